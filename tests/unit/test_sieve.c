/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Sieve curves: numbers of grains and wrong input.
 * Expected numbers: Tables 3.2 and 3.3 of the dissertation, whose percentages are rounded to four digits. */
#include "../help.h"

#include "granhom/packing.h"

#include <stdio.h>
#include <unistd.h>

static const double quartz_d[] = {0.315, 0.250, 0.160, 0.125, 0.100, 0.063, 0.050};
static const double quartz_v[] = {0, 2.50, 39.72, 44.22, 9.58, 3.70, 0.28};
static const double concrete_d[] = {32, 16, 8, 4, 2, 1};
static const double concrete_v[] = {0, 38, 24, 15, 9, 14};

static gh_sieve *make(gh_context *ctx, gh_sieve_kind kind, int n, const double *d, const double *v) {
  gh_sieve *s;
  OK(gh_sieve_create(ctx, kind, n, d, v, &s));
  return s;
}

/* Shares and numbers of the quartz sand are those of Table 3.2, columns IV and V. */
static void quartz_table(void **state) {
  static const double percent[] = {1.7435, 14.5119, 14.9131, 44.0557, 24.1531, 0.6227, 0};
  static const int wanted[] = {17, 145, 149, 441, 242, 6, 0};
  gh_context *ctx = *state;
  gh_sieve *s = make(ctx, GH_SIEVE_VOLUME, 7, quartz_d, quartz_v);
  double share[7];
  int count[7];
  gh_sieve_shares(s, 2, share);
  OK(gh_sieve_counts(ctx, s, 2, 1000, count));
  for (int k = 0; k < 7; k++) {
    NEAR("share", 100 * share[k], percent[k], 1e-4);
    assert_int_equal(count[k], wanted[k]);
  }
  gh_sieve_destroy(&s);
}

/* Shares and numbers of the concrete aggregate are those of Table 3.3. */
static void concrete_table(void **state) {
  static const double percent[] = {79.0472, 12.7040, 5.2933, 2.1173, 0.8381, 0};
  static const int wanted[] = {791, 127, 53, 21, 8, 0};
  gh_context *ctx = *state;
  gh_sieve *s = make(ctx, GH_SIEVE_VOLUME, 6, concrete_d, concrete_v);
  double share[6];
  int count[6];
  gh_sieve_shares(s, 2, share);
  OK(gh_sieve_counts(ctx, s, 2, 1000, count));
  for (int k = 0; k < 6; k++) {
    NEAR("share", 100 * share[k], percent[k], 1e-4);
    assert_int_equal(count[k], wanted[k]);
  }
  gh_sieve_destroy(&s);
}

/* A curve of passing percentages gives the same grains as the shares it is the sum of, rising or falling. */
static void passing(void **state) {
  static const double d[] = {1, 2, 4, 8, 16}, rising[] = {14, 23, 38, 62, 100};
  gh_context *ctx = *state;
  double falling_d[5], falling[5];
  for (int k = 0; k < 5; k++) falling_d[k] = d[4 - k], falling[k] = rising[4 - k];
  gh_sieve *a = make(ctx, GH_SIEVE_PASSING, 5, d, rising);
  gh_sieve *b = make(ctx, GH_SIEVE_PASSING, 5, falling_d, falling);
  gh_sieve *c = make(ctx, GH_SIEVE_VOLUME, 6, concrete_d, concrete_v);
  for (int k = 0; k < 5; k++) {
    NEAR("rising", a->amount[k], c->amount[k], 1e-12);
    NEAR("falling", b->amount[k], c->amount[k], 1e-12);
    assert_true(b->diameter[k] == d[k]);
  }
  gh_sieve_destroy(&a);
  gh_sieve_destroy(&b);
  gh_sieve_destroy(&c);
}

/* The least number of grains is 100 over the smallest share (3.13), in each dimension, and one less is
 * refused by its name. */
static void least(void **state) {
  gh_context *ctx = *state;
  gh_sieve *s = make(ctx, GH_SIEVE_VOLUME, 6, concrete_d, concrete_v);
  int count[6];
  double sum2 = 0, sum3 = 0; /* 38/16^dim is the smallest */
  for (int k = 1; k < 6; k++) {
    sum2 += concrete_v[k] / (concrete_d[k] * concrete_d[k]);
    sum3 += concrete_v[k] / (concrete_d[k] * concrete_d[k] * concrete_d[k]);
  }
  NEAR("plane", gh_sieve_least(s, 2), ceil(sum2 / (38. / 256)), 0);
  NEAR("space", gh_sieve_least(s, 3), ceil(sum3 / (38. / 4096)), 0);
  for (int dim = 2; dim <= 3; dim++) {
    int n = (int)gh_sieve_least(s, dim);
    char words[32];
    snprintf(words, sizeof words, "at least %d", n);
    FAILS(gh_sieve_counts(ctx, s, dim, n - 1, count), GH_INPUT, words);
    OK(gh_sieve_counts(ctx, s, dim, n, count));
    for (int k = 0; k < 5; k++) assert_true(count[k] >= 1);
    assert_int_equal(count[5], 0);
  }
  gh_sieve_destroy(&s);
}

