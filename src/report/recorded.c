/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What is read of a folder of results in order to draw it. */
#include "io/file.h"
#include "io/json.h"
#include "report/report.h"

#include <stdlib.h>
#include <string.h>

/* A text of run.json, "" where it is missing. The file may be anybody's. */
static gh_status label_read(gh_context *ctx, const char *path, const cJSON *object, const char *key,
                            char *out, size_t size) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
  const char *text = cJSON_IsString(item) ? item->valuestring : "";
  char what[GH_QUOTE];
  size_t n = strlen(text);
  if (gh_unprintable(text, what))
    return gh_fail(ctx, GH_INPUT, "%s: %s holds %s, a text in one line is wanted", path, key, what);
  if (n >= size) /* not within a character */
    for (n = size - 1; n > 0 && ((unsigned char)text[n] & 0xC0) == 0x80;) n--;
  snprintf(out, size, "%.*s", (int)n, text);
  return GH_OK;
}

static gh_status labels_fill(gh_context *ctx, const char *path, const cJSON *root, report_labels *l) {
  const cJSON *units = cJSON_GetObjectItemCaseSensitive(root, "units"),
              *driven = cJSON_GetObjectItemCaseSensitive(root, "driven");
  const cJSON *micro =
      cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(root, "options"), "micro");
  const cJSON *points = cJSON_GetObjectItemCaseSensitive(micro, "points");
  char direction[2];
  GH_TRY(label_read(ctx, path, root, "title", l->title, sizeof l->title));
  GH_TRY(label_read(ctx, path, units, "length", l->length, sizeof l->length));
  GH_TRY(label_read(ctx, path, units, "force", l->force, sizeof l->force));
  if (*l->length && *l->force) snprintf(l->stress, sizeof l->stress, "%s/%s", l->force, l->length);
  GH_TRY(label_read(ctx, path, driven, "set", l->driven_set, sizeof l->driven_set));
  GH_TRY(label_read(ctx, path, driven, "direction", direction, sizeof direction));
  l->driven_direction = direction[0] == 'x' ? 'x' : 'y';
  l->points = cJSON_IsNumber(points) ? points->valueint : 0;
  return GH_OK;
}

gh_status report_run_read(gh_context *ctx, const char *folder, cJSON **root) {
  char *path = gh_path_join(folder, "run.json"), *text = NULL;
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_file_regular(ctx, path);
  if (status == GH_OK) status = gh_file_text(ctx, path, &text);
  *root = NULL;
  if (status == GH_OK) status = gh_json_parse(ctx, path, text, root);
  if (status == GH_OK && !cJSON_IsObject(*root)) {
    status = gh_fail(ctx, GH_INPUT, "%s: is no JSON object: cut off, or of another program", path);
    cJSON_Delete(*root);
    *root = NULL;
  }
  free(text);
  free(path);
  return status;
}

gh_status report_labels_of(gh_context *ctx, const char *folder, const cJSON *root, report_labels *l) {
  *l = (report_labels){0};
  char *path = gh_path_join(folder, "run.json");
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = labels_fill(ctx, path, root, l);
  free(path);
  return status;
}

gh_status report_labels_read(gh_context *ctx, const char *folder, report_labels *l) {
  cJSON *root;
  *l = (report_labels){0};
  GH_TRY(report_run_read(ctx, folder, &root));
  gh_status status = report_labels_of(ctx, folder, root, l);
  cJSON_Delete(root);
  return status;
}

/* ---- HDF5 ---- */

/* Results of older versions have no checksum and can still be shown. */
gh_status report_open_h5(gh_context *ctx, const char *folder, const char *name, gh_h5 **file) {
  bool sealed = true;
  char *path = gh_path_join(folder, name);
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_h5_read(ctx, path, gh_results_kind(name), &sealed, file);
  if (status == GH_OK && !sealed)
    gh_log(ctx, GH_LEVEL_WARNING,
           "%s has no checksum: an older version of granhom or another program wrote it, and damage would "
           "not be "
           "seen",
           path);
  free(path);
  return status;
}

static gh_status count_rows(gh_context *ctx, gh_h5 *file, const char *name, size_t cols, size_t *rows) {
  size_t c;
  GH_TRY(gh_h5_size(file, name, rows, &c));
  if (c == cols) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "dataset %s has %zu columns instead of %zu", name, c, cols);
}

gh_status report_get_doubles(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                             double **data) {
  *data = NULL;
  GH_TRY(count_rows(ctx, file, name, cols, rows));
  GH_TRY(gh_alloc(ctx, *rows * cols, sizeof **data, data));
  gh_status status = gh_h5_get_doubles(file, name, *rows, cols, *data);
  if (status == GH_OK) return GH_OK;
  free(*data);
  *data = NULL;
  return status;
}

gh_status report_get_ints(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                          int **data) {
  *data = NULL;
  GH_TRY(count_rows(ctx, file, name, cols, rows));
  GH_TRY(gh_alloc(ctx, *rows * cols, sizeof **data, data));
  gh_status status = gh_h5_get_ints(file, name, *rows, cols, *data);
  if (status == GH_OK) return GH_OK;
  free(*data);
  *data = NULL;
  return status;
}
