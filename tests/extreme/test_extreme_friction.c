/* SPDX-License-Identifier: GPL-2.0-or-later */
/* RVEs with friction at the edges of what can be asked of them: scales, contact laws, packings. */
#include "extreme_friction.h"

/* Stress and tangent over E, E_t = 0.8 E and h = 0.1 E with it, from 1e-6 to 1e14. */
static void stiffness_scales(void **state) {
  static const double stiffness[] = {1, 1e-6, 1e3, 1e14};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst = 0;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4][4], A[4][16];
    for (int k = 0; k < 4; k++) {
      gh_rve *rve = open_rve(ctx, p, e, *b, law_of(stiffness[k], 20, 0.1 * stiffness[k]));
      walk(ctx, rve, I, squeeze, 8, P[k], A[k]);
      for (int c = 0; c < 4; c++) P[k][c] /= stiffness[k];
      for (int c = 0; c < 16; c++) A[k][c] /= stiffness[k];
      WITHIN(&worst, "stress", relative(P[k], P[0], 4), 1e-9);
      WITHIN(&worst, "tangent", relative(A[k], A[0], 16), 1e-9);
      gh_rve_destroy(&rve);
    }
    assert_true(norm(P[0], 4) > 1e-3);
  }
  row_error(section, "stiffness E 1e-6 to 1e14, E_t = 0.8 E, h = 0.1 E, 20 degrees", "P/E, A/E as with E = 1",
            worst, 1e-9);
  gh_packing_destroy(&p);
}

/* Lengths from 1e-6 to 1e6 at the same stiffness. */
static void length_does_not_matter(void **state) {
  static const double length[] = {1, 1e-6, 1e-3, 1e6};
  gh_context *ctx = *state;
  double worst = 0;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4][4], A[4][16];
    for (int k = 0; k < 4; k++) {
      gh_packing *p = scaled(ctx, "p50d", length[k]);
      gh_rve *rve = open_rve(ctx, p, e, *b, law_of(1, 20, 0.1));
      walk(ctx, rve, I, squeeze, 8, P[k], A[k]);
      WITHIN(&worst, "stress", relative(P[k], P[0], 4), 1e-9);
      WITHIN(&worst, "tangent", relative(A[k], A[0], 16), 1e-9);
      gh_rve_destroy(&rve);
      gh_packing_destroy(&p);
    }
  }
  row_error(section, "lengths 1e-6 to 1e6, 20 degrees, h = 0.1 E", "P, A as with 1", worst, 1e-9);
}

/* One path of 40 increments for a law, in both engines: they agree, and forces and moments balance. False:
 * some increment has no equilibrium that was found, and the message states where and what was missing. */
static bool path_of(gh_context *ctx, const gh_packing *p, gh_boundary b, gh_contact_law law, double s[4],
                    double *worst, double limit) {
  enum { STEPS = 40 };
  double P[2][4], edge[4], F[4];
  bool whole = true;
  FOR_ENGINES(e) {
    gh_rve *rve = open_rve(ctx, p, e, b, law);
    for (int k = 1; k <= STEPS; k++) {
      for (int c = 0; c < 4; c++) F[c] = I[c] + (squeeze[c] - I[c]) * k / STEPS;
      gh_status status = gh_rve_evaluate(rve, F, 0, P[e], NULL);
      if (status != GH_OK) {
        FAILS(status, GH_DIVERGED, "no equilibrium within");
        whole = false;
        break;
      }
      memcpy(s, gh_rve_measure(rve)->cauchy, 4 * sizeof *s);
      WITHIN(worst, "symmetry", fabs(s[1] - s[2]) / norm(s, 4), limit);
      OK(gh_rve_boundary_stress(rve, edge));
      WITHIN(worst, "boundary form", relative(edge, P[e], 4), limit);
      OK(gh_rve_commit(rve));
    }
    gh_rve_destroy(&rve);
  }
  if (whole && use_engine(0) && use_engine(1)) WITHIN(worst, "engines", relative(P[0], P[1], 4), limit);
  return whole;
}

/* Tangential over normal stiffness from 1e-3 to 1e3. */
static void stiffness_ratio(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst = 0, s[4];
  FOR_BOUNDARIES(b) for (double ratio = 1e-3; ratio < 2e3; ratio *= 10) {
    gh_contact_law law = law_of(1, 20, 0);
    law.tangential_stiffness = ratio;
    assert_true(path_of(ctx, p, *b, law, s, &worst, 1e-7));
  }
  row_error(section, "E_t/E_n from 1e-3 to 1e3, 20 degrees", balances, worst, 1e-7);
  gh_packing_destroy(&p);
}

/* Hardening from none to a thousand times the stiffness, in increments of 0.05 %. With these it all but never
 * slides: the stress is that of sticking contacts. */
