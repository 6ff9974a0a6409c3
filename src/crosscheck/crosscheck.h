/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the files of a cross-check share: one path, several programs, several subdivisions of the
 * increments. */
#ifndef GRANHOM_CROSSCHECK_LEVELS_H
#define GRANHOM_CROSSCHECK_LEVELS_H

#include "granhom/crosscheck.h"

typedef struct cross_engine {
  const char *word, *title; /* on the command line and in files; in tables and plots */
  bool peer;
  gh_engine_kind engine; /* of granhom's own */
  gh_peer_kind kind;
} cross_engine;
extern const cross_engine cross_engines[GH_CROSS_ENGINES];

/* The path with each increment in `substeps`; from F = I to the first row likewise, unless that is I. */
typedef struct cross_path {
  int rows;    /* of the subdivided path */
  double *F;   /* rows x 4 */
  int *of_row; /* rows of the path as given: row of the subdivided path */
} cross_path;

/* What one program made of one path. */
typedef struct cross_trace {
  int engine;        /* among cross_engines */
  gh_peer_row *rows; /* of the subdivided path; those past `result.rows` are not set */
  gh_peer_result result;
} cross_trace;

/* One subdivision of the path by all programs; the others are compared with the first of the traces. */
typedef struct cross_level {
  int substeps;
  cross_path path;
  cross_trace trace[GH_CROSS_ENGINES];
} cross_level;

struct gh_crosscheck {
  gh_context *ctx;
  gh_crosscheck_options o;
  cross_level level[GH_CROSS_LEVELS];
};

/* A row of the path as given; NULL when the program has not come so far. */
const gh_peer_row *cross_row(const cross_level *level, int e, int row);
/* Largest component of the Cauchy stress of a trace on the path. */
double cross_scale(const gh_crosscheck *c, const cross_level *level, int e);
/* Largest difference of a component in one row of the path as given to the first program of the level. NAN
 * when one of them has not come so far. */
double cross_difference(const cross_level *level, int e, int row);
/* The largest difference of program e of `level` to r of `other` over the path, over the scale of r; the row
 * it is found in. NAN when one of them has not finished. */
double cross_worst(const gh_crosscheck *c, const cross_level *level, int e, const cross_level *other, int r,
                   int *row);
/* Of program e on level k: its difference to the reference with the same substeps or, with `change`, to
 * itself with half as many. NAN where there is none. */
double cross_refined(const gh_crosscheck *c, int k, int e, bool change);
/* Differences below are what the residual may leave: they have no order. */
double cross_round_off(const gh_crosscheck *c);

static inline const char *cross_word(const gh_crosscheck *c, int e) {
  return cross_engines[c->o.engine[e]].word;
}
static inline const char *cross_title(const gh_crosscheck *c, int e) {
  return cross_engines[c->o.engine[e]].title;
}

/* The components that are compared, of s11 s12 s21 s22. */
enum { CROSS_COMPONENTS = 3 };
extern const int cross_component[CROSS_COMPONENTS];
extern const char *const cross_component_name[CROSS_COMPONENTS];

/* crosscheck.csv, refine.csv (more than one level) in the folder. */
gh_status cross_files_write(const gh_crosscheck *c, const char *folder);

#endif
