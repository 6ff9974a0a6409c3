/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Stiffness of an RVE in blocks of one grain each, and its factor: LDL^T without friction (2 x 2), LU with it
 * (u_x, u_y, r theta; two or one of them where rotations or all positions are fixed).
 *
 * Rotations are counted in r theta: forces and moments over r then have one unit. A grain of which some
 * unknowns are fixed keeps its whole block, with a diagonal row in the place of what is fixed.
 *
 * KLU (CHOLMOD) solves where the block factor is no good: LU comes to a pivot of zero that exchanges of rows
 * between grains would avoid, or a solution does not fit.
 *
 * What is solved depends on the contacts and the input alone: the order of elimination is that of the current
 * graph, and an order is kept only for the same graph. So an RVE gives the same bits whatever the workspace
 * solved before, on any number of ranks and after a restart. */
#include "micro/block.h"
#include "micro/internal.h"

#include <stdlib.h>
#include <string.h>

/* Pivots with friction over the largest entry: what is less is round-off. Symmetric: over the largest pivot;
 * the matrix is semidefinite to round-off. */
static const double negligible_pivot = 1e-14, least_pivot = 1e-15;
/* Largest residual of a solve, over the sizes of both sides. */
static const double good_fit = 1e-12;

typedef struct blocks {
  gh_solver base;
  bool symmetric;
  const gh_block_kernel *kernel;
  gh_block_pattern pattern;
  gh_block_values values;
  int *block;              /* per member: its block, -1 when nothing of it is unknown */
  int *pairs;              /* contacts between different blocks, each pair once */
  int *slot;               /* per contact: its pair, -1 for none */
  int *entry;              /* per unknown: its row in values.y */
  double *scale;           /* per unknown: 1; 1 / r for rotations */
  double *solution, *rest; /* n x 4; like values.y: residual */
  double size;             /* largest entry of the diagonal blocks */
  int nblocks;
  size_t pairs_capacity, slot_capacity, entry_capacity, scale_capacity, solution_capacity, block_capacity[3],
      matrix_capacity, factor_capacity[2], exchange_capacity, y_capacity[2];
  gh_solver *spare;   /* NULL until it is needed */
  gh_solver_input in; /* of the last factor */
  double shift;
  bool on_spare;
} blocks;

/* ---- numbering ---- */

static void unknowns_number(blocks *s, const gh_solver_input *in, const int *component) {
  int moving = 0;
  s->base.n = s->nblocks = 0;
  for (int i = 0; i < s->base.members; i++) {
    int *u = &s->base.unknown[3 * i];
    bool moves = !in->rattler[i] && !(in->held && in->held[i]) && !(component && component[i] == i);
    u[0] = moves ? s->base.n++ : -1;
    u[1] = moves ? s->base.n++ : -1;
    u[2] = gh_solver_turns(in, i) ? s->base.n++ : -1;
    s->block[i] = moves || u[2] >= 0 ? s->nblocks++ : -1;
    moving += moves;
  }
  s->kernel = s->symmetric ? &gh_block_symmetric_2
              : !in->turns ? &gh_block_general_2
              : moving > 0 ? &gh_block_general_3
                           : &gh_block_general_1;
}

static gh_status block_number(gh_context *ctx, gh_solver *base, const gh_solver_input *in) {
  blocks *s = (blocks *)base;
  int *component = s->block; /* free for use until members are numbered, each after its component is read */
  if (in->pin) gh_find_components(base->members, in->list, in->rattler, component);
  unknowns_number(s, in, in->pin ? component : NULL);
  const size_t n = (size_t)base->n, columns = GH_BLOCK_COLUMNS;
  GH_TRY(gh_grow(ctx, n + 1, sizeof(int), &s->entry_capacity, &s->entry));
  GH_TRY(gh_grow(ctx, n + 1, sizeof(double), &s->scale_capacity, &s->scale));
  GH_TRY(gh_grow(ctx, columns * (n + 1), sizeof(double), &base->rhs_capacity, &base->rhs));
  return gh_grow(ctx, columns * (n + 1), sizeof(double), &s->solution_capacity, &s->solution);
}

/* First component of a member's unknowns that is in its block: rotations alone are in blocks of one. */
static int block_offset(const blocks *s) {
  return s->kernel->size == 1 ? 2 : 0;
}

/* ---- pattern ---- */

