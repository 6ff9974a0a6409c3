/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Conditions on a frame of boundary grains (docs/explanation/frames.md): closed forms, identities, states, wrong input. */
#include "../frames_help.h"

/* ---- closed forms ---- */

/* Four grains of a square lattice: every condition gives P = -E (2 r - |l|) / |l_0| ... along each side, and
 * A_1111 = E, from contacts along the sides alone. */
static void square(void **state) {
  gh_context *ctx = *state;
  const double radius[4] = {1, 1, 1, 1}, cell[4] = {4, 0, 0, 4}, x[8] = {0, 0, 2, 0, 0, 2, 2, 2},
               F[4] = {0.98, 0, 0, 0.99};
  gh_packing *p = make_packing(ctx, 4, cell, radius, x);
  for (int m = 0; m < 2; m++)
    for (int c = 0; c < NCONDITIONS; c++) {
      if (!use_engine(KINDS[m])) continue;
      const gh_rve_options o = options(ctx, &CONDITIONS[c], KINDS[m], ROUGH); /* smooth, it is unstable */
      gh_rve *r = open_rve(ctx, p, &o);
      double P[4], A[16];
      OK(gh_rve_evaluate(r, F, GH_WANT_TANGENT, P, A));
      NEAR("P11", P[0], -E * 0.02, 1e-9 * E); /* overlap 0.04 on a length of 2 */
      NEAR("P22", P[3], -E * 0.01, 1e-9 * E);
      NEAR("P12", P[1], 0, 1e-9 * E);
      NEAR("A1111", A[0], E, 1e-6 * E);
      NEAR("A2222", A[15], E, 1e-6 * E);
      NEAR("A1122", A[3], 0, 1e-6 * E);
      gh_rve_destroy(&r);
    }
  gh_packing_destroy(&p);
}

/* The triangular lattice, undisturbed: one answer under all conditions. */
static void triangles(void **state) {
  gh_context *ctx = *state;
  const double F[4] = {0.995, 0, 0, 0.995};
  double reference[4], stiffness[16];
  gh_packing *p = triangular(ctx, 0);
  const gh_rve_options periodic = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, E, 1e-11);
  gh_rve *r = open_rve(ctx, p, &periodic);
  OK(gh_rve_evaluate(r, F, GH_WANT_TANGENT, reference, stiffness));
  gh_rve_destroy(&r);
  for (int c = 0; c < NCONDITIONS; c++) {
    const gh_rve_options o = options(ctx, &CONDITIONS[c], GH_ENGINE_NATIVE, SMOOTH);
    double P[4], A[16];
    r = open_rve(ctx, p, &o);
    OK(gh_rve_evaluate(r, F, GH_WANT_TANGENT, P, A));
    print_message("%s %s: P11 %.6g of %.6g, A1111 %.6g of %.6g\n", CONDITIONS[c].name,
                  CONDITIONS[c].mixed ? CONDITIONS[c].mixed : "", P[0], reference[0], A[0], stiffness[0]);
    NEAR("P", distance(P, reference, 4), 0, 1e-9 * E);
    NEAR("A", distance(A, stiffness, 16), 0, 1e-6 * E);
    gh_rve_destroy(&r);
  }
  gh_packing_destroy(&p);
}

/* ---- identities ---- */

/* Areas of the frame add up to none, and sum X (x) area = V 1, with and without a grain at the corner; opposite copies
 * have opposite ones. */
static void areas(void **state) {
  gh_context *ctx = *state;
  static const char *const names[] = {"p50", "p150", "p150d", "block150"};
  const gh_condition traction = {.edges = {GH_EDGES_TRACTION, GH_EDGES_TRACTION}};
  for (int k = 0; k < 8; k++) {
    gh_packing *p = case_packing(ctx, names[k / 2]);
    gh_rve_frame *f;
    if (k % 2) p->low[0] += 0.4 * p->radius[0], p->low[1] -= 0.3 * p->radius[0];
    for (int i = 0; i < p->n && k % 2; i++) { /* another origin: grains are put back into the cell */
      double inverse[4], s[2] = {p->x[2 * i] - p->low[0], p->x[2 * i + 1] - p->low[1]};
      gh_inv2(p->cell, inverse);
      gh_apply2(inverse, s, s);
      s[0] = floor(s[0]), s[1] = floor(s[1]);
      gh_apply2(p->cell, s, s);
      p->x[2 * i] -= s[0], p->x[2 * i + 1] -= s[1];
    }
    OK(gh_frame_create(ctx, p, &traction, &f));
    double sum[2] = {0}, moment[4] = {0}, V = gh_det2(p->cell);
    for (int m = 0; m < f->n; m++) {
      for (int h = 0; h < 2; h++) sum[h] += f->area[2 * m + h];
      for (int h = 0; h < 4; h++) moment[h] += f->x[2 * m + h / 2] * f->area[2 * m + h % 2];
    }
    for (int i = 0; i < p->n; i++) {
      double all[2] = {0};
      for (int m = 0; m < f->n; m++)
        if (f->grain[m] == i) all[0] += f->area[2 * m], all[1] += f->area[2 * m + 1];
      NEAR("copies", norm(all, 2), 0, 1e-13 * sqrt(V));
    }
    NEAR("sum of areas", norm(sum, 2), 0, 1e-13 * sqrt(V));
    for (int h = 0; h < 4; h++) NEAR("sum X (x) area", moment[h] / V, h == 0 || h == 3, 1e-13);
    gh_frame_destroy(&f);
    gh_packing_destroy(&p);
  }
}

