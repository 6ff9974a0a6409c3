/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Known limits of a granulate, in one place for all commands. */
#include "granhom/limits.h"
#include "micro/internal.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/* docs/reference/limits.md describes them. */
static const gh_limits defaults = {.overlap_warned = 0.05,
                                   .overlap = 0.2,
                                   .fraction = 1,
                                   .fraction_overlap = 0.15,
                                   .covered = 1.2092, /* 2 pi / sqrt(27) */
                                   .engulfed = 0,
                                   .stress_warned = 0.05,
                                   .stress = 0.5,
                                   .planned_fraction = 1.5,
                                   .expansion = 100,
                                   .loose = 0.5,
                                   .sparse = 0.01,
                                   .stretch = 0.1};
/* Tensions below this share of the stiffness are round-off of a stress of zero. */
static const double round_off = 1e-9;

static const char *const units_cause =
    "the likely cause is units, as stresses in kPa and a normal stiffness in N/mm (in the plane both are "
    "force per length)";

static bool all_grains_follow(const gh_rve_options *o) {
  const gh_condition c = gh_condition_of(o);
  return !gh_condition_relaxes(&c);
}

gh_limits gh_limits_of(const gh_rve_options *o) {
  gh_limits l = defaults;
  if (all_grains_follow(o)) l.sheared_fraction = 0.9, l.engulfed = INT_MAX;
  if (o->allow_overlap <= 0) return l;
  l.overlap_warned = l.overlap = o->allow_overlap;
  l.sheared_fraction = 0;
  if (o->allow_overlap <= defaults.overlap) return l;
  l.fraction = l.covered = l.planned_fraction = l.stress_warned = l.stress = INFINITY;
  l.engulfed = INT_MAX;
  return l;
}

static double limit_of_fraction(const gh_limits *l, const gh_rve_measures *m) {
  return m->overlap > l->fraction_overlap ? l->fraction : l->covered;
}

static bool limit_overlap_holds(const gh_limits *l, const gh_rve_measures *m) {
  return m->overlap <= l->overlap || m->volume_fraction <= l->sheared_fraction;
}

bool gh_limits_hold(const gh_limits *l, const gh_rve_measures *m) {
  return limit_overlap_holds(l, m) && m->volume_fraction <= limit_of_fraction(l, m) &&
         m->engulfed <= l->engulfed;
}

double gh_limits_pressure(const gh_rve_measures *m) {
  return -(m->cauchy[0] + m->cauchy[3]) / 2;
}

/* A stiffness that was not given is the first thing to inspect. */
static const char *limit_default_note(const gh_rve_options *o) {
  const bool is_default = o->law.normal_stiffness == gh_rve_defaults().law.normal_stiffness;
  return is_default ? " (the default where none is given)" : "";
}

static const char *limit_cause(const gh_rve_options *o) {
  static const char *const strain =
      "all grains follow F there, so that the cause is a prescribed strain this large, or units";
  return all_grains_follow(o) ? strain : units_cause;
}

static gh_status limit_refuse(gh_context *ctx, const gh_rve_options *o, const gh_rve_measures *m,
                              const char *where, const char *what, double value, double limit) {
  const double E = o->law.normal_stiffness;
  return gh_fail(
      ctx, GH_LIMIT,
      "%s: %s is %.4g, above the limit %.4g, where the mean stress is %.3g, %.3g of the normal "
      "stiffness %g%s: %s. `contact: {allow_overlap: true}` or --allow-overlap computes such states",
      where, what, value, limit, gh_limits_pressure(m), gh_limits_pressure(m) / E, E, limit_default_note(o),
      limit_cause(o));
}

