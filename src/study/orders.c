/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The table of orders of convergence that people read. */
#include "study/judge.h"

/* Columns: the other parameters that are varied, the order, from, to, remark. */
static int other_parameters(const gh_study *s, int *parameter, int wanted) {
  int n = 0;
  for (int k = 0; k < s->nparameters; k++) {
    if (k == s->order || s->parameters[k].nvalues < 2) continue;
    if (n++ == wanted) *parameter = k;
  }
  return n;
}

static void remark(const gh_study *s, const struct study_fit *f, char text[STUDY_CELL]) {
  char **value = s->parameters[s->order].value;
  *text = 0;
  if (!f->monotone)
    snprintf(text, STUDY_CELL, "not monotone: the error does not fall from %s to %s", value[f->up_from],
             value[f->up_to]);
  else if (isnan(f->order)) snprintf(text, STUDY_CELL, "too few values for a fit");
}

static bool order_cell(const study_table *t, int row, int column, char text[STUDY_CELL]) {
  static const char *const heads[] = {"order", "from", "to", ""};
  const gh_study *s = t->s;
  const struct study_fit *f = row < 0 ? NULL : s->verdict->fits + row;
  int parameter = 0, others = other_parameters(s, &parameter, column), what = column - others;
  *text = 0;
  if (what < 0)
    study_plain(f ? s->configs[f->first].value[parameter] : s->parameters[parameter].name, text, STUDY_CELL);
  else if (!f && what == 0) snprintf(text, STUDY_CELL, "order in %s", s->parameters[s->order].name);
  else if (!f) snprintf(text, STUDY_CELL, "%s", heads[what]);
  else if (what == 0) snprintf(text, STUDY_CELL, "%s", study_order_word(f->order).text);
  else if (what == 3) remark(s, f, text);
  else {
    int choice = what == 1 ? f->from : f->to;
    snprintf(text, STUDY_CELL, "%s", choice < 0 ? "-" : s->parameters[s->order].value[choice]);
  }
  return what >= 0 && what < 3;
}

/* The value next to the reference shares much of its error. */
static bool near_reference(const gh_study *s) {
  for (int k = 0; k < s->nconfigs; k++) {
    double here, there;
    int r = s->configs[k].reference;
    if (!study_is_rated(s, k) || r < 0) continue;
    if (!gh_parse_number(s->configs[k].value[s->order], &here) ||
        !gh_parse_number(s->configs[r].value[s->order], &there))
      continue;
    double ratio = s->verdict->grows ? there / here : here / there;
    if (ratio > 1 && ratio < 4) return true;
  }
  return false;
}

void study_print_orders(const gh_study *s, study_style style, gh_text *out) {
  int parameter = 0;
  study_table t = {.s = s, .cell = order_cell, .rows = s->verdict->nfits};
  if (s->order < 0 || t.rows == 0) return;
  t.columns = other_parameters(s, &parameter, -1) + 4;
  study_print_table(&t, style, out);
  gh_text_print(out,
                "\nOrders are slopes of log error over log %s, fitted where the error falls and is ten "
                "times above its floor; in the table above between one value and the one before.",
                s->parameters[s->order].name);
  if (near_reference(s))
    gh_text_print(out, " The finest values are less than four times coarser than the reference, which makes "
                       "their errors too small and the last orders too large.");
  gh_text_print(out, "\n");
}
