/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Status, messages, memory, progress and tensors. */
#include "../help.h"

/* Each status has its exit code and words; what is none counts as a failure. */
static void each_status_has_exit_code_and_words(void **state) {
  (void)state;
  static const int code[] = {[GH_OK] = 0,     [GH_INPUT] = 2,  [GH_DIVERGED] = 1, [GH_SYSTEM] = 1,
                             [GH_MEMORY] = 1, [GH_ENGINE] = 1, [GH_STOPPED] = 1,  [GH_INTERNAL] = 1};
  for (int s = GH_OK; s <= GH_INTERNAL; s++) {
    assert_int_equal(gh_exit_status((gh_status)s), code[s]);
    assert_true(strlen(gh_status_text((gh_status)s)) > 3);
  }
  assert_int_equal(gh_exit_status((gh_status)99), 1);
  assert_non_null(gh_status_text((gh_status)99));
}

/* A failure leaves its sentence, a prefix goes before it, and both may quote the message that is there. */
static void messages_are_kept_and_prefixed(void **state) {
  gh_context *ctx = *state;
  assert_string_equal(gh_message(ctx), "");
  assert_int_equal(gh_fail(ctx, GH_INPUT, "%s:%d: bad", "a.csv", 3), GH_INPUT);
  assert_string_equal(gh_message(ctx), "a.csv:3: bad");
  assert_int_equal(gh_prefix(ctx, GH_INPUT, "point %d: ", 7), GH_INPUT);
  assert_string_equal(gh_message(ctx), "point 7: a.csv:3: bad");
  gh_fail(ctx, GH_ENGINE, "again: %s", gh_message(ctx));
  assert_string_equal(gh_message(ctx), "again: point 7: a.csv:3: bad");
  assert_int_equal(gh_fail(NULL, GH_ENGINE, "nobody listens"), GH_ENGINE);
  assert_string_equal(gh_message(NULL), "");
}

/* A sentence longer than the room for it is cut, also by prefixes, and stays a string. */
static void long_messages_are_cut(void **state) {
  gh_context *ctx = *state;
  char text[5000];
  memset(text, 'x', sizeof text - 1);
  text[sizeof text - 1] = 0;
  gh_fail(ctx, GH_INPUT, "%s", text);
  size_t length = strlen(gh_message(ctx));
  assert_in_range(length, 1000, sizeof text - 2);
  gh_prefix(ctx, GH_INPUT, "before: ");
  assert_int_equal(strlen(gh_message(ctx)), length);
  assert_memory_equal(gh_message(ctx), "before: xxx", 11);
  gh_prefix(ctx, GH_INPUT, "%s", text);
  assert_int_equal(strlen(gh_message(ctx)), length);
}

/* Memory is zeroed; more than there is, or than a size_t can count, is refused with a message. */
static void memory_is_zeroed_or_refused(void **state) {
  gh_context *ctx = *state;
  double *p;
  OK(gh_alloc(ctx, 100, sizeof *p, &p));
  for (int k = 0; k < 100; k++) assert_true(p[k] == 0);
  free(p);
  OK(gh_alloc(ctx, 0, sizeof *p, &p));
  assert_non_null(p);
  free(p);
  if (getenv("SANITIZED")) return; /* the sanitizer ends the program instead */
  FAILS(gh_alloc(ctx, (size_t)-1 / 2, 16, &p), GH_MEMORY, "no memory");
  assert_null(p);
}

/* An array that grows keeps its content; growing beyond what a size_t counts fails and keeps it, too. */
static void growing_keeps_content(void **state) {
  gh_context *ctx = *state;
  int *a = NULL;
  size_t capacity = 0;
  for (int k = 0; k < 1000; k++) {
    OK(gh_grow(ctx, (size_t)k + 1, sizeof *a, &capacity, &a));
    assert_true(capacity > (size_t)k);
    a[k] = k;
  }
  for (int k = 0; k < 1000; k++) assert_int_equal(a[k], k);
  size_t before = capacity;
  FAILS(gh_grow(ctx, (size_t)-1 / 2, sizeof *a, &capacity, &a), GH_MEMORY, "no memory");
  assert_int_equal(capacity, before);
  assert_int_equal(a[999], 999);
  free(a);
}

typedef struct heard {
  int reports, ends;
  gh_progress last;
  char line[64];
  gh_level level;
} heard;

