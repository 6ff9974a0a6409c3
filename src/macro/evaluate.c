/* SPDX-License-Identifier: GPL-2.0-or-later */
/* From displacements to stresses, tangents and internal forces, through the farm of material points. */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

gh_status gh_state_create(const gh_macro *m, gh_state *s) {
  size_t n = (size_t)m->npoints;
  GH_TRY(gh_alloc(m->ctx, (size_t)m->ndof, sizeof *s->u, &s->u));
  GH_TRY(gh_alloc(m->ctx, 4 * n, sizeof *s->F, &s->F));
  GH_TRY(gh_alloc(m->ctx, 4 * n, sizeof *s->P, &s->P));
  GH_TRY(gh_alloc(m->ctx, 16 * n, sizeof *s->A, &s->A));
  GH_TRY(gh_alloc(m->ctx, (size_t)m->ndof, sizeof *s->fint, &s->fint));
  for (size_t p = 0; p < n; p++) s->F[4 * p] = s->F[4 * p + 3] = 1;
  return GH_OK;
}

void gh_state_destroy(gh_state *s) {
  free(s->u);
  free(s->F);
  free(s->P);
  free(s->A);
  free(s->fint);
}

void gh_state_copy(const gh_macro *m, const gh_state *from, gh_state *to) {
  size_t n = (size_t)m->npoints, d = (size_t)m->ndof;
  memcpy(to->u, from->u, d * sizeof *to->u);
  memcpy(to->F, from->F, 4 * n * sizeof *to->F);
  memcpy(to->P, from->P, 4 * n * sizeof *to->P);
  memcpy(to->A, from->A, 16 * n * sizeof *to->A);
  memcpy(to->fint, from->fint, d * sizeof *to->fint);
}

void gh_state_swap(gh_state *a, gh_state *b) {
  gh_state c = *a;
  *a = *b;
  *b = c;
}

/* An element whose corner is inverted overlaps itself, even where det F > 0 at its four points: a
 * body of grains that has lost its contacts would be flung there without resistance. */
static gh_status state_check_corners(gh_macro *m, const gh_state *s) {
  for (int e = 0; e < m->mesh->nelements; e++) {
    double x[4][2];
    for (int a = 0; a < 4; a++)
      for (int i = 0; i < 2; i++) {
        int d = 2 * m->mesh->quad[e][a] + i;
        x[a][i] = m->mesh->X[d] + s->u[d];
      }
    if (!gh_quad_convex((const double(*)[2])x))
      return gh_fail(m->ctx, GH_DIVERGED, "a corner of element %d is turned inside out", e);
  }
  return GH_OK;
}

/* F of all points; a displacement that is not finite or turns an element inside out is caught here. */
static gh_status state_deform(gh_macro *m, gh_state *s) {
  for (int d = 0; d < m->ndof; d++) {
    char name[GH_DOF_NAME];
    if (!isfinite(s->u[d]))
      return gh_fail(m->ctx, GH_DIVERGED, "the displacement of %s is %g", gh_mesh_dof_name(m->mesh, d, name),
                     s->u[d]);
  }
  for (int e = 0; e < m->mesh->nelements; e++)
    gh_element_deformation(&m->shapes, m->mesh, e, s->u, s->F + 16 * e);
  for (int p = 0; p < m->npoints; p++) {
    double J = gh_det2(s->F + 4 * (size_t)p);
    if (!(J > 0) || !isfinite(J))
      return gh_fail(m->ctx, GH_DIVERGED,
                     "integration point %d of element %d is turned inside out (det F = %g)", p, p / 4, J);
  }
  return state_check_corners(m, s);
}

static gh_status state_check_material(gh_macro *m, const gh_state *s) {
  for (int p = 0; p < m->npoints; p++) {
    const char *what = !gh_finite(s->P + 4 * (size_t)p, 4)     ? "stress"
                       : !gh_finite(s->A + 16 * (size_t)p, 16) ? "tangent"
                                                               : NULL;
    if (what) return gh_fail(m->ctx, GH_DIVERGED, "the %s of integration point %d is not finite", what, p);
  }
  return GH_OK;
}

static gh_status state_evaluate(gh_macro *m, gh_state *s, unsigned want) {
  GH_TRY(state_deform(m, s));
  double start = gh_seconds();
  gh_status status = gh_farm_evaluate(m->farm, s->F, want, s->P, s->A);
  m->micro_seconds += gh_seconds() - start;
  GH_TRY(status);
  GH_TRY(state_check_material(m, s));
  memset(s->fint, 0, (size_t)m->ndof * sizeof *s->fint);
  for (int e = 0; e < m->mesh->nelements; e++) {
    double f[8];
    gh_element_force(&m->shapes, e, s->P + 16 * e, f);
    for (int k = 0; k < 8; k++) s->fint[2 * m->mesh->quad[e][k / 2] + k % 2] += f[k];
  }
  return GH_OK;
}

gh_status gh_macro_evaluate(gh_macro *m, gh_state *s) {
  return state_evaluate(m, s, GH_WANT_TANGENT);
}

/* Points of other kinds than RVEs may write a tangent that was not required. */
gh_status gh_macro_evaluate_stress(gh_macro *m, gh_state *s, const gh_state *tangents) {
  const size_t bytes = 16 * (size_t)m->npoints * sizeof *s->A;
  memcpy(s->A, tangents->A, bytes);
  gh_status status = state_evaluate(m, s, 0);
  memcpy(s->A, tangents->A, bytes);
  return status;
}

gh_status gh_macro_start(gh_macro *m) {
  if (m->started) return GH_OK;
  const bool stress = m->options.method == GH_METHOD_RELAXATION; /* tangents that are zero from the start */
  gh_status status = stress ? gh_macro_evaluate_stress(m, &m->eq, &m->now) : gh_macro_evaluate(m, &m->eq);
  if (status != GH_OK) return gh_prefix(m->ctx, status, "stress at the start (u = 0): ");
  if (m->elastic) memcpy(m->elastic, m->eq.A, 16 * (size_t)m->npoints * sizeof *m->elastic);
  m->started = true;
  gh_energy_begin(m);
  return GH_OK;
}

gh_status gh_macro_balance(gh_macro *m) {
  if (m->solved)
    return gh_fail(m->ctx, GH_INPUT, "the initial stress is balanced before the first increment, not after");
  GH_TRY(gh_macro_start(m));
  memcpy(m->f0, m->eq.fint, (size_t)m->ndof * sizeof *m->f0);
  return GH_OK;
}
