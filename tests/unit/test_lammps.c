/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The LAMMPS engine against closed forms and brute force, and what an engine promises. */
#include "lammps_help.h"

/* Contacts and their energy by trying all images within `reach` cells. */
static double brute_force(const packing *p, int reach, int *count) {
  double energy = 0;
  *count = 0;
  for (int i = 0; i < p->n; i++)
    for (int j = i; j < p->n; j++)
      for (int a = -reach; a <= reach; a++)
        for (int b = -reach; b <= reach; b++) {
          if (i == j && (b < 0 || (b == 0 && a <= 0))) continue;
          double lx = p->x[2 * j] - p->x[2 * i] + p->cell[0] * a + p->cell[1] * b;
          double ly = p->x[2 * j + 1] - p->x[2 * i + 1] + p->cell[2] * a + p->cell[3] * b;
          double e = p->radius[i] + p->radius[j] - hypot(lx, ly);
          if (e < 0) continue;
          ++*count;
          energy += STIFFNESS * e * e / 2;
        }
  return energy;
}

static double energy_of(outcome o) {
  double sum = 0;
  for (int k = 0; k < o.count; k++) sum += o.c[k].energy;
  return sum;
}

/* ---- closed forms ---- */

/* Two disks: overlap, force, energy and stiffness are the closed form in any cell, also across its boundary.
 */
static void two_disks(void **state) {
  (void)state;
  const double cells[][4] = {{5, 0, 0, 5},  {5, 2.4, 0, 6},  {5, 13, 0, 6},  {4, -3, 3, 4},
                             {0, -7, 7, 0}, {-5, 1, -2, -5}, {12, 80, 2, 20}};
  const int images[][2] = {{0, 0}, {1, 0}, {-2, 3}, {7, -40}};
  packing p = make(2);
  p.radius[0] = 1;
  p.radius[1] = 0.5;
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  const double d[2] = {1.1, -0.8}, r = hypot(1.1, 0.8), n[2] = {d[0] / r, d[1] / r}, o = 1.5 - r;
  for (size_t c = 0; c < sizeof cells / sizeof *cells; c++)
    for (size_t k = 0; k < sizeof images / sizeof *images; k++) {
      const double *H = cells[c];
      double x[4] = {0.3, 4.9, 0, 0};
      for (int m = 0; m < 2; m++)
        x[2 + m] = x[m] + d[m] + H[2 * m] * images[k][0] + H[2 * m + 1] * images[k][1];
      OK(gh_engine_set(e, H, x, NULL));
      outcome got = contacts_of(e);
      assert_int_equal(got.count, 1);
      assert_int_equal(got.c[0].i, 0);
      assert_int_equal(got.c[0].j, 1);
      assert_near(got.c[0].overlap, o, 1e-12);
      assert_near(got.c[0].energy, STIFFNESS * o * o / 2, 1e-10);
      for (int m = 0; m < 2; m++) {
        assert_near(got.c[0].l[m], d[m], 1e-12);
        assert_near(got.c[0].f[m], -STIFFNESS * o * n[m], 1e-10);
        assert_near(got.f[m], -STIFFNESS * o * n[m], 1e-10);
        assert_near(got.f[2 + m], STIFFNESS * o * n[m], 1e-10);
      }
      const double along = STIFFNESS, across = -STIFFNESS * o / r; /* eigenvalues of the second derivative */
      assert_near(got.c[0].h[0], along * n[0] * n[0] + across * n[1] * n[1], 1e-9);
      assert_near(got.c[0].h[1], (along - across) * n[0] * n[1], 1e-9);
      assert_near(got.c[0].h[2], along * n[1] * n[1] + across * n[0] * n[0], 1e-9);
    }
  gh_engine_destroy(&e);
  drop(&p);
}

/* One grain in a square cell touches two of its own images, in any orientation and basis; its force is zero.
 */
