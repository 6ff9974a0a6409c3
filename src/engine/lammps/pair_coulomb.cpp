/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS pair style granhom/coulomb: normal contact and Coulomb friction of disks by return mapping.
 *
 * Every contact is evaluated from state n, which fix granhom/history keeps. With newton off a contact with a
 * ghost is evaluated on both sides, and both atoms have its record. */
#include "engine/lammps/pair_coulomb.h"

#include "engine/lammps/fix_history.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using granhom::FixHistory;
using granhom::PairCoulomb;

enum { PARAMETERS = 4 }; /* E_n E_t mu h */

static void parameters_of(const gh_contact_law &law, double *p) {
  p[0] = law.normal_stiffness;
  p[1] = law.tangential_stiffness;
  p[2] = law.friction_coefficient;
  p[3] = law.hardening;
}

PairCoulomb::PairCoulomb(LAMMPS *l) : PairNormal(l), extra(EXTRA) {
  single_extra = EXTRA;
  svector = extra.data();
}

PairCoulomb::~PairCoulomb() {
  if (!fix) return;
  tell_of_loss();
  modify->delete_fix(FixHistory::ID);
}

/* When LAMMPS ends, or begins again with clear, there is no update any more, and nothing to tell. */
void PairCoulomb::tell_of_loss() const {
  if (!update) return;
  const long slips = fix->slips();
  if (slips && comm->me == 0)
    error->warning(FLERR, "Pair granhom/coulomb is given up, and with it the slip of " +
                              std::to_string(slips) +
                              " contacts: in a pair style that follows, slip begins at zero");
}

std::size_t PairCoulomb::index(int i, int j) const {
  return (std::size_t)i * (atom->ntypes + 1) + j;
}

/* ---- what the script states ---- */

void PairCoulomb::settings(int narg, char **arg) {
  const std::string illegal = "Illegal pair_style granhom/coulomb command: ";
  step = true;
  fixed = objective = proportional = false;
  for (int k = 0; k < narg; k += 2) {
    const std::string word = arg[k];
    if (k + 1 >= narg) error->all(FLERR, illegal + "no value for " + word);
    const std::string value = arg[k + 1];
    auto choice = [&](const char *no, const char *yes) {
      if (value != no && value != yes)
        error->all(FLERR, illegal + word + " is " + no + " or " + yes + ", not " + value);
      return value == yes;
    };
    if (word == "increment") step = choice("manual", "step");
    else if (word == "slip") objective = choice("projected", "objective");
    else if (word == "rotations") fixed = choice("free", "fixed");
    else if (word == "hardening") proportional = choice("printed", "proportional");
    else error->all(FLERR, illegal + "unknown keyword " + word);
  }
  if (allocated) /* laws that are set already follow */
    for (auto &law : laws) set_choices(law);
}

void PairCoulomb::set_choices(gh_contact_law &law) const {
  law.slip = objective ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
  law.hardening_law = proportional ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
  law.fixed_rotations = fixed;
}

void PairCoulomb::set_law(int i, int j, const double *p) {
  gh_contact_law law = {};
  law.friction = 1;
  law.normal_stiffness = p[0];
  law.tangential_stiffness = p[1];
  law.friction_coefficient = p[2];
  law.hardening = p[3];
  set_choices(law);
  E[i][j] = E[j][i] = p[0];
  laws.resize(index(atom->ntypes, atom->ntypes) + 1);
  laws[index(i, j)] = laws[index(j, i)] = law;
}

void PairCoulomb::coeff(int narg, char **arg) {
  static const char *const names[PARAMETERS] = {"Normal stiffness", "Tangential stiffness",
                                                "Friction coefficient", "Hardening"};
  if (narg != 2 + PARAMETERS)
    error->all(
        FLERR,
        std::string(
            "Incorrect args for pair coefficients: granhom/coulomb wants pair_coeff I J E_n E_t mu h"));
  if (!allocated) allocate();
  int ilo, ihi, jlo, jhi;
  utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
  utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);
  double p[PARAMETERS];
  for (int k = 0; k < PARAMETERS; k++) {
    p[k] = utils::numeric(FLERR, arg[2 + k], false, lmp);
    if (!(k < 2 ? p[k] > 0 : p[k] >= 0) || !std::isfinite(p[k]))
      error->all(FLERR, std::string(names[k]) + " of pair granhom/coulomb must be " +
                            (k < 2 ? "positive and finite, not " : "finite and not negative, but is ") +
                            arg[2 + k]);
  }
  int count = 0;
  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++, count++) {
      set_law(i, j, p);
      setflag[i][j] = 1;
    }
  if (!count) error->all(FLERR, std::string("Incorrect args for pair coefficients"));
}

