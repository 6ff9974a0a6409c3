/* Gmsh meshes, MSH 2.2 and 4.1 ASCII (format: the Gmsh reference manual). SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "macro/internal.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* ---- words of the file ---- */

typedef struct scanner {
  gh_context *ctx;
  const char *path;
  char *text;       /* the whole file */
  char *end;        /* behind its last character */
  char *at;         /* behind the last word */
  int line;         /* of the last word */
  const char *word; /* the last word; points into text */
  char *cut;        /* where it was cut off, and */
  char kept;        /* what stood there */
} scanner;

static gh_status read_all(scanner *s) {
  FILE *file = fopen(s->path, "rb");
  if (!file) return gh_fail(s->ctx, GH_INPUT, "%s: cannot be opened: %s", s->path, strerror(errno));
  size_t length = 0, capacity = 0, got;
  gh_status status;
  do {
    GH_TRY_OR(gh_grow(s->ctx, length + 65536, 1, &capacity, &s->text), done);
    got = fread(s->text + length, 1, capacity - length - 1, file);
    length += got;
  } while (got > 0);
  if (ferror(file)) status = gh_fail(s->ctx, GH_INPUT, "%s: cannot be read: %s", s->path, strerror(errno));
  s->text[length] = '\0';
  s->end = s->text + length;
  s->at = s->text;
  s->line = 1;
done:
  fclose(file);
  return status;
}

/* The next word: up to white space, or a "quoted name" without its quotes. False at the end of the file. */
static bool next_word(scanner *s) {
  if (s->cut) *s->cut = s->kept;
  s->cut = NULL;
  for (; *s->at && strchr(" \t\r\n", *s->at); s->at++) s->line += *s->at == '\n';
  if (!*s->at) return false;
  bool quoted = *s->at == '"';
  char *begin = s->at + quoted, *end = begin + strcspn(begin, quoted ? "\"\n" : " \t\r\n");
  s->at = end + (quoted && *end == '"');
  s->word = begin;
  s->cut = end;
  s->kept = *end;
  *end = '\0';
  return true;
}

static gh_status want_word(scanner *s, const char *what) {
  if (next_word(s)) return GH_OK;
  return gh_fail(s->ctx, GH_INPUT, "%s:%d: the file ends where %s should stand (truncated?)", s->path,
                 s->line, what);
}

static gh_status want_integer(scanner *s, const char *what, long low, long high, long *value) {
  GH_TRY(want_word(s, what));
  char *end;
  errno = 0;
  *value = strtol(s->word, &end, 10);
  if (end == s->word || *end || errno)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: \"%s\" is not an integer (%s)", s->path, s->line, s->word, what);
  if (*value < low || *value > high)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: %s is %ld, not within %ld to %ld", s->path, s->line, what,
                   *value, low, high);
  return GH_OK;
}

static gh_status want_number(scanner *s, const char *what, double *value) {
  GH_TRY(want_word(s, what));
  char *end;
  *value = strtod(s->word, &end);
  if (end == s->word || *end || !isfinite(*value))
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: \"%s\" is not a finite number (%s)", s->path, s->line, s->word,
                   what);
  return GH_OK;
}

/* A count of things that take at least one byte each: a larger one than the file has bytes left is an error.
 */
static gh_status want_count(scanner *s, const char *what, long *value) {
  GH_TRY(want_integer(s, what, 0, INT_MAX / 8, value));
  if (s->end - s->at < *value)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: %s is %ld, more than the rest of the file can hold", s->path,
                   s->line, what, *value);
  return GH_OK;
}

static gh_status want_end(scanner *s, const char *section) {
  GH_TRY(want_word(s, "the end of a section"));
  if (strncmp(s->word, "$End", 4) == 0 && strcmp(s->word + 4, section) == 0) return GH_OK;
  return gh_fail(s->ctx, GH_INPUT, "%s:%d: \"%s\" where $End%s should stand", s->path, s->line, s->word,
                 section);
}

/* ---- what the file holds ---- */

typedef struct file_node {
  long id;
  int line, index; /* index in the mesh; -1 while no quadrilateral uses it */
  double x[2];
} file_node;

