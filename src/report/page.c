/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A page of a picture: points of the plane to pixels, colours, text. */
#include "report/page.h"

#include <cairo-svg.h>
#include <stdlib.h>
#include <string.h>

static const char *const FONT = "sans-serif";
/* ---- colours ---- */

/* Dark blue over green to yellow, of evenly rising lightness; t in [0, 1]. Nine knots in the manner of
 * viridis. */
void report_colour(double t, double rgb[3]) {
  static const double knot[9][3] = {{0.267, 0.005, 0.329}, {0.282, 0.156, 0.471}, {0.244, 0.290, 0.537},
                                    {0.191, 0.407, 0.556}, {0.147, 0.513, 0.557}, {0.120, 0.622, 0.535},
                                    {0.208, 0.719, 0.473}, {0.565, 0.841, 0.263}, {0.993, 0.906, 0.144}};
  t = fmin(fmax(t, 0), 1) * 8;
  int k = t >= 8 ? 7 : (int)t;
  for (int i = 0; i < 3; i++) rgb[i] = knot[k][i] + (t - k) * (knot[k + 1][i] - knot[k][i]);
}

/* ---- a page ---- */

bool report_has_ending(const char *path, const char *ending) {
  size_t n = strlen(path), m = strlen(ending);
  return n > m && strcmp(path + n - m, ending) == 0;
}

static cairo_status_t bytes_collect(void *text, const unsigned char *bytes, unsigned int length) {
  return gh_text_add(text, bytes, length) == GH_OK ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_NO_MEMORY;
}

/* Pixels are set here: where cairo has no memory to paint them, it does not always report it. */
static void paper_whiten(report_page *p) {
  unsigned char *pixels = p->svg ? NULL : cairo_image_surface_get_data(p->surface);
  if (pixels) {
    memset(pixels, 0xFF, (size_t)cairo_image_surface_get_stride(p->surface) * (size_t)p->height);
    cairo_surface_mark_dirty(p->surface);
    return;
  }
  cairo_set_source_rgb(p->c, 1, 1, 1);
  cairo_paint(p->c);
}

