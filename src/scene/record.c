/* run.json: what was run, on what, with which outcome. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/internal.h"
#include "granhom/granhom.h"

#include <cjson/cJSON.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#ifndef GH_BUILD_FLAGS
#define GH_BUILD_FLAGS "unknown"
#endif

/* cJSON keeps the first failure to itself: an object that could not be made is NULL, and adding to NULL does
 * nothing. */
static cJSON *group(cJSON *parent, const char *name) {
  return cJSON_AddObjectToObject(parent, name);
}
static void text(cJSON *o, const char *name, const char *value) {
  cJSON_AddStringToObject(o, name, value);
}
static void truth(cJSON *o, const char *name, bool value) {
  cJSON_AddBoolToObject(o, name, value);
}
/* 17 digits; JSON has no NaN: null. */
static void number(cJSON *o, const char *name, double value) {
  if (isfinite(value)) cJSON_AddNumberToObject(o, name, value);
  else cJSON_AddNullToObject(o, name);
}

/* Asking LAMMPS for its version opens it, and MPI: not for a scene that does without. */
static void add_program(cJSON *root, const gh_scene *s) {
  cJSON *o = group(root, "program");
  text(o, "name", "granhom");
  text(o, "version", GH_VERSION);
  text(o, "compiler", __VERSION__);
  text(o, "flags", GH_BUILD_FLAGS);
  text(o, "build", gh_build());
  number(o, "lammps", s->micro.engine == GH_ENGINE_LAMMPS ? gh_engine_lammps_version() : NAN);
}

static void add_machine(cJSON *root) {
  struct utsname name;
  cJSON *o = group(root, "machine");
  if (uname(&name) == 0) {
    text(o, "host", name.nodename);
    text(o, "system", name.sysname);
    text(o, "release", name.release);
    text(o, "architecture", name.machine);
  }
  number(o, "cores", (double)sysconf(_SC_NPROCESSORS_ONLN));
}

static void add_options(cJSON *root, const gh_scene *s, const gh_farm *farm) {
  static const char *const starts[] = {"none", "confinement", "balance"};
  cJSON *o = group(root, "options"), *micro = group(o, "micro"), *solver = group(o, "solver"),
        *start = group(o, "start");
  text(micro, "boundary", gh_boundary_name(s->micro.boundary));
  text(micro, "engine", s->micro.engine == GH_ENGINE_NATIVE ? "native" : "lammps");
  number(micro, "normal_stiffness", s->micro.law.normal_stiffness);
  text(micro, "relaxation", gh_relaxation_name(s->micro.relaxation));
  number(micro, "tolerance", s->micro.tolerance);
  number(micro, "max_steps", (double)gh_rve_step_limit(&s->micro));
  number(micro, "accept", s->micro.accept);
  number(micro, "grains", s->packings[0]->n);
  number(micro, "points", gh_farm_size(farm));
  text(solver, "method", "newton");
  number(solver, "tolerance", s->solver.tolerance);
  number(solver, "max_iterations", s->solver.max_iterations);
  number(solver, "cut_steps", s->solver.cut_steps);
  truth(solver, "line_search", s->solver.line_search);
  number(solver, "search_memory", s->solver.memory);
  text(solver, "tangent", gh_tangent_name(s->solver.tangent));
  number(solver, "at_once", s->at_once);
  truth(solver, "estimate_error", s->estimate);
  truth(solver, "pass_jumps", s->solver.pass_jumps);
  text(start, "kind", starts[s->start]);
  number(start, "confinement", s->start == SCENE_START_CONFINEMENT ? s->confinement : NAN);
}

/* Which packing is at which integration point: a number of the list for each. */
static void add_packings(cJSON *root, const gh_scene *s) {
  int points = 4 * s->mesh->nelements;
  cJSON *o = group(root, "packings"), *list = cJSON_AddArrayToObject(o, "files");
  for (int k = 0; k < s->npackings; k++) {
    cJSON *entry = cJSON_CreateObject();
    text(entry, "file", s->packing_paths[k]);
    number(entry, "grains", s->packings[k]->n);
    number(entry, "points", scene_packing_points(s, k));
    cJSON_AddItemToArray(list, entry);
  }
  if (s->packing_drawn) number(o, "seed", (double)s->packing_seed);
  if (s->npackings > 1) cJSON_AddItemToObject(o, "of_point", cJSON_CreateIntArray(s->packing_of, points));
}

/* What the pictures need to know: which set is driven, and in which direction. */
static void add_driven(cJSON *root, const gh_scene *s) {
  int set, direction;
  if (!scene_driven(s, &set, &direction)) return;
  cJSON *o = group(root, "driven");
  text(o, "set", s->mesh->sets[set].name);
  text(o, "direction", direction ? "y" : "x");
}

