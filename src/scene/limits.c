/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a scene prescribes, against the known limits of a granulate. */
#include "granhom/limits.h"
#include "scene/internal.h"

#include <stdlib.h>
#include <string.h>

static void extent_add(double range[2], double x) {
  range[0] = fmin(range[0], x), range[1] = fmax(range[1], x);
}

/* ---- stresses ---- */

static gh_status check_stress(gh_scene *s, int line, const char *what, double compression,
                              gh_stress_kind kind, bool *warned) {
  char where[512];
  snprintf(where, sizeof where, "%s:%d", s->path, line);
  return gh_limits_check_stress(s->ctx, &s->micro, where, what, compression, kind, warned);
}

static gh_status check_pressure(gh_scene *s, const scene_pressure *p, bool *warned) {
  char what[256];
  snprintf(what, sizeof what, "the pressure on '%.128s', %g,", s->mesh->sets[p->set].name, p->to);
  GH_TRY(check_stress(s, p->line, what, p->to, GH_STRESS_NORMAL, warned));
  snprintf(what, sizeof what, "the pressure on '%.128s', from %g,", s->mesh->sets[p->set].name, p->from);
  return isnan(p->from) ? GH_OK : check_stress(s, p->line, what, p->from, GH_STRESS_NORMAL, warned);
}

/* The stress that the weight makes over the extent of the mesh along it. */
static gh_status check_weight(gh_scene *s, int line, const double b[2], bool *warned) {
  const double size = hypot(b[0], b[1]), *X = s->mesh->X;
  double low = INFINITY, high = -INFINITY;
  char what[256];
  if (size == 0 || isnan(size)) return GH_OK;
  for (int a = 0; a < s->mesh->nnodes; a++) {
    double along = (X[2 * a] * b[0] + X[2 * a + 1] * b[1]) / size;
    low = fmin(low, along), high = fmax(high, along);
  }
  snprintf(what, sizeof what, "the weight %g over the height %g of the mesh, %g,", size, high - low,
           size * (high - low));
  return check_stress(s, line, what, size * (high - low), GH_STRESS_LOAD, warned);
}

gh_status scene_check_stresses(gh_scene *s) {
  bool warned = false; /* once a scene */
  char what[64];
  snprintf(what, sizeof what, "the confinement, %g,", s->confinement);
  if (s->start == SCENE_START_CONFINEMENT)
    GH_TRY(check_stress(s, s->start_line, what, s->confinement, GH_STRESS_NORMAL, &warned));
  GH_TRY(check_weight(s, s->gravity_line, s->gravity, &warned));
  for (int k = 0; k < s->nsteps; k++) {
    const scene_step *step = s->steps + k;
    for (int j = 0; j < step->npressures; j++) GH_TRY(check_pressure(s, step->pressures + j, &warned));
    if (!step->gravity) continue;
    GH_TRY(check_weight(s, step->gravity_line, step->gravity_to, &warned));
    GH_TRY(check_weight(s, step->gravity_line, step->gravity_from, &warned));
  }
  return GH_OK;
}

/* ---- the start ---- */

static bool set_has_edge(const gh_mesh_set *set, int a, int b) {
  for (int k = 0; k < set->nedges; k++)
    if ((set->edges[k][0] == a && set->edges[k][1] == b) || (set->edges[k][0] == b && set->edges[k][1] == a))
      return true;
  return false;
}

static bool edge_is_loaded(const gh_scene *s, int a, int b) {
  for (int set = 0; set < s->nsets; set++)
    if ((s->present.pressure[set].now != 0 || s->present.footing[set].stands) &&
        set_has_edge(s->mesh->sets + set, a, b))
      return true;
  return false;
}

static gh_status refuse_free(gh_scene *s, int a, int b) {
  const double *X = s->mesh->X;
  const char *name = NULL;
  for (int set = 0; set < s->nsets && !name; set++)
    if (set_has_edge(s->mesh->sets + set, a, b)) name = s->mesh->sets[set].name;
  return gh_fail(s->ctx, GH_INPUT,
                 "%s:%d: at the start the boundary from (%g, %g) to (%g, %g)%s%s%s is neither supported nor "
                 "pressed: grains only push, and the body would fly apart there. The confinement acts on the "
                 "edges of the first step that has pressures: give a pressure there, or a support",
                 s->path, s->start_line, X[2 * a], X[2 * a + 1], X[2 * b], X[2 * b + 1], name ? ", '" : "",
                 name ? name : "", name ? "'," : "");
}

