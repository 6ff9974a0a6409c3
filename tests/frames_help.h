/* SPDX-License-Identifier: GPL-2.0-or-later */
/* RVEs on a frame, for the tests of its conditions. */
#ifndef GRANHOM_TESTS_FRAMES_HELP_H
#define GRANHOM_TESTS_FRAMES_HELP_H

#include "help.h"

#include "micro/internal.h"

/* The conditions on a frame, and mixed ones of all kinds. */
typedef struct condition {
  const char *name, *mixed;
} condition;
static const condition CONDITIONS[] = {{"displacement", NULL},
                                       {"frame-periodic", NULL},
                                       {"traction", NULL},
                                       {"mixed", "x=traction,y=displacement"},
                                       {"mixed", "x=periodic,y=traction"},
                                       {"mixed", "x=displacement,y=periodic"}};
enum { NCONDITIONS = sizeof CONDITIONS / sizeof *CONDITIONS, DISPLACEMENT = 0, PERIODIC, TRACTION };
static const gh_engine_kind KINDS[] = {GH_ENGINE_NATIVE, GH_ENGINE_LAMMPS};
static const double E = 1000;

typedef enum law { SMOOTH, ROUGH, RIGID, LAWS } law; /* RIGID: friction, rotations fixed */

static inline gh_rve_options options(gh_context *ctx, const condition *c, gh_engine_kind engine, law l) {
  gh_rve_options o = rve_options(engine, GH_PERIODIC, E, 1e-11);
  assert_true(gh_boundary_from_name(c->name, &o.boundary));
  if (c->mixed) OK(gh_mixed_read(ctx, c->mixed, o.mixed));
  if (l == SMOOTH) return o;
  o.law.friction = 1;
  o.law.tangential_stiffness = 0.5 * E;
  o.law.friction_coefficient = 0.4;
  o.law.fixed_rotations = l == RIGID;
  o.law.slip = GH_SLIP_OBJECTIVE;
  return o;
}

static inline gh_rve *open_rve(gh_context *ctx, const gh_packing *p, const gh_rve_options *o) {
  gh_rve *r;
  OK(gh_rve_create(ctx, p, o, &r));
  return r;
}

/* Compression with shear. */
static inline void deformation(double s, double F[4]) {
  F[0] = 1 - s, F[1] = 0.3 * s, F[2] = -0.1 * s, F[3] = 1 - 0.8 * s;
}

/* To some compression, in steps that are committed. */
static inline void compress(gh_context *ctx, gh_rve *r, double s, int steps) {
  double F[4], P[4];
  for (int k = 1; k <= steps; k++) {
    deformation(s * k / steps, F);
    OK(gh_rve_evaluate(r, F, 0, P, NULL));
    OK(gh_rve_commit(r));
  }
}

/* A triangular lattice of grains that just touch, with radii that are smaller by up to `noise`. */
static inline gh_packing *triangular(gh_context *ctx, double noise) {
  enum { SIDE = 4, N = 2 * SIDE * SIDE };
  const double h = sqrt(3), cell[4] = {2 * SIDE, 0, 0, 2 * h * SIDE};
  double radius[N], x[2 * N];
  unsigned long long seed = 7;
  for (int k = 0; k < N; k++) {
    radius[k] = 1 - noise * uniform(&seed);
    x[2 * k] = 2 * (k % SIDE) + (k / SIDE % 2) + 0.3;
    x[2 * k + 1] = h * (k / SIDE) + 0.2;
  }
  return make_packing(ctx, N, cell, radius, x);
}

/* Grains under uniform traction without friction are pushed between each other in most packings, which then have no
 * stress: a lattice has one. */
static inline gh_packing *sample(gh_context *ctx, const condition *c, law l) {
  const bool traction = !strcmp(c->name, "traction") || (c->mixed && strstr(c->mixed, "traction"));
  return l == SMOOTH && traction ? triangular(ctx, 0.005) : case_packing(ctx, "p50d");
}

#endif
