/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Reads a scene file and what it names. Every complaint begins with file:line. */
#include "io/file.h"
#include "scene/read.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ELEMENTS = 1000000 };

/* ---- material: contact, micro ---- */

/* The number at an optional key of `contact`, 0 or more. */
static gh_status optional_amount(node map, const char *key, double *value) {
  node n = gh_yaml_get(map, key);
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(gh_yaml_finite(n, key, value));
  if (!(*value >= 0)) return gh_yaml_fail(n, "%s is %g, it must not be negative", key, *value);
  return GH_OK;
}

/* The coefficient of friction, from one of two keys. */
static gh_status read_friction(gh_contact_law *law, node contact) {
  node angle = gh_yaml_get(contact, "friction_angle"), mu = gh_yaml_get(contact, "friction_coefficient");
  double degrees = 0;
  if (gh_yaml_has(angle) && gh_yaml_has(mu))
    return gh_yaml_fail(mu, "friction_angle and friction_coefficient say the same: give one of them");
  law->friction = gh_yaml_has(angle) || gh_yaml_has(mu);
  GH_TRY(optional_amount(contact, "friction_coefficient", &law->friction_coefficient));
  if (!gh_yaml_has(angle)) return GH_OK;
  GH_TRY(optional_amount(contact, "friction_angle", &degrees));
  if (!(degrees < 90))
    return gh_yaml_fail(angle, "friction_angle is %g, it must be below 90 degrees", degrees);
  law->friction_coefficient = tan(degrees * acos(-1) / 180);
  return GH_OK;
}

static gh_status read_tangential(gh_contact_law *law, node contact) {
  static const char *const keys[] = {"tangential_stiffness", "hardening", "hardening_law", "rotations",
                                     "slip"};
  int slip, hardening;
  for (size_t k = 0; k < sizeof keys / sizeof *keys && !law->friction; k++) {
    node n = gh_yaml_get(contact, keys[k]);
    if (gh_yaml_has(n))
      return gh_yaml_fail(n, "%s needs friction: friction_angle or friction_coefficient", keys[k]);
  }
  if (!law->friction) return GH_OK;
  node n = gh_yaml_get(contact, "tangential_stiffness");
  law->tangential_stiffness = law->normal_stiffness;
  if (gh_yaml_has(n)) GH_TRY(gh_yaml_positive(n, "tangential_stiffness", &law->tangential_stiffness));
  GH_TRY(optional_amount(contact, "hardening", &law->hardening));
  GH_TRY(
      scene_optional_choice(contact, "rotations", (const char *[]){"free", "fixed"}, &law->fixed_rotations));
  GH_TRY(scene_optional_choice(contact, "slip", (const char *[]){"projected", "objective"}, &slip));
  law->slip = slip ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
  GH_TRY(scene_optional_choice(contact, "hardening_law", (const char *[]){"printed", "proportional"},
                               &hardening));
  law->hardening_law = hardening ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
  return GH_OK;
}

/* true, false or the mean overlap over the mean radius (granhom/limits.h). */
static gh_status read_allowed(gh_rve_options *micro, node n) {
  double value;
  bool any;
  const char *text;
  micro->allow_overlap = 0;
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(gh_yaml_text(n, "allow_overlap", &text));
  if (gh_parse_number(text, &value)) return gh_yaml_positive(n, "allow_overlap", &micro->allow_overlap);
  if (gh_yaml_bool(n, "allow_overlap", &any) != GH_OK)
    return gh_yaml_fail(n, "allow_overlap is '%s', it must be true, false or a mean overlap over the radius",
                        text);
  micro->allow_overlap = any ? INFINITY : 0;
  return GH_OK;
}

