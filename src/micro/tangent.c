/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tangents of an RVE in equilibrium by static condensation (methods 4, 5). */
#include "micro/internal.h"

#include <string.h>

/* No stiffness at all. */
static gh_status tangent_of_unjammed(gh_rve *r) {
  r->m.acoustic = r->m.acoustic_angle = 0;
  return GH_OK;
}

/* A at fixed fluctuations (6.3), and the mixed derivatives G of the energy with respect to the unknown
 * positions and F, one column per component of F (6.18). */
static void tangent_add_direct(gh_rve *r, double A[16]) {
  const gh_solver *s = r->solver;
  size_t rows = r->relaxes ? (size_t)s->n : 0;
  double inverse[4];
  gh_inv2(r->F, inverse);
  memset(A, 0, 16 * sizeof *A);
  if (rows > 0) memset(s->rhs, 0, 4 * rows * sizeof *s->rhs); /* there is none without unknown grains */
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = &r->list.contacts[c];
    if (r->relaxes && (r->rattlers->flag[q->i] || r->rattlers->flag[q->j])) continue;
    double m[2], h[4] = {q->h[0], q->h[1], q->h[1], q->h[2]};
    gh_apply2(inverse, q->l, m);
    for (int n = 0; n < 16; n++) A[n] += h[2 * (n >> 3) + (n >> 1 & 1)] * m[n >> 2 & 1] * m[n & 1];
    if (!r->relaxes || q->i == q->j) continue;
    for (int e = 0; e < 2; e++) {
      int u = s->unknown[3 * (e ? q->j : q->i)];
      if (u < 0) continue;
      double sign = e ? 1 : -1;
      for (int i = 0; i < 2; i++)
        for (int kL = 0; kL < 4; kL++)
          s->rhs[rows * (size_t)kL + (size_t)(u + i)] += sign * h[2 * i + kL / 2] * m[kL % 2];
    }
  }
}

/* Factor of the stiffness at the equilibrium; shifted when it is not positive definite (a mode without
 * stiffness). */
static gh_status tangent_factor(gh_rve *r) {
  bool definite;
  double shift = 0;
  const gh_solver_input in = gh_rve_solver_input(r);
  GH_TRY(gh_solver_number(r->ctx, r->solver, &in));
  for (;;) {
    GH_TRY(gh_solver_factor(r->ctx, r->solver, &in, shift, &definite));
    r->m.factorisations++;
    if (definite) return GH_OK;
    if (shift > r->options.law.normal_stiffness)
      return gh_fail(r->ctx, GH_DIVERGED,
                     "the stiffness of the packing is singular, even with a shift of %.3g", shift);
    r->m.regularised = 1;
    shift = shift > 0 ? 10 * shift : 1e-9 * r->options.law.normal_stiffness;
  }
}

gh_status gh_rve_tangent(gh_rve *r, double A[16]) {
  memset(A, 0, 16 * sizeof *A);
  if (r->m.unjammed) return tangent_of_unjammed(r);
  double start = gh_seconds();
  if (r->relaxes) GH_TRY(tangent_factor(r));
  tangent_add_direct(r, A);
  if (r->relaxes && r->solver->n > 0) { /* A - G^T K^-1 G */
    const gh_solver *s = r->solver;
    const double *X;
    GH_TRY(gh_solver_solve(r->ctx, r->solver, 4, &X));
    size_t rows = (size_t)s->n;
    for (size_t iJ = 0; iJ < 4; iJ++)
      for (size_t kL = 0; kL < 4; kL++) {
        double sum = 0;
        for (size_t p = 0; p < rows; p++) sum += s->rhs[rows * iJ + p] * X[rows * kL + p];
        A[4 * iJ + kL] -= sum;
      }
  }
  for (int n = 0; n < 16; n++) A[n] /= r->volume;
  r->cost.factorise += gh_seconds() - start;
  if (!gh_finite(A, 16)) return gh_fail(r->ctx, GH_DIVERGED, "the tangent is not finite");
  r->m.acoustic = gh_acoustic(A, &r->m.acoustic_angle);
  return GH_OK;
}

/* ---- with friction: algorithmic tangent of an increment (methods 5, 8.12), state n is frozen ----
 *
 * With the generalised strain (l, q) of a contact, its generalised force (f, M) and D = d(f, M)/d(l, q):
 * l = F m, and unknowns v change (l, q) by B v. Equilibrium gives K v = -R : dF with K = sum B^T D B and
 * R_kL = sum B^T D e_k m_L; the stress V P_iJ = sum f_i m_J changes by
 * sum D_ik m_J m_L dF_kL + sum m_J e_i^T D B v (the forces on the unknowns balance, so that a change of m_J
 * adds nothing). D is not symmetric, hence left and right parts differ. */

