/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Newton's iteration with line search for one substep of an increment.
 *
 * The first correction is a linear prediction with the last tangent that carries the prescribed displacements
 * along: K_ff du_f = -(R_f + K_fp du_p). Imposing them on the old field instead would strain one row of
 * elements alone, which a packing answers by rearranging. The residual of iteration 0 is this right-hand
 * side: the unbalanced forces of the increment, linearised at the last equilibrium; no packing is evaluated
 * for it.
 *
 * Every trial starts from the farm's converged state, and its packings look for equilibrium there or, with
 * friction, near that of the accepted iterate (gh_farm_keep). m->now is the iterate and the farm's trial
 * state belongs to it. */
#include "macro/internal.h"

#include <float.h>
#include <string.h>

/* A step is long enough when it takes this share of the decrease that the tangent promises ... */
static const double decrease = 0.1;
/* ... or when the work of the residual along the direction falls below this share of the first, as long as
 * the residual does not grow by more than `growth`: a step that is right in the soft directions may be wrong
 * in the stiff ones. */
static const double slope = 0.5, growth = 2;
enum { TRIALS = 5, WEAK_STEPS = 3 };
/* Shortened steps in a row that do not halve the residual: as it happens before an instability of a packing,
 * where each step ends on the near side. It is given up early, because bisection or stepping over the
 * instability helps. */
enum { SLOW_STEPS = 4 };
/* With a tangent that is not updated, as many iterations must bring the residual down to a tenth. */
enum { PATIENCE = 10 };

/* One factorisation serves all iterations of a substep. */
static bool newton_keeps_factor(const gh_macro *m, const gh_attempt *a) {
  const gh_tangent t = m->options.tangent;
  return (t == GH_TANGENT_FROZEN || t == GH_TANGENT_ELASTIC) && !a->present && !a->released;
}

static void matrix_symmetrise(int n, double *K) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) K[n * i + j] = K[n * j + i] = 0.5 * (K[n * i + j] + K[n * j + i]);
}

/* The post-instability descent uses the current tangents, whatever the choice (gh_follow). */
static void tangent_assemble(gh_macro *m, const gh_attempt *a) {
  const bool halves = m->options.tangent == GH_TANGENT_SYMMETRISED && !a->released;
  const double *A = m->elastic && newton_keeps_factor(m, a) ? m->elastic : m->now.A;
  gh_system_clear(m->system);
  for (int e = 0; e < m->mesh->nelements; e++) {
    double K[8][8];
    int dof[8];
    for (int k = 0; k < 8; k++) dof[k] = 2 * m->mesh->quad[e][k / 2] + k % 2;
    gh_element_stiffness(&m->shapes, e, A + 64 * e, K);
    if (halves) matrix_symmetrise(8, K[0]);
    gh_system_add(m->system, 8, dof, K[0]);
  }
  const gh_edge_loads *lists[2] = {&m->follow, &a->to->follow};
  const double share[2] = {1 - a->t, a->t};
  for (int l = 0; l < 2; l++)
    for (int k = 0; k < lists[l]->n; k++) {
      const gh_edge_load *edge = lists[l]->edge + k;
      int dof[4] = {2 * edge->a, 2 * edge->a + 1, 2 * edge->b, 2 * edge->b + 1};
      double K[4][4];
      gh_edge_stiffness(share[l] * edge->pressure, K);
      if (halves) matrix_symmetrise(4, K[0]);
      gh_system_add(m->system, 4, dof, K[0]);
    }
  if (m->nfootings == 0) return;
  gh_external_forces(m, a->to, a->t, !a->released, m->now.u, m->fext);
  for (int d = 0; d < m->ndof; d++) m->trial[d] = m->now.fint[d] - m->fext[d];
  gh_footings_tangent(m, a->to, a->t, m->now.u, m->trial);
}

/* One trial of length s: m->next, its residual and the residual's work. */
static gh_status step_try(gh_macro *m, gh_attempt *a, double s, double *residual, double *scale,
                          double *work) {
  gh_step_move(m, s);
  if (newton_keeps_factor(m, a)) GH_TRY(gh_macro_evaluate_stress(m, &m->next, &m->now));
  else GH_TRY(gh_macro_evaluate(m, &m->next));
  gh_residual_find(m, a, &m->next, NULL, m->trial);
  GH_TRY(gh_residual_measure(m, a, m->trial, residual, scale));
  *work = gh_residual_along(m, a, m->trial);
  return GH_OK;
}

/* Before each correction. */
static void attempt_remember(gh_attempt *a) {
  memmove(a->before + 1, a->before, sizeof a->before - sizeof *a->before);
  a->before[0] = a->residual;
}

