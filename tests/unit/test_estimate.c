/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a run knows of its error: marks of a farm, work and energy, two paths that are compared.
 *
 * Orders and true errors are those against the same scene with many more increments, solved once.
 * ESTIMATE_TELL=1 prints the numbers of docs/explanation/method.md. */
#include "../help.h"
#include "scene/internal.h"

#include <stdio.h>
#include <unistd.h>

static bool telling(void) {
  return getenv("ESTIMATE_TELL") != NULL;
}

/* ---- marks ---- */

enum { N = 3 };
static const double path[4][4] = {
    {0.999, 0.001, 0, 0.998}, {0.998, 0.002, 0, 0.996}, {0.997, 0, 0.001, 0.999}, {0.998, 0.001, 0, 0.997}};

static void go(gh_context *ctx, gh_farm *farm, int k, double P[4 * N]) {
  double F[4 * N];
  for (int p = 0; p < N; p++)
    for (int i = 0; i < 4; i++) F[4 * p + i] = path[k][i] + 1e-4 * p * (i == 1);
  OK(gh_farm_evaluate(farm, F, 0, P, NULL));
  OK(gh_farm_commit(farm));
}

static int states(const gh_farm *farm) {
  gh_farm_counts c;
  gh_farm_count(farm, &c);
  return c.states;
}

/* From a mark the same evaluations give the same bits, any number of times, wherever the farm has been in
 * between; measures come back too. */
static void marks_lead_back(void **state) {
  gh_context *ctx = *state;
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_RESTRICTED, 100, 1e-9);
  o.law.friction = true, o.law.tangential_stiffness = 50, o.law.friction_coefficient = 0.4;
  gh_packing *packing = case_packing(ctx, "p50");
  gh_farm *farm;
  gh_farm_mark *mark, *fresh;
  double P[4 * N], again[4 * N], elsewhere[4 * N];
  OK(gh_farm_create_rves(ctx, N, packing, &o, &farm));
  OK(gh_farm_mark_states(farm, &fresh));
  go(ctx, farm, 0, P);
  const gh_rve_measures then = *gh_farm_measure(farm, 2);
  OK(gh_farm_mark_states(farm, &mark));
  go(ctx, farm, 1, P);
  for (int k = 0; k < 3; k++) {
    for (int n = 1; n < 4; n++) go(ctx, farm, n, elsewhere); /* over the slots that became free */
    gh_farm_return(farm, mark);
    assert_memory_equal(gh_farm_measure(farm, 2), &then, sizeof then);
    go(ctx, farm, 1, again);
    assert_memory_equal(P, again, sizeof P);
  }
  gh_farm_return(farm, fresh);
  assert_int_equal(states(farm), 1); /* the packing as read */
  go(ctx, farm, 0, elsewhere);
  gh_farm_return(farm, mark);
  go(ctx, farm, 1, again);
  assert_memory_equal(P, again, sizeof P);
  gh_farm_drop_mark(farm, &mark);
  gh_farm_drop_mark(farm, &fresh);
  assert_null(mark);
  go(ctx, farm, 2, again);
  assert_int_equal(states(farm), N);
  gh_farm_destroy(&farm);
  gh_packing_destroy(&packing);
}

/* ---- a block that is compressed and sheared ---- */

typedef struct run {
  gh_context *ctx;
  gh_scene *scene;
  gh_farm *farm;
  gh_macro *macro;
  gh_loads *loads;
  int points;
} run;

