/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The loop over load steps and increments. */
#include "granhom/limits.h"
#include "scene/output.h"

#include <stdlib.h>
#include <string.h>

typedef struct run {
  gh_scene *scene;
  gh_context *ctx;
  const gh_run_options *options;
  const char *folder; /* NULL: nothing is written */
  gh_farm *farm;
  gh_macro *macro;
  gh_loads *loads;
  scene_output output;
  gh_lock *lock;         /* of the folder */
  gh_run_summary sum;    /* of this run and those that it continues from, without the following: */
  gh_run_summary before; /* cost, farm and seconds up to the checkpoint that was read */
  double begin;
  double **begin_u; /* nsteps + 1: displacements when each step began */
  gh_h5 *pending;   /* checkpoint of the last complete increment, in memory */
  gh_work work;
  int counter;             /* of increments, 0 the start */
  int step, increment;     /* at work */
  bool warned;             /* of overlaps: gh_limits_check_state */
  gh_macro_iteration last; /* of the increment at work */
} run;

/* ---- one increment ---- */

/* Steps of relaxation are many and cheap. */
static void tell_relaxation(run *r, const gh_macro_iteration *it) {
  enum { EVERY = 20 };
  if (it->iteration % EVERY > 0) return;
  gh_log(r->ctx, GH_LEVEL_INFO,
         "%s %d/%d  part %d  relaxation %4d  relative residual %9.2e  kinetic energy over work %9.2e  %.2f s",
         gh_scene_step_name(r->scene, r->step), r->increment, gh_scene_increments(r->scene, r->step),
         it->substep + 1, it->iteration, it->relative, it->kinetic, it->seconds);
}

static void watch(void *data, const gh_macro_iteration *it) {
  run *r = data;
  r->last = *it;
  if (r->output.results)
    gh_results_residual(r->output.results,
                        &(gh_residual_row){r->counter, it->substep, it->iteration, it->residual, it->relative,
                                           it->first, it->step, it->kinetic, it->seconds});
  if (it->kinetic > 0) {
    tell_relaxation(r, it);
    return;
  }
  gh_log(r->ctx, GH_LEVEL_INFO,
         "%s %d/%d  part %d  iteration %2d  relative residual %9.2e  step length %.3g  %.2f s",
         gh_scene_step_name(r->scene, r->step), r->increment, gh_scene_increments(r->scene, r->step),
         it->substep + 1, it->iteration, it->relative, it->step, it->seconds);
}

static gh_status tell_stop(run *r) {
  if (!r->folder)
    return gh_fail(r->ctx, GH_STOPPED, "stopped on request at increment %d of %d of step '%s'", r->increment,
                   gh_scene_increments(r->scene, r->step), gh_scene_step_name(r->scene, r->step));
  return gh_fail(
      r->ctx, GH_STOPPED,
      "stopped on request at increment %d of %d of step '%s'; what was done before is complete on disk, and "
      "--restart continues from there",
      r->increment, gh_scene_increments(r->scene, r->step), gh_scene_step_name(r->scene, r->step));
}

/* The farm asks too, within an increment; here counts a request that comes while results are written. */
static gh_status ask_stop(const run *r) {
  const gh_run_options *o = r->options;
  return o && o->stop && o->stop(o->stop_data) ? GH_STOPPED : GH_OK;
}

static void add_up(run *r, const gh_macro_report *report) {
  r->sum.iterations += report->iterations;
  r->sum.relaxed += report->relaxed;
  r->sum.relaxed_increments += report->relaxed > 0;
  r->sum.substeps += report->substeps;
  r->sum.cuts += report->cuts;
  r->sum.jumps += report->jumps;
  r->sum.micro_seconds += report->micro_seconds;
}