gh_status gh_limits_check_state(gh_context *ctx, const gh_rve_options *o, const gh_rve_measures *m,
                                const char *where) {
  const gh_limits l = gh_limits_of(o);
  if (gh_limits_hold(&l, m)) return GH_OK;
  if (!limit_overlap_holds(&l, m))
    return limit_refuse(ctx, o, m, where, "the mean overlap over the mean radius", m->overlap, l.overlap);
  if (!(m->volume_fraction <= limit_of_fraction(&l, m)))
    return limit_refuse(ctx, o, m, where, "the volume fraction", m->volume_fraction,
                        limit_of_fraction(&l, m));
  return limit_refuse(ctx, o, m, where, "the number of contacts with an overlap above the smaller radius",
                      m->engulfed, l.engulfed);
}

void gh_limits_warn(gh_context *ctx, const gh_rve_options *o, const char *where, double overlap,
                    double pressure, bool *warned) {
  const gh_limits l = gh_limits_of(o);
  if (*warned || overlap <= l.overlap_warned) return;
  *warned = true;
  gh_log(
      ctx, GH_LEVEL_WARNING,
      "%s: the mean overlap is %.3g of the mean radius, above %.3g, where the mean stress is %.3g, %.3g of "
      "the normal stiffness %g%s. The contact law is for stiff grains: %s",
      where, overlap, l.overlap_warned, pressure, pressure / o->law.normal_stiffness, o->law.normal_stiffness,
      limit_default_note(o), limit_cause(o));
}

bool gh_limits_is_warning(const char *line) {
  return strstr(line, "of the normal stiffness ") != NULL;
}

gh_status gh_limits_check(gh_context *ctx, const gh_rve_options *o, const gh_rve_measures *m,
                          const char *where, bool *warned) {
  GH_TRY(gh_limits_check_state(ctx, o, m, where));
  gh_limits_warn(ctx, o, where, m->overlap, gh_limits_pressure(m), warned);
  return GH_OK;
}

gh_status gh_limits_check_stress(gh_context *ctx, const gh_rve_options *o, const char *where,
                                 const char *what, double compression, gh_stress_kind kind, bool *warned) {
  const gh_limits l = gh_limits_of(o);
  const double E = o->law.normal_stiffness, ratio = compression / E;
  if (kind == GH_STRESS_NORMAL && ratio < -round_off)
    return gh_fail(
        ctx, GH_INPUT,
        "%s: %s is a tension of %g, and grains without cohesion only push; the likely cause is the "
        "sign",
        where, what, -compression);
  if (!(fabs(ratio) <= l.stress) && kind != GH_STRESS_LOAD)
    return gh_fail(
        ctx, GH_INPUT,
        "%s: %s is %.3g of the normal stiffness %g%s, above the limit %g: grains would be squeezed "
        "flat; %s",
        where, what, fabs(ratio), E, limit_default_note(o), l.stress, units_cause);
  if (fabs(ratio) > l.stress_warned && !*warned) {
    gh_log(ctx, GH_LEVEL_WARNING,
           "%s: %s is %.3g of the normal stiffness %g%s, above %g: overlaps will be about that share of the "
           "diameter; %s",
           where, what, fabs(ratio), E, limit_default_note(o), l.stress_warned, units_cause);
    *warned = true;
  }
  return GH_OK;
}

const char gh_limits_undeformed[] =
    "F = 1 is undeformed, and a compression by 3 percent is 0.97: are these displacement gradients, or "
    "strains in percent?";

gh_status gh_limits_check_volume(gh_context *ctx, const gh_rve_options *o, const char *where,
                                 const char *what, double det, double fraction) {
  const gh_limits l = gh_limits_of(o);
  if (!(det > 0))
    return gh_fail(ctx, GH_INPUT, "%s: %s is %g; it must be positive. %s", where, what, det,
                   gh_limits_undeformed);
  if (!(fraction / det <= l.planned_fraction))
    return gh_fail(
        ctx, GH_INPUT,
        "%s: %s is %.4g: no packing can follow, the grains would fill %.3g of the cell (%.3g now). "
        "%s",
        where, what, det, fraction / det, fraction, gh_limits_undeformed);
  if (!(det <= l.expansion))
    return gh_fail(ctx, GH_INPUT, "%s: %s is %.4g, above the limit %g. %s", where, what, det, l.expansion,
                   gh_limits_undeformed);
  return GH_OK;
}

