/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The native engine: contacts against brute force over images, forces against the energy, relaxation. */
#include "../help.h"

enum { MOST = 40 };

/* A random packing: positions anywhere, several lattice vectors away from the cell. */
typedef struct sample {
  int n;
  double cell[4], radius[MOST], x[2 * MOST];
} sample;

/* The contacts of an engine without friction. */
static gh_status contacts_of(gh_engine *e, const gh_contact **c, int *count, const double **force) {
  gh_contact_list list = {0};
  gh_status status = gh_engine_contacts(e, &list);
  *c = list.contacts, *count = list.count, *force = list.force;
  return status;
}

static void draw(unsigned long long *seed, int n, double largest, sample *s) {
  s->n = n;
  double angle = 2 * help_pi * uniform(seed), Q[4],
         T[4] = {0.4 + uniform(seed), 2 * uniform(seed) - 1, 0, 0.4 + uniform(seed)};
  rotation(angle, Q);
  gh_mul2(Q, T, s->cell);
  for (int i = 0; i < n; i++) {
    double f[2] = {6 * uniform(seed) - 3, 6 * uniform(seed) - 3};
    s->radius[i] = largest * (0.2 + 0.8 * uniform(seed));
    gh_apply2(s->cell, f, &s->x[2 * i]);
  }
}

static gh_engine *make_engine(gh_context *ctx, const sample *s, bool periodic, const unsigned char *held) {
  gh_engine *e;
  gh_engine_setup setup = {
      .n = s->n, .radius = s->radius, .held = held, .periodic = periodic, .law = {.normal_stiffness = 100}};
  OK(gh_engine_create(ctx, GH_ENGINE_NATIVE, &setup, &e));
  return e;
}

/* Number of contacts of i and j (j seen at any image), each one looked up in the list and marked there.
 * Contacts within round-off of touching may be in the list or not. */
static int brute_force(const sample *s, bool periodic, int i, int j, const gh_contact *list, int count,
                       int *mark) {
  double inverse[4], f[2], d0[2] = {s->x[2 * j] - s->x[2 * i], s->x[2 * j + 1] - s->x[2 * i + 1]};
  gh_inv2(s->cell, inverse);
  gh_apply2(inverse, d0, f);
  int found = 0, range = periodic ? 12 : 0;
  for (int a = -range; a <= range; a++)
    for (int b = -range; b <= range; b++) {
      if (i == j && (b < 0 || (b == 0 && a <= 0))) continue;
      double k[2] = {a, b}, l[2];
      if (periodic) k[0] -= floor(f[0]), k[1] -= floor(f[1]);
      gh_apply2(s->cell, k, l);
      for (int c = 0; c < 2; c++) l[c] = d0[c] + (periodic ? l[c] : 0);
      double overlap = s->radius[i] + s->radius[j] - hypot(l[0], l[1]);
      if (overlap < 1e-13) continue;
      found++;
      int hits = 0;
      for (int c = 0; c < count; c++) {
        double same = hypot(list[c].l[0] - l[0], list[c].l[1] - l[1]);
        if (i == j) same = fmin(same, hypot(list[c].l[0] + l[0], list[c].l[1] + l[1]));
        if (list[c].i != i || list[c].j != j || same > 1e-12) continue;
        hits++, mark[c]++;
        NEAR("overlap", list[c].overlap, overlap, 1e-12);
      }
      assert_int_equal(hits, 1);
    }
  return found;
}

static void check_contacts(gh_context *ctx, const sample *s, bool periodic) {
  gh_engine *e = make_engine(ctx, s, periodic, NULL);
  const gh_contact *list;
  const double *force;
  int count, found = 0, mark[8000] = {0};
  OK(gh_engine_set(e, periodic ? s->cell : NULL, s->x, NULL));
  OK(contacts_of(e, &list, &count, &force));
  assert_in_range(count, 0, 8000);
  for (int i = 0; i < s->n; i++)
    for (int j = i; j < s->n; j++)
      if (i != j || periodic) found += brute_force(s, periodic, i, j, list, count, mark);
  for (int c = 0; c < count; c++) {
    assert_true(mark[c] == 1 || list[c].overlap <= 1e-13);
    found += mark[c] == 0;
    if (c)
      assert_true(list[c - 1].i < list[c].i || (list[c - 1].i == list[c].i && list[c - 1].j <= list[c].j));
  }
  assert_int_equal(found, count);
  gh_engine_destroy(&e);
}

