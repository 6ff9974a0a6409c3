/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Packings: LAMMPS data files, their replicas and hull. What is read is the same again when it is written and
 * read. */
#include "fuzz.h"
#include "granhom/packing.h"

#include <unistd.h>

static void packing_use(gh_context *ctx, const gh_packing *p) {
  gh_cluster *cluster = NULL;
  gh_hull hull;
  fuzz_require(p->n > 0 && gh_finite(p->x, 2 * (size_t)p->n) && gh_finite(p->radius, (size_t)p->n) &&
                   gh_finite(p->cell, 4) && gh_finite(p->low, 2),
               "a packing with numbers that are not finite");
  if (fuzz_good(ctx, gh_cluster_create(ctx, p, &cluster)))
    fuzz_require(gh_finite(cluster->x, 2 * (size_t)cluster->n), "replicas at places that are not finite");
  gh_cluster_destroy(&cluster);
  fuzz_good(ctx, gh_hull_find(ctx, p, &hull));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("packings", "data", data, size);
  gh_context *ctx = fuzz_begin();
  gh_lammps_data *raw = NULL;
  gh_packing *packing = NULL;
  if (fuzz_good(ctx, gh_lammps_data_read(ctx, file, &raw)))
    fuzz_require(raw->natoms >= 0 && gh_finite(raw->x, 3 * (size_t)raw->natoms) && gh_finite(raw->low, 3) &&
                     gh_finite(raw->high, 3),
                 "a data file with numbers that are not finite");
  gh_lammps_data_destroy(&raw);
  if (fuzz_good(ctx, gh_packing_read(ctx, file, &packing))) packing_use(ctx, packing);
  gh_packing_destroy(&packing);
  fuzz_end(ctx);
  return 0;
}
