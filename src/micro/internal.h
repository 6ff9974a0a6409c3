/* Private parts of the RVE. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_MICRO_INTERNAL_H
#define GRANHOM_MICRO_INTERNAL_H

#include <cholmod.h>
#include <klu.h>

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

/* Groups of grains that hang together by contacts, without those that are marked (NULL: all count): the first
 * grain of a group, and it alone, has group[i] == i. */
void gh_find_groups(int n, const gh_contact *contacts, int ncontacts, const unsigned char *without,
                    int *group);

/* ---- the same with friction: positions and rotations, unsymmetric, LU by KLU ---- */

typedef struct gh_coupled {
  int n; /* unknowns */
  int members;
  int *unknown;   /* members x 3: number of u_x, u_y, theta among the unknowns; -1 when there is none */
  int *first;     /* members + 1: each member's blocks in `neighbour` */
  int *neighbour; /* per block: the other member, ascending; the own block is among them */
  int *row;       /* per block: its first row within each column of the member */
  int *p, *i;     /* compressed columns, rows ascending */
  double *x;
  double *rhs, *solution; /* n x 4 each, column-major */
  int *old;               /* pattern of `symbolic`: p, then i */
  klu_common common;
  klu_symbolic *symbolic;
  klu_numeric *numeric;
  size_t neighbour_capacity, row_capacity, p_capacity, i_capacity, x_capacity, rhs_capacity,
      solution_capacity, old_capacity;
  int old_n;
  long analyses, factorisations;
} gh_coupled;

gh_status gh_coupled_create(gh_context *ctx, int members, gh_coupled **s);
void gh_coupled_destroy(gh_coupled **s);
/* Numbers the unknowns of the members that have a contact: positions where they are not held, rotations where
 * they turn, and makes the pattern. `pin`: the position of one member of each group that hangs together is
 * left out (rigid translation). */
gh_status gh_coupled_number(gh_context *ctx, gh_coupled *s, const unsigned char *held,
                            const unsigned char *loose, bool turns, const gh_contact_list *list, bool pin);
/* Assembles and factorises K = sum B^T D B with D of gh_friction and B of the generalised branch (l, q);
 * `shift` is added to the diagonal, times r^2 for rotations. *regular: the factor can be used. */
gh_status gh_coupled_factorise(gh_context *ctx, gh_coupled *s, const double *radius,
                               const gh_contact_list *list, double shift, bool *regular);
/* Solves K X = B for ncol <= 4 columns held in s->rhs (column-major, s->n rows); *X is valid until the next
 * solve. */
gh_status gh_coupled_solve(gh_context *ctx, gh_coupled *s, int ncol, const double **X);
/* The rows of B for end `e` (0: i, 1: j) of a contact: its unknowns v = (u_x, u_y, theta) change the branch
 * vector by sign * u and q by r * theta. */
static inline double gh_end_sign(int e) {
  return e ? 1 : -1;
}

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

/* With friction two contacts can hold a grain, or one: only members without any contact are marked
 * (method 8.3). Returns how many of them are not held. */
int gh_rattlers_loose(gh_rattlers *r, int n, const unsigned char *held, const gh_contact_list *list);

/* ---- history of the contacts (Table 7.1) ---- */

/* Sorted by (i, j, image[1], image[0]); contacts without history are left out. */
typedef struct gh_slips {
  gh_slip *slips;
  int count;
  size_t capacity;
} gh_slips;

/* What the history becomes: that of the contacts, and the hardening of those that have opened (method 8.10).
 */
gh_status gh_slips_advance(gh_context *ctx, const gh_slips *from, const gh_contact_list *list, bool hardening,
                           gh_slips *to);

/* ---- the RVE ---- */

/* A state that slip counts from and that is no converged one. */
typedef struct gh_kept {
  double F[4], *y, *theta; /* n x 2 positions F^-1 x, n rotations */
  double dissipated;       /* by friction since the begin */
  gh_slips slips;
} gh_kept;

