/* Results of a run: one folder of files, each whole after each increment.
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * results.h5      /mesh and one group per increment, /step0000 (the start) onwards
 * results.xdmf    the same for ParaView; points.xdmf: at the integration points
 * rves.h5         grains and contacts of recorded material points at the last increment; traces.h5: their
 * positions at all dumps/          the chosen material points as LAMMPS dumps history.csv, convergence.csv,
 * timing.csv, run.json checkpoint.h5   where the run can go on (checkpoint.c) */
#include "scene/checkpoint.h"
#include "scene/results.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- folder ---- */

gh_status scene_results_check(gh_context *ctx, const char *folder) {
  static const char *const files[] = {"results.h5",      "results.xdmf", "points.xdmf", "rves.h5",
                                      "traces.h5",       "history.csv",  "timing.csv",  "run.json",
                                      "convergence.csv", "checkpoint.h5"};
  GH_TRY(gh_output_folder_check(ctx, folder));
  for (size_t k = 0; k < sizeof files / sizeof *files; k++)
    GH_TRY(gh_output_within(ctx, folder, files[k], false));
  return gh_output_within(ctx, folder, "dumps", true);
}

gh_status scene_result_path(const scene_results *r, const char *name, char **path) {
  *path = gh_path_join(r->folder, name);
  return *path ? GH_OK : gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
}

static gh_status commit_text(scene_results *r, gh_text *text, const char *name) {
  char *path;
  GH_TRY(scene_result_path(r, name, &path));
  gh_status status = gh_text_commit(text, path);
  free(path);
  return status;
}

/* ---- the whole ---- */

static gh_status write_json(scene_results *r, const char *status_text, const char *message,
                            const gh_run_summary *summary) {
  gh_text *text;
  char blas[GH_BLAS_SIZE];
  GH_TRY(gh_blas(r->ctx, blas, sizeof blas));
  char *json = scene_run_json(r->scene, r->farm, blas, r->started, status_text, message, summary);
  if (!json) return gh_fail(r->ctx, GH_MEMORY, "no memory for run.json");
  gh_status status = gh_text_create(r->ctx, &text);
  if (status == GH_OK) {
    gh_text_print(text, "%s\n", json);
    status = commit_text(r, text, "run.json");
    gh_text_destroy(&text);
  }
  free(json);
  return status;
}

static gh_status write_xdmf(scene_results *r, const gh_text *steps, const char *name) {
  gh_text *whole;
  GH_TRY(gh_text_create(r->ctx, &whole));
  scene_xdmf_begin(whole);
  gh_text_join(whole, steps);
  scene_xdmf_end(whole);
  gh_status status = commit_text(r, whole, name);
  gh_text_destroy(&whole);
  return status;
}

/* A file of a run before, perhaps of another mesh. */
static gh_status remove_old(scene_results *r, const char *name) {
  char *path;
  GH_TRY(scene_result_path(r, name, &path));
  gh_status status = gh_file_remove(r->ctx, path);
  free(path);
  return status;
}

static gh_status begin(scene_results *r) {
  if (r->begun) return GH_OK;
  GH_TRY(gh_folder_make(r->ctx, r->folder));
  scene_history_header(r);
  static const char *const old[] = {"rves.h5",    "traces.h5",    "checkpoint.h5",
                                    "results.h5", "results.xdmf", "points.xdmf"};
  size_t count = sizeof old / sizeof *old; /* the last three are replaced by the first increment */
  for (size_t k = 0; k < (gh_h5_available() ? 3 : count); k++) GH_TRY(remove_old(r, old[k]));
  r->begun = true;
  return write_json(r, "running", NULL, NULL);
}

/* The number of points that carry nothing, the smallest acoustic eigenvalue, the most loaded point. */
static void look_at_points(scene_results *r) {
  const double *A = gh_macro_A(r->macro), *F = gh_macro_F(r->macro), *P = gh_macro_P(r->macro);
  double most = -1;
  r->unjammed = 0;
  r->min_acoustic = INFINITY;
  for (int p = 0; p < gh_farm_size(r->farm); p++) {
    double angle, cauchy[4], acoustic = gh_acoustic(A + 16 * p, &angle);
    const gh_rve_measures *m = gh_farm_measure(r->farm, p);
    gh_cauchy2(P + 4 * p, F + 4 * p, cauchy);
    if (m && m->unjammed) r->unjammed++;
    if (acoustic < r->min_acoustic) r->min_acoustic = acoustic, r->least_stable = p;
    if (gh_mises2(cauchy) > most) most = gh_mises2(cauchy), r->most_loaded = p;
  }
}

/* The last guard: what is not finite is no result, whatever has let it pass. */
static gh_status check_fields(const scene_results *r) {
  const size_t ndof = 2 * (size_t)r->scene->mesh->nnodes, points = (size_t)gh_farm_size(r->farm);
  const struct {
    const char *name;
    const double *value;
    size_t n;
  } all[] = {{"a displacement", gh_macro_u(r->macro), ndof},
             {"a reaction", gh_macro_reactions(r->macro), ndof},
             {"a stress", gh_macro_P(r->macro), 4 * points},
             {"a tangent", gh_macro_A(r->macro), 16 * points}};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    if (!gh_finite(all[k].value, all[k].n))
      return gh_fail(r->ctx, GH_DIVERGED, "%s is not finite: the increment is not written", all[k].name);
  return GH_OK;
}

int scene_results_unjammed(const scene_results *r, double *min_acoustic) {
  *min_acoustic = r->min_acoustic;
  return r->unjammed;
}

