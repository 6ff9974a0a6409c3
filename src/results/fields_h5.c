/* SPDX-License-Identifier: GPL-2.0-or-later */
/* results.h5: the mesh, and one group with all fields per increment. */
#include "results/results.h"

#include <stdlib.h>
#include <string.h>

static gh_status sets_put(const gh_solver_results *s, gh_h5 *file) {
  for (int k = 0; k < s->nsets; k++) {
    const gh_mesh_set *set = s->mesh->sets + k;
    char name[GH_COLUMN + 16], part[GH_COLUMN];
    snprintf(name, sizeof name, "/mesh/sets/%s", gh_dataset_name(set->name, part));
    GH_TRY(gh_h5_put_ints(file, name, (size_t)set->nnodes, 1, set->nodes));
  }
  return GH_OK;
}

/* points.xdmf makes a vertex of each integration point by its number. */
static gh_status numbers_put(gh_results *r, gh_h5 *file) {
  const size_t n = (size_t)r->points;
  int *number;
  GH_TRY(gh_alloc(r->ctx, n, sizeof *number, &number));
  for (size_t p = 0; p < n; p++) number[p] = (int)p;
  gh_status status = gh_h5_put_ints(file, "/mesh/points", n, 1, number);
  free(number);
  return status;
}

static gh_status mesh_put(gh_results *r, gh_h5 *file) {
  const gh_solver_results *s = r->solver;
  const gh_mesh *m = s->mesh;
  const size_t nnodes = (size_t)m->nnodes, npoints = (size_t)r->points;
  double *x;
  GH_TRY(gh_alloc(r->ctx, 3 * nnodes + 2 * npoints, sizeof *x, &x));
  for (size_t n = 0; n < nnodes; n++) memcpy(x + 3 * n, m->X + 2 * n, 2 * sizeof *x);
  gh_mesh_gauss(m, x + 3 * nnodes);
  gh_status status;
  GH_TRY_OR(gh_h5_put_doubles(file, "/mesh/coordinates", nnodes, 3, x), done);
  GH_TRY_OR(gh_h5_put_doubles(file, "/mesh/gauss", npoints, 2, x + 3 * nnodes), done);
  GH_TRY_OR(gh_h5_put_ints(file, "/mesh/packing", npoints, 1, s->packing_of), done);
  GH_TRY_OR(gh_h5_put_ints(file, "/mesh/cells", (size_t)m->nelements, 4, &m->quad[0][0]), done);
  GH_TRY_OR(numbers_put(r, file), done);
  GH_TRY_OR(sets_put(s, file), done);
  GH_TRY_OR(gh_h5_put_text(file, "/title", s->title), done);
  GH_TRY_OR(gh_h5_put_text(file, "/units/length", s->length_unit), done);
  GH_TRY_OR(gh_h5_put_text(file, "/units/force", s->force_unit), done);
done:
  free(x);
  return status;
}

static gh_status field_put(gh_results *r, gh_h5 *file, const gh_frame *f, const gh_field *field) {
  char name[128];
  snprintf(name, sizeof name, "/step%04d/%s", f->counter, field->name);
  GH_TRY(field->fill(r->solver->data, field, r->value));
  return gh_h5_put_doubles(file, name, results_field_rows(r, field), (size_t)field->components, r->value);
}

gh_status results_write_fields(gh_results *r, const gh_frame *f) {
  char *path, time[32];
  gh_h5 *file = NULL;
  GH_TRY(results_path(r, "results.h5", &path));
  gh_status status = gh_h5_open(r->ctx, path, gh_results_kind("results.h5"), r->frames > 0, &file);
  free(path);
  if (status != GH_OK) return status;
  if (r->frames == 0) GH_TRY_OR(mesh_put(r, file), failed);
  snprintf(time, sizeof time, "/step%04d/time", f->counter);
  GH_TRY_OR(gh_h5_put_doubles(file, time, 1, 1, &f->time), failed);
  for (int k = 0; k < r->solver->nfields; k++)
    GH_TRY_OR(field_put(r, file, f, r->solver->fields + k), failed);
  return gh_h5_commit(&file);
failed:
  gh_h5_close(&file);
  return status;
}
