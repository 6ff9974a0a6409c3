/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A run beside others of the same scene: reading, and the gaps. */
#include "report/compare.h"

#include "io/file.h"

#include <stdlib.h>
#include <string.h>

/* ---- which columns ---- */

static const char *const numbers[] = {"dilatancy", "coordination", "anisotropy"};
static const char *const footing[] = {"footing_ux_", "footing_uy_", "footing_turn_"};

static bool is_number(const char *name) {
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
    if (strcmp(name, numbers[k]) == 0) return true;
  for (size_t k = 0; k < sizeof footing / sizeof *footing; k++)
    if (strncmp(name, footing[k], strlen(footing[k])) == 0) return true;
  return false;
}

/* The x of a pair SET_x, SET_y: names of loads come singly or before their set. */
static bool is_reaction_pair(const report_table *t, int column) {
  const char *x = t->name[column];
  const size_t n = strlen(x);
  if (n < 3 || strcmp(x + n - 2, "_x") != 0 || column + 1 >= t->ncols) return false;
  const char *y = t->name[column + 1];
  return strlen(y) == n && strncmp(x, y, n - 1) == 0 && y[n - 1] == 'y';
}

static bool in_all(const char *name, const report_table *others, int nothers) {
  for (int k = 0; k < nothers; k++)
    if (report_table_column(others + k, name) < 0) return false;
  return true;
}

static void column_add(gh_comparison *c, const report_table *others, const char *name, compared_kind kind) {
  if (in_all(name, others, c->nothers)) c->quantity[c->n++] = (compared){.name = name, .kind = kind};
}

static gh_status columns_choose(gh_comparison *c, const report_table *others) {
  const report_table *t = &c->table;
  GH_TRY(gh_alloc(c->ctx, (size_t)t->ncols, sizeof *c->quantity, &c->quantity));
  for (int k = 0; k < t->ncols; k++) {
    if (is_reaction_pair(t, k)) {
      column_add(c, others, t->name[k], COMPARED_REACTION);
      column_add(c, others, t->name[k + 1], COMPARED_REACTION);
    } else if (is_number(t->name[k])) column_add(c, others, t->name[k], COMPARED_NUMBER);
  }
  for (int k = 0; k < c->n; k++)
    if (c->quantity[k].kind == COMPARED_REACTION) return GH_OK;
  return gh_fail(c->ctx, GH_INPUT, "%s: has no reaction in common with what it is compared to", t->path);
}

/* ---- rows in common ---- */

static double time_at(const report_table *t, int row) {
  return report_table_number(t, row, report_table_column(t, "time"));
}

static gh_status times_check(gh_context *ctx, const report_table *t) {
  for (int k = 0; k < t->nrows; k++)
    if (!isfinite(time_at(t, k)) || (k > 0 && !(time_at(t, k) > time_at(t, k - 1))))
      return gh_fail(ctx, GH_INPUT, "%s:%d: the load steps in the column `time` do not increase", t->path,
                     k + 2);
  return GH_OK;
}

/* Load steps that are closer are one. */
static const double SAME = 1e-9;

static gh_status rows_choose(gh_comparison *c, const report_table *others) {
  double end = INFINITY;
  for (int k = 0; k < c->nothers; k++) end = fmin(end, time_at(others + k, others[k].nrows - 1));
  while (c->rows < c->table.nrows && time_at(&c->table, c->rows) <= end + SAME) c->rows++;
  c->shorter = c->rows < c->table.nrows;
  if (c->rows >= 2) return GH_OK;
  return gh_fail(c->ctx, GH_INPUT, "%s: has no increment in common with what it is compared to",
                 c->table.path);
}

/* A column at a load step, linear between two rows. */
static double at_time(const report_table *t, int column, double time) {
  int k = 0;
  while (k + 1 < t->nrows && time_at(t, k) < time - SAME) k++;
  const double here = report_table_number(t, k, column);
  if (k == 0 || fabs(time_at(t, k) - time) <= SAME) return here;
  const double before = report_table_number(t, k - 1, column),
               share = (time - time_at(t, k - 1)) / (time_at(t, k) - time_at(t, k - 1));
  return before + share * (here - before);
}

