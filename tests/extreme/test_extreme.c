/* SPDX-License-Identifier: GPL-2.0-or-later */
/* RVEs at the edges of what can be asked of them: scales, increments, rotations, wild deformations. */
#include "extreme_rve.h"

/* Stress and tangent grow with the stiffness, from 1e-6 to 1e14, and with nothing else. */
static void stiffness_scales(void **state) {
  static const double stiffness[] = {1, 1e-6, 1e3, 1e14};
  gh_context *ctx = *state;
  double worst = 0;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4][4], A[4][16];
    for (int k = 0; k < 4; k++) {
      gh_rve *rve = make_rve(ctx, p, e, *b, stiffness[k], 1e-11);
      walk(ctx, rve, I, squeeze, 3, P[k], A[k]);
      for (int c = 0; c < 4; c++) P[k][c] /= stiffness[k];
      for (int c = 0; c < 16; c++) A[k][c] /= stiffness[k];
      WITHIN(&worst, "stress", relative(P[k], P[0], 4), 1e-9);
      WITHIN(&worst, "tangent", relative(A[k], A[0], 16), 1e-9);
      gh_rve_destroy(&rve);
    }
    assert_true(norm(P[0], 4) > 1e-3);
  }
  gh_packing_destroy(&p);
  row_error(section, "stiffness E 1e-6 to 1e14", "P/E, A/E as with E = 1", worst, 1e-9);
}

/* Beyond 1e-100 and 1e100 squares of forces are no numbers. */
static void stiffness_out_of_range(void **state) {
  static const double stiffness[] = {1e-101, 1e101, 0, -1, INFINITY, NAN};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  gh_rve *rve;
  for (size_t k = 0; k < sizeof stiffness / sizeof *stiffness; k++) {
    gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, stiffness[k], 1e-8);
    FAILS(gh_rve_create(ctx, p, &o, &rve), GH_INPUT, "normal stiffness must");
  }
  row(section, "stiffness below 1e-100, above 1e100, 0, negative, infinite, NaN", "message, exit status 2",
      "refused: the normal stiffness must be positive and finite; must lie between 1e-100 and 1e+100");
  gh_packing_destroy(&p);
}

/* In the plane stress and tangent do not know how large the grains are, from 1e-6 to 1e6. */
static void length_does_not_matter(void **state) {
  static const double length[] = {1, 1e-6, 1e-3, 1e6};
  gh_context *ctx = *state;
  double worst = 0;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4][4], A[4][16];
    for (int k = 0; k < 4; k++) {
      gh_packing *p = scaled(ctx, "p50", length[k]);
      gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-11);
      walk(ctx, rve, I, squeeze, 3, P[k], A[k]);
      WITHIN(&worst, "stress", relative(P[k], P[0], 4), 1e-9);
      WITHIN(&worst, "tangent", relative(A[k], A[0], 16), 1e-9);
      gh_rve_destroy(&rve);
      gh_packing_destroy(&p);
    }
  }
  row_error(section, "lengths 1e-6 to 1e6", "P, A as with 1", worst, 1e-9);
}

/* A packing ten thousand cells away from the origin is the same packing, up to the round-off of its
 * positions. */
static void far_from_the_origin(void **state) {
  gh_context *ctx = *state;
  double worst = 0;
  gh_packing *p = case_packing(ctx, "p50"), *q;
  OK(gh_packing_copy(ctx, p, &q));
  for (int i = 0; i < 2 * p->n; i++) q->x[i] += 1e4;
  q->low[0] += 1e4, q->low[1] += 1e4;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4], Q[4];
    gh_rve *near = make_rve(ctx, p, e, *b, 1, 1e-10), *far = make_rve(ctx, q, e, *b, 1, 1e-10);
    walk(ctx, near, I, squeeze, 2, P, NULL);
    walk(ctx, far, I, squeeze, 2, Q, NULL);
    WITHIN(&worst, "stress", relative(Q, P, 4), 1e-7);
    gh_rve_destroy(&near);
    gh_rve_destroy(&far);
  }
  gh_packing_destroy(&p);
  gh_packing_destroy(&q);
  row_error(section, "a packing 1e4 cells from the origin", "P at the origin", worst, 1e-7);
}