static void hardening(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst = 0, sticks = 0, s[4], stuck[4];
  FOR_BOUNDARIES(b) {
    assert_true(path_of(ctx, p, *b, law_of(1, 89, 0), stuck, &worst, 1e-7));
    for (double h = 0; h<2e3; h = h> 0 ? 10 * h : 1e-3) {
      assert_true(path_of(ctx, p, *b, law_of(1, 20, h), s, &worst, 1e-7));
    }
    WITHIN(&sticks, "limit", relative(s, stuck, 4), 2e-6);
  }
  row_error(section, "hardening from 0 to 1e3 E, increments of 0.05 %", balances, worst, 1e-7);
  row_error(section, "hardening 1e3 E", "the stress of contacts that stick (89 degrees)", sticks, 2e-6);
  gh_packing_destroy(&p);
}

/* Angles from 0 to 89.9 degrees: none is frictionless, the largest never slides. */
static void friction_angle(void **state) {
  static const double angles[] = {0, 1, 20, 45, 75, 89.9};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst = 0, none = 0, sticks = 0, s[4], other[4];
  FOR_BOUNDARIES(b) {
    for (int k = 0; k < 6; k++) {
      assert_true(path_of(ctx, p, *b, law_of(1, angles[k], 0), s, &worst, 1e-7));
      gh_contact_law law = law_of(1, 0, 0);
      if (k == 0) law.friction = 0;
      else if (k == 5) law.friction_coefficient = 2000;
      else continue;
      assert_true(path_of(ctx, p, *b, law, other, &worst, 1e-7));
      WITHIN(k ? &sticks : &none, "limit", relative(s, other, 4), 1e-7);
    }
  }
  row_error(section, "friction angles from 0 to 89.9 degrees", balances, worst, 1e-7);
  row_error(section, "friction angle 0", "the frictionless stress", none, 1e-7);
  row_error(section, "friction angle 89.9 degrees", "the stress at a coefficient of 2000", sticks, 1e-7);
  gh_packing_destroy(&p);
}

/* A hundredth of a degree: floating grains creep on contacts that slide. Whatever answers is right, the rest
 * is refused. */
static void almost_no_friction(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst = 0, s[4];
  int whole = 0;
  FOR_BOUNDARIES(b) {
    bool good = path_of(ctx, p, *b, law_of(1, 0.01, 0), s, &worst, 1e-7);
    if (*b == GH_TAYLOR || *b == GH_TAYLOR_CELL) assert_true(good);
    whole += good;
  }
  row(section, "friction angle 0.01 degrees", balances,
      "%d of 4 boundary conditions converged to the end, error %.0e (allowed 1e-07)%s", whole, worst,
      whole < 4 ? "; the others refused: no equilibrium within 50000 relaxation steps" : "");
  gh_packing_destroy(&p);
}

/* One grain that touches its own images, sheared: a closed form. The grain rotates until the couples of its
 * two contacts balance. */
static void one_grain_sheared(void **state) {
  const double r = 0.502, E = 10, F[4] = {0.99, 0.004, 0, 0.985}, straight[4] = {0.99, 0, 0, 0.985},
               x[2] = {0.3, 0.1}, radius[1] = {0.502};
  gh_context *ctx = *state;
  gh_packing *p = make_packing(ctx, 1, I, radius, x);
  double worst = 0, P[4];
  gh_contact_law law = law_of(E, 85, 0);
  law.slip = GH_SLIP_OBJECTIVE;
  double l1 = F[0], l2 = hypot(F[1], F[3]), s1 = l1 / (2 * r), s2 = l2 / (2 * r), turn = -atan2(F[1], F[3]),
         q = straight[3] * turn * s2 / (s1 * s1 + s2 * s2), f1 = 0.8 * E * q * s1,
         f2 = 0.8 * E * (q * s2 - straight[3] * turn), n2[2] = {F[1] / l2, F[3] / l2}, N1 = E * (2 * r - l1),
         N2 = E * (2 * r - l2);
  const double wanted[4] = {-N1, -N2 * n2[0] + f2 * n2[1], -f1, -N2 * n2[1] - f2 * n2[0]};
  FOR_ENGINES(e) for (int b = 1; b < 4; b += 2) {
    gh_rve *rve = open_rve(ctx, p, e, all_boundaries[b], law);
    step(ctx, rve, straight, P, NULL);
    step(ctx, rve, F, P, NULL);
    WITHIN(&worst, "stress", relative(P, wanted, 4), 1e-9);
    gh_rve_destroy(&rve);
  }
  row_error(section, "1 grain that touches its own images, sheared", "closed form", worst, 1e-9);
  gh_packing_destroy(&p);
}

