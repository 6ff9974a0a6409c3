/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The columns of history.csv: loads, reactions, what the solution cost, energies, estimated errors. */
#include "scene/history.h"

#include <stdlib.h>
#include <string.h>

static bool set_is_pressed(const gh_scene *s, int set) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].npressures; j++)
      if (s->steps[k].pressures[j].set == set) return true;
  return s->present.pressure[set].now != 0;
}

static bool set_is_driven(const gh_scene *s, int set, int i) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].ndisplaces; j++)
      if (s->steps[k].displaces[j].set == set && !isnan(s->steps[k].displaces[j].to[i])) return true;
  return false;
}

static bool set_is_forced(const gh_scene *s, int set) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].nforces; j++)
      if (s->steps[k].forces[j].set == set) return true;
  return false;
}

static bool set_has_footing(const gh_scene *s, int set) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].nfootings; j++)
      if (s->steps[k].footings[j].set == set) return true;
  return false;
}

/* ---- one walk over all columns, for their names and for a row ---- */

void scene_walk_column(scene_walk *w, const char *name, bool may_be_nan, double value) {
  if (w->column) {
    snprintf(w->column[w->n].name, sizeof w->column[w->n].name, "%s", name);
    w->column[w->n].may_be_nan = may_be_nan;
  }
  if (w->value) w->value[w->n] = value;
  w->n++;
}

/* A column of scene_history_sets, with the name of the set in the place of SET. Displacements that nothing
 * prescribes are nan. */
static void set_column_add(scene_walk *w, int column, int set, double value) {
  const char *name = scene_history_sets[column].name, *at = strstr(name, "SET");
  char of[GH_COLUMN], full[GH_COLUMN + 16];
  if (at) {
    gh_column_name(w->scene->mesh->sets[set].name, of);
    snprintf(full, sizeof full, "%.*s%s%s", (int)(at - name), name, of, at + strlen("SET"));
  }
  scene_walk_column(w, at ? full : name, column == HISTORY_UX || column == HISTORY_UY, value);
}

void scene_walk_loads(scene_walk *w) {
  const gh_scene *s = w->scene;
  for (int set = 0; set < s->nsets; set++) {
    gh_scene_load load;
    gh_scene_load_on(s, set, &load);
    if (set_is_pressed(s, set)) set_column_add(w, HISTORY_P, set, load.pressure);
    for (int i = 0; i < 2; i++) {
      const scene_standing *footing = s->present.footing + set;
      if (set_is_driven(s, set, i)) set_column_add(w, HISTORY_UX + i, set, load.displacement[i]);
      if (set_is_forced(s, set)) set_column_add(w, HISTORY_FX + i, set, load.force[i]);
      if (set_has_footing(s, set))
        set_column_add(w, HISTORY_FOOTING_FX + i, set, footing->force[i].now + footing->old[i].now);
    }
  }
  double b[2];
  gh_scene_gravity(s, b);
  for (int i = 0; i < 2; i++) set_column_add(w, HISTORY_GX + i, 0, b[i]);
}

void scene_walk_reactions(scene_walk *w, void (*reaction)(const void *data, int set, double sum[2]),
                          const void *data) {
  for (int set = 0; set < w->scene->nsets; set++) {
    double sum[2] = {0, 0};
    if (w->present) reaction(data, set, sum);
    for (int i = 0; i < 2; i++) set_column_add(w, HISTORY_X + i, set, sum[i]);
  }
}

static void macro_reaction(const void *data, int set, double sum[2]) {
  gh_macro_reaction(((const scene_output *)data)->macro, set, sum);
}

/* How footings have moved. */
static void footings_add(scene_walk *w, const scene_output *o) {
  for (int set = 0; set < w->scene->nsets; set++) {
    double u[2] = {0, 0}, turn = 0;
    if (!set_has_footing(w->scene, set)) continue;
    if (o) gh_macro_footing(o->macro, set, u, &turn);
    set_column_add(w, HISTORY_FOOTING_UX, set, u[0]);
    set_column_add(w, HISTORY_FOOTING_UY, set, u[1]);
    set_column_add(w, HISTORY_FOOTING_TURN, set, turn);
  }
}

