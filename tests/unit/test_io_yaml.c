/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of YAML files. */
#include "test_io.h"

#include <float.h>
#include <limits.h>

static gh_yaml *read_text(place *p, const char *text) {
  gh_yaml *doc;
  gh_status s = gh_yaml_read(p->ctx, put_file(p, "a.yaml", text), &doc);
  if (s != GH_OK) fail_msg("%s", gh_message(p->ctx));
  return doc;
}

static gh_yaml_node value_of(const gh_yaml *doc, const char *key) {
  return gh_yaml_get(gh_yaml_root(doc), key);
}

/* Maps, lists and values of a scene are found with their lines. */
static void a_scene_is_walked(void **state) {
  place *p = *state;
  gh_yaml *doc;
  const char *path = "tests/data/io/scene.yaml", *text;
  double size[2];
  assert_int_equal(gh_yaml_read(p->ctx, path, &doc), GH_OK);
  gh_yaml_node root = gh_yaml_root(doc), steps = gh_yaml_get(root, "steps"), value;
  assert_true(gh_yaml_is_map(root) && gh_yaml_is_list(steps) && gh_yaml_has(steps));
  assert_string_equal(gh_yaml_path(root), path);
  assert_int_equal(gh_yaml_length(root), 4);
  assert_string_equal(gh_yaml_key(root, 1, &value), "packing");
  assert_int_equal(gh_yaml_text(value, "packing", &text), GH_OK);
  assert_string_equal(text, "rve150.data");
  assert_int_equal(gh_yaml_line(value), 3);
  assert_int_equal(gh_yaml_length(steps), 2);
  gh_yaml_node edge = gh_yaml_get(gh_yaml_item(gh_yaml_get(gh_yaml_item(steps, 1), "displace"), 0), "edge");
  assert_int_equal(gh_yaml_text(edge, "edge", &text), GH_OK);
  assert_string_equal(text, "top");
  assert_int_equal(gh_yaml_line(edge), 10);
  gh_yaml_node mesh = gh_yaml_get(gh_yaml_get(root, "mesh"), "rectangle");
  assert_int_equal(gh_yaml_numbers(gh_yaml_get(mesh, "size"), "size", 2, size), GH_OK);
  assert_true(size[0] == 100 && size[1] == 50.5);
  gh_yaml_destroy(&doc);
  assert_null(doc);
  gh_yaml_destroy(&doc);
}

/* Plain numbers of every form, booleans of every word, texts with and without quotes. */
static void values_are_typed(void **state) {
  static const struct {
    const char *text;
    double value;
  } numbers[] = {{"1e-8", 1e-8}, {".5", .5}, {"+3", 3}, {"-2.", -2}, {"010", 10}};
  static const char *const words[] = {"true", "yes", "On", "false", "no", "OFF"};
  place *p = *state;
  const char *text;
  gh_yaml *doc;
  for (int k = 0; k < 6; k++) {
    char line[64];
    double v = -1;
    bool b = k >= 3;
    if (k < 5) {
      snprintf(line, sizeof line, "a: %s # comment\n", numbers[k].text);
      doc = read_text(p, line);
      assert_int_equal(gh_yaml_number(value_of(doc, "a"), "a", -INFINITY, INFINITY, &v), GH_OK);
      assert_true(v == numbers[k].value);
      gh_yaml_destroy(&doc);
    }
    snprintf(line, sizeof line, "a: %s\r\n", words[k]);
    doc = read_text(p, line);
    assert_int_equal(gh_yaml_bool(value_of(doc, "a"), "a", &b), GH_OK);
    assert_true(b == (k < 3));
    gh_yaml_destroy(&doc);
  }
  doc = read_text(p, "{a: '5', b: 42, c: -7, d: \"\\xFC\"}");
  long i;
  assert_int_equal(gh_yaml_text(value_of(doc, "a"), "a", &text), GH_OK);
  assert_string_equal(text, "5");
  assert_int_equal(gh_yaml_text(value_of(doc, "b"), "b", &text), GH_OK);
  assert_string_equal(text, "42");
  assert_int_equal(gh_yaml_integer(value_of(doc, "c"), "c", -7, -7, &i), GH_OK);
  assert_int_equal(i, -7);
  assert_int_equal(gh_yaml_text(value_of(doc, "d"), "d", &text), GH_OK);
  assert_string_equal(text, "\xC3\xBC");
  gh_yaml_destroy(&doc);
}