/* Contacts of random packings in tilted and turned cells are those that a search over all images finds. */
static void contacts_of_random_packings(void **state) {
  unsigned long long seed = 11;
  print_message("seed %llu\n", seed);
  sample s;
  for (int trial = 0; trial < 60; trial++) {
    draw(&seed, 5 + trial % (MOST - 4), 0.02 + 0.1 * uniform(&seed), &s);
    check_contacts(*state, &s, true);
    check_contacts(*state, &s, false);
  }
}

/* One to four grains in cells smaller than they are: a grain touches its own images and several of its
 * neighbours'. */
static void contacts_in_tiny_cells(void **state) {
  unsigned long long seed = 12;
  print_message("seed %llu\n", seed);
  sample s;
  for (int trial = 0; trial < 200; trial++) {
    draw(&seed, 1 + trial % 4, 0.1 + 0.5 * uniform(&seed), &s);
    check_contacts(*state, &s, true);
  }
}

/* Energy of the contacts at x. */
static double energy_at(gh_context *ctx, gh_engine *e, const sample *s, const double *x) {
  const gh_contact *list;
  const double *force;
  int count;
  double sum = 0;
  OK(gh_engine_set(e, s->cell, x, NULL));
  OK(contacts_of(e, &list, &count, &force));
  for (int c = 0; c < count; c++) sum += list[c].energy;
  return sum;
}

/* The force on each grain is minus the derivative of the energy with respect to its position, and sums to
 * zero. */
static void forces_are_derivatives_of_the_energy(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 13;
  print_message("seed %llu\n", seed);
  sample s;
  for (int trial = 0; trial < 10; trial++) {
    draw(&seed, 3 + 2 * trial, 0.15, &s);
    gh_engine *e = make_engine(ctx, &s, true, NULL);
    double f[2 * MOST], sum[2] = {0}, h = 1e-6;
    const gh_contact *list;
    const double *force;
    int count;
    OK(gh_engine_set(e, s.cell, s.x, NULL));
    OK(contacts_of(e, &list, &count, &force));
    memcpy(f, force, 2 * (size_t)s.n * sizeof *f);
    for (int k = 0; k < 2 * s.n; k++) {
      double kept = s.x[k];
      s.x[k] = kept + h;
      double up = energy_at(ctx, e, &s, s.x);
      s.x[k] = kept - h;
      double down = energy_at(ctx, e, &s, s.x);
      s.x[k] = kept;
      NEAR("force", f[k], -(up - down) / (2 * h), 1e-4); /* a contact that opens within h costs E h */
      sum[k % 2] += f[k];
    }
    NEAR("sum of forces", hypot(sum[0], sum[1]), 0, 1e-11);
    gh_engine_destroy(&e);
  }
}

/* Branch vector, force, energy and stiffness of each contact belong together (4.3, 4.8, 4.12). */
static void contacts_are_complete(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 14;
  sample s;
  draw(&seed, 20, 0.15, &s);
  gh_engine *e = make_engine(ctx, &s, true, NULL);
  const gh_contact *c;
  const double *force;
  int count;
  OK(gh_engine_set(e, s.cell, s.x, NULL));
  OK(contacts_of(e, &c, &count, &force));
  assert_true(count > 10);
  for (int k = 0; k < count; k++, c++) {
    double d = hypot(c->l[0], c->l[1]), n[2] = {c->l[0] / d, c->l[1] / d}, q = c->overlap / d;
    NEAR("overlap", c->overlap, s.radius[c->i] + s.radius[c->j] - d, 1e-15);
    NEAR("fx", c->f[0], -100 * c->overlap * n[0], 1e-12);
    NEAR("fy", c->f[1], -100 * c->overlap * n[1], 1e-12);
    NEAR("energy", c->energy, 50 * c->overlap * c->overlap, 1e-12);
    NEAR("xx", c->h[0], 100 * (n[0] * n[0] - q * n[1] * n[1]), 1e-11);
    NEAR("xy", c->h[1], 100 * (1 + q) * n[0] * n[1], 1e-11);
    NEAR("yy", c->h[2], 100 * (n[1] * n[1] - q * n[0] * n[0]), 1e-11);
  }
  gh_engine_destroy(&e);
}

