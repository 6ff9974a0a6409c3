/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Element tests: conditions, and a point under mixed control, with materials in closed form. */
#include "../neo_hooke.h"
#include "element_help.h"

#include "control/four.h"

/* ---- a material in closed form ----
 *
 * Neo-Hooke, P = mu (F - F^-T) + lambda ln J F^-T, with a jump that a packing has too: seen from a state with
 * F22 above jump_at, a trial below it has `jump` added to P22, and once committed there it stays so. */
typedef struct material {
  double mu, lambda, jump_at, jump;
  double limit; /* largest |F - F_n|; 0: none */
  bool jumped, trial_jumped;
  double Fn[4], F[4];
  int evaluations, commits;
} material;

static gh_status evaluate(void *point, const double F[4], unsigned want, double P[4], double A[16]) {
  material *m = point;
  (void)want;
  m->evaluations++;
  memcpy(m->F, F, sizeof m->F);
  if (m->limit > 0 && distance(F, m->Fn, 4) > m->limit) return GH_DIVERGED;
  neo_hooke_of(m->mu, m->lambda, F, P, A);
  m->trial_jumped = m->jumped || F[3] < m->jump_at;
  if (m->trial_jumped) P[3] += m->jump;
  return GH_OK;
}
static gh_status commit(void *point) {
  material *m = point;
  m->commits++;
  m->jumped = m->trial_jumped;
  memcpy(m->Fn, m->F, sizeof m->Fn);
  return GH_OK;
}
static gh_status revert(void *point) {
  material *m = point;
  m->trial_jumped = m->jumped;
  return GH_OK;
}

static gh_control *make_control(gh_context *ctx, material *m, double tolerance) {
  static const gh_point_ops ops = {.evaluate = evaluate, .commit = commit, .revert = revert};
  gh_control_options o = gh_control_defaults();
  gh_control *c;
  memcpy(m->Fn, identity, sizeof identity);
  o.stiffness = m->mu;
  o.tolerance = tolerance;
  OK(gh_control_create(ctx, &ops, m, &o, &c));
  OK(gh_control_start(c, identity));
  return c;
}

/* Zero of f in [low, high]. */
static double bisect(double (*f)(const material *, double, double), const material *m, double wanted,
                     double low, double high) {
  bool up = f(m, high, wanted) > 0;
  for (int k = 0; k < 200; k++) {
    double middle = (low + high) / 2;
    if ((f(m, middle, wanted) > 0) == up) high = middle;
    else low = middle;
  }
  return (low + high) / 2;
}

/* ---- conditions ---- */

static void test_words(void **state) {
  gh_context *ctx = *state;
  gh_condition c;
  const double F[4] = {1.1, 0.2, -0.05, 0.9}, P[4] = {-1, 0.3, 0.2, -2};
  double s[4];
  gh_cauchy2(P, F, s);
  OK(gh_condition_parse(ctx, "s22 - 0.5 s11", &c));
  assert_true(c.stress);
  NEAR("a sum of stresses", gh_condition_value(&c, F, P), s[3] - 0.5 * s[0], 1e-15);
  OK(gh_condition_parse(ctx, " -2*F12+F21 - .5 volume ", &c));
  assert_false(c.stress);
  NEAR("a sum of deformations", gh_condition_value(&c, F, P), -2 * 0.2 - 0.05 - 0.5 * (0.99 + 0.01), 1e-15);
  OK(gh_condition_parse(ctx, "pressure", &c));
  NEAR("pressure", gh_condition_value(&c, F, P), -(s[0] + s[3]) / 2, 1e-15);
  OK(gh_condition_parse(ctx, "P21", &c));
  NEAR("a Piola stress", gh_condition_value(&c, F, P), 0.2, 0);
  FAILS(gh_condition_parse(ctx, "s13", &c), GH_INPUT, "\"s13\" is no condition: unknown quantity");
  FAILS(gh_condition_parse(ctx, "s11 s22", &c), GH_INPUT, "a sign is missing");
  FAILS(gh_condition_parse(ctx, "s11 -", &c), GH_INPUT, "a quantity is missing");
  FAILS(gh_condition_parse(ctx, "", &c), GH_INPUT, "a quantity is missing");
  FAILS(gh_condition_parse(ctx, "s11 + F11", &c), GH_INPUT, "mixes stress and deformation");
  FAILS(gh_condition_parse(ctx, "s11 - s11", &c), GH_INPUT, "nothing is left");
  FAILS(gh_condition_parse(ctx, "1e999 s11", &c), GH_INPUT, "not finite");
  FAILS(gh_condition_parse(ctx, "3", &c), GH_INPUT, "F11 F12 F21 F22 volume P11");
}

