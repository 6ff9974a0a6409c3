/* Time of one RVE update and where it goes: an increment of 0.05 % uniaxial compression to a residual of
 * 1e-8, with tangent. Packings are made here: random disks of the sizes of p150, relaxed at a volume fraction
 * of 0.88, then held to an overlap of about 1 %. SPDX-License-Identifier: GPL-2.0-or-later usage: rve [engine
 * ...]   (default: native lammps) */
#include <stdlib.h>
#include <string.h>

#include "granhom/micro.h"

enum { INCREMENTS = 20, WARM_UP = 2 };
/* The contacts of an engine without friction. */
static gh_status contacts_of(gh_engine *e, const gh_contact **c, int *count, const double **force) {
  gh_contact_list list = {0};
  gh_status status = gh_engine_contacts(e, &list);
  *c = list.contacts, *count = list.count, *force = list.force;
  return status;
}

static const int sizes[] = {88, 150, 300, 400, 600, 700};
static const gh_boundary boundaries[] = {GH_TAYLOR, GH_TAYLOR_CELL, GH_RESTRICTED, GH_PERIODIC};

static void must(gh_context *ctx, gh_status s) {
  if (s == GH_OK) return;
  fprintf(stderr, "bench: %s\n", gh_message(ctx));
  exit(gh_exit_status(s));
}

static double uniform(unsigned long long *state) { /* splitmix64: the same packings on every run */
  unsigned long long z = (*state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Relaxes the grains in a square cell of side a. Returns the mean overlap over the mean radius. */
static double settle(gh_context *ctx, gh_engine *engine, gh_packing *p, double a) {
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

static gh_packing *make_packing(gh_context *ctx, int n) {
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
    area += 3.14159265358979 * raw.radius[i] * raw.radius[i];
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

static void measure(gh_context *ctx, const gh_packing *p, gh_boundary b, gh_engine_kind kind) {
  gh_rve_options o = gh_rve_defaults();
  o.boundary = b, o.engine = kind, o.law.normal_stiffness = 1000, o.tolerance = 1e-8;
  gh_rve *rve;
  gh_rve_cost first, last;
  double seconds[INCREMENTS], P[4], A[16];
  must(ctx, gh_rve_create(ctx, p, &o, &rve));
  for (int k = 0; k < INCREMENTS + WARM_UP; k++) {
    double F[4] = {1 - 5e-4 * k, 0, 0, 1};
    if (k == WARM_UP) gh_rve_costs(rve, &first);
    must(ctx, gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
    must(ctx, gh_rve_commit(rve));
    if (k >= WARM_UP) seconds[k - WARM_UP] = gh_rve_measure(rve)->seconds;
  }
  gh_rve_costs(rve, &last);
  for (int a = 1; a < INCREMENTS; a++)
    for (int c = a; c > 0 && seconds[c - 1] > seconds[c]; c--) {
      double t = seconds[c];
      seconds[c] = seconds[c - 1], seconds[c - 1] = t;
    }
  double per = 1e3 / INCREMENTS, total = last.total - first.total, set = last.set - first.set,
         relax = last.relax - first.relax, contacts = last.contacts - first.contacts,
         factor = last.factorise - first.factorise;
  printf("%6d  %-11s %-7s %8.3f %8.3f %8.3f | %7.3f %7.3f %7.3f %7.3f %7.3f | %6.0f %5.1f\n", p->n,
         gh_boundary_name(b), kind == GH_ENGINE_NATIVE ? "native" : "lammps", 1e3 * seconds[INCREMENTS / 2],
         per * total, 1e3 * seconds[INCREMENTS - 1], per * set, per * relax, per * contacts, per * factor,
         per * (total - set - relax - contacts - factor), (double)(last.steps - first.steps) / INCREMENTS,
         (double)(last.factorisations - first.factorisations) / INCREMENTS);
  fflush(stdout);
  gh_rve_destroy(&rve);
}

int main(int argc, char **argv) {
  gh_context *ctx;
  if (gh_context_create(&ctx) != GH_OK) return 1;
  printf("One RVE update, milliseconds: an increment of 0.05 %% to a residual of 1e-8, with tangent; %d "
         "increments\n",
         INCREMENTS);
  printf("grains  boundary    engine    median     mean  largest |     set   relax contact  factor    rest | "
         " steps  fact\n");
  for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
    gh_packing *p = make_packing(ctx, sizes[n]);
    for (size_t b = 0; b < sizeof boundaries / sizeof *boundaries; b++)
      for (int kind = 1; kind >= 0; kind--) {
        const char *name = kind ? "native" : "lammps";
        bool wanted = argc < 2;
        for (int a = 1; a < argc; a++) wanted |= !strcmp(argv[a], name);
        if (wanted) measure(ctx, p, boundaries[b], kind ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS);
      }
    gh_packing_destroy(&p);
  }
  gh_context_destroy(&ctx);
  return 0;
}
