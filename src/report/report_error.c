/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a run knows of its error, over increments and over time. */
#include "report/report.h"

#include <stdlib.h>

static double error(const report *r, const char *name) {
  return report_run_number(r, (const char *const[]){"error", name, NULL});
}

static double estimate(const report *r, const char *name) {
  return report_run_number(r, (const char *const[]){"error", "estimate", name, NULL});
}

gh_status report_seconds(report *r, double *seconds) {
  report_table t = {0};
  char *path = gh_path_join(r->folder, "timing.csv");
  if (!path) return gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
  bool there = false;
  gh_status status = gh_file_there(r->ctx, path, &there);
  free(path);
  if (there) status = report_table_read(r->ctx, r->folder, "timing.csv", &t);
  const int column = there && status == GH_OK ? report_table_column(&t, "seconds") : -1;
  for (int k = 0; k < r->n; k++)
    seconds[k] = column >= 0 && k < t.nrows ? report_table_number(&t, k, column) : NAN;
  report_table_free(&t);
  return status;
}

/* Four columns, r->n each, behind the increments and the seconds up to their ends. */
enum { ESTIMATES = 4 };
static const char *const columns[ESTIMATES] = {"estimate", "estimate_largest", "estimate_displacement",
                                               "estimate_force"};
static const char *const names[ESTIMATES] = {"stress, root mean square", "stress, largest of a point",
                                             "displacement", "force"};

typedef struct errors {
  double *increment, *seconds, *defect, *branch, *estimate[ESTIMATES],
      *memory; /* branch: by how much, else NAN */
  bool estimated;
} errors;

static gh_status take(report *r, errors *e) {
  const size_t n = (size_t)r->n;
  double sum = 0;
  GH_TRY(gh_alloc(r->ctx, (4 + ESTIMATES) * n, sizeof *e->memory, &e->memory));
  e->increment = e->memory, e->seconds = e->memory + n, e->defect = e->memory + 2 * n;
  e->branch = e->memory + 3 * n;
  for (int j = 0; j < ESTIMATES; j++) e->estimate[j] = e->memory + (4 + (size_t)j) * n;
  GH_TRY(report_seconds(r, e->seconds));
  for (int k = 0; k < r->n; k++) {
    e->increment[k] = k;
    e->seconds[k] = sum += e->seconds[k];
    e->defect[k] = report_history(r, k, "energy_defect");
    e->branch[k] = report_history(r, k, "branched") > 0 ? report_history(r, k, "estimate_growth") : NAN;
    for (int j = 0; j < ESTIMATES; j++) e->estimate[j][k] = report_history(r, k, columns[j]);
  }
  e->estimated = report_table_column(&r->history, columns[0]) >= 0;
  return GH_OK;
}

static void draw_defect(report *r, const errors *e) {
  report_chart chart = {.title = "Energy imbalance",
                        .x_label = "increment",
                        .y_label = "over the largest work so far",
                        .line = NAN,
                        .zero = true,
                        .nseries = 1,
                        .series = {{.n = r->n, .x = e->increment, .y = e->defect}}};
  report_draw_chart(r->out, &chart);
}

static const char branch_name[] = "stresses part: the path branches";

static void draw_estimates(report *r, const errors *e) {
  report_chart chart = {.title = "Estimated error at each increment",
                        .x_label = "increment",
                        .y_label = "over the largest value so far",
                        .log_y = true,
                        .line = NAN,
                        .nseries = ESTIMATES + 1};
  for (int j = 0; j < ESTIMATES; j++)
    chart.series[j] = (report_series){.name = names[j], .n = r->n, .x = e->increment, .y = e->estimate[j]};
  chart.series[ESTIMATES] =
      (report_series){.name = branch_name, .n = r->n, .x = e->increment, .y = e->branch};
  report_draw_chart(r->out, &chart);
}

static void draw_time(report *r, const errors *e) {
  report_chart chart = {.title = "Estimated error of the stress",
                        .x_label = "seconds of solving, both paths",
                        .y_label = "root mean square over the points",
                        .log_y = true,
                        .line = NAN,
                        .nseries = 2,
                        .series = {{.name = "estimate", .n = r->n, .x = e->seconds, .y = e->estimate[0]},
                                   {.name = branch_name, .n = r->n, .x = e->seconds, .y = e->branch}}};
  report_draw_chart(r->out, &chart);
}

static void tell_defects(report *r) {
  if (!isfinite(error(r, "energy_defect"))) {
    gh_text_print(r->out, "<p>run.json does not say what this run knows of its error: it has not ended in an "
                          "orderly way, or is of an older version.</p>\n");
    return;
  }
  gh_text_print(
      r->out,
      "<p>Residuals of all converged substeps: at most %.1e of the forces (body) and %.1e of the mean "
      "contact force (packings). Energy imbalance at the end %.1e: the work of the stress on the "
      "deformation, by the trapezoidal rule, less what the packings have stored and dissipated, over "
      "the largest work. A smooth path leaves the error of the sums there, of second order in the "
      "increments (of first with friction); what stays with finer increments is energy that packings "
      "lost when their grains rearranged. External and internal work differ by %.1e",
      error(r, "residual"), error(r, "micro_residual"), error(r, "energy_defect"), error(r, "work_defect"));
  if (error(r, "freed_in_jumps") != 0)
    gh_text_print(r->out, ", apart from an energy of %.3g that was released at instabilities",
                  error(r, "freed_in_jumps"));
  gh_text_print(r->out, ".</p>\n");
}

static void tell_estimate(report *r, const errors *e) {
  const double branched = estimate(r, "branched_increments");
  if (!e->estimated) {
    gh_text_print(r->out, "<p>The run has made no estimate of the error of its path; <code>granhom run "
                          "--estimate-error</code> makes one, for about three times the time.</p>\n");
    return;
  }
  if (!isfinite(branched)) return;
  gh_text_print(
      r->out,
      "<p>Estimate by step doubling, largest of all increments: stress %.2g (at one point %.2g), "
      "displacement %.2g, force %.2g, each over its largest value; %.1f s were spent on the halves. ",
      estimate(r, "stress_l2"), estimate(r, "stress_largest"), estimate(r, "displacement"),
      estimate(r, "force"), estimate(r, "extra_seconds"));
  if (branched > 0)
    gh_text_print(
        r->out,
        "The path branches in %.0f of %.0f increments (the stresses part by up to %.2g): there it is "
        "one of several, and the estimate holds for the pieces between.",
        branched, estimate(r, "increments"), estimate(r, "largest_branch"));
  else gh_text_print(r->out, "The path branches nowhere.");
  gh_text_print(r->out, "</p>\n");
}

gh_status report_error(report *r) {
  errors e = {0};
  gh_text_print(r->out, "<h2 id=\"error\">Error against run time</h2>\n");
  gh_status status = take(r, &e);
  if (status == GH_OK) {
    tell_defects(r);
    tell_estimate(r, &e);
    gh_text_print(r->out, "<div class=\"grid\">\n");
    if (report_table_column(&r->history, "energy_defect") >= 0) draw_defect(r, &e);
    if (e.estimated) {
      draw_estimates(r, &e);
      draw_time(r, &e);
    }
    gh_text_print(r->out, "</div>\n");
  }
  free(e.memory);
  return status;
}
