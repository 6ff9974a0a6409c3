/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: status and error text, log and progress, tensors.
 *
 * Conventions of the whole library
 *  - Every public name starts with gh_; object, then verb: gh_rve_evaluate(). Inputs first, results last.
 *  - A function that can fail returns gh_status and leaves a sentence in the context (gh_message()).
 *  - Objects are opaque, made by X_create(..., &x) and freed by X_destroy(&x), which takes NULL and sets
 * NULL.
 *  - Second-order tensors are double[4], row-major: F11 F12 F21 F22. The tangent A_iJkL = dP_iJ/dF_kL is
 * double[16] with index 8 i + 4 J + 2 k + L. A cell is double[4] too; its COLUMNS are the lattice vectors.
 *  - Plane problems of unit thickness: stress is force per length; pressure is negative.
 *  - No globals, no printing, no exit: the driver prints, through the sinks that it sets.
 */
#ifndef GRANHOM_BASE_H
#define GRANHOM_BASE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* What the shared libraries export; all else is hidden in them. */
#define GH_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/* One line per error: name, exit status of a program that stops for it, meaning. */
#define GH_STATUS_LIST(X)                                                                                    \
  X(GH_OK, 0, "done")                                                                                        \
  X(GH_INPUT, 2, "the input is wrong")                                                                       \
  X(GH_DIVERGED, 1, "the computation did not converge")                                                      \
  X(GH_SYSTEM, 1, "the operating system refused")                                                            \
  X(GH_MEMORY, 1, "out of memory")                                                                           \
  X(GH_ENGINE, 1, "the engine reported an error")                                                            \
  X(GH_STOPPED, 1, "stopped on request")                                                                     \
  X(GH_INTERNAL, 1, "an internal check failed")                                                              \
  X(GH_LIMIT, 1, "a state beyond known limits")

typedef enum gh_status {
#define GH_X(name, exit_status, text) name,
  GH_STATUS_LIST(GH_X)
#undef GH_X
} gh_status;

/* Exit status of a program that ends with s: 0, 1 (computation) or 2 (input). */
GH_API int gh_exit_status(gh_status s);
/* Meaning of s in a few words; never NULL. */
GH_API const char *gh_status_text(gh_status s);

/* ---- context: the last message, the log and the progress sink; one per thread of control ---- */

typedef struct gh_context gh_context;

typedef enum gh_level { GH_LEVEL_DEBUG, GH_LEVEL_INFO, GH_LEVEL_WARNING } gh_level;

/* Receives one line without newline. */
typedef void gh_log_sink(void *data, gh_level level, const char *line);

/* A progress report: what is done, how far, how fast, how long still (seconds; NAN while unknown). */
typedef struct gh_progress {
  const char *label; /* "confine" */
  const char *unit;  /* "steps" */
  double done, total;
  double rate;    /* units per second; NAN while unknown */
  double seconds; /* since the start */
  double left;    /* estimate of the seconds left; NAN while unknown */
  bool end;       /* the last report of this work */
} gh_progress;
typedef void gh_progress_sink(void *data, const gh_progress *report);

GH_API gh_status gh_context_create(gh_context **ctx);
GH_API void gh_context_destroy(gh_context **ctx);
/* Text of the last failure; "" when there was none. Valid until the next failure. */
GH_API const char *gh_message(const gh_context *ctx);
GH_API void gh_set_log(gh_context *ctx, gh_log_sink *sink, void *data);
GH_API void gh_set_progress(gh_context *ctx, gh_progress_sink *sink, void *data);

#define GH_PI 3.14159265358979323846
/* The end of a plural: printf("%d step%s", n, GH_S(n)). */
#define GH_S(n) ((n) == 1 ? "" : "s")
#define GH_PRINTF(f, a) __attribute__((format(printf, f, a)))

/* Stores the message (what, where, which value, which limit) and returns s, so that callers write
 * `return gh_fail(ctx, GH_INPUT, "%s:%d: ...", file, line);` */
GH_API gh_status gh_fail(gh_context *ctx, gh_status s, const char *format, ...) GH_PRINTF(3, 4);
/* The same with its place: "... [src/io/csv.c:12 row_read]". Debug builds (make DEBUG=1) add it. */
GH_API gh_status gh_fail_at(const char *file, int line, const char *function, gh_context *ctx, gh_status s,
                            const char *format, ...) GH_PRINTF(6, 7);
