/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: results of a solver in a folder of files.
 *
 * A solver hands over a table of fields, a list of columns and the way to its packings; what is written knows
 * nothing else of it. After each increment all files are whole:
 *
 *   results.h5       /mesh and one group per increment, /step0000 (the start) onwards
 *   results.xdmf     the same for ParaView; points.xdmf: at the integration points
 *   rves.h5          grains and contacts of recorded points at the last increment; traces.h5: their positions
 *                    at all increments
 *   dumps/           the chosen points as LAMMPS dumps
 *   history.csv, convergence.csv, timing.csv, run.json
 *   checkpoint.h5    where the solver can continue */
#ifndef GRANHOM_RESULTS_H
#define GRANHOM_RESULTS_H

#include "granhom/io.h"
#include "granhom/mesh.h"
#include "granhom/micro.h"

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- names ---- */

/* Names of sets in columns of history.csv ("left" in left_x) and among the sets of results.h5. A comma, a
 * blank, a quote becomes '_', in results.h5 a slash too. Returns text. */
enum { GH_COLUMN = 128 };
GH_API const char *gh_column_name(const char *set, char text[GH_COLUMN]);
GH_API const char *gh_dataset_name(const char *set, char text[GH_COLUMN]);
/* Kind and version of an HDF5 file of a folder of results, for gh_h5_open; "unknown" for other names. */
GH_API const char *gh_results_kind(const char *file);
/* Columns and datasets of the files that are the same for each solver, and what they mean. */
GH_API const gh_term_list *gh_results_columns(void);

/* ---- what a solver hands over ---- */

typedef enum gh_place { GH_AT_NODES, GH_AT_POINTS, GH_AT_CELLS } gh_place;

/* A row of the solver's table of fields. */
typedef struct gh_field {
  const char *name;      /* dataset below /stepNNNN: "displacement", "points/F" */
  const char *attribute; /* its name in the XDMF file; NULL: in none */
  gh_place place;
  int components; /* numbers at each place: 1, a vector 3, a tensor of the plane 4, a full tensor 9 */
  int index;      /* for fill */
  /* components numbers at each node, integration point or element into value. */
  gh_status (*fill)(void *data, const struct gh_field *field, double *value);
} gh_field;

/* A column of history.csv behind step, increment, name, load_step and time. */
typedef struct gh_column {
  char name[GH_COLUMN + 16];
  bool may_be_nan; /* else a row with nan or inf in it is not written */
} gh_column;

/* Integration points by number: `count` of `point`, or one of these counts. */
/* GH_FEW_POINTS: all if there are at most GH_FEW, else a few that are chosen. */
enum { GH_ALL_POINTS = -1, GH_FEW_POINTS = -2, GH_FEW = 64 };
typedef struct gh_point_list {
  int count;
  const int *point;
} gh_point_list;

/* One complete increment. */
typedef struct gh_frame {
  int counter, step, increment;      /* counter: of all increments, 0 the start */
  const char *name;                  /* of the step */
  double time;                       /* in load steps */
  int most_loaded, least_stable;     /* points that are recorded when the scene chooses none */
  double seconds, micro_seconds;     /* of the increment, of these in packings */
  long evaluations, computed, moved; /* of integration points, in this increment */
  int ranks;
} gh_frame;

/* One residual of the iteration under way, for convergence.csv. */
typedef struct gh_residual_row {
  int counter, substep, iteration;
  double residual, relative, first, step_length, kinetic, seconds;
} gh_residual_row;

/* How it stands with the run, for run.json. */
typedef struct gh_outcome {
  const char *status;  /* "running", "done", "stopped", ... */
  const char *message; /* NULL or "": none */
  const char *started; /* UTC, ISO 8601 */
  const char *blas;    /* gh_blas */
  bool ended;          /* the summary is known */
} gh_outcome;

/* What must be the same for a checkpoint to fit: name of the dataset, words ("belongs to another mesh"),
 * value. */
typedef struct gh_mark {
  const char *name, *what;
  char value[64];
} gh_mark;
enum { GH_MARKS = 8 };

typedef struct gh_archive gh_archive;