/* Increments from 1e-10 to a thousandth change the stress by A : dF, up to second order and round-off. */
static void tiny_increments(void **state) {
  gh_context *ctx = *state;
  double worst = 0;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P0[4], P[4], A[16], F[4];
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-12);
    walk(ctx, rve, I, squeeze, 4, P0, A);
    for (double d = 1e-10; d < 1e-6; d *= 10) {
      memcpy(F, squeeze, sizeof F);
      F[0] -= d;
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      for (int c = 0; c < 4; c++)
        WITHIN(&worst, "dP", fabs(P[c] - P0[c] + d * A[4 * c]) / (norm(A, 16) * (d + 4e-10)), 1e-3);
    }
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
  row_error(section, "increments of 1e-10 to 1e-7", "dP = A : dF; relative to dF + 4e-10", worst, 1e-3);
}

/* Compression by up to a fifth at once: both engines find the same equilibrium with pressure, and the next
 * 1e-4 are no harder. */
static void large_increments(void **state) {
  gh_context *ctx = *state;
  double worst = 0;
  gh_packing *p = case_packing(ctx, "p50");
  for (int b = 2; b < 4; b++)
    for (double d = 0.01; d < 0.21; d += 0.0475) {
      double P[2][4], F[4] = {1 - d, d / 3, 0, 1}, last[4] = {1 - d - 1e-4, d / 3, 0, 1};
      FOR_ENGINES(e) {
        gh_rve *rve = make_rve(ctx, p, e, all_boundaries[b], 1, 1e-11);
        OK(gh_rve_evaluate(rve, F, 0, P[e], NULL));
        OK(gh_rve_commit(rve));
        OK(gh_rve_evaluate(rve, last, 0, P[e], NULL));
        const gh_rve_measures *m = gh_rve_measure(rve);
        assert_true(m->cauchy[0] < 0 && m->cauchy[3] < 0);
        WITHIN(&worst, "symmetry", fabs(m->cauchy[1] - m->cauchy[2]) / norm(m->cauchy, 4), 1e-9);
        gh_rve_destroy(&rve);
      }
      if (use_engine(0) && use_engine(1)) WITHIN(&worst, "engines", relative(P[0], P[1], 4), 1e-8);
    }
  gh_packing_destroy(&p);
  row_error(section, "one increment of 1 to 20 % from rest, then 1e-4",
            "engines agree, symmetric Cauchy stress", worst, 1e-8);
}

/* Shear to 2 in steps of a hundredth, in which LAMMPS's cell changes its lattice vectors four times: both
 * engines give the same stress all the way. */
static void shear_to_two(void **state) {
  enum { STEPS = 200 };
  gh_context *ctx = *state;
  double worst = 0;
  gh_packing *p = case_packing(ctx, "p20");
  if (!use_engine(0) || !use_engine(1)) skip();
  for (int b = 0; b < 4; b++) {
    gh_rve *rve[2] = {make_rve(ctx, p, 0, all_boundaries[b], 1, 1e-11),
                      make_rve(ctx, p, 1, all_boundaries[b], 1, 1e-11)};
    for (int k = 1; k <= STEPS; k++) {
      double F[4] = {0.97, 2.0 * k / STEPS, 0, 0.97}, P[2][4], A[2][16];
      for (int e = 0; e < 2; e++) {
        OK(gh_rve_evaluate(rve[e], F, GH_WANT_TANGENT, P[e], A[e]));
        OK(gh_rve_commit(rve[e]));
      }
      WITHIN(&worst, "stress", relative(P[0], P[1], 4), 1e-8);
      WITHIN(&worst, "tangent", relative(A[0], A[1], 16), 1e-8);
    }
    gh_rve_destroy(&rve[0]);
    gh_rve_destroy(&rve[1]);
  }
  gh_packing_destroy(&p);
  row_error(section, "shear to 2 in 200 increments", "engines agree, P and A", worst, 1e-8);
}

/* Turned twice around its centre, in steps of 15 degrees, a packing turns its stress along: P(QF) = Q P(F).
 */
static void two_turns(void **state) {
  gh_context *ctx = *state;
  double worst = 0;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P0[4], P[4], Q[4], F[4], turned[4];
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-11);
    walk(ctx, rve, I, squeeze, 3, P0, NULL);
    for (int angle = 15; angle <= 720; angle += 15) {
      rotation(angle * help_pi / 180, Q);
      gh_mul2(Q, squeeze, F);
      gh_mul2(Q, P0, turned);
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      OK(gh_rve_commit(rve));
      WITHIN(&worst, "stress", distance(P, turned, 4) / norm(P0, 4), 1e-10);
    }
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
  row_error(section, "rotation by 720 degrees in steps of 15", "P(Q F) = Q P(F)", worst, 1e-10);
}

