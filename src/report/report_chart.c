/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Charts of the report as SVG text. */
#include "report/report.h"

#include <string.h>

/* The page of a chart, in units that are pixels on a screen of common width. */
enum { WIDTH = 420, HEIGHT = 290, LEFT = 60, RIGHT = 12, TOP = 30, BOTTOM = 48, MOST_MARKERS = 400 };

void report_escape(gh_text *out, const char *text) {
  for (; *text; text++) {
    if (*text == '&') gh_text_print(out, "&amp;");
    else if (*text == '<') gh_text_print(out, "&lt;");
    else if (*text == '>') gh_text_print(out, "&gt;");
    else if (*text == '"') gh_text_print(out, "&quot;");
    else gh_text_print(out, "%c", *text);
  }
}

/* ---- axes ---- */

typedef struct axes {
  double low[2], high[2]; /* of x and of y, y as a power of ten where it is logarithmic */
  bool log_y;
} axes;

static double scaled(const axes *a, int i, double v) {
  return i && a->log_y ? (v > 0 ? log10(v) : NAN) : v;
}

static double place(const axes *a, int i, double v) {
  double t = (scaled(a, i, v) - a->low[i]) / (a->high[i] - a->low[i]);
  return i ? HEIGHT - BOTTOM - t * (HEIGHT - BOTTOM - TOP) : LEFT + t * (WIDTH - LEFT - RIGHT);
}

static void include(axes *a, int i, double v) {
  v = scaled(a, i, v);
  if (!isfinite(v)) return;
  a->low[i] = fmin(a->low[i], v), a->high[i] = fmax(a->high[i], v);
}

static void find_axes(const report_chart *c, axes *a) {
  *a = (axes){.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}, .log_y = c->log_y};
  for (int k = 0; k < c->nseries; k++)
    for (int j = 0; j < c->series[k].n; j++) {
      double x = c->series[k].x[j];
      include(a, 0, c->bars ? x - 0.6 : x);
      include(a, 0, c->bars ? x + 0.6 : x);
      include(a, 1, c->series[k].y[j]);
    }
  include(a, 1, c->line);
  if (c->zero || c->bars) include(a, 1, 0);
  for (int i = 0; i < 2; i++) {
    double size = fmax(fabs(a->low[i]), fabs(a->high[i])), range = a->high[i] - a->low[i];
    if (!isfinite(size)) a->low[i] = 0, a->high[i] = 1; /* nothing to draw */
    else if (range < 1e-9 * size + 1e-300) a->low[i] -= 0.1 * size + 1e-12, a->high[i] += 0.1 * size + 1e-12;
    else if (i) {
      bool bottom = (c->zero || c->bars) && a->low[1] == 0;
      if (!bottom) a->low[1] -= 0.06 * range;
      a->high[1] += 0.06 * range;
    } else if (!c->bars) a->low[0] -= 0.02 * range, a->high[0] += 0.02 * range;
  }
}

static void print_tick(gh_text *out, const axes *a, int i, double v, const char *label) {
  double range = a->high[i] - a->low[i], t = (v - a->low[i]) / range;
  if (i) {
    double y = HEIGHT - BOTTOM - t * (HEIGHT - BOTTOM - TOP);
    gh_text_print(out,
                  "<path class=\"gr\" d=\"M%d %.1fH%d\"/><text class=\"e\" x=\"%d\" y=\"%.1f\">%s</text>",
                  LEFT, y, WIDTH - RIGHT, LEFT - 7, y + 4.5, label);
  } else {
    double x = LEFT + t * (WIDTH - LEFT - RIGHT);
    gh_text_print(out, "<path class=\"ax\" d=\"M%.1f %dv5\"/><text class=\"m\" x=\"%.1f\" y=\"%d\">%s</text>",
                  x, HEIGHT - BOTTOM, x, HEIGHT - BOTTOM + 20, label);
  }
}

/* -0.5 with a true minus sign. */
static const char *tick_label(char text[48], double v, double step) {
  char plain[32];
  if (fabs(v) < 1e-9 * step) v = 0;
  snprintf(plain, sizeof plain, "%.5g", fabs(v));
  snprintf(text, 48, "%s%s", v < 0 ? "\xe2\x88\x92" : "", plain);
  return text;
}

static void print_ticks(gh_text *out, const axes *a, int i) {
  double range = a->high[i] - a->low[i], step = report_tick_step(range);
  bool powers = i && a->log_y;
  char text[96];
  if (powers) step = fmax(1, round(range / 5));
  for (double v = ceil(a->low[i] / step - 1e-9) * step; v <= a->high[i] + 1e-9 * step; v += step) {
    if (powers)
      snprintf(text, sizeof text, "10<tspan dy=\"-5\" style=\"font-size:.75em\">%s%.0f</tspan>",
               v < 0 ? "\xe2\x88\x92" : "", fabs(v));
    else tick_label(text, v, step);
    print_tick(out, a, i, v, text);
  }
}

