/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tables and sentences of studies whose curves are known. */
#include "study_show_help.h"

#include <unistd.h>

/* ---- text ---- */

/* The text has this line. */
static void has_line(gh_context *ctx, const gh_text *t, const char *line) {
  (void)ctx;
  const char *text = gh_text_get(t, NULL);
  size_t n = strlen(line);
  for (const char *p = text; p; p = strchr(p, '\n')) {
    p += *p == '\n';
    if (strncmp(p, line, n) == 0 && (p[n] == '\n' || p[n] == 0)) return;
    if (!*p) break;
  }
  print_error("no line \"%s\" in\n", line);
  fputs(text, stderr);
  fail();
}

static void has_no(const gh_text *t, const char *words) {
  if (strstr(gh_text_get(t, NULL), words)) fail_msg("\"%s\" in\n%s", words, gh_text_get(t, NULL));
}

static void test_markdown(void **state) {
  gh_context *ctx = *state;
  gh_study *s = tolerance_study(ctx);
  gh_text *t;
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  has_line(ctx, t, "# A made study");
  has_line(
      ctx, t,
      "8 configurations of made.yaml (micro.tolerance 1e-2, 1e-4, 1e-6, 1e-8; micro.boundary restricted, "
      "periodic), compared with the truth.");
  has_line(ctx, t,
           "- For 1 % of the stress: micro.tolerance 1e-4, micro.boundary restricted (error 9.00e-3, 0.300 s "
           "of one core, 8000 pair evaluations).");
  has_line(ctx, t,
           "- For 0.1 % of the stress: micro.tolerance 1e-6, micro.boundary restricted (error 9.00e-4, 0.500 "
           "s of one core, 6.40e4 pair evaluations).");
  has_line(
      ctx, t,
      "- No configuration reaches 1e-6 of the stress; the nearest is micro.tolerance 1e-8, micro.boundary "
      "restricted (error 5.00e-6, 0.700 s of one core, 2.16e5 pair evaluations).");
  has_line(ctx, t,
           "| micro.tolerance | micro.boundary | error of the stress | largest | energy | seconds | pair "
           "evaluations | front |");
  has_line(ctx, t, "| --- | --- | ---: | ---: | ---: | ---: | ---: | --- |");
  has_line(ctx, t, "| 1e-2 | restricted | failed [1] | - | - | - | - |  |");
  has_line(ctx, t, "| 1e-2 | periodic | 0.200 | 0.113 | 0 | 0.200 | 1000 | both |");
  has_line(ctx, t, "| 1e-6 | periodic | 3.10e-3 | 1.75e-3 | 0 | 0.600 | 1.25e5 |  |");
  has_line(
      ctx, t,
      "- [1] micro.tolerance 1e-2, micro.boundary restricted: row 3: no equilibrium \\| after 400000 steps.");
  has_no(t, "nan");
  has_no(t, "packing");
  gh_text_destroy(&t);
  made_destroy(s);
}

/* The terminal shows the same, in columns that stand below each other. */
static void test_print(void **state) {
  gh_context *ctx = *state;
  gh_study *s = tolerance_study(ctx);
  gh_text *t;
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  gh_study_print(s, t);
  has_line(ctx, t,
           "For 1 % of the stress: micro.tolerance 1e-4, micro.boundary restricted (error 9.00e-3, 0.300 s "
           "of one core, 8000 pair evaluations).");
  has_line(ctx, t,
           "micro.tolerance  micro.boundary  error of the stress  largest  energy  seconds  pair evaluations "
           " front");
  has_line(
      ctx, t,
      "1e-2             restricted               failed [1]        -       -        -                 -  ");
  has_line(
      ctx, t,
      "1e-6             periodic                    3.10e-3  1.75e-3       0    0.600            1.25e5  ");
  has_line(
      ctx, t,
      "[1] micro.tolerance 1e-2, micro.boundary restricted: row 3: no equilibrium | after 400000 steps.");
  gh_text_destroy(&t);
  made_destroy(s);
}

