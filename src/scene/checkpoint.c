/* Writing and reading checkpoints. SPDX-License-Identifier: GPL-2.0-or-later
 *
 * Besides the checksum of the file there is one over all datasets in /check. */
#include "scene/checkpoint.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FILE_NAME "checkpoint.h5"
#define KIND "checkpoint 4"

enum { POSITION = 4, HEX = 17, WORDS = (sizeof(gh_run_summary) + 7) / 8 };

/* ---- checksums ---- */

/* FNV-1a over words of eight bytes; changes with every single bit. */
static uint64_t add_bytes(uint64_t sum, const void *data, size_t size) {
  const char *bytes = data;
  for (; size > 0;) {
    uint64_t word = 0;
    size_t n = size < sizeof word ? size : sizeof word;
    memcpy(&word, bytes, n);
    sum = (sum ^ word) * 1099511628211u;
    sum ^= sum >> 32;
    bytes += n, size -= n;
  }
  return sum;
}

static const uint64_t first_sum = 14695981039346656037u;

static void hex(uint64_t sum, char text[HEX]) {
  snprintf(text, HEX, "%016" PRIx64, sum);
}

static uint64_t sum_scene(const gh_scene *s) {
  uint64_t sum = add_bytes(first_sum, s->text, strlen(s->text));
  for (int k = 0; k < s->noverrides; k++) {
    sum = add_bytes(sum, s->override_key[k], strlen(s->override_key[k]) + 1);
    sum = add_bytes(sum, s->override_value[k], strlen(s->override_value[k]) + 1);
  }
  return sum;
}

static uint64_t sum_mesh(const gh_scene *s) {
  const gh_mesh *m = s->mesh;
  uint64_t sum = add_bytes(first_sum, m->X, 2 * (size_t)m->nnodes * sizeof *m->X);
  sum = add_bytes(sum, m->quad, (size_t)m->nelements * sizeof *m->quad);
  for (int k = 0; k < s->nsets; k++) {
    const gh_mesh_set *set = m->sets + k;
    sum = add_bytes(sum, set->name, strlen(set->name));
    sum = add_bytes(sum, set->nodes, (size_t)set->nnodes * sizeof *set->nodes);
    if (set->nedges > 0) sum = add_bytes(sum, set->edges, (size_t)set->nedges * sizeof *set->edges);
  }
  return sum;
}

static uint64_t sum_packings(const gh_scene *s) {
  uint64_t sum = add_bytes(first_sum, s->packing_of, 4 * (size_t)s->mesh->nelements * sizeof *s->packing_of);
  for (int k = 0; k < s->npackings; k++) {
    const gh_packing *p = s->packings[k];
    size_t n = (size_t)p->n;
    sum = add_bytes(sum, p->id, n * sizeof *p->id);
    sum = add_bytes(sum, p->type, n * sizeof *p->type);
    sum = add_bytes(sum, p->radius, n * sizeof *p->radius);
    sum = add_bytes(sum, p->x, 2 * n * sizeof *p->x);
    sum = add_bytes(sum, p->cell, sizeof p->cell);
    sum = add_bytes(sum, p->low, sizeof p->low);
  }
  return sum;
}

/* What must be the same: name of the dataset, words for it, value. */
typedef struct mark {
  const char *name, *what;
  char value[64];
} mark;
enum { MARKS = 6 };

static void find_marks(const gh_scene *s, mark list[MARKS]) {
  static const mark names[MARKS] = {
      {"/made/format", "is no checkpoint of this version of granhom", KIND},
      {"/made/scene", "belongs to another scene file", ""},
      {"/made/mesh", "belongs to another mesh", ""},
      {"/made/packings", "belongs to other packings", ""},
      {"/made/engine", "was made with another engine", ""},
      {"/made/estimate", "was made with another choice of --estimate-error", ""}};
  memcpy(list, names, sizeof names);
  hex(sum_scene(s), list[1].value);
  hex(sum_mesh(s), list[2].value);
  hex(sum_packings(s), list[3].value);
  snprintf(list[4].value, sizeof list[4].value, "%s",
           s->micro.engine == GH_ENGINE_NATIVE ? "native" : "lammps");
  snprintf(list[5].value, sizeof list[5].value, "%s", s->estimate ? "yes" : "no");
}

/* ---- datasets that count into the checksum ---- */

