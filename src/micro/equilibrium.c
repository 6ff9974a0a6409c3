/* Equilibrium of the free grains: dynamic relaxation, polished by Newton or alone (method 3).
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * Relaxation alone decides on which branch the packing ends. Newton takes over only where it cannot change
 * the branch: while the stiffness is positive definite (with friction, where it is not symmetric: regular)
 * and every full step at least halves the residual; else relaxation goes on ten times further. */
#include "micro/internal.h"

#include <float.h>
#include <string.h>

static const double first_relaxation = 1e-5;
/* Share of round-off in the contact forces above which a packing counts as stress-free. */
static const double stress_free = 1e-3;

/* Largest force on a free member, and largest moment over the radius where members turn. */
static double largest_unbalance(const gh_rve *r) {
  double largest = 0;
  if (r->relaxes)
    for (int i = 0; i < r->n; i++)
      if (!(r->held && r->held[i]))
        largest = gh_max(largest, hypot(r->list.force[2 * i], r->list.force[2 * i + 1]));
  if (r->turns)
    for (int i = 0; i < r->n; i++) largest = gh_max(largest, fabs(r->list.moment[i]) / r->radius[i]);
  return largest;
}

gh_status gh_rve_look_at_contacts(gh_rve *r) {
  double start = gh_seconds();
  GH_TRY(gh_engine_contacts(r->engine, &r->list));
  double sum = 0, all = 0, largest = largest_unbalance(r);
  const gh_contact *q = r->list.contacts;
  double E = r->options.law.normal_stiffness;
  for (int c = 0; c < r->list.count; c++) {
    all += hypot(q[c].f[0], q[c].f[1]);
    sum += E * q[c].overlap;
  }
  if (!gh_rve_friction(r)) sum = all; /* the same but for round-off */
  if (!isfinite(all) || !isfinite(sum) || !isfinite(largest))
    return gh_fail(r->ctx, GH_DIVERGED, "a contact force is not finite");
  r->m.mean_force = r->list.count ? sum / r->list.count : 0;
  /* Grains that follow F and just touch carry nothing yet, but they are stiff (6.10); free ones are loose. */
  r->m.unjammed = r->relaxes ? r->m.mean_force <= r->floor : r->list.count == 0;
  r->m.residual = r->m.mean_force > 0 && !r->m.unjammed ? largest / r->m.mean_force : 0;
  r->m.contacts = r->list.count;
  r->cost.evaluations++;
  r->cost.contacts += gh_seconds() - start;
  return GH_OK;
}

/* What round-off of the positions leaves of a residual. */
static double round_off(const gh_rve *r) {
  const gh_contact_law *law = &r->options.law;
  double stiffest =
      gh_rve_friction(r) ? fmax(law->normal_stiffness, law->tangential_stiffness) : law->normal_stiffness;
  return r->m.mean_force > 0 ? 16 * DBL_EPSILON * stiffest * r->extent / r->m.mean_force : 0;
}

/* The residual that is good enough: the wanted one, or what round-off of the positions leaves. */
static double target(const gh_rve *r) {
  return fmax(r->options.tolerance, round_off(r));
}

/* Forces that are mostly round-off are no stress: nobody can tell whether they balance. */
static void find_stress_free(gh_rve *r) {
  r->m.stress_free = r->m.unjammed || round_off(r) > stress_free;
  if (r->m.stress_free) r->m.residual = 0;
}

/* Numbers the unknowns at the contacts and rattlers at hand. */
static gh_status number_coupled(gh_rve *r) {
  return gh_coupled_number(r->ctx, r->coupled, r->held, r->rattlers->flag, r->turns, &r->list, r->periodic);
}

/* As they are numbered, with r->shift. */
static gh_status factorise_shifted(gh_rve *r, bool *regular) {
  r->m.factorisations++;
  return gh_coupled_factorise(r->ctx, r->coupled, r->radius, &r->list, r->shift, regular);
}

/* Friction leaves modes without stiffness: grains that roll on each other like gears where no odd cycle of
 * contacts blocks them, grains that one contact holds, grains whose contacts all slide. A little stiffness of
 * position and rotation decides them in the tangent. */
gh_status gh_rve_factorise_coupled(gh_rve *r, bool help, bool *regular) {
  double most = 1e-6 * r->options.law.normal_stiffness;
  r->shift = 0;
  GH_TRY(number_coupled(r));
  for (;;) {
    GH_TRY(factorise_shifted(r, regular));
    if (*regular || !help || r->shift >= most) return GH_OK;
    r->shift = r->shift > 0 ? 10 * r->shift : 1e-3 * most;
  }
}

/* Rolling changes no contact force, so that any amount of it is the same equilibrium. Grains whose contacts
 * slide without hardening can come to rest in many places, and relaxation alone says in which. */
