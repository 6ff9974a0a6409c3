/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Context: the last message, the log and the progress sink. */
#include "granhom/base.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MESSAGE_SIZE = 2048 };

#undef gh_fail
#undef gh_prefix

struct gh_context {
  char message[MESSAGE_SIZE];
  gh_log_sink *log;
  void *log_data;
  gh_progress_sink *progress;
  void *progress_data;
};

int gh_exit_status(gh_status s) {
  static const int code[] = {
#define GH_X(name, exit_status, text) [name] = exit_status,
      GH_STATUS_LIST(GH_X)
#undef GH_X
  };
  return (unsigned)s < sizeof code / sizeof *code ? code[s] : 1;
}

const char *gh_status_text(gh_status s) {
  static const char *const words[] = {
#define GH_X(name, exit_status, text) [name] = text,
      GH_STATUS_LIST(GH_X)
#undef GH_X
  };
  return (unsigned)s < sizeof words / sizeof *words ? words[s] : "unknown status";
}

gh_status gh_context_create(gh_context **ctx) {
  *ctx = calloc(1, sizeof **ctx);
  return *ctx ? GH_OK : GH_MEMORY;
}

void gh_context_destroy(gh_context **ctx) {
  if (!ctx) return;
  free(*ctx);
  *ctx = NULL;
}

const char *gh_message(const gh_context *ctx) {
  return ctx ? ctx->message : "";
}

void gh_set_log(gh_context *ctx, gh_log_sink *sink, void *data) {
  ctx->log = sink;
  ctx->log_data = data;
}

void gh_set_progress(gh_context *ctx, gh_progress_sink *sink, void *data) {
  ctx->progress = sink;
  ctx->progress_data = data;
}

/* A message is one line, whatever names and words of a file it quotes: no control character reaches a
 * terminal or a record. */
static void message_clean(char *text) {
  for (char *c = text; *c; c++)
    if (*c == '\n' || *c == '\r' || *c == '\t') *c = ' ';
    else if ((unsigned char)*c < ' ' || *c == 0x7F) *c = '?';
}

/* The arguments may point into the stored message. */
static void message_print(char text[MESSAGE_SIZE], const char *format, va_list args) {
  vsnprintf(text, MESSAGE_SIZE, format, args);
  message_clean(text);
}

gh_status(gh_fail)(gh_context *ctx, gh_status s, const char *format, ...) {
  char text[MESSAGE_SIZE];
  va_list args;
  va_start(args, format);
  message_print(text, format, args);
  va_end(args);
  if (ctx) memcpy(ctx->message, text, sizeof text);
  return s;
}

gh_status gh_fail_at(const char *file, int line, const char *function, gh_context *ctx, gh_status s,
                     const char *format, ...) {
  char text[MESSAGE_SIZE];
  va_list args;
  va_start(args, format);
  message_print(text, format, args);
  va_end(args);
  const size_t used = strlen(text);
  snprintf(text + used, sizeof text - used, " [%s:%d %s]", file, line, function);
  if (ctx) memcpy(ctx->message, text, sizeof text);
  return s;
}

gh_status gh_prefix(gh_context *ctx, gh_status s, const char *format, ...) {
  if (!ctx) return s;
  char text[MESSAGE_SIZE];
  va_list args;
  va_start(args, format);
  int n = vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (n >= 0 && n < MESSAGE_SIZE) snprintf(text + n, sizeof text - (size_t)n, "%s", ctx->message);
  message_clean(text);
  memcpy(ctx->message, text, sizeof text);
  return s;
}

void gh_log(gh_context *ctx, gh_level level, const char *format, ...) {
  if (!ctx || !ctx->log) return;
  char line[MESSAGE_SIZE];
  va_list args;
  va_start(args, format);
  vsnprintf(line, sizeof line, format, args);
  va_end(args);
  message_clean(line);
  ctx->log(ctx->log_data, level, line);
}

gh_status gh_alloc(gh_context *ctx, size_t count, size_t size, void *p) {
  void *memory = calloc(count ? count : 1, size);
  memcpy(p, &memory, sizeof memory);
  if (!memory) return gh_fail(ctx, GH_MEMORY, "no memory for %zu objects of %zu bytes", count, size);
  return GH_OK;
}

gh_status gh_copy_text(gh_context *ctx, const char *text, char **copy) {
  GH_TRY(gh_alloc(ctx, strlen(text) + 1, 1, copy));
  strcpy(*copy, text);
  return GH_OK;
}

gh_status gh_grow(gh_context *ctx, size_t need, size_t size, size_t *capacity, void *p) {
  if (need <= *capacity) return GH_OK;
  size_t wanted = *capacity + *capacity / 2 + 16;
  size_t ample = need + need / 8; /* so that a count that wavers grows once */
  if (wanted < ample || wanted < need) wanted = ample > need ? ample : need;
  void *old, *memory;
  memcpy(&old, p, sizeof old);
  memory = wanted > (size_t)-1 / size ? NULL : realloc(old, wanted * size);
  if (!memory) return gh_fail(ctx, GH_MEMORY, "no memory for %zu objects of %zu bytes", wanted, size);
  memcpy(p, &memory, sizeof memory);
  *capacity = wanted;
  return GH_OK;
}

double gh_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void report(gh_context *ctx, gh_work *w, double done, double now, bool end) {
  if (!ctx || !ctx->progress) return;
  double seconds = now - w->start, rate = done > 0 && seconds > 0 ? done / seconds : NAN;
  gh_progress p = {.label = w->label,
                   .unit = w->unit,
                   .done = done,
                   .total = w->total,
                   .rate = rate,
                   .seconds = seconds,
                   .left = end ? 0 : (w->total - done) / rate,
                   .end = end};
  ctx->progress(ctx->progress_data, &p);
}

void gh_work_begin(gh_context *ctx, gh_work *w, const char *label, const char *unit, double total) {
  *w = (gh_work){.label = label, .unit = unit, .total = total, .start = gh_seconds()};
  report(ctx, w, 0, w->start, false);
}

void gh_work_advance(gh_context *ctx, gh_work *w, double done) {
  double now = gh_seconds();
  if (now - w->last < 0.1) return;
  w->last = now;
  report(ctx, w, done, now, false);
}

void gh_work_end(gh_context *ctx, gh_work *w, double done) {
  report(ctx, w, done, gh_seconds(), true);
}
