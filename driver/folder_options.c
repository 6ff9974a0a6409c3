/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Options of what writes a folder of results. */
#include "folder_options.h"
#include "cli.h"

const option_row folder_rows[] = {{.name = "output",
                                   .letter = 'o',
                                   .argument = "DIR",
                                   .kind = OPTION_TEXT,
                                   .place = offsetof(folder_options, folder),
                                   .help = "folder for the results, made where it is missing"},
                                  {.name = "explain",
                                   .kind = OPTION_FLAG,
                                   .place = offsetof(folder_options, explain),
                                   .help = "reports what would be computed, and how, and computes nothing"},
                                  {0}};

gh_status folder_check(gh_context *ctx, void *options) {
  const folder_options *o = options;
  if (o->folder || o->explain) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "-o DIR is needed: the folder for results");
}

void folder_begin(gh_context *ctx, const folder_options *o) {
  if (o->quiet) cli_quiet(ctx);
  if (!o->explain) cli_catch_signals();
}
