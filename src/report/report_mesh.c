/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Fields on the deformed mesh. */
#include "report/report.h"

#include <stdlib.h>
#include <string.h>

/* The page of a picture; coordinates of paths are tenths of its units. */
enum { WIDTH = 430, LEFT = 42, RIGHT = 76, TOP = 8, BOTTOM = 44, TALLEST = 460 };

typedef struct frame {
  double *u;             /* nnodes x 3 */
  double *mises, *shear; /* nnodes */
  double *angle;         /* np: of the direction with the smallest acoustic eigenvalue */
  const double *acoustic;
} frame;

typedef struct picture {
  report *r;
  frame frames[REPORT_FILM];
  double factor; /* by which displacements are drawn larger */
  double low[2], high[2], scale, height;
} picture;

static void picture_free(picture *p) {
  for (int k = 0; k < REPORT_FILM; k++) {
    free(p->frames[k].u);
    free(p->frames[k].mises);
    free(p->frames[k].shear);
    free(p->frames[k].angle);
  }
}

/* ---- values ---- */

/* E = (F^T F - 1)/2 of the points to the nodes, and there the largest shear E_I - E_II. */
static gh_status nodal_shear(report *r, int k, double **shear) {
  size_t np = (size_t)r->np, nn = (size_t)r->mesh.nnodes;
  double *F = NULL, *E = NULL;
  gh_status status;
  GH_TRY_OR(report_field(r, k, "points/F", np, 4, &F), done);
  GH_TRY_OR(gh_alloc(r->ctx, 3 * nn, sizeof *E, &E), done);
  GH_TRY_OR(gh_alloc(r->ctx, nn, sizeof **shear, shear), done);
  for (size_t p = 0; p < np; p++) {
    const double *f = F + 4 * p;
    double e[3] = {0.5 * (f[0] * f[0] + f[2] * f[2] - 1), 0.5 * (f[0] * f[1] + f[2] * f[3]),
                   0.5 * (f[1] * f[1] + f[3] * f[3] - 1)};
    memcpy(F + 3 * p, e, sizeof e); /* in place: three numbers for four */
  }
  GH_TRY_OR(gh_mesh_nodal_average(r->ctx, &r->mesh, 3, F, E), done);
  for (size_t n = 0; n < nn; n++) (*shear)[n] = hypot(E[3 * n] - E[3 * n + 2], 2 * E[3 * n + 1]);
done:
  free(F);
  free(E);
  return status;
}

static gh_status read_frame(report *r, int k, frame *f) {
  size_t nn = (size_t)r->mesh.nnodes, np = (size_t)r->np;
  f->acoustic = r->acoustic + (size_t)k * np;
  GH_TRY(report_field(r, k, "displacement", nn, 3, &f->u));
  GH_TRY(report_field(r, k, "von_mises", nn, 1, &f->mises));
  if (r->tangents) GH_TRY(report_field(r, k, "points/acoustic_angle", np, 1, &f->angle));
  return nodal_shear(r, k, &f->shear);
}

/* ---- places ---- */

static double drawn(const picture *p, const frame *f, int node, int i) {
  return p->r->mesh.X[2 * node + i] + p->factor * f->u[3 * node + i];
}

/* The largest displacement of the film is drawn as about 4 % of the body: 1, 2 or 5 times a power of ten. */
static double enlargement(const picture *p) {
  const gh_mesh *m = &p->r->mesh;
  double most = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int n = 0; n < m->nnodes; n++) {
    for (int k = 0; k < p->r->nfilm; k++)
      most = fmax(most, hypot(p->frames[k].u[3 * n], p->frames[k].u[3 * n + 1]));
    for (int i = 0; i < 2; i++)
      low[i] = fmin(low[i], m->X[2 * n + i]), high[i] = fmax(high[i], m->X[2 * n + i]);
  }
  double wanted = 0.04 * fmax(high[0] - low[0], high[1] - low[1]) / fmax(most, 1e-300);
  if (wanted < 1.5 || most == 0) return 1;
  double power = pow(10, floor(log10(wanted))), x = wanted / power;
  return power * (x < 2 ? 1 : x < 5 ? 2 : 5);
}