typedef struct archive {
  gh_context *ctx;
  gh_h5 *file;
  uint64_t sum;
  size_t bytes; /* of a file that is read */
} archive;

static gh_status put_doubles(archive *a, const char *name, size_t n, const double *data) {
  a->sum = add_bytes(add_bytes(a->sum, &n, sizeof n), data, n * sizeof *data);
  return gh_h5_put_doubles(a->file, name, n, 1, data);
}

static gh_status put_ints(archive *a, const char *name, size_t n, const int *data) {
  a->sum = add_bytes(add_bytes(a->sum, &n, sizeof n), data, n * sizeof *data);
  return gh_h5_put_ints(a->file, name, n, 1, data);
}

/* Bytes of any kind as doubles of the same bits. */
static gh_status put_bytes(archive *a, const char *name, size_t size, const void *data) {
  size_t n = (size + sizeof(double) - 1) / sizeof(double);
  double *words;
  GH_TRY(gh_alloc(a->ctx, n + 1, sizeof *words, &words));
  const double length = (double)size;
  memcpy(words, &length, sizeof length);
  memcpy(words + 1, data, size);
  gh_status status = put_doubles(a, name, n + 1, words);
  free(words);
  return status;
}

static gh_status size_of(archive *a, const char *name, size_t *n) {
  size_t cols;
  GH_TRY(gh_h5_size(a->file, name, n, &cols));
  if (cols == 1 && *n <= a->bytes / sizeof(int)) return GH_OK;
  return gh_fail(a->ctx, GH_INPUT, "%s is no list that fits into the file", name);
}

/* The caller frees *data. */
static gh_status get_doubles(archive *a, const char *name, size_t *n, double **data) {
  GH_TRY(size_of(a, name, n));
  GH_TRY(gh_alloc(a->ctx, *n + 1, sizeof **data, data));
  GH_TRY(gh_h5_get_doubles(a->file, name, *n, 1, *data));
  a->sum = add_bytes(add_bytes(a->sum, n, sizeof *n), *data, *n * sizeof **data);
  return GH_OK;
}

static gh_status get_ints(archive *a, const char *name, size_t *n, int **data) {
  GH_TRY(size_of(a, name, n));
  GH_TRY(gh_alloc(a->ctx, *n + 1, sizeof **data, data));
  GH_TRY(gh_h5_get_ints(a->file, name, *n, 1, *data));
  a->sum = add_bytes(add_bytes(a->sum, n, sizeof *n), *data, *n * sizeof **data);
  return GH_OK;
}

/* With a 0 behind them; the caller frees *data. */
static gh_status get_bytes(archive *a, const char *name, size_t *size, char **data) {
  size_t n;
  double *words = NULL;
  gh_status status = get_doubles(a, name, &n, &words);
  if (status == GH_OK && (n < 1 || !(words[0] >= 0 && words[0] <= (double)(n - 1) * sizeof(double))))
    status = gh_fail(a->ctx, GH_INPUT, "%s is no text", name);
  if (status == GH_OK) {
    *size = (size_t)words[0];
    status = gh_alloc(a->ctx, *size + 1, 1, data);
  }
  if (status == GH_OK) memcpy(*data, words + 1, *size);
  free(words);
  return status;
}

/* ---- writing ---- */

static const char *in(char name[64], const char *folder, const char *what) {
  snprintf(name, 64, "%s/%s", folder, what);
  return name;
}

static gh_status put_marks(archive *a, const gh_scene *s) {
  mark list[MARKS];
  find_marks(s, list);
  char blas[GH_BLAS_SIZE];
  GH_TRY(gh_blas(a->ctx, blas, sizeof blas));
  for (int k = 0; k < MARKS; k++) GH_TRY(gh_h5_put_text(a->file, list[k].name, list[k].value));
  return gh_h5_put_text(a->file, "/made/blas", blas);
}

static gh_status put_position(archive *a, const scene_results *r, const scene_position *p) {
  const int where[POSITION] = {p->counter, p->step, p->increment, r->frames};
  size_t ndof = 2 * (size_t)r->scene->mesh->nnodes;
  char name[64];
  GH_TRY(put_ints(a, "/run/position", POSITION, where));
  GH_TRY(put_bytes(a, "/run/summary", sizeof p->sum, &p->sum));
  for (int k = 1; k <= p->step; k++) {
    snprintf(name, sizeof name, "/run/begin%04d", k);
    GH_TRY(put_doubles(a, name, ndof, p->begin_u[k]));
  }
  return GH_OK;
}

