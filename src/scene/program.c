/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The plan of a scene: what acts at the end of each increment.
 *
 * All that acts is a ramp over the increments of a step. Loads and driven displacements keep their last value
 * until a step changes them; the supports of a step end with it. A support holds every node of its set where
 * that node is when the support begins. */
#include "scene/internal.h"

#include <stdlib.h>
#include <string.h>

int gh_scene_steps(const gh_scene *scene) {
  return scene->nsteps;
}
int gh_scene_increments(const gh_scene *scene, int step) {
  return step < 1 ? 1 : scene->steps[step - 1].increments;
}
const char *gh_scene_step_name(const gh_scene *scene, int step) {
  return step < 1 ? "start" : scene->steps[step - 1].name;
}
const gh_mesh *gh_scene_mesh(const gh_scene *scene) {
  return scene->mesh;
}

/* ---- the mesh seen by the plan ---- */

/* One set for each node behind the user's sets, so that nodes of an edge can be held where they are, each for
 * itself. */
static gh_status add_node_sets(gh_scene *s) {
  gh_mesh *m = s->mesh;
  size_t total = (size_t)s->nsets + (size_t)m->nnodes;
  gh_mesh_set *sets;
  GH_TRY(gh_alloc(s->ctx, total, sizeof *sets, &sets));
  if (s->nsets > 0) memcpy(sets, m->sets, (size_t)s->nsets * sizeof *sets);
  free(m->sets);
  m->sets = sets;
  for (int a = 0; a < m->nnodes; a++) {
    gh_mesh_set *set = sets + s->nsets + a;
    m->nsets = s->nsets + a + 1; /* so that a failure leaves what gh_mesh_destroy can free */
    GH_TRY(gh_alloc(s->ctx, 32, 1, &set->name));
    snprintf(set->name, 32, "(node %d)",
             a); /* names of users cannot clash: sets are looked up before these exist */
    GH_TRY(gh_alloc(s->ctx, 1, sizeof *set->nodes, &set->nodes));
    set->nodes[0] = a;
    set->nnodes = 1;
  }
  return GH_OK;
}

/* ---- memory ---- */

gh_status scene_program_create(gh_scene *s) {
  scene_present *p = &s->present;
  size_t nsets = (size_t)s->nsets, ndof = 2 * (size_t)s->mesh->nnodes;
  GH_TRY(add_node_sets(s));
  GH_TRY(gh_alloc(s->ctx, nsets, sizeof *p->pressure, &p->pressure));
  GH_TRY(gh_alloc(s->ctx, nsets, sizeof *p->follow, &p->follow));
  GH_TRY(gh_alloc(s->ctx, nsets, sizeof *p->force, &p->force));
  GH_TRY(gh_alloc(s->ctx, nsets, sizeof *p->footing, &p->footing));
  GH_TRY(gh_alloc(s->ctx, ndof, sizeof *p->u, &p->u));
  GH_TRY(gh_alloc(s->ctx, ndof, sizeof *p->held, &p->held));
  return gh_alloc(s->ctx, ndof, sizeof *p->driven, &p->driven);
}

void scene_program_destroy(gh_scene *s) {
  scene_present *p = &s->present;
  free(p->pressure);
  free(p->follow);
  free(p->force);
  free(p->footing);
  free(p->u);
  free(p->held);
  free(p->driven);
  *p = (scene_present){0};
}

static void clear(gh_scene *s) {
  scene_present *p = &s->present;
  size_t nsets = (size_t)s->nsets, ndof = 2 * (size_t)s->mesh->nnodes;
  memset(p->pressure, 0, nsets * sizeof *p->pressure);
  memset(p->follow, 0, nsets * sizeof *p->follow);
  memset(p->force, 0, nsets * sizeof *p->force);
  memset(p->footing, 0, nsets * sizeof *p->footing);
  memset(p->u, 0, ndof * sizeof *p->u);
  memset(p->held, 0, ndof * sizeof *p->held);
  memset(p->driven, 0, ndof * sizeof *p->driven);
  for (int i = 0; i < 2; i++) p->gravity[i] = (scene_ramp){s->gravity[i], s->gravity[i], s->gravity[i]};
}

/* ---- what a step does ---- */

static void set_ramp(scene_ramp *r, double from, double to) {
  r->from = isnan(from) ? r->now : from;
  r->to = to;
}

static void keep_ramp(scene_ramp *r) {
  r->from = r->to = r->now;
}

