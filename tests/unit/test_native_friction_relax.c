/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The native engine with friction: relaxation, and what its result must not depend on. */
#include "friction_help.h"

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

/* Relaxation meets the residual that it reports, in forces and moments; fixed grains stay, but turn; where
 * rotations are fixed, nothing turns and moments do not count. */
static void relaxation(void **state) {
  gh_context *ctx = *state;
  static sample s;
  unsigned char held[MOST] = {0};
  for (int i = 0; i < MOST; i += 7) held[i] = 1;
  for (int k = 0; k < 8; k++) {
    const double F[4] = {0.999, 0.002, 0, 0.9995};
    case_sample(ctx, k & 4 ? "p20" : "p150d", F, 0, &s);
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

/* Where all positions are fixed, rotations alone bring the moments to rest; two grains that stick turn by
 * what undoes the slip of the step, each by the half of it. */
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

/* A grain between two that cannot rotate, because each is one of a triangle: both contacts slide, one each
 * way, and a trifle more overlap on one side drives the grain on until the slip there has gone back to its
 * limit. On the way nothing resists; steps alone are not at rest after 200,000. */
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

/* Where the pair list is rebuilt does not matter: two engines come to the same positions from lists that
 * were made at different places, and the contacts are those of a list made at the end. */
static void lists_do_not_matter(void **state) {
  gh_context *ctx = *state;
  static sample s, start, end;
  unsigned long long seed = 34;
  const double F[4] = {1, 0, 0, 1};
  case_sample(ctx, "p50d", F, 0, &s);
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
  case_sample(ctx, "p150d", F, 0, &s);
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

int main(void) {
  const struct CMUnitTest tests[] = {TEST(relaxation),         TEST(only_rotations),
                                     TEST(a_grain_that_spins), TEST(lists_do_not_matter),
                                     TEST(moving_is_setting),  TEST(no_friction)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
