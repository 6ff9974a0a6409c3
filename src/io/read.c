/* Text files in: whole files, lines, words. SPDX-License-Identifier: GPL-2.0-or-later */
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHUNK = 1 << 16 };

static int line_at(const char *text, size_t offset) {
  int line = 1;
  for (size_t k = 0; k < offset; k++) line += text[k] == '\n';
  return line;
}

/* Reads what fd gives, and looks at each piece at once: a device full of zeros ends at the first one. */
static gh_status fill(gh_context *ctx, int fd, gh_reader *r) {
  size_t capacity = 0;
  for (;;) {
    GH_TRY(gh_grow(ctx, r->length + CHUNK + 1, 1, &capacity, &r->text));
    ssize_t n = read(fd, r->text + r->length, CHUNK);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return gh_fail(ctx, GH_INPUT, "%s: cannot be read: %s", r->path, strerror(errno));
    if (n == 0) break;
    const char *zero = memchr(r->text + r->length, 0, (size_t)n);
    if (zero) {
      return gh_fail(ctx, GH_INPUT, "%s:%d: not a text file: it holds a zero byte", r->path,
                     line_at(r->text, (size_t)(zero - r->text)));
    }
    r->length += (size_t)n;
    if (r->length > INT_MAX - 2 * CHUNK) return gh_fail(ctx, GH_INPUT, "%s: larger than 2 GiB", r->path);
  }
  r->text[r->length] = 0;
  if (r->length == 0) return gh_fail(ctx, GH_INPUT, "%s: the file is empty", r->path);
  return GH_OK;
}

gh_status gh_reader_open(gh_context *ctx, const char *path, gh_reader *r) {
  bool standard = strcmp(path, "-") == 0;
  *r = (gh_reader){.path = standard ? "standard input" : path};
  int fd = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
  if (fd < 0) return gh_fail(ctx, GH_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
  struct stat info;
  gh_status s = fstat(fd, &info) == 0 && S_ISDIR(info.st_mode)
                    ? gh_fail(ctx, GH_INPUT, "%s: is a folder, a file is wanted", r->path)
                    : fill(ctx, fd, r);
  if (!standard) close(fd);
  if (s != GH_OK) {
    gh_reader_close(r);
    return s;
  }
  r->next = r->length >= 3 && memcmp(r->text, "\xEF\xBB\xBF", 3) == 0 ? r->text + 3 : r->text;
  return GH_OK;
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
