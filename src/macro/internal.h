/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom macro: what the files of this module share.
 *
 * Degree of freedom 2 a + i is component i of node a. Arrays over them have ndof = 2 nnodes entries. */
#ifndef GRANHOM_MACRO_INTERNAL_H
#define GRANHOM_MACRO_INTERNAL_H

#include "granhom/macro.h"

/* ---- edges.c ---- */

/* Force on each of the two nodes of an edge from a to b, body on the left, under a pressure per length. */
void gh_edge_force(const double a[2], const double b[2], double pressure, double f[2]);
/* Derivative of minus the forces on (a, b) with respect to the positions of (a, b). Unsymmetric. */
void gh_edge_stiffness(double pressure, double K[4][4]);

/* ---- loads.c ---- */

typedef struct gh_edge_load {
  int a, b;
  double pressure;
} gh_edge_load;

/* Follower loads. */
typedef struct gh_edge_loads {
  int n;
  size_t capacity;
  gh_edge_load *edge;
} gh_edge_loads;

/* The dead load of a footing: a force and its arms, arm_ij = f_i z_j with z the arm in the reference about
 * the middle of the edge. The moment at any rotation is linear in them, so loads add and mix. */
typedef struct gh_footing_load {
  int set;
  double force[2], arm[4];
} gh_footing_load;

struct gh_loads {
  gh_context *ctx;
  const gh_mesh *mesh;
  double *force;        /* ndof, dead */
  unsigned char *fixed; /* ndof */
  double *value;        /* ndof, displacement where fixed */
  gh_edge_loads follow;
  int nfootings;
  size_t footing_capacity;
  gh_footing_load *footing;
};

gh_status gh_edge_loads_add(gh_context *ctx, gh_edge_loads *list, int a, int b, double pressure);

/* ---- footing.c ---- */

/* A footing of the present increment, in the order of the loads'. Its unknowns q are its displacement and its
 * rotation times `half`; they stand behind the ndof entries of residuals and corrections. */
typedef struct gh_footing {
  const gh_mesh_set *set;
  int end[2];           /* nodes at the ends of its edge */
  double half;          /* half the distance between them in the reference */
  gh_footing_load from; /* its load at eq */
  double fade[3];       /* what fixes it at eq and is no load: fades like gh_macro.fade */
} gh_footing;

/* moved = u with the footing's nodes moved by dq. */
void gh_footing_move(const gh_mesh *mesh, const gh_footing *f, const double dq[3], const double *u,
                     double *moved);
/* Takes over the footings of the loads. GH_INPUT: one of their nodes is fixed. */
gh_status gh_footings_begin(gh_macro *m, const gh_loads *to);
/* Loads and fade at eq, which lies at the fraction t of the path; R: internal minus external nodal forces
 * there.
 */
void gh_footings_rebase(gh_macro *m, const gh_loads *to, double t, const double *R);
/* The entries behind the ndof nodal ones of R at the fraction t; returns the norm of the footings' forces. */
double gh_footings_residual(const gh_macro *m, const gh_loads *to, double t, bool fade, const double *u,
                            double *R);
/* Work of the footings' loads, and of what fades, from m->eq at the fraction t0 to m->now at t1. */
double gh_footings_work(const gh_macro *m, const gh_loads *to, double t0, double t1, bool fade);
/* Gives the system the rotation of nodes with the footings; R: internal minus external nodal forces at u. */
void gh_footings_tangent(gh_macro *m, const gh_loads *to, double t, const double *u, const double *R);

/* ---- supports.c ---- */

/* GH_INPUT when a connected body can move rigidly in spite of the fixed degrees of freedom. Footings connect.
 */
gh_status gh_supports_check(gh_context *ctx, const gh_mesh *mesh, const unsigned char *fixed, int nfootings,
                            const gh_footing *footing);

/* ---- factor.c: factors of a sparse matrix ---- */

/* Compressed columns, rows ascending. Of symmetric ones the upper triangle is used alone. */
typedef struct gh_factor_matrix {
  int n, *p, *i;
  double *x;
} gh_factor_matrix;
typedef enum gh_factor_method { GH_FACTOR_CHOLMOD, GH_FACTOR_UMFPACK } gh_factor_method;
typedef struct gh_factor gh_factor;
gh_status gh_factor_create(gh_context *ctx, gh_factor **factor);
void gh_factor_destroy(gh_factor **factor);
/* Drops analyses and factors: the pattern changes, or the next analysis must not depend on older values. */
void gh_factor_forget(gh_factor *factor);
/* Analyses where that has not been done, and factorises. GH_DIVERGED: not positive definite (CHOLMOD, without
 * a message), singular (UMFPACK). */
