/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS compute granhom/tangent: the homogenised tangent. */
#include "engine/lammps/compute_tangent.h"

#include "engine/lammps/pair_coulomb.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <climits>
#include <string>

using namespace LAMMPS_NS;
using granhom::ComputeTangent;
using granhom::Packing;

enum { PER_GRAIN = 3, PER_CONTACT = 13 }; /* tag radius free; tags, l, derivative */

ComputeTangent::ComputeTangent(LAMMPS *l, int narg, char **arg) : ComputeContact(l, narg, arg) {
  if (domain->dimension != 2)
    error->all(FLERR, std::string("Compute granhom/tangent requires a 2d simulation"));
  local_flag = size_local_cols = vector_flag = size_vector = 0;
  vector = nullptr;
  array_flag = 1;
  size_array_rows = size_array_cols = 4;
  extarray = 0;
  memory->create(array, 4, 4, "tangent:array");
}

ComputeTangent::~ComputeTangent() {
  memory->destroy(array);
}

void ComputeTangent::init() {
  ComputeContact::init();
  if (domain->dimension == 2) return;
  error->all(FLERR, std::string("Compute granhom/tangent requires a 2d simulation"));
}

void ComputeTangent::gather(std::vector<double> &mine, std::vector<double> &all) const {
  if (mine.size() > INT_MAX) error->one(FLERR, std::string("Too many contacts for compute granhom/tangent"));
  int n = (int)mine.size();
  std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, world);
  for (int r = 1; r < comm->nprocs; r++) starts[r] = starts[r - 1] + counts[r - 1];
  if (comm->me == 0) all.resize((std::size_t)starts.back() + counts.back());
  MPI_Gatherv(mine.data(), n, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, 0, world);
}

void ComputeTangent::gather_grains() {
  std::vector<double> mine;
  for (int i = 0; i < atom->nlocal; i++)
    for (double value : {(double)atom->tag[i], atom->radius[i], (double)((atom->mask[i] & groupbit) != 0)})
      mine.push_back(value);
  gather(mine, grains);
}

void ComputeTangent::gather_contacts() {
  std::vector<double> mine;
  const bool friction_too = friction() != nullptr;
  const int count = list_contacts(true);
  for (int r = 0; r < count; r++) {
    const double *row = rows[r];
    const double normal[9] = {row[HXX], row[HXY], 0, row[HXY], row[HYY], 0, 0, 0, 0},
                 *d = friction_too ? row + DERIVATIVE : normal;
    for (int k : {TAG1, TAG2, LX, LY}) mine.push_back(row[k]);
    mine.insert(mine.end(), d, d + 9);
  }
  gather(mine, contacts);
}

/* Grains in the order of their ids, so that the result does not depend on who had them. */
Packing ComputeTangent::packing() const {
  Packing p;
  const std::size_t n = grains.size() / PER_GRAIN, m = contacts.size() / PER_CONTACT;
  std::vector<std::size_t> order(n);
  for (std::size_t g = 0; g < n; g++) order[g] = g;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return grains[PER_GRAIN * a] < grains[PER_GRAIN * b]; });
  std::vector<double> tags(n);
  for (std::size_t g = 0; g < n; g++) {
    const double *grain = &grains[PER_GRAIN * order[g]];
    tags[g] = grain[0];
    p.radius.push_back(grain[1]);
    p.free.push_back(grain[2] != 0);
  }
  auto grain_of = [&](double tag) {
    return (int)(std::lower_bound(tags.begin(), tags.end(), tag) - tags.begin());
  };
  for (std::size_t c = 0; c < m; c++) {
    const double *row = &contacts[PER_CONTACT * c];
    Packing::Contact contact = {grain_of(row[0]), grain_of(row[1]), {row[2], row[3]}, {}};
    std::copy_n(row + 4, 9, contact.d);
    p.contacts.push_back(contact);
  }
  std::sort(p.contacts.begin(), p.contacts.end(), [](const Packing::Contact &a, const Packing::Contact &b) {
    if (a.i != b.i) return a.i < b.i;
    if (a.j != b.j) return a.j < b.j;
    return a.l[1] != b.l[1] ? a.l[1] < b.l[1] : a.l[0] < b.l[0];
  });
  p.volume = domain->xprd * domain->yprd;
  return p;
}

void ComputeTangent::compute_array() {
  invoked_array = update->ntimestep;
  gather_grains();
  gather_contacts();
  int failed = 0;
  if (comm->me == 0) {
    Packing p = packing();
    const PairCoulomb *c = friction();
    p.friction = c != nullptr;
    p.turns = c && c->turning();
    failed = !condense(p, array[0]);
  }
  MPI_Bcast(&failed, 1, MPI_INT, 0, world);
  if (failed)
    error->all(FLERR, std::string("Compute granhom/tangent: the stiffness matrix could not be factorised"));
  MPI_Bcast(array[0], 16, MPI_DOUBLE, 0, world);
}

double ComputeTangent::memory_usage() {
  return ComputeContact::memory_usage() +
         (double)((grains.capacity() + contacts.capacity()) * sizeof(double));
}
