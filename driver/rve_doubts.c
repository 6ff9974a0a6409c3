/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Warnings of granhom rve and granhom element: states accepted unconverged. */
#include "rve_doubts.h"

void rve_doubts_add(rve_doubts *d, const gh_rve_measures *m) {
  d->residual = gh_max(d->residual, m->residual);
  if (m->accepted) d->accepted = gh_max(d->accepted, m->residual);
}

void rve_doubts_tell(gh_context *ctx, rve_doubts *d, long step) {
  if (d->accepted > 0)
    gh_log(ctx, GH_LEVEL_WARNING, "step %ld: accepted unconverged, with a residual of %.2g", step,
           d->accepted);
  *d = (rve_doubts){0};
}
