/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Event-driven growth: what a grown packing must be. Compiled a second time for three dimensions by
 * test_grow_packing3.c. */
#include "grow_help.h"

#include "granhom/io.h"

#include <stdio.h>
#include <unistd.h>

static gh_grow_options fast(void) {
  gh_grow_options o = gh_grow_defaults(DIM);
  o.rate = 0.02;
  return o;
}

static void mixed(int n, double *diameter, int *type) {
  for (int i = 0; i < n; i++) {
    type[i] = 1 + i % 3;
    diameter[i] = 0.5 + 0.25 * type[i];
  }
}

/* A grown packing has the diameters and types asked for, its volume fraction is what is reported, its grains
 * lie in the cell and do not overlap by 1e-12 of the smallest radius; both velocity rules, tilted cell. */
static void grown(void **state) {
  enum { N = 200 };
  gh_context *ctx = *state;
  double diameter[N];
  int type[N];
  mixed(N, diameter, type);
  for (int variant = 0; variant < 3; variant++) {
    gh_grow_options o = fast();
    gh_grow_result r;
    gh_grains *p;
    if (variant == 1) o.collision = GH_COLLISION_MOMENTUM;
    if (variant == 2) {
      for (int k = 0; k < DIM; k++) o.shape[k * (DIM + 1)] = 1;
      o.shape[1] = 0.5;
    }
    OK(gh_packing_grow(ctx, DIM, N, diameter, type, &o, &p, &r));
    assert_true(p->n == N && p->dim == DIM && r.stop == GH_STOP_DRIED_UP);
    assert_true(r.volume_fraction > (DIM == 2 ? 0.78 : 0.58));
    NEAR("volume fraction", gh_grains_volume_fraction(p), r.volume_fraction, 1e-12);
    assert_true(overlap(N, p->x, p->radius, p->cell) < 1e-12);
    assert_true(r.overlap < 1e-12);
    NEAR("tilt", p->cell[1] / p->cell[0], variant == 2 ? 0.5 : 0, 1e-14);
    for (int i = 0; i < N; i++) {
      assert_true(2 * p->radius[i] == diameter[i] && p->type[i] == type[i]);
      for (int k = DIM - 1; k >= 0; k--) { /* lattice coordinates by back substitution */
        double s = p->x[DIM * i + k];
        if (k == 0) s -= p->cell[1] * p->x[DIM * i + 1] / p->cell[DIM + 1];
        assert_true(s > -1e-12 * p->cell[0] && s < p->cell[k * (DIM + 1)] * (1 + 1e-12));
      }
    }
    gh_grains_destroy(&p);
  }
}

/* Equal seeds give equal packings to the last bit, other seeds others. */
static void seeds(void **state) {
  enum { N = 150 };
  gh_context *ctx = *state;
  double diameter[N];
  int type[N];
  gh_grains *p[3];
  mixed(N, diameter, type);
  for (int k = 0; k < 3; k++) {
    gh_grow_options o = fast();
    gh_grow_result r;
    o.seed = k < 2 ? 42 : 43;
    OK(gh_packing_grow(ctx, DIM, N, diameter, type, &o, &p[k], &r));
  }
  size_t bytes = N * DIM * sizeof(double);
  assert_memory_equal(p[0]->x, p[1]->x, bytes);
  assert_memory_equal(p[0]->cell, p[1]->cell, sizeof p[0]->cell);
  assert_true(memcmp(p[0]->x, p[2]->x, bytes) != 0);
  for (int k = 0; k < 3; k++) gh_grains_destroy(&p[k]);
}

/* Growth stops at the volume fraction, to round-off; at the time limit; and states so. */
static void stops(void **state) {
  enum { N = 100 };
  gh_context *ctx = *state;
  double diameter[N];
  int type[N];
  gh_grains *p;
  gh_grow_result r;
  gh_grow_options o = fast();
  mixed(N, diameter, type);
  o.volume_fraction = 0.5;
  OK(gh_packing_grow(ctx, DIM, N, diameter, type, &o, &p, &r));
  assert_int_equal(r.stop, GH_STOP_FRACTION);
  NEAR("volume fraction", gh_grains_volume_fraction(p), 0.5, 1e-13);
  gh_grains_destroy(&p);
  o = fast();
  o.seconds = 0.05, o.threshold = 0, o.rate = 1e-5;
  OK(gh_packing_grow(ctx, DIM, N, diameter, type, &o, &p, &r));
  assert_int_equal(r.stop, GH_STOP_TIME);
  assert_true(r.seconds >= 0.05 && r.seconds < 5);
  gh_grains_destroy(&p);
}

