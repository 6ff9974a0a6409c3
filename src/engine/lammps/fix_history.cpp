/* LAMMPS fix granhom/history: the converged state n of pair style granhom/coulomb.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include "engine/lammps/fix_history.h"

#include "engine/lammps/pair_coulomb.h"
#include "engine/lammps/versions.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using namespace FixConst;
using granhom::FixHistory;

FixHistory::FixHistory(LAMMPS *l, int narg, char **arg) : Fix(l, narg, arg) {
  if (narg != 3 || std::strcmp(id, ID) != 0)
    error->all(FLERR, std::string("Fix granhom/history is made by pair style granhom/coulomb"));
  restart_peratom = restart_global = create_attribute = 1;
  comm_forward = 5;
  maxexchange_dynamic = 1;
  maxexchange = HEAD;
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  cell(Hn);
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
}

FixHistory::~FixHistory() {
  if (holder) *holder = nullptr;
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

int FixHistory::setmask() {
  return INITIAL_INTEGRATE | POST_INTEGRATE | PRE_EXCHANGE;
}

void FixHistory::init() {
  if (std::strncmp(update->integrate_style, "respa", 5) == 0)
    error->all(FLERR, std::string("Pair granhom/coulomb does not run with run_style respa"));
}

void FixHistory::configure(bool step, bool turn_too, bool keep) {
  each_step = step;
  turns = turn_too;
  keep_alpha = keep;
  elsewhere = false; /* fix granhom/relax says otherwise after this */
}

/* ---- geometry ---- */

/* Lattice vectors as columns. */
void FixHistory::cell(double H[4]) const {
  H[0] = domain->xprd;
  H[1] = domain->triclinic ? domain->xy : 0;
  H[2] = 0;
  H[3] = domain->yprd;
}

/* Image flags count in periodic directions only. */
static void flags_of(const Domain *domain, imageint image, int k[2]) {
  k[0] = domain->xperiodic ? (int)(image & IMGMASK) - IMGMAX : 0;
  k[1] = domain->yperiodic ? (int)(image >> IMGBITS & IMGMASK) - IMGMAX : 0;
}

void FixHistory::unwrapped(int i, double x[2]) const {
  double H[4];
  int k[2];
  cell(H);
  flags_of(domain, atom->image[i], k);
  x[0] = atom->x[i][0] + H[0] * k[0] + H[1] * k[1];
  x[1] = atom->x[i][1] + H[3] * k[1];
}

void FixHistory::image(int i, int j, int k[2]) const {
  for (int c = 0; c < 2; c++) k[c] = steps[2 * (std::size_t)j + c] - steps[2 * (std::size_t)i + c];
}

void FixHistory::branch_n(int i, int j, const int k[2], double ln[2]) const {
  const double *a = &xn[2 * (std::size_t)i], *b = &xn[2 * (std::size_t)j];
  for (int c = 0; c < 2; c++) ln[c] = b[c] - a[c] + (Hn[2 * c] * k[0] + Hn[2 * c + 1] * k[1]);
}

void FixHistory::refresh(bool new_list) {
  for (int i = 0; i < atom->nlocal; i++) turn[i] = theta[i] - theta_n[i];
  if (new_list) {
    follow_flip();
    for (int i = 0; i < atom->nlocal; i++) {
      int k[2];
      flags_of(domain, atom->image[i], k);
      for (int c = 0; c < 2; c++) steps[2 * (std::size_t)i + c] = -k[c];
    }
  }
  new_ghosts = new_list;
  granhom::forward_comm(comm, this, new_list ? 5 : 3);
  if (new_list) ghosts_known = true;
}

int FixHistory::pack_forward_comm(int n, int *list, double *buf, int, int *) {
  int m = 0;
  for (int a = 0; a < n; a++) {
    const std::size_t i = list[a];
    buf[m++] = xn[2 * i];
    buf[m++] = xn[2 * i + 1];
    buf[m++] = turn[i];
    if (!new_ghosts) continue;
    /* of a ghost that is sent on: the position of its owner */
    double x[2], H[4];
    cell(H);
    x[0] = atom->x[i][0] - H[0] * steps[2 * i] - H[1] * steps[2 * i + 1];
    x[1] = atom->x[i][1] - H[3] * steps[2 * i + 1];
    buf[m++] = x[0];
    buf[m++] = x[1];
  }
  return m;
}

