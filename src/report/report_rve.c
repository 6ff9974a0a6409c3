/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Packings of chosen points: force network, density functions, traces. */
#include "report/report.h"

#include <stdlib.h>
#include <string.h>

enum { PAGE = 1000, WIDEST = 26, LEVELS = 16, ANGLES = 180, LONGEST_TRACE = 60 };
enum { RATTLER = 1, REPLICA = 4, FRAME = 8 };

/* From the plane to the page. */
typedef struct view {
  double low[2], high[2], scale, height;
} view;

static void view_include(view *v, const double x[2], double margin) {
  for (int i = 0; i < 2; i++)
    v->low[i] = fmin(v->low[i], x[i] - margin), v->high[i] = fmax(v->high[i], x[i] + margin);
}

static const double corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

static void corner(const double cell[4], const double low[2], int k, double x[2]) {
  gh_apply2(cell, corners[k], x);
  x[0] += low[0], x[1] += low[1];
}

static void view_fit(view *v, const report_rve *d, double margin) {
  *v = (view){.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
  for (int k = 0; k < 4; k++) {
    double x[2];
    corner(d->cell, d->low, k, x);
    view_include(v, x, margin);
  }
}

static void view_end(view *v) {
  v->scale = PAGE / fmax(v->high[0] - v->low[0], 1e-300);
  v->height = v->scale * (v->high[1] - v->low[1]);
}

static double px(const view *v, double x) {
  return v->scale * (x - v->low[0]);
}
static double py(const view *v, double y) {
  return v->height - v->scale * (y - v->low[1]);
}

static bool on_page(const view *v, const double x[2], double radius) {
  return x[0] + radius > v->low[0] && x[0] - radius < v->high[0] && x[1] + radius > v->low[1] &&
         x[1] - radius < v->high[1];
}

static double largest_radius(const report_rve *d) {
  double radius = 0;
  for (size_t n = 0; n < d->n; n++) radius = fmax(radius, d->radius[n]);
  return radius;
}

/* ---- parts of pictures ---- */

static void begin_figure(report *r, const view *v, const char *title) {
  gh_text_print(r->out, "<figure><figcaption>%s</figcaption>", title);
  gh_text_print(r->out,
                "<svg style=\"overflow:hidden\" viewBox=\"0 0 %d %.0f\" role=\"img\" aria-label=\"%s\">",
                PAGE, v->height, title);
}

static void print_cell(gh_text *out, const view *v, const double cell[4], const double low[2],
                       const char *class) {
  gh_text_print(out, "<path class=\"%s\" d=\"", class);
  for (int k = 0; k < 4; k++) {
    double x[2];
    corner(cell, low, k, x);
    gh_text_print(out, "%s%.0f %.0f", k ? "L" : "M", px(v, x[0]), py(v, x[1]));
  }
  gh_text_print(out, "Z\"/>");
}

/* All grains, and in a periodic cell their images that reach into the page. Rattlers are outlines, replicas
 * and images lighter. */
static void print_grains(gh_text *out, const view *v, const report_rve *d) {
  for (size_t n = 0; n < d->n; n++) {
    double shift[2];
    int images = d->periodic ? 1 : 0;
    report_rve_home(d, d->x + 2 * n, shift);
    for (int i = -images; i <= images; i++)
      for (int j = -images; j <= images; j++) {
        double x[2];
        for (size_t k = 0; k < 2; k++)
          x[k] = d->x[2 * n + k] + shift[k] + i * d->cell[2 * k] + j * d->cell[2 * k + 1];
        if (!on_page(v, x, d->radius[n])) continue;
        const char *class = d->flags[n] & RATTLER ? "w" : i || j || (d->flags[n] & REPLICA) ? "r" : "g";
        gh_text_print(out, "<circle class=\"%s%s\" cx=\"%.0f\" cy=\"%.0f\" r=\"%.1f\"/>", class,
                      d->flags[n] & FRAME ? " f" : "", px(v, x[0]), py(v, x[1]), v->scale * d->radius[n]);
      }
  }
}

static double force_of(const report_rve *d, size_t k) {
  return hypot(d->contact[4 * k + 2], d->contact[4 * k + 3]);
}

static double largest_force(const report_rve *d) {
  double most = 0;
  for (size_t k = 0; k < d->ncontacts; k++) most = fmax(most, force_of(d, k));
  return most;
}

static void print_branch(gh_text *out, const view *v, const double a[2], const double l[2], double sign) {
  double x = px(v, a[0]), y = py(v, a[1]);
  gh_text_print(out, "M%.0f %.0fL%.0f %.0f", x, y, px(v, a[0] + sign * l[0]), py(v, a[1] + sign * l[1]));
}

/* The force of contact k from centre to centre; one that crosses the frame of a periodic cell also from its
 * other grain. */
static void print_force(gh_text *out, const view *v, const report_rve *d, size_t k) {
  const double *l = d->contact + 4 * k;
  double end[2][2], off = 0;
  for (int e = 0; e < 2; e++) {
    const double *x = d->x + 2 * d->pairs[2 * k + (size_t)e];
    report_rve_home(d, x, end[e]);
    for (int i = 0; i < 2; i++) end[e][i] += x[i];
  }
  for (int i = 0; i < 2; i++) off = fmax(off, fabs(end[0][i] + l[i] - end[1][i]));
  print_branch(out, v, end[0], l, 1);
  if (off > 1e-6 * (v->high[0] - v->low[0])) print_branch(out, v, end[1], l, -1);
}

/* Lines of about the same width are one path. */
static void print_level(gh_text *out, const view *v, const report_rve *d, int level, bool sliding,
                        double most) {
  bool any = false;
  for (size_t k = 0; k < d->ncontacts; k++) {
    int at = (int)(LEVELS * force_of(d, k) / fmax(most, 1e-300));
    if ((at < LEVELS ? at : LEVELS - 1) != level || (d->sliding && d->sliding[k]) != sliding) continue;
    if (!any) gh_text_print(out, "<path stroke-width=\"%.1f\" d=\"", WIDEST * (level + 0.5) / LEVELS);
    any = true;
    print_force(out, v, d, k);
  }
  if (any) gh_text_print(out, "\"/>");
}

static void print_forces(gh_text *out, const view *v, const report_rve *d) {
  double most = largest_force(d);
  gh_text_print(out, "<g class=\"fc\">");
  for (int level = 0; level < LEVELS; level++) print_level(out, v, d, level, false, most);
  gh_text_print(out, "</g>");
  if (!d->sliding) return;
  gh_text_print(out, "<g class=\"fs\">");
  for (int level = 0; level < LEVELS; level++) print_level(out, v, d, level, true, most);
  gh_text_print(out, "</g>");
}

/* ---- pictures ---- */

static void print_length(report *r) {
  if (!*r->labels.length) return;
  gh_text_print(r->out, " ");
  report_escape(r->out, r->labels.length);
}

static void draw_network(report *r, const report_rve *d) {
  view v;
  view_fit(&v, d, 1.1 * largest_radius(d));
  view_end(&v);
  begin_figure(r, &v, "Force network");
  print_grains(r->out, &v, d);
  print_forces(r->out, &v, d);
  print_cell(r->out, &v, d->cell, d->low, "cell");
  gh_text_print(r->out, "</svg><p class=\"note\">Width of lines: contact force, the largest is %.3g",
                largest_force(d));
  if (*r->labels.force) {
    gh_text_print(r->out, " ");
    report_escape(r->out, r->labels.force);
  }
  gh_text_print(r->out, "%s%s. Outlines: rattlers; lighter: %s; orange: the cell, %.4g by %.4g",
                d->sliding ? "; purple: sliding contacts" : "",
                report_rve_has_frame(d) ? "; red outlines: frame" : "",
                d->periodic ? "periodic images" : "replicas", hypot(d->cell[0], d->cell[2]),
                hypot(d->cell[1], d->cell[3]));
  print_length(r);
  gh_text_print(r->out, ".</p></figure>\n");
}

static gh_status draw_densities(report *r, const report_rve *d) {
  double *memory, contacts[ANGLES], forces[ANGLES];
  GH_TRY(gh_alloc(r->ctx, 3 * d->ncontacts, sizeof *memory, &memory));
  double *weight = memory + 2 * d->ncontacts;
  for (size_t k = 0; k < d->ncontacts; k++) {
    memcpy(memory + 2 * k, d->contact + 4 * k, 2 * sizeof *memory);
    weight[k] = fmax(0, d->radius[d->pairs[2 * k]] + d->radius[d->pairs[2 * k + 1]] -
                            hypot(memory[2 * k], memory[2 * k + 1]));
  }
  report_density((int)d->ncontacts, memory, NULL, 25 * GH_PI / 180, ANGLES, contacts);
  report_density((int)d->ncontacts, memory, weight, 25 * GH_PI / 180, ANGLES, forces);
  report_draw_polar(r->out, ANGLES, contacts, forces);
  free(memory);
  return GH_OK;
}

/* The primary grains, which come first. */
static size_t primaries(const report_rve *d) {
  size_t n = 0;
  while (n < d->n && !(d->flags[n] & REPLICA)) n++;
  return n;
}

/* Positions of a point's primary grains at increment k; *x NULL when they are not recorded. */
static gh_status trace_at(report *r, const report_rve *d, int k, double **x) {
  char name[64];
  size_t rows, cols;
  bool there = false;
  *x = NULL;
  snprintf(name, sizeof name, "/trace/%04d/step%04d", d->point, k);
  if (r->traces) GH_TRY(gh_h5_there(r->traces, name, &there));
  if (!there) return GH_OK;
  GH_TRY(gh_h5_size(r->traces, name, &rows, &cols));
  if (rows != primaries(d) || cols != 2)
    return gh_fail(r->ctx, GH_INPUT, "%s/traces.h5: %s has %zu rows, rves.h5 has %zu grains", r->folder, name,
                   rows, primaries(d));
  GH_TRY(gh_alloc(r->ctx, 2 * rows, sizeof **x, x));
  return gh_h5_get_doubles(r->traces, name, rows, 2, *x);
}

/* Cell at increment k: F_k F^-1 (last cell). */
static gh_status cell_at(report *r, const report_rve *d, int k, double cell[4], double low[2]) {
  double *F, last[4], first[4];
  size_t np = (size_t)r->np;
  GH_TRY(report_field(r, d->step, "points/F", np, 4, &F));
  memcpy(last, F + 4 * d->point, sizeof last);
  free(F);
  GH_TRY(report_field(r, k, "points/F", np, 4, &F));
  memcpy(first, F + 4 * d->point, sizeof first);
  free(F);
  gh_inv2(last, last);
  gh_mul2(first, last, first);
  gh_mul2(first, d->cell, cell);
  gh_apply2(first, d->low, low);
  return GH_OK;
}

typedef struct traces {
  int n;
  double *x[LONGEST_TRACE + 2];
} traces;

static void traces_free(traces *t) {
  for (int k = 0; k < t->n; k++) free(t->x[k]);
}

/* At most LONGEST_TRACE of the increments, the first and the last among them. */
static gh_status read_traces(report *r, const report_rve *d, traces *t) {
  int steps = d->step < LONGEST_TRACE ? d->step : LONGEST_TRACE;
  for (int k = 0; k <= steps; k++) {
    double *x;
    gh_status status = trace_at(r, d, steps ? (int)((long)k * d->step / steps) : 0, &x);
    if (x) t->x[t->n++] = x;
    GH_TRY(status);
  }
  return GH_OK;
}

/* The longest way from the start is drawn as long as about the largest radius: 1, 2 or 5 times a power of
 * ten. */
static double enlargement(const report_rve *d, const traces *t) {
  double most = 0;
  for (int k = 0; k < t->n; k++)
    for (size_t n = 0; n < 2 * primaries(d); n++) most = fmax(most, fabs(t->x[k][n] - d->x[n]));
  double wanted = largest_radius(d) / fmax(most, 1e-300);
  if (wanted < 2 || most == 0) return 1;
  double power = pow(10, floor(log10(wanted))), x = wanted / power;
  return power * (x < 2 ? 1 : x < 5 ? 2 : 5);
}

static void print_trace(gh_text *out, const view *v, const report_rve *d, const traces *t, double factor,
                        size_t grain) {
  double shift[2];
  report_rve_home(d, d->x + 2 * grain, shift);
  for (int k = 0; k < t->n; k++) {
    double x[2];
    for (size_t i = 0; i < 2; i++) {
      double now = d->x[2 * grain + i];
      x[i] = now + shift[i] + factor * (t->x[k][2 * grain + i] - now);
    }
    gh_text_print(out, "%s%.0f %.0f", k ? "L" : "M", px(v, x[0]), py(v, x[1]));
  }
}

static void print_dots(gh_text *out, const view *v, const report_rve *d) {
  for (size_t n = 0; n < primaries(d); n++) {
    double shift[2];
    report_rve_home(d, d->x + 2 * n, shift);
    gh_text_print(out, "<circle class=\"dot\" cx=\"%.0f\" cy=\"%.0f\" r=\"5\"/>",
                  px(v, d->x[2 * n] + shift[0]), py(v, d->x[2 * n + 1] + shift[1]));
  }
}

/* cell, low: at the start. */
static void print_traces(report *r, const report_rve *d, const traces *t, double cell[4], double low[2]) {
  view v;
  double factor = enlargement(d, t);
  for (int k = 0; k < 4; k++) cell[k] = d->cell[k] + factor * (cell[k] - d->cell[k]);
  for (int k = 0; k < 2; k++) low[k] = d->low[k] + factor * (low[k] - d->low[k]);
  view_fit(&v, d, 1.1 * largest_radius(d));
  for (int k = 0; k < 4; k++) {
    double x[2];
    corner(cell, low, k, x);
    view_include(&v, x, 0.3 * largest_radius(d));
  }
  view_end(&v);
  begin_figure(r, &v, "Traces of the grains");
  print_grains(r->out, &v, d);
  print_cell(r->out, &v, cell, low, "un");
  print_cell(r->out, &v, d->cell, d->low, "cell");
  gh_text_print(r->out, "<path class=\"tr\" d=\"");
  for (size_t n = 0; n < primaries(d); n++) print_trace(r->out, &v, d, t, factor, n);
  gh_text_print(r->out, "\"/>");
  print_dots(r->out, &v, d);
  gh_text_print(r->out, "</svg><p class=\"note\">Paths of the centres from the start to the dots");
  if (factor > 1) gh_text_print(r->out, ", motion drawn %g times as large", factor);
  gh_text_print(r->out, ". Orange: the cell now, dashed: at the start.</p></figure>\n");
}

static gh_status draw_traces(report *r, const report_rve *d) {
  traces t = {0};
  double cell[4], low[2];
  gh_status status = read_traces(r, d, &t);
  if (status == GH_OK) status = cell_at(r, d, 0, cell, low);
  if (status == GH_OK && t.n > 1) print_traces(r, d, &t, cell, low);
  else if (status == GH_OK)
    gh_text_print(
        r->out,
        "<figure><figcaption>Traces of the grains</figcaption><p class=\"soft\">The run has not "
        "recorded where the grains of this point were before; <code>results: {rves: [%d]}</code> in "
        "the scene does.</p></figure>\n",
        d->point);
  traces_free(&t);
  return status;
}

/* ---- the section ---- */

/* Old folders lack some of them. */
static gh_status print_number(report *r, const char *label, const char *name, int point) {
  double *values = NULL;
  char full[64];
  bool there;
  snprintf(full, sizeof full, "/step%04d/%s", r->n - 1, name);
  GH_TRY(gh_h5_there(r->results, full, &there));
  if (!there) return GH_OK;
  gh_status status = report_field(r, r->n - 1, name, (size_t)r->np, 1, &values);
  if (status == GH_OK) gh_text_print(r->out, "%s %.4g, ", label, values[point]);
  free(values);
  return status;
}

static gh_status print_numbers(report *r, int point) {
  static const char *const number[][2] = {{"contacts", "points/contacts"},
                                          {"coordination", "points/coordination"},
                                          {"rattlers", "points/rattlers"},
                                          {"sliding contacts", "points/sliding"},
                                          {"volume fraction", "points/volume_fraction"},
                                          {"anisotropy", "points/anisotropy"},
                                          {"residual", "points/residual"}};
  for (size_t k = 0; k < sizeof number / sizeof *number; k++)
    GH_TRY(print_number(r, number[k][0], number[k][1], point));
  return GH_OK;
}

static gh_status print_head(report *r, int point) {
  const double *s = r->cauchy + 4 * point;
  gh_text_print(r->out, "<h3 id=\"point%d\">Point %d", point, point);
  if (point == r->most_shown)
    gh_text_print(r->out, ", the largest von Mises stress%s",
                  point == r->most ? "" : " of the recorded points");
  if (r->tangents && point == r->least_shown)
    gh_text_print(r->out, ", the smallest acoustic eigenvalue%s",
                  point == r->least ? "" : " of the recorded points");
  gh_text_print(r->out, "</h3>\n<p class=\"soft\">Element %d, at (%.4g, %.4g)", point / 4,
                r->gauss[2 * point], r->gauss[2 * point + 1]);
  print_length(r);
  gh_text_print(r->out, ". Cauchy stress s11 %.4g, s22 %.4g, s12 %.4g", s[0], s[3], 0.5 * (s[1] + s[2]));
  if (*r->labels.stress) {
    gh_text_print(r->out, " ");
    report_escape(r->out, r->labels.stress);
  }
  gh_text_print(r->out, "; ");
  GH_TRY(print_numbers(r, point));
  if (r->tangents)
    gh_text_print(r->out, "acoustic eigenvalue %.4g.</p>\n",
                  r->acoustic[(size_t)(r->n - 1) * (size_t)r->np + (size_t)point]);
  else gh_text_print(r->out, "no acoustic tensor.</p>\n");
  return GH_OK;
}

static gh_status draw_point(report *r, int point) {
  report_rve d = {0};
  gh_status status = report_rve_read(r->ctx, r->rves, point, &d);
  if (status == GH_OK && (d.step < 0 || d.step > r->n))
    status = gh_fail(r->ctx, GH_INPUT, "%s/rves.h5 is of increment %d, results.h5 ends with %d", r->folder,
                     d.step, r->n - 1);
  if (status == GH_OK) status = print_head(r, point);
  if (status == GH_OK) {
    gh_text_print(r->out, "<div class=\"grid\">\n");
    draw_network(r, &d);
    status = draw_densities(r, &d);
    if (status == GH_OK) status = draw_traces(r, &d);
    gh_text_print(r->out, "</div>\n");
  }
  report_rve_free(&d);
  return status;
}

gh_status report_packings(report *r) {
  gh_text_print(
      r->out, "<h2 id=\"packings\">Packings</h2>\n<p class=\"soft\">At the last increment. The density of a "
              "direction is the share of the contacts (of the overlaps, for the forces) within an angle of "
              "influence of 25\xc2\xb0 around it, over what an even distribution would have: 1 is the dark "
              "circle. Anisotropy is the difference of the principal values of mean n\xe2\x8a\x97n over "
              "their sum.</p>\n");
  if (!r->rves) {
    gh_text_print(r->out,
                  "<p>The run has recorded no grains: <code>results: {rves: [...]}</code> in the scene "
                  "chooses points.</p>\n");
    return GH_OK;
  }
  for (int k = 0; k < r->npoints; k++) {
    bool recorded;
    GH_TRY(report_rve_recorded(r->rves, r->points[k], &recorded));
    if (recorded) GH_TRY(draw_point(r, r->points[k]));
    else {
      GH_TRY(print_head(r, r->points[k]));
      gh_text_print(r->out,
                    "<p>Its grains are not recorded: <code>results: {rves: [%d]}</code> in the scene does "
                    "it.</p>\n",
                    r->points[k]);
    }
  }
  return GH_OK;
}
