/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The choice of Newton's matrix: the same answer with each, at its own rate. */
#include "../help.h"

#include "granhom/macro.h"

enum { LINES = 240 };

typedef struct block {
  gh_context *ctx;
  gh_packing *packing;
  gh_mesh *mesh;
  gh_farm *farm;
  gh_loads *loads;
  gh_macro *macro;
  gh_macro_report report;
  double relative[LINES]; /* of the last increment */
  int lines;
} block;

static void watch(void *data, const gh_macro_iteration *it) {
  block *b = data;
  if (it->iteration == 0) b->lines = 0;
  if (b->lines < LINES) b->relative[b->lines++] = it->relative;
}

/* A 2 x 2 block with a node moved inside, so that all points differ. */
static void make_block(gh_context *ctx, bool friction, gh_tangent tangent, block *b) {
  *b = (block){.ctx = ctx, .packing = case_packing(ctx, "p150")};
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_TAYLOR_CELL, 50, 1e-12);
  gh_macro_options solver = gh_macro_defaults();
  if (friction) {
    o.law.friction = true;
    o.law.tangential_stiffness = 25;
    o.law.friction_coefficient = 0.3;
  }
  solver.tangent = tangent;
  solver.tolerance = 1e-11;
  solver.max_iterations = tangent >= GH_TANGENT_FROZEN ? 200 : 20;
  OK(gh_mesh_rectangle(ctx, (const double[]){0, 0}, (const double[]){2, 2}, (const int[]){2, 2}, &b->mesh));
  b->mesh->X[8] += 0.2, b->mesh->X[9] -= 0.1;
  OK(gh_farm_create_rves(ctx, 16, b->packing, &o, &b->farm));
  OK(gh_loads_create(ctx, b->mesh, &b->loads));
  OK(gh_macro_create(ctx, b->mesh, b->farm, &solver, &b->macro));
  gh_macro_set_watch(b->macro, watch, b);
  OK(gh_macro_balance(b->macro));
}

static void drop_block(block *b) {
  gh_macro_destroy(&b->macro);
  gh_loads_destroy(&b->loads);
  gh_farm_destroy(&b->farm);
  gh_mesh_destroy(&b->mesh);
  gh_packing_destroy(&b->packing);
}

/* Increment k: the top goes down and sideways, pressure on the right; it follows where the matrix may be
 * unsymmetric anyway. */
static void solve(block *b, int k, bool follow) {
  gh_context *ctx = b->ctx;
  int bottom = gh_mesh_find(b->mesh, "bottom"), top = gh_mesh_find(b->mesh, "top"),
      right = gh_mesh_find(b->mesh, "right");
  gh_loads_clear(b->loads);
  for (int i = 0; i < 2; i++) OK(gh_loads_displace(b->loads, bottom, i, 0));
  OK(gh_loads_displace(b->loads, top, 0, 1e-3 * k));
  OK(gh_loads_displace(b->loads, top, 1, -2e-3 * k));
  OK(gh_loads_pressure(b->loads, right, 2e-3 * k, follow));
  OK(gh_macro_solve(b->macro, b->loads, &b->report));
}

enum { INCREMENTS = 4 };

/* Largest difference of u and P against the algorithmic tangent, relative. */
static void compare(gh_context *ctx, bool friction, gh_tangent tangent) {
  block a, b;
  make_block(ctx, friction, GH_TANGENT_ALGORITHMIC, &a);
  make_block(ctx, friction, tangent, &b);
  for (int k = 1; k <= INCREMENTS; k++) {
    solve(&a, k, true);
    solve(&b, k, true);
    assert_int_equal(b.report.cuts + b.report.jumps, 0);
    const double *u = gh_macro_u(a.macro), *P = gh_macro_P(a.macro), *A = gh_macro_A(a.macro);
    NEAR("u", distance(u, gh_macro_u(b.macro), 18), 0, 1e-8 * norm(u, 18));
    NEAR("P", distance(P, gh_macro_P(b.macro), 64), 0, 1e-8 * norm(P, 64));
    /* tangents at the end are those of the end, whatever was iterated with */
    NEAR("A", distance(A, gh_macro_A(b.macro), 256), 0, 1e-6 * norm(A, 256));
  }
  drop_block(&a);
  drop_block(&b);
}

static void same_answers(void **state) {
  for (int t = GH_TANGENT_SYMMETRISED; t <= GH_TANGENT_ELASTIC; t++)
    for (int friction = 0; friction < 2; friction++) compare(*state, friction, (gh_tangent)t);
}

/* The order from three residuals in a row, the last of them the smallest above round-off. */
static double order(const block *b) {
  int k = b->lines - 1;
  while (k > 2 && b->relative[k] < 1e-12) k--;
  const double *r = b->relative + k;
  return log(r[0] / r[-1]) / log(r[-1] / r[-2]);
}

