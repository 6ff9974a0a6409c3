/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The outline of a mesh: edges that one element has alone, side by side. */
#include "direct/outline.h"

#include <stdlib.h>
#include <string.h>

/* Edges that turn by more than this make a corner. */
static const double corner = GH_PI / 6;

static void edge_measure(const gh_mesh *m, outline_edge *e) {
  const double *A = m->X + 2 * e->a, *B = m->X + 2 * e->b;
  const double d[2] = {B[0] - A[0], B[1] - A[1]};
  e->length = hypot(d[0], d[1]);
  for (int i = 0; i < 2; i++) e->along[i] = d[i] / e->length;
  e->outward[0] = e->along[1], e->outward[1] = -e->along[0];
}

static bool turns_little(const outline_edge *e, const outline_edge *f) {
  const double c = e->along[0] * f->along[0] + e->along[1] * f->along[1],
               s = e->along[0] * f->along[1] - e->along[1] * f->along[0];
  return fabs(atan2(s, c)) <= corner;
}

/* The edge that begins where e ends, of those not taken; -1: none. Where two loops touch there are two. */
static int edge_next(const outline_edge *all, const bool *taken, int n, const outline_edge *e) {
  int found = -1;
  for (int k = 0; k < n; k++)
    if (!taken[k] && all[k].a == e->b && (found < 0 || turns_little(e, all + k))) found = k;
  return found;
}

/* An edge whose predecessor is none of its side, of those not taken; without any, in a round loop, the first. */
static int edge_first(const outline_edge *all, const bool *taken, int n) {
  int any = -1;
  for (int k = 0; k < n; k++) {
    if (taken[k]) continue;
    bool follows = false;
    for (int j = 0; j < n && !follows; j++)
      follows = !taken[j] && all[j].b == all[k].a && turns_little(all + j, all + k);
    if (!follows) return k;
    if (any < 0) any = k;
  }
  return any;
}

static void sides_order(outline *o, const outline_edge *all, bool *taken) {
  int placed = 0;
  while (placed < o->nedges) {
    outline_side *side = o->side + o->nsides++;
    *side = (outline_side){.first = placed};
    for (int k = edge_first(all, taken, o->nedges); k >= 0;) {
      outline_edge *e = o->edge + placed++;
      *e = all[k];
      e->start = side->length;
      taken[k] = true;
      side->length += e->length;
      side->count++;
      const int next = edge_next(all, taken, o->nedges, e);
      k = next >= 0 && turns_little(e, all + next) ? next : -1;
    }
  }
}

static void outline_measure(outline *o) {
  const gh_mesh *m = o->mesh;
  for (int i = 0; i < 2; i++) o->low[i] = INFINITY, o->high[i] = -INFINITY;
  o->area = 0;
  for (int k = 0; k < o->nedges; k++) {
    const double *A = m->X + 2 * o->edge[k].a, *B = m->X + 2 * o->edge[k].b;
    o->area += (A[0] * B[1] - A[1] * B[0]) / 2;
    for (int i = 0; i < 2; i++) {
      o->low[i] = fmin(o->low[i], A[i]);
      o->high[i] = fmax(o->high[i], A[i]);
    }
  }
}

void outline_move(outline *o) {
  for (int k = 0; k < o->nsides; k++) {
    outline_side *side = o->side + k;
    side->length = 0;
    for (int e = side->first; e < side->first + side->count; e++) {
      edge_measure(o->mesh, o->edge + e);
      o->edge[e].start = side->length;
      side->length += o->edge[e].length;
    }
  }
  outline_measure(o);
}

gh_status outline_create(gh_context *ctx, const gh_mesh *mesh, outline *o) {
  gh_mesh_edge *edges = NULL;
  outline_edge *all = NULL;
  bool *taken = NULL;
  gh_status status;
  *o = (outline){.mesh = mesh};
  GH_TRY_OR(gh_mesh_boundary_edges(ctx, mesh->nelements, (const int(*)[4])mesh->quad, &edges, &o->nedges),
            done);
  const size_t n = (size_t)o->nedges;
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *all, &all), done);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *taken, &taken), done);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *o->edge, &o->edge), done);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *o->side, &o->side), done);
  for (size_t k = 0; k < n; k++) {
    all[k] = (outline_edge){.a = edges[k].a, .b = edges[k].b};
    edge_measure(mesh, all + k);
  }
  sides_order(o, all, taken);
  outline_measure(o);
done:
  free(edges);
  free(all);
  free(taken);
  return status;
}

void outline_destroy(outline *o) {
  free(o->edge);
  free(o->side);
  *o = (outline){0};
}

void outline_gradient(const outline *o, const double *u, double G[4]) {
  memset(G, 0, 4 * sizeof *G);
  for (int k = 0; k < o->nedges; k++) {
    const outline_edge *e = o->edge + k;
    for (int i = 0; i < 2; i++)
      for (int j = 0; j < 2; j++)
        G[2 * i + j] += (u[2 * e->a + i] + u[2 * e->b + i]) / 2 * e->length * e->outward[j] / o->area;
  }
}

/* Nearest point of an edge: arc length from its node a, and the square of the distance. */
static double edge_distance2(const outline *o, const outline_edge *e, const double X[2], double *t) {
  const double *A = o->mesh->X + 2 * e->a, d[2] = {X[0] - A[0], X[1] - A[1]};
  *t = fmin(fmax(d[0] * e->along[0] + d[1] * e->along[1], 0), e->length);
  const double off[2] = {d[0] - *t * e->along[0], d[1] - *t * e->along[1]};
  return off[0] * off[0] + off[1] * off[1];
}

/* Whether a ray to the right crosses the outline an odd number of times. */
static bool outline_inside(const outline *o, const double X[2]) {
  bool inside = false;
  for (int k = 0; k < o->nedges; k++) {
    const double *A = o->mesh->X + 2 * o->edge[k].a, *B = o->mesh->X + 2 * o->edge[k].b;
    if ((A[1] > X[1]) == (B[1] > X[1])) continue;
    if (X[0] < A[0] + (X[1] - A[1]) / (B[1] - A[1]) * (B[0] - A[0])) inside = !inside;
  }
  return inside;
}

double outline_depth(const outline *o, const double X[2]) {
  double nearest = INFINITY, t;
  for (int k = 0; k < o->nedges; k++) nearest = fmin(nearest, edge_distance2(o, o->edge + k, X, &t));
  return outline_inside(o, X) ? sqrt(nearest) : -sqrt(nearest);
}

outline_place outline_project(const outline *o, const outline_side *side, const double X[2]) {
  double nearest = INFINITY, t;
  outline_place p = {.edge = side->first};
  for (int k = side->first; k < side->first + side->count; k++) {
    const outline_edge *e = o->edge + k;
    const double d2 = edge_distance2(o, e, X, &t), *A = o->mesh->X + 2 * e->a;
    if (!(d2 < nearest)) continue;
    nearest = d2;
    p = (outline_place){.edge = k, .s = e->start + t};
    p.beyond = (X[0] - A[0]) * e->along[0] + (X[1] - A[1]) * e->along[1] - t;
    p.depth = -(X[0] - A[0]) * e->outward[0] - (X[1] - A[1]) * e->outward[1];
  }
  return p;
}
