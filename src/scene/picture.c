/* Pictures of results with cairo: deformed mesh, one material point. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "scene/internal.h"

#include <cairo.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const char *const FONT = "sans-serif";

/* ---- colours ---- */

/* Dark blue over green to yellow, of evenly rising lightness; t in [0, 1]. Nine knots in the manner of
 * viridis. */
static void colour(double t, double rgb[3]) {
  static const double knot[9][3] = {{0.267, 0.005, 0.329}, {0.282, 0.156, 0.471}, {0.244, 0.290, 0.537},
                                    {0.191, 0.407, 0.556}, {0.147, 0.513, 0.557}, {0.120, 0.622, 0.535},
                                    {0.208, 0.719, 0.473}, {0.565, 0.841, 0.263}, {0.993, 0.906, 0.144}};
  t = fmin(fmax(t, 0), 1) * 8;
  int k = t >= 8 ? 7 : (int)t;
  for (int i = 0; i < 3; i++) rgb[i] = knot[k][i] + (t - k) * (knot[k + 1][i] - knot[k][i]);
}

/* ---- a page: points of the plane to pixels ---- */

typedef struct page {
  gh_context *ctx;
  cairo_surface_t *surface;
  cairo_t *c;
  double low[2], scale, left, bottom; /* pixel = left + scale (x - low), bottom - scale (y - low) */
  int width, height;
} page;

