/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Scenes: what is read, what acts when, what is derived from stresses. */
#include "../help.h"
#include "scene/internal.h"

#include <stdio.h>
#include <unistd.h>

#define HEAD                                                                                                 \
  "packing: scenes/block/sand150.data\ncontact: {normal_stiffness: 50}\n"                                    \
  "mesh: {rectangle: {size: [100, 100], elements: [3, 3]}}\n"                                                \
  "supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]\n"

enum { LEFT, RIGHT, BOTTOM, TOP }; /* sets of a rectangle */

/* Reads text as a scene; the file stands in the working directory, as its packing is named from there. */
static gh_status read_text(gh_context *ctx, const char *text, gh_scene **scene) {
  char path[64];
  snprintf(path, sizeof path, "test_scene_%ld.yaml", (long)getpid());
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
  gh_status status = gh_scene_read(ctx, path, scene);
  unlink(path);
  return status;
}

static gh_scene *scene_of(gh_context *ctx, const char *text) {
  gh_scene *scene;
  OK(read_text(ctx, text, &scene));
  return scene;
}

typedef struct plan {
  gh_context *ctx;
  gh_scene *scene;
  gh_loads *loads;
} plan;

static plan plan_of(gh_context *ctx, const char *text) {
  plan p = {.ctx = ctx, .scene = scene_of(ctx, text)};
  OK(gh_loads_create(ctx, gh_scene_mesh(p.scene), &p.loads));
  return p;
}
static void plan_free(plan *p) {
  gh_loads_destroy(&p->loads);
  gh_scene_destroy(&p->scene);
}
/* Goes through a step and returns what acts on a set at the end of `increment`. */
static gh_scene_load at(plan *p, int step, int increment, const double *u, int set) {
  gh_context *ctx = p->ctx;
  gh_scene_load load;
  for (int k = 1; k <= increment; k++) OK(gh_scene_loads(p->scene, step, k, u, p->loads));
  gh_scene_load_on(p->scene, set, &load);
  return load;
}

/* The scene of the user guide's first page reads as it stands and gives the loads that it states. */
static void example(void **state) {
  gh_context *ctx = *state;
  plan p = plan_of(
      ctx, HEAD
      "title: Rectangular block under side pressure\n"
      "micro: {boundary: periodic, tolerance: 1e-8}\nstart: {confinement: 0.01}\n"
      "steps:\n  - name: confine\n    increments: 10\n    supports: [{edge: top, fix: y}]\n"
      "    pressure: [{edge: right, from: 0.01, to: 0.2}]\n"
      "  - name: compress\n    increments: 30\n    displace: [{edge: top, y: -3}]\n"
      "solver: {method: newton, tolerance: 1e-8, line_search: true, max_iterations: 20, cut_steps: 6}\n");
  assert_int_equal(gh_scene_steps(p.scene), 2);
  assert_string_equal(gh_scene_step_name(p.scene, 2), "compress");
  assert_int_equal(gh_scene_increments(p.scene, 2), 30);
  gh_scene_load right = at(&p, 0, 1, NULL, RIGHT), top;
  assert_true(right.pressure == 0.01 && !right.follow);
  gh_scene_load_on(p.scene, TOP, &top);
  assert_true(top.pressure == 0 && top.held[1] && !top.held[0] && top.displacement[1] == 0);
  right = at(&p, 1, 1, NULL, RIGHT);
  NEAR("pressure", right.pressure, 0.029, 1e-15);
  right = at(&p, 1, 10, NULL, RIGHT);
  assert_true(right.pressure == 0.2);
  top = at(&p, 2, 15, NULL, TOP);
  NEAR("u of top", top.displacement[1], -1.5, 1e-15);
  gh_scene_load_on(p.scene, RIGHT, &right);
  assert_true(right.pressure == 0.2);
  plan_free(&p);
}

/* Without `from` a pressure, a force and a weight start at their present values, and they stay when a step
 * does not name them. */
