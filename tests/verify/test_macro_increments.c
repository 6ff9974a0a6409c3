/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The macro problem against closed forms: increments that are bisected or meet an instability, work, wrong
 * input. */
#include "../macro_help.h"

/* A material that fails beyond a strain increment: the increment is cut and still ends where it should; with
 * too few cuts it fails, keeps the last converged state, names the reason, and can continue with smaller
 * loads.
 */
static void test_cuts(void **state) {
  const material brittle = {.limit = 0.03};
  gh_macro_options o = tight();
  for (int few = 0; few < 2; few++) {
    o.cut_steps = few ? 1 : 6;
    problem p = make_block(*state, 1, 1, 1, 1, &brittle, &o);
    fix(&p, "left", 0, 0);
    fix(&p, "right", 0, 0);
    fix(&p, "bottom", 1, 0);
    fix(&p, "top", 1, -0.1);
    if (few) {
      solve_fails(&p, GH_DIVERGED, "strain increment");
      assert_non_null(strstr(gh_message(p.ctx), "integration point"));
      for (int d = 0; d < 8; d++) assert_true(gh_macro_u(p.macro)[d] == 0);
      fix(&p, "top", 1, -0.05);
      solve(&p);
      fix(&p, "top", 1, -0.1);
    }
    solve(&p);
    if (!few) assert_true(p.report.cuts >= 2 && p.report.substeps >= 4);
    CLOSE(gh_macro_P(p.macro)[3], confined(0.9, 0), 1e-12);
    assert_int_equal(p.report.jumps, 0);
    drop(&p);
  }
}

/* An increment that fails half-way leaves the last part that converged, and other loads can follow from
 * there. */
