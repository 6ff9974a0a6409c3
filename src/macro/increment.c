/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One increment of the loads: substeps, bisection, commits.
 *
 * An increment starts at a state that the farm has committed. What holds the body there and is neither a load
 * nor a support of the new increment (reactions of released supports; the initial stress before the first
 * increment; what an instability of a packing left unbalanced) becomes an external force that fades linearly,
 * m->fade. So the path to the end of the increment always starts balanced, and bisection always helps a
 * smooth material. */
#include "macro/internal.h"

#include <string.h>

/* Moves the start of the increment to m->eq, which lies at the fraction t of the path to `to`. */
static gh_status increment_rebase(gh_macro *m, const gh_loads *to, double t) {
  for (int k = 0; k < m->follow.n; k++) m->follow.edge[k].pressure *= 1 - t;
  if (t == 1) m->follow.n = 0;
  for (int k = 0; t > 0 && k < to->follow.n; k++) {
    const gh_edge_load *edge = to->follow.edge + k;
    GH_TRY(gh_edge_loads_add(m->ctx, &m->follow, edge->a, edge->b, t * edge->pressure));
  }
  for (int d = 0; d < m->ndof; d++) m->force[d] = (1 - t) * m->force[d] + t * to->force[d];
  gh_external_forces(m, to, 0, false, m->eq.u, m->fext);
  for (int d = 0; d < m->ndof; d++) {
    m->from[d] = m->eq.u[d];
    m->trial[d] = m->eq.fint[d] - m->fext[d];
    m->fade[d] = to->fixed[d] || m->owner[d / 2] >= 0 ? 0 : m->trial[d];
  }
  gh_footings_rebase(m, to, t, m->trial);
  return GH_OK;
}

/* m->now becomes the state from which the farm continues; m->eq lies at the fraction t0. */
static gh_status increment_commit(gh_macro *m, const gh_attempt *a, double t0, bool evaluated,
                                  bool balanced) {
  GH_TRY(gh_farm_commit(m->farm));
  gh_energy_count(m, a, t0, evaluated, balanced);
  gh_state_swap(&m->eq, &m->now);
  gh_external_forces(m, a->to, a->t, false, m->eq.u, m->fext);
  for (int d = 0; d < m->ndof; d++)
    m->reaction[d] = a->to->fixed[d] || m->owner[d / 2] >= 0 ? m->eq.fint[d] - m->fext[d] : 0;
  return GH_OK;
}

/* How far the increment has come: the next substep is [t, t + dt], at this depth of bisection. */
typedef struct walk {
  double t, dt;
  int level, point,
      again;            /* again: instabilities in a row of the same point that did not halve the residual */
  double jump_residual; /* after the last instability */
  double change; /* departure of a stress from its linear prediction when a substep failed last; INFINITY:
                    none did */
  bool in_vain;  /* relaxation did not come to rest: until the end of the increment it is left alone */
} walk;

static gh_status substep_accept(gh_macro *m, const gh_attempt *a, int iterations, walk *w,
                                gh_macro_report *r) {
  GH_TRY(increment_commit(m, a, w->t, iterations > 0, true));
  r->substeps++;
  r->residual = a->residual;
  r->relative = gh_relative_residual(a);
  gh_energy_residual(m, r->relative);
  if (w->level > m->deepest) m->deepest = w->level;
  w->t = a->t;
  w->again = 0;
  w->change = INFINITY;
  /* Substeps grow on the grid of halves, quarters, ..., so that they end at 1 and are never finer than the
   * option states. */
  if (w->level > m->first_level && 2 * iterations <= m->options.max_iterations &&
      fmod(w->t, 2 * w->dt) == 0) {
    w->level--;
    w->dt *= 2;
  }
  return GH_OK;
}

enum { JUMPS = 40, AGAIN = 8 };

/* Steps over an instability: commits the post-instability states, lets the body come to rest there under the
 * current loads, and starts again from that state. */
static gh_status instability_step_over(gh_macro *m, gh_attempt *a, walk *w, gh_macro_report *r) {
  if (!m->options.pass_jumps || r->jumps == JUMPS || w->again == AGAIN) return GH_DIVERGED;
  double residual = m->instability.residual;
  GH_TRY(gh_instability_evaluate(m));
  GH_TRY(increment_commit(m, a, w->t, true, false));
  GH_TRY(increment_rebase(m, a->to, a->t));
  w->t = 0; /* the path is counted from here, and the event has happened, also if what follows fails */
  r->jumps++;
  gh_attempt settled = {.to = a->to, .substep = a->substep};
  gh_status followed = gh_follow(m, &settled);
  a->iterations += settled.iterations;
  GH_TRY(increment_rebase(m, a->to, 0)); /* from wherever the committed steps have led */
  GH_TRY(followed);
  w->again = m->instability.point != w->point || residual < 0.5 * w->jump_residual ? 0 : w->again + 1;
  w->point = m->instability.point;
  w->jump_residual = residual;
  w->dt = ldexp(1, -m->first_level);
  w->level = m->first_level;
  w->change = INFINITY;
  gh_log(m->ctx, GH_LEVEL_INFO,
         "stepped over an instability: integration point %d, stress changes by %.3g, unbalanced force %.3g",
         m->instability.point, m->instability.change, residual);
  return GH_OK;
}

