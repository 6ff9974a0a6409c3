/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Stiffness of the free grains without friction, its Cholesky factor by CHOLMOD. */
#include "micro/internal.h"

#include <cholmod.h>
#include <stdlib.h>
#include <string.h>

typedef struct stiffness { /* (4.12) */
  gh_solver base;
  cholmod_common common;
  cholmod_sparse K;         /* upper triangle, order 2 nactive; arrays owned here */
  cholmod_factor *L;        /* NULL before the first analysis */
  cholmod_dense *X, *Y, *E; /* solution and CHOLMOD's workspaces */
  int nactive;
  int *active;   /* per member: number among the unknown grains, -1 when fixed, rattler or pinned */
  int *slot;     /* per contact: place of its off-diagonal block, -1 for none */
  int *diagonal; /* per unknown grain: place of its diagonal entries xx, xy (yy follows) */
  int *pattern;  /* contacts of the pattern: unknown grains i < j, in order */
  size_t slot_capacity, pattern_capacity, npattern;
  size_t k_capacity, p_capacity, i_capacity, diagonal_capacity;
} stiffness;

static gh_status cholmod_number(gh_context *ctx, gh_solver *base, const gh_solver_input *in) {
  stiffness *s = (stiffness *)base;
  const int n = base->members;
  int *a = s->active;
  GH_TRY(gh_grow(ctx, 2 * (size_t)n + 2, sizeof(int), &s->diagonal_capacity, &s->diagonal));
  int *component = s->diagonal; /* free for use until the pattern is made */
  if (in->pin) gh_find_components(n, in->list, in->rattler, component);
  s->nactive = 0;
  for (int i = 0; i < n; i++) {
    bool pinned = in->pin && component[i] == i, known = (in->held && in->held[i]) || in->rattler[i] || pinned;
    int *u = base->unknown + 3 * i;
    a[i] = known ? -1 : s->nactive++;
    u[0] = known ? -1 : 2 * a[i];
    u[1] = known ? -1 : 2 * a[i] + 1;
    u[2] = -1;
  }
  base->n = 2 * s->nactive;
  return GH_OK;
}

/* Contacts between two unknown grains, one entry per pair: contacts come sorted by (i, j). */
static gh_status pattern_collect(gh_context *ctx, stiffness *s, const gh_contact *contacts, int ncontacts,
                                 int **pairs, size_t *npairs) {
  GH_TRY(gh_grow(ctx, (size_t)ncontacts + 1, sizeof(int), &s->slot_capacity, &s->slot));
  GH_TRY(gh_grow(ctx, 2 * (s->npattern + (size_t)ncontacts), sizeof(int), &s->pattern_capacity, &s->pattern));
  int *list = s->pattern + 2 * s->npattern; /* behind the pattern in use, to compare with it */
  size_t count = 0;
  for (int c = 0; c < ncontacts; c++) {
    int i = s->active[contacts[c].i], j = s->active[contacts[c].j];
    s->slot[c] = -1;
    if (i < 0 || j < 0 || i == j) continue;
    if (!count || list[2 * count - 2] != i || list[2 * count - 1] != j) {
      list[2 * count] = i;
      list[2 * count + 1] = j;
      count++;
    }
    s->slot[c] = (int)count - 1; /* number of the pair; the place comes later */
  }
  *pairs = list;
  *npairs = count;
  return GH_OK;
}

/* Compressed columns of the upper triangle. Column block j holds the blocks (i, j), i ascending, then its
 * diagonal. */
