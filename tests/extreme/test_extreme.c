/* RVEs at the edges of what can be asked of them: scales, increments, rotations, sizes, degenerate packings,
 * wild deformations. SPDX-License-Identifier: GPL-2.0-or-later */
#include "../help.h"

#define FOR_ENGINES(e)                                                                                       \
  for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)                                      \
    if (use_engine(e))
#define FOR_BOUNDARIES(b) for (const gh_boundary *b = all_boundaries; b < all_boundaries + 4; b++)

static const double I[4] = {1, 0, 0, 1}, squeeze[4] = {0.98, 0.005, 0.002, 0.985};

/* P (and A where wanted) at F after the steps F/n, 2F/n, ... from I. */
static void walk(gh_context *ctx, gh_rve *rve, const double from[4], const double to[4], int n, double P[4],
                 double *A) {
  double F[4];
  for (int k = 1; k <= n; k++) {
    for (int c = 0; c < 4; c++) F[c] = from[c] + (to[c] - from[c]) * k / n;
    OK(gh_rve_evaluate(rve, F, A && k == n ? GH_WANT_TANGENT : 0, P, A));
    OK(gh_rve_commit(rve));
  }
}

static gh_packing *scaled(gh_context *ctx, const char *name, double factor) {
  gh_packing *p = case_packing(ctx, name);
  for (int i = 0; i < p->n; i++) p->radius[i] *= factor;
  for (int i = 0; i < 2 * p->n; i++) p->x[i] *= factor;
  for (int k = 0; k < 4; k++) p->cell[k] *= factor;
  for (int k = 0; k < 2; k++) p->low[k] *= factor;
  return p;
}

/* Stress and tangent grow with the stiffness, from 1e-6 to 1e14, and with nothing else. */
static void stiffness_scales(void **state) {
  static const double stiffness[] = {1, 1e-6, 1e3, 1e14};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4][4], A[4][16];
    for (int k = 0; k < 4; k++) {
      gh_rve *rve = make_rve(ctx, p, e, *b, stiffness[k], 1e-11);
      walk(ctx, rve, I, squeeze, 3, P[k], A[k]);
      for (int c = 0; c < 4; c++) P[k][c] /= stiffness[k];
      for (int c = 0; c < 16; c++) A[k][c] /= stiffness[k];
      NEAR("stress", distance(P[k], P[0], 4), 0, 1e-9 * norm(P[0], 4));
      NEAR("tangent", distance(A[k], A[0], 16), 0, 1e-9 * norm(A[0], 16));
      gh_rve_destroy(&rve);
    }
    assert_true(norm(P[0], 4) > 1e-3);
  }
  gh_packing_destroy(&p);
}

/* In the plane stress and tangent do not know how large the grains are, from 1e-6 to 1e6. */
static void length_does_not_matter(void **state) {
  static const double length[] = {1, 1e-6, 1e-3, 1e6};
  gh_context *ctx = *state;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4][4], A[4][16];
    for (int k = 0; k < 4; k++) {
      gh_packing *p = scaled(ctx, "p50", length[k]);
      gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-11);
      walk(ctx, rve, I, squeeze, 3, P[k], A[k]);
      NEAR("stress", distance(P[k], P[0], 4), 0, 1e-9 * norm(P[0], 4));
      NEAR("tangent", distance(A[k], A[0], 16), 0, 1e-9 * norm(A[0], 16));
      gh_rve_destroy(&rve);
      gh_packing_destroy(&p);
    }
  }
}

/* A packing ten thousand cells away from the origin is the same packing, up to the round-off of its
 * positions. */
static void far_from_the_origin(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50"), *q;
  OK(gh_packing_copy(ctx, p, &q));
  for (int i = 0; i < 2 * p->n; i++) q->x[i] += 1e4;
  q->low[0] += 1e4, q->low[1] += 1e4;
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4], Q[4];
    gh_rve *near = make_rve(ctx, p, e, *b, 1, 1e-10), *far = make_rve(ctx, q, e, *b, 1, 1e-10);
    walk(ctx, near, I, squeeze, 2, P, NULL);
    walk(ctx, far, I, squeeze, 2, Q, NULL);
    NEAR("stress", distance(P, Q, 4), 0, 1e-7 * norm(P, 4));
    gh_rve_destroy(&near);
    gh_rve_destroy(&far);
  }
  gh_packing_destroy(&p);
  gh_packing_destroy(&q);
}

