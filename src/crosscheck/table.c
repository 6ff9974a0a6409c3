/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The tables of a cross-check, for a reader. */
#include "crosscheck/crosscheck.h"

static void engine_print(const gh_crosscheck *c, int e, gh_text *out) {
  const cross_level *level = &c->level[0];
  const gh_peer_result *r = &level->trace[e].result;
  long steps = 0;
  int row;
  for (int k = 0; k < r->rows; k++) steps += level->trace[e].rows[k].steps;
  gh_text_print(out, "%-26s %-8s", cross_title(c, e), gh_peer_end_text(r->end));
  if (r->rows == 0) {
    gh_text_print(out, " %8s %9s %8s %11s\n", "-", "-", "-", "-");
    return;
  }
  gh_text_print(out, " %8d %9ld %8.3f", level->trace[e].rows[r->rows - 1].contacts, steps, r->seconds);
  double worst = cross_worst(c, level, e, level, 0, &row);
  if (e == 0) gh_text_print(out, " %11s\n", "reference");
  else if (isnan(worst)) gh_text_print(out, " %11s\n", "-");
  else gh_text_print(out, " %11.2e %6ld\n", worst, c->o.step[row]);
}

/* A line per level; from line to line the values fall as (1/2)^order. */
static void refinement_print(const gh_crosscheck *c, bool change, gh_text *out) {
  double rest = cross_round_off(c);
  gh_text_print(out, "%-8s", "substeps");
  for (int e = change ? 0 : 1; e < c->o.engines; e++) gh_text_print(out, " %10s order", cross_word(c, e));
  gh_text_print(out, "\n");
  for (int k = change; k < c->o.levels; k++) {
    gh_text_print(out, "%-8d", c->level[k].substeps);
    for (int e = change ? 0 : 1; e < c->o.engines; e++) {
      double d = cross_refined(c, k, e, change), before = k ? cross_refined(c, k - 1, e, change) : NAN;
      if (isnan(d)) gh_text_print(out, " %10s", "-");
      else gh_text_print(out, " %10.2e", d);
      if (d > rest && before > rest) gh_text_print(out, " %5.2f", log2(before / d));
      else gh_text_print(out, " %5s", "");
    }
    gh_text_print(out, "\n");
  }
}

/* Why a program did not finish: each level, but once where it is missing or unable. */
static void reasons_print(const gh_crosscheck *c, gh_text *out) {
  for (int k = 0; k < c->o.levels; k++)
    for (int e = 0; e < c->o.engines; e++) {
      const gh_peer_result *r = &c->level[k].trace[e].result;
      bool again = k > 0 && (r->end == GH_PEER_MISSING || r->end == GH_PEER_UNABLE);
      if (r->end == GH_PEER_DONE || again) continue;
      gh_text_print(out, "%s", cross_title(c, e));
      if (k > 0) gh_text_print(out, " (%d substeps)", c->level[k].substeps);
      gh_text_print(out, ": %s: %s\n", gh_peer_end_text(r->end), r->message);
    }
}

void gh_crosscheck_print(const gh_crosscheck *c, gh_text *out) {
  gh_text_print(out, "%-26s %-8s %8s %9s %8s %11s %6s\n", "engine", "end", "contacts", "steps", "seconds",
                "difference", "step");
  for (int e = 0; e < c->o.engines; e++) engine_print(c, e, out);
  gh_text_print(
      out, "difference: of any component of the Cauchy stress, over the largest of %s on the path, %.6g\n",
      cross_title(c, 0), cross_scale(c, c->level, 0));
  if (c->o.levels > 1) {
    gh_text_print(out, "\nEach increment in substeps: largest difference to %s with as many substeps\n",
                  cross_title(c, 0));
    refinement_print(c, false, out);
    gh_text_print(out, "\nChange of each from half as many substeps\n");
    refinement_print(c, true, out);
  }
  reasons_print(c, out);
}