static gh_status put_texts(archive *a, const scene_results *r) {
  scene_text list[SCENE_TEXTS];
  char name[64];
  scene_results_texts(r, list);
  GH_TRY(put_bytes(a, "/text/started", strlen(r->started), r->started));
  for (int k = 0; k < SCENE_TEXTS; k++) {
    size_t length;
    GH_TRY(gh_text_check(list[k].text));
    const char *text = gh_text_get(list[k].text, &length);
    snprintf(name, sizeof name, "/text/%s", list[k].name);
    GH_TRY(put_bytes(a, name, length, text));
  }
  return GH_OK;
}

static gh_status put_macro(archive *a, const char *name, const scene_results *r) {
  size_t n = gh_macro_state_size(r->macro);
  double *state;
  GH_TRY(gh_alloc(a->ctx, n, sizeof *state, &state));
  gh_macro_save(r->macro, state);
  gh_status status = put_doubles(a, name, n, state);
  free(state);
  return status;
}

static gh_status put_farm(archive *a, const char *folder, const scene_results *r) {
  gh_farm_image f;
  char name[64];
  gh_status status;
  double *sizes = NULL;
  GH_TRY_OR(gh_farm_save(r->farm, &f), done);
  size_t n = (size_t)f.npoints, ns = (size_t)f.nstates;
  GH_TRY_OR(gh_alloc(a->ctx, ns + 1, sizeof *sizes, &sizes), done);
  for (size_t k = 0; k <= ns; k++) sizes[k] = (double)f.start[k];
  GH_TRY_OR(put_ints(a, in(name, folder, "state"), n, f.state), done);
  GH_TRY_OR(put_doubles(a, in(name, folder, "start"), ns + 1, sizes), done);
  GH_TRY_OR(put_doubles(a, in(name, folder, "data"), f.start[ns], f.data), done);
  status = put_doubles(a, in(name, folder, "measure"), n * (size_t)f.nwords, f.measure);
done:
  free(sizes);
  gh_farm_image_free(&f);
  return status;
}

/* The body that goes in whole increments for an estimate of the error. */
static gh_status put_whole(archive *a, const scene_results *r) {
  const int apart = gh_macro_apart(r->macro);
  GH_TRY(put_ints(a, "/whole/apart", 1, &apart));
  if (!apart) return GH_OK;
  GH_TRY(gh_macro_exchange(r->macro));
  GH_TRY(put_macro(a, "/whole/macro", r));
  GH_TRY(put_farm(a, "/whole/farm", r));
  return gh_macro_exchange(r->macro);
}

gh_status scene_checkpoint_make(const scene_results *r, const scene_position *p, gh_h5 **file) {
  archive a = {.ctx = r->ctx, .sum = first_sum};
  char *path, check[HEX];
  GH_TRY(scene_result_path(r, FILE_NAME, &path));
  gh_status status = gh_h5_open(r->ctx, path, KIND, false, &a.file);
  free(path);
  if (status != GH_OK) return status;
  GH_TRY_OR(put_marks(&a, r->scene), failed);
  GH_TRY_OR(put_position(&a, r, p), failed);
  GH_TRY_OR(put_texts(&a, r), failed);
  GH_TRY_OR(put_macro(&a, "/macro", r), failed);
  GH_TRY_OR(put_farm(&a, "/farm", r), failed);
  if (r->scene->estimate) GH_TRY_OR(put_whole(&a, r), failed);
  hex(a.sum, check);
  GH_TRY_OR(gh_h5_put_text(a.file, "/check", check), failed);
  *file = a.file;
  return GH_OK;
failed:
  gh_h5_close(&a.file);
  return status;
}

/* ---- reading ---- */

gh_status scene_checkpoint_find(const scene_results *r, bool *there) {
  char *path;
  GH_TRY(scene_result_path(r, FILE_NAME, &path));
  gh_status status = gh_file_there(r->ctx, path, there);
  free(path);
  return status;
}

