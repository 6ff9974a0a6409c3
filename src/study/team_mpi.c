/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The ranks that share the runs of a study, by MPI. Rank 0 has a counter in a window of memory from which all
 * take numbers, without asking rank 0 itself: nobody waits for a rank that computes. A stop is a number that
 * no run has. Notes are short messages that need no answer. */
#include "study/parts.h"

#include <limits.h>
#include <mpi.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TAG_NOTE = 1, TAG_TEXT };
static const long STOPPED = LONG_MAX / 2; /* counted up from there, it stays above all numbers of runs */
static const double LOOK_EVERY = 0.1;     /* seconds */

struct study_team {
  gh_context *ctx;
  MPI_Comm comm;
  MPI_Win window;
  long *counter; /* of rank 0 */
  int rank, ranks;
  bool alone, stopped;
  const study_stop *stop;
  double looked;
};

/* ---- all together ---- */

static void rest(void) {
  static const struct timespec moment = {.tv_nsec = 2000000};
  nanosleep(&moment, NULL);
}

static void wait_for(MPI_Request *request) {
  for (int done = 0;;) {
    MPI_Test(request, &done, MPI_STATUS_IGNORE);
    if (done) return;
    rest();
  }
}

/* A rank that failed alone would leave the others waiting for it. */
static gh_status worst(gh_context *ctx, MPI_Comm comm, gh_status status) {
  MPI_Request request;
  int mine = (int)status, all = mine;
  MPI_Iallreduce(&mine, &all, 1, MPI_INT, MPI_MAX, comm, &request);
  wait_for(&request);
  if (status != GH_OK || all == GH_OK) return status;
  return gh_fail(ctx, (gh_status)all, "another rank has failed: %s", gh_status_text((gh_status)all));
}

gh_status study_team_worst(study_team *t, gh_status status) {
  return t->alone ? status : worst(t->ctx, t->comm, status);
}

/* ---- a team ---- */

static void window_open(study_team *t) {
  MPI_Win_allocate((MPI_Aint)(t->rank == 0 ? sizeof *t->counter : 0), sizeof *t->counter, MPI_INFO_NULL,
                   t->comm, &t->counter, &t->window);
  MPI_Win_lock_all(0, t->window);
  if (t->rank == 0) {
    *t->counter = 0;
    MPI_Win_sync(t->window);
  }
  MPI_Barrier(t->comm);
}

gh_status study_team_create(gh_context *ctx, const void *comm, const study_stop *stop, study_team **team) {
  const MPI_Comm world = comm ? *(const MPI_Comm *)comm : MPI_COMM_NULL;
  gh_status status = gh_alloc(ctx, 1, sizeof **team, team);
  study_team *t = *team;
  if (status == GH_OK) {
    *t = (study_team){.ctx = ctx, .stop = stop, .ranks = 1};
    if (comm) MPI_Comm_size(world, &t->ranks);
    t->alone = t->ranks == 1;
    if (t->alone) status = gh_alloc(ctx, 1, sizeof *t->counter, &t->counter);
  }
  if (comm) status = worst(ctx, world, status);
  if (status != GH_OK) {
    if (t) free(t->alone ? t->counter : NULL);
    free(t);
    *team = NULL;
    return status;
  }
  if (t->alone) return GH_OK;
  MPI_Comm_dup(world, &t->comm);
  MPI_Comm_rank(t->comm, &t->rank);
  window_open(t);
  return GH_OK;
}

void study_team_destroy(study_team **team) {
  if (!team || !*team) return;
  study_team *t = *team;
  if (t->alone) {
    free(t->counter);
  } else {
    MPI_Win_unlock_all(t->window);
    MPI_Win_free(&t->window);
    MPI_Comm_free(&t->comm);
  }
  free(t);
  *team = NULL;
}

int study_team_rank(const study_team *t) {
  return t->rank;
}

/* ---- the counter ---- */

/* Its value before op. */
static long ask(study_team *t, long number, MPI_Op op) {
  long before = 0;
  MPI_Fetch_and_op(&number, &before, MPI_LONG, 0, 0, op, t->window);
  MPI_Win_flush(0, t->window);
  return before;
}

long study_team_next(study_team *t) {
  return t->alone ? (*t->counter)++ : ask(t, 1, MPI_SUM);
}

void study_team_stop(study_team *t) {
  t->stopped = true;
  if (!t->alone) ask(t, STOPPED, MPI_REPLACE);
}