gh_status gh_limits_check_F(gh_context *ctx, const gh_rve_options *o, const char *where, const double F[4],
                            double fraction) {
  char what[160];
  snprintf(what, sizeof what, "the determinant of F = [%g %g; %g %g]", F[0], F[1], F[2], F[3]);
  return gh_limits_check_volume(ctx, o, where, what, gh_det2(F), fraction);
}

double gh_packing_volume_fraction(const gh_packing *p) {
  double area = 0;
  for (int i = 0; i < p->n; i++) area += acos(-1) * p->radius[i] * p->radius[i];
  return area / gh_det2(p->cell);
}

/* ---- packings as read ---- */

/* Fewer grains that touch each other may be alone in a large cell. */
enum { FEW_GRAINS = 10 };
static const char *const lengths_cause = "the likely cause is units (diameters, positions and cell must be "
                                         "in the same one), or radii for diameters";

/* Contacts between grains as read, and those with an overlap above the smaller radius. */
typedef struct contact_counts {
  int all, engulfed;
} contact_counts;

static gh_status count_contacts(gh_context *ctx, const gh_packing *p, contact_counts *counts) {
  const gh_engine_setup setup = {
      .n = p->n, .radius = p->radius, .periodic = true, .law = {.normal_stiffness = 1}};
  gh_contact_list list;
  gh_engine *engine = NULL;
  gh_status status;
  *counts = (contact_counts){0};
  GH_TRY_OR(gh_engine_create(ctx, GH_ENGINE_NATIVE, &setup, &engine), done);
  GH_TRY_OR(gh_engine_set(engine, p->cell, p->x, NULL), done);
  GH_TRY_OR(gh_engine_contacts(engine, &list), done);
  counts->all = list.count;
  for (int c = 0; c < list.count; c++) {
    const gh_contact *q = &list.contacts[c];
    counts->engulfed += q->overlap > fmin(p->radius[q->i], p->radius[q->j]);
  }
done:
  gh_engine_destroy(&engine);
  return status;
}

gh_status gh_limits_check_packing(gh_context *ctx, const gh_rve_options *o, const char *file,
                                  const gh_packing *p, double least, double most, bool *warned) {
  const gh_limits l = gh_limits_of(o);
  const double fraction = gh_packing_volume_fraction(p);
  contact_counts now;
  if (!(fraction / fmax(most, 1) <= l.planned_fraction))
    return gh_fail(ctx, GH_INPUT, "%s: the grains fill %.3g of the cell, above the limit %g: %s", file,
                   fraction, l.planned_fraction, lengths_cause);
  gh_status status = count_contacts(ctx, p, &now);
  if (status != GH_OK) return gh_prefix(ctx, status, "%s: ", file);
  if (!(fraction / fmin(least, 1) >= l.sparse) && (now.all == 0 || p->n >= FEW_GRAINS))
    return gh_fail(ctx, GH_INPUT, "%s: the grains fill %.3g of the cell, below the limit %g: %s", file,
                   fraction, l.sparse, lengths_cause);
  if (*warned) return GH_OK;
  *warned = now.engulfed > l.engulfed || (now.all == 0 && fraction < l.loose);
  if (now.engulfed > l.engulfed)
    gh_log(ctx, GH_LEVEL_WARNING,
           "%s: of %d contacts as read %d have an overlap above the smaller radius, and relaxation makes "
           "another packing of it; %s",
           file, now.all, now.engulfed, lengths_cause);
  else if (*warned)
    gh_log(
        ctx, GH_LEVEL_WARNING,
        "%s: the grains fill %.3g of the cell, and none touch: there is no stress before F closes the gaps; "
        "%s",
        file, fraction, lengths_cause);
  return GH_OK;
}
