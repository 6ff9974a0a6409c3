/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A path of deformation gradients from a CSV file. */
#include "path.h"

const option_row path_option[] = {
    {.name = "path",
     .argument = "FILE",
     .kind = OPTION_TEXT,
     .help = "CSV with the columns F11 F12 F21 F22 (and step), a row per increment; - is standard input"},
    {0}};

void path_F(const path_rows *path, int row, double F[4]) {
  for (int k = 0; k < 4; k++) F[k] = path->csv->value[row * path->csv->ncols + path->columns[k + 1]];
}

static double step_number(const path_rows *path, int row) {
  int column = path->columns[0];
  return column >= 0 ? path->csv->value[row * path->csv->ncols + column] : row;
}

long path_step(const path_rows *path, int row) {
  return (long)step_number(path, row);
}

static gh_status rows_read(gh_context *ctx, const char *file, path_rows *path) {
  static const char *const names[] = {"step", "F11", "F12", "F21", "F22"};
  GH_TRY(gh_csv_read(ctx, file, &path->csv));
  const gh_csv *p = path->csv;
  for (int k = 0; k < 5; k++) {
    path->columns[k] = gh_csv_find(p, names[k]);
    if (path->columns[k] < 0 && k > 0)
      return gh_fail(ctx, GH_INPUT, "%s:1: no column %s; a path has step,F11,F12,F21,F22", file, names[k]);
  }
  if (p->nrows < 1) return gh_fail(ctx, GH_INPUT, "%s: the path has no rows", file);
  for (int row = 0; row < p->nrows; row++) {
    double F[4], step = step_number(path, row);
    path_F(path, row, F);
    if (!(gh_det2(F) > 0))
      return gh_fail(ctx, GH_INPUT,
                     "%s:%d: F = [%g %g; %g %g] has the determinant %g; it must be positive. %s", file,
                     p->line[row], F[0], F[1], F[2], F[3], gh_det2(F), gh_limits_undeformed);
    if (step != floor(step) || fabs(step) > 1e15)
      return gh_fail(ctx, GH_INPUT, "%s:%d: step %g is not an integer", file, p->line[row], step);
  }
  return GH_OK;
}

gh_status path_read(gh_context *ctx, const char *file, path_rows *path) {
  return gh_file_expect(ctx, rows_read(ctx, file, path), file, GH_FILE_PATH);
}

gh_status path_check(gh_context *ctx, const char *file, const path_rows *path, const gh_rve_options *options,
                     const char *packing_file, const gh_packing *packing) {
  const double fraction = gh_packing_volume_fraction(packing);
  double F[4], least = INFINITY, most = 0;
  bool warned = false;
  for (int row = 0; row < path->csv->nrows; row++) {
    path_F(path, row, F);
    least = fmin(least, gh_det2(F)), most = fmax(most, gh_det2(F));
  }
  GH_TRY(gh_limits_check_packing(ctx, options, packing_file, packing, least, most, &warned));
  for (int row = 0; row < path->csv->nrows; row++) {
    char where[512];
    path_F(path, row, F);
    snprintf(where, sizeof where, "%s:%d", file, path->csv->line[row]);
    GH_TRY(gh_limits_check_F(ctx, options, where, F, fraction));
  }
  return GH_OK;
}
