/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Lets the cell of a packing relax under a pressure.
 *
 * The equilibrium of grains and cell under the pressure p is a minimum of the enthalpy W(F) + p det F, W the
 * energy of the relaxed grains per reference area. Its gradient is P + p cof F, its second derivative A + p d
 * cof F / dF. Newton's method with the Hessian shifted until it is positive definite, and steps that lower
 * the enthalpy: the end is a minimum also where the packing rearranges on the way. At a minimum a(x)N : A :
 * a(x)N >= 0 for all a, N, for det F does not curve along a(x)N: no acoustic tensor has a negative
 * eigenvalue. */
#include "prepare/finish.h"

#include <string.h>

static const double stress_tolerance = 1e-7; /* of the deviation from -p 1, over p */
enum { MOST_STEPS = 400 };

/* The unknowns: F11, F12, F22. */
static const int at[3] = {0, 1, 3};

static double enthalpy(const double F[4], double energy, double p) {
  return energy + p * gh_det2(F);
}

/* Returns the length. */
static double gradient(const double F[4], const double P[4], double p, double g[3]) {
  const double cof[4] = {F[3], -F[2], -F[1], F[0]};
  for (int a = 0; a < 3; a++) g[a] = P[at[a]] + p * cof[at[a]];
  return sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
}

/* Solves (H + shift 1) d = -g by Cholesky's method; false when the matrix is not positive definite. */
static bool solve(const double H[9], double shift, const double g[3], double d[3]) {
  double L[9] = {0};
  for (int a = 0; a < 3; a++)
    for (int b = 0; b <= a; b++) {
      double sum = H[3 * a + b] + (a == b ? shift : 0);
      for (int k = 0; k < b; k++) sum -= L[3 * a + k] * L[3 * b + k];
      if (a == b && !(sum > 1e-12 * (fabs(H[3 * a + a]) + shift))) return false;
      L[3 * a + b] = a == b ? sqrt(sum) : sum / L[3 * b + b];
    }
  for (int a = 0; a < 3; a++) {
    d[a] = -g[a];
    for (int k = 0; k < a; k++) d[a] -= L[3 * a + k] * d[k];
    d[a] /= L[3 * a + a];
  }
  for (int a = 2; a >= 0; a--) {
    for (int k = a + 1; k < 3; k++) d[a] -= L[3 * k + a] * d[k];
    d[a] /= L[3 * a + a];
  }
  return true;
}

/* A direction that descends, no longer than `longest`. */
static void direction(const finish_job *j, double p, const double g[3], double longest, double d[3]) {
  double H[9], shift = 0, size = 0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      H[3 * a + b] = (j->A[4 * at[a] + at[b]] + j->A[4 * at[b] + at[a]]) / 2;
      if (a + b == 2 && a != b) H[3 * a + b] += p; /* d2 det / dF11 dF22 */
      size = gh_max(size, fabs(H[3 * a + b]));
    }
  while (!solve(H, shift, g, d)) {
    shift = shift > 0 ? 4 * shift : 1e-3 * size;
    if (shift > 0 && shift <= 1e6 * size) continue;
    d[0] = d[1] = d[2] = 0; /* a tangent that is zero or not finite: there is no direction */
    return;
  }
  double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (int a = 0; a < 3 && length > longest; a++) d[a] *= longest / length;
}

/* One step along d, shortened until the enthalpy falls (or, where it cannot tell any more, the gradient).
 * *moved: there was such a step, and it has been taken. */
static gh_status descend(finish_job *j, double p, const double g[3], const double d[3], bool *moved) {
  double before = enthalpy(j->F, j->energy, p), slope = 0,
         length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  for (int a = 0; a < 3; a++) slope += g[a] * d[a];
  *moved = false;
  for (double t = 1; t > 1e-7; t /= 2) {
    double F[4], next[3];
    bool found;
    memcpy(F, j->F, sizeof F);
    for (int a = 0; a < 3; a++) F[at[a]] += t * d[a];
    if (!(gh_det2(F) > 0)) continue;
    GH_TRY(finish_try(j, F, true, &found));
    if (!found) continue;
    double after = enthalpy(j->trial_F, j->trial_energy, p), now = gradient(F, j->trial_P, p, next);
    bool lower = after <= before + 1e-4 * t * slope, flat = fabs(after - before) <= 1e-13 * fabs(before);
    if (!lower && !(flat && now <= length / 2)) continue;
    *moved = true;
    return finish_take(j);
  }
  return GH_OK;
}

static double deviation(const finish_job *j, double p) {
  const double *s = j->now.cauchy;
  return gh_max(gh_max(fabs(s[0] + p), fabs(s[3] + p)), gh_max(fabs(s[1]), fabs(s[2]))) / p;
}

gh_status finish_relax_cell(finish_job *j, double p) {
  bool found;
  GH_TRY(finish_try(j, j->F, true, &found)); /* the tangent of the state as it is */
  if (found) GH_TRY(finish_take(j));
  for (int step = 0; step < MOST_STEPS && found && !(deviation(j, p) <= stress_tolerance); step++) {
    double g[3], d[3], overlap = fmax(j->now.overlap, p / j->options->normal_stiffness);
    bool moved;
    gradient(j->F, j->P, p, g);
    direction(j, p, g, fmin(overlap, 0.01), d);
    GH_TRY(descend(j, p, g, d, &moved));
    if (!moved) break;
  }
  if (found && deviation(j, p) <= j->options->accuracy) return GH_OK;
  return gh_fail(
      j->ctx, GH_DIVERGED,
      "the cell finds no rest under the pressure %g: the stress is off by %.3g %% after %d equilibria", p,
      100 * deviation(j, p), j->evaluations);
}
