/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A body of grains: made, looked at, saved and loaded. */
#include "direct/internal.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static void state_free(direct_state *s) {
  free(s->x);
  free(s->theta);
  free(s->slips.slips);
}

void gh_direct_destroy(gh_direct **direct) {
  if (!direct || !*direct) return;
  gh_direct *d = *direct;
  gh_engine_destroy(&d->engine);
  gh_packing_destroy(&d->body);
  outline_destroy(&d->outline);
  chain_destroy(&d->chain);
  outline_destroy(&d->exposed);
  free(d->moved.X);
  state_free(&d->now);
  state_free(&d->trial);
  void *const arrays[] = {d->nearest,  d->element, d->weight,        d->boundary,     d->mask,     d->held,
                          d->u,        d->dead,    d->kept,          d->follow,       d->reaction, d->outside,
                          d->load,     d->support, d->cauchy,        d->coordination, d->rattler,  d->degree,
                          d->identity, d->flags,   d->pressure_dead, d->joined};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  free(d);
  *direct = NULL;
}

static gh_status state_create(gh_direct *d, direct_state *s) {
  GH_TRY(gh_alloc(d->ctx, 2 * (size_t)d->n, sizeof *s->x, &s->x));
  memcpy(s->x, d->body->x, 2 * (size_t)d->n * sizeof *s->x);
  return direct_friction(d) ? gh_alloc(d->ctx, (size_t)d->n, sizeof *s->theta, &s->theta) : GH_OK;
}

static gh_status arrays_create(gh_direct *d) {
  const size_t n = (size_t)d->n, nodes = (size_t)d->mesh->nnodes, elements = (size_t)d->mesh->nelements;
  double **const twice[] = {&d->dead, &d->kept, &d->reaction, &d->outside, &d->load};
  for (size_t k = 0; k < sizeof twice / sizeof *twice; k++)
    GH_TRY(gh_alloc(d->ctx, 2 * n, sizeof(double), twice[k]));
  unsigned char **const flags[] = {&d->boundary, &d->mask, &d->held, &d->rattler, &d->flags};
  for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) GH_TRY(gh_alloc(d->ctx, n, 1, flags[k]));
  GH_TRY(gh_alloc(d->ctx, n, sizeof(int), &d->element));
  GH_TRY(gh_alloc(d->ctx, n, sizeof(int), &d->degree));
  GH_TRY(gh_alloc(d->ctx, n, sizeof(int), &d->joined));
  GH_TRY(gh_alloc(d->ctx, n, sizeof(int), &d->identity));
  GH_TRY(gh_alloc(d->ctx, n, sizeof(double), &d->weight));
  GH_TRY(gh_alloc(d->ctx, 3 * n, sizeof(double), &d->support));
  GH_TRY(gh_alloc(d->ctx, nodes, sizeof(int), &d->nearest));
  GH_TRY(gh_alloc(d->ctx, 2 * nodes, sizeof(double), &d->u));
  GH_TRY(gh_alloc(d->ctx, (size_t)d->outline.nedges, sizeof(double), &d->pressure_dead));
  GH_TRY(gh_alloc(d->ctx, (size_t)d->outline.nedges, sizeof(double), &d->follow));
  GH_TRY(gh_alloc(d->ctx, 4 * elements, sizeof(double), &d->cauchy));
  GH_TRY(gh_alloc(d->ctx, elements, sizeof(double), &d->coordination));
  GH_TRY(state_create(d, &d->now));
  return state_create(d, &d->trial);
}

/* Which grains are on the boundary, which of them is nearest to a node, and what area each stands for. */
static void grains_mark(gh_direct *d) {
  double all = 0;
  for (int k = 0; k < d->chain.nmembers; k++) d->boundary[d->chain.member[k].grain] = 1;
  for (int a = 0; a < d->mesh->nnodes; a++) {
    double nearest = INFINITY;
    for (int k = 0; k < d->chain.nmembers; k++) {
      const int q = d->chain.member[k].grain;
      const double off =
          hypot(d->body->x[2 * q] - d->mesh->X[2 * a], d->body->x[2 * q + 1] - d->mesh->X[2 * a + 1]);
      if (off < nearest) nearest = off, d->nearest[a] = q;
    }
  }
  for (int q = 0; q < d->n; q++) all += d->body->radius[q] * d->body->radius[q];
  for (int q = 0; q < d->n; q++) {
    d->weight[q] = d->outline.area * d->body->radius[q] * d->body->radius[q] / all;
    d->identity[q] = q + 1;
    for (int i = 0; i < 2; i++) d->extent = fmax(d->extent, fabs(d->body->x[2 * q + i]));
  }
  d->mean_radius = gh_packing_mean_radius(d->body);
}

