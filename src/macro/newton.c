/* Newton's iteration with line search for one part of an increment. SPDX-License-Identifier: GPL-2.0-or-later
 *
 * The first correction is a linear prediction with the last tangent that carries the prescribed displacements
 * along: K_ff du_f = -(R_f + K_fp du_p). Imposing them on the old field instead would strain one row of
 * elements alone, which a packing answers by rearranging. The residual of iteration 0 is this right-hand
 * side: the out-of-balance forces of the increment, linearised at the last equilibrium; no packing is asked
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
/* Shortened steps in a row that do not halve the residual: the way it goes before a jump of a packing, where
 * each step ends at the near side. It is given up early, because a cut or a jump is what helps. */
enum { SLOW_STEPS = 4 };
/* With a tangent that stays behind, as many iterations must bring the residual down to a tenth. */
enum { PATIENCE = 10 };

void gh_outer_forces(const gh_macro *m, const gh_loads *to, double t, bool fade, const double *u, double *f) {
  for (int d = 0; d < m->ndof; d++)
    f[d] = m->f0[d] + (1 - t) * (m->force[d] + (fade ? m->fade[d] : 0)) + t * to->force[d];
  const gh_edge_loads *lists[2] = {&m->follow, &to->follow};
  const double share[2] = {1 - t, t};
  for (int l = 0; l < 2; l++)
    for (int k = 0; k < lists[l]->n; k++) {
      const gh_edge_load *edge = lists[l]->edge + k;
      double x[2][2], force[2];
      int node[2] = {edge->a, edge->b};
      for (int c = 0; c < 2; c++)
        for (int i = 0; i < 2; i++) x[c][i] = m->mesh->X[2 * node[c] + i] + u[2 * node[c] + i];
      gh_edge_force(x[0], x[1], share[l] * edge->pressure, force);
      for (int c = 0; c < 2; c++)
        for (int i = 0; i < 2; i++) f[2 * node[c] + i] += force[i];
    }
}

/* One factorisation serves all iterations of a part. */
static bool keeps_factor(const gh_macro *m, const gh_attempt *a) {
  const gh_tangent t = m->options.tangent;
  return (t == GH_TANGENT_FROZEN || t == GH_TANGENT_ELASTIC) && !a->present && !a->released;
}

static void symmetrise(int n, double *K) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) K[n * i + j] = K[n * j + i] = 0.5 * (K[n * i + j] + K[n * j + i]);
}

/* The way down beyond a jump goes by the tangents of where it is, whatever the choice (gh_follow). */
static void assemble(gh_macro *m, const gh_attempt *a) {
  const bool halves = m->options.tangent == GH_TANGENT_SYMMETRISED && !a->released;
  const double *A = m->elastic && keeps_factor(m, a) ? m->elastic : m->now.A;
  gh_system_clear(m->system);
  for (int e = 0; e < m->mesh->nelements; e++) {
    double K[8][8];
    int dof[8];
    for (int k = 0; k < 8; k++) dof[k] = 2 * m->mesh->quad[e][k / 2] + k % 2;
    gh_element_stiffness(&m->shapes, e, A + 64 * e, K);
    if (halves) symmetrise(8, K[0]);
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
      if (halves) symmetrise(4, K[0]);
      gh_system_add(m->system, 4, dof, K[0]);
    }
  if (m->nfootings == 0) return;
  gh_outer_forces(m, a->to, a->t, !a->released, m->now.u, m->fext);
  for (int d = 0; d < m->ndof; d++) m->trial[d] = m->now.fint[d] - m->fext[d];
  gh_footings_tangent(m, a->to, a->t, m->now.u, m->trial);
}

/* Entries of residuals and corrections: the nodes', then those of the footings. */
static int entries(const gh_macro *m) {
  return m->ndof + 3 * m->nfootings;
}

/* Whether entry d is an unknown: neither prescribed nor the node of a footing. */
static bool is_free(const gh_macro *m, const gh_attempt *a, int d) {
  return d >= m->ndof || (!a->to->fixed[d] && m->owner[d / 2] < 0);
}

/* R = f_int - f_ext at state s, plus K times the prescribed part of du where a prediction is asked for. */
static void find_residual(gh_macro *m, const gh_attempt *a, const gh_state *s, const double *predict,
                          double *R) {
  gh_outer_forces(m, a->to, a->t, !a->released, s->u, m->fext);
  for (int d = 0; d < m->ndof; d++) R[d] = s->fint[d] - m->fext[d];
  if (predict) gh_system_multiply(m->system, predict, R);
  m->footing_force = gh_footings_residual(m, a->to, a->t, !a->released, s->u, R);
}

