/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: engines evaluate contacts and relax grains; the seam between the RVE and the discrete element
 * method.
 *
 * An engine is a workspace for one packing: radii, law and which grains are fixed are given once. With
 * friction, the converged state n is given at the start of an increment. Cell, positions and rotations are
 * set for each evaluation, and what comes back depends on nothing else (so an engine has no memory and can be
 * shared). Positions are those of the primary grains as the RVE keeps them: not wrapped into the cell, in the
 * frame of space; rotations are angles, counter-clockwise. Without friction there are no rotations: where a
 * function takes `theta`, it is not looked at then and may be NULL. */
#ifndef GRANHOM_ENGINE_H
#define GRANHOM_ENGINE_H

#include "granhom/base.h"
#include "granhom/contact.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gh_engine gh_engine;

typedef enum gh_engine_kind { GH_ENGINE_LAMMPS, GH_ENGINE_NATIVE } gh_engine_kind;

typedef struct gh_engine_setup {
  int n;                     /* number of grains, >= 1 */
  const double *radius;      /* n, > 0 */
  const int *type;           /* n, sieve fractions 1, 2, ...; NULL: all 1 */
  const unsigned char *held; /* n, nonzero: position is prescribed, never moved by relax; NULL: all are free.
                                Fixed grains still rotate, unless the law fixes the rotations of all */
  bool periodic;             /* true: a periodic cell; false: a cluster in free space, no images */
  gh_contact_law law;
  /* What relaxation heeds besides; NULL: nothing of it. Contact lists do not depend on it. */
  const unsigned char
      *fixed; /* n, components that are prescribed, gh_fixed; x or y alone in a cluster only */
  const unsigned char *edges; /* n, a bit for each edge of a frame that the grain is on: a contact counts half
                                 for each edge that its two grains share */
  const double *area;         /* n x 2, zero for grains without: sum x (x) area stays as it is */
} gh_engine_setup;

typedef enum gh_fixed { GH_FIXED_X = 1, GH_FIXED_Y = 2, GH_FIXED_TURN = 4 } gh_fixed;

/* The converged state n that an increment with friction starts from. slips: the history of the contacts,
 * sorted by (i, j, image[1], image[0]); a contact that is not among them starts from zero. */
typedef struct gh_converged {
  double cell[4];          /* not looked at for a cluster */
  const double *x, *theta; /* n x 2, n */
  const gh_slip *slips;
  int nslips;
} gh_converged;

/* Contacts at the present positions, ordered by (i, j) and, with friction, by (i, j, image[1], image[0]).
 * i <= j; i == j for a grain that touches its own image. The arrays belong to the engine and are valid until
 * its next call. */
typedef struct gh_contact_list {
  int count;
  const gh_contact *contacts;  /* count */
  const gh_friction *friction; /* count; NULL without friction */
  const double *force;         /* n x 2: total force on each grain */
  const double *moment;        /* n: total moment; NULL without friction */
} gh_contact_list;

/* How a packing is brought to equilibrium. Damped: central differences with the damping of (4.47). FIRE:
 * Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006). */
typedef enum gh_relaxation {
  GH_RELAX_POLISHED, /* damped, and Newton's steps of the RVE where they are safe; an engine takes none */
  GH_RELAX_DAMPED,   /* damped alone */
  GH_RELAX_FIRE      /* FIRE alone */
} gh_relaxation;
/* "polished", "damped", "fire"; false when the word is none of them. */
GH_API bool gh_relaxation_from_name(const char *name, gh_relaxation *relaxation);
GH_API const char *gh_relaxation_name(gh_relaxation relaxation);

/* Dynamic relaxation (4.39)-(4.47), or FIRE. The residual is the largest force on a free grain, and the
 * largest moment over the radius, over the mean normal contact force (method 3). */
typedef struct gh_relax_options {
  double tolerance; /* of the residual */
  long max_steps;
  double floor; /* mean normal force at or below which the packing counts as unjammed (absolute) */
  gh_relaxation method;
  double least_damping; /* over 1/dt, to begin with: what a relaxation that is continued had in the end; 0:
                           again. With friction and without FIRE, else nothing */
  long patience; /* steps without half the residual after which it ends unconverged; 0: damping is raised
                    instead. With friction and without FIRE, else nothing */
} gh_relax_options;

typedef struct gh_relax_result {
  double residual;      /* reached; 0 when unjammed */
  double mean_force;    /* mean normal contact force */
  long steps;           /* force evaluations spent */
  bool converged;       /* residual <= tolerance, or unjammed */
  double least_damping; /* at the end */
} gh_relax_result;

/* A ramp: the packing follows a gradient affinely, a part of it in each relaxation step, and relaxes on at the
 * end. Slip is committed at every step, as in a direct simulation. */