/* A smooth law departs from its linear prediction by a quarter when the substep is halved, a stress
 * discontinuity by as much as before: then further bisection only spends time, and two are enough to decide.
 * An increment that has met one instability meets more of them, and each is stepped over at once, unless it
 * is the same point again: a packing that long steps move to and fro settles on one side in short ones. */
static bool substep_meets_instability(const gh_macro *m, walk *w, int jumps) {
  bool candidate = m->options.pass_jumps && isfinite(m->instability.residual),
       stays = m->instability.change > 0.6 * w->change;
  const int cuts = w->level - m->first_level;
  w->change = candidate ? m->instability.change : INFINITY;
  if (w->again > 0) return candidate && cuts >= 2 + w->again;
  return candidate && (jumps > 0 || (cuts >= 2 && stays));
}

static void substep_bisect(walk *w, gh_macro_report *r) {
  w->level++;
  w->dt *= 0.5;
  r->cuts++;
}

/* Where Newton has stopped, `last`: for good. GH_DIVERGED: not asked for, or it does not come to rest either:
 * a stress in the gap of a discontinuity, which it meets once more in each part of the increment. The
 * instability that Newton has met stays known. */
static gh_status substep_relax(gh_macro *m, gh_attempt *a, walk *w, gh_macro_report *r, bool last) {
  const int before = a->iterations;
  if (m->options.method != GH_METHOD_AUTOMATIC || (w->in_vain && !last)) return GH_DIVERGED;
  const gh_instability met = m->instability;
  gh_status status = gh_relax(m, a);
  m->instability = met;
  r->iterations = a->iterations;
  r->relaxed = a->relaxed;
  if (status == GH_OK) return substep_accept(m, a, a->iterations - before, w, r);
  w->in_vain = true;
  if (status == GH_DIVERGED) GH_TRY(gh_farm_revert(m->farm));
  return status;
}

/* After a failed attempt: bisect, or step over an instability, or give up. */
static gh_status substep_recover(gh_macro *m, gh_attempt *a, walk *w, gh_macro_report *r) {
  GH_TRY(gh_farm_revert(m->farm));
  bool last = w->level >= m->options.cut_steps + m->first_level;
  if (last) gh_instability_from_swing(m);
  if (!substep_meets_instability(m, w, r->jumps) && !last) {
    substep_bisect(w, r);
    return GH_OK;
  }
  char reason[512];
  snprintf(reason, sizeof reason, "%s", gh_message(m->ctx));
  gh_status status = substep_relax(m, a, w, r, last);
  if (status == GH_DIVERGED) status = instability_step_over(m, a, w, r);
  if (status != GH_DIVERGED) return status;
  GH_TRY(gh_farm_revert(m->farm));
  if (!last) {
    substep_bisect(w, r);
    return GH_OK;
  }
  gh_fail(m->ctx, status, "%s", reason);
  return gh_instability_explain(m, a, r);
}

static gh_status increment_advance(gh_macro *m, const gh_loads *loads, walk *w, gh_macro_report *r) {
  gh_attempt a = {.to = loads};
  while (w->t < 1) {
    int before = a.iterations;
    a.t = w->t + w->dt;
    a.substep = r->substeps;
    gh_status status = m->options.method == GH_METHOD_RELAXATION ? gh_relax(m, &a) : gh_newton(m, &a);
    r->iterations = a.iterations;
    r->relaxed = a.relaxed;
    if (status == GH_OK) status = substep_accept(m, &a, a.iterations - before, w, r);
    else if (status == GH_DIVERGED) status = substep_recover(m, &a, w, r);
    if (status == GH_OK) continue;
    gh_farm_revert(m->farm); /* the first failure is the one to report */
    r->residual = a.residual;
    r->relative = gh_relative_residual(&a);
    return status;
  }
  return GH_OK;
}

gh_status gh_macro_solve(gh_macro *m, const gh_loads *loads, gh_macro_report *report) {
  gh_macro_report unused, *r = report ? report : &unused;
  walk w = {.dt = ldexp(1, -m->first_level),
            .level = m->first_level,
            .point = -1,
            .jump_residual = INFINITY,
            .change = INFINITY};
  *r = (gh_macro_report){0};
  m->begin = gh_seconds();
  m->micro_seconds = 0;
  m->deepest = 0;
  if (loads->mesh != m->mesh) return gh_fail(m->ctx, GH_INPUT, "the loads belong to another mesh");
  GH_TRY(gh_footings_begin(m, loads));
  GH_TRY(gh_supports_check(m->ctx, m->mesh, loads->fixed, m->nfootings, m->footing));
  GH_TRY(gh_macro_start(m));
  m->solved = true;
  GH_TRY(gh_system_constrain(m->system, loads->fixed, m->nfootings, m->owner));
  GH_TRY(increment_rebase(m, loads, 0));
  gh_status status = increment_advance(m, loads, &w, r);
  gh_status kept = increment_rebase(m, loads, w.t); /* loads of the state that was reached */
  r->micro_seconds = m->micro_seconds;
  r->seconds = gh_seconds() - m->begin;
  return status != GH_OK ? status : kept;
}
