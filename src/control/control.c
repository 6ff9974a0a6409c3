/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One material point under mixed control: Newton, cuts, and servo control beyond jumps (method 6).
 *
 * Four equations g(F) = condition(F, P(F)) - target = 0 for the four components of F. Their lack is measured
 * as a strain: |M^-1 g|, where M is the derivative of g for an isotropic elastic solid (Lame constants
 * sqrt(3)/4 E both, those of the triangular lattice of equal disks). So stress and deformation have one
 * measure.
 *
 * Servo control is what a test machine does: F moves by -M^-1 g, that is, as if the packing were that solid,
 * only faster where the packing's own tangent allows it. Every step is committed. Where the packing can carry
 * what is wanted, this ends there, whatever rearranges on the way. */
#include "granhom/control.h"

#include "control/four.h"

#include <float.h>
#include <stdlib.h>

/* A step is long enough when it takes this share of the decrease that the tangent promises. */
static const double decrease = 0.1;
/* More strain than this at once is no correction but a tangent that means nothing any more. */
static const double longest = 0.2;
static const double round_off = 1e-13; /* of conditions on the deformation */
enum { TRIALS = 5, WEAK_STEPS = 3, SERVO_STEPS = 1000, FAILURES = 12, JUMPS = 100 };

typedef struct point_state {
  double F[4], P[4], A[16];
} point_state;

struct gh_control {
  gh_context *ctx;
  gh_point_ops ops;
  void *point;
  gh_control_options options;
  bool (*stop)(void *data);
  void *stop_data;
  void (*count)(void *data);
  void *count_data;
  point_state eq; /* committed */
  bool started;
  double change; /* departure of P from its linear prediction at the best trial that failed; 0: none */
};

/* What is to be met: at the end of the increment, and at the end of the present part of it. */
typedef struct goal {
  const gh_condition *condition;
  double end[4], from[4], now[4];
  double stress; /* largest stress at the start and among the targets */
  gh_control_report *report;
} goal;

gh_control_options gh_control_defaults(void) {
  return (gh_control_options){.tolerance = 1e-6, .max_iterations = 20, .cut_steps = 6, .pass_jumps = true};
}

static gh_status check_options(gh_context *ctx, const gh_control_options *o) {
  if (!(o->stiffness > 0) || !isfinite(o->stiffness))
    return gh_fail(ctx, GH_INPUT, "the stiffness of the control must be positive and finite, not %g",
                   o->stiffness);
  if (!(o->tolerance > 0) || !(o->tolerance < 1))
    return gh_fail(ctx, GH_INPUT, "the tolerance of the stresses must lie between 0 and 1, not %g",
                   o->tolerance);
  if (o->max_iterations < 1 || o->cut_steps < 0 || o->cut_steps > 30)
    return gh_fail(ctx, GH_INPUT, "%d iterations and %d cuts: at least 1, and from 0 to 30, are wanted",
                   o->max_iterations, o->cut_steps);
  return GH_OK;
}

gh_status gh_control_create(gh_context *ctx, const gh_point_ops *ops, void *point,
                            const gh_control_options *options, gh_control **control) {
  *control = NULL;
  GH_TRY(check_options(ctx, options));
  GH_TRY(gh_alloc(ctx, 1, sizeof **control, control));
  **control = (gh_control){.ctx = ctx, .ops = *ops, .point = point, .options = *options};
  return GH_OK;
}

static gh_status rve_evaluate(void *p, const double F[4], unsigned want, double P[4], double A[16]) {
  return gh_rve_evaluate(p, F, want, P, A);
}
static gh_status rve_commit(void *p) {
  return gh_rve_commit(p);
}
static gh_status rve_revert(void *p) {
  return gh_rve_revert(p);
}
static gh_status rve_keep(void *p) {
  return gh_rve_keep(p);
}

gh_status gh_control_create_rve(gh_context *ctx, gh_rve *rve, const gh_control_options *options,
                                gh_control **control) {
  static const gh_point_ops ops = {
      .evaluate = rve_evaluate, .commit = rve_commit, .revert = rve_revert, .keep = rve_keep};
  return gh_control_create(ctx, &ops, rve, options, control);
}