void FixHistory::unpack_forward_comm(int n, int start, double *buf) {
  double H[4];
  cell(H);
  for (std::size_t i = start; i < (std::size_t)start + n; i++) {
    xn[2 * i] = *buf++;
    xn[2 * i + 1] = *buf++;
    turn[i] = *buf++;
    if (!new_ghosts) continue;
    const double ky = domain->yperiodic ? std::round((atom->x[i][1] - buf[1]) / H[3]) : 0,
                 kx = domain->xperiodic ? std::round((atom->x[i][0] - buf[0] - H[1] * ky) / H[0]) : 0;
    steps[2 * i] = (int)kx;
    steps[2 * i + 1] = (int)ky;
    buf += 2;
  }
}

/* A box that was flipped within this time step (fix deform, fix nh) has another second lattice vector, m
 * times the first one longer; image flags have changed so that unwrapped positions stay, and the keys follow.
 */
void FixHistory::follow_flip() {
  if (!stepping || !domain->triclinic) return;
  const int m = (int)std::round((domain->xy - tilt_before) / domain->xprd);
  if (!m) return;
  for (auto &p : pool) p.k[0] -= m * p.k[1];
  Hn[1] += m * Hn[0];
  Hn[3] += m * Hn[2];
  tilt_before = domain->xy;
}

/* ---- records ---- */

/* Contacts keep their order from step to step: the search begins after the last find. */
int FixHistory::find(int i, tagint tag, const int k[2]) const {
  const int n = count[i], at = first[i];
  for (int a = 0, b = finger[i]; a < n; a++, b++) {
    if (b >= n) b = 0;
    const Partner &p = pool[at + b];
    if (p.tag == tag && p.k[0] == k[0] && p.k[1] == k[1]) {
      finger[i] = b + 1;
      return at + b;
    }
  }
  return -1;
}

void FixHistory::begin_trial() {
  trial = moved = false;
  touched.clear();
  owner.clear();
  if (keep_alpha) used.assign(pool.size(), 0);
  std::fill(finger.begin(), finger.end(), 0);
}

void FixHistory::touch(int i, const Partner &p) {
  owner.push_back(i);
  touched.push_back(p);
}

/* alpha survives opening, gamma and gamma_pl do not (method 8.10). */
void FixHistory::carry_alpha() {
  for (int i = 0; i < atom->nlocal; i++)
    for (int r = first[i]; r < first[i] + count[i]; r++)
      if (!used[r] && pool[r].alpha > 0)
        touch(i, {pool[r].tag, {pool[r].k[0], pool[r].k[1]}, 0, 0, pool[r].alpha});
}

/* Sorts what was touched by its atoms, and notes where everything is. */
void FixHistory::end_trial() {
  if (keep_alpha) carry_alpha();
  const std::size_t n = atom->nlocal;
  tcount.assign(n, 0);
  tfirst.assign(n + 1, 0);
  tpool.resize(touched.size());
  for (int i : owner) tcount[i]++;
  for (std::size_t i = 0; i < n; i++) tfirst[i + 1] = tfirst[i] + tcount[i];
  std::vector<int> &at = finger; /* any content will do from here on */
  std::copy(tfirst.begin(), tfirst.begin() + (std::ptrdiff_t)n, at.begin());
  for (std::size_t t = 0; t < touched.size(); t++) tpool[at[owner[t]]++] = touched[t];
  std::fill(finger.begin(), finger.end(), 0);
  xt.resize(2 * n);
  for (std::size_t i = 0; i < n; i++) unwrapped((int)i, &xt[2 * i]);
  theta_t.assign(theta.begin(), theta.begin() + (std::ptrdiff_t)n);
  cell(Ht);
  trial = true;
}

void FixHistory::commit() {
  if (!trial || moved) return;
  trial = false;
  std::copy(Ht, Ht + 4, Hn);
  std::copy(xt.begin(), xt.end(), xn.begin());
  std::copy(theta_t.begin(), theta_t.end(), theta_n.begin());
  std::copy(tcount.begin(), tcount.end(), count.begin());
  std::copy(tfirst.begin(), tfirst.begin() + (std::ptrdiff_t)tcount.size(), first.begin());
  std::fill(finger.begin(), finger.end(), 0);
  pool.swap(tpool);
}

/* ---- the time step ---- */

void FixHistory::initial_integrate(int) {
  stepping = true;
  tilt_before = domain->xy;
  if (each_step) commit();
}

