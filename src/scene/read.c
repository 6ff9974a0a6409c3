/* Reads a scene file and what it names; every complaint begins with file:line. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "scene/internal.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_INCREMENTS = 1000000, MOST_ELEMENTS = 1000000 };
static const double LARGE = 1e300;

typedef gh_yaml_node node;
#define KEYS(...)                                                                                            \
  (const char *const[]) {                                                                                    \
    __VA_ARGS__, NULL                                                                                        \
  }

/* ---- small readers ---- */

static gh_status copy_text(gh_context *ctx, const char *text, char **copy) {
  GH_TRY(gh_alloc(ctx, strlen(text) + 1, 1, copy));
  strcpy(*copy, text);
  return GH_OK;
}

/* The value of a key that must be there. */
static gh_status need(node map, const char *what, const char *key, node *value) {
  *value = gh_yaml_get(map, key);
  if (gh_yaml_has(*value)) return GH_OK;
  return gh_yaml_fail(map, "%s needs the key '%s'", what, key);
}

static gh_status a_map(node n, const char *what, const char *const *keys) {
  if (!gh_yaml_is_map(n)) return gh_yaml_fail(n, "%s must be a map of keys and values", what);
  return gh_yaml_keys(n, keys);
}

static gh_status number(node n, const char *what, double *value) {
  return gh_yaml_number(n, what, -LARGE, LARGE, value);
}

static gh_status positive(node n, const char *what, double *value) {
  double x;
  GH_TRY(number(n, what, &x));
  if (!(x > 0)) return gh_yaml_fail(n, "%s is %g, it must be above 0", what, x);
  *value = x;
  return GH_OK;
}

/* The number 0 < x < 1 behind an optional key. */
static gh_status fraction(node map, const char *key, double *value) {
  node n = gh_yaml_get(map, key);
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(positive(n, key, value));
  if (!(*value < 1)) return gh_yaml_fail(n, "%s is %g, it must be below 1", key, *value);
  return GH_OK;
}

static gh_status optional_bool(node map, const char *key, bool *value) {
  node n = gh_yaml_get(map, key);
  return gh_yaml_has(n) ? gh_yaml_bool(n, key, value) : GH_OK;
}

static gh_status optional_integer(node map, const char *key, long low, long high, int *value) {
  node n = gh_yaml_get(map, key);
  if (!gh_yaml_has(n)) return GH_OK;
  long x;
  GH_TRY(gh_yaml_integer(n, key, low, high, &x));
  *value = (int)x;
  return GH_OK;
}

/* Two numbers [x, y]. */
static gh_status pair(node n, const char *what, double value[2]) {
  GH_TRY(gh_yaml_numbers(n, what, 2, value));
  if (!gh_finite(value, 2)) return gh_yaml_fail(n, "%s is not finite", what);
  return GH_OK;
}

/* Number of entries of an optional list; fails when it is no list. */
static gh_status list_length(node list, const char *what, int *length) {
  *length = 0;
  if (!gh_yaml_has(list)) return GH_OK;
  if (!gh_yaml_is_list(list)) return gh_yaml_fail(list, "%s must be a list: [{edge: ...}, ...]", what);
  *length = gh_yaml_length(list);
  return GH_OK;
}

/* The set named by `edge` or `set`. Edges are needed where a pressure acts. */
static gh_status find_set(const gh_scene *s, node map, const char *what, bool edges, int *set) {
  node n = gh_yaml_get(map, "edge"), other = gh_yaml_get(map, "set");
  if (gh_yaml_has(n) && gh_yaml_has(other))
    return gh_yaml_fail(map, "%s: give 'edge' or 'set', not both", what);
  if (!gh_yaml_has(n)) n = other;
  if (!gh_yaml_has(n)) return gh_yaml_fail(map, "%s needs the key 'edge'", what);
  const char *name;
  GH_TRY(gh_yaml_text(n, "edge", &name));
  *set = gh_mesh_find(s->mesh, name);
  if (*set < 0) {
    char known[256] = "";
    for (int k = 0; k < s->nsets; k++) {
      size_t at = strlen(known);
      snprintf(known + at, sizeof known - at, "%s%s", k ? ", " : "", s->mesh->sets[k].name);
    }
    return gh_yaml_fail(n, "there is no edge or set '%s'; the mesh has: %s", name, *known ? known : "none");
  }
  if (edges && s->mesh->sets[*set].nedges == 0)
    return gh_yaml_fail(n, "a pressure needs edges of the boundary, and set '%s' has none", name);
  return GH_OK;
}