/* Each edge of a set needs a grain that bears it. */
static gh_status sets_check(const gh_direct *d) {
  if (!memchr(d->boundary, 0, (size_t)d->n))
    return gh_fail(d->ctx, GH_INPUT, "all %d grains lie on the outline: the grains are too large for it",
                   d->n);
  for (int set = 0; set < d->nsets; set++) {
    const gh_mesh_set *s = d->mesh->sets + set;
    bool outer = false, borne = false;
    for (int k = 0; k < s->nedges; k++)
      for (int e = 0; e < d->outline.nedges; e++)
        outer = outer || (d->outline.edge[e].a == s->edges[k][0] && d->outline.edge[e].b == s->edges[k][1]);
    for (int p = 0; p < d->chain.nmembers && !borne; p++) {
      const outline_edge *e = d->outline.edge + d->chain.member[p].edge;
      for (int k = 0; k < s->nedges && !borne; k++) borne = s->edges[k][0] == e->a && s->edges[k][1] == e->b;
    }
    if (outer && !borne)
      return gh_fail(d->ctx, GH_INPUT, "no grain lies on the edge '%s': the grains are too large for it",
                     s->name);
  }
  return GH_OK;
}

gh_status gh_direct_create(gh_context *ctx, const gh_mesh *mesh, int nsets, const gh_packing *body,
                           const gh_direct_options *options, gh_direct **direct) {
  gh_status status;
  *direct = NULL;
  GH_TRY(gh_contact_law_check(ctx, &options->law));
  gh_direct *d;
  GH_TRY(gh_alloc(ctx, 1, sizeof *d, &d));
  d->ctx = ctx, d->mesh = mesh, d->nsets = nsets, d->options = *options, d->n = body->n;
  GH_TRY_OR(gh_packing_copy(ctx, body, &d->body), failed);
  GH_TRY_OR(outline_create(ctx, mesh, &d->outline), failed);
  GH_TRY_OR(chain_create(ctx, &d->outline, d->body, &d->chain), failed);
  d->moved = *mesh;
  GH_TRY_OR(gh_alloc(ctx, 2 * (size_t)mesh->nnodes, sizeof(double), &d->moved.X), failed);
  memcpy(d->moved.X, mesh->X, 2 * (size_t)mesh->nnodes * sizeof(double));
  GH_TRY_OR(outline_create(ctx, &d->moved, &d->exposed), failed);
  GH_TRY_OR(arrays_create(d), failed);
  grains_mark(d);
  GH_TRY_OR(sets_check(d), failed);
  GH_TRY_OR(direct_locate(d), failed);
  *direct = d;
  return GH_OK;
failed:
  gh_direct_destroy(&d);
  return status;
}

/* ---- what is seen from outside ---- */

void gh_direct_zero(gh_direct *d) {
  d->m.outer_work = 0;
  d->zero_energy = d->energy, d->zero_dissipated = d->now.dissipated;
  d->m.energy = d->m.dissipation = 0;
}

const gh_direct_measures *gh_direct_measure(const gh_direct *d) {
  return &d->m;
}

const double *gh_direct_u(const gh_direct *d) {
  return d->u;
}

const double *gh_direct_cauchy(const gh_direct *d) {
  return d->cauchy;
}

const double *gh_direct_coordination(const gh_direct *d) {
  return d->coordination;
}

static bool set_has(const gh_mesh_set *s, const outline_edge *e) {
  for (int k = 0; k < s->nedges; k++)
    if (s->edges[k][0] == e->a && s->edges[k][1] == e->b) return true;
  return false;
}

static bool set_bears(const gh_direct *d, const gh_mesh_set *s, const chain_member *m) {
  if (set_has(s, d->outline.edge + m->edge)) return true;
  for (int k = 0; k < s->nnodes && s->nedges == 0; k++)
    if (d->nearest[s->nodes[k]] == m->grain) return true;
  return false;
}

/* A grain that is on two sides of one set counts once. */
void gh_direct_reaction(const gh_direct *d, int set, double sum[2]) {
  const gh_mesh_set *s = d->mesh->sets + set;
  sum[0] = sum[1] = 0;
  for (int k = 0; k < d->chain.nmembers; k++) {
    const chain_member *m = d->chain.member + k;
    bool before = !set_bears(d, s, m);
    for (int j = 0; j < k && !before; j++)
      before = d->chain.member[j].grain == m->grain && set_bears(d, s, d->chain.member + j);
    for (int i = 0; i < 2 && !before; i++) sum[i] += d->reaction[2 * m->grain + i];
  }
  for (int q = 0; q < d->n; q++) {
    if (!d->joined[q] || !set_has(s, d->outline.edge + d->joined[q] - 1)) continue;
    bool before = false;
    for (int k = 0; k < d->chain.nmembers && !before; k++)
      before = d->chain.member[k].grain == q && set_bears(d, s, d->chain.member + k);
    for (int i = 0; i < 2 && !before; i++) sum[i] += d->reaction[2 * q + i];
  }
}

