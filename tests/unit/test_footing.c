/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The rigid massless footing, with material points in closed form.
 *
 * The material is a compressible neo-Hooke solid, energy mu/2 (F:F - 2 - 2 ln J) + lambda/2 (ln J)^2, with a
 * limit of the strain increment, a jump of the stress that stays, and an unsymmetric part where a test wants
 * them. */
#include "footing_help.h"

/* A move keeps all distances, and a turned footing moved by a turned dq is the turned move (random motions).
 */
static void test_kinematics(void **state) {
  gh_context *ctx = *state;
  problem p;
  unsigned long long seed = 20261;
  make(&p, ctx, &plain, true);
  begin(&p);
  put(&p, 0, 0, 0);
  OK(gh_footings_begin(p.macro, p.loads));
  const gh_footing *f = p.macro->footing;
  size_t ndof = (size_t)p.macro->ndof;
  double *u = calloc(ndof, sizeof *u), *v = calloc(ndof, sizeof *v), *w = calloc(ndof, sizeof *w), Q[4];
  for (int trial = 0; trial < 20; trial++) {
    double dq[3], turned[3];
    for (int i = 0; i < 3; i++) dq[i] = 6 * uniform(&seed) - 3;
    rotation(6 * uniform(&seed), Q);
    memset(u, 0, ndof * sizeof *u);
    gh_footing_move(p.mesh, f, dq, u, v);
    for (size_t a = 0; a < ndof / 2; a++) { /* u = (Q - 1) X */
      const double *X = p.mesh->X + 2 * a;
      for (int i = 0; i < 2; i++) u[2 * a + (size_t)i] = Q[2 * i] * X[0] + Q[2 * i + 1] * X[1] - X[i];
    }
    for (int i = 0; i < 2; i++) turned[i] = Q[2 * i] * dq[0] + Q[2 * i + 1] * dq[1];
    turned[2] = dq[2];
    gh_footing_move(p.mesh, f, turned, u, w);
    for (int k = 0; k < f->set->nnodes; k++) {
      int a = f->set->nodes[k], b = f->set->nodes[0];
      const double *X = p.mesh->X + 2 * a, *Y = p.mesh->X + 2 * b;
      double x[2] = {X[0] + v[2 * a], X[1] + v[2 * a + 1]}, y[2] = {Y[0] + v[2 * b], Y[1] + v[2 * b + 1]};
      NEAR("distance", hypot(x[0] - y[0], x[1] - y[1]), hypot(X[0] - Y[0], X[1] - Y[1]), 1e-14);
      for (int i = 0; i < 2; i++)
        NEAR("turned move", X[i] + w[2 * a + i], Q[2 * i] * x[0] + Q[2 * i + 1] * x[1], 2e-14);
    }
  }
  free(u), free(v), free(w);
  drop(&p);
}

/* A central force on a symmetric block: no turn. The same displacement prescribed at the edge gives the same
 * body, and reactions that sum to the force. */
static void test_central(void **state) {
  gh_context *ctx = *state;
  problem p, q;
  double u[2], turn, sum[3], s[2];
  make(&p, ctx, &plain, true);
  begin(&p);
  put(&p, 0, 0, -4);
  solve(&p);
  gh_macro_footing(p.macro, p.top, u, &turn);
  assert_true(u[1] < -0.1);
  NEAR("turn", turn, 0, 1e-13);
  NEAR("sideways", u[0], 0, 1e-13);
  contact(&p, 0, sum);
  NEAR("force", sum[1], -4, 1e-10);
  make(&q, ctx, &plain, true);
  begin(&q);
  OK(gh_loads_displace(q.loads, q.top, 0, 0));
  OK(gh_loads_displace(q.loads, q.top, 1, u[1]));
  solve(&q);
  NEAR("body", distance(gh_macro_u(p.macro), gh_macro_u(q.macro), p.macro->ndof), 0, 1e-10);
  gh_macro_reaction(q.macro, q.top, s);
  NEAR("force", s[1], -4, 1e-10);
  NEAR("force", s[0], 0, 1e-10);
  drop(&p), drop(&q);
}

