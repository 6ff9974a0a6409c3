/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the files of the finish share. */
#ifndef GRANHOM_PREPARE_FINISH_H
#define GRANHOM_PREPARE_FINISH_H

#include "granhom/finish.h"

/* A packing on its way: the RVE's converged state, and what is known of it. F is upper triangular throughout,
 * so that the first lattice vector stays along x. */
typedef struct finish_job {
  gh_context *ctx;
  const gh_finish_options *options;
  gh_rve *rve;
  double mean_radius;
  double F[4];                /* of the converged state */
  gh_finish_report now;       /* of the converged state */
  double energy, P[4], A[16]; /* of the converged state; A only after finish_try with tangent */
  /* trial state of the last finish_try */
  double trial_F[4], trial_energy, trial_P[4], trial_A[16];
  gh_finish_report trial;
  int evaluations;
  double strain; /* spent by finish_shear */
} finish_job;

/* Looks for the equilibrium at F. *found is false where the engine found none (no error: the message is
 * lost). */
gh_status finish_try(finish_job *j, const double F[4], bool tangent, bool *found);
/* The trial state becomes the converged one. */
gh_status finish_take(finish_job *j);
/* Overlap or pressure, whichever is wanted. */
double finish_value(const finish_job *j, const gh_finish_report *r);

/* Whether the cell is to relax. */
bool finish_relaxes(const gh_finish_options *options);

/* finish_scale.c: scales the cell until the goal is met. */
gh_status finish_scale(finish_job *j);
/* finish_cell.c: lets the cell relax under `pressure` until the stress is isotropic. */
gh_status finish_relax_cell(finish_job *j, double pressure);
/* finish_shear.c: pre-strains until the anisotropy is the wanted one; the goal is met again after each strain
 * increment by `settle`. */
gh_status finish_shear(finish_job *j, gh_status (*settle)(finish_job *j));
/* fabric.c: overlap, stress, coordination and fabric of the last evaluation of an RVE. */
gh_status finish_report_fill(gh_rve *rve, double mean_radius, gh_finish_report *r);

#endif
