/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Memory for large arrays that are read here and there. */
#ifndef GRANHOM_PACKING_LARGE_H
#define GRANHOM_PACKING_LARGE_H

#include "granhom/packing.h"

/* Zeroed memory that begins at a cache line; from a few MiB on it lies in huge pages where the system has
 * them (Linux: transparent huge pages on request), since otherwise most reads miss the page table's cache
 * too. For free(). GH_MEMORY. */
gh_status packing_large(gh_context *ctx, size_t bytes, void *memory);

#endif
