/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The native engine: plain C, the reference that LAMMPS is checked against. */
#include "contact/coulomb.h"
#include "contact/normal.h"
#include "engine/native/history.h"
#include "engine/native/neighbours.h"
#include "engine/ops.h"
#include "engine/relax/relax_fire.h"

#include <stdlib.h>
#include <string.h>

typedef struct native {
  gh_context *ctx;
  int n;
  bool periodic;
  gh_contact_law law;
  double skin, cell[4];
  double *radius, *x, *x0, *v, *f, *work;
  unsigned char *held;
  gh_relax_frame frame;
  gh_neighbours nb;
  gh_contact *contacts;
  size_t contact_capacity, work_capacity;
  gh_engine_cost cost;
  /* with friction only */
  double *theta, *w, *m;
  gh_history history;
  gh_friction *friction;
  size_t friction_capacity;
} native;

static void native_destroy(void *self) {
  native *e = self;
  if (!e) return;
  gh_neighbours_free(&e->nb);
  gh_history_free(&e->history);
  double *const arrays[] = {e->radius, e->x, e->x0, e->v, e->f, e->work, e->theta, e->w, e->m};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  gh_relax_frame_free(&e->frame);
  free(e->held);
  free(e->contacts);
  free(e->friction);
  free(e);
}

static gh_status allocate(gh_context *ctx, const gh_engine_setup *setup, native *e) {
  size_t n = (size_t)e->n, d = sizeof(double);
  GH_TRY(gh_alloc(ctx, n, d, &e->radius));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->x));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->x0));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->v));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->f));
  if (e->law.friction) {
    GH_TRY(gh_alloc(ctx, n, d, &e->theta));
    GH_TRY(gh_alloc(ctx, n, d, &e->w));
    GH_TRY(gh_alloc(ctx, n, d, &e->m));
    GH_TRY(gh_history_alloc(ctx, &e->history, e->n));
    GH_TRY(gh_grow(ctx, 1, sizeof(gh_friction), &e->friction_capacity, &e->friction)); /* never NULL */
  }
  GH_TRY(gh_relax_frame_make(ctx, setup, &e->frame));
  return gh_alloc(ctx, n, 1, &e->held);
}

static gh_status native_create(gh_context *ctx, const gh_engine_setup *setup, void **self) {
  native *e;
  GH_TRY(gh_alloc(ctx, 1, sizeof *e, &e));
  *e = (native){.ctx = ctx, .n = setup->n, .periodic = setup->periodic, .law = setup->law};
  e->nb.with_images = setup->law.friction != 0;
  gh_status status = allocate(ctx, setup, e);
  if (status != GH_OK) {
    native_destroy(e);
    return status;
  }
  memcpy(e->radius, setup->radius, (size_t)e->n * sizeof(double));
  if (setup->held) memcpy(e->held, setup->held, (size_t)e->n);
  double mean = 0;
  for (int i = 0; i < e->n; i++) mean += e->radius[i] / e->n;
  e->skin = 0.2 * mean;
  *self = e;
  return GH_OK;
}

static gh_status find_pairs(native *e) {
  GH_TRY(gh_neighbours_find(e->ctx, &e->nb, e->n, e->x, e->radius, e->periodic ? e->cell : NULL, e->skin));
  memcpy(e->x0, e->x, 2 * (size_t)e->n * sizeof(double));
  e->cost.rebuilds++;
  if (e->law.friction) {
    double start = gh_seconds();
    GH_TRY(gh_history_recall(e->ctx, &e->history, &e->nb));
    e->cost.history_seconds += gh_seconds() - start;
  }
  const int npairs = (int)e->nb.npairs;
  const size_t work = e->law.friction ? gh_relax_friction_work(e->n, npairs) : gh_relax_work(e->n, npairs);
  return gh_grow(e->ctx, work, sizeof(double), &e->work_capacity, &e->work);
}

static gh_status native_begin(void *self, const gh_converged *state) {
  native *e = self;
  double start = gh_seconds();
  GH_TRY(gh_history_begin(e->ctx, &e->history, e->n, e->periodic, state));
  e->cost.history_seconds += gh_seconds() - start;
  return GH_OK;
}

