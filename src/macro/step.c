/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the steps of Newton's iteration and of relaxation share. */
#include "macro/internal.h"

bool gh_prescribe(gh_macro *m, const gh_attempt *a) {
  bool any = false;
  for (int d = 0; d < gh_residual_size(m); d++) {
    m->du[d] = 0;
    if (gh_residual_is_free(m, a, d) || !a->to->fixed[d]) continue;
    double target = a->t < 1 ? m->from[d] + a->t * (a->to->value[d] - m->from[d]) : a->to->value[d];
    m->du[d] = target - m->now.u[d];
    any = any || m->du[d] != 0;
  }
  return any;
}

void gh_step_move(gh_macro *m, double s) {
  for (int d = 0; d < m->ndof; d++) m->next.u[d] = m->now.u[d] + s * m->du[d];
  for (int k = 0; k < m->nfootings; k++) {
    const double *q = m->du + m->ndof + 3 * k;
    gh_footing_move(m->mesh, m->footing + k, (const double[3]){s * q[0], s * q[1], s * q[2]}, m->now.u,
                    m->next.u);
  }
}

void gh_step_accept(gh_macro *m, gh_attempt *a, double residual, double scale) {
  gh_state_swap(&m->now, &m->next);
  gh_farm_keep(m->farm);
  double *swap = m->residual;
  m->residual = m->trial;
  m->trial = swap;
  a->residual = residual;
  a->scale = scale;
}

void gh_iteration_report(const gh_macro *m, const gh_attempt *a, int iteration, double first, double step) {
  if (!m->watch) return;
  gh_macro_iteration it = {.substep = a->substep,
                           .iteration = iteration,
                           .residual = a->residual,
                           .scale = a->scale,
                           .relative = gh_relative_residual(a),
                           .first = first > 0 ? a->residual / first : 0,
                           .step = step,
                           .kinetic = a->kinetic,
                           .seconds = gh_seconds() - m->begin};
  m->watch(m->watch_data, &it);
}
