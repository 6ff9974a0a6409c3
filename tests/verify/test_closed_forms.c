/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Lattices whose stress and tangent are known in closed form.
 *
 * The square lattice of (6.10): # P = m x m grains with the polygon through the outer centres as reference
 * area, V = (2 r (m - 1))^2 (6.9). With the counting of method 8.1 that is a cell of the side 2 r (m - 1)
 * whose primary grains are the (m - 1)^2 lattice points from the cell's corner on: those on the low faces get
 * replicas on the high ones, which makes m x m grains, and contacts along the boundary count on both sides.
 *
 * (6.21), nine disks of the area 16 r^2 cos(alpha), is not checked: it is the area of a parallelogram that
 * nothing in the program computes. */
#include "../help.h"

static const double E = 50;

/* Fails unless A is `wanted` within `limit` of its largest component. */
static void assert_tangent(const char *what, const double A[16], const double wanted[16], double limit) {
  double worst = distance(A, wanted, 16) / norm(wanted, 16);
  print_message("  %s: tangent within %.1e\n", what, worst);
  assert_true(worst <= limit);
}

static void evaluate(gh_context *ctx, const gh_packing *p, gh_engine_kind engine, gh_boundary boundary,
                     const double F[4], double P[4], double A[16]) {
  gh_rve *rve = make_rve(ctx, p, engine, boundary, E, 1e-12);
  OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
  gh_rve_destroy(&rve);
}

/* Square lattice of n = m^2 disks just in contact, Taylor: A_1111 = A_2222 = E [1 + (m - 1)/(n - 2 m + 1)],
 * zero elsewhere. */
static void square_lattice(void **state) {
  gh_context *ctx = *state;
  for (int m = 2; m <= 5; m++) {
    int n = (m - 1) * (m - 1);
    double r = 0.5, cell[4] = {2 * r * (m - 1), 0, 0, 2 * r * (m - 1)}, radius[16], x[32];
    for (int i = 0; i < n; i++)
      radius[i] = r, x[2 * i] = 2 * r * (i % (m - 1)), x[2 * i + 1] = 2 * r * (i / (m - 1));
    gh_packing *p = make_packing(ctx, n, cell, radius, x);
    gh_cluster *c;
    OK(gh_cluster_create(ctx, p, &c));
    assert_int_equal(c->n, m * m);
    gh_cluster_destroy(&c);
    double wanted[16] = {0}, P[4], A[16], I[4] = {1, 0, 0, 1};
    wanted[0] = wanted[15] = E * (1 + (m - 1.0) / (m * m - 2 * m + 1));
    for (int e = 0; e < 2; e++) {
      if (!use_engine((gh_engine_kind)e)) continue;
      char what[64];
      snprintf(what, sizeof what, "%d disks, %s", m * m, engine_names[e]);
      evaluate(ctx, p, (gh_engine_kind)e, GH_TAYLOR, I, P, A);
      assert_true(norm(P, 4) == 0);
      assert_tangent(what, A, wanted, 1e-12);
    }
    gh_packing_destroy(&p);
  }
}

/* A k x k periodic cell of the triangular lattice of disks with r = 1/2 in contact, its cell tilted along the
 * lattice. */
static gh_packing *triangular(gh_context *ctx, int k) {
  double h = sqrt(3) / 2, cell[4] = {k, k / 2.0, 0, k * h}, radius[64], x[128];
  for (int i = 0; i < k * k; i++) {
    radius[i] = 0.5;
    x[2 * i] = i % k + i / k / 2.0, x[2 * i + 1] = i / k * h;
  }
  return make_packing(ctx, k * k, cell, radius, x);
}

/* Three contacts to each grain of the area sqrt(3)/2; f = E (1 - c), |l| = c under F = c 1 (4.8, 4.12). With
 * q = (1 - c)/c the sums over the directions give P = -sqrt(3) E (1 - c) 1 and A = sqrt(3) E [(1 + q)/4 (d_iJ
 * d_kL + d_ik d_JL + d_iL d_Jk) - q d_ik d_JL]: at c = 1 lambda = mu = sqrt(3)/4 E. */