static void square_lattice(void **state) {
  (void)state;
  packing p = make(1);
  p.radius[0] = 0.5;
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  const double a = 0.98;
  for (int turn = 0; turn < 24; turn++) {
    double Q[4], cell[4], x[2] = {3.1 * turn, -1};
    rotation(15 * turn, Q);
    for (int shear = -3; shear <= 3; shear++) {
      gh_mul2(Q, (double[4]){a, shear * a, 0, a}, cell);
      OK(gh_engine_set(e, cell, x, NULL));
      outcome o = contacts_of(e);
      assert_int_equal(o.count, 2);
      for (int k = 0; k < 2; k++) {
        assert_int_equal(o.c[k].i, 0);
        assert_int_equal(o.c[k].j, 0);
        assert_near(o.c[k].overlap, 1 - a, 1e-12);
      }
      assert_near(fabs(o.c[0].l[0] * o.c[1].l[1] - o.c[0].l[1] * o.c[1].l[0]), a * a, 1e-12);
      assert_near(hypot(o.f[0], o.f[1]), 0, 1e-12);
    }
  }
  gh_engine_destroy(&e);
  drop(&p);
}

/* Cells of one to four grains, where pairs touch in several images, have the contacts that brute force finds.
 */
static void tiny_cells(void **state) {
  (void)state;
  const uint64_t first = 20240611;
  uint64_t seed = first;
  print_message("seed %llu\n", (unsigned long long)first);
  for (int n = 1; n <= 4; n++) {
    packing p = make(n);
    for (int i = 0; i < n; i++) p.radius[i] = 0.3 + 0.5 * uniform(&seed);
    gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
    for (int k = 0; k < 40; k++) {
      for (int m = 0; m < 4; m++) p.cell[m] = (m == 0 || m == 3) + 1.6 * (uniform(&seed) - 0.5);
      if (gh_det2(p.cell) < 0.5) continue;
      for (int m = 0; m < 2 * n; m++) p.x[m] = 6 * (uniform(&seed) - 0.5);
      int count;
      double energy = brute_force(&p, 14, &count);
      OK(gh_engine_set(e, p.cell, p.x, NULL));
      outcome o = contacts_of(e);
      assert_int_equal(o.count, count);
      assert_near(energy_of(o), energy, 1e-11 * (1 + energy));
      assert_sums(o, n, 1e-10);
    }
    gh_engine_destroy(&e);
    drop(&p);
  }
}

/* A packing without contacts has none, no forces, and counts as relaxed and unjammed. */
static void no_contact(void **state) {
  (void)state;
  packing p = make(2);
  p.radius[0] = p.radius[1] = 0.1;
  p.x[2] = p.x[3] = 0.5;
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  OK(gh_engine_set(e, p.cell, p.x, NULL));
  gh_relax_result r;
  OK(gh_engine_relax(e, &(gh_relax_options){.tolerance = 1e-8, .max_steps = 1000, .method = GH_RELAX_DAMPED},
                     &r));
  assert_true(r.converged);
  assert_near(r.residual, 0, 0);
  assert_near(r.mean_force, 0, 0);
  outcome o = contacts_of(e);
  assert_int_equal(o.count, 0);
  for (int k = 0; k < 4; k++) assert_near(o.f[k], 0, 0);
  gh_engine_destroy(&e);
  drop(&p);
}

/* ---- what an engine promises ---- */

