/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The loop over load steps and increments of a direct simulation. */
#include "scene/direct.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- one increment ---- */

/* What the plan holds at present, by nodes and sets. */
static void loads_take(scene_direct *r, gh_direct_loads *l, double *value) {
  const gh_scene *s = r->scene;
  const scene_present *p = &s->present;
  double *dead = r->pressure, *follow = r->pressure + s->nsets;
  for (int set = 0; set < s->nsets; set++) {
    dead[set] = p->follow[set] ? 0 : p->pressure[set].now;
    follow[set] = p->follow[set] ? p->pressure[set].now : 0;
    for (int i = 0; i < 2; i++) r->force[2 * set + i] = s->mesh->sets[set].nnodes * p->force[set][i].now;
  }
  for (int d = 0; d < 2 * s->mesh->nnodes; d++) value[d] = p->held[d] ? p->u[d].now : 0;
  *l = (gh_direct_loads){.fixed = p->held, .value = value, .dead = dead, .follow = follow, .force = r->force};
  gh_scene_gravity(s, l->gravity);
}

static void increment_log(const scene_direct *r) {
  const gh_direct_measures *m = gh_direct_measure(r->body);
  gh_log(r->ctx, GH_LEVEL_INFO,
         "%s %d/%d done: %d substep%s, %ld relaxation steps, residual %.1e, dilatancy %.4g %%, coordination "
         "%.3g, "
         "%.2f s",
         gh_scene_step_name(r->scene, r->step), r->increment, gh_scene_increments(r->scene, r->step),
         r->report.substeps, GH_S(r->report.substeps), r->report.steps, m->residual,
         100 * (m->current / m->volume - 1), m->coordination, r->report.seconds);
  if (m->contacts == 0)
    gh_log(r->ctx, GH_LEVEL_WARNING, "%s %d: no grain touches another", gh_scene_step_name(r->scene, r->step),
           r->increment);
}

static gh_status increment_write(scene_direct *r) {
  const int increments = gh_scene_increments(r->scene, r->step);
  const gh_frame frame = {.counter = r->counter,
                          .step = r->step,
                          .increment = r->increment,
                          .name = gh_scene_step_name(r->scene, r->step),
                          .time = r->step == 0 ? 0 : r->step - 1 + (double)r->increment / increments,
                          .seconds = r->report.seconds,
                          .micro_seconds = r->report.seconds,
                          .evaluations = r->report.substeps,
                          .computed = r->report.substeps,
                          .ranks = 1};
  return gh_results_write(r->results, &frame);
}

static gh_status increment_keep(scene_direct *r) {
  if (!gh_h5_available()) return GH_OK;
  const int every = r->options->checkpoint_every > 0 ? r->options->checkpoint_every : 1;
  r->sum.seconds = r->before + gh_seconds() - r->begin;
  gh_h5_close(&r->pending);
  GH_TRY(gh_checkpoint_make(r->results, &r->pending));
  return r->counter % every == 0 ? gh_h5_commit(&r->pending) : GH_OK;
}

static gh_status increment_solve(scene_direct *r) {
  gh_direct_loads loads;
  double *value;
  GH_TRY(gh_alloc(r->ctx, 2 * (size_t)r->scene->mesh->nnodes, sizeof *value, &value));
  loads_take(r, &loads, value);
  const gh_status status = gh_direct_solve(r->body, &loads, &r->report);
  free(value);
  r->sum.relaxation_steps += r->report.steps;
  r->sum.substeps += r->report.substeps;
  r->sum.cuts += r->report.cuts;
  if (status != GH_OK && status != GH_STOPPED)
    return gh_prefix(r->ctx, status, "%s: step '%s', increment %d of %d: ", r->scene->path,
                     gh_scene_step_name(r->scene, r->step), r->increment,
                     gh_scene_increments(r->scene, r->step));
  GH_TRY(status);
  if (r->step == 0) gh_direct_zero(r->body);
  GH_TRY(increment_write(r));
  increment_log(r);
  r->sum.increments += r->step > 0;
  r->sum.steps += r->step > 0 && r->increment == gh_scene_increments(r->scene, r->step);
  GH_TRY(increment_keep(r));
  r->counter++;
  return GH_OK;
}

/* ---- all steps ---- */

static gh_status ask_stop(const scene_direct *r) {
  return r->options->stop && r->options->stop(r->options->stop_data) ? GH_STOPPED : GH_OK;
}

