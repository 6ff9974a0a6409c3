/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Lines and numbers of a LAMMPS data file. */
#include "io/lammps_data.h"

#include <string.h>

char *gh_data_line(gh_data_parser *p) {
  char *line;
  while ((line = gh_reader_line(&p->r))) {
    char *hash = strchr(line, '#');
    p->comment = hash ? gh_trim(hash + 1) : "";
    if (hash) *hash = 0;
    line = gh_trim(line);
    if (*line) return line;
  }
  return NULL;
}

gh_status gh_data_number(gh_data_parser *p, const char *text, const char *what, double *value) {
  char quoted[GH_QUOTE];
  if (gh_parse_number(text, value)) return GH_OK;
  return GH_DATA_FAIL(p, "%s: '%s' is not a finite number%s", what, gh_quote(text, quoted),
                      gh_number_hint(text));
}