static void fit(picture *p) {
  const gh_mesh *m = &p->r->mesh;
  for (int i = 0; i < 2; i++) {
    p->low[i] = INFINITY, p->high[i] = -INFINITY;
    for (int n = 0; n < m->nnodes; n++)
      for (int k = -1; k < p->r->nfilm; k++) {
        double x = k < 0 ? m->X[2 * n + i] : drawn(p, p->frames + k, n, i);
        p->low[i] = fmin(p->low[i], x), p->high[i] = fmax(p->high[i], x);
      }
  }
  double w = fmax(p->high[0] - p->low[0], 1e-300), h = fmax(p->high[1] - p->low[1], 1e-300);
  p->scale = fmin((WIDTH - LEFT - RIGHT) / w, (TALLEST - TOP - BOTTOM) / h);
  p->height = fmax(TOP + BOTTOM + p->scale * h, 200);
}

static double px(const picture *p, double x) {
  return LEFT + p->scale * (x - p->low[0]);
}
static double py(const picture *p, double y) {
  return p->height - BOTTOM - p->scale * (y - p->low[1]);
}

/* The point (s, t) in [0, 1]^2 of an element, in tenths of a unit of the page. */
static void in_element(const picture *p, const frame *f, int e, double s, double t, int at[2]) {
  double N[4] = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t}, x[2] = {0, 0};
  for (int a = 0; a < 4; a++)
    for (int i = 0; i < 2; i++) x[i] += N[a] * drawn(p, f, p->r->mesh.quad[e][a], i);
  at[0] = (int)lround(10 * px(p, x[0]));
  at[1] = (int)lround(10 * py(p, x[1]));
}

/* A quadrilateral of an element as a part of a path. */
static void print_patch(const picture *p, const frame *f, int e, double s0, double s1, double t0, double t1) {
  int a[4][2];
  in_element(p, f, e, s0, t0, a[0]);
  in_element(p, f, e, s1, t0, a[1]);
  in_element(p, f, e, s1, t1, a[2]);
  in_element(p, f, e, s0, t1, a[3]);
  gh_text_print(p->r->out, "M%d %d", a[0][0], a[0][1]);
  for (int k = 1; k < 4; k++)
    gh_text_print(p->r->out, "l%d %d", a[k][0] - a[k - 1][0], a[k][1] - a[k - 1][1]);
  gh_text_print(p->r->out, "z");
}

/* ---- colours ---- */

enum { SHADES = 40 };

static const char *shade(int k, char text[8]) {
  double rgb[3];
  report_colour((k + 0.5) / SHADES, rgb);
  snprintf(text, 8, "#%02x%02x%02x", (unsigned)lround(255 * rgb[0]), (unsigned)lround(255 * rgb[1]),
           (unsigned)lround(255 * rgb[2]));
  return text;
}

static int shade_of(double v, double low, double high) {
  int k = (int)floor(SHADES * (v - low) / (high - low));
  return k < 0 ? 0 : k >= SHADES ? SHADES - 1 : k;
}

static void print_bar(const picture *p, double low, double high, bool lost) {
  gh_text *out = p->r->out;
  double x = px(p, p->high[0]) + 16, top = TOP + 4, h = fmin(p->height - TOP - BOTTOM - 8, 260), step;
  char text[8];
  if (lost) h -= 24;
  for (int k = 0; k < SHADES; k++)
    gh_text_print(out, "<rect x=\"%.0f\" y=\"%.2f\" width=\"14\" height=\"%.2f\" fill=\"%s\"/>", x,
                  top + h * (SHADES - 1 - k) / SHADES, h / SHADES + 0.3, shade(k, text));
  step = report_tick_step((high - low) * 1.2);
  for (double v = ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) {
    double y = top + h * (1 - (v - low) / (high - low)), value = fabs(v) < 1e-9 * step ? 0 : v;
    gh_text_print(out, "<path class=\"ax\" d=\"M%.0f %.1fh4\"/><text x=\"%.0f\" y=\"%.1f\">%s%.4g</text>",
                  x + 14, y, x + 21, y + 4.5, value < 0 ? "\xe2\x88\x92" : "", fabs(value));
  }
  if (lost)
    gh_text_print(out,
                  "<rect class=\"lost\" x=\"%.0f\" y=\"%.1f\" width=\"14\" height=\"14\"/><text x=\"%.0f\" "
                  "y=\"%.1f\">\xe2\x89\xa4 0</text>",
                  x, top + h + 14, x + 21, top + h + 25.5);
}

