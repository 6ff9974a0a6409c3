/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a frame of boundary grains, supports and external loads do to the forces of a relaxation.
 *
 * Masses are one, so that a constraint that is linear in the positions is kept by taking the forces' part along
 * it away: velocities are sums of such forces. */
#ifndef GRANHOM_ENGINE_RELAX_FRAME_H
#define GRANHOM_ENGINE_RELAX_FRAME_H

#include "granhom/engine.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Copies of what gh_engine_setup and gh_engine_load give; NULL: none. */
typedef struct gh_relax_frame {
  unsigned char *fixed, *edges;
  double *area, inverse[4]; /* inverse: of sum area (x) area */
  double *force, *moment;   /* external */
} gh_relax_frame;

gh_status gh_relax_frame_make(gh_context *ctx, const gh_engine_setup *setup, gh_relax_frame *frame);
void gh_relax_frame_free(gh_relax_frame *frame);
gh_status gh_relax_frame_load(gh_context *ctx, int n, const double *force, const double *moment,
                              gh_relax_frame *frame);
/* NULL where there is nothing to heed. */
const gh_relax_frame *gh_relax_frame_used(const gh_relax_frame *frame);

/* Multiplies the values of all pairs, `count` arrays of npairs numbers, by the pairs' shares. */
void gh_frame_weigh(const gh_relax_frame *frame, size_t npairs, const int *i, const int *j, int count,
                    double *const *values);
/* Forces (n x 2) and couples (n, moments over -radius; NULL: none) of contacts become those that move the grains. */
void gh_frame_act(const gh_relax_frame *frame, int n, const double *radius, double *force, double *couple);

#ifdef __cplusplus
}
#endif
#endif