static bool only_rolls(const gh_rve *r) {
  if (r->options.law.hardening > 0) return true;
  for (int c = 0; c < r->list.count; c++)
    if (r->list.friction[c].slides) return false;
  return true;
}

static gh_status factorise(gh_rve *r, bool *good) {
  double start = gh_seconds();
  GH_TRY(gh_rve_find_rattlers(r));
  if (r->coupled) {
    GH_TRY(gh_rve_factorise_coupled(r, only_rolls(r), good));
  } else {
    GH_TRY(gh_stiffness_number(r->ctx, r->stiffness, r->n, r->held, r->rattlers->flag, r->list.contacts,
                               r->list.count, r->periodic));
    GH_TRY(gh_stiffness_factorise(r->ctx, r->stiffness, r->rattlers->flag, r->list.contacts, r->list.count, 0,
                                  good));
    r->m.factorisations++;
  }
  r->cost.factorise += gh_seconds() - start;
  return GH_OK;
}

/* Out of balance, of the contacts between grains that are no rattlers: the others end with the step. */
static void balance_of_backbone(const gh_rve *r) {
  const gh_stiffness *s = r->stiffness;
  for (int i = 0; i < r->n; i++)
    if (s->active[i] >= 0) memcpy(&s->rhs[2 * s->active[i]], &r->list.force[2 * i], 2 * sizeof(double));
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = r->list.contacts + c;
    const int end[2] = {q->i, q->j};
    for (int e = 0; e < 2; e++) {
      int a = s->active[end[e]];
      if (a < 0 || !r->rattlers->flag[end[1 - e]]) continue;
      for (int k = 0; k < 2; k++) s->rhs[2 * a + k] -= e ? -q->f[k] : q->f[k];
    }
  }
}

/* Pushes one or both ends of a contact with a rattler apart, if they overlap where the step leads. */
static bool push_apart(gh_rve *r, const gh_contact *q, double gap) {
  const bool loose[2] = {r->rattlers->flag[q->i], r->rattlers->flag[q->j]};
  double l[2], *x[2] = {r->step + 2 * q->i, r->step + 2 * q->j};
  for (int k = 0; k < 2; k++)
    l[k] = q->l[k] + (x[1][k] - r->x[2 * q->j + k]) - (x[0][k] - r->x[2 * q->i + k]);
  double d = hypot(l[0], l[1]), overlap = q->overlap + hypot(q->l[0], q->l[1]) - d;
  if (!(overlap > 0 && d > 0) || !(loose[0] || loose[1]) || q->i == q->j) return false;
  double share = (overlap + gap) / d / (loose[0] + loose[1]);
  for (int k = 0; k < 2; k++) {
    x[0][k] -= loose[0] ? share * l[k] : 0;
    x[1][k] += loose[1] ? share * l[k] : 0;
  }
  return true;
}

/* Rattlers carry nothing, but lean on others, and relaxation never parts them quite. A step of the others by
 * more than that overlap would press them: they are pushed out of its way. Those that it meets anew show in
 * the residual. */
static void clear_rattlers(gh_rve *r) {
  enum { SWEEPS = 20 };
  const double gap = 1e-9 * gh_packing_mean_radius(r->packing);
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    bool moved = false;
    for (int c = 0; c < r->list.count; c++) moved = push_apart(r, r->list.contacts + c, gap) || moved;
    if (!moved) return;
  }
}

static gh_status solve_forces(gh_rve *r) {
  const gh_stiffness *s = r->stiffness;
  const double *dx;
  balance_of_backbone(r);
  GH_TRY(gh_stiffness_solve(r->ctx, r->stiffness, 1, &dx));
  for (int i = 0; i < r->n; i++)
    for (int k = 0; k < 2; k++)
      r->step[2 * i + k] = r->x[2 * i + k] + (s->active[i] >= 0 ? dx[2 * s->active[i] + k] : 0);
  clear_rattlers(r);
  return GH_OK;
}

static gh_status solve_forces_and_moments(gh_rve *r) {
  const gh_coupled *s = r->coupled;
  const double *dx;
  for (int i = 0; i < r->n; i++) {
    const double out[3] = {r->list.force[2 * i], r->list.force[2 * i + 1], r->list.moment[i]};
    for (int k = 0; k < 3; k++)
      if (s->unknown[3 * i + k] >= 0) s->rhs[s->unknown[3 * i + k]] = out[k];
  }
  GH_TRY(gh_coupled_solve(r->ctx, r->coupled, 1, &dx));
  for (int i = 0; i < r->n; i++) {
    const int *u = &s->unknown[3 * i];
    for (int k = 0; k < 2; k++) r->step[2 * i + k] = r->x[2 * i + k] + (u[k] >= 0 ? dx[u[k]] : 0);
    r->turn[i] = r->theta[i] + (u[2] >= 0 ? dx[u[2]] : 0);
  }
  return GH_OK;
}

