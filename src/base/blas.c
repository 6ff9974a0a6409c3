/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Which BLAS is loaded.
 *
 * The factors of CHOLMOD and UMFPACK are made by it, and the order of its sums is its own: another BLAS gives
 * other last bits. It is found by where its functions lie, so that nothing more is linked. */
#define _GNU_SOURCE
#include "granhom/base.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The last two parts of a path: the name of a library states little where its folder tells them apart. */
static const char *path_end(const char *path) {
  const char *end = path + strlen(path);
  for (int parts = 0; end > path; end--)
    if (end[-1] == '/' && ++parts == 2) return end;
  return end;
}

/* What the library states of itself: version, and the kernels that it has chosen for this processor. */
static void blas_describe(char *text, size_t size) {
  typedef char *config(void);
  static const char *const names[] = {"openblas_get_config", "openblas_get_corename",
                                      "bli_info_get_version_str"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    config *f;
    *(void **)(void *)&f = dlsym(RTLD_DEFAULT, names[k]);
    const size_t used = strlen(text);
    if (f && used < size) snprintf(text + used, size - used, "; %s", f());
  }
}

gh_status gh_blas(gh_context *ctx, char *text, size_t size) {
  Dl_info info;
  void *function = dlsym(RTLD_DEFAULT, "dgemm_");
  snprintf(text, size, "unknown");
  if (function && dladdr(function, &info) && info.dli_fname) {
    char *path = realpath(info.dli_fname, NULL);
    if (!path)
      return gh_fail(ctx, GH_SYSTEM, "%s: the path of the BLAS cannot be resolved: %s", info.dli_fname,
                     strerror(errno));
    snprintf(text, size, "%s", path_end(path));
    free(path);
  }
  blas_describe(text, size);
  return GH_OK;
}