/* Grains that do not rotate stay as they were at n, whatever is asked for. */
static void set_rotations(native *e, const double *theta) {
  if (!e->law.friction) return;
  memcpy(e->theta, e->law.fixed_rotations ? e->history.theta : theta, (size_t)e->n * sizeof(double));
}

static gh_status native_set(void *self, const double cell[4], const double *x, const double *theta) {
  native *e = self;
  double start = gh_seconds();
  if (e->periodic) memcpy(e->cell, cell, sizeof e->cell);
  memcpy(e->x, x, 2 * (size_t)e->n * sizeof(double));
  set_rotations(e, theta);
  GH_TRY(find_pairs(e));
  e->cost.set_seconds += gh_seconds() - start;
  return GH_OK;
}

static gh_status native_move(void *self, const double *x, const double *theta) {
  native *e = self;
  double start = gh_seconds(), far = 0;
  memcpy(e->x, x, 2 * (size_t)e->n * sizeof(double));
  set_rotations(e, theta);
  for (int i = 0; i < e->n; i++)
    far = fmax(far, hypot(x[2 * i] - e->x0[2 * i], x[2 * i + 1] - e->x0[2 * i + 1]));
  if (far > e->skin / 2) GH_TRY(find_pairs(e));
  e->cost.set_seconds += gh_seconds() - start;
  return GH_OK;
}

/* Relaxes on one pair list; `s` and `f` are the same relaxation, `f` with friction. */
static gh_relax_end relax_on_list(native *e, gh_relax_state *s, gh_relax_friction *f,
                                  const gh_relax_options *o, gh_relax_result *r) {
  const long left = o->max_steps - r->steps;
  const bool fire = o->method == GH_RELAX_FIRE;
  gh_relax_state *g = e->law.friction ? &f->grains : s;
  g->pairs = e->nb.pairs;
  g->npairs = (int)e->nb.npairs;
  g->work = e->work;
  f->memory = e->history.memory;
  if (!e->law.friction)
    return (fire ? gh_relax_fire : gh_relax_run)(s, o->tolerance, o->floor, left, &r->residual,
                                                 &r->mean_force, &r->steps);
  return (fire ? gh_relax_friction_fire : gh_relax_friction_run)(f, o->tolerance, o->floor, left,
                                                                 &r->residual, &r->mean_force, &r->steps);
}

static gh_relax_state native_grains(native *e) {
  return (gh_relax_state){.n = e->n,
                          .held = e->held,
                          .stiffness = e->law.normal_stiffness,
                          .x = e->x,
                          .v = e->v,
                          .f = e->f,
                          .x0 = e->x0,
                          .slack = e->skin / 2,
                          .frame = gh_relax_frame_used(&e->frame)};
}

static gh_relax_friction native_rotating(native *e) {
  return (gh_relax_friction){.grains = native_grains(e),
                             .law = &e->law,
                             .radius = e->radius,
                             .theta_n = e->history.theta,
                             .theta = e->theta,
                             .w = e->w,
                             .m = e->m};
}

/* A relaxation that began at `start` ends so. */
static void native_end(native *e, gh_relax_end end, const gh_relax_friction *f, double start,
                       gh_relax_result *r) {
  r->converged = gh_relax_at_rest(end);
  r->least_damping = f->watch.least;
  e->cost.steps += r->steps;
  e->cost.relax_seconds += gh_seconds() - start;
}

static gh_status native_load(void *self, const double *force, const double *moment) {
  native *e = self;
  return gh_relax_frame_load(e->ctx, e->n, force, moment, &e->frame);
}

static gh_status native_relax(void *self, const gh_relax_options *o, gh_relax_result *r) {
  native *e = self;
  double start = gh_seconds();
  gh_relax_state s = native_grains(e);
  gh_relax_friction f = native_rotating(e);
  f.watch = (gh_relax_watch){.least = o->least_damping, .patience = o->patience};
  *r = (gh_relax_result){0};
  gh_relax_end end = GH_RELAX_REBUILD;
  while (end == GH_RELAX_REBUILD && r->steps < o->max_steps) {
    const long before = r->steps;
    end = relax_on_list(e, &s, &f, o, r);
    e->cost.pairs += (r->steps - before) * (long)e->nb.npairs;
    if (end == GH_RELAX_REBUILD) GH_TRY(find_pairs(e));
  }
  native_end(e, end, &f, start, r);
  return GH_OK;
}

