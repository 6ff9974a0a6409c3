/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Studies: what is read and refused, configurations, references and members, paths. */
#include "study_read_help.h"

/* ---- reading ---- */

static const struct {
  const char *text, *message;
} wrong_studies[] = {
    {SMALL VARY, "study.yaml:1: a study needs the key 'reference'"},
    {SMALL REFERENCE, "study.yaml:1: a study needs the key 'vary'"},
    {VARY REFERENCE, "study.yaml:1: a study needs one of the keys 'scene' and 'rve'"},
    {"scene: a.yaml\n" SMALL VARY REFERENCE, "study.yaml:1: a study needs one of the keys 'scene' and 'rve'"},
    {"scene: none.yaml\n" VARY REFERENCE, "study.yaml:1: "},
    {"vari: {}\n" SMALL VARY REFERENCE, "study.yaml:1: unknown key 'vari', is 'vary' meant?"},
    {SMALL REFERENCE "vary: []\n", "study.yaml:7: vary must be a map of keys and lists"},
    {SMALL REFERENCE "vary: {micro.tolerance: 1e-2}\n", "study.yaml:7: micro.tolerance: a list of values"},
    {SMALL REFERENCE "vary: {micro.tolerance: []}\n", "study.yaml:7: micro.tolerance: a list of values"},
    {SMALL REFERENCE "vary: {micro.tolerance: [1e-2, 0.01]}\n",
     "study.yaml:7: micro.tolerance: the value 0.01 is there twice"},
    {SMALL REFERENCE "vary:\n  micro.tolerance:\n    - 1e-2\n    - 2\n",
     "study.yaml:9: micro.tolerance: 2: "},
    {SMALL REFERENCE "vary: {micro.tolerance: [1e-2, 2]}\n", "tolerance is 2, it must be below 1"},
    {SMALL REFERENCE "vary: {micro.tolerence: [1e-2]}\n", "study.yaml:7: micro.tolerence: 1e-2: "},
    {SMALL REFERENCE "vary: {micro.tolerence: [1e-2]}\n",
     "study.yaml:4: unknown key 'tolerence', is 'tolerance' meant?"},
    {SMALL REFERENCE "base: {micro.boundary: round}\n" VARY, "study.yaml:7: micro.boundary: round: "},
    {SMALL VARY "reference: {set: {micro.tolerance: 0}}\n", "study.yaml:7: micro.tolerance: 0: "},
    {SMALL REFERENCE "vary: {path.legs.1.increments: [1, 2]}\n", "there is no entry 1, the list has 1"},
    {SMALL REFERENCE "vary: {refine: [1, 1.5]}\n", "study.yaml:7: refine: 1.5: refine is '1.5'"},
    {SMALL REFERENCE "vary: {refine: [0]}\n", "it must be an integer from 1 to"},
    {SMALL REFERENCE "vary: {packing: [none-*.data]}\n",
     "study.yaml:7: packing: none-*.data: no file fits this pattern"},
    {SMALL REFERENCE "vary: {packing: [[a, b]]}\n", "a pattern of file names is a list"},
    {SMALL VARY "reference: {}\n", "study.yaml:7: reference needs one of the keys 'set', 'file' and"},
    {SMALL VARY "reference: {set: {}}\n", "study.yaml:7: set has no key"},
    {SMALL VARY "reference: {closed_form: square}\n", "study.yaml:7: closed_form 'square' is not known"},
    {SMALL VARY "reference: {closed_form: triangular-lattice}\n", "study.yaml:7: reference: "},
    {SMALL VARY "reference: {file: none.csv}\n", "none.csv: cannot be opened"},
    {SMALL VARY REFERENCE "order: refine\n", "study.yaml:8: order: 'refine' is none of the keys under vary"},
    {SMALL REFERENCE "vary: {micro.boundary: [taylor, periodic]}\norder: micro.boundary\n",
     "study.yaml:8: order: the values of micro.boundary must be numbers above 0"},
    {SMALL VARY REFERENCE "series: x\n", "study.yaml:8: series: 'x' is none of the keys"},
    {SMALL VARY REFERENCE "goals: [0]\n", "study.yaml:8: a goal is 0, it must be above 0"},
    {SMALL VARY REFERENCE "goals: 1\n", "study.yaml:8: goals must be a list"},
    {SMALL VARY REFERENCE "quantities: [force]\n",
     "study.yaml:8: quantity 'force' is none of stress, energy"},
    {SMALL VARY REFERENCE "quantities: [stress, stress]\n", "quantity 'stress' is there twice"},
    {SMALL VARY REFERENCE "plots: [s33]\n", "study.yaml:8: column 's33' is none of P11, P12"},
    {SMALL REFERENCE "vary: {micro.tolerance: [1e-2], micro: [{boundary: taylor}]}\n",
     "study.yaml:7: micro replaces micro.tolerance as well, which line 6 sets"},
    {SMALL VARY "reference: {set: {micro: {boundary: taylor}}}\n",
     "study.yaml:7: micro replaces micro.tolerance as well, which line 6 sets"},
    {SMALL VARY "reference: {set: {path.legs.0.increments: 4}}\n",
     "study.yaml:7: reference: micro.tolerance 1e-2: at t = 1, F is not that of what it is compared with"},
    {SMALL VARY REFERENCE "quick: {goals: [1]}\n", "study.yaml:8: unknown key 'goals'"},
    {"rve: {packing: @/p20.data, path: {}}\n" VARY REFERENCE, "rve needs the key 'contact'"},
    {"rve: {packing: @/p20.data, contact: {normal_stiffness: 1}}\n" VARY REFERENCE, "needs the key 'path'"},
    {"rve: {packing: @/p20.data, contact: {normal_stiffness: 1}, path: {legs: [{to: [1, 0, 0, -1], "
     "increments: 2}]}}\n" VARY REFERENCE,
     "study.yaml:1: to: [F11, F12, F21, F22] has the determinant -1; it must be positive"},
    {"rve: {packing: @/p20.data, contact: {normal_stiffness: 1}, path: {legs: [{to: [-1, 0, 0, -1], "
     "increments: 2}]}}\n" VARY REFERENCE,
     "study.yaml:1: on the path to it det F is 0 at t = 1; it must be positive"},
    {"rve: {packing: @/p20.data, contact: {normal_stiffness: 1}, path: {file: none.csv}}\n" VARY REFERENCE,
     "none.csv: cannot be opened"}};

