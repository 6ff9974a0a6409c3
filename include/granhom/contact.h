/* granhom: the contact laws, the one place where contact forces and their derivatives are written.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_CONTACT_H
#define GRANHOM_CONTACT_H

#ifdef __cplusplus
extern "C" {
#endif

/* Parameters of the contact between two grains. */
typedef struct gh_contact_law {
  double normal_stiffness; /* E_n > 0, force per length */
} gh_contact_law;

/* One contact of a packing. The branch vector goes from grain i to the image of grain j that it touches. */
typedef struct gh_contact {
  int i, j;       /* grains, counted from 0 */
  double l[2];    /* branch vector */
  double f[2];    /* force on grain i; grain j has -f */
  double h[3];    /* -k_ij = second derivative of the contact energy with respect to l: xx xy yy (4.12) */
  double overlap; /* r_i + r_j - |l| >= 0 */
  double energy;  /* stored energy */
} gh_contact;

#ifdef __cplusplus
}
#endif
#endif
