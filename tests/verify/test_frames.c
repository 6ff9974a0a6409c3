/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Conditions on a frame of boundary grains (docs/explanation/frames.md): closed forms, identities, tangents. */
#include "../help.h"

#include "micro/internal.h"

/* The conditions on a frame, and mixed ones of all kinds. */
typedef struct condition {
  const char *name, *mixed;
} condition;
static const condition CONDITIONS[] = {{"displacement", NULL},
                                       {"frame-periodic", NULL},
                                       {"traction", NULL},
                                       {"mixed", "x=traction,y=displacement"},
                                       {"mixed", "x=periodic,y=traction"},
                                       {"mixed", "x=displacement,y=periodic"}};
enum { NCONDITIONS = sizeof CONDITIONS / sizeof *CONDITIONS, DISPLACEMENT = 0, PERIODIC, TRACTION };
static const gh_engine_kind KINDS[] = {GH_ENGINE_NATIVE, GH_ENGINE_LAMMPS};
static const double E = 1000;

typedef enum law { SMOOTH, ROUGH, RIGID, LAWS } law; /* RIGID: friction, rotations fixed */

static gh_rve_options options(gh_context *ctx, const condition *c, gh_engine_kind engine, law l) {
  gh_rve_options o = rve_options(engine, GH_PERIODIC, E, 1e-11);
  assert_true(gh_boundary_from_name(c->name, &o.boundary));
  if (c->mixed) OK(gh_mixed_read(ctx, c->mixed, o.mixed));
  if (l == SMOOTH) return o;
  o.law.friction = 1;
  o.law.tangential_stiffness = 0.5 * E;
  o.law.friction_coefficient = 0.4;
  o.law.fixed_rotations = l == RIGID;
  o.law.slip = GH_SLIP_OBJECTIVE;
  return o;
}

static gh_rve *open_rve(gh_context *ctx, const gh_packing *p, const gh_rve_options *o) {
  gh_rve *r;
  OK(gh_rve_create(ctx, p, o, &r));
  return r;
}

/* Compression with shear. */
static void deformation(double s, double F[4]) {
  F[0] = 1 - s, F[1] = 0.3 * s, F[2] = -0.1 * s, F[3] = 1 - 0.8 * s;
}

/* To some compression, in steps that are committed. */
static void compress(gh_context *ctx, gh_rve *r, double s, int steps) {
  double F[4], P[4];
  for (int k = 1; k <= steps; k++) {
    deformation(s * k / steps, F);
    OK(gh_rve_evaluate(r, F, 0, P, NULL));
    OK(gh_rve_commit(r));
  }
}

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

/* A triangular lattice of grains that just touch, with radii that are smaller by up to `noise`. */
static gh_packing *triangular(gh_context *ctx, double noise) {
  enum { SIDE = 4, N = 2 * SIDE * SIDE };
  const double h = sqrt(3), cell[4] = {2 * SIDE, 0, 0, 2 * h * SIDE};
  double radius[N], x[2 * N];
  unsigned long long seed = 7;
  for (int k = 0; k < N; k++) {
    radius[k] = 1 - noise * uniform(&seed);
    x[2 * k] = 2 * (k % SIDE) + (k / SIDE % 2) + 0.3;
    x[2 * k + 1] = h * (k / SIDE) + 0.2;
  }
  return make_packing(ctx, N, cell, radius, x);
}

/* Grains under uniform traction without friction are pushed between each other in most packings, which then have no
 * stress: a lattice has one. */
static gh_packing *sample(gh_context *ctx, const condition *c, law l) {
  const bool traction = !strcmp(c->name, "traction") || (c->mixed && strstr(c->mixed, "traction"));
  return l == SMOOTH && traction ? triangular(ctx, 0.005) : case_packing(ctx, "p50d");
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
  const struct CMUnitTest tests[] = {TEST(square),      TEST(triangles),   TEST(areas),    TEST(identities),
                                     TEST(as_periodic), TEST(objectivity), TEST(tangents), TEST(ordering),
                                     TEST(servo),       TEST(servo_gain),  TEST(saved),    TEST(refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
