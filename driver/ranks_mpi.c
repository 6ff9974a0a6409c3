/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The ranks of a command, by MPI. */
#include "cli.h"
#include "granhom/io.h"

#include <mpi.h>
#include <stdlib.h>

static MPI_Comm world; /* MPI_COMM_WORLD is no object that one could point to */

/* MPI takes ten times as long to start as everything else together. Where nobody has started more ranks, it
 * is left to the LAMMPS engine, which cannot do without. */
static bool under_way(void) {
  int begun = 0, done = 0;
  MPI_Initialized(&begun);
  MPI_Finalized(&done);
  return begun && !done;
}

int cli_rank(void) {
  int rank = 0;
  if (under_way()) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

static void finalize(void) {
  if (under_way()) MPI_Finalize();
  cli_session_end();
}

/* By mpirun or a batch system, as one of several ranks or alone. */
static bool launched(void) {
  static const char *const marks[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
  for (size_t k = 0; k < sizeof marks / sizeof *marks; k++)
    if (getenv(marks[k])) return true;
  return false;
}

gh_status cli_mpi(gh_context *ctx, bool single) {
  int begun = 0;
  MPI_Initialized(&begun);
  if (!begun) {
    gh_h5_start();
    if (!launched()) GH_TRY(cli_session_start(ctx));
    else if (MPI_Init(NULL, NULL) != MPI_SUCCESS) return gh_fail(ctx, GH_SYSTEM, "MPI cannot be started");
    atexit(finalize);
  }
  if (single && cli_ranks() > 1)
    return gh_fail(ctx, GH_INPUT, "this command runs on one rank, and it was started on %d", cli_ranks());
  return GH_OK;
}

const void *cli_world(void) {
  if (!under_way()) return NULL;
  world = MPI_COMM_WORLD;
  return &world;
}

int cli_ranks(void) {
  int ranks = 1;
  if (under_way()) MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  return ranks;
}

int cli_share(int value) {
  if (under_way()) MPI_Bcast(&value, 1, MPI_INT, 0, MPI_COMM_WORLD);
  return value;
}

void cli_abort(int code) {
  if (under_way()) MPI_Abort(MPI_COMM_WORLD, code);
  exit(code);
}
