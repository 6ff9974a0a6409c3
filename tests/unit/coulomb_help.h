/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the tests of pair style granhom/coulomb in LAMMPS's own hands share. */
#ifndef GRANHOM_TESTS_COULOMB_HELP_H
#define GRANHOM_TESTS_COULOMB_HELP_H

#include "../help.h"
#include "engine/lammps/guard.h"

static inline void command(gh_context *ctx, void *lmp, const char *line) {
  OK(gh_lmp_command(ctx, lmp, "%s", line));
}

static inline void commands(gh_context *ctx, void *lmp, const char *const *lines) {
  for (; *lines; lines++) command(ctx, lmp, *lines);
}

/* Two disks of radius 1 and 0.5 in a periodic box, the second at `l` from the first, across the box's
 * boundary. */
static inline void *two_disks(gh_context *ctx, const char *style, const char *coefficients,
                              const double l[2]) {
  static const char *const box[] = {"dimension 2",
                                    "atom_style sphere",
                                    "atom_modify map array",
                                    "newton off",
                                    "region r prism 0 9 0 8 -1 1 0.7 0 0",
                                    "create_box 1 r",
                                    "neighbor 0.3 bin",
                                    "neigh_modify every 1 delay 0 check yes",
                                    NULL};
  const int id[2] = {1, 2}, type[2] = {1, 1};
  const double x[6] = {8.9, 0.5, 0, 8.9 + l[0] - 9, 0.5 + l[1], 0};
  void *lmp;
  double *radius;
  OK(gh_lmp_open(ctx, &lmp));
  commands(ctx, lmp, box);
  OK(gh_lmp_create_atoms(ctx, lmp, 2, id, type, x));
  OK(gh_lmp_atom(ctx, lmp, "radius", &radius));
  radius[0] = 1, radius[1] = 0.5;
  command(ctx, lmp, "group second id 2");
  OK(gh_lmp_command(ctx, lmp, "pair_style granhom/coulomb %s", style));
  OK(gh_lmp_command(ctx, lmp, "pair_coeff * * %s", coefficients));
  command(ctx, lmp, "compute c all granhom/contact/local");
  command(ctx, lmp, "compute s all granhom/stress");
  command(ctx, lmp, "timestep 0.001");
  return lmp;
}

/* Forces and torques by id: f_x f_y m. */
static inline void forces(gh_context *ctx, void *lmp, int n, double *out) {
  int *tag;
  double **f, **torque;
  OK(gh_lmp_atom(ctx, lmp, "id", &tag));
  OK(gh_lmp_atom(ctx, lmp, "f", &f));
  OK(gh_lmp_atom(ctx, lmp, "torque", &torque));
  for (int k = 0; k < n; k++) {
    double *o = out + 3 * (tag[k] - 1);
    o[0] = f[k][0], o[1] = f[k][1], o[2] = torque[k][2];
  }
}

#endif