/* ---- the same loading ---- */

static gh_status loading_check(gh_comparison *c, const report_table *other) {
  if (!c->curve.driven) return GH_OK;
  const char *name = c->table.name[c->curve.x];
  const int column = report_table_column(other, name);
  double largest = 0;
  if (column < 0)
    return gh_fail(c->ctx, GH_INPUT, "%s: has no column %s, which %s is driven by", other->path, name,
                   c->folder);
  for (int k = 0; k < c->rows; k++)
    largest = fmax(largest, fabs(report_table_number(&c->table, k, c->curve.x)));
  for (int k = 0; k < c->rows; k++) {
    const double here = report_table_number(&c->table, k, c->curve.x),
                 there = at_time(other, column, c->time[k]);
    /* Within a step it depends on where the set was before, which may have been free. */
    if (fabs(c->time[k] - round(c->time[k])) > SAME || !isfinite(here) || !isfinite(there)) continue;
    if (!(fabs(here - there) <= 1e-6 * largest))
      return gh_fail(c->ctx, GH_INPUT, "%s: %s is %g at load step %g, %s has %g: not the same loading",
                     other->path, name, there, c->time[k], c->folder, here);
  }
  return GH_OK;
}

/* ---- numbers ---- */

static gh_status values_take(gh_comparison *c, const report_table *others, compared *q) {
  const int column = report_table_column(&c->table, q->name);
  for (int k = 0; k < c->rows; k++) {
    q->first[k] = report_table_number(&c->table, k, column);
    bool good = isfinite(q->first[k]);
    for (int j = 0; j < c->nothers; j++) {
      const double v = at_time(others + j, report_table_column(others + j, q->name), c->time[k]);
      good = good && isfinite(v);
      q->other[j * c->rows + k] = v;
      q->mean[k] += v / c->nothers;
    }
    if (!good)
      return gh_fail(c->ctx, GH_INPUT, "%s:%d: %s is not a finite number, here or in what it is compared to",
                     c->table.path, k + 2, q->name);
    for (int j = 0; j < c->nothers && q->scatter; j++) {
      const double d = q->other[j * c->rows + k] - q->mean[k];
      q->scatter[k] += d * d / (c->nothers - 1);
    }
    if (q->scatter) q->scatter[k] = sqrt(q->scatter[k]);
  }
  return GH_OK;
}

static gh_status values_all(gh_comparison *c, const report_table *others) {
  const size_t rows = (size_t)c->rows, each = rows * (size_t)(4 + c->nothers);
  GH_TRY(gh_alloc(c->ctx, each * (size_t)c->n, sizeof *c->memory, &c->memory));
  for (int k = 0; k < c->n; k++) {
    compared *q = c->quantity + k;
    q->first = c->memory + each * (size_t)k;
    q->mean = q->first + rows;
    q->gap = q->mean + rows;
    q->scatter = c->nothers > 1 ? q->gap + rows : NULL;
    q->other = q->gap + 2 * rows;
    GH_TRY(values_take(c, others, q));
  }
  return GH_OK;
}

static gh_status gaps_fill(gh_comparison *c) {
  double most = -1;
  for (int i = 0; i < c->n; i++)
    for (int k = 0; k < c->rows && c->quantity[i].kind == COMPARED_REACTION; k++)
      if (fabs(c->quantity[i].mean[k]) > most) most = fabs(c->quantity[i].mean[k]), c->shown = i;
  if (!(most > 0))
    return gh_fail(c->ctx, GH_INPUT, "%s: what it is compared to has no reaction but zero", c->table.path);
  c->largest = most;
  for (int i = 0; i < c->n; i++) {
    compared *q = c->quantity + i;
    const double scale = q->kind == COMPARED_REACTION ? 100 / most : 1;
    for (int k = 0; k < c->rows; k++) q->gap[k] = scale * (q->first[k] - q->mean[k]);
    if (c->curve.driven && c->curve.force >= 0 && strcmp(q->name, c->table.name[c->curve.force]) == 0)
      c->shown = i;
  }
  return GH_OK;
}

