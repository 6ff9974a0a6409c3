/* Numbers and names as people read them. SPDX-License-Identifier: GPL-2.0-or-later */
#include "io/file.h"
#include "study/judge.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers ---- */

/* "3.10e-03" becomes "3.10e-3", "1.20e+06" "1.20e6", "123." "123". */
static void tidy(char *text) {
  char *e = strchr(text, 'e'), *end;
  if (e) {
    long exponent = strtol(e + 1, &end, 10);
    snprintf(e + 1, 8, "%ld", exponent);
  }
  size_t n = strlen(text);
  if (n > 0 && text[n - 1] == '.') text[n - 1] = 0;
}

static study_word word(const char *format, double value) {
  study_word w = {"-"};
  if (isnan(value)) return w;
  gh_c_locale l = gh_c_locale_begin();
  snprintf(w.text, sizeof w.text, format, value);
  gh_c_locale_end(l);
  tidy(w.text);
  return w;
}

study_word study_error_word(double error) {
  return word(error == 0 ? "%.0f" : error < 0.1 || error >= 1000 ? "%.2e" : "%#.3g", error);
}

study_word study_seconds_word(double seconds) {
  return word(seconds >= 1000 ? "%.0f" : seconds == 0 ? "%.0f" : "%#.3g", seconds);
}

study_word study_count_word(double count) {
  return word(count < 1e4 ? "%.4g" : "%.2e", count);
}

study_word study_order_word(double order) {
  return word("%.2f", order);
}

study_word study_goal_word(double goal) {
  return goal > 0.99e-4 ? word("%g %%", 100 * goal) : word("%g", goal);
}

/* ---- names ---- */

void study_print_escaped(gh_text *out, study_style style, const char *text) {
  for (; *text; text++)
    gh_text_print(out, style == STUDY_MARKDOWN && strchr("*|<`\\", *text) ? "\\%c" : "%c",
                  *text == '\n' ? ' ' : *text);
}

__attribute__((format(printf, 3, 4))) static void append(char *text, size_t size, const char *format, ...) {
  size_t n = strlen(text);
  va_list args;
  va_start(args, format);
  vsnprintf(text + n, size - n, format, args);
  va_end(args);
}

static bool varied(const gh_study *s, int knob) {
  for (int k = 0; k < s->nknobs; k++)
    if (s->knobs[k].nvalues > 1) return s->knobs[knob].nvalues > 1;
  return true; /* a study of one setting names all its knobs */
}

int study_varied_knob(const gh_study *s, int i) {
  for (int k = 0; k < s->nknobs; k++)
    if (varied(s, k) && i-- == 0) return k;
  return -1;
}

void study_name(const gh_study *s, int setting, int except, char *text, size_t size) {
  const study_setting *g = s->settings + setting;
  *text = 0;
  for (int k = 0; k < s->nknobs; k++)
    if (k != except && (varied(s, k) || g->choice[k] < 0))
      append(text, size, "%s%s %s", *text ? ", " : "", s->knobs[k].name, g->value[k]);
  if (g->also && *g->also) append(text, size, "%s%s", *text ? ", " : "", g->also);
}

void study_short_value(const gh_study *s, int setting, int knob, char *text, size_t size) {
  const char *value = s->settings[setting].value[knob], *slash = strrchr(value, '/');
  if (strcmp(s->knobs[knob].name, "packing") != 0) {
    snprintf(text, size, "%s", value);
    return;
  }
  snprintf(text, size, "%s", slash ? slash + 1 : value);
  char *dot = strrchr(text, '.');
  if (dot && dot > text) *dot = 0;
}

void study_legend(const gh_study *s, int setting, int except, char *text, size_t size) {
  char value[128];
  *text = 0;
  for (int k = 0; k < s->nknobs; k++) {
    if (k == except || !varied(s, k)) continue;
    study_short_value(s, setting, k, value, sizeof value);
    /* words speak for themselves; numbers and yes or no need their name */
    bool bare = s->knobs[k].nvalues > 0 && isnan(s->knobs[k].number[0]) && strcmp(value, "true") != 0 &&
                strcmp(value, "false") != 0 && *value != '[';
    const char *dot = strrchr(s->knobs[k].name, '.'), *name = dot ? dot + 1 : s->knobs[k].name;
    append(text, size, "%s%s%s%s", *text ? ", " : "", bare ? "" : name, bare ? "" : " ", value);
  }
}
