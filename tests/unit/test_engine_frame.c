/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Supports of single components, external loads, shared contacts and the constraint of uniform traction, in both
 * engines. */
#include "ramp_help.h"

static const gh_relax_options RELAX = {.tolerance = 1e-10, .max_steps = 200000, .method = GH_RELAX_DAMPED};
static const gh_contact_law SMOOTH = {.normal_stiffness = 100}, ROUGH = {.normal_stiffness = 100,
                                                                         .friction = 1,
                                                                         .tangential_stiffness = 50,
                                                                         .friction_coefficient = 10};

static gh_engine *engine_at(gh_context *ctx, gh_engine_kind kind, const gh_engine_setup *setup,
                            const double *x, const double *theta) {
  gh_engine *e;
  const gh_converged n = {.x = x, .theta = theta};
  OK(gh_engine_create(ctx, kind, setup, &e));
  OK(gh_engine_begin(e, &n));
  OK(gh_engine_set(e, NULL, x, theta));
  return e;
}

/* A grain is pushed on a fixed one with a force: the overlap is force over stiffness. */
static void load_on_two(void **state) {
  gh_context *ctx = *state;
  const double radius[2] = {1, 1}, x[4] = {0, 0, 1.9, 0}, theta[2] = {0}, force[4] = {0, 0, -12, 0};
  const unsigned char held[2] = {1, 0};
  const gh_engine_setup setup = {.n = 2, .radius = radius, .held = held, .law = SMOOTH};
  for (int m = 0; m < ENGINES; m++) {
    if (!use_engine(KINDS[m])) continue;
    double at[4];
    gh_relax_result r;
    gh_engine *e = engine_at(ctx, KINDS[m], &setup, x, theta);
    OK(gh_engine_load(e, force, NULL));
    OK(gh_engine_relax(e, &RELAX, &r));
    OK(gh_engine_get(e, at, NULL));
    assert_true(r.converged);
    NEAR("overlap", 2 - at[2], 0.12, 1e-10);
    OK(gh_engine_load(e, NULL, NULL)); /* nothing pushes any longer */
    OK(gh_engine_relax(e, &RELAX, &r));
    OK(gh_engine_get(e, at, NULL));
    assert_true(2 - at[2] < 1e-3);
    gh_engine_destroy(&e);
  }
}

/* A grain that may move up and down alone lies on a slope of two fixed ones; another, fixed where it is, is turned
 * against one of them by a moment: r E_t r theta = m. */
static void components_and_moment(void **state) {
  gh_context *ctx = *state;
  const double radius[3] = {1, 1, 1}, x[6] = {0, 0, 1.2, 1.55, 1.9, 0}, theta[3] = {0},
               force[6] = {0, 0, 0, -5, 0, 0}, moment[3] = {0, 0, 0.3}, none[6] = {0};
  const unsigned char held[3] = {1, 0, 1}, slides[3] = {0, GH_FIXED_X | GH_FIXED_TURN, 0},
                      turns[3] = {GH_FIXED_TURN, GH_FIXED_TURN, 0};
  gh_engine_setup setup = {.n = 3, .radius = radius, .held = held, .fixed = slides, .law = SMOOTH};
  for (int m = 0; m < ENGINES; m++) {
    if (!use_engine(KINDS[m])) continue;
    double at[6], turned[3], up = 0;
    gh_relax_result r;
    gh_contact_list list;
    setup.law = SMOOTH, setup.fixed = slides;
    gh_engine *e = engine_at(ctx, KINDS[m], &setup, x, theta);
    OK(gh_engine_load(e, force, NULL));
    OK(gh_engine_relax(e, &RELAX, &r));
    OK(gh_engine_get(e, at, NULL));
    OK(gh_engine_contacts(e, &list));
    up = list.force[3];
    NEAR("across", at[2], x[2], 0);
    NEAR("supported", up, 5, 1e-8);
    gh_engine_destroy(&e);
    setup.law = ROUGH, setup.fixed = turns;
    const double apart[6] = {0, 0, 1, 9, 1.9, 0};
    const unsigned char all[3] = {1, 1, 1};
    setup.held = all;
    e = engine_at(ctx, KINDS[m], &setup, apart, theta);
    OK(gh_engine_load(e, none, moment));
    OK(gh_engine_relax(e, &RELAX, &r));
    OK(gh_engine_get(e, at, turned));
    NEAR("fixed rotation", turned[0], 0, 0);
    NEAR("rotation", turned[2], 0.3 / (50 * 0.95 * 0.95),
         1e-9); /* slip and couple are scaled by |l|/(r_i+r_j) */
    setup.held = held;
    gh_engine_destroy(&e);
  }
}

