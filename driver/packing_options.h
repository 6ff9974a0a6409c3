/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Options of what is done with one packing: granhom rve, element and crosscheck. */
#ifndef GRANHOM_PACKING_OPTIONS_H
#define GRANHOM_PACKING_OPTIONS_H

#include "options.h"

#include "granhom/micro.h"

/* The contact law; NAN and -1: not given. */
typedef struct contact_options {
  double normal, angle, coefficient, tangential, hardening, overlap;
  int rotations, slip, hardening_law;
} contact_options;

typedef struct packing_options {
  const char *packing; /* the operand */
  contact_options contact;
  gh_rve_options rve;
} packing_options;

/* States of one material point in files. */
typedef struct state_options {
  const char *save, *load;
} state_options;

/* Groups; the comment names the struct that they fill. */
extern const option_row packing_condition_rows[]; /* packing_options: boundary condition, engine */
extern const option_row packing_contact_rows[];   /* packing_options: contact law */
extern const option_row packing_solver_rows[];    /* packing_options: tolerance, relaxation, its steps */
extern const option_row packing_accept_rows[];    /* packing_options: unconverged states */
extern const option_row packing_state_rows[];     /* state_options */

void packing_defaults(packing_options *o);
/* The contact law and the limit of overlaps go into o->rve. GH_INPUT: options that exclude or need each
 * other. */
gh_status packing_check(gh_context *ctx, packing_options *o);
/* The default of the normal stiffness is named: its unit is that of the stresses. */
void packing_note(gh_context *ctx, const packing_options *o);

#endif
