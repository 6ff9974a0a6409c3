/* The native engine with friction: closed forms of a few grains, balances, keys of contacts, the derivative
 * assembled over packings, relaxation. SPDX-License-Identifier: GPL-2.0-or-later */
#include "../help.h"

enum { MOST = 150, MOST_SLIPS = 2000 };

static const gh_contact_law LAW = {
    .normal_stiffness = 100, .friction = 1, .tangential_stiffness = 80, .friction_coefficient = 0.3};

/* A packing at n and in the trial state. */
typedef struct sample {
  int n, nslips;
  bool periodic;
  double radius[MOST], cell_n[4], x_n[2 * MOST], theta_n[MOST], cell[4], x[2 * MOST], theta[MOST];
  gh_slip slips[MOST_SLIPS];
} sample;

static gh_engine *make_engine(gh_context *ctx, const sample *s, gh_contact_law law,
                              const unsigned char *held) {
  gh_engine *e;
  const gh_engine_setup setup = {
      .n = s->n, .radius = s->radius, .held = held, .periodic = s->periodic, .law = law};
  OK(gh_engine_create(ctx, GH_ENGINE_NATIVE, &setup, &e));
  return e;
}

static gh_converged state_n(const sample *s) {
  gh_converged n = {.x = s->x_n, .theta = s->theta_n, .slips = s->slips, .nslips = s->nslips};
  memcpy(n.cell, s->cell_n, sizeof n.cell);
  return n;
}

static void put(gh_context *ctx, gh_engine *e, const sample *s) {
  const gh_converged n = state_n(s);
  OK(gh_engine_begin(e, &n));
  OK(gh_engine_set(e, s->cell, s->x, s->theta));
}

