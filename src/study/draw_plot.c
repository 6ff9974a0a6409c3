/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Errors over something, on logarithmic axes. */
#include "study/draw.h"

double study_plot_x_of(const study_plot *p, int k) {
  double number;
  if (p->over == OVER_CORE) return p->s->verdict->row[k].core;
  if (p->over == OVER_COUNT) return study_count_of(p->s, k);
  return gh_parse_number(p->s->configs[k].value[p->parameter], &number) ? number : NAN;
}

double study_plot_y_of(const study_plot *p, int k) {
  double e = study_error_of(p->s, k);
  return e > 0 ? e : p->floor;
}

bool study_plot_drawn(const study_plot *p, int k) {
  return study_is_rated(p->s, k) && study_plot_x_of(p, k) > 0;
}

bool study_plot_begins_curve(const study_plot *p, int k) {
  if (!study_plot_drawn(p, k)) return false;
  for (int j = 0; j < k; j++)
    if (study_plot_drawn(p, j) && study_alike(p->s, j, k, p->parameter)) return false;
  return true;
}

static bool on_front(const study_plot *p, int k) {
  const study_judged *row = p->s->verdict->row + k;
  return study_plot_drawn(p, k) && (p->over == OVER_CORE ? row->pareto : row->pareto_count);
}

void study_plot_measure(study_plot *p) {
  p->x[0] = p->y[0] = INFINITY, p->x[1] = p->y[1] = 0;
  p->points = 0;
  p->floor = study_zero_floor(p->s);
  for (int k = 0; k < p->s->nconfigs; k++) {
    if (!study_plot_drawn(p, k)) continue;
    p->points++;
    p->front = p->front || on_front(p, k);
    p->zeros = p->zeros || study_error_of(p->s, k) == 0;
    p->bars = p->bars || p->s->verdict->row[k].chance[p->s->main] > 0;
    p->x[0] = fmin(p->x[0], study_plot_x_of(p, k)), p->x[1] = fmax(p->x[1], study_plot_x_of(p, k));
    p->y[0] = fmin(p->y[0], study_plot_y_of(p, k)), p->y[1] = fmax(p->y[1], study_plot_y_of(p, k));
    p->bar_end = fmax(p->bar_end, study_plot_y_of(p, k) + fmax(0, p->s->verdict->row[k].chance[p->s->main]));
  }
}

/* A goal that the points come near to is shown. */
static bool goal_shown(const study_plot *p, double goal) {
  return goal > p->y[0] / 4 && goal < p->y[1] * 4;
}

/* ---- data: x, y, low, high ---- */

static void write_point(const study_plot *p, int k, gh_text *t) {
  double y = study_plot_y_of(p, k), chance = p->s->verdict->row[k].chance[p->s->main];
  if (!(chance > 0)) chance = 0;
  gh_text_print(t, "%.17g %.17g %.17g %.17g\n", study_plot_x_of(p, k), y, fmax(y - chance, y * 1e-6),
                y + chance);
}

static void write_curve(const study_plot *p, int first, int number, gh_text *t) {
  gh_text_print(t, "$curve%d << EOD\n", number);
  for (int k = first; k < p->s->nconfigs; k++)
    if (study_plot_drawn(p, k) && study_alike(p->s, k, first, p->parameter)) write_point(p, k, t);
  gh_text_print(t, "EOD\n");
}

static void write_zeros(const study_plot *p, gh_text *t) {
  gh_text_print(t, "$zeros << EOD\n");
  for (int k = 0; k < p->s->nconfigs; k++)
    if (study_plot_drawn(p, k) && study_error_of(p->s, k) == 0) write_point(p, k, t);
  gh_text_print(t, "EOD\n");
}

/* By growing cost; a line for each reference. */
static void write_front(const study_plot *p, gh_text *t) {
  const gh_study *s = p->s;
  gh_text_print(t, "$front << EOD\n");
  for (int first = 0; first < s->nconfigs; first++) {
    if (!study_first_of_reference(s, first)) continue;
    for (int next = first, last = -1; next >= 0; last = next) {
      next = -1;
      for (int k = first; k < s->nconfigs; k++) {
        if (!on_front(p, k) || s->configs[k].reference != s->configs[first].reference) continue;
        if (last >= 0 && study_plot_x_of(p, k) <= study_plot_x_of(p, last)) continue;
        if (next < 0 || study_plot_x_of(p, k) < study_plot_x_of(p, next)) next = k;
      }
      if (next >= 0) write_point(p, next, t);
    }
    gh_text_print(t, "\n");
  }
  gh_text_print(t, "EOD\n");
}

