/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Sieve curves: which grains a packing has (3.12, 3.13). */
#include "packing/sieve.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static const double HUNDRED_WITHIN = 0.5; /* percent; tables are rounded */

void gh_sieve_destroy(gh_sieve **sieve) {
  if (!sieve || !*sieve) return;
  free((*sieve)->diameter);
  free((*sieve)->amount);
  free(*sieve);
  *sieve = NULL;
}

/* ---- reading ---- */

static const double SMALLEST = 1e-90, LARGEST = 1e90;

gh_status gh_sieve_refuse(const gh_sieve_source *s, int k, const char *what, double value,
                          const char *limit) {
  if (s->path)
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: %s is %g, %s", s->path, s->line[k], what, value, limit);
  return gh_fail(s->ctx, GH_INPUT, "sieve curve, row %d: %s is %g, %s", k + 1, what, value, limit);
}

static gh_status refuse_curve(const gh_sieve_source *s, const char *words, double value) {
  return gh_fail(s->ctx, GH_INPUT, "%s: %s %g", s->path ? s->path : "sieve curve", words, value);
}

static gh_status check_rows(const gh_sieve_source *s, gh_sieve_kind kind, int n, const double *d,
                            const double *v) {
  static const char *const names[] = {"count", "volume_percent", "passing"};
  for (int k = 0; k < n; k++) {
    if (!(d[k] > 0) || !isfinite(d[k])) return gh_sieve_refuse(s, k, "diameter", d[k], "it must be positive");
    if (d[k] < SMALLEST || d[k] > LARGEST) /* its third power goes into shares and volumes */
      return gh_sieve_refuse(s, k, "diameter", d[k], "it must lie between 1e-90 and 1e90");
    if (k && !(n > 1 && (d[k] - d[k - 1]) * (d[1] - d[0]) > 0))
      return gh_sieve_refuse(s, k, "diameter", d[k], "the diameters must rise, or fall, from row to row");
    if (!(v[k] >= 0)) return gh_sieve_refuse(s, k, names[kind], v[k], "it must not be negative");
    if (kind == GH_SIEVE_COUNT && (v[k] != floor(v[k]) || v[k] > INT_MAX))
      return gh_sieve_refuse(s, k, "count", v[k], "it must be a whole number");
    if (kind != GH_SIEVE_COUNT && v[k] > 100 + 1e-9)
      return gh_sieve_refuse(s, k, names[kind], v[k], "it must be at most 100 percent");
  }
  return GH_OK;
}

/* From rows in ascending order (row(k): index of the k-th in the input) to amounts. */
static gh_status amounts(const gh_sieve_source *s, gh_sieve *c, const double *v, bool falling) {
  double sum = 0;
  for (int k = 0; k < c->n; k++) {
    int row = falling ? c->n - 1 - k : k, before = falling ? row + 1 : row - 1;
    double value = v[row];
    if (c->kind == GH_SIEVE_PASSING && k) {
      if (value < v[before])
        return gh_sieve_refuse(s, row, "passing", value, "it must not fall as the diameter grows");
      value -= v[before];
    }
    c->amount[k] = value;
    sum += value;
  }
  if (c->kind == GH_SIEVE_PASSING && !(sum >= 100 - HUNDRED_WITHIN))
    return refuse_curve(s, "passing must reach 100 at the largest diameter; it ends at", sum);
  if (c->kind == GH_SIEVE_VOLUME && !(fabs(sum - 100) <= HUNDRED_WITHIN))
    return refuse_curve(s, "the shares volume_percent must add up to 100; their sum is", sum);
  if (!(sum > 0)) return refuse_curve(s, "a sieve curve without grains; the sum of its counts is", sum);
  return GH_OK;
}

gh_status gh_sieve_from_rows(const gh_sieve_source *s, gh_sieve_kind kind, int n, const double *diameter,
                             const double *value, gh_sieve **sieve) {
  gh_sieve *c = NULL;
  *sieve = NULL;
  if (n < 1) return refuse_curve(s, "a sieve curve needs at least one row; it has", n);
  GH_TRY(check_rows(s, kind, n, diameter, value));
  GH_TRY(gh_alloc(s->ctx, 1, sizeof *c, &c));
  gh_status status;
  bool falling = n > 1 && diameter[1] < diameter[0];
  c->n = n, c->kind = kind;
  GH_TRY_OR(gh_alloc(s->ctx, (size_t)n, sizeof(double), &c->diameter), failed);
  GH_TRY_OR(gh_alloc(s->ctx, (size_t)n, sizeof(double), &c->amount), failed);
  for (int k = 0; k < n; k++) c->diameter[k] = diameter[falling ? n - 1 - k : k];
  GH_TRY_OR(amounts(s, c, value, falling), failed);
  *sieve = c;
  return GH_OK;
failed:
  gh_sieve_destroy(&c);
  return status;
}