/* Against central differences of the values. */
static void test_slopes(void **state) {
  gh_context *ctx = *state;
  static const char *const words[] = {"F12",
                                      "volume",
                                      "P12",
                                      "P21",
                                      "s11",
                                      "s12",
                                      "s22",
                                      "pressure",
                                      "F11 - 2 volume",
                                      "s22 - 0.3 s12 + 0.1 P11"};
  const material m = {.mu = 2, .lambda = 3};
  const double F[4] = {1.1, 0.2, -0.07, 0.85}, h = 1e-6;
  for (size_t w = 0; w < sizeof words / sizeof *words; w++) {
    gh_condition c;
    double P[4], A[16], B[16], slope[4];
    OK(gh_condition_parse(ctx, words[w], &c));
    neo_hooke_of(m.mu, m.lambda, F, P, A);
    gh_condition_slope(&c, F, P, A, slope);
    for (int a = 0; a < 4; a++) {
      double G[4], value[2];
      for (int side = 0; side < 2; side++) {
        memcpy(G, F, sizeof G);
        G[a] += side ? -h : h;
        neo_hooke_of(m.mu, m.lambda, G, P, B);
        value[side] = gh_condition_value(&c, G, P);
      }
      NEAR(words[w], slope[a], (value[0] - value[1]) / (2 * h), 1e-8);
    }
  }
}

/* Matrices of order four with known inverse and known eigenvalues: V D V^-1, D of blocks [a b; -b a]. */
static void test_four(void **state) {
  (void)state;
  unsigned long long seed = 4711;
  print_message("seed %llu\n", seed);
  for (int k = 0; k < 200; k++) {
    double V[16], D[16] = {0}, VD[16] = {0}, B[16], back[16] = {0}, least = INFINITY;
    for (int a = 0; a < 16; a++) V[a] = uniform(&seed) - 0.5 + 2 * (a % 5 == 0);
    for (int b = 0; b < 2; b++) {
      double re = 2 * uniform(&seed) - 0.6, im = k % 2 ? 3 * uniform(&seed) : 0;
      D[10 * b] = D[10 * b + 5] = re, D[10 * b + 1] = im, D[10 * b + 4] = -im;
      least = fmin(least, re);
    }
    for (int a = 0; a < 16; a++)
      for (int m = 0; m < 4; m++) VD[a] += V[4 * (a / 4) + m] * D[4 * m + a % 4];
    double Vt[16], VDt[16]; /* B V = V D, solved for the rows of B */
    for (int a = 0; a < 16; a++) Vt[a] = V[4 * (a % 4) + a / 4], VDt[a] = VD[4 * (a % 4) + a / 4];
    assert_true(gh_four_solve(Vt, 4, VDt, back));
    for (int a = 0; a < 16; a++) B[a] = back[4 * (a % 4) + a / 4];
    for (int a = 0; a < 16; a++) {
      double sum = -VD[a];
      for (int m = 0; m < 4; m++) sum += B[4 * (a / 4) + m] * V[4 * m + a % 4];
      NEAR("solution", sum, 0, 1e-12);
    }
    if (fabs(least) < 1e-3) continue;
    assert_int_equal(gh_four_stable(B, 0), least > 0);
    assert_true(gh_four_stable(B, 1e-3 - least));
    assert_false(gh_four_stable(B, -1e-3 - least));
  }
  const double singular[16] = {1, 2, 3, 4, 2, 4, 6, 8, 0, 1, 0, 1, 1, 0, 1, 0}, b[4] = {1, 1, 1, 1};
  double x[4];
  assert_false(gh_four_solve(singular, 1, b, x));
}

/* ---- control of the closed form ---- */

/* Cauchy stress of F = diag(x, x). */
static double isotropic(const material *m, double x, double pressure) {
  double P = m->mu * (x - 1 / x) + m->lambda * 2 * log(x) / x;
  return P / x + pressure;
}

static void test_isotropic(void **state) {
  gh_context *ctx = *state;
  static const char *const words[4] = {"s11", "s22", "s12", "F21"};
  const double target[4] = {-0.3, -0.3, 0, 0};
  material m = {.mu = 1, .lambda = 1.5};
  gh_control *c = make_control(ctx, &m, 1e-12);
  gh_control_report r;
  OK(solve(ctx, c, words, target, &r));
  double x = bisect(isotropic, &m, 0.3, 0.5, 1.2);
  const double F[4] = {x, 0, 0, x};
  NEAR("F", distance(gh_control_F(c), F, 4), 0, 1e-11);
  assert_int_equal(r.parts, 1);
  assert_int_equal(r.cuts + r.jumps, 0);
  assert_true(r.mismatch <= 1e-12 && r.iterations <= 6);
  gh_control_destroy(&c);
}

