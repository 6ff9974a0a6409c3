/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A compressible neo-Hooke solid in closed form, energy m/2 (F:F - 2 - 2 ln J) + l/2 (ln J)^2. */
#ifndef GRANHOM_TESTS_NEO_HOOKE_H
#define GRANHOM_TESTS_NEO_HOOKE_H

#include "granhom/base.h"

static inline void neo_hooke_of(double m, double l, const double F[4], double P[4], double A[16]) {
  const double J = gh_det2(F);
  double G[4];
  gh_inv2(F, G);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      P[2 * i + j] = m * (F[2 * i + j] - G[2 * j + i]) + l * log(J) * G[2 * j + i];
      for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
          A[8 * i + 4 * j + 2 * a + b] = m * (i == a && j == b) + l * G[2 * j + i] * G[2 * b + a] +
                                         (m - l * log(J)) * G[2 * j + a] * G[2 * b + i];
    }
}

#endif