/* ---- one picture ---- */

static gh_status print_outline(const picture *p) {
  gh_mesh_edge *edges;
  int count;
  const gh_mesh *m = &p->r->mesh;
  GH_TRY(gh_mesh_boundary_edges(p->r->ctx, m->nelements, (const int(*)[4])m->quad, &edges, &count));
  gh_text_print(p->r->out, "<path class=\"un\" d=\"");
  for (int k = 0; k < count; k++)
    gh_text_print(p->r->out, "M%.0f %.0fL%.0f %.0f", 10 * px(p, m->X[2 * edges[k].a]),
                  10 * py(p, m->X[2 * edges[k].a + 1]), 10 * px(p, m->X[2 * edges[k].b]),
                  10 * py(p, m->X[2 * edges[k].b + 1]));
  gh_text_print(p->r->out, "\"/>");
  free(edges);
  return GH_OK;
}

static void print_edges(const picture *p, const frame *f) {
  enum { MOST = 4000 }; /* beyond that they are denser than the screen */
  if (p->r->mesh.nelements > MOST) return;
  gh_text_print(p->r->out, "<path class=\"ed\" style=\"stroke-width:%d\" d=\"",
                p->r->mesh.nelements < 400 ? 10 : 4);
  for (int e = 0; e < p->r->mesh.nelements; e++) print_patch(p, f, e, 0, 1, 0, 1);
  gh_text_print(p->r->out, "\"/>");
}

/* Coordinates of the body along the lower and the left side. */
static void print_axes(const picture *p) {
  for (int i = 0; i < 2; i++) {
    double step = report_tick_step((p->high[i] - p->low[i]) * 1.6);
    for (double v = ceil(p->low[i] / step - 1e-9) * step; v <= p->high[i] + 1e-9 * step; v += step) {
      double value = fabs(v) < 1e-9 * step ? 0 : v;
      const char *minus = value < 0 ? "\xe2\x88\x92" : "";
      if (i)
        gh_text_print(p->r->out, "<text class=\"s e\" x=\"%d\" y=\"%.1f\">%s%.5g</text>", LEFT - 7,
                      py(p, v) + 4.5, minus, fabs(value));
      else
        gh_text_print(p->r->out, "<text class=\"s m\" x=\"%.1f\" y=\"%.1f\">%s%.5g</text>", px(p, v),
                      p->height - BOTTOM + 19, minus, fabs(value));
    }
  }
  if (*p->r->labels.length) {
    gh_text_print(p->r->out, "<text class=\"s m\" x=\"%.1f\" y=\"%.1f\">",
                  px(p, 0.5 * (p->low[0] + p->high[0])), p->height - 6);
    report_escape(p->r->out, p->r->labels.length);
    gh_text_print(p->r->out, "</text>");
  }
}

/* Where the patches of an element are, side x side of them. */
typedef struct patches {
  int side;
  unsigned char *colour; /* side x side for each element, row after row */
} patches;

static gh_status colour_patches(const picture *p, const double *value, double low, double high, patches *t) {
  int ne = p->r->mesh.nelements, side = (int)sqrt(6000.0 / ne);
  t->side = side = side < 1 ? 1 : side > 24 ? 24 : side;
  size_t each = (size_t)side * (size_t)side;
  GH_TRY(gh_alloc(p->r->ctx, each * (size_t)ne, 1, &t->colour));
  for (size_t k = 0; k < each * (size_t)ne; k++) {
    int e = (int)(k / each), rest = (int)(k % each);
    double s = (rest % side + 0.5) / side, at = (rest / side + 0.5) / side, v = 0;
    double N[4] = {(1 - s) * (1 - at), s * (1 - at), s * at, (1 - s) * at};
    for (int a = 0; a < 4; a++) v += N[a] * value[p->r->mesh.quad[e][a]];
    t->colour[k] = (unsigned char)shade_of(v, low, high);
  }
  return GH_OK;
}

/* The patches of one colour as one path; neighbours in a row are one strip, which has straight sides in a
 * bilinear element. */
