/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Smallest eigenvalue of the acoustic tensor (method 7). */
#include "granhom/micro.h"

/* Smaller eigenvalue of the symmetric part of Q_ik = A_iJkL N_J N_L for N = (cos a, sin a). */
static double acoustic_eigenvalue(const double A[16], double a) {
  double N[2] = {cos(a), sin(a)}, Q[4] = {0};
  for (int n = 0; n < 16; n++) Q[2 * (n >> 3) + (n >> 1 & 1)] += A[n] * N[n >> 2 & 1] * N[n & 1];
  double q = (Q[1] + Q[2]) / 2;
  return (Q[0] + Q[3]) / 2 - sqrt((Q[0] - Q[3]) * (Q[0] - Q[3]) / 4 + q * q);
}

double gh_acoustic(const double A[16], double *angle) {
  enum { SCAN = 72 };
  const double golden = 0.6180339887498949;
  int best = 0;
  double value[SCAN];
  for (int k = 0; k < SCAN; k++) {
    value[k] = acoustic_eigenvalue(A, GH_PI * k / SCAN);
    if (value[k] < value[best]) best = k;
  }
  double low = GH_PI * (best - 1) / SCAN, high = GH_PI * (best + 1) / SCAN;
  while (high - low > 1e-8) { /* golden section between the neighbours of the smallest */
    double a = high - golden * (high - low), b = low + golden * (high - low);
    if (acoustic_eigenvalue(A, a) < acoustic_eigenvalue(A, b)) high = b;
    else low = a;
  }
  *angle = (low + high) / 2;
  if (*angle < 0) *angle += GH_PI;
  return fmin(acoustic_eigenvalue(A, (low + high) / 2), value[best]);
}
