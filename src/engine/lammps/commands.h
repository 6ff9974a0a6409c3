/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS commands that friction cannot follow. */
#ifndef GRANHOM_LAMMPS_COMMANDS_H
#define GRANHOM_LAMMPS_COMMANDS_H

namespace LAMMPS_NS {
class LAMMPS;
}

namespace granhom {

/* From now on rerun and read_dump stop with the reason where pair style granhom/coulomb has a state n that
 * they would leave behind. May be called again after `clear`. */
void register_commands(LAMMPS_NS::LAMMPS *lmp);

/* Stops a command of a script that would remove or replace what pair style granhom/coulomb keeps. */
void refuse_removal(LAMMPS_NS::LAMMPS *lmp, const char *command, int narg, char **arg);

} // namespace granhom

#endif