static gh_status matrix_make_columns(gh_context *ctx, stiffness *s) {
  size_t n = (size_t)s->nactive, nnz = 4 * s->npattern + 3 * n;
  GH_TRY(gh_grow(ctx, 2 * n + 1, sizeof(int), &s->p_capacity, &s->K.p));
  GH_TRY(gh_grow(ctx, nnz + 1, sizeof(int), &s->i_capacity, &s->K.i));
  GH_TRY(gh_grow(ctx, nnz + 1, sizeof(double), &s->k_capacity, &s->K.x));
  GH_TRY(gh_grow(ctx, 8 * n + 4, sizeof(double), &s->base.rhs_capacity, &s->base.rhs));
  int *p = s->K.p, *row = s->K.i;
  memset(p, 0, (2 * n + 1) * sizeof(int));
  for (size_t q = 0; q < s->npattern; q++) {
    p[2 * s->pattern[2 * q + 1] + 1] += 2;
    p[2 * s->pattern[2 * q + 1] + 2] += 2;
  }
  for (size_t a = 0; a < n; a++) p[2 * a + 1] += 1, p[2 * a + 2] += 2;
  for (size_t c = 0; c < 2 * n; c++) p[c + 1] += p[c];
  for (size_t a = 0; a < n; a++) { /* the diagonal is last in its columns */
    s->diagonal[2 * a] = p[2 * a + 1] - 1;
    s->diagonal[2 * a + 1] = p[2 * a + 2] - 2;
    row[s->diagonal[2 * a]] = (int)(2 * a);
    row[s->diagonal[2 * a + 1]] = (int)(2 * a);
    row[s->diagonal[2 * a + 1] + 1] = (int)(2 * a + 1);
  }
  s->K.nrow = s->K.ncol = 2 * n;
  s->K.nzmax = nnz;
  s->K.stype = 1;
  s->K.itype = CHOLMOD_INT;
  s->K.xtype = CHOLMOD_REAL;
  s->K.dtype = CHOLMOD_DOUBLE;
  s->K.sorted = s->K.packed = 1;
  return GH_OK;
}

/* Turns the numbers of pairs in slot into places: first entry of the block's first column. `fill` is the next
 * free place of a column block. */
static void matrix_place_blocks(stiffness *s, int ncontacts, int *fill) {
  const int *p = s->K.p;
  int *row = s->K.i;
  for (int a = 0; a < s->nactive; a++) fill[a] = 0;
  int last = -1, place = -1;
  for (int c = 0; c < ncontacts; c++) {
    if (s->slot[c] < 0) continue;
    if (s->slot[c] != last) {
      last = s->slot[c];
      int i = s->pattern[2 * last], j = s->pattern[2 * last + 1];
      place = p[2 * j] + fill[j];
      int second = p[2 * j + 1] + fill[j];
      row[place] = row[second] = 2 * i;
      row[place + 1] = row[second + 1] = 2 * i + 1;
      fill[j] += 2;
    }
    s->slot[c] = place;
  }
}

static void matrix_assemble(stiffness *s, const unsigned char *rattler, const gh_contact *contacts,
                            int ncontacts, double shift) {
  double *k = s->K.x;
  const int *p = s->K.p;
  memset(k, 0, s->K.nzmax * sizeof *k);
  for (int c = 0; c < ncontacts; c++) {
    const gh_contact *q = &contacts[c];
    int end[2] = {s->active[q->i], s->active[q->j]};
    if (q->i == q->j || rattler[q->i] || rattler[q->j]) continue;
    for (int e = 0; e < 2; e++) {
      if (end[e] < 0) continue;
      k[s->diagonal[2 * end[e]]] += q->h[0];
      k[s->diagonal[2 * end[e] + 1]] += q->h[1];
      k[s->diagonal[2 * end[e] + 1] + 1] += q->h[2];
    }
    if (s->slot[c] < 0) continue;
    int first = s->slot[c], second = first - p[2 * end[1]] + p[2 * end[1] + 1]; /* i < j: columns of j */
    k[first] -= q->h[0];
    k[first + 1] -= q->h[1];
    k[second] -= q->h[1];
    k[second + 1] -= q->h[2];
  }
  if (shift > 0)
    for (int a = 0; a < s->nactive; a++) {
      k[s->diagonal[2 * a]] += shift;
      k[s->diagonal[2 * a + 1] + 1] += shift;
    }
}

