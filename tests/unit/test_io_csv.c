/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of CSV files. */
#include "test_io.h"

#include <fcntl.h>

/* Spaces, comments, blank lines, CR LF, a byte order mark and a missing last line end are no obstacles; lines
 * are counted as in the file. */
static void a_table_is_read(void **state) {
  place *p = *state;
  const char *path = put_file(
      p, "a.csv", "\xEF\xBB\xBF# a comment\r\n\r\nstep , F11,F12\r\n0, 1 ,-2e-3\r\n\r\n  # more\r\n1,.5,+3");
  gh_csv *csv;
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_OK);
  assert_int_equal(csv->nrows, 2);
  assert_int_equal(csv->ncols, 3);
  assert_int_equal(gh_csv_find(csv, "step"), 0);
  assert_int_equal(gh_csv_find(csv, "F12"), 2);
  assert_int_equal(gh_csv_find(csv, "F13"), -1);
  static const double wanted[] = {0, 1, -2e-3, 1, .5, 3};
  assert_memory_equal(csv->value, wanted, sizeof wanted);
  assert_int_equal(csv->line[0], 4);
  assert_int_equal(csv->line[1], 7);
  gh_csv_destroy(&csv);
  assert_null(csv);
  gh_csv_destroy(&csv);
}

/* A header without rows is a table of no rows. */
static void no_rows_is_a_table(void **state) {
  place *p = *state;
  gh_csv *csv;
  assert_int_equal(gh_csv_read(p->ctx, put_file(p, "a.csv", "step,F11\n"), &csv), GH_OK);
  assert_int_equal(csv->nrows, 0);
  assert_int_equal(csv->ncols, 2);
  gh_csv_destroy(&csv);
}

/* The path of a reference case has the rows that it is known to have: 0.999 in both directions at the second.
 */
static void a_path_of_the_cases_is_read(void **state) {
  place *p = *state;
  gh_csv *csv;
  assert_int_equal(gh_csv_read(p->ctx, "tests/data/cases/paths/biax1_shear5.csv", &csv), GH_OK);
  assert_int_equal(csv->ncols, 5);
  assert_true(csv->nrows >= 2);
  assert_true(csv->value[5 + gh_csv_find(csv, "F11")] == 0.999);
  assert_true(csv->value[5 + gh_csv_find(csv, "F22")] == 0.999);
  gh_csv_destroy(&csv);
}

/* Numbers written with 17 digits come back bit by bit, thousands of rows of them. */
static void a_round_trip_is_bitwise(void **state) {
  enum { N = 3000 };
  place *p = *state;
  static double value[N][2];
  gh_text *text;
  gh_csv *csv;
  srand(7);
  print_message("seed 7\n");
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  gh_text_print(text, "a,b\n");
  for (int k = 0; k < N; k++) {
    value[k][0] = (rand() - RAND_MAX / 2) / 3.0, value[k][1] = 1e-300 * rand();
    gh_text_print(text, "%.17g,%.17g\n", value[k][0], value[k][1]);
  }
  const char *path = in_folder(p, "a.csv");
  assert_int_equal(gh_text_commit(text, path), GH_OK);
  gh_text_destroy(&text);
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_OK);
  assert_int_equal(csv->nrows, N);
  assert_memory_equal(csv->value, value, sizeof value);
  gh_csv_destroy(&csv);
}

/* "-" is standard input, and messages say so. */
static void standard_input_is_read(void **state) {
  place *p = *state;
  gh_csv *csv;
  int kept = dup(0), fd = open(put_file(p, "a.csv", "a\n1\nx\n"), O_RDONLY);
  assert_true(kept >= 0 && fd >= 0 && dup2(fd, 0) == 0);
  gh_status s = gh_csv_read(p->ctx, "-", &csv);
  dup2(kept, 0);
  close(kept);
  close(fd);
  assert_int_equal(s, GH_INPUT);
  assert_message(p, "standard input", ":3: a: 'x' is not a finite number");
}

