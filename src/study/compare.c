/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The curves of a configuration against those of its reference. */
#include "study/judge.h"

#include <stdlib.h>
#include <string.h>

bool study_run_done(const study_run *r) {
  return r->finished && r->status == GH_OK && r->curve.n > 0;
}

int study_curve_at(const study_curve *c, double t) {
  if (c->n == 0) return -1;
  double near = 1e-9 * (c->n > 1 ? fabs(c->t[c->n - 1] - c->t[0]) : fmax(1, fabs(t)));
  int low = 0, high = c->n - 1;
  while (low < high) {
    int middle = (low + high) / 2;
    if (c->t[middle] < t - near) low = middle + 1;
    else high = middle;
  }
  return fabs(c->t[low] - t) <= near ? low : -1;
}

const study_curve *study_first_curve(const study_config *g) {
  for (int m = 0; m < g->nruns; m++)
    if (study_run_done(g->runs + m)) return &g->runs[m].curve;
  return NULL;
}

study_sample study_members_at(const gh_study *s, const study_config *g, double t, int column) {
  study_sample x = {0};
  double squares = 0, first = 0; /* members that are equal have exactly that mean */
  for (int pass = 0; pass < 2; pass++) {
    int n = 0;
    for (int m = 0; m < g->nruns; m++) {
      const study_curve *c = &g->runs[m].curve;
      if (!study_run_done(g->runs + m)) continue;
      int row = study_curve_at(c, t);
      if (row < 0) return (study_sample){0};
      double v = c->value[(size_t)row * (size_t)s->ncolumns + (size_t)column];
      if (n == 0) first = v;
      if (pass == 0) x.mean += v - first;
      else squares += (v - x.mean) * (v - x.mean);
      n++;
    }
    if (pass == 0 && n > 0) x.mean = first + x.mean / n;
    x.n = n;
  }
  x.deviation = x.n > 1 ? sqrt(squares / (x.n - 1)) : 0;
  return x;
}

/* ---- two sets of curves at the t that all have ---- */

typedef struct comparison {
  int na, nb, points, columns;
  bool paired;
  double student_a, student_b; /* quantiles for as many members */
  const study_curve *
      *curve; /* na of the configuration, then nb of the reference; paired: in the same order */
  int *row;   /* (na + nb) x points */
} comparison;

static double value(const comparison *c, int member, int point, int column) {
  int row = c->row[(size_t)member * (size_t)c->points + (size_t)point];
  return c->curve[member]->value[(size_t)row * (size_t)c->columns + (size_t)column];
}

/* Over the members from `first` on; minus >= 0: of their differences from the members from there on. */
static study_sample sample(const comparison *c, int first, int n, int minus, int point, int column) {
  study_sample x = {.n = n};
  double squares = 0, origin = 0; /* members that are equal have exactly that mean */
  for (int pass = 0; pass < 2; pass++) {
    for (int m = 0; m < n; m++) {
      double v = value(c, first + m, point, column);
      if (minus >= 0) v -= value(c, minus + m, point, column);
      if (m == 0) origin = v;
      if (pass == 0) x.mean += v - origin;
      else squares += (v - x.mean) * (v - x.mean);
    }
    if (pass == 0) x.mean = origin + x.mean / n;
  }
  x.deviation = n > 1 ? sqrt(squares / (n - 1)) : 0;
  return x;
}

/* Both have the same packings, one after the other. */
static bool same_packings(const study_config *a, const study_config *b) {
  if (a->nruns != b->nruns) return false;
  for (int m = 0; m < a->nruns; m++) {
    const char *p = a->runs[m].packing, *q = b->runs[m].packing;
    if ((p || q) && (!p || !q || strcmp(p, q) != 0)) return false;
  }
  return true;
}

/* Which curves are compared. */
static gh_status choose(const gh_study *s, const study_config *g, comparison *c) {
  const study_config *r = g->reference >= 0 ? s->configs + g->reference : NULL;
  size_t most = (size_t)g->nruns + (r ? (size_t)r->nruns : 1);
  GH_TRY(gh_alloc(s->ctx, most, sizeof *c->curve, &c->curve));
  c->columns = s->ncolumns;
  c->paired = r && same_packings(g, r);
  for (int m = 0; m < g->nruns; m++)
    if (study_run_done(g->runs + m) && (!c->paired || study_run_done(r->runs + m)))
      c->curve[c->na++] = &g->runs[m].curve;
  for (int m = 0; r && m < r->nruns; m++)
    if (study_run_done(r->runs + m) && (!c->paired || study_run_done(g->runs + m)))
      c->curve[c->na + c->nb++] = &r->runs[m].curve;
  if (!r && s->given.n > 0) c->curve[c->na + c->nb++] = &s->given;
  c->student_a = study_student(c->na - 1), c->student_b = study_student(c->nb - 1);
  return GH_OK;
}

