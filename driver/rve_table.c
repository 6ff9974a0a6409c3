/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Columns that the tables of granhom rve and granhom element share. */
#include "rve_table.h"
#include "cli.h"
#include "reference.h"

#include <string.h>
#include <sys/stat.h>

const option_row rve_table_option[] = {{.name = "output",
                                        .letter = 'o',
                                        .argument = "FILE",
                                        .kind = OPTION_TEXT,
                                        .standard = "standard output",
                                        .help = "results"},
                                       {0}};

static void more_columns(gh_text *out, bool wanted, const gh_term *columns) {
  if (!wanted) return;
  gh_text_print(out, ",");
  gh_terms_header(out, columns, ",");
}

void rve_table_header(gh_text *out, const gh_rve_options *o) {
  gh_terms_header(out, columns_point, ",");
  more_columns(out, o->law.friction, columns_friction);
  more_columns(out, gh_rve_has_frame(o), columns_frame);
  more_columns(out, gh_rve_has_servo(o), columns_servo);
}

void rve_table_row(gh_text *out, long step, const gh_rve_measures *m, double residual, double seconds,
                   const gh_rve_options *o) {
  const double *const blocks[] = {m->F, m->P, m->cauchy};
  gh_text_print(out, "%ld", step);
  for (int b = 0; b < 3; b++)
    for (int k = 0; k < 4; k++) gh_text_print(out, ",%.17g", blocks[b][k]);
  gh_text_print(out, ",%.17g,%d,%d,%.17g,%.6g", m->energy, m->contacts, m->rattlers, residual, seconds);
  if (o->law.friction) gh_text_print(out, ",%.17g,%.17g,%d", m->energy_t, m->dissipation, m->sliding);
  if (gh_rve_has_frame(o)) gh_text_print(out, ",%.17g", m->couple);
  if (gh_rve_has_servo(o)) gh_text_print(out, ",%d", m->sweeps);
}

/* What goes into a pipe or a device cannot be replaced by more of it. */
static bool is_stream(const char *path) {
  struct stat info;
  return stat(path, &info) == 0 && !S_ISREG(info.st_mode);
}

gh_status rve_table_write(gh_context *ctx, gh_text *text, const char *path, bool last) {
  if (!text || (path && !last && is_stream(path))) return GH_OK;
  if (path && strcmp(path, "-")) return gh_text_commit(text, path);
  return last ? cli_print(ctx, text) : GH_OK;
}
