/* SPDX-License-Identifier: GPL-2.0-or-later */
/* run.json: what was run, on what, with which outcome. */
#include "io/json.h"
#include "scene/output.h"
#include "granhom/granhom.h"

#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#ifndef GH_BUILD_FLAGS
#define GH_BUILD_FLAGS "unknown"
#endif

/* Asking LAMMPS for its version opens it, and MPI: not for a scene that does without. */
static void add_program(gh_json root, const gh_scene *s) {
  gh_json o = gh_json_group(root, "program");
  gh_json_text(o, "name", "granhom");
  gh_json_text(o, "version", GH_VERSION);
  gh_json_text(o, "compiler", __VERSION__);
  gh_json_text(o, "flags", GH_BUILD_FLAGS);
  gh_json_text(o, "build", gh_build());
  gh_json_number(o, "lammps", s->micro.engine == GH_ENGINE_LAMMPS ? gh_engine_lammps_version() : NAN);
}

static void add_machine(gh_json root, const char *blas) {
  struct utsname name;
  gh_json o = gh_json_group(root, "machine");
  if (uname(&name) == 0) {
    gh_json_text(o, "host", name.nodename);
    gh_json_text(o, "system", name.sysname);
    gh_json_text(o, "release", name.release);
    gh_json_text(o, "architecture", name.machine);
  }
  gh_json_text(o, "blas", blas);
  gh_json_number(o, "cores", (double)sysconf(_SC_NPROCESSORS_ONLN));
}

static void add_options(gh_json root, const gh_scene *s, const gh_farm *farm) {
  static const char *const starts[] = {"none", "confinement", "balance"};
  gh_json o = gh_json_group(root, "options"), micro = gh_json_group(o, "micro"),
          solver = gh_json_group(o, "solver"), start = gh_json_group(o, "start");
  char boundary[GH_MIXED_TEXT];
  gh_boundary_text(&s->micro, boundary);
  gh_json_text(micro, "boundary", boundary);
  gh_json_text(micro, "engine", s->micro.engine == GH_ENGINE_NATIVE ? "native" : "lammps");
  gh_json_number(micro, "normal_stiffness", s->micro.law.normal_stiffness);
  gh_json_text(micro, "relaxation", gh_relaxation_name(s->micro.relaxation));
  if (gh_rve_has_branches(&s->micro))
    gh_json_text(micro, "integration", gh_integration_name(s->micro.integration));
  gh_json_number(micro, "tolerance", s->micro.tolerance);
  gh_json_number(micro, "max_steps", (double)gh_rve_step_limit(&s->micro));
  gh_json_number(micro, "accept", s->micro.accept);
  gh_json_number(micro, "grains", s->packings[0]->n);
  gh_json_number(micro, "points", gh_farm_size(farm));
  gh_json_text(solver, "method", gh_macro_method_name(s->solver.method));
  gh_json_number(solver, "tolerance", s->solver.tolerance);
  if (s->solver.method != GH_METHOD_NEWTON) {
    gh_json_number(solver, "damping_ratio", s->solver.damping_ratio);
    gh_json_number(solver, "safety", s->solver.safety);
  }
  gh_json_number(solver, "max_iterations", s->solver.max_iterations);
  gh_json_number(solver, "cut_steps", s->solver.cut_steps);
  gh_json_truth(solver, "line_search", s->solver.line_search);
  gh_json_number(solver, "search_memory", s->solver.memory);
  gh_json_text(solver, "tangent", gh_tangent_name(s->solver.tangent));
  gh_json_number(solver, "at_once", s->at_once);
  gh_json_truth(solver, "estimate_error", s->estimate);
  gh_json_truth(solver, "pass_jumps", s->solver.pass_jumps);
  gh_json_text(start, "kind", starts[s->start]);
  gh_json_number(start, "confinement", s->start == SCENE_START_CONFINEMENT ? s->confinement : NAN);
}

/* Which packing is at which integration point: a number of the list for each. */
static void add_packings(gh_json root, const gh_scene *s) {
  int points = 4 * s->mesh->nelements;
  gh_json o = gh_json_group(root, "packings");
  cJSON *list = cJSON_AddArrayToObject(o.at, "files");
  for (int k = 0; k < s->npackings; k++) {
    gh_json entry = {.at = cJSON_CreateObject(), .failed = root.failed};
    gh_json_text(entry, "file", s->packing_paths[k]);
    gh_json_number(entry, "grains", s->packings[k]->n);
    gh_json_number(entry, "points", scene_packing_points(s, k));
    if (cJSON_AddItemToArray(list, entry.at)) continue;
    cJSON_Delete(entry.at);
    *root.failed = true;
  }
  if (s->packing_drawn) gh_json_number(o, "seed", (double)s->packing_seed);
  if (s->npackings > 1) gh_json_add(o, "of_point", cJSON_CreateIntArray(s->packing_of, points));
}

/* What the pictures need to know: which set is driven, and in which direction. */
static void add_driven(gh_json root, const gh_scene *s) {
  int set, direction;
  if (!scene_driven(s, &set, &direction)) return;
  gh_json o = gh_json_group(root, "driven");
  gh_json_text(o, "set", s->mesh->sets[set].name);
  gh_json_text(o, "direction", direction ? "y" : "x");
}

