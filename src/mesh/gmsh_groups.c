/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Physical groups of Gmsh meshes. */
#include "mesh/gmsh.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static int int_compare(const void *p, const void *q) {
  return *(const int *)p - *(const int *)q;
}

typedef struct member { /* a line or a point in one of its physical groups */
  int dim, cell;
  long tag;
} member;

/* Lines before points, groups in the order of their numbers, elements in that of the file. */
static int member_compare(const void *p, const void *q) {
  const member *a = p, *b = q;
  if (a->dim != b->dim) return b->dim - a->dim;
  if (a->tag != b->tag) return a->tag < b->tag ? -1 : 1;
  return a->cell - b->cell;
}

/* All members of all groups, sorted. A line may be listed twice in a group. */
static gh_status members_list(const gh_msh *g, member **members, int *n) {
  size_t all = 0;
  *n = 0;
  for (int c = 0; c < g->ncells; c++)
    if (g->cells[c].nnodes <= 2) all += (size_t)g->cells[c].group[1];
  if (all > INT_MAX / 8)
    return gh_fail(g->s.ctx, GH_INPUT,
                   "%s: lines and points are in physical groups %zu times, at most %d are possible",
                   g->s.path, all, INT_MAX / 8);
  GH_TRY(gh_alloc(g->s.ctx, all, sizeof **members, members));
  for (int c = 0; c < g->ncells; c++) {
    const gh_msh_cell *cell = g->cells + c;
    if (cell->nnodes > 2) continue;
    for (int k = 0; k < cell->group[1]; k++)
      (*members)[(*n)++] = (member){cell->nnodes - 1, c, g->groups[cell->group[0] + k]};
  }
  if (*n > 0) qsort(*members, (size_t)*n, sizeof **members, member_compare);
  return GH_OK;
}

/* Nodes and edges of one physical group. Nodes that no quadrilateral uses are not in the mesh. listed: of each
 * edge of the boundary, at first false. */
static gh_status set_fill(gh_msh *g, const member *members, int n, const gh_mesh_edge *outer, int nouter,
                          bool *listed, gh_mesh_set *set) {
  GH_TRY(gh_alloc(g->s.ctx, 2 * (size_t)n, sizeof *set->nodes, &set->nodes));
  GH_TRY(gh_alloc(g->s.ctx, (size_t)n, sizeof *set->edges, &set->edges));
  for (int k = 0; k < n; k++) {
    if (k && members[k].cell == members[k - 1].cell) continue;
    const gh_msh_cell *cell = g->cells + members[k].cell;
    int node[2] = {-1, -1};
    for (int a = 0; a < cell->nnodes; a++) {
      node[a] = g->nodes[cell->node[a]].index;
      if (node[a] >= 0) set->nodes[set->nnodes++] = node[a];
    }
    const bool within = node[0] >= 0 && node[1] >= 0;
    const gh_mesh_edge *found = within ? gh_mesh_find_edge(outer, nouter, node[0], node[1]) : NULL;
    if (!found && cell->nnodes == 2) set->nlines++;
    if (!found || listed[found - outer]) continue; /* by another line */
    listed[found - outer] = true;
    set->edges[set->nedges][0] = found->a;
    set->edges[set->nedges++][1] = found->b;
  }
  if (set->nnodes > 0) qsort(set->nodes, (size_t)set->nnodes, sizeof *set->nodes, int_compare);
  int kept = 0;
  for (int k = 0; k < set->nnodes; k++)
    if (kept == 0 || set->nodes[k] != set->nodes[kept - 1]) set->nodes[kept++] = set->nodes[k];
  set->nnodes = kept;
  return GH_OK;
}

static gh_status set_name(gh_msh *g, int dim, long tag, gh_mesh_set *set) {
  char number[32];
  snprintf(number, sizeof number, "%ld", tag);
  int k = gh_msh_find(g->names, g->nnames, sizeof *g->names, dim, tag);
  const char *name = k >= 0 ? g->names[k].text : number;
  GH_TRY(gh_alloc(g->s.ctx, strlen(name) + 1, 1, &set->name));
  strcpy(set->name, name);
  return GH_OK;
}

/* The set of the n members of one group, unless the mesh has none of its nodes. */
static gh_status set_add(gh_msh *g, const member *members, int n, const gh_mesh_edge *outer, int nouter,
                         gh_mesh *mesh) {
  gh_mesh_set set = {0};
  bool *listed;
  GH_TRY(gh_alloc(g->s.ctx, (size_t)nouter, sizeof *listed, &listed));
  gh_status status = set_fill(g, members, n, outer, nouter, listed, &set);
  free(listed);
  if (status == GH_OK && set.nnodes > 0) status = set_name(g, members->dim, members->tag, &set);
  if (status != GH_OK || set.nnodes == 0) {
    free(set.nodes);
    free(set.edges);
    free(set.name);
    return status;
  }
  mesh->sets[mesh->nsets++] = set;
  return GH_OK;
}

static int name_compare(const void *p, const void *q) {
  return strcmp(*(char *const *)p, *(char *const *)q);
}

/* Sets are looked up by their names. */
static gh_status names_check(const gh_msh *g, const gh_mesh *mesh) {
  const char **names;
  GH_TRY(gh_alloc(g->s.ctx, (size_t)mesh->nsets, sizeof *names, &names));
  for (int k = 0; k < mesh->nsets; k++) names[k] = mesh->sets[k].name;
  if (mesh->nsets > 0) qsort(names, (size_t)mesh->nsets, sizeof *names, name_compare);
  gh_status status = GH_OK;
  char quoted[GH_QUOTE];
  for (int k = 1; k < mesh->nsets && status == GH_OK; k++)
    if (strcmp(names[k - 1], names[k]) == 0)
      status = gh_fail(g->s.ctx, GH_INPUT, "%s: two physical groups of points and lines are called \"%s\"",
                       g->s.path, gh_quote(names[k], quoted));
  free(names);
  return status;
}

gh_status gh_msh_sets(gh_msh *g, gh_mesh *mesh) {
  gh_mesh_edge *outer = NULL;
  member *members = NULL;
  int nouter, n, groups = 0;
  gh_status status;
  GH_TRY_OR(gh_mesh_boundary_edges(g->s.ctx, mesh->nelements, (const int(*)[4])mesh->quad, &outer, &nouter),
            done);
  GH_TRY_OR(members_list(g, &members, &n), done);
  for (int k = 0; k < n; k++)
    groups += k == 0 || members[k].dim != members[k - 1].dim || members[k].tag != members[k - 1].tag;
  GH_TRY_OR(gh_alloc(g->s.ctx, (size_t)groups, sizeof *mesh->sets, &mesh->sets), done);
  for (int k = 0, next; k < n; k = next) {
    for (next = k + 1;
         next < n && members[next].dim == members[k].dim && members[next].tag == members[k].tag;)
      next++;
    GH_TRY_OR(set_add(g, members + k, next - k, outer, nouter, mesh), done);
  }
  status = names_check(g, mesh);
done:
  free(outer);
  free(members);
  return status;
}