/* What the run knows of its error; energies in units of the scene, defects and errors relative. */
static void add_error(cJSON *root, const gh_run_summary *m, bool estimated) {
  static const char *const names[GH_ERRORS] = {"stress_l2", "stress_largest", "displacement", "force"};
  const gh_energy *e = &m->energy;
  cJSON *o = group(root, "error");
  number(o, "residual", e->residual);
  number(o, "micro_residual", e->micro_residual);
  number(o, "energy_defect", gh_energy_defect(e));
  number(o, "work_defect", gh_work_defect(e));
  number(o, "inner_work", e->inner_work);
  number(o, "outer_work", e->outer_work);
  number(o, "energy", e->energy);
  number(o, "dissipation", e->dissipation);
  number(o, "freed_in_jumps", e->freed);
  if (!estimated) return;
  const gh_run_estimate *q = &m->estimate;
  o = group(o, "estimate");
  for (int k = 0; k < GH_ERRORS; k++) number(o, names[k], gh_estimated_error(q, k));
  number(o, "increments", q->increments);
  number(o, "branched_increments", q->branched);
  number(o, "largest_branch", q->branch);
  number(o, "extra_seconds", q->seconds);
}

static void add_overrides(cJSON *root, const gh_scene *s) {
  if (s->noverrides == 0) return;
  cJSON *o = group(root, "overrides");
  for (int k = 0; k < s->noverrides; k++) text(o, s->override_key[k], s->override_value[k]);
}

static void add_summary(cJSON *root, const gh_run_summary *m) {
  cJSON *o = group(root, "summary"), *time = group(o, "seconds"), *farm = group(o, "farm");
  number(o, "steps", m->steps);
  number(o, "increments", m->increments);
  number(o, "iterations", m->iterations);
  number(o, "substeps", m->substeps);
  number(o, "cuts", m->cuts);
  number(o, "jumps", m->jumps);
  number(o, "points", m->points);
  number(o, "unjammed", m->unjammed);
  number(o, "min_acoustic", m->min_acoustic);
  number(o, "evaluations", (double)m->cost.evaluations);
  number(o, "relaxation_steps", (double)m->cost.steps);
  number(o, "factorisations", (double)m->cost.factorisations);
  number(o, "pair_evaluations", (double)m->cost.pairs);
  number(farm, "ranks", m->farm.ranks);
  number(farm, "evaluations", (double)m->farm.evaluations);
  number(farm, "pair_evaluations", (double)m->farm.pairs);
  number(farm, "slip_kept", (double)m->farm.kept);
  number(farm, "accepted", (double)m->farm.accepted);
  number(farm, "computed", (double)m->farm.computed);
  number(farm, "moved", (double)m->farm.moved);
  number(farm, "busy_seconds", m->farm.busy);
  number(farm, "longest_seconds", m->farm.longest);
  number(farm, "different_rves", m->farm.states);
  number(farm, "rves_kept_ready", m->farm.residents);
  number(farm, "bytes_of_one", m->farm.bytes);
  number(time, "total", m->seconds);
  number(time, "micro", m->micro_seconds);
  number(time, "micro_set", m->cost.set);
  number(time, "micro_relax", m->cost.relax);
  number(time, "micro_contacts", m->cost.contacts);
  number(time, "micro_factorise", m->cost.factorise);
  number(time, "micro_sum", m->cost.total); /* over all points: the parts above belong to it */
  number(time, "results", m->results_seconds);
}

char *scene_run_json(const gh_scene *scene, const gh_farm *farm, const char *started, const char *status,
                     const char *message, const gh_run_summary *summary) {
  cJSON *root = cJSON_CreateObject(), *units;
  text(root, "title", scene->title);
  text(root, "status", status);
  if (message && *message) text(root, "message", message);
  text(root, "started", started);
  add_program(root, scene);
  add_machine(root);
  add_options(root, scene, farm);
  add_driven(root, scene);
  units = group(root, "units");
  text(units, "length", scene->length_unit);
  text(units, "force", scene->force_unit);
  if (summary) add_summary(root, summary);
  if (summary) add_error(root, summary, scene->estimate);
  text(root, "scene_file", scene->path);
  text(root, "packing_file", scene->packing_paths[0]);
  add_packings(root, scene);
  text(root, "scene", scene->text);
  add_overrides(root, scene);
  char *json = cJSON_Print(root);
  cJSON_Delete(root);
  return json;
}
