/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The native engine with friction: closed forms of a few grains, balances, keys of contacts, the derivative
 * assembled over packings. */
#include "friction_help.h"

/* Two grains of radius 1 and 0.5 along x with the overlap e at n, nothing moved yet. */
static sample two_grains(double e) {
  sample s = {.n = 2, .radius = {1, 0.5}, .x_n = {3, 4, 4.5 - e, 4}, .theta_n = {0.3, -0.2}};
  memcpy(s.x, s.x_n, sizeof s.x);
  memcpy(s.theta, s.theta_n, sizeof s.theta);
  return s;
}

/* Slip by turning: f_t = E_t s q below the limit, mu f_n plus hardening above; moments -r M, M = s f_t. */
static void slip_by_turning(void **state) {
  gh_context *ctx = *state;
  const double e = 0.02, fn = 100 * e, d = 1.5 - e, scale = d / 1.5;
  for (int k = 0; k < 8; k++) {
    gh_contact_law law = LAW;
    law.hardening = k & 1 ? 20 : 0;
    law.slip = k & 2 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
    law.hardening_law = k & 4 ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
    sample s = two_grains(e);
    gh_engine *g = make_engine(ctx, &s, law, NULL);
    for (int much = 0; much < 2; much++) {
      s.theta[0] = 0.3 + (much ? 0.02 : 0.003), s.theta[1] = -0.2 + (much ? 0.01 : 0.004);
      const double gamma = scale * (much ? 0.025 : 0.005), h = (k & 4 ? fn : 1) * law.hardening,
                   ft = much ? (h * 80 * gamma + 80 * 0.3 * fn) / (80 + h) : 80 * gamma;
      gh_contact_list list = evaluate(ctx, g, &s);
      assert_int_equal(list.count, 1);
      const gh_friction *f = list.friction;
      NEAR("f_t", f->force, ft, 1e-12);
      NEAR("gamma", f->slip.gamma, gamma, 1e-15);
      NEAR("gamma_pl", f->slip.gamma_pl, gamma - ft / 80, 1e-15);
      NEAR("alpha", f->slip.alpha, gamma - ft / 80, 1e-15);
      const double alpha = gamma - ft / 80;
      NEAR("energy", f->energy, ft * ft / 160 + (k & 4 ? 0 : h * alpha * alpha / 2), 1e-14);
      NEAR("dissipated", f->dissipated, (k & 4 ? ft : 0.3 * fn) * alpha, 1e-14);
      assert_int_equal(f->slides, much);
      NEAR("f_x", list.force[0], -fn, 1e-12);
      NEAR("f_y", list.force[1], -ft, 1e-12);
      NEAR("f_x", list.force[2], fn, 1e-12);
      NEAR("f_y", list.force[3], ft, 1e-12);
      NEAR("couple", f->couple, scale * ft, 1e-12);
      NEAR("moment", list.moment[0], -scale * ft, 1e-12);
      NEAR("moment", list.moment[1], -0.5 * scale * ft, 1e-12);
      assert_true(list.contacts[0].f[0] == list.force[0] && list.contacts[0].f[1] == list.force[1]);
    }
    gh_engine_destroy(&g);
  }
}

/* Slip by moving, of a pair that touched at n, and of one that was apart: its whole way counts, and alpha
 * from an earlier contact returns. The projected slip is -|l_n| sin b, the objective one -|l_n| b. */
