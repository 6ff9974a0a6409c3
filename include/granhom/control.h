/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: one material point under prescribed stresses and strains.
 *
 * A test of a material prescribes some components of the stress and some of the deformation: a biaxial
 * compression holds the side stress and drives the height, an undrained shear holds the volume. Here F is
 * found such that four conditions are met; one of them takes the rotation out, usually F21 = 0: what is
 * horizontal stays horizontal. */
#ifndef GRANHOM_CONTROL_H
#define GRANHOM_CONTROL_H

#include "granhom/farm.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- conditions ---- */

/* What can be prescribed. s is the Cauchy stress P F^T / det F, P the Piola stress; volume is det F, pressure
 * -(s11 + s22)/2. */
#define GH_QUANTITY_LIST(X)                                                                                  \
  X(F11)                                                                                                     \
  X(F12)                                                                                                     \
  X(F21)                                                                                                     \
  X(F22)                                                                                                     \
  X(volume)                                                                                                  \
  X(P11)                                                                                                     \
  X(P12)                                                                                                     \
  X(P21)                                                                                                     \
  X(P22)                                                                                                     \
  X(s11)                                                                                                     \
  X(s12)                                                                                                     \
  X(s22)                                                                                                     \
  X(pressure)

typedef enum gh_quantity {
#define GH_X(name) GH_QUANTITY_##name,
  GH_QUANTITY_LIST(GH_X)
#undef GH_X
      GH_QUANTITIES
} gh_quantity;

/* A linear combination of quantities, all of the deformation (F, volume) or all stresses. */
typedef struct gh_condition {
  double factor[GH_QUANTITIES];
  bool stress;
} gh_condition;

/* From words: "s11", "volume", "s22 - 0.5 s11", "F12 - F21". GH_INPUT: unknown names (the message lists the
 * known ones), stresses and deformation in one condition, no quantity left. */
GH_API gh_status gh_condition_parse(gh_context *ctx, const char *text, gh_condition *c);
/* Its value at F and P. */
GH_API double gh_condition_value(const gh_condition *c, const double F[4], const double P[4]);
/* Its derivative with respect to F (row-major), where A is dP/dF. */
GH_API void gh_condition_slope(const gh_condition *c, const double F[4], const double P[4],
                               const double A[16], double slope[4]);

/* Whether four conditions determine F near this F, in an elastic solid without stress. GH_INPUT: one follows
 * from the others, or none takes out the rotation. */
GH_API gh_status gh_conditions_check(gh_context *ctx, const gh_condition condition[4], const double F[4]);

/* ---- a point under control ---- */

typedef struct gh_control gh_control;

typedef struct gh_control_options {
  double stiffness; /* > 0: normal stiffness of the contacts (force per length), or what stands for it: scales
                       strains that stand for a lack of stress, and steps over instabilities */
  double tolerance; /* of the stress conditions, over the largest stress; default 1e-6. Conditions on the
                       deformation are met to round-off */
  int max_iterations; /* of Newton per attempt, default 20 */
  int cut_steps;      /* how often a failing increment is halved, default 6 */
  bool pass_jumps; /* default true: where no equilibrium is near (an instability, a limit load), continue by
                      servo control: see gh_control_solve */
} gh_control_options;
/* The stiffness is 0, to be set. */
GH_API gh_control_options gh_control_defaults(void);

typedef struct gh_control_report {
  int iterations;  /* evaluations of the point */
  int parts, cuts; /* substeps that the increment was met in, and bisections */
  int jumps;       /* times that servo control had to pass a discontinuity (method 6) */
  double mismatch; /* largest lack of a stress condition over the largest stress */
} gh_control_report;

/* The point stays the caller's and must outlive the control. GH_INPUT: options out of range. */
GH_API gh_status gh_control_create(gh_context *ctx, const gh_point_ops *ops, void *point,
                                   const gh_control_options *options, gh_control **control);
/* For an RVE. */
GH_API gh_status gh_control_create_rve(gh_context *ctx, gh_rve *rve, const gh_control_options *options,
                                       gh_control **control);
GH_API void gh_control_destroy(gh_control **control);
/* stop(data) is asked before each evaluation; once it returns true, what runs ends with GH_STOPPED. NULL:
 * never.
 */
GH_API void gh_control_set_stop(gh_control *control, bool (*stop)(void *data), void *data);
/* count(data) is called at each equilibrium before it is committed, while the point's measures are those of
 * it. NULL: nobody. */
GH_API void gh_control_set_count(gh_control *control, void (*count)(void *data), void *data);

/* Brings the point to F and commits: the state that control begins with. Before the first gh_control_solve.
 */
GH_API gh_status gh_control_start(gh_control *control, const double F[4]);
/* Finds F such that the four conditions have their targets, and commits. On the way they go linearly from
 * their present values. Newton's method on the mixed conditions, every evaluation from the committed state;
 * an increment that fails is halved. Where halving does not help, because of an instability the wanted
 * stress lies in the gap, or because it cannot carry more, the point continues by servo control: small steps
 * that reduce what is lacking, each of them committed, so that the packing goes through what rearranges; that
 * is counted. GH_INPUT: the conditions do not determine F, a target is not finite. GH_DIVERGED: they cannot
 * be met; the state is then the last committed one, and the message states what is lacking. */
GH_API gh_status gh_control_solve(gh_control *control, const gh_condition condition[4],
                                  const double target[4], gh_control_report *report);

/* Of the committed state. Arrays belong to the control. */
GH_API const double *gh_control_F(const gh_control *control);
GH_API const double *gh_control_P(const gh_control *control);
GH_API const double *gh_control_A(const gh_control *control);

#ifdef __cplusplus
}
#endif
#endif
