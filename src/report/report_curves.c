/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The curves of the report. */
#include "report/report.h"

#include <stdlib.h>
#include <string.h>

/* A column of history.csv from the increment `first` on; `number` turns a row into a value. */
typedef struct columns {
  int n, first;
  double *x, *force, *dilatancy, *increment, *iterations, *residual, *acoustic;
  int *mark, *jump; /* colours: 2 an instability in the increment, 3 it was bisected; jump: the first alone */
  double *memory;
} columns;

static gh_status take_columns(report *r, columns *c) {
  const report_table *h = &r->history;
  size_t n = (size_t)r->n;
  *c = (columns){.n = r->n, .first = r->curve.first};
  GH_TRY(gh_alloc(r->ctx, 2 * n, sizeof *c->mark, &c->mark));
  c->jump = c->mark + n;
  GH_TRY(gh_alloc(r->ctx, 7 * n, sizeof *c->memory, &c->memory));
  double **const at[] = {&c->x,          &c->force,    &c->dilatancy, &c->increment,
                         &c->iterations, &c->residual, &c->acoustic};
  for (size_t k = 0; k < 7; k++) *at[k] = c->memory + k * n;
  for (int k = 0; k < r->n; k++) {
    c->x[k] = r->curve.sign * report_table_number(h, k, r->curve.x);
    c->force[k] = r->curve.force < 0 ? NAN : fabs(report_table_number(h, k, r->curve.force));
    c->dilatancy[k] = report_table_number(h, k, r->curve.dilatancy);
    c->increment[k] = k;
    c->iterations[k] = report_history(r, k, "iterations");
    c->acoustic[k] = report_history(r, k, "min_acoustic");
    c->residual[k] = report_history(r, k, "residual");
    c->jump[k] = report_history(r, k, "jumps") > 0 ? 2 : 0;
    c->mark[k] = c->jump[k] ? c->jump[k] : report_history(r, k, "cuts") > 0 ? 3 : 0;
  }
  return GH_OK;
}

/* y over the driven displacement (or the load steps), increments with instabilities marked. */
static void over_path(report *r, const columns *c, const char *title, const char *y_label, const double *y) {
  int first = c->first;
  report_chart chart = {
      .title = title,
      .x_label = r->curve.x_label,
      .y_label = y_label,
      .first = first,
      .line = NAN,
      .nseries = 1,
      .mark_names = {"increment", "with an instability"},
      .series = {{.n = c->n - first, .x = c->x + first, .y = y + first, .mark = c->jump + first}}};
  for (int k = first; k < c->n; k++)
    if (c->jump[k]) chart.nmarks = 2;
  report_draw_chart(r->out, &chart);
}

static void draw_iterations(report *r, const columns *c) {
  report_chart chart = {.title = "Macro iterations of each increment",
                        .x_label = "increment",
                        .y_label = "iterations",
                        .bars = true,
                        .line = NAN,
                        .nseries = 1,
                        .nmarks = 3,
                        .mark_names = {"in one substep", "with an instability", "bisected"},
                        .series = {{.n = c->n, .x = c->increment, .y = c->iterations, .mark = c->mark}}};
  report_draw_chart(r->out, &chart);
}

static void draw_residuals(report *r, const columns *c) {
  static const char *const keys[] = {"options", "solver", "tolerance", NULL};
  report_chart chart = {.title = "Residual at the end of each increment",
                        .x_label = "increment",
                        .y_label = "residual over forces",
                        .log_y = true,
                        .line = report_run_number(r, keys),
                        .line_label = "tolerance",
                        .nseries = 1,
                        .series = {{.n = c->n, .x = c->increment, .y = c->residual}}};
  report_draw_chart(r->out, &chart);
}

static void draw_stability(report *r, const columns *c) {
  char label[160];
  if (!r->tangents) return;
  report_chart chart = {.title = "Smallest acoustic eigenvalue of all points",
                        .x_label = "increment",
                        .y_label =
                            report_label(label, "at or below 0: ellipticity is lost", r->labels.stress),
                        .line = NAN,
                        .zero = true,
                        .nseries = 1,
                        .series = {{.n = c->n, .x = c->increment, .y = c->acoustic}}};
  report_draw_chart(r->out, &chart);
}

gh_status report_iterations(report *r) {
  columns c = {0};
  gh_status status = take_columns(r, &c);
  if (status == GH_OK) {
    gh_text_print(r->out, "<div class=\"grid\">\n");
    draw_iterations(r, &c);
    draw_residuals(r, &c);
    gh_text_print(r->out, "</div>\n");
  }
  free(c.memory);
  free(c.mark);
  return status;
}

/* ---- at the chosen points ---- */

typedef struct paths {
  double *p, *q, *coordination, *anisotropy, *increment; /* n per point, one point after another */
  char name[REPORT_POINTS][32];
  double *memory;
} paths;

/* Larger minus smaller principal stress, halved: the radius of Mohr's circle. */
static double shear(const double s[4]) {
  return hypot(0.5 * (s[0] - s[3]), 0.5 * (s[1] + s[2]));
}

