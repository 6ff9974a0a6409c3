/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Sections of Gmsh meshes, MSH 2.2 and 4.1 ASCII (format: the Gmsh reference manual). */
#include "mesh/gmsh.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static int key_compare(const void *p, const void *q) {
  const gh_msh_key *a = p, *b = q;
  if (a->dim != b->dim) return a->dim - b->dim;
  if (a->tag != b->tag) return a->tag < b->tag ? -1 : 1;
  return a->place - b->place;
}

int gh_msh_find(const void *objects, int n, size_t size, int dim, long tag) {
  const gh_msh_key last = {dim, INT_MAX, tag};
  int low = 0, high = n; /* those below low are at most `last` */
  while (low < high) {
    int middle = low + (high - low) / 2;
    if (key_compare((const char *)objects + (size_t)middle * size, &last) <= 0) low = middle + 1;
    else high = middle;
  }
  if (low == 0) return -1;
  const gh_msh_key *found = (const gh_msh_key *)((const char *)objects + (size_t)(low - 1) * size);
  return found->dim == dim && found->tag == tag ? low - 1 : -1;
}

static gh_status group_add(gh_msh *g, long tag) {
  GH_TRY(gh_grow(g->s.ctx, (size_t)g->ngroups + 1, sizeof *g->groups, &g->cap_groups, &g->groups));
  g->groups[g->ngroups++] = labs(tag); /* the sign is an orientation */
  return GH_OK;
}

static const char how_to_save[] =
    "2.2 and 4.1 ASCII are read; save it as one of them (gmsh FILE -save -format msh41 -o NEW.msh, or "
    "Mesh.MshFileVersion = 4.1)";

static gh_status format_read(gh_msh *g) {
  gh_msh_words *s = &g->s;
  char quoted[GH_QUOTE];
  long binary, size;
  GH_TRY(gh_msh_word(s, "the version"));
  g->v4 = strcmp(s->word, "4.1") == 0;
  if (!g->v4 && strcmp(s->word, "2.2") != 0)
    return GH_MSH_FAIL(s, "MSH version %s; %s", gh_quote(s->word, quoted), how_to_save);
  GH_TRY(gh_msh_integer(s, "the file type", 0, 1, &binary));
  if (binary)
    return GH_MSH_FAIL(s, "a binary mesh (MSH %s); only ASCII is read (Mesh.Binary = 0)",
                       g->v4 ? "4.1" : "2.2");
  return gh_msh_integer(s, "the data size", 1, 16, &size);
}

static gh_status names_read(gh_msh *g) {
  gh_msh_words *s = &g->s;
  long n, dim, tag;
  GH_TRY(gh_msh_count(s, "number of physical names", &n));
  for (long k = 0; k < n; k++) {
    GH_TRY(gh_msh_integer(s, "dimension of a physical group", 0, 3, &dim));
    GH_TRY(gh_msh_integer(s, "number of a physical group", LONG_MIN / 2, LONG_MAX / 2, &tag));
    GH_TRY(gh_msh_word(s, "name of a physical group"));
    GH_TRY(gh_grow(s->ctx, (size_t)g->nnames + 1, sizeof *g->names, &g->cap_names, &g->names));
    gh_msh_name *name = g->names + g->nnames;
    *name = (gh_msh_name){.key = {(int)dim, g->nnames, labs(tag)}};
    GH_TRY(gh_alloc(s->ctx, strlen(s->word) + 1, 1, &name->text));
    strcpy(name->text, s->word);
    g->nnames++;
  }
  if (g->nnames > 0) qsort(g->names, (size_t)g->nnames, sizeof *g->names, key_compare);
  return GH_OK;
}

static gh_status numbers_skip(gh_msh *g, long n) {
  double ignored;
  for (long k = 0; k < n; k++) GH_TRY(gh_msh_number(&g->s, "a number of an entity", &ignored));
  return GH_OK;
}

