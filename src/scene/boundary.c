/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What holds and what loads the outer boundary. */
#include "scene/internal.h"

#include <stdlib.h>
#include <string.h>

bool scene_normal_is_free(const gh_scene *s, int a, int b) {
  const double *X = s->mesh->X;
  double normal[2] = {X[2 * b + 1] - X[2 * a + 1], X[2 * a] - X[2 * b]}, length = hypot(normal[0], normal[1]);
  for (int i = 0; i < 2; i++)
    if (fabs(normal[i]) > 1e-6 * length && (!s->present.held[2 * a + i] || !s->present.held[2 * b + i]))
      return true;
  return false;
}

bool scene_boundary_is_free(const gh_scene *s) {
  const gh_mesh *m = s->mesh;
  gh_mesh_edge *edges;
  int count;
  if (gh_mesh_boundary_edges(s->ctx, m->nelements, (const int(*)[4])m->quad, &edges, &count) != GH_OK)
    return false;
  bool is_free = false;
  for (int k = 0; k < count && !is_free; k++) is_free = scene_normal_is_free(s, edges[k].a, edges[k].b);
  free(edges);
  return is_free;
}

bool scene_has_load(const gh_scene *s) {
  const scene_present *p = &s->present;
  for (int k = 0; k < s->nsets; k++)
    if (p->pressure[k].now != 0 || p->force[k][0].now != 0 || p->force[k][1].now != 0 ||
        p->footing[k].force[0].now != 0 || p->footing[k].force[1].now != 0)
      return true;
  return p->gravity[0].now != 0 || p->gravity[1].now != 0;
}
