/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What fuzzing has found, each as a test. */
#include "test_io.h"

#include "granhom/macro.h"
#include "granhom/packing.h"

static gh_yaml *parsed(place *p, const char *text) {
  gh_yaml *doc;
  if (gh_yaml_parse(p->ctx, "a.yaml", text, &doc) != GH_OK) fail_msg("%s", gh_message(p->ctx));
  return doc;
}

static void assert_printed(place *p, const gh_yaml *doc, const char *wanted) {
  gh_text *out;
  assert_int_equal(gh_text_create(p->ctx, &out), GH_OK);
  gh_yaml_print(gh_yaml_root(doc), out);
  assert_string_equal(gh_text_get(out, NULL), wanted);
  gh_text_destroy(&out);
}

/* Messages are one line, whatever they quote. */
static void a_message_has_no_control_characters(void **state) {
  place *p = *state;
  gh_fail(p->ctx, GH_INPUT,
          "a.msh:%d: $No\x01"
          "d\x7F has no\n$End\r\t\x1B[31m",
          4);
  assert_string_equal(gh_message(p->ctx), "a.msh:4: $No?d? has no $End  ?[31m");
  gh_prefix(p->ctx, GH_INPUT, "b\nc: ");
  assert_string_equal(gh_message(p->ctx), "b c: a.msh:4: $No?d? has no $End  ?[31m");
  gh_fail(p->ctx, GH_INPUT, "Größe");
  assert_string_equal(gh_message(p->ctx), "Größe");
}

/* Values that flow style would take for something else are printed in quotes; what was plain stays so. */
static void a_printed_document_is_the_same(void **state) {
  place *p = *state;
  const struct {
    const char *text, *printed;
  } docs[] = {{"a: [1e-8, -1, x:y, Größe, p?.data, a b]", "{a: [1e-8, -1, x:y, Größe, p?.data, a b]}"},
              {"a:\n- \n- b\n", "{a: [~, b]}"},
              {"\"\": 1\n", "{\"\": 1}"},
              {"? \n: 1\n", "{\"\": 1}"},
              {"a: \"x\\Ny\\Lz\\P\"\n", "{a: \"x\\Ny\\Lz\\P\"}"},
              {"a: ' b'\n", "{a: \" b\"}"},
              {"a: b\n", "{a: b}"}};
  for (size_t k = 0; k < sizeof docs / sizeof *docs; k++) {
    gh_yaml *doc = parsed(p, docs[k].text), *again;
    assert_printed(p, doc, docs[k].printed);
    again = parsed(p, docs[k].printed);
    assert_printed(p, again, docs[k].printed);
    gh_yaml_destroy(&again);
    gh_yaml_destroy(&doc);
  }
}

/* Keys that are set are printed so that they can be read, or refused when they are no text. */
/* Characters that no YAML text holds as they are, in the name of a key that is set: printed as escapes. */
static void keys_of_controls(void **state) {
  place *p = *state;
  char key[8], wanted[64];
  for (unsigned c = 0x80; c < 0xA0; c++) {
    if (c == 0x85) continue; /* the line break \N, above */
    snprintf(key, sizeof key, "k%c%cx", 0xC2, (int)c);
    gh_yaml *doc = parsed(p, "a: 1\n"), *again;
    assert_int_equal(gh_yaml_set(doc, key, "2"), GH_OK);
    snprintf(wanted, sizeof wanted, "{a: 1, \"k\\x%02Xx\": 2}", c);
    assert_printed(p, doc, wanted);
    again = parsed(p, wanted);
    assert_printed(p, again, wanted);
    gh_yaml_destroy(&again);
    gh_yaml_destroy(&doc);
  }
}