/* Each is refused with its message, and nothing is written. */
static void wrong_studies_are_refused(void **state) {
  place *p = *state;
  for (size_t k = 0; k < sizeof wrong_studies / sizeof *wrong_studies; k++) {
    gh_study *s;
    gh_status status = gh_study_read(p->ctx, put(p, "study.yaml", wrong_studies[k].text), false, &s);
    if (status != GH_INPUT || !strstr(gh_message(p->ctx), wrong_studies[k].message))
      fail_msg("case %zu: status %d, message \"%s\" (wanted \"%s\")", k, status, gh_message(p->ctx),
               wrong_studies[k].message);
    assert_null(s);
  }
  assert_int_equal(count_entries(p->folder), 1); /* the study itself: nothing is written */
}

/* A study of a scene names both files, and what is wrong in them. */
static void wrong_scenes_are_refused(void **state) {
  static const struct {
    const char *scene, *study, *message;
  } wrong[] = {
      {SCENE SHEAR, "vary: {micro.tolerance: [5]}\n" REFERENCE,
       "/study.yaml:2: micro.tolerance: 5: %s/scene.yaml:3: tolerance is 5, it must be below 1"},
      {SCENE SHEAR, "vary: {steps.3.increments: [5]}\n" REFERENCE,
       "/study.yaml:2: steps.3.increments: 5: %s/scene.yaml:7: 'steps.3.increments': there is no entry 3"},
      {SCENE "stops: []\n", VARY REFERENCE,
       "/study.yaml:1: %s/scene.yaml:7: unknown key 'stops', is 'steps'"},
      {SCENE SHEAR,
       "vary: {steps.0: [{increments: 1}, {increments: 1, displace: [{edge: top, x: 1}]}]}\n" REFERENCE,
       "/study.yaml:1: steps.0 {increments: 1, displace: [{edge: top, x: 1}]}: here an edge is driven, "
       "unlike"},
      {SCENE SHEAR, VARY REFERENCE "quantities: [energy]\n",
       "/study.yaml:4: quantity 'energy' is none of stress, force, dilatancy"},
      {SCENE SHEAR, VARY "reference: {closed_form: triangular-lattice}\n",
       "/study.yaml:3: a closed form belongs"}};
  place *p = *state;
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char text[1024], message[1024];
    gh_study *s;
    put(p, "scene.yaml", wrong[k].scene);
    snprintf(text, sizeof text, "scene: scene.yaml\n%s", wrong[k].study);
    const char *path = put_file(p, "study.yaml", text), *rest = strstr(wrong[k].message, "%s");
    if (rest) {
      snprintf(message, sizeof message, "%s%.*s%s%s", p->folder, (int)(rest - wrong[k].message),
               wrong[k].message, p->folder, rest + 2);
    } else {
      snprintf(message, sizeof message, "%s%s", p->folder, wrong[k].message);
    }
    assert_int_equal(gh_study_read(p->ctx, path, false, &s), GH_INPUT);
    if (strncmp(gh_message(p->ctx), message, strlen(message)) != 0)
      fail_msg("\"%s\" (wanted \"%s\")", gh_message(p->ctx), message);
  }
}

