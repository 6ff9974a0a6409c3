/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Reads a study file and checks all that it names. Every complaint begins with file:line. */
#include "io/file.h"
#include "study/parts.h"

#include <libgen.h>
#include <stdlib.h>
#include <string.h>

/* A value as one line of YAML; the caller frees. */
static gh_status one_line(gh_study *s, node n, char **value) {
  gh_text *text;
  GH_TRY(gh_text_create(s->ctx, &text));
  gh_yaml_print(n, text);
  gh_status status = gh_text_check(text);
  if (status == GH_OK) status = gh_copy_text(s->ctx, gh_text_get(text, NULL), value);
  gh_text_destroy(&text);
  if (status == GH_OK && !**value) return gh_yaml_fail(n, "a value is missing");
  return status;
}

/* ---- keys with values: base, reference ---- */

static void free_entries(study_entry *list, int n) {
  for (int k = 0; k < n; k++) {
    free(list[k].key);
    free(list[k].value);
  }
  free(list);
}

static gh_status add_entry(gh_study *s, const char *key, node value, study_entry **list, int *n) {
  study_entry *e = NULL;
  for (int k = 0; k < *n; k++)
    if (strcmp((*list)[k].key, key) == 0) e = *list + k; /* an entry of `quick` goes before */
  if (!e) {
    study_entry *more = realloc(*list, ((size_t)*n + 1) * sizeof **list);
    if (!more) return gh_fail(s->ctx, GH_MEMORY, "no memory for the keys of a study");
    *list = more;
    e = more + *n;
    *e = (study_entry){0};
    ++*n;
    GH_TRY(gh_copy_text(s->ctx, key, &e->key));
  }
  free(e->value);
  e->value = NULL;
  e->line = gh_yaml_line(value);
  return one_line(s, value, &e->value);
}

static gh_status read_entries(gh_study *s, node map, const char *what, study_entry **list, int *n) {
  if (!gh_yaml_has(map)) return GH_OK;
  if (!gh_yaml_is_map(map)) return gh_yaml_fail(map, "%s must be a map: {micro.tolerance: 1e-9, ...}", what);
  for (int k = 0; k < gh_yaml_length(map); k++) {
    node value;
    const char *key = gh_yaml_key(map, k, &value);
    GH_TRY(add_entry(s, key, value, list, n));
  }
  return GH_OK;
}

/* ---- parameters ---- */

static gh_status read_values(gh_study *s, node list, study_parameter *parameter) {
  int count = gh_yaml_length(list);
  if (!gh_yaml_is_list(list) || count < 1)
    return gh_yaml_fail(list, "%s: a list of values is required: [1e-2, 1e-4, ...]", parameter->name);
  GH_TRY(gh_alloc(s->ctx, (size_t)count, sizeof *parameter->value, &parameter->value));
  GH_TRY(gh_alloc(s->ctx, (size_t)count, sizeof *parameter->number, &parameter->number));
  for (int k = 0; k < count; k++) {
    node item = gh_yaml_item(list, k);
    parameter->nvalues = k + 1;
    GH_TRY(one_line(s, item, &parameter->value[k]));
    if (!gh_parse_number(parameter->value[k], &parameter->number[k])) parameter->number[k] = NAN;
    for (int j = 0; j < k; j++)
      if (strcmp(parameter->value[j], parameter->value[k]) == 0 ||
          parameter->number[j] == parameter->number[k])
        return gh_yaml_fail(item, "%s: the value %s is there twice", parameter->name, parameter->value[k]);
  }
  return GH_OK;
}

static gh_status read_parameters(gh_study *s, node vary) {
  char what[GH_QUOTE];
  if (!gh_yaml_is_map(vary) || gh_yaml_length(vary) < 1)
    return gh_yaml_fail(vary, "vary must be a map of keys and lists: {micro.tolerance: [1e-2, 1e-4], ...}");
  GH_TRY(gh_alloc(s->ctx, (size_t)gh_yaml_length(vary), sizeof *s->parameters, &s->parameters));
  for (int k = 0; k < gh_yaml_length(vary); k++) {
    node list;
    const char *name = gh_yaml_key(vary, k, &list);
    study_parameter *parameter = s->parameters + k;
    s->nparameters = k + 1;
    parameter->line = gh_yaml_line(list);
    if (gh_unprintable(name, what)) return gh_yaml_fail(list, "a key under vary holds %s", what);
    GH_TRY(gh_copy_text(s->ctx, name, &parameter->name));
    GH_TRY(read_values(s, list, parameter));
  }
  return GH_OK;
}

