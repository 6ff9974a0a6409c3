/* SPDX-License-Identifier: GPL-2.0-or-later */
/* All converged states of a farm, out and in. */
#include "farm/internal.h"

#include <stdlib.h>
#include <string.h>

static size_t numbers_in_bytes(void) {
  return (sizeof(gh_rve_measures) + sizeof(double) - 1) / sizeof(double);
}

void gh_farm_image_free(gh_farm_image *image) {
  free(image->state);
  free(image->start);
  free(image->data);
  free(image->measure);
  *image = (gh_farm_image){0};
}

static gh_status image_alloc_points(gh_context *ctx, int n, gh_farm_image *image) {
  *image = (gh_farm_image){.npoints = n, .nwords = (int)numbers_in_bytes()};
  GH_TRY(gh_alloc(ctx, (size_t)n, sizeof *image->state, &image->state));
  GH_TRY(gh_alloc(ctx, (size_t)n + 1, sizeof *image->start, &image->start));
  return gh_alloc(ctx, (size_t)n * numbers_in_bytes(), sizeof *image->measure, &image->measure);
}

/* Numbers the states by their first point; list: the states in that order. */
static gh_status states_number(farm_shared *s, gh_farm_image *image, int **list) {
  farm_books *b = &s->books;
  int *number;
  GH_TRY(gh_alloc(s->ctx, (size_t)b->n, sizeof **list, list));
  GH_TRY(gh_alloc(s->ctx, b->nstates, sizeof *number, &number));
  for (size_t k = 0; k < b->nstates; k++) number[k] = -1;
  for (int k = 0; k < b->n; k++) {
    int state = b->state[k];
    if (b->states[state].rank != FARM_FRESH && number[state] < 0) {
      (*list)[image->nstates] = state;
      number[state] = image->nstates++;
    }
    image->state[k] = number[state];
  }
  free(number);
  return GH_OK;
}

/* Asks every rank for its states of the list. They come in the list's order. */
static gh_status states_request(farm_shared *s, const int *list, int count) {
  const farm_books *b = &s->books;
  for (int r = 1; r < s->ranks; r++) {
    int n = 0;
    for (int k = 0; k < count; k++) n += b->states[list[k]].rank == r;
    farm_message *m = farm_begin_order(s, FARM_FETCH);
    farm_put_int(m, n);
    for (int k = 0; k < count; k++)
      if (b->states[list[k]].rank == r) farm_put_int(m, b->states[list[k]].slot);
    GH_TRY(farm_order(s, r));
  }
  return GH_OK;
}

static gh_status states_gather(farm_shared *s, const int *list, gh_farm_image *image) {
  size_t capacity = 0;
  for (int k = 0; k < image->nstates; k++) {
    const farm_state *state = s->books.states + list[k];
    const double *own = NULL;
    size_t at = image->start[k], size;
    if (state->rank == 0) GH_TRY(farm_store_get(s->store, state->slot, &own, &size));
    else size = farm_next_state(s->comm, state->rank);
    GH_TRY(gh_grow(s->ctx, at + size, sizeof *image->data, &capacity, &image->data));
    if (own) memcpy(image->data + at, own, size * sizeof *own);
    else farm_receive_state(s->comm, state->rank, image->data + at, size);
    if (size == 0) return gh_fail(s->ctx, GH_INTERNAL, "rank %d has lost a state", state->rank);
    image->start[k + 1] = at + size;
  }
  return GH_OK;
}

gh_status gh_farm_save(gh_farm *f, gh_farm_image *image) {
  farm_shared *s = f->shared;
  int *list = NULL;
  gh_status status;
  *image = (gh_farm_image){0};
  if (!s) return gh_fail(f->ctx, GH_INPUT, "only the states of RVEs can be saved");
  GH_TRY_OR(image_alloc_points(s->ctx, f->n, image), done);
  for (int k = 0; k < f->n; k++)
    memcpy(image->measure + numbers_in_bytes() * (size_t)k, s->books.measure + k, sizeof(gh_rve_measures));
  GH_TRY_OR(states_number(s, image, &list), done);
  GH_TRY_OR(states_request(s, list, image->nstates), done);
  status = states_gather(s, list, image);
done:
  free(list);
  return status;
}

/* ---- back ---- */