/* ---- configurations ---- */

/* All combinations, the last parameter fastest; references are shared, and may be rows. */
static void configs_are_planned(void **state) {
  place *p = *state;
  gh_study *s = study_of(
      p, SMALL "vary: {micro.tolerance: [1e-2, 1e-4, 1e-6], micro.boundary: [taylor, periodic]}\n" REFERENCE,
      false);
  assert_int_equal(s->nconfigs, 8); /* one reference for each boundary condition */
  assert_string_equal(s->configs[1].value[0], "1e-2");
  assert_string_equal(s->configs[1].value[1], "periodic");
  assert_string_equal(s->configs[2].value[0], "1e-4");
  for (int k = 0; k < 6; k++) {
    const study_config *r = s->configs + s->configs[k].reference;
    assert_true(r->extra && !s->configs[k].extra && r->choice[0] == -1 && r->choice[1] == k % 2);
    assert_string_equal(r->value[0], "1e-11");
    assert_string_equal(r->value[1], s->configs[k].value[1]);
  }
  assert_true(s->order == -1 && s->series == 0 && s->ngoals == 3 && s->goals[0] == 1e-2);
  assert_true(s->nquantities == 2 && s->main == 0 && s->ncolumns == 9);
  gh_study_destroy(&s);
  /* a value that is among those of the parameter, however it is written: rows are references */
  s = study_of(p,
               SMALL "vary: {micro.tolerance: [1e-2, 1e-6]}\nbase: {micro.boundary: taylor}\n"
                     "reference: {set: {micro.tolerance: 0.000001, micro.boundary: taylor}}\n"
                     "quantities: [energy, stress]\ngoals: [1e-3, 1e-1]\nplots: [energy, s12]\n",
               false);
  assert_int_equal(s->nconfigs, 2);
  assert_true(s->configs[0].reference == 1 && s->configs[1].reference == 1);
  assert_string_equal(s->quantities[0].name, "energy");
  assert_true(s->goals[0] == 1e-1 && s->ngoals == 2 && s->nplots == 2 && s->plots[0] == 8 &&
              s->plots[1] == 5);
  gh_study_destroy(&s);
  /* a key that is no parameter makes a reference for each row */
  s = study_of(p, SMALL VARY "reference: {set: {micro.max_steps: 9999}}\n", false);
  assert_int_equal(s->nconfigs, 4);
  assert_string_equal(s->configs[2].also, "micro.max_steps: 9999");
  assert_true(s->configs[1].reference == 3 && s->configs[3].reference == 3);
  gh_study_destroy(&s);
}

