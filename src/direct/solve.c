/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Equilibrium under the loads of an increment.
 *
 * With friction and `ramp`, supports and loads go in stages so short that slip within one hardly matters, and
 * slip is committed in every relaxation step. Else slip counts over the whole substep. */
#include "direct/internal.h"

#include "contact/slips.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* Chosen as the RVE's are (docs/explanation/method.md, "Ramps"). */
static const struct stage_rule {
  double length; /* strain of a stage over the overlap strain p/E_n */
  double loose;  /* strain of a stage without pressure */
  double
      rest; /* residual at the end of a stage, but the last; below it the same grains bear the pressure ... */
  double again; /* ... until it is above this */
  int most;     /* stages of a substep */
} rule = {.length = 0.25, .loose = 1e-3, .rest = 1e-2, .again = 0.03, .most = 64};
enum { PORTION = 5000, LOOK = 300 }; /* relaxation steps between two requests to stop; between two looks */

static bool solve_ramps(const gh_direct *d) {
  return direct_friction(d) && d->options.integration == GH_INTEGRATION_RAMP;
}

static gh_status solve_stop(const gh_direct *d) {
  return d->options.stop && d->options.stop(d->options.stop_data) ? GH_STOPPED : GH_OK;
}

static gh_status engine_make(gh_direct *d, const unsigned char *mask) {
  const size_t n = (size_t)d->n;
  if (d->engine && memcmp(d->mask, mask, n) == 0) return GH_OK;
  gh_engine_destroy(&d->engine);
  d->list = (gh_contact_list){0};
  memcpy(d->mask, mask, n);
  for (size_t i = 0; i < n; i++) d->held[i] = mask[i] == (GH_FIXED_X | GH_FIXED_Y);
  const gh_engine_setup setup = {.n = d->n,
                                 .radius = d->body->radius,
                                 .type = d->body->type,
                                 .held = d->held,
                                 .fixed = d->mask,
                                 .law = d->options.law};
  return gh_engine_create(d->ctx, d->options.engine, &setup, &d->engine);
}

static double round_off(const gh_direct *d) {
  const gh_contact_law *law = &d->options.law;
  const double stiffest =
      direct_friction(d) ? fmax(law->normal_stiffness, law->tangential_stiffness) : law->normal_stiffness;
  return 16 * DBL_EPSILON * stiffest * d->extent;
}

/* ---- a stage ---- */

typedef struct attempt {
  const direct_plan *plan;
  double t;     /* of the plan, at the end of the stage */
  long left;    /* relaxation steps */
  bool exposed; /* pressures push the grains that are exposed ... */
  bool settled; /* ... and these stay the same now */
  gh_direct_report *report;
} attempt;

static gh_status slips_copy(gh_context *ctx, const gh_slip *from, int count, direct_slips *to) {
  GH_TRY(gh_grow(ctx, (size_t)count + 1, sizeof *to->slips, &to->capacity, &to->slips));
  if (count) memcpy(to->slips, from, (size_t)count * sizeof *from);
  to->count = count;
  return GH_OK;
}

/* Relaxation steps towards the residual `asked`. */
static gh_status stage_steps(gh_direct *d, attempt *a, double asked, gh_relax_result *r) {
  const long portion = a->settled ? PORTION : LOOK, most = a->left < portion ? a->left : portion;
  if (!solve_ramps(d)) {
    const gh_relax_options o = {
        .tolerance = asked, .max_steps = most, .floor = -1, .method = d->options.relaxation};
    GH_TRY(gh_engine_relax(d->engine, &o, r));
  } else {
    const gh_ramp o = {.to = {1, 0, 0, 1},
                       .tolerance = asked,
                       .max_steps = most < 1 ? 1 : most,
                       .floor = -1,
                       .round_off = round_off(d)};
    gh_ramp_result result;
    GH_TRY(gh_engine_ramp(d->engine, &o, &result));
    *r = result.relaxed;
    d->trial.dissipated += result.dissipated;
    GH_TRY(slips_copy(d->ctx, result.slips, result.nslips, &d->trial.slips));
  }
  a->left -= r->steps;
  a->report->steps += r->steps;
  return gh_engine_get(d->engine, d->trial.x, d->trial.theta);
}

