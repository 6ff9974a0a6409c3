/* SPDX-License-Identifier: GPL-2.0-or-later */
/* From a hard packing to soft grains in equilibrium. */
#include "prepare/finish.h"

#include <stdlib.h>
#include <string.h>

gh_finish_options gh_finish_defaults(void) {
  return (gh_finish_options){.goal = GH_FINISH_OVERLAP,
                             .target = 0.01,
                             .cell = GH_FINISH_CELL_AUTO,
                             .engine = GH_ENGINE_NATIVE,
                             .normal_stiffness = 1,
                             .tolerance = 1e-10,
                             .accuracy = 0.005,
                             .anisotropy = NAN,
                             .anisotropy_accuracy = 0.004};
}

bool gh_finish_cell_from_name(const char *name, gh_finish_cell *cell) {
  static const char *const names[] = {"auto", "scaled", "relaxed"};
  for (int k = 0; k < 3; k++)
    if (strcmp(name, names[k]) == 0) return *cell = (gh_finish_cell)k, true;
  return false;
}

gh_status gh_finish_parse(gh_context *ctx, const char *text, gh_finish_options *o) {
  bool overlap = strncmp(text, "overlap=", 8) == 0, pressure = strncmp(text, "pressure=", 9) == 0;
  if (!overlap && !pressure)
    return gh_fail(ctx, GH_INPUT, "'%s' is no way to finish a packing: overlap=X or pressure=P", text);
  const char *number = strchr(text, '=') + 1;
  if (!gh_parse_number(number, &o->target) || !(o->target > 0))
    return gh_fail(ctx, GH_INPUT, "'%s': '%s' is no positive number%s", text, number, gh_number_hint(number));
  if (overlap && !(o->target < 1))
    return gh_fail(ctx, GH_INPUT, "'%s': the mean overlap must be below the mean radius, that is below 1",
                   text);
  o->goal = overlap ? GH_FINISH_OVERLAP : GH_FINISH_PRESSURE;
  return GH_OK;
}

gh_status gh_finish_check(gh_context *ctx, const gh_finish_options *o) {
  const struct {
    const char *name;
    double value, limit;
  } positive[] = {{"normal stiffness", o->normal_stiffness, INFINITY},
                  {"tolerance of the equilibrium", o->tolerance, 1},
                  {"accuracy of the target", o->accuracy, 1},
                  {"accuracy of the anisotropy", o->anisotropy_accuracy, 1},
                  {o->goal == GH_FINISH_OVERLAP ? "mean overlap" : "pressure", o->target,
                   o->goal == GH_FINISH_OVERLAP ? 1 : 0.5 * o->normal_stiffness}};
  for (size_t k = 0; k < sizeof positive / sizeof *positive; k++)
    if (!(positive[k].value > 0) || !(positive[k].value < positive[k].limit))
      return gh_fail(ctx, GH_INPUT, "the %s must lie between 0 and %g, not %g", positive[k].name,
                     positive[k].limit, positive[k].value);
  if (!isnan(o->anisotropy) && (!(o->anisotropy >= 0) || !(o->anisotropy < 1)))
    return gh_fail(ctx, GH_INPUT, "the fabric anisotropy must lie between 0 and 1, not %g", o->anisotropy);
  return GH_OK;
}

static gh_status open_job(gh_context *ctx, const gh_packing *packing, const gh_finish_options *o,
                          finish_job *j) {
  gh_rve_options rve = gh_rve_defaults();
  rve.boundary = GH_PERIODIC;
  rve.engine = o->engine;
  rve.law.normal_stiffness = o->normal_stiffness;
  rve.tolerance = o->tolerance;
  *j = (finish_job){.ctx = ctx,
                    .options = o,
                    .mean_radius = gh_packing_mean_radius(packing),
                    .F = {1, 0, 0, 1},
                    .trial_F = {1, 0, 0, 1}};
  return gh_rve_create(ctx, packing, &rve, &j->rve);
}

/* Overlap and isotropic stress together: under a pressure that is corrected until the overlap is met. */
static gh_status relax_at_overlap(finish_job *j) {
  const gh_finish_options *o = j->options;
  double pressure = j->now.pressure;
  for (int round = 0; round < 50; round++) {
    GH_TRY(finish_relax_cell(j, pressure));
    if (fabs(j->now.overlap - o->target) <= o->accuracy * o->target) return GH_OK;
    pressure *= o->target / j->now.overlap;
  }
  return gh_fail(j->ctx, GH_DIVERGED,
                 "no isotropic state with the mean overlap %g: the last one has %g under the pressure %g",
                 o->target, j->now.overlap, j->now.pressure);
}

/* Meets the goal from wherever the job is. */
static gh_status settle(finish_job *j) {
  const gh_finish_options *o = j->options;
  GH_TRY(finish_scale(j));
  if (!finish_relaxes(o)) return GH_OK;
  return o->goal == GH_FINISH_PRESSURE ? finish_relax_cell(j, o->target) : relax_at_overlap(j);
}

