/* The ranks of a command, by MPI. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"
#include "granhom/io.h"

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

static gh_temporary session = {.lock = -1}; /* folder of this process for Open MPI's session */

static void finalize(void) {
  int done = 0;
  MPI_Finalized(&done);
  if (!done) MPI_Finalize();
  gh_temporary_remove(&session);
}

/* Open MPI keeps a folder for each session below one of the user, and processes that start and end at the
 * same time may remove it under each other. Each process gets one of its own. */
static gh_status own_session(gh_context *ctx) {
  if (getenv("OMPI_MCA_orte_tmpdir_base")) return GH_OK;
  GH_TRY(gh_temporary_make(ctx, "mpi", &session));
  setenv("OMPI_MCA_orte_tmpdir_base", session.folder, 1);
  return GH_OK;
}

/* Started by hand and not by mpirun or a batch system: Open MPI then needs no helper process, which takes
 * time and memory. */
static gh_status start_alone(gh_context *ctx) {
  static const char *const launched[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
  for (size_t k = 0; k < sizeof launched / sizeof *launched; k++)
    if (getenv(launched[k])) return GH_OK;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  return own_session(ctx);
}

gh_status cli_mpi(gh_context *ctx, bool single) {
  int begun = 0, ranks = 1;
  MPI_Initialized(&begun);
  if (!begun) {
    gh_h5_start();
    GH_TRY(start_alone(ctx));
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
