/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Factor and solution for one size of blocks: included with BLOCK (the size), STRIDE and SYMMETRIC (0, 1).
 *
 * Left-looking: a column of blocks is gathered, all earlier columns that its row meets are subtracted, its
 * diagonal block is factorised and divides the rest. Some earlier columns with the same rows are subtracted at
 * once, which saves traffic. Loops over a block have constant bounds, and compilers unroll them into
 * vectors. */
#include "micro/block.h"

#include <math.h>
#include <string.h>

enum { AREA = BLOCK * STRIDE };
/* Columns that are subtracted at once: as many as registers hold the factors of. */
#define WIDEST (BLOCK > 2 ? 2 : 4)

/* A column of a block. */
typedef double lanes __attribute__((vector_size(STRIDE * sizeof(double))));

/* No function that takes or returns lanes is called: all are inlined, and how they would be is of no concern. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

static inline __attribute__((always_inline)) lanes lanes_load(const double *a) {
  lanes v;
  memcpy(&v, a, sizeof v);
  return v;
}

static inline __attribute__((always_inline)) void lanes_store(double *a, lanes v) {
  memcpy(a, &v, sizeof v);
}

/* Earlier columns with the same rows: x -= sum of l u, over `width` of them. */
static inline __attribute__((always_inline)) void columns_subtract_sized(int width, double *restrict x,
                                                                         const double *const *l,
                                                                         const double *const *u,
                                                                         const int *restrict row, int count) {
  double factor[WIDEST][AREA];
  for (int w = 0; w < width; w++) memcpy(factor[w], u[w], sizeof factor[w]);
  for (int e = 0; e < count; e++) {
    double *to = x + AREA * row[e];
    lanes sum[BLOCK];
    for (int c = 0; c < BLOCK; c++) sum[c] = lanes_load(to + STRIDE * c);
    for (int w = 0; w < width; w++)
      for (int m = 0; m < BLOCK; m++) {
        const lanes left = lanes_load(l[w] + AREA * e + STRIDE * m);
        for (int c = 0; c < BLOCK; c++) sum[c] -= left * factor[w][STRIDE * c + m];
      }
    for (int c = 0; c < BLOCK; c++) lanes_store(to + STRIDE * c, sum[c]);
  }
}

#if !SYMMETRIC
/* x -= l u */
static void product_subtract(double *restrict x, const double *l, const double *u) {
  static const int own = 0;
  columns_subtract_sized(1, x, &l, &u, &own, 1);
}
#endif

static void columns_subtract(int width, double *restrict x, const double *const *l, const double *const *u,
                             const int *restrict row, int count) {
  switch (width) {
#if BLOCK <= 2
  case 4:
    columns_subtract_sized(4, x, l, u, row, count);
    return;
  case 3:
    columns_subtract_sized(3, x, l, u, row, count);
    return;
#endif
  case 2:
    columns_subtract_sized(2, x, l, u, row, count);
    return;
  default:
    columns_subtract_sized(1, x, l, u, row, count);
  }
}

/* ---- diagonal blocks ---- */

#if !SYMMETRIC
static bool pivot_exchange(double *d, int *exchange, int c) {
  int best = c;
  for (int r = c + 1; r < BLOCK; r++)
    if (fabs(d[STRIDE * c + r]) > fabs(d[STRIDE * c + best])) best = r;
  if (best == c) return false;
  for (int k = 0; k < BLOCK; k++) {
    double t = d[STRIDE * k + c];
    d[STRIDE * k + c] = d[STRIDE * k + best];
    d[STRIDE * k + best] = t;
  }
  int t = exchange[c];
  exchange[c] = exchange[best];
  exchange[best] = t;
  return true;
}
#endif

/* d = P^T L U in place, the inverse pivots on its diagonal. Returns the number of pivots: BLOCK, or less where
 * the next one is too small. */
