/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS compute granhom/stress: the homogenised stress. */
#ifndef GRANHOM_LAMMPS_COMPUTE_STRESS_H
#define GRANHOM_LAMMPS_COMPUTE_STRESS_H

#include "engine/lammps/compute_contact.h"

namespace granhom {

class ComputeStress : public ComputeContact {
public:
  ComputeStress(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);
  void compute_vector() override;

private:
  double stress[9] = {}; /* row-major */
};

} // namespace granhom

#endif