/* Counts are used unchanged, and scaled without loss: Table 5.1 from 150 to 300 and 600 grains. */
static void counts(void **state) {
  static const double d[] = {0.1, 0.125, 0.16, 0.25}, v[] = {35, 74, 40, 1};
  gh_context *ctx = *state;
  gh_sieve *s = make(ctx, GH_SIEVE_COUNT, 4, d, v);
  int count[4], n, *type;
  double *diameter;
  NEAR("least", gh_sieve_least(s, 2), 150, 0);
  for (int times = 0; times <= 4; times++) {
    OK(gh_sieve_counts(ctx, s, 2, 150 * times, count));
    for (int k = 0; k < 4; k++) NEAR("count", count[k], (times ? times : 1) * v[k], 0);
  }
  FAILS(gh_sieve_counts(ctx, s, 2, 149, count), GH_INPUT, "at least 150");
  OK(gh_sieve_counts(ctx, s, 2, 0, count));
  OK(gh_sieve_grains(ctx, s, count, &n, &diameter, &type));
  assert_int_equal(n, 150);
  for (int i = 0; i < n; i++) {
    int k = i < 1 ? 3 : i < 41 ? 2 : i < 115 ? 1 : 0;
    assert_int_equal(type[i], k + 1);
    assert_true(diameter[i] == d[k]);
  }
  free(diameter);
  free(type);
  gh_sieve_destroy(&s);
}

/* Whatever the total, counts add up to it and differ from the exact share by less than one grain. */
static void rounding(void **state) {
  gh_context *ctx = *state;
  gh_sieve *s = make(ctx, GH_SIEVE_VOLUME, 7, quartz_d, quartz_v);
  for (int dim = 2; dim <= 3; dim++) {
    double share[7];
    gh_sieve_shares(s, dim, share);
    for (int total = (int)gh_sieve_least(s, dim); total < 3000; total += 7) {
      int count[7], sum = 0;
      OK(gh_sieve_counts(ctx, s, dim, total, count));
      for (int k = 0; k < 7; k++) {
        sum += count[k];
        assert_true(fabs(count[k] - share[k] * total) < 1);
      }
      assert_int_equal(sum, total);
    }
  }
  gh_sieve_destroy(&s);
}

static void refused(gh_context *ctx, gh_sieve_kind kind, int n, const double *d, const double *v,
                    const char *words) {
  gh_sieve *s;
  FAILS(gh_sieve_create(ctx, kind, n, d, v, &s), GH_INPUT, words);
  assert_null(s);
}

/* Wrong curves are refused with the value and what it must be. */
static void wrong_curves(void **state) {
  gh_context *ctx = *state;
  const double d[] = {1, 2, 3}, same[] = {1, 2, 2}, turn[] = {1, 3, 2}, zero[] = {0, 1, 2},
               nan[] = {1, NAN, 3};
  refused(ctx, GH_SIEVE_COUNT, 3, zero, (double[]){1, 1, 1}, "diameter is 0");
  refused(ctx, GH_SIEVE_COUNT, 3, nan, (double[]){1, 1, 1}, "diameter is nan");
  refused(ctx, GH_SIEVE_COUNT, 3, same, (double[]){1, 1, 1}, "must rise, or fall");
  refused(ctx, GH_SIEVE_COUNT, 3, turn, (double[]){1, 1, 1}, "must rise, or fall");
  refused(ctx, GH_SIEVE_COUNT, 3, d, (double[]){1, -1, 1}, "count is -1");
  refused(ctx, GH_SIEVE_COUNT, 3, d, (double[]){1, 1.5, 1}, "whole number");
  refused(ctx, GH_SIEVE_COUNT, 3, d, (double[]){0, 0, 0}, "without grains");
  refused(ctx, GH_SIEVE_COUNT, 0, d, d, "at least one row");
  refused(ctx, GH_SIEVE_VOLUME, 3, d, (double[]){10, 101, -11}, "at most 100");
  refused(ctx, GH_SIEVE_VOLUME, 3, d, (double[]){10, 20, 30}, "their sum is 60");
  refused(ctx, GH_SIEVE_PASSING, 3, d, (double[]){10, 5, 100}, "must not fall");
  refused(ctx, GH_SIEVE_PASSING, 3, d, (double[]){10, 20, 90}, "it ends at 90");
  refused(ctx, GH_SIEVE_PASSING, 3, d, (double[]){10, 20, 120}, "at most 100");
}

