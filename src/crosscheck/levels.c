/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A cross-check: the programs, and the differences of their rows. */
#include "crosscheck/crosscheck.h"

const cross_engine cross_engines[GH_CROSS_ENGINES] = {
    {.word = "lammps", .title = "granhom on LAMMPS", .engine = GH_ENGINE_LAMMPS},
    {.word = "native", .title = "granhom native", .engine = GH_ENGINE_NATIVE},
    {.word = "gran", .title = "LAMMPS gran/hooke/history", .peer = true, .kind = GH_PEER_LAMMPS},
    {.word = "liggghts", .title = "LIGGGHTS hooke/stiffness", .peer = true, .kind = GH_PEER_LIGGGHTS}};

const char *gh_cross_word(int engine) {
  return cross_engines[engine].word;
}

const gh_peer_row *cross_row(const cross_level *level, int e, int row) {
  const cross_trace *t = level->trace + e;
  int k = level->path.of_row[row];
  return k < t->result.rows ? t->rows + k : NULL;
}

double cross_scale(const gh_crosscheck *c, const cross_level *level, int e) {
  double scale = 0;
  for (int row = 0; row < c->o.rows; row++) {
    const gh_peer_row *a = cross_row(level, e, row);
    for (int q = 0; a && q < 4; q++) scale = gh_max(scale, fabs(a->cauchy[q]));
  }
  return scale;
}

static double row_difference(const gh_peer_row *a, const gh_peer_row *b) {
  double d = 0;
  if (!a || !b) return NAN;
  for (int q = 0; q < 4; q++) d = gh_max(d, fabs(a->cauchy[q] - b->cauchy[q]));
  return d;
}

double cross_difference(const cross_level *level, int e, int row) {
  return row_difference(cross_row(level, e, row), cross_row(level, 0, row));
}

double cross_worst(const gh_crosscheck *c, const cross_level *level, int e, const cross_level *other, int r,
                   int *row) {
  double worst = 0, scale = cross_scale(c, other, r);
  *row = 0;
  for (int k = 0; k < c->o.rows; k++) {
    double d = row_difference(cross_row(level, e, k), cross_row(other, r, k));
    if (isnan(d)) return NAN;
    if (d > worst) *row = k;
    if (d > worst) worst = d;
  }
  return scale > 0 ? worst / scale : worst;
}

double cross_refined(const gh_crosscheck *c, int k, int e, bool change) {
  int row;
  const cross_level *level = c->level + k;
  if (!change) return cross_worst(c, level, e, level, 0, &row);
  return k > 0 ? cross_worst(c, level, e, level - 1, e, &row) : NAN;
}

double cross_round_off(const gh_crosscheck *c) {
  return 100 * c->o.rve.tolerance;
}
