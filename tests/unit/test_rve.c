/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One RVE: what it promises to those who call. */
#include "../help.h"

static const double I[4] = {1, 0, 0, 1}, squeeze[4] = {0.99, 0.004, 0.002, 0.995};

#define FOR_ENGINES(e)                                                                                       \
  for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)                                      \
    if (use_engine(e))
#define FOR_BOUNDARIES(b) for (const gh_boundary *b = all_boundaries; b < all_boundaries + 4; b++)

/* Words and boundary conditions belong together, both ways; other words are refused. */
static void boundary_names(void **state) {
  (void)state;
  static const char *const names[] = {"taylor", "taylor-cell", "restricted", "periodic"};
  for (int k = 0; k < 4; k++) {
    gh_boundary b;
    assert_string_equal(gh_boundary_name(all_boundaries[k]), names[k]);
    assert_true(gh_boundary_from_name(names[k], &b) && b == all_boundaries[k]);
  }
  gh_boundary b;
  assert_false(gh_boundary_from_name("Taylor", &b) || gh_boundary_from_name("", &b) ||
               gh_boundary_from_name("tractions", &b));
}

/* Options out of range are refused, with the value. */
static void bad_options_are_refused(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  gh_rve *rve;
  gh_rve_options good = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, 100, 1e-8), o = good;
  const double bad[] = {0, -1, NAN, 1, INFINITY};
  for (int k = 0; k < 5; k++) {
    o = good, o.tolerance = bad[k];
    FAILS(gh_rve_create(ctx, p, &o, &rve), GH_INPUT, "tolerance");
    o = good, o.law.normal_stiffness = bad[k];
    if (bad[k] != 1) FAILS(gh_rve_create(ctx, p, &o, &rve), GH_INPUT, "normal stiffness");
  }
  o = good, o.max_steps = -1;
  FAILS(gh_rve_create(ctx, p, &o, &rve), GH_INPUT, "-1");
  assert_null(rve);
  gh_rve_destroy(&rve);
  gh_packing_destroy(&p);
}

/* F with det F <= 0 or with a value that is not finite is GH_INPUT, and the RVE continues as if it had not
 * been asked. */
static void bad_deformations_are_refused(void **state) {
  gh_context *ctx = *state;
  static const double bad[][4] = {{1, 0, 0, 0},   {-1, 0, 0, 1},       {0, 1, 1, 0},   {NAN, 0, 0, 1},
                                  {1, NAN, 0, 1}, {1, 0, INFINITY, 1}, {1, 2, 0.5, 1}, {1e200, 0, 0, 1e200}};
  gh_packing *p = case_packing(ctx, "p20");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve *rve = make_rve(ctx, p, e, *b, 100, 1e-10);
    double P[4], again[4];
    OK(gh_rve_evaluate(rve, squeeze, 0, P, NULL));
    for (int k = 0; k < 8; k++) {
      FAILS(gh_rve_evaluate(rve, bad[k], 0, again, NULL), GH_INPUT, "F = [");
      OK(gh_rve_commit(rve)); /* no trial state: nothing to commit */
    }
    OK(gh_rve_evaluate(rve, squeeze, 0, again, NULL));
    assert_memory_equal(P, again, sizeof P);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* The answer does not depend on evaluations that were not committed, to the last bit; nor does an empty
 * revert. */
static void trials_leave_no_trace(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  static const double others[][4] = {
      {0.97, 0, 0, 0.97}, {1.2, 0, 0, 1.2}, {1, 0.05, 0, 0.98}, {0.9, 0, 0, 0.99}};
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve *a = make_rve(ctx, p, e, *b, 100, 1e-10), *c = make_rve(ctx, p, e, *b, 100, 1e-10);
    for (int step = 1; step <= 3; step++) {
      double F[4], Pa[4], Aa[16], Pc[4], Ac[16], P[4], A[16];
      for (int k = 0; k < 4; k++) F[k] = I[k] + step * (squeeze[k] - I[k]) / 3;
      for (int k = 0; k < 4; k++) OK(gh_rve_evaluate(a, others[k], k % 2 ? GH_WANT_TANGENT : 0, P, A));
      if (step == 2) OK(gh_rve_revert(a));
      OK(gh_rve_evaluate(a, F, GH_WANT_TANGENT, Pa, Aa));
      OK(gh_rve_evaluate(c, F, GH_WANT_TANGENT, Pc, Ac));
      assert_memory_equal(Pa, Pc, sizeof Pa);
      assert_memory_equal(Aa, Ac, sizeof Aa);
      assert_true(gh_rve_measure(a)->energy == gh_rve_measure(c)->energy);
      OK(gh_rve_commit(a));
      OK(gh_rve_commit(c));
    }
    gh_rve_destroy(&a);
    gh_rve_destroy(&c);
  }
  gh_packing_destroy(&p);
}

