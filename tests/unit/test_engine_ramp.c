/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Ramps of both engines where all grains are fixed: against increments of the whole law. */
#include "ramp_help.h"
#include "slips_help.h"

/* The history after an increment: of its contacts, and the hardening of those that have opened. */
static void advance_history(sample *s, const gh_contact_list *list) {
  static gh_slip next[MOST_SLIPS];
  int count = 0, old = 0;
  for (int c = 0; c <= list->count; c++) {
    const gh_slip *now = c < list->count ? &list->friction[c].slip : NULL;
    for (; old < s->nslips && (!now || order(&s->slips[old], now) < 0); old++) {
      if (s->slips[old].alpha == 0) continue;
      next[count] = s->slips[old];
      next[count].gamma = next[count].gamma_pl = 0;
      count++;
    }
    if (!now) break;
    if (old < s->nslips && order(&s->slips[old], now) == 0) old++;
    if (now->gamma != 0 || now->gamma_pl != 0 || now->alpha != 0) next[count++] = *now;
    assert_in_range(count, 0, MOST_SLIPS - 1);
  }
  memcpy(s->slips, next, (size_t)count * sizeof *next);
  s->nslips = count;
}

/* A random packing that overlaps, in a cell that is turned, tilted up to twice its width, with grains kept in
 * other cells, and with a history of the contacts that it has. Nothing rotates by itself. */
static void draw(gh_context *ctx, unsigned long long *seed, int trial, sample *s) {
  const int n = trial % 3 ? trial % 3 + trial % 2 : 30;
  const double largest = trial % 3 ? 0.5 : 0.13, tilt = trial % 4 ? 0.5 : 4,
               T[4] = {0.6 + uniform(seed), tilt * (uniform(seed) - 0.5), 0, 0.6 + uniform(seed)};
  double Q[4];
  *s = (sample){.n = n, .periodic = trial % 7 != 6};
  s->law = (gh_contact_law){.normal_stiffness = E,
                            .friction = 1,
                            .tangential_stiffness = 80,
                            .friction_coefficient = 0.5 * uniform(seed),
                            .hardening = trial & 1 ? 30 * uniform(seed) : 0,
                            .slip = trial & 2 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED,
                            .fixed_rotations = 1,
                            .hardening_law = trial & 8 ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED};
  rotation(6 * uniform(seed), Q);
  gh_mul2(Q, T, s->cell);
  memset(s->held, 1, sizeof s->held);
  for (int i = 0; i < n; i++) {
    double f[2] = {uniform(seed), uniform(seed)};
    for (int k = 0; k < 2 && s->periodic; k++) f[k] = 6 * f[k] - 3;
    s->radius[i] = largest * (0.3 + 0.7 * uniform(seed));
    s->theta[i] = uniform(seed);
    gh_apply2(s->cell, f, &s->x[2 * i]);
  }
  gh_contact_list list;
  gh_engine *g = make_engine(ctx, s, GH_ENGINE_NATIVE);
  put(ctx, g, s);
  OK(gh_engine_contacts(g, &list));
  s->nslips = draw_slips(seed, &list, largest, MOST_SLIPS, s->slips);
  for (int c = 0; c < s->nslips && !(trial & 1); c++) s->slips[c].alpha = 0;
  gh_engine_destroy(&g);
}

static double dissipated_in(const gh_contact_list *list) {
  double sum = 0;
  for (int c = 0; c < list->count; c++) sum += list->friction[c].dissipated;
  return sum;
}

static double stored_in(const gh_contact_list *list) {
  double sum = 0;
  for (int c = 0; c < list->count; c++) sum += list->contacts[c].energy + list->friction[c].energy;
  return sum;
}

/* The ramp as increments of the whole law, from `s`, which becomes the state at its end; its last list of
 * contacts belongs to `g`. Returns what is dissipated. */
static double by_increments(gh_context *ctx, gh_engine *g, const double to[4], long steps, sample *s,
                            gh_contact_list *list) {
  static sample start;
  double sum = 0;
  start = *s;
  for (long k = 0; k <= steps + 1; k++) { /* the last one is that of the state as it is */
    double G[4];
    gh_converged n = {.x = s->x, .theta = s->theta, .slips = s->slips, .nslips = s->nslips};
    memcpy(n.cell, s->cell, sizeof n.cell);
    OK(gh_engine_begin(g, &n));
    part_of(to, fmin(1, (double)k / (double)steps), G);
    gh_mul2(G, start.cell, s->cell);
    for (int i = 0; i < s->n; i++) gh_apply2(G, &start.x[2 * i], &s->x[2 * i]);
    OK(gh_engine_set(g, s->cell, s->x, s->theta));
    OK(gh_engine_contacts(g, list));
    sum += dissipated_in(list);
    advance_history(s, list);
  }
  return sum;
}

