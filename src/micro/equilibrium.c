/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Equilibrium of the free grains: dynamic relaxation, with a Newton finish or alone (method 3).
 *
 * Relaxation alone decides on which branch the packing ends. Newton takes over only where it cannot change
 * the branch: while the stiffness is positive definite (with friction, where it is not symmetric: regular)
 * and every full step at least halves the residual; else relaxation continues, to a tenth of the residual.
 * With friction relaxation may find none: then a ramp leads to F (ramp.c), or Newton out of a limit cycle. */
#include "micro/internal.h"

static bool relaxation_has_finish(const gh_rve *r) {
  return r->options.relaxation == GH_RELAX_POLISHED;
}

/* Newton may take over a limit cycle of the relaxation below this residual. */
static const double near = 1e-2;

/* Relaxation steps until grains are stopped and relaxation starts again; with friction a limit cycle is
 * suspected then. */
static long relaxation_portion(const gh_rve *r) {
  enum { WITHOUT_FRICTION = 50000, WITH_FRICTION = 5000 };
  return gh_rve_friction(r) ? WITH_FRICTION : WITHOUT_FRICTION;
}

/* In a limit cycle, or slow: slip of an increment depends on its end alone, so that a limit cycle gives back
 * what it has dissipated, which grains in motion do not. A ramp has none. */
static gh_status limit_cycle_end(gh_rve *r, double tolerance, long *left) {
  if (r->m.residual <= near && relaxation_has_finish(r)) GH_TRY(gh_rve_newton_regularised(r, tolerance));
  if (r->m.residual <= tolerance || gh_rve_patience(r) == 0 || *left <= 0) return GH_OK;
  return gh_rve_ramp_to_rest(r, left);
}

/* Relaxation by the engine until the residual as it is defined here is met: the engine sums in another order
 * and leaves a grain's contacts with its own images out of the mean, so that it may need a slightly
 * smaller tolerance. The engine knows nothing of round-off: packings that hardly touch are inspected in
 * between, whether round-off of the positions allows no less. */
static gh_status residual_relax(gh_rve *r, double tolerance, long *left) {
  double asked = tolerance, floor = r->floor, least = 0;
  for (;;) {
    const long most = relaxation_portion(r);
    double start = gh_seconds();
    gh_relax_options o = {.tolerance = asked,
                          .max_steps = *left < most ? *left : most,
                          .floor = floor,
                          .method = r->options.relaxation,
                          .least_damping = least,
                          .patience = gh_rve_patience(r)};
    gh_relax_result result;
    GH_TRY(gh_engine_relax(r->engine, &o, &result));
    *left -= result.steps;
    r->m.steps += result.steps;
    r->cost.steps += result.steps;
    r->cost.relax += gh_seconds() - start;
    GH_TRY(gh_rve_update_contacts(r));
    if (gh_rve_friction(r) && !result.converged)
      GH_TRY(limit_cycle_end(r, fmax(tolerance, gh_rve_target(r)), left));
    if (r->m.residual <= fmax(tolerance, gh_rve_target(r))) return GH_OK;
    r->m.accepted = *left <= 0 && (r->m.residual * r->m.mean_force <= r->options.accept ||
                                   r->m.residual <= r->accept_within * fmax(tolerance, gh_rve_target(r)));
    if (r->m.accepted) return GH_OK;
    if (*left <= 0 || result.steps < 1)
      return gh_fail(r->ctx, GH_DIVERGED,
                     "no equilibrium within %ld relaxation steps at F = [%.6g %.6g; %.6g %.6g]: the largest "
                     "force is %.3g of the mean contact force, required %.3g",
                     r->m.steps, r->F[0], r->F[1], r->F[2], r->F[3], r->m.residual, tolerance);
    least = result.converged ? 0 : result.least_damping;
    if (!result.converged) continue;
    asked *= 0.5 * fmin(1, tolerance / r->m.residual);
    floor *= 0.5;
  }
}

/* The residual by relaxation alone. */
static gh_status equilibrium_relax(gh_rve *r) {
  long left = r->options.max_steps;
  return residual_relax(r, r->options.tolerance, &left);
}

/* Where rotations alone are unknown, the branch cannot change: at a fixed Coulomb limit their incremental
 * potential is convex (positions fix the normal forces). Newton may start at once there. */
static gh_status equilibrium_solve(gh_rve *r) {
  long left = r->options.max_steps;
  double aim = fmax(gh_rve_first_relaxation, r->options.tolerance);
  bool done = false, again;
  if (!r->relaxes) {
    GH_TRY(gh_rve_update_contacts(r));
    if (r->m.unjammed || r->m.residual <= gh_rve_target(r)) return GH_OK;
    GH_TRY(gh_rve_newton_finish(r, &done, &again));
  }
  while (!done) {
    GH_TRY(residual_relax(r, aim, &left));
    if (r->m.unjammed || r->m.accepted || r->m.residual <= gh_rve_target(r)) break;
    GH_TRY(gh_rve_newton_finish(r, &done, &again));
    if (!done) aim = again ? fmax(fmin(r->m.residual, aim) / 10, gh_rve_target(r)) : gh_rve_target(r);
  }
  return GH_OK;
}

/* The affine guess keeps the fluctuations. Grains are assumed to rotate with the body: by the rotation of F since
 * the start. Where they slide, there are many equilibria, and a guess that lags behind would end in one that a
 * rigid rotation does not have. */
static void equilibrium_guess(gh_rve *r, const gh_start *b) {
  double f[4], inverse[4];
  for (int i = 0; i < r->n; i++) gh_apply2(r->F, &b->y[2 * i], &r->x[2 * i]);
  if (!r->theta) return;
  gh_inv2(b->F, inverse);
  gh_mul2(r->F, inverse, f);
  const double turn = r->turns ? gh_turn2(f) : 0;
  for (int i = 0; i < r->n; i++) r->theta[i] = b->theta[i] + turn;
  for (int i = 0; i < r->n && r->turns && r->frame; i++)
    if (gh_frame_turns_with_F(r->frame, i)) r->theta[i] = b->theta[i] + gh_rotation_between(b->F, r->F);
}

static gh_status equilibrium_set(gh_rve *r, const double cell[4]) {
  const double start = gh_seconds();
  GH_TRY(gh_engine_set(r->engine, cell, r->x, r->theta));
  r->cost.set += gh_seconds() - start;
  return GH_OK;
}

gh_status gh_rve_equilibrate(gh_rve *r, const gh_start *b) {
  double cell[4];
  bool reached;
  gh_mul2(r->F, r->lattice, cell);
  if (b) equilibrium_guess(r, b);
  gh_rve_find_round_off(r, cell);
  r->shift = 0;
  if (!gh_rve_solves(r)) {
    GH_TRY(equilibrium_set(r, cell));
    GH_TRY(gh_rve_update_contacts(r));
    r->m.stress_free = r->m.unjammed;
    return GH_OK;
  }
  GH_TRY(gh_rve_follow(r, b, &reached));
  if (!reached) {
    if (b) equilibrium_guess(r, b);
    GH_TRY(equilibrium_set(r, cell));
    GH_TRY(relaxation_has_finish(r) ? equilibrium_solve(r) : equilibrium_relax(r));
  }
  gh_rve_find_stress_free(r);
  return gh_engine_get(r->engine, r->x, r->theta);
}