/* ---- material: packing, contact, micro ---- */

static gh_status read_packing(gh_scene *s, node root, const char *folder) {
  node n;
  const char *name;
  GH_TRY(need(root, "a scene", "packing", &n));
  GH_TRY(gh_yaml_text(n, "packing", &name));
  s->packing_path = gh_path_join(folder, name);
  if (!s->packing_path) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_packing_read(s->ctx, s->packing_path, &s->packing);
  if (status != GH_OK) gh_prefix(s->ctx, status, "%s:%d: packing: ", gh_yaml_path(n), gh_yaml_line(n));
  return status;
}

static gh_status read_contact(gh_scene *s, node root) {
  node contact, n;
  GH_TRY(need(root, "a scene", "contact", &contact));
  GH_TRY(a_map(contact, "contact", KEYS("normal_stiffness")));
  GH_TRY(need(contact, "contact", "normal_stiffness", &n));
  return positive(n, "normal_stiffness", &s->micro.law.normal_stiffness);
}

static gh_status read_micro(gh_scene *s, node root) {
  node micro = gh_yaml_get(root, "micro"), n;
  if (!gh_yaml_has(micro)) return GH_OK;
  GH_TRY(a_map(micro, "micro", KEYS("boundary", "tolerance", "engine", "max_steps")));
  const char *word;
  if (gh_yaml_has(n = gh_yaml_get(micro, "boundary"))) {
    GH_TRY(gh_yaml_text(n, "boundary", &word));
    if (!gh_boundary_from_name(word, &s->micro.boundary))
      return gh_yaml_fail(n, "boundary '%s' is none of taylor, taylor-cell, restricted, periodic", word);
  }
  if (gh_yaml_has(n = gh_yaml_get(micro, "engine"))) {
    GH_TRY(gh_yaml_text(n, "engine", &word));
    if (strcmp(word, "lammps") != 0 && strcmp(word, "native") != 0)
      return gh_yaml_fail(n, "engine '%s' is none of lammps, native", word);
    s->micro.engine = strcmp(word, "native") == 0 ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS;
  }
  if (gh_yaml_has(n = gh_yaml_get(micro, "max_steps")))
    GH_TRY(gh_yaml_integer(n, "max_steps", 1, 2000000000, &s->micro.max_steps));
  return fraction(micro, "tolerance", &s->micro.tolerance);
}

/* ---- mesh ---- */

static gh_status move_nodes(gh_scene *s, node list) {
  int count;
  if (gh_yaml_has(list) && !gh_yaml_is_list(list))
    return gh_yaml_fail(list, "move must be a list: [{node: [x, y], by: [dx, dy]}, ...]");
  GH_TRY(list_length(list, "move", &count));
  double size = 0;
  for (int k = 0; k < 2 * s->mesh->nnodes; k++) size = fmax(size, fabs(s->mesh->X[k] - s->mesh->X[k % 2]));
  double *old;
  GH_TRY(gh_alloc(s->ctx, 2 * (size_t)s->mesh->nnodes, sizeof *old, &old));
  memcpy(old, s->mesh->X, 2 * (size_t)s->mesh->nnodes * sizeof *old); /* nodes are named by where they were */
  gh_status status = GH_OK;
  for (int k = 0; k < count && status == GH_OK; k++) {
    node entry = gh_yaml_item(list, k), at, by;
    double x[2], d[2];
    GH_TRY_OR(a_map(entry, "an entry of move", KEYS("node", "by")), done);
    GH_TRY_OR(need(entry, "an entry of move", "node", &at), done);
    GH_TRY_OR(need(entry, "an entry of move", "by", &by), done);
    GH_TRY_OR(pair(at, "node", x), done);
    GH_TRY_OR(pair(by, "by", d), done);
    int best = 0;
    for (int a = 1; a < s->mesh->nnodes; a++)
      if (hypot(old[2 * a] - x[0], old[2 * a + 1] - x[1]) <
          hypot(old[2 * best] - x[0], old[2 * best + 1] - x[1]))
        best = a;
    double off = hypot(old[2 * best] - x[0], old[2 * best + 1] - x[1]);
    if (off > 1e-4 * size) {
      status = gh_yaml_fail(at, "there is no node at (%g, %g); the nearest is at (%g, %g)", x[0], x[1],
                            old[2 * best], old[2 * best + 1]);
      goto done;
    }
    for (int i = 0; i < 2; i++) s->mesh->X[2 * best + i] = old[2 * best + i] + d[i];
  }
done:
  free(old);
  return status;
}