/* Pulled apart until no contact is left a packing carries nothing, and pressed together again it pushes
 * again; where the grains follow F, by the same stress as if it had never been apart. */
static void apart_and_together(void **state) {
  static const double apart[4] = {1.6, 0.1, 0, 1.5};
  gh_context *ctx = *state;
  double worst = 0;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4], A[16], direct[4];
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-10), *other = make_rve(ctx, p, e, *b, 1, 1e-10);
    walk(ctx, rve, I, apart, 10, P, A);
    assert_true(norm(P, 4) == 0 && norm(A, 16) == 0);
    assert_true(gh_rve_measure(rve)->unjammed && gh_rve_measure(rve)->contacts == 0);
    walk(ctx, rve, apart, squeeze, 10, P, A);
    assert_true(P[0] < 0 && P[3] < 0 && A[0] > 0 && A[15] > 0);
    OK(gh_rve_evaluate(other, squeeze, 0, direct, NULL));
    if (b < all_boundaries + 2) WITHIN(&worst, "stress", relative(P, direct, 4), 1e-11);
    gh_rve_destroy(&rve);
    gh_rve_destroy(&other);
  }
  gh_packing_destroy(&p);
  row_error(section, "until no contact is left and back", "P = 0, A = 0 when apart; Taylor: P as without",
            worst, 1e-11);
}

/* Pressed to half the area in steps of a hundredth: half of each grain lies in others. */
static void half_the_area(void **state) {
  enum { STEPS = 30 };
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  double worst = 0, sum = 0, P[2][4], wanted[4];
  FOR_BOUNDARIES(b) {
    gh_rve *rve[2] = {make_rve(ctx, p, 0, *b, 1, 1e-11), make_rve(ctx, p, 1, *b, 1, 1e-11)};
    for (int k = 1; k <= STEPS; k++) {
      double s = 1 + (sqrt(0.5) - 1) * k / STEPS, F[4] = {s, 0, 0, s};
      FOR_ENGINES(e) {
        walk(ctx, rve[e], F, F, 1, P[e], NULL);
        assert_true(P[e][0] < 0 && P[e][3] < 0);
        if (*b != GH_TAYLOR_CELL) continue;
        sum_of_pairs(p, F, 1, wanted);
        WITHIN(&sum, "sum", relative(P[e], wanted, 4), 1e-12);
      }
      if (use_engine(0) && use_engine(1)) WITHIN(&worst, "engines", relative(P[0], P[1], 4), 1e-7);
    }
    gh_rve_destroy(&rve[0]);
    gh_rve_destroy(&rve[1]);
  }
  row_error(section, "compression to J = 0.5", "engines agree", worst, 1e-7);
  row_error(section, "the same, Taylor on the cell", "plain sum over all pairs", sum, 1e-12);
  gh_packing_destroy(&p);
}

/* Pressed and sheared to and fro where no contact opens or closes, the packing comes back to where it was. */
static void reversals(void **state) {
  const int cycles = full_size() ? 5000 : 50;
  const double other[4] = {squeeze[0] - 2e-5, squeeze[1] + 2e-5, squeeze[2], squeeze[3]};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  double worst = 0, P[4], first[4];
  FOR_BOUNDARIES(b) {
    gh_rve *rve = make_rve(ctx, p, GH_ENGINE_NATIVE, *b, 1, 1e-12);
    walk(ctx, rve, I, squeeze, 4, P, NULL);
    walk(ctx, rve, squeeze, other, 1, P, NULL);
    walk(ctx, rve, other, squeeze, 1, first, NULL);
    for (int k = 1; k < cycles; k++) {
      walk(ctx, rve, squeeze, other, 1, P, NULL);
      walk(ctx, rve, other, squeeze, 1, P, NULL);
      WITHIN(&worst, "stress", relative(P, first, 4), 1e-9);
    }
    gh_rve_destroy(&rve);
  }
  row_error(section, full_size() ? "1e4 reversals of a strain of 2e-5" : "100 reversals of a strain of 2e-5",
            "the stress returns", worst, 1e-9);
  gh_packing_destroy(&p);
}

