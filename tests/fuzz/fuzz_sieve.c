/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Sieve curves, and the grains that follow from them. */
#include "fuzz.h"
#include "granhom/packing.h"

#include <stdlib.h>

enum { MOST = 100000 };

static void sieve_use(gh_context *ctx, const gh_sieve *sieve, int dim, int total) {
  double *share, sum = 0;
  int *count, n = 0, *type = NULL;
  double *diameter = NULL;
  fuzz_require(gh_alloc(ctx, (size_t)sieve->n, sizeof *share, &share) == GH_OK &&
                   gh_alloc(ctx, (size_t)sieve->n, sizeof *count, &count) == GH_OK,
               "no memory");
  gh_sieve_shares(sieve, dim, share);
  for (int k = 0; k < sieve->n; k++) sum += share[k];
  fuzz_require(fabs(sum - 1) < 1e-9, "shares whose sum is not one");
  if (fuzz_good(ctx, gh_sieve_counts(ctx, sieve, dim, total, count))) {
    long all = 0;
    for (int k = 0; k < sieve->n; k++) {
      fuzz_require(count[k] >= 0, "a negative number of grains");
      all += count[k];
    }
    fuzz_require(total == 0 || all == total, "another number of grains than asked for");
    if (all <= MOST && fuzz_good(ctx, gh_sieve_grains(ctx, sieve, count, &n, &diameter, &type)))
      fuzz_require(n == all, "another number of grains than counted");
  }
  free(diameter);
  free(type);
  free(share);
  free(count);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("packings", "csv", data, size);
  gh_context *ctx = fuzz_begin();
  gh_sieve *sieve = NULL;
  if (fuzz_good(ctx, gh_sieve_read(ctx, file, &sieve)))
    for (int dim = 2; dim <= 3; dim++) {
      sieve_use(ctx, sieve, dim, 1000);
      sieve_use(ctx, sieve, dim, 0);
    }
  gh_sieve_destroy(&sieve);
  fuzz_end(ctx);
  return 0;
}
