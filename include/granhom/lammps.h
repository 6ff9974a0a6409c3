/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: LAMMPS's library interface with its errors caught.
 *
 * Every function returns GH_ENGINE with LAMMPS's own message where LAMMPS would have ended the process, and
 * checks names and pointers that LAMMPS does not check. After an error the instance can be closed, and used
 * again from a `run` with setup on. The first call loads granhom-lammps.so, and LAMMPS with it: GH_ENGINE
 * with the places that were tried when it is not there. */
#ifndef GRANHOM_LAMMPS_H
#define GRANHOM_LAMMPS_H

#include "granhom/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A silent instance on this process alone (MPI_COMM_SELF; MPI is initialised if nobody did), with granhom's
 * styles. GH_ENGINE: version below 29 Sep 2021, or a LAMMPS whose functions cannot be replaced. */
GH_API gh_status gh_lmp_open(gh_context *ctx, void **lmp);
/* Of an open instance, as a date: 20210929. */
GH_API int gh_lmp_version(gh_context *ctx, void *lmp);
/* Closes; takes NULL. Errors of LAMMPS are dropped. */
GH_API void gh_lmp_close(void **lmp);
/* One input command. */
GH_API gh_status gh_lmp_command(gh_context *ctx, void *lmp, const char *format, ...) GH_PRINTF(3, 4);
/* n atoms with ids 1..n of these types at x (n x 3); GH_ENGINE when LAMMPS takes not all of them. */
GH_API gh_status gh_lmp_create_atoms(gh_context *ctx, void *lmp, int n, const int *id, const int *type,
                                     const double *x);
/* Integer setting ("nlocal"). */
GH_API gh_status gh_lmp_setting(gh_context *ctx, void *lmp, const char *name, int *value);
/* Array of a per-atom property ("x", "id", "image", ...); valid until the next run. p is a pointer to the
 * array's pointer. */
GH_API gh_status gh_lmp_atom(gh_context *ctx, void *lmp, const char *name, void *p);
/* Local array of a compute: rows x columns; *rows may be NULL when there is none. */
GH_API gh_status gh_lmp_local(gh_context *ctx, void *lmp, const char *id, int *count, double ***rows);
/* Component of a fix's global vector. */
GH_API gh_status gh_lmp_fix_vector(gh_context *ctx, void *lmp, const char *id, int component, double *value);

/* ---- a LAMMPS program of its own ---- */

/* What LAMMPS's own main does with these arguments (argv[0] is the program) on MPI_COMM_WORLD (MPI is
 * initialised if nobody did). programs: the script may run other programs (the command shell and the like,
 * which are errors otherwise). *exit_status: that of a `quit` command, else 0. GH_ENGINE: an error; on all
 * ranks unless *alone is set: then the other ranks do not know, and the caller must end them (MPI_Abort). */
GH_API gh_status gh_lmp_program(gh_context *ctx, int argc, char **argv, bool programs, int *exit_status,
                                bool *alone);

#ifdef __cplusplus
}
#endif
#endif
