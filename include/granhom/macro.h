/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: the macro problem: loads, Newton. */
#ifndef GRANHOM_MACRO_H
#define GRANHOM_MACRO_H

#include "granhom/farm.h"
#include "granhom/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- loads: what acts at the end of an increment ---- */

typedef struct gh_loads gh_loads;
GH_API gh_status gh_loads_create(gh_context *ctx, const gh_mesh *mesh, gh_loads **loads);
GH_API void gh_loads_destroy(gh_loads **loads);
GH_API void gh_loads_clear(gh_loads *loads);
/* Displacement component dir (0 x, 1 y) of all nodes of a set. A later call for the same node overrides. */
GH_API gh_status gh_loads_displace(gh_loads *loads, int set, int dir, double value);
/* Pressure > 0 pushes into the body; per reference length and direction (dead), or a follower load on the
 * deformed edge. */
GH_API gh_status gh_loads_pressure(gh_loads *loads, int set, double pressure, bool follow);
/* Force on each node of a set. */
GH_API gh_status gh_loads_force(gh_loads *loads, int set, const double force[2]);
/* Weight per reference area. */
GH_API gh_status gh_loads_gravity(gh_loads *loads, const double b[2]);
/* A rigid, massless and rough footing on the straight edge `set`: its nodes move as a rigid body, with finite
 * rotation, from where they are when the footing is first given; a dead load acts on the body at the point
 * `at` (reference coordinates; it follows the footing). More forces on the same footing are more calls. The
 * footing stands as long as the loads that are solved for name it. GH_INPUT: no edges, an edge that is not
 * straight, a footing that shares nodes with another one. Nodes that are fixed as well are found by
 * gh_macro_solve. */
GH_API gh_status gh_loads_footing(gh_loads *loads, int set, const double at[2], const double force[2]);
/* Middle between the ends of a footing's edge (reference coordinates) and the point on its line at the
 * distance `eccentricity` from it, towards growing x (growing y where the edge is upright). */
GH_API void gh_footing_point(const gh_mesh *mesh, int set, double eccentricity, double at[2]);

/* ---- the problem ---- */

typedef struct gh_macro gh_macro;

/* The matrix of Newton's iteration. It affects the path, not the result: the residual is always that
 * of the packings. */
typedef enum gh_tangent {
  GH_TANGENT_ALGORITHMIC, /* of the current iterate: quadratic convergence */
  GH_TANGENT_SYMMETRISED, /* its symmetric part: Cholesky in place of LU; linear where friction is */
  GH_TANGENT_FROZEN,      /* of the last equilibrium: one factorisation for a substep; linear */
  GH_TANGENT_ELASTIC      /* of u = 0 before the first increment, where contacts stick: likewise */
} gh_tangent;
/* "algorithmic", "symmetrised", "frozen", "elastic"; false when the word is none of them. */
GH_API bool gh_tangent_from_name(const char *name, gh_tangent *tangent);
GH_API const char *gh_tangent_name(gh_tangent tangent);

/* How the equilibrium of an increment is found. */
typedef enum gh_macro_method {
  GH_METHOD_NEWTON,
  GH_METHOD_RELAXATION, /* damped central differences: stresses alone, no tangents, nothing is factorised */
  GH_METHOD_AUTOMATIC   /* Newton, and relaxation where it stops */
} gh_macro_method;
/* "newton", "relaxation", "automatic"; false when the word is none of them. */
GH_API bool gh_macro_method_from_name(const char *name, gh_macro_method *method);
GH_API const char *gh_macro_method_name(gh_macro_method method);

enum { GH_MACRO_MEMORY = 10 };