/* The cell, the list and state n of where the ramp is. */
static gh_status native_follow_ramp(native *e, const gh_relax_ramp *ramp, const double from[4]) {
  double G[4];
  gh_relax_ramp_gradient(ramp, G);
  if (e->periodic) gh_mul2(G, from, e->cell);
  GH_TRY(gh_history_store(e->ctx, &e->history, &e->nb, e->n, e->x, e->periodic ? e->cell : NULL));
  return find_pairs(e);
}

static gh_status native_ramp(void *self, const gh_ramp *o, gh_ramp_result *result) {
  native *e = self;
  double start = gh_seconds(), from[4];
  gh_relax_ramp ramp = {.steps = o->steps, .round_off = o->round_off};
  gh_relax_friction f = native_rotating(e);
  gh_relax_result *r = &result->relaxed;
  memcpy(ramp.to, o->to, sizeof ramp.to);
  memcpy(from, e->cell, sizeof from);
  f.ramp = &ramp;
  *result = (gh_ramp_result){0};
  gh_relax_end end = GH_RELAX_REBUILD;
  while (end == GH_RELAX_REBUILD && r->steps < o->max_steps) {
    const long before = r->steps;
    f.grains.pairs = e->nb.pairs, f.grains.npairs = (int)e->nb.npairs;
    f.grains.work = e->work, f.grains.x0 = e->x0;
    f.memory = e->history.memory;
    end = gh_relax_friction_run(&f, o->tolerance, o->floor, o->max_steps - r->steps, &r->residual,
                                &r->mean_force, &r->steps);
    e->cost.pairs += (r->steps - before) * (long)e->nb.npairs;
    if (isfinite(r->residual)) GH_TRY(native_follow_ramp(e, &ramp, from)); /* else gh_engine_ramp refuses */
  }
  native_end(e, end, &f, start, r);
  result->done = ramp.done;
  result->dissipated = ramp.dissipated;
  result->slips = e->history.slips, result->nslips = (int)e->history.nslips;
  return GH_OK;
}

/* The friction of contact `c`, the pair p of the list, into its place; the force of `c` becomes the whole
 * one. Adds the moments to the grains. */
static gh_status add_friction(native *e, size_t p, gh_contact *c, double d, size_t at) {
  const gh_pair_memory *m = &e->history.memory[p];
  const double *r = e->radius, *theta = e->theta, *theta_n = e->history.theta,
               q = r[c->i] * (theta[c->i] - theta_n[c->i]) + r[c->j] * (theta[c->j] - theta_n[c->j]);
  const gh_coulomb_step s = {.l = {c->l[0], c->l[1]},
                             .d = d,
                             .reach = e->nb.pairs[p].reach,
                             .ln = {m->ln[0], m->ln[1]},
                             .q = q,
                             .gamma = m->gamma,
                             .gamma_pl = m->gamma_pl,
                             .alpha = m->alpha};
  gh_coulomb_result t;
  gh_coulomb_evaluate(&e->law, &s, &t);
  GH_TRY(gh_grow(e->ctx, at + 1, sizeof(gh_friction), &e->friction_capacity, &e->friction));
  gh_friction *f = &e->friction[at];
  *f = (gh_friction){.slip = {.i = c->i,
                              .j = c->j,
                              .image = {e->nb.image[2 * p], e->nb.image[2 * p + 1]},
                              .gamma = t.gamma,
                              .gamma_pl = t.gamma_pl,
                              .alpha = t.alpha},
                     .force = t.force,
                     .couple = t.couple,
                     .energy = gh_coulomb_energy(&e->law, &t),
                     .dissipated = gh_coulomb_dissipated(&e->law, &t, c->overlap),
                     .slides = t.slides != 0};
  gh_coulomb_derivative(&e->law, &s, &t, f->d);
  c->f[0] = t.f[0], c->f[1] = t.f[1];
  e->m[c->i] -= r[c->i] * t.couple;
  e->m[c->j] -= r[c->j] * t.couple;
  return GH_OK;
}