/* A contact of two grains on one edge counts half, on two a quarter: so much more they overlap under a load. */
static void shares(void **state) {
  gh_context *ctx = *state;
  enum { LEFT = 1, RIGHT = 2, LOW = 4, HIGH = 8 };
  const double radius[2] = {1, 1}, theta[2] = {0}, x[4] = {0, 0, 0, 1.9}, load[4] = {0, 0, 0, -3},
               back[4] = {0, 3, 0, -3};
  const unsigned char held[2] = {1, 0}, edges[3][2] = {{LEFT | LOW, RIGHT | HIGH},
                                                       {LEFT | LOW, LEFT | HIGH},
                                                       {LEFT | LOW, LEFT | LOW}};
  for (int m = 0; m < ENGINES; m++) {
    if (!use_engine(KINDS[m])) continue;
    for (int k = 0; k < 6; k++) {
      const gh_engine_setup setup = {.n = 2,
                                     .radius = radius,
                                     .held = k < 3 ? held : NULL,
                                     .edges = edges[k % 3],
                                     .law = k % 2 ? ROUGH : SMOOTH};
      double at[4], turned[2];
      gh_relax_result r;
      gh_engine *e = engine_at(ctx, KINDS[m], &setup, x, theta);
      OK(gh_engine_load(e, k < 3 ? load : back, NULL));
      OK(gh_engine_relax(e, &RELAX, &r));
      OK(gh_engine_get(e, at, turned));
      assert_true(r.converged);
      NEAR("overlap", 2 - hypot(at[2] - at[0], at[3] - at[1]), 0.03 * (1 << k % 3), 1e-9);
      gh_engine_destroy(&e);
    }
  }
}

/* Four grains in a square under the constraint of uniform traction: sums of position and area stay, and the forces
 * that are left are those along the areas. The same with friction, along a ramp, in both engines. */
static void constraint(void **state) {
  gh_context *ctx = *state;
  const double radius[4] = {1, 1, 1, 1}, area[8] = {-1, -1, 1, -1, 1, 1, -1, 1};
  const double x[8] = {0, 0, 1.9, 0.03, 1.91, 1.92, -0.02, 1.9}, theta[4] = {0},
               to[4] = {0.99, 0.004, 0, 1.01};
  for (int rough = 0; rough < 2; rough++) {
    double at[ENGINES][8] = {{0}};
    for (int m = 0; m < ENGINES; m++) {
      const gh_engine_setup setup = {.n = 4, .radius = radius, .area = area, .law = rough ? ROUGH : SMOOTH};
      double sum[4] = {0}, turned[4];
      gh_relax_result r;
      if (!use_engine(KINDS[m])) continue;
      gh_engine *e = engine_at(ctx, KINDS[m], &setup, x, theta);
      if (rough) {
        const gh_ramp ramp = ramp_to(to, 100, 1e-10);
        gh_ramp_result end;
        OK(gh_engine_ramp(e, &ramp, &end));
        assert_true(end.relaxed.converged);
      } else {
        OK(gh_engine_relax(e, &RELAX, &r));
        assert_true(r.converged);
      }
      OK(gh_engine_get(e, at[m], turned));
      for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
          double before[2];
          gh_apply2(to, &x[2 * i], before);
          sum[k] += (at[m][2 * i + k / 2] - (rough ? before : &x[2 * i])[k / 2]) * area[2 * i + k % 2];
        }
      for (int k = 0; k < 4; k++) NEAR("constraint", sum[k], 0, 1e-13);
      NEAR("it moved", distance(at[m], x, 8) > 1e-3, 1, 0);
      gh_engine_destroy(&e);
    }
    if (use_engine(GH_ENGINE_LAMMPS)) NEAR("engines", distance(at[0], at[1], 8), 0, 1e-9);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(load_on_two), TEST(components_and_moment), TEST(shares),
                                     TEST(constraint)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
