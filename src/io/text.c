/* Files that appear whole or not at all, folders, paths. SPDX-License-Identifier: GPL-2.0-or-later */
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct gh_text {
  gh_context *ctx;
  char *bytes;
  size_t length, capacity;
  bool failed; /* a print found no memory: told by the commit */
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

gh_status gh_text_set(gh_text *t, const char *bytes, size_t length) {
  GH_TRY(gh_grow(t->ctx, length + 1, 1, &t->capacity, &t->bytes));
  memcpy(t->bytes, bytes, length);
  t->bytes[length] = 0;
  t->length = length;
  t->failed = false;
  return GH_OK;
}

const char *gh_text_get(const gh_text *t, size_t *length) {
  if (length) *length = t->length;
  return t->bytes ? t->bytes : "";
}

gh_status gh_text_commit(gh_text *t, const char *path) {
  if (t->failed)
    return gh_fail(t->ctx, GH_MEMORY, "%s: no memory for its text (%zu bytes so far)", path, t->length);
  return gh_file_write(t->ctx, path, t->bytes, t->length);
}

/* ---- whole files ---- */

static gh_status cannot(gh_context *ctx, const char *path, const char *what, int reason) {
  return gh_fail(ctx, GH_SYSTEM, "%s: cannot %s: %s", path, what, strerror(reason));
}

/* 0, or errno of what went wrong. */
static int write_all(int fd, const char *bytes, size_t length) {
  while (length > 0) {
    ssize_t n = write(fd, bytes, length);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    bytes += n;
    length -= (size_t)n;
  }
  return 0;
}

/* Makes the rename itself last. Not every file system can do that for folders, and the file is complete by
 * now: only a device error counts. */
static int sync_folder(const char *path) {
  char *folder = gh_path_folder(path);
  if (!folder) return ENOMEM;
  int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC), reason = 0;
  free(folder);
  if (fd < 0) return 0;
  if (fsync(fd) != 0 && errno == EIO) reason = EIO;
  close(fd);
  return reason;
}

gh_status gh_file_replace(gh_context *ctx, const char *tmp, const char *path) {
  int fd = open(tmp, O_RDONLY | O_CLOEXEC);
  if (fd < 0) return cannot(ctx, tmp, "open", errno);
  int reason = fsync(fd) == 0 ? 0 : errno;
  if (close(fd) != 0 && !reason && errno != EINTR) reason = errno;
  if (!reason && rename(tmp, path) != 0) reason = errno;
  if (reason) {
    unlink(tmp);
    return cannot(ctx, path, "write", reason);
  }
  reason = sync_folder(path);
  return reason ? cannot(ctx, path, "write", reason) : GH_OK;
}

static gh_status write_by_rename(gh_context *ctx, const char *path, const void *bytes, size_t length) {
  size_t size = strlen(path) + sizeof ".tmp";
  char *tmp;
  GH_TRY(gh_alloc(ctx, size, 1, &tmp));
  snprintf(tmp, size, "%s.tmp", path);
  int fd = open(tmp, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  gh_status s = fd < 0 ? cannot(ctx, path, "write", errno) : GH_OK;
  if (s == GH_OK) {
    int reason = write_all(fd, bytes, length);
    if (close(fd) != 0 && !reason && errno != EINTR) reason = errno;
    if (reason) {
      unlink(tmp);
      s = cannot(ctx, path, "write", reason);
    }
  }
  if (s == GH_OK) s = gh_file_replace(ctx, tmp, path);
  free(tmp);
  return s;
}

gh_status gh_file_write(gh_context *ctx, const char *path, const void *bytes, size_t length) {
  struct stat info;
  bool there = stat(path, &info) == 0;
  if (there && S_ISDIR(info.st_mode)) return cannot(ctx, path, "write", EISDIR);
  if (there && !S_ISREG(info.st_mode)) { /* a rename would put a file in place of /dev/null */
    int fd = open(path, O_WRONLY | O_CLOEXEC);
    int reason = fd < 0 ? errno : write_all(fd, bytes, length);
    if (fd >= 0 && close(fd) != 0 && !reason && errno != EINTR) reason = errno;
    return reason ? cannot(ctx, path, "write", reason) : GH_OK;
  }
  char *real = there ? realpath(path, NULL) : NULL; /* behind a link stands the file that is meant */
  gh_status s = write_by_rename(ctx, real ? real : path, bytes, length);
  free(real);
  return s;
}

/* ---- folders and paths ---- */

/* One folder whose parent exists. */
static gh_status make_one(gh_context *ctx, const char *path) {
  struct stat info;
  if (mkdir(path, 0777) == 0) return GH_OK;
  int reason = errno;
  if (stat(path, &info) != 0) return cannot(ctx, path, "make the folder", reason);
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
    s = make_one(ctx, part);
    if (!end) break;
    *p = end;
  }
  free(part);
  return s;
}

char *gh_path_join(const char *dir, const char *name) {
  if (*name == '/' || !*dir) return strdup(name);
  size_t n = strlen(dir), size = n + strlen(name) + 2;
  char *path = malloc(size);
  if (path) snprintf(path, size, "%s%s%s", dir, dir[n - 1] == '/' ? "" : "/", name);
  return path;
}

char *gh_path_folder(const char *path) {
  char *copy = strdup(path), *folder = copy ? strdup(dirname(copy)) : NULL;
  free(copy);
  return folder;
}