static void ramps_start_where_they_are(void **state) {
  gh_context *ctx = *state;
  plan p =
      plan_of(ctx, HEAD
              "gravity: [0, -1]\nsteps:\n"
              "  - {increments: 2, pressure: [{edge: top, to: 4}], forces: [{set: right, to: [6, 0]}]}\n"
              "  - {increments: 4, pressure: [{edge: right, to: 8, follow: true}], gravity: {to: [0, -5]}}\n"
              "  - {increments: 4, pressure: [{edge: top, to: 0}], forces: [{set: right, to: [2, 4]}]}\n");
  double b[2];
  at(&p, 0, 1, NULL, TOP);
  gh_scene_gravity(p.scene, b);
  assert_true(b[1] == -1);
  assert_true(at(&p, 1, 1, NULL, TOP).pressure == 2);
  assert_true(at(&p, 1, 2, NULL, RIGHT).force[0] == 6);
  gh_scene_load right = at(&p, 2, 1, NULL, RIGHT);
  assert_true(right.pressure == 2 && right.follow && right.force[0] == 6);
  gh_scene_gravity(p.scene, b);
  assert_true(b[1] == -2);
  assert_true(at(&p, 2, 4, NULL, TOP).pressure == 4);
  assert_true(at(&p, 3, 1, NULL, TOP).pressure == 3);
  gh_scene_load_on(p.scene, RIGHT, &right);
  assert_true(right.force[0] == 5 && right.force[1] == 1 && right.pressure == 8);
  plan_free(&p);
}

/* A driven edge starts at the displacement of its nodes, stays where it came to, and is free after its
 * release. */
static void driven_edges(void **state) {
  gh_context *ctx = *state;
  plan p = plan_of(ctx, HEAD "steps:\n  - {increments: 4, pressure: [{edge: top, to: 1}]}\n"
                             "  - {increments: 4, displace: [{edge: top, y: -3}]}\n  - {increments: 1, "
                             "pressure: [{edge: right, to: 1}]}\n"
                             "  - {increments: 1, release: [{edge: top, free: y}]}\n");
  double u[32] = {0};
  for (int n = 12; n < 16; n++) u[2 * n + 1] = -1 - 0.1 * (n - 12); /* the top row, tilted: -1 ... -1.3 */
  assert_false(at(&p, 0, 1, NULL, TOP).held[1]);
  assert_false(at(&p, 1, 4, NULL, TOP).held[1]);
  gh_scene_load top = at(&p, 2, 1, u, TOP);
  assert_true(top.held[1] && !top.held[0]);
  NEAR("u of top", top.displacement[1], -1.15 + 0.25 * (-3 + 1.15), 1e-15);
  NEAR("u of a node", p.scene->present.u[2 * 15 + 1].now, -1.3 + 0.25 * (-3 + 1.3), 1e-15);
  assert_true(at(&p, 2, 4, u, TOP).displacement[1] == -3);
  for (int n = 12; n < 16; n++) u[2 * n + 1] = -3;
  top = at(&p, 3, 1, u, TOP);
  assert_true(top.held[1] && top.displacement[1] == -3);
  assert_false(at(&p, 4, 1, u, TOP).held[1]);
  plan_free(&p);
}

/* A support of one step holds the nodes where they are, and ends with its step. */
static void supports_hold_where_nodes_are(void **state) {
  gh_context *ctx = *state;
  plan p =
      plan_of(ctx, HEAD "steps:\n  - {increments: 1, pressure: [{edge: top, to: 1}]}\n"
                        "  - {increments: 2, supports: [{edge: right, fix: both}]}\n  - {increments: 1}\n");
  double u[32] = {0};
  for (int n = 0; n < 16; n++) u[2 * n] = 0.01 * n;
  at(&p, 0, 1, NULL, TOP);
  at(&p, 1, 1, NULL, TOP);
  gh_scene_load right = at(&p, 2, 1, u, RIGHT);
  assert_true(right.held[0] && right.held[1]);
  NEAR("u of right", right.displacement[0], 0.01 * (3 + 7 + 11 + 15) / 4, 1e-15);
  assert_true(p.scene->present.u[2 * 11].now == 0.01 * 11);
  assert_false(at(&p, 3, 1, u, RIGHT).held[0]);
  plan_free(&p);
}

