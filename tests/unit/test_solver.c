/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The linear system of an RVE: blocks of grains against CHOLMOD and KLU on states of packings, what they report
 * of singular and indefinite matrices, and the same bits whatever came before.
 *
 * The linker sends allocations of granhom's own objects to the functions below (--wrap, see the Makefile). */
#include "../help.h"

#include "micro/internal.h"

/* ---- allocations: how many live, and which one fails ---- */

static long live, until_failure = -1;

void *__real_calloc(size_t n, size_t m);
void *__real_realloc(void *p, size_t n);
void __real_free(void *p);
void *__wrap_calloc(size_t n, size_t m);
void *__wrap_realloc(void *p, size_t n);
void __wrap_free(void *p);
static bool allocation_fails(void) {
  return until_failure >= 0 && until_failure-- == 0;
}
void *__wrap_calloc(size_t n, size_t m) {
  void *made = allocation_fails() ? NULL : __real_calloc(n, m);
  live += made != NULL;
  return made;
}
void *__wrap_realloc(void *p, size_t n) {
  void *made = allocation_fails() ? NULL : __real_realloc(p, n);
  live += made && !p;
  return made;
}
void __wrap_free(void *p) {
  live -= p != NULL;
  __real_free(p);
}

/* ---- states of packings ---- */

typedef struct sample {
  const char *name, *packing;
  gh_boundary boundary;
  gh_contact_law law;
  bool unbalanced; /* relaxation stops early: rattlers touch, contacts slide */
} sample;

#define FRICTION .normal_stiffness = 100, .friction = 1, .tangential_stiffness = 50
static const sample samples[] = {
    {"periodic", "p150", GH_PERIODIC, {.normal_stiffness = 100}, false},
    {"periodic, far from balance", "p150d", GH_PERIODIC, {.normal_stiffness = 100}, true},
    {"restricted", "p50", GH_RESTRICTED, {.normal_stiffness = 100}, false},
    {"friction", "p150", GH_PERIODIC, {FRICTION, .friction_coefficient = 0.5}, false},
    {"friction, sliding", "p150", GH_PERIODIC, {FRICTION, .friction_coefficient = 0.02}, true},
    {"friction, restricted", "p50", GH_RESTRICTED, {FRICTION, .friction_coefficient = 0.2}, false},
    {"friction, Taylor", "p50", GH_TAYLOR, {FRICTION, .friction_coefficient = 0.2}, false},
    {"friction, cell of Taylor", "p20", GH_TAYLOR_CELL, {FRICTION, .friction_coefficient = 0.2}, false},
    {"hardening", "p150d", GH_PERIODIC, {FRICTION, .friction_coefficient = 0.1, .hardening = 10}, true},
    {"objective slip",
     "p50",
     GH_PERIODIC,
     {FRICTION, .friction_coefficient = 0.1, .slip = GH_SLIP_OBJECTIVE},
     true},
    {"fixed rotations",
     "p50",
     GH_PERIODIC,
     {FRICTION, .friction_coefficient = 0.2, .fixed_rotations = 1},
     true},
    {"stiff in other units",
     "p50",
     GH_PERIODIC,
     {.normal_stiffness = 1e9, .friction = 1, .tangential_stiffness = 1e8, .friction_coefficient = 0.3},
     false}};
enum { SAMPLES = sizeof samples / sizeof *samples };

/* The state at which the contacts of the RVE are left. */
static gh_rve *sample_rve(gh_context *ctx, const sample *s, const gh_packing *p) {
  static const double F[4] = {0.998, 0.002, 0.0005, 0.999};
  double P[4];
  gh_rve *rve;
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, s->boundary, 0, s->unbalanced ? 1e-2 : 1e-8);
  o.law = s->law;
  OK(gh_rve_create(ctx, p, &o, &rve));
  OK(gh_rve_evaluate(rve, F, 0, P, NULL));
  return rve;
}

static void reference(gh_context *ctx, const gh_rve *rve, gh_solver **s) {
  OK(gh_rve_friction(rve) ? gh_solver_klu(ctx, rve->n, s) : gh_solver_cholmod(ctx, rve->n, s));
}

