/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The run beside others of the same scene: a section of the report. */
#include "report/compare.h"
#include "report/report.h"

#include <stdlib.h>

/* This run, the mean of the others, and with two or more the band of their scatter. */
static gh_status draw_quantity(report *r, const gh_comparison *c, const compared *q) {
  char label[256];
  const int n = c->rows - c->from;
  double *band;
  compared_label(c, q, label);
  GH_TRY(gh_alloc(r->ctx, 2 * (size_t)n, sizeof *band, &band));
  for (int k = 0; k < n && q->scatter; k++) {
    band[k] = q->mean[c->from + k] + q->scatter[c->from + k];
    band[n + k] = q->mean[c->from + k] - q->scatter[c->from + k];
  }
  report_chart chart = {
      .title = label,
      .x_label = c->x_label,
      .y_label = label,
      .first = c->from,
      .line = NAN,
      .nseries = q->scatter ? 4 : 2,
      .series = {{.name = "this run", .n = n, .x = c->x + c->from, .y = q->first + c->from},
                 {.name = "mean of the others", .n = n, .x = c->x + c->from, .y = q->mean + c->from},
                 {.name = "mean + scatter", .n = n, .x = c->x + c->from, .y = band},
                 {.name = "mean - scatter", .n = n, .x = c->x + c->from, .y = band + n}}};
  report_draw_chart(r->out, &chart);
  free(band);
  return GH_OK;
}

static void draw_gaps(report *r, const gh_comparison *c) {
  report_chart chart = {.title = "Gap of the reactions",
                        .x_label = c->x_label,
                        .y_label = "% of the largest reaction",
                        .first = c->from,
                        .line = NAN,
                        .zero = true};
  for (int i = 0; i < c->n && chart.nseries < REPORT_POINTS; i++)
    if (c->quantity[i].kind == COMPARED_REACTION)
      chart.series[chart.nseries++] = (report_series){.name = c->quantity[i].name,
                                                      .n = c->rows - c->from,
                                                      .x = c->x + c->from,
                                                      .y = c->quantity[i].gap + c->from};
  report_draw_chart(r->out, &chart);
}

gh_status report_comparison(report *r) {
  const gh_comparison *c = r->comparison;
  gh_text *table;
  if (!c) return GH_OK;
  gh_text_print(r->out, "<h2 id=\"comparison\">Comparison</h2>\n<div class=\"grid\">\n");
  GH_TRY(draw_quantity(r, c, c->quantity + c->shown));
  draw_gaps(r, c);
  for (int i = 0; i < c->n; i++)
    if (c->quantity[i].kind == COMPARED_NUMBER) GH_TRY(draw_quantity(r, c, c->quantity + i));
  gh_text_print(r->out, "</div>\n<div class=\"scroll\" tabindex=\"0\"><pre>");
  GH_TRY(gh_text_create(r->ctx, &table));
  gh_comparison_print(c, table);
  gh_status status = gh_text_check(table);
  if (status == GH_OK) report_escape(r->out, gh_text_get(table, NULL));
  gh_text_destroy(&table);
  gh_text_print(r->out, "</pre></div>\n");
  return status;
}
