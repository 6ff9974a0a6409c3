/* What `granhom pack` shall do. SPDX-License-Identifier: GPL-2.0-or-later */
#include "pack_spec.h"
#include "reference.h"

#include "granhom/io.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

void pack_spec_init(pack_spec *spec) {
  *spec = (pack_spec){.dim = 2, .grow = gh_grow_defaults(2), .soft_options = gh_finish_defaults()};
  spec->grow.rate = NAN;
}

void pack_spec_free(pack_spec *spec) {
  free(spec->sieve);
  free(spec->output);
  free(spec->picture);
  *spec = (pack_spec){0};
}

/* ---- one setting ---- */

typedef struct setting { /* being set */
  gh_context *ctx;
  pack_spec *spec;
  const char *where, *text;
} setting;

static gh_status refuse(const setting *s, const char *wanted) {
  return gh_fail(s->ctx, GH_INPUT, "%s: '%s' is not %s", s->where, s->text, wanted);
}

static gh_status set_text(const setting *s, char **value) {
  free(*value);
  *value = strdup(s->text);
  return *value ? GH_OK : gh_fail(s->ctx, GH_MEMORY, "%s: no memory", s->where);
}

static gh_status set_integer(const setting *s, long low, long high, int *value) {
  long number;
  char wanted[64];
  snprintf(wanted, sizeof wanted, "a whole number from %ld to %ld", low, high);
  if (!gh_parse_integer(s->text, low, high, &number)) return refuse(s, wanted);
  *value = (int)number;
  return GH_OK;
}

static gh_status set_positive(const setting *s, double *value) {
  if (gh_parse_number(s->text, value) && *value > 0) return GH_OK;
  return refuse(s, "a positive number");
}

static gh_status set_threshold(const setting *s) {
  double *value = &s->spec->grow.threshold;
  if (gh_parse_number(s->text, value) && *value >= 0 && *value < 1) return GH_OK;
  return refuse(s, "a number from 0 to below 1");
}

static gh_status set_fraction(const setting *s) {
  double *value = &s->spec->grow.volume_fraction;
  if (gh_parse_number(s->text, value) && *value > 0 && *value < 1) return GH_OK;
  return refuse(s, "a volume fraction, above 0 and below 1");
}

/* Up to three numbers with commas between them. */
static gh_status set_numbers(const setting *s, const char *wanted, double low, double *value, int *count) {
  char copy[256], *rest = copy;
  if (strlen(s->text) >= sizeof copy) return refuse(s, wanted);
  strcpy(copy, s->text);
  for (*count = 0; rest && *count < 3; (*count)++) {
    char *word = rest + strspn(rest, " "), *comma = strchr(word, ',');
    rest = comma ? comma + 1 : NULL;
    if (comma) *comma = 0;
    for (char *end = word + strlen(word); end > word && end[-1] == ' ';) *--end = 0;
    if (!gh_parse_number(word, &value[*count]) || !(value[*count] > low)) return refuse(s, wanted);
  }
  return rest ? refuse(s, wanted) : GH_OK;
}

static gh_status set_seed(const setting *s) {
  long seed;
  if (!gh_parse_integer(s->text, 0, LONG_MAX, &seed)) return refuse(s, "a whole number from 0");
  s->spec->grow.seed = (unsigned long long)seed;
  return GH_OK;
}

static gh_status set_collision(const setting *s) {
  gh_collision *rule = &s->spec->grow.collision;
  if (!strcmp(s->text, "exchange")) return *rule = GH_COLLISION_EXCHANGE, GH_OK;
  if (!strcmp(s->text, "momentum")) return *rule = GH_COLLISION_MOMENTUM, GH_OK;
  return refuse(s, "exchange or momentum");
}

static gh_status set_engine(const setting *s) {
  gh_engine_kind *engine = &s->spec->soft_options.engine;
  s->spec->soft = true;
  if (!strcmp(s->text, "native")) return *engine = GH_ENGINE_NATIVE, GH_OK;
  if (!strcmp(s->text, "lammps")) return *engine = GH_ENGINE_LAMMPS, GH_OK;
  return refuse(s, "native or lammps");
}

static gh_status set_finish(const setting *s) {
  s->spec->finish = true;
  gh_status status = gh_finish_parse(s->ctx, s->text, &s->spec->soft_options);
  return status == GH_OK ? GH_OK : gh_prefix(s->ctx, status, "%s: ", s->where);
}

static gh_status set_finish_cell(const setting *s) {
  s->spec->soft = true;
  if (gh_finish_cell_from_name(s->text, &s->spec->soft_options.cell)) return GH_OK;
  return refuse(s, "auto, scaled or relaxed");
}

static gh_status set_anisotropy(const setting *s) {
  double *value = &s->spec->soft_options.anisotropy;
  s->spec->soft = true;
  if (gh_parse_number(s->text, value) && *value >= 0 && *value < 1) return GH_OK;
  return refuse(s, "a number from 0 to below 1");
}