typedef struct file_cell { /* point, line or quadrilateral */
  long id;
  int line, nnodes;
  long node[4]; /* ids, later places in `nodes` */
  int group[2]; /* first and number of its physical groups in `groups` */
} file_cell;

typedef struct entity { /* of MSH 4.1 */
  int dim;
  long tag;
  int group[2];
} entity;

typedef struct physical_name {
  int dim;
  long tag;
  char *text;
} physical_name;

typedef struct gmsh {
  scanner s;
  bool v4;
  file_node *nodes;
  file_cell *cells;
  entity *entities;
  physical_name *names;
  long *groups; /* physical tags, in runs */
  int nnodes, ncells, nentities, nnames, ngroups;
  size_t cap_nodes, cap_cells, cap_entities, cap_names, cap_groups;
} gmsh;

static gh_status add_group(gmsh *g, long tag) {
  GH_TRY(gh_grow(g->s.ctx, (size_t)g->ngroups + 1, sizeof *g->groups, &g->cap_groups, &g->groups));
  g->groups[g->ngroups++] = labs(tag); /* the sign is an orientation */
  return GH_OK;
}

static gh_status read_format(gmsh *g) {
  scanner *s = &g->s;
  long binary, size;
  GH_TRY(want_word(s, "the version"));
  g->v4 = strcmp(s->word, "4.1") == 0;
  if (!g->v4 && strcmp(s->word, "2.2") != 0)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: MSH version %s; 2.2 and 4.1 are read", s->path, s->line,
                   s->word);
  GH_TRY(want_integer(s, "the file type", 0, 1, &binary));
  if (binary)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: a binary mesh; only ASCII is read (Mesh.Binary = 0)", s->path,
                   s->line);
  return want_integer(s, "the data size", 1, 16, &size);
}

static gh_status read_names(gmsh *g) {
  scanner *s = &g->s;
  long n, dim, tag;
  GH_TRY(want_count(s, "number of physical names", &n));
  for (long k = 0; k < n; k++) {
    GH_TRY(want_integer(s, "dimension of a physical group", 0, 3, &dim));
    GH_TRY(want_integer(s, "number of a physical group", LONG_MIN / 2, LONG_MAX / 2, &tag));
    GH_TRY(want_word(s, "name of a physical group"));
    GH_TRY(gh_grow(s->ctx, (size_t)g->nnames + 1, sizeof *g->names, &g->cap_names, &g->names));
    physical_name *name = g->names + g->nnames;
    *name = (physical_name){.dim = (int)dim, .tag = labs(tag)};
    GH_TRY(gh_alloc(s->ctx, strlen(s->word) + 1, 1, &name->text));
    strcpy(name->text, s->word);
    g->nnames++;
  }
  return GH_OK;
}

static gh_status skip_numbers(gmsh *g, long n) {
  double ignored;
  for (long k = 0; k < n; k++) GH_TRY(want_number(&g->s, "a number of an entity", &ignored));
  return GH_OK;
}

/* $Entities: the physical groups of points, curves and surfaces. */
static gh_status read_entities(gmsh *g) {
  scanner *s = &g->s;
  long n[4], tag, m, group;
  for (int dim = 0; dim < 4; dim++) GH_TRY(want_count(s, "number of entities", n + dim));
  for (int dim = 0; dim < 4; dim++)
    for (long k = 0; k < n[dim]; k++) {
      GH_TRY(want_integer(s, "tag of an entity", LONG_MIN, LONG_MAX, &tag));
      GH_TRY(skip_numbers(g, dim == 0 ? 3 : 6)); /* position or bounding box */
      GH_TRY(want_count(s, "number of physical groups", &m));
      GH_TRY(gh_grow(s->ctx, (size_t)g->nentities + 1, sizeof *g->entities, &g->cap_entities, &g->entities));
      g->entities[g->nentities++] = (entity){dim, tag, {g->ngroups, (int)m}};
      for (long j = 0; j < m; j++) {
        GH_TRY(want_integer(s, "number of a physical group", LONG_MIN / 2, LONG_MAX / 2, &group));
        GH_TRY(add_group(g, group));
      }
      if (dim == 0) continue;
      GH_TRY(want_count(s, "number of bounding entities", &m));
      GH_TRY(skip_numbers(g, m));
    }
  return GH_OK;
}

