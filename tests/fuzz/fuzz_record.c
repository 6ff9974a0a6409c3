/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Records of runs that a study has in its folder; the checksum is that of the changed text. */
#include "fuzz.h"
#include "study/parts.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  gh_context *ctx = fuzz_begin();
  gh_study *study = NULL;
  const char *folder = getenv("FUZZ_DATA");
  fuzz_require(folder && chdir(folder) == 0, "FUZZ_DATA is not the folder that tests/fuzz/run.py prepares");
  fuzz_require(gh_study_read(ctx, "studies/small.yaml", false, &study) == GH_OK, gh_message(ctx));
  study_run run = study->configs[0].runs[0];
  run.curve = (study_curve){0};
  char *text = fuzz_text(data, size), *check = strstr(text, "  \"check\": \""), *whole = NULL;
  if (check) *check = 0;
  size_t length = strlen(text);
  whole = malloc(length + 64);
  fuzz_require(whole != NULL, "no memory");
  snprintf(whole, length + 64, "%s  \"check\": \"%016" PRIx64 "\"\n}\n", text,
           gh_sum_bytes(GH_SUM_BEGIN, text, length));
  if (fuzz_good(ctx, study_record_parse(study, whole, &run))) {
    fuzz_require(gh_finite(run.curve.t, (size_t)run.curve.n), "a curve over a parameter that is not finite");
    fuzz_require(strlen(run.message) < sizeof run.message, "a message without an end");
  }
  study_curve_free(&run.curve);
  free(whole);
  free(text);
  gh_study_destroy(&study);
  fuzz_end(ctx);
  return 0;
}