/* The t that all these curves have. */
static gh_status align(const gh_study *s, comparison *c) {
  int all = c->na + c->nb, most = c->curve[0]->n, n = 0;
  int *found;
  GH_TRY(gh_alloc(s->ctx, (size_t)all * (size_t)most, sizeof *found, &found));
  for (int k = 0; k < most; k++) {
    bool common = true;
    for (int m = 0; m < all && common; m++) {
      int row = study_curve_at(c->curve[m], c->curve[0]->t[k]);
      found[(size_t)m * (size_t)most + (size_t)n] = row;
      common = row >= 0;
    }
    n += common;
  }
  c->points = n;
  for (int m = 1; m < all; m++)
    memmove(found + (size_t)m * (size_t)n, found + (size_t)m * (size_t)most, (size_t)n * sizeof *found);
  c->row = found;
  return GH_OK;
}

/* ---- errors ---- */

/* Of the interval of the mean; NAN with one member, whose quantile is. */
static double squared_half_width(study_sample x, double student) {
  return student * student * x.deviation * x.deviation / x.n;
}

/* part over whole, both norms; equal when there is nothing on either side, unknown over nothing. */
static double relative(double part, double whole) {
  if (whole > 0) return part / whole;
  return part == 0 && whole == 0 ? 0 : NAN;
}

/* Root mean square over the members of |q_m - q_ref| / |q_ref|, each against itself where they are paired. */
static double single_error(const comparison *c, const study_quantity *q) {
  double squares = 0;
  for (int m = 0; m < c->na; m++) {
    double difference = 0, norm = 0;
    for (int p = 0; p < c->points; p++)
      for (int k = q->first; k < q->first + q->count; k++) {
        double v = value(c, m, p, k),
               ref = c->paired ? value(c, c->na + m, p, k) : sample(c, c->na, c->nb, -1, p, k).mean;
        difference += (v - ref) * (v - ref);
        norm += ref * ref;
      }
    double e = relative(sqrt(difference), sqrt(norm));
    squares += e * e;
  }
  return sqrt(squares / c->na);
}

static void compare_quantity(const comparison *c, const study_quantity *q, int k, study_judged *row) {
  double difference = 0, norm = 0, confidence = 0, chance = 0, largest = 0, largest_norm = 0;
  for (int p = 0; p < c->points; p++) {
    double d2 = 0, r2 = 0;
    for (int j = q->first; j < q->first + q->count; j++) {
      study_sample a = sample(c, 0, c->na, -1, p, j), b = sample(c, c->na, c->nb, -1, p, j);
      double own = squared_half_width(a, c->student_a);
      d2 += (a.mean - b.mean) * (a.mean - b.mean);
      r2 += b.mean * b.mean;
      confidence += own;
      if (c->paired) chance += squared_half_width(sample(c, 0, c->na, c->na, p, j), c->student_a);
      else chance += own + (c->nb > 1 ? squared_half_width(b, c->student_b) : 0);
    }
    difference += d2, norm += r2;
    largest = fmax(largest, d2), largest_norm = fmax(largest_norm, r2);
  }
  if (isnan(difference)) largest = NAN; /* fmax passes over what is unknown */
  row->l2[k] = relative(sqrt(difference), sqrt(norm));
  row->largest[k] = relative(sqrt(largest), sqrt(largest_norm));
  row->confidence[k] = relative(sqrt(confidence), sqrt(norm));
  row->chance[k] = relative(sqrt(chance), sqrt(norm));
  row->single[k] = single_error(c, q);
}

/* Why there is nothing to compare; NULL: there is. */
static const char *obstacle(const gh_study *s, const study_config *g, const comparison *c) {
  if (!study_first_curve(g)) return "no run came to the end";
  if (g->reference >= 0 ? !study_first_curve(s->configs + g->reference) : c->nb == 0)
    return "its reference did not come to the end";
  if (c->na == 0) return "no packing came to the end both here and in the reference";
  return NULL;
}

/* Why an error is NAN although both sides have points. */
static const char *unknown(const comparison *c, const study_quantity *q) {
  for (int m = 0; m < c->na + c->nb; m++)
    for (int p = 0; p < c->points; p++)
      for (int k = q->first; k < q->first + q->count; k++)
        if (isnan(value(c, m, p, k))) return "some values are unknown, here or in the reference";
  return "the reference is zero throughout";
}

gh_status study_compare(const gh_study *s, const study_config *g, study_judged *row) {
  comparison c = {0};
  gh_status status = choose(s, g, &c);
  if (status == GH_OK) {
    row->paired = c.paired;
    row->why = obstacle(s, g, &c);
    if (!row->why) status = align(s, &c);
  }
  if (status == GH_OK && !row->why) {
    row->points = c.points;
    if (c.points < 2) row->why = "it has fewer than two values of t in common with the reference";
    for (int k = 0; k < s->nquantities && !row->why; k++) compare_quantity(&c, s->quantities + k, k, row);
    if (!row->why && isnan(row->l2[s->main])) row->why = unknown(&c, s->quantities + s->main);
  }
  free(c.curve);
  free(c.row);
  return status;
}
