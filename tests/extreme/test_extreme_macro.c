/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The macro problem at the edges of what can be asked of it. */
#include "../loads_help.h"
#include "extreme.h"

static const char section[] = "Macro";

typedef struct problem {
  gh_context *ctx;
  gh_mesh *mesh;
  gh_farm *farm;
  gh_loads *loads;
  gh_macro *macro;
  gh_macro_report report;
} problem;

static gh_rve_options material(gh_boundary b, double E, double degrees) {
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, b, E, 1e-10);
  o.law.friction = degrees > 0;
  o.law.tangential_stiffness = 0.8 * E;
  o.law.friction_coefficient = tan(degrees * help_pi / 180);
  return o;
}

/* p->mesh is made already. */
static void make(problem *p, const gh_packing *packing, const gh_rve_options *o) {
  gh_context *ctx = p->ctx;
  gh_macro_options options = gh_macro_defaults();
  options.tolerance = 1e-10;
  OK(gh_mesh_check(ctx, p->mesh));
  OK(gh_farm_create_rves(ctx, 4 * p->mesh->nelements, packing, o, &p->farm));
  OK(gh_macro_create(ctx, p->mesh, p->farm, &options, &p->macro));
  OK(gh_loads_create(ctx, p->mesh, &p->loads));
}

static void drop(problem *p) {
  gh_macro_destroy(&p->macro);
  gh_loads_destroy(&p->loads);
  gh_farm_destroy(&p->farm);
  gh_mesh_destroy(&p->mesh);
}

static void rectangle(problem *p, gh_context *ctx, double w, double h, int m, int n) {
  const double low[2] = {0, 0}, size[2] = {w, h};
  const int elements[2] = {m, n};
  *p = (problem){.ctx = ctx};
  OK(gh_mesh_rectangle(ctx, low, size, elements, &p->mesh));
}

static void hold(problem *p, const char *set, int dir, double value) {
  loads_hold(p->ctx, p->loads, p->mesh, set, dir, value);
}

static void put(problem *p, double eccentricity, double fx, double fy) {
  loads_put(p->ctx, p->loads, p->mesh, gh_mesh_find(p->mesh, "top"), eccentricity, fx, fy);
}

/* A footing with an eccentric load on one element of sand, whatever the stiffness: it moves and turns alike.
 */
static void footing_on_one_element(void **state) {
  static const double stiffness[] = {1, 1e-6, 1e14};
  gh_context *ctx = *state;
  gh_packing *packing = case_packing(ctx, "p50d");
  double worst = 0;
  for (int friction = 0; friction < 2; friction++) FOR_BOUNDARIES(b) {
      double moved[3][3];
      for (int k = 0; k < 3; k++) {
        problem p;
        double E = stiffness[k];
        gh_rve_options o = material(*b, E, friction ? 20 : 0);
        rectangle(&p, ctx, 1, 1, 1, 1);
        make(&p, packing, &o);
        OK(gh_macro_balance(p.macro));
        for (int n = 1; n <= 4; n++) {
          gh_loads_clear(p.loads);
          hold(&p, "bottom", 0, 0), hold(&p, "bottom", 1, 0);
          put(&p, -0.1, 1e-3 * E * n / 4, -2e-2 * E * n / 4);
          OK(gh_macro_solve(p.macro, p.loads, &p.report));
        }
        gh_macro_footing(p.macro, gh_mesh_find(p.mesh, "top"), moved[k], &moved[k][2]);
        /* a ramp takes hundreds of steps, and round-off grows along them */
        WITHIN(&worst, "movement", relative(moved[k], moved[0], 3), friction ? 1e-7 : 1e-9);
        assert_true(moved[k][1] < -1e-4);
        drop(&p);
      }
    }
  row_error(section, "footing on one element, E 1e-6 to 1e14, with and without friction",
            "it moves as with E = 1", worst, 1e-9);
  gh_packing_destroy(&packing);
}