bool study_team_stopped(void *team) {
  study_team *t = team;
  double now = gh_seconds();
  if (t->stopped) return true;
  if (study_stopped(t->stop)) {
    study_team_stop(t);
  } else if (!t->alone && now - t->looked > LOOK_EVERY) {
    t->looked = now;
    t->stopped = ask(t, 0, MPI_NO_OP) >= STOPPED;
  }
  return t->stopped;
}

/* ---- notes ---- */

void study_team_tell(study_team *t, const char *note) {
  if (t->rank > 0) MPI_Send(note, (int)strlen(note) + 1, MPI_CHAR, 0, TAG_NOTE, t->comm);
}

void study_team_listen(study_team *t, void (*hear)(void *data, const char *note), void *data) {
  if (t->alone || t->rank > 0) return;
  for (;;) {
    char note[STUDY_NOTE] = "";
    int there = 0;
    MPI_Status from;
    MPI_Iprobe(MPI_ANY_SOURCE, TAG_NOTE, t->comm, &there, &from);
    if (!there) return;
    MPI_Recv(note, STUDY_NOTE - 1, MPI_CHAR, from.MPI_SOURCE, TAG_NOTE, t->comm, MPI_STATUS_IGNORE);
    hear(data, note);
  }
}

/* ---- what all give and get ---- */

bool study_team_alike(study_team *t, uint64_t number) {
  uint64_t both[2] = {number, ~number};
  if (!t->alone) MPI_Allreduce(MPI_IN_PLACE, both, 2, MPI_UINT64_T, MPI_MAX, t->comm);
  return both[0] == ~both[1]; /* the largest is the least one */
}

void study_team_share(study_team *t, unsigned char *flags, int n) {
  if (!t->alone) MPI_Bcast(flags, n, MPI_UNSIGNED_CHAR, 0, t->comm);
}

/* Texts go in pieces, the last of them shorter: a rank without memory for the whole still takes them all, and
 * nobody waits for it. */
enum { PIECE = 1 << 14 };

static void text_send(study_team *t, const char *text) {
  const size_t length = strlen(text);
  for (size_t sent = 0, n = PIECE; n == PIECE; sent += n) {
    MPI_Request request;
    n = length - sent < PIECE ? length - sent : PIECE;
    MPI_Isend(text + sent, (int)n, MPI_CHAR, 0, TAG_TEXT, t->comm, &request);
    wait_for(&request);
  }
}

static int piece_receive(study_team *t, int rank, void (*hear)(void *data, const char *note), void *hear_data,
                         char piece[PIECE]) {
  MPI_Status status;
  int there = 0, n = 0;
  for (;;) {
    study_team_listen(t, hear, hear_data);
    MPI_Iprobe(rank, TAG_TEXT, t->comm, &there, &status);
    if (there) break;
    study_team_stopped(t); /* a signal that only this rank gets is passed on */
    rest();
  }
  MPI_Recv(piece, PIECE, MPI_CHAR, rank, TAG_TEXT, t->comm, &status);
  MPI_Get_count(&status, MPI_CHAR, &n);
  study_team_listen(t, hear, hear_data); /* what was reported before the text */
  return n;
}

/* The text of a rank, which the caller destroys. */
static gh_status text_receive(study_team *t, int rank, void (*hear)(void *data, const char *note),
                              void *hear_data, gh_text **text) {
  char piece[PIECE];
  gh_status status = gh_text_create(t->ctx, text);
  for (int n = PIECE; n == PIECE;) {
    n = piece_receive(t, rank, hear, hear_data, piece);
    if (status == GH_OK) status = gh_text_add(*text, piece, (size_t)n);
  }
  return status == GH_OK ? gh_text_check(*text) : status;
}

gh_status study_team_gather(study_team *t, const char *mine, gh_status (*take)(void *data, const char *text),
                            void *data, void (*hear)(void *data, const char *note), void *hear_data) {
  if (t->alone) return GH_OK;
  if (t->rank > 0) {
    text_send(t, mine);
    return GH_OK;
  }
  gh_status first = GH_OK;
  for (int rank = 1; rank < t->ranks; rank++) {
    gh_text *other = NULL;
    gh_status status = text_receive(t, rank, hear, hear_data, &other);
    if (status == GH_OK) status = take(data, gh_text_get(other, NULL));
    if (first == GH_OK) first = status; /* the others are heard all the same */
    gh_text_destroy(&other);
  }
  return first;
}

int study_team_agree(study_team *t, int number) {
  MPI_Request request;
  if (t->alone) return number;
  MPI_Ibcast(&number, 1, MPI_INT, 0, t->comm, &request);
  wait_for(&request);
  return number;
}
