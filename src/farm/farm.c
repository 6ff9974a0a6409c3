/* A batch of material points. SPDX-License-Identifier: GPL-2.0-or-later */
#include "granhom/farm.h"

#include <stdlib.h>

struct gh_farm {
  gh_context *ctx;
  int n;
  gh_point_ops ops;
  void **points;
  bool rves;
  bool (*stop)(void *data);
  void *stop_data;
};

void gh_farm_destroy(gh_farm **farm) {
  if (!farm || !*farm) return;
  gh_farm *f = *farm;
  for (int k = 0; k < f->n; k++)
    if (f->points[k]) f->ops.destroy(f->points[k]);
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

static gh_status rve_evaluate(void *p, const double F[4], unsigned want, double P[4], double A[16]) {
  return gh_rve_evaluate(p, F, want, P, A);
}
static gh_status rve_commit(void *p) {
  return gh_rve_commit(p);
}
static gh_status rve_revert(void *p) {
  return gh_rve_revert(p);
}
static void rve_destroy(void *p) {
  gh_rve *rve = p;
  gh_rve_destroy(&rve);
}

gh_status gh_farm_create_rves(gh_context *ctx, int n, const gh_packing *packing,
                              const gh_rve_options *options, gh_farm **farm) {
  static const gh_point_ops ops = {rve_evaluate, rve_commit, rve_revert, rve_destroy};
  *farm = NULL;
  gh_farm *f = NULL;
  gh_status status;
  if (n < 1) return gh_fail(ctx, GH_INPUT, "a farm needs at least one point, not %d", n);
  GH_TRY_OR(gh_alloc(ctx, 1, sizeof *f, &f), failed);
  *f = (gh_farm){.ctx = ctx, .ops = ops, .rves = true};
  GH_TRY_OR(gh_alloc(ctx, (size_t)n, sizeof *f->points, &f->points), failed);
  f->n = n;
  for (int k = 0; k < n; k++) {
    gh_rve *rve;
    GH_TRY_OR(gh_rve_create(ctx, packing, options, &rve), failed);
    f->points[k] = rve;
  }
  *farm = f;
  return GH_OK;
failed:
  gh_farm_destroy(&f);
  return status;
}

int gh_farm_size(const gh_farm *f) {
  return f->n;
}

void gh_farm_set_stop(gh_farm *f, bool (*stop)(void *data), void *data) {
  f->stop = stop;
  f->stop_data = data;
}

gh_status gh_farm_evaluate(gh_farm *f, const double *F, unsigned want, double *P, double *A) {
  for (int k = 0; k < f->n; k++) {
    if (f->stop && f->stop(f->stop_data)) return gh_fail(f->ctx, GH_STOPPED, "stopped on request");
    gh_status s = f->ops.evaluate(f->points[k], F + 4 * k, want, P + 4 * k, A ? A + 16 * k : NULL);
    if (s != GH_OK) return gh_prefix(f->ctx, s, "integration point %d: ", k);
  }
  return GH_OK;
}

static gh_status for_all(gh_farm *f, gh_status (*act)(void *)) {
  for (int k = 0; k < f->n; k++) {
    gh_status s = act(f->points[k]);
    if (s != GH_OK) return gh_prefix(f->ctx, s, "integration point %d: ", k);
  }
  return GH_OK;
}

gh_status gh_farm_commit(gh_farm *f) {
  return for_all(f, f->ops.commit);
}
gh_status gh_farm_revert(gh_farm *f) {
  return for_all(f, f->ops.revert);
}

gh_rve *gh_farm_rve(gh_farm *f, int point) {
  return f->rves && point >= 0 && point < f->n ? f->points[point] : NULL;
}

const gh_rve_measures *gh_farm_measure(const gh_farm *f, int point) {
  return f->rves && point >= 0 && point < f->n ? gh_rve_measure(f->points[point]) : NULL;
}

void gh_farm_costs(const gh_farm *f, gh_rve_cost *sum) {
  *sum = (gh_rve_cost){0};
  if (!f->rves) return;
  for (int k = 0; k < f->n; k++) {
    gh_rve_cost c;
    gh_rve_costs(f->points[k], &c);
    sum->set += c.set, sum->relax += c.relax, sum->contacts += c.contacts, sum->factorise += c.factorise,
        sum->total += c.total, sum->history += c.history;
    sum->evaluations += c.evaluations, sum->steps += c.steps, sum->factorisations += c.factorisations,
        sum->analyses += c.analyses;
  }
}
