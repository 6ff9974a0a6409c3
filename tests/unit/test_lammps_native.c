/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The LAMMPS engine against the native one: contacts, forces, equilibria. */
#include "lammps_help.h"

static const double deformations[][4] = {
    {1, 0, 0, 1}, {1, 0.03, 0, 1}, {1, 0.8, 0.1, 1}, {0.98, 0, 0, 0.99}, {1, -2.3, 0, 1}};

/* Contacts and forces of 150 grains equal those of the native engine, deformed and turned. */
static void same_as_native(void **state) {
  (void)state;
  packing p = read_p150();
  gh_engine *lammps = open_engine(&p, GH_ENGINE_LAMMPS), *native = open_engine(&p, GH_ENGINE_NATIVE);
  for (size_t k = 0; k < sizeof deformations / sizeof *deformations; k++)
    for (int turn = 0; turn < 2; turn++) {
      packing q = read_p150();
      double Q[4];
      rotation(30 * turn, Q);
      deform(&q, deformations[k]);
      deform(&q, Q);
      OK(gh_engine_set(lammps, q.cell, q.x, NULL));
      OK(gh_engine_set(native, q.cell, q.x, NULL));
      outcome a = contacts_of(lammps), b = contacts_of(native);
      assert_true(a.count > 100);
      assert_same_contacts(a, b, q.n, 1e-12);
      assert_sums(a, q.n, 1e-12);
      drop(&q);
    }
  gh_engine_destroy(&lammps);
  gh_engine_destroy(&native);
  drop(&p);
}

/* A cluster in free space has the contacts of the native engine, wherever it is; grains alone have none. */
static void cluster_as_native(void **state) {
  (void)state;
  packing p = read_p150();
  p.cluster = true;
  gh_engine *lammps = open_engine(&p, GH_ENGINE_LAMMPS), *native = open_engine(&p, GH_ENGINE_NATIVE);
  for (int k = 0; k < 4; k++) {
    deform(&p, (double[4]){1.003, 0.4, -0.5, 0.9});
    for (int i = 0; i < p.n; i++) p.x[2 * i] += 100 * k;
    OK(gh_engine_set(lammps, NULL, p.x, NULL));
    OK(gh_engine_set(native, NULL, p.x, NULL));
    assert_same_contacts(contacts_of(lammps), contacts_of(native), p.n, 1e-12);
  }
  gh_engine_destroy(&lammps);
  gh_engine_destroy(&native);
  drop(&p);
  packing one = make(1);
  one.cluster = true;
  one.radius[0] = 2;
  gh_engine *e = open_engine(&one, GH_ENGINE_LAMMPS);
  OK(gh_engine_set(e, NULL, one.x, NULL));
  assert_int_equal(contacts_of(e).count, 0);
  gh_engine_destroy(&e);
  drop(&one);
}

/* Takes out the contacts without force: where a rattler rests depends on round-off. */
static int loaded(outcome o, double limit, gh_contact *out) {
  int n = 0;
  for (int k = 0; k < o.count; k++)
    if (hypot(o.c[k].f[0], o.c[k].f[1]) > limit) out[n++] = o.c[k];
  return n;
}

/* Relaxed to 1e-11, both engines are in the same equilibrium: forces and branch vectors of loaded contacts
 * agree to 1e-9 (rattlers, and with them the translation of the rest, are free).
 */
static void relax_as_native(void **state) {
  (void)state;
  packing p = read_p150();
  double Q[4];
  gh_contact *c[2];
  gh_relax_result r[2];
  int count[2];
  rotation(30, Q);
  deform(&p, (double[4]){0.985, 0.01, 0, 0.99});
  deform(&p, Q);
  for (int k = 0; k < 2; k++) {
    gh_engine *e = open_engine(&p, k ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS);
    c[k] = calloc(20 * (size_t)p.n, sizeof *c[k]);
    OK(gh_engine_set(e, p.cell, p.x, NULL));
    OK(gh_engine_relax(
        e, &(gh_relax_options){.tolerance = 1e-11, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r[k]));
    assert_true(r[k].converged && r[k].residual <= 1e-11);
    outcome o = contacts_of(e);
    double largest = 0;
    for (int i = 0; i < p.n; i++) largest = fmax(largest, hypot(o.f[2 * i], o.f[2 * i + 1]));
    assert_near(largest / r[k].mean_force, r[k].residual, 2e-12); /* the residual is what the forces say */
    count[k] = loaded(o, 1e-6 * r[k].mean_force, c[k]);
    gh_engine_destroy(&e);
  }
  assert_near(r[0].mean_force, r[1].mean_force, 1e-9 * r[1].mean_force);
  assert_int_equal(count[0], count[1]);
  for (int k = 0; k < count[0]; k++)
    for (int m = 0; m < 2; m++) {
      const gh_contact *a = &c[0][k], *b = &c[1][k];
      assert_true(a->i == b->i && a->j == b->j);
      assert_near(a->f[m], b->f[m], 1e-9 * r[1].mean_force);
      assert_near(a->l[m], b->l[m], 1e-9 * hypot(b->l[0], b->l[1]));
    }
  for (int k = 0; k < 2; k++) free(c[k]);
  drop(&p);
}

/* A cluster with fixed grains relaxes to the native engine's equilibrium, and moves as it does. */
static void cluster_relaxes_as_native(void **state) {
  (void)state;
  packing p = read_p150();
  p.cluster = true;
  for (int i = 0; i < p.n; i++) p.held[i] = fmax(fabs(p.x[2 * i]), fabs(p.x[2 * i + 1])) > 0.6;
  deform(&p, (double[4]){0.99, 0.01, 0, 0.985});
  gh_contact *c[2];
  int count[2];
  gh_relax_result r[2];
  double *x = calloc(2 * (size_t)p.n, sizeof *x);
  for (int k = 0; k < 2; k++) {
    gh_engine *e = open_engine(&p, k ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS);
    c[k] = calloc(20 * (size_t)p.n, sizeof *c[k]);
    OK(gh_engine_set(e, NULL, p.x, NULL));
    OK(gh_engine_relax(
        e, &(gh_relax_options){.tolerance = 1e-11, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r[k]));
    assert_true(r[k].converged);
    OK(gh_engine_get(e, x, NULL));
    for (int i = 0; i < p.n; i++)
      if (p.held[i]) assert_memory_equal(&x[2 * i], &p.x[2 * i], 2 * sizeof *x);
    OK(gh_engine_move(e, x, NULL));
    count[k] = loaded(contacts_of(e), 1e-6 * r[k].mean_force, c[k]);
    gh_engine_destroy(&e);
  }
  assert_int_equal(count[0], count[1]);
  for (int k = 0; k < count[0]; k++)
    for (int m = 0; m < 2; m++) assert_near(c[0][k].f[m], c[1][k].f[m], 1e-9 * r[1].mean_force);
  free(c[0]);
  free(c[1]);
  free(x);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(same_as_native), cmocka_unit_test(cluster_as_native),
                                     cmocka_unit_test(relax_as_native),
                                     cmocka_unit_test(cluster_relaxes_as_native)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
