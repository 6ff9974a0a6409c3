/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Slip integrated along ramps (method 3, "Ramps").
 *
 * Slip that counts from the converged state over a whole increment loses its equilibrium within the increment.
 * Slip that is committed at every step of a ramp only dissipates, so that a packing always comes to rest, but
 * its end depends on the ramp, and has no tangent. So a ramp leads to the start of a short last part, is frozen
 * there, and slip counts over the last part alone: a function of F with an algorithmic tangent. Where the last
 * part has no equilibrium either, a second ramp leads to its end. */
#include "micro/internal.h"

#include "contact/coulomb.h"

#include <string.h>

static const char *const integrations[] = {[GH_INTEGRATION_RAMP] = "ramp", [GH_INTEGRATION_WHOLE] = "whole"};

bool gh_integration_from_name(const char *name, gh_integration *integration) {
  for (int k = 0; k < 2; k++) {
    if (!strcmp(name, integrations[k])) {
      *integration = (gh_integration)k;
      return true;
    }
  }
  return false;
}

const char *gh_integration_name(gh_integration integration) {
  return integrations[integration];
}

/* Lengths are strains over p_n/E_n, the overlap strain of the converged state. Measured in
 * docs/reports/friction.md, "Ramps". */
static const struct ramp_rule {
  double last;      /* length of the last part */
  double steps;     /* relaxation steps of a ramp of length 1 */
  long least, most; /* steps of a ramp */
  double strain;    /* of a step at most */
  double rest;      /* residual at the end of a ramp ... */
  double closer;    /* ... times this for each ramp to F that has not helped yet */
  long patience;    /* of the last part: steps without half the residual */
  double limit;     /* nearer than this share of the normal force to the Coulomb limit a contact slides */
} rule = {.last = 0.25,
          .steps = 800,
          .least = 32,
          .most = 20000,
          .strain = 1e-4,
          .rest = 1e-3,
          .closer = 1e-2,
          .patience = 1000,
          .limit = 1e-6};

bool gh_rve_ramps(const gh_rve *r) {
  return gh_rve_friction(r) && r->relaxes && r->options.integration == GH_INTEGRATION_RAMP;
}

long gh_rve_patience(const gh_rve *r) {
  return gh_rve_ramps(r) && !r->servo ? rule.patience
                                      : 0; /* servo-control moves the frame off the ramp's end */
}

/* The engine stands at the start then. */
static gh_status start_set(gh_rve *r, const gh_start *b) {
  double cell[4];
  gh_mul2(b->F, r->lattice, cell);
  for (int i = 0; i < r->n; i++) gh_apply2(b->F, &b->y[2 * i], &r->x[2 * i]);
  gh_rve_find_round_off(r, cell);
  return gh_engine_set(r->engine, cell, r->x, b->theta);
}

gh_status gh_rve_find_pressure(gh_rve *r) {
  const gh_start n = {.F = r->Fn, .y = r->yn, .theta = r->thetan};
  gh_engine_cost before, after;
  double sum = 0;
  if (r->pressuren >= 0) return GH_OK;
  gh_engine_costs(r->engine, &before);
  GH_TRY(gh_rve_begin_increment(r));
  GH_TRY(start_set(r, &n));
  GH_TRY(gh_engine_contacts(r->engine, &r->list));
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = &r->list.contacts[c];
    sum += q->overlap * hypot(q->l[0], q->l[1]) *
           (gh_frame_is_open(r->frame) ? gh_frame_share_of(r->frame, q) : 1);
  }
  r->pressuren = r->options.law.normal_stiffness * sum / (2 * r->volume * gh_det2(r->Fn));
  gh_engine_costs(r->engine, &after);
  r->uncounted += after.pairs - before.pairs;
  return GH_OK;
}

static long ramp_steps(const gh_rve *r, double length) {
  const double steps = ceil(rule.steps * length * r->options.law.normal_stiffness / r->pressuren);
  if (!(length > 0)) return rule.least;
  return steps < (double)rule.least ? rule.least : steps < (double)rule.most ? (long)steps : rule.most;
}

/* The end of a ramp becomes r->base. */
static gh_status base_take(gh_rve *r, const gh_start *from, const double to[4],
                           const gh_ramp_result *result) {
  gh_base *k = &r->base;
  double inverse[4];
  k->dissipated = (r->based ? k->dissipated : r->dissipatedn) + result->dissipated;
  GH_TRY(gh_grow(r->ctx, (size_t)result->nslips + 1, sizeof(gh_slip), &k->slips.capacity, &k->slips.slips));
  if (result->nslips) memcpy(k->slips.slips, result->slips, (size_t)result->nslips * sizeof(gh_slip));
  k->slips.count = result->nslips;
  GH_TRY(gh_engine_get(r->engine, r->x, r->theta));
  gh_inv2(to, inverse);
  for (int i = 0; i < r->n; i++) {
    if (r->held && r->held[i]) memcpy(&r->y[2 * i], &from->y[2 * i], 2 * sizeof(double));
    else gh_apply2(inverse, &r->x[2 * i], &r->y[2 * i]);
    if (gh_frame_turns_with_F(r->frame, i)) r->theta[i] = from->theta[i] + gh_rotation_between(from->F, to);
  }
  memcpy(k->y, r->y, 2 * (size_t)r->n * sizeof(double));
  memcpy(k->theta, r->theta, (size_t)r->n * sizeof(double));
  memcpy(k->F, to, sizeof k->F);
  return GH_OK;
}

