/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the fuzz targets share. */
#include "fuzz.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void fuzz_require(bool good, const char *what) {
  if (good) return;
  fprintf(stderr, "fuzz: %s\n", what);
  abort();
}

gh_context *fuzz_begin(void) {
  gh_context *ctx;
  fuzz_require(gh_context_create(&ctx) == GH_OK, "no context");
  return ctx;
}

void fuzz_end(gh_context *ctx) {
  gh_context_destroy(&ctx);
}

bool fuzz_good(const gh_context *ctx, gh_status status) {
  if (status == GH_OK) return true;
  const char *message = gh_message(ctx);
  if (status != GH_INPUT) fprintf(stderr, "fuzz: status '%s': %s\n", gh_status_text(status), message);
  fuzz_require(status == GH_INPUT, "a wrong input has another status than GH_INPUT");
  fuzz_require(*message, "a refusal without a message");
  for (const char *c = message; *c; c++)
    if ((unsigned char)*c < ' ' || *c == 0x7F) {
      fprintf(stderr, "fuzz: message: %s\n", message);
      fuzz_require(false, "a message with a control character");
    }
  return false;
}

char *fuzz_text(const uint8_t *data, size_t size) {
  char *text = malloc(size + 1);
  fuzz_require(text != NULL, "no memory");
  if (size) memcpy(text, data, size);
  text[size] = 0;
  return text;
}

/* ---- files ---- */

static void file_write(const char *path, const void *data, size_t size) {
  int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  fuzz_require(fd >= 0 && write(fd, data, size) == (ssize_t)size, "the input cannot be written");
  close(fd);
}

/* Into a folder of FUZZ_DATA. */
static void folder_enter(const char *folder) {
  const char *data = getenv("FUZZ_DATA");
  char *path = gh_path_join(data ? data : ".", folder);
  fuzz_require(path && chdir(path) == 0, "FUZZ_DATA is not the folder that tests/fuzz/run.py prepares");
  free(path);
}

/* What this process leaves behind: one file, or one folder. */
static char left[128];
static void left_remove(void) {
  unlink(left);
}

const char *fuzz_file(const char *folder, const char *ending, const void *data, size_t size) {
  if (!*left) {
    folder_enter(folder);
    snprintf(left, sizeof left, "input-%ld.%s", (long)getpid(), ending);
    atexit(left_remove);
  }
  file_write(left, data, size);
  return left;
}

static void file_copy(const char *from, const char *to) {
  gh_context *ctx = fuzz_begin();
  int in = open(from, O_RDONLY | O_CLOEXEC);
  struct stat info;
  fuzz_require(in >= 0 && fstat(in, &info) == 0, "a file to copy cannot be opened");
  char *bytes = malloc((size_t)info.st_size + 1);
  fuzz_require(bytes && read(in, bytes, (size_t)info.st_size) == info.st_size, "a file cannot be copied");
  file_write(to, bytes, (size_t)info.st_size);
  free(bytes);
  close(in);
  fuzz_end(ctx);
}

/* The plain files of a folder: copied to `to`, or removed where that is NULL. */
static void files_walk(const char *from, const char *to) {
  DIR *dir = opendir(from);
  fuzz_require(dir != NULL, "a folder of FUZZ_DATA is missing");
  for (struct dirent *e; (e = readdir(dir));) {
    char a[600], b[600];
    struct stat info;
    snprintf(a, sizeof a, "%s/%s", from, e->d_name);
    if (lstat(a, &info) != 0 || S_ISDIR(info.st_mode)) continue;
    snprintf(b, sizeof b, "%s/%s", to ? to : "", e->d_name);
    if (to) file_copy(a, b);
    else unlink(a);
  }
  closedir(dir);
}

static char copied[64];
static void copied_remove(void) {
  files_walk(copied, NULL);
  rmdir(copied);
}

const char *fuzz_folder(const char *folder) {
  if (!*copied) {
    folder_enter(".");
    snprintf(copied, sizeof copied, "folder-%ld", (long)getpid());
    mkdir(copied, 0777);
    atexit(copied_remove);
  }
  files_walk(copied, NULL);
  files_walk(folder, copied);
  return copied;
}

/* ---- HDF5 ---- */

