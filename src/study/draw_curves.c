/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Columns over t, one curve for each configuration, with the scatter of the packings. */
#include "study/draw.h"

#include <stdlib.h>
#include <string.h>

/* Pixels, but for the number of bars on a curve. COLUMN: from an axis to its name; FOOT: numbers and name of
 * the lowest axes of t. */
enum {
  BARS = 15,
  BAR = 5,
  LEFT = 105,
  RIGHT = 20,
  TOP = 45,
  BETWEEN = 108,
  COLUMN = 89,
  NUMBERS = 35,
  FOOT = 70,
  ROW_NAME = 30,
  EDGE = 10
};

/* Panels: `across` plots stand side by side in each row; what is left of the plots stands below all rows, in
 * rows again. */
typedef struct figure {
  const gh_study *s;
  study_rows rows;
  study_key key;
  int across, bands, panel_width, panel_height, width, height;
  int curves;     /* most curves of a panel */
  double t[2];    /* ends of all curves */
  double (*y)[2]; /* nplots: ends of all curves with their bars */
} figure;

/* ---- data ---- */

static void range_include(double range[2], double low, double high) {
  range[0] = fmin(range[0], low), range[1] = fmax(range[1], high);
}

/* t, then mean and standard deviation of each plotted column. */
static void write_curve(figure *f, int k, gh_text *t) {
  const gh_study *s = f->s;
  const study_curve *first = study_first_curve(s->configs + k);
  gh_text_print(t, "$curve%d << EOD\n", k);
  for (int row = 0; row < first->n; row++) {
    if (study_members_at(s, s->configs + k, first->t[row], 0).n == 0) continue;
    gh_text_print(t, "%.17g", first->t[row]);
    for (int c = 0; c < s->nplots; c++) {
      study_sample x = study_members_at(s, s->configs + k, first->t[row], s->plots[c]);
      gh_text_print(t, " %.17g %.17g", x.mean, x.deviation);
      range_include(f->y[c], x.mean - x.deviation, x.mean + x.deviation);
    }
    gh_text_print(t, "\n");
  }
  gh_text_print(t, "EOD\n");
  range_include(f->t, first->t[0], first->t[first->n - 1]);
}

static void write_given(figure *f, gh_text *t) {
  const gh_study *s = f->s;
  gh_text_print(t, "$given << EOD\n");
  for (int row = 0; row < s->given.n; row++) {
    gh_text_print(t, "%.17g", s->given.t[row]);
    for (int c = 0; c < s->nplots; c++) {
      double v = s->given.value[row * s->ncolumns + s->plots[c]];
      gh_text_print(t, " %.17g 0", v);
      if (isfinite(v)) range_include(f->y[c], v, v);
    }
    gh_text_print(t, "\n");
  }
  gh_text_print(t, "EOD\n");
}

static void write_data(figure *f, gh_text *t) {
  study_line line;
  f->t[0] = INFINITY, f->t[1] = -INFINITY;
  for (int c = 0; c < f->s->nplots; c++) f->y[c][0] = INFINITY, f->y[c][1] = -INFINITY;
  for (int k = 0; k < f->s->nconfigs; k++)
    if (f->rows.group[k] >= 0 || k == f->rows.extra) write_curve(f, k, t);
  if (study_rows_given(&f->rows, &line)) write_given(f, t);
}

/* ---- curves of a panel ---- */

/* Of the line between two rows of a curve, at t: mean and deviation of each plotted column. */
static void write_bar(const figure *f, int k, double t, gh_text *out) {
  const study_config *g = f->s->configs + k;
  const study_curve *c = study_first_curve(g);
  int row = 0;
  while (row < c->n - 2 && c->t[row + 1] < t) row++;
  double a = c->t[row], b = c->t[row + 1], share = b > a ? (t - a) / (b - a) : 0;
  if (study_members_at(f->s, g, a, 0).n == 0 || study_members_at(f->s, g, b, 0).n == 0) return;
  gh_text_print(out, "%.17g", t);
  for (int plot = 0; plot < f->s->nplots; plot++) {
    study_sample x = study_members_at(f->s, g, a, f->s->plots[plot]),
                 y = study_members_at(f->s, g, b, f->s->plots[plot]);
    gh_text_print(out, " %.17g %.17g", x.mean + share * (y.mean - x.mean),
                  x.deviation + share * (y.deviation - x.deviation));
  }
  gh_text_print(out, "\n");
}

static bool has_bars(const figure *f, int k) {
  return f->s->verdict->row[k].members > 1 && study_first_curve(f->s->configs + k)->n > 1;
}

/* Some bars on each curve, back from its end; those of different curves stand beside each other, so that they
 * do not hide each other. */
