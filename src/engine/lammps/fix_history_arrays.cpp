/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Fix granhom/history: records move with their atoms, to other ranks and into restart files. */
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

void FixHistory::grow_arrays(int nmax) {
  const std::size_t n = nmax;
  xn.resize(2 * n);
  for (auto *a : {&theta_n, &theta, &turn}) a->resize(n);
  for (auto *a : {&first, &count, &finger}) a->resize(n);
  steps.resize(2 * n);
  xw.resize(2 * n);
  fl.resize(2 * n);
  known.resize(n);
}

void FixHistory::copy_arrays(int i, int j, int) {
  moved = true;
  std::copy_n(&xn[2 * (std::size_t)i], 2, &xn[2 * (std::size_t)j]);
  theta_n[j] = theta_n[i];
  theta[j] = theta[i];
  first[j] = first[i];
  count[j] = count[i];
  known[j] = known[i];
  std::copy_n(&xw[2 * (std::size_t)i], 2, &xw[2 * (std::size_t)j]);
  std::copy_n(&fl[2 * (std::size_t)i], 2, &fl[2 * (std::size_t)j]);
}

/* A new atom is at n where it is now. */
void FixHistory::set_arrays(int i) {
  moved = true;
  unwrapped(i, &xn[2 * (std::size_t)i]);
  theta_n[i] = theta[i] = turn[i] = 0;
  first[i] = count[i] = 0;
  born = true;
  known[i] = 0;
  for (std::size_t k = 0; k < 2; k++) {
    xw[2 * (std::size_t)i + k] = NAN;
    fl[2 * (std::size_t)i + k] = 0;
  }
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

long FixHistory::slips() const {
  long mine = 0, all;
  for (int i = 0; i < atom->nlocal; i++)
    for (int r = first[i]; r < first[i] + count[i]; r++)
      if ((pool[r].gamma != 0 || pool[r].alpha > 0) && atom->tag[i] <= pool[r].tag) mine++;
  MPI_Allreduce(&mine, &all, 1, MPI_LONG, MPI_SUM, world);
  return all;
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
  buf[m++] = (double)known[i];
  for (std::size_t a = 2 * (std::size_t)i; a < 2 * (std::size_t)i + 2; a++) {
    buf[m++] = xw[a];
    buf[m++] = fl[a];
  }
  for (int r = first[i]; r < first[i] + count[i]; r++) {
    const Partner &p = pool[r];
    for (double value : {(double)p.tag, (double)p.k[0], (double)p.k[1], p.gamma, p.gamma_pl, p.alpha})
      buf[m++] = value;
  }
  return m;
}

int FixHistory::unpack(int i, const double *buf) {
  const std::size_t a = 2 * (std::size_t)i;
  xn[a] = buf[1];
  xn[a + 1] = buf[2];
  theta_n[i] = buf[3];
  theta[i] = buf[4];
  turn[i] = theta[i] - theta_n[i];
  first[i] = (int)pool.size();
  count[i] = (int)buf[5];
  const int head = (int)buf[0] - RECORD * count[i];
  const bool old = head == HEAD_1;
  known[i] = old ? atom->tag[i] : (tagint)buf[6];
  for (std::size_t k = 0; k < 2; k++) {
    xw[a + k] = old ? NAN : buf[7 + 2 * k];
    fl[a + k] = old ? 0 : (int)buf[8 + 2 * k];
  }
  born = born || !known[i];
  for (int r = 0; r < count[i]; r++) {
    const double *p = buf + head + RECORD * r;
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

/* Within a run, the run that reads the file begins where this one is. */
int FixHistory::pack_restart(int i, double *buf) {
  if (update->whichflag) note_end(i);
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
  const int size = (int)all[m], records = size > HEAD ? (int)all[m + 5] : 0, head = size - RECORD * records;
  if (size == HEAD_1 || head == HEAD || head == HEAD_1) unpack(nlocal, all + m);
  else known[nlocal] = -1;
  if (known[nlocal] && known[nlocal] != atom->tag[nlocal])
    error->one(FLERR, std::string("Pair granhom/coulomb: atoms were added, removed, reordered or renumbered "
                                  "between read_restart and the first run, so that the history in the "
                                  "restart file is not theirs: use run 0 right after read_restart"));
}

/* Lattice of n, that of the end of the last run, and the laws, so that a script with other ones is refused.
 * The lower left component of a lattice is 0: in its place stands the version, from 2 on. */
enum { VERSION = 2 };

void FixHistory::write_restart(FILE *fp) {
  if (update->whichflag) cell(Hl);
  std::vector<double> data(Hn, Hn + 4);
  data[2] = VERSION;
  data.insert(data.end(), Hl, Hl + 4);
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
  buf += sizeof H;
  const double version = H[2];
  if (version != 0 && version != VERSION)
    error->all(FLERR, "The restart file holds the history of a later version of pair granhom/coulomb: " +
                          std::to_string((int)version) + ", not " + std::to_string(VERSION));
  H[2] = 0;
  std::copy(H, H + 4, Hn);
  if (version == VERSION) {
    std::memcpy(Hl, buf, sizeof Hl);
    buf += sizeof Hl;
  }
  auto *pair = dynamic_cast<PairCoulomb *>(force->pair_match("granhom/coulomb", 1));
  if (pair) pair->compare(buf);
}

double FixHistory::memory_usage() {
  const std::size_t doubles = xn.capacity() + theta_n.capacity() + theta.capacity() + turn.capacity() +
                              xt.capacity() + theta_t.capacity() + xw.capacity() + xl.capacity(),
                    ints = first.capacity() + count.capacity() + finger.capacity() + steps.capacity() +
                           tfirst.capacity() + tcount.capacity() + owner.capacity() + fl.capacity() +
                           known.capacity();
  return (double)(doubles * sizeof(double) + ints * sizeof(int) + used.capacity() +
                  (pool.capacity() + tpool.capacity() + touched.capacity()) * sizeof(Partner));
}