/* --quick takes other values, adds to base, and may have another reference. */
static void quick_studies(void **state) {
  static const char text[] = SMALL "base: {micro.boundary: taylor, micro.max_steps: 999}\nvary: {refine: [1, "
                                   "2, 4], micro.tolerance: [1e-2, "
                                   "1e-3]}\norder: refine\nreference: {set: {refine: 64}}\n"
                                   "quick: {vary: {micro.tolerance: [1e-2]}, base: {micro.boundary: "
                                   "periodic}, reference: {set: {refine: 3}}}\n";
  place *p = *state;
  gh_study *s = study_of(p, text, false);
  assert_true(s->nconfigs == 8 && s->order == 0);
  assert_string_equal(study_value(s, s->configs, "micro.boundary"), "taylor");
  gh_study_destroy(&s);
  s = study_of(p, text, true);
  assert_true(s->nconfigs == 2 && s->order == -1 && s->nparameters == 1);
  assert_string_equal(study_value(s, s->configs, "micro.boundary"), "periodic");
  assert_string_equal(study_value(s, s->configs, "micro.max_steps"), "999");
  assert_string_equal(study_value(s, s->configs + 1, "refine"), "3");
  gh_study_destroy(&s);
  /* a name may be one that the whole study alone has, but not one that none has */
  assert_int_equal(gh_study_read(p->ctx,
                                 put(p, "study.yaml", SMALL VARY REFERENCE "series: micro.x\nquick: {}\n"),
                                 true, &s),
                   GH_INPUT);
  assert_non_null(
      strstr(gh_message(p->ctx), "study.yaml:8: series: 'micro.x' is none of the keys under vary"));
}

static void copy_packing(place *p, const char *from, const char *name) {
  char path[256];
  size_t length;
  snprintf(path, sizeof path, "tests/data/cases/packings/%s", from);
  char *text = get_file(path, &length);
  put_bytes(p, name, text, length);
  free(text);
}

/* A pattern is an ensemble: its files in ascending order. Names of runs depend on contents alone. */
static void ensembles_and_names(void **state) {
  place *p = *state;
  copy_packing(p, "p50.data", "e-2.data");
  copy_packing(p, "p20.data", "e-1.data");
  copy_packing(p, "p20.data", "other.data");
  gh_study *s = study_of(
      p, SMALL "vary: {packing: ['e-*.data', other.data], micro.tolerance: [1e-2]}\n" REFERENCE, false);
  assert_int_equal(s->nconfigs, 4);
  assert_true(s->configs[0].nruns == 2 && s->configs[1].nruns == 1 && s->configs[2].nruns == 2);
  assert_non_null(strstr(s->configs[0].runs[0].packing, "/e-1.data"));
  assert_non_null(strstr(s->configs[0].runs[1].packing, "/e-2.data"));
  const char *first = s->configs[0].runs[0].id;
  assert_string_equal(first, s->configs[1].runs[0].id); /* the same grains under another name */
  assert_string_not_equal(first, s->configs[0].runs[1].id);
  assert_string_not_equal(first, s->configs[2].runs[0].id);
  char id[20];
  strcpy(id, first);
  gh_study_destroy(&s);
  /* more values, other goals and comments are the same run; another content is not */
  s = study_of(
      p, "title: x # y\n" SMALL "vary: {packing: [e-1.data], micro.tolerance: [1e-3, 1e-2]}\n" REFERENCE,
      false);
  assert_string_equal(s->configs[1].runs[0].id, id);
  assert_string_not_equal(s->configs[0].runs[0].id, id);
  gh_study_destroy(&s);
  copy_packing(p, "p50.data", "e-1.data");
  s = study_of(p, SMALL "vary: {packing: [e-1.data], micro.tolerance: [1e-2]}\n" REFERENCE, false);
  assert_string_not_equal(s->configs[0].runs[0].id, id);
  gh_study_destroy(&s);
}

/* Copies are no ensemble, an empty file no reference, and another path none either; the name of a folder is
 * no pattern. */
