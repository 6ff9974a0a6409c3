/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Studies made in memory, with curves that are known in closed form. */
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

/* A parameter with its values, of which NULL ends the list. */
static inline void made_parameter(gh_study *s, const char *name, const char *const *values) {
  s->parameters = realloc(s->parameters, (size_t)(s->nparameters + 1) * sizeof *s->parameters);
  assert_non_null(s->parameters);
  study_parameter *k = s->parameters + s->nparameters++;
  *k = (study_parameter){.name = made_text(name)};
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

/* All combinations of the values, the last parameter fastest, each with so many runs, and room for `extra`
 * more.
 */
static inline void made_configs(gh_study *s, int nruns, int extra) {
  int n = 1;
  for (int k = 0; k < s->nparameters; k++) n *= s->parameters[k].nvalues;
  s->nconfigs = n + extra;
  s->configs = made_array((size_t)s->nconfigs, sizeof *s->configs);
  for (int i = 0; i < s->nconfigs; i++) {
    study_config *g = s->configs + i;
    g->value = made_array((size_t)s->nparameters, sizeof *g->value);
    g->choice = made_array((size_t)s->nparameters, sizeof *g->choice);
    g->also = made_text("");
    g->extra = i >= n;
    g->reference = -1;
    for (int k = s->nparameters - 1, rest = i % n; k >= 0; rest /= s->parameters[k--].nvalues) {
      g->choice[k] = rest % s->parameters[k].nvalues;
      g->value[k] = made_text(s->parameters[k].value[g->choice[k]]);
    }
    g->nruns = nruns;
    g->runs = made_array((size_t)nruns, sizeof *g->runs);
    for (int m = 0; m < nruns; m++) g->runs[m].residual = g->runs[m].energy_defect = NAN;
  }
}

/* A value that only a reference has. */
static inline void made_value(gh_study *s, int config, int parameter, const char *value) {
  study_config *g = s->configs + config;
  free(g->value[parameter]);
  g->value[parameter] = made_text(value);
  g->choice[parameter] = -1;
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
  for (int i = 0; i < s->nconfigs; i++) {
    study_config *g = s->configs + i;
    for (int k = 0; k < s->nparameters; k++) free(g->value[k]);
    for (int m = 0; m < g->nruns; m++) made_free_curve(&g->runs[m].curve);
    free(g->value), free(g->choice), free(g->also), free(g->runs);
  }
  for (int k = 0; k < s->nparameters; k++) {
    for (int v = 0; v < s->parameters[k].nvalues; v++) free(s->parameters[k].value[v]);
    free(s->parameters[k].name), free(s->parameters[k].value), free(s->parameters[k].number);
  }
  for (int c = 0; c < s->ncolumns; c++) free(s->column[c]);
  made_free_curve(&s->given);
  free(s->parameters), free(s->configs), free(s->column), free(s->quantities), free(s->goals), free(s->plots);
  free(s->path), free(s->title), free(s->reference_text), free(s->length_unit), free(s->force_unit), free(s);
}

#endif