static void tell_increment(run *r, const gh_macro_report *report) {
  double V, v;
  const int unjammed = r->output.unjammed;
  char acoustic[64] = "";
  if (!isnan(r->output.min_acoustic))
    snprintf(acoustic, sizeof acoustic, ", smallest acoustic eigenvalue %.3g", r->output.min_acoustic);
  gh_macro_volumes(r->macro, &V, &v);
  gh_log(r->ctx, GH_LEVEL_INFO,
         "%s %d/%d done: %d iteration%s in %d substep%s, residual %.1e, dilatancy %.4g %%%s, %.2f s (%.2f s "
         "micro)",
         gh_scene_step_name(r->scene, r->step), r->increment, gh_scene_increments(r->scene, r->step),
         report->iterations, GH_S(report->iterations), report->substeps, GH_S(report->substeps),
         report->relative, 100 * (v / V - 1), acoustic, report->seconds, report->micro_seconds);
  if (report->jumps > 0)
    gh_log(r->ctx, GH_LEVEL_WARNING,
           "%s %d: passed %d jump%s of the packings: the path is not continuous there",
           gh_scene_step_name(r->scene, r->step), r->increment, report->jumps, GH_S(report->jumps));
  if (unjammed > 0)
    gh_log(r->ctx, GH_LEVEL_WARNING,
           "%s %d: %d of %d integration points are unjammed: no grain touches another there",
           gh_scene_step_name(r->scene, r->step), r->increment, unjammed, r->sum.points);
}

static gh_status write_frame(run *r, const gh_macro_report *report) {
  int increments = gh_scene_increments(r->scene, r->step);
  double begin = gh_seconds();
  const gh_frame frame = {.counter = r->counter,
                          .step = r->step,
                          .increment = r->increment,
                          .name = gh_scene_step_name(r->scene, r->step),
                          .time = r->step == 0 ? 0 : r->step - 1 + (double)r->increment / increments};
  gh_status status = scene_output_write(&r->output, frame, report, &r->sum);
  r->sum.results_seconds += gh_seconds() - begin;
  return status;
}

/* ---- checkpoints ---- */

/* What the farm and the clock know goes into the summary. */
static void sum_up(run *r) {
  const gh_farm_counts *old = &r->before.farm;
  gh_farm_counts *now = &r->sum.farm;
  gh_farm_costs(r->farm, &r->sum.cost);
  gh_rve_cost_add(&r->sum.cost, &r->before.cost);
  gh_farm_count(r->farm, now);
  now->evaluations += old->evaluations, now->steps += old->steps, now->factorisations += old->factorisations;
  now->pairs += old->pairs;
  now->ramps += old->ramps, now->settled += old->settled, now->newton += old->newton,
      now->accepted += old->accepted;
  now->computed += old->computed, now->moved += old->moved;
  now->busy += old->busy, now->longest += old->longest;
  r->sum.seconds = r->before.seconds + gh_seconds() - r->begin;
}

/* A checkpoint of the increment that is complete now; to disk when it is due. */
static gh_status keep(run *r) {
  if (!gh_h5_available() || !r->folder) return GH_OK;
  double begin = gh_seconds();
  int every = r->options && r->options->checkpoint_every > 0 ? r->options->checkpoint_every : 1;
  scene_position here = {
      .counter = r->counter, .step = r->step, .increment = r->increment, .begin_u = r->begin_u};
  sum_up(r);
  here.sum = r->sum;
  gh_h5_close(&r->pending);
  GH_TRY(scene_checkpoint_make(&r->output, &here, &r->pending));
  gh_status status = r->counter % every == 0 ? gh_h5_commit(&r->pending) : GH_OK;
  r->sum.results_seconds += gh_seconds() - begin;
  return status;
}

/* The plan knows where it is after it was asked for all increments up to there. */
static gh_status replay(run *r) {
  for (int step = 0; step <= r->step; step++) {
    int last = step < r->step ? gh_scene_increments(r->scene, step) : r->increment;
    for (int k = 1; k <= last; k++)
      GH_TRY(gh_scene_loads(r->scene, step, k, k == 1 ? r->begin_u[step] : NULL, r->loads));
  }
  return GH_OK;
}

/* *resumed: the run continues behind r->step, r->increment. */
static gh_status resume(run *r, bool *resumed) {
  *resumed = false;
  if (!r->options || !r->options->restart || !r->folder) return GH_OK;
  GH_TRY(gh_checkpoint_find(r->output.results, resumed));
  if (!*resumed) {
    gh_log(r->ctx, GH_LEVEL_WARNING, "there is no checkpoint to restart from: the run begins at the start");
    return GH_OK;
  }
  scene_position at = {.begin_u = r->begin_u};
  GH_TRY(scene_checkpoint_read(&r->output, &at));
  r->counter = at.counter, r->step = at.step, r->increment = at.increment;
  r->sum = r->before = at.sum;
  r->counter++;
  GH_TRY(replay(r));
  gh_log(r->ctx, GH_LEVEL_INFO, "continuing behind increment %d of %d of step '%s'", r->increment,
         gh_scene_increments(r->scene, r->step), gh_scene_step_name(r->scene, r->step));
  return GH_OK;
}

