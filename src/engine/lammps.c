/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS's library interface, behind the module that is loaded on demand. */
#include "granhom/lammps.h"

#include "engine/module.h"

#include <stdarg.h>

gh_status gh_lmp_open(gh_context *ctx, void **lmp) {
  const gh_lammps_module *m;
  *lmp = NULL;
  GH_TRY(gh_lammps_load(ctx, &m));
  return m->open(ctx, lmp);
}

int gh_lmp_version(gh_context *ctx, void *lmp) {
  const gh_lammps_module *m;
  return gh_lammps_load(ctx, &m) == GH_OK ? m->version(ctx, lmp) : 0;
}

void gh_lmp_close(void **lmp) {
  const gh_lammps_module *m;
  if (lmp && *lmp && gh_lammps_load(NULL, &m) == GH_OK) m->close(lmp);
}

gh_status gh_lmp_command(gh_context *ctx, void *lmp, const char *format, ...) {
  const gh_lammps_module *m;
  char text[512];
  GH_TRY(gh_lammps_load(ctx, &m));
  va_list args;
  va_start(args, format);
  const int length = vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (length < 0 || length >= (int)sizeof text)
    return gh_fail(ctx, GH_INTERNAL, "LAMMPS command too long: %s", text);
  return m->command(ctx, lmp, "%s", text);
}

gh_status gh_lmp_create_atoms(gh_context *ctx, void *lmp, int n, const int *id, const int *type,
                              const double *x) {
  const gh_lammps_module *m;
  GH_TRY(gh_lammps_load(ctx, &m));
  return m->create_atoms(ctx, lmp, n, id, type, x);
}

gh_status gh_lmp_setting(gh_context *ctx, void *lmp, const char *name, int *value) {
  const gh_lammps_module *m;
  GH_TRY(gh_lammps_load(ctx, &m));
  return m->setting(ctx, lmp, name, value);
}

gh_status gh_lmp_atom(gh_context *ctx, void *lmp, const char *name, void *p) {
  const gh_lammps_module *m;
  GH_TRY(gh_lammps_load(ctx, &m));
  return m->atom(ctx, lmp, name, p);
}

gh_status gh_lmp_local(gh_context *ctx, void *lmp, const char *id, int *count, double ***rows) {
  const gh_lammps_module *m;
  GH_TRY(gh_lammps_load(ctx, &m));
  return m->local(ctx, lmp, id, count, rows);
}

gh_status gh_lmp_fix_vector(gh_context *ctx, void *lmp, const char *id, int component, double *value) {
  const gh_lammps_module *m;
  GH_TRY(gh_lammps_load(ctx, &m));
  return m->fix_vector(ctx, lmp, id, component, value);
}

gh_status gh_lmp_program(gh_context *ctx, int argc, char **argv, bool programs, int *exit_status,
                         bool *alone) {
  const gh_lammps_module *m;
  *exit_status = 0;
  *alone = false;
  GH_TRY(gh_lammps_load(ctx, &m));
  return m->program(ctx, argc, argv, programs, exit_status, alone);
}
