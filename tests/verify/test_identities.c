/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Identities that hold for every correct RVE, on the packings of the reference cases, for all boundary
 * conditions and both engines. */
#include "../help.h"

static const char *const packings[] = {"p50", "p150", "p150d", "block150"};
enum { NPACKINGS = sizeof packings / sizeof *packings };

/* One identity on one packing, with one engine and one boundary condition. */
typedef struct problem {
  gh_context *ctx;
  const gh_packing *p;
  const char *name;
  gh_engine_kind engine;
  gh_boundary boundary;
} problem;

static void for_all(gh_context *ctx, void (*check)(const problem *)) {
  for (int k = 0; k < NPACKINGS; k++) {
    gh_packing *p = case_packing(ctx, packings[k]);
    for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)
      for (int b = 0; b < 4; b++)
        if (use_engine(e)) check(&(problem){ctx, p, packings[k], e, all_boundaries[b]});
    gh_packing_destroy(&p);
  }
}

static gh_rve *open_rve(const problem *q, double tolerance) {
  return make_rve(q->ctx, q->p, q->engine, q->boundary, 1000, tolerance);
}

static bool relaxes(const problem *q) {
  return q->boundary == GH_RESTRICTED || q->boundary == GH_PERIODIC;
}

/* States which problem it is and what came out; fails beyond the limit. */
static void judge(const problem *q, const char *what, double value, double limit) {
  if (value <= limit) return;
  print_error("%s, %s, %s: %s %.3g, at most %.3g is allowed\n", q->name, engine_names[q->engine],
              gh_boundary_name(q->boundary), what, value, limit);
  fail();
}

/* Compression with shear in `steps` committed steps, up to F = (1 - s) [1 + shear]. */
static void deformation(double s, double F[4]) {
  F[0] = 1 - s, F[1] = 0.6 * s, F[2] = -0.2 * s, F[3] = 1 - 0.7 * s;
}
static void walk(const problem *q, gh_rve *rve, double s, int steps) {
  double F[4], P[4];
  for (int k = 1; k <= steps; k++) {
    deformation(s * k / steps, F);
    gh_context *ctx = q->ctx;
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_commit(rve));
  }
}

static void check_two_forms(const problem *q) {
  gh_context *ctx = q->ctx;
  gh_rve *rve = open_rve(q, 1e-11);
  for (int k = 0; k <= 4; k++) {
    double F[4], P[4], B[4];
    deformation(0.004 * k, F);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_boundary_stress(rve, B));
    const gh_rve_measures *m = gh_rve_measure(rve);
    double largest =
        fmax(norm(P, 4), m->mean_force); /* per unit of length: the scale of a stress that nearly vanishes */
    judge(q, "contact form - boundary form over P:", distance(P, B, 4) / largest, 1e-9);
    judge(q, "asymmetry of the Cauchy stress:", fabs(m->cauchy[1] - m->cauchy[2]) / largest, 1e-11);
    double s[4], J = gh_det2(F);
    for (int n = 0; n < 4; n++)
      s[n] = (P[n / 2 * 2] * F[n % 2 * 2] + P[n / 2 * 2 + 1] * F[n % 2 * 2 + 1]) / J;
    judge(q, "Cauchy - P F^T / J:", distance(s, m->cauchy, 4) / largest, 1e-13);
    OK(gh_rve_commit(rve));
  }
  gh_rve_destroy(&rve);
}

/* The contact form (5.6) and the boundary form (5.16, 5.19, 5.22) of the stress agree in equilibrium, and the
 * Cauchy stress is symmetric. */
static void two_forms_of_the_stress(void **state) {
  for_all(*state, check_two_forms);
}

/* Difference of the energies at the ends minus the integral of P : dF by the trapezoidal rule, n sub-steps,
 * over the mean. */
static double work_error(const problem *q, double from, double to, int n) {
  gh_context *ctx = q->ctx;
  gh_rve *rve = open_rve(q, 1e-11);
  double last[4] = {0}, P[4], F[4], G[4], work = 0, start = 0;
  walk(q, rve, from, 10);
  deformation(from, G);
  for (int k = 0; k <= n; k++) {
    deformation(from + (to - from) * k / n, F);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_commit(rve));
    if (k == 0) start = gh_rve_measure(rve)->energy;
    else
      for (int c = 0; c < 4; c++) work += (P[c] + last[c]) / 2 * (F[c] - G[c]);
    memcpy(last, P, sizeof P);
    memcpy(G, F, sizeof F);
  }
  double end = gh_rve_measure(rve)->energy;
  gh_rve_destroy(&rve);
  return (end - start - work) / work;
}

