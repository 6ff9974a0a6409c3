/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Edges: the outer boundary of a mesh, edges that sets have in common. */
#include "granhom/mesh.h"

#include <stdlib.h>
#include <string.h>

static int edge_compare_nodes(const void *p, const void *q) {
  const gh_mesh_edge *e = p, *f = q;
  int a[2] = {e->a < e->b ? e->a : e->b, e->a < e->b ? e->b : e->a};
  int b[2] = {f->a < f->b ? f->a : f->b, f->a < f->b ? f->b : f->a};
  for (int i = 0; i < 2; i++)
    if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
  return 0;
}

gh_status gh_mesh_boundary_edges(gh_context *ctx, int nelements, const int (*quad)[4], gh_mesh_edge **edges,
                                 int *count) {
  size_t n = 4 * (size_t)nelements;
  *count = 0;
  GH_TRY(gh_alloc(ctx, n, sizeof **edges, edges));
  gh_mesh_edge *e = *edges;
  for (size_t k = 0; k < n; k++) e[k] = (gh_mesh_edge){quad[k / 4][k % 4], quad[k / 4][(k + 1) % 4]};
  if (n > 0) qsort(e, n, sizeof *e, edge_compare_nodes);
  for (size_t k = 0; k < n;) { /* a side that is listed once has an element on one side only */
    size_t same = k + 1;
    while (same < n && edge_compare_nodes(e + k, e + same) == 0) same++;
    if (same == k + 1) e[(*count)++] = e[k];
    k = same;
  }
  return GH_OK;
}

const gh_mesh_edge *gh_mesh_find_edge(const gh_mesh_edge *edges, int count, int a, int b) {
  gh_mesh_edge key = {a, b};
  if (count == 0) return NULL;
  return bsearch(&key, edges, (size_t)count, sizeof *edges, edge_compare_nodes);
}

static int pair_compare(const void *p, const void *q) {
  const int *a = p, *b = q;
  if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
  return (a[1] > b[1]) - (a[1] < b[1]);
}

gh_status gh_mesh_share_edges(gh_context *ctx, const gh_mesh_set *a, const gh_mesh_set *b, bool *share) {
  const size_t n = (size_t)a->nedges;
  int(*sorted)[2];
  *share = false;
  if (a->nedges == 0 || b->nedges == 0) return GH_OK;
  GH_TRY(gh_alloc(ctx, n, sizeof *sorted, &sorted));
  memcpy(sorted, a->edges, n * sizeof *sorted);
  qsort(sorted, n, sizeof *sorted, pair_compare);
  for (int k = 0; k < b->nedges && !*share; k++)
    *share = bsearch(b->edges + k, sorted, n, sizeof *sorted, pair_compare) != NULL;
  free(sorted);
  return GH_OK;
}
