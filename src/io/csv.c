/* SPDX-License-Identifier: GPL-2.0-or-later */
/* CSV files: a header line and rows of numbers. */
#include "io/csv.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { MAX_COLUMNS = 10000, MOST_MEGABYTES = 256 };

/* The next line that states something; NULL at the end. Keeps the last comment, which may be the header. */
static char *next_line(gh_table *t) {
  char *line;
  while ((line = gh_reader_line(&t->r))) {
    line = gh_trim(line);
    if (*line && *line != '#') return line;
    if (*line) t->comment = gh_trim(line + strspn(line, "#"));
  }
  return NULL;
}

/* ---- header ---- */

/* Adds a column. The name is copied. */
static gh_status add_name(gh_table *t, gh_csv *csv, const char *name) {
  const char *unit;
  int c = csv->ncols;
  gh_csv_bare(name, &unit);
  csv->percent[c] = unit && gh_unit_percent(unit);
  csv->names[c] = strdup(name);
  if (!csv->names[c]) return gh_fail(t->ctx, GH_MEMORY, "%s: no memory for the header", t->r.path);
  csv->ncols++;
  return GH_OK;
}

static int by_name(const void *p, const void *q) {
  return strcmp(*(char *const *)p, *(char *const *)q);
}

static gh_status check_names(gh_table *t, const gh_csv *csv) {
  char quoted[GH_QUOTE];
  const char **names;
  GH_TRY(gh_alloc(t->ctx, (size_t)csv->ncols, sizeof *names, &names));
  memcpy(names, csv->names, (size_t)csv->ncols * sizeof *names);
  if (csv->ncols > 0) qsort(names, (size_t)csv->ncols, sizeof *names, by_name);
  gh_status s = GH_OK;
  for (int c = 1; c < csv->ncols && s == GH_OK; c++)
    if (strcmp(names[c - 1], names[c]) == 0)
      s = GH_TABLE_FAIL(t, "column '%s' occurs twice", gh_quote(names[c], quoted));
  free(names);
  return s;
}

/* The names of `line`; empty ones at its end are those of trailing separators. */
static gh_status read_names(gh_table *t, char *line, gh_csv *csv) {
  char quoted[GH_QUOTE];
  int n = gh_table_count(t, line), nameless = 0;
  if (n > MAX_COLUMNS) return GH_TABLE_FAIL(t, "%d columns, at most %d are possible", n, MAX_COLUMNS);
  GH_TRY(gh_alloc(t->ctx, (size_t)n, sizeof *csv->names, &csv->names));
  GH_TRY(gh_alloc(t->ctx, (size_t)n, sizeof *csv->percent, &csv->percent));
  for (int c = 0; c < n; c++) {
    char *name;
    double number;
    GH_TRY(gh_table_field(t, &line, &name));
    if (!*name && !nameless) nameless = c + 1;
    if (!*name) continue;
    if (nameless) return GH_TABLE_FAIL(t, "column %d has no name", nameless);
    if (gh_table_number(t, name, &number))
      return GH_TABLE_FAIL(t, "the first line must name the columns, but column %d is the number '%s'", c + 1,
                           gh_quote(name, quoted));
    GH_TRY(add_name(t, csv, name));
  }
  if (csv->ncols == 0) return GH_TABLE_FAIL(t, "column %d has no name", 1);
  return check_names(t, csv);
}

/* Whether each field of the line is a number. */
static bool only_numbers(const gh_table *t, const char *line) {
  char *copy = strdup(line), *rest = copy, *field;
  gh_table trial = *t; /* what is learned here is learned again when the row is read */
  trial.ctx = NULL;
  double number;
  bool all = copy != NULL;
  for (int c = gh_table_count(t, line); c > 0 && all; c--)
    all = gh_table_field(&trial, &rest, &field) == GH_OK && gh_table_number(&trial, field, &number);
  free(copy);
  return all;
}

/* Reads the header; *row: the first row, when that is where the header should stand and a comment before it
 * has the names. */
static gh_status read_header(gh_table *t, gh_csv *csv, char **row) {
  char *line = next_line(t);
  *row = NULL;
  if (line && strncasecmp(line, "sep=", 4) == 0 && line[4] && !line[5]) { /* a remark of spreadsheets */
    t->separator = line[4];
    if (!strchr(",;\t", line[4]))
      return GH_TABLE_FAIL(t, "the separator is '%c'; wanted is ',', ';' or a tab", line[4]);
    line = next_line(t);
  }
  if (!line) return gh_fail(t->ctx, GH_INPUT, "%s: no header line: only blank lines and comments", t->r.path);
  char *names = line, *copy = NULL;
  if (!t->separator) GH_TRY(gh_table_separator(t, line));
  if (t->comment && only_numbers(t, line)) {
    if (gh_table_count(t, t->comment) == gh_table_count(t, line)) {
      names = copy = strdup(t->comment);
      if (!copy) return gh_fail(t->ctx, GH_MEMORY, "%s: no memory for the header", t->r.path);
      *row = line;
    }
  }
  gh_status s = read_names(t, names, csv);
  free(copy);
  return s;
}

/* ---- rows ---- */

