/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The deformed mesh, coloured by the von Mises stress. */
#include "report/page.h"

#include <stdlib.h>
#include <string.h>

/* The last increment of results.h5. */
typedef struct mesh_data {
  size_t nnodes, nelements;
  double *X, *u, *mises; /* X and u: nnodes x 3 */
  int *quad;
  int last; /* increment */
  double time;
} mesh_data;

/* Number of the last increment in results.h5. */
static gh_status last_step(gh_h5 *file, int *last) {
  char name[64];
  bool there = true;
  for (int k = 0; there; k++) {
    snprintf(name, sizeof name, "/step%04d/displacement", k);
    GH_TRY(gh_h5_there(file, name, &there));
    *last = k - 1;
  }
  return GH_OK;
}

static void mesh_data_free(mesh_data *d) {
  free(d->X);
  free(d->u);
  free(d->mises);
  free(d->quad);
}

/* Values at all nodes, finite, and elements of nodes that are there. */
static gh_status mesh_data_check(gh_context *ctx, const char *folder, const mesh_data *d,
                                 const size_t rows[2]) {
  bool good = rows[0] == d->nnodes && rows[1] == d->nnodes && gh_finite(d->X, 3 * d->nnodes) &&
              gh_finite(d->u, 3 * d->nnodes) && gh_finite(d->mises, d->nnodes);
  for (size_t k = 0; k < 4 * d->nelements; k++)
    good = good && d->quad[k] >= 0 && (size_t)d->quad[k] < d->nnodes;
  return good ? GH_OK
              : gh_fail(ctx, GH_INPUT, "%s/results.h5: the fields of increment %d do not fit the mesh",
                        folder, d->last);
}

static gh_status mesh_data_read(gh_context *ctx, const char *folder, mesh_data *d) {
  gh_h5 *file = NULL;
  char name[64];
  size_t points[2];
  gh_status status;
  *d = (mesh_data){0};
  GH_TRY(report_open_h5(ctx, folder, "results.h5", &file));
  GH_TRY_OR(last_step(file, &d->last), done);
  if (d->last < 0) {
    status = gh_fail(ctx, GH_INPUT, "%s/results.h5 holds no increment", folder);
    goto done;
  }
  GH_TRY_OR(report_get_doubles(ctx, file, "/mesh/coordinates", &d->nnodes, 3, &d->X), done);
  GH_TRY_OR(report_get_ints(ctx, file, "/mesh/cells", &d->nelements, 4, &d->quad), done);
  snprintf(name, sizeof name, "/step%04d/displacement", d->last);
  GH_TRY_OR(report_get_doubles(ctx, file, name, &points[0], 3, &d->u), done);
  snprintf(name, sizeof name, "/step%04d/von_mises", d->last);
  GH_TRY_OR(report_get_doubles(ctx, file, name, &points[1], 1, &d->mises), done);
  snprintf(name, sizeof name, "/step%04d/time", d->last);
  GH_TRY_OR(gh_h5_get_doubles(file, name, 1, 1, &d->time), done);
  status = mesh_data_check(ctx, folder, d, points);
done:
  gh_h5_close(&file);
  return status;
}

/* ---- drawing ---- */

static void outline(report_page *p, const mesh_data *d, size_t e, double factor) {
  for (int a = 0; a < 4; a++) {
    int n = d->quad[4 * e + (size_t)a];
    double x = report_px(p, d->X[3 * n] + factor * d->u[3 * n]),
           y = report_py(p, d->X[3 * n + 1] + factor * d->u[3 * n + 1]);
    if (a == 0) cairo_move_to(p->c, x, y);
    else cairo_line_to(p->c, x, y);
  }
  cairo_close_path(p->c);
}

/* The element as small flat patches: the value is bilinear between the corners. */
static void fill_element(report_page *p, const mesh_data *d, size_t e, double factor, double low,
                         double high) {
  const int patches = d->nelements < 100 ? 64 : 16;
  cairo_set_antialias(p->c, CAIRO_ANTIALIAS_NONE); /* no seams between the patches */
  for (int i = 0; i < patches; i++)
    for (int j = 0; j < patches; j++) {
      double rgb[3], value = 0, half = 0.5 / patches, s = (i + 0.5) / patches, t = (j + 0.5) / patches;
      double N[4] = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
      for (int a = 0; a < 4; a++) value += N[a] * d->mises[d->quad[4 * e + (size_t)a]];
      report_colour((value - low) / (high - low), rgb);
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
        if (k == 0) cairo_move_to(p->c, report_px(p, x), report_py(p, y));
        else cairo_line_to(p->c, report_px(p, x), report_py(p, y));
      }
      cairo_close_path(p->c);
      cairo_fill(p->c);
    }
  cairo_set_antialias(p->c, CAIRO_ANTIALIAS_DEFAULT);
}

