/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Values that the readers of a scene share. */
#include "scene/read.h"

gh_status scene_optional_bool(node map, const char *key, bool *value) {
  node n = gh_yaml_get(map, key);
  return gh_yaml_has(n) ? gh_yaml_bool(n, key, value) : GH_OK;
}

gh_status scene_pair(node n, const char *what, double value[2]) {
  GH_TRY(gh_yaml_numbers(n, what, 2, value));
  if (!gh_finite(value, 2)) return gh_yaml_fail(n, "%s is not finite", what);
  return GH_OK;
}

/* Number of entries of an optional list; fails when it is no list. */
gh_status scene_list_length(node list, const char *what, int *length) {
  *length = 0;
  if (!gh_yaml_has(list)) return GH_OK;
  if (!gh_yaml_is_list(list)) return gh_yaml_fail(list, "%s must be a list: [{edge: ...}, ...]", what);
  *length = gh_yaml_length(list);
  return GH_OK;
}
