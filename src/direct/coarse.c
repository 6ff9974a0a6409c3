/* SPDX-License-Identifier: GPL-2.0-or-later */
/* From grains to the mesh: displacements of the nodes by moving least squares, stress of the elements by the
 * part of each branch vector that lies in them. */
#include "direct/internal.h"

#include <string.h>

enum { FIT = 3, FIT_LEAST = 12 }; /* terms of a linear fit; grains that it needs */
static const double fit_near = 6; /* radius of the first try, over the mean radius */

/* Solves the symmetric system M a = b of three equations for two right-hand sides. */
static bool fit_solve(double M[FIT][FIT], double b[FIT][2]) {
  for (int k = 0; k < FIT; k++) {
    if (!(M[k][k] > 1e-10)) return false; /* weights and arms are of order one */
    for (int i = 0; i < FIT; i++) {
      const double f = i == k ? 0 : M[i][k] / M[k][k];
      for (int j = 0; j < FIT && i != k; j++) M[i][j] -= f * M[k][j];
      for (int j = 0; j < 2 && i != k; j++) b[i][j] -= f * b[k][j];
    }
  }
  for (int j = 0; j < 2; j++) b[0][j] /= M[0][0];
  return true;
}

/* Fit of the displacements within a radius; false: there are too few. */
static bool fit_within(const gh_direct *d, const double *x, const double A[2], double radius, double u[2]) {
  double M[FIT][FIT] = {{0}}, b[FIT][2] = {{0}};
  int count = 0;
  for (int q = 0; q < d->n; q++) {
    const double *X = d->body->x + 2 * q, arm[FIT] = {1, (X[0] - A[0]) / radius, (X[1] - A[1]) / radius},
                 r2 = arm[1] * arm[1] + arm[2] * arm[2], w = 1 - r2;
    if (!(w > 0)) continue;
    count++;
    for (int i = 0; i < FIT; i++) {
      for (int j = 0; j < FIT; j++) M[i][j] += w * arm[i] * arm[j];
      for (int j = 0; j < 2; j++) b[i][j] += w * arm[i] * (x[2 * q + j] - X[j]);
    }
  }
  if (count < FIT_LEAST && count < d->n / 2) return false;
  if (!fit_solve(M, b)) return false;
  memcpy(u, b[0], 2 * sizeof *u);
  return true;
}

void direct_fit(const gh_direct *d, const double *x, int node, double u[2]) {
  const double *A = d->mesh->X + 2 * node;
  const double widest = hypot(d->outline.high[0] - d->outline.low[0], d->outline.high[1] - d->outline.low[1]);
  double radius = fit_near * d->mean_radius;
  while (radius < 4 * widest) {
    if (fit_within(d, x, A, radius, u)) return;
    radius *= 1.5;
  }
  const int q = d->nearest[node];
  for (int i = 0; i < 2; i++) u[i] = x[2 * q + i] - d->body->x[2 * q + i];
}

/* ---- elements ---- */

/* The part of the segment x + t l, 0 <= t <= 1, in the convex quadrilateral. */
static double segment_share(const double quad[4][2], const double x[2], const double l[2]) {
  double from = 0, to = 1;
  for (int k = 0; k < 4; k++) {
    const double *A = quad[k], *B = quad[(k + 1) % 4], n[2] = {A[1] - B[1], B[0] - A[0]}; /* inward */
    const double at = n[0] * (x[0] - A[0]) + n[1] * (x[1] - A[1]), slope = n[0] * l[0] + n[1] * l[1];
    if (slope == 0 && at < 0) return 0;
    if (slope > 0) from = fmax(from, -at / slope);
    if (slope < 0) to = fmin(to, -at / slope);
  }
  return to > from ? to - from : 0;
}

static void quad_place(const gh_direct *d, int e, bool current, double quad[4][2]) {
  for (int a = 0; a < 4; a++)
    for (int i = 0; i < 2; i++) {
      const int dof = 2 * d->mesh->quad[e][a] + i;
      quad[a][i] = d->mesh->X[dof] + (current ? d->u[dof] : 0);
    }
}

static double quad_area(const double x[4][2]) {
  return ((x[2][0] - x[0][0]) * (x[3][1] - x[1][1]) - (x[2][1] - x[0][1]) * (x[3][0] - x[1][0])) / 2;
}

gh_status direct_locate(gh_direct *d) {
  for (int q = 0; q < d->n; q++) {
    const double *X = d->body->x + 2 * q;
    double nearest = INFINITY;
    for (int e = 0; e < d->mesh->nelements; e++) {
      double x[4][2], middle[2] = {0, 0};
      quad_place(d, e, false, x);
      for (int a = 0; a < 4; a++)
        for (int i = 0; i < 2; i++) middle[i] += x[a][i] / 4;
      const double off = hypot(X[0] - middle[0], X[1] - middle[1]);
      const bool inside = segment_share((const double(*)[2])x, X, (const double[2]){0, 0}) > 0;
      if (inside || off < nearest) d->element[q] = e, nearest = inside ? -1 : off;
    }
  }
  return GH_OK;
}

static void stress_add(gh_direct *d, int e, double share, const gh_contact *c) {
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) d->cauchy[4 * e + 2 * i + j] += share * c->f[i] * c->l[j];
}

/* What of a contact lies in no element counts for that of its first grain. */
static void contact_spread(gh_direct *d, const gh_contact *c) {
  const double *x = d->now.x + 2 * c->i;
  double rest = 1;
  for (int e = 0; e < d->mesh->nelements && rest > 1e-14; e++) {
    double quad[4][2];
    quad_place(d, e, true, quad);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int a = 0; a < 4; a++)
      for (int i = 0; i < 2; i++) low[i] = fmin(low[i], quad[a][i]), high[i] = fmax(high[i], quad[a][i]);
    bool apart = false;
    for (int i = 0; i < 2; i++)
      apart = apart || fmax(x[i], x[i] + c->l[i]) < low[i] || fmin(x[i], x[i] + c->l[i]) > high[i];
    if (apart) continue;
    const double share = segment_share((const double(*)[2])quad, x, c->l);
    stress_add(d, e, fmin(share, rest), c);
    rest -= fmin(share, rest);
  }
  if (rest > 1e-14) stress_add(d, d->element[c->i], rest, c);
}

void direct_coarsen(gh_direct *d) {
  const int ne = d->mesh->nelements;
  memset(d->cauchy, 0, 4 * (size_t)ne * sizeof *d->cauchy);
  for (int c = 0; c < d->list.count; c++) contact_spread(d, &d->list.contacts[c]);
  for (int e = 0; e < ne; e++) {
    double quad[4][2], grains = 0, contacts = 0;
    quad_place(d, e, true, quad);
    for (int k = 0; k < 4; k++) d->cauchy[4 * e + k] /= quad_area((const double(*)[2])quad);
    for (int q = 0; q < d->n; q++) {
      if (d->element[q] != e || d->rattler[q]) continue;
      grains++, contacts += d->degree[q];
    }
    d->coordination[e] = grains > 0 ? contacts / grains : 0;
  }
}
