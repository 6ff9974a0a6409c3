/* LAMMPS's library interface with its errors caught. SPDX-License-Identifier: GPL-2.0-or-later
 *
 * Every function returns GH_ENGINE with LAMMPS's own message where LAMMPS would have ended the process, and
 * checks names and pointers that LAMMPS does not check. After an error the instance can be closed, and used
 * again from a `run` with setup on. The executable must be linked with -rdynamic: guard.cpp replaces
 * functions of the packaged liblammps.so, which has no exceptions of its own. */
#ifndef GRANHOM_LAMMPS_GUARD_H
#define GRANHOM_LAMMPS_GUARD_H

#include "granhom/base.h"
#include "granhom/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A silent instance on this process alone (MPI_COMM_SELF; MPI is initialised if nobody did), with granhom's
 * styles. GH_ENGINE: version below 29 Sep 2021, or the executable's symbols are not visible. */
gh_status gh_lmp_open(gh_context *ctx, void **lmp);
/* Of an open instance, as a date: 20210929. */
int gh_lmp_version(gh_context *ctx, void *lmp);
/* Closes; takes NULL. Errors of LAMMPS are dropped. */
void gh_lmp_close(void **lmp);
/* One input command. */
gh_status gh_lmp_command(gh_context *ctx, void *lmp, const char *format, ...) GH_PRINTF(3, 4);
/* n atoms with ids 1..n of these types at x (n x 3); GH_ENGINE when LAMMPS takes not all of them. */
gh_status gh_lmp_create_atoms(gh_context *ctx, void *lmp, int n, const int *id, const int *type,
                              const double *x);
/* Integer setting ("nlocal"). */
gh_status gh_lmp_setting(gh_context *ctx, void *lmp, const char *name, int *value);
/* Array of a per-atom property ("x", "id", "image", ...); valid until the next run. p is a pointer to the
 * array's pointer. */
gh_status gh_lmp_atom(gh_context *ctx, void *lmp, const char *name, void *p);
/* Local array of a compute: rows x columns; *rows may be NULL when there is none. */
gh_status gh_lmp_local(gh_context *ctx, void *lmp, const char *id, int *count, double ***rows);
/* Component of a fix's global vector. */
gh_status gh_lmp_fix_vector(gh_context *ctx, void *lmp, const char *id, int component, double *value);

/* ---- driving a fix granhom/relax with `inner yes` ---- */

/* Takes it over, before the first run: from now on nothing moves in a step unless gh_lmp_relax says so, and
 * the cell may change between steps. A cluster's box (periodic false) follows its grains. Gives the bit of
 * the fix's group in "mask". */
gh_status gh_lmp_drive(gh_context *ctx, void *lmp, const char *id, bool periodic, int *group_bit);
/* The box becomes [0, t0] x [0, t3] with tilt t1 (t2 is 0); the neighbour list is made anew in the next
 * step. */
gh_status gh_lmp_set_cell(gh_context *ctx, void *lmp, const char *id, const double t[4]);
/* The neighbour list is made anew in the next step. */
gh_status gh_lmp_rebuild(gh_context *ctx, void *lmp, const char *id);
/* One time step, after the first run: forces and, where they are due, lists. Like a `run 1 pre no post no`,
 * without text and without memory. */
gh_status gh_lmp_advance(gh_context *ctx, void *lmp, const char *id);
typedef struct gh_lmp_relaxed {
  double residual, mean_force;
  long steps, pairs; /* pairs: evaluated, summed over the steps */
  bool converged;    /* or unjammed */
  double least_damping;
} gh_lmp_relaxed;
/* Relaxes until the residual is met, or the steps or all contacts are gone (gh_relax_options). */
gh_status gh_lmp_relax(gh_context *ctx, void *lmp, const char *id, const gh_relax_options *options,
                       gh_lmp_relaxed *result);
/* ---- driving pair style granhom/coulomb, from the first run on; arrays by id - 1 ---- */

/* State n: lattice H (columns), unwrapped positions (n x 2), rotations, and the history of the contacts with
 * images between those positions. */
gh_status gh_lmp_history(gh_context *ctx, void *lmp, const double H[4], const double *x,
                         const double *theta_n, const gh_slip *slips, int nslips);
gh_status gh_lmp_set_rotations(gh_context *ctx, void *lmp, const double *theta);
gh_status gh_lmp_get_rotations(gh_context *ctx, void *lmp, double *theta);

/* Number of neighbour lists made so far. */
gh_status gh_lmp_builds(gh_context *ctx, void *lmp, const char *id, long *builds);
/* Pairs on the neighbour list within reach and skin, each once. After the first run. */
gh_status gh_lmp_pairs(gh_context *ctx, void *lmp, const char *id, long *pairs);

/* ---- a LAMMPS program of its own ---- */

/* What LAMMPS's own main does with these arguments (argv[0] is the program) on MPI_COMM_WORLD (MPI is
 * initialised if nobody did). programs: the script may run other programs (the command shell and the like,
 * which are errors otherwise). *exit_status: that of a `quit` command, else 0. GH_ENGINE: an error; on all
 * ranks unless *alone is set: then the other ranks do not know, and the caller must end them (MPI_Abort). */
gh_status gh_lmp_program(gh_context *ctx, int argc, char **argv, bool programs, int *exit_status,
                         bool *alone);

#ifdef __cplusplus
}
#endif
#endif
