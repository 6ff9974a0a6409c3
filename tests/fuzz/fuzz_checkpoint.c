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
  /* what a restart computes from changed numbers may fail, with a message */
  fuzz_require(status == GH_OK || *gh_message(ctx), "a failure without a message");
  fuzz_require(status != GH_MEMORY && status != GH_INTERNAL, gh_message(ctx));
  fuzz_require(chdir("..") == 0, "no folder above");
  gh_scene_destroy(&scene);
  fuzz_end(ctx);
  return 0;
}
