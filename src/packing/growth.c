/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Growth in two or three dimensions. */
#include "packing/grow.h"

gh_status gh_packing_grow(gh_context *ctx, int dim, int n, const double *diameter, const int *type,
                          const gh_grow_options *options, gh_grains **grains, gh_grow_result *result) {
  if (dim == 2) return gh_packing_grow2(ctx, n, diameter, type, options, grains, result);
  if (dim == 3) return gh_packing_grow3(ctx, n, diameter, type, options, grains, result);
  *grains = NULL;
  return gh_fail(ctx, GH_INPUT, "packing: %d dimensions; 2 or 3 are possible", dim);
}
