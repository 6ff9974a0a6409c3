/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Which file a name means. */
#include "io/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_LINKS = 40 };

/* One step along a symbolic link: *path becomes what it names. 0, or errno. */
static int link_follow(char **path) {
  char name[4096];
  ssize_t n = readlink(*path, name, sizeof name - 1);
  if (n < 0) return errno;
  name[n] = 0;
  char *folder = gh_path_folder(*path), *next = folder ? gh_path_join(folder, name) : NULL;
  free(folder);
  if (!next) return ENOMEM;
  free(*path);
  *path = next;
  return 0;
}

/* /dev/stdout is a link whose text names nothing when it is a pipe. */
static bool is_stream(const char *path) {
  struct stat info;
  return stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

int gh_file_target(const char *path, char **target) {
  struct stat info;
  int reason = 0;
  *target = strdup(path);
  if (!*target) return ENOMEM;
  if (is_stream(path)) return 0;
  for (int k = 0; !reason && lstat(*target, &info) == 0 && S_ISLNK(info.st_mode); k++)
    reason = k < MOST_LINKS ? link_follow(target) : ELOOP;
  return reason;
}

/* ---- one file by two names ---- */

static const char *last_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

static bool same_folder(const char *a, const char *b) {
  struct stat x, y;
  char *one = gh_path_folder(a), *two = gh_path_folder(b);
  const bool same =
      one && two && stat(one, &x) == 0 && stat(two, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
  free(one);
  free(two);
  return same;
}

bool gh_file_same(const char *a, const char *b) {
  struct stat x, y;
  const bool first = stat(a, &x) == 0, second = stat(b, &y) == 0;
  if (first || second) /* what is written to a device does not replace anything */
    return first && second && x.st_dev == y.st_dev && x.st_ino == y.st_ino && !S_ISCHR(x.st_mode);
  char *one = NULL, *two = NULL;
  const bool same = gh_file_target(a, &one) == 0 && gh_file_target(b, &two) == 0 && same_folder(one, two) &&
                    strcmp(last_name(one), last_name(two)) == 0;
  free(one);
  free(two);
  return same;
}

gh_status gh_file_regular(gh_context *ctx, const char *path) {
  struct stat info;
  if (stat(path, &info) != 0 || S_ISREG(info.st_mode)) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "%s: is a %s, a file is wanted", path,
                 S_ISDIR(info.st_mode) ? "folder" : "device or a pipe");
}