static gh_status write_tables(scene_results *r) {
  GH_TRY(commit_text(r, r->history, "history.csv"));
  GH_TRY(commit_text(r, r->timing, "timing.csv"));
  return commit_text(r, r->convergence, "convergence.csv");
}

/* results.h5 comes first: the others may then refer to what is in it. */
static gh_status write_fields(scene_results *r, const scene_frame *f) {
  GH_TRY(scene_write_h5(r, f));
  GH_TRY(scene_write_rves(r, f));
  scene_xdmf_step(r->xdmf, r->scene->mesh, f);
  GH_TRY(write_xdmf(r, r->xdmf, "results.xdmf"));
  scene_xdmf_points(r->points_xdmf, r->scene->mesh, f);
  return write_xdmf(r, r->points_xdmf, "points.xdmf");
}

gh_status scene_results_write(scene_results *r, const scene_frame *f) {
  if (r->folder) GH_TRY(begin(r));
  look_at_points(r);
  GH_TRY(check_fields(r));
  if (!r->folder) return GH_OK;
  size_t rows;
  gh_text_get(r->history, &rows);
  const size_t numbers = scene_history_row(r, f);
  gh_status status = gh_text_check_row(r->history, numbers, "history.csv");
  if (status == GH_OK && gh_h5_available()) status = write_fields(r, f);
  if (status == GH_OK) {
    r->frames++;
    status = scene_write_dumps(r, f);
  }
  if (status == GH_OK) return write_tables(r);
  gh_text_cut(r->history, rows); /* rows are of whole increments */
  return status;
}

gh_status scene_results_close(scene_results *r, gh_status status, const char *outcome, const char *message,
                              const gh_run_summary *summary) {
  if (!r->folder || (status == GH_INPUT && !r->begun)) return GH_OK; /* wrong input writes nothing */
  GH_TRY(begin(r));
  GH_TRY(write_tables(r));
  return write_json(r, outcome, message, summary);
}

gh_status scene_results_create(gh_scene *scene, gh_farm *farm, gh_macro *macro, const char *folder,
                               scene_results **results) {
  gh_context *ctx = scene->ctx;
  size_t points = (size_t)gh_farm_size(farm);
  gh_status status;
  GH_TRY(gh_alloc(ctx, 1, sizeof **results, results));
  scene_results *r = *results;
  r->ctx = ctx, r->scene = scene, r->farm = farm, r->macro = macro;
  r->min_acoustic = NAN;
  r->folder = folder ? strdup(folder) : NULL;
  status = r->folder || !folder ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK) status = gh_text_create(ctx, &r->history);
  if (status == GH_OK) status = gh_text_create(ctx, &r->convergence);
  if (status == GH_OK) status = gh_text_create(ctx, &r->timing);
  if (status == GH_OK) status = gh_text_create(ctx, &r->xdmf);
  if (status == GH_OK) status = gh_text_create(ctx, &r->points_xdmf);
  if (status == GH_OK) status = gh_alloc(ctx, 4 * points, sizeof *r->tensor, &r->tensor);
  if (status == GH_OK) status = gh_alloc(ctx, points, sizeof *r->scalar, &r->scalar);
  if (status != GH_OK) {
    scene_results_destroy(results);
    return status;
  }
  gh_terms_header(r->timing, scene_timing_columns, ",");
  gh_text_print(r->timing, "\n");
  gh_terms_header(r->convergence, scene_convergence_columns, ",");
  gh_text_print(r->convergence, "\n");
  time_t now = time(NULL);
  struct tm utc;
  if (gmtime_r(&now, &utc)) strftime(r->started, sizeof r->started, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return GH_OK;
}

/* ---- going on from a checkpoint ---- */

void scene_results_texts(const scene_results *r, scene_text list[SCENE_TEXTS]) {
  const scene_text all[SCENE_TEXTS] = {{"history", r->history},
                                       {"convergence", r->convergence},
                                       {"timing", r->timing},
                                       {"xdmf", r->xdmf},
                                       {"points_xdmf", r->points_xdmf}};
  memcpy(list, all, sizeof all);
}

/* results.h5 must hold the increments up to the checkpoint; what came behind them goes. */
static gh_status cut_h5(gh_h5 *file, int frames) {
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

gh_status scene_results_resume(scene_results *r, int frames) {
  char *path;
  gh_h5 *file = NULL;
  bool there;
  GH_TRY(scene_result_path(r, "results.h5", &path));
  gh_status status = gh_file_there(r->ctx, path, &there);
  if (status == GH_OK && !there) status = gh_fail(r->ctx, GH_INPUT, "%s: %s", path, strerror(ENOENT));
  if (status == GH_OK) status = gh_h5_open(r->ctx, path, scene_h5_kind("results.h5"), true, &file);
  free(path);
  GH_TRY(status);
  status = cut_h5(file, frames);
  if (status == GH_OK) status = gh_h5_commit(&file);
  else gh_h5_close(&file);
  r->frames = frames;
  r->begun = true;
  look_at_points(r);
  return status;
}

void scene_results_destroy(scene_results **results) {
  if (!results || !*results) return;
  scene_results *r = *results;
  gh_text_destroy(&r->history);
  gh_text_destroy(&r->convergence);
  gh_text_destroy(&r->timing);
  gh_text_destroy(&r->xdmf);
  gh_text_destroy(&r->points_xdmf);
  free(r->folder);
  free(r->dump_end);
  free(r->tensor);
  free(r->scalar);
  free(r);
  *results = NULL;
}