typedef struct gh_macro_options {
  double tolerance;   /* |R_free| <= tolerance (|f_ext| + |R_prescribed|); default 1e-8. Relaxation: kinetic
                         energy <= tolerance times internal work of the substep, too */
  int max_iterations; /* default 20; of relaxation alone, its steps */
  int cut_steps;      /* largest depth of bisection of a failing increment; default 6 */
  bool line_search;   /* default true */
  int memory; /* a step of the line search is compared with the largest of the last so many residuals of this
                 substep, 1 to GH_MACRO_MEMORY; default 1 */
  double memory_above; /* ... as long as its own is larger than this times the scale of `tolerance`; default
                          0: always */
  bool pass_jumps; /* default true: when bisection is spent, step over an instability of the packings: commit
                      the post-instability states and continue (method 6) */
  gh_tangent tangent; /* default: algorithmic. With frozen and elastic the packings compute tangents at the
                         end of a substep alone, by one evaluation more */
  gh_macro_method method; /* default: Newton */
  double damping_ratio;   /* of relaxation: over critical damping; above 0, default 1 */
  double safety;          /* time step over the critical one; above 0, below 1, default 0.5 */
} gh_macro_options;
GH_API gh_macro_options gh_macro_defaults(void);

/* One line of convergence: called after each residual. `iteration` 0 is the residual before the first
 * correction. */
typedef struct gh_macro_iteration {
  int substep, iteration;
  double residual; /* |R_free| */
  double scale;    /* |f_ext| + |R_prescribed| */
  double relative; /* residual / scale */
  double first;    /* residual / residual of iteration 0 */
  double step;     /* length of the line search's step that led here; 1 without */
  double kinetic;  /* of relaxation: kinetic energy over internal work; 0 with Newton */
  double seconds;  /* since the increment began */
} gh_macro_iteration;
typedef void gh_macro_watch(void *data, const gh_macro_iteration *it);

typedef struct gh_macro_report {
  int iterations, substeps, cuts,
      jumps;   /* of the increment; cuts: bisections; jumps: instabilities stepped over (method 6) */
  int relaxed; /* of the iterations: steps of relaxation */
  double residual, relative; /* at the end */
  double micro_seconds, seconds;
} gh_macro_report;

/* The mesh and the farm (4 points per element, point 4 e + g) stay the caller's and must outlive the macro.
 */
GH_API gh_status gh_macro_create(gh_context *ctx, const gh_mesh *mesh, gh_farm *farm,
                                 const gh_macro_options *options, gh_macro **macro);
GH_API void gh_macro_destroy(gh_macro **macro);
GH_API void gh_macro_set_watch(gh_macro *macro, gh_macro_watch *watch, void *data);
/* Holds the initial stress: from now on the internal forces at u = 0 act as fixed external forces. Before the
 * first solve. */
GH_API gh_status gh_macro_balance(gh_macro *macro);
/* Finds the equilibrium under `loads` from the last one, and commits. Between the two, dead loads, follower
 * loads and prescribed displacements go linearly, and the reactions of supports that are released fade
 * linearly. GH_INPUT: singular for want of supports (names a node and direction). GH_DIVERGED: bisections
 * spent; the state is that of the last converged substep (farm reverted), and the message names the
 * integration point or the node with the largest residual and the reason. */
GH_API gh_status gh_macro_solve(gh_macro *macro, const gh_loads *loads, gh_macro_report *report);
/* ---- estimates of its error (docs/explanation/method.md) ---- */

/* Of all converged substeps since the energy was set to zero; the residuals since the start. */
typedef struct gh_energy {
  double inner_work; /* int P : dF dV0 by the trapezoidal rule over the substeps */
  double outer_work; /* of loads, supports and what fades on the displacements, likewise */
  double freed; /* what of outer_work exceeds inner_work in instabilities, where nothing balances: set free */
  double energy, dissipation; /* gained by the packings and dissipated by friction, summed with the weights of
                                 the points; NAN when the farm is not made of RVEs */
  double largest;             /* largest |inner_work| or |energy + dissipation| seen */
  double scale; /* int |P| |F| dV0 at the end: work below 1e-12 of it is round-off (a rotation) */
  double residual, micro_residual; /* largest relative residual of a substep, and of a packing in it */
} gh_energy;
GH_API void gh_macro_energy(const gh_macro *macro, gh_energy *energy);
/* The current equilibrium is the zero from now on; without this u = 0 is. */
GH_API void gh_macro_zero_energy(gh_macro *macro);
/* Energy imbalance (Hill-Mandel): internal work less what the packings have gained and dissipated, over
 * `largest`; 0 where all work was round-off. */
