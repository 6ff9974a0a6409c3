/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Element tests with packings: closed form of a lattice, energy, the same path without control. */
#include "element_help.h"

/* P = -sqrt(3) E (1 - c) 1 at F = c 1, so that the pressure p needs c = sqrt(3) E / (sqrt(3) E + p). */
static void test_lattice(void **state) {
  gh_context *ctx = *state;
  static const char *const words[4] = {"pressure", "s11 - s22", "s12", "F21"};
  const double E = 100;
  for (int kind = 0; kind < 2; kind++) {
    if (!use_engine((gh_engine_kind)kind)) continue;
    gh_packing *p = lattice(ctx, 4, 0.5);
    gh_rve *rve = make_rve(ctx, p, (gh_engine_kind)kind, GH_PERIODIC, E, 1e-10);
    gh_control_options o = gh_control_defaults();
    gh_control *c;
    const double start[4] = {0.9999, 0, 0, 0.9999};
    o.stiffness = E;
    o.tolerance = 1e-11;
    OK(gh_control_create_rve(ctx, rve, &o, &c));
    OK(gh_control_start(c, start));
    for (double pressure = 0.5; pressure < 5; pressure *= 2) {
      const double target[4] = {pressure, 0, 0, 0}, x = sqrt(3) * E / (sqrt(3) * E + pressure),
                   F[4] = {x, 0, 0, x};
      gh_control_report r;
      OK(solve(ctx, c, words, target, &r));
      NEAR("F", distance(gh_control_F(c), F, 4), 0, 1e-11);
      assert_int_equal(r.jumps, 0);
    }
    gh_control_destroy(&c);
    gh_rve_destroy(&rve);
    gh_packing_destroy(&p);
  }
}

/* Work of P along F, by the trapezoidal rule, less the energy gained, over the work; from the same start with
 * n increments. */
static double imbalance(gh_context *ctx, const gh_packing *p, int n) {
  static const char *const words[4] = {"F22", "s11", "s12", "F21"};
  gh_rve *rve = make_rve(ctx, p, GH_ENGINE_NATIVE, GH_PERIODIC, 1000, 1e-11);
  gh_control_options o = gh_control_defaults();
  gh_control *c;
  o.stiffness = 1000;
  o.tolerance = 1e-9;
  OK(gh_control_create_rve(ctx, rve, &o, &c));
  OK(gh_control_start(c, identity));
  double s[4], work = 0, energy = gh_rve_measure(rve)->energy;
  gh_cauchy2(gh_control_P(c), gh_control_F(c), s);
  for (int k = 1; k <= n; k++) {
    double F[4], P[4];
    const double target[4] = {1 - 0.001 * k / n, s[0], s[1], 0};
    memcpy(F, gh_control_F(c), sizeof F);
    memcpy(P, gh_control_P(c), sizeof P);
    gh_control_report r;
    OK(solve(ctx, c, words, target, &r));
    assert_int_equal(r.parts, 1);
    double now[4];
    gh_cauchy2(gh_control_P(c), gh_control_F(c), now);
    NEAR("side stress", now[0], s[0], 1e-9 * fabs(now[3]));
    NEAR("shear stress", now[1], s[1], 1e-9 * fabs(now[3]));
    for (int a = 0; a < 4; a++) work += (gh_control_F(c)[a] - F[a]) * (gh_control_P(c)[a] + P[a]) / 2;
  }
  double gained = gh_rve_measure(rve)->energy - energy;
  gh_control_destroy(&c);
  gh_rve_destroy(&rve);
  return fabs(work - gained) / fabs(work);
}

/* Biaxial compression of a dense packing at its own side stress: the work of the outer stress is stored, with
 * an error of second order in the increment. */
static void test_energy(void **state) {
  gh_context *ctx = *state;
  if (!use_engine(GH_ENGINE_NATIVE)) return;
  gh_packing *p = case_packing(ctx, "p150d");
  double coarse = imbalance(ctx, p, 4), fine = imbalance(ctx, p, 16);
  print_message("work and energy differ by %.3g with 4 increments, %.3g with 16\n", coarse, fine);
  assert_true(coarse < 1e-3);
  assert_true(fine < coarse / 8);
  gh_packing_destroy(&p);
}

/* The state after an element test is that of a run along the same F without control. */
static void test_same_as_path(void **state) {
  gh_context *ctx = *state;
  static const char *const words[4] = {"volume", "F12", "s11 - s22", "F21"};
  if (!use_engine(GH_ENGINE_NATIVE)) return;
  gh_packing *p = case_packing(ctx, "p150d");
  gh_rve *rve = make_rve(ctx, p, GH_ENGINE_NATIVE, GH_PERIODIC, 1000, 1e-10),
         *other = make_rve(ctx, p, GH_ENGINE_NATIVE, GH_PERIODIC, 1000, 1e-10);
  gh_control_options o = gh_control_defaults();
  gh_control *c;
  double P[4];
  o.stiffness = 1000;
  OK(gh_control_create_rve(ctx, rve, &o, &c));
  OK(gh_control_start(c, identity));
  OK(gh_rve_evaluate(other, identity, 0, P, NULL));
  OK(gh_rve_commit(other));
  double s[4];
  gh_cauchy2(gh_control_P(c), identity, s);
  for (int k = 1; k <= 4; k++) {
    const double target[4] = {1, 5e-5 * k, s[0] - s[3], 0};
    gh_control_report r;
    OK(solve(ctx, c, words, target, &r));
    assert_int_equal(r.parts, 1);
    NEAR("J", gh_det2(gh_control_F(c)), 1, 1e-13);
    assert_int_equal(distance(gh_rve_F(rve), gh_control_F(c), 4) > 0, 0);
    OK(gh_rve_evaluate(other, gh_control_F(c), 0, P, NULL));
    OK(gh_rve_commit(other));
    NEAR("P", distance(P, gh_control_P(c), 4), 0, 0);
  }
  gh_control_destroy(&c);
  gh_rve_destroy(&rve);
  gh_rve_destroy(&other);
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_lattice), TEST(test_energy), TEST(test_same_as_path)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
