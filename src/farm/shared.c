/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A farm of RVEs on rank 0: gives out jobs, gathers answers. */
#include "farm/internal.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* ---- orders to other ranks ---- */

farm_message *farm_begin_order(farm_shared *s, farm_command command) {
  farm_message_begin(&s->message);
  farm_put_int(&s->message, command);
  return &s->message;
}

gh_status farm_order(farm_shared *s, int rank) {
  GH_TRY(farm_message_check(s->ctx, &s->message));
  farm_send(s->comm, rank, FARM_TAG_COMMAND, &s->message);
  return GH_OK;
}

static bool evaluation_stop_requested(const farm_shared *s) {
  return s->stop && s->stop(s->stop_data);
}

/* Asks all ranks to leave their jobs, once. */
static void evaluation_cancel(farm_shared *s) {
  if (s->cancelled) return;
  s->cancelled = true;
  for (int r = 1; r < s->ranks; r++) farm_cancel(s->comm, r);
}

static void evaluation_wait(void *data) {
  farm_shared *s = data;
  if (!s->cancelled && evaluation_stop_requested(s)) evaluation_cancel(s);
}

gh_status farm_reply(farm_shared *s, int rank) {
  int tag = FARM_TAG_REPLY;
  const farm_waiting waiting = {evaluation_wait, s};
  GH_TRY(farm_receive(s->ctx, s->comm, rank, &tag, &s->message, &waiting));
  return farm_take_status(&s->message, s->ctx);
}

/* ---- making ---- */

static gh_status packings_copy(gh_context *ctx, const gh_farm_setup *setup, gh_packing **copies) {
  for (int k = 0; k < setup->npackings; k++) GH_TRY(gh_packing_copy(ctx, setup->packings[k], copies + k));
  return GH_OK;
}

static gh_status store_make(farm_shared *s, const gh_farm_setup *setup) {
  gh_packing **copies;
  GH_TRY(gh_alloc(s->ctx, (size_t)setup->npackings, sizeof *copies, &copies));
  gh_status status = packings_copy(s->ctx, setup, copies);
  if (status == GH_OK)
    status = farm_store_create(s->ctx, setup->npackings, copies, &setup->rve, setup->resident, &s->store);
  else
    for (int k = 0; k < setup->npackings; k++) gh_packing_destroy(copies + k);
  free(copies);
  return status == GH_OK ? farm_store_check(s->store) : status;
}

static gh_status setup_send(farm_shared *s, const gh_farm_setup *setup) {
  farm_message *m = farm_begin_order(s, FARM_MAKE);
  farm_put(m, &setup->rve, sizeof setup->rve);
  farm_put_int(m, setup->resident);
  farm_put_int(m, setup->npackings);
  for (int k = 0; k < setup->npackings; k++) {
    const gh_packing *p = setup->packings[k];
    size_t n = (size_t)p->n;
    farm_put_int(m, p->n);
    farm_put(m, p->id, n * sizeof *p->id);
    farm_put(m, p->type, n * sizeof *p->type);
    farm_put(m, p->radius, n * sizeof *p->radius);
    farm_put(m, p->x, 2 * n * sizeof *p->x);
    farm_put(m, p->cell, sizeof p->cell);
    farm_put(m, p->low, sizeof p->low);
  }
  for (int r = 1; r < s->ranks; r++) GH_TRY(farm_order(s, r));
  gh_status status = GH_OK;
  for (int r = 1; r < s->ranks; r++) {
    gh_status told = farm_reply(s, r);
    if (status == GH_OK) status = told;
  }
  return status;
}

static gh_status shared_fill(farm_shared *s, const gh_farm_setup *setup) {
  if (setup->comm) GH_TRY(farm_connect(s->ctx, setup->comm, &s->comm, &s->ranks));
  GH_TRY(farm_books_create(s->ctx, setup, s->ranks, &s->books));
  GH_TRY(store_make(s, setup));
  return s->ranks > 1 ? setup_send(s, setup) : GH_OK;
}

gh_status farm_shared_create(gh_context *ctx, const gh_farm_setup *setup, farm_shared **shared) {
  GH_TRY(gh_alloc(ctx, 1, sizeof **shared, shared));
  farm_shared *s = *shared;
  s->ctx = ctx;
  s->ranks = 1;
  gh_status status = shared_fill(s, setup);
  if (status != GH_OK) farm_shared_destroy(shared);
  return status;
}

void farm_shared_destroy(farm_shared **shared) {
  if (!shared || !*shared) return;
  farm_shared *s = *shared;
  farm_begin_order(s, FARM_DROP);
  for (int r = 1; r < s->ranks; r++)
    if (!s->message.failed) farm_order(s, r);
  farm_store_destroy(&s->store);
  farm_books_destroy(&s->books);
  farm_message_free(&s->message);
  farm_message_free(&s->view);
  free(s->answers);
  free(s->done);
  free(s->sends);
  free(s->receives);
  free(s);
  *shared = NULL;
}

