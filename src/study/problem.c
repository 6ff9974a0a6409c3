/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What one run of a study computes: the scene or the rve with the keys of its configuration, and the hash of
 * all that the answer depends on. */
#include "io/file.h"
#include "study/parts.h"

#include "granhom/granhom.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_REFINE = 1000000 };

/* ---- hash ---- */

/* A text with its end, so that two texts are not the same as one. */
static uint64_t hash_text(uint64_t sum, const char *text) {
  return gh_sum_bytes(sum, text, strlen(text) + 1);
}

static gh_status hash_file(gh_context *ctx, const char *path, uint64_t *sum) {
  char *text;
  GH_TRY(gh_file_text(ctx, path, &text));
  *sum = hash_text(*sum, text);
  free(text);
  return GH_OK;
}

static gh_status hash_node(gh_context *ctx, node n, uint64_t *sum) {
  gh_text *text;
  GH_TRY(gh_text_create(ctx, &text));
  gh_yaml_print(n, text);
  gh_status status = gh_text_check(text);
  if (status == GH_OK) *sum = hash_text(*sum, gh_text_get(text, NULL));
  gh_text_destroy(&text);
  return status;
}

/* The content of a file that a key names. */
static gh_status hash_named(gh_context *ctx, const char *folder, node n, uint64_t *sum) {
  const char *name;
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(gh_yaml_text(n, "a file", &name));
  char *path = gh_path_join(folder, name);
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = hash_file(ctx, path, sum);
  free(path);
  return status;
}

/* ---- the keys of a configuration ---- */

/* Keys for the document, and what a study understands itself. */
typedef struct wanted {
  gh_override *list; /* without the special ones */
  int count;
  long refine;
  const char *packing; /* file; NULL: the document's own */
} wanted;

static gh_status read_refine(gh_context *ctx, const char *value, long *refine) {
  if (gh_parse_integer(value, 1, MOST_REFINE, refine)) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "refine is '%s', it must be an integer from 1 to %d", value, MOST_REFINE);
}

static gh_status find_wanted(gh_context *ctx, const gh_study *s, const study_config *one, int member,
                             int without, wanted *w) {
  int all = 0;
  *w = (wanted){.refine = 1, .packing = one->files ? one->files[member] : NULL};
  GH_TRY(study_overrides(s, one, &w->list, NULL, &all));
  for (int k = 0; k < all; k++) {
    const gh_override o = w->list[k];
    if (k == without || strcmp(o.key, "packing") == 0) continue;
    if (strcmp(o.key, "refine") == 0) GH_TRY(read_refine(ctx, o.value, &w->refine));
    else w->list[w->count++] = o;
  }
  return GH_OK;
}

static void close_id(uint64_t sum, char id[20]) {
  snprintf(id, 20, "%016" PRIx64, sum);
}

static uint64_t open_id(const char *kind) {
  return hash_text(hash_text(hash_text(GH_SUM_BEGIN, "granhom study 1"), GH_VERSION), kind);
}

/* ---- a scene ---- */

/* A text as YAML. */
static gh_status text_quote(gh_context *ctx, const char *text, char **yaml) {
  size_t n = 0;
  GH_TRY(gh_alloc(ctx, 2 * strlen(text) + 3, 1, yaml));
  (*yaml)[n++] = '"';
  for (; *text; text++) {
    if (*text == '"' || *text == '\\') (*yaml)[n++] = '\\';
    (*yaml)[n++] = *text;
  }
  (*yaml)[n] = '"';
  return GH_OK;
}

/* Overrides of a scene; its last ones are made here and owned by it. */
typedef struct scene_keys {
  gh_override *list;
  int count, borrowed;
} scene_keys;

static void free_keys(scene_keys *k) {
  for (int j = k->borrowed; j < k->count; j++) {
    free((char *)k->list[j].key);
    free((char *)k->list[j].value);
  }
  free(k->list);
}

static gh_status add_key(gh_context *ctx, gh_yaml *doc, scene_keys *k, const char *key, const char *value) {
  char *copies[2] = {NULL, NULL};
  gh_status status = gh_copy_text(ctx, key, &copies[0]);
  if (status == GH_OK) status = gh_copy_text(ctx, value, &copies[1]);
  if (status != GH_OK) {
    free(copies[0]);
    return status;
  }
  k->list[k->count++] = (gh_override){.key = copies[0], .value = copies[1]};
  return gh_yaml_set(doc, key, value);
}

