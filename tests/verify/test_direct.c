/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Direct simulation: lattices in closed form, the RVE's stress in a patch, balance of reactions and pressures,
 * symmetry, objectivity, states. */
#include "../help.h"
#include "granhom/direct.h"

static const double E = 50;
enum { LEFT, RIGHT, BOTTOM, TOP, SETS };

/* A body of grains and what acts on it; loads are zero but for what a test sets. */
typedef struct body {
  gh_mesh *mesh;
  gh_direct *direct;
  gh_packing *grains;
  bool fixed[200];
  double value[200], dead[SETS], follow[SETS], force[2 * SETS];
  gh_direct_loads loads;
} body;

static gh_direct_options options_of(int friction, gh_integration integration) {
  return (gh_direct_options){.engine = GH_ENGINE_NATIVE,
                             .law = {.normal_stiffness = E,
                                     .friction = friction,
                                     .tangential_stiffness = 0.5 * E,
                                     .friction_coefficient = 0.3},
                             .tolerance = 1e-11,
                             .max_steps = 400000,
                             .relaxation = GH_RELAX_DAMPED,
                             .integration = integration,
                             .cut_steps = 4};
}

static void body_create(gh_context *ctx, const gh_packing *packing, double grains, const double size[2],
                        const int elements[2], const gh_direct_options *options, body *b) {
  *b = (body){0};
  OK(gh_mesh_rectangle(ctx, (double[2]){0, 0}, size, elements, &b->mesh));
  OK(gh_direct_fill(ctx, b->mesh, packing, grains, &b->grains));
  OK(gh_direct_create(ctx, b->mesh, SETS, b->grains, options, &b->direct));
  b->loads = (gh_direct_loads){
      .fixed = b->fixed, .value = b->value, .dead = b->dead, .follow = b->follow, .force = b->force};
}

static void body_destroy(body *b) {
  gh_direct_destroy(&b->direct);
  gh_packing_destroy(&b->grains);
  gh_mesh_destroy(&b->mesh);
}

static gh_direct_report body_solve(gh_context *ctx, body *b) {
  gh_direct_report report;
  OK(gh_direct_solve(b->direct, &b->loads, &report));
  return report;
}

static void set_fix(body *b, int set, int i, double value) {
  for (int k = 0; k < b->mesh->sets[set].nnodes; k++) {
    b->fixed[2 * b->mesh->sets[set].nodes[k] + i] = true;
    b->value[2 * b->mesh->sets[set].nodes[k] + i] = value;
  }
}

/* All edges follow F. */
static void edges_drive(body *b, const double F[4]) {
  for (int set = 0; set < SETS; set++)
    for (int k = 0; k < b->mesh->sets[set].nnodes; k++) {
      const int a = b->mesh->sets[set].nodes[k];
      double x[2];
      gh_apply2(F, b->mesh->X + 2 * a, x);
      for (int i = 0; i < 2; i++)
        b->fixed[2 * a + i] = true, b->value[2 * a + i] = x[i] - b->mesh->X[2 * a + i];
    }
}

/* Two grains of a triangular lattice whose rows are one apart, overlapping by `overlap`. low: where its corner is. */
static gh_packing lattice(double overlap, int *id, int *type, double *radius, double *x) {
  const double height = sqrt(3);
  for (int k = 0; k < 2; k++) id[k] = k + 1, type[k] = 1, radius[k] = (1 + overlap) / 2;
  x[0] = x[1] = 0, x[2] = 0.5, x[3] = height / 2;
  return (gh_packing){.n = 2, .id = id, .type = type, .radius = radius, .x = x, .cell = {1, 0, 0, height}};
}

static const double per_area = 1.1547005383792515; /* 2/sqrt(3) grains of that lattice */

