/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Maps and numbers as the readers of scenes and studies need them. */
#include "granhom/io.h"

static const double LARGE = 1e300;

gh_status gh_yaml_need(gh_yaml_node map, const char *what, const char *key, gh_yaml_node *value) {
  *value = gh_yaml_get(map, key);
  if (gh_yaml_has(*value)) return GH_OK;
  return gh_yaml_fail(map, "%s needs the key '%s'", what, key);
}

gh_status gh_yaml_map(gh_yaml_node node, const char *what, const gh_term *keys) {
  if (!gh_yaml_is_map(node)) return gh_yaml_fail(node, "%s must be a map of keys and values", what);
  return gh_yaml_terms(node, keys);
}

gh_status gh_yaml_finite(gh_yaml_node node, const char *what, double *value) {
  return gh_yaml_number(node, what, -LARGE, LARGE, value);
}

gh_status gh_yaml_positive(gh_yaml_node node, const char *what, double *value) {
  double x;
  GH_TRY(gh_yaml_finite(node, what, &x));
  if (!(x > 0)) return gh_yaml_fail(node, "%s is %g, it must be above 0", what, x);
  *value = x;
  return GH_OK;
}
