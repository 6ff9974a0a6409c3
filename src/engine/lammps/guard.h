/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS's library interface with its errors caught, within the module.
 *
 * Every function returns GH_ENGINE with LAMMPS's own message where LAMMPS would have ended the process. What
 * others than the engine need has the name gh_lmp_* outside, and is described in granhom/lammps.h. */
#ifndef GRANHOM_LAMMPS_GUARD_H
#define GRANHOM_LAMMPS_GUARD_H

#include "engine/relax/relax_friction.h"
#include "granhom/engine.h"
#include "granhom/lammps.h"

/* End of the message of a contact force without direction. */
#define GRANHOM_COINCIDE " coincide or are not finite: their contact has no direction"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- gh_lmp_* of granhom/lammps.h ---- */

gh_status guard_open(gh_context *ctx, void **lmp);
int guard_version(gh_context *ctx, void *lmp);
void guard_close(void **lmp);
gh_status guard_command(gh_context *ctx, void *lmp, const char *format, ...) GH_PRINTF(3, 4);
gh_status guard_create_atoms(gh_context *ctx, void *lmp, int n, const int *id, const int *type,
                             const double *x);
gh_status guard_setting(gh_context *ctx, void *lmp, const char *name, int *value);
gh_status guard_atom(gh_context *ctx, void *lmp, const char *name, void *p);
gh_status guard_local(gh_context *ctx, void *lmp, const char *id, int *count, double ***rows);
gh_status guard_fix_vector(gh_context *ctx, void *lmp, const char *id, int component, double *value);
gh_status guard_program(gh_context *ctx, int argc, char **argv, bool programs, int *exit_status, bool *alone);

/* ---- driving a fix granhom/relax with `inner yes` ---- */

/* Takes it over, before the first run: from now on nothing moves in a step unless guard_relax states so, and
 * the cell may change between steps. A cluster's box (periodic false) follows its grains. Gives the bit of
 * the fix's group in "mask". */
gh_status guard_drive(gh_context *ctx, void *lmp, const char *id, bool periodic, int *group_bit);
/* The box becomes [0, t0] x [0, t3] with tilt t1 (t2 is 0); the neighbour list is rebuilt in the next
 * step. */
gh_status guard_set_cell(gh_context *ctx, void *lmp, const char *id, const double t[4]);
/* The neighbour list is rebuilt in the next step. */
gh_status guard_rebuild(gh_context *ctx, void *lmp, const char *id);
/* One time step, after the first run: forces and, where they are due, lists. Like a `run 1 pre no post no`,
 * without text and without memory. */
gh_status guard_advance(gh_context *ctx, void *lmp, const char *id);
typedef struct guard_relaxed {
  double residual, mean_force;
  long steps, pairs; /* pairs: evaluated, summed over the steps */
  bool converged;    /* or unjammed */
  double least_damping;
} guard_relaxed;
/* Relaxes until the residual is met, or the steps or all contacts are gone (gh_relax_options). frame: arrays by
 * id - 1, in LAMMPS's frame; NULL: none. */
gh_status guard_relax(gh_context *ctx, void *lmp, const char *id, const gh_relax_options *options,
                      const gh_relax_frame *frame, guard_relaxed *result);
typedef struct guard_ramped {
  gh_relax_end end;
  long pairs;           /* evaluated, summed over the steps */
  const gh_slip *slips; /* committed, with images as in guard_history, by (i, j); until the next call */
  int nslips;
} guard_ramped;
/* Leads the packing along a ramp with friction from LAMMPS's positions and rotations, to the end of the ramp
 * or of LAMMPS's list. `s` has the ramp in LAMMPS's frame and all arrays of grains, by id - 1; x and theta are
 * filled here, and so are pairs, memory, x0, slack and work. LAMMPS itself stays as it is. Steps are added to
 * those of *r. */
gh_status guard_ramp(gh_context *ctx, void *lmp, const char *id, const gh_ramp *ramp, gh_relax_friction *s,
                     gh_relax_result *r, guard_ramped *list);
/* ---- driving pair style granhom/coulomb, from the first run on; arrays by id - 1 ---- */

/* State n: lattice H (columns), unwrapped positions (n x 2), rotations, and the history of the contacts with
 * images between those positions. */
gh_status guard_history(gh_context *ctx, void *lmp, const double H[4], const double *x, const double *theta_n,
                        const gh_slip *slips, int nslips);
gh_status guard_set_rotations(gh_context *ctx, void *lmp, const double *theta);
gh_status guard_get_rotations(gh_context *ctx, void *lmp, double *theta);

/* Number of neighbour lists made so far. */
gh_status guard_builds(gh_context *ctx, void *lmp, const char *id, long *builds);
/* Pairs on the neighbour list within reach and skin, each once. After the first run. */
gh_status guard_pairs(gh_context *ctx, void *lmp, const char *id, long *pairs);

#ifdef __cplusplus
}
#endif
#endif