/* After all fixes have moved the grains: omega is that of the half step, as in fix nve/sphere. */
void FixHistory::post_integrate() {
  if (!turns || elsewhere) return;
  for (int i = 0; i < atom->nlocal; i++) theta[i] += update->dt * atom->omega[i][2];
}

void FixHistory::setup_pre_exchange() {
  stepping = false;
  pre_exchange();
}

/* Atoms may leave from here on: what was noted of the trial state belongs to an order that is gone. */
void FixHistory::pre_exchange() {
  trial = ghosts_known = false;
  compact();
  int mine = HEAD + RECORD * (2 * most_partners() + 16); /* room for what forms until the next call */
  MPI_Allreduce(&mine, &maxexchange, 1, MPI_INT, MPI_MAX, world);
}

/* fix_modify granhom_history commit yes */
int FixHistory::modify_param(int narg, char **arg) {
  if (std::strcmp(arg[0], "commit") != 0) return 0;
  if (narg < 2 || std::strcmp(arg[1], "yes") != 0)
    error->all(FLERR, std::string("Illegal fix_modify command: granhom/history takes commit yes"));
  int mine = moved, any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (any)
    error->all(FLERR, std::string("Fix granhom/history: atoms have changed places since the forces were "
                                  "computed; use run 0 before commit yes"));
  commit();
  return 2;
}

/* ---- atoms come, go and are saved ---- */

void FixHistory::grow_arrays(int nmax) {
  const std::size_t n = nmax;
  xn.resize(2 * n);
  for (auto *a : {&theta_n, &theta, &turn}) a->resize(n);
  for (auto *a : {&first, &count, &finger}) a->resize(n);
  steps.resize(2 * n);
}

void FixHistory::copy_arrays(int i, int j, int) {
  moved = true;
  std::copy_n(&xn[2 * (std::size_t)i], 2, &xn[2 * (std::size_t)j]);
  theta_n[j] = theta_n[i];
  theta[j] = theta[i];
  first[j] = first[i];
  count[j] = count[i];
}

/* A new atom is at n where it is now. */
void FixHistory::set_arrays(int i) {
  moved = true;
  unwrapped(i, &xn[2 * (std::size_t)i]);
  theta_n[i] = theta[i] = turn[i] = 0;
  first[i] = count[i] = 0;
}

/* Records of atoms that have left, while none was committed. */
void FixHistory::compact() {
  std::size_t live = 0;
  for (int i = 0; i < atom->nlocal; i++) live += count[i];
  if (pool.size() <= 2 * live + 1000) return;
  std::vector<Partner> kept;
  kept.reserve(live);
  for (int i = 0; i < atom->nlocal; i++) {
    const int at = (int)kept.size();
    kept.insert(kept.end(), pool.begin() + first[i], pool.begin() + first[i] + count[i]);
    first[i] = at;
  }
  pool.swap(kept);
}

int FixHistory::most_partners() const {
  return atom->nlocal ? *std::max_element(count.begin(), count.begin() + atom->nlocal) : 0;
}

int FixHistory::pack(int i, double *buf) const {
  int m = 0;
  buf[m++] = HEAD + RECORD * count[i];
  buf[m++] = xn[2 * (std::size_t)i];
  buf[m++] = xn[2 * (std::size_t)i + 1];
  buf[m++] = theta_n[i];
  buf[m++] = theta[i];
  buf[m++] = count[i];
  for (int r = first[i]; r < first[i] + count[i]; r++) {
    const Partner &p = pool[r];
    for (double value : {(double)p.tag, (double)p.k[0], (double)p.k[1], p.gamma, p.gamma_pl, p.alpha})
      buf[m++] = value;
  }
  return m;
}

int FixHistory::unpack(int i, const double *buf) {
  xn[2 * (std::size_t)i] = buf[1];
  xn[2 * (std::size_t)i + 1] = buf[2];
  theta_n[i] = buf[3];
  theta[i] = buf[4];
  turn[i] = theta[i] - theta_n[i];
  first[i] = (int)pool.size();
  count[i] = (int)buf[5];
  for (int r = 0; r < count[i]; r++) {
    const double *p = buf + HEAD + RECORD * r;
    pool.push_back({(tagint)p[0], {(int)p[1], (int)p[2]}, p[3], p[4], p[5]});
  }
  return (int)buf[0];
}

