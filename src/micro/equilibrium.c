/* Equilibrium of the free grains: dynamic relaxation, polished by Newton (method 3). SPDX-License-Identifier:
 * GPL-2.0-or-later
 *
 * Relaxation alone decides on which branch the packing ends. Newton takes over only where it cannot change
 * the branch: while the stiffness is positive definite and every full step at least halves the residual; else
 * relaxation goes on ten times further. */
#include "micro/internal.h"

#include <float.h>
#include <string.h>

static const double first_relaxation = 1e-5;

gh_status gh_rve_look_at_contacts(gh_rve *r) {
  double start = gh_seconds();
  gh_contact_list list;
  GH_TRY(gh_engine_contacts(r->engine, &list));
  r->contacts = list.contacts;
  r->ncontacts = list.count;
  r->force = list.force;
  double sum = 0, largest = 0;
  for (int c = 0; c < r->ncontacts; c++) sum += hypot(r->contacts[c].f[0], r->contacts[c].f[1]);
  if (r->relaxes)
    for (int i = 0; i < r->n; i++)
      if (!(r->held && r->held[i])) largest = fmax(largest, hypot(r->force[2 * i], r->force[2 * i + 1]));
  if (!isfinite(sum) || !isfinite(largest))
    return gh_fail(r->ctx, GH_DIVERGED, "a contact force is not finite");
  r->m.mean_force = r->ncontacts ? sum / r->ncontacts : 0;
  /* Grains that follow F and just touch carry nothing yet, but they are stiff (6.10); free ones are loose. */
  r->m.unjammed = r->relaxes ? r->m.mean_force <= r->floor : r->ncontacts == 0;
  r->m.residual = r->m.mean_force > 0 && !r->m.unjammed ? largest / r->m.mean_force : 0;
  r->m.contacts = r->ncontacts;
  r->cost.evaluations++;
  r->cost.contacts += gh_seconds() - start;
  return GH_OK;
}

/* The residual that is good enough: the wanted one, or what round-off of the positions leaves. */
static double target(const gh_rve *r) {
  double roundoff = 16 * DBL_EPSILON * r->options.law.normal_stiffness * r->extent;
  return r->m.mean_force > 0 ? fmax(r->options.tolerance, roundoff / r->m.mean_force) : r->options.tolerance;
}

/* Relaxation by the engine until the residual as it is defined here is met: the engine sums in another order
 * and leaves a grain's contacts with its own images out of the mean, so that it may have to be asked for a
 * little more. */
static gh_status relax(gh_rve *r, double tolerance, long *left) {
  double asked = tolerance, floor = r->floor;
  for (bool met = false; !met;) {
    double start = gh_seconds();
    gh_relax_options o = {.tolerance = asked, .max_steps = *left, .floor = floor};
    gh_relax_result result;
    GH_TRY(gh_engine_relax(r->engine, &o, &result));
    *left -= result.steps;
    r->m.steps += result.steps;
    r->cost.steps += result.steps;
    r->cost.relax += gh_seconds() - start;
    GH_TRY(gh_rve_look_at_contacts(r));
    met = r->m.residual <= tolerance;
    if (!met && (!result.converged || *left <= 0))
      return gh_fail(r->ctx, GH_DIVERGED,
                     "no equilibrium within %ld relaxation steps at F = [%.6g %.6g; %.6g %.6g]: the largest "
                     "force is %.3g of the mean contact force, wanted %.3g",
                     r->m.steps, r->F[0], r->F[1], r->F[2], r->F[3], r->m.residual, tolerance);
    asked *= 0.5 * fmin(1, tolerance / r->m.residual);
    floor *= 0.5;
  }
  return GH_OK;
}

static gh_status factorise(gh_rve *r, bool *definite) {
  double start = gh_seconds();
  GH_TRY(gh_rattlers_find(r->ctx, r->rattlers, r->n, r->held, r->contacts, r->ncontacts, r->m.mean_force,
                          &r->m.rattlers));
  GH_TRY(gh_stiffness_number(r->ctx, r->stiffness, r->n, r->held, r->rattlers->flag, r->contacts,
                             r->ncontacts, r->periodic));
  GH_TRY(gh_stiffness_factorise(r->ctx, r->stiffness, r->rattlers->flag, r->contacts, r->ncontacts, 0,
                                definite));
  r->m.factorisations++;
  r->cost.factorise += gh_seconds() - start;
  return GH_OK;
}

/* One full Newton step from x to r->step; the engine is left there. */
static gh_status newton_step(gh_rve *r) {
  double start = gh_seconds();
  const gh_stiffness *s = r->stiffness;
  const double *dx;
  for (int i = 0; i < r->n; i++)
    if (s->active[i] >= 0) memcpy(&s->rhs[2 * s->active[i]], &r->force[2 * i], 2 * sizeof(double));
  GH_TRY(gh_stiffness_solve(r->ctx, r->stiffness, 1, &dx));
  for (int i = 0; i < r->n; i++)
    for (int k = 0; k < 2; k++)
      r->step[2 * i + k] = r->x[2 * i + k] + (s->active[i] >= 0 ? dx[2 * s->active[i] + k] : 0);
  r->cost.factorise += gh_seconds() - start;
  return gh_engine_move(r->engine, r->step, NULL);
}

/* Newton from the engine's positions as long as it is safe. *done: the residual is reached. Else the engine
 * is at the last safe positions. */
static gh_status polish(gh_rve *r, bool *done) {
  *done = false;
  GH_TRY(gh_engine_get(r->engine, r->x, NULL));
  for (;;) {
    bool definite;
    double before = r->m.residual;
    GH_TRY(factorise(r, &definite));
    if (!definite) return GH_OK;
    GH_TRY(newton_step(r));
    GH_TRY(gh_rve_look_at_contacts(r));
    if (!(r->m.residual <= before / 2) || r->m.unjammed) { /* back to where it was */
      GH_TRY(gh_engine_move(r->engine, r->x, NULL));
      return gh_rve_look_at_contacts(r);
    }
    memcpy(r->x, r->step, 2 * (size_t)r->n * sizeof(double));
    *done = r->m.residual <= target(r);
    r->m.polished = *done;
    if (*done) return GH_OK;
  }
}

/* What round-off of the positions hides: long cells and packings far from the origin have coarse positions.
 */
static void find_limits(gh_rve *r, const double cell[4]) {
  r->extent = hypot(cell[0], cell[2]) + hypot(cell[1], cell[3]);
  for (int k = 0; k < 2 * r->n; k++) r->extent = fmax(r->extent, fabs(r->x[k]));
  double E = r->options.law.normal_stiffness;
  r->floor = fmax(1e-13 * E * gh_packing_mean_radius(r->packing), 4 * DBL_EPSILON * E * r->extent);
}

gh_status gh_rve_equilibrate(gh_rve *r) {
  double cell[4];
  double start = gh_seconds();
  gh_mul2(r->F, r->packing->cell, cell);
  find_limits(r, cell);
  GH_TRY(gh_engine_set(r->engine, cell, r->x, NULL));
  r->cost.set += gh_seconds() - start;
  if (!r->relaxes) return gh_rve_look_at_contacts(r);
  long left = r->options.max_steps;
  double aim = fmax(first_relaxation, r->options.tolerance);
  for (;;) {
    GH_TRY(relax(r, aim, &left));
    if (r->m.unjammed || r->m.residual <= target(r)) break;
    bool done;
    GH_TRY(polish(r, &done));
    if (done) break;
    aim = fmax(fmin(r->m.residual, aim) / 10, target(r));
  }
  return gh_engine_get(r->engine, r->x, NULL);
}
