/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Residual tables and where the time went. */
#include "report/report.h"

#include <stdlib.h>

/* ---- residuals, as in Tables 6.1 to 6.7 of the dissertation ---- */

enum { SHOWN = 8 }; /* residuals in a row */

typedef struct residual_columns {
  int step, substep, iteration, relative, first;
} residual_columns;

static bool find_columns(const gh_csv *csv, residual_columns *c) {
  *c =
      (residual_columns){gh_csv_find(csv, "step"), gh_csv_find(csv, "substep"), gh_csv_find(csv, "iteration"),
                         gh_csv_find(csv, "relative"), gh_csv_find(csv, "first")};
  return c->step >= 0 && c->substep >= 0 && c->iteration >= 0 && c->relative >= 0 && c->first >= 0;
}

static double value(const gh_csv *csv, int row, int column) {
  return csv->value[(size_t)row * (size_t)csv->ncols + (size_t)column];
}

/* An attempt: rows from one iteration 0 to the next. */
static int attempt_end(const gh_csv *csv, const residual_columns *c, int begin) {
  int k = begin + 1;
  while (k < csv->nrows && value(csv, k, c->iteration) != 0) k++;
  return k;
}

static void print_cell(gh_text *out, double v) {
  gh_text_print(out, "<td>%.3E</td>", v);
}

/* One row: the residuals over the first, and the last one over the forces. Long attempts lose their middle.
 */
static void print_attempt(gh_text *out, const gh_csv *csv, const residual_columns *c, int begin, int end,
                          double tolerance) {
  int n = end - begin;
  double last = value(csv, end - 1, c->relative);
  bool met = last <= tolerance * (1 + 1e-12);
  gh_text_print(out, "<tr%s><td>%.0f</td><td>%.0f</td><td>%s</td><td>%d</td><td>%.3E</td>",
                met ? "" : " class=\"cut\"", value(csv, begin, c->step), value(csv, begin, c->substep) + 1,
                met ? "yes" : "no", n - 1, last);
  for (int k = 0; k < SHOWN; k++) {
    if (n <= SHOWN)
      k < n ? print_cell(out, value(csv, begin + k, c->first)) : gh_text_print(out, "<td></td>");
    else if (k < SHOWN - 2) print_cell(out, value(csv, begin + k, c->first));
    else if (k == SHOWN - 2) gh_text_print(out, "<td>\xe2\x80\xa6</td>");
    else print_cell(out, value(csv, end - 1, c->first));
  }
  gh_text_print(out, "</tr>\n");
}

gh_status report_convergence(report *r) {
  static const char *const keys[] = {"options", "solver", "tolerance", NULL};
  const gh_csv *csv = r->convergence;
  residual_columns c;
  double tolerance = report_run_number(r, keys);
  gh_text *out = r->out;
  gh_text_print(out, "<h2 id=\"convergence\">Convergence</h2>\n");
  GH_TRY(report_iterations(r));
  if (csv->nrows == 0 || !find_columns(csv, &c)) {
    gh_text_print(out, "<p>convergence.csv holds no residuals.</p>\n");
    return GH_OK;
  }
  gh_text_print(
      out, "<p class=\"soft\">One row per attempt at an increment or a substep. Residuals of the iterations "
           "over the first of the attempt; \xe2\x80\x9c"
           "at the end\xe2\x80\x9d over the forces, which has to "
           "come below the tolerance. Attempts that missed it are grey: the increment was then bisected, "
           "or the instability stepped over.</p>\n");
  gh_text_print(out, "<div class=\"scroll\" tabindex=\"0\"><table "
                     "id=\"residuals\"><thead><tr><th>increment</th><th>substep</th>"
                     "<th>converged</th><th>iterations</th><th>at the end</th>");
  for (int k = 0; k < SHOWN; k++)
    gh_text_print(out, "<th>%s</th>", k == SHOWN - 1 ? "\xe2\x80\xa6 last" : (char[2]){(char)('0' + k), 0});
  gh_text_print(out, "</tr></thead><tbody>\n");
  for (int k = 0; k < csv->nrows;) {
    int end = attempt_end(csv, &c, k);
    print_attempt(out, csv, &c, k, end, isfinite(tolerance) ? tolerance : 0);
    k = end;
  }
  gh_text_print(out, "</tbody></table></div>\n");
  return GH_OK;
}

/* ---- time ---- */

static double seconds(const report *r, const char *name) {
  return report_run_number(r, (const char *const[]){"summary", "seconds", name, NULL});
}

static double summary(const report *r, const char *name) {
  return report_run_number(r, (const char *const[]){"summary", name, NULL});
}

static double positive(double v) {
  return v > 0 ? v : 0; /* NAN too */
}

static void draw_wall(report *r) {
  double total = seconds(r, "total"), micro = seconds(r, "micro"), results = positive(seconds(r, "results"));
  report_share parts[] = {{"packings", micro},
                          {"macro problem and the rest", positive(total - micro - results)},
                          {"writing results", results}};
  report_draw_shares(r->out, "The whole run", "s", 3, parts);
}

static void draw_micro(report *r) {
  double relax = positive(seconds(r, "micro_relax")), contacts = positive(seconds(r, "micro_contacts")),
         factorise = positive(seconds(r, "micro_factorise")), set = positive(seconds(r, "micro_set")),
         sum = seconds(r, "micro_sum");
  if (!isfinite(sum)) sum = seconds(r, "micro");
  report_share parts[] = {{"relaxation", relax},
                          {"stiffness and tangent", factorise},
                          {"contact lists", contacts},
                          {"cells and neighbour lists", set},
                          {"rest", positive(sum - relax - contacts - factorise - set)}};
  report_draw_shares(r->out, "The packings, summed over all points", "s", 5, parts);
}

static gh_status draw_increments(report *r) {
  double *x;
  GH_TRY(gh_alloc(r->ctx, 2 * (size_t)r->n, sizeof *x, &x));
  gh_status status = report_seconds(r, x + r->n);
  for (int k = 0; k < r->n; k++) x[k] = k;
  report_chart chart = {.title = "Time of each increment",
                        .x_label = "increment",
                        .y_label = "seconds",
                        .bars = true,
                        .line = NAN,
                        .nseries = 1,
                        .series = {{.n = r->n, .x = x, .y = x + r->n}}};
  if (status == GH_OK) report_draw_chart(r->out, &chart);
  free(x);
  return status;
}

static void tell_counts(const report *r) {
  const double pairs = summary(r, "pair_evaluations"); /* old runs do not tell */
  gh_text_print(r->out, "<p>%.0f evaluations of packings, %.0f relaxation steps, ", summary(r, "evaluations"),
                summary(r, "relaxation_steps"));
  if (isfinite(pairs)) gh_text_print(r->out, "%.0f pair evaluations, ", pairs);
  gh_text_print(r->out, "%.0f factorisations. These counts do not depend on the machine or its load.</p>\n",
                summary(r, "factorisations"));
}

gh_status report_time(report *r) {
  gh_text_print(r->out, "<h2 id=\"time\">Time</h2>\n");
  if (!isfinite(seconds(r, "total")))
    gh_text_print(r->out,
                  "<p>The run has not ended in an orderly way, so run.json does not say where its time went."
                  "</p>\n");
  gh_text_print(r->out, "<div class=\"grid\">\n");
  if (isfinite(seconds(r, "total"))) {
    draw_wall(r);
    draw_micro(r);
  }
  GH_TRY(draw_increments(r));
  gh_text_print(r->out, "</div>\n");
  if (isfinite(summary(r, "evaluations"))) tell_counts(r);
  return GH_OK;
}