/* A confinement without any pressure in the steps acts on all edges that are free along their normal, also in
 * a step that drives another. */
static void confinement_on_free_edges(void **state) {
  gh_context *ctx = *state;
  plan p = plan_of(ctx, HEAD "start: {confinement: 0.5, follow: true}\nsteps: [{increments: 1, forces: "
                             "[{edge: top, to: [1, 0]}]}]\n");
  gh_scene_load load;
  static const double expected[4] = {[RIGHT] = 0.5, [TOP] = 0.5};
  at(&p, 0, 1, NULL, TOP);
  for (int set = LEFT; set <= TOP; set++) {
    gh_scene_load_on(p.scene, set, &load);
    assert_true(load.pressure == expected[set] && load.follow == (expected[set] > 0));
  }
  plan_free(&p);
  p = plan_of(ctx,
              HEAD "start: {confinement: 0.5}\nsteps: [{increments: 1, displace: [{edge: top, y: -1}]}]\n");
  assert_true(at(&p, 0, 1, NULL, TOP).pressure == 0);
  assert_true(at(&p, 1, 1, NULL, RIGHT).pressure == 0.5);
  plan_free(&p);
}

/* Wrong scenes are GH_INPUT with the line, and leave no scene. */
static void wrong_scenes(void **state) {
  gh_context *ctx = *state;
  static const struct {
    const char *text, *message;
  } wrong[] = {{HEAD, "steps"},
               {HEAD "steps: [{increments: 0}]\n", ":5: increments"},
               {HEAD "steps: [{increments: 1, supports: [{edge: top}]}]\n", "'fix'"},
               {HEAD "steps: [{increments: 1}]\noutput: {rves: [36]}\n", ":6: integration point"},
               {HEAD "steps: [{increments: 1}]\noutput: {rves: [3, 3]}\n", "twice"},
               {HEAD "steps: [{increments: 1}]\nsolver: {method: explicit}\n", ":6: method 'explicit'"},
               {HEAD "steps: [{increments: 1}]\nstart: {follow: true}\n", "confinement"}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    gh_scene *scene;
    assert_int_equal(read_text(ctx, wrong[k].text, &scene), GH_INPUT);
    assert_null(scene);
    if (!strstr(gh_message(ctx), wrong[k].message)) print_error("%s\n", gh_message(ctx));
    assert_non_null(strstr(gh_message(ctx), wrong[k].message));
    assert_non_null(strstr(gh_message(ctx), ".yaml:"));
  }
}

/* All nine scenes of the block read. */
static void block_scenes(void **state) {
  gh_context *ctx = *state;
  static const char *const boundary[] = {"taylor", "restricted", "periodic"};
  for (int p = 1; p <= 3; p++)
    for (int b = 0; b < 3; b++) {
      char path[64];
      gh_scene *scene;
      snprintf(path, sizeof path, "scenes/block/p%02d_%s.yaml", p, boundary[b]);
      OK(gh_scene_read(ctx, path, &scene));
      NEAR("pressure", scene->steps[0].pressures[0].to, 0.1 * p, 1e-15);
      assert_string_equal(gh_boundary_name(scene->micro.boundary), boundary[b]);
      gh_scene_destroy(&scene);
    }
}

/* An explanation names the boundary condition, the engine and what is left out. */
static void explanation(void **state) {
  gh_context *ctx = *state;
  gh_scene *scene = scene_of(ctx, HEAD "micro: {boundary: taylor}\nsteps: [{increments: 1}]\n");
  gh_text *text;
  OK(gh_text_create(ctx, &text));
  gh_scene_set_engine(scene, GH_ENGINE_NATIVE);
  gh_scene_explain(scene, text);
  const char *words = gh_text_get(text, NULL);
  assert_non_null(strstr(words, "taylor"));
  assert_non_null(strstr(words, "native"));
  assert_non_null(strstr(words, "36"));
  assert_non_null(strstr(words, "rotations"));
  gh_text_destroy(&text);
  gh_scene_destroy(&scene);
}