/* Which residual force is not finite, and the likely cause. */
static gh_status residual_refuse(const gh_macro *m, const double *R) {
  int d = 0;
  char name[96] = "a footing";
  while (d < entries(m) && isfinite(R[d])) d++;
  if (d < m->ndof) gh_dof_name(m->mesh, d, name);
  if (d == entries(m))
    return gh_fail(m->ctx, GH_DIVERGED,
                   "the norm of the residual forces is not finite: the loads are too large");
  return gh_fail(
      m->ctx, GH_DIVERGED,
      "the residual force at %s is %g, not a finite number: the loads or the stresses are too large", name,
      R[d]);
}

/* |R_free| and |f_ext| + |R_prescribed|, footings' forces among f_ext. GH_DIVERGED: one is not finite. */
static gh_status measure(const gh_macro *m, const gh_attempt *a, const double *R, double *residual,
                         double *scale) {
  gh_squares norm = {0}, held = {0}, external = {0};
  gh_squares_add(&external, m->footing_force);
  for (int d = 0; d < entries(m); d++) {
    if (is_free(m, a, d)) gh_squares_add(&norm, R[d]);
    else if (a->to->fixed[d]) gh_squares_add(&held, R[d]);
    if (d < m->ndof) gh_squares_add(&external, m->fext[d]);
  }
  *residual = gh_squares_root(&norm);
  *scale = gh_squares_root(&external) + gh_squares_root(&held);
  return isfinite(*residual) && isfinite(*scale) ? GH_OK : residual_refuse(m, R);
}

/* The residual that counts as zero. Round-off of F is DBL_EPSILON, which the tangent turns into forces:
 * without this floor a body that is unloaded to no force at all would never converge. The stiffness is that
 * of the last assembly. */
static double limit(const gh_macro *m, double scale) {
  return fmax(m->options.tolerance * scale, DBL_EPSILON * m->length * gh_system_diagonal(m->system));
}

static bool converged(const gh_macro *m, const gh_attempt *a) {
  return gh_within(a->residual, limit(m, a->scale));
}

static double along(const gh_macro *m, const gh_attempt *a, const double *R) {
  double sum = 0;
  for (int d = 0; d < entries(m); d++)
    if (is_free(m, a, d)) sum += m->du[d] * R[d];
  return sum;
}

/* One trial of length s: m->next, its residual and the residual's work. */
static gh_status try_step(gh_macro *m, gh_attempt *a, double s, double *residual, double *scale,
                          double *work) {
  for (int d = 0; d < m->ndof; d++) m->next.u[d] = m->now.u[d] + s * m->du[d];
  for (int k = 0; k < m->nfootings; k++) {
    const double *q = m->du + m->ndof + 3 * k;
    gh_footing_move(m->mesh, m->footing + k, (const double[3]){s * q[0], s * q[1], s * q[2]}, m->now.u,
                    m->next.u);
  }
  if (keeps_factor(m, a)) GH_TRY(gh_macro_evaluate_stress(m, &m->next, &m->now));
  else GH_TRY(gh_macro_evaluate(m, &m->next));
  find_residual(m, a, &m->next, NULL, m->trial);
  GH_TRY(measure(m, a, m->trial, residual, scale));
  *work = along(m, a, m->trial);
  return GH_OK;
}

/* Before each correction. */
static void remember(gh_attempt *a) {
  memmove(a->before + 1, a->before, sizeof a->before - sizeof *a->before);
  a->before[0] = a->residual;
}

/* What a step has to fall below. Where packings come to rest now here, now there, the residual comes down by
 * fits and starts, and steps that are shortened for it lead to no other packings: the largest of the last few
 * is what counts (Grippo, Lampariello and Lucidi, SIAM J. Numer. Anal. 23, 707, 1986). Residuals so small
 * that they are what the packings' own tolerance leaves would only wander by that. */
static double to_beat(const gh_macro *m, const gh_attempt *a) {
  double worst = a->residual;
  if (worst <= m->options.memory_above * a->scale) return worst;
  for (int k = 0; k < m->options.memory; k++) worst = fmax(worst, a->before[k]);
  return worst;
}

static void accept(gh_macro *m, gh_attempt *a, double residual, double scale) {
  gh_state_swap(&m->now, &m->next);
  gh_farm_keep(m->farm);
  double *swap = m->residual;
  m->residual = m->trial;
  m->trial = swap;
  a->residual = residual;
  a->scale = scale;
}

