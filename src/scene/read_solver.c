/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Reads how the equilibrium of the finite element problem is found. */
#include "scene/read.h"

#include <string.h>

/* Frozen and elastic tangents converge linearly, in cheap iterations. */
enum {
  PATIENT_ITERATIONS = 200,
  STEPS = 2000,
  AT_ONCE = 16,
  MOST_AT_ONCE = 1 << 10,
  MEMORY_WITH_BRANCHES = 5
};
/* Over the tolerance of the packings: residuals of the body that this tolerance leaves. */
static const double NOISE = 10;
/* Relaxation: forces to a thousandth. */
static const double AT_REST = 1e-3;

static gh_status read_tangent(gh_scene *s, node solver) {
  node n = gh_yaml_get(solver, "tangent");
  const char *word;
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(gh_yaml_text(n, "tangent", &word));
  if (!gh_tangent_from_name(word, &s->solver.tangent))
    return gh_yaml_fail(n, "tangent '%s' is none of algorithmic, symmetrised, frozen, elastic", word);
  if (s->solver.tangent == GH_TANGENT_FROZEN || s->solver.tangent == GH_TANGENT_ELASTIC)
    s->solver.max_iterations = PATIENT_ITERATIONS;
  return GH_OK;
}

static gh_status read_increments(gh_scene *s, node solver) {
  int automatic;
  node n = gh_yaml_get(solver, "at_once");
  s->at_once = 1;
  GH_TRY(scene_optional_choice(solver, "increments", (const char *[]){"planned", "automatic"}, &automatic));
  if (!automatic && gh_yaml_has(n)) return gh_yaml_fail(n, "at_once needs `increments: automatic`");
  if (automatic) s->at_once = AT_ONCE;
  return scene_optional_integer(solver, "at_once", 1, MOST_AT_ONCE, &s->at_once);
}

/* Keys that belong to one method are refused with the other, which would not look at them. */
static gh_status refuse(node solver, const char *const keys[], const char *why) {
  for (; *keys; keys++) {
    node n = gh_yaml_get(solver, *keys);
    if (gh_yaml_has(n)) return gh_yaml_fail(n, "%s %s", *keys, why);
  }
  return GH_OK;
}

static gh_status read_method(gh_scene *s, node solver) {
  static const char *const explicit_keys[] = {"damping_ratio", "safety", NULL}, *const newton_keys[] = {
                                                                                    "line_search",
                                                                                    "search_memory",
                                                                                    "pass_jumps", "tangent",
                                                                                    NULL};
  node n = gh_yaml_get(solver, "method");
  const char *word = "newton";
  if (gh_yaml_has(n)) GH_TRY(gh_yaml_text(n, "method", &word));
  if (!gh_macro_method_from_name(word, &s->solver.method))
    return gh_yaml_fail(n, "method '%s' is none of newton, relaxation, automatic", word);
  if (s->solver.method == GH_METHOD_NEWTON)
    return refuse(solver, explicit_keys, "needs `method: relaxation` or `method: automatic`");
  if (gh_yaml_has(n = gh_yaml_get(solver, "damping_ratio")))
    GH_TRY(gh_yaml_positive(n, "damping_ratio", &s->solver.damping_ratio));
  GH_TRY(scene_fraction(solver, "safety", &s->solver.safety));
  if (s->solver.method != GH_METHOD_RELAXATION) return GH_OK;
  s->solver.tolerance = AT_REST;
  s->solver.max_iterations = STEPS;
  return refuse(solver, newton_keys, "belongs to Newton's iteration, and `method` is relaxation");
}

gh_status scene_read_solver(gh_scene *s, node root) {
  node solver = gh_yaml_get(root, "solver");
  s->at_once = 1;
  if (gh_rve_has_branches(&s->micro)) s->solver.memory = MEMORY_WITH_BRANCHES;
  s->solver.memory_above = NOISE * s->micro.tolerance;
  if (!gh_yaml_has(solver)) return GH_OK;
  GH_TRY(gh_yaml_map(solver, "solver", scene_solver_keys));
  GH_TRY(read_method(s, solver));
  GH_TRY(scene_fraction(solver, "tolerance", &s->solver.tolerance));
  GH_TRY(scene_optional_bool(solver, "line_search", &s->solver.line_search));
  GH_TRY(scene_optional_integer(solver, "search_memory", 1, GH_MACRO_MEMORY, &s->solver.memory));
  GH_TRY(scene_optional_bool(solver, "pass_jumps", &s->solver.pass_jumps));
  GH_TRY(read_tangent(s, solver));
  GH_TRY(read_increments(s, solver));
  GH_TRY(scene_optional_integer(solver, "max_iterations", 1, 10000, &s->solver.max_iterations));
  return scene_optional_integer(solver, "cut_steps", 0, 30, &s->solver.cut_steps);
}
