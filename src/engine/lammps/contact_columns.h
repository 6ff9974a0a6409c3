/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Columns of compute granhom/contact/local, for the compute and for the bridge that reads them. */
#ifndef GRANHOM_LAMMPS_CONTACT_COLUMNS_H
#define GRANHOM_LAMMPS_CONTACT_COLUMNS_H

/* Enumerators in the order of the columns; from COUPLE on with friction only, DERIVATIVE is the first of
 * nine. */
#define GH_CONTACT_COLUMNS                                                                                   \
  TAG1, TAG2, LX, LY, LZ, FX, FY, FZ, OVERLAP, ENERGY, HXX, HXY, HXZ, HYY, HYZ, HZZ, COUPLE, SLIP_FORCE,     \
      GAMMA, GAMMA_PL, ALPHA, SLIDES, KX, KY, ENERGY_T, DISSIPATED, DERIVATIVE

#endif
