/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Values of options by the rows of a table. */
#include "options.h"

#include "granhom/io.h"

#include <string.h>

const option_row *option_find(const option_row *rows, const char *name) {
  for (; rows->name; rows++)
    if (rows->kind != OPTION_HEADING && strcmp(rows->name, name) == 0) return rows;
  return NULL;
}

static void choice_wanted(const char *const *words, char text[160]) {
  size_t used = 0;
  for (int k = 0; words[k] && used < 160; k++) {
    const char *before = k == 0 ? "" : words[k + 1] ? ", " : " or ";
    used += (size_t)snprintf(text + used, 160 - used, "%s%s", before, words[k]);
  }
}

void option_wanted(const option_row *row, char text[160]) {
  *text = 0;
  if (row->wanted) snprintf(text, 160, "%s", row->wanted);
  else if (row->kind == OPTION_CHOICE) choice_wanted(row->words, text);
  else if (row->kind == OPTION_NUMBER)
    snprintf(text, 160, "%s", row->zero ? "a number that is 0 or more" : "a positive number");
  else if (row->kind == OPTION_INTEGER || row->kind == OPTION_LONG)
    snprintf(text, 160, "an integer from %ld to %ld", row->low, row->high);
}

static gh_status value_refuse(gh_context *ctx, const option_row *row, const char *where, const char *text) {
  char wanted[160];
  option_wanted(row, wanted);
  const char *hint = row->kind == OPTION_CHOICE ? "" : gh_number_hint(text);
  return gh_fail(ctx, GH_INPUT, "%s must be %s, not \"%s\"%s", where, wanted, text, hint);
}

static gh_status number_set(gh_context *ctx, const option_row *row, const char *where, const char *text,
                            double *place) {
  double value;
  if (!gh_parse_number(text, &value) || !(row->zero ? value >= 0 : value > 0))
    return value_refuse(ctx, row, where, text);
  if (row->below > 0 && !(value < row->below))
    return row->wanted ? value_refuse(ctx, row, where, text)
                       : gh_fail(ctx, GH_INPUT, "%s must be below %g, not %g", where, row->below, value);
  *place = value;
  return GH_OK;
}

static gh_status choice_set(gh_context *ctx, const option_row *row, const char *where, const char *text,
                            int *place) {
  for (int k = 0; row->words[k]; k++)
    if (strcmp(row->words[k], text) == 0) {
      *place = k;
      return GH_OK;
    }
  return value_refuse(ctx, row, where, text);
}

gh_status option_set(gh_context *ctx, const option_row *row, const char *where, const char *text,
                     void *group) {
  void *place = (char *)group + row->place;
  long integer;
  switch (row->kind) {
  case OPTION_TEXT:
    *(const char **)place = text;
    return GH_OK;
  case OPTION_FLAG:
    *(bool *)place = true;
    return GH_OK;
  case OPTION_NUMBER:
    return number_set(ctx, row, where, text, place);
  case OPTION_INTEGER:
  case OPTION_LONG:
    if (!gh_parse_integer(text, row->low, row->high, &integer)) return value_refuse(ctx, row, where, text);
    if (row->kind == OPTION_LONG) *(long *)place = integer;
    else *(int *)place = (int)integer;
    return GH_OK;
  case OPTION_CHOICE:
    return choice_set(ctx, row, where, text, place);
  case OPTION_OWN:
    return row->read(ctx, where, text, group);
  case OPTION_HEADING:
    break;
  }
  return GH_OK;
}