/* The square lattice with one to four grains in a cell. Its grains can roll like gears: any turn will do. */
static void one_to_four_grains(void **state) {
  static const int across[5] = {0, 1, 2, 3, 2};
  const double F[4] = {0.99, 0, 0, 0.985}, r = 0.502;
  gh_context *ctx = *state;
  double worst = 0;
  for (int n = 1; n <= 4; n++) {
    double x[8], radius[4], cell[4] = {across[n], 0, 0, n / across[n]};
    for (int i = 0; i < n; i++) {
      radius[i] = r;
      x[2 * i] = 0.3 + i % across[n], x[2 * i + 1] = 0.1 + i / across[n];
    }
    gh_packing *p = make_packing(ctx, n, cell, radius, x);
    const double wanted[4] = {-10 * (2 * r - F[0]), 0, 0, -10 * (2 * r - F[3])};
    FOR_ENGINES(e) for (int b = 1; b < 4; b += 2) {
      double P[4], A[16];
      gh_rve *rve = open_rve(ctx, p, e, all_boundaries[b], law_of(10, 30, 0));
      step(ctx, rve, F, P, A);
      WITHIN(&worst, "stress", relative(P, wanted, 4), 1e-12);
      assert_true(gh_finite(A, 16));
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
  row_error(section, "1, 2, 3, 4 grains (square lattice)", "closed form", worst, 1e-12);
}

/* Two grains at one place have no direction to push. */
static void grains_at_one_place(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  p->x[8] = p->x[30], p->x[9] = p->x[31];
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4];
    gh_rve *rve = open_rve(ctx, p, e, *b, law_of(1, 20, 0));
    gh_status s = gh_rve_evaluate(rve, I, 0, P, NULL);
    assert_true(s == GH_DIVERGED || s == GH_ENGINE);
    if (!strstr(gh_message(ctx), "coincide")) fail_msg("%s", gh_message(ctx));
    gh_rve_destroy(&rve);
  }
  row(section, "two grains at one place", "message, exit status 1", "refused: grains coincide");
  gh_packing_destroy(&p);
}

/* Another cell of the same lattice, tilted up to three times its width. */
static void strongly_tilted_cells(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d"), *q;
  double worst = 0;
  for (int tilt = -3; tilt <= 3; tilt += 2) {
    OK(gh_packing_copy(ctx, p, &q));
    q->cell[1] += tilt * q->cell[0];
    FOR_ENGINES(e) for (int b = 1; b < 4; b += 2) {
      double P[4], Q[4], A[16], B[16];
      gh_rve *plain = open_rve(ctx, p, e, all_boundaries[b], law_of(1, 20, 0)),
             *tilted = open_rve(ctx, q, e, all_boundaries[b], law_of(1, 20, 0));
      walk(ctx, plain, I, squeeze, 8, P, A);
      walk(ctx, tilted, I, squeeze, 8, Q, B);
      WITHIN(&worst, "stress", relative(Q, P, 4), 1e-8);
      WITHIN(&worst, "tangent", relative(B, A, 16), 1e-8);
      gh_rve_destroy(&plain);
      gh_rve_destroy(&tilted);
    }
    gh_packing_destroy(&q);
  }
  row_error(section, "cells tilted by up to three times their width", "P, A of the upright cell", worst,
            1e-8);
  gh_packing_destroy(&p);
}

/* Grains that touch nothing carry nothing, and pairs that overlap are pushed apart until they carry nothing.
 */
static void rattlers_only(void **state) {
  gh_context *ctx = *state;
  double cell[4] = {10, 0, 0, 10}, radius[6] = {1, 1, 1, 1, 1, 1},
         x[12] = {2, 2, 3.9, 2, 5, 7.1, 5, 5.2, 8.1, 4, 8, 8};
  for (int touching = 0; touching < 2; touching++) {
    if (!touching) x[2] = 4.1, x[7] = 5.05;
    else x[2] = 3.9, x[7] = 5.2;
    gh_packing *p = make_packing(ctx, 6, cell, radius, x);
    FOR_ENGINES(e) FOR_BOUNDARIES(b) {
      double P[4], A[16];
      gh_rve *rve = open_rve(ctx, p, e, *b, law_of(1, 20, 0));
      OK(gh_rve_evaluate(rve, I, GH_WANT_TANGENT, P, A));
      bool carries = touching && (*b == GH_TAYLOR || *b == GH_TAYLOR_CELL);
      if (!carries) assert_true(norm(P, 4) == 0 && norm(A, 16) == 0 && gh_rve_measure(rve)->unjammed);
      else assert_true(P[0] < 0 && P[3] < 0);
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
  row(section, "a packing of rattlers only", "P = 0, A = 0, unjammed", "converged, exactly");
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(stiffness_scales),    TEST(length_does_not_matter),
                                     TEST(stiffness_ratio),     TEST(hardening),
                                     TEST(friction_angle),      TEST(almost_no_friction),
                                     TEST(one_grain_sheared),   TEST(one_to_four_grains),
                                     TEST(grains_at_one_place), TEST(strongly_tilted_cells),
                                     TEST(rattlers_only)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
