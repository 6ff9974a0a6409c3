/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the extremes of RVEs without friction share. */
#ifndef GRANHOM_TESTS_EXTREME_RVE_H
#define GRANHOM_TESTS_EXTREME_RVE_H

#include "extreme.h"

static const char section[] = "Frictionless";
static const double I[4] = {1, 0, 0, 1}, squeeze[4] = {0.98, 0.005, 0.002, 0.985};

/* P (and A where wanted) at F after the steps F/n, 2F/n, ... from I. */
static inline void walk(gh_context *ctx, gh_rve *rve, const double from[4], const double to[4], int n,
                        double P[4], double *A) {
  double F[4];
  for (int k = 1; k <= n; k++) {
    for (int c = 0; c < 4; c++) F[c] = from[c] + (to[c] - from[c]) * k / n;
    OK(gh_rve_evaluate(rve, F, A && k == n ? GH_WANT_TANGENT : 0, P, A));
    OK(gh_rve_commit(rve));
  }
}

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
