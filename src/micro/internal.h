/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Private parts of the RVE. */
#ifndef GRANHOM_MICRO_INTERNAL_H
#define GRANHOM_MICRO_INTERNAL_H

#include "granhom/micro.h"

/* ---- boundary conditions ---- */

typedef enum gh_condition_body {
  GH_BODY_CLUSTER, /* members are the grains of a cluster, without images */
  GH_BODY_CELL,    /* members are the primary grains, with periodic images */
  GH_BODY_FRAME /* the same, but for the copies of grains on edges under traction, which are members, too */
} gh_condition_body;
typedef enum gh_condition_fixes {
  GH_FIXES_NONE,     /* no position */
  GH_FIXES_BOUNDARY, /* members on the boundary follow F */
  GH_FIXES_ALL       /* all members follow F */
} gh_condition_fixes;
typedef struct gh_condition {
  const char *name;
  gh_condition_body body;
  gh_condition_fixes fixes;
  gh_edges edges[2]; /* of a frame: those normal to each lattice vector */
  bool servo;        /* they are met by servo-control */
} gh_condition;
/* GH_MIXED: with the edges of the options. */
gh_condition gh_condition_of(const gh_rve_options *options);
/* Whether positions are unknown at given F. */
static inline bool gh_condition_relaxes(const gh_condition *c) {
  return c->fixes != GH_FIXES_ALL;
}
/* Sets r->held: the members whose position is fixed. */
gh_status gh_condition_fix(gh_rve *r);

/* ---- frame.c: a frame of boundary grains (docs/explanation/frames.md) ---- */

/* Directions are lattice vectors; x edges are those that the first one leads to. */
typedef struct gh_rve_frame {
  bool open[2]; /* edges under traction: not periodic, copies of their grains are members */
  int n, *grain, (*image)[2], *type; /* members: primaries in order, then copies; image in lattice vectors */
  double *x, *radius;                /* n x 2, n */
  unsigned char *on;                 /* n: 1 on any edge, 0 inside */
  unsigned char *edges;              /* n: bit 2 k + s: on edge s (0 low, 1 high) of the open direction k */
  unsigned char *held;               /* n: follows F */
  unsigned char *fixed;              /* n: gh_fixed of those; NULL: none is held */
  int rank;                          /* directions that the areas span */
  double axes[4];                    /* these, and what is left */
  double *area, inverse[4];          /* n x 2: of traction, zero elsewhere; NULL: no edge is open */
  double lattice[4];                 /* of the engine's cell before the deformation */
  int corner;                        /* a grain on edges of both directions, else on any */
  /* with open edges: contacts and forces with their shares, and forces without their part along the areas */
  gh_contact *contacts;
  gh_friction *friction;
  double *force, *moment, *balance;
  size_t contact_capacity, friction_capacity;
  double *support; /* n x 3, of gh_rve_look */
} gh_rve_frame;
gh_status gh_frame_create(gh_context *ctx, const gh_packing *packing, const gh_condition *condition,
                          gh_rve_frame **frame);
void gh_frame_destroy(gh_rve_frame **frame);
static inline bool gh_frame_is_open(const gh_rve_frame *f) {
  return f && f->area;
}
/* The engine's list with the shares of contacts between copies, into the frame. */
gh_status gh_frame_share_contacts(gh_rve *r);
double gh_frame_share_of(const gh_rve_frame *f, const gh_contact *q);
/* Whether the rotation of a member is prescribed. */
static inline bool gh_frame_turns_with_F(const gh_rve_frame *f, int i) {
  return f && f->fixed && f->fixed[i] & GH_FIXED_TURN;
}
/* From the rotation of one F to that of another, in (-pi, pi]; the first and second derivative of F's. */
double gh_rotation_between(const double from[4], const double to[4]);
void gh_rotation_slope(const double F[4], double slope[4], double curvature[16]);
/* Moments of the supports of the members whose rotation is prescribed. */
double gh_frame_couple(const gh_rve *r);

/* ---- solver: the linear system of the unknowns ---- */

/* What unknowns and stiffness depend on. */
typedef struct gh_solver_input {
  const unsigned char *held;    /* members whose position is fixed; NULL: none */
  const unsigned char *fixed;   /* gh_fixed; of it GH_FIXED_TURN: members whose rotation is; NULL: none */
  const unsigned char *rattler; /* members that are left out */
  bool turns;                   /* rotations are unknown */
  bool pin;                     /* the position of one member of each connected component is left out */
  const double *radius;         /* members */
  const gh_contact_list *list;
} gh_solver_input;