/* Contacts after a move, near or far, are bitwise those after setting the same positions. */
static void moving_is_setting(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 15;
  print_message("seed %llu\n", seed);
  sample s;
  draw(&seed, MOST, 0.12, &s);
  gh_engine *a = make_engine(ctx, &s, true, NULL), *b = make_engine(ctx, &s, true, NULL);
  OK(gh_engine_set(a, s.cell, s.x, NULL));
  for (int step = 0; step < 20; step++) {
    double size = step % 4 == 3 ? 0.5 : 0.003, back[2 * MOST];
    const gh_contact *ca, *cb;
    const double *fa, *fb;
    int na, nb;
    for (int k = 0; k < 2 * s.n; k++) s.x[k] += size * (uniform(&seed) - 0.5);
    OK(gh_engine_move(a, s.x, NULL));
    OK(gh_engine_set(b, s.cell, s.x, NULL));
    OK(contacts_of(a, &ca, &na, &fa));
    OK(contacts_of(b, &cb, &nb, &fb));
    OK(gh_engine_get(a, back, NULL));
    assert_memory_equal(back, s.x, sizeof back);
    assert_int_equal(na, nb);
    assert_memory_equal(ca, cb, (size_t)na * sizeof *ca);
    assert_memory_equal(fa, fb, 2 * (size_t)s.n * sizeof *fa);
  }
  gh_engine_destroy(&a);
  gh_engine_destroy(&b);
}

/* Largest force on a free grain over the mean force of the contacts. */
static double residual_of(gh_context *ctx, gh_engine *e, int n, const unsigned char *held) {
  const gh_contact *c;
  const double *f;
  int count;
  double largest = 0, mean = 0;
  OK(contacts_of(e, &c, &count, &f));
  for (int k = 0; k < count; k++) mean += hypot(c[k].f[0], c[k].f[1]) / count;
  for (int i = 0; i < n; i++)
    if (!held || !held[i]) largest = fmax(largest, hypot(f[2 * i], f[2 * i + 1]));
  return largest / mean;
}

/* Relaxation reaches the residual that it reports and leaves fixed grains where they are. */
static void relaxation_reaches_equilibrium(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  unsigned char held[50] = {0};
  for (int i = 0; i < 50; i += 9) held[i] = 1;
  for (int some = 0; some < 2; some++) {
    gh_engine *e;
    gh_engine_setup setup = {.n = p->n,
                             .radius = p->radius,
                             .held = some ? held : NULL,
                             .periodic = true,
                             .law = {.normal_stiffness = 1000}};
    double cell[4], x[100], y[100], F[4] = {0.99, 0.005, 0, 0.995};
    gh_relax_options o = {.tolerance = 1e-6, .max_steps = 100000, .floor = 0};
    gh_relax_result r;
    gh_engine_cost cost;
    OK(gh_engine_create(ctx, GH_ENGINE_NATIVE, &setup, &e));
    assert_string_equal(gh_engine_name(e), "native");
    gh_mul2(F, p->cell, cell);
    for (int i = 0; i < 50; i++) gh_apply2(F, &p->x[2 * i], &x[2 * i]);
    OK(gh_engine_set(e, cell, x, NULL));
    OK(gh_engine_relax(e, &o, &r));
    OK(gh_engine_get(e, y, NULL));
    assert_true(r.converged && r.residual <= 1e-6 && r.steps > 10);
    NEAR("residual", residual_of(ctx, e, 50, some ? held : NULL), r.residual, 1e-9);
    for (int i = 0; i < 50; i++)
      if (some && held[i]) assert_true(x[2 * i] == y[2 * i] && x[2 * i + 1] == y[2 * i + 1]);
    gh_engine_costs(e, &cost);
    assert_true(cost.steps == r.steps && cost.rebuilds >= 1 && cost.evaluations == 1);
    gh_engine_destroy(&e);
  }
  gh_packing_destroy(&p);
}

/* Too few steps are no error but say so, and one more call continues; nothing more is spent than allowed. */
static void relaxation_may_run_out_of_steps(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  gh_engine *e;
  gh_engine_setup setup = {
      .n = p->n, .radius = p->radius, .periodic = true, .law = {.normal_stiffness = 1000}};
  gh_relax_options o = {.tolerance = 1e-8, .max_steps = 7};
  gh_relax_result r;
  double cell[4], F[4] = {0.98, 0, 0, 0.98}, x[100];
  OK(gh_engine_create(ctx, GH_ENGINE_NATIVE, &setup, &e));
  gh_mul2(F, p->cell, cell);
  for (int i = 0; i < 50; i++) gh_apply2(F, &p->x[2 * i], &x[2 * i]);
  OK(gh_engine_set(e, cell, x, NULL));
  OK(gh_engine_relax(e, &o, &r));
  assert_true(!r.converged && r.residual > 1e-8 && r.steps <= 7);
  o.max_steps = 100000;
  OK(gh_engine_relax(e, &o, &r));
  assert_true(r.converged && r.residual <= 1e-8);
  gh_engine_destroy(&e);
  gh_packing_destroy(&p);
}

