/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Paths of deformation gradients: legs from F = I, or the rows of a file. */
#include "study/parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROWS = 10000000 };

void study_path_free(study_path *path) {
  free(path->t);
  free(path->F);
  free(path->file);
  *path = (study_path){0};
}

static gh_status path_reserve(gh_context *ctx, node where, double rows, study_path *p) {
  if (rows > MOST_ROWS)
    return gh_yaml_fail(where, "the path has %.0f rows with `refine`, at most %d are possible", rows,
                        MOST_ROWS);
  GH_TRY(gh_alloc(ctx, (size_t)rows, sizeof *p->t, &p->t));
  return gh_alloc(ctx, (size_t)rows, 4 * sizeof *p->F, &p->F);
}

static void path_begin(study_path *p) {
  static const double one[4] = {1, 0, 0, 1};
  p->t[0] = 0;
  memcpy(p->F, one, sizeof one);
  p->rows = 1;
}

/* `count` increments of 1/refine each in t, linearly from the last row to `to`. Quotients are formed first,
 * so that a coarse and a fine path agree to the bit where they meet. */
static void path_add_leg(study_path *p, const double to[4], int count, long refine) {
  double from[4], begin_t = p->t[p->rows - 1];
  const long n = count * refine;
  memcpy(from, p->F + 4 * (p->rows - 1), sizeof from);
  for (long k = 1; k <= n; k++, p->rows++) {
    double s = (double)k / (double)n;
    p->t[p->rows] = begin_t + (double)k / (double)refine;
    for (int c = 0; c < 4; c++) p->F[4 * p->rows + c] = k == n ? to[c] : from[c] + s * (to[c] - from[c]);
  }
}

/* ---- legs ---- */

static gh_status read_leg(node leg, double to[4], long *count) {
  node n;
  GH_TRY(gh_yaml_map(leg, "a leg", study_leg_keys));
  GH_TRY(gh_yaml_need(leg, "a leg", "to", &n));
  GH_TRY(gh_yaml_numbers(n, "to", 4, to));
  if (!(gh_det2(to) > 0))
    return gh_yaml_fail(n, "to: [F11, F12, F21, F22] has the determinant %g; it must be positive",
                        gh_det2(to));
  GH_TRY(gh_yaml_need(leg, "a leg", "increments", &n));
  return gh_yaml_integer(n, "increments", 1, MOST_ROWS, count);
}

/* Between two F of positive determinant there may be one that has none. */
static gh_status path_check_rows(node where, const study_path *p, int first) {
  for (int k = first; k < p->rows; k++)
    if (!(gh_det2(p->F + 4 * k) > 0))
      return gh_yaml_fail(where, "on the path to it det F is %g at t = %g; it must be positive",
                          gh_det2(p->F + 4 * k), p->t[k]);
  return GH_OK;
}

static gh_status read_legs(gh_context *ctx, node legs, long refine, study_path *p) {
  double to[4], total = 1;
  long count = 0;
  if (!gh_yaml_is_list(legs) || gh_yaml_length(legs) < 1)
    return gh_yaml_fail(legs, "legs must be a list: [{to: [F11, F12, F21, F22], increments: N}, ...]");
  for (int k = 0; k < gh_yaml_length(legs); k++) {
    GH_TRY(read_leg(gh_yaml_item(legs, k), to, &count));
    total += (double)count * (double)refine;
  }
  GH_TRY(path_reserve(ctx, legs, total, p));
  path_begin(p);
  for (int k = 0; k < gh_yaml_length(legs); k++) {
    node leg = gh_yaml_item(legs, k);
    int first = p->rows;
    GH_TRY(read_leg(leg, to, &count));
    path_add_leg(p, to, (int)count, refine);
    GH_TRY(path_check_rows(leg, p, first));
  }
  return GH_OK;
}

/* ---- a file ---- */

static gh_status find_columns(gh_context *ctx, const gh_csv *csv, const char *file, int column[4]) {
  static const char *const names[4] = {"F11", "F12", "F21", "F22"};
  for (int c = 0; c < 4; c++) {
    column[c] = gh_csv_find(csv, names[c]);
    if (column[c] < 0)
      return gh_fail(ctx, GH_INPUT, "%s:1: no column %s; a path has F11,F12,F21,F22", file, names[c]);
  }
  return GH_OK;
}

static gh_status path_row(gh_context *ctx, const gh_csv *csv, const char *file, int row, const int column[4],
                          double F[4]) {
  for (int c = 0; c < 4; c++) F[c] = csv->value[(size_t)row * (size_t)csv->ncols + (size_t)column[c]];
  if (gh_det2(F) > 0) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "%s:%d: F has the determinant %g; it must be positive", file, csv->line[row],
                 gh_det2(F));
}

static gh_status add_rows(gh_context *ctx, node where, const gh_csv *csv, const char *file, long refine,
                          study_path *p) {
  int column[4];
  GH_TRY(find_columns(ctx, csv, file, column));
  GH_TRY(path_reserve(ctx, where, 1 + (double)csv->nrows * (double)refine, p));
  path_begin(p);
  for (int row = 0; row < csv->nrows; row++) {
    double F[4];
    int first = p->rows;
    GH_TRY(path_row(ctx, csv, file, row, column, F));
    if (row == 0 && memcmp(F, p->F, sizeof F) == 0) continue; /* the row F = I is there */
    path_add_leg(p, F, 1, refine);
    GH_TRY(path_check_rows(where, p, first));
  }
  return GH_OK;
}

static gh_status read_file(gh_context *ctx, node n, const char *folder, long refine, study_path *p) {
  const char *name;
  gh_csv *csv = NULL;
  GH_TRY(gh_yaml_text(n, "file", &name));
  char *file = p->file = gh_path_join(folder, name);
  if (!file) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_file_expect(ctx, gh_csv_read(ctx, file, &csv), file, GH_FILE_PATH);
  if (status == GH_OK && csv->nrows < 1) status = gh_fail(ctx, GH_INPUT, "%s: the path has no rows", file);
  if (status == GH_OK) status = add_rows(ctx, n, csv, file, refine, p);
  gh_csv_destroy(&csv);
  return status;
}

gh_status study_path_read(gh_context *ctx, node path, const char *folder, long refine, study_path *p) {
  *p = (study_path){0};
  GH_TRY(gh_yaml_map(path, "path", study_path_keys));
  node legs = gh_yaml_get(path, "legs"), file = gh_yaml_get(path, "file");
  if (gh_yaml_has(legs) == gh_yaml_has(file))
    return gh_yaml_fail(path, "path needs one of the keys 'legs' and 'file'");
  gh_status status =
      gh_yaml_has(legs) ? read_legs(ctx, legs, refine, p) : read_file(ctx, file, folder, refine, p);
  if (status != GH_OK) study_path_free(p);
  return status;
}

bool study_path_agree(const study_path *a, const study_path *b, double *t) {
  static const double same = 1e-12;
  for (int i = 0, j = 0; i < a->rows && j < b->rows;) {
    const double later = a->t[i] - b->t[j];
    if (fabs(later) > same * fmax(1, fabs(a->t[i]))) {
      *(later > 0 ? &j : &i) += 1;
      continue;
    }
    for (int c = 0; c < 4; c++)
      if (fabs(a->F[4 * i + c] - b->F[4 * j + c]) > same * fmax(1, fabs(a->F[4 * i + c]))) {
        *t = a->t[i];
        return false;
      }
    i++, j++;
  }
  return true;
}
