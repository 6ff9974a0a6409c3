/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Small studies in files that the tests of reading and of running share. */
#ifndef GRANHOM_TESTS_STUDY_READ_HELP_H
#define GRANHOM_TESTS_STUDY_READ_HELP_H

#include "study/parts.h"
#include "test_io.h"

#include <math.h>
#include <unistd.h>

#define SMALL                                                                                                \
  "rve:\n  packing: @/p50.data\n  contact: {normal_stiffness: 50}\n"                                         \
  "  micro: {boundary: periodic, engine: native}\n"                                                          \
  "  path: {legs: [{to: [0.99, 0, 0, 1], increments: 2}]}\n"
#define REFERENCE "reference: {set: {micro.tolerance: 1e-11}}\n"
#define VARY "vary: {micro.tolerance: [1e-2, 1e-6]}\n"
#define SCENE                                                                                                \
  "packing: @/p20.data\ncontact: {normal_stiffness: 50}\nmicro: {boundary: taylor, engine: native}\n"        \
  "start: {confinement: 0.3}\nmesh: {rectangle: {size: [2, 2], elements: [1, 1]}}\n"                         \
  "supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]\n"
#define SHEAR "steps: [{increments: 2, displace: [{edge: top, x: 0.01}]}]\n"

/* cmocka's own compares as float. */
static inline void near(double a, double b, double limit) {
  if (!(fabs(a - b) <= limit)) fail_msg("%.17g and %.17g differ by more than %g", a, b, limit);
}

/* A file of the test's folder; @ stands for the folder of the reference packings. */
static inline const char *put(place *p, const char *name, const char *text) {
  char full[8192] = "", here[4096];
  assert_non_null(getcwd(here, sizeof here));
  for (const char *c = text; *c; c++) {
    size_t used = strlen(full);
    if (*c == '@') snprintf(full + used, sizeof full - used, "%s/tests/data/cases/packings", here);
    else snprintf(full + used, sizeof full - used, "%c", *c);
  }
  return put_file(p, name, full);
}

static inline gh_study *study_of(place *p, const char *text, bool quick) {
  gh_study *s;
  gh_status status = gh_study_read(p->ctx, put(p, "study.yaml", text), quick, &s);
  if (status != GH_OK) fail_msg("%s", gh_message(p->ctx));
  return s;
}

#endif
