/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The macro problem against closed forms: elements, loads, Newton, supports that fade. */
#include "../macro_help.h"

/* Patch test: boundary displacements of a uniform F on a distorted mesh give that F and its stress
 * everywhere, and no residual inside. */
static void test_patch(void **state) {
  const double F[4] = {1.1, 0.15, -0.05, 0.93}, shift[4][2] = {{6, -4}, {-5, 7}, {4, 5}, {-7, -6}};
  const int inner[4] = {5, 6, 9, 10};
  problem p = make_block(*state, 100, 100, 3, 3, NULL, NULL);
  for (int k = 0; k < 4; k++)
    for (int i = 0; i < 2; i++) p.mesh->X[2 * inner[k] + i] += shift[k][i];
  gh_macro_options o = tight();
  make_macro(&p, &plain, &o);
  for (int a = 0; a < p.mesh->nnodes; a++) {
    const double *X = p.mesh->X + 2 * a;
    bool border = X[0] == 0 || X[0] == 100 || X[1] == 0 || X[1] == 100;
    for (int i = 0; border && i < 2; i++) {
      p.loads->fixed[2 * a + i] = 1;
      p.loads->value[2 * a + i] = F[2 * i] * X[0] + F[2 * i + 1] * X[1] - X[i];
    }
  }
  solve(&p);
  double P[4], A[16], V, v;
  neo_hooke(F, P, A);
  for (int q = 0; q < 36; q++)
    for (int k = 0; k < 4; k++) {
      CLOSE(gh_macro_F(p.macro)[4 * q + k], F[k], 1e-13);
      CLOSE(gh_macro_P(p.macro)[4 * q + k], P[k], 1e-12);
    }
  for (int k = 0; k < 4; k++) {
    const double *X = p.mesh->X + 2 * inner[k], *u = gh_macro_u(p.macro) + 2 * inner[k];
    for (int i = 0; i < 2; i++) {
      CLOSE(u[i], F[2 * i] * X[0] + F[2 * i + 1] * X[1] - X[i], 1e-11);
      CLOSE(gh_macro_reactions(p.macro)[2 * inner[k] + i], 0, 0);
    }
  }
  gh_macro_volumes(p.macro, &V, &v);
  CLOSE(V, 1e4, 1e-9);
  CLOSE(v, 1e4 * gh_det2(F), 1e-9);
  drop(&p);
}

/* The stiffness of a distorted element is the derivative of its forces (central differences); so is that of a
 * follower pressure. */
static void test_stiffness(void **state) {
  problem p = make_block(*state, 2, 1, 1, 1, NULL, NULL);
  const double X[8] = {0.1, -0.2, 2.2, 0.1, 1.8, 1.3, -0.1, 0.9}, step = 1e-6;
  double u[8] = {0.1, 0.2, -0.1, 0.05, 0.3, -0.2, 0.15, 0.1}, F[16], P[16], A[64], K[8][8], f[2][8];
  for (int a = 0; a < 4; a++) memcpy(p.mesh->X + 2 * p.mesh->quad[0][a], X + 2 * a, 2 * sizeof *X);
  int dof[8];
  for (int k = 0; k < 8; k++) dof[k] = 2 * p.mesh->quad[0][k / 2] + k % 2;
  double all[8] = {0};
  for (int k = 0; k < 8; k++) all[dof[k]] = u[k];
  gh_shapes s = {0};
  assert_int_equal(gh_shapes_create(p.ctx, p.mesh, &s), GH_OK);
  gh_element_deformation(&s, p.mesh, 0, all, F);
  for (int g = 0; g < 4; g++) neo_hooke(F + 4 * g, P + 4 * g, A + 16 * g);
  gh_element_stiffness(&s, 0, A, K);
  for (int c = 0; c < 8; c++) {
    for (int side = 0; side < 2; side++) {
      double unused[16], saved = all[dof[c]];
      all[dof[c]] += side ? step : -step;
      gh_element_deformation(&s, p.mesh, 0, all, F);
      for (int g = 0; g < 4; g++) neo_hooke(F + 4 * g, P + 4 * g, unused);
      gh_element_force(&s, 0, P, f[side]);
      all[dof[c]] = saved;
    }
    for (int r = 0; r < 8; r++) CLOSE(K[r][c], (f[1][r] - f[0][r]) / (2 * step), 1e-7);
  }
  double x[4] = {1, 2, 4, 3}, E[4][4];
  gh_edge_stiffness(0.7, E);
  for (int c = 0; c < 4; c++) {
    double side[2][2], y[4];
    for (int k = 0; k < 2; k++) {
      memcpy(y, x, sizeof y);
      y[c] += k ? 0.5 : -0.5;
      gh_edge_force(y, y + 2, 0.7, side[k]);
    }
    for (int r = 0; r < 4; r++) CLOSE(E[r][c], -(side[1][r % 2] - side[0][r % 2]), 1e-14);
  }
  gh_shapes_destroy(&s);
  drop(&p);
}

