/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Growth of a packing from points to the density where it stops (Table 3.1). */
#include "packing/grow.h"
#include "packing/random.h"

#include <stdlib.h>
#include <string.h>

/* Volume fraction at which a cell must have room for two of the largest grains, when no target is given:
 * about that of a random packing. */
static const double RANDOM_FRACTION = DIM == 2 ? 0.84 : 0.64;
/* Up to this volume fraction the grains are a fluid that forgets: they grow at least at the second rate. */
static const double FLUID_FRACTION = DIM == 2 ? 0.4 : 0.25, FLUID_RATE = 0.1;
static const double ORDER_GROWTH =
    0.1;                    /* of the radii, over those at volume fraction 1, between two orderings */
enum { ORDER_FROM = 2000 }; /* fewer grains stay in the cache anyway */
static const double SYNC_GROWTH = 0.1; /* velocities gain about this part of themselves between two syncs */

/* ---- input ---- */

static gh_status check_shape(gh_context *ctx, const double *shape) {
  for (int r = 0; r < DIM; r++)
    for (int c = 0; c < DIM; c++) {
      double value = shape[DIM * r + c];
      if (!isfinite(value) || (c == r && !(value > 0)) || (c < r && value != 0))
        return gh_fail(
            ctx, GH_INPUT,
            "packing: the cell's entry %d,%d is %g: upper triangular, with a positive diagonal, is wanted",
            r + 1, c + 1, value);
    }
  return GH_OK;
}

static gh_status check_options(gh_context *ctx, int n, const double *diameter, const gh_grow_options *o) {
  if (!(o->rate > 0) || !(o->rate <= 10))
    return gh_fail(ctx, GH_INPUT, "packing: the growth rate is %g; it must be above 0 and at most 10",
                   o->rate);
  if (!(o->window > 0) || !isfinite(o->window))
    return gh_fail(ctx, GH_INPUT, "packing: the window is %g collisions per grain; it must be above 0",
                   o->window);
  if (!(o->threshold >= 0) || !(o->threshold < 1))
    return gh_fail(ctx, GH_INPUT, "packing: the threshold is %g; it must be at least 0 and below 1",
                   o->threshold);
  if (!(o->seconds >= 0))
    return gh_fail(ctx, GH_INPUT, "packing: the time limit is %g seconds; it must be above 0", o->seconds);
  if (o->threshold == 0 && o->seconds == 0 && o->volume_fraction == 0)
    return gh_fail(ctx, GH_INPUT,
                   "packing: nothing stops the growth: a volume fraction, a threshold or a time "
                   "limit is wanted");
  double limit = gh_grow_limit(DIM, n, diameter);
  if (!(o->volume_fraction >= 0) || o->volume_fraction > limit)
    return gh_fail(
        ctx, GH_INPUT,
        "packing: the volume fraction %g is not possible: it must be above 0 and at most %.4f for grains "
        "of these sizes",
        o->volume_fraction, limit);
  return GH_OK;
}

static gh_status check_grains(gh_context *ctx, int n, const double *diameter) {
  if (n < 1) return gh_fail(ctx, GH_INPUT, "packing: %d grains; at least one is needed", n);
  if (n > MAX_GRAINS)
    return gh_fail(ctx, GH_INPUT, "packing: %d grains are too many, at most %d can be grown", n, MAX_GRAINS);
  for (int i = 0; i < n; i++)
    if (!(diameter[i] > 0) || !isfinite(diameter[i]))
      return gh_fail(ctx, GH_INPUT, "packing: grain %d has the diameter %g; it must be positive", i + 1,
                     diameter[i]);
  return GH_OK;
}

/* Two grains beside each other must not touch over two faces at once. */
static gh_status check_room(const growth *g, double fraction) {
  double largest = 0, height = INFINITY, s = pow(fraction, 1.0 / DIM);
  for (int i = 0; i < g->n; i++) largest = fmax(largest, 2 * g->grain[i].a * s);
  for (int k = 0; k < DIM; k++) height = fmin(height, g->box.height[k]);
  if (2 * largest > height)
    return gh_fail(
        g->ctx, GH_INPUT,
        "packing: the cell is too small for two neighbours: at a volume fraction of %.3g it is %.3g "
        "of the largest diameters high, and 2 are needed; take more grains or a squarer cell",
        fraction, height / largest);
  return GH_OK;
}

