/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS pair style granhom/normal: one-sided harmonic normal contact of spheres and disks.
 *
 * LAMMPS's sign convention: del = x_i - x_j = -l, and fpair * del is the force on i. */
#include "engine/lammps/pair_normal.h"

#include "engine/lammps/guard.h"

#include "contact/normal.h"
#include "engine/lammps/fix_history.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "lammps.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

using namespace LAMMPS_NS;
using granhom::PairNormal;

PairNormal::PairNormal(LAMMPS *l) : Pair(l) {
  writedata = 1;
}

PairNormal::~PairNormal() {
  if (copymode || !allocated) return;
  memory->destroy(setflag);
  memory->destroy(cutsq);
  memory->destroy(E);
  memory->destroy(largest);
}

void PairNormal::allocate() {
  allocated = 1;
  int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  memory->create(E, n, n, "pair:E");
  memory->create(largest, n, "pair:largest");
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      setflag[i][j] = 0;
      cutsq[i][j] = E[i][j] = 0;
    }
}

void PairNormal::settings(int narg, char **) {
  if (narg) error->all(FLERR, std::string("Illegal pair_style command: granhom/normal takes no arguments"));
}

void PairNormal::coeff(int narg, char **arg) {
  if (narg != 3)
    error->all(FLERR,
               std::string("Incorrect args for pair coefficients: granhom/normal wants pair_coeff I J E"));
  if (!allocated) allocate();
  int ilo, ihi, jlo, jhi;
  utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
  utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);
  double e = utils::numeric(FLERR, arg[2], false, lmp);
  if (!(e > 0) || !std::isfinite(e))
    error->all(FLERR,
               std::string("Normal stiffness of pair granhom/normal must be positive and finite, not ") +
                   arg[2]);
  int count = 0;
  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++, count++) {
      E[i][j] = E[j][i] = e;
      setflag[i][j] = 1;
    }
  if (!count) error->all(FLERR, std::string("Incorrect args for pair coefficients"));
}

/* Number of pair styles of that name; several are sub-styles of a hybrid. */
static int count_styles(Force *force, const char *name) {
  if (force->pair_match(name, 1)) return 1;
  int n = 0;
  while (force->pair_match(name, 1, n + 1)) n++;
  return n;
}

PairNormal *PairNormal::in_use(const Force *force) {
  if (auto *only = dynamic_cast<PairNormal *>(force->pair)) return only;
  auto *f = const_cast<Force *>(force);
  Pair *normal = f->pair_match("granhom/normal", 1), *coulomb = f->pair_match("granhom/coulomb", 1);
  if (count_styles(f, "granhom/normal") + count_styles(f, "granhom/coulomb") != 1) return nullptr;
  return dynamic_cast<PairNormal *>(normal ? normal : coulomb);
}

PairNormal *PairNormal::require(LAMMPS *lmp, const std::string &who) {
  PairNormal *pair = in_use(lmp->force);
  if (pair) return pair;
  const int normal = count_styles(lmp->force, "granhom/normal"),
            coulomb = count_styles(lmp->force, "granhom/coulomb");
  if (normal + coulomb == 0)
    lmp->error->all(FLERR, who + " requires one of the pair styles granhom/normal and granhom/coulomb");
  lmp->error->all(FLERR, who + " requires a single pair style of granhom, but pair_style " +
                             lmp->force->pair_style + " has " + std::to_string(normal) +
                             " granhom/normal and " + std::to_string(coulomb) +
                             " granhom/coulomb: give all types to one of them (granhom/coulomb with mu = 0 "
                             "is free of friction)");
  return nullptr;
}

void PairNormal::init_style() {
  if (!atom->radius_flag) error->all(FLERR, std::string("Pair granhom/normal requires atom style sphere"));
  refuse_history();
  find_largest();
  neighbor->request(this, instance_me);
}

/* LAMMPS would drop what a restart file states of friction with a warning. A fix of that name takes it up, if
 * there is any. */
void PairNormal::refuse_history() {
  if (!modify->nfix_restart_global || modify->find_fix(FixHistory::ID) >= 0) return;
  Fix *probe = modify->add_fix(std::string(FixHistory::ID) + " all granhom/history");
  const bool there = probe->restart_reset;
  modify->delete_fix(FixHistory::ID);
  if (there)
    error->all(FLERR, std::string("The restart file holds the history of pair granhom/coulomb, which pair "
                                  "granhom/normal would drop"));
}

