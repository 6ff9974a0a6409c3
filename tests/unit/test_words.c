/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Texts that are not the program's own: control characters, strings of gnuplot, columns of sets. */
#include "../help.h"

#include "io/file.h"
#include "report/gnuplot.h"
#include "granhom/results.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void test_unprintable(void **state) {
  static const struct {
    const char *text, *name;
  } rows[] = {{"", NULL},
              {"plain text, 100 % & 'more'", NULL},
              {"\xc3\xa9 \xe2\x88\x92 \xf0\x9f\x8f\x96", NULL}, /* e with an accent, minus, a beach */
              {"\xc2\xa0", NULL},                               /* a blank that does not break */
              {"a\nb", "a line break"},
              {"a\r", "a line break"},
              {"\ta", "a tab"},
              {"a\x1b[31m", "the control character U+001B"},
              {"\x01", "the control character U+0001"},
              {"a\x7f", "the control character U+007F"},
              {"a\xc2\x85", "the control character U+0085"},
              {"a\xe2\x80\xa8", "the control character U+2028"},
              {"a\xe2\x80\xae", "the control character U+202E"},
              {"a\xe9", "bytes that are not UTF-8"},
              {"a\xc3", "bytes that are not UTF-8"},
              {"\xc0\x8a", "bytes that are not UTF-8"},     /* a line break, longer than it may be */
              {"\xed\xa0\x80", "bytes that are not UTF-8"}, /* half of a pair of UTF-16 */
              {"\xff\xfe", "bytes that are not UTF-8"}};
  char name[GH_QUOTE];
  (void)state;
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    const char *found = gh_unprintable(rows[k].text, name);
    if (!found != !rows[k].name || (found && strcmp(found, rows[k].name) != 0))
      fail_msg("row %zu: %s", k, found ? found : "nothing");
  }
}

static void test_string(void **state) {
  gh_text *t;
  gh_context *ctx = *state;
  OK(gh_text_create(ctx, &t));
  gh_picture_string(t, "a'\"`!\n");
  assert_string_equal(gh_text_get(t, NULL), "\"\\141\\047\\042\\140\\041\\077\"");
  OK(gh_text_set(t, "", 0));
  gh_picture_string(t, "\xc3\xa9");
  assert_string_equal(gh_text_get(t, NULL), "\"\\303\\251\"");
  gh_text_destroy(&t);
}

/* Scripts with a command of the shell are not even given to gnuplot. */
static void test_script(void **state) {
  static const char *const bad[] = {"!touch PWNED\n", "set title \"`touch PWNED`\"\n",
                                    "x = system('touch PWNED')\n", "@x\n", "set title 'a\rb'\n"};
  char png[] = "/tmp/granhom-words-XXXXXX";
  int fd = mkstemp(png);
  assert_true(fd >= 0);
  close(fd);
  unlink(png);
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    assert_int_equal(report_gnuplot(*state, bad[k], png), GH_SYSTEM);
    assert_non_null(strstr(gh_message(*state), "holds a command of the shell"));
    assert_int_equal(access(png, F_OK), -1);
    assert_int_equal(access("PWNED", F_OK), -1);
  }
}

static void test_column(void **state) {
  char text[GH_COLUMN], long_name[300];
  (void)state;
  assert_string_equal(gh_column_name("left", text), "left");
  assert_string_equal(gh_column_name("Line 7.a-b/\xc3\xa9", text), "Line_7.a-b/\xc3\xa9");
  assert_string_equal(gh_column_name(" a, \"b\" 'c'", text), "_a___b___c_");
  assert_string_equal(gh_dataset_name("a/b c", text), "a_b_c");
  assert_string_equal(gh_dataset_name(".", text), "_");
  memset(long_name, 'x', sizeof long_name);
  long_name[299] = 0;
  assert_int_equal(strlen(gh_column_name(long_name, text)), GH_COLUMN - 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_unprintable), TEST(test_string), TEST(test_script),
                                     TEST(test_column)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
