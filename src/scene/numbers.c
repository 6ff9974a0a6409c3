/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What results hold of an integration point, number by number. */
#include "scene/output.h"

/* Difference of the principal values of mean n(x)n over their sum. The sum is 1, but 0 without contacts. */
static double fabric_anisotropy(const gh_rve_measures *m) {
  const double *f = m->fabric;
  double sum = f[0] + f[2];
  return sum > 0 ? hypot(f[0] - f[2], 2 * f[1]) / sum : 0;
}

/* Of the axis of the larger principal value to the x axis, in (-pi/2, pi/2]. */
static double fabric_angle(const gh_rve_measures *m) {
  const double *f = m->fabric;
  return f[1] != 0 || f[0] != f[2] ? 0.5 * atan2(2 * f[1], f[0] - f[2]) : 0;
}

/* name, value, whether its mean over the points of an element has a meaning, what it is */
#define NUMBERS(X)                                                                                           \
  X(energy, m->energy, true, "stored energy per reference area")                                             \
  X(energy_t, m->energy_t, true, "its part in tangential springs and hardening")                             \
  X(dissipation, m->dissipation, true, "dissipated by friction per reference area since the start")          \
  X(coordination, m->coordination, true, "contacts of a grain that is no rattler")                           \
  X(contacts, m->contacts, true, "number of contacts")                                                       \
  X(rattlers, m->rattlers, true, "number of floating grains (rattlers)")                                     \
  X(sliding, m->sliding, true, "contacts on the Coulomb limit")                                              \
  X(residual, m->residual, true,                                                                             \
    "largest unbalanced force on a free grain over the mean normal contact force")                           \
  X(mean_force, m->mean_force, true, "mean normal contact force")                                            \
  X(unjammed, m->unjammed, true, "1: no contact carries a force, P = 0")                                     \
  X(regularised, m->regularised, true, "1: the matrix of the tangent was shifted")                           \
  X(volume_fraction, m->volume_fraction, true, "area of the grains over that of the cell")                   \
  X(fabric_xx, m->fabric[0], true, "mean of n(x)n over the contacts")                                        \
  X(fabric_xy, m->fabric[1], true, "")                                                                       \
  X(fabric_yy, m->fabric[2], true, "")                                                                       \
  X(anisotropy, fabric_anisotropy(m), true,                                                                  \
    "difference of the principal values of the fabric over their sum")                                       \
  X(anisotropy_angle, fabric_angle(m), false, "angle of the larger one to x, radians")                       \
  X(steps, (double)m->steps, true, "relaxation steps of the last evaluation")                                \
  X(factorisations, m->factorisations, true, "factorisations of the last evaluation")                        \
  X(seconds, m->seconds, true, "time of the last evaluation")

#define FUNCTION(name, value, mean, text)                                                                    \
  static double name(const gh_rve_measures *m) {                                                             \
    return value;                                                                                            \
  }
NUMBERS(FUNCTION)

#define ENTRY(name, value, mean, text) {#name, "points/" #name, "cells/" #name, name, mean},
const scene_number scene_numbers[] = {NUMBERS(ENTRY)};
const size_t scene_number_count = sizeof scene_numbers / sizeof *scene_numbers;

#define TERM(name, value, mean, text) {#name, text},
const gh_term scene_number_terms[] = {NUMBERS(TERM){0}};
