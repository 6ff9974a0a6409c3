/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Configurations of a study: all combinations of the values of its parameters, what each is compared with,
 * and the packings of each. */
#include "io/file.h"
#include "study/parts.h"

#include <glob.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CONFIGS = 100000 };

/* ---- values ---- */

static const study_entry *find_entry(const study_entry *list, int n, const char *key) {
  for (int k = 0; k < n; k++)
    if (strcmp(list[k].key, key) == 0) return list + k;
  return NULL;
}

static int find_parameter(const gh_study *s, const char *key) {
  for (int k = 0; k < s->nparameters; k++)
    if (strcmp(s->parameters[k].name, key) == 0) return k;
  return -1;
}

const char *study_value(const gh_study *s, const study_config *config, const char *key) {
  const study_entry *e = config->extra ? find_entry(s->tighter, s->ntighter, key) : NULL;
  if (e) return e->value;
  int parameter = find_parameter(s, key);
  if (parameter >= 0) return config->value[parameter];
  e = find_entry(s->base, s->nbase, key);
  return e ? e->value : NULL;
}

int study_line(const gh_study *s, const study_config *config, const char *key) {
  const study_entry *e = config->extra ? find_entry(s->tighter, s->ntighter, key) : NULL;
  int parameter = find_parameter(s, key);
  if (!e && parameter >= 0) return s->parameters[parameter].line;
  if (!e) e = find_entry(s->base, s->nbase, key);
  return e ? e->line : s->problem_line;
}

/* Keys in the order in which they are set: of base, parameters, reference. */
static const char *key_of(const gh_study *s, int k) {
  if (k < s->nbase) return s->base[k].key;
  k -= s->nbase;
  return k < s->nparameters ? s->parameters[k].name : s->tighter[k - s->nparameters].key;
}

gh_status study_overrides(const gh_study *s, const study_config *config, gh_override **list, int **line,
                          int *count) {
  const int tighter = config->extra ? s->ntighter : 0, most = s->nbase + s->nparameters + tighter;
  int n = 0;
  *list = NULL;
  if (line) *line = NULL;
  GH_TRY(gh_alloc(s->ctx, (size_t)most, sizeof **list, list));
  gh_status status = line ? gh_alloc(s->ctx, (size_t)most, sizeof **line, line) : GH_OK;
  if (status != GH_OK) {
    free(*list);
    return status;
  }
  for (int k = 0; k < most; k++) {
    const char *key = key_of(s, k);
    bool known = false;
    for (int j = 0; j < n; j++) known = known || strcmp((*list)[j].key, key) == 0;
    if (known) continue;
    if (line) (*line)[n] = study_line(s, config, key);
    (*list)[n++] = (gh_override){.key = key, .value = study_value(s, config, key)};
  }
  *count = n;
  return GH_OK;
}

/* `key` is a part of what `whole` holds. */
static bool is_within(const char *key, const char *whole) {
  size_t n = strlen(whole);
  return strncmp(key, whole, n) == 0 && key[n] == '.';
}

static bool is_first_key(const gh_study *s, int k) {
  for (int j = 0; j < k; j++)
    if (strcmp(key_of(s, j), key_of(s, k)) == 0) return false;
  return true;
}

gh_status study_check_keys(const gh_study *s) {
  const study_config all = {.extra = true}; /* whose keys may come from each of the three */
  const int most = s->nbase + s->nparameters + s->ntighter;
  for (int j = 0; j < most; j++)
    for (int i = 0; i < most; i++) {
      const char *whole = key_of(s, j), *part = key_of(s, i);
      const bool later = i < j || strcmp(whole, "packing") == 0; /* packings are set last */
      if (!is_within(part, whole) || !later || !is_first_key(s, j)) continue;
      return gh_fail(s->ctx, GH_INPUT, "%s:%d: %s replaces %s as well, which line %d sets", s->path,
                     study_line(s, &all, whole), whole, part, study_line(s, &all, part));
    }
  return GH_OK;
}

static bool same_value(const char *a, const char *b) {
  double x, y;
  return strcmp(a, b) == 0 || (gh_parse_number(a, &x) && gh_parse_number(b, &y) && x == y);
}

/* What the reference sets is no parameter, and another value than in all runs. */
static bool entry_is_beside(const gh_study *s, const study_entry *e) {
  const study_entry *base = find_entry(s->base, s->nbase, e->key);
  return find_parameter(s, e->key) < 0 && !(base && same_value(base->value, e->value));
}

/* ---- names ---- */

