/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Errors, intervals, fronts and orders of studies whose curves are known. */
#include "study_help.h"

#define VALUES(...)                                                                                          \
  (const char *const[]) {                                                                                    \
    __VA_ARGS__, NULL                                                                                        \
  }

/* ---- Student ---- */

/* The table of any textbook, two-sided 95 %. */
static void test_student(void **state) {
  static const struct {
    int freedom;
    double t, limit;
  } table[] = {{1, 12.7062, 5e-5}, {2, 4.3027, 5e-5},   {3, 3.1824, 5e-5},
               {4, 2.7764, 5e-5},  {9, 2.2622, 5e-5},   {14, 2.1448, 5e-5},
               {29, 2.0452, 5e-5}, {120, 1.9799, 5e-5}, {100000, 1.95996, 5e-5}};
  (void)state;
  for (size_t k = 0; k < sizeof table / sizeof *table; k++)
    NEAR("t", study_student(table[k].freedom), table[k].t, table[k].limit);
  assert_true(isnan(study_student(0)));
}

/* ---- errors ---- */

/* With two degrees of freedom, the quantile is p sqrt(2 / (1 - p^2)). */
static const double student2 = 4.30265272974946;

/* q(t) = t^2 for P11, 0 for P22, 1 for the energy; data: what is added to P11 and to the energy. */
static double parabola(double t, int column, void *data) {
  double add = data ? *(double *)data : 0;
  return column == 0 ? t * t + add : column == 1 ? 0 : 1 + 2 * add;
}

/* t = 0, 1, 2, 3 against t = 0, .5, ..., 3: the norm of the reference over the common t is sqrt(0+1+16+81).
 */
static void test_errors(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  double add = 0.01;
  made_parameter(s, "tolerance", VALUES("1e-2"));
  made_configs(s, 1, 0);
  made_run(s->configs[0].runs, 4, 3, parabola, &add, 1.5, 100);
  made_curve(&s->given, 7, 3, parabola, NULL);
  OK(study_judge(s));
  const study_judged *row = s->verdict->row;
  assert_int_equal(row->points, 4);
  assert_int_equal(row->members, 1);
  NEAR("l2", row->l2[0], sqrt(4 * 1e-4) / sqrt(98), 1e-15);
  NEAR("largest", row->largest[0], 0.01 / 9, 1e-15);
  NEAR("single", row->single[0], row->l2[0], 1e-15);
  NEAR("energy", row->l2[1], 0.02, 1e-15);
  NEAR("core", row->core, 1.5, 0);
  assert_true(isnan(row->confidence[0]) && isnan(row->chance[0]));
  assert_true(row->pareto && row->pareto_count && !row->why);
  made_destroy(s);
}

/* What cannot be compared has no error, and the reason is reported. */
static void test_nothing_to_compare(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  double third = 1.0 / 3;
  made_parameter(s, "k", VALUES("1", "2", "3", "4", "5"));
  made_configs(s, 1, 0);
  for (int k = 0; k < 5; k++) s->configs[k].reference = k < 3 ? 3 : 4;
  s->reference = STUDY_CONFIG;
  made_run(s->configs[0].runs, 4, 3 * (1 + third), parabola, NULL, 1, 1); /* t 0, 4/3, ...: one in common */
  made_failure(s->configs[1].runs, "no");
  made_run(s->configs[2].runs, 2, 3, parabola, NULL, 1, 1); /* t 0, 3 */
  made_run(s->configs[3].runs, 4, 3, parabola, NULL, 1, 1);
  made_failure(s->configs[4].runs, "no");
  OK(study_judge(s));
  const study_judged *row = s->verdict->row;
  assert_int_equal(row[0].points, 1);
  assert_true(isnan(row[0].l2[0]));
  assert_non_null(strstr(row[0].why, "fewer than two values of t"));
  assert_true(isnan(row[1].l2[0]) && isnan(row[1].core) && row[1].members == 0);
  assert_non_null(strstr(row[1].why, "no run came to the end"));
  assert_int_equal(row[2].points, 2);
  NEAR("exact", row[2].l2[0], 0, 0);
  assert_non_null(strstr(row[3].why, "its reference did not come to the end"));
  assert_true(isnan(row[4].l2[0]) && !row[4].why && study_is_reference(s, 4));
  assert_false(row[0].pareto || row[1].pareto || row[3].pareto || row[4].pareto);
  assert_true(row[2].pareto);
  made_destroy(s);
}