typedef struct gh_solver gh_solver;
typedef struct gh_solver_ops {
  const char *name;
  gh_status (*number)(gh_context *ctx, gh_solver *s, const gh_solver_input *in);
  gh_status (*factor)(gh_context *ctx, gh_solver *s, const gh_solver_input *in, double shift, bool *good);
  gh_status (*solve)(gh_context *ctx, gh_solver *s, int ncol, const double **X);
  void (*release)(gh_solver *s); /* what the solver itself has allocated */
} gh_solver_ops;

/* The part that all solvers share; it is the first member of each. */
struct gh_solver {
  const gh_solver_ops *ops;
  int n, members; /* n: unknowns */
  int *unknown;   /* members x 3: number of u_x, u_y, theta among the unknowns; -1 when there is none */
  double *rhs;    /* n x 4, column-major */
  size_t rhs_capacity;
  long analyses, factorisations;
  long fallbacks; /* of `factorisations`: done again by another solver */
  int negative;   /* diagonal blocks of the last factor with a negative determinant; -1: not known */
};

/* Blocks of a grain each; symmetric: without friction. What a solver gives is a function of its input alone
 * (solver_block.c). */
gh_status gh_solver_block(gh_context *ctx, int members, bool symmetric, gh_solver **s);
/* What it falls back on. Without friction: positions, symmetric. With friction: positions and rotations,
 * unsymmetric. */
gh_status gh_solver_cholmod(gh_context *ctx, int members, gh_solver **s);
gh_status gh_solver_klu(gh_context *ctx, int members, gh_solver **s);
/* The same under the constraint of traction on the frame, which stays the caller's (solver_frame.c). */
gh_status gh_solver_frame(gh_context *ctx, int members, bool symmetric, const gh_rve_frame *frame,
                          gh_solver **s);
void gh_solver_destroy(gh_solver **s);
static inline bool gh_solver_turns(const gh_solver_input *in, int i) {
  return in->turns && !in->rattler[i] && !(in->fixed && in->fixed[i] & GH_FIXED_TURN);
}
/* Numbers the unknowns: positions where they are not fixed, rotations where they are unknown. */
gh_status gh_solver_number(gh_context *ctx, gh_solver *s, const gh_solver_input *in);
/* Assembles and factorises K of the contacts; `shift` is added to the diagonal, times r^2 for rotations.
 * *good: the factor can be used: K is positive definite (without friction), regular (with it). What `in`
 * points to stays as it is until the last solve with this factor. */
gh_status gh_solver_factor(gh_context *ctx, gh_solver *s, const gh_solver_input *in, double shift,
                           bool *good);
/* Solves K X = B for ncol <= 4 columns in s->rhs (column-major, s->n rows); *X is valid until the next solve.
 */
gh_status gh_solver_solve(gh_context *ctx, gh_solver *s, int ncol, const double **X);
/* Connected components of grains by contacts, without those that are marked (NULL: all count): the first
 * grain of a component, and it alone, has component[i] == i. */
void gh_find_components(int n, const gh_contact_list *list, const unsigned char *without, int *component);
/* The rows of B for end `e` (0: i, 1: j) of a contact: its unknowns v = (u_x, u_y, theta) change the branch
 * vector by sign * u and q by r * theta. */
static inline double gh_end_sign(int e) {
  return e ? 1 : -1;
}

/* ---- rattlers (Table 4.3; method 8.3) ---- */

typedef struct gh_rattlers {
  unsigned char *flag;    /* per member */
  int *start, *link;      /* contacts of each grain */
  double (*direction)[3]; /* of the contacts of one grain: unit vector, and what grows with its angle */
  size_t link_capacity, direction_capacity;
} gh_rattlers;
gh_status gh_rattlers_create(gh_context *ctx, int members, gh_rattlers **r);
void gh_rattlers_destroy(gh_rattlers **r);
/* Marks them; fixed members are never marked. mean_force: mean normal contact force. Returns their number. */
gh_status gh_rattlers_find(gh_context *ctx, gh_rattlers *r, int n, const unsigned char *held,
                           const gh_contact *contacts, int ncontacts, double mean_force, int *count);

/* With friction two contacts can hold a grain, or one: only members without any contact are marked
 * (method 8.3). Returns how many of them are not fixed. */
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

/* A state that slip counts from and that is no converged one: the end of a ramp. */
typedef struct gh_base {
  double F[4], *y, *theta; /* n x 2 positions F^-1 x, n rotations */
  double dissipated;       /* by friction since the start */
  gh_slips slips;
} gh_base;

/* A pair of grains that have touched in a Newton iteration, one of them a rattler. */
enum { LOOSE_PUSH = 5 };
typedef struct gh_loose_pair {
  int i, j;
  double reach, shift[2]; /* sum of radii; what the cell adds to x_j - x_i */
} gh_loose_pair;