gh_status report_page_open(gh_context *ctx, report_page *p, int width, int height, const char *path) {
  *p = (report_page){.ctx = ctx, .width = width, .height = height};
  GH_TRY(gh_text_create(ctx, &p->bytes));
  p->svg = report_has_ending(path, ".svg");
  if (p->svg) p->surface = cairo_svg_surface_create_for_stream(bytes_collect, p->bytes, width, height);
  else p->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  p->c = cairo_create(p->surface);
  if (cairo_status(p->c) != CAIRO_STATUS_SUCCESS) return gh_fail(ctx, GH_MEMORY, "no memory for a picture");
  paper_whiten(p);
  cairo_select_font_face(p->c, FONT, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_line_join(p->c, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(p->c, CAIRO_LINE_CAP_ROUND);
  return GH_OK;
}

void report_page_close(report_page *p) {
  if (p->c) cairo_destroy(p->c);
  if (p->surface) cairo_surface_destroy(p->surface);
  gh_text_destroy(&p->bytes);
}

gh_status report_page_write(report_page *p, const char *path) {
  cairo_status_t s = cairo_status(p->c); /* after a failure of its own, cairo draws nothing more */
  if (s == CAIRO_STATUS_SUCCESS && p->svg) {
    cairo_surface_finish(p->surface);
    s = cairo_surface_status(p->surface);
  } else if (s == CAIRO_STATUS_SUCCESS) {
    s = cairo_surface_write_to_png_stream(p->surface, bytes_collect, p->bytes);
  }
  if (s == CAIRO_STATUS_SUCCESS) return gh_text_commit(p->bytes, path);
  return gh_fail(p->ctx, GH_MEMORY, "%s: cannot be drawn: %s", path, cairo_status_to_string(s));
}

/* Fits [low, high] into the pixels [x, x + w] x [y, y + h], in the middle. */
void report_page_fit(report_page *p, const double low[2], const double high[2], double x, double y, double w,
                     double h) {
  double size[2] = {fmax(high[0] - low[0], 1e-300), fmax(high[1] - low[1], 1e-300)};
  p->scale = fmin(w / size[0], h / size[1]);
  p->low[0] = low[0], p->low[1] = low[1];
  p->left = x + 0.5 * (w - p->scale * size[0]);
  p->bottom = y + h - 0.5 * (h - p->scale * size[1]);
}

double report_px(const report_page *p, double x) {
  return p->left + p->scale * (x - p->low[0]);
}
double report_py(const report_page *p, double y) {
  return p->bottom - p->scale * (y - p->low[1]);
}

void report_page_fit_cell(report_page *p, const double cell[4], const double low[2], double margin, double x,
                          double y, double w, double h) {
  double least[2] = {INFINITY, INFINITY}, most[2] = {-INFINITY, -INFINITY};
  for (int k = 0; k < 4; k++) {
    double corner[2] = {k & 1, k >> 1};
    gh_apply2(cell, corner, corner);
    for (int i = 0; i < 2; i++)
      least[i] = fmin(least[i], low[i] + corner[i]), most[i] = fmax(most[i], low[i] + corner[i]);
  }
  for (int i = 0; i < 2; i++) least[i] -= margin, most[i] += margin;
  report_page_fit(p, least, most, x, y, w, h);
  cairo_rectangle(p->c, report_px(p, least[0]), report_py(p, most[1]), p->scale * (most[0] - least[0]),
                  p->scale * (most[1] - least[1]));
}

void report_page_disk(report_page *p, const double x[2], double radius, const double fill[3],
                      const double outline[3], double line) {
  cairo_new_sub_path(p->c);
  cairo_arc(p->c, report_px(p, x[0]), report_py(p, x[1]), p->scale * radius, 0, 2 * GH_PI);
  cairo_set_source_rgb(p->c, fill[0], fill[1], fill[2]);
  cairo_fill_preserve(p->c);
  cairo_set_source_rgb(p->c, outline[0], outline[1], outline[2]);
  cairo_set_line_width(p->c, line);
  cairo_stroke(p->c);
}

void report_page_frame(report_page *p, const double cell[4], const double low[2]) {
  static const double at[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int k = 0; k < 4; k++) {
    double v[2];
    gh_apply2(cell, at[k], v);
    if (k == 0) cairo_move_to(p->c, report_px(p, low[0] + v[0]), report_py(p, low[1] + v[1]));
    else cairo_line_to(p->c, report_px(p, low[0] + v[0]), report_py(p, low[1] + v[1]));
  }
  cairo_close_path(p->c);
  cairo_stroke(p->c);
}

/* Text at (x, y), `align` of its width to the left of x: 0 starts there, 0.5 is centred, 1 ends there. */
void report_page_text(report_page *p, double x, double y, double size, double align, const char *text) {
  cairo_text_extents_t e;
  cairo_set_font_size(p->c, size);
  cairo_text_extents(p->c, text, &e);
  cairo_move_to(p->c, x - align * e.x_advance, y);
  cairo_show_text(p->c, text);
}

/* "label (unit)", or the label alone. */
const char *report_label(char out[160], const char *name, const char *unit) {
  snprintf(out, 160, *unit ? "%s (%s)" : "%s", name, unit);
  return out;
}

/* A step of 1, 2 or 5 times a power of ten that divides `range` into about five. */
double report_tick_step(double range) {
  double raw = range / 5, power = pow(10, floor(log10(raw))), x = raw / power;
  return power * (x < 1.5 ? 1 : x < 3.5 ? 2 : x < 7.5 ? 5 : 10);
}

void report_colour_bar(report_page *p, double low, double high, const char *title) {
  double x = p->width - 130, y = 90, h = p->height - 180, w = 24;
  for (int k = 0; k < (int)h; k++) {
    double rgb[3];
    report_colour(1 - k / h, rgb);
    cairo_set_source_rgb(p->c, rgb[0], rgb[1], rgb[2]);
    cairo_rectangle(p->c, x, y + k, w, 1.5);
    cairo_fill(p->c);
  }
  cairo_set_source_rgb(p->c, 0.2, 0.2, 0.2);
  cairo_set_line_width(p->c, 1);
  cairo_rectangle(p->c, x, y, w, h);
  cairo_stroke(p->c);
  report_page_text(p, p->width - 20, y - 22, 16, 1, title);
  double step = report_tick_step(high - low);
  for (double v = ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) {
    char text[32];
    double at = y + h - h * (v - low) / (high - low);
    snprintf(text, sizeof text, "%.6g", fabs(v) < 1e-9 * step ? 0 : v);
    cairo_move_to(p->c, x + w, at);
    cairo_line_to(p->c, x + w + 5, at);
    cairo_stroke(p->c);
    report_page_text(p, x + w + 10, at + 5, 14, 0, text);
  }
}
