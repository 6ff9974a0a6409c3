/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Pressure on the edges of elements: forces and their derivative. */
#include "macro/internal.h"

#include <string.h>

void gh_edge_force(const double a[2], const double b[2], double pressure, double f[2]) {
  f[0] = -0.5 * pressure * (b[1] - a[1]);
  f[1] = 0.5 * pressure * (b[0] - a[0]);
}

void gh_edge_stiffness(double pressure, double K[4][4]) {
  double h = 0.5 * pressure;
  for (int row = 0; row < 4; row += 2) { /* both nodes carry the same force */
    double x[4] = {0, -h, 0, h}, y[4] = {h, 0, -h, 0};
    memcpy(K[row], x, sizeof x);
    memcpy(K[row + 1], y, sizeof y);
  }
}
