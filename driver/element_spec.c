/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What `granhom element` shall do. */
#include "element_spec.h"
#include "reference.h"

#include "granhom/io.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_INCREMENTS = 1000000, MOST_DEPTH = 4 };

void element_spec_free(element_spec *spec) {
  free(spec->steps);
  *spec = (element_spec){0};
}

static gh_status add(gh_context *ctx, element_spec *spec, const element_step *step) {
  GH_TRY(gh_grow(ctx, (size_t)spec->nsteps + 1, sizeof *step, &spec->capacity, &spec->steps));
  spec->steps[spec->nsteps++] = *step;
  spec->increments += step->increments;
  return GH_OK;
}

/* Three conditions leave the rotation: what is horizontal keeps its direction. */
static void add_rotation(element_step *step) {
  step->condition[3] = (gh_condition){.factor = {[GH_QUANTITY_F21] = 1}};
  step->way[3] = ELEMENT_BY;
  step->value[3] = 0;
}

/* Without rotation and strain; the packing may be elsewhere, and then gh_control_solve reports it. */
static gh_status check(gh_context *ctx, const element_step *step) {
  static const double identity[4] = {1, 0, 0, 1};
  return gh_conditions_check(ctx, step->condition, identity);
}

/* ---- YAML ---- */

const gh_term element_keys[] = {
    {"title", "one line of text"}, {"steps", "required. List of steps and repetitions"}, {0}};

const gh_term element_step_keys[] = {
    {"name", "for messages; default `step N`"},
    {"increments", "required. Number of increments"},
    {"control", "required. Map of three or four conditions; with three, `F21: hold` is the fourth"},
    {"until", "map of one condition and a level: the step ends after the increment that passes it"},
    {0}};

const gh_term element_way_keys[] = {
    {"to", "linear to this value; a number alone means the same"},
    {"by", "by this difference from the value at the start of the step; the word `hold` "
           "means 0"},
    {"times", "to this multiple of the value at the start of the step"},
    {0}};

const gh_term element_repeat_keys[] = {
    {"repeat", "required. How often"}, {"steps", "required. List of steps"}, {0}};

typedef gh_yaml_node node;

static gh_status number(node n, const char *what, double *value) {
  return gh_yaml_number(n, what, -INFINITY, INFINITY, value);
}

/* A number, `hold`, {to: x}, {by: x} or {times: x}. */
static gh_status read_way(node n, const char *key, element_step *step, int k) {
  const gh_term *words = element_way_keys;
  const char *text;
  step->way[k] = ELEMENT_TO;
  if (gh_yaml_is_map(n)) {
    GH_TRY(gh_yaml_terms(n, words));
    if (gh_yaml_length(n) != 1) return gh_yaml_fail(n, "%s: give one of to, by and times", key);
    for (int w = 0; words[w].name; w++) {
      node value = gh_yaml_get(n, words[w].name);
      if (!gh_yaml_has(value)) continue;
      step->way[k] = (element_way)w;
      return number(value, words[w].name, &step->value[k]);
    }
  }
  const bool there = gh_yaml_is_scalar(n) && gh_yaml_text(n, key, &text) == GH_OK;
  if (there && !strcmp(text, "hold")) {
    step->way[k] = ELEMENT_BY;
    step->value[k] = 0;
    return GH_OK;
  }
  double value;
  if (!there || !gh_parse_number(text, &value))
    return gh_yaml_fail(n, "%s must be a number, hold, {to: x}, {by: x} or {times: x}%s", key,
                        there ? gh_number_hint(text) : "");
  step->value[k] = value;
  return GH_OK;
}

static gh_status parse_at(gh_context *ctx, node n, const char *text, gh_condition *c) {
  gh_status status = gh_condition_parse(ctx, text, c);
  return status == GH_OK ? GH_OK : gh_prefix(ctx, status, "%s:%d: ", gh_yaml_path(n), gh_yaml_line(n));
}

static gh_status read_conditions(gh_context *ctx, node step, element_step *s) {
  node map = gh_yaml_get(step, "control");
  if (!gh_yaml_has(map)) return gh_yaml_fail(step, "a step needs the key 'control'");
  if (!gh_yaml_is_map(map)) return gh_yaml_fail(map, "control must be a map of conditions");
  int count = gh_yaml_length(map);
  if (count != 3 && count != 4)
    return gh_yaml_fail(map,
                        "control has %d condition%s; it needs three, and F21: hold is the fourth, or four",
                        count, count == 1 ? "" : "s");
  for (int k = 0; k < count; k++) {
    node value;
    const char *key = gh_yaml_key(map, k, &value);
    s->line[k] = gh_yaml_line(value);
    GH_TRY(parse_at(ctx, value, key, &s->condition[k]));
    GH_TRY(read_way(value, key, s, k));
  }
  if (count == 3) add_rotation(s);
  gh_status status = check(ctx, s);
  return status == GH_OK ? GH_OK : gh_prefix(ctx, status, "%s:%d: ", gh_yaml_path(map), gh_yaml_line(map));
}

static gh_status read_until(gh_context *ctx, node step, element_step *s) {
  node map = gh_yaml_get(step, "until"), value;
  if (!gh_yaml_has(map)) return GH_OK;
  if (!gh_yaml_is_map(map) || gh_yaml_length(map) != 1)
    return gh_yaml_fail(map, "until must be a map of one condition, like {s12: 0.05}");
  const char *key = gh_yaml_key(map, 0, &value);
  GH_TRY(parse_at(ctx, value, key, &s->end));
  s->until = true;
  return number(value, key, &s->level);
}