/* Another BLAS gives results as right as before, but other last bits. */
static gh_status check_blas(archive *a) {
  char there[GH_BLAS_SIZE] = "", here[GH_BLAS_SIZE];
  GH_TRY(gh_blas(a->ctx, here, sizeof here));
  if (gh_h5_get_text(a->file, "/made/blas", sizeof there, there) == GH_OK && strcmp(there, here) != 0)
    gh_log(a->ctx, GH_LEVEL_WARNING,
           "the checkpoint was made with the BLAS %s, and now it is %s: results agree to round-off, not to "
           "the bit",
           there, here);
  return GH_OK;
}

static gh_status check_marks(archive *a, const gh_scene *s) {
  mark list[MARKS];
  find_marks(s, list);
  for (int k = 0; k < MARKS; k++) {
    char value[64] = "";
    GH_TRY(gh_h5_get_text(a->file, list[k].name, sizeof value, value));
    if (strcmp(value, list[k].value) != 0) return gh_fail(a->ctx, GH_INPUT, "it %s", list[k].what);
  }
  return check_blas(a);
}

/* All that a checkpoint holds, before any of it is put to use. */
typedef struct content {
  int *where;
  char *summary, *started, *text[SCENE_TEXTS];
  double **begin_u, *macro, *whole_macro;
  gh_farm_image farm, whole_farm;
  size_t summary_size, macro_size, whole_size, length[SCENE_TEXTS];
  bool apart; /* the two whole_ are there */
} content;

static void free_content(const gh_scene *s, content *c) {
  free(c->where);
  free(c->summary);
  free(c->started);
  free(c->macro);
  free(c->whole_macro);
  for (int k = 0; k < SCENE_TEXTS; k++) free(c->text[k]);
  for (int k = 0; c->begin_u && k <= s->nsteps; k++) free(c->begin_u[k]);
  free(c->begin_u);
  gh_farm_image_free(&c->farm);
  gh_farm_image_free(&c->whole_farm);
}

static gh_status get_position(archive *a, const gh_scene *s, content *c) {
  size_t n, ndof = 2 * (size_t)s->mesh->nnodes;
  char name[64];
  GH_TRY(get_ints(a, "/run/position", &n, &c->where));
  if (n != POSITION || c->where[0] < 0 || c->where[3] < 0 || c->where[1] < 0 || c->where[1] > s->nsteps ||
      c->where[2] < 1 || c->where[2] > gh_scene_increments(s, c->where[1]))
    return gh_fail(a->ctx, GH_INPUT, "/run/position is none of this scene");
  GH_TRY(get_bytes(a, "/run/summary", &c->summary_size, &c->summary));
  if (c->summary_size != sizeof(gh_run_summary))
    return gh_fail(a->ctx, GH_INPUT, "it was made by another version of granhom");
  for (int k = 1; k <= c->where[1]; k++) {
    snprintf(name, sizeof name, "/run/begin%04d", k);
    GH_TRY(get_doubles(a, name, &n, &c->begin_u[k]));
    if (n != ndof) return gh_fail(a->ctx, GH_INPUT, "%s has %zu numbers instead of %zu", name, n, ndof);
  }
  return GH_OK;
}

static gh_status get_texts(archive *a, const scene_results *r, content *c) {
  scene_text list[SCENE_TEXTS];
  char name[64];
  size_t size;
  scene_results_texts(r, list);
  GH_TRY(get_bytes(a, "/text/started", &size, &c->started));
  for (int k = 0; k < SCENE_TEXTS; k++) {
    snprintf(name, sizeof name, "/text/%s", list[k].name);
    GH_TRY(get_bytes(a, name, &c->length[k], &c->text[k]));
  }
  return GH_OK;
}