/* The columns of a list of terms. Without tangents there is no acoustic tensor. */
static void terms_add(scene_walk *w, const gh_term *terms, const double *value) {
  const bool stress = w->scene->solver.method == GH_METHOD_RELAXATION;
  for (int k = 0; terms[k].name; k++)
    scene_walk_column(w, terms[k].name, stress && !strcmp(terms[k].name, "min_acoustic"), value[k]);
}

enum { TAIL = 18 };

/* Mean over the integration points of one of scene_numbers. */
static double points_mean(const scene_output *o, const char *name) {
  const scene_number *number = scene_numbers;
  const int points = gh_farm_size(o->farm);
  double sum = 0;
  while (strcmp(number->name, name) != 0) number++;
  for (int p = 0; p < points; p++) sum += number->of(gh_farm_measure(o->farm, p));
  return sum / points;
}

/* In the order of scene_history_tail. */
static void tail_fill(const scene_output *o, double value[TAIL]) {
  const gh_macro_report *m = o->report;
  const gh_energy *e = &o->summary->energy;
  gh_farm_counts now;
  double V, v;
  gh_macro_volumes(o->macro, &V, &v);
  gh_farm_count(o->farm, &now);
  const double all[TAIL] = {100 * (v / V - 1),
                            m->iterations,
                            m->substeps,
                            m->cuts,
                            m->jumps,
                            o->unjammed,
                            o->min_acoustic,
                            m->relative,
                            (double)(now.evaluations - o->counted.evaluations),
                            (double)(now.steps - o->counted.steps),
                            (double)(now.factorisations - o->counted.factorisations),
                            e->inner_work,
                            e->outer_work,
                            e->energy,
                            e->dissipation,
                            gh_energy_defect(e),
                            points_mean(o, "coordination"),
                            points_mean(o, "anisotropy")};
  memcpy(value, all, sizeof all);
}

/* In the order of scene_history_estimate. */
static void estimate_fill(const scene_output *o, double value[GH_ERRORS + 2]) {
  const gh_run_estimate *q = &o->summary->estimate;
  for (int k = 0; k < GH_ERRORS; k++) value[k] = gh_estimated_now(q, k);
  value[GH_ERRORS] = q->growth;
  value[GH_ERRORS + 1] = q->last_branched;
}

/* o NULL: names alone. */
static void columns_walk(scene_walk *w, const scene_output *o) {
  double tail[TAIL] = {0}, estimate[GH_ERRORS + 2] = {0};
  scene_walk_loads(w);
  scene_walk_reactions(w, macro_reaction, o);
  footings_add(w, o);
  if (o) tail_fill(o, tail);
  terms_add(w, scene_history_tail, tail);
  if (w->scene->solver.method != GH_METHOD_NEWTON)
    terms_add(w, scene_history_relaxation, (const double[]){o ? o->report->relaxed : 0});
  if (!w->scene->estimate) return;
  if (o) estimate_fill(o, estimate);
  terms_add(w, scene_history_estimate, estimate);
}

gh_status scene_columns_create(const gh_scene *scene, gh_column **columns, int *count) {
  scene_walk w = {.scene = scene};
  columns_walk(&w, NULL);
  *count = w.n;
  GH_TRY(gh_alloc(scene->ctx, (size_t)w.n, sizeof **columns, columns));
  w.n = 0, w.column = *columns;
  columns_walk(&w, NULL);
  return GH_OK;
}

gh_status scene_row(void *data, const gh_frame *frame, double *value) {
  (void)frame;
  const scene_output *o = data;
  scene_walk w = {.scene = o->scene, .present = true, .value = value};
  columns_walk(&w, o);
  return GH_OK;
}
