/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A block under a footing, with material points in closed form. */
#ifndef GRANHOM_TESTS_FOOTING_HELP_H
#define GRANHOM_TESTS_FOOTING_HELP_H

#include "../help.h"
#include "granhom/macro.h"
#include "macro/internal.h"

static const double mu = 3, lambda = 5;

typedef struct material {
  double limit;         /* largest change of a component of F in one increment; 0: none */
  double skew;          /* P12 += skew F21 */
  double jump_at, jump; /* F22 below this, or once committed below this: P22 += jump; 0: none */
} material;

typedef struct point {
  gh_context *ctx;
  const material *m;
  double F[4], trial[4];
  bool jumped, trial_jumped;
} point;

static inline gh_status evaluate(void *data, const double F[4], unsigned want, double P[4], double A[16]) {
  point *p = data;
  const material *m = p->m;
  double J = gh_det2(F), G[4];
  (void)want;
  for (int k = 0; k < 4; k++)
    if (m->limit > 0 && fabs(F[k] - p->F[k]) > m->limit)
      return gh_fail(p->ctx, GH_DIVERGED, "strain increment %g exceeds %g", F[k] - p->F[k], m->limit);
  gh_inv2(F, G);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      P[2 * i + j] = mu * (F[2 * i + j] - G[2 * j + i]) + lambda * log(J) * G[2 * j + i];
      for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++)
          A[8 * i + 4 * j + 2 * k + l] = mu * (i == k && j == l) + lambda * G[2 * j + i] * G[2 * l + k] +
                                         (mu - lambda * log(J)) * G[2 * j + k] * G[2 * l + i];
    }
  P[1] += m->skew * F[2];
  A[4 + 2] += m->skew;
  p->trial_jumped = p->jumped || (m->jump_at > 0 && F[3] < m->jump_at);
  if (p->trial_jumped) P[3] += m->jump;
  memcpy(p->trial, F, sizeof p->trial);
  return GH_OK;
}

static inline gh_status commit(void *data) {
  point *p = data;
  memcpy(p->F, p->trial, sizeof p->F);
  p->jumped = p->trial_jumped;
  return GH_OK;
}

static inline gh_status revert(void *data) {
  (void)data;
  return GH_OK;
}

enum { LINES = 100 };

typedef struct problem {
  gh_context *ctx;
  gh_mesh *mesh;
  gh_farm *farm;
  gh_loads *loads;
  gh_macro *macro;
  gh_macro_report report;
  double relative[LINES];
  int lines, top;
} problem;

static inline void watch(void *data, const gh_macro_iteration *it) {
  problem *p = data;
  if (p->lines < LINES) p->relative[p->lines++] = it->relative;
}

static const material plain = {0};

/* A block 4 x 2 of 8 x 4 elements on a rough plate; the left and right sides of its top are no part of the
 * footing when `narrow`: then the set "top" is cut down to its inner five nodes. */
static inline void make(problem *p, gh_context *ctx, const material *m, bool narrow) {
  static const gh_point_ops ops = {evaluate, commit, revert, free, NULL};
  const double low[2] = {-2, 0}, size[2] = {4, 2};
  const int elements[2] = {8, 4};
  *p = (problem){.ctx = ctx};
  OK(gh_mesh_rectangle(ctx, low, size, elements, &p->mesh));
  p->top = gh_mesh_find(p->mesh, "top");
  gh_mesh_set *top = p->mesh->sets + p->top;
  if (narrow) {
    memmove(top->nodes, top->nodes + 2, 5 * sizeof *top->nodes);
    memmove(top->edges, top->edges + 2, 4 * sizeof *top->edges);
    top->nnodes = 5, top->nedges = 4;
  }
  int n = 4 * p->mesh->nelements;
  void **points = calloc((size_t)n, sizeof *points);
  for (int k = 0; k < n; k++) {
    point *q = points[k] = calloc(1, sizeof *q);
    *q = (point){.ctx = ctx, .m = m, .F = {1, 0, 0, 1}, .trial = {1, 0, 0, 1}};
  }
  OK(gh_farm_create(ctx, n, &ops, points, &p->farm));
  free(points);
  gh_macro_options o = gh_macro_defaults();
  o.tolerance = 1e-12;
  OK(gh_macro_create(ctx, p->mesh, p->farm, &o, &p->macro));
  OK(gh_loads_create(ctx, p->mesh, &p->loads));
  gh_macro_set_watch(p->macro, watch, p);
}

static inline void drop(problem *p) {
  gh_macro_destroy(&p->macro);
  gh_loads_destroy(&p->loads);
  gh_farm_destroy(&p->farm);
  gh_mesh_destroy(&p->mesh);
}

/* The plate below, and nothing else. */
static inline void begin(problem *p) {
  gh_context *ctx = p->ctx;
  gh_loads_clear(p->loads);
  for (int i = 0; i < 2; i++) OK(gh_loads_displace(p->loads, gh_mesh_find(p->mesh, "bottom"), i, 0));
}

static inline void put(problem *p, double eccentricity, double fx, double fy) {
  gh_context *ctx = p->ctx;
  double at[2], force[2] = {fx, fy};
  gh_footing_point(p->mesh, p->top, eccentricity, at);
  OK(gh_loads_footing(p->loads, p->top, at, force));
}

static inline void solve(problem *p) {
  gh_context *ctx = p->ctx;
  p->lines = 0;
  OK(gh_macro_solve(p->macro, p->loads, &p->report));
}

static const gh_mesh_set *edge(const problem *p) {
  return p->mesh->sets + p->top;
}

static inline void place(const problem *p, int node, double x[2]) {
  for (int i = 0; i < 2; i++) x[i] = p->mesh->X[2 * node + i] + gh_macro_u(p->macro)[2 * node + i];
}

/* Force of the footing on the body, and its moment about the point z from the middle of the edge, which has
 * followed the footing. */
static inline void contact(const problem *p, double z, double sum[3]) {
  double u[2], turn, o[2];
  gh_footing_point(p->mesh, p->top, 0, o);
  gh_macro_footing(p->macro, p->top, u, &turn);
  o[0] += u[0] + z * cos(turn), o[1] += u[1] + z * sin(turn);
  sum[0] = sum[1] = sum[2] = 0;
  for (int k = 0; k < edge(p)->nnodes; k++) {
    double x[2];
    const double *r = gh_macro_reactions(p->macro) + 2 * edge(p)->nodes[k];
    place(p, edge(p)->nodes[k], x);
    for (int i = 0; i < 2; i++) sum[i] += r[i];
    sum[2] += (x[0] - o[0]) * r[1] - (x[1] - o[1]) * r[0];
  }
}

/* Largest change of a distance between two nodes of the footing. */
static inline double strain(const problem *p) {
  double largest = 0;
  for (int a = 0; a < edge(p)->nnodes; a++)
    for (int b = 0; b < a; b++) {
      double x[2], y[2];
      const double *X = p->mesh->X + 2 * edge(p)->nodes[a], *Y = p->mesh->X + 2 * edge(p)->nodes[b];
      place(p, edge(p)->nodes[a], x);
      place(p, edge(p)->nodes[b], y);
      largest = fmax(largest, fabs(hypot(x[0] - y[0], x[1] - y[1]) - hypot(X[0] - Y[0], X[1] - Y[1])));
    }
  return largest;
}

#endif