#if defined GH_DEBUG && !defined __clang_analyzer__
#define gh_fail(ctx, ...) gh_fail_at(__FILE__, __LINE__, __func__, ctx, __VA_ARGS__)
#endif
/* Puts text before the stored message: "integration point 17: " + message. Returns s. */
GH_API gh_status gh_prefix(gh_context *ctx, gh_status s, const char *format, ...) GH_PRINTF(3, 4);
#ifdef __clang_analyzer__ /* which reads one file at a time and has to know what they return */
#define gh_fail(ctx, s, ...) (gh_fail(ctx, s, __VA_ARGS__), (s))
#define gh_prefix(ctx, s, ...) (gh_prefix(ctx, s, __VA_ARGS__), (s))
#endif
GH_API void gh_log(gh_context *ctx, gh_level level, const char *format, ...) GH_PRINTF(3, 4);

/* Returns from the calling function when call fails. */
#define GH_TRY(call)                                                                                         \
  do {                                                                                                       \
    gh_status gh_try_status_ = (call);                                                                       \
    if (gh_try_status_ != GH_OK) return gh_try_status_;                                                      \
  } while (0)
/* The same with a clean-up label: sets `status` and jumps. */
#define GH_TRY_OR(call, label)                                                                               \
  do {                                                                                                       \
    status = (call);                                                                                         \
    if (status != GH_OK) goto label;                                                                         \
  } while (0)

/* Zeroed memory for count objects of size bytes; *p is NULL after a failure. GH_MEMORY names the size. */
GH_API gh_status gh_alloc(gh_context *ctx, size_t count, size_t size, void *p);
/* A copy of a text; the caller frees. GH_MEMORY as above. */
GH_API gh_status gh_copy_text(gh_context *ctx, const char *text, char **copy);
/* Grows *p (an array of *capacity objects of size bytes) so that it holds at least need objects. */
GH_API gh_status gh_grow(gh_context *ctx, size_t need, size_t size, size_t *capacity, void *p);

/* ---- progress ---- */

typedef struct gh_work {
  const char *label, *unit;
  double total, start, last;
} gh_work;
GH_API void gh_work_begin(gh_context *ctx, gh_work *w, const char *label, const char *unit, double total);
GH_API void gh_work_advance(gh_context *ctx, gh_work *w, double done); /* at most ten reports a second */
GH_API void gh_work_end(gh_context *ctx, gh_work *w, double done);

/* Which build of granhom this is: a sum over the sources that answers depend on, and the compiler's options.
 */
GH_API const char *gh_build(void);

/* Which BLAS is loaded, as text: folder and file of the library with its version, and what it states of
 * itself. Bits of results depend on it. "unknown": there is none. GH_SYSTEM: its path cannot be resolved. */
enum { GH_BLAS_SIZE = 256 };
GH_API gh_status gh_blas(gh_context *ctx, char *text, size_t size);

/* Seconds of a monotonic clock. */
GH_API double gh_seconds(void);

/* ---- checksums of what is compared within one program or version ---- */

/* 64-bit FNV-1a over bytes; of several pieces, one after the other. Start with GH_SUM_BEGIN. */
#define GH_SUM_BEGIN UINT64_C(14695981039346656037)
static inline uint64_t gh_sum_bytes(uint64_t sum, const void *data, size_t size) {
  const unsigned char *bytes = (const unsigned char *)data;
  for (size_t k = 0; k < size; k++) sum = (sum ^ bytes[k]) * UINT64_C(1099511628211);
  return sum;
}

/* ---- tensors of the plane ---- */

