/* Friction in LAMMPS: the engine against the native one, and the styles in LAMMPS's own hands.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include "../help.h"

#include "engine/lammps/guard.h"

#include <lammps/library.h>
#include <unistd.h>

enum { MOST = 150, MOST_SLIPS = 2000, ENGINES = 2 };

static const gh_engine_kind KINDS[ENGINES] = {GH_ENGINE_LAMMPS, GH_ENGINE_NATIVE};
static const double E = 100;

/* ---- the engine ---- */

/* A packing at n and in the trial state. */
typedef struct sample {
  int n, nslips;
  bool periodic;
  gh_contact_law law;
  const unsigned char *held;
  double radius[MOST], cell_n[4], x_n[2 * MOST], theta_n[MOST], cell[4], x[2 * MOST], theta[MOST];
  gh_slip slips[MOST_SLIPS];
} sample;

static gh_engine *make_engine(gh_context *ctx, const sample *s, gh_engine_kind kind) {
  gh_engine *e;
  const gh_engine_setup setup = {
      .n = s->n, .radius = s->radius, .held = s->held, .periodic = s->periodic, .law = s->law};
  OK(gh_engine_create(ctx, kind, &setup, &e));
  return e;
}

static void put(gh_context *ctx, gh_engine *e, const sample *s) {
  gh_converged n = {.x = s->x_n, .theta = s->theta_n, .slips = s->slips, .nslips = s->nslips};
  memcpy(n.cell, s->cell_n, sizeof n.cell);
  OK(gh_engine_begin(e, &n));
  OK(gh_engine_set(e, s->cell, s->x, s->theta));
}

static gh_contact_law random_law(unsigned long long *seed, int trial) {
  return (gh_contact_law){.normal_stiffness = E,
                          .friction = 1,
                          .tangential_stiffness = 80,
                          .friction_coefficient = 0.5 * uniform(seed),
                          .hardening = trial & 1 ? 30 * uniform(seed) : 0,
                          .slip = trial & 2 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED,
                          .fixed_rotations = trial % 5 == 4};
}

/* A random packing that overlaps, in a cell that is turned, tilted up to twice its width, with grains kept in
 * other cells, and with a random history of the contacts that it has at n. */