/* Increments from 1e-10 to a thousandth change the stress by A : dF, up to second order and round-off. */
static void tiny_increments(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P0[4], P[4], A[16], F[4];
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-12);
    walk(ctx, rve, I, squeeze, 4, P0, A);
    for (double d = 1e-10; d < 1e-6; d *= 10) {
      memcpy(F, squeeze, sizeof F);
      F[0] -= d;
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      for (int c = 0; c < 4; c++) NEAR("dP", P[c] - P0[c], -d * A[4 * c], (1e-3 * d + 4e-13) * norm(A, 16));
    }
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Compression by up to a fifth at once: both engines find the same equilibrium with pressure, and the next
 * 1e-4 are no harder. */
static void large_increments(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  for (int b = 2; b < 4; b++)
    for (double d = 0.01; d < 0.21; d += 0.0475) {
      double P[2][4], F[4] = {1 - d, d / 3, 0, 1}, last[4] = {1 - d - 1e-4, d / 3, 0, 1};
      FOR_ENGINES(e) {
        gh_rve *rve = make_rve(ctx, p, e, all_boundaries[b], 1, 1e-11);
        OK(gh_rve_evaluate(rve, F, 0, P[e], NULL));
        OK(gh_rve_commit(rve));
        OK(gh_rve_evaluate(rve, last, 0, P[e], NULL));
        const gh_rve_measures *m = gh_rve_measure(rve);
        assert_true(m->cauchy[0] < 0 && m->cauchy[3] < 0);
        NEAR("symmetry", m->cauchy[1], m->cauchy[2], 1e-9 * norm(m->cauchy, 4));
        gh_rve_destroy(&rve);
      }
      if (use_engine(0) && use_engine(1)) NEAR("engines", distance(P[0], P[1], 4), 0, 1e-8 * norm(P[0], 4));
    }
  gh_packing_destroy(&p);
}

/* Shear to 2 in steps of a hundredth, in which LAMMPS's cell changes its lattice vectors four times: both
 * engines give the same stress all the way. */
static void shear_to_two(void **state) {
  enum { STEPS = 200 };
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  if (!use_engine(0) || !use_engine(1)) skip();
  for (int b = 0; b < 4; b++) {
    gh_rve *rve[2] = {make_rve(ctx, p, 0, all_boundaries[b], 1, 1e-11),
                      make_rve(ctx, p, 1, all_boundaries[b], 1, 1e-11)};
    for (int k = 1; k <= STEPS; k++) {
      double F[4] = {0.97, 2.0 * k / STEPS, 0, 0.97}, P[2][4], A[2][16];
      for (int e = 0; e < 2; e++) {
        OK(gh_rve_evaluate(rve[e], F, GH_WANT_TANGENT, P[e], A[e]));
        OK(gh_rve_commit(rve[e]));
      }
      NEAR("stress", distance(P[0], P[1], 4), 0, 1e-8 * norm(P[1], 4));
      NEAR("tangent", distance(A[0], A[1], 16), 0, 1e-8 * norm(A[1], 16));
    }
    gh_rve_destroy(&rve[0]);
    gh_rve_destroy(&rve[1]);
  }
  gh_packing_destroy(&p);
}

/* Turned twice around its centre, in steps of 15 degrees, a packing turns its stress along: P(QF) = Q P(F).
 */
static void two_turns(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P0[4], P[4], Q[4], F[4], turned[4];
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-11);
    walk(ctx, rve, I, squeeze, 3, P0, NULL);
    for (int angle = 15; angle <= 720; angle += 15) {
      rotation(angle * help_pi / 180, Q);
      gh_mul2(Q, squeeze, F);
      gh_mul2(Q, P0, turned);
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      OK(gh_rve_commit(rve));
      NEAR("stress", distance(P, turned, 4), 0, 1e-10 * norm(P0, 4));
    }
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Pulled apart until no contact is left a packing carries nothing, and pressed together again it pushes
 * again; where the grains follow F, by the same stress as if it had never been apart. */
static void apart_and_together(void **state) {
  static const double apart[4] = {1.6, 0.1, 0, 1.5};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4], A[16], direct[4];
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-10), *other = make_rve(ctx, p, e, *b, 1, 1e-10);
    walk(ctx, rve, I, apart, 10, P, A);
    assert_true(norm(P, 4) == 0 && norm(A, 16) == 0);
    assert_true(gh_rve_measure(rve)->unjammed && gh_rve_measure(rve)->contacts == 0);
    walk(ctx, rve, apart, squeeze, 10, P, A);
    assert_true(P[0] < 0 && P[3] < 0 && A[0] > 0 && A[15] > 0);
    OK(gh_rve_evaluate(other, squeeze, 0, direct, NULL));
    if (b < all_boundaries + 2) NEAR("stress", distance(P, direct, 4), 0, 1e-13);
    gh_rve_destroy(&rve);
    gh_rve_destroy(&other);
  }
  gh_packing_destroy(&p);
}

