/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Scales the cell of a packing until overlap or pressure is the wanted one.
 *
 * The goal is approached from the compressed side, where the packing is jammed: first the cell shrinks until
 * the value lies above the target, then it grows by secants. A trial that falls short, unjams or finds no
 * equilibrium is dropped and bounds the step. A packing that rearranges may snap past the target; then the
 * state before the instability is taken and compressed again. */
#include "prepare/finish.h"

static const double longest_step = 0.01;            /* of the cell's size, at once */
enum { MOST_EVALUATIONS = 2000, MOST_ROUNDS = 50 }; /* of one call */

/* The target as a mean overlap over the mean radius. A plane packing of N grains that fills 0.84 of the cell
 * has about 2 N contacts, so that p = 2 N E e R / V = 0.53 E e / R. */
static double as_overlap(const finish_job *j, double value) {
  const gh_finish_options *o = j->options;
  return o->goal == GH_FINISH_OVERLAP ? value : value / (0.53 * o->normal_stiffness);
}

static gh_status try_scaled(finish_job *j, double scale, double *value) {
  double F[4] = {scale * j->F[0], scale * j->F[1], 0, scale * j->F[3]};
  bool found;
  GH_TRY(finish_try(j, F, false, &found));
  *value = found ? finish_value(j, &j->trial) : NAN;
  return GH_OK;
}

static bool meets(const finish_job *j, double value) {
  const gh_finish_options *o = j->options;
  return fabs(value - o->target) <= o->accuracy * o->target;
}

static gh_status too_many(finish_job *j) {
  const gh_finish_options *o = j->options;
  return gh_fail(
      j->ctx, GH_DIVERGED,
      "the %s %g cannot be met within %.3g %%: after %d equilibria it is %g at the volume fraction %g",
      o->goal == GH_FINISH_OVERLAP ? "mean overlap" : "pressure", o->target, 100 * o->accuracy,
      j->evaluations, finish_value(j, &j->now), j->now.volume_fraction);
}

/* Shrinks the cell until the value is above the target or meets it. */
static gh_status compress(finish_job *j, int last) {
  double target = j->options->target, step = fmin(as_overlap(j, target) / 2, longest_step);
  bool failed = false;
  for (double value = finish_value(j, &j->now); value < target && !meets(j, value);) {
    if (j->evaluations >= last) return too_many(j);
    double trial, missing = as_overlap(j, target - value);
    if (value > 0 && !failed) step = fmin(0.6 * missing + 1e-3 * as_overlap(j, target), longest_step);
    GH_TRY(try_scaled(j, 1 - step, &trial));
    failed = isnan(trial);
    if (failed || trial == 0) step = fmin(1.5 * step, longest_step);
    if (failed) continue; /* from where it was, but further */
    GH_TRY(finish_take(j));
    value = trial;
  }
  return GH_OK;
}

/* The next growth of the cell: by the slope, and well inside the bracket. */
static double next_growth(const finish_job *j, double value, double slope, double limit) {
  double target = j->options->target, least = 1e-4 * as_overlap(j, target);
  double growth = isnan(slope) ? as_overlap(j, value - target) / 2 : (value - target) / slope;
  growth = fmin(fmax(growth, least), longest_step);
  return growth < 0.8 * limit ? growth : limit / 2;
}

/* Takes the state `growth` further, which lies below the target, or, where there is no equilibrium, one that
 * is compressed a little. */
static gh_status leap(finish_job *j, double growth) {
  double value;
  GH_TRY(try_scaled(j, 1 + growth, &value));
  if (isnan(value)) GH_TRY(try_scaled(j, 1 - 0.1 * as_overlap(j, j->options->target), &value));
  return isnan(value) ? too_many(j) : finish_take(j);
}

/* From a value above the target: lets the cell grow until it is met. Not met: an instability leads past the
 * target, and the packing is post-instability. `limit`: the growth that is known to lead below the target. */
static gh_status decompress(finish_job *j, int last, bool *met) {
  double target = j->options->target, value = finish_value(j, &j->now), slope = NAN, limit = INFINITY;
  for (*met = true; !meets(j, value);) {
    if (j->evaluations >= last) return too_many(j);
    if (limit < 1e-3 * as_overlap(j, target)) {
      *met = false;
      return leap(j, limit);
    }
    double growth = next_growth(j, value, slope, limit), trial;
    GH_TRY(try_scaled(j, 1 + growth, &trial));
    if (trial >= target || meets(j, trial)) {
      slope = trial < value ? (value - trial) / growth : NAN;
      limit -= growth;
      value = trial;
      GH_TRY(finish_take(j));
    } else {
      limit = growth;
      slope = NAN;
    }
  }
  return GH_OK;
}

gh_status finish_scale(finish_job *j) {
  int last = j->evaluations + MOST_EVALUATIONS;
  for (int round = 0; round < MOST_ROUNDS; round++) {
    bool met;
    GH_TRY(compress(j, last));
    GH_TRY(decompress(j, last, &met));
    if (met) return GH_OK;
  }
  return too_many(j);
}