/* One packing of three fails; the mean of the others is nearer to the reference than chance can tell. */
static void test_ensemble_text(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  gh_text *t;
  double d[3][2] = {{0, 0.1}, {0, -0.09}, {0, 0}};
  made_parameter(s, "packing", VALUES("packings/p88-*.data", "packings/p150-*.data"));
  made_configs(s, 3, 0);
  s->configs[0].reference = s->configs[1].reference = 1;
  s->reference = STUDY_CONFIG;
  for (int m = 0; m < 2; m++) made_run(s->configs[0].runs + m, 11, 1, path, d[m], 0.5, 0);
  made_failure(s->configs[0].runs + 2, "lost");
  for (int m = 0; m < 3; m++) made_run(s->configs[1].runs + m, 11, 1, path, d[2], 0.5, 0);
  for (int m = 0; m < 3; m++) s->configs[0].runs[m].packing = "a", s->configs[1].runs[m].packing = "b";
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  /* mean of P11: 0.005 off in units of |P| = sqrt(1.16) |P11|; deviation 0.19/sqrt(2), t 12.706 */
  NEAR("error", s->verdict->row[0].l2[0], 0.005 / sqrt(1.16), 1e-14);
  NEAR("chance", s->verdict->row[0].chance[0], 12.706204736 * 0.095 / sqrt(1.16), 1e-8);
  has_line(ctx, t,
           "- For 1 % of the stress: packing packings/p88-\\*.data (error of the mean 4.64e-3 +- 1.12, of a "
           "single packing 8.83e-2; for each packing 0.500 s of one core and 10 factorisations). With 2 "
           "packings this difference cannot be distinguished from chance, so whether the goal is met remains "
           "open.");
  has_line(
      ctx, t,
      "- No configuration reaches 0.1 % or 1e-6 of the stress; the nearest is packing packings/p88-\\*.data "
      "(error of the mean 4.64e-3 +- 1.12, of a single packing 8.83e-2; for each packing 0.500 s of one "
      "core and 10 factorisations). With 2 packings this difference cannot be distinguished from chance.");
  has_line(
      ctx, t,
      "| packings/p88-\\*.data | 4.64e-3 [1] | 1.12 | 8.83e-2 | 4.64e-3 | 0 | 2 of 3 | 0.500 | 10 | both |");
  has_line(ctx, t, "| packings/p150-\\*.data | reference | - | - | - | - | 3 of 3 | 0.500 | 10 |  |");
  has_line(ctx, t, "- [1] packing packings/p88-\\*.data: 1 of 3 packings failed, the first with: lost.");
  gh_text_destroy(&t);
  made_destroy(s);
}

static void test_order_text(void **state) {
  gh_context *ctx = *state;
  gh_study *s = order_study(ctx);
  gh_text *t;
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  /* each condition has a reference of its own, and sentences of its own */
  has_line(ctx, t,
           "- For 1 % of the stress: refine 4, boundary taylor (error 3.00e-3, 0.300 s of one core, 3000 "
           "pair evaluations).");
  has_line(ctx, t,
           "- For 1 % of the stress: refine 2, boundary periodic (error 4.00e-3, 0.200 s of one core, 2000 "
           "pair evaluations).");
  has_line(ctx, t, "| boundary | order in refine | from | to |  |");
  has_line(ctx, t, "| taylor | 2.00 | 1 | 8 |  |");
  has_line(ctx, t, "| periodic | 2.91 | 1 | 2 | not monotone: the error does not fall from 2 to 4 |");
  has_line(ctx, t, "| 4 | taylor | 3.00e-3 | 1.69e-3 | 0 | 0.300 | 3000 | 2.00 | both |");
  assert_non_null(strstr(gh_text_get(t, NULL), "The references took 30.0 to 60.0 s of one core."));
  assert_non_null(strstr(gh_text_get(t, NULL), "less than four times coarser than the reference"));
  gh_text_destroy(&t);
  made_destroy(s);
}

/* Nothing to compare: said once, and no table of NaN. */
static void test_nothing(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  gh_text *t;
  made_parameter(s, "k", VALUES("1"));
  made_configs(s, 1, 0);
  made_curve(&s->given, 11, 1, path, NULL);
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  has_line(ctx, t, "- No configuration could be compared with the reference: no run came to the end.");
  has_line(ctx, t, "| 1 | not run [1] | - | - | - |  |");
  has_line(ctx, t, "- [1] k 1: It was not run.");
  has_no(t, "nan");
  OK(study_draw(s, "/nonexistent")); /* nothing to draw */
  gh_text_destroy(&t);
  made_destroy(s);
}

/* A reference that has no row of its own reports why it has no answer. */
static void test_failed_reference(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  gh_text *t;
  made_parameter(s, "k", VALUES("1", "2"));
  made_configs(s, 1, 1);
  s->reference = STUDY_CONFIG;
  for (int k = 0; k < 2; k++) {
    s->configs[k].reference = 2;
    run_with_error(s->configs[k].runs, 0.1, 1, 10);
  }
  made_value(s, 2, 0, "9");
  made_failure(s->configs[2].runs, "row 3: no equilibrium");
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  has_line(ctx, t,
           "- No configuration could be compared with the reference: its reference did not come to the end.");
  has_line(ctx, t, "- [2] k 2: Not compared: its reference did not come to the end.");
  has_line(ctx, t, "- reference k 9: row 3: no equilibrium.");
  gh_text_destroy(&t);
  made_destroy(s);
}

