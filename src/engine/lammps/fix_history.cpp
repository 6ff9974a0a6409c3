/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS fix granhom/history: the converged state n of pair style granhom/coulomb. */
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
  cell(Hl);
  for (int i = 0; i < atom->nlocal; i++) {
    set_arrays(i);
    note_end(i);
  }
  born = false;
}

/* LAMMPS calls fixes by their places, which it notes at the start of a run with setup: once one that has run is
 * gone, the next run has a setup, `pre no` or not. When LAMMPS ends there is no update any more. */
FixHistory::~FixHistory() {
  if (holder) {
    *holder = nullptr;
    if (update) update->first_update = 0;
  }
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

int FixHistory::setmask() {
  return INITIAL_INTEGRATE | POST_INTEGRATE | PRE_EXCHANGE | POST_RUN;
}

void FixHistory::init() {
  if (std::strncmp(update->integrate_style, "respa", 5) == 0)
    error->all(FLERR, std::string("Pair granhom/coulomb does not run with run_style respa"));
}

void FixHistory::configure(bool step, bool turn_too, bool keep) {
  each_step = step;
  turns = turn_too;
  keep_alpha = keep;
  elsewhere = false; /* fix granhom/relax states otherwise after this */
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

void FixHistory::image_n(int i, int j, int k[2]) const {
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
    follow_births();
    for (int i = 0; i < atom->nlocal; i++) {
      int k[2];
      flags_of(domain, atom->image[i], k);
      for (int c = 0; c < 2; c++) steps[2 * (std::size_t)i + c] = -k[c];
    }
  }
  new_ghosts = new_list;
  granhom::forward_comm(comm, this, new_list ? 5 : 3);
  if (new_list) ghosts_known = true;
  if (!starting) return;
  xl.resize(2 * ((std::size_t)atom->nlocal + atom->nghost));
  for (std::size_t i = 0; i < (std::size_t)atom->nlocal; i++) {
    xl[2 * i] = xw[2 * i] + Hl[0] * fl[2 * i] + Hl[1] * fl[2 * i + 1];
    xl[2 * i + 1] = xw[2 * i + 1] + Hl[3] * fl[2 * i + 1];
  }
  sending_last = true;
  granhom::forward_comm(comm, this, 2);
  sending_last = false;
}

int FixHistory::pack_forward_comm(int n, int *list, double *buf, int, int *) {
  int m = 0;
  for (int a = 0; a < n; a++) {
    const std::size_t i = list[a];
    if (sending_last) {
      buf[m++] = xl[2 * i];
      buf[m++] = xl[2 * i + 1];
      continue;
    }
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
  if (sending_last) {
    std::copy_n(buf, 2 * (std::size_t)n, xl.data() + 2 * (std::size_t)start);
    return;
  }
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
  trial = moved = starting = false;
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
  if (awaited && reconcile(STEPPED)) trial = ghosts_known = false; /* a run without setup */
}

/* After all fixes have moved the grains: omega is that of the half step, as in fix nve/sphere. */
void FixHistory::post_integrate() {
  if (!turns || elsewhere) return;
  for (int i = 0; i < atom->nlocal; i++) theta[i] += update->dt * atom->omega[i][2];
}

void FixHistory::setup_pre_exchange() {
  stepping = false;
  reconcile(ROUNDED);
  pre_exchange();
}

void FixHistory::post_run() {
  if (driven) return;
  for (int i = 0; i < atom->nlocal; i++) note_end(i);
  cell(Hl);
  awaited = true;
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

/* ---- what commands do between runs ---- */

void FixHistory::note_end(int i) {
  known[i] = atom->tag[i];
  std::copy_n(atom->x[i], 2, &xw[2 * (std::size_t)i]);
  flags_of(domain, atom->image[i], &fl[2 * (std::size_t)i]);
}

/* State n follows the atoms that were known at the end of the last run: renumbered ones keep their contacts,
 * those of atoms that are gone are dropped (their ids may be in use again). True: something has changed. */
bool FixHistory::reconcile(double near) {
  awaited = false;
  if (driven) return false;
  std::vector<Change> changes;
  int mine = 0, any;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!known[i]) {
      place_new(i);
      continue;
    }
    Change c = {known[i], atom->tag[i], {0, 0}};
    if (follow_images(i, near, &c) || c.before != c.now) mine = 1;
    changes.push_back(c);
    known[i] = c.now;
  }
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (any) rekey(changes);
  starting = true;
  return any;
}

/* An atom that is where it was, or on an image of that, while a command has changed its image flags by
 * others than those between the two (set image, change_box boundary, a move by a whole period): its unwrapped
 * position has gained lattice vectors, at n too. near: part of a period within which it is there. */
bool FixHistory::follow_images(int i, double near, Change *c) {
  const std::size_t a = 2 * (std::size_t)i;
  const double d[2] = {xw[a] - atom->x[i][0], xw[a + 1] - atom->x[i][1]};
  double H[4];
  int now[2];
  cell(H);
  flags_of(domain, atom->image[i], now);
  const double m1 = domain->yperiodic ? std::round(d[1] / H[3]) : 0,
               m0 = domain->xperiodic ? std::round((d[0] - H[1] * m1) / H[0]) : 0;
  const bool there =
      std::fabs(d[0] - H[0] * m0 - H[1] * m1) <= near * H[0] && std::fabs(d[1] - H[3] * m1) <= near * H[3];
  if (!there) return false; /* or not known */
  c->steps[0] = now[0] - fl[a] - (int)m0;
  c->steps[1] = now[1] - fl[a + 1] - (int)m1;
  for (int k = 0; k < 2; k++) fl[a + k] += (int)c->steps[k];
  for (int k = 0; k < 2; k++) xn[a + k] += Hn[2 * k] * c->steps[0] + Hn[2 * k + 1] * c->steps[1];
  return c->steps[0] || c->steps[1];
}

/* A new atom has moved with the box since n, and not otherwise. */
void FixHistory::place_new(int i) {
  double H[4], x[2];
  cell(H);
  unwrapped(i, x);
  if (!std::equal(H, H + 4, Hn)) {
    const double s1 = x[1] / H[3], s0 = (x[0] - H[1] * s1) / H[0];
    for (int k = 0; k < 2; k++) x[k] = Hn[2 * k] * s0 + Hn[2 * k + 1] * s1;
  }
  std::copy_n(x, 2, &xn[2 * (std::size_t)i]);
}

/* Of all ranks, in their order. */
static std::vector<tagint> gather(const std::vector<tagint> &mine, MPI_Comm world) {
  int ranks, count = (int)mine.size(), total = 0;
  MPI_Comm_size(world, &ranks);
  std::vector<int> counts(ranks), starts(ranks);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int r = 0; r < ranks; r++) {
    starts[r] = total;
    total += counts[r];
  }
  std::vector<tagint> all(total);
  MPI_Allgatherv(mine.data(), count, MPI_LMP_TAGINT, all.data(), counts.data(), starts.data(), MPI_LMP_TAGINT,
                 world);
  return all;
}

