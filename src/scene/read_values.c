/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Values that the readers of a scene share. */
#include "scene/read.h"

#include <string.h>

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

gh_status scene_fraction(node map, const char *key, double *value) {
  node n = gh_yaml_get(map, key);
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(gh_yaml_positive(n, key, value));
  if (!(*value < 1)) return gh_yaml_fail(n, "%s is %g, it must be below 1", key, *value);
  return GH_OK;
}

gh_status scene_optional_integer(node map, const char *key, long low, long high, int *value) {
  node n = gh_yaml_get(map, key);
  if (!gh_yaml_has(n)) return GH_OK;
  long x;
  GH_TRY(gh_yaml_integer(n, key, low, high, &x));
  *value = (int)x;
  return GH_OK;
}

gh_status scene_optional_choice(node map, const char *key, const char *const words[2], int *value) {
  node n = gh_yaml_get(map, key);
  const char *word;
  *value = 0;
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(gh_yaml_text(n, key, &word));
  *value = strcmp(word, words[1]) == 0;
  if (*value || strcmp(word, words[0]) == 0) return GH_OK;
  return gh_yaml_fail(n, "%s '%s' is none of %s, %s", key, word, words[0], words[1]);
}
