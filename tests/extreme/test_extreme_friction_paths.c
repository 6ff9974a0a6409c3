/* SPDX-License-Identifier: GPL-2.0-or-later */
/* RVEs with friction at the edges of what can be asked of them: rotations, cycles, increments, wild
 * deformations. */
#include "extreme_friction.h"

/* Turned twice in steps of a degree. By the angle, the slip of a rigid rotation is zero; as printed in (7.5),
 * it is not. */
static void two_turns(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  double worst[2] = {0, 0};
  for (int slip = 0; slip < 2; slip++) FOR_BOUNDARIES(b) {
      double s0[4], s[4], P[4], Q[4], QT[4], F[4];
      gh_contact_law law = law_of(1, 20, 0);
      law.slip = slip ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
      gh_rve *rve = open_rve(ctx, p, GH_ENGINE_NATIVE, *b, law);
      walk(ctx, rve, I, squeeze, 8, P, NULL);
      memcpy(s0, gh_rve_measure(rve)->cauchy, sizeof s0);
      for (int degree = 1; degree <= 720; degree++) {
        rotation(degree * help_pi / 180, Q);
        gh_mul2(Q, squeeze, F);
        step(ctx, rve, F, P, NULL);
      }
      rotation(-720 * help_pi / 180, QT);
      gh_mul2(QT, gh_rve_measure(rve)->cauchy, s);
      gh_mul2(s, Q, s);
      if (slip) WITHIN(&worst[1], "stress", relative(s, s0, 4), 1e-7);
      else WITHIN(&worst[0], "stress", relative(s, s0, 4), 1);
      gh_rve_destroy(&rve);
    }
  row_error(section, "rotation by 720 degrees in steps of 1 degree, objective slip", "stress rotates along",
            worst[1], 1e-7);
  row(section, "the same, projected slip (7.5)", "stress rotates along",
      "converged, departs by %.0e: the printed measure is not objective", worst[0]);
  gh_packing_destroy(&p);
}

typedef struct cycling {
  double drift;  /* of the stress in the last cycle, relative */
  double total;  /* of the stress since the second cycle, relative */
  double defect; /* work not found in energy or dissipation, over the energy at the end; summed from there */
  double dissipated; /* in the last cycle, over the energy */
} cycling;

/* Cycles of shear by `amplitude` and back, each way in `parts` increments. */
static cycling cycle(gh_context *ctx, const gh_packing *p, gh_boundary b, double amplitude, int parts,
                     int cycles) {
  double P[4] = {0}, F[4], last[4], second[4], end[4], work = 0, energy = 0, spent = 0, before = 0;
  gh_rve *rve = open_rve(ctx, p, GH_ENGINE_NATIVE, b, law_of(1, 20, 0));
  const gh_rve_measures *m = gh_rve_measure(rve);
  walk(ctx, rve, I, squeeze, 8, P, NULL);
  for (int k = 0; k < cycles; k++) {
    if (k == 2) memcpy(second, P, sizeof P), energy = m->energy, spent = m->dissipation, work = 0;
    memcpy(end, P, sizeof P);
    before = m->dissipation;
    for (int j = 1; j <= 2 * parts; j++) {
      memcpy(F, squeeze, sizeof F), memcpy(last, P, sizeof last);
      F[1] += amplitude * (j <= parts ? j : 2 * parts - j) / parts;
      step(ctx, rve, F, P, NULL);
      work += (P[1] + last[1]) / 2 * amplitude / parts * (j <= parts ? 1 : -1);
      assert_true(gh_finite(P, 4) && m->dissipation >= before);
    }
  }
  cycling c = {relative(P, end, 4), relative(P, second, 4),
               fabs(work - (m->energy - energy) - (m->dissipation - spent)) / m->energy,
               (m->dissipation - before) / m->energy};
  gh_rve_destroy(&rve);
  return c;
}

/* Sheared to and fro a packing shakes down, but what it keeps creeps: slip is counted backward (7.5), with
 * the length of the contact at the start of the increment, and going there and back leaves a rest of second
 * order in the increment. Half the increments, half the creep. */