/* Forces of the stage at the trial positions, which the engine has. */
static gh_status stage_load(gh_direct *d, attempt *a) {
  GH_TRY(direct_plan_forces(d, a->plan, a->t, d->trial.x, d->load, &a->exposed));
  return gh_engine_load(d->engine, d->load, NULL);
}

static gh_status stage_fail(gh_direct *d, const attempt *a, double residual, double tolerance) {
  int worst = 0;
  double largest = -1;
  for (int i = 0; i < d->n; i++) {
    double f[2] = {d->list.force[2 * i] + d->load[2 * i], d->list.force[2 * i + 1] + d->load[2 * i + 1]};
    if (d->mask[i] & GH_FIXED_X) f[0] = 0;
    if (d->mask[i] & GH_FIXED_Y) f[1] = 0;
    if (hypot(f[0], f[1]) > largest) largest = hypot(f[0], f[1]), worst = i;
  }
  return gh_fail(
      d->ctx, GH_DIVERGED,
      "no equilibrium within %ld relaxation steps: residual %.3g, required %.3g; the largest unbalanced "
      "force is that on grain %d at (%.6g, %.6g)",
      a->report->steps, residual, tolerance, worst + 1, d->trial.x[2 * worst], d->trial.x[2 * worst + 1]);
}

/* Grains that have come between those that bear a pressure bear it, too, else they would be pressed out: which do is
 * looked at until the packing is nearly at rest, and again where it leaves that or takes long: a grain may have
 * come loose under its load. */
static gh_status stage_look(gh_direct *d, attempt *a, bool converged) {
  const double residual = a->report->residual;
  if (a->settled && !(a->exposed && (residual > rule.again || !converged))) return GH_OK;
  a->settled = residual <= rule.rest;
  return stage_load(d, a);
}

static gh_status stage_relax(gh_direct *d, attempt *a, double tolerance) {
  double asked = tolerance;
  GH_TRY(stage_load(d, a));
  a->settled = !a->exposed;
  for (;;) {
    gh_relax_result r;
    double mean;
    GH_TRY(solve_stop(d));
    GH_TRY(stage_steps(d, a, a->settled ? asked : fmax(rule.rest, asked), &r));
    GH_TRY(gh_engine_contacts(d->engine, &d->list));
    a->report->residual = direct_residual(d, d->mask, &mean);
    if (!isfinite(a->report->residual))
      return gh_fail(d->ctx, GH_DIVERGED,
                     "no contact holds the grains against their loads, or a force is not finite");
    const double target = fmax(tolerance, mean > 0 ? round_off(d) / mean : 0);
    if (gh_within(a->report->residual, target)) return GH_OK;
    if (a->left <= 0 || r.steps < 1) return stage_fail(d, a, a->report->residual, tolerance);
    if (a->settled && r.converged) asked *= 0.5 * fmin(1, tolerance / a->report->residual);
    GH_TRY(stage_look(d, a, r.converged));
  }
}

/* ---- a substep ---- */

static int stage_count(const gh_direct *d, double strain) {
  const double overlap = d->pressure / d->options.law.normal_stiffness,
               each = overlap > 0 ? rule.length * overlap : rule.loose, count = ceil(strain / each);
  if ((!solve_ramps(d) && d->solved) || !(count > 1)) return 1;
  return count < rule.most ? (int)count : rule.most;
}

static gh_status substep_begin(gh_direct *d) {
  const size_t n = (size_t)d->n;
  direct_state *s = &d->trial;
  const gh_converged c = {
      .x = d->now.x, .theta = d->now.theta, .slips = d->now.slips.slips, .nslips = d->now.slips.count};
  memcpy(s->x, d->now.x, 2 * n * sizeof(double));
  s->dissipated = d->now.dissipated;
  if (!direct_friction(d)) return GH_OK;
  memcpy(s->theta, d->now.theta, n * sizeof(double));
  GH_TRY(slips_copy(d->ctx, d->now.slips.slips, d->now.slips.count, &s->slips));
  return gh_engine_begin(d->engine, &c);
}

