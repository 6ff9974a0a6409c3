/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Pairs under relaxation, with and without friction: one array for each of their numbers, so that loops over
 * pairs vectorise, and the sums over the pairs of each grain. */
#ifndef GRANHOM_ENGINE_RELAX_PARTS_H
#define GRANHOM_ENGINE_RELAX_PARTS_H

#include "engine/relax/relax.h"

#include <string.h>

/* What a pair is, and exerts: force on grain i, overlap. Friction adds to both. */
enum { SHIFT_X, SHIFT_Y, REACH, PAIR_GIVEN };
enum { FORCE_X, FORCE_Y, OVERLAP, PAIR_EXERTED };

/* given: PAIR_GIVEN x n or more; i, j: n. */
static inline void gh_pairs_lay_out(const gh_pair *pairs, size_t n, double *given, int *i, int *j) {
  for (size_t p = 0; p < n; p++) {
    const gh_pair *q = &pairs[p];
    given[SHIFT_X * n + p] = q->shift[0];
    given[SHIFT_Y * n + p] = q->shift[1];
    given[REACH * n + p] = q->reach;
    i[p] = q->i, j[p] = q->j;
  }
}

/* Sums the forces of n pairs, and their moments where `moment` is given, over the grains: into f (grains x 2)
 * and couple (grains). Returns the mean overlap. Pairs are sorted by i: that side is summed in registers. */
__attribute__((always_inline)) static inline double
gh_pairs_gather(int grains, size_t n, const int *restrict first, const int *restrict second,
                const double *restrict pair, const double *restrict moment, double *restrict f,
                double *restrict couple) {
  double overlap = 0;
  int contacts = 0;
  memset(f, 0, 2 * (size_t)grains * sizeof *f);
  if (moment) memset(couple, 0, (size_t)grains * sizeof *couple);
  for (size_t p = 0; p < n;) {
    const int i = first[p];
    double fx = 0, fy = 0, m = 0;
    for (; p < n && first[p] == i; p++) {
      const int j = second[p];
      const double px = pair[FORCE_X * n + p], py = pair[FORCE_Y * n + p], e = pair[OVERLAP * n + p];
      fx += px;
      fy += py;
      f[2 * j] -= px;
      f[2 * j + 1] -= py;
      overlap += e >= 0 ? e : 0;
      contacts += e >= 0;
      if (!moment) continue;
      m += moment[p];
      couple[j] += moment[p];
    }
    f[2 * i] += fx;
    f[2 * i + 1] += fy;
    if (moment) couple[i] += m;
  }
  return contacts ? overlap / contacts : 0;
}

#endif