static gh_status read_rectangle(gh_scene *s, node n) {
  double low[2] = {0, 0}, size[2];
  int elements[2];
  node part;
  GH_TRY(a_map(n, "rectangle", KEYS("size", "elements", "low")));
  GH_TRY(need(n, "rectangle", "size", &part));
  GH_TRY(pair(part, "size", size));
  if (!(size[0] > 0) || !(size[1] > 0))
    return gh_yaml_fail(part, "size [%g, %g] must be above 0", size[0], size[1]);
  GH_TRY(need(n, "rectangle", "elements", &part));
  if (!gh_yaml_is_list(part) || gh_yaml_length(part) != 2)
    return gh_yaml_fail(part, "elements must be a list of two numbers");
  for (int i = 0; i < 2; i++) {
    long count;
    GH_TRY(gh_yaml_integer(gh_yaml_item(part, i), "elements", 1, MOST_ELEMENTS, &count));
    elements[i] = (int)count;
  }
  if ((double)elements[0] * elements[1] > MOST_ELEMENTS)
    return gh_yaml_fail(part, "%d x %d elements are more than %d", elements[0], elements[1], MOST_ELEMENTS);
  if (gh_yaml_has(part = gh_yaml_get(n, "low"))) GH_TRY(pair(part, "low", low));
  return gh_mesh_rectangle(s->ctx, low, size, elements, &s->mesh);
}

static gh_status read_mesh(gh_scene *s, node root, const char *folder) {
  node mesh, rectangle, gmsh;
  GH_TRY(need(root, "a scene", "mesh", &mesh));
  GH_TRY(a_map(mesh, "mesh", KEYS("rectangle", "gmsh", "move")));
  rectangle = gh_yaml_get(mesh, "rectangle");
  gmsh = gh_yaml_get(mesh, "gmsh");
  if (gh_yaml_has(rectangle) == gh_yaml_has(gmsh))
    return gh_yaml_fail(mesh, "mesh needs one of the keys 'rectangle' and 'gmsh'");
  if (gh_yaml_has(gmsh)) {
    const char *name;
    GH_TRY(gh_yaml_text(gmsh, "gmsh", &name));
    char *path = gh_path_join(folder, name);
    if (!path) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
    gh_status status = gh_mesh_read_gmsh(s->ctx, path, &s->mesh);
    free(path);
    if (status != GH_OK)
      return gh_prefix(s->ctx, status, "%s:%d: mesh: ", gh_yaml_path(gmsh), gh_yaml_line(gmsh));
  } else {
    GH_TRY(read_rectangle(s, rectangle));
  }
  s->nsets = s->mesh->nsets;
  GH_TRY(move_nodes(s, gh_yaml_get(mesh, "move")));
  gh_status status = gh_mesh_check(s->ctx, s->mesh);
  if (status != GH_OK) gh_prefix(s->ctx, status, "%s:%d: mesh: ", gh_yaml_path(mesh), gh_yaml_line(mesh));
  return status;
}

/* ---- supports and loads ---- */

/* [{edge: NAME, KEY: x|y|both}, ...]; key is `fix` or `free`. */
static gh_status read_fixes(gh_scene *s, node list, const char *what, const char *key, scene_fix **fixes,
                            int *count) {
  GH_TRY(list_length(list, what, count));
  GH_TRY(gh_alloc(s->ctx, (size_t)*count, sizeof **fixes, fixes));
  for (int k = 0; k < *count; k++) {
    node entry = gh_yaml_item(list, k), n;
    const char *word;
    GH_TRY(a_map(entry, what, KEYS("edge", "set", key)));
    GH_TRY(find_set(s, entry, what, false, &(*fixes)[k].set));
    GH_TRY(need(entry, what, key, &n));
    GH_TRY(gh_yaml_text(n, key, &word));
    if (strcmp(word, "x") == 0) (*fixes)[k].mask = SCENE_X;
    else if (strcmp(word, "y") == 0) (*fixes)[k].mask = SCENE_Y;
    else if (strcmp(word, "both") == 0) (*fixes)[k].mask = SCENE_X | SCENE_Y;
    else return gh_yaml_fail(n, "%s is '%s', it must be x, y or both", key, word);
  }
  return GH_OK;
}

