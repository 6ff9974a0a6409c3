/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Questions about a judged study. */
#include "study/judge.h"

bool study_is_reference(const gh_study *s, int config) {
  const study_config *g = s->configs + config;
  return g->extra || g->reference == config;
}

double study_error_of(const gh_study *s, int config) {
  return s->verdict->row[config].l2[s->main];
}

bool study_is_rated(const gh_study *s, int config) {
  return !study_is_reference(s, config) && isfinite(study_error_of(s, config));
}

bool study_first_of_reference(const gh_study *s, int config) {
  for (int k = 0; k < config; k++)
    if (study_is_rated(s, k) && s->configs[k].reference == s->configs[config].reference) return false;
  return study_is_rated(s, config);
}

bool study_alike(const gh_study *s, int a, int b, int except) {
  for (int k = 0; k < s->nparameters; k++)
    if (k != except && s->configs[a].choice[k] != s->configs[b].choice[k]) return false;
  return true;
}

bool study_first_alike(const gh_study *s, int config, int except) {
  for (int k = 0; k < config; k++)
    if (!s->configs[k].extra && study_alike(s, k, config, except)) return false;
  return true;
}

bool study_has_ensembles(const gh_study *s) {
  for (int k = 0; k < s->nconfigs; k++)
    if (!s->configs[k].extra && s->configs[k].nruns > 1) return true;
  return false;
}

study_counted study_counts(const gh_study *s) {
  study_counted counted = STUDY_NOTHING;
  for (int k = 0; k < s->nconfigs; k++) {
    const study_judged *row = s->verdict->row + k;
    if (row->pair_evaluations > 0) return STUDY_PAIRS;
    if (row->factorisations > 0) counted = STUDY_FACTORISATIONS;
  }
  return counted;
}

double study_count_of(const gh_study *s, int config) {
  const study_judged *row = s->verdict->row + config;
  return study_counts(s) == STUDY_FACTORISATIONS ? row->factorisations : row->pair_evaluations;
}

const char *study_count_name(study_counted counted) {
  return counted == STUDY_FACTORISATIONS ? "factorisations" : "pair evaluations";
}
