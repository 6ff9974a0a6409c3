/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Datasets that count into the checksum of a checkpoint. */
#include "results/archive.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

uint64_t gh_sum_bytes(uint64_t sum, const void *data, size_t size) {
  const char *bytes = data;
  for (; size > 0;) {
    uint64_t word = 0;
    size_t n = size < sizeof word ? size : sizeof word;
    memcpy(&word, bytes, n);
    sum = (sum ^ word) * 1099511628211u;
    sum ^= sum >> 32;
    bytes += n, size -= n;
  }
  return sum;
}

const uint64_t gh_sum_begin = 14695981039346656037u;

void gh_sum_text(uint64_t sum, char text[GH_SUM_TEXT]) {
  snprintf(text, GH_SUM_TEXT, "%016" PRIx64, sum);
}

gh_status gh_archive_put_doubles(gh_archive *a, const char *name, size_t n, const double *data) {
  a->sum = gh_sum_bytes(gh_sum_bytes(a->sum, &n, sizeof n), data, n * sizeof *data);
  return gh_h5_put_doubles(a->file, name, n, 1, data);
}

gh_status gh_archive_put_ints(gh_archive *a, const char *name, size_t n, const int *data) {
  a->sum = gh_sum_bytes(gh_sum_bytes(a->sum, &n, sizeof n), data, n * sizeof *data);
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
  GH_TRY(gh_h5_get_doubles(a->file, name, *n, 1, *data));
  a->sum = gh_sum_bytes(gh_sum_bytes(a->sum, n, sizeof *n), *data, *n * sizeof **data);
  return GH_OK;
}

gh_status gh_archive_get_ints(gh_archive *a, const char *name, size_t *n, int **data) {
  GH_TRY(dataset_size(a, name, n));
  GH_TRY(gh_alloc(a->ctx, *n + 1, sizeof **data, data));
  GH_TRY(gh_h5_get_ints(a->file, name, *n, 1, *data));
  a->sum = gh_sum_bytes(gh_sum_bytes(a->sum, n, sizeof *n), *data, *n * sizeof **data);
  return GH_OK;
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
