/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Whether quadrilaterals meet at common nodes alone. */
#include "granhom/mesh.h"

#include <stdlib.h>
#include <string.h>

/* Lengths below this share of a quadrilateral are none. */
static const double nothing = 1e-9;

typedef struct place {
  double x[2]; /* along the axis that is looked along, and across */
  int node;
} place;

static int place_compare(const void *p, const void *q) {
  const place *a = p, *b = q;
  for (int i = 0; i < 2; i++)
    if (a->x[i] != b->x[i]) return a->x[i] < b->x[i] ? -1 : 1;
  return (a->node > b->node) - (a->node < b->node);
}

/* The axis along which quadrilaterals are shorter, over the body's length: fewer nodes are beside one. */
static int axis_choose(const gh_mesh *mesh) {
  double sum[2] = {0}, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int e = 0; e < mesh->nelements; e++)
    for (int i = 0; i < 2; i++) {
      double least = INFINITY, most = -INFINITY;
      for (int a = 0; a < 4; a++) {
        const double x = mesh->X[2 * mesh->quad[e][a] + i];
        least = fmin(least, x), most = fmax(most, x);
      }
      sum[i] += most - least;
      low[i] = fmin(low[i], least), high[i] = fmax(high[i], most);
    }
  return sum[1] * (high[0] - low[0]) < sum[0] * (high[1] - low[1]);
}

static gh_status places_sort(gh_context *ctx, const gh_mesh *mesh, int axis, place **places) {
  GH_TRY(gh_alloc(ctx, (size_t)mesh->nnodes, sizeof **places, places));
  for (int a = 0; a < mesh->nnodes; a++)
    (*places)[a] = (place){.x = {mesh->X[2 * a + axis], mesh->X[2 * a + !axis]}, .node = a};
  qsort(*places, (size_t)mesh->nnodes, sizeof **places, place_compare);
  return GH_OK;
}

/* The first place that does not lie below x. */
static int places_from(const place *places, int n, double x) {
  int low = 0, high = n;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (places[middle].x[0] < x) low = middle + 1;
    else high = middle;
  }
  return low;
}

/* A convex quadrilateral with what is nothing beside it, and its extent along the axis. */
typedef struct corners {
  double x[4][2], low, high, none;
} corners;

static corners corners_of(const gh_mesh *mesh, int e, int axis) {
  corners c;
  for (int a = 0; a < 4; a++) memcpy(c.x[a], mesh->X + 2 * mesh->quad[e][a], sizeof c.x[a]);
  c.none = nothing * fmax(hypot(c.x[2][0] - c.x[0][0], c.x[2][1] - c.x[0][1]),
                          hypot(c.x[3][0] - c.x[1][0], c.x[3][1] - c.x[1][1]));
  c.low = c.high = c.x[0][axis];
  for (int a = 1; a < 4; a++) c.low = fmin(c.low, c.x[a][axis]), c.high = fmax(c.high, c.x[a][axis]);
  return c;
}

/* 2: a corner; 1: on a side or inside; 0: outside. */
static int corners_hold(const corners *c, const double x[2]) {
  for (int a = 0; a < 4; a++)
    if (hypot(x[0] - c->x[a][0], x[1] - c->x[a][1]) <= c->none) return 2;
  for (int a = 0; a < 4; a++) {
    const double *p = c->x[a], *q = c->x[(a + 1) % 4], d[2] = {q[0] - p[0], q[1] - p[1]};
    if (!(d[0] * (x[1] - p[1]) - d[1] * (x[0] - p[0]) >= -c->none * hypot(d[0], d[1]))) return 0;
  }
  return 1;
}

static bool owns(const gh_mesh *mesh, int e, int node) {
  for (int a = 0; a < 4; a++)
    if (mesh->quad[e][a] == node) return true;
  return false;
}

gh_status gh_mesh_find_misfits(gh_context *ctx, const gh_mesh *mesh, gh_mesh_misfits *found) {
  place *places;
  *found = (gh_mesh_misfits){.element = -1, .node = -1, .twin = {-1, -1}};
  const int axis = axis_choose(mesh);
  GH_TRY(places_sort(ctx, mesh, axis, &places));
  for (int e = 0; e < mesh->nelements && found->element < 0; e++) {
    const corners c = corners_of(mesh, e, axis);
    for (int k = places_from(places, mesh->nnodes, c.low - c.none);
         k < mesh->nnodes && places[k].x[0] <= c.high + c.none; k++) {
      const int where =
          owns(mesh, e, places[k].node) ? 0 : corners_hold(&c, mesh->X + 2 * (size_t)places[k].node);
      if (where == 1) found->element = e, found->node = places[k].node;
      if (where == 1) break;
    }
  }
  for (int k = 1; k < mesh->nnodes; k++) {
    if (memcmp(places[k].x, places[k - 1].x, sizeof places[k].x) != 0) continue;
    if (found->ntwins++ == 0) found->twin[0] = places[k - 1].node, found->twin[1] = places[k].node;
  }
  free(places);
  return GH_OK;
}