/* ---- growth ---- */

/* Random places, velocities uniform in a cube; radii 0. */
static void scatter(growth *g, unsigned long long seed) {
  for (int i = 0; i < g->n; i++) {
    double s[DIM];
    for (int k = 0; k < DIM; k++) s[k] = random_uniform(&seed);
    for (int k = 0; k < DIM; k++) g->grain[i].x[k] = dot(g->box.cell[k], s);
    for (int k = 0; k < DIM; k++) g->grain[i].v[k] = 2 * random_uniform(&seed) - 1;
  }
}

typedef struct course { /* where growth is in its stop rules */
  const gh_grow_options *o;
  double begin, target,
      sync; /* target: s at the wanted volume fraction; sync: collisions between two syncs */
  double window_begin, window_fraction; /* (3.11): collisions and volume fraction then */
  double mean, ordered;                 /* mean a; s at the last ordering */
  gh_work work;
  char label[64];
} course;

static double fraction_of(const growth *g) {
  return pow(g->s0 + g->rate * g->now, DIM);
}

/* Between two syncs: true when a stop rule holds. */
static bool stops(growth *g, course *c, gh_grow_stop *stop) {
  double fraction = fraction_of(g);
  snprintf(c->label, sizeof c->label, "volume fraction %.5f", fraction);
  gh_work_advance(g->ctx, &c->work, g->collisions);
  if (g->s0 + g->rate * g->now >= c->target) {
    *stop = GH_STOP_FRACTION;
    return true;
  }
  if (g->collisions - c->window_begin >= c->o->window * g->n) {
    double windows = (g->collisions - c->window_begin) / (c->o->window * g->n);
    if (fraction - c->window_fraction < c->o->threshold * windows) {
      *stop = GH_STOP_DRIED_UP;
      return true;
    }
    c->window_begin = g->collisions, c->window_fraction = fraction;
  }
  *stop = GH_STOP_TIME;
  return growth_late(g);
}

/* After a sync: the growth rate for the density, the memory in order. */
static gh_status settle(growth *g, course *c) {
  double fraction = fraction_of(g), rate = c->o->rate;
  if (fraction < FLUID_FRACTION) rate = fmax(rate, FLUID_RATE);
  g->rate = rate / (2 * c->mean);
  c->sync = g->n * fmin(fmax(SYNC_GROWTH / rate, 1), 50);
  if (g->n < ORDER_FROM || g->s0 < c->ordered + ORDER_GROWTH) return GH_OK;
  c->ordered = g->s0;
  return growth_order2(g);
}

static gh_status run(growth *g, course *c, gh_grow_stop *stop) {
  do {
    GH_TRY(growth_sync2(g));
    GH_TRY(settle(g, c));
    double end = (c->target - g->s0) / g->rate;
    double most = fmin(g->collisions + c->sync, c->window_begin + ceil(c->o->window * g->n));
    GH_TRY(growth_run2(g, end, most));
    if (!(fraction_of(g) < 1.01))
      return gh_fail(g->ctx, GH_INTERNAL, "packing: grown past the volume fraction 1");
  } while (!stops(g, c, stop));
  return GH_OK;
}

/* ---- result ---- */