static void what_is_compared_must_fit(void **state) {
  static const struct {
    const char *text, *message;
  } wrong[] = {
      {SMALL REFERENCE "vary: {packing: ['copy-*.data']}\n", "copy-2.data hold the same: members must"},
      {SMALL VARY "reference: {file: empty.csv}\n", "empty.csv: there are no rows"},
      {SMALL "vary: {path.legs.0.increments: [2, 4]}\nreference: {file: one.csv}\n",
       "study.yaml:7: reference: path.legs.0.increments 4: at t = 1, F is not that of what it is"}};
  place *p = *state;
  copy_packing(p, "p20.data", "copy-1.data");
  copy_packing(p, "p20.data", "copy-2.data");
  put_file(p, "empty.csv", "t,P11,P12,P21,P22,energy\n");
  put_file(p, "one.csv", "t,P11,P12,P21,P22,energy\n0,1,1,1,1,1\n");
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    gh_study *s;
    assert_int_equal(gh_study_read(p->ctx, put(p, "study.yaml", wrong[k].text), false, &s), GH_INPUT);
    if (!strstr(gh_message(p->ctx), wrong[k].message)) fail_msg("case %zu: %s", k, gh_message(p->ctx));
  }
  /* each has its own path, as long as its reference has the same one */
  gh_study *s =
      study_of(p, SMALL "vary: {path.legs.0.increments: [2, 4], refine: [1, 2]}\n" REFERENCE, false);
  assert_int_equal(s->nconfigs, 8);
  gh_study_destroy(&s);
  assert_int_equal(mkdir(in_folder(p, "[x]*"), 0777), 0);
  copy_packing(p, "p20.data", "[x]*/e.data");
  const char *path = put(p, "[x]*/study.yaml", SMALL "vary: {packing: ['e*.data']}\n" REFERENCE);
  assert_int_equal(gh_study_read(p->ctx, path, false, &s), GH_OK);
  assert_int_equal(s->configs[0].nruns, 1);
  gh_study_destroy(&s);
}

/* Whole numbers of t are rows of the path as written, and F is the same to the bit there, however fine. */
static void paths_are_refined(void **state) {
  static const char legs[] =
      "legs: [{to: [0.97, 0, 0, 1], increments: 3}, {to: [0.97, 0.1, 0, 1.01], increments: 7}]";
  place *p = *state;
  gh_yaml *doc;
  study_path coarse, fine, file;
  put_file(p, "path.csv", "step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.9,0,0,1\n2,0.9,0.1,0,1\n");
  assert_int_equal(gh_yaml_parse(p->ctx, "path", legs, &doc), GH_OK);
  assert_int_equal(study_path_read(p->ctx, gh_yaml_root(doc), p->folder, 1, &coarse), GH_OK);
  assert_int_equal(study_path_read(p->ctx, gh_yaml_root(doc), p->folder, 7, &fine), GH_OK);
  assert_true(coarse.rows == 11 && fine.rows == 71 && fine.t[70] == 10 && fine.t[0] == 0);
  for (int k = 0; k < coarse.rows; k++) {
    assert_true(coarse.t[k] == k && fine.t[7 * k] == k);
    assert_memory_equal(coarse.F + 4 * k, fine.F + 28 * k, 4 * sizeof(double));
  }
  near(fine.F[4 * 4], 1 - 0.03 * 4 / 21, 1e-15); /* row 4: 4/21 of the first leg */
  gh_yaml_destroy(&doc);
  assert_int_equal(gh_yaml_parse(p->ctx, "path", "file: path.csv", &doc), GH_OK);
  assert_int_equal(study_path_read(p->ctx, gh_yaml_root(doc), p->folder, 2, &file), GH_OK);
  assert_true(file.rows == 5 && file.t[3] == 1.5 && file.t[4] == 2);
  near(file.F[4 * 3 + 1], 0.05, 1e-15);
  gh_yaml_destroy(&doc);
  study_path_free(&coarse);
  study_path_free(&fine);
  study_path_free(&file);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(wrong_studies_are_refused), TEST(wrong_scenes_are_refused),
                                     TEST(configs_are_planned),       TEST(quick_studies),
                                     TEST(ensembles_and_names),       TEST(what_is_compared_must_fit),
                                     TEST(paths_are_refined)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
