/* SPDX-License-Identifier: GPL-2.0-or-later */
/* States of an RVE as flat buffers of numbers: what is saved, loaded, committed, and where an evaluation
 * starts. */
#include "micro/internal.h"

#include <limits.h>
#include <string.h>

/* A state is F and positions y; with friction more: rotations, numbers, slips. A trial state whose slip
 * counts from the end of a ramp is marked among the numbers, and that end follows it. */
enum { DISSIPATED, PRESSURE, BASED, SLIPS, NUMBERS };

static size_t state_size(const gh_rve *r, int nslips) {
  const size_t n = (size_t)r->n, basic = 4 + 2 * n;
  return gh_rve_friction(r) ? basic + n + NUMBERS + GH_SLIP_NUMBERS * (size_t)nslips : basic;
}

/* The parts of a state, in its place; without friction there are no more than two. */
typedef struct state_parts {
  const double *F, *y, *theta, *numbers, *slips;
  int nslips;
  const double *end;
} state_parts;

static state_parts state_split(const gh_rve *r, const double *state) {
  const size_t n = (size_t)r->n;
  state_parts p = {.F = state, .y = state + 4, .end = state + 4 + 2 * n};
  if (!gh_rve_friction(r)) return p;
  p.theta = p.end, p.numbers = p.theta + n, p.slips = p.numbers + NUMBERS;
  p.nslips = (int)p.numbers[SLIPS];
  p.end = p.slips + GH_SLIP_NUMBERS * (size_t)p.nslips;
  return p;
}

/* Whether another state stands behind it. */
static bool state_has_base(const state_parts *p) {
  return p->numbers && p->numbers[BASED] > 0;
}

/* One state of at most `size` numbers, and how many it has by its own count: more, if it is cut off. */
static gh_status state_check_parts(const gh_rve *r, const double *state, size_t size, size_t *used) {
  *used = state_size(r, 0);
  if (size < *used) return GH_OK;
  if (!gh_finite(state, size) || !(gh_det2(state) > 0))
    return gh_fail(r->ctx, GH_INPUT,
                   "the state to load has a value that is not finite, or F with det F <= 0");
  if (!gh_rve_friction(r)) return GH_OK;
  const double slips = state[*used - NUMBERS + SLIPS];
  if (!(slips >= 0) || slips > INT_MAX || slips != nearbyint(slips))
    return gh_fail(r->ctx, GH_INPUT, "the state to load states that %g contacts have a history", slips);
  *used = state_size(r, (int)slips);
  return GH_OK;
}

gh_status gh_state_check(const gh_rve *r, const double *state, size_t size) {
  size_t used, more = 0;
  GH_TRY(state_check_parts(r, state, size, &used));
  const state_parts p = used < size ? state_split(r, state) : (state_parts){0};
  if (state_has_base(&p)) GH_TRY(state_check_parts(r, state + used, size - used, &more));
  if (used + more == size) return GH_OK;
  return gh_fail(r->ctx, GH_INPUT,
                 "the state to load has %zu numbers, which does not fit this packing and its contact law",
                 size);
}

/* Trial states are no farther than this from where they help, as a share of their own distance. */
static const double nearby = 0.3;

static double gradient_distance(const double F[4], const double G[4]) {
  return hypot(hypot(F[0] - G[0], F[1] - G[1]), hypot(F[2] - G[2], F[3] - G[3]));
}

static gh_status state_resume_base(gh_rve *r, const double *state) {
  const state_parts p = state_split(r, state);
  const size_t n = (size_t)r->n;
  gh_base *k = &r->base;
  memcpy(k->F, p.F, sizeof k->F);
  memcpy(k->y, p.y, 2 * n * sizeof(double));
  memcpy(k->theta, p.theta, n * sizeof(double));
  k->dissipated = p.numbers[DISSIPATED];
  GH_TRY(gh_slips_load(r->ctx, p.slips, p.nslips, &k->slips));
  return gh_rve_resume_base(r);
}