/* An eccentric and inclined force: the footing rotates to the loaded side and stays rigid; forces and moments
 * balance; holding all its nodes where they are gives the same body. The whole in one increment or in four is
 * the same. */
static void test_eccentric(void **state) {
  gh_context *ctx = *state;
  for (int side = -1; side <= 1; side += 2) {
    problem p, q, r;
    double u[2], turn, sum[3];
    make(&p, ctx, &plain, true);
    begin(&p);
    put(&p, 0.4 * side, 0.7, -4);
    solve(&p);
    gh_macro_footing(p.macro, p.top, u, &turn);
    assert_true(side * turn < -0.1); /* a turn that is finite indeed */
    NEAR("rigid", strain(&p), 0, 1e-13);
    contact(&p, 0.4 * side, sum);
    NEAR("horizontal force", sum[0], 0.7, 1e-10);
    NEAR("vertical force", sum[1], -4, 1e-10);
    NEAR("moment", sum[2], 0, 1e-10);
    make(&q, ctx, &plain, true);
    begin(&q);
    for (int k = 0; k < edge(&p)->nnodes; k++)
      for (int i = 0; i < 2; i++) {
        int dof = 2 * edge(&p)->nodes[k] + i;
        q.loads->fixed[dof] = 1;
        q.loads->value[dof] = gh_macro_u(p.macro)[dof];
      }
    solve(&q);
    NEAR("body", distance(gh_macro_u(p.macro), gh_macro_u(q.macro), p.macro->ndof), 0, 1e-10);
    NEAR("reactions", distance(gh_macro_reactions(p.macro), gh_macro_reactions(q.macro), p.macro->ndof), 0,
         1e-9);
    make(&r, ctx, &plain, true);
    for (int k = 1; k <= 4; k++) {
      begin(&r);
      put(&r, 0.4 * side, 0.7 * k / 4, -1.0 * k);
      solve(&r);
    }
    NEAR("path", distance(gh_macro_u(p.macro), gh_macro_u(r.macro), p.macro->ndof), 0, 1e-10);
    drop(&p), drop(&q), drop(&r);
  }
}

/* Stiffness of the mesh and of the footing at g->now. */
static void assemble(problem *p) {
  gh_context *ctx = p->ctx;
  gh_macro *g = p->macro;
  OK(gh_macro_evaluate(g, &g->now));
  gh_external_forces(g, p->loads, 1, true, g->now.u, g->fext);
  for (int d = 0; d < g->ndof; d++) g->trial[d] = g->now.fint[d] - g->fext[d];
  gh_system_clear(g->system);
  for (int e = 0; e < p->mesh->nelements; e++) {
    double K[8][8];
    int dof[8];
    for (int k = 0; k < 8; k++) dof[k] = 2 * p->mesh->quad[e][k / 2] + k % 2;
    gh_element_stiffness(&g->shapes, e, g->now.A + 64 * e, K);
    gh_system_add(g->system, 8, dof, K[0]);
  }
  gh_footings_tangent(g, p->loads, 1, g->now.u, g->trial);
}

/* Residual, nodal and reduced, at the length s along x from g->now. */
static void residual_at(problem *p, double s, const double *x, double *R) {
  gh_context *ctx = p->ctx;
  gh_macro *g = p->macro;
  const double *q = x + g->ndof;
  for (int d = 0; d < g->ndof; d++) g->next.u[d] = g->now.u[d] + s * x[d];
  gh_footing_move(p->mesh, g->footing, (double[3]){s * q[0], s * q[1], s * q[2]}, g->now.u, g->next.u);
  OK(gh_macro_evaluate(g, &g->next));
  for (int d = 0; d < g->ndof; d++) R[d] = g->next.fint[d] - g->fext[d];
  gh_footings_residual(g, p->loads, 1, true, g->next.u, R);
}

/* The reduced tangent, by way of its inverse: x = K^-1 b, and the residual's central difference along x is b,
 * at a rotated unbalanced state, with a symmetric and an unsymmetric material (CHOLMOD, UMFPACK).
 */
