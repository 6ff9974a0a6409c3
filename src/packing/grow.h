/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Event-driven growth: the grains, their clocks, their neighbours.
 *
 * Lengths are those of a cell of volume 1; the speed is 1 in the root mean square. All radii are known from
 * one number: r_i(t) = a_i s(t), s = s0 + rate t (3.1), and a_i is scaled so that the volume fraction is
 * s^DIM.
 *
 * Each grain has a clock of its own: x is its place at its time t, and between two of its events nobody
 * touches it. Each grain has one event in the queue. A collision is entered under both partners. A grain
 * whose partner found an earlier collision keeps its time, as a check: nothing can happen to it before.
 *
 * Neighbours. A grain has a hull, a sphere about its place `home` in which it stays until its event "leave";
 * it lists those whose hulls meet its own. So a list changes only by an event of one of its owners. The
 * hull's thickness follows the work that the list makes, so that it stays cheap for any ratio of the sizes.
 * Hulls are found by grids of cells, one grid for each power of two of the size.
 *
 * This header is compiled with DIM 2 or 3 (packing/to3.h). */
#ifndef GRANHOM_PACKING_GROW_H
#define GRANHOM_PACKING_GROW_H

#include "granhom/packing.h"
#include "packing/heap.h"

#ifndef DIM
#define DIM 2
#endif

enum {
  FAR = 2, /* images reach this many cells away: hulls are smaller than the cell */
  SPAN = 2 * FAR + 1,
  IMAGES = DIM == 2 ? SPAN * SPAN : SPAN * SPAN * SPAN,
  HERE = IMAGES / 2, /* the image that is the grain itself; the opposite of image m is IMAGES - 1 - m */
  MAX_LEVELS = 32,
  MAX_GRAINS = 1 << 25 /* neighbour.back */
};
/* What stands for the partner in events that have none. */
enum { LEAVE = -1, CHECK = -2 };

typedef struct grain { /* one cache line: an event reads it for each neighbour */
  _Alignas(64) double x[DIM];
  double v[DIM], t, a;
} grain;

typedef struct event {
  double when;        /* INFINITY while it is being sought */
  int partner, image; /* partner's image that is met */
} event;

typedef struct neighbour { /* small, since large packings are bound by the memory's speed */
  int j;
  unsigned image : 7; /* grain j shifted by this image */
  unsigned back : 25; /* where j's list has the mirrored entry */
} neighbour;

typedef struct list {
  neighbour *entry;
  int n, capacity, work; /* work: entries looked at since the list was made */
  double shell;          /* its hull is thicker than the grain was by this */
} list;

typedef struct hull { /* apart from the list, since searches read many hulls */
  double home[DIM], reach;
} hull;

typedef struct level { /* a grid of cells for grains with a in (a_max / 2, a_max] */
  double a_max, reach; /* reach: of its largest hull */
  int m[DIM], *head;
} level;

typedef struct box {
  double cell[DIM][DIM], inverse[DIM][DIM], height[DIM]; /* cell: upper triangular, columns span it */
  double shift[IMAGES][DIM];
} box;

typedef struct growth {
  gh_context *ctx;
  int n, levels;
  int *id; /* place of each grain in the input: neighbours in space are made neighbours in memory */
  grain *grain;
  list *list;
  hull *hull;
  event *event;
  heap queue;
  level level[MAX_LEVELS];
  int *in_level, *in_cell, *next, *previous; /* cell of each home, as linked lists */
  void *memory; /* all these arrays but the grids, and the first entries of all lists */
  box box;
  gh_collision collision;
  double s0, rate, now;
  double collisions, leaves, checks;
  double deadline; /* gh_seconds() at which growth shall stop; INFINITY: never */
  bool late;       /* it has come */
} growth;

static inline bool growth_late(growth *g) {
  g->late = g->late || gh_seconds() >= g->deadline;
  return g->late;
}

/* Cost of making a list, in entries looked at by predictions (about 10 ns each). */
static inline double growth_list_cost(const list *a) {
  return 100 + 10.0 * a->n;
}

/* ---- grow_lists.c ---- */
/* Scales the shape (row-major DIM x DIM, upper triangular) to the volume 1, with the least tilt. */
void growth_box_fit2(const double *shape, box *b);
gh_status growth_create2(gh_context *ctx, int n, const double *diameter, growth **g);
void growth_destroy2(growth **g);
/* Puts grain i into the cell, gives it a new hull and list. Its clock must be at g->now. */
gh_status growth_list2(growth *g, int i);
gh_status growth_list_all2(growth *g);
/* Orders the grains along a curve through the cell and lists them again. Clocks at g->now, events checks. */
gh_status growth_order2(growth *g);

/* ---- grow_events.c ---- */
/* Handles events up to the time `end`, until there were `collisions` in all, or until the deadline (g->late).
 * GH_INTERNAL: an event in the past. */
gh_status growth_run2(growth *g, double end, double collisions);
/* Brings all clocks to g->now and calls that time 0; takes the mean velocity out, sets its root mean square
 * to 1; all events become checks. GH_INTERNAL when a number is not finite. */
gh_status growth_sync2(growth *g);
/* Largest factor <= 1 on all radii with which no two grains overlap; clocks at the same time. */
double growth_scale2(const growth *g);

static inline double dot(const double *a, const double *b) {
  double sum = 0;
  for (int k = 0; k < DIM; k++) sum += a[k] * b[k];
  return sum;
}

/* (3.5)-(3.8): two spheres at the distance l, with relative velocity dv and the sum of radii sigma growing at
 * the rate `growth`, are v t^2 + 2 u t + w apart (squares of distances). */
typedef struct approach {
  double u, v, w;
} approach;

static inline approach approach_of(const double *l, const double *dv, double sigma, double growth) {
  return (approach){dot(l, dv) - sigma * growth, dot(dv, dv) - growth * growth, dot(l, l) - sigma * sigma};
}

/* Whether they may touch before the time t > 0: without branches, since most neighbours are turned down here.
 */
static inline int meets_before(approach a, double t) {
  double end = (a.v * t + 2 * a.u) * t + a.w;
  return (end < 0) | ((a.u < 0) & (a.v * t + a.u > 0) & (a.u * a.u >= a.v * a.w));
}

/* Time until they touch; 0 when they touch and approach; INFINITY when they never do. The root is taken in
 * the form without cancellation. */
static inline double meeting(approach a) {
  double q = a.u * a.u - a.v * a.w;
  if (a.u < 0) {
    if (a.w <= 0) return 0;
    return q < 0 ? INFINITY : a.w / (sqrt(q) - a.u);
  }
  if (a.v >= 0) return INFINITY;
  return (a.u + sqrt(fmax(q, 0))) / -a.v; /* they part, but growth catches up */
}

/* Normal velocities, along the branch vector from i to j, after the contact of grains with growth rates gi,
 * gj and masses mi, mj. */
static inline void impact(gh_collision rule, double gi, double gj, double mi, double mj, double *vi,
                          double *vj) {
  double a = *vi, b = *vj;
  if (rule == GH_COLLISION_EXCHANGE) { /* (3.9) */
    *vi = fmin(a, b) - gi;
    *vj = fmax(a, b) + gj;
  } else { /* the surfaces part as fast as they met; never slower than a part of their growth, so that time
              advances */
    double part = fmax(a - b + gi + gj, 1e-9 * (gi + gj)) + gi + gj;
    double mean = (mi * a + mj * b) / (mi + mj);
    *vi = mean - mj / (mi + mj) * part;
    *vj = mean + mi / (mi + mj) * part;
  }
}

#endif
