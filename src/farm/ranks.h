/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Messages between the ranks of a farm: docs/explanation/architecture.md, "Protocol of the ranks". */
#ifndef GRANHOM_FARM_RANKS_H
#define GRANHOM_FARM_RANKS_H

#include "farm/store.h"

/* A build without MPI (make MPI=0) has alone.c in the place of mpi.c and serve.c: a farm of one rank. */
#ifdef GH_NO_MPI
typedef int farm_comm, farm_request;
#else
#include <mpi.h>
typedef MPI_Comm farm_comm;
typedef MPI_Request farm_request;
#endif

typedef enum farm_command {
  FARM_MAKE = 1,
  FARM_DROP,
  FARM_EVALUATE,
  FARM_FETCH,
  FARM_PUT,
  FARM_LOOK,
  FARM_COSTS,
  FARM_LEAVE
} farm_command;
enum { FARM_TAG_COMMAND = 7101, FARM_TAG_REPLY, FARM_TAG_STATE, FARM_TAG_CANCEL };

/* A message: values one after the other, in the representation of this machine. A failure of memory is kept
 * until farm_message_check. */
typedef struct farm_message {
  char *bytes;
  size_t size, capacity, at;
  bool failed;
} farm_message;
void farm_message_free(farm_message *m);
void farm_message_begin(farm_message *m);
void farm_put(farm_message *m, const void *data, size_t size);
void farm_put_int(farm_message *m, int value);
/* false (and zeros) when the message is shorter. */
bool farm_take(farm_message *m, void *data, size_t size);
int farm_take_int(farm_message *m);
/* A piece of the message itself; NULL when it is shorter. */
const void *farm_take_place(farm_message *m, size_t size);
gh_status farm_message_check(gh_context *ctx, const farm_message *m);

/* Asked while waiting: stop(data). */
typedef struct farm_waiting {
  void (*idle)(void *data);
  void *data;
} farm_waiting;

/* comm is the caller's MPI_Comm *. GH_INPUT: this build has no MPI. */
gh_status farm_connect(gh_context *ctx, const void *comm, farm_comm *to, int *ranks);
/* Asks a rank to leave its jobs. */
void farm_cancel(farm_comm comm, int rank);
/* Sends and waits until the message is sent. */
void farm_send(farm_comm comm, int rank, int tag, const farm_message *m);
/* Waits for a message of rank with this tag (MPI_ANY_TAG: any; *tag: which). */
gh_status farm_receive(gh_context *ctx, farm_comm comm, int rank, int *tag, farm_message *m,
                       const farm_waiting *waiting);
/* A state by itself. */
void farm_send_state(farm_comm comm, int rank, const double *state, size_t size, farm_request *request);
/* Waits for one; its size. */
size_t farm_next_state(farm_comm comm, int rank);
void farm_receive_state(farm_comm comm, int rank, double *state, size_t size);
/* Into a slot. */
gh_status farm_store_receive(farm_store *store, farm_comm comm, int rank, int slot);
void farm_wait(farm_request *requests, int n);

/* Begin of every reply: status and message of the rank. */
void farm_put_status(farm_message *m, gh_context *ctx, gh_status status);
gh_status farm_take_status(farm_message *m, gh_context *ctx);

/* A view with its arrays; the taken one points into memory of *m. */
void farm_put_view(farm_message *m, const gh_rve_view *view);
bool farm_take_view(farm_message *m, gh_rve_view *view);

/* Moves of states that concern one rank: its number in slot and the other rank. Sends all, then receives all,
 * so that no two ranks wait for each other. */
typedef struct farm_transfer {
  int slot, rank;
} farm_transfer;
gh_status farm_transfers(gh_context *ctx, farm_store *store, farm_comm comm, int nsend,
                         const farm_transfer *send, int nreceive, const farm_transfer *receive);

#endif
