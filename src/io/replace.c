/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Files that appear whole or not at all.
 *
 * What is to become a file is written under another name in the same folder, fsynced and renamed. That name
 * is random and made with O_EXCL: programs that write the same file at the same time do not meet, and what
 * others have put there is neither followed nor overwritten. Where the system can, the new file has no name
 * at all until it is complete (O_TMPFILE), so that a killed program leaves nothing behind. */
#define _GNU_SOURCE
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MOST_NAMES = 100 };

typedef struct new_file {
  char *target; /* the file itself, behind symbolic links */
  char *name;   /* of the new file; it exists when `named` */
  int fd;
  bool there, named; /* there: the target exists */
  bool unable;       /* this system cannot make a file without a name, or cannot give it one */
  struct stat old;   /* of the target that is there */
} new_file;

static gh_status cannot_write(gh_context *ctx, const char *path, int reason) {
  return gh_fail(ctx, GH_SYSTEM, "%s: cannot write: %s", path, strerror(reason));
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

/* ---- the target ---- */

/* A file that its owner has made read-only is not replaced, though its folder would allow that. */
static int target_check(const char *path, new_file *t) {
  int reason = gh_file_target(path, &t->target); /* new_file_close frees it */
  if (reason) return reason;
  t->there = stat(t->target, &t->old) == 0; // NOLINT(clang-analyzer-unix.Malloc)
  if (!t->there) return errno == ENOENT ? 0 : errno;
  if (S_ISDIR(t->old.st_mode)) return EISDIR;
  return faccessat(AT_FDCWD, t->target, W_OK, AT_EACCESS) == 0 ? 0 : errno;
}

/* ---- the new file ---- */

static uint64_t random_bits(void) {
  uint64_t bits;
  if (getrandom(&bits, sizeof bits, GRND_NONBLOCK) == (ssize_t)sizeof bits) return bits;
  struct timespec now; /* O_EXCL keeps names apart all the same */
  clock_gettime(CLOCK_MONOTONIC, &now);
  return ((uint64_t)now.tv_nsec << 32) ^ ((uint64_t)now.tv_sec << 20) ^ (uint64_t)getpid();
}

/* A new name in the target's folder. 0, or ENOMEM. */
static int name_draw(new_file *t) {
  char base[40];
  snprintf(base, sizeof base, ".granhom-%016llx.tmp", (unsigned long long)random_bits());
  char *folder = gh_path_folder(t->target);
  free(t->name);
  t->name = folder ? gh_path_join(folder, base) : NULL;
  free(folder);
  return t->name ? 0 : ENOMEM;
}

/* Until it is complete nobody else may read what takes the place of a file that nobody else may read. */
static mode_t mode_at_first(const new_file *t) {
  return t->there ? 0600 : 0666;
}

static int open_named(new_file *t) {
  int reason = EEXIST;
  for (int k = 0; k < MOST_NAMES && reason == EEXIST; k++) {
    reason = name_draw(t);
    if (reason) return reason;
    t->fd = open(t->name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode_at_first(t));
    reason = t->fd < 0 ? errno : 0;
  }
  t->named = !reason;
  return reason;
}

static int open_nameless(new_file *t) {
  char *folder = gh_path_folder(t->target);
  if (!folder) return ENOMEM;
  t->fd = open(folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, mode_at_first(t));
  int reason = t->fd < 0 ? errno : 0;
  free(folder);
  t->unable = reason != 0;
  return reason;
}

/* A nameless file gets a name. */
static int name_give(new_file *t) {
  char self[40];
  int reason = EEXIST;
  snprintf(self, sizeof self, "/proc/self/fd/%d", t->fd);
  for (int k = 0; k < MOST_NAMES && reason == EEXIST; k++) {
    reason = name_draw(t);
    if (reason) return reason;
    reason = linkat(AT_FDCWD, self, AT_FDCWD, t->name, AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
  }
  t->named = !reason;
  t->unable = reason != 0;
  return reason;
}

/* Owner and permissions of the file that is replaced. Another owner can be kept by root alone. */
static int mode_keep(const new_file *t) {
  if (!t->there) return 0;
  if (t->old.st_uid != geteuid() || t->old.st_gid != getegid()) {
    int kept = fchown(t->fd, t->old.st_uid, t->old.st_gid);
    (void)kept;
  }
  if (fchmod(t->fd, t->old.st_mode & 0777) == 0) return 0;
  return errno == EPERM || errno == EOPNOTSUPP ? 0 : errno; /* some file systems have no permissions */
}

/* Makes the rename itself last. Not every file system can do that for folders, and the file is complete by
 * now: only a device error counts. */
static int folder_sync(const char *path) {
  char *folder = gh_path_folder(path);
  if (!folder) return ENOMEM;
  int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC), reason = 0;
  free(folder);
  if (fd < 0) return 0;
  if (fsync(fd) != 0 && errno == EIO) reason = EIO;
  close(fd);
  return reason;
}

/* The new file is on disk and has a name; its descriptor is closed. */
static int file_complete(new_file *t) {
  int reason = mode_keep(t);
  if (!reason && fsync(t->fd) != 0) reason = errno;
  if (!reason && !t->named) reason = name_give(t);
  if (close(t->fd) != 0 && !reason && errno != EINTR) reason = errno;
  t->fd = -1;
  return reason;
}

static int file_replace(new_file *t) {
  if (rename(t->name, t->target) != 0) return errno;
  t->named = false;
  return folder_sync(t->target);
}

static int new_file_open(const char *path, new_file *t) {
  *t = (new_file){.fd = -1};
  return target_check(path, t);
}

/* Drops a new file that has not taken its place. */
static void file_drop(new_file *t) {
  if (t->fd >= 0) close(t->fd);
  if (t->named) unlink(t->name);
  t->fd = -1;
  t->named = false;
}

static void new_file_close(new_file *t) {
  file_drop(t);
  free(t->target);
  free(t->name);
}

/* ---- files ---- */

gh_status gh_file_writable(gh_context *ctx, const char *path) {
  new_file t;
  int reason = new_file_open(path, &t);
  if (!reason && t.there && !S_ISREG(t.old.st_mode)) reason = access(path, W_OK) == 0 ? 0 : errno;
  else if (!reason) reason = open_named(&t);
  new_file_close(&t);
  return reason ? cannot_write(ctx, path, reason) : GH_OK;
}

static int bytes_write(new_file *t, const void *bytes, size_t length, bool named) {
  int reason = named ? open_named(t) : open_nameless(t);
  if (!reason) reason = write_all(t->fd, bytes, length);
  if (!reason) reason = file_complete(t);
  if (!reason) reason = file_replace(t);
  if (reason) file_drop(t);
  return reason;
}

/* A rename would put a file in the place of /dev/null. */
static int device_write(const char *path, const void *bytes, size_t length) {
  int fd = open(path, O_WRONLY | O_CLOEXEC);
  int reason = fd < 0 ? errno : write_all(fd, bytes, length);
  if (fd >= 0 && close(fd) != 0 && !reason && errno != EINTR) reason = errno;
  return reason;
}

gh_status gh_file_write(gh_context *ctx, const char *path, const void *bytes, size_t length) {
  new_file t;
  int reason = new_file_open(path, &t);
  if (!reason && t.there && !S_ISREG(t.old.st_mode)) {
    reason = device_write(path, bytes, length);
  } else if (!reason) {
    reason = bytes_write(&t, bytes, length, false);
    if (reason && t.unable) reason = bytes_write(&t, bytes, length, true);
  }
  new_file_close(&t);
  return reason ? cannot_write(ctx, path, reason) : GH_OK;
}
