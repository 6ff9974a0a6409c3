/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Farms: sharing, pools, packings per point, images, balance, books. Several ranks:
 * tests/system/mpi_run.sh. */
#include "../help.h"

#include "farm/books.h"

#include <time.h>

enum { POINTS = 6, STEPS = 4 };
#define FOR_ENGINES(e)                                                                                       \
  for (gh_engine_kind e = GH_ENGINE_LAMMPS; e <= GH_ENGINE_NATIVE; e++)                                      \
    if (use_engine(e))

/* F of point k in step s: points 0, 1, 2 go together up to step 1, 0 and 1 up to step 2, 3 goes alone, 4 and
 * 5 always together. */
static void deform(int k, int s, double F[4]) {
  int path = k == 3 ? 3 : k >= 4 ? 4 : s <= 1 ? 0 : k == 2 ? 2 : s <= 2 ? 0 : k;
  double a = 0.002 * (s + 1), b = 0.0007 * path * (s + 1);
  F[0] = 1 - a, F[1] = b, F[2] = 0.3 * b, F[3] = 1 - 0.5 * a + 0.2 * b;
}

/* What a run through all steps leaves: P, A and energy of all points in all steps, positions at the end. */
typedef struct record {
  double P[STEPS][POINTS][4], A[STEPS][POINTS][16], energy[STEPS][POINTS];
  double x[POINTS][2 * 200];
  int nx[POINTS];
} record;

static void step(gh_context *ctx, gh_farm *farm, int s, record *r) {
  double F[4 * POINTS], other[4 * POINTS], P[4 * POINTS];
  for (int k = 0; k < POINTS; k++) {
    deform(k, s, F + 4 * k);
    for (int i = 0; i < 4; i++) other[4 * k + i] = F[4 * k + i] + (i == 1 ? 0.001 * (k % 2) : 0);
  }
  OK(gh_farm_evaluate(farm, other, 0, P, NULL)); /* a trial that is dropped, where other points part */
  if (s % 2) OK(gh_farm_revert(farm));
  OK(gh_farm_evaluate(farm, F, GH_WANT_TANGENT, r->P[s][0], r->A[s][0]));
  OK(gh_farm_commit(farm));
  for (int k = 0; k < POINTS; k++) r->energy[s][k] = gh_farm_measure(farm, k)->energy;
}

static void finish(gh_context *ctx, gh_farm *farm, record *r) {
  for (int k = POINTS; k-- > 0;) {
    gh_rve_view v;
    OK(gh_farm_look(farm, k, &v));
    assert_true(v.n <= 200);
    r->nx[k] = v.n;
    memcpy(r->x[k], v.x, 2 * (size_t)v.n * sizeof(double));
  }
}

static record *run(gh_context *ctx, const gh_farm_setup *setup, gh_farm_counts *counts) {
  record *r;
  gh_farm *farm;
  OK(gh_alloc(ctx, 1, sizeof *r, &r));
  OK(gh_farm_create_shared(ctx, setup, &farm));
  for (int s = 0; s < STEPS; s++) step(ctx, farm, s, r);
  finish(ctx, farm, r);
  gh_farm_count(farm, counts);
  gh_farm_destroy(&farm);
  return r;
}

static gh_rve_options law(gh_engine_kind e, gh_boundary boundary, bool friction) {
  gh_rve_options o = rve_options(e, boundary, 100, 1e-9);
  o.law.friction = friction;
  o.law.tangential_stiffness = 80, o.law.friction_coefficient = 0.3, o.law.hardening = 1;
  return o;
}

/* Four boundary conditions, without and with friction. */
enum { KINDS = 8 };

static void same(const record *a, const record *b) {
  assert_memory_equal(a, b, sizeof *a);
}