static void check_hill_mandel(const problem *q) {
  if (q->boundary == GH_PERIODIC && strcmp(q->name, "p150d"))
    return; /* the others rearrange, and dissipate, on the way */
  double from = 0.012, to = 0.0125, e1 = work_error(q, from, to, 8), e2 = work_error(q, from, to, 32);
  judge(q, "energy - work, 8 sub-steps:", fabs(e1), 1e-4);
  judge(q, "energy - work, 32 sub-steps:", fabs(e2), 1e-5);
  if (fabs(e2) > 1e-9)
    judge(q, "error of 32 sub-steps over that of 8 (second order: 1/16):", fabs(e2 / e1), 0.125);
}

/* Hill-Mandel: the energy gained along a path is the integral of P : dF, to second order in the sub-steps. */
static void hill_mandel(void **state) {
  for_all(*state, check_hill_mandel);
}

static void check_objectivity(const problem *q) {
  gh_context *ctx = q->ctx;
  gh_rve *straight = open_rve(q, 1e-12), *turned = open_rve(q, 1e-12), *turning = open_rve(q, 1e-12);
  const int steps = 6;
  for (int k = 1; k <= steps; k++) {
    double F[4], Q[4], R[4], QF[4], RF[4], P[4], PQ[4], PR[4], QP[4], RP[4], A[16], AQ[16], QA[16];
    deformation(0.002 * k, F);
    rotation(help_pi / 6, Q);             /* from the start */
    rotation(help_pi / 6 * k / steps, R); /* in steps */
    gh_mul2(Q, F, QF);
    gh_mul2(R, F, RF);
    OK(gh_rve_evaluate(straight, F, GH_WANT_TANGENT, P, A));
    OK(gh_rve_evaluate(turned, QF, GH_WANT_TANGENT, PQ, AQ));
    OK(gh_rve_evaluate(turning, RF, 0, PR, NULL));
    gh_mul2(Q, P, QP);
    gh_mul2(R, P, RP);
    double largest = fmax(norm(P, 4), gh_rve_measure(straight)->mean_force);
    judge(q, "P(QF) - Q P(F) over P:", distance(PQ, QP, 4) / largest, 1e-8);
    judge(q, "P(RF) - R P(F) over P, in steps:", distance(PR, RP, 4) / largest, 1e-8);
    for (int n = 0; n < 16; n++) { /* A(QF)_iJkL = Q_ia Q_kc A_aJcL */
      QA[n] = 0;
      for (int a = 0; a < 2; a++)
        for (int c = 0; c < 2; c++)
          QA[n] +=
              Q[2 * (n >> 3) + a] * Q[2 * (n >> 1 & 1) + c] * A[8 * a + 4 * (n >> 2 & 1) + 2 * c + (n & 1)];
    }
    if (!gh_rve_measure(straight)->regularised)
      judge(q, "tangent turned:", distance(AQ, QA, 16) / norm(A, 16), 1e-7);
    OK(gh_rve_commit(straight));
    OK(gh_rve_commit(turned));
    OK(gh_rve_commit(turning));
  }
  gh_rve_destroy(&straight);
  gh_rve_destroy(&turned);
  gh_rve_destroy(&turning);
}

/* Objectivity: P(QF) = Q P(F) for a rotation of 30 degrees, applied from the start and in steps, and the
 * tangent turns along. */
static void objectivity(void **state) {
  for_all(*state, check_objectivity);
}

/* Number of the contacts between grains that carry, and a sum that changes when another pair touches. */
static unsigned long long network(const problem *q, gh_rve *rve) {
  gh_context *ctx = q->ctx;
  gh_rve_view v;
  unsigned long long sum = 1;
  OK(gh_rve_look(rve, &v));
  for (int c = 0; c < v.ncontacts; c++) {
    int i = v.contacts[c].i, j = v.contacts[c].j;
    if (relaxes(q) && ((v.flags[i] | v.flags[j]) & 1)) continue;
    sum = sum * 6364136223846793005ull + (unsigned long long)i * 4096 + (unsigned long long)j;
  }
  return sum;
}

/* Central differences of the re-equilibrated stress; false when a contact opens or closes within the
 * difference. */
static bool differences(const problem *q, gh_rve *rve, const double F[4], double h, unsigned long long same,
                        double D[16]) {
  gh_context *ctx = q->ctx;
  for (int kL = 0; kL < 4; kL++) {
    double G[4], P[2][4];
    for (int side = 0; side < 2; side++) {
      memcpy(G, F, sizeof G);
      G[kL] += side ? -h : h;
      OK(gh_rve_evaluate(rve, G, 0, P[side], NULL));
      if (network(q, rve) != same) return false;
    }
    for (int iJ = 0; iJ < 4; iJ++) D[4 * iJ + kL] = (P[0][iJ] - P[1][iJ]) / (2 * h);
  }
  return true;
}

