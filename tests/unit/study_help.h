/* Studies made in memory, with curves that are known in closed form. SPDX-License-Identifier:
 * GPL-2.0-or-later
 */
#ifndef GRANHOM_TESTS_STUDY_HELP_H
#define GRANHOM_TESTS_STUDY_HELP_H

#include "../help.h"
#include "study/judge.h"

/* Columns P11, P22 (the stress), energy. */
enum { MADE_COLUMNS = 3 };

/* Value of a column at t. */
typedef double made_law(double t, int column, void *data);

static inline char *made_text(const char *text) {
  char *copy = strdup(text);
  assert_non_null(copy);
  return copy;
}

static inline void *made_array(size_t n, size_t size) {
  void *p = calloc(n ? n : 1, size);
  assert_non_null(p);
  return p;
}

/* A knob with its values, of which NULL ends the list. */
static inline void made_knob(gh_study *s, const char *name, const char *const *values) {
  s->knobs = realloc(s->knobs, (size_t)(s->nknobs + 1) * sizeof *s->knobs);
  assert_non_null(s->knobs);
  study_knob *k = s->knobs + s->nknobs++;
  *k = (study_knob){.name = made_text(name)};
  while (values[k->nvalues]) k->nvalues++;
  k->value = made_array((size_t)k->nvalues, sizeof *k->value);
  k->number = made_array((size_t)k->nvalues, sizeof *k->number);
  for (int v = 0; v < k->nvalues; v++) {
    k->value[v] = made_text(values[v]);
    if (!gh_parse_number(values[v], k->number + v)) k->number[v] = NAN;
  }
}

static inline gh_study *made_study(gh_context *ctx) {
  static const char *const columns[MADE_COLUMNS] = {"P11", "P22", "energy"};
  gh_study *s = made_array(1, sizeof *s);
  s->ctx = ctx;
  s->path = made_text("studies/made.yaml"), s->title = made_text("A made study");
  s->reference_text = made_text("the truth");
  s->length_unit = made_text("mm"), s->force_unit = made_text("N");
  s->ncolumns = MADE_COLUMNS;
  s->column = made_array(MADE_COLUMNS, sizeof *s->column);
  for (int c = 0; c < MADE_COLUMNS; c++) s->column[c] = made_text(columns[c]);
  s->nquantities = 2;
  s->quantities = made_array(2, sizeof *s->quantities);
  s->quantities[0] = (study_quantity){"stress", 0, 2}, s->quantities[1] = (study_quantity){"energy", 2, 1};
  s->ngoals = 3;
  s->goals = made_array(3, sizeof *s->goals);
  s->goals[0] = 1e-2, s->goals[1] = 1e-3, s->goals[2] = 1e-6;
  s->reference = STUDY_CLOSED_FORM;
  s->order = -1;
  return s;
}

/* All combinations of the values, the last knob fastest, each with so many runs, and room for `extra` more.
 */
static inline void made_settings(gh_study *s, int nruns, int extra) {
  int n = 1;
  for (int k = 0; k < s->nknobs; k++) n *= s->knobs[k].nvalues;
  s->nsettings = n + extra;
  s->settings = made_array((size_t)s->nsettings, sizeof *s->settings);
  for (int i = 0; i < s->nsettings; i++) {
    study_setting *g = s->settings + i;
    g->value = made_array((size_t)s->nknobs, sizeof *g->value);
    g->choice = made_array((size_t)s->nknobs, sizeof *g->choice);
    g->also = made_text("");
    g->extra = i >= n;
    g->reference = -1;
    for (int k = s->nknobs - 1, rest = i % n; k >= 0; rest /= s->knobs[k--].nvalues) {
      g->choice[k] = rest % s->knobs[k].nvalues;
      g->value[k] = made_text(s->knobs[k].value[g->choice[k]]);
    }
    g->nruns = nruns;
    g->runs = made_array((size_t)nruns, sizeof *g->runs);
    for (int m = 0; m < nruns; m++) g->runs[m].residual = g->runs[m].energy_defect = NAN;
  }
}

/* A value that only a reference has. */
static inline void made_value(gh_study *s, int setting, int knob, const char *value) {
  study_setting *g = s->settings + setting;
  free(g->value[knob]);
  g->value[knob] = made_text(value);
  g->choice[knob] = -1;
}

static inline void made_curve(study_curve *c, int n, double end, made_law *law, void *data) {
  c->n = n;
  c->t = made_array((size_t)n, sizeof *c->t);
  c->value = made_array((size_t)n * MADE_COLUMNS, sizeof *c->value);
  for (int k = 0; k < n; k++) {
    c->t[k] = end * k / (n - 1);
    for (int j = 0; j < MADE_COLUMNS; j++) c->value[k * MADE_COLUMNS + j] = law(c->t[k], j, data);
  }
}

/* A run that came to the end. */
static inline void made_run(study_run *r, int n, double end, made_law *law, void *data, double core,
                            long pairs) {
  made_curve(&r->curve, n, end, law, data);
  r->finished = true;
  r->status = GH_OK;
  r->core = core, r->wall = 2 * core;
  r->pair_evaluations = pairs;
  r->force_evaluations = 2 * pairs, r->factorisations = 10;
}

static inline void made_failure(study_run *r, const char *message) {
  r->finished = true;
  r->status = GH_DIVERGED;
  snprintf(r->message, sizeof r->message, "%s", message);
}

static inline void made_free_curve(study_curve *c) {
  free(c->t);
  free(c->value);
}

static inline void made_destroy(gh_study *s) {
  study_verdict_destroy(s);
  for (int i = 0; i < s->nsettings; i++) {
    study_setting *g = s->settings + i;
    for (int k = 0; k < s->nknobs; k++) free(g->value[k]);
    for (int m = 0; m < g->nruns; m++) made_free_curve(&g->runs[m].curve);
    free(g->value), free(g->choice), free(g->also), free(g->runs);
  }
  for (int k = 0; k < s->nknobs; k++) {
    for (int v = 0; v < s->knobs[k].nvalues; v++) free(s->knobs[k].value[v]);
    free(s->knobs[k].name), free(s->knobs[k].value), free(s->knobs[k].number);
  }
  for (int c = 0; c < s->ncolumns; c++) free(s->column[c]);
  made_free_curve(&s->given);
  free(s->knobs), free(s->settings), free(s->column), free(s->quantities), free(s->goals), free(s->plots);
  free(s->path), free(s->title), free(s->reference_text), free(s->length_unit), free(s->force_unit), free(s);
}

#endif