/* A state that was dropped is not committed afterwards; a second commit changes nothing; committing moves
 * state n. */
static void commit_and_revert(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve *rve = make_rve(ctx, p, e, *b, 100, 1e-10);
    size_t n = gh_rve_state_size(rve), bytes = n * sizeof(double);
    double *zero, *now, P[4];
    OK(gh_alloc(ctx, n, sizeof(double), &zero));
    OK(gh_alloc(ctx, n, sizeof(double), &now));
    OK(gh_rve_save(rve, zero));
    assert_memory_equal(zero, I, sizeof I);
    for (int i = 0; i < 2 * p->n; i++) assert_true(zero[4 + i] == p->x[i]);
    OK(gh_rve_evaluate(rve, squeeze, 0, P, NULL));
    OK(gh_rve_revert(rve));
    OK(gh_rve_commit(rve));
    OK(gh_rve_save(rve, now));
    assert_memory_equal(zero, now, bytes);
    OK(gh_rve_evaluate(rve, squeeze, 0, P, NULL));
    OK(gh_rve_save(rve, now));
    assert_memory_equal(zero, now, bytes); /* a trial state is not saved */
    OK(gh_rve_commit(rve));
    OK(gh_rve_save(rve, now));
    assert_memory_equal(now, squeeze, sizeof squeeze);
    bool moved = memcmp(now + 4, zero + 4, bytes - 4 * sizeof(double)) != 0;
    assert_int_equal(moved, *b == GH_RESTRICTED || *b == GH_PERIODIC);
    OK(gh_rve_commit(rve));
    OK(gh_rve_save(rve, zero));
    assert_memory_equal(zero, now, bytes);
    free(zero);
    free(now);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* An RVE that starts from a saved state continues bitwise like the one that saved it. */
static void a_loaded_state_goes_on_bitwise(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve *a = make_rve(ctx, p, e, *b, 100, 1e-10), *c = make_rve(ctx, p, e, *b, 100, 1e-10);
    double *kept, Pa[4], Pc[4], Aa[16], Ac[16];
    OK(gh_alloc(ctx, gh_rve_state_size(a), sizeof(double), &kept));
    for (int step = 1; step <= 4; step++) {
      double F[4];
      for (int k = 0; k < 4; k++) F[k] = I[k] + step * (squeeze[k] - I[k]) / 3;
      OK(gh_rve_evaluate(a, F, GH_WANT_TANGENT, Pa, Aa));
      if (step == 2) OK(gh_rve_load(c, kept, gh_rve_state_size(c)));
      if (step >= 2) {
        OK(gh_rve_evaluate(c, F, GH_WANT_TANGENT, Pc, Ac));
        assert_memory_equal(Pa, Pc, sizeof Pa);
        assert_memory_equal(Aa, Ac, sizeof Aa);
        OK(gh_rve_commit(c));
      }
      OK(gh_rve_commit(a));
      OK(gh_rve_save(a, kept));
    }
    kept[0] = -kept[0];
    FAILS(gh_rve_load(c, kept, gh_rve_state_size(c)), GH_INPUT, "det F <= 0");
    kept[0] = NAN;
    FAILS(gh_rve_load(c, kept, gh_rve_state_size(c)), GH_INPUT, "not finite");
    free(kept);
    gh_rve_destroy(&a);
    gh_rve_destroy(&c);
  }
  gh_packing_destroy(&p);
}

/* A state whose grains fluctuated is kept also where all grains follow F: it is not replaced by the reference
 * positions. */
