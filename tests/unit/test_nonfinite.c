/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Numbers that are not finite, huge or tiny: no solver takes them for convergence.
 *
 * The material is a neo-Hooke solid, which answers a chosen call, or all calls from there on, with a fault. */
#include "../help.h"
#include "../neo_hooke.h"
#include "granhom/control.h"
#include "granhom/macro.h"

#include <float.h>

typedef enum fault { NONE, NAN_STRESS, INF_STRESS, NAN_TANGENT, INF_TANGENT, HUGE_STRESS, SOFT } fault;

typedef struct material {
  double stiffness;
  fault kind;
  int from, to; /* calls with the fault, counted over all points */
  int calls;
} material;

typedef struct point {
  material *m;
} point;

static gh_status point_evaluate(void *data, const double F[4], unsigned want, double P[4], double A[16]) {
  material *m = ((point *)data)->m;
  (void)want;
  neo_hooke_of(3 * m->stiffness, 5 * m->stiffness, F, P, A);
  const int call = m->calls++;
  if (call < m->from || call >= m->to) return GH_OK;
  switch (m->kind) {
  case NAN_STRESS:
    P[2] = NAN;
    break;
  case INF_STRESS:
    P[3] = -INFINITY;
    break;
  case NAN_TANGENT:
    A[15] = NAN;
    break;
  case INF_TANGENT:
    A[3] = INFINITY;
    break;
  case HUGE_STRESS:
    P[3] = -DBL_MAX;
    break;
  case SOFT:
    memset(P, 0, 4 * sizeof *P), memset(A, 0, 16 * sizeof *A);
    break;
  default:
    break;
  }
  return GH_OK;
}

static gh_status point_keep(void *data) {
  (void)data;
  return GH_OK;
}

static const gh_point_ops point_ops = {point_evaluate, point_keep, point_keep, free, NULL};

/* ---- base ---- */

static void helpers_see_nan(void **state) {
  (void)state;
  assert_true(gh_within(1, 2) && gh_within(2, 2) && !gh_within(3, 2));
  assert_false(gh_within(NAN, 2) || gh_within(1, NAN) || gh_within(INFINITY, INFINITY) ||
               gh_within(1, INFINITY));
  assert_false(gh_within(-INFINITY, 2));
  assert_true(gh_max(1, 2) == 2 && gh_max(2, 1) == 2 && isnan(gh_max(NAN, 1)) && isnan(gh_max(1, NAN)));
  for (int at = 0; at < 3; at++) {
    double a[3] = {1, -5, 2};
    assert_true(gh_largest(a, 3) == 5);
    a[at] = NAN;
    assert_true(isnan(gh_largest(a, 3)) && isnan(gh_norm(a, 3)));
    a[at] = -INFINITY;
    assert_true(isinf(gh_largest(a, 3)) && isinf(gh_norm(a, 3)));
  }
}

/* 3, 4, 12 and 13; the plain formula to the bit where it is in range. */
static void norms_have_no_range(void **state) {
  (void)state;
  const double scale[] = {1, 1e-300, 1e-160, 1e-140, 1e-20, 1e20, 1e140, 1e160, 1e306};
  for (size_t k = 0; k < sizeof scale / sizeof *scale; k++) {
    const double a[3] = {3 * scale[k], -4 * scale[k], 12 * scale[k]};
    assert_true(fabs(gh_norm(a, 3) / (13 * scale[k]) - 1) < 1e-15);
  }
  const double b[3] = {0.1, -0.7, 1.3}, zero[2] = {0, -0.0};
  assert_true(gh_norm(b, 3) == sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]));
  assert_true(gh_norm(zero, 2) == 0 && gh_norm(NULL, 0) == 0);
}

/* ---- one point under prescribed stresses and strains ---- */

static gh_status control_run(gh_context *ctx, material *m, double scale, double F[4], double *mismatch) {
  static const char *const words[] = {"s11", "F12", "F21", "F22"};
  gh_condition condition[4];
  for (int k = 0; k < 4; k++) OK(gh_condition_parse(ctx, words[k], condition + k));
  const double target[4] = {-0.3 * scale, 0.02, 0, 0.9}, one[4] = {1, 0, 0, 1};
  gh_control_options o = gh_control_defaults();
  o.stiffness = scale;
  o.pass_jumps = false;
  gh_control *control;
  gh_control_report report;
  point p = {m};
  OK(gh_control_create(ctx, &point_ops, &p, &o, &control));
  gh_status status = gh_control_start(control, one);
  if (status == GH_OK) status = gh_control_solve(control, condition, target, &report);
  memcpy(F, gh_control_F(control), 4 * sizeof *F);
  *mismatch = report.mismatch;
  gh_control_destroy(&control);
  return status;
}

