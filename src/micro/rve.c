/* One RVE: converged state, trial state, and the way from F to P and A. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "micro/internal.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* Friction makes relaxation short where there is an equilibrium at all: a few hundred steps. */
enum { DEFAULT_STEPS = 400000, DEFAULT_STEPS_FRICTION = 50000 };

static const char *const boundary_names[] = {"taylor", "taylor-cell", "restricted", "periodic"};

bool gh_boundary_from_name(const char *name, gh_boundary *b) {
  for (int k = 0; k < 4; k++)
    if (!strcmp(name, boundary_names[k])) return *b = (gh_boundary)k, true;
  return false;
}

const char *gh_boundary_name(gh_boundary b) {
  return boundary_names[b];
}

gh_rve_options gh_rve_defaults(void) {
  return (gh_rve_options){.boundary = GH_PERIODIC, .engine = GH_ENGINE_LAMMPS, .tolerance = 1e-8};
}

long gh_rve_step_limit(const gh_rve_options *o) {
  if (o->max_steps > 0) return o->max_steps;
  return o->law.friction ? DEFAULT_STEPS_FRICTION : DEFAULT_STEPS;
}

void gh_rve_destroy(gh_rve **rve) {
  if (!rve || !*rve) return;
  gh_rve *r = *rve;
  gh_engine_destroy(&r->engine);
  gh_stiffness_destroy(&r->stiffness);
  gh_coupled_destroy(&r->coupled);
  gh_rattlers_destroy(&r->rattlers);
  gh_cluster_destroy(&r->cluster);
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
                          r->theta0,
                          r->view_grain,
                          r->view_id,
                          r->view_flags,
                          r->all_held,
                          r->history.slips,
                          r->trial_history.slips,
                          r->kept.y,
                          r->kept.theta,
                          r->kept.slips.slips};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  free(r);
  *rve = NULL;
}

static bool relaxes(const gh_rve_options *o) {
  return o->boundary == GH_RESTRICTED || o->boundary == GH_PERIODIC;
}

bool gh_rve_has_branches(const gh_rve_options *o) {
  return relaxes(o) && o->law.friction;
}

static gh_status check_options(gh_context *ctx, const gh_rve_options *o) {
  if (!(o->tolerance > 0) || !(o->tolerance < 1))
    return gh_fail(ctx, GH_INPUT, "the tolerance must lie between 0 and 1, not %g", o->tolerance);
  if (!(o->accept >= 0) || isinf(o->accept))
    return gh_fail(ctx, GH_INPUT, "the force that is accepted out of balance must be 0 or more, not %g",
                   o->accept);
  if (!(o->allow_overlap >= 0))
    return gh_fail(ctx, GH_INPUT, "the mean overlap that is allowed must be 0 or more, not %g",
                   o->allow_overlap);
  if (o->max_steps < 0)
    return gh_fail(ctx, GH_INPUT, "the number of relaxation steps must not be negative, but is %ld",
                   o->max_steps);
  return GH_OK;
}

static gh_status make_engine(gh_rve *r) {
  const gh_cluster *c = r->cluster;
  r->radius = c ? c->radius : r->packing->radius;
  if (r->options.boundary == GH_RESTRICTED) r->held = c->boundary;
  if (r->turns && !r->relaxes) { /* all positions are prescribed, but rotations are not */
    GH_TRY(gh_alloc(r->ctx, (size_t)r->n, 1, &r->all_held));
    memset(r->all_held, 1, (size_t)r->n);
    r->held = r->all_held;
  }
  gh_engine_setup setup = {.n = r->n,
                           .radius = r->radius,
                           .type = c ? c->type : r->packing->type,
                           .held = r->held,
                           .periodic = r->periodic,
                           .law = r->options.law};
  return gh_engine_create(r->ctx, r->options.engine, &setup, &r->engine);
}

static gh_status make_state(gh_rve *r) {
  size_t n = 2 * (size_t)r->n;
  double **const arrays[] = {&r->X, &r->yn, &r->y, &r->x, &r->step};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    GH_TRY(gh_alloc(r->ctx, n, sizeof(double), arrays[k]));
  GH_TRY(gh_alloc(r->ctx, n, sizeof(int), &r->view_grain));
  GH_TRY(gh_alloc(r->ctx, n, sizeof(int), &r->view_id));
  GH_TRY(gh_alloc(r->ctx, n, 1, &r->view_flags));
  memcpy(r->X, r->cluster ? r->cluster->x : r->packing->x, n * sizeof(double));
  memcpy(r->yn, r->X, n * sizeof(double));
  memcpy(r->y, r->X, n * sizeof(double));
  memcpy(r->Fn, (double[4]){1, 0, 0, 1}, sizeof r->Fn);
  memcpy(r->F, r->Fn, sizeof r->F);
  if (!gh_rve_friction(r)) return GH_OK;
  double **const turns[] = {&r->thetan, &r->theta, &r->turn, &r->theta0, &r->kept.theta},
                 **const places[] = {&r->x0, &r->kept.y};
  for (size_t k = 0; k < sizeof turns / sizeof *turns; k++)
    GH_TRY(gh_alloc(r->ctx, (size_t)r->n, sizeof(double), turns[k]));
  for (size_t k = 0; k < sizeof places / sizeof *places; k++)
    GH_TRY(gh_alloc(r->ctx, n, sizeof(double), places[k]));
  return GH_OK;
}

