/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The fields of a scene in results.h5: what the body and its packings know at nodes, integration points and
 * elements. */
#include "scene/output.h"

#include <stdlib.h>
#include <string.h>

/* ---- nodes ---- */

/* Vectors of the plane as the three components that ParaView needs. */
static void vectors_fill(const scene_output *o, const double *plane, double *value) {
  const int nnodes = o->scene->mesh->nnodes;
  for (int n = 0; n < nnodes; n++) {
    memcpy(value + 3 * n, plane + 2 * n, 2 * sizeof *value);
    value[3 * n + 2] = 0;
  }
}

static gh_status displacement_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_output *o = data;
  vectors_fill(o, gh_macro_u(o->macro), value);
  return GH_OK;
}

static gh_status reaction_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_output *o = data;
  vectors_fill(o, gh_macro_reactions(o->macro), value);
  return GH_OK;
}

static gh_status mises_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_output *o = data;
  return gh_mesh_nodal_mises(o->ctx, o->scene->mesh, o->cauchy, value);
}

/* ---- tensors of the plane ---- */

typedef enum tensor { TENSOR_F, TENSOR_P, TENSOR_CAUCHY } tensor;

static const double *tensor_of(const scene_output *o, int which) {
  return which == TENSOR_F ? gh_macro_F(o->macro) : which == TENSOR_P ? gh_macro_P(o->macro) : o->cauchy;
}

static gh_status tensor_fill(void *data, const gh_field *field, double *value) {
  const scene_output *o = data;
  memcpy(value, tensor_of(o, field->index), 4 * (size_t)gh_farm_size(o->farm) * sizeof *value);
  return GH_OK;
}

/* Means over the elements, as 3 x 3. */
static gh_status cell_tensor_fill(void *data, const gh_field *field, double *value) {
  static const int at[4] = {0, 1, 3, 4};
  const scene_output *o = data;
  const double *points = tensor_of(o, field->index);
  for (int e = 0; e < o->scene->mesh->nelements; e++) {
    double mean[4];
    gh_mesh_cell_average(1, 4, points + 16 * e, mean);
    memset(value + 9 * e, 0, 9 * sizeof *value);
    for (int k = 0; k < 4; k++) value[9 * e + at[k]] = mean[k];
  }
  return GH_OK;
}

/* Of the mean stress of each element. */
static gh_status cell_mises_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_output *o = data;
  for (int e = 0; e < o->scene->mesh->nelements; e++) {
    double mean[4];
    gh_mesh_cell_average(1, 4, o->cauchy + 16 * e, mean);
    value[e] = gh_mises2(mean);
  }
  return GH_OK;
}

/* ---- acoustic tensors: smallest eigenvalue and its direction ---- */

static gh_status acoustic_fill(void *data, const gh_field *field, double *value) {
  const scene_output *o = data;
  memcpy(value, field->index ? o->angle : o->acoustic, (size_t)gh_farm_size(o->farm) * sizeof *value);
  return GH_OK;
}

/* The point of an element with the smallest eigenvalue. */
static int cell_least_stable(const double *acoustic, int e) {
  int least = 4 * e;
  for (int p = 4 * e + 1; p < 4 * e + 4; p++)
    if (acoustic[p] < acoustic[least]) least = p;
  return least;
}

static gh_status cell_acoustic_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_output *o = data;
  for (int e = 0; e < o->scene->mesh->nelements; e++)
    value[e] = o->acoustic[cell_least_stable(o->acoustic, e)];
  return GH_OK;
}

static gh_status cell_normal_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_output *o = data;
  for (int e = 0; e < o->scene->mesh->nelements; e++) {
    const double angle = o->angle[cell_least_stable(o->acoustic, e)];
    value[3 * e] = cos(angle), value[3 * e + 1] = sin(angle), value[3 * e + 2] = 0;
  }
  return GH_OK;
}

/* ---- numbers of the packings ---- */

/* NAN where a point is no packing. */
static double number_at(const scene_output *o, int point, int index) {
  const gh_rve_measures *m = gh_farm_measure(o->farm, point);
  return m ? scene_numbers[index].of(m) : NAN;
}

static gh_status number_fill(void *data, const gh_field *field, double *value) {
  const scene_output *o = data;
  for (int p = 0; p < gh_farm_size(o->farm); p++) value[p] = number_at(o, p, field->index);
  return GH_OK;
}

static gh_status cell_number_fill(void *data, const gh_field *field, double *value) {
  const scene_output *o = data;
  for (int e = 0; e < o->scene->mesh->nelements; e++) {
    double four[4];
    for (int g = 0; g < 4; g++) four[g] = number_at(o, 4 * e + g, field->index);
    gh_mesh_cell_average(1, 1, four, value + e);
  }
  return GH_OK;
}

/* ---- the table ---- */

static const gh_field fixed[] = {
    {"displacement", "displacement", GH_AT_NODES, 3, 0, displacement_fill},
    {"reaction", "reaction", GH_AT_NODES, 3, 0, reaction_fill},
    {"von_mises", "von_mises", GH_AT_NODES, 1, 0, mises_fill},
    {"cells/F", "F", GH_AT_CELLS, 9, TENSOR_F, cell_tensor_fill},
    {"cells/piola", "piola", GH_AT_CELLS, 9, TENSOR_P, cell_tensor_fill},
    {"cells/cauchy", "cauchy", GH_AT_CELLS, 9, TENSOR_CAUCHY, cell_tensor_fill},
    {"cells/von_mises", "von_mises_cell", GH_AT_CELLS, 1, 0, cell_mises_fill},
    {"cells/acoustic", "acoustic", GH_AT_CELLS, 1, 0, cell_acoustic_fill},
    {"cells/acoustic_normal", "acoustic_normal", GH_AT_CELLS, 3, 0, cell_normal_fill},
    {"points/F", "F", GH_AT_POINTS, 4, TENSOR_F, tensor_fill},
    {"points/P", "piola", GH_AT_POINTS, 4, TENSOR_P, tensor_fill},
    {"points/cauchy", "cauchy", GH_AT_POINTS, 4, TENSOR_CAUCHY, tensor_fill},
    {"points/acoustic", "acoustic", GH_AT_POINTS, 1, 0, acoustic_fill},
    {"points/acoustic_angle", "acoustic_angle", GH_AT_POINTS, 1, 1, acoustic_fill}};
enum { FIXED = sizeof fixed / sizeof *fixed };

gh_status scene_fields_create(gh_context *ctx, gh_field **fields, int *count) {
  GH_TRY(gh_alloc(ctx, FIXED + 2 * scene_number_count, sizeof **fields, fields));
  gh_field *f = *fields;
  memcpy(f, fixed, sizeof fixed);
  *count = FIXED;
  for (size_t k = 0; k < scene_number_count; k++) {
    const scene_number *n = scene_numbers + k;
    f[(*count)++] = (gh_field){n->point, n->name, GH_AT_POINTS, 1, (int)k, number_fill};
    if (n->mean) f[(*count)++] = (gh_field){n->cell, n->name, GH_AT_CELLS, 1, (int)k, cell_number_fill};
  }
  return GH_OK;
}