/* The rotation about one point, which the first factorisation finds. */
static bool rotation_is_free(const gh_scene *s) {
  double range[2][2] = {{INFINITY, -INFINITY}, {INFINITY, -INFINITY}};
  const double *X = s->mesh->X;
  for (int d = 0; d < 2 * s->mesh->nnodes; d++)
    if (s->present.held[d]) extent_add(range[d % 2], X[d - d % 2 + 1 - d % 2]);
  return !(range[0][1] > range[0][0]) && !(range[1][1] > range[1][0]);
}

/* Weight presses, too: what it does at a free edge shows in the solution. */
gh_status scene_check_confined(gh_scene *s) {
  const gh_mesh *m = s->mesh;
  gh_mesh_edge *edges;
  int count;
  gh_status status = GH_OK;
  if (s->start != SCENE_START_CONFINEMENT || s->gravity[0] != 0 || s->gravity[1] != 0 || rotation_is_free(s))
    return GH_OK;
  GH_TRY(gh_mesh_boundary_edges(s->ctx, m->nelements, (const int(*)[4])m->quad, &edges, &count));
  for (int k = 0; k < count && status == GH_OK; k++)
    if (scene_normal_is_free(s, edges[k].a, edges[k].b) && !edge_is_loaded(s, edges[k].a, edges[k].b))
      status = refuse_free(s, edges[k].a, edges[k].b);
  free(edges);
  return status;
}

/* ---- displacements ---- */

/* Extent of a set whose nodes are all prescribed in direction i: now along i, in the reference along i and
 * across. */
typedef struct extent {
  bool known;
  double now[2], along[2], across[2]; /* least, largest */
} extent;

static extent extent_of(const gh_scene *s, const gh_mesh_set *set, int i) {
  extent e = {.known = set->nnodes > 0,
              .now = {INFINITY, -INFINITY},
              .along = {INFINITY, -INFINITY},
              .across = {INFINITY, -INFINITY}};
  for (int n = 0; n < set->nnodes; n++) {
    const int a = set->nodes[n], dof = 2 * a + i;
    e.known = e.known && s->present.held[dof] && !isnan(s->present.u[dof].to);
    extent_add(e.now, s->mesh->X[dof] + s->present.u[dof].to);
    extent_add(e.along, s->mesh->X[dof]);
    extent_add(e.across, s->mesh->X[2 * a + 1 - i]);
  }
  return e;
}

/* An upper bound of the mean stretch between two sets, one above the other; INFINITY where that is not so. */
static double stretch_between(const extent *low, const extent *high) {
  if (!low->known || !high->known || !(high->along[0] > low->along[1])) return INFINITY;
  if (low->across[1] < high->across[0] || high->across[1] < low->across[0]) return INFINITY;
  return (high->now[1] - low->now[0]) / (high->along[1] - low->along[0]);
}

static gh_status refuse_stretch(gh_scene *s, const scene_displace *d, int other, int i, double stretch) {
  return gh_fail(
      s->ctx, GH_INPUT,
      "%s:%d: this displacement of '%s' makes the distance to '%s' in %c %.3g times what it is: %s. "
      "Displacements are lengths, in the units of the mesh",
      s->path, d->line, s->mesh->sets[d->set].name, s->mesh->sets[other].name, "xy"[i], stretch,
      stretch > 1   ? "no grains would touch"
      : stretch > 0 ? "no packing can follow"
                    : "the mesh would be turned inside out");
}

/* The least stretch in direction i between the driven set and any other one. */
static double least_stretch(const gh_scene *s, int set, int i, int *other) {
  const extent own = extent_of(s, s->mesh->sets + set, i);
  double least = INFINITY;
  for (int k = 0; k < s->nsets && own.known; k++) {
    const extent e = extent_of(s, s->mesh->sets + k, i);
    const double stretch = fmin(stretch_between(&e, &own), stretch_between(&own, &e));
    if (stretch < least) least = stretch, *other = k;
  }
  return least;
}

gh_status scene_check_stretch(gh_scene *s, const scene_step *step) {
  const gh_limits limits = gh_limits_of(&s->micro);
  for (int k = 0; k < step->ndisplaces; k++)
    for (int i = 0; i < 2; i++) {
      int other = 0;
      double stretch = least_stretch(s, step->displaces[k].set, i, &other);
      if (stretch < limits.stretch || (stretch > limits.expansion && isfinite(stretch)))
        return refuse_stretch(s, step->displaces + k, other, i, stretch);
    }
  return GH_OK;
}
