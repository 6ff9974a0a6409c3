/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS compute granhom/contact/local: the contacts of the pair styles granhom/normal and
 * granhom/coulomb as a local array.
 *
 * It reads the list that the pair style itself computed its forces with, not an occasional list of its own:
 * LAMMPS bins such lists with the bins of the last rebuild, and loses contacts after the box has changed. */
#include "engine/lammps/compute_contact.h"

#include "contact/normal.h"
#include "engine/lammps/fix_history.h"
#include "engine/lammps/pair_coulomb.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <string>

using namespace LAMMPS_NS;
using granhom::ComputeContact;
using granhom::PairCoulomb;
using granhom::PairNormal;

ComputeContact::ComputeContact(LAMMPS *l, int narg, char **arg) : Compute(l, narg, arg) {
  if (narg != 3)
    error->all(FLERR, std::string("Illegal compute ") + style + " command: it takes no arguments");
  columns = dynamic_cast<PairCoulomb *>(PairNormal::in_use(force)) ? COLUMNS : COLUMNS_NORMAL;
  local_flag = 1;
  size_local_cols = columns;
  size_local_rows = 0;
  vector_flag = 1;
  size_vector = TOTALS;
  extvector = 0;
  vector = totals;
}

ComputeContact::~ComputeContact() {
  memory->destroy(rows);
}

PairNormal *ComputeContact::pair() const {
  PairNormal *p = PairNormal::in_use(force);
  return p ? p : PairNormal::require(lmp, std::string("Compute ") + style);
}

PairCoulomb *ComputeContact::friction() const {
  return dynamic_cast<PairCoulomb *>(PairNormal::in_use(force));
}

/* Others look at the number of columns as soon as the compute is there. */
void ComputeContact::init() {
  pair();
  if (columns != (friction() ? COLUMNS : COLUMNS_NORMAL))
    error->all(FLERR, std::string("Compute ") + style +
                          " must be defined after the pair style: granhom/coulomb has more columns");
}

/* Within a run the list, the ghosts and the forces belong together; but where a fix changes the box (fix
 * deform does so at the end of a step) ghosts are left behind, and are brought up to date here. Between runs,
 * commands may have moved atoms or the box: the list still holds every contact if no two atoms can have come
 * nearer than the skin since it was made. */
void ComputeContact::check_list(const PairNormal &p) {
  if (!update->whichflag || !p.builds) refuse_stale(p);
  else if (!domain->box_change) return;
  comm->forward_comm();
  if (coulomb) coulomb->history()->refresh(false);
}

void ComputeContact::refuse_stale(const PairNormal &p) {
  int stale = !p.builds || (coulomb && !(coulomb->history() && coulomb->history()->fresh())) ||
              p.build_id.size() != (std::size_t)atom->nlocal + (std::size_t)atom->nghost ||
              !std::equal(p.build_id.begin(), p.build_id.end(), atom->tag);
  double mine[2] = {(double)stale, 0}, all[2];
  if (!stale)
    for (int i = 0; i < atom->nlocal; i++) {
      double r2 = 0;
      for (int k = 0; k < 3; k++) r2 += std::pow(atom->x[i][k] - p.build_x[3 * (std::size_t)i + k], 2);
      mine[1] = std::max(mine[1], r2);
    }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, world);
  double cell[6], change = 0;
  p.cell_now(cell);
  const double *old = p.build_cell;
  for (int k = 0; k < 3; k++) { /* an image moves by its number of cells times the change of the cell */
    double images =
        domain->periodicity[k] ? std::ceil(comm->cutghost[k] / (domain->triclinic ? 1 : old[k])) : 0;
    double tilt = k == 0   ? 0
                  : k == 1 ? std::fabs(cell[3] - old[3])
                           : std::hypot(cell[4] - old[4], cell[5] - old[5]);
    change += images * std::hypot(cell[k] - old[k], tilt);
  }
  if (all[0] != 0 || 2 * std::sqrt(all[1]) + change > neighbor->skin * (1 + 1e-9))
    error->all(FLERR,
               std::string("Compute ") + style +
                   ": atoms or box changed since the last run by more than the neighbor skin, or there was "
                   "no run yet: use run 0 first");
}

/* Of a grain's two images on opposite sides, the one ahead in the order z, y, x of the lattice vectors. */
bool ComputeContact::ahead(int i, int j, const double *l) const {
  if (coulomb) {
    int k[2];
    coulomb->history()->image_n(i, j, k);
    return k[1] != 0 ? k[1] > 0 : k[0] > 0;
  }
  double kz = domain->zperiodic ? std::round(l[2] / domain->zprd) : 0;
  if (kz != 0) return kz > 0;
  double ky = domain->yperiodic ? std::round(l[1] / domain->yprd) : 0;
  if (ky != 0) return ky > 0;
  return l[0] > 0;
}

/* With newton off a contact with a ghost is listed from both sides. */
bool ComputeContact::counted_here(int i, int j, const double *l) const {
  if (j < atom->nlocal || force->newton_pair) return true;
  return atom->tag[i] == atom->tag[j] ? ahead(i, j, l) : atom->tag[i] < atom->tag[j];
}

