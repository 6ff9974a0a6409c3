/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Slip integrated along ramps against slip over whole increments, and P(F) as Newton's method meets it: steps and
 * tangent along lines. Lengths are strains over p/E_n, the overlap strain, which decides where there are ramps. */
#include "../help.h"

enum { LAWS = 2, PATHS = 5, BOUNDARIES = 2 };

static const double directions[PATHS][4] = {
    {-1, 0, 0, -1}, {-1, 0, 0, 0.5}, {0, 1, 0, 0}, {-0.5, 0.7, 0, 0.3}, {-1, 0.5, 0.2, -0.5}};
static const double identity[4] = {1, 0, 0, 1};

/* Free grains under one law on the way from the packing as read. */
typedef struct walk {
  gh_boundary boundary;
  int law;
  const double *direction;
  double strain; /* p/E_n of the packing as read */
} walk;

static gh_rve *open_walk(gh_context *ctx, const gh_packing *p, walk *w, gh_integration integration,
                         double tolerance) {
  static const gh_contact_law laws[LAWS] = {
      {.normal_stiffness = 1, .friction = 1, .tangential_stiffness = 0.8, .friction_coefficient = 0.2},
      {.normal_stiffness = 1, .friction = 1, .tangential_stiffness = 0.2, .friction_coefficient = 0.5}};
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, w->boundary, 1, tolerance);
  gh_rve *rve;
  double P[4];
  o.law = laws[w->law], o.integration = integration;
  OK(gh_rve_create(ctx, p, &o, &rve));
  OK(gh_rve_evaluate(rve, identity, 0, P, NULL));
  OK(gh_rve_commit(rve));
  w->strain = -(P[0] + P[3]) / 2;
  assert_true(w->strain > 1e-3);
  return rve;
}

/* Each of them, or one of `every`. */
static void for_walks(void **state, int every, void (*check)(gh_context *, const gh_packing *, walk *)) {
  gh_context *ctx = *state;
  static const char *const names[] = {"p20", "p50d"};
  for (int k = 0; k < 2 * LAWS * BOUNDARIES * PATHS; k += every) {
    gh_packing *p = case_packing(ctx, names[k % 2]);
    walk w = {.boundary = k / 2 % 2 ? GH_PERIODIC : GH_RESTRICTED,
              .law = k / 4 % 2,
              .direction = directions[k / 8]};
    check(ctx, p, &w);
    gh_packing_destroy(&p);
  }
}

static void along(const walk *w, double length, double F[4]) {
  for (int c = 0; c < 4; c++) F[c] = identity[c] + length * w->strain * w->direction[c];
}

/* ---- the two integrations ---- */

enum { HALVINGS = 3 };

static struct {
  int walks, ramps;
  double log_ratio[HALVINGS];
} halved;

/* Stress at the end of a path of 4.2 p/E_n in so many increments; the number of ramps. */
static int end_of_path(gh_context *ctx, const gh_packing *p, walk *w, gh_integration integration,
                       int increments, double P[4]) {
  gh_rve *rve = open_walk(ctx, p, w, integration, 1e-10);
  int ramps = 0;
  for (int k = 1; k <= increments; k++) {
    double F[4];
    along(w, 4.2 * k / increments, F);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    assert_int_equal(gh_rve_measure(rve)->settled, 0); /* no instability is crossed */
    ramps += gh_rve_measure(rve)->ramps;
    OK(gh_rve_commit(rve));
  }
  gh_rve_destroy(&rve);
  return ramps;
}

static void halve(gh_context *ctx, const gh_packing *p, walk *w) {
  double before = 0;
  for (int k = 0; k <= HALVINGS; k++) {
    double ramp[4], whole[4];
    halved.ramps += end_of_path(ctx, p, w, GH_INTEGRATION_RAMP, 1 << k, ramp);
    assert_int_equal(end_of_path(ctx, p, w, GH_INTEGRATION_WHOLE, 1 << k, whole), 0);
    const double apart = distance(ramp, whole, 4) / norm(ramp, 4);
    assert_true(apart > 0 && apart < 0.1);
    if (k > 0) halved.log_ratio[k - 1] += log(before / apart);
    before = apart;
  }
  halved.walks++;
}

/* Slip along ramps and over whole increments part by an error of the first order in the increments: in the mean
 * over packings, laws, conditions and paths, three halvings each at least nearly halve the difference, and
 * together divide it by more than eight. */
static void agree_to_first_order(void **state) {
  double all = 0;
  for_walks(state, 1, halve);
  assert_true(halved.ramps > 12 * halved.walks);
  for (int k = 0; k < HALVINGS; k++) {
    const double ratio = exp(halved.log_ratio[k] / halved.walks);
    print_message("halving %d: differences fall by %.2f\n", k + 1, ratio);
    assert_true(ratio > 1.7);
    all += halved.log_ratio[k] / halved.walks;
  }
  assert_true(exp(all) > 8);
}

