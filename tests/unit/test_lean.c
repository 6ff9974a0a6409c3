/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Nothing unneeded: what a scene pays for, counted.
 *
 * The linker sends the calls of granhom's own objects to the counting functions below (--wrap, see the
 * Makefile). What LAMMPS and SuiteSparse allocate inside their own libraries is theirs and is not seen, with
 * the exception of memory that granhom's styles ask LAMMPS's Memory for. */
#include "../help.h"

#include "granhom/macro.h"
#include "micro/block.h"
#include "micro/internal.h"

/* ---- counting ---- */

#define COUNTERS(X)                                                                                          \
  X(memory)                                                                                                  \
  X(open)                                                                                                    \
  X(command)                                                                                                 \
  X(run)                                                                                                     \
  X(begin)                                                                                                   \
  X(set)                                                                                                     \
  X(relax)                                                                                                   \
  X(rattlers) X(analyses) X(stiffnesses) X(fallbacks) X(factorisations) X(umfpack) X(tangents)

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
COUNTED(gh_status, gh_block_pattern_make, (gh_context * c, gh_block_pattern *p, const gh_block_graph *g),
        (c, p, g), now.analyses++)
COUNTED(gh_status, gh_solver_factor,
        (gh_context * c, gh_solver *s, const gh_solver_input *in, double shift, bool *good),
        (c, s, in, shift, good), now.stiffnesses++)
COUNTED(int, cholmod_factorize, (void *A, void *L, void *c), (A, L, c), now.factorisations++)
COUNTED(void *, klu_factor, (int *p, int *i, double *x, void *s, void *c), (p, i, x, s, c), now.fallbacks++)

COUNTED(int, umfpack_di_numeric,
        (const int *p, const int *i, const double *x, void *symbolic, void **numeric, const double *c,
         double *info),
        (p, i, x, symbolic, numeric, c, info), now.umfpack++)

COUNTED(gh_status, gh_rve_tangent, (gh_rve * r, double *A), (r, A), now.tangents++)
COUNTED(gh_status, gh_rve_tangent_friction, (gh_rve * r, double *A), (r, A), now.tangents++)

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

/* ---- a block of two by two elements ---- */