static void exact(double c, double P[4], double A[16]) {
  double q = (1 - c) / c;
  memset(P, 0, 4 * sizeof *P);
  P[0] = P[3] = -sqrt(3) * E * (1 - c);
  for (int n = 0; n < 16; n++) {
    int i = n >> 3, J = n >> 2 & 1, k = n >> 1 & 1, L = n & 1;
    A[n] = sqrt(3) * E *
           ((1 + q) / 4 * ((i == J) * (k == L) + (i == k) * (J == L) + (i == L) * (J == k)) -
            q * (i == k) * (J == L));
  }
}

/* Periodic triangular lattice: stress and tangent under isotropic compression, down to just in contact. */
static void triangular_lattice(void **state) {
  gh_context *ctx = *state;
  static const double factors[] = {1 - 1e-7, 0.9999, 0.99, 0.95};
  static const gh_boundary boundaries[] = {GH_TAYLOR_CELL, GH_PERIODIC};
  for (int k = 1; k <= 6; k += k < 4 ? 1 : 2) {
    gh_packing *p = triangular(ctx, k);
    for (int e = 0; e < 2; e++)
      for (int b = 0; b < 2; b++)
        for (int f = 0; f < 4; f++) {
          if (!use_engine((gh_engine_kind)e)) continue;
          double c = factors[f], F[4] = {c, 0, 0, c}, P[4], A[16], P0[4], A0[16];
          exact(c, P0, A0);
          evaluate(ctx, p, (gh_engine_kind)e, boundaries[b], F, P, A);
          if (distance(P, P0, 4) > 1e-8 * norm(P0, 4) || distance(A, A0, 16) > 1e-8 * norm(A0, 16))
            print_error("%d grains, %s, %s, c = %g\n", k * k, engine_names[e],
                        gh_boundary_name(boundaries[b]), c);
          NEAR("P", distance(P, P0, 4) / norm(P0, 4), 0, 1e-8); /* overlaps of 1e-7 are round to 1e-9 */
          NEAR("A", distance(A, A0, 16) / norm(A0, 16), 0, 1e-8);
        }
    gh_packing_destroy(&p);
  }
}

/* The Lame constants of the triangular lattice just in contact are sqrt(3)/4 E, its plane modulus 3 sqrt(3)/4
 * E. */
static void triangular_lattice_just_in_contact(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = triangular(ctx, 4);
  double c = 1 - 1e-8, F[4] = {c, 0, 0, c}, P[4], A[16], wanted[16] = {0}, mu = sqrt(3) / 4 * E;
  wanted[0] = wanted[15] = 3 * mu;
  wanted[3] = wanted[12] = mu;                         /* A1122, A2211 */
  wanted[5] = wanted[6] = wanted[9] = wanted[10] = mu; /* A1212, A1221, A2112, A2121 */
  for (int e = 0; e < 2; e++) {
    if (!use_engine((gh_engine_kind)e)) continue;
    evaluate(ctx, p, (gh_engine_kind)e, GH_TAYLOR_CELL, F, P, A);
    assert_tangent("taylor-cell", A, wanted, 1e-7);
    evaluate(ctx, p, (gh_engine_kind)e, GH_PERIODIC, F, P, A);
    assert_tangent("periodic", A, wanted, 1e-7);
  }
  gh_packing_destroy(&p);
}

/* One grain in a periodic cell touches its own images: P_11 = -E (2 r - c_1 L)/L in a square cell, P_22
 * likewise. */
static void one_grain_and_its_images(void **state) {
  gh_context *ctx = *state;
  double cell[4] = {1, 0, 0, 1}, radius = 0.51, x[2] = {0.3, 0.2}, F[4] = {0.97, 0, 0, 0.99}, P[4], A[16];
  gh_packing *p = make_packing(ctx, 1, cell, &radius, x);
  for (int e = 0; e < 2; e++)
    for (int b = 1; b < 4; b += 2) {
      if (!use_engine((gh_engine_kind)e)) continue;
      evaluate(ctx, p, (gh_engine_kind)e, all_boundaries[b], F, P, A);
      NEAR("P11", P[0], -E * (1.02 - 0.97), 1e-12);
      NEAR("P22", P[3], -E * (1.02 - 0.99), 1e-12);
      NEAR("P12", P[1], 0, 1e-12);
      NEAR("P21", P[2], 0, 1e-12);
      NEAR("A1111", A[0], E, 1e-11);
      NEAR("A2222", A[15], E, 1e-11);
      NEAR("A1122", A[3], 0, 1e-11);
      NEAR("A1212", A[5], -E * (1.02 - 0.99) / 0.99, 1e-11); /* across a contact: -E e/|l| */
      NEAR("A2121", A[10], -E * (1.02 - 0.97) / 0.97, 1e-11);
    }
  gh_packing_destroy(&p);
}