/* ---- P(F) along a line ---- */

enum { POINTS = 100 };

static struct {
  double step[2]; /* the largest of P over what the tangent expects: near trials, and trials from state n */
  double tangent; /* the largest error of the tangent */
  int ramps;
} lines;

/* The tangent at the trial state `near` against central differences. */
static double tangent_error(gh_context *ctx, gh_rve *rve, const double *near, size_t size, const double F[4],
                            const double A[16], double h) {
  double worst = 0;
  for (int k = 0; k < 4; k++) {
    double G[4], P[2][4];
    for (int side = 0; side < 2; side++) {
      memcpy(G, F, sizeof G);
      G[k] += side ? h : -h;
      OK(gh_rve_evaluate_near(rve, G, near, size, 0, P[side], NULL));
    }
    for (int i = 0; i < 4; i++) worst = fmax(worst, fabs(A[4 * i + k] - (P[1][i] - P[0][i]) / (2 * h)));
  }
  return worst / norm(A, 16);
}

/* The step of P from one point to the next over |A : dF|, that of the stiffer end: a contact may change in between. */
static double step_over_expected(double P[2][4], double A[2][16], const double dF[4]) {
  double expected = 0, dP[4];
  for (int end = 0; end < 2; end++) {
    double e[4] = {0};
    for (int k = 0; k < 16; k++) e[k / 4] += A[end][k] * dF[k % 4];
    expected = fmax(expected, norm(e, 4));
  }
  for (int i = 0; i < 4; i++) dP[i] = P[1][i] - P[0][i];
  return norm(dP, 4) / expected;
}

/* From the end of three increments, trials at 0.9 to 1.0 of a fourth, in a hundred steps from 1e-6 to 1e-2 of it:
 * near the first, as Newton's method makes them, or each from state n along its own ramp. */
static void line(gh_context *ctx, const gh_packing *p, walk *w, bool from_n) {
  gh_rve *rve = open_walk(ctx, p, w, GH_INTEGRATION_RAMP, 1e-11);
  double F[4], dF[4], P[2][4], A[2][16], *near = NULL, at = 0.9;
  size_t size = 0;
  for (int k = 1; k <= 3; k++) {
    along(w, k, F);
    OK(gh_rve_evaluate(rve, F, 0, P[0], NULL));
    OK(gh_rve_commit(rve));
  }
  w->strain = -(P[0][0] + P[0][3]) / 2; /* that of state n */
  for (int k = 0; k <= POINTS; k++) {
    const double step = k ? 1e-6 * pow(1e4, (k - 1.) / (POINTS - 1)) : 0;
    double G[4];
    at += step;
    for (int c = 0; c < 4; c++) G[c] = F[c] + at * w->strain * w->direction[c];
    for (int c = 0; c < 4; c++) dF[c] = step * w->strain * w->direction[c];
    OK(gh_rve_evaluate_near(rve, G, from_n ? NULL : near, from_n ? 0 : size, GH_WANT_TANGENT, P[1], A[1]));
    assert_int_equal(gh_rve_measure(rve)->settled, 0);
    lines.ramps += gh_rve_measure(rve)->ramps;
    if (k == 0) {
      size = gh_rve_trial_size(rve);
      OK(gh_alloc(ctx, size, sizeof *near, &near));
      OK(gh_rve_save_trial(rve, near));
      lines.tangent = fmax(lines.tangent, tangent_error(ctx, rve, near, size, G, A[1], 1e-6 * w->strain));
    } else if (!from_n || step >= 1e-5) {
      lines.step[from_n] = fmax(lines.step[from_n], step_over_expected(P, A, dF));
    }
    memcpy(P[0], P[1], sizeof P[0]);
    memcpy(A[0], A[1], sizeof A[0]);
  }
  free(near);
  gh_rve_destroy(&rve);
}
static void line_near(gh_context *ctx, const gh_packing *p, walk *w) {
  line(ctx, p, w, false);
}
static void line_from_n(gh_context *ctx, const gh_packing *p, walk *w) {
  line(ctx, p, w, true);
}

/* Trials near the last one, which share a base, make P(F) as continuous as the law itself. Trials that begin at
 * state n have a ramp each, whose number of steps is an integer: steps of less than 1e-5 of the increment may miss
 * by as much as that. */
static void no_step_beyond_the_tangent(void **state) {
  for_walks(state, 1, line_near);
  print_message("near trials: largest step %.3f, tangent %.1e\n", lines.step[0], lines.tangent);
  assert_true(lines.step[0] < 1.5);
  assert_true(lines.tangent < 1e-3);
  for_walks(state, 3, line_from_n);
  print_message("trials from state n: largest step %.3f, tangent %.1e\n", lines.step[1], lines.tangent);
  assert_true(lines.step[1] < 2);
  assert_true(lines.tangent < 1e-3);
  assert_true(lines.ramps > 12 * POINTS);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(agree_to_first_order), TEST(no_step_beyond_the_tangent)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