static void reversals(void **state) {
  enum { FEW = 25, MANY = 5000 };
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  double drift = 0, halved = 0, defect = 0, spent = 0, total = 0, many = 0;
  FOR_BOUNDARIES(b) {
    cycling c = cycle(ctx, p, *b, 2e-4, 4, FEW), fine = cycle(ctx, p, *b, 2e-4, 8, FEW);
    WITHIN(&drift, "drift", c.drift, 1e-7);
    WITHIN(&halved, "drift at half the increments", fabs(fine.drift / c.drift - 0.5), 0.02);
    WITHIN(&defect, "energy", c.defect, 1e-6);
    WITHIN(&spent, "dissipation of the last cycle", c.dissipated, 1e-8);
    if (!full_size()) continue;
    c = cycle(ctx, p, *b, 2e-4, 4, MANY);
    WITHIN(&total, "drift", c.total, 1.1e-7 * MANY);
    WITHIN(&many, "energy", c.defect, 1e-6 * MANY / FEW);
  }
  row(section, "50 reversals of a shear of 2e-4 in increments of 5e-5", "the stress returns; energy balance",
      "converged, shakes down; creeps by %.0e of the stress in a cycle, by half of it with half the "
      "increments; "
      "energy balance within %.0e of the stored energy",
      drift, defect);
  if (full_size())
    row(section, "1e4 reversals of the same", "as above",
        "converged; the stress has crept by %.0e, energy balance within %.0e of the stored energy", total,
        many);
  gh_packing_destroy(&p);
}

/* Drift of the stress over so many cycles of shear by `amplitude` p/E and back, a ramp each way, over the pressure:
 * since the third cycle, and in the last. */
static void cycle_along_ramps(gh_context *ctx, const gh_packing *p, gh_boundary b, gh_contact_law law,
                              double amplitude, int cycles, double drift[2]) {
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, b, law.normal_stiffness, 1e-10);
  gh_rve *rve;
  double P[4], third[4] = {0}, last[4];
  int ramps = 0;
  o.law = law;
  OK(gh_rve_create(ctx, p, &o, &rve));
  step(ctx, rve, I, P, NULL);
  const double pressure = -(P[0] + P[3]) / 2, strain = pressure / law.normal_stiffness;
  for (int k = 0; k < cycles; k++) {
    memcpy(last, P, sizeof P);
    for (int back = 0; back < 2; back++) {
      step(ctx, rve, (double[4]){1, back ? 0 : amplitude * strain, 0, 1}, P, NULL);
      ramps += gh_rve_measure(rve)->ramps;
      assert_int_equal(gh_rve_measure(rve)->settled, 0);
    }
    if (k == 2) memcpy(third, P, sizeof P);
  }
  assert_true(ramps == 2 * cycles);
  drift[0] = distance(P, third, 4) / pressure;
  drift[1] = distance(P, last, 4) / pressure;
  gh_rve_destroy(&rve);
}

/* Each way the shear stress changes by 5 to 19 % of the pressure: all reversals together move less than that. */
static void reversals_along_ramps(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  const int cycles = full_size() ? 5000 : 60;
  const gh_contact_law rough = {
      .normal_stiffness = 1, .friction = 1, .tangential_stiffness = 0.2, .friction_coefficient = 0.5};
  double total = 0, last = 0;
  for (int k = 0; k < 8; k++) {
    double drift[2];
    cycle_along_ramps(ctx, p, k & 1 ? GH_PERIODIC : GH_RESTRICTED, k & 2 ? rough : law_of(1, 20, 0),
                      k & 4 ? 0.5 : 1.2, cycles, drift);
    WITHIN(&total, "drift", drift[0], full_size() ? 0.12 : 0.02);
    WITHIN(&last, "drift of the last cycle", drift[1], full_size() ? 2e-5 : 1e-4);
  }
  row(section,
      full_size() ? "1e4 reversals of a shear of 0.5 and 1.2 p/E, a ramp each way"
                  : "120 reversals of a shear of 0.5 and 1.2 p/E, a ramp each way",
      "the stress returns", "converged; it has drifted by %.0e of the pressure, by %.0e in the last cycle",
      total, last);
  gh_packing_destroy(&p);
}

/* To F in halves, quarters, ... where an increment has no equilibrium, as `granhom rve` does it. */
static gh_status go_to(gh_rve *rve, const double F[4], int cuts, double P[4], int *parts) {
  gh_status status = gh_rve_evaluate(rve, F, 0, P, NULL);
  if (status == GH_OK) return (*parts)++, gh_rve_commit(rve);
  if (status != GH_DIVERGED || cuts == 0) return status;
  double half[4];
  for (int c = 0; c < 4; c++) half[c] = (gh_rve_F(rve)[c] + F[c]) / 2;
  GH_TRY(go_to(rve, half, cuts - 1, P, parts));
  return go_to(rve, F, cuts - 1, P, parts);
}

