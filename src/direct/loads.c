/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Loads of the mesh as those of its boundary grains. */
#include "direct/internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- supports and driven displacements ---- */

/* Change of the displacement that the loads prescribe at a node; 0 where they prescribe none. */
static double node_change(const gh_direct *d, const gh_direct_loads *loads, int dof) {
  return loads->fixed[dof] ? loads->value[dof] - d->u[dof] : 0;
}

/* Mean gradient of that change. */
static gh_status mean_gradient(const gh_direct *d, const gh_direct_loads *loads, double G[4]) {
  double *change;
  GH_TRY(gh_alloc(d->ctx, 2 * (size_t)d->mesh->nnodes, sizeof *change, &change));
  for (int dof = 0; dof < 2 * d->mesh->nnodes; dof++) change[dof] = node_change(d, loads, dof);
  outline_gradient(&d->outline, change, G);
  free(change);
  return GH_OK;
}

/* A grain off the outline follows it with the mean gradient. */
static void component_fix(direct_plan *p, int grain, int i, double change, const double offset[2],
                          const double G[4]) {
  const unsigned char bit = i ? GH_FIXED_Y : GH_FIXED_X;
  if (p->mask[grain] & bit) return;
  p->mask[grain] |= bit;
  p->step[2 * grain + i] = change + G[2 * i] * offset[0] + G[2 * i + 1] * offset[1];
}

/* Prescribed components of a grain on an edge, at a share of it. */
static void member_fix(const gh_direct *d, const gh_direct_loads *loads, const chain_member *m,
                       const double G[4], direct_plan *p) {
  const outline_edge *e = d->outline.edge + m->edge;
  for (int i = 0; i < 2; i++) {
    if (!loads->fixed[2 * e->a + i] || !loads->fixed[2 * e->b + i]) continue;
    const double change =
        (1 - m->share) * node_change(d, loads, 2 * e->a + i) + m->share * node_change(d, loads, 2 * e->b + i);
    component_fix(p, m->grain, i, change, m->offset, G);
  }
}

/* Edges both of whose nodes are prescribed. covered: 2 nnodes. */
static void edges_fix(const gh_direct *d, const gh_direct_loads *loads, const double G[4], direct_plan *p,
                      bool *covered) {
  for (int k = 0; k < d->outline.nedges; k++) {
    const outline_edge *e = d->outline.edge + k;
    for (int i = 0; i < 2; i++)
      if (loads->fixed[2 * e->a + i] && loads->fixed[2 * e->b + i])
        covered[2 * e->a + i] = covered[2 * e->b + i] = true;
  }
  for (int k = 0; k < d->chain.nmembers; k++) member_fix(d, loads, d->chain.member + k, G, p);
}

static bool edge_holds(const gh_direct *d, const gh_direct_loads *loads, int edge) {
  const outline_edge *e = d->outline.edge + edge;
  return (loads->fixed[2 * e->a] && loads->fixed[2 * e->b]) ||
         (loads->fixed[2 * e->a + 1] && loads->fixed[2 * e->b + 1]);
}

/* The outline goes where the grains around its nodes are. */
static void outline_expose(gh_direct *d, const double *x) {
  for (int k = 0; k < d->exposed.nedges; k++) {
    const int a = d->exposed.edge[k].a; /* each node of the outline is the first of an edge */
    double u[2];
    direct_fit(d, x, a, u);
    for (int i = 0; i < 2; i++) d->moved.X[2 * a + i] = d->mesh->X[2 * a + i] + u[i];
  }
  outline_move(&d->exposed);
}

/* Grains that have come between those of a support are held by it, too, from now on. */
static gh_status exposed_join(gh_direct *d, const gh_direct_loads *loads, const double G[4], direct_plan *p) {
  gh_packing now = *d->body;
  chain c;
  now.x = d->now.x;
  outline_expose(d, d->now.x);
  gh_status status = chain_create(d->ctx, &d->exposed, &now, &c);
  for (int k = 0; k < c.nmembers && status == GH_OK; k++) {
    const chain_member *m = c.member + k;
    if (edge_holds(d, loads, m->edge) && !d->boundary[m->grain]) d->joined[m->grain] = m->edge + 1;
  }
  for (int k = 0; k < c.nmembers && status == GH_OK; k++)
    if (d->joined[c.member[k].grain] == c.member[k].edge + 1) member_fix(d, loads, c.member + k, G, p);
  chain_destroy(&c);
  return status;
}

