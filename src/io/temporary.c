/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Folders for temporary files.
 *
 * granhom-WHAT-PID-XXXXXX in $TMPDIR or /tmp. A file in it is locked as long as its process lives, so that a
 * folder that a killed process has left can be told from one in use, whatever process has that number now. */
#define _GNU_SOURCE 1 /* flock, O_DIRECTORY */
#include "granhom/io.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char LOCK[] = ".granhom-lock";
enum { DEEPEST = 16, TRIES = 10 };

/* Of the system's temporary files, with its whole name (caller frees). */
static char *temporary_root(void) {
  const char *root = getenv("TMPDIR");
  return realpath(root && *root ? root : "/tmp", NULL);
}

/* granhom-WHAT-PID-XXXXXX */
static bool name_is_ours(const char *name) {
  static const char prefix[] = "granhom-";
  if (strncmp(name, prefix, sizeof prefix - 1) != 0) return false;
  name += sizeof prefix - 1;
  size_t word = strspn(name, "abcdefghijklmnopqrstuvwxyz"), digits = 0;
  if (!word || name[word] != '-') return false;
  name += word + 1;
  digits = strspn(name, "0123456789");
  if (!digits || name[digits] != '-' || strlen(name + digits + 1) != 6) return false;
  for (name += digits + 1; *name; name++)
    if (!isalnum((unsigned char)*name)) return false;
  return true;
}

/* What is in the folder, links themselves and not what they lead to. Closes fd. */
static void folder_empty(int fd, int depth) {
  DIR *dir = fdopendir(fd);
  if (!dir) {
    close(fd);
    return;
  }
  for (struct dirent *e; (e = readdir(dir));) {
    if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0) continue;
    if (unlinkat(dirfd(dir), e->d_name, 0) == 0) continue;
    int inner = openat(dirfd(dir), e->d_name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (inner >= 0 && depth < DEEPEST) folder_empty(inner, depth + 1);
    else if (inner >= 0) close(inner);
    unlinkat(dirfd(dir), e->d_name, AT_REMOVEDIR);
  }
  closedir(dir);
}

/* Takes the folder's lock; -1: there is none, it is not ours, or its process lives. */
static int folder_claim(int fd) {
  struct stat s;
  if (fstat(fd, &s) != 0 || s.st_uid != geteuid()) return -1;
  int lock = openat(fd, LOCK, O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (lock < 0 || flock(lock, LOCK_EX | LOCK_NB) == 0) return lock;
  close(lock);
  return -1;
}

void gh_temporary_clean(void) {
  char *root = temporary_root();
  DIR *dir = root ? opendir(root) : NULL;
  free(root);
  for (struct dirent *e; dir && (e = readdir(dir));) {
    if (!name_is_ours(e->d_name)) continue;
    int fd = openat(dirfd(dir), e->d_name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    int lock = fd < 0 ? -1 : folder_claim(fd);
    if (lock >= 0) {
      folder_empty(fd, 0);
      unlinkat(dirfd(dir), e->d_name, AT_REMOVEDIR);
      close(lock);
    } else if (fd >= 0) close(fd);
  }
  if (dir) closedir(dir);
}

/* A new folder with a lock; false with *code: the system's error, 0 when another process took it for one that
 * was left. */
static bool folder_make(const char *root, const char *what, gh_temporary *t, int *code) {
  int n = snprintf(t->folder, sizeof t->folder, "%s/granhom-%s-%ld-XXXXXX", root, what, (long)getpid());
  char path[sizeof t->folder + sizeof LOCK];
  *code = n < 0 || (size_t)n >= sizeof t->folder ? ENAMETOOLONG : 0;
  if (!*code && !mkdtemp(t->folder)) *code = errno;
  if (*code) return false;
  snprintf(path, sizeof path, "%s/%s", t->folder, LOCK);
  t->lock = open(path, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (t->lock >= 0 && flock(t->lock, LOCK_EX | LOCK_NB) == 0) return true;
  *code = errno == EWOULDBLOCK ? 0 : errno;
  if (t->lock >= 0) close(t->lock);
  unlink(path);
  rmdir(t->folder);
  return false;
}

gh_status gh_temporary_make(gh_context *ctx, const char *what, gh_temporary *t) {
  int code = 0;
  bool made = false;
  *t = (gh_temporary){.lock = -1};
  gh_temporary_clean();
  const char *given = getenv("TMPDIR");
  if (given && *given && access(given, F_OK) != 0) GH_TRY(gh_folder_make(ctx, given)); /* as MPI does */
  char *root = temporary_root();
  if (!root) code = errno;
  for (int k = 0; k < TRIES && root && !made && !code; k++) made = folder_make(root, what, t, &code);
  free(root);
  if (made) return GH_OK;
  t->lock = -1;
  *t->folder = '\0';
  return gh_fail(ctx, GH_SYSTEM, "%s%s: no folder for temporary files can be made there: %s",
                 given && *given ? "TMPDIR = " : "", given && *given ? given : "/tmp", strerror(code));
}

void gh_temporary_remove(gh_temporary *t) {
  if (!*t->folder) return;
  int fd = open(t->folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd >= 0) folder_empty(fd, 0);
  rmdir(t->folder);
  if (t->lock >= 0) close(t->lock);
  *t = (gh_temporary){.lock = -1};
}
