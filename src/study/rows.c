/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The table of configurations that people read. */
#include "study/judge.h"

#include <string.h>

typedef enum kind {
  PARAMETER,
  ERROR,
  CHANCE,
  SINGLE,
  LARGEST,
  OTHER,
  PACKINGS,
  CORE,
  COUNT,
  ORDER,
  FRONT,
  NO_KIND
} kind;

/* Which columns this study needs: kind and index (parameter, quantity) of column c. */
static kind column_kind(const gh_study *s, int c, int *index) {
  const int ensemble = study_has_ensembles(s);
  int parameters = 0;
  while (study_varied_parameter(s, parameters) >= 0) parameters++;
  const struct {
    kind kind;
    int count;
  } parts[] = {{PARAMETER, parameters}, {ERROR, 1},   {CHANCE, ensemble},
               {SINGLE, ensemble},      {LARGEST, 1}, {OTHER, s->nquantities - 1},
               {PACKINGS, ensemble},    {CORE, 1},    {COUNT, study_counts(s) != STUDY_NOTHING},
               {ORDER, s->order >= 0},  {FRONT, 1}};
  for (size_t p = 0; p < sizeof parts / sizeof *parts; c -= parts[p++].count)
    if (c < parts[p].count) {
      *index = parts[p].kind == PARAMETER ? study_varied_parameter(s, c) : c;
      if (parts[p].kind == OTHER && c >= s->main) *index = c + 1;
      return parts[p].kind;
    }
  return NO_KIND;
}

static int config_of(const gh_study *s, int row) {
  for (int k = 0; k < s->nconfigs; k++)
    if (!s->configs[k].extra && row-- == 0) return k;
  return -1;
}

static bool has_note(const gh_study *s, int k) {
  return !study_is_reference(s, k)
             ? s->verdict->row[k].why || s->verdict->row[k].members < s->configs[k].nruns
             : s->verdict->row[k].members < s->configs[k].nruns;
}

/* Number of the foot line of a row; 0: it has none. */
static int note_of(const gh_study *s, int config) {
  int n = 0;
  if (!has_note(s, config)) return 0;
  for (int k = 0; k <= config; k++) n += !s->configs[k].extra && has_note(s, k);
  return n;
}

static void head(const gh_study *s, kind what, int index, char text[STUDY_CELL]) {
  switch (what) {
  case PARAMETER:
    snprintf(text, STUDY_CELL, "%s", s->parameters[index].name);
    break;
  case ERROR:
    snprintf(text, STUDY_CELL, "error of the %s", s->quantities[s->main].name);
    break;
  case CHANCE:
    snprintf(text, STUDY_CELL, "+- 95 %%");
    break;
  case SINGLE:
    snprintf(text, STUDY_CELL, "single packing");
    break;
  case LARGEST:
    snprintf(text, STUDY_CELL, "largest");
    break;
  case OTHER:
    snprintf(text, STUDY_CELL, "%s", s->quantities[index].name);
    break;
  case PACKINGS:
    snprintf(text, STUDY_CELL, "packings");
    break;
  case CORE:
    snprintf(text, STUDY_CELL, "seconds");
    break;
  case COUNT:
    snprintf(text, STUDY_CELL, "%s", study_count_name(study_counts(s)));
    break;
  case ORDER:
    snprintf(text, STUDY_CELL, "order");
    break;
  case FRONT:
    snprintf(text, STUDY_CELL, "front");
    break;
  case NO_KIND:
    *text = 0;
    break;
  }
}

static void error_cell(const gh_study *s, int k, char text[STUDY_CELL]) {
  const study_judged *row = s->verdict->row + k;
  const char *word = study_is_reference(s, k) ? "reference" : NULL;
  if (row->members == 0) {
    bool finished = s->configs[k].nruns > 0;
    for (int m = 0; m < s->configs[k].nruns; m++) finished = finished && s->configs[k].runs[m].finished;
    word = finished ? "failed" : "not run";
  }
  study_word number = study_error_word(row->l2[s->main]);
  int note = note_of(s, k);
  snprintf(text, STUDY_CELL, "%s", word ? word : number.text);
  size_t n = strlen(text);
  if (note) snprintf(text + n, STUDY_CELL - n, " [%d]", note);
}

