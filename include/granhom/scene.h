/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: scenes: reading and checking them, running their load steps. */
#ifndef GRANHOM_SCENE_H
#define GRANHOM_SCENE_H

#include "granhom/farm.h"
#include "granhom/io.h"
#include "granhom/macro.h"
#include "granhom/results.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- a scene file (docs/reference/keys.md) ---- */

typedef struct gh_scene gh_scene;

/* The keys of a scene file, map by map; the columns and datasets of the files that a run writes. */
GH_API const gh_term_list *gh_scene_keys(void);
GH_API const gh_term_list *gh_scene_columns(void);

/* Reads a scene with its packing and its mesh, and checks all that can be known before the first equilibrium.
 * All errors are GH_INPUT and begin with file:line. Nothing is written. */
GH_API gh_status gh_scene_read(gh_context *ctx, const char *path, gh_scene **scene);
/* A key of the scene with another value than in the file, both as gh_yaml_set takes them. */
typedef struct gh_override {
  const char *key, *value;
} gh_override;
/* The same with n keys set, one after the other, before anything else is read. They are recorded in run.json.
 * Messages about their values have the line of what they replace. */
GH_API gh_status gh_scene_read_with(gh_context *ctx, const char *path, int n, const gh_override *overrides,
                                    gh_scene **scene);
GH_API void gh_scene_destroy(gh_scene **scene);
/* `contact` and `micro` of a map, as in a scene, into *rve, which holds the defaults. GH_INPUT with
 * file:line. */
GH_API gh_status gh_scene_read_material(gh_yaml_node map, gh_context *ctx, gh_rve_options *rve);
/* Overrides `micro: {engine: ...}`. */
GH_API void gh_scene_set_engine(gh_scene *scene, gh_engine_kind engine);
/* false: each integration point is computed, also where others have the same packing and history. */
GH_API void gh_scene_set_sharing(gh_scene *scene, bool share);
/* true: a second body goes in whole increments, the run in halves of them, and it estimates its error. */
GH_API void gh_scene_set_estimate(gh_scene *scene, bool estimate);
/* For gh_scene_explain: the ranks it would run on (0: this build has no MPI), and whether RVEs stay where
 * they began. */
GH_API void gh_scene_set_ranks(gh_scene *scene, int ranks, bool no_balance);
/* States in words what the scene switches on and what it leaves out. */
GH_API void gh_scene_explain(const gh_scene *scene, gh_text *out);

/* ---- load steps: the plan of what acts when ---- */

/* Step 0 is the start. Steps are counted 1 ... gh_scene_steps() as in the file. */
GH_API int gh_scene_steps(const gh_scene *scene);
GH_API int gh_scene_increments(const gh_scene *scene, int step); /* 1 for step 0 */
GH_API const char *gh_scene_step_name(const gh_scene *scene, int step);
GH_API const gh_mesh *gh_scene_mesh(const gh_scene *scene);
/* Labels of units; "" where the file gives none. */
GH_API const char *gh_scene_length_unit(const gh_scene *scene);
GH_API const char *gh_scene_force_unit(const gh_scene *scene);
/* Paths of the packings, each once; *n: how many. They belong to the scene. */
GH_API char *const *gh_scene_packing_files(const gh_scene *scene, int *n);
/* All files that the scene was read from, its own first. The caller frees the list, not the names. */
GH_API gh_status gh_scene_files(const gh_scene *scene, const char ***file, int *n);
typedef enum gh_scene_loading {
  GH_LOADING_NONE,
  GH_LOADING_DISPLACEMENT,
  GH_LOADING_FOOTING,
  GH_LOADING_FORCE /* pressure or nodal force */
} gh_scene_loading;
/* What the response of the body is measured at: the set (index into the mesh) with the last prescribed
 * displacement; without any, that of the last footing, pressure or force. *set -1: there is none. */
GH_API gh_scene_loading gh_scene_last_loading(const gh_scene *scene, int *set);
/* The loads at the end of `increment` (from 1) of `step`. Steps and increments are asked for in their order,
 * and u (nnodes x 2) holds the displacements at the end of the step before whenever increment is 1 (NULL:
 * zero): ramps without `from` and supports hold on to them. */
GH_API gh_status gh_scene_loads(gh_scene *scene, int step, int increment, const double *u, gh_loads *loads);

/* What a plan gives for one set (index into the mesh) after the last gh_scene_loads. */
typedef struct gh_scene_load {
  double pressure;
  bool follow;
  double force[2];        /* on each node */
  bool held[2];           /* all nodes of the set are prescribed in x, y */
  double displacement[2]; /* mean of the prescribed values over the set; NAN where it is not held */
} gh_scene_load;
GH_API void gh_scene_load_on(const gh_scene *scene, int set, gh_scene_load *load);
GH_API void gh_scene_gravity(const gh_scene *scene, double b[2]);

/* ---- a run ---- */

