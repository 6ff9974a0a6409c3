/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The search for rattlers (Table 4.3) against the angles themselves. */
#include "../help.h"
#include "micro/internal.h"

enum { GRAINS = 60, CONTACTS = 400 };

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Angles of the contacts of grain i that count, ascending; the largest force. */
static int angles_of(int i, const gh_contact *c, int count, const unsigned char *flag, double *angle,
                     double *force) {
  int found = 0;
  *force = 0;
  for (int k = 0; k < count; k++)
    for (int e = 0; e < 2; e++) {
      if ((e ? c[k].j : c[k].i) != i || flag[e ? c[k].i : c[k].j]) continue;
      angle[found++] = atan2(e ? -c[k].l[1] : c[k].l[1], e ? -c[k].l[0] : c[k].l[0]);
      *force = fmax(*force, hypot(c[k].f[0], c[k].f[1]));
    }
  qsort(angle, (size_t)found, sizeof *angle, ascending);
  return found;
}

/* A grain is a rattler whose largest gap is above half a turn, or half a turn without force. */
static bool loose(int i, const gh_contact *c, int count, const unsigned char *flag) {
  double angle[2 * CONTACTS], force, gap;
  const int found = angles_of(i, c, count, flag, angle, &force);
  if (found < 2) return true;
  gap = angle[0] + 2 * help_pi - angle[found - 1];
  for (int k = 1; k < found; k++) gap = fmax(gap, angle[k] - angle[k - 1]);
  return gap > help_pi + 1e-9 || (gap >= help_pi - 1e-9 && force <= 1e-6);
}

static void by_angles(int n, const gh_contact *c, int count, unsigned char *flag) {
  memset(flag, 0, (size_t)n);
  for (bool again = true; again;) {
    again = false;
    for (int i = 0; i < n; i++)
      if (!flag[i] && loose(i, c, count, flag)) flag[i] = 1, again = true;
  }
}

/* Random contacts among few directions, so that many are opposite or the same, or among any. */
static int draw_contacts(unsigned long long *seed, int n, bool few, gh_contact *c) {
  const int count = 3 + (int)(uniform(seed) * 5 * n);
  for (int k = 0; k < count; k++) {
    const double share = uniform(seed), turn = 2 * help_pi * (few ? floor(8 * share) / 8 : share),
                 length = 0.1 + uniform(seed), force = uniform(seed) < 0.3 ? 0 : 1;
    const int i = (int)(uniform(seed) * n), j = (i + 1 + (int)(uniform(seed) * (n - 1))) % n;
    c[k] = (gh_contact){.i = i < j ? i : j,
                        .j = i < j ? j : i,
                        .l = {length * cos(turn), length * sin(turn)},
                        .f = {force * cos(turn), force * sin(turn)}};
  }
  return count;
}

static void rattlers_are_those_of_the_angles(void **state) {
  gh_context *ctx = *state;
  unsigned long long seed = 61;
  int marked = 0, kept = 0;
  gh_rattlers *r;
  OK(gh_rattlers_create(ctx, GRAINS, &r));
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < 3000; trial++) {
    gh_contact c[CONTACTS];
    unsigned char expected[GRAINS];
    int count, n = trial % 10 == 9 ? GRAINS : 4 + trial % 17;
    const int contacts = draw_contacts(&seed, n, trial & 1, c);
    OK(gh_rattlers_find(ctx, r, n, NULL, c, contacts, 1, &count));
    by_angles(n, c, contacts, expected);
    for (int i = 0; i < n; i++)
      if (expected[i] != r->flag[i]) {
        double angle[2 * CONTACTS], force;
        const int found = angles_of(i, c, contacts, expected, angle, &force);
        for (int k = 0; k < found; k++) print_error("%.17g\n", angle[k]);
        fail_msg("trial %d: grain %d is %sa rattler", trial, i, r->flag[i] ? "" : "no ");
      }
    marked += count, kept += n - count;
  }
  print_message("%d rattlers, %d others\n", marked, kept);
  assert_true(marked > 10000 && kept > 10000);
  gh_rattlers_destroy(&r);
}

/* A grain between two others: held by exactly opposite contacts that carry force, by no others, in all
 * directions; by three unless they are in one half-plane. Fixed grains are no rattlers. */
static void two_and_three_contacts(void **state) {
  static const unsigned char held[4] = {0, 1, 1, 1};
  gh_context *ctx = *state;
  gh_rattlers *r;
  OK(gh_rattlers_create(ctx, 4, &r));
  for (int degree = 0; degree < 360; degree++)
    for (int kind = 0; kind < 6; kind++) {
      static const double apart[6] = {180, 180, 179.9999, 180.0001, 0, 1e-4};
      const double turn[3] = {degree * help_pi / 180, (degree + apart[kind]) * help_pi / 180,
                              (degree + 90) * help_pi / 180};
      const double force = kind == 1 ? 0 : 1;
      gh_contact c[3];
      int count;
      for (int k = 0; k < 3; k++)
        c[k] = (gh_contact){.i = 0,
                            .j = k + 1,
                            .l = {cos(turn[k]), sin(turn[k])},
                            .f = {force * cos(turn[k]), force * sin(turn[k])}};
      OK(gh_rattlers_find(ctx, r, 4, held, c, 2, 1, &count));
      assert_int_equal(count, kind == 0 ? 0 : 1);
      OK(gh_rattlers_find(ctx, r, 4, held, c, 3, 1, &count)); /* the largest gap is beside the third */
      assert_int_equal(count, kind == 0 || kind == 3 ? 0 : 1);
    }
  gh_rattlers_destroy(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(rattlers_are_those_of_the_angles), TEST(two_and_three_contacts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
