/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A checkpoint that is written or read. */
#ifndef GRANHOM_RESULTS_ARCHIVE_H
#define GRANHOM_RESULTS_ARCHIVE_H

#include "results/results.h"

struct gh_archive {
  gh_context *ctx;
  gh_h5 *file;
  size_t bytes; /* of a file that is read */
};

#endif
