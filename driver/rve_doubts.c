/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Warnings of granhom rve and granhom element: docs/explanation/method.md, "Limit cycles". */
#include "rve_doubts.h"

void rve_doubts_add(rve_doubts *d, const gh_rve_measures *m) {
  d->kept += m->kept;
  if (m->accepted) d->residual = gh_max(d->residual, m->residual);
}

void rve_doubts_tell(gh_context *ctx, rve_doubts *d, long step) {
  if (d->kept)
    gh_log(ctx, GH_LEVEL_WARNING, "step %ld: limit cycle of the relaxation; %d intermediate history commit%s",
           step, d->kept, d->kept == 1 ? "" : "s");
  if (d->residual > 0)
    gh_log(ctx, GH_LEVEL_WARNING, "step %ld: accepted unconverged, with a residual of %.2g", step,
           d->residual);
  *d = (rve_doubts){0};
}
