/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A folder of results, as `plot` and `report` read it: run.json, history.csv, convergence.csv, timing.csv as
 * any text, results.h5, rves.h5 and traces.h5 changed as in fuzz_state.c. The first byte of an input states
 * which of them it is. */
#include "fuzz.h"
#include "granhom/report.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

static const char *const texts[] = {"run.json", "history.csv", "convergence.csv", "timing.csv"};
static const char *const files[] = {"results.h5", "rves.h5", "traces.h5"};
static const char *const names[][24] = {{"/mesh/cells",
                                         "/mesh/coordinates",
                                         "/mesh/gauss",
                                         "/mesh/packing",
                                         "/mesh/points",
                                         "/mesh/sets/top",
                                         "/title",
                                         "/units/force",
                                         "/units/length",
                                         "/step0000/displacement",
                                         "/step0003/displacement",
                                         "/step0003/von_mises",
                                         "/step0003/points/cauchy",
                                         "/step0003/points/acoustic",
                                         "/step0003/time",
                                         "/step0001/points/acoustic",
                                         "/step0002",
                                         "/step0003/cells/von_mises",
                                         "/step0003/points/F",
                                         "/step0004/points/acoustic",
                                         "/mesh",
                                         NULL},
                                        {"/rve/0000/cauchy",
                                         "/rve/0000/contact_branch_force",
                                         "/rve/0000/contact_pairs",
                                         "/rve/0000/cell",
                                         "/rve/0000/flags",
                                         "/rve/0000/ids",
                                         "/rve/0000/low",
                                         "/rve/0000/periodic",
                                         "/rve/0000/positions",
                                         "/rve/0000/radii",
                                         "/step",
                                         "/rve/0000/types",
                                         "/rve/0001/positions",
                                         "/rve/0001/radii",
                                         "/rve/0001/contact_pairs",
                                         "/rve/0001",
                                         "/rve",
                                         "/rve/0000/contact_sliding",
                                         "/rve/0000/rotations",
                                         NULL},
                                        {"/trace/0000/step0000", "/trace/0000/step0001",
                                         "/trace/0000/step0002", "/trace/0000/step0003",
                                         "/trace/0001/step0003", "/trace/0000", "/trace", NULL}};

static void text_write(const char *path, const uint8_t *data, size_t size) {
  int fd = open(path, O_WRONLY | O_TRUNC | O_CLOEXEC);
  fuzz_require(fd >= 0 && write(fd, data, size) == (ssize_t)size, "an input cannot be written");
  close(fd);
}

/* The page and pictures, but for those that gnuplot draws. */
static void folder_use(gh_context *ctx) {
  static const int points[] = {0, 1};
  fuzz_good(ctx, gh_report_write(ctx, ".", points, 0, NULL, "report.html"));
  fuzz_good(ctx, gh_report_write(ctx, ".", points, 2, NULL, "report.html"));
  fuzz_good(ctx, gh_picture_mesh(ctx, ".", "mesh.svg"));
  fuzz_good(ctx, gh_picture_rve(ctx, ".", -1, "rve.svg"));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size < 1) return 0;
  gh_context *ctx = fuzz_begin();
  const char *folder = fuzz_folder("run");
  fuzz_require(chdir(folder) == 0, "no folder");
  unsigned k = data[0] % 7;
  if (k < 4) text_write(texts[k], data + 1, size - 1);
  else fuzz_change_h5(ctx, files[k - 4], names[k - 4], data + 1, size - 1);
  folder_use(ctx);
  fuzz_require(chdir("..") == 0, "no folder above");
  fuzz_end(ctx);
  return 0;
}
