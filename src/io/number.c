/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Numbers in text: strict, finite, independent of the locale. */
#include "io/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

gh_c_locale gh_c_locale_begin(void) {
  gh_c_locale l = {.ours = newlocale(LC_ALL_MASK, "C", (locale_t)0), .theirs = (locale_t)0};
  if (l.ours) l.theirs = uselocale(l.ours);
  return l;
}

void gh_c_locale_end(gh_c_locale l) {
  if (!l.ours) return;
  uselocale(l.theirs);
  freelocale(l.ours);
}

static const char *digits(const char *p, int *count) {
  for (; *p >= '0' && *p <= '9'; p++) ++*count;
  return p;
}

/* [+-] digits [. digits] [e [+-] digits], at least one digit before the exponent. strtod alone would take
 * hexadecimal numbers, "nan" and leading blanks, too. */
static bool is_decimal(const char *p) {
  int mantissa = 0, exponent = 0;
  if (*p == '+' || *p == '-') p++;
  p = digits(p, &mantissa);
  if (*p == '.') p = digits(p + 1, &mantissa);
  if (mantissa == 0) return false;
  if (*p == 'e' || *p == 'E') {
    p++;
    if (*p == '+' || *p == '-') p++;
    p = digits(p, &exponent);
    if (exponent == 0) return false;
  }
  return *p == 0;
}

bool gh_parse_number(const char *text, double *value) {
  if (!text || !is_decimal(text)) return false;
  char *end;
  gh_c_locale l = gh_c_locale_begin();
  double v = strtod(text, &end);
  gh_c_locale_end(l);
  if (*end || !isfinite(v)) return false; /* 1e999 */
  *value = v;
  return true;
}

bool gh_parse_integer(const char *text, long low, long high, long *value) {
  if (!text) return false;
  int count = 0;
  if (*digits(*text == '+' || *text == '-' ? text + 1 : text, &count) || count == 0) return false;
  errno = 0;
  long v = strtol(text, NULL, 10);
  if (errno == ERANGE || v < low || v > high) return false;
  *value = v;
  return true;
}

/* Digits, signs, blanks and the characters of `more` alone. */
static bool made_of_digits(const char *text, const char *more) {
  for (; *text; text++)
    if (!(*text >= '0' && *text <= '9') && !strchr("+-. ", *text) && !strchr(more, *text)) return false;
  return true;
}

const char *gh_number_hint(const char *text) {
  if (strstr(text, "\xE2\x88\x92")) return " (its sign is U+2212; a hyphen-minus is wanted)";
  if (strstr(text, "\xC2\xA0") || strstr(text, "\xE2\x80\xAF"))
    return " (it holds a blank that does not break)";
  if (strchr(text, ',') && made_of_digits(text, ",eE"))
    return " (a comma: a decimal point is wanted, and no sign between thousands)";
  if (strpbrk(text, "dD") && made_of_digits(text, "dD")) return " (an exponent of Fortran; e is wanted)";
  return "";
}
