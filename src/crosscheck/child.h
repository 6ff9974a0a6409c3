/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A program as a child process with a time limit. */
#ifndef GRANHOM_CROSSCHECK_CHILD_H
#define GRANHOM_CROSSCHECK_CHILD_H

#include "granhom/base.h"

/* The program's whole path (caller frees): itself when it holds a slash, else from PATH. NULL when there is
 * no such program. */
char *child_find(const char *program);
typedef enum child_end { CHILD_EXIT, CHILD_SIGNAL, CHILD_STOPPED } child_end;
/* Runs argv[0] (a path) with both outputs into the file `output` and nothing to read, without what an MPI of
 * this process has put into the environment, in `folder`, where its temporary files go too. After `seconds`
 * it is killed, with all processes it started. *code: exit status or signal. GH_SYSTEM: it cannot be started.
 */
gh_status child_run(gh_context *ctx, char *const argv[], const char *output, const char *folder,
                    double seconds, child_end *end, int *code);

#endif
