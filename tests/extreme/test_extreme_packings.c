/* SPDX-License-Identifier: GPL-2.0-or-later */
/* RVEs at the edges of what can be asked of them: few and many grains, size ratios, overlaps, degenerate
 * packings. */
#include "extreme_rve.h"

/* The square lattice, told with one to four grains in a cell, has the stress of two contacts: P11 = -E (2r -
 * F11) for a lattice constant of one. */
static void one_to_four_grains(void **state) {
  static const int across[5] = {0, 1, 2, 3, 2};
  const double F[4] = {0.99, 0, 0, 0.985}, r = 0.502;
  gh_context *ctx = *state;
  double worst = 0;
  for (int n = 1; n <= 4; n++) {
    double x[8], radius[4], cell[4] = {across[n], 0, 0, n / across[n]};
    for (int i = 0; i < n; i++) {
      radius[i] = r;
      x[2 * i] = 0.3 + i % across[n], x[2 * i + 1] = 0.1 + i / across[n];
    }
    gh_packing *p = make_packing(ctx, n, cell, radius, x);
    const double wanted[4] = {-10 * (2 * r - F[0]), 0, 0, -10 * (2 * r - F[3])};
    FOR_ENGINES(e) for (int b = 1; b < 4; b += 2) {
      double P[4];
      gh_rve *rve = make_rve(ctx, p, e, all_boundaries[b], 10, 1e-11);
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      WITHIN(&worst, "stress", relative(P, wanted, 4), 1e-12);
      assert_int_equal(gh_rve_measure(rve)->contacts, 2 * n);
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
  row_error(section, "1, 2, 3, 4 grains (square lattice)", "closed form", worst, 1e-12);
}

/* Few grains pressed far into each other and through their own images: equilibrium is found all the same, no
 * grain leaves by more than a cell, and both engines find the same. */
static void deep_overlaps_relax(void **state) {
  gh_context *ctx = *state;
  double worst = 0;
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
      WITHIN(&worst, "engines", distance(P[0], P[1], 4) / (norm(P[0], 4) + 1e-3), 1e-5);
    gh_packing_destroy(&p);
  }
  row_error(section, "300 heaps of 2 to 4 grains, pressed into each other by 20 to 50 %", "engines agree",
            worst, 1e-5);
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
  double worst = 0;
  gh_packing *p = case_packing(ctx, "p150"), *q = replicated(ctx, p, 7, 2);
  assert_int_equal(q->n, 2100);
  FOR_ENGINES(e) for (int b = 1; b < 4; b += 2) {
    double P[4], Q[4], A[16], B[16];
    gh_rve *one = make_rve(ctx, p, e, all_boundaries[b], 1, 1e-11),
           *many = make_rve(ctx, q, e, all_boundaries[b], 1, 1e-11);
    walk(ctx, one, I, squeeze, 2, P, A);
    walk(ctx, many, I, squeeze, 2, Q, B);
    assert_false(gh_rve_measure(many)->regularised);
    WITHIN(&worst, "stress", relative(Q, P, 4), 1e-8);
    WITHIN(&worst, "tangent", relative(B, A, 16), 1e-7);
    gh_rve_destroy(&one);
    gh_rve_destroy(&many);
  }
  gh_packing_destroy(&p);
  gh_packing_destroy(&q);
  row_error(section, "2,100 grains: one of 150 repeated", "P, A of the 150", worst, 1e-7);
}

/* A square lattice with forty grains of a thirty-second and a hundredth of the size in its pore: they are
 * pushed out of each other's way and carry nothing, and the stress is that of the lattice. */
static void small_grains_in_a_pore(void **state) {
  enum { SMALL = 40 };
  gh_context *ctx = *state;
  unsigned long long seed = 32;
  const double F[4] = {0.99, 0, 0, 1};
  double worst = 0;
  print_message("seed %llu\n", seed);
  for (int ratio = 32; ratio <= 100; ratio += 68) {
    double x[2 * SMALL + 2] = {0, 0}, radius[SMALL + 1] = {0.505}, P[4], wide = 4.48 / ratio;
    for (int i = 1; i <= SMALL; i++) {
      radius[i] = radius[0] / ratio;
      for (int k = 0; k < 2; k++) x[2 * i + k] = 0.5 + wide * (uniform(&seed) - 0.5);
    }
    const double wanted[4] = {-(2 * radius[0] - 0.99), 0, 0, -(2 * radius[0] - 1)};
    gh_packing *p = make_packing(ctx, SMALL + 1, I, radius, x);
    p->type[0] = 2;
    FOR_ENGINES(e) {
      gh_rve *rve = make_rve(ctx, p, e, GH_PERIODIC, 1, 1e-10);
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      WITHIN(&worst, "stress", relative(P, wanted, 4), 1e-7);
      assert_int_equal(gh_rve_measure(rve)->rattlers, SMALL);
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
  row_error(section, "size ratios 1:32 and 1:100: grains in the pore of a lattice",
            "the lattice's stress; the small ones are rattlers", worst, 1e-7);
}

/* A large grain among hundreds of a hundredth of its size, which it touches. */
static void one_to_a_hundred(void **state) {
  enum { N = 300 };
  gh_context *ctx = *state;
  unsigned long long seed = 100;
  const double F[4] = {0.97, 0.01, 0, 0.98};
  double worst = 0, x[2 * N] = {0.5, 0.5}, radius[N] = {0.3}, P[4], wanted[4];
  print_message("seed %llu\n", seed);
  for (int i = 1; i < N; i++) {
    double angle = 2 * help_pi * uniform(&seed), far = i % 2 ? 0.3025 : 0.31 + 0.15 * uniform(&seed);
    radius[i] = 0.003;
    x[2 * i] = 0.5 + far * cos(angle), x[2 * i + 1] = 0.5 + far * sin(angle);
  }
  gh_packing *p = make_packing(ctx, N, I, radius, x);
  p->type[0] = 2;
  sum_of_pairs(p, F, 1, wanted);
  FOR_ENGINES(e) {
    gh_rve *rve = make_rve(ctx, p, e, GH_TAYLOR_CELL, 1, 1e-10);
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    WITHIN(&worst, "stress", relative(P, wanted, 4), 1e-12);
    assert_true(gh_rve_measure(rve)->contacts > N / 2);
    gh_rve_destroy(&rve);
  }
  row_error(section, "size ratio 1:100: 299 grains around one, Taylor", "plain sum over all pairs", worst,
            1e-12);
  gh_packing_destroy(&p);
}

/* Overlaps of 1e-10 to 0.2 of the radius in the square lattice: P = -2 E e / cell. Round-off of a length
 * leaves eps r / e. */
static void lattice_overlaps(void **state) {
  const double x[2] = {0.3, 0.4}, E = 3;
  gh_context *ctx = *state;
  double worst = 0, P[4];
  for (double e = 1e-10; e < 0.3; e = e < 0.05 ? 10 * e : 2 * e) {
    double radius[1] = {0.5 * (1 + e)}, overlap = 2 * radius[0] - 1;
    gh_packing *p = make_packing(ctx, 1, I, radius, x);
    const double wanted[4] = {-E * overlap, 0, 0, -E * overlap};
    FOR_ENGINES(k) for (int b = 1; b < 4; b += 2) {
      gh_rve *rve = make_rve(ctx, p, k, all_boundaries[b], E, 1e-10);
      OK(gh_rve_evaluate(rve, I, 0, P, NULL));
      assert_false(gh_rve_measure(rve)->unjammed);
      WITHIN(&worst, "stress", relative(P, wanted, 4) / (1 + 1e-3 / e), 1e-12);
      gh_rve_destroy(&rve);
    }
    gh_packing_destroy(&p);
  }
  row_error(section, "overlap 1e-10 to 20 % of the radius, lattice",
            "closed form; relative to 1 + 1e-3/overlap", worst, 1e-12);
}

/* Blown up until the mean overlap is 1e-10 of the radius: in steps that leave it at least a twentieth of what
 * it was. Round-off of the positions, 16 eps E (cell)/(mean force), is all that the last residuals can
 * promise. */
static void vanishing_overlaps(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  const double r = gh_packing_mean_radius(p);
  double worst = 0, residual = 0;
  FOR_ENGINES(e) for (int b = 2; b < 4; b++) {
    gh_rve *rve = make_rve(ctx, p, e, all_boundaries[b], 1, 1e-10);
    const gh_rve_measures *m = gh_rve_measure(rve);
    double s = 0.98, P[4], edge[4], F[4] = {s, 0, 0, s}, overlap, increment = 1e-2;
    walk(ctx, rve, F, F, 1, P, NULL);
    overlap = m->mean_force / r;
    for (int tries = 0; overlap > 1e-10; tries++) {
      assert_true(tries < 200);
      F[0] = F[3] = s + increment;
      OK(gh_rve_evaluate(rve, F, 0, P, NULL));
      double now = m->unjammed ? 0 : m->mean_force / r;
      if (now < 0.05 * overlap) {
        increment /= 2;
        continue;
      }
      OK(gh_rve_boundary_stress(rve, edge));
      WITHIN(&worst, "boundary form", relative(edge, P, 4), 1e-4);
      WITHIN(&worst, "symmetry", fabs(m->cauchy[1] - m->cauchy[2]) / norm(m->cauchy, 4), 1e-4);
      WITHIN(&residual, "residual", m->residual, 1e-3);
      s += increment;
      if (now > 0.5 * overlap) increment *= 1.5;
      OK(gh_rve_commit(rve));
      overlap = now;
    }
    gh_rve_destroy(&rve);
  }
  row(section, "mean overlap down to 1e-10 of the radius, 50 grains",
      "boundary form of the stress, symmetric Cauchy stress",
      "converged, error %.0e (allowed 1e-04); the residual ends at %.0e, round-off of the positions", worst,
      residual);
  gh_packing_destroy(&p);
}

/* 50,000 grains: a packing of 50 repeated a thousand times, Taylor and periodic. */
static void fifty_thousand_grains(void **state) {
  gh_context *ctx = *state;
  if (!full_size()) skip();
  gh_packing *p = case_packing(ctx, "p50"), *q = replicated(ctx, p, 40, 25);
  double worst = 0, seconds = 0;
  assert_int_equal(q->n, 50000);
  FOR_ENGINES(e) for (int b = 1; b < 4; b += 2) {
    double P[4], Q[4], A[16], B[16];
    gh_rve *one = make_rve(ctx, p, e, all_boundaries[b], 1, 1e-10),
           *many = make_rve(ctx, q, e, all_boundaries[b], 1, 1e-10);
    walk(ctx, one, I, squeeze, 1, P, A);
    walk(ctx, many, I, squeeze, 1, Q, B);
    seconds = fmax(seconds, gh_rve_measure(many)->seconds);
    print_message("%s %s %g %g, regularised %d steps %ld %g s\n", engine_names[e],
                  gh_boundary_name(all_boundaries[b]), relative(Q, P, 4), relative(B, A, 16),
                  gh_rve_measure(many)->regularised, gh_rve_measure(many)->steps,
                  gh_rve_measure(many)->seconds);
    WITHIN(&worst, "stress", relative(Q, P, 4), 1e-6);
    gh_rve_destroy(&one);
    gh_rve_destroy(&many);
  }
  row_error(section, "50,000 grains: 50 repeated a thousand times, increment of 2 %", "P of the 50", worst,
            1e-6);
  gh_packing_destroy(&p);
  gh_packing_destroy(&q);
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
  row(section, "two grains at one place", "message, exit status 1", "refused: grains coincide");
}

/* Another cell of the same lattice, tilted up to three times its width, is the same periodic packing. */
static void strongly_tilted_cells(void **state) {
  gh_context *ctx = *state;
  double worst = 0;
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
        WITHIN(&worst, "stress", relative(Q, P, 4), 1e-9);
        WITHIN(&worst, "tangent", relative(B, A, 16), 1e-8);
      } else { /* other grains are at the boundary of the other cell */
        assert_true(Q[0] < 0 && Q[3] < 0 && gh_finite(Q, 4) && gh_finite(B, 16));
      }
      gh_rve_destroy(&plain);
      gh_rve_destroy(&tilted);
    }
    gh_packing_destroy(&q);
  }
  gh_packing_destroy(&p);
  row_error(section, "cells tilted by up to three times their width", "P, A of the upright cell", worst,
            1e-8);
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
  row(section, "a packing of rattlers only", "P = 0, A = 0, unjammed", "converged, exactly");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(lattice_overlaps),       TEST(vanishing_overlaps),  TEST(one_to_four_grains),
      TEST(deep_overlaps_relax),    TEST(two_thousand_grains), TEST(fifty_thousand_grains),
      TEST(small_grains_in_a_pore), TEST(one_to_a_hundred),    TEST(grains_at_one_place),
      TEST(strongly_tilted_cells),  TEST(rattlers_only)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
