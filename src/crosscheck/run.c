/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A peer along a path, and all programs along all paths of a cross-check. */
#include "crosscheck/crosscheck.h"
#include "crosscheck/peers.h"

#include <stdlib.h>
#include <string.h>

gh_status gh_peer_run(gh_context *ctx, gh_peer_kind kind, const gh_peer_problem *problem, gh_peer_row *row,
                      gh_peer_result *result) {
  *result = (gh_peer_result){0};
  GH_TRY(gh_peer_check(ctx, problem));
  double start = gh_seconds();
  gh_status status = kind == GH_PEER_LAMMPS ? peer_lammps(ctx, problem, row, result)
                                            : peer_liggghts(ctx, problem, row, result);
  result->seconds = gh_seconds() - start;
  return status;
}

/* ---- path ---- */

static gh_status path_subdivide(const gh_crosscheck *c, int substeps, cross_path *sub) {
  double before[4] = {1, 0, 0, 1};
  const size_t rows = (size_t)c->o.rows;
  GH_TRY(gh_alloc(c->ctx, rows * (size_t)substeps, 4 * sizeof(double), &sub->F));
  GH_TRY(gh_alloc(c->ctx, rows, sizeof(int), &sub->of_row));
  for (int row = 0; row < c->o.rows; row++) {
    const double *F = c->o.F + 4 * row;
    int n = memcmp(F, before, sizeof before) == 0 ? 1 : substeps;
    for (int k = 1; k <= n; k++)
      for (int q = 0; q < 4; q++)
        sub->F[4 * (sub->rows + k - 1) + q] = k == n ? F[q] : before[q] + (F[q] - before[q]) * k / n;
    sub->rows += n;
    sub->of_row[row] = sub->rows - 1;
    memcpy(before, F, sizeof before);
  }
  return GH_OK;
}

/* ---- runs ---- */

static void row_set(const gh_rve_measures *m, gh_peer_row *row) {
  *row = (gh_peer_row){
      .contacts = m->contacts, .mean_force = m->mean_force, .residual = m->residual, .steps = m->steps};
  memcpy(row->cauchy, m->cauchy, sizeof row->cauchy);
}

static gh_status path_walk(gh_rve *rve, const cross_path *path, cross_trace *t) {
  double P[4];
  for (int k = 0; k < path->rows; k++) {
    GH_TRY(gh_rve_evaluate(rve, path->F + 4 * k, 0, P, NULL));
    row_set(gh_rve_measure(rve), t->rows + k);
    GH_TRY(gh_rve_commit(rve));
    t->result.rows++;
  }
  return GH_OK;
}

static gh_status granhom_run(gh_crosscheck *c, cross_level *level, cross_trace *t) {
  gh_rve *rve = NULL;
  gh_rve_options options = c->o.rve;
  double start = gh_seconds();
  options.engine = cross_engines[t->engine].engine;
  gh_status status = gh_rve_create(c->ctx, c->o.packing, &options, &rve);
  if (status == GH_OK) status = path_walk(rve, &level->path, t);
  gh_rve_destroy(&rve);
  t->result.seconds = gh_seconds() - start;
  if (status == GH_DIVERGED || status == GH_ENGINE || status == GH_INTERNAL) { /* a result of its own */
    t->result.end = GH_PEER_FAILED;
    snprintf(t->result.message, sizeof t->result.message, "row %d: %s", t->result.rows, gh_message(c->ctx));
    status = GH_OK;
  }
  return status;
}

/* The problem of the other programs; x is freed by the caller. */
static gh_status problem_set(const gh_crosscheck *c, const cross_level *level, gh_peer_problem *problem,
                             double **x) {
  const gh_packing *p = c->o.packing;
  GH_TRY(gh_alloc(c->ctx, 2 * (size_t)p->n, sizeof **x, x));
  for (int i = 0; i < 2 * p->n; i++) (*x)[i] = p->x[i] - p->low[i % 2];
  *problem = (gh_peer_problem){.n = p->n,
                               .radius = p->radius,
                               .x = *x,
                               .law = c->o.rve.law,
                               .rows = level->path.rows,
                               .F = level->path.F,
                               .tolerance = c->o.rve.tolerance,
                               .max_steps = c->o.rve.max_steps,
                               .steps_per_row = c->o.steps_per_row,
                               .seconds = c->o.seconds,
                               .program = c->o.liggghts};
  memcpy(problem->cell, p->cell, sizeof problem->cell);
  return GH_OK;
}

