/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS pair style granhom/normal: one-sided harmonic normal contact of spheres and disks; the base of
 * granhom/coulomb. */
#ifndef GRANHOM_LAMMPS_PAIR_NORMAL_H
#define GRANHOM_LAMMPS_PAIR_NORMAL_H

#include "engine/lammps/c_mpi.h"

#include "force.h"
#include "pair.h"

#include <string>
#include <vector>

namespace granhom {

class PairNormal : public LAMMPS_NS::Pair {
public:
  explicit PairNormal(LAMMPS_NS::LAMMPS *lmp);
  ~PairNormal() override;
  void compute(int eflag, int vflag) override;
  double single(int i, int j, int itype, int jtype, double rsq, double factor_coul, double factor_lj,
                double &fforce) override;
  void settings(int narg, char **arg) override;
  void coeff(int narg, char **arg) override;
  void init_style() override;
  double init_one(int i, int j) override;
  void write_restart(FILE *fp) override;
  void read_restart(FILE *fp) override;
  void write_data(FILE *fp) override;
  void write_data_all(FILE *fp) override;
  double memory_usage() override;

  /* The pair style of this simulation, normal or coulomb; null: another one, or several in a hybrid. */
  static PairNormal *in_use(const LAMMPS_NS::Force *force);
  /* The same; stops with the reason where there is none or more than one. who: "Fix granhom/relax". */
  static PairNormal *require(LAMMPS_NS::LAMMPS *lmp, const std::string &who);
  double stiffness(int itype, int jtype) const { return E[itype][jtype]; }
  /* True when all pairs of types have the stiffness that is written to *value. */
  bool one_stiffness(double *value) const;
  /* Stops the run: the contact of these two atoms has no direction. */
  [[noreturn]] void centres_coincide(int i, int j);

  /* Of the last compute() on this rank: sum of the normal forces and number of contacts (a contact across
   * ranks counts half on each side); a grain and its own image are left out, they exert no net force. */
  double force_sum = 0, contact_count = 0;

  /* State when the neighbour list was made, for those who must know whether it still holds. */
  long builds = 0;                         /* lists made so far */
  std::vector<double> build_x;             /* 3 per owned atom */
  std::vector<LAMMPS_NS::tagint> build_id; /* per atom, ghosts too */
  double build_cell[6] = {};               /* xprd yprd zprd xy xz yz */
  void cell_now(double cell[6]) const;

  /* A program that moves the atoms itself changes radii and atoms at no time: they are checked at list builds
   * only, else at each evaluation too. */
  void driven_by_program(bool yes) { driven = yes; }

protected:
  double **E = nullptr; /* stiffness of the pairs of types */
  void allocate();
  /* Checks what the neighbour list assumes; true: the list is new. To be called before each evaluation. */
  bool check_list();
  void find_largest();
  void refuse_history();

private:
  double *largest = nullptr;         /* largest radius of each type, of grains to be inserted too */
  std::vector<char> covered;         /* types with contacts of this style */
  std::vector<double> build_largest; /* as `largest`, when the list was made */
  int build_inum = 0;                /* atoms on the list then */
  /* of the last evaluation: time step, and those of its run */
  LAMMPS_NS::bigint seen = -1, run_first = -1, run_last = -1;
  bool driven = false;

  void note_build();
  void check_unprepared();
  void check_radii();
};

} // namespace granhom

#endif
