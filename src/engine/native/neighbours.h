/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Candidate pairs of a packing by cells. */
#ifndef GRANHOM_NATIVE_NEIGHBOURS_H
#define GRANHOM_NATIVE_NEIGHBOURS_H

#include "engine/relax/relax.h"
#include "granhom/base.h"

/* Pairs of grains and of grains with their own images that are nearer than r_i + r_j + skin. */
typedef struct gh_neighbours {
  bool with_images; /* set by the caller: note the images, and keep all pairs in one list */
  gh_pair *pairs;   /* i < j, sorted by (i, j, shift); with images i <= j, by (i, j, image[1], image[0]) */
  int *image;       /* npairs x 2, with images: lattice vectors between the positions as given */
  gh_pair *own;     /* i == j, image > 0: a grain and its own image; empty with images */
  size_t npairs, nown, pair_capacity, own_capacity, image_capacity;
  int *bin_start, *bin_grain, *bin_of; /* scratch */
  int *wrap;                           /* n x 2: lattice vectors taken off each position */
  size_t bin_capacity, grain_capacity;
} gh_neighbours;

/* Finds the pairs. x: n x 2, anywhere; cell: columns are the lattice vectors, NULL for a cluster without
 * images. */
gh_status gh_neighbours_find(gh_context *ctx, gh_neighbours *nb, int n, const double *x, const double *radius,
                             const double *cell, double skin);
void gh_neighbours_free(gh_neighbours *nb);

#endif