static void assert_same_contacts(const gh_contact_list *a, const gh_contact_list *b, int n,
                                 double tolerance) {
  assert_int_equal(a->count, b->count);
  for (int c = 0; c < a->count; c++) {
    assert_int_equal(order(&a->friction[c].slip, &b->friction[c].slip), 0);
    NEAR("force", distance(a->contacts[c].f, b->contacts[c].f, 2), 0, E * tolerance);
    NEAR("branch", distance(a->contacts[c].l, b->contacts[c].l, 2), 0, tolerance);
    NEAR("couple", a->friction[c].couple, b->friction[c].couple, E * tolerance);
  }
  NEAR("forces", distance(a->force, b->force, 2 * n), 0, 10 * E * tolerance);
  NEAR("moments", distance(a->moment, b->moment, n), 0, 10 * E * tolerance);
}

/* Where all grains are fixed a ramp is m increments of the whole law: contacts open, form and slide on the
 * way, lists are made again, cells tilt; hardening of contacts that have opened stays, and comes back with
 * them. Then the engine continues from there. Lengths are about 1. */
static void ramps_are_increments(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 51;
  static sample s, reached;
  int contacts = 0, apart = 0;
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < 84; trial++) {
    draw(ctx, &seed, trial, &s);
    double to[4], back[4];
    for (int k = 0; k < 4; k++) to[k] = (k % 3 ? 0 : 1) + 0.25 * (uniform(&seed) - 0.5);
    gh_inv2(to, back);
    gh_engine *whole = make_engine(ctx, &s, GH_ENGINE_NATIVE);
    gh_contact_list list, expected;
    reached = s;
    double there = by_increments(ctx, whole, to, 24, &reached, &expected);
    for (int m = 0; m < ENGINES; m++) {
      if (!use_engine(KINDS[m])) continue;
      gh_ramp_result r;
      double x[2 * MOST], theta[MOST];
      gh_ramp o = ramp_to(to, 24, 1e-9);
      gh_engine *g = make_engine(ctx, &s, KINDS[m]);
      put(ctx, g, &s);
      OK(gh_engine_ramp(g, &o, &r));
      assert_true(r.done == 24 && r.relaxed.steps >= 25);
      assert_true(expected.count == 0 || r.relaxed.converged);
      assert_same_slips(r.slips, r.nslips, reached.slips, reached.nslips, 2e-12);
      NEAR("dissipated", r.dissipated, there, 1e-12 * (1 + fabs(there)));
      OK(gh_engine_get(g, x, theta));
      NEAR("positions", distance(x, reached.x, 2 * s.n), 0, 1e-12);
      NEAR("rotations", distance(theta, s.theta, s.n), 0, 0);
      OK(gh_engine_contacts(g, &list));
      assert_same_contacts(&list, &expected, s.n, 2e-12);
      NEAR("nothing left to dissipate", dissipated_in(&list), 0, 1e-11);
      for (int c = 0; c < r.nslips; c++) apart += r.slips[c].gamma == 0 && r.slips[c].alpha != 0;
      contacts += list.count;
      gh_engine_destroy(&g);
    }
    gh_engine_destroy(&whole);
  }
  print_message("%d contacts, %d apart with hardening\n", contacts, apart);
  assert_true(contacts > 1000 && apart > 100);
}

/* Two large grains that are not on the first list, among small ones that are, touch before these would have
 * made a new list. */
static void large_grains_come_together(void **state) {
  gh_context *ctx = *state;
  static sample s, reached;
  const double to[4] = {0.9, 0.1, 0.05, 1};
  s = (sample){.n = 6, .radius = {1, 1, 0.1, 0.1, 0.1, 0.1}};
  s.law = (gh_contact_law){.normal_stiffness = E,
                           .friction = 1,
                           .tangential_stiffness = 80,
                           .friction_coefficient = 0.2,
                           .fixed_rotations = 1};
  memset(s.held, 1, sizeof s.held);
  s.x[2] = 2.1;
  for (int i = 2; i < 6; i++) s.x[2 * i] = 0.19 * i, s.x[2 * i + 1] = 3;
  for (int m = 0; m < ENGINES; m++) {
    if (!use_engine(KINDS[m])) continue;
    gh_ramp_result r;
    gh_contact_list list;
    const gh_ramp o = ramp_to(to, 40, 1e-9);
    gh_engine *g = make_engine(ctx, &s, KINDS[m]);
    reached = s;
    const double there = by_increments(ctx, g, to, 40, &reached, &list);
    assert_true(reached.nslips == 4 && reached.slips[0].j == 1 && fabs(reached.slips[0].gamma_pl) > 0.01);
    put(ctx, g, &s);
    OK(gh_engine_ramp(g, &o, &r));
    assert_same_slips(r.slips, r.nslips, reached.slips, reached.nslips, 2e-12);
    NEAR("dissipated", r.dissipated, there, 1e-12);
    gh_engine_destroy(&g);
  }
}

