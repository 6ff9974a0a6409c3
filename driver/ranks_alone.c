/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A build without MPI (make MPI=0): one process. */
#include "cli.h"

#include <stdlib.h>

int cli_rank(void) {
  return 0;
}

/* Started by mpirun, each process would take itself for the only one and write into the same files. */
gh_status cli_mpi(gh_context *ctx, bool single) {
  static const char *const sizes[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS"};
  (void)single;
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    const char *text = getenv(sizes[k]);
    if (text && atoi(text) > 1)
      return gh_fail(ctx, GH_INPUT,
                     "this granhom was built without MPI (make MPI=0) and was started on %s ranks", text);
  }
  atexit(cli_session_end); /* after LAMMPS has ended MPI */
  return cli_session_start(ctx);
}

const void *cli_world(void) {
  return NULL;
}

int cli_ranks(void) {
  return 0;
}

int cli_share(int value) {
  return value;
}

void cli_abort(int code) {
  exit(code);
}
