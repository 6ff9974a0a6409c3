/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Columns that the tables of granhom rve and granhom element share. */
#include "rve_table.h"
#include "cli.h"
#include "reference.h"

#include <string.h>

const option_row rve_table_option[] = {{.name = "output",
                                        .letter = 'o',
                                        .argument = "FILE",
                                        .kind = OPTION_TEXT,
                                        .standard = "standard output",
                                        .help = "results"},
                                       {0}};

void rve_table_header(gh_text *out, bool friction) {
  gh_terms_header(out, columns_point, ",");
  if (!friction) return;
  gh_text_print(out, ",");
  gh_terms_header(out, columns_friction, ",");
}

void rve_table_row(gh_text *out, long step, const gh_rve_measures *m, double seconds, bool friction) {
  const double *const blocks[] = {m->F, m->P, m->cauchy};
  gh_text_print(out, "%ld", step);
  for (int b = 0; b < 3; b++)
    for (int k = 0; k < 4; k++) gh_text_print(out, ",%.17g", blocks[b][k]);
  gh_text_print(out, ",%.17g,%d,%d,%.17g,%.6g", m->energy, m->contacts, m->rattlers, m->residual, seconds);
  if (friction) gh_text_print(out, ",%.17g,%.17g,%d", m->energy_t, m->dissipation, m->sliding);
}

gh_status rve_table_write(gh_context *ctx, gh_text *text, const char *path, bool last) {
  if (!text) return GH_OK;
  if (path && strcmp(path, "-")) return gh_text_commit(text, path);
  return last ? cli_print(ctx, text) : GH_OK;
}
