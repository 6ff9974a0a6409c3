/* Discontinuities of packings: remembering the far side, going there, and explaining a failure (method 6).
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * A packing rearranges: seen from its converged state, P(F) has jumps. Where the stress that is wanted lies
 * in the gap, every step of Newton's iteration, however short, lands beyond the jump with a larger residual.
 * These trials are offered here, and the one with the smallest residual is where the increment goes on once
 * cutting has not helped. */
#include "macro/internal.h"

#include <string.h>

void gh_jump_forget(gh_jump *jump) {
  jump->residual = INFINITY;
  jump->point = -1;
  jump->change = 0;
}

/* The point whose stress departs most from the prediction P + A : dF between m->now and m->next. */
static void find_change(gh_macro *m) {
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
    if (change <= m->jump.change) continue;
    m->jump.point = p;
    m->jump.change = change;
  }
}

void gh_jump_offer(gh_macro *m, double residual) {
  if (!(residual < m->jump.residual)) return;
  gh_jump_forget(&m->jump);
  m->jump.residual = residual;
  memcpy(m->jump.u, m->next.u, (size_t)m->ndof * sizeof *m->jump.u);
  find_change(m);
}

gh_status gh_jump_take(gh_macro *m) {
  if (!isfinite(m->jump.residual)) return GH_DIVERGED;
  memcpy(m->now.u, m->jump.u, (size_t)m->ndof * sizeof *m->now.u);
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
static double softest(const gh_macro *m, int *point) {
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
static int worst(const gh_macro *m, const gh_attempt *a) {
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

gh_status gh_jump_explain(gh_macro *m, const gh_attempt *a, const gh_macro_report *r) {
  char node[128] = "", where[96], change[128] = "", unjammed[256], loose[264] = "";
  int dof = worst(m, a), point = 0;
  if (dof >= m->ndof)
    snprintf(node, sizeof node, ", largest at the footing on %.64s",
             m->footing[(dof - m->ndof) / 3].set->name);
  else if (dof >= 0) snprintf(node, sizeof node, ", largest at %s", gh_dof_name(m->mesh, dof, where));
  if (m->jump.point >= 0)
    snprintf(change, sizeof change, "; the stress changes most abruptly at integration point %d (by %.3g)",
             m->jump.point, m->jump.change);
  gh_name_unjammed(m, unjammed, sizeof unjammed);
  if (*unjammed && !strstr(gh_message(m->ctx), unjammed)) /* the reason may have said it */
    snprintf(loose, sizeof loose, "; %s", unjammed);
  double acoustic = softest(m, &point);
  return gh_fail(m->ctx, GH_DIVERGED,
                 "no equilibrium after %d cuts and %d passed jumps: %s; residual %.3g%s%s; "
                 "smallest acoustic eigenvalue %.3g at integration point %d%s",
                 r->cuts, r->jumps, gh_message(m->ctx), a->residual, node, change, acoustic, point, loose);
}
