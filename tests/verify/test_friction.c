/* SPDX-License-Identifier: GPL-2.0-or-later */
/* RVEs with friction: stress, algorithmic tangent, energy, rigid rotations, states. */
#include "../help.h"

typedef struct problem {
  gh_engine_kind engine;
  gh_boundary boundary;
  gh_contact_law law;
} problem;

static gh_contact_law law_of(double angle, double hardening, gh_slip_measure slip) {
  return (gh_contact_law){.normal_stiffness = 1000,
                          .friction = 1,
                          .tangential_stiffness = 800,
                          .friction_coefficient = tan(angle * help_pi / 180),
                          .hardening = hardening,
                          .slip = slip};
}

/* The friction limit grows by half of it in a few increments of those below. */
static gh_contact_law proportional(double angle, gh_slip_measure slip) {
  gh_contact_law law = law_of(angle, 100, slip);
  law.hardening_law = GH_HARDENING_PROPORTIONAL;
  return law;
}

static gh_rve *open_rve(gh_context *ctx, const gh_packing *p, const problem *q) {
  gh_rve_options o = gh_rve_defaults();
  gh_rve *rve;
  o.boundary = q->boundary, o.engine = q->engine, o.law = q->law, o.tolerance = 1e-11;
  OK(gh_rve_create(ctx, p, &o, &rve));
  return rve;
}

/* Shear with compression, `s` in steps of 1. */
static void deformation(double s, double F[4]) {
  F[0] = 1 - 0.0008 * s, F[1] = 0.0012 * s, F[2] = -0.0002 * s, F[3] = 1 - 0.0004 * s;
}

static void walk(gh_context *ctx, gh_rve *rve, double from, double to, int steps) {
  double F[4], P[4];
  for (int k = 1; k <= steps; k++) {
    deformation(from + (to - from) * k / steps, F);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_commit(rve));
  }
}

/* Every combination that the tests below go through. */
static void for_all(void **state, const char *name,
                    void (*check)(gh_context *, const gh_packing *, const problem *)) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, name);
  for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)
    for (int b = 0; b < 4; b++)
      for (int v = 0; v < 5; v++)
        if (use_engine(e)) {
          const gh_contact_law laws[] = {law_of(20, 0, GH_SLIP_PROJECTED), law_of(10, 200, GH_SLIP_PROJECTED),
                                         law_of(15, 50, GH_SLIP_OBJECTIVE),
                                         proportional(10, GH_SLIP_PROJECTED),
                                         proportional(15, GH_SLIP_OBJECTIVE)};
          check(ctx, p, &(problem){e, all_boundaries[b], laws[v]});
        }
  gh_packing_destroy(&p);
}

/* Contact form and boundary form of the stress agree, and the Cauchy stress is symmetric: moments balance. */
static void check_stress(gh_context *ctx, const gh_packing *p, const problem *q) {
  gh_rve *rve = open_rve(ctx, p, q);
  double F[4], P[4], B[4];
  int sliding = 0;
  for (int k = 1; k <= 4; k++) {
    deformation(k, F);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_boundary_stress(rve, B));
    const gh_rve_measures *m = gh_rve_measure(rve);
    NEAR("boundary form", distance(P, B, 4) / norm(P, 4), 0, 1e-9);
    NEAR("asymmetry", fabs(m->cauchy[1] - m->cauchy[2]) / norm(P, 4), 0, 1e-9);
    assert_true(m->dissipation >= 0 && m->energy_t >= 0);
    sliding += m->sliding;
    OK(gh_rve_commit(rve));
  }
  assert_true(sliding > 0);
  gh_rve_destroy(&rve);
}
static void stresses(void **state) {
  for_all(state, "p50d", check_stress);
}

/* The tangent is the derivative of the stress of the re-equilibrated increment at fixed state n, stick and
 * slip alike. */
static void check_tangent(gh_context *ctx, const gh_packing *p, const problem *q) {
  gh_rve *rve = open_rve(ctx, p, q);
  const double h = 1e-6;
  double F[4], P[4], A[16], worst = 0;
  walk(ctx, rve, 0, 4, 4);
  for (int step = 5; step <= 6; step++) {
    deformation(step, F);
    OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
    assert_int_equal(gh_rve_measure(rve)->regularised, 0);
    for (int k = 0; k < 4; k++) {
      double G[4], up[4], down[4], *const to[2] = {up, down};
      for (int side = 0; side < 2; side++) {
        memcpy(G, F, sizeof G);
        G[k] += side ? -h : h;
        OK(gh_rve_evaluate(rve, G, 0, to[side], NULL));
      }
      for (int i = 0; i < 4; i++) worst = fmax(worst, fabs(A[4 * i + k] - (up[i] - down[i]) / (2 * h)));
    }
    NEAR("tangent against differences", worst / norm(A, 16), 0, 1e-5);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_commit(rve));
  }
  gh_rve_destroy(&rve);
}
static void tangents(void **state) {
  for_all(state, "p50d", check_tangent);
}

/* Work of the stress over a path minus stored and dissipated energy: an error of the increments, which
 * shrinks with their length. */
