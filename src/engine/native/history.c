/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The converged state n of the native engine. */
#include "engine/native/history.h"

#include "contact/slips.h"

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

/* The history of pair number p of the list, as the memory has it. */
static gh_slip pair_slip(const gh_neighbours *nb, size_t p, const gh_pair_memory *m) {
  return (gh_slip){.i = nb->pairs[p].i,
                   .j = nb->pairs[p].j,
                   .image = {nb->image[2 * p], nb->image[2 * p + 1]},
                   .gamma = m->gamma,
                   .gamma_pl = m->gamma_pl,
                   .alpha = m->alpha};
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
    const gh_slip key = pair_slip(nb, p, m);
    while (s < h->nslips && gh_slip_order(&h->slips[s], &key) < 0) s++; /* pairs that have gone far apart */
    if (s == h->nslips || gh_slip_order(&h->slips[s], &key) != 0) continue;
    m->gamma = h->slips[s].gamma;
    m->gamma_pl = h->slips[s].gamma_pl;
    m->alpha = h->slips[s].alpha;
  }
  return GH_OK;
}

gh_status gh_history_store(gh_context *ctx, gh_history *h, const gh_neighbours *nb, int n, const double *x,
                           const double cell[4]) {
  const size_t most = nb->npairs + h->nslips + 1; /* the two change places: both must be large enough */
  GH_TRY(gh_grow(ctx, most, sizeof(gh_slip), &h->spare_capacity, &h->spare));
  GH_TRY(gh_grow(ctx, most, sizeof(gh_slip), &h->slip_capacity, &h->slips));
  int count = 0;
  for (size_t p = 0; p < nb->npairs; p++) {
    const gh_slip now = pair_slip(nb, p, &h->memory[p]);
    if (now.gamma != 0 || now.gamma_pl != 0 || now.alpha != 0) h->spare[count++] = now;
  }
  count = gh_slips_add_opened(h->spare, count, h->slips, (int)h->nslips);
  gh_slip *const swap = h->slips;
  const size_t capacity = h->slip_capacity;
  h->slips = h->spare, h->slip_capacity = h->spare_capacity, h->nslips = (size_t)count;
  h->spare = swap, h->spare_capacity = capacity;
  memcpy(h->x, x, 2 * (size_t)n * sizeof(double));
  if (cell) memcpy(h->cell, cell, sizeof h->cell);
  return GH_OK;
}