static gh_status step_begin(scene_direct *r) {
  const size_t ndof = 2 * (size_t)r->scene->mesh->nnodes;
  double **u = r->begin_u + r->step;
  if (!*u) GH_TRY(gh_alloc(r->ctx, ndof, sizeof **u, u));
  memcpy(*u, gh_direct_u(r->body), ndof * sizeof **u);
  return GH_OK;
}

static gh_status step_run(scene_direct *r, int step, int first) {
  const int increments = gh_scene_increments(r->scene, step);
  gh_status status = GH_OK;
  r->step = step;
  gh_work_begin(r->ctx, &r->work, gh_scene_step_name(r->scene, step), "increments", increments);
  int k = first;
  for (; k <= increments; k++) {
    r->increment = k;
    GH_TRY_OR(ask_stop(r), done);
    if (k == 1) GH_TRY_OR(step_begin(r), done);
    GH_TRY_OR(gh_scene_loads(r->scene, step, k, gh_direct_u(r->body), r->loads), done);
    GH_TRY_OR(increment_solve(r), done);
    gh_work_advance(r->ctx, &r->work, k);
  }
done:
  gh_work_end(r->ctx, &r->work, k - 1);
  return status;
}

static gh_status start_run(scene_direct *r) {
  r->step = 0, r->increment = 1; /* of which the loads are since body_open */
  GH_TRY(scene_check_start(r->scene));
  if (r->scene->start == SCENE_START_BALANCE) GH_TRY(gh_direct_balance(r->body));
  return increment_solve(r);
}

/* The plan knows where it is after it was asked for all increments up to there. */
static gh_status replay(scene_direct *r) {
  for (int step = 0; step <= r->step; step++) {
    const int last = step < r->step ? gh_scene_increments(r->scene, step) : r->increment;
    for (int k = 1; k <= last; k++)
      GH_TRY(gh_scene_loads(r->scene, step, k, k == 1 ? r->begin_u[step] : NULL, r->loads));
  }
  return GH_OK;
}

static gh_status resume(scene_direct *r, bool *resumed) {
  *resumed = false;
  if (!r->options->restart) return GH_OK;
  GH_TRY(gh_checkpoint_find(r->results, resumed));
  if (!*resumed) {
    gh_log(r->ctx, GH_LEVEL_WARNING, "there is no checkpoint to restart from: the run begins at the start");
    return GH_OK;
  }
  GH_TRY(gh_checkpoint_read(r->results));
  r->counter++;
  r->before = r->sum.seconds;
  gh_log(r->ctx, GH_LEVEL_INFO, "continuing behind increment %d of %d of step '%s'", r->increment,
         gh_scene_increments(r->scene, r->step), gh_scene_step_name(r->scene, r->step));
  return replay(r);
}

static gh_status steps_run(scene_direct *r) {
  bool resumed;
  GH_TRY(resume(r, &resumed));
  if (!resumed) GH_TRY(start_run(r));
  int step = r->step, next = r->increment + 1;
  for (; step <= gh_scene_steps(r->scene); step++, next = 1)
    if (next <= gh_scene_increments(r->scene, step)) GH_TRY(step_run(r, step, next));
  return GH_OK;
}

/* ---- open and close ---- */

/* What the scene asks for and grains cannot give; and what they need. */
static gh_status scene_check(const scene_direct *r) {
  const gh_scene *s = r->scene;
  const double bytes = gh_direct_bytes(r->options->grains),
               all = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
  for (int k = 0; k < s->nsteps; k++)
    if (s->steps[k].nfootings > 0)
      return gh_fail(r->ctx, GH_INPUT,
                     "%s:%d: a direct simulation has no footings: drive the edge by `displace`", s->path,
                     s->steps[k].footings[0].line);
  if (bytes > all)
    return gh_fail(r->ctx, GH_INPUT,
                   "%g grains need %.3g GB of memory, and this machine has %.3g GB: take fewer (--grains)",
                   r->options->grains, bytes / 1e9, all / 1e9);
  if (!gh_h5_available() && r->options->restart)
    return gh_fail(r->ctx, GH_INPUT,
                   "--restart needs a checkpoint, and this granhom was built without HDF5 (make HDF5=0)");
  return GH_OK;
}