/* Slip of a whole substep: the history becomes that of the contacts. */
static gh_status substep_slips(gh_direct *d) {
  direct_slips *to = &d->trial.slips;
  if (!direct_friction(d) || solve_ramps(d)) return GH_OK;
  const int old = d->now.slips.count;
  GH_TRY(gh_grow(d->ctx, (size_t)(d->list.count + old) + 1, sizeof *to->slips, &to->capacity, &to->slips));
  to->count = 0;
  for (int c = 0; c < d->list.count; c++) {
    const gh_friction *q = &d->list.friction[c];
    d->trial.dissipated += q->dissipated;
    if (q->slip.gamma != 0 || q->slip.gamma_pl != 0 || q->slip.alpha != 0) to->slips[to->count++] = q->slip;
  }
  to->count = gh_slips_add_opened(to->slips, to->count, d->now.slips.slips, old);
  return GH_OK;
}

/* The trial state becomes the last equilibrium. External work by the trapezoidal rule. */
static void substep_accept(gh_direct *d) {
  for (int k = 0; k < 2 * d->n; k++) {
    const unsigned char bit = k % 2 ? GH_FIXED_Y : GH_FIXED_X;
    d->reaction[k] = d->mask[k / 2] & bit ? -d->list.force[k] - d->load[k] : 0;
    const double outside = d->load[k] + d->reaction[k];
    d->m.outer_work += (d->outside[k] + outside) / 2 * (d->trial.x[k] - d->now.x[k]);
    d->outside[k] = outside;
  }
  const direct_state swap = d->now;
  d->now = d->trial;
  d->trial = swap;
  double sum = 0;
  d->energy = 0;
  for (int c = 0; c < d->list.count; c++) {
    const gh_contact *q = &d->list.contacts[c];
    d->energy += q->energy + (d->list.friction ? d->list.friction[c].energy : 0);
    sum += q->overlap * hypot(q->l[0], q->l[1]);
  }
  d->pressure = d->options.law.normal_stiffness * sum / (2 * d->outline.area);
  d->m.residual = direct_residual(d, d->mask, &d->m.mean_force);
}

/* From the fraction t0 of the plan to t1. */
static gh_status substep_solve(gh_direct *d, const direct_plan *p, double t0, double t1,
                               gh_direct_report *report) {
  attempt a = {.plan = p, .left = d->options.max_steps, .report = report};
  const int stages = stage_count(d, p->strain * (t1 - t0));
  GH_TRY(substep_begin(d));
  for (int k = 1; k <= stages; k++) {
    const bool last = k == stages;
    a.t = last ? t1 : t0 + (t1 - t0) * k / stages;
    for (int i = 0; i < 2 * d->n; i++) {
      const unsigned char bit = i % 2 ? GH_FIXED_Y : GH_FIXED_X;
      if (p->mask[i / 2] & bit) d->trial.x[i] = d->now.x[i] + (a.t - t0) * p->step[i];
      else d->trial.x[i] += (t1 - t0) / stages * p->step[i];
    }
    GH_TRY(gh_engine_set(d->engine, NULL, d->trial.x, d->trial.theta));
    GH_TRY(stage_relax(d, &a, last ? d->options.tolerance : fmax(rule.rest, d->options.tolerance)));
  }
  return substep_slips(d);
}

/* ---- an increment ---- */

/* Loads at the fraction t are those that the next increment starts from. */
static void loads_take(gh_direct *d, const direct_plan *p, double t) {
  for (int k = 0; k < 2 * d->n; k++)
    d->dead[k] = t < 1 ? (1 - t) * (d->dead[k] + p->fade[k]) + t * p->dead[k] : p->dead[k];
  for (int k = 0; k < d->outline.nedges; k++) {
    d->pressure_dead[k] = (1 - t) * d->pressure_dead[k] + t * p->pressure[k];
    d->follow[k] = (1 - t) * d->follow[k] + t * p->follow[k];
  }
}

