/* SPDX-License-Identifier: GPL-2.0-or-later */
/* History of the contacts from one converged state to the next (Table 7.1). */
#include "micro/internal.h"

#include "contact/slips.h"

#include <string.h>

gh_status gh_slips_advance(gh_context *ctx, const gh_slips *from, const gh_contact_list *list, bool hardening,
                           gh_slips *to) {
  size_t most = (size_t)list->count + (hardening ? (size_t)from->count : 0);
  GH_TRY(gh_grow(ctx, most + 1, sizeof(gh_slip), &to->capacity, &to->slips));
  to->count = 0;
  for (int c = 0; c < list->count; c++) {
    const gh_slip *now = &list->friction[c].slip;
    if (now->gamma != 0 || now->gamma_pl != 0 || now->alpha != 0) to->slips[to->count++] = *now;
  }
  if (hardening) to->count = gh_slips_add_opened(to->slips, to->count, from->slips, from->count);
  return GH_OK;
}

void gh_slips_save(const gh_slips *h, double *to) {
  for (int c = 0; c < h->count; c++) {
    const gh_slip *q = &h->slips[c];
    memcpy(to + GH_SLIP_NUMBERS * (size_t)c,
           (double[GH_SLIP_NUMBERS]){q->i, q->j, q->image[0], q->image[1], q->gamma, q->gamma_pl, q->alpha},
           GH_SLIP_NUMBERS * sizeof *to);
  }
}

gh_status gh_slips_load(gh_context *ctx, const double *from, int count, gh_slips *h) {
  GH_TRY(gh_grow(ctx, (size_t)count + 1, sizeof(gh_slip), &h->capacity, &h->slips));
  h->count = 0;
  for (const double *q = from; h->count < count; q += GH_SLIP_NUMBERS) {
    for (int k = 0; k < 4; k++)
      if (q[k] != nearbyint(q[k]) || fabs(q[k]) > 1e9)
        return gh_fail(ctx, GH_INPUT, "the state to load has a contact whose key is not made of integers");
    h->slips[h->count++] = (gh_slip){.i = (int)q[0],
                                     .j = (int)q[1],
                                     .image = {(int)q[2], (int)q[3]},
                                     .gamma = q[4],
                                     .gamma_pl = q[5],
                                     .alpha = q[6]};
  }
  return GH_OK;
}

/* ---- what slip counts from ---- */

static gh_status history_start(gh_rve *r, const double F[4], const double *y, const double *theta,
                               const gh_slips *slips) {
  gh_converged c = {.theta = theta, .slips = slips->slips, .nslips = slips->count, .x = r->step};
  gh_mul2(F, r->lattice, c.cell);
  for (int i = 0; i < r->n; i++) gh_apply2(F, &y[2 * i], &r->step[2 * i]);
  return gh_engine_begin(r->engine, &c);
}

gh_status gh_rve_begin_increment(gh_rve *r) {
  if (!gh_rve_friction(r) || r->begun) return GH_OK;
  GH_TRY(history_start(r, r->Fn, r->yn, r->thetan, &r->history));
  r->begun = true;
  return GH_OK;
}

gh_status gh_rve_resume_base(gh_rve *r) {
  const gh_base *k = &r->base;
  r->begun = false;
  r->based = true;
  return history_start(r, k->F, k->y, k->theta, &k->slips);
}

gh_status gh_rve_advance_history(gh_rve *r) {
  const double start = gh_seconds();
  const gh_slips *from = r->based ? &r->base.slips : &r->history;
  r->dissipated = r->based ? r->base.dissipated : r->dissipatedn;
  for (int c = 0; c < r->list.count; c++) r->dissipated += r->list.friction[c].dissipated;
  GH_TRY(gh_slips_advance(r->ctx, from, &r->list, r->options.law.hardening > 0, &r->trial_history));
  r->cost.history += gh_seconds() - start;
  return GH_OK;
}