static void test_tangent(void **state) {
  gh_context *ctx = *state;
  for (int skewed = 0; skewed < 2; skewed++) {
    const material m = {.skew = skewed * 0.5};
    unsigned long long seed = 7;
    problem p;
    make(&p, ctx, &m, true);
    begin(&p);
    put(&p, 0.3, 0.5, -2);
    solve(&p);
    gh_macro *g = p.macro;
    int n = g->ndof + 3;
    double *b = calloc((size_t)n, sizeof *b), *x = calloc((size_t)n, sizeof *x),
           *R = calloc((size_t)n, sizeof *R), *S = calloc((size_t)n, sizeof *S);
    gh_footing_move(p.mesh, g->footing, (double[3]){0.02, -0.03, 0.05}, g->eq.u, g->now.u);
    assemble(&p);
    for (int d = 0; d < n; d++)
      if (d >= g->ndof || (!p.loads->fixed[d] && g->owner[d / 2] < 0)) b[d] = 2 * uniform(&seed) - 1;
    OK(gh_system_solve(g->system, b, x));
    assert_int_equal(gh_system_method(g->system), skewed ? 'u' : 'c');
    const double step = 1e-6 / norm(x, n);
    residual_at(&p, -step, x, R);
    residual_at(&p, step, x, S);
    for (int d = 0; d < n; d++)
      if (b[d] != 0) NEAR("tangent", (S[d] - R[d]) / (2 * step), b[d], 2e-7 * norm(x, n));
    free(b), free(x), free(R), free(S);
    drop(&p);
  }
}

/* Each iteration squares the residual in the end. */
static void test_quadratic(void **state) {
  gh_context *ctx = *state;
  for (int skewed = 0; skewed < 2; skewed++) {
    const material m = {.skew = skewed * 0.5};
    problem p;
    make(&p, ctx, &m, true);
    begin(&p);
    put(&p, 0.4, 0.7, -4);
    solve(&p);
    int squared = 0;
    for (int k = 0; k + 1 < p.lines; k++) {
      double r = p.line[k].relative, next = p.line[k + 1].relative;
      if (r > 1e-2 || r < 1e-6) continue;
      if (!(next <= 30 * r * r + 1e-13)) fail_msg("a residual of %g is followed by %g", r, next);
      squared++;
    }
    assert_true(squared >= 1);
    assert_true(p.report.iterations <= 9);
    assert_int_equal(p.report.cuts, 0);
    drop(&p);
  }
}

/* Cuts lead to the same end, and so does a footing on which the way is turned round: loads taken off. */
static void test_cuts(void **state) {
  gh_context *ctx = *state;
  const material timid = {.limit = 0.1};
  problem p, q;
  make(&p, ctx, &plain, true);
  make(&q, ctx, &timid, true);
  begin(&p), begin(&q);
  put(&p, 0.4, 0.7, -4), put(&q, 0.4, 0.7, -4);
  solve(&p), solve(&q);
  assert_true(q.report.cuts > 0);
  NEAR("end", distance(gh_macro_u(p.macro), gh_macro_u(q.macro), p.macro->ndof), 0, 1e-10);
  begin(&q);
  put(&q, 0.4, 0, 0);
  solve(&q);
  NEAR("unloaded", norm(gh_macro_u(q.macro), q.macro->ndof), 0, 1e-10);
  drop(&p), drop(&q);
}

/* An instability of the material is stepped over under a footing: it ends in equilibrium with the force, also
 * where the tangent is unsymmetric. */