void PairCoulomb::init_style() {
  if (!atom->radius_flag || !atom->omega_flag || !atom->torque_flag)
    error->all(FLERR, std::string("Pair granhom/coulomb requires atom style sphere"));
  if (domain->dimension != 2) error->all(FLERR, std::string("Pair granhom/coulomb requires a 2d simulation"));
  if (force->newton_pair) error->all(FLERR, std::string("Pair granhom/coulomb requires newton off"));
  if (!atom->tag_enable) error->all(FLERR, std::string("Pair granhom/coulomb requires atom ids"));
  if (update->whichflag == 2)
    error->all(FLERR, std::string("Pair granhom/coulomb does not run with minimize: use fix granhom/relax"));
  if (!fix) {
    if (had_fix) error->all(FLERR, std::string(FixHistory::STAYS));
    if (modify->find_fix(FixHistory::ID) >= 0)
      error->all(FLERR, std::string("Only one pair style granhom/coulomb can be in use"));
    fix = dynamic_cast<FixHistory *>(modify->add_fix(std::string(FixHistory::ID) + " all granhom/history"));
  }
  fix->held_by(&fix);
  had_fix = true;
  bool hardens = false;
  for (const auto &law : laws) hardens = hardens || law.hardening > 0;
  fix->configure(step, !fixed, hardens);
  find_largest();
  neighbor->request(this, instance_me);
}

double PairCoulomb::init_one(int i, int j) {
  if (!setflag[i][j]) {
    double a[PARAMETERS], b[PARAMETERS];
    parameters_of(law(i, i), a);
    parameters_of(law(j, j), b);
    for (int k = 0; k < PARAMETERS; k++) a[k] = 0.5 * (a[k] + b[k]);
    set_law(i, j, a);
  }
  return PairNormal::init_one(i, j);
}

bool PairCoulomb::one_law(gh_contact_law *one) const {
  double p[PARAMETERS], q[PARAMETERS];
  *one = law(1, 1);
  parameters_of(*one, p);
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = 1; j <= atom->ntypes; j++) {
      parameters_of(law(i, j), q);
      if (!std::equal(p, p + PARAMETERS, q)) return false;
    }
  return true;
}

/* ---- forces ---- */

double PairCoulomb::Contact::energy() const {
  return gh_coulomb_energy(law, &result);
}

double PairCoulomb::Contact::dissipated() const {
  return gh_coulomb_dissipated(law, &result, step.reach - step.d);
}

void PairCoulomb::evaluate(int i, int j, const double *l, double d, double reach, Contact *c) const {
  const tagint *tag = atom->tag;
  int k[2];
  double ln[2];
  fix->image_n(i, j, k);
  fix->branch_n(i, j, k, ln);
  c->law = &laws[index(atom->type[i], atom->type[j])];
  c->record = fix->find(i, tag[j], k);
  c->swapped = tag[i] > tag[j];
  const double sign = c->swapped ? -1 : 1, gi = atom->radius[i] * fix->turned(i),
               gj = atom->radius[j] * fix->turned(j);
  for (int m = 0; m < 2; m++) {
    c->k[m] = c->swapped ? -k[m] : k[m];
    c->step.l[m] = sign * l[m];
    c->step.ln[m] = sign * ln[m];
  }
  c->step.d = d;
  c->step.reach = reach;
  c->step.q = fixed ? 0 : c->swapped ? gj + gi : gi + gj;
  c->step.gamma = c->step.gamma_pl = c->step.alpha = 0;
  if (c->record >= 0) {
    const FixHistory::Partner &p = fix->record(c->record);
    c->step.gamma = p.gamma;
    c->step.gamma_pl = p.gamma_pl;
    c->step.alpha = p.alpha;
  }
  gh_coulomb_evaluate(c->law, &c->step, &c->result);
}

double PairCoulomb::coefficient(int i, int j, const double *l, double d2) const {
  const gh_contact_law &law = laws[index(atom->type[i], atom->type[j])];
  if (!gh_coulomb_is_proportional(&law)) return law.friction_coefficient;
  Contact c;
  evaluate(i, j, l, std::sqrt(d2), atom->radius[i] + atom->radius[j], &c);
  return gh_coulomb_coefficient(&law, c.step.d <= c.step.reach ? c.result.alpha : c.step.alpha);
}