typedef struct block {
  gh_packing *packing;
  gh_mesh *mesh;
  gh_farm *farm;
  gh_loads *loads;
  gh_macro *macro;
  counts first, iterations; /* at iteration 0; in all iterations of the last increment */
  counts whole;             /* in all of it */
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

static void make_block(gh_context *ctx, const gh_rve_options *o, bool share, gh_tangent tangent, block *b) {
  gh_macro_options solver = gh_macro_defaults();
  solver.tangent = tangent;
  solver.max_iterations = 100;
  *b = (block){0};
  b->packing = case_packing(ctx, "p50");
  OK(gh_mesh_rectangle(ctx, (const double[]){0, 0}, (const double[]){2, 2}, (const int[]){2, 2}, &b->mesh));
  const gh_packing *packings[] = {b->packing};
  const gh_farm_setup setup = {.n = 16, .npackings = 1, .packings = packings, .rve = *o, .no_share = !share};
  OK(gh_farm_create_shared(ctx, &setup, &b->farm));
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
  counts before = now;
  OK(gh_macro_solve(b->macro, b->loads, &b->report));
  b->whole = since(&before);
}

static void drop_block(block *b) {
  gh_macro_destroy(&b->macro);
  gh_loads_destroy(&b->loads);
  gh_farm_destroy(&b->farm);
  gh_mesh_destroy(&b->mesh);
  gh_packing_destroy(&b->packing);
}

/* A round there and back after four to warm up. The path is the same in each, so that nothing that was large
 * enough before needs to grow. */
static void steady(gh_context *ctx, gh_boundary boundary, gh_engine_kind engine, bool friction,
                   gh_relaxation relaxation) {
  static const int round[] = {1, 2, 1, 0};
  enum { PER_ROUND = 4, WARM = 4 * PER_ROUND, ALL = 5 * PER_ROUND };
  char name[80];
  block b;
  counts sum = {0};
  gh_rve_options o = law(boundary, engine, friction);
  o.relaxation = relaxation;
  snprintf(name, sizeof name, "%s %s%s %s", engine_names[engine], gh_boundary_name(boundary),
           friction ? " friction" : "", gh_relaxation_name(relaxation));
  make_block(ctx, &o, false, GH_TANGENT_ALGORITHMIC, &b);
  for (int n = 0; n < ALL; n++) {
    solve(ctx, &b, round[n % PER_ROUND]);
    const counts *d = &b.iterations;
    assert_int_equal(d->open + d->command + d->run, 0);
    if (n < WARM) continue;
#define ADD(field) sum.field += d->field;
    COUNTERS(ADD)
#undef ADD
    assert_int_equal(d->stiffnesses > 0, friction || boundary >= GH_RESTRICTED);
    assert_int_equal(d->fallbacks, 0);
    if (b.report.cuts > 0) continue; /* d is of the last part */
    if (friction) assert_int_equal(d->umfpack, b.report.iterations);
    if (friction || boundary >= GH_RESTRICTED) continue;
    assert_int_equal(d->factorisations, b.report.iterations);
    assert_int_equal(d->umfpack + d->relax + d->rattlers, 0);
  }
  tell(name, &sum);
  assert_int_equal(sum.memory, 0);
  drop_block(&b);
}

static void iterations_ask_for_nothing(void **state) {
  for (int e = 0; e < 2; e++)
    for (int f = 0; f < 2 && use_engine((gh_engine_kind)e); f++)
      for (int k = 0; k < 4; k++) {
        steady(*state, all_boundaries[k], (gh_engine_kind)e, f, GH_RELAX_POLISHED);
        if (k == 3) steady(*state, all_boundaries[k], (gh_engine_kind)e, f, GH_RELAX_FIRE);
      }
}

/* Points that share begin as one RVE and open one each when they part, in the first iteration: not one more
 * in the second, although nothing is committed yet. */
static void points_open_once(void **state) {
  gh_context *ctx = *state;
  if (!use_engine(GH_ENGINE_LAMMPS)) return;
  for (int share = 0; share < 2; share++) {
    block b;
    gh_rve_options o = law(GH_TAYLOR_CELL, GH_ENGINE_LAMMPS, false);
    counts before = now;
    make_block(ctx, &o, share, GH_TANGENT_ALGORITHMIC, &b);
    counts made = since(&before);
    assert_int_equal(made.open, 1 + (share ? 1 : 16)); /* one to see that the options will do */
    solve(ctx, &b, 1);
    solve(ctx, &b, 2);
    assert_true(b.report.iterations >= 2);
    made = since(&before);
    assert_int_equal(made.open, 17);
    drop_block(&b);
  }
}

/* Tangents that stay behind cost one factorisation of the whole body for all iterations of an increment, and
 * one tangent of each packing, at the end. */
static void one_factor_for_an_increment(void **state) {
  gh_context *ctx = *state;
  for (int t = GH_TANGENT_FROZEN; t <= GH_TANGENT_ELASTIC; t++)
    for (int friction = 0; friction < 2; friction++) {
      block b;
      gh_rve_options o = law(GH_TAYLOR_CELL, GH_ENGINE_NATIVE, friction);
      o.law.fixed_rotations = friction;
      int all = 0;
      make_block(ctx, &o, false, (gh_tangent)t, &b);
      for (int k = 1; k <= 3; k++) {
        solve(ctx, &b, k);
        counts d = b.iterations;
        tell("frozen or elastic", &d);
        assert_int_equal(b.report.cuts, 0);
        all += b.report.iterations;
        assert_int_equal(d.umfpack + d.factorisations, 1); /* LU where contacts slide */
        assert_int_equal(d.stiffnesses, 0);
        assert_int_equal(d.tangents, 0);
        assert_int_equal(b.whole.tangents, 16);
      }
      assert_true(all > 3);
      drop_block(&b);
    }
}

/* One evaluation from the packing as read. */
static counts evaluate_once(gh_context *ctx, const gh_rve_options *o, unsigned want, gh_rve **rve) {
  const double F[4] = {0.999, 0.001, 0, 0.998};
  double P[4], A[16];
  gh_packing *p = case_packing(ctx, "p50");
  OK(gh_rve_create(ctx, p, o, rve));
  counts before = now;
  OK(gh_rve_evaluate(*rve, F, want, P, A));
  gh_packing_destroy(&p);
  return since(&before);
}

/* Without friction: no rotations, no history, nothing of either in a state, no fall-back. */
static void frictionless(void **state) {
  gh_context *ctx = *state;
  for (int k = 0; k < 8; k++) {
    gh_engine_kind engine = (gh_engine_kind)(k / 4);
    gh_rve *rve;
    gh_rve_options o = law(all_boundaries[k % 4], engine, false);
    if (!use_engine(engine)) continue;
    counts d = evaluate_once(ctx, &o, GH_WANT_TANGENT, &rve);
    assert_int_equal(gh_rve_trial_size(rve), 4 + 2 * rve->n); /* F and positions */
    assert_null(rve->theta);
    assert_null(rve->thetan);
    assert_null(rve->turn);
    assert_true(!rve->solver || strcmp(rve->solver->ops->name, "blocks") == 0);
    assert_null(rve->history.slips);
    assert_null(rve->trial_history.slips);
    assert_null(rve->list.friction);
    assert_null(rve->list.moment);
    assert_int_equal(d.begin + d.fallbacks, 0);
    gh_rve_destroy(&rve);
  }
}

/* With friction a state grows by the rotations, four numbers, and seven for each contact; a trial state behind a
 * ramp by the end of the ramp, in which as many contacts have a history at most. */
static void history_costs_its_contacts(void **state) {
  gh_context *ctx = *state;
  gh_rve *rve;
  gh_rve_options o = law(GH_PERIODIC, GH_ENGINE_NATIVE, true);
  for (int k = 0; k < 2; k++) {
    o.integration = k ? GH_INTEGRATION_RAMP : GH_INTEGRATION_WHOLE;
    evaluate_once(ctx, &o, 0, &rve);
    const int contacts = gh_rve_measure(rve)->contacts, grains = 4 + 3 * rve->n + 4,
              whole = grains + 7 * contacts;
    assert_true(contacts > 50);
    if (k == 0) assert_int_equal(gh_rve_trial_size(rve), whole);
    else assert_in_range(gh_rve_trial_size(rve), whole + grains, 2 * whole + 7 * 5);
    gh_rve_destroy(&rve);
  }
}

/* Taylor without friction: one set of forces, no relaxation, no search for rattlers, no factor. */
static void taylor(void **state) {
  gh_context *ctx = *state;
  for (int k = 0; k < 4; k++) {
    gh_engine_kind engine = (gh_engine_kind)(k / 2);
    gh_rve *rve;
    gh_rve_options o = law(all_boundaries[k % 2], engine, false);
    gh_rve_cost cost;
    if (!use_engine(engine)) continue;
    counts d = evaluate_once(ctx, &o, GH_WANT_TANGENT, &rve);
    assert_int_equal(d.set, 1);
    assert_int_equal(d.relax + d.rattlers + d.analyses + d.stiffnesses, 0);
    gh_rve_costs(rve, &cost);
    assert_int_equal(cost.steps + cost.factorisations, 0);
    assert_null(rve->solver);
    assert_null(rve->rattlers);
    gh_rve_destroy(&rve);
  }
}

/* Who asks for the stress alone pays no factor: none at all where relaxation reaches the tolerance by itself.
 */
static void stress_only(void **state) {
  gh_context *ctx = *state;
  for (int friction = 0; friction < 2; friction++) {
    gh_rve *rve;
    gh_rve_options o = law(GH_PERIODIC, GH_ENGINE_NATIVE, friction);
    o.tolerance = 1e-4;
    counts with = evaluate_once(ctx, &o, GH_WANT_TANGENT, &rve);
    gh_rve_destroy(&rve);
    counts without = evaluate_once(ctx, &o, 0, &rve);
    gh_rve_destroy(&rve);
    assert_true(with.stiffnesses >= 1 && with.analyses >= 1);
    assert_int_equal(without.stiffnesses + without.analyses, 0);
    assert_int_equal(with.factorisations + with.fallbacks, 0);
    assert_true(without.relax >= 1);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(iterations_ask_for_nothing),
                                     TEST(points_open_once),
                                     TEST(one_factor_for_an_increment),
                                     TEST(frictionless),
                                     TEST(history_costs_its_contacts),
                                     TEST(taylor),
                                     TEST(stress_only)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
