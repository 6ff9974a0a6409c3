/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A scene's results: what it hands to the writers (granhom/results.h). */
#ifndef GRANHOM_SCENE_OUTPUT_H
#define GRANHOM_SCENE_OUTPUT_H

#include "io/json.h"
#include "scene/internal.h"

/* Where a run is after an increment, and what it has counted. */
typedef struct scene_position {
  int counter, step, increment; /* of the last complete increment; counter from 0, the start */
  double *
      *begin_u; /* nsteps + 1: displacements (2 nnodes) at the start of each step; NULL: not begun, or 0 */
  gh_run_summary sum;
} scene_position;

typedef struct scene_loaded scene_loaded; /* saved.c */

typedef struct scene_output {
  gh_context *ctx;
  const gh_scene *scene;
  gh_farm *farm;
  gh_macro *macro;
  gh_results *results; /* NULL: nothing is written */
  gh_solver_results solver;
  gh_column *columns;
  gh_field *fields;
  /* of the last scene_output_inspect */
  double *cauchy, *acoustic, *angle; /* per integration point: 4, 1, 1 */
  double min_acoustic;
  int unjammed, most_loaded, least_stable;
  gh_farm_counts counted; /* by the farm up to the last row of history.csv */
  /* of the increment that is written */
  const gh_macro_report *report;
  const gh_run_summary *summary;
  scene_position *position; /* of the checkpoint under way */
  scene_loaded *loaded;
} scene_output;

/* ---- output.c ---- */

/* Folder NULL: the points are inspected, and nothing is written. The output must not move afterwards. */
gh_status scene_output_create(gh_scene *scene, gh_farm *farm, gh_macro *macro, const char *folder,
                              scene_output *o);
void scene_output_destroy(scene_output *o);
/* Inspects, and writes the increment. frame: counter, step, increment, name, time. */
gh_status scene_output_write(scene_output *o, gh_frame frame, const gh_macro_report *report,
                             const gh_run_summary *summary);
/* Ends the record: outcome ("done", "stopped", ...) and message into run.json. */
gh_status scene_output_close(scene_output *o, gh_status status, const char *outcome, const char *message,
                             const gh_run_summary *summary);
gh_status scene_checkpoint_make(scene_output *o, scene_position *position, gh_h5 **file);
/* Into farm, body, texts of the results and *position. The plan of the loads is up to the caller. */
gh_status scene_checkpoint_read(scene_output *o, scene_position *position);

/* ---- inspect.c ---- */

/* Stress and acoustic tensor of each integration point, what is largest and smallest. GH_DIVERGED: a number
 * is not finite. */
gh_status scene_output_inspect(scene_output *o);

/* ---- fields.c ---- */

/* The table of fields; the caller frees. */
gh_status scene_fields_create(gh_context *ctx, gh_field **fields, int *count);

/* numbers.c: what is written of each integration point under `name`, and its mean over an element where that
 * has a meaning. */
typedef struct scene_number {
  const char *name, *point, *cell; /* datasets */
  double (*of)(const gh_rve_measures *m);
  bool mean;
} scene_number;
extern const scene_number scene_numbers[];
extern const size_t scene_number_count;

/* ---- history.c ---- */

/* Columns of history.csv; the caller frees. */
gh_status scene_columns_create(const gh_scene *scene, gh_column **columns, int *count);
/* Their values: gh_solver_results.row. */
gh_status scene_row(void *data, const gh_frame *frame, double *value);

/* ---- columns.c: what the columns mean ---- */

enum {
  HISTORY_P,
  HISTORY_UX,
  HISTORY_UY,
  HISTORY_FX,
  HISTORY_FY,
  HISTORY_FOOTING_FX,
  HISTORY_FOOTING_FY,
  HISTORY_GX,
  HISTORY_GY,
  HISTORY_X,
  HISTORY_Y,
  HISTORY_FOOTING_UX,
  HISTORY_FOOTING_UY,
  HISTORY_FOOTING_TURN
};
extern const gh_term scene_history_sets[], scene_history_tail[], scene_history_relaxation[],
    scene_history_estimate[], scene_number_terms[];

/* ---- record.c: run.json ---- */

gh_status scene_record(void *data, const gh_outcome *outcome, gh_text *out);
/* What both kinds of a run record before and after their own; scene_record_end prints and destroys. */
void scene_record_begin(gh_json root, const gh_scene *scene, const gh_outcome *outcome);
gh_status scene_record_end(gh_json root, const gh_scene *scene, gh_text *out);

/* ---- saved.c: checkpoints ---- */

int scene_marks(void *data, gh_mark *list);
int scene_marks_common(const gh_scene *scene, gh_mark *list); /* of both kinds of a run */
gh_status scene_save(void *data, gh_archive *a);
gh_status scene_load(void *data, gh_archive *a);
gh_status scene_resume(void *data);
void scene_loaded_destroy(scene_output *o);

#endif
