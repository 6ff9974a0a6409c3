/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Ramps: a packing follows a gradient while it relaxes (method 3, "Ramps"). */
#include "engine/relax/relax_friction_parts.h"

#include <string.h>

void gh_relax_ramp_gradient(const gh_relax_ramp *ramp, double G[4]) {
  const double share = ramp->steps > 0 ? (double)ramp->done / (double)ramp->steps : 1;
  for (int k = 0; k < 4; k++) {
    const double one = k == 0 || k == 3 ? 1 : 0;
    G[k] = ramp->done < ramp->steps ? one + share * (ramp->to[k] - one) : ramp->to[k];
  }
}

bool gh_ramp_is_over(const gh_relax_friction *s) {
  return !s->ramp || s->ramp->done >= s->ramp->steps;
}

gh_ramp_list gh_ramp_begin(gh_relax_friction *s, const gh_friction_parts *w) {
  gh_relax_state *g = &s->grains;
  gh_ramp_list list = {.reach = 0};
  if (!s->ramp) return list;
  for (int i = 0; i < g->n; i++) list.reach = fmax(list.reach, 2 * s->radius[i]);
  gh_relax_ramp_gradient(s->ramp, list.from);
  memcpy(w->x0, g->x0, 2 * (size_t)g->n * sizeof(double));
  g->x0 = w->x0;
  return list;
}

void gh_ramp_advance(gh_relax_friction *s, const gh_friction_parts *w) {
  gh_relax_state *g = &s->grains;
  const size_t n = (size_t)g->npairs;
  double before[4], after[4], inverse[4], D[4];
  gh_relax_ramp_gradient(s->ramp, before);
  s->ramp->done++;
  gh_relax_ramp_gradient(s->ramp, after);
  gh_inv2(before, inverse);
  gh_mul2(after, inverse, D);
  for (int i = 0; i < g->n; i++) {
    gh_apply2(D, g->x + 2 * i, g->x + 2 * i);
    gh_apply2(D, w->x0 + 2 * i, w->x0 + 2 * i);
  }
  for (size_t p = 0; p < n; p++) {
    const double shift[2] = {w->given[SHIFT_X * n + p], w->given[SHIFT_Y * n + p]};
    w->given[SHIFT_X * n + p] = D[0] * shift[0] + D[1] * shift[1];
    w->given[SHIFT_Y * n + p] = D[2] * shift[0] + D[3] * shift[1];
  }
  const double turn = gh_turn2(D);
  for (int i = 0; i < g->n && !s->law->fixed_rotations; i++) s->theta[i] += turn;
}

/* How far a grain may be from where the list was made: pairs beyond reach and skin come nearer by the strain
 * since then, too. */
double gh_ramp_slack(const gh_relax_friction *s, const gh_ramp_list *list) {
  const double slack = s->grains.slack;
  double now[4];
  if (!s->ramp) return slack;
  gh_relax_ramp_gradient(s->ramp, now);
  return fmax(0, slack - 0.5 * gh_strain2(list->from, now) * (list->reach + 2 * slack));
}

gh_relax_end gh_ramp_end(gh_relax_friction *s, const gh_friction_parts *w, gh_relax_end end) {
  const size_t n = (size_t)s->grains.npairs;
  for (size_t p = 0; s->ramp && p < n; p++)
    s->memory[p] = (gh_pair_memory){.ln = {w->given[LN_X * n + p], w->given[LN_Y * n + p]},
                                    .gamma = w->given[GAMMA * n + p],
                                    .gamma_pl = w->given[GAMMA_PL * n + p],
                                    .alpha = w->given[ALPHA * n + p]};
  return end;
}
