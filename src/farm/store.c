/* SPDX-License-Identifier: GPL-2.0-or-later */
/* States and RVEs of one rank. */
#include "farm/store.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct slot {
  double *data;
  size_t size, capacity;
  long version; /* another one whenever it is written */
  int space;    /* that wrote it, -1 */
  long ticket;  /* of the evaluation that wrote it, 0 */
} slot;

/* An RVE of the pool. */
typedef struct space {
  gh_rve *rve;
  int packing;
  long ticket; /* of its last evaluation */
  long loaded; /* version of the state that it starts from, 0 */
  double bytes;
} space;

struct farm_store {
  gh_context *ctx;
  int npackings;
  gh_packing **packings;
  slot *fresh; /* npackings: the packings as read */
  gh_rve_options options;
  int resident;
  slot *slots;
  size_t nslots, slot_capacity;
  size_t largest; /* state in a slot so far */
  space *spaces;
  int nspaces;
  size_t space_capacity;
  double bytes;    /* of all spaces */
  long ticket;     /* of the last evaluation */
  long version;    /* the last one given out */
  long round, old; /* tickets when the present round and the one before it began */
  int *cursor;     /* npackings: behind the last space that find_fresh gave in this round */
  gh_rve_cost off; /* cost of RVEs that are gone */
};

/* ---- memory ---- */

/* Bytes that are allocated at present. */
static double memory_in_use(void) {
  struct mallinfo2 m = mallinfo2();
  return (double)m.uordblks + (double)m.hblkhd;
}

void gh_rve_cost_add(gh_rve_cost *sum, const gh_rve_cost *c) {
  sum->set += c->set, sum->relax += c->relax, sum->contacts += c->contacts, sum->factorise += c->factorise,
      sum->history += c->history, sum->total += c->total;
  sum->evaluations += c->evaluations, sum->steps += c->steps, sum->factorisations += c->factorisations,
      sum->analyses += c->analyses, sum->pairs += c->pairs;
}

static void cost_add(gh_rve_cost *sum, const gh_rve *rve) {
  gh_rve_cost c;
  gh_rve_costs(rve, &c);
  gh_rve_cost_add(sum, &c);
}

gh_status farm_store_create(gh_context *ctx, int npackings, gh_packing **packings,
                            const gh_rve_options *options, int resident, farm_store **store) {
  gh_status status;
  farm_store *s = NULL;
  *store = NULL;
  GH_TRY_OR(gh_alloc(ctx, 1, sizeof *s, &s), failed);
  *s = (farm_store){.ctx = ctx, .options = *options, .resident = resident};
  GH_TRY_OR(gh_alloc(ctx, (size_t)npackings, sizeof *s->packings, &s->packings), failed);
  memcpy(s->packings, packings, (size_t)npackings * sizeof *packings);
  s->npackings = npackings;
  GH_TRY_OR(gh_alloc(ctx, (size_t)npackings, sizeof *s->fresh, &s->fresh), failed);
  GH_TRY_OR(gh_alloc(ctx, (size_t)npackings, sizeof *s->cursor, &s->cursor), failed);
  *store = s;
  return GH_OK;
failed:
  if (s && s->packings) farm_store_destroy(&s);
  else
    for (int k = 0; k < npackings; k++) gh_packing_destroy(packings + k);
  free(s);
  return status;
}

void farm_store_destroy(farm_store **store) {
  if (!store || !*store) return;
  farm_store *s = *store;
  for (int k = 0; k < s->nspaces; k++) gh_rve_destroy(&s->spaces[k].rve);
  for (size_t k = 0; k < s->nslots; k++) free(s->slots[k].data);
  for (int k = 0; k < s->npackings; k++) {
    gh_packing_destroy(&s->packings[k]);
    if (s->fresh) free(s->fresh[k].data);
  }
  free(s->packings);
  free(s->fresh);
  free(s->cursor);
  free(s->slots);
  free(s->spaces);
  free(s);
  *store = NULL;
}

/* ---- slots ---- */

static gh_status slot_resize(farm_store *s, slot *q, size_t size) {
  GH_TRY(gh_grow(s->ctx, size, sizeof *q->data, &q->capacity, &q->data));
  q->size = size;
  q->version = ++s->version;
  q->space = -1;
  q->ticket = 0;
  return GH_OK;
}

static gh_status slot_find(farm_store *s, int number) {
  size_t need = (size_t)number + 1;
  GH_TRY(gh_grow(s->ctx, need, sizeof *s->slots, &s->slot_capacity, &s->slots));
  for (; s->nslots < need; s->nslots++) s->slots[s->nslots] = (slot){.space = -1};
  return GH_OK;
}