/* On one packing: support form and contact form of the stress, Hill-Mandel with couples, symmetry, traction as it is
 * prescribed, F in the mean, the other engine. */
static void check_identities(gh_context *ctx, const gh_packing *p, const condition *c, law l,
                             double *stress) {
  for (int m = 0; m < 2; m++) {
    if (!use_engine(KINDS[m])) continue;
    const gh_rve_options o = options(ctx, c, KINDS[m], l);
    gh_rve *r = open_rve(ctx, p, &o);
    double F[4], P[4], B[4], slope[4], curvature[16], sum[4] = {0};
    compress(ctx, r, 0.01, 5);
    deformation(0.0102, F);
    OK(gh_rve_evaluate(r, F, 0, P, NULL));
    OK(gh_rve_boundary_stress(r, B));
    const gh_rve_measures *q = gh_rve_measure(r);
    const double scale = norm(P, 4), asymmetry = q->cauchy[1] - q->cauchy[2];
    assert_true(scale > 1e-4 * E && q->residual <= 1e-8);
    gh_rotation_slope(F, slope, curvature);
    for (int k = 0; k < 4; k++) NEAR("Hill-Mandel", P[k], B[k] + q->couple * slope[k], 1e-8 * scale);
    if (l != RIGID) NEAR("Cauchy stress", asymmetry, 0, 1e-8 * scale);
    if (l == ROUGH && c == &CONDITIONS[DISPLACEMENT]) assert_true(fabs(q->couple) > 1e-7 * scale);
    for (int i = 0; gh_frame_is_open(r->frame) && i < r->n; i++)
      for (int k = 0; k < 4; k++) sum[k] += r->x[2 * i + k / 2] * r->frame->area[2 * i + k % 2];
    for (int i = 0; c == &CONDITIONS[TRACTION] && i < r->n; i++) {
      double a[2];
      gh_apply2(P, &r->frame->area[2 * i], a);
      for (int k = 0; k < 2; k++)
        NEAR("traction", -r->list.force[2 * i + k], a[k], 1e-8 * fmax(q->mean_force, norm(a, 2)));
    }
    for (int k = 0; c == &CONDITIONS[TRACTION] && k < 4; k++)
      NEAR("F in the mean", sum[k] / r->volume, F[k], 1e-12);
    print_message("%s %s, law %d, %s: p %.5g couple %.3g residual %.2g\n", c->name, c->mixed ? c->mixed : "",
                  l, engine_names[KINDS[m]], -(P[0] + P[3]) / 2, q->couple, q->residual);
    if (m == 1 && use_engine(GH_ENGINE_NATIVE)) NEAR("engines", distance(P, stress, 4) / scale, 0, 1e-7);
    memcpy(stress, P, sizeof P);
    gh_rve_destroy(&r);
  }
}

static void identities(void **state) {
  gh_context *ctx = *state;
  double P[4];
  for (int c = 0; c < NCONDITIONS; c++)
    for (law l = SMOOTH; l < LAWS; l++) {
      gh_packing *p = sample(ctx, &CONDITIONS[c], l);
      check_identities(ctx, p, &CONDITIONS[c], l, P);
      gh_packing_destroy(&p);
    }
}

/* Copies that move alike are the periodic cell. */
static void as_periodic(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p150d");
  for (law l = SMOOTH; l < LAWS; l++) {
    double F[4], P[2][4], A[2][16];
    for (int k = 0; k < 2; k++) {
      gh_rve_options o = options(ctx, &CONDITIONS[PERIODIC], GH_ENGINE_NATIVE, l);
      if (k) o.boundary = GH_PERIODIC;
      gh_rve *r = open_rve(ctx, p, &o);
      compress(ctx, r, 0.004, 4);
      deformation(0.0042, F);
      OK(gh_rve_evaluate(r, F, GH_WANT_TANGENT, P[k], A[k]));
      if (!k) {
        const int corner = r->frame->corner;
        NEAR("corner", distance(&r->y[2 * corner], &r->X[2 * corner], 2), 0, 1e-12);
      }
      gh_rve_destroy(&r);
    }
    NEAR("P", distance(P[0], P[1], 4) / norm(P[1], 4), 0, 1e-9);
    NEAR("A", distance(A[0], A[1], 16) / norm(A[1], 16), 0, 1e-7);
  }
  gh_packing_destroy(&p);
}

