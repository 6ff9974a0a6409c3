/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Sparse matrices of small dense blocks, one block row per grain, and their factors. Private to
 * solver_block.c, block_*.c and their tests.
 *
 * The pattern of blocks is symmetric; values may not be. Blocks are eliminated in the order of AMD on the
 * graph of blocks, each diagonal block by itself: L is unit block lower triangular, the upper factor U has
 * the diagonal blocks D_k. Inside a diagonal block rows are exchanged (partial pivoting); between blocks they
 * are not. Without that, growth shows in the residual of a solve, which the caller tests.
 *
 * A factor is a function of the pattern and the values alone: nothing of earlier ones enters. */
#ifndef GRANHOM_MICRO_BLOCK_H
#define GRANHOM_MICRO_BLOCK_H

#include "granhom/base.h"

/* A block of `size` x `size` numbers is stored by columns of `stride` numbers, of which those beyond `size`
 * are zero: blocks of 3 fill vectors of 4. */
enum { GH_BLOCK_COLUMNS = 4 }; /* right-hand sides that are solved together */

/* A graph of n blocks: pairs i < j, sorted by (i, j), each once. */
typedef struct gh_block_graph {
  int n;
  size_t npairs;
  const int *pairs; /* npairs x 2 */
} gh_block_graph;

/* Order of elimination and patterns of A, L and U. Blocks have their place in that order from `place_of` on. */
typedef struct gh_block_pattern {
  int n;
  size_t npairs;
  int *pairs;            /* of the graph that the rest was made of */
  int *place;            /* per block of the graph: its place */
  int *a_first, *a_row;  /* n + 1, 2 npairs: neighbours of each place, in the order of the pairs */
  int *a_slot;           /* npairs x 2: places of the blocks (i, j) and (j, i) in a_row */
  int *first, *row;      /* n + 1: rows of the columns of L below the diagonal, ascending */
  int *across, *column;  /* n + 1: columns of the rows of L left of the diagonal, ascending */
  int *entry;            /* per `column`: that block's place in `row` */
  unsigned char *joined; /* per column: the one before has this row and all rows of this one, and no other */
  int *parent, *mark;    /* elimination tree; work */
  int *work;             /* of AMD */
  size_t n_capacity, pairs_capacity, factor_capacity, work_capacity;
  bool made;
} gh_block_pattern;

gh_status gh_block_pattern_make(gh_context *ctx, gh_block_pattern *p, const gh_block_graph *graph);
/* Whether the pattern was made of this very graph. */
bool gh_block_pattern_is_of(const gh_block_pattern *p, const gh_block_graph *graph);
void gh_block_pattern_release(gh_block_pattern *p);

/* Values of A and its factor; all arrays of blocks. */
typedef struct gh_block_values {
  double *diagonal;   /* n, by place */
  double *a;          /* parallel to a_row: the blocks of a column (place p: a_first[p] ...) */
  double *l, *u;      /* parallel to `row` and `column`; u: NULL where A is symmetric */
  double *d;          /* n: triangular factors of the diagonal blocks, pivots inverted */
  int *exchange;      /* n x size: rows of a diagonal block in the order of their pivots */
  double *column;     /* n: the column that is made */
  double *y;          /* n x size x GH_BLOCK_COLUMNS: right-hand sides, then solutions, by place */
  double negligible;  /* pivots up to this are none; symmetric matrices: those up to zero */
  double least, most; /* magnitudes of pivots */
  int negative;       /* diagonal blocks with a negative determinant */
  bool singular;      /* a pivot is none, and no other row has one in its place */
} gh_block_values;

/* One size of blocks. */
typedef struct gh_block_kernel {
  int size, stride;
  /* Symmetric: from the blocks of A below the diagonal (rows after columns) alone, without exchanges; false:
   * a pivot is not positive. Else false: a pivot is negligible or not finite. */
  bool symmetric;
  bool (*factor)(const gh_block_pattern *p, gh_block_values *v);
  /* Solves in v->y, where each number is a row of `ncol` columns (1 or GH_BLOCK_COLUMNS). */
  void (*solve)(const gh_block_pattern *p, gh_block_values *v, int ncol);
  /* r -= A x, both like v->y. */
  void (*subtract)(const gh_block_pattern *p, const gh_block_values *v, int ncol, const double *x, double *r);
} gh_block_kernel;

extern const gh_block_kernel gh_block_symmetric_2, gh_block_general_1, gh_block_general_2, gh_block_general_3;

#endif
