/* SPDX-License-Identifier: GPL-2.0-or-later */
/* FIRE on a list of neighbour pairs; used by the native engine and by LAMMPS's fix granhom/relax. */
#ifndef GRANHOM_ENGINE_RELAX_FIRE_H
#define GRANHOM_ENGINE_RELAX_FIRE_H

#include "engine/relax/relax_friction.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As gh_relax_run, with FIRE in the place of damped central differences (E. Bitzek, P. Koskinen, F. Gähler,
 * M. Moseler, P. Gumbsch, Structural Relaxation Made Simple, Phys. Rev. Lett. 97, 170201, 2006): nothing is
 * damped; velocities are turned towards the forces, and set to zero where the power f.v is negative. Its
 * largest time step is that of gh_relax_run, a tenth of which it begins with. */
gh_relax_end gh_relax_fire(gh_relax_state *s, double tolerance, double floor, long max_steps,
                           double *residual, double *mean_force, long *steps);
/* As gh_relax_friction_run: rotations are unknowns too, r theta/sqrt(2) with the force sqrt(2) m/r. Forces
 * with friction have no potential, and FIRE promises nothing for them. */
gh_relax_end gh_relax_friction_fire(gh_relax_friction *s, double tolerance, double floor, long max_steps,
                                    double *residual, double *mean_force, long *steps);

#ifdef __cplusplus
}
#endif
#endif
