/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One RVE along a path: substeps, their balance, trial states nearby, limit cycles of the relaxation. */
#include "../help.h"

static const double I[4] = {1, 0, 0, 1}, squeeze[4] = {0.99, 0.004, 0.002, 0.995};

#define FOR_ENGINES(e)                                                                                       \
  for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)                                      \
    if (use_engine(e))

/* F of the substeps of a path, as they are reported. */
typedef struct told {
  int n;
  double F[128][4];
} told;
static void note_part(void *data, const gh_rve_measures *m) {
  told *t = data;
  assert_true(t->n < 128);
  memcpy(t->F[t->n++], m->F, sizeof m->F);
}

/* The same parts one after the other give the same bits; the last one is the trial state. */
static void is_that_path(gh_context *ctx, const gh_packing *p, const gh_rve_way *way, const told *t,
                         gh_rve *rve) {
  gh_rve *other = make_rve(ctx, p, GH_ENGINE_NATIVE, GH_PERIODIC, 100, 1e-8);
  double P[4];
  assert_int_equal(t->n, way->parts);
  assert_memory_equal(t->F[t->n - 1], way->to, sizeof way->to);
  for (int k = 0; k < t->n; k++) {
    OK(gh_rve_evaluate(other, t->F[k], 0, P, NULL));
    if (k < t->n - 1) OK(gh_rve_commit(other));
  }
  assert_memory_equal(P, gh_rve_measure(rve)->P, sizeof P);
  assert_memory_equal(gh_rve_F(other), gh_rve_F(rve), 4 * sizeof(double));
  gh_rve_destroy(&other);
}

static void ways_in_parts(void **state) {
  gh_context *ctx = *state;
  gh_packing *p;
  int found = 0;
  OK(gh_packing_read(ctx, "scenes/block/sand150.data", &p));
  for (long most = 100; most < 10000; most += most / 20) { /* from none in equilibrium to all at once */
    gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, 100, 1e-8);
    gh_rve *rve;
    told t = {0};
    gh_rve_way way = {.from = {1, 0, 0, 1}, .to = {0.85, 0, 0, 1}, .count = note_part, .data = &t};
    o.max_steps = most;
    OK(gh_rve_create(ctx, p, &o, &rve));
    gh_status status = gh_rve_reach(rve, &way, NULL);
    if (status == GH_OK) is_that_path(ctx, p, &way, &t, rve);
    else assert_int_equal(status, GH_DIVERGED);
    if (status == GH_OK) assert_true(way.cuts > 0 ? way.parts > 1 : way.parts == 1);
    else assert_int_equal(t.n, way.parts);
    if (status != GH_OK && way.parts > 0) { /* it stays where it has come to */
      assert_memory_equal(gh_rve_F(rve), t.F[t.n - 1], 4 * sizeof(double));
      assert_non_null(strstr(gh_message(ctx), " substeps of the increment: no equilibrium"));
    }
    found |= status == GH_OK ? (way.cuts > 0 ? 2 : 4) : way.parts > 0 ? 8 : 1;
    gh_rve_destroy(&rve);
  }
  assert_int_equal(found & 7, 7); /* each of them was met */
  gh_packing_destroy(&p);
}

/* A linear spring of stiffness 3 in F11 that also dissipates 0.2 a part: the trapezoidal rule is exact, so
 * the balance holds but for what is taken away at the last part. */
static void balances(void **state) {
  (void)state;
  gh_rve_balance b = {0};
  gh_rve_measures m = {0};
  const double residual[3] = {1e-9, 4e-9, 2e-9};
  assert_true(gh_rve_balance_defect(&b) == 0);
  for (int k = 0; k < 3; k++) {
    const double e = 0.5 + k; /* stretched before the first part */
    m.F[0] = 1 + e, m.P[0] = 3 * e + 0.2, m.energy = 1.5 * e * e, m.dissipation = 7 + 0.2 * k;
    m.residual = residual[k];
    gh_rve_balance_add(&b, &m);
  }
  NEAR("work", b.work, 1.5 * (2.5 * 2.5 - 0.5 * 0.5) + 0.4, 1e-15);
  NEAR("held", b.held, b.work, 1e-14);
  assert_true(b.residual == 4e-9 && fabs(gh_rve_balance_defect(&b)) < 1e-14);
  m.energy -= 0.94; /* and F stays where it is */
  gh_rve_balance_add(&b, &m);
  NEAR("defect", gh_rve_balance_defect(&b), 0.94 / 9.4, 1e-14);
}

/* The limits of docs/explanation/method.md: a thousand tolerances, and with friction a tenth of the change as
 * well. */
