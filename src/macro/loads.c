/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What acts on the mesh at the end of an increment. */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

gh_status gh_loads_create(gh_context *ctx, const gh_mesh *mesh, gh_loads **loads) {
  GH_TRY(gh_alloc(ctx, 1, sizeof **loads, loads));
  gh_loads *l = *loads;
  gh_status status;
  size_t ndof = 2 * (size_t)mesh->nnodes;
  l->ctx = ctx;
  l->mesh = mesh;
  GH_TRY_OR(gh_alloc(ctx, ndof, sizeof *l->force, &l->force), failed);
  GH_TRY_OR(gh_alloc(ctx, ndof, sizeof *l->fixed, &l->fixed), failed);
  GH_TRY_OR(gh_alloc(ctx, ndof, sizeof *l->value, &l->value), failed);
  return GH_OK;
failed:
  gh_loads_destroy(loads);
  return status;
}

void gh_loads_destroy(gh_loads **loads) {
  if (!loads || !*loads) return;
  free((*loads)->force);
  free((*loads)->fixed);
  free((*loads)->value);
  free((*loads)->follow.edge);
  free((*loads)->footing);
  free(*loads);
  *loads = NULL;
}

void gh_loads_clear(gh_loads *l) {
  size_t ndof = 2 * (size_t)l->mesh->nnodes;
  memset(l->force, 0, ndof * sizeof *l->force);
  memset(l->fixed, 0, ndof * sizeof *l->fixed);
  memset(l->value, 0, ndof * sizeof *l->value);
  l->follow.n = 0;
  l->nfootings = 0;
}

gh_status gh_edge_loads_add(gh_context *ctx, gh_edge_loads *list, int a, int b, double pressure) {
  GH_TRY(gh_grow(ctx, (size_t)list->n + 1, sizeof *list->edge, &list->capacity, &list->edge));
  list->edge[list->n++] = (gh_edge_load){a, b, pressure};
  return GH_OK;
}

static gh_status loads_find_set(const gh_loads *l, int set, const gh_mesh_set **found) {
  if (set < 0 || set >= l->mesh->nsets)
    return gh_fail(l->ctx, GH_INPUT, "set %d: the mesh has sets 0 to %d", set, l->mesh->nsets - 1);
  *found = l->mesh->sets + set;
  return GH_OK;
}

gh_status gh_loads_displace(gh_loads *l, int set, int dir, double value) {
  const gh_mesh_set *s = NULL;
  GH_TRY(loads_find_set(l, set, &s));
  if (dir != 0 && dir != 1)
    return gh_fail(l->ctx, GH_INPUT, "set %s: direction %d is neither 0 nor 1", s->name, dir);
  if (!isfinite(value))
    return gh_fail(l->ctx, GH_INPUT, "set %s: displacement %g is not finite", s->name, value);
  for (int k = 0; k < s->nnodes; k++) {
    l->fixed[2 * s->nodes[k] + dir] = 1;
    l->value[2 * s->nodes[k] + dir] = value;
  }
  return GH_OK;
}

gh_status gh_loads_pressure(gh_loads *l, int set, double pressure, bool follow) {
  const gh_mesh_set *s = NULL;
  GH_TRY(loads_find_set(l, set, &s));
  if (!isfinite(pressure))
    return gh_fail(l->ctx, GH_INPUT, "set %s: pressure %g is not finite", s->name, pressure);
  if (s->nedges == 0)
    return gh_fail(l->ctx, GH_INPUT, "set %s: a pressure needs edges of the boundary, it has none", s->name);
  for (int k = 0; k < s->nedges; k++) {
    int a = s->edges[k][0], b = s->edges[k][1];
    if (follow) {
      GH_TRY(gh_edge_loads_add(l->ctx, &l->follow, a, b, pressure));
      continue;
    }
    double f[2];
    gh_edge_force(l->mesh->X + 2 * a, l->mesh->X + 2 * b, pressure, f);
    for (int i = 0; i < 2; i++) {
      l->force[2 * a + i] += f[i];
      l->force[2 * b + i] += f[i];
    }
  }
  return GH_OK;
}

gh_status gh_loads_force(gh_loads *l, int set, const double force[2]) {
  const gh_mesh_set *s = NULL;
  GH_TRY(loads_find_set(l, set, &s));
  if (!gh_finite(force, 2))
    return gh_fail(l->ctx, GH_INPUT, "set %s: force (%g, %g) is not finite", s->name, force[0], force[1]);
  for (int k = 0; k < s->nnodes; k++)
    for (int i = 0; i < 2; i++) l->force[2 * s->nodes[k] + i] += force[i];
  return GH_OK;
}

gh_status gh_loads_gravity(gh_loads *l, const double b[2]) {
  const gh_mesh *mesh = l->mesh;
  if (!gh_finite(b, 2))
    return gh_fail(l->ctx, GH_INPUT, "weight per area (%g, %g) is not finite", b[0], b[1]);
  for (int e = 0; e < mesh->nelements; e++) {
    double x[4][2], grad[4][2], N[4], area;
    for (int a = 0; a < 4; a++) memcpy(x[a], mesh->X + 2 * mesh->quad[e][a], sizeof x[a]);
    for (int g = 0; g < 4; g++) {
      gh_shape_values(g, N);
      gh_shape_gradients((const double(*)[2])x, g, grad, &area);
      for (int a = 0; a < 4; a++)
        for (int i = 0; i < 2; i++) l->force[2 * mesh->quad[e][a] + i] += N[a] * area * b[i];
    }
  }
  return GH_OK;
}
