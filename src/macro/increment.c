/* One increment of the loads: parts of it, cuts, commits. SPDX-License-Identifier: GPL-2.0-or-later
 *
 * An increment starts at a state that the farm has committed. What holds the body there and is neither a load
 * nor a support of the new increment (reactions of released supports; the initial stress before the first
 * increment; what a packing left out of balance when it jumped) becomes an outer force that fades linearly,
 * m->fade. So the way to the end of the increment always begins in balance, and cutting it always helps a
 * smooth material. */
#include "macro/internal.h"

#include <string.h>

/* Moves the start of the increment to m->eq, which lies at the fraction t of the way to `to`. */
static gh_status rebase(gh_macro *m, const gh_loads *to, double t) {
  for (int k = 0; k < m->follow.n; k++) m->follow.edge[k].pressure *= 1 - t;
  if (t == 1) m->follow.n = 0;
  for (int k = 0; t > 0 && k < to->follow.n; k++) {
    const gh_edge_load *edge = to->follow.edge + k;
    GH_TRY(gh_edge_loads_add(m->ctx, &m->follow, edge->a, edge->b, t * edge->pressure));
  }
  for (int d = 0; d < m->ndof; d++) m->force[d] = (1 - t) * m->force[d] + t * to->force[d];
  gh_outer_forces(m, to, 0, false, m->eq.u, m->fext);
  for (int d = 0; d < m->ndof; d++) {
    m->from[d] = m->eq.u[d];
    m->trial[d] = m->eq.fint[d] - m->fext[d];
    m->fade[d] = to->fixed[d] || m->owner[d / 2] >= 0 ? 0 : m->trial[d];
  }
  gh_footings_rebase(m, to, t, m->trial);
  return GH_OK;
}

/* m->now becomes the state from which the farm goes on; m->eq lies at the fraction t0. */
static gh_status commit(gh_macro *m, const gh_attempt *a, double t0, bool evaluated, bool balanced) {
  GH_TRY(gh_farm_commit(m->farm));
  gh_energy_count(m, a, t0, evaluated, balanced);
  gh_state_swap(&m->eq, &m->now);
  gh_outer_forces(m, a->to, a->t, false, m->eq.u, m->fext);
  for (int d = 0; d < m->ndof; d++)
    m->reaction[d] = a->to->fixed[d] || m->owner[d / 2] >= 0 ? m->eq.fint[d] - m->fext[d] : 0;
  return GH_OK;
}

/* How far the increment has come: the next part is [t, t + dt], cut `level` times. */
typedef struct walk {
  double t, dt;
  int level, point, again; /* again: jumps in a row of the same point that did not halve the residual */
  double jump_residual;    /* beyond the last jump */
  double change; /* departure of a stress from its linear prediction when a part failed last; INFINITY: none
                    did */
} walk;

static gh_status succeed(gh_macro *m, const gh_attempt *a, int iterations, walk *w, gh_macro_report *r) {
  GH_TRY(commit(m, a, w->t, iterations > 0, true));
  r->substeps++;
  r->residual = a->residual;
  r->relative = gh_relative_residual(a);
  gh_energy_residual(m, r->relative);
  if (w->level > m->deepest) m->deepest = w->level;
  w->t = a->t;
  w->again = 0;
  w->change = INFINITY;
  /* Parts grow on the grid of halves, quarters, ..., so that they end at 1 and are never cut finer than the
   * option says. */
  if (w->level > m->first_level && 2 * iterations <= m->options.max_iterations &&
      fmod(w->t, 2 * w->dt) == 0) {
    w->level--;
    w->dt *= 2;
  }
  return GH_OK;
}

enum { JUMPS = 40, AGAIN = 8 };

/* Commits the states beyond the jump, lets the body come to rest there under the loads at hand, and starts
 * anew from that state. */