/* `refine` times as many increments in each step. */
static gh_status refine_steps(gh_context *ctx, gh_yaml *doc, long refine, scene_keys *k) {
  node steps = gh_yaml_get(gh_yaml_root(doc), "steps");
  for (int j = 0; j < gh_yaml_length(steps); j++) {
    char key[64], value[32];
    long count;
    node n = gh_yaml_get(gh_yaml_item(steps, j), "increments");
    if (!gh_yaml_has(n)) continue; /* reading the scene reports what is missing */
    GH_TRY(gh_yaml_integer(n, "increments", 1, MOST_REFINE, &count));
    snprintf(key, sizeof key, "steps.%d.increments", j);
    snprintf(value, sizeof value, "%ld", count * refine);
    GH_TRY(add_key(ctx, doc, k, key, value));
  }
  return GH_OK;
}

/* The scene is read elsewhere, so that the file is named from the root. */
static gh_status place_packing(gh_context *ctx, gh_yaml *doc, const char *file, scene_keys *k) {
  char *path = realpath(file, NULL), *yaml = NULL;
  if (!path) return gh_fail(ctx, gh_read_status(errno), "%s: cannot be found: %s", file, strerror(errno));
  gh_status status = text_quote(ctx, path, &yaml);
  if (status == GH_OK) status = add_key(ctx, doc, k, "packing", yaml);
  free(path);
  free(yaml);
  /* what counts is in the file, not where it is */
  return status == GH_OK ? gh_yaml_set(doc, "packing", "file") : status;
}

/* Nothing is written, and points that a scene records need not be there with another mesh. */
static gh_status leave_results(gh_context *ctx, gh_yaml *doc, scene_keys *k) {
  static const char *const names[] = {"results", "output"};
  for (int j = 0; j < 2; j++)
    if (gh_yaml_has(gh_yaml_get(gh_yaml_root(doc), names[j]))) GH_TRY(add_key(ctx, doc, k, names[j], "{}"));
  return GH_OK;
}

static gh_status collect_keys(gh_context *ctx, gh_yaml *doc, const wanted *w, scene_keys *k) {
  size_t steps = (size_t)gh_yaml_length(gh_yaml_get(gh_yaml_root(doc), "steps"));
  for (int j = 0; j < w->count; j++) GH_TRY(gh_yaml_set(doc, w->list[j].key, w->list[j].value));
  size_t more = (size_t)gh_yaml_length(gh_yaml_get(gh_yaml_root(doc), "steps"));
  GH_TRY(gh_alloc(ctx, (size_t)w->count + steps + more + 3, sizeof *k->list, &k->list));
  for (int j = 0; j < w->count; j++) k->list[j] = w->list[j];
  k->count = k->borrowed = w->count;
  GH_TRY(leave_results(ctx, doc, k));
  if (w->refine > 1) GH_TRY(refine_steps(ctx, doc, w->refine, k));
  return w->packing ? place_packing(ctx, doc, w->packing, k) : GH_OK;
}

static gh_status hash_scene(gh_context *ctx, const gh_study *s, gh_yaml *doc, study_problem *p) {
  uint64_t sum = open_id("scene");
  char *folder = gh_path_folder(s->scene_path);
  if (!folder) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = hash_node(ctx, gh_yaml_root(doc), &sum);
  int packings;
  char *const *files = gh_scene_packing_files(p->scene, &packings);
  for (int k = 0; k < packings && status == GH_OK; k++) status = hash_file(ctx, files[k], &sum);
  if (status == GH_OK)
    status = hash_named(ctx, folder, gh_yaml_get(gh_yaml_get(gh_yaml_root(doc), "mesh"), "gmsh"), &sum);
  free(folder);
  close_id(sum, p->id);
  return status;
}

static gh_status open_scene(gh_context *ctx, const gh_study *s, const wanted *w, study_problem *p) {
  gh_yaml *doc = NULL;
  scene_keys keys = {0};
  gh_status status = gh_yaml_read(ctx, s->scene_path, &doc);
  if (status == GH_OK) status = collect_keys(ctx, doc, w, &keys);
  if (status == GH_OK) status = gh_scene_read_with(ctx, s->scene_path, keys.count, keys.list, &p->scene);
  if (status == GH_OK) status = hash_scene(ctx, s, doc, p);
  free_keys(&keys);
  gh_yaml_destroy(&doc);
  return status;
}

/* ---- one packing along a path ---- */

/* Takes the name of a peer out of `micro.engine`, which knows none. */
static gh_status find_peer(gh_yaml *doc, node rve, int *peer) {
  static const char *const words[] = {[GH_PEER_LAMMPS] = "gran", [GH_PEER_LIGGGHTS] = "liggghts"};
  const char *word;
  node n = gh_yaml_get(gh_yaml_get(rve, "micro"), "engine");
  *peer = STUDY_NO_PEER;
  if (!gh_yaml_is_scalar(n)) return GH_OK;
  GH_TRY(gh_yaml_text(n, "engine", &word));
  for (int k = 0; k < 2; k++)
    if (strcmp(word, words[k]) == 0) *peer = k;
  return *peer == STUDY_NO_PEER ? GH_OK : gh_yaml_set(doc, "rve.micro.engine", "native");
}

