/* The macro problem against closed forms, with material points in closed form. SPDX-License-Identifier:
 * GPL-2.0-or-later
 *
 * The material is a compressible neo-Hooke solid, energy mu/2 (F:F - 2 - 2 ln J) + lambda/2 (ln J)^2, with
 * extras that a packing has too: an initial stress, a limit of the strain increment, a jump of the stress
 * that stays once passed. */
#include "granhom/macro.h"
#include "macro/internal.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* cmocka's own compares as float. */
static void near_at(double a, double b, double limit, const char *file, int line) {
  if (fabs(a - b) <= limit) return;
  print_error("%.17g and %.17g differ by more than %g\n", a, b, limit);
  _fail(file, line);
}
#define assert_near(a, b, limit) near_at(a, b, limit, __FILE__, __LINE__)

static const double mu = 3, lambda = 5;

typedef struct material {
  double prestress[4]; /* constant part of P */
  double limit;        /* largest change of a component of F in one increment; 0: none */
  double skew;         /* P12 += skew (F21): an unsymmetric tangent */
  double jump_at;      /* F22 below this, or once committed below this: P22 += jump; 0: none */
  double jump;
  double rough; /* P22 += rough in the second evaluation of an increment, and in no other */
  bool poison;  /* stress is not a number away from F = I */
  bool empty;   /* no stress, no stiffness */
} material;

typedef struct point {
  gh_context *ctx;
  const material *m;
  double F[4], trial[4], P[4];
  bool jumped, trial_jumped, has_trial;
  int commits, evaluations; /* evaluations: since the last one */
  double committed[64][2];  /* F22, P22 */
} point;

static void neo_hooke(const double F[4], double P[4], double A[16]) {
  double J = gh_det2(F), G[4];
  gh_inv2(F, G);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      P[2 * i + j] = mu * (F[2 * i + j] - G[2 * j + i]) + lambda * log(J) * G[2 * j + i];
      for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++)
          A[8 * i + 4 * j + 2 * k + l] = mu * (i == k && j == l) + lambda * G[2 * j + i] * G[2 * l + k] +
                                         (mu - lambda * log(J)) * G[2 * j + k] * G[2 * l + i];
    }
}

static gh_status evaluate(void *data, const double F[4], unsigned want, double P[4], double A[16]) {
  point *p = data;
  const material *m = p->m;
  (void)want;
  for (int k = 0; k < 4; k++)
    if (m->limit > 0 && fabs(F[k] - p->F[k]) > m->limit)
      return gh_fail(p->ctx, GH_DIVERGED, "strain increment %g exceeds %g", F[k] - p->F[k], m->limit);
  neo_hooke(F, P, A);
  for (int k = 0; k < 4; k++) P[k] += m->prestress[k];
  P[1] += m->skew * F[2];
  A[4 + 2] += m->skew;
  p->trial_jumped = p->jumped || (m->jump_at > 0 && F[3] < m->jump_at);
  if (p->trial_jumped) P[3] += m->jump;
  if (++p->evaluations == 2) P[3] += m->rough;
  if (m->poison && F[0] != 1) P[0] = NAN;
  if (m->empty) {
    memset(P, 0, 4 * sizeof *P);
    memset(A, 0, 16 * sizeof *A);
  }
  memcpy(p->trial, F, sizeof p->trial);
  memcpy(p->P, P, sizeof p->P);
  p->has_trial = true;
  return GH_OK;
}

static gh_status commit(void *data) {
  point *p = data;
  if (!p->has_trial) return GH_OK;
  memcpy(p->F, p->trial, sizeof p->F);
  p->jumped = p->trial_jumped;
  p->has_trial = false;
  p->evaluations = 0;
  if (p->commits < 64) {
    p->committed[p->commits][0] = p->F[3];
    p->committed[p->commits++][1] = p->P[3];
  }
  return GH_OK;
}

static gh_status revert(void *data) {
  ((point *)data)->has_trial = false;
  return GH_OK;
}

enum { LINES = 400 };

/* A mesh, points, loads and the macro, made and freed together. */
typedef struct problem {
  gh_context *ctx;
  gh_mesh *mesh;
  gh_farm *farm;
  gh_loads *loads;
  gh_macro *macro;
  point **points;
  gh_macro_report report;
  gh_macro_iteration line[LINES];
  int lines;
} problem;