/* The trial state of a contact, for both atoms where both are here. */
void PairCoulomb::remember(int i, int j, const Contact &c) {
  const tagint *tag = atom->tag;
  const gh_coulomb_result &r = c.result;
  const int s = c.swapped ? -1 : 1, k[2] = {s * c.k[0], s * c.k[1]}, back[2] = {-k[0], -k[1]};
  fix->touch(i, {tag[j], {k[0], k[1]}, r.gamma, r.gamma_pl, r.alpha});
  const bool mark = fix->keeps_alpha() && c.record >= 0;
  if (mark) fix->mark(c.record);
  if (j >= atom->nlocal) return;
  fix->touch(j, {tag[i], {back[0], back[1]}, r.gamma, r.gamma_pl, r.alpha});
  const int other = mark ? fix->find(j, tag[i], back) : -1;
  if (other >= 0) fix->mark(other);
}

void PairCoulomb::add(int i, int j, const double *l, double d, double reach) {
  Contact c;
  evaluate(i, j, l, d, reach, &c);
  remember(i, j, c);
  const double sign = c.swapped ? -1 : 1, f[2] = {sign * c.result.f[0], sign * c.result.f[1]};
  const double e = reach - d, normal = c.law->normal_stiffness * e;
  const bool owned = j < atom->nlocal, image = atom->tag[i] == atom->tag[j];
  for (int m = 0; m < 2 && !image; m++) { /* no net force of an own image, not even a rounded one */
    atom->f[i][m] += f[m];
    if (owned) atom->f[j][m] -= f[m];
  }
  atom->torque[i][2] -= atom->radius[i] * c.result.couple;
  if (owned) atom->torque[j][2] -= atom->radius[j] * c.result.couple;
  if (!image) {
    force_sum += owned ? normal : 0.5 * normal;
    contact_count += owned ? 1 : 0.5;
  }
  if (evflag)
    ev_tally_xyz(i, j, atom->nlocal, 0, gh_normal_energy(c.law->normal_stiffness, e), c.energy(), f[0], f[1],
                 0, -l[0], -l[1], 0);
}

/* Slip is measured from positions. A grain that a command has put to another place has not slid all the way
 * along its new neighbours. */
void PairCoulomb::check_moves() {
  const double *const *x = atom->x, *radius = atom->radius;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      const double l[2] = {x[j][0] - x[i][0], x[j][1] - x[i][1]}, moved = fix->moved_by_commands(i, j, l),
                   limit = std::min(radius[i], radius[j]);
      if (std::hypot(l[0], l[1]) > radius[i] + radius[j] || !(moved > limit)) continue;
      char text[500];
      snprintf(text, sizeof text,
               "Pair granhom/coulomb: commands between runs have moved atom %ld against atom %ld, which it "
               "touches, by %g, more than the smaller radius %g: the slip of this contact is not known. Move "
               "in smaller steps with run 0 between them, or drop all history: pair_style none, then "
               "pair_style granhom/coulomb again",
               (long)atom->tag[i], (long)atom->tag[j], moved, limit);
      error->one(FLERR, std::string(text));
    }
  }
}

void PairCoulomb::compute(int eflag, int vflag) {
  ev_init(eflag, vflag);
  const bool built = check_list();
  fix->refresh(built || !fix->fresh());
  if (fix->starts()) check_moves();
  fix->begin_trial();
  force_sum = contact_count = 0;
  const double *const *x = atom->x;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii], *jlist = list->firstneigh[i], jnum = list->numneigh[i];
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      const double l[2] = {x[j][0] - x[i][0], x[j][1] - x[i][1]}, d2 = l[0] * l[0] + l[1] * l[1],
                   reach = atom->radius[i] + atom->radius[j];
      if (d2 > 1.000001 * reach * reach) continue; /* the root decides near the limit, as in the kernel */
      const double d = std::sqrt(d2);
      if (reach - d < 0) continue;
      if (!(d > 0)) centres_coincide(i, j);
      add(i, j, l, d, reach);
    }
  }
  fix->end_trial();
  if (vflag_fdotr) virial_fdotr_compute();
}

double PairCoulomb::single(int i, int j, int itype, int jtype, double rsq, double, double, double &fforce) {
  const double l[2] = {atom->x[j][0] - atom->x[i][0], atom->x[j][1] - atom->x[i][1]}, d = std::sqrt(rsq),
               reach = atom->radius[i] + atom->radius[j], e = reach - d;
  fforce = 0;
  if (!fix) error->one(FLERR, std::string(FixHistory::STAYS));
  std::fill(extra.begin(), extra.end(), 0.0);
  if (e < 0) return 0;
  if (!(d > 0)) centres_coincide(i, j);
  const double En = law(itype, jtype).normal_stiffness, factor = gh_normal_factor(En, e, d);
  Contact c;
  evaluate(i, j, l, d, reach, &c);
  const gh_coulomb_result &r = c.result;
  fforce = -factor;
  const double sign = c.swapped ? -1 : 1;
  for (int m = 0; m < 2; m++) extra[m] = sign * r.f[m] - factor * l[m]; /* tangential force on i */
  const double rest[] = {r.force, r.couple, r.gamma, r.gamma_pl, r.alpha, (double)(r.slides != 0)};
  std::copy(std::begin(rest), std::end(rest), extra.begin() + 3);
  return gh_normal_energy(En, e) + c.energy();
}

