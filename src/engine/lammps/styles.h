/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS styles of granhom: names and registration. */
#ifndef GRANHOM_LAMMPS_STYLES_H
#define GRANHOM_LAMMPS_STYLES_H

#include "engine/lammps/c_mpi.h"

#include "pointers.h"

/* All styles: name, class, what `plugin load` states of it. */
#define GH_LAMMPS_STYLES(PAIR, FIX, COMPUTE)                                                                 \
  PAIR("granhom/normal", PairNormal, "one-sided harmonic normal contact")                                    \
  PAIR("granhom/coulomb", PairCoulomb, "normal contact and Coulomb friction")                                \
  FIX("granhom/relax", FixRelax, "dynamic relaxation to a residual")                                         \
  FIX("granhom/history", FixHistory, "history of granhom/coulomb")                                           \
  COMPUTE("granhom/contact/local", ComputeContact, "list of contacts")                                       \
  COMPUTE("granhom/stress", ComputeStress, "homogenised stress")                                             \
  COMPUTE("granhom/tangent", ComputeTangent, "homogenised tangent")

namespace granhom {

/* Puts all styles of granhom into the style tables of an instance. */
void register_styles(LAMMPS_NS::LAMMPS *lmp);

} // namespace granhom

#endif
