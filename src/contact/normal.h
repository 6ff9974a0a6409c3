/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One-sided harmonic normal contact (method 1; dissertation 4.3, 4.8, 4.12).
 *
 * Branch vector l from grain i to grain j, overlap e = r_i + r_j - |l|, in contact when e >= 0.
 * Lines a simulation runs millions of times: inline, in C and in C++. */
#ifndef GRANHOM_CONTACT_NORMAL_H
#define GRANHOM_CONTACT_NORMAL_H

#include <math.h>

/* Energy E e^2 / 2 (4.3). */
static inline double gh_normal_energy(double E, double e) {
  return 0.5 * E * e * e;
}

/* Force on grain i is factor * l with the factor -E e / |l| (4.8); d = |l| > 0. */
static inline double gh_normal_factor(double E, double e, double d) {
  return -E * e / d;
}

/* -k_ij = E (n n - e/|l| (1 - n n)): second derivative of the energy with respect to l, in the dimension
 * `dim` (2 or 3), packed xx xy yy or xx xy xz yy yz zz (4.12 with i != j has the opposite sign). */
static inline void gh_normal_hessian(double E, double e, double d, const double *l, int dim, double *h) {
  double q = e / d, s = E * (1 + q) / (d * d);
  int k = 0;
  for (int a = 0; a < dim; a++)
    for (int b = a; b < dim; b++) h[k++] = s * l[a] * l[b] - (a == b ? E * q : 0);
}
#endif