static gh_status add_node(gmsh *g, long id, int line, file_node **node) {
  GH_TRY(gh_grow(g->s.ctx, (size_t)g->nnodes + 1, sizeof *g->nodes, &g->cap_nodes, &g->nodes));
  *node = g->nodes + g->nnodes++;
  **node = (file_node){.id = id, .line = line, .index = -1};
  return GH_OK;
}

static gh_status read_position(gmsh *g, file_node *node) {
  scanner *s = &g->s;
  double z;
  GH_TRY(want_number(s, "x of a node", node->x));
  GH_TRY(want_number(s, "y of a node", node->x + 1));
  GH_TRY(want_number(s, "z of a node", &z));
  if (z != 0)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: node %ld has z = %g; the mesh must lie in z = 0", s->path,
                   s->line, node->id, z);
  return GH_OK;
}

static gh_status read_nodes_2(gmsh *g) {
  scanner *s = &g->s;
  long n, id;
  file_node *node;
  GH_TRY(want_count(s, "number of nodes", &n));
  for (long k = 0; k < n; k++) {
    GH_TRY(want_integer(s, "number of a node", LONG_MIN, LONG_MAX, &id));
    GH_TRY(add_node(g, id, s->line, &node));
    GH_TRY(read_position(g, node));
  }
  return GH_OK;
}

static gh_status read_nodes_4(gmsh *g) {
  scanner *s = &g->s;
  long blocks, total, ignored, dim, parametric, n, id;
  GH_TRY(want_count(s, "number of node blocks", &blocks));
  GH_TRY(want_count(s, "number of nodes", &total));
  for (int k = 0; k < 2; k++) GH_TRY(want_integer(s, "range of node numbers", LONG_MIN, LONG_MAX, &ignored));
  for (long b = 0; b < blocks; b++) {
    GH_TRY(want_integer(s, "dimension of an entity", 0, 3, &dim));
    GH_TRY(want_integer(s, "tag of an entity", LONG_MIN, LONG_MAX, &ignored));
    GH_TRY(want_integer(s, "parametric", 0, 1, &parametric));
    GH_TRY(want_count(s, "number of nodes of a block", &n));
    int first = g->nnodes;
    file_node *node;
    for (long k = 0; k < n; k++) {
      GH_TRY(want_integer(s, "number of a node", LONG_MIN, LONG_MAX, &id));
      GH_TRY(add_node(g, id, s->line, &node));
    }
    for (long k = 0; k < n; k++) {
      GH_TRY(read_position(g, g->nodes + first + k));
      GH_TRY(skip_numbers(g, parametric ? dim : 0));
    }
  }
  if (total != g->nnodes)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: %d nodes where %ld are announced", s->path, s->line, g->nnodes,
                   total);
  return GH_OK;
}

/* Number of nodes of a supported element type; others are named in the message. */
static gh_status cell_size(const scanner *s, long type, int *n) {
  static const struct {
    int type, nodes;
    const char *name;
  } known[] = {{15, 1, NULL},
               {1, 2, NULL},
               {3, 4, NULL},
               {2, 0, "triangle"},
               {8, 0, "quadratic line"},
               {9, 0, "quadratic triangle"},
               {10, 0, "quadratic quadrilateral"},
               {16, 0, "quadratic quadrilateral"},
               {4, 0, "tetrahedron"},
               {5, 0, "hexahedron"}};
  const char *name = "unsupported element";
  for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
    if (known[k].type != type) continue;
    *n = known[k].nodes;
    if (*n) return GH_OK;
    name = known[k].name;
  }
  return gh_fail(
      s->ctx, GH_INPUT,
      "%s:%d: a %s (type %ld); only 4-node quadrilaterals are read, with 2-node lines and points as sets",
      s->path, s->line, name, type);
}

static gh_status add_cell(gmsh *g, const file_cell *cell) {
  GH_TRY(gh_grow(g->s.ctx, (size_t)g->ncells + 1, sizeof *g->cells, &g->cap_cells, &g->cells));
  g->cells[g->ncells++] = *cell;
  return GH_OK;
}

static gh_status read_corners(gmsh *g, file_cell *cell) {
  for (int a = 0; a < cell->nnodes; a++)
    GH_TRY(want_integer(&g->s, "node of an element", LONG_MIN, LONG_MAX, cell->node + a));
  return add_cell(g, cell);
}

