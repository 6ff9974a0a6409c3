/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a direct simulation hands to the writers of results. */
#include "io/json.h"
#include "scene/direct.h"
#include "scene/history.h"

#include <stdlib.h>
#include <string.h>

/* ---- history.csv ---- */

/* Of scene_history_tail: the others have no meaning without integration points. */
enum { TAIL = 10 };
static const char *const tail_names[TAIL] = {"dilatancy",    "substeps",   "cuts",   "residual",
                                             "micro_steps",  "outer_work", "energy", "dissipation",
                                             "coordination", "anisotropy"};

static void body_reaction(const void *data, int set, double sum[2]) {
  gh_direct_reaction(((const scene_direct *)data)->body, set, sum);
}

static void columns_walk(scene_walk *w, const scene_direct *r) {
  double value[TAIL] = {0};
  scene_walk_loads(w);
  scene_walk_reactions(w, body_reaction, r);
  if (w->value) {
    const gh_direct_measures *m = gh_direct_measure(r->body);
    const double now[TAIL] = {100 * (m->current / m->volume - 1),
                              r->report.substeps,
                              r->report.cuts,
                              m->residual,
                              (double)r->report.steps,
                              m->outer_work,
                              m->energy,
                              m->dissipation,
                              m->coordination,
                              m->anisotropy};
    memcpy(value, now, sizeof value);
  }
  for (int k = 0; k < TAIL; k++) scene_walk_column(w, tail_names[k], false, value[k]);
}

static gh_status columns_create(scene_direct *r) {
  scene_walk w = {.scene = r->scene};
  columns_walk(&w, r);
  r->solver.ncolumns = w.n;
  GH_TRY(gh_alloc(r->ctx, (size_t)w.n, sizeof *r->columns, &r->columns));
  w.n = 0, w.column = r->columns;
  columns_walk(&w, r);
  return GH_OK;
}

static gh_status row_fill(void *data, const gh_frame *frame, double *value) {
  (void)frame;
  const scene_direct *r = data;
  scene_walk w = {.scene = r->scene, .value = value, .present = true};
  columns_walk(&w, r);
  return GH_OK;
}

/* ---- fields ---- */

static gh_status displacement_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_direct *r = data;
  const double *u = gh_direct_u(r->body);
  for (int a = 0; a < r->scene->mesh->nnodes; a++)
    value[3 * a] = u[2 * a], value[3 * a + 1] = u[2 * a + 1], value[3 * a + 2] = 0;
  return GH_OK;
}

static void tensor_put(const double plane[4], double *value) {
  const double full[9] = {plane[0], plane[1], 0, plane[2], plane[3]};
  memcpy(value, full, sizeof full);
}

static gh_status gradient_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_direct *r = data;
  gh_shapes shapes;
  gh_status status = gh_shapes_create(r->ctx, r->scene->mesh, &shapes);
  for (int e = 0; e < r->scene->mesh->nelements && status == GH_OK; e++) {
    double F[16], mean[4];
    gh_element_deformation(&shapes, r->scene->mesh, e, gh_direct_u(r->body), F);
    gh_mesh_cell_average(1, 4, F, mean);
    tensor_put(mean, value + 9 * e);
  }
  gh_shapes_destroy(&shapes);
  return status;
}

static gh_status cauchy_fill(void *data, const gh_field *field, double *value) {
  const scene_direct *r = data;
  const double *cauchy = gh_direct_cauchy(r->body);
  for (int e = 0; e < r->scene->mesh->nelements; e++) {
    if (field->components == 9) tensor_put(cauchy + 4 * e, value + 9 * e);
    else value[e] = gh_mises2(cauchy + 4 * e);
  }
  return GH_OK;
}

static gh_status coordination_fill(void *data, const gh_field *field, double *value) {
  (void)field;
  const scene_direct *r = data;
  memcpy(value, gh_direct_coordination(r->body), (size_t)r->scene->mesh->nelements * sizeof *value);
  return GH_OK;
}

static const gh_field fields[] = {
    {"displacement", "displacement", GH_AT_NODES, 3, 0, displacement_fill},
    {"cells/F", "F", GH_AT_CELLS, 9, 0, gradient_fill},
    {"cells/cauchy", "cauchy", GH_AT_CELLS, 9, 0, cauchy_fill},
    {"cells/von_mises", "von_mises_cell", GH_AT_CELLS, 1, 0, cauchy_fill},
    {"cells/coordination", "coordination", GH_AT_CELLS, 1, 0, coordination_fill}};

/* ---- grains ---- */

/* The body stands where integration point 0 would. */
static gh_status body_inspect(void *data, int point, gh_rve_view *view, const gh_rve_measures **m) {
  static const gh_rve_measures none = {.acoustic = NAN};
  const scene_direct *r = data;
  (void)point;
  gh_direct_look(r->body, view);
  *m = &none;
  return GH_OK;
}

/* ---- run.json ---- */

static void summary_add(gh_json root, const scene_direct *r) {
  const gh_direct_summary *m = &r->sum;
  gh_json o = gh_json_group(root, "summary"), time = gh_json_group(o, "seconds");
  gh_json_number(o, "steps", m->steps);
  gh_json_number(o, "increments", m->increments);
  gh_json_number(o, "substeps", m->substeps);
  gh_json_number(o, "cuts", m->cuts);
  gh_json_number(o, "relaxation_steps", (double)m->relaxation_steps);
  gh_json_number(time, "total", m->seconds);
}

static gh_status record(void *data, const gh_outcome *outcome, gh_text *out) {
  const scene_direct *r = data;
  bool failed = false;
  gh_json root = {.at = cJSON_CreateObject(), .failed = &failed};
  scene_record_begin(root, r->scene, outcome);
  gh_json o = gh_json_group(gh_json_group(root, "options"), "direct");
  gh_json_number(o, "grains", r->sum.grains);
  gh_json_number(o, "asked", r->options->grains);
  gh_json_truth(o, "tile", r->options->tile);
  if (!r->options->tile) gh_json_number(o, "seed", r->options->seed);
  gh_json_text(o, "integration", gh_integration_name(r->scene->micro.integration));
  gh_json_text(o, "engine", r->scene->micro.engine == GH_ENGINE_NATIVE ? "native" : "lammps");
  gh_json_number(o, "tolerance", r->scene->micro.tolerance);
  if (outcome->ended) summary_add(root, r);
  return scene_record_end(root, r->scene, out);
}

/* ---- all of it ---- */

gh_status scene_direct_output(scene_direct *r) {
  static const int body = 0;
  const gh_scene *s = r->scene;
  GH_TRY(columns_create(r));
  r->solver.data = r;
  r->solver.title = s->title, r->solver.length_unit = s->length_unit, r->solver.force_unit = s->force_unit;
  r->solver.mesh = s->mesh, r->solver.nsets = s->nsets, r->solver.packing_of = s->packing_of;
  r->solver.fields = fields, r->solver.nfields = sizeof fields / sizeof *fields;
  r->solver.columns = r->columns;
  r->solver.recorded = (gh_point_list){0, NULL};
  r->solver.dumped = (gh_point_list){1, &body};
  r->solver.dump_every = s->dump_every > 0 ? s->dump_every : 1;
  r->solver.row = row_fill, r->solver.inspect = body_inspect, r->solver.record = record;
  r->solver.marks = scene_direct_marks, r->solver.save = scene_direct_save;
  r->solver.load = scene_direct_load, r->solver.resume = scene_direct_resume;
  return gh_results_create(r->ctx, &r->solver, r->folder, &r->results);
}
