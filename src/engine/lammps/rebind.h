/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Calls within liblammps.so of functions that are replaced. */
#ifndef GRANHOM_LAMMPS_REBIND_H
#define GRANHOM_LAMMPS_REBIND_H

namespace granhom {

/* From now on liblammps.so calls the functions that are replaced (interpose*.cpp), even where the program has
 * loaded it before this module. May be called again. */
void rebind();

} // namespace granhom

#endif
