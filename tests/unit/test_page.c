/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Pictures whose drawing library fails. */
#include "../help.h"

#include "report/page.h"

#include <stdlib.h>
#include <unistd.h>

/* A drawing that has failed (here: by restoring a state that was never saved) draws nothing more, and what
 * would be written is not the picture: no file, and a reason. */
static void a_failed_drawing_is_not_written(void **state) {
  static const char *const names[] = {"a.png", "a.svg"};
  (void)state;
  gh_context *ctx;
  char folder[] = "/tmp/granhom-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  assert_int_equal(gh_context_create(&ctx), GH_OK);
  for (int k = 0; k < 4; k++) {
    const bool fails = k < 2;
    report_page p;
    snprintf(path, sizeof path, "%s/%s", folder, names[k % 2]);
    assert_int_equal(report_page_open(ctx, &p, 60, 40, path), GH_OK);
    if (fails) cairo_restore(p.c);
    report_page_text(&p, 10, 20, 12, 0, "x");
    assert_int_equal(report_page_write(&p, path), fails ? GH_MEMORY : GH_OK);
    report_page_close(&p);
    assert_int_equal(access(path, F_OK), fails ? -1 : 0);
    if (fails) assert_non_null(strstr(gh_message(ctx), ": cannot be drawn: "));
    else unlink(path);
  }
  gh_context_destroy(&ctx);
  rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_failed_drawing_is_not_written)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
