/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Conditions on a frame of boundary grains (docs/explanation/frames.md): tangents, their order, servo-control. */
#include "../frames_help.h"

/* ---- tangents ---- */

/* Against central differences from the same converged state, at an increment in which no contact changes. */
static void check_tangent(gh_context *ctx, const gh_packing *p, const condition *c, law l) {
  const double h = 1e-7; /* with friction contacts change soon */
  gh_rve_options o = options(ctx, c, GH_ENGINE_NATIVE, l);
  o.integration = GH_INTEGRATION_WHOLE;
  o.tolerance = 1e-12;
  gh_rve *r = open_rve(ctx, p, &o);
  double F[4], P[4], A[16], D[16], plus[4], minus[4];
  compress(ctx, r, 0.01, 10);
  deformation(0.01002, F);
  OK(gh_rve_evaluate(r, F, GH_WANT_TANGENT, P, A));
  for (int k = 0; k < 4; k++) {
    double G[4];
    memcpy(G, F, sizeof G);
    G[k] = F[k] + h;
    OK(gh_rve_evaluate(r, G, 0, plus, NULL));
    G[k] = F[k] - h;
    OK(gh_rve_evaluate(r, G, 0, minus, NULL));
    for (int i = 0; i < 4; i++) D[4 * i + k] = (plus[i] - minus[i]) / (2 * h);
  }
  print_message("%s %s, law %d: A1111 %.6g, tangent - differences %.2g\n", c->name, c->mixed ? c->mixed : "",
                l, A[0], distance(A, D, 16) / norm(A, 16));
  NEAR("tangent", distance(A, D, 16) / norm(A, 16), 0, 2e-6);
  if (l == SMOOTH)
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 4; k++) NEAR("major symmetry", A[4 * i + k], A[4 * k + i], 1e-9 * norm(A, 16));
  gh_rve_destroy(&r);
}

static void tangents(void **state) {
  gh_context *ctx = *state;
  for (int c = 0; c < NCONDITIONS; c++)
    for (law l = SMOOTH; l < LAWS; l++) {
      gh_packing *p = sample(ctx, &CONDITIONS[c], l);
      check_tangent(ctx, p, &CONDITIONS[c], l);
      gh_packing_destroy(&p);
    }
}

/* Least eigenvalue of the symmetric part of a 4 x 4 matrix, by Jacobi's rotations. */
static double least_eigenvalue(const double *M) {
  double a[4][4], least = INFINITY;
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 4; k++) a[i][k] = 0.5 * (M[4 * i + k] + M[4 * k + i]);
  for (int sweep = 0; sweep < 40; sweep++)
    for (int p = 0; p < 4; p++)
      for (int q = p + 1; q < 4; q++) {
        const double t = 0.5 * atan2(2 * a[p][q], a[q][q] - a[p][p]), c = cos(t), s = sin(t);
        for (int k = 0; k < 4; k++) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
        }
        for (int k = 0; k < 4; k++) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
        }
      }
  for (int i = 0; i < 4; i++) least = fmin(least, a[i][i]);
  return least;
}

/* Contact forces have a negative stiffness across them: without it the energy is convex, whatever is free. */
static void make_elastic(gh_rve *r) {
  for (int c = 0; c < r->list.count; c++) {
    gh_contact *q = (gh_contact *)(uintptr_t)&r->list.contacts[c];
    const double d = hypot(q->l[0], q->l[1]), n[2] = {q->l[0] / d, q->l[1] / d},
                 share = gh_frame_share_of(r->frame, q), v[3] = {n[1], -n[0], d / (d + q->overlap)};
    q->h[0] = share * E * n[0] * n[0], q->h[1] = share * E * n[0] * n[1], q->h[2] = share * E * n[1] * n[1];
    for (int k = 0; k < 9 && r->list.friction; k++)
      ((gh_friction *)(uintptr_t)&r->list.friction[c])->d[k] =
          share * ((k / 3 < 2 && k % 3 < 2 ? E * n[k / 3] * n[k % 3] : 0) + 0.5 * E * v[k / 3] * v[k % 3]);
  }
}

