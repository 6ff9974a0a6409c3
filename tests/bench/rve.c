/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Time of one RVE update and where it goes: an increment of 0.05 % uniaxial compression to a residual of
 * 1e-8, with tangent. Packings: bench.h.
 * usage: rve [engine ...]   (default: native lammps) */
#include "bench.h"

enum { INCREMENTS = 20, WARM_UP = 2 };
static const int sizes[] = {88, 150, 300, 400, 600, 700};
static const gh_boundary boundaries[] = {GH_TAYLOR, GH_TAYLOR_CELL, GH_RESTRICTED, GH_PERIODIC};

typedef struct figures {
  double seconds[INCREMENTS]; /* ascending */
  double set, relax, contacts, factor, history, total, steps,
      factorisations; /* per increment, milliseconds */
} figures;

static void measure(gh_context *ctx, const gh_packing *p, gh_boundary b, gh_engine_kind kind, double friction,
                    figures *f) {
  gh_rve_options o = gh_rve_defaults();
  o.boundary = b, o.engine = kind, o.law.normal_stiffness = 1000, o.tolerance = 1e-8;
  o.law.friction = friction > 0, o.law.tangential_stiffness = 1000, o.law.friction_coefficient = friction;
  gh_rve *rve;
  gh_rve_cost first, last;
  double *seconds = f->seconds, P[4], A[16];
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
  double per = 1e3 / INCREMENTS;
  f->total = per * (last.total - first.total), f->set = per * (last.set - first.set);
  f->relax = per * (last.relax - first.relax), f->contacts = per * (last.contacts - first.contacts);
  f->factor = per * (last.factorise - first.factorise), f->history = per * (last.history - first.history);
  f->steps = (double)(last.steps - first.steps) / INCREMENTS;
  f->factorisations = (double)(last.factorisations - first.factorisations) / INCREMENTS;
  gh_rve_destroy(&rve);
}

static const char *engine_name(gh_engine_kind kind) {
  return kind == GH_ENGINE_NATIVE ? "native" : "lammps";
}

static void print_row(int n, gh_boundary b, gh_engine_kind kind, const figures *f) {
  printf("%6d  %-11s %-7s %8.3f %8.3f %8.3f | %7.3f %7.3f %7.3f %7.3f %7.3f | %6.0f %5.1f\n", n,
         gh_boundary_name(b), engine_name(kind), 1e3 * f->seconds[INCREMENTS / 2], f->total,
         1e3 * f->seconds[INCREMENTS - 1], f->set, f->relax, f->contacts, f->factor,
         f->total - f->set - f->relax - f->contacts - f->factor, f->steps, f->factorisations);
  fflush(stdout);
}

/* With friction 0.5 and 0.1 against without. */
static void friction_rows(gh_context *ctx, const gh_packing *p, gh_engine_kind kind) {
  static const double friction[] = {0.5, 0.1};
  for (size_t b = 0; b < sizeof boundaries / sizeof *boundaries; b++) {
    figures without, with;
    measure(ctx, p, boundaries[b], kind, 0, &without);
    for (size_t k = 0; k < sizeof friction / sizeof *friction; k++) {
      measure(ctx, p, boundaries[b], kind, friction[k], &with);
      double mean = with.total, median = 1e3 * with.seconds[INCREMENTS / 2],
             plain = 1e3 * without.seconds[INCREMENTS / 2];
      printf("%6d  %-11s %-7s %5.1f %8.3f %8.3f %6.2f | %7.3f %7.3f %7.3f %7.3f | %6.1f %% | %6.0f %5.1f\n",
             p->n, gh_boundary_name(boundaries[b]), engine_name(kind), friction[k], plain, median,
             median / plain, with.set, with.relax, with.contacts, with.factor, 100 * with.history / mean,
             with.steps, with.factorisations);
      fflush(stdout);
    }
  }
}

static bool chosen(int argc, char **argv, gh_engine_kind kind) {
  bool wanted = argc < 2;
  for (int a = 1; a < argc; a++) wanted |= !strcmp(argv[a], engine_name(kind));
  return wanted;
}

static void plain_table(gh_context *ctx, gh_packing *const *packings, int argc, char **argv) {
  figures f;
  printf("One RVE update, milliseconds: an increment of 0.05 %% to a residual of 1e-8, with tangent; %d "
         "increments\n",
         INCREMENTS);
  printf("grains  boundary    engine    median     mean  largest |     set   relax contact  factor    rest | "
         " steps  fact\n");
  for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++)
    for (size_t b = 0; b < sizeof boundaries / sizeof *boundaries; b++)
      for (int kind = GH_ENGINE_NATIVE; kind >= GH_ENGINE_LAMMPS; kind--) {
        if (!chosen(argc, argv, (gh_engine_kind)kind)) continue;
        measure(ctx, packings[n], boundaries[b], (gh_engine_kind)kind, 0, &f);
        print_row(packings[n]->n, boundaries[b], (gh_engine_kind)kind, &f);
      }
}

static void friction_table(gh_context *ctx, gh_packing *const *packings, int argc, char **argv) {
  printf("\nThe same with friction (E_t = E_n, rotations free), milliseconds: medians without and with, "
         "their ratio; "
         "parts\nof the mean with friction; share of the history of the contacts\n");
  printf("grains  boundary    engine     mu  without     with  ratio |     set   relax contact  factor |  "
         "history |  "
         "steps  fact\n");
  for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
    if (sizes[n] != 150 && sizes[n] != 300 && sizes[n] != 600) continue;
    for (int kind = GH_ENGINE_NATIVE; kind >= GH_ENGINE_LAMMPS; kind--)
      if (chosen(argc, argv, (gh_engine_kind)kind)) friction_rows(ctx, packings[n], (gh_engine_kind)kind);
  }
}

int main(int argc, char **argv) {
  enum { SIZES = sizeof sizes / sizeof *sizes };
  gh_context *ctx;
  gh_packing *packings[SIZES];
  if (gh_context_create(&ctx) != GH_OK) return 1;
  for (int n = 0; n < SIZES; n++) packings[n] = make_packing(ctx, sizes[n]);
  plain_table(ctx, packings, argc, argv);
  friction_table(ctx, packings, argc, argv);
  for (int n = 0; n < SIZES; n++) gh_packing_destroy(&packings[n]);
  gh_context_destroy(&ctx);
  return 0;
}