/* The four elements in the middle of a patch whose edges are affine have the stress of the RVE. */
static void patch_is_rve(void **state) {
  static const double F[3][4] = {{0.97, 0.01, -0.02, 0.98}, {0.98, 0, 0, 0.97}, {0.8, -0.45, 0.45, 0.8}};
  gh_context *ctx = *state;
  int id[2], type[2];
  double radius[2], x[4];
  const gh_packing p = lattice(0.02, id, type, radius, x);
  const double size[2] = {16, 8 * sqrt(3)};
  for (int i = 0; i < 2; i++) x[2 * i] += 0.2, x[2 * i + 1] += 0.3; /* no row on the side of an element */
  for (int k = 0; k < 3; k++) {
    const gh_direct_options o = options_of(0, GH_INTEGRATION_RAMP);
    body b;
    gh_rve *rve;
    double P[4], cauchy[4];
    body_create(ctx, &p, size[0] * size[1] * per_area, size, (int[2]){4, 4}, &o, &b);
    edges_drive(&b, F[k]);
    body_solve(ctx, &b);
    gh_rve_options r = gh_rve_defaults();
    r.law = o.law, r.boundary = GH_PERIODIC, r.engine = GH_ENGINE_NATIVE, r.tolerance = 1e-11;
    OK(gh_rve_create(ctx, &p, &r, &rve));
    OK(gh_rve_evaluate(rve, F[k], 0, P, NULL));
    gh_cauchy2(P, F[k], cauchy);
    static const int middle[4] = {5, 6, 9, 10};
    for (int e = 0; e < 4; e++)
      for (int c = 0; c < 4; c++)
        NEAR("stress", gh_direct_cauchy(b.direct)[4 * middle[e] + c], cauchy[c], 1e-10 * norm(cauchy, 4));
    const gh_direct_measures *m = gh_direct_measure(b.direct);
    NEAR("area", m->current / m->volume, gh_det2(F[k]), 1e-12);
    NEAR("anisotropy", m->anisotropy > 0.2, 0, 0);
    gh_rve_destroy(&rve);
    body_destroy(&b);
  }
}

/* Rows under a plate: each grain but the outer ones stands on two. */
static void lattice_in_closed_form(void **state) {
  gh_context *ctx = *state;
  int id[2], type[2];
  double radius[2], x[4];
  const gh_packing p = lattice(0.02, id, type, radius, x);
  const double size[2] = {10, 4 * sqrt(3)}, shrink = 0.99;
  for (int friction = 0; friction < 2; friction++) {
    gh_direct_options o = options_of(friction, GH_INTEGRATION_WHOLE);
    o.law.fixed_rotations = 1; /* those at the edges would turn */
    body b;
    double sum[2], other[2];
    body_create(ctx, &p, size[0] * size[1] * per_area, size, (int[2]){2, 2}, &o, &b);
    edges_drive(&b, (double[4]){1, 0, 0, 1});
    body_solve(ctx, &b);
    edges_drive(&b, (double[4]){1, 0, 0, shrink});
    body_solve(ctx, &b);
    const double l[2] = {0.5, shrink * sqrt(3) / 2}, n[2] = {0.5, sqrt(3) / 2}, d = hypot(l[0], l[1]),
                 fn = E * (1.02 - d), slip = (n[1] * l[0] - n[0] * l[1]) / d, /* (7.5): -l_n . t */
        c = (n[0] * l[0] + n[1] * l[1]) / (d * d), ft = friction ? 0.5 * E * slip : 0;
    gh_direct_reaction(b.direct, TOP, sum);
    gh_direct_reaction(b.direct, BOTTOM, other);
    NEAR("plate", sum[1], -20 * (fn * l[1] + c * ft * l[0]) / d, 1e-8);
    NEAR("balance", sum[1] + other[1], 0, 1e-8);
    body_destroy(&b);
  }
}

