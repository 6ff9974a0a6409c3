/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One folder of files, each whole after each increment. */
#include "results/results.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static gh_status text_commit(gh_results *r, gh_text *text, const char *name) {
  char *path;
  GH_TRY(results_path(r, name, &path));
  gh_status status = gh_text_commit(text, path);
  free(path);
  return status;
}

/* ---- the whole ---- */

static gh_status record_write(gh_results *r, const char *state, const char *message, bool ended) {
  gh_text *text;
  char blas[GH_BLAS_SIZE];
  gh_outcome outcome = {
      .status = state, .message = message, .started = r->started, .blas = blas, .ended = ended};
  GH_TRY(gh_blas(r->ctx, blas, sizeof blas));
  GH_TRY(gh_text_create(r->ctx, &text));
  gh_status status = r->solver->record(r->solver->data, &outcome, text);
  if (status == GH_OK) status = text_commit(r, text, "run.json");
  gh_text_destroy(&text);
  return status;
}

static gh_status xdmf_write(gh_results *r, const gh_text *steps, const char *name) {
  gh_text *whole;
  GH_TRY(gh_text_create(r->ctx, &whole));
  results_xdmf_begin(whole);
  gh_text_join(whole, steps);
  results_xdmf_end(whole);
  gh_status status = text_commit(r, whole, name);
  gh_text_destroy(&whole);
  return status;
}

/* A file of a run before, perhaps of another mesh. */
static gh_status old_remove(gh_results *r, const char *name) {
  char *path;
  GH_TRY(results_path(r, name, &path));
  gh_status status = gh_file_remove(r->ctx, path);
  free(path);
  return status;
}

static void history_header(gh_results *r) {
  gh_terms_header(r->history, results_history_columns, ",");
  for (int k = 0; k < r->solver->ncolumns; k++) gh_text_print(r->history, ",%s", r->solver->columns[k].name);
  gh_text_print(r->history, "\n");
}

static gh_status folder_begin(gh_results *r) {
  if (r->begun) return GH_OK;
  GH_TRY(gh_folder_make(r->ctx, r->folder));
  history_header(r);
  static const char *const old[] = {"rves.h5",    "traces.h5",    "checkpoint.h5",
                                    "results.h5", "results.xdmf", "points.xdmf"};
  size_t count = sizeof old / sizeof *old; /* the last three are replaced by the first increment */
  for (size_t k = 0; k < (gh_h5_available() ? 3 : count); k++) GH_TRY(old_remove(r, old[k]));
  r->begun = true;
  return record_write(r, "running", NULL, false);
}

/* ---- rows ---- */

void gh_results_residual(gh_results *r, const gh_residual_row *q) {
  gh_text_print(r->convergence, "%d,%d,%d,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", q->counter, q->substep,
                q->iteration, q->residual, q->relative, q->first, q->step_length, q->kinetic, q->seconds);
}

/* GH_DIVERGED: a column that must be finite is not; the message names it. */
static gh_status row_check(const gh_results *r) {
  for (int k = 0; k < r->solver->ncolumns; k++)
    if (!r->solver->columns[k].may_be_nan && !isfinite(r->value[k]))
      return gh_fail(r->ctx, GH_DIVERGED, "history.csv: %s is %g: the increment is not written",
                     r->solver->columns[k].name, r->value[k]);
  return GH_OK;
}

/* What depends on the machine or on chance stands in timing.csv: history.csv is the same whenever the scene
 * is. */
static gh_status row_write(gh_results *r, const gh_frame *f) {
  gh_text *t = r->history;
  GH_TRY(r->solver->row(r->solver->data, f, r->value));
  GH_TRY(row_check(r));
  gh_text_print(t, "%d,%d,", f->counter, f->increment);
  for (const char *c = f->name; *c; c++)
    gh_text_print(t, "%c", *c == ',' || *c == '"' || *c == '\n' ? '_' : *c);
  gh_text_print(t, ",%d,%.17g", f->step, f->time);
  for (int k = 0; k < r->solver->ncolumns; k++) gh_text_print(t, ",%.17g", r->value[k]);
  gh_text_print(t, "\n");
  gh_text_print(r->timing, "%d,%.17g,%.17g,%ld,%ld,%ld,%d\n", f->counter, f->seconds, f->micro_seconds,
                f->evaluations, f->computed, f->moved, f->ranks);
  return GH_OK;
}

/* ---- the whole ---- */

static gh_status tables_write(gh_results *r) {
  GH_TRY(text_commit(r, r->history, "history.csv"));
  GH_TRY(text_commit(r, r->timing, "timing.csv"));
  return text_commit(r, r->convergence, "convergence.csv");
}

/* results.h5 comes first: the others may then refer to what is in it. */
static gh_status fields_write(gh_results *r, const gh_frame *f) {
  GH_TRY(results_write_fields(r, f));
  GH_TRY(results_write_rves(r, f));
  results_xdmf_step(r->xdmf, r->solver, f);
  GH_TRY(xdmf_write(r, r->xdmf, "results.xdmf"));
  results_xdmf_points(r->points_xdmf, r->solver, f);
  return xdmf_write(r, r->points_xdmf, "points.xdmf");
}

