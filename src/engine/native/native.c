/* The native engine: plain C, the reference that LAMMPS is checked against. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "contact/normal.h"
#include "engine/native/neighbours.h"
#include "engine/ops.h"

#include <stdlib.h>
#include <string.h>

typedef struct native {
  gh_context *ctx;
  int n;
  bool periodic;
  double E, skin, cell[4];
  double *radius, *x, *x0, *v, *f, *work;
  unsigned char *held;
  gh_neighbours nb;
  gh_contact *contacts;
  size_t contact_capacity, work_capacity;
  gh_engine_cost cost;
} native;

static void native_destroy(void *self) {
  native *e = self;
  if (!e) return;
  gh_neighbours_free(&e->nb);
  double *const arrays[] = {e->radius, e->x, e->x0, e->v, e->f, e->work};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  free(e->held);
  free(e->contacts);
  free(e);
}

static gh_status allocate(gh_context *ctx, native *e) {
  size_t n = (size_t)e->n, d = sizeof(double);
  GH_TRY(gh_alloc(ctx, n, d, &e->radius));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->x));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->x0));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->v));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->f));
  return gh_alloc(ctx, n, 1, &e->held);
}

static gh_status native_create(gh_context *ctx, const gh_engine_setup *setup, void **self) {
  native *e;
  GH_TRY(gh_alloc(ctx, 1, sizeof *e, &e));
  *e = (native){.ctx = ctx, .n = setup->n, .periodic = setup->periodic, .E = setup->law.normal_stiffness};
  gh_status status = allocate(ctx, e);
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
  return gh_grow(e->ctx, gh_relax_work(e->n, (int)e->nb.npairs), sizeof(double), &e->work_capacity, &e->work);
}

static gh_status native_set(void *self, const double cell[4], const double *x, const double *theta) {
  (void)theta;
  native *e = self;
  double start = gh_seconds();
  if (e->periodic) memcpy(e->cell, cell, sizeof e->cell);
  memcpy(e->x, x, 2 * (size_t)e->n * sizeof(double));
  GH_TRY(find_pairs(e));
  e->cost.set_seconds += gh_seconds() - start;
  return GH_OK;
}

static gh_status native_move(void *self, const double *x, const double *theta) {
  (void)theta;
  native *e = self;
  double start = gh_seconds(), far = 0;
  memcpy(e->x, x, 2 * (size_t)e->n * sizeof(double));
  for (int i = 0; i < e->n; i++)
    far = fmax(far, hypot(x[2 * i] - e->x0[2 * i], x[2 * i + 1] - e->x0[2 * i + 1]));
  if (far > e->skin / 2) GH_TRY(find_pairs(e));
  e->cost.set_seconds += gh_seconds() - start;
  return GH_OK;
}

static gh_status native_relax(void *self, const gh_relax_options *o, gh_relax_result *r) {
  native *e = self;
  double start = gh_seconds();
  gh_relax_state s = {.n = e->n,
                      .held = e->held,
                      .stiffness = e->E,
                      .x = e->x,
                      .v = e->v,
                      .f = e->f,
                      .x0 = e->x0,
                      .slack = e->skin / 2};
  *r = (gh_relax_result){0};
  gh_relax_end end = GH_RELAX_REBUILD;
  while (end == GH_RELAX_REBUILD && r->steps < o->max_steps) {
    s.pairs = e->nb.pairs;
    s.npairs = (int)e->nb.npairs;
    s.work = e->work;
    end = gh_relax_run(&s, o->tolerance, o->floor, o->max_steps - r->steps, &r->residual, &r->mean_force,
                       &r->steps);
    if (end == GH_RELAX_REBUILD) GH_TRY(find_pairs(e));
  }
  r->converged = end == GH_RELAX_CONVERGED || end == GH_RELAX_UNJAMMED;
  e->cost.steps += r->steps;
  e->cost.relax_seconds += gh_seconds() - start;
  return GH_OK;
}

/* Appends the contact of the pair if it touches, and adds its force to the grains. */
static gh_status add_contact(native *e, const gh_pair *p, size_t *count) {
  double l[2] = {e->x[2 * p->j] - e->x[2 * p->i] + p->shift[0],
                 e->x[2 * p->j + 1] - e->x[2 * p->i + 1] + p->shift[1]};
  double d = sqrt(l[0] * l[0] + l[1] * l[1]), overlap = p->reach - d;
  if (overlap < 0) return GH_OK;
  if (!(d > 0))
    return gh_fail(e->ctx, GH_DIVERGED,
                   "the centres of grains %d and %d coincide: their contact has no direction", p->i + 1,
                   p->j + 1);
  GH_TRY(gh_grow(e->ctx, *count + 1, sizeof(gh_contact), &e->contact_capacity, &e->contacts));
  gh_contact *c = &e->contacts[(*count)++];
  double factor = gh_normal_factor(e->E, overlap, d);
  *c = (gh_contact){.i = p->i,
                    .j = p->j,
                    .l = {l[0], l[1]},
                    .f = {factor * l[0], factor * l[1]},
                    .overlap = overlap,
                    .energy = gh_normal_energy(e->E, overlap)};
  gh_normal_hessian(e->E, overlap, d, l, 2, c->h);
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
  for (size_t p = 0; p < e->nb.npairs;
       p++) { /* a grain's own images come between its pairs with smaller and larger j */
    for (; own < e->nb.nown && e->nb.own[own].i <= e->nb.pairs[p].i; own++)
      GH_TRY(add_contact(e, &e->nb.own[own], &n));
    GH_TRY(add_contact(e, &e->nb.pairs[p], &n));
  }
  for (; own < e->nb.nown; own++) GH_TRY(add_contact(e, &e->nb.own[own], &n));
  *list = (gh_contact_list){.count = (int)n, .contacts = e->contacts, .force = e->f};
  e->cost.evaluations++;
  e->cost.contact_seconds += gh_seconds() - start;
  return GH_OK;
}

static gh_status native_get(void *self, double *x, double *theta) {
  (void)theta;
  const native *e = self;
  memcpy(x, e->x, 2 * (size_t)e->n * sizeof(double));
  return GH_OK;
}

static void native_costs(const void *self, gh_engine_cost *cost) {
  *cost = ((const native *)self)->cost;
}

const gh_engine_ops gh_native_ops = {.name = "native",
                                     .create = native_create,
                                     .destroy = native_destroy,
                                     .set = native_set,
                                     .move = native_move,
                                     .relax = native_relax,
                                     .contacts = native_contacts,
                                     .get = native_get,
                                     .costs = native_costs};
