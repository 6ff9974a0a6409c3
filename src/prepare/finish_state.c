/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A packing on its way: trial and converged state. */
#include "prepare/finish.h"

#include <stdlib.h>
#include <string.h>

bool finish_relaxes(const gh_finish_options *o) {
  if (o->cell != GH_FINISH_CELL_AUTO) return o->cell == GH_FINISH_CELL_RELAXED;
  return o->goal == GH_FINISH_PRESSURE && isnan(o->anisotropy);
}

double finish_value(const finish_job *j, const gh_finish_report *r) {
  return j->options->goal == GH_FINISH_OVERLAP ? r->overlap : r->pressure;
}

gh_status finish_try(finish_job *j, const double F[4], bool tangent, bool *found) {
  gh_status status = gh_rve_evaluate(j->rve, F, tangent ? GH_WANT_TANGENT : 0, j->trial_P, j->trial_A);
  j->evaluations++;
  *found = status == GH_OK;
  if (status == GH_DIVERGED) return gh_rve_revert(j->rve);
  GH_TRY(status);
  memcpy(j->trial_F, F, sizeof j->trial_F);
  j->trial_energy = gh_rve_measure(j->rve)->energy;
  return finish_report_fill(j->rve, j->mean_radius, &j->trial);
}

gh_status finish_take(finish_job *j) {
  memcpy(j->F, j->trial_F, sizeof j->F);
  memcpy(j->P, j->trial_P, sizeof j->P);
  memcpy(j->A, j->trial_A, sizeof j->A);
  j->energy = j->trial_energy;
  j->now = j->trial;
  return gh_rve_commit(j->rve);
}