static void test_partial(void **state) {
  const material bistable = {.jump_at = 0.95, .jump = -0.2};
  const double q0 = -confined(0.95, 0), q = q0 + 0.1; /* in the gap: no F has this stress */
  gh_macro_options o = tight();
  o.pass_jumps = false;
  problem p = make_block(*state, 1, 1, 1, 1, &bistable, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", q, true);
  solve_fails(&p, GH_DIVERGED, "the residual creeps");
  double parts = floor(64 * q0 / q); /* the increment is cut six times */
  CLOSE(gh_macro_P(p.macro)[3], -q * parts / 64, 1e-11);
  assert_false(p.points[0]->has_trial);
  gh_loads_clear(p.loads);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", 0.5 * q0, true);
  solve(&p);
  CLOSE(gh_macro_F(p.macro)[3], bisect(confined, 0.5 * q0, 0.5, 1), 1e-11);
  drop(&p);
}

/* A stress in the gap of a jump: no F reaches it from state n. The jump is passed, counted, and the end is
 * the equilibrium on its far side; without leave to pass it the increment fails and states where. */
static void test_jump(void **state) {
  const double q0 = -confined(0.95, 0);
  for (int soft = 0; soft < 2; soft++) {
    const material bistable = {.jump_at = 0.95, .jump = soft ? 0.2 : -0.2};
    const double q =
        q0 + (soft ? 0.02 : 0.1); /* beyond what the near side carries, and below what the far side does */
    for (int pass = 0; pass < 2; pass++) {
      gh_macro_options o = tight();
      o.pass_jumps = pass;
      problem p = make_block(*state, 1, 1, 1, 1, &bistable, &o);
      fix(&p, "left", 0, 0);
      fix(&p, "right", 0, 0);
      fix(&p, "bottom", 1, 0);
      press(&p, "top", q, false);
      if (!pass && !soft) solve_fails(&p, GH_DIVERGED, "most abruptly at integration point");
      if (pass) {
        solve(&p);
        double x = bisect(confined, q + bistable.jump, 0.2, 1.5);
        for (int g = 0; g < 4; g++) CLOSE(gh_macro_F(p.macro)[4 * g + 3], x, 1e-11);
        if (!soft) assert_true(p.report.jumps >= 1);
        gh_energy e;
        gh_macro_energy(p.macro, &e);
        assert_true(p.report.jumps > 0 ? e.freed > 0 : e.freed == 0);
        CLOSE(e.outer_work - e.inner_work, e.freed, 1e-12);
        assert_true(p.report.relative <= o.tolerance);
      }
      drop(&p);
    }
  }
}

static double stored(const double F[4]) {
  double J = gh_det2(F), FF = 0;
  for (int k = 0; k < 4; k++) FF += F[k] * F[k];
  return 0.5 * mu * (FF - 2 - 2 * log(J)) + 0.5 * lambda * log(J) * log(J);
}

/* The trapezoidal work of the stress is the energy of the solid up to the second order in the increments;
 * loads that press and follow, driven edges and reactions that fade do the same work from outside. */
static void test_work(void **state) {
  const material even = {.prestress = {0.1, 0, 0, 0.1}};
  double error[3];
  for (int k = 0; k < 3; k++) {
    const int n = 2 << k;
    gh_macro_options o = tight();
    problem p = make_block(*state, 2, 1, 2, 2, &plain, &o);
    double energy = 0;
    gh_energy e;
    for (int j = 1; j <= n; j++) {
      gh_loads_clear(p.loads);
      for (int i = 0; i < 2; i++) fix(&p, "bottom", i, 0);
      fix(&p, "top", 1, -0.1 * j / n);
      press(&p, "right", 0.5 * j / n, true);
      solve(&p);
    }
    for (int q = 0; q < 16; q++) energy += stored(gh_macro_F(p.macro) + 4 * q) / 8;
    gh_macro_energy(p.macro, &e);
    error[k] = fabs(e.inner_work - energy);
    CLOSE(gh_work_defect(&e), 0, 1e-11);
    assert_true(e.freed == 0 && e.residual <= o.tolerance && isnan(e.energy)); /* these are no packings */
    gh_macro_zero_energy(p.macro);
    solve(&p);
    gh_macro_energy(p.macro, &e);
    CLOSE(e.inner_work, 0, 1e-12 * energy);
    gh_loads_clear(p.loads); /* the top is released: its reaction fades, and so does the pressure */
    for (int i = 0; i < 2; i++) fix(&p, "bottom", i, 0);
    solve(&p);
    gh_macro_energy(p.macro, &e);
    assert_true(e.inner_work < -0.5 * energy);
    CLOSE(gh_work_defect(&e), 0, 1e-11);
    drop(&p);
  }
  for (int k = 1; k < 3; k++) CLOSE(log2(error[k - 1] / error[k]), 2, 0.1);
  gh_macro_options o = tight();
  problem p = make_block(*state, 1, 1, 1, 1, &even, &o); /* held by fixed forces: no work at all */
  gh_energy e;
  for (int i = 0; i < 2; i++) fix(&p, "bottom", i, 0);
  assert_int_equal(gh_macro_balance(p.macro), GH_OK);
  solve(&p);
  gh_macro_energy(p.macro, &e);
  assert_true(e.inner_work == 0 && e.outer_work == 0 && gh_work_defect(&e) == 0);
  drop(&p);
}

/* What the supports leave free is named before anything is computed. */
static void test_no_supports(void **state) {
  gh_macro_options o = tight();
  problem p = make_block(*state, 2, 1, 2, 1, &plain, &o);
  press(&p, "top", 1, false);
  solve_fails(&p, GH_INPUT, "free in x, in y and in rotation");
  fix(&p, "bottom", 1, 0);
  solve_fails(&p, GH_INPUT, "free in x");
  gh_loads_clear(p.loads);
  p.loads->fixed[0] = p.loads->fixed[1] = 1; /* a hinge */
  solve_fails(&p, GH_INPUT, "in rotation");
  p.loads->fixed[5] = 1; /* a roller at the same height that bears it in y */
  solve(&p);
  p.loads->fixed[5] = 0;
  p.loads->fixed[4] = 1; /* and one that acts through the hinge */
  solve_fails(&p, GH_INPUT, "in rotation");
  drop(&p);
}

/* Of two bodies, the one that nothing holds is found. */
static void test_two_bodies(void **state) {
  gh_macro_options o = tight();
  problem p = make_block(*state, 3, 1, 3, 1, NULL, NULL);
  memcpy(p.mesh->quad[1], p.mesh->quad[2], sizeof p.mesh->quad[1]); /* the middle one is taken out */
  p.mesh->nelements = 2;
  make_macro(&p, &plain, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "left", 1, 0);
  solve_fails(&p, GH_INPUT, "body with node 2 at (2, 0) free in x, in y and in rotation");
  fix(&p, "right", 0, 0.25);
  fix(&p, "right", 1, 0);
  solve(&p);
  CLOSE(gh_macro_u(p.macro)[2 * 2], 0.25, 1e-12);
  drop(&p);
}

/* Wrong input of the macro: an inverted element, too few points, options and loads out of range. */
static void test_input(void **state) {
  gh_macro_options o = gh_macro_defaults(), wrong = o;
  problem p = make_block(*state, 2, 1, 2, 1, &plain, &o);
  gh_macro *other = NULL;
  double x = p.mesh->X[4];
  p.mesh->X[4] = 0.5;
  assert_int_equal(gh_macro_create(p.ctx, p.mesh, p.farm, &o, &other), GH_INPUT);
  p.mesh->X[4] = x;
  p.mesh->nelements = 1;
  assert_int_equal(gh_macro_create(p.ctx, p.mesh, p.farm, &o, &other), GH_INPUT);
  p.mesh->nelements = 2;
  wrong.tolerance = -1;
  assert_int_equal(gh_macro_create(p.ctx, p.mesh, p.farm, &wrong, &other), GH_INPUT);
  assert_null(other);
  assert_int_equal(gh_loads_displace(p.loads, 7, 0, 0), GH_INPUT);
  assert_int_equal(gh_loads_displace(p.loads, 0, 2, 0), GH_INPUT);
  assert_int_equal(gh_loads_displace(p.loads, 0, 0, NAN), GH_INPUT);
  assert_int_equal(gh_loads_pressure(p.loads, 0, INFINITY, false), GH_INPUT);
  assert_int_equal(gh_loads_gravity(p.loads, (const double[2]){0, NAN}), GH_INPUT);
  drop(&p);
}

/* A motion that turns elements inside out, a stress that is not a number and a material without stiffness
 * each end with their own message and leave the state as it was. */
static void test_breakdown(void **state) {
  const material poison = {.poison = true}, empty = {.empty = true};
  const material *const kinds[] = {&plain, &poison, &empty};
  const char *const words[] = {"inside out", "stress of integration point 0 is not finite", "singular"};
  gh_macro_options o = gh_macro_defaults();
  for (int k = 0; k < 3; k++) {
    problem p = make_block(*state, 1, 1, 1, 1, kinds[k], &o);
    fix(&p, "left", 0, 0);
    fix(&p, "bottom", 1, 0);
    if (k == 0) {
      fix(&p, "bottom", 0, 0);
      fix(&p, "top", 0, 0);
      fix(&p, "top", 1, -2);
      fix(&p, "right", 0, 0);
    } else press(&p, "right", 1, false);
    solve_fails(&p, GH_DIVERGED, words[k]);
    assert_true(gh_finite(gh_macro_u(p.macro), 8));
    drop(&p);
  }
}

/* A material with an unsymmetric tangent goes to the unsymmetric solver and converges as fast. */
static void test_unsymmetric(void **state) {
  const material twisted = {.skew = 0.5};
  gh_macro_options o = tight();
  problem p = make_block(*state, 1, 1, 3, 3, &twisted, &o);
  fix(&p, "bottom", 0, 0);
  fix(&p, "bottom", 1, 0);
  fix(&p, "top", 0, 0.1);
  fix(&p, "top", 1, 0);
  solve(&p);
  assert_int_equal(gh_system_method(p.macro->system), 'u');
  assert_true(p.report.iterations <= 6);
  drop(&p);
}

/* An initial stress that is balanced keeps the body where it is, without supports' reactions; then a load is
 * carried as from the unstressed state in the small. */
static void test_initial_stress(void **state) {
  const material stressed = {.prestress = {-0.2, 0.01, 0.01, -0.3}};
  gh_macro_options o = tight();
  problem p = make_block(*state, 1, 1, 2, 2, &stressed, &o);
  assert_int_equal(gh_macro_balance(p.macro), GH_OK);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  solve(&p);
  assert_int_equal(p.report.iterations, 0);
  for (int d = 0; d < p.macro->ndof; d++) {
    assert_true(gh_macro_u(p.macro)[d] == 0);
    CLOSE(gh_macro_reactions(p.macro)[d], 0, 1e-15);
  }
  assert_int_equal(gh_macro_balance(p.macro), GH_INPUT);
  press(&p, "top", 4, false);
  solve(&p);
  CLOSE(gh_macro_F(p.macro)[3], bisect(confined, 4, 0.1, 1), 1e-11);
  drop(&p);
}

/* Without balancing, the initial stress works against the supports and the load: P22 = -q in the end. */
static void test_confinement(void **state) {
  const material stressed = {.prestress = {-0.2, 0, 0, -0.3}};
  gh_macro_options o = tight();
  problem p = make_block(*state, 1, 1, 2, 2, &stressed, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", 0.1, false);
  solve(&p);
  for (int q = 0; q < 16; q++) {
    CLOSE(gh_macro_F(p.macro)[4 * q + 3], bisect(confined, 0.1 - 0.3, 0.5, 2), 1e-12);
    CLOSE(gh_macro_P(p.macro)[4 * q + 3], -0.1, 1e-12);
  }
  drop(&p);
}

/* All degrees of freedom prescribed: nothing to solve, the reactions are the internal forces. */
static void test_all_prescribed(void **state) {
  gh_macro_options o = tight();
  problem p = make_block(*state, 1, 1, 1, 1, &plain, &o);
  for (int d = 0; d < 8; d++) p.loads->fixed[d] = 1;
  p.loads->value[5] = p.loads->value[7] = -0.1;
  solve(&p);
  double sum[2];
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "top"), sum);
  CLOSE(sum[1], confined(0.9, 0), 1e-13);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cuts),        cmocka_unit_test(test_partial),
      cmocka_unit_test(test_jump),        cmocka_unit_test(test_work),
      cmocka_unit_test(test_no_supports), cmocka_unit_test(test_two_bodies),
      cmocka_unit_test(test_input),       cmocka_unit_test(test_breakdown),
      cmocka_unit_test(test_unsymmetric), cmocka_unit_test(test_initial_stress),
      cmocka_unit_test(test_confinement), cmocka_unit_test(test_all_prescribed),
  };
  return cmocka_run_group_tests(tests, open_context, close_context);
}
