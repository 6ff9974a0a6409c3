/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Records of finished runs: runs/ID.json, with a checksum over all that stands before it. */
#include "io/file.h"
#include "io/json.h"
#include "study/parts.h"

#include "granhom/granhom.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CHECK "  \"check\": \""

/* ---- writing ---- */

/* A string of JSON, with its quotes. */
static void put_text(gh_text *out, const char *text) {
  gh_text_print(out, "\"");
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    const char *letter = strchr("\"\\\bb\ff\nn\rr\tt", *c);
    if (*c == '"' || *c == '\\') gh_text_print(out, "\\%c", *c);
    else if (*c < ' ' && letter) gh_text_print(out, "\\%c", letter[1]);
    else if (*c < ' ') gh_text_print(out, "\\u%04x", *c);
    else gh_text_print(out, "%c", *c);
  }
  gh_text_print(out, "\"");
}

static void put_string(gh_text *out, const char *name, const char *text) {
  gh_text_print(out, "  \"%s\": ", name);
  put_text(out, text);
  gh_text_print(out, ",\n");
}

/* JSON has no NaN: null. */
static void put_value(gh_text *out, double value) {
  if (isfinite(value)) gh_text_print(out, "%.17g", value);
  else gh_text_print(out, "null");
}

static void put_number(gh_text *out, const char *name, double value) {
  gh_text_print(out, "  \"%s\": ", name);
  put_value(out, value);
  gh_text_print(out, ",\n");
}

static void put_curve(const gh_study *s, gh_text *out, const study_curve *c) {
  gh_text_print(out, "  \"columns\": [\"t\"");
  for (int k = 0; k < s->ncolumns; k++) {
    gh_text_print(out, ", ");
    put_text(out, s->column[k]);
  }
  gh_text_print(out, "],\n  \"curve\": [");
  for (int row = 0; row < c->n; row++) {
    gh_text_print(out, "%s\n    [", row ? "," : "");
    put_value(out, c->t[row]);
    for (int k = 0; k < s->ncolumns; k++) {
      gh_text_print(out, ", ");
      put_value(out, c->value[(size_t)row * (size_t)s->ncolumns + (size_t)k]);
    }
    gh_text_print(out, "]");
  }
  gh_text_print(out, "],\n");
}

static gh_status put_overrides(const gh_study *s, const study_config *one, gh_text *out) {
  gh_override *list;
  int count;
  GH_TRY(study_overrides(s, one, &list, NULL, &count));
  gh_text_print(out, "  \"overrides\": {");
  for (int k = 0; k < count; k++) {
    if (k) gh_text_print(out, ", ");
    put_text(out, list[k].key);
    gh_text_print(out, ": ");
    put_text(out, list[k].value);
  }
  gh_text_print(out, "},\n");
  free(list);
  return GH_OK;
}

/* The counts of a run under their names. */
enum { COUNTS = 7 };
static const char *const count_names[COUNTS] = {
    "force_evaluations", "pair_evaluations", "factorisations", "evaluations", "iterations", "cuts", "jumps"};
static void find_counts(study_run *r, long *list[COUNTS]) {
  long *const all[COUNTS] = {&r->force_evaluations,
                             &r->pair_evaluations,
                             &r->factorisations,
                             &r->evaluations,
                             &r->iterations,
                             &r->cuts,
                             &r->jumps};
  memcpy(list, all, sizeof all);
}

gh_status study_record_print(const gh_study *s, int config, const study_run *run, gh_text *out) {
  size_t length;
  long *count[COUNTS];
  study_run copy = *run;
  gh_text_print(out, "{\n");
  put_string(out, "id", run->id);
  put_string(out, "program", "granhom " GH_VERSION);
  put_string(out, "build", run->other_build ? "another" : gh_build());
  put_string(out, "problem", s->scene ? s->scene_path : s->path);
  GH_TRY(put_overrides(s, s->configs + config, out));
  if (run->packing) put_string(out, "packing", run->packing);
  gh_text_print(out, "  \"status\": %d,\n", gh_exit_status(run->status));
  put_string(out, "outcome", gh_status_text(run->status));
  put_string(out, "message", run->message);
  put_number(out, "wall_seconds", run->wall);
  put_number(out, "core_seconds", run->core);
  find_counts(&copy, count);
  for (int k = 0; k < COUNTS; k++) gh_text_print(out, "  \"%s\": %ld,\n", count_names[k], *count[k]);
  put_number(out, "residual", run->residual);
  put_number(out, "energy_defect", run->energy_defect);
  put_curve(s, out, &run->curve);
  GH_TRY(gh_text_check(out));
  const char *text = gh_text_get(out, &length);
  gh_text_print(out, CHECK "%016" PRIx64 "\"\n}\n", gh_sum_bytes(GH_SUM_BEGIN, text, length));
  return GH_OK;
}

/* ---- reading ---- */

static gh_status record_damaged(const gh_study *s, const char *what) {
  return gh_fail(s->ctx, GH_INPUT, "the record of a run is damaged: %s", what);
}

static gh_status check_sum(const gh_study *s, const char *text) {
  const char *check = NULL;
  char wanted[64];
  for (const char *at = text; (at = strstr(at, CHECK)) != NULL; at++) check = at;
  if (!check) return record_damaged(s, "it has no checksum");
  snprintf(wanted, sizeof wanted, CHECK "%016" PRIx64 "\"\n}\n",
           gh_sum_bytes(GH_SUM_BEGIN, text, (size_t)(check - text)));
  return strcmp(check, wanted) == 0 ? GH_OK : record_damaged(s, "its checksum does not fit");
}

