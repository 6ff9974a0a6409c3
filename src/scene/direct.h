/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A scene as grains everywhere, and its results. */
#ifndef GRANHOM_SCENE_DIRECT_H
#define GRANHOM_SCENE_DIRECT_H

#include "granhom/direct.h"
#include "scene/output.h"

typedef struct scene_direct {
  gh_context *ctx;
  gh_scene *scene;
  const gh_direct_run_options *options;
  const char *folder;
  gh_direct *body;
  gh_loads *loads; /* of the plan, which wants to be asked for them */
  double *pressure, *force;
  gh_results *results;
  gh_solver_results solver;
  gh_column *columns;
  gh_lock *lock;
  gh_h5 *pending; /* checkpoint of the last complete increment */
  gh_work work;
  double **begin_u; /* nsteps + 1: displacements when each step began */
  int counter, step, increment;
  gh_direct_report report; /* of the increment that is written */
  gh_direct_summary sum;
  double begin, before; /* clock at the start; seconds up to the checkpoint that was read */
  struct scene_direct_loaded *loaded;
} scene_direct;

/* ---- direct_output.c ---- */

gh_status scene_direct_output(scene_direct *r);
/* ---- direct_saved.c ---- */
int scene_direct_marks(void *data, gh_mark *list);
gh_status scene_direct_save(void *data, gh_archive *a);
gh_status scene_direct_load(void *data, gh_archive *a);
gh_status scene_direct_resume(void *data);
void scene_direct_loaded_destroy(scene_direct *r);

#endif
