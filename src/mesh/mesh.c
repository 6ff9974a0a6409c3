/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Meshes of bilinear quadrilaterals: rectangle, check, sets, Gauss points. */
#include "granhom/mesh.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* Twice the area of the triangle a b c. */
static double triangle_twice_area(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
}

bool gh_quad_convex(const double x[4][2]) {
  /* The Jacobian is linear between the corners' values, which are these turns: positive there, it is positive
   * inside. The margin keeps corners of 180 degrees out whatever the round-off. */
  double diagonal = hypot(x[2][0] - x[0][0], x[2][1] - x[0][1]) * hypot(x[3][0] - x[1][0], x[3][1] - x[1][1]);
  for (int a = 0; a < 4; a++)
    if (!(triangle_twice_area(x[(a + 3) % 4], x[a], x[(a + 1) % 4]) > 1e-12 * diagonal)) return false;
  return true;
}

gh_status gh_mesh_check(gh_context *ctx, const gh_mesh *mesh) {
  if (mesh->nelements < 1) return gh_fail(ctx, GH_INPUT, "the mesh has no quadrilateral");
  for (int a = 0; a < mesh->nnodes; a++)
    if (!gh_finite(mesh->X + 2 * a, 2))
      return gh_fail(ctx, GH_INPUT, "coordinates of node %d are not finite", a);
  for (int e = 0; e < mesh->nelements; e++) {
    double x[4][2];
    for (int a = 0; a < 4; a++) {
      int node = mesh->quad[e][a];
      if (node < 0 || node >= mesh->nnodes)
        return gh_fail(ctx, GH_INPUT, "element %d refers to node %d of %d", e, node, mesh->nnodes);
      memcpy(x[a], mesh->X + 2 * node, sizeof x[a]);
    }
    if (!gh_quad_convex((const double(*)[2])x))
      return gh_fail(ctx, GH_INPUT,
                     "element %d with corners (%g, %g) (%g, %g) (%g, %g) (%g, %g) is inverted or not convex",
                     e, x[0][0], x[0][1], x[1][0], x[1][1], x[2][0], x[2][1], x[3][0], x[3][1]);
  }
  return GH_OK;
}

int gh_mesh_find(const gh_mesh *mesh, const char *name) {
  for (int k = 0; k < mesh->nsets; k++)
    if (strcmp(mesh->sets[k].name, name) == 0) return k;
  return -1;
}

/* The one node that two sets share; -1: none, or several. */
static int shared_node(const gh_mesh *mesh, const char *one, const char *other) {
  const int a = gh_mesh_find(mesh, one), b = gh_mesh_find(mesh, other);
  int shared = -1;
  if (a < 0 || b < 0) return -1;
  for (int i = 0; i < mesh->sets[a].nnodes; i++)
    for (int j = 0; j < mesh->sets[b].nnodes; j++) {
      if (mesh->sets[a].nodes[i] != mesh->sets[b].nodes[j]) continue;
      if (shared >= 0) return -1;
      shared = mesh->sets[a].nodes[i];
    }
  return shared;
}

static gh_status add_point(gh_context *ctx, gh_mesh *mesh, const char *name, int node) {
  const size_t n = (size_t)mesh->nsets;
  gh_mesh_set *sets;
  GH_TRY(gh_alloc(ctx, n + 1, sizeof *sets, &sets));
  gh_mesh_set *set = sets + n;
  gh_status status = gh_alloc(ctx, strlen(name) + 1, 1, &set->name);
  if (status == GH_OK) status = gh_alloc(ctx, 1, sizeof *set->nodes, &set->nodes);
  if (status != GH_OK) {
    free(set->name);
    free(sets);
    return status;
  }
  strcpy(set->name, name);
  set->nodes[0] = node;
  set->nnodes = 1;
  memcpy(sets, mesh->sets, n * sizeof *sets);
  free(mesh->sets);
  mesh->sets = sets;
  mesh->nsets++;
  return GH_OK;
}

gh_status gh_mesh_find_corner(gh_context *ctx, gh_mesh *mesh, const char *name, int *set) {
  static const char *const corners[][3] = {{"bottom_left", "bottom", "left"},
                                           {"bottom_right", "bottom", "right"},
                                           {"top_left", "top", "left"},
                                           {"top_right", "top", "right"}};
  *set = gh_mesh_find(mesh, name);
  for (int k = 0; *set < 0 && k < 4; k++) {
    const int node = strcmp(name, corners[k][0]) == 0 ? shared_node(mesh, corners[k][1], corners[k][2]) : -1;
    if (node < 0) continue;
    GH_TRY(add_point(ctx, mesh, name, node));
    *set = mesh->nsets - 1;
  }
  return GH_OK;
}

const char *gh_mesh_dof_name(const gh_mesh *mesh, int dof, char text[GH_DOF_NAME]) {
  int a = dof / 2;
  snprintf(text, GH_DOF_NAME, "node %d at (%g, %g) in %c", a, mesh->X[2 * a], mesh->X[2 * a + 1],
           "xy"[dof % 2]);
  return text;
}