static gh_status make_solver(gh_rve *r) {
  if (!gh_rve_solves(r)) return GH_OK;
  GH_TRY(gh_rattlers_create(r->ctx, r->n, &r->rattlers));
  if (gh_rve_friction(r)) return gh_coupled_create(r->ctx, r->n, &r->coupled);
  return gh_stiffness_create(r->ctx, r->n, &r->stiffness);
}

gh_status gh_rve_create(gh_context *ctx, const gh_packing *packing, const gh_rve_options *options,
                        gh_rve **rve) {
  *rve = NULL;
  GH_TRY(check_options(ctx, options));
  gh_rve *r;
  GH_TRY(gh_alloc(ctx, 1, sizeof *r, &r));
  gh_status status;
  r->ctx = ctx;
  r->options = *options;
  r->options.max_steps = gh_rve_step_limit(options);
  gh_boundary b = options->boundary;
  r->relaxes = relaxes(options);
  r->turns = options->law.friction && !options->law.fixed_rotations;
  r->periodic = b == GH_TAYLOR_CELL || b == GH_PERIODIC;
  GH_TRY_OR(gh_packing_copy(ctx, packing, &r->packing), failed);
  if (!r->periodic) GH_TRY_OR(gh_cluster_create(ctx, packing, &r->cluster), failed);
  r->n = r->cluster ? r->cluster->n : packing->n;
  r->volume = gh_det2(packing->cell);
  r->mean_radius = gh_packing_mean_radius(packing);
  GH_TRY_OR(make_engine(r), failed);
  GH_TRY_OR(make_state(r), failed);
  GH_TRY_OR(make_solver(r), failed);
  *rve = r;
  return GH_OK;
failed:
  gh_rve_destroy(&r);
  return status;
}

/* y = F^-1 x: positions before the deformation, fluctuations included. */
static void pull_back(gh_rve *r) {
  double inverse[4];
  gh_inv2(r->F, inverse);
  for (int i = 0; i < r->n; i++) gh_apply2(inverse, &r->x[2 * i], &r->y[2 * i]);
}

gh_status gh_rve_find_rattlers(gh_rve *r) {
  if (!gh_rve_friction(r))
    return gh_rattlers_find(r->ctx, r->rattlers, r->n, r->held, r->list.contacts, r->list.count,
                            r->m.mean_force, &r->m.rattlers);
  r->m.rattlers = gh_rattlers_loose(r->rattlers, r->n, r->held, &r->list);
  return GH_OK;
}

/* A state is F and positions y; with friction more: rotations, numbers, slips. A trial state whose slip was
 * kept on the way says so among the numbers, and behind it stands the state that its slip counts from. */
enum { DISSIPATED, KEPT, SLIPS, NUMBERS };

static size_t state_size(const gh_rve *r, int nslips) {
  const size_t n = (size_t)r->n, basic = 4 + 2 * n;
  return gh_rve_friction(r) ? basic + n + NUMBERS + GH_SLIP_NUMBERS * (size_t)nslips : basic;
}

/* The parts of a state, in its place; without friction there are no more than two. */
typedef struct parts {
  const double *F, *y, *theta, *numbers, *slips;
  int nslips;
  const double *end;
} parts;

static parts divide(const gh_rve *r, const double *state) {
  const size_t n = (size_t)r->n;
  parts p = {.F = state, .y = state + 4, .end = state + 4 + 2 * n};
  if (!gh_rve_friction(r)) return p;
  p.theta = p.end, p.numbers = p.theta + n, p.slips = p.numbers + NUMBERS;
  p.nslips = (int)p.numbers[SLIPS];
  p.end = p.slips + GH_SLIP_NUMBERS * (size_t)p.nslips;
  return p;
}

/* Whether another state stands behind it. */
static bool keeps(const parts *p) {
  return p->numbers && p->numbers[KEPT] > 0;
}

