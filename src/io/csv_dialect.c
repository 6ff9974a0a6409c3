/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dialects of CSV files: separators, quotes, decimal commas, units. */
#include "io/csv.h"

#include <string.h>
#include <strings.h>

static bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

/* ---- fields ---- */

/* How often a character stands outside quotes in the first n characters. */
static int count_outside(const char *line, size_t n, char wanted) {
  int count = 0;
  bool inside = false;
  for (size_t k = 0; k < n && line[k]; k++) {
    if (line[k] == '"') inside = !inside;
    count += !inside && line[k] == wanted;
  }
  return count;
}

static int count_words(const char *line, size_t n) {
  int count = 0;
  for (size_t k = 0; k < n && line[k]; k++) count += !is_blank(line[k]) && (k == 0 || is_blank(line[k - 1]));
  return count;
}

int gh_table_count(const gh_table *t, const char *line) {
  if (t->separator == ' ') return count_words(line, strlen(line));
  return 1 + count_outside(line, strlen(line), t->separator);
}

/* The line that gh_reader_line would give if it passed over blank lines and comments; *n: its length. */
static const char *peek_line(const gh_reader *r, size_t *n) {
  for (const char *line = r->next; *line; line += *n + (line[*n] == '\n')) {
    *n = strcspn(line, "\n");
    size_t blank = strspn(line, " \t\r");
    if (blank < *n && line[blank] != '#') return line;
  }
  *n = 0;
  return "";
}

gh_status gh_table_separator(gh_table *t, const char *header) {
  static const char candidates[] = ",;\t";
  size_t n, whole = strlen(header);
  const char *row = peek_line(&t->r, &n);
  char present = 0, agreed = 0;
  int presents = 0, agrees = 0;
  for (int k = 2; k >= 0;
       k--) { /* of a comma and a tab that agree the comma wins: blanks around fields are allowed */
    int in_header = count_outside(header, whole, candidates[k]);
    if (in_header == 0) continue;
    present = candidates[k];
    presents++;
    if (in_header != count_outside(row, n, candidates[k])) continue;
    if (agreed != '\t') agrees++;
    agreed = candidates[k];
  }
  t->separator = agreed ? agreed : present ? present : ',';
  if (presents > 1 && strspn(header, "0123456789+-.,; \t") == whole)
    t->separator = ';'; /* no names: decimal commas */
  else if (presents > 1 && agrees > 1)
    return GH_TABLE_FAIL(t, "%s", "',' and ';' may both separate the columns here; put the names in quotes");
  int words = count_words(header, whole);
  bool with_row = words == count_words(row, n - (n > 0 && row[n - 1] == '\r')),
       with_comment = t->comment && words == count_words(t->comment, strlen(t->comment)); /* a single row */
  if (!presents && words > 1 && (with_row || with_comment)) t->separator = ' ';
  return GH_OK;
}

/* Takes the quotes off in place; *end: behind the closing one, NULL when there is none. */
static char *unquote(char *text, char **end) {
  char *to = text, *from = text + 1;
  for (; *from; *to++ = *from++) {
    if (*from != '"') continue;
    if (from[1] != '"') break;
    from++;
  }
  *end = *from ? from + 1 : NULL;
  *to = 0;
  return gh_trim(text);
}

gh_status gh_table_field(gh_table *t, char **rest, char **field) {
  char *begin = *rest, *end;
  if (t->separator != '\t') begin += strspn(begin, " \t");
  else begin += strspn(begin, " ");
  t->quoted = *begin == '"' && t->separator != ' ';
  if (t->quoted) {
    *field = unquote(begin, &end);
    if (!end) return GH_TABLE_FAIL(t, "%s", "a quote that does not end in this line");
    while (*end && *end != t->separator && is_blank(*end)) end++;
    if (*end && *end != t->separator)
      return GH_TABLE_FAIL(t, "%s", "text behind a closing quote (a quote within quotes is written twice)");
    *rest = end + (*end != 0);
    return GH_OK;
  }
  end = begin + strcspn(begin, t->separator == ' ' ? " \t" : (char[2]){t->separator, 0});
  *rest = end + (*end != 0);
  *end = 0;
  *field = gh_trim(begin);
  return GH_OK;
}