/* One full Newton step from x, with the factor at hand. *falls: the residual is at most `fall` times what it
 * was, and x is there; else all is where it was. */
static gh_status newton_step(gh_rve *r, double fall, bool *falls) {
  double start = gh_seconds(), before = r->m.residual;
  GH_TRY(r->coupled ? solve_forces_and_moments(r) : solve_forces(r));
  r->cost.factorise += gh_seconds() - start;
  GH_TRY(gh_engine_move(r->engine, r->step, r->turn));
  GH_TRY(gh_rve_look_at_contacts(r));
  *falls = r->m.residual <= fall * before && !r->m.unjammed;
  if (!*falls) {
    GH_TRY(gh_engine_move(r->engine, r->x, r->theta));
    return gh_rve_look_at_contacts(r);
  }
  memcpy(r->x, r->step, 2 * (size_t)r->n * sizeof(double));
  if (r->theta) memcpy(r->theta, r->turn, (size_t)r->n * sizeof(double));
  return GH_OK;
}

static bool polishes(const gh_rve *r) {
  return r->options.relaxation == GH_RELAX_POLISHED;
}

/* A residual from which relaxation that goes in circles may be helped on. */
static const double near = 1e-2;

/* Forces with friction have no potential, and relaxation may circle around the equilibrium that it has found.
 * Newton goes there, as long as every step halves the residual; loose grains, which would make the matrix
 * singular or be thrown far, are held by more and more stiffness of their own. Where it does not come to the
 * end, all is as it was: it may have gone back to an equilibrium that is unstable, which relaxation is just
 * leaving. */
static gh_status leave_circle(gh_rve *r, double tolerance) {
  static const double shifts[] = {0, 1e-9, 1e-6, 1e-4, 1e-2};
  GH_TRY(gh_engine_get(r->engine, r->x, r->theta));
  memcpy(r->x0, r->x, 2 * (size_t)r->n * sizeof(double));
  memcpy(r->theta0, r->theta, (size_t)r->n * sizeof(double));
  bool moved = false;
  for (size_t k = 0; k < sizeof shifts / sizeof *shifts; k++) {
    for (bool falls = true; falls;) {
      double start = gh_seconds();
      bool regular;
      r->shift = shifts[k] * r->options.law.normal_stiffness;
      GH_TRY(gh_rve_find_rattlers(r));
      GH_TRY(number_coupled(r));
      GH_TRY(factorise_shifted(r, &regular));
      r->cost.factorise += gh_seconds() - start;
      if (!regular) break;
      GH_TRY(newton_step(r, 0.5, &falls));
      moved = moved || falls;
      if (falls && r->m.residual <= tolerance) return GH_OK;
    }
  }
  if (!moved) return GH_OK;
  GH_TRY(gh_engine_move(r->engine, r->x0, r->theta0));
  return gh_rve_look_at_contacts(r);
}

/* Steps until relaxation without end is looked at: with friction 5000, and when slip was kept four times 500,
 * four times 1000, 2000, and 5000 from then on. */
static long portion(const gh_rve *r) {
  enum { WITHOUT_FRICTION = 50000, FIRST = 5000 };
  static const long then[] = {500, 1000, 2000};
  if (!r->coupled) return WITHOUT_FRICTION;
  const int k = (r->m.kept - 1) / 4;
  return r->m.kept && k < (int)(sizeof then / sizeof *then) ? then[k] : FIRST;
}

/* Without end: in circles, or slowly. What slip does in an increment depends on where it leads alone, so that
 * a circle gives back what it has dissipated; grains in motion keep it. */
static gh_status end_circle(gh_rve *r, double tolerance, bool goes_on) {
  if (!r->m.kept && r->m.residual <= near && polishes(r)) GH_TRY(leave_circle(r, tolerance));
  if (r->m.residual <= tolerance || !r->relaxes || !goes_on) return GH_OK;
  return gh_rve_keep_slip(r);
}

/* Relaxation by the engine until the residual as it is defined here is met: the engine sums in another order
 * and leaves a grain's contacts with its own images out of the mean, so that it may have to be asked for a
 * little more. The engine knows nothing of round-off: packings that hardly touch are asked in between whether
 * they have come as near as their positions allow. */
