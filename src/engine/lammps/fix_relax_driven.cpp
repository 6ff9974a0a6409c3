/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Fix granhom/relax driven by a program: the cell is set, lists are made when they are needed. */
#include "engine/lammps/fix_relax.h"

#include "engine/lammps/fix_history.h"
#include "engine/lammps/pair_coulomb.h"
#include "engine/lammps/versions.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "output.h"
#include "timer.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <climits>
#include <cstdio>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using namespace FixConst;
using granhom::FixRelax;
using granhom::PairCoulomb;
using granhom::PairNormal;

void FixRelax::drive(bool periodic) {
  driven = true;
  active = false;
  cluster = !periodic;
  box_change = BOX_CHANGE_X | BOX_CHANGE_Y | (periodic ? BOX_CHANGE_XY : 0);
}

/* Neighbours again: pre_exchange brings grains back into the box, or the box to the grains. */
void FixRelax::renew_lists() {
  modify->pre_exchange();
  if (domain->triclinic) domain->x2lamda(atom->nlocal);
  domain->pbc();
  domain->reset_box();
  comm->setup();
  neighbor->setup_bins();
  comm->exchange();
  comm->borders();
  if (domain->triclinic) domain->lamda2x(atom->nlocal + atom->nghost);
  modify->pre_neighbor();
  neighbor->build(1);
  modify->post_neighbor();
}

/* Newton's third law is off and nothing is tallied: no sums over ghosts, no energies. */
void FixRelax::advance() {
  update->ntimestep++;
  modify->initial_integrate(0);
  modify->post_integrate();
  if (neighbor->decide()) renew_lists();
  else comm->forward_comm();
  const std::size_t bytes = 3 * sizeof(double) * (std::size_t)atom->nlocal;
  std::memset(atom->f[0], 0, bytes);
  std::memset(atom->torque[0], 0, bytes);
  modify->pre_force(0);
  force->pair->compute(0, 0);
  modify->post_force(0);
  modify->final_integrate();
}

void FixRelax::tell(guard_relaxed *r) const {
  r->residual = residual;
  r->mean_force = mean_force;
  r->steps = steps;
  r->pairs = evaluated;
  r->converged = ended == CONVERGED || ended == UNJAMMED;
  r->least_damping = watched.least;
}

void FixRelax::set_cell(double lx, double ly, double xy) {
  const double low[3] = {0, 0, domain->boxlo[2]}, high[3] = {lx, ly, domain->boxhi[2]};
  std::copy(low, low + 3, domain->boxlo);
  std::copy(high, high + 3, domain->boxhi);
  domain->xy = xy;
  domain->set_global_box();
  domain->set_local_box();
  rebuild_next();
}

void FixRelax::rebuild_next() {
  next_reneighbor = update->ntimestep + 1;
}

void FixRelax::relax_next(const gh_relax_options &o, const gh_relax_frame *with) {
  frame = with;
  tolerance = o.tolerance;
  floor_force = o.floor;
  max_steps = o.max_steps;
  by_fire = o.method == GH_RELAX_FIRE;
  first_least = o.least_damping;
  patience = o.patience;
  active = fresh = true;
  ended = RUNNING;
}

long FixRelax::builds() const {
  return pair ? pair->builds : 0;
}

void FixRelax::setup_pre_exchange() {
  pre_exchange();
}

/* LAMMPS wraps by one period at most and loses what is farther out. */
void FixRelax::pre_exchange() {
  if (!driven) return;
  if (cluster) {
    surround();
    return;
  }
  for (int i = 0; i < atom->nlocal; i++) {
    double s[3];
    domain->x2lamda(atom->x[i], s);
    if (s[0] < -0.5 || s[0] > 1.5 || s[1] < -0.5 || s[1] > 1.5) domain->remap(atom->x[i], atom->image[i]);
  }
}

/* A cluster has no box of its own: LAMMPS's box follows the grains, so that none is ever outside. */
void FixRelax::surround() {
  double room = pair->cutforce + neighbor->skin;
  for (int k = 0; k < 2; k++) {
    double low = atom->x[0][k], high = low;
    for (int i = 1; i < atom->nlocal; i++) {
      low = std::min(low, atom->x[i][k]);
      high = std::max(high, atom->x[i][k]);
    }
    domain->boxlo[k] = low - room;
    domain->boxhi[k] = high + room;
  }
}
