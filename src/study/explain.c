/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a study would run, in words. */
#include "study/judge.h"
#include "study/parts.h"

#include <string.h>

static void parameters(const gh_study *s, gh_text *out) {
  for (int k = 0; k < s->nparameters; k++) {
    const study_parameter *parameter = s->parameters + k;
    gh_text_print(out, "  varied: %s:", parameter->name);
    for (int j = 0; j < parameter->nvalues; j++) {
      gh_text_print(out, "%s ", j ? "," : "");
      study_print_plain(out, STUDY_PLAIN, parameter->value[j]);
    }
    gh_text_print(out, "%s%s\n", k == s->series ? "; points of a curve" : "",
                  k == s->order ? "; order of convergence" : "");
  }
  for (int k = 0; k < s->nbase; k++) {
    if (strcmp(s->base[k].key, "packing") == 0) continue;
    gh_text_print(out, "  set: %s: ", s->base[k].key);
    study_print_plain(out, STUDY_PLAIN, s->base[k].value);
    gh_text_print(out, "\n");
  }
}

/* Packings of the configurations, where the study names some. */
static void members(const gh_study *s, gh_text *out) {
  int least = s->configs[0].nruns, most = least;
  for (int k = 0; k < s->nconfigs; k++) {
    if (s->configs[k].nruns < least) least = s->configs[k].nruns;
    if (s->configs[k].nruns > most) most = s->configs[k].nruns;
  }
  if (most == 1) return;
  if (least == most)
    gh_text_print(out, "  packings: %d for each configuration; errors are those of their mean\n", most);
  else
    gh_text_print(out, "  packings: %d to %d for a configuration; errors are those of their mean\n", least,
                  most);
}

void gh_study_explain(const gh_study *s, gh_text *out) {
  int rows = 0, runs = 0;
  for (int k = 0; k < s->nconfigs; k++) {
    rows += !s->configs[k].extra;
    runs += s->configs[k].nruns;
  }
  gh_text_print(out, "%s%s\n", s->title, s->quick ? " (quick)" : "");
  if (s->scene) gh_text_print(out, "  problem: the scene %s\n", s->scene_path);
  else gh_text_print(out, "  problem: one packing along a path\n");
  parameters(s, out);
  members(s, out);
  gh_text_print(out, "  configurations: %d, and %d more as references; %d runs in all\n", rows,
                s->nconfigs - rows, runs);
  gh_text_print(out, "  reference: %s\n  compared:", s->reference_text);
  for (int k = 0; k < s->nquantities; k++) gh_text_print(out, "%s %s", k ? "," : "", s->quantities[k].name);
  gh_text_print(out, "\n  goals:");
  for (int k = 0; k < s->ngoals; k++) gh_text_print(out, "%s %g", k ? "," : "", s->goals[k]);
  gh_text_print(out, "\n");
}
