/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One RVE: converged state, trial state, and the path from F to P and A. */
#include "micro/internal.h"

#include <stdlib.h>
#include <string.h>

/* Friction makes relaxation short where there is an equilibrium at all: a few hundred steps. */
enum { DEFAULT_STEPS = 400000, DEFAULT_STEPS_FRICTION = 50000 };

gh_rve_options gh_rve_defaults(void) {
  return (gh_rve_options){.boundary = GH_PERIODIC,
                          .engine = GH_ENGINE_LAMMPS,
                          .tolerance = 1e-8,
                          .servo_gain = 0.1,
                          .servo_tolerance = 1e-4};
}

long gh_rve_step_limit(const gh_rve_options *o) {
  if (o->max_steps > 0) return o->max_steps;
  return o->law.friction ? DEFAULT_STEPS_FRICTION : DEFAULT_STEPS;
}

void gh_rve_destroy(gh_rve **rve) {
  if (!rve || !*rve) return;
  gh_rve *r = *rve;
  gh_engine_destroy(&r->engine);
  gh_solver_destroy(&r->solver);
  gh_rattlers_destroy(&r->rattlers);
  gh_cluster_destroy(&r->cluster);
  gh_frame_destroy(&r->frame);
  gh_servo_destroy(&r->servo);
  gh_packing_destroy(&r->packing);
  void *const arrays[] = {r->X,
                          r->yn,
                          r->y,
                          r->x,
                          r->step,
                          r->thetan,
                          r->theta,
                          r->turn,
                          r->x0,
                          r->loose,
                          r->loose_push,
                          r->theta0,
                          r->view_grain,
                          r->view_id,
                          r->view_flags,
                          r->all_held,
                          r->history.slips,
                          r->trial_history.slips,
                          r->kept,
                          r->base.y,
                          r->base.theta,
                          r->base.slips.slips,
                          r->sliding};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  free(r);
  *rve = NULL;
}

/* Two grains of a frame that touch have a stiffness of 2 E_n against each other, whatever the others do: with a gain
 * of 1 or more they move farther apart in each sweep. */
static gh_status servo_check(gh_context *ctx, const gh_rve_options *o) {
  if (!(o->servo_gain > 0) || !(o->servo_gain < 1))
    return gh_fail(
        ctx, GH_INPUT,
        "servo-control with a gain of %g cannot converge: it must lie between 0 and 1, since the largest "
        "stiffness of a frame is at least 2 E_n",
        o->servo_gain);
  if (!(o->servo_tolerance > 0) || !(o->servo_tolerance < 1))
    return gh_fail(ctx, GH_INPUT, "the tolerance of servo-control must lie between 0 and 1, not %g",
                   o->servo_tolerance);
  if (o->servo_acceleration < 0 || o->servo_acceleration > GH_SERVO_DEPTH)
    return gh_fail(ctx, GH_INPUT, "the acceleration of servo-control must lie between 0 and %d, not %d",
                   GH_SERVO_DEPTH, o->servo_acceleration);
  return GH_OK;
}

static gh_status options_check(gh_context *ctx, const gh_rve_options *o) {
  if (!(o->tolerance > 0) || !(o->tolerance < 1))
    return gh_fail(ctx, GH_INPUT, "the tolerance must lie between 0 and 1, not %g", o->tolerance);
  if (!(o->accept >= 0) || isinf(o->accept))
    return gh_fail(ctx, GH_INPUT, "the unbalanced force that is accepted must be 0 or more, not %g",
                   o->accept);
  if (!(o->allow_overlap >= 0))
    return gh_fail(ctx, GH_INPUT, "the mean overlap that is allowed must be 0 or more, not %g",
                   o->allow_overlap);
  if (gh_rve_has_servo(o)) GH_TRY(servo_check(ctx, o));
  if (o->max_steps < 0)
    return gh_fail(ctx, GH_INPUT, "the number of relaxation steps must not be negative, but is %ld",
                   o->max_steps);
  return GH_OK;
}

static gh_status rve_make_engine(gh_rve *r) {
  const gh_cluster *c = r->cluster;
  const gh_rve_frame *f = r->frame;
  r->radius = c ? c->radius : f ? f->radius : r->packing->radius;
  GH_TRY(gh_condition_fix(r));
  gh_engine_setup setup = {.n = r->n,
                           .radius = r->radius,
                           .type = c   ? c->type
                                   : f ? f->type
                                       : r->packing->type,
                           .fixed = f && r->turns ? f->fixed : NULL,
                           .edges = gh_frame_is_open(f) ? f->edges : NULL,
                           .area = gh_frame_is_open(f) && !gh_rve_has_servo(&r->options) ? f->area : NULL,
                           .held = r->held,
                           .periodic = r->periodic,
                           .law = r->options.law};
  return gh_engine_create(r->ctx, r->options.engine, &setup, &r->engine);
}

