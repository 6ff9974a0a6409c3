/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Packings with friction that the tests of ramps share. */
#ifndef GRANHOM_TESTS_RAMP_HELP_H
#define GRANHOM_TESTS_RAMP_HELP_H

#include "../help.h"

enum { MOST = 150, MOST_SLIPS = 3000, ENGINES = 2 };

static const gh_engine_kind KINDS[ENGINES] = {GH_ENGINE_NATIVE, GH_ENGINE_LAMMPS};
static const double E = 100;

/* A packing and its history. */
typedef struct sample {
  int n, nslips;
  bool periodic;
  gh_contact_law law;
  unsigned char held[MOST];
  double radius[MOST], cell[4], x[2 * MOST], theta[MOST];
  gh_slip slips[MOST_SLIPS];
} sample;

static inline gh_engine *make_engine(gh_context *ctx, const sample *s, gh_engine_kind kind) {
  gh_engine *e;
  const gh_engine_setup setup = {
      .n = s->n, .radius = s->radius, .held = s->held, .periodic = s->periodic, .law = s->law};
  OK(gh_engine_create(ctx, kind, &setup, &e));
  return e;
}

/* The sample is state n, and where the engine is. */
static inline void put(gh_context *ctx, gh_engine *e, const sample *s) {
  gh_converged n = {.x = s->x, .theta = s->theta, .slips = s->slips, .nslips = s->nslips};
  memcpy(n.cell, s->cell, sizeof n.cell);
  OK(gh_engine_begin(e, &n));
  OK(gh_engine_set(e, s->cell, s->x, s->theta));
}

static inline gh_ramp ramp_to(const double to[4], long steps, double tolerance) {
  gh_ramp r = {.steps = steps, .tolerance = tolerance, .max_steps = steps + 100000};
  memcpy(r.to, to, sizeof r.to);
  return r;
}

/* 1 + share (to - 1) */
static inline void part_of(const double to[4], double share, double G[4]) {
  for (int k = 0; k < 4; k++) G[k] = (k % 3 ? 0 : 1) + share * (to[k] - (k % 3 ? 0 : 1));
}

static inline int order(const gh_slip *a, const gh_slip *b) {
  const int ka[4] = {a->i, a->j, a->image[1], a->image[0]}, kb[4] = {b->i, b->j, b->image[1], b->image[0]};
  for (int k = 0; k < 4; k++)
    if (ka[k] != kb[k]) return ka[k] < kb[k] ? -1 : 1;
  return 0;
}

/* The same contacts with the same history. Slip that is nothing but rounding may be on one side only. */
static inline void assert_same_slips(const gh_slip *a, int na, const gh_slip *b, int nb, double tolerance) {
  static const gh_slip none = {0};
  for (int p = 0, q = 0; p < na || q < nb;) {
    const int way = p == na ? 1 : q == nb ? -1 : order(&a[p], &b[q]);
    const gh_slip *s = way <= 0 ? &a[p++] : &none, *t = way >= 0 ? &b[q++] : &none;
    NEAR("gamma", s->gamma, t->gamma, tolerance);
    NEAR("gamma_pl", s->gamma_pl, t->gamma_pl, tolerance);
    NEAR("alpha", s->alpha, t->alpha, tolerance);
  }
}

#endif