static void write_bar_data(const figure *f, int row, gh_text *t) {
  int most = f->panel_width / (BAR * (f->curves + 1)), number = 0;
  study_line line;
  if (most > BARS) most = BARS;
  if (most < 4) most = 4;
  for (int k = 0; k < f->s->nconfigs; k++) {
    if (!study_rows_line(&f->rows, row, k, &line)) continue;
    const study_curve *c = study_first_curve(f->s->configs + k);
    double beside = 0.8 * number++ / f->curves;
    if (!has_bars(f, k)) continue;
    int every = (c->n + most - 1) / most, bars = (c->n - 1) / every;
    double between = every * (c->t[c->n - 1] - c->t[0]) / (c->n - 1);
    gh_text_print(t, "$bars%d_%d << EOD\n", row, k);
    for (int bar = 0; bar < bars; bar++) write_bar(f, k, c->t[c->n - 1] - between * (bar + beside), t);
    gh_text_print(t, "EOD\n");
  }
}

/* Before the lines, which lie on them. */
static void write_bars(const figure *f, int row, int plot, gh_text *t) {
  const int mean = 2 + 2 * plot, deviation = mean + 1;
  study_line line;
  for (int k = 0; k < f->s->nconfigs; k++)
    if (study_rows_line(&f->rows, row, k, &line) && has_bars(f, k))
      gh_text_print(
          t, "$bars%d_%d using 1:($%d-$%d):(0):(2*$%d) with vectors nohead lc rgb '%s' lw 0.8 notitle, ", row,
          k, mean, deviation, deviation, line.colour);
}

static void write_lines(const figure *f, int row, int plot, gh_text *t) {
  const char *comma = "";
  study_line line;
  for (int k = 0; k < f->s->nconfigs; k++) {
    if (!study_rows_line(&f->rows, row, k, &line)) continue;
    gh_text_print(t, "%s$curve%d using 1:%d with lines lc rgb '%s' lw %g dt %d notitle", comma, k,
                  2 + 2 * plot, line.colour, line.width, line.dash);
    comma = ", ";
  }
  if (study_rows_given(&f->rows, &line))
    gh_text_print(t, "%s$given using 1:%d with lines lc rgb '%s' lw %g dt %d notitle", comma, 2 + 2 * plot,
                  line.colour, line.width, line.dash);
  gh_text_print(t, "\n");
}

static void count_curves(figure *f) {
  study_line line;
  for (int row = 0; row < study_rows_count(&f->rows); row++) {
    int n = 0;
    for (int k = 0; k < f->s->nconfigs; k++) n += study_rows_line(&f->rows, row, k, &line);
    if (n > f->curves) f->curves = n;
  }
}

/* ---- panels ---- */

/* "P11 (N/mm)": a column with its unit. */
static void column_name(const gh_study *s, const char *column, char name[2 * STUDY_NAME]) {
  const char *force = s->force_unit ? s->force_unit : "", *length = s->length_unit ? s->length_unit : "";
  char unit[STUDY_NAME] = "";
  bool is_force = strncmp(column, "force", 5) == 0;
  if (strcmp(column, "dilatancy") == 0) snprintf(unit, sizeof unit, " (%%)");
  else if (is_force && *force) snprintf(unit, sizeof unit, " (%.100s)", force);
  else if (!is_force && *force && *length) snprintf(unit, sizeof unit, " (%.100s/%.100s)", force, length);
  snprintf(name, 2 * STUDY_NAME, "%.*s%s", STUDY_NAME - 1, column, unit);
}

/* Panels have room for their name above and for the numbers below. */
static int figure_pitch(const figure *f) {
  return f->panel_height + (f->rows.grouped ? ROW_NAME : 0) + NUMBERS;
}

/* Left and upper edge of a panel in pixels from the left and the top. */
static void figure_place(const figure *f, int row, int plot, int *left, int *top) {
  int line = plot / f->across * study_rows_count(&f->rows) + row;
  *left = LEFT + plot % f->across * (f->panel_width + BETWEEN);
  *top = TOP + line * figure_pitch(f) + (f->rows.grouped ? ROW_NAME : 0);
}

static void write_frame(const figure *f, int row, int plot, gh_text *t) {
  int left, top;
  const double w = f->width, h = f->height, *y = f->y[plot];
  double pad = y[1] > y[0] ? 0.04 * (y[1] - y[0]) : fmax(fabs(y[1]), 1e-300);
  bool lowest = row == study_rows_count(&f->rows) - 1 && plot + f->across >= f->s->nplots;
  figure_place(f, row, plot, &left, &top);
  gh_text_print(t, "set lmargin at screen %.5f\nset rmargin at screen %.5f\n", left / w,
                (left + f->panel_width) / w);
  gh_text_print(t, "set bmargin at screen %.5f\nset tmargin at screen %.5f\n",
                1 - (top + f->panel_height) / h, 1 - top / h);
  if (y[1] >= y[0]) gh_text_print(t, "set yrange [%.17g:%.17g]\n", y[0] - pad, y[1] + pad);
  if (lowest)
    gh_text_print(t, "set xlabel '%s' noenhanced\n", f->s->scene ? "t (load steps)" : "t (rows of the path)");
  else gh_text_print(t, "unset xlabel\n");
}

