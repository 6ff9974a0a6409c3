/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tables of sieve curves: which column is what. */
#include "packing/sieve.h"
#include "granhom/io.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const double HUNDRED_WITHIN = 0.5; /* percent; tables are rounded */

/* ---- columns ---- */

typedef enum { DIAMETER, COUNT, VOLUME, PASSING, RETAINED, INDIVIDUAL, CUMULATIVE, UNKNOWN } column_kind;

/* In lower case, without unit and percent signs, with one blank between words. */
static const struct {
  const char *name;
  column_kind kind;
} names[] = {{"diameter", DIAMETER},
             {"d", DIAMETER},
             {"grain diameter", DIAMETER},
             {"grain size", DIAMETER},
             {"sieve", DIAMETER},
             {"sieve size", DIAMETER},
             {"count", COUNT},
             {"volume percent", VOLUME},
             {"passing", PASSING},
             {"percent passing", PASSING},
             {"cumulative passing", PASSING},
             {"finer", PASSING},
             {"percent finer", PASSING},
             {"retained", RETAINED},
             {"percent retained", RETAINED},
             {"retained individual", INDIVIDUAL},
             {"individual retained", INDIVIDUAL},
             {"individual percent retained", INDIVIDUAL},
             {"retained cumulative", CUMULATIVE},
             {"cumulative retained", CUMULATIVE},
             {"cumulative percent retained", CUMULATIVE}};

static column_kind find_kind(const char *name) {
  char plain[64];
  const char *unit;
  size_t n = gh_csv_bare(name, &unit), m = 0;
  for (size_t k = 0; k < n && m + 1 < sizeof plain; k++) {
    bool blank = strchr(" \t_-%", name[k]) != NULL;
    if (!blank) plain[m++] = (char)tolower((unsigned char)name[k]);
    else if (m && plain[m - 1] != ' ') plain[m++] = ' ';
  }
  while (m && plain[m - 1] == ' ') m--;
  plain[m] = 0;
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    if (strcmp(plain, names[k].name) == 0) return names[k].kind;
  return UNKNOWN;
}

typedef struct columns {
  int diameter, value;
  column_kind kind;
} columns;

static gh_status find_columns(gh_context *ctx, const char *path, const gh_csv *csv, columns *c) {
  *c = (columns){-1, -1, UNKNOWN};
  for (int k = 0; k < csv->ncols; k++) {
    column_kind kind = find_kind(csv->names[k]);
    int *place = kind == DIAMETER ? &c->diameter : &c->value;
    if (kind == UNKNOWN) continue;
    if (*place >= 0)
      return gh_fail(ctx, GH_INPUT, "%s: the columns '%.40s' and '%.40s' exclude each other", path,
                     csv->names[*place], csv->names[k]);
    *place = k;
    if (kind != DIAMETER) c->kind = kind;
    if (csv->percent[k] && (kind == DIAMETER || kind == COUNT))
      return gh_fail(ctx, GH_INPUT, "%s: the column '%.40s' is in percent", path, csv->names[k]);
  }
  if (c->diameter < 0)
    return gh_fail(ctx, GH_INPUT,
                   "%s: a sieve curve needs the column 'diameter'; the first of its %d columns is '%.40s'",
                   path, csv->ncols, csv->names[0]);
  if (c->value < 0)
    return gh_fail(
        ctx, GH_INPUT,
        "%s: a sieve curve needs one of the columns 'count', 'volume_percent', 'passing' and 'retained'",
        path);
  return GH_OK;
}

/* ---- retained ---- */

typedef struct rows {
  int n;             /* without the pan */
  double *d, *v, *p; /* diameter, retained, passing */
  int pan;           /* its row in the lines of the file, -1 without one */
  double in_pan;
} rows;

/* The k-th from the finest. */
static int finest(const rows *r, int k) {
  return r->n > 1 && r->d[1] < r->d[0] ? r->n - 1 - k : k;
}

static double retained_sum(const rows *r) {
  double sum = r->pan >= 0 ? r->in_pan : 0;
  for (int k = 0; k < r->n; k++) sum += r->v[k];
  return sum;
}

/* Shares of each sieve: they add up to 100 with the pan; without it the rest is in the pan. */
static bool maybe_individual(const rows *r) {
  double sum = retained_sum(r);
  return sum <= 100 + HUNDRED_WITHIN && (r->pan < 0 || sum >= 100 - HUNDRED_WITHIN);
}

/* What is retained on this sieve and all coarser ones: it rises to the finest, and to 100 in the pan. */
static bool maybe_cumulative(const rows *r) {
  for (int k = 1; k < r->n; k++)
    if (r->v[finest(r, k - 1)] < r->v[finest(r, k)]) return false;
  return r->pan < 0 || (fabs(r->in_pan - 100) <= HUNDRED_WITHIN && r->in_pan >= r->v[finest(r, 0)]);
}

static void passing_by_individual(rows *r) {
  double left = 100;
  for (int k = r->n - 1; k >= 0; k--) {
    left = fmax(left - r->v[finest(r, k)], 0);
    r->p[finest(r, k)] = left;
  }
  if (r->pan < 0 && retained_sum(r) >= 100 - HUNDRED_WITHIN) r->p[finest(r, 0)] = 0;
}

static bool same_passing(rows *r) {
  passing_by_individual(r);
  for (int k = 0; k < r->n; k++)
    if (fabs(r->p[k] - (100 - r->v[k])) > 1e-9) return false;
  return true;
}