/* The undeformed body. */
static gh_status draw_body(report_page *p, const mesh_data *d) {
  gh_mesh_edge *edges;
  int count;
  GH_TRY(gh_mesh_boundary_edges(p->ctx, (int)d->nelements, (const int(*)[4])d->quad, &edges, &count));
  for (int k = 0; k < count; k++) {
    int a = edges[k].a, b = edges[k].b;
    cairo_move_to(p->c, report_px(p, d->X[3 * a]), report_py(p, d->X[3 * a + 1]));
    cairo_line_to(p->c, report_px(p, d->X[3 * b]), report_py(p, d->X[3 * b + 1]));
  }
  cairo_stroke(p->c);
  free(edges);
  return GH_OK;
}

/* Coordinates of the undeformed body along the lower and the left side. */
static void draw_axes(report_page *p, const double low[2], const double high[2], const char *unit) {
  double bottom = p->height - 75, left = 85;
  char text[160];
  for (int i = 0; i < 2; i++) {
    double step = report_tick_step(high[i] - low[i]);
    for (double v = ceil(low[i] / step - 1e-9) * step; v <= high[i] + 1e-9 * step; v += step) {
      snprintf(text, sizeof text, "%.6g", fabs(v) < 1e-9 * step ? 0 : v);
      double x = i ? left : report_px(p, v), y = i ? report_py(p, v) : bottom;
      cairo_move_to(p->c, x, y);
      cairo_line_to(p->c, x - (i ? 5 : 0), y + (i ? 0 : 5));
      cairo_stroke(p->c);
      report_page_text(p, i ? x - 10 : x, i ? y + 5 : y + 22, 14, i ? 1 : 0.5, text);
    }
    cairo_move_to(p->c, i ? left : report_px(p, low[0]), i ? report_py(p, low[1]) : bottom);
    cairo_line_to(p->c, i ? left : report_px(p, high[0]), i ? report_py(p, high[1]) : bottom);
    cairo_stroke(p->c);
  }
  report_page_text(p, 0.5 * (report_px(p, low[0]) + report_px(p, high[0])), bottom + 48, 16, 0.5,
                   report_label(text, "x", unit));
  cairo_save(p->c);
  cairo_translate(p->c, 32, 0.5 * (report_py(p, low[1]) + report_py(p, high[1])));
  cairo_rotate(p->c, -acos(-1) / 2);
  report_page_text(p, 0, 0, 16, 0.5, report_label(text, "y", unit));
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

static gh_status draw_mesh(report_page *p, const mesh_data *d, const report_labels *l) {
  double low[2], high[2], drawn_low[2], drawn_high[2], from, to;
  box(d, 0, low, high);
  double factor = enlargement(d, (double[2]){high[0] - low[0], high[1] - low[1]});
  box(d, factor, drawn_low, drawn_high);
  for (int i = 0; i < 2; i++)
    drawn_low[i] = fmin(low[i], drawn_low[i]), drawn_high[i] = fmax(high[i], drawn_high[i]);
  report_page_fit(p, drawn_low, drawn_high, 95, 90, p->width - 285, p->height - 175);
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
  report_page_text(p, 40, 36, 20, 0, *l->title ? l->title : "Deformed mesh");
  if (factor == 1) snprintf(text, sizeof text, "increment %d; dashed: undeformed", d->last);
  else
    snprintf(text, sizeof text, "increment %d, displacements drawn %g times as large; dashed: undeformed",
             d->last, factor);
  report_page_text(p, 40, 62, 15, 0, text);
  report_colour_bar(p, from, to, report_label(name, "von Mises stress", l->stress));
  return GH_OK;
}

gh_status gh_picture_mesh(gh_context *ctx, const char *folder, const char *png) {
  mesh_data d;
  report_page p;
  report_labels l;
  GH_TRY(report_labels_read(ctx, folder, &l));
  gh_status status = mesh_data_read(ctx, folder, &d);
  if (status == GH_OK) {
    status = report_page_open(ctx, &p, 1000, 800, png ? png : "mesh.png");
    if (status == GH_OK) status = draw_mesh(&p, &d, &l);
    if (status == GH_OK && png) status = report_page_write(&p, png);
    report_page_close(&p);
  }
  mesh_data_free(&d);
  return status;
}