/* Reactions balance pressures, dead and following, on a rough base and on rollers. */
static void reactions_balance(void **state) {
  gh_context *ctx = *state;
  gh_packing *p;
  const double size[2] = {30, 40}, pressure = 0.5;
  OK(gh_packing_read(ctx, "tests/data/cases/packings/p150.data", &p));
  for (int k = 0; k < 5; k++) {
    const bool follow = k % 2;
    const gh_direct_options o = options_of(1, k == 4 ? GH_INTEGRATION_WHOLE : GH_INTEGRATION_RAMP);
    body b;
    double sum[2];
    body_create(ctx, p, 300, size, (int[2]){3, 4}, &o, &b);
    set_fix(&b, BOTTOM, 1, 0);
    b.fixed[0] = true;
    if (k < 2) set_fix(&b, BOTTOM, 0, 0);
    double *load = follow ? b.follow : b.dead;
    load[LEFT] = load[RIGHT] = load[TOP] = pressure;
    gh_direct_report report = body_solve(ctx, &b);
    const gh_direct_measures *m = gh_direct_measure(b.direct);
    assert_true(report.residual <= 1e-10 && m->residual <= 1e-10 && m->contacts > 300);
    gh_direct_reaction(b.direct, BOTTOM, sum);
    if (!follow) NEAR("weight of the pressure", sum[1], pressure * size[0], 1e-7);
    else assert_true(sum[1] > 0.8 * pressure * size[0] && sum[1] < pressure * size[0]);
    NEAR("sideways", sum[0], 0, follow ? 0.05 * pressure * size[1] : 1e-7);
    double mean = 0, area = 0;
    for (int e = 0; e < 12; e++) mean += gh_direct_cauchy(b.direct)[4 * e + 3] / 12, area += 1;
    NEAR("mean stress", mean, -pressure, 0.1 * pressure);
    b.loads.gravity[1] = -1e-3;
    body_solve(ctx, &b);
    double heavier[2];
    gh_direct_reaction(b.direct, BOTTOM, heavier);
    if (!follow) NEAR("weight", heavier[1] - sum[1], 1e-3 * size[0] * size[1], 1e-7);
    body_destroy(&b);
  }
  gh_packing_destroy(&p);
}

/* A symmetric block under symmetric loads: displacements are mirrored. */
static void mirrored(void **state) {
  gh_context *ctx = *state;
  int id[2], type[2];
  double radius[2], x[4];
  const gh_packing p = lattice(0.02, id, type, radius, x);
  const double size[2] = {10, 4 * sqrt(3)};
  const gh_direct_options o = options_of(1, GH_INTEGRATION_WHOLE);
  body b;
  double sum[2];
  gh_rve_view v;
  body_create(ctx, &p, size[0] * size[1] * per_area, size, (int[2]){2, 2}, &o, &b);
  for (int i = 0; i < 2; i++) set_fix(&b, BOTTOM, i, 0), set_fix(&b, TOP, i, i ? -0.05 : 0);
  b.dead[LEFT] = b.dead[RIGHT] = 1;
  body_solve(ctx, &b);
  gh_direct_look(b.direct, &v);
  for (int i = 0; i < v.n; i++) {
    int twin = -1;
    for (int j = 0; j < v.n; j++)
      if (fabs(b.grains->x[2 * j] + b.grains->x[2 * i] - 10) < 1e-9 &&
          fabs(b.grains->x[2 * j + 1] - b.grains->x[2 * i + 1]) < 1e-9)
        twin = j;
    assert_true(twin >= 0);
    NEAR("x", v.x[2 * i] + v.x[2 * twin], 10, 1e-5);
    NEAR("y", v.x[2 * i + 1], v.x[2 * twin + 1], 1e-5);
  }
  gh_direct_reaction(b.direct, TOP, sum);
  NEAR("sideways", sum[0], 0, 1e-4);
  body_destroy(&b);
}