/* The square lattice, told with one to four grains in a cell, has the stress of two contacts: P11 = -E (2r -
 * F11) for a lattice constant of one. */
static void one_to_four_grains(void **state) {
  static const int across[5] = {0, 1, 2, 3, 2};
  const double F[4] = {0.99, 0, 0, 0.985}, r = 0.502;
  gh_context *ctx = *state;
  for (int n = 1; n <= 4; n++) {
    double x[8], radius[4], cell[4] = {across[n], 0, 0, n / across[n]};
    for (int i = 0; i < n; i++) {
      radius[i] = r;
      x[2 * i] = 0.3 + i % across[n], x[2 * i + 1] = 0.1 + i / across[n];
    }
    gh_packing *p = make_packing(ctx, n, cell, radius, x);
    FOR_ENGINES(e) for (int b = 1; b < 4; b += 2) {
      double P[4];
      gh_rve *rve = make_rve(ctx, p, e, all_boundaries[b], 10, 1e-11);
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      NEAR("P11", P[0], -10 * (2 * r - F[0]), 1e-13);
      NEAR("P22", P[3], -10 * (2 * r - F[3]), 1e-13);
      NEAR("shear", fmax(fabs(P[1]), fabs(P[2])), 0, 1e-13);
      assert_int_equal(gh_rve_measure(rve)->contacts, 2 * n);
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
}

/* Few grains pressed far into each other and through their own images: equilibrium is found all the same, no
 * grain leaves by more than a cell, and both engines find the same. */
static void deep_overlaps_relax(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 7;
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < 300; trial++) {
    int n = 2 + trial % 3;
    double cell[4] = {1, uniform(&seed) - 0.5, 0, 1}, radius[4], x[8], f[2], P[2][4], moved[12];
    double overlap = 0.2 + 0.3 * uniform(&seed);
    for (int i = 0; i < n; i++) {
      radius[i] = 0.25 / (1 - overlap) * (0.9 + 0.2 * uniform(&seed));
      f[0] = uniform(&seed), f[1] = uniform(&seed);
      gh_apply2(cell, f, &x[2 * i]);
    }
    gh_packing *p = make_packing(ctx, n, cell, radius, x);
    FOR_ENGINES(e) {
      gh_rve *rve = make_rve(ctx, p, e, GH_PERIODIC, 100, 1e-8);
      gh_status s = gh_rve_evaluate(rve, I, 0, P[e], NULL);
      if (s != GH_OK) fail_msg("trial %d, %d grains, %s: %s", trial, n, engine_names[e], gh_message(ctx));
      OK(gh_rve_commit(rve));
      gh_rve_save(rve, moved);
      NEAR("way of a grain", distance(moved + 4, x, 2 * n), 0, 1);
      assert_true(gh_rve_measure(rve)->steps < 5000);
      gh_rve_destroy(&rve);
    }
    if (use_engine(0) && use_engine(1))
      NEAR("engines", distance(P[0], P[1], 4), 0, 1e-5 * (norm(P[0], 4) + 1e-3));
    gh_packing_destroy(&p);
  }
}

static gh_packing *replicated(gh_context *ctx, const gh_packing *p, int nx, int ny) {
  int n = 0;
  double *x, *radius, cell[4] = {nx * p->cell[0], ny * p->cell[1], nx * p->cell[2], ny * p->cell[3]};
  OK(gh_alloc(ctx, 2 * (size_t)(p->n * nx * ny), sizeof *x, &x));
  OK(gh_alloc(ctx, (size_t)(p->n * nx * ny), sizeof *radius, &radius));
  for (int a = 0; a < nx; a++)
    for (int b = 0; b < ny; b++)
      for (int i = 0; i < p->n; i++, n++) {
        radius[n] = p->radius[i];
        for (int k = 0; k < 2; k++)
          x[2 * n + k] = p->x[2 * i + k] + a * p->cell[2 * k] + b * p->cell[2 * k + 1];
      }
  gh_packing *q = make_packing(ctx, n, cell, radius, x);
  memcpy(q->low, p->low, sizeof q->low);
  free(x);
  free(radius);
  return q;
}

/* A packing of 2,100 grains that repeats one of 150 has its stress and tangent, in both engines. (Pressed by
 * 2 % it is stable; near its first contacts a mode longer than the small cell would break the repetition.) */
static void two_thousand_grains(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p150"), *q = replicated(ctx, p, 7, 2);
  assert_int_equal(q->n, 2100);
  FOR_ENGINES(e) for (int b = 1; b < 4; b += 2) {
    double P[4], Q[4], A[16], B[16];
    gh_rve *one = make_rve(ctx, p, e, all_boundaries[b], 1, 1e-11),
           *many = make_rve(ctx, q, e, all_boundaries[b], 1, 1e-11);
    walk(ctx, one, I, squeeze, 2, P, A);
    walk(ctx, many, I, squeeze, 2, Q, B);
    assert_false(gh_rve_measure(many)->regularised);
    NEAR("stress", distance(P, Q, 4), 0, 1e-8 * norm(P, 4));
    NEAR("tangent", distance(A, B, 16), 0, 1e-7 * norm(A, 16));
    gh_rve_destroy(&one);
    gh_rve_destroy(&many);
  }
  gh_packing_destroy(&p);
  gh_packing_destroy(&q);
}

/* A square lattice with forty grains of a thirty-second of the size in its pore: they are pushed out of each
 * other's way and carry nothing, and the stress is that of the lattice. */
static void one_to_thirty_two(void **state) {
  enum { SMALL = 40 };
  gh_context *ctx = *state;
  unsigned long long seed = 32;
  print_message("seed %llu\n", seed);
  double x[2 * SMALL + 2] = {0, 0}, radius[SMALL + 1] = {0.505}, P[4];
  for (int i = 1; i <= SMALL; i++) {
    radius[i] = radius[0] / 32;
    x[2 * i] = 0.43 + 0.14 * uniform(&seed), x[2 * i + 1] = 0.43 + 0.14 * uniform(&seed);
  }
  gh_packing *p = make_packing(ctx, SMALL + 1, I, radius, x);
  p->type[0] = 2;
  const double F[4] = {0.99, 0, 0, 1};
  FOR_ENGINES(e) {
    gh_rve *rve = make_rve(ctx, p, e, GH_PERIODIC, 1, 1e-10);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    NEAR("P11", P[0], -(2 * radius[0] - 0.99), 1e-9);
    NEAR("P22", P[3], -(2 * radius[0] - 1), 1e-9);
    assert_int_equal(gh_rve_measure(rve)->rattlers, SMALL);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Two grains at one place have no direction to push: a message, in both engines and under all conditions. */
static void grains_at_one_place(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  p->x[8] = p->x[30], p->x[9] = p->x[31];
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    double P[4];
    gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-8);
    gh_status s = gh_rve_evaluate(rve, I, 0, P, NULL);
    assert_true(s == GH_DIVERGED || s == GH_ENGINE);
    if (!strstr(gh_message(ctx), "coincide")) fail_msg("%s", gh_message(ctx));
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Another cell of the same lattice, tilted up to three times its width, is the same periodic packing. */
static void strongly_tilted_cells(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50"), *q;
  for (int tilt = -3; tilt <= 3; tilt += 2) {
    OK(gh_packing_copy(ctx, p, &q));
    q->cell[1] += tilt * q->cell[0];
    FOR_ENGINES(e) FOR_BOUNDARIES(b) {
      double P[4], Q[4], A[16], B[16];
      gh_rve *plain = make_rve(ctx, p, e, *b, 1, 1e-11), *tilted = make_rve(ctx, q, e, *b, 1, 1e-11);
      walk(ctx, plain, I, squeeze, 2, P, A);
      walk(ctx, tilted, I, squeeze, 2, Q, B);
      if (*b == GH_TAYLOR_CELL || *b == GH_PERIODIC) {
        NEAR("stress", distance(P, Q, 4), 0, 1e-9 * norm(P, 4));
        NEAR("tangent", distance(A, B, 16), 0, 1e-8 * norm(A, 16));
      } else { /* other grains are at the boundary of the other cell */
        assert_true(Q[0] < 0 && Q[3] < 0 && gh_finite(Q, 4) && gh_finite(B, 16));
      }
      gh_rve_destroy(&plain);
      gh_rve_destroy(&tilted);
    }
    gh_packing_destroy(&q);
  }
  gh_packing_destroy(&p);
}

/* A packing of rattlers only: grains that touch nothing carry nothing, and pairs that overlap are pushed
 * apart until they carry nothing. */
static void rattlers_only(void **state) {
  gh_context *ctx = *state;
  double cell[4] = {10, 0, 0, 10}, radius[6] = {1, 1, 1, 1, 1, 1},
         x[12] = {2, 2, 3.9, 2, 5, 7.1, 5, 5.2, 8.1, 4, 8, 8};
  for (int touching = 0; touching < 2; touching++) {
    if (!touching) x[2] = 4.1, x[7] = 5.05;
    else x[2] = 3.9, x[7] = 5.2;
    gh_packing *p = make_packing(ctx, 6, cell, radius, x);
    FOR_ENGINES(e) FOR_BOUNDARIES(b) {
      double P[4], A[16];
      gh_rve *rve = make_rve(ctx, p, e, *b, 1, 1e-9);
      OK(gh_rve_evaluate(rve, I, GH_WANT_TANGENT, P, A));
      bool carries = touching && (*b == GH_TAYLOR || *b == GH_TAYLOR_CELL);
      if (!carries) assert_true(norm(P, 4) == 0 && norm(A, 16) == 0 && gh_rve_measure(rve)->unjammed);
      else assert_true(P[0] < 0 && P[3] < 0);
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
}

/* What answers, answers with numbers; what cannot be, has a message that holds its numbers too. */
static void ask(gh_context *ctx, gh_rve *rve, const double F[4]) {
  double P[4] = {NAN, NAN, NAN, NAN}, A[16];
  for (int k = 0; k < 16; k++) A[k] = NAN;
  gh_status s = gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A);
  const gh_rve_measures *m = gh_rve_measure(rve);
  assert_true(m->steps < 20000);
  if (s != GH_OK) {
    assert_true(s == GH_INPUT || s == GH_DIVERGED);
    assert_true(strlen(gh_message(ctx)) > 10);
    return;
  }
  bool good = gh_finite(P, 4) && gh_finite(A, 16) && gh_finite(m->cauchy, 4) && isfinite(m->energy) &&
              isfinite(m->residual) && isfinite(m->acoustic) && gh_finite(m->fabric, 3);
  if (!good) fail_msg("F = [%g %g; %g %g]: not finite", F[0], F[1], F[2], F[3]);
}

/* No deformation, however wild, brings out NaN, costs more than some thousand steps, or ends in anything but
 * a number or a message; and none is remembered. */
static void nan_never_comes_out(void **state) {
  static const double wild[][4] = {
      {0.3, 0, 0, 0.3},       {0.1, 0, 0, 0.1},  {1e-4, 0, 0, 1e-4},   {1e-8, 0, 0, 1e-8},
      {1e-150, 0, 0, 1e-150}, {1e-4, 0, 0, 1e4}, {0.01, 0, 0, 100},    {10, 0, 0, 10},
      {100, 0, 0, 100},       {1e4, 0, 0, 1e4},  {1e150, 0, 0, 1e150}, {1, 100, 0, 1},
      {1, 1e4, 0, 1},         {1, 1e8, 0, 1},    {1, 1e300, 0, 1},     {1e8, 0, 0, 1e-8},
      {1, 1, 1, 1.0000001},   {1, 1, 1, 1},      {1, 0, 0, -1},        {-1, 0, 0, -1},
      {0, 0, 0, 0},           {NAN, 0, 0, 1},    {1, INFINITY, 0, 1},  {1, 0, NAN, 1}};
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  unsigned long long seed = 99;
  print_message("seed %llu\n", seed);
  FOR_ENGINES(e) FOR_BOUNDARIES(b) {
    gh_rve *rve = make_rve(ctx, p, e, *b, 100, 1e-8);
    double before[4], after[4], F[4];
    OK(gh_rve_evaluate(rve, squeeze, 0, before, NULL));
    for (size_t k = 0; k < sizeof wild / sizeof *wild; k++) ask(ctx, rve, wild[k]);
    for (int k = 0; k < 60; k++) {
      for (int c = 0; c < 4; c++) F[c] = I[c] + (uniform(&seed) - 0.5) * (k % 4 + 1) / 2;
      ask(ctx, rve, F);
    }
    OK(gh_rve_evaluate(rve, squeeze, 0, after, NULL));
    assert_memory_equal(before, after, sizeof before);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(stiffness_scales),    TEST(length_does_not_matter), TEST(far_from_the_origin),
      TEST(tiny_increments),     TEST(large_increments),       TEST(shear_to_two),
      TEST(two_turns),           TEST(apart_and_together),     TEST(one_to_four_grains),
      TEST(deep_overlaps_relax), TEST(two_thousand_grains),    TEST(one_to_thirty_two),
      TEST(grains_at_one_place), TEST(strongly_tilted_cells),  TEST(rattlers_only),
      TEST(nan_never_comes_out)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