static int diagonal_factor(gh_block_values *v, double *d, int *exchange) {
  bool odd = false;
  for (int c = 0; c < BLOCK; c++) exchange[c] = c;
  for (int c = 0; c < BLOCK; c++) {
#if !SYMMETRIC
    if (pivot_exchange(d, exchange, c)) odd = !odd;
#endif
    double pivot = d[STRIDE * c + c], size = fabs(pivot);
    if (!(SYMMETRIC ? pivot > 0 : size > v->negligible) || !isfinite(pivot)) return c;
    if (pivot < 0) odd = !odd;
    v->least = size < v->least ? size : v->least;
    v->most = size > v->most ? size : v->most;
    d[STRIDE * c + c] = 1 / pivot;
    for (int r = c + 1; r < BLOCK; r++) d[STRIDE * c + r] /= pivot;
    for (int k = c + 1; k < BLOCK; k++)
      for (int r = c + 1; r < BLOCK; r++) d[STRIDE * k + r] -= d[STRIDE * c + r] * d[STRIDE * k + c];
  }
  v->negative += odd;
  return BLOCK;
}

/* Column c of a block row over the upper triangle of a diagonal block whose first c pivots are made. */
static inline void column_divide(const double *restrict d, int c, double *restrict w) {
  for (int m = 0; m < c; m++)
    for (int r = 0; r < STRIDE; r++) w[STRIDE * c + r] -= w[STRIDE * m + r] * d[STRIDE * c + m];
}

/* l = x d^-1 */
static inline void diagonal_divide_right(const double *restrict d, const int *restrict exchange,
                                         const double *restrict x, double *restrict l) {
  double w[AREA];
  memcpy(w, x, sizeof w);
  for (int c = 0; c < BLOCK; c++) {
    column_divide(d, c, w);
    for (int r = 0; r < STRIDE; r++) w[STRIDE * c + r] *= d[STRIDE * c + c];
  }
  for (int c = BLOCK - 2; c >= 0; c--)
    for (int m = c + 1; m < BLOCK; m++)
      for (int r = 0; r < STRIDE; r++) w[STRIDE * c + r] -= w[STRIDE * m + r] * d[STRIDE * c + m];
  for (int c = 0; c < BLOCK; c++)
    for (int r = 0; r < STRIDE; r++) l[STRIDE * exchange[c] + r] = w[STRIDE * c + r];
}

/* y = d^-1 y */
static inline void diagonal_divide_left(const double *restrict d, const int *restrict exchange, int ncol,
                                        double *restrict y) {
  double w[BLOCK * GH_BLOCK_COLUMNS];
  for (int r = 0; r < BLOCK; r++)
    for (int k = 0; k < ncol; k++) w[ncol * r + k] = y[ncol * exchange[r] + k];
  for (int c = 0; c < BLOCK; c++)
    for (int r = c + 1; r < BLOCK; r++)
      for (int k = 0; k < ncol; k++) w[ncol * r + k] -= d[STRIDE * c + r] * w[ncol * c + k];
  for (int c = BLOCK - 1; c >= 0; c--) {
    for (int k = 0; k < ncol; k++) w[ncol * c + k] *= d[STRIDE * c + c];
    for (int r = 0; r < c; r++)
      for (int k = 0; k < ncol; k++) w[ncol * r + k] -= d[STRIDE * c + r] * w[ncol * c + k];
  }
  for (int k = 0; k < BLOCK * ncol; k++) y[k] = w[k];
}

/* ---- factor ---- */

static void column_gather(const gh_block_pattern *p, const gh_block_values *v, int j) {
  const size_t bytes = AREA * sizeof(double);
  double *x = v->column;
  if (!SYMMETRIC)
    for (int q = p->across[j]; q < p->across[j + 1]; q++) memset(x + AREA * p->column[q], 0, bytes);
  for (int e = p->first[j]; e < p->first[j + 1]; e++) memset(x + AREA * p->row[e], 0, bytes);
  for (int a = p->a_first[j]; a < p->a_first[j + 1]; a++)
    if (!SYMMETRIC || p->a_row[a] > j) memcpy(x + AREA * p->a_row[a], v->a + AREA * a, bytes);
  memcpy(x + AREA * j, v->diagonal + AREA * j, bytes);
}