/* ---- an evaluation ---- */

/* The failure that a single rank would have met first. */
typedef struct failure {
  int point; /* INT_MAX: none */
  gh_status status;
  char words[2048];
} failure;

static void failure_store(farm_shared *s, failure *f, int point, gh_status status) {
  if (status == GH_OK || point >= f->point) return;
  f->point = point;
  f->status = status;
  snprintf(f->words, sizeof f->words, "%s", gh_message(s->ctx));
}

/* What this rank sends and receives: sends, receives. */
static gh_status transfers_list(farm_shared *s, int rank, int *nsend, int *nreceive) {
  const farm_books *b = &s->books;
  *nsend = *nreceive = 0;
  for (size_t k = 0; k < b->nmoves; k++) {
    const farm_state *from = b->states + b->moves[k].from, *to = b->states + b->moves[k].to;
    if (from->rank == rank) {
      GH_TRY(gh_grow(s->ctx, (size_t)*nsend + 1, sizeof *s->sends, &s->send_capacity, &s->sends));
      s->sends[(*nsend)++] = (farm_transfer){.slot = from->slot, .rank = to->rank};
    }
    if (to->rank == rank) {
      GH_TRY(gh_grow(s->ctx, (size_t)*nreceive + 1, sizeof *s->receives, &s->receive_capacity, &s->receives));
      s->receives[(*nreceive)++] = (farm_transfer){.slot = to->slot, .rank = from->rank};
    }
  }
  return GH_OK;
}

static int jobs_count(const farm_books *b, int rank) {
  int count = 0;
  for (int j = 0; j < b->njobs; j++) count += b->jobs[j].rank == rank;
  return count;
}

static gh_status jobs_send(farm_shared *s, int rank, unsigned want) {
  const farm_books *b = &s->books;
  int nsend, nreceive;
  GH_TRY(transfers_list(s, rank, &nsend, &nreceive));
  farm_message *m = farm_begin_order(s, FARM_EVALUATE);
  farm_put_int(m, (int)want);
  farm_put_int(m, jobs_count(b, rank));
  farm_put_int(m, nsend);
  farm_put_int(m, nreceive);
  farm_put(m, s->sends, (size_t)nsend * sizeof *s->sends);
  farm_put(m, s->receives, (size_t)nreceive * sizeof *s->receives);
  for (int j = 0; j < b->njobs; j++)
    if (b->jobs[j].rank == rank) farm_put(m, &b->jobs[j].task, sizeof b->jobs[j].task);
  return farm_order(s, rank);
}

static gh_status jobs_run_own(farm_shared *s, unsigned want, int *point) {
  farm_books *b = &s->books;
  int nsend, nreceive;
  *point = 0;
  GH_TRY(transfers_list(s, 0, &nsend, &nreceive));
  GH_TRY(farm_transfers(s->ctx, s->store, s->comm, nsend, s->sends, nreceive, s->receives));
  farm_store_begin(s->store);
  for (int j = 0; j < b->njobs; j++) {
    if (b->jobs[j].rank != 0) continue;
    *point = b->jobs[j].task.point;
    if (evaluation_stop_requested(s)) {
      evaluation_cancel(s);
      return gh_fail(s->ctx, GH_STOPPED, "stopped on request");
    }
    GH_TRY(farm_store_evaluate(s->store, &b->jobs[j].task, want, s->answers + j));
    s->done[j] = 1;
  }
  return GH_OK;
}

/* The reply of a rank to send_jobs. A rank comes to its jobs in their order, and ends with the one that
 * fails. */
static void answers_receive(farm_shared *s, int rank, failure *f) {
  farm_books *b = &s->books;
  gh_status status = farm_reply(s, rank);
  int done = farm_take_int(&s->message), point = 0;
  for (int j = 0; j < b->njobs; j++) {
    if (b->jobs[j].rank != rank) continue;
    point = b->jobs[j].task.point;
    if (done-- <= 0) break;
    s->done[j] = farm_take(&s->message, s->answers + j, sizeof *s->answers);
    if (!s->done[j]) {
      status = gh_fail(s->ctx, GH_INTERNAL, "a message between ranks is cut off");
      break;
    }
  }
  failure_store(s, f, point, status);
}

static gh_status jobs_run(farm_shared *s, unsigned want, failure *f) {
  farm_books *b = &s->books;
  size_t njobs = (size_t)b->njobs;
  GH_TRY(gh_grow(s->ctx, njobs, sizeof *s->answers, &s->answer_capacity, &s->answers));
  GH_TRY(gh_grow(s->ctx, njobs, 1, &s->done_capacity, &s->done));
  memset(s->done, 0, njobs);
  s->cancelled = false;
  int point, asked = 1;
  gh_status status = GH_OK;
  for (; asked < s->ranks && status == GH_OK; asked++) status = jobs_send(s, asked, want);
  if (status != GH_OK) asked--; /* no memory to ask this one */
  failure_store(s, f, -1, status);
  status = jobs_run_own(s, want, &point);
  failure_store(s, f, point, status);
  for (int r = 1; r < asked; r++) answers_receive(s, r, f);
  return GH_OK;
}

