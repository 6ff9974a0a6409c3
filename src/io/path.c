/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Names of files. */
#include "granhom/io.h"

#include <libgen.h>
#include <stdlib.h>
#include <string.h>

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