/* From where slip counts from to `to`, which becomes what it counts from. *left: relaxation steps that may be
 * spent behind the ramp. */
static gh_status ramp_follow(gh_rve *r, const gh_start *from, const double to[4], long steps,
                             double tolerance, long *left) {
  const double start = gh_seconds();
  double inverse[4];
  gh_ramp ramp = {.steps = steps,
                  .tolerance = tolerance,
                  .max_steps = steps + *left,
                  .floor = r->floor,
                  .round_off = gh_rve_round_off(r)};
  gh_ramp_result result;
  gh_inv2(from->F, inverse);
  gh_mul2(to, inverse, ramp.to);
  if (steps == 0) memcpy(ramp.to, (double[4]){1, 0, 0, 1}, sizeof ramp.to);
  GH_TRY(gh_engine_ramp(r->engine, &ramp, &result));
  *left -= result.relaxed.steps > steps ? result.relaxed.steps - steps : 0;
  r->m.ramps++;
  r->m.steps += result.relaxed.steps;
  r->cost.steps += result.relaxed.steps;
  r->cost.relax += gh_seconds() - start;
  GH_TRY(base_take(r, from, to, &result));
  return gh_rve_resume_base(r);
}

gh_status gh_rve_ramp_to_base(gh_rve *r, gh_start *b) {
  const double length = gh_strain2(r->Fn, r->F), rest = fmax(rule.rest, r->options.tolerance);
  long left = r->options.max_steps;
  double to[4];
  if (!(length > 0)) return GH_OK;
  const double last = rule.last * r->pressuren / r->options.law.normal_stiffness, share = 1 - last / length;
  if (!(share > 0)) return GH_OK;
  if (!(share * length <= rule.strain * (double)rule.most))
    return gh_fail(
        r->ctx, GH_DIVERGED,
        "the increment to F = [%.6g %.6g; %.6g %.6g] is a strain of %.3g, too long for a ramp: at most "
        "%g is possible",
        r->F[0], r->F[1], r->F[2], r->F[3], length, rule.strain * (double)rule.most);
  for (int k = 0; k < 4; k++) to[k] = r->Fn[k] + share * (r->F[k] - r->Fn[k]);
  GH_TRY(start_set(r, b));
  GH_TRY(ramp_follow(r, b, to, ramp_steps(r, share * length), rest, &left));
  *b = (gh_start){.F = r->base.F, .y = r->base.y, .theta = r->base.theta};
  return GH_OK;
}

gh_status gh_rve_mark_sliding(gh_rve *r) {
  const gh_contact_law *law = &r->options.law;
  const size_t count = (size_t)r->list.count;
  GH_TRY(gh_grow(r->ctx, count + 1, sizeof(gh_friction), &r->sliding_capacity, &r->sliding));
  if (count) memcpy(r->sliding, r->list.friction, count * sizeof(gh_friction));
  r->list.friction = r->sliding;
  for (size_t c = 0; c < count; c++) {
    const gh_contact *q = &r->list.contacts[c];
    gh_friction *f = &r->sliding[c];
    const double fn = law->normal_stiffness * q->overlap, d = hypot(q->l[0], q->l[1]),
                 limit = gh_coulomb_limit(law, fn, f->slip.alpha);
    if (f->slides || !(fabs(f->force) >= limit - rule.limit * fn)) continue;
    const gh_coulomb_step s = {.l = {q->l[0], q->l[1]},
                               .d = d,
                               .reach = q->overlap + d,
                               .ln = {q->l[0], q->l[1]},
                               .gamma = f->slip.gamma,
                               .gamma_pl = f->slip.gamma_pl,
                               .alpha = f->slip.alpha};
    const gh_coulomb_result now = {
        .force = f->force, .alpha = f->slip.alpha, .c = 1, .slides = f->force > 0 ? 1 : -1};
    gh_coulomb_derivative(law, &s, &now, f->d);
    for (int k = 0; k < 9 && gh_frame_is_open(r->frame); k++) f->d[k] *= gh_frame_share_of(r->frame, q);
    f->slides = 1;
  }
  return GH_OK;
}

gh_status gh_rve_ramp_to_rest(gh_rve *r, long *left) {
  const gh_start base = {.F = r->base.F, .y = r->base.y, .theta = r->base.theta};
  const gh_start from = r->based ? base : (gh_start){.F = r->Fn, .y = r->yn, .theta = r->thetan};
  const double length = gh_strain2(from.F, r->F), aim = rule.rest * pow(rule.closer, r->m.settled);
  GH_TRY(start_set(r, &from));
  GH_TRY(ramp_follow(r, &from, r->F, length > 0 ? ramp_steps(r, length) : 0,
                     fmax(aim, 0.1 * r->options.tolerance), left));
  r->m.settled++;
  GH_TRY(start_set(r, &base));
  return gh_rve_update_contacts(r);
}
