/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Contacts that the copies of grains on a frame share, and the constraint of uniform traction on it: inline, for
 * relaxation and for the RVE. */
#ifndef GRANHOM_CONTACT_FRAME_H
#define GRANHOM_CONTACT_FRAME_H

#include "granhom/base.h"

/* Share of a contact between two grains on these edges, a bit each: half for each edge that they have in common. */
static inline double gh_frame_share(unsigned edges_i, unsigned edges_j) {
  double share = 1;
  for (unsigned common = edges_i & edges_j; common; common &= common - 1) share *= 0.5;
  return share;
}

/* Of sum area (x) area, areas n x 2: its inverse, on what the areas span where they are parallel; its axes as rows;
 * returns how many directions the areas span. */
static inline int gh_frame_invert(int n, const double *area, double inverse[4], double axes[4]) {
  double sum[4] = {0, 0, 0, 0};
  int rank = 0;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 4; k++) sum[k] += area[2 * i + k / 2] * area[2 * i + k % 2];
  const double turn = 0.5 * atan2(2 * sum[1], sum[0] - sum[3]), c = cos(turn), s = sin(turn);
  axes[0] = axes[3] = c, axes[1] = s, axes[2] = -s; /* the axis of the larger value comes first */
  for (int k = 0; k < 4; k++) inverse[k] = 0;
  for (int a = 0; a < 2; a++) {
    const double *e = axes + 2 * a, value = e[0] * (sum[0] * e[0] + 2 * sum[1] * e[1]) + sum[3] * e[1] * e[1];
    if (!(value > 1e-12 * (sum[0] + sum[3]))) break;
    for (int k = 0; k < 4; k++) inverse[k] += e[k / 2] * e[k % 2] / value;
    rank++;
  }
  return rank;
}

/* Takes the part of the forces (n x 2) along the constraint sum x (x) area = const away. */
static inline void gh_frame_project(const double *area, const double inverse[4], int n, double *force) {
  double sum[4] = {0, 0, 0, 0}, along[4];
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 4; k++) sum[k] += force[2 * i + k / 2] * area[2 * i + k % 2];
  gh_mul2(sum, inverse, along);
  for (int i = 0; i < n; i++) {
    double part[2];
    gh_apply2(along, &area[2 * i], part);
    for (int k = 0; k < 2; k++) force[2 * i + k] -= part[k];
  }
}

#endif