gh_status gh_factor_update(gh_factor *factor, gh_factor_method method, const gh_factor_matrix *K);
/* With the factor of the last update; UMFPACK refines with K. b, x: n. */
gh_status gh_factor_solve(gh_factor *factor, const gh_factor_matrix *K, double *b, double *x);
/* What factorised last: 'c' CHOLMOD, 'u' UMFPACK, 0 nothing yet. */
char gh_factor_letter(const gh_factor *factor);

/* ---- solve.c: the sparse system ---- */

typedef struct gh_system gh_system;
gh_status gh_system_create(gh_context *ctx, const gh_mesh *mesh, gh_system **system);
void gh_system_destroy(gh_system **system);
/* Which degrees of freedom are prescribed, and which nodes follow one of n rigid bodies (owner: the body of
 * each node, -1 for none; NULL: no bodies). A body's three unknowns stand behind the ndof entries of b and x:
 * two displacements and the rotation. At the start of an increment: analyses are not stored from one to the
 * next, because UMFPACK's depends on the values, and a restart has only those to come. */
gh_status gh_system_constrain(gh_system *system, const unsigned char *fixed, int n, const int *owner);
/* Displacement of a node for a unit rotation of its body. */
void gh_system_turn(gh_system *system, int node, const double turn[2]);
/* Stiffness of a body against its rotation, besides that of the mesh. */
void gh_system_spring(gh_system *system, int body, double spring);
void gh_system_clear(gh_system *system);
/* Adds an n x n matrix (row-major) at the degrees of freedom dof. */
void gh_system_add(gh_system *system, int n, const int *dof, const double *K);
/* y += K x over all degrees of freedom. */
void gh_system_multiply(const gh_system *system, const double *x, double *y);
/* Euclidean norm of the diagonal. */
double gh_system_diagonal(const gh_system *system);
/* Solves K_ff x_f = b_f; entries of fixed degrees of freedom are not touched. GH_DIVERGED: K_ff is singular.
 */
gh_status gh_system_solve(gh_system *system, const double *b, double *x);
/* The same with the factor of the last gh_system_solve since gh_system_constrain, whatever was added since.
 */
gh_status gh_system_again(gh_system *system, const double *b, double *x);
/* The same with the upper triangle of K_ff made positive definite by a multiple of the unit matrix where it
 * is not: x is a direction in which the energy falls. */
gh_status gh_system_descend(gh_system *system, const double *b, double *x);
/* What factorised last: 'c' CHOLMOD, 'u' UMFPACK, 0 nothing yet. */
char gh_system_method(const gh_system *system);

/* ---- macro.c: the object ---- */

/* Everything at one displacement field. */
typedef struct gh_state {
  double *u;    /* ndof */
  double *F;    /* npoints x 4 */
  double *P;    /* npoints x 4 */
  double *A;    /* npoints x 16 */
  double *fint; /* ndof, internal forces */
} gh_state;

/* The best iterate beyond a stress discontinuity that Newton met (instability.c). */
typedef struct gh_instability {
  double *u;       /* ndof */
  double residual; /* there; infinite while there is none */
  int point;       /* whose stress departs most from its linear prediction, -1 while unknown */
  double change;   /* by how much */
} gh_instability;

/* Relaxation by damped central differences (relaxation.c). Entries are those of residuals; mass is one for
 * which the critical time step is 1. The arrays are parts of `numbers`. */
typedef struct gh_relax_arrays {
  double *numbers, *mass, *velocity, *last, *shape, *work; /* the last three: scratch */
} gh_relax_arrays;

/* What has added up since the energy was set to zero (energy.c). All of it is saved with the state. */
typedef struct gh_tally {
  double inner, outer, freed;      /* work; freed: external minus internal of steps that were not balanced */
  double energy, dissipation;      /* of the packings now, */
  double energy0, dissipation0;    /* and when it was zero */
  double largest;                  /* of |inner| and |energy + dissipation| since then */
  double residual, micro_residual; /* largest of all converged substeps */
} gh_tally;

