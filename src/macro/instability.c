/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Instabilities of packings: the state after a stress discontinuity, and the explanation of a failure (method
 * 6).
 *
 * A packing rearranges: seen from its converged state, P(F) has discontinuities. Where the required stress
 * lies in the gap, every step of Newton's iteration, however short, lands beyond the discontinuity with a
 * larger residual. These trials are offered here, and the increment continues at the one with the smallest
 * residual once bisection has not helped. */
#include "macro/internal.h"

#include <string.h>

void gh_instability_forget(gh_instability *instability) {
  instability->residual = INFINITY;
  instability->point = -1;
  instability->change = 0;
}

/* The point whose stress departs most from the prediction P + A : dF between m->now and m->next. */
static void instability_find_point(const gh_macro *m, gh_instability *best) {
  for (int p = 0; p < m->npoints; p++) {
    const double *F = m->now.F + 4 * (size_t)p, *G = m->next.F + 4 * (size_t)p,
                 *A = m->now.A + 16 * (size_t)p;
    const double *P = m->now.P + 4 * (size_t)p, *Q = m->next.P + 4 * (size_t)p;
    double d[4];
    for (int i = 0; i < 4; i++) {
      d[i] = Q[i] - P[i];
      for (int k = 0; k < 4; k++) d[i] -= A[4 * i + k] * (G[k] - F[k]);
    }
    const double change = gh_norm(d, 4);
    if (change <= best->change) continue;
    best->point = p;
    best->change = change;
  }
}

void gh_instability_offer(gh_macro *m, gh_instability *best, double residual) {
  if (!(residual < best->residual)) return;
  gh_instability_forget(best);
  best->residual = residual;
  memcpy(best->u, m->next.u, (size_t)m->ndof * sizeof *best->u);
  instability_find_point(m, best);
}

void gh_instability_from_swing(gh_macro *m) {
  if (isfinite(m->instability.residual)) return;
  const gh_instability swap = m->instability;
  m->instability = m->swing;
  m->swing = swap;
}

gh_status gh_instability_evaluate(gh_macro *m) {
  if (!isfinite(m->instability.residual)) return GH_DIVERGED;
  memcpy(m->now.u, m->instability.u, (size_t)m->ndof * sizeof *m->now.u);
  gh_status status = gh_macro_evaluate(m, &m->now);
  return status == GH_INPUT ? GH_DIVERGED : status;
}

void gh_name_unjammed(const gh_macro *m, char *text, size_t size) {
  int count = 0;
  char list[160] = "";
  size_t used = 0;
  for (int p = 0; p < m->npoints; p++) {
    const gh_rve_measures *measure = gh_farm_measure(m->farm, p);
    if (!measure || !measure->unjammed) continue;
    if (used < sizeof list - 24)
      used += (size_t)snprintf(list + used, sizeof list - used, "%s%d", count ? ", " : "", p);
    else if (list[used - 1] != '.') used += (size_t)snprintf(list + used, sizeof list - used, ", ...");
    count++;
  }
  *text = '\0';
  if (count)
    snprintf(text, size, "%d of %d integration points are unjammed (no contact forces): %s", count,
             m->npoints, list);
}

/* The smallest eigenvalue of the acoustic tensors at the last equilibrium, and its point. */
static double material_find_softest(const gh_macro *m, int *point) {
  double smallest = INFINITY, angle;
  for (int p = 0; p < m->npoints; p++) {
    double value = gh_acoustic(m->eq.A + 16 * (size_t)p, &angle);
    if (!(value < smallest)) continue;
    smallest = value;
    *point = p;
  }
  return smallest;
}

/* The entry of the residual with the largest value: a degree of freedom, or behind those an unknown of a
 * footing. */
static int residual_find_largest(const gh_macro *m, const gh_attempt *a) {
  int dof = -1;
  double largest = -1;
  for (int d = 0; d < m->ndof + 3 * m->nfootings; d++) {
    bool out = d < m->ndof && (a->to->fixed[d] || m->owner[d / 2] >= 0);
    if (out || fabs(m->residual[d]) <= largest) continue;
    largest = fabs(m->residual[d]);
    dof = d;
    if (!isfinite(largest)) break;
  }
  return dof;
}

gh_status gh_instability_explain(gh_macro *m, const gh_attempt *a, const gh_macro_report *r) {
  char node[128] = "", where[GH_DOF_NAME], change[128] = "", unjammed[256], floating[264] = "";
  int dof = residual_find_largest(m, a), point = 0;
  if (dof >= m->ndof)
    snprintf(node, sizeof node, ", largest at the footing on %.64s",
             m->footing[(dof - m->ndof) / 3].set->name);
  else if (dof >= 0) snprintf(node, sizeof node, ", largest at %s", gh_mesh_dof_name(m->mesh, dof, where));
  if (m->instability.point >= 0)
    snprintf(change, sizeof change, "; the stress changes most abruptly at integration point %d (by %.3g)",
             m->instability.point, m->instability.change);
  gh_name_unjammed(m, unjammed, sizeof unjammed);
  if (*unjammed && !strstr(gh_message(m->ctx), unjammed)) /* the reason may have said it */
    snprintf(floating, sizeof floating, "; %s", unjammed);
  char softest[96] = "";
  if (m->options.method != GH_METHOD_RELAXATION) {
    const double acoustic = material_find_softest(m, &point);
    snprintf(softest, sizeof softest, "; smallest acoustic eigenvalue %.3g at integration point %d", acoustic,
             point);
  }
  return gh_fail(m->ctx, GH_DIVERGED,
                 "no equilibrium after %d bisections and %d instabilities stepped over: %s; residual "
                 "%.3g%s%s%s%s",
                 r->cuts, r->jumps, gh_message(m->ctx), a->residual, node, change, softest, floating);
}
