/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Open MPI in a process that mpirun has not started, with ranks or under LAMMPS alone. */
#include "cli.h"
#include "granhom/io.h"

#include <stdlib.h>

static gh_temporary session = {.lock = -1}; /* folder of this process for Open MPI's session */

void cli_session_end(void) {
  gh_temporary_remove(&session);
}

/* Open MPI keeps a folder for each session below one of the user, and processes that start and end at the
 * same time may remove it under each other. Each process gets one of its own. */
static gh_status session_own_folder(gh_context *ctx) {
  if (getenv("OMPI_MCA_orte_tmpdir_base")) return GH_OK;
  GH_TRY(gh_temporary_make(ctx, "mpi", &session));
  setenv("OMPI_MCA_orte_tmpdir_base", session.folder, 1);
  return GH_OK;
}

gh_status cli_session_start(gh_context *ctx) {
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0); /* no helper process, which takes time and memory */
  return session_own_folder(ctx);
}