/* ---- one increment solved ---- */

/* Increments that are solved with ease take twice as many planned ones at once, those that are hard half as
 * many. Cuts reach down to the same part of a planned increment whatever is taken at once. */
static void adapt(run *r, const gh_macro_report *report) {
  const gh_scene *s = r->scene;
  const int most = s->solver.max_iterations;
  if (r->step == 0 || s->at_once <= 1) return;
  const bool hard = report->cuts > 0 || report->jumps > 0 || 2 * report->iterations > most,
             easy = !hard && 3 * report->iterations <= most;
  if (hard) r->sum.at_once = r->sum.at_once > 1 ? r->sum.at_once / 2 : 1;
  if (easy) r->sum.at_once = 2 * r->sum.at_once <= s->at_once ? 2 * r->sum.at_once : s->at_once;
}

/* The planned increment at which the one after `before` ends. */
static int next_end(run *r, int before) {
  int left = gh_scene_increments(r->scene, r->step) - before, taken = r->sum.at_once, halvings = 0;
  if (r->scene->at_once <= 1) return before + 1;
  if (taken > left) taken = left;
  for (int k = taken; k > 1; k = (k + 1) / 2) halvings++;
  gh_macro_allow_cuts(r->macro, r->scene->solver.cut_steps + halvings);
  return before + taken;
}

/* The energy counts from the end of the start. */
static void note_energy(run *r) {
  if (r->step == 0) gh_macro_zero_energy(r->macro);
  gh_macro_energy(r->macro, &r->sum.energy);
}

/* What is easy is told by the increment in one: `whole`. */
static gh_status find_equilibrium(run *r, gh_macro_report *report, gh_macro_report *whole) {
  if (r->scene->estimate)
    return scene_solve_twice(r->scene, r->macro, r->loads, report, whole, &r->sum.estimate);
  gh_status status = gh_macro_solve(r->macro, r->loads, report);
  *whole = *report;
  return status;
}

/* To who watches the run from outside. */
static gh_status show(run *r) {
  const gh_run_options *o = r->options;
  if (!o || !o->observe) return GH_OK;
  return o->observe(o->observe_data, r->step, r->increment, gh_scene_increments(r->scene, r->step), r->macro);
}

/* How far the run has come. */
static void note_step(run *r) {
  int of = gh_scene_increments(r->scene, r->step);
  bool whole = r->step > 0 && r->increment == of, part = r->step > 0 && !whole;
  r->sum.steps += whole;
  r->sum.step = part ? r->step : 0;
  r->sum.done = part ? r->increment : 0;
  r->sum.of = part ? of : 0;
}

/* Each integration point, in their order, so that ranks and sharing change no message; the warning is about
 * their mean, since single points beside a corner carry more. */
static gh_status check_limits(run *r) {
  const gh_rve_options *o = &r->scene->micro;
  const gh_limits limits = gh_limits_of(o);
  double overlap = 0, pressure = 0;
  for (int p = 0; p < r->sum.points; p++) {
    const gh_rve_measures *m = gh_farm_measure(r->farm, p);
    char where[48];
    overlap += m->overlap / r->sum.points;
    pressure += gh_limits_pressure(m) / r->sum.points;
    if (gh_limits_hold(&limits, m)) continue;
    snprintf(where, sizeof where, "integration point %d", p);
    return gh_limits_check_state(r->ctx, o, m, where);
  }
  if (overlap > limits.overlap_warned) {
    char where[192];
    snprintf(where, sizeof where, "step '%s', increment %d: all integration points together",
             gh_scene_step_name(r->scene, r->step), r->increment);
    gh_limits_warn(r->ctx, o, where, overlap, pressure, &r->warned);
  }
  return GH_OK;
}

static gh_status solve(run *r) {
  gh_macro_report report = {0}, whole = {0};
  gh_status status = find_equilibrium(r, &report, &whole);
  add_up(r, &report);
  if (status == GH_OK) status = check_limits(r);
  if (status != GH_OK)
    return gh_prefix(r->ctx, status, "%s: step '%s', increment %d of %d: ", r->scene->path,
                     gh_scene_step_name(r->scene, r->step), r->increment,
                     gh_scene_increments(r->scene, r->step));
  note_energy(r);
  GH_TRY(write_frame(r, &report));
  tell_increment(r, &report);
  adapt(r, &whole);
  r->sum.increments += r->step > 0;
  note_step(r);
  GH_TRY(keep(r));
  r->counter++;
  return show(r);
}

