/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Columns that the tables of granhom rve and granhom element share. */
#ifndef GRANHOM_RVE_TABLE_H
#define GRANHOM_RVE_TABLE_H

#include "options.h"

#include "granhom/io.h"
#include "granhom/micro.h"

/* The option --output of the table, a const char *. */
extern const option_row rve_table_option[];

/* Names and values, without the end of the line. Of energy_t, dissipation and sliding with friction alone.
 * residual: the largest of the increment's substeps. */
void rve_table_header(gh_text *out, const gh_rve_options *options);
void rve_table_row(gh_text *out, long step, const gh_rve_measures *m, double residual, double seconds,
                   const gh_rve_options *options);

/* Writes a table, whole, into its file or, when it is the last time, on standard output (path NULL or "-").
 * A text that is NULL is none. */
gh_status rve_table_write(gh_context *ctx, gh_text *text, const char *path, bool last);

#endif
