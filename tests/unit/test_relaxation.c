/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The ways to equilibrium (polished, damped, FIRE) and the count of pair evaluations. */
#include "../help.h"

#include "granhom/farm.h"

#define FOR_ENGINES(e)                                                                                       \
  for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)                                      \
    if (use_engine(e))
#define FOR_WAYS(w) for (gh_relaxation w = GH_RELAX_POLISHED; w <= GH_RELAX_FIRE; w++)

/* Words and ways belong together, both ways; other words are refused; the default is `polished`. */
static void names_of_the_ways(void **state) {
  (void)state;
  static const char *const names[] = {"polished", "damped", "fire"};
  gh_relaxation w;
  for (int k = 0; k < 3; k++) {
    assert_string_equal(gh_relaxation_name((gh_relaxation)k), names[k]);
    assert_true(gh_relaxation_from_name(names[k], &w) && w == (gh_relaxation)k);
  }
  assert_false(gh_relaxation_from_name("FIRE", &w) || gh_relaxation_from_name("", &w) ||
               gh_relaxation_from_name("newton", &w));
  assert_int_equal(gh_rve_defaults().relaxation, GH_RELAX_POLISHED);
}

/* ---- FIRE against its publication: one free grain among fixed ones ---- */

enum { HELD = 5, STEPS = 60 };
static const double E = 7;

typedef struct nest {
  double radius[HELD + 1], x[2 * (HELD + 1)];
} nest;

/* Grain 0 in the middle, the others around it, overlapping by some per cent. */
static nest make_nest(unsigned long long *seed) {
  nest s = {.radius = {1}};
  for (int k = 1; k <= HELD; k++) {
    const double angle = 2 * help_pi * (k + 0.4 * uniform(seed)) / HELD, r = 0.5 + 0.2 * uniform(seed),
                 far = 1 + r - 0.06 - 0.03 * uniform(seed);
    s.radius[k] = r;
    s.x[2 * k] = far * cos(angle), s.x[2 * k + 1] = far * sin(angle);
  }
  s.x[0] = 0.02 * uniform(seed), s.x[1] = -0.02 * uniform(seed);
  return s;
}

/* Force on the free grain at x (4.8), and the bound of the eigenvalues: twice that of sum E n n. */
static double nest_force(const nest *s, const double x[2], double f[2]) {
  double k[3] = {0};
  f[0] = f[1] = 0;
  for (int h = 1; h <= HELD; h++) {
    const double l[2] = {s->x[2 * h] - x[0], s->x[2 * h + 1] - x[1]}, d = hypot(l[0], l[1]),
                 e = s->radius[0] + s->radius[h] - d;
    for (int c = 0; c < 2 && e >= 0; c++) f[c] -= E * e * l[c] / d;
    k[0] += E * l[0] * l[0] / (d * d), k[1] += E * l[0] * l[1] / (d * d), k[2] += E * l[1] * l[1] / (d * d);
  }
  const double mean = (k[0] + k[2]) / 2, most = mean + hypot((k[0] - k[2]) / 2, k[1]);
  return 2 * fmax(most, 2 * E);
}

/* The algorithm of Bitzek et al. with its own parameters: F1-F5 of the publication, semi-implicit Euler. */
static void publication(const nest *s, int steps, double x[2]) {
  double v[2] = {0, 0}, f[2], alpha = 0.1, most = 0, dt = 0;
  int positive = 0;
  memcpy(x, s->x, 2 * sizeof *x);
  for (int k = 0; k < steps; k++) {
    const double bound = nest_force(s, x, f);
    if (k % 32 == 0) {
      dt = k ? dt / most : 0.1;
      most = 1.8 / sqrt(bound);
      dt *= most;
    }
    const double power = v[0] * f[0] + v[1] * f[1];
    if (power > 0) {
      if (++positive > 5) dt = fmin(1.1 * dt, most), alpha *= 0.99;
    } else if (k > 0) {
      positive = 0, dt *= 0.5, alpha = 0.1, v[0] = v[1] = 0;
    }
    for (int c = 0; c < 2; c++) v[c] += dt * f[c];
    const double speed = hypot(v[0], v[1]), force = hypot(f[0], f[1]);
    for (int c = 0; c < 2; c++) {
      v[c] = (1 - alpha) * v[c] + alpha * speed * f[c] / force;
      x[c] += dt * v[c];
    }
  }
}

