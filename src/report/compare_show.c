/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A comparison as a table for people, as CSV and as a picture. */
#include "report/compare.h"

#include <string.h>

const gh_term_list *gh_comparison_columns(void) {
  static const gh_term terms[] = {
      {"time", "load steps completed, as the first folder has them"},
      {"ux_SET", "displacement of the driven set, where one is driven"},
      {"uy_SET", ""},
      {"NAME", "a reaction `SET_x`, `SET_y`, `dilatancy`, `coordination`, `anisotropy`, a displacement of a "
               "footing: of the first folder"},
      {"NAME_others", "mean of the other folders"},
      {"NAME_scatter", "their standard deviation, from two on"},
      {"NAME_gap", "`NAME` less `NAME_others`; of a reaction in per cent of the largest reaction"},
      {0}};
  static const gh_term_list list[] = {{"granhom compare -o", terms}, {0}};
  return list;
}

const char *compared_unit(const compared *q) {
  return q->kind == COMPARED_REACTION ? "%" : "";
}

/* ---- for people ---- */

static double mean_of(const double *v, int n, bool absolute) {
  double sum = 0;
  for (int k = 0; k < n; k++) sum += absolute ? fabs(v[k]) : v[k];
  return sum / n;
}

static int largest_of(const double *v, int n) {
  int at = 0;
  for (int k = 1; k < n; k++)
    if (fabs(v[k]) > fabs(v[at])) at = k;
  return at;
}

static void print_quantity(const gh_comparison *c, const compared *q, gh_text *out) {
  const int at = largest_of(q->gap, c->rows), last = c->rows - 1;
  const char *unit = compared_unit(q);
  gh_text_print(out, "%-24s %12.5g %12.5g", q->name, q->first[last], q->mean[last]);
  if (q->scatter) {
    const double scale = q->kind == COMPARED_REACTION ? 100 / c->largest : 1;
    gh_text_print(out, " %10.3g%-1s", scale * mean_of(q->scatter, c->rows, false), unit);
  }
  gh_text_print(out, " %10.3g%-1s %10.3g%-1s  %g\n", mean_of(q->gap, c->rows, true), unit, q->gap[at], unit,
                c->time[at]);
}

void gh_comparison_print(const gh_comparison *c, gh_text *out) {
  gh_text_print(out, "%s beside %d other%s: %d increments, to load step %g", c->folder, c->nothers,
                GH_S(c->nothers), c->rows - 1, c->time[c->rows - 1]);
  if (c->shorter) gh_text_print(out, ", where the first of the others ends");
  gh_text_print(out, "\nlargest reaction: %.6g%s%s\n\n", c->largest, *c->labels.force ? " " : "",
                c->labels.force);
  gh_text_print(out, "%-24s %12s %12s", "at the end", "here", "others");
  if (c->nothers > 1) gh_text_print(out, " %11s", "scatter");
  gh_text_print(out, " %11s %11s  %s\n", "mean gap", "largest gap", "at load step");
  for (int k = 0; k < c->n; k++) print_quantity(c, c->quantity + k, out);
}

/* ---- CSV ---- */

void gh_comparison_table(const gh_comparison *c, gh_text *out) {
  gh_text_print(out, "time");
  if (c->curve.driven) gh_text_print(out, ",%s", c->table.name[c->curve.x]);
  for (int i = 0; i < c->n; i++) {
    const char *name = c->quantity[i].name;
    gh_text_print(out, ",%s,%s_others", name, name);
    if (c->quantity[i].scatter) gh_text_print(out, ",%s_scatter", name);
    gh_text_print(out, ",%s_gap", name);
  }
  gh_text_print(out, "\n");
  for (int k = 0; k < c->rows; k++) {
    gh_text_print(out, "%.17g", c->time[k]);
    if (c->curve.driven) gh_text_print(out, ",%s", report_table_text(&c->table, k, c->curve.x));
    for (int i = 0; i < c->n; i++) {
      const compared *q = c->quantity + i;
      gh_text_print(out, ",%.17g,%.17g", q->first[k], q->mean[k]);
      if (q->scatter) gh_text_print(out, ",%.17g", q->scatter[k]);
      gh_text_print(out, ",%.17g", q->gap[k]);
    }
    gh_text_print(out, "\n");
  }
}

