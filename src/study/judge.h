/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the files that judge and show a study share. */
#ifndef GRANHOM_STUDY_JUDGE_H
#define GRANHOM_STUDY_JUDGE_H

#include "study/internal.h"

/* ---- compare.c: curves ---- */

/* A run that came to the end; others take part in nothing. */
bool study_run_done(const study_run *r);
/* Row of the curve at t, up to 1e-9 of its range; -1: it has none. */
int study_curve_at(const study_curve *c, double t);

/* Mean and standard deviation (n - 1) of n numbers. */
typedef struct study_sample {
  int n;
  double mean, deviation; /* deviation 0 with one number */
} study_sample;
/* Of a column over the members that came to the end. n 0: not all of them have this t, or there are none. */
study_sample study_members_at(const gh_study *s, const study_config *g, double t, int column);
/* The curve of the first member that came to the end: its t are those of the mean; NULL: there is none. */
const study_curve *study_first_curve(const study_config *g);
/* Fills the errors of a row (arrays of nquantities, allocated), its points, paired, why. */
gh_status study_compare(const gh_study *s, const study_config *g, study_judged *row);

/* ---- ratings.c: questions about a judged study ---- */

/* The configuration is itself what it is compared with. */
bool study_is_reference(const gh_study *s, int config);
/* A row that takes part in fronts, sentences and pictures: no extra, no reference, its main error is known.
 */
bool study_is_rated(const gh_study *s, int config);
/* It is rated, and none before it is that has the same reference. */
bool study_first_of_reference(const gh_study *s, int config);
double study_error_of(const gh_study *s, int config); /* l2 of the main quantity */

/* What counts as work on every machine: pair evaluations, or factorisations where no run counts those. */
typedef enum study_counted { STUDY_NOTHING, STUDY_PAIRS, STUDY_FACTORISATIONS } study_counted;
study_counted study_counts(const gh_study *s);
double study_count_of(const gh_study *s, int config);
const char *study_count_name(study_counted counted); /* "pair evaluations" */

/* All parameters but one are equal (except -1: all are). */
bool study_alike(const gh_study *s, int a, int b, int except);
/* No configuration before this one, extra ones apart, is alike. */
bool study_first_alike(const gh_study *s, int config, int except);
/* Some configuration of the table has more than one packing. */
bool study_has_ensembles(const gh_study *s);

/* ---- front.c ---- */

/* front[k]: no other point costs at most as much and errs at most as much, with less in one of the two. Equal
 * points stay together. Returns how many are on the front; order: their indices by growing cost (n ints). */
gh_status study_front(gh_context *ctx, int n, const double *cost, const double *error, bool *front,
                      int *order, int *count);

/* ---- fit.c ---- */

/* Orders between values and their fits; after the errors are known. */
gh_status study_fit_orders(gh_study *s);

/* ---- words.c ---- */

typedef struct study_word {
  char text[48];
} study_word;
study_word study_error_word(double error);     /* "3.10e-3", "0.125"; "-" for NAN */
study_word study_seconds_word(double seconds); /* "0.820", "1230" */
study_word study_count_word(double count);     /* "1234", "1.20e6" */
study_word study_goal_word(double goal);       /* "1 %", "1e-6" */
study_word study_order_word(double order);     /* "1.98" */

typedef enum study_style { STUDY_PLAIN, STUDY_MARKDOWN } study_style;
/* Text as it is, or with a backslash before what Markdown would read as markup. */
void study_print_escaped(gh_text *out, study_style style, const char *text);
/* The i-th parameter that has more than one value (of a study of one configuration: any parameter); -1: there
 * are fewer. */
int study_varied_parameter(const gh_study *s, int i);
/* "micro.tolerance 1e-4, micro.boundary periodic": the parameters that are varied, but `except`, and what a
 * reference sets beside them. */
void study_name(const gh_study *s, int config, int except, char *text, size_t size);
/* A value as study_plain has it, escaped. */
void study_print_plain(gh_text *out, study_style style, const char *value);
/* A parameter's value for a legend, without quotes: packings without folder and `.data`. */
void study_short_value(const gh_study *s, int config, int parameter, char *text, size_t size);
/* For a picture: like study_name with short values, and names where a value does not speak for itself. */
void study_legend(const gh_study *s, int config, int except, char *text, size_t size);

/* ---- sentences.c ---- */

/* Each line with `lead` before it. */
void study_print_sentences(const gh_study *s, study_style style, const char *lead, gh_text *out);
/* What was compared with what. */
void study_print_subject(const gh_study *s, study_style style, gh_text *out);
/* How the numbers of the table are to be read, and what the references cost. */
void study_print_notes(const gh_study *s, gh_text *out);

/* ---- cells.c ---- */

enum { STUDY_CELL = 512 };

/* Cells are made twice, for the width of their column and to be printed. */
typedef struct study_table {
  const gh_study *s;
  int rows, columns;
  /* Text of a cell; row -1: of the head. Returns whether it stands on the right. */
  bool (*cell)(const struct study_table *t, int row, int column, char text[STUDY_CELL]);
} study_table;
void study_print_table(const study_table *t, study_style style, gh_text *out);

/* ---- rows.c, orders.c ---- */

void study_print_rows(const gh_study *s, study_style style, gh_text *out);
void study_print_orders(const gh_study *s, study_style style, gh_text *out);

#endif
