/* checkpoint.h5: all that a run needs to go on. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_SCENE_CHECKPOINT_H
#define GRANHOM_SCENE_CHECKPOINT_H

#include "scene/results.h"

/* Where a run is after an increment, and what it has counted. */
typedef struct scene_position {
  int counter, step, increment; /* of the last complete increment; counter from 0, the start */
  double *
      *begin_u; /* nsteps + 1: displacements (2 nnodes) when each step began; NULL: not begun, or the start */
  gh_run_summary sum;
} scene_position;

/* Puts everything into a new file in memory, *file, which gh_h5_commit brings to disk. */
gh_status scene_checkpoint_make(const scene_results *r, const scene_position *p, gh_h5 **file);
/* *there: the folder holds a checkpoint. */
gh_status scene_checkpoint_find(const scene_results *r, bool *there);
/* Reads it into the farm, the macro problem, the texts of the results and p; GH_INPUT when it is damaged or
 * belongs to something else. The plan of the loads is up to the caller. */
gh_status scene_checkpoint_read(scene_results *r, scene_position *p);

/* results.c: the texts that grow with the run. */
typedef struct scene_text {
  const char *name;
  gh_text *text;
} scene_text;
enum { SCENE_TEXTS = 5 };
void scene_results_texts(const scene_results *r, scene_text list[SCENE_TEXTS]);
/* results.c: the folder is that of a run with `frames` complete increments; what came behind them is removed.
 */
gh_status scene_results_resume(scene_results *r, int frames);

#endif