/* Supports hold their nodes where they are: at u, 0 where it is not known. */
static void hold(gh_scene *s, const scene_fix *fixes, int count, const double *u) {
  for (int k = 0; k < count; k++) {
    const gh_mesh_set *set = s->mesh->sets + fixes[k].set;
    for (int n = 0; n < 2 * set->nnodes; n++) {
      int dof = 2 * set->nodes[n / 2] + n % 2;
      if (!(fixes[k].mask & (n % 2 ? SCENE_Y : SCENE_X))) continue;
      s->present.held[dof] = true;
      s->present.u[dof].from = s->present.u[dof].to = u ? u[dof] : 0;
    }
  }
}

static void release(gh_scene *s, const scene_step *step) {
  for (int k = 0; k < step->nreleases; k++) {
    const gh_mesh_set *set = s->mesh->sets + step->releases[k].set;
    for (int n = 0; n < 2 * set->nnodes; n++)
      if (step->releases[k].mask & (n % 2 ? SCENE_Y : SCENE_X))
        s->present.driven[2 * set->nodes[n / 2] + n % 2] = false;
  }
}

/* Each node of a driven set goes from where it is (or from `from`) to the target. At the start it is held at
 * the beginning of that ramp. */
static void drive(gh_scene *s, const scene_step *step, const double *u, bool start) {
  for (int k = 0; k < step->ndisplaces; k++) {
    const scene_displace *d = step->displaces + k;
    const gh_mesh_set *set = s->mesh->sets + d->set;
    for (int n = 0; n < 2 * set->nnodes; n++) {
      int i = n % 2, dof = 2 * set->nodes[n / 2] + i;
      if (isnan(d->to[i])) continue;
      double from = isnan(d->from[i]) ? (u ? u[dof] : 0) : d->from[i];
      s->present.held[dof] = s->present.driven[dof] = true;
      s->present.u[dof].from = from;
      s->present.u[dof].to = start ? from : d->to[i];
    }
  }
}

/* Supports and driven displacements of a step; later ones win at shared nodes. */
static void begin_supports(gh_scene *s, const scene_step *step, const double *u, bool start) {
  scene_present *p = &s->present;
  int ndof = 2 * s->mesh->nnodes;
  release(s, step);
  for (int d = 0; d < ndof; d++) {
    p->held[d] = p->driven[d];
    p->u[d].from = p->u[d].to = u ? u[d] : 0;
  }
  hold(s, s->supports, s->nsupports, u);
  hold(s, step->supports, step->nsupports, u);
  drive(s, step, u, start);
}

static void confine_edge(gh_scene *s, int set, bool follow) {
  s->present.pressure[set] = (scene_ramp){s->confinement, s->confinement, s->confinement};
  s->present.follow[set] = s->confinement_follow < 0 ? follow : s->confinement_follow;
}

/* Where the confinement acts: on the edges of the first step that has pressures, else on all that no support
 * holds along their normal. */
static gh_status confine(gh_scene *s) {
  for (int k = 0; k < s->nsteps; k++) {
    for (int j = 0; j < s->steps[k].npressures; j++)
      confine_edge(s, s->steps[k].pressures[j].set, s->steps[k].pressures[j].follow);
    if (s->steps[k].npressures > 0) return GH_OK;
  }
  int count = 0;
  for (int set = 0; set < s->nsets; set++) {
    const gh_mesh_set *m = s->mesh->sets + set;
    bool wanted = false;
    for (int e = 0; e < m->nedges && !wanted; e++)
      wanted = scene_normal_is_free(s, m->edges[e][0], m->edges[e][1]);
    if (!wanted) continue;
    for (int other = 0; other < set; other++) {
      bool share = false;
      if (s->present.pressure[other].now != 0)
        GH_TRY(gh_mesh_share_edges(s->ctx, s->mesh->sets + other, m, &share));
      if (share)
        return gh_fail(
            s->ctx, GH_INPUT,
            "%s:%d: '%s' and '%s' share edges: say by the pressure of a step where the confinement acts",
            s->path, s->start_line, s->mesh->sets[other].name, m->name);
    }
    confine_edge(s, set, false);
    count++;
  }
  if (count > 0) return GH_OK;
  return gh_fail(s->ctx, GH_INPUT, "%s:%d: the confinement finds no edge to act on: all are held by supports",
                 s->path, s->start_line);
}

/* The force of a footing goes from its present value to the new one; where it shall act at another point, it
 * fades at the old one and grows at the new. At the start the footing stands with the force that the first
 * step begins with. */
static void load_footing(scene_standing *now, const scene_footing *f, bool start) {
  bool moves = now->stands && (now->at[0] != f->at[0] || now->at[1] != f->at[1]);
  for (int i = 0; i < 2; i++) {
    if (moves && isnan(f->from[i])) {
      now->old_at[i] = now->at[i];
      now->old[i] = (scene_ramp){now->force[i].now, 0, now->force[i].now};
    }
    if (moves) now->force[i].now = 0;
    set_ramp(now->force + i, f->from[i], f->to[i]);
    if (start) now->force[i].to = now->force[i].from;
    now->at[i] = f->at[i];
  }
  now->stands = true;
  now->line = f->line;
}

