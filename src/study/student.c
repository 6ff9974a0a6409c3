/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Student's distribution. */
#include "study/internal.h"

/* Probability of |t| < sqrt(n) tan(angle) with n degrees of freedom: the finite sums of Abramowitz and
 * Stegun, 26.7.3 and 26.7.4. */
static double student_within(int n, double angle) {
  double c = cos(angle), s = sin(angle), term = n % 2 ? c : 1, sum = n == 1 ? 0 : term;
  for (int k = n % 2 ? 3 : 2; k < n; k += 2) {
    term *= c * c * (k - 1) / k;
    sum += term;
  }
  return n % 2 ? 0.63661977236758134308 * (angle + s * sum) : s * sum;
}

double study_student(int freedom) {
  if (freedom < 1) return NAN;
  double low = 0, high = 1.57079632679489661923;
  for (int k = 0; k < 100; k++) {
    double middle = 0.5 * (low + high);
    if (student_within(freedom, middle) < 0.95) low = middle;
    else high = middle;
  }
  return sqrt(freedom) * tan(0.5 * (low + high));
}
