/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Known limits of a granulate: overlaps and volume fractions of lattices in closed form, each limit from just
 * below and just above. */
#include "../help.h"

#include "granhom/limits.h"

static const double square[4] = {1, 0, 0, 1}, hexagonal[4] = {1, 0.5, 0, 0.86602540378443864676};

/* One disk of diameter 1 in a cell where it touches its images: contacts of overlap 1 - f at F = f I. */
static gh_rve_measures lattice(gh_context *ctx, const double cell[4], gh_boundary b, const double F[4]) {
  const double radius[1] = {0.5}, x[2] = {0, 0};
  double P[4];
  gh_packing *p = make_packing(ctx, 1, cell, radius, x);
  gh_rve *rve = make_rve(ctx, p, GH_ENGINE_NATIVE, b, 100, 1e-10);
  OK(gh_rve_evaluate(rve, F, 0, P, NULL));
  gh_rve_measures m = *gh_rve_measure(rve);
  gh_rve_destroy(&rve);
  gh_packing_destroy(&p);
  return m;
}

static gh_rve_measures lattice_by(gh_context *ctx, const double cell[4], gh_boundary b, double f) {
  return lattice(ctx, cell, b, (const double[4]){f, 0, 0, f});
}

static void overlaps_of_lattices(void **state) {
  gh_context *ctx = *state;
  for (int k = 0; k < 2; k++) {
    gh_rve_measures m = lattice_by(ctx, square, k ? GH_TAYLOR_CELL : GH_PERIODIC, 0.95);
    NEAR("m.overlap", m.overlap, 0.1, 1e-12);
    NEAR("m.volume_fraction", m.volume_fraction, help_pi / 4 / 0.9025, 1e-12);
    assert_int_equal(m.engulfed, 0);
    m = lattice_by(ctx, hexagonal, k ? GH_TAYLOR_CELL : GH_PERIODIC, 0.92);
    NEAR("m.overlap", m.overlap, 0.16, 1e-12);
    NEAR("m.volume_fraction", m.volume_fraction, help_pi / sqrt(12) / 0.8464, 1e-12);
  }
}

/* What is checked of m: the words of the refusal, or NULL; whether it is warned of. */
static void checked(gh_context *ctx, gh_boundary b, double allowed, gh_rve_measures m, const char *words,
                    bool warns) {
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, b, 100, 1e-10);
  bool warned = false;
  o.allow_overlap = allowed;
  if (words) FAILS(gh_limits_check(ctx, &o, &m, "here", &warned), GH_LIMIT, words);
  else OK(gh_limits_check(ctx, &o, &m, "here", &warned));
  assert_true(warned == (warns && !words));
  const gh_limits l = gh_limits_of(&o);
  assert_true(gh_limits_hold(&l, &m) == !words);
}

static void overlaps_are_limited(void **state) {
  gh_context *ctx = *state;
  for (const gh_boundary *b = all_boundaries; b < all_boundaries + 4; b++) {
    gh_boundary cell = *b == GH_PERIODIC ? GH_PERIODIC : GH_TAYLOR_CELL;
    checked(ctx, *b, 0, lattice_by(ctx, square, cell, 0.9755), NULL, false); /* 0.049 */
    checked(ctx, *b, 0, lattice_by(ctx, square, cell, 0.9745), NULL, true);  /* 0.051 */
    checked(ctx, *b, 0, lattice_by(ctx, square, cell, 0.9005), NULL, true);  /* 0.199 */
    checked(ctx, *b, 0, lattice_by(ctx, square, cell, 0.8995), "mean overlap over the mean radius is 0.201",
            true);
    checked(ctx, *b, INFINITY, lattice_by(ctx, square, cell, 0.6), NULL, false);
    checked(ctx, *b, 0.3, lattice_by(ctx, square, cell, 0.8505), NULL, false);
    checked(ctx, *b, 0.3, lattice_by(ctx, square, cell, 0.8495), "above the limit 0.3,", true);
    checked(ctx, *b, 0.02, lattice_by(ctx, square, cell, 0.9895), "above the limit 0.02,", true);
  }
}

