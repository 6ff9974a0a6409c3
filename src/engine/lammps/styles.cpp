/* LAMMPS styles of granhom: registration. SPDX-License-Identifier: GPL-2.0-or-later */
#include "engine/lammps/styles.h"

#include "engine/lammps/compute_contact.h"
#include "engine/lammps/fix_relax.h"
#include "engine/lammps/pair_normal.h"

#include "force.h"
#include "modify.h"

using LAMMPS_NS::LAMMPS;

void granhom::register_styles(LAMMPS *lmp) {
  (*lmp->force->pair_map)["granhom/normal"] = [](LAMMPS *l) -> LAMMPS_NS::Pair * {
    return new PairNormal(l);
  };
  (*lmp->modify->fix_map)["granhom/relax"] = [](LAMMPS *l, int narg, char **arg) -> LAMMPS_NS::Fix * {
    return new FixRelax(l, narg, arg);
  };
  (*lmp->modify->compute_map)["granhom/contact/local"] = [](LAMMPS *l, int narg,
                                                            char **arg) -> LAMMPS_NS::Compute * {
    return new ComputeContact(l, narg, arg);
  };
}