static gh_contact_list evaluate(gh_context *ctx, gh_engine *e, const sample *s) {
  gh_contact_list list;
  put(ctx, e, s);
  OK(gh_engine_contacts(e, &list));
  assert_non_null(list.friction);
  assert_non_null(list.moment);
  return list;
}

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
  for (int k = 0; k < 4; k++) {
    gh_contact_law law = LAW;
    law.hardening = k & 1 ? 20 : 0;
    law.slip = k & 2 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
    sample s = two_grains(e);
    gh_engine *g = make_engine(ctx, &s, law, NULL);
    for (int much = 0; much < 2; much++) {
      s.theta[0] = 0.3 + (much ? 0.02 : 0.003), s.theta[1] = -0.2 + (much ? 0.01 : 0.004);
      const double gamma = scale * (much ? 0.025 : 0.005), h = law.hardening,
                   ft = much ? (h * 80 * gamma + 80 * 0.3 * fn) / (80 + h) : 80 * gamma;
      gh_contact_list list = evaluate(ctx, g, &s);
      assert_int_equal(list.count, 1);
      const gh_friction *f = list.friction;
      NEAR("f_t", f->force, ft, 1e-12);
      NEAR("gamma", f->slip.gamma, gamma, 1e-15);
      NEAR("gamma_pl", f->slip.gamma_pl, gamma - ft / 80, 1e-15);
      NEAR("alpha", f->slip.alpha, gamma - ft / 80, 1e-15);
      NEAR("energy", f->energy, ft * ft / 160 + h * pow(gamma - ft / 80, 2) / 2, 1e-14);
      NEAR("dissipated", f->dissipated, 0.3 * fn * (gamma - ft / 80), 1e-14);
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

/* Three grains in a row, the middle one turned: it feels both couples and no force; the outer ones one. */
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

/* A random packing that overlaps, many lattice vectors apart, with a random history of its contacts at n. */
static void draw(gh_context *ctx, unsigned long long *seed, int n, double largest, bool periodic, sample *s) {
  const double F[4] = {1 + 0.01 * (uniform(seed) - 0.5), 0.01 * (uniform(seed) - 0.5),
                       0.01 * (uniform(seed) - 0.5), 1 + 0.01 * (uniform(seed) - 0.5)},
               T[4] = {0.6 + uniform(seed), uniform(seed) - 0.5, 0, 0.6 + uniform(seed)};
  double Q[4];
  *s = (sample){.n = n, .periodic = periodic};
  rotation(6 * uniform(seed), Q);
  gh_mul2(Q, T, s->cell_n);
  gh_mul2(F, s->cell_n, s->cell);
  for (int i = 0; i < n; i++) {
    double f[2] = {uniform(seed), uniform(seed)};
    for (int k = 0; k < 2 && periodic; k++) f[k] = 6 * f[k] - 3;
    s->radius[i] = largest * (0.3 + 0.7 * uniform(seed));
    s->theta_n[i] = uniform(seed);
    s->theta[i] = s->theta_n[i] + 0.04 * (uniform(seed) - 0.5);
    gh_apply2(s->cell_n, f, &s->x_n[2 * i]);
    gh_apply2(F, &s->x_n[2 * i], &s->x[2 * i]);
    for (int k = 0; k < 2; k++) s->x[2 * i + k] += 0.06 * largest * (uniform(seed) - 0.5);
  }
  sample at_n = *s;
  memcpy(at_n.x, s->x_n, sizeof at_n.x);
  memcpy(at_n.cell, s->cell_n, sizeof at_n.cell);
  memcpy(at_n.theta, s->theta_n, sizeof at_n.theta);
  gh_engine *g = make_engine(ctx, s, LAW, NULL);
  gh_contact_list list = evaluate(ctx, g, &at_n);
  assert_in_range(list.count, 0, MOST_SLIPS);
  s->nslips = list.count;
  for (int c = 0; c < list.count; c++) {
    s->slips[c] = list.friction[c].slip;
    s->slips[c].gamma = 0.02 * largest * (uniform(seed) - 0.5);
    s->slips[c].gamma_pl = s->slips[c].gamma + 0.2 * largest * (uniform(seed) - 0.5);
    s->slips[c].alpha = 0.002 * largest * uniform(seed);
  }
  gh_engine_destroy(&g);
}

static gh_contact_law random_law(unsigned long long *seed, int trial) {
  gh_contact_law law = LAW;
  law.hardening = trial & 1 ? 30 * uniform(seed) : 0;
  law.slip = trial & 2 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
  return law;
}

/* Forces and moments of the grains are the sums over the contacts, each of which balances; contacts are in
 * order, lie at the image that their key names, and go on with the history that was given. */
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
      const double limit = 0.3 * 100 * q->overlap + law.hardening * t->slip.alpha;
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

/* Forces (2 n) and moments (n) in one array; the number of contacts and of sliding ones. */
static void all_forces(gh_context *ctx, gh_engine *g, const sample *s, double *out, int count[2]) {
  const gh_contact_list list = evaluate(ctx, g, s);
  memcpy(out, list.force, 2 * (size_t)s->n * sizeof *out);
  memcpy(out + 2 * s->n, list.moment, (size_t)s->n * sizeof *out);
  count[0] = list.count, count[1] = 0;
  for (int c = 0; c < list.count; c++) count[1] += list.friction[c].slides;
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

/* A reference packing, deformed by F from its state of rest; no history. */
static void case_sample(gh_context *ctx, const char *name, const double F[4], sample *s) {
  gh_packing *p = case_packing(ctx, name);
  *s = (sample){.n = p->n, .periodic = true};
  assert_in_range(p->n, 1, MOST);
  memcpy(s->radius, p->radius, (size_t)p->n * sizeof(double));
  memcpy(s->x_n, p->x, 2 * (size_t)p->n * sizeof(double));
  memcpy(s->cell_n, p->cell, sizeof p->cell);
  gh_mul2(F, p->cell, s->cell);
  for (int i = 0; i < p->n; i++) gh_apply2(F, &p->x[2 * i], &s->x[2 * i]);
  gh_packing_destroy(&p);
}

static gh_contact_law hard(double mu) {
  return (gh_contact_law){
      .normal_stiffness = 1000, .friction = 1, .tangential_stiffness = 1000, .friction_coefficient = mu};
}

/* Largest force on a free grain and moment over radius, over the mean normal force. */
static double residual_of(const sample *s, const gh_contact_list *list, const unsigned char *held,
                          bool turns) {
  double largest = 0, mean = 0;
  for (int c = 0; c < list->count; c++) mean += 1000 * list->contacts[c].overlap / list->count;
  for (int i = 0; i < s->n; i++) {
    if (!held || !held[i]) largest = fmax(largest, hypot(list->force[2 * i], list->force[2 * i + 1]));
    if (turns) largest = fmax(largest, fabs(list->moment[i]) / s->radius[i]);
  }
  return largest / mean;
}

static gh_relax_result relax(gh_context *ctx, gh_engine *g, double tolerance) {
  const gh_relax_options o = {.tolerance = tolerance, .max_steps = 200000};
  gh_relax_result r;
  OK(gh_engine_relax(g, &o, &r));
  return r;
}

/* Relaxation meets the residual that it reports, in forces and moments; held grains stay, but turn; where
 * rotations are fixed, nothing turns and moments do not count. */
static void relaxation(void **state) {
  gh_context *ctx = *state;
  static sample s;
  unsigned char held[MOST] = {0};
  for (int i = 0; i < MOST; i += 7) held[i] = 1;
  for (int k = 0; k < 8; k++) {
    const double F[4] = {0.999, 0.002, 0, 0.9995};
    case_sample(ctx, k & 4 ? "p20" : "p150d", F, &s);
    gh_contact_law law = hard(0.3);
    law.fixed_rotations = k & 1;
    const unsigned char *who = k & 2 ? held : NULL;
    double x[2 * MOST], theta[MOST];
    gh_contact_list list;
    gh_engine *g = make_engine(ctx, &s, law, who);
    put(ctx, g, &s);
    const gh_relax_result r = relax(ctx, g, 1e-10);
    assert_true(r.converged && r.residual <= 1e-10 && r.steps > 10);
    OK(gh_engine_contacts(g, &list));
    NEAR("residual", residual_of(&s, &list, who, !(k & 1)), r.residual, 1e-12);
    if (k & 1) assert_true(norm(list.moment, s.n) > 1e-3 * r.mean_force * s.radius[0]);
    OK(gh_engine_get(g, x, theta));
    for (int i = 0; i < s.n; i++) {
      if (who && who[i]) assert_true(x[2 * i] == s.x[2 * i] && x[2 * i + 1] == s.x[2 * i + 1]);
      if (k & 1) assert_true(theta[i] == s.theta[i]);
      else if (who && who[i] && i == 0) assert_true(theta[i] != s.theta[i]);
    }
    gh_engine_destroy(&g);
  }
}

/* Where all positions are held, rotations alone bring the moments to rest; two grains that stick turn by what
 * undoes the slip of the step, each by the half of it. */
static void only_rotations(void **state) {
  gh_context *ctx = *state;
  sample s = {.n = 2, .radius = {1, 1}, .x_n = {0, 0, 1.9, 0}};
  const double b = 0.001;
  const unsigned char held[MOST] = {1, 1};
  s.x[2] = 1.9 * cos(b), s.x[3] = 1.9 * sin(b);
  double x[4], theta[2];
  gh_engine *g = make_engine(ctx, &s, LAW, held);
  put(ctx, g, &s);
  assert_true(relax(ctx, g, 1e-12).converged);
  OK(gh_engine_get(g, x, theta));
  NEAR("rotation", theta[0], sin(b), 1e-12); /* (theta_1 + theta_2) |l|/2 = |l_n| sin b */
  NEAR("rotation", theta[1], sin(b), 1e-12);
  assert_memory_equal(x, s.x, sizeof x);
  gh_engine_destroy(&g);
}

/* A grain between two that cannot turn, because each is one of a triangle: both contacts slide, one each way,
 * and a trifle more overlap on one side drives the grain on until the slip there has gone back to its limit.
 * On the way nothing resists; steps alone are not at rest after 200,000. */
static void a_grain_that_spins(void **state) {
  gh_context *ctx = *state;
  const double e = 0.02, uneven = 1e-5, deep = 1.9, slip = 0.2, far = deep * sqrt(0.75);
  const double left = e - 2, right = 2 - e * (1 + uneven);
  sample s = {.n = 7,
              .radius = {1, 1, 1, 1, 1, 1, 1},
              .x_n = {left, 0, 0, 0, right, 0, left - far, 0.5 * deep, left - far, -0.5 * deep, right + far,
                      0.5 * deep, right + far, -0.5 * deep},
              .nslips = 2,
              .slips = {{.i = 0, .j = 1, .gamma = slip}, {.i = 1, .j = 2, .gamma = -slip}}};
  const unsigned char held[MOST] = {1, 1, 1, 1, 1, 1, 1};
  double x[14], theta[7];
  memcpy(s.x, s.x_n, sizeof s.x);
  gh_engine *g = make_engine(ctx, &s, LAW, held);
  put(ctx, g, &s);
  gh_relax_result r = relax(ctx, g, 1e-11);
  assert_true(r.converged);
  assert_in_range(r.steps, 1, 1500);
  OK(gh_engine_get(g, x, theta));
  /* f_t s on both sides is mu E_n e s of the left one */
  const double limit = 0.3 * 100 * e * (2 - e) / right;
  NEAR("slip of the right contact", (theta[1] + theta[2]) * right / 2 - slip, -limit / 80, 1e-9);
  assert_true(theta[0] < 0 && fabs(theta[0]) < 0.01 && fabs(theta[2]) < 0.01);
  gh_engine_destroy(&g);
}

/* Where the pair list is made anew does not matter: two engines come to the same positions from lists that
 * were made at different places, and the contacts are those of a list made at the end. */
static void lists_do_not_matter(void **state) {
  gh_context *ctx = *state;
  static sample s, start, end;
  unsigned long long seed = 34;
  const double F[4] = {1, 0, 0, 1};
  case_sample(ctx, "p50d", F, &s);
  for (int k = 0; k < 2 * s.n; k++) s.x[k] += 0.15 * s.radius[k / 2] * (uniform(&seed) - 0.5);
  start = s;
  for (int k = 0; k < 2 * s.n; k++) start.x[k] += 0.06 * s.radius[k / 2] * (uniform(&seed) - 0.5);
  gh_engine *a = make_engine(ctx, &s, hard(0.2), NULL), *b = make_engine(ctx, &s, hard(0.2), NULL);
  double x[2][2 * MOST], theta[2][MOST], before[3 * MOST], after[3 * MOST];
  gh_contact_list list;
  gh_engine_cost cost;
  int count[2];
  put(ctx, a, &s);
  put(ctx, b, &start);
  OK(gh_engine_move(b, s.x, s.theta));
  for (int k = 0; k < 2; k++) {
    gh_engine *g = k ? b : a;
    assert_true(relax(ctx, g, 1e-11).converged);
    OK(gh_engine_get(g, x[k], theta[k]));
    gh_engine_costs(g, &cost);
    assert_true(cost.rebuilds >= 2);
    OK(gh_engine_contacts(g, &list));
    memcpy(before, list.force, 2 * (size_t)s.n * sizeof(double));
    memcpy(before + 2 * s.n, list.moment, (size_t)s.n * sizeof(double));
    end = s;
    memcpy(end.x, x[k], sizeof end.x);
    memcpy(end.theta, theta[k], sizeof end.theta);
    all_forces(ctx, g, &end, after, count);
    assert_memory_equal(before, after, 3 * (size_t)s.n * sizeof(double));
  }
  NEAR("positions", distance(x[0], x[1], 2 * s.n), 0, 1e-8 * s.radius[0]);
  NEAR("rotations", distance(theta[0], theta[1], s.n), 0, 1e-8);
  gh_engine_destroy(&a);
  gh_engine_destroy(&b);
}

/* Contacts after a move are bitwise those after setting the same. */
static void moving_is_setting(void **state) {
  gh_context *ctx = *state;
  static sample s;
  unsigned long long seed = 35;
  double a[3 * MOST], b[3 * MOST];
  int count[2];
  draw(ctx, &seed, 30, 0.12, true, &s);
  gh_engine *g = make_engine(ctx, &s, LAW, NULL), *other = make_engine(ctx, &s, LAW, NULL);
  put(ctx, g, &s);
  for (int step = 0; step < 12; step++) {
    const double size = step % 4 == 3 ? 0.5 : 0.002;
    for (int k = 0; k < 2 * s.n; k++) s.x[k] += size * (uniform(&seed) - 0.5);
    for (int k = 0; k < s.n; k++) s.theta[k] += 0.01 * (uniform(&seed) - 0.5);
    OK(gh_engine_move(g, s.x, s.theta));
    gh_contact_list list;
    OK(gh_engine_contacts(g, &list));
    memcpy(a, list.force, 2 * (size_t)s.n * sizeof *a);
    memcpy(a + 2 * s.n, list.moment, (size_t)s.n * sizeof *a);
    all_forces(ctx, other, &s, b, count);
    assert_int_equal(list.count, count[0]);
    assert_memory_equal(a, b, 3 * (size_t)s.n * sizeof *a);
  }
  gh_engine_destroy(&g);
  gh_engine_destroy(&other);
}

/* Friction of coefficient 0 without hardening is no friction: the same forces, the same relaxed positions,
 * nothing turns. */
static void no_friction(void **state) {
  gh_context *ctx = *state;
  static sample s;
  const double F[4] = {0.999, 0, 0, 1};
  double x[2][2 * MOST], theta[MOST];
  gh_relax_result r[2];
  double force[2][2 * MOST];
  int count[2];
  case_sample(ctx, "p150d", F, &s);
  gh_contact_law smooth = hard(0);
  smooth.friction = 0;
  gh_engine *g[2] = {make_engine(ctx, &s, hard(0), NULL), make_engine(ctx, &s, smooth, NULL)};
  for (int k = 0; k < 2; k++) {
    put(ctx, g[k], &s);
    gh_contact_list list;
    OK(gh_engine_contacts(g[k], &list));
    assert_true((list.friction != NULL) == (k == 0) && (list.moment != NULL) == (k == 0));
    memcpy(force[k], list.force, 2 * (size_t)s.n * sizeof(double));
    count[k] = list.count;
    r[k] = relax(ctx, g[k], 1e-9);
  }
  assert_int_equal(count[0], count[1]);
  NEAR("forces", distance(force[0], force[1], 2 * s.n), 0, 1e-13);
  OK(gh_engine_get(g[0], x[0], theta));
  OK(gh_engine_get(g[1], x[1], NULL));
  assert_true(r[0].converged && r[1].converged);
  NEAR("positions", distance(x[0], x[1], 2 * s.n), 0, 1e-9 * s.radius[0]);
  assert_memory_equal(theta, s.theta, (size_t)s.n * sizeof(double));
  gh_engine_destroy(&g[0]);
  gh_engine_destroy(&g[1]);
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
  const struct CMUnitTest tests[] = {TEST(slip_by_turning),
                                     TEST(slip_by_moving),
                                     TEST(three_in_a_row),
                                     TEST(own_image),
                                     TEST(two_images_of_a_pair),
                                     TEST(balances),
                                     TEST(derivative_of_a_packing),
                                     TEST(kept_in_another_cell),
                                     TEST(relaxation),
                                     TEST(only_rotations),
                                     TEST(a_grain_that_spins),
                                     TEST(lists_do_not_matter),
                                     TEST(moving_is_setting),
                                     TEST(no_friction),
                                     TEST(bad_input_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
