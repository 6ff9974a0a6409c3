/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Studies: reading with all that they name, explaining. */
#include "fuzz.h"
#include "study/study.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("scenes/studies", "yaml", data, size);
  gh_context *ctx = fuzz_begin();
  for (int quick = 0; quick < 2; quick++) {
    gh_study *study = NULL;
    gh_text *out;
    if (fuzz_good(ctx, gh_study_read(ctx, file, quick, &study))) {
      fuzz_require(gh_text_create(ctx, &out) == GH_OK, "no text");
      gh_study_explain(study, out);
      gh_text_destroy(&out);
    }
    gh_study_destroy(&study);
  }
  fuzz_end(ctx);
  return 0;
}
