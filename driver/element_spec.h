/* What `granhom element` shall do: steps of conditions, from a YAML file or a table. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#ifndef GRANHOM_ELEMENT_SPEC_H
#define GRANHOM_ELEMENT_SPEC_H

#include "granhom/control.h"

/* Where a condition goes in a step: to a value, or from where it is: by a difference, times a factor; hold is
 * by 0. */
typedef enum element_way { ELEMENT_TO, ELEMENT_BY, ELEMENT_TIMES } element_way;

typedef struct element_step {
  char name[64];
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
  element_step *steps;
} element_spec;

/* {steps: [...]}, docs/element.md. GH_INPUT with file and line. */
gh_status element_spec_read(gh_context *ctx, const char *path, element_spec *spec);
/* A CSV whose columns, but for `step`, are named by conditions; a row of targets per increment. */
gh_status element_spec_read_path(gh_context *ctx, const char *path, element_spec *spec);
void element_spec_free(element_spec *spec);

#endif