static void fire_is_the_published_one(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 20;
  const unsigned char held[HELD + 1] = {0, 1, 1, 1, 1, 1};
  FOR_ENGINES(kind) for (int trial = 0; trial < 5; trial++) {
    const nest s = make_nest(&seed);
    const gh_engine_setup setup = {
        .n = HELD + 1, .radius = s.radius, .held = held, .law = {.normal_stiffness = E}};
    gh_engine *e;
    OK(gh_engine_create(ctx, kind, &setup, &e));
    for (int steps = 0; steps <= STEPS; steps += 3) {
      const gh_relax_options o = {.max_steps = steps + 1, .method = GH_RELAX_FIRE};
      gh_relax_result r;
      double x[2 * (HELD + 1)], wanted[2];
      OK(gh_engine_set(e, NULL, s.x, NULL));
      OK(gh_engine_relax(e, &o, &r));
      OK(gh_engine_get(e, x, NULL));
      publication(&s, steps, wanted);
      assert_int_equal(r.steps, steps + 1);
      assert_false(r.converged);
      NEAR("x", x[0], wanted[0], 1e-12);
      NEAR("y", x[1], wanted[1], 1e-12);
      assert_memory_equal(x + 2, s.x + 2, 2 * HELD * sizeof *x);
    }
    gh_engine_destroy(&e);
  }
}

/* ---- one equilibrium ---- */

typedef struct answer {
  double P[4], A[16];
  gh_rve_measures m;
} answer;

/* Three increments with commits; the answer of the last one. */
static answer follow(gh_context *ctx, const gh_packing *p, const gh_rve_options *o) {
  gh_rve *rve;
  answer a;
  OK(gh_rve_create(ctx, p, o, &rve));
  for (int k = 1; k <= 3; k++) {
    const double F[4] = {1 - 5e-5 * k, 1e-5 * k, 0, 1 - 8e-5 * k};
    OK(gh_rve_evaluate(rve, F, k == 3 ? GH_WANT_TANGENT : 0, a.P, a.A));
    a.m = *gh_rve_measure(rve);
    assert_int_equal(a.m.sliding, 0);
    if (o->relaxation != GH_RELAX_POLISHED) {
      assert_int_equal(a.m.polished, 0);
      if (k < 3) assert_int_equal(a.m.factorisations, 0); /* no Newton step at all */
    }
    assert_true(a.m.residual <= o->tolerance);
    OK(gh_rve_commit(rve));
  }
  gh_rve_destroy(&rve);
  return a;
}

static void one_equilibrium_by_all_ways(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  FOR_ENGINES(e) for (int friction = 0; friction < 3; friction++) for (int b = 0; b < 4; b++) {
    gh_rve_options o = rve_options(e, all_boundaries[b], 1000, 1e-10);
    o.law.friction = friction > 0;
    o.law.tangential_stiffness = 700, o.law.friction_coefficient = 20;
    o.law.fixed_rotations = friction == 2;
    const bool relaxes = b >= 2 || friction == 1;
    const answer reference = follow(ctx, p, &o);
    assert_int_equal(reference.m.polished, relaxes);
    FOR_WAYS(w) {
      o.relaxation = w;
      const answer a = follow(ctx, p, &o);
      NEAR("P", distance(a.P, reference.P, 4), 0, 1e-7 * norm(reference.P, 4));
      NEAR("A", distance(a.A, reference.A, 16), 0, 1e-6 * norm(reference.A, 16));
      assert_int_equal(a.m.contacts, reference.m.contacts);
      if (relaxes && w) assert_true(a.m.steps > reference.m.steps); /* Newton's part by relaxation */
      if (!relaxes) assert_int_equal(a.m.steps, 0);
    }
  }
  gh_packing_destroy(&p);
}