int FixHistory::pack_exchange(int i, double *buf) {
  moved = true;
  return pack(i, buf);
}

int FixHistory::unpack_exchange(int nlocal, double *buf) {
  moved = true;
  return unpack(nlocal, buf);
}

int FixHistory::pack_restart(int i, double *buf) {
  return pack(i, buf);
}

int FixHistory::size_restart(int i) {
  return HEAD + RECORD * count[i];
}

int FixHistory::maxsize_restart() {
  int mine = HEAD + RECORD * most_partners(), most;
  MPI_Allreduce(&mine, &most, 1, MPI_INT, MPI_MAX, world);
  return most;
}

void FixHistory::unpack_restart(int nlocal, int nth) {
  const double *all = atom->extra[nlocal];
  int m = 0;
  for (int a = 0; a < nth; a++) m += (int)all[m];
  unpack(nlocal, all + m);
}

/* Lattice of n, and the laws, so that a script with other ones is refused. */
void FixHistory::write_restart(FILE *fp) {
  std::vector<double> data(Hn, Hn + 4);
  auto *pair = dynamic_cast<PairCoulomb *>(force->pair_match("granhom/coulomb", 1));
  if (pair) pair->describe(data);
  if (comm->me) return;
  const int size = (int)(data.size() * sizeof(double));
  fwrite(&size, sizeof size, 1, fp);
  fwrite(data.data(), sizeof(double), data.size(), fp);
}

void FixHistory::restart(char *buf) {
  double H[4];
  std::memcpy(H, buf, sizeof H);
  std::copy(H, H + 4, Hn);
  auto *pair = dynamic_cast<PairCoulomb *>(force->pair_match("granhom/coulomb", 1));
  if (pair) pair->compare(buf + sizeof H);
}

double FixHistory::memory_usage() {
  const std::size_t doubles = xn.capacity() + theta_n.capacity() + theta.capacity() + turn.capacity() +
                              xt.capacity() + theta_t.capacity(),
                    ints = first.capacity() + count.capacity() + finger.capacity() + steps.capacity() +
                           tfirst.capacity() + tcount.capacity() + owner.capacity();
  return (double)(doubles * sizeof(double) + ints * sizeof(int) + used.capacity() +
                  (pool.capacity() + tpool.capacity() + touched.capacity()) * sizeof(Partner));
}

/* ---- driven by a program ---- */

void FixHistory::set_converged(const double H[4], const double *x, const double *rotations,
                               const gh_slip *slips, int nslips) {
  const int n = atom->nlocal;
  std::copy(H, H + 4, Hn);
  std::vector<int> &at = place;
  local.resize(n);
  at.assign(n + 1, 0);
  for (int i = 0; i < n; i++) local[atom->tag[i] - 1] = i;
  for (int i = 0; i < n; i++) {
    const std::size_t a = atom->tag[i] - 1;
    std::copy_n(x + 2 * a, 2, &xn[2 * (std::size_t)i]);
    theta_n[i] = rotations[a];
    count[i] = 0;
  }
  for (int c = 0; c < nslips; c++) {
    count[local[slips[c].i]]++;
    count[local[slips[c].j]]++;
  }
  for (int i = 0; i < n; i++) at[i + 1] = at[i] + count[i];
  std::copy(at.begin(), at.end() - 1, first.begin());
  const std::size_t records = static_cast<std::size_t>(at[n]);
  if (records > pool.capacity()) pool.reserve(records + records / 8); /* a count that wavers grows once */
  pool.resize(records);
  for (int c = 0; c < nslips; c++) { /* each grain has its own record; one on its own image has two */
    const gh_slip &s = slips[c];
    pool[at[local[s.i]]++] = {s.j + 1, {s.image[0], s.image[1]}, s.gamma, s.gamma_pl, s.alpha};
    pool[at[local[s.j]]++] = {s.i + 1, {-s.image[0], -s.image[1]}, s.gamma, s.gamma_pl, s.alpha};
  }
  std::fill(finger.begin(), finger.end(), 0);
  trial = false;
}

void FixHistory::set_rotations(const double *rotations) {
  for (int i = 0; i < atom->nlocal; i++) theta[i] = rotations[atom->tag[i] - 1];
}

void FixHistory::get_rotations(double *rotations) const {
  for (int i = 0; i < atom->nlocal; i++) rotations[atom->tag[i] - 1] = theta[i];
}