static void control_survives_one_fault(void **state) {
  gh_context *ctx = *state;
  double right[4], F[4], mismatch;
  material m = {.stiffness = 1};
  OK(control_run(ctx, &m, 1, right, &mismatch));
  for (int kind = NAN_STRESS; kind < HUGE_STRESS; kind++)
    for (int call = 1; call < 4; call++) {
      m = (material){.stiffness = 1, .kind = (fault)kind, .from = call, .to = call + 1};
      OK(control_run(ctx, &m, 1, F, &mismatch));
      assert_true(m.calls > call);
      for (int k = 0; k < 4; k++) assert_true(fabs(F[k] - right[k]) < 1e-6);
      assert_true(mismatch <= 1e-6);
    }
}

static void control_fails_under_lasting_faults(void **state) {
  gh_context *ctx = *state;
  for (int kind = NAN_STRESS; kind <= SOFT; kind++)
    for (int call = 0; call < 3; call++) {
      double F[4], mismatch;
      material m = {.stiffness = 1, .kind = (fault)kind, .from = call, .to = 1 << 30};
      if (kind == HUGE_STRESS || (kind == SOFT && call != 1))
        continue; /* what it prescribes may be met by these */
      assert_int_equal(control_run(ctx, &m, 1, F, &mismatch), GH_DIVERGED);
      if (kind < HUGE_STRESS) assert_non_null(strstr(gh_message(ctx), "not finite"));
      assert_true(gh_finite(F, 4));
    }
}

static void control_has_no_units(void **state) {
  gh_context *ctx = *state;
  double right[4], F[4], mismatch;
  material m = {.stiffness = 1};
  OK(control_run(ctx, &m, 1, right, &mismatch));
  const double scale[] = {1e-250, 1e-160, 1e-100, 1e100, 1e160, 1e250};
  for (size_t k = 0; k < sizeof scale / sizeof *scale; k++) {
    m = (material){.stiffness = scale[k]};
    OK(control_run(ctx, &m, scale[k], F, &mismatch));
    for (int a = 0; a < 4; a++) assert_true(fabs(F[a] - right[a]) < 1e-6);
  }
}

/* ---- the macro problem ---- */

typedef struct body {
  gh_mesh *mesh;
  gh_farm *farm;
  gh_loads *loads;
  gh_macro *macro;
  gh_macro_report report;
} body;

static void body_make(gh_context *ctx, body *b, material *m, gh_tangent tangent, double size) {
  const double low[2] = {0, 0}, extent[2] = {size, size};
  OK(gh_mesh_rectangle(ctx, low, extent, (const int[2]){2, 2}, &b->mesh));
  void *points[16];
  for (int k = 0; k < 16; k++) {
    point *p = points[k] = malloc(sizeof *p);
    p->m = m;
  }
  OK(gh_farm_create(ctx, 16, &point_ops, points, &b->farm));
  gh_macro_options o = gh_macro_defaults();
  o.tangent = tangent;
  OK(gh_macro_create(ctx, b->mesh, b->farm, &o, &b->macro));
  OK(gh_loads_create(ctx, b->mesh, &b->loads));
  OK(gh_loads_displace(b->loads, gh_mesh_find(b->mesh, "left"), 0, 0));
  OK(gh_loads_displace(b->loads, gh_mesh_find(b->mesh, "bottom"), 1, 0));
}

static void body_drop(body *b) {
  gh_macro_destroy(&b->macro);
  gh_loads_destroy(&b->loads);
  gh_farm_destroy(&b->farm);
  gh_mesh_destroy(&b->mesh);
}

static gh_status body_press(gh_context *ctx, body *b, double force) {
  OK(gh_loads_force(b->loads, gh_mesh_find(b->mesh, "top"), (double[2]){0.3 * force, -force}));
  return gh_macro_solve(b->macro, b->loads, &b->report);
}

static double body_height(const body *b) {
  return gh_macro_u(b->macro)[2 * 8 + 1];
}

