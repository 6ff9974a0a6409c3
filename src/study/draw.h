/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the pictures of a study share. */
#ifndef GRANHOM_STUDY_DRAW_H
#define GRANHOM_STUDY_DRAW_H

#include "study/judge.h"

/* ---- draw_axis.c: what the pictures share ---- */

enum { STUDY_COLOURS = 12, STUDY_NAME = 256 };
const char *study_colour(int k); /* grey beyond STUDY_COLOURS */
/* A logarithmic axis ('x' or 'y') from low to high, a little wider, with marks that have labels also where it
 * is shorter than a decade. Returns the ends in range. */
void study_log_axis(gh_text *out, char axis, double low, double high, double range[2]);
/* Draws the commands into folder/name. */
gh_status study_picture(const gh_study *s, const char *folder, const char *name, int width, int height,
                        gh_text *commands);
/* Where errors that are exactly zero are drawn: a tenth of the smallest other one, or 1e-16. */
double study_zero_floor(const gh_study *s);

/* ---- draw_precision.c, draw_order.c, draw_curves.c ---- */

gh_status study_draw_precision(const gh_study *s, const char *folder);
gh_status study_draw_order(const gh_study *s, const char *folder);
gh_status study_draw_curves(const gh_study *s, const char *folder);

/* ---- draw_plot.c: errors over something ---- */

enum { STUDY_PLOT_WIDTH = 1000, STUDY_PLOT_HEIGHT = 600 };

/* Over what the error is drawn. */
typedef enum study_over { OVER_CORE, OVER_COUNT, OVER_PARAMETER } study_over;

typedef struct study_plot {
  const gh_study *s;
  study_over over;
  int parameter;           /* its values are the points of one curve */
  double floor;            /* where zeros are drawn */
  bool zeros, bars, front; /* there are some */
  double x[2], y[2];       /* ends of the points */
  double bar_end;          /* of the highest bar */
  double x_axis[2], y_axis[2];
  int points;
} study_plot;

double study_plot_x_of(const study_plot *p, int config);
double study_plot_y_of(const study_plot *p, int config);
bool study_plot_drawn(const study_plot *p, int config);
/* It is the first of the configurations of a curve that is drawn. */
bool study_plot_begins_curve(const study_plot *p, int config);
/* Finds the ends, the number of points, floor, zeros and bars. */
void study_plot_measure(study_plot *p);
void study_plot_axes(study_plot *p, const char *x_label, gh_text *t);
void study_plot_data(const study_plot *p, gh_text *t);
/* What stands behind `plot`: bars, curves, zeros. */
void study_plot_curves(const study_plot *p, gh_text *t);

/* ---- draw_labels.c ---- */

/* Each point's value of the parameter beside it where there is room; after the axes. */
gh_status study_plot_labels(const study_plot *p, gh_text *t);

/* ---- draw_rows.c: which curves stand together in curves.png ---- */

typedef struct study_line {
  const char *colour;
  int dash;
  double width;
} study_line;

/* Rows of panels. Few curves, or those of one parameter alone, are one row without a name. More of them are a
 * row for each group (combination of the parameters beside the series) with the series' values as its curves;
 * below them, where groups are few, all groups for the last value of the series that all of them have. */
typedef struct study_rows {
  const gh_study *s;
  bool grouped;
  int ngroups, *first; /* a configuration of each group */
  int *group, *colour; /* nconfigs: -1: it is not drawn, or is the reference of all */
  int compared;        /* choice of the series in the last row; -1: there is no such row */
  int extra;           /* a reference that is no row of the study but that of all; -1: there is none */
} study_rows;

/* The caller frees, also after a failure. ngroups 0: there is nothing to draw. */
gh_status study_rows_plan(const gh_study *s, study_rows *r);
void study_rows_free(study_rows *r);
int study_rows_count(const study_rows *r);
/* Whether a configuration has a curve in a row, and how it looks. */
bool study_rows_line(const study_rows *r, int row, int config, study_line *line);
/* What stands above a row: "periodic (reference: p2400-*)"; "". */
void study_rows_name(const study_rows *r, int row, char name[STUDY_NAME]);
/* There is a curve that comes from no run: a closed form, a file. */
bool study_rows_given(const study_rows *r, study_line *line);

/* ---- draw_key.c: names of the curves, below all panels ---- */

enum { STUDY_KEY_LINE = 22, STUDY_ENTRIES = STUDY_COLOURS + 10 };

typedef struct study_key {
  int n, letters, left, width; /* letters: of the longest curve; left, width: pixels */
  struct {
    bool heading; /* begins a line; has no line of a curve */
    char text[STUDY_NAME];
    study_line line;
  } entry[STUDY_ENTRIES];
} study_key;

/* Names are cut where they are wider than the key. */
void study_key_plan(const study_rows *r, int left, int width, study_key *key);
int study_key_height(const study_key *key);
/* With its lower edge at `bottom` pixels, in a picture of that size: labels and arrows. */
void study_key_print(const study_key *key, int bottom, int picture_width, int picture_height, gh_text *t);

/* ---- draw_curves.c ---- */

/* What gnuplot draws as curves.png, and its size; nothing where there is no curve. */
gh_status study_curves_script(const gh_study *s, gh_text *t, int *width, int *height);

#endif