static void watch(void *data, const gh_macro_iteration *it) {
  problem *p = data;
  if (p->lines < LINES) p->line[p->lines++] = *it;
}

static void make_farm(problem *p, const material *m) {
  static const gh_point_ops ops = {evaluate, commit, revert, free};
  int n = 4 * p->mesh->nelements;
  p->points = calloc((size_t)n, sizeof *p->points);
  assert_non_null(p->points);
  for (int k = 0; k < n; k++) {
    p->points[k] = calloc(1, sizeof **p->points);
    assert_non_null(p->points[k]);
    *p->points[k] = (point){.ctx = p->ctx, .m = m, .F = {1, 0, 0, 1}};
  }
  assert_int_equal(gh_farm_create(p->ctx, n, &ops, (void **)p->points, &p->farm), GH_OK);
}

static void make_macro(problem *p, const material *m, const gh_macro_options *options) {
  make_farm(p, m);
  assert_int_equal(gh_loads_create(p->ctx, p->mesh, &p->loads), GH_OK);
  assert_int_equal(gh_macro_create(p->ctx, p->mesh, p->farm, options, &p->macro), GH_OK);
  gh_macro_set_watch(p->macro, watch, p);
}

static gh_macro_options tight(void) {
  gh_macro_options o = gh_macro_defaults();
  o.tolerance = 1e-12;
  return o;
}

static problem make_block(const void *ctx, double width, double height, int nx, int ny, const material *m,
                          const gh_macro_options *options) {
  problem p = {.ctx = (gh_context *)(uintptr_t)ctx};
  const double low[2] = {0, 0}, size[2] = {width, height};
  const int n[2] = {nx, ny};
  assert_int_equal(gh_mesh_rectangle(p.ctx, low, size, n, &p.mesh), GH_OK);
  if (m) {
    make_macro(&p, m, options);
    gh_macro_set_watch(p.macro, NULL, NULL); /* p moves when it is returned */
  }
  return p;
}

static void drop(problem *p) {
  gh_macro_destroy(&p->macro);
  gh_loads_destroy(&p->loads);
  gh_farm_destroy(&p->farm);
  gh_mesh_destroy(&p->mesh);
  free(p->points);
}

static void fix(problem *p, const char *edge, int dir, double value) {
  assert_int_equal(gh_loads_displace(p->loads, gh_mesh_find(p->mesh, edge), dir, value), GH_OK);
}

static void press(problem *p, const char *edge, double pressure, bool follow) {
  assert_int_equal(gh_loads_pressure(p->loads, gh_mesh_find(p->mesh, edge), pressure, follow), GH_OK);
}

static void solve(problem *p) {
  gh_status s = gh_macro_solve(p->macro, p->loads, &p->report);
  if (s != GH_OK) fail_msg("%s", gh_message(p->ctx));
}

/* Status must be s and the message must hold `word`. */
static void solve_fails(problem *p, gh_status s, const char *word) {
  assert_int_equal(gh_macro_solve(p->macro, p->loads, &p->report), s);
  if (!strstr(gh_message(p->ctx), word)) fail_msg("\"%s\" lacks \"%s\"", gh_message(p->ctx), word);
}

static const material plain = {0};

/* Zero of f in [a, b], f(a) f(b) < 0. */
static double bisect(double (*f)(double x, double q), double q, double a, double b) {
  bool rising = f(b, q) > 0;
  for (int k = 0; k < 200; k++) {
    double c = 0.5 * (a + b);
    if ((f(c, q) > 0) == rising) b = c;
    else a = c;
  }
  return 0.5 * (a + b);
}

/* P22 + q of neo-Hooke at F = diag(1, x). */
static double confined(double x, double q) {
  return mu * (x - 1 / x) + lambda * log(x) / x + q;
}
/* P22 + q x at F = diag(x, x): Cauchy stress -q all round. */
static double isotropic(double x, double q) {
  return mu * (x - 1 / x) + 2 * lambda * log(x) / x + q * x;
}

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
      assert_near(gh_macro_F(p.macro)[4 * q + k], F[k], 1e-13);
      assert_near(gh_macro_P(p.macro)[4 * q + k], P[k], 1e-12);
    }
  for (int k = 0; k < 4; k++) {
    const double *X = p.mesh->X + 2 * inner[k], *u = gh_macro_u(p.macro) + 2 * inner[k];
    for (int i = 0; i < 2; i++) {
      assert_near(u[i], F[2 * i] * X[0] + F[2 * i + 1] * X[1] - X[i], 1e-11);
      assert_near(gh_macro_reactions(p.macro)[2 * inner[k] + i], 0, 0);
    }
  }
  gh_macro_volumes(p.macro, &V, &v);
  assert_near(V, 1e4, 1e-9);
  assert_near(v, 1e4 * gh_det2(F), 1e-9);
  drop(&p);
}