/* The tangent at the positions of a periodic equilibrium, where copies are where the cell has them. */
static void tangent_at(gh_context *ctx, const gh_packing *p, const condition *c, law l, const double F[4],
                       const double *y, double A[16]) {
  gh_rve_options o = options(ctx, c, GH_ENGINE_NATIVE, l);
  o.law.friction_coefficient = l == SMOOTH ? 0 : 1e6;
  gh_rve *r = open_rve(ctx, p, &o);
  double cell[4];
  memcpy(r->F, F, sizeof r->F);
  for (int i = 0; i < r->n; i++) {
    const int g = r->frame->grain[i], *k = r->frame->image[i];
    for (int h = 0; h < 2; h++)
      r->y[2 * i + h] = y[2 * g + h] + p->cell[2 * h] * k[0] + p->cell[2 * h + 1] * k[1];
    gh_apply2(F, &r->y[2 * i], &r->x[2 * i]);
  }
  memcpy(r->Fn, F, sizeof r->Fn);
  memcpy(r->yn, r->y, 2 * (size_t)r->n * sizeof(double));
  gh_mul2(F, r->lattice, cell);
  OK(gh_rve_begin_increment(r));
  OK(gh_engine_set(r->engine, cell, r->x, r->theta));
  OK(gh_rve_update_contacts(r));
  make_elastic(r);
  OK(gh_rve_find_rattlers(r));
  OK(gh_rve_sums(r));
  OK(l == SMOOTH ? gh_rve_tangent(r, A) : gh_rve_tangent_friction(r, A));
  gh_rve_destroy(&r);
}

/* One energy, at one state, and larger and larger sets of displacements: D >= P >= T. */
static void ordering(void **state) {
  gh_context *ctx = *state;
  static const char *const names[] = {"p50", "p50d", "p150", "p150d", "block150"};
  for (int k = 0; k < 5; k++) {
    gh_packing *p = case_packing(ctx, names[k]);
    for (law l = SMOOTH; l < LAWS; l++) {
      gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, E, 1e-11);
      gh_rve *r = open_rve(ctx, p, &o);
      double F[4], A[NCONDITIONS][16], D[16];
      static const int pairs[][2] = {{DISPLACEMENT, PERIODIC},
                                     {PERIODIC, TRACTION},
                                     {DISPLACEMENT, 3},
                                     {3, TRACTION},
                                     {PERIODIC, 4},
                                     {4, TRACTION},
                                     {DISPLACEMENT, 5},
                                     {5, PERIODIC}};
      compress(ctx, r, 0.02, 10);
      deformation(0.02, F);
      for (int c = 0; c < NCONDITIONS; c++) tangent_at(ctx, p, &CONDITIONS[c], l, F, r->yn, A[c]);
      print_message("%s, law %d: A1111 D %.5g P %.5g T %.5g\n", names[k], l, A[0][0], A[1][0], A[2][0]);
      for (size_t q = 0; q < sizeof pairs / sizeof *pairs; q++) {
        for (int n = 0; n < 16; n++) D[n] = A[pairs[q][0]][n] - A[pairs[q][1]][n];
        if (least_eigenvalue(D) < -1e-6 * norm(A[0], 16))
          print_error("%s, law %d: %s %s below %s %s by %.3g\n", names[k], l, CONDITIONS[pairs[q][0]].name,
                      CONDITIONS[pairs[q][0]].mixed ? CONDITIONS[pairs[q][0]].mixed : "",
                      CONDITIONS[pairs[q][1]].name,
                      CONDITIONS[pairs[q][1]].mixed ? CONDITIONS[pairs[q][1]].mixed : "",
                      least_eigenvalue(D));
        assert_true(least_eigenvalue(D) >= -1e-6 * norm(A[0], 16));
      }
      gh_rve_destroy(&r);
    }
    gh_packing_destroy(&p);
  }
}

/* ---- servo-control ---- */

