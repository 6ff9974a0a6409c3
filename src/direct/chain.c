/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Boundary grains: those that a probe touches when it comes from outside along the normal of a side. */
#include "direct/outline.h"

#include <stdlib.h>
#include <string.h>

static const double probe = 0.5;      /* radius over the mean radius */
static const double fineness = 0.125; /* distance of the places it is let down at, over the mean radius */
static const double deep = 6;         /* depth of grains that are looked at, over the largest radius */

/* Where a grain lies on the side, and how near a probe's centre comes to its own. */
typedef struct profile_grain {
  double s, depth, reach;
} profile_grain;

typedef struct profile {
  int count;
  double spacing, *height; /* of the probe: along the inward normal */
  int *grain;              /* that stops it; -1: none */
  profile_grain *at;       /* of all grains */
} profile;

static double height_at(const profile_grain *g, double s) {
  const double t = s - g->s, h2 = g->reach * g->reach - t * t;
  return h2 >= 0 ? g->depth - sqrt(h2) : INFINITY;
}

/* Where the probe passes from one grain, at s0, to another, at s1: a continuous function of their places. */
static double profile_pass(const profile *f, int from, int to, double s0, double s1) {
  for (int k = 0; k < 50 && s1 - s0 > 1e-15 * s1; k++) {
    const double middle = (s0 + s1) / 2;
    if (height_at(f->at + from, middle) <= height_at(f->at + to, middle)) s0 = middle;
    else s1 = middle;
  }
  return (s0 + s1) / 2;
}

/* A grain stops the probe at the places that it covers, unless another one does before. */
static void profile_add(profile *f, int grain, const outline_place *at, double reach) {
  const profile_grain g = {at->s + at->beyond, at->depth, reach};
  const int first = (int)ceil((g.s - reach) / f->spacing - 0.5),
            last = (int)floor((g.s + reach) / f->spacing - 0.5);
  f->at[grain] = g;
  for (int k = first < 0 ? 0 : first; k <= last && k < f->count; k++) {
    const double height = height_at(&g, (k + 0.5) * f->spacing);
    if (height < f->height[k]) f->height[k] = height, f->grain[k] = grain;
  }
}

static gh_status profile_create(gh_context *ctx, double length, double spacing, int grains, profile *f) {
  *f = (profile){.count = (int)ceil(length / spacing)};
  f->spacing = length / f->count;
  GH_TRY(gh_alloc(ctx, (size_t)f->count, sizeof *f->height, &f->height));
  GH_TRY(gh_alloc(ctx, (size_t)f->count, sizeof *f->grain, &f->grain));
  GH_TRY(gh_alloc(ctx, (size_t)grains, sizeof *f->at, &f->at));
  for (int k = 0; k < f->count; k++) f->height[k] = INFINITY, f->grain[k] = -1;
  return GH_OK;
}

static int member_compare(const void *p, const void *q) {
  const chain_member *a = p, *b = q;
  if (a->s != b->s) return a->s < b->s ? -1 : 1;
  return (a->grain > b->grain) - (a->grain < b->grain);
}

static int member_find(const chain *c, int first, int grain) {
  for (int k = first; k < c->nmembers; k++)
    if (c->member[k].grain == grain) return k;
  return -1;
}

static gh_status member_add(gh_context *ctx, const outline *o, int side, const gh_packing *body, int grain,
                            int first, chain *c) {
  if (member_find(c, first, grain) >= 0) return GH_OK;
  const double *X = body->x + 2 * grain;
  const outline_place at = outline_project(o, o->side + side, X);
  const outline_edge *e = o->edge + at.edge;
  const double *A = o->mesh->X + 2 * e->a, t = at.s - e->start;
  GH_TRY(gh_grow(ctx, (size_t)c->nmembers + 1, sizeof *c->member, &c->member_capacity, &c->member));
  c->member[c->nmembers++] =
      (chain_member){.grain = grain,
                     .side = side,
                     .edge = at.edge,
                     .s = at.s,
                     .share = t / e->length,
                     .offset = {X[0] - A[0] - t * e->along[0], X[1] - A[1] - t * e->along[1]}};
  return GH_OK;
}

