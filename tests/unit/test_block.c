/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Factors of matrices of blocks against dense elimination; what they report of pivots. */
#include "../help.h"

#include "micro/block.h"

static const gh_block_kernel *const kernels[] = {&gh_block_general_1, &gh_block_general_2,
                                                 &gh_block_general_3, &gh_block_symmetric_2};
enum { MOST = 60, PAIRS = MOST * (MOST - 1) / 2 };

/* A matrix of n blocks and its dense twin. */
typedef struct matrix {
  const gh_block_kernel *kernel;
  gh_block_pattern pattern;
  gh_block_values values;
  int pairs[2 * PAIRS];
  gh_block_graph graph;
  double *dense; /* rows x rows, row-major, in the order of the graph */
  int rows;
} matrix;

static void draw_graph(matrix *m, int n, double share, unsigned long long *seed) {
  m->graph = (gh_block_graph){.n = n, .pairs = m->pairs};
  for (int i = 0; i < n; i++)
    for (int j = i + 1; j < n; j++) {
      if (uniform(seed) >= share) continue;
      m->pairs[2 * m->graph.npairs] = i;
      m->pairs[2 * m->graph.npairs++ + 1] = j;
    }
}

static double *draw_area(gh_context *ctx, size_t count, int width) {
  double *a;
  OK(gh_alloc(ctx, count * (size_t)width + 1, sizeof *a, &a));
  return a;
}

static void make(gh_context *ctx, const gh_block_kernel *kernel, int n, double share,
                 unsigned long long *seed, matrix *m) {
  *m = (matrix){.kernel = kernel, .rows = n * kernel->size};
  draw_graph(m, n, share, seed);
  OK(gh_block_pattern_make(ctx, &m->pattern, &m->graph));
  const int area = kernel->size * kernel->stride;
  const size_t factor = (size_t)m->pattern.first[n], blocks = (size_t)n;
  gh_block_values *v = &m->values;
  double **const arrays[] = {&v->diagonal, &v->d, &v->column, &v->a, &v->l, &v->u, &v->y};
  const size_t counts[] = {blocks, blocks, blocks, 2 * m->graph.npairs, factor, factor, blocks};
  const int widths[] = {area, area, area, area, area, area, kernel->size * GH_BLOCK_COLUMNS};
  for (int k = 0; k < 7; k++) *arrays[k] = draw_area(ctx, counts[k], widths[k]);
  OK(gh_alloc(ctx, (size_t)m->rows, sizeof(int), &v->exchange));
  m->dense = draw_area(ctx, (size_t)m->rows, m->rows);
}

static void drop(matrix *m) {
  gh_block_values *v = &m->values;
  void *const arrays[] = {v->diagonal, v->d, v->column, v->a, v->l, v->u, v->y, v->exchange, m->dense};
  for (int k = 0; k < 9; k++) free(arrays[k]);
  gh_block_pattern_release(&m->pattern);
}

static void put(matrix *m, int i, int j, double *block) {
  for (int c = 0; c < m->kernel->size; c++)
    for (int r = 0; r < m->kernel->size; r++)
      block[m->kernel->stride * c + r] =
          m->dense[m->rows * (m->kernel->size * i + r) + m->kernel->size * j + c];
}

/* From the dense matrix. */
static void fill(matrix *m) {
  const int area = m->kernel->size * m->kernel->stride;
  for (int i = 0; i < m->graph.n; i++) put(m, i, i, m->values.diagonal + area * m->pattern.place[i]);
  for (size_t q = 0; q < m->graph.npairs; q++) {
    put(m, m->pairs[2 * q], m->pairs[2 * q + 1], m->values.a + area * m->pattern.a_slot[2 * q]);
    put(m, m->pairs[2 * q + 1], m->pairs[2 * q], m->values.a + area * m->pattern.a_slot[2 * q + 1]);
  }
}

/* Numbers in the pattern. Symmetric: K = sum of B^T B over pairs, and a little of the unit matrix. General:
 * large numbers off the diagonal of the diagonal blocks, so that rows are exchanged. */
