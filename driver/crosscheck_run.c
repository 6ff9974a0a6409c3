/* The engines of `granhom crosscheck` along a path, and their differences. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "crosscheck.h"

#include <stdlib.h>
#include <string.h>

const cross_engine cross_engines[CROSS_ENGINES] = {
    {.word = "lammps", .title = "granhom on LAMMPS", .engine = GH_ENGINE_LAMMPS},
    {.word = "native", .title = "granhom native", .engine = GH_ENGINE_NATIVE},
    {.word = "gran", .title = "LAMMPS gran/hooke/history", .peer = true, .kind = GH_PEER_LAMMPS},
    {.word = "liggghts", .title = "LIGGGHTS hooke/stiffness", .peer = true, .kind = GH_PEER_LIGGGHTS}};

/* ---- path ---- */

gh_status cross_path_cut(gh_context *ctx, const path_rows *path, int parts, cross_path *cut) {
  double before[4] = {1, 0, 0, 1}, F[4];
  size_t rows = (size_t)path->csv->nrows;
  *cut = (cross_path){0};
  GH_TRY(gh_alloc(ctx, rows * (size_t)parts, 4 * sizeof(double), &cut->F));
  GH_TRY(gh_alloc(ctx, rows, sizeof(int), &cut->of_row));
  for (int row = 0; row < (int)rows; row++) {
    path_F(path, row, F);
    int n = memcmp(F, before, sizeof F) == 0 ? 1 : parts;
    for (int k = 1; k <= n; k++)
      for (int c = 0; c < 4; c++)
        cut->F[4 * (cut->rows + k - 1) + c] = k == n ? F[c] : before[c] + (F[c] - before[c]) * k / n;
    cut->rows += n;
    cut->of_row[row] = cut->rows - 1;
    memcpy(before, F, sizeof F);
  }
  return GH_OK;
}

void cross_path_free(cross_path *cut) {
  free(cut->F);
  free(cut->of_row);
  *cut = (cross_path){0};
}

/* ---- runs ---- */

static void take_row(const gh_rve_measures *m, gh_peer_row *row) {
  *row = (gh_peer_row){
      .contacts = m->contacts, .mean_force = m->mean_force, .residual = m->residual, .steps = m->steps};
  memcpy(row->cauchy, m->cauchy, sizeof row->cauchy);
}

static gh_status walk(gh_rve *rve, const cross_path *path, cross_trace *t) {
  double P[4];
  for (int k = 0; k < path->rows; k++) {
    GH_TRY(gh_rve_evaluate(rve, path->F + 4 * k, 0, P, NULL));
    take_row(gh_rve_measure(rve), t->rows + k);
    GH_TRY(gh_rve_commit(rve));
    t->result.rows++;
  }
  return GH_OK;
}

static gh_status run_granhom(cross_job *j, cross_level *level, cross_trace *t) {
  gh_rve *rve = NULL;
  gh_rve_options options = j->rve;
  double start = gh_seconds();
  options.engine = cross_engines[t->engine].engine;
  gh_status status = gh_rve_create(j->ctx, j->packing, &options, &rve);
  if (status == GH_OK) status = walk(rve, &level->path, t);
  gh_rve_destroy(&rve);
  t->result.seconds = gh_seconds() - start;
  if (status == GH_DIVERGED || status == GH_ENGINE || status == GH_INTERNAL) { /* a result of its own */
    t->result.end = GH_PEER_FAILED;
    snprintf(t->result.message, sizeof t->result.message, "row %d: %s", t->result.rows, gh_message(j->ctx));
    status = GH_OK;
  }
  return status;
}

/* What the other programs are asked; x is freed by the caller. */
static gh_status pose(const cross_job *j, const cross_level *level, gh_peer_problem *problem, double **x) {
  const gh_packing *p = j->packing;
  GH_TRY(gh_alloc(j->ctx, 2 * (size_t)p->n, sizeof **x, x));
  for (int i = 0; i < 2 * p->n; i++) (*x)[i] = p->x[i] - p->low[i % 2];
  *problem = (gh_peer_problem){.n = p->n,
                               .radius = p->radius,
                               .x = *x,
                               .law = j->rve.law,
                               .rows = level->path.rows,
                               .F = level->path.F,
                               .tolerance = j->rve.tolerance,
                               .max_steps = j->rve.max_steps,
                               .steps_per_row = j->steps_per_row,
                               .seconds = j->seconds,
                               .program = j->liggghts};
  memcpy(problem->cell, p->cell, sizeof problem->cell);
  return GH_OK;
}

gh_status cross_check(cross_job *j) {
  gh_peer_problem problem;
  double *x;
  bool peers = false;
  for (int e = 0; e < j->engines; e++) peers = peers || cross_engines[j->engine[e]].peer;
  if (!peers) return GH_OK;
  GH_TRY(pose(j, &j->level[0], &problem, &x));
  gh_status status = gh_peer_check(j->ctx, &problem);
  free(x);
  return status;
}

static gh_status run_peer(cross_job *j, cross_level *level, cross_trace *t) {
  gh_peer_problem problem;
  double *x;
  GH_TRY(pose(j, level, &problem, &x));
  gh_status status = gh_peer_run(j->ctx, cross_engines[t->engine].kind, &problem, t->rows, &t->result);
  free(x);
  return status;
}

gh_status cross_run(cross_job *j, cross_level *level, int e) {
  cross_trace *t = level->trace + e;
  t->engine = j->engine[e];
  GH_TRY(gh_alloc(j->ctx, (size_t)level->path.rows, sizeof *t->rows, &t->rows));
  return cross_engines[t->engine].peer ? run_peer(j, level, t) : run_granhom(j, level, t);
}

/* ---- differences ---- */

/* The row of the trace, NULL when it has not come so far. */
static const gh_peer_row *at(const cross_level *level, int e, int row) {
  const cross_trace *t = level->trace + e;
  int k = level->path.of_row[row];
  return k < t->result.rows ? t->rows + k : NULL;
}

double cross_scale(const cross_job *j, const cross_level *level, int e) {
  double scale = 0;
  for (int row = 0; row < j->path.csv->nrows; row++) {
    const gh_peer_row *a = at(level, e, row);
    for (int c = 0; a && c < 4; c++) scale = gh_max(scale, fabs(a->cauchy[c]));
  }
  return scale;
}

double cross_difference(const cross_level *level, int e, const cross_level *other, int r, int row) {
  const gh_peer_row *a = at(level, e, row), *b = at(other, r, row);
  double d = 0;
  if (!a || !b) return NAN;
  for (int c = 0; c < 4; c++) d = gh_max(d, fabs(a->cauchy[c] - b->cauchy[c]));
  return d;
}

double cross_worst(const cross_job *j, const cross_level *level, int e, const cross_level *other, int r,
                   int *row) {
  double worst = 0, scale = cross_scale(j, other, r);
  *row = 0;
  for (int k = 0; k < j->path.csv->nrows; k++) {
    double d = cross_difference(level, e, other, r, k);
    if (isnan(d)) return NAN;
    if (d > worst) worst = d, *row = k;
  }
  return scale > 0 ? worst / scale : worst;
}
