/* Questions about a judged study. SPDX-License-Identifier: GPL-2.0-or-later */
#include "study/judge.h"

bool study_is_reference(const gh_study *s, int setting) {
  const study_setting *g = s->settings + setting;
  return g->extra || g->reference == setting;
}

double study_error_of(const gh_study *s, int setting) {
  return s->verdict->row[setting].l2[s->main];
}

bool study_is_rated(const gh_study *s, int setting) {
  return !study_is_reference(s, setting) && isfinite(study_error_of(s, setting));
}

bool study_first_of_reference(const gh_study *s, int setting) {
  for (int k = 0; k < setting; k++)
    if (study_is_rated(s, k) && s->settings[k].reference == s->settings[setting].reference) return false;
  return study_is_rated(s, setting);
}

bool study_alike(const gh_study *s, int a, int b, int except) {
  for (int k = 0; k < s->nknobs; k++)
    if (k != except && s->settings[a].choice[k] != s->settings[b].choice[k]) return false;
  return true;
}

bool study_first_alike(const gh_study *s, int setting, int except) {
  for (int k = 0; k < setting; k++)
    if (!s->settings[k].extra && study_alike(s, k, setting, except)) return false;
  return true;
}

bool study_has_ensembles(const gh_study *s) {
  for (int k = 0; k < s->nsettings; k++)
    if (!s->settings[k].extra && s->settings[k].nruns > 1) return true;
  return false;
}

study_counted study_counts(const gh_study *s) {
  study_counted counted = STUDY_NOTHING;
  for (int k = 0; k < s->nsettings; k++) {
    const study_judged *row = s->verdict->row + k;
    if (row->pair_evaluations > 0) return STUDY_PAIRS;
    if (row->factorisations > 0) counted = STUDY_FACTORISATIONS;
  }
  return counted;
}

double study_count_of(const gh_study *s, int setting) {
  const study_judged *row = s->verdict->row + setting;
  return study_counts(s) == STUDY_FACTORISATIONS ? row->factorisations : row->pair_evaluations;
}

const char *study_count_name(study_counted counted) {
  return counted == STUDY_FACTORISATIONS ? "factorisations" : "pair evaluations";
}