/* The parameter that an optional key names. `whole`: `vary` of the whole study; with --quick, a name that is
 * there alone is none. */
static gh_status read_parameter_name(const gh_study *s, node whole, node n, const char *what,
                                     int *parameter) {
  const char *name;
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(gh_yaml_text(n, what, &name));
  for (int k = 0; k < s->nparameters; k++) {
    if (strcmp(s->parameters[k].name, name) != 0) continue;
    *parameter = k;
    return GH_OK;
  }
  if (gh_yaml_is_map(whole) && gh_yaml_has(gh_yaml_get(whole, name))) return GH_OK;
  return gh_yaml_fail(n, "%s: '%s' is none of the keys under vary", what, name);
}

static gh_status read_order(gh_study *s, node whole, node n) {
  s->order = -1;
  GH_TRY(read_parameter_name(s, whole, n, "order", &s->order));
  for (int k = 0; s->order >= 0 && k < s->parameters[s->order].nvalues; k++)
    if (!(s->parameters[s->order].number[k] > 0))
      return gh_yaml_fail(n, "order: the values of %s must be numbers above 0, and '%s' is none",
                          s->parameters[s->order].name, s->parameters[s->order].value[k]);
  return GH_OK;
}

/* ---- reference ---- */

static gh_status read_closed_form(gh_study *s, node n) {
  const char *word;
  GH_TRY(gh_yaml_text(n, "closed_form", &word));
  if (strcmp(word, "triangular-lattice") != 0)
    return gh_yaml_fail(n, "closed_form '%s' is not known; there is: triangular-lattice", word);
  if (s->scene) return gh_yaml_fail(n, "a closed form belongs to one packing along a path (rve)");
  s->reference = STUDY_CLOSED_FORM;
  return gh_copy_text(s->ctx, "the closed form of a triangular lattice", &s->reference_text);
}

static gh_status read_reference_file(gh_study *s, node n) {
  const char *name;
  GH_TRY(gh_yaml_text(n, "file", &name));
  s->reference = STUDY_FILE;
  s->reference_file = gh_path_join(s->folder, name);
  if (!s->reference_file) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
  return gh_copy_text(s->ctx, name, &s->reference_text);
}

static gh_status read_tighter(gh_study *s, node set) {
  char words[512] = "the same with ", value[256];
  s->reference = STUDY_CONFIG;
  GH_TRY(read_entries(s, set, "set", &s->tighter, &s->ntighter));
  if (s->ntighter == 0) return gh_yaml_fail(set, "set has no key: nothing would differ from the reference");
  for (int k = 0; k < s->ntighter; k++) {
    size_t used = strlen(words);
    snprintf(words + used, sizeof words - used, "%s%s %s", k ? ", " : "", s->tighter[k].key,
             study_plain(s->tighter[k].value, value, sizeof value));
  }
  return gh_copy_text(s->ctx, words, &s->reference_text);
}

static gh_status read_reference(gh_study *s, node n) {
  GH_TRY(gh_yaml_map(n, "reference", study_reference_keys));
  node set = gh_yaml_get(n, "set"), file = gh_yaml_get(n, "file"), form = gh_yaml_get(n, "closed_form");
  s->reference_line = gh_yaml_line(n);
  if (gh_yaml_has(set) + gh_yaml_has(file) + gh_yaml_has(form) != 1)
    return gh_yaml_fail(n, "reference needs one of the keys 'set', 'file' and 'closed_form'");
  if (gh_yaml_has(set)) return read_tighter(s, set);
  return gh_yaml_has(file) ? read_reference_file(s, file) : read_closed_form(s, form);
}

/* ---- the problem ---- */

static gh_status read_problem(gh_study *s, node root) {
  node scene = gh_yaml_get(root, "scene"), rve = gh_yaml_get(root, "rve"), packing;
  if (gh_yaml_has(scene) == gh_yaml_has(rve))
    return gh_yaml_fail(root, "a study needs one of the keys 'scene' and 'rve'");
  s->scene = gh_yaml_has(scene);
  s->problem_line = gh_yaml_line(s->scene ? scene : rve);
  if (s->scene) {
    const char *name;
    GH_TRY(gh_yaml_text(scene, "scene", &name));
    s->scene_path = gh_path_join(s->folder, name);
    return s->scene_path ? GH_OK : gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
  }
  GH_TRY(gh_yaml_map(rve, "rve", study_rve_keys));
  GH_TRY(gh_yaml_need(rve, "rve", "packing", &packing));
  return add_entry(s, "packing", packing, &s->base, &s->nbase);
}

