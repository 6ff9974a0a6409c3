/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Converged states to come back to: references, entered in the books. */
#include "farm/internal.h"

#include <stdlib.h>
#include <string.h>

struct gh_farm_mark {
  int *state;               /* of each point, with a reference of its own */
  gh_rve_measures *measure; /* of the last evaluation then */
};

gh_status gh_farm_mark_states(gh_farm *f, gh_farm_mark **mark) {
  *mark = NULL;
  if (!f->shared) return gh_fail(f->ctx, GH_INPUT, "only the states of RVEs can be marked");
  farm_books *b = &f->shared->books;
  gh_farm_mark *m;
  gh_status status;
  size_t n = (size_t)b->n;
  GH_TRY(gh_alloc(f->ctx, 1, sizeof *m, &m));
  GH_TRY_OR(gh_alloc(f->ctx, n, sizeof *m->state, &m->state), failed);
  GH_TRY_OR(gh_alloc(f->ctx, n, sizeof *m->measure, &m->measure), failed);
  memcpy(m->state, b->state, n * sizeof *m->state);
  memcpy(m->measure, b->measure, n * sizeof *m->measure);
  for (int k = 0; k < b->n; k++) b->states[m->state[k]].users++;
  *mark = m;
  return GH_OK;
failed:
  free(m->state);
  free(m);
  return status;
}

void gh_farm_return(gh_farm *f, const gh_farm_mark *m) {
  farm_books *b = &f->shared->books;
  b->trial = false;
  farm_books_forget(b);
  memcpy(b->measure, m->measure, (size_t)b->n * sizeof *b->measure);
  for (int k = 0; k < b->n; k++) {
    farm_books_enter(b, k, m->state[k]);
    b->job[k] = -1; /* the last evaluation is none of this state */
  }
}

void gh_farm_drop_mark(gh_farm *f, gh_farm_mark **mark) {
  if (!mark || !*mark) return;
  farm_books *b = &f->shared->books;
  for (int k = 0; k < b->n; k++) farm_books_release(b, (*mark)->state[k]);
  free((*mark)->state);
  free((*mark)->measure);
  free(*mark);
  *mark = NULL;
}
