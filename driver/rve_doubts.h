/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Warnings of equilibria within a looser tolerance than the one required. */
#ifndef GRANHOM_RVE_DOUBTS_H
#define GRANHOM_RVE_DOUBTS_H

#include "granhom/micro.h"

/* Of the substeps of one increment; zero at the start. */
typedef struct rve_doubts {
  double residual; /* the largest */
  double accepted; /* the largest of those accepted unconverged; 0: none were */
} rve_doubts;

/* A substep in equilibrium, before it is committed. */
void rve_doubts_add(rve_doubts *d, const gh_rve_measures *m);
/* At most one warning, "step N: ...", and zero again. */
void rve_doubts_tell(gh_context *ctx, rve_doubts *d, long step);

#endif