/* ---- a picture ---- */

void compared_label(const gh_comparison *c, const compared *q, char text[256]) {
  if (q->kind == COMPARED_REACTION)
    snprintf(text, 256, *c->labels.force ? "%s (%s)" : "%s", q->name, c->labels.force);
  else if (strcmp(q->name, "dilatancy") == 0) snprintf(text, 256, "dilatancy, 100 (v/V - 1) (%%)");
  else if (strcmp(q->name, "coordination") == 0) snprintf(text, 256, "coordination number");
  else snprintf(text, 256, "%s", q->name);
}

/* The reaction that is drawn, and all numbers. */
static bool is_drawn(const gh_comparison *c, int i) {
  return i == c->shown || c->quantity[i].kind == COMPARED_NUMBER;
}

static void write_curves(const gh_comparison *c, int i, gh_text *out) {
  const compared *q = c->quantity + i;
  gh_text_print(out, "$q%d << EOD\n", i);
  for (int k = c->from; k < c->rows; k++) {
    gh_text_print(out, "%.17g %.17g %.17g %.17g", c->x[k], q->first[k], q->mean[k], q->gap[k]);
    for (int j = 0; j < c->nothers; j++) gh_text_print(out, " %.17g", q->other[j * c->rows + k]);
    gh_text_print(out, "\n");
  }
  gh_text_print(out, "EOD\n");
}

static void write_panel(const gh_comparison *c, int i, gh_text *out) {
  char label[256];
  compared_label(c, c->quantity + i, label);
  gh_text_print(out, "set ylabel ");
  gh_picture_string(out, label);
  gh_text_print(out, " noenhanced\nplot ");
  for (int j = 0; j < c->nothers && c->nothers > 1; j++)
    gh_text_print(out, "$q%d using 1:%d with lines lc rgb '#c8c8c8' notitle, ", i, 5 + j);
  gh_text_print(
      out,
      "$q%d using 1:3 with lines lc rgb '#d95f02' lw 1.4 title '%s', $q%d using 1:2 with lines lc rgb "
      "'#31688e' lw 1.6 title ",
      i, c->nothers > 1 ? "mean of the others" : "the other", i);
  gh_picture_string(out, c->folder);
  gh_text_print(out, "\n");
}

static void write_gap(const gh_comparison *c, gh_text *out) {
  gh_text_print(
      out,
      "set ylabel 'gap, %% of the largest reaction' noenhanced\nset xzeroaxis lc rgb '#888888'\nplot $q%d "
      "using 1:4 with lines lc rgb '#31688e' lw 1.6 notitle\nunset xzeroaxis\n",
      c->shown);
}

gh_status gh_comparison_picture(const gh_comparison *c, const char *png) {
  gh_text *out;
  int panels = 1;
  for (int i = 0; i < c->n; i++) panels += is_drawn(c, i);
  const int lines = (panels + 1) / 2;
  GH_TRY(gh_text_create(c->ctx, &out));
  for (int i = 0; i < c->n; i++)
    if (is_drawn(c, i)) write_curves(c, i, out);
  gh_text_print(out, "set key left top\nset multiplot layout %d,2 title ", lines);
  gh_picture_string(out, c->labels.title);
  gh_text_print(out, " noenhanced\nset lmargin 11\nset rmargin 2\nset xlabel ");
  gh_picture_string(out, c->x_label);
  gh_text_print(out, " noenhanced\n");
  write_panel(c, c->shown, out);
  write_gap(c, out);
  for (int i = 0; i < c->n; i++)
    if (c->quantity[i].kind == COMPARED_NUMBER) write_panel(c, i, out);
  gh_text_print(out, "unset multiplot\n");
  gh_status status = gh_text_check(out);
  if (status == GH_OK && png)
    status = gh_picture_script(c->ctx, gh_text_get(out, NULL), 1100, 360 * lines + 40, png);
  gh_text_destroy(&out);
  return status;
}
