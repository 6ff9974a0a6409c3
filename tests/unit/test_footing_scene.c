/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Footings of scenes: their loads step by step, and wrong ones. */
#include "../help.h"
#include "macro/internal.h"
#include "scene/internal.h"

#include <stdio.h>
#include <unistd.h>

#define HEAD                                                                                                 \
  "packing: scenes/block/sand150.data\ncontact: {normal_stiffness: 50}\nstart: {balance: true}\n"            \
  "mesh: {rectangle: {size: [8, 4], elements: [4, 2]}}\nsupports: [{edge: bottom, fix: both}]\n"

/* Reads text as a scene; the file stands in the working directory, as its packing is named from there. */
static gh_status read_text(gh_context *ctx, const char *text, gh_scene **scene) {
  char path[64];
  snprintf(path, sizeof path, "test_footing_%ld.yaml", (long)getpid());
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
  gh_status status = gh_scene_read(ctx, path, scene);
  unlink(path);
  return status;
}

static void assert_load(gh_context *ctx, gh_scene *scene, gh_loads *loads, int step, int increment,
                        const double f[2], const double moment) {
  OK(gh_scene_loads(scene, step, increment, NULL, loads));
  assert_int_equal(loads->nfootings, 1);
  const gh_footing_load *load = loads->footing;
  for (int i = 0; i < 2; i++) NEAR("force", load->force[i], f[i], 1e-14);
  NEAR("moment", load->arm[2] - load->arm[1], moment, 1e-13);
}

/* Ramps: from nothing, from where they are, and to another point, where the old force fades. */
static void test_scene(void **state) {
  gh_context *ctx = *state;
  gh_scene *scene;
  gh_loads *loads;
  OK(read_text(ctx,
               HEAD
               "steps:\n"
               "  - {increments: 4, footing: [{edge: top, force: [1, -8], eccentricity: 0.5}]}\n"
               "  - {increments: 1, gravity: [0, -1]}\n"
               "  - {increments: 2, footing: [{edge: top, force: [0, -4], at: [3, 5]}]}\n"
               "  - {increments: 2, footing: [{edge: top, force: [0, -2], from: [0, -1], at: [3, 5]}]}\n",
               &scene));
  OK(gh_loads_create(ctx, gh_scene_mesh(scene), &loads));
  assert_load(ctx, scene, loads, 0, 1, (double[2]){0, 0}, 0);
  for (int k = 1; k <= 4; k++)
    assert_load(ctx, scene, loads, 1, k, (double[2]){0.25 * k, -2.0 * k}, -1.0 * k);
  assert_load(ctx, scene, loads, 2, 1, (double[2]){1, -8}, -4);
  /* half the old (1, -8) at (4.5, 4), half the new (0, -4) at (3, 5), about (4, 4) */
  assert_load(ctx, scene, loads, 3, 1, (double[2]){0.5, -6}, -2 + 2);
  assert_load(ctx, scene, loads, 3, 2, (double[2]){0, -4}, 4);
  assert_load(ctx, scene, loads, 4, 1, (double[2]){0, -1.5}, 1.5);
  assert_load(ctx, scene, loads, 4, 2, (double[2]){0, -2}, 2);
  gh_loads_destroy(&loads);
  gh_scene_destroy(&scene);
}

static void test_scene_errors(void **state) {
  static const struct {
    const char *text, *words;
  } cases[] = {
      {"footing: [{edge: top}]", "yaml:6: footing needs the key 'force'"},
      {"footing: [{edge: roof, force: [0, 0]}]", "yaml:6: there is no edge or set 'roof'"},
      {"footing: [{edge: top, force: [0]}]", "yaml:6: "},
      {"footing: [{edge: top, force: [0, 1], at: [1, 1], eccentricity: 2}]", "yaml:6: footing: give 'at' or"},
      {"footing: [{edge: top, force: [0, 1], rough: true}]", "yaml:6: "},
      {"footing: [{edge: top, force: [0, 1]}, {edge: top, force: [0, 1]}]",
       "yaml:6: the footing on 'top' is given "},
      {"footing: [{edge: top, force: [0, 1]}, {edge: left, force: [0, 1]}]",
       "yaml:6: the footings on left and top share node"},
      {"footing: [{edge: top, force: [0, 1]}], supports: [{edge: left, fix: x}]",
       "yaml:6: the footing on 'top' cannot move its node at (0, 4): a support or a displacement holds it in "
       "x in "},
      {"footing: [{edge: top, force: [0, 1]}], displace: [{edge: right, y: 1}]",
       "yaml:6: the footing on 'top' cannot move its node at (8, 4)"},
  };
  gh_context *ctx = *state;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char text[1024];
    gh_scene *scene;
    snprintf(text, sizeof text, HEAD "steps: [{increments: 1, %s}]\n", cases[k].text);
    FAILS(read_text(ctx, text, &scene), GH_INPUT, cases[k].words);
    assert_null(scene);
  }
  gh_scene *scene;
  FAILS(read_text(
            ctx,
            "packing: scenes/block/sand150.data\ncontact: {normal_stiffness: 50}\nstart: {balance: true}\n"
            "mesh: {rectangle: {size: [8, 4], elements: [4, 2]}, move: [{node: [4, 4], by: [0, 0.1]}]}\n"
            "supports: [{edge: bottom, fix: both}]\nsteps:\n- increments: 1\n  footing:\n"
            "  - {edge: top, force: [0, 1]}\n",
            &scene),
        GH_INPUT, "yaml:9: set top: a footing needs a straight edge");
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_scene), TEST(test_scene_errors)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
