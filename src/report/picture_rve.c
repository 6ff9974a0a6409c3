/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The grains of one material point with their network of forces. */
#include "report/page.h"

#include <stdlib.h>
#include <string.h>

void report_rve_free(report_rve *d) {
  free(d->x);
  free(d->radius);
  free(d->contact);
  free(d->flags);
  free(d->pairs);
  free(d->sliding);
}

gh_status report_rve_recorded(gh_h5 *file, int point, bool *recorded) {
  char name[64];
  snprintf(name, sizeof name, "/rve/%04d/cauchy", point);
  *recorded = false;
  return point < 0 ? GH_OK : gh_h5_there(file, name, recorded);
}

/* Arrays of equal length, and contacts of grains that are there. */
static gh_status check_rve(gh_context *ctx, const report_rve *d, const size_t rows[4]) {
  bool good = rows[0] == d->n && rows[1] == d->n && rows[2] == d->ncontacts && gh_finite(d->x, 2 * d->n) &&
              gh_finite(d->radius, d->n) && gh_finite(d->contact, 4 * d->ncontacts);
  good = good && (!d->sliding || rows[3] == d->ncontacts);
  for (size_t k = 0; k < 2 * d->ncontacts; k++) good = good && d->pairs[k] >= 0 && (size_t)d->pairs[k] < d->n;
  return good ? GH_OK
              : gh_fail(ctx, GH_INPUT, "rves.h5: the grains of point %d do not fit together", d->point);
}

gh_status report_rve_read(gh_context *ctx, gh_h5 *file, int point, report_rve *d) {
  char name[64];
  size_t rows[4];
  bool slides;
  *d = (report_rve){.point = point};
#define AT(what) (snprintf(name, sizeof name, "/rve/%04d/%s", point, what), name)
  GH_TRY(report_get_doubles(ctx, file, AT("positions"), &d->n, 2, &d->x));
  GH_TRY(report_get_doubles(ctx, file, AT("radii"), rows, 1, &d->radius));
  GH_TRY(report_get_ints(ctx, file, AT("flags"), rows + 1, 1, &d->flags));
  GH_TRY(report_get_ints(ctx, file, AT("contact_pairs"), &d->ncontacts, 2, &d->pairs));
  GH_TRY(report_get_doubles(ctx, file, AT("contact_branch_force"), rows + 2, 4, &d->contact));
  GH_TRY(gh_h5_get_doubles(file, AT("cell"), 1, 4, d->cell));
  GH_TRY(gh_h5_get_doubles(file, AT("low"), 1, 2, d->low));
  GH_TRY(gh_h5_get_doubles(file, AT("cauchy"), 1, 4, d->cauchy));
  GH_TRY(gh_h5_get_ints(file, AT("periodic"), 1, 1, &d->periodic));
  GH_TRY(gh_h5_there(file, AT("contact_sliding"), &slides));
  if (slides) GH_TRY(report_get_ints(ctx, file, name, rows + 3, 1, &d->sliding));
#undef AT
  GH_TRY(gh_h5_get_ints(file, "/step", 1, 1, &d->step));
  return check_rve(ctx, d, rows);
}

/* The recorded point with the largest von Mises stress; -1 when none is recorded. */
static gh_status most_loaded(gh_h5 *file, int points, int *best) {
  double most = -1;
  *best = -1;
  for (int k = 0; k < points; k++) {
    char name[64];
    double s[4];
    bool recorded;
    snprintf(name, sizeof name, "/rve/%04d/cauchy", k);
    GH_TRY(report_rve_recorded(file, k, &recorded));
    if (!recorded) continue;
    GH_TRY(gh_h5_get_doubles(file, name, 1, 4, s));
    if (gh_mises2(s) > most) most = gh_mises2(s), *best = k;
  }
  return GH_OK;
}

static gh_status read_point(gh_context *ctx, const char *folder, int points, int point, report_rve *d) {
  gh_h5 *file = NULL;
  *d = (report_rve){0};
  GH_TRY(report_open_h5(ctx, folder, "rves.h5", &file));
  bool recorded = false;
  gh_status status = point < 0 ? most_loaded(file, points, &point) : GH_OK;
  if (status == GH_OK) status = report_rve_recorded(file, point, &recorded);
  if (status != GH_OK) gh_h5_close(&file);
  GH_TRY(status);
  if (recorded) status = report_rve_read(ctx, file, point, d);
  else
    status = gh_fail(ctx, GH_INPUT,
                     "%s/rves.h5: integration point %d is not recorded; there are %d, and `results: {rves: "
                     "[...]}` of the scene chooses",
                     folder, point, points);
  gh_h5_close(&file);
  return status;
}

void report_rve_home(const report_rve *d, const double *x, double shift[2]) {
  double inverse[4], s[2] = {x[0] - d->low[0], x[1] - d->low[1]};
  shift[0] = shift[1] = 0;
  if (!d->periodic) return;
  gh_inv2(d->cell, inverse);
  gh_apply2(inverse, s, s);
  double k[2] = {-floor(s[0]), -floor(s[1])};
  gh_apply2(d->cell, k, shift);
}

