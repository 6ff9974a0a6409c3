/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a report reads. */
#include "io/file.h"
#include "io/json.h"
#include "report/report.h"

#include <stdlib.h>
#include <string.h>

void report_close(report *r) {
  gh_h5_close(&r->results);
  gh_h5_close(&r->rves);
  gh_h5_close(&r->traces);
  gh_csv_destroy(&r->convergence);
  report_table_free(&r->history);
  cJSON_Delete(r->run);
  free(r->mesh.X);
  free(r->mesh.quad);
  free(r->gauss);
  free(r->acoustic);
  free(r->cauchy);
  gh_text_destroy(&r->out);
}

/* ---- numbers by name ---- */

double report_history(const report *r, int k, const char *column) {
  int c = report_table_column(&r->history, column);
  return c < 0 ? NAN : report_table_number(&r->history, k, c);
}

double report_run_number(const report *r, const char *const *keys) {
  const cJSON *at = r->run;
  for (; *keys && at; keys++) at = cJSON_GetObjectItemCaseSensitive(at, *keys);
  return at && cJSON_IsNumber(at) ? at->valuedouble : NAN;
}

const char *report_run_text(const report *r, const char *key) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(r->run, key);
  return cJSON_IsString(item) ? item->valuestring : "";
}

gh_status report_field(report *r, int k, const char *name, size_t rows, size_t cols, double **data) {
  char full[96];
  snprintf(full, sizeof full, "/step%04d/%s", k, name);
  GH_TRY(gh_alloc(r->ctx, rows * cols, sizeof **data, data));
  GH_TRY(gh_h5_get_doubles(r->results, full, rows, cols, *data));
  if (gh_finite(*data, rows * cols)) return GH_OK;
  return gh_fail(r->ctx, GH_INPUT, "%s/results.h5: %s holds a value that is not finite", r->folder, full);
}

/* ---- files ---- */

static gh_status read_run(report *r) {
  char *path = gh_path_join(r->folder, "run.json");
  if (!path) return gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
  bool there = false;
  gh_status status = gh_file_there(r->ctx, path, &there);
  free(path);
  GH_TRY(status);
  if (!there)
    return gh_fail(r->ctx, GH_INPUT, "%s: holds no results of `granhom run`: its folder -o is wanted",
                   r->folder);
  GH_TRY(report_run_read(r->ctx, r->folder, &r->run));
  return report_labels_of(r->ctx, r->folder, r->run, &r->labels);
}

static gh_status no_increment(report *r) {
  const char *message = report_run_text(r, "message");
  return gh_fail(r->ctx, GH_INPUT, "%s: holds no complete increment%s%s", r->folder,
                 *message ? "; the run ended with: " : "", message);
}

static gh_status read_tables(report *r) {
  char *path = gh_path_join(r->folder, "results.h5");
  if (!path) return gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
  bool there = false;
  gh_status found = gh_file_there(r->ctx, path, &there);
  free(path);
  GH_TRY(found);
  if (!there) return no_increment(r);
  GH_TRY(report_table_read(r->ctx, r->folder, "history.csv", &r->history));
  GH_TRY(report_curve_choose(r->ctx, &r->history, &r->labels, &r->curve));
  path = gh_path_join(r->folder, "convergence.csv");
  if (!path) return gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
  gh_status status = report_residuals_read(r->ctx, path, &r->convergence);
  free(path);
  return status;
}

static gh_status read_mesh(report *r) {
  size_t nn, ne, np, nx;
  double *X;
  int *quad;
  GH_TRY(report_get_doubles(r->ctx, r->results, "/mesh/coordinates", &nn, 3, &X));
  r->mesh.X = X; /* to the two coordinates of the plane, in place */
  for (size_t k = 0; k < nn; k++) X[2 * k] = X[3 * k], X[2 * k + 1] = X[3 * k + 1];
  GH_TRY(report_get_ints(r->ctx, r->results, "/mesh/cells", &ne, 4, &quad));
  r->mesh.quad = (int(*)[4])quad;
  r->mesh.nnodes = (int)nn, r->mesh.nelements = (int)ne;
  for (size_t k = 0; k < 4 * ne; k++)
    if (quad[k] < 0 || quad[k] >= (int)nn)
      return gh_fail(r->ctx, GH_INPUT, "%s/results.h5: /mesh/cells names the node %d of %zu", r->folder,
                     quad[k], nn);
  r->np = 4 * (int)ne;
  GH_TRY(report_get_doubles(r->ctx, r->results, "/mesh/gauss", &np, 2, &r->gauss));
  nx = 4 * ne;
  if (np == nx && nx > 0) return GH_OK;
  return gh_fail(r->ctx, GH_INPUT, "%s/results.h5: %zu integration points and %zu elements", r->folder, np,
                 ne);
}

/* Increments that are both in results.h5, which is written first, and in history.csv. */
static gh_status count_increments(report *r) {
  char name[64];
  bool there = true;
  int frames = -1;
  while (there) {
    snprintf(name, sizeof name, "/step%04d/points/acoustic", ++frames);
    GH_TRY(gh_h5_there(r->results, name, &there));
  }
  if (frames == 0) return no_increment(r);
  if (frames < r->history.nrows)
    return gh_fail(r->ctx, GH_INPUT, "%s: history.csv has %d increments, results.h5 has %d", r->folder,
                   r->history.nrows, frames);
  r->n = r->history.nrows;
  return GH_OK;
}