void gh_control_destroy(gh_control **control) {
  if (!control) return;
  free(*control);
  *control = NULL;
}

void gh_control_set_stop(gh_control *c, bool (*stop)(void *data), void *data) {
  c->stop = stop;
  c->stop_data = data;
}

void gh_control_set_count(gh_control *c, void (*count)(void *data), void *data) {
  c->count = count;
  c->count_data = data;
}

const double *gh_control_F(const gh_control *c) {
  return c->eq.F;
}
const double *gh_control_P(const gh_control *c) {
  return c->eq.P;
}
const double *gh_control_A(const gh_control *c) {
  return c->eq.A;
}

/* ---- evaluations ---- */

static gh_status evaluate(gh_control *c, point_state *s) {
  if (c->stop && c->stop(c->stop_data)) return gh_fail(c->ctx, GH_STOPPED, "stopped on request");
  GH_TRY(c->ops.evaluate(c->point, s->F, GH_WANT_TANGENT, s->P, s->A));
  const char *what = !gh_finite(s->P, 4) ? "stress" : !gh_finite(s->A, 16) ? "tangent" : NULL;
  if (!what) return GH_OK;
  return gh_fail(c->ctx, GH_DIVERGED, "the %s at F = [%.6g %.6g; %.6g %.6g] is not finite", what, s->F[0],
                 s->F[1], s->F[2], s->F[3]);
}

static gh_status commit(gh_control *c, const point_state *s) {
  if (c->count) c->count(c->count_data);
  GH_TRY(c->ops.commit(c->point));
  c->eq = *s;
  return GH_OK;
}

/* The iterate that the point has just been evaluated at is accepted: trials near it start there. */
static gh_status accept(gh_control *c) {
  return c->ops.keep ? c->ops.keep(c->point) : GH_OK;
}

/* A trial that fails because of its F is no reason to stop. */
static bool fatal(gh_status s) {
  return s != GH_OK && s != GH_DIVERGED && s != GH_INPUT;
}

gh_status gh_control_start(gh_control *c, const double F[4]) {
  point_state s;
  memcpy(s.F, F, sizeof s.F);
  GH_TRY(evaluate(c, &s));
  GH_TRY(commit(c, &s));
  c->started = true;
  return GH_OK;
}

/* ---- the equations ---- */

