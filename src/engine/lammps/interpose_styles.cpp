/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom's styles in each instance of LAMMPS.
 *
 * LAMMPS::post_create(), which LAMMPS calls for a new instance and after each `clear`, is replaced (how:
 * interpose.cpp) by one that registers our styles too: in the program granhom, and in LAMMPS's own program
 * where granhomplugin.so is preloaded. */
#include "engine/lammps/c_mpi.h"

#include "engine/lammps/interpose.h"
#include "engine/lammps/styles.h"

#include "lammps.h"

#include <dlfcn.h>

using LAMMPS_NS::LAMMPS;

/* Seen by liblammps.so, whatever is hidden otherwise. */
__attribute__((visibility("default"))) void LAMMPS::post_create() {
  using function = void (*)(LAMMPS *);
  auto original = reinterpret_cast<function>(dlsym(RTLD_NEXT, "_ZN9LAMMPS_NS6LAMMPS11post_createEv"));
  if (original) original(this);
  granhom::register_styles(this);
}

const char *granhom::advice_on_linking() {
  return "the calls within liblammps.so cannot be replaced (is it linked with -Bsymbolic?)";
}
