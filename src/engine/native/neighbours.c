/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Candidate pairs of a packing by cells.
 *
 * Grains are sorted into nb[0] x nb[1] bins of the cell (or of the bounding box), at least as wide as the
 * largest reach. A cell smaller than the reach has one bin, and the stencil then covers as many images as the
 * reach needs. */
#include "engine/native/neighbours.h"

#include <stdlib.h>
#include <string.h>

typedef struct grid {
  double cell[4], inverse[4], low[2]; /* x = low + cell s, s in [0, 1) */
  int nb[2], stencil[2];
  bool periodic;
} grid;

static int floor_divide(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/* Cell of a cluster: its bounding box. */
static void bounding_box(int n, const double *x, grid *g) {
  double high[2] = {x[0], x[1]};
  g->low[0] = x[0], g->low[1] = x[1];
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 2; k++) {
      if (x[2 * i + k] < g->low[k]) g->low[k] = x[2 * i + k];
      if (x[2 * i + k] > high[k]) high[k] = x[2 * i + k];
    }
  for (int k = 0; k < 2; k++) g->cell[3 * k] = (high[k] - g->low[k]) * (1 + 1e-9);
}

enum { MOST_IMAGES = 1000 }; /* that one grain may reach along a lattice vector */

static gh_status make_grid(gh_context *ctx, int n, const double *x, const double *cell, double reach,
                           grid *g) {
  *g = (grid){.periodic = cell != NULL};
  if (cell) memcpy(g->cell, cell, sizeof g->cell);
  else bounding_box(n, x, g);
  for (int k = 0; k < 2; k++)
    if (!cell && !(g->cell[3 * k] > reach)) g->cell[3 * k] = reach;
  gh_inv2(g->cell, g->inverse);
  int limit = 2 + (int)sqrt(4.0 * n); /* no more bins than there is use for */
  for (int k = 0; k < 2; k++) {
    /* the distance between the two sides of the cell that s_k runs between */
    double height = 1 / hypot(g->inverse[2 * k], g->inverse[2 * k + 1]), bins = floor(height / reach);
    g->nb[k] = bins < 1 ? 1 : bins > limit ? limit : (int)bins;
    double stencil = ceil(reach / (height / g->nb[k]));
    if (!(stencil <= MOST_IMAGES))
      return gh_fail(ctx, GH_INPUT,
                     "the cell [%g %g; %g %g] is %g high, too thin for grains that reach %g: one would touch "
                     "more than %d images of itself",
                     g->cell[0], g->cell[1], g->cell[2], g->cell[3], height, reach, MOST_IMAGES);
    g->stencil[k] = (int)stencil;
  }
  return GH_OK;
}

static gh_status sort_into_bins(gh_context *ctx, gh_neighbours *nb, const grid *g, int n, const double *x) {
  size_t bins = (size_t)g->nb[0] * (size_t)g->nb[1];
  GH_TRY(gh_grow(ctx, bins + 1, sizeof(int), &nb->bin_capacity, &nb->bin_start));
  if (nb->grain_capacity < (size_t)n) {
    size_t c[3] = {nb->grain_capacity, nb->grain_capacity, nb->grain_capacity};
    GH_TRY(gh_grow(ctx, (size_t)n, sizeof(int), &c[0], &nb->bin_grain));
    GH_TRY(gh_grow(ctx, (size_t)n, sizeof(int), &c[1], &nb->bin_of));
    GH_TRY(gh_grow(ctx, (size_t)n, 2 * sizeof(int), &c[2], &nb->wrap));
    nb->grain_capacity = c[0];
  }
  memset(nb->bin_start, 0, (bins + 1) * sizeof(int));
  for (int i = 0; i < n; i++) {
    double s[2] = {x[2 * i] - g->low[0], x[2 * i + 1] - g->low[1]};
    gh_apply2(g->inverse, s, s);
    int b[2];
    for (int k = 0; k < 2; k++) {
      int w = g->periodic ? (int)floor(s[k]) : 0;
      nb->wrap[2 * i + k] = w;
      b[k] = (int)((s[k] - w) * g->nb[k]);
      if (b[k] < 0) b[k] = 0;
      if (b[k] >= g->nb[k]) b[k] = g->nb[k] - 1;
    }
    nb->bin_of[i] = b[1] * g->nb[0] + b[0];
    nb->bin_start[nb->bin_of[i] + 1]++;
  }
  for (size_t b = 0; b < bins; b++) nb->bin_start[b + 1] += nb->bin_start[b];
  for (int i = n - 1; i >= 0; i--) nb->bin_grain[--nb->bin_start[nb->bin_of[i] + 1]] = i;
  memmove(nb->bin_start, nb->bin_start + 1,
          bins * sizeof(int)); /* the counts have moved to the starts, one place on */
  nb->bin_start[bins] = n;
  return GH_OK;
}