GH_API double gh_energy_defect(const gh_energy *energy);
/* Work imbalance: external work, what was set free in instabilities apart, less internal work, over
 * `largest`. */
GH_API double gh_work_defect(const gh_energy *energy);

/* How the body that goes in halves and the one that goes in whole increments differ. Root mean squares are
 * over the areas of the points, of Frobenius norms. */
typedef struct gh_difference {
  bool known;  /* both came to the end of the increment */
  bool halves; /* the present state is that of the halves; false: they failed, and it is the other one */
  gh_macro_report whole;    /* of the whole increment */
  double stress, most;      /* of P at the end: root mean square, and at the point where it is largest */
  double growth, change;    /* root mean squares of how this difference and how P change in the increment */
  double scale, scale_most; /* root mean square and largest |P| at the end */
  double displacement, scale_u; /* Euclidean norms of the difference of u, and of u */
  const double *reactions;      /* in whole increments, nnodes x 2; the macro's, valid until the next call */
  double seconds;               /* of the halves */
} gh_difference;
/* gh_macro_solve for two bodies that start as one: the current state continues in halves of the increment (of
 * its shortest substep where the other was bisected), another one in whole increments. Where only one of them
 * finds an equilibrium, or an instability was stepped over, both continue from it as one. The report is that
 * of the current state, with the seconds of both; the watch sees the halves alone. GH_INPUT: a farm without
 * RVEs. */
GH_API gh_status gh_macro_solve_twice(gh_macro *macro, const gh_loads *loads, gh_macro_report *report,
                                      gh_difference *difference);
/* Both continue from the current state as one. */
GH_API void gh_macro_join(gh_macro *macro);
/* Whether the two are apart; exchanges them (for saving both); makes the current state, macro and farm, the
 * one of the whole increments (for loading both: this one first). */
GH_API bool gh_macro_apart(const gh_macro *macro);
GH_API gh_status gh_macro_exchange(gh_macro *macro);
GH_API gh_status gh_macro_part(gh_macro *macro);

/* Depth of bisection of the next increments, in place of the option's cut_steps (0 ... 40). */
GH_API void gh_macro_allow_cuts(gh_macro *macro, int cut_steps);

/* All that the next gh_macro_solve starts from, without the states of the farm, as numbers: a macro of the
 * same mesh and options that loads them continues to the same last bit. GH_INPUT: not of this mesh. */
GH_API size_t gh_macro_state_size(const gh_macro *macro);
GH_API void gh_macro_save(const gh_macro *macro, double *state);
GH_API gh_status gh_macro_load(gh_macro *macro, const double *state, size_t size);

/* State at the last equilibrium. Arrays belong to the macro. */
GH_API const double *gh_macro_u(const gh_macro *macro); /* nnodes x 2 */
GH_API const double *gh_macro_F(const gh_macro *macro); /* npoints x 4 */
GH_API const double *gh_macro_P(const gh_macro *macro); /* npoints x 4 */
GH_API const double *gh_macro_A(const gh_macro *macro); /* npoints x 16; NULL with GH_METHOD_RELAXATION */
GH_API const double *
gh_macro_reactions(const gh_macro *macro); /* nnodes x 2: force of the supports on the body */
/* Sum of the reactions over the nodes of a set (corners count for both edges). */
GH_API void gh_macro_reaction(const gh_macro *macro, int set, double sum[2]);
/* How a footing has moved against the reference: the middle between the ends of its edge, and the angle of
 * the line between them (counter-clockwise, radians). Its force on the body is gh_macro_reaction. */
GH_API void gh_macro_footing(const gh_macro *macro, int set, double u[2], double *turn);
/* Area of the mesh, reference and current; dilatancy is 100 (v/V - 1). */
GH_API void gh_macro_volumes(const gh_macro *macro, double *V, double *v);

#ifdef __cplusplus
}
#endif
#endif