/* What a step has to fall below. Where packings come to rest in varying states, the residual decreases
 * irregularly, and steps that are shortened for it lead to no other packings: the largest of the last few is
 * what counts (Grippo, Lampariello and Lucidi, SIAM J. Numer. Anal. 23, 707, 1986). Residuals so small that
 * they are what the packings' own tolerance leaves would only wander by that. */
static double attempt_bound(const gh_macro *m, const gh_attempt *a) {
  double worst = a->residual;
  if (worst <= m->options.memory_above * a->scale) return worst;
  for (int k = 0; k < m->options.memory; k++) worst = fmax(worst, a->before[k]);
  return worst;
}

static bool status_is_fatal(gh_status s) {
  return s != GH_OK && s != GH_DIVERGED && s != GH_INPUT;
}

/* The next length to try: the zero of the work by a secant, within bounds; half after a failed evaluation. */
static double step_shorten(double s, double work0, double work) {
  double zero = work0 < 0 && work > 0 ? s * work0 / (work0 - work) : 0.5 * s;
  return fmin(0.5 * s, fmax(0.2 * s, zero));
}

/* Backtracks until a step is long enough; else takes the best that lowers the residual at all and counts it
 * as weak; else the iteration has stalled. */
static gh_status line_search(gh_macro *m, gh_attempt *a, double *step, int *weak) {
  double now = a->residual, beat = attempt_bound(m, a), work0 = gh_residual_along(m, a, m->residual),
         best = 0, best_residual = now * (1 - 1e-6), tried = 0;
  gh_status failure = GH_OK;
  *step = 1;
  gh_instability_forget(&m->instability);
  for (int k = 0; k < TRIALS; k++) {
    double residual, scale, work = NAN;
    tried = *step;
    gh_status status = step_try(m, a, tried, &residual, &scale, &work);
    if (status_is_fatal(status)) return status;
    if (status != GH_OK) {
      failure = status;
      *step *= 0.5;
      continue;
    }
    if (residual <= (1 - decrease * tried) * beat || gh_within(residual, gh_residual_limit(m, scale)) ||
        (gh_within(fabs(work), slope * fabs(work0)) && residual <= growth * now)) {
      if (residual > now) gh_instability_offer(m, &m->swing, residual);
      gh_step_accept(m, a, residual, scale);
      return GH_OK;
    }
    if (residual < best_residual) {
      best = tried;
      best_residual = residual;
    }
    gh_instability_offer(m, &m->instability, residual);
    *step = step_shorten(tried, work0, work);
  }
  if (best > 0 && ++*weak <= WEAK_STEPS) {
    double residual, scale, work;
    *step = best;
    GH_TRY(step_try(m, a, best, &residual, &scale, &work));
    gh_step_accept(m, a, residual, scale);
    return GH_OK;
  }
  if (failure != GH_OK && !isfinite(m->instability.residual)) return GH_DIVERGED; /* its message states why */
  return gh_fail(m->ctx, GH_DIVERGED,
                 "the residual does not fall along Newton's direction down to a step of %.2g", tried);
}

static gh_status step_full(gh_macro *m, gh_attempt *a) {
  double residual, scale, work;
  gh_instability_forget(&m->instability);
  gh_status status = step_try(m, a, 1, &residual, &scale, &work);
  if (status != GH_OK) return status_is_fatal(status) ? status : GH_DIVERGED;
  gh_step_accept(m, a, residual, scale);
  return GH_OK;
}

static gh_status correction_solve(gh_macro *m, bool again) {
  for (int d = 0; d < gh_residual_size(m); d++) m->trial[d] = -m->residual[d];
  gh_status status =
      again ? gh_system_again(m->system, m->trial, m->du) : gh_system_solve(m->system, m->trial, m->du);
  if (status != GH_DIVERGED) return status;
  char text[256] = "";
  gh_name_unjammed(m, text, sizeof text);
  return gh_fail(m->ctx, status, "%s%s%s", gh_message(m->ctx), *text ? ": " : "", text);
}

