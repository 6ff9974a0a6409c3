/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The packings of a scene, and which of them is at which integration point. */
#include "granhom/limits.h"
#include "packing/random.h"
#include "scene/read.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_PACKINGS = 100000 };

/* The number of the packing in this file, which is read where it is new. *warned: of gaps between grains. */
static gh_status need_packing(gh_scene *s, node n, const char *folder, bool *warned, int *number) {
  const char *name;
  GH_TRY(gh_yaml_text(n, "packing", &name));
  char *path = gh_path_join(folder, name);
  if (!path) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
  for (int k = 0; k < s->npackings; k++)
    if (strcmp(path, s->packing_paths[k]) == 0) {
      free(path);
      return *number = k, GH_OK;
    }
  *number = s->npackings;
  s->packing_paths[s->npackings] = path;
  gh_status status = gh_packing_read(s->ctx, path, &s->packings[s->npackings]);
  if (status == GH_OK)
    status = gh_limits_check_packing(s->ctx, &s->micro, path, s->packings[s->npackings], 1, 1, warned);
  s->npackings++;
  if (status != GH_OK) gh_prefix(s->ctx, status, "%s:%d: packing: ", gh_yaml_path(n), gh_yaml_line(n));
  return status;
}

/* The files of a list: *numbers of their packings. */
static gh_status read_files(gh_scene *s, node list, const char *folder, int **numbers, int *count) {
  bool single = gh_yaml_is_scalar(list), warned = false;
  *count = single ? 1 : gh_yaml_length(list);
  if (*count < 1) return gh_yaml_fail(list, "packing is an empty list");
  if (*count > MOST_PACKINGS)
    return gh_yaml_fail(list, "%d packings are more than %d", *count, MOST_PACKINGS);
  GH_TRY(gh_alloc(s->ctx, (size_t)*count, sizeof **numbers, numbers));
  GH_TRY(gh_alloc(s->ctx, (size_t)*count, sizeof *s->packings, &s->packings));
  GH_TRY(gh_alloc(s->ctx, (size_t)*count, sizeof *s->packing_paths, &s->packing_paths));
  for (int k = 0; k < *count; k++)
    GH_TRY(need_packing(s, single ? list : gh_yaml_item(list, k), folder, &warned, *numbers + k));
  return GH_OK;
}

static gh_status read_ensemble(gh_scene *s, node map, node *list) {
  node n;
  long seed;
  GH_TRY(gh_yaml_map(map, "packing", scene_ensemble_keys));
  GH_TRY(gh_yaml_need(map, "packing", "ensemble", list));
  GH_TRY(gh_yaml_need(map, "packing", "seed", &n));
  GH_TRY(gh_yaml_integer(n, "seed", 0, 2147483647, &seed));
  if (!gh_yaml_is_list(*list)) return gh_yaml_fail(*list, "ensemble must be a list of files");
  s->packing_drawn = true;
  s->packing_seed = seed;
  return GH_OK;
}

/* Which of `count` files point after point gets: in turn, or drawn. */
static gh_status place_packings(gh_scene *s, const int *numbers, int count) {
  int points = 4 * s->mesh->nelements;
  unsigned long long state = (unsigned long long)s->packing_seed;
  GH_TRY(gh_alloc(s->ctx, (size_t)points, sizeof *s->packing_of, &s->packing_of));
  for (int k = 0; k < points; k++)
    s->packing_of[k] = numbers[s->packing_drawn ? (int)(random_uniform(&state) * count) : k % count];
  return GH_OK;
}

gh_status scene_read_packings(gh_scene *s, node root, const char *folder) {
  node n, list;
  int *numbers = NULL, count;
  GH_TRY(gh_yaml_need(root, "a scene", "packing", &n));
  list = n;
  if (gh_yaml_is_map(n)) GH_TRY(read_ensemble(s, n, &list));
  gh_status status = read_files(s, list, folder, &numbers, &count);
  if (status == GH_OK && numbers) status = place_packings(s, numbers, count);
  free(numbers);
  return status;
}

int scene_packing_points(const gh_scene *s, int packing) {
  int count = 0;
  for (int k = 0; k < 4 * s->mesh->nelements; k++) count += s->packing_of[k] == packing;
  return count;
}

void scene_packings_destroy(gh_scene *s) {
  for (int k = 0; k < s->npackings; k++) {
    gh_packing_destroy(&s->packings[k]);
    free(s->packing_paths[k]);
  }
  free(s->packings);
  free(s->packing_paths);
  free(s->packing_of);
}
