/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The CSV files of a cross-check. */
#include "crosscheck/crosscheck.h"

#include <stdlib.h>

const int cross_component[CROSS_COMPONENTS] = {0, 3, 1};
const char *const cross_component_name[CROSS_COMPONENTS] = {"11", "22", "12"};

static gh_status table_commit(const gh_crosscheck *c, gh_text *text, const char *folder, const char *name) {
  char *path = gh_path_join(folder, name);
  gh_status status = path ? gh_text_commit(text, path) : gh_fail(c->ctx, GH_MEMORY, "no memory for a path");
  free(path);
  gh_text_destroy(&text);
  return status;
}

/* A field of a CSV line; empty for what there is not. */
static void field_print(gh_text *t, int digits, double value) {
  gh_text_print(t, ",");
  if (!isnan(value)) gh_text_print(t, "%.*g", digits, value);
}

static void stress_print(const gh_crosscheck *c, gh_text *t, int row) {
  const cross_level *level = &c->level[0];
  const gh_peer_row *reference = cross_row(level, 0, row);
  const double *F = c->o.F + 4 * row, scale = cross_scale(c, level, 0);
  gh_text_print(t, "%ld,%.17g,%.17g,%.17g,%.17g", c->o.step[row], F[0], F[1], F[2], F[3]);
  for (int e = 0; e < c->o.engines; e++) {
    const gh_peer_row *r = cross_row(level, e, row);
    bool both = r && reference && scale > 0;
    for (int k = 0; k < CROSS_COMPONENTS; k++) field_print(t, 17, r ? r->cauchy[cross_component[k]] : NAN);
    field_print(t, 9, r ? r->contacts : NAN);
    field_print(t, 6, r ? r->residual : NAN);
    field_print(t, 9, r ? (double)r->steps : NAN);
    for (int k = 0; k < CROSS_COMPONENTS && e > 0; k++) {
      int n = cross_component[k];
      field_print(t, 6, both ? (r->cauchy[n] - reference->cauchy[n]) / scale : NAN);
    }
  }
  gh_text_print(t, "\n");
}

static gh_status stresses_write(const gh_crosscheck *c, const char *folder) {
  gh_text *t;
  GH_TRY(gh_text_create(c->ctx, &t));
  gh_text_print(t, "step,F11,F12,F21,F22");
  for (int e = 0; e < c->o.engines; e++) {
    const char *word = cross_word(c, e);
    for (int k = 0; k < CROSS_COMPONENTS; k++) gh_text_print(t, ",%s_s%s", word, cross_component_name[k]);
    gh_text_print(t, ",%s_contacts,%s_residual,%s_steps", word, word, word);
    for (int k = 0; k < CROSS_COMPONENTS && e > 0; k++)
      gh_text_print(t, ",%s_d%s", word, cross_component_name[k]);
  }
  gh_text_print(t, "\n");
  for (int row = 0; row < c->o.rows; row++) stress_print(c, t, row);
  return table_commit(c, t, folder, "crosscheck.csv");
}

/* Per level: the difference to the reference, and the change of each program from the level before. */
static gh_status refinement_write(const gh_crosscheck *c, const char *folder) {
  gh_text *t;
  GH_TRY(gh_text_create(c->ctx, &t));
  gh_text_print(t, "parts");
  for (int e = 0; e < c->o.engines; e++) {
    const char *word = cross_word(c, e);
    gh_text_print(t, ",%s_difference,%s_change,%s_seconds", word, word, word);
  }
  for (int k = 0; k < c->o.levels; k++) {
    const cross_level *level = c->level + k;
    gh_text_print(t, "\n%d", level->substeps);
    for (int e = 0; e < c->o.engines; e++) {
      const gh_peer_result *r = &level->trace[e].result;
      field_print(t, 6, cross_refined(c, k, e, false));
      field_print(t, 6, cross_refined(c, k, e, true));
      field_print(t, 6, r->rows ? r->seconds : NAN);
    }
  }
  gh_text_print(t, "\n");
  return table_commit(c, t, folder, "refine.csv");
}

gh_status cross_files_write(const gh_crosscheck *c, const char *folder) {
  GH_TRY(stresses_write(c, folder));
  return c->o.levels > 1 ? refinement_write(c, folder) : GH_OK;
}
