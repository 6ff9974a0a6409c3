/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A page of a picture and what pictures read from a folder of results. */
#ifndef GRANHOM_REPORT_PAGE_H
#define GRANHOM_REPORT_PAGE_H

#include "granhom/report.h"
#include "granhom/results.h"

#include <cairo.h>

/* ---- page.c ---- */

typedef struct report_page {
  gh_context *ctx;
  cairo_surface_t *surface;
  cairo_t *c;
  double low[2], scale, left, bottom; /* pixel = left + scale (x - low), bottom - scale (y - low) */
  int width, height;
  gh_text *bytes; /* of the file */
  bool svg;       /* otherwise pixels for a PNG */
} report_page;

/* The ending of `path` chooses: .svg, else pixels. */
gh_status report_page_open(gh_context *ctx, report_page *p, int width, int height, const char *path);
void report_page_close(report_page *p);
/* The file appears whole. The last thing done with a page. */
gh_status report_page_write(report_page *p, const char *path);
bool report_has_ending(const char *path, const char *ending);
/* Fits [low, high] into the pixels [x, x + w] x [y, y + h], in the middle. */
void report_page_fit(report_page *p, const double low[2], const double high[2], double x, double y, double w,
                     double h);
double report_px(const report_page *p, double x);
double report_py(const report_page *p, double y);
/* Fits the parallelogram of `cell` (columns) at `low` with a margin around it, given in its units; leaves the
 * fitted rectangle as the path of the page. */
void report_page_fit_cell(report_page *p, const double cell[4], const double low[2], double margin, double x,
                          double y, double w, double h);
/* A disk at a point of the plane, with an outline of `line` pixels. */
void report_page_disk(report_page *p, const double x[2], double radius, const double fill[3],
                      const double outline[3], double line);
/* The outline of a cell in the present colour and line width. */
void report_page_frame(report_page *p, const double cell[4], const double low[2]);
/* Text at (x, y), `align` of its width to the left of x: 0 starts there, 0.5 is centred, 1 ends there. */
void report_page_text(report_page *p, double x, double y, double size, double align, const char *text);
/* Dark blue over green to yellow, of evenly rising lightness; t in [0, 1]. */
void report_colour(double t, double rgb[3]);
void report_colour_bar(report_page *p, double low, double high, const char *title);
/* "name (unit)", or the name alone. */
const char *report_label(char out[160], const char *name, const char *unit);
/* A step of 1, 2 or 5 times a power of ten that divides `range` into about five. */
double report_tick_step(double range);

/* ---- picture_packing.c ---- */

extern const double report_tone_inner[3], report_tone_boundary[3]; /* of grains in I and in B */
gh_status report_picture_check(gh_context *ctx,
                               const char *path); /* GH_INPUT unless it ends in .svg or .png */

/* ---- recorded.c ---- */

/* What run.json states. */
typedef struct report_labels {
  char title[256], length[96], force[96], stress[200];
  char driven_set[GH_COLUMN]; /* "" when nothing is driven */
  char driven_direction;      /* x or y */
  int points;
} report_labels;
/* GH_INPUT: no run.json, or a text in it that is not one line. */
gh_status report_labels_read(gh_context *ctx, const char *folder, report_labels *labels);

/* ---- table.c: history.csv ---- */

typedef struct report_table {
  char *path; /* of the file */
  int nrows, ncols;
  char **name; /* ncols */
  char **cell; /* nrows x ncols, as they are in the file */
  char *text;  /* what they point into */
} report_table;
/* GH_INPUT with file and line: missing, a line with too few or too many fields, a last line that is cut, no
 * row. */
gh_status report_table_read(gh_context *ctx, const char *folder, const char *file, report_table *table);
void report_table_free(report_table *table);
int report_table_column(const report_table *table, const char *name);          /* -1: there is none */
const char *report_table_text(const report_table *table, int row, int column); /* "" for column -1 */
double report_table_number(const report_table *table, int row, int column);    /* NAN: it is none */

/* Which columns of history.csv are drawn, and from which row on. */
typedef struct report_curve {
  int x, force, dilatancy, first; /* columns; force -1: there is none */
  bool driven;
  double sign; /* -1 where the set is driven against its axis */
  char x_label[400], force_label[400];
} report_curve;
gh_status report_curve_choose(gh_context *ctx, const report_table *history, const report_labels *labels,
                              report_curve *curve);

/* ---- picture_rve.c: what rves.h5 holds of a point ---- */

typedef struct report_rve {
  int point, step, periodic;
  size_t n, ncontacts;
  double *x, *radius, *contact; /* contact: branch and force, ncontacts x 4 */
  int *flags, *pairs, *sliding; /* sliding: ncontacts, NULL without friction */
  double cell[4], low[2], cauchy[4];
} report_rve;
gh_status report_rve_recorded(gh_h5 *file, int point, bool *recorded);
/* GH_INPUT: missing or damaged. To be freed also then. */
gh_status report_rve_read(gh_context *ctx, gh_h5 *file, int point, report_rve *rve);
void report_rve_free(report_rve *rve);
/* Whether grains of a frame are among them. */
bool report_rve_has_frame(const report_rve *rve);
/* The shift that brings x into the cell; zero for clusters. */
void report_rve_home(const report_rve *rve, const double *x, double shift[2]);

/* ---- HDF5 ---- */

gh_status report_open_h5(gh_context *ctx, const char *folder, const char *name, gh_h5 **file);
/* A dataset of any number of rows; the caller frees. *data is NULL after a failure. */
gh_status report_get_doubles(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                             double **data);
gh_status report_get_ints(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                          int **data);

#endif
