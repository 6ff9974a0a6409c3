/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: the contact laws, the one place where contact forces and their derivatives are written. */
#ifndef GRANHOM_CONTACT_H
#define GRANHOM_CONTACT_H

#ifdef __cplusplus
extern "C" {
#endif

/* How the slip of a step is measured: as printed in (7.5), the projection of the old branch vector; or by the
 * angle between the branch vectors, which a rigid rotation of any size leaves at zero (method 8.7). */
typedef enum gh_slip_measure { GH_SLIP_PROJECTED, GH_SLIP_OBJECTIVE } gh_slip_measure;

/* How the friction limit grows with the hardening variable: f_n tan(rho) + h alpha, which stays when the normal
 * force goes, as printed in Table 7.1; or f_n (tan(rho) + h alpha), which goes with it. */
typedef enum gh_hardening_law { GH_HARDENING_PRINTED, GH_HARDENING_PROPORTIONAL } gh_hardening_law;

/* Parameters of the contact between two grains. All zero but the first: frictionless. */
typedef struct gh_contact_law {
  double normal_stiffness; /* E_n > 0, force per length */
  int friction; /* nonzero: Coulomb friction by return mapping (Table 7.1); 0: the rest is unused */
  double tangential_stiffness; /* E_t > 0, force per length */
  double friction_coefficient; /* tan(rho) >= 0 */
  double hardening;            /* h >= 0, force per length; proportional: 1/length */
  gh_slip_measure slip;
  int fixed_rotations; /* nonzero: grains do not rotate */
  gh_hardening_law hardening_law;
} gh_contact_law;

/* One contact of a packing. The branch vector goes from grain i to the image of grain j that it touches. */
typedef struct gh_contact {
  int i, j;       /* grains, counted from 0 */
  double l[2];    /* branch vector */
  double f[2];    /* force on grain i, friction included; grain j has -f */
  double h[3];    /* -k_ij = second derivative of the normal energy with respect to l: xx xy yy (4.12) */
  double overlap; /* r_i + r_j - |l| >= 0 */
  double energy;  /* stored in the normal contact (4.3) */
} gh_contact;

/* History of one contact. The image counts lattice vectors between the positions of i and j as they are kept,
 * never wrapped: l = x_j + cell image - x_i; so it is the same contact for as long as the two touch. i <= j;
 * for i == j the image is the positive one of the two (the second component first). */
typedef struct gh_slip {
  int i, j, image[2];
  double gamma;    /* total slip (7.5), length */
  double gamma_pl; /* its plastic part (7.17), length */
  double alpha;    /* hardening variable (7.17), length; survives opening (method 8.10) */
} gh_slip;

/* The tangential part of one contact; f_t is along t = n rotated by +90 degrees. */
typedef struct gh_friction {
  gh_slip slip;  /* of the trial state, with the key of the contact */
  double force;  /* f_t = E_t (gamma - gamma_pl), signed: f on grain i is -E_n e n - c f_t t (7.19) */
  double couple; /* M = c s f_t: the moments on i and j are -r_i M and -r_j M (7.23; method 8.8) */
  double d[9];   /* derivative of (f_x, f_y, M) with respect to (l_x, l_y, q), row-major, at fixed state n;
                    q = r_i (theta_i - theta_i^n) + r_j (theta_j - theta_j^n) */
  double energy; /* E_t gamma_el^2 / 2 + h alpha^2 / 2 (7.6); proportional hardening stores nothing */
  double
      dissipated; /* dlambda f_n tan(rho) of this step (7.13), and dlambda f_n h alpha where that is lost */
  int slides;     /* nonzero: on the Coulomb limit */
} gh_friction;

#ifdef __cplusplus
}
#endif
#endif
