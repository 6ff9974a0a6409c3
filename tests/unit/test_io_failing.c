/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of texts, files and records that memory or the system fails. */
#include "test_io.h"

#include "io/file.h"
#include "io/json.h"

#include <errno.h>

/* A text that could not grow: any length of which half the address space is short. */
static void text_fail(gh_text *text) {
  assert_int_equal(gh_text_add(text, "x", SIZE_MAX / 4), GH_MEMORY);
}

/* It is lost as a whole: not read, not written, not added to another one, and what was on disk stays. */
static void a_text_that_failed_is_lost(void **state) {
  place *p = *state;
  const char *path = put_file(p, "a.txt", "before");
  gh_text *text, *other;
  size_t length = 99;
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  assert_int_equal(gh_text_create(p->ctx, &other), GH_OK);
  gh_text_print(text, "first line\n");
  assert_int_equal(gh_text_check(text), GH_OK);
  text_fail(text);
  gh_text_print(text, "a line that found memory again\n");
  assert_int_equal(gh_text_check(text), GH_MEMORY);
  assert_null(gh_text_get(text, &length));
  assert_int_equal(length, 0);
  assert_int_equal(gh_text_commit(text, path), GH_MEMORY);
  assert_non_null(strstr(gh_message(p->ctx), "a.txt: no memory for a text"));
  size_t size;
  char *there = get_file(path, &size);
  assert_string_equal(there, "before");
  free(there);
  gh_text_print(other, "whole\n");
  gh_text_join(other, text);
  assert_int_equal(gh_text_check(other), GH_MEMORY);
  assert_null(gh_text_get(other, NULL));
  assert_int_equal(gh_text_set(text, "new", 3), GH_OK); /* what was lost is replaced */
  assert_string_equal(gh_text_get(text, NULL), "new");
  gh_text_destroy(&text);
  gh_text_destroy(&other);
}

/* A wrong name is wrong input; what the system lacks or a device refuses is not. */
static void whose_fault_it_is(void **state) {
  (void)state;
  const int input[] = {ENOENT, ENOTDIR, EISDIR, EACCES, ELOOP, ENAMETOOLONG};
  const int system[] = {EIO, EMFILE, ENFILE, ENOSPC, EDQUOT, ESTALE, EBUSY};
  for (size_t k = 0; k < sizeof input / sizeof *input; k++)
    assert_int_equal(gh_exit_status(gh_read_status(input[k])), 2);
  for (size_t k = 0; k < sizeof system / sizeof *system; k++)
    assert_int_equal(gh_exit_status(gh_read_status(system[k])), 1);
  assert_int_equal(gh_read_status(ENOMEM), GH_MEMORY);
}

/* "Is not there" is an answer for missing names alone: a loop of links cannot be looked at. */
static void there_or_unknown(void **state) {
  place *p = *state;
  bool there;
  const char *file = put_file(p, "a", "x"), *loop = in_folder(p, "loop");
  assert_int_equal(symlink("loop", loop), 0);
  assert_int_equal(gh_file_there(p->ctx, file, &there), GH_OK);
  assert_true(there);
  assert_int_equal(gh_file_there(p->ctx, in_folder(p, "none"), &there), GH_OK);
  assert_false(there);
  assert_int_equal(gh_file_there(p->ctx, in_folder(p, "a/b"), &there), GH_OK);
  assert_false(there);
  assert_int_equal(gh_file_there(p->ctx, loop, &there), GH_SYSTEM);
  assert_int_equal(gh_file_remove(p->ctx, file), GH_OK);
  assert_int_equal(gh_file_remove(p->ctx, file), GH_OK);
  assert_int_equal(gh_file_remove(p->ctx, p->folder), GH_SYSTEM);
}

/* What could not be added to a record is remembered for all of it. */
static void a_record_remembers(void **state) {
  place *p = *state;
  bool failed = false;
  cJSON *root;
  gh_json o = {.at = cJSON_CreateObject(), .failed = &failed};
  gh_json_number(gh_json_group(o, "group"), "number", 0.1);
  gh_json_number(o, "none", NAN);
  assert_false(failed);
  assert_true(cJSON_IsNull(cJSON_GetObjectItem(o.at, "none")));
  gh_json_add(o, "list", NULL);
  assert_true(failed);
  cJSON_Delete(o.at);
  failed = false;
  gh_json nowhere = {.at = NULL, .failed = &failed};
  gh_json_text(gh_json_group(nowhere, "group"), "text", "lost");
  assert_true(failed);
  assert_int_equal(gh_json_parse(p->ctx, "run.json", "{\"a\": 1", &root), GH_INPUT);
  assert_null(root);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(a_text_that_failed_is_lost), TEST(whose_fault_it_is),
                                     TEST(there_or_unknown), TEST(a_record_remembers)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
