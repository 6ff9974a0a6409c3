/* What the pictures of a study share. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_STUDY_DRAW_H
#define GRANHOM_STUDY_DRAW_H

#include "study/judge.h"

/* ---- draw_axis.c: what the pictures share ---- */

enum { STUDY_COLOURS = 12, STUDY_NAME = 256 };
const char *study_colour(int k); /* grey beyond STUDY_COLOURS */
void study_print_quoted(gh_text *out, const char *text);
/* A logarithmic axis ('x' or 'y') from low to high, a little wider, with marks that have labels also where it
 * is shorter than a decade. Returns the ends in range. */
void study_log_axis(gh_text *out, char axis, double low, double high, double range[2]);
/* Draws the commands into folder/name. */
gh_status study_picture(const gh_study *s, const char *folder, const char *name, int width, int height,
                        gh_text *commands);
/* Where errors that are exactly zero are drawn: a tenth of the smallest other one, or 1e-16. */
double study_zero_floor(const gh_study *s);
gh_status study_draw_precision(const gh_study *s, const char *folder);
gh_status study_draw_order(const gh_study *s, const char *folder);
gh_status study_draw_curves(const gh_study *s, const char *folder);

/* ---- draw_plot.c: errors over something ---- */

enum { STUDY_PLOT_WIDTH = 1000, STUDY_PLOT_HEIGHT = 600 };

/* Over what the error is drawn. */
typedef enum study_over { OVER_CORE, OVER_COUNT, OVER_KNOB } study_over;

typedef struct study_plot {
  const gh_study *s;
  study_over over;
  int knob;                /* its values are the points of one curve */
  double floor;            /* where zeros are drawn */
  bool zeros, bars, front; /* there are some */
  double x[2], y[2];       /* ends of the points */
  double bar_end;          /* of the highest bar */
  double x_axis[2], y_axis[2];
  int points;
} study_plot;

double study_plot_x_of(const study_plot *p, int setting);
double study_plot_y_of(const study_plot *p, int setting);
bool study_plot_drawn(const study_plot *p, int setting);
/* It is the first of the settings of a curve that is drawn. */
bool study_plot_begins_curve(const study_plot *p, int setting);
/* Finds the ends, the number of points, floor, zeros and bars. */
void study_plot_measure(study_plot *p);
void study_plot_axes(study_plot *p, const char *x_label, gh_text *t);
void study_plot_data(const study_plot *p, gh_text *t);
/* What stands behind `plot`: bars, curves, zeros. */
void study_plot_curves(const study_plot *p, gh_text *t);

/* ---- draw_labels.c ---- */

/* Each point's value of the knob beside it where there is room; after the axes. */
gh_status study_plot_labels(const study_plot *p, gh_text *t);

#endif