static gh_status read_labels(gh_study *s, node root) {
  node n = gh_yaml_get(root, "title"), units = gh_yaml_get(root, "units");
  const char *title = NULL, *length = "", *force = "";
  char *copy = strdup(s->path);
  if (!copy) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_yaml_has(n) ? gh_yaml_text(n, "title", &title) : GH_OK;
  if (status == GH_OK) status = gh_copy_text(s->ctx, title ? title : basename(copy), &s->title);
  free(copy);
  GH_TRY(status);
  if (!gh_yaml_has(units)) return GH_OK; /* a scene has its own */
  GH_TRY(gh_yaml_map(units, "units", study_units_keys));
  if (gh_yaml_has(n = gh_yaml_get(units, "length"))) GH_TRY(gh_yaml_text(n, "length", &length));
  if (gh_yaml_has(n = gh_yaml_get(units, "force"))) GH_TRY(gh_yaml_text(n, "force", &force));
  GH_TRY(gh_copy_text(s->ctx, length, &s->length_unit));
  return gh_copy_text(s->ctx, force, &s->force_unit);
}

/* ---- goals, and what is known once there are columns ---- */

static int descending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x < y) - (x > y);
}

static gh_status read_goals(gh_study *s, node list) {
  static const double usual[] = {1e-2, 1e-3, 1e-6};
  int count = gh_yaml_length(list);
  if (gh_yaml_has(list) && (!gh_yaml_is_list(list) || count < 1))
    return gh_yaml_fail(list, "goals must be a list of numbers: [1e-2, 1e-3, 1e-6]");
  s->ngoals = gh_yaml_has(list) ? count : 3;
  GH_TRY(gh_alloc(s->ctx, (size_t)s->ngoals, sizeof *s->goals, &s->goals));
  for (int k = 0; k < s->ngoals; k++) {
    s->goals[k] = usual[k % 3];
    if (gh_yaml_has(list)) GH_TRY(gh_yaml_positive(gh_yaml_item(list, k), "a goal", s->goals + k));
  }
  qsort(s->goals, (size_t)s->ngoals, sizeof *s->goals, descending);
  return GH_OK;
}

/* Chooses and orders what there is by the names of an optional list. */
static gh_status choose_quantities(gh_study *s, node list) {
  if (gh_yaml_has(list) && !gh_yaml_is_list(list))
    return gh_yaml_fail(list, "quantities must be a list: [%s, ...]", s->quantities[0].name);
  if (gh_yaml_has(list) && gh_yaml_length(list) < 1) return gh_yaml_fail(list, "quantities is an empty list");
  for (int k = 0; k < gh_yaml_length(list); k++) {
    const char *name;
    int found = -1;
    GH_TRY(gh_yaml_text(gh_yaml_item(list, k), "a quantity", &name));
    for (int j = 0; j < s->nquantities; j++)
      if (strcmp(s->quantities[j].name, name) == 0) found = j;
    if (found < 0)
      return gh_yaml_fail(gh_yaml_item(list, k), "quantity '%s' is none of %s, %s%s%s", name,
                          s->quantities[0].name, s->quantities[1].name, s->nquantities > 2 ? ", " : "",
                          s->nquantities > 2 ? s->quantities[2].name : "");
    if (found < k) return gh_yaml_fail(gh_yaml_item(list, k), "quantity '%s' is there twice", name);
    study_quantity q = s->quantities[found]; /* those that are chosen stand at the start */
    memmove(s->quantities + k + 1, s->quantities + k, (size_t)(found - k) * sizeof q);
    s->quantities[k] = q;
  }
  if (gh_yaml_has(list)) s->nquantities = gh_yaml_length(list);
  return GH_OK;
}

static gh_status read_plots(gh_study *s, node list) {
  if (!gh_yaml_has(list)) return GH_OK;
  if (!gh_yaml_is_list(list)) return gh_yaml_fail(list, "plots must be a list of columns: [P11, ...]");
  GH_TRY(gh_alloc(s->ctx, (size_t)gh_yaml_length(list), sizeof *s->plots, &s->plots));
  for (int k = 0; k < gh_yaml_length(list); k++) {
    const char *name;
    int found = -1;
    GH_TRY(gh_yaml_text(gh_yaml_item(list, k), "a column", &name));
    for (int c = 0; c < s->ncolumns; c++)
      if (strcmp(s->column[c], name) == 0) found = c;
    if (found < 0) {
      char words[256] = "";
      for (int c = 0; c < s->ncolumns; c++)
        snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s", c ? ", " : "", s->column[c]);
      return gh_yaml_fail(gh_yaml_item(list, k), "column '%s' is none of %s", name, words);
    }
    s->plots[s->nplots++] = found;
  }
  return GH_OK;
}