/* The stiffness of a distorted element is the derivative of its forces (central differences); so is that of a
 * following pressure. */
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
    for (int r = 0; r < 8; r++) assert_near(K[r][c], (f[1][r] - f[0][r]) / (2 * step), 1e-7);
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
    for (int r = 0; r < 4; r++) assert_near(E[r][c], -(side[1][r % 2] - side[0][r % 2]), 1e-14);
  }
  gh_shapes_destroy(&s);
  drop(&p);
}

/* Each iteration squares the residual in the end, with dead and with following pressure on a distorted mesh.
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

/* One element between smooth walls under dead pressure: P22 = -q. */
static void test_dead_pressure(void **state) {
  gh_macro_options o = tight();
  problem p = make_block(*state, 2, 3, 1, 1, &plain, &o);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", 4, false);
  solve(&p);
  double x = bisect(confined, 4, 0.1, 1), sum[2];
  for (int q = 0; q < 4; q++) assert_near(gh_macro_F(p.macro)[4 * q + 3], x, 1e-12);
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "bottom"), sum);
  assert_near(sum[1], 8, 1e-11);
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "top"), sum);
  assert_near(sum[1], 0, 0);
  drop(&p);
}

/* A residual that rises once: a search that wants each step to lower it shortens that step, one that compares
 * with the largest of the last few goes on with full steps, to the same end. It does so above a given
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
    for (int q = 0; q < 4; q++) assert_near(gh_macro_F(p.macro)[4 * q + 3], x, 1e-12);
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

/* Following pressure all round gives a Cauchy stress of -q: F = diag(x, x). */
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
    assert_near(gh_macro_F(p.macro)[4 * q], x, 1e-12);
    assert_near(gh_macro_F(p.macro)[4 * q + 3], x, 1e-12);
  }
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "left"), sum);
  assert_near(sum[0], 4 * 3 * x, 1e-10);
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
  assert_near(u / expected, 1, 1e-4);
  gh_macro_reaction(p.macro, gh_mesh_find(p.mesh, "bottom"), sum);
  assert_near(sum[1] / (g * H * W), 1, 1e-9);
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
  for (int k = 0; k < 3; k++) assert_near(sum[k], 0, 1e-12);
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
  for (int d = 0; d < p.macro->ndof; d++) assert_near(gh_macro_u(p.macro)[d], 0, 1e-13);
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
  assert_near(q->committed[1][1], confined(0.9, 0), 1e-12);
  assert_near(q->committed[2][1], 0.5 * confined(0.9, 0), 1e-12);
  assert_near(q->committed[3][1], 0, 1e-12);
  for (int d = 0; d < 8; d++) assert_near(gh_macro_u(p.macro)[d], 0, 1e-12);
  drop(&p);
}

