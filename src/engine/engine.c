/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dispatch to the engines, and the checks that all of them need. */
#include "engine/module.h"
#include "engine/ops.h"
#include "granhom/lammps.h"

#include <stdlib.h>
#include <string.h>

struct gh_engine {
  gh_context *ctx;
  const gh_engine_ops *ops;
  void *self;
  int n;
  bool periodic, friction, begun;
  double reach, area; /* twice the largest radius; sum of the areas of the grains */
  double cell[4];     /* now; of a periodic packing */
};

/* Squares of forces must be numbers still, for whatever lengths. */
static const double least_stiffness = 1e-100, most_stiffness = 1e100;

gh_status gh_contact_law_check(gh_context *ctx, const gh_contact_law *law) {
  double E = law->normal_stiffness, Et = law->tangential_stiffness, mu = law->friction_coefficient,
         h = law->hardening;
  if (!(E > 0) || !isfinite(E))
    return gh_fail(ctx, GH_INPUT, "the normal stiffness must be positive and finite, not %g", E);
  if (E < least_stiffness || E > most_stiffness)
    return gh_fail(ctx, GH_INPUT,
                   "the normal stiffness must lie between %g and %g, but is %g: choose other units",
                   least_stiffness, most_stiffness, E);
  if (!law->friction) return GH_OK;
  if (!(Et > 0) || !isfinite(Et))
    return gh_fail(ctx, GH_INPUT, "the tangential stiffness must be positive and finite, not %g", Et);
  if (!(mu >= 0) || !isfinite(mu))
    return gh_fail(ctx, GH_INPUT, "the friction coefficient must be finite and not negative, but is %g", mu);
  if (!(h >= 0) || !isfinite(h))
    return gh_fail(ctx, GH_INPUT, "the hardening must be finite and not negative, but is %g", h);
  return GH_OK;
}

static const char *const relaxation_names[] = {
    [GH_RELAX_POLISHED] = "polished", [GH_RELAX_DAMPED] = "damped", [GH_RELAX_FIRE] = "fire"};

bool gh_relaxation_from_name(const char *name, gh_relaxation *relaxation) {
  for (int k = 0; k < 3; k++)
    if (!strcmp(name, relaxation_names[k])) return *relaxation = (gh_relaxation)k, true;
  return false;
}

const char *gh_relaxation_name(gh_relaxation relaxation) {
  return relaxation_names[relaxation];
}

/* Lengths and forces, too. */
static const double least_product = 1e-120, most_product = 1e120;

static gh_status check_radius(gh_context *ctx, double r, double E) {
  if (r >= least_product && r <= most_product && E * r >= least_product && E * r <= most_product)
    return GH_OK;
  return gh_fail(
      ctx, GH_INPUT,
      "grains of radius %g with a normal stiffness of %g: the radius, and the product of both, which "
      "contact forces are a part of, must lie between %g and %g, so that their squares are numbers: "
      "choose other units",
      r, E, least_product, most_product);
}

static gh_status check_setup(gh_context *ctx, const gh_engine_setup *s) {
  if (s->n < 1) return gh_fail(ctx, GH_INPUT, "an engine needs at least one grain, not %d", s->n);
  GH_TRY(gh_contact_law_check(ctx, &s->law));
  for (int i = 0; i < s->n; i++) {
    if (!(s->radius[i] > 0) || !isfinite(s->radius[i]))
      return gh_fail(ctx, GH_INPUT, "the radius of grain %d must be positive and finite, not %g", i + 1,
                     s->radius[i]);
    GH_TRY(check_radius(ctx, s->radius[i], s->law.normal_stiffness));
    if (s->periodic && s->fixed && ((s->fixed[i] ^ s->fixed[i] >> 1) & GH_FIXED_X))
      return gh_fail(ctx, GH_INPUT, "grain %d of a periodic cell is fixed in one direction alone", i + 1);
    if (s->area && !gh_finite(&s->area[2 * i], 2))
      return gh_fail(ctx, GH_INPUT, "the area of grain %d is not finite", i + 1);
    if (s->type && s->type[i] < 1)
      return gh_fail(ctx, GH_INPUT, "the type of grain %d must be 1 or more, not %d", i + 1, s->type[i]);
  }
  return GH_OK;
}