/* Two grains in a row are two springs in series: the overlap 2 (r_1 + r_2) - c L is shared by halves, P_11 =
 * -E e / height. */
static void two_grains_in_series(void **state) {
  gh_context *ctx = *state;
  double cell[4] = {2, 0, 0, 3}, radius[2] = {0.6, 0.42}, x[4] = {0.5, 1, 1.55, 1}, F[4] = {0.98, 0, 0, 1},
         P[4];
  gh_packing *p = make_packing(ctx, 2, cell, radius, x);
  double e = (2 * 1.02 - 0.98 * 2) / 2;
  for (int k = 0; k < 2; k++) {
    if (!use_engine((gh_engine_kind)k)) continue;
    gh_rve *rve = make_rve(ctx, p, (gh_engine_kind)k, GH_PERIODIC, E, 1e-11);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    NEAR("P11", P[0], -E * e / 3, 1e-9);
    NEAR("P22", P[3], 0, 1e-9);
    NEAR("energy", gh_rve_measure(rve)->energy, 2 * E * e * e / 2 / 6, 1e-9);
    assert_int_equal(gh_rve_measure(rve)->contacts, 2);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* The smallest eigenvalue of the acoustic tensor: mu for an isotropic solid; found where it lies for one that
 * softens in one direction. */
static void acoustic_tensor(void **state) {
  (void)state;
  double A[16], angle, lambda = 3, mu = 2;
  for (int turn = 0; turn < 40; turn++) {
    double Q[4], a = help_pi * turn / 40, weak = 5;
    rotation(a, Q); /* direction M = (cos a, sin a) has its longitudinal stiffness lowered by `weak` */
    for (int n = 0; n < 16; n++) {
      int i = n >> 3, J = n >> 2 & 1, k = n >> 1 & 1, L = n & 1;
      double M[2] = {Q[0], Q[2]};
      A[n] = lambda * (i == J) * (k == L) + mu * ((i == k) * (J == L) + (i == L) * (J == k));
      if (turn) A[n] -= weak * M[i] * M[J] * M[k] * M[L];
    }
    double least = gh_acoustic(A, &angle);
    if (!turn) {
      NEAR("isotropic", least, mu, 1e-12);
      continue;
    }
    double scan = INFINITY; /* Q = mu 1 + (lambda + mu) N N - weak (M.N)^2 M M, eigenvalues by a fine scan */
    for (int s = 0; s < 20000; s++) {
      double d = help_pi * s / 20000, c = cos(d) * cos(d), m = cos(d), n = sin(d); /* N in the axes of M */
      double q11 = mu + (lambda + mu) * m * m - weak * c, q12 = (lambda + mu) * m * n,
             q22 = mu + (lambda + mu) * n * n;
      scan = fmin(scan, (q11 + q22) / 2 - sqrt((q11 - q22) * (q11 - q22) / 4 + q12 * q12));
    }
    NEAR("least", least, scan, 1e-6);
    assert_true(least <= scan + 1e-12);
    double c = cos(angle - a), s = sin(angle - a);
    double q11 = mu + (lambda + mu) * c * c - weak * c * c, q12 = (lambda + mu) * c * s,
           q22 = mu + (lambda + mu) * s * s;
    NEAR("at the angle", (q11 + q22) / 2 - sqrt((q11 - q22) * (q11 - q22) / 4 + q12 * q12), least, 1e-9);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(square_lattice),           TEST(triangular_lattice),   TEST(triangular_lattice_just_in_contact),
      TEST(one_grain_and_its_images), TEST(two_grains_in_series), TEST(acoustic_tensor)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
