/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Sieve curves from rows of a table. */
#ifndef GRANHOM_PACKING_SIEVE_H
#define GRANHOM_PACKING_SIEVE_H

#include "granhom/packing.h"

/* Where a row comes from, for messages: file and line, or the row's number. */
typedef struct gh_sieve_source {
  gh_context *ctx;
  const char *path;
  const int *line;
} gh_sieve_source;

/* GH_INPUT: `what` of row k is a value that is not within a limit. */
gh_status gh_sieve_refuse(const gh_sieve_source *s, int k, const char *what, double value, const char *limit);
/* A sieve curve from n rows with rising or falling diameters. */
gh_status gh_sieve_from_rows(const gh_sieve_source *s, gh_sieve_kind kind, int n, const double *diameter,
                             const double *value, gh_sieve **sieve);

#endif
