/* SPDX-License-Identifier: GPL-2.0-or-later */
/* JSON by cJSON, without its silence about memory. */
#ifndef GRANHOM_IO_JSON_H
#define GRANHOM_IO_JSON_H

#include "granhom/base.h"

#include <cjson/cJSON.h>

/* A place in a document that is written. What could not be added is remembered for the whole document. */
typedef struct gh_json {
  cJSON *at;
  bool *failed;
} gh_json;
gh_json gh_json_group(gh_json parent, const char *name);
void gh_json_text(gh_json o, const char *name, const char *value);
void gh_json_truth(gh_json o, const char *name, bool value);
/* 17 digits; JSON has no NaN: null. */
void gh_json_number(gh_json o, const char *name, double value);
/* Adds an item of cJSON's, or the failure to make it (NULL). */
void gh_json_add(gh_json o, const char *name, cJSON *item);

/* The document of a text; freed by cJSON_Delete. GH_INPUT "NAME: is no JSON", GH_MEMORY. */
gh_status gh_json_parse(gh_context *ctx, const char *name, const char *text, cJSON **root);

#endif