/* The stress of a condition from a state that another one has come to, by slip of the whole increment. */
static void stress_of(gh_context *ctx, const gh_packing *p, const char *start, const char *name, law l,
                      gh_engine_kind engine, double tolerance, int depth, double P[4], double A[16],
                      int *sweeps) {
  const condition at_n = {start, NULL}, c = {name, NULL};
  gh_rve_options o = options(ctx, &at_n, GH_ENGINE_NATIVE, l);
  double F[4], *state;
  gh_rve *r = open_rve(ctx, p, &o);
  compress(ctx, r, 0.01, 5);
  const size_t size = gh_rve_state_size(r);
  OK(gh_alloc(ctx, size, sizeof *state, &state));
  OK(gh_rve_save(r, state));
  gh_rve_destroy(&r);
  o = options(ctx, &c, engine, l);
  o.integration = GH_INTEGRATION_WHOLE;
  o.servo_tolerance = tolerance, o.servo_acceleration = depth;
  r = open_rve(ctx, p, &o);
  OK(gh_rve_load(r, state, size));
  deformation(0.0102, F);
  OK(gh_rve_evaluate(r, F, GH_WANT_TANGENT, P, A));
  *sweeps = gh_rve_measure(r)->sweeps;
  gh_rve_destroy(&r);
  free(state);
}

/* Servo-control comes to the solution of the constraint, as near as its tolerance, with its tangent; Anderson's
 * acceleration needs fewer sweeps; both engines agree. */
static void servo(void **state) {
  gh_context *ctx = *state;
  static const char *const names[] = {"displacement", "frame-periodic", "traction"}, *const by_servo[] = {
                                                                                         "servo-displacement",
                                                                                         "servo-periodic",
                                                                                         "servo-traction"};
  gh_packing *p = case_packing(ctx, "p50d");
  for (int c = 0; c < 3; c++) {
    const law l = c == 1 ? SMOOTH : ROUGH;
    double P[4], A[16], Q[4], B[16], last = INFINITY;
    int sweeps, plain, fast;
    stress_of(ctx, p, names[c], names[c], l, GH_ENGINE_NATIVE, 1e-4, 0, P, A, &sweeps);
    NEAR("sweeps", sweeps, 0, 0);
    for (double tolerance = 1e-2; tolerance > 1e-9; tolerance *= 1e-2) {
      stress_of(ctx, p, names[c], by_servo[c], l, GH_ENGINE_NATIVE, tolerance, 5, Q, B, &fast);
      const double off = distance(P, Q, 4) / norm(P, 4);
      print_message("%s: tolerance %.0e, %d sweeps, stress off by %.2g, tangent by %.2g\n", by_servo[c],
                    tolerance, fast, off, distance(A, B, 16) / norm(A, 16));
      assert_true(off <= 10 * tolerance && off <= fmax(last, 1e-8));
      last = off;
    }
    NEAR("tangent", distance(A, B, 16) / norm(A, 16), 0, 1e-5);
    stress_of(ctx, p, names[c], by_servo[c], l, GH_ENGINE_NATIVE, 1e-4, 0, Q, B, &plain);
    stress_of(ctx, p, names[c], by_servo[c], l, GH_ENGINE_NATIVE, 1e-4, 5, Q, B, &fast);
    print_message("%s: %d sweeps, accelerated %d\n", by_servo[c], plain, fast);
    assert_true(c == 0 ? plain == 1 && fast == 1 : fast > 1 && 2 * fast < plain);
    if (!use_engine(GH_ENGINE_LAMMPS)) continue;
    stress_of(ctx, p, names[c], by_servo[c], l, GH_ENGINE_LAMMPS, 1e-8, 5, Q, B, &fast);
    NEAR("engines", distance(P, Q, 4) / norm(P, 4), 0, 1e-6);
  }
  gh_packing_destroy(&p);
}

static void servo_gain(void **state) {
  gh_context *ctx = *state;
  const condition c = {"servo-periodic", NULL};
  gh_packing *p = case_packing(ctx, "p50d");
  gh_rve_options o = options(ctx, &c, GH_ENGINE_NATIVE, ROUGH);
  const double F[4] = {0.99, 0, 0, 0.99};
  double P[4];
  gh_rve *r;
  o.servo_gain = 1;
  FAILS(gh_rve_create(ctx, p, &o, &r), GH_INPUT, "gain of 1 cannot converge");
  o.servo_gain = 0.9;
  r = open_rve(ctx, p, &o);
  FAILS(gh_rve_evaluate(r, F, 0, P, NULL), GH_DIVERGED, "smaller gain");
  gh_rve_destroy(&r);
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(tangents), TEST(ordering), TEST(servo), TEST(servo_gain)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
