/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The pictures of a study. */
#include "study/draw.h"

gh_status study_draw(const gh_study *s, const char *folder) {
  if (!s->verdict) return GH_OK;
  GH_TRY(study_draw_precision(s, folder));
  if (s->order >= 0) GH_TRY(study_draw_order(s, folder));
  return s->nplots > 0 ? study_draw_curves(s, folder) : GH_OK;
}
