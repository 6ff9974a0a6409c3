/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The parameters of `granhom pack`, as options and as keys of a file. */
#include "pack_spec.h"

#include "granhom/io.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

void pack_spec_init(pack_spec *spec) {
  *spec = (pack_spec){.dim = 2,
                      .grow = gh_grow_defaults(2),
                      .soft = gh_finish_defaults(),
                      .stiffness = NAN,
                      .anisotropy = NAN,
                      .finish_cell = -1,
                      .engine = -1};
  spec->seed = (long)spec->grow.seed;
  spec->grow.rate = NAN;
}

void pack_spec_free(pack_spec *spec) {
  free(spec->own_sieve);
  *spec = (pack_spec){0};
}

/* ---- values that no kind of option covers ---- */

/* Up to three numbers with commas between them. */
static gh_status numbers_read(gh_context *ctx, const char *where, const char *text, const char *wanted,
                              double low, double *value, int *count) {
  char copy[256], *rest = copy;
  bool good = strlen(text) < sizeof copy;
  if (good) strcpy(copy, text);
  for (*count = 0; good && rest && *count < 3; (*count)++) {
    char *word = rest + strspn(rest, " "), *comma = strchr(word, ',');
    rest = comma ? comma + 1 : NULL;
    if (comma) *comma = 0;
    for (char *end = word + strlen(word); end > word && end[-1] == ' ';) *--end = 0;
    good = gh_parse_number(word, &value[*count]) && value[*count] > low;
  }
  if (good && !rest) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "%s must be %s, not \"%s\"", where, wanted, text);
}

static gh_status cell_read(gh_context *ctx, const char *where, const char *text, void *group) {
  pack_spec *spec = group;
  return numbers_read(ctx, where, text, "two or three positive lengths with commas between them", 0,
                      spec->cell, &spec->cells);
}

static gh_status tilt_read(gh_context *ctx, const char *where, const char *text, void *group) {
  pack_spec *spec = group;
  return numbers_read(ctx, where, text, "one or three tilts xy,xz,yz with commas between them", -INFINITY,
                      spec->tilt, &spec->tilts);
}

static gh_status finish_read(gh_context *ctx, const char *where, const char *text, void *group) {
  pack_spec *spec = group;
  spec->finish = true;
  gh_status status = gh_finish_parse(ctx, text, &spec->soft);
  return status == GH_OK ? GH_OK : gh_prefix(ctx, status, "%s: ", where);
}

/* ---- rows ---- */

enum { MOST_GRAINS = 100000000, MOST_PACKINGS = 999 };

#define PLACE(member) .place = offsetof(pack_spec, member)

const option_row pack_spec_rows[] = {
    {.name = "output",
     .letter = 'o',
     .argument = "FILE",
     .kind = OPTION_TEXT,
     PLACE(output),
     .help = "the packing"},
    {.name = "sieve",
     .key = true,
     .argument = "FILE",
     .kind = OPTION_TEXT,
     PLACE(sieve),
     .help = "CSV with the column diameter and one of count, volume_percent, passing"},
    {.name = "count",
     .key = true,
     .argument = "N",
     .kind = OPTION_INTEGER,
     .low = 1,
     .high = MOST_GRAINS,
     PLACE(count),
     .standard = "the counts of the sieve curve",
     .help = "number of grains"},
    {.name = "dimension",
     .key = true,
     .argument = "D",
     .kind = OPTION_INTEGER,
     .low = 2,
     .high = 3,
     PLACE(dim),
     .help = "2 or 3"},
    {.name = "seed",
     .key = true,
     .argument = "S",
     .kind = OPTION_LONG,
     .high = LONG_MAX,
     .wanted = "a whole number from 0",
     PLACE(seed),
     .help = "the same seed gives the same packing"},
    {.name = "ensemble",
     .key = true,
     .argument = "K",
     .kind = OPTION_INTEGER,
     .low = 1,
     .high = MOST_PACKINGS,
     PLACE(ensemble),
     .help = "K packings with the seeds S, S+1, ...: PACKING-001.data, PACKING-002.data, ..."},
    {.name = "picture", .argument = "FILE", .kind = OPTION_TEXT, PLACE(picture), .help = ".svg or .png"},
    {0}};

static const char *const collisions[] = {
    [GH_COLLISION_EXCHANGE] = "exchange", [GH_COLLISION_MOMENTUM] = "momentum", NULL};

