/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Orders of convergence. */
#include "study/judge.h"

#include <stdlib.h>

static const double ROUND_OFF = 1e-13; /* an error below is none */

typedef struct point {
  double x, error; /* x: log of the parameter, growing from coarse to fine */
  int config;
} point;

static double parameter_of(const gh_study *s, int config) {
  const study_config *g = s->configs + config;
  double number = NAN;
  if (g->choice[s->order] >= 0) return s->parameters[s->order].number[g->choice[s->order]];
  return gh_parse_number(g->value[s->order], &number) ? number : NAN;
}

static bool point_usable(const gh_study *s, int config) {
  return study_is_rated(s, config) && parameter_of(s, config) > 0;
}

/* Whether larger values are finer: the reference lies on the fine side; where it does not differ in this
 * parameter, the errors decide. */
static bool parameter_grows(const gh_study *s) {
  double sum = 0;
  for (int k = 0; k < s->nconfigs; k++) {
    int r = s->configs[k].reference;
    if (!point_usable(s, k) || r < 0) continue;
    double there = parameter_of(s, r), here = parameter_of(s, k);
    if (isfinite(there) && there != here) sum += there > here ? 1 : -1;
  }
  if (sum != 0) return sum > 0;
  for (int a = 0; a < s->nconfigs; a++)
    for (int b = 0; b < a; b++) {
      if (!point_usable(s, a) || !point_usable(s, b) || !study_alike(s, a, b, s->order)) continue;
      double ea = fmax(study_error_of(s, a), ROUND_OFF), eb = fmax(study_error_of(s, b), ROUND_OFF);
      sum -= log(ea / eb) * log(parameter_of(s, a) / parameter_of(s, b));
    }
  return sum >= 0;
}

static int points_by_x(const void *a, const void *b) {
  const point *p = a, *q = b;
  return p->x < q->x ? -1 : p->x > q->x;
}

/* The configurations that differ from `first` in the order parameter alone, from coarse to fine. */
static int points_collect(const gh_study *s, int first, point *p) {
  int n = 0;
  for (int k = first; k < s->nconfigs; k++)
    if (point_usable(s, k) && study_alike(s, k, first, s->order))
      p[n++] = (point){(s->verdict->grows ? 1 : -1) * log(parameter_of(s, k)), study_error_of(s, k), k};
  qsort(p, (size_t)n, sizeof *p, points_by_x);
  return n;
}

/* Order of the step that ends at point k; NAN at the first and where an error is zero. */
static double order_at(const point *p, int k) {
  if (k == 0 || !(p[k].error > 0) || !(p[k - 1].error > 0)) return NAN;
  return log(p[k - 1].error / p[k].error) / (p[k].x - p[k - 1].x);
}

/* What the errors do not fall below: round-off; where they end on a plateau (the smallest is not the last, or
 * the last step's order is less than a quarter of the best one), the smallest of them. */
static double find_floor(const point *p, int n) {
  double smallest = INFINITY, best = 0;
  for (int k = 0; k < n; k++) {
    smallest = fmin(smallest, p[k].error);
    best = fmax(best, order_at(p, k));
  }
  bool plateau = n > 2 && (p[n - 1].error > smallest || order_at(p, n - 1) < best / 4);
  return plateau ? fmax(smallest, ROUND_OFF) : ROUND_OFF;
}

/* The longest run of points over which the error falls and is above the limit: length, *first. */
static int longest_fall(const point *p, int n, double limit, int *first) {
  int longest = 0, length = 0;
  for (int k = 0; k < n; k++) {
    bool above = p[k].error > limit;
    length = !above ? 0 : length > 0 && p[k].error < p[k - 1].error ? length + 1 : 1;
    if (length > longest) longest = length, *first = k - length + 1;
  }
  return longest;
}

/* Minus the slope of log error over x. */
static double points_slope(const point *p, int n) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (int k = 0; k < n; k++) x += p[k].x / n, y += log(p[k].error) / n;
  for (int k = 0; k < n; k++) {
    xx += (p[k].x - x) * (p[k].x - x);
    xy += (p[k].x - x) * (log(p[k].error) - y);
  }
  return -xy / xx;
}

static void points_fit(gh_study *s, const point *p, int n, struct study_fit *f) {
  int first = 0, parameter = s->order;
#define CHOICE(k) s->configs[p[k].config].choice[parameter]
  f->order = NAN;
  f->from = f->to = f->up_from = f->up_to = -1;
  f->monotone = true;
  for (int k = 1; k < n && f->monotone; k++) {
    f->monotone = p[k].error < p[k - 1].error || p[k].error <= ROUND_OFF;
    if (!f->monotone) f->up_from = CHOICE(k - 1), f->up_to = CHOICE(k);
  }
  for (int k = 1; k < n; k++) s->verdict->row[p[k].config].order = order_at(p, k);
  int used = longest_fall(p, n, 10 * find_floor(p, n), &first);
  if (used < 2) return;
  f->order = points_slope(p + first, used);
  f->from = CHOICE(first), f->to = CHOICE(first + used - 1);
#undef CHOICE
}

gh_status study_fit_orders(gh_study *s) {
  study_verdict *v = s->verdict;
  point *p;
  GH_TRY(gh_alloc(s->ctx, (size_t)s->nconfigs, sizeof *v->fits, &v->fits));
  GH_TRY(gh_alloc(s->ctx, (size_t)s->nconfigs, sizeof *p, &p));
  v->grows = parameter_grows(s);
  for (int k = 0; k < s->nconfigs; k++) {
    if (s->configs[k].extra || !study_first_alike(s, k, s->order)) continue;
    v->fits[v->nfits].first = k;
    points_fit(s, p, points_collect(s, k, p), v->fits + v->nfits++);
  }
  free(p);
  return GH_OK;
}
