/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Explicit relaxation of the macro problem: the equilibria of Newton's iteration and of closed forms, from
 * stresses alone; what does not come to rest; where Newton stops. */
#include "../unit/footing_help.h"

static gh_macro_options relaxing(double tolerance) {
  gh_macro_options o = gh_macro_defaults();
  o.method = GH_METHOD_RELAXATION;
  o.tolerance = tolerance;
  o.max_iterations = 4000;
  return o;
}

/* No point was asked for a tangent, and no matrix was factorised. */
static void stress_alone(const problem *p) {
  for (int q = 0; q < p->macro->npoints; q++) assert_int_equal(p->points[q]->tangents, 0);
  assert_int_equal(gh_system_method(p->macro->system), 0);
  assert_null(gh_macro_A(p->macro));
}

static double apart(const problem *a, const problem *b) {
  double off = 0, size = 0;
  for (int d = 0; d < a->macro->ndof; d++) {
    off = fmax(off, fabs(gh_macro_u(a->macro)[d] - gh_macro_u(b->macro)[d]));
    size = fmax(size, fabs(gh_macro_u(b->macro)[d]));
  }
  return off / size;
}

/* Increment k of 4 of a path with driven edges, dead and follower pressure, weight and a release. */
static void load_block(problem *p, int k) {
  gh_loads_clear(p->loads);
  for (int i = 0; i < 2; i++) fix(p, "bottom", i, 0);
  if (k < 4) fix(p, "top", 1, -0.04 * k);
  press(p, "right", 0.1 * k, true);
  press(p, "left", 0.05 * k, false);
  assert_int_equal(gh_loads_gravity(p->loads, (const double[2]){0.02 * k, -0.1 * k}), GH_OK);
}

/* The closer to rest, the closer to Newton's solution. */
static void test_block(void **state) {
  const double tolerances[] = {1e-3, 1e-6, 1e-9};
  const gh_macro_options o = tight();
  problem exact = make_block(*state, 2, 1, 4, 3, &plain, &o);
  for (int j = 0; j < 3; j++) {
    const gh_macro_options r = relaxing(tolerances[j]);
    problem p = make_block(*state, 2, 1, 4, 3, &plain, &r);
    for (int k = 1; k <= 4; k++) {
      load_block(&p, k);
      solve(&p);
      assert_true(p.report.relative <= r.tolerance && p.report.relaxed == p.report.iterations);
      assert_int_equal(p.report.cuts, 0);
      if (j == 0) load_block(&exact, k), solve(&exact);
    }
    stress_alone(&p);
    assert_true(apart(&p, &exact) < 30 * tolerances[j]);
    drop(&p);
  }
  assert_int_equal(exact.report.relaxed, 0);
  drop(&exact);
}

/* Under a pressure all round, and driven without anything free: closed forms. */
static void test_closed_forms(void **state) {
  const gh_macro_options r = relaxing(1e-10);
  problem p = make_block(*state, 2, 1, 3, 2, &plain, &r);
  fix(&p, "left", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "right", 0.5, true);
  press(&p, "top", 0.5, true);
  solve(&p);
  const double x = bisect(isotropic, 0.5, 0.5, 1);
  for (int q = 0; q < 24; q++) {
    CLOSE(gh_macro_F(p.macro)[4 * q], x, 1e-8);
    CLOSE(gh_macro_F(p.macro)[4 * q + 3], x, 1e-8);
  }
  solve(&p); /* the same again: there is no work to compare with, but it comes to rest there */
  assert_true(p.report.iterations < 40);
  CLOSE(gh_macro_F(p.macro)[0], x, 1e-8);
  gh_loads_clear(p.loads); /* down to no force at all */
  fix(&p, "left", 0, 0);
  fix(&p, "bottom", 1, 0);
  solve(&p);
  CLOSE(gh_macro_F(p.macro)[0], 1, 1e-8);
  stress_alone(&p);
  drop(&p);
  p = make_block(*state, 1, 1, 1, 1, &plain, &r);
  for (int i = 0; i < 2; i++) fix(&p, "bottom", i, 0), fix(&p, "top", i, -0.1 * i);
  solve(&p);
  CLOSE(gh_macro_P(p.macro)[3], confined(0.9, 0), 1e-12);
  drop(&p);
}

/* A footing with an eccentric load moves and turns as with Newton. */
static void test_footing(void **state) {
  problem p[2];
  double u[2][2], turn[2];
  for (int j = 0; j < 2; j++) {
    make(p + j, *state, &plain, true);
    if (j) {
      const gh_macro_options r = relaxing(1e-9);
      gh_macro_destroy(&p[j].macro);
      assert_int_equal(gh_macro_create(p[j].ctx, p[j].mesh, p[j].farm, &r, &p[j].macro), GH_OK);
    }
    gh_macro_set_watch(p[j].macro, NULL, NULL);
    for (int k = 1; k <= 2; k++) {
      begin(p + j);
      put(p + j, 0.25, 0.1 * k, -0.6 * k);
      solve(p + j);
    }
    gh_macro_footing(p[j].macro, p[j].top, u[j], turn + j);
  }
  stress_alone(p + 1);
  assert_true(fabs(turn[0]) > 1e-3);
  CLOSE(turn[1], turn[0], 1e-6 * fabs(turn[0]));
  for (int i = 0; i < 2; i++) CLOSE(u[1][i], u[0][i], 1e-6 * fabs(u[0][i]));
  CLOSE(strain(p + 1), 0, 1e-12);
  drop(p), drop(p + 1);
}

