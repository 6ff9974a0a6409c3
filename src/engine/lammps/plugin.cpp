/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom's styles as a plugin (`plugin load`) for LAMMPS builds with the PLUGIN package; empty where
 * LAMMPS's header for plugins is not installed, as in Debian: there granhomplugin.so is preloaded
 * (interpose_styles.cpp).
 *
 * Built against the headers of the very LAMMPS that loads it: docs/reference/lammps/README.md. */
#if __has_include(<lammpsplugin.h>)
#include "engine/lammps/commands.h"
#include "engine/lammps/compute_contact.h"
#include "engine/lammps/compute_stress.h"
#include "engine/lammps/compute_tangent.h"
#include "engine/lammps/fix_history.h"
#include "engine/lammps/fix_relax.h"
#include "engine/lammps/pair_coulomb.h"
#include "engine/lammps/styles.h"

#include "lammps.h"
#include "version.h"

#include <lammpsplugin.h>

using LAMMPS_NS::LAMMPS;

/* The void pointer is to the base class. */
template <typename Style> static void *pair(void *lmp) {
  return static_cast<LAMMPS_NS::Pair *>(new Style(static_cast<LAMMPS *>(lmp)));
}

template <typename Base, typename Style> static void *other(void *lmp, int narg, char **arg) {
  return static_cast<Base *>(new Style(static_cast<LAMMPS *>(lmp), narg, arg));
}

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *registrar) {
  using LAMMPS_NS::Compute;
  using LAMMPS_NS::Fix;
  using namespace granhom;
  auto registers = reinterpret_cast<lammpsplugin_regfunc>(registrar);
  lammpsplugin_t plugin = {};
  plugin.version = LAMMPS_VERSION;
  plugin.author = "granhom";
  plugin.handle = handle;

  auto add_pair = [&](const char *name, const char *info, lammpsplugin_factory1 *make) {
    plugin.style = "pair";
    plugin.name = name;
    plugin.info = info;
    plugin.creator.v1 = make;
    registers(&plugin, lmp);
  };
  auto add_other = [&](const char *kind, const char *name, const char *info, lammpsplugin_factory2 *make) {
    plugin.style = kind;
    plugin.name = name;
    plugin.info = info;
    plugin.creator.v2 = make;
    registers(&plugin, lmp);
  };
#define PAIR(name, Style, info) add_pair(name, info, pair<Style>);
#define FIX(name, Style, info) add_other("fix", name, info, other<Fix, Style>);
#define COMPUTE(name, Style, info) add_other("compute", name, info, other<Compute, Style>);
  GH_LAMMPS_STYLES(PAIR, FIX, COMPUTE)
#undef PAIR
#undef FIX
#undef COMPUTE
  register_commands(static_cast<LAMMPS *>(lmp));
}
#endif
