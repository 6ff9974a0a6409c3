/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Event-driven growth: events against an independent slow run. Compiled a second time for three dimensions by
 * test_grow3.c. */
#include "grow_help.h"

/* ---- small parts ---- */

static approach along_x(double gap, double speed, double sigma, double growth) {
  double l[DIM] = {sigma + gap}, dv[DIM] = {speed};
  return approach_of(l, dv, sigma, growth);
}

/* Times of contact of two grains on a line: gap over closing speed, growth included (3.5). */
static void head_on(void **state) {
  (void)state;
  NEAR("closing", meeting(along_x(0.5, -1, 1, 0)), 0.5, 1e-15);
  NEAR("closing and growing", meeting(along_x(0.5, -1, 1, 1)), 0.25, 1e-15);
  NEAR("growing at rest", meeting(along_x(0.5, 0, 1, 2)), 0.25, 1e-15);
  NEAR("parting, overtaken by growth", meeting(along_x(0.5, 1, 1, 2)), 0.5, 1e-15);
  assert_true(isinf(meeting(along_x(0.5, 1, 1, 0.5))));
  assert_true(meeting(along_x(0, -1, 1, 0.5)) == 0);
  NEAR("tiny gap", meeting(along_x(1e-12, -1, 1, 0)) / 1e-12, 1, 1e-3);
}

/* The time of contact puts random spheres at the distance of their radii for the first time, and the test
 * without branches agrees with it. */
static void first_contact(void **state) {
  unsigned long long seed = 7;
  int found = 0;
  (void)state;
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < 20000; trial++) {
    double l[DIM], dv[DIM], square = 0, growth = uniform(&seed);
    for (int k = 0; k < DIM; k++) {
      l[k] = 4 * uniform(&seed) - 2, dv[k] = 2 * uniform(&seed) - 1;
      square += l[k] * l[k];
    }
    double sigma = sqrt(square) * uniform(&seed), end = 2 * uniform(&seed);
    approach a = approach_of(l, dv, sigma, growth);
    double t = meeting(a), last = fmin(t, 10);
    for (int step = 0; step <= 20; step++) { /* no contact before */
      double d = 0, when = last * step / 20 * (1 - 1e-9);
      for (int k = 0; k < DIM; k++) d += (l[k] + dv[k] * when) * (l[k] + dv[k] * when);
      assert_true(sqrt(d) >= (sigma + growth * when) * (1 - 1e-12));
      if (step == 20 && isfinite(t) && t < 10) {
        NEAR("distance", sqrt(d), sigma + growth * when, 1e-7);
        found++;
      }
    }
    assert_int_equal(meets_before(a, end), t < end);
  }
  assert_true(found > 1000);
}

/* (3.9) exchanges normal velocities and adds growth; approaching and parting pairs. */
static void exchange_rule(void **state) {
  (void)state;
  double vi = 2, vj = -1;
  impact(GH_COLLISION_EXCHANGE, 0.25, 0.5, 1, 9, &vi, &vj);
  assert_true(vi == -1.25 && vj == 2.5);
  vi = -0.25, vj = 0;
  impact(GH_COLLISION_EXCHANGE, 0.25, 0.5, 1, 9, &vi, &vj);
  assert_true(vi == -0.5 && vj == 0.5);
}

/* The other rule keeps momentum, and the surfaces part as fast as they met. */
static void momentum_rule(void **state) {
  (void)state;
  double vi = 2, vj = -1, mi = 3, mj = 5, gi = 0.1, gj = 0.4;
  impact(GH_COLLISION_MOMENTUM, gi, gj, mi, mj, &vi, &vj);
  NEAR("momentum", mi * vi + mj * vj, 3 * 2 - 5, 1e-14);
  NEAR("surfaces", (vj - gj) - (vi + gi), (2 + gi) - (-1 - gj), 1e-14);
}

/* The queue hands out entries in the order of their times, whatever was changed. */
static void queue(void **state) {
  enum { N = 1000 };
  heap_slot slot[N];
  int place[N];
  heap h = {N, slot, place, {-1, -1, -1}};
  unsigned long long seed = 11;
  (void)state;
  print_message("seed %llu\n", seed);
  heap_level(&h, 0);
  for (int k = 0; k < 20 * N; k++) heap_set(&h, (int)(uniform(&seed) * N), uniform(&seed));
  for (int i = 0; i < N; i++) heap_set(&h, i, uniform(&seed));
  double last = 0;
  for (int k = 0; k < N; k++) {
    assert_true(slot[0].t >= last);
    last = slot[0].t;
    heap_set(&h, slot[0].i, INFINITY);
  }
  assert_true(isinf(slot[0].t));
}

/* ---- events against a slow run ---- */