gh_status gh_engine_create(gh_context *ctx, gh_engine_kind kind, const gh_engine_setup *setup,
                           gh_engine **engine) {
  *engine = NULL;
  GH_TRY(check_setup(ctx, setup));
  const gh_engine_ops *ops = &gh_native_ops;
  if (kind == GH_ENGINE_LAMMPS) {
    const gh_lammps_module *module;
    GH_TRY(gh_lammps_load(ctx, &module));
    ops = module->engine;
  }
  gh_engine *e;
  GH_TRY(gh_alloc(ctx, 1, sizeof *e, &e));
  *e = (gh_engine){.ctx = ctx,
                   .ops = ops,
                   .n = setup->n,
                   .periodic = setup->periodic,
                   .friction = setup->law.friction != 0};
  for (int i = 0; i < setup->n; i++) {
    double r = setup->radius[i];
    e->reach = fmax(e->reach, 2 * r);
    e->area += acos(-1) * r * r;
  }
  gh_status s = e->ops->create(ctx, setup, &e->self);
  if (s != GH_OK) {
    free(e);
    return s;
  }
  *engine = e;
  return GH_OK;
}

void gh_engine_destroy(gh_engine **engine) {
  if (!engine || !*engine) return;
  (*engine)->ops->destroy((*engine)->self);
  free(*engine);
  *engine = NULL;
}

const char *gh_engine_name(const gh_engine *e) {
  return e->ops->name;
}

int gh_engine_lammps_version(void) {
  void *lmp;
  if (gh_lmp_open(NULL, &lmp) != GH_OK) return 0;
  int version = gh_lmp_version(NULL, lmp);
  gh_lmp_close(&lmp);
  return version;
}

static gh_status check_positions(const gh_engine *e, const double *x) {
  for (int i = 0; i < e->n; i++)
    if (!isfinite(x[2 * i]) || !isfinite(x[2 * i + 1]))
      return gh_fail(e->ctx, GH_INPUT, "the position of grain %d is not finite: (%g, %g)", i + 1, x[2 * i],
                     x[2 * i + 1]);
  return GH_OK;
}

/* Distance between the long sides of the cell, of all cells of this lattice the one with the shortest sides.
 */
static double lattice_height(const double cell[4]) {
  double a[2] = {cell[0], cell[2]}, b[2] = {cell[1], cell[3]};
  for (;;) { /* Gauss's reduction: a is the shorter one */
    double a2 = a[0] * a[0] + a[1] * a[1], b2 = b[0] * b[0] + b[1] * b[1];
    if (a2 > b2) {
      for (int k = 0; k < 2; k++) {
        double swap = a[k];
        a[k] = b[k];
        b[k] = swap;
      }
      a2 = b2;
    }
    double times = nearbyint((a[0] * b[0] + a[1] * b[1]) / a2);
    if (!(fabs(times) >= 1)) return gh_det2(cell) / hypot(b[0], b[1]); /* also where it is NaN */
    for (int k = 0; k < 2; k++) b[k] -= times * a[k];
  }
}

/* What no packing looks like would cost time and memory without limit: a Newton trial may ask for it. */
static gh_status check_cell(const gh_engine *e, const double cell[4]) {
  static const double most_filled = 20, most_images = 50, most_distorted = 1e10;
  double det = gh_det2(cell);
  if (!gh_finite(cell, 4) || !(det > 0) || !isfinite(det))
    return gh_fail(e->ctx, GH_INPUT, "the cell [%g %g; %g %g] must be finite with a positive determinant",
                   cell[0], cell[1], cell[2], cell[3]);
  double longest = fmax(hypot(cell[0], cell[2]), hypot(cell[1], cell[3]));
  if (!(longest <= sqrt(most_distorted) * sqrt(det)))
    return gh_fail(e->ctx, GH_INPUT, "the cell [%g %g; %g %g] is distorted beyond use", cell[0], cell[1],
                   cell[2], cell[3]);
  if (!(e->area <= most_filled * det))
    return gh_fail(
        e->ctx, GH_INPUT,
        "the cell [%g %g; %g %g] is compressed too far: the grains fill it %.3g times, at most %g is "
        "possible",
        cell[0], cell[1], cell[2], cell[3], e->area / det, most_filled);
  if (!(e->reach <= most_images * lattice_height(cell)))
    return gh_fail(
        e->ctx, GH_INPUT,
        "the cell [%g %g; %g %g] is too thin for grains of diameter %g: one would touch more than %g "
        "images of itself in a row",
        cell[0], cell[1], cell[2], cell[3], e->reach, most_images);
  return GH_OK;
}