static void slip_by_moving(void **state) {
  gh_context *ctx = *state;
  const double e = 0.02, d = 1.5 - e, b = 0.004;
  for (int k = 0; k < 4; k++) {
    gh_contact_law law = LAW;
    law.slip = k & 1 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
    law.hardening = 25;
    const double apart = k & 2 ? 0.3 : 0, dn = d + apart, alpha = k & 2 ? 0.1 : 0;
    sample s = two_grains(e);
    s.x_n[2] += apart;
    s.x[2] = 3 + d * cos(b), s.x[3] = 4 + d * sin(b);
    s.nslips = 1;
    s.slips[0] = (gh_slip){.j = 1, .gamma = k & 2 ? 0 : 0.001, .alpha = alpha};
    gh_engine *g = make_engine(ctx, &s, law, NULL);
    gh_contact_list list = evaluate(ctx, g, &s);
    assert_int_equal(list.count, 1);
    const double gamma = (k & 2 ? 0 : 0.001) - dn * (k & 1 ? b : sin(b)), c = k & 1 ? 1 : dn / d * cos(b),
                 ft = 80 * gamma;
    assert_int_equal(list.friction->slides, 0); /* |f_t| < 0.53 <= mu f_n + h alpha */
    NEAR("gamma", list.friction->slip.gamma, gamma, 1e-15);
    NEAR("alpha", list.friction->slip.alpha, alpha, 0);
    NEAR("f_x", list.force[0], -100 * e * cos(b) + c * ft * sin(b), 1e-12);
    NEAR("f_y", list.force[1], -100 * e * sin(b) - c * ft * cos(b), 1e-12);
    NEAR("moment", list.moment[0], -c * d / 1.5 * ft, 1e-12);
    gh_engine_destroy(&g);
  }
}

/* Three grains in a row, the middle one rotated: it feels both couples and no force; the outer ones one. */
static void three_in_a_row(void **state) {
  gh_context *ctx = *state;
  sample s = {.n = 3, .radius = {1, 1, 1}, .x_n = {0, 0, 1.98, 0, 3.96, 0}};
  memcpy(s.x, s.x_n, sizeof s.x);
  s.theta[1] = 0.002;
  gh_engine *g = make_engine(ctx, &s, LAW, NULL);
  gh_contact_list list = evaluate(ctx, g, &s);
  const double ft = 80 * 0.99 * 0.002, m = -0.99 * ft;
  assert_int_equal(list.count, 2);
  for (int i = 0; i < 3; i++) {
    NEAR("moment", list.moment[i], i == 1 ? 2 * m : m, 1e-13);
    NEAR("f_y", list.force[2 * i + 1], (i - 1) * ft, 1e-13);
    NEAR("f_x", list.force[2 * i], (i - 1) * 2., 1e-12);
  }
  gh_engine_destroy(&g);
}

/* A grain and its own image: no force, the couple twice; by turning and by the turning of the lattice. */
static void own_image(void **state) {
  gh_context *ctx = *state;
  sample s = {.n = 1,
              .periodic = true,
              .radius = {1},
              .cell_n = {1.9, 0, 0, 5},
              .x_n = {7, -3},
              .x = {7.1, -3},
              .theta = {0.01}};
  gh_engine *g = make_engine(ctx, &s, LAW, NULL);
  for (int k = 0; k < 2; k++) {
    const double tilt = k * 0.01, d = hypot(1.9, tilt);
    memcpy(s.cell, (double[4]){1.9, 0, tilt, 5}, sizeof s.cell);
    s.nslips = 1;
    s.slips[0] = (gh_slip){.image = {1, 0}, .gamma = 0.003, .gamma_pl = 0.001};
    gh_contact_list list = evaluate(ctx, g, &s);
    const double gamma = 0.003 + 2 * 0.01 * d / 2 - 1.9 * tilt / d, ft = 80 * (gamma - 0.001),
                 c = 1.9 * 1.9 / (d * d);
    assert_int_equal(list.count, 1);
    assert_true(list.contacts->i == 0 && list.contacts->j == 0 && list.friction->slip.image[0] == 1 &&
                list.friction->slip.image[1] == 0);
    NEAR("gamma", list.friction->slip.gamma, gamma, 1e-15);
    NEAR("moment", list.moment[0], -2 * c * d / 2 * ft, 1e-12);
    assert_true(list.force[0] == 0 && list.force[1] == 0);
  }
  gh_engine_destroy(&g);
}

