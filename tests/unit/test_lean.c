/* Nothing unneeded: what a scene pays for, counted. SPDX-License-Identifier: GPL-2.0-or-later
 *
 * The linker sends the calls of granhom's own objects to the counting functions below (--wrap, see the
 * Makefile). What LAMMPS and SuiteSparse allocate inside their own libraries is theirs and is not seen, with
 * the exception of memory that granhom's styles ask LAMMPS's Memory for. */
#include "../help.h"

#include "granhom/macro.h"

/* ---- counting ---- */

#define COUNTERS(X)                                                                                          \
  X(memory)                                                                                                  \
  X(open)                                                                                                    \
  X(command)                                                                                                 \
  X(run)                                                                                                     \
  X(begin)                                                                                                   \
  X(set) X(relax) X(rattlers) X(analyses) X(factorisations) X(lu_analyses) X(lu_factorisations)

typedef struct counts {
#define FIELD(name) long name;
  COUNTERS(FIELD)
#undef FIELD
} counts;
static counts now;

#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#define COUNTED(type, name, parameters, arguments, what)                                                     \
  type __real_##name parameters;                                                                             \
  type __wrap_##name parameters;                                                                             \
  type __wrap_##name parameters {                                                                            \
    what;                                                                                                    \
    return __real_##name arguments;                                                                          \
  }
COUNTED(void *, malloc, (size_t n), (n), now.memory++)
COUNTED(void *, calloc, (size_t n, size_t m), (n, m), now.memory++)
COUNTED(void *, realloc, (void *p, size_t n), (p, n), now.memory++)
COUNTED(void *, _Znwm, (size_t n), (n), now.memory++)
COUNTED(void *, _ZN9LAMMPS_NS6Memory7smallocElPKc, (void *self, int64_t n, const char *name), (self, n, name),
        now.memory++)
COUNTED(void *, _ZN9LAMMPS_NS6Memory8sreallocEPvlPKc, (void *self, void *p, int64_t n, const char *name),
        (self, p, n, name), now.memory++)
COUNTED(void *, lammps_open, (int n, char **words, void *comm, void **handle), (n, words, comm, handle),
        now.open++)
COUNTED(char *, lammps_command, (void *handle, const char *text), (handle, text),
        strncmp(text, "run ", 4) ? now.command++ : now.run++)
COUNTED(gh_status, gh_engine_begin, (gh_engine * e, const gh_converged *c), (e, c), now.begin++)
COUNTED(gh_status, gh_engine_set, (gh_engine * e, const double *c, const double *x, const double *t),
        (e, c, x, t), now.set++)
COUNTED(gh_status, gh_engine_relax, (gh_engine * e, const gh_relax_options *o, gh_relax_result *r), (e, o, r),
        now.relax++)
COUNTED(gh_status, gh_rve_find_rattlers, (gh_rve * r), (r), now.rattlers++)
COUNTED(void *, cholmod_analyze, (void *A, void *c), (A, c), now.analyses++)
COUNTED(int, cholmod_factorize, (void *A, void *L, void *c), (A, L, c), now.factorisations++)
COUNTED(void *, klu_analyze, (int n, int *p, int *i, void *c), (n, p, i, c), now.lu_analyses++)
COUNTED(void *, klu_factor, (int *p, int *i, double *x, void *s, void *c), (p, i, x, s, c),
        now.lu_factorisations++)

static counts since(const counts *before) {
  counts d;
#define MINUS(name) d.name = now.name - before->name;
  COUNTERS(MINUS)
#undef MINUS
  return d;
}

static void tell(const char *what, const counts *d) {
  if (!getenv("LEAN_TELL")) return;
  printf("%-28s", what);
#define TELL(name) printf(" %s %ld", #name, d->name);
  COUNTERS(TELL)
#undef TELL
  printf("\n");
}

/* ---- a block of two elements ---- */

typedef struct block {
  gh_packing *packing;
  gh_mesh *mesh;
  gh_farm *farm;
  gh_loads *loads;
  gh_macro *macro;
  counts first, iterations; /* at iteration 0; in all iterations of the last increment */
  gh_macro_report report;
} block;

static void watch(void *data, const gh_macro_iteration *it) {
  block *b = data;
  if (it->iteration == 0) b->first = now;
  else b->iterations = since(&b->first);
}

static gh_rve_options law(gh_boundary boundary, gh_engine_kind engine, bool friction) {
  gh_rve_options o = rve_options(engine, boundary, 100, 1e-9);
  if (!friction) return o;
  o.law.friction = true;
  o.law.tangential_stiffness = 50;
  o.law.friction_coefficient = 0.4;
  return o;
}

static void make_block(gh_context *ctx, const gh_rve_options *o, block *b) {
  gh_macro_options solver = gh_macro_defaults();
  *b = (block){0};
  b->packing = case_packing(ctx, "p50");
  OK(gh_mesh_rectangle(ctx, (const double[]){0, 0}, (const double[]){2, 1}, (const int[]){2, 1}, &b->mesh));
  OK(gh_farm_create_rves(ctx, 8, b->packing, o, &b->farm));
  OK(gh_loads_create(ctx, b->mesh, &b->loads));
  OK(gh_macro_create(ctx, b->mesh, b->farm, &solver, &b->macro));
  gh_macro_set_watch(b->macro, watch, b);
  OK(gh_macro_balance(b->macro));
}

/* The increment k: the top goes down and sideways, so that all points differ. */
static void solve(gh_context *ctx, block *b, int k) {
  int bottom = gh_mesh_find(b->mesh, "bottom"), top = gh_mesh_find(b->mesh, "top");
  gh_loads_clear(b->loads);
  for (int i = 0; i < 2; i++) OK(gh_loads_displace(b->loads, bottom, i, 0));
  OK(gh_loads_displace(b->loads, top, 0, 2e-4 * k));
  OK(gh_loads_displace(b->loads, top, 1, -2e-4 * k));
  OK(gh_macro_solve(b->macro, b->loads, &b->report));
}

static void drop_block(block *b) {
  gh_macro_destroy(&b->macro);
  gh_loads_destroy(&b->loads);
  gh_farm_destroy(&b->farm);
  gh_mesh_destroy(&b->mesh);
  gh_packing_destroy(&b->packing);
}

static void try_it(void **state) {
  gh_context *ctx = *state;
  for (int e = 0; e < 2; e++)
    for (int f = 0; f < 2; f++)
      for (int k = 0; k < 4; k++) {
        block b;
        gh_rve_options o = law(all_boundaries[k], (gh_engine_kind)e, f);
        make_block(ctx, &o, &b);
        for (int n = 1; n <= 8; n++) {
          char text[64];
          solve(ctx, &b, n);
          snprintf(text, sizeof text, "%s %s %d: %d it", engine_names[e], gh_boundary_name(o.boundary), f,
                   b.report.iterations);
          if (n == 1 || n > 6) tell(text, &b.iterations);
        }
        drop_block(&b);
      }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(try_it)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
