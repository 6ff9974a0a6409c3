/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Estimate of the error of the path by step doubling (docs/explanation/method.md, "Error estimates"). */
#include "scene/internal.h"

void gh_scene_set_estimate(gh_scene *s, bool estimate) {
  s->estimate = estimate;
}

double gh_estimated_error(const gh_run_estimate *e, int k) {
  return e->error[k] > 0 ? e->error[k] / e->scale[k] : 0;
}

double gh_estimated_now(const gh_run_estimate *e, int k) {
  return e->now[k] > 0 ? e->now[k] / e->scale[k] : 0;
}

bool scene_driven(const gh_scene *s, int *set, int *direction) {
  for (int k = s->nsteps - 1; k >= 0; k--) {
    if (s->steps[k].ndisplaces == 0) continue;
    const scene_displace *d = s->steps[k].displaces;
    *set = d->set;
    *direction = isnan(d->to[1]) ? 0 : 1;
    return true;
  }
  return false;
}

/* Force on the driven set now, and how much it is another one in whole increments; of all reactions, the
 * Euclidean norms. */
static void find_force(const gh_scene *s, const gh_macro *m, const gh_difference *d, double *now,
                       double *off) {
  const double *r = gh_macro_reactions(m);
  int set, direction;
  *now = *off = 0;
  if (scene_driven(s, &set, &direction)) {
    const gh_mesh_set *q = s->mesh->sets + set;
    for (int k = 0; k < q->nnodes; k++) {
      int dof = 2 * q->nodes[k] + direction;
      *now += r[dof];
      if (d->known) *off += r[dof] - d->reactions[dof];
    }
    *now = fabs(*now), *off = fabs(*off);
    return;
  }
  for (int k = 0; k < 2 * s->mesh->nnodes; k++) {
    *now += r[k] * r[k];
    if (d->known) *off += (r[k] - d->reactions[k]) * (r[k] - d->reactions[k]);
  }
  *now = sqrt(*now), *off = sqrt(*off);
}

static bool is_branched(const gh_scene *s, const gh_macro_report *halves, const gh_difference *d) {
  if (!d->known || halves->jumps > 0 || d->whole.jumps > 0) return true;
  return gh_is_branch(&s->micro.law, fmax(s->micro.tolerance, s->solver.tolerance), d->growth, d->change,
                      d->scale);
}

/* The error of halves of first order is what they differ by from the whole: (2 - 1)^-1 of it. Where the paths
 * branch, what they differed by before stays an error of what follows; without friction, nothing stays. */
static void count(const gh_scene *s, const double off[GH_ERRORS], const double scale[GH_ERRORS],
                  bool branched, gh_run_estimate *e) {
  for (int k = 0; k < GH_ERRORS; k++) {
    e->scale[k] = gh_max(e->scale[k], gh_max(scale[k], off[k]));
    if (branched && s->micro.law.friction) e->before[k] += e->off[k];
    e->off[k] = branched ? 0 : off[k];
    e->now[k] = e->before[k] + e->off[k];
    e->error[k] = gh_max(e->error[k], e->now[k]);
  }
  e->last_branched = branched;
  e->branched += branched;
  if (branched) e->branch = gh_max(e->branch, e->growth);
  e->increments++;
}

gh_status scene_solve_twice(const gh_scene *s, gh_macro *m, const gh_loads *loads, gh_macro_report *report,
                            gh_macro_report *whole, gh_run_estimate *e) {
  gh_difference d;
  double force, force_off;
  gh_status status = gh_macro_solve_twice(m, loads, report, &d);
  *whole = d.whole;
  e->seconds += d.seconds;
  GH_TRY(status);
  find_force(s, m, &d, &force, &force_off);
  const bool branched = is_branched(s, report, &d);
  const double off[GH_ERRORS] = {d.stress, d.most, d.displacement, force_off},
               scale[GH_ERRORS] = {d.scale, d.scale_most, d.scale_u, force};
  e->growth = d.growth > 0 ? d.growth / fmax(d.scale, e->scale[GH_ERROR_STRESS]) : 0;
  count(s, off, scale, branched, e);
  if (branched) gh_macro_join(m);
  if (!d.known)
    gh_log(s->ctx, GH_LEVEL_WARNING,
           "an equilibrium was found %s alone: the error of this increment is not known",
           d.halves ? "in halves" : "in the whole increment");
  return GH_OK;
}