/* Von Mises stress in the plane: zero under equal pressure, sqrt(3)/2 |s| uniaxial, sqrt(3) |t| in shear. */
static void mises(void **state) {
  (void)state;
  assert_true(gh_mises2((double[]){-2, 0, 0, -2}) == 0);
  NEAR("mises", gh_mises2((double[]){-2, 0, 0, 0}), sqrt(3), 1e-15);
  NEAR("mises", gh_mises2((double[]){1, 3, 3, 1}), 3 * sqrt(3), 1e-14);
}

/* A stress that is linear in x and y is extrapolated to the nodes of a rectangle mesh exactly. */
static void nodal_mises(void **state) {
  gh_context *ctx = *state;
  gh_mesh *mesh;
  OK(gh_mesh_rectangle(ctx, (double[]){-1, 2}, (double[]){3, 2}, (int[]){3, 2}, &mesh));
  double gauss[48], cauchy[96], nodes[12];
  gh_mesh_gauss(mesh, gauss);
  for (int p = 0; p < 24; p++) {
    double s[4] = {gauss[2 * p] - 2 * gauss[2 * p + 1], gauss[2 * p + 1], gauss[2 * p + 1], -gauss[2 * p]};
    memcpy(cauchy + 4 * p, s, sizeof s);
  }
  OK(gh_mesh_nodal_mises(ctx, mesh, cauchy, nodes));
  for (int n = 0; n < 12; n++) {
    double x = mesh->X[2 * n], y = mesh->X[2 * n + 1], d = 2 * x - 2 * y;
    NEAR("mises of a node", nodes[n], sqrt(0.75 * d * d + 3 * y * y), 1e-13);
  }
  gh_mesh_destroy(&mesh);
}

