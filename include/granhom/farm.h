/* granhom: a batch of material points; the seam between the macro problem and what stands in for a material
 * law. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_FARM_H
#define GRANHOM_FARM_H

#include "granhom/micro.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gh_farm gh_farm;

/* A material point: state n, and a trial state that commit makes state n. The contract of gh_rve_*. */
typedef struct gh_point_ops {
  gh_status (*evaluate)(void *point, const double F[4], unsigned want, double P[4], double A[16]);
  gh_status (*commit)(void *point);
  gh_status (*revert)(void *point);
  void (*destroy)(void *point);
} gh_point_ops;

/* A farm of n points of any kind; takes the points over (also when it fails). */
gh_status gh_farm_create(gh_context *ctx, int n, const gh_point_ops *ops, void **points, gh_farm **farm);
/* A farm of n RVEs of the same packing, each its own. */
gh_status gh_farm_create_rves(gh_context *ctx, int n, const gh_packing *packing,
                              const gh_rve_options *options, gh_farm **farm);
void gh_farm_destroy(gh_farm **farm);
int gh_farm_size(const gh_farm *farm);
/* stop(data) is asked before each point of an evaluation; once it says true, the evaluation ends with
 * GH_STOPPED, and the trial states are those of a failed evaluation: to be reverted. NULL: never. */
void gh_farm_set_stop(gh_farm *farm, bool (*stop)(void *data), void *data);

/* F: n x 4 (row-major 2x2). Fills P (n x 4) and, where wanted, A (n x 16, index iJkL). Trial state only:
 * every evaluation starts from the converged state. A failure names the point ("integration point 17: ...",
 * counted from 0). */
gh_status gh_farm_evaluate(gh_farm *farm, const double *F, unsigned want, double *P, double *A);
gh_status gh_farm_commit(gh_farm *farm); /* trial state becomes the converged state */
gh_status gh_farm_revert(gh_farm *farm); /* trial state is dropped */

/* Measures of the last evaluation of a point; NULL when the farm is not made of RVEs. */
const gh_rve_measures *gh_farm_measure(const gh_farm *farm, int point);
/* The RVE itself (to look at it); NULL when the farm is not made of RVEs. */
gh_rve *gh_farm_rve(gh_farm *farm, int point);
void gh_farm_costs(const gh_farm *farm, gh_rve_cost *sum);

#ifdef __cplusplus
}
#endif
#endif