static void hear_progress(void *data, const gh_progress *report) {
  heard *h = data;
  h->reports++;
  h->ends += report->end;
  h->last = *report;
}
static void hear_log(void *data, gh_level level, const char *line) {
  heard *h = data;
  h->level = level;
  snprintf(h->line, sizeof h->line, "%s", line);
}

/* Work reports its begin and its end, in between at most ten times a second; without a sink nothing happens.
 */
static void progress_is_reported_sparingly(void **state) {
  gh_context *ctx = *state;
  heard h = {0};
  gh_work w;
  gh_work_begin(ctx, &w, "nobody", "steps", 5);
  gh_work_end(ctx, &w, 5);
  gh_set_progress(ctx, hear_progress, &h);
  double start = gh_seconds();
  gh_work_begin(ctx, &w, "pour", "grains", 1e6);
  assert_int_equal(h.reports, 1);
  assert_true(isnan(h.last.rate) && isnan(h.last.left) && h.last.done == 0 && !h.last.end);
  for (int k = 0; k < 1000000; k++) gh_work_advance(ctx, &w, k);
  gh_work_end(ctx, &w, 1e6);
  double seconds = gh_seconds() - start;
  assert_true(h.reports <= 3 + 10 * seconds);
  assert_int_equal(h.ends, 1);
  assert_string_equal(h.last.label, "pour");
  assert_string_equal(h.last.unit, "grains");
  assert_true(h.last.end && h.last.left == 0 && h.last.total == 1e6 && h.last.done == 1e6 && h.last.rate > 0);
}

/* A line of the log reaches its sink with its level; without a sink nothing happens. */
static void log_lines_reach_their_sink(void **state) {
  gh_context *ctx = *state;
  heard h = {0};
  gh_log(ctx, GH_LEVEL_INFO, "nobody");
  gh_log(NULL, GH_LEVEL_INFO, "nobody");
  gh_set_log(ctx, hear_log, &h);
  gh_log(ctx, GH_LEVEL_WARNING, "%d grains", 3);
  assert_string_equal(h.line, "3 grains");
  assert_int_equal(h.level, GH_LEVEL_WARNING);
}

/* Products, inverses and the Cauchy stress of tensors that were worked out by hand; outputs may be inputs. */
static void tensors_of_the_plane(void **state) {
  (void)state;
  const double A[4] = {2, 1, 3, 4}, B[4] = {1, -2, 5, 3}, AB[4] = {7, -1, 23, 6};
  double C[4], x[2] = {1, 2};
  assert_true(gh_det2(A) == 5);
  gh_mul2(A, B, C);
  assert_true(distance(C, AB, 4) == 0);
  memcpy(C, A, sizeof C), gh_mul2(C, B, C);
  assert_true(distance(C, AB, 4) == 0);
  memcpy(C, B, sizeof C), gh_mul2(A, C, C);
  assert_true(distance(C, AB, 4) == 0);
  gh_inv2(A, C);
  assert_true(distance(C, (double[4]){0.8, -0.2, -0.6, 0.4}, 4) < 1e-15);
  memcpy(C, A, sizeof C), gh_inv2(C, C);
  assert_true(distance(C, (double[4]){0.8, -0.2, -0.6, 0.4}, 4) < 1e-15);
  gh_apply2(A, x, x);
  assert_true(x[0] == 4 && x[1] == 11);
  gh_cauchy2(B, A, C); /* B A^T / 5 */
  assert_true(distance(C, (double[4]){0, -1, 2.6, 5.4}, 4) < 1e-15);
  assert_true(gh_finite(A, 4) && !gh_finite((double[2]){1, NAN}, 2) &&
              !gh_finite((double[2]){INFINITY, 1}, 2));
}

/* In a debug build a message ends with the place where it was made. */
static void messages_name_their_place(void **state) {
  gh_context *ctx = *state;
  assert_int_equal(gh_fail_at("a.c", 3, "row_read", ctx, GH_INPUT, "row %d: %s", 7, "bad\n"), GH_INPUT);
  assert_string_equal(gh_message(ctx), "row 7: bad  [a.c:3 row_read]");
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(each_status_has_exit_code_and_words),
                                     TEST(messages_are_kept_and_prefixed),
                                     TEST(messages_name_their_place),
                                     TEST(long_messages_are_cut),
                                     TEST(memory_is_zeroed_or_refused),
                                     TEST(growing_keeps_content),
                                     TEST(progress_is_reported_sparingly),
                                     TEST(log_lines_reach_their_sink),
                                     TEST(tensors_of_the_plane)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
