/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS compute granhom/tangent: the homogenised tangent. */
#ifndef GRANHOM_LAMMPS_COMPUTE_TANGENT_H
#define GRANHOM_LAMMPS_COMPUTE_TANGENT_H

#include "engine/lammps/compute_contact.h"
#include "engine/lammps/condense.h"

#include <vector>

namespace granhom {

class ComputeTangent : public ComputeContact {
public:
  ComputeTangent(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);
  ~ComputeTangent() override;
  void init() override;
  void compute_array() override;
  double memory_usage() override;

private:
  std::vector<double> grains, contacts; /* on rank 0: of all ranks */
  void gather(std::vector<double> &mine, std::vector<double> &all) const;
  void gather_grains();
  void gather_contacts();
  Packing packing() const;
};

} // namespace granhom

#endif
