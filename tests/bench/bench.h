/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Packings that the benchmarks share: random disks of the sizes of p150, relaxed at a volume fraction of 0.88,
 * then held to an overlap of about 1 %. The same on every machine. */
#ifndef GRANHOM_BENCH_H
#define GRANHOM_BENCH_H

#include <stdlib.h>
#include <string.h>

#include "granhom/micro.h"

/* The contacts of an engine without friction. */
static inline gh_status contacts_of(gh_engine *e, const gh_contact **c, int *count, const double **force) {
  gh_contact_list list = {0};
  gh_status status = gh_engine_contacts(e, &list);
  *c = list.contacts, *count = list.count, *force = list.force;
  return status;
}

static inline void must(gh_context *ctx, gh_status s) {
  if (s == GH_OK) return;
  fprintf(stderr, "bench: %s\n", gh_message(ctx));
  exit(gh_exit_status(s));
}

static inline double uniform(unsigned long long *state) { /* splitmix64: the same packings on every run */
  unsigned long long z = (*state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Relaxes the grains in a square cell of side a. Returns the mean overlap over the mean radius. */
static inline double settle(gh_context *ctx, gh_engine *engine, gh_packing *p, double a) {
  double cell[4] = {a, 0, 0, a}, scale = a / p->cell[0], overlap = 0;
  const gh_contact *c;
  const double *f;
  int count;
  for (int k = 0; k < 2 * p->n; k++) p->x[k] *= scale;
  memcpy(p->cell, cell, sizeof cell);
  gh_relax_options o = {.tolerance = 1e-10, .max_steps = 2000000, .floor = 1e-13};
  gh_relax_result result;
  must(ctx, gh_engine_set(engine, cell, p->x, NULL));
  must(ctx, gh_engine_relax(engine, &o, &result));
  must(ctx, gh_engine_get(engine, p->x, NULL));
  must(ctx, contacts_of(engine, &c, &count, &f));
  for (int k = 0; k < count; k++) overlap += c[k].overlap / count;
  return overlap / gh_packing_mean_radius(p);
}

static inline gh_packing *make_packing(gh_context *ctx, int n) {
  static const double diameter[] = {0.063, 0.08, 0.1, 0.125, 0.16, 0.25},
                      share[] = {0.06, 0.1, 0.14, 0.3, 0.34, 0.06};
  unsigned long long seed = 20 + (unsigned long long)n;
  gh_packing *copy;
  gh_packing raw = {.n = n, .cell = {1, 0, 0, 1}};
  raw.id = calloc((size_t)n, sizeof(int));
  raw.type = calloc((size_t)n, sizeof(int));
  raw.radius = calloc((size_t)n, sizeof(double));
  raw.x = calloc(2 * (size_t)n, sizeof(double));
  double area = 0;
  for (int i = 0; i < n; i++) {
    double u = (i + 0.5) / n, sum = 0;
    int k = 0;
    while (k < 5 && u > sum + share[k]) sum += share[k++];
    raw.id[i] = i + 1, raw.type[i] = k + 1, raw.radius[i] = diameter[k] / 2;
    area += GH_PI * raw.radius[i] * raw.radius[i];
    raw.x[2 * i] = uniform(&seed), raw.x[2 * i + 1] = uniform(&seed);
  }
  must(ctx, gh_packing_copy(ctx, &raw, &copy));
  gh_engine_setup setup = {.n = n, .radius = copy->radius, .periodic = true, .law = {1}};
  gh_engine *engine;
  must(ctx, gh_engine_create(ctx, GH_ENGINE_NATIVE, &setup, &engine));
  double fraction = 0.86;
  while (settle(ctx, engine, copy, sqrt(area / fraction)) < 0.01 && fraction < 1.1) fraction *= 1.002;
  gh_engine_destroy(&engine);
  free(raw.id), free(raw.type), free(raw.radius), free(raw.x);
  return copy;
}

#endif