/* Two grains that touch through two images, each contact with its own history. */
static void two_images_of_a_pair(void **state) {
  gh_context *ctx = *state;
  sample s = {.n = 2,
              .periodic = true,
              .radius = {1, 1},
              .cell_n = {3.9, 0, 0, 9},
              .cell = {3.9, 0, 0, 9},
              .x_n = {0, 0, 1.96 - 3.9 * 2, 9},
              .theta = {0.001},
              .nslips = 2};
  memcpy(s.x, s.x_n, sizeof s.x);
  s.slips[0] = (gh_slip){.j = 1, .image = {1, -1}, .gamma = 0.002};
  s.slips[1] = (gh_slip){.j = 1, .image = {2, -1}, .gamma = -0.004};
  gh_engine *g = make_engine(ctx, &s, LAW, NULL);
  gh_contact_list list = evaluate(ctx, g, &s);
  assert_int_equal(list.count, 2);
  const double d[2] = {1.94, 1.96}, gamma[2] = {0.002, -0.004};
  double sum = 0;
  for (int k = 0; k < 2; k++) {
    const gh_friction *f = &list.friction[k];
    assert_true(f->slip.image[0] == 1 + k && f->slip.image[1] == -1);
    NEAR("branch", list.contacts[k].l[0], k ? d[1] : -d[0], 1e-14);
    NEAR("gamma", f->slip.gamma, gamma[k] + 0.001 * d[k] / 2, 1e-15);
    sum += 80 * (gamma[k] + 0.001 * d[k] / 2) * d[k] / 2;
  }
  NEAR("moment", list.moment[0], -sum, 1e-12);
  NEAR("moment", list.moment[1], -sum, 1e-12);
  gh_engine_destroy(&g);
}

/* Forces and moments of the grains are the sums over the contacts, each of which balances; contacts are in
 * order, lie at the image that their key names, and continue with the history that was given. */
static void balances(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 31;
  print_message("seed %llu\n", seed);
  static sample s;
  int own = 0, slides = 0, fresh = 0;
  for (int trial = 0; trial < 60; trial++) {
    draw(ctx, &seed, trial % 3 ? 1 + trial % 3 : 20, trial % 3 ? 0.5 : 0.15, trial % 4 != 3 || trial % 3, &s);
    const gh_contact_law law = random_law(&seed, trial);
    gh_engine *g = make_engine(ctx, &s, law, NULL);
    const gh_contact_list list = evaluate(ctx, g, &s);
    double f[2 * MOST] = {0}, m[MOST] = {0}, sum[2] = {0};
    for (int c = 0; c < list.count; c++) {
      const gh_contact *q = &list.contacts[c];
      const gh_friction *t = &list.friction[c];
      const double R = s.radius[q->i] + s.radius[q->j];
      NEAR("moments of a contact", -(q->l[0] * q->f[1] - q->l[1] * q->f[0]) - R * t->couple, 0, 1e-12);
      assert_true(t->slip.i == q->i && t->slip.j == q->j);
      for (int k = 0; k < 2; k++) {
        NEAR("branch", q->l[k],
             s.x[2 * q->j + k] - s.x[2 * q->i + k] + s.cell[2 * k] * t->slip.image[0] +
                 s.cell[2 * k + 1] * t->slip.image[1],
             1e-13);
        f[2 * q->i + k] += q->f[k];
        f[2 * q->j + k] -= q->f[k];
      }
      m[q->i] -= s.radius[q->i] * t->couple;
      m[q->j] -= s.radius[q->j] * t->couple;
      const double fn = 100 * q->overlap, h = (trial & 4 ? fn : 1) * law.hardening,
                   limit = 0.3 * fn + h * t->slip.alpha;
      assert_true(fabs(t->force) <= limit + 1e-12 && (t->slides == 0) == (fabs(t->force) < limit - 1e-12));
      NEAR("elastic", t->force, 80 * (t->slip.gamma - t->slip.gamma_pl), 1e-12);
      int before = 0;
      for (int b = 0; b < s.nslips; b++)
        if (s.slips[b].i == q->i && s.slips[b].j == q->j && s.slips[b].image[0] == t->slip.image[0] &&
            s.slips[b].image[1] == t->slip.image[1]) {
          before++;
          if (!t->slides) NEAR("gamma_pl", t->slip.gamma_pl, s.slips[b].gamma_pl, 0);
          NEAR("alpha", t->slip.alpha - fabs(t->slip.gamma_pl - s.slips[b].gamma_pl), s.slips[b].alpha,
               1e-14);
        }
      assert_true(before <= 1);
      fresh += !before, own += q->i == q->j, slides += t->slides;
      if (c == 0) continue;
      const gh_slip *o = &t[-1].slip;
      const int a[4] = {o->i, o->j, o->image[1], o->image[0]},
                b[4] = {q->i, q->j, t->slip.image[1], t->slip.image[0]};
      int k = 0;
      while (k < 3 && a[k] == b[k]) k++;
      assert_true(a[k] < b[k]);
    }
    for (int i = 0; i < s.n; i++) sum[0] += list.force[2 * i], sum[1] += list.force[2 * i + 1];
    NEAR("sum of forces", hypot(sum[0], sum[1]), 0, 1e-11);
    NEAR("forces", distance(f, list.force, 2 * s.n), 0, 1e-11);
    NEAR("moments", distance(m, list.moment, s.n), 0, 1e-11);
    gh_engine_destroy(&g);
  }
  assert_true(own > 15 && slides > 50 && fresh > 2);
}

