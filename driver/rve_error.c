/* Energy defect and step doubling along a path of one material point: docs/method.md, "What a run knows of
 * its error". SPDX-License-Identifier: GPL-2.0-or-later */
#include "rve_error.h"

#include <string.h>

static const double branch = 0.1, amplified = 1e3; /* src/scene/estimate.c */

void rve_error_count(rve_error *e, const gh_rve_measures *m) {
  const double held = m->energy + m->dissipation;
  if (e->parts++ == 0) e->energy0 = held;
  else
    for (int k = 0; k < 4; k++) e->work += 0.5 * (m->P[k] + e->P[k]) * (m->F[k] - e->F[k]);
  memcpy(e->F, m->F, sizeof e->F);
  memcpy(e->P, m->P, sizeof e->P);
  e->held = held - e->energy0;
  e->largest = fmax(e->largest, fmax(fabs(e->work), fabs(e->held)));
  e->residual = fmax(e->residual, m->residual);
}

static double norm4(const double a[4]) {
  return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + a[3] * a[3]);
}

bool rve_error_compare(rve_error *e, const double P[4], const double whole[4], const gh_rve_options *o) {
  double apart[4], growth[4], change[4];
  for (int k = 0; k < 4; k++) {
    apart[k] = whole ? P[k] - whole[k] : 0;
    growth[k] = apart[k] - e->apart[k];
    change[k] = P[k] - e->before[k];
  }
  const double grown = norm4(growth), noise = amplified * o->tolerance * norm4(P);
  const bool branched = !whole || (grown > noise && (!o->law.friction || grown > branch * norm4(change)));
  if (branched && o->law.friction) e->kept += norm4(e->apart);
  for (int k = 0; k < 4; k++) e->apart[k] = branched ? 0 : apart[k];
  memcpy(e->before, P, sizeof e->before);
  e->now = e->kept + norm4(e->apart);
  e->most = fmax(e->most, e->now);
  e->scale = fmax(e->scale, fmax(norm4(P), e->now));
  e->compared++;
  e->branched += branched;
  return branched;
}

void rve_error_tell(gh_context *ctx, const rve_error *e) {
  if (e->parts == 0) return;
  if (e->compared > 0)
    gh_log(ctx, GH_LEVEL_INFO,
           "estimated error of the stress path %.2g of the largest stress; it branches in %d of %d rows%s",
           e->most > 0 ? e->most / e->scale : 0, e->branched, e->compared,
           e->branched > 0 ? ", behind which it is one of several" : "");
  if (e->largest > 0)
    gh_log(ctx, GH_LEVEL_INFO,
           "largest residual %.1e; energy defect %.1e: work of P on F by the trapezoidal rule, less energy "
           "gained and dissipated, over the largest work",
           e->residual, (e->work - e->held) / e->largest);
  else gh_log(ctx, GH_LEVEL_INFO, "largest residual %.1e", e->residual);
}