static void print_frame(gh_text *out, const report_chart *c, const axes *a) {
  print_ticks(out, a, 1);
  print_ticks(out, a, 0);
  gh_text_print(out, "<path class=\"ax\" d=\"M%d %dH%d\"/>", LEFT, HEIGHT - BOTTOM, WIDTH - RIGHT);
  if (a->low[1] < 0 && a->high[1] > 0 && !a->log_y)
    gh_text_print(out, "<path class=\"ax\" d=\"M%d %.1fH%d\"/>", LEFT, place(a, 1, 0), WIDTH - RIGHT);
  gh_text_print(out, "<text class=\"s\" x=\"0\" y=\"14\">");
  report_escape(out, c->y_label);
  gh_text_print(out, "</text><text class=\"s e\" x=\"%d\" y=\"%d\">", WIDTH - RIGHT, HEIGHT - 8);
  report_escape(out, c->x_label);
  gh_text_print(out, "</text>");
  if (!isfinite(c->line)) return;
  gh_text_print(out, "<path class=\"lv\" d=\"M%d %.1fH%d\"/><text class=\"s e\" x=\"%d\" y=\"%.1f\">", LEFT,
                place(a, 1, c->line), WIDTH - RIGHT, WIDTH - RIGHT, place(a, 1, c->line) - 5);
  report_escape(out, c->line_label);
  gh_text_print(out, "</text>");
}

/* ---- series ---- */

static void print_line(gh_text *out, const axes *a, const report_series *s, int colour) {
  bool down = false;
  gh_text_print(out, "<path class=\"ln s%d\" d=\"", colour);
  for (int j = 0; j < s->n; j++) {
    double x = place(a, 0, s->x[j]), y = place(a, 1, s->y[j]);
    if (!isfinite(x) || !isfinite(y)) down = false;
    else gh_text_print(out, "%s%.1f %.1f", down ? "L" : "M", x, y), down = true;
  }
  gh_text_print(out, "\"/>");
}

static void print_values(gh_text *out, const report_chart *c, const report_series *s, int j) {
  gh_text_print(out, "data-t=\"");
  if (c->nseries > 1) {
    report_escape(out, s->name);
    gh_text_print(out, ", ");
  }
  if (c->bars) gh_text_print(out, "increment %.0f: %.5g\"", s->x[j], s->y[j]);
  else gh_text_print(out, "increment %d: %.5g, %.5g\"", c->first + j, s->x[j], s->y[j]);
}

static void print_markers(gh_text *out, const report_chart *c, const axes *a, const report_series *s,
                          int colour) {
  for (int j = 0; j < s->n; j++) {
    double x = place(a, 0, s->x[j]), y = place(a, 1, s->y[j]);
    if (!isfinite(x) || !isfinite(y)) continue;
    int mark = s->mark && s->mark[j] ? s->mark[j] : colour;
    gh_text_print(out, "<circle class=\"hit f%d\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" ", mark, x, y,
                  mark == colour ? 2.4 : 4.2);
    print_values(out, c, s, j);
    gh_text_print(out, "/>");
  }
}

static void print_bars(gh_text *out, const report_chart *c, const axes *a, const report_series *s,
                       int colour) {
  double wide = (WIDTH - LEFT - RIGHT) / (a->high[0] - a->low[0]) * 0.8;
  for (int j = 0; j < s->n; j++) {
    double x = place(a, 0, s->x[j]), y = place(a, 1, s->y[j]), base = HEIGHT - BOTTOM;
    if (!isfinite(x) || !isfinite(y)) continue;
    gh_text_print(out, "<rect class=\"f%d\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" ",
                  s->mark && s->mark[j] ? s->mark[j] : colour, x - wide / 2, y, wide, fmax(base - y, 0));
    print_values(out, c, s, j);
    gh_text_print(out, "/>");
  }
}

static void print_key(gh_text *out, const report_chart *c) {
  if (c->nseries < 2 && c->nmarks == 0) return;
  gh_text_print(out, "<div class=\"key\">");
  for (int k = 0; k < (c->nmarks ? c->nmarks : c->nseries); k++) {
    gh_text_print(out, "<span><i class=\"f%d\"></i>", k % 6 + 1);
    report_escape(out, c->nmarks ? c->mark_names[k] : c->series[k].name);
    gh_text_print(out, "</span>");
  }
  gh_text_print(out, "</div>");
}