gh_status gh_sieve_create(gh_context *ctx, gh_sieve_kind kind, int n, const double *diameter,
                          const double *value, gh_sieve **sieve) {
  gh_sieve_source s = {.ctx = ctx};
  return gh_sieve_from_rows(&s, kind, n, diameter, value, sieve);
}

/* ---- numbers of grains ---- */

void gh_sieve_shares(const gh_sieve *sieve, int dim, double *share) {
  double sum = 0;
  for (int k = 0; k < sieve->n; k++) {
    share[k] = sieve->amount[k];
    if (sieve->kind != GH_SIEVE_COUNT) share[k] /= pow(sieve->diameter[k], dim);
    sum += share[k];
  }
  for (int k = 0; k < sieve->n; k++) share[k] /= sum;
}

double gh_sieve_least(const gh_sieve *sieve, int dim) {
  double sum = 0, least = INFINITY;
  for (int k = 0; k < sieve->n; k++) {
    double weight = sieve->amount[k];
    if (sieve->kind != GH_SIEVE_COUNT) weight /= pow(sieve->diameter[k], dim);
    sum += weight;
    if (weight > 0) least = fmin(least, weight);
  }
  return ceil(sum / least *
              (1 - 1e-12)); /* 150 grains of which one is the only one of its kind: 150, not 151 */
}

/* Largest remainder: whole parts, then one more where most is missing. */
static void round_to(int n, const double *share, int total, int *count) {
  int given = 0;
  for (int k = 0; k < n; k++) given += count[k] = (int)(share[k] * total * (1 + 1e-12));
  while (given < total) {
    int most = -1;
    for (int k = 0; k < n; k++)
      if (share[k] > 0 && (most < 0 || share[k] * total - count[k] > share[most] * total - count[most]))
        most = k;
    count[most]++;
    given++;
  }
}

gh_status gh_sieve_counts(gh_context *ctx, const gh_sieve *sieve, int dim, int total, int *count) {
  double own = 0, least = gh_sieve_least(sieve, dim), *share;
  for (int k = 0; k < sieve->n; k++) own += sieve->amount[k];
  if (total == 0) {
    if (sieve->kind != GH_SIEVE_COUNT)
      return gh_fail(ctx, GH_INPUT,
                     "a sieve curve in percent needs a number of grains: --count N, at least %.0f", least);
    if (own > INT_MAX / 8)
      return gh_fail(ctx, GH_INPUT, "%.0f grains are too many, at most %d", own, INT_MAX / 8);
    for (int k = 0; k < sieve->n; k++) count[k] = (int)sieve->amount[k];
    return GH_OK;
  }
  if (total < least)
    return gh_fail(
        ctx, GH_INPUT,
        "%d grains are too few for one of each fraction of the sieve curve: --count must be at least %.0f "
        "in %d dimensions",
        total, least, dim);
  GH_TRY(gh_alloc(ctx, (size_t)sieve->n, sizeof *share, &share));
  gh_sieve_shares(sieve, dim, share);
  round_to(sieve->n, share, total, count);
  free(share);
  return GH_OK;
}

gh_status gh_sieve_grains(gh_context *ctx, const gh_sieve *sieve, const int *count, int *n, double **diameter,
                          int **type) {
  size_t total = 0, at = 0;
  *diameter = NULL, *type = NULL;
  for (int k = 0; k < sieve->n; k++) total += (size_t)count[k];
  GH_TRY(gh_alloc(ctx, total, sizeof(double), diameter));
  gh_status status = gh_alloc(ctx, total, sizeof(int), type);
  if (status != GH_OK) {
    free(*diameter);
    *diameter = NULL;
    return status;
  }
  for (int k = sieve->n - 1; k >= 0; k--)
    for (int m = 0; m < count[k]; m++, at++) {
      (*diameter)[at] = sieve->diameter[k];
      (*type)[at] = k + 1;
    }
  *n = (int)total;
  return GH_OK;
}
