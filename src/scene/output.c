/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A scene as a solver whose results are written. */
#include "scene/output.h"

#include <stdlib.h>
#include <string.h>

/* ---- what is handed over ---- */

static gh_status point_inspect(void *data, int point, gh_rve_view *view, const gh_rve_measures **m) {
  const scene_output *o = data;
  *m = gh_farm_measure(o->farm, point);
  return *m ? gh_farm_look(o->farm, point, view) : GH_OK;
}

static void solver_fill(scene_output *o) {
  const gh_scene *s = o->scene;
  o->solver.data = o;
  o->solver.title = s->title, o->solver.length_unit = s->length_unit, o->solver.force_unit = s->force_unit;
  o->solver.mesh = s->mesh, o->solver.nsets = s->nsets, o->solver.packing_of = s->packing_of;
  o->solver.fields = o->fields, o->solver.columns = o->columns;
  o->solver.recorded = (gh_point_list){s->nrves, s->rves};
  o->solver.dumped = (gh_point_list){s->ndumps, s->dumps};
  o->solver.dump_every = s->dump_every;
  o->solver.row = scene_row, o->solver.inspect = point_inspect, o->solver.record = scene_record;
  o->solver.marks = scene_marks, o->solver.save = scene_save;
  o->solver.load = scene_load, o->solver.resume = scene_resume;
}

gh_status scene_output_create(gh_scene *scene, gh_farm *farm, gh_macro *macro, const char *folder,
                              scene_output *o) {
  const size_t points = (size_t)gh_farm_size(farm);
  *o = (scene_output){.ctx = scene->ctx, .scene = scene, .farm = farm, .macro = macro, .min_acoustic = NAN};
  GH_TRY(gh_alloc(o->ctx, 4 * points, sizeof *o->cauchy, &o->cauchy));
  GH_TRY(gh_alloc(o->ctx, points, sizeof *o->acoustic, &o->acoustic));
  GH_TRY(gh_alloc(o->ctx, points, sizeof *o->angle, &o->angle));
  if (!folder) return GH_OK;
  GH_TRY(scene_fields_create(o->ctx, &o->fields, &o->solver.nfields));
  GH_TRY(scene_columns_create(scene, &o->columns, &o->solver.ncolumns));
  solver_fill(o);
  return gh_results_create(o->ctx, &o->solver, folder, &o->results);
}

void scene_output_destroy(scene_output *o) {
  gh_results_destroy(&o->results);
  scene_loaded_destroy(o);
  free(o->fields);
  free(o->columns);
  free(o->cauchy);
  free(o->acoustic);
  free(o->angle);
  *o = (scene_output){0};
}

/* ---- an increment ---- */

/* What the farm has counted since the last row goes into the frame. */
static void frame_count(scene_output *o, gh_frame *f) {
  gh_farm_counts now;
  gh_farm_count(o->farm, &now);
  f->evaluations = now.evaluations - o->counted.evaluations;
  f->computed = now.computed - o->counted.computed;
  f->moved = now.moved - o->counted.moved;
  f->ranks = now.ranks;
}

gh_status scene_output_write(scene_output *o, gh_frame frame, const gh_macro_report *report,
                             const gh_run_summary *summary) {
  GH_TRY(scene_output_inspect(o));
  if (!o->results) return GH_OK;
  o->report = report, o->summary = summary;
  frame.most_loaded = o->most_loaded, frame.least_stable = o->least_stable;
  frame.seconds = report->seconds, frame.micro_seconds = report->micro_seconds;
  frame_count(o, &frame);
  gh_status status = gh_results_write(o->results, &frame);
  gh_farm_count(o->farm, &o->counted);
  return status;
}

gh_status scene_output_close(scene_output *o, gh_status status, const char *outcome, const char *message,
                             const gh_run_summary *summary) {
  o->summary = summary;
  return o->results ? gh_results_close(o->results, outcome, message, status == GH_INPUT) : GH_OK;
}

/* ---- checkpoints ---- */

gh_status scene_checkpoint_make(scene_output *o, scene_position *position, gh_h5 **file) {
  o->position = position;
  gh_status status = gh_checkpoint_make(o->results, file);
  o->position = NULL;
  return status;
}

gh_status scene_checkpoint_read(scene_output *o, scene_position *position) {
  o->position = position;
  gh_status status = gh_checkpoint_read(o->results);
  o->position = NULL;
  return status;
}
