/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of HDF5 files. */
#include "io/seal.h"
#include "test_io.h"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/wait.h>

static const double numbers[6] = {1 / 3., -0.0, 5e-324, 1.7976931348623157e308, -2, 1e-8};
static const int integers[3] = {-2147483647 - 1, 0, 2147483647};

/* A file with a matrix, a vector of integers in groups, a text and a dataset of no rows. */
static const char *make_file(place *p, const char *name) {
  const char *path = in_folder(p, name);
  gh_h5 *f;
  assert_int_equal(gh_h5_open(p->ctx, path, "test 1", false, &f), GH_OK);
  assert_int_equal(gh_h5_put_doubles(f, "/step0003/P", 2, 3, numbers), GH_OK);
  assert_int_equal(gh_h5_put_ints(f, "/step0003/deep/id", 3, 1, integers), GH_OK);
  assert_int_equal(gh_h5_put_text(f, "/run", "sand \xC3\xBC"), GH_OK);
  assert_int_equal(gh_h5_put_text(f, "/nothing", ""), GH_OK);
  assert_int_equal(gh_h5_put_doubles(f, "/none", 0, 4, NULL), GH_OK);
  assert_int_equal(gh_h5_put_ints(f, "/none1", 0, 1, NULL), GH_OK);
  assert_int_equal(gh_h5_commit(&f), GH_OK);
  assert_null(f);
  return path;
}

/* Numbers come back bit by bit, also those of no rows. */
static void a_round_trip_is_bitwise(void **state) {
  place *p = *state;
  const char *path = make_file(p, "a.h5");
  gh_h5 *f;
  double d[6];
  int i[3];
  struct stat info;
  size_t rows, cols;
  assert_int_equal(count_entries(p->folder), 1);
  assert_int_equal(stat(path, &info), 0);
  assert_true(info.st_size < 20000); /* no padding to speak of */
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", NULL, &f), GH_OK);
  assert_int_equal(gh_h5_size(f, "/step0003/P", &rows, &cols), GH_OK);
  assert_true(rows == 2 && cols == 3);
  assert_int_equal(gh_h5_get_doubles(f, "/step0003/P", 2, 3, d), GH_OK);
  assert_memory_equal(d, numbers, sizeof d);
  assert_int_equal(gh_h5_size(f, "/step0003/deep/id", &rows, &cols), GH_OK);
  assert_true(rows == 3 && cols == 1);
  assert_int_equal(gh_h5_get_ints(f, "/step0003/deep/id", 3, 1, i), GH_OK);
  assert_memory_equal(i, integers, sizeof i);
  assert_int_equal(gh_h5_get_doubles(f, "/step0003/deep/id", 3, 1, d), GH_OK);
  assert_true(d[0] == -2147483648.0 && d[2] == 2147483647.0);
  assert_int_equal(gh_h5_size(f, "/none", &rows, &cols), GH_OK);
  assert_true(rows == 0 && cols == 4);
  assert_int_equal(gh_h5_get_doubles(f, "/none", 0, 4, NULL), GH_OK);
  assert_int_equal(gh_h5_size(f, "/none1", &rows, &cols), GH_OK);
  assert_true(rows == 0 && cols == 1);
  gh_h5_close(&f);
  assert_null(f);
  gh_h5_close(&f);
}

