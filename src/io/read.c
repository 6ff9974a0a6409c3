/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Text files in: whole files, lines, words. */
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum {
  CHUNK = 1 << 16,
  MOST_MEGABYTES = 1024, /* of any text */
  PIPE_WAIT = 5          /* seconds until a pipe has a writer */
};

gh_status gh_read_status(int reason) {
  static const int named[] = {ENOENT,       ENOTDIR, EISDIR, EACCES, EPERM,    ELOOP,
                              ENAMETOOLONG, EINVAL,  ENXIO,  ENODEV, EOVERFLOW};
  if (reason == ENOMEM) return GH_MEMORY;
  for (size_t k = 0; k < sizeof named / sizeof *named; k++)
    if (reason == named[k]) return GH_INPUT;
  return GH_SYSTEM;
}

static int line_at(const char *text, size_t offset) {
  int line = 1;
  for (size_t k = 0; k < offset; k++) line += text[k] == '\n';
  return line;
}

/* ---- what is no text ---- */

/* The version in the second line of a Gmsh mesh. */
static gh_status refuse_binary_mesh(gh_context *ctx, const gh_reader *r) {
  char version[16] = "?";
  sscanf(r->text, "$MeshFormat %15s", version);
  return gh_fail(
      ctx, GH_INPUT,
      "%s:2: a binary Gmsh mesh (MSH %s), and only ASCII is read; save it with Mesh.Binary = 0, or "
      "gmsh FILE -save -format msh41 -o NEW.msh",
      r->path, version);
}

/* Kinds of files by their first bytes. GH_OK when they are none of these. */
static gh_status refuse_kind(gh_context *ctx, const gh_reader *r) {
  static const struct {
    const char *bytes;
    size_t n;
    const char *what;
  } kinds[] = {
      {"\xFF\xFE\0\0", 4, "text in UTF-32 (by its byte order mark); save it in UTF-8"},
      {"\0\0\xFE\xFF", 4, "text in UTF-32 (by its byte order mark); save it in UTF-8"},
      {"\xFF\xFE", 2, "text in UTF-16 (by its byte order mark); save it in UTF-8"},
      {"\xFE\xFF", 2, "text in UTF-16 (by its byte order mark); save it in UTF-8"},
      {"\x1F\x8B", 2, "compressed by gzip; unpack it"},
      {"BZh", 3, "compressed by bzip2; unpack it"},
      {"\xFD"
       "7zXZ",
       5, "compressed by xz; unpack it"},
      {"\x28\xB5\x2F\xFD", 4, "compressed by zstd; unpack it"},
      {"PK\3\4", 4, "a zip archive; of a spreadsheet (.xlsx, .ods), save the table as CSV"},
      {"\xD0\xCF\x11\xE0", 4, "a spreadsheet of the old Excel format; save the table as CSV"},
      {"\x89HDF", 4, "an HDF5 file, and a text is wanted"},
      {"LammpS RestartT", 15, "a binary LAMMPS restart; lmp -restart2data FILE NEW.data makes a data file"},
  };
  if (r->length >= 11 && memcmp(r->text, "$MeshFormat", 11) == 0 && memchr(r->text, 0, r->length))
    return refuse_binary_mesh(ctx, r);
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
    if (r->length >= kinds[k].n && memcmp(r->text, kinds[k].bytes, kinds[k].n) == 0)
      return gh_fail(ctx, GH_INPUT, "%s:1: %s", r->path, kinds[k].what);
  return GH_OK;
}

static gh_status refuse_zero(gh_context *ctx, const gh_reader *r, size_t offset) {
  const char *t = r->text;
  GH_TRY(refuse_kind(ctx, r));
  if (r->length >= 4 && (t[0] == 0) != (t[1] == 0) && (t[0] == 0) == (t[2] == 0) &&
      (t[1] == 0) == (t[3] == 0))
    return gh_fail(ctx, GH_INPUT,
                   "%s:1: text in UTF-16, by the zero byte in every character; save it in UTF-8", r->path);
  return gh_fail(ctx, GH_INPUT, "%s:%d: not a text file: it holds a zero byte", r->path, line_at(t, offset));
}

/* ---- files as a whole ---- */

/* A read that finds a pipe without a writer tries again for some seconds; one that finds a writer waits for
 * what that writes. The descriptor does not block at first. */
static ssize_t read_piece(int fd, bool pipe, char *to, double begin, bool *abandoned) {
  const struct timespec moment = {.tv_nsec = 10000000};
  for (;;) {
    ssize_t n = read(fd, to, CHUNK);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) {
      if (fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) & ~O_NONBLOCK) != 0) return -1;
      continue;
    }
    if (n != 0 || !pipe) return n;
    *abandoned = gh_seconds() - begin > PIPE_WAIT;
    if (*abandoned) return 0;
    nanosleep(&moment, NULL);
  }
}

