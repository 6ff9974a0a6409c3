/* Error over what it costs, and over the knob whose order of convergence is asked for.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include "study/judge.h"

#include <stdlib.h>
#include <string.h>

enum { NAME = 256, WIDTH = 1000, HEIGHT = 600 };

/* Over what the error is drawn. */
typedef enum over { OVER_CORE, OVER_COUNT, OVER_KNOB } over;

typedef struct plot {
  const gh_study *s;
  over over;
  int knob;     /* its values are the points of one curve */
  double floor; /* where zeros are drawn */
  bool zeros, bars;
  double x[2], y[2]; /* ends of the points */
  double bar_end;    /* of the highest bar */
  double x_axis[2], y_axis[2];
  int points, curves;
} plot;

static double x_of(const plot *p, int k) {
  double number;
  if (p->over == OVER_CORE) return p->s->verdict->row[k].core;
  if (p->over == OVER_COUNT) return study_count_of(p->s, k);
  return gh_parse_number(p->s->settings[k].value[p->knob], &number) ? number : NAN;
}

static double y_of(const plot *p, int k) {
  double e = study_error_of(p->s, k);
  return e > 0 ? e : p->floor;
}

static bool drawn(const plot *p, int k) {
  return study_is_rated(p->s, k) && x_of(p, k) > 0;
}

/* The first of the settings of a curve that is drawn. */
static bool begins_curve(const plot *p, int k) {
  if (!drawn(p, k)) return false;
  for (int j = 0; j < k; j++)
    if (drawn(p, j) && study_alike(p->s, j, k, p->knob)) return false;
  return true;
}

static void measure(plot *p) {
  p->x[0] = p->y[0] = INFINITY, p->x[1] = p->y[1] = 0;
  p->points = p->curves = 0;
  p->floor = study_zero_floor(p->s, &p->zeros);
  for (int k = 0; k < p->s->nsettings; k++) {
    if (!drawn(p, k)) continue;
    p->points++;
    p->curves += begins_curve(p, k);
    p->bars = p->bars || p->s->verdict->row[k].chance[p->s->main] > 0;
    p->x[0] = fmin(p->x[0], x_of(p, k)), p->x[1] = fmax(p->x[1], x_of(p, k));
    p->y[0] = fmin(p->y[0], y_of(p, k)), p->y[1] = fmax(p->y[1], y_of(p, k));
    p->bar_end = fmax(p->bar_end, y_of(p, k) + fmax(0, p->s->verdict->row[k].chance[p->s->main]));
  }
}

/* A goal that the points come near to is shown. */
static bool goal_shown(const plot *p, double goal) {
  return goal > p->y[0] / 4 && goal < p->y[1] * 4;
}

/* ---- data: x, y, low, high ---- */

static void write_point(const plot *p, int k, gh_text *t) {
  double y = y_of(p, k), chance = p->s->verdict->row[k].chance[p->s->main];
  if (!(chance > 0)) chance = 0;
  gh_text_print(t, "%.17g %.17g %.17g %.17g\n", x_of(p, k), y, fmax(y - chance, y * 1e-6), y + chance);
}

static void write_curve(const plot *p, int first, int number, gh_text *t) {
  gh_text_print(t, "$curve%d << EOD\n", number);
  for (int k = first; k < p->s->nsettings; k++)
    if (drawn(p, k) && study_alike(p->s, k, first, p->knob)) write_point(p, k, t);
  gh_text_print(t, "EOD\n");
}

static void write_zeros(const plot *p, gh_text *t) {
  gh_text_print(t, "$zeros << EOD\n");
  for (int k = 0; k < p->s->nsettings; k++)
    if (drawn(p, k) && study_error_of(p->s, k) == 0) write_point(p, k, t);
  gh_text_print(t, "EOD\n");
}

static bool on_front(const plot *p, int k) {
  const study_judged *row = p->s->verdict->row + k;
  return drawn(p, k) && (p->over == OVER_CORE ? row->pareto : row->pareto_count);
}

/* By growing cost. */
static void write_front(const plot *p, gh_text *t) {
  int last = -1;
  gh_text_print(t, "$front << EOD\n");
  for (;;) {
    int next = -1;
    for (int k = 0; k < p->s->nsettings; k++) {
      if (!on_front(p, k) || (last >= 0 && x_of(p, k) <= x_of(p, last))) continue;
      if (next < 0 || x_of(p, k) < x_of(p, next)) next = k;
    }
    if (next < 0) break;
    write_point(p, next, t);
    last = next;
  }
  gh_text_print(t, "EOD\n");
}

