/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Coulomb friction by return mapping: closed forms of two grains, balances, and the derivative against
 * differences. */
#include "../help.h"

#include "contact/coulomb.h"

static const gh_contact_law LAW = {
    .normal_stiffness = 100, .friction = 1, .tangential_stiffness = 80, .friction_coefficient = 0.3};

/* Two grains at a fixed distance along x, of which the second is moved tangentially only by rotation: the
 * slip is q |l| / (r_i + r_j) exactly. */
static gh_coulomb_result turned(const gh_contact_law *law, double overlap, double q,
                                const gh_coulomb_result *n) {
  gh_coulomb_step s = {.l = {2 - overlap, 0}, .d = 2 - overlap, .reach = 2, .ln = {2 - overlap, 0}, .q = q};
  if (n) s.gamma = n->gamma, s.gamma_pl = n->gamma_pl, s.alpha = n->alpha;
  gh_coulomb_result r;
  gh_coulomb_evaluate(law, &s, &r);
  return r;
}

/* Stick below the limit with slope E_t, then the limit; with hardening the slope E_t h/(E_t + h), where
 * proportional hardening has f_n times its own h; unloading is elastic. What slip takes is dissipated or, by the
 * printed law, stored. */
static void closed_forms(void **state) {
  (void)state;
  const double e = 0.01, s = (2 - e) / 2, fn = 100 * e, limit = 0.3 * fn;
  for (int k = 0; k < 3; k++) {
    const double h = k ? 20 : 0;
    gh_contact_law law = LAW;
    law.hardening = k == 2 ? h / fn : h;
    law.hardening_law = k == 2 ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
    const double slope = k ? 80.0 * 20 / 100 : 0, q_limit = limit / (80 * s);
    gh_coulomb_result a = turned(&law, e, 0.5 * q_limit, NULL);
    NEAR("stick", a.force, 0.5 * limit, 1e-12);
    assert_int_equal(a.slides, 0);
    NEAR("normal force", a.f[0], -fn, 1e-12);
    NEAR("tangential force", a.f[1], -a.force, 1e-12); /* c = 1: the branch has not turned */
    NEAR("couple", a.couple, s * a.force, 1e-12);
    gh_coulomb_result b = turned(&law, e, 2.5 * q_limit, &a); /* gamma = 3 gamma_limit in two steps */
    NEAR("slip", b.force, limit + slope * 2 * limit / 80, 1e-12);
    assert_int_equal(b.slides, 1);
    NEAR("limit with hardening", b.force, limit + h * b.alpha, 1e-12);
    NEAR("stored", gh_coulomb_energy(&law, &b),
         b.force * b.force / 160 + (k == 1 ? h * b.alpha * b.alpha / 2 : 0), 1e-14);
    NEAR("dissipated", gh_coulomb_dissipated(&law, &b, e), (k == 2 ? b.force : limit) * b.alpha, 1e-14);
    gh_coulomb_result c = turned(&law, e, -0.5 * q_limit, &b);
    NEAR("unloading", c.force, b.force - 0.5 * limit, 1e-12);
    assert_int_equal(c.slides, 0);
    NEAR("no change of the history", c.gamma_pl, b.gamma_pl, 0);
    gh_coulomb_result d = turned(&law, e, -10 * q_limit, &c);
    assert_int_equal(d.slides, -1);
    NEAR("reversed", d.force, -(limit + h * d.alpha), 1e-12);
    /* one step or many: at constant normal force the law is rate independent and has no step error */
    gh_coulomb_result many = a;
    for (int i = 0; i < 100; i++) many = turned(&law, e, 0.025 * q_limit, &many);
    NEAR("many steps", many.force, b.force, 1e-12);
  }
}

/* Two grains that have slid are parted. The force of the printed law jumps from h alpha to none where they part;
 * the proportional one follows the normal force down, and so does the stiffness. */