/* The largest t is 1e-9 of the range off: still the same t; 1e-8 is another. */
static void test_common_t(void **state) {
  (void)state;
  double t[] = {0, 1, 2}, value[9] = {0};
  study_curve c = {3, t, value};
  assert_int_equal(study_curve_at(&c, 1 + 1.9e-9), 1);
  assert_int_equal(study_curve_at(&c, 1 - 1.9e-9), 1);
  assert_int_equal(study_curve_at(&c, 1 + 1e-8), -1);
  assert_int_equal(study_curve_at(&c, 2), 2);
  assert_int_equal(study_curve_at(&c, 0), 0);
  assert_int_equal(study_curve_at(&c, 3), -1);
  assert_int_equal(study_curve_at(&c, -1), -1);
}

/* A constant for P11. */
static double constant(double t, int column, void *data) {
  (void)t;
  return column == 0 ? *(double *)data : 0;
}

/* Three packings with P11 = 9, 11, 13 against 10: mean 11, deviation 2, half width 4.3027 * 2/sqrt(3). */
static void test_ensemble(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  double p[3] = {9, 11, 13}, ten = 10;
  made_parameter(s, "k", VALUES("1"));
  made_configs(s, 4, 0);
  for (int m = 0; m < 3; m++) made_run(s->configs[0].runs + m, 5, 1, constant, p + m, 1 + m, 100 * (m + 1));
  made_failure(s->configs[0].runs + 3, "no");
  s->configs[0].runs[1].energy_defect = -0.5, s->configs[0].runs[2].energy_defect = 1e-9;
  s->configs[0].runs[0].residual = 1e-3, s->configs[0].runs[2].residual = 1e-5;
  made_curve(&s->given, 5, 1, constant, &ten);
  OK(study_judge(s));
  const study_judged *row = s->verdict->row;
  assert_int_equal(row->members, 3);
  NEAR("energy imbalance, which has a sign", row->energy_defect, -0.5, 0);
  NEAR("residual", row->residual, 1e-3, 0);
  NEAR("l2", row->l2[0], 0.1, 1e-15);
  NEAR("largest", row->largest[0], 0.1, 1e-15);
  NEAR("single", row->single[0], sqrt((0.01 + 0.01 + 0.09) / 3), 1e-15);
  NEAR("confidence", row->confidence[0], student2 * 2 / sqrt(3) / 10, 1e-12);
  NEAR("chance", row->chance[0], row->confidence[0], 0);
  NEAR("core", row->core, 2, 1e-15);
  NEAR("pairs", row->pair_evaluations, 200, 1e-12);
  made_destroy(s);
}

/* The same packings under the reference: the scatter of the packings cancels, and a packing that one of the
 * two has not finished is left out. Differences 0.1, 0.2, 0.3: mean 0.2, deviation 0.1. */
static void test_paired(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  static const char *const packing[] = {"a.data", "b.data", "c.data", "d.data"};
  double here[4] = {9.1, 11.2, 13.3, 50}, there[4] = {9, 11, 13, 0};
  made_parameter(s, "k", VALUES("1"));
  made_configs(s, 4, 1);
  s->configs[0].reference = 1;
  made_value(s, 1, 0, "2");
  for (int m = 0; m < 4; m++) {
    s->configs[0].runs[m].packing = s->configs[1].runs[m].packing = packing[m];
    made_run(s->configs[0].runs + m, 5, 1, constant, here + m, 1, 1);
    if (m < 3) made_run(s->configs[1].runs + m, 5, 1, constant, there + m, 1, 1);
  }
  made_failure(s->configs[1].runs + 3, "no");
  OK(study_judge(s));
  const study_judged *row = s->verdict->row;
  assert_true(row->paired);
  assert_int_equal(row->members, 4);
  NEAR("l2", row->l2[0], 0.2 / 11, 1e-15);
  NEAR("chance", row->chance[0], student2 * 0.1 / sqrt(3) / 11, 1e-12);
  NEAR("confidence", row->confidence[0], student2 * 2.1 / sqrt(3) / 11, 1e-12);
  double own = (0.1 * 0.1 / 81 + 0.2 * 0.2 / 121 + 0.3 * 0.3 / 169) / 3;
  NEAR("single", row->single[0], sqrt(own), 1e-14);

  /* other packings: both intervals count */
  s->configs[1].runs[0].packing = "e.data";
  OK(study_judge(s));
  row = s->verdict->row;
  assert_false(row->paired);
  double mean = (9.1 + 11.2 + 13.3 + 50) / 4, squares = 0;
  for (int m = 0; m < 4; m++) squares += (here[m] - mean) * (here[m] - mean);
  double h = 3.18244630528371 * sqrt(squares / 3 / 4), hr = student2 * 2 / sqrt(3);
  NEAR("unpaired l2", row->l2[0], (mean - 11) / 11, 1e-14);
  NEAR("unpaired confidence", row->confidence[0], h / 11, 1e-12);
  NEAR("unpaired chance", row->chance[0], sqrt(h * h + hr * hr) / 11, 1e-12);
  made_destroy(s);
}