/* Two sets with an edge of the mesh in common. */
static bool share_edge(const gh_mesh_set *a, const gh_mesh_set *b) {
  for (int i = 0; i < a->nedges; i++)
    for (int j = 0; j < b->nedges; j++)
      if (a->edges[i][0] == b->edges[j][0] && a->edges[i][1] == b->edges[j][1]) return true;
  return false;
}

static gh_status read_pressures(gh_scene *s, node list, scene_step *step) {
  GH_TRY(list_length(list, "pressure", &step->npressures));
  GH_TRY(gh_alloc(s->ctx, (size_t)step->npressures, sizeof *step->pressures, &step->pressures));
  for (int k = 0; k < step->npressures; k++) {
    scene_pressure *p = step->pressures + k;
    node entry = gh_yaml_item(list, k), n;
    GH_TRY(a_map(entry, "pressure", KEYS("edge", "set", "from", "to", "follow")));
    GH_TRY(find_set(s, entry, "pressure", true, &p->set));
    GH_TRY(need(entry, "pressure", "to", &n));
    GH_TRY(number(n, "to", &p->to));
    p->from = NAN;
    if (gh_yaml_has(n = gh_yaml_get(entry, "from"))) GH_TRY(number(n, "from", &p->from));
    GH_TRY(optional_bool(entry, "follow", &p->follow));
    const gh_mesh_set *sets = s->mesh->sets;
    for (int j = 0; j < k; j++) {
      int other = step->pressures[j].set;
      if (other == p->set)
        return gh_yaml_fail(entry, "the pressure on '%s' is given twice in this step", sets[other].name);
      if (share_edge(sets + other, sets + p->set))
        return gh_yaml_fail(entry, "'%s' and '%s' share edges: pressure would be given twice there",
                            sets[other].name, sets[p->set].name);
    }
  }
  return GH_OK;
}

static gh_status read_displaces(gh_scene *s, node list, scene_step *step) {
  GH_TRY(list_length(list, "displace", &step->ndisplaces));
  GH_TRY(gh_alloc(s->ctx, (size_t)step->ndisplaces, sizeof *step->displaces, &step->displaces));
  for (int k = 0; k < step->ndisplaces; k++) {
    scene_displace *d = step->displaces + k;
    node entry = gh_yaml_item(list, k), n, from;
    const char *names[2] = {"x", "y"};
    GH_TRY(a_map(entry, "displace", KEYS("edge", "set", "x", "y", "from")));
    GH_TRY(find_set(s, entry, "displace", false, &d->set));
    int directions = 0;
    for (int i = 0; i < 2; i++) {
      d->from[i] = d->to[i] = NAN;
      if (!gh_yaml_has(n = gh_yaml_get(entry, names[i]))) continue;
      GH_TRY(number(n, names[i], d->to + i));
      directions++;
    }
    if (directions == 0) return gh_yaml_fail(entry, "displace needs a target: x, y or both");
    if (gh_yaml_has(from = gh_yaml_get(entry, "from"))) {
      if (directions == 2) GH_TRY(pair(from, "from", d->from));
      else GH_TRY(number(from, "from", d->from + (isnan(d->to[0]) ? 1 : 0)));
    }
    for (int j = 0; j < k; j++)
      for (int i = 0; i < 2; i++)
        if (step->displaces[j].set == d->set && !isnan(d->to[i]) && !isnan(step->displaces[j].to[i]))
          return gh_yaml_fail(entry, "the %s displacement of '%s' is given twice in this step", names[i],
                              s->mesh->sets[d->set].name);
  }
  return GH_OK;
}

