/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A path of deformation gradients from a CSV file. */
#ifndef GRANHOM_DRIVER_PATH_H
#define GRANHOM_DRIVER_PATH_H

#include "options.h"

#include "granhom/io.h"
#include "granhom/limits.h"

typedef struct path_rows {
  gh_csv *csv;    /* freed by gh_csv_destroy */
  int columns[5]; /* step F11 F12 F21 F22; the first is -1 when there is none */
} path_rows;

/* The option --path, a const char *. */
extern const option_row path_option[];
/* Reads and checks: GH_INPUT with file and line when a column is missing, there is no row, det F <= 0 or a
 * step is no integer. */
gh_status path_read(gh_context *ctx, const char *file, path_rows *path);
/* Whether a packing, as read, can follow (granhom/limits.h). GH_INPUT with file and line. */
gh_status path_check(gh_context *ctx, const char *file, const path_rows *path, const gh_rve_options *options,
                     const char *packing_file, const gh_packing *packing);
void path_F(const path_rows *path, int row, double F[4]);
long path_step(const path_rows *path, int row); /* the row's number when there is no column for it */

#endif