static void draw_values(matrix *m, unsigned long long *seed) {
  const int size = m->kernel->size, rows = m->rows;
  double *a = m->dense;
  for (int k = 0; k < rows; k++) {
    const int other = m->kernel->symmetric ? k : k - k % size + (k + 1) % size;
    a[rows * k + other] = m->kernel->symmetric ? 0.01 : 0.5;
  }
  for (size_t q = 0; q < m->graph.npairs; q++)
    for (int h = 0; h < size; h++)
      for (int k = 0; k < size; k++) {
        const int i = size * m->pairs[2 * q], j = size * m->pairs[2 * q + 1];
        double one = uniform(seed) - 0.5, two = uniform(seed) - 0.5;
        if (m->kernel->symmetric) { /* one spring between component h of i and k of j */
          a[rows * (i + h) + i + h] += one * one, a[rows * (j + k) + j + k] += two * two;
          a[rows * (i + h) + j + k] += one * two, a[rows * (j + k) + i + h] += one * two;
        } else {
          a[rows * (i + h) + j + k] = one, a[rows * (j + k) + i + h] = two;
          a[rows * (i + h) + i - i % size + (h + 1) % size] += 2 * fabs(one);
          a[rows * (j + k) + j - j % size + (k + 1) % size] += 2 * fabs(two);
        }
      }
  fill(m);
}

/* Gauss's elimination with the largest pivot of each column; x holds the right-hand side. */
static void dense_solve(double *a, int n, double *x) {
  for (int c = 0; c < n; c++) {
    int best = c;
    for (int r = c + 1; r < n; r++)
      if (fabs(a[n * r + c]) > fabs(a[n * best + c])) best = r;
    for (int k = 0; k < n; k++) {
      double t = a[n * c + k];
      a[n * c + k] = a[n * best + k], a[n * best + k] = t;
    }
    double t = x[c];
    x[c] = x[best], x[best] = t;
    for (int r = c + 1; r < n; r++) {
      double f = a[n * r + c] / a[n * c + c];
      for (int k = c; k < n; k++) a[n * r + k] -= f * a[n * c + k];
      x[r] -= f * x[c];
    }
  }
  for (int c = n - 1; c >= 0; c--) {
    for (int k = c + 1; k < n; k++) x[c] -= a[n * c + k] * x[k];
    x[c] /= a[n * c + c];
  }
}

/* Solves with `ncol` columns; every column against dense elimination. */
static void check_solution(gh_context *ctx, matrix *m, int ncol, unsigned long long *seed) {
  const int rows = m->rows, size = m->kernel->size;
  double *x = draw_area(ctx, (size_t)rows, ncol), *y = m->values.y,
         *rest = draw_area(ctx, (size_t)rows, ncol), *copy = draw_area(ctx, (size_t)rows, rows);
  for (int k = 0; k < rows * ncol; k++) y[k] = rest[k] = uniform(seed) - 0.5;
  for (int c = 0; c < ncol; c++) {
    for (int i = 0; i < rows; i++)
      x[rows * c + i] = y[ncol * (size * m->pattern.place[i / size] + i % size) + c];
    memcpy(copy, m->dense, (size_t)(rows * rows) * sizeof *copy);
    dense_solve(copy, rows, x + rows * c);
  }
  m->kernel->solve(&m->pattern, &m->values, ncol);
  for (int c = 0; c < ncol; c++)
    for (int i = 0; i < rows; i++)
      NEAR("solution", y[ncol * (size * m->pattern.place[i / size] + i % size) + c], x[rows * c + i],
           1e-10 * norm(x + rows * c, rows));
  m->kernel->subtract(&m->pattern, &m->values, ncol, y, rest);
  NEAR("residual", norm(rest, rows * ncol), 0, 1e-12 * (1 + norm(y, rows * ncol)));
  free(x), free(rest), free(copy);
}

/* Random matrices of all sizes of blocks, sparse and full, one block and many, for one and four columns. */
static void dense_elimination_agrees(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 7;
  printf("seed %llu\n", seed);
  for (int round = 0; round < 200; round++) {
    static const double shares[] = {0, 0.05, 0.1, 0.3, 1};
    matrix m;
    int n = 1 + (int)(uniform(&seed) * (round % 5 == 4 ? 12 : MOST));
    make(ctx, kernels[round % 4], n, shares[round % 5], &seed, &m);
    draw_values(&m, &seed);
    assert_true(m.kernel->factor(&m.pattern, &m.values));
    assert_true(m.values.least > 0 && m.values.least <= m.values.most);
    check_solution(ctx, &m, 1, &seed);
    check_solution(ctx, &m, GH_BLOCK_COLUMNS, &seed);
    drop(&m);
  }
}

