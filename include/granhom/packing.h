/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: packings of grains in a periodic cell, their replicas and boundary sets. */
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
GH_API gh_status gh_packing_read(gh_context *ctx, const char *path, gh_packing **packing);
/* Writes it back (17 digits), with grains at x (n x 2; NULL: reference positions) in the cell `cell` (NULL:
 * reference), turned so that the first lattice vector lies along x, and with the lattice vectors of the least
 * tilt. */
GH_API gh_status gh_packing_write(gh_context *ctx, const gh_packing *packing, const char *path,
                                  const double *x, const double *cell);
GH_API gh_status gh_packing_copy(gh_context *ctx, const gh_packing *from, gh_packing **packing);
GH_API void gh_packing_destroy(gh_packing **packing);
GH_API double gh_packing_mean_radius(const gh_packing *packing);

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
GH_API gh_status gh_cluster_create(gh_context *ctx, const gh_packing *packing, gh_cluster **cluster);
GH_API void gh_cluster_destroy(gh_cluster **cluster);

/* The boundary set B as a hull (3.14, 3.15 and the text after them). */
typedef struct gh_hull {
  int boundary;    /* primary grains in B; the rest is I */
  double gap;      /* the widest gap that a grain has to pass to cross the hull, surface to surface; below 0
                      where grains overlap; INFINITY when the hull has a hole that no two grains bound */
  int id[2];       /* ids of the two grains beside it; 0 when the gap is infinite */
  int face;        /* it is in the hull along lattice vector 0 or 1 */
  double smallest; /* smallest diameter of the packing */
  bool full;       /* gap < smallest: no grain can pass between two neighbours of B */
} gh_hull;
GH_API gh_status gh_hull_find(gh_context *ctx, const gh_packing *packing, gh_hull *hull);

/* ---- sieve curves: which grains (3.12, 3.13) ---- */

typedef enum gh_sieve_kind { GH_SIEVE_COUNT, GH_SIEVE_VOLUME, GH_SIEVE_PASSING } gh_sieve_kind;

/* Fractions with ascending diameters; fraction k is the type k + 1 of its grains. */
typedef struct gh_sieve {
  int n;
  gh_sieve_kind kind; /* the column it was read from */
  double *diameter;   /* n, > 0, ascending */
  double *amount;     /* n, >= 0: grains (GH_SIEVE_COUNT) or percent of the volume (the other two) */
} gh_sieve;

/* From n pairs (diameter, value), in ascending or descending order of diameter. value: a number of grains, a
 * share of the volume in percent, or the percentage of the volume in grains up to this diameter. Errors,
 * GH_INPUT: diameters that are not positive or not ordered, values below 0, percentages above 100, shares
 * whose sum is not 100 within 0.5, a passing that falls with the diameter or does not end at 100, no grains
 * at all. */
GH_API gh_status gh_sieve_create(gh_context *ctx, gh_sieve_kind kind, int n, const double *diameter,
                                 const double *value, gh_sieve **sieve);
/* CSV with the column `diameter` and one of `count`, `volume_percent`, `passing`; errors with file and line.
 */
GH_API gh_status gh_sieve_read(gh_context *ctx, const char *path, gh_sieve **sieve);
GH_API void gh_sieve_destroy(gh_sieve **sieve);
/* Share of the number of grains of each fraction (3.12), with the exponent dim (2 or 3); n numbers, sum 1. */
GH_API void gh_sieve_shares(const gh_sieve *sieve, int dim, double *share);
/* Least number of grains that has one of each fraction (3.13), rounded up. */
GH_API double gh_sieve_least(const gh_sieve *sieve, int dim);
/* Grains of each fraction (n numbers) whose sum is total: shares times total, rounded by largest remainder.
 * total 0: the curve's own counts (GH_SIEVE_COUNT only). GH_INPUT when total is below gh_sieve_least, which
 * the message names. */
GH_API gh_status gh_sieve_counts(gh_context *ctx, const gh_sieve *sieve, int dim, int total, int *count);
/* The grains one by one, largest first: diameter and type (fraction + 1), allocated, sum of count numbers. */
GH_API gh_status gh_sieve_grains(gh_context *ctx, const gh_sieve *sieve, const int *count, int *n,
                                 double **diameter, int **type);

