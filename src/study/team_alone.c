/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A study on one process, where there is no MPI (make MPI=0). */
#include "study/parts.h"

#include <stdlib.h>

struct study_team {
  const study_stop *stop;
  long counter;
  bool stopped;
};

gh_status study_team_create(gh_context *ctx, const void *comm, const study_stop *stop, study_team **team) {
  if (comm)
    return gh_fail(ctx, GH_INPUT,
                   "this granhom was built without MPI (make MPI=0): it works on one rank alone");
  GH_TRY(gh_alloc(ctx, 1, sizeof **team, team));
  (*team)->stop = stop;
  return GH_OK;
}

void study_team_destroy(study_team **team) {
  if (!team) return;
  free(*team);
  *team = NULL;
}

int study_team_rank(const study_team *t) {
  (void)t;
  return 0;
}

long study_team_next(study_team *t) {
  return t->counter++;
}

void study_team_stop(study_team *t) {
  t->stopped = true;
}

bool study_team_stopped(void *team) {
  study_team *t = team;
  t->stopped = t->stopped || study_stopped(t->stop);
  return t->stopped;
}

/* What follows is of ranks from 1 on. */

void study_team_tell(study_team *t, const char *note) {
  (void)t, (void)note;
}

void study_team_listen(study_team *t, void (*hear)(void *data, const char *note), void *data) {
  (void)t, (void)hear, (void)data;
}

gh_status study_team_worst(study_team *t, gh_status status) {
  (void)t;
  return status;
}

bool study_team_alike(study_team *t, uint64_t number) {
  (void)t, (void)number;
  return true;
}

void study_team_share(study_team *t, unsigned char *flags, int n) {
  (void)t, (void)flags, (void)n;
}

gh_status study_team_gather(study_team *t, const char *mine, gh_status (*take)(void *data, const char *text),
                            void *data, void (*hear)(void *data, const char *note), void *hear_data) {
  (void)t, (void)mine, (void)take, (void)data, (void)hear, (void)hear_data;
  return GH_OK;
}

int study_team_agree(study_team *t, int number) {
  (void)t;
  return number;
}