/* The pattern is that of elimination: columns of L by the rule that eliminating k joins what is left of its
 * neighbours, rows ascending, both lists of the same blocks. */
static void pattern_is_that_of_elimination(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 11;
  for (int round = 0; round < 50; round++) {
    static unsigned char full[MOST][MOST];
    matrix m;
    int n = 1 + (int)(uniform(&seed) * MOST), entries = 0;
    make(ctx, kernels[0], n, 0.08, &seed, &m);
    const gh_block_pattern *p = &m.pattern;
    memset(full, 0, sizeof full);
    for (size_t q = 0; q < 2 * m.graph.npairs; q += 2) {
      int i = p->place[m.pairs[q]], j = p->place[m.pairs[q + 1]];
      full[i][j] = full[j][i] = 1;
    }
    for (int k = 0; k < n; k++)
      for (int i = k + 1; i < n; i++)
        for (int j = k + 1; j < n; j++) full[i][j] |= full[i][k] && full[k][j] && i != j;
    for (int k = 0; k < n; k++) {
      int e = p->first[k], q = p->across[k];
      for (int i = k + 1; i < n; i++)
        if (full[i][k]) assert_int_equal(p->row[e++], i);
      assert_int_equal(e, p->first[k + 1]);
      for (int j = 0; j < k; j++) {
        if (!full[k][j]) continue;
        assert_int_equal(p->column[q], j);
        assert_int_equal(p->row[p->entry[q++]], k);
      }
      assert_int_equal(q, p->across[k + 1]);
      entries += e - p->first[k];
    }
    assert_int_equal(entries, p->first[n]);
    assert_true(gh_block_pattern_is_of(p, &m.graph));
    drop(&m);
  }
}

/* Without contacts between blocks a factor has the diagonal blocks themselves: their determinants are known. */
static void determinants_are_counted(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 3;
  matrix m;
  make(ctx, &gh_block_general_2, 5, 0, &seed, &m);
  static const double block[5][4] = {
      {1, 0, 0, 1}, {0, 1, 1, 0}, {-1, 0, 0, -1}, {2, 3, 1, 1}, {0, -4, 1, 1}}; /* dets 1 -1 1 -1 4 */
  for (int b = 0; b < 5; b++)
    for (int k = 0; k < 4; k++) m.dense[m.rows * (2 * b + k / 2) + 2 * b + k % 2] = block[b][k];
  fill(&m);
  assert_true(m.kernel->factor(&m.pattern, &m.values));
  assert_int_equal(m.values.negative, 2);
  NEAR("least", m.values.least, 0.5, 1e-15); /* of {2 3; 1 1}: 1 - 3/2 */
  NEAR("most", m.values.most, 4, 0);
  m.dense[0] = 0; /* {0 0; 0 1}: no pivot */
  fill(&m);
  assert_false(m.kernel->factor(&m.pattern, &m.values));
  drop(&m);
}

/* A symmetric matrix with one negative eigenvalue, however small, ends the factor; its shifted one does not.
 * Neither does NaN pass. */
static void indefinite_matrices_end_the_factor(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 5;
  for (int round = 0; round < 20; round++) {
    matrix m;
    make(ctx, &gh_block_symmetric_2, 20, 0.2, &seed, &m);
    draw_values(&m, &seed);
    assert_true(m.kernel->factor(&m.pattern, &m.values));
    double *entry = &m.dense[(m.rows + 1) * (round % m.rows)], was = *entry;
    double *x = draw_area(ctx, (size_t)m.rows, 1), *copy = draw_area(ctx, (size_t)m.rows, m.rows);
    x[round % m.rows] = 1;
    memcpy(copy, m.dense, (size_t)(m.rows * m.rows) * sizeof *copy);
    dense_solve(copy, m.rows, x); /* 1 / x: by how much the entry may fall */
    for (int side = -1; side <= 1; side += 2) {
      *entry = was - (1 - side * 1e-9) / x[round % m.rows];
      fill(&m);
      assert_int_equal(m.kernel->factor(&m.pattern, &m.values), side > 0);
    }
    *entry = NAN;
    fill(&m);
    assert_false(m.kernel->factor(&m.pattern, &m.values));
    free(x), free(copy);
    drop(&m);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(dense_elimination_agrees), TEST(pattern_is_that_of_elimination),
                                     TEST(determinants_are_counted),
                                     TEST(indefinite_matrices_end_the_factor)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