/* ---- values in quotes ---- */

static void test_plain(void **state) {
  static const char *const values[][2] = {
      {"1e-4", "1e-4"},
      {"", ""},
      {"\"packings/p150-00[1-3].data\"", "packings/p150-00[1-3].data"},
      {"\"a \\\"b\\\" \\\\ c\"", "a \"b\" \\ c"},
      {"\"\"", ""},
      {"\"", "\""},
      {"\"a\", \"b\"", "\"a\", \"b\""}, /* not one text */
      {"[\"a\"]", "[\"a\"]"},
  };
  char text[64];
  (void)state;
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    assert_string_equal(study_plain(values[k][0], text, sizeof text), values[k][1]);
  assert_string_equal(study_plain("\"abcdef\"", text, 4), "abc");
}

/* Parameters that end alike keep their whole names in legends. */
static void test_names_that_end_alike(void **state) {
  gh_study *s = made_study(*state);
  char name[64];
  made_parameter(s, "micro.tolerance", VALUES("1e-4", "1e-8"));
  made_parameter(s, "solver.tolerance", VALUES("1e-2", "1e-3"));
  made_parameter(s, "solver.cut_steps", VALUES("5", "6"));
  made_configs(s, 1, 0);
  study_legend(s, 0, 0, name, sizeof name);
  assert_string_equal(name, "solver.tolerance 1e-2, cut_steps 5");
  made_destroy(s);
}

/* Tables and sentences have the text, legends the name of the file. */
static void test_quoted_values(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  gh_text *t;
  char name[64];
  made_parameter(s, "packing", VALUES("\"p/p150-00[1-3].data\"", "\"sand-0.5.data\"", "p/sand-0.25-*"));
  made_configs(s, 1, 0);
  for (int k = 0; k < 3; k++) run_with_error(s->configs[k].runs, 0.02 - 0.006 * k, 1 + k, 1000 * (k + 1));
  made_curve(&s->given, 11, 1, path, NULL);
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  has_line(
      ctx, t,
      "3 configurations of made.yaml (packing p/p150-00[1-3].data, sand-0.5.data, p/sand-0.25-\\*), compared "
      "with the truth.");
  has_line(ctx, t, "| p/p150-00[1-3].data | 2.00e-2 | 1.13e-2 | 0 | 1.00 | 1000 | both |");
  has_line(ctx, t,
           "- For 1 % of the stress: packing p/sand-0.25-\\* (error 8.00e-3, 3.00 s of one core, 3000 pair "
           "evaluations).");
  has_no(t, "\"");
  study_legend(s, 0, -1, name, sizeof name);
  assert_string_equal(name, "p150-00[1-3]");
  study_short_value(s, 1, 0, name, sizeof name);
  assert_string_equal(name, "sand-0.5");
  study_short_value(s, 2, 0, name, sizeof name);
  assert_string_equal(name, "sand-0.25-*");
  gh_text_destroy(&t);
  made_destroy(s);
}

/* ---- CSV ---- */

static void temporary(char path[64]) {
  strcpy(path, "/tmp/study-show-XXXXXX");
  int fd = mkstemp(path);
  assert_true(fd >= 0);
  close(fd);
}

/* Two configurations of two packings each. */
static gh_study *csv_study(gh_context *ctx) {
  gh_study *s = made_study(ctx);
  double d[2][2] = {{0.001, 0.1}, {0.001, -0.05}};
  made_parameter(s, "micro.tolerance", VALUES("1e-2", "1e-4"));
  made_configs(s, 2, 0);
  for (int k = 0; k < 4; k++) {
    study_run *r = s->configs[k / 2].runs + k % 2;
    made_run(r, 11, 1, path, d[k % 2], 1.0 / 3, 7);
    r->residual = r->energy_defect = k;
  }
  made_curve(&s->given, 11, 1, path, NULL);
  OK(study_judge(s));
  return s;
}

/* The text as a file of numbers. */
static gh_csv *read_numbers(gh_context *ctx, gh_text *t) {
  gh_csv *csv;
  char file[64];
  temporary(file);
  OK(gh_text_commit(t, file));
  OK(gh_csv_read(ctx, file, &csv));
  unlink(file);
  return csv;
}