/* From the converged state, or from the trial state that is near. */
gh_status gh_state_start(gh_rve *r, const double *near, gh_start *b) {
  *b = (gh_start){.F = r->Fn, .y = r->yn, .theta = r->thetan};
  r->based = false;
  if (!near || !r->relaxes || gradient_distance(r->F, near) > nearby * gradient_distance(near, r->Fn))
    return gh_rve_begin_increment(r);
  const state_parts p = state_split(r, near);
  *b = (gh_start){.F = p.F, .y = p.y, .theta = p.theta, .near = true};
  return state_has_base(&p) ? state_resume_base(r, p.end) : gh_rve_begin_increment(r);
}

gh_status gh_rve_keep(gh_rve *r) {
  const size_t size = gh_rve_trial_size(r);
  if (!r->trial || !gh_rve_has_branches(&r->options)) return GH_OK;
  GH_TRY(gh_grow(r->ctx, size, sizeof *r->kept, &r->kept_capacity, &r->kept));
  r->kept_size = size;
  return gh_rve_save_trial(r, r->kept);
}

gh_status gh_rve_commit(gh_rve *r) {
  r->kept_size = 0;
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
  r->pressuren = gh_max(0, -(r->m.cauchy[0] + r->m.cauchy[3]) / 2);
  r->begun = false;
  return GH_OK;
}

gh_status gh_rve_revert(gh_rve *r) {
  r->kept_size = 0;
  r->trial = false;
  return GH_OK;
}

/* Writes a state; returns its end. */
static double *state_put(const gh_rve *r, const gh_start *b, double dissipated, bool based, const gh_slips *h,
                         double *to) {
  const size_t n = (size_t)r->n;
  memcpy(to, b->F, 4 * sizeof *to);
  memcpy(to + 4, b->y, 2 * n * sizeof *to);
  to += 4 + 2 * n;
  if (!gh_rve_friction(r)) return to;
  memcpy(to, b->theta, n * sizeof *to);
  to += n;
  to[DISSIPATED] = dissipated;
  to[PRESSURE] = r->pressuren;
  to[BASED] = based;
  to[SLIPS] = h->count;
  gh_slips_save(h, to + NUMBERS);
  return to + NUMBERS + GH_SLIP_NUMBERS * (size_t)h->count;
}

gh_status gh_rve_save(const gh_rve *r, double *state) {
  const gh_start b = {.F = r->Fn, .y = r->yn, .theta = r->thetan};
  state_put(r, &b, r->dissipatedn, false, &r->history, state);
  return GH_OK;
}

gh_status gh_rve_save_trial(const gh_rve *r, double *state) {
  if (!r->trial) return gh_rve_save(r, state);
  const gh_base *k = &r->base;
  const gh_start b = {.F = r->F, .y = r->y, .theta = r->theta},
                 base = {.F = k->F, .y = k->y, .theta = k->theta};
  double *end = state_put(r, &b, r->dissipated, r->based, &r->trial_history, state);
  if (r->based) state_put(r, &base, k->dissipated, false, &k->slips, end);
  return GH_OK;
}

size_t gh_rve_state_size(const gh_rve *r) {
  return state_size(r, r->history.count);
}

size_t gh_rve_trial_size(const gh_rve *r) {
  if (!r->trial) return gh_rve_state_size(r);
  return state_size(r, r->trial_history.count) + (r->based ? state_size(r, r->base.slips.count) : 0);
}

gh_status gh_rve_load(gh_rve *r, const double *state, size_t size) {
  const size_t n = (size_t)r->n;
  GH_TRY(gh_state_check(r, state, size));
  const state_parts p = state_split(r, state);
  memcpy(r->Fn, p.F, sizeof r->Fn);
  memcpy(r->yn, p.y, 2 * n * sizeof(double));
  memcpy(r->y, p.y, 2 * n * sizeof(double)); /* where all grains follow F, no evaluation sets it */
  r->trial = r->begun = false;
  r->kept_size = 0;
  if (!gh_rve_friction(r)) return GH_OK;
  memcpy(r->thetan, p.theta, n * sizeof(double));
  r->dissipatedn = p.numbers[DISSIPATED];
  r->pressuren = p.numbers[PRESSURE];
  return gh_slips_load(r->ctx, p.slips, p.nslips, &r->history);
}