/* Shear to 2 in steps of a two-hundredth, in which LAMMPS's cell changes its lattice vectors four times. The
 * engines agree until a ramp leads to an equilibrium: there round-off decides among many. */
static void shear_to_two(void **state) {
  enum { STEPS = 400 };
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  double worst = 0;
  int parts = 0, alike = STEPS;
  if (!use_engine(0) || !use_engine(1)) skip();
  FOR_BOUNDARIES(b) {
    gh_rve *rve[2] = {open_rve(ctx, p, 0, *b, law_of(1, 20, 0)), open_rve(ctx, p, 1, *b, law_of(1, 20, 0))};
    bool settled = false;
    for (int k = 1; k <= STEPS; k++) {
      double F[4] = {0.97, 2.0 * k / STEPS, 0, 0.97}, P[2][4];
      for (int e = 0; e < 2; e++) {
        OK(go_to(rve[e], F, 6, P[e], &parts));
        settled = settled || gh_rve_measure(rve[e])->settled;
      }
      if (!settled) WITHIN(&worst, "engines", relative(P[0], P[1], 4), 2e-8);
      else if (*b == GH_PERIODIC && k - 1 < alike) alike = k - 1;
    }
    if (*b == GH_TAYLOR || *b == GH_TAYLOR_CELL) assert_false(settled);
    gh_rve_destroy(&rve[0]);
    gh_rve_destroy(&rve[1]);
  }
  assert_true(alike > 0);
  assert_true(parts >= 8 * STEPS);
  row_error(section, "shear to 2 in 400 increments", "engines agree", worst, 2e-8);
  row(section, "the same, periodic", "engines agree up to a ramp to rest",
      "%d bisections; alike for %d increments, then a ramp to rest", parts - 8 * STEPS, alike);
  gh_packing_destroy(&p);
}

/* Pulled apart until nothing touches and pressed together again: a contact that opens forgets its slip, so
 * that every time is like the first where grains follow F (with fixed rotations: free ones stay where the
 * last contact has left them). Elsewhere the grains come together in another order each time. */
static void apart_and_together(void **state) {
  static const double apart[4] = {1.6, 0.1, 0, 1.5};
  const int times = full_size() ? 20 : 5;
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst[2] = {0, 0};
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4], A[16], first[4];
    bool relaxes = *b == GH_RESTRICTED || *b == GH_PERIODIC;
    gh_contact_law law = law_of(1, 20, 0);
    law.fixed_rotations = !relaxes;
    gh_rve *rve = open_rve(ctx, p, e, *b, law);
    walk(ctx, rve, I, apart, 20, P, NULL);
    for (int k = 0; k < times; k++) {
      walk(ctx, rve, apart, squeeze, 40, P, A);
      if (k == 0) memcpy(first, P, sizeof P);
      WITHIN(&worst[relaxes], "stress", relative(P, first, 4), relaxes ? 0.2 : 1e-12);
      walk(ctx, rve, squeeze, apart, 20, P, A);
      assert_true(norm(P, 4) == 0 && norm(A, 16) == 0 && gh_rve_measure(rve)->unjammed);
      assert_true(gh_rve_measure(rve)->energy == 0);
    }
    gh_rve_destroy(&rve);
  }
  row_error(section, "until no contact is left and back, again and again, Taylor",
            "the same stress each time", worst[0], 1e-12);
  row(section, "the same, restricted and periodic", "no stress or energy when apart",
      "converged; stresses differ by up to %.0e, as grains come together in other places", worst[1]);
  gh_packing_destroy(&p);
}

/* Increments from 1e-10 to 1e-7 change the stress by A : dF, from the state of an increment of zero length.
 */
static void tiny_increments(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst = 0;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P0[4], P[4], A[16], F[4], off[4];
    gh_rve *rve = open_rve(ctx, p, e, *b, law_of(1, 20, 0));
    walk(ctx, rve, I, squeeze, 40, P0, NULL);
    OK(gh_rve_evaluate(rve, squeeze, GH_WANT_TANGENT, P0, A));
    for (double d = 1e-10; d < 2e-7; d *= 10) {
      memcpy(F, squeeze, sizeof F);
      F[0] -= d;
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      for (int c = 0; c < 4; c++) off[c] = P[c] - P0[c] + d * A[4 * c];
      WITHIN(&worst, "dP", norm(off, 4) / (norm(A, 16) * (d + 1e-9)), 1e-4);
    }
    gh_rve_destroy(&rve);
  }
  row_error(section, "increments of 1e-10 to 1e-7", "dP = A : dF; relative to dF + 1e-9", worst, 1e-4);
  gh_packing_destroy(&p);
}

