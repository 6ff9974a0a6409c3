/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Files that a command writes: nothing that was there is lost by mistake. */
#include "cli.h"

#include "granhom/results.h"
#include "study/study.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool is_there(const char *folder, const char *name) {
  char *path = gh_path_join(folder, name);
  const bool there = path && access(path, F_OK) == 0;
  free(path);
  return there;
}

static bool is_among(const char *name, const char *const *list) {
  while (*list && strcmp(*list, name) != 0) list++;
  return *list != NULL;
}

/* A name of a run's results, or of a study's, beside the file that each of them has. */
static gh_status check_result(gh_context *ctx, const char *path) {
  char *real = realpath(path, NULL), *folder = gh_path_folder(real ? real : path);
  const char *whole = real ? real : path, *slash = strrchr(whole, '/'), *name = slash ? slash + 1 : whole;
  gh_status status = folder ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (folder && ((is_among(name, gh_results_files()) && is_there(folder, "run.json")) ||
                 (is_among(name, gh_study_files()) && is_there(folder, "study.csv"))))
    status =
        gh_fail(ctx, GH_INPUT, "%s: has the name of a file of the results in %s, and would be taken for it",
                path, folder);
  free(folder);
  free(real);
  return status;
}

gh_status cli_check_outputs(gh_context *ctx, const gh_output *output, int outputs, const char *const *input,
                            int inputs) {
  GH_TRY(gh_outputs_check(ctx, output, outputs, input, inputs));
  for (int k = 0; k < outputs; k++)
    if (output[k].path && strcmp(output[k].path, "-") != 0) GH_TRY(check_result(ctx, output[k].path));
  return GH_OK;
}

gh_status cli_check_outputs_of(gh_context *ctx, const gh_output *output, int outputs, const char *folder,
                               const option_more *others) {
  enum { FILES = 16 }; /* of a folder */
  char **input;
  int inputs = 0;
  GH_TRY(gh_alloc(ctx, (size_t)(others->n + 1) * FILES, sizeof *input, &input));
  for (int k = -1; k < others->n; k++) {
    const char *const *name = gh_results_files();
    for (int n = 0; n < FILES && name[n]; n++)
      input[inputs++] = gh_path_join(k < 0 ? folder : others->word[k], name[n]);
  }
  gh_status status = cli_check_outputs(ctx, output, outputs, (const char *const *)input, inputs);
  for (int k = 0; k < inputs; k++) free(input[k]);
  free(input);
  return status;
}