/* v = sign * D column for positions, r * D row of M for rotations. */
static void friction_add_right(const gh_rve *r, const gh_contact *q, const double d[9], const double m[2]) {
  const gh_solver *s = r->solver;
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
static void friction_strain(const gh_rve *r, const gh_contact *q, const double *v, double change[3]) {
  const int *unknown = r->solver->unknown;
  change[0] = change[1] = change[2] = 0;
  for (int e = 0; e < 2; e++) {
    int grain = e ? q->j : q->i;
    const int *u = &unknown[3 * grain];
    for (int h = 0; h < 2; h++) change[h] += u[h] >= 0 ? gh_end_sign(e) * v[u[h]] : 0;
    change[2] += u[2] >= 0 ? r->radius[grain] * v[u[2]] : 0;
  }
}

static void friction_add_stress(const gh_rve *r, const double *X, double A[16]) {
  double inverse[4];
  gh_inv2(r->F, inverse);
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = &r->list.contacts[c];
    const double *d = r->list.friction[c].d;
    double m[2];
    gh_apply2(inverse, q->l, m);
    for (int kL = 0; kL < 4; kL++) {
      double change[3] = {0};
      if (X) friction_strain(r, q, X + r->solver->n * kL, change);
      for (int i = 0; i < 2; i++) {
        double df = d[3 * i + kL / 2] * m[kL % 2];
        for (int h = 0; h < 3; h++) df -= d[3 * i + h] * change[h];
        for (int J = 0; J < 2; J++) A[4 * (2 * i + J) + kL] += df * m[J] / r->volume;
      }
    }
  }
}

/* ---- rotations that follow F (displacement of a frame) ----
 *
 * They change q by g theta'(F), where g is the sum of the radii of such ends, and their couples work on theta'. */

/* The sum of the radii of the ends whose rotation follows F. */
static double contact_turned_radius(const gh_rve *r, const gh_contact *q) {
  return (gh_frame_turns_with_F(r->frame, q->i) ? r->radius[q->i] : 0) +
         (gh_frame_turns_with_F(r->frame, q->j) ? r->radius[q->j] : 0);
}

static void turned_add_right(const gh_rve *r, const double slope[4]) {
  const gh_solver *s = r->solver;
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = &r->list.contacts[c];
    const double *d = r->list.friction[c].d, g = contact_turned_radius(r, q);
    for (int e = 0; e < 2 && g > 0; e++) {
      const int grain = e ? q->j : q->i;
      const double scale[3] = {gh_end_sign(e), gh_end_sign(e), r->radius[grain]};
      for (int h = 0; h < 3; h++) {
        const int u = s->unknown[3 * grain + h];
        for (int kL = 0; kL < 4 && u >= 0; kL++)
          s->rhs[s->n * kL + u] += scale[h] * d[3 * h + 2] * g * slope[kL];
      }
    }
  }
}

static void turned_add_stress(const gh_rve *r, const double *X, double A[16]) {
  double inverse[4], slope[4], curvature[16];
  const double couple = gh_frame_couple(r);
  gh_inv2(r->F, inverse);
  gh_rotation_slope(r->F, slope, curvature);
  for (int k = 0; k < 16; k++) A[k] += couple * curvature[k] / r->volume;
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = &r->list.contacts[c];
    const double *d = r->list.friction[c].d, g = contact_turned_radius(r, q);
    double m[2];
    if (!(g > 0)) continue;
    gh_apply2(inverse, q->l, m);
    for (int kL = 0; kL < 4; kL++) {
      double change[3], strain[3] = {0, 0, g * slope[kL]};
      friction_strain(r, q, X + r->solver->n * kL, change);
      strain[kL / 2] += m[kL % 2];
      double dM = 0;
      for (int h = 0; h < 3; h++) dM += d[6 + h] * (strain[h] - change[h]);
      for (int iJ = 0; iJ < 4; iJ++)
        A[4 * iJ + kL] += (d[3 * (iJ / 2) + 2] * g * slope[kL] * m[iJ % 2] + dM * g * slope[iJ]) / r->volume;
    }
  }
}

gh_status gh_rve_tangent_friction(gh_rve *r, double A[16]) {
  memset(A, 0, 16 * sizeof *A);
  if (r->m.unjammed) return tangent_of_unjammed(r);
  const bool turned = r->frame && r->frame->fixed && r->turns;
  double start = gh_seconds(), inverse[4];
  const double *X = NULL;
  if (gh_rve_solves(r)) {
    bool regular;
    GH_TRY(gh_rve_factor(r, true, &regular));
    r->m.regularised = r->shift > 0;
    if (!regular) return gh_fail(r->ctx, GH_DIVERGED, "the stiffness of the packing is singular");
    memset(r->solver->rhs, 0, 4 * (size_t)r->solver->n * sizeof(double));
    gh_inv2(r->F, inverse);
    for (int c = 0; c < r->list.count; c++) {
      double m[2];
      gh_apply2(inverse, r->list.contacts[c].l, m);
      friction_add_right(r, &r->list.contacts[c], r->list.friction[c].d, m);
    }
    if (turned) {
      double slope[4], curvature[16];
      gh_rotation_slope(r->F, slope, curvature);
      turned_add_right(r, slope);
    }
    GH_TRY(gh_solver_solve(r->ctx, r->solver, 4, &X));
  }
  friction_add_stress(r, X, A);
  if (turned) turned_add_stress(r, X, A);
  r->cost.factorise += gh_seconds() - start;
  if (!gh_finite(A, 16)) return gh_fail(r->ctx, GH_DIVERGED, "the tangent is not finite");
  r->m.acoustic = gh_acoustic(A, &r->m.acoustic_angle);
  return GH_OK;
}
