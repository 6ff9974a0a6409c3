/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: other programs for the discrete element method on the same packing and path, to check against;
 * their stresses compared.
 *
 * A peer takes a periodic packing along a path of deformation gradients with its own contact law and its own
 * time integration: LAMMPS's pair style gran/hooke/history, in this process, and LIGGGHTS's `gran model
 * hooke/stiffness tangential history`, as a child process. Both integrate the tangential displacement of a
 * contact over the time steps of a damped motion, where granhom takes it from one converged state to the next
 * (docs/reports/crosscheck.md). */
#ifndef GRANHOM_CROSSCHECK_H
#define GRANHOM_CROSSCHECK_H

#include "granhom/base.h"
#include "granhom/contact.h"
#include "granhom/io.h"
#include "granhom/micro.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gh_peer_kind { GH_PEER_LAMMPS, GH_PEER_LIGGGHTS } gh_peer_kind;

typedef struct gh_peer_problem {
  int n;
  const double *radius; /* n, > 0 */
  const double *x;      /* n x 2, positions before the path, from the cell's corner */
  double cell[4];       /* before the path; columns are the lattice vectors */
  gh_contact_law law;   /* the slip measure is the peers' own */
  int rows;
  const double *F;  /* rows x 4; the cell of row k is F_k cell. The packing is relaxed in each */
  double tolerance; /* largest force on a grain, and moment over radius, over the mean normal contact force */
  long max_steps;   /* time steps of relaxation before a row has failed */
  int steps_per_row;   /* time steps over which the motion from row to row is spread, >= 1 */
  double seconds;      /* time limit for the path, > 0 */
  const char *program; /* of LIGGGHTS, looked for in PATH unless it holds a slash; NULL: "liggghts" */
} gh_peer_problem;

/* A relaxed row of the path. */
typedef struct gh_peer_row {
  double cauchy[4]; /* (1/V) sum f (x) l over the contacts, force per length, in the frame of F */
  int contacts;
  double mean_force; /* mean normal contact force */
  double residual;
  long steps; /* time steps of this row */
} gh_peer_row;

typedef enum gh_peer_end {
  GH_PEER_DONE,
  GH_PEER_MISSING, /* the program is not installed */
  GH_PEER_UNABLE,  /* it cannot follow the path */
  GH_PEER_FAILED,  /* its own error, or no equilibrium */
  GH_PEER_STOPPED  /* by the time limit */
} gh_peer_end;
GH_API const char *gh_peer_end_text(gh_peer_end end); /* "done", "missing", ... */

typedef struct gh_peer_result {
  gh_peer_end end;
  int rows;          /* complete ones, from the start of the path */
  char message[400]; /* why it ended early; "" when done */
  double seconds;    /* of the clock, start of the program included */
} gh_peer_result;

/* GH_INPUT when a peer cannot take the problem: values out of range, hardening, which the peers' laws do not
 * have, det F <= 0, a cell that is sheared by more than half its width or narrower than four of the largest
 * radii. */
GH_API gh_status gh_peer_check(gh_context *ctx, const gh_peer_problem *problem);
/* Runs the path. What becomes of the peer is stated in the result; an error is returned only for what
 * gh_peer_check refuses, and GH_SYSTEM, GH_MEMORY: no folder for temporary files, no memory. row:
 * problem->rows of them; those past result->rows are not set. */
GH_API gh_status gh_peer_run(gh_context *ctx, gh_peer_kind kind, const gh_peer_problem *problem,
                             gh_peer_row *row, gh_peer_result *result);

/* ---- a path through granhom and its peers, compared ---- */

enum { GH_CROSS_ENGINES = 4, GH_CROSS_LEVELS = 8 };
/* Word of a program in files and on the command line ("lammps", "native", "gran", "liggghts"), in this
 * order: number 0 to GH_CROSS_ENGINES - 1. */
GH_API const char *gh_cross_word(int engine);

/* Pointers are kept: what they point to must outlive the gh_crosscheck. */
typedef struct gh_crosscheck_options {
  const gh_packing *packing;
  int rows;
  const double *F;                       /* rows x 4, det > 0 */
  const long *step;                      /* rows: the numbers of the increments in tables and files */
  gh_rve_options rve;                    /* periodic; tolerance and max_steps are those of the peers too */
  const char *liggghts;                  /* its program, as gh_peer_problem has it */
  int steps_per_row;                     /* of the peers, >= 1 */
  double seconds;                        /* time limit of a peer on each path, > 0 */
  int engines, engine[GH_CROSS_ENGINES]; /* numbers of programs; all others are compared with the first */
  int levels; /* 1 to GH_CROSS_LEVELS: the path in each with 1, 2, 4, ... substeps per increment */
} gh_crosscheck_options;

typedef struct gh_crosscheck gh_crosscheck;

/* GH_INPUT: a peer cannot take packing, path or law (gh_peer_check). */
GH_API gh_status gh_crosscheck_create(gh_context *ctx, const gh_crosscheck_options *options,
                                      gh_crosscheck **c);
GH_API void gh_crosscheck_destroy(gh_crosscheck **c);
/* Runs each program along each path and writes crosscheck.csv and, with more than one level, refine.csv into
 * the folder, after each run. A program that fails, is missing or is stopped is stated in the tables.
 * GH_INPUT, GH_MEMORY, GH_SYSTEM: wrong input, or the system refuses. */
GH_API gh_status gh_crosscheck_run(gh_crosscheck *c, const char *folder);
/* The tables for a reader, after gh_crosscheck_run. */
GH_API void gh_crosscheck_print(const gh_crosscheck *c, gh_text *out);
/* crosscheck.png in the folder, unless there is nothing to compare. Needs gnuplot. */
GH_API gh_status gh_crosscheck_draw(const gh_crosscheck *c, const char *folder);
/* GH_DIVERGED: a program failed or was stopped; names the first. */
GH_API gh_status gh_crosscheck_verdict(const gh_crosscheck *c);

#ifdef __cplusplus
}
#endif
#endif