typedef struct gh_ramp {
  double to[4]; /* gradient at the end, row-major, det > 0: of the cell, the fixed grains, all positions */
  long steps;   /* in which it is reached; 0: it is 1, and the packing relaxes, committing */
  double tolerance; /* of the residual at the end */
  long max_steps;   /* > steps */
  double floor;     /* as in gh_relax_options */
  double round_off; /* unbalanced force that round-off may leave: at or below it the packing is at rest */
} gh_ramp;

typedef struct gh_ramp_result {
  gh_relax_result relaxed;
  long done;            /* steps of the ramp that were made: all, but where max_steps ended it before */
  double dissipated;    /* by friction on the way */
  const gh_slip *slips; /* what was committed, as in gh_converged; the engine's, until its next call */
  int nslips;
} gh_ramp_result;

/* What an engine has counted since it was made; seconds of its parts.
 *
 * `pairs` is the work in a unit that does not depend on the machine: pairs of grains whose contact was
 * evaluated, summed over all steps of relaxation and all contact lists. A pair on the list of candidates
 * counts in each of these, touching or not, and once: LAMMPS lists pairs across the cell's boundary twice.
 * The forces that LAMMPS makes besides, when positions are set, do not count, nor do bounds of the time step.
 */
typedef struct gh_engine_cost {
  long steps, evaluations, rebuilds, pairs;
  double relax_seconds, contact_seconds, set_seconds;
  double history_seconds; /* of set_seconds: taking the converged state in and finding it for the pairs */
} gh_engine_cost;

/* GH_INPUT when a parameter is out of its range (granhom/contact.h), or E_n outside 1e-100 to 1e100. */
GH_API gh_status gh_contact_law_check(gh_context *ctx, const gh_contact_law *law);
/* Makes an engine; the setup's arrays are copied. Errors: GH_INPUT (setup out of range), GH_ENGINE (LAMMPS's
 * own message). */
GH_API gh_status gh_engine_create(gh_context *ctx, gh_engine_kind kind, const gh_engine_setup *setup,
                                  gh_engine **engine);
GH_API void gh_engine_destroy(gh_engine **engine);
GH_API const char *gh_engine_name(const gh_engine *engine);
/* Version of the LAMMPS library that this program runs with, as a date: 20210929. Opens a silent instance to
 * ask it (milliseconds; MPI is initialised if nobody did). 0: LAMMPS cannot be used; engines then say why. */
GH_API int gh_engine_lammps_version(void);
/* Version of LAMMPS that granhom-lammps.so was built with, as a date, without loading it. 0: the file is not
 * there. */
GH_API int gh_engine_lammps_built(void);

/* With friction, before the first gh_engine_set of an increment: the converged state that the increment
 * starts from. Copied. Positions and history of it stay until the next gh_engine_begin. Without friction it
 * is not needed, and does nothing. GH_INPUT: a value that is not finite, slips out of order or of grains that
 * do not exist. */
GH_API gh_status gh_engine_begin(gh_engine *engine, const gh_converged *state);
/* Sets cell (columns are the lattice vectors, det > 0; ignored by a cluster, may be NULL there), positions
 * (n x 2) and rotations (n). Forgets everything but the state of gh_engine_begin. GH_INPUT: a value that is
 * not finite, det(cell) <= 0, or a cell that is compressed, thinned or sheared beyond what a packing can be.
 */
GH_API gh_status gh_engine_set(gh_engine *engine, const double cell[4], const double *x, const double *theta);
/* Changes the positions and rotations only, by little: cheaper than gh_engine_set. Same cell. */
GH_API gh_status gh_engine_move(gh_engine *engine, const double *x, const double *theta);
/* External forces (n x 2) and moments (n; without friction nothing), which relaxation balances with those of the
 * contacts, from now on; copied. NULL: none. GH_INPUT: a value that is not finite. */
GH_API gh_status gh_engine_load(gh_engine *engine, const double *force, const double *moment);
/* Moves the free grains, and rotates all grains that may rotate, towards equilibrium. Not converging within
 * max_steps is no error: look at the result. */
GH_API gh_status gh_engine_relax(gh_engine *engine, const gh_relax_options *options, gh_relax_result *result);
/* With friction, after gh_engine_begin and gh_engine_set at the state that the ramp starts from. The state it
 * ends in becomes state n; cell and positions are those of that state, as after gh_engine_begin and
 * gh_engine_set with it. Not converging is no error. GH_INPUT: as gh_engine_set, for the cell on the way. */
GH_API gh_status gh_engine_ramp(gh_engine *engine, const gh_ramp *ramp, gh_ramp_result *result);
GH_API gh_status gh_engine_contacts(gh_engine *engine, gh_contact_list *list);
/* Present positions, n x 2, and rotations, n. */
GH_API gh_status gh_engine_get(gh_engine *engine, double *x, double *theta);
GH_API void gh_engine_costs(const gh_engine *engine, gh_engine_cost *cost);

#ifdef __cplusplus
}
#endif
#endif