/* Keeps the records for which keep(atom, record) is true; it may change them. */
template <typename Keep> void FixHistory::filter_records(Keep keep) {
  std::vector<Partner> kept;
  for (int i = 0; i < atom->nlocal; i++) {
    const int begin = first[i], end = first[i] + count[i];
    first[i] = (int)kept.size();
    for (int r = begin; r < end; r++)
      if (keep(i, pool[r])) kept.push_back(pool[r]);
    count[i] = (int)kept.size() - first[i];
  }
  pool.swap(kept);
}

void FixHistory::rekey(const std::vector<Change> &mine) {
  static_assert(sizeof(Change) == 4 * sizeof(tagint), "gathered as numbers");
  std::vector<tagint> numbers;
  for (const Change &c : mine) numbers.insert(numbers.end(), {c.before, c.now, c.steps[0], c.steps[1]});
  numbers = gather(numbers, world);
  std::vector<Change> all(numbers.size() / 4);
  for (std::size_t a = 0; a < all.size(); a++)
    all[a] = {numbers[4 * a], numbers[4 * a + 1], {numbers[4 * a + 2], numbers[4 * a + 3]}};
  std::sort(all.begin(), all.end(), [](const Change &a, const Change &b) { return a.before < b.before; });
  std::vector<std::size_t> own(atom->nlocal, all.size());
  auto find_change = [&](tagint before) {
    return std::lower_bound(all.begin(), all.end(), before,
                            [](const Change &a, tagint tag) { return a.before < tag; });
  };
  std::size_t next = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (known[i]) own[i] = next++;
  filter_records([&](int i, Partner &p) {
    const auto c = find_change(p.tag);
    if (c == all.end() || c->before != p.tag) return false;
    for (int k = 0; k < 2; k++) p.k[k] += (int)(mine[own[i]].steps[k] - c->steps[k]);
    p.tag = c->now;
    return true;
  });
}

/* A new atom has no history. A record of its id belongs to an atom that is gone. */
void FixHistory::follow_births() {
  if (driven) return;
  int mine = born, any;
  born = false;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return;
  std::vector<tagint> tags;
  for (int i = 0; i < atom->nlocal; i++)
    if (!known[i]) tags.push_back(known[i] = atom->tag[i]);
  tags = gather(tags, world);
  std::sort(tags.begin(), tags.end());
  filter_records([&](int, Partner &p) { return !std::binary_search(tags.begin(), tags.end(), p.tag); });
}

double FixHistory::moved_by_commands(int i, int j, const double l[2]) const {
  int k[2];
  double H[4], last[2];
  image_n(i, j, k);
  cell(H);
  const double *a = &xl[2 * (std::size_t)i], *b = &xl[2 * (std::size_t)j];
  for (int c = 0; c < 2; c++) last[c] = b[c] - a[c] + (Hl[2 * c] * k[0] + Hl[2 * c + 1] * k[1]);
  const double s1 = last[1] / Hl[3], s0 = (last[0] - Hl[1] * s1) / Hl[0];
  const double with_box = std::hypot(l[0] - (H[0] * s0 + H[1] * s1), l[1] - H[3] * s1);
  return std::min(with_box, std::hypot(l[0] - last[0], l[1] - last[1]));
}

/* ---- driven by a program ---- */

void FixHistory::set_converged(const double H[4], const double *x, const double *rotations,
                               const gh_slip *slips, int nslips) {
  const int n = atom->nlocal;
  driven = true;
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