/* Shear without compression: where all grains follow F, an overlap of 0.3 at a volume fraction of 0.77. */
static void a_shear_is_not_limited(void **state) {
  gh_context *ctx = *state;
  gh_rve_measures m = lattice(ctx, square, GH_TAYLOR_CELL, (const double[4]){0.85, 0, 0, 1.2});
  NEAR("m.overlap", m.overlap, 0.3, 1e-12);
  checked(ctx, GH_TAYLOR, 0, m, NULL, true);
  checked(ctx, GH_TAYLOR_CELL, 0, m, NULL, true);
  checked(ctx, GH_RESTRICTED, 0, m, "mean overlap", true);
  checked(ctx, GH_PERIODIC, 0, m, "mean overlap", true);
}

static void volume_fractions_are_limited(void **state) {
  gh_context *ctx = *state;
  for (const gh_boundary *b = all_boundaries; b < all_boundaries + 4; b++) {
    checked(ctx, *b, 0, lattice_by(ctx, hexagonal, GH_TAYLOR_CELL, 0.926), NULL, true); /* 0.148; 1.058 */
    checked(ctx, *b, 0, lattice_by(ctx, hexagonal, GH_TAYLOR_CELL, 0.924),
            "volume fraction is 1.062, above the limit 1,", true);
    checked(ctx, *b, 0, (gh_rve_measures){.overlap = 0.1, .volume_fraction = 1.209}, NULL, true);
    checked(ctx, *b, 0, (gh_rve_measures){.overlap = 0, .volume_fraction = 1.21}, "above the limit 1.209",
            false);
    checked(ctx, *b, 0, (gh_rve_measures){.overlap = 0.01, .volume_fraction = NAN}, "volume fraction", false);
    checked(ctx, *b, 0, (gh_rve_measures){.overlap = NAN, .volume_fraction = 0.95}, "mean overlap", false);
  }
}

static void engulfed_grains_are_limited(void **state) {
  gh_context *ctx = *state;
  const gh_rve_measures m = {.overlap = 0.01, .volume_fraction = 0.8, .engulfed = 1};
  checked(ctx, GH_PERIODIC, 0, m, "contacts with an overlap above the smaller radius is 1", false);
  checked(ctx, GH_RESTRICTED, 0, m, "contacts with an overlap above the smaller radius is 1", false);
  checked(ctx, GH_TAYLOR, 0, m, NULL, false);
  checked(ctx, GH_PERIODIC, INFINITY, m, NULL, false);
}

static void stress_checked(gh_context *ctx, double compression, gh_stress_kind kind, const char *words,
                           bool warns) {
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, 100, 1e-10);
  bool warned = false;
  gh_status s = gh_limits_check_stress(ctx, &o, "f:1", "the stress", compression, kind, &warned);
  if (words) FAILS(s, GH_INPUT, words);
  else OK(s);
  assert_true(warned == warns);
}

static void stresses_are_limited(void **state) {
  gh_context *ctx = *state;
  stress_checked(ctx, 0, GH_STRESS_NORMAL, NULL, false);
  stress_checked(ctx, 4.99, GH_STRESS_NORMAL, NULL, false);
  stress_checked(ctx, 5.01, GH_STRESS_NORMAL, NULL, true);
  stress_checked(ctx, 49.9, GH_STRESS_NORMAL, NULL, true);
  stress_checked(ctx, 50.1, GH_STRESS_NORMAL, "above the limit 0.5", false);
  stress_checked(ctx, -1e-3, GH_STRESS_NORMAL, "tension of 0.001", false);
  stress_checked(ctx, NAN, GH_STRESS_NORMAL, "above the limit", false);
  stress_checked(ctx, -4.99, GH_STRESS_SIGNLESS, NULL, false);
  stress_checked(ctx, -50.1, GH_STRESS_SIGNLESS, "above the limit 0.5", false);
  stress_checked(ctx, 5000, GH_STRESS_LOAD, NULL, true);
}

static void volumes_are_limited(void **state) {
  gh_context *ctx = *state;
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, 100, 1e-10);
  OK(gh_limits_check_volume(ctx, &o, "f:1", "volume", 0.561, 0.84));
  FAILS(gh_limits_check_volume(ctx, &o, "f:1", "volume", 0.559, 0.84), GH_INPUT, "no packing can follow");
  OK(gh_limits_check_volume(ctx, &o, "f:1", "volume", 99, 0.84));
  FAILS(gh_limits_check_volume(ctx, &o, "f:1", "volume", 101, 0.84), GH_INPUT, "above the limit 100");
  FAILS(gh_limits_check_volume(ctx, &o, "f:1", "volume", NAN, 0.84), GH_INPUT, "must be positive");
  FAILS(gh_limits_check_F(ctx, &o, "f:1", (const double[4]){0, 0.1, 0.1, 0}, 0.84), GH_INPUT,
        "F = 1 is undeformed");
}