/* Explicit relaxation computes stresses alone. */
static bool has_tangents(const report *r) {
  const cJSON *at = cJSON_GetObjectItemCaseSensitive(r->run, "options");
  at = cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(at, "solver"), "method");
  return !cJSON_IsString(at) || strcmp(at->valuestring, "relaxation") != 0;
}

static gh_status read_points(report *r) {
  size_t np = (size_t)r->np, n = (size_t)r->n;
  r->tangents = has_tangents(r);
  GH_TRY(gh_alloc(r->ctx, n * np, sizeof *r->acoustic, &r->acoustic));
  for (size_t k = 0; k < n; k++) {
    char name[64];
    snprintf(name, sizeof name, "/step%04zu/points/acoustic", k);
    GH_TRY(gh_h5_get_doubles(r->results, name, np, 1, r->acoustic + k * np));
  }
  GH_TRY(report_field(r, r->n - 1, "points/cauchy", np, 4, &r->cauchy));
  const double *last = r->acoustic + (n - 1) * np;
  for (int p = 0; p < r->np; p++) {
    if (last[p] < last[r->least]) r->least = p;
    if (gh_mises2(r->cauchy + 4 * p) > gh_mises2(r->cauchy + 4 * r->most)) r->most = p;
  }
  return GH_OK;
}

/* ---- choices ---- */

static void add_point(report *r, int point) {
  for (int k = 0; k < r->npoints; k++)
    if (r->points[k] == point) return;
  r->points[r->npoints++] = point;
}

/* The extreme points and the first, of those whose grains are recorded; of all where none are. */
static gh_status choose_extremes(report *r) {
  const double *acoustic = r->acoustic + (size_t)(r->n - 1) * (size_t)r->np;
  int most = -1, least = -1, first = -1;
  for (int p = 0; p < r->np && r->rves; p++) {
    bool recorded;
    GH_TRY(report_rve_recorded(r->rves, p, &recorded));
    if (!recorded) continue;
    if (first < 0) most = least = first = p;
    if (acoustic[p] < acoustic[least]) least = p;
    if (gh_mises2(r->cauchy + 4 * p) > gh_mises2(r->cauchy + 4 * most)) most = p;
  }
  bool none = first < 0;
  r->most_shown = none ? r->most : most;
  r->least_shown = none ? r->least : least;
  add_point(r, r->most_shown);
  add_point(r, r->least_shown);
  add_point(r, none ? 0 : first);
  return GH_OK;
}

static gh_status choose_points(report *r, const int *points, int npoints) {
  r->most_shown = r->most, r->least_shown = r->least;
  if (npoints > REPORT_POINTS)
    return gh_fail(r->ctx, GH_INPUT, "at most %d points are drawn, not %d", REPORT_POINTS, npoints);
  for (int k = 0; k < npoints; k++) {
    if (points[k] < 0 || points[k] >= r->np)
      return gh_fail(r->ctx, GH_INPUT, "there is no integration point %d: there are %d, counted from 0",
                     points[k], r->np);
    add_point(r, points[k]);
  }
  if (npoints == 0) GH_TRY(choose_extremes(r));
  return GH_OK;
}

static void add_film(report *r, int increment) {
  int at = r->nfilm;
  for (int k = 0; k < r->nfilm; k++)
    if (r->film[k] == increment) return;
  if (r->nfilm == REPORT_FILM) return;
  for (; at > 0 && r->film[at - 1] > increment; at--) r->film[at] = r->film[at - 1];
  r->film[at] = increment;
  r->nfilm++;
}

/* The first increment, the last, the ends of load steps, and then always the middle of the widest gap. Large
 * meshes get fewer: their pictures are long. */
static void choose_film(report *r) {
  enum { LARGE = 4000 };
  add_film(r, r->n - 1);
  if (r->mesh.nelements > LARGE) return;
  add_film(r, 0);
  for (int k = 1; k < r->n && r->nfilm < REPORT_FILM - 1; k++)
    if (report_history(r, k, "load_step") != report_history(r, k - 1, "load_step")) add_film(r, k - 1);
  while (r->nfilm < REPORT_FILM) {
    int widest = 0, at = -1;
    for (int k = 1; k < r->nfilm; k++)
      if (r->film[k] - r->film[k - 1] > widest) widest = r->film[k] - r->film[k - 1], at = k;
    if (widest < 2) return;
    add_film(r, (r->film[at] + r->film[at - 1]) / 2);
  }
}

/* A file that may be missing, but not be damaged. */
static gh_status open_optional(report *r, const char *name, gh_h5 **file) {
  char *path = gh_path_join(r->folder, name);
  if (!path) return gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
  bool there = false;
  gh_status status = gh_file_there(r->ctx, path, &there);
  free(path);
  return there ? report_open_h5(r->ctx, r->folder, name, file) : status;
}

gh_status report_open(gh_context *ctx, const char *folder, const int *points, int npoints, report *r) {
  *r = (report){.ctx = ctx, .folder = folder};
  GH_TRY(read_run(r));
  GH_TRY(read_tables(r));
  GH_TRY(report_open_h5(ctx, folder, "results.h5", &r->results));
  GH_TRY(open_optional(r, "rves.h5", &r->rves));
  GH_TRY(open_optional(r, "traces.h5", &r->traces));
  GH_TRY(read_mesh(r));
  GH_TRY(count_increments(r));
  GH_TRY(read_points(r));
  GH_TRY(choose_points(r, points, npoints));
  choose_film(r);
  return gh_text_create(ctx, &r->out);
}
