/* SPDX-License-Identifier: GPL-2.0-or-later */
/* gnuplot as a child process. No shell stands between, no name of a file and no text of a user's goes into
 * its program: it reads the script from standard input and writes the picture to standard output, both of
 * them temporary files without a name. */
#define _GNU_SOURCE 1 /* environ */
#include "report/gnuplot.h"

#include "io/file.h"

#include <errno.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- texts ---- */

/* In a string of gnuplot with double quotes, octal escapes alone: nothing can end it, and neither commands in
 * back quotes nor macros are looked for in digits. */
void gh_picture_string(gh_text *out, const char *text) {
  gh_text_print(out, "\"");
  for (const unsigned char *c = (const unsigned char *)text; *c; c++)
    gh_text_print(out, "\\%03o", *c < ' ' || *c == 0x7F ? '?' : *c);
  gh_text_print(out, "\"");
}

/* Nothing of ours has a shell command in it: a script that has one holds what does not belong there. gnuplot
 * itself has no switch that turns them off. */
static gh_status script_check(gh_context *ctx, const char *script, const char *png) {
  bool bad = strpbrk(script, "!`@") || strstr(script, "system");
  for (const char *c = script; *c; c++) bad = bad || ((unsigned char)*c < ' ' && *c != '\n');
  return bad ? gh_fail(ctx, GH_SYSTEM, "%s: the script for gnuplot holds a command of the shell", png)
             : GH_OK;
}

/* ---- the child ---- */

typedef struct child {
  FILE *stream[3]; /* its standard input, output and error */
  char **env;
  pid_t pid;
} child;

/* Variables with which gnuplot loads or starts other programs, or looks different. The caller frees. */
static gh_status child_environment(gh_context *ctx, char ***env) {
  size_t n = 0, kept = 0;
  while (environ[n]) n++;
  GH_TRY(gh_alloc(ctx, n + 1, sizeof **env, env));
  for (size_t k = 0; k < n; k++)
    if (strncmp(environ[k], "GNU", 3) != 0 && strncmp(environ[k], "FIT_", 4) != 0)
      (*env)[kept++] = environ[k];
  return GH_OK;
}

static gh_status child_open(gh_context *ctx, const char *script, const char *png, child *c) {
  GH_TRY(child_environment(ctx, &c->env));
  for (int k = 0; k < 3; k++)
    if (!(c->stream[k] = tmpfile()))
      return gh_fail(ctx, GH_SYSTEM, "%s: no temporary file for gnuplot: %s", png, strerror(errno));
  if (fputs(script, c->stream[0]) >= 0 && fflush(c->stream[0]) == 0 && fseek(c->stream[0], 0, SEEK_SET) == 0)
    return GH_OK;
  return gh_fail(ctx, GH_SYSTEM, "%s: a temporary file for gnuplot cannot be written: %s", png,
                 strerror(errno));
}

static void child_close(child *c) {
  for (int k = 0; k < 3; k++)
    if (c->stream[k]) fclose(c->stream[k]);
  free(c->env);
}

/* -d: neither the user's nor the machine's configuration of gnuplot; -: the script is standard input, and its
 * first error ends it. Returns an errno. */
static int child_start(child *c) {
  char program[] = "gnuplot", defaults[] = "-d", script[] = "-", *argv[] = {program, defaults, script, NULL};
  posix_spawn_file_actions_t actions;
  int reason = posix_spawn_file_actions_init(&actions);
  if (reason) return reason;
  for (int k = 0; k < 3 && !reason; k++)
    reason = posix_spawn_file_actions_adddup2(&actions, fileno(c->stream[k]), k);
  if (!reason) reason = posix_spawnp(&c->pid, program, &actions, NULL, argv, c->env);
  posix_spawn_file_actions_destroy(&actions);
  return reason;
}

/* What it has written, as a text of *length bytes and a final 0. */
static gh_status child_read(gh_context *ctx, FILE *stream, const char *png, char **bytes, size_t *length) {
  long end = fseek(stream, 0, SEEK_END) == 0 ? ftell(stream) : -1;
  *length = end > 0 ? (size_t)end : 0;
  GH_TRY(gh_alloc(ctx, *length + 1, 1, bytes));
  if (end >= 0 && fseek(stream, 0, SEEK_SET) == 0 && fread(*bytes, 1, *length, stream) == *length)
    return GH_OK;
  return gh_fail(ctx, GH_SYSTEM, "%s: what gnuplot has drawn cannot be read: %s", png, strerror(errno));
}

/* ---- results ---- */

/* With the last line that gnuplot has written to standard error. */
static gh_status failed(gh_context *ctx, child *c, const char *png, int status) {
  char *text = NULL, quoted[GH_QUOTE], *line;
  size_t length;
  gh_status read = child_read(ctx, c->stream[2], png, &text, &length);
  if (read == GH_OK) {
    gh_trim(text);
    line = strrchr(text, '\n');
    line = gh_trim(line ? line + 1 : text);
    read = gh_fail(ctx, GH_ENGINE, "%s: gnuplot failed (status %d)%s%s", png, status, *line ? ": " : "",
                   gh_quote(line, quoted));
  }
  free(text);
  return read;
}

/* A PNG from its first to its last byte. */
static bool is_whole(const char *bytes, size_t length) {
  static const char first[] = "\x89PNG\r\n\x1a\n", last[] = "IEND\xae\x42\x60\x82";
  size_t n = sizeof first - 1;
  return length > 2 * n && memcmp(bytes, first, n) == 0 && memcmp(bytes + length - n, last, n) == 0;
}

static gh_status save(gh_context *ctx, child *c, const char *png) {
  char *bytes = NULL;
  size_t length;
  gh_status status = child_read(ctx, c->stream[1], png, &bytes, &length);
  if (status == GH_OK)
    status = is_whole(bytes, length)
                 ? gh_file_write(ctx, png, bytes, length)
                 : gh_fail(ctx, GH_SYSTEM, "%s: gnuplot has not drawn a whole picture", png);
  free(bytes);
  return status;
}

static gh_status child_draw(gh_context *ctx, child *c, const char *png) {
  int reason = child_start(c), code = 0;
  while (!reason && waitpid(c->pid, &code, 0) < 0)
    if (errno != EINTR) reason = errno;
  if (reason == ENOENT || (!reason && WIFEXITED(code) && WEXITSTATUS(code) == 127))
    return gh_fail(ctx, GH_ENGINE, "%s: gnuplot is not installed (Debian: apt-get install gnuplot-nox)", png);
  if (reason) return gh_fail(ctx, GH_SYSTEM, "%s: gnuplot cannot be started: %s", png, strerror(reason));
  if (WIFEXITED(code) && WEXITSTATUS(code) == 0) return save(ctx, c, png);
  return failed(ctx, c, png, WIFEXITED(code) ? WEXITSTATUS(code) : -1);
}

gh_status report_gnuplot(gh_context *ctx, const char *script, const char *png) {
  child c = {0};
  GH_TRY(script_check(ctx, script, png));
  gh_status status = child_open(ctx, script, png, &c);
  if (status == GH_OK) status = child_draw(ctx, &c, png);
  child_close(&c);
  return status;
}
