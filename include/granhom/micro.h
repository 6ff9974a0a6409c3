/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: one representative volume element (RVE): F in, Piola stress and tangent out. */
#ifndef GRANHOM_MICRO_H
#define GRANHOM_MICRO_H

#include "granhom/engine.h"
#include "granhom/packing.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gh_rve gh_rve;

/* Boundary conditions (method 2). */
typedef enum gh_boundary {
  GH_TAYLOR,
  GH_TAYLOR_CELL,
  GH_RESTRICTED,
  GH_PERIODIC,
  GH_DISPLACEMENT, /* these four: on a frame, docs/explanation/frames.md */
  GH_FRAME_PERIODIC,
  GH_TRACTION,
  GH_MIXED,
  GH_SERVO_DISPLACEMENT, /* the same by servo-control */
  GH_SERVO_PERIODIC,
  GH_SERVO_TRACTION,
  GH_BOUNDARIES
} gh_boundary;
/* "taylor", "taylor-cell", "restricted", "periodic", "displacement", "frame-periodic", "traction", "mixed", "servo-displacement",
 * "servo-periodic", "servo-traction"; false
 * when the word is none of them. */
GH_API bool gh_boundary_from_name(const char *name, gh_boundary *b);
GH_API const char *gh_boundary_name(gh_boundary b);
/* The words in one text: "taylor, taylor-cell, ...". */
GH_API const char *gh_boundary_words(void);

/* What a pair of opposite edges of a frame does. */
typedef enum gh_edges {
  GH_EDGES_OPEN, /* no condition: none is given */
  GH_EDGES_DISPLACEMENT,
  GH_EDGES_PERIODIC,
  GH_EDGES_TRACTION
} gh_edges;
/* Of GH_MIXED: "x=traction,y=displacement", x the edges that the first lattice vector leads to. GH_INPUT: another
 * text, or a pair without condition, whose work is not that of the stress then. */
GH_API gh_status gh_mixed_read(gh_context *ctx, const char *text, gh_edges mixed[2]);
enum { GH_MIXED_TEXT = 80 };
/* The name of a condition with what it mixes: "mixed x=traction,y=displacement". */
typedef struct gh_rve_options gh_rve_options;
GH_API void gh_boundary_text(const gh_rve_options *options, char text[GH_MIXED_TEXT]);

/* How slip is counted within an increment where grains are free (method 3, "Ramps"): along a ramp of F, committed
 * in every relaxation step, and over a short last part; or over the whole increment at once, as Table 7.1 does,
 * which has no equilibrium in some increments. Where all grains follow F it is the whole one always. */
typedef enum gh_integration { GH_INTEGRATION_RAMP, GH_INTEGRATION_WHOLE } gh_integration;
/* "ramp", "whole"; false when the word is neither. */
GH_API bool gh_integration_from_name(const char *name, gh_integration *integration);
GH_API const char *gh_integration_name(gh_integration integration);

struct gh_rve_options {
  gh_boundary boundary;
  gh_edges mixed[2]; /* of GH_MIXED, else nothing */
  /* Of servo-control, else nothing: displacement over unbalanced force, over 1/E_n, 0 < g < 1, default 0.1; what may be
   * unbalanced, over the mean normal contact force, default 1e-4; sweeps that Anderson's acceleration combines, 0 (the
   * default) to GH_SERVO_DEPTH. */
  double servo_gain, servo_tolerance;
  int servo_acceleration;
  gh_engine_kind engine;
  gh_contact_law law;
  double tolerance; /* residual: largest force on a free grain over the mean normal contact force; > 0,
                       default 1e-8 */
  long max_steps;   /* relaxation steps before GH_DIVERGED; 0: the default */
  double accept; /* when the relaxation steps are spent: unbalanced force on a grain, or moment over radius,
                    up to which the packing is accepted unconverged; 0, the default: none */
  gh_relaxation relaxation;   /* the method of finding equilibrium; default GH_RELAX_POLISHED. The others take
                               no Newton step: relaxation alone has to reach the tolerance */
  gh_integration integration; /* of slip; default GH_INTEGRATION_RAMP. Without friction it is nothing */
  double allow_overlap;       /* of accepted states, see granhom/limits.h: 0, the default: gh_default_limits;
                               INFINITY: any; else the largest mean overlap over the mean radius */
};
enum { GH_SERVO_DEPTH = 8 };
GH_API gh_rve_options gh_rve_defaults(void);
/* The relaxation steps that these options allow: max_steps, or the default (friction relaxes in fewer). */
GH_API long gh_rve_step_limit(const gh_rve_options *options);

/* Whether a packing often has several equilibria close to each other at one F: free grains with friction. */
GH_API bool gh_rve_has_branches(const gh_rve_options *options);
/* Whether the condition is one on a frame. */
GH_API bool gh_rve_has_frame(const gh_rve_options *options);
/* Whether it is met by servo-control. */
GH_API bool gh_rve_has_servo(const gh_rve_options *options);
/* Whether the packing has what the condition needs: gh_rve_create and gh_farm_create refuse others. GH_INPUT: a frame
 * with a gap that a grain can pass, no grain on an edge, one that reaches across the cell, a pair of edges without
 * condition. */