/* ---- event-driven growth (chapter 3) in two and three dimensions ---- */

/* Grains in a periodic cell, of dimension 2 or 3: what growth makes. */
typedef struct gh_grains {
  int n, dim;
  double *radius; /* n */
  int *type;      /* n, from 1 */
  double *x;      /* n x dim, inside the cell, whose corner is the origin */
  double cell[9]; /* the first dim x dim: row-major, columns are the lattice vectors, upper triangular */
} gh_grains;
GH_API void gh_grains_destroy(gh_grains **grains);
/* LAMMPS data file, atom_style sphere; plane packings have z = 0. */
GH_API gh_status gh_grains_write(gh_context *ctx, const gh_grains *grains, const char *path);
/* The same as a packing, dim 2 only; ids 1 ... n. */
GH_API gh_status gh_grains_packing(gh_context *ctx, const gh_grains *grains, gh_packing **packing);
GH_API double gh_grains_volume_fraction(const gh_grains *grains);

typedef enum gh_collision {
  GH_COLLISION_EXCHANGE, /* (3.9): equal masses, each grain is pushed by its own growth rate */
  GH_COLLISION_MOMENTUM  /* elastic impact of growing grains with masses as their volumes */
} gh_collision;

typedef enum gh_grow_stop { GH_STOP_FRACTION, GH_STOP_DRIED_UP, GH_STOP_TIME } gh_grow_stop;
GH_API const char *gh_grow_stop_text(gh_grow_stop stop); /* "the volume fraction was reached" */

typedef struct gh_grow_options {
  unsigned long long seed;
  double shape[9]; /* the cell but for its size, like gh_grains.cell: upper triangular, positive diagonal; all
                      zero: square or cube */
  double rate;     /* growth of the mean diameter per time over the root mean square of the velocities, > 0 */
  gh_collision collision;
  double volume_fraction; /* stops when it is reached; 0: none */
  double threshold;       /* (3.11): stops when the volume fraction grows by less ... */
  double window;          /* ... in this number of collisions per grain; > 0 */
  double seconds;         /* stops after this time of the clock; 0: none */
} gh_grow_options;
GH_API gh_grow_options gh_grow_defaults(int dim);

typedef struct gh_grow_result {
  gh_grow_stop stop;
  double volume_fraction;
  double collisions, transfers, checks; /* events: contacts; lists renewed; predictions renewed */
  double seconds, rate;                 /* time of the clock; collisions per second */
  double overlap; /* largest overlap over the smallest radius, of the grains as returned */
} gh_grow_result;

/* Grows n grains whose radii keep the ratios of diameter (n, > 0), from points at random places to a dense
 * packing, in a cell of the shape given; the result has exactly these diameters, and the cell the size that
 * belongs to the volume fraction reached. Same input, same seed: the same packing to the last bit, unless the
 * clock stops it. type NULL: all
 * 1. Progress in events and volume fraction. Errors, GH_INPUT: n < 1, values out of range, a wanted volume
 * fraction above gh_grow_limit, a cell lower than two of the largest grains. */
GH_API gh_status gh_packing_grow2(gh_context *ctx, int n, const double *diameter, const int *type,
                                  const gh_grow_options *options, gh_grains **grains, gh_grow_result *result);
GH_API gh_status gh_packing_grow3(gh_context *ctx, int n, const double *diameter, const int *type,
                                  const gh_grow_options *options, gh_grains **grains, gh_grow_result *result);
/* By dim. */
GH_API gh_status gh_packing_grow(gh_context *ctx, int dim, int n, const double *diameter, const int *type,
                                 const gh_grow_options *options, gh_grains **grains, gh_grow_result *result);
/* No packing of these diameters is denser. Equal grains: pi/sqrt(12), pi/sqrt(18). Disks: Florian's bound for
 * the ratio of the extremes; otherwise k sizes fill each other's voids, 1 - (1 - equal)^k. */
GH_API double gh_grow_limit(int dim, int n, const double *diameter);

#ifdef __cplusplus
}
#endif
#endif
