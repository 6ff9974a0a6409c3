/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a path of one material point knows of its error. */
#ifndef GRANHOM_RVE_ERROR_H
#define GRANHOM_RVE_ERROR_H

#include "granhom/micro.h"

/* Zero at the start. */
typedef struct rve_error {
  gh_rve_balance balance;
  int compared, branched;
  double before[4], apart[4]; /* P, and its difference to the other path, at the last row */
  double kept, now, most, scale;
} rve_error;

/* P of a row when it was reached in halves, and in one from a path of its own in whole rows (NULL: it was not
 * reached). True: the two are different paths, and have to continue as one. */
bool rve_error_compare(rve_error *e, const double P[4], const double whole[4], const gh_rve_options *o);
void rve_error_tell(gh_context *ctx, const rve_error *e);

#endif