/* One compression by up to a fifth. */
static void large_increments(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst = 0;
  int answered = 0, refused = 0;
  if (!use_engine(0) || !use_engine(1)) skip();
  FOR_BOUNDARIES(b) for (double d = 0.01; d < 0.21; d += 0.0475) {
    const double F[4] = {1 - d, d / 3, 0, 1};
    double P[2][4];
    gh_status status[2];
    for (int e = 0; e < 2; e++) {
      gh_rve *rve = open_rve(ctx, p, e, *b, law_of(1, 20, 0));
      status[e] = gh_rve_evaluate(rve, F, 0, P[e], NULL);
      if (status[e] != GH_OK) FAILS(status[e], GH_DIVERGED, "no equilibrium within");
      else assert_true(gh_rve_measure(rve)->cauchy[0] < 0 && gh_rve_measure(rve)->cauchy[3] < 0);
      gh_rve_destroy(&rve);
    }
    if (status[0] == GH_OK && status[1] == GH_OK) {
      WITHIN(&worst, "engines", relative(P[0], P[1], 4), 1e-6);
      answered++;
    } else refused++;
  }
  row(section, "one increment of 1 to 20 % from rest", "engines agree",
      "%d of %d converged, error %.0e (allowed 1e-06)%s", answered, answered + refused, worst,
      refused ? "; the others refused: no equilibrium within 50000 relaxation steps" : "");
  gh_packing_destroy(&p);
}

/* Deformations that no packing survives: a number or a message, and nothing is remembered. */
static void nan_never_comes_out(void **state) {
  static const double wild[][4] = {{0.3, 0, 0, 0.3},     {1e-4, 0, 0, 1e-4}, {1e-150, 0, 0, 1e-150},
                                   {1e-4, 0, 0, 1e4},    {10, 0, 0, 10},     {1e150, 0, 0, 1e150},
                                   {1, 100, 0, 1},       {1, 1e8, 0, 1},     {1, 1e300, 0, 1},
                                   {1, 1, 1, 1.0000001}, {-1, 0, 0, -1},     {0.7, 0.3, 0.4, 1.2},
                                   {0, 0, 0, 0},         {NAN, 0, 0, 1},     {1, INFINITY, 0, 1}};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  int answered = 0, refused = 0;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) for (int slip = 0; slip < 2; slip++) {
    double before[4], after[4], P[4], A[16];
    gh_rve_options o = gh_rve_defaults();
    o.boundary = *b, o.engine = e, o.law = law_of(100, 20, slip ? 10 : 0), o.max_steps = 5000;
    o.law.slip = slip ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
    gh_rve *rve;
    OK(gh_rve_create(ctx, p, &o, &rve));
    OK(gh_rve_evaluate(rve, I, 0, before, NULL));
    for (size_t k = 0; k < sizeof wild / sizeof *wild; k++) {
      for (int c = 0; c < 4; c++) P[c] = NAN;
      for (int c = 0; c < 16; c++) A[c] = NAN;
      gh_status s = gh_rve_evaluate(rve, wild[k], GH_WANT_TANGENT, P, A);
      const gh_rve_measures *m = gh_rve_measure(rve);
      if (s == GH_OK) {
        bool good = gh_finite(P, 4) && gh_finite(A, 16) && gh_finite(m->cauchy, 4) && isfinite(m->energy) &&
                    isfinite(m->energy_t) && isfinite(m->dissipation) && isfinite(m->residual);
        if (!good) fail_msg("F = [%g %g; %g %g]: not finite", wild[k][0], wild[k][1], wild[k][2], wild[k][3]);
        answered++;
      } else {
        if (s != GH_INPUT && s != GH_DIVERGED) fail_msg("status %d: %s", s, gh_message(ctx));
        assert_true(strlen(gh_message(ctx)) > 10);
        refused++;
      }
    }
    OK(gh_rve_evaluate(rve, I, 0, after, NULL));
    assert_memory_equal(before, after, sizeof before);
    gh_rve_destroy(&rve);
  }
  row(section, "wild deformations: det F from 1e-300 to 1e300, shear to 1e300, NaN",
      "finite number or message", "%d answered, %d refused with a reason", answered, refused);
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(two_turns),        TEST(reversals),          TEST(reversals_along_ramps),
      TEST(shear_to_two),     TEST(apart_and_together), TEST(tiny_increments),
      TEST(large_increments), TEST(nan_never_comes_out)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