typedef struct gh_solver_results {
  void *data; /* handed to the functions below */
  const char *title, *length_unit, *force_unit;
  const gh_mesh *mesh;
  int nsets;             /* of the mesh: those that the user knows */
  const int *packing_of; /* 4 nelements: number of the packing of each integration point */
  int nfields, ncolumns;
  const gh_field *fields;
  const gh_column *columns;
  gh_point_list recorded, dumped; /* dumped: no GH_FEW_POINTS */
  int dump_every;                 /* increments */
  /* The values of all columns. */
  gh_status (*row)(void *data, const gh_frame *frame, double *value);
  /* The one way from an integration point to its grains, valid until the next call. *m NULL: it is no RVE. */
  gh_status (*inspect)(void *data, int point, gh_rve_view *view, const gh_rve_measures **m);
  /* run.json. */
  gh_status (*record)(void *data, const gh_outcome *outcome, gh_text *out);
  /* Checkpoints: at most GH_MARKS marks, returns their number; all that the solver needs to continue; the
   * same into memory, checked; what was loaded is put to use. */
  int (*marks)(void *data, gh_mark *list);
  gh_status (*save)(void *data, gh_archive *a);
  gh_status (*load)(void *data, gh_archive *a);
  gh_status (*resume)(void *data);
} gh_solver_results;

/* ---- the folder ---- */

typedef struct gh_results gh_results;
/* The names of the files of a folder of results, of which the last is NULL. */
GH_API const char *const *gh_results_files(void);
/* GH_INPUT, GH_SYSTEM: the folder cannot be written to, one of its files is there and no regular file, or is one
 * of the inputs. Touches nothing. */
GH_API gh_status gh_results_folder_check(gh_context *ctx, const char *folder, const char *const *input,
                                         int inputs);
/* The tables of `solver` must outlive the results. Nothing is written before the first increment. */
GH_API gh_status gh_results_create(gh_context *ctx, const gh_solver_results *solver, const char *folder,
                                   gh_results **results);
GH_API void gh_results_destroy(gh_results **results);
GH_API void gh_results_residual(gh_results *r, const gh_residual_row *row);
/* Writes all files but checkpoint.h5. GH_DIVERGED: a number of the row is not finite. */
GH_API gh_status gh_results_write(gh_results *r, const gh_frame *frame);
/* Ends the record in run.json. wrong_input: nothing is written when nothing was before. */
GH_API gh_status gh_results_close(gh_results *r, const char *status, const char *message, bool wrong_input);

/* ---- checkpoints ---- */

/* Puts everything into a new file in memory, *file, which gh_h5_commit brings to disk. */
GH_API gh_status gh_checkpoint_make(const gh_results *r, gh_h5 **file);
/* *there: the folder holds a checkpoint. */
GH_API gh_status gh_checkpoint_find(const gh_results *r, bool *there);
/* Loads and resumes the solver, and cuts the results to the increments that the checkpoint knows; GH_INPUT
 * when it is damaged or belongs to something else. */
GH_API gh_status gh_checkpoint_read(gh_results *r);

/* Datasets of a checkpoint. Sizes are those of the file when it is read; the caller frees. GH_INPUT: it is not there, of another shape or larger than the file. */
GH_API gh_status gh_archive_put_doubles(gh_archive *a, const char *name, size_t n, const double *data);
GH_API gh_status gh_archive_put_ints(gh_archive *a, const char *name, size_t n, const int *data);
GH_API gh_status gh_archive_put_bytes(gh_archive *a, const char *name, size_t size, const void *data);
GH_API gh_status gh_archive_get_doubles(gh_archive *a, const char *name, size_t *n, double **data);
GH_API gh_status gh_archive_get_ints(gh_archive *a, const char *name, size_t *n, int **data);
GH_API gh_status gh_archive_get_bytes(gh_archive *a, const char *name, size_t *size,
                                      char **data); /* and a 0 */

/* ---- dumps ---- */

/* A frame of a LAMMPS dump: the grains of one material point, id type x y z ix iy iz radius grain rattler
 * fixed replica and with friction theta. Periodic: in the box of the cell, rotated so that its first lattice
 * vector lies along x, with image flags; else in a bounding box as it is. */
GH_API void gh_dump_grains(gh_text *out, long step, const gh_rve_view *view);

#ifdef __cplusplus
}
#endif
#endif
