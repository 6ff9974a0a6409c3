/* SPDX-License-Identifier: GPL-2.0-or-later */
/* CSV files as spreadsheets and other programs write them. */
#include "test_io.h"

#include <time.h>

/* The table is a, b = 0.25, 10; 0.5, 40.5. */
static void assert_table(place *p, const char *text) {
  static const double wanted[] = {0.25, 10, 0.5, 40.5};
  gh_csv *csv;
  if (gh_csv_read(p->ctx, put_file(p, "a.csv", text), &csv) != GH_OK)
    fail_msg("%s: %s", text, gh_message(p->ctx));
  assert_int_equal(csv->ncols, 2);
  if (csv->nrows != 2) fail_msg("%s: %d rows", text, csv->nrows);
  assert_int_equal(gh_csv_find(csv, "a"), 0);
  assert_int_equal(gh_csv_find(csv, "b"), 1);
  assert_memory_equal(csv->value, wanted, sizeof wanted);
  gh_csv_destroy(&csv);
}

/* Separators, decimal commas, quotes, trailing separators, rows of separators, units, headers in comments. */
static void dialects_are_read(void **state) {
  static const char *const texts[] = {
      "a,b\n0.25,10\n0.5,40.5\n",
      "a;b\n0.25;10\n0.5;40.5\n",
      "a;b\n0,25;10,0\n0,5;40,5\n",
      "a;b\n0,25;10\n,5;4,05E+1\n",
      "a\tb\n0.25\t10\n0.5\t40.5\n",
      "a\tb\n0,25\t10\n0,5\t40,5\n",
      "a,\tb\n0.25,\t10\n0.5,\t40.5\n",
      "a b\n0.25 10\n0.5   40.5\n",
      "\"a\",\"b\"\n\"0.25\",\"10\"\n\"0.5\",\"40.5\"\n",
      "\"a\",\"b\"\n\"0,25\",\"10\"\n\"0,5\" , \"40,5\"\n",
      "\"a\";\"b\"\n\"0,25\";10\n0,5;\"40,5\"\n",
      "a,b,\n0.25,10,\n0.5,40.5,\n",
      "a,b,,\n0.25,10,,\n0.5,40.5,,\n,,,\n",
      "a;b\n0,25;10;\n0,5;40,5;;\n;\n;;\n",
      "a,b\n0.25,10\n,\n\"\",\n0.5,40.5\n",
      "sep=;\na;b\n0,25;10\n0,5;40,5\n",
      "a,b\nmm,kPa\n0.25,10\n0.5,40.5\n",
      "a;b\n[mm];[-]\n0,25;10\n0,5;40,5\n",
      "a,b\n,(N)\n0.25,10\n0.5,40.5\n",
      "a [mm],b (kPa)\n0.25,10\n0.5,40.5\n",
      "# made by hand\n# a,b\n0.25,10\n0.5,40.5\n",
      "# a b\n0.25 10\n0.5 40.5\n",
      "# remark, with commas\na,b\n0.25,10\n0.5,40.5\n",
      ("\xEF\xBB\xBF"
       "a;b\r\n0,25;10\r\n\r\n0,5;40,5\r\n"),
      "a,b\r0.25,10\r0.5,40.5\r",
  };
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) assert_table(*state, texts[k]);
}

static void assert_refused(place *p, const char *text, const char *message) {
  const char *path = put_file(p, "a.csv", text);
  gh_csv *csv;
  if (gh_csv_read(p->ctx, path, &csv) != GH_INPUT) fail_msg("%s is read", text);
  assert_null(csv);
  assert_message(p, path, message);
}

