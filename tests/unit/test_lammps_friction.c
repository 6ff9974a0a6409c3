/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The LAMMPS engine with friction against the native one. */
#include "friction_help.h"

enum { ENGINES = 2 };

static const gh_engine_kind KINDS[ENGINES] = {GH_ENGINE_LAMMPS, GH_ENGINE_NATIVE};
static const double E = 100;

static gh_contact_law law_of(double mu) {
  return (gh_contact_law){
      .normal_stiffness = E, .friction = 1, .tangential_stiffness = E, .friction_coefficient = mu};
}

/* A random packing, its cell tilted by up to twice its width, and a random law. */
static gh_contact_law draw_trial(gh_context *ctx, unsigned long long *seed, int trial, int n, double largest,
                                 sample *s) {
  draw_tilted(ctx, seed, n, largest, trial % 4 ? 0.5 : 4, trial % 7 != 6, s);
  gh_contact_law law = random_law(seed, trial);
  law.friction_coefficient = 0.5 * uniform(seed);
  law.fixed_rotations = trial % 5 == 4;
  return law;
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
    const gh_contact_law law = draw_trial(ctx, &seed, trial, n, trial % 3 ? 0.5 : 0.13, &s);
    gh_engine *g[ENGINES];
    gh_contact_list list[ENGINES];
    for (int k = 0; k < ENGINES; k++) {
      g[k] = make_engine_of(ctx, KINDS[k], &s, law, NULL);
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

#define SAME(a, b) assert_memory_equal(a, b, sizeof *(a))

/* To the last bit; member by member, as the bytes between members may hold anything. */
static void assert_equal(const gh_contact_list *a, const gh_contact_list *b) {
  assert_int_equal(a->count, b->count);
  for (int c = 0; c < a->count; c++) {
    const gh_contact *p = &a->contacts[c], *q = &b->contacts[c];
    const gh_friction *s = &a->friction[c], *t = &b->friction[c];
    assert_true(p->i == q->i && p->j == q->j);
    SAME(&p->l, &q->l);
    SAME(&p->f, &q->f);
    SAME(&p->h, &q->h);
    SAME(&p->overlap, &q->overlap);
    SAME(&p->energy, &q->energy);
    assert_true(s->slip.i == t->slip.i && s->slip.j == t->slip.j);
    SAME(&s->slip.image, &t->slip.image);
    SAME(&s->slip.gamma, &t->slip.gamma);
    SAME(&s->slip.gamma_pl, &t->slip.gamma_pl);
    SAME(&s->slip.alpha, &t->slip.alpha);
    SAME(&s->force, &t->force);
    SAME(&s->couple, &t->couple);
    SAME(&s->d, &t->d);
    SAME(&s->energy, &t->energy);
    SAME(&s->dissipated, &t->dissipated);
    assert_int_equal(s->slides, t->slides);
  }
}

/* What comes back depends on state n, cell, positions and rotations only, to the last bit. */
static void no_memory(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 42;
  static sample s, other;
  const gh_contact_law law = draw_trial(ctx, &seed, 1, 40, 0.12, &s);
  draw_trial(ctx, &seed, 0, 40, 0.12, &other);
  memcpy(other.radius, s.radius, sizeof s.radius);
  other.nslips = 0;
  const gh_relax_options o = {.tolerance = 1e-6, .max_steps = 2000, .method = GH_RELAX_DAMPED};
  gh_engine *fresh = make_engine_of(ctx, GH_ENGINE_LAMMPS, &s, law, NULL),
            *used = make_engine_of(ctx, GH_ENGINE_LAMMPS, &s, law, NULL);
  gh_relax_result r[2];
  gh_contact_list a, b;
  put(ctx, used, &other);
  OK(gh_engine_relax(used, &o, r));
  put(ctx, used, &s);
  put(ctx, fresh, &s);
  for (int step = 0; step < 2; step++) {
    OK(gh_engine_contacts(fresh, &a));
    OK(gh_engine_contacts(used, &b));
    assert_equal(&a, &b);
    assert_memory_equal(a.moment, b.moment, (size_t)s.n * sizeof *a.moment);
    OK(gh_engine_relax(fresh, &o, &r[0]));
    OK(gh_engine_relax(used, &o, &r[1]));
    assert_int_equal(r[0].steps, r[1].steps);
  }
  gh_engine_destroy(&fresh);
  gh_engine_destroy(&used);
}

/* Where the residual does not come down any more, the least damping is doubled every thousand steps, from
 * list to list; a relaxation that is continued begins with what there was; behind the largest it is the
 * first again. */
static void damping_is_carried_on(void **state) {
  gh_context *ctx = *state;
  static sample s;
  const double F[4] = {0.998, 0.002, 0, 0.999};
  case_sample(ctx, "p20", F, 0, &s);
  for (int m = 0; m < ENGINES; m++) {
    gh_engine *g = make_engine_of(ctx, KINDS[m], &s, law_of(0.5), NULL);
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
 * is what the forces say. Fixed grains stay and turn. */
static void relaxes_as_native(void **state) {
  gh_context *ctx = *state;
  static sample s;
  unsigned char held[MOST] = {0};
  for (int i = 0; i < MOST; i += 9) held[i] = 1;
  for (int k = 0; k < 6; k++) {
    const double F[4] = {0.998, 0.002, 0, 0.999};
    case_sample(ctx, "p150d", F, k % 2, &s);
    const unsigned char *who = k % 3 == 1 ? held : NULL;
    s.periodic = k != 4;
    gh_relax_result r[ENGINES];
    double x[ENGINES][2 * MOST], theta[ENGINES][MOST];
    gh_contact_list list;
    for (int m = 0; m < ENGINES; m++) {
      gh_engine *g = make_engine_of(ctx, KINDS[m], &s, law_of(k % 3 == 2 ? 0.1 : 0.5), who);
      put(ctx, g, &s);
      OK(gh_engine_relax(
          g, &(gh_relax_options){.tolerance = 1e-11, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r[m]));
      assert_true(r[m].converged && r[m].residual <= 1e-11);
      OK(gh_engine_get(g, x[m], theta[m]));
      OK(gh_engine_contacts(g, &list));
      double largest = 0;
      for (int i = 0; i < s.n; i++) {
        if (!who || !held[i]) largest = fmax(largest, hypot(list.force[2 * i], list.force[2 * i + 1]));
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

/* Two grains that were on the list when it was made are moved apart beyond reach and skin, each by less than
 * half the skin, and relaxation presses them together: four in a row between fixed ones, 0.08 too long for its
 * place, so that each of three contacts has a third of that. */
static void pairs_of_the_list_come_back(void **state) {
  gh_context *ctx = *state;
  static const unsigned char held[4] = {0, 0, 1, 1};
  const double at_list[8] = {0, 0, 2.1, 0, -1.91, 0, 4.01, 0}, third = 0.08 / 3;
  for (int m = 0; m < 4; m++) {
    const gh_engine_kind kind = m & 1 ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS;
    gh_contact_law law = LAW;
    sample s = {.n = 4, .radius = {1, 1, 1, 1}};
    double x[8], theta[4];
    gh_relax_result r;
    gh_contact_list list;
    if (!use_engine(kind)) continue;
    law.friction = m / 2;
    memcpy(s.x_n, at_list, sizeof at_list);
    memcpy(s.x, at_list, sizeof at_list);
    gh_engine *e = make_engine_of(ctx, kind, &s, law, held);
    const gh_converged n = state_n(&s);
    if (law.friction) OK(gh_engine_begin(e, &n));
    OK(gh_engine_set(e, s.cell, s.x, s.theta));
    s.x[0] -= 0.09, s.x[2] += 0.09;
    OK(gh_engine_move(e, s.x, s.theta));
    OK(gh_engine_relax(e, &(gh_relax_options){.tolerance = 1e-9, .floor = 1e-9, .max_steps = 1000}, &r));
    assert_true(r.converged);
    OK(gh_engine_get(e, x, theta));
    NEAR("left grain", x[0], 0.09 - third, 1e-9);
    NEAR("right grain", x[2], 2.01 + third, 1e-9);
    OK(gh_engine_contacts(e, &list));
    assert_int_equal(list.count, 3);
    gh_engine_destroy(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(same_as_native), TEST(no_memory), TEST(relaxes_as_native),
                                     TEST(damping_is_carried_on), TEST(pairs_of_the_list_come_back)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