/* Rotations count only with friction. */
static gh_status check_rotations(const gh_engine *e, const double *theta) {
  if (!e->friction) return GH_OK;
  for (int i = 0; i < e->n; i++)
    if (!isfinite(theta[i]))
      return gh_fail(e->ctx, GH_INPUT, "the rotation of grain %d is not finite: %g", i + 1, theta[i]);
  return GH_OK;
}

static int compare_keys(const gh_slip *a, const gh_slip *b) {
  const int ka[4] = {a->i, a->j, a->image[1], a->image[0]}, kb[4] = {b->i, b->j, b->image[1], b->image[0]};
  for (int k = 0; k < 4; k++)
    if (ka[k] != kb[k]) return ka[k] < kb[k] ? -1 : 1;
  return 0;
}

static gh_status check_slips(const gh_engine *e, const gh_converged *s) {
  for (int c = 0; c < s->nslips; c++) {
    const gh_slip *q = &s->slips[c];
    if (q->i < 0 || q->j < q->i || q->j >= e->n)
      return gh_fail(e->ctx, GH_INPUT, "the history names a contact between grains %d and %d of %d", q->i + 1,
                     q->j + 1, e->n);
    const int *k = q->image;
    if (e->periodic ? q->i == q->j && (k[1] < 0 || (k[1] == 0 && k[0] <= 0)) : q->i == q->j || k[0] || k[1])
      return gh_fail(e->ctx, GH_INPUT, "the history names a contact of grains %d and %d at image (%d, %d)",
                     q->i + 1, q->j + 1, k[0], k[1]);
    if (c > 0 && compare_keys(q - 1, q) >= 0)
      return gh_fail(e->ctx, GH_INPUT, "the history of the contacts is not in order at grains %d and %d",
                     q->i + 1, q->j + 1);
    if (!isfinite(q->gamma) || !isfinite(q->gamma_pl) || !isfinite(q->alpha))
      return gh_fail(e->ctx, GH_INPUT, "the history of the contact of grains %d and %d is not finite",
                     q->i + 1, q->j + 1);
  }
  return GH_OK;
}

gh_status gh_engine_begin(gh_engine *e, const gh_converged *state) {
  if (!e->friction) return GH_OK;
  if (e->periodic) GH_TRY(check_cell(e, state->cell));
  GH_TRY(check_positions(e, state->x));
  GH_TRY(check_rotations(e, state->theta));
  GH_TRY(check_slips(e, state));
  GH_TRY(e->ops->begin(e->self, state));
  e->begun = true;
  return GH_OK;
}

gh_status gh_engine_set(gh_engine *e, const double cell[4], const double *x, const double *theta) {
  if (e->friction && !e->begun)
    return gh_fail(e->ctx, GH_ENGINE, "an engine with friction has no converged state yet (gh_engine_begin)");
  if (e->periodic) GH_TRY(check_cell(e, cell));
  GH_TRY(check_positions(e, x));
  GH_TRY(check_rotations(e, theta));
  if (e->periodic) memcpy(e->cell, cell, sizeof e->cell);
  return e->ops->set(e->self, cell, x, theta);
}

gh_status gh_engine_move(gh_engine *e, const double *x, const double *theta) {
  GH_TRY(check_positions(e, x));
  GH_TRY(check_rotations(e, theta));
  return e->ops->move(e->self, x, theta);
}

gh_status gh_engine_load(gh_engine *e, const double *force, const double *moment) {
  for (int i = 0; i < e->n; i++)
    if ((force && !gh_finite(&force[2 * i], 2)) || (moment && !isfinite(moment[i])))
      return gh_fail(e->ctx, GH_INPUT, "the external load of grain %d is not finite", i + 1);
  return e->ops->load(e->self, force, e->friction ? moment : NULL);
}

gh_status gh_engine_relax(gh_engine *e, const gh_relax_options *options, gh_relax_result *result) {
  GH_TRY(e->ops->relax(e->self, options, result));
  if (!isfinite(result->residual) || !isfinite(result->mean_force))
    return gh_fail(e->ctx, GH_DIVERGED,
                   "relaxation gave a residual that is not finite (two grains at one place?)");
  return GH_OK;
}

