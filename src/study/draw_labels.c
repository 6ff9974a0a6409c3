/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Names of the points of a plot. */
#include "study/draw.h"

#include <stdlib.h>
#include <string.h>

/* A box in shares of the drawing area. */
typedef struct box {
  double x[2], y[2];
} box;

/* About what the margins and the key leave of the picture, and the size of a letter in it. */
static const double LETTER_WIDTH = 6.8 / 520, LETTER_HEIGHT = 12.0 / 470, POINT = 5.0 / 520;

static bool box_overlaps(const box *a, const box *b) {
  return a->x[0] < b->x[1] && b->x[0] < a->x[1] && a->y[0] < b->y[1] && b->y[0] < a->y[1];
}

static double axis_share(const double axis[2], double v) {
  return log(v / axis[0]) / log(axis[1] / axis[0]);
}

static bool is_free(const box *b, const box *taken, int n) {
  if (b->x[0] < 0 || b->x[1] > 1.05 || b->y[0] < 0 || b->y[1] > 1) return false;
  for (int k = 0; k < n; k++)
    if (box_overlaps(b, taken + k)) return false;
  return true;
}

/* Beside the point, above or below, to the right or the left: the first place that nothing covers yet. */
static bool place_label(const study_plot *p, int k, int letters, const box *taken, int n, int *side, box *b) {
  double x = axis_share(p->x_axis, study_plot_x_of(p, k)), y = axis_share(p->y_axis, study_plot_y_of(p, k)),
         width = letters * LETTER_WIDTH;
  for (*side = 0; *side < 4; ++*side) {
    double sign = *side % 2 ? -1 : 1, middle = y + (*side < 2 ? 1 : -1) * LETTER_HEIGHT;
    double near = x + 2 * sign * POINT, far = near + sign * width;
    *b = (box){{fmin(near, far), fmax(near, far)},
               {middle - 0.55 * LETTER_HEIGHT, middle + 0.55 * LETTER_HEIGHT}};
    if (is_free(b, taken, n)) return true;
  }
  return false;
}

gh_status study_plot_labels(const study_plot *p, gh_text *t) {
  box *taken;
  int n = 0, side;
  if (p->s->nparameters == 0) return GH_OK;
  GH_TRY(gh_alloc(p->s->ctx, 2 * (size_t)p->points, sizeof *taken, &taken));
  for (int k = 0; k < p->s->nconfigs; k++) {
    if (!study_plot_drawn(p, k)) continue;
    double x = axis_share(p->x_axis, study_plot_x_of(p, k)), y = axis_share(p->y_axis, study_plot_y_of(p, k));
    taken[n++] = (box){{x - POINT, x + POINT}, {y - POINT, y + POINT}};
  }
  for (int first = 0, curve = 0; first < p->s->nconfigs; first++) {
    if (!study_plot_begins_curve(p, first)) continue;
    for (int k = first; k < p->s->nconfigs; k++) {
      char text[STUDY_NAME];
      if (!study_plot_drawn(p, k) || !study_alike(p->s, k, first, p->parameter)) continue;
      study_short_value(p->s, k, p->parameter, text, sizeof text);
      if (!place_label(p, k, (int)strlen(text), taken, n, &side, taken + n)) continue;
      n++;
      gh_text_print(t, "set label ");
      gh_picture_string(t, text);
      gh_text_print(t, " at %.17g,%.17g %s offset %s,%s font ',10' tc rgb '%s' noenhanced front\n",
                    study_plot_x_of(p, k), study_plot_y_of(p, k), side % 2 ? "right" : "left",
                    side % 2 ? "-0.8" : "0.8", side < 2 ? "0.6" : "-0.6", study_colour(curve));
    }
    curve++;
  }
  free(taken);
  return GH_OK;
}