static void odd_keys_are_set_or_refused(void **state) {
  place *p = *state;
  const char *const keys[] = {"%%", "  b", "- b", "b: c", "@b", "b:", "&b", "!b"},
                    *const none[] = {"b\xB0", "b\xC0\x80",    "b\x01",
                                     "b\n",   "\xED\xA0\x80", "\xF4\x90\x80\x80"};
  for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
    char wanted[64];
    gh_yaml *doc = parsed(p, "a: 1\n");
    assert_int_equal(gh_yaml_set(doc, keys[k], "2"), GH_OK);
    snprintf(wanted, sizeof wanted, "{a: 1, \"%s\": 2}", keys[k]);
    assert_printed(p, doc, wanted);
    gh_yaml_destroy(&doc);
  }
  for (size_t k = 0; k < sizeof none / sizeof *none; k++) {
    gh_yaml *doc = parsed(p, "a: 1\n");
    assert_int_equal(gh_yaml_set(doc, none[k], "2"), GH_INPUT);
    assert_non_null(strstr(gh_message(p->ctx), "is no key"));
    assert_printed(p, doc, "{a: 1}");
    gh_yaml_destroy(&doc);
  }
}

/* A mesh whose list of names is empty is read; its groups have numbers for names. */
static void a_mesh_without_names_is_read(void **state) {
  place *p = *state;
  gh_mesh *mesh;
  const char *path = put_file(p, "a.msh",
                              "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n0\n$EndPhysicalNames\n"
                              "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n"
                              "$Elements\n2\n1 1 2 7 1 1 2\n2 3 2 8 1 1 2 3 4\n$EndElements\n");
  if (gh_mesh_read_gmsh(p->ctx, path, &mesh) != GH_OK) fail_msg("%s", gh_message(p->ctx));
  assert_int_equal(mesh->nelements, 1);
  assert_int_equal(mesh->nsets, 1);
  assert_string_equal(mesh->sets[0].name, "7");
  gh_mesh_destroy(&mesh);
}

/* A dataset where a group is to be holds nothing: its members are missing, which is wrong input. */
static void a_dataset_is_no_group(void **state) {
  place *p = *state;
  const char *path = in_folder(p, "a.h5");
  const double one[2] = {1, 2};
  double two[2];
  gh_h5 *file;
  size_t rows, cols;
  bool there = true;
  if (!gh_h5_available()) skip();
  assert_int_equal(gh_h5_open(p->ctx, path, "state 2", false, &file), GH_OK);
  assert_int_equal(gh_h5_put_doubles(file, "packing", 2, 1, one), GH_OK);
  assert_int_equal(gh_h5_put_doubles(file, "other/x", 2, 1, one), GH_OK);
  assert_int_equal(gh_h5_commit(&file), GH_OK);
  assert_int_equal(gh_h5_read(p->ctx, path, "state 2", NULL, &file), GH_OK);
  assert_int_equal(gh_h5_there(file, "packing/x", &there), GH_OK);
  assert_false(there);
  assert_int_equal(gh_h5_there(file, "other/x", &there), GH_OK);
  assert_true(there);
  assert_int_equal(gh_h5_size(file, "packing/x", &rows, &cols), GH_INPUT);
  assert_int_equal(gh_h5_get_doubles(file, "packing/x", 2, 1, two), GH_INPUT);
  assert_int_equal(gh_h5_get_doubles(file, "other", 2, 1, two), GH_INPUT);
  gh_h5_close(&file);
}

/* Diameters whose powers leave the range of numbers gave shares that are none. */
static void diameters_have_third_powers(void **state) {
  place *p = *state;
  const char *const wrong[] = {"5e-309", "1e-120", "1e120", "1e308"};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    const bool small = strstr(wrong[k], "e-") != NULL;
    char text[128];
    gh_sieve *sieve = NULL;
    snprintf(text, sizeof text, "diameter,volume_percent\n%s,50\n%s,50\n", small ? wrong[k] : "1",
             small ? "1" : wrong[k]);
    assert_int_equal(gh_sieve_read(p->ctx, put_file(p, "s.csv", text), &sieve), GH_INPUT);
    assert_non_null(strstr(gh_message(p->ctx), small ? "s.csv:2: diameter" : "s.csv:3: diameter"));
    assert_null(sieve);
  }
}

int main(void) {
#define TEST(f) cmocka_unit_test_setup_teardown(f, begin, end)
  const struct CMUnitTest tests[] = {
      TEST(a_message_has_no_control_characters), TEST(a_printed_document_is_the_same),
      TEST(odd_keys_are_set_or_refused),         TEST(keys_of_controls),
      TEST(a_mesh_without_names_is_read),        TEST(a_dataset_is_no_group),
      TEST(diameters_have_third_powers)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
