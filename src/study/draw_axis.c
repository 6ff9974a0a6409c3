/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Colours, logarithmic axes and files: what the pictures of a study share. */
#include "study/draw.h"

#include <stdlib.h>

const char *study_colour(int k) {
  static const char *const colour[STUDY_COLOURS] = {"#31688e", "#d95f02", "#35b779", "#7b3294",
                                                    "#e7298a", "#8c6d31", "#17becf", "#66a61e",
                                                    "#b2182b", "#6a5acd", "#e6ab02", "#1b4f3a"};
  return k >= 0 && k < STUDY_COLOURS ? colour[k] : "#b5b5b5";
}

/* ---- logarithmic axes ---- */

/* Plain numbers where the whole axis can have them, else powers of ten. */
static void print_mark(gh_text *out, int digit, int decade, bool plain) {
  if (plain) gh_text_print(out, "'%g' ", digit * pow(10, decade));
  else if (digit == 1) gh_text_print(out, "'10^{%d}' ", decade);
  else
    gh_text_print(out,
                  "'%d\xc2\xb7"
                  "10^{%d}' ",
                  digit, decade);
}

/* Labels at 1, 2, 5 of each decade of a short axis, at every decade or some of a long one; small marks at the
 * other digits. */
static void print_marks(gh_text *out, char axis, const double range[2]) {
  int first = (int)floor(log10(range[0])), last = (int)ceil(log10(range[1]));
  double decades = log10(range[1] / range[0]);
  int step = decades > 9 ? (int)ceil(decades / 9) : 1;
  bool plain = range[0] > 0.9e-3 && range[1] < 2e4;
  const char *comma = "";
  gh_text_print(out, "set %ctics (", axis);
  for (int d = first; d <= last; d++)
    for (int k = 1; k < 10; k++) {
      double v = k * pow(10, d);
      if (v < range[0] * (1 - 1e-9) || v > range[1] * (1 + 1e-9)) continue;
      bool label = (k == 1 && d % step == 0) || (decades < 2.2 && (k == 2 || k == 5)) ||
                   (decades < 0.9 && k != 7 && k != 9);
      if (!label && (step > 1 ? k > 1 : decades > 6)) continue;
      gh_text_print(out, "%s", comma);
      if (label) print_mark(out, k, d, plain);
      else gh_text_print(out, "'' ");
      gh_text_print(out, "%.17g%s", v, label ? "" : " 1");
      comma = ", ";
    }
  gh_text_print(out, ")\n");
}

void study_log_axis(gh_text *out, char axis, double low, double high, double range[2]) {
  double decades = log10(high / low), pad = fmax(0.07 * decades, fmax(0.08, 0.5 * (0.7 - decades)));
  range[0] = low * pow(10, -pad), range[1] = high * pow(10, pad);
  gh_text_print(out, "set logscale %c\nset %crange [%.17g:%.17g]\n", axis, axis, range[0], range[1]);
  print_marks(out, axis, range);
}

/* ---- files ---- */

gh_status study_picture(const gh_study *s, const char *folder, const char *name, int width, int height,
                        gh_text *commands) {
  GH_TRY(gh_text_check(commands));
  char *png = gh_path_join(folder, name);
  if (!png) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_picture_script(s->ctx, gh_text_get(commands, NULL), width, height, png);
  free(png);
  return status;
}

double study_zero_floor(const gh_study *s) {
  double smallest = INFINITY;
  for (int k = 0; k < s->nconfigs; k++) {
    if (study_is_rated(s, k) && study_error_of(s, k) > 0) smallest = fmin(smallest, study_error_of(s, k));
  }
  return isfinite(smallest) ? smallest / 10 : 1e-16;
}
