/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The columns that answers have, and what of them is compared as a whole. */
#include "study/parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool study_measures_force(const gh_scene *scene) {
  int set;
  return gh_scene_last_loading(scene, &set) == GH_LOADING_DISPLACEMENT;
}

static gh_status columns_name(gh_study *s, const char *const *names, int n) {
  GH_TRY(gh_alloc(s->ctx, (size_t)n, sizeof *s->column, &s->column));
  for (; s->ncolumns < n; s->ncolumns++)
    GH_TRY(gh_copy_text(s->ctx, names[s->ncolumns], &s->column[s->ncolumns]));
  return GH_OK;
}

static gh_status columns_group(gh_study *s, const study_quantity *list, int n) {
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
    GH_TRY(columns_name(s, of_path, 9));
    return columns_group(s, path, 2);
  }
  const bool force = study_measures_force(p->scene);
  const study_quantity body[] = {
      {"stress", 0, 4}, {force ? "force" : "displacement", 4, 2}, {"dilatancy", 6, 1}};
  GH_TRY(columns_name(s, force ? driven : loaded, 7));
  return columns_group(s, body, 3);
}
