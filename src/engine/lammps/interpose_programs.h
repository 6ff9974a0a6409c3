/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Commands of LAMMPS that run other programs. */
#ifndef GRANHOM_LAMMPS_INTERPOSE_PROGRAMS_H
#define GRANHOM_LAMMPS_INTERPOSE_PROGRAMS_H

namespace LAMMPS_NS {
class LAMMPS;
}

namespace granhom {

/* From now on this instance runs no other programs, `clear` or not: shell, python, plugin, dump movie and
 * names of compressed files that a shell would interpret are errors. In effect where the executable's symbols
 * come before those of liblammps.so, as in the program granhom. */
void refuse_programs(LAMMPS_NS::LAMMPS *lmp);

} // namespace granhom

#endif
