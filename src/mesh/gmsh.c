/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Gmsh meshes: from what the file holds to the mesh. */
#include "mesh/gmsh.h"

#include <stdlib.h>
#include <string.h>

/* ---- from the file to the mesh ---- */

static int node_compare_ids(const void *p, const void *q) {
  const gh_msh_node *a = p, *b = q;
  return (a->id > b->id) - (a->id < b->id);
}

static int node_compare_lines(const void *p, const void *q) {
  const gh_msh_node *a = p, *b = q;
  return a->line - b->line;
}

/* Replaces the cells' node ids by places in the list of nodes. */
static gh_status cells_find_nodes(gh_msh *g) {
  const gh_msh_words *s = &g->s;
  if (g->nnodes == 0) return gh_fail(s->ctx, GH_INPUT, "%s: the mesh has no nodes", s->path);
  if (g->nnodes > 0) qsort(g->nodes, (size_t)g->nnodes, sizeof *g->nodes, node_compare_ids);
  for (int a = 1; a < g->nnodes; a++)
    if (g->nodes[a].id == g->nodes[a - 1].id)
      return gh_fail(s->ctx, GH_INPUT, "%s:%d: node %ld occurs twice", s->path,
                     g->nodes[a].line > g->nodes[a - 1].line ? g->nodes[a].line : g->nodes[a - 1].line,
                     g->nodes[a].id);
  for (int c = 0; c < g->ncells; c++)
    for (int a = 0; a < g->cells[c].nnodes; a++) {
      gh_msh_node key = {.id = g->cells[c].node[a]};
      const gh_msh_node *found =
          bsearch(&key, g->nodes, (size_t)g->nnodes, sizeof *g->nodes, node_compare_ids);
      if (!found)
        return gh_fail(s->ctx, GH_INPUT, "%s:%d: element %ld refers to node %ld, which is missing", s->path,
                       g->cells[c].line, g->cells[c].id, key.id);
      g->cells[c].node[a] = found - g->nodes;
    }
  return GH_OK;
}

static void cell_sorted_corners(const gh_msh_cell *cell, long n[4]) {
  memcpy(n, cell->node, sizeof cell->node);
  for (int a = 1; a < 4; a++)
    for (int b = a; b > 0 && n[b] < n[b - 1]; b--) {
      long swap = n[b];
      n[b] = n[b - 1];
      n[b - 1] = swap;
    }
}

static int cell_compare_corners(const void *p, const void *q) {
  const gh_msh_cell *a = *(gh_msh_cell *const *)p, *b = *(gh_msh_cell *const *)q;
  long na[4], nb[4];
  cell_sorted_corners(a, na);
  cell_sorted_corners(b, nb);
  for (int k = 0; k < 4; k++)
    if (na[k] != nb[k]) return na[k] < nb[k] ? -1 : 1;
  return a->line - b->line;
}

static int cell_compare_places(const void *p, const void *q) {
  const gh_msh_cell *a = *(gh_msh_cell *const *)p, *b = *(gh_msh_cell *const *)q;
  return (a > b) - (a < b);
}

static gh_status mesh_refuse_no_quads(const gh_msh *g) {
  const char *why = " (in Gmsh: mesh in two dimensions, gmsh -2, with Recombine Surface)";
  if (g->ncells > 0 && g->ngroups > 0)
    why = ", only points and lines of physical groups: once there are such groups, Gmsh saves nothing but "
          "them; "
          "give the surface one, too (Physical Surface), or save all (Mesh.SaveAll = 1)";
  return gh_fail(g->s.ctx, GH_INPUT, "%s: the mesh has no quadrilateral%s", g->s.path, why);
}

/* The quadrilaterals in the file's order, each once: MSH 2.2 repeats an element for each of its physical
 * groups. */
static gh_status quads_collect(gh_msh *g, gh_msh_cell ***quads, int *n) {
  GH_TRY(gh_alloc(g->s.ctx, (size_t)g->ncells, sizeof **quads, quads));
  int all = 0, kept = 0;
  for (int c = 0; c < g->ncells; c++)
    if (g->cells[c].nnodes == 4) (*quads)[all++] = g->cells + c;
  if (all > 0) qsort(*quads, (size_t)all, sizeof **quads, cell_compare_corners);
  for (int k = 0; k < all; k++) {
    long before[4] = {-1, -1, -1, -1}, here[4];
    if (kept) cell_sorted_corners((*quads)[kept - 1], before);
    cell_sorted_corners((*quads)[k], here);
    if (memcmp(before, here, sizeof here) != 0) (*quads)[kept++] = (*quads)[k];
  }
  if (kept > 0) qsort(*quads, (size_t)kept, sizeof **quads, cell_compare_places);
  *n = kept;
  return kept ? GH_OK : mesh_refuse_no_quads(g);
}