static const char *front_word(const study_judged *row) {
  return row->pareto ? (row->pareto_count ? "both" : "time") : row->pareto_count ? "work" : "";
}

static void cell(const gh_study *s, kind what, int index, int k, char text[STUDY_CELL]) {
  const study_judged *row = s->verdict->row + k;
  study_word w = {""};
  switch (what) {
  case PARAMETER:
    study_plain(s->configs[k].value[index], text, STUDY_CELL);
    return;
  case ERROR:
    error_cell(s, k, text);
    return;
  case PACKINGS:
    snprintf(text, STUDY_CELL, "%d of %d", row->members, s->configs[k].nruns);
    return;
  case FRONT:
    snprintf(text, STUDY_CELL, "%s", front_word(row));
    return;
  case CHANCE:
    w = study_error_word(row->chance[s->main]);
    break;
  case SINGLE:
    w = study_error_word(row->single[s->main]);
    break;
  case LARGEST:
    w = study_error_word(row->largest[s->main]);
    break;
  case OTHER:
    w = study_error_word(row->l2[index]);
    break;
  case CORE:
    w = study_seconds_word(row->core);
    break;
  case COUNT:
    w = study_count_word(row->members ? study_count_of(s, k) : NAN);
    break;
  case ORDER:
    w = study_order_word(row->order);
    break;
  case NO_KIND:
    break;
  }
  snprintf(text, STUDY_CELL, "%s", w.text);
}

static bool config_cell(const study_table *t, int row, int column, char text[STUDY_CELL]) {
  int index = 0;
  kind what = column_kind(t->s, column, &index);
  if (row < 0) head(t->s, what, index, text);
  else cell(t->s, what, index, config_of(t->s, row), text);
  return what != PARAMETER && what != FRONT;
}

/* Why a run has no result. */
static void print_failure(const gh_study *s, int k, study_style style, gh_text *out) {
  const study_config *g = s->configs + k;
  int failed = 0, waiting = 0;
  const char *message = NULL;
  for (int m = 0; m < g->nruns; m++) {
    const study_run *r = g->runs + m;
    if (study_run_done(r)) continue;
    if (!r->finished) waiting++;
    else failed++;
    if (r->finished && !message) message = *r->message ? r->message : gh_status_text(r->status);
  }
  if (failed > 0) {
    if (g->nruns > 1) gh_text_print(out, " %d of %d packings failed, the first with:", failed, g->nruns);
    gh_text_print(out, " ");
    study_print_escaped(out, style, message);
    gh_text_print(out, ".");
  }
  if (waiting > 0 && g->nruns > 1) gh_text_print(out, " %d of %d packings were not run.", waiting, g->nruns);
  else if (waiting > 0) gh_text_print(out, " It was not run.");
}

static void print_foot(const gh_study *s, int k, study_style style, gh_text *out) {
  char name[STUDY_CELL];
  const study_judged *row = s->verdict->row + k;
  study_name(s, k, -1, name, sizeof name);
  gh_text_print(out, "%s", style == STUDY_MARKDOWN ? "- " : "");
  if (s->configs[k].extra) gh_text_print(out, "reference ");
  else gh_text_print(out, "[%d] ", note_of(s, k));
  study_print_escaped(out, style, name);
  gh_text_print(out, ":");
  print_failure(s, k, style, out);
  if (row->why && row->members > 0) gh_text_print(out, " Not compared: %s.", row->why);
  gh_text_print(out, "\n");
}

void study_print_rows(const gh_study *s, study_style style, gh_text *out) {
  study_table t = {.s = s, .cell = config_cell};
  int index, notes = 0;
  while (config_of(s, t.rows) >= 0) t.rows++;
  while (column_kind(s, t.columns, &index) != NO_KIND) t.columns++;
  study_print_table(&t, style, out);
  for (int k = 0; k < s->nconfigs; k++) { /* references that have no row of their own stand behind the rows */
    if (!has_note(s, k)) continue;
    if (notes++ == 0) gh_text_print(out, "\n");
    print_foot(s, k, style, out);
  }
}