static double order_of(gh_context *ctx, bool friction, gh_tangent tangent, bool follow, int *iterations) {
  block b;
  double p = NAN;
  make_block(ctx, friction, tangent, &b);
  for (int k = 1; k <= INCREMENTS; k++) {
    solve(&b, k, follow);
    p = order(&b);
    if (getenv("LEAN_TELL")) {
      printf("%s friction %d follow %d: %d iterations, order %.2f:", gh_tangent_name(tangent), friction,
             follow, b.report.iterations, p);
      for (int j = 0; j < b.lines && j < 12; j++) printf(" %.1e", b.relative[j]);
      printf("\n");
    }
  }
  *iterations = b.report.iterations;
  drop_block(&b);
  return p;
}

/* The present tangent converges quadratically; its symmetric part is the same thing without friction and
 * linear with it; those that stay behind are linear, the older the slower. */
static void orders(void **state) {
  gh_context *ctx = *state;
  for (int friction = 0; friction < 2; friction++) {
    int n[4];
    double p[4];
    for (int t = 0; t < 4; t++) p[t] = order_of(ctx, friction, (gh_tangent)t, false, n + t);
    if (!friction) assert_true(p[GH_TANGENT_ALGORITHMIC] > 1.8);
    if (!friction) assert_int_equal(n[GH_TANGENT_SYMMETRISED], n[GH_TANGENT_ALGORITHMIC]);
    else
      assert_true(n[GH_TANGENT_SYMMETRISED] > n[GH_TANGENT_ALGORITHMIC] && p[GH_TANGENT_SYMMETRISED] < 1.5);
    NEAR("order with the frozen tangent", p[GH_TANGENT_FROZEN], 1, 0.1);
    NEAR("order with the elastic tangent", p[GH_TANGENT_ELASTIC], 1, 0.1);
    assert_true(n[GH_TANGENT_FROZEN] > n[GH_TANGENT_ALGORITHMIC]);
    assert_true(n[GH_TANGENT_ELASTIC] > n[GH_TANGENT_FROZEN]);
  }
}

/* A macro that has loaded the state of another continues to the same last bit, also with the elastic tangent,
 * which is of a state that neither has current any more. */
static void going_on(void **state) {
  gh_context *ctx = *state;
  for (int t = 0; t < 4; t++) {
    block a, b;
    gh_farm_image image;
    make_block(ctx, true, (gh_tangent)t, &a);
    make_block(ctx, true, (gh_tangent)t, &b);
    for (int k = 1; k <= 2; k++) solve(&a, k, false);
    size_t size = gh_macro_state_size(a.macro);
    double *numbers = malloc(size * sizeof *numbers);
    assert_non_null(numbers);
    gh_macro_save(a.macro, numbers);
    OK(gh_farm_save(a.farm, &image));
    OK(gh_farm_load(b.farm, &image));
    OK(gh_macro_load(b.macro, numbers, size));
    solve(&a, 3, false);
    solve(&b, 3, false);
    assert_memory_equal(gh_macro_u(a.macro), gh_macro_u(b.macro), 18 * sizeof(double));
    assert_int_equal(a.report.iterations, b.report.iterations);
    gh_farm_image_free(&image);
    free(numbers);
    drop_block(&a);
    drop_block(&b);
  }
}

/* Far from where it was made, the elastic tangent is too far behind to converge. That is no instability of a
 * packing: the part is done with the present tangent, and ends where all others do. */
static void too_far_behind(void **state) {
  gh_context *ctx = *state;
  for (int t = GH_TANGENT_FROZEN; t <= GH_TANGENT_ELASTIC; t++) {
    block a, b;
    make_block(ctx, false, GH_TANGENT_ALGORITHMIC, &a);
    make_block(ctx, false, (gh_tangent)t, &b);
    int most = 0;
    for (int k = 10; k <= 90; k += 20) {
      solve(&a, k, false);
      solve(&b, k, false);
      assert_int_equal(a.report.cuts + a.report.jumps + b.report.jumps, 0);
      const double *u = gh_macro_u(a.macro);
      NEAR("u", distance(u, gh_macro_u(b.macro), 18), 0, 1e-8 * norm(u, 18));
      most = b.report.iterations > most ? b.report.iterations : most;
    }
    if (getenv("LEAN_TELL")) printf("%s: at most %d iterations\n", gh_tangent_name((gh_tangent)t), most);
    drop_block(&a);
    drop_block(&b);
  }
}

static void names(void **state) {
  (void)state;
  gh_tangent t;
  for (int k = 0; k < 4; k++) {
    assert_true(gh_tangent_from_name(gh_tangent_name((gh_tangent)k), &t));
    assert_int_equal(t, k);
  }
  assert_false(gh_tangent_from_name("secant", &t));
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(same_answers), TEST(orders), TEST(going_on), TEST(too_far_behind),
                                     TEST(names)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