/* A saved state between two increments (estimate.c). */
typedef struct gh_keep {
  double *state;
  size_t size, capacity;
  gh_farm_mark *mark;
} gh_keep;

struct gh_macro {
  gh_context *ctx;
  const gh_mesh *mesh;
  gh_farm *farm;
  gh_macro_options options;
  gh_macro_watch *watch;
  void *watch_data;
  int ndof, npoints;
  double length; /* of a typical element */
  gh_shapes shapes;
  gh_system *system;
  gh_state eq;   /* where the farm's converged state is: the last equilibrium */
  gh_state now;  /* Newton's iterate; the farm's trial state belongs to it */
  gh_state next; /* a trial of the line search */
  int nfootings;
  gh_footing *footing;
  int *owner; /* nnodes: the footing that a node follows, -1 for none */
  double *reaction;
  double *f0;           /* holds the initial stress */
  double *force;        /* dead loads at eq, without f0 */
  gh_edge_loads follow; /* follower loads at eq */
  double *from;         /* u at eq, where the increment starts (increment.c) */
  double *fade;         /* forces at eq that are neither loads nor supports of the increment: they fade */
  double *fext;         /* of the last residual */
  double footing_force; /* of the last residual */
  double *residual;     /* of `now`; these three have 3 nfootings entries more */
  double *trial;        /* of `next` */
  double *du;
  gh_instability instability; /* of the last line search */
  gh_instability swing;       /* of the iteration's steps with which the residual grew */
  gh_relax_arrays relax;      /* none with Newton alone */
  double *elastic; /* npoints x 16: tangents at u = 0 before the first increment; NULL when not in use */
  bool started;    /* the stress at u = 0 is known */
  bool solved;     /* an increment was started */
  gh_tally tally;
  int first_level;  /* smallest depth of bisection of an increment; 0 */
  int deepest;      /* depth of its shortest converged substep */
  gh_keep begin_of; /* of the increment that is solved twice */
  gh_keep whole;    /* the body that goes in whole increments, */
  bool apart;       /* where it differs from the current one */
  double *compared; /* of solving twice (estimate.c) */
  double begin, micro_seconds;
};

/* ---- evaluate.c ---- */

gh_status gh_state_create(const gh_macro *m, gh_state *s);
void gh_state_destroy(gh_state *s);
void gh_state_copy(const gh_macro *m, const gh_state *from, gh_state *to);
void gh_state_swap(gh_state *a, gh_state *b);
/* F from u, P and A from the farm, internal forces. GH_DIVERGED: what is not finite, det F <= 0, corners of
 * elements that are turned inside out. */
gh_status gh_macro_evaluate(gh_macro *m, gh_state *s);
/* The same with the tangents of another state, which stand in for those that are not computed. */
gh_status gh_macro_evaluate_stress(gh_macro *m, gh_state *s, const gh_state *tangents);
/* Evaluates u = 0 once. */
gh_status gh_macro_start(gh_macro *m);

/* ---- residual.c ---- */

/* One attempt to reach the fraction t of the path from m->eq to the loads `to`. */
typedef struct gh_attempt {
  const gh_loads *to;
  double t;
  int substep, iterations, relaxed; /* relaxed: of the iterations, by relaxation */
  double residual, scale;           /* of m->now */
  double kinetic;                   /* kinetic energy over internal work, in relaxation */
  double before[GH_MACRO_MEMORY];   /* residuals of m->now in this substep, the latest first; 0: none */
  bool released;                    /* fading forces do not act */
  bool present;                     /* iterate with current tangents, whatever the option states */
} gh_attempt;

/* External forces at the fraction t and at displacements u; f: ndof. Without `fade` those that fade are left
 * out. */
void gh_external_forces(const gh_macro *m, const gh_loads *to, double t, bool fade, const double *u,
                        double *f);
