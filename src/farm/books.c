/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Points, states and jobs of a farm. */
#include "farm/books.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---- memory ---- */

static gh_status books_fill(farm_books *b, const gh_farm_setup *setup) {
  size_t n = (size_t)b->n, ranks = (size_t)b->ranks;
  for (b->table_size = 16; b->table_size < 2 * n;) b->table_size *= 2;
  GH_TRY(gh_alloc(b->ctx, n, sizeof *b->packing, &b->packing));
  GH_TRY(gh_alloc(b->ctx, n, sizeof *b->state, &b->state));
  GH_TRY(gh_alloc(b->ctx, n, sizeof *b->job, &b->job));
  GH_TRY(gh_alloc(b->ctx, n, sizeof *b->near, &b->near));
  GH_TRY(gh_alloc(b->ctx, n, sizeof *b->home, &b->home));
  GH_TRY(gh_alloc(b->ctx, n, sizeof *b->cost, &b->cost));
  GH_TRY(gh_alloc(b->ctx, n, sizeof *b->measure, &b->measure));
  GH_TRY(gh_alloc(b->ctx, b->table_size, sizeof *b->table, &b->table));
  GH_TRY(gh_alloc(b->ctx, ranks, sizeof *b->slots, &b->slots));
  GH_TRY(gh_alloc(b->ctx, ranks, sizeof *b->next_slot, &b->next_slot));
  GH_TRY(gh_grow(b->ctx, (size_t)b->npackings, sizeof *b->states, &b->state_capacity, &b->states));
  for (int k = 0; k < b->npackings; k++)
    b->states[k] =
        (farm_state){.rank = FARM_FRESH, .slot = FARM_FRESH, .packing = k, .users = 1, .content = k};
  b->nstates = (size_t)b->npackings;
  b->content = b->npackings;
  for (int k = 0; k < b->n; k++) {
    b->packing[k] = b->state[k] = setup->packing_of ? setup->packing_of[k] : 0;
    b->states[b->state[k]].users++;
    b->job[k] = b->near[k] = -1;
    b->home[k] = (int)((double)k * b->ranks / b->n);
  }
  return GH_OK;
}

gh_status farm_books_create(gh_context *ctx, const gh_farm_setup *setup, int ranks, farm_books *b) {
  *b = (farm_books){.ctx = ctx,
                    .n = setup->n,
                    .npackings = setup->npackings,
                    .ranks = ranks,
                    .share = !setup->no_share,
                    .balance = !setup->no_balance,
                    .keeps = gh_rve_has_branches(&setup->rve)};
  for (int k = 0; setup->packing_of && k < setup->n; k++)
    if (setup->packing_of[k] < 0 || setup->packing_of[k] >= setup->npackings)
      return gh_fail(ctx, GH_INPUT, "integration point %d: there is no packing %d among %d", k,
                     setup->packing_of[k], setup->npackings);
  return books_fill(b, setup);
}

void farm_books_destroy(farm_books *b) {
  for (int r = 0; b->slots && r < b->ranks; r++) free(b->slots[r].item);
  void *const arrays[] = {b->packing, b->state, b->job,    b->near,      b->home,      b->cost, b->measure,
                          b->table,   b->slots, b->states, b->idle.item, b->next_slot, b->jobs, b->moves};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  *b = (farm_books){0};
}

/* ---- states ---- */

static gh_status list_push(farm_books *b, farm_list *list, int item) {
  GH_TRY(gh_grow(b->ctx, list->n + 1, sizeof *list->item, &list->capacity, &list->item));
  list->item[list->n++] = item;
  return GH_OK;
}

