/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Whether results can be written where they shall go, before they are computed. */
#include "granhom/io.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

static gh_status refused(gh_context *ctx, const char *path, int reason) {
  return gh_fail(ctx, GH_SYSTEM, "%s: cannot write there: %s", path, strerror(reason));
}

/* Permissions do not say it all (read-only and special file systems, root): a file is made and removed. */
static gh_status try_folder(gh_context *ctx, const char *folder) {
  char *name = gh_path_join(folder, ".granhom-XXXXXX");
  if (!name) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  const int file = mkstemp(name), reason = file < 0 ? errno : 0;
  if (file >= 0) close(file), unlink(name);
  free(name);
  return reason ? refused(ctx, folder, reason) : GH_OK;
}

static gh_status check_parent(gh_context *ctx, const char *path) {
  struct stat info;
  char *folder = gh_path_folder(path);
  if (!folder) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = GH_OK;
  if (stat(folder, &info) != 0)
    status = gh_fail(ctx, GH_SYSTEM, "%s: its folder %s: %s", path, folder, strerror(errno));
  else if (!S_ISDIR(info.st_mode))
    status = gh_fail(ctx, GH_SYSTEM, "%s: %s is a file, and no folder", path, folder);
  free(folder);
  return status;
}

gh_status gh_output_check(gh_context *ctx, const char *path) {
  struct stat info;
  if (!path || strcmp(path, "-") == 0) return GH_OK;
  if (!*path) return gh_fail(ctx, GH_INPUT, "the name of a file for results is empty");
  if (stat(path, &info) != 0) GH_TRY(check_parent(ctx, path));
  else if (S_ISDIR(info.st_mode))
    return gh_fail(ctx, GH_SYSTEM, "%s: is a folder, and a file is to be written", path);
  else if (S_ISCHR(info.st_mode) && info.st_rdev == makedev(1, 7)) return refused(ctx, path, ENOSPC);
  return gh_file_writable(ctx, path);
}

gh_status gh_output_folder_check(gh_context *ctx, const char *folder) {
  struct stat info;
  if (!*folder) return gh_fail(ctx, GH_INPUT, "the name of the folder for results is empty");
  char *path = strdup(folder);
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = GH_OK;
  while (stat(path, &info) != 0 && (errno == ENOENT || errno == ENOTDIR)) { /* up to what exists */
    char *parent = gh_path_folder(path);
    free(path);
    if (!parent) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
    path = parent;
  }
  if (stat(path, &info) != 0) status = gh_fail(ctx, GH_SYSTEM, "%s: %s", path, strerror(errno));
  else if (!S_ISDIR(info.st_mode))
    status = gh_fail(ctx, GH_INPUT, "%s: is a file, and the results need a folder", path);
  else status = try_folder(ctx, path);
  free(path);
  return status;
}

gh_status gh_output_within(gh_context *ctx, const char *folder, const char *name, bool is_folder) {
  struct stat info;
  char *path = gh_path_join(folder, name);
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = GH_OK;
  if (stat(path, &info) == 0 && S_ISDIR(info.st_mode) != is_folder)
    status = gh_fail(ctx, GH_INPUT, "%s: is a %s, and a %s is to be written there", path,
                     is_folder ? "file" : "folder", is_folder ? "folder" : "file");
  free(path);
  return status;
}
