/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tables of cells, as Markdown and in plain columns. */
#include "study/judge.h"

/* Characters, not bytes, of UTF-8. */
static int width_of(const char *text) {
  int n = 0;
  for (; *text; text++) n += ((unsigned char)*text & 0xc0) != 0x80;
  return n;
}

static int column_width(const study_table *t, int column) {
  char text[STUDY_CELL];
  int width = 0;
  for (int row = -1; row < t->rows; row++) {
    t->cell(t, row, column, text);
    if (width_of(text) > width) width = width_of(text);
  }
  return width;
}

static void print_plain(const study_table *t, gh_text *out) {
  char text[STUDY_CELL];
  for (int row = -1; row < t->rows; row++) {
    for (int c = 0; c < t->columns; c++) {
      bool right = t->cell(t, row, c, text);
      int pad = column_width(t, c) - width_of(text);
      if (c > 0) gh_text_print(out, "  ");
      if (right) gh_text_print(out, "%*s%s", pad, "", text);
      else gh_text_print(out, c + 1 < t->columns ? "%s%*s" : "%s", text, pad, "");
    }
    gh_text_print(out, "\n");
  }
}

static void print_markdown(const study_table *t, gh_text *out) {
  char text[STUDY_CELL];
  for (int row = -1; row < t->rows; row++) {
    for (int c = 0; c < t->columns; c++) {
      t->cell(t, row, c, text);
      gh_text_print(out, "| ");
      study_print_escaped(out, STUDY_MARKDOWN, text);
      gh_text_print(out, " ");
    }
    gh_text_print(out, "|\n");
    for (int c = 0; c < t->columns && row < 0; c++)
      gh_text_print(out, t->cell(t, row, c, text) ? "| ---: " : "| --- ");
    if (row < 0) gh_text_print(out, "|\n");
  }
}

void study_print_table(const study_table *t, study_style style, gh_text *out) {
  (style == STUDY_MARKDOWN ? print_markdown : print_plain)(t, out);
}