static void blocks(gh_context *ctx, const gh_rve *rve, gh_solver **s) {
  OK(gh_solver_block(ctx, rve->n, !gh_rve_friction(rve), s));
}

/* The solution for four right-hand sides, as if each was asked for; NULL: not good. */
static const double *solve(gh_context *ctx, gh_solver *s, const gh_solver_input *in, double shift, int ncol) {
  const double *X;
  bool good;
  OK(gh_solver_number(ctx, s, in));
  OK(gh_solver_factor(ctx, s, in, shift, &good));
  if (!good) return NULL;
  unsigned long long seed = 1;
  for (int k = 0; k < ncol * s->n; k++) s->rhs[k] = uniform(&seed) - 0.5;
  OK(gh_solver_solve(ctx, s, ncol, &X));
  return X;
}

/* The same unknowns, the same verdict, and solutions alike to round-off: 1e-12 of their size, or what the
 * condition of the matrix makes of it where that is bad. */
static void compare(gh_context *ctx, const char *name, const gh_rve *rve, double shift, int ncol) {
  const gh_solver_input in = gh_rve_solver_input(rve);
  gh_solver *a, *b;
  reference(ctx, rve, &a);
  blocks(ctx, rve, &b);
  const double *X = solve(ctx, a, &in, shift, ncol), *Y = solve(ctx, b, &in, shift, ncol);
  assert_int_equal(a->n, b->n);
  assert_true(a->n == 0 || !X == !Y);
  for (int i = 0; i < 3 * rve->n; i++) assert_int_equal(a->unknown[i], b->unknown[i]);
  if (X && a->n > 0) {
    double size = norm(X, ncol * a->n), condition = size * rve->options.law.normal_stiffness;
    NEAR(name, distance(X, Y, ncol * a->n) / size, 0, 1e-12 * fmax(1, 1e-6 * condition));
  }
  assert_int_equal(b->fallbacks, 0);
  gh_solver_destroy(&a);
  gh_solver_destroy(&b);
}

static void compare_all(gh_context *ctx, const char *name, const gh_rve *rve) {
  static const double shifts[] = {0, 1e-6, 1e-2};
  for (int k = 0; k < 3; k++)
    for (int ncol = 1; ncol <= 4; ncol++)
      compare(ctx, name, rve, shifts[k] * rve->options.law.normal_stiffness, ncol);
}

static void others_agree(void **state) {
  gh_context *ctx = *state;
  for (int k = 0; k < SAMPLES; k++) {
    gh_packing *p = case_packing(ctx, samples[k].packing);
    gh_rve *rve = sample_rve(ctx, &samples[k], p);
    if (k == 0) assert_true(gh_rve_measure(rve)->rattlers > 0);
    if (k == 4) assert_true(gh_rve_measure(rve)->sliding > 50);
    compare_all(ctx, samples[k].name, rve);
    gh_rve_destroy(&rve);
    gh_packing_destroy(&p);
  }
}

/* Four grains in a narrow cell touch their own images, and each other through several. */
static void own_images(void **state) {
  gh_context *ctx = *state;
  static const double cell[4] = {1.95, 0, 0, 6.64}, radius[] = {1, 1, 1, 1},
                      x[] = {0, 0, 0.97, 1.67, 0.02, 3.34, 0.98, 4.98};
  for (int n = 1; n <= 4; n += 3)
    for (int k = 0; k < SAMPLES; k++) {
      if (samples[k].boundary != GH_PERIODIC) continue;
      const double own[4] = {1.95, 0, 0, 1.94}; /* one grain: nothing but its rotation is unknown */
      gh_packing *p = make_packing(ctx, n, n == 1 ? own : cell, radius, x);
      gh_rve *rve = sample_rve(ctx, &samples[k], p);
      int images = 0;
      for (int c = 0; c < rve->list.count; c++) images += rve->list.contacts[c].i == rve->list.contacts[c].j;
      assert_true(images >= n);
      compare_all(ctx, samples[k].name, rve);
      gh_rve_destroy(&rve);
      gh_packing_destroy(&p);
    }
}