/* Without contacts a packing counts as unjammed at once. */
static void nothing_to_relax(void **state) {
  gh_context *ctx = *state;
  sample s = {.n = 2, .cell = {10, 0, 0, 10}, .radius = {1, 1}, .x = {1, 1, 6, 6}};
  gh_engine *e = make_engine(ctx, &s, true, NULL);
  gh_relax_options o = {.tolerance = 1e-8, .max_steps = 100};
  gh_relax_result r;
  OK(gh_engine_set(e, s.cell, s.x, NULL));
  OK(gh_engine_relax(e, &o, &r));
  assert_true(r.converged && r.residual == 0 && r.mean_force == 0 && r.steps == 1);
  gh_engine_destroy(&e);
}

/* Coinciding centres, and a cell that is nearly flat, give a message: no NaN, no endless search. */
static void what_has_no_direction_or_no_room(void **state) {
  gh_context *ctx = *state;
  sample s = {.n = 2, .cell = {10, 0, 0, 10}, .radius = {1, 1}, .x = {1, 1, 11, 11}};
  gh_engine *e = make_engine(ctx, &s, true, NULL);
  FAILS(gh_engine_set(e, s.cell, s.x, NULL), GH_DIVERGED, "grains 1 and 2 coincide");
  s.x[2] = 5;
  OK(gh_engine_set(e, s.cell, s.x, NULL));
  FAILS(gh_engine_set(e, (double[4]){1e-2, 0, 0, 100}, s.x, NULL), GH_INPUT, "too thin");
  FAILS(gh_engine_set(e, (double[4]){1e-9, 0, 0, 10}, s.x, NULL), GH_INPUT,
        "the grains fill it 6.28e+08 times");
  FAILS(gh_engine_set(e, (double[4]){1e-9, 0, 0, 1e10}, s.x, NULL), GH_INPUT, "distorted beyond use");
  FAILS(gh_engine_set(e, (double[4]){10, 1e8, 0, 10}, s.x, NULL), GH_INPUT, "distorted beyond use");
  gh_engine_destroy(&e);
}

/* Setups and positions that are out of range are refused with the value. */
static void bad_input_is_refused(void **state) {
  gh_context *ctx = *state;
  gh_engine *e = NULL;
  double r[2] = {1, 1}, x[4] = {0, 0, 3, 3};
  int type[2] = {1, 0};
  const gh_engine_setup good = {.n = 2, .radius = r, .periodic = true, .law = {.normal_stiffness = 1}};
  gh_engine_setup s = good;
  s.n = 0;
  FAILS(gh_engine_create(ctx, GH_ENGINE_NATIVE, &s, &e), GH_INPUT, "not 0");
  const double stiffness[] = {0, -5, NAN, INFINITY}, radius[] = {0, -1, NAN, INFINITY};
  for (int k = 0; k < 4; k++) {
    s = good, s.law.normal_stiffness = stiffness[k];
    FAILS(gh_engine_create(ctx, GH_ENGINE_NATIVE, &s, &e), GH_INPUT, "normal stiffness");
    s = good, r[1] = radius[k];
    FAILS(gh_engine_create(ctx, GH_ENGINE_NATIVE, &s, &e), GH_INPUT, "radius of grain 2");
    r[1] = 1;
  }
  s = good, s.type = type;
  FAILS(gh_engine_create(ctx, GH_ENGINE_NATIVE, &s, &e), GH_INPUT, "type of grain 2");
  assert_null(e);
  OK(gh_engine_create(ctx, GH_ENGINE_NATIVE, &good, &e));
  FAILS(gh_engine_set(e, (double[4]){1, 0, 0, -1}, x, NULL), GH_INPUT, "determinant");
  FAILS(gh_engine_set(e, (double[4]){NAN, 0, 0, 1}, x, NULL), GH_INPUT, "cell");
  x[3] = NAN;
  FAILS(gh_engine_set(e, (double[4]){5, 0, 0, 5}, x, NULL), GH_INPUT, "grain 2");
  FAILS(gh_engine_move(e, x, NULL), GH_INPUT, "grain 2");
  gh_engine_destroy(&e);
  assert_null(e);
  gh_engine_destroy(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(contacts_of_random_packings),
                                     TEST(contacts_in_tiny_cells),
                                     TEST(forces_are_derivatives_of_the_energy),
                                     TEST(contacts_are_complete),
                                     TEST(moving_is_setting),
                                     TEST(relaxation_reaches_equilibrium),
                                     TEST(relaxation_may_run_out_of_steps),
                                     TEST(nothing_to_relax),
                                     TEST(what_has_no_direction_or_no_room),
                                     TEST(bad_input_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
