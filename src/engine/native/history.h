/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the native engine keeps with friction: the converged state n, and what the pairs remember of it. */
#ifndef GRANHOM_NATIVE_HISTORY_H
#define GRANHOM_NATIVE_HISTORY_H

#include "engine/native/neighbours.h"
#include "engine/relax/relax_friction.h"
#include "granhom/engine.h"

typedef struct gh_history {
  double cell[4], *x, *theta; /* of state n */
  gh_slip *slips;             /* sorted by (i, j, image[1], image[0]) */
  size_t nslips, slip_capacity;
  gh_slip *spare; /* memory of slips to come */
  size_t spare_capacity;
  gh_pair_memory *memory; /* parallel to the pairs of the last gh_history_recall */
  size_t memory_capacity;
} gh_history;

gh_status gh_history_alloc(gh_context *ctx, gh_history *h, int n);
void gh_history_free(gh_history *h);
/* Copies the converged state of n grains; the cell only where there is one. */
gh_status gh_history_begin(gh_context *ctx, gh_history *h, int n, bool periodic, const gh_converged *state);
/* What each pair remembers: the branch vector at n (also of pairs that were apart then, method 8.11), and the
 * history of those that have one. The pairs must have their images. */
gh_status gh_history_recall(gh_context *ctx, gh_history *h, const gh_neighbours *nb);
/* State n becomes the one that a ramp has left: rotations are there already, slips come from the memory of the
 * pairs. Of contacts that are no pair any more, hardening stays (method 8.10). */
gh_status gh_history_store(gh_context *ctx, gh_history *h, const gh_neighbours *nb, int n, const double *x,
                           const double cell[4]);

#endif