static gh_status read_forces(gh_scene *s, node list, scene_step *step) {
  GH_TRY(list_length(list, "forces", &step->nforces));
  GH_TRY(gh_alloc(s->ctx, (size_t)step->nforces, sizeof *step->forces, &step->forces));
  for (int k = 0; k < step->nforces; k++) {
    scene_force *f = step->forces + k;
    node entry = gh_yaml_item(list, k), n;
    GH_TRY(a_map(entry, "forces", KEYS("edge", "set", "from", "to")));
    GH_TRY(find_set(s, entry, "forces", false, &f->set));
    GH_TRY(need(entry, "forces", "to", &n));
    GH_TRY(pair(n, "to", f->to));
    f->from[0] = f->from[1] = NAN;
    if (gh_yaml_has(n = gh_yaml_get(entry, "from"))) GH_TRY(pair(n, "from", f->from));
    for (int j = 0; j < k; j++)
      if (step->forces[j].set == f->set)
        return gh_yaml_fail(entry, "the force on '%s' is given twice in this step",
                            s->mesh->sets[f->set].name);
  }
  return GH_OK;
}

/* [gx, gy], or {from: [..], to: [..]} where ramps are possible. */
static gh_status read_step_gravity(node n, scene_step *step) {
  node part;
  step->gravity_from[0] = step->gravity_from[1] = NAN;
  if (!gh_yaml_has(n)) return GH_OK;
  step->gravity = true;
  if (gh_yaml_is_list(n)) return pair(n, "gravity", step->gravity_to);
  GH_TRY(a_map(n, "gravity", KEYS("from", "to")));
  GH_TRY(need(n, "gravity", "to", &part));
  GH_TRY(pair(part, "to", step->gravity_to));
  if (gh_yaml_has(part = gh_yaml_get(n, "from"))) GH_TRY(pair(part, "from", step->gravity_from));
  return GH_OK;
}

static gh_status read_step(gh_scene *s, node n, int index, scene_step *step) {
  node part;
  long count;
  step->line = gh_yaml_line(n);
  GH_TRY(
      a_map(n, "a step",
            KEYS("name", "increments", "supports", "release", "pressure", "displace", "forces", "gravity")));
  char numbered[32];
  const char *name = numbered;
  snprintf(numbered, sizeof numbered, "step %d", index + 1);
  if (gh_yaml_has(part = gh_yaml_get(n, "name"))) GH_TRY(gh_yaml_text(part, "name", &name));
  GH_TRY(copy_text(s->ctx, name, &step->name));
  GH_TRY(need(n, "a step", "increments", &part));
  GH_TRY(gh_yaml_integer(part, "increments", 1, MOST_INCREMENTS, &count));
  step->increments = (int)count;
  GH_TRY(read_fixes(s, gh_yaml_get(n, "supports"), "supports", "fix", &step->supports, &step->nsupports));
  GH_TRY(read_fixes(s, gh_yaml_get(n, "release"), "release", "free", &step->releases, &step->nreleases));
  GH_TRY(read_pressures(s, gh_yaml_get(n, "pressure"), step));
  GH_TRY(read_displaces(s, gh_yaml_get(n, "displace"), step));
  GH_TRY(read_forces(s, gh_yaml_get(n, "forces"), step));
  return read_step_gravity(gh_yaml_get(n, "gravity"), step);
}

static gh_status read_steps(gh_scene *s, node root) {
  node n;
  GH_TRY(need(root, "a scene", "steps", &n));
  if (!gh_yaml_is_list(n) || gh_yaml_length(n) < 1)
    return gh_yaml_fail(n, "steps must be a list of at least one step");
  GH_TRY(gh_alloc(s->ctx, (size_t)gh_yaml_length(n), sizeof *s->steps, &s->steps));
  s->nsteps = gh_yaml_length(n);
  for (int k = 0; k < s->nsteps; k++) GH_TRY(read_step(s, gh_yaml_item(n, k), k, s->steps + k));
  return GH_OK;
}

