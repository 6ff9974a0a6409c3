/* Tables, sentences and pictures of studies whose curves are known. SPDX-License-Identifier: GPL-2.0-or-later
 * STUDY_PICTURES=DIR keeps the pictures there. */
#include "study_help.h"
#include "study/draw.h"

#include <sys/stat.h>
#include <unistd.h>

#define VALUES(...)                                                                                          \
  (const char *const[]) {                                                                                    \
    __VA_ARGS__, NULL                                                                                        \
  }

/* ---- made-up studies ---- */

/* Two stresses and an energy that bend like those of a packing; data: error in P22, scatter of P11. */
static double path(double t, int column, void *data) {
  const double *d = data;
  double bend = t * (1 + 0.3 * t), scatter = d ? d[1] : 0;
  return column == 0 ? -bend * (1 + scatter) : column == 1 ? (d ? d[0] : 0) - 0.4 * bend : 0.5 * t * t;
}

/* Norm of the path's stress over 11 rows of [0, 1]. */
static double path_norm(void) {
  double sum = 0;
  for (int k = 0; k <= 10; k++) {
    double t = k / 10.0, bend = t * (1 + 0.3 * t);
    sum += 1.16 * bend * bend;
  }
  return sqrt(sum);
}

/* Error e of the stress as l2: the same at all 11 rows of P22. */
static void run_with_error(study_run *r, double e, double core, long pairs) {
  double d[2] = {e * path_norm() / sqrt(11), 0};
  made_run(r, 11, 1, path, d, core, pairs);
}

/* Tolerances of two conditions, one run of which fails; reference: a closed form. */
static gh_study *tolerance_study(gh_context *ctx) {
  static const double error[8] = {0, 0.2, 9e-3, 3e-2, 9e-4, 3.1e-3, 5e-6, 4e-5};
  gh_study *s = made_study(ctx);
  made_knob(s, "micro.tolerance", VALUES("1e-2", "1e-4", "1e-6", "1e-8"));
  made_knob(s, "micro.boundary", VALUES("restricted", "periodic"));
  made_settings(s, 1, 0);
  for (int k = 1; k < 8; k++) run_with_error(s->settings[k].runs, error[k], 0.1 * (k + 1), 1000L * k * k * k);
  made_failure(s->settings[0].runs, "row 3: no equilibrium | after 400000 steps");
  made_curve(&s->given, 11, 1, path, NULL);
  s->goals[2] = 1e-6;
  return s;
}

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
  has_line(ctx, t,
           "8 settings of made.yaml (micro.tolerance 1e-2, 1e-4, 1e-6, 1e-8; micro.boundary restricted, "
           "periodic), compared with the truth.");
  has_line(ctx, t,
           "- For 1 % of the stress: micro.tolerance 1e-4, micro.boundary restricted (error 9.00e-3, 0.300 s "
           "of one core, 8000 pair evaluations).");
  has_line(ctx, t,
           "- For 0.1 % of the stress: micro.tolerance 1e-6, micro.boundary restricted (error 9.00e-4, 0.500 "
           "s of one core, 6.40e4 pair evaluations).");
  has_line(ctx, t,
           "- No setting reaches 1e-6 of the stress; the nearest is micro.tolerance 1e-8, micro.boundary "
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

/* The terminal says the same, in columns that stand below each other. */
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
  made_knob(s, "packing", VALUES("packings/p88-*.data", "packings/p150-*.data"));
  made_settings(s, 3, 0);
  s->settings[0].reference = s->settings[1].reference = 1;
  s->reference = STUDY_SETTING;
  for (int m = 0; m < 2; m++) made_run(s->settings[0].runs + m, 11, 1, path, d[m], 0.5, 0);
  made_failure(s->settings[0].runs + 2, "lost");
  for (int m = 0; m < 3; m++) made_run(s->settings[1].runs + m, 11, 1, path, d[2], 0.5, 0);
  for (int m = 0; m < 3; m++) s->settings[0].runs[m].packing = "a", s->settings[1].runs[m].packing = "b";
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  /* mean of P11: 0.005 off in units of |P| = sqrt(1.16) |P11|; deviation 0.19/sqrt(2), t 12.706 */
  NEAR("error", s->verdict->row[0].l2[0], 0.005 / sqrt(1.16), 1e-14);
  NEAR("chance", s->verdict->row[0].chance[0], 12.706204736 * 0.095 / sqrt(1.16), 1e-8);
  has_line(ctx, t,
           "- For 1 % of the stress: packing packings/p88-\\*.data (error of the mean 4.64e-3 +- 1.12, of a "
           "single packing 8.83e-2; for each packing 0.500 s of one core and 10 factorisations). With 2 "
           "packings this difference can't be told from chance, so whether the goal is met remains open.");
  has_line(ctx, t,
           "- No setting reaches 0.1 % or 1e-6 of the stress; the nearest is packing packings/p88-\\*.data "
           "(error of the mean 4.64e-3 +- 1.12, of a single packing 8.83e-2; for each packing 0.500 s of one "
           "core and 10 factorisations). With 2 packings this difference can't be told from chance.");
  has_line(
      ctx, t,
      "| packings/p88-\\*.data | 4.64e-3 [1] | 1.12 | 8.83e-2 | 4.64e-3 | 0 | 2 of 3 | 0.500 | 10 | both |");
  has_line(ctx, t, "| packings/p150-\\*.data | reference | - | - | - | - | 3 of 3 | 0.500 | 10 |  |");
  has_line(ctx, t, "- [1] packing packings/p88-\\*.data: 1 of 3 packings failed, the first with: lost.");
  gh_text_destroy(&t);
  made_destroy(s);
}

