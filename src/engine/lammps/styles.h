/* LAMMPS styles of granhom: names and registration. SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_LAMMPS_STYLES_H
#define GRANHOM_LAMMPS_STYLES_H

#include "engine/lammps/c_mpi.h"

#include "pointers.h"

namespace granhom {

/* Puts all styles of granhom into the style tables of an instance. */
void register_styles(LAMMPS_NS::LAMMPS *lmp);

} // namespace granhom

#endif
