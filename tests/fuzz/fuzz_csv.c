/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tables: any CSV, paths of deformation gradients, tables of conditions of an element test. */
#include "../../driver/element_spec.h"
#include "../../driver/path.h"
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("packings", "csv", data, size);
  gh_context *ctx = fuzz_begin();
  gh_csv *csv = NULL;
  path_rows path = {0};
  element_spec spec = {0};
  if (fuzz_good(ctx, gh_csv_read(ctx, file, &csv)))
    fuzz_require(gh_finite(csv->value, (size_t)csv->nrows * (size_t)csv->ncols),
                 "a table with numbers that are not finite");
  gh_csv_destroy(&csv);
  if (fuzz_good(ctx, path_read(ctx, file, &path)))
    for (int k = 0; k < path.csv->nrows; k++) {
      double F[4];
      path_F(&path, k, F);
      fuzz_require(gh_det2(F) > 0 && path_step(&path, k) < 2000000000000000L, "a path that leads nowhere");
    }
  gh_csv_destroy(&path.csv);
  fuzz_good(ctx, element_spec_read_path(ctx, file, &spec));
  element_spec_free(&spec);
  fuzz_end(ctx);
  return 0;
}