/* Means and deviations of the curves. */
static void curves_are_read_back(gh_context *ctx, gh_study *s) {
  gh_text *t;
  OK(gh_text_create(ctx, &t));
  study_write_curves(s, t);
  gh_csv *csv = read_numbers(ctx, t);
  assert_int_equal(csv->nrows, 22);
  assert_int_equal(csv->ncols, 2 + 2 + 6);
  const double *row =
      csv->value + 15 * csv->ncols; /* second configuration, t = 0.4: P11 = -0.448 (1 + scatter) */
  NEAR("setting", row[0], 1, 0);
  NEAR("parameter", row[gh_csv_find(csv, "micro.tolerance")], 1e-4, 0);
  NEAR("t", row[gh_csv_find(csv, "t")], 0.4, 1e-16);
  NEAR("members", row[gh_csv_find(csv, "members")], 2, 0);
  NEAR("P11", row[gh_csv_find(csv, "P11")], -0.448 * 1.025, 1e-15);
  NEAR("P11 deviation", row[gh_csv_find(csv, "P11_deviation")], 0.448 * 0.15 / sqrt(2), 1e-15);
  NEAR("P22", row[gh_csv_find(csv, "P22")], 0.001 - 0.4 * 0.448, 1e-15);
  NEAR("energy", row[gh_csv_find(csv, "energy")], 0.08, 1e-15);
  gh_csv_destroy(&csv);
  gh_text_destroy(&t);
}

/* A word stands in for a number: outcomes become 0, orders of no parameter are left off with the last column.
 */
static void words_become_numbers(gh_context *ctx, gh_text *t) {
  char *text = strdup(gh_text_get(t, NULL)), *p;
  assert_non_null(text);
  while ((p = strstr(text, ",done,"))) memcpy(p, ",0000,", 6);
  while ((p = strstr(text, ",nan\n"))) memcpy(p, ",000\n", 5);
  while ((p = strstr(text, ",,"))) memmove(p, p + 1, strlen(p)); /* `also` is empty ... */
  if ((p = strstr(text, ",also,"))) memmove(p, p + 5, strlen(p + 5) + 1);
  OK(gh_text_set(t, text, strlen(text)));
  free(text);
}

/* All is numbers here but the outcome: read back up to it, and behind it. */
static void test_csv(void **state) {
  gh_context *ctx = *state;
  gh_study *s = csv_study(ctx);
  gh_text *t;
  curves_are_read_back(ctx, s);
  OK(gh_text_create(ctx, &t));
  study_write_csv(s, t);
  words_become_numbers(ctx, t);
  gh_csv *csv = read_numbers(ctx, t);
  assert_int_equal(csv->nrows, 2);
  for (int k = 0; k < 2; k++) {
    const double *row = csv->value + k * csv->ncols;
    NEAR("core", row[gh_csv_find(csv, "core")], 1.0 / 3, 0);
    NEAR("pairs", row[gh_csv_find(csv, "pair_evaluations")], 7, 0);
    NEAR("l2", row[gh_csv_find(csv, "stress_l2")], s->verdict->row[k].l2[0], 0);
    NEAR("chance", row[gh_csv_find(csv, "stress_chance")], s->verdict->row[k].chance[0], 0);
    NEAR("residual", row[gh_csv_find(csv, "residual")], 2 * k + 1, 0);
    NEAR("members", row[gh_csv_find(csv, "members")], 2, 0);
    NEAR("points", row[gh_csv_find(csv, "points")], 11, 0);
  }
  gh_csv_destroy(&csv);
  gh_text_destroy(&t);
  made_destroy(s);
}

/* Values with commas stand in quotes; those that a value has in YAML are no part of it. */
static void test_csv_quotes(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  gh_text *t;
  made_parameter(s, "mesh", VALUES("[1, 2]", "\"a\"", "\"b\\\"c\""));
  made_configs(s, 1, 0);
  made_curve(&s->given, 11, 1, path, NULL);
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_csv(s, t);
  const char *text = gh_text_get(t, NULL);
  assert_non_null(strstr(text, "\n0,\"[1, 2]\",,-1,unfinished,1,0,0,"));
  assert_non_null(strstr(text, "\n1,a,,-1,unfinished,"));
  assert_non_null(strstr(text, "\n2,\"b\"\"c\",,-1,unfinished,"));
  gh_text_destroy(&t);
  made_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_markdown),         TEST(test_print),
                                     TEST(test_ensemble_text),    TEST(test_order_text),
                                     TEST(test_nothing),          TEST(test_csv),
                                     TEST(test_failed_reference), TEST(test_plain),
                                     TEST(test_quoted_values),    TEST(test_names_that_end_alike),
                                     TEST(test_csv_quotes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