/* The derivatives of the contacts, assembled over the packing, against differences in random directions. */
static void derivative_of_a_packing(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 32;
  print_message("seed %llu\n", seed);
  static sample s;
  int tried = 0, slides = 0;
  for (int trial = 0; trial < 40; trial++) {
    draw(ctx, &seed, trial % 4 ? 12 : 2, trial % 4 ? 0.2 : 0.5, true, &s);
    gh_engine *g = make_engine(ctx, &s, random_law(&seed, trial), NULL);
    double du[3 * MOST], up[3 * MOST], down[3 * MOST], exact[3 * MOST] = {0};
    int n = s.n, at[2], above[2], below[2];
    for (int k = 0; k < 3 * n; k++) du[k] = 2 * uniform(&seed) - 1;
    all_forces(ctx, g, &s, up, at);
    const gh_contact_list list = evaluate(ctx, g, &s);
    for (int c = 0; c < list.count; c++) {
      const gh_friction *t = &list.friction[c];
      const int i = t->slip.i, j = t->slip.j;
      const double dl[3] = {du[2 * j] - du[2 * i], du[2 * j + 1] - du[2 * i + 1],
                            s.radius[i] * du[2 * n + i] + s.radius[j] * du[2 * n + j]};
      double df[3] = {0};
      for (int k = 0; k < 9; k++) df[k / 3] += t->d[k] * dl[k % 3];
      for (int k = 0; k < 2; k++) exact[2 * i + k] += df[k], exact[2 * j + k] -= df[k];
      exact[2 * n + i] -= s.radius[i] * df[2];
      exact[2 * n + j] -= s.radius[j] * df[2];
    }
    const double h = 1e-7;
    sample plus = s, minus = s;
    for (int k = 0; k < 2 * n; k++) plus.x[k] += h * du[k], minus.x[k] -= h * du[k];
    for (int k = 0; k < n; k++) plus.theta[k] += h * du[2 * n + k], minus.theta[k] -= h * du[2 * n + k];
    all_forces(ctx, g, &plus, up, above);
    all_forces(ctx, g, &minus, down, below);
    gh_engine_destroy(&g);
    if (above[0] != at[0] || below[0] != at[0] || above[1] != at[1] || below[1] != at[1]) continue; /* kink */
    tried++;
    slides += at[1];
    for (int k = 0; k < 3 * n; k++) NEAR("derivative", exact[k], (up[k] - down[k]) / (2 * h), 1e-5);
  }
  assert_true(tried > 30 && slides > 50);
}

