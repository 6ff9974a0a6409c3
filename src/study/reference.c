/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Reference curves that are no runs: a closed form, a file. */
#include "study/parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static gh_status reference_locate(const gh_study *s) {
  return gh_prefix(s->ctx, GH_INPUT, "%s:%d: reference: ", s->path, s->reference_line);
}

/* ---- a file ---- */

/* Needed are the columns of the quantities that are compared. */
static bool column_needed(const gh_study *s, int column) {
  for (int k = 0; k < s->nquantities; k++)
    if (column >= s->quantities[k].first && column < s->quantities[k].first + s->quantities[k].count)
      return true;
  return false;
}

static gh_status find_columns(gh_study *s, const gh_csv *csv, int *column, int *t) {
  *t = gh_csv_find(csv, "t");
  if (*t < 0) return gh_fail(s->ctx, GH_INPUT, "%s:1: no column t", s->reference_file);
  for (int c = 0; c < s->ncolumns; c++) {
    column[c] = gh_csv_find(csv, s->column[c]);
    if (column[c] < 0 && column_needed(s, c))
      return gh_fail(s->ctx, GH_INPUT,
                     "%s:1: no column %s, which a quantity needs (`quantities` can leave it out)",
                     s->reference_file, s->column[c]);
  }
  return GH_OK;
}

static gh_status take_rows(gh_study *s, const gh_csv *csv, const int *column, int t, double *value) {
  size_t capacity = 0;
  for (int row = 0; row < csv->nrows; row++) {
    const double *cell = csv->value + (size_t)row * (size_t)csv->ncols;
    if (row > 0 && !(cell[t] > cell[t - csv->ncols]))
      return gh_fail(s->ctx, GH_INPUT, "%s:%d: t is %g, it must grow from row to row", s->reference_file,
                     csv->line[row], cell[t]);
    for (int c = 0; c < s->ncolumns; c++) value[c] = column[c] >= 0 ? cell[column[c]] : NAN;
    GH_TRY(study_curve_add(s->ctx, &s->given, &capacity, s->ncolumns, cell[t], value));
  }
  return GH_OK;
}

static gh_status take_file(gh_study *s) {
  gh_csv *csv = NULL;
  int *column = NULL, t;
  double *value = NULL;
  gh_status status = gh_csv_read(s->ctx, s->reference_file, &csv);
  if (status == GH_OK) status = gh_alloc(s->ctx, (size_t)s->ncolumns, sizeof *column, &column);
  if (status == GH_OK) status = gh_alloc(s->ctx, (size_t)s->ncolumns, sizeof *value, &value);
  if (status == GH_OK) status = find_columns(s, csv, column, &t);
  if (status == GH_OK && csv->nrows < 1)
    status = gh_fail(s->ctx, GH_INPUT, "%s: there are no rows", s->reference_file);
  if (status == GH_OK) status = take_rows(s, csv, column, t, value);
  free(column);
  free(value);
  gh_csv_destroy(&csv);
  return status;
}

/* ---- a closed form ---- */

/* It is one curve: what it depends on must be the same in all configurations. */
static gh_status check_parameters(const gh_study *s) {
  for (int k = 0; k < s->nparameters; k++)
    if (strncmp(s->parameters[k].name, "contact", 7) == 0 || strncmp(s->parameters[k].name, "path", 4) == 0)
      return gh_fail(s->ctx, GH_INPUT,
                     "a closed form needs the same %s in all configurations, and %s is varied",
                     *s->parameters[k].name == 'c' ? "contact law" : "path", s->parameters[k].name);
  return GH_OK;
}

static bool nearly_equal(double a, double b) {
  return fabs(a - b) <= 1e-9 * fabs(b);
}

/* The same lattice in each packing; a rotation by a bond's 60 degrees is none. */
static gh_status check_lattice(const gh_study *s, const study_problem *p, int config, int member,
                               study_lattice *common) {
  study_lattice l;
  const double third = acos(-1) / 3;
  const char *file = s->configs[config].files[member];
  gh_status status = study_lattice_find(s->ctx, p->packing, &p->rve.law, &l);
  if (status != GH_OK) return gh_prefix(s->ctx, status, "%s: ", file);
  if (common->spacing == 0) *common = l;
  const double turn = fabs(remainder(l.angle - common->angle, third));
  if (nearly_equal(l.radius, common->radius) && nearly_equal(l.spacing, common->spacing) && turn < 1e-6)
    return GH_OK;
  return gh_fail(
      s->ctx, GH_INPUT,
      "%s: its lattice is another one than that of the packings before, and the closed form is one "
      "for all",
      file);
}

/* Rows of all paths: t, then the columns. Paths are the same but for their refinement, so that a t has one F.
 */
enum { WIDTH = 10 };
typedef struct answers {
  double (*row)[WIDTH];
  size_t n, capacity;
  int last; /* rows of the path that was added last: with as many it is the same */
} answers;

static gh_status add_path(gh_context *ctx, const study_lattice *l, const study_path *path, answers *a) {
  if (path->rows == a->last) return GH_OK;
  a->last = path->rows;
  GH_TRY(gh_grow(ctx, a->n + (size_t)path->rows, sizeof *a->row, &a->capacity, &a->row));
  for (int k = 0; k < path->rows; k++, a->n++) {
    a->row[a->n][0] = path->t[k];
    GH_TRY(study_lattice_answer(ctx, l, path->F + 4 * k, a->row[a->n] + 1));
  }
  return GH_OK;
}

static int by_t(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Each t once, ascending. */
static gh_status take_answers(gh_study *s, answers *a) {
  size_t capacity = 0;
  if (a->n > 0) qsort(a->row, a->n, sizeof *a->row, by_t);
  for (size_t k = 0; k < a->n; k++)
    if (k == 0 || a->row[k][0] - a->row[k - 1][0] > 1e-9)
      GH_TRY(study_curve_add(s->ctx, &s->given, &capacity, s->ncolumns, a->row[k][0], a->row[k] + 1));
  return GH_OK;
}

static gh_status take_closed_form(gh_study *s) {
  study_lattice common = {0};
  answers all = {0};
  gh_status status = check_parameters(s);
  for (int k = 0; k < s->nconfigs && status == GH_OK; k++)
    for (int m = 0; m < s->configs[k].nruns && status == GH_OK; m++) {
      study_problem p;
      status = study_problem_open(s->ctx, s, k, m, -1, &p);
      if (status == GH_OK) status = check_lattice(s, &p, k, m, &common);
      if (status == GH_OK) status = add_path(s->ctx, &common, &p.path, &all);
      study_problem_close(&p);
    }
  if (status == GH_OK) status = take_answers(s, &all);
  free(all.row);
  return status;
}

gh_status study_reference(gh_study *s) {
  gh_status status = GH_OK;
  if (s->reference == STUDY_FILE) status = take_file(s);
  if (s->reference == STUDY_CLOSED_FORM) status = take_closed_form(s);
  return status == GH_INPUT ? reference_locate(s) : status;
}
