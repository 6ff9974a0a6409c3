/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The key of curves.png: gnuplot's own one may cover panels, so it is made of labels and arrows. */
#include "study/draw.h"

#include <string.h>

/* Pixels: of a letter, about; of the line before a name, and between two entries. */
enum { LETTER = 10, SAMPLE = 42, GAP = 24 };

/* ---- entries ---- */

static void key_add(study_key *key, const char *text, const char *more, study_line line, bool heading) {
  if (key->n == STUDY_ENTRIES) return;
  key->entry[key->n].heading = heading;
  key->entry[key->n].line = line;
  snprintf(key->entry[key->n++].text, STUDY_NAME, "%.200s%s", text, more); /* cut later to what fits */
}

static const char *reference_mark(const gh_study *s, int k) {
  return study_is_reference(s, k) ? " (reference)" : "";
}

/* What has no colour of its own is named together. */
static void add_others(const study_rows *r, study_key *key) {
  for (int k = 0; k < r->s->nconfigs; k++)
    if (r->colour[k] >= STUDY_COLOURS) {
      key_add(key, "others", "", (study_line){study_colour(STUDY_COLOURS), 1, 1.1}, false);
      return;
    }
}

static void add_curves(const study_rows *r, study_key *key) {
  char name[STUDY_NAME];
  study_line line;
  for (int k = 0; k < r->s->nconfigs; k++) {
    if (r->group[k] < 0 || r->colour[k] >= STUDY_COLOURS || !study_rows_line(r, 0, k, &line)) continue;
    study_legend(r->s, k, -1, name, sizeof name);
    key_add(key, name, reference_mark(r->s, k), line, false);
  }
}

/* Values of the series; the names of the rows state which of them are references. */
static void add_series(const study_rows *r, study_key *key) {
  char name[STUDY_NAME];
  study_line line;
  const study_parameter *parameter = r->s->parameters + r->s->series;
  key_add(key, parameter->name, "", (study_line){"", 1, 0}, true);
  for (int v = 0; v < parameter->nvalues && v < STUDY_COLOURS; v++) {
    int some = -1;
    for (int k = r->s->nconfigs - 1; k >= 0; k--)
      if (r->colour[k] == v) some = k;
    if (some < 0) continue;
    study_rows_line(r, r->group[some], some, &line);
    study_short_value(r->s, some, r->s->series, name, sizeof name);
    key_add(key, name, "", line, false);
  }
}

static void add_compared(const study_rows *r, study_key *key) {
  char name[STUDY_NAME];
  study_line line;
  key_add(key, "comparison", "", (study_line){"", 1, 0}, true);
  for (int k = 0; k < r->s->nconfigs; k++) {
    if (r->group[k] < 0 || !study_rows_line(r, r->ngroups, k, &line)) continue;
    study_legend(r->s, k, r->s->series, name, sizeof name);
    key_add(key, name, reference_mark(r->s, k), line, false);
  }
}

static void add_references(const study_rows *r, study_key *key) {
  study_line line;
  if (r->extra >= 0 && study_rows_line(r, 0, r->extra, &line)) key_add(key, "reference", "", line, false);
  if (study_rows_given(r, &line))
    key_add(key, r->s->reference_text ? r->s->reference_text : "reference", "", line, false);
}

/* Shorter by whole letters of UTF-8. */
static void text_cut(char *text, int letters) {
  if ((int)strlen(text) <= letters) return;
  int n = letters > 3 ? letters - 3 : 0;
  while (n > 0 && ((unsigned char)text[n] & 0xC0) == 0x80) n--;
  memcpy(text + n, "...", 4);
}

void study_key_plan(const study_rows *r, int left, int width, study_key *key) {
  *key = (study_key){.left = left, .width = width};
  if (r->grouped) add_series(r, key);
  else add_curves(r, key);
  add_others(r, key);
  for (int k = 0; k < key->n; k++) {
    int letters = (int)strlen(key->entry[k].text);
    if (!key->entry[k].heading && letters > key->letters) key->letters = letters;
  }
  add_references(r, key);
  if (r->compared >= 0) add_compared(r, key);
  for (int k = 0; k < key->n; k++) text_cut(key->entry[k].text, (width - SAMPLE) / LETTER);
}

/* ---- places ---- */

static int column_width(const study_key *key) {
  return SAMPLE + LETTER * key->letters + GAP;
}

/* Line and column of an entry: as many columns as fit, of which a longer name takes more than one; headings
 * have lines of their own. */
static void key_place(const study_key *key, int entry, int *line, int *column) {
  int columns = (key->width + GAP) / column_width(key), next = 0;
  if (columns < 1) columns = 1;
  *line = *column = 0;
  for (int k = 0; k <= entry; k++) {
    int pixels = SAMPLE + LETTER * (int)strlen(key->entry[k].text) + GAP;
    int wide = (pixels + column_width(key) - 1) / column_width(key);
    bool heading = key->entry[k].heading, after = k > 0 && key->entry[k - 1].heading;
    if (k > 0 && (heading || after || next + wide > columns)) ++*line, next = 0;
    *column = next;
    next += wide;
  }
}

int study_key_height(const study_key *key) {
  int line, column;
  if (key->n == 0) return 0;
  key_place(key, key->n - 1, &line, &column);
  return STUDY_KEY_LINE * (line + 1);
}

void study_key_print(const study_key *key, int bottom, int picture_width, int picture_height, gh_text *t) {
  const double w = picture_width, h = picture_height;
  int top = bottom + study_key_height(key), line, column;
  for (int k = 0; k < key->n; k++) {
    key_place(key, k, &line, &column);
    bool heading = key->entry[k].heading;
    const study_line *l = &key->entry[k].line;
    double x = key->left + column * column_width(key);
    double y = top - STUDY_KEY_LINE * (line + 0.5);
    if (!heading)
      gh_text_print(t,
                    "set arrow from screen %.5f, screen %.5f to screen %.5f, screen %.5f nohead lc rgb '%s' "
                    "lw %g dt %d\n",
                    x / w, y / h, (x + SAMPLE - 8) / w, y / h, l->colour, 1.4 * l->width, l->dash);
    gh_text_print(t, "set label ");
    gh_picture_string(t, key->entry[k].text);
    gh_text_print(t, " at screen %.5f, screen %.5f left noenhanced%s\n", (heading ? x : x + SAMPLE) / w,
                  y / h, heading ? " font ':Bold'" : "");
  }
}
