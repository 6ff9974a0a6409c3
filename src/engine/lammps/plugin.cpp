/* granhom's styles as a plugin (`plugin load`) for LAMMPS builds with the PLUGIN package; empty where
 * LAMMPS's header for plugins is not installed, as in Debian. SPDX-License-Identifier: GPL-2.0-or-later
 *
 * Built against the headers of the very LAMMPS that loads it: docs/lammps/README.md. */
#if __has_include(<lammpsplugin.h>)
#include "engine/lammps/compute_contact.h"
#include "engine/lammps/fix_relax.h"
#include "engine/lammps/pair_normal.h"

#include "lammps.h"
#include "version.h"

#include <lammpsplugin.h>

using LAMMPS_NS::LAMMPS;

static void *make_pair(void *lmp) {
  return static_cast<LAMMPS_NS::Pair *>(new granhom::PairNormal(static_cast<LAMMPS *>(lmp)));
}

static void *make_fix(void *lmp, int narg, char **arg) {
  return static_cast<LAMMPS_NS::Fix *>(new granhom::FixRelax(static_cast<LAMMPS *>(lmp), narg, arg));
}

static void *make_compute(void *lmp, int narg, char **arg) {
  return static_cast<LAMMPS_NS::Compute *>(
      new granhom::ComputeContact(static_cast<LAMMPS *>(lmp), narg, arg));
}

extern "C" void lammpsplugin_init(void *lmp, void *handle, void *registrar) {
  auto registers = reinterpret_cast<lammpsplugin_regfunc>(registrar);
  lammpsplugin_t plugin = {};
  plugin.version = LAMMPS_VERSION;
  plugin.author = "granhom";
  plugin.handle = handle;

  plugin.style = "pair";
  plugin.name = "granhom/normal";
  plugin.info = "one-sided harmonic normal contact";
  plugin.creator.v1 = make_pair;
  registers(&plugin, lmp);

  plugin.style = "fix";
  plugin.name = "granhom/relax";
  plugin.info = "dynamic relaxation to a residual";
  plugin.creator.v2 = make_fix;
  registers(&plugin, lmp);

  plugin.style = "compute";
  plugin.name = "granhom/contact/local";
  plugin.info = "list of contacts";
  plugin.creator.v2 = make_compute;
  registers(&plugin, lmp);
}
#endif
