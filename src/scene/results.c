/* Results of a run: one folder of files, each whole after each increment.
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * results.h5      /mesh and one group per increment, /step0000 (the start) onwards
 * results.xdmf    the same for ParaView, points.xdmf: at the integration points
 * rves.h5         grains and contacts of recorded material points at the last increment; traces.h5: positions
 * at all dumps/          the chosen material points as LAMMPS dumps history.csv, convergence.csv, run.json */
#include "scene/results.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- folder ---- */

gh_status scene_results_check(gh_context *ctx, const char *folder) {
  struct stat info;
  if (!*folder) return gh_fail(ctx, GH_INPUT, "the name of the folder for results is empty");
  char *path = strdup(folder);
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = GH_OK;
  while (stat(path, &info) != 0 && (errno == ENOENT || errno == ENOTDIR)) { /* up to what exists */
    char *parent = gh_path_folder(path);
    free(path);
    if (!parent) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
    path = parent;
  }
  if (stat(path, &info) != 0) status = gh_fail(ctx, GH_SYSTEM, "%s: %s", path, strerror(errno));
  else if (!S_ISDIR(info.st_mode))
    status = gh_fail(ctx, GH_INPUT, "%s: is a file, and the results need a folder", path);
  else if (access(path, W_OK | X_OK) != 0)
    status = gh_fail(ctx, GH_SYSTEM, "%s: cannot write there: %s", path, strerror(errno));
  free(path);
  return status;
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
  char *json = scene_run_json(r->scene, r->farm, r->started, status_text, message, summary);
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
  gh_text_print(whole, "%s", gh_text_get(steps, NULL));
  scene_xdmf_end(whole);
  gh_status status = commit_text(r, whole, name);
  gh_text_destroy(&whole);
  return status;
}

/* A file of a run before, perhaps of another mesh. */
static gh_status remove_old(scene_results *r, const char *name) {
  char *path;
  GH_TRY(scene_result_path(r, name, &path));
  unlink(path);
  free(path);
  return GH_OK;
}

static gh_status begin(scene_results *r) {
  if (r->begun) return GH_OK;
  GH_TRY(gh_folder_make(r->ctx, r->folder));
  scene_history_header(r);
  GH_TRY(remove_old(r, "rves.h5"));
  GH_TRY(remove_old(r, "traces.h5"));
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
    if (scene_mises(cauchy) > most) most = scene_mises(cauchy), r->most_loaded = p;
  }
}

int scene_results_unjammed(const scene_results *r, double *min_acoustic) {
  *min_acoustic = r->min_acoustic;
  return r->unjammed;
}

/* results.h5 comes first: the others may then refer to what is in it. */
gh_status scene_results_write(scene_results *r, const scene_frame *f) {
  GH_TRY(begin(r));
  look_at_points(r);
  GH_TRY(scene_write_h5(r, f));
  r->frames++;
  GH_TRY(scene_write_rves(r, f));
  GH_TRY(scene_write_dumps(r, f));
  scene_xdmf_step(r->xdmf, r->scene->mesh, f);
  GH_TRY(write_xdmf(r, r->xdmf, "results.xdmf"));
  scene_xdmf_points(r->points_xdmf, r->scene->mesh, f);
  GH_TRY(write_xdmf(r, r->points_xdmf, "points.xdmf"));
  scene_history_row(r, f);
  GH_TRY(commit_text(r, r->history, "history.csv"));
  return commit_text(r, r->convergence, "convergence.csv");
}

gh_status scene_results_close(scene_results *r, gh_status status, const char *outcome, const char *message,
                              const gh_run_summary *summary) {
  if (status == GH_INPUT && !r->begun) return GH_OK; /* wrong input writes nothing */
  GH_TRY(begin(r));
  GH_TRY(commit_text(r, r->history, "history.csv"));
  GH_TRY(commit_text(r, r->convergence, "convergence.csv"));
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
  r->folder = strdup(folder);
  status = r->folder ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK) status = gh_text_create(ctx, &r->history);
  if (status == GH_OK) status = gh_text_create(ctx, &r->convergence);
  if (status == GH_OK) status = gh_text_create(ctx, &r->xdmf);
  if (status == GH_OK) status = gh_text_create(ctx, &r->points_xdmf);
  if (status == GH_OK) status = gh_alloc(ctx, 4 * points, sizeof *r->tensor, &r->tensor);
  if (status == GH_OK) status = gh_alloc(ctx, points, sizeof *r->scalar, &r->scalar);
  if (status != GH_OK) {
    scene_results_destroy(results);
    return status;
  }
  gh_text_print(r->convergence, "step,substep,iteration,residual,relative,first,step_length,seconds\n");
  time_t now = time(NULL);
  struct tm utc;
  if (gmtime_r(&now, &utc)) strftime(r->started, sizeof r->started, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return GH_OK;
}

void scene_results_destroy(scene_results **results) {
  if (!results || !*results) return;
  scene_results *r = *results;
  gh_text_destroy(&r->history);
  gh_text_destroy(&r->convergence);
  gh_text_destroy(&r->xdmf);
  gh_text_destroy(&r->points_xdmf);
  free(r->folder);
  free(r->dump_end);
  free(r->tensor);
  free(r->scalar);
  free(r);
  *results = NULL;
}
