/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Names: sets as parts of columns and datasets, kinds of files: one rule for those who write and those who
 * read. */
#include "results/results.h"

#include <string.h>

const char *gh_column_name(const char *set, char text[GH_COLUMN]) {
  snprintf(text, GH_COLUMN, "%s", set);
  for (char *c = text; *c; c++)
    if (*c == ',' || *c == ' ' || *c == '"' || *c == '\'') *c = '_';
  return text;
}

const char *gh_dataset_name(const char *set, char text[GH_COLUMN]) {
  gh_column_name(set, text);
  for (char *c = text; *c; c++)
    if (*c == '/') *c = '_';               /* HDF5 would make groups of it */
  if (strcmp(text, ".") == 0) *text = '_'; /* and this is the group itself */
  return text;
}

const char *gh_results_kind(const char *file) {
  static const struct {
    const char *name, *kind;
  } kinds[] = {{"results.h5", "results 1"},
               {"rves.h5", "rves 1"},
               {"traces.h5", "traces 1"},
               {"checkpoint.h5", "checkpoint 6"}};
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
    if (strcmp(kinds[k].name, file) == 0) return kinds[k].kind;
  return "unknown";
}