/* Pairs of blocks in contact: contacts come sorted by (i, j). */
static gh_status graph_collect(gh_context *ctx, blocks *s, const gh_contact_list *list,
                               gh_block_graph *graph) {
  const size_t count = (size_t)list->count;
  GH_TRY(gh_grow(ctx, count + 1, sizeof(int), &s->slot_capacity, &s->slot));
  GH_TRY(gh_grow(ctx, 2 * count + 2, sizeof(int), &s->pairs_capacity, &s->pairs));
  int npairs = 0;
  for (int c = 0; c < list->count; c++) {
    int i = s->block[list->contacts[c].i], j = s->block[list->contacts[c].j], *last = s->pairs + 2 * npairs;
    s->slot[c] = -1;
    if (i < 0 || j < 0 || i == j) continue;
    if (!npairs || last[-2] != i || last[-1] != j) {
      last[0] = i;
      last[1] = j;
      npairs++;
    }
    s->slot[c] = npairs - 1;
  }
  *graph = (gh_block_graph){.n = s->nblocks, .npairs = (size_t)npairs, .pairs = s->pairs};
  return GH_OK;
}

static gh_status values_reserve(gh_context *ctx, blocks *s) {
  gh_block_values *v = &s->values;
  const size_t area = (size_t)(s->kernel->size * s->kernel->stride), n = (size_t)s->nblocks,
               factor = (size_t)s->pattern.first[s->nblocks], rows = n * (size_t)s->kernel->size;
  double **const of_blocks[] = {&v->diagonal, &v->d, &v->column};
  double **const of_factor[] = {&v->l, &v->u};
  double **const of_columns[] = {&v->y, &s->rest};
  for (int k = 0; k < 3; k++)
    GH_TRY(gh_grow(ctx, area * n + 1, sizeof(double), &s->block_capacity[k], of_blocks[k]));
  for (int k = 0; k < 2; k++) {
    GH_TRY(gh_grow(ctx, area * factor + 1, sizeof(double), &s->factor_capacity[k], of_factor[k]));
    GH_TRY(gh_grow(ctx, GH_BLOCK_COLUMNS * rows + 1, sizeof(double), &s->y_capacity[k], of_columns[k]));
  }
  GH_TRY(gh_grow(ctx, 2 * area * s->pattern.npairs + 1, sizeof(double), &s->matrix_capacity, &v->a));
  return gh_grow(ctx, rows + 1, sizeof(int), &s->exchange_capacity, &v->exchange);
}

static gh_status pattern_make(gh_context *ctx, blocks *s, const gh_solver_input *in) {
  gh_block_graph graph;
  GH_TRY(graph_collect(ctx, s, in->list, &graph));
  if (!gh_block_pattern_is_of(&s->pattern, &graph)) {
    GH_TRY(gh_block_pattern_make(ctx, &s->pattern, &graph));
    s->base.analyses++;
  }
  GH_TRY(values_reserve(ctx, s));
  const int offset = block_offset(s), size = s->kernel->size;
  for (int m = 0; m < s->base.members; m++)
    for (int h = 0; h < 3; h++) {
      int u = s->base.unknown[3 * m + h];
      if (u < 0) continue;
      s->entry[u] = size * s->pattern.place[s->block[m]] + h - offset;
      s->scale[u] = h == 2 ? 1 / in->radius[m] : 1;
    }
  return GH_OK;
}

/* ---- values ---- */

static double *diagonal_of(const blocks *s, int block) {
  return s->values.diagonal + s->kernel->size * s->kernel->stride * s->pattern.place[block];
}

/* Without friction, -h between the ends of a contact, h on both diagonals. */
static void contacts_add_symmetric(blocks *s, const gh_solver_input *in) {
  double *const a = s->values.a;
  const int *slot = s->pattern.a_slot;
  for (int c = 0; c < in->list->count; c++) {
    const gh_contact *q = &in->list->contacts[c];
    if (q->i == q->j || in->rattler[q->i] || in->rattler[q->j]) continue;
    const double h[4] = {q->h[0], q->h[1], q->h[1], q->h[2]};
    const int end[2] = {s->block[q->i], s->block[q->j]};
    for (int e = 0; e < 2; e++) {
      if (end[e] < 0) continue;
      double *d = diagonal_of(s, end[e]);
      for (int k = 0; k < 4; k++) d[k] += h[k];
    }
    if (s->slot[c] < 0) continue;
    for (int e = 0; e < 2; e++)
      for (int k = 0; k < 4; k++) a[4 * slot[2 * s->slot[c] + e] + k] -= h[k];
  }
}

/* B_a^T D B_b with B = (sign, sign, 1) on the diagonal, 0 for what is fixed; `to` by columns. The bounds are
 * constants where it is called. */
static inline __attribute__((always_inline)) void
product_add_sized(int size, int stride, int offset, const double *restrict left, const double *restrict d,
                  const double *restrict right, double *restrict to) {
  for (int k = 0; k < size; k++)
    for (int h = 0; h < size; h++)
      to[stride * k + h] += left[h + offset] * d[3 * (h + offset) + k + offset] * right[k + offset];
}