/* A loaded state continues to the same last bit. */
static void state_continues(void **state) {
  gh_context *ctx = *state;
  gh_packing *p;
  const double size[2] = {30, 30};
  OK(gh_packing_read(ctx, "tests/data/cases/packings/p150.data", &p));
  const gh_direct_options o = options_of(1, GH_INTEGRATION_RAMP);
  body b, c;
  body_create(ctx, p, 200, size, (int[2]){2, 2}, &o, &b);
  body_create(ctx, p, 200, size, (int[2]){2, 2}, &o, &c);
  for (int i = 0; i < 2; i++) set_fix(&b, BOTTOM, i, 0), set_fix(&b, TOP, i, 0);
  b.dead[LEFT] = b.dead[RIGHT] = 0.5;
  body_solve(ctx, &b);
  size_t n = gh_direct_state_size(b.direct);
  double *at = malloc(n * sizeof *at);
  assert_non_null(at);
  gh_direct_save(b.direct, at);
  OK(gh_direct_load(c.direct, at, n));
  FAILS(gh_direct_load(c.direct, at, n - 1), GH_INPUT, "does not fit");
  set_fix(&b, TOP, 1, -0.2);
  body_solve(ctx, &b);
  c.loads = b.loads;
  body_solve(ctx, &c);
  const size_t later = gh_direct_state_size(b.direct);
  assert_int_equal(later, gh_direct_state_size(c.direct));
  double *one = malloc(later * sizeof *one), *two = malloc(later * sizeof *two);
  assert_true(one && two);
  gh_direct_save(b.direct, one);
  gh_direct_save(c.direct, two);
  assert_memory_equal(one, two, later * sizeof *one);
  free(at);
  free(one);
  free(two);
  body_destroy(&b);
  body_destroy(&c);
  gh_packing_destroy(&p);
}

/* Both engines; work of the loads is what is stored, where nothing dissipates. */
static void engines_agree(void **state) {
  gh_context *ctx = *state;
  gh_packing *p;
  const double size[2] = {20, 20};
  double top[2][2];
  OK(gh_packing_read(ctx, "tests/data/cases/packings/p150.data", &p));
  for (int k = 0; k < 2; k++) {
    gh_direct_options o = options_of(0, GH_INTEGRATION_RAMP);
    body b;
    o.engine = k ? GH_ENGINE_LAMMPS : GH_ENGINE_NATIVE;
    body_create(ctx, p, 150, size, (int[2]){2, 2}, &o, &b);
    edges_drive(&b, (double[4]){0.99, 0, 0, 0.99});
    body_solve(ctx, &b);
    gh_direct_zero(b.direct);
    for (int step = 1; step <= 20; step++) {
      edges_drive(&b, (double[4]){0.99, 0, 0, 0.99 - 0.0001 * step});
      body_solve(ctx, &b);
    }
    gh_direct_reaction(b.direct, TOP, top[k]);
    const gh_direct_measures *m = gh_direct_measure(b.direct);
    NEAR("work", m->outer_work / m->energy, 1, 0.02);
    body_destroy(&b);
  }
  for (int i = 0; i < 2; i++) NEAR("engines", top[1][i], top[0][i], 1e-7 * norm(top[0], 2));
  gh_packing_destroy(&p);
}

static void refused(void **state) {
  gh_context *ctx = *state;
  gh_packing *p, *grains;
  gh_mesh *mesh;
  OK(gh_packing_read(ctx, "tests/data/cases/packings/p150.data", &p));
  OK(gh_mesh_rectangle(ctx, (double[2]){0, 0}, (double[2]){1000, 1}, (int[2]){10, 1}, &mesh));
  FAILS(gh_direct_fill(ctx, mesh, p, 1e-3, &grains), GH_INPUT, "");
  gh_mesh_destroy(&mesh);
  OK(gh_mesh_rectangle(ctx, (double[2]){5, 7}, (double[2]){30, 20}, (int[2]){3, 2}, &mesh));
  OK(gh_direct_fill(ctx, mesh, p, 600, &grains));
  assert_true(grains->n >= 600 && grains->n < 720);
  gh_packing_destroy(&grains);
  gh_mesh_destroy(&mesh);
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(patch_is_rve), TEST(lattice_in_closed_form), TEST(reactions_balance),
      TEST(mirrored),     TEST(state_continues),        TEST(engines_agree),
      TEST(refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