void study_plot_data(const study_plot *p, gh_text *t) {
  for (int k = 0, n = 0; k < p->s->nconfigs; k++)
    if (study_plot_begins_curve(p, k)) write_curve(p, k, n++, t);
  if (p->over != OVER_PARAMETER) write_front(p, t);
  if (p->zeros) write_zeros(p, t);
}

/* ---- commands ---- */

static void write_goals(const study_plot *p, gh_text *t) {
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

void study_plot_axes(study_plot *p, const char *x_label, gh_text *t) {
  double low = p->y[0], high = fmin(p->bar_end, 3 * p->y[1]);
  for (int k = 0; k < p->s->ngoals && p->over != OVER_PARAMETER; k++)
    if (goal_shown(p, p->s->goals[k])) low = fmin(low, p->s->goals[k]), high = fmax(high, p->s->goals[k]);
  study_log_axis(t, 'x', p->x[0], p->x[1], p->x_axis);
  study_log_axis(t, 'y', low, high, p->y_axis);
  gh_text_print(t, "set title ");
  gh_picture_string(t, p->s->title ? p->s->title : "");
  gh_text_print(t, " noenhanced\nset xlabel ");
  gh_picture_string(t, x_label);
  gh_text_print(t, " noenhanced\nset ylabel ");
  char label[2 * STUDY_NAME];
  snprintf(label, sizeof label, "relative error of the %.*s%s", STUDY_NAME, p->s->quantities[p->s->main].name,
           study_has_ensembles(p->s) ? " (mean of packings)" : "");
  gh_picture_string(t, label);
  gh_text_print(t, " noenhanced\n");
  gh_text_print(t, "set key outside right top Left reverse samplen 2 spacing 1.15\n");
  if (p->over != OVER_PARAMETER) write_goals(p, t);
}

/* The name of a curve in the key; over the parameter itself with its order. */
static void write_title(const study_plot *p, int first, gh_text *t) {
  char name[STUDY_NAME], order[80] = "";
  study_legend(p->s, first, p->parameter, name, sizeof name);
  for (int f = 0; p->over == OVER_PARAMETER && f < p->s->verdict->nfits; f++) {
    const struct study_fit *fit = p->s->verdict->fits + f;
    if (!study_alike(p->s, fit->first, first, p->parameter)) continue;
    snprintf(order, sizeof order, "%s%s%s%s", isnan(fit->order) ? "" : "order ",
             isnan(fit->order) ? "" : study_order_word(fit->order).text,
             isnan(fit->order) || fit->monotone ? "" : ", ", fit->monotone ? "" : "not monotone");
  }
  if (!*name && !*order) snprintf(name, sizeof name, "configurations");
  gh_text_print(t, " title ");
  char title[STUDY_NAME + 90];
  snprintf(title, sizeof title, "%s%s%s", name, *name && *order ? ": " : "", order);
  gh_picture_string(t, title);
}

/* First, so that points lie on them. */
static void write_bars(const study_plot *p, gh_text *t) {
  for (int k = 0, n = 0; k < p->s->nconfigs && p->bars; k++)
    if (study_plot_begins_curve(p, k)) {
      gh_text_print(t, "$curve%d using 1:3:(0):($4-$3) with vectors nohead lc rgb '%s' lw 0.7 notitle, ", n,
                    study_colour(n));
      n++;
    }
}

void study_plot_curves(const study_plot *p, gh_text *t) {
  static const int shape[] = {7, 5, 9, 11, 13};
  write_bars(p, t);
  for (int k = 0, n = 0; k < p->s->nconfigs; k++) {
    if (!study_plot_begins_curve(p, k)) continue;
    gh_text_print(t, "%s$curve%d using 1:2%s with linespoints lc rgb '%s' lw 1.1 pt %d ps 1.1", n ? ", " : "",
                  n, p->over == OVER_PARAMETER ? " smooth unique" : "", study_colour(n), shape[n % 5]);
    if (n < STUDY_COLOURS) write_title(p, k, t);
    else gh_text_print(t, n == STUDY_COLOURS ? " title 'others'" : " notitle");
    n++;
  }
  if (p->zeros)
    gh_text_print(t, ", $zeros using 1:2 with points lc rgb '#000000' pt 10 ps 2 title 'error exactly 0'");
}