/* Absent values have no length, no kind and no items, but the line of where they were looked for. */
static void absent_values_are_harmless(void **state) {
  place *p = *state;
  gh_yaml *doc = read_text(p, "# first\na:\n  b: 1\nc: [1]\n");
  gh_yaml_node root = gh_yaml_root(doc), a = gh_yaml_get(root, "a"), none = gh_yaml_get(a, "x"), value;
  double v;
  assert_int_equal(none.node, 0);
  assert_false(gh_yaml_has(none) || gh_yaml_is_map(none) || gh_yaml_is_list(none) || gh_yaml_is_scalar(none));
  assert_int_equal(gh_yaml_length(none), 0);
  assert_int_equal(gh_yaml_line(none), 3);
  assert_false(gh_yaml_has(gh_yaml_get(none, "y")));
  assert_false(gh_yaml_has(gh_yaml_item(none, 0)));
  assert_false(gh_yaml_has(gh_yaml_item(gh_yaml_get(root, "c"), 1)));
  assert_false(gh_yaml_has(gh_yaml_item(gh_yaml_get(root, "c"), -1)));
  assert_null(gh_yaml_key(root, 2, &value));
  assert_false(gh_yaml_has(value));
  assert_null(gh_yaml_key(root, -1, NULL));
  assert_int_equal(gh_yaml_number(none, "x", 0, 1, &v), GH_INPUT);
  assert_message(p, gh_yaml_path(root), ":3: x is missing, a number is wanted");
  assert_int_equal(gh_yaml_number(gh_yaml_get(none, "y"), "y", 0, 1, &v), GH_INPUT);
  assert_message(p, gh_yaml_path(root), ":3: y is missing, a number is wanted");
  gh_yaml_destroy(&doc);
}

enum { NUMBER, INTEGER, BOOL, TEXT, NUMBERS };

static gh_status take(gh_yaml_node node, int type) {
  double d[2];
  long i;
  bool b;
  const char *t;
  switch (type) {
  case NUMBER:
    return gh_yaml_number(node, "a", DBL_MIN, 10, d);
  case INTEGER:
    return gh_yaml_integer(node, "a", -1, 10, &i);
  case BOOL:
    return gh_yaml_bool(node, "a", &b);
  case TEXT:
    return gh_yaml_text(node, "a", &t);
  default:
    return gh_yaml_numbers(node, "a", 2, d);
  }
}

/* A value of the wrong type or outside its range is named with its line. */
static void wrong_values_have_messages(void **state) {
  static const struct {
    int type;
    const char *value, *message;
  } faults[] = {
      {NUMBER, "x", "a: 'x' is not a finite number"},
      {NUMBER, "3 mm", "a: '3 mm' is not a finite number"},
      {NUMBER, ".nan", "a: '.nan' is not a finite number"},
      {NUMBER, ".inf", "a: '.inf' is not a finite number"},
      {NUMBER, "1e999", "a: '1e999' is not a finite number"},
      {NUMBER, "'5'", "a is a text in quotes ('5'), a number is wanted"},
      {NUMBER, "\"5\"", "a is a text in quotes ('5'), a number is wanted"},
      {NUMBER, "", "a is empty, a number is wanted"},
      {NUMBER, "[1]", "a is a list, a number is wanted"},
      {NUMBER, "{b: 1}", "a is a map, a number is wanted"},
      {NUMBER, "-0.5", "a is -0.5, it must be positive"},
      {NUMBER, "11", "a is 11, it must be at most 10"},
      {INTEGER, "1.5", "a: '1.5' is not an integer"},
      {INTEGER, "99999999999999999999", "a: '99999999999999999999' is not an integer"},
      {INTEGER, "-2", "a is -2, it must be at least -1"},
      {INTEGER, "11", "a is 11, it must be at most 10"},
      {INTEGER, "'1'", "a is a text in quotes ('1'), an integer is wanted"},
      {BOOL, "1", "a: '1' is neither true nor false"},
      {BOOL, "'yes'", "a is a text in quotes ('yes'), true or false is wanted"},
      {TEXT, "", "a is empty, a text is wanted"},
      {TEXT, "''", "a is empty, a text is wanted"},
      {TEXT, "[x]", "a is a list, a text is wanted"},
      {NUMBERS, "1", "a is a single value, a list of 2 numbers is wanted"},
      {NUMBERS, "[1]", "a has 1 items, 2 numbers are wanted"},
      {NUMBERS, "[1, 2, .5]", "a has 3 items, 2 numbers are wanted"},
      {NUMBERS, "[0,5, 3]",
       "a has 3 items, 2 numbers are wanted (with decimal commas? a decimal point is wanted)"},
      {NUMBERS, "[-3]", "a has 1 items, 2 numbers are wanted"},
      {NUMBERS, "[1, x]", "a, item 2: 'x' is not a finite number"},
  };
  place *p = *state;
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    char text[64], message[256];
    snprintf(text, sizeof text, "# first\nb: 0\na: %s\n", faults[k].value);
    snprintf(message, sizeof message, ":3: %s", faults[k].message);
    gh_yaml *doc = read_text(p, text);
    assert_int_equal(take(value_of(doc, "a"), faults[k].type), GH_INPUT);
    assert_message(p, gh_yaml_path(gh_yaml_root(doc)), message);
    gh_yaml_destroy(&doc);
  }
}