/* How many of the columns of row j from q on have the same rows. */
static int columns_alike(const gh_block_pattern *p, int j, int q) {
  int width = 1;
  while (width < WIDEST && q + width < p->across[j + 1] && p->column[q + width] == p->column[q] + width &&
         p->joined[p->column[q + width]])
    width++;
  return width;
}

#if SYMMETRIC
/* u of column k and row j is D_k L_jk^T, kept beside L_jk. */
static void column_update(const gh_block_pattern *p, gh_block_values *v, int j) {
  for (int q = p->across[j], width; q < p->across[j + 1]; q += width) {
    const int e = p->entry[q], count = p->first[p->column[q] + 1] - e;
    const double *l[WIDEST], *u[WIDEST];
    width = columns_alike(p, j, q);
    for (int w = 0; w < width; w++)
      l[w] = v->l + AREA * p->entry[q + w], u[w] = v->u + AREA * p->entry[q + w];
    columns_subtract(width, v->column, l, u, p->row + e, count);
  }
}
#else
/* u of column k and row j is what earlier columns have left there, columns alike among them. */
static void column_update(const gh_block_pattern *p, gh_block_values *v, int j) {
  double *x = v->column;
  for (int q = p->across[j], width; q < p->across[j + 1]; q += width) {
    const int k = p->column[q];
    const double *l[WIDEST], *u[WIDEST];
    width = columns_alike(p, j, q);
    for (int w = 0; w < width; w++) {
      double *own = v->u + AREA * (q + w);
      memcpy(own, x + AREA * (k + w), AREA * sizeof *own);
      for (int m = 0; m < w; m++) product_subtract(own, v->l + AREA * (p->first[k + m] + w - m - 1), u[m]);
      u[w] = own;
      l[w] = v->l + AREA * (p->first[k + w] + width - w - 1);
    }
    const int e = p->first[k + width - 1];
    columns_subtract(width, x, l, u, p->row + e, p->first[k + width] - e);
  }
}
#endif

#if !SYMMETRIC
/* Whether nothing is left of a column of numbers at all, below its diagonal block as in it: then the matrix is
 * singular, and exchanges of rows between blocks would not help. */
static bool column_vanishes(const gh_block_pattern *p, const gh_block_values *v, int j, int pivots) {
  const double *d = v->d + AREA * j;
  double largest = 0;
  for (int e = p->first[j]; e < p->first[j + 1]; e++) {
    double w[AREA];
    memcpy(w, v->column + AREA * p->row[e], sizeof w);
    for (int c = 0; c <= pivots; c++) {
      column_divide(d, c, w);
      for (int r = 0; r < STRIDE && c < pivots; r++) w[STRIDE * c + r] *= d[STRIDE * c + c];
    }
    for (int r = 0; r < STRIDE; r++) {
      const double size = fabs(w[STRIDE * pivots + r]);
      if (!(size <= largest)) largest = size; /* NaN stays */
    }
  }
  return largest <= v->negligible && isfinite(d[(STRIDE + 1) * pivots]);
}
#endif

static bool block_factor(const gh_block_pattern *p, gh_block_values *v) {
  v->least = INFINITY;
  v->most = 0;
  v->negative = 0;
  v->singular = false;
  for (int j = 0; j < p->n; j++) {
    double *d = v->d + AREA * j;
    int *exchange = v->exchange + BLOCK * j;
    column_gather(p, v, j);
    column_update(p, v, j);
    memcpy(d, v->column + AREA * j, AREA * sizeof *d);
    const int pivots = diagonal_factor(v, d, exchange);
    if (pivots < BLOCK) {
#if !SYMMETRIC
      v->singular = column_vanishes(p, v, j, pivots);
#endif
      return false;
    }
    for (int e = p->first[j]; e < p->first[j + 1]; e++) {
      const double *x = v->column + AREA * p->row[e];
      diagonal_divide_right(d, exchange, x, v->l + AREA * e);
#if SYMMETRIC
      for (int c = 0; c < BLOCK; c++)
        for (int r = 0; r < BLOCK; r++) v->u[AREA * e + STRIDE * c + r] = x[STRIDE * r + c];
#endif
    }
  }
  return true;
}