/* The grains with the diameters asked for, and the cell that belongs to them. */
static gh_status give(growth *g, const double *diameter, const int *type, gh_grains **out) {
  gh_grains *p;
  size_t n = (size_t)g->n;
  GH_TRY(gh_alloc(g->ctx, 1, sizeof *p, &p));
  p->n = g->n, p->dim = DIM;
  gh_status status;
  GH_TRY_OR(gh_alloc(g->ctx, n, sizeof(double), &p->radius), failed);
  GH_TRY_OR(gh_alloc(g->ctx, n, sizeof(int), &p->type), failed);
  GH_TRY_OR(gh_alloc(g->ctx, n * DIM, sizeof(double), &p->x), failed);
  double unit = diameter[g->id[0]] / (2 * g->grain[0].a * g->s0);
  for (int m = 0; m < g->n; m++) {
    int i = g->id[m];
    p->radius[i] = diameter[i] / 2;
    p->type[i] = type ? type[i] : 1;
    for (int k = 0; k < DIM; k++) p->x[DIM * i + k] = g->grain[m].x[k] * unit;
  }
  for (int k = 0; k < DIM * DIM; k++) p->cell[k] = g->box.cell[k / DIM][k % DIM] * unit;
  *out = p;
  return GH_OK;
failed:
  gh_grains_destroy(&p);
  return status;
}

/* Round-off has left overlaps of the order of 1e-15 of the cell: the radii give way. All grains are put into
 * the cell. */
static gh_status finish(growth *g, gh_grow_result *r) {
  double smallest = INFINITY, largest = 0;
  GH_TRY(growth_sync2(g));
  if (!(g->s0 > 0))
    return gh_fail(g->ctx, GH_DIVERGED,
                   "packing: the time limit was reached before the grains began to grow");
  GH_TRY(growth_list_all2(g));
  double scale = growth_scale2(g);
  for (int i = 0; i < g->n; i++) {
    smallest = fmin(smallest, g->grain[i].a);
    largest = fmax(largest, g->grain[i].a);
  }
  r->overlap = (1 - scale) * 2 * largest / smallest;
  if (!(r->overlap < 1e-10))
    return gh_fail(g->ctx, GH_INTERNAL, "packing: grains overlap by %.3g of the smallest radius", r->overlap);
  g->s0 *= scale * (1 - 4e-16);
  r->volume_fraction = fraction_of(g);
  return GH_OK;
}

static gh_status grow(growth *g, const gh_grow_options *o, gh_grow_result *r) {
  course c = {.o = o, .begin = gh_seconds()};
  for (int i = 0; i < g->n; i++) c.mean += g->grain[i].a / g->n;
  g->collision = o->collision;
  g->deadline = o->seconds > 0 ? c.begin + o->seconds : INFINITY;
  c.target = o->volume_fraction > 0 ? pow(o->volume_fraction, 1.0 / DIM) : INFINITY;
  GH_TRY(check_room(g, o->volume_fraction > 0 ? o->volume_fraction : RANDOM_FRACTION));
  scatter(g, o->seed);
  GH_TRY(growth_order2(g));
  gh_work_begin(g->ctx, &c.work, c.label, "collisions", NAN);
  gh_status status = run(g, &c, &r->stop);
  gh_work_end(g->ctx, &c.work, g->collisions);
  if (status != GH_OK) return status;
  r->seconds = gh_seconds() - c.begin;
  r->collisions = g->collisions, r->transfers = g->leaves, r->checks = g->checks;
  r->rate = r->collisions / r->seconds;
  return finish(g, r);
}

gh_status gh_packing_grow2(gh_context *ctx, int n, const double *diameter, const int *type,
                           const gh_grow_options *options, gh_grains **grains, gh_grow_result *result) {
  double shape[DIM * DIM] = {0};
  growth *g;
  *grains = NULL;
  *result = (gh_grow_result){0};
  for (int k = 0; k < DIM; k++) shape[DIM * k + k] = 1;
  for (int k = 0; k < DIM * DIM; k++)
    if (options->shape[k] != 0) {
      memcpy(shape, options->shape, sizeof shape);
      break;
    }
  GH_TRY(check_grains(ctx, n, diameter));
  GH_TRY(check_shape(ctx, shape));
  GH_TRY(check_options(ctx, n, diameter, options));
  GH_TRY(growth_create2(ctx, n, diameter, &g));
  growth_box_fit2(shape, &g->box);
  gh_status status = grow(g, options, result);
  if (status == GH_OK) status = give(g, diameter, type, grains);
  growth_destroy2(&g);
  return status;
}
