/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of what every text file goes through: encodings, kinds, pipes, sizes. */
#include "io/file.h"
#include "test_io.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <time.h>

static void assert_bytes_refused(place *p, const void *bytes, size_t n, const char *message) {
  gh_reader r;
  const char *path = put_bytes(p, "a.txt", bytes, n);
  assert_int_equal(gh_reader_open(p->ctx, path, &r), GH_INPUT);
  assert_message(p, path, message);
}

/* Encodings and other kinds of files are named. */
static void kinds_are_named(void **state) {
  place *p = *state;
  assert_bytes_refused(p,
                       "\xFF\xFE"
                       "a\0\n\0",
                       6, ":1: text in UTF-16 (by its byte order mark); save it in UTF-8");
  assert_bytes_refused(p, "\xFE\xFF\0a\0\n", 6,
                       ":1: text in UTF-16 (by its byte order mark); save it in UTF-8");
  assert_bytes_refused(p, "\xFF\xFE\0\0a\0\0\0", 8,
                       ":1: text in UTF-32 (by its byte order mark); save it in UTF-8");
  assert_bytes_refused(p, "\xFF\xFE\x61\x62", 4,
                       ":1: text in UTF-16 (by its byte order mark); save it in UTF-8");
  assert_bytes_refused(p, "a\0b\0\n\0", 6,
                       ":1: text in UTF-16, by the zero byte in every character; save it in UTF-8");
  assert_bytes_refused(p, "\0a\0b\0\n", 6,
                       ":1: text in UTF-16, by the zero byte in every character; save it in UTF-8");
  assert_bytes_refused(p, "\x1F\x8B\x08\0\0", 5, ":1: compressed by gzip; unpack it");
  assert_bytes_refused(p, "PK\3\4\x14\0", 6,
                       ":1: a zip archive; of a spreadsheet (.xlsx, .ods), save the table as CSV");
  assert_bytes_refused(p, "\x89HDF\r\n\x1a\n\0", 9, ":1: an HDF5 file, and a text is wanted");
  assert_bytes_refused(p, "LammpS RestartT\0\1", 17,
                       ":1: a binary LAMMPS restart; lmp -restart2data FILE NEW.data makes a data file");
  assert_bytes_refused(p, "a\nb\0c\n", 6, ":2: not a text file: it holds a zero byte");
}

/* CR LF, LF and CR alone end lines; CR among LF stays what it is. */
static void lines_end_in_three_ways(void **state) {
  static const char *const texts[] = {"one\ntwo\n", "one\r\ntwo\r\n", "one\rtwo\r", "\xEF\xBB\xBFone\rtwo"};
  place *p = *state;
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    gh_reader r;
    assert_int_equal(gh_reader_open(p->ctx, put_file(p, "a.txt", texts[k]), &r), GH_OK);
    assert_string_equal(gh_reader_line(&r), "one");
    assert_string_equal(gh_reader_line(&r), "two");
    assert_int_equal(r.line, 2);
    assert_null(gh_reader_line(&r));
    gh_reader_close(&r);
  }
}

/* Files above the limit are refused, a sparse one of 64 GiB at once; what comes through a pipe as well. */
static void sizes_have_a_limit(void **state) {
  enum { N = (2 << 20) + 1 };
  place *p = *state;
  gh_reader r;
  char *text = malloc(N);
  memset(text, 'x', N);
  const char *path = put_bytes(p, "a.txt", text, N);
  free(text);
  assert_int_equal(gh_reader_open_most(p->ctx, path, 3, &r), GH_OK);
  assert_int_equal(r.length, N);
  gh_reader_close(&r);
  assert_int_equal(gh_reader_open_most(p->ctx, path, 2, &r), GH_INPUT);
  assert_message(p, path, ": larger than 2 MiB, the most that is read of such a file");
  if (truncate(path, (off_t)64 << 30) == 0) {
    assert_int_equal(gh_reader_open(p->ctx, path, &r), GH_INPUT);
    assert_message(p, path, ": larger than 1024 MiB, the most that is read of such a file");
  }
}

static void pause_for(int milliseconds) {
  nanosleep(&(struct timespec){.tv_nsec = milliseconds * 1000000L}, NULL);
}

/* Starts a process that writes `text` n times into a pipe, after a while. */
static pid_t start_writer(const char *pipe, int milliseconds, const char *text, int n) {
  pid_t child = fork();
  assert_true(child >= 0);
  if (child) return child;
  pause_for(milliseconds);
  signal(SIGPIPE, SIG_IGN);
  int fd = open(pipe, O_WRONLY);
  pause_for(milliseconds);
  for (int k = 0; k < n; k++)
    if (write(fd, text, strlen(text)) < 0) break;
  _exit(0);
}

/* A pipe is read when its writer comes late and writes late; a writer without end is stopped at the limit; a
 * pipe without a writer is no reason to wait for ever. */
static void pipes_are_read(void **state) {
  place *p = *state;
  gh_reader r;
  const char *path = in_folder(p, "pipe");
  assert_int_equal(mkfifo(path, 0600), 0);
  pid_t child = start_writer(path, 200, "hello\n", 3);
  assert_int_equal(gh_reader_open(p->ctx, path, &r), GH_OK);
  assert_int_equal(r.length, 18);
  gh_reader_close(&r);
  waitpid(child, NULL, 0);
  child = start_writer(path, 0, "0123456789\n", 1000000);
  assert_int_equal(gh_reader_open_most(p->ctx, path, 1, &r), GH_INPUT);
  assert_message(p, path, ": larger than 1 MiB, the most that is read of such a file");
  waitpid(child, NULL, 0);
  assert_int_equal(gh_reader_open(p->ctx, path, &r), GH_INPUT);
  assert_message(p, path, ": a pipe that nothing is written into (waited 5 s)");
}

/* What is wrong with a word that was meant as a number. */
static void hints(void **state) {
  (void)state;
  assert_non_null(strstr(gh_number_hint("0,25"), "comma"));
  assert_non_null(strstr(gh_number_hint("1,234.5"), "comma"));
  assert_non_null(strstr(gh_number_hint("\xE2\x88\x92"
                                        "1.5"),
                         "U+2212"));
  assert_non_null(strstr(gh_number_hint("1.5D+00"), "Fortran"));
  assert_string_equal(gh_number_hint("damp"), "");
  assert_string_equal(gh_number_hint("nan"), "");
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(kinds_are_named), TEST(lines_end_in_three_ways),
                                     TEST(sizes_have_a_limit), TEST(pipes_are_read), TEST(hints)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