typedef struct bytes {
  const uint8_t *data;
  size_t size;
} bytes;

static unsigned bytes_next(bytes *b) {
  if (b->size == 0) return 0;
  b->size--;
  return *b->data++;
}

/* A number that readers may stumble over, or a plain one. */
static double bytes_number(bytes *b) {
  static const double odd[] = {0,    -1,   1,   2,    1e308, -1e308,   1e-308,    4e9,
                               -4e9, 1e19, 0.5, 1e15, NAN,   INFINITY, -INFINITY, 3};
  unsigned k = bytes_next(b);
  return k < 128 ? odd[k % (sizeof odd / sizeof *odd)] : (double)k - 160;
}

enum { MOST_VALUES = 4096 };

static void dataset_put(gh_h5 *file, const char *name, unsigned kind, size_t rows, size_t cols, bytes *b) {
  static double value[MOST_VALUES];
  static int integer[MOST_VALUES];
  while (rows * cols > MOST_VALUES) rows /= 2;
  for (size_t k = 0; k < rows * cols; k++) {
    value[k] = bytes_number(b);
    integer[k] = value[k] > -2e9 && value[k] < 2e9 ? (int)value[k] : (int)(k * 2654435761u);
  }
  if (kind == 0) gh_h5_put_doubles(file, name, rows, cols, value);
  else gh_h5_put_ints(file, name, rows, cols, integer);
}

/* One value of a dataset of numbers is another one. */
static void dataset_change(gh_context *ctx, gh_h5 *file, const char *name, bytes *b) {
  size_t rows, cols, at = bytes_next(b) + 256u * bytes_next(b);
  double *value, number = bytes_number(b);
  if (gh_h5_size(file, name, &rows, &cols) != GH_OK || rows * cols == 0) return;
  if (gh_alloc(ctx, rows * cols, sizeof *value, &value) != GH_OK) return;
  int *integer = (int *)value;
  if (gh_h5_get_doubles(file, name, rows, cols, value) == GH_OK) {
    value[at % (rows * cols)] = number;
    gh_h5_put_doubles(file, name, rows, cols, value);
  } else if (gh_h5_get_ints(file, name, rows, cols, integer) == GH_OK) {
    integer[at % (rows * cols)] = fabs(number) < 2e9 ? (int)number : -2147483647 - 1;
    gh_h5_put_ints(file, name, rows, cols, integer);
  }
  free(value);
}

static void dataset_text(gh_h5 *file, const char *name, bytes *b) {
  char text[64];
  unsigned length = bytes_next(b) % 63;
  for (unsigned k = 0; k < length; k++) text[k] = (char)bytes_next(b);
  text[length] = 0;
  gh_h5_put_text(file, name, text);
}

void fuzz_kind(const char *path, char kind[40]) {
  FILE *file = fopen(path, "r");
  bool good = file && fscanf(file, "%*[^\n]\nkind %39[^\n]", kind) == 1;
  if (file) fclose(file);
  fuzz_require(good, "a binary file without a seal");
}

void fuzz_change_h5(gh_context *ctx, const char *path, const char *const *names, const uint8_t *data,
                    size_t size) {
  bytes b = {data, size};
  gh_h5 *file;
  unsigned count = 0;
  bool there;
  char kind[40];
  fuzz_kind(path, kind);
  while (names[count]) count++;
  fuzz_require(gh_h5_open(ctx, path, kind, true, &file) == GH_OK, gh_message(ctx));
  for (int turn = 0; b.size && turn < 8; turn++) {
    unsigned what = bytes_next(&b), rows = bytes_next(&b), cols = bytes_next(&b);
    const char *name = names[bytes_next(&b) % count];
    switch (what % 8) {
    case 0:
      gh_h5_remove(file, name, &there);
      break;
    case 1:
      dataset_put(file, name, 0, rows, cols % 32, &b);
      break;
    case 2:
      dataset_put(file, name, 1, rows, cols % 32, &b);
      break;
    case 3:
      dataset_text(file, name, &b);
      break;
    default:
      dataset_change(ctx, file, name, &b);
    }
  }
  fuzz_require(gh_h5_commit(&file) == GH_OK, "the changed file cannot be written");
}