static void write_file(const char *path, const char *text) {
  FILE *f = fopen(path, "w");
  assert_non_null(f);
  fputs(text, f);
  fclose(f);
}

/* Files: the kind comes from the column, messages carry file and line. */
static void files(void **state) {
  gh_context *ctx = *state;
  gh_sieve *s;
  char path[] = "/tmp/granhom-sieve-XXXXXX";
  int fd = mkstemp(path);
  assert_true(fd >= 0);
  close(fd);
  write_file(path, "diameter,count\n2,3\n1,7\n");
  OK(gh_sieve_read(ctx, path, &s));
  assert_int_equal(s->kind, GH_SIEVE_COUNT);
  assert_true(s->n == 2 && s->diameter[0] == 1 && s->amount[0] == 7 && s->amount[1] == 3);
  gh_sieve_destroy(&s);
  write_file(path, "passing,diameter\n# comment\n40,1\n100,2\n");
  OK(gh_sieve_read(ctx, path, &s));
  assert_int_equal(s->kind, GH_SIEVE_PASSING);
  assert_true(s->amount[0] == 40 && s->amount[1] == 60);
  gh_sieve_destroy(&s);
  write_file(path, "diameter,count\n2,3\n1,-7\n");
  FAILS(gh_sieve_read(ctx, path, &s), GH_INPUT, ":3: count is -7");
  write_file(path, "diameter,count,passing\n2,3,100\n");
  FAILS(gh_sieve_read(ctx, path, &s), GH_INPUT, "exclude each other");
  write_file(path, "diameter,number\n2,3\n");
  FAILS(gh_sieve_read(ctx, path, &s), GH_INPUT, "needs one of the columns");
  write_file(path, "size,count\n2,3\n");
  FAILS(gh_sieve_read(ctx, path, &s), GH_INPUT, "needs the column 'diameter'");
  write_file(path, "diameter,count\n");
  FAILS(gh_sieve_read(ctx, path, &s), GH_INPUT, "");
  unlink(path);
  FAILS(gh_sieve_read(ctx, path, &s), GH_INPUT, path);
}

/* The curve of `passing` with its pan and in percent: 0.25, 0.5, 1, 2 pass 10, 40, 80, 100. */
static void assert_curve(gh_context *ctx, const char *path, const char *text) {
  static const double diameter[] = {0.25, 0.5, 1, 2}, amount[] = {10, 30, 40, 20};
  gh_sieve *s;
  write_file(path, text);
  if (gh_sieve_read(ctx, path, &s) != GH_OK) fail_msg("%s: %s", text, gh_message(ctx));
  assert_int_equal(s->kind, GH_SIEVE_PASSING);
  assert_int_equal(s->n, 4);
  assert_memory_equal(s->diameter, diameter, sizeof diameter);
  assert_memory_equal(s->amount, amount, sizeof amount);
  gh_sieve_destroy(&s);
}