/* The text is a UTF-8 string of fixed length, as HDF5's own functions see it. */
static void a_text_is_a_string(void **state) {
  place *p = *state;
  char text[32] = "";
  hid_t file = H5Fopen(make_file(p, "a.h5"), H5F_ACC_RDONLY, H5P_DEFAULT),
        set = H5Dopen2(file, "/run", H5P_DEFAULT);
  hid_t type = H5Dget_type(set);
  assert_int_equal(H5Tget_class(type), H5T_STRING);
  assert_int_equal(H5Tget_cset(type), H5T_CSET_UTF8);
  assert_true(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0);
  assert_string_equal(text, "sand \xC3\xBC");
  H5Tclose(type), H5Dclose(set), H5Fclose(file);
  gh_h5 *f;
  char five[5];
  memset(text, 'x', sizeof text);
  assert_int_equal(gh_h5_read(p->ctx, make_file(p, "b.h5"), "test 1", NULL, &f), GH_OK);
  assert_int_equal(gh_h5_get_text(f, "/run", sizeof text, text), GH_OK);
  assert_string_equal(text, "sand \xC3\xBC");
  assert_int_equal(gh_h5_get_text(f, "/nothing", sizeof text, text), GH_OK);
  assert_string_equal(text, "");
  assert_int_equal(gh_h5_get_text(f, "/run", sizeof five, five), GH_INPUT);
  assert_message(p, in_folder(p, "b.h5"), ": /run is a text of 8 bytes, at most 5 are read");
  assert_int_equal(gh_h5_get_text(f, "/step0003/P", sizeof text, text), GH_INPUT);
  assert_message(p, in_folder(p, "b.h5"), ": /step0003/P does not hold a text");
  assert_int_equal(gh_h5_get_text(f, "/nowhere", sizeof text, text), GH_INPUT);
  gh_h5_close(&f);
}

/* Appending keeps what is there and replaces datasets of the same name, also of another size; not appending
 * starts again. */
static void appending_keeps_what_is_there(void **state) {
  place *p = *state;
  const char *path = make_file(p, "a.h5");
  gh_h5 *f;
  double d[6];
  size_t rows, cols;
  assert_int_equal(gh_h5_open(p->ctx, path, "test 1", true, &f), GH_OK);
  assert_int_equal(gh_h5_put_doubles(f, "/step0004/P", 1, 1, numbers), GH_OK);
  assert_int_equal(gh_h5_put_doubles(f, "/none", 3, 2, numbers), GH_OK);
  assert_int_equal(gh_h5_get_doubles(f, "/none", 3, 2, d), GH_OK); /* before the commit, too */
  assert_int_equal(gh_h5_commit(&f), GH_OK);
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", NULL, &f), GH_OK);
  assert_int_equal(gh_h5_get_doubles(f, "/step0003/P", 2, 3, d), GH_OK);
  assert_memory_equal(d, numbers, sizeof d);
  assert_int_equal(gh_h5_get_doubles(f, "/step0004/P", 1, 1, d), GH_OK);
  assert_int_equal(gh_h5_size(f, "/none", &rows, &cols), GH_OK);
  assert_true(rows == 3 && cols == 2);
  gh_h5_close(&f);
  assert_int_equal(gh_h5_open(p->ctx, in_folder(p, "new.h5"), "test 1", true, &f),
                   GH_OK); /* nothing to append to */
  assert_int_equal(gh_h5_commit(&f), GH_OK);
  assert_int_equal(gh_h5_open(p->ctx, path, "test 1", false, &f), GH_OK);
  assert_int_equal(gh_h5_commit(&f), GH_OK);
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", NULL, &f), GH_OK);
  assert_int_equal(gh_h5_size(f, "/none", &rows, &cols), GH_INPUT);
  gh_h5_close(&f);
}

/* Without a commit nothing changes on disk. */
static void without_commit_nothing_changes(void **state) {
  place *p = *state;
  const char *path = make_file(p, "a.h5");
  size_t before, after;
  gh_h5 *f;
  char *old = get_file(path, &before);
  for (int append = 0; append < 2; append++) {
    assert_int_equal(gh_h5_open(p->ctx, path, "test 1", append, &f), GH_OK);
    assert_int_equal(gh_h5_put_doubles(f, "/more", 6, 1, numbers), GH_OK);
    gh_h5_close(&f);
    char *now = get_file(path, &after);
    assert_int_equal(after, before);
    assert_memory_equal(now, old, before);
    free(now);
  }
  assert_int_equal(count_entries(p->folder), 1);
  free(old);
}

/* The same contents make the same bytes, whatever the time. */
static void files_are_reproducible(void **state) {
  place *p = *state;
  size_t na, nb;
  char *a = get_file(make_file(p, "a.h5"), &na);
  sleep(1);
  char *b = get_file(make_file(p, "b.h5"), &nb);
  assert_int_equal(na, nb);
  assert_memory_equal(a, b, na);
  free(a);
  free(b);
}