static growth *start(gh_context *ctx, int n, const double *diameter, const double *shape,
                     unsigned long long seed) {
  growth *g;
  OK(growth_create2(ctx, n, diameter, &g));
  growth_box_fit2(shape, &g->box);
  for (int i = 0; i < n; i++) {
    double s[DIM];
    for (int k = 0; k < DIM; k++) s[k] = uniform(&seed);
    for (int k = 0; k < DIM; k++) {
      g->grain[i].x[k] = dot(g->box.cell[k], s);
      g->grain[i].v[k] = 2 * uniform(&seed) - 1;
    }
  }
  g->rate = 0.05;
  OK(growth_list_all2(g));
  OK(growth_sync2(g));
  return g;
}

enum { FEW = 12 };
typedef struct slow { /* all grains on one clock */
  long double x[FEW][DIM], v[FEW][DIM];
  long double s;
} slow;

/* Time until a pair at the distance l touches, by the roots as they are printed in (3.5). */
static long double slow_time(const long double *l, const long double *dv, long double sigma,
                             long double growth) {
  long double u = -sigma * growth, v = -growth * growth, w = -sigma * sigma;
  for (int k = 0; k < DIM; k++) u += l[k] * dv[k], v += dv[k] * dv[k], w += l[k] * l[k];
  long double q = u * u - v * w, best = INFINITY;
  if (q < 0) return INFINITY;
  for (int sign = -1; sign <= 1; sign += 2) {
    long double t = (-u + sign * sqrtl(q)) / v;
    if (t > 1e-10L && t < best) best = t;
  }
  return best;
}

typedef struct encounter {
  int i, j, image;
  long double t;
} encounter;

static encounter slow_search(const growth *g, const slow *p) {
  encounter e = {-1, -1, 0, INFINITY};
  for (int i = 0; i < g->n; i++)
    for (int j = 0; j < i; j++)
      for (int m = 0; m < IMAGES; m++) {
        long double l[DIM], dv[DIM], sum = g->grain[i].a + g->grain[j].a;
        for (int k = 0; k < DIM; k++) {
          l[k] = p->x[j][k] + g->box.shift[m][k] - p->x[i][k];
          dv[k] = p->v[j][k] - p->v[i][k];
        }
        long double t = slow_time(l, dv, sum * p->s, sum * g->rate);
        if (t < e.t) e = (encounter){i, j, m, t};
      }
  return e;
}

static void slow_wrap(const growth *g, long double *x) {
  for (int k = DIM - 1; k >= 0; k--) {
    long double times = floorl(x[k] / g->box.cell[k][k]);
    for (int r = 0; r <= k; r++) x[r] -= times * g->box.cell[r][k];
  }
}

static void slow_advance(const growth *g, slow *p, long double t) {
  for (int i = 0; i < g->n; i++) {
    for (int k = 0; k < DIM; k++) p->x[i][k] += t * p->v[i][k];
  }
  p->s += t * g->rate;
}

/* To the next collision, in steps so short that all images that can be met are among those that are searched.
 */
static void slow_step(const growth *g, slow *p) {
  const long double most = 0.1;
  encounter e = slow_search(g, p);
  for (; e.t > most; e = slow_search(g, p)) {
    slow_advance(g, p, most);
    for (int i = 0; i < g->n; i++) slow_wrap(g, p->x[i]);
  }
  assert_true(e.i >= 0);
  slow_advance(g, p, e.t);
  long double n[DIM], length = 0, vi = 0, vj = 0;
  for (int k = 0; k < DIM; k++) {
    n[k] = p->x[e.j][k] + g->box.shift[e.image][k] - p->x[e.i][k];
    length += n[k] * n[k];
  }
  for (int k = 0; k < DIM; k++) {
    n[k] /= sqrtl(length);
    vi += n[k] * p->v[e.i][k], vj += n[k] * p->v[e.j][k];
  }
  long double low = fminl(vi, vj) - g->grain[e.i].a * g->rate,
              high = fmaxl(vi, vj) + g->grain[e.j].a * g->rate;
  for (int k = 0; k < DIM; k++) {
    p->v[e.i][k] += (low - vi) * n[k];
    p->v[e.j][k] += (high - vj) * n[k];
  }
  for (int i = 0; i < g->n; i++) slow_wrap(g, p->x[i]);
}

/* All grains of the fast run on one clock, in the cell. */
static slow slow_copy(const growth *g) {
  slow p = {.s = g->s0 + (long double)g->rate * g->now};
  for (int i = 0; i < g->n; i++) {
    const grain *q = &g->grain[i];
    for (int k = 0; k < DIM; k++) {
      p.v[i][k] = q->v[k];
      p.x[i][k] = q->x[k] + (long double)q->v[k] * (g->now - q->t);
    }
    slow_wrap(g, p.x[i]);
  }
  return p;
}