static double energy_defect(gh_context *ctx, const gh_packing *p, const problem *q, int steps) {
  gh_rve *rve = open_rve(ctx, p, q);
  double F[4], P[4], F0[4] = {1, 0, 0, 1}, P0[4], work = 0;
  OK(gh_rve_evaluate(rve, F0, 0, P0, NULL));
  OK(gh_rve_commit(rve));
  double start = gh_rve_measure(rve)->energy;
  for (int k = 1; k <= steps; k++) {
    deformation(10.0 * k / steps, F);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_commit(rve));
    for (int i = 0; i < 4; i++) work += 0.5 * (P[i] + P0[i]) * (F[i] - F0[i]);
    memcpy(P0, P, sizeof P), memcpy(F0, F, sizeof F);
  }
  const gh_rve_measures *m = gh_rve_measure(rve);
  double defect = fabs(work - (m->energy - start) - m->dissipation) / work;
  assert_true(m->dissipation > 0.01 * work);
  gh_rve_destroy(&rve);
  return defect;
}
static void energies(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  for (int k = 0; k < 8; k++) {
    const int b = k / 2;
    problem q = {GH_ENGINE_NATIVE, all_boundaries[b],
                 k % 2 ? proportional(10, GH_SLIP_PROJECTED) : law_of(10, 100, GH_SLIP_PROJECTED)};
    double coarse = energy_defect(ctx, p, &q, 8), fine = energy_defect(ctx, p, &q, 64);
    print_message("%-12s %senergy imbalance with 8 increments %.2e, with 64 %.2e\n",
                  gh_boundary_name(all_boundaries[b]), k % 2 ? "proportional hardening: " : "", coarse, fine);
    assert_true(fine < 0.25 * coarse && coarse < 0.02);
  }
  gh_packing_destroy(&p);
}

/* Work that a cycle of shear with opening contacts does not find in energy or dissipation, over the largest energy
 * and dissipation. */
static double cycle_defect(gh_context *ctx, const gh_packing *p, const problem *q) {
  enum { PARTS = 40 };
  gh_rve *rve = open_rve(ctx, p, q);
  const gh_rve_measures *m = gh_rve_measure(rve);
  double P[4], last[4], start = 0, work = 0, worst = 0;
  int contacts = 0;
  for (int k = 0; k <= 4 * PARTS; k++) {
    const int way = k < PARTS ? k : k < 3 * PARTS ? 2 * PARTS - k : k - 4 * PARTS;
    const double F[4] = {1, 0.08 * way / PARTS, 0, 1};
    memcpy(last, P, sizeof P);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_commit(rve));
    if (k == 0) start = m->energy, contacts = m->contacts;
    else work += 0.5 * (P[1] + last[1]) * 0.08 / PARTS * (k <= PARTS || k > 3 * PARTS ? 1 : -1);
    worst = fmax(worst, fabs(work - (m->energy - start) - m->dissipation));
  }
  assert_true(m->contacts < contacts);
  worst /= m->energy + m->dissipation;
  gh_rve_destroy(&rve);
  return worst;
}

/* What printed hardening has stored in a contact is lost where the contact opens; proportional hardening stores
 * nothing, and loses nothing. */
static void opening_loses_what_hardening_stores(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  const problem printed = {GH_ENGINE_NATIVE, GH_PERIODIC, law_of(15, 800, GH_SLIP_PROJECTED)},
                other = {GH_ENGINE_NATIVE, GH_PERIODIC, proportional(15, GH_SLIP_PROJECTED)};
  const double lost = cycle_defect(ctx, p, &printed), kept = cycle_defect(ctx, p, &other);
  print_message("energy imbalance of a cycle: printed hardening %.2e, proportional %.2e\n", lost, kept);
  assert_true(kept < 0.05 && lost > 10 * kept);
  gh_packing_destroy(&p);
}

/* A packing that is sheared and then turned as a whole, in one increment: relative change of the Cauchy
 * stress in the turned frame, and the defect of the slip of (7.5) over the mean radius for comparison
 * (method 8.7). */
static double rotated_change(gh_rve *rve, double angle) {
  double F[4], P[4], before[4], Q[4] = {cos(angle), -sin(angle), sin(angle), cos(angle)}, QT[4], s[4];
  memcpy(before, gh_rve_measure(rve)->cauchy, sizeof before);
  deformation(10, F);
  gh_mul2(Q, F, F);
  if (gh_rve_evaluate(rve, F, 0, P, NULL) == GH_DIVERGED)
    return INFINITY; /* (7.5) may leave no equilibrium */
  gh_inv2(Q, QT);
  gh_mul2(QT, gh_rve_measure(rve)->cauchy, s);
  gh_mul2(s, Q, s);
  double change = distance(s, before, 4) / norm(before, 4);
  return change;
}
static void rigid_rotations(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  static const double degrees[] = {0.1, 1, 5, 15, 30, 60, 90};
  double projected[7];
  for (int b = 0; b < 4; b++)
    for (int slip = 0; slip < 2; slip++) {
      problem q = {GH_ENGINE_NATIVE, all_boundaries[b],
                   law_of(20, 0, slip ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED)};
      print_message("%-12s %-10s", gh_boundary_name(q.boundary), slip ? "objective" : "projected");
      for (int k = 0; k < 7; k++) {
        gh_rve *rve = open_rve(ctx, p, &q);
        walk(ctx, rve, 0, 10, 40);
        double change = rotated_change(rve, degrees[k] * help_pi / 180);
        print_message("  %g: %.1e", degrees[k], change);
        if (slip) assert_true(change < 1e-8);
        else projected[k] = change;
        gh_rve_destroy(&rve);
      }
      print_message("\n");
    }
  assert_true(projected[4] > 5e-3 && projected[4] > 20 * projected[2]); /* periodic: 30 degrees, 5 degrees */
  gh_packing_destroy(&p);
}

