/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Descriptions of packings: `granhom pack SPEC.yaml`. */
#include "../../driver/pack_spec.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("scenes/packings", "yaml", data, size);
  gh_context *ctx = fuzz_begin();
  pack_spec spec;
  pack_spec_init(&spec);
  if (fuzz_good(ctx, pack_spec_read(ctx, file, &spec))) {
    if (!spec.output) spec.output = "out.data";
    if (fuzz_good(ctx, pack_spec_complete(ctx, &spec)))
      fuzz_require(spec.grow.rate > 0 && gh_finite(spec.grow.shape, 9), "a growth rate or cell that is none");
  }
  pack_spec_free(&spec);
  fuzz_end(ctx);
  return 0;
}