typedef struct gh_run_options {
  bool (*stop)(void *data); /* asked before each increment and each material point; true ends the run with
                               GH_STOPPED. NULL: never */
  void *stop_data;
  const void *comm;     /* MPI_Comm * whose other ranks are in gh_farm_serve; NULL: this process alone */
  bool no_balance;      /* leave RVEs on the rank where they began */
  bool restart;         /* continue from the checkpoint in the folder; from the start where there is none */
  int checkpoint_every; /* increments from one checkpoint to the next; 0: 1 */
  /* called after each complete increment, that of the start (step 0) among them, `increment` of the
     `increments` that are planned in the step; what is not GH_OK ends the run. NULL: not */
  gh_status (*observe)(void *data, int step, int increment, int increments, const gh_macro *macro);
  void *observe_data;
} gh_run_options;

/* Of what a run estimates its error: Piola stress in the root mean square over the points, and at the point
 * where it is largest; displacements; the force on the driven set (all reactions where none is driven). */
enum { GH_ERROR_STRESS, GH_ERROR_STRESS_LARGEST, GH_ERROR_DISPLACEMENT, GH_ERROR_FORCE, GH_ERRORS };

/* Estimate by step doubling (docs/explanation/method.md, "Error estimates"). */
typedef struct gh_run_estimate {
  int increments;           /* compared */
  int branched;             /* of these: the path is another one in halves, or not continuous */
  double now[GH_ERRORS];    /* error at the last increment */
  double error[GH_ERRORS];  /* the largest of all increments */
  double scale[GH_ERRORS];  /* largest value of the quantity up to now */
  double off[GH_ERRORS];    /* difference of the two paths now, since they were last one path */
  double before[GH_ERRORS]; /* sum of their differences when they had to become one again */
  double growth, branch;    /* of the difference of stresses, over their scale: in the last
                               increment, and the largest in a branched one */
  int last_branched;        /* the last increment was */
  double seconds;           /* of the halves: what the estimate costs on top */
} gh_run_estimate;
/* error and now over scale. */
GH_API double gh_estimated_error(const gh_run_estimate *estimate, int quantity);
GH_API double gh_estimated_now(const gh_run_estimate *estimate, int quantity);

typedef struct gh_run_summary {
  int steps, increments;                 /* done, without the start */
  int planned, step;                     /* steps of the scene; the one that is done in part, 0: none is */
  int done, of;                          /* increments of that one: complete, planned */
  int iterations, substeps, cuts, jumps; /* of the whole run */
  int relaxed, relaxed_increments;       /* of the iterations: steps of relaxation; increments with any */
  int at_once;                           /* planned increments that the next one takes */
  int points, unjammed;                  /* material points; how many of them carry nothing at the end */
  double min_acoustic;                   /* smallest eigenvalue of any acoustic tensor at the end */
  gh_rve_cost cost;                      /* of the material points, summed */
  gh_farm_counts farm;
  gh_energy energy;         /* from the start on */
  gh_run_estimate estimate; /* no increments: none was asked for */
  double micro_seconds, results_seconds, seconds;
} gh_run_summary;

/* Runs all steps and writes results.h5, results.xdmf, points.xdmf, rves.h5, traces.h5, dumps, history.csv,
 * convergence.csv, timing.csv and run.json into `folder`, which is made after the first equilibrium. After
 * each increment all files are whole. GH_INPUT: the scene cannot be run (nothing is written when that shows
 * at the start); GH_DIVERGED: names step and increment; what was complete before is on disk. `summary` may be
 * NULL. Folder NULL: nothing is written, there are no checkpoints, and `restart` is not looked at; what comes
 * out is seen by `observe`. checkpoint.h5 is written last, so that all files are complete up to its
 * increment; a run that ends early writes one of the last complete increment. A run that continues from it
 * writes the same files as one that was never interrupted, seconds apart. GH_INPUT: a checkpoint that is
 * damaged or of another scene, packing, mesh or version. */
GH_API gh_status gh_scene_run(gh_scene *scene, const char *folder, const gh_run_options *options,
                              gh_run_summary *summary);
/* ---- the same scene as grains everywhere ---- */

typedef struct gh_direct_run_options {
  double grains; /* in the area of the mesh: sets their size */
  bool tile;     /* copies of the first packing; false: one large packing, grown with `seed` */
  int seed;
  bool restart;         /* as in gh_run_options */
  int checkpoint_every; /* likewise */
  bool (*stop)(void *data);
  void *stop_data;
} gh_direct_run_options;

typedef struct gh_direct_summary {
  int planned, steps, increments; /* steps of the scene, those done, increments without the start */
  int grains, substeps, cuts;
  long relaxation_steps;
  double seconds;
} gh_direct_summary;

/* As gh_scene_run, with the same files but for rves.h5, traces.h5 and points; dumps/point_0.dump holds all
 * grains. GH_INPUT too: a scene with footings, more grains than memory. One process. */
GH_API gh_status gh_scene_direct(gh_scene *scene, const char *folder, const gh_direct_run_options *options,
                                 gh_direct_summary *summary);

/* The summary in words, a few lines. */
GH_API void gh_summary_print(const gh_run_summary *summary, const char *folder, gh_text *out);

#ifdef __cplusplus
}
#endif
#endif
