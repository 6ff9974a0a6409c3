/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Ramps of packings: both engines against each other, rigid rotation, wrong input; and the patience of a
 * relaxation. */
#include "ramp_help.h"

/* A reference packing, compressed, so that it is out of equilibrium: damping in the first steps is a quotient
 * of forces, and at rest a quotient of what rounding leaves. Its cell is spanned by the diagonal and the second vector: LAMMPS, which tilts by
 * half the first vector at most, changes the basis on the way. */
static void case_sample(gh_context *ctx, const char *name, double turn, sample *s) {
  gh_packing *p = case_packing(ctx, name);
  double Q[4];
  const double basis[4] = {1, 0, 1, 1}, F[4] = {0.998, 0.002, 0, 0.999};
  *s = (sample){.n = p->n, .periodic = true};
  s->law = (gh_contact_law){
      .normal_stiffness = E, .friction = 1, .tangential_stiffness = E, .friction_coefficient = 0.3};
  assert_in_range(p->n, 1, MOST);
  rotation(turn, Q);
  gh_mul2(Q, F, Q);
  memcpy(s->radius, p->radius, (size_t)p->n * sizeof(double));
  gh_mul2(Q, p->cell, s->cell);
  gh_mul2(s->cell, basis, s->cell);
  for (int i = 0; i < p->n; i++) gh_apply2(Q, &p->x[2 * i], &s->x[2 * i]);
  gh_packing_destroy(&p);
}

/* A body that turns as a whole, a radian in a hundred ramps, slips nowhere where slip is objective: what is
 * tangential is rounding. Grains rotate with it. */
static void rigid_rotation(void **state) {
  gh_context *ctx = *state;
  static sample s;
  double R[4];
  case_sample(ctx, "p20", 0.3, &s);
  s.law.slip = GH_SLIP_OBJECTIVE;
  memset(s.held, 1, sizeof s.held);
  rotation(0.01, R);
  for (int m = 0; m < ENGINES; m++) {
    if (!use_engine(KINDS[m])) continue;
    const gh_ramp o = ramp_to(R, 1, 1e-9);
    gh_ramp_result r;
    gh_contact_list list;
    double x[2 * MOST], theta[MOST], whole[4], slip_force = 0, force = 0;
    gh_engine *g = make_engine(ctx, &s, KINDS[m]);
    put(ctx, g, &s);
    for (int k = 0; k < 100; k++) {
      OK(gh_engine_ramp(g, &o, &r));
      assert_true(r.relaxed.converged && r.relaxed.steps == 2);
      NEAR("dissipated", r.dissipated, 0, 0);
    }
    OK(gh_engine_get(g, x, theta));
    OK(gh_engine_contacts(g, &list));
    rotation(1, whole);
    for (int i = 0; i < s.n; i++) {
      double y[2];
      gh_apply2(whole, &s.x[2 * i], y);
      NEAR("turned", distance(y, &x[2 * i], 2), 0, 1e-13);
      NEAR("rotation", theta[i], 1, 1e-12);
    }
    for (int c = 0; c < list.count; c++) {
      slip_force = fmax(slip_force, fabs(list.friction[c].force));
      force = fmax(force, E * list.contacts[c].overlap);
    }
    print_message("%s: slip force %g of %g\n", engine_names[KINDS[m]], slip_force, force);
    assert_true(force > 0 && slip_force <= 1e-9 * force);
    gh_engine_destroy(&g);
  }
}

typedef struct outcome {
  gh_ramp_result r;
  int nslips;
  long lists;
  double x[2 * MOST], theta[MOST];
  gh_slip slips[MOST_SLIPS];
} outcome;

/* After some steps of relaxation towards equilibrium, where there are any. */
static void lead(gh_context *ctx, const sample *s, gh_engine_kind kind, long relaxed, const gh_ramp *o,
                 outcome *out) {
  const gh_relax_options before = {.tolerance = 1e-9, .max_steps = relaxed, .method = GH_RELAX_DAMPED};
  gh_engine_cost cost;
  gh_relax_result r;
  gh_engine *g = make_engine(ctx, s, kind);
  put(ctx, g, s);
  if (relaxed) OK(gh_engine_relax(g, &before, &r));
  gh_engine_costs(g, &cost);
  out->lists = -cost.rebuilds;
  OK(gh_engine_ramp(g, o, &out->r));
  assert_in_range(out->r.nslips, 0, MOST_SLIPS);
  out->nslips = out->r.nslips;
  memcpy(out->slips, out->r.slips, (size_t)out->nslips * sizeof *out->slips);
  OK(gh_engine_get(g, out->x, out->theta));
  gh_engine_costs(g, &cost);
  out->lists += cost.rebuilds;
  gh_engine_destroy(&g);
}

/* Both engines lead the same packing to the same state, in as many steps: compressed and sheared within one
 * list, and so far that lists are made again; periodic, and a cluster about fixed grains. */
