/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Static condensation of a packing's stiffness to the homogenised tangent, for LAMMPS's users. */
#ifndef GRANHOM_LAMMPS_CONDENSE_H
#define GRANHOM_LAMMPS_CONDENSE_H

#include <vector>

namespace granhom {

struct Packing {
  struct Contact {
    int i, j;
    double l[2]; /* from i to the image of j */
    double d[9]; /* of (f_x, f_y, M) with respect to (l_x, l_y, q): granhom/contact.h */
  };
  std::vector<double> radius;
  std::vector<char>
      free; /* grains that are in equilibrium; the others follow F, and rotate where grains do */
  std::vector<Contact> contacts;
  double volume = 0;
  bool friction = false, turns = false;
};

/* A: 4 x 4, rows iJ and columns kL as 11 12 21 22, A_iJkL = dP_iJ/dF_kL at F = 1 (6.3, 6.7, 6.18, 6.19).
 * Without friction, rattlers (Table 4.3) are left out; with it, grains without contacts. False: the matrix
 * could not be factorised. */
bool condense(const Packing &p, double *A);

} // namespace granhom

#endif