/* *units: the row is one of units. Their percent signs go into the columns. */
static gh_status read_units(gh_table *t, const char *line, gh_csv *csv, bool *units) {
  char *copy = strdup(line), *rest = copy, *field, name[GH_QUOTE];
  int n = gh_table_count(t, line), percent = -1;
  if (!copy) return gh_fail(t->ctx, GH_MEMORY, "%s: no memory for a row", t->r.path);
  *units = n >= csv->ncols;
  gh_status s = GH_OK;
  for (int c = 0; c < n && *units && s == GH_OK; c++) {
    s = gh_table_field(t, &rest, &field);
    if (s == GH_OK) *units = !*field || (c < csv->ncols && gh_is_unit(field));
    if (s == GH_OK && *units && *field && gh_unit_percent(field)) csv->percent[percent = c] = true;
  }
  free(copy);
  if (s == GH_OK && *units && percent >= 0 && !(t->flags & GH_CSV_PERCENT))
    return GH_TABLE_FAIL(t, "%s is in percent by its unit; a number that needs none is wanted",
                         gh_quote(csv->names[percent], name));
  return s;
}

static gh_status refuse_count(const gh_table *t, const char *line, int n, int ncols) {
  const char *hint = "";
  if (n == 1 && ncols > 1 && strpbrk(line, ",;\t"))
    hint = "; the row and the header have different separators";
  else if (n > ncols && t->separator == ',' && strchr(line, ';'))
    hint = "; the row and the header have different separators";
  else if (n == 2 * ncols && t->separator == ',')
    hint = "; with decimal commas the separator must be ';' or a tab";
  return GH_TABLE_FAIL(t, "%d fields in this row, %d columns in the header%s", n, ncols, hint);
}

static gh_status read_row(gh_table *t, char *line, gh_csv *csv, double *row) {
  char quoted[GH_QUOTE], name[GH_QUOTE], *field;
  int n = gh_table_count(t, line);
  if (n < csv->ncols || (n > csv->ncols && !gh_table_trails(t, line, csv->ncols)))
    return refuse_count(t, line, n, csv->ncols);
  for (int c = 0; c < csv->ncols; c++) {
    GH_TRY(gh_table_field(t, &line, &field));
    if (!*field) return GH_TABLE_FAIL(t, "%s is empty", gh_quote(csv->names[c], name));
    bool number = gh_table_number(t, field, &row[c]);
    if (!number && (t->flags & GH_CSV_PERCENT) && gh_table_percent(t, field, &row[c]))
      csv->percent[c] = number = true;
    if (!number && (t->flags & GH_CSV_PAN) && strcasecmp(field, "pan") == 0) {
      row[c] = 0;
      number = true;
    }
    if (!number)
      return GH_TABLE_FAIL(t, "%s: '%s' is not a finite number%s", gh_quote(csv->names[c], name),
                           gh_quote(field, quoted), gh_number_hint(field));
  }
  return GH_OK;
}

static gh_status read_rows(gh_table *t, char *line, gh_csv *csv) {
  size_t nvalues = 0, nlines = 0, ncols = (size_t)csv->ncols;
  bool first = true, units = false;
  if (!line) line = next_line(t);
  for (; line; line = next_line(t), first = false) {
    size_t row = (size_t)csv->nrows;
    if (gh_table_trails(t, line, 0)) continue; /* nothing but separators */
    if (first) GH_TRY(read_units(t, line, csv, &units));
    if (first && units) continue;
    GH_TRY(gh_grow(t->ctx, (row + 1) * ncols, sizeof *csv->value, &nvalues, &csv->value));
    GH_TRY(gh_grow(t->ctx, row + 1, sizeof *csv->line, &nlines, &csv->line));
    csv->line[row] = t->r.line;
    GH_TRY(read_row(t, line, csv, csv->value + row * ncols));
    csv->nrows++;
  }
  return gh_table_check(t);
}

gh_status gh_csv_read_with(gh_context *ctx, const char *path, int flags, gh_csv **out) {
  *out = NULL;
  gh_table t = {.ctx = ctx, .flags = flags};
  gh_csv *csv;
  char *row;
  GH_TRY(gh_reader_open_most(ctx, path, MOST_MEGABYTES, &t.r));
  gh_status s = gh_alloc(ctx, 1, sizeof *csv, &csv);
  if (s == GH_OK) s = read_header(&t, csv, &row);
  if (s == GH_OK) s = read_rows(&t, row, csv);
  gh_reader_close(&t.r);
  if (s == GH_OK) *out = csv;
  else gh_csv_destroy(&csv);
  return s;
}

gh_status gh_csv_read(gh_context *ctx, const char *path, gh_csv **csv) {
  return gh_csv_read_with(ctx, path, 0, csv);
}

void gh_csv_destroy(gh_csv **csv) {
  if (!csv || !*csv) return;
  for (int c = 0; c < (*csv)->ncols; c++) free((*csv)->names[c]);
  free((*csv)->names);
  free((*csv)->percent);
  free((*csv)->value);
  free((*csv)->line);
  free(*csv);
  *csv = NULL;
}

size_t gh_csv_bare(const char *name, const char **unit) {
  size_t n = strlen(name);
  const char *open =
      n && (name[n - 1] == ']' || name[n - 1] == ')') ? strrchr(name, name[n - 1] == ']' ? '[' : '(') : NULL;
  *unit = open;
  if (!open || open == name) {
    *unit = NULL;
    return n;
  }
  n = (size_t)(open - name);
  while (n > 0 && (name[n - 1] == ' ' || name[n - 1] == '\t')) n--;
  return n;
}

int gh_csv_find(const gh_csv *csv, const char *name) {
  int found = -1;
  for (int c = 0; c < csv->ncols; c++)
    if (strcmp(csv->names[c], name) == 0) return c;
  for (int c = 0; c < csv->ncols; c++) {
    const char *unit;
    size_t n = gh_csv_bare(csv->names[c], &unit);
    if (!unit || csv->percent[c] || n != strlen(name) || strncmp(csv->names[c], name, n) != 0) continue;
    if (found >= 0) return -1; /* with two units */
    found = c;
  }
  return found;
}
