/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Options of what writes a folder of results: granhom run and study. */
#ifndef GRANHOM_FOLDER_OPTIONS_H
#define GRANHOM_FOLDER_OPTIONS_H

#include "options.h"

typedef struct folder_options {
  const char *file, *folder; /* file: the operand */
  bool explain, quiet;
} folder_options;

extern const option_row folder_rows[]; /* the folder, --explain */
/* GH_INPUT: no folder, and something to write. */
gh_status folder_check(gh_context *ctx, void *options);
/* Signals and screen of a long command, after its options are read. */
void folder_begin(gh_context *ctx, const folder_options *o);

#endif
