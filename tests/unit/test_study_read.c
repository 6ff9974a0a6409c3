/* Studies: what is read and refused, settings, references and members, records, runs, the closed form.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include "study/parts.h"
#include "test_io.h"

#include <inttypes.h>
#include <math.h>
#include <unistd.h>

#define SMALL                                                                                                \
  "rve:\n  packing: @/p50.data\n  contact: {normal_stiffness: 50}\n"                                         \
  "  micro: {boundary: periodic, engine: native}\n"                                                          \
  "  path: {legs: [{to: [0.99, 0, 0, 1], increments: 2}]}\n"
#define REFERENCE "reference: {set: {micro.tolerance: 1e-11}}\n"
#define VARY "vary: {micro.tolerance: [1e-2, 1e-6]}\n"
#define SCENE                                                                                                \
  "packing: @/p20.data\ncontact: {normal_stiffness: 50}\nmicro: {boundary: taylor, engine: native}\n"        \
  "start: {confinement: 0.3}\nmesh: {rectangle: {size: [2, 2], elements: [1, 1]}}\n"                         \
  "supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]\n"
#define SHEAR "steps: [{increments: 2, displace: [{edge: top, x: 0.01}]}]\n"

/* cmocka's own compares as float. */
static void near(double a, double b, double limit) {
  if (!(fabs(a - b) <= limit)) fail_msg("%.17g and %.17g differ by more than %g", a, b, limit);
}

/* A file of the test's folder; @ stands for the folder of the reference packings. */
static const char *put(place *p, const char *name, const char *text) {
  char full[8192] = "", here[4096];
  assert_non_null(getcwd(here, sizeof here));
  for (const char *c = text; *c; c++) {
    size_t used = strlen(full);
    if (*c == '@') snprintf(full + used, sizeof full - used, "%s/tests/data/cases/packings", here);
    else snprintf(full + used, sizeof full - used, "%c", *c);
  }
  return put_file(p, name, full);
}

static gh_study *study_of(place *p, const char *text, bool quick) {
  gh_study *s;
  gh_status status = gh_study_read(p->ctx, put(p, "study.yaml", text), quick, &s);
  if (status != GH_OK) fail_msg("%s", gh_message(p->ctx));
  return s;
}

/* ---- reading ---- */

static void wrong_studies_are_refused(void **state) {
  static const struct {
    const char *text, *message;
  } wrong[] = {
      {SMALL VARY, "study.yaml:1: a study needs the key 'reference'"},
      {SMALL REFERENCE, "study.yaml:1: a study needs the key 'vary'"},
      {VARY REFERENCE, "study.yaml:1: a study needs one of the keys 'scene' and 'rve'"},
      {"scene: a.yaml\n" SMALL VARY REFERENCE,
       "study.yaml:1: a study needs one of the keys 'scene' and 'rve'"},
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
      {SMALL VARY REFERENCE "order: refine\n",
       "study.yaml:8: order: 'refine' is none of the keys under vary"},
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
       "study.yaml:1: on the way there det F is 0 at t = 1; it must be positive"},
      {"rve: {packing: @/p20.data, contact: {normal_stiffness: 1}, path: {file: none.csv}}\n" VARY REFERENCE,
       "none.csv: cannot be opened"}};
  place *p = *state;
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    gh_study *s;
    gh_status status = gh_study_read(p->ctx, put(p, "study.yaml", wrong[k].text), false, &s);
    if (status != GH_INPUT || !strstr(gh_message(p->ctx), wrong[k].message))
      fail_msg("case %zu: status %d, message \"%s\" (wanted \"%s\")", k, status, gh_message(p->ctx),
               wrong[k].message);
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

/* ---- settings ---- */