/* Largest radius of grains of this type that fixes will insert (fix pour, fix deposit), as LAMMPS's granular
 * styles ask for it. */
static double inserted_radius(Modify *modify, int type) {
  double most = 0;
  for (int k = 0; k < modify->nfix; k++) {
    int dim = type; /* the type goes in, the dimension of the answer comes out */
    auto *radius = static_cast<double *>(modify->fix[k]->extract("radius", dim));
    if (radius && dim == 0) most = std::max(most, *radius);
  }
  return most;
}

void PairNormal::find_largest() {
  int n = atom->ntypes + 1;
  std::vector<double> mine(n, 0.0);
  for (int i = 0; i < atom->nlocal; i++) mine[atom->type[i]] = std::max(mine[atom->type[i]], atom->radius[i]);
  for (int t = 1; t < n; t++) mine[t] = std::max(mine[t], inserted_radius(modify, t));
  MPI_Allreduce(mine.data(), largest, n, MPI_DOUBLE, MPI_MAX, world);
  covered.assign(n, 0);
}

double PairNormal::init_one(int i, int j) {
  if (!setflag[i][j]) E[i][j] = 0.5 * (E[i][i] + E[j][j]);
  E[j][i] = E[i][j];
  covered[i] = covered[j] = 1;
  return largest[i] + largest[j];
}

bool PairNormal::one_stiffness(double *value) const {
  *value = E[1][1];
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = 1; j <= atom->ntypes; j++)
      if (E[i][j] != *value) return false;
  return true;
}

void PairNormal::cell_now(double cell[6]) const {
  const double c[6] = {domain->xprd, domain->yprd, domain->zprd, domain->xy, domain->xz, domain->yz};
  std::copy(c, c + 6, cell);
}

void PairNormal::note_build() {
  builds++;
  const double *x = atom->nlocal ? atom->x[0] : nullptr;
  build_x.assign(x, x + 3 * (std::size_t)atom->nlocal);
  build_id.assign(atom->tag, atom->tag + atom->nlocal + atom->nghost);
  build_largest.assign(largest, largest + atom->ntypes + 1);
  build_inum = list->inum;
  cell_now(build_cell);
}

/* The first evaluation of a run without setup (pre no) may use the list of the run before, whatever commands
 * between them have initialised. */
bool PairNormal::check_list() {
  if (covered.empty())
    error->all(FLERR, "Pair " + std::string(force->pair_style) +
                          ": a run with pre no cannot follow the command pair_style: use pre yes");
  const bigint step = update->ntimestep;
  const bool built = neighbor->ago == 0, prepared = run_first == update->firststep &&
                                                    run_last == update->laststep &&
                                                    (step == seen || step == seen + 1);
  seen = step;
  run_first = update->firststep;
  run_last = update->laststep;
  if (built) note_build();
  else if (!prepared) check_unprepared();
  if (built || !driven) check_radii();
  return built;
}

/* The cutoff of a type follows from its largest radius at the start of the run. */
void PairNormal::check_radii() {
  const double *radius = atom->radius;
  const int *type = atom->type;
  for (int i = 0; i < atom->nlocal; i++) {
    if (radius[i] <= build_largest[type[i]] || !covered[type[i]]) continue;
    char text[400];
    snprintf(text, sizeof text,
             "Pair %s: the radius %g of atom %ld exceeds %g, the largest of its type %d at the start of the "
             "run and of what fixes insert: contacts beyond the cutoff would be missed. Change radii and "
             "types between runs (with setup), or let the type have an atom of the largest radius from the "
             "start",
             force->pair_style, radius[i], (long)atom->tag[i], build_largest[type[i]], type[i]);
    error->one(FLERR, std::string(text));
  }
}

/* Commands before a run with `pre no` may have changed what the list is made of: those that need ghosts make
 * them once more, in other places, and LAMMPS empties its lists where it initialises with other ones. Two
 * atoms that have come nearer by more than the skin may be in contact without being on the list. */
void PairNormal::check_unprepared() {
  const std::string reason = "Pair " + std::string(force->pair_style) + ": a run with pre no cannot follow ";
  const std::size_t nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  if (build_id.size() != nall || build_x.size() != 3 * nlocal || build_inum != list->inum ||
      !std::equal(build_id.begin(), build_id.end(), atom->tag))
    error->one(FLERR, reason +
                          "commands that add, remove, reorder or renumber atoms or renew their ghosts: use "
                          "pre yes");
  double most = 0, second = 0;
  for (std::size_t i = 0; i < nlocal; i++) {
    double d2 = 0;
    for (std::size_t k = 0; k < 3; k++) d2 += std::pow(atom->x[i][k] - build_x[3 * i + k], 2);
    second = std::max(second, std::min(most, d2));
    most = std::max(most, d2);
  }
  if (std::sqrt(most) + std::sqrt(second) > neighbor->skin * (1 + 1e-9))
    error->one(FLERR, reason + "commands that move atoms by more than the neighbor skin: use pre yes");
}

