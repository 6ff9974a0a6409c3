/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Runs gnuplot. */
#ifndef GRANHOM_REPORT_GNUPLOT_H
#define GRANHOM_REPORT_GNUPLOT_H

#include "granhom/report.h"

/* Draws `png`, which appears whole or not at all; the script sets a terminal and no output. Texts of a user's
 * are in it by gh_picture_string alone: a script with a shell command in it is refused. GH_ENGINE: gnuplot is
 * not installed, or it failed (with its last message). GH_SYSTEM: the picture cannot be written. */
gh_status report_gnuplot(gh_context *ctx, const char *script, const char *png);

#endif