void report_draw_chart(gh_text *out, const report_chart *c) {
  axes a;
  find_axes(c, &a);
  gh_text_print(out, "<figure><figcaption>");
  report_escape(out, c->title);
  gh_text_print(out, "</figcaption><svg viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"", WIDTH, HEIGHT);
  report_escape(out, c->title);
  gh_text_print(out, "\">");
  print_frame(out, c, &a);
  for (int k = 0; k < c->nseries; k++) {
    const report_series *s = c->series + k;
    int colour = k % 6 + 1;
    if (c->bars) print_bars(out, c, &a, s, colour);
    else print_line(out, &a, s, colour);
    if (!c->bars && s->n <= MOST_MARKERS) print_markers(out, c, &a, s, colour);
  }
  gh_text_print(out, "</svg>");
  print_key(out, c);
  gh_text_print(out, "</figure>\n");
}

/* ---- shares of a whole ---- */

void report_draw_shares(gh_text *out, const char *title, const char *unit, int n, const report_share *s) {
  double whole = 0, x = 0;
  for (int k = 0; k < n; k++) whole += s[k].value;
  gh_text_print(out, "<figure><figcaption>");
  report_escape(out, title);
  gh_text_print(out, "</figcaption><svg viewBox=\"0 0 %d 34\" role=\"img\" aria-label=\"", WIDTH);
  report_escape(out, title);
  gh_text_print(out, "\">");
  for (int k = 0; k < n && whole > 0; k++) {
    double wide = s[k].value / whole * WIDTH;
    gh_text_print(out,
                  "<rect class=\"f%d\" x=\"%.2f\" y=\"2\" width=\"%.2f\" height=\"28\" data-t=\"%s: %.3g %s, "
                  "%.1f %%\"/>",
                  k % 6 + 1, x, wide, s[k].name, s[k].value, unit, 100 * s[k].value / whole);
    x += wide;
  }
  gh_text_print(out, "</svg><table>");
  for (int k = 0; k < n; k++)
    gh_text_print(out,
                  "<tr><td><span class=\"key\"><span><i class=\"f%d\"></i>%s</span></span></td><td>%.3f "
                  "%s</td><td>%.1f %%</td></tr>",
                  k % 6 + 1, s[k].name, s[k].value, unit, whole > 0 ? 100 * s[k].value / whole : 0);
  gh_text_print(out, "</table></figure>\n");
}

/* ---- polar diagrams ---- */

enum { POLAR = 300, RADIUS = 122 };

static void print_polar(gh_text *out, int m, const double *f, double scale, int colour, const char *dash) {
  gh_text_print(out, "<path class=\"ln s%d\"%s d=\"", colour, dash);
  for (int k = 0; k < m; k++) {
    double angle = 2 * GH_PI * k / m, r = scale * f[k];
    gh_text_print(out, "%s%.1f %.1f", k ? "L" : "M", POLAR / 2.0 + r * cos(angle),
                  POLAR / 2.0 - r * sin(angle));
  }
  gh_text_print(out, "Z\"/>");
}

void report_draw_polar(gh_text *out, int m, const double *contacts, const double *forces) {
  double most = 1.5;
  for (int k = 0; k < m; k++) most = fmax(most, fmax(contacts[k], forces[k]));
  double scale = RADIUS / most, ring = most > 4 ? ceil(most / 4) : most > 2 ? 1 : 0.5;
  gh_text_print(out,
                "<figure><figcaption>Densities over the direction</figcaption><svg viewBox=\"0 0 %d %d\" "
                "role=\"img\" aria-label=\"density functions\">",
                POLAR, POLAR);
  for (int k = 0; k < 12; k++)
    gh_text_print(out, "<path class=\"gr\" d=\"M%d %dL%.1f %.1f\"/>", POLAR / 2, POLAR / 2,
                  POLAR / 2 + RADIUS * cos(GH_PI * k / 6), POLAR / 2 - RADIUS * sin(GH_PI * k / 6));
  for (double v = ring; v <= most * 1.0001; v += ring)
    gh_text_print(out, "<circle class=\"gr\" cx=\"%d\" cy=\"%d\" r=\"%.1f\"/>", POLAR / 2, POLAR / 2,
                  v * scale);
  gh_text_print(out, "<circle class=\"ax\" cx=\"%d\" cy=\"%d\" r=\"%.1f\"/>", POLAR / 2, POLAR / 2, scale);
  print_polar(out, m, contacts, scale, 1, "");
  print_polar(out, m, forces, scale, 2, " stroke-dasharray=\"6 3\"");
  for (double v = ring; v <= most * 1.0001; v += ring)
    gh_text_print(out, "<text class=\"s ring\" x=\"%.1f\" y=\"%.1f\">%.3g</text>",
                  POLAR / 2 + v * scale * cos(GH_PI / 12) + 2, POLAR / 2 - v * scale * sin(GH_PI / 12), v);
  gh_text_print(
      out,
      "<text class=\"s\" x=\"%d\" y=\"%d\">x</text><text class=\"s m\" x=\"%d\" y=\"14\">y</text>"
      "</svg><div class=\"key\"><span><i class=\"f1\"></i>contacts</span><span><i class=\"f2\"></i>"
      "forces (dashed)</span></div><p class=\"note\">Dark circle: the same in all directions.</p></figure>\n",
      POLAR - 14, POLAR / 2 + 4, POLAR / 2);
}