static void opening(void **state) {
  (void)state;
  for (int proportional = 0; proportional < 2; proportional++) {
    gh_contact_law law = LAW;
    law.hardening = 20;
    law.hardening_law = proportional ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
    const gh_coulomb_result slid = turned(&law, 0.01, 0.05, NULL);
    for (double e = 1e-3; e > 1e-12; e /= 10) {
      const gh_coulomb_step s = {.l = {2 - e, 0},
                                 .d = 2 - e,
                                 .reach = 2,
                                 .ln = {2 - e, 0},
                                 .gamma = slid.gamma,
                                 .gamma_pl = slid.gamma_pl - 0.05,
                                 .alpha = slid.alpha};
      gh_coulomb_result r;
      double d[9];
      gh_coulomb_evaluate(&law, &s, &r);
      gh_coulomb_derivative(&law, &s, &r, d);
      assert_true(r.slides && r.alpha > slid.alpha && slid.alpha > 0.02);
      const double fn = 100 * e, added = 20 * r.alpha;
      NEAR("force", r.force, proportional ? fn * (0.3 + added) : fn * 0.3 + added, 1e-12);
      const double h = proportional ? 20 * fn : 20, ratio = (2 - e) / 2;
      NEAR("stiffness", d[8], ratio * ratio * 80 * h / (80 + h), 1e-12);
      NEAR("stored by hardening", gh_coulomb_energy(&law, &r) - r.force * r.force / 160,
           proportional ? 0 : 10 * r.alpha * r.alpha, 1e-13);
    }
  }
}

/* Slid while the normal force changes: work of the tangential force, f_t dgamma, is stored or dissipated but for
 * an error of the first order in the steps. */
static double slip_work_missing(const gh_contact_law *law, int steps) {
  gh_coulomb_result r = {.force = 0};
  double work = 0, dissipated = 0;
  for (int k = 1; k <= steps; k++) {
    const double share = (double)k / steps, e = 0.01 + 0.006 * sin(7 * share), before = r.force,
                 from = r.gamma;
    r = turned(law, e, 0.05 / steps, &r);
    work += 0.5 * (before + r.force) * (r.gamma - from);
    dissipated += gh_coulomb_dissipated(law, &r, e);
  }
  assert_true(dissipated > 0.2 * work);
  return fabs(work - dissipated - gh_coulomb_energy(law, &r)) / work;
}
static void slip_work(void **state) {
  (void)state;
  for (int proportional = 0; proportional < 2; proportional++) {
    gh_contact_law law = LAW;
    law.hardening = 10;
    law.hardening_law = proportional ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
    const double coarse = slip_work_missing(&law, 200), fine = slip_work_missing(&law, 400);
    print_message("missing %g, %g\n", coarse, fine);
    assert_true(coarse < 0.02 && fine < 0.6 * coarse);
  }
}

static gh_coulomb_step random_step(unsigned long long *seed, double slip) {
  gh_coulomb_step s = {.reach = 1.5 + uniform(seed)};
  double a = 6.3 * uniform(seed), b = a + 0.1 * (uniform(seed) - 0.5);
  s.d = s.reach * (1 - 0.05 * uniform(seed) - 1e-3);
  double dn = s.reach * (1 + 0.02 * (uniform(seed) - 0.5));
  s.l[0] = s.d * cos(a), s.l[1] = s.d * sin(a);
  s.ln[0] = dn * cos(b), s.ln[1] = dn * sin(b);
  s.q = slip * (uniform(seed) - 0.5);
  s.gamma = 0.01 * (uniform(seed) - 0.5);
  s.gamma_pl = 0.01 * (uniform(seed) - 0.5);
  s.alpha = 0.01 * uniform(seed);
  return s;
}

static void evaluate_at(const gh_contact_law *law, gh_coulomb_step s, const double du[3], double out[3],
                        int *slides) {
  s.l[0] += du[0], s.l[1] += du[1], s.q += du[2];
  s.d = hypot(s.l[0], s.l[1]);
  gh_coulomb_result r;
  gh_coulomb_evaluate(law, &s, &r);
  out[0] = r.f[0], out[1] = r.f[1], out[2] = r.couple;
  *slides = r.slides;
}

/* In stick and slip, with and without hardening, for both measures of slip. */
static void derivative(void **state) {
  (void)state;
  unsigned long long seed = 11;
  print_message("seed %llu\n", seed);
  int stick = 0, slip = 0;
  for (int trial = 0; trial < 2000; trial++) {
    gh_contact_law law = LAW;
    law.hardening = trial & 1 ? 30 * uniform(&seed) : 0;
    law.slip = trial & 2 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
    law.hardening_law = trial & 8 ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
    gh_coulomb_step s = random_step(&seed, trial & 4 ? 0.5 : 0.02);
    gh_coulomb_result r;
    gh_coulomb_evaluate(&law, &s, &r);
    double d9[9], h = 1e-6;
    gh_coulomb_derivative(&law, &s, &r, d9);
    for (int k = 0; k < 3; k++) {
      double du[3] = {0}, up[3], down[3];
      int a, b;
      du[k] = h;
      evaluate_at(&law, s, du, up, &a);
      du[k] = -h;
      evaluate_at(&law, s, du, down, &b);
      if (a != r.slides || b != r.slides) continue; /* a kink */
      for (int i = 0; i < 3; i++) NEAR("derivative", d9[3 * i + k], (up[i] - down[i]) / (2 * h), 1e-6 * 100);
      *(r.slides ? &slip : &stick) += 1;
    }
  }
  assert_true(stick > 500 && slip > 500);
}

