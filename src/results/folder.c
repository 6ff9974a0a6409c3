/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The folder of results and the files in it. */
#include "results/results.h"

const char *const *gh_results_files(void) {
  static const char *const files[] = {"results.h5",      "results.xdmf",  "points.xdmf", "rves.h5",
                                      "traces.h5",       "history.csv",   "timing.csv",  "run.json",
                                      "convergence.csv", "checkpoint.h5", NULL};
  return files;
}

gh_status gh_results_folder_check(gh_context *ctx, const char *folder, const char *const *input, int inputs) {
  GH_TRY(gh_output_folder_check(ctx, folder));
  GH_TRY(gh_outputs_within(ctx, folder, gh_results_files(), input, inputs));
  return gh_output_within(ctx, folder, "dumps", true);
}

gh_status results_path(const gh_results *r, const char *name, char **path) {
  *path = gh_path_join(r->folder, name);
  return *path ? GH_OK : gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
}