/* All combinations, the last knob fastest; references are shared, and may be rows. */
static void settings_are_planned(void **state) {
  place *p = *state;
  gh_study *s = study_of(
      p, SMALL "vary: {micro.tolerance: [1e-2, 1e-4, 1e-6], micro.boundary: [taylor, periodic]}\n" REFERENCE,
      false);
  assert_int_equal(s->nsettings, 8); /* one reference for each boundary condition */
  assert_string_equal(s->settings[1].value[0], "1e-2");
  assert_string_equal(s->settings[1].value[1], "periodic");
  assert_string_equal(s->settings[2].value[0], "1e-4");
  for (int k = 0; k < 6; k++) {
    const study_setting *r = s->settings + s->settings[k].reference;
    assert_true(r->extra && !s->settings[k].extra && r->choice[0] == -1 && r->choice[1] == k % 2);
    assert_string_equal(r->value[0], "1e-11");
    assert_string_equal(r->value[1], s->settings[k].value[1]);
  }
  assert_true(s->order == -1 && s->series == 0 && s->ngoals == 3 && s->goals[0] == 1e-2);
  assert_true(s->nquantities == 2 && s->main == 0 && s->ncolumns == 9);
  gh_study_destroy(&s);
  /* a value that is among those of the knob, however it is written: rows are references */
  s = study_of(p,
               SMALL "vary: {micro.tolerance: [1e-2, 1e-6]}\nbase: {micro.boundary: taylor}\n"
                     "reference: {set: {micro.tolerance: 0.000001, micro.boundary: taylor}}\n"
                     "quantities: [energy, stress]\ngoals: [1e-3, 1e-1]\nplots: [energy, s12]\n",
               false);
  assert_int_equal(s->nsettings, 2);
  assert_true(s->settings[0].reference == 1 && s->settings[1].reference == 1);
  assert_string_equal(s->quantities[0].name, "energy");
  assert_true(s->goals[0] == 1e-1 && s->ngoals == 2 && s->nplots == 2 && s->plots[0] == 8 &&
              s->plots[1] == 5);
  gh_study_destroy(&s);
  /* a key that is no knob makes a reference for each row */
  s = study_of(p, SMALL VARY "reference: {set: {micro.max_steps: 9999}}\n", false);
  assert_int_equal(s->nsettings, 4);
  assert_string_equal(s->settings[2].also, "micro.max_steps: 9999");
  assert_true(s->settings[1].reference == 3 && s->settings[3].reference == 3);
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
  assert_true(s->nsettings == 8 && s->order == 0);
  assert_string_equal(study_value(s, s->settings, "micro.boundary"), "taylor");
  gh_study_destroy(&s);
  s = study_of(p, text, true);
  assert_true(s->nsettings == 2 && s->order == -1 && s->nknobs == 1);
  assert_string_equal(study_value(s, s->settings, "micro.boundary"), "periodic");
  assert_string_equal(study_value(s, s->settings, "micro.max_steps"), "999");
  assert_string_equal(study_value(s, s->settings + 1, "refine"), "3");
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
  assert_int_equal(s->nsettings, 4);
  assert_true(s->settings[0].nruns == 2 && s->settings[1].nruns == 1 && s->settings[2].nruns == 2);
  assert_non_null(strstr(s->settings[0].runs[0].packing, "/e-1.data"));
  assert_non_null(strstr(s->settings[0].runs[1].packing, "/e-2.data"));
  const char *first = s->settings[0].runs[0].id;
  assert_string_equal(first, s->settings[1].runs[0].id); /* the same grains under another name */
  assert_string_not_equal(first, s->settings[0].runs[1].id);
  assert_string_not_equal(first, s->settings[2].runs[0].id);
  char id[20];
  strcpy(id, first);
  gh_study_destroy(&s);
  /* more values, other goals and comments are the same run; another content is not */
  s = study_of(
      p, "title: x # y\n" SMALL "vary: {packing: [e-1.data], micro.tolerance: [1e-3, 1e-2]}\n" REFERENCE,
      false);
  assert_string_equal(s->settings[1].runs[0].id, id);
  assert_string_not_equal(s->settings[0].runs[0].id, id);
  gh_study_destroy(&s);
  copy_packing(p, "p50.data", "e-1.data");
  s = study_of(p, SMALL "vary: {packing: [e-1.data], micro.tolerance: [1e-2]}\n" REFERENCE, false);
  assert_string_not_equal(s->settings[0].runs[0].id, id);
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
  assert_int_equal(s->nsettings, 8);
  gh_study_destroy(&s);
  assert_int_equal(mkdir(in_folder(p, "[x]*"), 0777), 0);
  copy_packing(p, "p20.data", "[x]*/e.data");
  const char *path = put(p, "[x]*/study.yaml", SMALL "vary: {packing: ['e*.data']}\n" REFERENCE);
  assert_int_equal(gh_study_read(p->ctx, path, false, &s), GH_OK);
  assert_int_equal(s->settings[0].nruns, 1);
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

/* ---- runs and records ---- */

static int told; /* lines of finished runs, counted by the log */
static void count_lines(void *data, gh_level level, const char *line) {
  (void)data, (void)level;
  told += strstr(line, ": done, ") || strstr(line, ": failed after ");
}

static bool after_some(void *data) {
  return --*(int *)data < 0;
}

static void run_study(place *p, gh_study *s, gh_status wanted, bool (*stop)(void *data), void *data,
                      bool fresh) {
  char folder[128];
  gh_study_options options = {.stop = stop, .stop_data = data, .fresh = fresh};
  snprintf(folder, sizeof folder, "%s/out", p->folder);
  gh_set_log(p->ctx, count_lines, NULL);
  told = 0;
  gh_status status = gh_study_run(s, folder, &options);
  if (status != wanted) fail_msg("status %d: %s", status, gh_message(p->ctx));
}

/* What has a record is not repeated; what was stopped is; a record with a changed byte is none. */
static void runs_are_kept(void **state) {
  place *p = *state;
  gh_study *s = study_of(p, SMALL "vary: {micro.tolerance: [1e-2, 1e-4, 1e-6]}\n" REFERENCE, false);
  int calls = 8;
  run_study(p, s, GH_STOPPED, after_some, &calls, false);
  int first = told;
  assert_in_range(first, 1, 3);
  assert_non_null(strstr(gh_message(p->ctx), "of 4 runs are finished and stay"));
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 4 - first);
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 0);
  study_run *run = s->settings[1].runs;
  const double P11 = run->curve.value[2 * 9];
  assert_true(run->finished && run->status == GH_OK && run->curve.n == 3 && run->curve.t[2] == 2 && P11 < 0);
  assert_true(run->force_evaluations > 0 && run->wall > 0 && run->core > 0 && run->residual <= 1e-4);
  assert_true(fabs(run->energy_defect) < 0.05); /* of the trapezoidal rule over two increments */
  char path[128];
  size_t length;
  snprintf(path, sizeof path, "%s/out/runs/%s.json", p->folder, run->id);
  char *text = get_file(path, &length);
  srand(5);
  print_message("seed 5\n");
  for (int k = 0; k < 300; k++) {
    size_t at = (size_t)rand() % length;
    char old = text[at];
    text[at] = (char)(old ^ (1 << rand() % 7));
    assert_int_equal(study_record_parse(s, text, run), text[at] == old ? GH_OK : GH_INPUT);
    text[at] = 0; /* cut there */
    assert_int_equal(study_record_parse(s, text, run), GH_INPUT);
    text[at] = old;
  }
  study_curve_free(&run->curve);
  assert_int_equal(study_record_parse(s, text, run), GH_OK);
  assert_true(run->curve.value[2 * 9] == P11); /* to the last bit */
  strcpy(run->id, "0");
  assert_int_equal(study_record_parse(s, text, run), GH_INPUT); /* of another run */
  free(text);
  gh_study_destroy(&s);
  s = study_of(p, SMALL "vary: {micro.tolerance: [1e-2, 1e-4, 1e-6]}\n" REFERENCE, false);
  put_file(p, "out/runs/x", "");
  FILE *file = fopen(path, "r+");
  assert_non_null(file);
  fputc('#', file);
  fclose(file);
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 1);
  run_study(p, s, GH_OK, NULL, NULL, true);
  assert_int_equal(told, 4);
  /* a fresh study that is stopped keeps no old records, so that it can go on */
  calls = 8;
  run_study(p, s, GH_STOPPED, after_some, &calls, true);
  first = told;
  assert_in_range(first, 1, 3);
  assert_non_null(strstr(gh_message(p->ctx), "the same command without --fresh goes on"));
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 4 - first);
  gh_study_destroy(&s);
}

