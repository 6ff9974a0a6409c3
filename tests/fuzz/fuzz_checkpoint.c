/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Restarts: checkpoint.h5 of a run, changed as in fuzz_state.c, and the files that a restart cuts to its
 * increment. */
#include "fuzz.h"
#include "granhom/scene.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

static const char *const names[] = {"/made/engine",
                                    "/made/estimate",
                                    "/made/format",
                                    "/made/mesh",
                                    "/made/packings",
                                    "/made/scene",
                                    "/run/position",
                                    "/run/frames",
                                    "/run/summary",
                                    "/run/begin0000",
                                    "/run/begin0001",
                                    "/run/begin0002",
                                    "/text/history.csv",
                                    "/text/started",
                                    "/farm/data",
                                    "/farm/state",
                                    "/farm/measure",
                                    "/farm/start",
                                    "/macro",
                                    "/whole/apart",
                                    "/whole/farm",
                                    "/whole/macro",
                                    "/farm",
                                    "/text/timing.csv",
                                    "/text/convergence.csv",
                                    "/check",
                                    "/run",
                                    "/text",
                                    "/farm/cost",
                                    "/farm/of",
                                    "/made/law",
                                    "/text/dump",
                                    NULL};

/* The first byte: which other file is cut, and where (second and third). */
static void file_cut(const uint8_t *data) {
  static const char *const files[] = {"results.h5", "history.csv", "timing.csv",
                                      "rves.h5",    "traces.h5",   "run.json"};
  if (data[0] < 128) return;
  if (truncate(files[data[0] % 6], data[1] + 256L * data[2]) != 0) return;
}

/* Where the content's own sum is all that is wrong, it is put right: the message states what it must be. */
static bool sum_mend(gh_context *ctx) {
  static const char words[] = "its content gives ";
  const char *at = strstr(gh_message(ctx), words);
  char sum[32], kind[40];
  gh_h5 *file;
  if (!at) return false;
  snprintf(sum, sizeof sum, "%.16s", at + strlen(words));
  fuzz_kind("checkpoint.h5", kind);
  fuzz_require(gh_h5_open(ctx, "checkpoint.h5", kind, true, &file) == GH_OK, gh_message(ctx));
  fuzz_require(gh_h5_put_text(file, "/check", sum) == GH_OK, gh_message(ctx));
  fuzz_require(gh_h5_commit(&file) == GH_OK, gh_message(ctx));
  return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size < 3) return 0;
  gh_context *ctx = fuzz_begin();
  const char *folder = fuzz_folder("run");
  gh_scene *scene = NULL;
  gh_run_options options = {.restart = true};
  fuzz_require(gh_scene_read(ctx, "packings/s.yaml", &scene) == GH_OK, gh_message(ctx));
  fuzz_require(chdir(folder) == 0, "no folder");
  file_cut(data);
  fuzz_change_h5(ctx, "checkpoint.h5", names, data + 3, size - 3);
  gh_status status = gh_scene_run(scene, ".", &options, NULL);
  if (status == GH_INPUT && sum_mend(ctx)) status = gh_scene_run(scene, ".", &options, NULL);
  /* what a restart computes from changed numbers may fail, with a message */
  fuzz_require(status == GH_OK || *gh_message(ctx), "a failure without a message");
  fuzz_require(status != GH_MEMORY && status != GH_INTERNAL, gh_message(ctx));
  fuzz_require(chdir("..") == 0, "no folder above");
  gh_scene_destroy(&scene);
  fuzz_end(ctx);
  return 0;
}
