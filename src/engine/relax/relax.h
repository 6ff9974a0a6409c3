/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dynamic relaxation on a list of neighbour pairs; used by the native engine and by LAMMPS's fix
 * granhom/relax. */
#ifndef GRANHOM_ENGINE_RELAX_H
#define GRANHOM_ENGINE_RELAX_H

#include "engine/relax/relax_frame.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A candidate pair: grains i and j, j seen at x_j + shift (a sum of lattice vectors). A grain and its own
 * image exert no net force: such pairs do not belong here. */
typedef struct gh_pair {
  int i, j;
  double shift[2];
  double reach; /* r_i + r_j */
} gh_pair;

/* What FIRE carries from list to list; it is set when a relaxation begins. */
typedef struct gh_fire {
  double step;  /* time step, over gh_relax_safe_step */
  double mix;   /* share of the velocities that is turned towards the forces */
  int downhill; /* steps since the power was last negative */
} gh_fire;

/* A packing under relaxation. All arrays belong to the caller. */
typedef struct gh_relax_state {
  int n;                     /* grains */
  const unsigned char *held; /* n; NULL: none */
  int npairs;
  const gh_pair *pairs; /* sorted by (i, j, shift): the order of summation */
  double stiffness;
  double *x, *v, *f; /* n x 2: positions, velocities of the last half step, forces */
  const double *x0;  /* n x 2: positions at which the pairs were found */
  double slack;      /* leave when a grain is farther than this from x0 (half the skin) */
  int started; /* 0: v is not yet set (4.41); a new relaxation begins with 0, a new pair list continues with 1
                */
  double damping; /* of the last step; 0 at the start; carried from list to list like `started` */
  gh_fire fire;   /* gh_relax_fire alone */
  const gh_relax_frame *frame; /* NULL: none */
  double *work;                /* gh_relax_work(n, npairs) doubles, any content */
} gh_relax_state;

/* Doubles of work space. */
size_t gh_relax_work(int n, int npairs);

typedef enum gh_relax_end {
  GH_RELAX_CONVERGED,
  GH_RELAX_REBUILD,
  GH_RELAX_STEPS,
  GH_RELAX_UNJAMMED
} gh_relax_end;
static inline int gh_relax_at_rest(gh_relax_end end) {
  return end == GH_RELAX_CONVERGED || end == GH_RELAX_UNJAMMED;
}

/* Runs central differences (4.39), (4.40) with unit masses until the residual is at most `tolerance`, the
 * list must be rebuilt, `max_steps` force evaluations are spent, or the mean normal force is at most
 * `floor`. Time step from a bound of the largest eigenvalue, damping from the running Rayleigh quotient
 * (4.47). On return f belongs to x. Writes residual and mean force, adds the force evaluations to *steps. */
gh_relax_end gh_relax_run(gh_relax_state *s, double tolerance, double floor, long max_steps, double *residual,
                          double *mean_force, long *steps);
/* One step of the grains that are free: v <- a v + b f, x <- x + dt v. Returns the square of the largest
 * distance from x0. No grain goes as far as the slack at once: overlaps of a tenth of a radius stay below
 * that, but larger ones would throw a grain through its neighbours, where forces are those of another
 * packing, and it may be thrown back for ever. */
double gh_relax_move(gh_relax_state *s, double a, double b, double dt);
/* Once for each list of pairs, before the next two. */
void gh_relax_begin(gh_relax_state *s);
/* Forces at x. Returns the largest force on a free grain; *mean_force is the mean normal contact force (0: no
 * contact). */
double gh_relax_forces(gh_relax_state *s, double *mean_force);

/* The largest of the forces (n x 2) on free grains and of the couples (n; NULL: none): slowly, but for
 * numbers whose squares overflow or underflow. NaN: one is not finite. */
double gh_relax_largest(int n, const unsigned char *held, const double *f, const double *couple);
/* Between these, sums of squares of forces are right. */
#define GH_RELAX_LEAST 1e-290
#define GH_RELAX_MOST 1e300
/* up / down of a quotient of Rayleigh; 0: there is none, or it is no number. */
double gh_relax_quotient(double up, double down);

/* The time step of gh_relax_run at x: below the stability limit of all contacts that touch or nearly do. */
double gh_relax_safe_step(const gh_relax_state *s);

/* The parts, for those who must step by themselves (LAMMPS on several ranks). Bound of the largest eigenvalue
 * for unit masses: twice the largest eigenvalue of a grain's own stiffness block, given as xx xy yy. */
double gh_relax_bound(double kxx, double kxy, double kyy);
/* Time step for that bound. */
double gh_relax_time_step(double bound);

#ifdef __cplusplus
}
#endif
#endif