static void a_loaded_state_survives_taylor(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  FOR_ENGINES(e) {
    gh_rve *rve = make_rve(ctx, p, e, GH_TAYLOR_CELL, 100, 1e-8);
    double kept[44], now[44], P[4];
    assert_int_equal(gh_rve_state_size(rve), 44);
    OK(gh_rve_save(rve, kept));
    for (int k = 4; k < 44; k++) kept[k] += 1e-3 * (k % 5);
    OK(gh_rve_load(rve, kept, gh_rve_state_size(rve)));
    OK(gh_rve_evaluate(rve, squeeze, 0, P, NULL));
    OK(gh_rve_commit(rve));
    OK(gh_rve_save(rve, now));
    assert_memory_equal(now + 4, kept + 4, 40 * sizeof(double));
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Grains that do not touch carry nothing: P = 0, A = 0, unjammed, no NaN. */
static void no_contact_is_a_valid_state(void **state) {
  gh_context *ctx = *state;
  double cell[4] = {10, 0, 0, 10}, radius[4] = {1, 0.5, 0.7, 1}, x[8] = {0.5, 0.5, 5, 5, 5, 8, 8, 4};
  for (int n = 1; n <= 4; n++) {
    gh_packing *p = make_packing(ctx, n, cell, radius, x);
    FOR_ENGINES(e) FOR_BOUNDARIES(b) {
      gh_rve *rve = make_rve(ctx, p, e, *b, 100, 1e-8);
      double P[4] = {9}, A[16] = {9}, B[4] = {9};
      OK(gh_rve_evaluate(rve, squeeze, GH_WANT_TANGENT, P, A));
      const gh_rve_measures *m = gh_rve_measure(rve);
      assert_true(norm(P, 4) == 0 && norm(A, 16) == 0 && norm(m->cauchy, 4) == 0);
      assert_true(m->unjammed == 1 && m->contacts == 0 && m->energy == 0 && m->residual == 0 &&
                  m->coordination == 0);
      OK(gh_rve_boundary_stress(rve, B));
      assert_true(norm(B, 4) == 0);
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
}

/* A packing that is pulled apart unjams, and carries again when it is pushed together. */
static void unjamming_and_coming_back(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  static const double path[] = {1, 0.995, 1.03, 1.06, 1.02, 0.985, 0.98};
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve *rve = make_rve(ctx, p, e, *b, 100, 1e-8);
    for (size_t k = 0; k < sizeof path / sizeof *path; k++) {
      double F[4] = {path[k], 0, 0, path[k]}, P[4], A[16];
      OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
      OK(gh_rve_commit(rve));
      const gh_rve_measures *m = gh_rve_measure(rve);
      assert_true(gh_finite(P, 4) && gh_finite(A, 16));
      if (k == 3) assert_true(m->unjammed && norm(P, 4) == 0 && norm(A, 16) == 0);
      if (k == 1 || k == 6) assert_true(!m->unjammed && P[0] < 0 && P[3] < 0 && A[0] > 0 && A[15] > 0);
      assert_true(m->residual <= 1e-8);
    }
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Coinciding centres end in a message, not in NaN. */
static void coinciding_centres_are_told(void **state) {
  gh_context *ctx = *state;
  double cell[4] = {4, 0, 0, 4}, radius[3] = {1, 1, 1}, x[6] = {1, 1, 3, 3, 1, 1}, P[4];
  gh_packing *p = make_packing(ctx, 3, cell, radius, x);
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve_options o = rve_options(e, *b, 100, 1e-8);
    gh_rve *rve;
    gh_status s = gh_rve_create(ctx, p, &o, &rve);
    if (s == GH_OK) s = gh_rve_evaluate(rve, I, 0, P, NULL);
    assert_true(s == GH_DIVERGED || s == GH_ENGINE || s == GH_INPUT);
    if (!strstr(gh_message(ctx), "coincide")) fail_msg("%s", gh_message(ctx));
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* One to four grains, which touch their own images and each other several times: equilibrium is found and its
 * stress is symmetric.
 */
static void small_packings_relax(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 21;
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < 40; trial++) {
    int n = 1 + trial % 4;
    double cell[4] = {1, uniform(&seed) - 0.5, 0, 1}, radius[4], x[8], f[2];
    for (int i = 0; i < n; i++) {
      radius[i] = (n == 1 ? 0.5 : 0.25) * (1.01 + 0.08 * uniform(&seed));
      f[0] = i % 2 * 0.5 + 0.04 * uniform(&seed), f[1] = i / 2 * 0.5 + 0.04 * uniform(&seed);
      gh_apply2(cell, f, &x[2 * i]);
    }
    gh_packing *p = make_packing(ctx, n, cell, radius, x);
    FOR_ENGINES(e) for (int b = 2; b < 4; b++) {
      gh_rve *rve = make_rve(ctx, p, e, all_boundaries[b], 100, 1e-8);
      double P[4], A[16];
      gh_status s = gh_rve_evaluate(rve, squeeze, GH_WANT_TANGENT, P, A);
      if (s != GH_OK)
        fail_msg("trial %d, %d grains, %s, %s: %s", trial, n, engine_names[e],
                 gh_boundary_name(all_boundaries[b]), gh_message(ctx));
      const gh_rve_measures *m = gh_rve_measure(rve);
      NEAR("symmetry", m->cauchy[1], m->cauchy[2], 1e-10 * (norm(m->cauchy, 4) + 1e-3));
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
}

/* Stress scales with the stiffness and does not depend on the unit of length, over twelve and more orders. */
static void scaling(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P0[4], A0[16], P[4], A[16];
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-12);
    OK(gh_rve_evaluate(rve, squeeze, GH_WANT_TANGENT, P0, A0));
    gh_rve_destroy(&rve);
    static const double stiffness[] = {1e-6, 1e-3, 50, 1e6, 1e12}, unit[] = {1e-6, 1e-3, 25.4, 1e3, 1e6};
    for (int k = 0; k < 5; k++) {
      rve = make_rve(ctx, p, e, *b, stiffness[k], 1e-12);
      OK(gh_rve_evaluate(rve, squeeze, GH_WANT_TANGENT, P, A));
      for (int c = 0; c < 4; c++) NEAR("P over E", P[c] / stiffness[k], P0[c], 1e-9 * norm(P0, 4));
      for (int c = 0; c < 16; c++) NEAR("A over E", A[c] / stiffness[k], A0[c], 1e-8 * norm(A0, 16));
      gh_rve_destroy(&rve);
      gh_packing *q;
      OK(gh_packing_copy(ctx, p, &q));
      for (int i = 0; i < q->n; i++)
        q->radius[i] *= unit[k], q->x[2 * i] *= unit[k], q->x[2 * i + 1] *= unit[k];
      for (int c = 0; c < 4; c++) q->cell[c] *= unit[k];
      q->low[0] *= unit[k], q->low[1] *= unit[k];
      rve = make_rve(ctx, q, e, *b, 1, 1e-12);
      OK(gh_rve_evaluate(rve, squeeze, GH_WANT_TANGENT, P, A));
      NEAR("P in another unit", distance(P, P0, 4), 0, 1e-9 * norm(P0, 4));
      NEAR("A in another unit", distance(A, A0, 16), 0, 1e-8 * norm(A0, 16));
      gh_rve_destroy(&rve);
      gh_packing_destroy(&q);
    }
  }
  gh_packing_destroy(&p);
}

/* Too few steps are GH_DIVERGED, with the residual that was reached; state n stays. */
static void too_few_steps(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) {
    gh_rve_options o = rve_options(e, GH_PERIODIC, 100, 1e-8);
    gh_rve *rve;
    double P[4], before[104], after[104];
    o.max_steps = 3;
    OK(gh_rve_create(ctx, p, &o, &rve));
    OK(gh_rve_save(rve, before));
    FAILS(gh_rve_evaluate(rve, squeeze, 0, P, NULL), GH_DIVERGED, "no equilibrium within 3 relaxation steps");
    OK(gh_rve_commit(rve));
    OK(gh_rve_save(rve, after));
    assert_memory_equal(before, after, sizeof before);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* When the steps are spent, a packing is accepted unconverged, if an unbalanced force is allowed. */
static void taken_as_it_is(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) for (int friction = 0; friction < 2; friction++) {
    gh_rve_options o = rve_options(e, GH_PERIODIC, 100, 1e-10);
    gh_rve *rve;
    double P[4], A[16];
    if (friction)
      o.law = (gh_contact_law){
          .normal_stiffness = 100, .friction = 1, .tangential_stiffness = 60, .friction_coefficient = 0.4};
    o.integration = GH_INTEGRATION_WHOLE; /* Newton ends a ramp's last part sooner */
    o.max_steps = 20;
    o.accept = 1e-9;
    OK(gh_rve_create(ctx, p, &o, &rve));
    FAILS(gh_rve_evaluate(rve, squeeze, 0, P, NULL), GH_DIVERGED, "no equilibrium within 20");
    gh_rve_destroy(&rve);
    o.accept = 10;
    OK(gh_rve_create(ctx, p, &o, &rve));
    OK(gh_rve_evaluate(rve, squeeze, GH_WANT_TANGENT, P, A));
    const gh_rve_measures *m = gh_rve_measure(rve);
    assert_int_equal(m->accepted, 1);
    assert_true(m->residual > 1e-10 && m->residual * m->mean_force <= 10);
    gh_rve_destroy(&rve);
    o.max_steps = 0;
    OK(gh_rve_create(ctx, p, &o, &rve));
    OK(gh_rve_evaluate(rve, squeeze, 0, P, NULL));
    assert_int_equal(gh_rve_measure(rve)->accepted, 0);
    assert_true(gh_rve_measure(rve)->residual <= 1e-10);
    gh_rve_destroy(&rve);
    o.accept = -1;
    FAILS(gh_rve_create(ctx, p, &o, &rve), GH_INPUT, "0 or more, not -1");
  }
  gh_packing_destroy(&p);
}

/* What one sees of an RVE adds up to its stress: (1/V) sum f (x) F^-1 l over the contacts, positions and
 * flags in order. */
static void looking_at_an_rve(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve *rve = make_rve(ctx, p, e, *b, 100, 1e-10);
    gh_rve_view v;
    double P[4], sum[4] = {0}, inverse[4], cell[4];
    OK(gh_rve_evaluate(rve, squeeze, 0, P, NULL));
    OK(gh_rve_look(rve, &v));
    bool cluster = *b == GH_TAYLOR || *b == GH_RESTRICTED;
    assert_int_equal(v.n, cluster ? 65 : 50); /* test_packing counts the 15 replicas */
    assert_int_equal(v.periodic, !cluster);
    gh_mul2(squeeze, p->cell, cell);
    NEAR("cell", distance(cell, v.cell, 4), 0, 1e-15);
    gh_inv2(squeeze, inverse);
    int rattlers = 0;
    for (int c = 0; c < v.ncontacts; c++) {
      double m[2];
      gh_apply2(inverse, v.contacts[c].l, m);
      for (int k = 0; k < 4; k++) sum[k] += v.contacts[c].f[k / 2] * m[k % 2] / gh_det2(p->cell);
    }
    NEAR("stress", distance(sum, P, 4), 0, 1e-13 * norm(P, 4));
    for (int i = 0; i < v.n; i++) {
      assert_true(v.radius[i] == p->radius[v.grain[i]] && v.id[i] == p->id[v.grain[i]] && v.type[i] == 1);
      assert_int_equal(v.flags[i] >> 2 & 1, i >= 50);
      if (*b == GH_PERIODIC) assert_int_equal(v.flags[i] >> 1 & 1, 0);
      if (*b == GH_TAYLOR || *b == GH_TAYLOR_CELL || i >= 50) assert_int_equal(v.flags[i] >> 1 & 1, 1);
      rattlers += v.flags[i] & 1;
    }
    assert_int_equal(rattlers, gh_rve_measure(rve)->rattlers);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(boundary_names),
                                     TEST(bad_options_are_refused),
                                     TEST(bad_deformations_are_refused),
                                     TEST(trials_leave_no_trace),
                                     TEST(commit_and_revert),
                                     TEST(a_loaded_state_goes_on_bitwise),
                                     TEST(a_loaded_state_survives_taylor),
                                     TEST(no_contact_is_a_valid_state),
                                     TEST(unjamming_and_coming_back),
                                     TEST(coinciding_centres_are_told),
                                     TEST(small_packings_relax),
                                     TEST(scaling),
                                     TEST(too_few_steps),
                                     TEST(taken_as_it_is),
                                     TEST(looking_at_an_rve)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
