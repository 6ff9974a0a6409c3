/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS compute granhom/contact/local: the contacts of the pair styles granhom/normal and
 * granhom/coulomb as a local array; the base of granhom/stress and granhom/tangent. */
#ifndef GRANHOM_LAMMPS_COMPUTE_CONTACT_H
#define GRANHOM_LAMMPS_COMPUTE_CONTACT_H

#include "engine/lammps/contact_columns.h"
#include "engine/lammps/c_mpi.h"

#include "compute.h"

namespace granhom {

class PairCoulomb;
class PairNormal;

class ComputeContact : public LAMMPS_NS::Compute {
public:
  /* Columns of a row; from COUPLE on with friction only. */
  enum column { GH_CONTACT_COLUMNS, COLUMNS_NORMAL = COUPLE, COLUMNS = DERIVATIVE + 9 };
  ComputeContact(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);
  ~ComputeContact() override;
  void init() override;
  void compute_local() override;
  void compute_vector() override;
  double memory_usage() override;

protected:
  double **rows = nullptr;
  PairNormal *pair() const;
  PairCoulomb *friction() const; /* null without */
  /* Rows of the contacts on this rank, each contact on one rank; all: of grains outside the group too. */
  int list_contacts(bool all);

private:
  enum { TOTALS = 11 }; /* sxx syy szz sxy sxz syz, energy, contacts; energy_t, dissipated, sliding */
  double totals[TOTALS] = {};
  int rows_allocated = 0, columns;
  PairCoulomb *coulomb = nullptr; /* friction(), while contacts are listed */
  void check_list(const PairNormal &p);
  void refuse_stale(const PairNormal &p);
  bool ahead(int i, int j, const double *l) const;
  bool counted_here(int i, int j, const double *l) const;
  void add(const PairNormal &p, int i, int j, int *count);
  void add_normal(double *row, double E, double e, double d) const;
  void add_friction(double *row, int i, int j, const double *l, double d, double reach) const;
};

} // namespace granhom

#endif
