/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One packing along a path, by granhom or by another program. */
#include "granhom/limits.h"
#include "study/parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 9 };
/* Of other programs: as `granhom crosscheck` has them. */
enum { STEPS_A_ROW = 50 };
static const double LONGEST = 3600; /* seconds for a path */

bool study_stopped(const study_stop *stop) {
  return stop && stop->asked && stop->asked(stop->data);
}

gh_status study_curve_add(gh_context *ctx, study_curve *c, size_t *capacity, int ncolumns, double t,
                          const double *value) {
  const size_t columns = (size_t)ncolumns, need = (size_t)c->n + 1;
  size_t times = *capacity, values = *capacity;
  GH_TRY(gh_grow(ctx, need, sizeof *c->t, &times, &c->t));
  GH_TRY(gh_grow(ctx, need, columns * sizeof *c->value, &values, &c->value));
  *capacity = times < values ? times : values;
  c->t[c->n] = t;
  memcpy(c->value + (size_t)c->n * columns, value, columns * sizeof *value);
  c->n++;
  return GH_OK;
}

/* ---- granhom ---- */

typedef struct walk {
  study_problem *p;
  const study_stop *stop;
  study_run *run;
  gh_rve *rve;
  size_t capacity;
  gh_rve_balance balance;
  bool warned; /* of overlaps */
} walk;

static void walk_count(void *data, const gh_rve_measures *m) {
  walk *w = data;
  gh_rve_balance_add(&w->balance, m);
  w->run->residual = w->balance.residual;
  w->run->energy_defect = gh_rve_balance_defect(&w->balance);
}

static gh_status walk_reach(walk *w, const double from[4], const double to[4]) {
  gh_rve_way way = {.count = walk_count, .data = w};
  memcpy(way.from, from, sizeof way.from);
  memcpy(way.to, to, sizeof way.to);
  gh_status status = gh_rve_reach(w->rve, &way, NULL);
  w->run->cuts += way.cuts;
  GH_TRY(status);
  GH_TRY(gh_limits_check(w->p->ctx, &w->p->rve, gh_rve_measure(w->rve), "the packing", &w->warned));
  return gh_rve_commit(w->rve);
}

static gh_status walk_add_row(walk *w, double t) {
  const gh_rve_measures *m = gh_rve_measure(w->rve);
  double value[COLUMNS];
  memcpy(value, m->P, 4 * sizeof *value);
  memcpy(value + 4, m->cauchy, 4 * sizeof *value);
  value[8] = m->energy;
  return study_curve_add(w->p->ctx, &w->run->curve, &w->capacity, COLUMNS, t, value);
}

static gh_status walk_rows(walk *w) {
  const study_path *path = &w->p->path;
  for (int k = 0; k < path->rows; k++) {
    const double *to = path->F + 4 * k, *from = k ? to - 4 : to;
    if (study_stopped(w->stop)) return gh_fail(w->p->ctx, GH_STOPPED, "stopped on request");
    gh_status status = walk_reach(w, from, to);
    if (status == GH_OK) status = walk_add_row(w, path->t[k]);
    if (status != GH_OK) return gh_prefix(w->p->ctx, status, "t = %.6g: ", path->t[k]);
  }
  return GH_OK;
}

static gh_status walk_path(study_problem *p, const study_stop *stop, study_run *run) {
  walk w = {.p = p, .stop = stop, .run = run};
  gh_rve_cost cost = {0};
  GH_TRY(gh_rve_create(p->ctx, p->packing, &p->rve, &w.rve));
  run->residual = 0;
  gh_status status = walk_rows(&w);
  gh_rve_costs(w.rve, &cost);
  run->force_evaluations = cost.steps;
  run->pair_evaluations = cost.pairs;
  run->factorisations = cost.factorisations;
  run->evaluations = cost.evaluations;
  gh_rve_destroy(&w.rve);
  return status;
}

/* ---- other programs ---- */

/* The Cauchy stress of a row, and P = J s F^-T. They report no energy. */
static gh_status add_peer_row(study_problem *p, study_run *run, size_t *capacity, int k,
                              const gh_peer_row *row) {
  const double *F = p->path.F + 4 * k, J = gh_det2(F);
  double inverse[4], value[COLUMNS];
  gh_inv2(F, inverse);
  const double transposed[4] = {inverse[0], inverse[2], inverse[1], inverse[3]};
  gh_mul2(row->cauchy, transposed, value);
  for (int c = 0; c < 4; c++) value[c] *= J, value[4 + c] = row->cauchy[c];
  value[8] = NAN;
  run->force_evaluations += row->steps;
  run->residual = fmax(run->residual, row->residual);
  return study_curve_add(p->ctx, &run->curve, capacity, COLUMNS, p->path.t[k], value);
}

static gh_status peer_end(study_problem *p, const gh_peer_result *r) {
  static const gh_status statuses[] = {[GH_PEER_DONE] = GH_OK,
                                       [GH_PEER_MISSING] = GH_SYSTEM,
                                       [GH_PEER_UNABLE] = GH_INPUT,
                                       [GH_PEER_FAILED] = GH_DIVERGED,
                                       [GH_PEER_STOPPED] = GH_DIVERGED};
  if (r->end == GH_PEER_DONE) return GH_OK;
  return gh_fail(p->ctx, statuses[r->end], "%s, after %d rows: %s", gh_peer_end_text(r->end), r->rows,
                 r->message);
}

static gh_status peer_run(study_problem *p, double *x, gh_peer_row *row, study_run *run) {
  const gh_packing *packing = p->packing;
  size_t capacity = 0;
  gh_peer_result result;
  for (int i = 0; i < 2 * packing->n; i++) x[i] = packing->x[i] - packing->low[i % 2];
  gh_peer_problem problem = {.n = packing->n,
                             .radius = packing->radius,
                             .x = x,
                             .law = p->rve.law,
                             .rows = p->path.rows,
                             .F = p->path.F,
                             .tolerance = p->rve.tolerance,
                             .max_steps = gh_rve_step_limit(&p->rve),
                             .steps_per_row = STEPS_A_ROW,
                             .seconds = LONGEST};
  memcpy(problem.cell, packing->cell, sizeof problem.cell);
  GH_TRY(gh_peer_run(p->ctx, (gh_peer_kind)p->peer, &problem, row, &result));
  run->residual = 0;
  for (int k = 0; k < result.rows; k++) GH_TRY(add_peer_row(p, run, &capacity, k, row + k));
  return peer_end(p, &result);
}

static gh_status peer_follow(study_problem *p, study_run *run) {
  double *x = NULL;
  gh_peer_row *row = NULL;
  if (p->rve.boundary != GH_PERIODIC)
    return gh_fail(p->ctx, GH_INPUT, "%s relaxes all grains of a periodic cell: the boundary cannot be %s",
                   p->peer == GH_PEER_LAMMPS ? "gran" : "liggghts", gh_boundary_name(p->rve.boundary));
  gh_status status = gh_alloc(p->ctx, 2 * (size_t)p->packing->n, sizeof *x, &x);
  if (status == GH_OK) status = gh_alloc(p->ctx, (size_t)p->path.rows, sizeof *row, &row);
  if (status == GH_OK) status = peer_run(p, x, row, run);
  free(x);
  free(row);
  return status;
}

gh_status study_follow(study_problem *p, const study_stop *stop, study_run *run) {
  return p->peer == STUDY_NO_PEER ? walk_path(p, stop, run) : peer_follow(p, run);
}