struct gh_rve {
  gh_context *ctx;
  gh_rve_options options;
  gh_packing *packing;
  gh_cluster *cluster;    /* taylor and restricted */
  struct gh_servo *servo; /* NULL: no servo-control */
  gh_rve_frame *frame;    /* conditions on a frame */
  gh_engine *engine;
  gh_solver *solver; /* NULL where nothing is unknown */
  gh_rattlers *rattlers;
  int n;                 /* members: primaries, or the cluster */
  bool periodic;         /* the engine has a cell */
  bool pinned;           /* nothing else prevents a translation */
  const double *lattice; /* of that cell, before the deformation */
  bool relaxes;          /* positions of free members are unknown */
  bool turns;            /* rotations are unknown: friction, and not fixed */
  double volume;         /* of the reference cell */
  double accept_within;  /* multiple of the tolerance up to which a packing that has spent its steps is
                           accepted */
  double floor;          /* mean normal force at or below which the packing counts as unjammed */
  double mean_radius;    /* of the primary grains */
  double extent;         /* of the cell and the positions: sets round-off of the forces */
  const double *radius;
  const unsigned char *held;
  unsigned char *all_held; /* memory of `held` where all positions are prescribed */
  double *X;               /* n x 2 reference positions */
  double Fn[4];            /* converged state: F and fluctuated reference positions y = F^-1 x */
  double *yn;
  double F[4], *y; /* trial state */
  bool trial;
  double *kept; /* a trial state that was kept; of kept_size numbers, 0: none is */
  size_t kept_size, kept_capacity;
  double *thetan, *theta;          /* n: rotations of both states; NULL without friction */
  gh_slips history, trial_history; /* with friction */
  gh_base base;                    /* with friction and free grains: what slip counts from ... */
  bool based;                      /* ... if this is set, else from the converged state */
  double dissipatedn, dissipated;  /* by friction since the start, of both states */
  long uncounted;                  /* pair evaluations for the pressure of the packing as read */
  double pressuren;                /* mean pressure of the converged state; negative: not known yet */
  gh_friction *sliding;            /* list.friction of a state that a ramp has led to F */
  size_t sliding_capacity;
  bool begun;           /* the engine has the converged state */
  double shift;         /* of the coupled stiffness in this evaluation: 0 until it has turned out singular */
  double *x, *step;     /* n x 2 work: positions in space of the last evaluation, and of a Newton step */
  double *turn;         /* n work: rotations of a Newton step; NULL without friction */
  double *x0, *theta0;  /* the same, where a Newton iteration started; theta0 is NULL without friction */
  gh_loose_pair *loose; /* nloose of them, of this Newton iteration */
  int nloose;
  size_t loose_capacity;
  double *loose_push; /* n x LOOSE_PUSH work */
  int *view_grain, *view_id;
  unsigned char *view_flags;
  gh_contact_list list; /* of the last evaluation, the engine's */
  gh_rve_measures m;
  gh_rve_cost cost;
};

/* ---- state.c ---- */

/* Where the search for equilibrium starts. Where slip of that state counts from the end of a ramp, it is in
 * r->base, and r->based is set. */
typedef struct gh_start {
  const double *F, *y, *theta;
  bool near; /* at a trial state */
} gh_start;
gh_status gh_state_check(const gh_rve *rve, const double *state, size_t size);
/* From the converged state, or from the trial state `near` (NULL: none) where it is near. */
gh_status gh_state_start(gh_rve *rve, const double *near, gh_start *start);

/* ---- servo.c: servo-control of a frame ---- */

typedef struct gh_servo gh_servo;
/* Of r->frame, into r->servo. */
gh_status gh_servo_create(gh_rve *r);
void gh_servo_destroy(gh_servo **servo);
/* The frame is held, as it is when an evaluation begins. */
void gh_servo_hold(gh_rve *r);
/* As gh_rve_equilibrate; the frame counts as free afterwards. */
gh_status gh_servo_equilibrate(gh_rve *r, const gh_start *start);

/* ---- history.c ---- */

/* Gives the converged state to the engine, once, and not again before it changes. */
gh_status gh_rve_begin_increment(gh_rve *rve);
/* Slip counts from rve->base from now on. */
gh_status gh_rve_resume_base(gh_rve *rve);
/* The trial state's history and dissipation, from the current contacts. */
gh_status gh_rve_advance_history(gh_rve *rve);
/* Slips as a row of numbers. GH_INPUT: a key that is not made of integers. */
enum { GH_SLIP_NUMBERS = 7 };
void gh_slips_save(const gh_slips *slips, double *to);
gh_status gh_slips_load(gh_context *ctx, const double *from, int count, gh_slips *slips);