/* A grain kept a few lattice vectors away, its keys changed accordingly, feels the same. */
static void kept_in_another_cell(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 33;
  print_message("seed %llu\n", seed);
  static sample s, moved;
  int slides = 0;
  for (int trial = 0; trial < 50; trial++) {
    draw(ctx, &seed, 3 + trial % 9, 0.25, true, &s);
    moved = s;
    const int who = trial % s.n, by[2] = {trial % 5 - 2, trial % 3 - 1};
    for (int k = 0; k < 2; k++) {
      moved.x_n[2 * who + k] += s.cell_n[2 * k] * by[0] + s.cell_n[2 * k + 1] * by[1];
      moved.x[2 * who + k] += s.cell[2 * k] * by[0] + s.cell[2 * k + 1] * by[1];
    }
    for (int c = 0; c < s.nslips; c++) { /* all images of a pair move alike: the order stays */
      gh_slip *q = &moved.slips[c];
      for (int k = 0; k < 2; k++) q->image[k] += by[k] * ((q->i == who) - (q->j == who));
    }
    gh_engine *g = make_engine(ctx, &s, random_law(&seed, trial), NULL);
    double a[3 * MOST], b[3 * MOST];
    int na[2], nb[2];
    all_forces(ctx, g, &s, a, na);
    all_forces(ctx, g, &moved, b, nb);
    assert_true(na[0] == nb[0] && na[1] == nb[1]);
    slides += na[1];
    NEAR("forces and moments", distance(a, b, 3 * s.n), 0, 1e-11);
    gh_engine_destroy(&g);
  }
  assert_true(slides > 50);
}

/* A converged state is needed, and its history must be one. */
static void bad_input_is_refused(void **state) {
  gh_context *ctx = *state;
  sample s = two_grains(0.02), p;
  gh_engine *g = make_engine(ctx, &s, LAW, NULL);
  FAILS(gh_engine_set(g, NULL, s.x, s.theta), GH_ENGINE, "gh_engine_begin");
  const struct {
    gh_slip slip;
    bool periodic;
    const char *words;
  } bad[] = {{{.i = 0, .j = 2}, false, "between grains 1 and 3 of 2"},
             {{.i = 1, .j = 0}, false, "between grains 2 and 1 of 2"},
             {{.i = -1, .j = 0}, false, "between grains 0 and 1 of 2"},
             {{.j = 1, .gamma = NAN}, false, "not finite"},
             {{.j = 1, .gamma_pl = INFINITY}, false, "not finite"},
             {{.j = 1, .alpha = NAN}, false, "not finite"},
             {{.j = 1, .image = {1, 0}}, false, "at image (1, 0)"},
             {{.i = 0, .j = 0}, false, "grains 1 and 1 at image (0, 0)"},
             {{.i = 1, .j = 1, .image = {-1, 0}}, true, "grains 2 and 2 at image (-1, 0)"},
             {{.i = 1, .j = 1, .image = {3, -1}}, true, "grains 2 and 2 at image (3, -1)"}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    p = s;
    p.periodic = bad[k].periodic, p.nslips = 1, p.slips[0] = bad[k].slip;
    p.cell_n[0] = p.cell_n[3] = 10;
    gh_engine *e = make_engine(ctx, &p, LAW, NULL);
    const gh_converged n = state_n(&p);
    FAILS(gh_engine_begin(e, &n), GH_INPUT, bad[k].words);
    gh_engine_destroy(&e);
  }
  p = s;
  p.nslips = 2, p.slips[0] = p.slips[1] = (gh_slip){.j = 1};
  gh_converged n = state_n(&p);
  FAILS(gh_engine_begin(g, &n), GH_INPUT, "not in order at grains 1 and 2");
  p = s, p.theta_n[1] = NAN;
  n = state_n(&p);
  FAILS(gh_engine_begin(g, &n), GH_INPUT, "rotation of grain 2");
  put(ctx, g, &s);
  s.theta[0] = INFINITY;
  FAILS(gh_engine_set(g, NULL, s.x, s.theta), GH_INPUT, "rotation of grain 1");
  gh_engine_destroy(&g);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(slip_by_turning),         TEST(slip_by_moving),
                                     TEST(three_in_a_row),          TEST(own_image),
                                     TEST(two_images_of_a_pair),    TEST(balances),
                                     TEST(derivative_of_a_packing), TEST(kept_in_another_cell),
                                     TEST(bad_input_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