/* Of the axis of a panel: gnuplot would put it as far away as the numbers are long. */
static void write_column(const figure *f, int row, int plot, gh_text *t) {
  int left, top;
  char name[2 * STUDY_NAME];
  figure_place(f, row, plot, &left, &top);
  column_name(f->s, f->s->column[f->s->plots[plot]], name);
  gh_text_print(t, "set label ");
  gh_picture_string(t, name);
  gh_text_print(t, " at screen %.5f, screen %.5f center rotate by 90 noenhanced\n",
                (left - COLUMN) / (double)f->width, 1 - (top + f->panel_height / 2) / (double)f->height);
}

/* Above the first panel of a row. */
static void write_name(const figure *f, int row, int plot, gh_text *t) {
  char name[STUDY_NAME];
  int left, top;
  study_rows_name(&f->rows, row, name);
  if (!*name || plot % f->across != 0) return;
  figure_place(f, row, plot, &left, &top);
  gh_text_print(t, "set label ");
  gh_picture_string(t, name);
  gh_text_print(t, " at screen %.5f, screen %.5f left noenhanced font ':Bold'\n", left / (double)f->width,
                1 - (top - 14) / (double)f->height);
}

static void write_panels(const figure *f, gh_text *t) {
  gh_text_print(t, "set multiplot\nunset key\n");
  if (f->t[1] > f->t[0]) gh_text_print(t, "set xrange [%.17g:%.17g]\n", f->t[0], f->t[1]);
  gh_text_print(t, "set label ");
  gh_picture_string(t, f->s->title ? f->s->title : "");
  gh_text_print(t, " at screen 0.5, screen %.5f center noenhanced\n", 1 - 18.0 / f->height);
  study_key_print(&f->key, EDGE, f->width, f->height, t);
  for (int plot = 0; plot < f->s->nplots; plot++)
    for (int row = 0; row < study_rows_count(&f->rows); row++) {
      write_name(f, row, plot, t);
      write_column(f, row, plot, t);
      write_frame(f, row, plot, t);
      gh_text_print(t, "plot ");
      write_bars(f, row, plot, t);
      write_lines(f, row, plot, t);
      gh_text_print(t, "unset label\nunset arrow\n"); /* title, key and names are there once */
    }
  gh_text_print(t, "unset multiplot\n");
}

/* ---- the picture ---- */

/* Up to four panels side by side where rows are compared, else two of more than three. */
static void size_panels(figure *f) {
  static const int widths[] = {0, 900, 445, 360, 285};
  int n = f->s->nplots, most = f->rows.grouped ? 4 : n > 3 ? 2 : 1;
  f->bands = (n + most - 1) / most;
  f->across = (n + f->bands - 1) / f->bands;
  f->panel_width = widths[f->across];
  f->panel_height = f->rows.grouped ? 230 : 290;
  f->width = LEFT + f->across * (f->panel_width + BETWEEN) - BETWEEN + RIGHT;
}

static gh_status lay_out(figure *f, gh_text *t) {
  if (f->rows.ngroups == 0) return GH_OK;
  GH_TRY(gh_alloc(f->s->ctx, (size_t)f->s->nplots, sizeof *f->y, &f->y));
  size_panels(f);
  count_curves(f);
  study_key_plan(&f->rows, LEFT, f->width - LEFT - RIGHT, &f->key);
  f->height = TOP + f->bands * study_rows_count(&f->rows) * figure_pitch(f) - NUMBERS + FOOT +
              study_key_height(&f->key) + EDGE;
  write_data(f, t);
  for (int row = 0; row < study_rows_count(&f->rows); row++) write_bar_data(f, row, t);
  write_panels(f, t);
  return GH_OK;
}

gh_status study_curves_script(const gh_study *s, gh_text *t, int *width, int *height) {
  figure f = {.s = s};
  gh_status status = study_rows_plan(s, &f.rows);
  if (status == GH_OK) status = lay_out(&f, t);
  study_rows_free(&f.rows);
  free(f.y);
  *width = f.width, *height = f.height;
  return status;
}

gh_status study_draw_curves(const gh_study *s, const char *folder) {
  gh_text *t;
  int width, height;
  GH_TRY(gh_text_create(s->ctx, &t));
  gh_status status = study_curves_script(s, t, &width, &height);
  if (status == GH_OK && width > 0) status = study_picture(s, folder, "curves.png", width, height, t);
  gh_text_destroy(&t);
  return status;
}
