/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the tests of extremes share: a worst error that is asserted as it grows, and the rows of
 * docs/reports/stability.md.
 *
 * GH_EXTREME_TABLE=FILE: each test appends its rows, `section|case|check|outcome`; `make extreme` makes the
 * table of them. GH_EXTREME_FULL=1: the sizes that take minutes. */
#ifndef GRANHOM_TESTS_EXTREME_H
#define GRANHOM_TESTS_EXTREME_H

#include "../help.h"

#define FOR_ENGINES(e)                                                                                       \
  for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)                                      \
    if (use_engine(e))
#define FOR_BOUNDARIES(b) for (const gh_boundary *b = all_boundaries; b < all_boundaries + 4; b++)

static inline bool full_size(void) {
  const char *full = getenv("GH_EXTREME_FULL");
  return full && *full == '1';
}

/* error <= limit (a NaN is not); the largest so far stays in *worst. */
#define WITHIN(worst, name, error, limit) assert_within(worst, name, error, limit, __FILE__, __LINE__)
static inline void assert_within(double *worst, const char *name, double error, double limit,
                                 const char *file, int line) {
  if (error > *worst) *worst = error;
  if (error <= limit) return;
  print_error("%s: error %.3g, at most %.3g is allowed\n", name, error, limit);
  _fail(file, line);
}

/* Relative error of n numbers against b. */
static inline double relative(const double *a, const double *b, int n) {
  return distance(a, b, n) / norm(b, n);
}

static inline void row(const char *section, const char *name, const char *check, const char *format, ...)
    GH_PRINTF(4, 5);
static inline void row(const char *section, const char *name, const char *check, const char *format, ...) {
  const char *path = getenv("GH_EXTREME_TABLE");
  if (!path || !*path) return;
  FILE *f = fopen(path, "a");
  assert_non_null(f);
  va_list list;
  va_start(list, format);
  fprintf(f, "%s|%s|%s|", section, name, check);
  vfprintf(f, format, list);
  fputc('\n', f);
  va_end(list);
  assert_int_equal(fclose(f), 0);
}

/* The row of a case that converges: its worst error, and the error that the test allows. */
static inline void row_error(const char *section, const char *name, const char *check, double worst,
                             double limit) {
  row(section, name, check, "converged, error %.0e (allowed %.0e)", worst, limit);
}

static const double I[4] = {1, 0, 0, 1}, squeeze[4] = {0.98, 0.005, 0.002, 0.985};

static inline void step(gh_context *ctx, gh_rve *rve, const double F[4], double P[4], double *A) {
  OK(gh_rve_evaluate(rve, F, A ? GH_WANT_TANGENT : 0, P, A));
  OK(gh_rve_commit(rve));
}

/* From one deformation to another in n equal steps; P, and A where it is wanted, at the end. */
static inline void walk(gh_context *ctx, gh_rve *rve, const double from[4], const double to[4], int n,
                        double P[4], double *A) {
  double F[4];
  for (int k = 1; k <= n; k++) {
    for (int c = 0; c < 4; c++) F[c] = from[c] + (to[c] - from[c]) * k / n;
    step(ctx, rve, F, P, k == n ? A : NULL);
  }
}

/* The packing with all lengths times `factor`. */
static inline gh_packing *scaled(gh_context *ctx, const char *name, double factor) {
  gh_packing *p = case_packing(ctx, name);
  for (int i = 0; i < p->n; i++) p->radius[i] *= factor;
  for (int i = 0; i < 2 * p->n; i++) p->x[i] *= factor;
  for (int k = 0; k < 4; k++) p->cell[k] *= factor;
  for (int k = 0; k < 2; k++) p->low[k] *= factor;
  return p;
}

#endif
