/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Reads the supports and the load steps of a scene. */
#include "scene/read.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_INCREMENTS = 1000000 };

/* The set named by `edge` or `set`. Edges are needed where a pressure acts. */
static gh_status find_set(gh_scene *s, node map, const char *what, bool edges, int *set) {
  node n = gh_yaml_get(map, "edge"), other = gh_yaml_get(map, "set");
  if (gh_yaml_has(n) && gh_yaml_has(other))
    return gh_yaml_fail(map, "%s: give 'edge' or 'set', not both", what);
  if (!gh_yaml_has(n)) n = other;
  if (!gh_yaml_has(n)) return gh_yaml_fail(map, "%s needs the key 'edge'", what);
  const char *name;
  GH_TRY(gh_yaml_text(n, "edge", &name));
  GH_TRY(gh_mesh_find_corner(s->ctx, s->mesh, name, set));
  s->nsets = s->mesh->nsets;
  if (*set < 0) {
    char known[256] = "";
    size_t at = 0;
    for (int k = 0; k < s->nsets && at < sizeof known; k++)
      at += (size_t)snprintf(known + at, sizeof known - at, "%s%s", k ? ", " : "", s->mesh->sets[k].name);
    if (at >= sizeof known) memcpy(known + sizeof known - 4, "...", 4);
    return gh_yaml_fail(n, "there is no edge or set '%s'; the mesh has: %s", name,
                        *known ? known : "none (sets are the physical groups of lines and points)");
  }
  if (edges && s->mesh->sets[*set].nedges == 0)
    return gh_yaml_fail(n, "a %s needs edges of the boundary, and set '%s' has none", what, name);
  if (edges && s->mesh->sets[*set].nlines > 0)
    return gh_yaml_fail(n, "a %s needs edges of the boundary, and %d of the lines of set '%s' %s none", what,
                        s->mesh->sets[*set].nlines, name, s->mesh->sets[*set].nlines == 1 ? "is" : "are");
  return GH_OK;
}

/* [{edge: NAME, KEY: x|y|both}, ...]; key is `fix` or `free`. */
gh_status scene_read_fixes(gh_scene *s, node list, const char *what, const char *key, scene_fix **fixes,
                           int *count) {
  GH_TRY(scene_list_length(list, what, count));
  GH_TRY(gh_alloc(s->ctx, (size_t)*count, sizeof **fixes, fixes));
  for (int k = 0; k < *count; k++) {
    node entry = gh_yaml_item(list, k), n;
    const char *word;
    GH_TRY(gh_yaml_map(entry, what, strcmp(key, "fix") == 0 ? scene_support_keys : scene_release_keys));
    GH_TRY(find_set(s, entry, what, false, &(*fixes)[k].set));
    GH_TRY(gh_yaml_need(entry, what, key, &n));
    GH_TRY(gh_yaml_text(n, key, &word));
    if (strcmp(word, "x") == 0) (*fixes)[k].mask = SCENE_X;
    else if (strcmp(word, "y") == 0) (*fixes)[k].mask = SCENE_Y;
    else if (strcmp(word, "both") == 0) (*fixes)[k].mask = SCENE_X | SCENE_Y;
    else return gh_yaml_fail(n, "%s is '%s', it must be x, y or both", key, word);
  }
  return GH_OK;
}

