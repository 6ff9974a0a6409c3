/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One writer in a folder.
 *
 * The lock is one of the kernel's on DIR/.lock (open file description lock, which network file systems have
 * too): it ends with the process however that ends, so that a file that a killed process has left behind
 * locks nothing. What stands in the file, host and process, is for messages alone. */
#define _GNU_SOURCE
#include "granhom/io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define NAME ".lock"

enum { OWNER = 320, TRIES = 100 };

struct gh_lock {
  gh_context *ctx;
  char *folder, *path;
  size_t made; /* letters of the folder's part that was there; what is behind was made for the lock */
  int fd;
};

/* ---- the owner ---- */

static void owner_write(int fd) {
  char host[256] = "", text[OWNER];
  if (gethostname(host, sizeof host - 1) != 0 || !*host) strcpy(host, "unknown");
  int n = snprintf(text, sizeof text, "process %ld on host %s\n", (long)getpid(), host);
  bool fine = ftruncate(fd, 0) == 0 && pwrite(fd, text, (size_t)n, 0) == n;
  (void)fine; /* the lock holds without it */
}

/* The owner writes its name just after it has the lock: a moment is left for that. */
static void owner_read(int fd, char owner[OWNER]) {
  const struct timespec moment = {.tv_nsec = 20000000};
  ssize_t n = 0;
  for (int k = 0; k < 10; k++) {
    nanosleep(&moment, NULL);
    n = pread(fd, owner, OWNER - 1, 0);
    if (n > 0 && owner[n - 1] == '\n') break;
  }
  owner[n > 0 ? n : 0] = 0;
  for (char *c = owner; *c; c++)
    if (*c < ' ') *c = c[1] ? '?' : 0;
  if (!*owner) strcpy(owner, "another process");
}

/* ---- the folder ---- */

/* Length of the part of the path that is there. */
static size_t folder_there(const char *folder) {
  struct stat info;
  char *part = strdup(folder);
  if (!part) return strlen(folder);
  size_t n = strlen(part);
  while (n > 0 && stat(part, &info) != 0) {
    while (n > 0 && part[n - 1] == '/') n--;
    while (n > 0 && part[n - 1] != '/') n--;
    part[n] = 0;
  }
  free(part);
  return n;
}

/* Folders that were made for the lock and hold nothing. */
static void folder_remove(gh_lock *l) {
  size_t n = strlen(l->folder);
  for (bool empty = true; empty && n > l->made;) {
    while (n > l->made && l->folder[n - 1] == '/') l->folder[--n] = 0;
    if (n > l->made) empty = rmdir(l->folder) == 0;
    while (n > l->made && l->folder[n - 1] != '/') l->folder[--n] = 0;
  }
}

/* ---- the lock ---- */

static gh_status refuse(gh_lock *l) {
  char owner[OWNER];
  owner_read(l->fd, owner);
  return gh_fail(l->ctx, GH_SYSTEM,
                 "%s: %s writes into this folder (%s); wait for its end, or choose another folder", l->folder,
                 owner, l->path);
}

/* GH_OK with *again: the owner of before has just removed the file. */
static gh_status lock_try(gh_lock *l, bool *again) {
  struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  struct stat ours, now;
  *again = false;
  l->fd = open(l->path, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0666);
  if (l->fd < 0 && errno == ENOENT) {
    *again = true;
    return GH_OK;
  }
  if (l->fd < 0) return gh_fail(l->ctx, GH_SYSTEM, "%s: cannot be opened: %s", l->path, strerror(errno));
  if (fcntl(l->fd, F_OFD_SETLK, &whole) != 0) {
    if (errno == EAGAIN || errno == EACCES) return refuse(l);
    gh_log(l->ctx, GH_LEVEL_WARNING,
           "%s: this file system has no locks (%s): a second run in this folder would not be noticed",
           l->folder, strerror(errno));
  }
  *again = fstat(l->fd, &ours) != 0 || lstat(l->path, &now) != 0 || ours.st_ino != now.st_ino ||
           ours.st_dev != now.st_dev;
  if (!*again) {
    owner_write(l->fd);
  } else {
    close(l->fd);
    l->fd = -1;
  }
  return GH_OK;
}

static gh_status lock_take(gh_lock *l) {
  bool again = true;
  l->made = folder_there(l->folder);
  for (int k = 0; k < TRIES && again; k++) {
    GH_TRY(gh_folder_make(l->ctx, l->folder));
    GH_TRY(lock_try(l, &again));
  }
  return again ? gh_fail(l->ctx, GH_SYSTEM, "%s: cannot be locked: it is removed again and again", l->path)
               : GH_OK;
}

static void lock_free(gh_lock *l) {
  if (l->fd >= 0) close(l->fd);
  free(l->folder);
  free(l->path);
  free(l);
}

gh_status gh_lock_create(gh_context *ctx, const char *folder, gh_lock **lock) {
  gh_lock *l;
  *lock = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *l, &l));
  *l = (gh_lock){.ctx = ctx, .made = SIZE_MAX, .fd = -1};
  l->folder = strdup(folder);
  l->path = gh_path_join(folder, NAME);
  gh_status s = l->folder && l->path ? lock_take(l) : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (s == GH_OK) {
    *lock = l;
  } else {
    if (l->folder) folder_remove(l);
    lock_free(l);
  }
  return s;
}

/* The file goes before the lock does: who opens it afterwards opens another. */
void gh_lock_destroy(gh_lock **lock) {
  if (!lock || !*lock) return;
  unlink((*lock)->path);
  folder_remove(*lock);
  lock_free(*lock);
  *lock = NULL;
}
