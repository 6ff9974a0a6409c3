/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Matrices of order four, row-major. */
#ifndef GRANHOM_CONTROL_FOUR_H
#define GRANHOM_CONTROL_FOUR_H

#include "granhom/base.h"

#include <string.h>

/* X = A^-1 B for `columns` columns of B (row-major, 4 x columns, at most 4), by elimination with pivots
 * chosen among rows of equal size; false when A is singular to within 1e-12. */
static inline bool gh_four_solve(const double A[16], int columns, const double *B, double *X) {
  double M[4][8];
  for (int r = 0; r < 4; r++) {
    double largest = 0;
    for (int c = 0; c < 4; c++) largest = gh_max(largest, fabs(A[4 * r + c]));
    if (!(largest > 0) || !isfinite(largest)) return false;
    for (int c = 0; c < 4; c++) M[r][c] = A[4 * r + c] / largest;
    for (int c = 0; c < columns; c++) M[r][4 + c] = B[columns * r + c] / largest;
  }
  for (int k = 0; k < 4; k++) {
    int pivot = k;
    for (int r = k + 1; r < 4; r++)
      if (fabs(M[r][k]) > fabs(M[pivot][k])) pivot = r;
    if (!(fabs(M[pivot][k]) > 1e-12)) return false;
    double swap[8];
    memcpy(swap, M[k], sizeof swap);
    memcpy(M[k], M[pivot], sizeof swap);
    memcpy(M[pivot], swap, sizeof swap);
    for (int r = 0; r < 4; r++) {
      double factor = r == k ? 0 : M[r][k] / M[k][k];
      for (int c = k; c < 4 + columns; c++) M[r][c] -= factor * M[k][c];
    }
  }
  for (int r = 0; r < 4; r++)
    for (int c = 0; c < columns; c++) X[columns * r + c] = M[r][4 + c] / M[r][r];
  return true;
}

/* Whether all eigenvalues of B + shift 1 have a positive real part: the characteristic polynomial by
 * Faddeev and LeVerrier, its roots by Routh and Hurwitz. */
static inline bool gh_four_stable(const double B[16], double shift) {
  double S[16], N[16] = {0}, c[5] = {1}; /* det(x 1 + S) = x^4 + c1 x^3 + ... + c4 */
  memcpy(S, B, sizeof S);
  for (int a = 0; a < 4; a++) S[5 * a] += shift;
  for (int k = 1; k <= 4; k++) {
    double next[16], trace = 0;
    for (int a = 0; a < 16; a++) { /* N_k = S N_(k-1) + c_(k-1) 1 with the signs of det(x 1 - (-S)) */
      double sum = 0;
      for (int m = 0; m < 4; m++) sum -= S[4 * (a / 4) + m] * N[4 * m + a % 4];
      next[a] = sum + (a % 5 == 0 ? c[k - 1] : 0);
    }
    memcpy(N, next, sizeof N);
    for (int a = 0; a < 4; a++)
      for (int m = 0; m < 4; m++) trace -= S[4 * a + m] * N[4 * m + a];
    c[k] = -trace / k;
  }
  return c[1] > 0 && c[2] > 0 && c[3] > 0 && c[4] > 0 &&
         c[1] * c[2] * c[3] > c[3] * c[3] + c[1] * c[1] * c[4];
}

#endif