/* Far from equilibrium FIRE continues from list to list, and both engines go the same way. */
static void fire_over_many_lists(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  const double F[4] = {0.9, 0.1, 0, 0.95}, theta[50] = {0};
  const gh_converged n = {
      .cell = {p->cell[0], p->cell[1], p->cell[2], p->cell[3]}, .x = p->x, .theta = theta};
  double cell[4], start[100], x[2][100];
  gh_mul2(F, p->cell, cell);
  for (int i = 0; i < 50; i++) gh_apply2(F, &p->x[2 * i], &start[2 * i]);
  for (int friction = 0; friction < 2; friction++) {
    FOR_ENGINES(kind) {
      const gh_engine_setup setup = {.n = p->n,
                                     .radius = p->radius,
                                     .type = p->type,
                                     .periodic = true,
                                     .law = {100, friction, 80, 0.3, 10, GH_SLIP_PROJECTED, 0}};
      const gh_relax_options o = {.tolerance = 1e-9, .max_steps = 100000, .method = GH_RELAX_FIRE};
      gh_engine *e;
      gh_engine_cost before, after;
      gh_relax_result r;
      double turned[50];
      OK(gh_engine_create(ctx, kind, &setup, &e));
      OK(gh_engine_begin(e, &n));
      OK(gh_engine_set(e, cell, start, theta));
      gh_engine_costs(e, &before);
      OK(gh_engine_relax(e, &o, &r));
      gh_engine_costs(e, &after);
      assert_true(r.converged && r.residual <= 1e-9 && r.mean_force > 0);
      assert_true(after.rebuilds - before.rebuilds >= 2);
      OK(gh_engine_get(e, x[kind], turned));
      gh_engine_destroy(&e);
    }
    if (use_engine(GH_ENGINE_LAMMPS) && use_engine(GH_ENGINE_NATIVE))
      NEAR("positions", distance(x[0], x[1], 100), 0, 1e-4);
  }
  gh_packing_destroy(&p);
}