/* What comes back depends on cell and positions only, to the last bit, whatever the engine did before. */
static void no_memory(void **state) {
  (void)state;
  packing p = read_p150();
  size_t bytes = 2 * (size_t)p.n * sizeof(double);
  double *x1 = malloc(bytes), *x2 = malloc(bytes);
  gh_engine *fresh = open_engine(&p, GH_ENGINE_LAMMPS), *used = open_engine(&p, GH_ENGINE_LAMMPS);
  const gh_relax_options options = {.tolerance = 1e-6, .max_steps = 100000, .method = GH_RELAX_DAMPED};
  gh_relax_result r1, r2;
  packing other = read_p150();
  deform(&other, (double[4]){1.1, 0.9, -0.7, 1.2});
  OK(gh_engine_set(used, other.cell, other.x, NULL));
  OK(gh_engine_relax(used, &options, &r2));
  OK(gh_engine_move(used, other.x, NULL));
  deform(&p, (double[4]){0.99, 0.02, 0, 0.99});
  OK(gh_engine_set(fresh, p.cell, p.x, NULL));
  OK(gh_engine_set(used, p.cell, p.x, NULL));
  outcome a = contacts_of(fresh), b = contacts_of(used);
  assert_int_equal(a.count, b.count);
  assert_memory_equal(a.c, b.c, (size_t)a.count * sizeof *a.c);
  assert_memory_equal(a.f, b.f, bytes);
  OK(gh_engine_relax(fresh, &options, &r1));
  OK(gh_engine_relax(used, &options, &r2));
  assert_int_equal(r1.steps, r2.steps);
  assert_memory_equal(&r1.residual, &r2.residual, sizeof r1.residual);
  OK(gh_engine_get(fresh, x1, NULL));
  OK(gh_engine_get(used, x2, NULL));
  assert_memory_equal(x1, x2, bytes);
  gh_engine_destroy(&fresh);
  gh_engine_destroy(&used);
  free(x1);
  free(x2);
  drop(&other);
  drop(&p);
}