static void check_tangent(const problem *q) {
  gh_context *ctx = q->ctx;
  gh_rve *rve = open_rve(q, 1e-12);
  static const double steps[] = {1e-5, 3e-6, 1e-6, 3e-7};
  int checked = 0;
  for (int k = 1; k <= 6; k++) {
    double F[4], P[4], A[16], D[16];
    deformation(0.0025 * k, F);
    OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
    double A0 = norm(A, 16), skew = 0;
    for (int n = 0; n < 4; n++)
      for (int m = 0; m < 4; m++) skew = fmax(skew, fabs(A[4 * n + m] - A[4 * m + n]));
    judge(q, "major symmetry of A:", skew / A0, 1e-12);
    bool regular = !gh_rve_measure(rve)->regularised;
    double best = INFINITY; /* long differences feel the curvature, short ones the residual */
    unsigned long long same = network(q, rve);
    for (int s = 0; s < 4 && regular && !(best <= 1e-7); s++)
      if (differences(q, rve, F, steps[s], same, D)) best = fmin(best, distance(A, D, 16) / A0);
    if (best < INFINITY) {
      judge(q, "A - differences over A:", best, 1e-6);
      checked++;
    }
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_commit(rve));
  }
  if (checked < 3)
    fail_msg("%s, %s: only %d tangents could be checked", q->name, gh_boundary_name(q->boundary), checked);
  gh_rve_destroy(&rve);
}

/* The tangent is the central difference of the re-equilibrated stress, where no contact changes, and has
 * major symmetry. */
static void tangent_is_the_derivative(void **state) {
  for_all(*state, check_tangent);
}

static double energy_of(const problem *q, gh_boundary boundary, const double F[4]) {
  gh_context *ctx = q->ctx;
  double P[4];
  gh_rve *rve = make_rve(ctx, q->p, q->engine, boundary, 1000, 1e-10);
  OK(gh_rve_evaluate(rve, F, 0, P, NULL));
  double energy = gh_rve_measure(rve)->energy;
  gh_rve_destroy(&rve);
  return energy;
}

static void check_bounds(const problem *q) {
  if (q->boundary != GH_PERIODIC) return; /* once for each packing */
  for (int k = 0; k < 4; k++) {
    double F[4];
    deformation(0.005 * k, F);
    double taylor = energy_of(q, GH_TAYLOR, F), restricted = energy_of(q, GH_RESTRICTED, F);
    double cell = energy_of(q, GH_TAYLOR_CELL, F), periodic = energy_of(q, GH_PERIODIC, F);
    judge(q, "restricted - taylor (cluster):", restricted - taylor, 0);
    judge(q, "periodic - taylor-cell (cell):", periodic - cell, 0);
    judge(q, "periodic - restricted:", periodic - restricted, 0);
  }
}

/* The more freedom, the less energy, in one step from the reference. Like with like: Taylor and restricted
 * Taylor sum over the cluster, Taylor on the cell and periodic over the cell (each contact once). The
 * restricted state is also one that periodic conditions allow, and the cluster counts each contact of the
 * cell at least once: so periodic is below restricted, too. */
static void freedom_costs_no_energy(void **state) {
  for_all(*state, check_bounds);
}

/* LAMMPS and the native engine agree to 1e-9 along a path, in stress, energy and tangent. */
static void engines_agree(void **state) {
  gh_context *ctx = *state;
  if (!use_engine(GH_ENGINE_LAMMPS) || !use_engine(GH_ENGINE_NATIVE)) skip();
  for (int k = 0; k < NPACKINGS; k++) {
    gh_packing *p = case_packing(ctx, packings[k]);
    for (int b = 0; b < 4; b++) {
      problem q = {ctx, p, packings[k], GH_ENGINE_LAMMPS, all_boundaries[b]};
      gh_rve *lammps = make_rve(ctx, p, GH_ENGINE_LAMMPS, all_boundaries[b], 1000, 1e-11);
      gh_rve *native = make_rve(ctx, p, GH_ENGINE_NATIVE, all_boundaries[b], 1000, 1e-11);
      for (int step = 0; step <= 8; step++) {
        double F[4], P[4], A[16], Pn[4], An[16];
        deformation(0.002 * step, F);
        OK(gh_rve_evaluate(lammps, F, GH_WANT_TANGENT, P, A));
        OK(gh_rve_evaluate(native, F, GH_WANT_TANGENT, Pn, An));
        const gh_rve_measures *m = gh_rve_measure(native), *l = gh_rve_measure(lammps);
        judge(&q, "LAMMPS - native, P:", distance(P, Pn, 4) / fmax(norm(Pn, 4), m->mean_force), 1e-9);
        judge(&q, "LAMMPS - native, A:", distance(A, An, 16) / norm(An, 16), 1e-8);
        judge(&q, "LAMMPS - native, energy:", fabs(l->energy - m->energy) / m->energy, 1e-9);
        OK(gh_rve_commit(lammps));
        OK(gh_rve_commit(native));
      }
      gh_rve_destroy(&lammps);
      gh_rve_destroy(&native);
    }
    gh_packing_destroy(&p);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(two_forms_of_the_stress), TEST(hill_mandel),  TEST(objectivity), TEST(tangent_is_the_derivative),
      TEST(freedom_costs_no_energy), TEST(engines_agree)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