static gh_status cholmod_factor_stiffness(gh_context *ctx, gh_solver *base, const gh_solver_input *in,
                                          double shift, bool *definite) {
  stiffness *s = (stiffness *)base;
  const gh_contact *contacts = in->list->contacts;
  const int ncontacts = in->list->count;
  *definite = true;
  if (s->nactive == 0) return GH_OK;
  int *pairs;
  size_t npairs, n = (size_t)s->nactive;
  GH_TRY(pattern_collect(ctx, s, contacts, ncontacts, &pairs, &npairs));
  bool same = s->L && s->L->n == 2 * n && npairs == s->npattern &&
              !memcmp(pairs, s->pattern, 2 * npairs * sizeof(int));
  if (!same) {
    memmove(s->pattern, pairs, 2 * npairs * sizeof(int));
    s->npattern = npairs;
  }
  GH_TRY(matrix_make_columns(ctx, s));    /* the numbering used the same memory for its groups */
  int *fill = (int *)(void *)s->base.rhs; /* not in use yet */
  matrix_place_blocks(s, ncontacts, fill);
  matrix_assemble(s, in->rattler, contacts, ncontacts, shift);
  if (!gh_finite(s->K.x, s->K.nzmax))
    return gh_fail(ctx, GH_DIVERGED, "the stiffness of the packing is not finite");
  if (!same) {
    cholmod_free_factor(&s->L, &s->common);
    s->L = cholmod_analyze(&s->K, &s->common);
    if (!s->L) return gh_fail(ctx, GH_MEMORY, "CHOLMOD could not analyse a stiffness of %zu unknowns", 2 * n);
    base->analyses++;
  }
  cholmod_factorize(&s->K, s->L, &s->common);
  base->factorisations++;
  if (s->common.status < CHOLMOD_OK)
    return gh_fail(ctx, GH_MEMORY, "CHOLMOD failed to factorise (status %d)", s->common.status);
  *definite = s->L->minor == s->L->n && cholmod_rcond(s->L, &s->common) > 1e-15;
  s->common.status = CHOLMOD_OK;
  return GH_OK;
}

static gh_status cholmod_solve_columns(gh_context *ctx, gh_solver *base, int ncol, const double **X) {
  stiffness *s = (stiffness *)base;
  size_t n = 2 * (size_t)s->nactive;
  *X = s->base.rhs;
  if (n == 0) return GH_OK;
  cholmod_dense B = {.nrow = n,
                     .ncol = (size_t)ncol,
                     .nzmax = n * (size_t)ncol,
                     .d = n,
                     .x = s->base.rhs,
                     .xtype = CHOLMOD_REAL,
                     .dtype = CHOLMOD_DOUBLE};
  if (!cholmod_solve2(CHOLMOD_A, s->L, &B, NULL, &s->X, NULL, &s->Y, &s->E, &s->common))
    return gh_fail(ctx, GH_MEMORY, "CHOLMOD failed to solve for %zu unknowns (status %d)", n,
                   s->common.status);
  *X = s->X->x;
  if (!gh_finite(*X, n * (size_t)ncol))
    return gh_fail(ctx, GH_DIVERGED, "the solution with the stiffness of the packing is not finite");
  return GH_OK;
}

static void cholmod_release(gh_solver *base) {
  stiffness *s = (stiffness *)base;
  cholmod_free_factor(&s->L, &s->common);
  cholmod_free_dense(&s->X, &s->common);
  cholmod_free_dense(&s->Y, &s->common);
  cholmod_free_dense(&s->E, &s->common);
  cholmod_finish(&s->common);
  void *const arrays[] = {s->active, s->slot, s->diagonal, s->pattern, s->K.p, s->K.i, s->K.x};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
}

static const gh_solver_ops cholmod_ops = {.name = "CHOLMOD",
                                          .number = cholmod_number,
                                          .factor = cholmod_factor_stiffness,
                                          .solve = cholmod_solve_columns,
                                          .release = cholmod_release};

gh_status gh_solver_cholmod(gh_context *ctx, int members, gh_solver **solver) {
  stiffness *s;
  *solver = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *s, &s));
  s->base.ops = &cholmod_ops;
  s->base.members = members;
  cholmod_start(&s->common);
  s->common.print = 0;
  s->common.supernodal = CHOLMOD_SIMPLICIAL;
  s->common.final_ll = 1; /* L L': a negative pivot ends the factorisation, so it tests definiteness */
  s->common.nmethods = 1;
  s->common.method[0].ordering = CHOLMOD_AMD;
  gh_status status = gh_alloc(ctx, (size_t)members, sizeof(int), &s->active);
  if (status == GH_OK) status = gh_alloc(ctx, 3 * (size_t)members, sizeof(int), &s->base.unknown);
  *solver = &s->base;
  if (status != GH_OK) gh_solver_destroy(solver);
  return status;
}