static void same_state(const growth *g, const slow *a, const slow *b) {
  NEAR("size", (double)a->s, (double)b->s, 1e-13);
  for (int i = 0; i < g->n; i++) {
    double d[DIM];
    for (int k = 0; k < DIM; k++) {
      NEAR("velocity", (double)a->v[i][k], (double)b->v[i][k], 1e-9);
      d[k] = (double)(a->x[i][k] - b->x[i][k]);
    }
    for (int k = DIM - 1; k >= 0; k--) { /* at a face of the cell: up to lattice vectors */
      double times = nearbyint(d[k] / g->box.cell[k][k]);
      for (int r = 0; r <= k; r++) d[r] -= times * g->box.cell[r][k];
    }
    NEAR("place", norm(d, DIM), 0, 1e-11);
  }
}

/* Lists, queue and clocks change nothing: from each state to the next collision and through it, a search of
 * all pairs and images on one clock does the same; 400 collisions of grains of four sizes in a tilted cell.
 */
static void same_as_slow(void **state) {
  gh_context *ctx = *state;
  double diameter[FEW], shape[DIM * DIM] = {0};
  for (int k = 0; k < DIM; k++) shape[k * (DIM + 1)] = 1;
  shape[1] = 0.4;
  for (int i = 0; i < FEW; i++) diameter[i] = i < 2 ? 1 : 0.2 + 0.1 * (i % 3);
  for (unsigned long long seed = 1; seed <= 3; seed++) {
    print_message("seed %llu\n", seed);
    growth *g = start(ctx, FEW, diameter, shape, seed);
    for (int step = 1; step <= 400; step++) {
      slow p = slow_copy(g);
      slow_step(g, &p);
      OK(growth_run2(g, INFINITY, step));
      slow q = slow_copy(g);
      same_state(g, &q, &p);
    }
    growth_destroy2(&g);
  }
}

static double overlap_now(const growth *g) {
  double x[400 * DIM], radius[400];
  assert_true(g->n <= 400);
  for (int i = 0; i < g->n; i++) {
    memcpy(&x[DIM * i], g->grain[i].x, sizeof g->grain[i].x);
    radius[i] = g->grain[i].a * g->s0;
  }
  return overlap(g->n, x, radius, &g->box.cell[0][0]);
}

/* At no time do grains of sizes 1:32 overlap, in a tilted cell, also when the memory is ordered again on the
 * way. */
static void never_overlap(void **state) {
  gh_context *ctx = *state;
  double diameter[150], shape[DIM * DIM] = {0};
  for (int k = 0; k < DIM; k++) shape[k * (DIM + 1)] = 1 + 0.3 * k;
  shape[1] = 0.7;
  if (DIM == 3) shape[2] = -0.4, shape[5] = 0.5;
  for (int i = 0; i < 150; i++) diameter[i] = i < 4 ? 32 : i < 20 ? 8 : i < 60 ? 3 : 1;
  growth *g = start(ctx, 150, diameter, shape, 3);
  g->collision = GH_COLLISION_MOMENTUM;
  for (int step = 1; step <= 60; step++) {
    OK(growth_run2(g, INFINITY, 300 * step));
    OK(growth_sync2(g));
    if (step % 10 == 0) OK(growth_order2(g));
    assert_true(overlap_now(g) < 1e-12);
  }
  NEAR("collisions", g->collisions, 18000, 0);
  assert_true(pow(g->s0, DIM) > 0.3);
  growth_destroy2(&g);
}

/* Between two syncs the rule that keeps momentum keeps that of the whole packing. */
static void momentum_of_all(void **state) {
  gh_context *ctx = *state;
  double diameter[60], shape[DIM * DIM] = {0}, before[DIM] = {0}, after[DIM] = {0}, scale = 0;
  for (int k = 0; k < DIM; k++) shape[k * (DIM + 1)] = 1;
  for (int i = 0; i < 60; i++) diameter[i] = 1 + i % 3;
  growth *g = start(ctx, 60, diameter, shape, 5);
  g->collision = GH_COLLISION_MOMENTUM;
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < 60; i++)
      for (int k = 0; k < DIM; k++) {
        double p = pow(diameter[i], DIM) * g->grain[i].v[k];
        (pass ? after : before)[k] += p;
        scale = fmax(scale, fabs(p));
      }
    if (!pass) OK(growth_run2(g, INFINITY, 5000));
  }
  for (int k = 0; k < DIM; k++) NEAR("momentum", after[k], before[k], 1e-11 * scale);
  growth_destroy2(&g);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(head_on),       TEST(first_contact),  TEST(exchange_rule),
                                     TEST(momentum_rule), TEST(queue),          TEST(same_as_slow),
                                     TEST(never_overlap), TEST(momentum_of_all)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
