/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Whether a folder of results is whole, before anything is drawn from it. */
#include "io/file.h"
#include "report/report.h"

#include <stdlib.h>
#include <string.h>

typedef struct folder {
  gh_context *ctx;
  const char *name;
  cJSON *run;
  int rows; /* of history.csv: complete increments, the start included */
} folder;

static bool still_running(const folder *f) {
  const cJSON *status = cJSON_GetObjectItemCaseSensitive(f->run, "status");
  return cJSON_IsString(status) && strcmp(status->valuestring, "running") == 0;
}

/* A run that has ended states how many increments it has written; the start comes before them. */
static gh_status history_check(const folder *f, const report_table *h) {
  const cJSON *summary = cJSON_GetObjectItemCaseSensitive(f->run, "summary"),
              *increments = cJSON_GetObjectItemCaseSensitive(summary, "increments");
  if (still_running(f) || !cJSON_IsNumber(increments) || h->nrows >= increments->valuedouble + 1)
    return GH_OK;
  return gh_fail(f->ctx, GH_INPUT,
                 "%s: is cut off: it has %d increment%s after the start, run.json has counted %.0f", h->path,
                 h->nrows - 1, GH_S(h->nrows - 1), increments->valuedouble);
}

/* `open`: nan, and only this word, is a displacement that the row's step does not prescribe. */
static gh_status values_check(gh_context *ctx, const report_table *h, int column, bool open) {
  char quoted[GH_QUOTE], name[GH_QUOTE];
  for (int k = 0; k < h->nrows && column >= 0; k++)
    if (!isfinite(report_table_number(h, k, column)) &&
        !(open && strcmp(report_table_text(h, k, column), "nan") == 0))
      return gh_fail(ctx, GH_INPUT, "%s:%d: %s: '%s' is not a finite number", h->path, k + 2,
                     gh_quote(h->name[column], name), gh_quote(report_table_text(h, k, column), quoted));
  return GH_OK;
}

static gh_status table_check(folder *f) {
  report_table h;
  report_labels l;
  report_curve c;
  GH_TRY(report_labels_of(f->ctx, f->name, f->run, &l));
  gh_status status = report_table_read(f->ctx, f->name, "history.csv", &h);
  f->rows = h.nrows;
  if (status == GH_OK) status = history_check(f, &h);
  if (status == GH_OK) status = report_curve_choose(f->ctx, &h, &l, &c);
  if (status == GH_OK) status = values_check(f->ctx, &h, c.x, true);
  if (status == GH_OK) status = values_check(f->ctx, &h, c.force, false);
  if (status == GH_OK) status = values_check(f->ctx, &h, c.dilatancy, false);
  report_table_free(&h);
  return status;
}

gh_status report_residuals_read(gh_context *ctx, const char *path, gh_csv **csv) {
  char *text;
  *csv = NULL;
  GH_TRY(gh_file_regular(ctx, path));
  GH_TRY(gh_file_text(ctx, path, &text));
  bool cut = !*text || text[strlen(text) - 1] != '\n';
  free(text);
  if (cut) return gh_fail(ctx, GH_INPUT, "%s: the last line is cut off", path);
  GH_TRY(gh_csv_read(ctx, path, csv));
  const int step = gh_csv_find(*csv, "step");
  bool good = (*csv)->nrows > 0 && step >= 0 && gh_csv_find(*csv, "iteration") >= 0 &&
              gh_csv_find(*csv, "relative") >= 0;
  for (int k = 0; good && k < (*csv)->nrows; k++) {
    const double number = (*csv)->value[(size_t)k * (size_t)(*csv)->ncols + (size_t)step];
    good = number >= 0 && number < 1e9;
  }
  if (good) return GH_OK;
  gh_csv_destroy(csv);
  return gh_fail(ctx, GH_INPUT, "%s: holds no residuals", path);
}

/* Each increment has a residual at least. */
static gh_status residuals_check(const folder *f, const char *path) {
  gh_csv *csv;
  GH_TRY(report_residuals_read(f->ctx, path, &csv));
  double last = csv->value[(csv->nrows - 1) * csv->ncols + gh_csv_find(csv, "step")];
  gh_csv_destroy(&csv);
  const int behind = still_running(f) ? 2 : 1; /* the files of an increment are written one after the other */
  if (last >= f->rows - behind && last < 1e9) return GH_OK;
  return gh_fail(f->ctx, GH_INPUT, "%s: is cut off: it ends in increment %.0f, history.csv in %d", path, last,
                 f->rows - 1);
}

/* Files of HDF5 are checked as they are opened. */
static gh_status fields_check(const folder *f, const char *path, const char *name, bool needed) {
  gh_h5 *file = NULL;
  bool there;
  GH_TRY(gh_file_there(f->ctx, path, &there));
  if (!gh_h5_available() || (!there && !needed)) return GH_OK;
  if (!there)
    return gh_fail(f->ctx, GH_INPUT, "%s: holds no complete increment: %s is missing", f->name, name);
  GH_TRY(report_open_h5(f->ctx, f->name, name, &file));
  char last[64];
  snprintf(last, sizeof last, "/step%04d/time", f->rows - 1);
  gh_status status = gh_h5_there(file, last, &there);
  if (status == GH_OK && needed && !there)
    status = gh_fail(f->ctx, GH_INPUT, "%s: is cut off: it has no increment %d, history.csv has one", path,
                     f->rows - 1);
  snprintf(last, sizeof last, "/step%04d/time", f->rows + 1); /* one more may be under way */
  if (status == GH_OK && needed) status = gh_h5_there(file, last, &there);
  if (status == GH_OK && needed && there)
    status = gh_fail(f->ctx, GH_INPUT,
                     "%s/history.csv: is cut off: it ends with increment %d, results.h5 has more", f->name,
                     f->rows - 1);
  gh_h5_close(&file);
  return status;
}

static gh_status files_check(folder *f) {
  static const char *const fields[] = {"results.h5", "rves.h5", "traces.h5"};
  GH_TRY(table_check(f));
  char *path = gh_path_join(f->name, "convergence.csv");
  gh_status status = path ? residuals_check(f, path) : gh_fail(f->ctx, GH_MEMORY, "no memory for a path");
  free(path);
  for (size_t k = 0; k < 3 && status == GH_OK; k++) {
    path = gh_path_join(f->name, fields[k]);
    status =
        path ? fields_check(f, path, fields[k], k == 0) : gh_fail(f->ctx, GH_MEMORY, "no memory for a path");
    free(path);
  }
  return status;
}

gh_status gh_results_check(gh_context *ctx, const char *name) {
  folder f = {.ctx = ctx, .name = name};
  char *path = gh_path_join(name, "run.json");
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  bool there;
  gh_status found = gh_file_there(ctx, path, &there);
  free(path);
  GH_TRY(found);
  if (!there)
    return gh_fail(ctx, GH_INPUT, "%s: holds no results of `granhom run`: its folder -o is wanted", name);
  GH_TRY(report_run_read(ctx, name, &f.run));
  gh_status status = files_check(&f);
  cJSON_Delete(f.run);
  return status;
}
