/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Memory for large arrays that are read here and there. */
#define _DEFAULT_SOURCE /* madvise */
#include "packing/large.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

gh_status packing_large(gh_context *ctx, size_t bytes, void *out) {
  enum { LINE = 64, PAGE = 1 << 21 };
  const size_t unit = bytes < 2 * PAGE ? LINE : PAGE, whole = (bytes + unit - 1) / unit * unit;
  void *memory = aligned_alloc(unit, whole);
  if (!memory) return gh_fail(ctx, GH_MEMORY, "no memory for %zu bytes", bytes);
#ifdef MADV_HUGEPAGE
  if (unit == PAGE)
    (void)madvise(memory, whole, MADV_HUGEPAGE); /* advice: without it, everything is slower */
#endif
  memset(memory, 0, whole);
  memcpy(out, &memory, sizeof memory);
  return GH_OK;
}
