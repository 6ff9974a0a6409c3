/* A page of a picture and what pictures read from a folder of results.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_SCENE_PAGE_H
#define GRANHOM_SCENE_PAGE_H

#include "scene/internal.h"

#include <cairo.h>

/* ---- page.c ---- */

typedef struct scene_page {
  gh_context *ctx;
  cairo_surface_t *surface;
  cairo_t *c;
  double low[2], scale, left, bottom; /* pixel = left + scale (x - low), bottom - scale (y - low) */
  int width, height;
  gh_text *bytes; /* of the file */
  bool svg;       /* otherwise pixels for a PNG */
} scene_page;

/* The ending of `path` chooses: .svg, else pixels. */
gh_status scene_page_open(gh_context *ctx, scene_page *p, int width, int height, const char *path);
void scene_page_close(scene_page *p);
/* The file appears whole. The last thing done with a page. */
gh_status scene_page_write(scene_page *p, const char *path);
bool scene_has_ending(const char *path, const char *ending);
/* Fits [low, high] into the pixels [x, x + w] x [y, y + h], in the middle. */
void scene_page_fit(scene_page *p, const double low[2], const double high[2], double x, double y, double w,
                    double h);
double scene_px(const scene_page *p, double x);
double scene_py(const scene_page *p, double y);
/* Fits the parallelogram of `cell` (columns) at `low` with a margin around it, given in its units; leaves the
 * fitted rectangle as the path of the page. */
void scene_page_fit_cell(scene_page *p, const double cell[4], const double low[2], double margin, double x,
                         double y, double w, double h);
/* A disk at a point of the plane, with an outline of `line` pixels. */
void scene_page_disk(scene_page *p, const double x[2], double radius, const double fill[3],
                     const double outline[3], double line);
/* The outline of a cell in the present colour and line width. */
void scene_page_frame(scene_page *p, const double cell[4], const double low[2]);
/* Text at (x, y), `align` of its width to the left of x: 0 starts there, 0.5 is centred, 1 ends there. */
void scene_page_text(scene_page *p, double x, double y, double size, double align, const char *text);
/* Dark blue over green to yellow, of evenly rising lightness; t in [0, 1]. */
void scene_colour(double t, double rgb[3]);
void scene_colour_bar(scene_page *p, double low, double high, const char *title);
/* "name (unit)", or the name alone. */
const char *scene_label(char out[160], const char *name, const char *unit);
/* A step of 1, 2 or 5 times a power of ten that divides `range` into about five. */
double scene_tick_step(double range);

/* ---- picture_packing.c ---- */

extern const double scene_tone_inner[3], scene_tone_boundary[3]; /* of grains in I and in B */
gh_status scene_picture_check(gh_context *ctx,
                              const char *path); /* GH_INPUT unless it ends in .svg or .png */

/* ---- recorded.c ---- */

/* What run.json says. */
typedef struct scene_labels {
  char title[256], length[96], force[96], stress[200];
  char driven_set[SCENE_COLUMN]; /* "" when nothing is driven */
  char driven_direction;         /* x or y */
  int points;
} scene_labels;
/* GH_INPUT: no run.json, or a text in it that is not one line. */
gh_status scene_labels_read(gh_context *ctx, const char *folder, scene_labels *labels);

/* ---- table.c: history.csv ---- */

typedef struct scene_table {
  char *path; /* of the file */
  int nrows, ncols;
  char **name; /* ncols */
  char **cell; /* nrows x ncols, as they are in the file */
  char *text;  /* what they point into */
} scene_table;
/* GH_INPUT with file and line: missing, a line with too few or too many fields, a last line that is cut, no
 * row. */
gh_status scene_table_read(gh_context *ctx, const char *folder, const char *file, scene_table *table);
void scene_table_free(scene_table *table);
int scene_table_column(const scene_table *table, const char *name);          /* -1: there is none */
const char *scene_table_text(const scene_table *table, int row, int column); /* "" for column -1 */
double scene_table_number(const scene_table *table, int row, int column);    /* NAN: it is none */

/* Which columns of history.csv are drawn, and from which row on. */
typedef struct scene_curve {
  int x, force, dilatancy, first; /* columns; force -1: there is none */
  bool driven;
  double sign; /* -1 where the set is driven against its axis */
  char x_label[400], force_label[400];
} scene_curve;
gh_status scene_curve_choose(gh_context *ctx, const scene_table *history, const scene_labels *labels,
                             scene_curve *curve);

/* ---- picture_rve.c: what rves.h5 holds of a point ---- */

typedef struct scene_rve {
  int point, step, periodic;
  size_t n, ncontacts;
  double *x, *radius, *contact; /* contact: branch and force, ncontacts x 4 */
  int *flags, *pairs, *sliding; /* sliding: ncontacts, NULL without friction */
  double cell[4], low[2], cauchy[4];
} scene_rve;
gh_status scene_rve_recorded(gh_h5 *file, int point, bool *recorded);
/* GH_INPUT: missing or damaged. To be freed also then. */
gh_status scene_rve_read(gh_context *ctx, gh_h5 *file, int point, scene_rve *rve);
void scene_rve_free(scene_rve *rve);
/* The shift that brings x into the cell; zero for clusters. */
void scene_rve_home(const scene_rve *rve, const double *x, double shift[2]);

/* ---- HDF5 ---- */

gh_status scene_open_h5(gh_context *ctx, const char *folder, const char *name, gh_h5 **file);
/* A dataset of any number of rows; the caller frees. *data is NULL after a failure. */
gh_status scene_get_doubles(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                            double **data);
gh_status scene_get_ints(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                         int **data);

#endif