static gh_status read_elements_2(gmsh *g) {
  scanner *s = &g->s;
  long n, type, ntags, tag;
  GH_TRY(want_count(s, "number of elements", &n));
  for (long k = 0; k < n; k++) {
    file_cell cell = {0};
    GH_TRY(want_integer(s, "number of an element", LONG_MIN, LONG_MAX, &cell.id));
    cell.line = s->line;
    GH_TRY(want_integer(s, "type of an element", 1, 1000, &type));
    GH_TRY(cell_size(s, type, &cell.nnodes));
    GH_TRY(want_count(s, "number of tags", &ntags));
    cell.group[0] = g->ngroups;
    for (long j = 0; j < ntags; j++) {
      GH_TRY(want_integer(s, "tag of an element", LONG_MIN / 2, LONG_MAX / 2, &tag));
      if (j > 0 || tag == 0) continue; /* the first is the physical group, 0 means none */
      GH_TRY(add_group(g, tag));
      cell.group[1] = 1;
    }
    GH_TRY(read_corners(g, &cell));
  }
  return GH_OK;
}

static gh_status read_elements_4(gmsh *g) {
  scanner *s = &g->s;
  long blocks, total, ignored, dim, tag, type, n;
  int first = g->ncells;
  GH_TRY(want_count(s, "number of element blocks", &blocks));
  GH_TRY(want_count(s, "number of elements", &total));
  for (int k = 0; k < 2; k++)
    GH_TRY(want_integer(s, "range of element numbers", LONG_MIN, LONG_MAX, &ignored));
  for (long b = 0; b < blocks; b++) {
    file_cell cell = {0};
    GH_TRY(want_integer(s, "dimension of an entity", 0, 3, &dim));
    GH_TRY(want_integer(s, "tag of an entity", LONG_MIN, LONG_MAX, &tag));
    GH_TRY(want_integer(s, "type of elements", 1, 1000, &type));
    GH_TRY(cell_size(s, type, &cell.nnodes));
    GH_TRY(want_count(s, "number of elements of a block", &n));
    for (int k = 0; k < g->nentities; k++)
      if (g->entities[k].dim == dim && g->entities[k].tag == tag)
        memcpy(cell.group, g->entities[k].group, sizeof cell.group);
    for (long k = 0; k < n; k++) {
      GH_TRY(want_integer(s, "number of an element", LONG_MIN, LONG_MAX, &cell.id));
      cell.line = s->line;
      GH_TRY(read_corners(g, &cell));
    }
  }
  if (total != g->ncells - first)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: %d elements where %ld are announced", s->path, s->line,
                   g->ncells - first, total);
  return GH_OK;
}

static gh_status skip_section(gmsh *g, const char *section) {
  scanner *s = &g->s;
  int line = s->line;
  while (next_word(s))
    if (strncmp(s->word, "$End", 4) == 0 && strcmp(s->word + 4, section) == 0) return GH_OK;
  return gh_fail(s->ctx, GH_INPUT, "%s:%d: $%s has no $End%s (truncated?)", s->path, line, section, section);
}

static gh_status read_section(gmsh *g, const char *name) {
  scanner *s = &g->s;
  if (strcmp(name, "PhysicalNames") == 0) GH_TRY(read_names(g));
  else if (strcmp(name, "Entities") == 0 && g->v4) GH_TRY(read_entities(g));
  else if (strcmp(name, "Nodes") == 0) GH_TRY(g->v4 ? read_nodes_4(g) : read_nodes_2(g));
  else if (strcmp(name, "Elements") == 0) GH_TRY(g->v4 ? read_elements_4(g) : read_elements_2(g));
  else if (strcmp(name, "PartitionedEntities") == 0)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: a partitioned mesh; save it without partitions", s->path,
                   s->line);
  else return skip_section(g, name);
  return want_end(s, name);
}