static void test_jump(void **state) {
  gh_context *ctx = *state;
  for (int skewed = 0; skewed < 2; skewed++) {
    const material collapsing = {.skew = 0.2 * skewed, .jump_at = 0.95, .jump = 0.3};
    problem p;
    double sum[3], u[2], turn;
    int jumps = 0;
    make(&p, ctx, &collapsing, true);
    for (int k = 1; k <= 8; k++) {
      begin(&p);
      put(&p, 0.3, 0.05 * k, -0.25 * k);
      solve(&p);
      jumps += p.report.jumps;
    }
    assert_true(jumps > 0);
    contact(&p, 0.3, sum);
    NEAR("horizontal force", sum[0], 0.4, 1e-9);
    NEAR("vertical force", sum[1], -2, 1e-9);
    NEAR("moment", sum[2], 0, 1e-9);
    NEAR("rigid", strain(&p), 0, 1e-13);
    gh_macro_footing(p.macro, p.top, u, &turn);
    assert_true(turn < 0 && u[1] < 0);
    drop(&p);
  }
}

/* The plate below is driven aside and up while the force acts: the prediction carries body and footing along,
 * and nothing else changes. */
static void test_driven(void **state) {
  gh_context *ctx = *state;
  const double by[2] = {0.3, -0.7};
  problem p;
  double u[2], v[2], turn, turned;
  make(&p, ctx, &plain, true);
  begin(&p);
  put(&p, 0.3, 0.2, -2);
  solve(&p);
  gh_macro_footing(p.macro, p.top, u, &turn);
  begin(&p);
  for (int i = 0; i < 2; i++) OK(gh_loads_displace(p.loads, gh_mesh_find(p.mesh, "bottom"), i, by[i]));
  put(&p, 0.3, 0.2, -2);
  solve(&p);
  gh_macro_footing(p.macro, p.top, v, &turned);
  assert_true(turn < -0.01);
  NEAR("turn", turned, turn, 1e-12);
  for (int i = 0; i < 2; i++) NEAR("way", v[i] - u[i], by[i], 1e-12);
  assert_true(p.report.iterations <= 2);
  drop(&p);
}

/* The load of a footing does the work that the solid takes up; turning costs the trapezoidal rule a third
 * order of the turn in each increment, so that halving the increments leaves a quarter. */
static void test_work(void **state) {
  gh_context *ctx = *state;
  double defect[3];
  for (int k = 0; k < 3; k++) {
    const int n = 4 << k;
    problem p;
    gh_energy e;
    make(&p, ctx, &plain, false);
    for (int j = 1; j <= n; j++) {
      begin(&p);
      put(&p, 0.5, 0.4 * j / n, -3.0 * j / n);
      OK(gh_loads_pressure(p.loads, p.top, 0.3 * j / n, true)); /* on the nodes of the footing as well */
      solve(&p);
    }
    gh_macro_energy(p.macro, &e);
    defect[k] = fabs(gh_work_defect(&e));
    if (getenv("ESTIMATE_TELL")) printf("footing, %d increments: work imbalance %.3e\n", n, defect[k]);
    drop(&p);
  }
  assert_true(defect[2] < 1e-3);
  for (int k = 1; k < 3; k++) NEAR("order", log2(defect[k - 1] / defect[k]), 2, 0.2);
}

/* A footing on ground that has moved takes the ground as it is, at rest; when it is taken away again, the
 * body goes back to where it was without it. */
static void test_later(void **state) {
  gh_context *ctx = *state;
  const double b[2] = {0.1, -0.4};
  problem p;
  make(&p, ctx, &plain, true);
  size_t bytes = (size_t)p.macro->ndof * sizeof(double);
  double *before = malloc(bytes), sum[3], u[2], v[2], turn, start;
  for (int stage = 0; stage < 4; stage++) {
    begin(&p);
    OK(gh_loads_gravity(p.loads, b));
    if (stage == 1) put(&p, 0.2, 0, 0);
    if (stage == 2) put(&p, 0.2, 0, -2);
    solve(&p);
    if (stage == 0) {
      memcpy(before, gh_macro_u(p.macro), bytes);
      gh_macro_footing(p.macro, p.top, u, &start);
    }
    if (stage == 1) NEAR("at rest", distance(before, gh_macro_u(p.macro), p.macro->ndof), 0, 0);
    if (stage != 2) continue;
    contact(&p, 0, sum);
    NEAR("force", sum[1], -2, 1e-10);
    gh_macro_footing(p.macro, p.top, v, &turn);
    assert_true(turn < start && v[1] < u[1]);
  }
  NEAR("taken away", distance(before, gh_macro_u(p.macro), p.macro->ndof), 0, 1e-10);
  free(before);
  drop(&p);
}

