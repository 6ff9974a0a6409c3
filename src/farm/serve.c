/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The ranks that serve rank 0. */
#include "farm/ranks.h"

#include <stdlib.h>

typedef struct server {
  gh_context *ctx;
  MPI_Comm comm;
  bool (*stop)(void *data);
  void *stop_data;
  farm_store *store;
  farm_message in, out;
} server;

static gh_status packing_receive(server *s, gh_packing **packing) {
  gh_packing *p;
  GH_TRY(gh_alloc(s->ctx, 1, sizeof *p, packing));
  p = *packing;
  p->n = farm_take_int(&s->in);
  size_t n = (size_t)p->n;
  GH_TRY(gh_alloc(s->ctx, n, sizeof *p->id, &p->id));
  GH_TRY(gh_alloc(s->ctx, n, sizeof *p->type, &p->type));
  GH_TRY(gh_alloc(s->ctx, n, sizeof *p->radius, &p->radius));
  GH_TRY(gh_alloc(s->ctx, 2 * n, sizeof *p->x, &p->x));
  farm_take(&s->in, p->id, n * sizeof *p->id);
  farm_take(&s->in, p->type, n * sizeof *p->type);
  farm_take(&s->in, p->radius, n * sizeof *p->radius);
  farm_take(&s->in, p->x, 2 * n * sizeof *p->x);
  farm_take(&s->in, p->cell, sizeof p->cell);
  if (farm_take(&s->in, p->low, sizeof p->low)) return GH_OK;
  return gh_fail(s->ctx, GH_INTERNAL, "a message with a packing is cut off");
}

static gh_status store_make(server *s) {
  gh_rve_options options;
  farm_store_destroy(&s->store);
  farm_take(&s->in, &options, sizeof options);
  int resident = farm_take_int(&s->in), npackings = farm_take_int(&s->in);
  gh_packing **packings;
  GH_TRY(gh_alloc(s->ctx, (size_t)npackings, sizeof *packings, &packings));
  gh_status status = GH_OK;
  for (int k = 0; k < npackings && status == GH_OK; k++) status = packing_receive(s, packings + k);
  if (status == GH_OK) status = farm_store_create(s->ctx, npackings, packings, &options, resident, &s->store);
  else
    for (int k = 0; k < npackings; k++) gh_packing_destroy(packings + k);
  free(packings);
  return status;
}

static bool evaluation_is_cancelled(server *s) {
  int there = 0;
  MPI_Iprobe(0, FARM_TAG_CANCEL, s->comm, &there, MPI_STATUS_IGNORE);
  if (there) MPI_Recv(NULL, 0, MPI_BYTE, 0, FARM_TAG_CANCEL, s->comm, MPI_STATUS_IGNORE);
  return there || (s->stop && s->stop(s->stop_data));
}

static gh_status jobs_run(server *s, unsigned want, int ntasks, farm_answer *answers, int *done) {
  farm_store_begin(s->store);
  for (*done = 0; *done < ntasks; ++*done) {
    farm_task task;
    if (!farm_take(&s->in, &task, sizeof task))
      return gh_fail(s->ctx, GH_INTERNAL, "a message with jobs is cut off");
    if (evaluation_is_cancelled(s)) return gh_fail(s->ctx, GH_STOPPED, "stopped on request");
    GH_TRY(farm_store_evaluate(s->store, &task, want, answers + *done));
  }
  return GH_OK;
}

static gh_status transfers_receive(server *s, int n, farm_transfer **list) {
  GH_TRY(gh_alloc(s->ctx, (size_t)n + 1, sizeof **list, list));
  farm_take(&s->in, *list, (size_t)n * sizeof **list);
  return GH_OK;
}