static void as_native(void **state) {
  gh_context *ctx = *state;
  static sample s;
  static outcome got[ENGINES];
  static const char *const names[] = {"p20", "p50d", "p150d"};
  const double to[2][4] = {{0.995, 0.01, 0.003, 0.997}, {0.98, 0.09, 0.01, 0.99}};
  for (int k = 0; k < 9; k++) {
    const int far = k / 3 == 1;
    case_sample(ctx, names[k % 3], k % 2 ? 0.3 : 0, &s);
    s.periodic = k < 6;
    s.law.slip = k % 2 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
    s.law.hardening = k % 3 == 1 ? 20 : 0;
    s.law.hardening_law = k == 4 ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
    s.law.fixed_rotations = k == 2;
    for (int i = 0; i < s.n && !s.periodic; i += 4) s.held[i] = 1;
    const gh_ramp o = ramp_to(to[far], far ? 400 : 200, 1e-3);
    for (int m = 0; m < ENGINES; m++) lead(ctx, &s, KINDS[m], k % 3 == 1 ? 15 : 0, &o, &got[m]);
    const outcome *a = &got[0], *b = &got[1];
    print_message("%s: %ld and %ld steps, %ld and %ld lists, x %.1e, dissipated %g\n", names[k % 3],
                  a->r.relaxed.steps, b->r.relaxed.steps, a->lists, b->lists, distance(a->x, b->x, 2 * s.n),
                  a->r.dissipated);
    assert_true(a->r.relaxed.converged && b->r.relaxed.converged);
    assert_int_equal(a->r.relaxed.steps, b->r.relaxed.steps);
    NEAR("positions", distance(a->x, b->x, 2 * s.n), 0, 1e-8);
    NEAR("rotations", distance(a->theta, b->theta, s.n), 0, 1e-7);
    NEAR("dissipated", a->r.dissipated, b->r.dissipated, 1e-7 * a->r.dissipated);
    assert_same_slips(a->slips, a->nslips, b->slips, b->nslips, 1e-8);
    assert_true(a->r.dissipated > 0 && a->nslips > s.n / 2);
    if (far) assert_true(a->lists >= 4 && b->lists >= 4);
  }
}

/* ---- wrong input ---- */

static void wrong_input(void **state) {
  gh_context *ctx = *state;
  static sample s;
  case_sample(ctx, "p20", 0, &s);
  const double ok[4] = {0.999, 0, 0, 1};
  for (int m = 0; m < ENGINES; m++) {
    if (!use_engine(KINDS[m])) continue;
    gh_ramp_result r;
    gh_ramp o = ramp_to(ok, 10, 1e-3);
    gh_engine *g = make_engine(ctx, &s, KINDS[m]);
    FAILS(gh_engine_ramp(g, &o, &r), GH_ENGINE, "converged state");
    put(ctx, g, &s);
    o.max_steps = 10;
    FAILS(gh_engine_ramp(g, &o, &r), GH_INPUT, "10 of 10 steps");
    o = ramp_to((double[4]){-1, 0, 0, 1}, 10, 1e-3);
    FAILS(gh_engine_ramp(g, &o, &r), GH_INPUT, "determinant");
    o = ramp_to((double[4]){1, NAN, 0, 1}, 10, 1e-3);
    FAILS(gh_engine_ramp(g, &o, &r), GH_INPUT, "determinant");
    o = ramp_to((double[4]){-1, 0, 0, -1}, 10, 1e-3); /* on the line of gradients lies 0 */
    FAILS(gh_engine_ramp(g, &o, &r), GH_INPUT, "on the way");
    o = ramp_to((double[4]){0.01, 0, 0, 1}, 10, 1e-3);
    FAILS(gh_engine_ramp(g, &o, &r), GH_INPUT, "compressed too far");
    o = ramp_to(ok, 0, 1e-3);
    FAILS(gh_engine_ramp(g, &o, &r), GH_INPUT, "needs steps");
    o = ramp_to((double[4]){1 + 1e-15, 0, -1e-16, 1}, 0, 1e-3); /* nothing was broken; rounding is no ramp */
    OK(gh_engine_ramp(g, &o, &r));
    assert_true(r.relaxed.converged && r.done == 0);
    gh_engine_destroy(&g);
    s.law = (gh_contact_law){.normal_stiffness = E};
    g = make_engine(ctx, &s, KINDS[m]);
    OK(gh_engine_set(g, s.cell, s.x, NULL));
    o = ramp_to(ok, 10, 1e-3);
    FAILS(gh_engine_ramp(g, &o, &r), GH_ENGINE, "needs friction");
    gh_engine_destroy(&g);
    case_sample(ctx, "p20", 0, &s);
  }
}

/* A relaxation with a patience ends unconverged that many steps after its residual last came to half. */
static void patience(void **state) {
  gh_context *ctx = *state;
  static sample s;
  for (int m = 0; m < ENGINES; m++) {
    if (!use_engine(KINDS[m])) continue;
    gh_relax_result r[2];
    gh_relax_options o = {.max_steps = 20000, .method = GH_RELAX_DAMPED, .patience = 300};
    case_sample(ctx, "p20", 0, &s);
    gh_engine *g = make_engine(ctx, &s, KINDS[m]);
    put(ctx, g, &s);
    OK(gh_engine_relax(g, &o, &r[0])); /* no residual is 0 */
    o.patience = 700;
    put(ctx, g, &s);
    OK(gh_engine_relax(g, &o, &r[1]));
    print_message("%s: %ld and %ld steps\n", engine_names[KINDS[m]], r[0].steps, r[1].steps);
    assert_true(!r[0].converged && !r[1].converged);
    assert_true(r[0].steps >= 301 && r[1].steps >= r[0].steps + 400 && r[1].steps < 20000);
    gh_engine_destroy(&g);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(rigid_rotation), TEST(as_native), TEST(wrong_input),
                                     TEST(patience)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