static gh_status read_steps(gh_context *ctx, node list, int depth, element_spec *spec);

static gh_status read_repeat(gh_context *ctx, node item, int depth, element_spec *spec) {
  long times;
  GH_TRY(gh_yaml_terms(item, element_repeat_keys));
  GH_TRY(gh_yaml_integer(gh_yaml_get(item, "repeat"), "repeat", 1, MOST_INCREMENTS, &times));
  if (depth == MOST_DEPTH) return gh_yaml_fail(item, "repeat within repeat, more than %d deep", MOST_DEPTH);
  for (long k = 0; k < times; k++) GH_TRY(read_steps(ctx, gh_yaml_get(item, "steps"), depth + 1, spec));
  return GH_OK;
}

static gh_status read_step(gh_context *ctx, node item, element_spec *spec) {
  element_step step = {0};
  node n;
  long increments;
  GH_TRY(gh_yaml_terms(item, element_step_keys));
  snprintf(step.name, sizeof step.name, "step %d", spec->nsteps + 1);
  if (gh_yaml_has(n = gh_yaml_get(item, "name"))) {
    const char *text;
    GH_TRY(gh_yaml_text(n, "name", &text));
    snprintf(step.name, sizeof step.name, "%s", text);
  }
  if (!gh_yaml_has(n = gh_yaml_get(item, "increments")))
    return gh_yaml_fail(item, "a step needs the key 'increments'");
  GH_TRY(gh_yaml_integer(n, "increments", 1, MOST_INCREMENTS, &increments));
  if (increments > MOST_INCREMENTS - spec->increments)
    return gh_yaml_fail(item, "more than %d increments", MOST_INCREMENTS);
  step.increments = (int)increments;
  GH_TRY(read_conditions(ctx, item, &step));
  GH_TRY(read_until(ctx, item, &step));
  return add(ctx, spec, &step);
}

static gh_status read_steps(gh_context *ctx, node list, int depth, element_spec *spec) {
  if (!gh_yaml_is_list(list) || gh_yaml_length(list) < 1)
    return gh_yaml_fail(list, "steps must be a list of at least one step");
  for (int k = 0; k < gh_yaml_length(list); k++) {
    node item = gh_yaml_item(list, k);
    if (!gh_yaml_is_map(item)) return gh_yaml_fail(item, "a step must be a map");
    bool repeat = gh_yaml_has(gh_yaml_get(item, "repeat"));
    GH_TRY(repeat ? read_repeat(ctx, item, depth, spec) : read_step(ctx, item, spec));
  }
  return GH_OK;
}

gh_status element_spec_read(gh_context *ctx, const char *path, element_spec *spec) {
  gh_yaml *doc;
  *spec = (element_spec){.path = path};
  GH_TRY(gh_file_expect(ctx, gh_yaml_read(ctx, path, &doc), path, GH_FILE_CONTROL));
  node root = gh_yaml_root(doc);
  gh_status status = gh_yaml_is_map(root)
                         ? gh_yaml_terms(root, element_keys)
                         : gh_yaml_fail(root, "a control file is a map with the key 'steps'");
  if (status == GH_OK) status = read_steps(ctx, gh_yaml_get(root, "steps"), 0, spec);
  gh_yaml_destroy(&doc);
  return gh_file_expect(ctx, status, path, GH_FILE_CONTROL);
}

/* ---- CSV ---- */

static gh_status read_columns(gh_context *ctx, const char *path, const gh_csv *csv, element_step *step,
                              int column[4]) {
  int count = 0;
  for (int c = 0; c < csv->ncols; c++) {
    if (!strcmp(csv->names[c], "step")) continue;
    if (count == 4)
      return gh_fail(ctx, GH_INPUT, "%s:1: more than four conditions; a row has three, or four", path);
    gh_status status = gh_condition_parse(ctx, csv->names[c], &step->condition[count]);
    if (status != GH_OK) return gh_prefix(ctx, status, "%s:1: ", path);
    column[count++] = c;
  }
  if (count < 3)
    return gh_fail(ctx, GH_INPUT, "%s:1: %d condition%s; a row needs three, and F21 is fixed, or four", path,
                   count, count == 1 ? "" : "s");
  if (count == 3) add_rotation(step);
  if (count == 3) column[3] = -1;
  gh_status status = check(ctx, step);
  if (status != GH_OK) return gh_prefix(ctx, status, "%s:1: ", path);
  return csv->nrows ? GH_OK : gh_fail(ctx, GH_INPUT, "%s: the path has no rows", path);
}

gh_status element_spec_read_path(gh_context *ctx, const char *path, element_spec *spec) {
  gh_csv *csv;
  element_step step = {.increments = 1};
  int column[4];
  *spec = (element_spec){.path = path};
  GH_TRY(gh_file_expect(ctx, gh_csv_read(ctx, path, &csv), path, GH_FILE_CONDITIONS));
  gh_status status = read_columns(ctx, path, csv, &step, column);
  for (int row = 0; row < csv->nrows && status == GH_OK; row++) {
    snprintf(step.name, sizeof step.name, "%s:%d", path, csv->line[row]);
    for (int k = 0; k < 4; k++)
      if (column[k] >= 0)
        step.value[k] = csv->value[row * csv->ncols + column[k]], step.line[k] = csv->line[row];
    status = add(ctx, spec, &step);
  }
  gh_csv_destroy(&csv);
  return gh_file_expect(ctx, status, path, GH_FILE_CONDITIONS);
}