/* What does not come to rest is bisected, fails, and leaves the last state that did. */
static void test_no_rest(void **state) {
  gh_macro_options r = relaxing(1e-6);
  r.max_iterations = 5;
  r.cut_steps = 2;
  problem p = make_block(*state, 2, 1, 4, 3, &plain, &r);
  load_block(&p, 1);
  solve_fails(&p, GH_DIVERGED, "does not come to rest in 5 steps");
  assert_non_null(strstr(gh_message(p.ctx), "no equilibrium after 2 bisections"));
  assert_null(strstr(gh_message(p.ctx), "acoustic"));
  assert_int_equal(p.report.cuts, 2);
  for (int d = 0; d < p.macro->ndof; d++) assert_true(gh_macro_u(p.macro)[d] == 0);
  for (int q = 0; q < p.macro->npoints; q++) assert_int_equal(p.points[q]->commits, 0);
  stress_alone(&p);
  drop(&p);
  const material bistable = {.jump_at = 0.95, .jump = -0.2}; /* a load in the gap: no F carries it */
  r = relaxing(1e-6);
  r.max_iterations = 300;
  p = make_block(*state, 1, 1, 1, 1, &bistable, &r);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", 0.1 - confined(0.95, 0), false);
  solve_fails(&p, GH_DIVERGED, "does not come to rest in 300 steps");
  assert_true(gh_macro_F(p.macro)[3] >= 0.95 && gh_macro_F(p.macro)[3] < 0.96);
  drop(&p);
}

static double dipped(double x, double q) {
  const double z = (x - 0.9) / 0.02;
  return confined(x, q) + 0.6 * exp(-z * z);
}

/* Beyond a limit load Newton's iteration is caught where the residual is smallest; relaxation goes down to
 * the branch behind, which needs no instability to be stepped over. */
static void test_automatic(void **state) {
  const material soft = {.dip = 0.6};
  const double q = 0.8; /* the near branch carries 0.6 or so */
  for (int automatic = 0; automatic < 2; automatic++) {
    gh_macro_options o = tight();
    o.tolerance = 1e-9;
    o.method = automatic ? GH_METHOD_AUTOMATIC : GH_METHOD_NEWTON;
    o.pass_jumps = false;
    problem p = make_block(*state, 1, 1, 2, 2, &soft, &o);
    fix(&p, "left", 0, 0);
    fix(&p, "right", 0, 0);
    fix(&p, "bottom", 1, 0);
    press(&p, "top", q, false);
    if (automatic) {
      solve(&p);
      const double x = bisect(dipped, q, 0.5, 0.9);
      for (int g = 0; g < 16; g++) CLOSE(gh_macro_F(p.macro)[4 * g + 3], x, 1e-8);
      assert_true(p.report.relaxed > 0 && p.report.relaxed < p.report.iterations);
      assert_true(p.report.jumps == 0 && p.report.relative <= o.tolerance);
      press(&p, "top", 0.2, false); /* to 1: and Newton continues from there */
      solve(&p);
      assert_int_equal(p.report.relaxed, 0);
    } else solve_fails(&p, GH_DIVERGED, "no equilibrium");
    drop(&p);
  }
}

/* A load in the gap of a discontinuity: relaxation tries once, and then Newton steps over it as ever. */
static void test_gap(void **state) {
  const material bistable = {.jump_at = 0.95, .jump = -0.2};
  const double q = 0.1 - confined(0.95, 0);
  gh_macro_options o = tight();
  o.method = GH_METHOD_AUTOMATIC;
  problem p = make_block(*state, 1, 1, 1, 1, &bistable, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", q, false);
  solve(&p);
  for (int g = 0; g < 4; g++)
    CLOSE(gh_macro_F(p.macro)[4 * g + 3], bisect(confined, q + bistable.jump, 0.2, 1.5), 1e-11);
  assert_true(p.report.jumps >= 1 && p.report.relaxed >= 150 && p.report.relaxed < 400);
  drop(&p);
}

static void test_names(void **state) {
  gh_macro_method method;
  gh_macro *other = NULL;
  for (int k = 0; k < 3; k++) {
    assert_true(gh_macro_method_from_name(gh_macro_method_name((gh_macro_method)k), &method));
    assert_int_equal(method, k);
  }
  assert_false(gh_macro_method_from_name("explicit", &method));
  gh_macro_options o = relaxing(1e-3);
  problem p = make_block(*state, 1, 1, 1, 1, &plain, &o);
  const double bad[] = {0, -1, NAN, INFINITY};
  for (int k = 0; k < 4; k++) {
    gh_macro_options wrong = o;
    wrong.safety = bad[k];
    assert_int_equal(gh_macro_create(p.ctx, p.mesh, p.farm, &wrong, &other), GH_INPUT);
    wrong = o;
    wrong.damping_ratio = bad[k];
    assert_int_equal(gh_macro_create(p.ctx, p.mesh, p.farm, &wrong, &other), GH_INPUT);
  }
  o.method = (gh_macro_method)7;
  assert_int_equal(gh_macro_create(p.ctx, p.mesh, p.farm, &o, &other), GH_INPUT);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_block),     cmocka_unit_test(test_closed_forms),
                                     cmocka_unit_test(test_footing),   cmocka_unit_test(test_no_rest),
                                     cmocka_unit_test(test_automatic), cmocka_unit_test(test_gap),
                                     cmocka_unit_test(test_names)};
  return cmocka_run_group_tests(tests, open_context, close_context);
}