/* Turns a clockwise quadrilateral; refuses one that is not convex. */
static gh_status quad_orient(gh_msh *g, gh_msh_cell *cell) {
  double x[4][2];
  for (int turned = 0; turned < 2; turned++) {
    for (int a = 0; a < 4; a++) memcpy(x[a], g->nodes[cell->node[a]].x, sizeof x[a]);
    if (gh_quad_convex((const double(*)[2])x)) return GH_OK;
    long swap = cell->node[1];
    cell->node[1] = cell->node[3];
    cell->node[3] = swap;
  }
  return gh_fail(g->s.ctx, GH_INPUT, "%s:%d: quadrilateral %ld is inverted or not convex", g->s.path,
                 cell->line, cell->id);
}

/* Nodes that quadrilaterals use, in the file's order, and the quadrilaterals. */
static gh_status mesh_fill(gh_msh *g, gh_msh_cell **quads, int n, gh_mesh *mesh) {
  gh_context *ctx = g->s.ctx;
  gh_msh_node *order = NULL;
  gh_status status;
  for (int e = 0; e < n; e++) {
    GH_TRY(quad_orient(g, quads[e]));
    for (int a = 0; a < 4; a++) g->nodes[quads[e]->node[a]].index = 0;
  }
  GH_TRY_OR(gh_alloc(ctx, (size_t)g->nnodes, sizeof *order, &order), done);
  for (int a = 0; a < g->nnodes; a++) {
    order[a] = g->nodes[a];
    order[a].id = a; /* the place, to find back after sorting */
  }
  if (g->nnodes > 0) qsort(order, (size_t)g->nnodes, sizeof *order, node_compare_lines);
  GH_TRY_OR(gh_alloc(ctx, 2 * (size_t)g->nnodes, sizeof *mesh->X, &mesh->X), done);
  for (int a = 0; a < g->nnodes; a++) {
    if (order[a].index < 0) continue;
    memcpy(mesh->X + 2 * (size_t)mesh->nnodes, order[a].x, sizeof order[a].x);
    g->nodes[order[a].id].index = mesh->nnodes++;
  }
  GH_TRY_OR(gh_alloc(ctx, (size_t)n, sizeof *mesh->quad, &mesh->quad), done);
  mesh->nelements = n;
  for (int e = 0; e < n; e++)
    for (int a = 0; a < 4; a++) mesh->quad[e][a] = g->nodes[quads[e]->node[a]].index;
done:
  free(order);
  return status;
}

/* Quadrilaterals that overlap, or a node that hangs on the side of one, make a body that nobody means; a slit
 * may be meant. */
static gh_status mesh_check_misfits(const gh_msh *g, gh_msh_cell *const *quads, const gh_mesh *mesh) {
  gh_mesh_misfits found;
  GH_TRY(gh_mesh_find_misfits(g->s.ctx, mesh, &found));
  const double *x = mesh->X + 2 * (size_t)(found.node >= 0 ? found.node : 0);
  if (found.element >= 0)
    return gh_fail(g->s.ctx, GH_INPUT,
                   "%s:%d: quadrilateral %ld has a node of others in it or on its side, at (%g, %g): "
                   "quadrilaterals must not overlap, and must meet at their corners",
                   g->s.path, quads[found.element]->line, quads[found.element]->id, x[0], x[1]);
  x = mesh->X + 2 * (size_t)(found.ntwins ? found.twin[0] : 0);
  if (found.ntwins)
    gh_log(g->s.ctx, GH_LEVEL_WARNING,
           "%s: %d node%s at the place of another, the first at (%g, %g): nothing joins them, and the body "
           "has a "
           "slit there (Coherence joins them in Gmsh)",
           g->s.path, found.ntwins, found.ntwins == 1 ? " is" : "s are", x[0], x[1]);
  return GH_OK;
}

static gh_status mesh_build(gh_msh *g, gh_mesh *mesh) {
  gh_msh_cell **quads = NULL;
  int n;
  gh_status status;
  GH_TRY_OR(cells_find_nodes(g), done);
  GH_TRY_OR(quads_collect(g, &quads, &n), done);
  GH_TRY_OR(mesh_fill(g, quads, n, mesh), done);
  GH_TRY_OR(mesh_check_misfits(g, quads, mesh), done);
  status = gh_msh_sets(g, mesh);
done:
  free(quads);
  return status;
}

gh_status gh_mesh_read_gmsh(gh_context *ctx, const char *path, gh_mesh **mesh) {
  gh_msh g = {.s = {.ctx = ctx, .path = path}};
  gh_status status;
  *mesh = NULL;
  GH_TRY_OR(gh_msh_read(&g), done);
  GH_TRY_OR(gh_alloc(ctx, 1, sizeof **mesh, mesh), done);
  status = mesh_build(&g, *mesh);
  if (status != GH_OK) gh_mesh_destroy(mesh);
done:
  gh_msh_free(&g);
  return gh_file_expect(ctx, status, path, GH_FILE_MESH);
}