/* ---- solution ---- */

/* y -= b x */
static inline void vector_subtract(double *restrict y, const double *restrict b, const double *restrict x,
                                   int ncol) {
  for (int c = 0; c < BLOCK; c++)
    for (int r = 0; r < BLOCK; r++)
      for (int k = 0; k < ncol; k++) y[ncol * r + k] -= b[STRIDE * c + r] * x[ncol * c + k];
}

#if SYMMETRIC
/* y -= b^T x */
static inline void vector_subtract_transposed(double *restrict y, const double *restrict b,
                                              const double *restrict x, int ncol) {
  for (int r = 0; r < BLOCK; r++)
    for (int c = 0; c < BLOCK; c++)
      for (int k = 0; k < ncol; k++) y[ncol * r + k] -= b[STRIDE * r + c] * x[ncol * c + k];
}
#endif

static inline __attribute__((always_inline)) void columns_solve(const gh_block_pattern *p, gh_block_values *v,
                                                                int ncol) {
  const int step = BLOCK * ncol;
  double *y = v->y, own[BLOCK * GH_BLOCK_COLUMNS];
  for (int j = 0; j < p->n; j++) {
    for (int k = 0; k < step; k++) own[k] = y[step * j + k];
    for (int e = p->first[j]; e < p->first[j + 1]; e++)
      vector_subtract(y + step * p->row[e], v->l + AREA * e, own, ncol);
  }
  if (SYMMETRIC)
    for (int j = 0; j < p->n; j++)
      diagonal_divide_left(v->d + AREA * j, v->exchange + BLOCK * j, ncol, y + step * j);
  for (int j = p->n - 1; j >= 0; j--) {
    for (int k = 0; k < step; k++) own[k] = y[step * j + k];
#if SYMMETRIC
    for (int e = p->first[j]; e < p->first[j + 1]; e++)
      vector_subtract_transposed(own, v->l + AREA * e, y + step * p->row[e], ncol);
#else
    diagonal_divide_left(v->d + AREA * j, v->exchange + BLOCK * j, ncol, own);
    for (int q = p->across[j]; q < p->across[j + 1]; q++)
      vector_subtract(y + step * p->column[q], v->u + AREA * q, own, ncol);
#endif
    for (int k = 0; k < step; k++) y[step * j + k] = own[k];
  }
}

static void block_solve(const gh_block_pattern *p, gh_block_values *v, int ncol) {
  if (ncol == 1) columns_solve(p, v, 1);
  else columns_solve(p, v, GH_BLOCK_COLUMNS);
}

static inline __attribute__((always_inline)) void product_of_columns(const gh_block_pattern *p,
                                                                     const gh_block_values *v, int ncol,
                                                                     const double *x, double *r) {
  const int step = BLOCK * ncol;
  for (int j = 0; j < p->n; j++) {
    vector_subtract(r + step * j, v->diagonal + AREA * j, x + step * j, ncol);
    for (int a = p->a_first[j]; a < p->a_first[j + 1]; a++)
      vector_subtract(r + step * p->a_row[a], v->a + AREA * a, x + step * j, ncol);
  }
}

static void block_subtract(const gh_block_pattern *p, const gh_block_values *v, int ncol, const double *x,
                           double *r) {
  if (ncol == 1) product_of_columns(p, v, 1, x, r);
  else product_of_columns(p, v, GH_BLOCK_COLUMNS, x, r);
}
