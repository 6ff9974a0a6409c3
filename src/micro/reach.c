/* SPDX-License-Identifier: GPL-2.0-or-later */
/* An increment of F in substeps, where it has no equilibrium at once. */
#include "micro/internal.h"

#include <math.h>
#include <string.h>

/* Paths that differ by more than this share of what the stress has changed by are two, not the same one more
 * and less precisely. */
static const double branch = 0.1;
/* Stresses are off by up to this many times the residual. */
static const double amplified = 1e3;
/* Multiple of the tolerance up to which the deepest bisection accepts a packing unconverged: it is reported,
 * and more steps would hardly change its stress. */
static const double nearly = 3;
/* A loose tolerance has no room for that. */
static const double tight = 1e-6;

/* A substep from the converged state to the share `end` of the path. */
static gh_status path_reach_substep(gh_rve *rve, gh_rve_way *w, double end, double A[16]) {
  double F[4], P[4];
  const bool last = end == 1;
  for (int k = 0; k < 4; k++) F[k] = last ? w->to[k] : w->from[k] + end * (w->to[k] - w->from[k]);
  GH_TRY(gh_rve_evaluate(rve, F, last ? w->want : 0, P, A));
  w->parts++;
  if (w->count) w->count(w->data, gh_rve_measure(rve));
  return last ? GH_OK : gh_rve_commit(rve);
}

gh_status gh_rve_reach(gh_rve *rve, gh_rve_way *w, double A[16]) {
  const bool moves =
      memcmp(w->from, w->to, sizeof w->from) != 0; /* else parts are no shorter than the whole */
  const int deepest = w->halvings + (moves ? GH_WAY_CUTS : 0);
  double t = 0, dt = ldexp(1, -w->halvings);
  w->parts = w->cuts = 0;
  for (int level = w->halvings; t < 1;) {
    rve->accept_within = level == deepest && rve->options.tolerance <= tight ? nearly : 0;
    gh_status status = path_reach_substep(rve, w, t + dt, A);
    rve->accept_within = 0;
    if (status == GH_DIVERGED && level < deepest) {
      GH_TRY(gh_rve_revert(rve));
      dt /= 2, level++, w->cuts++;
      continue;
    }
    if (status != GH_OK && w->parts > 0)
      gh_prefix(rve->ctx, status, "after %d substeps of the increment: ", w->parts);
    GH_TRY(status);
    t += dt;
    if (level > w->halvings && fmod(t, 2 * dt) == 0) dt *= 2, level--;
  }
  return GH_OK;
}

void gh_rve_balance_add(gh_rve_balance *b, const gh_rve_measures *m) {
  const double held = m->energy + m->dissipation;
  const bool first = b->parts++ == 0;
  if (first) b->first = held;
  for (int k = 0; k < 4 && !first; k++) b->work += 0.5 * (m->P[k] + b->P[k]) * (m->F[k] - b->F[k]);
  memcpy(b->F, m->F, sizeof b->F);
  memcpy(b->P, m->P, sizeof b->P);
  b->held = held - b->first;
  b->largest = gh_max(b->largest, gh_max(fabs(b->work), fabs(b->held)));
  b->residual = gh_max(b->residual, m->residual);
}

double gh_rve_balance_defect(const gh_rve_balance *b) {
  double PP = 0, FF = 0;
  for (int k = 0; k < 4; k++) PP += b->P[k] * b->P[k], FF += b->F[k] * b->F[k];
  return b->largest <= 1e-12 * sqrt(PP * FF) ? 0 : (b->work - b->held) / b->largest;
}

/* Without friction the stress depends on F alone as long as no packing rearranges: any difference that is
 * more than what the tolerances leave is a branch. */
bool gh_is_branch(const gh_contact_law *law, double tolerance, double growth, double change, double scale) {
  return growth > amplified * tolerance * scale && (!law->friction || growth > branch * change);
}
