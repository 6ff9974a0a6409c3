/* Private parts of the RVE. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_MICRO_INTERNAL_H
#define GRANHOM_MICRO_INTERNAL_H

#include <cholmod.h>

#include "granhom/micro.h"

/* ---- stiffness of the free grains (4.12) and its factor ---- */

typedef struct gh_stiffness {
  cholmod_common common;
  cholmod_sparse K;         /* upper triangle, order 2 nactive; arrays owned here */
  cholmod_factor *L;        /* NULL before the first analysis */
  cholmod_dense *X, *Y, *E; /* solution and CHOLMOD's workspaces */
  double *rhs;              /* 2 nactive x 4 */
  int nactive;
  int *active;   /* per member: number among the unknown grains, -1 when held, rattler or pinned */
  int *slot;     /* per contact: place of its off-diagonal block, -1 for none */
  int *diagonal; /* per unknown grain: place of its diagonal entries xx, xy (yy follows) */
  int *pattern;  /* contacts of the pattern: unknown grains i < j, in order */
  size_t capacity, slot_capacity, pattern_capacity, npattern;
  size_t k_capacity, p_capacity, i_capacity, rhs_capacity, diagonal_capacity;
  long analyses, factorisations;
} gh_stiffness;

gh_status gh_stiffness_create(gh_context *ctx, int members, gh_stiffness **s);
void gh_stiffness_destroy(gh_stiffness **s);
/* Numbers the unknown grains: neither held nor rattler, and one grain of each group that hangs together
 * without a held grain is pinned (rigid translation). */
gh_status gh_stiffness_number(gh_context *ctx, gh_stiffness *s, int n, const unsigned char *held,
                              const unsigned char *rattler, const gh_contact *contacts, int ncontacts,
                              bool pin);
/* Assembles and factorises K + shift 1. *definite: K is positive definite, and only then the factor can be
 * used. */
gh_status gh_stiffness_factorise(gh_context *ctx, gh_stiffness *s, const unsigned char *rattler,
                                 const gh_contact *contacts, int ncontacts, double shift, bool *definite);
/* Solves K X = B for ncol <= 4 columns held in s->rhs (column-major, 2 nactive rows); *X is valid until the
 * next solve. */
gh_status gh_stiffness_solve(gh_context *ctx, gh_stiffness *s, int ncol, const double **X);

/* ---- rattlers (Table 4.3; method 8.3) ---- */

typedef struct gh_rattlers {
  unsigned char *flag; /* per member */
  int *start, *link;   /* contacts of each grain */
  double *angle;
  size_t link_capacity, angle_capacity;
} gh_rattlers;
gh_status gh_rattlers_create(gh_context *ctx, int members, gh_rattlers **r);
void gh_rattlers_destroy(gh_rattlers **r);
/* Marks them; held members are never marked. mean_force: mean normal contact force. Returns their number. */
gh_status gh_rattlers_find(gh_context *ctx, gh_rattlers *r, int n, const unsigned char *held,
                           const gh_contact *contacts, int ncontacts, double mean_force, int *count);

/* ---- the RVE ---- */

struct gh_rve {
  gh_context *ctx;
  gh_rve_options options;
  gh_packing *packing;
  gh_cluster *cluster; /* taylor and restricted */
  gh_engine *engine;
  gh_stiffness *stiffness;
  gh_rattlers *rattlers;
  int n; /* members: primaries, or the cluster */
  bool periodic, relaxes;
  double volume; /* of the reference cell */
  double floor;  /* mean normal force at or below which the packing counts as unjammed */
  double extent; /* of the cell and the positions: sets round-off of the forces */
  const double *radius;
  const unsigned char *held;
  double *X;    /* n x 2 reference positions */
  double Fn[4]; /* converged state: F and fluctuated reference positions y = F^-1 x */
  double *yn;
  double F[4], *y; /* trial state */
  bool trial;
  double *x, *step; /* n x 2 work: positions in space of the last evaluation, and of a Newton step */
  int *view_grain, *view_id;
  unsigned char *view_flags;
  const gh_contact *contacts;
  const double *force;
  int ncontacts;
  gh_rve_measures m;
  gh_rve_cost cost;
};

/* Finds the equilibrium from the positions in rve->x (in space) at rve->F. Leaves positions, contacts and
 * forces of the equilibrium. */
gh_status gh_rve_equilibrate(gh_rve *rve);
/* Fetches contacts and forces, residual and mean force into rve->m. */
gh_status gh_rve_look_at_contacts(gh_rve *rve);
/* Stress, energy and the other sums over the contacts into rve->m. */
gh_status gh_rve_sums(gh_rve *rve);
/* A by static condensation; contacts and rattlers of the equilibrium are at hand. */
gh_status gh_rve_tangent(gh_rve *rve, double A[16]);

#endif
