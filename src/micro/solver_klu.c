/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Stiffness of positions and rotations with friction: unsymmetric, in compressed columns, its LU factor by
 * KLU of SuiteSparse.
 *
 * KLU and not UMFPACK: the factors are so sparse that UMFPACK's dense fronts do not pay
 * (docs/reports/performance.md). Blocks are of members, up to 3 x 3 (u_x, u_y, theta); the pattern of blocks
 * is symmetric. */
#include "micro/internal.h"

#include <klu.h>
#include <stdlib.h>
#include <string.h>

typedef struct coupled {
  gh_solver base;
  int *first;     /* members + 1: each member's blocks in `neighbour` */
  int *neighbour; /* per block: the other member, ascending; the own block is among them */
  int *row;       /* per block: its first row within each column of the member */
  int *p, *i;     /* compressed columns, rows ascending */
  double *x;
  double *solution; /* n x 4, column-major */
  int *old;         /* pattern of `symbolic`: p, then i */
  klu_common common;
  klu_symbolic *symbolic;
  klu_numeric *numeric;
  size_t neighbour_capacity, row_capacity, p_capacity, i_capacity, x_capacity, solution_capacity,
      old_capacity;
  int old_n;
} coupled;

/* ---- numbering and pattern ---- */

static void unknowns_number(coupled *s, const gh_solver_input *in, const int *component) {
  s->base.n = 0;
  for (int i = 0; i < s->base.members; i++) {
    int *u = &s->base.unknown[3 * i];
    bool moves = !in->rattler[i] && !(in->held && in->held[i]) && !(component && component[i] == i);
    u[0] = moves ? s->base.n++ : -1;
    u[1] = moves ? s->base.n++ : -1;
    u[2] = gh_solver_turns(in, i) ? s->base.n++ : -1;
  }
}

/* Lists for each member itself and those it touches, ascending: contacts come sorted by (i, j), so that the
 * smaller neighbours of a member come before it, and the larger ones after it. */
static void neighbours_list(coupled *s, const gh_contact_list *list) {
  int *first = s->first;
  for (int round = 0; round < 2; round++) {
    if (round == 0) memset(first, 0, ((size_t)s->base.members + 2) * sizeof *first);
    int *next = first + 1; /* round 0 counts into first[i + 2], round 1 fills from first[i + 1] */
    for (int half = 0; half < 3; half++)
      for (int c = 0; c < (half == 1 ? s->base.members : list->count); c++) {
        const gh_contact *q = half == 1 ? NULL : &list->contacts[c];
        bool again = q && c > 0 && q[-1].i == q->i && q[-1].j == q->j;
        if (q && (q->i == q->j || again)) continue;
        int a = !q ? c : half == 0 ? q->j : q->i, b = !q ? c : half == 0 ? q->i : q->j;
        if (round == 0) first[a + 2]++;
        else s->neighbour[next[a]++] = b;
      }
    if (round == 0)
      for (int i = 1; i <= s->base.members; i++) first[i + 1] += first[i];
  }
}

static int member_unknowns(const coupled *s, int member) {
  const int *u = &s->base.unknown[3 * member];
  return (u[0] >= 0) + (u[1] >= 0) + (u[2] >= 0);
}

static gh_status matrix_make_pattern(gh_context *ctx, coupled *s) {
  int *row = s->row;
  size_t nnz = 0;
  for (int m = 0; m < s->base.members; m++) {
    int height = 0;
    for (int b = s->first[m]; b < s->first[m + 1]; b++) {
      row[b] = height;
      height += member_unknowns(s, s->neighbour[b]);
    }
    nnz += (size_t)height * (size_t)member_unknowns(s, m);
  }
  GH_TRY(gh_grow(ctx, (size_t)s->base.n + 1, sizeof(int), &s->p_capacity, &s->p));
  GH_TRY(gh_grow(ctx, nnz + 1, sizeof(int), &s->i_capacity, &s->i));
  GH_TRY(gh_grow(ctx, nnz + 1, sizeof(double), &s->x_capacity, &s->x));
  int place = 0, column = 0;
  for (int m = 0; m < s->base.members; m++)
    for (int k = 0; k < 3; k++) {
      if (s->base.unknown[3 * m + k] < 0) continue;
      s->p[column++] = place;
      for (int b = s->first[m]; b < s->first[m + 1]; b++)
        for (int h = 0; h < 3; h++) {
          int u = s->base.unknown[3 * s->neighbour[b] + h];
          if (u >= 0) s->i[place++] = u;
        }
    }
  s->p[column] = place;
  return GH_OK;
}

