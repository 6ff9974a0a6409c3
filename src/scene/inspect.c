/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Stress and stability of all integration points. */
#include "scene/output.h"

/* The last guard: what is not finite is no result, whatever has let it pass. */
static gh_status fields_check(const scene_output *o) {
  const size_t ndof = 2 * (size_t)o->scene->mesh->nnodes, points = (size_t)gh_farm_size(o->farm);
  const struct {
    const char *name;
    const double *value;
    size_t n;
  } all[] = {{"a displacement", gh_macro_u(o->macro), ndof},
             {"a reaction", gh_macro_reactions(o->macro), ndof},
             {"a stress", gh_macro_P(o->macro), 4 * points},
             {"a tangent", gh_macro_A(o->macro), 16 * points}};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    if (all[k].value && !gh_finite(all[k].value, all[k].n))
      return gh_fail(o->ctx, GH_DIVERGED, "%s is not finite: the increment is not written", all[k].name);
  return GH_OK;
}

gh_status scene_output_inspect(scene_output *o) {
  const double *A = gh_macro_A(o->macro), *F = gh_macro_F(o->macro), *P = gh_macro_P(o->macro);
  double most = -1;
  o->unjammed = 0;
  o->min_acoustic = A ? INFINITY : NAN;
  for (int p = 0; p < gh_farm_size(o->farm); p++) {
    const gh_rve_measures *m = gh_farm_measure(o->farm, p);
    double *cauchy = o->cauchy + 4 * p;
    o->acoustic[p] = o->angle[p] = NAN; /* without a tangent nothing is known of it */
    if (A) o->acoustic[p] = gh_acoustic(A + 16 * p, o->angle + p);
    gh_cauchy2(P + 4 * p, F + 4 * p, cauchy);
    if (m && m->unjammed) o->unjammed++;
    if (o->acoustic[p] < o->min_acoustic) o->min_acoustic = o->acoustic[p], o->least_stable = p;
    if (gh_mises2(cauchy) > most) most = gh_mises2(cauchy), o->most_loaded = p;
  }
  return fields_check(o);
}
