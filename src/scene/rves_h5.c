/* rves.h5: grains and contacts of the recorded material points. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/results.h"

#include <stdlib.h>
#include <string.h>

static gh_status put_rve(scene_results *r, gh_h5 *file, int point) {
  gh_rve_view v;
  const gh_rve_measures *measure = gh_farm_measure(r->farm, point);
  if (!measure) return GH_OK;
  GH_TRY(gh_farm_look(r->farm, point, &v));
  size_t n = (size_t)v.n, nc = (size_t)v.ncontacts, most = n > nc ? n : nc;
  char name[64];
  double *row = NULL;
  int *pairs = NULL, periodic = v.periodic;
  gh_status status;
#define PUT(kind, what, rows, cols, data)                                                                    \
  snprintf(name, sizeof name, "/rve/%04d/%s", point, what);                                                  \
  GH_TRY_OR(gh_h5_put_##kind(file, name, rows, cols, data), done)
  GH_TRY_OR(gh_alloc(r->ctx, 4 * most, sizeof *row, &row), done);
  GH_TRY_OR(gh_alloc(r->ctx, 2 * most, sizeof *pairs, &pairs), done);
  PUT(doubles, "positions", n, 2, v.x);
  PUT(doubles, "radii", n, 1, v.radius);
  PUT(ints, "ids", n, 1, v.id);
  PUT(ints, "types", n, 1, v.type);
  for (size_t k = 0; k < n; k++) pairs[k] = v.flags[k];
  PUT(ints, "flags", n, 1, pairs);
  PUT(doubles, "cell", 1, 4, v.cell);
  PUT(doubles, "low", 1, 2, v.low);
  PUT(ints, "periodic", 1, 1, &periodic);
  PUT(doubles, "cauchy", 1, 4, measure->cauchy);
  for (size_t k = 0; k < nc; k++) {
    pairs[2 * k] = v.contacts[k].i, pairs[2 * k + 1] = v.contacts[k].j;
    memcpy(row + 4 * k, v.contacts[k].l, 2 * sizeof *row);
    memcpy(row + 4 * k + 2, v.contacts[k].f, 2 * sizeof *row);
  }
  PUT(ints, "contact_pairs", nc, 2, pairs);
  PUT(doubles, "contact_branch_force", nc, 4, row);
#undef PUT
done:
  free(row);
  free(pairs);
  return status;
}

/* What the scene asks for; without a wish all points if they are few, else the first, the most loaded and the
 * one nearest to losing ellipticity. */
gh_status scene_write_rves(scene_results *r, const scene_frame *f) {
  int points = gh_farm_size(r->farm), wanted = r->scene->nrves,
      chosen[3] = {0, r->most_loaded, r->least_stable};
  const int *list = r->scene->rves;
  bool all = wanted == SCENE_ALL_RVES || (wanted == SCENE_FEW_RVES && points <= SCENE_FEW);
  if (!all && wanted == SCENE_FEW_RVES) list = chosen, wanted = 3;
  if (!all && wanted == 0) return GH_OK;
  char *path;
  gh_h5 *file = NULL;
  GH_TRY(scene_result_path(r, "rves.h5", &path));
  gh_status status = gh_h5_open(r->ctx, path, false, &file);
  free(path);
  if (status != GH_OK) return status;
  GH_TRY_OR(gh_h5_put_ints(file, "/step", 1, 1, &f->counter), failed);
  for (int k = 0; k < (all ? points : wanted); k++) GH_TRY_OR(put_rve(r, file, all ? k : list[k]), failed);
  return gh_h5_commit(&file);
failed:
  gh_h5_close(&file);
  return status;
}
