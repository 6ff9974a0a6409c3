/* Stiffness of the free grains in compressed columns, its Cholesky factor by CHOLMOD.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include "micro/internal.h"

#include <stdlib.h>
#include <string.h>

gh_status gh_stiffness_create(gh_context *ctx, int members, gh_stiffness **stiffness) {
  gh_stiffness *s;
  *stiffness = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *s, &s));
  cholmod_start(&s->common);
  s->common.print = 0;
  s->common.supernodal = CHOLMOD_SIMPLICIAL;
  s->common.final_ll = 1; /* L L': a negative pivot ends the factorisation, so it tests definiteness */
  s->common.nmethods = 1;
  s->common.method[0].ordering = CHOLMOD_AMD;
  gh_status status = gh_alloc(ctx, (size_t)members, sizeof(int), &s->active);
  if (status != GH_OK) gh_stiffness_destroy(&s);
  *stiffness = s;
  return status;
}

void gh_stiffness_destroy(gh_stiffness **stiffness) {
  if (!stiffness || !*stiffness) return;
  gh_stiffness *s = *stiffness;
  cholmod_free_factor(&s->L, &s->common);
  cholmod_free_dense(&s->X, &s->common);
  cholmod_free_dense(&s->Y, &s->common);
  cholmod_free_dense(&s->E, &s->common);
  cholmod_finish(&s->common);
  void *const arrays[] = {s->rhs, s->active, s->slot, s->diagonal, s->pattern, s->K.p, s->K.i, s->K.x};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  free(s);
  *stiffness = NULL;
}

/* Root of a grain in the forest of grains that hang together. */
static int root_of(int *parent, int i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

void gh_find_groups(int n, const gh_contact *contacts, int ncontacts, const unsigned char *without,
                    int *group) {
  for (int i = 0; i < n; i++) group[i] = i;
  for (int c = 0; c < ncontacts; c++) {
    int i = contacts[c].i, j = contacts[c].j;
    if (without && (without[i] || without[j])) continue;
    i = root_of(group, i), j = root_of(group, j);
    group[i > j ? i : j] = i > j ? j : i; /* the root is the first grain of its group */
  }
}

gh_status gh_stiffness_number(gh_context *ctx, gh_stiffness *s, int n, const unsigned char *held,
                              const unsigned char *rattler, const gh_contact *contacts, int ncontacts,
                              bool pin) {
  int *a = s->active;
  GH_TRY(gh_grow(ctx, 2 * (size_t)n + 2, sizeof(int), &s->diagonal_capacity, &s->diagonal));
  int *group = s->diagonal; /* free for use until the pattern is made */
  if (pin) gh_find_groups(n, contacts, ncontacts, rattler, group);
  s->nactive = 0;
  for (int i = 0; i < n; i++) {
    bool pinned = pin && group[i] == i;
    a[i] = (held && held[i]) || rattler[i] || pinned ? -1 : s->nactive++;
  }
  return GH_OK;
}

/* Contacts between two unknown grains, one entry per pair: contacts come sorted by (i, j). */
static gh_status collect(gh_context *ctx, gh_stiffness *s, const gh_contact *contacts, int ncontacts,
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
static gh_status make_columns(gh_context *ctx, gh_stiffness *s) {
  size_t n = (size_t)s->nactive, nnz = 4 * s->npattern + 3 * n;
  GH_TRY(gh_grow(ctx, 2 * n + 1, sizeof(int), &s->p_capacity, &s->K.p));
  GH_TRY(gh_grow(ctx, nnz + 1, sizeof(int), &s->i_capacity, &s->K.i));
  GH_TRY(gh_grow(ctx, nnz + 1, sizeof(double), &s->k_capacity, &s->K.x));
  GH_TRY(gh_grow(ctx, 8 * n + 4, sizeof(double), &s->rhs_capacity, &s->rhs));
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
static void place_blocks(gh_stiffness *s, int ncontacts, int *fill) {
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

static void assemble(gh_stiffness *s, const unsigned char *rattler, const gh_contact *contacts, int ncontacts,
                     double shift) {
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

gh_status gh_stiffness_factorise(gh_context *ctx, gh_stiffness *s, const unsigned char *rattler,
                                 const gh_contact *contacts, int ncontacts, double shift, bool *definite) {
  *definite = true;
  if (s->nactive == 0) return GH_OK;
  int *pairs;
  size_t npairs, n = (size_t)s->nactive;
  GH_TRY(collect(ctx, s, contacts, ncontacts, &pairs, &npairs));
  bool same = s->L && s->L->n == 2 * n && npairs == s->npattern &&
              !memcmp(pairs, s->pattern, 2 * npairs * sizeof(int));
  if (!same) {
    memmove(s->pattern, pairs, 2 * npairs * sizeof(int));
    s->npattern = npairs;
  }
  GH_TRY(make_columns(ctx, s));      /* the numbering used the same memory for its groups */
  int *fill = (int *)(void *)s->rhs; /* not in use yet */
  place_blocks(s, ncontacts, fill);
  assemble(s, rattler, contacts, ncontacts, shift);
  if (!gh_finite(s->K.x, s->K.nzmax))
    return gh_fail(ctx, GH_DIVERGED, "the stiffness of the packing is not finite");
  if (!same) {
    cholmod_free_factor(&s->L, &s->common);
    s->L = cholmod_analyze(&s->K, &s->common);
    if (!s->L) return gh_fail(ctx, GH_MEMORY, "CHOLMOD could not analyse a stiffness of %zu unknowns", 2 * n);
    s->analyses++;
  }
  cholmod_factorize(&s->K, s->L, &s->common);
  s->factorisations++;
  if (s->common.status < CHOLMOD_OK)
    return gh_fail(ctx, GH_MEMORY, "CHOLMOD failed to factorise (status %d)", s->common.status);
  *definite = s->L->minor == s->L->n && cholmod_rcond(s->L, &s->common) > 1e-15;
  s->common.status = CHOLMOD_OK;
  return GH_OK;
}

gh_status gh_stiffness_solve(gh_context *ctx, gh_stiffness *s, int ncol, const double **X) {
  size_t n = 2 * (size_t)s->nactive;
  *X = s->rhs;
  if (n == 0) return GH_OK;
  cholmod_dense B = {.nrow = n,
                     .ncol = (size_t)ncol,
                     .nzmax = n * (size_t)ncol,
                     .d = n,
                     .x = s->rhs,
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