/* Tables as laboratories and spreadsheets write them are the same curve. */
static void tables_of_laboratories(void **state) {
  static const char *const texts[] = {
      "diameter,passing\n0.25,10\n0.5,40\n1.0,80\n2.0,100\n",
      "diameter;passing\n0,25;10,0\n0,5;40,0\n1,0;80,0\n2,0;100,0\n",
      "diameter;passing\n0.25;10\n0.5;40\n1.0;80\n2.0;100\n",
      "diameter\tpassing\n0,25\t10\n0,5\t40\n1\t80\n2\t100\n",
      "\"diameter\",\"passing\"\n\"0.25\",\"10\"\n\"0.5\",\"40\"\n\"1.0\",\"80\"\n\"2.0\",\"100\"\n",
      "diameter,passing,\n0.25,10,\n0.5,40,\n1.0,80,\n2.0,100,\n,,\n",
      "diameter,passing\n0.25,10%\n0.5,40 %\n1.0,80%\n2.0,100%\n",
      "diameter,passing\nmm,%\n0.25,10\n0.5,40\n1.0,80\n2.0,100\n",
      "diameter,passing\n[mm],[%]\n0.25,10\n0.5,40\n1.0,80\n2.0,100\n",
      ("\xEF\xBB\xBF"
       "diameter [mm],passing [%]\r\n0.25,10\r\n0.5,40\r\n1.0,80\r\n2.0,100\r\n"),
      "d (mm);Passing (%)\n0,25;10\n0,5;40\n1;80\n2;100\n",
      "Sieve size (mm),Percent passing\n2,100\n1,80\n0.5,40\n0.25,10\nPan,0\n",
      "diameter,passing\n0,0\n0.25,10\n0.5,40\n1.0,80\n2.0,100\n",
      "diameter,passing\n2,100\n1,80\n0.5,40\n0.25,10\n0,0\n",
      "id,diameter,passing\n1,2,100\n2,1,80\n3,0.5,40\n4,0.25,10\n",
      /* what each sieve retains, and what it and all coarser ones retain */
      "diameter,retained\n2,0\n1,20\n0.5,40\n0.25,30\npan,10\n",
      "diameter,retained\n0,10\n0.25,30\n0.5,40\n1,20\n2,0\n",
      "diameter,retained\n2,0\n1,20\n0.5,40\n0.25,30\n",
      "diameter;retained_individual [%]\n2;0\n1;20\n0,5;40\n0,25;30\n",
      "diameter,retained\n2,0%\n1,20%\n0.5,60%\n0.25,90%\npan,100%\n",
      "diameter,retained\n2,0\n1,20\n0.5,60\n0.25,90\n",
      "diameter,cumulative percent retained\n2,0\n1,20\n0.5,60\n0.25,90\n",
      "d [mm],% retained cumulative\n0.25,90\n0.5,60\n1,20\n2,0\n"};
  char path[] = "/tmp/granhom-sieve-XXXXXX";
  int fd = mkstemp(path);
  assert_true(fd >= 0);
  close(fd);
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) assert_curve(*state, path, texts[k]);
  unlink(path);
}

/* What may mean two things, or leaves the size of grains open, is refused with its reason. */
static void tables_in_doubt(void **state) {
  static const char *const faults[][2] = {
      {"diameter,retained\n2,0\n1,10\n0.5,20\n0.25,30\n", "retained_individual or retained_cumulative"},
      {"diameter,retained_individual\n2,0\n1,60\n0.5,60\n", "must add up to 100; the sum is 120"},
      {"diameter,retained_individual\n2,0\n1,60\n0.5,20\npan,10\n", "must add up to 100; the sum is 90"},
      {"diameter,retained_cumulative\n2,0\n1,60\n0.5,20\n",
       "must rise from the coarsest sieve to the finest"},
      {"diameter,retained\n2,0\n1,60\n0.5,20\n0.25,50\n",
       "neither adds up to 100 percent (the sum is 130) nor rises"},
      {"diameter,retained\n2,10\n1,60\n0.5,30\n",
       ":2: retained is 10, but nothing limits the size of grains above"},
      {"diameter,retained\n2,0\n1,-5\n0.5,30\n", ":3: retained is -5, it must be within 0 and 100"},
      {"diameter,retained\n2,0\n1,500\n0.5,300\n", ":3: retained is 500, it must be within 0 and 100"},
      {"diameter,retained\n2,0\n1,20\n1,30\n", ":4: diameter is 1, the diameters must rise, or fall"},
      {"diameter,passing\n0,5\n1,40\n2,100\n", ":2: diameter is 0, it must be positive"},
      {"diameter,passing,retained\n1,40,60\n2,100,0\n", "'passing' and 'retained' exclude each other"},
      {"diameter [%],passing\n1,40\n2,100\n", "'diameter [%]' is in percent"},
      {"d,diameter,passing\n1,1,40\n2,2,100\n", "'d' and 'diameter' exclude each other"},
      {"diameter,count\n1,40%\n2,100%\n", "'count' is in percent"},
      {"diameter;passing\n1,000;40\n2.5;100\n", "a decimal comma, and a decimal point in line 3"}};
  gh_context *ctx = *state;
  gh_sieve *s;
  char path[] = "/tmp/granhom-sieve-XXXXXX";
  int fd = mkstemp(path);
  assert_true(fd >= 0);
  close(fd);
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    write_file(path, faults[k][0]);
    FAILS(gh_sieve_read(ctx, path, &s), GH_INPUT, faults[k][1]);
  }
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(quartz_table),   TEST(concrete_table), TEST(passing),
                                     TEST(least),          TEST(counts),         TEST(rounding),
                                     TEST(wrong_curves),   TEST(files),          TEST(tables_of_laboratories),
                                     TEST(tables_in_doubt)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
