/* Algorithmic tangent of an increment with friction (methods 5, 8.12): state n is frozen.
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * With the generalised strain (l, q) of a contact, its generalised force (f, M) and D = d(f, M)/d(l, q):
 * l = F m, and unknowns v change (l, q) by B v. Equilibrium gives K v = -R : dF with K = sum B^T D B and
 * R_kL = sum B^T D e_k m_L; the stress V P_iJ = sum f_i m_J changes by
 * sum D_ik m_J m_L dF_kL + sum m_J e_i^T D B v (the forces on the unknowns balance, so that a change of m_J
 * adds nothing). D is not symmetric, hence left and right parts differ. */
#include "micro/internal.h"

#include <string.h>

/* v = sign * D column for positions, r * D row of M for rotations. */
static void add_right(const gh_rve *r, const gh_contact *q, const double d[9], const double m[2]) {
  const gh_coupled *s = r->coupled;
  for (int e = 0; e < 2; e++) {
    int grain = e ? q->j : q->i;
    const double scale[3] = {gh_end_sign(e), gh_end_sign(e), r->radius[grain]};
    for (int h = 0; h < 3; h++) {
      int u = s->unknown[3 * grain + h];
      if (u < 0) continue;
      for (int kL = 0; kL < 4; kL++) s->rhs[s->n * kL + u] += scale[h] * d[3 * h + kL / 2] * m[kL % 2];
    }
  }
}

/* Change of the generalised strain of a contact by the solution for one component of F. */
static void strain(const gh_rve *r, const gh_contact *q, const double *v, double change[3]) {
  const int *unknown = r->coupled->unknown;
  change[0] = change[1] = change[2] = 0;
  for (int e = 0; e < 2; e++) {
    int grain = e ? q->j : q->i;
    const int *u = &unknown[3 * grain];
    for (int h = 0; h < 2; h++) change[h] += u[h] >= 0 ? gh_end_sign(e) * v[u[h]] : 0;
    change[2] += u[2] >= 0 ? r->radius[grain] * v[u[2]] : 0;
  }
}

static void add_stress(const gh_rve *r, const double *X, double A[16]) {
  double inverse[4];
  gh_inv2(r->F, inverse);
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = &r->list.contacts[c];
    const double *d = r->list.friction[c].d;
    double m[2];
    gh_apply2(inverse, q->l, m);
    for (int kL = 0; kL < 4; kL++) {
      double change[3] = {0};
      if (X) strain(r, q, X + r->coupled->n * kL, change);
      for (int i = 0; i < 2; i++) {
        double df = d[3 * i + kL / 2] * m[kL % 2];
        for (int h = 0; h < 3; h++) df -= d[3 * i + h] * change[h];
        for (int J = 0; J < 2; J++) A[4 * (2 * i + J) + kL] += df * m[J] / r->volume;
      }
    }
  }
}

gh_status gh_rve_tangent_friction(gh_rve *r, double A[16]) {
  memset(A, 0, 16 * sizeof *A);
  if (r->m.unjammed) return r->m.acoustic = r->m.acoustic_angle = 0, GH_OK;
  double start = gh_seconds(), inverse[4];
  const double *X = NULL;
  if (gh_rve_solves(r)) {
    bool regular;
    GH_TRY(gh_rve_factorise_coupled(r, true, &regular));
    r->m.regularised = r->shift > 0;
    if (!regular) return gh_fail(r->ctx, GH_DIVERGED, "the stiffness of the packing is singular");
    memset(r->coupled->rhs, 0, 4 * (size_t)r->coupled->n * sizeof(double));
    gh_inv2(r->F, inverse);
    for (int c = 0; c < r->list.count; c++) {
      double m[2];
      gh_apply2(inverse, r->list.contacts[c].l, m);
      add_right(r, &r->list.contacts[c], r->list.friction[c].d, m);
    }
    GH_TRY(gh_coupled_solve(r->ctx, r->coupled, 4, &X));
  }
  add_stress(r, X, A);
  r->cost.factorise += gh_seconds() - start;
  if (!gh_finite(A, 16)) return gh_fail(r->ctx, GH_DIVERGED, "the tangent is not finite");
  r->m.acoustic = gh_acoustic(A, &r->m.acoustic_angle);
  return GH_OK;
}