static double dot4(const double a[4], const double b[4]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

static double stress_size(const point_state *s) {
  double cauchy[4];
  gh_cauchy2(s->P, s->F, cauchy);
  return gh_largest(cauchy, 4);
}

static void lack(const goal *q, const point_state *s, double g[4]) {
  for (int k = 0; k < 4; k++) g[k] = gh_condition_value(&q->condition[k], s->F, s->P) - q->now[k];
}

static void slopes(const goal *q, const point_state *s, double J[16]) {
  for (int k = 0; k < 4; k++) gh_condition_slope(&q->condition[k], s->F, s->P, s->A, J + 4 * k);
}

/* M at F: the derivative of the conditions for the elastic solid without stress, of stiffness E. */
static void elastic_slopes(const gh_condition condition[4], double E, const double F[4], double M[16]) {
  double mu = 0.25 * sqrt(3) * E, A[16], P[4] = {0};
  for (int a = 0; a < 16; a++) {
    int i = a >> 3, J = a >> 2 & 1, k = a >> 1 & 1, L = a & 1;
    A[a] = mu * ((i == J && k == L) + (i == k && J == L) + (i == L && J == k));
  }
  for (int k = 0; k < 4; k++) gh_condition_slope(&condition[k], F, P, A, M + 4 * k);
}

static void reference(const gh_control *c, const goal *q, const double F[4], double M[16]) {
  elastic_slopes(q->condition, c->options.stiffness, F, M);
}

gh_status gh_conditions_check(gh_context *ctx, const gh_condition condition[4], const double F[4]) {
  double M[16], zero[4] = {0}, x[4];
  elastic_slopes(condition, 1, F, M);
  if (gh_four_solve(M, 1, zero, x)) return GH_OK;
  return gh_fail(
      ctx, GH_INPUT,
      "the four conditions do not determine F: one follows from the others, or nothing takes out the "
      "rotation");
}

static double size_of(const gh_condition *condition) {
  double sum = 0;
  for (int k = 0; k < GH_QUANTITIES; k++) sum += fabs(condition->factor[k]);
  return sum;
}

/* Lack of the stress conditions over the largest stress. */
static double mismatch(const goal *q, const point_state *s, const double g[4]) {
  double worst = 0, size = gh_max(q->stress, stress_size(s));
  for (int k = 0; k < 4; k++)
    if (q->condition[k].stress) worst = gh_max(worst, fabs(g[k]) / size_of(&q->condition[k]));
  return size > 0 ? worst / size : worst;
}

static bool is_met(const gh_control *c, const goal *q, const point_state *s, const double g[4]) {
  double size = gh_max(q->stress, stress_size(s));
  for (int k = 0; k < 4; k++) {
    double limit = q->condition[k].stress
                       ? gh_max(c->options.tolerance * size, 4 * DBL_EPSILON * c->options.stiffness)
                       : round_off * fmax(1, gh_largest(s->F, 4));
    if (!gh_within(fabs(g[k]), limit * size_of(&q->condition[k]))) return false;
  }
  return true;
}

/* The lack as a strain. */
static double measure(const gh_control *c, const goal *q, const double F[4], const double g[4]) {
  double M[16], d[4];
  reference(c, q, F, M);
  return gh_four_solve(M, 1, g, d) ? gh_norm(d, 4) : INFINITY;
}

/* ---- Newton ---- */

static void offer_change(gh_control *c, const point_state *now, const point_state *next) {
  double d[4];
  for (int i = 0; i < 4; i++) {
    d[i] = next->P[i] - now->P[i];
    for (int k = 0; k < 4; k++) d[i] -= now->A[4 * i + k] * (next->F[k] - now->F[k]);
  }
  c->change = gh_norm(d, 4);
}

/* One step of Newton's method from *now along d, shortened until the lack falls; the first one of an attempt
 * carries the driven components along and is taken whole. */
static gh_status search(gh_control *c, goal *q, const double d[4], bool whole, int *weak, point_state *now) {
  double g[4], first, best_lack, step = 1;
  point_state next, best;
  gh_status status;
  lack(q, now, g);
  first = measure(c, q, now->F, g);
  best_lack = INFINITY;
  for (int k = 0; k < TRIALS; k++, step /= 2) {
    for (int a = 0; a < 4; a++) next.F[a] = now->F[a] + step * d[a];
    status = gh_det2(next.F) > 0 ? evaluate(c, &next) : gh_fail(c->ctx, GH_INPUT, "det F <= 0");
    q->report->iterations++;
    if (fatal(status)) return status;
    if (status != GH_OK && whole) return GH_DIVERGED;
    if (status != GH_OK) continue;
    lack(q, &next, g);
    double missing = measure(c, q, next.F, g);
    if (whole || (isfinite(missing) && missing <= (1 - decrease * step) * first) || is_met(c, q, &next, g)) {
      *now = next;
      return accept(c);
    }
    if (!(missing < best_lack)) continue;
    best_lack = missing;
    best = next;
  }
  if (isfinite(best_lack)) offer_change(c, now, &best);
  if (!(best_lack < (1 - 1e-6) * first) || ++*weak > WEAK_STEPS)
    return gh_fail(c->ctx, GH_DIVERGED, "the lack of stress does not fall along Newton's direction");
  *now = best; /* and so that the trial state of the point is this one: */
  GH_TRY(evaluate(c, now));
  return accept(c);
}

/* An increment in which nothing changes: evaluated all the same, so that the point's measures are those of
 * this state. */
static gh_status stay(gh_control *c, goal *q, point_state *now) {
  q->report->iterations++;
  return evaluate(c, now);
}

/* Looks for the equilibrium that meets the goal from the committed state. */
static gh_status newton(gh_control *c, goal *q, point_state *now) {
  int weak = 0;
  *now = c->eq;
  c->change = 0;
  for (int k = 0;; k++) {
    double g[4], J[16], d[4];
    lack(q, now, g);
    if (is_met(c, q, now, g)) return k > 0 ? GH_OK : stay(c, q, now);
    if (k == c->options.max_iterations)
      return gh_fail(c->ctx, GH_DIVERGED, "not converged after %d iterations", k);
    slopes(q, now, J);
    if (!gh_four_solve(J, 1, g, d)) return gh_fail(c->ctx, GH_DIVERGED, "the tangent is singular");
    if (!(gh_norm(d, 4) <= longest))
      return gh_fail(c->ctx, GH_DIVERGED, "the tangent asks for a strain of %.3g at once", gh_norm(d, 4));
    for (int a = 0; a < 4; a++) d[a] = -d[a];
    GH_TRY(search(c, q, d, k == 0, &weak, now));
  }
}

/* ---- servo control ---- */

/* The next step: -(M^-1 J + shift 1)^-1 M^-1 g with the least shift for which it leads to rest, no longer
 * than cap. Without shift it is Newton's. */
static gh_status servo_direction(gh_control *c, const goal *q, const double g[4], double cap, double d[4]) {
  double J[16], M[16], B[16], r[4], shift = 0;
  slopes(q, &c->eq, J);
  reference(c, q, c->eq.F, M);
  if (!gh_four_solve(M, 4, J, B) || !gh_four_solve(M, 1, g, r))
    return gh_fail(c->ctx, GH_DIVERGED, "the conditions do not determine F any more");
  while (!gh_four_stable(B, shift)) {
    shift = shift > 0 ? 2 * shift : 0.01;
    if (!(shift < 1e6)) return gh_fail(c->ctx, GH_DIVERGED, "the tangent is not finite");
  }
  if (shift > 0) shift *= 2; /* not on the edge of rest */
  for (int a = 0; a < 4; a++) B[5 * a] += shift;
  if (!gh_four_solve(B, 1, r, d)) memcpy(d, r, sizeof r);
  double length = gh_norm(d, 4);
  if (!isfinite(length)) return gh_fail(c->ctx, GH_DIVERGED, "the step of servo control is not finite");
  for (int a = 0; a < 4; a++) d[a] *= -fmin(1, cap / length);
  return GH_OK;
}

static gh_status give_up(gh_control *c, const goal *q, int steps) {
  double g[4], value = 0;
  int worst = 0;
  lack(q, &c->eq, g);
  for (int k = 0; k < 4; k++)
    if (q->condition[k].stress && fabs(g[k]) >= fabs(g[worst])) worst = k;
  value = gh_condition_value(&q->condition[worst], c->eq.F, c->eq.P);
  return gh_fail(
      c->ctx, GH_DIVERGED,
      "the packing does not come to rest under these conditions: after %d steps of servo control, at "
      "F = [%.6g %.6g; %.6g %.6g], condition %d of 4 is at %.6g and wanted at %.6g",
      steps, c->eq.F[0], c->eq.F[1], c->eq.F[2], c->eq.F[3], worst + 1, value, q->now[worst]);
}

/* Steps of at most the strain that the stress makes in the grains, committed one by one, until the goal is
 * met. */
static gh_status servo(gh_control *c, goal *q) {
  int failures = 0;
  double before[4] = {0},
         usual = fmin(0.01, fmax(1e-6, 0.25 * gh_max(q->stress, stress_size(&c->eq)) / c->options.stiffness)),
         cap = usual;
  for (int k = 0; k < SERVO_STEPS; k++) {
    double g[4], d[4] = {0};
    lack(q, &c->eq, g);
    if (is_met(c, q, &c->eq, g)) return GH_OK;
    GH_TRY(servo_direction(c, q, g, cap, d));
    cap = dot4(d, before) < 0 ? cap / 2 : fmin(1.5 * cap, 4 * usual); /* thrown to and fro: shorter */
    memcpy(before, d, sizeof before);
    point_state next = c->eq;
    for (int a = 0; a < 4; a++) next.F[a] += d[a];
    gh_status status = gh_det2(next.F) > 0 ? evaluate(c, &next) : gh_fail(c->ctx, GH_INPUT, "det F <= 0");
    q->report->iterations++;
    if (fatal(status)) return status;
    if (status == GH_OK) GH_TRY(commit(c, &next));
    else cap = gh_norm(d, 4) / 4;
    if (status != GH_OK && ++failures == FAILURES)
      return gh_prefix(c->ctx, GH_DIVERGED, "servo control met %d failures: ", failures);
  }
  return give_up(c, q, SERVO_STEPS);
}

/* ---- an increment ---- */

typedef struct walk {
  double t, dt;
  int level;
  double change;
} walk;

static void aim(goal *q, double t) {
  for (int k = 0; k < 4; k++) q->now[k] = t < 1 ? q->from[k] + t * (q->end[k] - q->from[k]) : q->end[k];
}

static void advance(walk *w, double t, bool easy) {
  w->t = t;
  w->change = 0;
  if (w->level > 0 && easy && fmod(w->t, 2 * w->dt) == 0) {
    w->level--;
    w->dt *= 2;
  }
}

/* A smooth law departs from its linear prediction by a quarter when the part is halved, a jump by as much as
 * before: then further cuts only spend time, and two are enough to tell. */
static bool is_jump(const gh_control *c, walk *w) {
  bool stays = c->change > 0 && c->change > 0.6 * w->change;
  w->change = c->change;
  return stays && w->level >= 2;
}

/* After a failed attempt: a cut, or servo control, or the end. */
static gh_status recover(gh_control *c, goal *q, walk *w, double t) {
  gh_control_report *r = q->report;
  GH_TRY(c->ops.revert(c->point));
  bool jump = is_jump(c, w), last = w->level >= c->options.cut_steps;
  if (!last && !(jump && c->options.pass_jumps)) {
    w->level++;
    w->dt /= 2;
    r->cuts++;
    return GH_OK;
  }
  if (!c->options.pass_jumps || r->jumps == JUMPS)
    return gh_prefix(c->ctx, GH_DIVERGED,
                     "no equilibrium after %d bisections and %d instabilities stepped over: ", r->cuts,
                     r->jumps);
  r->jumps++;
  GH_TRY(servo(c, q));
  advance(w, t, true);
  r->parts++;
  return GH_OK;
}

static gh_status run(gh_control *c, goal *q) {
  walk w = {.dt = 1};
  while (w.t < 1) {
    int before = q->report->iterations;
    double t = w.t + w.dt;
    point_state now;
    aim(q, t);
    gh_status status = newton(c, q, &now);
    if (status == GH_OK) {
      GH_TRY(commit(c, &now));
      advance(&w, t, 2 * (q->report->iterations - before) <= c->options.max_iterations);
      q->report->parts++;
    } else if (status == GH_DIVERGED) {
      status = recover(c, q, &w, t);
    }
    if (status == GH_OK) continue;
    c->ops.revert(c->point); /* the first failure is the one to report */
    return status;
  }
  return GH_OK;
}

static gh_status check(gh_control *c, const goal *q) {
  for (int k = 0; k < 4; k++)
    if (!isfinite(q->end[k]))
      return gh_fail(c->ctx, GH_INPUT, "the target of condition %d is not finite", k + 1);
  if (!c->started)
    return gh_fail(c->ctx, GH_INPUT, "the control has no state to begin with (gh_control_start)");
  return gh_conditions_check(c->ctx, q->condition, c->eq.F);
}

gh_status gh_control_solve(gh_control *c, const gh_condition condition[4], const double target[4],
                           gh_control_report *report) {
  gh_control_report unused, *r = report ? report : &unused;
  *r = (gh_control_report){0};
  goal q = {.condition = condition, .report = r};
  memcpy(q.end, target, sizeof q.end);
  GH_TRY(check(c, &q));
  q.stress = stress_size(&c->eq);
  for (int k = 0; k < 4; k++) {
    q.from[k] = gh_condition_value(&condition[k], c->eq.F, c->eq.P);
    if (condition[k].stress) q.stress = gh_max(q.stress, fabs(target[k]) / size_of(&condition[k]));
  }
  gh_status status = run(c, &q);
  double g[4];
  aim(&q, 1);
  lack(&q, &c->eq, g);
  r->mismatch = mismatch(&q, &c->eq, g);
  return status;
}