/* Moments of the contact about any point: l x (-f) of the forces against the couples (method 8.8); and the
 * same contact seen from the other grain. */
static void balance(void **state) {
  (void)state;
  unsigned long long seed = 12;
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < 1000; trial++) {
    gh_contact_law law = LAW;
    law.hardening = 30 * uniform(&seed);
    law.slip = trial & 1 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
    law.hardening_law = trial & 2 ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
    gh_coulomb_step s = random_step(&seed, 0.2);
    gh_coulomb_result r, back;
    gh_coulomb_evaluate(&law, &s, &r);
    double arm = -(s.l[0] * r.f[1] - s.l[1] * r.f[0]);
    NEAR("moments", arm - s.reach * r.couple, 0, 1e-12);
    for (int k = 0; k < 2; k++) s.l[k] = -s.l[k], s.ln[k] = -s.ln[k];
    gh_coulomb_evaluate(&law, &s, &back);
    for (int k = 0; k < 2; k++) assert_true(back.f[k] == -r.f[k]);
    assert_true(back.couple == r.couple && back.gamma == r.gamma && back.gamma_pl == r.gamma_pl);
    const double fn = 100 * (s.reach - s.d), h = (trial & 2 ? fn : 1) * law.hardening;
    assert_true(r.multiplier >= 0 && fabs(r.force) <= 0.3 * fn + h * r.alpha + 1e-12);
  }
}

/* While a contact sticks, the stiffness of an increment of no length is symmetric, whatever force it carries;
 * the asymmetry of longer increments grows with their length (method 8.12). */
static void stick_is_symmetric(void **state) {
  (void)state;
  unsigned long long seed = 13;
  print_message("seed %llu\n", seed);
  gh_contact_law law = LAW;
  law.friction_coefficient = 1e3;
  for (int trial = 0; trial < 100; trial++) {
    gh_coulomb_step s = random_step(&seed, 0);
    double turned[2] = {s.ln[0], s.ln[1]}, worst[3];
    for (int k = 0; k < 3; k++) { /* no increment, a tenth of it, all of it */
      double share = k == 0 ? 0 : k == 1 ? 0.1 : 1, d9[9];
      for (int c = 0; c < 2; c++) s.ln[c] = s.l[c] + share * (turned[c] - s.l[c]);
      gh_coulomb_result r;
      gh_coulomb_evaluate(&law, &s, &r);
      assert_int_equal(r.slides, 0);
      gh_coulomb_derivative(&law, &s, &r, d9);
      worst[k] = fmax(fabs(d9[1] - d9[3]), fmax(fabs(d9[2] - d9[6]), fabs(d9[5] - d9[7])));
    }
    assert_true(worst[0] <= 1e-12);
    assert_true(worst[1] <= 0.2 * worst[2]);
  }
}

/* A rigid rotation by b: the slip of (7.5) is |l| (b - sin b), that of the objective measure none (method
 * 8.7). */
static void rigid_rotation(void **state) {
  (void)state;
  for (int k = 0; k <= 8; k++) {
    double b = k * 0.35, l = 1.9, c;
    gh_coulomb_step s = {.l = {l * cos(b), l * sin(b)}, .d = l, .reach = 2, .ln = {l, 0}, .q = 2 * b};
    gh_contact_law law = LAW;
    NEAR("projected", gh_coulomb_slip(&law, &s, &c), l * (b - sin(b)), 1e-14);
    NEAR("c", c, cos(b), 1e-14);
    law.slip = GH_SLIP_OBJECTIVE;
    NEAR("objective", gh_coulomb_slip(&law, &s, &c), 0, 1e-14);
    NEAR("c", c, 1, 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(closed_forms),  cmocka_unit_test(opening),
                                     cmocka_unit_test(slip_work),     cmocka_unit_test(derivative),
                                     cmocka_unit_test(balance),       cmocka_unit_test(stick_is_symmetric),
                                     cmocka_unit_test(rigid_rotation)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