/* The gradient at this share of the ramp, and the cell there. */
static void ramp_at(const gh_engine *e, const gh_ramp *ramp, double share, double G[4], double cell[4]) {
  for (int k = 0; k < 4; k++) {
    const double one = k == 0 || k == 3 ? 1 : 0;
    G[k] = share < 1 ? one + share * (ramp->to[k] - one) : ramp->to[k];
  }
  gh_mul2(G, e->cell, cell);
}

/* The share of the ramp at which the determinant, 1 + s tr A + s^2 det A with A = to - 1, is least. */
static double ramp_thinnest(const gh_ramp *ramp) {
  const double A[4] = {ramp->to[0] - 1, ramp->to[1], ramp->to[2], ramp->to[3] - 1}, det = gh_det2(A),
               share = -(A[0] + A[3]) / (2 * det);
  return det > 0 && share > 0 && share < 1 ? share : 1;
}

static gh_status check_ramp(const gh_engine *e, const gh_ramp *ramp) {
  const double *to = ramp->to;
  if (!gh_finite(to, 4) || !(gh_det2(to) > 0) || ramp->steps < 0 || ramp->max_steps <= ramp->steps)
    return gh_fail(
        e->ctx, GH_INPUT,
        "a ramp to [%g %g; %g %g] in %ld of %ld steps: the determinant must be positive, and steps "
        "must be left to come to rest",
        to[0], to[1], to[2], to[3], ramp->steps, ramp->max_steps);
  double off = 0; /* who divides one gradient by another has rounding in it */
  for (int k = 0; k < 4; k++) off = fmax(off, fabs(to[k] - (k == 0 || k == 3 ? 1 : 0)));
  if (ramp->steps == 0 && off > 1e-12)
    return gh_fail(e->ctx, GH_INPUT, "a ramp to [%g %g; %g %g] needs steps in which it is reached", to[0],
                   to[1], to[2], to[3]);
  const double shares[2] = {ramp_thinnest(ramp), 1};
  for (int k = 0; k < 2; k++) {
    double G[4], cell[4];
    ramp_at(e, ramp, shares[k], G, cell);
    if (!(gh_det2(G) > 0))
      return gh_fail(e->ctx, GH_INPUT,
                     "a ramp to [%g %g; %g %g]: the determinant is %g on the way, and must be positive",
                     to[0], to[1], to[2], to[3], gh_det2(G));
    if (e->periodic) GH_TRY(check_cell(e, cell));
  }
  return GH_OK;
}

gh_status gh_engine_ramp(gh_engine *e, const gh_ramp *ramp, gh_ramp_result *result) {
  if (!e->friction || !e->begun)
    return gh_fail(e->ctx, GH_ENGINE, "a ramp needs friction and a converged state (gh_engine_begin)");
  GH_TRY(check_ramp(e, ramp));
  GH_TRY(e->ops->ramp(e->self, ramp, result));
  if (!isfinite(result->relaxed.residual) || !isfinite(result->relaxed.mean_force))
    return gh_fail(e->ctx, GH_DIVERGED,
                   "relaxation gave a residual that is not finite (two grains at one place?)");
  double G[4];
  ramp_at(e, ramp, ramp->steps ? (double)result->done / (double)ramp->steps : 1, G, e->cell);
  return GH_OK;
}

gh_status gh_engine_contacts(gh_engine *e, gh_contact_list *list) {
  return e->ops->contacts(e->self, list);
}

gh_status gh_engine_get(gh_engine *e, double *x, double *theta) {
  GH_TRY(e->ops->get(e->self, x, theta));
  for (int i = 0; i < 2 * e->n; i++)
    if (!isfinite(x[i]))
      return gh_fail(e->ctx, GH_DIVERGED, "relaxation has thrown grain %d to a place that is not finite",
                     i / 2 + 1);
  if (e->friction && !gh_finite(theta, (size_t)e->n))
    return gh_fail(e->ctx, GH_DIVERGED, "relaxation has given a grain a rotation that is not finite");
  return GH_OK;
}

void gh_engine_costs(const gh_engine *e, gh_engine_cost *cost) {
  e->ops->costs(e->self, cost);
}
