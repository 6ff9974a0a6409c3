/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A farm of one rank, where there is no MPI (make MPI=0): nobody to send to, nobody to serve. */
#include "farm/ranks.h"

static gh_status rank_absent(gh_context *ctx) {
  return gh_fail(ctx, GH_INPUT,
                 "this granhom was built without MPI (make MPI=0): it works on one rank alone");
}

gh_status farm_connect(gh_context *ctx, const void *comm, farm_comm *to, int *ranks) {
  (void)comm, (void)to, (void)ranks;
  return rank_absent(ctx);
}

gh_status gh_farm_serve(gh_context *ctx, const void *comm, bool (*stop)(void *data), void *data) {
  (void)comm, (void)stop, (void)data;
  return rank_absent(ctx);
}

void gh_farm_dismiss(const void *comm) {
  (void)comm;
}

gh_status farm_transfers(gh_context *ctx, farm_store *store, farm_comm comm, int nsend,
                         const farm_transfer *send, int nreceive, const farm_transfer *receive) {
  (void)store, (void)comm, (void)send, (void)receive;
  return nsend + nreceive == 0 ? GH_OK : rank_absent(ctx);
}

/* What follows is of ranks from 1 on. */

gh_status farm_receive(gh_context *ctx, farm_comm comm, int rank, int *tag, farm_message *m,
                       const farm_waiting *waiting) {
  (void)comm, (void)rank, (void)tag, (void)m, (void)waiting;
  return rank_absent(ctx);
}

void farm_send(farm_comm comm, int rank, int tag, const farm_message *m) {
  (void)comm, (void)rank, (void)tag, (void)m;
}

void farm_cancel(farm_comm comm, int rank) {
  (void)comm, (void)rank;
}

void farm_send_state(farm_comm comm, int rank, const double *state, size_t size, farm_request *request) {
  (void)comm, (void)rank, (void)state, (void)size, (void)request;
}

size_t farm_next_state(farm_comm comm, int rank) {
  (void)comm, (void)rank;
  return 0;
}

void farm_receive_state(farm_comm comm, int rank, double *state, size_t size) {
  (void)comm, (void)rank, (void)state, (void)size;
}

void farm_wait(farm_request *requests, int n) {
  (void)requests, (void)n;
}