/* Rattlers touch few others: no iteration asks for memory. */
static gh_status rve_make_loose(gh_rve *r) {
  GH_TRY(gh_alloc(r->ctx, (size_t)r->n * LOOSE_PUSH, sizeof(double), &r->loose_push));
  return gh_grow(r->ctx, 3 * (size_t)r->n + 1, sizeof *r->loose, &r->loose_capacity, &r->loose);
}

static gh_status rve_make_state(gh_rve *r) {
  size_t n = 2 * (size_t)r->n;
  double **const arrays[] = {&r->X, &r->yn, &r->y, &r->x, &r->step};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    GH_TRY(gh_alloc(r->ctx, n, sizeof(double), arrays[k]));
  GH_TRY(gh_alloc(r->ctx, n, sizeof(int), &r->view_grain));
  GH_TRY(gh_alloc(r->ctx, n, sizeof(int), &r->view_id));
  GH_TRY(gh_alloc(r->ctx, n, 1, &r->view_flags));
  memcpy(r->X, r->cluster ? r->cluster->x : r->frame ? r->frame->x : r->packing->x, n * sizeof(double));
  memcpy(r->yn, r->X, n * sizeof(double));
  memcpy(r->y, r->X, n * sizeof(double));
  memcpy(r->Fn, (double[4]){1, 0, 0, 1}, sizeof r->Fn);
  memcpy(r->F, r->Fn, sizeof r->F);
  r->pressuren = -1;
  if (r->relaxes) GH_TRY(gh_alloc(r->ctx, n, sizeof(double), &r->x0));
  if (!gh_rve_friction(r)) return r->relaxes ? rve_make_loose(r) : GH_OK;
  double **const turns[] = {&r->thetan, &r->theta, &r->turn, &r->theta0, &r->base.theta};
  for (size_t k = 0; k < sizeof turns / sizeof *turns; k++)
    GH_TRY(gh_alloc(r->ctx, (size_t)r->n, sizeof(double), turns[k]));
  GH_TRY(gh_alloc(r->ctx, n, sizeof(double), &r->base.y));
  if (!gh_rve_ramps(r)) return GH_OK;
  const size_t contacts = 3 * (size_t)r->n + 1; /* grains touch six others at most: no ramp asks for memory */
  GH_TRY(gh_grow(r->ctx, contacts, sizeof(gh_slip), &r->base.slips.capacity, &r->base.slips.slips));
  return gh_grow(r->ctx, contacts, sizeof(gh_friction), &r->sliding_capacity, &r->sliding);
}

static gh_status rve_make_solver(gh_rve *r) {
  if (!gh_rve_solves(r)) return GH_OK;
  GH_TRY(gh_rattlers_create(r->ctx, r->n, &r->rattlers));
  if (gh_frame_is_open(r->frame) && !gh_rve_has_servo(&r->options))
    return gh_solver_frame(r->ctx, r->n, !gh_rve_friction(r), r->frame, &r->solver);
  return gh_solver_block(r->ctx, r->n, !gh_rve_friction(r), &r->solver);
}

gh_status gh_rve_create(gh_context *ctx, const gh_packing *packing, const gh_rve_options *options,
                        gh_rve **rve) {
  *rve = NULL;
  GH_TRY(options_check(ctx, options));
  GH_TRY(gh_rve_check_packing(ctx, packing, options));
  gh_rve *r;
  GH_TRY(gh_alloc(ctx, 1, sizeof *r, &r));
  gh_status status;
  r->ctx = ctx;
  r->options = *options;
  r->options.max_steps = gh_rve_step_limit(options);
  const gh_condition condition = gh_condition_of(options);
  r->relaxes = gh_condition_relaxes(&condition);
  r->turns = options->law.friction && !options->law.fixed_rotations;
  r->periodic = condition.body != GH_BODY_CLUSTER;
  GH_TRY_OR(gh_packing_copy(ctx, packing, &r->packing), failed);
  if (!r->periodic) GH_TRY_OR(gh_cluster_create(ctx, packing, &r->cluster), failed);
  if (condition.body == GH_BODY_FRAME)
    GH_TRY_OR(gh_frame_create(ctx, packing, &condition, &r->frame), failed);
  r->n = r->cluster ? r->cluster->n : r->frame ? r->frame->n : packing->n;
  r->lattice = r->frame ? r->frame->lattice : r->packing->cell;
  r->volume = gh_det2(packing->cell);
  r->mean_radius = gh_packing_mean_radius(packing);
  GH_TRY_OR(rve_make_engine(r), failed);
  GH_TRY_OR(rve_make_state(r), failed);
  GH_TRY_OR(rve_make_solver(r), failed);
  if (condition.servo) GH_TRY_OR(gh_servo_create(r), failed);
  *rve = r;
  return GH_OK;
failed:
  gh_rve_destroy(&r);
  return status;
}