/* What may mean two things is refused, and what the separator or the comma has to do with it is said. */
static void doubts_are_refused(void **state) {
  place *p = *state;
  assert_refused(
      p, "a,b\n0,25,10,0\n",
      ":2: 4 fields in this row, 2 columns in the header; with decimal commas the separator must be ';' "
      "or a tab");
  assert_refused(
      p, "a,b\n0,25;10,0\n",
      ":2: 3 fields in this row, 2 columns in the header; the row and the header have different separators");
  assert_refused(
      p, "a;b\n1,2\n",
      ":2: 1 fields in this row, 2 columns in the header; the row and the header have different separators");
  assert_refused(p, "a;b,c\n1;2,5\n",
                 ":1: ',' and ';' may both separate the columns here; put the names in quotes");
  assert_refused(p, "a;b\n0,25;10.5\n",
                 ":2: a decimal comma, and a decimal point in line 2; one of them is wanted");
  assert_refused(p, "a;b\n1.5;2\n\n2;0,5\n",
                 ":4: a decimal comma, and a decimal point in line 2; one of them is wanted");
  assert_refused(
      p, "a\tb\n1,000\t2\n",
      ":2: a comma that may be a decimal comma or stand between thousands; write decimal points, or no sign "
      "between thousands");
  assert_refused(
      p, "a,b\n\"12,345\",2\n",
      ":2: a comma that may be a decimal comma or stand between thousands; write decimal points, or no sign "
      "between thousands");
  assert_refused(
      p, "a;b\n1,234.5;2\n",
      ":2: a: '1,234.5' is not a finite number (a comma: a decimal point is wanted, and no sign between "
      "thousands)");
  assert_refused(
      p, "a;b\n1.234,5;2\n",
      ":2: a: '1.234,5' is not a finite number (a comma: a decimal point is wanted, and no sign between "
      "thousands)");
  assert_refused(p,
                 "a,b\n\xE2\x88\x92"
                 "1,2\n",
                 ":2: a: '\xE2\x88\x92"
                 "1' is not a finite number (its sign is U+2212; a hyphen-minus is wanted)");
  assert_refused(p, "a,b\n5%,2\n", ":2: a: '5%' is not a finite number");
  assert_refused(p, "a,b\n-,%\n1,2\n", ":2: b is in percent by its unit; a number that needs none is wanted");
  assert_refused(p, "a,b\n1,2\nmm,mm\n", ":3: a: 'mm' is not a finite number");
  assert_refused(
      p, "a,b\n1,2,3,\n",
      ":2: 4 fields in this row, 2 columns in the header; with decimal commas the separator must be ';' or "
      "a tab");
  assert_refused(p, "0,25;10\n0,5;40\n",
                 ":1: the first line must name the columns, but column 1 is the number '0.25'");
  assert_refused(p, "a,b\npan,2\n", ":2: a: 'pan' is not a finite number");
  assert_refused(p, "sep=|\na|b\n", ":1: the separator is '|'; wanted is ',', ';' or a tab");
  assert_refused(p, ",\n1,2\n", ":1: column 1 has no name");
}

/* A column in percent is not found by its name alone: F11 [%] is a hundred times F11. */
static void percent_is_no_number(void **state) {
  place *p = *state;
  gh_csv *csv;
  const char *path = put_file(p, "a.csv", "a [%],b [m],b [mm],c (-)\n1,2,3,4\n");
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_OK);
  assert_int_equal(gh_csv_find(csv, "a"), -1);
  assert_int_equal(gh_csv_find(csv, "b"), -1);
  assert_int_equal(gh_csv_find(csv, "b [mm]"), 2);
  assert_int_equal(gh_csv_find(csv, "c"), 3);
  gh_csv_destroy(&csv);
  path = put_file(p, "b.csv", "a;b\nmm;%\n1,5;10 %\npan;0%\n");
  assert_int_equal(gh_csv_read_with(p->ctx, path, GH_CSV_PERCENT | GH_CSV_PAN, &csv), GH_OK);
  static const double wanted[] = {1.5, 10, 0, 0};
  assert_memory_equal(csv->value, wanted, sizeof wanted);
  assert_false(csv->percent[0]);
  assert_true(csv->percent[1]);
  gh_csv_destroy(&csv);
}

/* Ten thousand columns are compared by sorting, a hundred thousand rows by none. */
static void many_columns_and_rows(void **state) {
  enum { COLUMNS = 10000, ROWS = 300000 };
  place *p = *state;
  gh_csv *csv;
  const char *path = in_folder(p, "wide.csv");
  FILE *f = fopen(path, "w");
  assert_non_null(f);
  for (int c = 0; c < COLUMNS; c++) fprintf(f, "%scolumn%d", c ? ";" : "", c);
  for (int row = 0; row < 3; row++)
    for (int c = 0; c < COLUMNS; c++) fprintf(f, "%s%d,5", c ? ";" : "\n", c);
  assert_int_equal(fclose(f), 0);
  clock_t begin = clock();
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_OK);
  assert_true(csv->value[2 * COLUMNS + 7] == 7.5);
  gh_csv_destroy(&csv);
  f = fopen(path = in_folder(p, "long.csv"), "w");
  assert_non_null(f);
  fprintf(f, "a;b\n");
  for (int row = 0; row < ROWS; row++) fprintf(f, "%d,25;;\n;\n%d;1\n", row, row);
  assert_int_equal(fclose(f), 0);
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_INPUT);
  assert_message(p, path, ":2: b is empty");
  f = fopen(path, "w");
  assert_non_null(f);
  fprintf(f, "a;b\n");
  for (int row = 0; row < ROWS; row++) fprintf(f, "%d,25;1;\n;\n", row);
  assert_int_equal(fclose(f), 0);
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_OK);
  assert_int_equal(csv->nrows, ROWS);
  assert_true(csv->value[2 * (ROWS - 1)] == ROWS - 0.75);
  gh_csv_destroy(&csv);
  double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
  print_message("%.2f s\n", seconds);
  if (!getenv("SANITIZED")) assert_true(seconds < 5);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(dialects_are_read), TEST(doubts_are_refused),
                                     TEST(percent_is_no_number), TEST(many_columns_and_rows)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