static void branches(void **state) {
  (void)state;
  const gh_contact_law smooth = {.normal_stiffness = 1}, rough = {.normal_stiffness = 1, .friction = 1};
  assert_true(gh_is_branch(&smooth, 1e-8, 2.01e-5, 1, 2));
  assert_false(gh_is_branch(&smooth, 1e-8, 1.99e-5, 1e-9, 2));
  assert_true(gh_is_branch(&rough, 1e-8, 0.11, 1, 2));
  assert_false(gh_is_branch(&rough, 1e-8, 0.09, 1, 2));
  assert_false(gh_is_branch(&rough, 1e-8, 1.99e-5, 1e-9, 2));
}

/* Halvings are asked for; where nothing moves there is nothing to cut. */
static void ways_in_halves(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  gh_rve *rve = make_rve(ctx, p, GH_ENGINE_NATIVE, GH_PERIODIC, 100, 1e-8);
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, 100, 1e-8);
  told t = {0};
  gh_rve_way way = {
      .from = {1, 0, 0, 1}, .halvings = 2, .want = GH_WANT_TANGENT, .count = note_part, .data = &t};
  double A[16] = {0}, B[16], P[4];
  memcpy(way.to, squeeze, sizeof way.to);
  OK(gh_rve_reach(rve, &way, A));
  assert_true(way.parts == 4 && way.cuts == 0);
  for (int k = 0; k < 4; k++) NEAR("F of the second part", t.F[1][k], (way.from[k] + squeeze[k]) / 2, 1e-15);
  is_that_path(ctx, p, &way, &t, rve);
  OK(gh_rve_evaluate(rve, squeeze, GH_WANT_TANGENT, P, B));
  assert_memory_equal(A, B, sizeof A);
  gh_rve_destroy(&rve);
  o.max_steps = 3, o.relaxation = GH_RELAX_DAMPED;
  OK(gh_rve_create(ctx, p, &o, &rve));
  way = (gh_rve_way){0};
  memcpy(way.from, squeeze, sizeof way.from);
  memcpy(way.to, squeeze, sizeof way.to);
  FAILS(gh_rve_reach(rve, &way, NULL), GH_DIVERGED, "no equilibrium within 3 relaxation steps");
  assert_true(way.parts == 0 && way.cuts == 0);
  memcpy(way.from, I, sizeof way.from);
  FAILS(gh_rve_reach(rve, &way, NULL), GH_DIVERGED, "no equilibrium within 3 relaxation steps");
  assert_int_equal(way.cuts, GH_WAY_CUTS);
  gh_rve_destroy(&rve);
  gh_packing_destroy(&p);
}

/* From a trial state that is near, the same equilibrium is found with hardly a step; from one that is not,
 * and under Taylor's conditions, the converged state is the start. What is committed counts from the
 * converged state in all cases. */
static void near_a_trial_state(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  const double F[4] = {0.97, 0.02, 0.01, 0.99}, G[4] = {0.9701, 0.0199, 0.01, 0.99}, far[4] = {0.96, 0, 0, 1};
  FOR_ENGINES(e) {
    gh_rve_options o = rve_options(e, GH_PERIODIC, 100, 1e-10);
    o.integration = GH_INTEGRATION_WHOLE; /* else slip counts from elsewhere */
    o.law = (gh_contact_law){
        .normal_stiffness = 100, .friction = 1, .tangential_stiffness = 60, .friction_coefficient = 0.4};
    gh_rve *rve, *taylor;
    double P[4], Q[4], *near;
    OK(gh_rve_create(ctx, p, &o, &rve));
    o.boundary = GH_TAYLOR;
    OK(gh_rve_create(ctx, p, &o, &taylor));
    OK(gh_rve_evaluate(rve, G, 0, P, NULL));
    const size_t size = gh_rve_trial_size(rve);
    OK(gh_alloc(ctx, size, sizeof *near, &near));
    OK(gh_rve_save_trial(rve, near));
    OK(gh_rve_evaluate_near(rve, G, near, size, 0, Q, NULL));
    assert_in_range(gh_rve_measure(rve)->steps, 1, 3);
    for (int k = 0; k < 4; k++) NEAR("P where it was", Q[k], P[k], 1e-9);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    const long steps = gh_rve_measure(rve)->steps;
    const double dissipation = gh_rve_measure(rve)->dissipation;
    OK(gh_rve_evaluate_near(rve, F, near, size, 0, Q, NULL));
    for (int k = 0; k < 4; k++) NEAR("P nearby", Q[k], P[k], 1e-8);
    assert_in_range(gh_rve_measure(rve)->steps, 1, steps - 1);
    NEAR("dissipation", gh_rve_measure(rve)->dissipation, dissipation, 1e-9);
    OK(gh_rve_evaluate(rve, far, 0, P, NULL));
    OK(gh_rve_evaluate_near(rve, far, near, size, 0, Q, NULL));
    assert_memory_equal(P, Q, sizeof P);
    FAILS(gh_rve_evaluate_near(rve, F, near, size - 1, 0, Q, NULL), GH_INPUT, "does not fit this packing");
    OK(gh_rve_evaluate(taylor, G, 0, P, NULL));
    double *own;
    const size_t own_size = gh_rve_trial_size(taylor);
    OK(gh_alloc(ctx, own_size, sizeof *own, &own));
    OK(gh_rve_save_trial(taylor, own));
    OK(gh_rve_evaluate(taylor, F, 0, P, NULL));
    OK(gh_rve_evaluate_near(taylor, F, own, own_size, 0, Q, NULL));
    assert_memory_equal(P, Q, sizeof P);
    free(own);
    free(near);
    gh_rve_destroy(&rve);
    gh_rve_destroy(&taylor);
  }
  gh_packing_destroy(&p);
}

