/* SPDX-License-Identifier: GPL-2.0-or-later */
/* JSON by cJSON, without its silence about memory. */
#include "io/json.h"

#include <stdlib.h>
#include <string.h>

/* cJSON returns what it has added. */
static void json_note(gh_json o, const cJSON *added) {
  if (!added) *o.failed = true;
}

gh_json gh_json_group(gh_json parent, const char *name) {
  gh_json o = {.at = cJSON_AddObjectToObject(parent.at, name), .failed = parent.failed};
  json_note(o, o.at);
  return o;
}

void gh_json_text(gh_json o, const char *name, const char *value) {
  json_note(o, cJSON_AddStringToObject(o.at, name, value));
}

void gh_json_truth(gh_json o, const char *name, bool value) {
  json_note(o, cJSON_AddBoolToObject(o.at, name, value));
}

void gh_json_number(gh_json o, const char *name, double value) {
  json_note(o,
            isfinite(value) ? cJSON_AddNumberToObject(o.at, name, value) : cJSON_AddNullToObject(o.at, name));
}

void gh_json_add(gh_json o, const char *name, cJSON *item) {
  if (item && cJSON_AddItemToObject(o.at, name, item)) return;
  cJSON_Delete(item);
  *o.failed = true;
}

/* cJSON gives no reason. What can be read at the second try was in order; where there is no memory for twice
 * the text, there was none for the document. */
gh_status gh_json_parse(gh_context *ctx, const char *name, const char *text, cJSON **root) {
  *root = cJSON_Parse(text);
  if (!*root) *root = cJSON_Parse(text);
  if (*root) return GH_OK;
  void *room = malloc(2 * strlen(text) + 4096);
  free(room);
  return room ? gh_fail(ctx, GH_INPUT, "%s: is no JSON object: cut off, or of another program", name)
              : gh_fail(ctx, GH_MEMORY, "%s: no memory to read it", name);
}