gh_status farm_books_state(farm_books *b, int packing, int rank, long content, int *state) {
  farm_list *slots = b->slots + rank;
  /* room for what release will put back: it cannot fail then */
  GH_TRY(gh_grow(b->ctx, b->nstates + 1, sizeof *b->idle.item, &b->idle.capacity, &b->idle.item));
  GH_TRY(
      gh_grow(b->ctx, (size_t)b->next_slot[rank] + 1, sizeof *slots->item, &slots->capacity, &slots->item));
  if (b->idle.n > 0) {
    *state = b->idle.item[--b->idle.n];
  } else {
    GH_TRY(gh_grow(b->ctx, b->nstates + 1, sizeof *b->states, &b->state_capacity, &b->states));
    *state = (int)b->nstates++;
  }
  int slot = slots->n > 0 ? slots->item[--slots->n] : b->next_slot[rank]++;
  b->states[*state] =
      (farm_state){.rank = rank, .slot = slot, .packing = packing, .users = 1, .content = content};
  return GH_OK;
}

void farm_books_release(farm_books *b, int state) {
  farm_state *s = b->states + state;
  if (--s->users > 0) return;
  list_push(b, b->slots + s->rank, s->slot);
  list_push(b, &b->idle, state);
}

void farm_books_enter(farm_books *b, int point, int state) {
  int old = b->state[point];
  if (old == state) return;
  b->states[state].users++;
  b->state[point] = state;
  farm_books_release(b, old);
}

/* The point keeps another trial state, or none. */
static void state_hold(farm_books *b, int point, int state) {
  int old = b->near[point];
  if (old == state) return;
  if (state >= 0) b->states[state].users++;
  b->near[point] = state;
  if (old >= 0) farm_books_release(b, old);
}

void farm_books_keep(farm_books *b) {
  if (!b->keeps || !b->trial) return;
  for (int k = 0; k < b->n; k++) state_hold(b, k, b->jobs[b->job[k]].result);
}

void farm_books_forget(farm_books *b) {
  for (int k = 0; k < b->n; k++) state_hold(b, k, -1);
}

static void jobs_drop(farm_books *b) {
  for (int j = 0; j < b->njobs; j++) {
    farm_books_release(b, b->jobs[j].state);
    if (b->jobs[j].near >= 0) farm_books_release(b, b->jobs[j].near);
    if (b->jobs[j].result >= 0) farm_books_release(b, b->jobs[j].result);
  }
  b->njobs = 0;
  b->trial = false;
}

void farm_books_clear(farm_books *b) {
  jobs_drop(b);
  farm_books_forget(b);
  for (int k = 0; k < b->n; k++) {
    farm_books_enter(b, k, b->packing[k]);
    b->job[k] = -1;
  }
}

/* ---- jobs ---- */

static uint64_t content_hash(long content, long near, const double F[4]) {
  unsigned char bytes[sizeof content + sizeof near + 4 * sizeof *F];
  memcpy(bytes, &content, sizeof content);
  memcpy(bytes + sizeof content, &near, sizeof near);
  memcpy(bytes + sizeof content + sizeof near, F, 4 * sizeof *F);
  return gh_sum_bytes(GH_SUM_BEGIN, bytes, sizeof bytes);
}

static long content_of_point(const farm_books *b, int state) {
  return state < 0 ? -1 : b->states[state].content;
}

/* The job with these contents and F among those planned so far; -1, and the place in the table where it
 * belongs. */
static int job_find(const farm_books *b, long content, long near, const double F[4], size_t *place) {
  size_t mask = b->table_size - 1, at = (size_t)content_hash(content, near, F) & mask;
  for (; b->table[at] >= 0; at = (at + 1) & mask) {
    const farm_job *job = b->jobs + b->table[at];
    if (content_of_point(b, job->state) == content && content_of_point(b, job->near) == near &&
        !memcmp(job->task.F, F, sizeof job->task.F))
      return b->table[at];
  }
  *place = at;
  return -1;
}