/* law: what follows the stiffness; n increments. */
static void open_run(gh_context *ctx, const char *boundary, const char *law, int n, run *r) {
  char name[64];
  snprintf(name, sizeof name, "test_estimate_%ld.yaml", (long)getpid());
  FILE *file = fopen(name, "w");
  assert_non_null(file);
  fprintf(file,
          "packing: tests/data/cases/packings/p50.data\ncontact: {normal_stiffness: 50%s}\n"
          "micro: {boundary: %s, engine: native, tolerance: 1e-10}\nstart: {balance: true}\n"
          "mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}\nsupports: [{edge: bottom, fix: both}]\n"
          "steps: [{increments: %d, displace: [{edge: top, x: 0.1, y: -0.1}]}]\nsolver: {tolerance: 1e-10}\n",
          law, boundary, n);
  assert_int_equal(fclose(file), 0);
  *r = (run){.ctx = ctx};
  OK(gh_scene_read(ctx, name, &r->scene));
  unlink(name);
  r->points = 4 * r->scene->mesh->nelements;
  OK(gh_farm_create_rves(ctx, r->points, r->scene->packings[0], &r->scene->micro, &r->farm));
  OK(gh_macro_create(ctx, r->scene->mesh, r->farm, &r->scene->solver, &r->macro));
  OK(gh_loads_create(ctx, r->scene->mesh, &r->loads));
  OK(gh_scene_loads(r->scene, 0, 1, NULL, r->loads));
  OK(gh_macro_balance(r->macro));
  OK(gh_macro_solve(r->macro, r->loads, NULL));
  gh_macro_zero_energy(r->macro);
}

static void close_run(run *r) {
  gh_macro_destroy(&r->macro);
  gh_loads_destroy(&r->loads);
  gh_farm_destroy(&r->farm);
  gh_scene_destroy(&r->scene);
}

enum { POINTS = 16, FINE = 512, ROWS = 4 };

/* One increment, with or without an estimate. */
static void advance(run *r, int k, gh_run_estimate *e) {
  gh_context *ctx = r->ctx;
  gh_macro_report report, whole;
  OK(gh_scene_loads(r->scene, 1, k, k == 1 ? gh_macro_u(r->macro) : NULL, r->loads));
  if (e) OK(scene_solve_twice(r->scene, r->macro, r->loads, &report, &whole, e));
  else OK(gh_macro_solve(r->macro, r->loads, &report));
}

/* Stress at ROWS places of the path, evenly. */
static void follow(gh_context *ctx, const char *boundary, const char *law, int n, gh_run_estimate *e,
                   double P[ROWS][4 * POINTS], gh_energy *energy) {
  run r;
  open_run(ctx, boundary, law, n, &r);
  for (int k = 1; k <= n; k++) {
    advance(&r, k, e);
    if (P && k % (n / ROWS) == 0)
      memcpy(P[k / (n / ROWS) - 1], gh_macro_P(r.macro), 4 * POINTS * sizeof(double));
  }
  gh_macro_energy(r.macro, energy);
  close_run(&r);
}

/* Root mean square over equal points of the difference; b NULL: of a. */
static double rms(const double *a, const double *b) {
  double sum = 0;
  for (int k = 0; k < 4 * POINTS; k++) sum += (a[k] - (b ? b[k] : 0)) * (a[k] - (b ? b[k] : 0));
  return sqrt(sum / POINTS);
}

static const char friction[] = ", tangential_stiffness: 50, friction_angle: 20";