/* ---- each run, before it starts ---- */

static gh_status study_locate(gh_study *s, int line, const char *key, const char *value) {
  if (!key) return gh_prefix(s->ctx, GH_INPUT, "%s:%d: ", s->path, line);
  return gh_prefix(s->ctx, GH_INPUT, "%s:%d: %s: %s: ", s->path, line, key, value);
}

/* Names the key without which the run would be in order; the message of the failure is in the context. */
static gh_status study_blame(gh_study *s, int config, int member) {
  gh_override *list;
  int *line, count, guilty = -1;
  char message[2048];
  snprintf(message, sizeof message, "%s", gh_message(s->ctx));
  GH_TRY(study_overrides(s, s->configs + config, &list, &line, &count));
  for (int k = 0; k < count && guilty < 0; k++) {
    study_problem p;
    if (study_problem_open(s->ctx, s, config, member, k, &p) == GH_OK) guilty = k;
    study_problem_close(&p);
  }
  gh_fail(s->ctx, GH_INPUT, "%s", message);
  if (guilty >= 0) study_locate(s, line[guilty], list[guilty].key, list[guilty].value);
  else study_locate(s, s->problem_line, NULL, NULL);
  free(list);
  free(line);
  return GH_INPUT;
}

static gh_status take_columns(gh_study *s, int config, const study_problem *p) {
  char name[256];
  if (s->ncolumns > 0) {
    const bool driven = p->scene && study_measures_force(p->scene);
    if (!p->scene || driven == (strcmp(s->quantities[1].name, "force") == 0)) return GH_OK;
    study_run_name(s, config, -1, name, sizeof name);
    return gh_fail(
        s->ctx, GH_INPUT,
        "%s:%d: %s: here %s is driven, unlike in the configurations before: they cannot be compared", s->path,
        s->problem_line, name, driven ? "an edge" : "nothing");
  }
  GH_TRY(study_columns(s, p));
  if (!p->scene) return GH_OK;
  if (!s->length_unit) GH_TRY(gh_copy_text(s->ctx, gh_scene_length_unit(p->scene), &s->length_unit));
  return s->force_unit ? GH_OK : gh_copy_text(s->ctx, gh_scene_force_unit(p->scene), &s->force_unit);
}

/* An ensemble with copies would look surer of its mean than it is. */
static gh_status check_copies(gh_study *s, int config) {
  const study_config *one = s->configs + config;
  for (int m = 1; m < one->nruns; m++)
    for (int k = 0; k < m; k++)
      if (strcmp(one->runs[k].id, one->runs[m].id) == 0)
        return gh_fail(s->ctx, GH_INPUT, "%s:%d: packing: %s and %s hold the same: members must differ",
                       s->path, study_line(s, one, "packing"), one->files[k], one->files[m]);
  return GH_OK;
}

static gh_status check_run(gh_study *s, int config, int member, study_path *path) {
  study_problem p;
  study_run *run = s->configs[config].runs + member;
  gh_status status = study_problem_open(s->ctx, s, config, member, -1, &p);
  if (status == GH_INPUT) status = study_blame(s, config, member);
  if (status == GH_OK) {
    memcpy(run->id, p.id, sizeof run->id);
    status = take_columns(s, config, &p);
    if (status == GH_OK) status = study_inputs_note(s, &p);
  }
  if (member == 0) {
    *path = p.path;
    p.path = (study_path){0};
  }
  study_problem_close(&p);
  return status;
}

/* What is compared at one t must have been deformed alike. */
static gh_status check_paths(gh_study *s, const study_path *path) {
  for (int k = 0; k < s->nconfigs && !s->scene; k++) {
    const int with = s->configs[k].reference >= 0 ? s->configs[k].reference : 0;
    char name[256];
    double t;
    if (study_path_agree(path + k, path + with, &t)) continue;
    study_run_name(s, k, -1, name, sizeof name);
    return gh_fail(s->ctx, GH_INPUT,
                   "%s:%d: reference: %s: at t = %g, F is not that of what it is compared with; t counts the "
                   "rows of a path, and `refine` alone keeps them in their places",
                   s->path, s->reference_line, name, t);
  }
  return GH_OK;
}

static gh_status check_runs(gh_study *s) {
  study_path *path;
  gh_status status = GH_OK;
  GH_TRY(gh_alloc(s->ctx, (size_t)s->nconfigs, sizeof *path, &path));
  for (int k = 0; k < s->nconfigs && status == GH_OK; k++) {
    for (int m = 0; m < s->configs[k].nruns && status == GH_OK; m++) status = check_run(s, k, m, path + k);
    if (status == GH_OK) status = check_copies(s, k);
  }
  if (status == GH_OK) status = check_paths(s, path);
  for (int k = 0; k < s->nconfigs; k++) study_path_free(path + k);
  free(path);
  return status;
}