void gh_mesh_gauss(const gh_mesh *mesh, double *XG) {
  for (int e = 0; e < mesh->nelements; e++)
    for (int g = 0; g < 4; g++) {
      double N[4], *x = XG + 2 * (4 * (size_t)e + (size_t)g);
      gh_shape_values(g, N);
      for (int i = 0; i < 2; i++) {
        x[i] = 0;
        for (int a = 0; a < 4; a++) x[i] += N[a] * mesh->X[2 * mesh->quad[e][a] + i];
      }
    }
}

void gh_mesh_destroy(gh_mesh **mesh) {
  if (!mesh || !*mesh) return;
  gh_mesh *m = *mesh;
  for (int k = 0; m->sets && k < m->nsets; k++) {
    free(m->sets[k].name);
    free(m->sets[k].nodes);
    free(m->sets[k].edges);
  }
  free(m->sets);
  free(m->X);
  free(m->quad);
  free(m);
  *mesh = NULL;
}

/* A side of the rectangle: n edges, nodes first, first + stride, ...; reversed where the body would be on the
 * right. */
static gh_status rectangle_add_side(gh_context *ctx, gh_mesh_set *set, const char *name, int n, int first,
                                    int stride, bool reversed) {
  GH_TRY(gh_alloc(ctx, strlen(name) + 1, 1, &set->name));
  strcpy(set->name, name);
  GH_TRY(gh_alloc(ctx, (size_t)n + 1, sizeof *set->nodes, &set->nodes));
  GH_TRY(gh_alloc(ctx, (size_t)n, sizeof *set->edges, &set->edges));
  set->nnodes = n + 1;
  set->nedges = n;
  for (int k = 0; k <= n; k++) set->nodes[k] = first + k * stride;
  for (int k = 0; k < n; k++) {
    set->edges[k][reversed] = set->nodes[k];
    set->edges[k][!reversed] = set->nodes[k + 1];
  }
  return GH_OK;
}

static gh_status rectangle_fill(gh_context *ctx, const double low[2], const double size[2], const int n[2],
                                gh_mesh *m) {
  int row = n[0] + 1;
  m->nnodes = row * (n[1] + 1);
  m->nelements = n[0] * n[1];
  GH_TRY(gh_alloc(ctx, 2 * (size_t)m->nnodes, sizeof *m->X, &m->X));
  GH_TRY(gh_alloc(ctx, (size_t)m->nelements, sizeof *m->quad, &m->quad));
  GH_TRY(gh_alloc(ctx, 4, sizeof *m->sets, &m->sets));
  m->nsets = 4;
  for (int j = 0, a = 0; j <= n[1]; j++)
    for (int i = 0; i <= n[0]; i++, a++) {
      m->X[2 * a] = low[0] + size[0] * i / n[0];
      m->X[2 * a + 1] = low[1] + size[1] * j / n[1];
    }
  for (int j = 0, e = 0; j < n[1]; j++)
    for (int i = 0; i < n[0]; i++, e++) {
      int a = j * row + i, corner[4] = {a, a + 1, a + 1 + row, a + row};
      memcpy(m->quad[e], corner, sizeof corner);
    }
  GH_TRY(rectangle_add_side(ctx, m->sets + 0, "left", n[1], 0, row, true));
  GH_TRY(rectangle_add_side(ctx, m->sets + 1, "right", n[1], n[0], row, false));
  GH_TRY(rectangle_add_side(ctx, m->sets + 2, "bottom", n[0], 0, 1, false));
  return rectangle_add_side(ctx, m->sets + 3, "top", n[0], n[1] * row, 1, true);
}

gh_status gh_mesh_rectangle(gh_context *ctx, const double low[2], const double size[2], const int elements[2],
                            gh_mesh **mesh) {
  *mesh = NULL;
  for (int i = 0; i < 2; i++) {
    if (!isfinite(low[i]))
      return gh_fail(ctx, GH_INPUT, "rectangle: corner (%g, %g) is not finite", low[0], low[1]);
    if (!(size[i] > 0) || !isfinite(size[i]))
      return gh_fail(ctx, GH_INPUT, "rectangle: size %g x %g must be positive", size[0], size[1]);
    if (elements[i] < 1)
      return gh_fail(ctx, GH_INPUT, "rectangle: %d x %d elements, at least 1 x 1 needed", elements[0],
                     elements[1]);
  }
  if ((elements[0] + 1.0) * (elements[1] + 1.0) * 32 > INT_MAX)
    return gh_fail(ctx, GH_INPUT, "rectangle: %d x %d elements are too many", elements[0], elements[1]);
  GH_TRY(gh_alloc(ctx, 1, sizeof **mesh, mesh));
  gh_status status = rectangle_fill(ctx, low, size, elements, *mesh);
  if (status == GH_OK) status = gh_mesh_check(ctx, *mesh);
  if (status != GH_OK) gh_mesh_destroy(mesh);
  return status;
}
