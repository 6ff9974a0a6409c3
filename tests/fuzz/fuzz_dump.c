/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dumps that a restart finds: where their whole frames end. */
#include "fuzz.h"
#include "results/dumps.c" /* the reader is not visible outside it */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("packings", "dump", data, size);
  gh_context *ctx = fuzz_begin();
  for (int counter = 0; counter < 4; counter++) {
    off_t end = -1;
    fuzz_require(end_find(ctx, file, counter, &end) == GH_OK, gh_message(ctx));
    fuzz_require(end >= 0 && end <= (off_t)size, "an end outside the file");
  }
  fuzz_end(ctx);
  return 0;
}
