/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS styles of granhom: registration. */
#include "engine/lammps/styles.h"

#include "engine/lammps/commands.h"
#include "engine/lammps/compute_contact.h"
#include "engine/lammps/compute_stress.h"
#include "engine/lammps/compute_tangent.h"
#include "engine/lammps/fix_history.h"
#include "engine/lammps/fix_relax.h"
#include "engine/lammps/pair_coulomb.h"

#include "force.h"
#include "modify.h"

using LAMMPS_NS::LAMMPS;

template <typename Style> static LAMMPS_NS::Pair *pair(LAMMPS *lmp) {
  return new Style(lmp);
}

template <typename Style> static LAMMPS_NS::Fix *fix(LAMMPS *lmp, int narg, char **arg) {
  return new Style(lmp, narg, arg);
}

template <typename Style> static LAMMPS_NS::Compute *compute(LAMMPS *lmp, int narg, char **arg) {
  return new Style(lmp, narg, arg);
}

void granhom::register_styles(LAMMPS *lmp) {
  auto &pairs = *lmp->force->pair_map;
  auto &fixes = *lmp->modify->fix_map;
  auto &computes = *lmp->modify->compute_map;
#define PAIR(name, Style, info) pairs[name] = pair<Style>;
#define FIX(name, Style, info) fixes[name] = fix<Style>;
#define COMPUTE(name, Style, info) computes[name] = compute<Style>;
  GH_LAMMPS_STYLES(PAIR, FIX, COMPUTE)
#undef PAIR
#undef FIX
#undef COMPUTE
  register_commands(lmp);
}
