/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the extremes of RVEs without friction share. */
#ifndef GRANHOM_TESTS_EXTREME_RVE_H
#define GRANHOM_TESTS_EXTREME_RVE_H

#include "extreme.h"

static const char section[] = "Frictionless";

/* Taylor on the cell, summed over all pairs and images in the plainest way. */
static inline void sum_of_pairs(const gh_packing *p, const double F[4], double E, double P[4]) {
  double inverse[4], V = gh_det2(p->cell);
  gh_inv2(F, inverse);
  memset(P, 0, 4 * sizeof *P);
  for (int i = 0; i < p->n; i++)
    for (int j = 0; j < p->n; j++)
      for (int k = 0; k < 49; k++) {
        double a = k % 7 - 3, b = k / 7 - 3, L[2], l[2];
        for (int c = 0; c < 2; c++)
          L[c] = p->x[2 * j + c] - p->x[2 * i + c] + p->cell[2 * c] * a + p->cell[2 * c + 1] * b;
        gh_apply2(F, L, l);
        double d = hypot(l[0], l[1]), overlap = p->radius[i] + p->radius[j] - d;
        if (overlap < 0 || d == 0) continue;
        for (int c = 0; c < 4; c++)
          P[c] -= E * overlap * l[c / 2] / d * L[c % 2] / V / 2; /* each pair twice */
      }
}

#endif
