/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS compute granhom/stress: the homogenised stress (5.3-5.6), as Cauchy stress: the sum over all
 * contacts of force (x) branch vector over the volume of the box. */
#include "engine/lammps/compute_stress.h"

#include "domain.h"
#include "error.h"
#include "update.h"

#include <string>

using namespace LAMMPS_NS;
using granhom::ComputeStress;

ComputeStress::ComputeStress(LAMMPS *l, int narg, char **arg) : ComputeContact(l, narg, arg) {
  if (igroup)
    error->all(FLERR, std::string("Compute granhom/stress is of the whole box: it wants the group all"));
  local_flag = size_local_cols = 0;
  size_vector = 9;
  vector = stress;
}

void ComputeStress::compute_vector() {
  invoked_vector = update->ntimestep;
  double mine[9] = {0};
  const int count = list_contacts(true);
  for (int r = 0; r < count; r++)
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) mine[3 * a + b] += rows[r][FX + a] * rows[r][LX + b];
  MPI_Allreduce(mine, stress, 9, MPI_DOUBLE, MPI_SUM, world);
  const double volume = domain->xprd * domain->yprd * (domain->dimension == 3 ? domain->zprd : 1);
  for (double &s : stress) s /= volume;
}