/* ---- the start ---- */

/* Grains only push: a packing that is under stress at F = I and finds no load at a free boundary has no
 * equilibrium. */
gh_status scene_check_start(const gh_scene *s) {
  if (s->start != SCENE_START_NONE || scene_has_load(s) || !scene_boundary_is_free(s)) return GH_OK;
  double F[4] = {1, 0, 0, 1}, P[4] = {0}, largest = 0;
  for (int p = 0; p < s->npackings && largest < 1e-10 * s->micro.law.normal_stiffness; p++) {
    gh_rve *rve;
    GH_TRY(gh_rve_create(s->ctx, s->packings[p], &s->micro, &rve));
    gh_status status = gh_rve_evaluate(rve, F, 0, P, NULL);
    gh_rve_destroy(&rve);
    GH_TRY(status);
    for (int k = 0; k < 4; k++) largest = gh_max(largest, fabs(P[k]));
  }
  if (largest < 1e-10 * s->micro.law.normal_stiffness) return GH_OK;
  return gh_fail(s->ctx, GH_INPUT,
                 "%s:%d: the packing is under stress as it is (P11 = %.4g, P22 = %.4g), no load acts at the "
                 "start, and grains only push: "
                 "there is no equilibrium. Give `start: {confinement: p}` (a pressure to start from) or "
                 "`start: {balance: true}` (the stress is held)",
                 s->path, s->start_line, P[0], P[3]);
}

static gh_status begin_start(run *r) {
  r->step = 0, r->increment = 1; /* of which the loads are since open_run */
  GH_TRY(scene_check_start(r->scene));
  if (r->scene->start == SCENE_START_BALANCE) GH_TRY(gh_macro_balance(r->macro));
  gh_status status = solve(r);
  if (status == GH_DIVERGED && r->scene->start == SCENE_START_NONE && scene_boundary_is_free(r->scene)) {
    char message[2048];
    snprintf(message, sizeof message, "%s", gh_message(r->ctx));
    gh_fail(r->ctx, status,
            "%s. The scene has no `start`: a packing under stress needs `start: {confinement: p}` or `start: "
            "{balance: true}`",
            message);
  }
  return status;
}

/* ---- all steps ---- */

/* The plan of a step starts from the displacements that it finds. */
static gh_status note_begin(run *r) {
  size_t ndof = 2 * (size_t)r->scene->mesh->nnodes;
  double **u = r->begin_u + r->step;
  if (!*u) GH_TRY(gh_alloc(r->ctx, ndof, sizeof **u, u));
  memcpy(*u, gh_macro_u(r->macro), ndof * sizeof **u);
  return GH_OK;
}

/* The plan begins a step when it is asked for its first increment. */
static gh_status plan(run *r, bool begins) {
  const double *u = gh_macro_u(r->macro);
  if (begins && r->increment > 1) GH_TRY(gh_scene_loads(r->scene, r->step, 1, u, r->loads));
  return gh_scene_loads(r->scene, r->step, r->increment, u, r->loads);
}

/* The increments of a step from `first` on. */
static gh_status run_step(run *r, int step, int first) {
  int increments = gh_scene_increments(r->scene, step);
  r->step = step;
  gh_work_begin(r->ctx, &r->work, gh_scene_step_name(r->scene, step), "increments", increments);
  gh_status status = GH_OK;
  int k = first;
  for (; k <= increments; k++) {
    bool begins = k == 1;
    r->increment = k = next_end(r, k - 1);
    GH_TRY_OR(ask_stop(r), done);
    if (begins) GH_TRY_OR(note_begin(r), done);
    GH_TRY_OR(plan(r, begins), done);
    GH_TRY_OR(solve(r), done);
    gh_work_advance(r->ctx, &r->work, k);
  }
done:
  gh_work_end(r->ctx, &r->work, k - 1);
  return status;
}

static gh_status run_all(run *r) {
  bool resumed;
  GH_TRY(resume(r, &resumed));
  if (!resumed) GH_TRY(begin_start(r));
  int step = r->step, next = r->increment + 1; /* after the start: behind its only increment */
  for (; step <= gh_scene_steps(r->scene); step++, next = 1)
    if (next <= gh_scene_increments(r->scene, step)) GH_TRY(run_step(r, step, next));
  return GH_OK;
}

