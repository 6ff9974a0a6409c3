/* granhom: engines evaluate contacts and relax grains; the seam between the RVE and the discrete element
 * method. SPDX-License-Identifier: GPL-2.0-or-later
 *
 * An engine is a workspace for one packing: radii, law and which grains are held are given once. Cell and
 * positions are set for each evaluation, and what comes back depends on nothing else (so an engine has no
 * memory and can be shared). Positions are those of the primary grains as the RVE keeps them: not wrapped
 * into the cell, in the frame of space. */
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
  int n;                /* number of grains, >= 1 */
  const double *radius; /* n, > 0 */
  const int *type;      /* n, sieve fractions 1, 2, ...; NULL: all 1 */
  const unsigned char
      *held;     /* n, nonzero: position is prescribed, never moved by relax; NULL: all are free */
  bool periodic; /* true: a periodic cell; false: a cluster in free space, no images */
  gh_contact_law law;
} gh_engine_setup;

/* Dynamic relaxation (4.39)-(4.47). The residual is the largest force on a free grain over the mean normal
 * contact force (method 3). */
typedef struct gh_relax_options {
  double tolerance; /* of the residual */
  long max_steps;
  double floor; /* mean normal force at or below which the packing counts as unjammed (absolute) */
} gh_relax_options;

typedef struct gh_relax_result {
  double residual;   /* reached; 0 when unjammed */
  double mean_force; /* mean normal contact force */
  long steps;        /* force evaluations spent */
  bool converged;    /* residual <= tolerance, or unjammed */
} gh_relax_result;

/* What an engine has counted since it was made; seconds of its parts. */
typedef struct gh_engine_cost {
  long steps, evaluations, rebuilds;
  double relax_seconds, contact_seconds, set_seconds;
} gh_engine_cost;

/* Makes an engine; the setup's arrays are copied. Errors: GH_INPUT (setup out of range), GH_ENGINE (LAMMPS's
 * own message). */
gh_status gh_engine_create(gh_context *ctx, gh_engine_kind kind, const gh_engine_setup *setup,
                           gh_engine **engine);
void gh_engine_destroy(gh_engine **engine);
const char *gh_engine_name(const gh_engine *engine);
/* Version of the LAMMPS library that this program runs with, as a date: 20210929. Opens a silent instance to
 * ask it (milliseconds; MPI is initialised if nobody did). 0: LAMMPS cannot be used; engines then say why. */
int gh_engine_lammps_version(void);

/* Sets cell (columns are the lattice vectors, det > 0; ignored by a cluster, may be NULL there) and positions
 * (n x 2). Forgets everything that happened before. GH_INPUT: a value that is not finite, det(cell) <= 0, or
 * a cell that is compressed, thinned or sheared beyond what a packing can be. */
gh_status gh_engine_set(gh_engine *engine, const double cell[4], const double *x);
/* Changes the positions only, by little: cheaper than gh_engine_set. Same cell. */
gh_status gh_engine_move(gh_engine *engine, const double *x);
/* Moves the free grains towards equilibrium. Not converging within max_steps is no error: look at the result.
 */
gh_status gh_engine_relax(gh_engine *engine, const gh_relax_options *options, gh_relax_result *result);
/* Contacts at the present positions, ordered by (i, j), and the total force on each grain (n x 2). Both
 * belong to the engine and are valid until the next call. i <= j; i == j for a grain that touches its own
 * image. */
gh_status gh_engine_contacts(gh_engine *engine, const gh_contact **contacts, int *count,
                             const double **force);
/* Present positions, n x 2. */
gh_status gh_engine_get(gh_engine *engine, double *x);
void gh_engine_costs(const gh_engine *engine, gh_engine_cost *cost);

#ifdef __cplusplus
}
#endif
#endif