static void newton_survives_one_fault(void **state) {
  gh_context *ctx = *state;
  body b;
  material m = {.stiffness = 1};
  body_make(ctx, &b, &m, GH_TANGENT_ALGORITHMIC, 1);
  OK(body_press(ctx, &b, 0.2));
  const double right = body_height(&b);
  const int calls = m.calls;
  assert_true(right < -0.01);
  body_drop(&b);
  for (int kind = NAN_STRESS; kind <= HUGE_STRESS; kind++)
    for (int call = 16; call < calls; call += 7) {
      m = (material){.stiffness = 1, .kind = (fault)kind, .from = call, .to = call + 1};
      body_make(ctx, &b, &m, GH_TANGENT_ALGORITHMIC, 1);
      OK(body_press(ctx, &b, 0.2));
      assert_true(fabs(body_height(&b) / right - 1) < 1e-6);
      assert_true(b.report.relative <= 1e-8);
      body_drop(&b);
    }
}

static void newton_fails_under_lasting_faults(void **state) {
  gh_context *ctx = *state;
  for (int tangent = GH_TANGENT_ALGORITHMIC; tangent <= GH_TANGENT_ELASTIC; tangent++)
    for (int kind = NAN_STRESS; kind <= SOFT; kind++) {
      body b;
      material m = {.stiffness = 1, .kind = (fault)kind, .from = 16, .to = 1 << 30};
      body_make(ctx, &b, &m, (gh_tangent)tangent, 1);
      assert_int_equal(body_press(ctx, &b, 0.2), GH_DIVERGED);
      if (kind < HUGE_STRESS) assert_non_null(strstr(gh_message(ctx), "not finite"));
      assert_true(gh_finite(gh_macro_u(b.macro), 18) && gh_finite(gh_macro_reactions(b.macro), 18));
      assert_true(gh_finite(&b.report.relative, 1) && gh_finite(&b.report.residual, 1));
      body_drop(&b);
    }
}

static void fails_at(gh_context *ctx, body *b, gh_status status, const char *words) {
  gh_energy e;
  assert_int_equal(status, GH_DIVERGED);
  if (words && !strstr(gh_message(ctx), words)) fail_msg("%s", gh_message(ctx));
  assert_true(b->report.relative > 1e-8);
  gh_macro_energy(b->macro, &e);
  assert_true(isfinite(e.inner_work) && isfinite(e.outer_work));
  body_drop(b);
}

/* Squares of these loads overflow, or the loads themselves where they are added up. */
static void loads_beyond_squares_do_not_converge(void **state) {
  gh_context *ctx = *state;
  for (int tangent = GH_TANGENT_ALGORITHMIC; tangent <= GH_TANGENT_ELASTIC; tangent++) {
    material m = {.stiffness = 1};
    body b;
    const gh_tangent t = (gh_tangent)tangent;
    body_make(ctx, &b, &m, t, 1);
    fails_at(ctx, &b, body_press(ctx, &b, 1e160), NULL);
    body_make(ctx, &b, &m, t, 1);
    OK(gh_loads_gravity(b.loads, (double[2]){0, -1e170}));
    fails_at(ctx, &b, body_press(ctx, &b, 0), NULL);
    body_make(ctx, &b, &m, t, 1);
    OK(gh_loads_pressure(b.loads, gh_mesh_find(b.mesh, "right"), 1e200, true));
    fails_at(ctx, &b, body_press(ctx, &b, 0), NULL);
    body_make(ctx, &b, &m, t, 1);
    const int top = gh_mesh_find(b.mesh, "top"), bottom = gh_mesh_find(b.mesh, "bottom");
    gh_loads_clear(b.loads);
    for (int i = 0; i < 2; i++) OK(gh_loads_displace(b.loads, bottom, i, 0));
    OK(gh_loads_footing(b.loads, top, (double[2]){0.5, 1}, (double[2]){0, -1e160}));
    fails_at(ctx, &b, body_press(ctx, &b, 0), NULL);
    body_make(ctx, &b, &m, t, 1);
    OK(gh_loads_displace(b.loads, top, 1, -1e200));
    fails_at(ctx, &b, gh_macro_solve(b.macro, b.loads, &b.report), NULL);
    body_make(ctx, &b, &m, t, 1);
    for (int k = 0; k < 2; k++) OK(gh_loads_force(b.loads, top, (double[2]){0, -1.5e308}));
    b.report.relative = 1;
    fails_at(ctx, &b, gh_macro_solve(b.macro, b.loads, NULL), "not a finite number");
  }
}

