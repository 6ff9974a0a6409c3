/* RVEs with friction at the edges of what can be asked of them. SPDX-License-Identifier: GPL-2.0-or-later */
#include "extreme.h"

static const char section[] = "Friction";
static const char balances[] = "engines, boundary form, symmetry";
static const double I[4] = {1, 0, 0, 1}, press[4] = {0.98, 0.005, 0.002, 0.985};

/* E_t = 0.8 E_n. */
static gh_contact_law law_of(double E, double degrees, double hardening) {
  return (gh_contact_law){.normal_stiffness = E,
                          .friction = 1,
                          .tangential_stiffness = 0.8 * E,
                          .friction_coefficient = tan(degrees * help_pi / 180),
                          .hardening = hardening};
}

static gh_rve *open_rve(gh_context *ctx, const gh_packing *p, gh_engine_kind e, gh_boundary b,
                        gh_contact_law law) {
  gh_rve_options o = gh_rve_defaults();
  gh_rve *rve;
  o.boundary = b, o.engine = e, o.law = law, o.tolerance = 1e-11;
  OK(gh_rve_create(ctx, p, &o, &rve));
  return rve;
}

static void step(gh_context *ctx, gh_rve *rve, const double F[4], double P[4], double *A) {
  OK(gh_rve_evaluate(rve, F, A ? GH_WANT_TANGENT : 0, P, A));
  OK(gh_rve_commit(rve));
}

/* From one deformation to another in n equal steps. */
static void walk(gh_context *ctx, gh_rve *rve, const double from[4], const double to[4], int n, double P[4],
                 double *A) {
  double F[4];
  for (int k = 1; k <= n; k++) {
    for (int c = 0; c < 4; c++) F[c] = from[c] + (to[c] - from[c]) * k / n;
    step(ctx, rve, F, P, k == n ? A : NULL);
  }
}

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
      walk(ctx, rve, I, press, 8, P[k], A[k]);
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
      walk(ctx, rve, I, press, 8, P[k], A[k]);
      WITHIN(&worst, "stress", relative(P[k], P[0], 4), 1e-9);
      WITHIN(&worst, "tangent", relative(A[k], A[0], 16), 1e-9);
      gh_rve_destroy(&rve);
      gh_packing_destroy(&p);
    }
  }
  row_error(section, "lengths 1e-6 to 1e6, 20 degrees, h = 0.1 E", "P, A as with 1", worst, 1e-9);
}

/* One path of 40 increments for a law, in both engines: they agree, and forces and moments balance. False:
 * some increment has no equilibrium that was found, and the message says where and what was missing. */
static bool path_of(gh_context *ctx, const gh_packing *p, gh_boundary b, gh_contact_law law, double s[4],
                    double *worst, double limit) {
  enum { STEPS = 40 };
  double P[2][4], edge[4], F[4];
  bool whole = true;
  FOR_ENGINES(e) {
    gh_rve *rve = open_rve(ctx, p, e, b, law);
    for (int k = 1; k <= STEPS; k++) {
      for (int c = 0; c < 4; c++) F[c] = I[c] + (press[c] - I[c]) * k / STEPS;
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

/* A hundredth of a degree: loose grains creep on contacts that slide. Whatever answers is right, the rest is
 * refused. */
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

/* One grain that touches its own images, sheared: a closed form. The grain turns until the couples of its two
 * contacts balance. */
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
      walk(ctx, rve, I, press, 8, P, NULL);
      memcpy(s0, gh_rve_measure(rve)->cauchy, sizeof s0);
      for (int degree = 1; degree <= 720; degree++) {
        rotation(degree * help_pi / 180, Q);
        gh_mul2(Q, press, F);
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
  walk(ctx, rve, I, press, 8, P, NULL);
  for (int k = 0; k < cycles; k++) {
    if (k == 2) memcpy(second, P, sizeof P), energy = m->energy, spent = m->dissipation, work = 0;
    memcpy(end, P, sizeof P);
    before = m->dissipation;
    for (int j = 1; j <= 2 * parts; j++) {
      memcpy(F, press, sizeof F), memcpy(last, P, sizeof last);
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
 * the length of the contact at the begin of the increment, and going there and back leaves a rest of second
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
 * engines agree until slip is kept: where in a circle that was is decided by round-off. */
static void shear_to_two(void **state) {
  enum { STEPS = 400 };
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  double worst = 0;
  int parts = 0, alike = STEPS;
  if (!use_engine(0) || !use_engine(1)) skip();
  FOR_BOUNDARIES(b) {
    gh_rve *rve[2] = {open_rve(ctx, p, 0, *b, law_of(1, 20, 0)), open_rve(ctx, p, 1, *b, law_of(1, 20, 0))};
    bool kept = false;
    for (int k = 1; k <= STEPS; k++) {
      double F[4] = {0.97, 2.0 * k / STEPS, 0, 0.97}, P[2][4];
      for (int e = 0; e < 2; e++) {
        OK(go_to(rve[e], F, 6, P[e], &parts));
        kept = kept || gh_rve_measure(rve[e])->kept;
      }
      if (!kept) WITHIN(&worst, "engines", relative(P[0], P[1], 4), 1e-8);
      else if (k - 1 < alike) alike = k - 1;
    }
    if (*b != GH_PERIODIC) assert_false(kept);
    gh_rve_destroy(&rve[0]);
    gh_rve_destroy(&rve[1]);
  }
  assert_true(alike > STEPS / 4);
  assert_true(parts >= 8 * STEPS);
  row_error(section, "shear to 2 in 400 increments", "engines agree", worst, 1e-8);
  row(section, "the same, periodic", "engines agree up to a limit cycle",
      "%d bisections; alike for %d increments, then a limit cycle", parts - 8 * STEPS, alike);
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
      walk(ctx, rve, apart, press, 40, P, A);
      if (k == 0) memcpy(first, P, sizeof P);
      WITHIN(&worst[relaxes], "stress", relative(P, first, 4), relaxes ? 0.2 : 1e-12);
      walk(ctx, rve, press, apart, 20, P, A);
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
      walk(ctx, plain, I, press, 8, P, A);
      walk(ctx, tilted, I, press, 8, Q, B);
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

/* Increments from 1e-10 to 1e-7 change the stress by A : dF, from the state of an increment of zero length.
 */
static void tiny_increments(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  double worst = 0;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P0[4], P[4], A[16], F[4], off[4];
    gh_rve *rve = open_rve(ctx, p, e, *b, law_of(1, 20, 0));
    walk(ctx, rve, I, press, 40, P0, NULL);
    OK(gh_rve_evaluate(rve, press, GH_WANT_TANGENT, P0, A));
    for (double d = 1e-10; d < 2e-7; d *= 10) {
      memcpy(F, press, sizeof F);
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
        assert_true((s == GH_INPUT || s == GH_DIVERGED) && strlen(gh_message(ctx)) > 10);
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
      TEST(stiffness_scales),    TEST(length_does_not_matter), TEST(stiffness_ratio),
      TEST(hardening),           TEST(friction_angle),         TEST(almost_no_friction),
      TEST(one_grain_sheared),   TEST(one_to_four_grains),     TEST(two_turns),
      TEST(reversals),           TEST(shear_to_two),           TEST(apart_and_together),
      TEST(grains_at_one_place), TEST(strongly_tilted_cells),  TEST(tiny_increments),
      TEST(large_increments),    TEST(rattlers_only),          TEST(nan_never_comes_out)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