static void write_data(const plot *p, gh_text *t) {
  for (int k = 0, n = 0; k < p->s->nsettings; k++)
    if (begins_curve(p, k)) write_curve(p, k, n++, t);
  if (p->over != OVER_KNOB) write_front(p, t);
  if (p->zeros) write_zeros(p, t);
}

/* ---- commands ---- */

static void write_goals(const plot *p, gh_text *t) {
  for (int k = 0; k < p->s->ngoals; k++) {
    double goal = p->s->goals[k];
    if (!goal_shown(p, goal)) continue;
    gh_text_print(
        t,
        "set arrow from graph 0, first %.17g to graph 1, first %.17g nohead lc rgb '#c8c8c8' lw 0.8 "
        "dt 2 back\n",
        goal, goal);
    gh_text_print(
        t, "set label '%s' at graph 0.995, first %.17g right offset 0,0.5 tc rgb '#909090' font ',11'\n",
        study_goal_word(goal).text, goal);
  }
}

static void write_axes(plot *p, const char *x_label, gh_text *t) {
  double low = p->y[0], high = fmin(p->bar_end, 3 * p->y[1]);
  for (int k = 0; k < p->s->ngoals && p->over != OVER_KNOB; k++)
    if (goal_shown(p, p->s->goals[k])) low = fmin(low, p->s->goals[k]), high = fmax(high, p->s->goals[k]);
  study_log_axis(t, 'x', p->x[0], p->x[1], p->x_axis);
  study_log_axis(t, 'y', low, high, p->y_axis);
  gh_text_print(t, "set title ");
  study_print_quoted(t, p->s->title ? p->s->title : "");
  gh_text_print(t, " noenhanced\nset xlabel ");
  study_print_quoted(t, x_label);
  gh_text_print(t, " noenhanced\nset ylabel 'relative error of the %s%s' noenhanced\n",
                p->s->quantities[p->s->main].name, study_has_ensembles(p->s) ? " (mean of packings)" : "");
  gh_text_print(t, "set key outside right top Left reverse samplen 2 spacing 1.15\n");
}

/* The name of a curve in the key; over the knob itself with its order. */
static void write_title(const plot *p, int first, gh_text *t) {
  char name[NAME], order[80] = "";
  study_legend(p->s, first, p->knob, name, sizeof name);
  for (int f = 0; p->over == OVER_KNOB && f < p->s->verdict->nfits; f++) {
    const struct study_fit *fit = p->s->verdict->fits + f;
    if (!study_alike(p->s, fit->first, first, p->knob)) continue;
    snprintf(order, sizeof order, "%s%s%s%s", isnan(fit->order) ? "" : "order ",
             isnan(fit->order) ? "" : study_order_word(fit->order).text,
             isnan(fit->order) || fit->monotone ? "" : ", ", fit->monotone ? "" : "not monotone");
  }
  if (!*name && !*order) snprintf(name, sizeof name, "settings");
  gh_text_print(t, " title ");
  char title[NAME + 90];
  snprintf(title, sizeof title, "%s%s%s", name, *name && *order ? ": " : "", order);
  study_print_quoted(t, title);
}

/* First, so that points lie on them. */
static void write_bars(const plot *p, gh_text *t) {
  for (int k = 0, n = 0; k < p->s->nsettings && p->bars; k++)
    if (begins_curve(p, k)) {
      gh_text_print(t, "$curve%d using 1:3:(0):($4-$3) with vectors nohead lc rgb '%s' lw 0.7 notitle, ", n,
                    study_colour(n));
      n++;
    }
}

static void write_curves(const plot *p, gh_text *t) {
  static const int shape[] = {7, 5, 9, 11, 13};
  write_bars(p, t);
  for (int k = 0, n = 0; k < p->s->nsettings; k++) {
    if (!begins_curve(p, k)) continue;
    gh_text_print(t, "%s$curve%d using 1:2 with linespoints lc rgb '%s' lw 1.1 pt %d ps 1.1", n ? ", " : "",
                  n, study_colour(n), shape[n % 5]);
    if (n < STUDY_COLOURS) write_title(p, k, t);
    else gh_text_print(t, n == STUDY_COLOURS ? " title 'others'" : " notitle");
    n++;
  }
  if (p->zeros)
    gh_text_print(t, ", $zeros using 1:2 with points lc rgb '#000000' pt 10 ps 2 title 'error exactly 0'");
}

