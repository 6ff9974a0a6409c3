/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a study writes, and what it was read from. */
#include "study/parts.h"

#include <stdlib.h>

const char *const *gh_study_files(void) {
  static const char *const files[] = {
      "study.csv",  "curves.csv", "study.md", "order.png", "work-precision.png", "work-precision-count.png",
      "curves.png", NULL};
  return files;
}

static gh_status input_add(gh_study *s, const char *path) {
  if (!path) return GH_OK;
  GH_TRY(gh_copy_text(s->ctx, path, &s->inputs[s->ninputs]));
  s->ninputs++;
  return GH_OK;
}

gh_status study_inputs_note(gh_study *s, const study_problem *p) {
  const char **file = NULL;
  int n = 0;
  if (s->inputs) return GH_OK;
  if (p->scene) GH_TRY(gh_scene_files(p->scene, &file, &n));
  gh_status status = gh_alloc(s->ctx, (size_t)n + 3, sizeof *s->inputs, &s->inputs);
  for (int k = 0; k < n && status == GH_OK; k++) status = input_add(s, file[k]);
  if (status == GH_OK) status = input_add(s, s->path);
  if (status == GH_OK) status = input_add(s, s->reference_file);
  if (status == GH_OK) status = input_add(s, p->path.file);
  free(file);
  return status;
}

void study_inputs_free(gh_study *s) {
  for (int k = 0; k < s->ninputs; k++) free(s->inputs[k]);
  free(s->inputs);
}

/* A picture is no input, and where it cannot be written the tables are there all the same. */
gh_status study_inputs_kept(const gh_study *s, const char *folder) {
  static const char *const tables[] = {"study.csv", "curves.csv", "study.md", NULL};
  GH_TRY(gh_outputs_within(s->ctx, folder, tables, (const char *const *)s->inputs, s->ninputs));
  for (int k = 0; k < s->nconfigs; k++)
    for (int m = 0; m < s->configs[k].nruns; m++)
      GH_TRY(gh_outputs_within(s->ctx, folder, tables, &s->configs[k].runs[m].packing, 1));
  return GH_OK;
}