static gh_status problem_check(const gh_crosscheck *c) {
  gh_peer_problem problem;
  double *x;
  bool peers = false;
  for (int e = 0; e < c->o.engines; e++) peers = peers || cross_engines[c->o.engine[e]].peer;
  if (!peers) return GH_OK;
  GH_TRY(problem_set(c, &c->level[0], &problem, &x));
  gh_status status = gh_peer_check(c->ctx, &problem);
  free(x);
  return status;
}

static gh_status peer_run(gh_crosscheck *c, cross_level *level, cross_trace *t) {
  gh_peer_problem problem;
  double *x;
  GH_TRY(problem_set(c, level, &problem, &x));
  gh_status status = gh_peer_run(c->ctx, cross_engines[t->engine].kind, &problem, t->rows, &t->result);
  free(x);
  return status;
}

/* What becomes of the program is stated in the trace; an error is returned when the input is wrong or the
 * system refuses. */
static gh_status level_run(gh_crosscheck *c, cross_level *level, int e) {
  cross_trace *t = level->trace + e;
  t->engine = c->o.engine[e];
  GH_TRY(gh_alloc(c->ctx, (size_t)level->path.rows, sizeof *t->rows, &t->rows));
  return cross_engines[t->engine].peer ? peer_run(c, level, t) : granhom_run(c, level, t);
}

/* ---- all of it ---- */

gh_status gh_crosscheck_create(gh_context *ctx, const gh_crosscheck_options *options, gh_crosscheck **c) {
  gh_status status = GH_OK;
  GH_TRY(gh_alloc(ctx, 1, sizeof **c, c));
  (*c)->ctx = ctx;
  (*c)->o = *options;
  for (int k = 0; k < options->levels && status == GH_OK; k++) {
    (*c)->level[k].substeps = 1 << k;
    status = path_subdivide(*c, 1 << k, &(*c)->level[k].path);
  }
  if (status == GH_OK) status = problem_check(*c);
  if (status != GH_OK) gh_crosscheck_destroy(c);
  return status;
}

void gh_crosscheck_destroy(gh_crosscheck **c) {
  if (!*c) return;
  for (int k = 0; k < (*c)->o.levels; k++) {
    free((*c)->level[k].path.F);
    free((*c)->level[k].path.of_row);
    for (int e = 0; e < (*c)->o.engines; e++) free((*c)->level[k].trace[e].rows);
  }
  free(*c);
  *c = NULL;
}

/* What is there is written after each run: those to come may take long. */
gh_status gh_crosscheck_run(gh_crosscheck *c, const char *folder) {
  gh_work work;
  int done = 0;
  gh_work_begin(c->ctx, &work, "crosscheck", "runs", c->o.levels * c->o.engines);
  for (int k = 0; k < c->o.levels; k++)
    for (int e = 0; e < c->o.engines; e++) {
      GH_TRY(level_run(c, c->level + k, e));
      GH_TRY(cross_files_write(c, folder));
      gh_work_advance(c->ctx, &work, ++done);
    }
  gh_work_end(c->ctx, &work, done);
  return GH_OK;
}

gh_status gh_crosscheck_verdict(const gh_crosscheck *c) {
  for (int k = 0; k < c->o.levels; k++)
    for (int e = 0; e < c->o.engines; e++) {
      const gh_peer_result *r = &c->level[k].trace[e].result;
      if (r->end == GH_PEER_FAILED || r->end == GH_PEER_STOPPED)
        return gh_fail(c->ctx, GH_DIVERGED, "%s: %s: %s", cross_title(c, e), gh_peer_end_text(r->end),
                       r->message);
    }
  return GH_OK;
}