static gh_status set_keys(gh_context *ctx, gh_yaml *doc, const wanted *w) {
  for (int k = 0; k < w->count; k++) {
    size_t size = strlen(w->list[k].key) + 5;
    char *key;
    GH_TRY(gh_alloc(ctx, size, 1, &key));
    snprintf(key, size, "rve.%s", w->list[k].key);
    gh_status status = gh_yaml_set(doc, key, w->list[k].value);
    free(key);
    GH_TRY(status);
  }
  return gh_yaml_set(doc, "rve.packing", "file");
}

static gh_status hash_rve(gh_context *ctx, const gh_study *s, node rve, const wanted *w, study_problem *p) {
  uint64_t sum = open_id("rve");
  sum = gh_sum_bytes(sum, &w->refine, sizeof w->refine);
  GH_TRY(hash_node(ctx, rve, &sum));
  GH_TRY(hash_named(ctx, s->folder, gh_yaml_get(gh_yaml_get(rve, "path"), "file"), &sum));
  GH_TRY(hash_file(ctx, w->packing, &sum));
  close_id(sum, p->id);
  return GH_OK;
}

/* Whether the packing can follow. */
static gh_status check_path(gh_context *ctx, node path, const char *file, const study_problem *p) {
  const double fraction = gh_packing_volume_fraction(p->packing);
  double least = INFINITY, most = 0;
  bool warned = false;
  char where[512];
  for (int k = 0; k < p->path.rows; k++) {
    const double det = gh_det2(p->path.F + 4 * k);
    least = fmin(least, det), most = fmax(most, det);
  }
  GH_TRY(gh_limits_check_packing(ctx, &p->rve, file, p->packing, least, most, &warned));
  for (int k = 0; k < p->path.rows; k++) {
    snprintf(where, sizeof where, "%s:%d: path, t = %g", gh_yaml_path(path), gh_yaml_line(path),
             p->path.t[k]);
    GH_TRY(gh_limits_check_F(ctx, &p->rve, where, p->path.F + 4 * k, fraction));
  }
  return GH_OK;
}

static gh_status read_rve(gh_context *ctx, const gh_study *s, gh_yaml *doc, const wanted *w,
                          study_problem *p) {
  node rve = gh_yaml_get(gh_yaml_root(doc), "rve"), path, contact;
  GH_TRY(gh_yaml_map(rve, "rve", study_rve_keys));
  GH_TRY(gh_yaml_need(rve, "rve", "contact", &contact));
  GH_TRY(gh_yaml_need(rve, "rve", "path", &path));
  GH_TRY(study_path_read(ctx, path, s->folder, w->refine, &p->path));
  GH_TRY(hash_rve(ctx, s, rve, w, p));
  GH_TRY(find_peer(doc, rve, &p->peer));
  p->rve = gh_rve_defaults();
  p->rve.boundary = GH_PERIODIC;
  p->rve.engine = GH_ENGINE_LAMMPS;
  GH_TRY(gh_scene_read_material(rve, ctx, &p->rve));
  GH_TRY(gh_packing_read(ctx, w->packing, &p->packing));
  GH_TRY(check_path(ctx, path, w->packing, p));
  const gh_status status = gh_rve_check_packing(ctx, p->packing, &p->rve);
  return status == GH_OK ? GH_OK : gh_prefix(ctx, status, "%s: ", w->packing);
}

static gh_status open_rve(gh_context *ctx, const gh_study *s, const wanted *w, study_problem *p) {
  gh_yaml *doc = NULL;
  gh_status status = gh_yaml_read(ctx, s->path, &doc);
  if (status == GH_OK) status = set_keys(ctx, doc, w);
  if (status == GH_OK) status = read_rve(ctx, s, doc, w, p);
  gh_yaml_destroy(&doc);
  return status;
}

gh_status study_problem_open(gh_context *ctx, const gh_study *s, int config, int member, int without,
                             study_problem *p) {
  wanted w;
  *p = (study_problem){.ctx = ctx, .peer = STUDY_NO_PEER};
  gh_status status = find_wanted(ctx, s, s->configs + config, member, without, &w);
  if (status == GH_OK) status = s->scene ? open_scene(ctx, s, &w, p) : open_rve(ctx, s, &w, p);
  free(w.list);
  return status;
}

void study_problem_close(study_problem *p) {
  gh_scene_destroy(&p->scene);
  gh_packing_destroy(&p->packing);
  study_path_free(&p->path);
}
