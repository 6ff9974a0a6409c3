/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Density functions of directions. */
#include "report/report.h"

void report_density(int n, const double *x, const double *weight, double influence, int m, double *density) {
  double whole = 0;
  for (int i = 0; i < n; i++) whole += weight ? weight[i] : 1;
  for (int k = 0; k < m; k++) {
    double sum = 0, at = 2 * GH_PI * k / m;
    for (int i = 0; i < n; i++) { /* the angle between two axes, in [0, GH_PI/2] */
      double off = fabs(remainder(atan2(x[2 * i + 1], x[2 * i]) - at, GH_PI));
      if (off <= influence / 2) sum += weight ? weight[i] : 1;
    }
    density[k] = whole > 0 ? sum * GH_PI / (influence * whole) : 0;
  }
}