/* A key that is not known is named, with the nearest one that is, or all of them. */
static void unknown_keys_are_named(void **state) {
  static const char *const known[] = {"packing", "pressure", "steps", NULL};
  place *p = *state;
  gh_yaml *doc = read_text(p, "packing: a\nsteps:\n  - presure: 1\n  - colour: red\n  - 5\n");
  gh_yaml_node root = gh_yaml_root(doc), steps = gh_yaml_get(root, "steps");
  assert_int_equal(gh_yaml_keys(root, known), GH_OK);
  assert_int_equal(gh_yaml_keys(gh_yaml_item(steps, 0), known), GH_INPUT);
  assert_message(p, gh_yaml_path(root), ":3: unknown key 'presure', is 'pressure' meant?");
  assert_int_equal(gh_yaml_keys(gh_yaml_item(steps, 1), known), GH_INPUT);
  assert_message(p, gh_yaml_path(root), ":4: unknown key 'colour'; known here: packing, pressure, steps");
  assert_int_equal(gh_yaml_keys(gh_yaml_item(steps, 2), known), GH_INPUT);
  assert_message(p, gh_yaml_path(root), ":5: a map (key: value) is wanted here, this is a single value");
  assert_int_equal(gh_yaml_keys(steps, known), GH_INPUT);
  assert_message(p, gh_yaml_path(root), ":3: a map (key: value) is wanted here, this is a list");
  assert_int_equal(gh_yaml_fail(steps, "%d of %s", 3, "these"), GH_INPUT);
  assert_message(p, gh_yaml_path(root), ":3: 3 of these");
  gh_yaml_destroy(&doc);
}

/* Documents that are no single clean tree are refused when they are read. */
static void faulty_documents_are_refused(void **state) {
  static const char *const faults[][2] = {
      {"", ": the file is empty"},
      {"# only this\n\n", ": the file holds no values, only blank lines and comments"},
      {"a: 1\nb: 2\na: 3\n", ":3: key 'a' occurs twice, first in line 1"},
      {"x:\n  - {b: 1, c: 2, b: 3}\n", ":2: key 'b' occurs twice, first in line 2"},
      {"a: &k 1\nb: *k\n", ":1: this value is used again by an alias (*); write it out instead"},
      {"a: &k [*k]\n", ":1: this value is used again by an alias (*); write it out instead"},
      {"&k a: *k\n", ":1: this value is used again by an alias (*); write it out instead"},
      {"&k [{a: *k}]\n", ":1: this value is used again by an alias (*); write it out instead"},
      {"a: !!float 1\n", ":1: the tag 'tag:yaml.org,2002:float' is not understood"},
      {"a: !mine [1]\n", ":1: the tag '!mine' is not understood"},
      {"a: !mine {b: 1}\n", ":1: the tag '!mine' is not understood"},
      {"? [1]\n: 2\n", ":1: a key must be a text"},
      {"a: 1\n---\nb: 1\n", ":3: a second document begins, one per file is read"},
      {"a: \"x\\0y\"\n", ":1: a text holds a zero character"},
      {"a: [1, 2\nb: 3\n",
       ":2: not valid YAML: did not find expected ',' or ']' (while parsing a flow sequence)"},
      {"a: 1\n\tb: 2\n",
       ":2: not valid YAML: found a tab character that violates indentation (while scanning a plain scalar)"},
      {"a: 1\nb: 'x\n",
       ":3: not valid YAML: found unexpected end of stream (while scanning a quoted scalar)"},
      {"a: 1\nb: \xFF\xFE\n", ":2: not valid YAML: invalid leading UTF-8 octet"},
      {"a: 1\nb: \x01\n", ":2: not valid YAML: control characters are not allowed"},
      {"a: *k\n", ":1: not valid YAML: found undefined alias"},
  };
  place *p = *state;
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    gh_yaml *doc;
    const char *path = put_file(p, "a.yaml", faults[k][0]);
    assert_int_equal(gh_yaml_read(p->ctx, path, &doc), GH_INPUT);
    assert_null(doc);
    assert_message(p, path, faults[k][1]);
  }
}

