/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Messages between ranks on their way, by MPI. */
#include "farm/ranks.h"

#include <sched.h>
#include <stdlib.h>
#include <time.h>

gh_status farm_connect(gh_context *ctx, const void *comm, farm_comm *to, int *ranks) {
  (void)ctx;
  *to = *(const MPI_Comm *)comm;
  MPI_Comm_size(*to, ranks);
  return GH_OK;
}

void farm_cancel(farm_comm comm, int rank) {
  MPI_Send(NULL, 0, MPI_BYTE, rank, FARM_TAG_CANCEL, comm);
}

/* ---- waiting: polls, and sleeps between polls once it takes longer ---- */

enum { POLLS = 500 };

static void wait_pause(int *polls) {
  static const struct timespec moment = {.tv_nsec = 30000};
  if (++*polls < POLLS) sched_yield();
  else nanosleep(&moment, NULL);
}

void farm_wait(farm_request *requests, int n) {
  int done = 0, polls = 0;
  for (;;) {
    MPI_Testall(n, requests, &done, MPI_STATUSES_IGNORE);
    if (done) return;
    wait_pause(&polls);
  }
}

void farm_send(farm_comm comm, int rank, int tag, const farm_message *m) {
  farm_request request;
  MPI_Isend(m->bytes, (int)m->size, MPI_BYTE, rank, tag, comm, &request);
  farm_wait(&request, 1);
}

static void message_probe(farm_comm comm, int rank, int tag, MPI_Status *status,
                          const farm_waiting *waiting) {
  int there = 0, polls = 0;
  for (;;) {
    MPI_Iprobe(rank, tag, comm, &there, status);
    if (there) return;
    if (waiting) waiting->idle(waiting->data);
    wait_pause(&polls);
  }
}

gh_status farm_receive(gh_context *ctx, farm_comm comm, int rank, int *tag, farm_message *m,
                       const farm_waiting *waiting) {
  MPI_Status status;
  int size;
  farm_message_begin(m);
  message_probe(comm, rank, *tag, &status, waiting);
  MPI_Get_count(&status, MPI_BYTE, &size);
  *tag = status.MPI_TAG;
  GH_TRY(gh_grow(ctx, (size_t)size + 1, 1, &m->capacity, &m->bytes));
  MPI_Recv(m->bytes, size, MPI_BYTE, rank, status.MPI_TAG, comm, MPI_STATUS_IGNORE);
  m->size = (size_t)size;
  return GH_OK;
}

/* ---- states ---- */

void farm_send_state(farm_comm comm, int rank, const double *state, size_t size, farm_request *request) {
  MPI_Isend(state, (int)size, MPI_DOUBLE, rank, FARM_TAG_STATE, comm, request);
}

size_t farm_next_state(farm_comm comm, int rank) {
  MPI_Status status;
  int size;
  message_probe(comm, rank, FARM_TAG_STATE, &status, NULL);
  MPI_Get_count(&status, MPI_DOUBLE, &size);
  return (size_t)size;
}

void farm_receive_state(farm_comm comm, int rank, double *state, size_t size) {
  MPI_Recv(state, (int)size, MPI_DOUBLE, rank, FARM_TAG_STATE, comm, MPI_STATUS_IGNORE);
}

gh_status farm_store_receive(farm_store *store, farm_comm comm, int rank, int slot) {
  double *state;
  size_t size = farm_next_state(comm, rank);
  GH_TRY(farm_store_put(store, slot, size, &state));
  farm_receive_state(comm, rank, state, size);
  return GH_OK;
}

gh_status farm_transfers(gh_context *ctx, farm_store *store, farm_comm comm, int nsend,
                         const farm_transfer *send, int nreceive, const farm_transfer *receive) {
  farm_request *requests = NULL;
  gh_status status = GH_OK;
  if (nsend > 0) GH_TRY(gh_alloc(ctx, (size_t)nsend, sizeof *requests, &requests));
  for (int k = 0; k < nsend; k++) {
    const double *state = NULL;
    size_t size = 0;
    gh_status s = farm_store_get(store, send[k].slot, &state, &size);
    if (s != GH_OK) status = s; /* an empty one is sent, so that nobody waits */
    farm_send_state(comm, send[k].rank, state, size, requests + k);
  }
  for (int k = 0; k < nreceive && status == GH_OK; k++)
    status = farm_store_receive(store, comm, receive[k].rank, receive[k].slot);
  if (nsend > 0) farm_wait(requests, nsend);
  free(requests);
  return status;
}
