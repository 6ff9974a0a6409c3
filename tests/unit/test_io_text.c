/* Tests of files that appear whole, folders, paths. SPDX-License-Identifier: GPL-2.0-or-later */
#include "test_io.h"

#include <fcntl.h>

static void assert_file(const char *path, const char *wanted) {
  size_t length;
  char *text = get_file(path, &length);
  assert_string_equal(text, wanted);
  free(text);
}

/* Printed text is on disk after each commit, all of it, and nothing beside it. */
static void text_appears_with_the_commit(void **state) {
  place *p = *state;
  const char *path = in_folder(p, "a.txt");
  gh_text *text;
  size_t length = 99;
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  assert_string_equal(gh_text_get(text, &length), "");
  assert_int_equal(length, 0);
  gh_text_print(text, "%d %s\n", 1, "one");
  assert_int_equal(access(path, F_OK), -1);
  assert_int_equal(gh_text_commit(text, path), GH_OK);
  assert_file(path, "1 one\n");
  gh_text_print(text, "%d\n", 2);
  assert_int_equal(gh_text_commit(text, path), GH_OK);
  assert_file(path, "1 one\n2\n");
  assert_int_equal(count_entries(p->folder), 1);
  gh_text_destroy(&text);
  assert_null(text);
  gh_text_destroy(&text);
}

/* A full disk leaves the file of before, no .tmp, and the system's own words. */
static void a_full_disk_leaves_the_old_file(void **state) {
  place *p = *state;
  const char *path = put_file(p, "a.txt", "before");
  gh_text *text;
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  for (int k = 0; k < 10000; k++) gh_text_print(text, "line %d\n", k);
  limit_files(4096);
  gh_status s = gh_text_commit(text, path);
  limit_files(RLIM_INFINITY);
  assert_int_equal(s, GH_SYSTEM);
  assert_message(p, path, ": cannot write: File too large");
  assert_file(path, "before");
  assert_int_equal(count_entries(p->folder), 1);
  assert_int_equal(gh_text_commit(text, path), GH_OK); /* there is room again */
  gh_text_destroy(&text);
}

/* Pipes and devices are written directly and stay what they are; /dev/full says that it is full. */
static void devices_are_not_replaced(void **state) {
  place *p = *state;
  gh_text *text;
  char got[8] = "";
  const char *path = in_folder(p, "pipe");
  assert_int_equal(mkfifo(path, 0600), 0);
  int fd = open(path, O_RDWR);
  assert_true(fd >= 0);
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  gh_text_print(text, "text");
  assert_int_equal(gh_text_commit(text, path), GH_OK);
  assert_int_equal(read(fd, got, sizeof got - 1), 4);
  assert_string_equal(got, "text");
  assert_int_equal(count_entries(p->folder), 1);
  close(fd);
  assert_int_equal(gh_text_commit(text, "/dev/full"), GH_SYSTEM);
  assert_message(p, "/dev/full", ": cannot write: No space left on device");
  gh_text_destroy(&text);
}

/* What stands behind a symbolic link is replaced, the link stays. */
static void links_stay(void **state) {
  place *p = *state;
  const char *path = put_file(p, "a.txt", "before"), *link = in_folder(p, "link");
  struct stat info;
  gh_text *text;
  assert_int_equal(symlink("a.txt", link), 0);
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  gh_text_print(text, "after");
  assert_int_equal(gh_text_commit(text, link), GH_OK);
  assert_file(path, "after");
  assert_int_equal(lstat(link, &info), 0);
  assert_true(S_ISLNK(info.st_mode));
  gh_text_destroy(&text);
}

/* Folders that are missing, and folders in the place of the file, are told. */
static void places_that_cannot_be_written(void **state) {
  place *p = *state;
  gh_text *text;
  const char *path = in_folder(p, "none/a.txt");
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  assert_int_equal(gh_text_commit(text, path), GH_SYSTEM);
  assert_message(p, path, ": cannot write: No such file or directory");
  assert_int_equal(gh_text_commit(text, p->folder), GH_SYSTEM);
  assert_message(p, p->folder, ": cannot write: Is a directory");
  gh_text_destroy(&text);
}

/* A text of another writer takes the file's place; one that cannot is removed. */
static void other_writers_replace_files(void **state) {
  place *p = *state;
  const char *path = put_file(p, "a", "before"), *tmp = put_file(p, "b", "after");
  assert_int_equal(gh_file_replace(p->ctx, tmp, path), GH_OK);
  assert_file(path, "after");
  assert_int_equal(count_entries(p->folder), 1);
  assert_int_equal(gh_file_replace(p->ctx, tmp, path), GH_SYSTEM);
  assert_message(p, tmp, ": cannot open: No such file or directory");
  put_file(p, "b", "again");
  assert_int_equal(gh_file_replace(p->ctx, tmp, p->folder), GH_SYSTEM);
  assert_int_equal(access(tmp, F_OK), -1);
}

/* Folders are made with their parents, twice too; files in the way are wrong input, a system that refuses is
 * not. */
static void folders_are_made(void **state) {
  place *p = *state;
  const char *path = in_folder(p, "a//b/../c/");
  struct stat info;
  assert_int_equal(gh_folder_make(p->ctx, path), GH_OK);
  assert_int_equal(gh_folder_make(p->ctx, path), GH_OK);
  assert_int_equal(stat(path, &info), 0);
  assert_true(S_ISDIR(info.st_mode));
  const char *file = put_file(p, "file", "x"), *below = in_folder(p, "file/sub");
  assert_int_equal(gh_folder_make(p->ctx, file), GH_INPUT);
  assert_message(p, file, ": is a file, a folder is wanted");
  assert_int_equal(gh_folder_make(p->ctx, below), GH_INPUT);
  assert_message(p, file, ": is a file, a folder is wanted");
  assert_int_equal(gh_folder_make(p->ctx, ""), GH_INPUT);
  assert_int_equal(gh_folder_make(p->ctx, "/proc/none"), GH_SYSTEM);
  assert_message(p, "/proc/none", ": cannot make the folder: No such file or directory");
}

static void assert_text(char *made, const char *wanted) {
  assert_non_null(made);
  assert_string_equal(made, wanted);
  free(made);
}

/* Paths are joined and cut as dirname(1) does it. */
static void paths_are_joined_and_cut(void **state) {
  (void)state;
  assert_text(gh_path_join("a/b", "c"), "a/b/c");
  assert_text(gh_path_join("a/", "c"), "a/c");
  assert_text(gh_path_join("/", "c"), "/c");
  assert_text(gh_path_join("a", "/c"), "/c");
  assert_text(gh_path_join("", "c"), "c");
  assert_text(gh_path_folder("a/b.yaml"), "a");
  assert_text(gh_path_folder("b.yaml"), ".");
  assert_text(gh_path_folder("/b.yaml"), "/");
  assert_text(gh_path_folder("/a/b/"), "/a");
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(text_appears_with_the_commit),
                                     TEST(a_full_disk_leaves_the_old_file),
                                     TEST(devices_are_not_replaced),
                                     TEST(links_stay),
                                     TEST(places_that_cannot_be_written),
                                     TEST(other_writers_replace_files),
                                     TEST(folders_are_made),
                                     TEST(paths_are_joined_and_cut)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
