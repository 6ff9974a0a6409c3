/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A scene as a run of a study: nothing is written, the response of the body is measured after each
 * increment. */
#include "granhom/macro.h"
#include "study/parts.h"

#include <string.h>

enum { COLUMNS = 7 };

typedef struct body {
  study_problem *p;
  study_run *run;
  const gh_macro *macro;
  gh_scene_loading loading; /* of the set whose response is measured; -1: all nodes */
  int set;
  size_t capacity;
} body;

/* Mean of P over the reference area. */
static void body_stress(const body *b, double P[4]) {
  const gh_mesh *mesh = gh_scene_mesh(b->p->scene);
  const double *all = gh_macro_P(b->macro);
  double area = 0;
  memset(P, 0, 4 * sizeof *P);
  for (int e = 0; e < mesh->nelements; e++) {
    double x[4][2], grad[4][2], weight;
    for (int a = 0; a < 4; a++) memcpy(x[a], mesh->X + 2 * mesh->quad[e][a], sizeof x[a]);
    for (int g = 0; g < 4; g++) {
      gh_shape_gradients((const double(*)[2])x, g, grad, &weight);
      for (int c = 0; c < 4; c++) P[c] += weight * all[4 * (4 * e + g) + c];
      area += weight;
    }
  }
  for (int c = 0; c < 4; c++) P[c] /= area;
}

/* Mean displacement of the set, at the footing that of its point of load application. */
static void body_settlement(const body *b, double mean[2]) {
  const gh_mesh *mesh = gh_scene_mesh(b->p->scene);
  const gh_mesh_set *set = b->set >= 0 ? mesh->sets + b->set : NULL;
  const double *u = gh_macro_u(b->macro);
  const int n = set ? set->nnodes : mesh->nnodes;
  double rotation;
  mean[0] = mean[1] = 0;
  if (b->loading == GH_LOADING_FOOTING) {
    gh_macro_footing(b->macro, b->set, mean, &rotation);
    return;
  }
  for (int k = 0; k < n; k++)
    for (int i = 0; i < 2; i++) mean[i] += u[2 * (set ? set->nodes[k] : k) + i] / n;
}

static gh_status body_measure(void *data, int step, int increment, int increments, const gh_macro *macro) {
  body *b = data;
  double value[COLUMNS], V, v, t = step == 0 ? 0 : step - 1 + (double)increment / increments;
  b->macro = macro;
  body_stress(b, value);
  if (b->loading == GH_LOADING_DISPLACEMENT) gh_macro_reaction(macro, b->set, value + 4);
  else body_settlement(b, value + 4);
  gh_macro_volumes(macro, &V, &v);
  value[6] = 100 * (v / V - 1);
  return study_curve_add(b->p->ctx, &b->run->curve, &b->capacity, COLUMNS, t, value);
}

gh_status study_scene_run(study_problem *p, const study_stop *stop, study_run *run) {
  body b = {.p = p, .run = run};
  b.loading = gh_scene_last_loading(p->scene, &b.set);
  gh_run_summary sum = {0};
  gh_run_options options = {.stop = stop ? stop->asked : NULL,
                            .stop_data = stop ? stop->data : NULL,
                            .observe = body_measure,
                            .observe_data = &b};
  gh_status status = gh_scene_run(p->scene, NULL, &options, &sum);
  run->force_evaluations = sum.cost.steps;
  run->pair_evaluations = sum.cost.pairs;
  run->factorisations = sum.cost.factorisations;
  run->evaluations = sum.cost.evaluations;
  run->iterations = sum.iterations;
  run->cuts = sum.cuts;
  run->jumps = sum.jumps;
  if (sum.increments > 0) {
    run->residual = sum.energy.residual;
    run->energy_defect = gh_energy_defect(&sum.energy);
  }
  return status;
}