/* A record of another build is used, and the tables say so; pictures of an earlier study are gone. */
static void other_builds_are_told(void **state) {
  place *p = *state;
  char path[48], *at;
  size_t length;
  gh_text *text;
  gh_study *s = study_of(p, SMALL VARY REFERENCE, false);
  run_study(p, s, GH_OK, NULL, NULL, false);
  put_file(p, "out/order.png", "old");
  for (int k = 0; k < 2; k++) { /* the second time as all builds before this one had it */
    assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
    assert_false(s->settings[k].runs[0].other_build);
    snprintf(path, sizeof path, "out/runs/%s.json", s->settings[k].runs[0].id);
    assert_int_equal(study_record_print(s, k, s->settings[k].runs, text), GH_OK);
    char *record = strdup(gh_text_get(text, NULL));
    assert_non_null(record);
    assert_non_null(at = strstr(record, "  \"build\": \""));
    if (k == 0) at[12] = 'x';
    else memmove(at, strchr(at, '\n') + 1, strlen(strchr(at, '\n')));
    assert_non_null(at = strstr(record, "  \"check\": \""));
    length = (size_t)(at - record);
    snprintf(at, 40, "  \"check\": \"%016" PRIx64 "\"\n}\n", study_hash(study_hash_begin, record, length));
    put_file(p, path, record);
    free(record);
    gh_text_destroy(&text);
  }
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 0);
  assert_true(s->settings[0].runs[0].other_build && s->settings[1].runs[0].other_build);
  char *page = get_file(in_folder(p, "out/study.md"), &length);
  assert_non_null(strstr(page, "2 of 3 runs were computed by another build of granhom"));
  free(page);
  assert_int_not_equal(access(in_folder(p, "out/order.png"), F_OK), 0);
  run_study(p, s, GH_OK, NULL, NULL, true);
  assert_false(s->settings[0].runs[0].other_build);
  gh_study_destroy(&s);
}

