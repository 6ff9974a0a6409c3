/* SPDX-License-Identifier: GPL-2.0-or-later */
/* In the place of h5.c where there is no HDF5 (make HDF5=0): no file is ever open. */
#include "granhom/io.h"

void gh_h5_start(void) {}

bool gh_h5_available(void) {
  return false;
}

static gh_status refuse(gh_context *ctx, const char *path, gh_h5 **file) {
  *file = NULL;
  return gh_fail(ctx, GH_INPUT, "%s: this granhom was built without HDF5 (make HDF5=0)", path);
}

gh_status gh_h5_open(gh_context *ctx, const char *path, const char *kind, bool append, gh_h5 **file) {
  (void)kind, (void)append;
  return refuse(ctx, path, file);
}

gh_status gh_h5_read(gh_context *ctx, const char *path, const char *kind, bool *sealed, gh_h5 **file) {
  (void)kind, (void)sealed;
  return refuse(ctx, path, file);
}

/* There is no gh_h5 that these could be called with, but for the last two, which take none at all. */

gh_status gh_h5_put_doubles(gh_h5 *file, const char *name, size_t rows, size_t cols, const double *data) {
  (void)file, (void)name, (void)rows, (void)cols, (void)data;
  return GH_INTERNAL;
}

gh_status gh_h5_put_ints(gh_h5 *file, const char *name, size_t rows, size_t cols, const int *data) {
  (void)file, (void)name, (void)rows, (void)cols, (void)data;
  return GH_INTERNAL;
}

gh_status gh_h5_put_text(gh_h5 *file, const char *name, const char *text) {
  (void)file, (void)name, (void)text;
  return GH_INTERNAL;
}

gh_status gh_h5_remove(gh_h5 *file, const char *name, bool *there) {
  (void)file, (void)name, (void)there;
  return GH_INTERNAL;
}

gh_status gh_h5_there(gh_h5 *file, const char *name, bool *there) {
  (void)file, (void)name;
  *there = false;
  return GH_INTERNAL;
}

gh_status gh_h5_size(gh_h5 *file, const char *name, size_t *rows, size_t *cols) {
  (void)file, (void)name, (void)rows, (void)cols;
  return GH_INTERNAL;
}

gh_status gh_h5_get_doubles(gh_h5 *file, const char *name, size_t rows, size_t cols, double *data) {
  (void)file, (void)name, (void)rows, (void)cols, (void)data;
  return GH_INTERNAL;
}

gh_status gh_h5_get_ints(gh_h5 *file, const char *name, size_t rows, size_t cols, int *data) {
  (void)file, (void)name, (void)rows, (void)cols, (void)data;
  return GH_INTERNAL;
}

gh_status gh_h5_get_text(gh_h5 *file, const char *name, size_t size, char *text) {
  (void)file, (void)name, (void)size, (void)text;
  return GH_INTERNAL;
}

gh_status gh_h5_commit(gh_h5 **file) {
  (void)file;
  return GH_OK;
}

void gh_h5_close(gh_h5 **file) {
  (void)file;
}
