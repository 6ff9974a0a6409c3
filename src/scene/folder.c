/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The folder for the results of a scene. */
#include "granhom/results.h"
#include "scene/internal.h"

#include <stdlib.h>

gh_status scene_folder_open(const gh_scene *s, const char *folder, gh_lock **lock) {
  static const char *const studies[] = {"study.csv", "study.md", NULL};
  const char **file;
  int n;
  GH_TRY(gh_scene_files(s, &file, &n));
  gh_status status = gh_results_folder_check(s->ctx, folder, file, n);
  free(file);
  GH_TRY(status);
  GH_TRY(gh_lock_create(s->ctx, folder, lock));
  return gh_output_unmixed(s->ctx, folder, studies, "study");
}