/* ---- the whole ---- */

static gh_status read_root(gh_study *s, node root) {
  node quick = {.doc = root.doc}, vary, reference;
  GH_TRY(gh_yaml_map(root, "a study", study_keys));
  if (gh_yaml_has(gh_yaml_get(root, "quick"))) {
    GH_TRY(gh_yaml_map(gh_yaml_get(root, "quick"), "quick", study_quick_keys));
    if (s->quick) quick = gh_yaml_get(root, "quick");
  }
  GH_TRY(read_labels(s, root));
  GH_TRY(read_problem(s, root));
  GH_TRY(read_entries(s, gh_yaml_get(root, "base"), "base", &s->base, &s->nbase));
  GH_TRY(read_entries(s, gh_yaml_get(quick, "base"), "base", &s->base, &s->nbase));
  GH_TRY(gh_yaml_need(root, "a study", "vary", &vary));
  GH_TRY(gh_yaml_need(root, "a study", "reference", &reference));
  if (gh_yaml_has(gh_yaml_get(quick, "vary"))) vary = gh_yaml_get(quick, "vary");
  if (gh_yaml_has(gh_yaml_get(quick, "reference"))) reference = gh_yaml_get(quick, "reference");
  GH_TRY(read_parameters(s, vary));
  GH_TRY(read_reference(s, reference));
  const node whole = gh_yaml_get(root, "vary");
  GH_TRY(read_order(s, whole, gh_yaml_get(root, "order")));
  GH_TRY(read_parameter_name(s, whole, gh_yaml_get(root, "series"), "series", &s->series));
  GH_TRY(read_goals(s, gh_yaml_get(root, "goals")));
  GH_TRY(study_check_keys(s));
  GH_TRY(study_plan(s));
  GH_TRY(check_runs(s));
  GH_TRY(choose_quantities(s, gh_yaml_get(root, "quantities")));
  GH_TRY(read_plots(s, gh_yaml_get(root, "plots")));
  if (!s->length_unit) GH_TRY(gh_copy_text(s->ctx, "", &s->length_unit));
  if (!s->force_unit) GH_TRY(gh_copy_text(s->ctx, "", &s->force_unit));
  return study_reference(s);
}

gh_status gh_study_read(gh_context *ctx, const char *path, bool quick, gh_study **study) {
  *study = NULL;
  gh_yaml *doc = NULL;
  GH_TRY(gh_file_expect(ctx, gh_yaml_read(ctx, path, &doc), path, GH_FILE_STUDY));
  gh_status status = gh_alloc(ctx, 1, sizeof **study, study);
  if (status == GH_OK) {
    gh_study *s = *study;
    s->ctx = ctx, s->quick = quick;
    s->folder = gh_path_folder(path);
    status = s->folder ? gh_copy_text(ctx, path, &s->path) : gh_fail(ctx, GH_MEMORY, "no memory for a path");
    if (status == GH_OK) status = read_root(s, gh_yaml_root(doc));
  }
  gh_yaml_destroy(&doc);
  if (status != GH_OK) gh_study_destroy(study);
  return gh_file_expect(ctx, status, path, GH_FILE_STUDY);
}

static void destroy_parameters(gh_study *s) {
  for (int k = 0; k < s->nparameters; k++) {
    for (int j = 0; j < s->parameters[k].nvalues; j++) free(s->parameters[k].value[j]);
    free(s->parameters[k].value);
    free(s->parameters[k].number);
    free(s->parameters[k].name);
  }
  free(s->parameters);
}

void gh_study_destroy(gh_study **study) {
  if (!study || !*study) return;
  gh_study *s = *study;
  study_verdict_destroy(s);
  study_configs_destroy(s);
  destroy_parameters(s);
  free_entries(s->base, s->nbase);
  free_entries(s->tighter, s->ntighter);
  study_curve_free(&s->given);
  for (int c = 0; c < s->ncolumns; c++) free(s->column[c]);
  free(s->column);
  free(s->quantities);
  free(s->goals);
  free(s->plots);
  free(s->reference_text);
  free(s->reference_file);
  study_inputs_free(s);
  free(s->scene_path);
  free(s->folder);
  free(s->title);
  free(s->length_unit);
  free(s->force_unit);
  free(s->path);
  free(s);
  *study = NULL;
}