/* ---- names of points, where there is room ---- */

/* A box in shares of the drawing area. */
typedef struct box {
  double x[2], y[2];
} box;

/* About what the margins and the key leave of the picture, and the size of a letter in it. */
static const double LETTER_WIDTH = 6.8 / 520, LETTER_HEIGHT = 12.0 / 470, POINT = 5.0 / 520;

static bool overlaps(const box *a, const box *b) {
  return a->x[0] < b->x[1] && b->x[0] < a->x[1] && a->y[0] < b->y[1] && b->y[0] < a->y[1];
}

static double share(const double axis[2], double v) {
  return log(v / axis[0]) / log(axis[1] / axis[0]);
}

static bool is_free(const box *b, const box *taken, int n) {
  if (b->x[0] < 0 || b->x[1] > 1.05 || b->y[0] < 0 || b->y[1] > 1) return false;
  for (int k = 0; k < n; k++)
    if (overlaps(b, taken + k)) return false;
  return true;
}

/* Beside the point, above or below, to the right or the left: the first place that nothing covers yet. */
static bool place_label(const plot *p, int k, int letters, const box *taken, int n, int *side, box *b) {
  double x = share(p->x_axis, x_of(p, k)), y = share(p->y_axis, y_of(p, k)), width = letters * LETTER_WIDTH;
  for (*side = 0; *side < 4; ++*side) {
    double sign = *side % 2 ? -1 : 1, middle = y + (*side < 2 ? 1 : -1) * LETTER_HEIGHT;
    double near = x + 2 * sign * POINT, far = near + sign * width;
    *b = (box){{fmin(near, far), fmax(near, far)},
               {middle - 0.55 * LETTER_HEIGHT, middle + 0.55 * LETTER_HEIGHT}};
    if (is_free(b, taken, n)) return true;
  }
  return false;
}

static gh_status label_points(const plot *p, gh_text *t) {
  box *taken;
  int n = 0, side;
  GH_TRY(gh_alloc(p->s->ctx, 2 * (size_t)p->points, sizeof *taken, &taken));
  for (int k = 0; k < p->s->nsettings; k++) {
    if (!drawn(p, k)) continue;
    double x = share(p->x_axis, x_of(p, k)), y = share(p->y_axis, y_of(p, k));
    taken[n++] = (box){{x - POINT, x + POINT}, {y - POINT, y + POINT}};
  }
  for (int first = 0, curve = 0; first < p->s->nsettings; first++) {
    if (!begins_curve(p, first)) continue;
    for (int k = first; k < p->s->nsettings; k++) {
      char text[NAME];
      if (!drawn(p, k) || !study_alike(p->s, k, first, p->knob)) continue;
      study_short_value(p->s, k, p->knob, text, sizeof text);
      if (!place_label(p, k, (int)strlen(text), taken, n, &side, taken + n)) continue;
      n++;
      gh_text_print(t, "set label ");
      study_print_quoted(t, text);
      gh_text_print(t, " at %.17g,%.17g %s offset %s,%s font ',10' tc rgb '%s' noenhanced front\n",
                    x_of(p, k), y_of(p, k), side % 2 ? "right" : "left", side % 2 ? "-0.8" : "0.8",
                    side < 2 ? "0.6" : "-0.6", study_colour(curve));
    }
    curve++;
  }
  free(taken);
  return GH_OK;
}