static inline double gh_det2(const double a[4]) {
  return a[0] * a[3] - a[1] * a[2];
}
static inline void gh_mul2(const double a[4], const double b[4], double c[4]) { /* c = a b; c may be a or b */
  double r[4] = {a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2],
                 a[2] * b[1] + a[3] * b[3]};
  for (int k = 0; k < 4; k++) c[k] = r[k];
}
static inline void gh_inv2(const double a[4], double b[4]) { /* b = a^-1; b may be a; a must be regular */
  double d = 1 / gh_det2(a), r[4] = {a[3] * d, -a[1] * d, -a[2] * d, a[0] * d};
  for (int k = 0; k < 4; k++) b[k] = r[k];
}
static inline void gh_apply2(const double a[4], const double x[2], double y[2]) { /* y = a x; y may be x */
  double y0 = a[0] * x[0] + a[1] * x[1], y1 = a[2] * x[0] + a[3] * x[1];
  y[0] = y0;
  y[1] = y1;
}
/* The rotation of the polar decomposition of a, det a > 0. */
static inline double gh_turn2(const double a[4]) {
  return atan2(a[2] - a[1], a[0] + a[3]);
}
/* The strain from one gradient to another, without rotation: |R^T to from^-1 - 1|. */
static inline double gh_strain2(const double from[4], const double to[4]) {
  double f[4];
  gh_inv2(from, f);
  gh_mul2(to, f, f);
  const double turn = gh_turn2(f), c = cos(turn), s = sin(turn), xx = c * f[0] + s * f[2] - 1,
               xy = c * f[1] + s * f[3], yx = c * f[2] - s * f[0], yy = c * f[3] - s * f[1] - 1;
  return sqrt(xx * xx + xy * xy + yx * yx + yy * yy);
}
/* Cauchy stress s = P F^T / det F. */
static inline void gh_cauchy2(const double P[4], const double F[4], double s[4]) {
  double J = gh_det2(F);
  double r[4] = {(P[0] * F[0] + P[1] * F[1]) / J, (P[0] * F[2] + P[1] * F[3]) / J,
                 (P[2] * F[0] + P[3] * F[1]) / J, (P[2] * F[2] + P[3] * F[3]) / J};
  for (int k = 0; k < 4; k++) s[k] = r[k];
}
/* ---- numbers that may not be finite, norms that neither overflow nor underflow ----
 *
 * A comparison with NaN is false, fmax() passes over NaN, and inf <= inf is true: what decides by any of
 * these takes a computation that has failed for one that has converged. These do not. */

/* x is at most the limit, and both are finite. */
static inline bool gh_within(double x, double limit) {
  return x <= limit && isfinite(x) && isfinite(limit);
}
/* The larger of the two; NaN if one of them is. */
static inline double gh_max(double a, double b) {
  return a >= b || isnan(a) ? a : b;
}
/* The largest absolute value; NaN if one of them is. */
static inline double gh_largest(const double *a, size_t n) {
  double largest = 0;
  for (size_t k = 0; k < n; k++) largest = gh_max(largest, fabs(a[k]));
  return largest;
}

/* A sum of squares of which the root is wanted. Squares of numbers beyond 1e154 overflow and those below
 * 1e-154 underflow; the sums of scaled squares are what the root is taken of then. Where the plain sum is in
 * range, it alone counts, so that the root has the bits of the plain formula. */
typedef struct gh_squares {
  double sum, large, small;
} gh_squares;
#define GH_SQUARES_SCALE 4.149515568880993e180 /* 2^600 */
static inline void gh_squares_add(gh_squares *s, double x) {
  const double down = x / GH_SQUARES_SCALE, up = x * GH_SQUARES_SCALE;
  s->sum += x * x;
  s->large += down * down;
  s->small += up * up;
}
/* The root; inf and NaN where one of the numbers is, or where the root itself is too large. */
static inline double gh_squares_root(const gh_squares *s) {
  if (s->sum >= 1e-270 && s->sum <= 1e300) return sqrt(s->sum);
  return s->sum < 1 ? sqrt(s->small) / GH_SQUARES_SCALE : sqrt(s->large) * GH_SQUARES_SCALE;
}
/* Euclidean norm. */
static inline double gh_norm(const double *a, size_t n) {
  gh_squares s = {0, 0, 0};
  for (size_t k = 0; k < n; k++) gh_squares_add(&s, a[k]);
  return gh_squares_root(&s);
}

static inline bool gh_finite(const double *a, size_t n) {
  for (size_t k = 0; k < n; k++)
    if (!isfinite(a[k])) return false;
  return true;
}

#ifdef __cplusplus
}
#endif
#endif