/* y = F^-1 x: positions before the deformation, fluctuations included. */
static void positions_pull_back(gh_rve *r) {
  double inverse[4];
  gh_inv2(r->F, inverse);
  for (int i = 0; i < r->n; i++) gh_apply2(inverse, &r->x[2 * i], &r->y[2 * i]);
  if (!r->frame || !r->pinned) return;
  const int corner = r->frame->corner; /* nothing else prescribes where the packing is: corners follow F */
  const double off[2] = {r->y[2 * corner] - r->X[2 * corner], r->y[2 * corner + 1] - r->X[2 * corner + 1]};
  double shift[2];
  gh_apply2(r->F, off, shift);
  for (int i = 0; i < 2 * r->n; i++) r->y[i] -= off[i % 2], r->x[i] -= shift[i % 2];
}

static gh_status rve_evaluate(gh_rve *r, const double *near, unsigned want, double A[16]) {
  gh_start b;
  gh_servo_hold(r);
  GH_TRY(gh_state_start(r, near, &b));
  if (gh_rve_ramps(r) && !b.near) GH_TRY(gh_rve_ramp_to_base(r, &b));
  GH_TRY(r->servo ? gh_servo_equilibrate(r, &b) : gh_rve_equilibrate(r, &b));
  if (r->relaxes) positions_pull_back(r);
  if (gh_rve_solves(r)) GH_TRY(gh_rve_find_rattlers(r)); /* they serve the sums and the tangent */
  if (r->m.settled) GH_TRY(gh_rve_mark_sliding(r));
  if (gh_rve_friction(r)) GH_TRY(gh_rve_advance_history(r));
  GH_TRY(gh_rve_sums(r));
  if (!(want & GH_WANT_TANGENT)) return GH_OK;
  return gh_rve_friction(r) ? gh_rve_tangent_friction(r, A) : gh_rve_tangent(r, A);
}

gh_status gh_rve_evaluate(gh_rve *r, const double F[4], unsigned want, double P[4], double A[16]) {
  return gh_rve_evaluate_near(r, F, r->kept_size > 0 ? r->kept : NULL, r->kept_size, want, P, A);
}

gh_status gh_rve_evaluate_near(gh_rve *r, const double F[4], const double *near, size_t size, unsigned want,
                               double P[4], double A[16]) {
  double start = gh_seconds();
  r->trial = false;
  if (!gh_finite(F, 4))
    return gh_fail(r->ctx, GH_INPUT, "F = [%g %g; %g %g] is not finite", F[0], F[1], F[2], F[3]);
  if (!(gh_det2(F) > 0) || !isfinite(gh_det2(F)))
    return gh_fail(r->ctx, GH_INPUT,
                   "F = [%g %g; %g %g] has the determinant %g; it must be positive and finite", F[0], F[1],
                   F[2], F[3], gh_det2(F));
  if (near) GH_TRY(gh_state_check(r, near, size));
  r->m = (gh_rve_measures){.acoustic = NAN, .acoustic_angle = NAN};
  memcpy(r->F, F, sizeof r->F);
  memcpy(r->m.F, F, sizeof r->m.F);
  if (gh_rve_ramps(r))
    GH_TRY(gh_rve_find_pressure(r)); /* not counted: once, or again where it was not kept */
  gh_engine_cost before, after;
  gh_engine_costs(r->engine, &before);
  GH_TRY(rve_evaluate(r, near, want, A));
  gh_engine_costs(r->engine, &after);
  r->m.pairs = after.pairs - before.pairs;
  memcpy(P, r->m.P, sizeof r->m.P);
  r->trial = true;
  r->m.seconds = gh_seconds() - start;
  r->cost.total += r->m.seconds;
  return GH_OK;
}

const double *gh_rve_F(const gh_rve *r) {
  return r->Fn;
}

const gh_rve_measures *gh_rve_measure(const gh_rve *r) {
  return &r->m;
}

void gh_rve_costs(const gh_rve *r, gh_rve_cost *cost) {
  *cost = r->cost;
  if (r->solver) {
    cost->factorisations = r->solver->factorisations;
    cost->analyses = r->solver->analyses;
  }
  gh_engine_cost engine;
  gh_engine_costs(r->engine, &engine);
  cost->history += engine.history_seconds;
  cost->pairs = engine.pairs - r->uncounted;
}