/* ---- files ---- */

/* Files have one number for the measure of slip and the law of hardening. */
enum { OBJECTIVE = 1, PROPORTIONAL = 2 };

int PairCoulomb::choices() const {
  return (objective ? OBJECTIVE : 0) + (proportional ? PROPORTIONAL : 0);
}

void PairCoulomb::write_restart_settings(FILE *fp) {
  const int flags[3] = {step, fixed, choices()};
  fwrite(flags, sizeof(int), 3, fp);
}

void PairCoulomb::read_restart_settings(FILE *fp) {
  int flags[3];
  if (comm->me == 0) utils::sfread(FLERR, flags, sizeof(int), 3, fp, nullptr, error);
  MPI_Bcast(flags, 3, MPI_INT, 0, world);
  step = flags[0];
  fixed = flags[1];
  objective = flags[2] & OBJECTIVE;
  proportional = flags[2] & PROPORTIONAL;
}

void PairCoulomb::write_restart(FILE *fp) {
  write_restart_settings(fp);
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      double p[PARAMETERS];
      parameters_of(law(i, j), p);
      fwrite(&setflag[i][j], sizeof(int), 1, fp);
      fwrite(p, sizeof(double), PARAMETERS, fp);
    }
}

void PairCoulomb::read_restart(FILE *fp) {
  read_restart_settings(fp);
  allocate();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      double p[PARAMETERS];
      if (comm->me == 0) {
        utils::sfread(FLERR, &setflag[i][j], sizeof(int), 1, fp, nullptr, error);
        utils::sfread(FLERR, p, sizeof(double), PARAMETERS, fp, nullptr, error);
      }
      MPI_Bcast(&setflag[i][j], 1, MPI_INT, 0, world);
      MPI_Bcast(p, PARAMETERS, MPI_DOUBLE, 0, world);
      set_law(i, j, p);
    }
}

void PairCoulomb::describe(std::vector<double> &data) const {
  data.insert(data.end(), {(double)fixed, (double)choices(), (double)atom->ntypes});
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      double p[PARAMETERS];
      parameters_of(law(i, j), p);
      data.insert(data.end(), p, p + PARAMETERS);
    }
}

void PairCoulomb::compare(const char *data) const {
  double head[3], p[PARAMETERS], q[PARAMETERS];
  std::memcpy(head, data, sizeof head);
  data += sizeof head;
  const std::string differs = "The restart file holds the history of pair granhom/coulomb with ";
  if (head[0] != fixed)
    error->all(FLERR, differs + "rotations " + (fixed ? "free" : "fixed") + ", the script states " +
                          (fixed ? "fixed" : "free"));
  const int other = (int)head[1] ^ choices();
  if (other & OBJECTIVE)
    error->all(FLERR, differs + "slip " + (objective ? "projected" : "objective") + ", the script states " +
                          (objective ? "objective" : "projected"));
  if (other & PROPORTIONAL)
    error->all(FLERR, differs + "hardening " + (proportional ? "printed" : "proportional") +
                          ", the script states " + (proportional ? "proportional" : "printed"));
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++, data += sizeof p) {
      if (!setflag[i][j]) continue; /* follows from others */
      std::memcpy(p, data, sizeof p);
      parameters_of(law(i, j), q);
      if (!std::equal(p, p + PARAMETERS, q))
        error->all(FLERR, differs + "other coefficients of the types " + std::to_string(i) + " and " +
                              std::to_string(j) + " than the script: E_n " + std::to_string(p[0]) + " E_t " +
                              std::to_string(p[1]) + " mu " + std::to_string(p[2]) + " h " +
                              std::to_string(p[3]));
    }
}

void PairCoulomb::write_data(FILE *fp) {
  for (int i = 1; i <= atom->ntypes; i++) {
    double p[PARAMETERS];
    parameters_of(law(i, i), p);
    fprintf(fp, "%d %.17g %.17g %.17g %.17g\n", i, p[0], p[1], p[2], p[3]);
  }
}

void PairCoulomb::write_data_all(FILE *fp) {
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      double p[PARAMETERS];
      parameters_of(law(i, j), p);
      fprintf(fp, "%d %d %.17g %.17g %.17g %.17g\n", i, j, p[0], p[1], p[2], p[3]);
    }
}

double PairCoulomb::memory_usage() {
  return PairNormal::memory_usage() + (double)(laws.capacity() * sizeof(gh_contact_law));
}