/* ---- fronts ---- */

/* Random points, some of them equal or on a lattice, against the definition. */
static void test_front(void **state) {
  gh_context *ctx = *state;
  enum { N = 60, TRIALS = 200 };
  unsigned long long seed = 20240611;
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < TRIALS; trial++) {
    double cost[N], error[N];
    bool front[N];
    int order[N], count, n = 1 + (int)(N * uniform(&seed)), size = 0;
    for (int k = 0; k < n; k++) {
      cost[k] = uniform(&seed), error[k] = uniform(&seed);
      if (trial % 2) cost[k] = floor(8 * cost[k]), error[k] = floor(8 * error[k]);
    }
    OK(study_front(ctx, n, cost, error, front, order, &count));
    for (int k = 0; k < n; k++) {
      bool beaten = false;
      for (int j = 0; j < n; j++)
        beaten = beaten ||
                 (cost[j] <= cost[k] && error[j] <= error[k] && (cost[j] < cost[k] || error[j] < error[k]));
      assert_int_equal(front[k], !beaten);
      size += !beaten;
    }
    assert_int_equal(count, size);
    for (int k = 1; k < count; k++) assert_true(cost[order[k - 1]] <= cost[order[k]]);
  }
}

/* Without pair evaluations, factorisations count as work. */
static void test_counts(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  double add[2] = {0.1, 0.01};
  made_parameter(s, "k", VALUES("1", "2"));
  made_configs(s, 1, 0);
  for (int k = 0; k < 2; k++) {
    made_run(s->configs[k].runs, 4, 3, parabola, add + k, 1 + k, 0);
    s->configs[k].runs->factorisations = 20 - 10 * k;
  }
  made_curve(&s->given, 4, 3, parabola, NULL);
  OK(study_judge(s));
  assert_int_equal(study_counts(s), STUDY_FACTORISATIONS);
  assert_true(s->verdict->row[0].pareto && s->verdict->row[1].pareto);
  assert_true(!s->verdict->row[0].pareto_count && s->verdict->row[1].pareto_count);
  s->configs[0].runs->pair_evaluations = 3;
  OK(study_judge(s));
  assert_int_equal(study_counts(s), STUDY_PAIRS);
  made_destroy(s);
}

/* Configurations with references of their own do not compete: the exact answer of one condition is no rival.
 */
static void test_fronts_of_references(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  double add[4] = {0, 0.1, 0, 0.2}, cost[4] = {1, 2, 1, 1};
  made_parameter(s, "tolerance", VALUES("1", "2"));
  made_parameter(s, "boundary", VALUES("taylor", "periodic"));
  made_configs(s, 1, 2);
  s->reference = STUDY_CONFIG;
  for (int k = 0; k < 6; k++) {
    if (k < 4) s->configs[k].reference = 4 + k % 2;
    made_run(s->configs[k].runs, 4, 3, parabola, k < 4 ? add + k : NULL, k < 4 ? cost[k] : 9, 5);
  }
  OK(study_judge(s));
  const study_judged *row = s->verdict->row;
  assert_true(row[0].pareto && row[2].pareto); /* equal */
  assert_true(row[1].pareto && row[3].pareto); /* dearer than taylor, but better or cheaper than each other */
  assert_true(row[1].pareto_count && !row[3].pareto_count);
  made_destroy(s);
}

/* ---- orders ---- */

/* The same, with what is added in P22, where nothing cancels. */
static double beside(double t, int column, void *data) {
  return column == 0 ? t * t : column == 1 && data ? *(double *)data : 0;
}

/* Errors c h^p of a parameter that grows (refine, h = 1/k) or shrinks (tolerance, h = k), given out of order.
 */
