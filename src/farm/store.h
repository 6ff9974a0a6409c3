/* SPDX-License-Identifier: GPL-2.0-or-later */
/* States of RVEs on one rank, and the RVEs that compute with them.
 *
 * A state is a buffer of doubles in a numbered slot. An evaluation reads one slot and writes another; what
 * stands in a slot does not change until the slot is written again. Which RVE computes is of no consequence
 * (gh_rve_load), so that a pool of them serves any number of states. */
#ifndef GRANHOM_FARM_STORE_H
#define GRANHOM_FARM_STORE_H

#include "granhom/farm.h"

enum { FARM_FRESH = -1 }; /* in place of a slot: the packing as read */

typedef struct farm_store farm_store;

/* One evaluation: from a slot (or FARM_FRESH) into another. */
typedef struct farm_task {
  int packing, from, to;
  int near;  /* slot of a trial state from `from` that may be near (gh_rve_evaluate_near), or FARM_FRESH */
  int point; /* the first integration point that waits for it */
  double F[4];
} farm_task;

typedef struct farm_answer {
  double P[4], A[16];
  double seconds; /* of this rank's processor */
  gh_rve_measures m;
} farm_answer;

/* Takes the packings over (copies, also when it fails); packings itself is copied. resident 0: by memory. */
gh_status farm_store_create(gh_context *ctx, int npackings, gh_packing **packings,
                            const gh_rve_options *options, int resident, farm_store **store);
void farm_store_destroy(farm_store **store);
/* Makes one RVE of each packing, so that wrong options show before anything is computed. */
gh_status farm_store_check(farm_store *store);
/* Starts a round of evaluations: all that are required at one time. */
void farm_store_begin(farm_store *store);
gh_status farm_store_evaluate(farm_store *store, const farm_task *task, unsigned want, farm_answer *answer);
/* The state in a slot; belongs to the store, valid until the slot is written. */
gh_status farm_store_get(farm_store *store, int slot, const double **state, size_t *size);
/* Memory of a slot for a state of that size, to be filled. */
gh_status farm_store_put(farm_store *store, int slot, size_t size, double **state);
/* Grains and contacts of an evaluation; done again where its RVE has continued. */
gh_status farm_store_look(farm_store *store, const farm_task *task, gh_rve_view *view);
/* Adds to sum. */
void farm_store_costs(const farm_store *store, gh_rve_cost *sum);
int farm_store_residents(const farm_store *store, double *bytes);

#endif