/* Reads what fd gives, and looks at each piece at once: a device full of zeros ends at the first one. */
static gh_status reader_fill(gh_context *ctx, int fd, const struct stat *info, size_t most, gh_reader *r) {
  size_t capacity = 0;
  const double begin = gh_seconds();
  bool regular = S_ISREG(info->st_mode), abandoned = false;
  if (regular && (unsigned long long)info->st_size <= most) /* no growth: the whole of it at once */
    GH_TRY(gh_grow(ctx, (size_t)info->st_size + CHUNK + 1, 1, &capacity, &r->text));
  while (!regular || (unsigned long long)info->st_size <= most) {
    GH_TRY(gh_grow(ctx, r->length + CHUNK + 1, 1, &capacity, &r->text));
    bool empty_pipe = S_ISFIFO(info->st_mode) && r->length == 0 && fd != STDIN_FILENO;
    ssize_t n = read_piece(fd, empty_pipe, r->text + r->length, begin, &abandoned);
    if (n < 0) return gh_fail(ctx, gh_read_status(errno), "%s: cannot be read: %s", r->path, strerror(errno));
    if (abandoned)
      return gh_fail(ctx, GH_INPUT, "%s: a pipe that nothing is written into (waited %d s)", r->path,
                     PIPE_WAIT);
    if (n == 0) break;
    const char *zero = memchr(r->text + r->length, 0, (size_t)n);
    size_t before = r->length;
    r->length += (size_t)n;
    if (zero) return refuse_zero(ctx, r, before + (size_t)(zero - (r->text + before)));
    if (r->length > most) break;
  }
  if (r->length > most || (regular && (unsigned long long)info->st_size > most))
    return gh_fail(ctx, GH_INPUT, "%s: larger than %zu MiB, the most that is read of such a file", r->path,
                   most >> 20);
  r->text[r->length] = 0;
  r->empty = r->length == 0;
  if (r->empty) return gh_fail(ctx, GH_INPUT, "%s: the file is empty", r->path);
  return refuse_kind(ctx, r);
}

/* Lines that end with CR alone, as some spreadsheets still write them. */
static void end_lines(gh_reader *r) {
  if (memchr(r->text, '\n', r->length)) return;
  for (char *c = r->text; (c = strchr(c, '\r'));) *c = '\n';
}

gh_status gh_reader_open_most(gh_context *ctx, const char *path, int megabytes, gh_reader *r) {
  bool standard = strcmp(path, "-") == 0;
  *r = (gh_reader){.path = standard ? "standard input" : path};
  int fd = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return gh_fail(ctx, gh_read_status(errno), "%s: cannot be opened: %s", path, strerror(errno));
  struct stat info;
  gh_status s;
  if (fstat(fd, &info) != 0)
    s = gh_fail(ctx, gh_read_status(errno), "%s: cannot be opened: %s", r->path, strerror(errno));
  else if (S_ISDIR(info.st_mode)) s = gh_fail(ctx, GH_INPUT, "%s: is a folder, a file is wanted", r->path);
  else s = reader_fill(ctx, fd, &info, (size_t)megabytes << 20, r);
  if (!standard) close(fd);
  if (s != GH_OK) {
    gh_reader_close(r);
    return s;
  }
  end_lines(r);
  r->next = r->length >= 3 && memcmp(r->text, "\xEF\xBB\xBF", 3) == 0 ? r->text + 3 : r->text;
  return GH_OK;
}

gh_status gh_reader_open(gh_context *ctx, const char *path, gh_reader *r) {
  return gh_reader_open_most(ctx, path, MOST_MEGABYTES, r);
}

void gh_reader_close(gh_reader *r) {
  free(r->text);
  r->text = r->next = NULL;
}

gh_status gh_file_text(gh_context *ctx, const char *path, char **text) {
  gh_reader r;
  *text = NULL;
  GH_TRY(gh_reader_open(ctx, path, &r));
  *text = r.text;
  return GH_OK;
}

char *gh_reader_line(gh_reader *r) {
  if (*r->next == 0) return NULL;
  char *line = r->next, *end = strchr(line, '\n');
  r->next = end ? end + 1 : line + strlen(line);
  if (!end) end = r->next;
  if (end > line && end[-1] == '\r') end--;
  *end = 0;
  r->line++;
  return line;
}

static bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

int gh_words(char *text, int max, char **word) {
  int n = 0;
  for (;;) {
    while (is_space(*text)) text++;
    if (!*text) return n;
    if (n < max) word[n] = text;
    if (n < INT_MAX) n++;
    while (*text && !is_space(*text)) text++;
    if (*text) *text++ = 0;
  }
}

char *gh_trim(char *text) {
  while (is_space(*text)) text++;
  size_t n = strlen(text);
  while (n > 0 && is_space(text[n - 1])) n--;
  text[n] = 0;
  return text;
}

const char *gh_quote(const char *text, char out[GH_QUOTE]) {
  size_t n = strlen(text), keep = n < GH_QUOTE ? n : GH_QUOTE - 4;
  if (keep < n) /* not within a character of UTF-8 */
    while (keep > 0 && ((unsigned char)text[keep] & 0xC0) == 0x80) keep--;
  for (size_t k = 0; k < keep; k++) out[k] = (unsigned char)text[k] < ' ' || text[k] == 0x7F ? '?' : text[k];
  memcpy(out + keep, keep < n ? "..." : "", keep < n ? 4 : 1);
  return out;
}
