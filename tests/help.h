/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the tests of packings and RVEs share.
 * GH_ENGINE=native or lammps restricts them to one engine. */
#ifndef GRANHOM_TESTS_HELP_H
#define GRANHOM_TESTS_HELP_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "granhom/micro.h"

static const double help_pi = GH_PI;
static const char *const engine_names[] = {[GH_ENGINE_LAMMPS] = "lammps", [GH_ENGINE_NATIVE] = "native"};
static const gh_boundary all_boundaries[] = {GH_TAYLOR, GH_TAYLOR_CELL, GH_RESTRICTED, GH_PERIODIC};

/* The state of each test is its context. */
static inline int open_context(void **state) {
  gh_context *ctx;
  if (gh_context_create(&ctx) != GH_OK) return -1;
  *state = ctx;
  return 0;
}
static inline int close_context(void **state) {
  gh_context *ctx = *state;
  gh_context_destroy(&ctx);
  return 0;
}
#define TEST(f) cmocka_unit_test_setup_teardown(f, open_context, close_context)

#define OK(call) assert_ok(ctx, call, __FILE__, __LINE__)
static inline void assert_ok(const gh_context *ctx, gh_status s, const char *file, int line) {
  if (s == GH_OK) return;
  print_error("%s\n", gh_message(ctx));
  _fail(file, line);
}

/* The call fails with this status, and the message holds these words. */
#define FAILS(call, status, words) assert_fails(ctx, call, status, words, __FILE__, __LINE__)
static inline void assert_fails(const gh_context *ctx, gh_status s, gh_status wanted, const char *words,
                                const char *file, int line) {
  if (s == wanted && strstr(gh_message(ctx), words)) return;
  print_error("status %d (wanted %d), message \"%s\" (wanted \"%s\")\n", (int)s, (int)wanted, gh_message(ctx),
              words);
  _fail(file, line);
}

/* |a - b| <= limit, told with both values and a name. */
#define NEAR(name, a, b, limit) assert_near(name, a, b, limit, __FILE__, __LINE__)
static inline void assert_near(const char *name, double a, double b, double limit, const char *file,
                               int line) {
  if (fabs(a - b) <= limit) return;
  print_error("%s: %.17g and %.17g differ by %.3g, at most %.3g is allowed\n", name, a, b, fabs(a - b),
              limit);
  _fail(file, line);
}

static inline double norm(const double *a, int n) {
  double largest = 0;
  for (int k = 0; k < n; k++) largest = fmax(largest, fabs(a[k]));
  return largest;
}

/* Largest difference of n numbers. */
static inline double distance(const double *a, const double *b, int n) {
  double largest = 0;
  for (int k = 0; k < n; k++) largest = isnan(a[k] - b[k]) ? NAN : fmax(largest, fabs(a[k] - b[k]));
  return largest;
}

static inline bool use_engine(gh_engine_kind kind) {
  const char *only = getenv("GH_ENGINE");
  return !only || !*only || !strcmp(only, engine_names[kind]);
}

/* Uniform in [0, 1): the same numbers on every machine. */
static inline double uniform(unsigned long long *seed) {
  *seed = *seed * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(*seed >> 11) / 9007199254740992.0;
}

/* A packing of the reference cases. */
static inline gh_packing *case_packing(gh_context *ctx, const char *name) {
  char path[256];
  gh_packing *p;
  snprintf(path, sizeof path, "tests/data/cases/packings/%s.data", name);
  OK(gh_packing_read(ctx, path, &p));
  return p;
}

/* A packing made here; cell and x are those of gh_packing, ids 1 ... n. */
static inline gh_packing *make_packing(gh_context *ctx, int n, const double cell[4], const double *radius,
                                       const double *x) {
  gh_packing *p;
  OK(gh_alloc(ctx, 1, sizeof *p, &p));
  OK(gh_alloc(ctx, (size_t)n, sizeof(int), &p->id));
  OK(gh_alloc(ctx, (size_t)n, sizeof(int), &p->type));
  OK(gh_alloc(ctx, (size_t)n, sizeof(double), &p->radius));
  OK(gh_alloc(ctx, 2 * (size_t)n, sizeof(double), &p->x));
  p->n = n;
  for (int i = 0; i < n; i++) {
    p->id[i] = i + 1;
    p->type[i] = 1;
    p->radius[i] = radius[i];
    p->x[2 * i] = x[2 * i], p->x[2 * i + 1] = x[2 * i + 1];
  }
  memcpy(p->cell, cell, sizeof p->cell);
  return p;
}

static inline gh_rve_options rve_options(gh_engine_kind engine, gh_boundary boundary, double E,
                                         double tolerance) {
  gh_rve_options o = gh_rve_defaults();
  o.engine = engine, o.boundary = boundary, o.law.normal_stiffness = E, o.tolerance = tolerance;
  return o;
}

static inline gh_rve *make_rve(gh_context *ctx, const gh_packing *p, gh_engine_kind engine,
                               gh_boundary boundary, double E, double tolerance) {
  gh_rve *rve;
  gh_rve_options o = rve_options(engine, boundary, E, tolerance);
  OK(gh_rve_create(ctx, p, &o, &rve));
  return rve;
}

static inline void rotation(double angle, double Q[4]) {
  Q[0] = Q[3] = cos(angle);
  Q[2] = sin(angle);
  Q[1] = -Q[2];
}

#endif
