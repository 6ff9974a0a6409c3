/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Private parts of the direct simulation. */
#ifndef GRANHOM_DIRECT_INTERNAL_H
#define GRANHOM_DIRECT_INTERNAL_H

#include "direct/outline.h"
#include "granhom/direct.h"

typedef struct direct_slips {
  gh_slip *slips;
  int count;
  size_t capacity;
} direct_slips;

/* Grains in equilibrium, or on the way to it. */
typedef struct direct_state {
  double *x, *theta; /* n x 2; n, NULL without friction */
  direct_slips slips;
  double dissipated; /* by friction since the start */
} direct_state;

struct gh_direct {
  gh_context *ctx;
  gh_direct_options options;
  const gh_mesh *mesh;
  int nsets, n;
  gh_packing *body; /* reference positions */
  outline outline;  /* reference */
  chain chain;
  gh_mesh moved;   /* the mesh, with nodes where the grains around them are */
  outline exposed; /* its outline */
  int *joined;     /* n: edge of the outline, from 1, on which the grain has come to a support; 0: none */
  int *nearest;    /* nnodes: boundary grain */
  int *element;    /* n: that the grain is in, or is nearest to */
  double *weight;  /* n: reference area that the grain stands for */
  unsigned char *boundary; /* n */
  gh_engine *engine;
  unsigned char *mask, *held; /* n: gh_fixed, and whether both: of the engine */
  unsigned char *flags;       /* n work, of gh_direct_look */
  double mean_radius, extent;
  direct_state now, trial; /* now: the last equilibrium */
  double *u;               /* nnodes x 2 */
  double *dead;            /* n x 2: forces that do not depend on positions */
  double *kept;            /* n x 2: that hold the initial stress */
  double *pressure_dead;   /* edges of the outline: pressures, per reference length ... */
  double *follow;          /* ... and following */
  double *reaction;        /* n x 2: forces of the supports */
  double *outside;         /* n x 2: all forces from outside, these included */
  bool solved;             /* the start is in equilibrium */
  double *load;            /* n x 2 work: forces on the trial state, supports left out */
  double *support;         /* n x 3 work, of gh_direct_look */
  double pressure;         /* mean, compression positive */
  double energy, zero_energy, zero_dissipated;
  gh_direct_measures m;
  gh_contact_list list; /* of the last equilibrium, the engine's */
  double *cauchy, *coordination;
  unsigned char *rattler; /* n */
  int *degree;            /* n work: contacts of each grain */
  int *identity;          /* n: 1, 2, ... */
};

static inline bool direct_friction(const gh_direct *d) {
  return d->options.law.friction;
}

/* ---- loads.c: what is asked of the grains from one equilibrium to the next ---- */

typedef struct direct_plan {
  unsigned char *mask;       /* n: gh_fixed */
  double *step;              /* n x 2: displacement of what is fixed, and the guess for the others */
  double *dead, *fade;       /* n x 2: forces at the end; reactions of supports that end, which fade */
  double *pressure, *follow; /* edges of the outline: at the end */
  double strain;             /* of the step, and of the change of pressure over the stiffness */
} direct_plan;
gh_status direct_plan_allocate(gh_direct *d, direct_plan *p);
gh_status direct_plan_create(gh_direct *d, const gh_direct_loads *loads, direct_plan *p);
void direct_plan_destroy(direct_plan *p);
/* Forces at the fraction t of the plan on grains at x; f: n x 2. Pressures push the grains that are exposed there.
 * *exposed: there are such pressures. */
gh_status direct_plan_forces(gh_direct *d, const direct_plan *p, double t, double *x, double *f,
                             bool *exposed);

/* ---- measure.c ---- */

/* Largest unbalanced force and moment on what is free over the mean normal force, of d->list under d->load. */
double direct_residual(const gh_direct *d, const unsigned char *mask, double *mean_force);
/* Measures of the last equilibrium, d->list. */
gh_status direct_measure(gh_direct *d);

/* ---- coarse.c: from grains to the mesh ---- */

/* Displacement of the node from those of the grains around it. */
void direct_fit(const gh_direct *d, const double *x, int node, double u[2]);
/* Stress and coordination of the elements, from d->list. */
void direct_coarsen(gh_direct *d);
gh_status direct_locate(gh_direct *d);

#endif
