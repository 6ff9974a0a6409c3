/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Every configuration against its reference: errors, costs, fronts, orders. */
#include "study/judge.h"

#include <stdlib.h>

/* ---- costs ---- */

static void no_costs(study_judged *row) {
  row->wall = row->core = row->force_evaluations = row->pair_evaluations = row->factorisations =
      row->evaluations = row->iterations = row->cuts = row->jumps = NAN;
}

static void add_costs(study_judged *row, const study_run *r, double share) {
  row->wall += share * r->wall;
  row->core += share * r->core;
  row->force_evaluations += share * (double)r->force_evaluations;
  row->pair_evaluations += share * (double)r->pair_evaluations;
  row->factorisations += share * (double)r->factorisations;
  row->evaluations += share * (double)r->evaluations;
  row->iterations += share * (double)r->iterations;
  row->cuts += share * (double)r->cuts;
  row->jumps += share * (double)r->jumps;
}

/* Of two energy imbalances, which have a sign, the larger one; NAN counts for nothing. */
static double larger_imbalance(double a, double b) {
  return isnan(a) || fabs(b) > fabs(a) ? b : a;
}

/* Means over the runs that came to the end. */
static void judge_costs(const study_config *g, study_judged *row) {
  row->residual = row->energy_defect = NAN;
  for (int m = 0; m < g->nruns; m++) row->members += study_run_done(g->runs + m);
  if (row->members == 0) no_costs(row);
  for (int m = 0; m < g->nruns; m++) {
    const study_run *r = g->runs + m;
    if (!study_run_done(r)) continue;
    add_costs(row, r, 1.0 / row->members);
    row->residual = fmax(row->residual, r->residual); /* fmax passes over NAN */
    row->energy_defect = larger_imbalance(row->energy_defect, r->energy_defect);
  }
}

/* ---- fronts ---- */

/* Among the configurations that have the same reference, and so answer the same question. */
static gh_status mark_front(gh_study *s, int reference, bool by_count) {
  int n = 0, count, *index = NULL, *order = NULL;
  double *cost = NULL, *error = NULL;
  bool *front = NULL;
  gh_status status;
  size_t most = (size_t)s->nconfigs;
  GH_TRY_OR(gh_alloc(s->ctx, most, sizeof *index, &index), end);
  GH_TRY_OR(gh_alloc(s->ctx, most, sizeof *order, &order), end);
  GH_TRY_OR(gh_alloc(s->ctx, most, sizeof *cost, &cost), end);
  GH_TRY_OR(gh_alloc(s->ctx, most, sizeof *error, &error), end);
  GH_TRY_OR(gh_alloc(s->ctx, most, sizeof *front, &front), end);
  for (int k = 0; k < s->nconfigs; k++) {
    if (!study_is_rated(s, k) || s->configs[k].reference != reference) continue;
    index[n] = k;
    cost[n] = by_count ? study_count_of(s, k) : s->verdict->row[k].core;
    error[n++] = study_error_of(s, k);
  }
  GH_TRY_OR(study_front(s->ctx, n, cost, error, front, order, &count), end);
  for (int k = 0; k < n; k++) {
    study_judged *row = s->verdict->row + index[k];
    *(by_count ? &row->pareto_count : &row->pareto) = front[k];
  }
end:
  free(index);
  free(order);
  free(cost);
  free(error);
  free(front);
  return status;
}

/* ---- the whole ---- */

static gh_status judge_row(gh_study *s, int k) {
  study_judged *row = s->verdict->row + k;
  size_t n = (size_t)s->nquantities;
  GH_TRY(gh_alloc(s->ctx, 5 * n, sizeof *row->l2, &row->l2));
  row->largest = row->l2 + n, row->single = row->largest + n;
  row->confidence = row->single + n, row->chance = row->confidence + n;
  for (size_t j = 0; j < 5 * n; j++) row->l2[j] = NAN;
  row->order = NAN;
  judge_costs(s->configs + k, row);
  return study_is_reference(s, k) ? GH_OK : study_compare(s, s->configs + k, row);
}

gh_status study_judge(gh_study *s) {
  study_verdict_destroy(s);
  GH_TRY(gh_alloc(s->ctx, 1, sizeof *s->verdict, &s->verdict));
  GH_TRY(gh_alloc(s->ctx, (size_t)s->nconfigs, sizeof *s->verdict->row, &s->verdict->row));
  for (int k = 0; k < s->nconfigs; k++) GH_TRY(judge_row(s, k));
  for (int k = 0; k < s->nconfigs; k++) {
    if (!study_first_of_reference(s, k)) continue;
    GH_TRY(mark_front(s, s->configs[k].reference, false));
    if (study_counts(s) != STUDY_NOTHING) GH_TRY(mark_front(s, s->configs[k].reference, true));
  }
  return s->order >= 0 ? study_fit_orders(s) : GH_OK;
}

void study_verdict_destroy(gh_study *s) {
  if (!s->verdict) return;
  for (int k = 0; s->verdict->row && k < s->nconfigs; k++) free(s->verdict->row[k].l2);
  free(s->verdict->row);
  free(s->verdict->fits);
  free(s->verdict);
  s->verdict = NULL;
}