/* A packing that loses its contacts comes to rest by each way, and states so. */
static void unjamming_by_all_ways(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  const double F[4] = {1.05, 0, 0, 1.05};
  FOR_ENGINES(e) FOR_WAYS(w) {
    gh_rve_options o = rve_options(e, GH_PERIODIC, 100, 1e-8);
    gh_rve *rve;
    double P[4];
    o.relaxation = w;
    OK(gh_rve_create(ctx, p, &o, &rve));
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    assert_true(gh_rve_measure(rve)->unjammed && norm(P, 4) == 0);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Relaxation alone may spend its steps: an error that states how far it came. */
static void too_few_steps(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  const double F[4] = {0.99, 0, 0, 0.99};
  FOR_ENGINES(e) for (gh_relaxation w = GH_RELAX_DAMPED; w <= GH_RELAX_FIRE; w++) {
    gh_rve_options o = rve_options(e, GH_PERIODIC, 100, 1e-8);
    gh_rve *rve;
    double P[4];
    o.relaxation = w, o.max_steps = 20;
    OK(gh_rve_create(ctx, p, &o, &rve));
    FAILS(gh_rve_evaluate(rve, F, 0, P, NULL), GH_DIVERGED, "no equilibrium within 20 relaxation steps");
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* ---- pair evaluations ---- */

/* Pairs of grains, images among them, that are nearer than the sum of their radii and a fifth of the mean
 * radius: each once. */
static long pairs_within(const gh_packing *p, const double *x, const double cell[4]) {
  double skin = 0;
  long pairs = 0;
  for (int i = 0; i < p->n; i++) skin += 0.2 * p->radius[i] / p->n;
  for (int i = 0; i < p->n; i++)
    for (int j = i; j < p->n; j++)
      for (int kx = -2; kx <= 2; kx++)
        for (int ky = -2; ky <= 2; ky++) {
          if (i == j && (ky < 0 || (ky == 0 && kx <= 0))) continue;
          const double l[2] = {x[2 * j] - x[2 * i] + cell[0] * kx + cell[1] * ky,
                               x[2 * j + 1] - x[2 * i + 1] + cell[2] * kx + cell[3] * ky};
          pairs += hypot(l[0], l[1]) < p->radius[i] + p->radius[j] + skin;
        }
  return pairs;
}

/* On one list, each step of relaxation and each list of contacts evaluates all pairs that the list holds. */
static void pairs_are_steps_times_the_list(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p150");
  double theta[150] = {0};
  const gh_converged n = {
      .cell = {p->cell[0], p->cell[1], p->cell[2], p->cell[3]}, .x = p->x, .theta = theta};
  const long listed = pairs_within(p, p->x, p->cell);
  FOR_ENGINES(kind) for (int friction = 0; friction < 2; friction++) FOR_WAYS(w) {
    const gh_engine_setup setup = {.n = p->n,
                                   .radius = p->radius,
                                   .type = p->type,
                                   .periodic = true,
                                   .law = {1000, friction, 800, 0.5, 0, GH_SLIP_PROJECTED, 0}};
    const gh_relax_options o = {.max_steps = 25, .method = w};
    gh_engine *e;
    gh_engine_cost before, relaxed, looked;
    gh_contact_list list;
    gh_relax_result r;
    OK(gh_engine_create(ctx, kind, &setup, &e));
    OK(gh_engine_begin(e, &n));
    OK(gh_engine_set(e, p->cell, p->x, theta));
    gh_engine_costs(e, &before);
    assert_int_equal(before.pairs, 0);
    OK(gh_engine_relax(e, &o, &r));
    gh_engine_costs(e, &relaxed);
    assert_true(r.steps > 0 && relaxed.rebuilds == before.rebuilds);
    assert_int_equal(relaxed.pairs, r.steps * listed);
    for (int k = 1; k <= 2; k++) {
      OK(gh_engine_contacts(e, &list));
      gh_engine_costs(e, &looked);
      assert_int_equal(looked.pairs - relaxed.pairs, k * listed);
    }
    gh_engine_destroy(&e);
  }
  gh_packing_destroy(&p);
}

/* A cell so small that grains meet their own images, and nothing to relax: one list of contacts. */
static void own_images_count_once(void **state) {
  gh_context *ctx = *state;
  const double radius[] = {1, 0.8}, x[] = {0.2, 0.3, 1.7, 1.6}, cell[] = {2.1, 0.3, 0, 2.3},
               I[] = {1, 0, 0, 1};
  gh_packing *p = make_packing(ctx, 2, cell, radius, x);
  FOR_ENGINES(e) for (int friction = 0; friction < 2; friction++) {
    gh_rve_options o = rve_options(e, GH_TAYLOR_CELL, 10, 1e-8);
    gh_rve *rve;
    double P[4];
    o.law.friction = friction;
    o.law.tangential_stiffness = 8, o.law.friction_coefficient = 0.3, o.law.fixed_rotations = 1;
    OK(gh_rve_create(ctx, p, &o, &rve));
    OK(gh_rve_evaluate(rve, I, 0, P, NULL));
    assert_true(gh_rve_measure(rve)->contacts > 2);
    assert_int_equal(gh_rve_measure(rve)->pairs, pairs_within(p, x, cell));
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* An RVE's cost is the sum of its evaluations, the failed ones too; the engines count alike. */
static void pairs_of_an_rve(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50d");
  for (int friction = 0; friction < 2; friction++) FOR_WAYS(w) {
      double count[2] = {0};
      FOR_ENGINES(e) {
        gh_rve_options o = rve_options(e, GH_PERIODIC, 1000, 1e-9);
        gh_rve *rve;
        gh_rve_cost cost;
        double P[4], A[16];
        long sum = 0;
        o.relaxation = w;
        o.law.friction = friction;
        o.law.tangential_stiffness = 800, o.law.friction_coefficient = 0.5, o.law.hardening = 10;
        OK(gh_rve_create(ctx, p, &o, &rve));
        for (int k = 1; k <= 5; k++) {
          const double F[4] = {1 - 2e-4 * k, 0, 0, 1 - 1e-4 * k};
          OK(gh_rve_evaluate(rve, F, k % 2 ? GH_WANT_TANGENT : 0, P, A));
          OK(gh_rve_commit(rve));
          assert_true(gh_rve_measure(rve)->pairs > 50 * gh_rve_measure(rve)->steps);
          sum += gh_rve_measure(rve)->pairs;
        }
        gh_rve_costs(rve, &cost);
        assert_int_equal(cost.pairs, sum);
        count[e] = (double)sum;
        gh_rve_destroy(&rve);
      }
      if (use_engine(GH_ENGINE_LAMMPS) && use_engine(GH_ENGINE_NATIVE))
        NEAR("pairs of LAMMPS and of the native engine", count[0] / count[1], 1, 0.02);
    }
  gh_packing_destroy(&p);
}

/* Uniaxial compression in `steps` increments, each committed; returns how many Newton's iteration found alone. */
static int compress(gh_context *ctx, const gh_packing *p, gh_boundary b, gh_relaxation way, int steps,
                    double total, double P[4]) {
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, b, 50, 1e-10);
  gh_rve *rve;
  int newton = 0;
  o.relaxation = way;
  OK(gh_rve_create(ctx, p, &o, &rve));
  for (int k = 0; k <= steps; k++) {
    const double F[4] = {1 - total * k / steps, 0, 0, 1};
    OK(gh_rve_evaluate(rve, F, 0, P, NULL));
    OK(gh_rve_commit(rve));
    const gh_rve_measures *m = gh_rve_measure(rve);
    if (m->newton) assert_true(m->steps == 0 && m->polished && m->residual <= 1e-10);
    newton += m->newton;
  }
  gh_rve_destroy(&rve);
  return newton;
}

/* Where Newton's iteration comes to the end by itself it is on the branch of relaxation alone, and an increment
 * without instability ends where ten tenths of it end. */
static void newton_first_keeps_the_branch(void **state) {
  static const char *const names[] = {"p50", "p150"};
  gh_context *ctx = *state;
  double P[4], Q[4], R[4];
  for (int k = 0; k < 2; k++)
    for (gh_boundary b = GH_RESTRICTED; b <= GH_PERIODIC; b++) {
      gh_packing *p = case_packing(ctx, names[k]);
      const int newton = compress(ctx, p, b, GH_RELAX_POLISHED, 20, 0.01, P);
      assert_int_equal(compress(ctx, p, b, GH_RELAX_DAMPED, 20, 0.01, Q), 0);
      assert_true(newton >= 10);
      for (int c = 0; c < 4; c++) NEAR("branch of relaxation", P[c], Q[c], 1e-8 * fabs(Q[0]));
      assert_true(compress(ctx, p, b, GH_RELAX_POLISHED, 1, 5e-4, P) >= 1);
      assert_true(compress(ctx, p, b, GH_RELAX_POLISHED, 10, 5e-4, R) >= 5);
      for (int c = 0; c < 4; c++) NEAR("one increment and ten", P[c], R[c], 1e-6 * fabs(R[0]));
      gh_packing_destroy(&p);
    }
}

/* A packing of sand with rattlers that lean on others: Newton finishes nearly all of its equilibria, in few
 * factorisations, and leaves the stress where relaxation alone finds it. */
static void rattlers_do_not_hinder_newton(void **state) {
  gh_context *ctx = *state;
  enum { ROWS = 25 };
  gh_packing *p;
  double P[2][ROWS][4];
  int polished = 0, newton = 0, factorisations = 0, rattlers = 0;
  OK(gh_packing_read(ctx, "scenes/block/sand150.data", &p));
  for (int alone = 0; alone < 2; alone++) {
    gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, 50, 1e-8);
    gh_rve *rve;
    o.relaxation = alone ? GH_RELAX_DAMPED : GH_RELAX_POLISHED;
    OK(gh_rve_create(ctx, p, &o, &rve));
    for (int k = 0; k < ROWS; k++) {
      const double F[4] = {1 - 0.004 * (k + 1), 0, 0, 1};
      OK(gh_rve_evaluate(rve, F, 0, P[alone][k], NULL));
      OK(gh_rve_commit(rve));
      const gh_rve_measures *m = gh_rve_measure(rve);
      polished += m->polished, newton += m->newton, factorisations += m->factorisations,
          rattlers += m->rattlers;
    }
    gh_rve_destroy(&rve);
  }
  assert_true(rattlers > 2 * ROWS);
  assert_true(polished >= 20); /* 15, and 55 factorisations, if rattlers stay where they are */
  assert_true(factorisations <= 3 * polished + 6 * (ROWS - newton)); /* six are tried first */
  for (int k = 0; k < ROWS; k++)
    for (int c = 0; c < 4; c++) NEAR("stress", P[0][k][c], P[1][k][c], 1e-6 * fabs(P[1][k][0]));
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(names_of_the_ways),
                                     TEST(fire_is_the_published_one),
                                     TEST(one_equilibrium_by_all_ways),
                                     TEST(fire_over_many_lists),
                                     TEST(unjamming_by_all_ways),
                                     TEST(too_few_steps),
                                     TEST(own_images_count_once),
                                     TEST(pairs_are_steps_times_the_list),
                                     TEST(pairs_of_an_rve),
                                     TEST(newton_first_keeps_the_branch),
                                     TEST(rattlers_do_not_hinder_newton)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