static gh_status image_check(farm_shared *s, const gh_farm_image *image) {
  gh_context *ctx = s->ctx;
  if (image->npoints != s->books.n)
    return gh_fail(ctx, GH_INPUT, "states of %d integration points for %d", image->npoints, s->books.n);
  if (image->nwords != (int)numbers_in_bytes())
    return gh_fail(ctx, GH_INPUT, "measures of %d numbers, this version has %d", image->nwords,
                   (int)numbers_in_bytes());
  for (int k = 0; k < image->npoints; k++)
    if (image->state[k] < -1 || image->state[k] >= image->nstates)
      return gh_fail(ctx, GH_INPUT, "integration point %d is in state %d of %d", k, image->state[k],
                     image->nstates);
  for (int k = 0; k < image->nstates; k++)
    if (image->start[k + 1] <= image->start[k])
      return gh_fail(ctx, GH_INPUT, "state %d of %d is empty", k, image->nstates);
  return GH_OK;
}

/* New states for the image's, each on the rank of its first point; the list holds one user each. */
static gh_status states_make(farm_shared *s, const gh_farm_image *image, int *list) {
  farm_books *b = &s->books;
  for (int k = 0; k < image->nstates; k++) list[k] = -1;
  for (int p = 0; p < b->n; p++) {
    int k = image->state[p];
    if (k < 0) continue;
    if (list[k] < 0) GH_TRY(farm_books_state(b, b->packing[p], b->home[p], ++b->content, list + k));
    if (b->states[list[k]].packing != b->packing[p])
      return gh_fail(s->ctx, GH_INPUT, "integration point %d shares a state with one of another packing", p);
    farm_books_enter(b, p, list[k]);
  }
  for (int k = 0; k < image->nstates; k++)
    if (list[k] < 0) return gh_fail(s->ctx, GH_INPUT, "no integration point is in state %d", k);
  for (int k = 0; k < image->nstates; k++) farm_books_release(b, list[k]);
  return GH_OK;
}

static gh_status states_send(farm_shared *s, const gh_farm_image *image, const int *list, int rank) {
  const farm_books *b = &s->books;
  int n = 0;
  for (int k = 0; k < image->nstates; k++) n += b->states[list[k]].rank == rank;
  if (n == 0) return GH_OK;
  farm_message *m = farm_begin_order(s, FARM_PUT);
  farm_put_int(m, n);
  for (int k = 0; k < image->nstates; k++)
    if (b->states[list[k]].rank == rank) farm_put_int(m, b->states[list[k]].slot);
  GH_TRY(farm_order(s, rank));
  for (int k = 0; k < image->nstates; k++) {
    if (b->states[list[k]].rank != rank) continue;
    farm_request request;
    farm_send_state(s->comm, rank, image->data + image->start[k], image->start[k + 1] - image->start[k],
                    &request);
    farm_wait(&request, 1);
  }
  return farm_reply(s, rank);
}

static gh_status states_store_own(farm_shared *s, const gh_farm_image *image, const int *list) {
  for (int k = 0; k < image->nstates; k++) {
    const farm_state *state = s->books.states + list[k];
    size_t size = image->start[k + 1] - image->start[k];
    double *data;
    if (state->rank != 0) continue;
    GH_TRY(farm_store_put(s->store, state->slot, size, &data));
    memcpy(data, image->data + image->start[k], size * sizeof *data);
  }
  return GH_OK;
}

gh_status gh_farm_load(gh_farm *f, const gh_farm_image *image) {
  farm_shared *s = f->shared;
  int *list = NULL;
  gh_status status;
  if (!s) return gh_fail(f->ctx, GH_INPUT, "only the states of RVEs can be read back");
  GH_TRY(image_check(s, image));
  GH_TRY_OR(gh_alloc(s->ctx, (size_t)image->nstates + 1, sizeof *list, &list), done);
  farm_books_clear(&s->books);
  GH_TRY_OR(states_make(s, image, list), done);
  GH_TRY_OR(states_store_own(s, image, list), done);
  for (int r = 1; r < s->ranks; r++) GH_TRY_OR(states_send(s, image, list, r), done);
  for (int k = 0; k < f->n; k++)
    memcpy(s->books.measure + k, image->measure + numbers_in_bytes() * (size_t)k, sizeof(gh_rve_measures));
done:
  free(list);
  return status;
}