/* One state of at most `size` numbers, and how many it has by what it says itself: more, if it is cut off. */
static gh_status check_parts(const gh_rve *r, const double *state, size_t size, size_t *used) {
  *used = state_size(r, 0);
  if (size < *used) return GH_OK;
  if (!gh_finite(state, size) || !(gh_det2(state) > 0))
    return gh_fail(r->ctx, GH_INPUT,
                   "the state to load has a value that is not finite, or F with det F <= 0");
  if (!gh_rve_friction(r)) return GH_OK;
  const double slips = state[*used - NUMBERS + SLIPS];
  if (!(slips >= 0) || slips > INT_MAX || slips != nearbyint(slips))
    return gh_fail(r->ctx, GH_INPUT, "the state to load says that %g contacts have a history", slips);
  *used = state_size(r, (int)slips);
  return GH_OK;
}

static gh_status check_state(const gh_rve *r, const double *state, size_t size) {
  size_t used, more = 0;
  GH_TRY(check_parts(r, state, size, &used));
  const parts p = used < size ? divide(r, state) : (parts){0};
  if (keeps(&p)) GH_TRY(check_parts(r, state + used, size - used, &more));
  if (used + more == size) return GH_OK;
  return gh_fail(r->ctx, GH_INPUT,
                 "the state to load has %zu numbers, which does not fit this packing and its contact law",
                 size);
}

/* The state from which the search for equilibrium begins. Where it is one whose slip was kept, r->kept is
 * what its slip counts from. */
typedef struct beginning {
  const double *F, *y, *theta;
} beginning;

/* Trial states are no farther than this from where they help, as a share of their own way. */
static const double nearby = 0.1;

static double apart(const double F[4], const double G[4]) {
  return hypot(hypot(F[0] - G[0], F[1] - G[1]), hypot(F[2] - G[2], F[3] - G[3]));
}

static gh_status take_kept(gh_rve *r, const double *state) {
  const parts p = divide(r, state);
  const size_t n = (size_t)r->n;
  gh_kept *k = &r->kept;
  memcpy(k->F, p.F, sizeof k->F);
  memcpy(k->y, p.y, 2 * n * sizeof(double));
  memcpy(k->theta, p.theta, n * sizeof(double));
  k->dissipated = p.numbers[DISSIPATED];
  r->m.kept = 1;
  GH_TRY(gh_slips_load(r->ctx, p.slips, p.nslips, &k->slips));
  return gh_rve_go_on(r);
}

/* From the converged state, or from the trial state that is near. */
static gh_status begin(gh_rve *r, const double *near, beginning *b) {
  *b = (beginning){.F = r->Fn, .y = r->yn, .theta = r->thetan};
  if (!near || !r->relaxes || apart(r->F, near) > nearby * apart(near, r->Fn))
    return gh_rve_begin_increment(r);
  const parts p = divide(r, near);
  *b = (beginning){.F = p.F, .y = p.y, .theta = p.theta};
  return keeps(&p) ? take_kept(r, p.end) : gh_rve_begin_increment(r);
}

/* Grains are guessed to turn with the body: by the rotation of F from where it begins. Where they slide,
 * there are many equilibria, and a guess that stays behind would end in one that a rigid rotation does not
 * have. */
static void guess_rotations(gh_rve *r, const beginning *b) {
  double f[4], inverse[4];
  gh_inv2(b->F, inverse);
  gh_mul2(r->F, inverse, f);
  double turn = r->turns ? atan2(f[2] - f[1], f[0] + f[3]) : 0;
  for (int i = 0; i < r->n; i++) r->theta[i] = b->theta[i] + turn;
}

static gh_status evaluate(gh_rve *r, const double *near, unsigned want, double A[16]) {
  beginning b;
  GH_TRY(begin(r, near, &b));
  for (int i = 0; i < r->n; i++)
    gh_apply2(r->F, &b.y[2 * i], &r->x[2 * i]); /* the affine guess keeps the fluctuations */
  if (r->theta) guess_rotations(r, &b);
  GH_TRY(gh_rve_equilibrate(r));
  if (r->relaxes) pull_back(r);
  if (gh_rve_solves(r)) GH_TRY(gh_rve_find_rattlers(r)); /* they serve the sums and the tangent */
  if (gh_rve_friction(r)) GH_TRY(gh_rve_advance_history(r));
  GH_TRY(gh_rve_sums(r));
  if (!(want & GH_WANT_TANGENT)) return GH_OK;
  return gh_rve_friction(r) ? gh_rve_tangent_friction(r, A) : gh_rve_tangent(r, A);
}