void gh_direct_look(const gh_direct *d, gh_rve_view *v) {
  for (int q = 0; q < d->n; q++) {
    d->flags[q] = (unsigned char)(d->rattler[q] | (d->mask[q] ? 2 : 0) | (d->boundary[q] ? 8 : 0));
    d->support[3 * q] = d->outside[2 * q], d->support[3 * q + 1] = d->outside[2 * q + 1];
    d->support[3 * q + 2] = 0;
  }
  *v = (gh_rve_view){.n = d->n,
                     .ncontacts = d->list.count,
                     .x = d->now.x,
                     .radius = d->body->radius,
                     .grain = d->identity,
                     .type = d->body->type,
                     .id = d->identity,
                     .flags = d->flags,
                     .contacts = d->list.contacts,
                     .friction = d->list.friction,
                     .theta = d->now.theta,
                     .support = d->support};
}

/* ---- states as numbers ---- */

enum { SOLVED, SLIPS, DISSIPATED, PRESSURE, ENERGY, ZERO_ENERGY, ZERO_DISSIPATED, WORK, NUMBERS, SLIP = 5 };

static size_t state_size(const gh_direct *d, int slips) {
  const size_t n = (size_t)d->n;
  return NUMBERS + 2 * (size_t)d->mesh->nnodes + 2 * (size_t)d->outline.nedges + 2 * 5 * n + 2 * n +
         (direct_friction(d) ? n + SLIP * (size_t)slips : 0);
}

size_t gh_direct_state_size(const gh_direct *d) {
  return state_size(d, d->now.slips.count);
}

typedef struct state_array {
  double *at;
  size_t size;
} state_array;
enum { ARRAYS = 9 };

static int state_arrays(const gh_direct *d, state_array list[ARRAYS]) {
  const size_t n = (size_t)d->n;
  const state_array all[ARRAYS] = {{d->u, 2 * (size_t)d->mesh->nnodes},
                                   {d->follow, (size_t)d->outline.nedges},
                                   {d->pressure_dead, (size_t)d->outline.nedges},
                                   {d->now.x, 2 * n},
                                   {d->dead, 2 * n},
                                   {d->kept, 2 * n},
                                   {d->reaction, 2 * n},
                                   {d->outside, 2 * n},
                                   {d->now.theta, direct_friction(d) ? n : 0}};
  memcpy(list, all, sizeof all);
  return ARRAYS;
}

void gh_direct_save(const gh_direct *d, double *to) {
  state_array list[ARRAYS];
  const double numbers[NUMBERS] = {d->solved, d->now.slips.count, d->now.dissipated,  d->pressure,
                                   d->energy, d->zero_energy,     d->zero_dissipated, d->m.outer_work};
  memcpy(to, numbers, sizeof numbers);
  to += NUMBERS;
  for (int k = 0, n = state_arrays(d, list); k < n; k++) {
    if (list[k].size) memcpy(to, list[k].at, list[k].size * sizeof *to);
    to += list[k].size;
  }
  for (int i = 0; i < d->n; i++) *to++ = d->mask[i];
  for (int i = 0; i < d->n; i++) *to++ = d->joined[i];
  for (int c = 0; c < d->now.slips.count && direct_friction(d); c++, to += SLIP) {
    const gh_slip *q = d->now.slips.slips + c;
    memcpy(to, (double[SLIP]){q->i, q->j, q->gamma, q->gamma_pl, q->alpha}, SLIP * sizeof *to);
  }
}

gh_status gh_direct_load(gh_direct *d, const double *from, size_t size) {
  state_array list[ARRAYS];
  if (size < state_size(d, 0) || !gh_finite(from, size) || !(from[SLIPS] >= 0) || !(from[SLIPS] < INT_MAX) ||
      size != state_size(d, (int)from[SLIPS]))
    return gh_fail(d->ctx, GH_INPUT, "the state to load has %zu numbers, which does not fit this body", size);
  direct_slips *s = &d->now.slips;
  s->count = (int)from[SLIPS];
  GH_TRY(gh_grow(d->ctx, (size_t)s->count + 1, sizeof *s->slips, &s->capacity, &s->slips));
  d->solved = from[SOLVED] > 0, d->now.dissipated = from[DISSIPATED], d->pressure = from[PRESSURE];
  d->energy = from[ENERGY], d->zero_energy = from[ZERO_ENERGY], d->zero_dissipated = from[ZERO_DISSIPATED];
  d->m.outer_work = from[WORK];
  from += NUMBERS;
  for (int k = 0, n = state_arrays(d, list); k < n; k++) {
    if (list[k].size) memcpy(list[k].at, from, list[k].size * sizeof *from);
    from += list[k].size;
  }
  for (int i = 0; i < d->n; i++) d->mask[i] = (unsigned char)*from++;
  for (int i = 0; i < d->n; i++) d->joined[i] = (int)*from++;
  for (int c = 0; c < s->count; c++, from += SLIP)
    s->slips[c] = (gh_slip){
        .i = (int)from[0], .j = (int)from[1], .gamma = from[2], .gamma_pl = from[3], .alpha = from[4]};
  gh_engine_destroy(&d->engine);
  return GH_OK;
}