static void nodes_take(gh_direct *d, const gh_direct_loads *loads, double t) {
  for (int a = 0; a < d->mesh->nnodes; a++) {
    double u[2];
    direct_fit(d, d->now.x, a, u);
    for (int i = 0; i < 2; i++) {
      double *to = d->u + 2 * a + i;
      *to = !loads->fixed[2 * a + i] ? u[i]
            : t < 1                  ? *to + t * (loads->value[2 * a + i] - *to)
                                     : loads->value[2 * a + i];
    }
  }
}

static gh_status increment_solve(gh_direct *d, const direct_plan *p, gh_direct_report *report, double *t) {
  const double least = ldexp(1, -d->options.cut_steps);
  double part = 1;
  while (*t < 1) {
    const double to = *t + part < 1 ? *t + part : 1;
    const gh_status status = substep_solve(d, p, *t, to, report);
    if (status == GH_OK) {
      substep_accept(d);
      report->substeps++;
      *t = to;
    } else if (status != GH_DIVERGED || part / 2 < least) {
      return status;
    } else {
      gh_log(d->ctx, GH_LEVEL_INFO, "part %d is halved: %s", report->substeps + 1, gh_message(d->ctx));
      report->cuts++;
      part /= 2;
    }
  }
  return GH_OK;
}

/* The grains come to rest with those on the boundary where they are. */
static gh_status boundary_hold(gh_direct *d, gh_direct_report *report) {
  attempt a = {.left = d->options.max_steps, .report = report};
  direct_plan p;
  const size_t n = (size_t)d->n;
  gh_status status;
  GH_TRY_OR(direct_plan_allocate(d, &p), done);
  for (size_t i = 0; i < n; i++) p.mask[i] = d->boundary[i] ? GH_FIXED_X | GH_FIXED_Y : 0;
  a.plan = &p;
  GH_TRY_OR(engine_make(d, p.mask), done);
  GH_TRY_OR(substep_begin(d), done);
  GH_TRY_OR(gh_engine_set(d->engine, NULL, d->trial.x, d->trial.theta), done);
  GH_TRY_OR(stage_relax(d, &a, fmax(rule.rest, d->options.tolerance)), done);
  GH_TRY_OR(substep_slips(d), done);
  substep_accept(d);
done:
  direct_plan_destroy(&p);
  return status;
}

/* At the start what holds the boundary fades, while the loads grow. */
gh_status gh_direct_solve(gh_direct *d, const gh_direct_loads *loads, gh_direct_report *report) {
  const double start = gh_seconds();
  direct_plan p;
  double t = 0;
  *report = (gh_direct_report){0};
  if (!d->solved) GH_TRY(boundary_hold(d, report));
  gh_status status = direct_plan_create(d, loads, &p);
  if (status == GH_OK) status = engine_make(d, p.mask);
  if (status == GH_OK) status = increment_solve(d, &p, report, &t);
  if (status == GH_OK || t > 0) {
    d->solved = true;
    loads_take(d, &p, t);
    nodes_take(d, loads, t);
  }
  direct_plan_destroy(&p);
  report->seconds = gh_seconds() - start;
  return status == GH_OK ? direct_measure(d) : status;
}

gh_status gh_direct_balance(gh_direct *d) {
  gh_direct_report report = {0};
  GH_TRY(boundary_hold(d, &report));
  memcpy(d->kept, d->reaction, 2 * (size_t)d->n * sizeof(double));
  memset(d->reaction, 0, 2 * (size_t)d->n * sizeof(double)); /* it does not fade */
  memcpy(d->dead, d->kept, 2 * (size_t)d->n * sizeof(double));
  d->solved = true;
  return GH_OK;
}
