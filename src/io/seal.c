/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Checksums of binary files.
 *
 * A file of ours starts with 512 bytes of text, its seal: kind, length, and a sum over all bytes of
 * the file, in which the digits of the sum count as zeros. To HDF5 that is a user block, so that other
 * programs read the file as any other. The sum is XXH64 (public algorithm): it changes with every change
 * within one word of eight bytes, and takes a small part of the time that writing takes. */
#include "io/seal.h"

#include "io/file.h"

#define XXH_INLINE_ALL /* the header alone: no library to link */
#include <xxhash.h>

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- seals ---- */

#define FIRST "granhom binary file, format "
#define FORMAT "1"

enum { KIND = 40, CHUNK = 1 << 20 };

static const unsigned char hdf5_signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};

typedef struct seal {
  char kind[KIND];
  uint64_t length, sum;
} seal;

/* The whole of the 512 bytes follows from the seal. */
static void seal_print(const seal *s, char text[GH_SEAL]) {
  memset(text, 0, GH_SEAL);
  snprintf(text, GH_SEAL,
           FIRST FORMAT
           "\nkind %s\nbytes %" PRIu64 "\nxxh64 %016" PRIx64
           "\nThese 512 bytes are an HDF5 user block. The sum is XXH64 over all bytes of the file, "
           "the digits of the sum as zeros.\n",
           s->kind, s->length, s->sum);
}

/* false: the 512 bytes are no seal to the last of them. */
static bool seal_parse(const char text[GH_SEAL], seal *s) {
  char copy[GH_SEAL + 1] = "", again[GH_SEAL];
  memcpy(copy, text, GH_SEAL);
  *s = (seal){0};
  if (sscanf(copy, FIRST FORMAT "\nkind %39[^\n]\nbytes %" SCNu64 "\nxxh64 %" SCNx64, s->kind, &s->length,
             &s->sum) != 3)
    return false;
  seal_print(s, again);
  return memcmp(text, again, GH_SEAL) == 0;
}

/* Starts the sum with the seal itself. */
static void seal_begin(const seal *s, XXH64_state_t *sum) {
  char text[GH_SEAL];
  seal blank = *s;
  blank.sum = 0;
  seal_print(&blank, text);
  XXH64_reset(sum, 0);
  XXH64_update(sum, text, GH_SEAL);
}

void gh_seal_make(const char *kind, void *bytes, size_t length) {
  seal s = {.length = length};
  XXH64_state_t sum;
  snprintf(s.kind, sizeof s.kind, "%s", kind);
  seal_begin(&s, &sum);
  XXH64_update(&sum, (char *)bytes + GH_SEAL, length - GH_SEAL);
  s.sum = XXH64_digest(&sum);
  char text[GH_SEAL];
  seal_print(&s, text);
  memcpy(bytes, text, GH_SEAL);
}

/* ---- files ---- */

