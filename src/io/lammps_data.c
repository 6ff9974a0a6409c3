/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS data files of atom_style sphere.
 * The format: https://docs.lammps.org/read_data.html. The first line is a title; then header lines, whose
 * words stand behind their numbers, in any order; then sections, each opened by a line with its name. */
#include "io/lammps_data.h"

#include <stdlib.h>
#include <string.h>

static gh_status read_file(gh_data_parser *p) {
  char *line;
  p->title = gh_reader_line(&p->r);
  if (!p->title) p->title = "";
  while ((line = gh_data_line(p))) {
    if (gh_data_opens_section(line)) {
      GH_TRY(gh_data_header_end(p));
      return gh_data_sections(p, line);
    }
    GH_TRY(gh_data_header_line(p, line));
  }
  return GH_DATA_FAIL(p, "%s", "truncated: the file ends without a section Atoms");
}

gh_status gh_lammps_data_read(gh_context *ctx, const char *path, gh_lammps_data **data) {
  enum { MOST_MEGABYTES = 512 };
  *data = NULL;
  gh_data_parser p = {.ctx = ctx};
  GH_TRY(gh_reader_open_most(ctx, path, MOST_MEGABYTES, &p.r));
  gh_status s = gh_alloc(ctx, 1, sizeof *p.data, &p.data);
  if (s == GH_OK) s = read_file(&p);
  gh_reader_close(&p.r);
  free(p.labels);
  if (s == GH_OK) *data = p.data;
  else gh_lammps_data_destroy(&p.data);
  return s;
}

void gh_lammps_data_destroy(gh_lammps_data **data) {
  if (!data || !*data) return;
  gh_lammps_data *d = *data;
  free(d->id);
  free(d->type);
  free(d->line);
  free(d->diameter);
  free(d->density);
  free(d->x);
  free(d);
  *data = NULL;
}

/* ---- writing ---- */

/* What the reader would refuse is never written. */
static gh_status check_data(gh_context *ctx, const char *path, const gh_lammps_data *d) {
  const double tilt[3] = {d->xy, d->xz, d->yz};
  if (d->natoms < 1 || d->ntypes < 1) {
    return gh_fail(ctx, GH_INTERNAL, "%s: %d atoms of %d types to be written, at least 1 each is wanted",
                   path, d->natoms, d->ntypes);
  }
  for (int c = 0; c < 3; c++) {
    if (!(d->low[c] < d->high[c]) || !isfinite(d->high[c] - d->low[c]) || !isfinite(tilt[c]))
      return gh_fail(ctx, GH_INTERNAL, "%s: a cell without a finite size was to be written", path);
  }
  for (int k = 0; k < d->natoms; k++) {
    const double value[5] = {d->diameter[k], d->density[k], d->x[3 * (size_t)k], d->x[3 * (size_t)k + 1],
                             d->x[3 * (size_t)k + 2]};
    if (!gh_finite(value, 5) || d->id[k] < 1 || d->type[k] < 1 || d->type[k] > d->ntypes) {
      return gh_fail(ctx, GH_INTERNAL, "%s: atom %d (type %d) has a value that cannot be written", path,
                     d->id[k], d->type[k]);
    }
  }
  return GH_OK;
}

static void print_data(gh_text *t, const char *title, const gh_lammps_data *d) {
  static const char axis[] = "xyz";
  gh_text_print(t, "%.*s\n\n%d atoms\n%d atom types\n\n", (int)strcspn(title, "\r\n"), title, d->natoms,
                d->ntypes);
  for (int c = 0; c < 3; c++)
    gh_text_print(t, "%.17g %.17g %clo %chi\n", d->low[c], d->high[c], axis[c], axis[c]);
  if (d->xy != 0 || d->xz != 0 || d->yz != 0)
    gh_text_print(t, "%.17g %.17g %.17g xy xz yz\n", d->xy, d->xz, d->yz);
  gh_text_print(t, "\nAtoms # sphere\n\n");
  for (int k = 0; k < d->natoms; k++) {
    const double *x = d->x + 3 * (size_t)k;
    gh_text_print(t, "%d %d %.17g %.17g %.17g %.17g %.17g\n", d->id[k], d->type[k], d->diameter[k],
                  d->density[k], x[0], x[1], x[2]);
  }
}

gh_status gh_lammps_data_write(gh_context *ctx, const char *path, const char *title,
                               const gh_lammps_data *data) {
  gh_text *text;
  GH_TRY(check_data(ctx, path, data));
  GH_TRY(gh_text_create(ctx, &text));
  print_data(text, title, data);
  gh_status s = gh_text_commit(text, path);
  gh_text_destroy(&text);
  return s;
}
