/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The library as a material law: states of many points through one workspace, and two threads with the native
 * engine. */
#include "../help.h"

#include <pthread.h>

enum { STEPS = 6 };

typedef struct result {
  double P[4], A[16];
} result;

static void path(int point, int k, double F[4]) {
  F[0] = 1 - 2e-4 * k, F[1] = 1e-4 * k * (1 - point), F[2] = 0, F[3] = 1 + 1e-4 * k * (point - 1);
}

static gh_contact_law law(bool friction) {
  return (gh_contact_law){.normal_stiffness = 1000,
                          .friction = friction,
                          .tangential_stiffness = 800,
                          .friction_coefficient = 0.3};
}

/* A path in an RVE of its own. */
static gh_status alone(gh_context *ctx, const gh_packing *p, gh_engine_kind engine, bool friction, int point,
                       result out[STEPS]) {
  gh_rve_options o = gh_rve_defaults();
  gh_rve *rve;
  o.engine = engine, o.law = law(friction), o.tolerance = 1e-9;
  gh_status status = gh_rve_create(ctx, p, &o, &rve);
  for (int k = 0; k < STEPS && status == GH_OK; k++) {
    double F[4];
    path(point, k, F);
    status = gh_rve_evaluate(rve, F, GH_WANT_TANGENT, out[k].P, out[k].A);
    if (status == GH_OK) status = gh_rve_commit(rve);
  }
  gh_rve_destroy(&rve);
  return status;
}

/* Three points, whose states go in and out of one RVE at each step, with a trial in between that is dropped.
 */
static void shared(gh_context *ctx, const gh_packing *p, bool friction, result out[3][STEPS]) {
  gh_rve_options o = gh_rve_defaults();
  gh_rve *rve;
  double *state[3];
  size_t size[3];
  o.engine = GH_ENGINE_NATIVE, o.law = law(friction), o.tolerance = 1e-9;
  OK(gh_rve_create(ctx, p, &o, &rve));
  for (int c = 0; c < 3; c++) {
    size[c] = gh_rve_state_size(rve);
    state[c] = malloc(size[c] * sizeof **state);
    OK(gh_rve_save(rve, state[c]));
  }
  for (int k = 0; k < STEPS; k++)
    for (int c = 0; c < 3; c++) {
      double F[4], far[4], P[4];
      path(c, k, F);
      path(c, k + 3, far);
      OK(gh_rve_load(rve, state[c], size[c]));
      OK(gh_rve_evaluate(rve, far, 0, P, NULL));
      OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, out[c][k].P, out[c][k].A));
      size[c] = gh_rve_trial_size(rve);
      free(state[c]);
      state[c] = malloc(size[c] * sizeof **state);
      OK(gh_rve_save_trial(rve, state[c]));
    }
  for (int c = 0; c < 3; c++) free(state[c]);
  gh_rve_destroy(&rve);
}

static void test_workspace(void **state) {
  gh_context *ctx = *state;
  if (!use_engine(GH_ENGINE_NATIVE)) return;
  gh_packing *p = case_packing(ctx, "p50");
  for (int friction = 0; friction < 2; friction++) {
    result one[STEPS], all[3][STEPS];
    shared(ctx, p, friction, all);
    for (int c = 0; c < 3; c++) {
      OK(alone(ctx, p, GH_ENGINE_NATIVE, friction, c, one));
      for (int k = 0; k < STEPS; k++) assert_memory_equal(&one[k], &all[c][k], sizeof one[k]);
    }
  }
  gh_packing_destroy(&p);
}

/* ---- threads ---- */

typedef struct job {
  int point;
  gh_status status;
  char message[256];
  result out[STEPS];
} job;

/* Everything of its own, from the context on. */
static void *work(void *data) {
  job *j = data;
  gh_context *ctx;
  gh_packing *p = NULL;
  j->status = gh_context_create(&ctx);
  if (j->status != GH_OK) return NULL;
  j->status = gh_packing_read(ctx, "tests/data/cases/packings/p150.data", &p);
  if (j->status == GH_OK) j->status = alone(ctx, p, GH_ENGINE_NATIVE, false, j->point, j->out);
  snprintf(j->message, sizeof j->message, "%s", gh_message(ctx));
  gh_packing_destroy(&p);
  gh_context_destroy(&ctx);
  return NULL;
}

static void test_threads(void **state) {
  (void)state;
  enum { THREADS = 3 };
  pthread_t thread[THREADS];
  static job at_once[THREADS], in_turn[THREADS];
  if (!use_engine(GH_ENGINE_NATIVE)) return;
  for (int k = 0; k < THREADS; k++) {
    at_once[k] = in_turn[k] = (job){.point = k};
    assert_int_equal(pthread_create(&thread[k], NULL, work, &at_once[k]), 0);
  }
  for (int k = 0; k < THREADS; k++) assert_int_equal(pthread_join(thread[k], NULL), 0);
  for (int k = 0; k < THREADS; k++) {
    work(&in_turn[k]);
    assert_string_equal(at_once[k].message, "");
    assert_int_equal(at_once[k].status, GH_OK);
    assert_memory_equal(at_once[k].out, in_turn[k].out, sizeof in_turn[k].out);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_workspace), TEST(test_threads)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
