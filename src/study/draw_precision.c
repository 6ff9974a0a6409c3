/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Error over what it costs. */
#include "study/draw.h"

static gh_status draw_over(const gh_study *s, const char *folder, study_over over, const char *x_label,
                           const char *file) {
  study_plot p = {.s = s, .over = over, .parameter = s->series};
  gh_text *t;
  study_plot_measure(&p);
  if (p.points == 0) return GH_OK;
  GH_TRY(gh_text_create(s->ctx, &t));
  study_plot_axes(&p, x_label, t);
  study_plot_data(&p, t);
  gh_status status = study_plot_labels(&p, t);
  gh_text_print(t, "plot ");
  study_plot_curves(&p, t);
  if (p.front)
    gh_text_print(
        t, ", $front using 1:2 with steps lc rgb '#555555' lw 0.7 notitle, $front using 1:2 with points "
           "lc rgb '#222222' lw 0.8 pt 6 ps 2.2 title 'Pareto front'");
  if (s->nparameters > 0) {
    gh_text_print(t, ", NaN with points lc rgb '#ffffff' pt 0 title ");
    char text[STUDY_NAME];
    snprintf(text, sizeof text, "labels: %s", s->parameters[s->series].name);
    gh_picture_string(t, text);
  }
  gh_text_print(t, "\n");
  if (status == GH_OK) status = study_picture(s, folder, file, STUDY_PLOT_WIDTH, STUDY_PLOT_HEIGHT, t);
  gh_text_destroy(&t);
  return status;
}

gh_status study_draw_precision(const gh_study *s, const char *folder) {
  char label[STUDY_NAME];
  const char *each = study_has_ensembles(s) ? ", mean of the packings" : "";
  snprintf(label, sizeof label, "seconds of one core%s", each);
  GH_TRY(draw_over(s, folder, OVER_CORE, label, "work-precision.png"));
  if (study_counts(s) == STUDY_NOTHING) return GH_OK;
  bool none = false; /* zero has no place on the axis */
  for (int k = 0; k < s->nconfigs; k++) none = none || (study_is_rated(s, k) && study_count_of(s, k) == 0);
  snprintf(label, sizeof label, "%s%s%s", study_count_name(study_counts(s)), each,
           none ? " (configurations without any are not shown)" : "");
  return draw_over(s, folder, OVER_COUNT, label, "work-precision-count.png");
}