/* How evenly the ranks were busy. */
static void time_count(farm_shared *s) {
  farm_books *b = &s->books;
  double longest = 0;
  for (int r = 0; r < s->ranks; r++) {
    double sum = 0;
    for (int j = 0; j < b->njobs; j++)
      if (s->done[j] && b->jobs[j].rank == r) sum += s->answers[j].seconds;
    b->counts.busy += sum;
    longest = fmax(longest, sum);
  }
  b->counts.longest += longest;
}

/* Answers of all points before `end`, to those who asked. */
static void answers_spread(farm_shared *s, int end, double *P, double *A) {
  farm_books *b = &s->books;
  for (int j = 0; j < b->njobs; j++)
    if (s->done[j]) farm_books_answer(b, j, s->answers + j);
  for (int k = 0; k < b->n && k < end; k++) {
    const farm_answer *a = s->answers + b->job[k];
    memcpy(P + 4 * k, a->P, sizeof a->P);
    if (A) memcpy(A + 16 * k, a->A, sizeof a->A);
    b->measure[k] = a->m;
    b->cost[k] = b->jobs[b->job[k]].cost;
    b->counts.evaluations++;
    b->counts.steps += a->m.steps;
    b->counts.factorisations += a->m.factorisations;
    b->counts.pairs += a->m.pairs;
    b->counts.ramps += a->m.ramps;
    b->counts.settled += a->m.settled;
    b->counts.newton += a->m.newton;
    b->counts.accepted += a->m.accepted;
  }
}

gh_status farm_shared_evaluate(farm_shared *s, const double *F, unsigned want, double *P, double *A) {
  failure f = {.point = INT_MAX};
  if (!A && want & GH_WANT_TANGENT)
    return gh_fail(s->ctx, GH_INTERNAL, "a tangent is required, and there is no place for it");
  GH_TRY(farm_books_plan(&s->books, F));
  GH_TRY(jobs_run(s, want, &f));
  farm_books_settle(&s->books);
  time_count(s);
  answers_spread(s, f.point, P, want & GH_WANT_TANGENT ? A : NULL);
  if (f.point == INT_MAX) return s->books.trial = true, GH_OK;
  gh_fail(s->ctx, f.status, "%s", f.words);
  if (f.point < 0 || f.status == GH_STOPPED) return f.status;
  return gh_prefix(s->ctx, f.status, "integration point %d: ", f.point);
}

/* ---- looking ---- */

/* The job of the last evaluation; for a state that was read back, one at its own F. */
static farm_task task_of_job(const farm_shared *s, int point, int *rank) {
  const farm_books *b = &s->books;
  if (b->job[point] >= 0) {
    *rank = b->jobs[b->job[point]].rank;
    return b->jobs[b->job[point]].task;
  }
  const farm_state *state = b->states + b->state[point];
  farm_task task = {
      .packing = b->packing[point], .from = state->slot, .to = -1, .near = FARM_FRESH, .point = point};
  memcpy(task.F, b->measure[point].F, sizeof task.F);
  *rank = state->rank > 0 ? state->rank : 0;
  return task;
}

gh_status farm_shared_look(farm_shared *s, int point, gh_rve_view *view) {
  int rank;
  if (point < 0 || point >= s->books.n)
    return gh_fail(s->ctx, GH_INPUT, "there is no integration point %d", point);
  if (s->books.measure[point].F[0] == 0 && s->books.measure[point].F[1] == 0)
    return gh_fail(s->ctx, GH_INPUT, "integration point %d was not evaluated yet", point);
  farm_task task = task_of_job(s, point, &rank);
  if (rank == 0) return farm_store_look(s->store, &task, view);
  farm_put(farm_begin_order(s, FARM_LOOK), &task, sizeof task);
  GH_TRY(farm_order(s, rank));
  GH_TRY(farm_reply(s, rank));
  farm_message swap = s->view; /* the view stays while s->message continues */
  s->view = s->message;
  s->message = swap;
  if (farm_take_view(&s->view, view)) return GH_OK;
  return gh_fail(s->ctx, GH_INTERNAL, "a message between ranks is cut off");
}

void farm_shared_costs(farm_shared *s, gh_rve_cost *sum) {
  *sum = (gh_rve_cost){0};
  farm_store_costs(s->store, sum);
  for (int r = 1; r < s->ranks; r++) {
    int tag = FARM_TAG_REPLY;
    gh_rve_cost c;
    farm_begin_order(s, FARM_COSTS);
    if (farm_order(s, r) != GH_OK || farm_receive(s->ctx, s->comm, r, &tag, &s->message, NULL) != GH_OK)
      continue;
    if (farm_take(&s->message, &c, sizeof c)) gh_rve_cost_add(sum, &c);
  }
}
