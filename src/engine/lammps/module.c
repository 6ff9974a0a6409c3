/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The table of granhom-lammps.so. */
#include "engine/module.h"

#include "engine/lammps/guard.h"

__attribute__((visibility("default")))
const gh_lammps_module gh_lammps_linked = {.build = gh_build,
                                           .engine = &gh_lammps_ops,
                                           .open = guard_open,
                                           .version = guard_version,
                                           .close = guard_close,
                                           .command = guard_command,
                                           .create_atoms = guard_create_atoms,
                                           .setting = guard_setting,
                                           .atom = guard_atom,
                                           .local = guard_local,
                                           .fix_vector = guard_fix_vector,
                                           .program = guard_program};