static gh_status klu_number(gh_context *ctx, gh_solver *base, const gh_solver_input *in) {
  coupled *s = (coupled *)base;
  const gh_contact_list *list = in->list;
  size_t blocks = 2 * (size_t)list->count + (size_t)s->base.members;
  GH_TRY(gh_grow(ctx, blocks + 1, sizeof(int), &s->neighbour_capacity, &s->neighbour));
  GH_TRY(gh_grow(ctx, blocks + 1, sizeof(int), &s->row_capacity, &s->row));
  if (in->pin) /* the neighbours are free for use until the pattern is made */
    gh_find_components(s->base.members, list, NULL, s->neighbour);
  unknowns_number(s, in, in->pin ? s->neighbour : NULL);
  neighbours_list(s, list);
  GH_TRY(matrix_make_pattern(ctx, s));
  GH_TRY(gh_grow(ctx, 4 * (size_t)s->base.n + 4, sizeof(double), &s->base.rhs_capacity, &s->base.rhs));
  return gh_grow(ctx, 4 * (size_t)s->base.n + 4, sizeof(double), &s->solution_capacity, &s->solution);
}

/* ---- values ---- */

/* Adds the block of rows of member a and columns of member b. */
static void matrix_add_block(coupled *s, int a, int b, const double block[9]) {
  int low = s->first[b], high = s->first[b + 1] - 1;
  while (low < high) {
    int middle = (low + high) / 2;
    if (s->neighbour[middle] < a) low = middle + 1;
    else high = middle;
  }
  for (int k = 0; k < 3; k++) {
    int column = s->base.unknown[3 * b + k];
    if (column < 0) continue;
    int place = s->p[column] + s->row[low];
    for (int h = 0; h < 3; h++)
      if (s->base.unknown[3 * a + h] >= 0) s->x[place++] += block[3 * h + k];
  }
}

/* B_a^T D B_b with B = (sign, sign, r) on the diagonal. */
static void matrix_add_contact(coupled *s, const gh_contact *q, const double *d, const double *radius) {
  const int end[2] = {q->i, q->j};
  double scale[2][3], block[9];
  for (int e = 0; e < 2; e++) {
    scale[e][0] = scale[e][1] = gh_end_sign(e);
    scale[e][2] = radius[end[e]];
  }
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) {
      for (int h = 0; h < 3; h++)
        for (int k = 0; k < 3; k++) block[3 * h + k] = scale[a][h] * d[3 * h + k] * scale[b][k];
      matrix_add_block(s, end[a], end[b], block);
    }
}

static void matrix_assemble(coupled *s, const double *radius, const gh_contact_list *list, double shift) {
  memset(s->x, 0, (size_t)s->p[s->base.n] * sizeof *s->x);
  for (int c = 0; c < list->count; c++)
    matrix_add_contact(s, &list->contacts[c], list->friction[c].d, radius);
  if (!(shift > 0)) return;
  for (int m = 0; m < s->base.members; m++) {
    double r2 = radius[m] * radius[m], block[9] = {shift, 0, 0, 0, shift, 0, 0, 0, shift * r2};
    matrix_add_block(s, m, m, block);
  }
}

/* The symbolic analysis is kept while the pattern stays. */
static gh_status pattern_analyse(gh_context *ctx, coupled *s) {
  size_t np = (size_t)s->base.n + 1, ni = (size_t)s->p[s->base.n];
  bool same = s->symbolic && s->old_n == s->base.n && !memcmp(s->old, s->p, np * sizeof(int)) &&
              !memcmp(s->old + np, s->i, ni * sizeof(int));
  if (same) return GH_OK;
  GH_TRY(gh_grow(ctx, np + ni, sizeof(int), &s->old_capacity, &s->old));
  memcpy(s->old, s->p, np * sizeof(int));
  memcpy(s->old + np, s->i, ni * sizeof(int));
  s->old_n = s->base.n;
  s->base.analyses++;
  klu_free_symbolic(&s->symbolic, &s->common);
  s->symbolic = klu_analyze(s->base.n, s->p, s->i, &s->common);
  if (s->symbolic) return GH_OK;
  return gh_fail(ctx, GH_MEMORY, "KLU failed to analyse a stiffness of %d unknowns (status %d)", s->base.n,
                 s->common.status);
}

