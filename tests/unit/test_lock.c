/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of the lock of a folder. */
#include "test_io.h"

#include <errno.h>
#include <sys/wait.h>

static bool exists(const char *path) {
  return access(path, F_OK) == 0;
}

/* A child that takes the lock, reports it, and waits to be ended; *number: of the child. */
static int start_owner(place *p, const char *folder, pid_t *number) {
  int pipes[2];
  char told = 0;
  assert_int_equal(pipe(pipes), 0);
  *number = fork();
  assert_true(*number >= 0);
  if (*number == 0) {
    gh_lock *lock;
    bool fine = gh_lock_create(p->ctx, folder, &lock) == GH_OK && write(pipes[1], "x", 1) == 1;
    if (fine) pause();
    _exit(1);
  }
  close(pipes[1]);
  assert_int_equal(read(pipes[0], &told, 1), 1);
  close(pipes[0]);
  return told;
}

static void end_owner(pid_t number, int with) {
  int status;
  kill(number, with);
  assert_int_equal(waitpid(number, &status, 0), number);
}

/* The folder and its parents are made, the file names process and host, and what was made goes with the lock.
 */
static void a_lock_makes_its_folder(void **state) {
  place *p = *state;
  const char *folder = in_folder(p, "a/b//c/"), *file = in_folder(p, "a/b/c/.lock");
  char host[256] = "", wanted[320];
  gh_lock *lock;
  size_t length;
  assert_int_equal(gh_lock_create(p->ctx, folder, &lock), GH_OK);
  char *text = get_file(file, &length);
  gethostname(host, sizeof host - 1);
  snprintf(wanted, sizeof wanted, "process %ld on host %s\n", (long)getpid(), host);
  assert_string_equal(text, wanted);
  free(text);
  gh_lock_destroy(&lock);
  assert_null(lock);
  gh_lock_destroy(&lock);
  assert_int_equal(count_entries(p->folder), 0);
}

/* Folders that were there, and those in which something was written, stay. */
static void what_is_in_use_stays(void **state) {
  place *p = *state;
  gh_lock *lock;
  assert_int_equal(gh_lock_create(p->ctx, p->folder, &lock), GH_OK);
  gh_lock_destroy(&lock);
  assert_true(exists(p->folder));
  assert_false(exists(in_folder(p, ".lock")));
  assert_int_equal(gh_lock_create(p->ctx, in_folder(p, "a/b"), &lock), GH_OK);
  put_file(p, "a/results", "x");
  gh_lock_destroy(&lock);
  assert_false(exists(in_folder(p, "a/b")));
  assert_true(exists(in_folder(p, "a/results")));
}

/* A second one is refused as long as the first one lives, within a process too, and told who that is. */
static void a_second_owner_is_refused(void **state) {
  place *p = *state;
  const char *folder = in_folder(p, "out");
  char host[256] = "", wanted[1024];
  gh_lock *lock;
  pid_t owner;
  start_owner(p, folder, &owner);
  assert_int_equal(gh_lock_create(p->ctx, folder, &lock), GH_SYSTEM);
  assert_null(lock);
  gethostname(host, sizeof host - 1);
  snprintf(wanted, sizeof wanted,
           ": process %ld on host %s writes into this folder (%s/.lock); wait for its end, or choose another "
           "folder",
           (long)owner, host, folder);
  assert_message(p, folder, wanted);
  end_owner(owner, SIGKILL);
  assert_true(exists(in_folder(p, "out/.lock"))); /* left behind, and no obstacle */
  gh_lock *second;
  assert_int_equal(gh_lock_create(p->ctx, folder, &lock), GH_OK);
  assert_int_equal(gh_lock_create(p->ctx, folder, &second), GH_SYSTEM);
  gh_lock_destroy(&lock);
  assert_false(exists(in_folder(p, "out/.lock")));
}

/* Children that do not hold on to it, and files and links in its place. */
static void places_that_cannot_be_locked(void **state) {
  place *p = *state;
  gh_lock *lock;
  const char *file = put_file(p, "file", "mine"), *folder = in_folder(p, "linked");
  assert_int_equal(gh_lock_create(p->ctx, file, &lock), GH_INPUT);
  assert_int_equal(gh_lock_create(p->ctx, "", &lock), GH_INPUT);
  assert_int_equal(gh_lock_create(p->ctx, "/proc/none", &lock), GH_SYSTEM);
  assert_int_equal(mkdir(folder, 0700), 0);
  assert_int_equal(symlink("../file", in_folder(p, "linked/.lock")), 0);
  assert_int_equal(gh_lock_create(p->ctx, folder, &lock), GH_SYSTEM);
  size_t length;
  char *text = get_file(file, &length);
  assert_string_equal(text, "mine");
  free(text);
}

/* Many at one time: there is never more than one owner, and always one gets it. */
static void of_many_one_wins(void **state) {
  enum { ROUNDS = 20, MANY = 4 };
  place *p = *state;
  for (int round = 0; round < ROUNDS; round++) {
    const char *folder = in_folder(p, "race/out");
    int gate[2], told[2], won = 0;
    pid_t child[MANY];
    assert_true(pipe(gate) == 0 && pipe(told) == 0);
    for (int k = 0; k < MANY; k++) {
      child[k] = fork();
      assert_true(child[k] >= 0);
      if (child[k] > 0) continue;
      gh_lock *lock;
      char byte;
      close(gate[1]);
      while (read(gate[0], &byte, 1) > 0) continue; /* until all are there */
      byte = gh_lock_create(p->ctx, folder, &lock) == GH_OK;
      bool fine = write(told[1], &byte, 1) == 1;
      if (byte) pause();
      _exit(fine ? 0 : 1);
    }
    close(gate[0]), close(gate[1]);
    for (int k = 0; k < MANY; k++) {
      char byte;
      assert_int_equal(read(told[0], &byte, 1), 1);
      won += byte;
    }
    close(told[0]), close(told[1]);
    assert_int_equal(won, 1);
    for (int k = 0; k < MANY; k++) end_owner(child[k], SIGKILL);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(a_lock_makes_its_folder), TEST(what_is_in_use_stays),
                                     TEST(a_second_owner_is_refused), TEST(places_that_cannot_be_locked),
                                     TEST(of_many_one_wins)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
