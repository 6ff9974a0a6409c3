/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A batch of material points. */
#include "farm/internal.h"

#include <stdlib.h>

void gh_farm_destroy(gh_farm **farm) {
  if (!farm || !*farm) return;
  gh_farm *f = *farm;
  for (int k = 0; f->points && k < f->n; k++)
    if (f->points[k]) f->ops.destroy(f->points[k]);
  farm_shared_destroy(&f->shared);
  free(f->points);
  free(f);
  *farm = NULL;
}

gh_status gh_farm_create(gh_context *ctx, int n, const gh_point_ops *ops, void **points, gh_farm **farm) {
  *farm = NULL;
  gh_farm *f = NULL;
  gh_status status = n < 1 ? gh_fail(ctx, GH_INPUT, "a farm needs at least one point, not %d", n)
                           : gh_alloc(ctx, 1, sizeof *f, &f);
  if (status == GH_OK) status = gh_alloc(ctx, (size_t)n, sizeof *f->points, &f->points);
  if (status != GH_OK) {
    free(f);
    for (int k = 0; k < n; k++) ops->destroy(points[k]);
    return status;
  }
  f->ctx = ctx;
  f->n = n;
  f->ops = *ops;
  for (int k = 0; k < n; k++) f->points[k] = points[k];
  *farm = f;
  return GH_OK;
}

gh_status gh_farm_create_shared(gh_context *ctx, const gh_farm_setup *setup, gh_farm **farm) {
  *farm = NULL;
  gh_farm *f;
  if (setup->n < 1) return gh_fail(ctx, GH_INPUT, "a farm needs at least one point, not %d", setup->n);
  if (setup->npackings < 1) return gh_fail(ctx, GH_INPUT, "a farm needs at least one packing");
  GH_TRY(gh_alloc(ctx, 1, sizeof *f, &f));
  *f = (gh_farm){.ctx = ctx, .n = setup->n};
  gh_status status = farm_shared_create(ctx, setup, &f->shared);
  if (status != GH_OK) gh_farm_destroy(&f);
  *farm = f;
  return status;
}

gh_status gh_farm_create_rves(gh_context *ctx, int n, const gh_packing *packing,
                              const gh_rve_options *options, gh_farm **farm) {
  const gh_farm_setup setup = {.n = n, .npackings = 1, .packings = &packing, .rve = *options};
  return gh_farm_create_shared(ctx, &setup, farm);
}

int gh_farm_size(const gh_farm *f) {
  return f->n;
}

void gh_farm_set_stop(gh_farm *f, bool (*stop)(void *data), void *data) {
  f->stop = stop;
  f->stop_data = data;
  if (f->shared) f->shared->stop = stop, f->shared->stop_data = data;
}

gh_status gh_farm_evaluate(gh_farm *f, const double *F, unsigned want, double *P, double *A) {
  if (f->shared) return farm_shared_evaluate(f->shared, F, want, P, A);
  for (int k = 0; k < f->n; k++) {
    if (f->stop && f->stop(f->stop_data)) return gh_fail(f->ctx, GH_STOPPED, "stopped on request");
    gh_status s = f->ops.evaluate(f->points[k], F + 4 * k, want, P + 4 * k, A ? A + 16 * k : NULL);
    if (s != GH_OK) return gh_prefix(f->ctx, s, "integration point %d: ", k);
  }
  return GH_OK;
}

static gh_status points_for_all(gh_farm *f, gh_status (*act)(void *)) {
  for (int k = 0; k < f->n; k++) {
    gh_status s = act(f->points[k]);
    if (s != GH_OK) return gh_prefix(f->ctx, s, "integration point %d: ", k);
  }
  return GH_OK;
}

gh_status gh_farm_commit(gh_farm *f) {
  if (!f->shared) return points_for_all(f, f->ops.commit);
  farm_books_commit(&f->shared->books);
  return GH_OK;
}

gh_status gh_farm_revert(gh_farm *f) {
  if (!f->shared) return points_for_all(f, f->ops.revert);
  f->shared->books.trial = false;
  farm_books_forget(&f->shared->books);
  return GH_OK;
}

void gh_farm_keep(gh_farm *f) {
  if (f->shared) farm_books_keep(&f->shared->books);
}

/* ---- looking at it ---- */

const gh_rve_measures *gh_farm_measure(const gh_farm *f, int point) {
  return f->shared && point >= 0 && point < f->n ? f->shared->books.measure + point : NULL;
}

gh_status gh_farm_look(gh_farm *f, int point, gh_rve_view *view) {
  if (f->shared) return farm_shared_look(f->shared, point, view);
  return gh_fail(f->ctx, GH_INPUT, "integration point %d is no RVE to inspect", point);
}

int gh_farm_packing(const gh_farm *f, int point) {
  return f->shared && point >= 0 && point < f->n ? f->shared->books.packing[point] : -1;
}

void gh_farm_costs(const gh_farm *f, gh_rve_cost *sum) {
  *sum = (gh_rve_cost){0};
  if (f->shared) farm_shared_costs(f->shared, sum);
}

void gh_farm_count(const gh_farm *f, gh_farm_counts *counts) {
  *counts = (gh_farm_counts){.ranks = 1};
  if (!f->shared) return;
  *counts = f->shared->books.counts;
  counts->ranks = f->shared->ranks;
  counts->states = farm_books_count(&f->shared->books);
  counts->residents = farm_store_residents(f->shared->store, &counts->bytes);
}