/* Iterations leave no trace, a reverted step neither; a state that is loaded elsewhere continues to the last
 * bit. */
static void check_states(gh_context *ctx, const gh_packing *p, const problem *q) {
  gh_rve *a = open_rve(ctx, p, q), *b = open_rve(ctx, p, q);
  double F[4], P[4], Q[4], away[4] = {0.99, 0.02, 0, 0.98};
  walk(ctx, a, 0, 3, 3);
  size_t size = gh_rve_state_size(a);
  double *saved = malloc(size * sizeof *saved);
  assert_non_null(saved);
  OK(gh_rve_save(a, saved));
  OK(gh_rve_evaluate(a, away, 0, P, NULL));
  OK(gh_rve_revert(a));
  walk(ctx, b, 0, 1, 1); /* another history, to be forgotten */
  OK(gh_rve_load(b, saved, size));
  for (int k = 4; k <= 5; k++) {
    deformation(k, F);
    OK(gh_rve_evaluate(a, F, 0, P, NULL));
    OK(gh_rve_evaluate(b, F, 0, Q, NULL));
    assert_memory_equal(P, Q, sizeof P);
    NEAR("dissipation", gh_rve_measure(a)->dissipation, gh_rve_measure(b)->dissipation, 0);
    OK(gh_rve_commit(a));
    OK(gh_rve_commit(b));
  }
  FAILS(gh_rve_load(b, saved, size - 1), GH_INPUT, "numbers");
  saved[4 + 3 * p->n + 1] +=
      0; /* the state of a packing without replicas ends elsewhere: only the size is reported */
  saved[5] = NAN;
  FAILS(gh_rve_load(b, saved, size), GH_INPUT, "not finite");
  free(saved);
  gh_rve_destroy(&a);
  gh_rve_destroy(&b);
}
static void states(void **state) {
  for_all(state, "p50d", check_states);
}

/* Friction of zero gives the frictionless stress; fixed rotations are stiffer than free ones. */
static void limits(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  for (int b = 0; b < 4; b++) {
    problem none = {GH_ENGINE_NATIVE, all_boundaries[b], {.normal_stiffness = 1000}}, zero = none,
            fixed = none, turns = none;
    zero.law = law_of(0, 0, GH_SLIP_PROJECTED);
    turns.law = fixed.law = law_of(30, 0, GH_SLIP_PROJECTED);
    fixed.law.fixed_rotations = 1;
    const problem *const all[] = {&none, &zero, &turns, &fixed};
    double s[4][4];
    for (int k = 0; k < 4; k++) {
      gh_rve *rve = open_rve(ctx, p, all[k]);
      walk(ctx, rve, 0, 10, 20);
      memcpy(s[k], gh_rve_measure(rve)->cauchy, sizeof s[k]);
      gh_rve_destroy(&rve);
    }
    NEAR("no friction", distance(s[0], s[1], 4) / norm(s[0], 4), 0, 1e-8);
    print_message("%-12s shear stress: frictionless %.4f, rotations free %.4f, fixed %.4f\n",
                  gh_boundary_name(all_boundaries[b]), s[0][1], s[2][1], s[3][1]);
    assert_true(fabs(s[3][1]) > fabs(s[2][1]) && fabs(s[2][1]) > fabs(s[0][1]));
  }
  gh_packing_destroy(&p);
}

static void bad_laws(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  gh_rve *rve;
  static const struct {
    gh_contact_law law;
    const char *words;
  } wrong[] = {
      {{.normal_stiffness = 1, .friction = 1, .tangential_stiffness = 0}, "tangential stiffness"},
      {{.normal_stiffness = 1, .friction = 1, .tangential_stiffness = 1, .friction_coefficient = -1},
       "friction coefficient"},
      {{.normal_stiffness = 1, .friction = 1, .tangential_stiffness = 1, .hardening = -1}, "hardening"},
      {{.normal_stiffness = 1, .friction = 1, .tangential_stiffness = 1, .hardening = NAN}, "hardening"}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    gh_rve_options o = gh_rve_defaults();
    o.law = wrong[k].law;
    FAILS(gh_rve_create(ctx, p, &o, &rve), GH_INPUT, wrong[k].words);
  }
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(stresses),        TEST(tangents), TEST(energies), TEST(opening_loses_what_hardening_stores),
      TEST(rigid_rotations), TEST(states),   TEST(limits),   TEST(bad_laws)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
