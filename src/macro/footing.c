/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Rigid massless footings: three unknowns that the nodes under them follow.
 *
 * A footing moves by dc and rotates by an angle, exactly: x_a' = c + dc + Q (x_a - c), c the middle between
 * the ends of its edge. Unknowns are q = (dc, phi), phi the angle times half the length of the edge, so that
 * all three are lengths. Nodal residuals R_a (internal minus external forces without the footing's own load)
 * give R_q = (sum R_a - f, (sum r_a x R_a - r_p x f)/h),  r = x - c, and the tangent is T' K T with du_a =
 * T_a dq = dc + phi/h e_z x r_a, plus the rotation of the arms,
 * (-sum r_a . R_a + r_p . f)/h^2, at the place of phi. Sums of forces and moments balance exactly then.
 *
 * Nothing is stored from increment to increment: that the nodes are rigidly connected is in their positions,
 * and the point where the force acts follows the two ends of the edge. */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

/* Nodes of a straight edge lie within this share of its length on the line. */
static const double straight = 1e-6;

/* ---- geometry ---- */

static double vector_cross(const double a[2], const double b[2]) {
  return a[0] * b[1] - a[1] * b[0];
}

/* The two nodes of a set that are farthest apart along its line, towards growing x (y where it is upright),
 * and the vector between them. */
static void footing_find_ends(const gh_mesh *mesh, const gh_mesh_set *set, int end[2], double along[2]) {
  const double *X = mesh->X;
  int far = set->nodes[0];
  for (int pass = 0; pass < 2; pass++) {
    const double *from = X + 2 * far;
    int next = far;
    for (int k = 0; k < set->nnodes; k++) {
      const double *x = X + 2 * set->nodes[k], *y = X + 2 * next;
      if (hypot(x[0] - from[0], x[1] - from[1]) > hypot(y[0] - from[0], y[1] - from[1])) next = set->nodes[k];
    }
    end[pass] = far = next;
  }
  for (int i = 0; i < 2; i++) along[i] = X[2 * end[1] + i] - X[2 * end[0] + i];
  bool upright = fabs(along[0]) <= straight * fabs(along[1]);
  if (upright ? along[1] > 0 : along[0] > 0) return;
  int swap = end[0];
  end[0] = end[1], end[1] = swap;
  for (int i = 0; i < 2; i++) along[i] = -along[i];
}

void gh_footing_point(const gh_mesh *mesh, int set, double eccentricity, double at[2]) {
  int end[2];
  double along[2];
  footing_find_ends(mesh, mesh->sets + set, end, along);
  double length = hypot(along[0], along[1]);
  for (int i = 0; i < 2; i++)
    at[i] = 0.5 * (mesh->X[2 * end[0] + i] + mesh->X[2 * end[1] + i]) + eccentricity * along[i] / length;
}

/* Where the ends are now: the middle, and the map S = [a -b; b a] of reference arms about the middle to
 * present ones (a rotation; also a stretch where the footing was put on ground that had moved). */
typedef struct frame {
  double c[2], a, b;
} frame;

static frame frame_find(const gh_mesh *mesh, const int end[2], const double *u) {
  double D[2], d[2];
  frame f;
  for (int i = 0; i < 2; i++) {
    double X[2], x[2];
    for (int k = 0; k < 2; k++) {
      X[k] = mesh->X[2 * end[k] + i];
      x[k] = X[k] + u[2 * end[k] + i];
    }
    f.c[i] = 0.5 * (x[0] + x[1]);
    D[i] = X[1] - X[0];
    d[i] = x[1] - x[0];
  }
  double square = D[0] * D[0] + D[1] * D[1];
  f.a = (D[0] * d[0] + D[1] * d[1]) / square;
  f.b = vector_cross(D, d) / square;
  return f;
}

static void frame_find_arm(const gh_mesh *mesh, const frame *f, const double *u, int node, double r[2]) {
  for (int i = 0; i < 2; i++) r[i] = mesh->X[2 * node + i] + u[2 * node + i] - f->c[i];
}

void gh_footing_move(const gh_mesh *mesh, const gh_footing *f, const double dq[3], const double *u,
                     double *moved) {
  frame here = frame_find(mesh, f->end, u);
  double angle = dq[2] / f->half, c = cos(angle), s = sin(angle);
  for (int k = 0; k < f->set->nnodes; k++) {
    int node = f->set->nodes[k];
    double r[2];
    frame_find_arm(mesh, &here, u, node, r);
    /* u + dc + (Q - 1) r: no round-off while nothing turns */
    moved[2 * node] = u[2 * node] + dq[0] + (c - 1) * r[0] - s * r[1];
    moved[2 * node + 1] = u[2 * node + 1] + dq[1] + s * r[0] + (c - 1) * r[1];
  }
}

/* ---- loads ---- */

static gh_status footing_check_straight(const gh_loads *l, const gh_mesh_set *set) {
  int end[2];
  double along[2];
  if (set->nedges == 0)
    return gh_fail(l->ctx, GH_INPUT, "set %s: a footing needs edges of the boundary, it has none", set->name);
  footing_find_ends(l->mesh, set, end, along);
  double length = hypot(along[0], along[1]);
  for (int k = 0; k < set->nnodes; k++) {
    const double *x = l->mesh->X + 2 * set->nodes[k], *o = l->mesh->X + 2 * end[0];
    double off = fabs(vector_cross(along, (double[2]){x[0] - o[0], x[1] - o[1]})) / length;
    if (!(off <= straight * length))
      return gh_fail(
          l->ctx, GH_INPUT,
          "set %s: a footing needs a straight edge; node %d at (%g, %g) lies %g off the line between "
          "its ends",
          set->name, set->nodes[k], x[0], x[1], off);
  }
  return GH_OK;
}

static gh_status footing_check_overlap(const gh_loads *l, const gh_mesh_set *set, const gh_mesh_set *other) {
  for (int a = 0, b = 0; a < set->nnodes && b < other->nnodes;) {
    if (set->nodes[a] == other->nodes[b])
      return gh_fail(l->ctx, GH_INPUT, "the footings on %s and %s share node %d at (%g, %g)", other->name,
                     set->name, set->nodes[a], l->mesh->X[2 * set->nodes[a]],
                     l->mesh->X[2 * set->nodes[a] + 1]);
    if (set->nodes[a] < other->nodes[b]) a++;
    else b++;
  }
  return GH_OK;
}

static gh_status footing_add(gh_loads *l, int set, gh_footing_load **load) {
  const gh_mesh_set *s = l->mesh->sets + set;
  GH_TRY(footing_check_straight(l, s));
  for (int k = 0; k < l->nfootings; k++)
    GH_TRY(footing_check_overlap(l, s, l->mesh->sets + l->footing[k].set));
  GH_TRY(gh_grow(l->ctx, (size_t)l->nfootings + 1, sizeof *l->footing, &l->footing_capacity, &l->footing));
  *load = l->footing + l->nfootings++;
  **load = (gh_footing_load){.set = set};
  return GH_OK;
}

gh_status gh_loads_footing(gh_loads *l, int set, const double at[2], const double force[2]) {
  gh_footing_load *load = NULL;
  double middle[2];
  if (set < 0 || set >= l->mesh->nsets)
    return gh_fail(l->ctx, GH_INPUT, "set %d: the mesh has sets 0 to %d", set, l->mesh->nsets - 1);
  if (!gh_finite(at, 2) || !gh_finite(force, 2))
    return gh_fail(l->ctx, GH_INPUT, "footing on %s: force (%g, %g) at (%g, %g) is not finite",
                   l->mesh->sets[set].name, force[0], force[1], at[0], at[1]);
  for (int k = 0; k < l->nfootings; k++)
    if (l->footing[k].set == set) load = l->footing + k;
  if (!load) GH_TRY(footing_add(l, set, &load));
  gh_footing_point(l->mesh, set, 0, middle);
  for (int i = 0; i < 2; i++) {
    load->force[i] += force[i];
    for (int j = 0; j < 2; j++) load->arm[2 * i + j] += force[i] * (at[j] - middle[j]);
  }
  return GH_OK;
}

/* (1 - t) a + t b */
static gh_footing_load load_mix(const gh_footing_load *a, const gh_footing_load *b, double t) {
  gh_footing_load c = {.set = a->set};
  for (int i = 0; i < 2; i++) c.force[i] = (1 - t) * a->force[i] + t * b->force[i];
  for (int i = 0; i < 4; i++) c.arm[i] = (1 - t) * a->arm[i] + t * b->arm[i];
  return c;
}

/* r_p x f and r_p . f with r_p = S z. */
static double load_moment(const gh_footing_load *l, const frame *f) {
  return f->a * (l->arm[2] - l->arm[1]) - f->b * (l->arm[0] + l->arm[3]);
}
static double load_virial(const gh_footing_load *l, const frame *f) {
  return f->a * (l->arm[0] + l->arm[3]) + f->b * (l->arm[2] - l->arm[1]);
}

/* ---- the footings of a solve ---- */

static gh_status footing_check_free(const gh_macro *m, const gh_loads *to, const gh_footing *f) {
  for (int k = 0; k < 2 * f->set->nnodes; k++) {
    int dof = 2 * f->set->nodes[k / 2] + k % 2;
    char name[GH_DOF_NAME];
    if (to->fixed[dof])
      return gh_fail(m->ctx, GH_INPUT,
                     "the footing on %s holds %s, which a support or a displacement holds as well",
                     f->set->name, gh_mesh_dof_name(m->mesh, dof, name));
  }
  return GH_OK;
}

gh_status gh_footings_begin(gh_macro *m, const gh_loads *to) {
  gh_footing *list = NULL;
  gh_status status = GH_OK;
  int *owner = NULL;
  GH_TRY_OR(gh_alloc(m->ctx, (size_t)to->nfootings + 1, sizeof *list, &list), failed);
  GH_TRY_OR(gh_alloc(m->ctx, (size_t)m->mesh->nnodes, sizeof *owner, &owner), failed);
  for (int a = 0; a < m->mesh->nnodes; a++) owner[a] = -1;
  for (int k = 0; k < to->nfootings; k++) {
    gh_footing *f = list + k;
    double along[2];
    f->set = m->mesh->sets + to->footing[k].set;
    f->from.set = to->footing[k].set;
    footing_find_ends(m->mesh, f->set, f->end, along);
    f->half = 0.5 * hypot(along[0], along[1]);
    for (int j = 0; j < m->nfootings; j++)
      if (m->footing[j].set == f->set) f->from = m->footing[j].from;
    for (int n = 0; n < f->set->nnodes; n++) owner[f->set->nodes[n]] = k;
    GH_TRY_OR(footing_check_free(m, to, f), failed);
  }
  free(m->footing);
  free(m->owner);
  m->footing = list;
  m->owner = owner;
  m->nfootings = to->nfootings;
  return GH_OK;
failed:
  free(list);
  free(owner);
  return status;
}

/* Nodal R under a footing with a load, as R_q; `spring`: the rotation of the arms. */
static void footing_gather(const gh_macro *m, const gh_footing *f, const gh_footing_load *load,
                           const double *u, const double *R, double q[3], double *spring) {
  frame here = frame_find(m->mesh, f->end, u);
  double sum[2] = {-load->force[0], -load->force[1]}, turn = -load_moment(load, &here),
         inner = load_virial(load, &here);
  for (int k = 0; k < f->set->nnodes; k++) {
    int node = f->set->nodes[k];
    double r[2];
    frame_find_arm(m->mesh, &here, u, node, r);
    for (int i = 0; i < 2; i++) {
      sum[i] += R[2 * node + i];
      inner -= r[i] * R[2 * node + i];
    }
    turn += vector_cross(r, R + 2 * node);
  }
  q[0] = sum[0], q[1] = sum[1], q[2] = turn / f->half;
  if (spring) *spring = inner / (f->half * f->half);
}

void gh_footings_rebase(gh_macro *m, const gh_loads *to, double t, const double *R) {
  for (int k = 0; k < m->nfootings; k++) {
    gh_footing *f = m->footing + k;
    f->from = load_mix(&f->from, to->footing + k, t);
    footing_gather(m, f, &f->from, m->eq.u, R, f->fade, NULL);
  }
}

double gh_footings_residual(const gh_macro *m, const gh_loads *to, double t, bool fade, const double *u,
                            double *R) {
  gh_squares forces = {0};
  for (int k = 0; k < m->nfootings; k++) {
    const gh_footing *f = m->footing + k;
    gh_footing_load load = load_mix(&f->from, to->footing + k, t);
    double *q = R + m->ndof + 3 * k;
    footing_gather(m, f, &load, u, R, q, NULL);
    for (int i = 0; i < 3 && fade; i++) q[i] -= (1 - t) * f->fade[i];
    for (int i = 0; i < 2; i++) gh_squares_add(&forces, load.force[i]);
  }
  return gh_squares_root(&forces);
}

/* Dead loads: force . dx of the point where it acts is force . dc plus the change of r_p . f. */
double gh_footings_work(const gh_macro *m, const gh_loads *to, double t0, double t1, bool fade) {
  double sum = 0;
  for (int k = 0; k < m->nfootings; k++) {
    const gh_footing *f = m->footing + k;
    const gh_footing_load load = load_mix(&f->from, to->footing + k, 0.5 * (t0 + t1));
    const frame from = frame_find(m->mesh, f->end, m->eq.u), here = frame_find(m->mesh, f->end, m->now.u);
    const double turn = atan2(from.a * here.b - from.b * here.a, from.a * here.a + from.b * here.b);
    const double q[3] = {here.c[0] - from.c[0], here.c[1] - from.c[1], turn * f->half};
    sum +=
        load.force[0] * q[0] + load.force[1] * q[1] + load_virial(&load, &here) - load_virial(&load, &from);
    for (int i = 0; i < 3 && fade; i++) sum += (1 - 0.5 * (t0 + t1)) * f->fade[i] * q[i];
  }
  return sum;
}

void gh_footings_tangent(gh_macro *m, const gh_loads *to, double t, const double *u, const double *R) {
  for (int k = 0; k < m->nfootings; k++) {
    const gh_footing *f = m->footing + k;
    gh_footing_load load = load_mix(&f->from, to->footing + k, t);
    frame here = frame_find(m->mesh, f->end, u);
    double q[3], spring, turn[2];
    footing_gather(m, f, &load, u, R, q, &spring);
    for (int n = 0; n < f->set->nnodes; n++) {
      double r[2];
      frame_find_arm(m->mesh, &here, u, f->set->nodes[n], r);
      turn[0] = -r[1] / f->half, turn[1] = r[0] / f->half;
      gh_system_turn(m->system, f->set->nodes[n], turn);
    }
    gh_system_spring(m->system, k, spring);
  }
}

void gh_macro_footing(const gh_macro *m, int set, double u[2], double *turn) {
  u[0] = u[1] = *turn = 0;
  if (set < 0 || set >= m->mesh->nsets || m->mesh->sets[set].nedges == 0) return;
  int end[2];
  double along[2];
  footing_find_ends(m->mesh, m->mesh->sets + set, end, along);
  frame here = frame_find(m->mesh, end, m->eq.u);
  for (int i = 0; i < 2; i++) u[i] = 0.5 * (m->eq.u[2 * end[0] + i] + m->eq.u[2 * end[1] + i]);
  *turn = atan2(here.b, here.a);
}