/* $Entities: the physical groups of points, curves and surfaces. */
static gh_status entities_read(gh_msh *g) {
  gh_msh_words *s = &g->s;
  long n[4], tag, m, group;
  for (int dim = 0; dim < 4; dim++) GH_TRY(gh_msh_count(s, "number of entities", n + dim));
  for (int dim = 0; dim < 4; dim++)
    for (long k = 0; k < n[dim]; k++) {
      GH_TRY(gh_msh_integer(s, "tag of an entity", LONG_MIN, LONG_MAX, &tag));
      GH_TRY(numbers_skip(g, dim == 0 ? 3 : 6)); /* position or bounding box */
      GH_TRY(gh_msh_count(s, "number of physical groups", &m));
      GH_TRY(gh_grow(s->ctx, (size_t)g->nentities + 1, sizeof *g->entities, &g->cap_entities, &g->entities));
      g->entities[g->nentities] = (gh_msh_entity){{dim, g->nentities, tag}, {g->ngroups, (int)m}};
      g->nentities++;
      for (long j = 0; j < m; j++) {
        GH_TRY(gh_msh_integer(s, "number of a physical group", LONG_MIN / 2, LONG_MAX / 2, &group));
        GH_TRY(group_add(g, group));
      }
      if (dim == 0) continue;
      GH_TRY(gh_msh_count(s, "number of bounding entities", &m));
      GH_TRY(numbers_skip(g, m));
    }
  if (g->nentities > 0) qsort(g->entities, (size_t)g->nentities, sizeof *g->entities, key_compare);
  return GH_OK;
}

static gh_status node_add(gh_msh *g, long id, int line, gh_msh_node **node) {
  GH_TRY(gh_grow(g->s.ctx, (size_t)g->nnodes + 1, sizeof *g->nodes, &g->cap_nodes, &g->nodes));
  *node = g->nodes + g->nnodes++;
  **node = (gh_msh_node){.id = id, .line = line, .index = -1};
  return GH_OK;
}

static gh_status position_read(gh_msh *g, gh_msh_node *node) {
  gh_msh_words *s = &g->s;
  double z;
  GH_TRY(gh_msh_number(s, "x of a node", node->x));
  GH_TRY(gh_msh_number(s, "y of a node", node->x + 1));
  GH_TRY(gh_msh_number(s, "z of a node", &z));
  if (z != 0)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: node %ld has z = %g; the mesh must lie in z = 0", s->path,
                   s->line, node->id, z);
  return GH_OK;
}

/* parametric: $ParametricNodes, in which a node also has the dimension and tag of its entity and its
 * parameters there, one on a curve and two on a surface. */
static gh_status nodes_read_2(gh_msh *g, bool parametric) {
  gh_msh_words *s = &g->s;
  long n, id, dim, tag;
  gh_msh_node *node;
  GH_TRY(gh_msh_count(s, "number of nodes", &n));
  for (long k = 0; k < n; k++) {
    GH_TRY(gh_msh_integer(s, "number of a node", LONG_MIN, LONG_MAX, &id));
    GH_TRY(node_add(g, id, s->line, &node));
    GH_TRY(position_read(g, node));
    if (!parametric) continue;
    GH_TRY(gh_msh_integer(s, "dimension of a node's entity", 0, 3, &dim));
    GH_TRY(gh_msh_integer(s, "tag of a node's entity", LONG_MIN, LONG_MAX, &tag));
    GH_TRY(numbers_skip(g, dim < 3 ? dim : 0));
  }
  return GH_OK;
}

static gh_status nodes_read_4(gh_msh *g) {
  gh_msh_words *s = &g->s;
  long blocks, total, ignored, dim, parametric, n, id;
  GH_TRY(gh_msh_count(s, "number of node blocks", &blocks));
  GH_TRY(gh_msh_count(s, "number of nodes", &total));
  for (int k = 0; k < 2; k++)
    GH_TRY(gh_msh_integer(s, "range of node numbers", LONG_MIN, LONG_MAX, &ignored));
  for (long b = 0; b < blocks; b++) {
    GH_TRY(gh_msh_integer(s, "dimension of an entity", 0, 3, &dim));
    GH_TRY(gh_msh_integer(s, "tag of an entity", LONG_MIN, LONG_MAX, &ignored));
    GH_TRY(gh_msh_integer(s, "parametric", 0, 1, &parametric));
    GH_TRY(gh_msh_count(s, "number of nodes of a block", &n));
    int first = g->nnodes;
    gh_msh_node *node;
    for (long k = 0; k < n; k++) {
      GH_TRY(gh_msh_integer(s, "number of a node", LONG_MIN, LONG_MAX, &id));
      GH_TRY(node_add(g, id, s->line, &node));
    }
    for (long k = 0; k < n; k++) {
      GH_TRY(position_read(g, g->nodes + first + k));
      GH_TRY(numbers_skip(g, parametric ? dim : 0));
    }
  }
  if (total != g->nnodes) return GH_MSH_FAIL(s, "%d nodes where %ld are announced", g->nnodes, total);
  return GH_OK;
}

