/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Inspecting an RVE: grains, flags and contacts of the last evaluation. */
#include "micro/internal.h"

#include <string.h>

enum { RATTLER = 1, HELD = 2, REPLICA = 4, FRAME = 8 };

/* What balances the contacts of the frame. */
static const double *frame_support(const gh_rve *r) {
  double *to = r->frame->support;
  memset(to, 0, 3 * (size_t)r->n * sizeof *to);
  for (int i = 0; i < r->n && !r->m.unjammed; i++) {
    if (!r->frame->on[i]) continue;
    for (int k = 0; k < 2; k++) to[3 * i + k] = -r->list.force[2 * i + k];
    if (r->turns) to[3 * i + 2] = -r->list.moment[i];
  }
  return to;
}

gh_status gh_rve_look(gh_rve *r, gh_rve_view *view) {
  const gh_packing *p = r->packing;
  for (int i = 0; i < r->n; i++) {
    int primary = r->cluster ? r->cluster->grain[i] : r->frame ? r->frame->grain[i] : i;
    r->view_grain[i] = primary;
    r->view_id[i] = p->id[primary];
    bool rattler = r->rattlers && r->rattlers->flag[i], held = !r->relaxes || (r->held && r->held[i]);
    r->view_flags[i] = (unsigned char)((rattler ? RATTLER : 0) | (held ? HELD : 0) |
                                       (i >= p->n ? REPLICA : 0) | (r->frame && r->frame->on[i] ? FRAME : 0));
  }
  *view = (gh_rve_view){.n = r->n,
                        .ncontacts = r->list.count,
                        .x = r->x,
                        .radius = r->radius,
                        .grain = r->view_grain,
                        .type = r->cluster ? r->cluster->type
                                : r->frame ? r->frame->type
                                           : p->type,
                        .id = r->view_id,
                        .flags = r->view_flags,
                        .contacts = r->list.contacts,
                        .friction = r->list.friction,
                        .theta = r->theta,
                        .support = r->frame ? frame_support(r) : NULL,
                        .periodic = r->periodic && !gh_frame_is_open(r->frame)};
  gh_mul2(r->F, p->cell, view->cell);
  gh_apply2(r->F, p->low, view->low);
  return GH_OK;
}
