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
} scene_page;

gh_status scene_page_open(gh_context *ctx, scene_page *p, int width, int height);
void scene_page_close(scene_page *p);
/* To PNG.tmp, then into place. */
gh_status scene_page_write(scene_page *p, const char *png);
/* Fits [low, high] into the pixels [x, x + w] x [y, y + h], in the middle. */
void scene_page_fit(scene_page *p, const double low[2], const double high[2], double x, double y, double w,
                    double h);
double scene_px(const scene_page *p, double x);
double scene_py(const scene_page *p, double y);
/* Text at (x, y), `align` of its width to the left of x: 0 starts there, 0.5 is centred, 1 ends there. */
void scene_page_text(scene_page *p, double x, double y, double size, double align, const char *text);
/* Dark blue over green to yellow, of evenly rising lightness; t in [0, 1]. */
void scene_colour(double t, double rgb[3]);
void scene_colour_bar(scene_page *p, double low, double high, const char *title);
/* "name (unit)", or the name alone. */
const char *scene_label(char out[160], const char *name, const char *unit);
/* A step of 1, 2 or 5 times a power of ten that divides `range` into about five. */
double scene_tick_step(double range);

/* ---- recorded.c ---- */

/* What run.json says. */
typedef struct scene_labels {
  char title[128], length[32], force[32], stress[72];
  char driven_set[64];   /* "" when nothing is driven */
  char driven_direction; /* x or y */
  int points;
} scene_labels;
gh_status scene_labels_read(gh_context *ctx, const char *folder, scene_labels *labels);
gh_status scene_open_h5(gh_context *ctx, const char *folder, const char *name, gh_h5 **file);
/* A dataset of any number of rows; the caller frees. */
gh_status scene_get_doubles(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                            double **data);
gh_status scene_get_ints(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                         int **data);

#endif