static gh_status page_open(gh_context *ctx, page *p, int width, int height) {
  *p = (page){.ctx = ctx, .width = width, .height = height};
  p->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  p->c = cairo_create(p->surface);
  if (cairo_status(p->c) != CAIRO_STATUS_SUCCESS) return gh_fail(ctx, GH_MEMORY, "no memory for a picture");
  cairo_set_source_rgb(p->c, 1, 1, 1);
  cairo_paint(p->c);
  cairo_select_font_face(p->c, FONT, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_line_join(p->c, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(p->c, CAIRO_LINE_CAP_ROUND);
  return GH_OK;
}

static void page_close(page *p) {
  cairo_destroy(p->c);
  cairo_surface_destroy(p->surface);
}

/* To PNG.tmp, then into place. */
static gh_status page_write(page *p, const char *png) {
  size_t length = strlen(png) + 5;
  char *tmp;
  GH_TRY(gh_alloc(p->ctx, length, 1, &tmp));
  snprintf(tmp, length, "%s.tmp", png);
  cairo_status_t s = cairo_surface_write_to_png(p->surface, tmp);
  gh_status status = s == CAIRO_STATUS_SUCCESS ? gh_file_replace(p->ctx, tmp, png)
                                               : gh_fail(p->ctx, GH_SYSTEM, "%s: cannot be written: %s", png,
                                                         cairo_status_to_string(s));
  free(tmp);
  return status;
}

/* Fits [low, high] into the pixels [x, x + w] x [y, y + h], in the middle. */
static void page_fit(page *p, const double low[2], const double high[2], double x, double y, double w,
                     double h) {
  double size[2] = {fmax(high[0] - low[0], 1e-300), fmax(high[1] - low[1], 1e-300)};
  p->scale = fmin(w / size[0], h / size[1]);
  p->low[0] = low[0], p->low[1] = low[1];
  p->left = x + 0.5 * (w - p->scale * size[0]);
  p->bottom = y + h - 0.5 * (h - p->scale * size[1]);
}

static double px(const page *p, double x) {
  return p->left + p->scale * (x - p->low[0]);
}
static double py(const page *p, double y) {
  return p->bottom - p->scale * (y - p->low[1]);
}

/* Text at (x, y), `align` of its width to the left of x: 0 starts there, 0.5 is centred, 1 ends there. */
static void write_text(page *p, double x, double y, double size, double align, const char *text) {
  cairo_text_extents_t e;
  cairo_set_font_size(p->c, size);
  cairo_text_extents(p->c, text, &e);
  cairo_move_to(p->c, x - align * e.x_advance, y);
  cairo_show_text(p->c, text);
}

/* "label (unit)", or the label alone. */
static const char *label(char out[160], const char *name, const char *unit) {
  snprintf(out, 160, *unit ? "%s (%s)" : "%s", name, unit);
  return out;
}

/* A step of 1, 2 or 5 times a power of ten that divides `range` into about five. */
static double tick_step(double range) {
  double raw = range / 5, power = pow(10, floor(log10(raw))), x = raw / power;
  return power * (x < 1.5 ? 1 : x < 3.5 ? 2 : x < 7.5 ? 5 : 10);
}

static void colour_bar(page *p, double low, double high, const char *title) {
  double x = p->width - 130, y = 90, h = p->height - 180, w = 24;
  for (int k = 0; k < (int)h; k++) {
    double rgb[3];
    colour(1 - k / h, rgb);
    cairo_set_source_rgb(p->c, rgb[0], rgb[1], rgb[2]);
    cairo_rectangle(p->c, x, y + k, w, 1.5);
    cairo_fill(p->c);
  }
  cairo_set_source_rgb(p->c, 0.2, 0.2, 0.2);
  cairo_set_line_width(p->c, 1);
  cairo_rectangle(p->c, x, y, w, h);
  cairo_stroke(p->c);
  write_text(p, p->width - 20, y - 22, 16, 1, title);
  double step = tick_step(high - low);
  for (double v = ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) {
    char text[32];
    double at = y + h - h * (v - low) / (high - low);
    snprintf(text, sizeof text, "%.6g", fabs(v) < 1e-9 * step ? 0 : v);
    cairo_move_to(p->c, x + w, at);
    cairo_line_to(p->c, x + w + 5, at);
    cairo_stroke(p->c);
    write_text(p, x + w + 10, at + 5, 14, 0, text);
  }
}

/* ---- results ---- */

/* What run.json and results.h5 say; `units` are kept by the caller. */
typedef struct mesh_data {
  size_t nnodes, nelements;
  double *X, *u, *mises; /* X and u: nnodes x 3 */
  int *quad;
  int last; /* increment */
  double time;
} mesh_data;

static gh_status open_h5(gh_context *ctx, const char *folder, const char *name, gh_h5 **file) {
  char *path = gh_path_join(folder, name);
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_h5_read(ctx, path, file);
  free(path);
  return status;
}

static gh_status get_doubles(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                             double **data) {
  size_t r, c;
  GH_TRY(gh_h5_size(file, name, &r, &c));
  if (c != cols) return gh_fail(ctx, GH_INPUT, "dataset %s has %zu columns instead of %zu", name, c, cols);
  GH_TRY(gh_alloc(ctx, r * c, sizeof **data, data));
  *rows = r;
  return gh_h5_get_doubles(file, name, r, c, *data);
}

static gh_status get_ints(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                          int **data) {
  size_t r, c;
  GH_TRY(gh_h5_size(file, name, &r, &c));
  if (c != cols) return gh_fail(ctx, GH_INPUT, "dataset %s has %zu columns instead of %zu", name, c, cols);
  GH_TRY(gh_alloc(ctx, r * c, sizeof **data, data));
  *rows = r;
  return gh_h5_get_ints(file, name, r, c, *data);
}

/* Number of the last increment in results.h5. */
static int last_step(gh_h5 *file) {
  char name[64];
  size_t rows, cols;
  for (int k = 0;; k++) {
    snprintf(name, sizeof name, "/step%04d/displacement", k);
    if (gh_h5_size(file, name, &rows, &cols) != GH_OK) return k - 1;
  }
}

static void mesh_data_free(mesh_data *d) {
  free(d->X);
  free(d->u);
  free(d->mises);
  free(d->quad);
}

static gh_status mesh_data_read(gh_context *ctx, const char *folder, mesh_data *d) {
  gh_h5 *file = NULL;
  char name[64];
  size_t rows;
  gh_status status;
  *d = (mesh_data){0};
  GH_TRY(open_h5(ctx, folder, "results.h5", &file));
  d->last = last_step(file);
  if (d->last < 0) {
    status = gh_fail(ctx, GH_INPUT, "%s/results.h5 holds no increment", folder);
    goto done;
  }
  GH_TRY_OR(get_doubles(ctx, file, "/mesh/coordinates", &d->nnodes, 3, &d->X), done);
  GH_TRY_OR(get_ints(ctx, file, "/mesh/cells", &d->nelements, 4, &d->quad), done);
  snprintf(name, sizeof name, "/step%04d/displacement", d->last);
  GH_TRY_OR(get_doubles(ctx, file, name, &rows, 3, &d->u), done);
  snprintf(name, sizeof name, "/step%04d/von_mises", d->last);
  GH_TRY_OR(get_doubles(ctx, file, name, &rows, 1, &d->mises), done);
  snprintf(name, sizeof name, "/step%04d/time", d->last);
  GH_TRY_OR(gh_h5_get_doubles(file, name, 1, 1, &d->time), done);
done:
  gh_h5_close(&file);
  return status;
}

/* ---- mesh.png ---- */

static void outline(page *p, const mesh_data *d, size_t e, double factor) {
  for (int a = 0; a < 4; a++) {
    int n = d->quad[4 * e + (size_t)a];
    double x = px(p, d->X[3 * n] + factor * d->u[3 * n]),
           y = py(p, d->X[3 * n + 1] + factor * d->u[3 * n + 1]);
    if (a == 0) cairo_move_to(p->c, x, y);
    else cairo_line_to(p->c, x, y);
  }
  cairo_close_path(p->c);
}

/* The element as small flat patches: the value is bilinear between the corners. */
static void fill_element(page *p, const mesh_data *d, size_t e, double factor, double low, double high) {
  enum { PATCHES = 24 };
  cairo_set_antialias(p->c, CAIRO_ANTIALIAS_NONE); /* no seams between the patches */
  for (int i = 0; i < PATCHES; i++)
    for (int j = 0; j < PATCHES; j++) {
      double rgb[3], value = 0, half = 0.5 / PATCHES, s = (i + 0.5) / PATCHES, t = (j + 0.5) / PATCHES;
      double N[4] = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
      for (int a = 0; a < 4; a++) value += N[a] * d->mises[d->quad[4 * e + (size_t)a]];
      colour((value - low) / (high - low), rgb);
      cairo_set_source_rgb(p->c, rgb[0], rgb[1], rgb[2]);
      for (int k = 0; k < 4; k++) {
        double ss = s + (k == 1 || k == 2 ? half : -half) * 1.05, tt = t + (k >= 2 ? half : -half) * 1.05,
               x = 0, y = 0;
        double M[4] = {(1 - ss) * (1 - tt), ss * (1 - tt), ss * tt, (1 - ss) * tt};
        for (int a = 0; a < 4; a++) {
          int n = d->quad[4 * e + (size_t)a];
          x += M[a] * (d->X[3 * n] + factor * d->u[3 * n]);
          y += M[a] * (d->X[3 * n + 1] + factor * d->u[3 * n + 1]);
        }
        if (k == 0) cairo_move_to(p->c, px(p, x), py(p, y));
        else cairo_line_to(p->c, px(p, x), py(p, y));
      }
      cairo_close_path(p->c);
      cairo_fill(p->c);
    }
  cairo_set_antialias(p->c, CAIRO_ANTIALIAS_DEFAULT);
}

/* The undeformed body. */
static gh_status draw_body(page *p, const mesh_data *d) {
  scene_edge *edges;
  int count;
  GH_TRY(scene_boundary_edges(p->ctx, (int)d->nelements, (const int(*)[4])d->quad, &edges, &count));
  for (int k = 0; k < count; k++) {
    int a = edges[k].a, b = edges[k].b;
    cairo_move_to(p->c, px(p, d->X[3 * a]), py(p, d->X[3 * a + 1]));
    cairo_line_to(p->c, px(p, d->X[3 * b]), py(p, d->X[3 * b + 1]));
  }
  cairo_stroke(p->c);
  free(edges);
  return GH_OK;
}

/* Coordinates of the undeformed body along the lower and the left side. */
static void draw_axes(page *p, const double low[2], const double high[2], const char *unit) {
  double bottom = p->height - 75, left = 85;
  char text[160];
  for (int i = 0; i < 2; i++) {
    double step = tick_step(high[i] - low[i]);
    for (double v = ceil(low[i] / step - 1e-9) * step; v <= high[i] + 1e-9 * step; v += step) {
      snprintf(text, sizeof text, "%.6g", fabs(v) < 1e-9 * step ? 0 : v);
      double x = i ? left : px(p, v), y = i ? py(p, v) : bottom;
      cairo_move_to(p->c, x, y);
      cairo_line_to(p->c, x - (i ? 5 : 0), y + (i ? 0 : 5));
      cairo_stroke(p->c);
      write_text(p, i ? x - 10 : x, i ? y + 5 : y + 22, 14, i ? 1 : 0.5, text);
    }
    cairo_move_to(p->c, i ? left : px(p, low[0]), i ? py(p, low[1]) : bottom);
    cairo_line_to(p->c, i ? left : px(p, high[0]), i ? py(p, high[1]) : bottom);
    cairo_stroke(p->c);
  }
  write_text(p, 0.5 * (px(p, low[0]) + px(p, high[0])), bottom + 48, 16, 0.5, label(text, "x", unit));
  cairo_save(p->c);
  cairo_translate(p->c, 32, 0.5 * (py(p, low[1]) + py(p, high[1])));
  cairo_rotate(p->c, -PI / 2);
  write_text(p, 0, 0, 16, 0.5, label(text, "y", unit));
  cairo_restore(p->c);
}

static void range(const double *value, size_t n, double *low, double *high) {
  *low = INFINITY, *high = -INFINITY;
  for (size_t k = 0; k < n; k++) *low = fmin(*low, value[k]), *high = fmax(*high, value[k]);
  if (!(*high > *low)) *high = *low + 1e-12 + 1e-6 * fabs(*low);
}

/* 1, 2 or 5 times a power of ten by which displacements are drawn larger, so that the largest is about 4 % of
 * the mesh; 1 where they are large enough. */
static double enlargement(const mesh_data *d, const double size[2]) {
  double most = 0;
  for (size_t n = 0; n < d->nnodes; n++) most = fmax(most, hypot(d->u[3 * n], d->u[3 * n + 1]));
  double wanted = 0.04 * fmax(size[0], size[1]) / fmax(most, 1e-300);
  if (wanted < 1.5 || most == 0) return 1;
  double power = pow(10, floor(log10(wanted))), x = wanted / power;
  return power * (x < 2 ? 1 : x < 5 ? 2 : 5);
}

/* Box around the undeformed (factor 0) or the drawn body. */
static void box(const mesh_data *d, double factor, double low[2], double high[2]) {
  for (size_t i = 0; i < 2; i++) low[i] = INFINITY, high[i] = -INFINITY;
  for (size_t n = 0; n < d->nnodes; n++)
    for (size_t i = 0; i < 2; i++) {
      double x = d->X[3 * n + i] + factor * d->u[3 * n + i];
      low[i] = fmin(low[i], x), high[i] = fmax(high[i], x);
    }
}

static gh_status draw_mesh(page *p, const mesh_data *d, const scene_labels *l) {
  double low[2], high[2], drawn_low[2], drawn_high[2], from, to;
  box(d, 0, low, high);
  double factor = enlargement(d, (double[2]){high[0] - low[0], high[1] - low[1]});
  box(d, factor, drawn_low, drawn_high);
  for (int i = 0; i < 2; i++)
    drawn_low[i] = fmin(low[i], drawn_low[i]), drawn_high[i] = fmax(high[i], drawn_high[i]);
  page_fit(p, drawn_low, drawn_high, 95, 90, p->width - 285, p->height - 175);
  range(d->mises, d->nnodes, &from, &to);
  for (size_t e = 0; e < d->nelements; e++) fill_element(p, d, e, factor, from, to);
  cairo_set_source_rgba(p->c, 1, 1, 1, 0.8);
  cairo_set_line_width(p->c, d->nelements < 400 ? 1.5 : 0.5);
  for (size_t e = 0; e < d->nelements; e++) outline(p, d, e, factor);
  cairo_stroke(p->c);
  cairo_set_source_rgb(p->c, 0.35, 0.35, 0.35);
  cairo_set_line_width(p->c, 1.2);
  cairo_set_dash(p->c, (double[]){5, 5}, 2, 0);
  GH_TRY(draw_body(p, d));
  cairo_set_dash(p->c, NULL, 0, 0);
  char text[256], name[160];
  cairo_set_source_rgb(p->c, 0.1, 0.1, 0.1);
  draw_axes(p, low, high, l->length);
  write_text(p, 40, 36, 20, 0, *l->title ? l->title : "Deformed mesh");
  snprintf(text, sizeof text, "increment %d, displacements drawn %g times; dashed: undeformed", d->last,
           factor);
  write_text(p, 40, 62, 15, 0, text);
  colour_bar(p, from, to, label(name, "von Mises stress", l->stress));
  return GH_OK;
}

gh_status gh_picture_mesh(gh_context *ctx, const char *folder, const char *png) {
  mesh_data d;
  page p;
  scene_labels l;
  GH_TRY(scene_labels_read(ctx, folder, &l));
  gh_status status = mesh_data_read(ctx, folder, &d);
  if (status == GH_OK) {
    status = page_open(ctx, &p, 1000, 800);
    if (status == GH_OK) status = draw_mesh(&p, &d, &l);
    if (status == GH_OK) status = page_write(&p, png);
    page_close(&p);
  }
  mesh_data_free(&d);
  return status;
}

/* ---- rve.png ---- */

typedef struct rve_data {
  int point, step, periodic;
  size_t n, ncontacts;
  double *x, *radius, *contact; /* contact: branch and force, ncontacts x 4 */
  int *flags, *pairs;
  double cell[4], low[2], cauchy[4];
} rve_data;

static void rve_data_free(rve_data *d) {
  free(d->x);
  free(d->radius);
  free(d->contact);
  free(d->flags);
  free(d->pairs);
}

/* The recorded point with the largest von Mises stress; -1 when none is recorded. */
static int most_loaded(gh_h5 *file, int points) {
  int best = -1;
  double most = -1;
  for (int k = 0; k < points; k++) {
    char name[64];
    double s[4];
    snprintf(name, sizeof name, "/rve/%04d/cauchy", k);
    if (gh_h5_get_doubles(file, name, 1, 4, s) != GH_OK) continue;
    if (scene_mises(s) > most) most = scene_mises(s), best = k;
  }
  return best;
}

static gh_status rve_data_read(gh_context *ctx, const char *folder, int points, int point, rve_data *d) {
  gh_h5 *file = NULL;
  char name[64];
  size_t rows, cols;
  gh_status status;
  *d = (rve_data){0};
  GH_TRY(open_h5(ctx, folder, "rves.h5", &file));
  d->point = point >= 0 ? point : most_loaded(file, points);
  snprintf(name, sizeof name, "/rve/%04d/cauchy", d->point);
  if (d->point < 0 || gh_h5_size(file, name, &rows, &cols) != GH_OK) {
    status = gh_fail(ctx, GH_INPUT,
                     "%s/rves.h5: integration point %d is not recorded; there are %d, and `output: {rves: "
                     "[...]}` of the scene chooses",
                     folder, point, points);
    goto done;
  }
#define AT(what) (snprintf(name, sizeof name, "/rve/%04d/%s", d->point, what), name)
  GH_TRY_OR(get_doubles(ctx, file, AT("positions"), &d->n, 2, &d->x), done);
  GH_TRY_OR(get_doubles(ctx, file, AT("radii"), &rows, 1, &d->radius), done);
  GH_TRY_OR(get_ints(ctx, file, AT("flags"), &rows, 1, &d->flags), done);
  GH_TRY_OR(get_ints(ctx, file, AT("contact_pairs"), &d->ncontacts, 2, &d->pairs), done);
  GH_TRY_OR(get_doubles(ctx, file, AT("contact_branch_force"), &rows, 4, &d->contact), done);
  GH_TRY_OR(gh_h5_get_doubles(file, AT("cell"), 1, 4, d->cell), done);
  GH_TRY_OR(gh_h5_get_doubles(file, AT("low"), 1, 2, d->low), done);
  GH_TRY_OR(gh_h5_get_doubles(file, AT("cauchy"), 1, 4, d->cauchy), done);
  GH_TRY_OR(gh_h5_get_ints(file, AT("periodic"), 1, 1, &d->periodic), done);
  GH_TRY_OR(gh_h5_get_ints(file, "/step", 1, 1, &d->step), done);
#undef AT
done:
  gh_h5_close(&file);
  return status;
}

/* The shift (in lattice vectors) that brings x into the cell; zero for clusters. */
static void home(const rve_data *d, const double *x, double shift[2]) {
  double inverse[4], s[2] = {x[0] - d->low[0], x[1] - d->low[1]};
  shift[0] = shift[1] = 0;
  if (!d->periodic) return;
  gh_inv2(d->cell, inverse);
  gh_apply2(inverse, s, s);
  double k[2] = {-floor(s[0]), -floor(s[1])};
  gh_apply2(d->cell, k, shift);
}

/* Calls draw for x itself and, in a periodic cell, for all images that reach into the page. */
static void draw_grains(page *p, const rve_data *d) {
  for (size_t n = 0; n < d->n; n++) {
    double shift[2];
    home(d, d->x + 2 * n, shift);
    int images = d->periodic ? 1 : 0;
    for (int i = -images; i <= images; i++)
      for (int j = -images; j <= images; j++) {
        double x = d->x[2 * n] + shift[0] + i * d->cell[0] + j * d->cell[1];
        double y = d->x[2 * n + 1] + shift[1] + i * d->cell[2] + j * d->cell[3];
        bool replica = i || j || (d->flags[n] & 4), rattler = d->flags[n] & 1;
        double grey = rattler ? 1.0 : replica ? 0.93 : 0.84;
        cairo_arc(p->c, px(p, x), py(p, y), p->scale * d->radius[n], 0, 2 * PI);
        cairo_set_source_rgb(p->c, grey, grey, grey);
        cairo_fill_preserve(p->c);
        cairo_set_source_rgb(p->c, replica ? 0.8 : 0.55, replica ? 0.8 : 0.55, replica ? 0.8 : 0.55);
        cairo_set_line_width(p->c, 0.8);
        cairo_stroke(p->c);
      }
  }
}

static double largest_force(const rve_data *d) {
  double most = 0;
  for (size_t k = 0; k < d->ncontacts; k++)
    most = fmax(most, hypot(d->contact[4 * k + 2], d->contact[4 * k + 3]));
  return most;
}

enum { THICKEST = 14 }; /* pixels of the largest force */

static void force_line(page *p, const double a[2], const double l[2], double share) {
  double rgb[3];
  colour(0.85 * share, rgb);
  cairo_set_source_rgb(p->c, rgb[0], rgb[1], rgb[2]);
  cairo_set_line_width(p->c, fmax(THICKEST * share, 0.4));
  cairo_move_to(p->c, px(p, a[0]), py(p, a[1]));
  cairo_line_to(p->c, px(p, a[0] + l[0]), py(p, a[1] + l[1]));
  cairo_stroke(p->c);
}

/* Each force from centre to centre; in a periodic cell from both grains, so that those across the frame show
 * on both sides. */
static void draw_forces(page *p, const rve_data *d, double most) {
  for (size_t k = 0; k < d->ncontacts && most > 0; k++) {
    const double *c = d->contact + 4 * k,
                 *x[2] = {d->x + 2 * d->pairs[2 * k], d->x + 2 * d->pairs[2 * k + 1]};
    for (int end = 0; end < (d->periodic ? 2 : 1); end++) {
      double shift[2], sign = end ? -1 : 1;
      home(d, x[end], shift);
      force_line(p, (double[2]){x[end][0] + shift[0], x[end][1] + shift[1]},
                 (double[2]){sign * c[0], sign * c[1]}, hypot(c[2], c[3]) / most);
    }
  }
}

static void draw_frame(page *p, const rve_data *d) {
  static const double at[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int k = 0; k < 4; k++) {
    double v[2];
    gh_apply2(d->cell, at[k], v);
    if (k == 0) cairo_move_to(p->c, px(p, d->low[0] + v[0]), py(p, d->low[1] + v[1]));
    else cairo_line_to(p->c, px(p, d->low[0] + v[0]), py(p, d->low[1] + v[1]));
  }
  cairo_close_path(p->c);
  cairo_set_source_rgb(p->c, 0.8, 0.15, 0.1);
  cairo_set_line_width(p->c, 2);
  cairo_stroke(p->c);
}

static void rve_fit(page *p, const rve_data *d) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, radius = 0;
  for (size_t n = 0; n < d->n; n++) radius = fmax(radius, d->radius[n]);
  for (int k = 0; k < 4; k++) {
    double corner[2] = {k & 1, k >> 1};
    gh_apply2(d->cell, corner, corner);
    for (int i = 0; i < 2; i++)
      low[i] = fmin(low[i], d->low[i] + corner[i]), high[i] = fmax(high[i], d->low[i] + corner[i]);
  }
  for (int i = 0; i < 2; i++) low[i] -= radius, high[i] += radius;
  page_fit(p, low, high, 20, 120, p->width - 40, p->height - 140);
  cairo_rectangle(p->c, px(p, low[0]), py(p, high[1]), p->scale * (high[0] - low[0]),
                  p->scale * (high[1] - low[1]));
}

static void draw_rve(page *p, const rve_data *d, const scene_labels *l) {
  double most = largest_force(d);
  char text[256];
  rve_fit(p, d);
  cairo_save(p->c);
  cairo_clip(p->c);
  draw_grains(p, d);
  draw_forces(p, d, most);
  draw_frame(p, d);
  cairo_restore(p->c);
  cairo_set_source_rgb(p->c, 0.1, 0.1, 0.1);
  snprintf(text, sizeof text, "Integration point %d (element %d), increment %d", d->point, d->point / 4,
           d->step);
  write_text(p, 24, 36, 20, 0, text);
  snprintf(text, sizeof text,
           "%s: width of lines ~ contact force, largest %.3g%s%s; white grains: rattlers; red: cell",
           d->ncontacts ? "Force network" : "No contacts", most, *l->force ? " " : "", l->force);
  write_text(p, 24, 64, 15, 0, text);
  snprintf(text, sizeof text, "Cauchy stress  s11 = %.3g,  s22 = %.3g,  s12 = %.3g%s%s", d->cauchy[0],
           d->cauchy[3], d->cauchy[1], *l->stress ? " " : "", l->stress);
  write_text(p, 24, 90, 15, 0, text);
}

gh_status gh_picture_rve(gh_context *ctx, const char *folder, int point, const char *png) {
  rve_data d;
  page p;
  scene_labels l;
  GH_TRY(scene_labels_read(ctx, folder, &l));
  gh_status status = rve_data_read(ctx, folder, l.points, point, &d);
  if (status == GH_OK) {
    status = page_open(ctx, &p, 900, 1000);
    if (status == GH_OK) draw_rve(&p, &d, &l);
    if (status == GH_OK) status = page_write(&p, png);
    page_close(&p);
  }
  rve_data_free(&d);
  return status;
}