const option_row pack_growth_rows[] = {
    {.name = "", .kind = OPTION_HEADING, .help = "Growth"},
    {.name = "rate",
     .key = true,
     .argument = "R",
     .kind = OPTION_NUMBER,
     PLACE(grow.rate),
     .standard = "0.001",
     .help = "growth of the mean diameter over the grains' speed; slower is denser and more ordered"},
    {.name = "collision",
     .key = true,
     .argument = "NAME",
     .kind = OPTION_CHOICE,
     .words = collisions,
     PLACE(grow.collision),
     .help = "exchange (3.9) or momentum (masses as volumes, momentum is conserved)"},
    {.name = "volume-fraction",
     .key = true,
     .argument = "F",
     .kind = OPTION_NUMBER,
     .below = 1,
     .wanted = "a volume fraction, above 0 and below 1",
     PLACE(grow.volume_fraction),
     .help = "stop there; exit status 1 when growth dries up before"},
    {.name = "threshold",
     .key = true,
     .argument = "T",
     .kind = OPTION_NUMBER,
     .zero = true,
     .below = 1,
     .wanted = "a number from 0 to below 1",
     PLACE(grow.threshold),
     .help = "stop when the volume fraction grows by less than T (0: never) ..."},
    {.name = "window",
     .key = true,
     .argument = "C",
     .kind = OPTION_NUMBER,
     PLACE(grow.window),
     .help = "... in C collisions per grain"},
    {.name = "seconds",
     .key = true,
     .argument = "T",
     .kind = OPTION_NUMBER,
     PLACE(grow.seconds),
     .help = "stop growth after this time; --finish takes what it takes after that"},
    {.name = "cell",
     .key = true,
     .argument = "LX,LY[,LZ]",
     .kind = OPTION_OWN,
     .read = cell_read,
     .standard = "1,1[,1]",
     .help = "proportions of the cell (its size follows from the grains)"},
    {.name = "tilt",
     .key = true,
     .argument = "XY[,XZ,YZ]",
     .kind = OPTION_OWN,
     .read = tilt_read,
     .help = "tilts of the cell, in the same units"},
    {0}};

static const char *const cells[] = {[GH_FINISH_CELL_AUTO] = "auto",
                                    [GH_FINISH_CELL_SCALED] = "scaled",
                                    [GH_FINISH_CELL_RELAXED] = "relaxed",
                                    NULL};
static const char *const engines[] = {[GH_ENGINE_LAMMPS] = "lammps", [GH_ENGINE_NATIVE] = "native", NULL};

const option_row pack_soft_rows[] = {
    {.name = "", .kind = OPTION_HEADING, .help = "Ready for mechanics (two dimensions)"},
    {.name = "finish",
     .key = true,
     .argument = "GOAL",
     .kind = OPTION_OWN,
     .read = finish_read,
     .help = "overlap=X (mean overlap over mean radius) or pressure=P: soft grains in equilibrium"},
    {.name = "finish-cell",
     .key = true,
     .argument = "NAME",
     .kind = OPTION_CHOICE,
     .words = cells,
     PLACE(finish_cell),
     .standard = "auto",
     .help = "scaled: the cell keeps its shape; relaxed: until the stress is isotropic; auto: relaxed for a "
             "pressure without --anisotropy"},
    {.name = "normal-stiffness",
     .key = true,
     .argument = "E",
     .kind = OPTION_NUMBER,
     PLACE(stiffness),
     .standard = "1",
     .help = "force per overlap"},
    {.name = "anisotropy",
     .key = true,
     .argument = "A",
     .kind = OPTION_NUMBER,
     .zero = true,
     .below = 1,
     .wanted = "a number from 0 to below 1",
     PLACE(anisotropy),
     .help = "wanted difference of the principal values of the mean n(x)n over contacts"},
    {.name = "engine",
     .key = true,
     .argument = "NAME",
     .kind = OPTION_CHOICE,
     .words = engines,
     PLACE(engine),
     .standard = "native",
     .help = "native or lammps"},
    {0}};

static const option_row *const groups[] = {pack_spec_rows, pack_growth_rows, pack_soft_rows};
enum { GROUPS = sizeof groups / sizeof *groups };

