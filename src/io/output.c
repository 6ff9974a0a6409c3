/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Whether results can be written where they shall go, before they are computed. */
#include "io/file.h"

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

/* A name that no file can have: "out/", ".", "a/..". */
static bool names_folder(const char *path) {
  const char *slash = strrchr(path, '/'), *last = slash ? slash + 1 : path;
  return !*last || strcmp(last, ".") == 0 || strcmp(last, "..") == 0;
}

static bool is_none(const char *path) {
  return !path || strcmp(path, "-") == 0;
}

gh_status gh_output_check(gh_context *ctx, const char *path) {
  struct stat info;
  if (is_none(path)) return GH_OK;
  if (!*path) return gh_fail(ctx, GH_INPUT, "the name of a file for results is empty");
  if (names_folder(path))
    return gh_fail(ctx, GH_INPUT, "%s: is the name of a folder, and a file is to be written", path);
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
  if (stat(path, &info) == 0 && !(is_folder ? S_ISDIR(info.st_mode) : S_ISREG(info.st_mode)))
    status = gh_fail(ctx, GH_INPUT, "%s: is a %s, and a %s is to be written there", path,
                     S_ISREG(info.st_mode)   ? "file"
                     : S_ISDIR(info.st_mode) ? "folder"
                                             : "device or a pipe",
                     is_folder ? "folder" : "file");
  free(path);
  return status;
}

/* ---- several outputs, and inputs ---- */

static gh_status check_inputs_kept(gh_context *ctx, const char *output, const char *const *input,
                                   int inputs) {
  for (int m = 0; m < inputs; m++) {
    const bool standard = input[m] && strcmp(input[m], "-") == 0;
    if (input[m] && gh_file_same(output, standard ? "/dev/stdin" : input[m]))
      return gh_fail(ctx, GH_INPUT, "%s: is an input (%s), and results would be written over it", output,
                     standard ? "standard input" : input[m]);
  }
  return GH_OK;
}

gh_status gh_outputs_check(gh_context *ctx, const gh_output *output, int outputs, const char *const *input,
                           int inputs) {
  for (int k = 0; k < outputs; k++) {
    const char *path = output[k].path;
    if (is_none(path)) continue;
    for (int m = 0; m < k; m++)
      if (!is_none(output[m].path) && gh_file_same(output[m].path, path))
        return gh_fail(ctx, GH_INPUT, "%s: two of the results would be written into this file", path);
    GH_TRY(check_inputs_kept(ctx, path, input, inputs));
    GH_TRY(gh_output_check(ctx, path));
    GH_TRY(gh_kind_kept(ctx, path, output[k].kind));
  }
  return GH_OK;
}

gh_status gh_outputs_within(gh_context *ctx, const char *folder, const char *const *name,
                            const char *const *input, int inputs) {
  for (; *name; name++) {
    GH_TRY(gh_output_within(ctx, folder, *name, false));
    char *path = gh_path_join(folder, *name);
    gh_status status =
        path ? check_inputs_kept(ctx, path, input, inputs) : gh_fail(ctx, GH_MEMORY, "no memory for a path");
    free(path);
    GH_TRY(status);
  }
  return GH_OK;
}

gh_status gh_output_unmixed(gh_context *ctx, const char *folder, const char *const *mark, const char *whose) {
  for (; *mark; mark++) {
    char *path = gh_path_join(folder, *mark);
    bool there = false;
    gh_status status =
        path ? gh_file_there(ctx, path, &there) : gh_fail(ctx, GH_MEMORY, "no memory for a path");
    free(path);
    GH_TRY(status);
    if (there)
      return gh_fail(ctx, GH_INPUT, "%s: holds the results of `granhom %s` (%s); choose another folder",
                     folder, whose, *mark);
  }
  return GH_OK;
}
