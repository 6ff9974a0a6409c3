/* The ranks of a command, by MPI. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"

#include <ftw.h>
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

static char session[512]; /* folder of this process for Open MPI's session; "": none of its own */

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *place) {
  (void)info, (void)kind, (void)place;
  return remove(path);
}

static void finalize(void) {
  int done = 0;
  MPI_Finalized(&done);
  if (!done) MPI_Finalize();
  if (*session) nftw(session, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

/* Open MPI keeps a folder for each session below one of the user, and processes that start and end at the
 * same time may remove it under each other. Each process gets one of its own. */
static void own_session(void) {
  const char *base = getenv("TMPDIR");
  if (getenv("OMPI_MCA_orte_tmpdir_base")) return;
  int n = snprintf(session, sizeof session, "%s/granhom-XXXXXX", base && *base ? base : "/tmp");
  if (n < 0 || (size_t)n >= sizeof session || !mkdtemp(session)) {
    *session = '\0'; /* Open MPI then does as it always does */
    return;
  }
  setenv("OMPI_MCA_orte_tmpdir_base", session, 1);
}

/* Started by hand and not by mpirun or a batch system: Open MPI then needs no helper process, which takes
 * time and memory. */
static void start_alone(void) {
  static const char *const launched[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
  for (size_t k = 0; k < sizeof launched / sizeof *launched; k++)
    if (getenv(launched[k])) return;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  own_session();
}

gh_status cli_mpi(gh_context *ctx, bool single) {
  int begun = 0, ranks = 1;
  MPI_Initialized(&begun);
  if (!begun) {
    gh_h5_start();
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