/* Each iteration squares the residual in the end, with dead and with follower pressure on a distorted mesh.
 */
static void test_quadratic(void **state) {
  for (int follow = 0; follow < 2; follow++) {
    problem p = make_block(*state, 3, 3, 3, 3, NULL, NULL);
    p.mesh->X[2 * 5] += 0.2;
    p.mesh->X[2 * 10 + 1] -= 0.15;
    gh_macro_options o = tight();
    make_macro(&p, &plain, &o);
    fix(&p, "left", 0, 0);
    fix(&p, "left", 1, 0);
    press(&p, "top", 0.4, follow);
    solve(&p);
    int squared = 0;
    for (int k = 0; k + 1 < p.lines; k++) {
      double r = p.line[k].relative, next = p.line[k + 1].relative;
      if (r > 1e-2 || r < 1e-7) continue;
      assert_true(next <= 30 * r * r + 1e-14);
      squared++;
    }
    assert_true(squared >= 1);
    assert_true(p.report.iterations <= 8);
    assert_int_equal(gh_system_method(p.macro->system), follow ? 'u' : 'c');
    drop(&p);
  }
}

/* One element between smooth walls under dead-load pressure: P22 = -q. */
static void test_dead_pressure(void **state) {
  gh_macro_options o = tight();
  problem p = make_block(*state, 2, 3, 1, 1, &plain, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", 4, false);
  solve(&p);
  double x = bisect(confined, 4, 0.1, 1), sum[2];
  for (int q = 0; q < 4; q++) CLOSE(gh_macro_F(p.macro)[4 * q + 3], x, 1e-12);
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "bottom"), sum);
  CLOSE(sum[1], 8, 1e-11);
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "top"), sum);
  CLOSE(sum[1], 0, 0);
  drop(&p);
}

/* A residual that rises once: a search that wants each step to lower it shortens that step, one that compares
 * with the largest of the last few continues with full steps, to the same end. It does so above a given
 * residual alone. */
static void test_search_memory(void **state) {
  const material rough = {.rough = 1};
  for (int k = 0; k < 3; k++) {
    gh_macro_options o = tight();
    o.memory = k ? 5 : 1;
    o.memory_above = k == 2 ? 1e3 : 0;
    problem p = make_block(*state, 2, 3, 1, 1, &rough, &o);
    gh_macro_set_watch(p.macro, watch, &p);
    fix(&p, "left", 0, 0);
    fix(&p, "right", 0, 0);
    fix(&p, "bottom", 1, 0);
    press(&p, "top", 4, false);
    assert_int_equal(gh_macro_balance(p.macro), GH_OK);
    for (int q = 0; q < 4; q++) p.points[q]->evaluations = 0;
    solve(&p);
    double shortest = 1, x = bisect(confined, 4, 0.1, 1);
    bool rises = false;
    for (int q = 0; q < 4; q++) CLOSE(gh_macro_F(p.macro)[4 * q + 3], x, 1e-12);
    for (int l = 1; l < p.lines; l++) {
      shortest = fmin(shortest, p.line[l].step);
      rises = rises || p.line[l].residual > p.line[l - 1].residual;
    }
    assert_true(k == 1 ? rises && shortest == 1 : !rises && shortest < 1);
    drop(&p);
  }
  gh_macro_options o = tight();
  problem p = make_block(*state, 2, 3, 1, 1, &plain, &o);
  gh_macro *other = NULL;
  for (int k = 0; k < 2; k++) {
    o.memory = k ? GH_MACRO_MEMORY + 1 : 0;
    assert_int_equal(gh_macro_create(p.ctx, p.mesh, p.farm, &o, &other), GH_INPUT);
  }
  o.memory = 1;
  o.memory_above = -1;
  assert_int_equal(gh_macro_create(p.ctx, p.mesh, p.farm, &o, &other), GH_INPUT);
  drop(&p);
}

/* Follower pressure all round gives a Cauchy stress of -q: F = diag(x, x). */
static void test_following_pressure(void **state) {
  gh_macro_options o = tight();
  problem p = make_block(*state, 2, 3, 2, 2, &plain, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "right", 4, true);
  press(&p, "top", 4, true);
  solve(&p);
  double x = bisect(isotropic, 4, 0.1, 1), sum[2];
  for (int q = 0; q < 16; q++) {
    CLOSE(gh_macro_F(p.macro)[4 * q], x, 1e-12);
    CLOSE(gh_macro_F(p.macro)[4 * q + 3], x, 1e-12);
  }
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "left"), sum);
  CLOSE(sum[0], 4 * 3 * x, 1e-10);
  drop(&p);
}

/* A column under a small weight g per area sinks by g H^2 / (2 (lambda + 2 mu)), and the bottom carries it.
 */