static gh_status read_sections(gmsh *g) {
  scanner *s = &g->s;
  if (!next_word(s)) return gh_fail(s->ctx, GH_INPUT, "%s:1: the file is empty", s->path);
  if (strcmp(s->word, "$MeshFormat") != 0)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: no Gmsh file: it does not begin with $MeshFormat", s->path,
                   s->line);
  GH_TRY(read_format(g));
  GH_TRY(want_end(s, "MeshFormat"));
  while (next_word(s)) {
    char name[64];
    if (s->word[0] != '$' || strlen(s->word) >= sizeof name)
      return gh_fail(s->ctx, GH_INPUT, "%s:%d: \"%.40s\" where a section should begin", s->path, s->line,
                     s->word);
    strcpy(name, s->word + 1);
    GH_TRY(read_section(g, name));
  }
  return GH_OK;
}

/* ---- from the file to the mesh ---- */

static int by_id(const void *p, const void *q) {
  const file_node *a = p, *b = q;
  return (a->id > b->id) - (a->id < b->id);
}

static int by_line(const void *p, const void *q) {
  const file_node *a = p, *b = q;
  return a->line - b->line;
}

/* Replaces the cells' node ids by places in the list of nodes. */
static gh_status find_nodes(gmsh *g) {
  const scanner *s = &g->s;
  if (g->nnodes == 0) return gh_fail(s->ctx, GH_INPUT, "%s: the mesh has no nodes", s->path);
  qsort(g->nodes, (size_t)g->nnodes, sizeof *g->nodes, by_id);
  for (int a = 1; a < g->nnodes; a++)
    if (g->nodes[a].id == g->nodes[a - 1].id)
      return gh_fail(s->ctx, GH_INPUT, "%s:%d: node %ld occurs twice", s->path,
                     g->nodes[a].line > g->nodes[a - 1].line ? g->nodes[a].line : g->nodes[a - 1].line,
                     g->nodes[a].id);
  for (int c = 0; c < g->ncells; c++)
    for (int a = 0; a < g->cells[c].nnodes; a++) {
      file_node key = {.id = g->cells[c].node[a]};
      const file_node *found = bsearch(&key, g->nodes, (size_t)g->nnodes, sizeof *g->nodes, by_id);
      if (!found)
        return gh_fail(s->ctx, GH_INPUT, "%s:%d: element %ld refers to node %ld, which is missing", s->path,
                       g->cells[c].line, g->cells[c].id, key.id);
      g->cells[c].node[a] = found - g->nodes;
    }
  return GH_OK;
}

static void sorted_corners(const file_cell *cell, long n[4]) {
  memcpy(n, cell->node, sizeof cell->node);
  for (int a = 1; a < 4; a++)
    for (int b = a; b > 0 && n[b] < n[b - 1]; b--) {
      long swap = n[b];
      n[b] = n[b - 1];
      n[b - 1] = swap;
    }
}

static int by_corners(const void *p, const void *q) {
  const file_cell *a = *(file_cell *const *)p, *b = *(file_cell *const *)q;
  long na[4], nb[4];
  sorted_corners(a, na);
  sorted_corners(b, nb);
  for (int k = 0; k < 4; k++)
    if (na[k] != nb[k]) return na[k] < nb[k] ? -1 : 1;
  return a->line - b->line;
}

static int by_place(const void *p, const void *q) {
  const file_cell *a = *(file_cell *const *)p, *b = *(file_cell *const *)q;
  return (a > b) - (a < b);
}

/* The quadrilaterals in the file's order, each once: MSH 2.2 repeats an element for each of its physical
 * groups. */
static gh_status collect_quads(gmsh *g, file_cell ***quads, int *n) {
  GH_TRY(gh_alloc(g->s.ctx, (size_t)g->ncells, sizeof **quads, quads));
  int all = 0, kept = 0;
  for (int c = 0; c < g->ncells; c++)
    if (g->cells[c].nnodes == 4) (*quads)[all++] = g->cells + c;
  qsort(*quads, (size_t)all, sizeof **quads, by_corners);
  for (int k = 0; k < all; k++) {
    long before[4] = {-1, -1, -1, -1}, here[4];
    if (kept) sorted_corners((*quads)[kept - 1], before);
    sorted_corners((*quads)[k], here);
    if (memcmp(before, here, sizeof here) != 0) (*quads)[kept++] = (*quads)[k];
  }
  qsort(*quads, (size_t)kept, sizeof **quads, by_place);
  *n = kept;
  if (kept == 0) return gh_fail(g->s.ctx, GH_INPUT, "%s: the mesh has no quadrilateral", g->s.path);
  return GH_OK;
}