/* The boundary of a rectangle of 3 x 2 elements has 10 sides and runs around it once. */
static void boundary(void **state) {
  gh_context *ctx = *state;
  gh_mesh *mesh;
  gh_mesh_edge *edges;
  int count;
  double area = 0;
  OK(gh_mesh_rectangle(ctx, (double[]){0, 0}, (double[]){3, 2}, (int[]){3, 2}, &mesh));
  OK(gh_mesh_boundary_edges(ctx, mesh->nelements, (const int(*)[4])mesh->quad, &edges, &count));
  assert_int_equal(count, 10);
  for (int k = 0; k < count; k++) {
    const double *a = mesh->X + 2 * edges[k].a, *b = mesh->X + 2 * edges[k].b;
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  NEAR("area", area, 6, 1e-14);
  free(edges);
  gh_mesh_destroy(&mesh);
}

/* Keys that are set come before what is read of the file, and their errors have the line of what they
 * replace. */
static void overrides(void **state) {
  gh_context *ctx = *state;
  gh_scene *scene;
  char path[64];
  static const char text[] = HEAD "micro: {tolerance: 1e-8}\nsteps:\n  - {increments: 3}\n";
  const gh_override good[] = {{"steps.0.increments", "7"}, {"mesh.rectangle.elements", "[1, 2]"}},
                    wrong[] = {{"micro.engine", "native"}, {"micro.tolerance", "3"}},
                    nowhere[] = {{"steps.1.increments", "7"}};
  snprintf(path, sizeof path, "test_override_%ld.yaml", (long)getpid());
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
  gh_status status = gh_scene_read_with(ctx, path, 2, good, &scene);
  if (status == GH_OK) {
    assert_true(gh_scene_increments(scene, 1) == 7 && gh_scene_mesh(scene)->nelements == 2);
    assert_string_equal(scene->text, text); /* as it is in the file; what was set stands beside */
    assert_true(scene->noverrides == 2);
    assert_string_equal(scene->override_key[1], "mesh.rectangle.elements");
    assert_string_equal(scene->override_value[1], "[1, 2]");
  }
  gh_scene_destroy(&scene);
  gh_status refused = gh_scene_read_with(ctx, path, 2, wrong, &scene);
  char message[256];
  snprintf(message, sizeof message, "%s", gh_message(ctx));
  gh_status lost = gh_scene_read_with(ctx, path, 1, nowhere, &scene);
  unlink(path);
  OK(status);
  assert_true(refused == GH_INPUT && lost == GH_INPUT && !scene);
  assert_non_null(strstr(message, ".yaml:5: tolerance is 3, it must be below 1"));
  assert_non_null(strstr(gh_message(ctx), ".yaml:7: 'steps.1.increments': there is no entry 1"));
}

typedef struct seen {
  int calls, step, increment, last;
  double ux;
} seen;

static gh_status see(void *data, int step, int increment, int increments, const gh_macro *macro) {
  seen *s = data;
  s->calls++, s->step = step, s->increment = increment, s->last = increments;
  s->ux = gh_macro_u(macro)[2 * 3]; /* the last node of one element, above on the right */
  return s->calls == 3 ? GH_STOPPED : GH_OK;
}

/* Without a folder a run is seen by its observer alone, which can end it. */
static void observed(void **state) {
  gh_context *ctx = *state;
  seen s = {0};
  gh_run_options options = {.observe = see, .observe_data = &s, .restart = true};
  gh_run_summary sum;
  gh_scene *scene = scene_of(
      ctx, "packing: tests/data/cases/packings/p50.data\ncontact: {normal_stiffness: 50}\n"
           "micro: {boundary: taylor, engine: native}\nstart: {balance: true}\n"
           "mesh: {rectangle: {size: [1, 1], elements: [1, 1]}}\nsupports: [{edge: bottom, fix: both}]\n"
           "steps: [{increments: 4, displace: [{edge: top, x: 0.004}]}]\n");
  assert_int_equal(gh_scene_run(scene, NULL, &options, &sum), GH_STOPPED);
  assert_true(s.calls == 3 && s.step == 1 && s.increment == 2 && s.last == 4); /* the start, then two */
  NEAR("displacement of the driven edge", s.ux, 0.002, 1e-15);
  assert_int_equal(sum.increments, 2);
  gh_scene_destroy(&scene);
}

/* A prescribed displacement of any step goes before later loads; of the loads the last step's, a footing
 * first. */
static void last_loading(void **state) {
  gh_context *ctx = *state;
  static const struct {
    const char *steps;
    gh_scene_loading loading;
    int set;
  } cases[] = {{"  - {increments: 1, displace: [{edge: top, y: -1}]}\n  - {increments: 1, pressure: [{edge: "
                "right, to: 1}]}\n",
                GH_LOADING_DISPLACEMENT, TOP},
               {"  - {increments: 1, pressure: [{edge: top, to: 1}]}\n  - {increments: 1, pressure: [{edge: "
                "right, to: 1}]}\n",
                GH_LOADING_FORCE, RIGHT},
               {"  - {increments: 1, pressure: [{edge: right, to: 1}], forces: [{edge: top, to: [0, -1]}]}\n",
                GH_LOADING_FORCE, RIGHT},
               {"  - {increments: 1}\n", GH_LOADING_NONE, -1}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char text[1024];
    int set = -2, packings = 0;
    snprintf(text, sizeof text, HEAD "units: {length: mm, force: N}\nsteps:\n%s", cases[k].steps);
    gh_scene *scene = scene_of(ctx, text);
    assert_int_equal(gh_scene_last_loading(scene, &set), cases[k].loading);
    assert_int_equal(set, cases[k].set);
    assert_string_equal(gh_scene_length_unit(scene), "mm");
    assert_string_equal(gh_scene_force_unit(scene), "N");
    assert_string_equal(gh_scene_packing_files(scene, &packings)[0], "./scenes/block/sand150.data");
    assert_int_equal(packings, 1);
    gh_scene_destroy(&scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(example),
                                     TEST(last_loading),
                                     TEST(ramps_start_where_they_are),
                                     TEST(driven_edges),
                                     TEST(supports_hold_where_nodes_are),
                                     TEST(confinement_on_free_edges),
                                     TEST(wrong_scenes),
                                     TEST(block_scenes),
                                     TEST(explanation),
                                     TEST(mises),
                                     TEST(nodal_mises),
                                     TEST(boundary),
                                     TEST(overrides),
                                     TEST(observed)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
