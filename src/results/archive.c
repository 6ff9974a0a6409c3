/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Datasets of a checkpoint. */
#include "results/archive.h"

#include <stdlib.h>
#include <string.h>

gh_status gh_archive_put_doubles(gh_archive *a, const char *name, size_t n, const double *data) {
  return gh_h5_put_doubles(a->file, name, n, 1, data);
}

gh_status gh_archive_put_ints(gh_archive *a, const char *name, size_t n, const int *data) {
  return gh_h5_put_ints(a->file, name, n, 1, data);
}

/* Bytes of any kind as doubles of the same bits. */
gh_status gh_archive_put_bytes(gh_archive *a, const char *name, size_t size, const void *data) {
  size_t n = (size + sizeof(double) - 1) / sizeof(double);
  double *words;
  GH_TRY(gh_alloc(a->ctx, n + 1, sizeof *words, &words));
  const double length = (double)size;
  memcpy(words, &length, sizeof length);
  memcpy(words + 1, data, size);
  gh_status status = gh_archive_put_doubles(a, name, n + 1, words);
  free(words);
  return status;
}

static gh_status dataset_size(gh_archive *a, const char *name, size_t *n) {
  size_t cols;
  GH_TRY(gh_h5_size(a->file, name, n, &cols));
  if (cols == 1 && *n <= a->bytes / sizeof(int)) return GH_OK;
  return gh_fail(a->ctx, GH_INPUT, "%s is no list that fits into the file", name);
}

gh_status gh_archive_get_doubles(gh_archive *a, const char *name, size_t *n, double **data) {
  GH_TRY(dataset_size(a, name, n));
  GH_TRY(gh_alloc(a->ctx, *n + 1, sizeof **data, data));
  return gh_h5_get_doubles(a->file, name, *n, 1, *data);
}

gh_status gh_archive_get_ints(gh_archive *a, const char *name, size_t *n, int **data) {
  GH_TRY(dataset_size(a, name, n));
  GH_TRY(gh_alloc(a->ctx, *n + 1, sizeof **data, data));
  return gh_h5_get_ints(a->file, name, *n, 1, *data);
}

gh_status gh_archive_get_bytes(gh_archive *a, const char *name, size_t *size, char **data) {
  size_t n;
  double *words = NULL;
  gh_status status = gh_archive_get_doubles(a, name, &n, &words);
  if (status == GH_OK && (n < 1 || !(words[0] >= 0 && words[0] <= (double)(n - 1) * sizeof(double))))
    status = gh_fail(a->ctx, GH_INPUT, "%s is no text", name);
  if (status == GH_OK) {
    *size = (size_t)words[0];
    status = gh_alloc(a->ctx, *size + 1, 1, data);
  }
  if (status == GH_OK) memcpy(*data, words + 1, *size);
  free(words);
  return status;
}
