/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The converged state n of the native engine. */
#include "engine/native/history.h"

#include <stdlib.h>
#include <string.h>

gh_status gh_history_alloc(gh_context *ctx, gh_history *h, int n) {
  GH_TRY(gh_alloc(ctx, 2 * (size_t)n, sizeof(double), &h->x));
  return gh_alloc(ctx, (size_t)n, sizeof(double), &h->theta);
}

void gh_history_free(gh_history *h) {
  free(h->x);
  free(h->theta);
  free(h->slips);
  free(h->spare);
  free(h->memory);
  *h = (gh_history){0};
}

gh_status gh_history_begin(gh_context *ctx, gh_history *h, int n, bool periodic, const gh_converged *state) {
  const size_t slips = (size_t)state->nslips;
  GH_TRY(gh_grow(ctx, slips, sizeof(gh_slip), &h->slip_capacity, &h->slips));
  if (slips) memcpy(h->slips, state->slips, slips * sizeof(gh_slip));
  h->nslips = slips;
  if (periodic) memcpy(h->cell, state->cell, sizeof h->cell);
  memcpy(h->x, state->x, 2 * (size_t)n * sizeof(double));
  memcpy(h->theta, state->theta, (size_t)n * sizeof(double));
  return GH_OK;
}

/* Order of a slip and of a pair with the image k: negative where the slip comes first. */
static int order(const gh_slip *s, const gh_pair *p, const int k[2]) {
  if (s->i != p->i) return s->i < p->i ? -1 : 1;
  if (s->j != p->j) return s->j < p->j ? -1 : 1;
  if (s->image[1] != k[1]) return s->image[1] < k[1] ? -1 : 1;
  return s->image[0] < k[0] ? -1 : s->image[0] > k[0];
}

gh_status gh_history_recall(gh_context *ctx, gh_history *h, const gh_neighbours *nb) {
  GH_TRY(gh_grow(ctx, nb->npairs, sizeof *h->memory, &h->memory_capacity, &h->memory));
  size_t s = 0;
  for (size_t p = 0; p < nb->npairs; p++) { /* both are sorted alike */
    const gh_pair *q = &nb->pairs[p];
    const int *k = nb->image + 2 * p;
    gh_pair_memory *m = &h->memory[p];
    *m = (gh_pair_memory){0};
    for (int c = 0; c < 2; c++)
      m->ln[c] = h->x[2 * q->j + c] - h->x[2 * q->i + c] + h->cell[2 * c] * k[0] + h->cell[2 * c + 1] * k[1];
    while (s < h->nslips && order(&h->slips[s], q, k) < 0) s++; /* pairs that have gone far apart */
    if (s == h->nslips || order(&h->slips[s], q, k) != 0) continue;
    m->gamma = h->slips[s].gamma;
    m->gamma_pl = h->slips[s].gamma_pl;
    m->alpha = h->slips[s].alpha;
  }
  return GH_OK;
}

/* Of a slip without a pair. */
static void history_put_apart(gh_slip *to, size_t *count, const gh_slip *old) {
  if (old->alpha == 0) return;
  to[*count] = *old;
  to[*count].gamma = to[*count].gamma_pl = 0;
  ++*count;
}

gh_status gh_history_store(gh_context *ctx, gh_history *h, const gh_neighbours *nb, int n, const double *x,
                           const double cell[4]) {
  const size_t most = nb->npairs + h->nslips + 1; /* the two change places: both must be large enough */
  GH_TRY(gh_grow(ctx, most, sizeof(gh_slip), &h->spare_capacity, &h->spare));
  GH_TRY(gh_grow(ctx, most, sizeof(gh_slip), &h->slip_capacity, &h->slips));
  size_t s = 0, count = 0;
  for (size_t p = 0; p < nb->npairs; p++) { /* both are sorted alike */
    const gh_pair *q = &nb->pairs[p];
    const int *k = nb->image + 2 * p;
    const gh_pair_memory *m = &h->memory[p];
    for (; s < h->nslips && order(&h->slips[s], q, k) < 0; s++)
      history_put_apart(h->spare, &count, &h->slips[s]);
    if (s < h->nslips && order(&h->slips[s], q, k) == 0) s++;
    if (m->gamma == 0 && m->gamma_pl == 0 && m->alpha == 0) continue;
    h->spare[count++] = (gh_slip){.i = q->i,
                                  .j = q->j,
                                  .image = {k[0], k[1]},
                                  .gamma = m->gamma,
                                  .gamma_pl = m->gamma_pl,
                                  .alpha = m->alpha};
  }
  for (; s < h->nslips; s++) history_put_apart(h->spare, &count, &h->slips[s]);
  gh_slip *const swap = h->slips;
  const size_t capacity = h->slip_capacity;
  h->slips = h->spare, h->slip_capacity = h->spare_capacity, h->nslips = count;
  h->spare = swap, h->spare_capacity = capacity;
  memcpy(h->x, x, 2 * (size_t)n * sizeof(double));
  if (cell) memcpy(h->cell, cell, sizeof h->cell);
  return GH_OK;
}
