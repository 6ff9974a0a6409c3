/* What is told of equilibria that are not quite what was asked for. SPDX-License-Identifier: GPL-2.0-or-later
 */
#ifndef GRANHOM_RVE_DOUBTS_H
#define GRANHOM_RVE_DOUBTS_H

#include "granhom/micro.h"

/* Of the parts of one increment; zero to begin with. */
typedef struct rve_doubts {
  int kept;        /* times that slip was kept */
  double residual; /* the largest of parts taken as they are, above the tolerance; 0: none were */
} rve_doubts;

/* A part in equilibrium, before it is committed. */
void rve_doubts_add(rve_doubts *d, const gh_rve_measures *m);
/* At most two warnings, "step N: ...", and zero again. */
void rve_doubts_tell(gh_context *ctx, rve_doubts *d, long step);

#endif