/* The slope of log y over log x, by least squares. */
static double slope(int n, const double *x, const double *y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int k = 0; k < n; k++) {
    double a = log(x[k]), b = log(y[k]);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/* With friction and grains that follow F the path is smooth but for contacts that begin to slide or part. The
 * estimate is right within a factor of three, and falls with order one, as the true error does. */
static void friction_is_of_first_order(void **state) {
  if (getenv("SANITIZED")) return; /* the others use the same code */
  enum { RUNS = 5 };
  static const char *const boundaries[] = {"taylor", "taylor-cell"};
  for (int b = 0; b < 2; b++) {
    double fine[ROWS][4 * POINTS], P[ROWS][4 * POINTS], part[RUNS], told[RUNS], found[RUNS], defect[RUNS];
    gh_energy energy;
    follow(*state, boundaries[b], friction, FINE, NULL, fine, &energy);
    for (int k = 0; k < RUNS; k++) {
      int n = 4 << k;
      gh_run_estimate e = {0};
      follow(*state, boundaries[b], friction, n, &e, P, &energy);
      double scale = 0, off = 0;
      for (int row = 0; row < ROWS; row++) {
        scale = fmax(scale, rms(fine[row], NULL));
        off = fmax(off, rms(P[row], fine[row]));
      }
      part[k] = 1.0 / n, found[k] = off / scale, told[k] = gh_estimated_error(&e, GH_ERROR_STRESS);
      defect[k] = fabs(gh_energy_defect(&energy));
      if (telling())
        printf("%-12s %3d increments: true error %.2e, estimate %.2e, ratio %.2f, energy imbalance %.2e\n",
               boundaries[b], n, found[k], told[k], told[k] / found[k], defect[k]);
      assert_int_equal(e.increments, n);
      assert_int_equal(e.branched, 0);
      assert_true(told[k] < 3 * found[k] && told[k] > found[k] / 3);
    }
    if (telling())
      printf("%-12s orders: true error %.2f, estimate %.2f, energy imbalance %.2f\n", boundaries[b],
             slope(RUNS, part, found), slope(RUNS, part, told), slope(RUNS, part, defect));
    NEAR("order of the true error", slope(RUNS, part, found), 1, 0.35);
    NEAR("order of the estimate", slope(RUNS, part, told), 1, 0.35);
    NEAR("order of the energy imbalance", slope(RUNS, part, defect), 1, 0.3);
  }
}

/* Without friction stress is a function of F: both paths end at the same state, to what the tolerance of
 * 1e-10 leaves. The energy imbalance is of second order. */
static void frictionless_paths_agree(void **state) {
  static const char *const boundaries[] = {"taylor", "taylor-cell"};
  for (int b = 0; b < 2; b++) {
    double part[4], defect[4];
    for (int k = 0; k < 4; k++) {
      int n = 4 << k;
      gh_run_estimate e = {0};
      gh_energy energy;
      follow(*state, boundaries[b], "", n, &e, NULL, &energy);
      assert_int_equal(e.branched, 0);
      for (int j = 0; j < GH_ERRORS; j++) assert_true(gh_estimated_error(&e, j) < 1e-8);
      part[k] = 1.0 / n, defect[k] = fabs(gh_energy_defect(&energy));
      if (telling())
        printf("%-12s without friction, %2d increments: estimate %.1e, energy imbalance %.2e\n",
               boundaries[b], n, gh_estimated_error(&e, GH_ERROR_STRESS), defect[k]);
      assert_true(fabs(gh_work_defect(&energy)) < 1e-8);
      assert_true(energy.residual <= 1e-10 && energy.freed == 0 && energy.dissipation == 0);
    }
    NEAR("order of the energy imbalance", slope(4, part, defect), 2, 0.35);
  }
}

/* The body in halves is what a run with twice the increments is, whatever the other does, and the same bits
 * when both are exchanged and exchanged back. */
static void halves_are_the_finer_run(void **state) {
  gh_context *ctx = *state;
  enum { INCREMENTS = 4 };
  double P[ROWS][4 * POINTS], Q[ROWS][4 * POINTS];
  gh_run_estimate e = {0};
  gh_energy energy;
  run r;
  follow(ctx, "taylor", friction, 2 * INCREMENTS, NULL, P, &energy);
  open_run(ctx, "taylor", friction, INCREMENTS, &r);
  for (int k = 1; k <= INCREMENTS; k++) {
    advance(&r, k, &e);
    assert_true(gh_macro_apart(r.macro));
    memcpy(Q[0], gh_macro_P(r.macro), sizeof Q[0]);
    OK(gh_macro_exchange(r.macro));
    assert_true(rms(Q[0], gh_macro_P(r.macro)) > 0);
    OK(gh_macro_exchange(r.macro));
    assert_memory_equal(Q[0], gh_macro_P(r.macro), sizeof Q[0]);
  }
  NEAR("stress", distance(Q[0], P[ROWS - 1], 4 * POINTS), 0, 1e-9 * norm(P[ROWS - 1], 4 * POINTS));
  close_run(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(marks_lead_back), TEST(friction_is_of_first_order),
                                     TEST(frictionless_paths_agree), TEST(halves_are_the_finer_run)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