/* A run that fails is a result, and kept like others; when all fail the study has. */
static void failures_are_results(void **state) {
  place *p = *state;
  gh_study *s = study_of(
      p, SMALL "vary: {micro.max_steps: [1, 100000]}\nreference: {set: {micro.tolerance: 1e-11}}\n", false);
  run_study(p, s, GH_OK, NULL, NULL, false);
  const study_run *run = s->settings[0].runs;
  assert_true(run->finished && run->status == GH_DIVERGED && run->curve.n == 1);
  assert_non_null(strstr(run->message, "t = 1: no equilibrium within 1 relaxation steps"));
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 0);
  gh_study_destroy(&s);
  s = study_of(p, SMALL "vary: {micro.max_steps: [1, 2]}\nreference: {set: {micro.tolerance: 1e-11}}\n",
               false);
  run_study(p, s, GH_DIVERGED, NULL, NULL, false);
  assert_non_null(
      strstr(gh_message(p->ctx), "no setting has a result; the first one, micro.max_steps 1: t = 1: "));
  gh_study_destroy(&s);
}

/* Two settings that come to the same are one run with two rows. */
static void twins_run_once(void **state) {
  place *p = *state;
  gh_study *s =
      study_of(p, SMALL "vary: {packing: ['@/p20.data', '@/../packings/p20.data']}\n" REFERENCE, false);
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 2); /* and one for both references */
  assert_true(s->settings[1].runs->finished && s->settings[1].runs->curve.n == 3);
  assert_memory_equal(s->settings[0].runs->curve.value, s->settings[1].runs->curve.value,
                      27 * sizeof(double));
  gh_study_destroy(&s);
}

/* A scene that nothing drives is judged by its settlement: mean of the nodes under the last load. The mean of
 * P11 and P22 is that of the dead pressure, by virtual work in u = (X, 0) and (0, Y). */
static void scenes_without_driven_edges(void **state) {
  place *p = *state;
  put(p, "scene.yaml",
      SCENE "results: {rves: [99]}\nsteps: [{increments: 2, pressure: [{edge: right, to: 0.4}, {edge: top, "
            "to: 0.4}]}]\n");
  gh_study *s = study_of(p,
                         "scene: scene.yaml\nvary: {solver.tolerance: [1e-3, 1e-10]}\nbase: {refine: 2}\n"
                         "reference: {set: {solver.tolerance: 1e-11}}\n",
                         false);
  assert_string_equal(s->column[5], "displacement_y");
  assert_string_equal(s->quantities[1].name, "displacement");
  run_study(p, s, GH_OK, NULL, NULL, false);
  const study_curve *c = &s->settings[1].runs->curve;
  assert_true(c->n == 5 && c->t[0] == 0 && c->t[1] == 0.25 && c->t[4] == 1); /* refine 2 of two increments */
  const double *last = c->value + 4 * 7;
  near(last[0], -0.4, 1e-8), near(last[3], -0.4, 1e-8);
  assert_true(last[4] < 0 && last[6] < 0); /* the first load's edge, right, has moved to the left */
  gh_study_destroy(&s);
}

/* ---- references that are no runs ---- */

