/* SPDX-License-Identifier: GPL-2.0-or-later */
/* study.csv, curves.csv, study.md, and the terminal. */
#include "study/judge.h"

#include <string.h>

/* A field of CSV, in quotes where it has a comma or quotes in it (RFC 4180). */
static void print_field(gh_text *out, const char *text) {
  if (!strpbrk(text, ",\"\n")) {
    gh_text_print(out, "%s", text);
    return;
  }
  gh_text_print(out, "\"");
  for (; *text; text++) gh_text_print(out, *text == '"' ? "\"\"" : "%c", *text);
  gh_text_print(out, "\"");
}

static void print_config(const gh_study *s, int k, gh_text *out) {
  gh_text_print(out, "%d", k);
  for (int j = 0; j < s->nparameters; j++) {
    char text[STUDY_CELL];
    const char *value = s->configs[k].value[j];
    gh_text_print(out, ",");
    print_field(out, strlen(value) < sizeof text ? study_plain(value, text, sizeof text) : value);
  }
}

static void print_head(const gh_study *s, gh_text *out) {
  gh_text_print(out, "setting");
  for (int j = 0; j < s->nparameters; j++) {
    gh_text_print(out, ",");
    print_field(out, s->parameters[j].name);
  }
}

/* ---- study.csv ---- */

static const gh_term study_csv_head[] = {{"also", "keys that a reference sets besides the parameters"},
                                         {"reference", "row of the reference"},
                                         {"outcome", "done, reference, failed, partly failed, unfinished"},
                                         {"runs", "packings of the ensemble"},
                                         {"members", "of these with a result"},
                                         {"points", "values of t that are compared"},
                                         {0}};

static const gh_term study_csv_errors[] = {
    {"QUANTITY_l2", "relative error, l2 norm over t; of the mean of an ensemble"},
    {"QUANTITY_largest", "largest difference at one t over the largest value"},
    {"QUANTITY_single", "root mean square error of the members"},
    {"QUANTITY_confidence", "half width of the 95 % interval of the mean"},
    {"QUANTITY_chance", "half width of the 95 % interval of the error: what scatter alone explains"},
    {0}};

static const gh_term study_csv_tail[] = {
    {"wall", "elapsed time, s"},
    {"core", "processor time, s"},
    {"force_evaluations", "relaxation steps of the packings"},
    {"pair_evaluations", "evaluations of grain pairs"},
    {"factorisations", "of the packings"},
    {"evaluations", "of packings"},
    {"iterations", "of the finite element problem"},
    {"cuts", "bisections"},
    {"jumps", "instabilities that were stepped over"},
    {"residual", "largest"},
    {"energy_defect", "energy imbalance, relative"},
    {"pareto", "1: none with the same reference is as accurate and faster (core)"},
    {"pareto_count", "the same by pair evaluations"},
    {"order", "observed order of convergence"},
    {0}};

static const gh_term study_curve_columns[] = {{"t", "rows of the path, or load steps"},
                                              {"members", "packings of the ensemble"},
                                              {"COLUMN", "mean of a compared column"},
                                              {"COLUMN_deviation", "its standard deviation"},
                                              {0}};

const gh_term_list *gh_study_columns(void) {
  static const gh_term_list all[] = {{"study.csv: setting, the parameters, then", study_csv_head},
                                     {"study.csv: of each quantity", study_csv_errors},
                                     {"study.csv: cost", study_csv_tail},
                                     {"curves.csv: setting, the parameters, then", study_curve_columns},
                                     {0}};
  return all;
}

static const char *config_outcome(const gh_study *s, int k) {
  const study_config *g = s->configs + k;
  int finished = 0, members = s->verdict->row[k].members;
  for (int m = 0; m < g->nruns; m++) finished += g->runs[m].finished;
  if (finished < g->nruns) return "unfinished";
  if (members < g->nruns) return members > 0 ? "partly failed" : "failed";
  return study_is_reference(s, k) ? "reference" : "done";
}

void study_write_csv(const gh_study *s, gh_text *out) {
  if (!s->verdict) return;
  print_head(s, out);
  gh_text_print(out, ",");
  gh_terms_header(out, study_csv_head, ",");
  for (int q = 0; q < s->nquantities; q++) {
    for (const gh_term *t = study_csv_errors; t->name; t++)
      gh_text_print(out, ",%s%s", s->quantities[q].name, strchr(t->name, '_'));
  }
  gh_text_print(out, ",");
  gh_terms_header(out, study_csv_tail, ",");
  gh_text_print(out, "\n");
  for (int k = 0; k < s->nconfigs; k++) {
    const study_judged *r = s->verdict->row + k;
    print_config(s, k, out);
    gh_text_print(out, ",");
    print_field(out, s->configs[k].also ? s->configs[k].also : "");
    gh_text_print(out, ",%d,%s,%d,%d,%d", s->configs[k].reference, config_outcome(s, k), s->configs[k].nruns,
                  r->members, r->points);
    for (int q = 0; q < s->nquantities; q++)
      gh_text_print(out, ",%.17g,%.17g,%.17g,%.17g,%.17g", r->l2[q], r->largest[q], r->single[q],
                    r->confidence[q], r->chance[q]);
    gh_text_print(out, ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%d,%d,%.17g\n",
                  r->wall, r->core, r->force_evaluations, r->pair_evaluations, r->factorisations,
                  r->evaluations, r->iterations, r->cuts, r->jumps, r->residual, r->energy_defect, r->pareto,
                  r->pareto_count, r->order);
  }
}

/* ---- curves.csv ---- */

void study_write_curves(const gh_study *s, gh_text *out) {
  print_head(s, out);
  gh_text_print(out, ",t,members");
  for (int c = 0; c < s->ncolumns; c++) gh_text_print(out, ",%s,%s_deviation", s->column[c], s->column[c]);
  gh_text_print(out, "\n");
  for (int k = 0; k < s->nconfigs; k++) {
    const study_curve *first = study_first_curve(s->configs + k);
    for (int row = 0; first && row < first->n; row++) {
      int members = study_members_at(s, s->configs + k, first->t[row], 0).n;
      if (members == 0) continue;
      print_config(s, k, out);
      gh_text_print(out, ",%.17g,%d", first->t[row], members);
      for (int c = 0; c < s->ncolumns; c++) {
        study_sample x = study_members_at(s, s->configs + k, first->t[row], c);
        gh_text_print(out, ",%.17g,%.17g", x.mean, x.deviation);
      }
      gh_text_print(out, "\n");
    }
  }
}

/* ---- for people ---- */

static void print_all(const gh_study *s, study_style style, const char *lead, gh_text *out) {
  gh_text_print(out, "\n");
  study_print_subject(s, style, out);
  gh_text_print(out, "\n");
  study_print_sentences(s, style, lead, out);
  gh_text_print(out, "\n");
  study_print_rows(s, style, out);
  gh_text_print(out, "\n");
  study_print_notes(s, out);
  if (s->order < 0 || s->verdict->nfits == 0) return;
  gh_text_print(out, "\n");
  study_print_orders(s, style, out);
}

void study_write_markdown(const gh_study *s, gh_text *out) {
  if (!s->verdict) return;
  gh_text_print(out, "# ");
  study_print_escaped(out, STUDY_MARKDOWN, s->title ? s->title : "Study");
  gh_text_print(out, "\n");
  print_all(s, STUDY_MARKDOWN, "- ", out);
}

void gh_study_print(const gh_study *s, gh_text *out) {
  if (!s->verdict) return;
  if (s->title) gh_text_print(out, "%s", s->title);
  print_all(s, STUDY_PLAIN, "", out);
}