/* A material that fails beyond a strain increment: the increment is cut and still ends where it should; with
 * too few cuts it fails, keeps the last converged state, names the reason, and can go on with smaller loads.
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
    assert_near(gh_macro_P(p.macro)[3], confined(0.9, 0), 1e-12);
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
  assert_near(gh_macro_P(p.macro)[3], -q * parts / 64, 1e-11);
  assert_false(p.points[0]->has_trial);
  gh_loads_clear(p.loads);
  fix(&p, "left", 0, 0);
  fix(&p, "right", 0, 0);
  fix(&p, "bottom", 1, 0);
  press(&p, "top", 0.5 * q0, true);
  solve(&p);
  assert_near(gh_macro_F(p.macro)[3], bisect(confined, 0.5 * q0, 0.5, 1), 1e-11);
  drop(&p);
}

/* A stress in the gap of a jump: no F reaches it from state n. The jump is passed, counted, and the end is
 * the equilibrium on its far side; without leave to pass it the increment fails and says where. */
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
        for (int g = 0; g < 4; g++) assert_near(gh_macro_F(p.macro)[4 * g + 3], x, 1e-11);
        if (!soft) assert_true(p.report.jumps >= 1);
        gh_energy e;
        gh_macro_energy(p.macro, &e);
        assert_true(p.report.jumps > 0 ? e.freed > 0 : e.freed == 0);
        assert_near(e.outer_work - e.inner_work, e.freed, 1e-12);
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
    assert_near(gh_work_defect(&e), 0, 1e-11);
    assert_true(e.freed == 0 && e.residual <= o.tolerance && isnan(e.energy)); /* these are no packings */
    gh_macro_zero_energy(p.macro);
    solve(&p);
    gh_macro_energy(p.macro, &e);
    assert_near(e.inner_work, 0, 1e-12 * energy);
    gh_loads_clear(p.loads); /* the top is released: its reaction fades, and so does the pressure */
    for (int i = 0; i < 2; i++) fix(&p, "bottom", i, 0);
    solve(&p);
    gh_macro_energy(p.macro, &e);
    assert_true(e.inner_work < -0.5 * energy);
    assert_near(gh_work_defect(&e), 0, 1e-11);
    drop(&p);
  }
  for (int k = 1; k < 3; k++) assert_near(log2(error[k - 1] / error[k]), 2, 0.1);
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
  solve_fails(&p, GH_INPUT, "free in x, in y and to turn");
  fix(&p, "bottom", 1, 0);
  solve_fails(&p, GH_INPUT, "free in x");
  gh_loads_clear(p.loads);
  p.loads->fixed[0] = p.loads->fixed[1] = 1; /* a hinge */
  solve_fails(&p, GH_INPUT, "to turn");
  p.loads->fixed[5] = 1; /* a roller at the same height that bears it in y */
  solve(&p);
  p.loads->fixed[5] = 0;
  p.loads->fixed[4] = 1; /* and one that acts through the hinge */
  solve_fails(&p, GH_INPUT, "to turn");
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
  solve_fails(&p, GH_INPUT, "body with node 2 at (2, 0) free in x, in y and to turn");
  fix(&p, "right", 0, 0.25);
  fix(&p, "right", 1, 0);
  solve(&p);
  assert_near(gh_macro_u(p.macro)[2 * 2], 0.25, 1e-12);
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
    assert_near(gh_macro_reactions(p.macro)[d], 0, 1e-15);
  }
  assert_int_equal(gh_macro_balance(p.macro), GH_INPUT);
  press(&p, "top", 4, false);
  solve(&p);
  assert_near(gh_macro_F(p.macro)[3], bisect(confined, 4, 0.1, 1), 1e-11);
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
    assert_near(gh_macro_F(p.macro)[4 * q + 3], bisect(confined, 0.1 - 0.3, 0.5, 2), 1e-12);
    assert_near(gh_macro_P(p.macro)[4 * q + 3], -0.1, 1e-12);
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
  assert_near(sum[1], confined(0.9, 0), 1e-13);
  drop(&p);
}

static int make_context(void **state) {
  gh_context *ctx = NULL;
  int failed = gh_context_create(&ctx) != GH_OK;
  *state = ctx;
  return failed;
}

static int drop_context(void **state) {
  gh_context *ctx = *state;
  gh_context_destroy(&ctx);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_patch),          cmocka_unit_test(test_stiffness),
      cmocka_unit_test(test_quadratic),      cmocka_unit_test(test_dead_pressure),
      cmocka_unit_test(test_search_memory),  cmocka_unit_test(test_following_pressure),
      cmocka_unit_test(test_gravity),        cmocka_unit_test(test_balance_of_forces),
      cmocka_unit_test(test_unload),         cmocka_unit_test(test_same_again),
      cmocka_unit_test(test_release),        cmocka_unit_test(test_cuts),
      cmocka_unit_test(test_partial),        cmocka_unit_test(test_jump),
      cmocka_unit_test(test_work),           cmocka_unit_test(test_no_supports),
      cmocka_unit_test(test_two_bodies),     cmocka_unit_test(test_input),
      cmocka_unit_test(test_breakdown),      cmocka_unit_test(test_unsymmetric),
      cmocka_unit_test(test_initial_stress), cmocka_unit_test(test_confinement),
      cmocka_unit_test(test_all_prescribed),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