/* ---- contacts.c ---- */

/* Fetches contacts and forces, residual and mean force into rve->m. */
gh_status gh_rve_update_contacts(gh_rve *rve);
/* The residual that is good enough: the required one, or what round-off of the positions leaves. */
double gh_rve_target(const gh_rve *rve);
/* Unbalanced force that round-off of the positions leaves. */
double gh_rve_round_off(const gh_rve *rve);
/* Whether the forces are mostly round-off, into rve->m. */
void gh_rve_find_stress_free(gh_rve *rve);
/* Extent and smallest mean force of the packing in this cell at rve->x. */
void gh_rve_find_round_off(gh_rve *rve, const double cell[4]);
/* Marks the grains that carry nothing, into rve->rattlers and rve->m. */
gh_status gh_rve_find_rattlers(gh_rve *rve);

/* ---- newton.c ---- */

/* Factor of the stiffness at the current contacts; where it is singular and `help` is set, with a shift. */
gh_status gh_rve_factor(gh_rve *rve, bool help, bool *regular);
/* Newton from the engine's positions as long as it is safe. *done: the residual is reached. Else the engine
 * is at the last safe positions, and *again: another attempt after more relaxation is worth it. */
gh_status gh_rve_newton_finish(gh_rve *rve, bool *done, bool *again);
gh_status gh_rve_newton_regularised(gh_rve *rve, double tolerance);
/* Nothing is known yet of where rattlers have touched others. */
void gh_rve_newton_begin(gh_rve *rve);
/* The Newton step without friction from the current positions, to rve->step; *definite: with a stiffness that is
 * positive definite, else there is none. */
gh_status gh_rve_newton_direction(gh_rve *rve, bool *definite);

/* ---- follow.c ---- */

/* Newton from the start of an evaluation, where that is allowed. *reached: the engine is in equilibrium at F, as gh_rve_equilibrate
 * leaves it; else nothing is known of its positions. */
gh_status gh_rve_follow(gh_rve *rve, const gh_start *start, bool *reached);

/* ---- ramp.c ---- */

/* Whether slip is integrated along ramps. */
bool gh_rve_ramps(const gh_rve *rve);
/* The mean pressure of the converged state, where it is that of a packing as read, which no evaluation has
 * measured. */
gh_status gh_rve_find_pressure(gh_rve *rve);
/* A ramp from the converged state to the start of the last part of the increment, where the increment is longer
 * than that; *start becomes its end, which slip counts from. */
gh_status gh_rve_ramp_to_base(gh_rve *rve, gh_start *start);
/* A ramp to F itself, where the last part has no equilibrium: slip counts from its end then, which is nearer to
 * rest each time. Steps behind the ramp are taken from those that are *left. Contacts are current. */
gh_status gh_rve_ramp_to_rest(gh_rve *rve, long *left);
/* At the end of a ramp nothing has slipped yet: contacts on the Coulomb limit slide in the tangent. */
gh_status gh_rve_mark_sliding(gh_rve *rve);
/* Steps without half the residual after which the last part counts as without equilibrium; 0: it may take all. */
long gh_rve_patience(const gh_rve *rve);

/* ---- equilibrium.c, stress.c, tangent.c ---- */

/* Residual until which relaxation goes before Newton's iteration may end it. */
extern const double gh_rve_first_relaxation;
/* Finds the equilibrium at rve->F from a start, or from the positions and rotations in rve->x, theta (NULL).
 * Leaves positions, contacts and forces of the equilibrium. */
gh_status gh_rve_equilibrate(gh_rve *rve, const gh_start *start);
/* Stress, energy and the other sums over the contacts into rve->m. */
gh_status gh_rve_sums(gh_rve *rve);
/* A by static condensation; contacts and rattlers of the equilibrium are current. */
gh_status gh_rve_tangent(gh_rve *rve, double A[16]);
gh_status gh_rve_tangent_friction(gh_rve *rve, double A[16]);
/* Whether anything is unknown at given F: positions or rotations. */
static inline bool gh_rve_solves(const gh_rve *r) {
  return r->relaxes || r->turns;
}
static inline bool gh_rve_friction(const gh_rve *r) {
  return r->options.law.friction != 0;
}
static inline gh_solver_input gh_rve_solver_input(const gh_rve *r) {
  return (gh_solver_input){.held = r->held,
                           .fixed = r->frame ? r->frame->fixed : NULL,
                           .rattler = r->rattlers->flag,
                           .turns = r->turns,
                           .pin = r->pinned,
                           .radius = r->radius,
                           .list = &r->list};
}

#endif