/* Pivots of rotations are those of displacements times the radius, which KLU's scaling of rows leaves in: in
 * units in which grains are tiny or huge, a regular matrix has a condition that small. */
static double condition_find_least(const coupled *s, const double *radius) {
  static const double least = 1e-14, usual = 1e3; /* radii of 1e-3 to 1e3 count as 1 */
  double mean = 0;
  for (int m = 0; m < s->base.members; m++) mean += radius[m] / s->base.members;
  return least * fmin(1, usual * fmin(mean, 1 / mean));
}

static gh_status klu_factor_stiffness(gh_context *ctx, gh_solver *base, const gh_solver_input *in,
                                      double shift, bool *regular) {
  coupled *s = (coupled *)base;
  *regular = true;
  if (s->base.n == 0) return GH_OK;
  matrix_assemble(s, in->radius, in->list, shift);
  if (!gh_finite(s->x, (size_t)s->p[s->base.n]))
    return gh_fail(ctx, GH_DIVERGED, "the stiffness of the packing is not finite");
  GH_TRY(pattern_analyse(ctx, s));
  klu_free_numeric(&s->numeric, &s->common);
  s->numeric = klu_factor(s->p, s->i, s->x, s->symbolic, &s->common);
  s->base.factorisations++;
  if (s->common.status < KLU_OK)
    return gh_fail(ctx, GH_MEMORY, "KLU failed to factorise a stiffness of %d unknowns (status %d)",
                   s->base.n, s->common.status);
  *regular = s->numeric && s->common.status == KLU_OK && klu_rcond(s->symbolic, s->numeric, &s->common) &&
             s->common.rcond > condition_find_least(s, in->radius);
  return GH_OK;
}

static gh_status klu_solve_columns(gh_context *ctx, gh_solver *base, int ncol, const double **X) {
  coupled *s = (coupled *)base;
  size_t n = (size_t)s->base.n;
  *X = s->solution;
  if (n == 0) return GH_OK;
  memcpy(s->solution, s->base.rhs, n * (size_t)ncol * sizeof(double));
  if (!klu_solve(s->symbolic, s->numeric, s->base.n, ncol, s->solution, &s->common))
    return gh_fail(ctx, GH_MEMORY, "KLU failed to solve for %d unknowns (status %d)", s->base.n,
                   s->common.status);
  if (!gh_finite(s->solution, n * (size_t)ncol))
    return gh_fail(ctx, GH_DIVERGED, "the solution with the stiffness of the packing is not finite");
  return GH_OK;
}

static void klu_release(gh_solver *base) {
  coupled *s = (coupled *)base;
  klu_free_symbolic(&s->symbolic, &s->common);
  klu_free_numeric(&s->numeric, &s->common);
  void *const arrays[] = {s->first, s->neighbour, s->row, s->p, s->i, s->x, s->solution, s->old};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
}

static const gh_solver_ops klu_ops = {.name = "KLU",
                                      .number = klu_number,
                                      .factor = klu_factor_stiffness,
                                      .solve = klu_solve_columns,
                                      .release = klu_release};

gh_status gh_solver_klu(gh_context *ctx, int members, gh_solver **solver) {
  coupled *s;
  *solver = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *s, &s));
  s->base.ops = &klu_ops;
  s->base.members = members;
  klu_defaults(&s->common);
  s->common.btf = 0; /* the pattern is symmetric and one connected component */
  gh_status status = gh_alloc(ctx, 3 * (size_t)members, sizeof(int), &s->base.unknown);
  if (status == GH_OK) status = gh_alloc(ctx, (size_t)members + 2, sizeof(int), &s->first);
  *solver = &s->base;
  if (status != GH_OK) gh_solver_destroy(solver);
  return status;
}