static void test_gravity(void **state) {
  const double g = 1e-5, b[2] = {0, -g}, H = 4, W = 1;
  gh_macro_options o = tight();
  problem p = make_block(*state, W, H, 1, 8, &plain, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  assert_int_equal(gh_loads_gravity(p.loads, b), GH_OK);
  solve(&p);
  int top = gh_mesh_find(p.mesh, "top");
  double u = gh_macro_u(p.macro)[2 * p.mesh->sets[top].nodes[0] + 1],
         expected = -g * H * H / (2 * (lambda + 2 * mu)), sum[2];
  CLOSE(u / expected, 1, 1e-4);
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "bottom"), sum);
  CLOSE(sum[1] / (g * H * W), 1, 1e-9);
  drop(&p);
}

/* Nodal forces, pressure and gravity together are balanced by the reactions, force and moment. */
static void test_balance_of_forces(void **state) {
  const double b[2] = {0.02, -0.05}, force[2] = {0.03, 0.01};
  gh_macro_options o = tight();
  problem p = make_block(*state, 2, 2, 2, 2, &plain, &o);
  fix(&p, "bottom", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "right", 0.1, true);
  assert_int_equal(gh_loads_force(p.loads, gh_mesh_find(p.mesh, "top"), force), GH_OK);
  assert_int_equal(gh_loads_gravity(p.loads, b), GH_OK);
  solve(&p);
  double sum[3] = {0, 0, 0}, *outer = calloc((size_t)p.macro->ndof, sizeof *outer);
  assert_non_null(outer);
  gh_external_forces(p.macro, p.loads, 1, false, gh_macro_u(p.macro), outer);
  const double *r = gh_macro_reactions(p.macro), *u = gh_macro_u(p.macro);
  for (int a = 0; a < p.mesh->nnodes; a++) {
    double fx = r[2 * a] + outer[2 * a], fy = r[2 * a + 1] + outer[2 * a + 1];
    sum[0] += fx;
    sum[1] += fy;
    sum[2] += (p.mesh->X[2 * a] + u[2 * a]) * fy - (p.mesh->X[2 * a + 1] + u[2 * a + 1]) * fx;
  }
  for (int k = 0; k < 3; k++) CLOSE(sum[k], 0, 1e-12);
  free(outer);
  drop(&p);
}

/* Loading, then unloading to no force at all, comes back to u = 0 although the scale of the residual
 * vanishes. */
static void test_unload(void **state) {
  gh_macro_options o = tight();
  problem p = make_block(*state, 1, 1, 2, 2, &plain, &o);
  for (int k = 0; k < 2; k++) {
    gh_loads_clear(p.loads);
    fix(&p, "left", 0, 0);
    fix(&p, "bottom", 1, 0);
    if (k == 0) press(&p, "top", 1, false);
    solve(&p);
  }
  for (int d = 0; d < p.macro->ndof; d++) CLOSE(gh_macro_u(p.macro)[d], 0, 1e-13);
  drop(&p);
}

/* The same loads again: nothing moves and no iteration is spent. */
static void test_same_again(void **state) {
  gh_macro_options o = tight();
  problem p = make_block(*state, 1, 1, 1, 1, &plain, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", 1, true);
  solve(&p);
  double before = gh_macro_u(p.macro)[7];
  solve(&p);
  assert_int_equal(p.report.iterations, 0);
  assert_true(gh_macro_u(p.macro)[7] == before);
  drop(&p);
}

/* The reaction of a released support fades linearly: half of it is left at half of the increment, nothing at
 * its end. */
static void test_release(void **state) {
  const material brittle = {.limit = 0.06};
  gh_macro_options o = tight();
  problem p = make_block(*state, 1, 1, 1, 1, &brittle, &o);
  for (int k = 0; k < 2; k++) {
    gh_loads_clear(p.loads);
    fix(&p, "left", 0, 0);
    fix(&p, "right", 0, 0);
    fix(&p, "bottom", 1, 0);
    if (k == 0) fix(&p, "top", 1, -0.1); /* in two parts, as the material allows */
    solve(&p);
    assert_int_equal(p.report.substeps, 2);
  }
  const point *q = p.points[0];
  assert_int_equal(q->commits, 4);
  CLOSE(q->committed[1][1], confined(0.9, 0), 1e-12);
  CLOSE(q->committed[2][1], 0.5 * confined(0.9, 0), 1e-12);
  CLOSE(q->committed[3][1], 0, 1e-12);
  for (int d = 0; d < 8; d++) CLOSE(gh_macro_u(p.macro)[d], 0, 1e-12);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_patch),         cmocka_unit_test(test_stiffness),
      cmocka_unit_test(test_quadratic),     cmocka_unit_test(test_dead_pressure),
      cmocka_unit_test(test_search_memory), cmocka_unit_test(test_following_pressure),
      cmocka_unit_test(test_gravity),       cmocka_unit_test(test_balance_of_forces),
      cmocka_unit_test(test_unload),        cmocka_unit_test(test_same_again),
      cmocka_unit_test(test_release),
  };
  return cmocka_run_group_tests(tests, open_context, close_context);
}
