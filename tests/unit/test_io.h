/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the tests of file formats share: a folder of their own, a context. */
#ifndef GRANHOM_TEST_IO_H
#define GRANHOM_TEST_IO_H

#include "granhom/io.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <dirent.h>
#include <ftw.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* Each test has a context and an empty folder; the working directory stays the root of the repository. */
typedef struct {
  gh_context *ctx;
  char folder[64];
  char path[4][128];
  int paths;
} place;

static inline int begin(void **state) {
  place *p = calloc(1, sizeof *p);
  if (!p || gh_context_create(&p->ctx) != GH_OK) return -1;
  strcpy(p->folder, "/tmp/granhom-test-XXXXXX");
  *state = p;
  return mkdtemp(p->folder) ? 0 : -1;
}

static inline int remove_entry(const char *path, const struct stat *info, int type, struct FTW *ftw) {
  (void)info, (void)type, (void)ftw;
  return remove(path);
}

static inline int end(void **state) {
  place *p = *state;
  int failed = nftw(p->folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
  gh_context_destroy(&p->ctx);
  free(p);
  return failed;
}

/* A path in the test's folder; four are kept. */
static inline const char *in_folder(place *p, const char *name) {
  char *path = p->path[p->paths++ % 4];
  snprintf(path, sizeof p->path[0], "%s/%s", p->folder, name);
  return path;
}

static inline const char *put_bytes(place *p, const char *name, const void *bytes, size_t length) {
  const char *path = in_folder(p, name);
  unlink(path); /* file systems flush a file that is cut to nothing and written again, milliseconds each */
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, length, file), length);
  assert_int_equal(fclose(file), 0);
  return path;
}

static inline const char *put_file(place *p, const char *name, const char *text) {
  return put_bytes(p, name, text, strlen(text));
}

/* The bytes of a file and a final 0; caller frees. */
static inline char *get_file(const char *path, size_t *length) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  assert_int_equal(fseek(file, 0, SEEK_END), 0);
  *length = (size_t)ftell(file);
  rewind(file);
  char *text = calloc(*length + 1, 1);
  assert_non_null(text);
  assert_int_equal(fread(text, 1, *length, file), *length);
  fclose(file);
  return text;
}

static inline int count_entries(const char *folder) {
  int n = 0;
  DIR *dir = opendir(folder);
  assert_non_null(dir);
  for (struct dirent *e; (e = readdir(dir));) n += e->d_name[0] != '.';
  closedir(dir);
  return n;
}

/* The message is path + rest, to the last letter. */
static inline void assert_message(const place *p, const char *path, const char *rest) {
  char wanted[1024];
  snprintf(wanted, sizeof wanted, "%s%s", path, rest);
  assert_string_equal(gh_message(p->ctx), wanted);
}

/* Files of this process may have at most so many bytes; RLIM_INFINITY lifts the limit again. Writing more
 * fails with EFBIG. */
static inline void limit_files(rlim_t bytes) {
  struct rlimit limit;
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
  limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

#define TEST(f) cmocka_unit_test_setup_teardown(f, begin, end)

#endif
