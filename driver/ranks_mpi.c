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

static gh_temporary session = {.lock = -1}; /* folder of this process for Open MPI's session */

static void finalize(void) {
  if (under_way()) MPI_Finalize();
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

/* By mpirun or a batch system, as one of several ranks or alone. */
static bool launched(void) {
  static const char *const marks[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
  for (size_t k = 0; k < sizeof marks / sizeof *marks; k++)
    if (getenv(marks[k])) return true;
  return false;
}

/* Started by hand: if MPI is needed at all, it needs no helper process, which takes time and memory. */
static gh_status prepare_alone(gh_context *ctx) {
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  return own_session(ctx);
}

gh_status cli_mpi(gh_context *ctx, bool single) {
  int begun = 0;
  MPI_Initialized(&begun);
  if (!begun) {
    gh_h5_start();
    if (!launched()) GH_TRY(prepare_alone(ctx));
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
