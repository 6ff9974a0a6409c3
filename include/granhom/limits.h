/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: known limits of a granulate of soft grains.
 *
 * The contact law describes grains that are stiff: overlaps stand for small deformations near the contacts.
 * Stress over normal stiffness (both force per length) is about the overlap over the radius, so that a state
 * beyond these limits nearly always has its cause in units that do not fit each other. Stresses, stiffness
 * and limits have the same dimension in the plane. */
#ifndef GRANHOM_LIMITS_H
#define GRANHOM_LIMITS_H

#include "granhom/micro.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gh_limits {
  /* of accepted states */
  double overlap_warned;   /* mean overlap over the mean radius: above, a warning */
  double overlap;          /* ... above, the computation stops */
  double sheared_fraction; /* volume fraction up to which `overlap` does not stop. Where all grains follow F
                              (Taylor) overlaps are large in a large shear without compression (reference
                              cases: 0.872); elsewhere 0 */
  /* volume fraction: areas of the disks over that of the cell, overlaps counted twice. Dense sand has 0.84
     and reaches 1 with a mean overlap of 0.11 to 0.16, a lattice of equal disks (0.907) with 0.1, which is
     right */
  double fraction, fraction_overlap; /* above the first, where the mean overlap is above the second */
  double covered; /* above, with any overlap: the thinnest covering of the plane by equal disks, no voids */
  int engulfed;   /* contacts with an overlap above the smaller radius. A contact that spans a third grain
                     whose centre lies on its branch vector implies one: with d_ik + d_kj = d_ij < r_i + r_j
                     the overlaps of k with i and j add up to more than 2 r_k. Not
                     where all grains follow F: their large shears bring such contacts */
  /* of what is prescribed */
  double stress_warned;    /* stress over normal stiffness: above, a warning */
  double stress;           /* ... above, refused */
  double planned_fraction; /* volume fraction that a prescribed F leads to */
  double expansion;        /* det F: no packing is followed so far */
  /* of packings as read, whose grains do not touch */
  double loose;   /* volume fraction below which they are warned of */
  double sparse;  /* ... refused: a dense packing in a cell ten times too large has 0.009 */
  double stretch; /* least stretch between two prescribed edges of a body */
} gh_limits;
/* The values are in src/micro/limits.c. By options->allow_overlap: infinite, all of accepted states; a
 * number, the mean overlap: above the default without limits on the volume fraction and engulfed grains. What
 * is allowed in this way is not warned of. */
GH_API gh_limits gh_limits_of(const gh_rve_options *options);

/* Whether an accepted state is within those limits at which the computation stops. */
GH_API bool gh_limits_hold(const gh_limits *limits, const gh_rve_measures *m);
/* Checks an accepted state. `where` ("step 3", "integration point 7") begins the message. GH_LIMIT: value,
 * limit, likely cause. */
GH_API gh_status gh_limits_check_state(gh_context *ctx, const gh_rve_options *options,
                                       const gh_rve_measures *m, const char *where);
/* Warns of a mean overlap (over the mean radius), as long as *warned is false. */
GH_API void gh_limits_warn(gh_context *ctx, const gh_rve_options *options, const char *where, double overlap,
                           double pressure, bool *warned);
/* Whether a line of the log is a warning of this file: for those who silence all others. */
GH_API bool gh_limits_is_warning(const char *line);
/* Both, for a single packing. */
GH_API gh_status gh_limits_check(gh_context *ctx, const gh_rve_options *options, const gh_rve_measures *m,
                                 const char *where, bool *warned);
/* Mean Cauchy stress, compression positive. */
GH_API double gh_limits_pressure(const gh_rve_measures *m);

/* Normal: compression above 0, a tension is refused. Signless: a shear stress. Load: its stress is an
 * estimate, and there is nothing but a warning. */
typedef enum gh_stress_kind { GH_STRESS_NORMAL, GH_STRESS_SIGNLESS, GH_STRESS_LOAD } gh_stress_kind;
/* Checks a stress that is prescribed, before anything is computed; `what` names it with its value. At most
 * one warning as long as *warned is false. GH_INPUT: "WHERE: ...", a tension, or too much for the stiffness.
 */
GH_API gh_status gh_limits_check_stress(gh_context *ctx, const gh_rve_options *options, const char *where,
                                        const char *what, double compression, gh_stress_kind kind,
                                        bool *warned);
/* Checks a deformation gradient that is prescribed for a packing with this volume fraction as read. GH_INPUT:
 * "WHERE: ..." det F <= 0 or one that no packing can follow. */
GH_API gh_status gh_limits_check_F(gh_context *ctx, const gh_rve_options *options, const char *where,
                                   const double F[4], double fraction);
/* The same for det F alone, as `what` ("volume"). */
GH_API gh_status gh_limits_check_volume(gh_context *ctx, const gh_rve_options *options, const char *where,
                                        const char *what, double det, double fraction);
/* Checks a packing as read from a file. least, most: of det F where that is prescribed, else 1 (F = 1 counts always). At most one
 * warning as long as *warned is false: no contacts, or centres within other grains. GH_INPUT: "FILE: ..." the
 * grains fill too much of the cell, or next to nothing of it, at each of these det F. */
GH_API gh_status gh_limits_check_packing(gh_context *ctx, const gh_rve_options *options, const char *file,
                                         const gh_packing *packing, double least, double most, bool *warned);
/* The likely cause of a wrong F, in a sentence. */
GH_API extern const char gh_limits_undeformed[];
/* Areas of the grains over that of the cell, as read. */
GH_API double gh_packing_volume_fraction(const gh_packing *packing);

#ifdef __cplusplus
}
#endif
#endif
