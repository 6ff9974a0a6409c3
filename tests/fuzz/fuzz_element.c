/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Control files of element tests. */
#include "../../driver/element_spec.h"
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("packings", "yaml", data, size);
  gh_context *ctx = fuzz_begin();
  element_spec spec = {0};
  if (fuzz_good(ctx, element_spec_read(ctx, file, &spec))) {
    long sum = 0;
    for (int k = 0; k < spec.nsteps; k++) {
      const element_step *step = spec.steps + k;
      fuzz_require(step->increments >= 1 && gh_finite(step->value, 4),
                   "a step without increments or with a target that is not finite");
      sum += step->increments;
    }
    fuzz_require(sum == spec.increments, "another number of increments than the steps have");
  }
  element_spec_free(&spec);
  fuzz_end(ctx);
  return 0;
}