static gh_status pass_jump(gh_macro *m, gh_attempt *a, walk *w, gh_macro_report *r) {
  if (!m->options.pass_jumps || r->jumps == JUMPS || w->again == AGAIN) return GH_DIVERGED;
  double residual = m->jump.residual;
  GH_TRY(gh_jump_take(m));
  GH_TRY(commit(m, a, w->t, true, false));
  GH_TRY(rebase(m, a->to, a->t));
  w->t = 0; /* the way is counted from here, and the event has happened, also if what follows fails */
  r->jumps++;
  gh_attempt settled = {.to = a->to, .substep = a->substep};
  gh_status followed = gh_follow(m, &settled);
  a->iterations += settled.iterations;
  GH_TRY(rebase(m, a->to, 0)); /* from wherever the committed steps have led */
  GH_TRY(followed);
  w->again = m->jump.point != w->point || residual < 0.5 * w->jump_residual ? 0 : w->again + 1;
  w->point = m->jump.point;
  w->jump_residual = residual;
  w->dt = ldexp(1, -m->first_level);
  w->level = m->first_level;
  w->change = INFINITY;
  gh_log(m->ctx, GH_LEVEL_INFO,
         "passed a jump of the packings: integration point %d, stress changes by %.3g, %.3g out of balance",
         m->jump.point, m->jump.change, residual);
  return GH_OK;
}

/* A smooth law departs from its linear prediction by a quarter when the part is halved, a jump by as much as
 * before: then further cuts only spend time, and two are enough to tell. An increment that has met one jump
 * meets more of them, and each is passed at once, unless it is the same point again: a packing that is thrown
 * to and fro by long steps settles on one side when it is led there in short ones. */
static bool is_jump(const gh_macro *m, walk *w, int jumps) {
  bool candidate = m->options.pass_jumps && isfinite(m->jump.residual),
       stays = m->jump.change > 0.6 * w->change;
  const int cuts = w->level - m->first_level;
  w->change = candidate ? m->jump.change : INFINITY;
  if (w->again > 0) return candidate && cuts >= 2 + w->again;
  return candidate && (jumps > 0 || (cuts >= 2 && stays));
}

static void cut(walk *w, gh_macro_report *r) {
  w->level++;
  w->dt *= 0.5;
  r->cuts++;
}

/* After a failed attempt: cut, or pass a jump, or give up. */
static gh_status recover(gh_macro *m, gh_attempt *a, walk *w, gh_macro_report *r) {
  GH_TRY(gh_farm_revert(m->farm));
  bool last = w->level >= m->options.cut_steps + m->first_level;
  if (!is_jump(m, w, r->jumps) && !last) {
    cut(w, r);
    return GH_OK;
  }
  char reason[512];
  snprintf(reason, sizeof reason, "%s", gh_message(m->ctx));
  gh_status status = pass_jump(m, a, w, r);
  if (status != GH_DIVERGED) return status;
  GH_TRY(gh_farm_revert(m->farm));
  if (!last) {
    cut(w, r);
    return GH_OK;
  }
  gh_fail(m->ctx, status, "%s", reason);
  return gh_jump_explain(m, a, r);
}

static gh_status advance(gh_macro *m, const gh_loads *loads, walk *w, gh_macro_report *r) {
  gh_attempt a = {.to = loads};
  while (w->t < 1) {
    int before = a.iterations;
    a.t = w->t + w->dt;
    a.substep = r->substeps;
    gh_status status = gh_newton(m, &a);
    r->iterations = a.iterations;
    if (status == GH_OK) status = succeed(m, &a, a.iterations - before, w, r);
    else if (status == GH_DIVERGED) status = recover(m, &a, w, r);
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
  GH_TRY(rebase(m, loads, 0));
  gh_status status = advance(m, loads, &w, r);
  gh_status kept = rebase(m, loads, w.t); /* loads of the state that was reached */
  r->micro_seconds = m->micro_seconds;
  r->seconds = gh_seconds() - m->begin;
  return status != GH_OK ? status : kept;
}