/* Entries of residuals and corrections: the nodes', then those of the footings. */
static inline int gh_residual_size(const gh_macro *m) {
  return m->ndof + 3 * m->nfootings;
}
/* Whether entry d is an unknown: neither prescribed nor the node of a footing. */
static inline bool gh_residual_is_free(const gh_macro *m, const gh_attempt *a, int d) {
  return d >= m->ndof || (!a->to->fixed[d] && m->owner[d / 2] < 0);
}
/* R = f_int - f_ext at state s, plus K times the prescribed part of du for a prediction. */
void gh_residual_find(gh_macro *m, const gh_attempt *a, const gh_state *s, const double *predict, double *R);
/* |R_free| and |f_ext| + |R_prescribed|, footings' forces among f_ext. GH_DIVERGED: one is not finite. */
gh_status gh_residual_measure(const gh_macro *m, const gh_attempt *a, const double *R, double *residual,
                              double *scale);
/* Which residual force is not finite, and the likely cause. Returns GH_DIVERGED. */
gh_status gh_residual_refuse(const gh_macro *m, const double *R);
/* The residual that counts as zero at forces of this scale. */
double gh_residual_limit(const gh_macro *m, double scale);
bool gh_residual_converged(const gh_macro *m, const gh_attempt *a);
/* Work of the free residual forces along the correction m->du. */
double gh_residual_along(const gh_macro *m, const gh_attempt *a, const double *R);
/* The residual over the forces that act: 1 where there are none. */
double gh_relative_residual(const gh_attempt *a);

/* ---- step.c ---- */

/* m->du: what prescribed entries of m->now lack at the fraction a->t, zero elsewhere; true when there is any.
 */
bool gh_prescribe(gh_macro *m, const gh_attempt *a);
/* m->next.u = m->now.u moved by s times m->du, footings as rigid bodies. */
void gh_step_move(gh_macro *m, double s);
/* m->next, whose residual is m->trial, becomes the iterate. */
void gh_step_accept(gh_macro *m, gh_attempt *a, double residual, double scale);
/* To the watch. */
void gh_iteration_report(const gh_macro *m, const gh_attempt *a, int iteration, double first, double step);

/* ---- newton.c ---- */

/* GH_OK: m->now is in equilibrium and the farm's trial state belongs to it. GH_DIVERGED: it was not found;
 * the message states why. */
gh_status gh_newton(gh_macro *m, gh_attempt *a);
/* Lets the body move from m->eq to an equilibrium under the loads at the fraction a->t without fading forces,
 * down the energy and with a commit after every step, so that the packings go along through their
 * rearrangements (method 6). GH_OK: m->now is in equilibrium and committed, m->eq is the same. */
gh_status gh_follow(gh_macro *m, gh_attempt *a);

/* ---- relaxation.c ---- */

gh_status gh_relax_check(gh_context *ctx, const gh_macro_options *o);
gh_status gh_relax_allocate(gh_macro *m);
/* The same as gh_newton by damped central differences. */
gh_status gh_relax(gh_macro *m, gh_attempt *a);

/* ---- energy.c ---- */

/* Of the stresses from m->eq to m->now, trapezoidal. */
double gh_internal_work(const gh_macro *m);
/* m->eq was evaluated as the first state: energies are counted from here. */
void gh_energy_begin(gh_macro *m);
/* The body goes from m->eq at the fraction t0 to m->now at a->t, which is about to be committed. evaluated:
 * the farm's measures are those of m->now, else both are the same. balanced: both are equilibria. Uses
 * m->fext and m->trial. */
void gh_energy_count(gh_macro *m, const gh_attempt *a, double t0, bool evaluated, bool balanced);
void gh_energy_residual(gh_macro *m, double relative); /* of a converged substep */

/* ---- estimate.c ---- */

void gh_estimate_free(gh_macro *m);

/* ---- instability.c ---- */

void gh_instability_forget(gh_instability *instability);
/* Offers the trial m->next with its residual as a post-instability state. */
void gh_instability_offer(gh_macro *m, gh_instability *best, double residual);
/* Where no trial was refused: the best step with which the residual grew becomes the candidate. An iteration that
 * ends moving to and fro has accepted trials beyond the discontinuity. */
void gh_instability_from_swing(gh_macro *m);
/* Evaluates the remembered iterate into m->now. GH_DIVERGED: there is none. */
gh_status gh_instability_evaluate(gh_macro *m);
/* The message of an increment that failed; returns GH_DIVERGED. */
gh_status gh_instability_explain(gh_macro *m, const gh_attempt *a, const gh_macro_report *report);
/* Appends which integration points are unjammed, if any. */
void gh_name_unjammed(const gh_macro *m, char *text, size_t size);

#endif
