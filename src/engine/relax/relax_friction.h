/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dynamic relaxation with friction: positions and rotations on a list of neighbour pairs with the memory of
 * the converged state; used by the native engine and by LAMMPS's fix granhom/relax. */
#ifndef GRANHOM_ENGINE_RELAX_FRICTION_H
#define GRANHOM_ENGINE_RELAX_FRICTION_H

#include "engine/relax/relax.h"
#include "granhom/contact.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a candidate pair remembers of the converged state n: the branch vector then, touching or not (method
 * 8.11), and its history; zero for a pair without. */
typedef struct gh_pair_memory {
  double ln[2];
  double gamma, gamma_pl, alpha;
} gh_pair_memory;

/* Whether the residual comes down; zero at the start, but for `least` where a relaxation is continued, and
 * `patience`; carried from list to list like `started`. */
typedef struct gh_relax_watch {
  double record;      /* residual to come down to half of */
  long waited;        /* steps since then */
  double least;       /* least damping, over 1/dt */
  double leap, leapt; /* of creeping grains: how much farther the last went; residual before it */
  long
      patience; /* steps without half the residual after which relaxation ends; 0: damping is raised instead */
} gh_relax_watch;

/* A ramp (method 3, "Ramps"): the packing follows a gradient affinely, a part of it in each step, and slip is
 * committed at every step; so it is after the last part. Carried from list to list. */
typedef struct gh_relax_ramp {
  double to[4];      /* gradient at the end, from the positions at the start; its parts lie on a line */
  long steps, done;  /* parts; those behind */
  double round_off;  /* unbalanced force at or below which the packing is at rest */
  double dissipated; /* by friction since the start */
} gh_relax_ramp;
/* The gradient after the parts behind: 1 + done/steps (to - 1). */
void gh_relax_ramp_gradient(const gh_relax_ramp *ramp, double G[4]);

/* A packing under relaxation. All arrays belong to the caller. Of `grains`, stiffness is not looked at. With
 * friction a grain and its own image do exert a moment: such pairs (i == j) belong to the list, once. */
typedef struct gh_relax_friction {
  gh_relax_state grains; /* n, held, pairs, x, v, f, x0, slack, started, damping; work: see below */
  const gh_contact_law *law;
  const double *radius;   /* n */
  gh_pair_memory *memory; /* npairs, parallel to grains.pairs; a ramp leaves what it has committed */
  double *theta_n;        /* n: rotations of the converged state; with a ramp those of the last step */
  double *theta, *w, *m;  /* n: rotations, angular velocities of the last half step, moments. Left alone
                                   where the law fixes rotations: theta must be theta_n then */
  gh_relax_watch watch;
  gh_relax_ramp *ramp; /* NULL: F stays, slip counts from the converged state. Else sums of lattice vectors
                          follow the gradient, those in grains.pairs excepted */
} gh_relax_friction;

/* Doubles that grains.work must have. */
size_t gh_relax_friction_work(int n, int npairs);

/* As gh_relax_run, with rotations: unit masses and inertia r^2/2, which makes both kinds of motion converge
 * alike. Fixed grains rotate, unless the law fixes rotations. The residual counts |m|/r like |f|. */
gh_relax_end gh_relax_friction_run(gh_relax_friction *s, double tolerance, double floor, long max_steps,
                                   double *residual, double *mean_force, long *steps);
/* Forces and moments at x, theta. Returns the largest force on a free grain or moment over radius on a grain
 * that may rotate; *mean_force is the mean normal contact force (0: no contact). */
double gh_relax_friction_forces(gh_relax_friction *s, double *mean_force);

/* The same in two parts, for those who evaluate many times on one list (relax_fire.c): once for each list,
 * and for each x, theta. */
void gh_relax_friction_begin(gh_relax_friction *s);
double gh_relax_friction_again(gh_relax_friction *s, double *mean_force);
/* The time step of gh_relax_friction_run, after gh_relax_friction_again. */
double gh_relax_friction_safe_step(const gh_relax_friction *s);

/* For those who must step by themselves (LAMMPS on several ranks): stiffness of a contact along and across
 * its branch vector that bounds the quadratic form of its derivative. coefficient: of friction, with
 * proportional hardening. */
void gh_relax_friction_bound(const gh_contact_law *law, double coefficient, double *along, double *across);

#ifdef __cplusplus
}
#endif
#endif
