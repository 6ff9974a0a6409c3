/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the subcommands share: context with log and progress on standard error. */
#include "cli.h"

#include "granhom/io.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Standard error: whether the last thing on it is a progress line that the next one overwrites. There is one
 * standard error per process. */
static struct {
  bool terminal, line;
  double last; /* seconds of the last plain progress line */
} screen;

static void clear_line(void) {
  if (!screen.line) return;
  fprintf(stderr, "\r\033[K");
  fflush(stderr); /* before what is printed on standard output */
  screen.line = false;
}

static void log_line(void *data, gh_level level, const char *line) {
  (void)data;
  if (level == GH_LEVEL_DEBUG) return;
  clear_line();
  fprintf(stderr, "%s%s\n", level == GH_LEVEL_WARNING ? "warning: " : "", line);
}

static void duration(double seconds, char text[32]) {
  if (!isfinite(seconds)) snprintf(text, 32, "?");
  else if (seconds < 100) snprintf(text, 32, "%.0f s", seconds);
  else if (seconds < 6000) snprintf(text, 32, "%.0f min", seconds / 60);
  else snprintf(text, 32, "%.1f h", seconds / 3600);
}

static void progress_line(void *data, const gh_progress *p) {
  (void)data;
  double now = gh_seconds();
  if (!screen.terminal && !p->end && now - screen.last < 10) return;
  screen.last = now;
  char taken[32], left[32], rate[32] = "";
  duration(p->seconds, taken);
  duration(p->left, left);
  if (isfinite(p->rate)) snprintf(rate, sizeof rate, ", %.3g/s", p->rate);
  clear_line();
  bool known = isfinite(p->total);
  if (known) fprintf(stderr, "%s: %.0f of %.0f %s, %s%s", p->label, p->done, p->total, p->unit, taken, rate);
  else fprintf(stderr, "%s: %.0f %s, %s%s", p->label, p->done, p->unit, taken, rate);
  if (!p->end && known) fprintf(stderr, ", about %s left at this rate", left);
  if (!screen.terminal || p->end) fprintf(stderr, "\n");
  else screen.line = true;
  fflush(stderr);
}

gh_context *cli_open(void) {
  gh_context *ctx;
  if (gh_context_create(&ctx) != GH_OK) {
    fprintf(stderr, "granhom: out of memory\n");
    return NULL;
  }
  gh_temporary_clean();
  screen.terminal = isatty(STDERR_FILENO) == 1;
  screen.last = gh_seconds();
  gh_set_log(ctx, log_line, NULL);
  gh_set_progress(ctx, progress_line, NULL);
  return ctx;
}

const option_row cli_screen_rows[] = {
    {.name = "quiet", .kind = OPTION_FLAG, .help = "only warnings and errors on the screen"}, {0}};

static void warnings_only(void *data, gh_level level, const char *line) {
  (void)data;
  if (level == GH_LEVEL_WARNING) fprintf(stderr, "warning: %s\n", line);
}

void cli_quiet(gh_context *ctx) {
  gh_set_log(ctx, warnings_only, NULL);
  gh_set_progress(ctx, NULL, NULL);
}

int cli_close(gh_context *ctx, gh_status s) {
  clear_line();
  if (s != GH_OK && cli_rank() == 0) {
    const char *message = gh_message(ctx);
    fprintf(stderr, "granhom: %s\n", *message ? message : gh_status_text(s));
  }
  gh_context_destroy(&ctx);
  return gh_exit_status(s);
}

gh_status cli_print(gh_context *ctx, const gh_text *text) {
  size_t length;
  GH_TRY(gh_text_check(text));
  const char *bytes = gh_text_get(text, &length);
  if (fwrite(bytes, 1, length, stdout) == length && fflush(stdout) == 0) return GH_OK;
  clearerr(stdout); /* it has been reported */
  return gh_fail(ctx, GH_SYSTEM, "standard output cannot be written");
}

gh_status cli_print_last(gh_context *ctx, gh_text **text) {
  const gh_status status = cli_rank() == 0 ? cli_print(ctx, *text) : GH_OK;
  gh_text_destroy(text);
  return status;
}

int cli_usage(const cli_command *command, const char *format, ...) {
  va_list args;
  if (cli_rank() > 0) return 2;
  va_start(args, format);
  fprintf(stderr, "granhom %s: ", command->name);
  vfprintf(stderr, format, args);
  fprintf(stderr, "\nTry `granhom help %s`.\n", command->name);
  va_end(args);
  return 2;
}

gh_status cli_finish(gh_context *ctx, gh_status status, gh_status (*last)(void *data, bool good),
                     void *data) {
  char *message = status == GH_OK ? NULL : strdup(gh_message(ctx));
  gh_status s = last(data, status == GH_OK);
  if (message) gh_fail(ctx, status, "%s", message);
  free(message);
  return status == GH_OK ? s : status;
}

gh_status cli_end_of_rows(gh_status status, long rows) {
  return status == GH_INPUT && rows > 0 ? GH_DIVERGED : status;
}