/* The part of a side from s0 to s1, by edges. */
static gh_status pieces_add(gh_context *ctx, const outline *o, const outline_side *side, int member,
                            double s0, double s1, chain *c) {
  for (int k = side->first; k < side->first + side->count; k++) {
    const outline_edge *e = o->edge + k;
    const double length = fmin(s1, e->start + e->length) - fmax(s0, e->start);
    if (!(length > 0)) continue;
    GH_TRY(gh_grow(ctx, (size_t)c->npieces + 1, sizeof *c->piece, &c->piece_capacity, &c->piece));
    c->piece[c->npieces++] = (chain_piece){member, k, length};
  }
  return GH_OK;
}

/* Each member bears the places where it stops the probe; where nothing does, those of its neighbour. */
static gh_status side_divide(gh_context *ctx, const outline *o, int side, const profile *f, int first,
                             chain *c) {
  int bearer = -1;
  double from = 0;
  for (int k = 0; k < f->count && bearer < 0; k++) bearer = f->grain[k];
  for (int k = 0; k < f->count;) {
    while (k < f->count && (f->grain[k] < 0 || f->grain[k] == bearer)) k++;
    const int member = member_find(c, first, bearer);
    const chain_member *m = c->member + member;
    const double *outward = o->edge[m->edge].outward,
                 to = k < f->count ? profile_pass(f, bearer, f->grain[k], (k - 0.5) * f->spacing,
                                                  (k + 0.5) * f->spacing)
                                   : o->side[side].length;
    c->depth -= (m->offset[0] * outward[0] + m->offset[1] * outward[1]) * (to - from);
    GH_TRY(pieces_add(ctx, o, o->side + side, member, from, to, c));
    from = to;
    if (k < f->count) bearer = f->grain[k];
  }
  return GH_OK;
}

static gh_status side_create(gh_context *ctx, const outline *o, int side, const gh_packing *body, double mean,
                             double largest, chain *c) {
  profile f;
  const int first = c->nmembers;
  const double extra = probe * mean;
  gh_status status;
  GH_TRY_OR(profile_create(ctx, o->side[side].length, fineness * mean, body->n, &f), done);
  for (int i = 0; i < body->n; i++) {
    const outline_place at = outline_project(o, o->side + side, body->x + 2 * i);
    if (fabs(at.depth) <= deep * largest && fabs(at.beyond) <= largest)
      profile_add(&f, i, &at, body->radius[i] + extra);
  }
  for (int k = 0, last = -1; k < f.count; k++) {
    if (f.grain[k] < 0 || f.grain[k] == last) continue;
    GH_TRY_OR(member_add(ctx, o, side, body, last = f.grain[k], first, c), done);
  }
  const outline_edge *e = o->edge + o->side[side].first;
  if (c->nmembers == first) {
    status = gh_fail(ctx, GH_INPUT,
                     "no grain lies on the outline from (%g, %g) on: the grains are too large for it",
                     o->mesh->X[2 * e->a], o->mesh->X[2 * e->a + 1]);
    goto done;
  }
  qsort(c->member + first, (size_t)(c->nmembers - first), sizeof *c->member, member_compare);
  status = side_divide(ctx, o, side, &f, first, c);
done:
  free(f.height);
  free(f.grain);
  free(f.at);
  return status;
}

gh_status chain_create(gh_context *ctx, const outline *o, const gh_packing *body, chain *c) {
  const double mean = gh_packing_mean_radius(body);
  double largest = 0, length = 0;
  *c = (chain){0};
  for (int i = 0; i < body->n; i++) largest = fmax(largest, body->radius[i]);
  for (int side = 0; side < o->nsides; side++) {
    GH_TRY(side_create(ctx, o, side, body, mean, largest, c));
    length += o->side[side].length;
  }
  c->depth /= length;
  return GH_OK;
}

void chain_destroy(chain *c) {
  free(c->member);
  free(c->piece);
  *c = (chain){0};
}