static gh_status read_contact(gh_scene *s, node root) {
  gh_contact_law *law = &s->micro.law;
  node contact, n;
  GH_TRY(gh_yaml_need(root, "a scene", "contact", &contact));
  GH_TRY(gh_yaml_map(contact, "contact", scene_contact_keys));
  GH_TRY(gh_yaml_need(contact, "contact", "normal_stiffness", &n));
  GH_TRY(gh_yaml_positive(n, "normal_stiffness", &law->normal_stiffness));
  GH_TRY(read_allowed(&s->micro, gh_yaml_get(contact, "allow_overlap")));
  GH_TRY(read_friction(law, contact));
  return read_tangential(law, contact);
}

static gh_status read_mixed(gh_scene *s, node micro) {
  node n = gh_yaml_get(micro, "mixed");
  const char *text;
  if (gh_yaml_has(n) != (s->micro.boundary == GH_MIXED))
    return gh_yaml_has(n) ? gh_yaml_fail(n, "mixed needs boundary: mixed")
                          : gh_yaml_fail(gh_yaml_get(micro, "boundary"),
                                         "boundary mixed needs the key mixed, as x=traction,y=displacement");
  if (!gh_yaml_has(n)) return GH_OK;
  GH_TRY(gh_yaml_text(n, "mixed", &text));
  if (gh_mixed_read(s->ctx, text, s->micro.mixed) == GH_OK) return GH_OK;
  return gh_prefix(s->ctx, GH_INPUT, "%s:%d: ", gh_yaml_path(n), gh_yaml_line(n));
}

static gh_status read_micro(gh_scene *s, node root) {
  node micro = gh_yaml_get(root, "micro"), n;
  if (!gh_yaml_has(micro)) return GH_OK;
  GH_TRY(gh_yaml_map(micro, "micro", scene_micro_keys));
  const char *word;
  if (gh_yaml_has(n = gh_yaml_get(micro, "boundary"))) {
    GH_TRY(gh_yaml_text(n, "boundary", &word));
    if (!gh_boundary_from_name(word, &s->micro.boundary))
      return gh_yaml_fail(n, "boundary '%s' is none of %s", word, gh_boundary_words());
  }
  GH_TRY(read_mixed(s, micro));
  if (gh_yaml_has(n = gh_yaml_get(micro, "engine"))) {
    GH_TRY(gh_yaml_text(n, "engine", &word));
    if (strcmp(word, "lammps") != 0 && strcmp(word, "native") != 0)
      return gh_yaml_fail(n, "engine '%s' is none of lammps, native", word);
    s->micro.engine = strcmp(word, "native") == 0 ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS;
  }
  if (gh_yaml_has(n = gh_yaml_get(micro, "relaxation"))) {
    GH_TRY(gh_yaml_text(n, "relaxation", &word));
    if (!gh_relaxation_from_name(word, &s->micro.relaxation))
      return gh_yaml_fail(n, "relaxation '%s' is none of polished, damped, fire", word);
  }
  if (gh_yaml_has(n = gh_yaml_get(micro, "integration"))) {
    GH_TRY(gh_yaml_text(n, "integration", &word));
    if (!gh_integration_from_name(word, &s->micro.integration))
      return gh_yaml_fail(n, "integration '%s' is neither ramp nor whole", word);
  }
  if (gh_yaml_has(n = gh_yaml_get(micro, "max_steps")))
    GH_TRY(gh_yaml_integer(n, "max_steps", 1, 2000000000, &s->micro.max_steps));
  if (gh_yaml_has(n = gh_yaml_get(micro, "accept"))) GH_TRY(gh_yaml_positive(n, "accept", &s->micro.accept));
  GH_TRY(scene_fraction(micro, "servo_gain", &s->micro.servo_gain));
  GH_TRY(scene_fraction(micro, "servo_tolerance", &s->micro.servo_tolerance));
  GH_TRY(
      scene_optional_integer(micro, "servo_acceleration", 0, GH_SERVO_DEPTH, &s->micro.servo_acceleration));
  GH_TRY(scene_optional_integer(micro, "resident", 1, 1000000000, &s->resident));
  return scene_fraction(micro, "tolerance", &s->micro.tolerance);
}

/* ---- mesh ---- */