static void name_add(char *text, size_t size, const char *key, const char *value) {
  size_t used = strlen(text);
  snprintf(text + used, size - used, "%s%s%s%s", used ? ", " : "", key, *key ? " " : "", value);
}

static const char *last_part(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

void study_run_name(const gh_study *s, int config, int member, char *text, size_t size) {
  const study_config *one = s->configs + config;
  *text = 0;
  char value[256];
  for (int k = 0; k < s->nparameters; k++)
    name_add(text, size, s->parameters[k].name, study_plain(one->value[k], value, sizeof value));
  if (*one->also) name_add(text, size, "", one->also);
  if (member >= 0 && one->nruns > 1) name_add(text, size, "", last_part(one->files[member]));
}

/* ---- combinations ---- */

static gh_status config_alloc(gh_study *s, study_config *one) {
  GH_TRY(gh_alloc(s->ctx, (size_t)s->nparameters, sizeof *one->value, &one->value));
  return gh_alloc(s->ctx, (size_t)s->nparameters, sizeof *one->choice, &one->choice);
}

/* The configuration with this number: the last parameter is the fastest. */
static gh_status config_combine(gh_study *s, int number, study_config *one) {
  GH_TRY(config_alloc(s, one));
  for (int k = s->nparameters - 1; k >= 0; k--) {
    const study_parameter *parameter = s->parameters + k;
    one->choice[k] = number % parameter->nvalues;
    number /= parameter->nvalues;
    GH_TRY(gh_copy_text(s->ctx, parameter->value[one->choice[k]], &one->value[k]));
  }
  one->reference = -1;
  return gh_copy_text(s->ctx, "", &one->also);
}

static gh_status count_rows(gh_study *s, int *rows) {
  double product = 1;
  for (int k = 0; k < s->nparameters; k++) product *= s->parameters[k].nvalues;
  if (product > MOST_CONFIGS)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: %.0f combinations of values, at most %d are possible", s->path,
                   s->parameters[0].line, product, MOST_CONFIGS);
  *rows = (int)product;
  return GH_OK;
}

/* ---- references ---- */

/* The value of a parameter in the reference of a row. */
static const char *tightened(const gh_study *s, const study_config *row, int parameter) {
  const study_entry *e = find_entry(s->tighter, s->ntighter, s->parameters[parameter].name);
  return e ? e->value : row->value[parameter];
}

static gh_status make_reference(gh_study *s, int row, study_config *one) {
  char also[1024] = "";
  GH_TRY(config_alloc(s, one));
  for (int k = 0; k < s->nparameters; k++) {
    const char *value = tightened(s, s->configs + row, k);
    one->choice[k] = -1;
    for (int j = 0; j < s->parameters[k].nvalues; j++)
      if (same_value(s->parameters[k].value[j], value)) one->choice[k] = j;
    GH_TRY(gh_copy_text(s->ctx, value, &one->value[k]));
  }
  for (int k = 0; k < s->ntighter; k++)
    if (entry_is_beside(s, s->tighter + k)) {
      size_t used = strlen(also);
      char value[256];
      snprintf(also + used, sizeof also - used, "%s%s: %s", used ? ", " : "", s->tighter[k].key,
               study_plain(s->tighter[k].value, value, sizeof value));
    }
  one->extra = true;
  return gh_copy_text(s->ctx, also, &one->also);
}

/* Whether configuration k, which is a row or a reference, is the reference of a row. */
static bool is_reference(const gh_study *s, int k, int row, bool with_more) {
  const study_config *one = s->configs + k;
  if (with_more && !one->extra) return false;
  for (int j = 0; j < s->nparameters; j++)
    if (!same_value(one->value[j], tightened(s, s->configs + row, j))) return false;
  return true;
}

static gh_status add_references(gh_study *s, int rows) {
  bool with_more = false;
  for (int k = 0; k < s->ntighter; k++) with_more = with_more || entry_is_beside(s, s->tighter + k);
  for (int row = 0; row < rows; row++) {
    int found = -1;
    for (int k = 0; k < s->nconfigs && found < 0; k++)
      if (is_reference(s, k, row, with_more)) found = k;
    if (found < 0) {
      found = s->nconfigs++;
      GH_TRY(make_reference(s, row, s->configs + found));
      s->configs[found].reference = found;
    }
    s->configs[row].reference = found;
  }
  return GH_OK;
}

/* ---- members ---- */

