/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the parts of the report share.
 *
 * The page is text in `out`. Colours are CSS variables (report_style.c), so that it follows the reader's
 * light or dark setting; fields on the mesh keep their colours. */
#ifndef GRANHOM_REPORT_REPORT_H
#define GRANHOM_REPORT_REPORT_H

#include "report/page.h"

#include <cjson/cJSON.h>

enum { REPORT_POINTS = 12, REPORT_FILM = 6 };

/* What the folder holds. */
typedef struct report {
  gh_context *ctx;
  const char *folder;
  const gh_comparison *comparison; /* NULL: none */
  gh_text *out;
  cJSON *run;
  report_labels labels;
  report_table history;
  report_curve curve;
  gh_csv *convergence;
  gh_h5 *results, *rves, *traces; /* the last two may be NULL */
  gh_mesh mesh;                   /* nodes and quadrilaterals alone */
  int n;                          /* complete increments, the start included: 0 ... n - 1 */
  int np;                         /* integration points */
  double *gauss;                  /* np x 2 */
  bool tangents;                  /* there are acoustic tensors; else these are NAN */
  double *acoustic;               /* n x np */
  double *cauchy;                 /* np x 4 at the last increment */
  int least;                      /* point with the smallest acoustic eigenvalue at the last increment */
  int most;                       /* with the largest von Mises stress */
  int least_shown, most_shown;    /* the same among the points that are shown by default */
  int npoints, points[REPORT_POINTS];
  int nfilm, film[REPORT_FILM]; /* increments whose fields are drawn */
} report;

/* ---- recorded.c ---- */

/* run.json as a document, which the caller deletes. GH_INPUT with its name where it is missing, cut off, or
 * no object. */
gh_status report_run_read(gh_context *ctx, const char *folder, cJSON **root);
gh_status report_labels_of(gh_context *ctx, const char *folder, const cJSON *root, report_labels *labels);

/* ---- check.c ---- */

/* convergence.csv with the columns step, iteration, relative and a row at least; GH_INPUT: cut off. */
gh_status report_residuals_read(gh_context *ctx, const char *path, gh_csv **csv);

/* ---- report_data.c ---- */

/* Reads and checks all files but the grains. GH_INPUT with the file's name. */
gh_status report_open(gh_context *ctx, const char *folder, const int *points, int npoints, report *r);
void report_close(report *r);
/* A dataset of increment k, rows x cols; the caller frees. */
gh_status report_field(report *r, int k, const char *name, size_t rows, size_t cols, double **data);
/* A number of history.csv at increment k; NAN where the column is missing. */
double report_history(const report *r, int k, const char *column);
/* A number of run.json behind a path of keys, "summary", "seconds", "total"; NAN where it is missing. */
double report_run_number(const report *r, const char *const *keys);
const char *report_run_text(const report *r, const char *key); /* "" where it is missing */

/* ---- report_chart.c ---- */

void report_escape(gh_text *out, const char *text); /* for HTML: & < > " */

typedef struct report_series {
  const char *name;
  int n;
  const double *x, *y; /* NAN breaks the line */
  const int *mark;     /* n: colour of the point or bar, 1 ...; NULL: that of the series */
} report_series;

typedef struct report_chart {
  const char *title, *x_label, *y_label;
  bool log_y, bars, zero; /* zero: the y axis begins at 0 */
  int first;              /* increment of the first point, for what the pointer shows */
  double line;            /* a level to draw across; NAN: none */
  const char *line_label;
  int nseries;
  report_series series[REPORT_POINTS];
  int nmarks;
  const char *mark_names[4];
} report_chart;
void report_draw_chart(gh_text *out, const report_chart *chart);

/* Shares of a whole as one bar, and its numbers below. */
typedef struct report_share {
  const char *name;
  double value;
} report_share;
void report_draw_shares(gh_text *out, const char *title, const char *unit, int n, const report_share *shares);

/* Functions of the direction, m values each at equal angles over the full circle, as a polar diagram. */
void report_draw_polar(gh_text *out, int m, const double *contacts, const double *forces);

/* ---- report_density.c ---- */

/* Density function of directions (dissertation 4.5, Figure 4.12): at the angle 2 pi k / m the weight of all
 * directions within half the angle of influence on either side, over what it would be if the same weight were
 * spread evenly; so its mean over the circle is 1. A direction counts along with its opposite. x: n
 * directions (n x 2, any length > 0); weight: n, >= 0, NULL: 1. influence: in (0, pi]. Without weight all
 * zero. */
void report_density(int n, const double *x, const double *weight, double influence, int m, double *density);

/* ---- sections; each prints itself ---- */

gh_status report_verdict(report *r);     /* report_words.c */
gh_status report_options(report *r);     /* report_words.c */
gh_status report_comparison(report *r);  /* report_compare.c; nothing without one */
gh_status report_curves(report *r);      /* report_curves.c */
gh_status report_iterations(report *r);  /* report_curves.c; a part of the convergence */
gh_status report_fields(report *r);      /* report_mesh.c */
gh_status report_packings(report *r);    /* report_rve.c */
gh_status report_convergence(report *r); /* report_tables.c */
gh_status report_time(report *r);        /* report_tables.c */
gh_status report_error(report *r);       /* report_error.c */
/* Seconds of each increment (r->n), from timing.csv; NAN where it has none. */
gh_status report_seconds(report *r, double *seconds);

/* ---- report_style.c ---- */

void report_print_style(gh_text *out);
void report_print_script(gh_text *out);

#endif