/* Step 0: the scene's supports, those of the first step, and what the first step drives, held. */
static gh_status begin_start(gh_scene *s) {
  clear(s);
  begin_supports(s, s->steps, NULL, true);
  for (int k = 0; k < s->steps->nfootings; k++)
    load_footing(s->present.footing + s->steps->footings[k].set, s->steps->footings + k, true);
  return s->start == SCENE_START_CONFINEMENT ? confine(s) : GH_OK;
}

static void begin_step(gh_scene *s, const scene_step *step, const double *u) {
  scene_present *p = &s->present;
  for (int k = 0; k < s->nsets; k++) {
    keep_ramp(p->pressure + k);
    for (int i = 0; i < 2; i++) {
      keep_ramp(p->force[k] + i);
      keep_ramp(p->footing[k].force + i);
      keep_ramp(p->footing[k].old + i);
    }
  }
  for (int i = 0; i < 2; i++) {
    keep_ramp(p->gravity + i);
    if (step->gravity) set_ramp(p->gravity + i, step->gravity_from[i], step->gravity_to[i]);
  }
  for (int k = 0; k < step->npressures; k++) {
    const scene_pressure *q = step->pressures + k;
    set_ramp(p->pressure + q->set, q->from, q->to);
    p->follow[q->set] = q->follow;
  }
  for (int k = 0; k < step->nforces; k++)
    for (int i = 0; i < 2; i++)
      set_ramp(p->force[step->forces[k].set] + i, step->forces[k].from[i], step->forces[k].to[i]);
  for (int k = 0; k < step->nfootings; k++)
    load_footing(p->footing + step->footings[k].set, step->footings + k, false);
  begin_supports(s, step, u, false);
}

/* ---- the plan from outside ---- */

static void go(scene_ramp *r, int increment, int increments) {
  r->now = increment == increments ? r->to : r->from + (r->to - r->from) * increment / increments;
}

static gh_status add_footing(scene_standing *f, int set, int increment, int increments, gh_loads *loads) {
  for (int i = 0; i < 2; i++) {
    go(f->force + i, increment, increments);
    go(f->old + i, increment, increments);
  }
  const double force[2] = {f->force[0].now, f->force[1].now}, old[2] = {f->old[0].now, f->old[1].now};
  GH_TRY(gh_loads_footing(loads, set, f->at, force));
  return old[0] != 0 || old[1] != 0 ? gh_loads_footing(loads, set, f->old_at, old) : GH_OK;
}

gh_status gh_scene_loads(gh_scene *s, int step, int increment, const double *u, gh_loads *loads) {
  scene_present *p = &s->present;
  int ndof = 2 * s->mesh->nnodes, increments = gh_scene_increments(s, step);
  if (step == 0) GH_TRY(begin_start(s));
  else if (increment == 1) begin_step(s, s->steps + step - 1, u);
  gh_loads_clear(loads);
  for (int k = 0; k < s->nsets; k++) {
    go(p->pressure + k, increment, increments);
    if (p->pressure[k].now != 0) GH_TRY(gh_loads_pressure(loads, k, p->pressure[k].now, p->follow[k]));
    for (int i = 0; i < 2; i++) go(p->force[k] + i, increment, increments);
    double force[2] = {p->force[k][0].now, p->force[k][1].now};
    if (force[0] != 0 || force[1] != 0) GH_TRY(gh_loads_force(loads, k, force));
    if (p->footing[k].stands) GH_TRY(add_footing(p->footing + k, k, increment, increments, loads));
  }
  for (int i = 0; i < 2; i++) go(p->gravity + i, increment, increments);
  GH_TRY(gh_loads_gravity(loads, (const double[2]){p->gravity[0].now, p->gravity[1].now}));
  for (int d = 0; d < ndof; d++) {
    if (!p->held[d]) continue;
    go(p->u + d, increment, increments);
    GH_TRY(gh_loads_displace(loads, s->nsets + d / 2, d % 2, p->u[d].now));
  }
  return GH_OK;
}

void gh_scene_load_on(const gh_scene *s, int set, gh_scene_load *load) {
  const scene_present *p = &s->present;
  const gh_mesh_set *m = s->mesh->sets + set;
  *load = (gh_scene_load){.pressure = p->pressure[set].now, .follow = p->follow[set]};
  for (int i = 0; i < 2; i++) {
    load->force[i] = p->force[set][i].now;
    load->held[i] = m->nnodes > 0;
    for (int n = 0; n < m->nnodes; n++) {
      load->held[i] = load->held[i] && p->held[2 * m->nodes[n] + i];
      load->displacement[i] += p->u[2 * m->nodes[n] + i].now / m->nnodes;
    }
    if (!load->held[i]) load->displacement[i] = NAN;
  }
}

