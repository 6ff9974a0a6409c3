/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the files of the relaxation with friction share: the parts of its work space, and what is done with them. */
#ifndef GRANHOM_ENGINE_RELAX_FRICTION_PARTS_H
#define GRANHOM_ENGINE_RELAX_FRICTION_PARTS_H

#include "engine/relax/relax_friction.h"
#include "engine/relax/relax_parts.h"
#include "granhom/base.h"

/* What a pair remembers and exerts, too. */
enum { LN_X = PAIR_GIVEN, LN_Y, GAMMA, GAMMA_PL, ALPHA, GIVEN };
enum { COUPLE = PAIR_EXERTED, DISSIPATED, EXERTED };
enum { PER_BLOCK = 6 };

/* The gh_friction_parts of the work space. */
typedef struct gh_friction_parts {
  double *given;  /* GIVEN x npairs */
  double *pair;   /* EXERTED x npairs */
  double *rolled; /* n: r (theta - theta_n) */
  double *couple; /* n: sum of the couples, -m/r */
  double *old_f;  /* 2 n: forces of the last step */
  double *old_c;  /* n: sums of the couples of the last step */
  double *block;  /* PER_BLOCK n: stiffness of each grain alone */
  double *before; /* n: `rolled` when it was last looked for spins */
  double *x0;     /* 2 n: on a ramp, where the pairs were found, moved along */
  double *crept;  /* 3 n: on a ramp, positions and rotations when it was last looked for creep */
  int *i, *j;     /* npairs: grains of each pair */
} gh_friction_parts;

/* They lie in s->grains.work. */
gh_friction_parts gh_friction_divide(const gh_relax_friction *s);
/* Lays the pairs and their memory out in the work space. */
void gh_friction_lay_out(const gh_relax_friction *s, const gh_friction_parts *w);
/* As gh_relax_friction_forces, for pairs that are laid out. */
double gh_friction_forces(gh_relax_friction *s, const gh_friction_parts *w, double *mean_force);
/* The time step that the pairs as they are laid out allow. */
double gh_friction_time_step(const gh_relax_friction *s, const gh_friction_parts *w);
static inline double gh_friction_free(const gh_relax_friction *s, int i) {
  return s->grains.held && s->grains.held[i] ? 0 : 1;
}

/* ---- relax_ramp.c ---- */

/* The list is made for positions, and images, that the ramp leaves: `reach` is that of the largest grains, whose
 * pair need not be on it. */
typedef struct gh_ramp_list {
  double from[4], reach;
} gh_ramp_list;

bool gh_ramp_is_over(const gh_relax_friction *s);
/* Of a new list. */
gh_ramp_list gh_ramp_begin(gh_relax_friction *s, const gh_friction_parts *w);
/* The next part: all positions and images follow, and grains rotate with the body. */
void gh_ramp_advance(gh_relax_friction *s, const gh_friction_parts *w);
/* How far a grain may be from where the list was made. */
double gh_ramp_slack(const gh_relax_friction *s, const gh_ramp_list *list);
/* Puts what was committed into the memory of the pairs; returns `end`. */
gh_relax_end gh_ramp_end(gh_relax_friction *s, const gh_friction_parts *w, gh_relax_end end);

#endif