/* Turns a clockwise quadrilateral; refuses one that is not convex. */
static gh_status orient_quad(gmsh *g, file_cell *cell) {
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
static gh_status fill_mesh(gmsh *g, file_cell **quads, int n, gh_mesh *mesh) {
  gh_context *ctx = g->s.ctx;
  file_node *order = NULL;
  gh_status status;
  for (int e = 0; e < n; e++) {
    GH_TRY(orient_quad(g, quads[e]));
    for (int a = 0; a < 4; a++) g->nodes[quads[e]->node[a]].index = 0;
  }
  GH_TRY_OR(gh_alloc(ctx, (size_t)g->nnodes, sizeof *order, &order), done);
  for (int a = 0; a < g->nnodes; a++) {
    order[a] = g->nodes[a];
    order[a].id = a; /* the place, to find back after sorting */
  }
  qsort(order, (size_t)g->nnodes, sizeof *order, by_line);
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

/* ---- sets ---- */

typedef struct side { /* an edge of a quadrilateral, counter-clockwise, with its nodes also in order */
  int low, high, a, b;
} side;

static int by_side(const void *p, const void *q) {
  const side *a = p, *b = q;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  return (a->high > b->high) - (a->high < b->high);
}

/* The edges that belong to one quadrilateral only, sorted. */
static gh_status find_boundary(gh_context *ctx, const gh_mesh *mesh, side **sides, int *n) {
  int all = 0, kept = 0;
  GH_TRY(gh_alloc(ctx, 4 * (size_t)mesh->nelements, sizeof **sides, sides));
  for (int e = 0; e < mesh->nelements; e++)
    for (int k = 0; k < 4; k++) {
      int a = mesh->quad[e][k], b = mesh->quad[e][(k + 1) % 4];
      (*sides)[all++] = (side){a < b ? a : b, a < b ? b : a, a, b};
    }
  qsort(*sides, (size_t)all, sizeof **sides, by_side);
  for (int k = 0, next; k < all; k = next) {
    for (next = k + 1; next < all && by_side(*sides + k, *sides + next) == 0;) next++;
    if (next == k + 1) (*sides)[kept++] = (*sides)[k];
  }
  *n = kept;
  return GH_OK;
}

static bool in_group(const gmsh *g, const file_cell *cell, int dim, long tag) {
  if (cell->nnodes != dim + 1) return false;
  for (int k = 0; k < cell->group[1]; k++)
    if (g->groups[cell->group[0] + k] == tag) return true;
  return false;
}

static int by_value(const void *p, const void *q) {
  return *(const int *)p - *(const int *)q;
}

/* Nodes and edges of one physical group. Nodes that no quadrilateral uses are not in the mesh. */
static gh_status fill_set(gmsh *g, int dim, long tag, const side *sides, int nsides, gh_mesh_set *set) {
  gh_context *ctx = g->s.ctx;
  size_t count = 0;
  for (int c = 0; c < g->ncells; c++) count += in_group(g, g->cells + c, dim, tag);
  GH_TRY(gh_alloc(ctx, 2 * count, sizeof *set->nodes, &set->nodes));
  GH_TRY(gh_alloc(ctx, count, sizeof *set->edges, &set->edges));
  for (int c = 0; c < g->ncells; c++) {
    const file_cell *cell = g->cells + c;
    if (!in_group(g, cell, dim, tag)) continue;
    int node[2] = {-1, -1};
    for (int a = 0; a <= dim; a++) {
      node[a] = g->nodes[cell->node[a]].index;
      if (node[a] >= 0) set->nodes[set->nnodes++] = node[a];
    }
    if (dim == 0 || node[0] < 0 || node[1] < 0) continue;
    side key = {node[0] < node[1] ? node[0] : node[1], node[0] < node[1] ? node[1] : node[0], 0, 0};
    const side *found = bsearch(&key, sides, (size_t)nsides, sizeof *sides, by_side);
    if (!found) continue;
    set->edges[set->nedges][0] = found->a;
    set->edges[set->nedges++][1] = found->b;
  }
  qsort(set->nodes, (size_t)set->nnodes, sizeof *set->nodes, by_value);
  int kept = 0;
  for (int k = 0; k < set->nnodes; k++)
    if (kept == 0 || set->nodes[k] != set->nodes[kept - 1]) set->nodes[kept++] = set->nodes[k];
  set->nnodes = kept;
  return GH_OK;
}

static gh_status name_set(gmsh *g, int dim, long tag, const gh_mesh *mesh, gh_mesh_set *set) {
  char number[32];
  snprintf(number, sizeof number, "%ld", tag);
  const char *name = number;
  for (int k = 0; k < g->nnames; k++)
    if (g->names[k].dim == dim && g->names[k].tag == tag) name = g->names[k].text;
  if (gh_mesh_find(mesh, name) >= 0)
    return gh_fail(g->s.ctx, GH_INPUT, "%s: two physical groups of points and lines are called \"%s\"",
                   g->s.path, name);
  GH_TRY(gh_alloc(g->s.ctx, strlen(name) + 1, 1, &set->name));
  strcpy(set->name, name);
  return GH_OK;
}

static gh_status add_set(gmsh *g, int dim, long tag, const side *sides, int nsides, gh_mesh *mesh) {
  gh_mesh_set set = {0};
  gh_status status = fill_set(g, dim, tag, sides, nsides, &set);
  if (status == GH_OK && set.nnodes > 0) status = name_set(g, dim, tag, mesh, &set);
  if (status != GH_OK || set.nnodes == 0) {
    free(set.nodes);
    free(set.edges);
    free(set.name);
    return status;
  }
  mesh->sets[mesh->nsets++] = set;
  return GH_OK;
}

static int by_tag(const void *p, const void *q) {
  const long a = *(const long *)p, b = *(const long *)q;
  return (a > b) - (a < b);
}

/* Physical groups of lines, then of points, each in the order of their numbers. */
static gh_status make_sets(gmsh *g, gh_mesh *mesh) {
  side *sides = NULL;
  long *tags = NULL;
  int nsides, ntags = 0, unique = 0;
  gh_status status;
  GH_TRY_OR(find_boundary(g->s.ctx, mesh, &sides, &nsides), done);
  GH_TRY_OR(gh_alloc(g->s.ctx, (size_t)g->ngroups, sizeof *tags, &tags), done);
  GH_TRY_OR(gh_alloc(g->s.ctx, 2 * (size_t)g->ngroups, sizeof *mesh->sets, &mesh->sets), done);
  for (int k = 0; k < g->ngroups; k++) tags[ntags++] = g->groups[k];
  qsort(tags, (size_t)ntags, sizeof *tags, by_tag);
  for (int k = 0; k < ntags; k++)
    if (unique == 0 || tags[k] != tags[unique - 1]) tags[unique++] = tags[k];
  for (int dim = 1; dim >= 0; dim--)
    for (int k = 0; k < unique; k++) GH_TRY_OR(add_set(g, dim, tags[k], sides, nsides, mesh), done);
done:
  free(sides);
  free(tags);
  return status;
}

static gh_status build_mesh(gmsh *g, gh_mesh *mesh) {
  file_cell **quads = NULL;
  int n;
  gh_status status;
  GH_TRY_OR(find_nodes(g), done);
  GH_TRY_OR(collect_quads(g, &quads, &n), done);
  GH_TRY_OR(fill_mesh(g, quads, n, mesh), done);
  status = make_sets(g, mesh);
done:
  free(quads);
  return status;
}

gh_status gh_mesh_read_gmsh(gh_context *ctx, const char *path, gh_mesh **mesh) {
  gmsh g = {.s = {.ctx = ctx, .path = path}};
  gh_status status;
  *mesh = NULL;
  GH_TRY_OR(read_all(&g.s), done);
  GH_TRY_OR(read_sections(&g), done);
  GH_TRY_OR(gh_alloc(ctx, 1, sizeof **mesh, mesh), done);
  status = build_mesh(&g, *mesh);
  if (status != GH_OK) gh_mesh_destroy(mesh);
done:
  for (int k = 0; k < g.nnames; k++) free(g.names[k].text);
  free(g.names);
  free(g.entities);
  free(g.groups);
  free(g.nodes);
  free(g.cells);
  free(g.s.text);
  return status;
}