static void evaluation_serve(server *s) {
  unsigned want = (unsigned)farm_take_int(&s->in);
  int ntasks = farm_take_int(&s->in), nsend = farm_take_int(&s->in), nreceive = farm_take_int(&s->in),
      done = 0;
  farm_transfer *send = NULL, *receive = NULL;
  farm_answer *answers = NULL;
  gh_status status;
  GH_TRY_OR(transfers_receive(s, nsend, &send), reply);
  GH_TRY_OR(transfers_receive(s, nreceive, &receive), reply);
  GH_TRY_OR(farm_transfers(s->ctx, s->store, s->comm, nsend, send, nreceive, receive), reply);
  GH_TRY_OR(gh_alloc(s->ctx, (size_t)ntasks + 1, sizeof *answers, &answers), reply);
  status = jobs_run(s, want, ntasks, answers, &done);
reply:
  farm_put_status(&s->out, s->ctx, status);
  farm_put_int(&s->out, done);
  farm_put(&s->out, answers, (size_t)done * sizeof *answers);
  free(send);
  free(receive);
  free(answers);
}

/* Answers with the states themselves; an empty one where a slot holds none. */
static void states_serve(server *s) {
  int n = farm_take_int(&s->in);
  for (int k = 0; k < n; k++) {
    const double *state = NULL;
    size_t size = 0;
    MPI_Request request;
    if (farm_store_get(s->store, farm_take_int(&s->in), &state, &size) != GH_OK) size = 0;
    farm_send_state(s->comm, 0, state, size, &request);
    farm_wait(&request, 1);
  }
}

static gh_status states_receive(server *s) {
  int n = farm_take_int(&s->in);
  for (int k = 0; k < n; k++) GH_TRY(farm_store_receive(s->store, s->comm, 0, farm_take_int(&s->in)));
  return GH_OK;
}

static void view_serve(server *s) {
  farm_task task;
  gh_rve_view view;
  farm_take(&s->in, &task, sizeof task);
  gh_status status = farm_store_look(s->store, &task, &view);
  farm_put_status(&s->out, s->ctx, status);
  if (status == GH_OK) farm_put_view(&s->out, &view);
}

static void costs_serve(server *s) {
  gh_rve_cost sum = {0};
  if (s->store) farm_store_costs(s->store, &sum);
  farm_put(&s->out, &sum, sizeof sum);
}

/* false: the service is over. */
static bool command_obey(server *s, farm_command command) {
  farm_message_begin(&s->out);
  switch (command) {
  case FARM_MAKE:
    farm_put_status(&s->out, s->ctx, store_make(s));
    break;
  case FARM_DROP:
    farm_store_destroy(&s->store);
    return true;
  case FARM_EVALUATE:
    evaluation_serve(s);
    break;
  case FARM_FETCH:
    states_serve(s);
    return true;
  case FARM_PUT:
    farm_put_status(&s->out, s->ctx, states_receive(s));
    break;
  case FARM_LOOK:
    view_serve(s);
    break;
  case FARM_COSTS:
    costs_serve(s);
    break;
  case FARM_LEAVE:
    return false;
  }
  if (s->out.failed) { /* no memory for the reply: one that fits */
    farm_message_begin(&s->out);
    farm_put_status(&s->out, s->ctx, gh_fail(s->ctx, GH_MEMORY, "no memory for a message between ranks"));
    farm_put_int(&s->out, 0);
  }
  farm_send(s->comm, 0, FARM_TAG_REPLY, &s->out);
  return true;
}

gh_status gh_farm_serve(gh_context *ctx, const void *comm, bool (*stop)(void *data), void *data) {
  server s = {.ctx = ctx, .comm = *(const MPI_Comm *)comm, .stop = stop, .stop_data = data};
  gh_status status = GH_OK;
  for (bool on = true; on && status == GH_OK;) {
    int tag = MPI_ANY_TAG;
    status = farm_receive(ctx, s.comm, 0, &tag, &s.in, NULL);
    if (status == GH_OK && tag == FARM_TAG_COMMAND) on = command_obey(&s, (farm_command)farm_take_int(&s.in));
  }
  farm_store_destroy(&s.store);
  farm_message_free(&s.in);
  farm_message_free(&s.out);
  return status;
}

void gh_farm_dismiss(const void *comm) {
  if (!comm) return;
  MPI_Comm c = *(const MPI_Comm *)comm;
  int ranks;
  MPI_Comm_size(c, &ranks);
  farm_message m = {0};
  farm_put_int(&m, FARM_LEAVE);
  for (int r = 1; r < ranks && !m.failed; r++) farm_send(c, r, FARM_TAG_COMMAND, &m);
  farm_message_free(&m);
}