static bool fatal(gh_status s) {
  return s != GH_OK && s != GH_DIVERGED && s != GH_INPUT;
}

/* The next length to try: the zero of the work by a secant, within bounds; half after a failed evaluation. */
static double shorten(double s, double work0, double work) {
  double zero = work0 < 0 && work > 0 ? s * work0 / (work0 - work) : 0.5 * s;
  return fmin(0.5 * s, fmax(0.2 * s, zero));
}

/* Backtracks until a step is long enough; else takes the best that lowers the residual at all and counts it
 * as weak; else the iteration has stalled. */
static gh_status search(gh_macro *m, gh_attempt *a, double *step, int *weak) {
  double now = a->residual, beat = to_beat(m, a), work0 = along(m, a, m->residual), best = 0,
         best_residual = now * (1 - 1e-6), tried = 0;
  gh_status failure = GH_OK;
  *step = 1;
  gh_jump_forget(&m->jump);
  for (int k = 0; k < TRIALS; k++) {
    double residual, scale, work = NAN;
    tried = *step;
    gh_status status = try_step(m, a, tried, &residual, &scale, &work);
    if (fatal(status)) return status;
    if (status != GH_OK) {
      failure = status;
      *step *= 0.5;
      continue;
    }
    if (residual <= (1 - decrease * tried) * beat || gh_within(residual, limit(m, scale)) ||
        (gh_within(fabs(work), slope * fabs(work0)) && residual <= growth * now)) {
      accept(m, a, residual, scale);
      return GH_OK;
    }
    if (residual < best_residual) {
      best = tried;
      best_residual = residual;
    }
    gh_jump_offer(m, residual);
    *step = shorten(tried, work0, work);
  }
  if (best > 0 && ++*weak <= WEAK_STEPS) {
    double residual, scale, work;
    *step = best;
    GH_TRY(try_step(m, a, best, &residual, &scale, &work));
    accept(m, a, residual, scale);
    return GH_OK;
  }
  if (failure != GH_OK && !isfinite(m->jump.residual)) return GH_DIVERGED; /* its message says why */
  return gh_fail(m->ctx, GH_DIVERGED,
                 "the residual does not fall along Newton's direction down to a step of %.2g", tried);
}

static gh_status full_step(gh_macro *m, gh_attempt *a) {
  double residual, scale, work;
  gh_jump_forget(&m->jump);
  gh_status status = try_step(m, a, 1, &residual, &scale, &work);
  if (status != GH_OK) return fatal(status) ? status : GH_DIVERGED;
  accept(m, a, residual, scale);
  return GH_OK;
}

/* The prescribed part of du; true when there is any. */
static bool prescribe(gh_macro *m, const gh_attempt *a) {
  bool any = false;
  for (int d = 0; d < entries(m); d++) {
    m->du[d] = 0;
    if (is_free(m, a, d) || !a->to->fixed[d]) continue;
    double target = a->t < 1 ? m->from[d] + a->t * (a->to->value[d] - m->from[d]) : a->to->value[d];
    m->du[d] = target - m->now.u[d];
    any = any || m->du[d] != 0;
  }
  return any;
}

double gh_relative_residual(const gh_attempt *a) {
  if (a->residual == 0) return 0;
  return a->scale > 0 ? a->residual / a->scale : 1; /* nothing acts but the residual itself */
}

static void report(const gh_macro *m, const gh_attempt *a, int iteration, double first, double step) {
  if (!m->watch) return;
  gh_macro_iteration it = {.substep = a->substep,
                           .iteration = iteration,
                           .residual = a->residual,
                           .scale = a->scale,
                           .relative = gh_relative_residual(a),
                           .first = first > 0 ? a->residual / first : 0,
                           .step = step,
                           .seconds = gh_seconds() - m->begin};
  m->watch(m->watch_data, &it);
}

static gh_status direction(gh_macro *m, bool again) {
  for (int d = 0; d < entries(m); d++) m->trial[d] = -m->residual[d];
  gh_status status =
      again ? gh_system_again(m->system, m->trial, m->du) : gh_system_solve(m->system, m->trial, m->du);
  if (status != GH_DIVERGED) return status;
  char text[256] = "";
  gh_name_unjammed(m, text, sizeof text);
  return gh_fail(m->ctx, status, "%s%s%s", gh_message(m->ctx), *text ? ": " : "", text);
}