static void objectivity(void **state) {
  gh_context *ctx = *state;
  double Q[4];
  rotation(help_pi / 6, Q);
  for (int c = 0; c < NCONDITIONS; c++)
    for (law l = SMOOTH; l < RIGID; l++) {
      gh_packing *p = sample(ctx, &CONDITIONS[c], l);
      const gh_rve_options o = options(ctx, &CONDITIONS[c], GH_ENGINE_NATIVE, l);
      double F[4], QF[4], P[2][4], turned[4];
      for (int k = 0; k < 2; k++) {
        gh_rve *r = open_rve(ctx, p, &o);
        for (int n = 1; n <= 6; n++) {
          double R[4];
          deformation(0.002 * n, F);
          rotation(k * help_pi / 36 * n, R);
          gh_mul2(R, F, QF);
          OK(gh_rve_evaluate(r, QF, 0, P[k], NULL));
          OK(gh_rve_commit(r));
        }
        gh_rve_destroy(&r);
      }
      gh_mul2(Q, P[0], turned);
      print_message("%s %s, law %d: P(QF) - Q P(F) %.2g\n", CONDITIONS[c].name,
                    CONDITIONS[c].mixed ? CONDITIONS[c].mixed : "", l,
                    distance(turned, P[1], 4) / norm(turned, 4));
      NEAR(CONDITIONS[c].name, distance(turned, P[1], 4) / norm(turned, 4), 0, l == SMOOTH ? 1e-7 : 1e-2);
      gh_packing_destroy(&p);
    }
}

/* ---- states and wrong input ---- */

/* A state saved, and loaded into another RVE, continues to the last bit. */
static void saved(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  for (int c = 0; c < NCONDITIONS; c++)
    for (int m = 0; m < 2; m++) {
      if (!use_engine(KINDS[m])) continue;
      const gh_rve_options o = options(ctx, &CONDITIONS[c], KINDS[m], ROUGH);
      gh_rve *r = open_rve(ctx, p, &o), *other = open_rve(ctx, p, &o);
      double F[4], P[2][4], *numbers;
      compress(ctx, r, 0.004, 2);
      const size_t size = gh_rve_state_size(r);
      OK(gh_alloc(ctx, size, sizeof *numbers, &numbers));
      OK(gh_rve_save(r, numbers));
      OK(gh_rve_load(other, numbers, size));
      deformation(0.0045, F);
      OK(gh_rve_evaluate(r, F, 0, P[0], NULL));
      OK(gh_rve_evaluate(other, F, 0, P[1], NULL));
      assert_memory_equal(P[0], P[1], sizeof P[0]);
      free(numbers);
      gh_rve_destroy(&r);
      gh_rve_destroy(&other);
    }
  gh_packing_destroy(&p);
}

static void refused(void **state) {
  gh_context *ctx = *state;
  gh_edges mixed[2];
  gh_packing *p = case_packing(ctx, "p20");
  gh_rve_options o = options(ctx, &CONDITIONS[TRACTION], GH_ENGINE_NATIVE, SMOOTH);
  gh_rve *r;
  FAILS(gh_rve_create(ctx, p, &o, &r), GH_INPUT, "gap");
  gh_packing_destroy(&p);
  p = make_packing(ctx, 1, (double[]){2, 0, 0, 2}, (double[]){1}, (double[]){1, 1});
  FAILS(gh_rve_create(ctx, p, &o, &r), GH_INPUT, "both edges");
  gh_packing_destroy(&p);
  p = make_packing(ctx, 1, (double[]){9, 0, 0, 9}, (double[]){1}, (double[]){4, 4});
  FAILS(gh_rve_create(ctx, p, &o, &r), GH_INPUT, "hole");
  gh_packing_destroy(&p);
  FAILS(gh_mixed_read(ctx, "x=traction", mixed), GH_INPUT, "pair of edges y has no condition");
  FAILS(gh_mixed_read(ctx, "x=traction,y=periodical", mixed), GH_INPUT, "must be like");
  FAILS(gh_mixed_read(ctx, "x=traction,x=periodic", mixed), GH_INPUT, "must be like");
  FAILS(gh_mixed_read(ctx, "x=traction,y=periodic,", mixed), GH_INPUT, "must be like");
  OK(gh_mixed_read(ctx, "y=traction,x=displacement", mixed));
  assert_true(mixed[0] == GH_EDGES_DISPLACEMENT && mixed[1] == GH_EDGES_TRACTION);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(square),      TEST(triangles),   TEST(areas), TEST(identities),
                                     TEST(as_periodic), TEST(objectivity), TEST(saved), TEST(refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
