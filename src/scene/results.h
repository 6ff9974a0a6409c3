/* What the writers of results share. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_SCENE_RESULTS_H
#define GRANHOM_SCENE_RESULTS_H

#include "scene/internal.h"

#include <sys/types.h>

struct scene_results {
  gh_context *ctx;
  gh_scene *scene;
  gh_farm *farm;
  gh_macro *macro;
  char *folder; /* NULL: nothing is written */
  gh_text *history, *convergence, *timing, *xdmf, *points_xdmf;
  bool begun;             /* the folder is there */
  gh_farm_counts counted; /* by the farm up to the last row of history.csv */
  int frames;             /* complete increments on disk */
  int unjammed;
  double min_acoustic;
  int most_loaded,
      least_stable; /* points with the largest von Mises stress and the smallest acoustic eigenvalue */
  char started[40];
  off_t *dump_end;         /* dumps.c: lengths of the files */
  double *tensor, *scalar; /* scratch: 4 and 1 numbers per point */
};

/* results.c: a file of the folder; the caller frees. */
gh_status scene_result_path(const scene_results *r, const char *name, char **path);

/* recorded.c: kind and version of an HDF5 file of the folder, for gh_h5_open. */
const char *scene_h5_kind(const char *name);

/* columns.c: the columns of the text files that a run writes */
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
extern const gh_term scene_history_head[], scene_history_sets[], scene_history_tail[],
    scene_history_estimate[], scene_timing_columns[], scene_convergence_columns[], scene_grain_columns[],
    scene_grain_friction[], scene_contact_columns[], scene_contact_friction[];

/* history.c */
/* The names of its columns, with commas between, without an end of line. */
void scene_history_columns(const gh_scene *scene, gh_text *out);
void scene_history_header(scene_results *r);
/* Returns where the fields begin that are numbers in every row: displacements that nothing prescribes are
 * nan. */
size_t scene_history_row(scene_results *r, const scene_frame *f);

/* numbers.c: what is written of each material point under `name`, and its mean over an element where that has
 * a meaning. */
typedef struct scene_number {
  const char *name;
  double (*of)(const gh_rve_measures *m);
  bool mean;
} scene_number;
extern const scene_number scene_numbers[];
extern const size_t scene_number_count;
extern const gh_term scene_number_terms[];

/* xdmf.c */
void scene_xdmf_begin(gh_text *out);
void scene_xdmf_step(gh_text *out, const gh_mesh *mesh, const scene_frame *frame);   /* of results.xdmf */
void scene_xdmf_points(gh_text *out, const gh_mesh *mesh, const scene_frame *frame); /* of points.xdmf */
void scene_xdmf_end(gh_text *out);

/* results_h5.c, rves_h5.c, dumps.c */
gh_status scene_write_h5(scene_results *r, const scene_frame *f);
gh_status scene_write_rves(scene_results *r, const scene_frame *f);
gh_status scene_write_dumps(scene_results *r, const scene_frame *f);
/* The one way from a material point to its grains: the view and the measures of its last evaluation, valid
 * until the next call. *m is NULL when the point is no RVE. */
gh_status scene_look_at_point(scene_results *r, int point, gh_rve_view *view, const gh_rve_measures **m);

#endif