/* A full disk leaves the file of before and no .tmp; afterwards the same program writes again. */
static void a_full_disk_leaves_the_old_file(void **state) {
  enum { N = 100000 };
  place *p = *state;
  const char *path = make_file(p, "a.h5");
  size_t before, after;
  gh_h5 *f;
  char *old = get_file(path, &before);
  double *d = calloc(N, sizeof *d);
  for (int k = 0; k < 3; k++) {
    assert_int_equal(gh_h5_open(p->ctx, path, "test 1", true, &f), GH_OK);
    assert_int_equal(gh_h5_put_doubles(f, "/large", N, 1, d), GH_OK);
    limit_files(65536);
    gh_status s = gh_h5_commit(&f);
    limit_files(RLIM_INFINITY);
    assert_int_equal(s, GH_SYSTEM);
    assert_null(f);
    assert_message(p, path, ": cannot write: File too large");
    assert_int_equal(count_entries(p->folder), 1);
  }
  char *now = get_file(path, &after);
  assert_int_equal(after, before);
  assert_memory_equal(now, old, before);
  assert_int_equal(gh_h5_open(p->ctx, path, "test 1", true, &f), GH_OK);
  assert_int_equal(gh_h5_put_doubles(f, "/large", N, 1, d), GH_OK);
  assert_int_equal(gh_h5_commit(&f), GH_OK);
  free(now), free(old), free(d);
}

static void assert_no_file(place *p, const char *path, const char *message) {
  gh_h5 *f;
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", NULL, &f), GH_INPUT);
  assert_null(f);
  assert_message(p, path, message);
  if (strstr(message, "No such file")) return;
  assert_int_equal(gh_h5_open(p->ctx, path, "test 1", true, &f), GH_INPUT);
  assert_null(f);
  assert_message(p, path, message);
}

/* Missing files, folders, empty files, other files and cut files are refused, for reading and for appending.
 */
static void what_is_no_hdf5_is_refused(void **state) {
  place *p = *state;
  size_t length;
  char *whole = get_file(make_file(p, "a.h5"), &length);
  assert_no_file(p, in_folder(p, "none.h5"), ": cannot be opened: No such file or directory");
  assert_no_file(p, p->folder, ": is a folder, a file is wanted");
  assert_no_file(p, put_file(p, "b.h5", ""), ": the file is empty");
  assert_no_file(
      p, put_file(p, "b.h5", "step,F11\n0,1\n"),
      ": is damaged, or no binary file of granhom: it does not start with \"granhom binary file, format "
      "1\"");
  gh_h5 *f;
  for (size_t n = 1; n < length; n += n < 200 ? 1 : 97) {
    const char *path = put_bytes(p, "b.h5", whole, n);
    assert_int_equal(gh_h5_read(p->ctx, path, "test 1", NULL, &f), GH_INPUT);
    assert_int_equal(gh_h5_open(p->ctx, path, "test 1", true, &f), GH_INPUT);
  }
  free(whole);
}

/* Datasets that are missing, of another shape or type, and writing where reading is meant. */
static void wrong_datasets_are_refused(void **state) {
  place *p = *state;
  const char *path = make_file(p, "a.h5");
  gh_h5 *f;
  size_t rows, cols;
  double d[6];
  int i[6];
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", NULL, &f), GH_OK);
  assert_int_equal(gh_h5_size(f, "/step0003/Q", &rows, &cols), GH_INPUT);
  assert_message(p, path, ": cannot find /step0003/Q: object 'Q' doesn't exist");
  assert_int_equal(gh_h5_size(f, "/x/y/z", &rows, &cols), GH_INPUT);
  assert_int_equal(gh_h5_get_doubles(f, "/step0003", 1, 1, d), GH_INPUT);
  assert_int_equal(gh_h5_get_doubles(f, "/step0003/P", 3, 2, d), GH_INPUT);
  assert_message(p, path, ": /step0003/P is 2 x 3, wanted is 3 x 2");
  assert_int_equal(gh_h5_get_ints(f, "/step0003/P", 2, 3, i), GH_INPUT);
  assert_message(p, path, ": /step0003/P does not hold integers");
  assert_int_equal(gh_h5_get_doubles(f, "/run", 1, 1, d), GH_INPUT);
  assert_message(p, path, ": /run does not hold numbers");
  assert_int_equal(gh_h5_put_ints(f, "/id", 1, 1, i), GH_INTERNAL);
  assert_int_equal(gh_h5_put_text(f, "/text", "x"), GH_INTERNAL);
  assert_int_equal(gh_h5_commit(&f), GH_INTERNAL);
  assert_null(f);
  assert_int_equal(gh_h5_open(p->ctx, path, "test 1", true, &f), GH_OK);
  assert_int_equal(gh_h5_put_doubles(f, "/step0003", 1, 1, d), GH_INTERNAL); /* a group is not replaced */
  assert_int_equal(gh_h5_put_doubles(f, "/d", SIZE_MAX / 8, 3, d), GH_INTERNAL);
  gh_h5_close(&f);
}