/* A ramp in two calls, where the second continues on the line of the first, is the ramp in one. */
static void ramps_continue(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 52;
  static sample s;
  for (int trial = 0; trial < 12; trial++) {
    const double to[4] = {0.95, 0.06, -0.02, 0.97};
    double half[4], inverse[4], rest[4];
    draw(ctx, &seed, trial, &s);
    part_of(to, 0.5, half);
    gh_inv2(half, inverse);
    gh_mul2(to, inverse, rest);
    for (int m = 0; m < ENGINES; m++) {
      if (!use_engine(KINDS[m])) continue;
      const gh_ramp o[3] = {ramp_to(to, 20, 1e-9), ramp_to(half, 10, 1e-9), ramp_to(rest, 10, 1e-9)};
      gh_engine *one = make_engine(ctx, &s, KINDS[m]), *two = make_engine(ctx, &s, KINDS[m]);
      gh_ramp_result r, first, second;
      put(ctx, one, &s);
      put(ctx, two, &s);
      OK(gh_engine_ramp(one, &o[0], &r));
      OK(gh_engine_ramp(two, &o[1], &first));
      const double before = first.dissipated;
      OK(gh_engine_ramp(two, &o[2], &second));
      NEAR("dissipated", before + second.dissipated, r.dissipated, 1e-12);
      assert_same_slips(second.slips, second.nslips, r.slips, r.nslips, 2e-12);
      gh_engine_destroy(&one);
      gh_engine_destroy(&two);
    }
  }
}

/* Work of the gradient at fixed positions, sum of f.dl with the mean of the forces before and after, is stored
 * or dissipated; the error of n steps, and of contacts that form or open within one, falls with 1/n. */
static void energy_is_stored_or_dissipated(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 53;
  static sample s;
  draw(ctx, &seed, 3, &s);
  s.nslips = 0;
  for (int m = 0; m < ENGINES; m++) {
    double miss[2];
    if (!use_engine(KINDS[m])) continue;
    for (int fine = 0; fine < 2; fine++) {
      const long parts = fine ? 400 : 100;
      const double to[4] = {0.97, 0.06, 0, 1.01};
      double work = 0, dissipated = 0, first = 0, P[2][4] = {{0}}, stored = 0, before[4], G[4];
      gh_engine *g = make_engine(ctx, &s, KINDS[m]);
      put(ctx, g, &s);
      part_of(to, 0, before);
      for (long k = 0; k <= parts; k++) {
        double inverse[4], D[4];
        gh_ramp_result r = {0};
        gh_contact_list list;
        part_of(to, (double)k / (double)parts, G);
        gh_inv2(before, inverse);
        gh_mul2(G, inverse, D);
        const gh_ramp o = ramp_to(D, 1, 1e-9);
        OK(gh_engine_ramp(g, &o, &r));
        dissipated += r.dissipated;
        OK(gh_engine_contacts(g, &list));
        stored = stored_in(&list);
        if (k == 0) first = stored;
        memset(P[k & 1], 0, sizeof P[0]);
        for (int c = 0; c < list.count; c++) { /* f on i, and l_0 = G^-1 l: the work is sum f.dG l_0 */
          double to_start[4], l0[2];
          gh_inv2(G, to_start);
          gh_apply2(to_start, list.contacts[c].l, l0);
          for (int a = 0; a < 4; a++) P[k & 1][a] += list.contacts[c].f[a / 2] * l0[a % 2];
        }
        for (int a = 0; a < 4 && k > 0; a++) work += 0.5 * (P[0][a] + P[1][a]) * (G[a] - before[a]);
        memcpy(before, G, sizeof before);
      }
      miss[fine] = fabs(work - (stored - first + dissipated)) / work;
      print_message("%s: work %g stored %g dissipated %g\n", engine_names[KINDS[m]], work, stored - first,
                    dissipated);
      gh_engine_destroy(&g);
    }
    print_message("miss %g, %g\n", miss[0], miss[1]);
    assert_true(miss[1] < 0.4 * miss[0] && miss[1] < 0.01);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(ramps_are_increments), TEST(large_grains_come_together),
                                     TEST(ramps_continue), TEST(energy_is_stored_or_dissipated)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
