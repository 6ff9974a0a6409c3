/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The hull of a cell: whether a grain can slip through its boundary set (text after 3.15).
 *
 * Along each lattice vector the grains of B that touch that face form a chain, without end since the cell is
 * periodic. A grain of diameter d crosses it where two neighbours leave more than d between them. Which
 * grains are neighbours need not be known: the widest gap of the best chain is the least g for which the
 * pairs closer than g hold together from one cell to the next. Pairs are added in ascending order of their
 * gaps until they do. */
#include "granhom/packing.h"

#include <stdlib.h>

/* Two grains of a face and the gap between i and the image of j `shift` lattice vectors further. */
typedef struct pair {
  double gap;
  int i, j, shift;
} pair;

static int by_gap(const void *a, const void *b) {
  const pair *p = a, *q = b;
  if (p->gap != q->gap) return p->gap < q->gap ? -1 : 1;
  return p->i != q->i ? p->i - q->i : p->j != q->j ? p->j - q->j : p->shift - q->shift;
}

/* The grains of one face: member k of the cluster, its place in the forest, and the lattice vectors from its
 * root to it. */
typedef struct face {
  int n, *member, *parent, *offset;
} face;

static int root_of(const face *f, int i, int *offset) {
  *offset = 0;
  for (; f->parent[i] != i; i = f->parent[i]) *offset += f->offset[i];
  return i;
}

/* Joins the two; true when they hung together already by another number of lattice vectors: the chain is
 * closed around the cell. */
static bool joins_around(face *f, const pair *p) {
  int a, b, i = root_of(f, p->i, &a), j = root_of(f, p->j, &b);
  if (i == j) return a != b + p->shift;
  f->parent[j] = i;
  f->offset[j] = a - b - p->shift;
  return false;
}

/* The members that touch the line through `low` along lattice vector `along`: primaries that reach the low
 * face, and the replicas of those that reach the high one. *x is n x 2. */
static gh_status collect(gh_context *ctx, const gh_packing *p, const gh_cluster *c, int along, face *f,
                         double **x) {
  int across = 1 - along;
  size_t most = (size_t)(c->n - p->n);
  GH_TRY(gh_alloc(ctx, 3 * most + 1, sizeof(int), &f->member));
  GH_TRY(gh_alloc(ctx, 2 * most + 1, sizeof(double), x));
  f->parent = f->member + most;
  f->offset = f->parent + most;
  for (int m = p->n; m < c->n; m++) {
    if (c->image[m][along] != 0) continue;
    bool low = c->image[m][across] > 0;
    for (int k = 0; k < 2; k++) (*x)[2 * f->n + k] = c->x[2 * m + k] - (low ? p->cell[2 * k + across] : 0);
    f->member[f->n] = c->grain[m];
    f->parent[f->n] = f->n;
    f->n++;
  }
  return GH_OK;
}

static int list_pairs(const gh_packing *p, const face *f, const double *x, int along, pair *pairs) {
  int count = 0;
  for (int i = 0; i < f->n; i++)
    for (int j = i; j < f->n; j++)
      for (int shift = i == j ? 1 : -1; shift <= 1; shift++) {
        double d[2];
        for (int k = 0; k < 2; k++) d[k] = x[2 * j + k] + shift * p->cell[2 * k + along] - x[2 * i + k];
        double gap = hypot(d[0], d[1]) - p->radius[f->member[i]] - p->radius[f->member[j]];
        pairs[count++] = (pair){gap, i, j, shift};
      }
  return count;
}

static gh_status find_gap(gh_context *ctx, const gh_packing *p, const gh_cluster *c, int along,
                          gh_hull *hull) {
  face f = {0};
  double *x = NULL;
  pair *pairs = NULL;
  gh_status status;
  GH_TRY_OR(collect(ctx, p, c, along, &f, &x), done);
  size_t n = (size_t)f.n;
  GH_TRY_OR(gh_alloc(ctx, 3 * n * (n + 1) / 2 + 1, sizeof *pairs, &pairs), done);
  int count = list_pairs(p, &f, x, along, pairs), k = 0;
  if (count > 0) qsort(pairs, (size_t)count, sizeof *pairs, by_gap);
  while (k < count && !joins_around(&f, &pairs[k])) k++;
  if (k < count && pairs[k].gap <= hull->gap) goto done; /* the other face has a wider one */
  hull->face = along;
  hull->gap = k < count ? pairs[k].gap : INFINITY;
  hull->id[0] = k < count ? p->id[f.member[pairs[k].i]] : 0;
  hull->id[1] = k < count ? p->id[f.member[pairs[k].j]] : 0;
done:
  free(f.member);
  free(x);
  free(pairs);
  return status;
}

gh_status gh_hull_find(gh_context *ctx, const gh_packing *p, gh_hull *hull) {
  gh_cluster *c;
  *hull = (gh_hull){.gap = -INFINITY, .smallest = INFINITY};
  GH_TRY(gh_cluster_create(ctx, p, &c));
  for (int i = 0; i < p->n; i++) {
    hull->boundary += c->boundary[i];
    hull->smallest = fmin(hull->smallest, 2 * p->radius[i]);
  }
  gh_status status = GH_OK;
  for (int along = 0; along < 2 && status == GH_OK; along++) status = find_gap(ctx, p, c, along, hull);
  hull->full = hull->gap < hull->smallest;
  gh_cluster_destroy(&c);
  return status;
}