static void newton_has_no_units(void **state) {
  gh_context *ctx = *state;
  const double scale[] = {1, 1e-250, 1e-160, 1e-100, 1e100, 1e160, 1e250}, size[] = {1, 1e-70, 1e70};
  double right = 0;
  for (int tangent = GH_TANGENT_ALGORITHMIC; tangent <= GH_TANGENT_ELASTIC; tangent++)
    for (size_t k = 0; k < sizeof scale / sizeof *scale; k++)
      for (size_t s = 0; s < 3; s++) {
        body b;
        material m = {.stiffness = scale[k]};
        if (fabs(log10(scale[k])) + fabs(log10(size[s])) > 250.5) continue;
        body_make(ctx, &b, &m, (gh_tangent)tangent, size[s]);
        OK(body_press(ctx, &b, 0.2 * scale[k] * size[s]));
        if (right == 0) right = body_height(&b);
        assert_true(right < -0.01 && fabs(body_height(&b) / size[s] / right - 1) < 1e-6);
        assert_true(b.report.iterations > 2);
        body_drop(&b);
      }
}

/* ---- packings ---- */

/* Two by two disks that press each other, of radius r, in a cell of 3.9 r. */
static gh_packing *four_disks(gh_context *ctx, double r) {
  const double side = 3.9 * r, cell[4] = {side, 0, 0, side};
  double x[8], radius[4];
  for (int i = 0; i < 4; i++) {
    x[2 * i] = side * (0.25 + 0.5 * (i % 2)), x[2 * i + 1] = side * (0.25 + 0.5 * (i / 2));
    radius[i] = r;
  }
  return make_packing(ctx, 4, cell, radius, x);
}

/* Of the lattice: four contacts along x, of length 1.95 r f and overlap (2 - 1.95 f) r, in the area (3.9
 * r)^2. */
static double lattice_stress(double E, double f) {
  return -E * (2 - 1.95 * f) * 4 * 1.95 / (3.9 * 3.9);
}

/* The right stress, or a refusal that states why; the number of refusals. */
static int unit_check(gh_context *ctx, gh_engine_kind engine, gh_boundary b, double r, double E,
                      bool friction) {
  const double F[4] = {0.99, 0, 0, 1.001};
  double P[4] = {0}, A[16];
  gh_rve_options o = rve_options(engine, b, E, 1e-8);
  if (friction) o.law.friction = 1, o.law.friction_coefficient = 0.3, o.law.tangential_stiffness = E;
  gh_rve *rve = NULL;
  gh_packing *packing = four_disks(ctx, r);
  gh_status status = gh_rve_create(ctx, packing, &o, &rve);
  if (status == GH_OK) OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
  else FAILS(status, GH_INPUT, "choose other units");
  if (status == GH_OK && (b == GH_TAYLOR_CELL || b == GH_PERIODIC))
    NEAR("stress", P[0] / E, lattice_stress(1, 0.99), 1e-9);
  if (status == GH_OK) assert_true(P[0] / E < -0.01 && isfinite(A[0]));
  gh_rve_destroy(&rve);
  gh_packing_destroy(&packing);
  return status != GH_OK;
}

static void packings_have_units_or_are_refused(void **state) {
  const double size[] = {1e-160, 1e-130, 1e-100, 1, 1e100, 1e130, 1e150},
               stiffness[] = {1e-300, 1e-160, 1e-90, 1, 1e90, 1e160, 1e300};
  int refused = 0, all = 0;
  for (int engine = 0; engine < 2; engine++)
    for (int b = 0; b < 4; b++)
      for (int s = 0; s < 7; s++)
        for (int e = 0; e < 7; e++, all++)
          refused += unit_check(*state, engine ? GH_ENGINE_LAMMPS : GH_ENGINE_NATIVE, all_boundaries[b],
                                size[s], stiffness[e], (s + e) % 2);
  assert_int_equal(refused,
                   8 * (49 - 7)); /* lengths of 1 with three stiffnesses, and of 1e+-100 with two each */
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(helpers_see_nan),
                                     TEST(norms_have_no_range),
                                     TEST(control_survives_one_fault),
                                     TEST(control_fails_under_lasting_faults),
                                     TEST(control_has_no_units),
                                     TEST(newton_survives_one_fault),
                                     TEST(newton_fails_under_lasting_faults),
                                     TEST(loads_beyond_squares_do_not_converge),
                                     TEST(newton_has_no_units),
                                     TEST(packings_have_units_or_are_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