static const char lattice_packing[] =
    "lattice\n\n4 atoms\n1 atom types\n\n0 2 xlo xhi\n0 1.7320508075688772 ylo yhi\n"
    "-0.5 0.5 zlo zhi\n\nAtoms # sphere\n\n"
    "1 1 1.04 1 0 0 0\n2 1 1.04 1 1 0 0\n"
    "3 1 1.04 1 0.5 0.8660254037844386 0\n4 1 1.04 1 1.5 0.8660254037844386 0\n";

#define LATTICE                                                                                              \
  "rve:\n  packing: lattice.data\n  contact: {normal_stiffness: 50}\n  micro: {engine: native}\n"            \
  "  path: {legs: [{to: [0.97, 0, 0, 0.97], increments: 2}, {to: [0.95, 0.03, 0.01, 1.08], increments: "     \
  "3}]}\n"

/* P of the program equals that of the closed form, through compression, shear and the opening of bonds. */
static void triangular_lattice(void **state) {
  place *p = *state;
  put_file(p, "lattice.data", lattice_packing);
  gh_study *s = study_of(p,
                         LATTICE "vary: {micro.boundary: [taylor-cell, periodic], refine: [1, 3]}\n"
                                 "reference: {closed_form: triangular-lattice}\n",
                         false);
  assert_int_equal(s->nsettings, 4);
  assert_int_equal(s->given.n, 16);
  for (int k = 1; k < 16; k++) assert_true(s->given.t[k] > s->given.t[k - 1]);
  run_study(p, s, GH_OK, NULL, NULL, false);
  for (int k = 0; k < 4; k++) {
    const study_judged *row = s->verdict->row + k;
    assert_int_equal(row->points, k % 2 ? 16 : 6);
    for (int q = 0; q < 2; q++)
      if (!(row->l2[q] < 1e-12)) fail_msg("setting %d, quantity %d: error %g", k, q, row->l2[q]);
  }
  gh_study_destroy(&s);
}

/* Isotropic: three bonds with sum n (x) n = 3/2 give P = -sqrt(3) E (2 r - c a)/a, and the energy is 1.5 E
 * overlap^2 for the area of a grain. Others than this lattice are refused. */
static void lattice_alone(void **state) {
  static const struct {
    const char *from, *to, *message;
  } wrong[] = {{"2 1 1.04", "2 1 1.05", "grains 1 and 2 have the radii 0.52 and 0.525"},
               {"0.5 0.866", "0.51 0.866", "grain 3 is off by"},
               {"0 2 xlo", "0 2.1 xlo", "no triangular lattice"},
               {"4 1 1.04 1 1.5 0.8660254037844386 0\n", "", "no triangular lattice: 3 grains at 4 places"}};
  place *p = *state;
  gh_contact_law law = {.normal_stiffness = 50};
  const double F[4] = {0.95, 0, 0, 0.95}, narrow[4] = {0.5, 0, 0, 1}, overlap = 1.04 - 0.95;
  double answer[9];
  study_lattice l;
  gh_packing *packing;
  assert_int_equal(gh_packing_read(p->ctx, put_file(p, "lattice.data", lattice_packing), &packing), GH_OK);
  assert_int_equal(study_lattice_find(p->ctx, packing, &law, &l), GH_OK);
  assert_true(fabs(l.radius - 0.52) < 1e-15 && fabs(l.spacing - 1) < 1e-15);
  assert_int_equal(study_lattice_answer(p->ctx, &l, F, answer), GH_OK);
  for (int k = 0; k < 4; k++) near(answer[k], k % 3 ? 0 : -sqrt(3) * 50 * overlap, 1e-13);
  near(answer[4], -sqrt(3) * 50 * overlap / 0.95, 1e-13);
  near(answer[8], 1.5 * 50 * overlap * overlap / (sqrt(3) / 2), 1e-13);
  assert_int_equal(study_lattice_answer(p->ctx, &l, narrow, answer), GH_INPUT);
  assert_non_null(strstr(gh_message(p->ctx), "grains touch that are not next to each other"));
  law.friction = true;
  assert_int_equal(study_lattice_find(p->ctx, packing, &law, &l), GH_INPUT);
  law.friction = false;
  gh_packing_destroy(&packing);
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char text[1024];
    const char *at = strstr(lattice_packing, wrong[k].from);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - lattice_packing), lattice_packing, wrong[k].to,
             at + strlen(wrong[k].from));
    if (!*wrong[k].to) *strchr(text, '4') = '3';
    assert_int_equal(gh_packing_read(p->ctx, put_file(p, "wrong.data", text), &packing), GH_OK);
    gh_status status = study_lattice_find(p->ctx, packing, &law, &l);
    if (status != GH_INPUT || !strstr(gh_message(p->ctx), wrong[k].message))
      fail_msg("case %zu: %s", k, status == GH_OK ? "accepted" : gh_message(p->ctx));
    gh_packing_destroy(&packing);
  }
  gh_study *s;
  const char *path =
      put(p, "study.yaml",
          LATTICE "vary: {contact.normal_stiffness: [1, 2]}\nreference: {closed_form: triangular-lattice}\n");
  assert_int_equal(gh_study_read(p->ctx, path, false, &s), GH_INPUT);
  assert_non_null(
      strstr(gh_message(p->ctx), "study.yaml:7: reference: a closed form needs the same contact law"));
}