/* Calls draw for x itself and, in a periodic cell, for all images that reach into the page. */
static void draw_grains(report_page *p, const report_rve *d) {
  for (size_t n = 0; n < d->n; n++) {
    double shift[2];
    report_rve_home(d, d->x + 2 * n, shift);
    int images = d->periodic ? 1 : 0;
    for (int i = -images; i <= images; i++)
      for (int j = -images; j <= images; j++) {
        double x[2];
        for (int k = 0; k < 2; k++)
          x[k] = d->x[2 * n + (size_t)k] + shift[k] + i * d->cell[2 * k] + j * d->cell[2 * k + 1];
        bool replica = i || j || (d->flags[n] & 4), rattler = d->flags[n] & 1;
        double grey = rattler ? 1.0 : replica ? 0.93 : 0.84, dark = replica ? 0.8 : 0.55;
        const double frame = d->flags[n] & 8 ? 0.75 : 1; /* of green and blue: pale red */
        report_page_disk(p, x, d->radius[n], (double[3]){grey, frame * grey, frame * grey},
                         (double[3]){dark, dark, dark}, 0.8);
      }
  }
}

static double largest_force(const report_rve *d) {
  double most = 0;
  for (size_t k = 0; k < d->ncontacts; k++)
    most = fmax(most, hypot(d->contact[4 * k + 2], d->contact[4 * k + 3]));
  return most;
}

enum { THICKEST = 14 }; /* pixels of the largest force */

static void force_line(report_page *p, const double a[2], const double l[2], double share) {
  double rgb[3];
  report_colour(0.85 * share, rgb);
  cairo_set_source_rgb(p->c, rgb[0], rgb[1], rgb[2]);
  cairo_set_line_width(p->c, fmax(THICKEST * share, 0.4));
  cairo_move_to(p->c, report_px(p, a[0]), report_py(p, a[1]));
  cairo_line_to(p->c, report_px(p, a[0] + l[0]), report_py(p, a[1] + l[1]));
  cairo_stroke(p->c);
}

/* Each force from centre to centre; in a periodic cell from both grains, so that those across the frame show
 * on both sides. */
static void draw_forces(report_page *p, const report_rve *d, double most) {
  for (size_t k = 0; k < d->ncontacts && most > 0; k++) {
    const double *c = d->contact + 4 * k,
                 *x[2] = {d->x + 2 * d->pairs[2 * k], d->x + 2 * d->pairs[2 * k + 1]};
    for (int end = 0; end < (d->periodic ? 2 : 1); end++) {
      double shift[2], sign = end ? -1 : 1;
      report_rve_home(d, x[end], shift);
      force_line(p, (double[2]){x[end][0] + shift[0], x[end][1] + shift[1]},
                 (double[2]){sign * c[0], sign * c[1]}, hypot(c[2], c[3]) / most);
    }
  }
}

static double largest_radius(const report_rve *d) {
  double radius = 0;
  for (size_t n = 0; n < d->n; n++) radius = fmax(radius, d->radius[n]);
  return radius;
}

bool report_rve_has_frame(const report_rve *d) {
  for (size_t n = 0; n < d->n; n++)
    if (d->flags[n] & 8) return true;
  return false;
}

static void draw_rve(report_page *p, const report_rve *d, const report_labels *l) {
  double most = largest_force(d);
  char text[512];
  report_page_fit_cell(p, d->cell, d->low, largest_radius(d), 20, 120, p->width - 40, p->height - 140);
  cairo_save(p->c);
  cairo_clip(p->c);
  draw_grains(p, d);
  draw_forces(p, d, most);
  cairo_set_source_rgb(p->c, 0.8, 0.15, 0.1);
  cairo_set_line_width(p->c, 2);
  report_page_frame(p, d->cell, d->low);
  cairo_restore(p->c);
  cairo_set_source_rgb(p->c, 0.1, 0.1, 0.1);
  snprintf(text, sizeof text, "Integration point %d (element %d), increment %d", d->point, d->point / 4,
           d->step);
  report_page_text(p, 24, 36, 20, 0, text);
  snprintf(text, sizeof text,
           "%s: width of lines ~ contact force, largest %.3g%s%s; white grains: rattlers; red: cell%s",
           d->ncontacts ? "Force network" : "No contacts", most, *l->force ? " " : "", l->force,
           report_rve_has_frame(d) ? "; pale red: frame" : "");
  report_page_text(p, 24, 64, 15, 0, text);
  snprintf(text, sizeof text, "Cauchy stress  s11 = %.3g,  s22 = %.3g,  s12 = %.3g%s%s", d->cauchy[0],
           d->cauchy[3], d->cauchy[1], *l->stress ? " " : "", l->stress);
  report_page_text(p, 24, 90, 15, 0, text);
}

gh_status gh_picture_rve(gh_context *ctx, const char *folder, int point, const char *png) {
  report_rve d;
  report_page p;
  report_labels l;
  GH_TRY(report_labels_read(ctx, folder, &l));
  gh_status status = read_point(ctx, folder, l.points, point, &d);
  if (status == GH_OK) {
    status = report_page_open(ctx, &p, 900, 1000, png ? png : "rve.png");
    if (status == GH_OK) draw_rve(&p, &d, &l);
    if (status == GH_OK && png) status = report_page_write(&p, png);
    report_page_close(&p);
  }
  report_rve_free(&d);
  return status;
}
