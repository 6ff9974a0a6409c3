/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The results of a study in sentences. */
#include "study/judge.h"

#include <string.h>

enum { NAME = 512, FEW_REFERENCES = 6, ANY = -2 };

/* ---- which configuration ---- */

static bool config_competes(const gh_study *s, int k, int reference) {
  return study_is_rated(s, k) && (reference == ANY || s->configs[k].reference == reference);
}

/* The cheapest in core seconds whose error is at most the goal, of two the more accurate; -1: none. Of those
 * with this reference, or ANY. */
static int config_cheapest(const gh_study *s, int reference, double goal) {
  int best = -1;
  for (int k = 0; k < s->nconfigs; k++) {
    if (!config_competes(s, k, reference) || study_error_of(s, k) > goal) continue;
    double core = s->verdict->row[k].core, least = best < 0 ? INFINITY : s->verdict->row[best].core;
    if (core < least || (core == least && study_error_of(s, k) < study_error_of(s, best))) best = k;
  }
  return best;
}

static int config_nearest(const gh_study *s, int reference) {
  int best = -1;
  for (int k = 0; k < s->nconfigs; k++)
    if (config_competes(s, k, reference) && (best < 0 || study_error_of(s, k) < study_error_of(s, best)))
      best = k;
  return best;
}

/* ---- one sentence ---- */

static bool is_ensemble(const gh_study *s, int k) {
  return s->configs[k].nruns > 1;
}

/* " (error 3.10e-3, 0.820 s of one core, 1.20e6 pair evaluations)" */
static void print_price(const gh_study *s, int k, gh_text *out) {
  const study_judged *row = s->verdict->row + k;
  study_counted counted = study_counts(s);
  bool ensemble = is_ensemble(s, k);
  gh_text_print(out, " (error%s %s", ensemble ? " of the mean" : "", study_error_word(row->l2[s->main]).text);
  if (isfinite(row->chance[s->main]))
    gh_text_print(out, " +- %s", study_error_word(row->chance[s->main]).text);
  if (ensemble) gh_text_print(out, ", of a single packing %s", study_error_word(row->single[s->main]).text);
  gh_text_print(out, "%s %s s of one core", ensemble ? "; for each packing" : ",",
                study_seconds_word(row->core).text);
  if (counted != STUDY_NOTHING && study_count_of(s, k) > 0)
    gh_text_print(out, "%s %s %s", ensemble ? " and" : ",", study_count_word(study_count_of(s, k)).text,
                  study_count_name(counted));
  gh_text_print(out, ")");
}

/* Where an ensemble is too small for the difference. A goal of 0: there is none. */
static void print_doubt(const gh_study *s, int k, double goal, gh_text *out) {
  const study_judged *row = s->verdict->row + k;
  double error = row->l2[s->main], chance = row->chance[s->main];
  if (!(chance > error)) return;
  gh_text_print(out, " With %d packings this difference cannot be distinguished from chance", row->members);
  if (error <= goal && error + chance > goal) gh_text_print(out, ", so whether the goal is met remains open");
  gh_text_print(out, ".");
}

static void print_choice(const gh_study *s, int k, double goal, study_style style, gh_text *out) {
  char name[NAME];
  study_name(s, k, -1, name, sizeof name);
  study_print_escaped(out, style, name);
  print_price(s, k, out);
  gh_text_print(out, ".");
  print_doubt(s, k, goal, out);
  gh_text_print(out, "\n");
}

/* The goals are descending, so those that nothing reaches are the last ones: one sentence names them all. */
static void print_unreached(const gh_study *s, int reference, int first, study_style style, gh_text *out) {
  gh_text_print(out, "No configuration reaches");
  for (int k = first; k < s->ngoals; k++)
    gh_text_print(out, "%s %s",
                  k == first          ? ""
                  : k + 1 < s->ngoals ? ","
                                      : " or",
                  study_goal_word(s->goals[k]).text);
  gh_text_print(out, " of the %s; the nearest is ", s->quantities[s->main].name);
  print_choice(s, config_nearest(s, reference), 0, style, out);
}

static void print_goals(const gh_study *s, int reference, study_style style, const char *lead, gh_text *out) {
  for (int k = 0; k < s->ngoals; k++) {
    int best = config_cheapest(s, reference, s->goals[k]);
    gh_text_print(out, "%s", lead);
    if (best < 0) {
      print_unreached(s, reference, k, style, out);
      return;
    }
    gh_text_print(out, "For %s of the %s: ", study_goal_word(s->goals[k]).text, s->quantities[s->main].name);
    print_choice(s, best, s->goals[k], style, out);
  }
}

/* Configurations with references of their own answer different questions: each gets its sentences, as long as
 * these are few. */