/* What the run knows of its error; energies in units of the scene, defects and errors relative. */
static void add_error(gh_json root, const gh_run_summary *m, bool estimated) {
  static const char *const names[GH_ERRORS] = {"stress_l2", "stress_largest", "displacement", "force"};
  const gh_energy *e = &m->energy;
  gh_json o = gh_json_group(root, "error");
  gh_json_number(o, "residual", e->residual);
  gh_json_number(o, "micro_residual", e->micro_residual);
  gh_json_number(o, "energy_defect", gh_energy_defect(e));
  gh_json_number(o, "work_defect", gh_work_defect(e));
  gh_json_number(o, "inner_work", e->inner_work);
  gh_json_number(o, "outer_work", e->outer_work);
  gh_json_number(o, "energy", e->energy);
  gh_json_number(o, "dissipation", e->dissipation);
  gh_json_number(o, "freed_in_jumps", e->freed);
  if (!estimated) return;
  const gh_run_estimate *q = &m->estimate;
  o = gh_json_group(o, "estimate");
  for (int k = 0; k < GH_ERRORS; k++) gh_json_number(o, names[k], gh_estimated_error(q, k));
  gh_json_number(o, "increments", q->increments);
  gh_json_number(o, "branched_increments", q->branched);
  gh_json_number(o, "largest_branch", q->branch);
  gh_json_number(o, "extra_seconds", q->seconds);
}

static void add_overrides(gh_json root, const gh_scene *s) {
  if (s->noverrides == 0) return;
  gh_json o = gh_json_group(root, "overrides");
  for (int k = 0; k < s->noverrides; k++) gh_json_text(o, s->override_key[k], s->override_value[k]);
}

static void add_summary(gh_json root, const gh_run_summary *m) {
  gh_json o = gh_json_group(root, "summary"), time = gh_json_group(o, "seconds"),
          farm = gh_json_group(o, "farm");
  gh_json_number(o, "steps", m->steps);
  gh_json_number(o, "increments", m->increments);
  gh_json_number(o, "iterations", m->iterations);
  gh_json_number(o, "relaxation_iterations", m->relaxed);
  gh_json_number(o, "relaxation_increments", m->relaxed_increments);
  gh_json_number(o, "substeps", m->substeps);
  gh_json_number(o, "cuts", m->cuts);
  gh_json_number(o, "jumps", m->jumps);
  gh_json_number(o, "points", m->points);
  gh_json_number(o, "unjammed", m->unjammed);
  gh_json_number(o, "min_acoustic", m->min_acoustic);
  gh_json_number(o, "evaluations", (double)m->cost.evaluations);
  gh_json_number(o, "relaxation_steps", (double)m->cost.steps);
  gh_json_number(o, "factorisations", (double)m->cost.factorisations);
  gh_json_number(o, "pair_evaluations", (double)m->cost.pairs);
  gh_json_number(farm, "ranks", m->farm.ranks);
  gh_json_number(farm, "evaluations", (double)m->farm.evaluations);
  gh_json_number(farm, "pair_evaluations", (double)m->farm.pairs);
  gh_json_number(farm, "ramps", (double)m->farm.ramps);
  gh_json_number(farm, "ramps_to_rest", (double)m->farm.settled);
  gh_json_number(farm, "newton", (double)m->farm.newton);
  gh_json_number(farm, "accepted", (double)m->farm.accepted);
  gh_json_number(farm, "computed", (double)m->farm.computed);
  gh_json_number(farm, "moved", (double)m->farm.moved);
  gh_json_number(farm, "busy_seconds", m->farm.busy);
  gh_json_number(farm, "longest_seconds", m->farm.longest);
  gh_json_number(farm, "different_rves", m->farm.states);
  gh_json_number(farm, "rves_kept_ready", m->farm.residents);
  gh_json_number(farm, "bytes_of_one", m->farm.bytes);
  gh_json_number(time, "total", m->seconds);
  gh_json_number(time, "micro", m->micro_seconds);
  gh_json_number(time, "micro_set", m->cost.set);
  gh_json_number(time, "micro_relax", m->cost.relax);
  gh_json_number(time, "micro_contacts", m->cost.contacts);
  gh_json_number(time, "micro_factorise", m->cost.factorise);
  gh_json_number(time, "micro_sum", m->cost.total); /* over all points: the parts above belong to it */
  gh_json_number(time, "results", m->results_seconds);
}

void scene_record_begin(gh_json root, const gh_scene *scene, const gh_outcome *outcome) {
  gh_json_text(root, "title", scene->title);
  gh_json_text(root, "status", outcome->status);
  if (outcome->message && *outcome->message) gh_json_text(root, "message", outcome->message);
  gh_json_text(root, "started", outcome->started);
  add_program(root, scene);
  add_machine(root, outcome->blas);
  add_driven(root, scene);
  gh_json units = gh_json_group(root, "units");
  gh_json_text(units, "length", scene->length_unit);
  gh_json_text(units, "force", scene->force_unit);
}

gh_status scene_record_end(gh_json root, const gh_scene *scene, gh_text *out) {
  gh_json_text(root, "scene_file", scene->path);
  gh_json_text(root, "packing_file", scene->packing_paths[0]);
  add_packings(root, scene);
  gh_json_text(root, "scene", scene->text);
  add_overrides(root, scene);
  char *json = *root.failed ? NULL : cJSON_Print(root.at);
  cJSON_Delete(root.at);
  if (!json) return gh_fail(scene->ctx, GH_MEMORY, "no memory for run.json");
  gh_text_print(out, "%s\n", json);
  free(json);
  return GH_OK;
}

gh_status scene_record(void *data, const gh_outcome *outcome, gh_text *out) {
  const scene_output *o = data;
  bool failed = false;
  gh_json root = {.at = cJSON_CreateObject(), .failed = &failed};
  scene_record_begin(root, o->scene, outcome);
  add_options(root, o->scene, o->farm);
  if (outcome->ended) add_summary(root, o->summary);
  if (outcome->ended) add_error(root, o->summary, o->scene->estimate);
  return scene_record_end(root, o->scene, out);
}