gh_status gh_rve_evaluate(gh_rve *r, const double F[4], unsigned want, double P[4], double A[16]) {
  return gh_rve_evaluate_near(r, F, NULL, 0, want, P, A);
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
  if (near) GH_TRY(check_state(r, near, size));
  r->m = (gh_rve_measures){.acoustic = NAN, .acoustic_angle = NAN};
  memcpy(r->F, F, sizeof r->F);
  memcpy(r->m.F, F, sizeof r->m.F);
  gh_engine_cost before, after;
  gh_engine_costs(r->engine, &before);
  GH_TRY(evaluate(r, near, want, A));
  gh_engine_costs(r->engine, &after);
  r->m.pairs = after.pairs - before.pairs;
  memcpy(P, r->m.P, sizeof r->m.P);
  r->trial = true;
  r->m.seconds = gh_seconds() - start;
  r->cost.total += r->m.seconds;
  return GH_OK;
}

gh_status gh_rve_commit(gh_rve *r) {
  if (!r->trial) return GH_OK;
  memcpy(r->Fn, r->F, sizeof r->Fn);
  memcpy(r->yn, r->y, 2 * (size_t)r->n * sizeof(double));
  r->trial = false;
  if (!gh_rve_friction(r)) return GH_OK;
  memcpy(r->thetan, r->theta, (size_t)r->n * sizeof(double));
  gh_slips swap = r->history;
  r->history = r->trial_history;
  r->trial_history = swap;
  r->dissipatedn = r->dissipated;
  r->begun = false;
  return GH_OK;
}

gh_status gh_rve_revert(gh_rve *r) {
  r->trial = false;
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
  if (r->stiffness) {
    cost->factorisations = r->stiffness->factorisations;
    cost->analyses = r->stiffness->analyses;
  }
  if (r->coupled) {
    cost->factorisations = r->coupled->factorisations;
    cost->analyses = r->coupled->analyses;
  }
  gh_engine_cost engine;
  gh_engine_costs(r->engine, &engine);
  cost->history += engine.history_seconds;
  cost->pairs = engine.pairs;
}

/* Writes a state; returns its end. */
static double *put(const gh_rve *r, const beginning *b, double dissipated, bool kept, const gh_slips *h,
                   double *to) {
  const size_t n = (size_t)r->n;
  memcpy(to, b->F, 4 * sizeof *to);
  memcpy(to + 4, b->y, 2 * n * sizeof *to);
  to += 4 + 2 * n;
  if (!gh_rve_friction(r)) return to;
  memcpy(to, b->theta, n * sizeof *to);
  to += n;
  to[DISSIPATED] = dissipated;
  to[KEPT] = kept;
  to[SLIPS] = h->count;
  gh_slips_save(h, to + NUMBERS);
  return to + NUMBERS + GH_SLIP_NUMBERS * (size_t)h->count;
}

gh_status gh_rve_save(const gh_rve *r, double *state) {
  const beginning b = {.F = r->Fn, .y = r->yn, .theta = r->thetan};
  put(r, &b, r->dissipatedn, false, &r->history, state);
  return GH_OK;
}

gh_status gh_rve_save_trial(const gh_rve *r, double *state) {
  if (!r->trial) return gh_rve_save(r, state);
  const gh_kept *k = &r->kept;
  const beginning b = {.F = r->F, .y = r->y, .theta = r->theta},
                  base = {.F = k->F, .y = k->y, .theta = k->theta};
  double *end = put(r, &b, r->dissipated, r->m.kept > 0, &r->trial_history, state);
  if (r->m.kept) put(r, &base, k->dissipated, false, &k->slips, end);
  return GH_OK;
}

size_t gh_rve_state_size(const gh_rve *r) {
  return state_size(r, r->history.count);
}

size_t gh_rve_trial_size(const gh_rve *r) {
  if (!r->trial) return gh_rve_state_size(r);
  return state_size(r, r->trial_history.count) + (r->m.kept ? state_size(r, r->kept.slips.count) : 0);
}

gh_status gh_rve_load(gh_rve *r, const double *state, size_t size) {
  const size_t n = (size_t)r->n;
  GH_TRY(check_state(r, state, size));
  const parts p = divide(r, state);
  memcpy(r->Fn, p.F, sizeof r->Fn);
  memcpy(r->yn, p.y, 2 * n * sizeof(double));
  memcpy(r->y, p.y, 2 * n * sizeof(double)); /* where all grains follow F, no evaluation sets it */
  r->trial = r->begun = false;
  if (!gh_rve_friction(r)) return GH_OK;
  memcpy(r->thetan, p.theta, n * sizeof(double));
  r->dissipatedn = p.numbers[DISSIPATED];
  return gh_slips_load(r->ctx, p.slips, p.nslips, &r->history);
}
