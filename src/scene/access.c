/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What others read of a scene. */
#include "scene/internal.h"

const char *gh_scene_length_unit(const gh_scene *s) {
  return s->length_unit;
}

const char *gh_scene_force_unit(const gh_scene *s) {
  return s->force_unit;
}

char *const *gh_scene_packing_files(const gh_scene *s, int *n) {
  *n = s->npackings;
  return s->packing_paths;
}

gh_status gh_scene_files(const gh_scene *s, const char ***file, int *n) {
  const char **list;
  *file = NULL, *n = 0;
  GH_TRY(gh_alloc(s->ctx, (size_t)s->npackings + 2, sizeof *list, &list));
  list[(*n)++] = s->path;
  if (s->mesh_path) list[(*n)++] = s->mesh_path;
  for (int k = 0; k < s->npackings; k++) list[(*n)++] = s->packing_paths[k];
  *file = list;
  return GH_OK;
}

/* A displacement of any step goes before the loads of the last one. */
gh_scene_loading gh_scene_last_loading(const gh_scene *s, int *set) {
  for (int k = s->nsteps - 1; k >= 0; k--) {
    if (s->steps[k].ndisplaces == 0) continue;
    *set = s->steps[k].displaces[0].set;
    return GH_LOADING_DISPLACEMENT;
  }
  for (int k = s->nsteps - 1; k >= 0; k--) {
    const scene_step *step = s->steps + k;
    if (step->nfootings > 0) {
      *set = step->footings[0].set;
      return GH_LOADING_FOOTING;
    }
    if (step->npressures == 0 && step->nforces == 0) continue;
    *set = step->npressures > 0 ? step->pressures[0].set : step->forces[0].set;
    return GH_LOADING_FORCE;
  }
  *set = -1;
  return GH_LOADING_NONE;
}