/* Two forces on one footing are their sum, force and moment, also where the second comes later and the first
 * goes. */
static void test_two_forces(void **state) {
  gh_context *ctx = *state;
  problem p, q;
  double sum[3];
  make(&p, ctx, &plain, true);
  make(&q, ctx, &plain, true);
  begin(&p), begin(&q);
  put(&p, -0.2, 0, -1), put(&p, 0.6, 0, -3);
  put(&q, 0.4, 0, -4); /* 0.4 = (-0.2 + 3 0.6)/4 */
  solve(&p), solve(&q);
  NEAR("sum", distance(gh_macro_u(p.macro), gh_macro_u(q.macro), p.macro->ndof), 0, 1e-11);
  begin(&p);
  put(&p, -0.5, 0.2, -2);
  solve(&p);
  contact(&p, -0.5, sum);
  NEAR("moved force", sum[1], -2, 1e-10);
  NEAR("moment", sum[2], 0, 1e-10);
  drop(&p), drop(&q);
}

/* The whole top as a footing, at an upright edge, and one that carries a body without supports of its own. */
static void test_supports(void **state) {
  gh_context *ctx = *state;
  problem p;
  double at[2];
  make(&p, ctx, &plain, false);
  gh_footing_point(p.mesh, p.top, 0.5, at);
  NEAR("x", at[0], 0.5, 1e-15);
  NEAR("y", at[1], 2, 1e-15);
  gh_footing_point(p.mesh, gh_mesh_find(p.mesh, "left"), 0.5, at);
  NEAR("x", at[0], -2, 1e-15);
  NEAR("y", at[1], 1.5, 1e-15);
  gh_loads_clear(p.loads);
  put(&p, 0, 0, -1);
  FAILS(gh_macro_solve(p.macro, p.loads, &p.report), GH_INPUT, "free in x, in y and in rotation");
  begin(&p);
  OK(gh_loads_displace(p.loads, gh_mesh_find(p.mesh, "left"), 0, 0));
  put(&p, 0, 0, -1);
  FAILS(gh_macro_solve(p.macro, p.loads, &p.report), GH_INPUT, "the footing on top holds node");
  drop(&p);
}

static void test_bad_input(void **state) {
  gh_context *ctx = *state;
  const double at[2] = {0, 2}, force[2] = {0, -1}, wrong[2] = {0, NAN};
  problem p;
  make(&p, ctx, &plain, false);
  FAILS(gh_loads_footing(p.loads, 99, at, force), GH_INPUT, "set 99");
  FAILS(gh_loads_footing(p.loads, p.top, at, wrong), GH_INPUT, "not finite");
  FAILS(gh_loads_footing(p.loads, p.top, wrong, force), GH_INPUT, "not finite");
  OK(gh_loads_footing(p.loads, p.top, at, force));
  FAILS(gh_loads_footing(p.loads, gh_mesh_find(p.mesh, "left"), at, force), GH_INPUT,
        "top and left share node");
  gh_loads_clear(p.loads);
  p.mesh->X[2 * edge(&p)->nodes[3] + 1] += 0.01;
  FAILS(gh_loads_footing(p.loads, p.top, at, force), GH_INPUT, "straight");
  p.mesh->sets[p.top].nedges = 0;
  FAILS(gh_loads_footing(p.loads, p.top, at, force), GH_INPUT, "needs edges");
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_kinematics), TEST(test_central),    TEST(test_eccentric),
                                     TEST(test_tangent),    TEST(test_quadratic),  TEST(test_cuts),
                                     TEST(test_jump),       TEST(test_driven),     TEST(test_work),
                                     TEST(test_later),      TEST(test_two_forces), TEST(test_supports),
                                     TEST(test_bad_input)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