/* Without friction a negative stiffness of one contact makes the matrix indefinite, and a grain with one
 * contact makes it singular: neither is good, and a shift mends the second. */
static void not_definite(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p50");
  gh_rve *rve = sample_rve(ctx, &samples[0], p);
  gh_solver *s;
  blocks(ctx, rve, &s);
  gh_contact *contacts;
  gh_contact_list list = rve->list;
  gh_solver_input in = gh_rve_solver_input(rve);
  in.list = &list;
  OK(gh_alloc(ctx, (size_t)list.count, sizeof *contacts, &contacts));
  memcpy(contacts, list.contacts, (size_t)list.count * sizeof *contacts);
  list.contacts = contacts;
  assert_non_null(solve(ctx, s, &in, 0, 1));
  for (int k = 0; k < 3; k++) contacts[9].h[k] *= -20;
  assert_null(solve(ctx, s, &in, 0, 1));
  assert_int_equal(s->negative, -1);
  contacts[9] = rve->list.contacts[9];
  int grain = contacts[9].i, only = -1; /* one contact is left of those of this grain */
  for (int c = 0; c < list.count; c++) {
    if (contacts[c].i != grain && contacts[c].j != grain) continue;
    if (only < 0 && !in.rattler[contacts[c].i] && !in.rattler[contacts[c].j]) only = c;
    else memset(contacts[c].h, 0, sizeof contacts[c].h);
  }
  double *h = contacts[only].h; /* along its normal alone */
  const double *l = contacts[only].l;
  h[0] = l[0] * l[0], h[1] = l[0] * l[1], h[2] = l[1] * l[1];
  assert_null(solve(ctx, s, &in, 0, 1));
  assert_non_null(solve(ctx, s, &in, 1e-3, 1));
  assert_int_equal(s->fallbacks, 0);
  contacts[0].h[1] = NAN;
  bool good;
  OK(gh_solver_number(ctx, s, &in));
  FAILS(gh_solver_factor(ctx, s, &in, 0, &good), GH_DIVERGED, "not finite");
  free(contacts);
  gh_solver_destroy(&s);
  gh_rve_destroy(&rve);
  gh_packing_destroy(&p);
}

/* Two grains, and a third that is left out and gives them stiffness of their own: K = E (e 1; 1 e), with -1 for
 * positions. */
typedef struct pair {
  gh_contact contacts[3];
  gh_friction friction[3];
  gh_contact_list list;
  double radius[3];
  unsigned char rattler[3];
  gh_solver_input in;
} pair;

static void make_pair(pair *p, double E, double e) {
  *p = (pair){.rattler = {0, 0, 1}, .radius = {1, 0.5, 2}};
  static const int ends[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int c = 0; c < 3; c++) {
    p->contacts[c] = (gh_contact){.i = ends[c][0], .j = ends[c][1]};
    for (int k = 0; k < 9; k += 4) p->friction[c].d[k] = c == 0 ? E : E * (e - 1);
  }
  p->list = (gh_contact_list){.count = 3, .contacts = p->contacts, .friction = p->friction};
  p->in = (gh_solver_input){.rattler = p->rattler, .turns = true, .radius = p->radius, .list = &p->list};
}

/* Where the grains alone have no stiffness, or next to none, rows of two grains must be exchanged: KLU does. A
 * matrix that is singular is not asked of it. */