/* From the branch vector in the row: normal force, energy, second derivative. */
void ComputeContact::add_normal(double *r, double E, double e, double d) const {
  const double factor = gh_normal_factor(E, e, d);
  for (int k = 0; k < 3; k++) r[FX + k] = factor * r[LX + k];
  r[OVERLAP] = e;
  r[ENERGY] = gh_normal_energy(E, e);
  std::fill(r + HXX, r + columns, 0.0);
  if (domain->dimension == 3) {
    gh_normal_hessian(E, e, d, r + LX, 3, r + HXX);
  } else {
    double h[3];
    gh_normal_hessian(E, e, d, r + LX, 2, h);
    r[HXX] = h[0];
    r[HXY] = h[1];
    r[HYY] = h[2];
  }
}

void ComputeContact::add_friction(double *r, int i, int j, const double *l, double d, double reach) const {
  PairCoulomb::Contact c;
  coulomb->evaluate(i, j, l, d, reach, &c);
  r[FX] = c.result.f[0];
  r[FY] = c.result.f[1];
  r[COUPLE] = c.result.couple;
  r[SLIP_FORCE] = c.result.force;
  r[GAMMA] = c.result.gamma;
  r[GAMMA_PL] = c.result.gamma_pl;
  r[ALPHA] = c.result.alpha;
  r[SLIDES] = c.result.slides != 0;
  r[KX] = c.k[0];
  r[KY] = c.k[1];
  r[ENERGY_T] = c.energy();
  r[DISSIPATED] = c.dissipated();
  gh_coulomb_derivative(c.law, &c.step, &c.result, r + DERIVATIVE);
}

void ComputeContact::add(const PairNormal &p, int i, int j, int *count) {
  const double *xi = atom->x[i], *xj = atom->x[j];
  const double l[3] = {xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2]};
  const double d2 = l[0] * l[0] + l[1] * l[1] + l[2] * l[2], reach = atom->radius[i] + atom->radius[j];
  if (d2 > 1.000001 * reach * reach) return; /* the root decides near the limit, as in the pair style */
  const double d = std::sqrt(d2), e = reach - d;
  if (e < 0 || !counted_here(i, j, l)) return;
  if (!(d > 0)) const_cast<PairNormal &>(p).centres_coincide(i, j);
  if (*count == rows_allocated)
    memory->grow(rows, rows_allocated += 256 + rows_allocated / 2, columns, "contact:rows");
  double *r = rows[(*count)++];
  const bool swap = atom->tag[i] == atom->tag[j] ? !ahead(i, j, l) : atom->tag[i] > atom->tag[j];
  r[TAG1] = atom->tag[swap ? j : i];
  r[TAG2] = atom->tag[swap ? i : j];
  for (int k = 0; k < 3; k++) r[LX + k] = swap ? -l[k] : l[k];
  add_normal(r, p.stiffness(atom->type[i], atom->type[j]), e, d);
  if (coulomb) add_friction(r, i, j, l, d, reach);
}

int ComputeContact::list_contacts(bool all) {
  const PairNormal &p = *pair();
  coulomb = friction();
  check_list(p);
  int count = 0;
  for (int ii = 0; ii < p.list->inum; ii++) {
    int i = p.list->ilist[ii];
    if (!all && !(atom->mask[i] & groupbit)) continue;
    for (int jj = 0; jj < p.list->numneigh[i]; jj++) {
      int j = p.list->firstneigh[i][jj] & NEIGHMASK;
      if (all || atom->mask[j] & groupbit) add(p, i, j, &count);
    }
  }
  return count;
}

void ComputeContact::compute_local() {
  invoked_local = update->ntimestep;
  size_local_rows = list_contacts(false);
  array_local = rows;
}

/* Homogenised stress (5.3-5.6) as Cauchy stress: sum of f (x) l over the volume of the box, pressure
 * negative. */
void ComputeContact::compute_vector() {
  static const int pair_of[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  if (invoked_local != update->ntimestep) compute_local();
  invoked_vector = update->ntimestep;
  double mine[TOTALS] = {0};
  for (int r = 0; r < size_local_rows; r++) {
    for (int k = 0; k < 6; k++) mine[k] += rows[r][FX + pair_of[k][0]] * rows[r][LX + pair_of[k][1]];
    mine[6] += rows[r][ENERGY];
    if (columns < COLUMNS) continue;
    mine[8] += rows[r][ENERGY_T];
    mine[9] += rows[r][DISSIPATED];
    mine[10] += rows[r][SLIDES];
  }
  mine[7] = size_local_rows;
  MPI_Allreduce(mine, totals, TOTALS, MPI_DOUBLE, MPI_SUM, world);
  const double volume = domain->xprd * domain->yprd * (domain->dimension == 3 ? domain->zprd : 1);
  for (int k = 0; k < 6; k++) totals[k] /= volume;
}

double ComputeContact::memory_usage() {
  return (double)rows_allocated * columns * sizeof(double);
}
