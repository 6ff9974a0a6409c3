/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Which curves stand together, and how they look. */
#include "study/draw.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_TOGETHER = 6, MOST_GROUPS = 40, MOST_COMPARED = 4 };

static const char *const BLACK = "#000000";

/* ---- groups ---- */

static bool has_curve(const gh_study *s, int k) {
  return !s->configs[k].extra && study_first_curve(s->configs + k);
}

/* An extra configuration is drawn where it is the only one, as the reference of all. */
static int only_extra(const gh_study *s) {
  int extra = -1;
  for (int k = 0; k < s->nconfigs; k++) {
    if (!s->configs[k].extra) continue;
    if (extra >= 0) return -1;
    extra = k;
  }
  return extra >= 0 && study_first_curve(s->configs + extra) ? extra : -1;
}

/* Fills group and first; returns the number of curves. */
static int find_groups(study_rows *r) {
  int curves = 0;
  for (int k = 0; k < r->s->nconfigs; k++) {
    r->group[k] = -1;
    if (!has_curve(r->s, k)) continue;
    curves++;
    for (int g = 0; g < r->ngroups && r->group[k] < 0; g++)
      if (study_alike(r->s, r->first[g], k, r->s->series)) r->group[k] = g;
    if (r->group[k] >= 0) continue;
    r->group[k] = r->ngroups;
    r->first[r->ngroups++] = k;
  }
  return curves;
}

/* Rows of one curve each would compare nothing. */
static bool has_series(const study_rows *r) {
  for (int k = 0; k < r->s->nconfigs; k++)
    if (r->group[k] >= 0 && r->first[r->group[k]] != k) return true;
  return false;
}

static bool all_groups_have(const study_rows *r, int choice) {
  int have = 0;
  for (int k = 0; k < r->s->nconfigs; k++)
    have += r->group[k] >= 0 && r->s->configs[k].choice[r->s->series] == choice;
  return have == r->ngroups;
}

static void find_compared(study_rows *r) {
  for (int v = r->s->parameters[r->s->series].nvalues - 1; v >= 0 && r->compared < 0; v--)
    if (all_groups_have(r, v)) r->compared = v;
}

/* In groups the series has the colours, else each curve has one of its own. */
static void choose_colours(study_rows *r) {
  for (int k = 0, number = 0; k < r->s->nconfigs; k++) {
    r->colour[k] = -1;
    if (r->group[k] < 0) continue;
    r->colour[k] = r->grouped ? r->s->configs[k].choice[r->s->series] : number++;
    if (!r->grouped) r->group[k] = 0;
  }
}

gh_status study_rows_plan(const gh_study *s, study_rows *r) {
  *r = (study_rows){.s = s, .compared = -1, .extra = only_extra(s)};
  size_t n = (size_t)s->nconfigs;
  GH_TRY(gh_alloc(s->ctx, n, sizeof *r->first, &r->first));
  GH_TRY(gh_alloc(s->ctx, n, sizeof *r->group, &r->group));
  GH_TRY(gh_alloc(s->ctx, n, sizeof *r->colour, &r->colour));
  int curves = find_groups(r);
  r->grouped = curves > MOST_TOGETHER && r->ngroups > 1 && r->ngroups <= MOST_GROUPS && has_series(r);
  if (r->grouped && r->ngroups <= MOST_COMPARED) find_compared(r);
  if (!r->grouped && r->ngroups > 1) r->ngroups = 1;
  choose_colours(r);
  return GH_OK;
}

void study_rows_free(study_rows *r) {
  free(r->first);
  free(r->group);
  free(r->colour);
}

int study_rows_count(const study_rows *r) {
  return r->ngroups + (r->compared >= 0);
}

/* ---- how curves look ---- */

bool study_rows_line(const study_rows *r, int row, int k, study_line *line) {
  static const char *const group_colour[MOST_COMPARED] = {"#b2182b", "#2166ac", "#1b7837", "#762a83"};
  *line = (study_line){BLACK, 1, 1.6};
  if (k == r->extra) return true;
  if (r->group[k] < 0) return false;
  if (row < r->ngroups) {
    *line = (study_line){study_colour(r->colour[k]), 1, 1.1};
    return r->group[k] == row;
  }
  *line = (study_line){group_colour[r->group[k]], 1, 1.1};
  return r->s->configs[k].choice[r->s->series] == r->compared;
}

bool study_rows_given(const study_rows *r, study_line *line) {
  *line = (study_line){BLACK, 2, 1.6};
  return r->s->reference != STUDY_CONFIG && r->s->given.n > 0;
}

/* ---- names ---- */

static void name_append(char text[STUDY_NAME], const char *before, const char *more) {
  size_t n = strlen(text);
  snprintf(text + n, STUDY_NAME - n, "%s%s", before, more);
}

/* The references among the curves of a group, where not all of them are. */
static void name_references(const study_rows *r, int group, char name[STUDY_NAME]) {
  char value[128];
  int curves = 0, references = 0;
  for (int k = 0; k < r->s->nconfigs; k++) {
    if (r->group[k] != group) continue;
    curves++;
    references += study_is_reference(r->s, k);
  }
  if (references == 0) return;
  name_append(name, " (reference", references == curves ? "" : ": ");
  for (int k = 0, n = 0; k < r->s->nconfigs && references < curves; k++) {
    if (r->group[k] != group || !study_is_reference(r->s, k)) continue;
    study_short_value(r->s, k, r->s->series, value, sizeof value);
    name_append(name, n++ ? ", " : "", value);
  }
  name_append(name, "", ")");
}

void study_rows_name(const study_rows *r, int row, char name[STUDY_NAME]) {
  *name = 0;
  if (!r->grouped) return;
  if (row < r->ngroups) {
    study_legend(r->s, r->first[row], r->s->series, name, STUDY_NAME);
    name_references(r, row, name);
    return;
  }
  char value[128] = "";
  for (int k = r->s->nconfigs - 1; k >= 0; k--)
    if (r->group[k] >= 0 && r->s->configs[k].choice[r->s->series] == r->compared)
      study_short_value(r->s, k, r->s->series, value, sizeof value);
  snprintf(name, STUDY_NAME, "comparison for %s %s", r->s->parameters[r->s->series].name, value);
}