/* Numbers to make room for where this state comes: a new slot may get the end of a ramp, too. */
static size_t slot_room(const farm_store *s, const slot *q, size_t size) {
  const bool ramps = gh_rve_has_branches(&s->options) && s->options.integration == GH_INTEGRATION_RAMP;
  return ramps && q->capacity == 0 ? 2 * size : size;
}

gh_status farm_store_put(farm_store *s, int number, size_t size, double **state) {
  GH_TRY(slot_find(s, number));
  slot *q = s->slots + number;
  const size_t room = slot_room(s, q, size);
  if (room > s->largest) s->largest = room;
  /* Slots go from point to point, and states grow with their contacts: one that must grow at all gets room
   * for any of them. */
  if (size > q->capacity) GH_TRY(gh_grow(s->ctx, s->largest, sizeof *q->data, &q->capacity, &q->data));
  GH_TRY(slot_resize(s, q, size));
  *state = s->slots[number].data;
  return GH_OK;
}

gh_status farm_store_get(farm_store *s, int number, const double **state, size_t *size) {
  if (number < 0 || (size_t)number >= s->nslots || !s->slots[number].data)
    return gh_fail(s->ctx, GH_INTERNAL, "slot %d of the farm holds no state", number);
  *state = s->slots[number].data;
  *size = s->slots[number].size;
  return GH_OK;
}

/* ---- the pool ---- */

static gh_status space_make(farm_store *s, int packing, space *w) {
  double before = memory_in_use();
  *w = (space){.packing = packing};
  GH_TRY(gh_rve_create(s->ctx, s->packings[packing], &s->options, &w->rve));
  w->bytes = fmax(memory_in_use() - before, 0);
  s->bytes += w->bytes;
  if (s->fresh[packing].data) return GH_OK;
  GH_TRY(slot_resize(s, s->fresh + packing, gh_rve_state_size(w->rve)));
  return gh_rve_save(w->rve, s->fresh[packing].data);
}

static void space_clear(farm_store *s, space *w) {
  if (!w->rve) return;
  cost_add(&s->off, w->rve);
  s->bytes -= w->bytes;
  gh_rve_destroy(&w->rve);
}

static bool store_is_full(const farm_store *s) {
  if (s->nspaces == 0) return false;
  if (s->resident > 0) return s->nspaces >= s->resident;
  return s->bytes * (s->nspaces + 1) / s->nspaces > GH_FARM_BYTES;
}

/* Of the spaces of this packing (-1: of any): one that was not used in the round before and not in this one,
 * else the one used last: so all others stay with the states that they have served before. */
static int space_pick(const farm_store *s, int packing) {
  int best = -1;
  for (int k = 0; k < s->nspaces; k++) {
    const space *w = s->spaces + k;
    if (packing >= 0 && w->packing != packing) continue;
    if (w->ticket <= s->old) return k;
    if (best < 0 || w->ticket > s->spaces[best].ticket) best = k;
  }
  return best;
}

/* A space that is free in this round and holds the packing as read: points start from that state, which no
 * space has written, until the first commit. -1: none. */
static int space_find_fresh(farm_store *s, int packing) {
  while (s->cursor[packing] < s->nspaces) {
    int k = s->cursor[packing]++;
    const space *w = s->spaces + k;
    if (w->rve && w->packing == packing && w->ticket <= s->round && w->loaded == s->fresh[packing].version)
      return k;
  }
  return -1;
}

static gh_status space_choose(farm_store *s, const farm_task *task, int *chosen) {
  int before = task->from == FARM_FRESH ? -1 : s->slots[task->from].space;
  if (before >= 0 && s->spaces[before].packing == task->packing && s->spaces[before].ticket <= s->round &&
      s->spaces[before].rve)
    return *chosen = before, GH_OK;
  *chosen = task->from == FARM_FRESH ? space_find_fresh(s, task->packing) : -1;
  if (*chosen >= 0) return GH_OK;
  if (store_is_full(s)) *chosen = space_pick(s, task->packing);
  if (*chosen >= 0 && s->spaces[*chosen].rve) return GH_OK;
  if (*chosen < 0 && store_is_full(s)) *chosen = space_pick(s, -1);
  if (*chosen < 0) {
    GH_TRY(gh_grow(s->ctx, (size_t)s->nspaces + 1, sizeof *s->spaces, &s->space_capacity, &s->spaces));
    s->spaces[ *chosen = s->nspaces++] = (space){0};
  }
  space *w = s->spaces + *chosen;
  space_clear(s, w);
  return space_make(s, task->packing, w);
}

