/* results.h5: the mesh, and one group per increment. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/results.h"

#include <stdlib.h>
#include <string.h>

static gh_status put(scene_results *r, gh_h5 *file, const scene_frame *f, const char *name, size_t rows,
                     size_t cols, const double *data) {
  char full[128];
  (void)r;
  snprintf(full, sizeof full, "/step%04d/%s", f->counter, name);
  return gh_h5_put_doubles(file, full, rows, cols, data);
}

static gh_status put_mesh(scene_results *r, gh_h5 *file) {
  const gh_mesh *m = r->scene->mesh;
  size_t nnodes = (size_t)m->nnodes, npoints = 4 * (size_t)m->nelements;
  double *x;
  GH_TRY(gh_alloc(r->ctx, 3 * nnodes + 2 * npoints, sizeof *x, &x));
  for (size_t n = 0; n < nnodes; n++) memcpy(x + 3 * n, m->X + 2 * n, 2 * sizeof *x);
  gh_mesh_gauss(m, x + 3 * nnodes);
  gh_status status;
  GH_TRY_OR(gh_h5_put_doubles(file, "/mesh/coordinates", nnodes, 3, x), done);
  GH_TRY_OR(gh_h5_put_doubles(file, "/mesh/gauss", npoints, 2, x + 3 * nnodes), done);
  GH_TRY_OR(gh_h5_put_ints(file, "/mesh/packing", npoints, 1, r->scene->packing_of), done);
  GH_TRY_OR(gh_h5_put_ints(file, "/mesh/cells", (size_t)m->nelements, 4, &m->quad[0][0]), done);
  int *number; /* of the points, one by one: points.xdmf makes a vertex of each */
  GH_TRY_OR(gh_alloc(r->ctx, npoints, sizeof *number, &number), done);
  for (size_t p = 0; p < npoints; p++) number[p] = (int)p;
  status = gh_h5_put_ints(file, "/mesh/points", npoints, 1, number);
  free(number);
  if (status != GH_OK) goto done;
  for (int k = 0; k < r->scene->nsets; k++) {
    char name[SCENE_COLUMN + 16], part[SCENE_COLUMN];
    snprintf(name, sizeof name, "/mesh/sets/%s", scene_dataset(m->sets[k].name, part));
    GH_TRY_OR(gh_h5_put_ints(file, name, (size_t)m->sets[k].nnodes, 1, m->sets[k].nodes), done);
  }
  GH_TRY_OR(gh_h5_put_text(file, "/title", r->scene->title), done);
  GH_TRY_OR(gh_h5_put_text(file, "/units/length", r->scene->length_unit), done);
  GH_TRY_OR(gh_h5_put_text(file, "/units/force", r->scene->force_unit), done);
done:
  free(x);
  return status;
}

/* Vectors of the plane, nnodes x 2, as the three components that ParaView wants. */
static gh_status put_nodes(scene_results *r, gh_h5 *file, const scene_frame *f, const char *name,
                           const double *values) {
  size_t nnodes = (size_t)r->scene->mesh->nnodes;
  double *three;
  GH_TRY(gh_alloc(r->ctx, 3 * nnodes, sizeof *three, &three));
  for (size_t n = 0; n < nnodes; n++) memcpy(three + 3 * n, values + 2 * n, 2 * sizeof *three);
  gh_status status = put(r, file, f, name, nnodes, 3, three);
  free(three);
  return status;
}

/* Cell averages of a tensor of the plane as 3 x 3. */
static gh_status put_cell_tensor(scene_results *r, gh_h5 *file, const scene_frame *f, const char *name,
                                 const double *points) {
  size_t n = (size_t)r->scene->mesh->nelements;
  double *average;
  GH_TRY(gh_alloc(r->ctx, (4 + 9) * n, sizeof *average, &average));
  double *full = average + 4 * n;
  gh_mesh_cell_average((int)n, 4, points, average);
  for (size_t e = 0; e < n; e++) {
    static const int at[4] = {0, 1, 3, 4};
    for (int k = 0; k < 4; k++) full[9 * e + (size_t)at[k]] = average[4 * e + (size_t)k];
  }
  gh_status status = put(r, file, f, name, n, 9, full);
  free(average);
  return status;
}