static gh_status read_start(gh_scene *s, node root) {
  node start = gh_yaml_get(root, "start"), n;
  s->start_line = gh_yaml_line(gh_yaml_has(start) ? start : root);
  if (!gh_yaml_has(start)) return GH_OK;
  GH_TRY(a_map(start, "start", KEYS("confinement", "follow", "balance")));
  bool balance = false;
  GH_TRY(optional_bool(start, "balance", &balance));
  n = gh_yaml_get(start, "confinement");
  if (gh_yaml_has(n) == balance)
    return gh_yaml_fail(start, "start needs one of 'confinement: p' and 'balance: true'");
  if (balance && gh_yaml_has(gh_yaml_get(start, "follow")))
    return gh_yaml_fail(gh_yaml_get(start, "follow"), "follow belongs to a confinement, and start has none");
  s->start = balance ? SCENE_START_BALANCE : SCENE_START_CONFINEMENT;
  if (balance) return GH_OK;
  GH_TRY(positive(n, "confinement", &s->confinement));
  bool follow = false;
  GH_TRY(optional_bool(start, "follow", &follow));
  s->confinement_follow = gh_yaml_has(gh_yaml_get(start, "follow")) ? follow : -1;
  return GH_OK;
}

/* ---- solver, output, the whole ---- */

static gh_status read_solver(gh_scene *s, node root) {
  node solver = gh_yaml_get(root, "solver"), n;
  if (!gh_yaml_has(solver)) return GH_OK;
  GH_TRY(a_map(solver, "solver",
               KEYS("method", "tolerance", "line_search", "max_iterations", "cut_steps", "pass_jumps")));
  if (gh_yaml_has(n = gh_yaml_get(solver, "method"))) {
    const char *word;
    GH_TRY(gh_yaml_text(n, "method", &word));
    if (strcmp(word, "newton") != 0)
      return gh_yaml_fail(n, "method '%s' is not known; there is: newton", word);
  }
  GH_TRY(fraction(solver, "tolerance", &s->solver.tolerance));
  GH_TRY(optional_bool(solver, "line_search", &s->solver.line_search));
  GH_TRY(optional_bool(solver, "pass_jumps", &s->solver.pass_jumps));
  GH_TRY(optional_integer(solver, "max_iterations", 1, 10000, &s->solver.max_iterations));
  return optional_integer(solver, "cut_steps", 0, 30, &s->solver.cut_steps);
}

static gh_status read_output(gh_scene *s, node root) {
  node output = gh_yaml_get(root, "output"), list;
  s->nrves = SCENE_FEW_RVES;
  if (!gh_yaml_has(output)) return GH_OK;
  GH_TRY(a_map(output, "output", KEYS("rves")));
  if (!gh_yaml_has(list = gh_yaml_get(output, "rves"))) return GH_OK;
  int points = 4 * s->mesh->nelements;
  if (gh_yaml_is_list(list)) {
    int count = gh_yaml_length(list);
    GH_TRY(gh_alloc(s->ctx, (size_t)count, sizeof *s->rves, &s->rves));
    for (int k = 0; k < count; k++) {
      long point;
      GH_TRY(gh_yaml_integer(gh_yaml_item(list, k), "integration point", 0, points - 1, &point));
      s->rves[k] = (int)point;
      for (int j = 0; j < k; j++)
        if (s->rves[j] == s->rves[k])
          return gh_yaml_fail(gh_yaml_item(list, k), "integration point %ld is given twice", point);
    }
    s->nrves = count;
    return GH_OK;
  }
  const char *word;
  GH_TRY(gh_yaml_text(list, "rves", &word));
  if (strcmp(word, "all") == 0) s->nrves = SCENE_ALL_RVES;
  else if (strcmp(word, "none") == 0) s->nrves = 0;
  else return gh_yaml_fail(list, "rves is '%s', it must be all, none or a list of integration points", word);
  return GH_OK;
}

static gh_status read_labels(gh_scene *s, node root) {
  node n = gh_yaml_get(root, "title"), units = gh_yaml_get(root, "units");
  const char *title = "", *length = "", *force = "";
  if (gh_yaml_has(n)) GH_TRY(gh_yaml_text(n, "title", &title));
  if (gh_yaml_has(units)) {
    GH_TRY(a_map(units, "units", KEYS("length", "force")));
    if (gh_yaml_has(n = gh_yaml_get(units, "length"))) GH_TRY(gh_yaml_text(n, "length", &length));
    if (gh_yaml_has(n = gh_yaml_get(units, "force"))) GH_TRY(gh_yaml_text(n, "force", &force));
  }
  GH_TRY(copy_text(s->ctx, title, &s->title));
  GH_TRY(copy_text(s->ctx, length, &s->length_unit));
  return copy_text(s->ctx, force, &s->force_unit);
}