/* Sharing and the size of the pool change nothing but what is computed. */
static void sharing_and_pools_change_no_bit(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  FOR_ENGINES(e)
  for (int kind = 0; kind < KINDS; kind++) {
    gh_farm_setup setup = {.n = POINTS,
                           .npackings = 1,
                           .packings = (const gh_packing *const[]){p},
                           .rve = law(e, all_boundaries[kind % 4], kind >= 4)};
    gh_farm_counts shared, alone;
    record *reference = run(ctx, &setup, &shared), *other;
    setup.no_share = true;
    other = run(ctx, &setup, &alone);
    same(reference, other);
    free(other);
    /* groups of the evaluations that are committed: {012}{3}{45} twice, {01}{2}{3}{45}, {0}{1}{2}{3}{45};
     * of the dropped ones {02}{1}{3}{4}{5} twice, then {0}{1}{2}{3}{4}{5} */
    assert_int_equal(alone.computed, 2 * STEPS * POINTS);
    assert_int_equal(shared.computed, 3 + 3 + 4 + 5 + 5 + 5 + 6 + 6);
    assert_int_equal(alone.evaluations, shared.evaluations);
    assert_int_equal(alone.steps, shared.steps);
    assert_int_equal(alone.factorisations, shared.factorisations);
    assert_int_equal(shared.states, 5);
    assert_int_equal(alone.states, POINTS);
    for (int resident = 1; resident <= 3; resident++) {
      gh_farm_counts pooled;
      setup.no_share = resident == 2;
      setup.resident = resident;
      other = run(ctx, &setup, &pooled);
      same(reference, other);
      assert_int_equal(pooled.residents, resident);
      free(other);
    }
    free(reference);
  }
  gh_packing_destroy(&p);
}

/* What is kept is where nearby evaluations begin, until it is reverted or committed: as by hand with one RVE,
 * to the bit, with and without sharing, and with a pool of one. Without friction nothing is kept. */