static gh_status relax(gh_rve *r, double tolerance, long *left) {
  double asked = tolerance, floor = r->floor, least = 0;
  for (;;) {
    const long most = portion(r);
    double start = gh_seconds();
    gh_relax_options o = {.tolerance = asked,
                          .max_steps = *left < most ? *left : most,
                          .floor = floor,
                          .method = r->options.relaxation,
                          .least_damping = least};
    gh_relax_result result;
    GH_TRY(gh_engine_relax(r->engine, &o, &result));
    *left -= result.steps;
    r->m.steps += result.steps;
    r->cost.steps += result.steps;
    r->cost.relax += gh_seconds() - start;
    GH_TRY(gh_rve_look_at_contacts(r));
    if (r->coupled && !result.converged) GH_TRY(end_circle(r, fmax(tolerance, target(r)), *left > 0));
    if (r->m.residual <= fmax(tolerance, target(r))) return GH_OK;
    r->m.accepted = *left <= 0 && (r->m.residual * r->m.mean_force <= r->options.accept ||
                                   r->m.residual <= r->accept_within * fmax(tolerance, target(r)));
    if (r->m.accepted) return GH_OK;
    if (*left <= 0 || result.steps < 1)
      return gh_fail(r->ctx, GH_DIVERGED,
                     "no equilibrium within %ld relaxation steps at F = [%.6g %.6g; %.6g %.6g]: the largest "
                     "force is %.3g of the mean contact force, wanted %.3g",
                     r->m.steps, r->F[0], r->F[1], r->F[2], r->F[3], r->m.residual, tolerance);
    least = result.converged || r->m.kept ? 0 : result.least_damping;
    if (!result.converged) continue;
    asked *= 0.5 * fmin(1, tolerance / r->m.residual);
    floor *= 0.5;
  }
}

/* Newton from the engine's positions as long as it is safe. *done: the residual is reached. Else the engine
 * is at the last safe positions, and *again says whether it is worth another try further on. */
static gh_status polish(gh_rve *r, bool *done, bool *again) {
  *done = false;
  *again = true;
  const double fall = r->relaxes ? 0.5 : 0.95; /* rotations alone have one equilibrium: any fall will do */
  if (r->coupled && r->relaxes && !only_rolls(r)) { /* nine times of ten the matrix is singular */
    *again = false;
    return GH_OK;
  }
  GH_TRY(gh_engine_get(r->engine, r->x, r->theta));
  for (;;) {
    bool good, falls;
    GH_TRY(factorise(r, &good));
    if (!good) { /* with friction: grains that carry nothing slide on their last contact until the end */
      *again = !r->coupled;
      return GH_OK;
    }
    GH_TRY(newton_step(r, fall, &falls));
    if (!falls) return GH_OK;
    *done = r->m.residual <= target(r);
    r->m.polished = *done;
    if (*done) return GH_OK;
  }
}

/* What round-off of the positions hides: long cells and packings far from the origin have coarse positions.
 */
static void find_limits(gh_rve *r, const double cell[4]) {
  r->extent = hypot(cell[0], cell[2]) + hypot(cell[1], cell[3]);
  for (int k = 0; k < 2 * r->n; k++) r->extent = gh_max(r->extent, fabs(r->x[k]));
  double E = r->options.law.normal_stiffness;
  r->floor = fmax(1e-13 * E * gh_packing_mean_radius(r->packing), 4 * DBL_EPSILON * E * r->extent);
}

/* The residual by relaxation alone. */
static gh_status solve_alone(gh_rve *r) {
  long left = r->options.max_steps;
  return relax(r, r->options.tolerance, &left);
}

/* Where rotations alone are unknown, the branch cannot change: at a fixed Coulomb limit their incremental
 * potential is convex (positions fix the normal forces). Newton may begin at once there. */
static gh_status solve(gh_rve *r) {
  long left = r->options.max_steps;
  double aim = fmax(first_relaxation, r->options.tolerance);
  bool done = false, again;
  if (!r->relaxes) {
    GH_TRY(gh_rve_look_at_contacts(r));
    if (r->m.unjammed || r->m.residual <= target(r)) return GH_OK;
    GH_TRY(polish(r, &done, &again));
  }
  while (!done) {
    GH_TRY(relax(r, aim, &left));
    if (r->m.unjammed || r->m.accepted || r->m.residual <= target(r)) break;
    GH_TRY(polish(r, &done, &again));
    if (!done) aim = again ? fmax(fmin(r->m.residual, aim) / 10, target(r)) : target(r);
  }
  return GH_OK;
}

gh_status gh_rve_equilibrate(gh_rve *r) {
  double cell[4];
  double start = gh_seconds();
  gh_mul2(r->F, r->packing->cell, cell);
  find_limits(r, cell);
  r->shift = 0;
  GH_TRY(gh_engine_set(r->engine, cell, r->x, r->theta));
  r->cost.set += gh_seconds() - start;
  if (!gh_rve_solves(r)) {
    GH_TRY(gh_rve_look_at_contacts(r));
    r->m.stress_free = r->m.unjammed;
    return GH_OK;
  }
  GH_TRY(polishes(r) ? solve(r) : solve_alone(r));
  find_stress_free(r);
  return gh_engine_get(r->engine, r->x, r->theta);
}