/* Which of both the column is, when its name does not say so. */
static gh_status decide(const gh_sieve_source *s, rows *r, column_kind *kind) {
  bool individual = maybe_individual(r), cumulative = maybe_cumulative(r);
  if (*kind == INDIVIDUAL && !individual)
    return gh_fail(s->ctx, GH_INPUT,
                   "%s: what the sieves and the pan retain must add up to 100; the sum is %g", s->path,
                   retained_sum(r));
  if (*kind == CUMULATIVE && !cumulative)
    return gh_fail(
        s->ctx, GH_INPUT,
        "%s: what is retained in all must rise from the coarsest sieve to the finest, and to 100 in the "
        "pan",
        s->path);
  if (*kind != RETAINED) return GH_OK;
  if (individual && cumulative && !same_passing(r))
    return gh_fail(s->ctx, GH_INPUT,
                   "%s: 'retained' may be that of each sieve or of all coarser ones, too; call the column "
                   "retained_individual or retained_cumulative, or add the row of the pan",
                   s->path);
  if (!individual && !cumulative)
    return gh_fail(s->ctx, GH_INPUT,
                   "%s: 'retained' neither adds up to 100 percent (the sum is %g) nor rises to 100 from the "
                   "coarsest sieve to the pan",
                   s->path, retained_sum(r));
  *kind = individual ? INDIVIDUAL : CUMULATIVE;
  return GH_OK;
}

static gh_status retained_to_passing(const gh_sieve_source *s, rows *r, column_kind kind) {
  if (r->n < 1) return gh_fail(s->ctx, GH_INPUT, "%s: a sieve curve needs at least one row", s->path);
  for (int k = 0; k < r->n; k++) {
    if (!(r->d[k] > 0)) return gh_sieve_refuse(s, k, "diameter", r->d[k], "it must be positive");
    if (k && !(r->n > 1 && (r->d[k] - r->d[k - 1]) * (r->d[1] - r->d[0]) > 0))
      return gh_sieve_refuse(s, k, "diameter", r->d[k], "the diameters must rise, or fall, from row to row");
    if (!(r->v[k] >= 0) || r->v[k] > 100 + 1e-9)
      return gh_sieve_refuse(s, k, "retained", r->v[k], "it must be within 0 and 100 percent");
  }
  if (r->pan >= 0 && (!(r->in_pan >= 0) || r->in_pan > 100 + 1e-9))
    return gh_fail(s->ctx, GH_INPUT, "%s: the pan retains %g, it must be within 0 and 100 percent", s->path,
                   r->in_pan);
  int top = finest(r, r->n - 1);
  if (r->v[top] > 1e-9)
    return gh_sieve_refuse(s, top, "retained", r->v[top],
                           "but nothing limits the size of grains above the largest sieve; it must retain 0");
  GH_TRY(decide(s, r, &kind));
  if (kind == INDIVIDUAL) passing_by_individual(r);
  else
    for (int k = 0; k < r->n; k++) r->p[k] = 100 - r->v[k];
  return GH_OK;
}

/* ---- the table ---- */

/* Rows of the two columns. The pan, diameter 0, is no fraction: what passes it is nothing. */
static void gather(const gh_csv *csv, const columns *c, rows *r, int *line) {
  r->pan = -1;
  for (int k = 0; k < csv->nrows; k++) {
    const double *row = csv->value + (size_t)k * (size_t)csv->ncols;
    bool end = k == 0 || k == csv->nrows - 1;
    if (end && csv->nrows > 1 && r->pan < 0 && row[c->diameter] == 0 &&
        (c->kind >= RETAINED || row[c->value] == 0)) {
      r->pan = csv->line[k];
      r->in_pan = row[c->value];
      continue;
    }
    line[r->n] = csv->line[k];
    r->d[r->n] = row[c->diameter];
    r->v[r->n++] = row[c->value];
  }
}

static gh_status read_table(gh_context *ctx, const char *path, const gh_csv *csv, double *memory, int *line,
                            gh_sieve **sieve) {
  static const gh_sieve_kind kinds[] = {
      [COUNT] = GH_SIEVE_COUNT, [VOLUME] = GH_SIEVE_VOLUME, [PASSING] = GH_SIEVE_PASSING};
  gh_sieve_source s = {ctx, path, line};
  columns c;
  size_t n = (size_t)csv->nrows;
  rows r = {.d = memory, .v = memory + n, .p = memory + 2 * n};
  GH_TRY(find_columns(ctx, path, csv, &c));
  gather(csv, &c, &r, line);
  if (c.kind < RETAINED) return gh_sieve_from_rows(&s, kinds[c.kind], r.n, r.d, r.v, sieve);
  GH_TRY(retained_to_passing(&s, &r, c.kind));
  return gh_sieve_from_rows(&s, GH_SIEVE_PASSING, r.n, r.d, r.p, sieve);
}

gh_status gh_sieve_read(gh_context *ctx, const char *path, gh_sieve **sieve) {
  gh_csv *csv;
  double *memory;
  int *line = NULL;
  *sieve = NULL;
  gh_status status = gh_csv_read_with(ctx, path, GH_CSV_PERCENT | GH_CSV_PAN, &csv);
  if (status != GH_OK) return gh_file_expect(ctx, status, path, GH_FILE_SIEVE);
  status = gh_alloc(ctx, 3 * (size_t)csv->nrows, sizeof(double), &memory);
  if (status == GH_OK) status = gh_alloc(ctx, (size_t)csv->nrows, sizeof *line, &line);
  if (status == GH_OK) status = read_table(ctx, path, csv, memory, line, sieve);
  free(memory);
  free(line);
  gh_csv_destroy(&csv);
  return gh_file_expect(ctx, status, path, GH_FILE_SIEVE);
}