GH_API gh_status gh_rve_check_packing(gh_context *ctx, const gh_packing *packing,
                                      const gh_rve_options *options);

enum { GH_WANT_TANGENT = 1 };

/* Everything else that an evaluation knows. */
typedef struct gh_rve_measures {
  double F[4], P[4], cauchy[4];
  double energy;       /* stored contact energy per reference area (5.1), friction's part included */
  double energy_t;     /* friction's part: elastic slip and hardening (7.6) */
  double dissipation;  /* dissipated by friction since the start, per reference area (7.13) */
  double couple;       /* of a frame's supports: sum of their moments per reference area */
  double residual;     /* reached (method 3) */
  double mean_force;   /* mean normal contact force */
  double seconds;      /* of this evaluation */
  double coordination; /* mean number of contacts per grain that is no rattler; 0 when unjammed */
  double fabric[3];    /* mean n(x)n over contacts: xx xy yy */
  double volume_fraction;
  double overlap;  /* mean over the contacts between grains that are no rattlers, over the mean radius */
  double acoustic; /* smallest eigenvalue of N.A.N over all N; NAN without tangent */
  double acoustic_angle; /* of N to the x axis, radians */
  int sweeps;            /* of servo-control */
  long steps;            /* force evaluations */
  long pairs;            /* pair evaluations: gh_engine_cost */
  int contacts, rattlers;
  int engulfed; /* contacts with an overlap above the smaller radius: a centre lies in the other grain */
  int sliding;  /* contacts on the Coulomb limit */
  int factorisations;
  int ramps;       /* of this evaluation (docs/explanation/method.md, "Ramps") */
  int settled;     /* the last ramp led to F itself: slip has no equilibrium over the last part */
  int accepted;    /* unconverged: by options.accept, or in gh_rve_reach */
  int polished;    /* the residual was reached by Newton's iteration */
  int newton;      /* ... from the start, without relaxation (docs/explanation/method.md, "Newton first") */
  int events;      /* parts in which Newton's iteration followed F, or could not, where not at once */
  int unjammed;    /* no contact, or free grains without contact force: P = 0, A = 0 */
  int stress_free; /* unjammed, or the contact forces of free grains are mostly round-off: no stress */
  int regularised; /* the tangent's matrix was not positive definite and was shifted */
} gh_rve_measures;

/* Where the time of an RVE went since it was made, seconds and counts. */
typedef struct gh_rve_cost {
  double set, relax, contacts, factorise,
      total;      /* cell and neighbours; relaxation; contact lists; stiffness and tangent */
  double history; /* keeping the history of the contacts: part of `set` and of the rest */
  long evaluations, steps, factorisations, analyses;
  long pairs; /* pair evaluations (gh_engine_cost): work in a unit that does not depend on the machine */
} gh_rve_cost;

/* Makes an RVE whose converged state is the packing as read (F = I, no fluctuation). The packing is copied.
 * Errors: GH_INPUT (options out of range), GH_ENGINE. */
GH_API gh_status gh_rve_create(gh_context *ctx, const gh_packing *packing, const gh_rve_options *options,
                               gh_rve **rve);
GH_API void gh_rve_destroy(gh_rve **rve);
/* Finds the equilibrium at F (row-major, det > 0) from the converged state, or near a trial state that was kept
 * (gh_rve_keep), and makes it the trial state. P
 * (5.3-5.6) and, where `want` asks, A (6.3, 6.7, 6.18, 6.19); A may be NULL otherwise. GH_INPUT: det F <= 0
 * or not finite. GH_DIVERGED: no equilibrium within max_steps. */
GH_API gh_status gh_rve_evaluate(gh_rve *rve, const double F[4], unsigned want, double P[4], double A[16]);
/* The same, with a trial state of this RVE (gh_rve_save_trial) that was found from the same converged state:
 * the search for equilibrium starts there if F is near to its F, that is, no farther than a tenth of the
 * distance from the converged one to that. A packing that has several equilibria at nearly the same F then
 * stays with the one that it has, where a search from the converged state may come to another. Slip counts
 * from what it counted from in that trial state, the converged state or the end of a ramp, so that its tangent
 * holds. NULL, and Taylor's conditions: as gh_rve_evaluate. GH_INPUT: the state
 * does not fit. */
GH_API gh_status gh_rve_evaluate_near(gh_rve *rve, const double F[4], const double *near, size_t size,
                                      unsigned want, double P[4], double A[16]);
/* Keeps the trial state of the last evaluation, until the next commit, revert or load: gh_rve_evaluate then is
 * gh_rve_evaluate_near with it. For an iteration that has accepted this trial. Where a packing has one
 * equilibrium (gh_rve_has_branches) it does nothing. */
GH_API gh_status gh_rve_keep(gh_rve *rve);
GH_API gh_status gh_rve_commit(
    gh_rve *rve); /* trial state becomes the converged state; without a trial state nothing happens */
GH_API gh_status gh_rve_revert(gh_rve *rve); /* trial state is dropped */