/* Fixed grains stay to the last bit while others relax; positions come back as they were given. */
static void held_grains(void **state) {
  (void)state;
  packing p = read_p150();
  for (int i = 0; i < p.n; i += 3) p.held[i] = 1;
  deform(&p, (double[4]){0.99, 0.01, 0, 0.98});
  for (int i = 0; i < p.n; i++) p.x[2 * i] += 50; /* far from the cell at the origin */
  double *x = malloc(2 * (size_t)p.n * sizeof *x), moved = 0;
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  OK(gh_engine_set(e, p.cell, p.x, NULL));
  OK(gh_engine_get(e, x, NULL));
  assert_memory_equal(x, p.x, 2 * (size_t)p.n * sizeof *x);
  gh_relax_result r;
  OK(gh_engine_relax(
      e, &(gh_relax_options){.tolerance = 1e-9, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r));
  assert_true(r.converged);
  OK(gh_engine_get(e, x, NULL));
  for (int i = 0; i < p.n; i++) {
    if (p.held[i]) assert_memory_equal(&x[2 * i], &p.x[2 * i], 2 * sizeof *x);
    else moved = fmax(moved, hypot(x[2 * i] - p.x[2 * i], x[2 * i + 1] - p.x[2 * i + 1]));
  }
  assert_true(moved > 1e-3);
  outcome o = contacts_of(e);
  for (int i = 0; i < p.n; i++)
    if (!p.held[i]) assert_true(hypot(o.f[2 * i], o.f[2 * i + 1]) <= 1.001e-9 * r.mean_force);
  gh_engine_destroy(&e);
  free(x);
  drop(&p);
}

/* Small and large moves give what setting the same positions gives; small ones keep the neighbour list. */
static void moves(void **state) {
  (void)state;
  const uint64_t first = 7;
  uint64_t seed = first;
  print_message("seed %llu\n", (unsigned long long)first);
  packing p = read_p150();
  gh_engine *a = open_engine(&p, GH_ENGINE_LAMMPS), *b = open_engine(&p, GH_ENGINE_LAMMPS);
  OK(gh_engine_set(a, p.cell, p.x, NULL));
  gh_engine_cost before, after;
  gh_engine_costs(a, &before);
  for (int k = 0; k < 3; k++) {
    for (int m = 0; m < 2 * p.n; m++) p.x[m] += (k == 2 ? 0.1 : 1e-4) * (uniform(&seed) - 0.5);
    OK(gh_engine_move(a, p.x, NULL));
    OK(gh_engine_set(b, p.cell, p.x, NULL));
    assert_same_contacts(contacts_of(a), contacts_of(b), p.n, 1e-12);
    gh_engine_costs(a, &after);
    assert_int_equal(after.rebuilds - before.rebuilds, k == 2);
  }
  gh_engine_destroy(&a);
  gh_engine_destroy(&b);
  drop(&p);
}

/* Relaxation that runs out of steps states so and leaves a consistent state, from which it can continue. */
static void out_of_steps(void **state) {
  (void)state;
  packing p = read_p150();
  deform(&p, (double[4]){0.97, 0, 0, 0.99});
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  gh_relax_result r;
  OK(gh_engine_set(e, p.cell, p.x, NULL));
  OK(gh_engine_relax(e, &(gh_relax_options){.tolerance = 1e-12, .max_steps = 17, .method = GH_RELAX_DAMPED},
                     &r));
  assert_false(r.converged);
  assert_int_equal(r.steps, 17);
  assert_true(r.residual > 1e-3);
  assert_sums(contacts_of(e), p.n, 1e-12);
  OK(gh_engine_relax(
      e, &(gh_relax_options){.tolerance = 1e-9, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r));
  assert_true(r.converged);
  gh_engine_destroy(&e);
  drop(&p);
}

/* ---- errors ---- */

/* Setups out of range and calls before the first set are refused with a message. */
static void bad_setup(void **state) {
  (void)state;
  const double radius[] = {1, 1}, negative[] = {1, -1}, x[4] = {0, 0, 1, 1}, inverted[4] = {0, 1, 1, 0};
  const double unit[4] = {4, 0, 0, 4}, nan_x[4] = {0, 0, NAN, 1};
  const int types[] = {1, 5000};
  gh_engine *e;
  gh_engine_setup s = {
      .n = 2, .radius = radius, .type = types, .periodic = true, .law = {.normal_stiffness = 1}};
  assert_int_equal(gh_engine_create(ctx, GH_ENGINE_LAMMPS, &s, &e), GH_INPUT);
  assert_non_null(strstr(gh_message(ctx), "5000"));
  s.type = NULL;
  s.radius = negative;
  assert_int_equal(gh_engine_create(ctx, GH_ENGINE_LAMMPS, &s, &e), GH_INPUT);
  s.radius = radius;
  OK(gh_engine_create(ctx, GH_ENGINE_LAMMPS, &s, &e));
  outcome o;
  assert_int_equal(list_of(e, &o.c, &o.count, &o.f), GH_ENGINE);
  assert_int_equal(gh_engine_move(e, x, NULL), GH_ENGINE);
  assert_int_equal(gh_engine_set(e, inverted, x, NULL), GH_INPUT);
  assert_int_equal(gh_engine_set(e, unit, nan_x, NULL), GH_INPUT);
  OK(gh_engine_set(e, unit, x, NULL));
  gh_engine_destroy(&e);
}

/* Coinciding centres end in LAMMPS's error: a message with both ids; the engine continues with the next set. */
static void error_in_run(void **state) {
  (void)state;
  packing p = make(3);
  memcpy(p.cell, (double[4]){9, 0, 0, 9}, sizeof p.cell);
  p.radius[0] = p.radius[1] = p.radius[2] = 1;
  const double bad[6] = {1, 1, 4, 4, 4, 4}, good[6] = {1, 1, 4, 4, 5.5, 4};
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  for (int k = 0; k < 3; k++) {
    outcome o;
    assert_int_equal(gh_engine_set(e, p.cell, bad, NULL), GH_DIVERGED); /* as with the native engine */
    assert_non_null(strstr(gh_message(ctx), "coincide"));
    assert_non_null(strstr(gh_message(ctx), "2 and 3"));
    assert_int_equal(list_of(e, &o.c, &o.count, &o.f), GH_ENGINE);
    OK(gh_engine_set(e, p.cell, good, NULL));
    o = contacts_of(e);
    assert_int_equal(o.count, 1);
    assert_near(o.c[0].overlap, 0.5, 1e-13);
  }
  assert_int_equal(gh_engine_set(e, p.cell, bad, NULL), GH_DIVERGED);
  gh_engine_destroy(&e);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(two_disks),  cmocka_unit_test(square_lattice),
                                     cmocka_unit_test(tiny_cells), cmocka_unit_test(no_contact),
                                     cmocka_unit_test(no_memory),  cmocka_unit_test(held_grains),
                                     cmocka_unit_test(moves),      cmocka_unit_test(out_of_steps),
                                     cmocka_unit_test(bad_setup),  cmocka_unit_test(error_in_run)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