/* Missing files, folders, binary files, and brackets a hundred thousand deep. */
static void what_is_no_yaml_is_refused(void **state) {
  enum { N = 100000 };
  place *p = *state;
  gh_yaml *doc;
  const char *path = in_folder(p, "none.yaml");
  assert_int_equal(gh_yaml_read(p->ctx, path, &doc), GH_INPUT);
  assert_message(p, path, ": cannot be opened: No such file or directory");
  assert_int_equal(gh_yaml_read(p->ctx, p->folder, &doc), GH_INPUT);
  assert_message(p, p->folder, ": is a folder, a file is wanted");
  path = put_bytes(p, "b.yaml", "a\0b", 3);
  assert_int_equal(gh_yaml_read(p->ctx, path, &doc), GH_INPUT);
  assert_message(p, path, ":1: not a text file: it holds a zero byte");
  char *deep = malloc(N);
  memset(deep, '[', N);
  path = put_bytes(p, "c.yaml", deep, N);
  assert_int_equal(gh_yaml_read(p->ctx, path, &doc), GH_INPUT);
  assert_null(doc);
  assert_message(p, path, ":1: more than 200 brackets are open");
  free(deep);
}

/* A scene cut after any byte, or damaged at random, is read or refused. */
static void damage_is_safe(void **state) {
  place *p = *state;
  size_t length;
  char *text = get_file("tests/data/io/scene.yaml", &length);
  srand(3);
  print_message("seed 3\n");
  for (size_t n = 1; n < length + 1000; n++) {
    gh_yaml *doc;
    char *damaged = malloc(length);
    size_t cut = n < length ? n : length;
    memcpy(damaged, text, length);
    for (int c = 0; c < 3 && cut == length; c++) damaged[(size_t)rand() % length] = (char)(1 + rand() % 127);
    gh_status s = gh_yaml_read(p->ctx, put_bytes(p, "a.yaml", damaged, cut), &doc);
    assert_true(s == GH_OK || s == GH_INPUT);
    assert_true((s == GH_OK) == (doc != NULL));
    gh_yaml_destroy(&doc);
    free(damaged);
  }
  free(text);
}

/* The whole document in one line; caller frees. */
static char *printed(place *p, const gh_yaml *doc) {
  gh_text *out;
  assert_int_equal(gh_text_create(p->ctx, &out), GH_OK);
  gh_yaml_print(gh_yaml_root(doc), out);
  char *text = strdup(gh_text_get(out, NULL));
  gh_text_destroy(&out);
  return text;
}

static void assert_printed(place *p, const gh_yaml *doc, const char *wanted) {
  char *text = printed(p, doc);
  assert_string_equal(text, wanted);
  free(text);
}

static const char study[] =
    "title: Block, \"small\" # comment\n"
    "micro: {tolerance: 1e-8}\n"
    "start:\n"
    "steps:\n  - name: press\n    increments: 3\n  - {name: 'shear', increments: 10}\n";

/* Values are replaced and made, in maps, lists and places where nothing is written, and keep the line of what
 * they replace. */
