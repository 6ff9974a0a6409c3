/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: a batch of material points; the seam between the macro problem and what stands in for a material
 * law. */
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
  gh_status (*keep)(void *point); /* as gh_rve_keep; NULL: there is nothing to keep */
} gh_point_ops;

/* A farm of n points of any kind; takes the points over (also when it fails). */
GH_API gh_status gh_farm_create(gh_context *ctx, int n, const gh_point_ops *ops, void **points,
                                gh_farm **farm);

/* A farm of RVEs. */
typedef struct gh_farm_setup {
  int n;                             /* material points */
  int npackings;                     /* different packings */
  const gh_packing *const *packings; /* npackings; copied */
  const int *packing_of;             /* n: packing of each point; NULL: the first for all */
  gh_rve_options rve;
  const void *comm; /* MPI_Comm * whose other ranks are in gh_farm_serve; NULL: this process alone, no MPI */
  bool no_share;    /* compute each point, also where others have the same state and the same F */
  bool no_balance;  /* leave RVEs on the rank where they began */
  int resident;     /* RVEs that a rank keeps ready to continue; 0: as many as fit into GH_FARM_BYTES */
} gh_farm_setup;
/* Memory of a rank for RVEs that are kept ready when gh_farm_setup.resident is 0. */
#define GH_FARM_BYTES 1e9

/* Points start in the state of their packing as read. Points with the same packing and the same history of F,
 * to the bit, are computed once. Neither this, nor the ranks, nor `resident` change a bit of any result.
 * GH_INPUT: options out of range, packing_of out of range. */
GH_API gh_status gh_farm_create_shared(gh_context *ctx, const gh_farm_setup *setup, gh_farm **farm);
/* The same for one packing, in this process, with sharing. */
GH_API gh_status gh_farm_create_rves(gh_context *ctx, int n, const gh_packing *packing,
                                     const gh_rve_options *options, gh_farm **farm);
GH_API void gh_farm_destroy(gh_farm **farm);
GH_API int gh_farm_size(const gh_farm *farm);
/* stop(data) is called before each point of an evaluation; once it is true, the evaluation ends with
 * GH_STOPPED, and the trial states are those of a failed evaluation: to be reverted. NULL: never. */
GH_API void gh_farm_set_stop(gh_farm *farm, bool (*stop)(void *data), void *data);

/* F: n x 4 (row-major 2x2). Fills P (n x 4) and, where required, A (n x 16, index iJkL). Trial state only:
 * every evaluation starts from the converged state, or near a trial state that was stored (gh_farm_keep). A
 * failure names the point ("integration point 17: ...", counted from 0), the first one of those that fail. */
GH_API gh_status gh_farm_evaluate(gh_farm *farm, const double *F, unsigned want, double *P, double *A);
GH_API gh_status gh_farm_commit(gh_farm *farm); /* trial state becomes the converged state */
GH_API gh_status gh_farm_revert(gh_farm *farm); /* trial state is dropped, and what gh_farm_keep stored */
/* Keeps the trial states of the last evaluation until the next commit or revert: evaluations at nearly the
 * same F start there (gh_rve_evaluate_near). Of RVEs with branches (gh_rve_has_branches), else nothing. */
GH_API void gh_farm_keep(gh_farm *farm);

/* The converged states of all points as they are now, to come back to. States never change once they are
 * written, so that this keeps references; nothing is copied or sent. To be dropped before the farm.
 * GH_INPUT: no RVEs. */
typedef struct gh_farm_mark gh_farm_mark;
GH_API gh_status gh_farm_mark_states(gh_farm *farm, gh_farm_mark **mark);
/* Trial states are dropped; measures are those of the mark. Any number of times. */
GH_API void gh_farm_return(gh_farm *farm, const gh_farm_mark *mark);
GH_API void gh_farm_drop_mark(gh_farm *farm, gh_farm_mark **mark);

/* Measures of the last evaluation of a point; NULL when the farm is not made of RVEs. */
GH_API const gh_rve_measures *gh_farm_measure(const gh_farm *farm, int point);
/* Grains and contacts of a point in its last evaluation, which must have been a success. Pointers belong to
 * the farm, valid until its next call. GH_INPUT: no RVEs, no such point, no evaluation yet. */
GH_API gh_status gh_farm_look(gh_farm *farm, int point, gh_rve_view *view);
/* Packing of a point. */
GH_API int gh_farm_packing(const gh_farm *farm, int point);
/* Where the time of all RVEs went, summed over all ranks. Zero when another rank fails to answer. */
GH_API void gh_farm_costs(const gh_farm *farm, gh_rve_cost *sum);
GH_API void gh_rve_cost_add(gh_rve_cost *sum, const gh_rve_cost *more); /* sum += more */

/* Counts since the farm was made. The first four are sums over points, as if each were computed: they do not
 * depend on ranks or sharing. */
typedef struct gh_farm_counts {
  long evaluations, steps, factorisations, pairs; /* of points: evaluations, relaxation steps,
                                                     factorisations, pair evaluations (gh_engine_cost) */
  long ramps;                                     /* with friction and free grains (gh_rve_measures) */
  long settled;                                   /* of these, to F itself */
  long newton;                                    /* evaluations without relaxation (gh_rve_measures) */
  long accepted;                                  /* evaluations accepted unconverged (gh_rve_options) */
  long computed;                                  /* evaluations done, points that share counted once */
  long moved;                                     /* states that went from rank to rank */
  int ranks, states;                              /* now: ranks; different converged states */
  int residents;                                  /* RVEs kept ready on this rank, of about `bytes` each */
  double bytes;
  double busy, longest; /* processor seconds of all evaluations, and of the busiest rank in each: busy over
                           ranks times longest is the efficiency of the distribution */
} gh_farm_counts;
GH_API void gh_farm_count(const gh_farm *farm, gh_farm_counts *counts);

/* ---- all converged states, to be written and read back ---- */

typedef struct gh_farm_image {
  int npoints, nstates;
  int *state;      /* npoints: number of the point's state; -1: packing as read */
  size_t *start;   /* nstates + 1: where each starts in data */
  double *data;    /* start[nstates] */
  int nwords;      /* doubles of one gh_rve_measures, the last rounded up */
  double *measure; /* npoints x nwords: the bytes of the measures of the last evaluation */
} gh_farm_image;
/* The caller frees with gh_farm_image_free, also after a failure. GH_INPUT: no RVEs. */
GH_API gh_status gh_farm_save(gh_farm *farm, gh_farm_image *image);
GH_API void gh_farm_image_free(gh_farm_image *image);
/* Into a farm with the same points, packings and options; trial states are dropped. The number of ranks and
 * the sharing may be others. GH_INPUT: numbers that do not fit. */
GH_API gh_status gh_farm_load(gh_farm *farm, const gh_farm_image *image);

/* ---- other ranks ---- */

/* What every rank but 0 of comm (MPI_Comm *) does: serves the farms that rank 0 makes, until gh_farm_dismiss.
 * stop(data) is called between points, and ends the evaluation on all ranks; NULL: never. A failure is
 * reported to rank 0; GH_OK also then. */
GH_API gh_status gh_farm_serve(gh_context *ctx, const void *comm, bool (*stop)(void *data), void *data);
/* Rank 0: ends gh_farm_serve on all others. */
GH_API void gh_farm_dismiss(const void *comm);

#ifdef __cplusplus
}
#endif
#endif
