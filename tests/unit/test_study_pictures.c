/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Pictures of studies whose curves are known. STUDY_PICTURES=DIR keeps them there. */
#include "study_show_help.h"

#include <sys/stat.h>
#include <unistd.h>

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
  made_parameter(s, "packing", some);
  made_parameter(s, "micro.boundary", VALUES("taylor", "restricted", "periodic"));
  made_configs(s, 15, 0);
  s->reference = STUDY_CONFIG;
  for (int k = 0; k < s->nconfigs; k++) {
    int size = s->configs[k].choice[0], boundary = s->configs[k].choice[1];
    s->configs[k].reference = s->nconfigs - 1;
    for (int m = 0; m < 15; m++) {
      double d[2] = {0, 0};
      for (int j = 0; j < 12; j++) d[1] += (uniform(&seed) - 0.5) / sqrt(n[size]) * 1.5;
      d[1] += bias[boundary] * (boundary == 1 ? sqrt(88 / n[size]) : 1);
      made_run(s->configs[k].runs + m, 41, 0.2, path, d, 1e-3 * n[size] * (boundary + 1) * (1 + 0.1 * m / 15),
               (long)(2000 * n[size] * (1 + 40 * boundary)));
      s->configs[k].runs[m].packing = s->configs[k].value[0];
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
    for (int k = 0; k < s->nconfigs; k++)
      if (study_rows_line(&r, row, k, &line)) {
        curves++;
        assert_int_equal(row < 3 ? s->configs[k].choice[1] : 5, row < 3 ? row : s->configs[k].choice[0]);
        if (row < 3) assert_string_equal(line.colour, study_colour(s->configs[k].choice[0]));
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
  made_parameter(s, "packing", VALUES("a-*.data", "b-*.data", "c-*.data", "d-*.data"));
  made_parameter(s, "micro.boundary", VALUES("taylor", "periodic"));
  made_configs(s, 2, 0);
  for (int k = 0; k < 8; k++)
    for (int m = 0; m < 2; m++)
      made_run(s->configs[k].runs + m, 11, 1, path, (double[]){0, 0.1 * k * m}, 1, 1);
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

/* Many curves of one parameter, many panels, a long name of the reference: the key stays below. */
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
  made_parameter(s, "law", values);
  made_configs(s, 1, 0);
  for (int k = 0; k < 40; k++) run_with_error(s->configs[k].runs, 1e-3 * (k + 1), 1, 1);
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
    made_parameter(s, "micro.tolerance", VALUES("1e-2", "1e-4", "1e-6"));
    made_parameter(s, "micro.boundary", some);
    made_configs(s, 1, 0);
    for (int k = 0; k < s->nconfigs; k++) run_with_error(s->configs[k].runs, 0.1 / (k + 1), 1, 1);
    s->configs[2 * groups + 1].runs->status = GH_DIVERGED; /* 1e-6, the second condition */
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
  made_parameter(s, "solver.tangent", VALUES("algorithmic", "symmetrised", "frozen", "elastic"));
  made_parameter(s, "solver.line_search", VALUES("true", "false"));
  made_parameter(s, "solver.increments", VALUES("planned", "automatic"));
  made_configs(s, 1, 0);
  for (int k = 0; k < s->nconfigs; k++) {
    run_with_error(s->configs[k].runs, k % 4 == 1 ? 0 : 1e-9 / (k + 1), 10 + k, 0);
    s->configs[k].runs->factorisations = 0;
  }
  made_curve(&s->given, 11, 1, path, NULL);
  draws(ctx, s, "zero", VALUES("work-precision.png"));
  for (int k = 0; k < s->nconfigs; k++)
    memcpy(s->configs[k].runs->curve.value, s->given.value, 33 * sizeof(double));
  draws(ctx, s, "equal", VALUES("work-precision.png"));
  for (int k = 1; k < s->nconfigs; k++) s->configs[k].runs->finished = false;
  draws(ctx, s, "one", VALUES("work-precision.png"));
  made_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_pictures_tolerance),
                                     TEST(test_pictures_order),
                                     TEST(test_pictures_size),
                                     TEST(test_rows),
                                     TEST(test_range),
                                     TEST(test_key),
                                     TEST(test_groups),
                                     TEST(test_pictures_zero)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
