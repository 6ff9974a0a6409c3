/* What the files of `granhom crosscheck` share: one path, several engines, several cuts of the increments.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_DRIVER_CROSSCHECK_H
#define GRANHOM_DRIVER_CROSSCHECK_H

#include "path.h"

#include "granhom/micro.h"
#include "granhom/peers.h"

enum { CROSS_ENGINES = 4, CROSS_MOST_LEVELS = 8 };

typedef struct cross_engine {
  const char *word, *title; /* on the command line and in files; in tables and plots */
  bool peer;
  gh_engine_kind engine; /* of granhom's own */
  gh_peer_kind kind;
} cross_engine;
extern const cross_engine cross_engines[CROSS_ENGINES];

/* The path with each increment cut into `parts`; from F = I to the first row likewise, unless that is I. */
typedef struct cross_path {
  int rows;    /* of the cut path */
  double *F;   /* rows x 4 */
  int *of_row; /* rows of the path as given: row of the cut path */
} cross_path;
gh_status cross_path_cut(gh_context *ctx, const path_rows *path, int parts, cross_path *cut);
void cross_path_free(cross_path *cut);

/* What one engine made of one path. */
typedef struct cross_trace {
  int engine;        /* among cross_engines */
  gh_peer_row *rows; /* of the cut path; those past `result.rows` are not set */
  gh_peer_result result;
} cross_trace;

/* One cut of the path by all engines; the first of the traces is what the others are compared with. */
typedef struct cross_level {
  int parts;
  cross_path path;
  cross_trace trace[CROSS_ENGINES];
} cross_level;

typedef struct cross_job {
  gh_context *ctx;
  const char *packing_file, *path_file, *folder;
  gh_lock *lock; /* of the folder */
  gh_packing *packing;
  path_rows path;
  gh_rve_options rve;
  const char *liggghts;
  int steps_per_row;
  double seconds;
  int engines, engine[CROSS_ENGINES]; /* among cross_engines, in the order given */
  int levels;
  cross_level level[CROSS_MOST_LEVELS];
} cross_job;

/* GH_INPUT when the other programs cannot take this packing, path or law. */
gh_status cross_check(cross_job *j);
/* Runs engine number e of the job along the level's path. What becomes of it is told in the trace; an error
 * is returned when the input is wrong or the system refuses. */
gh_status cross_run(cross_job *j, cross_level *level, int e);

/* Largest component of the Cauchy stress of a trace on the path. */
double cross_scale(const cross_job *j, const cross_level *level, int e);
/* Largest difference of a component in one row of the path as given, between engine e of `level` and engine r
 * of `other`. NAN when one of them has not come so far. */
double cross_difference(const cross_level *level, int e, const cross_level *other, int r, int row);
/* The largest of these over the path, over the scale of r; the row it is found in. NAN when one of them has
 * not finished. */
double cross_worst(const cross_job *j, const cross_level *level, int e, const cross_level *other, int r,
                   int *row);

/* Tables on standard output. */
void cross_print(const cross_job *j);
/* crosscheck.csv, refine.csv (more than one level) in the folder. */
gh_status cross_write(const cross_job *j);
/* crosscheck.png */
gh_status cross_draw(const cross_job *j);

#endif