gh_status pack_spec_set(gh_context *ctx, pack_spec *spec, const char *name, const char *where,
                        const char *text) {
  for (int g = 0; g < GROUPS; g++) {
    const option_row *row = option_find(groups[g], name);
    if (row) return option_set(ctx, row, where, text, spec);
  }
  return gh_fail(ctx, GH_INPUT, "%s: there is no such parameter", where);
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

/* A path in a file is relative to its folder. */
static gh_status sieve_set(gh_context *ctx, const char *path, const char *text, pack_spec *spec) {
  char *folder = gh_path_folder(path);
  spec->own_sieve = folder ? gh_path_join(folder, text) : NULL;
  spec->sieve = spec->own_sieve;
  free(folder);
  return spec->own_sieve ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for a path");
}

static gh_status key_set(gh_context *ctx, const char *path, gh_yaml_node root, const option_row *row,
                         pack_spec *spec) {
  char key[32], where[512], text[512];
  key_of(row->name, key);
  gh_yaml_node node = gh_yaml_get(root, key);
  if (!gh_yaml_has(node)) return GH_OK;
  GH_TRY(text_of(node, key, text));
  snprintf(where, sizeof where, "%s:%d: %s", path, gh_yaml_line(node), key);
  /* the sieve curve is the only text; the document, which holds it, does not last */
  return row->kind == OPTION_TEXT ? sieve_set(ctx, path, text, spec)
                                  : option_set(ctx, row, where, text, spec);
}

void pack_terms_list(pack_terms *t) {
  pack_spec defaults;
  int n = 0;
  pack_spec_init(&defaults);
  for (int g = 0; g < GROUPS; g++)
    for (const option_row *row = groups[g]; row->name && n < PACK_MOST_KEYS; row++) {
      if (!row->key) continue;
      key_of(row->name, t->name[n]);
      option_text(row, &defaults, t->text[n]);
      t->terms[n] = (gh_term){t->name[n], t->text[n]};
      n++;
    }
  t->terms[n] = (gh_term){0};
  pack_spec_free(&defaults);
}

static gh_status map_read(gh_context *ctx, const char *path, gh_yaml_node root, pack_spec *spec) {
  pack_terms t;
  pack_terms_list(&t);
  if (!gh_yaml_is_map(root)) return gh_yaml_fail(root, "a packing is described by keys and values");
  GH_TRY(gh_yaml_terms(root, t.terms));
  for (int g = 0; g < GROUPS; g++)
    for (const option_row *row = groups[g]; row->name; row++)
      if (row->key) GH_TRY(key_set(ctx, path, root, row, spec));
  return GH_OK;
}

gh_status pack_spec_read(gh_context *ctx, const char *path, pack_spec *spec) {
  gh_yaml *doc;
  GH_TRY(gh_file_expect(ctx, gh_yaml_read(ctx, path, &doc), path, GH_FILE_GROWTH));
  gh_status status = map_read(ctx, path, gh_yaml_root(doc), spec);
  gh_yaml_destroy(&doc);
  return gh_file_expect(ctx, status, path, GH_FILE_GROWTH);
}

/* ---- together ---- */

/* The cell's shape: unit lengths where none are given; tilts are in the same units. */
static gh_status shape_set(gh_context *ctx, pack_spec *spec) {
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
  if (dim == 2) return GH_OK;
  m[2] = spec->tilt[1];
  m[5] = spec->tilt[2];
  return GH_OK;
}

/* What only --finish uses goes to it. */
static gh_status soft_set(gh_context *ctx, pack_spec *spec) {
  const bool given =
      !isnan(spec->stiffness) || !isnan(spec->anisotropy) || spec->finish_cell >= 0 || spec->engine >= 0;
  if (given && !spec->finish)
    return gh_fail(ctx, GH_INPUT,
                   "--finish-cell, --normal-stiffness, --anisotropy and --engine need --finish");
  if (!isnan(spec->stiffness)) spec->soft.normal_stiffness = spec->stiffness;
  if (!isnan(spec->anisotropy)) spec->soft.anisotropy = spec->anisotropy;
  if (spec->finish_cell >= 0) spec->soft.cell = (gh_finish_cell)spec->finish_cell;
  if (spec->engine >= 0) spec->soft.engine = (gh_engine_kind)spec->engine;
  return spec->finish ? gh_finish_check(ctx, &spec->soft) : GH_OK; /* before minutes of growth */
}

gh_status pack_spec_complete(gh_context *ctx, pack_spec *spec) {
  if (!spec->sieve)
    return gh_fail(ctx, GH_INPUT, "a sieve curve is needed: --sieve FILE.csv, or a YAML file that names it");
  if (!spec->output) return gh_fail(ctx, GH_INPUT, "-o is missing: the file to write");
  if (spec->finish && spec->dim != 2) return gh_fail(ctx, GH_INPUT, "--finish is for two dimensions");
  GH_TRY(soft_set(ctx, spec));
  spec->grow.seed = (unsigned long long)spec->seed;
  if (isnan(spec->grow.rate)) spec->grow.rate = gh_grow_defaults(spec->dim).rate;
  return shape_set(ctx, spec);
}
