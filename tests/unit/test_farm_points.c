/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A farm and its points: of any kind, stopped, of RVEs. */
#include "../help.h"

#include "granhom/farm.h"

static const double I[4] = {1, 0, 0, 1}, squeeze[4] = {0.99, 0.004, 0.002, 0.995};

#define FOR_ENGINES(e)                                                                                       \
  for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)                                      \
    if (use_engine(e))

/* A point of a farm that stands for anything: P = 2 F, fails where F11 = 7; counts what is done to it. */
typedef struct dummy {
  gh_context *ctx;
  int *log; /* commits, reverts, destroyed */
} dummy;
static gh_status dummy_evaluate(void *self, const double F[4], unsigned want, double P[4], double A[16]) {
  dummy *d = self;
  if (F[0] == 7) return gh_fail(d->ctx, GH_DIVERGED, "seven");
  for (int k = 0; k < 4; k++) P[k] = 2 * F[k];
  for (int k = 0; (want & GH_WANT_TANGENT) && k < 16; k++) A[k] = k % 5 == 0 ? 2 : 0;
  return GH_OK;
}
static gh_status dummy_commit(void *self) {
  return ((dummy *)self)->log[0]++, GH_OK;
}
static gh_status dummy_revert(void *self) {
  return ((dummy *)self)->log[1]++, GH_OK;
}
static void dummy_destroy(void *self) {
  ((dummy *)self)->log[2]++;
}

/* A farm hands each point its F, names the one that fails, and frees what it took over, also when it cannot
 * be made. */
static void a_farm_of_anything(void **state) {
  static const gh_point_ops ops = {dummy_evaluate, dummy_commit, dummy_revert, dummy_destroy, NULL};
  gh_context *ctx = *state;
  int log[3] = {0};
  dummy d = {ctx, log};
  void *points[3] = {&d, &d, &d};
  gh_farm *farm;
  double F[12] = {1, 2, 3, 4, 5, 6, -7, 8, 9, 10, 11, 12}, P[12], A[48];
  OK(gh_farm_create(ctx, 3, &ops, points, &farm));
  assert_int_equal(gh_farm_size(farm), 3);
  OK(gh_farm_evaluate(farm, F, GH_WANT_TANGENT, P, A));
  for (int k = 0; k < 12; k++) assert_true(P[k] == 2 * F[k]);
  assert_true(A[32] == 2 && A[47] == 2);
  OK(gh_farm_evaluate(farm, F, 0, P, NULL));
  F[8] = 7;
  FAILS(gh_farm_evaluate(farm, F, 0, P, NULL), GH_DIVERGED, "integration point 2: seven");
  OK(gh_farm_commit(farm));
  OK(gh_farm_revert(farm));
  assert_true(log[0] == 3 && log[1] == 3 && log[2] == 0);
  gh_rve_view view;
  FAILS(gh_farm_look(farm, 0, &view), GH_INPUT, "no RVE to inspect");
  assert_null(gh_farm_measure(farm, 0));
  gh_farm_destroy(&farm);
  assert_null(farm);
  assert_int_equal(log[2], 3);
  FAILS(gh_farm_create(ctx, 0, &ops, points, &farm), GH_INPUT, "at least one point");
  assert_null(farm);
}

static bool stop_at_three(void *data) {
  return ++*(int *)data == 3;
}

/* A request to stop ends an evaluation before the next point with a status of its own; without it all
 * continues
 * . */
static void a_farm_is_stopped(void **state) {
  static const gh_point_ops ops = {dummy_evaluate, dummy_commit, dummy_revert, dummy_destroy, NULL};
  gh_context *ctx = *state;
  int log[3] = {0}, asked = 0;
  dummy d = {ctx, log};
  void *points[4] = {&d, &d, &d, &d};
  gh_farm *farm;
  double F[16], P[16];
  for (int k = 0; k < 16; k++) F[k] = k + 1, P[k] = -1;
  OK(gh_farm_create(ctx, 4, &ops, points, &farm));
  gh_farm_set_stop(farm, stop_at_three, &asked);
  FAILS(gh_farm_evaluate(farm, F, 0, P, NULL), GH_STOPPED, "stopped on request");
  assert_int_equal(asked, 3);
  assert_true(P[7] == 16 && P[8] == -1);
  gh_farm_set_stop(farm, NULL, NULL);
  OK(gh_farm_evaluate(farm, F, 0, P, NULL));
  assert_int_equal(asked, 3);
  assert_true(P[15] == 32);
  gh_farm_destroy(&farm);
}

/* The points of a farm of RVEs are RVEs of their own: each answers as it would alone, and is committed alone.
 */
static void a_farm_of_rves(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  FOR_ENGINES(e) {
    gh_rve_options o = rve_options(e, GH_PERIODIC, 100, 1e-10);
    gh_farm *farm;
    double F[12], P[12], A[48], alone[4], tangent[16];
    OK(gh_farm_create_rves(ctx, 3, p, &o, &farm));
    for (int step = 1; step <= 2; step++) {
      for (int n = 0; n < 12; n++) F[n] = I[n % 4] + step * (n / 4) * (squeeze[n % 4] - I[n % 4]) / 4;
      OK(gh_farm_evaluate(farm, F, GH_WANT_TANGENT, P, A));
      OK(gh_farm_commit(farm));
    }
    gh_rve *rve = make_rve(ctx, p, e, GH_PERIODIC, 100, 1e-10);
    for (int step = 1; step <= 2; step++) {
      for (int n = 8; n < 12; n++) F[n] = I[n % 4] + step * 2 * (squeeze[n % 4] - I[n % 4]) / 4;
      OK(gh_rve_evaluate(rve, F + 8, GH_WANT_TANGENT, alone, tangent));
      OK(gh_rve_commit(rve));
    }
    assert_memory_equal(alone, P + 8, sizeof alone);
    assert_memory_equal(tangent, A + 32, sizeof tangent);
    assert_true(gh_farm_measure(farm, 2)->P[0] == alone[0] && gh_farm_measure(farm, 3) == NULL &&
                gh_farm_measure(farm, -1) == NULL);
    gh_rve_cost cost;
    gh_farm_costs(farm, &cost);
    assert_true(cost.evaluations >= 6 && cost.steps > 0 && cost.total > 0);
    F[5] = NAN;
    FAILS(gh_farm_evaluate(farm, F, 0, P, NULL), GH_INPUT, "integration point 1: F = [");
    gh_rve_destroy(&rve);
    gh_farm_destroy(&farm);
  }
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(a_farm_of_anything), TEST(a_farm_is_stopped), TEST(a_farm_of_rves)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
