/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The contact law against differences and its own definition. */
#include "../help.h"

#include "contact/normal.h"

static double length(const double *l, int dim) {
  double sum = 0;
  for (int a = 0; a < dim; a++) sum += l[a] * l[a];
  return sqrt(sum);
}

/* Energy of two grains with the sum of radii `reach`, zero when they do not touch. */
static double energy(double E, double reach, const double *l, int dim) {
  double e = reach - length(l, dim);
  return e >= 0 ? gh_normal_energy(E, e) : 0;
}

/* Force on grain i. */
static void force(double E, double reach, const double *l, int dim, double *f) {
  double d = length(l, dim), factor = gh_normal_factor(E, reach - d, d);
  for (int a = 0; a < dim; a++) f[a] = factor * l[a];
}

/* A branch vector of random direction and overlap; returns the sum of radii. */
static double random_branch(unsigned long long *seed, int dim, double *l) {
  double d = 0;
  while (d < 0.1) {
    for (int a = 0; a < dim; a++) l[a] = 2 * uniform(seed) - 1;
    d = length(l, dim);
  }
  return d * (1 + 0.2 * uniform(seed) + 1e-3);
}

/* The force on grain i is the derivative of the energy with respect to the branch vector, which points away
 * from i. */
static void force_is_the_gradient_of_the_energy(void **state) {
  (void)state;
  unsigned long long seed = 2;
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < 200; trial++)
    for (int dim = 2; dim <= 3; dim++) {
      double l[3], f[3], E = 1 + 1000 * uniform(&seed), reach = random_branch(&seed, dim, l), h = 1e-5;
      force(E, reach, l, dim, f);
      for (int a = 0; a < dim; a++) {
        double up[3], down[3];
        memcpy(up, l, sizeof l), memcpy(down, l, sizeof l);
        up[a] += h, down[a] -= h;
        double slope = (energy(E, reach, up, dim) - energy(E, reach, down, dim)) / (2 * h);
        NEAR("force", f[a], slope, 1e-7 * E);
      }
    }
}

/* The packed second derivative is the central difference of the force, in the plane and in space. */
static void hessian_is_the_derivative_of_the_force(void **state) {
  (void)state;
  unsigned long long seed = 3;
  print_message("seed %llu\n", seed);
  static const int place[2][3][3] = {{{0, 1, -1}, {1, 2, -1}, {-1, -1, -1}},
                                     {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}};
  for (int trial = 0; trial < 200; trial++)
    for (int dim = 2; dim <= 3; dim++) {
      double l[3], h[6], E = 1 + 1000 * uniform(&seed), reach = random_branch(&seed, dim, l), step = 1e-5;
      double d = length(l, dim);
      gh_normal_hessian(E, reach - d, d, l, dim, h);
      for (int b = 0; b < dim; b++) {
        double up[3], down[3], f[2][3];
        memcpy(up, l, sizeof l), memcpy(down, l, sizeof l);
        up[b] += step, down[b] -= step;
        force(E, reach, up, dim, f[0]), force(E, reach, down, dim, f[1]);
        for (int a = 0; a < dim; a++)
          NEAR("hessian", h[place[dim - 2][a][b]], (f[0][a] - f[1][a]) / (2 * step), 1e-6 * E);
      }
    }
}

/* Along the branch the stiffness is E, across it -E e/d: the contact pushes, so it buckles (4.12). */
static void stiffness_along_and_across(void **state) {
  (void)state;
  double l[2] = {3, 4}, h[3];
  gh_normal_hessian(10, 0.5, 5, l, 2, h);
  double along = (h[0] * 9 + 2 * h[1] * 12 + h[2] * 16) / 25,
         across = (h[0] * 16 - 2 * h[1] * 12 + h[2] * 9) / 25;
  double mixed = (-h[0] * 12 + h[1] * (9 - 16) + h[2] * 12) / 25;
  NEAR("along", along, 10, 1e-14);
  NEAR("across", across, -1, 1e-14);
  NEAR("mixed", mixed, 0, 1e-14);
}

/* At first touch energy and force vanish, the stiffness is E n n. */
static void values_at_touch(void **state) {
  (void)state;
  double l[2] = {0.6, 0.8}, h[3];
  assert_true(gh_normal_energy(7, 0) == 0);
  assert_true(gh_normal_factor(7, 0, 1) == 0);
  gh_normal_hessian(7, 0, 1, l, 2, h);
  NEAR("xx", h[0], 7 * 0.36, 1e-15);
  NEAR("xy", h[1], 7 * 0.48, 1e-15);
  NEAR("yy", h[2], 7 * 0.64, 1e-15);
}

/* The two grains push each other apart: the force on i points against the branch vector and is E e. */
static void contact_pushes(void **state) {
  (void)state;
  double l[3] = {1, 2, 2}, f[3];
  force(100, 3.25, l, 3, f);
  for (int a = 0; a < 3; a++) NEAR("force", f[a], -25 * l[a] / 3, 1e-13);
  NEAR("energy", gh_normal_energy(100, 0.25), 3.125, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(force_is_the_gradient_of_the_energy),
                                     cmocka_unit_test(hessian_is_the_derivative_of_the_force),
                                     cmocka_unit_test(stiffness_along_and_across),
                                     cmocka_unit_test(values_at_touch), cmocka_unit_test(contact_pushes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
