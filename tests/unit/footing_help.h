/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A block under a footing, with material points in closed form. */
#ifndef GRANHOM_TESTS_FOOTING_HELP_H
#define GRANHOM_TESTS_FOOTING_HELP_H

#include "../macro_help.h"

/* A block 4 x 2 of 8 x 4 elements on a rough plate; the left and right sides of its top are no part of the
 * footing when `narrow`: then the set "top" is cut down to its inner five nodes. */
static inline void make(problem *p, gh_context *ctx, const material *m, bool narrow) {
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
  const gh_macro_options o = tight();
  make_macro(p, m, &o);
}

/* The plate below, and nothing else. */
static inline void begin(problem *p) {
  gh_context *ctx = p->ctx;
  gh_loads_clear(p->loads);
  for (int i = 0; i < 2; i++) OK(gh_loads_displace(p->loads, gh_mesh_find(p->mesh, "bottom"), i, 0));
}

static inline void put(problem *p, double eccentricity, double fx, double fy) {
  loads_put(p->ctx, p->loads, p->mesh, p->top, eccentricity, fx, fy);
}

static inline const gh_mesh_set *edge(const problem *p) {
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