gh_status gh_results_write(gh_results *r, const gh_frame *f) {
  GH_TRY(folder_begin(r));
  size_t rows;
  gh_text_get(r->history, &rows);
  gh_status status = row_write(r, f);
  if (status == GH_OK && gh_h5_available()) status = fields_write(r, f);
  if (status == GH_OK) {
    r->frames++;
    status = results_write_dumps(r, f);
  }
  if (status == GH_OK) return tables_write(r);
  gh_text_cut(r->history, rows); /* rows are of whole increments */
  return status;
}

gh_status gh_results_close(gh_results *r, const char *state, const char *message, bool wrong_input) {
  if (wrong_input && !r->begun) return GH_OK;
  GH_TRY(folder_begin(r));
  GH_TRY(tables_write(r));
  return record_write(r, state, message, true);
}

/* Numbers of the largest field, or of a row. */
static size_t scratch_size(const gh_results *r) {
  const gh_solver_results *s = r->solver;
  size_t most = (size_t)s->ncolumns;
  for (int k = 0; k < s->nfields; k++) {
    const gh_field *f = s->fields + k;
    const size_t n = results_field_rows(r, f) * (size_t)f->components;
    if (n > most) most = n;
  }
  return most;
}

static gh_status texts_create(gh_results *r) {
  GH_TRY(gh_text_create(r->ctx, &r->history));
  GH_TRY(gh_text_create(r->ctx, &r->convergence));
  GH_TRY(gh_text_create(r->ctx, &r->timing));
  GH_TRY(gh_text_create(r->ctx, &r->xdmf));
  GH_TRY(gh_text_create(r->ctx, &r->points_xdmf));
  gh_terms_header(r->timing, results_timing_columns, ",");
  gh_text_print(r->timing, "\n");
  gh_terms_header(r->convergence, results_convergence_columns, ",");
  gh_text_print(r->convergence, "\n");
  return GH_OK;
}

gh_status gh_results_create(gh_context *ctx, const gh_solver_results *solver, const char *folder,
                            gh_results **results) {
  GH_TRY(gh_alloc(ctx, 1, sizeof **results, results));
  gh_results *r = *results;
  r->ctx = ctx, r->solver = solver, r->points = 4 * solver->mesh->nelements;
  r->folder = strdup(folder);
  gh_status status = r->folder ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK) status = texts_create(r);
  if (status == GH_OK) status = gh_alloc(ctx, scratch_size(r), sizeof *r->value, &r->value);
  if (status != GH_OK) {
    gh_results_destroy(results);
    return status;
  }
  time_t now = time(NULL);
  struct tm utc;
  if (gmtime_r(&now, &utc)) strftime(r->started, sizeof r->started, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return GH_OK;
}

/* ---- continuing from a checkpoint ---- */

void results_texts(const gh_results *r, results_text list[RESULTS_TEXTS]) {
  const results_text all[RESULTS_TEXTS] = {{"history", r->history},
                                           {"convergence", r->convergence},
                                           {"timing", r->timing},
                                           {"xdmf", r->xdmf},
                                           {"points_xdmf", r->points_xdmf}};
  memcpy(list, all, sizeof all);
}

/* results.h5 must hold the increments up to the checkpoint; what came behind them goes. */
static gh_status h5_cut(gh_h5 *file, int frames) {
  char name[32];
  size_t rows, cols;
  bool there = true;
  snprintf(name, sizeof name, "/step%04d/time", frames - 1);
  if (frames > 0) GH_TRY(gh_h5_size(file, name, &rows, &cols));
  for (int k = frames; there; k++) {
    snprintf(name, sizeof name, "/step%04d", k);
    GH_TRY(gh_h5_remove(file, name, &there));
  }
  return GH_OK;
}

gh_status results_resume(gh_results *r, int frames) {
  char *path;
  gh_h5 *file = NULL;
  bool there;
  GH_TRY(results_path(r, "results.h5", &path));
  gh_status status = gh_file_there(r->ctx, path, &there);
  if (status == GH_OK && !there) status = gh_fail(r->ctx, GH_INPUT, "%s: %s", path, strerror(ENOENT));
  if (status == GH_OK) status = gh_h5_open(r->ctx, path, gh_results_kind("results.h5"), true, &file);
  free(path);
  GH_TRY(status);
  status = h5_cut(file, frames);
  if (status == GH_OK) status = gh_h5_commit(&file);
  else gh_h5_close(&file);
  r->frames = frames;
  r->begun = true;
  return status;
}

void gh_results_destroy(gh_results **results) {
  if (!results || !*results) return;
  gh_results *r = *results;
  gh_text_destroy(&r->history);
  gh_text_destroy(&r->convergence);
  gh_text_destroy(&r->timing);
  gh_text_destroy(&r->xdmf);
  gh_text_destroy(&r->points_xdmf);
  free(r->folder);
  free(r->dump_end);
  free(r->value);
  free(r);
  *results = NULL;
}
