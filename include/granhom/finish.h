/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: from hard packings to mechanics: soft grains in equilibrium, wanted fabric.
 *
 * What is made is a packing like the one that came in: same grains, another cell, other positions. */
#ifndef GRANHOM_FINISH_H
#define GRANHOM_FINISH_H

#include "granhom/io.h"
#include "granhom/micro.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the finished packing has to meet. */
typedef enum gh_finish_goal {
  GH_FINISH_OVERLAP, /* mean overlap of the contacts that carry force, over the mean radius */
  GH_FINISH_PRESSURE /* mean normal Cauchy stress, compression positive: force per length */
} gh_finish_goal;

/* What may happen to the cell on the way. */
typedef enum gh_finish_cell {
  GH_FINISH_CELL_AUTO,   /* relaxed for a pressure without a wanted anisotropy, else scaled */
  GH_FINISH_CELL_SCALED, /* it keeps its shape, but for the shears of a wanted anisotropy; the stress is
                            isotropic only in the mean */
  GH_FINISH_CELL_RELAXED /* its sides and its tilt give way until the stress is isotropic; the packing is then
                            stable against every small change of the cell under that pressure, so that the
                            smallest eigenvalue of its acoustic tensors is not negative */
} gh_finish_cell;

typedef struct gh_finish_options {
  gh_finish_goal goal;
  double target; /* > 0 */
  gh_finish_cell cell;
  gh_engine_kind engine;
  double normal_stiffness;    /* E_n > 0, force per length */
  double tolerance;           /* residual of the equilibrium (method 3) */
  double accuracy;            /* of the target, relative */
  double anisotropy;          /* wanted; NAN: as it comes */
  double anisotropy_accuracy; /* absolute */
} gh_finish_options;
/* Overlap 0.01, cell as it fits, native engine, E_n = 1, residual 1e-10, 0.5 % of the target, anisotropy as
 * it comes (else within 0.004). */
GH_API gh_finish_options gh_finish_defaults(void);
/* "overlap=X" or "pressure=P" into goal and target. GH_INPUT: other words, X or P not positive, X >= 1. */
GH_API gh_status gh_finish_parse(gh_context *ctx, const char *text, gh_finish_options *options);
/* Whether all values lie in their ranges; gh_finish asks it too. GH_INPUT with the value and its limits. */
GH_API gh_status gh_finish_check(gh_context *ctx, const gh_finish_options *options);
/* "auto", "scaled" or "relaxed"; false when the word is none of them. */
GH_API bool gh_finish_cell_from_name(const char *name, gh_finish_cell *cell);

/* A packing as it is, seen with soft grains in periodic equilibrium. Contacts are those that carry force:
 * neither grain is a rattler. */
typedef struct gh_finish_report {
  double overlap;  /* mean over contacts, over the mean radius of all grains */
  double pressure; /* - tr(cauchy)/2 */
  double cauchy[4];
  double residual; /* largest force on a grain over the mean contact force */
  double volume_fraction;
  double coordination;     /* 2 contacts / (grains - rattlers) */
  double coordination_all; /* 2 contacts / grains */
  int contacts, rattlers;
  double fabric[3];                /* mean n(x)n: xx xy yy */
  double anisotropy;               /* difference of its principal values */
  double anisotropy_angle;         /* of the larger principal value to the x axis, radians */
  double acoustic, acoustic_angle; /* smallest eigenvalue of N.A.N, periodic condition; angle of that N */
  double linear_scale;             /* sqrt(area of the cell over that of the packing that came in) */
  double strain;                   /* sum of the shear increments spent on the wanted anisotropy; 0 without */
  int evaluations;                 /* equilibria searched for */
} gh_finish_report;

/* Brings a packing of hard grains (just touching, apart, or pressed together) to a jammed state of soft
 * grains in equilibrium: the periodic cell is scaled and the grains relax until the goal is met; then, where
 * asked, the cell relaxes or is pre-strained. The radii stay. `soft` is new, its positions lie in its cell.
 * GH_INPUT: options out of range; GH_DIVERGED: the goal cannot be met (states how near it came). */
GH_API gh_status gh_finish(gh_context *ctx, const gh_packing *hard, const gh_finish_options *options,
                           gh_packing **soft, gh_finish_report *report);
/* The report of a packing in equilibrium with soft grains, in the cell as it is. Grains that are not at rest
 * relax first; their new positions are dropped. Uses engine, normal_stiffness and tolerance of the options.
 */
GH_API gh_status gh_finish_measure(gh_context *ctx, const gh_packing *packing,
                                   const gh_finish_options *options, gh_finish_report *report);
/* The report in words, a few lines. */
GH_API void gh_finish_print(const gh_finish_report *report, gh_text *out);

/* NAME.data, 7 -> NAME-007.data: the file of member k of an ensemble. Caller frees; NULL when out of memory.
 */
GH_API char *gh_ensemble_path(const char *path, int k);

#ifdef __cplusplus
}
#endif
#endif