static void kept_states(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  const gh_packing *packings[] = {p};
  for (int kind = 0; kind < 4; kind++) {
    const bool friction = kind > 0;
    gh_rve_options o = law(GH_ENGINE_NATIVE, GH_PERIODIC, friction);
    const gh_farm_setup setup = {
        .n = 3, .npackings = 1, .packings = packings, .rve = o, .no_share = kind == 2, .resident = kind == 3};
    const double first[4] = {0.97, 0.02, 0.01, 0.99}, then[4] = {0.9701, 0.0199, 0.01, 0.99};
    double F[12], P[12], alone[4], again[4], cold[4], *near;
    gh_farm *farm;
    gh_rve *rve;
    gh_farm_counts counts;
    OK(gh_rve_create(ctx, p, &o, &rve));
    OK(gh_rve_evaluate(rve, first, 0, alone, NULL));
    OK(gh_alloc(ctx, gh_rve_trial_size(rve), sizeof *near, &near));
    OK(gh_rve_save_trial(rve, near));
    OK(gh_rve_evaluate_near(rve, then, near, gh_rve_trial_size(rve), 0, again, NULL));
    OK(gh_rve_evaluate(rve, then, 0, cold, NULL));
    assert_true(memcmp(again, cold, sizeof cold) != 0);
    OK(gh_farm_create_shared(ctx, &setup, &farm));
    gh_farm_keep(farm); /* nothing yet */
    for (int k = 0; k < 3; k++) memcpy(F + 4 * k, first, sizeof first);
    OK(gh_farm_evaluate(farm, F, 0, P, NULL));
    gh_farm_keep(farm);
    for (int k = 0; k < 3; k++) memcpy(F + 4 * k, then, sizeof then);
    for (int twice = 0; twice < 2; twice++) { /* a trial that is not kept changes nothing */
      OK(gh_farm_evaluate(farm, F, 0, P, NULL));
      for (int k = 0; k < 3; k++) assert_memory_equal(P + 4 * k, friction ? again : cold, sizeof cold);
    }
    gh_farm_count(farm, &counts);
    assert_int_equal(counts.computed, kind == 2 ? 9 : 3);
    OK(gh_farm_revert(farm));
    OK(gh_farm_evaluate(farm, F, 0, P, NULL));
    assert_memory_equal(P + 4, cold, sizeof cold);
    gh_farm_keep(farm);
    OK(gh_farm_commit(farm));
    OK(gh_rve_evaluate(rve, then, 0, cold, NULL));
    OK(gh_rve_commit(rve));
    OK(gh_rve_evaluate(rve, first, 0, cold, NULL));
    for (int k = 0; k < 3; k++) memcpy(F + 4 * k, first, sizeof first);
    OK(gh_farm_evaluate(farm, F, 0, P, NULL));
    assert_memory_equal(P + 8, cold, sizeof cold);
    free(near);
    gh_farm_destroy(&farm);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Each point answers as its packing does alone. */
static void packings_per_point(void **state) {
  gh_context *ctx = *state;
  gh_packing *p[2] = {case_packing(ctx, "p20"), case_packing(ctx, "p50")};
  const int of[POINTS] = {1, 1, 0, 0, 1, 0};
  FOR_ENGINES(e) {
    gh_farm_setup setup = {.n = POINTS,
                           .npackings = 2,
                           .packings = (const gh_packing *const *)p,
                           .packing_of = of,
                           .rve = law(e, GH_PERIODIC, false)};
    gh_farm_counts counts;
    record *r = run(ctx, &setup, &counts);
    setup.resident = 1; /* one RVE for two packings */
    record *other = run(ctx, &setup, &counts);
    same(r, other);
    for (int k = 0; k < POINTS; k++) {
      gh_rve *rve;
      double F[4], P[4], A[16];
      OK(gh_rve_create(ctx, p[of[k]], &setup.rve, &rve));
      for (int s = 0; s < STEPS; s++) {
        deform(k, s, F);
        OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
        assert_memory_equal(P, r->P[s][k], sizeof P);
        assert_memory_equal(A, r->A[s][k], sizeof A);
        OK(gh_rve_commit(rve));
      }
      gh_rve_destroy(&rve);
      assert_int_equal(r->nx[k], p[of[k]]->n);
    }
    free(r);
    free(other);
  }
  gh_farm *farm;
  gh_farm_setup bad = {.n = POINTS,
                       .npackings = 1,
                       .packings = (const gh_packing *const *)p,
                       .packing_of = of,
                       .rve = law(GH_ENGINE_NATIVE, GH_TAYLOR, false)};
  FAILS(gh_farm_create_shared(ctx, &bad, &farm), GH_INPUT,
        "integration point 0: there is no packing 1 among 1");
  bad.packing_of = NULL;
  bad.rve.tolerance = 2;
  FAILS(gh_farm_create_shared(ctx, &bad, &farm), GH_INPUT, "tolerance");
  assert_null(farm);
  gh_packing_destroy(&p[0]);
  gh_packing_destroy(&p[1]);
}

/* A farm that is read back continues as the one that was saved, shared or not. */
static void an_image_goes_on(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  FOR_ENGINES(e)
  for (int kind = 0; kind < KINDS; kind++) {
    gh_farm_setup setup = {.n = POINTS,
                           .npackings = 1,
                           .packings = (const gh_packing *const[]){p},
                           .rve = law(e, all_boundaries[kind % 4], kind >= 4)};
    gh_farm *farm;
    gh_farm_image image[STEPS + 1];
    record *whole, *part;
    OK(gh_alloc(ctx, 1, sizeof *whole, &whole));
    OK(gh_alloc(ctx, 1, sizeof *part, &part));
    OK(gh_farm_create_shared(ctx, &setup, &farm));
    for (int s = 0; s < STEPS; s++) {
      OK(gh_farm_save(farm, image + s));
      step(ctx, farm, s, whole);
    }
    OK(gh_farm_save(farm, image + STEPS));
    finish(ctx, farm, whole);
    gh_farm_destroy(&farm);
    assert_int_equal(image[0].nstates, 0);
    assert_int_equal(image[2].nstates, 3);
    assert_int_equal(image[STEPS].nstates, 5);
    for (int from = 0; from < STEPS; from++) {
      memcpy(part, whole, sizeof *part);
      memset(part->P[from], 0, sizeof part->P[from]);
      setup.no_share = from % 2;
      setup.resident = from;
      OK(gh_farm_create_shared(ctx, &setup, &farm));
      OK(gh_farm_load(farm, image + from));
      for (int s = from; s < STEPS; s++) step(ctx, farm, s, part);
      finish(ctx, farm, part);
      same(whole, part);
      gh_farm_destroy(&farm);
    }
    OK(gh_farm_create_shared(ctx, &setup, &farm));
    OK(gh_farm_load(farm, image + STEPS));
    gh_rve_view v;
    OK(gh_farm_look(farm, 5, &v)); /* the converged state itself, at its F */
    NEAR("positions of a state that was read back", distance(v.x, whole->x[5], 2 * v.n), 0, 1e-5);
    image[0].npoints--;
    FAILS(gh_farm_load(farm, image), GH_INPUT, "states of 5 integration points for 6");
    image[1].nwords++;
    FAILS(gh_farm_load(farm, image + 1), GH_INPUT, "measures of");
    image[2].state[3] = 7;
    FAILS(gh_farm_load(farm, image + 2), GH_INPUT, "integration point 3 is in state 7");
    gh_farm_destroy(&farm);
    for (int s = 0; s <= STEPS; s++) gh_farm_image_free(image + s);
    free(whole);
    free(part);
  }
  gh_packing_destroy(&p);
}

/* The first of several failing points is reported, and no point behind it counts; what was converged stays.
 */
static void failures_leave_the_states(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  gh_rve_options o = law(GH_ENGINE_NATIVE, GH_PERIODIC, false);
  double F[4 * POINTS], good[4 * POINTS], P[4 * POINTS], again[4 * POINTS];
  for (int share = 0; share < 2; share++) {
    gh_farm_setup setup = {.n = POINTS,
                           .npackings = 1,
                           .packings = (const gh_packing *const[]){p},
                           .rve = o,
                           .no_share = !share};
    gh_farm *farm;
    gh_farm_counts before, after;
    OK(gh_farm_create_shared(ctx, &setup, &farm));
    for (int k = 0; k < POINTS; k++) deform(k, 3, good + 4 * k);
    OK(gh_farm_evaluate(farm, good, 0, P, NULL));
    gh_farm_count(farm, &before);
    memcpy(F, good, sizeof F);
    F[4 * 3] = F[4 * 5] = -1;
    FAILS(gh_farm_evaluate(farm, F, 0, again, NULL), GH_INPUT, "integration point 3: F = [-1");
    gh_farm_count(farm, &after);
    assert_int_equal(after.evaluations - before.evaluations, 3);
    OK(gh_farm_commit(farm)); /* of nothing: the evaluation failed */
    OK(gh_farm_evaluate(farm, good, 0, again, NULL));
    assert_memory_equal(P, again, sizeof P);
    gh_rve_view v;
    FAILS(gh_farm_look(farm, POINTS, &v), GH_INPUT, "no integration point 6");
    gh_farm_destroy(&farm);
    OK(gh_farm_create_shared(ctx, &setup, &farm));
    FAILS(gh_farm_look(farm, 0, &v), GH_INPUT, "not evaluated yet");
    gh_farm_destroy(&farm);
  }
  gh_packing_destroy(&p);
}

/* ---- the books, with ranks that are only thought of ---- */

enum { N = 40, RANKS = 5, SLOTS = 4 * N, ROUNDS = 200 };

/* What a state stands for: a number made of all F of its history. */
static unsigned long long next_content(unsigned long long content, int packing, double f) {
  unsigned long long seed = content + (unsigned long long)(f * 1e6) + (unsigned long long)packing;
  uniform(&seed);
  return seed;
}

/* Random evaluations, commits, reverts and moves: after each commit every point is in the state of its own
 * history, and no evaluation or move reads a slot that does not hold what it needs. */
static void books_keep_every_history(void **state) {
  gh_context *ctx = *state;
  static unsigned long long slot[RANKS][SLOTS], history[N], trial[N];
  unsigned long long seed = (unsigned long long)time(NULL);
  print_message("seed %llu\n", seed);
  for (int share = 0; share < 2; share++) {
    farm_books b;
    int packing[N];
    double F[4 * N];
    for (int k = 0; k < N; k++) packing[k] = k % 2, history[k] = 0;
    gh_farm_setup setup = {.n = N, .npackings = 2, .packing_of = packing, .no_share = !share};
    OK(farm_books_create(ctx, &setup, RANKS, &b));
    b.balance = false;
    for (int round = 0; round < ROUNDS; round++) {
      for (int k = 0; k < N; k++) {
        for (int i = 0; i < 4; i++) F[4 * k + i] = 1;
        F[4 * k] = round < 20 ? 1 : floor(3 * uniform(&seed));
        if (uniform(&seed) < 0.1) b.home[k] = (int)(RANKS * uniform(&seed));
        trial[k] = next_content(history[k], packing[k], F[4 * k]);
      }
      OK(farm_books_plan(&b, F));
      for (size_t m = 0; m < b.nmoves; m++) {
        const farm_state *from = b.states + b.moves[m].from, *to = b.states + b.moves[m].to;
        slot[to->rank][to->slot] = slot[from->rank][from->slot];
      }
      for (int j = 0; j < b.njobs; j++) {
        const farm_task *t = &b.jobs[j].task;
        int r = b.jobs[j].rank;
        unsigned long long content = t->from == FARM_FRESH ? 0 : slot[r][t->from];
        assert_true(t->to < SLOTS && (content == history[t->point]));
        slot[r][t->to] = next_content(content, t->packing, t->F[0]);
      }
      farm_books_settle(&b);
      for (int k = 0; k < N; k++) {
        const farm_job *job = b.jobs + b.job[k];
        assert_true(slot[job->rank][job->task.to] == trial[k]);
      }
      b.trial = uniform(&seed) < 0.7;
      if (b.trial) memcpy(history, trial, sizeof history);
      farm_books_commit(&b);
      for (int k = 0; k < N; k++) {
        const farm_state *s = b.states + b.state[k];
        assert_true(s->rank == FARM_FRESH ? history[k] == 0 : slot[s->rank][s->slot] == history[k]);
      }
    }
    if (!share) assert_int_equal(b.njobs, N);
    farm_books_clear(&b);
    for (size_t k = 2; k < b.nstates; k++) assert_int_equal(b.states[k].users, 0);
    farm_books_destroy(&b);
  }
}

/* Costs that differ by a factor of ten are spread to within a few percent, and what is even stays. */
static void balance_by_cost(void **state) {
  gh_context *ctx = *state;
  gh_farm_setup setup = {.n = N, .npackings = 1};
  farm_books b;
  double F[4 * N], load[RANKS] = {0}, sum = 0, largest = 0;
  OK(farm_books_create(ctx, &setup, RANKS, &b));
  for (int k = 0; k < 4 * N; k++) F[k] = 1 + 0.01 * (k / 4);
  for (int k = 0; k < N; k++) b.cost[k] = 0.01;
  OK(farm_books_plan(&b, F));
  for (int k = 0; k < N; k++) assert_int_equal(b.home[k], k * RANKS / N);
  for (int k = 0; k < N; k++) sum += b.cost[k] = k < N / RANKS ? 0.1 : 0.01; /* a band on rank 0 */
  OK(farm_books_plan(&b, F));
  for (int j = 0; j < b.njobs; j++) load[b.jobs[j].rank] += b.cost[b.jobs[j].task.point];
  for (int r = 0; r < RANKS; r++) largest = fmax(largest, load[r]);
  assert_true(largest < 1.15 * sum / RANKS); /* 0.23: two dear ones and three cheap ones */
  int homes[N];
  memcpy(homes, b.home, sizeof homes);
  OK(farm_books_plan(&b, F));
  assert_memory_equal(homes, b.home, sizeof homes);
  farm_books_destroy(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(sharing_and_pools_change_no_bit),
                                     TEST(kept_states),
                                     TEST(packings_per_point),
                                     TEST(an_image_goes_on),
                                     TEST(failures_leave_the_states),
                                     TEST(books_keep_every_history),
                                     TEST(balance_by_cost)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
