/* LAMMPS compute granhom/contact/local: the contacts of pair style granhom/normal as a local array.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_LAMMPS_COMPUTE_CONTACT_H
#define GRANHOM_LAMMPS_COMPUTE_CONTACT_H

#include "engine/lammps/c_mpi.h"

#include "compute.h"

namespace granhom {

class PairNormal;

class ComputeContact : public LAMMPS_NS::Compute {
public:
  /* Columns of a row. */
  enum column { TAG1, TAG2, LX, LY, LZ, FX, FY, FZ, OVERLAP, ENERGY, HXX, HXY, HXZ, HYY, HYZ, HZZ, COLUMNS };
  ComputeContact(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);
  ~ComputeContact() override;
  void init() override;
  void compute_local() override;
  void compute_vector() override;
  double memory_usage() override;

private:
  enum { TOTALS = 8 }; /* sxx syy szz sxy sxz syz, energy, number of contacts */
  double totals[TOTALS] = {};
  int rows_allocated = 0;
  double **rows = nullptr;
  PairNormal *pair() const;
  void check_list(const PairNormal &p);
  bool ahead(const double *l) const;
  bool counted_here(int i, int j, const double *l) const;
  void add(const PairNormal &p, int i, int j, int *count);
};

} // namespace granhom

#endif