/* Notes the pair of i with the image (kx, ky) of j, in lattice vectors between the positions as given. */
static gh_status consider(gh_context *ctx, gh_neighbours *nb, const grid *g, const double *x,
                          const double *radius, double skin, int i, int j, int kx, int ky) {
  gh_pair p = {.i = i, .j = j, .reach = radius[i] + radius[j]};
  if (g->periodic) {
    p.shift[0] = g->cell[0] * kx + g->cell[1] * ky;
    p.shift[1] = g->cell[2] * kx + g->cell[3] * ky;
  }
  double lx = x[2 * j] - x[2 * i] + p.shift[0], ly = x[2 * j + 1] - x[2 * i + 1] + p.shift[1],
         far = p.reach + skin;
  if (lx * lx + ly * ly >= far * far) return GH_OK;
  if (lx == 0 && ly == 0) /* relaxation would turn this into NaN */
    return gh_fail(ctx, GH_DIVERGED,
                   "the centres of grains %d and %d coincide: their contact has no direction", i + 1, j + 1);
  if (nb->with_images) {
    GH_TRY(gh_grow(ctx, nb->npairs + 1, 2 * sizeof(int), &nb->image_capacity, &nb->image));
    nb->image[2 * nb->npairs] = kx;
    nb->image[2 * nb->npairs + 1] = ky;
  }
  if (i == j && !nb->with_images) {
    GH_TRY(gh_grow(ctx, nb->nown + 1, sizeof p, &nb->own_capacity, &nb->own));
    nb->own[nb->nown++] = p;
  } else {
    GH_TRY(gh_grow(ctx, nb->npairs + 1, sizeof p, &nb->pair_capacity, &nb->pairs));
    nb->pairs[nb->npairs++] = p;
  }
  return GH_OK;
}

static gh_status neighbours_of(gh_context *ctx, gh_neighbours *nb, const grid *g, const double *x,
                               const double *radius, double skin, int i) {
  int bx = nb->bin_of[i] % g->nb[0], by = nb->bin_of[i] / g->nb[0];
  for (int dy = -g->stencil[1]; dy <= g->stencil[1]; dy++)
    for (int dx = -g->stencil[0]; dx <= g->stencil[0]; dx++) {
      int ix = floor_divide(bx + dx, g->nb[0]), iy = floor_divide(by + dy, g->nb[1]);
      if (!g->periodic && (ix || iy)) continue;
      int bin = (by + dy - iy * g->nb[1]) * g->nb[0] + (bx + dx - ix * g->nb[0]);
      for (int q = nb->bin_start[bin]; q < nb->bin_start[bin + 1]; q++) {
        int j = nb->bin_grain[q];
        if (j < i || (j == i && (iy < 0 || (iy == 0 && ix <= 0)))) continue;
        int kx = ix + nb->wrap[2 * i] - nb->wrap[2 * j], ky = iy + nb->wrap[2 * i + 1] - nb->wrap[2 * j + 1];
        GH_TRY(consider(ctx, nb, g, x, radius, skin, i, j, kx, ky));
      }
    }
  return GH_OK;
}

/* The few neighbours of one grain, found bin by bin, in the order of (j, shift). */
static void sort_pairs(gh_pair *p, size_t n) {
  for (size_t a = 1; a < n; a++) {
    gh_pair q = p[a];
    size_t b = a;
    for (; b > 0; b--) {
      const gh_pair *o = &p[b - 1];
      if (o->j < q.j || (o->j == q.j && (o->shift[1] < q.shift[1] ||
                                         (o->shift[1] == q.shift[1] && o->shift[0] <= q.shift[0]))))
        break;
      p[b] = *o;
    }
    p[b] = q;
  }
}

/* The same in the order of (j, image[1], image[0]): integers, whatever the shape of the cell. */
static void sort_by_image(gh_pair *p, int *image, size_t n) {
  for (size_t a = 1; a < n; a++) {
    const gh_pair q = p[a];
    const int kx = image[2 * a], ky = image[2 * a + 1];
    size_t b = a;
    for (; b > 0; b--) {
      const int *o = image + 2 * (b - 1), oj = p[b - 1].j;
      if (oj < q.j || (oj == q.j && (o[1] < ky || (o[1] == ky && o[0] <= kx)))) break;
      p[b] = p[b - 1];
      image[2 * b] = o[0], image[2 * b + 1] = o[1];
    }
    p[b] = q;
    image[2 * b] = kx, image[2 * b + 1] = ky;
  }
}

gh_status gh_neighbours_find(gh_context *ctx, gh_neighbours *nb, int n, const double *x, const double *radius,
                             const double *cell, double skin) {
  double largest = 0;
  for (int i = 0; i < n; i++) largest = radius[i] > largest ? radius[i] : largest;
  grid g;
  GH_TRY(make_grid(ctx, n, x, cell, 2 * largest + skin, &g));
  GH_TRY(sort_into_bins(ctx, nb, &g, n, x));
  nb->npairs = nb->nown = 0;
  for (int i = 0; i < n; i++) {
    size_t first = nb->npairs, own = nb->nown;
    GH_TRY(neighbours_of(ctx, nb, &g, x, radius, skin, i));
    size_t found = nb->npairs - first; /* 0: there may be no array yet */
    if (found && nb->with_images) sort_by_image(nb->pairs + first, nb->image + 2 * first, found);
    else if (found) sort_pairs(nb->pairs + first, found);
    if (nb->nown > own) sort_pairs(nb->own + own, nb->nown - own);
  }
  return GH_OK;
}

void gh_neighbours_free(gh_neighbours *nb) {
  free(nb->pairs);
  free(nb->image);
  free(nb->own);
  free(nb->bin_start);
  free(nb->bin_grain);
  free(nb->bin_of);
  free(nb->wrap);
  *nb = (gh_neighbours){0};
}
