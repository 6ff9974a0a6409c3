/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the element tests with materials in closed form and those with packings share. */
#ifndef GRANHOM_TESTS_ELEMENT_HELP_H
#define GRANHOM_TESTS_ELEMENT_HELP_H

#include "../help.h"
#include "granhom/control.h"

static const double identity[4] = {1, 0, 0, 1};

static inline void parse(gh_context *ctx, const char *const words[4], gh_condition c[4]) {
  for (int k = 0; k < 4; k++) OK(gh_condition_parse(ctx, words[k], &c[k]));
}

static inline gh_status solve(gh_context *ctx, gh_control *control, const char *const words[4],
                              const double target[4], gh_control_report *report) {
  gh_condition c[4];
  parse(ctx, words, c);
  return gh_control_solve(control, c, target, report);
}

/* Triangular lattice of equal disks that just touch; row by row, in a cell of 2 r n x sqrt(3) r n. */
static inline gh_packing *lattice(gh_context *ctx, int n, double r) {
  const double cell[4] = {2 * r * n, 0, 0, sqrt(3) * r * n};
  double *radius = malloc((size_t)(n * n) * sizeof *radius), *x = malloc(2 * (size_t)(n * n) * sizeof *x);
  for (int k = 0; k < n * n; k++) {
    radius[k] = r;
    x[2 * k] = 2 * r * (k % n) + r * (k / n % 2);
    x[2 * k + 1] = sqrt(3) * r * (k / n);
  }
  gh_packing *p = make_packing(ctx, n * n, cell, radius, x);
  free(radius);
  free(x);
  return p;
}

#endif