static gh_status take_increment(report *r, int k, paths *t) {
  double *cauchy, *number;
  size_t np = (size_t)r->np;
  GH_TRY(report_field(r, k, "points/cauchy", np, 4, &cauchy));
  for (int j = 0; j < r->npoints; j++) {
    const double *s = cauchy + 4 * r->points[j];
    t->p[j * r->n + k] = -0.5 * (s[0] + s[3]);
    t->q[j * r->n + k] = shear(s);
    t->increment[j * r->n + k] = k;
  }
  free(cauchy);
  static const char *const names[] = {"points/coordination", "points/anisotropy"};
  for (int i = 0; i < 2; i++) {
    char full[64];
    snprintf(full, sizeof full, "/step%04d/%s", k, names[i]);
    bool there;
    GH_TRY(gh_h5_there(r->results, full, &there)); /* old folders lack the anisotropy */
    number = NULL;
    if (there) GH_TRY(report_field(r, k, names[i], np, 1, &number));
    for (int j = 0; j < r->npoints; j++)
      (i ? t->anisotropy : t->coordination)[j * r->n + k] = there ? number[r->points[j]] : NAN;
    free(number);
  }
  return GH_OK;
}

static gh_status take_paths(report *r, paths *t) {
  size_t n = (size_t)r->n * (size_t)r->npoints;
  GH_TRY(gh_alloc(r->ctx, 5 * n, sizeof *t->memory, &t->memory));
  double **const at[] = {&t->p, &t->q, &t->coordination, &t->anisotropy, &t->increment};
  for (size_t k = 0; k < 5; k++) *at[k] = t->memory + k * n;
  for (int j = 0; j < r->npoints; j++) snprintf(t->name[j], sizeof t->name[j], "point %d", r->points[j]);
  for (int k = 0; k < r->n; k++) GH_TRY(take_increment(r, k, t));
  return GH_OK;
}

static void draw_points(report *r, const paths *t, const char *title, const char *x_label, const double *x,
                        const char *y_label, const double *y, bool zero) {
  report_chart chart = {.title = title,
                        .x_label = x_label,
                        .y_label = y_label,
                        .line = NAN,
                        .zero = zero,
                        .nseries = r->npoints};
  for (int j = 0; j < r->npoints; j++)
    chart.series[j] = (report_series){.name = t->name[j], .n = r->n, .x = x + j * r->n, .y = y + j * r->n};
  report_draw_chart(r->out, &chart);
}

static gh_status draw_paths(report *r) {
  paths t = {0};
  char p[160], q[160];
  gh_status status = take_paths(r, &t);
  if (status == GH_OK) {
    report_label(p, "mean pressure \xe2\x88\x92(s11+s22)/2", r->labels.stress);
    report_label(q, "shear stress (s_I\xe2\x88\x92s_II)/2", r->labels.stress);
    draw_points(r, &t, "Stress paths of the chosen points", p, t.p, q, t.q, true);
    draw_points(r, &t, "Coordination number", "increment", t.increment,
                "contacts of a grain that is no rattler", t.coordination, false);
    if (isfinite(t.anisotropy[0]))
      draw_points(r, &t, "Anisotropy of the contacts", "increment", t.increment,
                  "(F_I\xe2\x88\x92"
                  "F_II)/(F_I+F_II), F = mean n\xe2\x8a\x97n",
                  t.anisotropy, true);
  }
  free(t.memory);
  return status;
}

/* ---- the numbers as a table ---- */

enum { MOST_COLUMNS = 16 };

/* Columns of history.csv that the table shows. */
static int table_columns(const report *r, int column[MOST_COLUMNS]) {
  static const char *const more[] = {"iterations", "substeps",     "cuts",    "jumps",
                                     "unjammed",   "min_acoustic", "residual"};
  int n = 0;
  column[n++] = r->curve.x;
  if (r->curve.force >= 0) column[n++] = r->curve.force;
  column[n++] = r->curve.dilatancy;
  for (size_t j = 0; j < sizeof more / sizeof *more; j++) {
    int c = report_table_column(&r->history, more[j]);
    const bool known = r->tangents || strcmp(more[j], "min_acoustic") != 0;
    if (c >= 0 && known) column[n++] = c;
  }
  return n;
}

static void print_table(report *r) {
  const report_table *h = &r->history;
  gh_text *out = r->out;
  int column[MOST_COLUMNS], n = table_columns(r, column), name = report_table_column(h, "name");
  gh_text_print(out, "<details><summary>The numbers of these curves</summary><div class=\"scroll\" "
                     "tabindex=\"0\"><table id=\"history\">"
                     "<thead><tr><th>increment</th><th class=\"left\">step</th>");
  for (int j = 0; j < n; j++) {
    gh_text_print(out, "<th>");
    report_escape(out, h->name[column[j]]);
    gh_text_print(out, "</th>");
  }
  gh_text_print(out, "</tr></thead><tbody>\n");
  for (int k = 0; k < r->n; k++) {
    gh_text_print(out, "<tr><td>%d</td><td class=\"left\">", k);
    report_escape(out, report_table_text(h, k, name));
    gh_text_print(out, "</td>");
    for (int j = 0; j < n; j++) gh_text_print(out, "<td>%.6g</td>", report_table_number(h, k, column[j]));
    gh_text_print(out, "</tr>\n");
  }
  gh_text_print(out, "</tbody></table></div></details>\n");
}

gh_status report_curves(report *r) {
  columns c = {0};
  gh_text_print(r->out, "<h2 id=\"curves\">Curves</h2>\n<div class=\"grid\">\n");
  gh_status status = take_columns(r, &c);
  if (status == GH_OK) {
    if (r->curve.force >= 0) over_path(r, &c, "Force", r->curve.force_label, c.force);
    over_path(r, &c, "Dilatancy", "100 (v/V \xe2\x88\x92 1), %", c.dilatancy);
    status = draw_paths(r);
  }
  if (status == GH_OK) {
    draw_stability(r, &c);
    gh_text_print(r->out, "</div>\n");
    print_table(r);
  }
  free(c.memory);
  free(c.mark);
  return status;
}