static void note_line(void *data, gh_level level, const char *line) {
  if (level == GH_LEVEL_WARNING) snprintf(data, 512, "%s", line);
}

/* n equal disks side by side in a square cell of size 1, each `gap` diameters from the next. */
static void packing_checked(gh_context *ctx, gh_boundary b, int n, double fraction, double gap,
                            const double det[2], const char *words, const char *warning) {
  enum { MOST = 16 };
  static const double one[4] = {1, 0, 0, 1};
  double radius[MOST], x[2 * MOST];
  const double r = sqrt(fraction / (n * help_pi));
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, b, 100, 1e-10);
  char last[512] = "";
  bool warned = false;
  assert_true(n <= MOST);
  for (int i = 0; i < n; i++) radius[i] = r, x[2 * i] = 2 * r * (1 + gap) * i, x[2 * i + 1] = 0;
  gh_packing *p = make_packing(ctx, n, one, radius, x);
  gh_set_log(ctx, note_line, last);
  gh_status s = gh_limits_check_packing(ctx, &o, "f", p, det[0], det[1], &warned);
  gh_set_log(ctx, NULL, NULL);
  if (words) FAILS(s, GH_INPUT, words);
  else OK(s);
  assert_int_equal(warned, warning != NULL);
  if (warning) assert_non_null(strstr(last, warning));
  gh_packing_destroy(&p);
}

/* A packing as read: what it fills of the cell, whether its grains touch. */
static void packings_are_limited(void **state) {
  gh_context *ctx = *state;
  static const double none[2] = {1, 1}, compression[2] = {0.25, 1}, expansion[2] = {1, 4};
  for (const gh_boundary *b = all_boundaries; b < all_boundaries + 4; b++) {
    packing_checked(ctx, *b, 1, 0.78, 0, none, NULL, NULL);
    packing_checked(ctx, *b, 2, 0.0101, 0.01, none, NULL, "f: the grains fill 0.0101 of the cell, and none");
    packing_checked(ctx, *b, 2, 0.0099, 0.01, none, "f: the grains fill 0.0099 of the cell, below the", NULL);
    packing_checked(ctx, *b, 2, 0.0099, 0.01, expansion, "below the limit 0.01", NULL);
    packing_checked(ctx, *b, 2, 0.0099, 0.01, compression, NULL, "none touch");
    packing_checked(ctx, *b, 2, 0.0099, -0.01, none, NULL, NULL); /* two that touch */
    packing_checked(ctx, *b, 9, 1e-6, -0.01, none, NULL, NULL);
    packing_checked(ctx, *b, 10, 1e-6, -0.01, none, "below the limit 0.01", NULL);
    packing_checked(ctx, *b, 1, 0.499, 0, none, NULL, "none touch");
    packing_checked(ctx, *b, 1, 0.501, 0, none, NULL, NULL);
    packing_checked(ctx, *b, 1, 1.49, 0, none, NULL, NULL);
    packing_checked(ctx, *b, 1, 1.51, 0, none, "the grains fill 1.51 of the cell, above the limit 1.5", NULL);
    packing_checked(ctx, *b, 1, 1.6, 0, expansion, NULL, NULL);
    packing_checked(ctx, *b, 1, 6.1, 0, expansion, "above the limit 1.5", NULL);
    packing_checked(ctx, *b, 1, 1.51, 0, compression, "above the limit 1.5", NULL);
  }
  packing_checked(ctx, GH_PERIODIC, 3, 0.3, -0.49, none, NULL, NULL);
  packing_checked(ctx, GH_PERIODIC, 3, 0.3, -0.51, none, NULL,
                  "of 3 contacts as read 2 have an overlap above");
  packing_checked(ctx, GH_TAYLOR, 3, 0.3, -0.51, none, NULL, NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(overlaps_of_lattices),        TEST(overlaps_are_limited),
                                     TEST(a_shear_is_not_limited),      TEST(volume_fractions_are_limited),
                                     TEST(engulfed_grains_are_limited), TEST(stresses_are_limited),
                                     TEST(volumes_are_limited),         TEST(packings_are_limited)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