static gh_status draw_over(const gh_study *s, const char *folder, over over, const char *x_label,
                           const char *file) {
  plot p = {.s = s, .over = over, .knob = s->series};
  gh_text *t;
  measure(&p);
  if (p.points == 0) return GH_OK;
  GH_TRY(gh_text_create(s->ctx, &t));
  write_axes(&p, x_label, t);
  write_goals(&p, t);
  write_data(&p, t);
  gh_status status = label_points(&p, t);
  gh_text_print(t, "plot ");
  write_curves(&p, t);
  gh_text_print(t,
                ", $front using 1:2 with steps lc rgb '#555555' lw 0.7 notitle, $front using 1:2 with points "
                "lc rgb '#222222' lw 0.8 pt 6 ps 2.2 title 'Pareto front'");
  if (s->nknobs > 0) {
    gh_text_print(t, ", NaN with points lc rgb '#ffffff' pt 0 title ");
    char text[NAME];
    snprintf(text, sizeof text, "labels: %s", s->knobs[s->series].name);
    study_print_quoted(t, text);
  }
  gh_text_print(t, "\n");
  if (status == GH_OK) status = study_picture(s, folder, file, WIDTH, HEIGHT, t);
  gh_text_destroy(&t);
  return status;
}

gh_status study_draw_precision(const gh_study *s, const char *folder) {
  char label[NAME];
  const char *each = study_has_ensembles(s) ? ", mean of the packings" : "";
  snprintf(label, sizeof label, "seconds of one core%s", each);
  GH_TRY(draw_over(s, folder, OVER_CORE, label, "work-precision.png"));
  if (study_counts(s) == STUDY_NOTHING) return GH_OK;
  snprintf(label, sizeof label, "%s%s", study_count_name(study_counts(s)), each);
  return draw_over(s, folder, OVER_COUNT, label, "work-precision-count.png");
}

/* ---- order.png ---- */

/* Dashed lines of order 1 and 2 below the coarsest point, each with its name where it leaves the picture. */
static void write_slopes(const plot *p, gh_text *t) {
  bool grows = p->s->verdict->grows;
  double x0 = grows ? INFINITY : 0, y0 = 0;
  for (int k = 0; k < p->s->nsettings; k++) {
    if (!drawn(p, k) || study_error_of(p->s, k) == 0) continue;
    double x = x_of(p, k), y = y_of(p, k);
    if (grows ? x < x0 : x > x0) x0 = x, y0 = y;
    else if (x == x0) y0 = fmin(y0, y);
  }
  if (!(y0 > 0)) return;
  y0 /= 2.5;
  for (int order = 1; order <= 2; order++) {
    /* to the fine end of the axis, or to the lower one */
    double far = grows ? p->x_axis[1] : p->x_axis[0], most = fabs(log(far / x0)),
           down = log(y0 / p->y_axis[0]);
    double length = fmin(most, down / order);
    if (!(length > 0)) continue;
    double x1 = x0 * exp(grows ? length : -length), y1 = y0 * exp(-order * length);
    gh_text_print(t, "set arrow from %.17g,%.17g to %.17g,%.17g nohead lc rgb '#a0a0a0' lw 0.8 dt 2 back\n",
                  x0, y0, x1, y1);
    gh_text_print(t, "set label 'order %d' at %.17g,%.17g %s offset %s,0.3 tc rgb '#808080' font ',11'\n",
                  order, x0 * exp((grows ? 0.85 : -0.85) * length), y0 * exp(-0.85 * order * length),
                  grows ? "left" : "right", grows ? "0.8" : "-0.8");
  }
}

/* The values themselves as marks where there are few. */
static void write_knob_marks(const plot *p, gh_text *t) {
  const study_knob *knob = p->s->knobs + p->knob;
  const char *comma = "";
  if (knob->nvalues > 12) return;
  gh_text_print(t, "set xtics (");
  for (int v = 0; v < knob->nvalues; v++) {
    if (!(knob->number[v] > 0)) continue;
    gh_text_print(t, "%s", comma);
    study_print_quoted(t, knob->value[v]);
    gh_text_print(t, " %.17g", knob->number[v]);
    comma = ", ";
  }
  gh_text_print(t, ") noenhanced\n");
}

gh_status study_draw_order(const gh_study *s, const char *folder) {
  plot p = {.s = s, .over = OVER_KNOB, .knob = s->order};
  gh_text *t;
  measure(&p);
  if (p.points == 0) return GH_OK;
  GH_TRY(gh_text_create(s->ctx, &t));
  write_axes(&p, s->knobs[s->order].name, t);
  write_knob_marks(&p, t);
  write_slopes(&p, t);
  write_data(&p, t);
  gh_text_print(t, "plot ");
  write_curves(&p, t);
  gh_text_print(t, "\n");
  gh_status status = study_picture(s, folder, "order.png", WIDTH, HEIGHT, t);
  gh_text_destroy(&t);
  return status;
}