/* Pulled apart and pressed together, again and again. */
static void cyclic_unjamming(void **state) {
  static const double apart[4] = {1.3, 0.1, 0, 1.25};
  const int times = full_size() ? 100 : 5;
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  double worst[2] = {0, 0};
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4], A[16], first[4];
    bool relaxes = *b == GH_RESTRICTED || *b == GH_PERIODIC;
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-9);
    walk(ctx, rve, I, apart, 10, P, NULL);
    for (int k = 0; k < times; k++) {
      walk(ctx, rve, apart, squeeze, 15, P, A);
      if (k == 0) memcpy(first, P, sizeof P);
      WITHIN(&worst[relaxes], "stress", relative(P, first, 4), relaxes ? 0.2 : 1e-12);
      walk(ctx, rve, squeeze, apart, 10, P, A);
      assert_true(norm(P, 4) == 0 && norm(A, 16) == 0 && gh_rve_measure(rve)->unjammed);
    }
    gh_rve_destroy(&rve);
  }
  row_error(section, "cyclic unjamming, Taylor", "the same stress each time", worst[0], 1e-12);
  row(section, "cyclic unjamming, restricted and periodic", "no stress when apart",
      "converged; the stress differs by up to %.0e from time to time", worst[1]);
  gh_packing_destroy(&p);
}

/* What answers, answers with numbers; what cannot be, has a message that holds its numbers too. */
static bool ask(gh_context *ctx, gh_rve *rve, const double F[4]) {
  double P[4] = {NAN, NAN, NAN, NAN}, A[16];
  for (int k = 0; k < 16; k++) A[k] = NAN;
  gh_status s = gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A);
  const gh_rve_measures *m = gh_rve_measure(rve);
  assert_true(m->steps < 20000);
  if (s != GH_OK) {
    assert_true(s == GH_INPUT || s == GH_DIVERGED);
    assert_true(strlen(gh_message(ctx)) > 10);
    return false;
  }
  bool good = gh_finite(P, 4) && gh_finite(A, 16) && gh_finite(m->cauchy, 4) && isfinite(m->energy) &&
              isfinite(m->residual) && isfinite(m->acoustic) && gh_finite(m->fabric, 3);
  if (!good) fail_msg("F = [%g %g; %g %g]: not finite", F[0], F[1], F[2], F[3]);
  return true;
}

/* No deformation, however wild, brings out NaN, costs more than some thousand steps, or ends in anything but
 * a number or a message; and none is remembered. */
static void nan_never_comes_out(void **state) {
  static const double wild[][4] = {
      {0.3, 0, 0, 0.3},       {0.1, 0, 0, 0.1},  {1e-4, 0, 0, 1e-4},   {1e-8, 0, 0, 1e-8},
      {1e-150, 0, 0, 1e-150}, {1e-4, 0, 0, 1e4}, {0.01, 0, 0, 100},    {10, 0, 0, 10},
      {100, 0, 0, 100},       {1e4, 0, 0, 1e4},  {1e150, 0, 0, 1e150}, {1, 100, 0, 1},
      {1, 1e4, 0, 1},         {1, 1e8, 0, 1},    {1, 1e300, 0, 1},     {1e8, 0, 0, 1e-8},
      {1, 1, 1, 1.0000001},   {1, 1, 1, 1},      {1, 0, 0, -1},        {-1, 0, 0, -1},
      {0, 0, 0, 0},           {NAN, 0, 0, 1},    {1, INFINITY, 0, 1},  {1, 0, NAN, 1}};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  unsigned long long seed = 99;
  int answered[2] = {0, 0};
  print_message("seed %llu\n", seed);
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve *rve = make_rve(ctx, p, e, *b, 100, 1e-8);
    double before[4], after[4], F[4];
    OK(gh_rve_evaluate(rve, squeeze, 0, before, NULL));
    for (size_t k = 0; k < sizeof wild / sizeof *wild; k++) answered[ask(ctx, rve, wild[k])]++;
    for (int k = 0; k < 60; k++) {
      for (int c = 0; c < 4; c++) F[c] = I[c] + (uniform(&seed) - 0.5) * (k % 4 + 1) / 2;
      answered[ask(ctx, rve, F)]++;
    }
    OK(gh_rve_evaluate(rve, squeeze, 0, after, NULL));
    assert_memory_equal(before, after, sizeof before);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
  row(section, "wild deformations: det F from 1e-300 to 1e300, shear to 1e300, NaN",
      "finite number or message", "%d answered, %d refused with a reason", answered[1], answered[0]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(stiffness_scales),    TEST(stiffness_out_of_range), TEST(length_does_not_matter),
      TEST(far_from_the_origin), TEST(tiny_increments),        TEST(large_increments),
      TEST(half_the_area),       TEST(shear_to_two),           TEST(two_turns),
      TEST(reversals),           TEST(apart_and_together),     TEST(cyclic_unjamming),
      TEST(nan_never_comes_out)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