gh_status farm_store_check(farm_store *s) {
  for (int k = 0; k < s->npackings; k++) {
    space w = {0};
    gh_status status = space_make(s, k, &w);
    s->bytes -= w.bytes;
    gh_rve_destroy(&w.rve);
    GH_TRY(status);
  }
  return GH_OK;
}

/* ---- evaluations ---- */

static double processor_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void farm_store_begin(farm_store *s) {
  s->old = s->round;
  s->round = s->ticket;
  memset(s->cursor, 0, (size_t)s->npackings * sizeof *s->cursor);
}

static gh_status space_load(farm_store *s, const farm_task *task, space *w) {
  const slot *from = task->from == FARM_FRESH ? s->fresh + task->packing : s->slots + task->from;
  if (w->loaded == from->version) return GH_OK;
  w->loaded = 0;
  GH_TRY(gh_rve_load(w->rve, from->data, from->size));
  w->loaded = from->version;
  return GH_OK;
}

static gh_status space_evaluate(farm_store *s, const farm_task *task, gh_rve *rve, unsigned want, double *P,
                                double *A) {
  const double *near = NULL;
  size_t size = 0;
  if (task->near != FARM_FRESH) GH_TRY(farm_store_get(s, task->near, &near, &size));
  return gh_rve_evaluate_near(rve, task->F, near, size, want, P, A);
}

static gh_status task_check(farm_store *s, const farm_task *task) {
  const double *state;
  size_t size;
  if (task->packing < 0 || task->packing >= s->npackings)
    return gh_fail(s->ctx, GH_INTERNAL, "the farm has no packing %d", task->packing);
  return task->from == FARM_FRESH ? GH_OK : farm_store_get(s, task->from, &state, &size);
}

/* The first evaluation of an RVE takes its work memory too. */
static void memory_measure(farm_store *s, space *w, double before) {
  double bytes = fmax(memory_in_use() - before, 0);
  w->bytes += bytes;
  s->bytes += bytes;
}

gh_status farm_store_evaluate(farm_store *s, const farm_task *task, unsigned want, farm_answer *a) {
  int k;
  double begin = processor_seconds();
  GH_TRY(task_check(s, task));
  GH_TRY(space_choose(s, task, &k));
  space *w = s->spaces + k;
  bool first = w->ticket == 0;
  double before = first ? memory_in_use() : 0;
  w->ticket = ++s->ticket;
  GH_TRY(space_load(s, task, w));
  gh_status status = space_evaluate(s, task, w->rve, want, a->P, a->A);
  if (first) memory_measure(s, w, before);
  GH_TRY(status);
  double *state;
  GH_TRY(farm_store_put(s, task->to, gh_rve_trial_size(w->rve), &state));
  GH_TRY(gh_rve_save_trial(w->rve, state));
  s->slots[task->to].space = k;
  s->slots[task->to].ticket = w->ticket;
  a->m = *gh_rve_measure(w->rve);
  a->seconds = processor_seconds() - begin;
  return GH_OK;
}

gh_status farm_store_look(farm_store *s, const farm_task *task, gh_rve_view *view) {
  int k;
  double P[4];
  GH_TRY(task_check(s, task));
  if (task->to >= 0 && (size_t)task->to < s->nslots) {
    const slot *q = s->slots + task->to;
    if (q->ticket > 0 && s->spaces[q->space].ticket == q->ticket)
      return gh_rve_look(s->spaces[q->space].rve, view);
  }
  GH_TRY(space_choose(s, task, &k));
  s->spaces[k].ticket = ++s->ticket;
  GH_TRY(space_load(s, task, s->spaces + k));
  GH_TRY(space_evaluate(s, task, s->spaces[k].rve, 0, P, NULL));
  return gh_rve_look(s->spaces[k].rve, view);
}

void farm_store_costs(const farm_store *s, gh_rve_cost *sum) {
  gh_rve_cost_add(sum, &s->off);
  for (int k = 0; k < s->nspaces; k++)
    if (s->spaces[k].rve) cost_add(sum, s->spaces[k].rve);
}

int farm_store_residents(const farm_store *s, double *bytes) {
  *bytes = s->nspaces > 0 ? s->bytes / s->nspaces : 0;
  return s->nspaces;
}
