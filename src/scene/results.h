/* What the writers of results share. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_SCENE_RESULTS_H
#define GRANHOM_SCENE_RESULTS_H

#include "scene/internal.h"

struct scene_results {
  gh_context *ctx;
  gh_scene *scene;
  gh_farm *farm;
  gh_macro *macro;
  char *folder;
  gh_text *history, *convergence, *timing, *xdmf;
  bool begun;             /* the folder is there */
  gh_farm_counts counted; /* by the farm up to the last row of history.csv */
  int frames;             /* complete increments on disk */
  int unjammed;
  double min_acoustic;
  int most_loaded,
      least_stable; /* points with the largest von Mises stress and the smallest acoustic eigenvalue */
  char started[40];
  double *tensor, *scalar; /* scratch: 4 and 1 numbers per point */
};

/* results.c: a file of the folder; the caller frees. */
gh_status scene_result_path(const scene_results *r, const char *name, char **path);

/* history.c */
/* A set's name as part of a column's: no commas, spaces or quotes. */
const char *scene_column(const gh_mesh *mesh, int set, char text[64]);
void scene_history_header(scene_results *r);
void scene_history_row(scene_results *r, const scene_frame *f);

/* results_h5.c, rves_h5.c */
gh_status scene_write_h5(scene_results *r, const scene_frame *f);
gh_status scene_write_rves(scene_results *r, const scene_frame *f);

#endif
