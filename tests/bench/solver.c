/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Time of the linear system of an RVE: analysis, factor and four solves for each law, blocks of grains against
 * CHOLMOD and KLU; and the factor alone where the graph of contacts is the same. Processor time, the least of
 * several. Packings: bench.h; states: compressed by 0.1 %.
 * usage: solver */
#define _GNU_SOURCE
#include <time.h>

#include "bench.h"
#include "micro/internal.h"

static const int sizes[] = {150, 600, 2400};

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

typedef struct times {
  double all, again; /* microseconds: with analysis and four solves; the factor alone */
} times;

static times measure(gh_context *ctx, gh_rve *rve, gh_solver *s) {
  times least = {INFINITY, INFINITY};
  gh_contact_list list = rve->list;
  const int repeats = 200000 / rve->n / 10 + 10;
  gh_solver_input in = gh_rve_solver_input(rve);
  in.list = &list;
  for (int k = 0; k < repeats; k++) {
    const double *X;
    bool good;
    list.count = rve->list.count - k % 2; /* another graph each time */
    double start = now();
    must(ctx, gh_solver_number(ctx, s, &in));
    must(ctx, gh_solver_factor(ctx, s, &in, 1e-3, &good));
    for (int u = 0; u < 4 * s->n; u++) s->rhs[u] = u % 7 - 3;
    must(ctx, gh_solver_solve(ctx, s, 4, &X));
    double middle = now();
    must(ctx, gh_solver_factor(ctx, s, &in, 1e-3, &good));
    least.all = fmin(least.all, middle - start);
    least.again = fmin(least.again, now() - middle);
    if (!good) fprintf(stderr, "bench: %s: not good\n", s->ops->name);
  }
  return least;
}

static gh_rve *compressed(gh_context *ctx, const gh_packing *p, bool friction) {
  static const double F[4] = {0.999, 0, 0, 1};
  gh_rve_options o = gh_rve_defaults();
  double P[4];
  gh_rve *rve;
  o.engine = GH_ENGINE_NATIVE, o.law.normal_stiffness = 1000, o.tolerance = 1e-6;
  o.law.friction = friction, o.law.tangential_stiffness = 200, o.law.friction_coefficient = 0.5;
  must(ctx, gh_rve_create(ctx, p, &o, &rve));
  must(ctx, gh_rve_evaluate(rve, F, 0, P, NULL));
  return rve;
}

static void row(gh_context *ctx, const gh_packing *p, bool friction) {
  gh_rve *rve = compressed(ctx, p, friction);
  gh_solver *block, *other;
  must(ctx, gh_solver_block(ctx, rve->n, !friction, &block));
  must(ctx, friction ? gh_solver_klu(ctx, rve->n, &other) : gh_solver_cholmod(ctx, rve->n, &other));
  times a = measure(ctx, rve, block), b = measure(ctx, rve, other);
  printf("%6d  %-8s  %-7s  %8.0f %8.0f %6.1f | %8.0f %8.0f %6.1f | %d\n", p->n, friction ? "0.5" : "0",
         other->ops->name, b.all, a.all, b.all / a.all, b.again, a.again, b.again / a.again,
         (int)block->fallbacks);
  fflush(stdout);
  gh_solver_destroy(&block);
  gh_solver_destroy(&other);
  gh_rve_destroy(&rve);
}

int main(void) {
  gh_context *ctx;
  if (gh_context_create(&ctx) != GH_OK) return 1;
  printf("Linear system of an RVE, microseconds of the processor: analysis, factor and four solves | "
         "assembly and "
         "factor\non the same graph\n");
  printf("grains  friction  against      other   blocks  ratio |    other   blocks  ratio | fallbacks\n");
  for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
    gh_packing *p = make_packing(ctx, sizes[n]);
    for (int friction = 0; friction < 2; friction++) row(ctx, p, friction);
    gh_packing_destroy(&p);
  }
  gh_context_destroy(&ctx);
  return 0;
}
