/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What an element test prescribes, against the known limits of a granulate. */
#include "element_spec.h"

#include <string.h>

/* The single quantity of a condition; GH_QUANTITIES when it combines several. */
static int single_quantity(const gh_condition *c) {
  int found = GH_QUANTITIES;
  for (int q = 0; q < GH_QUANTITIES; q++) {
    if (c->factor[q] == 0) continue;
    if (found != GH_QUANTITIES) return GH_QUANTITIES;
    found = q;
  }
  return found;
}

/* Whether a value above 0 is a tension in all terms (1), a compression in all (-1), or neither: shear
 * stresses, differences. */
static int sign_of_tension(const gh_condition *c) {
  static const int tension[GH_QUANTITIES] = {[GH_QUANTITY_P11] = 1,
                                             [GH_QUANTITY_P22] = 1,
                                             [GH_QUANTITY_s11] = 1,
                                             [GH_QUANTITY_s22] = 1,
                                             [GH_QUANTITY_pressure] = -1};
  int sign = 0;
  for (int q = 0; q < GH_QUANTITIES; q++) {
    const double f = c->factor[q] * tension[q];
    if (c->factor[q] == 0) continue;
    if (f == 0 || (f > 0 ? 1 : -1) == -sign) return 0;
    sign = f > 0 ? 1 : -1;
  }
  return sign;
}

static gh_status check_stress(gh_context *ctx, const char *where, const gh_condition *c, double target,
                              const gh_rve_options *o, bool *warned) {
  const int sign = sign_of_tension(c), q = single_quantity(c);
  double size = 0;
  char what[128];
  for (int k = 0; k < GH_QUANTITIES; k++) size += fabs(c->factor[k]);
  if (q == GH_QUANTITY_pressure)
    snprintf(what, sizeof what, "the pressure, %g (compression is positive),", target);
  else snprintf(what, sizeof what, "the stress, %g (compression is negative),", target);
  return gh_limits_check_stress(ctx, o, where, what, (sign == 0 ? 1 : -sign) * target / size,
                                sign == 0 ? GH_STRESS_SIGNLESS : GH_STRESS_NORMAL, warned);
}

/* F11 and F22 are stretches, volume is det F. */
static gh_status check_strain(gh_context *ctx, const char *where, const gh_condition *c, double target,
                              const gh_rve_options *o, double fraction) {
  const gh_limits l = gh_limits_of(o);
  const int q = single_quantity(c);
  const double value = q < GH_QUANTITIES ? target / c->factor[q] : NAN;
  if (q == GH_QUANTITY_volume) return gh_limits_check_volume(ctx, o, where, "the volume", value, fraction);
  if ((q == GH_QUANTITY_F11 || q == GH_QUANTITY_F22) && !(value >= l.stretch && value <= l.expansion))
    return gh_fail(ctx, GH_INPUT, "%s: %s is %g, and must lie between %g and %g. %s", where,
                   q == GH_QUANTITY_F11 ? "F11" : "F22", value, l.stretch, l.expansion, gh_limits_undeformed);
  return GH_OK;
}

gh_status element_check_target(gh_context *ctx, const char *where, const gh_condition *c, double target,
                               const gh_rve_options *o, double fraction, bool *warned) {
  if (!isfinite(target)) return GH_OK; /* not known yet, or the control reports it */
  return c->stress ? check_stress(ctx, where, c, target, o, warned)
                   : check_strain(ctx, where, c, target, o, fraction);
}

/* Where a condition is at the start of a step: at its target of the step before. Otherwise a stress is not
 * known (NAN), and a strain is that of F = I, which is near enough. */
static double start_value(const element_step *before, const gh_condition *c, bool loaded) {
  static const double identity[4] = {1, 0, 0, 1}, none[4] = {0};
  for (int k = 0; before && k < 4; k++)
    if (memcmp(before->condition[k].factor, c->factor, sizeof c->factor) == 0 && isfinite(before->value[k]))
      return before->value[k];
  return c->stress || loaded ? NAN : gh_condition_value(c, identity, none);
}

static void find_targets(const element_step *before, bool loaded, element_step *step) {
  for (int k = 0; k < 4; k++) {
    const double start = start_value(before, &step->condition[k], loaded);
    if (step->way[k] == ELEMENT_BY) step->value[k] += start;
    if (step->way[k] == ELEMENT_TIMES) step->value[k] *= start;
  }
}

/* A step that ends early leaves what moves where it is then. */
static void forget_moving(const element_step *before, bool loaded, element_step *step) {
  for (int k = 0; k < 4 && step->until; k++)
    if (!(step->value[k] == start_value(before, &step->condition[k], loaded))) step->value[k] = NAN;
}

/* All of F at once. */
static gh_status check_both(gh_context *ctx, const char *where, const element_step *s,
                            const gh_rve_options *o, double fraction) {
  double F[4] = {NAN, NAN, NAN, NAN};
  for (int k = 0; k < 4; k++) {
    const int q = single_quantity(&s->condition[k]);
    if (q <= GH_QUANTITY_F22) F[q] = s->value[k] / s->condition[k].factor[q];
  }
  return gh_finite(F, 4) ? gh_limits_check_F(ctx, o, where, F, fraction) : GH_OK;
}

gh_status element_spec_check(gh_context *ctx, const element_spec *spec, const gh_rve_options *o,
                             const gh_packing *packing, bool loaded) {
  const double fraction = gh_packing_volume_fraction(packing);
  bool warned = false;
  element_step before, step;
  for (int n = 0; n < spec->nsteps; n++) {
    char where[512] = "";
    step = spec->steps[n];
    find_targets(n ? &before : NULL, loaded, &step);
    for (int k = 0; k < 4; k++) {
      if (step.line[k] == 0) continue;
      snprintf(where, sizeof where, "%s:%d", spec->path, step.line[k]);
      GH_TRY(element_check_target(ctx, where, &step.condition[k], step.value[k], o, fraction, &warned));
    }
    GH_TRY(check_both(ctx, where, &step, o, fraction));
    forget_moving(n ? &before : NULL, loaded, &step);
    before = step;
  }
  return GH_OK;
}