/* Number of nodes of a supported element type; others are named in the message. */
static gh_status cell_size(const gh_msh_words *s, long type, int *n) {
  static const struct {
    int type, nodes;
    const char *name;
  } known[] = {{15, 1, NULL},
               {1, 2, NULL},
               {3, 4, NULL},
               {2, 0, " triangle"},
               {4, 0, " tetrahedron"},
               {5, 0, " hexahedron"},
               {6, 0, " prism"},
               {7, 0, " pyramid"},
               {8, 0, " quadratic line"},
               {9, 0, " quadratic triangle"},
               {10, 0, " quadratic quadrilateral"},
               {11, 0, " quadratic tetrahedron"},
               {12, 0, " quadratic hexahedron"},
               {16, 0, " quadratic quadrilateral"},
               {17, 0, " quadratic hexahedron"},
               {20, 0, " cubic triangle"},
               {21, 0, " cubic triangle"},
               {26, 0, " cubic line"},
               {27, 0, " line of fourth order"},
               {36, 0, " cubic quadrilateral"},
               {37, 0, " quadrilateral of fourth order"},
               {39, 0, " cubic quadrilateral"}};
  const char *name = "n unsupported element", *advice = "";
  for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
    if (known[k].type != type) continue;
    *n = known[k].nodes;
    if (*n) return GH_OK;
    name = known[k].name;
  }
  if (type == 2) advice = " (in Gmsh: Recombine Surface, or Mesh.RecombineAll = 1)";
  else if (type >= 4 && type <= 7) advice = " (in Gmsh: mesh in two dimensions, gmsh -2)";
  else if (type >= 8) advice = " (in Gmsh: Mesh.ElementOrder = 1)";
  return GH_MSH_FAIL(
      s, "a%s (type %ld); only 4-node quadrilaterals are read, with 2-node lines and points as sets%s", name,
      type, advice);
}

static gh_status cell_add(gh_msh *g, const gh_msh_cell *cell) {
  GH_TRY(gh_grow(g->s.ctx, (size_t)g->ncells + 1, sizeof *g->cells, &g->cap_cells, &g->cells));
  g->cells[g->ncells++] = *cell;
  return GH_OK;
}

static gh_status corners_read(gh_msh *g, gh_msh_cell *cell) {
  for (int a = 0; a < cell->nnodes; a++)
    GH_TRY(gh_msh_integer(&g->s, "node of an element", LONG_MIN, LONG_MAX, cell->node + a));
  return cell_add(g, cell);
}

static gh_status elements_read_2(gh_msh *g) {
  gh_msh_words *s = &g->s;
  long n, type, ntags, tag;
  GH_TRY(gh_msh_count(s, "number of elements", &n));
  for (long k = 0; k < n; k++) {
    gh_msh_cell cell = {0};
    GH_TRY(gh_msh_integer(s, "number of an element", LONG_MIN, LONG_MAX, &cell.id));
    cell.line = s->line;
    GH_TRY(gh_msh_integer(s, "type of an element", 1, 1000, &type));
    GH_TRY(cell_size(s, type, &cell.nnodes));
    GH_TRY(gh_msh_count(s, "number of tags", &ntags));
    cell.group[0] = g->ngroups;
    for (long j = 0; j < ntags; j++) {
      GH_TRY(gh_msh_integer(s, "tag of an element", LONG_MIN / 2, LONG_MAX / 2, &tag));
      if (j > 0 || tag == 0) continue; /* the first is the physical group, 0 means none */
      GH_TRY(group_add(g, tag));
      cell.group[1] = 1;
    }
    GH_TRY(corners_read(g, &cell));
  }
  return GH_OK;
}

static gh_status elements_read_4(gh_msh *g) {
  gh_msh_words *s = &g->s;
  long blocks, total, ignored, dim, tag, type, n;
  int first = g->ncells;
  GH_TRY(gh_msh_count(s, "number of element blocks", &blocks));
  GH_TRY(gh_msh_count(s, "number of elements", &total));
  for (int k = 0; k < 2; k++)
    GH_TRY(gh_msh_integer(s, "range of element numbers", LONG_MIN, LONG_MAX, &ignored));
  for (long b = 0; b < blocks; b++) {
    gh_msh_cell cell = {0};
    GH_TRY(gh_msh_integer(s, "dimension of an entity", 0, 3, &dim));
    GH_TRY(gh_msh_integer(s, "tag of an entity", LONG_MIN, LONG_MAX, &tag));
    GH_TRY(gh_msh_integer(s, "type of elements", 1, 1000, &type));
    GH_TRY(cell_size(s, type, &cell.nnodes));
    GH_TRY(gh_msh_count(s, "number of elements of a block", &n));
    int entity = gh_msh_find(g->entities, g->nentities, sizeof *g->entities, (int)dim, tag);
    if (entity >= 0) memcpy(cell.group, g->entities[entity].group, sizeof cell.group);
    for (long k = 0; k < n; k++) {
      GH_TRY(gh_msh_integer(s, "number of an element", LONG_MIN, LONG_MAX, &cell.id));
      cell.line = s->line;
      GH_TRY(corners_read(g, &cell));
    }
  }
  if (total != g->ncells - first)
    return GH_MSH_FAIL(s, "%d elements where %ld are announced", g->ncells - first, total);
  return GH_OK;
}