void gh_scene_gravity(const gh_scene *s, double b[2]) {
  for (int i = 0; i < 2; i++) b[i] = s->present.gravity[i].now;
}

/* ---- check ---- */

static gh_status check_releases(gh_scene *s, const scene_step *step) {
  for (int k = 0; k < step->nreleases; k++) {
    const gh_mesh_set *set = s->mesh->sets + step->releases[k].set;
    for (int n = 0; n < 2 * set->nnodes; n++) {
      if (!(step->releases[k].mask & (n % 2 ? SCENE_Y : SCENE_X))) continue;
      if (!s->present.driven[2 * set->nodes[n / 2] + n % 2])
        return gh_fail(s->ctx, GH_INPUT,
                       "%s:%d: step '%s' releases '%s' in %c, but no step before has driven it by 'displace'",
                       s->path, step->line, step->name, set->name, "xy"[n % 2]);
    }
  }
  return GH_OK;
}

/* Without a fixed node in x and in y the body is free to fly away; the rest of singularity shows in the first
 * factorisation. */
static gh_status check_supports(gh_scene *s, int line, const char *name) {
  for (int i = 0; i < 2; i++) {
    bool any = false;
    for (int a = 0; a < s->mesh->nnodes; a++) any = any || s->present.held[2 * a + i];
    if (!any)
      return gh_fail(
          s->ctx, GH_INPUT,
          "%s:%d: nothing holds the body in %c in step '%s': add a support, such as {edge: %s, fix: %c}",
          s->path, line, "xy"[i], name,
          s -> nsets > 0 ? s -> mesh -> sets[i && s->nsets > 2 ? 2 : 0].name : "NAME", "xy"[i]);
  }
  return GH_OK;
}

static gh_status check_footing_free(gh_scene *s, int set, const char *name) {
  const gh_mesh_set *m = s->mesh->sets + set;
  for (int n = 0; n < 2 * m->nnodes; n++) {
    int node = m->nodes[n / 2];
    if (s->present.held[2 * node + n % 2])
      return gh_fail(
          s->ctx, GH_INPUT,
          "%s:%d: the footing on '%s' cannot move its node at (%g, %g): a support or a displacement "
          "holds it in %c in step '%s'",
          s->path, s->present.footing[set].line, m->name, s->mesh->X[2 * node], s->mesh->X[2 * node + 1],
          "xy"[n % 2], name);
  }
  return GH_OK;
}

/* Straight edges, none shared, no node held. */
static gh_status check_footings(gh_scene *s, const char *name) {
  static const double nothing[2] = {0, 0};
  gh_loads *loads = NULL;
  gh_status status = gh_loads_create(s->ctx, s->mesh, &loads);
  for (int set = 0; set < s->nsets && status == GH_OK; set++) {
    const scene_standing *f = s->present.footing + set;
    if (f->stands) status = gh_loads_footing(loads, set, f->at, nothing);
    if (status != GH_OK) gh_prefix(s->ctx, status, "%s:%d: ", s->path, f->line);
  }
  for (int set = 0; set < s->nsets && status == GH_OK; set++)
    if (s->present.footing[set].stands) status = check_footing_free(s, set, name);
  gh_loads_destroy(&loads);
  return status;
}

/* Displacements at the end of the step, as far as they are prescribed. */
static void note_prescribed(const gh_scene *s, double *u) {
  for (int d = 0; d < 2 * s->mesh->nnodes; d++) u[d] = s->present.held[d] ? s->present.u[d].to : NAN;
}

static gh_status check_start(gh_scene *s) {
  GH_TRY(begin_start(s));
  GH_TRY(check_supports(s, s->steps->line, "start"));
  GH_TRY(check_footings(s, "start"));
  return scene_check_confined(s);
}

static gh_status check_steps(gh_scene *s, double *u) {
  GH_TRY(check_start(s));
  note_prescribed(s, u);
  for (int k = 0; k < s->nsteps; k++) {
    const scene_step *step = s->steps + k;
    GH_TRY(check_releases(s, step));
    begin_step(s, step, u);
    GH_TRY(check_supports(s, step->line, step->name));
    GH_TRY(check_footings(s, step->name));
    GH_TRY(scene_check_stretch(s, step));
    note_prescribed(s, u);
  }
  return GH_OK;
}

gh_status scene_program_check(gh_scene *s) {
  double *u;
  GH_TRY(gh_alloc(s->ctx, 2 * (size_t)s->mesh->nnodes, sizeof *u, &u));
  gh_status status = check_steps(s, u);
  free(u);
  clear(s);
  return status;
}
