/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the files of the Gmsh reader share. */
#ifndef GRANHOM_MESH_GMSH_H
#define GRANHOM_MESH_GMSH_H

#include "io/file.h"
#include "granhom/mesh.h"

/* ---- gmsh_words.c: words of the file ---- */

typedef struct gh_msh_words {
  gh_context *ctx;
  const char *path;
  gh_reader file;
  char *at;         /* behind the last word */
  int line;         /* of the last word */
  const char *word; /* the last word; points into the text */
  char *cut;        /* where it was cut off, and */
  char kept;        /* what stood there */
} gh_msh_words;

/* Fails with file and line of the last word. */
#define GH_MSH_FAIL(s, format, ...)                                                                          \
  gh_fail((s)->ctx, GH_INPUT, "%s:%d: " format, (s)->path, (s)->line, __VA_ARGS__)

gh_status gh_msh_open(gh_msh_words *s);
/* The next word: up to white space, or a "quoted name" without its quotes. False at the end of the file. */
bool gh_msh_next(gh_msh_words *s);
/* The same as an error at the end of the file; `what` should stand there. */
gh_status gh_msh_word(gh_msh_words *s, const char *what);
gh_status gh_msh_integer(gh_msh_words *s, const char *what, long low, long high, long *value);
gh_status gh_msh_number(gh_msh_words *s, const char *what, double *value);
/* A count of things that take at least one byte each: a larger one than the file has bytes left is an error.
 */
gh_status gh_msh_count(gh_msh_words *s, const char *what, long *value);
/* The line that ends a section. */
gh_status gh_msh_end(gh_msh_words *s, const char *section);
/* On to the end of a section that nothing is read of. */
gh_status gh_msh_skip(gh_msh_words *s, const char *section);

/* ---- gmsh_sections.c: what the file holds ---- */

typedef struct gh_msh_node {
  long id;
  int line, index; /* index in the mesh; -1 while no quadrilateral uses it */
  double x[2];
} gh_msh_node;

typedef struct gh_msh_cell { /* point, line or quadrilateral */
  long id;
  int line, nnodes;
  long node[4]; /* ids, later places in `nodes` */
  int group[2]; /* first and number of its physical groups in `groups` */
} gh_msh_cell;

typedef struct gh_msh_key { /* what entities and physical groups are found by */
  int dim, place;           /* place: of several with one tag, the one that is listed last holds */
  long tag;
} gh_msh_key;

typedef struct gh_msh_entity { /* of MSH 4.1 */
  gh_msh_key key;
  int group[2];
} gh_msh_entity;

typedef struct gh_msh_name {
  gh_msh_key key;
  char *text;
} gh_msh_name;

typedef struct gh_msh {
  gh_msh_words s;
  bool v4;
  gh_msh_node *nodes;
  gh_msh_cell *cells;
  gh_msh_entity *entities; /* sorted by dimension and tag */
  gh_msh_name *names;      /* sorted by dimension and tag */
  long *groups;            /* physical tags, in runs */
  int nnodes, ncells, nentities, nnames, ngroups;
  size_t cap_nodes, cap_cells, cap_entities, cap_names, cap_groups;
} gh_msh;

/* Index of the last of n objects in ascending order, each of which begins with its key, that has this
 * dimension and tag; -1 when none has. */
int gh_msh_find(const void *objects, int n, size_t size, int dim, long tag);
/* Reads the whole file. */
gh_status gh_msh_read(gh_msh *g);
void gh_msh_free(gh_msh *g);

/* ---- gmsh_groups.c: physical groups become sets ---- */

/* Sets of the mesh, whose nodes and quadrilaterals are there: physical groups of lines, then of points, each
 * in the order of their numbers. */
gh_status gh_msh_sets(gh_msh *g, gh_mesh *mesh);

#endif
