/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the extremes of RVEs with friction share. */
#ifndef GRANHOM_TESTS_EXTREME_FRICTION_H
#define GRANHOM_TESTS_EXTREME_FRICTION_H

#include "extreme.h"

static const char section[] = "Friction";
static const char balances[] = "engines, boundary form, symmetry";
static const double I[4] = {1, 0, 0, 1}, press[4] = {0.98, 0.005, 0.002, 0.985};

/* E_t = 0.8 E_n. */
static inline gh_contact_law law_of(double E, double degrees, double hardening) {
  return (gh_contact_law){.normal_stiffness = E,
                          .friction = 1,
                          .tangential_stiffness = 0.8 * E,
                          .friction_coefficient = tan(degrees * help_pi / 180),
                          .hardening = hardening};
}

static inline gh_rve *open_rve(gh_context *ctx, const gh_packing *p, gh_engine_kind e, gh_boundary b,
                               gh_contact_law law) {
  gh_rve_options o = gh_rve_defaults();
  gh_rve *rve;
  o.boundary = b, o.engine = e, o.law = law, o.tolerance = 1e-11;
  OK(gh_rve_create(ctx, p, &o, &rve));
  return rve;
}

static inline void step(gh_context *ctx, gh_rve *rve, const double F[4], double P[4], double *A) {
  OK(gh_rve_evaluate(rve, F, A ? GH_WANT_TANGENT : 0, P, A));
  OK(gh_rve_commit(rve));
}

/* From one deformation to another in n equal steps. */
static inline void walk(gh_context *ctx, gh_rve *rve, const double from[4], const double to[4], int n,
                        double P[4], double *A) {
  double F[4];
  for (int k = 1; k <= n; k++) {
    for (int c = 0; c < 4; c++) F[c] = from[c] + (to[c] - from[c]) * k / n;
    step(ctx, rve, F, P, k == n ? A : NULL);
  }
}

#endif
