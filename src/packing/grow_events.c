/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Growth: what comes next for a grain, and what happens then (3.5)-(3.9). */
#include "packing/grow.h"

enum {
  LOOK_AT_CLOCK = 4096, /* events, some milliseconds */
  TOO_MUCH = 8
}; /* work over the cost of a list after which a grain that never leaves gets a thinner hull */

static void advance(grain *p, double t) {
  for (int k = 0; k < DIM; k++) p->x[k] += p->v[k] * (t - p->t);
  p->t = t;
}

/* Time until grain i reaches its hull from inside: |x - home| = reach - r, where r grows. */
static double leaving(const growth *g, int i) {
  const grain *p = &g->grain[i];
  const hull *a = &g->hull[i];
  double d[DIM], growth = p->a * g->rate, room = a->reach - p->a * (g->s0 + g->rate * p->t);
  for (int k = 0; k < DIM; k++) d[k] = p->x[k] - a->home[k];
  double u = dot(d, p->v) + room * growth, v = dot(p->v, p->v) - growth * growth, w = dot(d, d) - room * room;
  if (w >= 0) return 0;
  double q = u * u - v * w;
  double root = q < 0 ? INFINITY : u > 0 ? -w / (u + sqrt(q)) : (sqrt(q) - u) / v;
  double full = room / growth;                  /* the grain fills its hull */
  return root > 0 && root < full ? root : full; /* v <= 0 with u <= 0: no root, or one behind */
}

/* In large packings two events in sequence are far apart in memory, and waiting for it takes longer than the
 * work. So what an event reads is fetched while its grain rises to the top of the queue. */
static void foresee(growth *g) {
  int *risen = g->queue.risen;
  if (risen[2] >= 0) {
    __builtin_prefetch(&g->list[risen[2]]);
    __builtin_prefetch(&g->grain[risen[2]]);
    __builtin_prefetch(&g->hull[risen[2]]);
  }
  if (risen[1] >= 0) {
    const list *a = &g->list[risen[1]];
    for (int k = 0; k < a->n; k += 8) __builtin_prefetch(&a->entry[k]);
  }
  if (risen[0] >= 0) {
    const list *a = &g->list[risen[0]];
    for (int k = 0; k < a->n; k++) __builtin_prefetch(&g->grain[a->entry[k].j]);
  }
  risen[0] = risen[1] = risen[2] = -1;
}

static void set(growth *g, int i, double t, int partner, int image) {
  g->event[i] = (event){t, partner, image};
  heap_set(&g->queue, i, t);
  foresee(g);
}

/* The earliest of: leave, the collision that is already entered, and a collision with a neighbour before that
 * one's own event. (After its event, that neighbour looks for its next and finds i.) Grain i's clock must be
 * at g->now. */
static void predict(growth *g, int i) {
  const grain *p = &g->grain[i];
  list *a = &g->list[i];
  const event old = g->event[i];
  event next = {0, LEAVE, HERE};
  double now = g->now, s = g->s0 + g->rate * now, best = leaving(g, i);
  if (old.partner >= 0 && old.when - now < best) next = old, best = old.when - now;
  a->work += a->n;
  for (int k = 0; k < a->n; k++) {
    int j = a->entry[k].j, m = (int)a->entry[k].image;
    const grain *q = &g->grain[j];
    const double *shift = g->box.shift[m];
    double l[DIM], dv[DIM], late = now - q->t, sum = p->a + q->a;
    for (int d = 0; d < DIM; d++) {
      l[d] = q->x[d] + q->v[d] * late + shift[d] - p->x[d];
      dv[d] = q->v[d] - p->v[d];
    }
    approach ahead = approach_of(l, dv, sum * s, sum * g->rate);
    if (!meets_before(ahead, best)) continue;
    double t = meeting(ahead);
    if (t < best && now + t < g->event[j].when) best = t, next = (event){t, j, m};
  }
  if (old.partner >= 0 && old.partner != next.partner) g->event[old.partner].partner = CHECK;
  if (next.partner >= 0 && (next.partner != old.partner || next.image != old.image)) {
    int j = next.partner, third = g->event[j].partner;
    if (third >= 0 && third != i) g->event[third].partner = CHECK;
    set(g, j, now + best, i, IMAGES - 1 - next.image);
  }
  set(g, i, next.partner >= 0 ? g->event[next.partner].when : now + best, next.partner, next.image);
}