static void print_shade(const picture *p, const frame *f, const patches *t, int c) {
  int side = t->side, rows = p->r->mesh.nelements * side;
  bool any = false;
  char text[8];
  for (int row = 0; row < rows; row++) {
    const unsigned char *colour = t->colour + (size_t)row * (size_t)side;
    for (int k = 0; k < side; k++) {
      if (colour[k] != c) continue;
      int begin = k;
      while (k + 1 < side && colour[k + 1] == c) k++;
      if (!any) gh_text_print(p->r->out, "<path fill=\"%s\" stroke=\"%s\" d=\"", shade(c, text), text);
      any = true;
      print_patch(p, f, row / side, (double)begin / side, (k + 1.0) / side, (double)(row % side) / side,
                  (row % side + 1.0) / side);
    }
  }
  if (any) gh_text_print(p->r->out, "\"/>");
}

/* A field given at the nodes. */
static gh_status print_smooth(const picture *p, const frame *f, const double *value, double low,
                              double high) {
  patches t;
  GH_TRY(colour_patches(p, value, low, high, &t));
  for (int c = 0; c < SHADES; c++) print_shade(p, f, &t, c);
  free(t.colour);
  return GH_OK;
}

/* The quarter of each element that belongs to a point, in the colour of the point's value. */
static void print_points(const picture *p, const frame *f, double high) {
  const report *r = p->r;
  bool tell = r->np <= 1000;
  char text[8];
  for (int point = 0; point < r->np; point++) {
    int e = point / 4, c = gh_mesh_gauss_corner(&r->mesh, e, r->gauss + 2 * point);
    double s = c == 1 || c == 2 ? 0.5 : 0, t = c >= 2 ? 0.5 : 0, v = f->acoustic[point];
    if (v > 0)
      gh_text_print(r->out, "<path fill=\"%s\" stroke=\"%s\"", shade(shade_of(v, 0, high), text), text);
    else gh_text_print(r->out, "<path class=\"lost\"");
    if (tell) gh_text_print(r->out, " data-t=\"point %d: %.4g\"", point, v);
    gh_text_print(r->out, " d=\"");
    print_patch(p, f, e, s, s + 0.5, t, t + 0.5);
    gh_text_print(r->out, "\"/>");
  }
}

/* Where ellipticity is lost: the line across the direction N, as a band would run. */
static void print_bands(const picture *p, const frame *f) {
  const report *r = p->r;
  for (int point = 0; point < r->np; point++) {
    if (f->acoustic[point] > 0) continue;
    int e = point / 4, c = gh_mesh_gauss_corner(&r->mesh, e, r->gauss + 2 * point), at[2], corner[2];
    double s = c == 1 || c == 2 ? 0.75 : 0.25, t = c >= 2 ? 0.75 : 0.25;
    in_element(p, f, e, s, t, at);
    in_element(p, f, e, s < 0.5 ? 0 : 1, t < 0.5 ? 0 : 1, corner);
    double half = 0.55 * hypot(at[0] - corner[0], at[1] - corner[1]);
    double x = -half * sin(f->angle[point]), y = half * cos(f->angle[point]);
    gh_text_print(r->out, "<path style=\"stroke:#111;stroke-width:16\" d=\"M%.0f %.0fl%.0f %.0f\"/>",
                  at[0] - x, at[1] + y, 2 * x, -2 * y);
  }
}

/* ---- the section ---- */

typedef enum field { MISES, SHEAR, ACOUSTIC } field;

static const double *values(const frame *f, field which) {
  return which == MISES ? f->mises : which == SHEAR ? f->shear : f->acoustic;
}

/* What the colours of a picture span: the values of its increment, but no less than a tenth of the largest of
 * them nor a fiftieth of the largest of the film, so that round-off does not fill the picture. */
static void range(const picture *p, field which, int frame_number, double *low, double *high, bool *lost) {
  int n = which == ACOUSTIC ? p->r->np : p->r->mesh.nnodes;
  double largest = 0;
  *low = INFINITY, *high = -INFINITY;
  for (int k = 0; k < p->r->nfilm; k++)
    for (int j = 0; j < n; j++) {
      double v = values(p->frames + k, which)[j];
      largest = fmax(largest, fabs(v));
      if (k == frame_number) *low = fmin(*low, v), *high = fmax(*high, v);
    }
  *lost = which == ACOUSTIC && *low <= 0;
  if (which == ACOUSTIC) *low = 0;
  double least = fmax(0.1 * fabs(*high), 0.02 * largest) + 1e-300;
  if (*high - *low < least) *high = *low + least;
}

