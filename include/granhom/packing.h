/* granhom: packings of grains in a periodic cell, their replicas and boundary sets. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#ifndef GRANHOM_PACKING_H
#define GRANHOM_PACKING_H

#include "granhom/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Primary grains in the reference cell. The cell's corner is the origin of coordinates of the file (`low`).
 */
typedef struct gh_packing {
  int n;
  int *id;        /* n, the file's ids, ascending */
  int *type;      /* n, sieve fractions 1, 2, ... */
  double *radius; /* n */
  double *x;      /* n x 2, reference positions */
  double cell[4]; /* columns L_1, L_2 (3.14); upper triangular, det > 0 */
  double low[2];  /* lower left corner of the cell */
} gh_packing;

/* Reads a LAMMPS data file (atom_style sphere, z = 0). Errors, all GH_INPUT with file and line: missing,
 * truncated or empty file, a value that is not finite, radius <= 0, ids that occur twice, z != 0, no atoms,
 * two grains at one place, grains that fill the cell more than twenty times.
 */
gh_status gh_packing_read(gh_context *ctx, const char *path, gh_packing **packing);
/* Writes it back (17 digits), with grains at x (n x 2; NULL: reference positions) in the cell `cell` (NULL:
 * reference), turned so that the first lattice vector lies along x, and with the lattice vectors of the least
 * tilt. */
gh_status gh_packing_write(gh_context *ctx, const gh_packing *packing, const char *path, const double *x,
                           const double *cell);
gh_status gh_packing_copy(gh_context *ctx, const gh_packing *from, gh_packing **packing);
void gh_packing_destroy(gh_packing **packing);
double gh_packing_mean_radius(const gh_packing *packing);

/* Primary grains and the replicas of those that touch the cell's boundary (method 8.1). */
typedef struct gh_cluster {
  int n;                   /* members: the primaries in order, then the replicas */
  int *grain;              /* n, index of the primary grain */
  int (*image)[2];         /* n, shift in lattice vectors; 0 0 for primaries */
  unsigned char *boundary; /* n, 1 for B (primaries with a replica, and all replicas), 0 for I (3.15) */
  double *x;               /* n x 2, reference positions */
  double *radius;          /* n */
  int *type;               /* n */
} gh_cluster;
gh_status gh_cluster_create(gh_context *ctx, const gh_packing *packing, gh_cluster **cluster);
void gh_cluster_destroy(gh_cluster **cluster);

#ifdef __cplusplus
}
#endif
#endif