/* The triangular lattice, two grains in a cell of 1 x sqrt(3). */
static gh_packing *triangular(gh_context *ctx) {
  const double radius[2] = {0.51, 0.51}, x[4] = {0.1, 0.1, 0.6, 0.1 + sqrt(0.75)};
  const double cell[4] = {1, 0, 0, sqrt(3)};
  return make_packing(ctx, 2, cell, radius, x);
}

/* Elements a thousand times as wide as high, and as high as wide, under pressures: dead-load pressures p and
 * q give P11 = P11_0 - p and P22 = P22_0 - q everywhere. */
static void slender_elements(void **state) {
  static const double width[] = {1, 1000, 1e-3, 1};
  const double p = 3e-3, q = 2e-3;
  gh_context *ctx = *state;
  gh_packing *packing = triangular(ctx);
  double worst = 0;
  for (int friction = 0; friction < 2; friction++)
    for (int b = 1; b < 4; b += 2)
      for (int k = 0; k < 3; k++) {
        problem m;
        double start[4];
        gh_rve_options o = material(all_boundaries[b], 1, friction ? 20 : 0);
        rectangle(&m, ctx, width[k], width[k + 1], 2, 2);
        make(&m, packing, &o);
        OK(gh_macro_balance(m.macro));
        memcpy(start, gh_macro_P(m.macro), sizeof start);
        hold(&m, "bottom", 1, 0), hold(&m, "left", 0, 0);
        OK(gh_loads_pressure(m.loads, gh_mesh_find(m.mesh, "right"), p, false));
        OK(gh_loads_pressure(m.loads, gh_mesh_find(m.mesh, "top"), q, false));
        OK(gh_macro_solve(m.macro, m.loads, &m.report));
        const double wanted[4] = {start[0] - p, 0, 0, start[3] - q};
        for (int g = 0; g < 16; g++)
          WITHIN(&worst, "stress", relative(gh_macro_P(m.macro) + 4 * g, wanted, 4), 1e-7);
        drop(&m);
      }
  row_error(section, "elements with sides 1:1000 and 1000:1 under pressure, triangular lattice",
            "P = P_0 - p in each direction", worst, 1e-7);
  gh_packing_destroy(&packing);
}

/* A set of one node, so that each node of the boundary can be driven on its own. */
static void add_point_set(problem *p, int node) {
  gh_context *ctx = p->ctx;
  gh_mesh *m = p->mesh;
  size_t capacity = (size_t)m->nsets;
  OK(gh_grow(ctx, (size_t)m->nsets + 1, sizeof *m->sets, &capacity, &m->sets));
  gh_mesh_set *s = &m->sets[m->nsets++];
  *s = (gh_mesh_set){.nnodes = 1};
  OK(gh_alloc(ctx, 16, 1, &s->name));
  OK(gh_alloc(ctx, 1, sizeof(int), &s->nodes));
  snprintf(s->name, 16, "node%d", node);
  s->nodes[0] = node;
}