static gh_status set_stiffness(const setting *s) {
  s->spec->soft = true;
  return set_positive(s, &s->spec->soft_options.normal_stiffness);
}

enum { MOST_GRAINS = 100000000, MOST_PACKINGS = 999 };

static gh_status set_sieve(const setting *s) {
  return set_text(s, &s->spec->sieve);
}
static gh_status set_output(const setting *s) {
  return set_text(s, &s->spec->output);
}
static gh_status set_picture(const setting *s) {
  return set_text(s, &s->spec->picture);
}
static gh_status set_count(const setting *s) {
  return set_integer(s, 1, MOST_GRAINS, &s->spec->count);
}
static gh_status set_dimension(const setting *s) {
  return set_integer(s, 2, 3, &s->spec->dim);
}
static gh_status set_ensemble(const setting *s) {
  return set_integer(s, 1, MOST_PACKINGS, &s->spec->ensemble);
}
static gh_status set_rate(const setting *s) {
  return set_positive(s, &s->spec->grow.rate);
}
static gh_status set_window(const setting *s) {
  return set_positive(s, &s->spec->grow.window);
}
static gh_status set_seconds(const setting *s) {
  return set_positive(s, &s->spec->grow.seconds);
}
static gh_status set_cell(const setting *s) {
  return set_numbers(s, "two or three positive lengths with commas between them", 0, s->spec->cell,
                     &s->spec->cells);
}
static gh_status set_tilt(const setting *s) {
  return set_numbers(s, "one or three tilts xy,xz,yz with commas between them", -INFINITY, s->spec->tilt,
                     &s->spec->tilts);
}

static const struct {
  const char *name;
  bool in_file; /* also a key of the YAML file */
  gh_status (*set)(const setting *s);
  const char *text; /* of a key */
} settings[] = {
    {"sieve", true, set_sieve, "required. [Sieve curve](files.md#sieve-curves), CSV"},
    {"count", true, set_count, "number of grains; default: the counts of the sieve curve"},
    {"dimension", true, set_dimension, "2 (default) or 3"},
    {"seed", true, set_seed, "default 1; the same seed gives the same packing"},
    {"rate", true, set_rate,
     "growth rate of the mean diameter over the root mean square velocity; default 0.001"},
    {"collision", true, set_collision,
     "`exchange` (default): grains exchange normal velocities; `momentum`: elastic impact with masses as the "
     "volumes"},
    {"volume-fraction", true, set_fraction, "growth ends at this volume fraction"},
    {"threshold", true, set_threshold,
     "growth ends when the volume fraction gains less than this in `window`; default 1e-9"},
    {"window", true, set_window, "collisions per grain; default 1"},
    {"seconds", true, set_seconds, "growth ends after this time"},
    {"cell", true, set_cell, "proportions of the cell, `[1, 1]`"},
    {"tilt", true, set_tilt, "tilt of the cell in the same units"},
    {"finish", true, set_finish, "`overlap=X` or `pressure=P`: soft grains in equilibrium, in the plane"},
    {"finish-cell", true, set_finish_cell,
     "`scaled`: the cell keeps its shape; `relaxed`: until the stress is isotropic; `auto` (default): "
     "relaxed for a pressure without anisotropy"},
    {"normal-stiffness", true, set_stiffness, "force per overlap; default 1"},
    {"anisotropy", true, set_anisotropy, "difference of the principal values of the fabric"},
    {"engine", true, set_engine, "`native` (default) or `lammps`"},
    {"ensemble", true, set_ensemble, "number of packings, with successive seeds"},
    {"output", false, set_output, ""},
    {"picture", false, set_picture, ""}};
enum { SETTINGS = sizeof settings / sizeof *settings };

bool pack_spec_knows(const char *name) {
  for (int k = 0; k < SETTINGS; k++)
    if (!strcmp(settings[k].name, name)) return true;
  return false;
}

gh_status pack_spec_set(gh_context *ctx, pack_spec *spec, const char *name, const char *where,
                        const char *text) {
  setting s = {ctx, spec, where, text};
  for (int k = 0; k < SETTINGS; k++)
    if (!strcmp(settings[k].name, name)) return settings[k].set(&s);
  return gh_fail(ctx, GH_INPUT, "%s: there is no such setting", where);
}

/* ---- a file ---- */

static void key_of(const char *name, char key[32]) {
  snprintf(key, 32, "%s", name);
  for (char *c = key; *c; c++)
    if (*c == '-') *c = '_';
}