struct gh_rve {
  gh_context *ctx;
  gh_rve_options options;
  gh_packing *packing;
  gh_cluster *cluster; /* taylor and restricted */
  gh_engine *engine;
  gh_stiffness *stiffness; /* without friction */
  gh_coupled *coupled;     /* with friction */
  gh_rattlers *rattlers;
  int n; /* members: primaries, or the cluster */
  bool periodic;
  bool relaxes;         /* positions of free members are unknown */
  bool turns;           /* rotations are unknown: friction, and not fixed */
  double volume;        /* of the reference cell */
  double accept_within; /* multiple of the tolerance up to which a packing that has spent its steps is
                           accepted */
  double floor;         /* mean normal force at or below which the packing counts as unjammed */
  double mean_radius;   /* of the primary grains */
  double extent;        /* of the cell and the positions: sets round-off of the forces */
  const double *radius;
  const unsigned char *held;
  unsigned char *all_held; /* memory of `held` where all positions are prescribed */
  double *X;               /* n x 2 reference positions */
  double Fn[4];            /* converged state: F and fluctuated reference positions y = F^-1 x */
  double *yn;
  double F[4], *y; /* trial state */
  bool trial;
  double *thetan, *theta;          /* n: rotations of both states; NULL without friction */
  gh_slips history, trial_history; /* with friction */
  gh_kept kept;                    /* with friction: state whose slip was kept last in this evaluation */
  double dissipatedn, dissipated;  /* by friction since the begin, of both states */
  bool begun;                      /* the engine has the converged state */
  double shift;        /* of the coupled stiffness in this evaluation: 0 until it has turned out singular */
  double *x, *step;    /* n x 2 work: positions in space of the last evaluation, and of a Newton step */
  double *turn;        /* n work: rotations of a Newton step; NULL without friction */
  double *x0, *theta0; /* the same, where a way out of a circle began; NULL without friction */
  int *view_grain, *view_id;
  unsigned char *view_flags;
  gh_contact_list list; /* of the last evaluation, the engine's */
  gh_rve_measures m;
  gh_rve_cost cost;
};

/* Gives the converged state to the engine, once, and not again before it changes. */
gh_status gh_rve_begin_increment(gh_rve *rve);
/* Slip goes on from the contacts at hand, in equilibrium or not, as it does in each time step of a direct
 * simulation (docs/explanation/method.md, "Limit cycles"). */
gh_status gh_rve_keep_slip(gh_rve *rve);
/* Slip goes on from rve->kept as it is. */
gh_status gh_rve_go_on(gh_rve *rve);
/* The trial state's history and dissipation, from the contacts at hand. */
gh_status gh_rve_advance_history(gh_rve *rve);
/* Slips as a row of numbers. GH_INPUT: a key that is not made of integers. */
enum { GH_SLIP_NUMBERS = 7 };
void gh_slips_save(const gh_slips *slips, double *to);
gh_status gh_slips_load(gh_context *ctx, const double *from, int count, gh_slips *slips);

/* Finds the equilibrium from the positions in rve->x (in space) at rve->F. Leaves positions, contacts and
 * forces of the equilibrium. */
gh_status gh_rve_equilibrate(gh_rve *rve);
/* Fetches contacts and forces, residual and mean force into rve->m. */
gh_status gh_rve_look_at_contacts(gh_rve *rve);
/* Stress, energy and the other sums over the contacts into rve->m. */
gh_status gh_rve_sums(gh_rve *rve);
/* A by static condensation; contacts and rattlers of the equilibrium are at hand. */
gh_status gh_rve_tangent(gh_rve *rve, double A[16]);
gh_status gh_rve_tangent_friction(gh_rve *rve, double A[16]);
/* Factor of the coupled stiffness at the contacts at hand; where it is singular and `help` is set, with a
 * shift. */
gh_status gh_rve_factorise_coupled(gh_rve *rve, bool help, bool *regular);
/* Marks the grains that carry nothing, into rve->rattlers and rve->m. */
gh_status gh_rve_find_rattlers(gh_rve *rve);
/* Whether anything is unknown at given F: positions or rotations. */
static inline bool gh_rve_solves(const gh_rve *r) {
  return r->relaxes || r->turns;
}
static inline bool gh_rve_friction(const gh_rve *r) {
  return r->options.law.friction != 0;
}

#endif