/* Patch test: elements of 1:1000, distorted inside, whose boundary follows one F: so does everything. */
static void distorted_and_slender(void **state) {
  enum { M = 3, NODES = (M + 1) * (M + 1) };
  static const double width[] = {1, 1000, 1e-3, 1}, F[4] = {0.985, 0.01, 0.002, 0.98};
  gh_context *ctx = *state;
  gh_packing *packing = case_packing(ctx, "p50d");
  unsigned long long seed = 5;
  double worst = 0;
  print_message("seed %llu\n", seed);
  FOR_BOUNDARIES(b) for (int k = 0; k < 3; k++) {
    problem p;
    double wanted[4];
    gh_rve_options o = material(*b, 1, 0);
    gh_rve *rve = make_rve(ctx, packing, GH_ENGINE_NATIVE, *b, 1, 1e-10);
    OK(gh_rve_evaluate(rve, F, 0, wanted, NULL));
    gh_rve_destroy(&rve);
    rectangle(&p, ctx, width[k], width[k + 1], M, M);
    for (int n = 0; n < NODES; n++) add_point_set(&p, n);
    for (int n = 0; n < NODES; n++) {
      bool inner = n % (M + 1) % M && n / (M + 1) % M;
      for (int c = 0; c < 2 && inner; c++)
        p.mesh->X[2 * n + c] += 0.5 * (uniform(&seed) - 0.5) * width[k + c] / M;
    }
    make(&p, packing, &o);
    for (int n = 0; n < NODES; n++) {
      const double *X = &p.mesh->X[2 * n];
      char name[16];
      snprintf(name, sizeof name, "node%d", n);
      if (n % (M + 1) % M && n / (M + 1) % M) continue;
      for (int c = 0; c < 2; c++) hold(&p, name, c, F[2 * c] * X[0] + F[2 * c + 1] * X[1] - X[c]);
    }
    OK(gh_macro_solve(p.macro, p.loads, &p.report));
    for (int q = 0; q < 4 * M * M; q++) {
      WITHIN(&worst, "stress", relative(gh_macro_P(p.macro) + 4 * q, wanted, 4), 1e-7);
    }
    drop(&p);
  }
  row_error(section, "patch of 3 x 3 distorted elements, sides 1:1 and 1:1000",
            "P of one packing at the same F", worst, 1e-7);
  gh_packing_destroy(&packing);
}

/* A node is driven through the line between its neighbours. The four points still have det F > 0 then, but
 * the element lies on itself. */
static void corner_inside_out(void **state) {
  gh_context *ctx = *state;
  gh_packing *packing = triangular(ctx);
  problem p;
  gh_rve_options o = material(GH_TAYLOR_CELL, 1, 0);
  rectangle(&p, ctx, 1, 1, 1, 1);
  add_point_set(&p, 3);
  make(&p, packing, &o);
  OK(gh_macro_balance(p.macro));
  hold(&p, "bottom", 0, 0), hold(&p, "bottom", 1, 0), hold(&p, "left", 0, 0), hold(&p, "left", 1, 0);
  hold(&p, "node3", 0, -0.55), hold(&p, "node3", 1, -0.55);
  FAILS(gh_macro_solve(p.macro, p.loads, &p.report), GH_DIVERGED,
        "a corner of element 0 is turned inside out");
  const double *u = gh_macro_u(p.macro);
  assert_true(u[6] > -0.5 && u[6] < -0.4 && u[7] == u[6]);
  row(section, "a corner of an element driven inside out", "message, exit status 1",
      "refused: a corner of element 0 is turned inside out");
  drop(&p);
  gh_packing_destroy(&packing);
}

/* A load on and off again. Without friction the body returns; with friction it creeps, less and less. */
static void load_reversals(void **state) {
  const int cycles = full_size() ? 200 : 6;
  gh_context *ctx = *state;
  gh_packing *packing = case_packing(ctx, "p50d");
  double back = 0, creep = 0;
  for (int friction = 0; friction < 2; friction++) FOR_BOUNDARIES(b) {
      problem p;
      gh_rve_options o = material(*b, 1, friction ? 20 : 0);
      double u[2], turn, rest = 0, change = 0;
      rectangle(&p, ctx, 2, 1, 2, 1);
      make(&p, packing, &o);
      OK(gh_macro_balance(p.macro));
      for (int n = 0; n < 2 * cycles; n++) {
        gh_loads_clear(p.loads);
        hold(&p, "bottom", 0, 0), hold(&p, "bottom", 1, 0);
        put(&p, 0.1, 0, n % 2 ? -2e-3 : -4e-3);
        OK(gh_macro_solve(p.macro, p.loads, &p.report));
        gh_macro_footing(p.macro, gh_mesh_find(p.mesh, "top"), u, &turn);
        assert_true(isfinite(u[0]) && isfinite(u[1]) && isfinite(turn));
        if (n % 2 == 0) continue;
        change = fabs(u[1] - rest) / fabs(u[1]);
        rest = u[1];
      }
      WITHIN(friction ? &creep : &back, "settlement", change, friction ? 1e-3 : 1e-8);
      drop(&p);
    }
  row_error(section,
            full_size() ? "400 load reversals of a footing, frictionless"
                        : "12 load reversals of a footing, frictionless",
            "the settlement returns", back, 1e-8);
  row(section, "the same, friction of 20 degrees", "the settlement returns",
      "converged; the last cycle settles by %.0e of the settlement", creep);
  gh_packing_destroy(&packing);
}

