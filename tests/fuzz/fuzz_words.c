/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What stands on command lines: numbers, integers, conditions of element tests, parameters of packings, ways
 * to finish one. Each line of an input is a word; the first of two with a blank between them may name a
 * parameter. */
#include "../../driver/pack_spec.h"
#include "fuzz.h"
#include "granhom/control.h"

#include <stdlib.h>
#include <string.h>

static void word_use(gh_context *ctx, const char *word) {
  double number;
  long integer;
  gh_condition condition;
  gh_finish_options finish = gh_finish_defaults();
  gh_boundary boundary;
  if (gh_parse_number(word, &number)) fuzz_require(isfinite(number), "a number that is not finite");
  if (gh_parse_integer(word, -5, 100, &integer))
    fuzz_require(integer >= -5 && integer <= 100, "an integer out of range");
  if (fuzz_good(ctx, gh_condition_parse(ctx, word, &condition)))
    for (int k = 0; k < (int)(sizeof condition.factor / sizeof *condition.factor); k++)
      fuzz_require(isfinite(condition.factor[k]), "a condition with a factor that is not finite");
  if (fuzz_good(ctx, gh_finish_parse(ctx, word, &finish))) fuzz_good(ctx, gh_finish_check(ctx, &finish));
  if (gh_boundary_from_name(word, &boundary))
    fuzz_require(strcmp(gh_boundary_name(boundary), word) == 0, "another name");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  gh_context *ctx = fuzz_begin();
  char *text = fuzz_text(data, size), *rest = text;
  pack_spec spec;
  pack_spec_init(&spec);
  while (rest) {
    char *line = rest, *end = strchr(rest, '\n');
    rest = end ? end + 1 : NULL;
    if (end) *end = 0;
    word_use(ctx, line);
    char *blank = strchr(line, ' ');
    if (!blank) continue;
    *blank = 0;
    fuzz_good(ctx, pack_spec_set(ctx, &spec, line, "--word", blank + 1));
  }
  fuzz_good(ctx, pack_spec_complete(ctx, &spec));
  pack_spec_free(&spec);
  free(text);
  fuzz_end(ctx);
  return 0;
}