/* At the end of a ramp contacts at their limit either slide on or stick, by the direction: the tangent in which all
 * slide is near. A little farther in the direction of the increment it is the derivative. */
static void tangent_behind_ramp(gh_context *ctx, gh_rve *rve, const double F[4], const double P[4],
                                const double A[16], const double *near, size_t size) {
  const double far = 1e-5, h = 1e-8;
  double G[4] = {F[0], F[1] + h, F[2], F[3]}, up[4], down[4], B[16];
  OK(gh_rve_evaluate_near(rve, G, near, size, 0, up, NULL));
  for (int k = 0; k < 4; k++) NEAR("forward", A[4 * k + 1], (up[k] - P[k]) / h, 0.05 * norm(A, 16));
  G[1] = F[1] + far;
  OK(gh_rve_evaluate_near(rve, G, near, size, GH_WANT_TANGENT, down, B));
  assert_int_equal(gh_rve_measure(rve)->ramps, 0);
  for (int c = 0; c < 4; c++) {
    const double at = G[c];
    G[c] = at + h;
    OK(gh_rve_evaluate_near(rve, G, near, size, 0, up, NULL));
    G[c] = at - h;
    OK(gh_rve_evaluate_near(rve, G, near, size, 0, down, NULL));
    G[c] = at;
    for (int k = 0; k < 4; k++)
      NEAR("derivative", B[4 * k + c], (up[k] - down[k]) / (2 * h), 1e-3 * norm(B, 16));
  }
}

/* Shear of 20 grains until slip has no equilibrium over an increment: a ramp leads to one, the same each time. A
 * trial nearby counts slip from there, and the tangent, in which contacts at their limit slide, is its
 * derivative. Committed, it is a state like others. So it is with proportional hardening. */
static void ramp_to_rest(void **state) {
  enum { STEPS = 400 };
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  FOR_ENGINES(e) for (int hardens = 0; hardens < 2; hardens++) {
    gh_rve_options o = rve_options(e, GH_PERIODIC, 1, 1e-11);
    o.law = (gh_contact_law){.normal_stiffness = 1,
                             .friction = 1,
                             .tangential_stiffness = 0.8,
                             .friction_coefficient = tan(17.5 * help_pi / 180),
                             .hardening = hardens ? 0.5 : 0,
                             .hardening_law = GH_HARDENING_PROPORTIONAL};
    gh_rve *rve;
    const gh_rve_measures *m;
    double F[4] = {0.97, 0, 0, 0.97}, P[4], Q[4], A[16], *near;
    OK(gh_rve_create(ctx, p, &o, &rve));
    m = gh_rve_measure(rve);
    for (int k = 1; k <= STEPS && !m->settled; k++) {
      OK(gh_rve_commit(rve));
      F[1] = 2.0 * k / STEPS;
      OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
    }
    assert_true(m->settled >= 1);
    assert_true(m->ramps >= 1 && m->residual <= 1e-11);
    const double dissipation = m->dissipation;
    OK(gh_rve_evaluate(rve, F, 0, Q, NULL));
    assert_memory_equal(P, Q, sizeof P);
    const size_t size = gh_rve_trial_size(rve);
    OK(gh_alloc(ctx, size, sizeof *near, &near));
    OK(gh_rve_save_trial(rve, near));
    OK(gh_rve_evaluate_near(rve, F, near, size, 0, Q, NULL));
    assert_in_range(m->steps, 1, 3);
    assert_int_equal(m->ramps, 0);
    for (int k = 0; k < 4; k++) NEAR("P where it was", Q[k], P[k], 1e-9 * norm(P, 4));
    NEAR("dissipation", m->dissipation, dissipation, 1e-9 * dissipation);
    tangent_behind_ramp(ctx, rve, F, P, A, near, size);
    FAILS(gh_rve_evaluate_near(rve, F, near, size - 7, 0, Q, NULL), GH_INPUT, "does not fit this packing");
    OK(gh_rve_load(rve, near, size));
    assert_true(gh_rve_state_size(rve) < size);
    OK(gh_rve_evaluate(rve, F, 0, Q, NULL));
    assert_int_equal(m->ramps, 0);
    assert_true(m->dissipation >= dissipation * (1 - 1e-12) && m->dissipation < 1.01 * dissipation);
    free(near);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(ways_in_parts),  TEST(balances),           TEST(branches),
                                     TEST(ways_in_halves), TEST(near_a_trial_state), TEST(ramp_to_rest)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
