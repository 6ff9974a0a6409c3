/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Options as the text of `granhom help`. */
#include "options.h"

#include <string.h>

enum { WIDTH = 100, COLUMN = 26 };

/* The words of one line, of which `at` columns are written; what is broken off starts at `column`. */
static void line_wrap(FILE *out, const char *text, size_t length, int at, int column) {
  const char *end = text + length;
  for (bool first = true; text < end; first = false) {
    const char *blank = memchr(text, ' ', (size_t)(end - text));
    const int word = (int)((blank ? blank : end) - text);
    if (!first && at + 1 + word > WIDTH) {
      fprintf(out, "\n%*s", column, "");
      at = column;
    } else if (!first) {
      fputc(' ', out);
      at++;
    }
    fprintf(out, "%.*s", word, text);
    at += word;
    text += word + 1;
  }
}

/* Lines of text, the first one where the output stands, the others at `column`. */
static void text_wrap(FILE *out, const char *text, int column) {
  for (bool first = true; *text; first = false) {
    const size_t length = strcspn(text, "\n");
    const int blanks = (int)strspn(text, " ");
    if (length > 0 && (size_t)blanks < length) {
      if (!first && column) fprintf(out, "%*s", column, "");
      fprintf(out, "%*s", blanks, "");
      line_wrap(out, text + blanks, length - (size_t)blanks, column + blanks, column + blanks);
    }
    fputc('\n', out);
    text += length + (text[length] == '\n');
  }
}

void help_print(FILE *out, const char *text) {
  text_wrap(out, text, 0);
}

/* The value before options are read or, where that is none that the option can have, `standard`. */
static void default_print(char text[128], const option_row *row, const void *group) {
  const void *place = (const char *)group + row->place;
  *text = 0;
  if (row->kind == OPTION_TEXT && *(const char *const *)place)
    snprintf(text, 128, " (default %s)", *(const char *const *)place);
  else if (row->kind == OPTION_NUMBER && isfinite(*(const double *)place) &&
           (row->zero || *(const double *)place > 0))
    snprintf(text, 128, " (default %g)", *(const double *)place);
  else if (row->kind == OPTION_LONG && *(const long *)place >= row->low)
    snprintf(text, 128, " (default %ld)", *(const long *)place);
  else if (row->kind == OPTION_INTEGER && *(const int *)place >= row->low)
    snprintf(text, 128, " (default %d)", *(const int *)place);
  else if (row->kind == OPTION_CHOICE && *(const int *)place >= 0)
    snprintf(text, 128, " (default %s)", row->words[*(const int *)place]);
  else if (row->standard) snprintf(text, 128, " (default %s)", row->standard);
}

void option_text(const option_row *row, const void *group, char text[OPTION_MOST_TEXT]) {
  char standard[128];
  default_print(standard, row, group);
  snprintf(text, OPTION_MOST_TEXT, "%s%s", row->help, standard);
}

static void row_print(FILE *out, const option_row *row, const void *group) {
  char left[80], letter[8] = "", help[OPTION_MOST_TEXT];
  if (row->kind == OPTION_HEADING) {
    fprintf(out, "\n%s\n", row->help);
    return;
  }
  if (row->letter) snprintf(letter, sizeof letter, "-%c, ", row->letter);
  const char *dashes = row->name[0] == '-' ? "" : "--";
  int length =
      snprintf(left, sizeof left, "  %s%s%s%s%s%s", letter, dashes, row->name, row->argument ? " " : "",
               row->optional ? "[" : "", row->argument ? row->argument : "");
  if (row->optional) length += snprintf(left + length, sizeof left - (size_t)length, "]");
  option_text(row, group, help);
  fprintf(out, "%s", left);
  if (length + 2 > COLUMN) fprintf(out, "\n%*s", COLUMN, "");
  else fprintf(out, "%*s", COLUMN - length, "");
  text_wrap(out, help, COLUMN);
}

void options_print(FILE *out, const option_group *groups, const void *arguments) {
  for (; groups->rows; groups++)
    for (const option_row *row = groups->rows; row->name; row++)
      row_print(out, row, (const char *)arguments + groups->place);
}
