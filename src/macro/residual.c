/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Residual forces: internal less external ones, their norm and when it counts as zero. */
#include "macro/internal.h"

#include <float.h>

void gh_external_forces(const gh_macro *m, const gh_loads *to, double t, bool fade, const double *u,
                        double *f) {
  for (int d = 0; d < m->ndof; d++)
    f[d] = m->f0[d] + (1 - t) * (m->force[d] + (fade ? m->fade[d] : 0)) + t * to->force[d];
  const gh_edge_loads *lists[2] = {&m->follow, &to->follow};
  const double share[2] = {1 - t, t};
  for (int l = 0; l < 2; l++)
    for (int k = 0; k < lists[l]->n; k++) {
      const gh_edge_load *edge = lists[l]->edge + k;
      double x[2][2], force[2];
      int node[2] = {edge->a, edge->b};
      for (int c = 0; c < 2; c++)
        for (int i = 0; i < 2; i++) x[c][i] = m->mesh->X[2 * node[c] + i] + u[2 * node[c] + i];
      gh_edge_force(x[0], x[1], share[l] * edge->pressure, force);
      for (int c = 0; c < 2; c++)
        for (int i = 0; i < 2; i++) f[2 * node[c] + i] += force[i];
    }
}

/* R = f_int - f_ext at state s, plus K times the prescribed part of du for a prediction. */
void gh_residual_find(gh_macro *m, const gh_attempt *a, const gh_state *s, const double *predict, double *R) {
  gh_external_forces(m, a->to, a->t, !a->released, s->u, m->fext);
  for (int d = 0; d < m->ndof; d++) R[d] = s->fint[d] - m->fext[d];
  if (predict) gh_system_multiply(m->system, predict, R);
  m->footing_force = gh_footings_residual(m, a->to, a->t, !a->released, s->u, R);
}

/* Which residual force is not finite, and the likely cause. */
gh_status gh_residual_refuse(const gh_macro *m, const double *R) {
  int d = 0;
  char name[GH_DOF_NAME] = "a footing";
  while (d < gh_residual_size(m) && isfinite(R[d])) d++;
  if (d < m->ndof) gh_mesh_dof_name(m->mesh, d, name);
  if (d == gh_residual_size(m))
    return gh_fail(m->ctx, GH_DIVERGED,
                   "the norm of the residual forces is not finite: the loads are too large");
  return gh_fail(
      m->ctx, GH_DIVERGED,
      "the residual force at %s is %g, not a finite number: the loads or the stresses are too large", name,
      R[d]);
}

/* |R_free| and |f_ext| + |R_prescribed|, footings' forces among f_ext. GH_DIVERGED: one is not finite. */
gh_status gh_residual_measure(const gh_macro *m, const gh_attempt *a, const double *R, double *residual,
                              double *scale) {
  gh_squares norm = {0}, held = {0}, external = {0};
  gh_squares_add(&external, m->footing_force);
  for (int d = 0; d < gh_residual_size(m); d++) {
    if (gh_residual_is_free(m, a, d)) gh_squares_add(&norm, R[d]);
    else if (a->to->fixed[d]) gh_squares_add(&held, R[d]);
    if (d < m->ndof) gh_squares_add(&external, m->fext[d]);
  }
  *residual = gh_squares_root(&norm);
  *scale = gh_squares_root(&external) + gh_squares_root(&held);
  return isfinite(*residual) && isfinite(*scale) ? GH_OK : gh_residual_refuse(m, R);
}

/* The residual that counts as zero. Round-off of F is DBL_EPSILON, which the tangent turns into forces:
 * without this floor a body that is unloaded to no force at all would never converge. The stiffness is that
 * of the last assembly. */
double gh_residual_limit(const gh_macro *m, double scale) {
  return fmax(m->options.tolerance * scale, DBL_EPSILON * m->length * gh_system_diagonal(m->system));
}

bool gh_residual_converged(const gh_macro *m, const gh_attempt *a) {
  return gh_within(a->residual, gh_residual_limit(m, a->scale));
}

double gh_residual_along(const gh_macro *m, const gh_attempt *a, const double *R) {
  double sum = 0;
  for (int d = 0; d < gh_residual_size(m); d++)
    if (gh_residual_is_free(m, a, d)) sum += m->du[d] * R[d];
  return sum;
}

double gh_relative_residual(const gh_attempt *a) {
  if (a->residual == 0) return 0;
  return a->scale > 0 ? a->residual / a->scale : 1; /* nothing acts but the residual itself */
}
