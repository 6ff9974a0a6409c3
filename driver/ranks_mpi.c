/* The ranks of a command, by MPI. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"

#include <mpi.h>
#include <stdlib.h>

static MPI_Comm world; /* MPI_COMM_WORLD is no object that one could point to */

int cli_rank(void) {
  int begun = 0, done = 0, rank = 0;
  MPI_Initialized(&begun);
  MPI_Finalized(&done);
  if (begun && !done) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

static void finalize(void) {
  int done = 0;
  MPI_Finalized(&done);
  if (!done) MPI_Finalize();
}

/* Started by hand and not by mpirun or a batch system: Open MPI then needs no helper process, which takes
 * time and memory. */
static void start_alone(void) {
  static const char *const launched[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
  for (size_t k = 0; k < sizeof launched / sizeof *launched; k++)
    if (getenv(launched[k])) return;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
}

gh_status cli_mpi(gh_context *ctx, bool single) {
  int begun = 0, ranks = 1;
  MPI_Initialized(&begun);
  if (!begun) {
    start_alone();
    if (MPI_Init(NULL, NULL) != MPI_SUCCESS) return gh_fail(ctx, GH_SYSTEM, "MPI cannot be started");
    atexit(finalize);
  }
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  if (single && ranks > 1)
    return gh_fail(ctx, GH_INPUT, "this command runs on one rank, and it was started on %d", ranks);
  return GH_OK;
}

const void *cli_world(void) {
  world = MPI_COMM_WORLD;
  return &world;
}

int cli_ranks(void) {
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  return ranks;
}

int cli_share(int value) {
  MPI_Bcast(&value, 1, MPI_INT, 0, MPI_COMM_WORLD);
  return value;
}

void cli_abort(int code) {
  MPI_Abort(MPI_COMM_WORLD, code);
}
