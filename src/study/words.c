/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Numbers and names as people read them. */
#include "io/file.h"
#include "study/judge.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers ---- */

/* "3.10e-03" becomes "3.10e-3", "1.20e+06" "1.20e6", "123." "123". */
static void number_tidy(char *text) {
  char *e = strchr(text, 'e'), *end;
  if (e) {
    long exponent = strtol(e + 1, &end, 10);
    snprintf(e + 1, 8, "%ld", exponent);
  }
  size_t n = strlen(text);
  if (n > 0 && text[n - 1] == '.') text[n - 1] = 0;
}

static study_word number_word(const char *format, double value) {
  study_word w = {"-"};
  if (isnan(value)) return w;
  gh_c_locale l = gh_c_locale_begin();
  snprintf(w.text, sizeof w.text, format, value);
  gh_c_locale_end(l);
  number_tidy(w.text);
  return w;
}

study_word study_error_word(double error) {
  return number_word(error == 0 ? "%.0f" : error < 0.1 || error >= 1000 ? "%.2e" : "%#.3g", error);
}

study_word study_seconds_word(double seconds) {
  return number_word(seconds >= 1000 ? "%.0f" : seconds == 0 ? "%.0f" : "%#.3g", seconds);
}

study_word study_count_word(double count) {
  return number_word(count < 1e4 ? "%.4g" : "%.2e", count);
}

study_word study_order_word(double order) {
  return number_word("%.2f", order);
}

study_word study_goal_word(double goal) {
  return goal > 0.99e-4 ? number_word("%g %%", 100 * goal) : number_word("%g", goal);
}

/* ---- names ---- */

static void print_letter(gh_text *out, study_style style, char letter) {
  gh_text_print(out, style == STUDY_MARKDOWN && strchr("*|<`\\", letter) ? "\\%c" : "%c",
                letter == '\n' ? ' ' : letter);
}

void study_print_escaped(gh_text *out, study_style style, const char *text) {
  for (; *text; text++) print_letter(out, style, *text);
}

/* ---- values without quotes ---- */

/* What stands between the quotes of a value that is one text in quotes; else all of it. */
static const char *between_quotes(const char *value, const char **end) {
  const char *last = value + 1;
  *end = value + strlen(value);
  if (*value != '"') return value;
  while (*last && *last != '"') last += *last == '\\' && last[1] ? 2 : 1;
  if (*last != '"' || last[1]) return value;
  *end = last;
  return value + 1;
}

/* The next letter; a backslash before quotes and backslashes is passed over between quotes. */
static char next_letter(const char **at, bool quoted) {
  if (quoted && **at == '\\' && ((*at)[1] == '"' || (*at)[1] == '\\')) ++*at;
  return *(*at)++;
}

const char *study_plain(const char *value, char *text, size_t size) {
  const char *end, *at = between_quotes(value, &end);
  size_t n = 0;
  for (const bool quoted = at > value; at < end && n + 1 < size;) text[n++] = next_letter(&at, quoted);
  text[n] = 0;
  return text;
}

void study_print_plain(gh_text *out, study_style style, const char *value) {
  const char *end, *at = between_quotes(value, &end);
  for (const bool quoted = at > value; at < end;) print_letter(out, style, next_letter(&at, quoted));
}

/* ---- names of configurations ---- */

__attribute__((format(printf, 3, 4))) static void name_append(char *text, size_t size, const char *format,
                                                              ...) {
  size_t n = strlen(text);
  va_list args;
  va_start(args, format);
  vsnprintf(text + n, size - n, format, args);
  va_end(args);
}

static bool parameter_varied(const gh_study *s, int parameter) {
  for (int k = 0; k < s->nparameters; k++)
    if (s->parameters[k].nvalues > 1) return s->parameters[parameter].nvalues > 1;
  return true; /* a study of one configuration names all its parameters */
}

int study_varied_parameter(const gh_study *s, int i) {
  for (int k = 0; k < s->nparameters; k++)
    if (parameter_varied(s, k) && i-- == 0) return k;
  return -1;
}

void study_name(const gh_study *s, int config, int except, char *text, size_t size) {
  const study_config *g = s->configs + config;
  char value[STUDY_CELL];
  *text = 0;
  for (int k = 0; k < s->nparameters; k++)
    if (k != except && (parameter_varied(s, k) || g->choice[k] < 0))
      name_append(text, size, "%s%s %s", *text ? ", " : "", s->parameters[k].name,
                  study_plain(g->value[k], value, sizeof value));
  if (g->also && *g->also) name_append(text, size, "%s%s", *text ? ", " : "", g->also);
}

void study_short_value(const gh_study *s, int config, int parameter, char *text, size_t size) {
  char value[STUDY_CELL];
  const char *slash = strrchr(study_plain(s->configs[config].value[parameter], value, sizeof value), '/');
  bool file = strcmp(s->parameters[parameter].name, "packing") == 0;
  snprintf(text, size, "%s", file && slash ? slash + 1 : value);
  size_t n = strlen(text);
  if (file && n > 5 && strcmp(text + n - 5, ".data") == 0) text[n - 5] = 0;
}

/* The last part of a parameter's name, or all of it where another parameter ends alike. */
static const char *short_name(const gh_study *s, int parameter) {
  const char *dot = strrchr(s->parameters[parameter].name, '.'),
             *name = dot ? dot + 1 : s->parameters[parameter].name;
  for (int k = 0; k < s->nparameters; k++) {
    const char *other = strrchr(s->parameters[k].name, '.');
    if (k != parameter && strcmp(other ? other + 1 : s->parameters[k].name, name) == 0)
      return s->parameters[parameter].name;
  }
  return name;
}

void study_legend(const gh_study *s, int config, int except, char *text, size_t size) {
  char value[128];
  *text = 0;
  for (int k = 0; k < s->nparameters; k++) {
    if (k == except || !parameter_varied(s, k)) continue;
    study_short_value(s, config, k, value, sizeof value);
    /* words speak for themselves; numbers and yes or no need their name */
    bool bare = s->parameters[k].nvalues > 0 && isnan(s->parameters[k].number[0]) &&
                strcmp(value, "true") != 0 && strcmp(value, "false") != 0 && *value != '[';
    name_append(text, size, "%s%s%s%s", *text ? ", " : "", bare ? "" : short_name(s, k), bare ? "" : " ",
                value);
  }
}