static void product_add(const blocks *s, const double *left, const double *d, const double *right,
                        double *to) {
  switch (s->kernel->size) {
  case 3:
    product_add_sized(3, 4, 0, left, d, right, to);
    return;
  case 2:
    product_add_sized(2, 2, 0, left, d, right, to);
    return;
  default:
    product_add_sized(1, 1, 2, left, d, right, to);
  }
}

static void contacts_add_general(blocks *s, const gh_solver_input *in) {
  const int area = s->kernel->size * s->kernel->stride;
  for (int c = 0; c < in->list->count; c++) {
    const gh_contact *q = &in->list->contacts[c];
    const double *d = in->list->friction[c].d;
    const int member[2] = {q->i, q->j};
    double scale[2][3];
    for (int e = 0; e < 2; e++)
      for (int h = 0; h < 3; h++)
        scale[e][h] = s->base.unknown[3 * member[e] + h] < 0 ? 0 : h < 2 ? gh_end_sign(e) : 1;
    for (int e = 0; e < 2; e++)
      if (s->block[member[e]] >= 0)
        product_add(s, scale[e], d, scale[e], diagonal_of(s, s->block[member[e]]));
    if (q->i == q->j && s->block[q->i] >= 0)
      for (int e = 0; e < 2; e++) product_add(s, scale[e], d, scale[1 - e], diagonal_of(s, s->block[q->i]));
    if (s->slot[c] < 0) continue;
    const int *slot = &s->pattern.a_slot[2 * s->slot[c]];
    for (int e = 0; e < 2; e++) /* slot[0] is the block of row i and column j */
      product_add(s, scale[e], d, scale[1 - e], s->values.a + area * slot[e]);
  }
}

/* Shift, size of the matrix, and the rows of what is fixed. GH_DIVERGED: a value is not finite; each value
 * of a contact is in a diagonal block. */
static gh_status diagonal_complete(gh_context *ctx, blocks *s, double shift) {
  const int size = s->kernel->size, stride = s->kernel->stride, offset = block_offset(s);
  const size_t all = (size_t)(size * stride) * (size_t)s->nblocks;
  s->size = 0;
  if (!gh_finite(s->values.diagonal, all))
    return gh_fail(ctx, GH_DIVERGED, "the stiffness of the packing is not finite");
  for (size_t k = 0; k < all; k++) s->size = gh_max(s->size, fabs(s->values.diagonal[k]));
  s->size = gh_max(s->size, shift);
  for (int m = 0; m < s->base.members; m++) {
    if (s->block[m] < 0) continue;
    double *d = diagonal_of(s, s->block[m]);
    for (int h = 0; h < size; h++)
      d[(stride + 1) * h] += s->base.unknown[3 * m + h + offset] >= 0 ? shift : s->size;
  }
  return GH_OK;
}

static gh_status matrix_assemble(gh_context *ctx, blocks *s, const gh_solver_input *in, double shift) {
  const size_t area = (size_t)(s->kernel->size * s->kernel->stride);
  memset(s->values.diagonal, 0, area * (size_t)s->nblocks * sizeof(double));
  memset(s->values.a, 0, 2 * area * s->pattern.npairs * sizeof(double));
  if (s->symmetric) contacts_add_symmetric(s, in);
  else contacts_add_general(s, in);
  return diagonal_complete(ctx, s, shift);
}

/* ---- factor and solution ---- */

static gh_status spare_factor(gh_context *ctx, blocks *s, bool *good) {
  if (!s->spare)
    GH_TRY(s->symmetric ? gh_solver_cholmod(ctx, s->base.members, &s->spare)
                        : gh_solver_klu(ctx, s->base.members, &s->spare));
  s->base.fallbacks++;
  GH_TRY(gh_solver_number(ctx, s->spare, &s->in));
  return gh_solver_factor(ctx, s->spare, &s->in, s->shift, good);
}

static gh_status block_factor_stiffness(gh_context *ctx, gh_solver *base, const gh_solver_input *in,
                                        double shift, bool *good) {
  blocks *s = (blocks *)base;
  *good = true;
  s->on_spare = false;
  base->negative = 0;
  if (base->n == 0) return GH_OK;
  s->in = *in;
  s->shift = shift > 0 ? shift : 0;
  GH_TRY(pattern_make(ctx, s, in));
  GH_TRY(matrix_assemble(ctx, s, in, s->shift));
  gh_block_values *v = &s->values;
  v->negligible = negligible_pivot * s->size;
  const bool complete = s->kernel->factor(&s->pattern, &s->values);
  base->factorisations++;
  base->negative = complete ? v->negative : -1;
  *good = complete && (!s->symmetric || v->least > least_pivot * v->most);
  if (*good || s->symmetric || v->singular) return GH_OK;
  GH_TRY(spare_factor(ctx, s, good));
  s->on_spare = *good;
  return GH_OK;
}