/* Single nodes hold the boundary grain that is nearest. */
static void nodes_fix(const gh_direct *d, const gh_direct_loads *loads, const double G[4], direct_plan *p,
                      const bool *covered) {
  for (int dof = 0; dof < 2 * d->mesh->nnodes; dof++) {
    if (!loads->fixed[dof] || covered[dof]) continue;
    const int grain = d->nearest[dof / 2];
    const double *A = d->mesh->X + dof / 2 * 2, *X = d->body->x + 2 * grain;
    component_fix(p, grain, dof % 2, node_change(d, loads, dof), (const double[2]){X[0] - A[0], X[1] - A[1]},
                  G);
  }
}

/* Free components follow the mean gradient, about the mean of what is prescribed. */
static void guess_free(const gh_direct *d, const double G[4], direct_plan *p) {
  for (int i = 0; i < 2; i++) {
    const unsigned char bit = i ? GH_FIXED_Y : GH_FIXED_X;
    double at[2] = {0, 0}, mean = 0;
    int count = 0;
    for (int q = 0; q < d->n; q++) {
      if (!(p->mask[q] & bit)) continue;
      for (int j = 0; j < 2; j++) at[j] += d->body->x[2 * q + j];
      mean += p->step[2 * q + i];
      count++;
    }
    for (int j = 0; j < 2 && count; j++) at[j] /= count;
    for (int q = 0; q < d->n; q++) {
      const double *X = d->body->x + 2 * q;
      if (p->mask[q] & bit) continue;
      p->step[2 * q + i] =
          (count ? mean / count : 0) + G[2 * i] * (X[0] - at[0]) + G[2 * i + 1] * (X[1] - at[1]);
    }
  }
}

static gh_status supports_make(gh_direct *d, const gh_direct_loads *loads, direct_plan *p) {
  double G[4];
  bool *covered;
  GH_TRY(mean_gradient(d, loads, G));
  GH_TRY(gh_alloc(d->ctx, 2 * (size_t)d->mesh->nnodes, sizeof *covered, &covered));
  edges_fix(d, loads, G, p, covered);
  nodes_fix(d, loads, G, p, covered);
  const gh_status status = d->solved ? exposed_join(d, loads, G, p) : GH_OK;
  guess_free(d, G, p);
  p->strain = hypot(hypot(G[0], G[1]), hypot(G[2], G[3]));
  free(covered);
  return status;
}

/* ---- forces ---- */

/* The edge of the outline between two nodes; -1: it is none. */
static int outline_find(const outline *o, int a, int b) {
  for (int k = 0; k < o->nedges; k++)
    if (o->edge[k].a == a && o->edge[k].b == b) return k;
  return -1;
}

/* Pressures of the sets on the edges of the outline: dead and following. */
static void pressures_take(const gh_direct *d, const gh_direct_loads *loads, double *dead, double *follow) {
  for (int set = 0; set < d->nsets; set++) {
    const gh_mesh_set *s = d->mesh->sets + set;
    if (loads->dead[set] == 0 && loads->follow[set] == 0) continue;
    for (int k = 0; k < s->nedges; k++) {
      const int e = outline_find(&d->outline, s->edges[k][0], s->edges[k][1]);
      if (e < 0) continue;
      dead[e] += loads->dead[set];
      follow[e] += loads->follow[set];
    }
  }
}

static bool set_has_edge(const gh_mesh_set *s, const outline_edge *e) {
  for (int k = 0; k < s->nedges; k++)
    if (s->edges[k][0] == e->a && s->edges[k][1] == e->b) return true;
  return false;
}

/* The force of a set over the length that its grains bear; of a set without edges, over the grains at its nodes. */
static void set_force_add(const gh_direct *d, int set, const double force[2], double *f) {
  const gh_mesh_set *s = d->mesh->sets + set;
  double length = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < d->chain.npieces; k++) {
      const chain_piece *q = d->chain.piece + k;
      if (!set_has_edge(s, d->outline.edge + q->edge)) continue;
      if (!pass) length += q->length;
      const int grain = d->chain.member[q->member].grain;
      for (int i = 0; i < 2 && pass; i++) f[2 * grain + i] += force[i] * q->length / length;
    }
  for (int k = 0; k < s->nnodes && length == 0; k++)
    for (int i = 0; i < 2; i++) f[2 * d->nearest[s->nodes[k]] + i] += force[i] / s->nnodes;
}

static void dead_make(const gh_direct *d, const gh_direct_loads *loads, double *f) {
  memcpy(f, d->kept, 2 * (size_t)d->n * sizeof *f);
  for (int q = 0; q < d->n; q++)
    for (int i = 0; i < 2; i++) f[2 * q + i] += loads->gravity[i] * d->weight[q];
  for (int set = 0; set < d->nsets; set++) {
    const double *force = loads->force + 2 * set;
    if (force[0] != 0 || force[1] != 0) set_force_add(d, set, force, f);
  }
}

