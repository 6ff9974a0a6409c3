/* What the readers of a scene share. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_SCENE_READ_H
#define GRANHOM_SCENE_READ_H

#include "scene/internal.h"

typedef gh_yaml_node node;
/* ---- read.c: values; all failures are GH_INPUT with file:line ---- */

gh_status scene_copy_text(gh_context *ctx, const char *text, char **copy);
/* The value of a key that must be there. */
gh_status scene_need(node map, const char *what, const char *key, node *value);
/* A map with no other keys than these. */
gh_status scene_map(node n, const char *what, const gh_term *keys);
gh_status scene_number(node n, const char *what, double *value);
/* Above 0. */
gh_status scene_positive(node n, const char *what, double *value);
gh_status scene_optional_bool(node map, const char *key, bool *value);
/* Two numbers [x, y]. */
gh_status scene_pair(node n, const char *what, double value[2]);
/* Number of entries of an optional list. */
gh_status scene_list_length(node list, const char *what, int *length);
/* `contact` and `micro` of a map into *rve, which holds the defaults. */
gh_status scene_read_material(node root, gh_context *ctx, gh_rve_options *rve);

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

/* ---- read_results.c ---- */

gh_status scene_read_results(gh_scene *s, node root);

#endif
