/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The key `results` of a scene: which packings are written. */
#include "scene/read.h"

#include <string.h>

static gh_status read_list(gh_scene *s, node list, int **points, int *count) {
  int n = gh_yaml_length(list), most = 4 * s->mesh->nelements - 1;
  GH_TRY(gh_alloc(s->ctx, (size_t)n, sizeof **points, points));
  for (int k = 0; k < n; k++) {
    long point;
    GH_TRY(gh_yaml_integer(gh_yaml_item(list, k), "integration point", 0, most, &point));
    (*points)[k] = (int)point;
    for (int j = 0; j < k; j++)
      if ((*points)[j] == (*points)[k])
        return gh_yaml_fail(gh_yaml_item(list, k), "integration point %ld is given twice", point);
  }
  *count = n;
  return GH_OK;
}

/* all, none, or a list of integration points. */
static gh_status read_points(gh_scene *s, node n, const char *key, int **points, int *count) {
  if (gh_yaml_is_list(n)) return read_list(s, n, points, count);
  const char *word;
  GH_TRY(gh_yaml_text(n, key, &word));
  if (strcmp(word, "all") == 0) *count = GH_ALL_POINTS;
  else if (strcmp(word, "none") == 0) *count = 0;
  else return gh_yaml_fail(n, "%s is '%s', it must be all, none or a list of integration points", key, word);
  return GH_OK;
}

gh_status scene_read_results(gh_scene *s, node root) {
  node results = gh_yaml_get(root, "results"), old = gh_yaml_get(root, "output"), n;
  s->nrves = GH_FEW_POINTS;
  s->dump_every = 1;
  if (gh_yaml_has(results) && gh_yaml_has(old))
    return gh_yaml_fail(old, "'output' is an older name of 'results', and the scene has both");
  if (gh_yaml_has(old)) results = old;
  if (!gh_yaml_has(results)) return GH_OK;
  GH_TRY(gh_yaml_map(results, "results", scene_results_keys));
  if (gh_yaml_has(n = gh_yaml_get(results, "rves"))) GH_TRY(read_points(s, n, "rves", &s->rves, &s->nrves));
  if (gh_yaml_has(n = gh_yaml_get(results, "dump"))) GH_TRY(read_points(s, n, "dump", &s->dumps, &s->ndumps));
  if (gh_yaml_has(n = gh_yaml_get(results, "dump_every"))) {
    long every;
    GH_TRY(gh_yaml_integer(n, "dump_every", 1, 1000000000, &every));
    if (s->ndumps == 0) return gh_yaml_fail(n, "dump_every belongs to a dump, and there is none");
    s->dump_every = (int)every;
  }
  return GH_OK;
}