static gh_status pressures_add(gh_direct *d, const double *pressure, const double *follow, double *x,
                               double *f) {
  gh_packing now = *d->body;
  chain c;
  now.x = x;
  outline_expose(d, x);
  gh_status status = chain_create(d->ctx, &d->exposed, &now, &c);
  for (int k = 0; k < c.npieces && status == GH_OK; k++) {
    const chain_piece *q = c.piece + k;
    const outline_edge *e = d->exposed.edge + q->edge, *reference = d->outline.edge + q->edge;
    const double share = q->length / e->length;
    double *to = f + 2 * c.member[q->member].grain;
    for (int i = 0; i < 2; i++)
      to[i] -= share * (pressure[q->edge] * reference->length * reference->outward[i] +
                        follow[q->edge] * e->length * e->outward[i]);
  }
  chain_destroy(&c);
  return status;
}

gh_status direct_plan_forces(gh_direct *d, const direct_plan *p, double t, double *x, double *f,
                             bool *exposed) {
  const int n = d->outline.nedges;
  double *pressure = p->pressure + n, *follow = p->follow + n;
  *exposed = false;
  for (int k = 0; k < 2 * d->n; k++) f[k] = (1 - t) * (d->dead[k] + p->fade[k]) + t * p->dead[k];
  for (int k = 0; k < n; k++) {
    pressure[k] = (1 - t) * d->pressure_dead[k] + t * p->pressure[k];
    follow[k] = (1 - t) * d->follow[k] + t * p->follow[k];
    *exposed = *exposed || pressure[k] != 0 || follow[k] != 0;
  }
  return *exposed ? pressures_add(d, pressure, follow, x, f) : GH_OK;
}

/* ---- the plan ---- */

gh_status direct_plan_allocate(gh_direct *d, direct_plan *p) {
  const size_t n = (size_t)d->n, edges = (size_t)d->outline.nedges;
  *p = (direct_plan){0};
  GH_TRY(gh_alloc(d->ctx, n, 1, &p->mask));
  GH_TRY(gh_alloc(d->ctx, 2 * n, sizeof(double), &p->step));
  GH_TRY(gh_alloc(d->ctx, 2 * n, sizeof(double), &p->dead));
  GH_TRY(gh_alloc(d->ctx, 2 * n, sizeof(double), &p->fade));
  GH_TRY(gh_alloc(d->ctx, 2 * edges, sizeof(double), &p->pressure)); /* the second half is work */
  return gh_alloc(d->ctx, 2 * edges, sizeof(double), &p->follow);
}

/* Strain that the change of the loads may bring: pressures, and forces over the width of a grain. */
static double loads_strain(const gh_direct *d, const direct_plan *p) {
  const double width = 2 * d->mean_radius;
  double most = 0;
  for (int q = 0; q < 2 * d->n; q++) most = fmax(most, fabs(p->dead[q] - d->dead[q] - p->fade[q]) / width);
  for (int k = 0; k < d->outline.nedges; k++)
    most = fmax(most, fabs(p->pressure[k] - d->pressure_dead[k]) + fabs(p->follow[k] - d->follow[k]));
  return most / d->options.law.normal_stiffness;
}

/* At the start pressed edges have the packing's own pressure, in the place of what has held the boundary. */
static void pressures_begin(gh_direct *d, direct_plan *p) {
  bool any = false;
  for (int k = 0; k < d->outline.nedges; k++) {
    d->pressure_dead[k] = p->pressure[k] != 0 && p->follow[k] == 0 ? d->pressure : 0;
    d->follow[k] = p->follow[k] != 0 ? d->pressure : 0;
    any = any || p->pressure[k] != 0 || p->follow[k] != 0;
  }
  if (any) memset(p->fade, 0, 2 * (size_t)d->n * sizeof *p->fade);
}

gh_status direct_plan_create(gh_direct *d, const gh_direct_loads *loads, direct_plan *p) {
  GH_TRY(direct_plan_allocate(d, p));
  GH_TRY(supports_make(d, loads, p));
  pressures_take(d, loads, p->pressure, p->follow);
  dead_make(d, loads, p->dead);
  for (int q = 0; q < 2 * d->n; q++) {
    const unsigned char bit = q % 2 ? GH_FIXED_Y : GH_FIXED_X;
    if ((d->mask[q / 2] & bit) && !(p->mask[q / 2] & bit)) p->fade[q] = d->reaction[q];
  }
  if (!d->solved) pressures_begin(d, p);
  p->strain += loads_strain(d, p);
  return GH_OK;
}

void direct_plan_destroy(direct_plan *p) {
  free(p->mask);
  free(p->step);
  free(p->dead);
  free(p->fade);
  free(p->pressure);
  free(p->follow);
  *p = (direct_plan){0};
}
