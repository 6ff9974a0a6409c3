/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What `granhom element` shall do: steps of conditions, from a YAML file or a table. */
#ifndef GRANHOM_ELEMENT_SPEC_H
#define GRANHOM_ELEMENT_SPEC_H

#include "granhom/control.h"
#include "granhom/limits.h"

/* Where a condition goes in a step: to a value, or from where it is: by a difference, times a factor; hold is
 * by 0. */
typedef enum element_way { ELEMENT_TO, ELEMENT_BY, ELEMENT_TIMES } element_way;

typedef struct element_step {
  char name[64];
  int line[4]; /* of the conditions, in the file; 0: F21, which the step adds */
  int increments;
  gh_condition condition[4];
  element_way way[4];
  double value[4];
  bool until; /* ends early, with the increment in which `end` passes `level` */
  gh_condition end;
  double level;
} element_step;

typedef struct element_spec {
  int nsteps, increments; /* increments: of all steps */
  size_t capacity;
  const char *path; /* of the file, the caller's */
  element_step *steps;
} element_spec;

/* {steps: [...]}, docs/reference/keys.md. GH_INPUT with file and line. */
gh_status element_spec_read(gh_context *ctx, const char *path, element_spec *spec);
/* A CSV whose columns, but for `step`, are named by conditions; a row of targets per increment. */
gh_status element_spec_read_path(gh_context *ctx, const char *path, element_spec *spec);
/* What is prescribed, as far as it is known before the test, against granhom/limits.h: tensions, stresses
 * beyond the stiffness, strains that no packing follows. loaded: the test starts from a saved state. GH_INPUT
 * with file and line. */
gh_status element_spec_check(gh_context *ctx, const element_spec *spec, const gh_rve_options *options,
                             const gh_packing *packing, bool loaded);
/* One condition that goes to this value. */
gh_status element_check_target(gh_context *ctx, const char *where, const gh_condition *condition,
                               double target, const gh_rve_options *options, double fraction, bool *warned);
void element_spec_free(element_spec *spec);

#endif