/* refine 1 ... 8 of two conditions: one of second order, one that grows in between. */
static gh_study *order_study(gh_context *ctx) {
  static const double error[8] = {4e-2, 3e-2, 1e-2, 4e-3, 2.5e-3, 6e-3, 6.25e-4, 1e-3};
  gh_study *s = made_study(ctx);
  made_knob(s, "refine", VALUES("1", "2", "4", "8"));
  made_knob(s, "boundary", VALUES("taylor", "periodic"));
  made_settings(s, 1, 2);
  s->reference = STUDY_SETTING;
  s->order = 0;
  for (int k = 0; k < 8; k++) {
    s->settings[k].reference = 8 + k % 2;
    run_with_error(s->settings[k].runs, error[k], 0.1 * (k / 2 + 1), 1000 * (k / 2 + 1));
  }
  for (int k = 8; k < 10; k++) {
    made_value(s, k, 0, "16");
    run_with_error(s->settings[k].runs, 0, 30 * (k - 7), 100000);
  }
  return s;
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
           "- For 1 % of the stress: refine 4, boundary taylor (error 2.50e-3, 0.300 s of one core, 3000 "
           "pair evaluations).");
  has_line(ctx, t,
           "- For 1 % of the stress: refine 2, boundary periodic (error 4.00e-3, 0.200 s of one core, 2000 "
           "pair evaluations).");
  has_line(ctx, t, "| boundary | order in refine | from | to |  |");
  has_line(ctx, t, "| taylor | 2.00 | 1 | 8 |  |");
  has_line(ctx, t, "| periodic | 2.91 | 1 | 2 | not monotone: the error does not fall from 2 to 4 |");
  has_line(ctx, t, "| 4 | taylor | 2.50e-3 | 1.41e-3 | 0 | 0.300 | 3000 | 2.00 | both |");
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
  made_knob(s, "k", VALUES("1"));
  made_settings(s, 1, 0);
  made_curve(&s->given, 11, 1, path, NULL);
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  has_line(ctx, t, "- No setting could be compared with the reference: no run came to the end.");
  has_line(ctx, t, "| 1 | not run [1] | - | - | - |  |");
  has_line(ctx, t, "- [1] k 1: It was not run.");
  has_no(t, "nan");
  OK(study_draw(s, "/nonexistent")); /* nothing to draw */
  gh_text_destroy(&t);
  made_destroy(s);
}