/* ---- one after another ---- */

static gh_status others_read(gh_comparison *c, const char *const *others, report_table *tables) {
  for (int k = 0; k < c->nothers; k++) {
    report_labels l;
    GH_TRY(report_labels_read(c->ctx, others[k], &l));
    if (strcmp(l.driven_set, c->labels.driven_set) != 0 ||
        (*l.driven_set && l.driven_direction != c->labels.driven_direction))
      return gh_fail(c->ctx, GH_INPUT,
                     "%s: drives '%s' in %c, %s '%s' in %c: results of one scene are wanted", others[k],
                     l.driven_set, l.driven_direction, c->folder, c->labels.driven_set,
                     c->labels.driven_direction);
    GH_TRY(report_table_read(c->ctx, others[k], "history.csv", tables + k));
    GH_TRY(times_check(c->ctx, tables + k));
  }
  return GH_OK;
}

static gh_status axis_fill(gh_comparison *c) {
  GH_TRY(gh_alloc(c->ctx, 2 * (size_t)c->rows, sizeof *c->time, &c->time));
  c->x = c->time + c->rows;
  for (int k = 0; k < c->rows; k++) {
    c->time[k] = time_at(&c->table, k);
    c->x[k] = c->curve.driven ? c->curve.sign * report_table_number(&c->table, k, c->curve.x) : c->time[k];
  }
  c->from = c->curve.driven && c->curve.first < c->rows - 1 ? c->curve.first : 0;
  snprintf(c->x_label, sizeof c->x_label, "%s", c->curve.driven ? c->curve.x_label : "load steps");
  return GH_OK;
}

static gh_status compare(gh_comparison *c, const char *const *others, report_table *tables) {
  GH_TRY(report_labels_read(c->ctx, c->folder, &c->labels));
  GH_TRY(report_table_read(c->ctx, c->folder, "history.csv", &c->table));
  GH_TRY(times_check(c->ctx, &c->table));
  GH_TRY(report_curve_choose(c->ctx, &c->table, &c->labels, &c->curve));
  GH_TRY(others_read(c, others, tables));
  GH_TRY(rows_choose(c, tables));
  GH_TRY(axis_fill(c));
  for (int k = 0; k < c->nothers; k++) GH_TRY(loading_check(c, tables + k));
  GH_TRY(columns_choose(c, tables));
  GH_TRY(values_all(c, tables));
  return gaps_fill(c);
}

gh_status gh_comparison_create(gh_context *ctx, const char *folder, const char *const *others, int nothers,
                               gh_comparison **comparison) {
  report_table *tables;
  *comparison = NULL;
  if (nothers < 1 || nothers > GH_COMPARED_MOST)
    return gh_fail(ctx, GH_INPUT, "1 to %d folders to compare %s to are wanted, not %d", GH_COMPARED_MOST,
                   folder, nothers);
  GH_TRY(gh_alloc(ctx, 1, sizeof **comparison, comparison));
  gh_comparison *c = *comparison;
  c->ctx = ctx;
  c->nothers = nothers;
  gh_status status = gh_alloc(ctx, (size_t)nothers, sizeof *tables, &tables);
  if (status == GH_OK && !(c->folder = strdup(folder)))
    status = gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK) status = compare(c, others, tables);
  for (int k = 0; k < nothers && tables; k++) report_table_free(tables + k);
  free(tables);
  if (status != GH_OK) gh_comparison_destroy(comparison);
  return status;
}

void gh_comparison_destroy(gh_comparison **comparison) {
  gh_comparison *c = *comparison;
  if (!c) return;
  report_table_free(&c->table);
  free(c->folder);
  free(c->time);
  free(c->quantity);
  free(c->memory);
  free(c);
  *comparison = NULL;
}