static gh_status make_farm(run *r) {
  const gh_scene *s = r->scene;
  gh_farm_setup setup = {.n = r->sum.points,
                         .npackings = s->npackings,
                         .packings = (const gh_packing *const *)s->packings,
                         .packing_of = s->packing_of,
                         .rve = s->micro,
                         .no_share = s->no_share,
                         .resident = s->resident};
  if (r->options) setup.comm = r->options->comm, setup.no_balance = r->options->no_balance;
  return gh_farm_create_shared(r->ctx, &setup, &r->farm);
}

static gh_status check_build(const run *r) {
  if (gh_h5_available() || !r->folder) return GH_OK;
  if (r->options && r->options->restart)
    return gh_fail(r->ctx, GH_INPUT,
                   "--restart needs a checkpoint, and this granhom was built without HDF5 (make HDF5=0)");
  gh_log(
      r->ctx, GH_LEVEL_WARNING,
      "built without HDF5 (make HDF5=0): no fields (results.h5, rves.h5, traces.h5 and their XDMF files) and "
      "no checkpoints are written; history.csv, convergence.csv, timing.csv, run.json and dumps are");
  return GH_OK;
}

static gh_status open_run(run *r) {
  const gh_scene *s = r->scene;
  GH_TRY(check_build(r));
  if (r->folder) GH_TRY(scene_folder_open(r->scene, r->folder, &r->lock));
  r->sum.points = 4 * s->mesh->nelements;
  r->sum.planned = gh_scene_steps(s);
  GH_TRY(gh_alloc(r->ctx, (size_t)s->nsteps + 1, sizeof *r->begin_u, &r->begin_u));
  GH_TRY(make_farm(r));
  if (r->options) gh_farm_set_stop(r->farm, r->options->stop, r->options->stop_data);
  GH_TRY(gh_macro_create(r->ctx, s->mesh, r->farm, &s->solver, &r->macro));
  GH_TRY(gh_loads_create(r->ctx, s->mesh, &r->loads));
  GH_TRY(gh_scene_loads(r->scene, 0, 1, NULL, r->loads)); /* pressures of the start have columns */
  GH_TRY(scene_output_create(r->scene, r->farm, r->macro, r->folder, &r->output));
  gh_macro_set_watch(r->macro, watch, r);
  return GH_OK;
}

/* Writes the end into run.json. A failure there does not hide the one of the run. */
static gh_status close_run(run *r, gh_status status) {
  char message[2048];
  snprintf(message, sizeof message, "%s", status == GH_OK ? "" : gh_message(r->ctx));
  const char *outcome = status == GH_OK ? "done" : status == GH_STOPPED ? "stopped" : gh_status_text(status);
  gh_status closed = scene_output_close(&r->output, status, outcome, message, &r->sum);
  if (r->pending) { /* not yet due, but the last one of this run */
    gh_status kept = gh_h5_commit(&r->pending);
    if (closed == GH_OK) closed = kept;
  }
  if (status == GH_OK) return closed;
  return gh_fail(r->ctx, status, "%s", message);
}

gh_status gh_scene_run(gh_scene *scene, const char *folder, const gh_run_options *options,
                       gh_run_summary *summary) {
  run r = {.scene = scene,
           .ctx = scene->ctx,
           .options = options,
           .folder = folder,
           .begin = gh_seconds(),
           .sum = {.at_once = 1}};
  gh_status status = open_run(&r);
  if (status == GH_OK) {
    status = run_all(&r);
    if (status == GH_STOPPED) tell_stop(&r);
    sum_up(&r);
    r.sum.unjammed = r.output.unjammed, r.sum.min_acoustic = r.output.min_acoustic;
    status = close_run(&r, status);
  }
  for (int k = 0; r.begin_u && k <= scene->nsteps; k++) free(r.begin_u[k]);
  free(r.begin_u);
  gh_h5_close(&r.pending);
  scene_output_destroy(&r.output);
  gh_loads_destroy(&r.loads);
  gh_macro_destroy(&r.macro);
  gh_farm_destroy(&r.farm);
  gh_lock_destroy(&r.lock);
  if (summary) *summary = r.sum;
  return status;
}