/* A text without the quotes that it may need in YAML. */
static gh_status plain_text(gh_study *s, const char *value, char **text) {
  gh_yaml *doc;
  const char *word;
  GH_TRY(gh_yaml_parse(s->ctx, "packing", value, &doc));
  gh_status status = gh_yaml_text(gh_yaml_root(doc), "a pattern of file names", &word);
  if (status == GH_OK) status = gh_copy_text(s->ctx, word, text);
  gh_yaml_destroy(&doc);
  return status;
}

/* The pattern in the study's folder, whose own name is none. */
static char *place_pattern(const char *folder, const char *pattern) {
  char *plain = malloc(2 * strlen(folder) + 1), *path = NULL;
  size_t n = 0;
  for (const char *c = folder; plain && *c; c++) {
    if (strchr("*?[\\", *c)) plain[n++] = '\\';
    plain[n++] = *c;
  }
  if (plain) {
    plain[n] = 0;
    path = gh_path_join(plain, pattern);
  }
  free(plain);
  return path;
}

/* Names of files become words of pictures and tables. */
static gh_status copy_file(gh_study *s, const char *name, char **copy) {
  char what[GH_QUOTE], quoted[GH_QUOTE];
  if (gh_unprintable(name, what))
    return gh_fail(s->ctx, GH_INPUT, "the name of the file '%s' holds %s", gh_quote(name, quoted), what);
  return gh_copy_text(s->ctx, name, copy);
}

/* Files that fit the pattern, ascending; at least one. */
static gh_status find_files(gh_study *s, const char *pattern, study_config *one) {
  glob_t found = {0};
  char *path = place_pattern(s->folder, pattern);
  if (!path) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
  int code = glob(path, 0, NULL, &found);
  free(path);
  gh_status status = code == GLOB_NOMATCH ? gh_fail(s->ctx, GH_INPUT, "no file fits this pattern")
                     : code != 0          ? gh_fail(s->ctx, GH_MEMORY, "no memory for a list of files")
                                          : GH_OK;
  if (status == GH_OK) status = gh_alloc(s->ctx, found.gl_pathc, sizeof *one->files, &one->files);
  if (status == GH_OK) one->nruns = (int)found.gl_pathc;
  for (int k = 0; k < one->nruns && status == GH_OK; k++)
    status = copy_file(s, found.gl_pathv[k], &one->files[k]);
  globfree(&found);
  return status;
}

static gh_status find_members(gh_study *s, study_config *one) {
  const char *value = study_value(s, one, "packing");
  char *pattern = NULL;
  if (!value) {
    one->nruns = 1;
    return gh_alloc(s->ctx, 1, sizeof *one->runs, &one->runs);
  }
  gh_status status = plain_text(s, value, &pattern);
  if (status == GH_OK) status = find_files(s, pattern, one);
  free(pattern);
  if (status == GH_INPUT)
    return gh_prefix(s->ctx, status, "%s:%d: packing: %s: ", s->path, study_line(s, one, "packing"), value);
  GH_TRY(status);
  GH_TRY(gh_alloc(s->ctx, (size_t)one->nruns, sizeof *one->runs, &one->runs));
  for (int k = 0; k < one->nruns; k++) one->runs[k].packing = one->files[k];
  return GH_OK;
}

gh_status study_plan(gh_study *s) {
  int rows = 0;
  GH_TRY(count_rows(s, &rows));
  GH_TRY(gh_alloc(s->ctx, 2 * (size_t)rows, sizeof *s->configs, &s->configs));
  for (int k = 0; k < rows; k++) {
    s->nconfigs = k + 1;
    GH_TRY(config_combine(s, k, s->configs + k));
  }
  if (s->reference == STUDY_CONFIG) GH_TRY(add_references(s, rows));
  for (int k = 0; k < s->nconfigs; k++) GH_TRY(find_members(s, s->configs + k));
  return GH_OK;
}

void study_curve_free(study_curve *curve) {
  free(curve->t);
  free(curve->value);
  *curve = (study_curve){0};
}

void study_configs_destroy(gh_study *s) {
  for (int k = 0; k < s->nconfigs; k++) {
    study_config *one = s->configs + k;
    for (int j = 0; j < s->nparameters && one->value; j++) free(one->value[j]);
    for (int j = 0; j < one->nruns; j++) {
      if (one->runs) study_curve_free(&one->runs[j].curve);
      if (one->files) free(one->files[j]);
    }
    free(one->value);
    free(one->choice);
    free(one->also);
    free(one->files);
    free(one->runs);
  }
  free(s->configs);
}