/* A file with t and the columns of what is compared. */
static void reference_from_a_file(void **state) {
  static const char study[] = SMALL VARY "reference: {file: other.csv}\nquantities: [stress]\n";
  place *p = *state;
  gh_study *s;
  put_file(p, "other.csv", "t,P11,P12,P21,P22\n0,-1,0,0,-1\n1,-2,0,0,-1\n2,-3,0,0,-1\n");
  s = study_of(p, study, false);
  assert_true(s->reference == STUDY_FILE && s->given.n == 3 && s->given.value[2 * 9] == -3);
  assert_true(isnan(s->given.value[8]) && s->settings[0].reference == -1 && s->nsettings == 2);
  gh_study_destroy(&s);
  const char *path = put(p, "study.yaml", SMALL VARY "reference: {file: other.csv}\n");
  assert_int_equal(gh_study_read(p->ctx, path, false, &s), GH_INPUT);
  assert_non_null(strstr(gh_message(p->ctx), "other.csv:1: no column energy, which a quantity needs"));
  put_file(p, "other.csv", "t,P11,P12,P21,P22\n0,-1,0,0,-1\n0,-2,0,0,-1\n");
  assert_int_equal(gh_study_read(p->ctx, put(p, "study.yaml", study), false, &s), GH_INPUT);
  assert_non_null(strstr(gh_message(p->ctx), "other.csv:3: t is 0, it must grow from row to row"));
}

/* Another program's Cauchy stress becomes P; it tells no energy, and does what it can alone. Without friction
 * both find the same equilibrium. */
static void other_programs(void **state) {
  place *p = *state;
  gh_study *s = study_of(p,
                         "rve:\n  packing: @/p50d.data\n  contact: {normal_stiffness: 50}\n"
                         "  micro: {engine: native}\n"
                         "  path: {legs: [{to: [0.995, 0.004, 0.001, 0.998], increments: 2}]}\n"
                         "vary: {micro.engine: [native, gran], micro.boundary: [periodic, taylor]}\n"
                         "reference: {set: {micro.engine: native, micro.tolerance: 1e-11}}\n",
                         false);
  run_study(p, s, GH_OK, NULL, NULL, false);
  const study_run *gran = s->settings[2].runs, *taylor = s->settings[3].runs;
  if (gran->status != GH_OK) fail_msg("%s", gran->message);
  if (!(s->verdict->row[2].l2[0] < 1e-6)) fail_msg("error of the stress %g", s->verdict->row[2].l2[0]);
  assert_true(gran->curve.n == 3 && gran->force_evaluations > 0 && isnan(gran->curve.value[8]));
  assert_true(isnan(s->verdict->row[2].l2[1]) && isnan(s->verdict->row[2].largest[1]));
  assert_true(taylor->finished && taylor->status == GH_INPUT);
  assert_non_null(strstr(taylor->message, "gran relaxes all grains of a periodic cell"));
  gh_study_destroy(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(wrong_studies_are_refused),
                                     TEST(wrong_scenes_are_refused),
                                     TEST(settings_are_planned),
                                     TEST(quick_studies),
                                     TEST(ensembles_and_names),
                                     TEST(what_is_compared_must_fit),
                                     TEST(paths_are_refined),
                                     TEST(runs_are_kept),
                                     TEST(other_builds_are_told),
                                     TEST(failures_are_results),
                                     TEST(twins_run_once),
                                     TEST(triangular_lattice),
                                     TEST(scenes_without_driven_edges),
                                     TEST(lattice_alone),
                                     TEST(reference_from_a_file),
                                     TEST(other_programs)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
