/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Material points in closed form, and a block of them, for the tests of the macro problem. */
#ifndef GRANHOM_TESTS_MACRO_HELP_H
#define GRANHOM_TESTS_MACRO_HELP_H

#include "loads_help.h"
#include "macro/internal.h"
#include "neo_hooke.h"

#define CLOSE(a, b, limit) NEAR(#a, a, b, limit)

static const double mu = 3, lambda = 5;

typedef struct material {
  double prestress[4]; /* constant part of P */
  double limit;        /* largest change of a component of F in one increment; 0: none */
  double skew;         /* P12 += skew (F21): an unsymmetric tangent */
  double jump_at;      /* F22 below this, or once committed below this: P22 += jump; 0: none */
  double jump;
  double rough; /* P22 += rough in the second evaluation of an increment, and in no other */
  double dip;   /* P22 += dip exp(-z^2), z = (F22 - 0.9) / 0.02: a branch that softens; 0: none */
  bool poison;  /* stress is not a number away from F = I */
  bool empty;   /* no stress, no stiffness */
} material;

typedef struct point {
  gh_context *ctx;
  const material *m;
  double F[4], trial[4], P[4];
  bool jumped, trial_jumped, has_trial;
  int commits, evaluations; /* evaluations: since the last one */
  int tangents;             /* evaluations that a tangent was wanted of */
  double committed[64][2];  /* F22, P22 */
} point;

static inline void neo_hooke(const double F[4], double P[4], double A[16]) {
  neo_hooke_of(mu, lambda, F, P, A);
}

static inline gh_status evaluate(void *data, const double F[4], unsigned want, double P[4], double A[16]) {
  point *p = data;
  const material *m = p->m;
  p->tangents += (want & GH_WANT_TANGENT) != 0;
  for (int k = 0; k < 4; k++)
    if (m->limit > 0 && fabs(F[k] - p->F[k]) > m->limit)
      return gh_fail(p->ctx, GH_DIVERGED, "strain increment %g exceeds %g", F[k] - p->F[k], m->limit);
  neo_hooke(F, P, A);
  for (int k = 0; k < 4; k++) P[k] += m->prestress[k];
  P[1] += m->skew * F[2];
  A[4 + 2] += m->skew;
  if (m->dip != 0) {
    const double z = (F[3] - 0.9) / 0.02, bump = m->dip * exp(-z * z);
    P[3] += bump;
    A[15] -= 2 * z / 0.02 * bump;
  }
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

static inline gh_status commit(void *data) {
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

static inline gh_status revert(void *data) {
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
  int lines; /* of the last solution */
  int top;   /* the set below a footing */
} problem;

static inline void watch(void *data, const gh_macro_iteration *it) {
  problem *p = data;
  if (p->lines < LINES) p->line[p->lines++] = *it;
}

static inline void make_farm(problem *p, const material *m) {
  static const gh_point_ops ops = {evaluate, commit, revert, free, NULL};
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

static inline void make_macro(problem *p, const material *m, const gh_macro_options *options) {
  make_farm(p, m);
  assert_int_equal(gh_loads_create(p->ctx, p->mesh, &p->loads), GH_OK);
  assert_int_equal(gh_macro_create(p->ctx, p->mesh, p->farm, options, &p->macro), GH_OK);
  gh_macro_set_watch(p->macro, watch, p);
}

static inline gh_macro_options tight(void) {
  gh_macro_options o = gh_macro_defaults();
  o.tolerance = 1e-12;
  return o;
}

static inline problem make_block(const void *ctx, double width, double height, int nx, int ny,
                                 const material *m, const gh_macro_options *options) {
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

static inline void drop(problem *p) {
  gh_macro_destroy(&p->macro);
  gh_loads_destroy(&p->loads);
  gh_farm_destroy(&p->farm);
  gh_mesh_destroy(&p->mesh);
  free(p->points);
}

static inline void fix(problem *p, const char *edge, int dir, double value) {
  loads_hold(p->ctx, p->loads, p->mesh, edge, dir, value);
}

static inline void press(problem *p, const char *edge, double pressure, bool follow) {
  assert_int_equal(gh_loads_pressure(p->loads, gh_mesh_find(p->mesh, edge), pressure, follow), GH_OK);
}

static inline void solve(problem *p) {
  gh_context *ctx = p->ctx;
  p->lines = 0;
  OK(gh_macro_solve(p->macro, p->loads, &p->report));
}

/* Status must be s and the message must hold `word`. */
static inline void solve_fails(problem *p, gh_status s, const char *word) {
  assert_int_equal(gh_macro_solve(p->macro, p->loads, &p->report), s);
  if (!strstr(gh_message(p->ctx), word)) fail_msg("\"%s\" lacks \"%s\"", gh_message(p->ctx), word);
}

static const material plain = {0};

/* Zero of f in [a, b], f(a) f(b) < 0. */
static inline double bisect(double (*f)(double x, double q), double q, double a, double b) {
  bool rising = f(b, q) > 0;
  for (int k = 0; k < 200; k++) {
    double c = 0.5 * (a + b);
    if ((f(c, q) > 0) == rising) b = c;
    else a = c;
  }
  return 0.5 * (a + b);
}

/* P22 + q of neo-Hooke at F = diag(1, x). */
static inline double confined(double x, double q) {
  return mu * (x - 1 / x) + lambda * log(x) / x + q;
}
/* P22 + q x at F = diag(x, x): Cauchy stress -q all round. */
static inline double isotropic(double x, double q) {
  return mu * (x - 1 / x) + 2 * lambda * log(x) / x + q * x;
}

#endif
