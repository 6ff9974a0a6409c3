/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Text in memory, folders, paths. */
#include "io/file.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct gh_text {
  gh_context *ctx;
  char *bytes;
  size_t length, capacity;
  bool failed; /* a print found no memory: whoever reads or commits the text gets the error */
};

gh_status gh_text_create(gh_context *ctx, gh_text **text) {
  gh_status s = gh_alloc(ctx, 1, sizeof **text, text);
  if (s == GH_OK) (*text)->ctx = ctx;
  return s;
}

void gh_text_destroy(gh_text **text) {
  if (!text || !*text) return;
  free((*text)->bytes);
  free(*text);
  *text = NULL;
}

static void print(gh_text *t, const char *format, va_list args) {
  va_list again;
  va_copy(again, args);
  int n = vsnprintf(NULL, 0, format, again);
  va_end(again);
  if (n < 0 || gh_grow(NULL, t->length + (size_t)n + 1, 1, &t->capacity, &t->bytes) != GH_OK) {
    t->failed = true;
    return;
  }
  vsnprintf(t->bytes + t->length, (size_t)n + 1, format, args);
  t->length += (size_t)n;
}

void gh_text_print(gh_text *t, const char *format, ...) {
  va_list args;
  va_start(args, format);
  gh_c_locale l = gh_c_locale_begin();
  print(t, format, args);
  gh_c_locale_end(l);
  va_end(args);
}

gh_status gh_text_add(gh_text *t, const void *bytes, size_t length) {
  gh_status s = gh_grow(t->ctx, t->length + length + 1, 1, &t->capacity, &t->bytes);
  t->failed = t->failed || s != GH_OK;
  if (s != GH_OK) return s;
  memcpy(t->bytes + t->length, bytes, length);
  t->length += length;
  t->bytes[t->length] = 0;
  return GH_OK;
}

gh_status gh_text_set(gh_text *t, const char *bytes, size_t length) {
  GH_TRY(gh_grow(t->ctx, length + 1, 1, &t->capacity, &t->bytes));
  memcpy(t->bytes, bytes, length);
  t->bytes[length] = 0;
  t->length = length;
  t->failed = false;
  return GH_OK;
}

/* The field is a word that printf gives for what is no finite number. */
static bool is_finite_field(const char *at) {
  if (*at == '-' || *at == '+') at++;
  return strncmp(at, "nan", 3) != 0 && strncmp(at, "inf", 3) != 0;
}

/* Name of a column, from the text's first line. */
static const char *column_name(const gh_text *t, int column, char name[64]) {
  const char *at = t->bytes;
  for (int k = 0; k < column && *at && *at != '\n'; at++) k += *at == ',';
  snprintf(name, 64, "%.*s", (int)strcspn(at, ",\n"), at);
  return name;
}

gh_status gh_text_check_row(gh_text *t, size_t from, const char *table) {
  char name[64], value[32];
  GH_TRY(gh_text_check(t));
  int column = 0;
  for (size_t k = from; k > 0 && t->bytes[k - 1] != '\n'; k--) column += t->bytes[k - 1] == ',';
  for (const char *at = t->bytes + from; from < t->length && *at; at++) {
    const size_t length = strcspn(at, ",\n");
    if (!is_finite_field(at)) {
      snprintf(value, sizeof value, "%.*s", (int)length, at);
      t->length = from;
      t->bytes[from] = 0;
      return gh_fail(t->ctx, GH_DIVERGED, "%s: %s would be %s, which is no result: the row is not written",
                     table, column_name(t, column, name), value);
    }
    at += length;
    column = *at == ',' ? column + 1 : 0;
    if (!*at) break;
  }
  return GH_OK;
}

void gh_text_cut(gh_text *t, size_t length) {
  if (length >= t->length) return;
  t->length = length;
  t->bytes[length] = 0;
}

gh_status gh_text_check(const gh_text *t) {
  if (!t->failed) return GH_OK;
  return gh_fail(t->ctx, GH_MEMORY, "no memory for a text (%zu bytes so far)", t->length);
}

const char *gh_text_get(const gh_text *t, size_t *length) {
  if (length) *length = t->failed ? 0 : t->length;
  if (t->failed) return NULL;
  return t->bytes ? t->bytes : "";
}

void gh_text_join(gh_text *t, const gh_text *other) {
  if (other->failed) t->failed = true;
  else if (other->length > 0) gh_text_add(t, other->bytes, other->length);
}

gh_status gh_text_commit(gh_text *t, const char *path) {
  gh_status s = gh_text_check(t);
  if (s != GH_OK) return gh_prefix(t->ctx, s, "%s: ", path);
  return gh_file_write(t->ctx, path, t->bytes, t->length);
}

/* ---- folders and paths ---- */

gh_status gh_file_there(gh_context *ctx, const char *path, bool *there) {
  struct stat info;
  *there = stat(path, &info) == 0;
  if (*there || errno == ENOENT || errno == ENOTDIR) return GH_OK;
  return gh_fail(ctx, GH_SYSTEM, "%s: cannot be looked at: %s", path, strerror(errno));
}

gh_status gh_file_remove(gh_context *ctx, const char *path) {
  if (unlink(path) == 0 || errno == ENOENT || errno == ENOTDIR) return GH_OK;
  return gh_fail(ctx, GH_SYSTEM, "%s: cannot be removed: %s", path, strerror(errno));
}

/* One folder whose parent exists. */
static gh_status folder_make_one(gh_context *ctx, const char *path) {
  struct stat info;
  if (mkdir(path, 0777) == 0) return GH_OK;
  int reason = errno;
  if (stat(path, &info) != 0)
    return gh_fail(ctx, GH_SYSTEM, "%s: cannot make the folder: %s", path, strerror(reason));
  if (!S_ISDIR(info.st_mode)) return gh_fail(ctx, GH_INPUT, "%s: is a file, a folder is wanted", path);
  return GH_OK;
}

gh_status gh_folder_make(gh_context *ctx, const char *path) {
  if (!*path) return gh_fail(ctx, GH_INPUT, "the name of a folder is empty");
  char *part = strdup(path);
  if (!part) return gh_fail(ctx, GH_MEMORY, "%s: no memory for a path", path);
  gh_status s = GH_OK;
  for (char *p = part + 1; s == GH_OK; p++) {
    if (*p && *p != '/') continue;
    char end = *p;
    *p = 0;
    s = folder_make_one(ctx, part);
    if (!end) break;
    *p = end;
  }
  free(part);
  return s;
}
