/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A packing: primary, boundary and replica grains in three tones, the cell as a frame (Figures 3.3, 3.12). */
#include "granhom/report.h"
#include "report/page.h"

/* Blue inside, red at the boundary as in the figures; replicas are the pale sisters of the boundary grains.
 * Their greys differ too. */
const double report_tone_inner[3] = {0.20, 0.36, 0.62}, report_tone_boundary[3] = {0.84, 0.38, 0.28};
static const double REPLICA[3] = {0.96, 0.83, 0.78}, OUTLINE[3] = {0.10, 0.10, 0.12};

static void draw_members(report_page *p, const gh_packing *packing, const gh_cluster *c) {
  for (int m = c->n - 1; m >= 0;
       m--) { /* replicas first, so that primaries lie on top where soft grains overlap */
    const double *tone = m >= packing->n  ? REPLICA
                         : c->boundary[m] ? report_tone_boundary
                                          : report_tone_inner;
    double line = fmin(0.8, 0.1 * p->scale * c->radius[m]);
    report_page_disk(p, &c->x[2 * m], c->radius[m], tone, OUTLINE, line);
  }
}

static void draw_caption(report_page *p, const gh_packing *packing, const gh_cluster *c) {
  char text[160];
  double area = 0;
  int boundary = 0;
  for (int i = 0; i < packing->n; i++) {
    area += GH_PI * packing->radius[i] * packing->radius[i];
    boundary += c->boundary[i];
  }
  snprintf(text, sizeof text,
           "%d grains (blue: %d inside, red: %d at the boundary; pale: %d replicas), volume fraction %.4f",
           packing->n, packing->n - boundary, boundary, c->n - packing->n, area / gh_det2(packing->cell));
  cairo_set_source_rgb(p->c, 0.1, 0.1, 0.1);
  report_page_text(p, p->width / 2.0, p->height - 18, 15, 0.5, text);
}

/* Box around all members, low and high. */
static void bounds(const gh_cluster *c, double low[2], double high[2]) {
  for (int k = 0; k < 2; k++) {
    low[k] = INFINITY, high[k] = -INFINITY;
    for (int m = 0; m < c->n; m++) {
      low[k] = fmin(low[k], c->x[2 * m + k] - c->radius[m]);
      high[k] = fmax(high[k], c->x[2 * m + k] + c->radius[m]);
    }
  }
}

enum { WIDTH = 900, BORDER = 20, CAPTION = 40 };

static void draw(report_page *p, const gh_packing *packing, const gh_cluster *c) {
  double low[2], high[2];
  bounds(c, low, high);
  report_page_fit(p, low, high, BORDER, BORDER, p->width - 2 * BORDER, p->height - 2 * BORDER - CAPTION);
  draw_members(p, packing, c);
  cairo_set_source_rgb(p->c, 0, 0, 0);
  cairo_set_line_width(p->c, 2.5);
  report_page_frame(p, packing->cell, packing->low);
  draw_caption(p, packing, c);
}

/* Of the picture, so that grains fill it; within limits for very long cells. */
static int height(const gh_cluster *c) {
  double low[2], high[2];
  bounds(c, low, high);
  double h = (high[1] - low[1]) / (high[0] - low[0]) * (WIDTH - 2 * BORDER);
  return 2 * BORDER + CAPTION + (int)fmin(fmax(h, 100), 2 * WIDTH);
}

gh_status report_picture_check(gh_context *ctx, const char *path) {
  if (report_has_ending(path, ".svg") || report_has_ending(path, ".png")) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "%s: a picture is a .svg or a .png", path);
}

gh_status gh_picture_packing(gh_context *ctx, const gh_packing *packing, const char *path) {
  report_page p = {0};
  gh_cluster *c;
  GH_TRY(report_picture_check(ctx, path));
  GH_TRY(gh_cluster_create(ctx, packing, &c));
  gh_status status = report_page_open(ctx, &p, WIDTH, height(c), path);
  if (status == GH_OK) {
    draw(&p, packing, c);
    status = report_page_write(&p, path);
  }
  report_page_close(&p);
  gh_cluster_destroy(&c);
  return status;
}
