/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Pareto fronts. */
#include "study/judge.h"

#include <stdlib.h>

typedef struct point {
  double cost, error;
  int index;
} point;

static int by_cost(const void *a, const void *b) {
  const point *p = a, *q = b;
  if (p->cost != q->cost) return p->cost < q->cost ? -1 : 1;
  if (p->error != q->error) return p->error < q->error ? -1 : 1;
  return p->index < q->index ? -1 : p->index > q->index;
}

/* From the cheapest on, what errs less than all before is on the front, and so is what equals the last one.
 */
gh_status study_front(gh_context *ctx, int n, const double *cost, const double *error, bool *front,
                      int *order, int *count) {
  point *p;
  *count = 0;
  GH_TRY(gh_alloc(ctx, (size_t)n, sizeof *p, &p));
  for (int k = 0; k < n; k++) p[k] = (point){cost[k], error[k], k};
  qsort(p, (size_t)n, sizeof *p, by_cost);
  const point *last = NULL;
  for (int k = 0; k < n; k++) {
    bool equal = last && p[k].cost == last->cost && p[k].error == last->error;
    front[p[k].index] = !last || p[k].error < last->error || equal;
    if (!front[p[k].index]) continue;
    last = p + k;
    order[(*count)++] = p[k].index;
  }
  free(p);
  return GH_OK;
}
