/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Grains in a cell of two or three dimensions: files, bounds, defaults of growth. */
#include "granhom/io.h"
#include "granhom/packing.h"

#include <stdlib.h>
#include <string.h>

void gh_grains_destroy(gh_grains **grains) {
  if (!grains || !*grains) return;
  free((*grains)->radius);
  free((*grains)->type);
  free((*grains)->x);
  free(*grains);
  *grains = NULL;
}

double gh_grains_volume_fraction(const gh_grains *p) {
  double sum = 0, volume = 1;
  for (int k = 0; k < p->dim; k++) volume *= p->cell[k * (p->dim + 1)];
  for (int i = 0; i < p->n; i++) {
    double r = p->radius[i];
    sum += p->dim == 2 ? GH_PI * r * r : 4 * GH_PI / 3 * r * r * r;
  }
  return sum / volume;
}

gh_status gh_grains_write(gh_context *ctx, const gh_grains *p, const char *path) {
  size_t n = (size_t)p->n;
  gh_lammps_data d = {.natoms = p->n, .ntypes = 1, .low = {0, 0, -0.5}, .high = {0, 0, 0.5}};
  double *memory;
  GH_TRY(gh_alloc(ctx, 5 * n, sizeof(double), &memory));
  gh_status status = gh_alloc(ctx, n, sizeof(int), &d.id);
  if (status != GH_OK) {
    free(memory);
    return status;
  }
  d.diameter = memory, d.density = memory + n, d.x = memory + 2 * n;
  d.type = p->type;
  for (int i = 0; i < p->n; i++) {
    d.id[i] = i + 1;
    if (p->type[i] > d.ntypes) d.ntypes = p->type[i];
    d.diameter[i] = 2 * p->radius[i];
    d.density[i] = 1;
    for (int k = 0; k < p->dim; k++) d.x[3 * i + k] = p->x[p->dim * i + k];
  }
  for (int k = 0; k < p->dim; k++) d.high[k] = p->cell[k * (p->dim + 1)];
  if (p->dim == 3) d.low[2] = 0, d.xz = p->cell[2], d.yz = p->cell[5];
  d.xy = p->cell[1];
  status = gh_lammps_data_write(ctx, path,
                                p->dim == 2 ? "granhom packing, 2d disks, atom_style sphere"
                                            : "granhom packing, spheres, atom_style sphere",
                                &d);
  free(memory);
  free(d.id);
  return status;
}

gh_status gh_grains_packing(gh_context *ctx, const gh_grains *p, gh_packing **packing) {
  size_t n = (size_t)p->n;
  gh_packing *q;
  *packing = NULL;
  if (p->dim != 2)
    return gh_fail(ctx, GH_INPUT, "a plane packing is wanted, not one of %d dimensions", p->dim);
  GH_TRY(gh_alloc(ctx, 1, sizeof *q, &q));
  gh_status status;
  q->n = p->n;
  GH_TRY_OR(gh_alloc(ctx, n, sizeof(int), &q->id), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof(int), &q->type), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof(double), &q->radius), failed);
  GH_TRY_OR(gh_alloc(ctx, 2 * n, sizeof(double), &q->x), failed);
  for (int i = 0; i < p->n; i++) q->id[i] = i + 1;
  memcpy(q->type, p->type, n * sizeof(int));
  memcpy(q->radius, p->radius, n * sizeof(double));
  memcpy(q->x, p->x, 2 * n * sizeof(double));
  memcpy(q->cell, p->cell, sizeof q->cell);
  *packing = q;
  return GH_OK;
failed:
  gh_packing_destroy(&q);
  return status;
}

/* ---- growth ---- */

gh_grow_options gh_grow_defaults(int dim) {
  (void)dim; /* the same in two and three dimensions */
  return (gh_grow_options){.seed = 1, .rate = 1e-3, .threshold = 1e-9, .window = 1};
}

const char *gh_grow_stop_text(gh_grow_stop stop) {
  switch (stop) {
  case GH_STOP_FRACTION:
    return "the volume fraction was reached";
  case GH_STOP_DRIED_UP:
    return "growth dried up";
  case GH_STOP_TIME:
    return "the time limit was reached";
  }
  return "unknown";
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Sizes that differ; without memory for the sort the safe answer: as many as grains. */
static int sizes(int n, const double *diameter) {
  double *d = malloc((size_t)n * sizeof *d);
  if (!d) return n;
  memcpy(d, diameter, (size_t)n * sizeof *d);
  qsort(d, (size_t)n, sizeof *d, ascending);
  int count = 1;
  for (int i = 1; i < n; i++) count += d[i] > d[i - 1];
  free(d);
  return count;
}

double gh_grow_limit(int dim, int n, const double *diameter) {
  double equal = dim == 2 ? GH_PI / sqrt(12) : GH_PI / sqrt(18), low = INFINITY, high = 0;
  for (int i = 0; i < n; i++) low = fmin(low, diameter[i]), high = fmax(high, diameter[i]);
  double voids = 1 - pow(1 - equal, sizes(n, diameter)), q = low / high;
  if (dim == 3) return voids;
  double florian = (GH_PI * q * q + 2 * (1 - q * q) * asin(q / (1 + q))) / (2 * q * sqrt(1 + 2 * q));
  return fmin(voids, florian);
}