static void collide(growth *g, grain *p, grain *q, int image) {
  double n[DIM], length, vi, vj, mi = p->a, mj = q->a;
  for (int k = 0; k < DIM; k++) n[k] = q->x[k] + g->box.shift[image][k] - p->x[k];
  length = sqrt(dot(n, n));
  for (int k = 0; k < DIM; k++) n[k] /= length;
  for (int k = 1; k < DIM; k++) mi *= p->a, mj *= q->a;
  double oi = vi = dot(p->v, n), oj = vj = dot(q->v, n);
  impact(g->collision, p->a * g->rate, q->a * g->rate, mi, mj, &vi, &vj);
  for (int k = 0; k < DIM; k++) {
    p->v[k] += (vi - oi) * n[k];
    q->v[k] += (vj - oj) * n[k];
  }
}

static gh_status handle_collision(growth *g, int i) {
  int pair[2] = {i, g->event[i].partner}, image = g->event[i].image;
  for (int k = 0; k < 2; k++) advance(&g->grain[pair[k]], g->now);
  collide(g, &g->grain[pair[0]], &g->grain[pair[1]], image);
  g->collisions++;
  for (int k = 0; k < 2; k++) g->event[pair[k]] = (event){INFINITY, CHECK, HERE};
  for (int k = 0; k < 2; k++) {
    const list *a = &g->list[pair[k]];
    if (a->work > TOO_MUCH * growth_list_cost(a)) GH_TRY(growth_list2(g, pair[k]));
  }
  for (int k = 0; k < 2; k++) predict(g, pair[k]);
  return GH_OK;
}

gh_status growth_run2(growth *g, double end, double collisions) {
  for (unsigned events = 0; g->collisions < collisions; events++) {
    int i = g->queue.slot[0].i;
    if (events % LOOK_AT_CLOCK == LOOK_AT_CLOCK - 1 && growth_late(g)) return GH_OK;
    double t = g->event[i].when;
    if (!(t >= g->now))
      return gh_fail(g->ctx, GH_INTERNAL, "packing: an event of grain %d at %.17g lies before %.17g", i + 1,
                     t, g->now);
    if (t > end) {
      g->now = end;
      return GH_OK;
    }
    g->now = t;
    if (g->event[i].partner >= 0) {
      GH_TRY(handle_collision(g, i));
      continue;
    }
    advance(&g->grain[i], t);
    g->event[i].when = INFINITY;
    if (g->event[i].partner == LEAVE) {
      g->leaves++;
      GH_TRY(growth_list2(g, i));
    } else g->checks++;
    predict(g, i);
  }
  return GH_OK;
}

gh_status growth_sync2(growth *g) {
  double mean[DIM] = {0}, square = 0;
  for (int i = 0; i < g->n; i++) {
    advance(&g->grain[i], g->now);
    for (int k = 0; k < DIM; k++) mean[k] += g->grain[i].v[k] / g->n;
  }
  for (int i = 0; i < g->n; i++) {
    for (int k = 0; k < DIM; k++) g->grain[i].v[k] -= mean[k];
    square += dot(g->grain[i].v, g->grain[i].v) / g->n;
  }
  double scale = 1 / sqrt(square);
  g->s0 += g->rate * g->now;
  g->now = 0;
  for (int k = 0; k < g->levels; k++) g->level[k].reach = 0;
  for (int i = 0; i < g->n; i++) {
    grain *p = &g->grain[i];
    level *l = &g->level[g->in_level[i]];
    for (int k = 0; k < DIM; k++) p->v[k] *= scale;
    if (!gh_finite(p->x, DIM) || !gh_finite(p->v, DIM))
      return gh_fail(g->ctx, GH_INTERNAL, "packing: the place or velocity of grain %d is not finite", i + 1);
    p->t = 0;
    g->event[i] = (event){0, CHECK, HERE};
    if (g->levels) l->reach = fmax(l->reach, g->hull[i].reach);
  }
  heap_level(&g->queue, 0);
  return GH_OK;
}

double growth_scale2(const growth *g) {
  double scale = 1, s = g->s0 + g->rate * g->now;
  for (int i = 0; i < g->n; i++)
    for (int k = 0; k < g->list[i].n; k++) {
      const neighbour *e = &g->list[i].entry[k];
      double l[DIM];
      for (int d = 0; d < DIM; d++) l[d] = g->grain[e->j].x[d] + g->box.shift[e->image][d] - g->grain[i].x[d];
      scale = fmin(scale, sqrt(dot(l, l)) / ((g->grain[i].a + g->grain[e->j].a) * s));
    }
  return scale;
}