bool gh_table_trails(const gh_table *t, const char *line, int n) {
  bool inside = false;
  if (t->separator == ' ' || gh_table_count(t, line) <= (n ? n : 1)) return false;
  for (; *line && n > 0; line++) {
    if (*line == '"') inside = !inside;
    n -= !inside && *line == t->separator;
  }
  for (; *line; line++)
    if (!is_blank(*line) && *line != t->separator && *line != '"') return false;
  return true;
}

/* ---- numbers ---- */

/* 1,000 and 12,345: a comma may stand between thousands; 0,250 is none of these. */
static bool may_group(const char *text) {
  if (*text == '+' || *text == '-') text++;
  size_t n = strcspn(text, ",");
  return n >= 1 && n <= 3 && *text != '0' && strspn(text, "0123456789") == n &&
         strspn(text + n + 1, "0123456789") == 3 && !text[n + 4];
}

bool gh_table_number(gh_table *t, char *text, double *value) {
  if (gh_parse_number(text, value)) {
    if (!t->point && strchr(text, '.')) t->point = t->r.line;
    return true;
  }
  char *comma = strchr(text, ',');
  if (!comma || (t->separator == ',' && !t->quoted) || strchr(text, '.') || strchr(comma + 1, ','))
    return false;
  bool group = may_group(text);
  *comma = '.';
  if (gh_parse_number(text, value)) {
    if (!t->comma) t->comma = t->r.line;
    t->surely_decimal = t->surely_decimal || !group;
    return true;
  }
  *comma = ',';
  return false;
}

bool gh_table_percent(gh_table *t, char *text, double *value) {
  size_t n = strlen(text);
  if (n < 2 || text[n - 1] != '%') return false;
  text[n - 1] = 0;
  if (gh_table_number(t, gh_trim(text), value)) return true;
  text[n - 1] = '%';
  return false;
}

gh_status gh_table_check(const gh_table *t) {
  if (!t->comma) return GH_OK;
  if (t->point)
    return gh_fail(t->ctx, GH_INPUT,
                   "%s:%d: a decimal comma, and a decimal point in line %d; one of them is wanted", t->r.path,
                   t->comma, t->point);
  if (t->surely_decimal || t->separator == ';') return GH_OK;
  return gh_fail(
      t->ctx, GH_INPUT,
      "%s:%d: a comma that may be a decimal comma or stand between thousands; write decimal points, or "
      "no sign between thousands",
      t->r.path, t->comma);
}

/* ---- units ---- */

bool gh_is_unit(const char *text) {
  static const char *const units[] = {
      "%",   "-",    "--",     "1",      "percent", "Percent", "wt%",       "wt.%",      "wt-%", "M.-%",
      "M-%", "vol%", "Vol.-%", "Gew.-%", "nm",      "um",      "\xC2\xB5m", "\xCE\xBCm", "mm",   "cm",
      "dm",  "m",    "in",     "inch",   "N",       "kN",      "MN",        "N/m",       "kN/m", "N/mm",
      "Pa",  "kPa",  "MPa",    "GPa",    "N/mm2",   "N/mm^2",  "kN/m2",     "kN/m^2",    "N/m2", "N/m^2",
      "s",   "min",  "h",      "rad",    "J",       "1/s",     "m/s",       "mm/s"};
  size_t n = strlen(text);
  double number;
  if (gh_parse_number(text, &number)) return false;
  if (n > 2 && ((text[0] == '[' && text[n - 1] == ']') || (text[0] == '(' && text[n - 1] == ')')))
    return true;
  for (size_t k = 0; k < sizeof units / sizeof *units; k++)
    if (strcmp(text, units[k]) == 0) return true;
  return false;
}

bool gh_unit_percent(const char *unit) {
  return strchr(unit, '%') != NULL || strcasecmp(unit, "percent") == 0 ||
         strcasecmp(unit, "[percent]") == 0 || strcasecmp(unit, "(percent)") == 0;
}