static void refused(gh_context *ctx, int n, const double *diameter, gh_grow_options o, const char *words) {
  gh_grains *p;
  gh_grow_result r;
  FAILS(gh_packing_grow(ctx, DIM, n, diameter, NULL, &o, &p, &r), GH_INPUT, words);
  assert_null(p);
}

/* Wrong input is refused with the value and the limit. */
static void wrong_input(void **state) {
  enum { N = 50 };
  gh_context *ctx = *state;
  double equal[N], bad[3] = {1, -1, 1};
  for (int i = 0; i < N; i++) equal[i] = 1;
  gh_grow_options o = fast();
  refused(ctx, 0, equal, o, "0 grains");
  refused(ctx, 3, bad, o, "grain 2 has the diameter -1");
  refused(ctx, 2, equal, o, "too small for two neighbours");
  o.volume_fraction = 0.95;
  refused(ctx, N, equal, o, DIM == 2 ? "at most 0.9069" : "at most 0.7405");
  o.volume_fraction = -0.1;
  refused(ctx, N, equal, o, "not possible");
  o = fast(), o.rate = 0;
  refused(ctx, N, equal, o, "growth rate is 0");
  o = fast(), o.rate = NAN;
  refused(ctx, N, equal, o, "growth rate");
  o = fast(), o.window = 0;
  refused(ctx, N, equal, o, "window");
  o = fast(), o.threshold = -1;
  refused(ctx, N, equal, o, "threshold");
  o = fast(), o.threshold = 0;
  refused(ctx, N, equal, o, "nothing stops");
  o = fast(), o.seconds = -1;
  refused(ctx, N, equal, o, "time limit");
  o = fast(), o.shape[0] = 1;
  refused(ctx, N, equal, o, "the cell's entry 2,2 is 0");
  o = fast();
  for (int k = 0; k < DIM; k++) o.shape[k * (DIM + 1)] = 1;
  o.shape[DIM] = 0.1;
  refused(ctx, N, equal, o, "upper triangular");
  o.shape[DIM] = 0, o.shape[0] = 60;
  refused(ctx, N, equal, o, "too small for two neighbours");
}

/* Bounds of the volume fraction: equal grains, a triangle of a large and two small disks, two sizes of
 * spheres. */
static void limits(void **state) {
  (void)state;
  double pi = help_pi, equal[3] = {2, 2, 2}, two[3] = {1, 0.8, 0.8};
  NEAR("disks", gh_grow_limit(2, 3, equal), pi / sqrt(12), 1e-14);
  NEAR("spheres", gh_grow_limit(3, 3, equal), pi / sqrt(18), 1e-14);
  double a = 1, b = 0.8, half = asin(b / (a + b)), area = b * sqrt((a + b) * (a + b) - b * b);
  NEAR("two sizes", gh_grow_limit(2, 3, two), (half * a * a + (pi / 2 - half) * b * b) / area, 1e-14);
  NEAR("spheres of two sizes", gh_grow_limit(3, 3, two), 1 - pow(1 - pi / sqrt(18), 2), 1e-14);
}

/* Files: what is written is read back, as LAMMPS data; plane packings also as a packing. */
static void written(void **state) {
  enum { N = 60 };
  gh_context *ctx = *state;
  double diameter[N];
  int type[N];
  char path[64];
  gh_grains *p;
  gh_grow_result r;
  gh_lammps_data *d;
  gh_grow_options o = fast();
  mixed(N, diameter, type);
  snprintf(path, sizeof path, "/tmp/granhom-grow%d-%d.data", DIM, (int)getpid());
  o.volume_fraction = 0.5;
  OK(gh_packing_grow(ctx, DIM, N, diameter, type, &o, &p, &r));
  OK(gh_grains_write(ctx, p, path));
  OK(gh_lammps_data_read(ctx, path, &d));
  assert_int_equal(d->natoms, N);
  for (int i = 0; i < N; i++) {
    assert_true(d->diameter[i] == diameter[i] && d->type[i] == type[i]);
    for (int k = 0; k < 3; k++) assert_true(d->x[3 * i + k] == (k < DIM ? p->x[DIM * i + k] : 0));
  }
  for (int k = 0; k < DIM; k++) assert_true(d->high[k] == p->cell[k * (DIM + 1)]);
  gh_lammps_data_destroy(&d);
  unlink(path);
  gh_packing *q;
  if (DIM == 2) {
    OK(gh_grains_packing(ctx, p, &q));
    assert_memory_equal(q->x, p->x, N * 2 * sizeof(double));
    assert_true(q->cell[0] == p->cell[0] && q->cell[3] == p->cell[3]);
    gh_packing_destroy(&q);
  } else FAILS(gh_grains_packing(ctx, p, &q), GH_INPUT, "plane");
  gh_grains_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(grown),       TEST(seeds),  TEST(stops),
                                     TEST(wrong_input), TEST(limits), TEST(written)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
