/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the readers of a scene share. */
#ifndef GRANHOM_SCENE_READ_H
#define GRANHOM_SCENE_READ_H

#include "scene/internal.h"

typedef gh_yaml_node node;
/* ---- read_values.c: values; all failures are GH_INPUT with file:line ---- */

gh_status scene_optional_bool(node map, const char *key, bool *value);
/* Two numbers [x, y]. */
gh_status scene_pair(node n, const char *what, double value[2]);
/* Number of entries of an optional list. */
gh_status scene_list_length(node list, const char *what, int *length);

/* The number 0 < x < 1 behind an optional key. */
gh_status scene_fraction(node map, const char *key, double *value);
gh_status scene_optional_integer(node map, const char *key, long low, long high, int *value);
/* One of two words: 0 or 1. */
gh_status scene_optional_choice(node map, const char *key, const char *const words[2], int *value);

/* ---- keys.c: what each map of a scene may hold ---- */

extern const gh_term scene_root_keys[], scene_units_keys[], scene_ensemble_keys[], scene_contact_keys[],
    scene_micro_keys[], scene_start_keys[], scene_mesh_keys[], scene_rectangle_keys[], scene_move_keys[],
    scene_support_keys[], scene_step_keys[], scene_pressure_keys[], scene_displace_keys[], scene_force_keys[],
    scene_footing_keys[], scene_gravity_keys[], scene_release_keys[], scene_solver_keys[],
    scene_results_keys[];

/* ---- packings.c ---- */

/* `packing`: a file, a list of files, or {ensemble: [...], seed: S}. The mesh is known. */
gh_status scene_read_packings(gh_scene *s, node root, const char *folder);

/* ---- read_steps.c ---- */

/* [{edge: NAME, KEY: x|y|both}, ...]; key is `fix` or `free`. */
gh_status scene_read_fixes(gh_scene *s, node list, const char *what, const char *key, scene_fix **fixes,
                           int *count);
gh_status scene_read_steps(gh_scene *s, node root);

/* ---- read_solver.c ---- */

gh_status scene_read_solver(gh_scene *s, node root);

/* ---- read_results.c ---- */

gh_status scene_read_results(gh_scene *s, node root);

#endif