/* Wanted: s11 of diag(x, y) with y given. */
static double height;
static double side_stress(const material *m, double x, double wanted) {
  double P = m->mu * (x - 1 / x) + m->lambda * log(x * height) / x;
  return P / height - wanted;
}

static void test_biaxial(void **state) {
  gh_context *ctx = *state;
  static const char *const words[4] = {"F22", "s11", "s12", "F12 - F21"};
  material m = {.mu = 1, .lambda = 1.5};
  gh_control *c = make_control(ctx, &m, 1e-12);
  for (height = 0.99; height > 0.8; height -= 0.03) {
    const double target[4] = {height, -0.1, 0, 0};
    OK(solve(ctx, c, words, target, NULL));
    const double F[4] = {bisect(side_stress, &m, -0.1, 0.5, 2), 0, 0, height};
    NEAR("F", distance(gh_control_F(c), F, 4), 0, 1e-11);
  }
  gh_control_destroy(&c);
}

static void test_isochoric(void **state) {
  gh_context *ctx = *state;
  static const char *const words[4] = {"volume", "F12", "s11 - s22", "F21"};
  material m = {.mu = 1, .lambda = 1.5};
  gh_control *c = make_control(ctx, &m, 1e-10);
  for (double shear = 0.1; shear < 1; shear += 0.1) {
    const double target[4] = {1, shear, 0, 0};
    OK(solve(ctx, c, words, target, NULL));
    /* s = mu (F F^T - 1) at J = 1, so s11 = s22 is F11^2 + F12^2 = 1/F11^2 */
    double b = shear * shear, F11 = sqrt((-b + sqrt(b * b + 4)) / 2);
    NEAR("J", gh_det2(gh_control_F(c)), 1, 1e-13);
    NEAR("F12", gh_control_F(c)[1], shear, 1e-15);
    NEAR("F11", gh_control_F(c)[0], F11, 1e-10);
  }
  gh_control_destroy(&c);
}

static double confined(const material *m, double y, double wanted) { /* P22 of diag(1, y) */
  return m->mu * (y - 1 / y) + m->lambda * log(y) / y - wanted;
}

/* A stress in the gap of a jump: P22 goes from above to below it at F22 = 0.95. The packing hardens there
 * (the jump is pressure) and is met beyond, with the jump committed; counted. */
static void test_jump(void **state) {
  gh_context *ctx = *state;
  static const char *const words[4] = {"P22", "F11", "F12", "F21"};
  const material bistable = {.mu = 1, .lambda = 1.5, .jump_at = 0.95};
  double edge = confined(&bistable, 0.95, 0);
  for (int soft = 0; soft < 2; soft++) {
    material m = bistable;
    m.jump = soft ? 0.1 : -0.1; /* soft: carries less beyond, so that it has to continue far */
    double wanted = soft ? edge - 0.01 : edge - 0.05;
    const double target[4] = {wanted, 1, 0, 0};
    gh_control *c = make_control(ctx, &m, 1e-10);
    gh_control_report r;
    OK(solve(ctx, c, words, target, &r));
    NEAR("P22", gh_control_P(c)[3], wanted, 1e-10);
    assert_true(m.jumped);
    double y = bisect(confined, &bistable, wanted - m.jump, 0.5, 1.2);
    NEAR("F22", gh_control_F(c)[3], y, 1e-9);
    if (!soft) assert_true(r.jumps >= 1 && r.cuts >= 2);
    gh_control_destroy(&c);
  }
}

static void test_stop_at_jump(void **state) {
  gh_context *ctx = *state;
  static const gh_point_ops ops = {.evaluate = evaluate, .commit = commit, .revert = revert};
  static const char *const words[4] = {"P22", "F11", "F12", "F21"};
  material m = {.mu = 1, .lambda = 1.5, .jump_at = 0.95, .jump = -0.1};
  const double target[4] = {confined(&m, 0.95, 0) - 0.05, 1, 0, 0};
  gh_control_options o = gh_control_defaults();
  gh_control *c;
  gh_control_report r;
  o.stiffness = 1;
  o.pass_jumps = false;
  memcpy(m.Fn, identity, sizeof identity);
  OK(gh_control_create(ctx, &ops, &m, &o, &c));
  OK(gh_control_start(c, identity));
  FAILS(solve(ctx, c, words, target, &r), GH_DIVERGED,
        "no equilibrium after 6 bisections and 0 instabilities");
  assert_false(m.jumped);
  assert_true(gh_control_F(c)[3] >= 0.95); /* the last committed part */
  assert_true(r.mismatch > 1e-3);
  gh_control_destroy(&c);
}

