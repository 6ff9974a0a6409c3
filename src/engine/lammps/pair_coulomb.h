/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS pair style granhom/coulomb: normal contact and Coulomb friction of disks by return mapping. */
#ifndef GRANHOM_LAMMPS_PAIR_COULOMB_H
#define GRANHOM_LAMMPS_PAIR_COULOMB_H

#include "engine/lammps/pair_normal.h"

#include "contact/coulomb.h"

#include <vector>

namespace granhom {

class FixHistory;

class PairCoulomb : public PairNormal {
public:
  explicit PairCoulomb(LAMMPS_NS::LAMMPS *lmp);
  ~PairCoulomb() override;
  void compute(int eflag, int vflag) override;
  double single(int i, int j, int itype, int jtype, double rsq, double factor_coul, double factor_lj,
                double &fforce) override;
  void settings(int narg, char **arg) override;
  void coeff(int narg, char **arg) override;
  void init_style() override;
  double init_one(int i, int j) override;
  void write_restart(FILE *fp) override;
  void read_restart(FILE *fp) override;
  void write_restart_settings(FILE *fp) override;
  void read_restart_settings(FILE *fp) override;
  void write_data(FILE *fp) override;
  void write_data_all(FILE *fp) override;
  double memory_usage() override;

  /* A closed contact, seen from the grain with the lower id; from grain i when a grain touches itself. */
  struct Contact {
    const gh_contact_law *law;
    gh_coulomb_step step;
    gh_coulomb_result result;
    int k[2];                  /* image of the grain with the higher id */
    bool swapped;              /* atom i has the higher id */
    int record;                /* of atom i at n; -1: none */
    double energy() const;     /* (7.6) */
    double dissipated() const; /* of this increment (7.13) */
  };
  /* The contact of owned atom i with atom j at l = x_j - x_i, which overlap: d = |l| <= reach. */
  void evaluate(int i, int j, const double *l, double d, double reach, Contact *c) const;

  /* Coefficient of friction of owned atom i and atom j, which touch or nearly do, with proportional hardening. */
  double coefficient(int i, int j, const double *l, double d2) const;

  const gh_contact_law &law(int itype, int jtype) const { return laws[index(itype, jtype)]; }
  /* True when all pairs of types have the same law, which is written to *one. */
  bool one_law(gh_contact_law *one) const;
  bool turning() const { return !fixed; }
  bool each_step() const { return step; }
  FixHistory *history() const { return fix; }

  /* For restart files: appends what the user has set; stops when a script has set something else. */
  void describe(std::vector<double> &data) const;
  void compare(const char *data) const;

private:
  enum { EXTRA = 9 }; /* values of single(), see docs/reference/lammps/pair_granhom_coulomb.md */
  bool step = true, fixed = false, objective = false, proportional = false;
  std::vector<gh_contact_law> laws; /* of pairs of types */
  std::vector<double> extra;
  FixHistory *fix = nullptr;
  bool had_fix = false;

  std::size_t index(int i, int j) const;
  void set_choices(gh_contact_law &law) const;
  int choices() const;
  void set_law(int i, int j, const double *parameters);
  void add(int i, int j, const double *l, double d, double reach);
  void remember(int i, int j, const Contact &c);
  void check_moves();
  void tell_of_loss() const;
};

} // namespace granhom

#endif