static gh_status section_read(gh_msh *g, const char *name) {
  gh_msh_words *s = &g->s;
  bool second =
      (g->nnames && strcmp(name, "PhysicalNames") == 0) || (g->nentities && strcmp(name, "Entities") == 0);
  if (second) return GH_MSH_FAIL(s, "a second section $%s", name);
  if (strcmp(name, "PhysicalNames") == 0) GH_TRY(names_read(g));
  else if (strcmp(name, "Entities") == 0 && g->v4) GH_TRY(entities_read(g));
  else if (strcmp(name, "Nodes") == 0) GH_TRY(g->v4 ? nodes_read_4(g) : nodes_read_2(g, false));
  else if (strcmp(name, "ParametricNodes") == 0 && !g->v4) GH_TRY(nodes_read_2(g, true));
  else if (strcmp(name, "Elements") == 0) GH_TRY(g->v4 ? elements_read_4(g) : elements_read_2(g));
  else if (strcmp(name, "PartitionedEntities") == 0)
    return GH_MSH_FAIL(s, "%s",
                       "a partitioned mesh; save it without partitions (in Gmsh: UnpartitionMesh, or without "
                       "-part)");
  else return gh_msh_skip(s, name);
  return gh_msh_end(s, name);
}

/* The word that opens a section, without its dollar. */
static gh_status section_read_name(const gh_msh_words *s, char name[64]) {
  char quoted[GH_QUOTE];
  if (s->word[0] != '$' || !s->word[1] || strlen(s->word) >= 64)
    return GH_MSH_FAIL(s, "\"%s\" where a section should begin", gh_quote(s->word, quoted));
  strcpy(name, s->word + 1);
  return GH_OK;
}

/* On to the section $MeshFormat; comments may stand before it. */
static gh_status format_find(gh_msh *g) {
  gh_msh_words *s = &g->s;
  char name[64];
  while (gh_msh_next(s)) {
    if (strcmp(s->word, "$MeshFormat") == 0) return GH_OK;
    if (strcmp(s->word, "$NOD") == 0 || strcmp(s->word, "$ELM") == 0)
      return GH_MSH_FAIL(s, "MSH version 1, which begins with %s; %s", s->word, how_to_save);
    if (strncmp(s->word, "//", 2) == 0 || strncmp(s->word, "SetFactory(", 11) == 0 ||
        strncmp(s->word, "Point(", 6) == 0)
      return GH_MSH_FAIL(s, "%s", "a Gmsh geometry and no mesh; gmsh -2 FILE.geo makes FILE.msh");
    if (s->word[0] != '$' || strcmp(s->word, "$Nodes") == 0 || strcmp(s->word, "$Elements") == 0)
      return GH_MSH_FAIL(s, "%s", "no Gmsh file: it does not begin with $MeshFormat");
    GH_TRY(section_read_name(s, name));
    GH_TRY(gh_msh_skip(s, name));
  }
  return GH_MSH_FAIL(s, "%s", "no Gmsh file: it holds no $MeshFormat, only blank lines and comments");
}

gh_status gh_msh_read(gh_msh *g) {
  gh_msh_words *s = &g->s;
  char name[64];
  GH_TRY(gh_msh_open(s));
  GH_TRY(format_find(g));
  GH_TRY(format_read(g));
  GH_TRY(gh_msh_end(s, "MeshFormat"));
  while (gh_msh_next(s)) {
    GH_TRY(section_read_name(s, name));
    GH_TRY(section_read(g, name));
  }
  return GH_OK;
}

void gh_msh_free(gh_msh *g) {
  for (int k = 0; k < g->nnames; k++) free(g->names[k].text);
  free(g->names);
  free(g->entities);
  free(g->groups);
  free(g->nodes);
  free(g->cells);
  gh_reader_close(&g->s.file);
}