static gh_status print_field(const picture *p, field which, const char *title, const char *note) {
  report *r = p->r;
  gh_text_print(r->out, "<figure class=\"mesh\"><figcaption>");
  report_escape(r->out, title);
  gh_text_print(r->out, "</figcaption>\n");
  for (int k = 0; k < r->nfilm; k++) {
    const frame *f = p->frames + k;
    double low, high;
    bool lost;
    range(p, which, k, &low, &high, &lost);
    gh_text_print(r->out, "<svg viewBox=\"0 0 %d %.0f\" role=\"img\" aria-label=\"", WIDTH, p->height);
    report_escape(r->out, title);
    gh_text_print(r->out, "\" data-frame=\"%d\"%s><g transform=\"scale(.1)\">", k,
                  k < r->nfilm - 1 ? " hidden" : "");
    if (which == ACOUSTIC) print_points(p, f, high);
    else GH_TRY(print_smooth(p, f, values(f, which), low, high));
    print_edges(p, f);
    if (which == ACOUSTIC) print_bands(p, f);
    GH_TRY(print_outline(p));
    gh_text_print(r->out, "</g>");
    print_bar(p, low, high, lost);
    print_axes(p);
    gh_text_print(r->out, "</svg>\n");
  }
  gh_text_print(r->out, "<p class=\"note\">%s</p></figure>\n", note);
  return GH_OK;
}

static void print_name(report *r, int k) {
  const char *name = report_table_text(&r->history, k, report_table_column(&r->history, "name"));
  gh_text_print(r->out, "increment %d (", k);
  for (; *name; name++) report_escape(r->out, (char[2]){*name == '|' ? '/' : *name, 0});
  gh_text_print(r->out, ")");
}

static void print_slider(report *r) {
  if (r->nfilm < 2) return;
  gh_text_print(r->out, "<div class=\"slider\" data-names=\"");
  for (int k = 0; k < r->nfilm; k++) {
    if (k) gh_text_print(r->out, "|");
    print_name(r, r->film[k]);
  }
  gh_text_print(
      r->out,
      "\"><label for=\"film\">Increment</label><input id=\"film\" type=\"range\" min=\"0\" max=\"%d\" "
      "step=\"1\" value=\"%d\"><output>",
      r->nfilm - 1, r->nfilm - 1);
  print_name(r, r->film[r->nfilm - 1]);
  gh_text_print(r->out, "</output></div>\n");
}

static gh_status print_fields(picture *p) {
  report *r = p->r;
  char title[3][160], factor[128] = "displacements as they are; dashed: undeformed";
  for (int k = 0; k < r->nfilm; k++) GH_TRY(read_frame(r, r->film[k], p->frames + k));
  p->factor = enlargement(p);
  fit(p);
  if (p->factor > 1)
    snprintf(factor, sizeof factor, "displacements drawn %g times as large; dashed: undeformed", p->factor);
  report_label(title[MISES], "Von Mises stress", r->labels.stress);
  report_label(title[SHEAR], "Shear strain E_I \xe2\x88\x92 E_II", "");
  report_label(title[ACOUSTIC], "Smallest acoustic eigenvalue", r->labels.stress);
  gh_text_print(r->out, "<h2 id=\"body\">The body</h2>\n<p class=\"soft\">Deformed mesh, ");
  print_name(r, r->film[r->nfilm - 1]);
  gh_text_print(r->out, " unless chosen otherwise; %s. The colours span the values of the increment.</p>\n",
                factor);
  print_slider(r);
  gh_text_print(r->out, "<div class=\"grid\">\n");
  GH_TRY(print_field(p, MISES, title[MISES], "Stress at the nodes, averaged over the elements."));
  GH_TRY(print_field(p, SHEAR, title[SHEAR], "Principal Green strains; 0 in the packing as read."));
  if (r->tangents)
    GH_TRY(print_field(p, ACOUSTIC, title[ACOUSTIC],
                       "At the integration points. \xe2\x89\xa4 0: ellipticity is lost; the line shows how a "
                       "band would run."));
  gh_text_print(r->out, "</div>\n");
  return GH_OK;
}

gh_status report_fields(report *r) {
  picture p = {.r = r};
  gh_status status = print_fields(&p);
  picture_free(&p);
  return status;
}
