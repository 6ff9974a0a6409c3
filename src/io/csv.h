/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dialects of CSV files: separators, quotes, decimal commas, units. */
#ifndef GRANHOM_IO_CSV_H
#define GRANHOM_IO_CSV_H

#include "io/file.h"

typedef struct gh_table {
  gh_context *ctx;
  gh_reader r;
  int flags;           /* of gh_csv_read_with */
  char separator;      /* ',', ';', tab, or a blank for columns of words; 0 while unknown */
  const char *comment; /* the last comment, NULL while there is none */
  bool quoted;         /* the field that was read last */
  int comma, point;    /* first line with a decimal comma, a decimal point; 0 for none */
  bool surely_decimal; /* some comma cannot be one between thousands */
} gh_table;

/* A message about the line that was read last. */
#define GH_TABLE_FAIL(t, format, ...)                                                                        \
  gh_fail((t)->ctx, GH_INPUT, "%s:%d: " format, (t)->r.path, (t)->r.line, __VA_ARGS__)

/* Sets the separator by the header and the line behind it. */
gh_status gh_table_separator(gh_table *t, const char *header);
/* Number of fields of a line. */
int gh_table_count(const gh_table *t, const char *line);
/* Cuts the next field off *rest, without blanks and quotes. */
gh_status gh_table_field(gh_table *t, char **rest, char **field);
/* Whether the line has nothing behind its first n fields but empty ones, and one at least. */
bool gh_table_trails(const gh_table *t, const char *line, int n);
/* A number in the dialect of the file, of the field that was read last; text with a decimal comma is changed.
 */
bool gh_table_number(gh_table *t, char *text, double *value);
/* The same before a percent sign. */
bool gh_table_percent(gh_table *t, char *text, double *value);
/* At the end: is it clear what the commas mean? */
gh_status gh_table_check(const gh_table *t);

/* A unit: in [] or (), or one of a list of usual ones. */
bool gh_is_unit(const char *text);
bool gh_unit_percent(const char *unit);

#endif
