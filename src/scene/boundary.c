/* Edges: the outer boundary of a mesh, what sets have in common. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/internal.h"

#include <stdlib.h>

static int by_nodes(const void *p, const void *q) {
  const scene_edge *e = p, *f = q;
  int a[2] = {e->a < e->b ? e->a : e->b, e->a < e->b ? e->b : e->a};
  int b[2] = {f->a < f->b ? f->a : f->b, f->a < f->b ? f->b : f->a};
  for (int i = 0; i < 2; i++)
    if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
  return 0;
}

gh_status scene_boundary_edges(gh_context *ctx, int nelements, const int (*quad)[4], scene_edge **edges,
                               int *count) {
  size_t n = 4 * (size_t)nelements;
  *count = 0;
  GH_TRY(gh_alloc(ctx, n, sizeof **edges, edges));
  scene_edge *e = *edges;
  for (size_t k = 0; k < n; k++) e[k] = (scene_edge){quad[k / 4][k % 4], quad[k / 4][(k + 1) % 4]};
  if (n > 0) qsort(e, n, sizeof *e, by_nodes);
  for (size_t k = 0; k < n;) { /* a side that is listed once has an element on one side only */
    size_t same = k + 1;
    while (same < n && by_nodes(e + k, e + same) == 0) same++;
    if (same == k + 1) e[(*count)++] = e[k];
    k = same;
  }
  return GH_OK;
}

bool scene_share_edges(const gh_mesh_set *a, const gh_mesh_set *b) {
  for (int i = 0; i < a->nedges; i++)
    for (int j = 0; j < b->nedges; j++)
      if (a->edges[i][0] == b->edges[j][0] && a->edges[i][1] == b->edges[j][1]) return true;
  return false;
}
