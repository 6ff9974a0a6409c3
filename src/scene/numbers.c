/* What results tell of a material point, number by number. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/results.h"

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

/* name, value, whether its mean over the points of an element has a meaning */
#define NUMBERS(X)                                                                                           \
  X(energy, m->energy, true)                                                                                 \
  X(energy_t, m->energy_t, true)                                                                             \
  X(dissipation, m->dissipation, true)                                                                       \
  X(coordination, m->coordination, true)                                                                     \
  X(contacts, m->contacts, true)                                                                             \
  X(rattlers, m->rattlers, true)                                                                             \
  X(sliding, m->sliding, true)                                                                               \
  X(residual, m->residual, true)                                                                             \
  X(mean_force, m->mean_force, true)                                                                         \
  X(unjammed, m->unjammed, true)                                                                             \
  X(regularised, m->regularised, true)                                                                       \
  X(volume_fraction, m->volume_fraction, true)                                                               \
  X(fabric_xx, m->fabric[0], true)                                                                           \
  X(fabric_xy, m->fabric[1], true)                                                                           \
  X(fabric_yy, m->fabric[2], true)                                                                           \
  X(anisotropy, fabric_anisotropy(m), true)                                                                  \
  X(anisotropy_angle, fabric_angle(m), false)                                                                \
  X(steps, (double)m->steps, true)                                                                           \
  X(factorisations, m->factorisations, true)                                                                 \
  X(seconds, m->seconds, true)

#define FUNCTION(name, value, mean)                                                                          \
  static double name(const gh_rve_measures *m) {                                                             \
    return value;                                                                                            \
  }
NUMBERS(FUNCTION)

#define ENTRY(name, value, mean) {#name, name, mean},
const scene_number scene_numbers[] = {NUMBERS(ENTRY)};
const size_t scene_number_count = sizeof scene_numbers / sizeof *scene_numbers;