/* The packing with the grains at the view's positions, in its cell with the least tilt. */
static void place(const gh_rve_view *v, gh_packing *p) {
  double inverse[4];
  memcpy(p->cell, v->cell, sizeof p->cell);
  memcpy(p->low, v->low, sizeof p->low);
  p->cell[1] -= nearbyint(p->cell[1] / p->cell[0]) * p->cell[0];
  gh_inv2(p->cell, inverse);
  for (int i = 0; i < p->n; i++) {
    double s[2] = {v->x[2 * i] - p->low[0], v->x[2 * i + 1] - p->low[1]}, k[2];
    gh_apply2(inverse, s, k);
    for (int a = 0; a < 2; a++) k[a] = -floor(k[a]);
    gh_apply2(p->cell, k, k);
    for (int a = 0; a < 2; a++) p->x[2 * i + a] = v->x[2 * i + a] + k[a];
  }
}

/* Equilibrium at F = I. The RVE is content where round-off may hide a smaller residual; coming from a state
 * beside this one, its last Newton step usually gets there. */
static gh_status come_to_rest(finish_job *j) {
  bool found;
  double F[4] = {1, 0, 0, 1};
  GH_TRY(finish_try(j, F, true, &found));
  if (!found) return GH_DIVERGED; /* the RVE's message states why */
  GH_TRY(finish_take(j));
  for (int attempt = 1; attempt <= 12 && !(j->now.residual <= j->options->tolerance); attempt++) {
    F[0] = F[3] = 1 - 1e-6 * attempt * j->now.overlap;
    GH_TRY(finish_try(j, F, false, &found));
    if (found) GH_TRY(finish_take(j));
    F[0] = F[3] = 1;
    GH_TRY(finish_try(j, F, true, &found));
    if (!found) return GH_DIVERGED;
    GH_TRY(finish_take(j));
  }
  return GH_OK;
}

/* The report of a packing, whose grains go where they are at rest. */
static gh_status rest(gh_context *ctx, const gh_finish_options *o, gh_packing *p, gh_finish_report *report) {
  finish_job j;
  gh_rve_view v;
  gh_status status = open_job(ctx, p, o, &j);
  if (status == GH_OK) status = come_to_rest(&j);
  if (status == GH_OK) status = gh_rve_look(j.rve, &v);
  if (status == GH_OK) {
    place(&v, p);
    *report = j.now;
    report->evaluations = j.evaluations;
    report->linear_scale = 1;
  }
  gh_rve_destroy(&j.rve);
  return status;
}

gh_status gh_finish_measure(gh_context *ctx, const gh_packing *packing, const gh_finish_options *options,
                            gh_finish_report *report) {
  gh_packing *p;
  GH_TRY(gh_finish_check(ctx, options));
  GH_TRY(gh_packing_copy(ctx, packing, &p));
  gh_status status = rest(ctx, options, p, report);
  gh_packing_destroy(&p);
  return status;
}

static gh_status work(finish_job *j) {
  bool found;
  GH_TRY(finish_try(j, j->F, false, &found));
  if (found) GH_TRY(finish_take(j));
  GH_TRY(settle(j));
  if (!isnan(j->options->anisotropy)) GH_TRY(finish_shear(j, settle));
  return finish_try(j, j->F, false,
                    &found); /* so that the RVE shows the converged state, not a dropped trial */
}

gh_status gh_finish(gh_context *ctx, const gh_packing *hard, const gh_finish_options *options,
                    gh_packing **soft, gh_finish_report *report) {
  *soft = NULL;
  GH_TRY(gh_finish_check(ctx, options));
  finish_job j;
  gh_rve_view v;
  gh_packing *p = NULL;
  gh_status status;
  GH_TRY_OR(open_job(ctx, hard, options, &j), done);
  GH_TRY_OR(gh_packing_copy(ctx, hard, &p), done);
  GH_TRY_OR(work(&j), done);
  GH_TRY_OR(gh_rve_look(j.rve, &v), done);
  place(&v, p);
  GH_TRY_OR(rest(ctx, options, p, report), done);
  report->linear_scale = sqrt(gh_det2(p->cell) / gh_det2(hard->cell));
  report->strain = j.strain;
  report->evaluations += j.evaluations;
  *soft = p;
  p = NULL;
done:
  gh_packing_destroy(&p);
  gh_rve_destroy(&j.rve);
  return status;
}

char *gh_ensemble_path(const char *path, int k) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  size_t stem = dot && dot != path && dot[-1] != '/' ? (size_t)(dot - path) : strlen(path),
         size = strlen(path) + 16;
  char *out = malloc(size);
  if (out) snprintf(out, size, "%.*s-%03d%s", (int)stem, path, k, path + stem);
  return out;
}
