/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of files that appear whole, folders, paths. */
#include "test_io.h"

#include <fcntl.h>
#include <sys/wait.h>

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

/* Pipes and devices are written directly and stay what they are; /dev/full states that it is full. */
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

/* Folders that are missing, and folders in the place of the file, are reported. */
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

static mode_t mode_of(const char *path) {
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  return info.st_mode & 07777;
}

/* Entries of a folder, hidden ones included. */
static int count_all(const char *folder) {
  int n = 0;
  DIR *dir = opendir(folder);
  assert_non_null(dir);
  for (struct dirent *e; (e = readdir(dir));)
    n += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
  closedir(dir);
  return n;
}

/* Whether a file can be written is found without leaving anything, and without changing what is there. */
static void what_can_be_written_is_known_before(void **state) {
  place *p = *state;
  const char *path = put_file(p, "a", "before");
  assert_int_equal(gh_file_writable(p->ctx, path), GH_OK);
  assert_file(path, "before");
  assert_int_equal(gh_file_writable(p->ctx, in_folder(p, "b")), GH_OK);
  assert_int_equal(gh_file_writable(p->ctx, "/dev/null"), GH_OK);
  assert_int_equal(gh_file_writable(p->ctx, p->folder), GH_SYSTEM);
  assert_message(p, p->folder, ": cannot write: Is a directory");
  assert_int_equal(gh_file_writable(p->ctx, in_folder(p, "none/b")), GH_SYSTEM);
  assert_int_equal(count_all(p->folder), 1);
}

/* A file that is replaced keeps its permissions; a new one has those that the umask leaves. */
static void permissions_are_kept(void **state) {
  static const mode_t modes[] = {0600, 0664, 0755, 0444};
  place *p = *state;
  const char *path = put_file(p, "a", "before"), *fresh = in_folder(p, "new");
  gh_text *text;
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  for (size_t k = 0; k < sizeof modes / sizeof *modes; k++) {
    if (!(modes[k] & 0200) && geteuid() != 0) continue;
    assert_int_equal(chmod(path, modes[k]), 0);
    assert_int_equal(gh_text_commit(text, path), GH_OK);
    assert_int_equal(mode_of(path), modes[k]);
  }
  mode_t before = umask(027);
  assert_int_equal(gh_text_commit(text, fresh), GH_OK);
  umask(before);
  assert_int_equal(mode_of(fresh), 0640);
  gh_text_destroy(&text);
}

/* Links at names that a program might use for its new file are not followed, and stay. */
static void links_at_other_names_are_not_followed(void **state) {
  place *p = *state;
  const char *path = in_folder(p, "o.csv"), *victim = put_file(p, "victim", "mine");
  gh_text *text;
  assert_int_equal(symlink("victim", in_folder(p, "o.csv.tmp")), 0);
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  gh_text_print(text, "results");
  assert_int_equal(gh_text_commit(text, path), GH_OK);
  assert_file(path, "results");
  assert_file(victim, "mine");
  struct stat info;
  assert_int_equal(lstat(path, &info), 0);
  assert_true(S_ISREG(info.st_mode));
  assert_int_equal(count_all(p->folder), 3);
  gh_text_destroy(&text);
}

/* Links to links, to a file that is not there yet, and in a circle. */
static void links_are_followed_to_their_end(void **state) {
  place *p = *state;
  const char *sub = in_folder(p, "sub"), *link = in_folder(p, "link");
  gh_text *text;
  assert_int_equal(mkdir(sub, 0700), 0);
  assert_int_equal(symlink("sub/second", link), 0);
  assert_int_equal(symlink("../a.txt", in_folder(p, "sub/second")), 0);
  assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
  for (int k = 0; k < 2; k++) { /* made, and then replaced */
    gh_text_print(text, "x");
    assert_int_equal(gh_text_commit(text, link), GH_OK);
    assert_file(in_folder(p, "a.txt"), k == 0 ? "x" : "xx");
  }
  assert_int_equal(count_all(p->folder), 3);
  assert_int_equal(symlink("round", in_folder(p, "round")), 0);
  assert_int_equal(gh_text_commit(text, in_folder(p, "round")), GH_SYSTEM);
  gh_text_destroy(&text);
}

/* Processes that write one file at the same time: it is always one of their texts, whole. */
static void writers_at_the_same_time_do_not_mix(void **state) {
  enum { WRITERS = 4, ROUNDS = 25, LENGTH = 30000 };
  place *p = *state;
  const char *path = in_folder(p, "same");
  pid_t child[WRITERS];
  for (int w = 0; w < WRITERS; w++) {
    child[w] = fork();
    assert_true(child[w] >= 0);
    if (child[w] > 0) continue;
    gh_text *text;
    bool fine = gh_text_create(p->ctx, &text) == GH_OK;
    for (int k = 0; k < LENGTH * (w + 1); k++) gh_text_print(text, "%c", 'a' + w);
    for (int k = 0; k < ROUNDS; k++) fine = gh_text_commit(text, path) == GH_OK && fine;
    _exit(fine ? 0 : 1);
  }
  for (int w = 0; w < WRITERS; w++) {
    int status;
    assert_int_equal(waitpid(child[w], &status, 0), child[w]);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  size_t length;
  char *text = get_file(path, &length);
  assert_int_equal(length, (size_t)LENGTH * (size_t)(text[0] - 'a' + 1));
  for (size_t k = 0; k < length; k++) assert_int_equal(text[k], text[0]);
  free(text);
  assert_int_equal(count_all(p->folder), 1);
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
                                     TEST(what_can_be_written_is_known_before),
                                     TEST(permissions_are_kept),
                                     TEST(links_at_other_names_are_not_followed),
                                     TEST(links_are_followed_to_their_end),
                                     TEST(writers_at_the_same_time_do_not_mix),
                                     TEST(folders_are_made),
                                     TEST(paths_are_joined_and_cut)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
