/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Made-up studies that the tests of tables and of pictures share. */
#ifndef GRANHOM_TESTS_STUDY_SHOW_HELP_H
#define GRANHOM_TESTS_STUDY_SHOW_HELP_H

#include "study_help.h"
#include "study/draw.h"

#define VALUES(...)                                                                                          \
  (const char *const[]) {                                                                                    \
    __VA_ARGS__, NULL                                                                                        \
  }

/* Two stresses and an energy that bend like those of a packing; data: error in P22, scatter of P11. */
static inline double path(double t, int column, void *data) {
  const double *d = data;
  double bend = t * (1 + 0.3 * t), scatter = d ? d[1] : 0;
  return column == 0 ? -bend * (1 + scatter) : column == 1 ? (d ? d[0] : 0) - 0.4 * bend : 0.5 * t * t;
}

/* Norm of the path's stress over 11 rows of [0, 1]. */
static inline double path_norm(void) {
  double sum = 0;
  for (int k = 0; k <= 10; k++) {
    double t = k / 10.0, bend = t * (1 + 0.3 * t);
    sum += 1.16 * bend * bend;
  }
  return sqrt(sum);
}

/* Error e of the stress as l2: the same at all 11 rows of P22. */
static inline void run_with_error(study_run *r, double e, double core, long pairs) {
  double d[2] = {e * path_norm() / sqrt(11), 0};
  made_run(r, 11, 1, path, d, core, pairs);
}

/* Tolerances of two conditions, one run of which fails; reference: a closed form. */
static inline gh_study *tolerance_study(gh_context *ctx) {
  static const double error[8] = {0, 0.2, 9e-3, 3e-2, 9e-4, 3.1e-3, 5e-6, 4e-5};
  gh_study *s = made_study(ctx);
  made_parameter(s, "micro.tolerance", VALUES("1e-2", "1e-4", "1e-6", "1e-8"));
  made_parameter(s, "micro.boundary", VALUES("restricted", "periodic"));
  made_configs(s, 1, 0);
  for (int k = 1; k < 8; k++) run_with_error(s->configs[k].runs, error[k], 0.1 * (k + 1), 1000L * k * k * k);
  made_failure(s->configs[0].runs, "row 3: no equilibrium | after 400000 steps");
  made_curve(&s->given, 11, 1, path, NULL);
  s->goals[2] = 1e-6;
  return s;
}

/* refine 1 ... 8 of two conditions: one of second order, one that grows in between. No error is at a goal, where
 * round-off would decide. */
static inline gh_study *order_study(gh_context *ctx) {
  static const double error[8] = {4.8e-2, 3e-2, 1.2e-2, 4e-3, 3e-3, 6e-3, 7.5e-4, 9e-4};
  gh_study *s = made_study(ctx);
  made_parameter(s, "refine", VALUES("1", "2", "4", "8"));
  made_parameter(s, "boundary", VALUES("taylor", "periodic"));
  made_configs(s, 1, 2);
  s->reference = STUDY_CONFIG;
  s->order = 0;
  for (int k = 0; k < 8; k++) {
    s->configs[k].reference = 8 + k % 2;
    run_with_error(s->configs[k].runs, error[k], 0.1 * (k / 2 + 1), 1000 * (k / 2 + 1));
  }
  for (int k = 8; k < 10; k++) {
    made_value(s, k, 0, "16");
    run_with_error(s->configs[k].runs, 0, 30 * (k - 7), 100000);
  }
  return s;
}

#endif