static void what_needs_exchanges(void **state) {
  gh_context *ctx = *state;
  pair p;
  gh_solver *s;
  OK(gh_solver_block(ctx, 3, false, &s));
  static const double own[] = {0, 1e-17, 3.3e-7, 0.3, 1};
  static const int fallbacks[] = {1, 1, 1, 0, 0}, negative[] = {-1, -1, 1, 1, -1};
  for (int k = 0; k < 5; k++) {
    const double E = 0.7, e = own[k], sign[3] = {-1, -1, 1};
    const long before = s->fallbacks;
    make_pair(&p, E, e);
    const double *X = solve(ctx, s, &p.in, 0, 4);
    assert_int_equal(s->fallbacks - before, fallbacks[k]);
    assert_int_equal(s->negative, negative[k]);
    assert_int_equal(X != NULL, k < 4);
    assert_int_equal(s->n, 6);
    for (int c = 0; X && c < 4; c++)
      for (int h = 0; h < 3; h++) { /* (e s; s e)^-1 (a, b) = (e a - s b, e b - s a) / (e^2 - 1) */
        const double *x = X + 6 * c + h, *y = s->rhs + 6 * c + h;
        const double r[2] = {1, h == 2 ? 0.5 : 1}, a = y[0] / r[0] / E, b = y[3] / r[1] / E;
        NEAR("first", x[0] * r[0], (e * a - sign[h] * b) / (e * e - 1), 1e-14);
        NEAR("second", x[3] * r[1], (e * b - sign[h] * a) / (e * e - 1), 1e-14);
      }
  }
  gh_solver_destroy(&s);
}

/* A solver that has seen other graphs, sizes, shifts and sizes of blocks gives the bits of a new one. */
static void what_came_before_does_not_matter(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p150");
  for (int friction = 0; friction < 2; friction++) {
    gh_rve *rve = sample_rve(ctx, &samples[friction ? 4 : 0], p);
    const double shift = 1e-6 * rve->options.law.normal_stiffness;
    gh_contact_list list = rve->list;
    gh_solver_input in = gh_rve_solver_input(rve);
    gh_solver *used, *fresh;
    in.list = &list;
    blocks(ctx, rve, &used);
    for (int round = 0; round < 12; round++) {
      list.count = rve->list.count - 7 * ((5 * round) % 4) * (round != 11);
      in.turns = friction && round % 3 != 1;
      blocks(ctx, rve, &fresh);
      solve(ctx, used, &in, 0, 1);
      const double *X = solve(ctx, used, &in, shift, 4), *Y = solve(ctx, fresh, &in, shift, 4);
      assert_int_equal(X != NULL, Y != NULL);
      if (X) assert_memory_equal(X, Y, 4 * (size_t)used->n * sizeof *X);
      assert_int_equal(used->negative, fresh->negative);
      gh_solver_destroy(&fresh);
    }
    gh_solver_destroy(&used);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

/* Every allocation fails once: GH_MEMORY, nothing is lost, and the next attempt succeeds. */
static void allocations_fail(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20");
  for (int kind = 0; kind < 3; kind++) { /* without and with friction, and with the fall-back */
    gh_rve *rve = sample_rve(ctx, &samples[kind == 0 ? 0 : 3], p);
    gh_solver_input in = gh_rve_solver_input(rve);
    pair two;
    make_pair(&two, 1, 0);
    if (kind == 2) in = two.in;
    const long before = live;
    int failures = 0;
    for (bool done = false; !done; failures++) {
      gh_solver *s;
      const double *X;
      bool good;
      until_failure = failures;
      gh_status status = gh_solver_block(ctx, kind == 2 ? 3 : rve->n, kind == 0, &s);
      if (status == GH_OK) status = gh_solver_number(ctx, s, &in);
      if (status == GH_OK) status = gh_solver_factor(ctx, s, &in, kind == 1 ? 1 : 0, &good);
      if (status == GH_OK) status = gh_solver_solve(ctx, s, 4, &X);
      done = until_failure >= 0;
      until_failure = -1;
      assert_int_equal(status, done ? GH_OK : GH_MEMORY);
      if (s && !done) assert_non_null(solve(ctx, s, &in, 1e-3, 4));
      gh_solver_destroy(&s);
      assert_int_equal(live, before);
    }
    assert_true(failures > 20);
    gh_rve_destroy(&rve);
  }
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(others_agree),
                                     TEST(own_images),
                                     TEST(not_definite),
                                     TEST(what_needs_exchanges),
                                     TEST(what_came_before_does_not_matter),
                                     TEST(allocations_fail)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