static gh_status iterate(gh_macro *m, gh_attempt *a) {
  const int done = a->iterations;
  int weak = 0, slow = 0;
  gh_jump_forget(&m->jump);
  memset(a->before, 0, sizeof a->before);
  gh_state_copy(m, &m->eq, &m->now);
  assemble(m, a);
  bool moved = prescribe(m, a);
  find_residual(m, a, &m->now, moved ? m->du : NULL, m->residual);
  GH_TRY(measure(m, a, m->residual, &a->residual, &a->scale));
  double first = a->residual, mark = first, step = 1;
  report(m, a, 0, first, step);
  for (int k = 0; moved || !converged(m, a); k++) {
    if (k == m->options.max_iterations)
      return gh_fail(m->ctx, GH_DIVERGED, "not converged after %d iterations", m->options.max_iterations);
    if (k > 0) {
      if (!keeps_factor(m, a)) assemble(m, a);
      memset(m->du, 0, (size_t)entries(m) * sizeof *m->du);
    }
    remember(a);
    GH_TRY(direction(m, k > 0 && keeps_factor(m, a)));
    GH_TRY(moved || !m->options.line_search ? full_step(m, a) : search(m, a, &step, &weak));
    moved = false;
    a->iterations++;
    report(m, a, k + 1, first, step);
    slow = step < 1 && a->residual > a->before[0] / 2 ? slow + 1 : 0;
    if (slow == SLOW_STEPS && !converged(m, a))
      return gh_fail(m->ctx, GH_DIVERGED, "the residual creeps: %d shortened steps in a row did not halve it",
                     slow);
    if (!keeps_factor(m, a) || (k + 1) % PATIENCE > 0) continue;
    if (!(a->residual <= 0.1 * mark) && !converged(m, a))
      return gh_fail(m->ctx, GH_DIVERGED, "%d iterations did not bring the residual down to a tenth",
                     PATIENCE);
    mark = a->residual;
  }
  /* Tangents for what comes next; an increment that was in equilibrium at once has those of the last. */
  return keeps_factor(m, a) && a->iterations > done ? gh_macro_evaluate(m, &m->now) : GH_OK;
}

/* A tangent that stays behind may be too far behind; and what looks like a jump from there need not be one,
 * for that is told by the departure from the present tangent. So a failure is one only with that. */
gh_status gh_newton(gh_macro *m, gh_attempt *a) {
  a->present = false;
  gh_status status = iterate(m, a);
  if (status != GH_DIVERGED || !keeps_factor(m, a)) return status;
  GH_TRY(gh_farm_revert(m->farm));
  a->present = true;
  return iterate(m, a);
}

/* One step down the energy: the longest of a few trials that does not overshoot the minimum along the
 * direction by much. */
static gh_status descend(gh_macro *m, gh_attempt *a, double *step) {
  enum { MOST = 6 };
  double work0 = along(m, a, m->residual), residual, scale, work = 0;
  *step = 1;
  for (int k = 0;; k++) {
    gh_status status = try_step(m, a, *step, &residual, &scale, &work);
    if (fatal(status)) return status;
    const bool usable = status == GH_OK && isfinite(work) && isfinite(work0),
               same = work == 0 || work0 == 0 || (work > 0) == (work0 > 0); /* the product may underflow */
    if (usable && (same || fabs(work) <= slope * fabs(work0) || k + 1 >= MOST)) break;
    if (k + 1 >= 2 * MOST) return status == GH_OK ? residual_refuse(m, m->trial) : GH_DIVERGED;
    *step = usable ? fmax(0.1 * *step, *step * work0 / (work0 - work)) : 0.5 * *step;
  }
  accept(m, a, residual, scale);
  return GH_OK;
}

gh_status gh_follow(gh_macro *m, gh_attempt *a) {
  enum { MOST = 100 };
  double step = 1, first;
  a->released = true;
  gh_state_copy(m, &m->eq, &m->now);
  find_residual(m, a, &m->now, NULL, m->residual);
  GH_TRY(measure(m, a, m->residual, &a->residual, &a->scale));
  first = a->residual;
  for (int k = 0; !converged(m, a); k++) {
    if (k == MOST) return gh_fail(m->ctx, GH_DIVERGED, "no equilibrium beyond the jump after %d steps", MOST);
    assemble(m, a);
    for (int d = 0; d < entries(m); d++) m->du[d] = 0, m->trial[d] = -m->residual[d];
    GH_TRY(gh_system_descend(m->system, m->trial, m->du));
    GH_TRY(descend(m, a, &step));
    GH_TRY(gh_farm_commit(m->farm));
    gh_energy_count(m, a, a->t, true, false);
    gh_state_copy(m, &m->now, &m->eq);
    a->iterations++;
    report(m, a, k + 1, first, step);
  }
  return GH_OK;
}