/* The same data as another program would write them. */
static const char *make_plain(place *p, const char *name) {
  hid_t from = H5Fopen(make_file(p, "sealed.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
  const char *path = in_folder(p, name);
  hid_t to = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Ocopy(from, "/step0003", to, "/step0003", H5P_DEFAULT, H5P_DEFAULT) >= 0);
  H5Fclose(from), H5Fclose(to);
  return path;
}

static void flip(int fd, size_t at, int bit) {
  char byte;
  assert_int_equal(pread(fd, &byte, 1, (off_t)at), 1);
  byte = (char)(byte ^ 1 << bit);
  assert_int_equal(pwrite(fd, &byte, 1, (off_t)at), 1);
}

static void assert_damaged(place *p, const char *path) {
  gh_h5 *f;
  bool sealed;
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", &sealed, &f), GH_INPUT);
  assert_non_null(strstr(gh_message(p->ctx), path));
  assert_non_null(strstr(gh_message(p->ctx), "damaged"));
  assert_int_equal(gh_h5_open(p->ctx, path, "test 1", true, &f), GH_INPUT);
  assert_null(f);
}

/* Any bit that is flipped is seen: all of them in the header and what follows it, 2000 at random behind. */
static void any_flipped_bit_is_seen(void **state) {
  enum { HEAD = 640, RANDOM = 2000 };
  place *p = *state;
  const char *path = make_file(p, "a.h5");
  unsigned seed = (unsigned)getpid();
  struct stat info;
  print_message("seed %u\n", seed);
  srand(seed);
  int fd = open(path, O_RDWR);
  assert_true(fd >= 0);
  assert_int_equal(fstat(fd, &info), 0);
  assert_true(info.st_size > 2 * HEAD);
  for (int k = 0; k < 8 * HEAD + RANDOM; k++) {
    size_t at = k < 8 * HEAD ? (size_t)k / 8 : (size_t)rand() % (size_t)info.st_size;
    flip(fd, at, k % 8);
    assert_damaged(p, path);
    flip(fd, at, k % 8);
  }
  close(fd);
  gh_h5 *f;
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", NULL, &f), GH_OK);
  gh_h5_close(&f);
}

/* A file that is cut anywhere, longer by a byte, or put together of two. */
static void other_lengths_are_seen(void **state) {
  place *p = *state;
  size_t length;
  char *whole = get_file(make_file(p, "a.h5"), &length), *longer = calloc(2, length);
  for (size_t n = 1; n < length; n += n < 600 ? 1 : 61) assert_damaged(p, put_bytes(p, "b.h5", whole, n));
  memcpy(longer, whole, length);
  assert_damaged(p, put_bytes(p, "b.h5", longer, length + 1));
  memcpy(longer + length, whole, length);
  assert_damaged(p, put_bytes(p, "b.h5", longer, 2 * length));
  memset(longer + length / 2, 0, length - length / 2); /* a block that never came to disk */
  assert_damaged(p, put_bytes(p, "b.h5", longer, length));
  free(whole), free(longer);
}

/* Kind and version are those that the reader wants. */
static void other_kinds_are_refused(void **state) {
  place *p = *state;
  const char *path = make_file(p, "a.h5");
  gh_h5 *f;
  assert_int_equal(gh_h5_read(p->ctx, path, "test 2", NULL, &f), GH_INPUT);
  assert_message(p, path,
                 ": holds a test 1 of granhom, wanted is a test 2 (the number is the version of the format)");
  assert_int_equal(gh_h5_open(p->ctx, path, "state 1", true, &f), GH_INPUT);
}

/* HDF5 files of other programs are refused, or read where the caller allows that; never appended to. */
static void files_without_a_checksum(void **state) {
  place *p = *state;
  const char *path = make_plain(p, "plain.h5");
  gh_h5 *f;
  bool sealed = true;
  double d[6];
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", NULL, &f), GH_INPUT);
  assert_non_null(strstr(gh_message(p->ctx), "plain.h5: has no checksum"));
  assert_int_equal(gh_h5_open(p->ctx, path, "test 1", true, &f), GH_INPUT);
  assert_int_equal(gh_h5_read(p->ctx, path, "test 1", &sealed, &f), GH_OK);
  assert_false(sealed);
  assert_int_equal(gh_h5_get_doubles(f, "/step0003/P", 2, 3, d), GH_OK);
  assert_memory_equal(d, numbers, sizeof d);
  gh_h5_close(&f);
  assert_int_equal(gh_h5_read(p->ctx, make_file(p, "a.h5"), "test 1", &sealed, &f), GH_OK);
  assert_true(sealed);
  gh_h5_close(&f);
  assert_int_equal(gh_h5_read(p->ctx, "/dev/zero", "test 1", NULL, &f), GH_INPUT);
  assert_string_equal(gh_message(p->ctx), "/dev/zero: is a device or a pipe, a file is wanted");
}

static bool read_damaged(place *p) {
  size_t length;
  char *whole = get_file(make_plain(p, "a.h5"), &length), *damaged = malloc(length);
  bool fine = true, sealed;
  for (int k = 0; k < 500; k++) {
    gh_h5 *f;
    double d[6];
    memcpy(damaged, whole, length);
    for (int c = 0; c < 8; c++) damaged[(size_t)rand() % length] = (char)rand();
    gh_status s = gh_h5_read(p->ctx, put_bytes(p, "b.h5", damaged, length), "test 1", &sealed, &f);
    fine = fine && (s == GH_OK || s == GH_INPUT);
    if (s != GH_OK) continue;
    s = gh_h5_get_doubles(f, "/step0003/P", 2, 3, d);
    fine = fine && (s == GH_OK || s == GH_INPUT);
    gh_h5_close(&f);
  }
  free(whole), free(damaged);
  return fine;
}

/* In a file without a checksum bytes changed at random give numbers or a message, never a crash. A process of
 * its own: HDF5 1.10 loses track of what it has open when metadata are damaged, and complains of it at the
 * end. */
static void random_damage_is_safe(void **state) {
  int status;
  srand(9);
  print_message("seed 9\n");
  fflush(stdout);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) { /* ends as another program, so that valgrind does not count what HDF5 lost */
    if (read_damaged(*state)) execlp("true", "true", (char *)NULL);
    _exit(1);
  }
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* The program's own setting of HDF5's error printing is as before. */
static void error_printing_is_left_alone(void **state) {
  place *p = *state;
  H5E_auto2_t function, now;
  void *data, *data_now;
  gh_h5 *f;
  H5Eget_auto2(H5E_DEFAULT, &function, &data);
  assert_non_null(function);
  assert_int_equal(gh_h5_read(p->ctx, "/none", "test 1", NULL, &f), GH_INPUT);
  H5Eget_auto2(H5E_DEFAULT, &now, &data_now);
  assert_true(now == function && data_now == data);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(a_round_trip_is_bitwise),         TEST(a_text_is_a_string),
      TEST(appending_keeps_what_is_there),   TEST(without_commit_nothing_changes),
      TEST(files_are_reproducible),          TEST(what_is_no_hdf5_is_refused),
      TEST(a_full_disk_leaves_the_old_file), TEST(wrong_datasets_are_refused),
      TEST(any_flipped_bit_is_seen),         TEST(other_lengths_are_seen),
      TEST(other_kinds_are_refused),         TEST(files_without_a_checksum),
      TEST(random_damage_is_safe),           TEST(error_printing_is_left_alone)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