/* A scalar as it is; the items of a list with commas between them. */
static gh_status text_of(gh_yaml_node node, const char *key, char text[512]) {
  const char *word;
  size_t at = 0;
  if (!gh_yaml_is_list(node)) {
    GH_TRY(gh_yaml_text(node, key, &word));
    if (snprintf(text, 512, "%s", word) >= 512) return gh_yaml_fail(node, "%s is too long", key);
    return GH_OK;
  }
  text[0] = 0;
  for (int k = 0; k < gh_yaml_length(node); k++) {
    GH_TRY(gh_yaml_text(gh_yaml_item(node, k), key, &word));
    at += (size_t)snprintf(text + at, 512 - at, "%s%s", k ? "," : "", word);
    if (at >= 512) return gh_yaml_fail(node, "%s is too long", key);
  }
  return GH_OK;
}

/* Paths in a file are relative to its folder. */
static gh_status anchor(gh_context *ctx, const char *path, char **name) {
  char *folder = gh_path_folder(path), *joined = folder ? gh_path_join(folder, *name) : NULL;
  free(folder);
  if (!joined) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  free(*name);
  *name = joined;
  return GH_OK;
}

void pack_spec_terms(char names[PACK_MOST_KEYS + 1][32], gh_term terms[PACK_MOST_KEYS + 1]) {
  int n = 0;
  for (int k = 0; k < SETTINGS && n < PACK_MOST_KEYS; k++) {
    if (!settings[k].in_file) continue;
    key_of(settings[k].name, names[n]);
    terms[n] = (gh_term){names[n], settings[k].text};
    n++;
  }
  terms[n] = (gh_term){0};
}

static gh_status read_map(gh_context *ctx, const char *path, gh_yaml_node root, pack_spec *spec) {
  char keys[PACK_MOST_KEYS + 1][32], where[512], text[512];
  gh_term known[PACK_MOST_KEYS + 1];
  pack_spec_terms(keys, known);
  if (!gh_yaml_is_map(root)) return gh_yaml_fail(root, "a packing is described by keys and values");
  GH_TRY(gh_yaml_terms(root, known));
  for (int k = 0; k < SETTINGS; k++) {
    char key[32];
    key_of(settings[k].name, key);
    gh_yaml_node node = settings[k].in_file ? gh_yaml_get(root, key) : (gh_yaml_node){0};
    if (!settings[k].in_file || !gh_yaml_has(node)) continue;
    GH_TRY(text_of(node, key, text));
    snprintf(where, sizeof where, "%s:%d: %s", path, gh_yaml_line(node), key);
    GH_TRY(pack_spec_set(ctx, spec, settings[k].name, where, text));
  }
  return spec->sieve ? anchor(ctx, path, &spec->sieve) : GH_OK;
}

gh_status pack_spec_read(gh_context *ctx, const char *path, pack_spec *spec) {
  gh_yaml *doc;
  GH_TRY(gh_yaml_read(ctx, path, &doc));
  gh_status status = read_map(ctx, path, gh_yaml_root(doc), spec);
  gh_yaml_destroy(&doc);
  return status;
}

/* ---- together ---- */

/* The cell's shape: unit lengths where none are given; tilts are in the same units. */
static gh_status shape(gh_context *ctx, pack_spec *spec) {
  int dim = spec->dim;
  double *m = spec->grow.shape;
  if (spec->cells && spec->cells != dim)
    return gh_fail(ctx, GH_INPUT, "the cell has %d lengths, %d are needed in %d dimensions", spec->cells, dim,
                   dim);
  if (spec->tilts && spec->tilts != (dim == 2 ? 1 : 3))
    return gh_fail(ctx, GH_INPUT, "the cell has %d tilts, %s in %d dimensions", spec->tilts,
                   dim == 2 ? "one (xy) is needed" : "three (xy,xz,yz) are needed", dim);
  if (!spec->cells && !spec->tilts) return GH_OK;
  for (int k = 0; k < dim; k++) m[k * (dim + 1)] = spec->cells ? spec->cell[k] : 1;
  m[1] = spec->tilt[0];
  if (dim == 3) m[2] = spec->tilt[1], m[5] = spec->tilt[2];
  return GH_OK;
}

gh_status pack_spec_complete(gh_context *ctx, pack_spec *spec) {
  if (!spec->sieve)
    return gh_fail(ctx, GH_INPUT, "a sieve curve is needed: --sieve FILE.csv, or a YAML file that names it");
  if (!spec->output) return gh_fail(ctx, GH_INPUT, "-o is missing: the file to write");
  if (spec->finish && spec->dim != 2) return gh_fail(ctx, GH_INPUT, "--finish is for two dimensions");
  if (spec->soft && !spec->finish)
    return gh_fail(ctx, GH_INPUT,
                   "--finish-cell, --normal-stiffness, --anisotropy and --engine need --finish");
  if (spec->finish) GH_TRY(gh_finish_check(ctx, &spec->soft_options)); /* before minutes of growth */
  if (isnan(spec->grow.rate)) spec->grow.rate = gh_grow_defaults(spec->dim).rate;
  return shape(ctx, spec);
}