static gh_status get_farm(archive *a, const char *folder, gh_farm_image *f) {
  char name[64];
  size_t n, starts, nmeasure, ndata;
  double *start = NULL;
  gh_status status;
  GH_TRY_OR(get_ints(a, in(name, folder, "state"), &n, &f->state), done);
  GH_TRY_OR(get_doubles(a, in(name, folder, "start"), &starts, &start), done);
  GH_TRY_OR(get_doubles(a, in(name, folder, "data"), &ndata, &f->data), done);
  GH_TRY_OR(get_doubles(a, in(name, folder, "measure"), &nmeasure, &f->measure), done);
  GH_TRY_OR(gh_alloc(a->ctx, starts + 1, sizeof *f->start, &f->start), done);
  bool fits = starts >= 1;
  for (size_t k = 0; k < starts; k++) {
    fits = fits && start[k] >= (k ? start[k - 1] : 0) && start[k] <= (double)ndata;
    f->start[k] = fits ? (size_t)start[k] : 0;
  }
  f->npoints = (int)n;
  f->nstates = (int)starts - 1;
  f->nwords = n > 0 ? (int)(nmeasure / n) : 0;
  if (n < 1 || !fits || f->start[starts - 1] != ndata || nmeasure != n * (size_t)f->nwords)
    status = gh_fail(a->ctx, GH_INPUT, "the lists in %s do not fit each other", folder);
done:
  free(start);
  return status;
}

static gh_status get_whole(archive *a, content *c) {
  size_t n;
  int *apart = NULL;
  gh_status status = get_ints(a, "/whole/apart", &n, &apart);
  c->apart = status == GH_OK && n == 1 && apart[0];
  free(apart);
  if (!c->apart) return status;
  GH_TRY(get_doubles(a, "/whole/macro", &c->whole_size, &c->whole_macro));
  return get_farm(a, "/whole/farm", &c->whole_farm);
}

static gh_status get_all(archive *a, const scene_results *r, content *c) {
  char check[HEX], stored[HEX] = "";
  GH_TRY(gh_alloc(a->ctx, (size_t)r->scene->nsteps + 1, sizeof *c->begin_u, &c->begin_u));
  GH_TRY(check_marks(a, r->scene));
  GH_TRY(get_position(a, r->scene, c));
  GH_TRY(get_texts(a, r, c));
  GH_TRY(get_doubles(a, "/macro", &c->macro_size, &c->macro));
  GH_TRY(get_farm(a, "/farm", &c->farm));
  if (r->scene->estimate) GH_TRY(get_whole(a, c));
  hex(a->sum, check);
  GH_TRY(gh_h5_get_text(a->file, "/check", sizeof stored, stored));
  if (strcmp(check, stored) == 0) return GH_OK;
  return gh_fail(a->ctx, GH_INPUT, "it is damaged: its checksum is %s, and its content gives %s", stored,
                 check);
}

static gh_status use(scene_results *r, scene_position *p, content *c) {
  scene_text list[SCENE_TEXTS];
  p->counter = c->where[0], p->step = c->where[1], p->increment = c->where[2];
  memcpy(&p->sum, c->summary, sizeof p->sum);
  for (int k = 1; k <= p->step; k++) {
    p->begin_u[k] = c->begin_u[k];
    c->begin_u[k] = NULL;
  }
  snprintf(r->started, sizeof r->started, "%s", c->started);
  scene_results_texts(r, list);
  for (int k = 0; k < SCENE_TEXTS; k++) GH_TRY(gh_text_set(list[k].text, c->text[k], c->length[k]));
  if (c->apart) {
    GH_TRY(gh_macro_load(r->macro, c->whole_macro, c->whole_size));
    GH_TRY(gh_farm_load(r->farm, &c->whole_farm));
    GH_TRY(gh_macro_part(r->macro));
  }
  GH_TRY(gh_macro_load(r->macro, c->macro, c->macro_size));
  GH_TRY(gh_farm_load(r->farm, &c->farm));
  return scene_results_resume(r, c->where[3]);
}

gh_status scene_checkpoint_read(scene_results *r, scene_position *p) {
  archive a = {.ctx = r->ctx, .sum = first_sum};
  content c = {0};
  struct stat info;
  char *path;
  GH_TRY(scene_result_path(r, FILE_NAME, &path));
  gh_status status = gh_h5_read(r->ctx, path, KIND, NULL, &a.file);
  if (status == GH_OK && stat(path, &info) != 0)
    status = gh_fail(r->ctx, GH_SYSTEM, "%s: %s", path, strerror(errno));
  else if (status == GH_OK) a.bytes = (size_t)info.st_size;
  if (status == GH_OK) {
    status = get_all(&a, r, &c);
    if (status == GH_OK) status = use(r, p, &c);
    if (status != GH_OK) gh_prefix(r->ctx, status, "%s: cannot go on from this checkpoint: ", path);
  }
  gh_h5_close(&a.file);
  free_content(r->scene, &c);
  free(path);
  return status;
}