/* A point that gives no answer for large increments: parts are halved, and what comes out is the same. */
static void test_cuts(void **state) {
  gh_context *ctx = *state;
  static const char *const words[4] = {"s11", "s22", "s12", "F21"};
  const double target[4] = {-0.3, -0.3, 0, 0};
  material m = {.mu = 1, .lambda = 1.5, .limit = 0.02};
  gh_control *c = make_control(ctx, &m, 1e-12);
  gh_control_report r;
  OK(solve(ctx, c, words, target, &r));
  NEAR("F", gh_control_F(c)[0], bisect(isotropic, &m, 0.3, 0.5, 1.2), 1e-11);
  assert_true(r.cuts >= 2 && r.parts >= 4 && r.jumps == 0);
  gh_control_destroy(&c);
}

/* A point that answers nothing but where it is; and a packing that is pulled, which carries nothing. */
static void test_given_up(void **state) {
  gh_context *ctx = *state;
  static const char *const words[4] = {"s11", "s22", "s12", "F21"};
  const double target[4] = {-0.3, -0.3, 0, 0}, tension[4] = {1, 1, 0, 0};
  material stiff = {.mu = 1, .lambda = 1.5, .limit = 1e-12};
  gh_control_report r;
  gh_control *c = make_control(ctx, &stiff, 1e-6);
  FAILS(solve(ctx, c, words, target, &r), GH_DIVERGED, "servo control met 12 failures");
  assert_int_equal(r.cuts, 6);
  assert_int_equal(stiff.commits, 1); /* the start */
  NEAR("F", distance(gh_control_F(c), identity, 4), 0, 0);
  NEAR("mismatch", r.mismatch, 1, 1e-12);
  gh_control_destroy(&c);

  if (!use_engine(GH_ENGINE_NATIVE)) return;
  gh_packing *p = lattice(ctx, 2, 0.5);
  gh_rve *rve = make_rve(ctx, p, GH_ENGINE_NATIVE, GH_PERIODIC, 100, 1e-10);
  gh_control_options o = gh_control_defaults();
  o.stiffness = 100;
  OK(gh_control_create_rve(ctx, rve, &o, &c));
  OK(gh_control_start(c, identity));
  FAILS(solve(ctx, c, words, tension, &r), GH_DIVERGED,
        "does not come to rest under these conditions: after 1000 steps");
  NEAR("P", norm(gh_control_P(c), 4), 0, 0);
  gh_control_destroy(&c);
  gh_rve_destroy(&rve);
  gh_packing_destroy(&p);
}

static bool at_once(void *data) {
  return --*(int *)data < 0;
}

static void test_refused(void **state) {
  gh_context *ctx = *state;
  static const gh_point_ops ops = {.evaluate = evaluate, .commit = commit, .revert = revert};
  static const char *const twice[4] = {"s11", "2 s11", "s12", "F21"},
                           *const turns[4] = {"s11", "s22", "s12", "P11"},
                           *const good[4] = {"s11", "s22", "s12", "F21"};
  const double zero[4] = {0}, bad[4] = {0, NAN, 0, 0}, load[4] = {-0.1, -0.1, 0, 0};
  material m = {.mu = 1, .lambda = 1.5};
  gh_control_options o = gh_control_defaults();
  gh_control *c;
  FAILS(gh_control_create(ctx, &ops, &m, &o, &c), GH_INPUT, "stiffness of the control must be positive");
  assert_null(c);
  o.stiffness = 1, o.tolerance = 1;
  FAILS(gh_control_create(ctx, &ops, &m, &o, &c), GH_INPUT, "between 0 and 1");
  o.tolerance = 1e-8;
  OK(gh_control_create(ctx, &ops, &m, &o, &c));
  FAILS(solve(ctx, c, good, zero, NULL), GH_INPUT, "no state to begin with");
  gh_control_destroy(&c);
  c = make_control(ctx, &m, 1e-8);
  FAILS(solve(ctx, c, twice, zero, NULL), GH_INPUT, "do not determine F");
  FAILS(solve(ctx, c, turns, zero, NULL), GH_INPUT, "do not determine F");
  FAILS(solve(ctx, c, good, bad, NULL), GH_INPUT, "target of condition 2");
  int left = 2, commits = m.commits;
  gh_control_set_stop(c, at_once, &left);
  FAILS(solve(ctx, c, good, load, NULL), GH_STOPPED, "stopped on request");
  assert_int_equal(m.commits, commits);
  gh_control_destroy(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_words),     TEST(test_slopes),       TEST(test_four),
                                     TEST(test_isotropic), TEST(test_biaxial),      TEST(test_isochoric),
                                     TEST(test_jump),      TEST(test_stop_at_jump), TEST(test_cuts),
                                     TEST(test_given_up),  TEST(test_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
