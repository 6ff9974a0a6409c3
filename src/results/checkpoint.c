/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Writing and reading checkpoints. */
#include "results/archive.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char FILE_NAME[] = "checkpoint.h5";

static const gh_mark format = {"/made/format", "is no checkpoint of this version of granhom", ""};

/* ---- writing ---- */

static gh_status marks_put(gh_archive *a, const gh_solver_results *s) {
  gh_mark list[GH_MARKS];
  char blas[GH_BLAS_SIZE];
  const int n = s->marks(s->data, list);
  GH_TRY(gh_blas(a->ctx, blas, sizeof blas));
  GH_TRY(gh_h5_put_text(a->file, format.name, gh_results_kind(FILE_NAME)));
  for (int k = 0; k < n; k++) GH_TRY(gh_h5_put_text(a->file, list[k].name, list[k].value));
  return gh_h5_put_text(a->file, "/made/blas", blas);
}

static gh_status texts_put(gh_archive *a, const gh_results *r) {
  results_text list[RESULTS_TEXTS];
  char name[64];
  results_texts(r, list);
  GH_TRY(gh_archive_put_bytes(a, "/text/started", strlen(r->started), r->started));
  for (int k = 0; k < RESULTS_TEXTS; k++) {
    size_t length;
    GH_TRY(gh_text_check(list[k].text));
    const char *text = gh_text_get(list[k].text, &length);
    snprintf(name, sizeof name, "/text/%s", list[k].name);
    GH_TRY(gh_archive_put_bytes(a, name, length, text));
  }
  return gh_archive_put_ints(a, "/run/frames", 1, &r->frames);
}

gh_status gh_checkpoint_make(const gh_results *r, gh_h5 **file) {
  gh_archive a = {.ctx = r->ctx};
  char *path;
  GH_TRY(results_path(r, FILE_NAME, &path));
  gh_status status = gh_h5_open(r->ctx, path, gh_results_kind(FILE_NAME), false, &a.file);
  free(path);
  if (status != GH_OK) return status;
  GH_TRY_OR(marks_put(&a, r->solver), failed);
  GH_TRY_OR(texts_put(&a, r), failed);
  GH_TRY_OR(r->solver->save(r->solver->data, &a), failed);
  *file = a.file;
  return GH_OK;
failed:
  gh_h5_close(&a.file);
  return status;
}

/* ---- reading ---- */

gh_status gh_checkpoint_find(const gh_results *r, bool *there) {
  char *path;
  GH_TRY(results_path(r, FILE_NAME, &path));
  gh_status status = gh_file_there(r->ctx, path, there);
  free(path);
  return status;
}

/* Another BLAS gives results as right as before, but other last bits. */
static gh_status blas_check(gh_archive *a) {
  char there[GH_BLAS_SIZE] = "", here[GH_BLAS_SIZE];
  GH_TRY(gh_blas(a->ctx, here, sizeof here));
  if (gh_h5_get_text(a->file, "/made/blas", sizeof there, there) == GH_OK && strcmp(there, here) != 0)
    gh_log(a->ctx, GH_LEVEL_WARNING,
           "the checkpoint was made with the BLAS %s, and now it is %s: results agree to round-off, not to "
           "the bit",
           there, here);
  return GH_OK;
}

static gh_status mark_check(gh_archive *a, const gh_mark *mark) {
  char value[64] = "";
  GH_TRY(gh_h5_get_text(a->file, mark->name, sizeof value, value));
  return strcmp(value, mark->value) == 0 ? GH_OK : gh_fail(a->ctx, GH_INPUT, "it %s", mark->what);
}

static gh_status marks_check(gh_archive *a, const gh_solver_results *s) {
  gh_mark list[GH_MARKS], kind = format;
  const int n = s->marks(s->data, list);
  snprintf(kind.value, sizeof kind.value, "%s", gh_results_kind(FILE_NAME));
  GH_TRY(mark_check(a, &kind));
  for (int k = 0; k < n; k++) GH_TRY(mark_check(a, list + k));
  return blas_check(a);
}

/* What the results themselves keep in a checkpoint, before any of it is put to use. */
typedef struct content {
  char *started, *text[RESULTS_TEXTS];
  size_t length[RESULTS_TEXTS];
  int frames;
} content;

static void content_free(content *c) {
  free(c->started);
  for (int k = 0; k < RESULTS_TEXTS; k++) free(c->text[k]);
}

static gh_status texts_get(gh_archive *a, const gh_results *r, content *c) {
  results_text list[RESULTS_TEXTS];
  char name[64];
  size_t size;
  int *frames = NULL;
  results_texts(r, list);
  GH_TRY(gh_archive_get_bytes(a, "/text/started", &size, &c->started));
  for (int k = 0; k < RESULTS_TEXTS; k++) {
    snprintf(name, sizeof name, "/text/%s", list[k].name);
    GH_TRY(gh_archive_get_bytes(a, name, &c->length[k], &c->text[k]));
  }
  gh_status status = gh_archive_get_ints(a, "/run/frames", &size, &frames);
  if (status == GH_OK && (size != 1 || frames[0] < 0))
    status = gh_fail(a->ctx, GH_INPUT, "/run/frames is no number of increments");
  if (status == GH_OK) c->frames = frames[0];
  free(frames);
  return status;
}

static gh_status all_get(gh_archive *a, const gh_results *r, content *c) {
  GH_TRY(marks_check(a, r->solver));
  GH_TRY(texts_get(a, r, c));
  return r->solver->load(r->solver->data, a);
}

static gh_status content_use(gh_results *r, content *c) {
  results_text list[RESULTS_TEXTS];
  snprintf(r->started, sizeof r->started, "%s", c->started);
  results_texts(r, list);
  for (int k = 0; k < RESULTS_TEXTS; k++) GH_TRY(gh_text_set(list[k].text, c->text[k], c->length[k]));
  GH_TRY(r->solver->resume(r->solver->data));
  return results_resume(r, c->frames);
}

gh_status gh_checkpoint_read(gh_results *r) {
  gh_archive a = {.ctx = r->ctx};
  content c = {0};
  struct stat info;
  char *path;
  GH_TRY(results_path(r, FILE_NAME, &path));
  gh_status status = gh_h5_read(r->ctx, path, gh_results_kind(FILE_NAME), NULL, &a.file);
  if (status == GH_OK && stat(path, &info) != 0)
    status = gh_fail(r->ctx, GH_SYSTEM, "%s: %s", path, strerror(errno));
  else if (status == GH_OK) a.bytes = (size_t)info.st_size;
  if (status == GH_OK) {
    status = all_get(&a, r, &c);
    if (status == GH_OK) status = content_use(r, &c);
    if (status != GH_OK) gh_prefix(r->ctx, status, "%s: cannot continue from this checkpoint: ", path);
  }
  gh_h5_close(&a.file);
  content_free(&c);
  free(path);
  return status;
}