static void draw(gh_context *ctx, unsigned long long *seed, int trial, int n, double largest, sample *s) {
  const double tilt = trial % 4 ? 0.5 : 4,
               F[4] = {1 + 0.01 * (uniform(seed) - 0.5), 0.01 * (uniform(seed) - 0.5),
                       0.01 * (uniform(seed) - 0.5), 1 + 0.01 * (uniform(seed) - 0.5)},
               T[4] = {0.6 + uniform(seed), tilt * (uniform(seed) - 0.5), 0, 0.6 + uniform(seed)};
  double Q[4];
  *s = (sample){.n = n, .periodic = trial % 7 != 6, .law = random_law(seed, trial)};
  rotation(6 * uniform(seed), Q);
  gh_mul2(Q, T, s->cell_n);
  gh_mul2(F, s->cell_n, s->cell);
  for (int i = 0; i < n; i++) {
    double f[2] = {uniform(seed), uniform(seed)};
    for (int k = 0; k < 2 && s->periodic; k++) f[k] = 6 * f[k] - 3;
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
  gh_engine *g = make_engine(ctx, s, GH_ENGINE_NATIVE);
  gh_contact_list list;
  put(ctx, g, &at_n);
  OK(gh_engine_contacts(g, &list));
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

/* Contacts of two engines, in the same order with the same keys. Centres that are near each other make second
 * derivatives large, and their rounding. */
static void assert_same(const gh_contact_list *a, const gh_contact_list *b, int n, double tolerance) {
  assert_int_equal(a->count, b->count);
  for (int c = 0; c < a->count; c++) {
    const gh_contact *p = &a->contacts[c], *q = &b->contacts[c];
    const gh_friction *s = &a->friction[c], *t = &b->friction[c];
    const double near = 1 + pow(1 + p->overlap / hypot(p->l[0], p->l[1]), 2);
    assert_true(p->i == q->i && p->j == q->j);
    assert_true(s->slip.i == p->i && s->slip.j == p->j);
    assert_memory_equal(s->slip.image, t->slip.image, sizeof s->slip.image);
    NEAR("branch", distance(p->l, q->l, 2), 0, tolerance);
    NEAR("force", distance(p->f, q->f, 2), 0, E * tolerance);
    NEAR("normal stiffness", distance(p->h, q->h, 3), 0, near * E * tolerance);
    NEAR("overlap", p->overlap, q->overlap, tolerance);
    NEAR("energy", p->energy, q->energy, E * tolerance);
    NEAR("gamma", s->slip.gamma, t->slip.gamma, tolerance);
    NEAR("gamma_pl", s->slip.gamma_pl, t->slip.gamma_pl, tolerance);
    NEAR("alpha", s->slip.alpha, t->slip.alpha, tolerance);
    NEAR("f_t", s->force, t->force, E * tolerance);
    NEAR("couple", s->couple, t->couple, E * tolerance);
    NEAR("derivative", distance(s->d, t->d, 9), 0, 10 * near * E * tolerance);
    NEAR("energy", s->energy, t->energy, E * tolerance);
    NEAR("dissipated", s->dissipated, t->dissipated, E * tolerance);
    assert_int_equal(s->slides, t->slides);
  }
  NEAR("forces", distance(a->force, b->force, 2 * n), 0, 10 * E * tolerance);
  NEAR("moments", distance(a->moment, b->moment, n), 0, 10 * E * tolerance);
}

/* Random packings, also of one to three grains that touch themselves and each other through several images;
 * then moved a little and a lot. Lengths are about 1. */
static void same_as_native(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 41;
  print_message("seed %llu\n", seed);
  static sample s;
  int own = 0, slides = 0, contacts = 0;
  for (int trial = 0; trial < 168; trial++) {
    const int n = trial % 3 ? trial % 3 + trial % 2 : 30;
    draw(ctx, &seed, trial, n, trial % 3 ? 0.5 : 0.13, &s);
    gh_engine *g[ENGINES];
    gh_contact_list list[ENGINES];
    for (int k = 0; k < ENGINES; k++) {
      g[k] = make_engine(ctx, &s, KINDS[k]);
      put(ctx, g[k], &s);
    }
    for (int step = 0; step < 3; step++) {
      for (int k = 0; k < ENGINES; k++) {
        if (step) OK(gh_engine_move(g[k], s.x, s.theta));
        OK(gh_engine_contacts(g[k], &list[k]));
      }
      assert_same(&list[0], &list[1], n, 1e-12);
      contacts += list[0].count;
      for (int c = 0; c < list[0].count; c++) {
        own += list[0].contacts[c].i == list[0].contacts[c].j;
        slides += list[0].friction[c].slides;
      }
      for (int k = 0; k < 2 * n; k++) s.x[k] += (step ? 0.1 : 1e-3) * (uniform(&seed) - 0.5);
      for (int k = 0; k < n; k++) s.theta[k] += 0.01 * (uniform(&seed) - 0.5);
    }
    for (int k = 0; k < ENGINES; k++) gh_engine_destroy(&g[k]);
  }
  print_message("%d contacts, %d slide, %d with a grain's own image\n", contacts, slides, own);
  assert_true(contacts > 5000 && slides > 2000 && own > 80);
}

/* What comes back depends on state n, cell, positions and rotations only, to the last bit. */
static void no_memory(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 42;
  static sample s, other;
  draw(ctx, &seed, 1, 40, 0.12, &s);
  draw(ctx, &seed, 0, 40, 0.12, &other);
  other.law = s.law;
  memcpy(other.radius, s.radius, sizeof s.radius);
  other.nslips = 0;
  const gh_relax_options o = {.tolerance = 1e-6, .max_steps = 2000, .method = GH_RELAX_DAMPED};
  gh_engine *fresh = make_engine(ctx, &s, GH_ENGINE_LAMMPS), *used = make_engine(ctx, &s, GH_ENGINE_LAMMPS);
  gh_relax_result r[2];
  gh_contact_list a, b;
  put(ctx, used, &other);
  OK(gh_engine_relax(used, &o, r));
  put(ctx, used, &s);
  put(ctx, fresh, &s);
  for (int step = 0; step < 2; step++) {
    OK(gh_engine_contacts(fresh, &a));
    OK(gh_engine_contacts(used, &b));
    assert_int_equal(a.count, b.count);
    assert_memory_equal(a.contacts, b.contacts, (size_t)a.count * sizeof *a.contacts);
    assert_memory_equal(a.friction, b.friction, (size_t)a.count * sizeof *a.friction);
    assert_memory_equal(a.moment, b.moment, (size_t)s.n * sizeof *a.moment);
    OK(gh_engine_relax(fresh, &o, &r[0]));
    OK(gh_engine_relax(used, &o, &r[1]));
    assert_int_equal(r[0].steps, r[1].steps);
  }
  gh_engine_destroy(&fresh);
  gh_engine_destroy(&used);
}

/* A reference packing at rest, deformed by F and turned; no history. */
static void case_sample(gh_context *ctx, const char *name, const double F[4], double turn, double mu,
                        sample *s) {
  gh_packing *p = case_packing(ctx, name);
  double Q[4], QF[4];
  *s = (sample){
      .n = p->n,
      .periodic = true,
      .law = {.normal_stiffness = E, .friction = 1, .tangential_stiffness = E, .friction_coefficient = mu}};
  assert_in_range(p->n, 1, MOST);
  rotation(turn, Q);
  gh_mul2(Q, F, QF);
  memcpy(s->radius, p->radius, (size_t)p->n * sizeof(double));
  gh_mul2(Q, p->cell, s->cell_n);
  gh_mul2(QF, p->cell, s->cell);
  for (int i = 0; i < p->n; i++) {
    gh_apply2(Q, &p->x[2 * i], &s->x_n[2 * i]);
    gh_apply2(QF, &p->x[2 * i], &s->x[2 * i]);
  }
  gh_packing_destroy(&p);
}

/* Where the residual does not come down any more, the least damping is doubled every thousand steps, from
 * list to list; a relaxation that is gone on with begins with what there was; behind the largest it is the
 * first again. */
static void damping_is_carried_on(void **state) {
  gh_context *ctx = *state;
  static sample s;
  const double F[4] = {0.998, 0.002, 0, 0.999};
  case_sample(ctx, "p20", F, false, 0.5, &s);
  s.periodic = true;
  for (int m = 0; m < ENGINES; m++) {
    gh_engine *g = make_engine(ctx, &s, KINDS[m]);
    gh_relax_options o = {.max_steps = 6000, .method = GH_RELAX_DAMPED}; /* no residual is 0 */
    gh_relax_result first, then;
    put(ctx, g, &s);
    OK(gh_engine_relax(g, &o, &first));
    assert_false(first.converged);
    assert_true(first.least_damping >= 0.04 && first.least_damping <= 0.32);
    assert_true(exp2(round(log2(first.least_damping / 0.01))) * 0.01 == first.least_damping);
    o.least_damping = first.least_damping;
    o.max_steps = 2500;
    OK(gh_engine_relax(g, &o, &then));
    assert_true(then.least_damping == fmin(1, 4 * first.least_damping));
    o.least_damping = 0.7;
    OK(gh_engine_relax(g, &o, &then));
    assert_true(then.least_damping == 0.01); /* 0.7, 1, 0.01 */
    o.max_steps = 5;
    o.least_damping = 0;
    OK(gh_engine_relax(g, &o, &then));
    assert_true(then.least_damping == 0.01);
    gh_engine_destroy(&g);
  }
}

/* Both engines run the same kernel on the same pairs: as many steps, and the same equilibrium. The residual
 * is what the forces say. Held grains stay and turn. */
static void relaxes_as_native(void **state) {
  gh_context *ctx = *state;
  static sample s;
  unsigned char held[MOST] = {0};
  for (int i = 0; i < MOST; i += 9) held[i] = 1;
  for (int k = 0; k < 6; k++) {
    const double F[4] = {0.998, 0.002, 0, 0.999};
    case_sample(ctx, "p150d", F, k % 2, k % 3 == 2 ? 0.1 : 0.5, &s);
    s.held = k % 3 == 1 ? held : NULL;
    s.periodic = k != 4;
    gh_relax_result r[ENGINES];
    double x[ENGINES][2 * MOST], theta[ENGINES][MOST];
    gh_contact_list list;
    for (int m = 0; m < ENGINES; m++) {
      gh_engine *g = make_engine(ctx, &s, KINDS[m]);
      put(ctx, g, &s);
      OK(gh_engine_relax(
          g, &(gh_relax_options){.tolerance = 1e-11, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r[m]));
      assert_true(r[m].converged && r[m].residual <= 1e-11);
      OK(gh_engine_get(g, x[m], theta[m]));
      OK(gh_engine_contacts(g, &list));
      double largest = 0;
      for (int i = 0; i < s.n; i++) {
        if (!s.held || !held[i]) largest = fmax(largest, hypot(list.force[2 * i], list.force[2 * i + 1]));
        else assert_memory_equal(&x[m][2 * i], &s.x[2 * i], 2 * sizeof(double));
        largest = fmax(largest, fabs(list.moment[i]) / s.radius[i]);
      }
      NEAR("residual", largest / r[m].mean_force, r[m].residual, 3e-12);
      gh_engine_destroy(&g);
    }
    print_message("steps: %ld and %ld\n", r[0].steps, r[1].steps);
    NEAR("mean force", r[0].mean_force, r[1].mean_force, 1e-9 * r[1].mean_force);
    NEAR("positions", distance(x[0], x[1], 2 * s.n), 0, 1e-8 * s.radius[0]);
    NEAR("rotations", distance(theta[0], theta[1], s.n), 0, 1e-7);
    assert_true(norm(theta[0], s.n) > 1e-5);
  }
}

/* ---- the styles in LAMMPS's own hands ---- */

static void command(gh_context *ctx, void *lmp, const char *line) {
  OK(gh_lmp_command(ctx, lmp, "%s", line));
}

static void commands(gh_context *ctx, void *lmp, const char *const *lines) {
  for (; *lines; lines++) command(ctx, lmp, *lines);
}

/* Two disks of radius 1 and 0.5 in a periodic box, the second at `l` from the first, across the box's
 * boundary. */
static void *two_disks(gh_context *ctx, const char *style, const char *coefficients, const double l[2]) {
  static const char *const box[] = {"dimension 2",
                                    "atom_style sphere",
                                    "atom_modify map array",
                                    "newton off",
                                    "region r prism 0 9 0 8 -1 1 0.7 0 0",
                                    "create_box 1 r",
                                    "neighbor 0.3 bin",
                                    "neigh_modify every 1 delay 0 check yes",
                                    NULL};
  const int id[2] = {1, 2}, type[2] = {1, 1};
  const double x[6] = {8.9, 0.5, 0, 8.9 + l[0] - 9, 0.5 + l[1], 0};
  void *lmp;
  double *radius;
  OK(gh_lmp_open(ctx, &lmp));
  commands(ctx, lmp, box);
  OK(gh_lmp_create_atoms(ctx, lmp, 2, id, type, x));
  OK(gh_lmp_atom(ctx, lmp, "radius", &radius));
  radius[0] = 1, radius[1] = 0.5;
  command(ctx, lmp, "group second id 2");
  OK(gh_lmp_command(ctx, lmp, "pair_style granhom/coulomb %s", style));
  OK(gh_lmp_command(ctx, lmp, "pair_coeff * * %s", coefficients));
  command(ctx, lmp, "compute c all granhom/contact/local");
  command(ctx, lmp, "compute s all granhom/stress");
  command(ctx, lmp, "timestep 0.001");
  return lmp;
}

/* Forces and torques by id: f_x f_y m. */
static void forces(gh_context *ctx, void *lmp, int n, double *out) {
  int *tag;
  double **f, **torque;
  OK(gh_lmp_atom(ctx, lmp, "id", &tag));
  OK(gh_lmp_atom(ctx, lmp, "f", &f));
  OK(gh_lmp_atom(ctx, lmp, "torque", &torque));
  for (int k = 0; k < n; k++) {
    double *o = out + 3 * (tag[k] - 1);
    o[0] = f[k][0], o[1] = f[k][1], o[2] = torque[k][2];
  }
}

/* The only row of the contacts; NULL: there is none. */
static const double *row_of(gh_context *ctx, void *lmp) {
  int count;
  double **rows;
  OK(gh_lmp_local(ctx, lmp, "c", &count, &rows));
  assert_in_range(count, 0, 1);
  return count ? rows[0] : NULL;
}

static void turn_second(gh_context *ctx, void *lmp, double d, double from, double to) {
  OK(gh_lmp_command(ctx, lmp, "displace_atoms second move %.17g %.17g 0", d * (cos(to) - cos(from)),
                    d * (sin(to) - sin(from))));
}

/* Increments by hand: the second disk goes round the first in committed steps. The contact sticks, then
 * slides with the slope E_t h/(E_t + h), and unloads with E_t; force, torque, stress and LAMMPS's virial are
 * those of the closed form, and a commit without a move leaves all but the scaling c. */
static void increments_by_hand(void **state) {
  gh_context *ctx = *state;
  const double e = 0.02, d = 1.5 - e, step = 0.0005, Et = 80, h = 20, fn = 100 * e, slip = d * sin(step);
  void *lmp = two_disks(ctx, "increment manual", "100 80 0.3 20", (double[2]){d, 0});
  command(ctx, lmp, "compute p all pressure NULL virial");
  command(ctx, lmp, "run 0 post no");
  double gamma = 0, plastic = 0, b = 0;
  for (int k = 1; k <= 25; k++) {
    const int back = k > 20;
    turn_second(ctx, lmp, d, b, b + (back ? -step : step));
    b += back ? -step : step;
    command(ctx, lmp, "run 0 post no");
    gamma -= back ? -slip : slip;
    const int slides = !back && -gamma * Et > 0.3 * fn;
    if (slides) plastic = gamma + (h * Et * -gamma + Et * 0.3 * fn) / (Et + h) / Et;
    double f[6];
    for (int again = 0; again < 2; again++) {
      const double ft = Et * (gamma - plastic), c = again ? 1 : cos(step), n[2] = {cos(b), sin(b)},
                   expected[2] = {-fn * n[0] + c * ft * n[1], -fn * n[1] - c * ft * n[0]};
      forces(ctx, lmp, 2, f);
      const double *row = row_of(ctx, lmp), *stress = lammps_extract_compute(lmp, "s", 0, LMP_TYPE_VECTOR);
      assert_non_null(row);
      NEAR("gamma", row[18], gamma, 1e-13);
      NEAR("gamma_pl", row[19], plastic, 1e-12);
      NEAR("alpha", row[20], -plastic, 1e-12);
      NEAR("f_t", row[17], ft, 1e-11);
      if (!again) assert_int_equal((int)row[21], slides);
      for (int m = 0; m < 2; m++) {
        NEAR("force", f[m], expected[m], 1e-11);
        NEAR("reaction", f[3 + m], -expected[m], 1e-11);
        for (int q = 0; q < 2; q++) NEAR("stress", stress[3 * m + q], expected[m] * d * n[q] / 72, 1e-12);
      }
      NEAR("torque", f[2], -c * d / 1.5 * ft, 1e-11);
      NEAR("torque", f[5], -0.5 * c * d / 1.5 * ft, 1e-11);
      if (again) break;
      command(ctx, lmp, "fix_modify granhom_history commit yes");
      command(ctx, lmp, "run 0 post no");
    }
  }
  assert_true(plastic < -0.001);
  gh_lmp_close(&lmp);
}

/* Each time step an increment: a disk that turns with a given omega slips by omega r dt |l|/(r_i + r_j) a
 * step; many runs, with setup or without, are as good as one. */
static void increments_by_time_step(void **state) {
  gh_context *ctx = *state;
  const double d = 1.48, omega = 2, slip = omega * 0.001 * d / 1.5;
  double f[3][6];
  for (int k = 0; k < 3; k++) {
    void *lmp = two_disks(ctx, "increment step", "100 80 0.3 0", (double[2]){d, 0});
    double **w;
    command(ctx, lmp, "fix drag all viscous 0");
    OK(gh_lmp_atom(ctx, lmp, "omega", &w));
    w[0][2] = omega;
    for (int run = 0; run < 3; run++) command(ctx, lmp, k && run ? "run 1 pre no post no" : "run 1 post no");
    if (k == 2) command(ctx, lmp, "run 0 post no");
    const double *row = row_of(ctx, lmp);
    NEAR("gamma", row[18], 3 * slip, 1e-14);
    forces(ctx, lmp, 2, f[k]);
    NEAR("torque", f[k][2], -80 * 3 * slip * d / 1.5, 1e-12);
    command(ctx, lmp, "run 10 post no");
    NEAR("limit", row_of(ctx, lmp)[17], 0.6, 1e-12);
    gh_lmp_close(&lmp);
  }
  for (int k = 1; k < 3; k++) NEAR("runs", distance(f[0], f[k], 6), 0, 1e-12);
}

/* A contact that opens loses its slip; alpha returns, here after the pair was apart for two increments. */
static void opening(void **state) {
  gh_context *ctx = *state;
  void *lmp = two_disks(ctx, "increment manual", "100 80 0.3 20", (double[2]){1.48, 0});
  command(ctx, lmp, "run 0 post no");
  turn_second(ctx, lmp, 1.48, 0, 0.01);
  command(ctx, lmp, "run 0 post no");
  const double alpha = row_of(ctx, lmp)[20];
  assert_true(alpha > 1e-3);
  for (int k = 0; k < 3; k++) {
    command(ctx, lmp, "fix_modify granhom_history commit yes");
    if (k < 2)
      command(ctx, lmp, k ? "displace_atoms second move 0.2 0.1 0" : "displace_atoms second move 0.2 0 0");
    else command(ctx, lmp, "displace_atoms second move -0.4 -0.1 0");
    command(ctx, lmp, "run 0 post no");
    if (k < 2) assert_null(row_of(ctx, lmp));
  }
  const double *row = row_of(ctx, lmp), l[2] = {1.48 * cos(0.01), 1.48 * sin(0.01)};
  /* the whole way of the last increment counts: from the separated pair, l + (0.4, 0.1) */
  const double gamma = -((l[0] + 0.4) * l[1] - (l[1] + 0.1) * l[0]) / 1.48,
               force = (80 * gamma - 0.3 * 2 - 20 * alpha) / 100;
  assert_non_null(row);
  NEAR("gamma", row[18], gamma, 1e-13);
  NEAR("alpha", row[20], alpha + force, 1e-12);
  gh_lmp_close(&lmp);
}

/* `unfix` takes the history away: contacts begin anew with the next run, and nothing is listed before it. */
static void history_taken_away(void **state) {
  gh_context *ctx = *state;
  void *lmp = two_disks(ctx, "increment manual", "100 80 0.3 20", (double[2]){1.48, 0});
  int count;
  double **rows;
  command(ctx, lmp, "run 0 post no");
  turn_second(ctx, lmp, 1.48, 0, 0.003);
  command(ctx, lmp, "run 0 post no");
  assert_true(fabs(row_of(ctx, lmp)[17]) > 0.1);
  command(ctx, lmp, "unfix granhom_history");
  command(ctx, lmp, "reset_timestep 1");
  FAILS(gh_lmp_local(ctx, lmp, "c", &count, &rows), GH_ENGINE, "use run 0 first");
  command(ctx, lmp, "run 0 post no");
  NEAR("f_t", row_of(ctx, lmp)[17], 0, 1e-13);
  command(ctx, lmp, "pair_style granhom/normal");
  command(ctx, lmp, "pair_coeff * * 100");
  FAILS(gh_lmp_command(ctx, lmp, "fix_modify granhom_history commit yes"), GH_ENGINE, "granhom_history");
  gh_lmp_close(&lmp);
}

/* What single() says of a contact is what compute() did: LAMMPS's compute pair/local asks it. */
static void single_contacts(void **state) {
  gh_context *ctx = *state;
  void *lmp = two_disks(ctx, "increment manual slip objective", "100 80 0.3 20", (double[2]){1.3, 0.6});
  int count;
  double **rows, f[6];
  command(ctx, lmp, "compute l all pair/local dist eng force fx fy p1 p2 p3 p4 p5 p6 p7 p8 p9");
  command(ctx, lmp, "compute e all pe");
  command(ctx, lmp, "thermo_style custom step c_e");
  command(ctx, lmp, "run 0 post no");
  command(ctx, lmp, "displace_atoms second move 0.01 -0.02 0");
  command(ctx, lmp, "run 0 post no");
  const double *row = row_of(ctx, lmp);
  double contact[26];
  memcpy(contact, row, sizeof contact);
  forces(ctx, lmp, 2, f);
  OK(gh_lmp_local(ctx, lmp, "l", &count, &rows));
  assert_int_equal(count, 1);
  const double *p = rows[0], *extra = p + 5, sign = p[3] * f[0] > 0 ? 1 : -1; /* of either atom */
  NEAR("distance", p[0], hypot(contact[2], contact[3]), 1e-14);
  NEAR("normal force", p[2], hypot(p[3], p[4]), 1e-12);
  for (int m = 0; m < 2; m++) NEAR("force", p[3 + m] + extra[m], sign * f[m], 1e-12);
  NEAR("energy", p[1], contact[9] + contact[24], 1e-13);
  NEAR("energy of LAMMPS", *(double *)lammps_extract_compute(lmp, "e", 0, LMP_TYPE_SCALAR), p[1], 1e-13);
  const int columns[] = {17, 16, 18, 19, 20, 21}; /* f_t, couple, gamma, gamma_pl, alpha, slides */
  for (int m = 0; m < 6; m++) NEAR("extra", extra[3 + m], contact[columns[m]], 1e-12);
  gh_lmp_close(&lmp);
}

/* The reference packing in LAMMPS's own hands. */
static void *open_packing(gh_context *ctx, const char *name, const char *style, const char *coefficients) {
  static const char *const before[] = {"dimension 2", "atom_style sphere", "atom_modify map array",
                                       "newton off",  "box tilt large",    NULL};
  static const char *const after[] = {"neighbor 0.02 bin", "neigh_modify every 1 delay 0 check yes",
                                      "compute s all granhom/stress", NULL};
  void *lmp;
  OK(gh_lmp_open(ctx, &lmp));
  commands(ctx, lmp, before);
  OK(gh_lmp_command(ctx, lmp, "read_data tests/data/cases/packings/%s.data", name));
  command(ctx, lmp, "change_box all triclinic");
  OK(gh_lmp_command(ctx, lmp, "pair_style %s", style));
  OK(gh_lmp_command(ctx, lmp, "pair_coeff * * %s", coefficients));
  commands(ctx, lmp, after);
  return lmp;
}

/* A box that fix deform flips is the same packing as one that it does not flip. */
static void flips(void **state) {
  gh_context *ctx = *state;
  static double f[2][3 * MOST];
  int n = 0;
  for (int k = 0; k < 2; k++) {
    void *lmp = open_packing(ctx, "p150d", "granhom/coulomb", "1000 800 0.5 10");
    command(ctx, lmp, "timestep 1e-4");
    command(ctx, lmp, "fix m all nve/sphere disc");
    command(ctx, lmp, "fix d all viscous 0.3");
    command(ctx, lmp,
            k ? "fix s all deform 1 xy final 1.4 remap x flip yes"
              : "fix s all deform 1 xy final 1.4 remap x flip no");
    command(ctx, lmp, "run 600 post no");
    double tilt = lammps_get_thermo(lmp, "xy"), wide = lammps_get_thermo(lmp, "lx");
    assert_true(k ? tilt < 0.5 * wide : tilt > 0.5 * wide);
    OK(gh_lmp_setting(ctx, lmp, "nlocal", &n));
    forces(ctx, lmp, n, f[k]);
    gh_lmp_close(&lmp);
  }
  print_message("forces up to %g, flipped or not differ by %g\n", norm(f[0], 3 * n),
                distance(f[0], f[1], 3 * n));
  NEAR("forces", distance(f[0], f[1], 3 * n), 0, 1e-8 * norm(f[0], 3 * n));
}

/* The box becomes (1 + g) of lx and xy, or of ly. */
static void stretch(gh_context *ctx, void *lmp, int along, const double box[3], double g) {
  if (along) OK(gh_lmp_command(ctx, lmp, "change_box all y final 0 %.17g remap", box[1] * (1 + g)));
  else
    OK(gh_lmp_command(ctx, lmp, "change_box all x final 0 %.17g xy final %.17g remap", box[0] * (1 + g),
                      box[2] * (1 + g)));
}

static void stress_now(void *lmp, double s[4]) {
  const double *v = lammps_extract_compute(lmp, "s", 0, LMP_TYPE_VECTOR);
  memcpy(s, (double[4]){v[0], v[1], v[3], v[4]}, 4 * sizeof *s);
}

/* The tangent is the derivative of the relaxed stress at fixed state n, with friction and without, with one
 * relaxation step per time step and with many, damped and FIRE. LAMMPS's boxes allow F11, F12, F22; turning
 * gives F21. */
static void tangents(void **state) {
  gh_context *ctx = *state;
  for (int k = 0; k < 4; k++) {
    void *lmp = open_packing(ctx, "p50d", k ? "granhom/coulomb increment manual" : "granhom/normal",
                             k ? "1000 800 0.3 20" : "1000");
    const double h = 1e-6;
    double A[16], S[4], worst = 0;
    command(ctx, lmp, "compute t all granhom/tangent");
    command(ctx, lmp,
            k == 3   ? "fix r all granhom/relax tolerance 1e-11 inner yes method fire"
            : k == 2 ? "fix r all granhom/relax tolerance 1e-11"
                     : "fix r all granhom/relax tolerance 1e-11 inner yes");
    command(ctx, lmp, "run 100000 post no");
    for (int step = 0; step < 2; step++) {
      if (k) command(ctx, lmp, "fix_modify granhom_history commit yes");
      command(ctx, lmp, "change_box all x scale 0.999 y scale 0.9995 xy delta 0.001 remap");
      command(ctx, lmp, "run 100000 post no");
    }
    double **array = lammps_extract_compute(lmp, "t", LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY);
    assert_non_null(array);
    memcpy(A, array[0], sizeof A);
    stress_now(lmp, S);
    const double box[3] = {lammps_get_thermo(lmp, "lx"), lammps_get_thermo(lmp, "ly"),
                           lammps_get_thermo(lmp, "xy")};
    for (int c = 0; c < 4; c++) {
      if (c == 2) continue;
      double P[2][4];
      for (int side = 0; side < 2; side++) {
        const double g = side ? -h : h, move = side ? -2 * h : h; /* from the other side */
        if (c == 1) OK(gh_lmp_command(ctx, lmp, "change_box all xy delta %.17g remap", move * box[1]));
        else stretch(ctx, lmp, c, box, g);
        command(ctx, lmp, "run 100000 post no");
        double s[4],
            J = c == 1 ? 1 : 1 + g,
            inverse[4] = {c == 0 ? 1 / J : 1, 0, c == 1 ? -g : 0, c == 3 ? 1 / J : 1}; /* of F, transposed */
        stress_now(lmp, s);
        gh_mul2(s, inverse, P[side]);
        for (int m = 0; m < 4; m++) P[side][m] *= J;
      }
      if (c == 1) OK(gh_lmp_command(ctx, lmp, "change_box all xy delta %.17g remap", h * box[1]));
      else stretch(ctx, lmp, c, box, 0);
      command(ctx, lmp, "run 100000 post no");
      for (int m = 0; m < 4; m++) worst = fmax(worst, fabs(A[4 * m + c] - (P[0][m] - P[1][m]) / (2 * h)));
    }
    print_message("tangent %g, against differences %g\n", norm(A, 16), worst / norm(A, 16));
    NEAR("tangent", worst / norm(A, 16), 0, 1e-5);
    const double WS[4] = {-S[2], -S[3], S[0], S[1]};
    for (int m = 0; m < 4 && !k; m++) NEAR("turning", A[4 * m + 2] - A[4 * m + 1], WS[m], 1e-9 * norm(A, 16));
    gh_lmp_close(&lmp);
  }
}

/* Wrong use ends in messages that say what is wrong. */
static void wrong_use(void **state) {
  gh_context *ctx = *state;
  static const char *const wrong[][2] = {
      {"pair_style granhom/coulomb increment", "no value for increment"},
      {"pair_style granhom/coulomb increment often", "increment is manual or step, not often"},
      {"pair_style granhom/coulomb slip wet", "slip is projected or objective, not wet"},
      {"pair_style granhom/coulomb speed 3", "unknown keyword speed"},
      {"pair_coeff * * 100", "pair_coeff I J E_n E_t mu h"},
      {"pair_coeff * * -1 80 0.3 0",
       "Normal stiffness of pair granhom/coulomb must be positive and finite, not -1"},
      {"pair_coeff * * 100 0 0.3 0",
       "Tangential stiffness of pair granhom/coulomb must be positive and finite, not 0"},
      {"pair_coeff * * 100 80 -0.3 0",
       "Friction coefficient of pair granhom/coulomb must be finite and not negative, but is -0.3"},
      {"pair_coeff * * 100 80 0.3 -2",
       "Hardening of pair granhom/coulomb must be finite and not negative, but is -2"},
      {"fix h all granhom/history", "made by pair style granhom/coulomb"},
      {"compute w second granhom/stress", "wants the group all"},
      {"compute w all granhom/tangent x", "takes no arguments"},
      {"run_style respa 2 2\nrun 0", "does not run with run_style respa"},
      {"run 0\ngroup first id 1\ndelete_atoms group first compress no\nfix_modify granhom_history commit yes",
       "use run 0 before commit yes"},
      {"run 0\nfix_modify granhom_history commit no", "takes commit yes"},
      {"minimize 0 0 1 1", "use fix granhom/relax"},
      {"fix r all granhom/relax inner yes\nrun 1", "requires granhom/coulomb with increment manual"},
      {"fix r all granhom/relax inner maybe", "inner is yes or no, not maybe"},
  };
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    void *lmp = two_disks(ctx, "", "100 80 0.3 0", (double[2]){1.48, 0});
    char text[300], *line = text, *rest;
    gh_status status = GH_OK;
    snprintf(text, sizeof text, "%s", wrong[k][0]);
    for (; line && status == GH_OK; line = rest) {
      rest = strchr(line, '\n');
      if (rest) *rest++ = 0;
      status = gh_lmp_command(ctx, lmp, "%s", line);
    }
    FAILS(status, GH_ENGINE, wrong[k][1]);
    gh_lmp_close(&lmp);
  }
}

/* What the pair style cannot do is refused: newton on, three dimensions, no radii; a compute from before the
 * pair style, which has another number of columns. */
static void wrong_simulation(void **state) {
  gh_context *ctx = *state;
  static const char *const wrong[][4] = {
      {"dimension 2", "atom_style sphere", "newton on", "requires newton off"},
      {"dimension 3", "atom_style sphere", "newton off", "requires a 2d simulation"},
      {"dimension 2", "atom_style atomic", "newton off", "requires atom style sphere"},
      {"dimension 2", "atom_style sphere", "newton off", "must be defined after the pair style"}};
  static const char *const rest[] = {"region r block 0 9 0 8 -1 1", "create_box 1 r",
                                     "create_atoms 1 single 1 1 0", NULL};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    void *lmp;
    OK(gh_lmp_open(ctx, &lmp));
    for (int line = 0; line < 3; line++) command(ctx, lmp, wrong[k][line]);
    commands(ctx, lmp, rest);
    if (k == 2) command(ctx, lmp, "mass 1 1");
    if (k == 3) command(ctx, lmp, "compute c all granhom/contact/local");
    command(ctx, lmp, "pair_style granhom/coulomb");
    command(ctx, lmp, "pair_coeff * * 100 80 0.3 0");
    FAILS(gh_lmp_command(ctx, lmp, "run 0"), GH_ENGINE, wrong[k][3]);
    gh_lmp_close(&lmp);
  }
}

/* A hybrid may have one of the two pair styles, not both: computes and the relaxation would see half the
 * contacts. */
static void hybrids(void **state) {
  gh_context *ctx = *state;
  static const char *const lines[] = {"dimension 2",
                                      "atom_style sphere",
                                      "newton off",
                                      "region r block 0 9 0 8 -1 1",
                                      "create_box 2 r",
                                      "create_atoms 1 single 1 1 0",
                                      "create_atoms 2 single 1.95 1 0",
                                      "neighbor 0.3 bin",
                                      NULL};
  for (int both = 0; both < 2; both++) {
    void *lmp;
    OK(gh_lmp_open(ctx, &lmp));
    commands(ctx, lmp, lines);
    command(ctx, lmp,
            both ? "pair_style hybrid granhom/coulomb granhom/normal"
                 : "pair_style hybrid granhom/coulomb zero 2");
    command(ctx, lmp, both ? "pair_coeff 1 1 granhom/normal 100" : "pair_coeff 1 1 zero");
    command(ctx, lmp, both ? "pair_coeff 2 2 granhom/normal 100" : "pair_coeff 2 2 zero");
    command(ctx, lmp, "pair_coeff 1 2 granhom/coulomb 100 80 0.3 0");
    command(ctx, lmp, "fix h all viscous 0");
    if (both) {
      FAILS(gh_lmp_command(ctx, lmp, "compute s all granhom/stress\n"), GH_OK, "");
      FAILS(gh_lmp_command(ctx, lmp, "run 0"), GH_ENGINE, "has 1 granhom/normal and 1 granhom/coulomb");
    } else {
      command(ctx, lmp, "compute s all granhom/stress");
      command(ctx, lmp, "run 0");
      const double *stress = lammps_extract_compute(lmp, "s", 0, LMP_TYPE_VECTOR);
      NEAR("stress", stress[0], -100 * 0.05 * 0.95 / 72, 1e-13);
    }
    gh_lmp_close(&lmp);
  }
}

/* Restart files: with the same law they go on, with another law or style they are refused. */
static void restarts(void **state) {
  gh_context *ctx = *state;
  static const struct {
    const char *line, *words;
  } scripts[] = {
      {NULL, NULL},
      {"pair_style granhom/coulomb increment manual", NULL},
      {"pair_coeff * * 100 80 0.3 10", NULL},
      {"pair_coeff * * 100 80 0.2 10", "other coefficients of the types 1 and 1"},
      {"pair_style granhom/coulomb slip objective", "with slip projected, the script says objective"},
      {"pair_style granhom/coulomb rotations fixed", "with rotations free, the script says fixed"},
      {"pair_style granhom/normal\npair_coeff * * 100", "granhom/normal would drop"}};
  char file[] = "/tmp/granhom-restart-XXXXXX";
  const int handle = mkstemp(file);
  assert_true(handle >= 0);
  close(handle);
  double f[6], g[6];
  void *lmp = two_disks(ctx, "increment step", "100 80 0.3 10", (double[2]){1.48, 0});
  double **w;
  OK(gh_lmp_atom(ctx, lmp, "omega", &w));
  w[0][2] = 2;
  command(ctx, lmp, "run 7 post no");
  OK(gh_lmp_command(ctx, lmp, "write_restart %s", file));
  command(ctx, lmp, "run 0 post no");
  forces(ctx, lmp, 2, f);
  assert_true(fabs(f[2]) > 0.1);
  gh_lmp_close(&lmp);
  for (size_t k = 0; k < sizeof scripts / sizeof *scripts; k++) {
    OK(gh_lmp_open(ctx, &lmp));
    command(ctx, lmp, "newton off");
    OK(gh_lmp_command(ctx, lmp, "read_restart %s", file));
    char text[200];
    snprintf(text, sizeof text, "%s", scripts[k].line ? scripts[k].line : "");
    char *rest = strchr(text, '\n');
    if (rest) *rest++ = 0;
    if (*text) command(ctx, lmp, text);
    if (rest) command(ctx, lmp, rest);
    if (scripts[k].words) FAILS(gh_lmp_command(ctx, lmp, "run 0 post no"), GH_ENGINE, scripts[k].words);
    else {
      command(ctx, lmp, "run 0 post no");
      forces(ctx, lmp, 2, g);
      assert_memory_equal(f, g, sizeof f);
    }
    gh_lmp_close(&lmp);
  }
  unlink(file);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(same_as_native),
                                     TEST(no_memory),
                                     TEST(relaxes_as_native),
                                     TEST(damping_is_carried_on),
                                     TEST(increments_by_hand),
                                     TEST(increments_by_time_step),
                                     TEST(opening),
                                     TEST(history_taken_away),
                                     TEST(single_contacts),
                                     TEST(flips),
                                     TEST(tangents),
                                     TEST(wrong_use),
                                     TEST(wrong_simulation),
                                     TEST(hybrids),
                                     TEST(restarts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