static gh_status read_pressures(gh_scene *s, node list, scene_step *step) {
  GH_TRY(scene_list_length(list, "pressure", &step->npressures));
  GH_TRY(gh_alloc(s->ctx, (size_t)step->npressures, sizeof *step->pressures, &step->pressures));
  for (int k = 0; k < step->npressures; k++) {
    scene_pressure *p = step->pressures + k;
    node entry = gh_yaml_item(list, k), n;
    p->line = gh_yaml_line(entry);
    GH_TRY(gh_yaml_map(entry, "pressure", scene_pressure_keys));
    GH_TRY(find_set(s, entry, "pressure", true, &p->set));
    GH_TRY(gh_yaml_need(entry, "pressure", "to", &n));
    GH_TRY(gh_yaml_finite(n, "to", &p->to));
    p->from = NAN;
    if (gh_yaml_has(n = gh_yaml_get(entry, "from"))) GH_TRY(gh_yaml_finite(n, "from", &p->from));
    GH_TRY(scene_optional_bool(entry, "follow", &p->follow));
    const gh_mesh_set *sets = s->mesh->sets;
    for (int j = 0; j < k; j++) {
      int other = step->pressures[j].set;
      if (other == p->set)
        return gh_yaml_fail(entry, "the pressure on '%s' is given twice in this step", sets[other].name);
      bool share;
      GH_TRY(gh_mesh_share_edges(s->ctx, sets + other, sets + p->set, &share));
      if (share)
        return gh_yaml_fail(entry, "'%s' and '%s' share edges: pressure would be given twice there",
                            sets[other].name, sets[p->set].name);
    }
  }
  return GH_OK;
}