static gh_status jobs_collect(farm_books *b, const double *F) {
  for (size_t k = 0; k < b->table_size; k++) b->table[k] = -1;
  GH_TRY(gh_grow(b->ctx, (size_t)b->n, sizeof *b->jobs, &b->job_capacity, &b->jobs));
  for (int k = 0; k < b->n; k++) {
    size_t place = 0;
    const long content = content_of_point(b, b->state[k]), near = content_of_point(b, b->near[k]);
    int found = b->share ? job_find(b, content, near, F + 4 * k, &place) : -1;
    if (found < 0) {
      found = b->njobs++;
      if (b->share) b->table[place] = found;
      b->jobs[found] = (farm_job){.task = {.packing = b->packing[k], .point = k},
                                  .state = b->state[k],
                                  .near = b->near[k],
                                  .result = -1,
                                  .rank = b->home[k],
                                  .cost = b->cost[k]};
      memcpy(b->jobs[found].task.F, F + 4 * k, sizeof b->jobs[found].task.F);
      b->states[b->state[k]].users++;
      if (b->near[k] >= 0) b->states[b->near[k]].users++;
    }
    b->job[k] = found;
  }
  return GH_OK;
}

/* A copy of a state for a job on another rank. The job's use of the old state ends with the moves
 * (farm_books_settle). */
static gh_status state_bring(farm_books *b, int rank, int *state) {
  if (*state < 0) return GH_OK;
  const farm_state s = b->states[*state];
  int copy;
  if (s.rank == FARM_FRESH || s.rank == rank) return GH_OK;
  GH_TRY(gh_grow(b->ctx, b->nmoves + 1, sizeof *b->moves, &b->move_capacity, &b->moves));
  GH_TRY(farm_books_state(b, s.packing, rank, s.content, &copy));
  b->moves[b->nmoves++] = (farm_move){.from = *state, .to = copy};
  *state = copy;
  return GH_OK;
}

/* Points go along with their jobs' states, and what was moved is let go. Slots become free by this, so it
 * comes after the new states have got theirs: nothing is written over what a move still reads. */
void farm_books_settle(farm_books *b) {
  for (int k = 0; k < b->n; k++) {
    farm_books_enter(b, k, b->jobs[b->job[k]].state);
    state_hold(b, k, b->jobs[b->job[k]].near);
  }
  for (size_t k = 0; k < b->nmoves; k++) farm_books_release(b, b->moves[k].from);
}

gh_status farm_books_plan(farm_books *b, const double *F) {
  jobs_drop(b);
  GH_TRY(jobs_collect(b, F));
  if (b->ranks > 1 && b->balance) GH_TRY(farm_balance(b));
  b->nmoves = 0;
  for (int j = 0; j < b->njobs; j++) {
    GH_TRY(state_bring(b, b->jobs[j].rank, &b->jobs[j].state));
    GH_TRY(state_bring(b, b->jobs[j].rank, &b->jobs[j].near));
  }
  for (int j = 0; j < b->njobs; j++) {
    farm_job *job = b->jobs + j;
    GH_TRY(farm_books_state(b, job->task.packing, job->rank, ++b->content, &job->result));
    job->task.from = b->states[job->state].slot;
    job->task.near = job->near < 0 ? FARM_FRESH : b->states[job->near].slot;
    job->task.to = b->states[job->result].slot;
  }
  b->counts.moved += (long)b->nmoves;
  return GH_OK;
}

void farm_books_answer(farm_books *b, int j, const farm_answer *a) {
  farm_job *job = b->jobs + j;
  b->counts.computed++;
  job->cost = job->cost > 0 ? 0.5 * (job->cost + a->seconds) : a->seconds;
}

void farm_books_commit(farm_books *b) {
  if (!b->trial) return;
  for (int k = 0; k < b->n; k++) farm_books_enter(b, k, b->jobs[b->job[k]].result);
  b->trial = false;
  farm_books_forget(b);
}

int farm_books_count(const farm_books *b) {
  int states = 0;
  for (size_t k = 0; k < b->nstates; k++) b->states[k].seen = false;
  for (int k = 0; k < b->n; k++) {
    farm_state *s = b->states + b->state[k];
    states += !s->seen;
    s->seen = true;
  }
  return states;
}