/* Loads the crest until no equilibrium is left. What is kept is the last state that was reached. */
static void slope(gh_context *ctx, const gh_packing *packing, gh_boundary b, bool friction,
                  double increment) {
  problem p;
  gh_rve_options o = material(b, 1, friction ? 20 : 0);
  char name[160], reason[160] = "";
  rectangle(&p, ctx, 4, 3, 4, 3);
  for (int n = 0; n < p.mesh->nnodes; n++) { /* the right half of the surface falls 1:2 */
    double *X = &p.mesh->X[2 * n];
    X[1] *= (3 - fmax(0, X[0] - 2) / 2) / 3;
  }
  gh_mesh_set *top = &p.mesh->sets[gh_mesh_find(p.mesh, "top")];
  for (int e = 0; e < top->nedges; e++) /* of the surface only the last part of the crest */
    if (p.mesh->X[2 * top->edges[e][0]] == 2) memcpy(top->edges[0], top->edges[e], sizeof top->edges[0]);
  top->nodes[0] = top->nodes[1], top->nodes[1] = top->nodes[2], top->nnodes = 2, top->nedges = 1;
  make(&p, packing, &o);
  OK(gh_macro_balance(p.macro));
  gh_status status = GH_OK;
  const double gravity[2] = {0, -1e-3};
  int n = -1;
  while (status == GH_OK) {
    assert_true(++n * increment < 1); /* twenty times what the sand is under */
    gh_loads_clear(p.loads);
    hold(&p, "bottom", 0, 0), hold(&p, "bottom", 1, 0), hold(&p, "left", 0, 0), hold(&p, "right", 0, 0);
    OK(gh_loads_gravity(p.loads, gravity));
    put(&p, 0.2, 0, -increment * n);
    status = gh_macro_solve(p.macro, p.loads, &p.report);
  }
  FAILS(status, GH_DIVERGED, "no equilibrium after");
  int bisections = 0;
  sscanf(gh_message(ctx), "no equilibrium after %d", &bisections);
  assert_true(bisections >= 6); /* the depth; more where first halves have come through */
  assert_true(n > 0 && norm(gh_macro_u(p.macro), 2 * p.mesh->nnodes) < 3);
  assert_true(gh_finite(gh_macro_P(p.macro), 192) && gh_finite(gh_macro_reactions(p.macro), 40));
  sscanf(gh_message(ctx), "%*[^:]: %159[^;:]", reason);
  snprintf(name, sizeof name, "slope loaded to its limit, %s, %s", gh_boundary_name(b),
           friction ? "20 degrees" : "frictionless");
  row(section, name, "stops with a reason",
      "converged up to %.3g E, at %.3g E refused: no equilibrium after %d bisections: %s",
      (n - 1) * increment, n * increment, bisections, reason);
  drop(&p);
}

static void slope_to_its_limit(void **state) {
  gh_context *ctx = *state;
  gh_packing *packing = case_packing(ctx, "p20");
  slope(ctx, packing, GH_TAYLOR, false, full_size() ? 0.005 : 0.03);
  slope(ctx, packing, GH_PERIODIC, true, 0.005);
  if (full_size()) {
    slope(ctx, packing, GH_TAYLOR, true, 0.005);
    slope(ctx, packing, GH_PERIODIC, false, 0.005);
  }
  gh_packing_destroy(&packing);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(footing_on_one_element), TEST(slender_elements),
                                     TEST(distorted_and_slender),  TEST(corner_inside_out),
                                     TEST(load_reversals),         TEST(slope_to_its_limit)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
