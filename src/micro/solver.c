/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The linear system of the unknowns of an RVE: number, factor, solve, behind one table for all libraries. */
#include "micro/internal.h"

#include <stdlib.h>

void gh_solver_destroy(gh_solver **solver) {
  if (!solver || !*solver) return;
  (*solver)->ops->release(*solver);
  free((*solver)->unknown);
  free((*solver)->rhs);
  free(*solver);
  *solver = NULL;
}

gh_status gh_solver_number(gh_context *ctx, gh_solver *s, const gh_solver_input *in) {
  return s->ops->number(ctx, s, in);
}

gh_status gh_solver_factor(gh_context *ctx, gh_solver *s, const gh_solver_input *in, double shift,
                           bool *good) {
  return s->ops->factor(ctx, s, in, shift, good);
}

gh_status gh_solver_solve(gh_context *ctx, gh_solver *s, int ncol, const double **X) {
  return s->ops->solve(ctx, s, ncol, X);
}

/* Root of a grain in the forest of connected components. */
static int component_root(int *parent, int i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

void gh_find_components(int n, const gh_contact_list *list, const unsigned char *without, int *component) {
  for (int i = 0; i < n; i++) component[i] = i;
  for (int c = 0; c < list->count; c++) {
    int i = list->contacts[c].i, j = list->contacts[c].j;
    if (without && (without[i] || without[j])) continue;
    i = component_root(component, i), j = component_root(component, j);
    component[i > j ? i : j] = i > j ? j : i; /* the root is the first grain of its component */
  }
}