/* An increment along the straight path between two F, row-major. */
typedef struct gh_rve_way {
  double from[4], to[4]; /* from: F of the converged state */
  int halvings;          /* it is done in 2^halvings substeps at least */
  unsigned want;         /* of the evaluation at the end */
  void (*count)(void *data,
                const gh_rve_measures
                    *m); /* called with each substep in equilibrium, before it is committed; NULL: not */
  void *data;
  int parts, cuts; /* substeps in equilibrium, the last one included; how often one was bisected */
} gh_rve_way;
enum { GH_WAY_CUTS = 6 };
/* Finds the equilibrium at `to` and makes it the trial state; A (4 x 4, iJkL) as in gh_rve_evaluate. A
 * substep that has none is bisected, GH_WAY_CUTS times at most below the `halvings`; behind it substeps grow
 * again. At the largest depth a packing that has spent its steps within three times the tolerance is accepted
 * unconverged. All substeps but the last are committed. GH_DIVERGED: bisections are spent; the converged
 * state is that of the last substep that was reached. Other errors as in gh_rve_evaluate. */
GH_API gh_status gh_rve_reach(gh_rve *rve, gh_rve_way *way, double A[16]);

/* Hill-Mandel along the substeps of a path: work of P on F by the trapezoidal rule against what the packing
 * stores and has dissipated, per reference area. Zero at the start; the first substep is the zero of both. */
typedef struct gh_rve_balance {
  long parts;
  double F[4], P[4];     /* of the last substep */
  double work, held;     /* energy gained and dissipated */
  double first, largest; /* what was stored at the first substep; largest work or gain so far */
  double residual;       /* largest */
} gh_rve_balance;
GH_API void gh_rve_balance_add(gh_rve_balance *balance, const gh_rve_measures *m);
/* (work - held) / largest; 0 where nothing was done beyond round-off (a rotation): |P| |F| / 1e12. */
GH_API double gh_rve_balance_defect(const gh_rve_balance *balance);
/* Whether a path in halves and the same in whole increments are on different branches
 * (docs/explanation/method.md, "Error estimates"): `growth` is by how much they have diverged in this
 * increment, `change` how much the stress has changed in it, `scale` the stress, all in the same norm;
 * `tolerance` is that of the stress. */
GH_API bool gh_is_branch(const gh_contact_law *law, double tolerance, double growth, double change,
                         double scale);
/* Of the last evaluation. */
GH_API const gh_rve_measures *gh_rve_measure(const gh_rve *rve);
GH_API void gh_rve_costs(const gh_rve *rve, gh_rve_cost *cost);

/* Piola stress from the forces on the boundary (5.16, 5.19, 5.22) of the last evaluation; equals P in
 * equilibrium. */
GH_API gh_status gh_rve_boundary_stress(gh_rve *rve, double P[4]);
/* Members of the last evaluation: number, current positions (n x 2), radii, primary grain and image (n x 2),
 * flags (1 rattler, 2 fixed, 4 replica, 8 on a frame), contacts. Periodic: the primaries alone, and `cell` holds the
 * current lattice vectors. Pointers belong to the RVE, valid until the next call. */
typedef struct gh_rve_view {
  int n, ncontacts;
  const double *x, *radius;
  const int *grain, *type, *id;
  const unsigned char *flags;
  const gh_contact *contacts;
  const gh_friction *friction; /* parallel to contacts; NULL without friction */
  const double *theta;         /* rotations; NULL without friction */
  const double
      *support; /* n x 3: forces and moments on the grains of a frame from outside, of all their copies
                                  that are no members; NULL: no frame */
  double cell[4], low[2];
  bool periodic;
} gh_rve_view;
GH_API gh_status gh_rve_look(gh_rve *rve, gh_rve_view *view);

/* States as flat buffers of doubles: what a farm moves, stores and writes. Their size changes with the
 * contacts that have a history; get it before each save. A state belongs to one packing, boundary condition
 * and law. */
GH_API size_t gh_rve_state_size(const gh_rve *rve); /* of the converged state, in doubles */
GH_API gh_status gh_rve_save(const gh_rve *rve, double *state);
/* The trial state likewise: what the converged state becomes by gh_rve_commit. Without a trial state these
 * are the converged one's. */
GH_API size_t gh_rve_trial_size(const gh_rve *rve);
GH_API gh_status gh_rve_save_trial(const gh_rve *rve, double *state);
/* Makes `state` the converged state and drops the trial state. What an evaluation gives afterwards is the
 * same to the last bit as in the RVE that the state was saved from. GH_INPUT: a size that does not fit the
 * content, values that are not finite, det F <= 0. */
GH_API gh_status gh_rve_load(gh_rve *rve, const double *state, size_t size);
/* F of the converged state, row-major; belongs to the RVE. */
GH_API const double *gh_rve_F(const gh_rve *rve);

/* Smallest eigenvalue of the symmetric part of Q_ik = A_iJkL N_J N_L over all unit N (method 7), and the
 * angle of that N. */
GH_API double gh_acoustic(const double A[16], double *angle);

#ifdef __cplusplus
}
#endif
#endif
