/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the extremes of RVEs with friction share. */
#ifndef GRANHOM_TESTS_EXTREME_FRICTION_H
#define GRANHOM_TESTS_EXTREME_FRICTION_H

#include "extreme.h"

static const char section[] = "Friction";
static const char balances[] = "engines, boundary form, symmetry";

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

#endif
