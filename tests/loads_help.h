/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Loads as the tests of the macro problem set them. */
#ifndef GRANHOM_TESTS_LOADS_HELP_H
#define GRANHOM_TESTS_LOADS_HELP_H

#include "granhom/macro.h"
#include "help.h"

/* Nodes of the set of this name move by `value` in direction `dir`. */
static inline void loads_hold(gh_context *ctx, gh_loads *loads, const gh_mesh *mesh, const char *set, int dir,
                              double value) {
  OK(gh_loads_displace(loads, gh_mesh_find(mesh, set), dir, value));
}

/* A footing on this set under a force at the eccentricity. */
static inline void loads_put(gh_context *ctx, gh_loads *loads, const gh_mesh *mesh, int set,
                             double eccentricity, double fx, double fy) {
  double at[2], force[2] = {fx, fy};
  gh_footing_point(mesh, set, eccentricity, at);
  OK(gh_loads_footing(loads, set, at, force));
}

#endif
