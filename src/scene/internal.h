/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the files of the scene module share. */
#ifndef GRANHOM_SCENE_INTERNAL_H
#define GRANHOM_SCENE_INTERNAL_H

#include "granhom/scene.h"

enum { SCENE_X = 1, SCENE_Y = 2 }; /* bits of a direction mask */

/* One line of a step. `from` is NAN where the file gives none: the ramp starts at the present value. */
typedef struct scene_fix {
  int set, mask;
} scene_fix;
typedef struct scene_pressure {
  int set, line;
  double from, to;
  bool follow;
} scene_pressure;
typedef struct scene_displace {
  int set, line;
  double from[2], to[2]; /* to: NAN for a direction that is not driven */
} scene_displace;
typedef struct scene_force {
  int set;
  double from[2], to[2];
} scene_force;

typedef struct scene_footing {
  int set, line;
  double at[2], from[2], to[2];
} scene_footing;

typedef struct scene_step {
  char *name;
  int increments, line;
  int nsupports, nreleases, npressures, ndisplaces, nforces, nfootings;
  scene_fix *supports, *releases;
  scene_pressure *pressures;
  scene_displace *displaces;
  scene_force *forces;
  scene_footing *footings;
  bool gravity;
  int gravity_line;
  double gravity_from[2], gravity_to[2];
} scene_step;

/* A value that goes linearly over the increments of a step. */
typedef struct scene_ramp {
  double from, to, now;
} scene_ramp;

/* A footing that stands: its force at `at`, and what an earlier step has left at another point and fades. */
typedef struct scene_standing {
  bool stands;
  int line;
  double at[2], old_at[2];
  scene_ramp force[2], old[2];
} scene_standing;

/* What acts: the plan's memory from step to step (program.c). */
typedef struct scene_present {
  scene_ramp *pressure;    /* nsets */
  bool *follow;            /* nsets */
  scene_ramp (*force)[2];  /* nsets */
  scene_standing *footing; /* nsets */
  scene_ramp gravity[2];
  scene_ramp *u;       /* 2 nnodes, where held */
  bool *held, *driven; /* 2 nnodes; driven: by a `displace` of this step or of one before */
} scene_present;

typedef enum scene_start { SCENE_START_NONE, SCENE_START_CONFINEMENT, SCENE_START_BALANCE } scene_start;

struct gh_scene {
  gh_context *ctx;
  char *path, *text, *title, *length_unit, *force_unit;
  int noverrides;
  char **override_key, **override_value; /* set in place of what `text` states */
  int npackings;                         /* different files */
  char **packing_paths;
  gh_packing **packings;
  int *packing_of;    /* 4 nelements: packing of each integration point */
  bool packing_drawn; /* by the seed */
  long packing_seed;
  gh_mesh *mesh;
  char *mesh_path; /* NULL: a rectangle */
  int mesh_line;
  int nsets; /* of the mesh as the user knows it; behind these comes one set per node (program.c) */
  gh_rve_options micro;
  bool no_share;
  int resident; /* RVEs kept ready on a rank; 0: by memory */
  gh_macro_options solver;
  int at_once; /* planned increments that one may take; 1: as planned */
  int ranks;   /* to be told by gh_scene_explain; 0: a build without MPI */
  bool no_balance;
  bool estimate; /* of the error, by step doubling */
  scene_start start;
  int start_line;
  double confinement;
  int confinement_follow; /* -1: as the pressure that takes over, else dead */
  double gravity[2];
  int gravity_line;
  int nsupports, nsteps;
  scene_fix *supports;
  scene_step *steps;
  int nrves; /* integration points to record; GH_ALL_POINTS, GH_FEW_POINTS */
  int *rves;
  int ndumps, *dumps; /* integration points to dump; GH_ALL_POINTS */
  int dump_every;     /* increments */
  scene_present present;
};

/* names.c */
/* GH_INPUT: a set whose name is no text of one line or too long, two columns or two sets of one name. */
gh_status scene_names_check(const gh_scene *scene);

/* folder.c: the lock of a folder that takes results. GH_INPUT: it holds a file of the scene under a name that is
 * written, or the results of a study. */
gh_status scene_folder_open(const gh_scene *scene, const char *folder, gh_lock **lock);

/* packings.c */
int scene_packing_points(const gh_scene *scene, int packing); /* at how many integration points it is */
void scene_packings_destroy(gh_scene *scene);

/* program.c */
gh_status scene_program_create(gh_scene *scene);
void scene_program_destroy(gh_scene *scene);
/* Goes through all steps without solving anything: supports, releases, confinement. */
gh_status scene_program_check(gh_scene *scene);
/* boundary.c */
/* Whether some edge of the outer boundary is free to move along its normal, so that nothing but a load can
 * hold a stress there. */
bool scene_boundary_is_free(const gh_scene *scene);
bool scene_has_load(const gh_scene *scene); /* any at present: pressure, force or gravity */
/* Whether a load along the normal of the edge from node a to node b would move one of them. */
bool scene_normal_is_free(const gh_scene *scene, int a, int b);

/* limits.c: what is prescribed against granhom/limits.h. GH_INPUT with file:line, or a warning. */
gh_status scene_check_stresses(gh_scene *scene); /* pressures, confinement, weight */
/* The confinement leaves no edge at the start that is neither supported nor pressed. Step 0 is present. */
gh_status scene_check_confined(gh_scene *scene);
/* Prescribed edges keep their distance at the end of the step that is present. Displacements that are not
 * known before the run are NAN. */
gh_status scene_check_stretch(gh_scene *scene, const scene_step *step);

/* run.c: GH_INPUT: the packing is under stress and finds no load at a free boundary. The plan is at the start. */
gh_status scene_check_start(const gh_scene *scene);

/* estimate.c: solves the increment for both paths, in halves and as a whole, and counts how they differ. */
gh_status scene_solve_twice(const gh_scene *scene, gh_macro *macro, const gh_loads *loads,
                            gh_macro_report *report, gh_macro_report *whole, gh_run_estimate *estimate);
/* The set that a step drives last, and its direction; false: none is driven. */
bool scene_driven(const gh_scene *scene, int *set, int *direction);

#endif