/* A reference that has no row of its own tells why it has no answer. */
static void test_failed_reference(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  gh_text *t;
  made_knob(s, "k", VALUES("1", "2"));
  made_settings(s, 1, 1);
  s->reference = STUDY_SETTING;
  for (int k = 0; k < 2; k++) {
    s->settings[k].reference = 2;
    run_with_error(s->settings[k].runs, 0.1, 1, 10);
  }
  made_value(s, 2, 0, "9");
  made_failure(s->settings[2].runs, "row 3: no equilibrium");
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  has_line(ctx, t,
           "- No setting could be compared with the reference: its reference did not come to the end.");
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

/* Knobs that end alike keep their whole names in legends. */
static void test_names_that_end_alike(void **state) {
  gh_study *s = made_study(*state);
  char name[64];
  made_knob(s, "micro.tolerance", VALUES("1e-4", "1e-8"));
  made_knob(s, "solver.tolerance", VALUES("1e-2", "1e-3"));
  made_knob(s, "solver.cut_steps", VALUES("5", "6"));
  made_settings(s, 1, 0);
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
  made_knob(s, "packing", VALUES("\"p/p150-00[1-3].data\"", "\"sand-0.5.data\"", "p/sand-0.25-*"));
  made_settings(s, 1, 0);
  for (int k = 0; k < 3; k++) run_with_error(s->settings[k].runs, 0.02 - 0.006 * k, 1 + k, 1000 * (k + 1));
  made_curve(&s->given, 11, 1, path, NULL);
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  study_write_markdown(s, t);
  has_line(ctx, t,
           "3 settings of made.yaml (packing p/p150-00[1-3].data, sand-0.5.data, p/sand-0.25-\\*), compared "
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

/* All is numbers here but the outcome: read back up to it, and behind it. */
static void test_csv(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  gh_text *t;
  gh_csv *csv;
  char file[64];
  double d[2][2] = {{0.001, 0.1}, {0.001, -0.05}};
  made_knob(s, "micro.tolerance", VALUES("1e-2", "1e-4"));
  made_settings(s, 2, 0);
  for (int k = 0; k < 4; k++) made_run(s->settings[k / 2].runs + k % 2, 11, 1, path, d[k % 2], 1.0 / 3, 7);
  for (int k = 0; k < 4; k++)
    s->settings[k / 2].runs[k % 2].residual = s->settings[k / 2].runs[k % 2].energy_defect = k;
  made_curve(&s->given, 11, 1, path, NULL);
  OK(study_judge(s));
  temporary(file);

  OK(gh_text_create(ctx, &t));
  study_write_curves(s, t);
  OK(gh_text_commit(t, file));
  OK(gh_csv_read(ctx, file, &csv));
  assert_int_equal(csv->nrows, 22);
  assert_int_equal(csv->ncols, 2 + 2 + 6);
  const double *row = csv->value + 15 * csv->ncols; /* second setting, t = 0.4: P11 = -0.448 (1 + scatter) */
  NEAR("setting", row[0], 1, 0);
  NEAR("knob", row[gh_csv_find(csv, "micro.tolerance")], 1e-4, 0);
  NEAR("t", row[gh_csv_find(csv, "t")], 0.4, 1e-16);
  NEAR("members", row[gh_csv_find(csv, "members")], 2, 0);
  NEAR("P11", row[gh_csv_find(csv, "P11")], -0.448 * 1.025, 1e-15);
  NEAR("P11 deviation", row[gh_csv_find(csv, "P11_deviation")], 0.448 * 0.15 / sqrt(2), 1e-15);
  NEAR("P22", row[gh_csv_find(csv, "P22")], 0.001 - 0.4 * 0.448, 1e-15);
  NEAR("energy", row[gh_csv_find(csv, "energy")], 0.08, 1e-15);
  gh_csv_destroy(&csv);
  gh_text_destroy(&t);

  /* a word stands in for a number: outcomes become 0, orders of no knob are left off with the last column */
  OK(gh_text_create(ctx, &t));
  study_write_csv(s, t);
  char *text = strdup(gh_text_get(t, NULL)), *p;
  assert_non_null(text);
  while ((p = strstr(text, ",done,"))) memcpy(p, ",0000,", 6);
  while ((p = strstr(text, ",nan\n"))) memcpy(p, ",000\n", 5);
  while ((p = strstr(text, ",,"))) memmove(p, p + 1, strlen(p)); /* `also` is empty ... */
  if ((p = strstr(text, ",also,"))) memmove(p, p + 5, strlen(p + 5) + 1);
  OK(gh_text_set(t, text, strlen(text)));
  free(text);
  OK(gh_text_commit(t, file));
  OK(gh_csv_read(ctx, file, &csv));
  assert_int_equal(csv->nrows, 2);
  for (int k = 0; k < 2; k++) {
    row = csv->value + k * csv->ncols;
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
  unlink(file);
  made_destroy(s);
}

/* Values with commas stand in quotes; those that a value has in YAML are no part of it. */
static void test_csv_quotes(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  gh_text *t;
  made_knob(s, "mesh", VALUES("[1, 2]", "\"a\"", "\"b\\\"c\""));
  made_settings(s, 1, 0);
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

/* ---- pictures ---- */

/* Draws into STUDY_PICTURES/name, or into a folder that is removed; each of these files must be there, and no
 * other. */
static void draws(gh_context *ctx, gh_study *s, const char *name, const char *const *files) {
  static const char *const all[] = {"work-precision.png", "work-precision-count.png", "order.png",
                                    "curves.png"};
  const char *keep = getenv("STUDY_PICTURES");
  char folder[256] = "/tmp/study-show-XXXXXX", file[512];
  if (keep) snprintf(folder, sizeof folder, "%s/%s", keep, name);
  else assert_non_null(mkdtemp(folder));
  if (keep) OK(gh_folder_make(ctx, folder));
  OK(study_judge(s));
  OK(study_draw(s, folder));
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    struct stat info;
    bool wanted = false;
    for (int j = 0; files[j]; j++) wanted = wanted || strcmp(files[j], all[k]) == 0;
    snprintf(file, sizeof file, "%s/%s", folder, all[k]);
    bool there = stat(file, &info) == 0 && info.st_size > 5000;
    if (there != wanted) fail_msg("%s is %sthere", file, there ? "" : "not ");
    if (!keep) unlink(file);
  }
  if (!keep) rmdir(folder);
}

static bool no_gnuplot(void) {
  return system("command -v gnuplot >/dev/null 2>&1") != 0;
}

static void test_pictures_tolerance(void **state) {
  gh_context *ctx = *state;
  gh_study *s = tolerance_study(ctx);
  if (no_gnuplot()) skip();
  draws(ctx, s, "tolerance", VALUES("work-precision.png", "work-precision-count.png"));
  made_destroy(s);
}

static void test_pictures_order(void **state) {
  gh_context *ctx = *state;
  gh_study *s = order_study(ctx);
  if (no_gnuplot()) skip();
  s->nplots = 2;
  s->plots = made_array(2, sizeof *s->plots);
  s->plots[1] = 2;
  draws(ctx, s, "order", VALUES("work-precision.png", "work-precision-count.png", "order.png", "curves.png"));
  made_destroy(s);
}

/* Ensembles of fifteen, six sizes, three conditions: bounds that close. */
static gh_study *size_study(gh_context *ctx, int sizes) {
  gh_study *s = made_study(ctx);
  unsigned long long seed = 7;
  static const double n[] = {88, 150, 300, 600, 1200, 2400}, bias[] = {0.3, 0.12, 0};
  static const char *const values[] = {"p/p88-*.data",
                                       "p/p150-*.data",
                                       "p/p300-*.data",
                                       "p/p600-*.data",
                                       "p/p1200-*.data",
                                       "p/p2400-*.data",
                                       NULL};
  const char *some[7] = {0};
  for (int k = 0; k < sizes; k++) some[k] = values[k];
  made_knob(s, "packing", some);
  made_knob(s, "micro.boundary", VALUES("taylor", "restricted", "periodic"));
  made_settings(s, 15, 0);
  s->reference = STUDY_SETTING;
  for (int k = 0; k < s->nsettings; k++) {
    int size = s->settings[k].choice[0], boundary = s->settings[k].choice[1];
    s->settings[k].reference = s->nsettings - 1;
    for (int m = 0; m < 15; m++) {
      double d[2] = {0, 0};
      for (int j = 0; j < 12; j++) d[1] += (uniform(&seed) - 0.5) / sqrt(n[size]) * 1.5;
      d[1] += bias[boundary] * (boundary == 1 ? sqrt(88 / n[size]) : 1);
      made_run(s->settings[k].runs + m, 41, 0.2, path, d,
               1e-3 * n[size] * (boundary + 1) * (1 + 0.1 * m / 15),
               (long)(2000 * n[size] * (1 + 40 * boundary)));
      s->settings[k].runs[m].packing = s->settings[k].value[0];
    }
  }
  s->nplots = 3;
  s->plots = made_array(3, sizeof *s->plots);
  for (int k = 0; k < 3; k++) s->plots[k] = k;
  return s;
}

static void test_pictures_size(void **state) {
  gh_context *ctx = *state;
  if (no_gnuplot()) skip();
  for (int sizes = 3; sizes <= 6; sizes += 3) {
    gh_study *s = size_study(ctx, sizes);
    draws(ctx, s, sizes == 3 ? "size3" : "size6",
          VALUES("work-precision.png", "work-precision-count.png", "curves.png"));
    made_destroy(s);
  }
}

/* ---- panels and key of curves.png ---- */

typedef struct panels {
  int n, width, height;
  double left[64], right[64], bottom[64], top[64], y[64][2];
  double key; /* highest line of the key, as a share of the height */
} panels;

/* Reads them from the commands: a key that is too high, panels that are too small or overlap are failures. */
static void read_panels(gh_context *ctx, gh_study *s, panels *p) {
  gh_text *t;
  double x, y;
  *p = (panels){0};
  OK(study_judge(s));
  OK(gh_text_create(ctx, &t));
  OK(study_curves_script(s, t, &p->width, &p->height));
  for (const char *at = gh_text_get(t, NULL); at; at = strchr(at, '\n')) {
    at += *at == '\n';
    assert_true(p->n < 64);
    sscanf(at, "set lmargin at screen %lf", &p->left[p->n]);
    sscanf(at, "set rmargin at screen %lf", &p->right[p->n]);
    sscanf(at, "set bmargin at screen %lf", &p->bottom[p->n]);
    sscanf(at, "set tmargin at screen %lf", &p->top[p->n]);
    sscanf(at, "set yrange [%lf:%lf]", &p->y[p->n][0], &p->y[p->n][1]);
    if (sscanf(at, "set arrow from screen %lf, screen %lf", &x, &y) == 2) p->key = fmax(p->key, y);
    p->n += strncmp(at, "plot ", 5) == 0;
  }
  gh_text_destroy(&t);
  assert_true(p->width <= 1600);
  for (int k = 0; k < p->n; k++) {
    assert_true((p->right[k] - p->left[k]) * p->width > 249.9);
    assert_true((p->top[k] - p->bottom[k]) * p->height > 219.9);
    assert_true(p->left[k] > 0 && p->right[k] < 1 && p->top[k] < 1);
    assert_true(p->key > 0 && p->key < 1 &&
                (p->bottom[k] - p->key) * p->height > 60); /* numbers, name of the axis */
    for (int j = 0; j < k; j++)
      assert_true(p->right[j] < p->left[k] || p->right[k] < p->left[j] || p->top[j] < p->bottom[k] ||
                  p->top[k] < p->bottom[j]);
  }
}

/* Three conditions of six sizes: a row each, and one that compares them; the same y down a column. */
static void test_rows(void **state) {
  static const char *const names[] = {"taylor", "restricted", "periodic (reference: p2400-*)",
                                      "comparison for packing p2400-*"};
  static const char *const entries[] = {"packing",
                                        "p88-*",
                                        "p150-*",
                                        "p300-*",
                                        "p600-*",
                                        "p1200-*",
                                        "p2400-*",
                                        "comparison",
                                        "taylor",
                                        "restricted",
                                        "periodic (reference)"};
  gh_context *ctx = *state;
  gh_study *s = size_study(ctx, 6);
  panels p;
  study_rows r;
  study_key key;
  study_line line;
  char name[STUDY_NAME];
  read_panels(ctx, s, &p);
  assert_int_equal(p.n, 4 * 3);
  for (int k = 0; k < p.n; k++) /* plots after each other, each with its rows */
    for (int j = 0; j < 2; j++) NEAR("end of y", p.y[k][j], p.y[k - k % 4][j], 0);
  assert_true(p.left[0] == p.left[3] && p.left[3] < p.left[4] && p.top[0] == p.top[4] && p.top[1] < p.top[0]);

  OK(study_rows_plan(s, &r));
  assert_int_equal(study_rows_count(&r), 4);
  for (int row = 0; row < 4; row++) {
    int curves = 0;
    study_rows_name(&r, row, name);
    assert_string_equal(name, names[row]);
    for (int k = 0; k < s->nsettings; k++)
      if (study_rows_line(&r, row, k, &line)) {
        curves++;
        assert_int_equal(row < 3 ? s->settings[k].choice[1] : 5, row < 3 ? row : s->settings[k].choice[0]);
        if (row < 3) assert_string_equal(line.colour, study_colour(s->settings[k].choice[0]));
      }
    assert_int_equal(curves, row < 3 ? 6 : 3);
  }
  study_key_plan(&r, 100, 1000, &key);
  assert_int_equal(key.n, 11);
  for (int k = 0; k < key.n; k++) assert_string_equal(key.entry[k].text, entries[k]);
  study_rows_free(&r);
  made_destroy(s);
}

/* y of the first plot reaches from the lowest to the highest bar of all rows. */
static void test_range(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  panels p;
  made_knob(s, "packing", VALUES("a-*.data", "b-*.data", "c-*.data", "d-*.data"));
  made_knob(s, "micro.boundary", VALUES("taylor", "periodic"));
  made_settings(s, 2, 0);
  for (int k = 0; k < 8; k++)
    for (int m = 0; m < 2; m++)
      made_run(s->settings[k].runs + m, 11, 1, path, (double[]){0, 0.1 * k * m}, 1, 1);
  made_curve(&s->given, 11, 1, path, NULL);
  s->nplots = 1;
  s->plots = made_array(1, sizeof *s->plots);
  read_panels(ctx, s, &p);
  assert_int_equal(p.n, 3);
  /* P11 = -1.3 (1 + scatter) at the end; scatters 0 and 0.7: mean 0.35, deviation 0.7/sqrt(2) */
  double low = -1.3 * (1.35 + 0.7 / sqrt(2)), high = 0;
  for (int k = 0; k < 3; k++) {
    NEAR("low", p.y[k][0], low - 0.04 * (high - low), 1e-12);
    NEAR("high", p.y[k][1], high + 0.04 * (high - low), 1e-12);
  }
  made_destroy(s);
}

/* Many curves of one knob, many panels, a long name of the reference: the key stays below. */
static void test_key(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  panels p;
  study_rows r;
  study_key key;
  const char *values[41] = {0};
  char text[40][48], long_name[301];
  for (int k = 0; k < 40; k++) {
    snprintf(text[k], sizeof text[k], "a_rather_long_name_of_a_value_%d", k);
    values[k] = text[k];
  }
  memset(long_name, 'x', 300), long_name[300] = 0;
  free(s->reference_text);
  s->reference_text = made_text(long_name);
  made_knob(s, "law", values);
  made_settings(s, 1, 0);
  for (int k = 0; k < 40; k++) run_with_error(s->settings[k].runs, 1e-3 * (k + 1), 1, 1);
  made_curve(&s->given, 11, 1, path, NULL);
  s->nplots = 9;
  s->plots = made_array(9, sizeof *s->plots);
  for (int k = 0; k < 9; k++) s->plots[k] = k % 3;
  read_panels(ctx, s, &p);
  assert_int_equal(p.n, 9);
  OK(study_rows_plan(s, &r));
  assert_int_equal(study_rows_count(&r), 1);
  study_key_plan(&r, 100, 900, &key);
  assert_int_equal(key.n, 14); /* twelve have a colour */
  assert_string_equal(key.entry[11].text, "a_rather_long_name_of_a_value_11");
  assert_string_equal(key.entry[12].text, "others");
  assert_true(strlen(key.entry[13].text) < 100 && strstr(key.entry[13].text, "xx..."));
  assert_int_equal(study_key_height(&key), 8 * STUDY_KEY_LINE); /* in twos, the last alone */
  study_rows_free(&r);
  if (!no_gnuplot())
    draws(ctx, s, "key", VALUES("work-precision.png", "work-precision-count.png", "curves.png"));
  made_destroy(s);
}

/* Five groups are not compared in one row; a value that one of them has not is not what is compared. */
static void test_groups(void **state) {
  gh_context *ctx = *state;
  for (int groups = 4; groups <= 5; groups++) {
    gh_study *s = made_study(ctx);
    study_rows r;
    panels p;
    const char *some[6] = {"taylor", "taylor-cell", "restricted", "periodic", "traction", NULL};
    some[groups] = NULL;
    made_knob(s, "micro.tolerance", VALUES("1e-2", "1e-4", "1e-6"));
    made_knob(s, "micro.boundary", some);
    made_settings(s, 1, 0);
    for (int k = 0; k < s->nsettings; k++) run_with_error(s->settings[k].runs, 0.1 / (k + 1), 1, 1);
    s->settings[2 * groups + 1].runs->status = GH_DIVERGED; /* 1e-6, the second condition */
    made_curve(&s->given, 11, 1, path, NULL);
    s->nplots = 5;
    s->plots = made_array(5, sizeof *s->plots);
    read_panels(ctx, s, &p);
    assert_int_equal(p.n, 25); /* 4 x 5 and 5 that compare, or 5 x 5 */
    OK(study_rows_plan(s, &r));
    assert_int_equal(r.ngroups, groups);
    assert_int_equal(r.compared, groups == 4 ? 1 : -1);
    study_rows_free(&r);
    if (!no_gnuplot())
      draws(ctx, s, groups == 4 ? "groups4" : "groups5",
            VALUES("work-precision.png", "work-precision-count.png", "curves.png"));
    made_destroy(s);
  }
}

/* Answers that equal the reference, no counts, long names with marks of gnuplot in them. */
static void test_pictures_zero(void **state) {
  gh_context *ctx = *state;
  gh_study *s = made_study(ctx);
  if (no_gnuplot()) skip();
  free(s->title);
  s->title = made_text("Answers that are exactly equal: 100 % of 'them', _really_");
  made_knob(s, "solver.tangent", VALUES("algorithmic", "symmetrised", "frozen", "elastic"));
  made_knob(s, "solver.line_search", VALUES("true", "false"));
  made_knob(s, "solver.increments", VALUES("planned", "automatic"));
  made_settings(s, 1, 0);
  for (int k = 0; k < s->nsettings; k++) {
    run_with_error(s->settings[k].runs, k % 4 == 1 ? 0 : 1e-9 / (k + 1), 10 + k, 0);
    s->settings[k].runs->factorisations = 0;
  }
  made_curve(&s->given, 11, 1, path, NULL);
  draws(ctx, s, "zero", VALUES("work-precision.png"));
  for (int k = 0; k < s->nsettings; k++)
    memcpy(s->settings[k].runs->curve.value, s->given.value, 33 * sizeof(double));
  draws(ctx, s, "equal", VALUES("work-precision.png"));
  for (int k = 1; k < s->nsettings; k++) s->settings[k].runs->finished = false;
  draws(ctx, s, "one", VALUES("work-precision.png"));
  made_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_markdown),
                                     TEST(test_print),
                                     TEST(test_ensemble_text),
                                     TEST(test_order_text),
                                     TEST(test_nothing),
                                     TEST(test_csv),
                                     TEST(test_failed_reference),
                                     TEST(test_plain),
                                     TEST(test_quoted_values),
                                     TEST(test_names_that_end_alike),
                                     TEST(test_csv_quotes),
                                     TEST(test_pictures_tolerance),
                                     TEST(test_pictures_order),
                                     TEST(test_pictures_size),
                                     TEST(test_rows),
                                     TEST(test_range),
                                     TEST(test_key),
                                     TEST(test_groups),
                                     TEST(test_pictures_zero)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