void study_print_sentences(const gh_study *s, study_style style, const char *lead, gh_text *out) {
  if (config_nearest(s, ANY) < 0) {
    const char *why = NULL;
    for (int k = 0; k < s->nconfigs && !why; k++) why = s->verdict->row[k].why;
    gh_text_print(out, "%sNo configuration could be compared with the reference%s%s.\n", lead,
                  why ? ": " : "", why ? why : "");
    return;
  }
  int references = 0;
  for (int k = 0; k < s->nconfigs; k++) references += study_first_of_reference(s, k);
  if (references > FEW_REFERENCES) print_goals(s, ANY, style, lead, out);
  for (int k = 0; k < s->nconfigs && references <= FEW_REFERENCES; k++)
    if (study_first_of_reference(s, k)) print_goals(s, s->configs[k].reference, style, lead, out);
}

/* ---- what was done ---- */

static int table_rows(const gh_study *s) {
  int n = 0;
  for (int k = 0; k < s->nconfigs; k++) n += !s->configs[k].extra;
  return n;
}

void study_print_subject(const gh_study *s, study_style style, gh_text *out) {
  const char *slash = s->path ? strrchr(s->path, '/') : NULL;
  int rows = table_rows(s), most = 0;
  for (int k = 0; k < s->nconfigs; k++)
    if (!s->configs[k].extra && s->configs[k].nruns > most) most = s->configs[k].nruns;
  gh_text_print(out, "%d configuration%s of ", rows, rows == 1 ? "" : "s");
  study_print_escaped(out, style, s->path ? (slash ? slash + 1 : s->path) : "the study");
  for (int k = 0; k < s->nparameters; k++) {
    gh_text_print(out, "%s%s ", k == 0 ? " (" : "; ", s->parameters[k].name);
    for (int v = 0; v < s->parameters[k].nvalues; v++) {
      gh_text_print(out, "%s", v ? ", " : "");
      study_print_plain(out, style, s->parameters[k].value[v]);
    }
  }
  gh_text_print(out, "%s", s->nparameters > 0 ? ")" : "");
  if (most > 1) gh_text_print(out, ", each with up to %d packings", most);
  gh_text_print(out, ", compared with ");
  study_print_escaped(out, style, s->reference_text ? s->reference_text : "the reference");
  gh_text_print(out, ".%s\n", s->quick ? " This is the short version of the study (--quick)." : "");
}

/* ---- notes ---- */

static void note_references(const gh_study *s, gh_text *out) {
  double least = INFINITY, most = 0;
  int n = 0;
  for (int k = 0; k < s->nconfigs; k++) {
    const study_judged *row = s->verdict->row + k;
    if (!study_is_reference(s, k) || row->members == 0) continue;
    least = fmin(least, row->core), most = fmax(most, row->core);
    n++;
  }
  if (n == 0) return;
  gh_text_print(out, " The reference%s took %s", n > 1 ? "s" : "", study_seconds_word(least).text);
  if (n > 1) gh_text_print(out, " to %s", study_seconds_word(most).text);
  gh_text_print(out, " s of one core%s.", study_has_ensembles(s) ? " a packing" : "");
}

/* Answers and seconds that may not be those of this program. */
static void note_builds(const gh_study *s, gh_text *out) {
  int others = 0, all = 0;
  for (int k = 0; k < s->nconfigs; k++)
    for (int m = 0; m < s->configs[k].nruns; m++, all++) others += s->configs[k].runs[m].other_build;
  if (others > 0)
    gh_text_print(
        out,
        " %d of %d runs were computed by another build of granhom, which may answer otherwise and take "
        "other times: --fresh repeats them.",
        others, all);
}

static bool any_zero(const gh_study *s) {
  for (int k = 0; k < s->nconfigs; k++)
    if (study_is_rated(s, k) && study_error_of(s, k) == 0) return true;
  return false;
}

void study_print_notes(const gh_study *s, gh_text *out) {
  study_counted counted = study_counts(s);
  gh_text_print(out,
                "Errors are relative: the l2 norm of the difference over that of the reference, over the "
                "values of t that both have; largest: the largest difference over the largest value. Seconds "
                "are those of one core. Front: nothing else with the same reference is at least as accurate "
                "and cheaper");
  if (counted != STUDY_NOTHING)
    gh_text_print(out, ", in time, in work (%s), or in both", study_count_name(counted));
  gh_text_print(out, ".");
  note_references(s, out);
  note_builds(s, out);
  if (study_has_ensembles(s))
    gh_text_print(out,
                  " With ensembles the error is that of the mean over the packings, +- the half width of "
                  "its 95 %% interval (Student's t; where the reference has the same packings, of the mean "
                  "of the differences); a single packing has the error in the column of that name (root "
                  "mean square), and costs are means over the packings.");
  if (any_zero(s))
    gh_text_print(out,
                  " An error of 0 is an answer that equals the reference to the last digit; the pictures "
                  "show it as a triangle at their lower edge.");
  gh_text_print(out, "\n");
}