static gh_status put_stress(scene_results *r, gh_h5 *file, const scene_frame *f) {
  const gh_mesh *m = r->scene->mesh;
  size_t np = 4 * (size_t)m->nelements, nn = (size_t)m->nnodes;
  const double *F = gh_macro_F(r->macro), *P = gh_macro_P(r->macro);
  double *cauchy = r->tensor, *mises;
  for (size_t p = 0; p < np; p++) gh_cauchy2(P + 4 * p, F + 4 * p, cauchy + 4 * p);
  GH_TRY(put(r, file, f, "points/F", np, 4, F));
  GH_TRY(put(r, file, f, "points/P", np, 4, P));
  GH_TRY(put(r, file, f, "points/cauchy", np, 4, cauchy));
  GH_TRY(put_cell_tensor(r, file, f, "cells/F", F));
  GH_TRY(put_cell_tensor(r, file, f, "cells/piola", P));
  GH_TRY(put_cell_tensor(r, file, f, "cells/cauchy", cauchy));
  GH_TRY(gh_alloc(r->ctx, np + nn, sizeof *mises, &mises));
  gh_status status = gh_mesh_nodal_mises(r->ctx, m, cauchy, mises + np);
  if (status == GH_OK) status = put(r, file, f, "von_mises", nn, 1, mises + np);
  for (size_t e = 0; e < np / 4; e++) { /* of the average stress */
    double s[4];
    gh_mesh_cell_average(1, 4, cauchy + 16 * e, s);
    mises[e] = gh_mises2(s);
  }
  if (status == GH_OK) status = put(r, file, f, "cells/von_mises", np / 4, 1, mises);
  free(mises);
  return status;
}

/* Each number of the points, and its mean over each element. */
static gh_status put_numbers(scene_results *r, gh_h5 *file, const scene_frame *f) {
  int np = gh_farm_size(r->farm);
  char name[64];
  for (size_t k = 0; k < scene_number_count; k++) {
    for (int p = 0; p < np; p++) {
      const gh_rve_measures *m = gh_farm_measure(r->farm, p);
      if (!m) return GH_OK; /* points that are no RVEs have no measures */
      r->scalar[p] = scene_numbers[k].of(m);
    }
    snprintf(name, sizeof name, "points/%s", scene_numbers[k].name);
    GH_TRY(put(r, file, f, name, (size_t)np, 1, r->scalar));
    if (!scene_numbers[k].mean) continue;
    gh_mesh_cell_average(np / 4, 1, r->scalar, r->tensor);
    snprintf(name, sizeof name, "cells/%s", scene_numbers[k].name);
    GH_TRY(put(r, file, f, name, (size_t)np / 4, 1, r->tensor));
  }
  return GH_OK;
}

/* The point of an element with the smallest acoustic eigenvalue. */
static size_t least_stable(const double *acoustic, size_t e) {
  size_t least = 4 * e;
  for (size_t p = 4 * e + 1; p < 4 * e + 4; p++)
    if (acoustic[p] < acoustic[least]) least = p;
  return least;
}

/* Acoustic tensors: smallest eigenvalue and its direction, of each point and the smallest of each element. */
static gh_status put_acoustic(scene_results *r, gh_h5 *file, const scene_frame *f) {
  size_t np = (size_t)gh_farm_size(r->farm), ne = np / 4;
  const double *A = gh_macro_A(r->macro);
  double *angle = r->tensor, *cells = r->tensor + np, *normal;
  for (size_t p = 0; p < np; p++) r->scalar[p] = gh_acoustic(A + 16 * p, angle + p);
  GH_TRY(put(r, file, f, "points/acoustic", np, 1, r->scalar));
  GH_TRY(put(r, file, f, "points/acoustic_angle", np, 1, angle));
  GH_TRY(gh_alloc(r->ctx, 3 * ne, sizeof *normal, &normal));
  for (size_t e = 0; e < ne; e++) {
    size_t p = least_stable(r->scalar, e);
    cells[e] = r->scalar[p];
    normal[3 * e] = cos(angle[p]), normal[3 * e + 1] = sin(angle[p]);
  }
  gh_status status = put(r, file, f, "cells/acoustic", ne, 1, cells);
  if (status == GH_OK) status = put(r, file, f, "cells/acoustic_normal", ne, 3, normal);
  free(normal);
  return status;
}

gh_status scene_write_h5(scene_results *r, const scene_frame *f) {
  char *path;
  gh_h5 *file = NULL;
  GH_TRY(scene_result_path(r, "results.h5", &path));
  gh_status status = gh_h5_open(r->ctx, path, scene_h5_kind("results.h5"), r->frames > 0, &file);
  free(path);
  if (status != GH_OK) return status;
  if (r->frames == 0) GH_TRY_OR(put_mesh(r, file), failed);
  GH_TRY_OR(put(r, file, f, "time", 1, 1, &f->time), failed);
  GH_TRY_OR(put_nodes(r, file, f, "displacement", gh_macro_u(r->macro)), failed);
  GH_TRY_OR(put_nodes(r, file, f, "reaction", gh_macro_reactions(r->macro)), failed);
  GH_TRY_OR(put_stress(r, file, f), failed);
  GH_TRY_OR(put_numbers(r, file, f), failed);
  GH_TRY_OR(put_acoustic(r, file, f), failed);
  return gh_h5_commit(&file);
failed:
  gh_h5_close(&file);
  return status;
}
