/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Energy imbalance and step doubling along a path of one material point: docs/explanation/method.md, "Error
 * estimates". */
#include "rve_error.h"

#include <string.h>

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
  const bool branched = !whole || gh_is_branch(&o->law, o->tolerance, norm4(growth), norm4(change), norm4(P));
  if (branched && o->law.friction) e->kept += norm4(e->apart);
  for (int k = 0; k < 4; k++) e->apart[k] = branched ? 0 : apart[k];
  memcpy(e->before, P, sizeof e->before);
  e->now = e->kept + norm4(e->apart);
  e->most = gh_max(e->most, e->now);
  e->scale = gh_max(e->scale, gh_max(norm4(P), e->now));
  e->compared++;
  e->branched += branched;
  return branched;
}

void rve_error_tell(gh_context *ctx, const rve_error *e) {
  const gh_rve_balance *b = &e->balance;
  if (b->parts == 0) return;
  if (e->compared > 0)
    gh_log(ctx, GH_LEVEL_INFO,
           "estimated error of the stress path %.2g of the largest stress; it branches in %d of %d row%s%s",
           e->most > 0 ? e->most / e->scale : 0, e->branched, e->compared, GH_S(e->compared),
           e->branched > 0 ? ", behind which it is one of several" : "");
  const double defect = gh_rve_balance_defect(b);
  if (b->largest > 0 && defect == 0)
    gh_log(ctx, GH_LEVEL_INFO, "largest residual %.1e; no work was done beyond round-off", b->residual);
  else if (b->largest > 0)
    gh_log(
        ctx, GH_LEVEL_INFO,
        "largest residual %.1e; energy imbalance %.1e: work of P on F by the trapezoidal rule, less energy "
        "gained and dissipated, over the largest work",
        b->residual, defect);
  else gh_log(ctx, GH_LEVEL_INFO, "largest residual %.1e", b->residual);
}
