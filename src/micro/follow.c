/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Newton first: equilibrium straight from the start of an evaluation, without relaxation (method 3).
 *
 * Without friction an increment without instability is one branch, smooth but for contacts that open and close.
 * Newton with the contacts of each iterate follows it, in one part or in halves of what it could not do at once.
 * It counts only where every stiffness on the way is positive definite, all steps stay small, and the residual
 * falls. Else relaxation decides on the branch, from the start. */
#include "micro/internal.h"

#include <string.h>

/* Measured in docs/reports/performance.md, "Newton first". */
static const struct follow_rule {
  int factors;     /* spent at most */
  int patience;    /* steps without half the residual */
  double least;    /* length of a part, of the increment */
  double nearly;   /* residual at the end of a part that is not the last */
  double farthest; /* step of a grain over the mean radius */
} rule = {.factors = 6, .patience = 2, .least = 0.125, .nearly = 1e-3, .farthest = 0.05};

static bool step_is_small(const gh_rve *r) {
  double largest = 0;
  for (int i = 0; i < r->n; i++) {
    const double step = hypot(r->step[2 * i] - r->x[2 * i], r->step[2 * i + 1] - r->x[2 * i + 1]);
    if (!(step <= largest)) largest = step; /* NaN stays */
  }
  return largest <= rule.farthest * r->mean_radius;
}

/* Newton's iteration from the engine's positions, which r->x has, to the residual `aim`. */
static gh_status part_iterate(gh_rve *r, double aim, int *factors, bool *reached) {
  double best = INFINITY;
  gh_rve_newton_begin(r);
  GH_TRY(gh_rve_update_contacts(r));
  *reached = !r->m.unjammed && r->m.residual <= fmax(aim, gh_rve_target(r));
  for (int since = 0; !*reached && since <= rule.patience && !r->m.unjammed && *factors < rule.factors;) {
    bool definite;
    ++*factors;
    GH_TRY(gh_rve_newton_direction(r, &definite));
    if (!definite || !step_is_small(r)) return GH_OK;
    GH_TRY(gh_engine_move(r->engine, r->step, NULL));
    GH_TRY(gh_rve_update_contacts(r));
    memcpy(r->x, r->step, 2 * (size_t)r->n * sizeof(double));
    *reached = !r->m.unjammed && r->m.residual <= fmax(aim, gh_rve_target(r));
    since = r->m.residual <= 0.5 * best ? 0 : since + 1;
    best = fmin(best, r->m.residual);
  }
  return GH_OK;
}

/* The engine at `to`, with the fluctuations of the positions r->x0 at `from`; fixed members follow F. */
static gh_status part_set(gh_rve *r, const gh_start *b, const double from[4], const double to[4]) {
  const double start = gh_seconds();
  double inverse[4], f[4], cell[4];
  gh_inv2(from, inverse);
  gh_mul2(to, inverse, f);
  for (int i = 0; i < r->n; i++) {
    if (r->held && r->held[i]) gh_apply2(to, &b->y[2 * i], &r->x[2 * i]);
    else gh_apply2(f, &r->x0[2 * i], &r->x[2 * i]);
  }
  gh_mul2(to, r->lattice, cell);
  GH_TRY(gh_engine_set(r->engine, cell, r->x, NULL));
  r->cost.set += gh_seconds() - start;
  return GH_OK;
}

/* A few steps of relaxation reach a loose tolerance without a factor. Frames: not tried. */
static bool rve_may_follow(const gh_rve *r) {
  return !gh_rve_friction(r) && !r->frame && r->relaxes && r->options.relaxation == GH_RELAX_POLISHED &&
         r->options.tolerance < gh_rve_first_relaxation;
}

gh_status gh_rve_follow(gh_rve *r, const gh_start *b, bool *reached) {
  int factors = 0;
  double done = 0, length = 1, from[4], to[4];
  *reached = false;
  if (!rve_may_follow(r)) return GH_OK;
  memcpy(from, b->F, sizeof from);
  for (int i = 0; i < r->n; i++) gh_apply2(from, &b->y[2 * i], &r->x0[2 * i]);
  while (!*reached && factors < rule.factors && length >= rule.least) {
    const double next = fmin(1, done + length);
    bool there;
    for (int k = 0; k < 4; k++) to[k] = next < 1 ? b->F[k] + next * (r->F[k] - b->F[k]) : r->F[k];
    GH_TRY(part_set(r, b, from, to));
    GH_TRY(part_iterate(r, next < 1 ? rule.nearly : 0, &factors, &there));
    r->m.events += !there || next < 1;
    *reached = there && next >= 1;
    length *= there ? 2 : 0.5;
    if (!there) continue;
    done = next;
    memcpy(from, to, sizeof from);
    memcpy(r->x0, r->x, 2 * (size_t)r->n * sizeof(double));
  }
  r->m.newton = r->m.polished = *reached;
  return GH_OK;
}