static gh_status get_number(const gh_study *s, const cJSON *root, const char *name, double *value) {
  const cJSON *n = cJSON_GetObjectItemCaseSensitive(root, name);
  if (!cJSON_IsNumber(n) && !cJSON_IsNull(n)) return record_damaged(s, name);
  *value = cJSON_IsNull(n) ? NAN : n->valuedouble;
  return GH_OK;
}

static gh_status get_text(const gh_study *s, const cJSON *root, const char *name, const char **text) {
  const cJSON *n = cJSON_GetObjectItemCaseSensitive(root, name);
  *text = cJSON_GetStringValue(n);
  return *text ? GH_OK : record_damaged(s, name);
}

static gh_status get_status(const gh_study *s, const cJSON *root, study_run *run) {
  static const gh_status known[] = {
#define GH_X(name, exit_status, text) name,
      GH_STATUS_LIST(GH_X)
#undef GH_X
  };
  const char *text;
  GH_TRY(get_text(s, root, "outcome", &text));
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (strcmp(gh_status_text(known[k]), text) == 0) {
      run->status = known[k];
      GH_TRY(get_text(s, root, "message", &text));
      snprintf(run->message, sizeof run->message, "%s", text);
      return GH_OK;
    }
  return record_damaged(s, "outcome");
}

static gh_status get_counts(const gh_study *s, const cJSON *root, study_run *run) {
  long *count[COUNTS];
  find_counts(run, count);
  for (int k = 0; k < COUNTS; k++) {
    double value = NAN;
    GH_TRY(get_number(s, root, count_names[k], &value));
    if (!(fabs(value) < 9e15)) return record_damaged(s, count_names[k]);
    *count[k] = (long)value;
  }
  return GH_OK;
}

static gh_status check_columns(const gh_study *s, const cJSON *root) {
  const cJSON *list = cJSON_GetObjectItemCaseSensitive(root, "columns");
  if (cJSON_GetArraySize(list) != s->ncolumns + 1) return record_damaged(s, "columns");
  for (int k = 0; k < s->ncolumns; k++) {
    const char *name = cJSON_GetStringValue(cJSON_GetArrayItem(list, k + 1));
    if (!name || strcmp(name, s->column[k]) != 0) return record_damaged(s, "columns");
  }
  return GH_OK;
}

static gh_status get_curve(const gh_study *s, const cJSON *root, study_curve *c) {
  const cJSON *rows = cJSON_GetObjectItemCaseSensitive(root, "curve"), *row, *cell;
  size_t capacity = 0;
  double *value;
  gh_status status = GH_OK;
  if (!cJSON_IsArray(rows)) return record_damaged(s, "curve");
  GH_TRY(check_columns(s, root));
  GH_TRY(gh_alloc(s->ctx, (size_t)s->ncolumns + 1, sizeof *value, &value));
  cJSON_ArrayForEach(row, rows) {
    int k = 0;
    cJSON_ArrayForEach(cell, row) if (k++ <= s->ncolumns) value[k - 1] =
        cJSON_IsNumber(cell) ? cell->valuedouble : NAN;
    status = k == s->ncolumns + 1 && isfinite(value[0]) ? GH_OK : record_damaged(s, "curve");
    if (status == GH_OK) status = study_curve_add(s->ctx, c, &capacity, s->ncolumns, value[0], value + 1);
    if (status != GH_OK) break;
  }
  free(value);
  return status;
}

static gh_status get_run(const gh_study *s, const cJSON *root, study_run *run) {
  const char *id;
  GH_TRY(get_text(s, root, "id", &id));
  if (strcmp(id, run->id) != 0) return record_damaged(s, "it belongs to another run");
  const char *build = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(root, "build"));
  run->other_build = !build || strcmp(build, gh_build()) != 0;
  GH_TRY(get_status(s, root, run));
  GH_TRY(get_number(s, root, "wall_seconds", &run->wall));
  GH_TRY(get_number(s, root, "core_seconds", &run->core));
  GH_TRY(get_counts(s, root, run));
  GH_TRY(get_number(s, root, "residual", &run->residual));
  GH_TRY(get_number(s, root, "energy_defect", &run->energy_defect));
  return get_curve(s, root, &run->curve);
}

gh_status study_record_parse(const gh_study *s, const char *text, study_run *run) {
  study_run found = {.packing = run->packing, .finished = true};
  memcpy(found.id, run->id, sizeof found.id);
  GH_TRY(check_sum(s, text));
  gh_c_locale l = gh_c_locale_begin();
  cJSON *root;
  gh_status status = gh_json_parse(s->ctx, "the record of a run is damaged", text, &root);
  if (status == GH_OK) status = get_run(s, root, &found);
  cJSON_Delete(root);
  gh_c_locale_end(l);
  if (status != GH_OK) {
    study_curve_free(&found.curve);
    return status;
  }
  study_curve_free(&run->curve);
  *run = found;
  return GH_OK;
}

/* ---- files ---- */

gh_status study_record_path(const gh_study *s, const char *folder, const char *id, char **path) {
  char name[32];
  snprintf(name, sizeof name, "runs/%s.json", id);
  *path = gh_path_join(folder, name);
  return *path ? GH_OK : gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
}

gh_status study_record_check(const gh_study *s, const char *folder, const study_run *run) {
  char *path;
  GH_TRY(study_record_path(s, folder, run->id, &path));
  gh_status status = gh_file_regular(s->ctx, path);
  free(path);
  return status;
}

bool study_record_find(const gh_study *s, const char *folder, study_run *run) {
  char *path = NULL, *text = NULL;
  bool found = study_record_path(s, folder, run->id, &path) == GH_OK && access(path, F_OK) == 0 &&
               gh_file_text(s->ctx, path, &text) == GH_OK && study_record_parse(s, text, run) == GH_OK;
  free(text);
  free(path);
  return found;
}
