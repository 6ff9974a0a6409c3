/* What a folder of results tells those who draw it. SPDX-License-Identifier: GPL-2.0-or-later
 */
#include "scene/page.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

static void take(const cJSON *object, const char *key, char *out, size_t size) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
  snprintf(out, size, "%s", cJSON_IsString(item) ? item->valuestring : "");
}

static gh_status read_text(gh_context *ctx, const char *path, char **text) {
  FILE *file = fopen(path, "rb");
  if (!file) return gh_fail(ctx, GH_INPUT, "%s: cannot be opened; is this a folder of results?", path);
  size_t length = 0, capacity = 0, got;
  gh_status status = GH_OK;
  do {
    status = gh_grow(ctx, length + 4097, 1, &capacity, text);
    if (status != GH_OK) break;
    got = fread(*text + length, 1, 4096, file);
    length += got;
    (*text)[length] = 0;
  } while (got > 0);
  fclose(file);
  return status;
}

static void fill(const cJSON *root, scene_labels *l) {
  const cJSON *units = cJSON_GetObjectItemCaseSensitive(root, "units"),
              *driven = cJSON_GetObjectItemCaseSensitive(root, "driven");
  const cJSON *micro =
      cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(root, "options"), "micro");
  const cJSON *points = cJSON_GetObjectItemCaseSensitive(micro, "points");
  char direction[2];
  take(root, "title", l->title, sizeof l->title);
  take(units, "length", l->length, sizeof l->length);
  take(units, "force", l->force, sizeof l->force);
  if (*l->length && *l->force) snprintf(l->stress, sizeof l->stress, "%s/%s", l->force, l->length);
  take(driven, "set", l->driven_set, sizeof l->driven_set);
  take(driven, "direction", direction, sizeof direction);
  l->driven_direction = direction[0] == 'x' ? 'x' : 'y';
  l->points = cJSON_IsNumber(points) ? points->valueint : 0;
}

gh_status scene_labels_read(gh_context *ctx, const char *folder, scene_labels *l) {
  *l = (scene_labels){0};
  char *path = gh_path_join(folder, "run.json"), *text = NULL;
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = read_text(ctx, path, &text);
  if (status == GH_OK) {
    cJSON *root = cJSON_Parse(text);
    if (root) fill(root, l);
    else status = gh_fail(ctx, GH_INPUT, "%s: is no JSON", path);
    cJSON_Delete(root);
  }
  free(text);
  free(path);
  return status;
}

/* ---- HDF5 ---- */

gh_status scene_open_h5(gh_context *ctx, const char *folder, const char *name, gh_h5 **file) {
  char *path = gh_path_join(folder, name);
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_h5_read(ctx, path, file);
  free(path);
  return status;
}

gh_status scene_get_doubles(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                            double **data) {
  size_t r, c;
  GH_TRY(gh_h5_size(file, name, &r, &c));
  if (c != cols) return gh_fail(ctx, GH_INPUT, "dataset %s has %zu columns instead of %zu", name, c, cols);
  GH_TRY(gh_alloc(ctx, r * c, sizeof **data, data));
  *rows = r;
  return gh_h5_get_doubles(file, name, r, c, *data);
}

gh_status scene_get_ints(gh_context *ctx, gh_h5 *file, const char *name, size_t *rows, size_t cols,
                         int **data) {
  size_t r, c;
  GH_TRY(gh_h5_size(file, name, &r, &c));
  if (c != cols) return gh_fail(ctx, GH_INPUT, "dataset %s has %zu columns instead of %zu", name, c, cols);
  GH_TRY(gh_alloc(ctx, r * c, sizeof **data, data));
  *rows = r;
  return gh_h5_get_ints(file, name, r, c, *data);
}