static gh_status move_nodes(gh_scene *s, node list) {
  int count;
  if (gh_yaml_has(list) && !gh_yaml_is_list(list))
    return gh_yaml_fail(list, "move must be a list: [{node: [x, y], by: [dx, dy]}, ...]");
  GH_TRY(scene_list_length(list, "move", &count));
  double size = 0;
  for (int k = 0; k < 2 * s->mesh->nnodes; k++) size = fmax(size, fabs(s->mesh->X[k] - s->mesh->X[k % 2]));
  double *old;
  GH_TRY(gh_alloc(s->ctx, 2 * (size_t)s->mesh->nnodes, sizeof *old, &old));
  memcpy(old, s->mesh->X, 2 * (size_t)s->mesh->nnodes * sizeof *old); /* nodes are named by where they were */
  gh_status status = GH_OK;
  for (int k = 0; k < count && status == GH_OK; k++) {
    node entry = gh_yaml_item(list, k), at, by;
    double x[2], d[2];
    GH_TRY_OR(gh_yaml_map(entry, "an entry of move", scene_move_keys), done);
    GH_TRY_OR(gh_yaml_need(entry, "an entry of move", "node", &at), done);
    GH_TRY_OR(gh_yaml_need(entry, "an entry of move", "by", &by), done);
    GH_TRY_OR(scene_pair(at, "node", x), done);
    GH_TRY_OR(scene_pair(by, "by", d), done);
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
  GH_TRY(gh_yaml_map(n, "rectangle", scene_rectangle_keys));
  GH_TRY(gh_yaml_need(n, "rectangle", "size", &part));
  GH_TRY(scene_pair(part, "size", size));
  if (!(size[0] > 0) || !(size[1] > 0))
    return gh_yaml_fail(part, "size [%g, %g] must be above 0", size[0], size[1]);
  GH_TRY(gh_yaml_need(n, "rectangle", "elements", &part));
  if (!gh_yaml_is_list(part) || gh_yaml_length(part) != 2)
    return gh_yaml_fail(part, "elements must be a list of two numbers");
  for (int i = 0; i < 2; i++) {
    long count;
    GH_TRY(gh_yaml_integer(gh_yaml_item(part, i), "elements", 1, MOST_ELEMENTS, &count));
    elements[i] = (int)count;
  }
  if ((double)elements[0] * elements[1] > MOST_ELEMENTS)
    return gh_yaml_fail(part, "%d x %d elements are more than %d", elements[0], elements[1], MOST_ELEMENTS);
  if (gh_yaml_has(part = gh_yaml_get(n, "low"))) GH_TRY(scene_pair(part, "low", low));
  gh_status status = gh_mesh_rectangle(s->ctx, low, size, elements, &s->mesh);
  if (status != GH_OK) gh_prefix(s->ctx, status, "%s:%d: rectangle: ", gh_yaml_path(n), gh_yaml_line(n));
  return status;
}

static gh_status read_mesh(gh_scene *s, node root, const char *folder) {
  node mesh, rectangle, gmsh;
  GH_TRY(gh_yaml_need(root, "a scene", "mesh", &mesh));
  s->mesh_line = gh_yaml_line(mesh);
  GH_TRY(gh_yaml_map(mesh, "mesh", scene_mesh_keys));
  rectangle = gh_yaml_get(mesh, "rectangle");
  gmsh = gh_yaml_get(mesh, "gmsh");
  if (gh_yaml_has(rectangle) == gh_yaml_has(gmsh))
    return gh_yaml_fail(mesh, "mesh needs one of the keys 'rectangle' and 'gmsh'");
  if (gh_yaml_has(gmsh)) {
    const char *name;
    GH_TRY(gh_yaml_text(gmsh, "gmsh", &name));
    s->mesh_path = gh_path_join(folder, name);
    if (!s->mesh_path) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
    gh_status status = gh_mesh_read_gmsh(s->ctx, s->mesh_path, &s->mesh);
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

/* ---- start ---- */

static gh_status read_start(gh_scene *s, node root) {
  node start = gh_yaml_get(root, "start"), n;
  s->start_line = gh_yaml_line(gh_yaml_has(start) ? start : root);
  if (!gh_yaml_has(start)) return GH_OK;
  GH_TRY(gh_yaml_map(start, "start", scene_start_keys));
  bool balance = false;
  GH_TRY(scene_optional_bool(start, "balance", &balance));
  n = gh_yaml_get(start, "confinement");
  if (gh_yaml_has(n) == balance)
    return gh_yaml_fail(start, "start needs one of 'confinement: p' and 'balance: true'");
  if (balance && gh_yaml_has(gh_yaml_get(start, "follow")))
    return gh_yaml_fail(gh_yaml_get(start, "follow"), "follow belongs to a confinement, and start has none");
  s->start = balance ? SCENE_START_BALANCE : SCENE_START_CONFINEMENT;
  if (balance) return GH_OK;
  GH_TRY(gh_yaml_positive(n, "confinement", &s->confinement));
  bool follow = false;
  GH_TRY(scene_optional_bool(start, "follow", &follow));
  s->confinement_follow = gh_yaml_has(gh_yaml_get(start, "follow")) ? follow : -1;
  return GH_OK;
}

/* ---- the whole ---- */

static gh_status read_labels(gh_scene *s, node root) {
  node n = gh_yaml_get(root, "title"), units = gh_yaml_get(root, "units");
  const char *title = "", *length = "", *force = "";
  if (gh_yaml_has(n)) GH_TRY(gh_yaml_text(n, "title", &title));
  if (gh_yaml_has(units)) {
    GH_TRY(gh_yaml_map(units, "units", scene_units_keys));
    if (gh_yaml_has(n = gh_yaml_get(units, "length"))) GH_TRY(gh_yaml_text(n, "length", &length));
    if (gh_yaml_has(n = gh_yaml_get(units, "force"))) GH_TRY(gh_yaml_text(n, "force", &force));
  }
  GH_TRY(gh_copy_text(s->ctx, title, &s->title));
  GH_TRY(gh_copy_text(s->ctx, length, &s->length_unit));
  return gh_copy_text(s->ctx, force, &s->force_unit);
}

static gh_status read_root(gh_scene *s, node root, const char *folder) {
  node gravity;
  GH_TRY(gh_yaml_map(root, "a scene", scene_root_keys));
  GH_TRY(read_labels(s, root));
  GH_TRY(read_contact(s, root));
  GH_TRY(read_micro(s, root));
  GH_TRY(scene_read_solver(s, root));
  GH_TRY(read_mesh(s, root, folder));
  GH_TRY(read_start(s, root));
  GH_TRY(scene_read_fixes(s, gh_yaml_get(root, "supports"), "supports", "fix", &s->supports, &s->nsupports));
  if (gh_yaml_has(gravity = gh_yaml_get(root, "gravity"))) GH_TRY(scene_pair(gravity, "gravity", s->gravity));
  s->gravity_line = gh_yaml_line(gravity);
  GH_TRY(scene_read_steps(s, root));
  GH_TRY(scene_read_results(s, root));
  GH_TRY(scene_read_packings(s, root, folder));
  for (int k = 0; k < s->npackings; k++) {
    const gh_status status = gh_rve_check_packing(s->ctx, s->packings[k], &s->micro);
    if (status != GH_OK) return gh_prefix(s->ctx, status, "%s: ", s->packing_paths[k]);
  }
  return GH_OK;
}

gh_status gh_scene_read_material(node root, gh_context *ctx, gh_rve_options *rve) {
  gh_scene s = {.ctx = ctx, .micro = *rve};
  GH_TRY(read_contact(&s, root));
  GH_TRY(read_micro(&s, root));
  *rve = s.micro;
  return GH_OK;
}

/* Sets the keys in the document, and notes them. */
static gh_status override(gh_scene *s, gh_yaml *doc, int n, const gh_override *overrides) {
  GH_TRY(gh_alloc(s->ctx, (size_t)n, sizeof *s->override_key, &s->override_key));
  GH_TRY(gh_alloc(s->ctx, (size_t)n, sizeof *s->override_value, &s->override_value));
  s->noverrides = n;
  for (int k = 0; k < n; k++) {
    GH_TRY(gh_copy_text(s->ctx, overrides[k].key, &s->override_key[k]));
    GH_TRY(gh_copy_text(s->ctx, overrides[k].value, &s->override_value[k]));
    GH_TRY(gh_yaml_set(doc, overrides[k].key, overrides[k].value));
  }
  return GH_OK;
}

gh_status gh_scene_read(gh_context *ctx, const char *path, gh_scene **scene) {
  return gh_scene_read_with(ctx, path, 0, NULL, scene);
}

gh_status gh_scene_read_with(gh_context *ctx, const char *path, int n, const gh_override *overrides,
                             gh_scene **scene) {
  *scene = NULL;
  gh_yaml *doc = NULL;
  char *folder = NULL;
  gh_status status = gh_yaml_read(ctx, path, &doc);
  GH_TRY_OR(status, done);
  GH_TRY_OR(gh_alloc(ctx, 1, sizeof **scene, scene), done);
  gh_scene *s = *scene;
  s->ctx = ctx;
  s->micro = gh_rve_defaults();
  s->micro.boundary = GH_PERIODIC;
  s->micro.engine = GH_ENGINE_LAMMPS;
  s->solver = gh_macro_defaults();
  s->ranks = 1;
  GH_TRY_OR(gh_copy_text(ctx, path, &s->path), done);
  folder = gh_path_folder(path);
  if (!folder) {
    status = gh_fail(ctx, GH_MEMORY, "no memory for a path");
    goto done;
  }
  GH_TRY_OR(gh_file_text(ctx, path, &s->text) /* as it is, for run.json */, done);
  GH_TRY_OR(override(s, doc, n, overrides), done);
  GH_TRY_OR(read_root(s, gh_yaml_root(doc), folder), done);
  GH_TRY_OR(scene_program_create(s), done);
  GH_TRY_OR(scene_check_stresses(s), done);
  GH_TRY_OR(scene_program_check(s), done);
  GH_TRY_OR(scene_names_check(s), done);
done:
  free(folder);
  gh_yaml_destroy(&doc);
  if (status != GH_OK) gh_scene_destroy(scene);
  return gh_file_expect(ctx, status, path, GH_FILE_SCENE);
}

static void destroy_step(scene_step *step) {
  free(step->name);
  free(step->supports);
  free(step->releases);
  free(step->pressures);
  free(step->displaces);
  free(step->forces);
  free(step->footings);
}

void gh_scene_destroy(gh_scene **scene) {
  if (!scene || !*scene) return;
  gh_scene *s = *scene;
  scene_program_destroy(s);
  for (int k = 0; k < s->nsteps; k++) destroy_step(s->steps + k);
  scene_packings_destroy(s);
  free(s->mesh_path);
  gh_mesh_destroy(&s->mesh);
  free(s->steps);
  free(s->supports);
  free(s->rves);
  free(s->dumps);
  for (int k = 0; k < s->noverrides; k++) {
    free(s->override_key[k]);
    free(s->override_value[k]);
  }
  free(s->override_key);
  free(s->override_value);
  free(s->path);
  free(s->text);
  free(s->title);
  free(s->length_unit);
  free(s->force_unit);
  free(s);
  *scene = NULL;
}

void gh_scene_set_engine(gh_scene *scene, gh_engine_kind engine) {
  scene->micro.engine = engine;
}

void gh_scene_set_sharing(gh_scene *scene, bool share) {
  scene->no_share = !share;
}

void gh_scene_set_ranks(gh_scene *scene, int ranks, bool no_balance) {
  scene->ranks = ranks;
  scene->no_balance = no_balance;
}