static gh_status read_displaces(gh_scene *s, node list, scene_step *step) {
  GH_TRY(scene_list_length(list, "displace", &step->ndisplaces));
  GH_TRY(gh_alloc(s->ctx, (size_t)step->ndisplaces, sizeof *step->displaces, &step->displaces));
  for (int k = 0; k < step->ndisplaces; k++) {
    scene_displace *d = step->displaces + k;
    node entry = gh_yaml_item(list, k), n, from;
    const char *names[2] = {"x", "y"};
    d->line = gh_yaml_line(entry);
    GH_TRY(gh_yaml_map(entry, "displace", scene_displace_keys));
    GH_TRY(find_set(s, entry, "displace", false, &d->set));
    int directions = 0;
    for (int i = 0; i < 2; i++) {
      d->from[i] = d->to[i] = NAN;
      if (!gh_yaml_has(n = gh_yaml_get(entry, names[i]))) continue;
      GH_TRY(gh_yaml_finite(n, names[i], d->to + i));
      directions++;
    }
    if (directions == 0) return gh_yaml_fail(entry, "displace needs a target: x, y or both");
    if (gh_yaml_has(from = gh_yaml_get(entry, "from"))) {
      if (directions == 2) GH_TRY(scene_pair(from, "from", d->from));
      else GH_TRY(gh_yaml_finite(from, "from", d->from + (isnan(d->to[0]) ? 1 : 0)));
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
  GH_TRY(scene_list_length(list, "forces", &step->nforces));
  GH_TRY(gh_alloc(s->ctx, (size_t)step->nforces, sizeof *step->forces, &step->forces));
  for (int k = 0; k < step->nforces; k++) {
    scene_force *f = step->forces + k;
    node entry = gh_yaml_item(list, k), n;
    GH_TRY(gh_yaml_map(entry, "forces", scene_force_keys));
    GH_TRY(find_set(s, entry, "forces", false, &f->set));
    GH_TRY(gh_yaml_need(entry, "forces", "to", &n));
    GH_TRY(scene_pair(n, "to", f->to));
    f->from[0] = f->from[1] = NAN;
    if (gh_yaml_has(n = gh_yaml_get(entry, "from"))) GH_TRY(scene_pair(n, "from", f->from));
    for (int j = 0; j < k; j++)
      if (step->forces[j].set == f->set)
        return gh_yaml_fail(entry, "the force on '%s' is given twice in this step",
                            s->mesh->sets[f->set].name);
  }
  return GH_OK;
}

/* Where the force of a footing acts: `at`, or at the distance `eccentricity` from the middle of its edge. */
static gh_status read_point(gh_scene *s, node entry, scene_footing *f) {
  node at = gh_yaml_get(entry, "at"), off = gh_yaml_get(entry, "eccentricity");
  double eccentricity = 0;
  if (gh_yaml_has(at) && gh_yaml_has(off))
    return gh_yaml_fail(entry, "footing: give 'at' or 'eccentricity', not both");
  if (gh_yaml_has(at)) return scene_pair(at, "at", f->at);
  if (gh_yaml_has(off)) GH_TRY(gh_yaml_finite(off, "eccentricity", &eccentricity));
  gh_footing_point(s->mesh, f->set, eccentricity, f->at);
  return GH_OK;
}

static gh_status read_footings(gh_scene *s, node list, scene_step *step) {
  GH_TRY(scene_list_length(list, "footing", &step->nfootings));
  GH_TRY(gh_alloc(s->ctx, (size_t)step->nfootings, sizeof *step->footings, &step->footings));
  for (int k = 0; k < step->nfootings; k++) {
    scene_footing *f = step->footings + k;
    node entry = gh_yaml_item(list, k), n;
    f->line = gh_yaml_line(entry);
    GH_TRY(gh_yaml_map(entry, "footing", scene_footing_keys));
    GH_TRY(find_set(s, entry, "footing", true, &f->set));
    GH_TRY(gh_yaml_need(entry, "footing", "force", &n));
    GH_TRY(scene_pair(n, "force", f->to));
    f->from[0] = f->from[1] = NAN;
    if (gh_yaml_has(n = gh_yaml_get(entry, "from"))) GH_TRY(scene_pair(n, "from", f->from));
    GH_TRY(read_point(s, entry, f));
    for (int j = 0; j < k; j++)
      if (step->footings[j].set == f->set)
        return gh_yaml_fail(entry, "the footing on '%s' is given twice in this step",
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
  step->gravity_line = gh_yaml_line(n);
  if (gh_yaml_is_list(n)) return scene_pair(n, "gravity", step->gravity_to);
  GH_TRY(gh_yaml_map(n, "gravity", scene_gravity_keys));
  GH_TRY(gh_yaml_need(n, "gravity", "to", &part));
  GH_TRY(scene_pair(part, "to", step->gravity_to));
  if (gh_yaml_has(part = gh_yaml_get(n, "from"))) GH_TRY(scene_pair(part, "from", step->gravity_from));
  return GH_OK;
}

static gh_status read_step(gh_scene *s, node n, int index, scene_step *step) {
  node part;
  long count;
  step->line = gh_yaml_line(n);
  GH_TRY(gh_yaml_map(n, "a step", scene_step_keys));
  char numbered[32];
  const char *name = numbered;
  snprintf(numbered, sizeof numbered, "step %d", index + 1);
  if (gh_yaml_has(part = gh_yaml_get(n, "name"))) GH_TRY(gh_yaml_text(part, "name", &name));
  GH_TRY(gh_copy_text(s->ctx, name, &step->name));
  GH_TRY(gh_yaml_need(n, "a step", "increments", &part));
  GH_TRY(gh_yaml_integer(part, "increments", 1, MOST_INCREMENTS, &count));
  step->increments = (int)count;
  GH_TRY(
      scene_read_fixes(s, gh_yaml_get(n, "supports"), "supports", "fix", &step->supports, &step->nsupports));
  GH_TRY(
      scene_read_fixes(s, gh_yaml_get(n, "release"), "release", "free", &step->releases, &step->nreleases));
  GH_TRY(read_pressures(s, gh_yaml_get(n, "pressure"), step));
  GH_TRY(read_displaces(s, gh_yaml_get(n, "displace"), step));
  GH_TRY(read_forces(s, gh_yaml_get(n, "forces"), step));
  GH_TRY(read_footings(s, gh_yaml_get(n, "footing"), step));
  return read_step_gravity(gh_yaml_get(n, "gravity"), step);
}

gh_status scene_read_steps(gh_scene *s, node root) {
  node n;
  GH_TRY(gh_yaml_need(root, "a scene", "steps", &n));
  if (!gh_yaml_is_list(n) || gh_yaml_length(n) < 1)
    return gh_yaml_fail(n, "steps must be a list of at least one step");
  GH_TRY(gh_alloc(s->ctx, (size_t)gh_yaml_length(n), sizeof *s->steps, &s->steps));
  s->nsteps = gh_yaml_length(n);
  for (int k = 0; k < s->nsteps; k++) GH_TRY(read_step(s, gh_yaml_item(n, k), k, s->steps + k));
  return GH_OK;
}