static gh_status body_open(scene_direct *r) {
  const gh_scene *s = r->scene;
  const gh_packing *const *packings = (const gh_packing *const *)s->packings;
  const gh_direct_options o = {.engine = s->micro.engine,
                               .law = s->micro.law,
                               .tolerance = s->micro.tolerance,
                               .max_steps = gh_rve_step_limit(&s->micro),
                               .relaxation = s->micro.relaxation,
                               .integration = s->micro.integration,
                               .cut_steps = s->solver.cut_steps,
                               .stop = r->options->stop,
                               .stop_data = r->options->stop_data};
  gh_packing *grown = NULL, *body = NULL;
  gh_status status = GH_OK;
  if (!r->options->tile)
    status = gh_direct_grow(r->ctx, s->mesh, s->npackings, packings, &s->micro, r->options->grains,
                            (unsigned long long)r->options->seed, &grown);
  if (status == GH_OK)
    status = gh_direct_fill(r->ctx, s->mesh, grown ? grown : packings[0], r->options->grains, &body);
  if (status == GH_OK) {
    r->sum.grains = body->n;
    gh_log(r->ctx, GH_LEVEL_INFO, "%d grains of mean radius %.4g fill the outline", body->n,
           gh_packing_mean_radius(body));
    status = gh_direct_create(r->ctx, s->mesh, s->nsets, body, &o, &r->body);
  }
  gh_packing_destroy(&grown);
  gh_packing_destroy(&body);
  return status == GH_INPUT ? gh_prefix(r->ctx, status, "%s:%d: ", s->path, s->mesh_line) : status;
}

static gh_status direct_open(scene_direct *r) {
  const gh_scene *s = r->scene;
  GH_TRY(scene_check(r));
  GH_TRY(scene_folder_open(r->scene, r->folder, &r->lock));
  r->sum.planned = gh_scene_steps(s);
  GH_TRY(gh_alloc(r->ctx, (size_t)s->nsteps + 1, sizeof *r->begin_u, &r->begin_u));
  GH_TRY(gh_alloc(r->ctx, 2 * (size_t)s->nsets, sizeof(double), &r->pressure));
  GH_TRY(gh_alloc(r->ctx, 2 * (size_t)s->nsets, sizeof(double), &r->force));
  GH_TRY(gh_loads_create(r->ctx, s->mesh, &r->loads));
  GH_TRY(gh_scene_loads(r->scene, 0, 1, NULL, r->loads)); /* pressures of the start have columns */
  GH_TRY(body_open(r));
  return scene_direct_output(r);
}

/* Writes the end into run.json. A failure there does not hide the one of the run. */
static gh_status direct_close(scene_direct *r, gh_status status) {
  char message[2048];
  snprintf(message, sizeof message, "%s", status == GH_OK ? "" : gh_message(r->ctx));
  const char *outcome = status == GH_OK ? "done" : status == GH_STOPPED ? "stopped" : gh_status_text(status);
  r->sum.seconds = r->before + gh_seconds() - r->begin;
  gh_status closed = gh_results_close(r->results, outcome, message, status == GH_INPUT);
  if (r->pending) {
    const gh_status kept = gh_h5_commit(&r->pending);
    if (closed == GH_OK) closed = kept;
  }
  if (status == GH_OK) return closed;
  return gh_fail(r->ctx, status, "%s", message);
}

static void direct_free(scene_direct *r) {
  for (int k = 0; r->begin_u && k <= r->scene->nsteps; k++) free(r->begin_u[k]);
  free(r->begin_u);
  free(r->pressure);
  free(r->force);
  free(r->columns);
  gh_h5_close(&r->pending);
  scene_direct_loaded_destroy(r);
  gh_results_destroy(&r->results);
  gh_loads_destroy(&r->loads);
  gh_direct_destroy(&r->body);
  gh_lock_destroy(&r->lock);
}

gh_status gh_scene_direct(gh_scene *scene, const char *folder, const gh_direct_run_options *options,
                          gh_direct_summary *summary) {
  scene_direct r = {
      .scene = scene, .ctx = scene->ctx, .options = options, .folder = folder, .begin = gh_seconds()};
  gh_status status = direct_open(&r);
  if (status == GH_OK) {
    status = steps_run(&r);
    if (status == GH_STOPPED)
      gh_fail(r.ctx, status,
              "stopped on request at increment %d of %d of step '%s'; what was done before is complete on "
              "disk, and "
              "--restart continues from there",
              r.increment, gh_scene_increments(scene, r.step), gh_scene_step_name(scene, r.step));
    status = direct_close(&r, status);
  }
  direct_free(&r);
  if (summary) *summary = r.sum;
  return status;
}