/* Appends the contact of the pair if it touches, and adds its force to the grains. With friction, the pair is
 * number `number` of the list. */
static gh_status add_contact(native *e, const gh_pair *p, size_t number, size_t *count) {
  double l[2] = {e->x[2 * p->j] - e->x[2 * p->i] + p->shift[0],
                 e->x[2 * p->j + 1] - e->x[2 * p->i + 1] + p->shift[1]};
  double d = sqrt(l[0] * l[0] + l[1] * l[1]), overlap = p->reach - d, E = e->law.normal_stiffness;
  if (overlap < 0) return GH_OK;
  if (!(d > 0))
    return gh_fail(e->ctx, GH_DIVERGED,
                   "the centres of grains %d and %d coincide: their contact has no direction", p->i + 1,
                   p->j + 1);
  GH_TRY(gh_grow(e->ctx, *count + 1, sizeof(gh_contact), &e->contact_capacity, &e->contacts));
  gh_contact *c = &e->contacts[*count];
  double factor = gh_normal_factor(E, overlap, d);
  *c = (gh_contact){.i = p->i,
                    .j = p->j,
                    .l = {l[0], l[1]},
                    .f = {factor * l[0], factor * l[1]},
                    .overlap = overlap,
                    .energy = gh_normal_energy(E, overlap)};
  gh_normal_hessian(E, overlap, d, l, 2, c->h);
  if (e->law.friction) GH_TRY(add_friction(e, number, c, d, *count));
  ++*count;
  if (e->law.friction && p->i == p->j) return GH_OK; /* no net force, not even a rounded one */
  for (int k = 0; k < 2; k++) {
    e->f[2 * p->i + k] += c->f[k];
    e->f[2 * p->j + k] -= c->f[k];
  }
  return GH_OK;
}

static gh_status native_contacts(void *self, gh_contact_list *list) {
  native *e = self;
  double start = gh_seconds();
  size_t n = 0, own = 0;
  memset(e->f, 0, 2 * (size_t)e->n * sizeof(double));
  if (e->law.friction) memset(e->m, 0, (size_t)e->n * sizeof(double));
  for (size_t p = 0; p < e->nb.npairs;
       p++) { /* a grain's own images come between its pairs with smaller and larger j */
    for (; own < e->nb.nown && e->nb.own[own].i <= e->nb.pairs[p].i; own++)
      GH_TRY(add_contact(e, &e->nb.own[own], own, &n));
    GH_TRY(add_contact(e, &e->nb.pairs[p], p, &n));
  }
  for (; own < e->nb.nown; own++) GH_TRY(add_contact(e, &e->nb.own[own], own, &n));
  *list = (gh_contact_list){
      .count = (int)n, .contacts = e->contacts, .friction = e->friction, .force = e->f, .moment = e->m};
  e->cost.evaluations++;
  e->cost.pairs += (long)(e->nb.npairs + e->nb.nown);
  e->cost.contact_seconds += gh_seconds() - start;
  return GH_OK;
}

static gh_status native_get(void *self, double *x, double *theta) {
  const native *e = self;
  memcpy(x, e->x, 2 * (size_t)e->n * sizeof(double));
  if (e->law.friction) memcpy(theta, e->theta, (size_t)e->n * sizeof(double));
  return GH_OK;
}

static void native_costs(const void *self, gh_engine_cost *cost) {
  *cost = ((const native *)self)->cost;
}

const gh_engine_ops gh_native_ops = {.name = "native",
                                     .create = native_create,
                                     .destroy = native_destroy,
                                     .begin = native_begin,
                                     .set = native_set,
                                     .move = native_move,
                                     .load = native_load,
                                     .relax = native_relax,
                                     .ramp = native_ramp,
                                     .contacts = native_contacts,
                                     .get = native_get,
                                     .costs = native_costs};
