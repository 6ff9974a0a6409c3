/* history.csv and timing.csv: one row per increment; convergence.csv: one per residual. What depends on the
 * machine or on chance stands in the latter two: history.csv is the same whenever the scene is.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/results.h"

#include <stdlib.h>
#include <string.h>

static bool pressed(const gh_scene *s, int set) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].npressures; j++)
      if (s->steps[k].pressures[j].set == set) return true;
  return s->present.pressure[set].now != 0;
}

static bool driven(const gh_scene *s, int set, int i) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].ndisplaces; j++)
      if (s->steps[k].displaces[j].set == set && !isnan(s->steps[k].displaces[j].to[i])) return true;
  return false;
}

static bool forced(const gh_scene *s, int set) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].nforces; j++)
      if (s->steps[k].forces[j].set == set) return true;
  return false;
}

static bool founded(const gh_scene *s, int set) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].nfootings; j++)
      if (s->steps[k].footings[j].set == set) return true;
  return false;
}

/* A column of scene_history_sets, with the name of the set in the place of SET. */
static void column_print(gh_text *t, int column, const char *set) {
  const char *name = scene_history_sets[column].name, *at = strstr(name, "SET");
  if (at) gh_text_print(t, ",%.*s%s%s", (int)(at - name), name, set, at + strlen("SET"));
  else gh_text_print(t, ",%s", name);
}

static void footings_columns(const gh_scene *s, gh_text *t) {
  char name[SCENE_COLUMN];
  for (int set = 0; set < s->nsets; set++) {
    if (!founded(s, set)) continue;
    scene_column(s->mesh->sets[set].name, name);
    for (int column = HISTORY_FOOTING_UX; column <= HISTORY_FOOTING_TURN; column++)
      column_print(t, column, name);
  }
}

/* How they have moved. */
static void history_footings(scene_results *r) {
  for (int set = 0; set < r->scene->nsets; set++) {
    double u[2], turn;
    if (!founded(r->scene, set)) continue;
    gh_macro_footing(r->macro, set, u, &turn);
    gh_text_print(r->history, ",%.17g,%.17g,%.17g", u[0], u[1], turn);
  }
}

/* Writes the header (names) or the loads of a row: one list of columns for both. */
static void history_loads(const gh_scene *s, gh_text *t, bool names) {
  char name[SCENE_COLUMN];
  for (int set = 0; set < s->nsets; set++) {
    gh_scene_load load;
    gh_scene_load_on(s, set, &load);
    scene_column(s->mesh->sets[set].name, name);
    if (pressed(s, set)) names ? column_print(t, HISTORY_P, name) : gh_text_print(t, ",%.17g", load.pressure);
    for (int i = 0; i < 2; i++) {
      if (driven(s, set, i))
        names ? column_print(t, HISTORY_UX + i, name) : gh_text_print(t, ",%.17g", load.displacement[i]);
      if (forced(s, set))
        names ? column_print(t, HISTORY_FX + i, name) : gh_text_print(t, ",%.17g", load.force[i]);
      double footing = s->present.footing[set].force[i].now + s->present.footing[set].old[i].now;
      if (founded(s, set))
        names ? column_print(t, HISTORY_FOOTING_FX + i, name) : gh_text_print(t, ",%.17g", footing);
    }
  }
  double b[2];
  gh_scene_gravity(s, b);
  for (int i = 0; i < 2; i++) names ? column_print(t, HISTORY_GX + i, "") : gh_text_print(t, ",%.17g", b[i]);
}

void scene_history_columns(const gh_scene *s, gh_text *t) {
  char name[SCENE_COLUMN];
  gh_terms_header(t, scene_history_head, ",");
  history_loads(s, t, true);
  for (int set = 0; set < s->nsets; set++) {
    scene_column(s->mesh->sets[set].name, name);
    for (int i = 0; i < 2; i++) column_print(t, HISTORY_X + i, name);
  }
  footings_columns(s, t);
  gh_text_print(t, ",");
  gh_terms_header(t, scene_history_tail, ",");
  if (!s->estimate) return;
  gh_text_print(t, ",");
  gh_terms_header(t, scene_history_estimate, ",");
}

void scene_history_header(scene_results *r) {
  scene_history_columns(r->scene, r->history);
  gh_text_print(r->history, "\n");
}

/* The end of a row: what is known of the error (docs/explanation/method.md). */
static void history_errors(scene_results *r, const scene_frame *f) {
  const gh_energy *e = f->energy;
  const gh_run_estimate *q = f->estimate;
  gh_text_print(r->history, ",%.17g,%.17g,%.17g,%.17g,%.17g", e->inner_work, e->outer_work, e->energy,
                e->dissipation, gh_energy_defect(e));
  for (int k = 0; k < GH_ERRORS && r->scene->estimate; k++)
    gh_text_print(r->history, ",%.17g", gh_estimated_now(q, k));
  if (r->scene->estimate) gh_text_print(r->history, ",%.17g,%d", q->growth, q->last_branched);
  gh_text_print(r->history, "\n");
}

size_t scene_history_row(scene_results *r, const scene_frame *f) {
  size_t numbers;
  gh_text *t = r->history;
  gh_text_print(t, "%d,%d,", f->counter, f->increment);
  for (const char *c = f->name; *c; c++)
    gh_text_print(t, "%c", *c == ',' || *c == '"' || *c == '\n' ? '_' : *c);
  gh_text_print(t, ",%d,%.17g", f->step, f->time);
  history_loads(r->scene, t, false);
  gh_text_get(t, &numbers);
  for (int set = 0; set < r->scene->nsets; set++) {
    double sum[2];
    gh_macro_reaction(r->macro, set, sum);
    gh_text_print(t, ",%.17g,%.17g", sum[0], sum[1]);
  }
  history_footings(r);
  double V, v;
  const gh_macro_report *m = f->report;
  gh_macro_volumes(r->macro, &V, &v);
  gh_farm_counts now, *before = &r->counted;
  gh_farm_count(r->farm, &now);
  gh_text_print(t, ",%.17g,%d,%d,%d,%d,%d,%.17g,%.17g,%ld,%ld,%ld", 100 * (v / V - 1), m->iterations,
                m->substeps, m->cuts, m->jumps, r->unjammed, r->min_acoustic, m->relative,
                now.evaluations - before->evaluations, now.steps - before->steps,
                now.factorisations - before->factorisations);
  history_errors(r, f);
  gh_text_print(r->timing, "%d,%.17g,%.17g,%ld,%ld,%ld,%d\n", f->counter, m->seconds, m->micro_seconds,
                now.evaluations - before->evaluations, now.computed - before->computed,
                now.moved - before->moved, now.ranks);
  r->counted = now;
  return numbers;
}

void scene_results_iteration(scene_results *r, int counter, const gh_macro_iteration *it) {
  gh_text_print(r->convergence, "%d,%d,%d,%.17g,%.17g,%.17g,%.17g,%.17g\n", counter, it->substep,
                it->iteration, it->residual, it->relative, it->first, it->step, it->seconds);
}