void PairNormal::centres_coincide(int i, int j) {
  error->one(FLERR, "Centres of atoms " + std::to_string(atom->tag[i]) + " and " +
                        std::to_string(atom->tag[j]) + GRANHOM_COINCIDE);
}

void PairNormal::compute(int eflag, int vflag) {
  ev_init(eflag, vflag);
  check_list();

  const double *const *x = atom->x;
  double **f = atom->f;
  const double *radius = atom->radius;
  const int *type = atom->type;
  const tagint *tag = atom->tag;
  const int nlocal = atom->nlocal, newton = force->newton_pair;
  double sum = 0, count = 0;

  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    const int *jlist = list->firstneigh[i], jnum = list->numneigh[i];
    const double xi[3] = {x[i][0], x[i][1], x[i][2]}, ri = radius[i];
    double fi[3] = {0, 0, 0};
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      const double del[3] = {xi[0] - x[j][0], xi[1] - x[j][1], xi[2] - x[j][2]};
      const double rsq = del[0] * del[0] + del[1] * del[1] + del[2] * del[2], reach = ri + radius[j];
      if (rsq > 1.000001 * reach * reach) continue; /* the root decides near the limit, as in the kernel */
      const double d = std::sqrt(rsq), e = reach - d;
      if (e < 0) continue;
      if (!(d > 0)) centres_coincide(i, j);
      const double stiff = E[type[i]][type[j]], fpair = -gh_normal_factor(stiff, e, d);
      for (int k = 0; k < 3; k++) fi[k] += fpair * del[k];
      if (newton || j < nlocal)
        for (int k = 0; k < 3; k++) f[j][k] -= fpair * del[k];
      if (tag[i] != tag[j]) {
        const double weight = newton || j < nlocal ? 1 : 0.5;
        sum += weight * stiff * e;
        count += weight;
      }
      if (evflag)
        ev_tally(i, j, nlocal, newton, gh_normal_energy(stiff, e), 0, fpair, del[0], del[1], del[2]);
    }
    for (int k = 0; k < 3; k++) f[i][k] += fi[k];
  }
  force_sum = sum;
  contact_count = count;
  if (vflag_fdotr) virial_fdotr_compute();
}

double PairNormal::single(int i, int j, int itype, int jtype, double rsq, double, double, double &fforce) {
  const double d = std::sqrt(rsq), e = atom->radius[i] + atom->radius[j] - d;
  fforce = 0;
  if (e < 0) return 0;
  if (!(d > 0)) centres_coincide(i, j);
  fforce = -gh_normal_factor(E[itype][jtype], e, d);
  return gh_normal_energy(E[itype][jtype], e);
}

void PairNormal::write_restart(FILE *fp) {
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      fwrite(&setflag[i][j], sizeof(int), 1, fp);
      fwrite(&E[i][j], sizeof(double), 1, fp);
    }
}

void PairNormal::read_restart(FILE *fp) {
  allocate();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      if (comm->me == 0) {
        utils::sfread(FLERR, &setflag[i][j], sizeof(int), 1, fp, nullptr, error);
        utils::sfread(FLERR, &E[i][j], sizeof(double), 1, fp, nullptr, error);
      }
      MPI_Bcast(&setflag[i][j], 1, MPI_INT, 0, world);
      MPI_Bcast(&E[i][j], 1, MPI_DOUBLE, 0, world);
      E[j][i] = E[i][j];
    }
}

void PairNormal::write_data(FILE *fp) {
  for (int i = 1; i <= atom->ntypes; i++) fprintf(fp, "%d %.17g\n", i, E[i][i]);
}

void PairNormal::write_data_all(FILE *fp) {
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) fprintf(fp, "%d %d %.17g\n", i, j, E[i][j]);
}

double PairNormal::memory_usage() {
  return Pair::memory_usage() + (double)covered.capacity() + (double)build_x.capacity() * sizeof(double) +
         (double)build_id.capacity() * sizeof(tagint);
}