static gh_status newton_iterate(gh_macro *m, gh_attempt *a) {
  const int done = a->iterations;
  int weak = 0, slow = 0;
  gh_instability_forget(&m->instability);
  gh_instability_forget(&m->swing);
  memset(a->before, 0, sizeof a->before);
  gh_state_copy(m, &m->eq, &m->now);
  tangent_assemble(m, a);
  bool moved = gh_prescribe(m, a);
  gh_residual_find(m, a, &m->now, moved ? m->du : NULL, m->residual);
  GH_TRY(gh_residual_measure(m, a, m->residual, &a->residual, &a->scale));
  double first = a->residual, mark = first, step = 1;
  gh_iteration_report(m, a, 0, first, step);
  for (int k = 0; moved || !gh_residual_converged(m, a); k++) {
    if (k == m->options.max_iterations)
      return gh_fail(m->ctx, GH_DIVERGED, "not converged after %d iterations", m->options.max_iterations);
    if (k > 0) {
      if (!newton_keeps_factor(m, a)) tangent_assemble(m, a);
      memset(m->du, 0, (size_t)gh_residual_size(m) * sizeof *m->du);
    }
    attempt_remember(a);
    GH_TRY(correction_solve(m, k > 0 && newton_keeps_factor(m, a)));
    GH_TRY(moved || !m->options.line_search ? step_full(m, a) : line_search(m, a, &step, &weak));
    moved = false;
    a->iterations++;
    gh_iteration_report(m, a, k + 1, first, step);
    slow = step < 1 && a->residual > a->before[0] / 2 ? slow + 1 : 0;
    if (slow == SLOW_STEPS && !gh_residual_converged(m, a))
      return gh_fail(m->ctx, GH_DIVERGED, "the residual creeps: %d shortened steps in a row did not halve it",
                     slow);
    if (!newton_keeps_factor(m, a) || (k + 1) % PATIENCE > 0) continue;
    if (!(a->residual <= 0.1 * mark) && !gh_residual_converged(m, a))
      return gh_fail(m->ctx, GH_DIVERGED, "%d iterations did not bring the residual down to a tenth",
                     PATIENCE);
    mark = a->residual;
  }
  /* Tangents for what comes next; an increment that was in equilibrium at once has those of the last. */
  return newton_keeps_factor(m, a) && a->iterations > done ? gh_macro_evaluate(m, &m->now) : GH_OK;
}

/* A tangent that is not updated may be too far off; and what resembles an instability from there need not be
 * one, which is decided by the departure from the current tangent. So only a failure with that one counts. */
gh_status gh_newton(gh_macro *m, gh_attempt *a) {
  a->present = false;
  gh_status status = newton_iterate(m, a);
  if (status != GH_DIVERGED || !newton_keeps_factor(m, a)) return status;
  GH_TRY(gh_farm_revert(m->farm));
  a->present = true;
  return newton_iterate(m, a);
}

/* One step down the energy: the longest of a few trials that does not overshoot the minimum along the
 * direction by much. */
static gh_status step_descend(gh_macro *m, gh_attempt *a, double *step) {
  enum { MOST = 6 };
  double work0 = gh_residual_along(m, a, m->residual), residual, scale, work = 0;
  *step = 1;
  for (int k = 0;; k++) {
    gh_status status = step_try(m, a, *step, &residual, &scale, &work);
    if (status_is_fatal(status)) return status;
    const bool usable = status == GH_OK && isfinite(work) && isfinite(work0),
               same = work == 0 || work0 == 0 || (work > 0) == (work0 > 0); /* the product may underflow */
    if (usable && (same || fabs(work) <= slope * fabs(work0) || k + 1 >= MOST)) break;
    if (k + 1 >= 2 * MOST) return status == GH_OK ? gh_residual_refuse(m, m->trial) : GH_DIVERGED;
    *step = usable ? fmax(0.1 * *step, *step * work0 / (work0 - work)) : 0.5 * *step;
  }
  gh_step_accept(m, a, residual, scale);
  return GH_OK;
}

gh_status gh_follow(gh_macro *m, gh_attempt *a) {
  enum { MOST = 100 };
  double step = 1, first;
  a->released = true;
  gh_state_copy(m, &m->eq, &m->now);
  gh_residual_find(m, a, &m->now, NULL, m->residual);
  GH_TRY(gh_residual_measure(m, a, m->residual, &a->residual, &a->scale));
  first = a->residual;
  for (int k = 0; !gh_residual_converged(m, a); k++) {
    if (k == MOST)
      return gh_fail(m->ctx, GH_DIVERGED, "no post-instability equilibrium after %d steps", MOST);
    tangent_assemble(m, a);
    for (int d = 0; d < gh_residual_size(m); d++) m->du[d] = 0, m->trial[d] = -m->residual[d];
    GH_TRY(gh_system_descend(m->system, m->trial, m->du));
    GH_TRY(step_descend(m, a, &step));
    GH_TRY(gh_farm_commit(m->farm));
    gh_energy_count(m, a, a->t, true, false);
    gh_state_copy(m, &m->now, &m->eq);
    a->iterations++;
    gh_iteration_report(m, a, k + 1, first, step);
  }
  return GH_OK;
}