static gh_status read_root(gh_scene *s, node root, const char *folder) {
  node gravity;
  GH_TRY(a_map(root, "a scene",
               KEYS("title", "units", "packing", "contact", "micro", "start", "mesh", "supports", "gravity",
                    "steps", "solver", "output")));
  GH_TRY(read_labels(s, root));
  GH_TRY(read_contact(s, root));
  GH_TRY(read_micro(s, root));
  GH_TRY(read_solver(s, root));
  GH_TRY(read_mesh(s, root, folder));
  GH_TRY(read_start(s, root));
  GH_TRY(read_fixes(s, gh_yaml_get(root, "supports"), "supports", "fix", &s->supports, &s->nsupports));
  if (gh_yaml_has(gravity = gh_yaml_get(root, "gravity"))) GH_TRY(pair(gravity, "gravity", s->gravity));
  GH_TRY(read_steps(s, root));
  GH_TRY(read_output(s, root));
  return read_packing(s, root, folder);
}

/* The file as it is, for run.json. */
static gh_status keep_text(gh_scene *s, const char *path) {
  FILE *file = fopen(path, "rb");
  if (!file) return gh_fail(s->ctx, GH_INPUT, "%s: cannot be opened", path);
  size_t length = 0, capacity = 0, got;
  gh_status status;
  do {
    GH_TRY_OR(gh_grow(s->ctx, length + 4097, 1, &capacity, &s->text), done);
    got = fread(s->text + length, 1, 4096, file);
    length += got;
  } while (got > 0);
  s->text[length] = 0;
  status = ferror(file) ? gh_fail(s->ctx, GH_INPUT, "%s: cannot be read", path) : GH_OK;
done:
  fclose(file);
  return status;
}

gh_status gh_scene_read(gh_context *ctx, const char *path, gh_scene **scene) {
  *scene = NULL;
  gh_yaml *doc = NULL;
  char *folder = NULL;
  gh_status status = gh_yaml_read(ctx, path, &doc);
  if (status != GH_OK) return status;
  GH_TRY_OR(gh_alloc(ctx, 1, sizeof **scene, scene), done);
  gh_scene *s = *scene;
  s->ctx = ctx;
  s->micro = gh_rve_defaults();
  s->micro.boundary = GH_PERIODIC;
  s->micro.engine = GH_ENGINE_LAMMPS;
  s->solver = gh_macro_defaults();
  GH_TRY_OR(copy_text(ctx, path, &s->path), done);
  folder = gh_path_folder(path);
  if (!folder) {
    status = gh_fail(ctx, GH_MEMORY, "no memory for a path");
    goto done;
  }
  GH_TRY_OR(keep_text(s, path), done);
  GH_TRY_OR(read_root(s, gh_yaml_root(doc), folder), done);
  GH_TRY_OR(scene_program_create(s), done);
  GH_TRY_OR(scene_program_check(s), done);
done:
  free(folder);
  gh_yaml_destroy(&doc);
  if (status != GH_OK) gh_scene_destroy(scene);
  return status;
}

static void destroy_step(scene_step *step) {
  free(step->name);
  free(step->supports);
  free(step->releases);
  free(step->pressures);
  free(step->displaces);
  free(step->forces);
}

void gh_scene_destroy(gh_scene **scene) {
  if (!scene || !*scene) return;
  gh_scene *s = *scene;
  scene_program_destroy(s);
  for (int k = 0; k < s->nsteps; k++) destroy_step(s->steps + k);
  gh_packing_destroy(&s->packing);
  gh_mesh_destroy(&s->mesh);
  free(s->steps);
  free(s->supports);
  free(s->rves);
  free(s->path);
  free(s->text);
  free(s->title);
  free(s->length_unit);
  free(s->force_unit);
  free(s->packing_path);
  free(s);
  *scene = NULL;
}

void gh_scene_set_engine(gh_scene *scene, gh_engine_kind engine) {
  scene->micro.engine = engine;
}
