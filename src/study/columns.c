/* The columns that answers have, and what of them is compared as a whole. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "study/parts.h"

#include "scene/internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The last thing that is driven, else the last footing, pressure or force, else the whole body. */
study_watched study_watch(const gh_scene *s) {
  for (int k = s->nsteps - 1; k >= 0; k--)
    if (s->steps[k].ndisplaces > 0)
      return (study_watched){.set = s->steps[k].displaces[0].set, .driven = true};
  for (int k = s->nsteps - 1; k >= 0; k--) {
    const scene_step *step = s->steps + k;
    if (step->nfootings > 0) return (study_watched){.set = step->footings[0].set, .footing = true};
    if (step->npressures > 0) return (study_watched){.set = step->pressures[0].set};
    if (step->nforces > 0) return (study_watched){.set = step->forces[0].set};
  }
  return (study_watched){.set = -1};
}

static gh_status take(gh_study *s, const char *const *names, int n) {
  GH_TRY(gh_alloc(s->ctx, (size_t)n, sizeof *s->column, &s->column));
  for (; s->ncolumns < n; s->ncolumns++)
    GH_TRY(study_copy(s->ctx, names[s->ncolumns], &s->column[s->ncolumns]));
  return GH_OK;
}

static gh_status compare(gh_study *s, const study_quantity *list, int n) {
  GH_TRY(gh_alloc(s->ctx, (size_t)n, sizeof *s->quantities, &s->quantities));
  memcpy(s->quantities, list, (size_t)n * sizeof *list);
  s->nquantities = n;
  return GH_OK;
}

gh_status study_columns(gh_study *s, const study_problem *p) {
  static const char *const of_path[] = {"P11", "P12", "P21", "P22", "s11", "s12", "s21", "s22", "energy"},
                           *const driven[] = {"P11", "P12", "P21", "P22", "force_x", "force_y", "dilatancy"},
                           *const loaded[] = {
                               "P11", "P12", "P21", "P22", "displacement_x", "displacement_y", "dilatancy"};
  static const study_quantity path[] = {{"stress", 0, 4}, {"energy", 8, 1}};
  if (!p->scene) {
    GH_TRY(take(s, of_path, 9));
    return compare(s, path, 2);
  }
  bool force = study_watch(p->scene).driven;
  const study_quantity body[] = {
      {"stress", 0, 4}, {force ? "force" : "displacement", 4, 2}, {"dilatancy", 6, 1}};
  GH_TRY(take(s, force ? driven : loaded, 7));
  return compare(s, body, 3);
}
