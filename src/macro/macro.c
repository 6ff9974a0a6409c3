/* The macro problem: object, evaluation, initial stress, state. SPDX-License-Identifier: GPL-2.0-or-later */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

gh_macro_options gh_macro_defaults(void) {
  return (gh_macro_options){.tolerance = 1e-8,
                            .max_iterations = 20,
                            .cut_steps = 6,
                            .line_search = true,
                            .memory = 1,
                            .pass_jumps = true};
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

static gh_status check_options(gh_context *ctx, const gh_macro_options *o) {
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
  return GH_OK;
}

static gh_status state_create(const gh_macro *m, gh_state *s) {
  size_t n = (size_t)m->npoints;
  GH_TRY(gh_alloc(m->ctx, (size_t)m->ndof, sizeof *s->u, &s->u));
  GH_TRY(gh_alloc(m->ctx, 4 * n, sizeof *s->F, &s->F));
  GH_TRY(gh_alloc(m->ctx, 4 * n, sizeof *s->P, &s->P));
  GH_TRY(gh_alloc(m->ctx, 16 * n, sizeof *s->A, &s->A));
  GH_TRY(gh_alloc(m->ctx, (size_t)m->ndof, sizeof *s->fint, &s->fint));
  for (size_t p = 0; p < n; p++) s->F[4 * p] = s->F[4 * p + 3] = 1;
  return GH_OK;
}

static void state_destroy(gh_state *s) {
  free(s->u);
  free(s->F);
  free(s->P);
  free(s->A);
  free(s->fint);
}

void gh_state_copy(const gh_macro *m, const gh_state *from, gh_state *to) {
  size_t n = (size_t)m->npoints, d = (size_t)m->ndof;
  memcpy(to->u, from->u, d * sizeof *to->u);
  memcpy(to->F, from->F, 4 * n * sizeof *to->F);
  memcpy(to->P, from->P, 4 * n * sizeof *to->P);
  memcpy(to->A, from->A, 16 * n * sizeof *to->A);
  memcpy(to->fint, from->fint, d * sizeof *to->fint);
}

void gh_state_swap(gh_state *a, gh_state *b) {
  gh_state c = *a;
  *a = *b;
  *b = c;
}

static gh_status fill(gh_macro *m) {
  double **vectors[] = {&m->reaction, &m->f0, &m->force, &m->from, &m->fade, &m->fext, &m->jump.u};
  double **longer[] = {&m->residual, &m->trial,
                       &m->du}; /* a footing has two nodes at least: four for three */
  GH_TRY(gh_shapes_create(m->ctx, m->mesh, &m->shapes));
  GH_TRY(gh_system_create(m->ctx, m->mesh, &m->system));
  GH_TRY(state_create(m, &m->eq));
  GH_TRY(state_create(m, &m->now));
  GH_TRY(state_create(m, &m->next));
  for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
    GH_TRY(gh_alloc(m->ctx, (size_t)m->ndof, sizeof(double), vectors[k]));
  if (m->options.tangent == GH_TANGENT_ELASTIC)
    GH_TRY(gh_alloc(m->ctx, 16 * (size_t)m->npoints, sizeof *m->elastic, &m->elastic));
  for (size_t k = 0; k < sizeof longer / sizeof *longer; k++)
    GH_TRY(gh_alloc(m->ctx, 2 * (size_t)m->ndof, sizeof(double), longer[k]));
  gh_jump_forget(&m->jump);
  double V, v;
  gh_macro_volumes(m, &V, &v);
  m->length = sqrt(V / m->mesh->nelements);
  return GH_OK;
}

gh_status gh_macro_create(gh_context *ctx, const gh_mesh *mesh, gh_farm *farm,
                          const gh_macro_options *options, gh_macro **macro) {
  *macro = NULL;
  GH_TRY(check_options(ctx, options));
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
  gh_status status = fill(m);
  if (status != GH_OK) gh_macro_destroy(macro);
  return status;
}

void gh_macro_destroy(gh_macro **macro) {
  if (!macro || !*macro) return;
  gh_macro *m = *macro;
  gh_estimate_free(m);
  gh_shapes_destroy(&m->shapes);
  gh_system_destroy(&m->system);
  state_destroy(&m->eq);
  state_destroy(&m->now);
  state_destroy(&m->next);
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
  free(m->jump.u);
  free(m->elastic);
  free(m);
  *macro = NULL;
}

void gh_macro_set_watch(gh_macro *m, gh_macro_watch *watch, void *data) {
  m->watch = watch;
  m->watch_data = data;
}

const char *gh_dof_name(const gh_mesh *mesh, int dof, char text[96]) {
  int a = dof / 2;
  snprintf(text, 96, "node %d at (%g, %g) in %c", a, mesh->X[2 * a], mesh->X[2 * a + 1], "xy"[dof % 2]);
  return text;
}

/* An element whose corner is turned inside out lies on itself, even where det F > 0 at its four points: a
 * body of grains that has lost its contacts would be flung there without resistance. */
static gh_status check_corners(gh_macro *m, const gh_state *s) {
  for (int e = 0; e < m->mesh->nelements; e++) {
    double x[4][2];
    for (int a = 0; a < 4; a++)
      for (int i = 0; i < 2; i++) {
        int d = 2 * m->mesh->quad[e][a] + i;
        x[a][i] = m->mesh->X[d] + s->u[d];
      }
    if (!gh_quad_convex((const double(*)[2])x))
      return gh_fail(m->ctx, GH_DIVERGED, "a corner of element %d is turned inside out", e);
  }
  return GH_OK;
}

/* F of all points; a displacement that is not finite or turns an element inside out is caught here. */
static gh_status deform(gh_macro *m, gh_state *s) {
  for (int d = 0; d < m->ndof; d++) {
    char name[96];
    if (!isfinite(s->u[d]))
      return gh_fail(m->ctx, GH_DIVERGED, "the displacement of %s is %g", gh_dof_name(m->mesh, d, name),
                     s->u[d]);
  }
  for (int e = 0; e < m->mesh->nelements; e++)
    gh_element_deformation(&m->shapes, m->mesh, e, s->u, s->F + 16 * e);
  for (int p = 0; p < m->npoints; p++) {
    double J = gh_det2(s->F + 4 * (size_t)p);
    if (!(J > 0) || !isfinite(J))
      return gh_fail(m->ctx, GH_DIVERGED,
                     "integration point %d of element %d is turned inside out (det F = %g)", p, p / 4, J);
  }
  return check_corners(m, s);
}

static gh_status check_material(gh_macro *m, const gh_state *s) {
  for (int p = 0; p < m->npoints; p++) {
    const char *what = !gh_finite(s->P + 4 * (size_t)p, 4)     ? "stress"
                       : !gh_finite(s->A + 16 * (size_t)p, 16) ? "tangent"
                                                               : NULL;
    if (what) return gh_fail(m->ctx, GH_DIVERGED, "the %s of integration point %d is not finite", what, p);
  }
  return GH_OK;
}

static gh_status evaluate(gh_macro *m, gh_state *s, unsigned want) {
  GH_TRY(deform(m, s));
  double start = gh_seconds();
  gh_status status = gh_farm_evaluate(m->farm, s->F, want, s->P, s->A);
  m->micro_seconds += gh_seconds() - start;
  GH_TRY(status);
  GH_TRY(check_material(m, s));
  memset(s->fint, 0, (size_t)m->ndof * sizeof *s->fint);
  for (int e = 0; e < m->mesh->nelements; e++) {
    double f[8];
    gh_element_force(&m->shapes, e, s->P + 16 * e, f);
    for (int k = 0; k < 8; k++) s->fint[2 * m->mesh->quad[e][k / 2] + k % 2] += f[k];
  }
  return GH_OK;
}

gh_status gh_macro_evaluate(gh_macro *m, gh_state *s) {
  return evaluate(m, s, GH_WANT_TANGENT);
}

/* Points of other kinds than RVEs may write a tangent that was not wanted. */
gh_status gh_macro_evaluate_stress(gh_macro *m, gh_state *s, const gh_state *tangents) {
  const size_t bytes = 16 * (size_t)m->npoints * sizeof *s->A;
  memcpy(s->A, tangents->A, bytes);
  gh_status status = evaluate(m, s, 0);
  memcpy(s->A, tangents->A, bytes);
  return status;
}

gh_status gh_macro_start(gh_macro *m) {
  if (m->started) return GH_OK;
  gh_status status = gh_macro_evaluate(m, &m->eq);
  if (status != GH_OK) return gh_prefix(m->ctx, status, "stress at the start (u = 0): ");
  if (m->elastic) memcpy(m->elastic, m->eq.A, 16 * (size_t)m->npoints * sizeof *m->elastic);
  m->started = true;
  gh_energy_begin(m);
  return GH_OK;
}

gh_status gh_macro_balance(gh_macro *m) {
  if (m->solved)
    return gh_fail(m->ctx, GH_INPUT, "the initial stress is balanced before the first increment, not after");
  GH_TRY(gh_macro_start(m));
  memcpy(m->f0, m->eq.fint, (size_t)m->ndof * sizeof *m->f0);
  return GH_OK;
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
  return m->eq.A;
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