static gh_status spare_solve(gh_context *ctx, blocks *s, int ncol, const double **X) {
  memcpy(s->spare->rhs, s->base.rhs, (size_t)ncol * (size_t)s->base.n * sizeof(double));
  return gh_solver_solve(ctx, s->spare, ncol, X);
}

/* Between s->base.rhs, or s->solution, and rows of `width` columns. */
static void columns_gather(const blocks *s, int ncol, int width, double *y) {
  const size_t n = (size_t)s->base.n;
  memset(y, 0, (size_t)(s->nblocks * s->kernel->size * width) * sizeof *y);
  for (size_t u = 0; u < n; u++)
    for (int k = 0; k < ncol; k++) y[width * s->entry[u] + k] = s->scale[u] * s->base.rhs[n * (size_t)k + u];
}

static void columns_scatter(const blocks *s, int ncol, int width, const double *y) {
  const size_t n = (size_t)s->base.n;
  for (size_t u = 0; u < n; u++)
    for (int k = 0; k < ncol; k++) s->solution[n * (size_t)k + u] = s->scale[u] * y[width * s->entry[u] + k];
}

/* Largest magnitude in each column of an array of rows. */
static void columns_find_largest(const double *y, int rows, int width, double *largest) {
  for (int k = 0; k < width; k++) largest[k] = 0;
  for (int r = 0; r < rows; r++)
    for (int k = 0; k < width; k++) {
      double size = fabs(y[width * r + k]);
      if (!(size <= largest[k])) largest[k] = size; /* NaN stays */
    }
}

/* Backward error of each column: the residual over what both sides of the equation are made of. */
static bool solution_fits(blocks *s, int ncol, int width) {
  const int rows = s->nblocks * s->kernel->size;
  double b[GH_BLOCK_COLUMNS], x[GH_BLOCK_COLUMNS], rest[GH_BLOCK_COLUMNS];
  columns_gather(s, ncol, width, s->rest);
  columns_find_largest(s->rest, rows, width, b);
  columns_find_largest(s->values.y, rows, width, x);
  s->kernel->subtract(&s->pattern, &s->values, width, s->values.y, s->rest);
  columns_find_largest(s->rest, rows, width, rest);
  for (int k = 0; k < ncol; k++)
    if (!(rest[k] <= good_fit * (b[k] + s->size * x[k]))) return false;
  return true;
}

static gh_status block_solve_columns(gh_context *ctx, gh_solver *base, int ncol, const double **X) {
  blocks *s = (blocks *)base;
  const int width = ncol == 1 ? 1 : GH_BLOCK_COLUMNS;
  *X = s->solution;
  if (base->n == 0) return GH_OK;
  if (s->on_spare) return spare_solve(ctx, s, ncol, X);
  columns_gather(s, ncol, width, s->values.y);
  s->kernel->solve(&s->pattern, &s->values, width);
  if (!solution_fits(s, ncol, width)) {
    GH_TRY(spare_factor(ctx, s, &s->on_spare));
    if (s->on_spare) return spare_solve(ctx, s, ncol, X);
  }
  columns_scatter(s, ncol, width, s->values.y);
  if (!gh_finite(s->solution, (size_t)base->n * (size_t)ncol))
    return gh_fail(ctx, GH_DIVERGED, "the solution with the stiffness of the packing is not finite");
  return GH_OK;
}

static void block_release(gh_solver *base) {
  blocks *s = (blocks *)base;
  gh_block_values *v = &s->values;
  gh_block_pattern_release(&s->pattern);
  gh_solver_destroy(&s->spare);
  void *const arrays[] = {s->block, s->pairs, s->slot, s->entry,  s->scale, s->solution, s->rest,    v->a,
                          v->l,     v->u,     v->d,    v->column, v->y,     v->diagonal, v->exchange};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
}

static const gh_solver_ops block_ops = {.name = "blocks",
                                        .number = block_number,
                                        .factor = block_factor_stiffness,
                                        .solve = block_solve_columns,
                                        .release = block_release};

gh_status gh_solver_block(gh_context *ctx, int members, bool symmetric, gh_solver **solver) {
  blocks *s;
  *solver = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *s, &s));
  s->base.ops = &block_ops;
  s->base.members = members;
  s->symmetric = symmetric;
  gh_status status = gh_alloc(ctx, 3 * (size_t)members, sizeof(int), &s->base.unknown);
  if (status == GH_OK) status = gh_alloc(ctx, (size_t)members, sizeof(int), &s->block);
  *solver = &s->base;
  if (status != GH_OK) gh_solver_destroy(solver);
  return status;
}
