/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Error over the parameter whose order of convergence is measured. */
#include "study/draw.h"

/* Dashed lines of order 1 and 2 below the coarsest point, each with its name where it leaves the picture. */
static void write_slopes(const study_plot *p, gh_text *t) {
  bool grows = p->s->verdict->grows;
  double x0 = grows ? INFINITY : 0, y0 = 0;
  for (int k = 0; k < p->s->nconfigs; k++) {
    if (!study_plot_drawn(p, k) || study_error_of(p->s, k) == 0) continue;
    double x = study_plot_x_of(p, k), y = study_plot_y_of(p, k);
    if (grows ? x < x0 : x > x0) x0 = x, y0 = y;
    else if (x == x0) y0 = fmin(y0, y);
  }
  if (!(y0 > 0)) return;
  y0 /= 2.5;
  for (int order = 1; order <= 2; order++) {
    /* to the fine end of the axis, or to the lower one */
    double far = grows ? p->x_axis[1] : p->x_axis[0], most = fabs(log(far / x0)),
           down = log(y0 / p->y_axis[0]);
    double length = fmin(most, down / order);
    if (!(length > 0)) continue;
    double x1 = x0 * exp(grows ? length : -length), y1 = y0 * exp(-order * length);
    gh_text_print(t, "set arrow from %.17g,%.17g to %.17g,%.17g nohead lc rgb '#a0a0a0' lw 0.8 dt 2 back\n",
                  x0, y0, x1, y1);
    gh_text_print(t, "set label 'order %d' at %.17g,%.17g %s offset %s,0.3 tc rgb '#808080' font ',11'\n",
                  order, x0 * exp((grows ? 0.85 : -0.85) * length), y0 * exp(-0.85 * order * length),
                  grows ? "left" : "right", grows ? "0.8" : "-0.8");
  }
}

/* The values themselves as marks where there are few. */
static void write_parameter_marks(const study_plot *p, gh_text *t) {
  const study_parameter *parameter = p->s->parameters + p->parameter;
  const char *comma = "";
  if (parameter->nvalues > 12) return;
  gh_text_print(t, "set xtics (");
  for (int v = 0; v < parameter->nvalues; v++) {
    if (!(parameter->number[v] > 0)) continue;
    gh_text_print(t, "%s", comma);
    gh_picture_string(t, parameter->value[v]);
    gh_text_print(t, " %.17g", parameter->number[v]);
    comma = ", ";
  }
  gh_text_print(t, ") noenhanced\n");
}

gh_status study_draw_order(const gh_study *s, const char *folder) {
  study_plot p = {.s = s, .over = OVER_PARAMETER, .parameter = s->order};
  gh_text *t;
  study_plot_measure(&p);
  if (p.points == 0) return GH_OK;
  GH_TRY(gh_text_create(s->ctx, &t));
  study_plot_axes(&p, s->parameters[s->order].name, t);
  write_parameter_marks(&p, t);
  write_slopes(&p, t);
  study_plot_data(&p, t);
  gh_text_print(t, "plot ");
  study_plot_curves(&p, t);
  gh_text_print(t, "\n");
  gh_status status = study_picture(s, folder, "order.png", STUDY_PLOT_WIDTH, STUDY_PLOT_HEIGHT, t);
  gh_text_destroy(&t);
  return status;
}
