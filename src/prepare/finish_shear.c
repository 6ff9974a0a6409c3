/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Pre-strains a packing until its fabric anisotropy is the wanted one.
 *
 * Small pure shears in steps, each settled again to the wanted overlap or pressure. Shortening along the
 * major axis of the fabric adds contacts there and raises the anisotropy; shortening across it lowers it. The
 * step is halved when the anisotropy has passed the wanted one. */
#include "prepare/finish.h"

#include <string.h>

static const double most_strain = 2, idle_strain = 0.4; /* in all; without coming nearer */
enum { ATTEMPTS = 8 };

/* A fabric that has been strained yields now and then and is most anisotropic just before, so that steps must
 * be shorter than the strain that a packing bears elastically, which goes with its overlap. A cell that
 * relaxes takes such strains back: there, steps may grow until the grains rearrange. */
static double first_step(const finish_job *j) {
  return fmin(fmax(0.25 * j->now.overlap, 1e-4), 4e-3);
}

static double longest_step(const finish_job *j) {
  return finish_relaxes(j->options) ? 0.05 : first_step(j);
}

/* Shears F at constant area, so that directions at `angle` shorten by `amount`. The increment has the
 * symmetric part of the shear and the rotation that keeps F upper triangular. */
static void shear(double angle, double amount, double F[4]) {
  double c = -amount * cos(2 * angle), s = -amount * sin(2 * angle), V[4] = {1 + c, 2 * s, 0, 1 - c};
  double size = sqrt(gh_det2(V));
  for (int k = 0; k < 4; k++) V[k] /= size;
  gh_mul2(V, F, F);
}

/* One shear; when there is no equilibrium, a shorter one. */
static gh_status strain(finish_job *j, double angle, double amount) {
  bool found = false;
  for (int attempt = 0; attempt < ATTEMPTS && !found; attempt++, amount /= 2) {
    double F[4];
    memcpy(F, j->F, sizeof F);
    shear(angle, amount, F);
    GH_TRY(finish_try(j, F, false, &found));
  }
  if (!found)
    return gh_fail(j->ctx, GH_DIVERGED, "no equilibrium after a shear of %g on the way to the anisotropy %g",
                   amount, j->options->anisotropy);
  return finish_take(j);
}

gh_status finish_shear(finish_job *j, gh_status (*settle)(finish_job *j)) {
  const gh_finish_options *o = j->options;
  double spent = 0, nearest = j->now.anisotropy, nearest_at = 0, step = first_step(j);
  gh_work work;
  gh_work_begin(j->ctx, &work, "pre-strain", "equilibria", INFINITY);
  while (spent < most_strain && spent - nearest_at < idle_strain) {
    double missing = o->anisotropy - j->now.anisotropy;
    if (fabs(missing) <= o->anisotropy_accuracy) break;
    GH_TRY(strain(j, j->now.anisotropy_angle, missing > 0 ? step : -step));
    GH_TRY(settle(j));
    spent += step;
    double now_missing = o->anisotropy - j->now.anisotropy;
    if (fabs(now_missing) < fabs(o->anisotropy - nearest)) nearest = j->now.anisotropy, nearest_at = spent;
    step = now_missing * missing < 0 ? fmax(step / 2, 1e-5) : fmin(1.2 * step, longest_step(j));
    gh_work_advance(j->ctx, &work, j->evaluations);
  }
  gh_work_end(j->ctx, &work, j->evaluations);
  j->strain = spent;
  if (fabs(o->anisotropy - j->now.anisotropy) <= o->anisotropy_accuracy) return GH_OK;
  return gh_fail(j->ctx, GH_DIVERGED,
                 "the fabric anisotropy %g cannot be met: the nearest is %.4f after a shear of %.3g in all",
                 o->anisotropy, nearest, spent);
}
