/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Spheres in their cell, seen in parallel projection (Figures 3.4, 3.8, 3.11).
 *
 * Spheres are painted from the back to the front. Replicas would hide the cell and are left out. */
#include "granhom/report.h"
#include "report/page.h"

#include <stdlib.h>

enum { WIDTH = 900, HEIGHT = 950 };

/* To the right, upwards and towards the eye, which is in front (-y), to the right and above: orthonormal. */
static const double view[3][3] = {{0.88, 0.4749736834815167, 0},
                                  {-0.1899894733926067, 0.352, 0.916515138991168},
                                  {0.4353205715332093, -0.8065333223122279, 0.4}};

typedef struct sphere {
  double at[3], radius; /* right, up, towards the eye */
  bool boundary;
} sphere;

static void project(const double x[3], double at[3]) {
  for (int k = 0; k < 3; k++) at[k] = view[k][0] * x[0] + view[k][1] * x[1] + view[k][2] * x[2];
}

static int by_depth(const void *a, const void *b) {
  double p = ((const sphere *)a)->at[2], q = ((const sphere *)b)->at[2];
  return (p > q) - (p < q);
}

/* The face spanned by two lattice vectors has the normal a x b; the cell's height over it is det / |a x b|.
 */
static bool touches_boundary(const double cell[9], const double x[3], double radius) {
  /* rows of the inverse of an upper triangular matrix: coordinates in lattice vectors */
  const double inverse[3][3] = {{1 / cell[0], -cell[1] / (cell[0] * cell[4]),
                                 (cell[1] * cell[5] - cell[2] * cell[4]) / (cell[0] * cell[4] * cell[8])},
                                {0, 1 / cell[4], -cell[5] / (cell[4] * cell[8])},
                                {0, 0, 1 / cell[8]}};
  for (int k = 0; k < 3; k++) {
    const double *n = inverse[k];
    double s = n[0] * x[0] + n[1] * x[1] + n[2] * x[2],
           height = 1 / sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (s * height <= radius || (1 - s) * height <= radius) return true;
  }
  return false;
}

static void corner(const double cell[9], int k, double at[3]) {
  double x[3] = {0};
  for (int a = 0; a < 3; a++)
    for (int i = 0; i < 3; i++)
      if (k >> a & 1) x[i] += cell[3 * i + a];
  project(x, at);
}

static void fit(report_page *p, const gh_grains *g, const sphere *s) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int i = 0; i < g->n; i++)
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], s[i].at[k] - s[i].radius);
      high[k] = fmax(high[k], s[i].at[k] + s[i].radius);
    }
  for (int c = 0; c < 8; c++) {
    double at[3];
    corner(g->cell, c, at);
    for (int k = 0; k < 2; k++) low[k] = fmin(low[k], at[k]), high[k] = fmax(high[k], at[k]);
  }
  report_page_fit(p, low, high, 20, 20, p->width - 40, p->height - 80);
}

/* The three edges at the corner farthest from the eye are behind the grains, the others before them. */
static void draw_edges(report_page *p, const double cell[9], bool behind) {
  int farthest = 0;
  double at[3], least = INFINITY;
  for (int c = 0; c < 8; c++) {
    corner(cell, c, at);
    if (at[2] < least) least = at[2], farthest = c;
  }
  cairo_set_source_rgb(p->c, 0, 0, 0);
  cairo_set_line_width(p->c, behind ? 1 : 2);
  for (int c = 0; c < 8; c++)
    for (int a = 0; a < 3; a++) {
      int d = c | 1 << a;
      if (d == c || (c == farthest || d == farthest) != behind) continue;
      corner(cell, c, at);
      cairo_move_to(p->c, report_px(p, at[0]), report_py(p, at[1]));
      corner(cell, d, at);
      cairo_line_to(p->c, report_px(p, at[0]), report_py(p, at[1]));
      cairo_stroke(p->c);
    }
}

/* Lit from above on the left. */
static void draw_sphere(report_page *p, const sphere *s) {
  double x = report_px(p, s->at[0]), y = report_py(p, s->at[1]), r = p->scale * s->radius;
  const double *tone = s->boundary ? report_tone_boundary : report_tone_inner;
  cairo_pattern_t *light = cairo_pattern_create_radial(x - 0.35 * r, y - 0.4 * r, 0.1 * r, x, y, r);
  cairo_pattern_add_color_stop_rgb(light, 0, 1 - 0.4 * (1 - tone[0]), 1 - 0.4 * (1 - tone[1]),
                                   1 - 0.4 * (1 - tone[2]));
  cairo_pattern_add_color_stop_rgb(light, 0.6, tone[0], tone[1], tone[2]);
  cairo_pattern_add_color_stop_rgb(light, 1, 0.45 * tone[0], 0.45 * tone[1], 0.45 * tone[2]);
  cairo_new_path(p->c);
  cairo_arc(p->c, x, y, r, 0, 2 * GH_PI);
  cairo_set_source(p->c, light);
  cairo_fill(p->c);
  cairo_pattern_destroy(light);
}

static void draw(report_page *p, const gh_grains *g, sphere *s) {
  char text[160];
  int boundary = 0;
  for (int i = 0; i < g->n; i++) {
    project(&g->x[3 * i], s[i].at);
    s[i].radius = g->radius[i];
    s[i].boundary = touches_boundary(g->cell, &g->x[3 * i], g->radius[i]);
    boundary += s[i].boundary;
  }
  qsort(s, (size_t)g->n, sizeof *s, by_depth);
  fit(p, g, s);
  draw_edges(p, g->cell, true);
  for (int i = 0; i < g->n; i++) draw_sphere(p, &s[i]);
  draw_edges(p, g->cell, false);
  snprintf(text, sizeof text, "%d grains (blue: %d inside, red: %d at the boundary), volume fraction %.4f",
           g->n, g->n - boundary, boundary, gh_grains_volume_fraction(g));
  cairo_set_source_rgb(p->c, 0.1, 0.1, 0.1);
  report_page_text(p, p->width / 2.0, p->height - 18, 15, 0.5, text);
}

static gh_status spheres(gh_context *ctx, const gh_grains *g, const char *path) {
  report_page p = {0};
  sphere *s;
  GH_TRY(report_picture_check(ctx, path));
  GH_TRY(gh_alloc(ctx, (size_t)g->n, sizeof *s, &s));
  gh_status status = report_page_open(ctx, &p, WIDTH, HEIGHT, path);
  if (status == GH_OK) {
    draw(&p, g, s);
    status = report_page_write(&p, path);
  }
  report_page_close(&p);
  free(s);
  return status;
}

gh_status gh_picture_grains(gh_context *ctx, const gh_grains *grains, const char *path) {
  if (grains->dim == 3) return spheres(ctx, grains, path);
  gh_packing *packing;
  GH_TRY(gh_grains_packing(ctx, grains, &packing));
  gh_status status = gh_picture_packing(ctx, packing, path);
  gh_packing_destroy(&packing);
  return status;
}