static void order_of(gh_context *ctx, const char *parameter, const char *const *values, bool grows,
                     double p) {
  gh_study *s = made_study(ctx);
  made_parameter(s, parameter, values);
  made_parameter(s, "boundary", VALUES("taylor", "periodic"));
  made_configs(s, 1, 0);
  s->order = 0;
  made_curve(&s->given, 11, 1, beside, NULL);
  for (int k = 0; k < s->nconfigs; k++) {
    double h = s->parameters[0].number[s->configs[k].choice[0]];
    if (grows) h = 1 / h;
    double add = (1 + s->configs[k].choice[1]) * 1e-2 * pow(h, p);
    made_run(s->configs[k].runs, 11, 1, beside, &add, 1, 1);
  }
  OK(study_judge(s));
  assert_int_equal(s->verdict->nfits, 2);
  assert_int_equal(s->verdict->grows, grows);
  for (int f = 0; f < 2; f++) {
    NEAR("fit", s->verdict->fits[f].order, p, 1e-12);
    assert_true(s->verdict->fits[f].monotone);
    /* values are given as second, finest, coarsest, third */
    assert_int_equal(s->verdict->fits[f].from, 2);
    assert_int_equal(s->verdict->fits[f].to, 1);
  }
  for (int k = 0; k < s->nconfigs; k++) {
    bool coarsest = s->configs[k].choice[0] == 2;
    assert_int_equal(isnan(s->verdict->row[k].order), coarsest);
    if (!coarsest) NEAR("pair", s->verdict->row[k].order, p, 1e-12);
  }
  made_destroy(s);
}

static void test_orders(void **state) {
  gh_context *ctx = *state;
  const double orders[] = {0.5, 1, 2, 4};
  for (int k = 0; k < 4; k++) {
    order_of(ctx, "refine", VALUES("2", "8", "1", "4"), true, orders[k]);
    order_of(ctx, "tolerance", VALUES("1e-1", "1e-2", "0.3", "0.05"), false, orders[k]);
  }
}

/* One series against a reference by `set`, with errors as given. */
static gh_study *series(gh_context *ctx, const double *errors, const char *const *values,
                        const char *finest) {
  gh_study *s = made_study(ctx);
  made_parameter(s, "refine", values);
  made_configs(s, 1, 1);
  int last = s->nconfigs - 1;
  s->order = 0;
  s->reference = STUDY_CONFIG;
  made_value(s, last, 0, finest);
  double one = 1;
  for (int k = 0; k < last; k++) {
    double v = 1 + errors[k];
    s->configs[k].reference = last;
    made_run(s->configs[k].runs, 4, 1, constant, &v, 1, 1);
  }
  made_run(s->configs[last].runs, 4, 1, constant, &one, 1, 1);
  OK(study_judge(s));
  return s;
}

/* Second order down to a plateau: only what lies ten times above it is fitted; the rest is not monotone. */
static void test_plateau(void **state) {
  gh_context *ctx = *state;
  const double errors[] = {1e-2, 2.5e-3, 6.25e-4, 1.5625e-4, 1e-5, 1.1e-5};
  gh_study *s = series(ctx, errors, VALUES("1", "2", "4", "8", "16", "32"), "64");
  const struct study_fit *f = s->verdict->fits;
  assert_int_equal(s->verdict->nfits, 1);
  NEAR("order", f->order, 2, 1e-8);
  assert_int_equal(f->from, 0);
  assert_int_equal(f->to, 3);
  assert_false(f->monotone);
  assert_int_equal(f->up_from, 4);
  assert_int_equal(f->up_to, 5);
  NEAR("last pair", s->verdict->row[5].order, log(1 / 1.1) / log(2), 1e-8);
  made_destroy(s);
}

/* Divergence away from the reference's side is a negative order, not a positive one of the other sign. */
static void test_divergence(void **state) {
  gh_context *ctx = *state;
  gh_study *s = series(ctx, (const double[]){1e-3, 2e-3, 4e-3}, VALUES("1", "2", "4"), "64");
  assert_true(s->verdict->grows);
  NEAR("order", s->verdict->row[1].order, -1, 1e-9);
  assert_true(isnan(s->verdict->fits[0].order));
  assert_int_equal(s->verdict->fits[0].from, -1);
  assert_false(s->verdict->fits[0].monotone);
  made_destroy(s);
}

/* Errors at round-off are no failure to converge; zero has no logarithm. */
static void test_round_off(void **state) {
  gh_context *ctx = *state;
  gh_study *s = series(ctx, (const double[]){1e-2, 1e-3, 0, 0}, VALUES("1", "10", "100", "1000"), "10000");
  const struct study_fit *f = s->verdict->fits;
  assert_true(f->monotone);
  NEAR("order", f->order, 1, 1e-9);
  assert_int_equal(f->to, 1);
  assert_true(isnan(s->verdict->row[2].order) && isnan(s->verdict->row[3].order));
  made_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(test_student),  TEST(test_errors),   TEST(test_nothing_to_compare),
      TEST(test_common_t), TEST(test_ensemble), TEST(test_paired),
      TEST(test_front),    TEST(test_counts),   TEST(test_fronts_of_references),
      TEST(test_orders),   TEST(test_plateau),  TEST(test_divergence),
      TEST(test_round_off)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
