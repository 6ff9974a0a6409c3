/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Overlap of spheres in DIM dimensions, for the tests of growth. */
#ifndef GRANHOM_TESTS_GROW_HELP_H
#define GRANHOM_TESTS_GROW_HELP_H

#include "../help.h"

#include "packing/grow.h"

/* Largest overlap of spheres in a cell (upper triangular, columns span it), over the smallest radius. */
static inline double overlap(int n, const double *x, const double *radius, const double *cell) {
  double worst = -INFINITY, smallest = INFINITY;
  const int span = 2, deep = DIM == 3 ? 2 : 0;
  for (int i = 0; i < n; i++) smallest = fmin(smallest, radius[i]);
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++)
      for (int a = -span; a <= span; a++)
        for (int b = -span; b <= span; b++)
          for (int c = -deep; c <= deep; c++) {
            int times[3] = {a, b, c};
            double square = 0;
            if (i == j && !a && !b && !c) continue;
            for (int r = 0; r < DIM; r++) {
              double d = x[DIM * i + r] - x[DIM * j + r];
              for (int k = r; k < DIM; k++) d += cell[DIM * r + k] * times[k];
              square += d * d;
            }
            worst = fmax(worst, radius[i] + radius[j] - sqrt(square));
          }
  return worst / smallest;
}

#endif