/* Reads until size bytes are there or the file ends. Their number, -1 and errno. */
static ssize_t fill(int fd, char *bytes, size_t size) {
  size_t done = 0;
  while (done < size) {
    ssize_t n = read(fd, bytes + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return -1;
    if (n == 0) break;
    done += (size_t)n;
  }
  return (ssize_t)done;
}

/* Sums up what is behind the seal; *length: of the whole file. */
static gh_status sum_file(gh_context *ctx, const char *path, int fd, XXH64_state_t *sum, uint64_t *length) {
  char *chunk;
  ssize_t n;
  GH_TRY(gh_alloc(ctx, CHUNK, 1, &chunk));
  *length = GH_SEAL;
  do {
    n = fill(fd, chunk, CHUNK);
    if (n > 0) XXH64_update(sum, chunk, (size_t)n);
    if (n > 0) *length += (uint64_t)n;
  } while (n == CHUNK);
  gh_status s = n < 0 ? gh_fail(ctx, GH_SYSTEM, "%s: cannot be read: %s", path, strerror(errno)) : GH_OK;
  free(chunk);
  return s;
}

/* What starts with something else. */
static gh_status unsealed(gh_context *ctx, const char *path, const char *text, size_t length, bool *sealed) {
  if (length < sizeof hdf5_signature || memcmp(text, hdf5_signature, sizeof hdf5_signature) != 0)
    return gh_fail(ctx, GH_INPUT,
                   "%s: is damaged, or no binary file of granhom: it does not start with \"%s%s\"", path,
                   FIRST, FORMAT);
  if (sealed) {
    *sealed = false;
    return GH_OK;
  }
  return gh_fail(ctx, GH_INPUT,
                 "%s: has no checksum: it was written by an older version of granhom, or by another program, "
                 "and is not used, since damage would not be seen",
                 path);
}

static gh_status compare(gh_context *ctx, const char *path, const char *kind, const seal *s, uint64_t length,
                         uint64_t sum) {
  if (length != s->length)
    return gh_fail(ctx, GH_INPUT, "%s: is damaged: it has %" PRIu64 " bytes instead of %" PRIu64, path,
                   length, s->length);
  if (sum != s->sum)
    return gh_fail(ctx, GH_INPUT,
                   "%s: is damaged: its checksum is %016" PRIx64 ", and its content gives %016" PRIx64, path,
                   s->sum, sum);
  if (strcmp(s->kind, kind) == 0) return GH_OK;
  return gh_fail(ctx, GH_INPUT,
                 "%s: holds a %s of granhom, wanted is a %s (the number is the version of the format)", path,
                 s->kind, kind);
}

static gh_status check(gh_context *ctx, const char *path, const char *kind, int fd, bool *sealed) {
  char text[GH_SEAL];
  seal s;
  XXH64_state_t sum;
  uint64_t length;
  ssize_t n = fill(fd, text, sizeof text);
  if (n < 0) return gh_fail(ctx, GH_SYSTEM, "%s: cannot be read: %s", path, strerror(errno));
  if (n == 0) return gh_fail(ctx, GH_INPUT, "%s: the file is empty", path);
  if ((size_t)n < strlen(FIRST FORMAT) || memcmp(text, FIRST FORMAT, strlen(FIRST FORMAT)) != 0)
    return unsealed(ctx, path, text, (size_t)n, sealed);
  if (n < GH_SEAL || !seal_parse(text, &s))
    return gh_fail(ctx, GH_INPUT, "%s: is damaged: its first %d bytes are no header of granhom", path,
                   GH_SEAL);
  seal_begin(&s, &sum);
  GH_TRY(sum_file(ctx, path, fd, &sum, &length));
  if (sealed) *sealed = true;
  return compare(ctx, path, kind, &s, length, XXH64_digest(&sum));
}

/* What is wrong with the name, and what with the system. */
static gh_status status_of(int reason) {
  switch (reason) {
  case ENOENT:
  case ENOTDIR:
  case EACCES:
  case EPERM:
  case ELOOP:
  case ENAMETOOLONG:
    return GH_INPUT;
  default:
    return GH_SYSTEM;
  }
}

gh_status gh_seal_check(gh_context *ctx, const char *path, const char *kind, bool *sealed) {
  struct stat info;
  int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe does not wait for its other end */
  if (fd < 0) return gh_fail(ctx, status_of(errno), "%s: cannot be opened: %s", path, strerror(errno));
  gh_status s = fstat(fd, &info) == 0 ? GH_OK : gh_fail(ctx, GH_SYSTEM, "%s: %s", path, strerror(errno));
  if (s == GH_OK && S_ISDIR(info.st_mode))
    s = gh_fail(ctx, GH_INPUT, "%s: is a folder, a file is wanted", path);
  else if (s == GH_OK && !S_ISREG(info.st_mode))
    s = gh_fail(ctx, GH_INPUT, "%s: is a device or a pipe, a file is wanted", path);
  if (s == GH_OK) s = check(ctx, path, kind, fd, sealed);
  close(fd);
  return s;
}