/* Each fault has its message with file and line. */
static void faults_have_messages(void **state) {
  static const struct {
    const char *text, *message;
  } faults[] = {
      {"", ": the file is empty"},
      {"# nothing\n\n", ": no header line: only blank lines and comments"},
      {"a,b\n1,2\n3\n", ":3: 1 fields in this row, 2 columns in the header"},
      {"a,b\n1,2,3\n", ":2: 3 fields in this row, 2 columns in the header"},
      {"a,b\n1,\n", ":2: b is empty"},
      {"a,,c\n", ":1: column 2 has no name"},
      {"a,b,a\n", ":1: column 'a' occurs twice"},
      {"1,2\n3,4\n", ":1: the first line must name the columns, but column 1 is the number '1'"},
      {"a\nnan\n", ":2: a: 'nan' is not a finite number"},
      {"a\n1e999\n", ":2: a: '1e999' is not a finite number"},
      {"a\n1 2\n", ":2: a: '1 2' is not a finite number"},
      {"a\n\x1b[31m\n", ":2: a: '?[31m' is not a finite number"},
      {"a\n\"1\" x\n", ":2: text behind a closing quote (a quote within quotes is written twice)"},
      {"a\n\"1\n", ":2: a quote that does not end in this line"},
  };
  place *p = *state;
  gh_csv *csv;
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    const char *path = put_file(p, "a.csv", faults[k].text);
    assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_INPUT);
    assert_null(csv);
    assert_message(p, path, faults[k].message);
  }
}

/* Missing files, folders, zero bytes, devices without end. */
static void what_is_no_text_file_is_refused(void **state) {
  place *p = *state;
  gh_csv *csv;
  const char *path = in_folder(p, "none.csv");
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_INPUT);
  assert_message(p, path, ": cannot be opened: No such file or directory");
  assert_int_equal(gh_csv_read(p->ctx, p->folder, &csv), GH_INPUT);
  assert_message(p, p->folder, ": is a folder, a file is wanted");
  path = put_bytes(p, "a.csv", "a\n1\n\0\0", 6);
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_INPUT);
  assert_message(p, path, ":3: not a text file: it holds a zero byte");
  assert_int_equal(gh_csv_read(p->ctx, "/dev/zero", &csv), GH_INPUT);
  assert_message(p, "/dev/zero", ":1: not a text file: it holds a zero byte");
}

/* A line of a megabyte is cut in the message, also within a character of several bytes. */
static void long_lines_are_cut_in_messages(void **state) {
  enum { N = 1 << 20 };
  place *p = *state;
  gh_csv *csv;
  char *text = malloc(N + 3);
  memset(text, 'x', N + 2);
  memcpy(text, "a\n", 2);
  text[N + 2] = 0;
  const char *path = put_file(p, "a.csv", text);
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_INPUT);
  assert_message(
      p, path,
      ":2: a: 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...' is not a finite number");
  for (int k = 0; k < 100; k++) memcpy(text + 3 + 2 * k, "\xC3\xBC", 2);
  path = put_file(p, "a.csv", text);
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_INPUT);
  const char *cut = strstr(gh_message(p->ctx), "...");
  assert_non_null(cut);
  assert_int_equal((unsigned char)cut[-1], 0xBC);
  memset(text, ',', N);
  path = put_file(p, "a.csv", text);
  assert_int_equal(gh_csv_read(p->ctx, path, &csv), GH_INPUT);
  assert_message(p, path, ":1: 1048577 columns, at most 10000 are possible");
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(a_table_is_read),
                                     TEST(no_rows_is_a_table),
                                     TEST(a_path_of_the_cases_is_read),
                                     TEST(a_round_trip_is_bitwise),
                                     TEST(standard_input_is_read),
                                     TEST(faults_have_messages),
                                     TEST(what_is_no_text_file_is_refused),
                                     TEST(long_lines_are_cut_in_messages)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
