/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The macro problem: options, object, what it gives. */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

gh_macro_options gh_macro_defaults(void) {
  return (gh_macro_options){.tolerance = 1e-8,
                            .max_iterations = 20,
                            .cut_steps = 6,
                            .line_search = true,
                            .memory = 1,
                            .pass_jumps = true,
                            .damping_ratio = 1,
                            .safety = 0.5};
}

static const char *const method_names[] = {"newton", "relaxation", "automatic"};

bool gh_macro_method_from_name(const char *name, gh_macro_method *method) {
  for (int k = 0; k < 3; k++)
    if (!strcmp(name, method_names[k])) return *method = (gh_macro_method)k, true;
  return false;
}

const char *gh_macro_method_name(gh_macro_method method) {
  return method_names[method];
}

static const char *const tangent_names[] = {"algorithmic", "symmetrised", "frozen", "elastic"};

bool gh_tangent_from_name(const char *name, gh_tangent *tangent) {
  for (int k = 0; k < 4; k++)
    if (!strcmp(name, tangent_names[k])) return *tangent = (gh_tangent)k, true;
  return false;
}

const char *gh_tangent_name(gh_tangent tangent) {
  return tangent_names[tangent];
}

void gh_macro_allow_cuts(gh_macro *m, int cut_steps) {
  m->options.cut_steps = cut_steps < 0 ? 0 : cut_steps > 40 ? 40 : cut_steps;
}

static gh_status options_check(gh_context *ctx, const gh_macro_options *o) {
  if (!(o->tolerance > 0 && o->tolerance < 1))
    return gh_fail(ctx, GH_INPUT, "solver: tolerance %g must lie between 0 and 1", o->tolerance);
  if (o->memory < 1 || o->memory > GH_MACRO_MEMORY)
    return gh_fail(ctx, GH_INPUT, "solver: search_memory %d must be from 1 to %d", o->memory,
                   GH_MACRO_MEMORY);
  if (!(o->memory_above >= 0))
    return gh_fail(ctx, GH_INPUT, "solver: memory_above %g is negative", o->memory_above);
  if (o->max_iterations < 1)
    return gh_fail(ctx, GH_INPUT, "solver: max_iterations %d must be at least 1", o->max_iterations);
  if (o->cut_steps < 0 || o->cut_steps > 40)
    return gh_fail(ctx, GH_INPUT, "solver: cut_steps %d must lie between 0 and 40", o->cut_steps);
  if (o->tangent < GH_TANGENT_ALGORITHMIC || o->tangent > GH_TANGENT_ELASTIC)
    return gh_fail(ctx, GH_INPUT, "solver: there is no tangent %d", (int)o->tangent);
  return gh_relax_check(ctx, o);
}

static gh_status macro_allocate(gh_macro *m) {
  double **vectors[] = {&m->reaction, &m->f0,   &m->force,         &m->from,
                        &m->fade,     &m->fext, &m->instability.u, &m->swing.u};
  double **longer[] = {&m->residual, &m->trial,
                       &m->du}; /* a footing has two nodes at least: four for three */
  GH_TRY(gh_shapes_create(m->ctx, m->mesh, &m->shapes));
  GH_TRY(gh_system_create(m->ctx, m->mesh, &m->system));
  GH_TRY(gh_state_create(m, &m->eq));
  GH_TRY(gh_state_create(m, &m->now));
  GH_TRY(gh_state_create(m, &m->next));
  for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
    GH_TRY(gh_alloc(m->ctx, (size_t)m->ndof, sizeof(double), vectors[k]));
  if (m->options.tangent == GH_TANGENT_ELASTIC)
    GH_TRY(gh_alloc(m->ctx, 16 * (size_t)m->npoints, sizeof *m->elastic, &m->elastic));
  for (size_t k = 0; k < sizeof longer / sizeof *longer; k++)
    GH_TRY(gh_alloc(m->ctx, 2 * (size_t)m->ndof, sizeof(double), longer[k]));
  if (m->options.method != GH_METHOD_NEWTON) GH_TRY(gh_relax_allocate(m));
  gh_instability_forget(&m->instability);
  gh_instability_forget(&m->swing);
  double V, v;
  gh_macro_volumes(m, &V, &v);
  m->length = sqrt(V / m->mesh->nelements);
  return GH_OK;
}

gh_status gh_macro_create(gh_context *ctx, const gh_mesh *mesh, gh_farm *farm,
                          const gh_macro_options *options, gh_macro **macro) {
  *macro = NULL;
  GH_TRY(options_check(ctx, options));
  GH_TRY(gh_mesh_check(ctx, mesh));
  if (gh_farm_size(farm) != 4 * mesh->nelements)
    return gh_fail(ctx, GH_INPUT, "%d material points for %d elements; four each are needed",
                   gh_farm_size(farm), mesh->nelements);
  GH_TRY(gh_alloc(ctx, 1, sizeof **macro, macro));
  gh_macro *m = *macro;
  m->ctx = ctx;
  m->mesh = mesh;
  m->farm = farm;
  m->options = *options;
  m->ndof = 2 * mesh->nnodes;
  m->npoints = 4 * mesh->nelements;
  gh_status status = macro_allocate(m);
  if (status != GH_OK) gh_macro_destroy(macro);
  return status;
}

void gh_macro_destroy(gh_macro **macro) {
  if (!macro || !*macro) return;
  gh_macro *m = *macro;
  gh_estimate_free(m);
  gh_shapes_destroy(&m->shapes);
  gh_system_destroy(&m->system);
  gh_state_destroy(&m->eq);
  gh_state_destroy(&m->now);
  gh_state_destroy(&m->next);
  free(m->reaction);
  free(m->f0);
  free(m->force);
  free(m->follow.edge);
  free(m->footing);
  free(m->owner);
  free(m->from);
  free(m->fade);
  free(m->fext);
  free(m->residual);
  free(m->trial);
  free(m->du);
  free(m->instability.u);
  free(m->swing.u);
  free(m->elastic);
  free(m->relax.numbers);
  free(m);
  *macro = NULL;
}

void gh_macro_set_watch(gh_macro *m, gh_macro_watch *watch, void *data) {
  m->watch = watch;
  m->watch_data = data;
}

const double *gh_macro_u(const gh_macro *m) {
  return m->eq.u;
}
const double *gh_macro_F(const gh_macro *m) {
  return m->eq.F;
}
const double *gh_macro_P(const gh_macro *m) {
  return m->eq.P;
}
const double *gh_macro_A(const gh_macro *m) {
  return m->options.method == GH_METHOD_RELAXATION ? NULL : m->eq.A;
}
const double *gh_macro_reactions(const gh_macro *m) {
  return m->reaction;
}

void gh_macro_reaction(const gh_macro *m, int set, double sum[2]) {
  sum[0] = sum[1] = 0;
  if (set < 0 || set >= m->mesh->nsets) return;
  const gh_mesh_set *s = m->mesh->sets + set;
  for (int k = 0; k < s->nnodes; k++)
    for (int i = 0; i < 2; i++) sum[i] += m->reaction[2 * s->nodes[k] + i];
}

void gh_macro_volumes(const gh_macro *m, double *V, double *v) {
  *V = *v = 0; /* the rule is exact for det F of a bilinear element */
  for (int p = 0; p < m->npoints; p++) {
    *V += m->shapes.weight[p];
    *v += m->shapes.weight[p] * gh_det2(m->eq.F + 4 * (size_t)p);
  }
}
