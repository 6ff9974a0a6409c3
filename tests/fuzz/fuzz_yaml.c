/* SPDX-License-Identifier: GPL-2.0-or-later */
/* YAML documents: printing gives the same document again; setters of paths ("steps.1.increments"). An input
 * is a document, and behind a line "%%" a key and, in the next line, a value. */
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

static char *yaml_print(gh_context *ctx, gh_yaml *doc) {
  gh_text *out;
  size_t length;
  fuzz_require(gh_text_create(ctx, &out) == GH_OK, "no text");
  gh_yaml_print(gh_yaml_root(doc), out);
  const char *text = gh_text_get(out, &length);
  char *copy = fuzz_text((const uint8_t *)text, length);
  gh_text_destroy(&out);
  return copy;
}

static void yaml_again(gh_context *ctx, gh_yaml *doc) {
  gh_yaml *twin = NULL;
  char *first = yaml_print(ctx, doc), *second;
  gh_status status = gh_yaml_parse(ctx, "printed", first, &twin);
  if (status != GH_OK) fprintf(stderr, "fuzz: %s\nof: %s\n", gh_message(ctx), first);
  fuzz_require(status == GH_OK, "a printed document cannot be read");
  second = yaml_print(ctx, twin);
  if (strcmp(first, second) != 0) fprintf(stderr, "fuzz: %s\n      %s\n", first, second);
  fuzz_require(strcmp(first, second) == 0, "a printed document is another one");
  gh_yaml_destroy(&twin);
  free(first);
  free(second);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  gh_context *ctx = fuzz_begin();
  gh_yaml *doc = NULL;
  char *text = fuzz_text(data, size), *key = strstr(text, "\n%%\n"), *value = NULL;
  if (key) {
    *key = 0;
    key += 4;
    value = strchr(key, '\n');
    if (value) *value++ = 0;
  }
  if (fuzz_good(ctx, gh_yaml_parse(ctx, "input.yaml", text, &doc))) {
    yaml_again(ctx, doc);
    if (value && fuzz_good(ctx, gh_yaml_set(doc, key, value))) yaml_again(ctx, doc);
  }
  gh_yaml_destroy(&doc);
  free(text);
  fuzz_end(ctx);
  return 0;
}
