/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of numbers in text. */
#include "test_io.h"

#include <float.h>
#include <limits.h>
#include <locale.h>

/* Decimal numbers of every form are read as the compiler reads them. */
static void numbers_are_read(void **state) {
  static const struct {
    const char *text;
    double value;
  } good[] = {{"0", 0},
              {"1e-8", 1e-8},
              {".5", .5},
              {"+3", 3},
              {"5.", 5.},
              {"-1.25E+2", -125},
              {"010", 10},
              {"0.1", 0.1},
              {"1e-400", 0},
              {"4.9406564584124654e-324", 4.9406564584124654e-324},
              {"1.7976931348623157e308", DBL_MAX}};
  (void)state;
  for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
    double v = -77;
    assert_true(gh_parse_number(good[k].text, &v));
    assert_true(v == good[k].value);
  }
}

/* What is no decimal number, or not finite, is refused and leaves the value alone. */
static void other_texts_are_no_numbers(void **state) {
  static const char *const bad[] = {"",          " ",     " 1",  "1 ",  "1x",  "0x10", "nan", "inf",
                                    "-Infinity", "1e999", "1e",  "e5",  ".",   "+",    "--1", "1,5",
                                    "1_0",       "1.2.3", "1d3", "1e+", "\t1", "1\n"};
  double v = 42;
  (void)state;
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) assert_false(gh_parse_number(bad[k], &v));
  assert_false(gh_parse_number(NULL, &v));
  assert_true(v == 42);
}

/* Every double written with 17 digits comes back bit by bit. */
static void seventeen_digits_are_enough(void **state) {
  uint64_t seed = 20240607, bits = seed;
  (void)state;
  print_message("seed %llu\n", (unsigned long long)seed);
  for (int k = 0; k < 20000; k++) {
    double v, w;
    char text[40];
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    memcpy(&v, &bits, sizeof v);
    if (!isfinite(v)) continue;
    snprintf(text, sizeof text, "%.17g", v);
    assert_true(gh_parse_number(text, &w));
    assert_memory_equal(&v, &w, sizeof v);
  }
}

/* Integers are whole texts within their range. */
static void integers_are_read(void **state) {
  static const char *const bad[] = {
      "", "+", "1.0", "1e3", " 1", "1 ", "0x1", "a", "11", "-11", "99999999999999999999"};
  long v = 42;
  (void)state;
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) assert_false(gh_parse_integer(bad[k], -10, 10, &v));
  assert_false(gh_parse_integer(NULL, -10, 10, &v));
  assert_int_equal(v, 42);
  assert_true(gh_parse_integer("+10", -10, 10, &v));
  assert_int_equal(v, 10);
  assert_true(gh_parse_integer("-010", -10, 10, &v));
  assert_int_equal(v, -10);
  assert_true(gh_parse_integer("9223372036854775807", LONG_MIN, LONG_MAX, &v));
  assert_true(v == LONG_MAX);
}

/* A program with a decimal comma in its locale reads and writes points all the same. */
static void the_locale_does_not_matter(void **state) {
  static const char *const names[] = {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8", "nl_NL.UTF-8"};
  place *p = *state;
  double v;
  size_t n;
  gh_text *text;
  bool found = false;
  for (int k = 0; k < 4 && !found; k++) found = setlocale(LC_NUMERIC, names[k]) != NULL;
  if (!found)
    print_message("no locale with a decimal comma on this machine: read and written in the usual one\n");
  assert_true(gh_parse_number("1.5", &v) && v == 1.5);
  assert_false(gh_parse_number("1,5", &v));
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  gh_text_print(text, "%g", 2.5);
  assert_string_equal(gh_text_get(text, &n), "2.5");
  gh_text_destroy(&text);
  setlocale(LC_NUMERIC, "C");
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(numbers_are_read), TEST(other_texts_are_no_numbers),
                                     TEST(seventeen_digits_are_enough), TEST(integers_are_read),
                                     TEST(the_locale_does_not_matter)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