static void values_are_set(void **state) {
  place *p = *state;
  gh_yaml *doc = read_text(p, study);
  long i;
  double v[2];
  assert_int_equal(gh_yaml_set(doc, "micro.tolerance", "1e-6"), GH_OK);
  assert_int_equal(gh_yaml_set(doc, "steps.1.increments", "20"), GH_OK);
  assert_int_equal(gh_yaml_set(doc, "mesh.rectangle.elements", "[2, 4]"), GH_OK);
  assert_int_equal(gh_yaml_set(doc, "start.confinement", "0.5"), GH_OK);
  assert_int_equal(gh_yaml_set(doc, "title", "'a: \"b\"'"), GH_OK);
  gh_yaml_node root = gh_yaml_root(doc), shear = gh_yaml_item(gh_yaml_get(root, "steps"), 1);
  gh_yaml_node increments = gh_yaml_get(shear, "increments"), mesh = gh_yaml_get(root, "mesh");
  assert_int_equal(gh_yaml_integer(increments, "increments", 1, 100, &i), GH_OK);
  assert_int_equal(i, 20);
  assert_int_equal(gh_yaml_line(increments), 7);
  assert_int_equal(gh_yaml_line(gh_yaml_get(gh_yaml_get(root, "micro"), "tolerance")), 2);
  assert_int_equal(gh_yaml_line(gh_yaml_get(gh_yaml_get(root, "start"), "confinement")), 3);
  assert_int_equal(gh_yaml_numbers(gh_yaml_get(gh_yaml_get(mesh, "rectangle"), "elements"), "e", 2, v),
                   GH_OK);
  assert_true(v[0] == 2 && v[1] == 4);
  assert_printed(
      p, doc,
      "{title: \"a: \\\"b\\\"\", micro: {tolerance: 1e-6}, start: {confinement: 0.5}, steps: [{name: "
      "press, increments: 3}, {name: \"shear\", increments: 20}], mesh: {rectangle: {elements: [2, "
      "4]}}}");
  assert_int_equal(gh_yaml_set(doc, "micro", "{}"), GH_OK); /* a map goes as a whole */
  assert_int_equal(gh_yaml_set(doc, "steps", "[]"), GH_OK);
  assert_int_equal(gh_yaml_set(doc, "start", "{balance: true, list: [[1, 2], {a: b}]}"), GH_OK);
  char *text = printed(p, doc);
  gh_yaml_destroy(&doc);
  assert_non_null(strstr(text, "micro: {}, start: {balance: true, list: [[1, 2], {a: b}]}, steps: [], mesh"));
  assert_int_equal(gh_yaml_parse(p->ctx, "again", text, &doc),
                   GH_OK); /* what was printed is the same document */
  assert_printed(p, doc, text);
  free(text);
  gh_yaml_destroy(&doc);
}

/* Ways that lead nowhere and values that are none are refused, and change nothing. */
static void wrong_settings_are_refused(void **state) {
  static const struct {
    const char *key, *value, *message;
  } wrong[] = {
      {"steps.2.increments", "1", ":5: 'steps.2.increments': there is no entry 2, the list has 2 (from 0)"},
      {"steps.x", "1", ":5: 'steps.x': this is a list, 'x' is no number of an entry (0, 1, ...)"},
      {"steps.-1", "1", ":5: 'steps.-1': this is a list, '-1' is no number of an entry (0, 1, ...)"},
      {"micro.tolerance.x", "1", ":2: 'micro.tolerance.x': this is a single value, it has no 'x'"},
      {"micro..x", "1", ": 'micro..x' is no key: a part of it is empty"},
      {"new.a..b", "1", ": 'new.a..b' is no key: a part of it is empty"},
      {"new.a.", "1", ": 'new.a.' is no key: a part of it is empty"},
      {"", "1", ": '' is no key: a part of it is empty"},
      {"micro.tolerance", "", ": 'micro.tolerance': the value is empty"},
      {"micro.tolerance", "[1, 2",
       ": 'micro.tolerance': '[1, 2' is no YAML value: value:2: not valid YAML: did not find expected ',' or "
       "']' "
       "(while parsing a flow sequence)"},
      {"micro", "{a: 1, a: 2}",
       ": 'micro': '{a: 1, a: 2}' is no YAML value: value:1: key 'a' occurs twice, first in line 1"}};
  place *p = *state;
  gh_yaml *doc = read_text(p, study);
  char *before = printed(p, doc);
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    assert_int_equal(gh_yaml_set(doc, wrong[k].key, wrong[k].value), GH_INPUT);
    assert_message(p, gh_yaml_path(gh_yaml_root(doc)), wrong[k].message);
    assert_printed(p, doc, before);
  }
  free(before);
  gh_yaml_destroy(&doc);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(a_scene_is_walked),          TEST(values_are_typed),       TEST(absent_values_are_harmless),
      TEST(wrong_values_have_messages), TEST(unknown_keys_are_named), TEST(faulty_documents_are_refused),
      TEST(what_is_no_yaml_is_refused), TEST(damage_is_safe),         TEST(values_are_set),
      TEST(wrong_settings_are_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
