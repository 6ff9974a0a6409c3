/* CSV files: a header line and rows of numbers. SPDX-License-Identifier: GPL-2.0-or-later */
#include "io/file.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_COLUMNS = 10000, MOST_MEGABYTES = 256 };

/* The next line that says something; NULL at the end. */
static char *next_line(gh_reader *r) {
  char *line;
  while ((line = gh_reader_line(r))) {
    line = gh_trim(line);
    if (*line && *line != '#') return line;
  }
  return NULL;
}

static int count_fields(const char *line) {
  int n = 1;
  for (; *line; line++) n += *line == ',';
  return n;
}

/* Cuts the next field off *rest. */
static char *next_field(char **rest) {
  char *field = *rest, *comma = strchr(field, ',');
  *rest = comma ? comma + 1 : field + strlen(field);
  if (comma) *comma = 0;
  return gh_trim(field);
}

static gh_status read_header(gh_context *ctx, gh_reader *r, gh_csv *csv) {
  char *line = next_line(r), quoted[GH_QUOTE];
  if (!line) return gh_fail(ctx, GH_INPUT, "%s: no header line: only blank lines and comments", r->path);
  int n = count_fields(line);
  if (n > MAX_COLUMNS) {
    return gh_fail(ctx, GH_INPUT, "%s:%d: %d columns, at most %d are possible", r->path, r->line, n,
                   MAX_COLUMNS);
  }
  GH_TRY(gh_alloc(ctx, (size_t)n, sizeof *csv->names, &csv->names));
  for (int c = 0; c < n; c++) {
    const char *name = next_field(&line);
    double number;
    if (!*name) return gh_fail(ctx, GH_INPUT, "%s:%d: column %d has no name", r->path, r->line, c + 1);
    if (gh_parse_number(name, &number)) {
      return gh_fail(ctx, GH_INPUT,
                     "%s:%d: the first line must name the columns, but column %d is the number '%s'", r->path,
                     r->line, c + 1, gh_quote(name, quoted));
    }
    if (gh_csv_find(csv, name) >= 0) {
      return gh_fail(ctx, GH_INPUT, "%s:%d: column '%s' occurs twice", r->path, r->line,
                     gh_quote(name, quoted));
    }
    csv->names[c] = strdup(name);
    if (!csv->names[c]) return gh_fail(ctx, GH_MEMORY, "%s: no memory for the header", r->path);
    csv->ncols = c + 1;
  }
  return GH_OK;
}

static gh_status read_row(gh_context *ctx, const gh_reader *r, char *line, const gh_csv *csv, double *row) {
  char quoted[GH_QUOTE], name[GH_QUOTE];
  int n = count_fields(line);
  if (n != csv->ncols) {
    return gh_fail(ctx, GH_INPUT, "%s:%d: %d fields in this row, %d columns in the header", r->path, r->line,
                   n, csv->ncols);
  }
  for (int c = 0; c < n; c++) {
    const char *field = next_field(&line);
    if (!*field)
      return gh_fail(ctx, GH_INPUT, "%s:%d: %s is empty", r->path, r->line, gh_quote(csv->names[c], name));
    if (!gh_parse_number(field, &row[c])) {
      return gh_fail(ctx, GH_INPUT, "%s:%d: %s: '%s' is not a finite number", r->path, r->line,
                     gh_quote(csv->names[c], name), gh_quote(field, quoted));
    }
  }
  return GH_OK;
}

static gh_status read_rows(gh_context *ctx, gh_reader *r, gh_csv *csv) {
  size_t nvalues = 0, nlines = 0, ncols = (size_t)csv->ncols;
  for (char *line; (line = next_line(r)); csv->nrows++) {
    size_t row = (size_t)csv->nrows;
    GH_TRY(gh_grow(ctx, (row + 1) * ncols, sizeof *csv->value, &nvalues, &csv->value));
    GH_TRY(gh_grow(ctx, row + 1, sizeof *csv->line, &nlines, &csv->line));
    csv->line[row] = r->line;
    GH_TRY(read_row(ctx, r, line, csv, csv->value + row * ncols));
  }
  return GH_OK;
}

gh_status gh_csv_read(gh_context *ctx, const char *path, gh_csv **out) {
  *out = NULL;
  gh_reader r;
  gh_csv *csv;
  GH_TRY(gh_reader_open_most(ctx, path, MOST_MEGABYTES, &r));
  gh_status s = gh_alloc(ctx, 1, sizeof *csv, &csv);
  if (s == GH_OK) s = read_header(ctx, &r, csv);
  if (s == GH_OK) s = read_rows(ctx, &r, csv);
  gh_reader_close(&r);
  if (s == GH_OK) *out = csv;
  else gh_csv_destroy(&csv);
  return s;
}

void gh_csv_destroy(gh_csv **csv) {
  if (!csv || !*csv) return;
  for (int c = 0; c < (*csv)->ncols; c++) free((*csv)->names[c]);
  free((*csv)->names);
  free((*csv)->value);
  free((*csv)->line);
  free(*csv);
  *csv = NULL;
}

int gh_csv_find(const gh_csv *csv, const char *name) {
  for (int c = 0; c < csv->ncols; c++)
    if (strcmp(csv->names[c], name) == 0) return c;
  return -1;
}
