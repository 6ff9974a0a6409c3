/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Fix granhom/relax: many relaxation steps inside one time step of LAMMPS. */
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

/* Grains in the order of their ids: the kernel's results must not depend on LAMMPS's order. */
void FixRelax::sort_ids() {
  const int n = atom->nlocal;
  const tagint *tag = atom->tag;
  order.resize(n);
  for (int i = 0; i < n; i++) order[i] = i;
  auto less = [tag](int a, int b) { return tag[a] < tag[b]; };
  if (!std::is_sorted(order.begin(), order.end(), less)) std::sort(order.begin(), order.end(), less);
  rank.resize(n);
  held.resize(n);
  for (int r = 0; r < n; r++) {
    rank[order[r]] = r;
    held[r] = !(atom->mask[order[r]] & groupbit);
  }
}

/* Owner of atom j, by id (one rank: every ghost has its owner here). */
static int owner(const Atom *atom, const std::vector<int> &order, int j) {
  if (j < atom->nlocal) return j;
  if (atom->map_style != Atom::MAP_NONE) {
    int i = const_cast<Atom *>(atom)->map(atom->tag[j]);
    if (i >= 0 && i < atom->nlocal) return i;
  }
  const tagint *tag = atom->tag;
  return *std::lower_bound(order.begin(), order.end(), tag[j],
                           [tag](int a, tagint id) { return tag[a] < id; });
}

/* Whether the pair was within reach and skin when the list was made: grains may come back by as much as they have
 * moved since, and as far again. */
bool FixRelax::was_near(int i, int o, const double shift[2], double reach) const {
  const double *at = pair->build_x.data(), *xi = at + 3 * (std::size_t)i, *xo = at + 3 * (std::size_t)o;
  const double lx = xo[0] + shift[0] - xi[0], ly = xo[1] + shift[1] - xi[1], far = reach + neighbor->skin;
  return lx * lx + ly * ly <= far * far;
}

/* Lattice vectors from the owner o of atom j to it. */
void FixRelax::shift_of(int o, int j, double shift[2]) const {
  const double *xj = atom->x[j], *xo = atom->x[o];
  const double ky = domain->yperiodic ? std::round((xj[1] - xo[1]) / domain->yprd) : 0,
               kx = domain->xperiodic ? std::round((xj[0] - xo[0] - ky * domain->xy) / domain->xprd) : 0;
  shift[0] = kx * domain->xprd + ky * domain->xy;
  shift[1] = ky * domain->yprd;
}

/* Adds the pair to the kernel's list: lower id first, ghosts as their owner and a sum of lattice vectors.
 * With newton off a pair with a ghost is listed from both sides. A grain's own images exert no net force;
 * with friction they exert a moment, and the one of the two sides that the keys name stands for both. */
void FixRelax::add_pair(int i, int j) {
  int o = owner(atom, order, j), k[2] = {0, 0};
  if (history) history->image_n(i, j, k);
  if (o == i ? !history || k[1] < 0 || (k[1] == 0 && k[0] < 0)
             : j >= atom->nlocal && !force->newton_pair && rank[i] > rank[o])
    return;
  const double reach = atom->radius[i] + atom->radius[j];
  gh_pair p = {rank[i], rank[o], {0, 0}, reach};
  shift_of(o, j, p.shift);
  if (!was_near(i, o, p.shift, reach)) return;
  const bool swap = p.i > p.j;
  if (swap) p = {p.j, p.i, {-p.shift[0], -p.shift[1]}, reach};
  if (!history) {
    pairs.push_back(p);
    return;
  }
  gh_pair_memory m = {};
  history->branch_n(i, j, k, m.ln);
  for (double &component : m.ln) component = swap ? -component : component;
  const int record = history->find(i, atom->tag[j], k);
  if (record >= 0) {
    const FixHistory::Partner &at_n = history->record(record);
    m.gamma = at_n.gamma;
    m.gamma_pl = at_n.gamma_pl;
    m.alpha = at_n.alpha;
  }
  const int side = swap ? -1 : 1;
  candidates.push_back({p, m, {side * k[0], side * k[1]}});
}

static bool in_order(const gh_pair &a, const gh_pair &b) {
  if (a.i != b.i) return a.i < b.i;
  if (a.j != b.j) return a.j < b.j;
  if (a.shift[1] != b.shift[1]) return a.shift[1] < b.shift[1];
  return a.shift[0] < b.shift[0];
}

void FixRelax::find_pairs() {
  const NeighList *list = pair->list;
  pairs.clear();
  candidates.clear();
  for (int ii = 0; ii < list->inum; ii++) {
    int i = list->ilist[ii];
    for (int jj = 0; jj < list->numneigh[i]; jj++) add_pair(i, list->firstneigh[i][jj] & NEIGHMASK);
  }
  std::sort(pairs.begin(), pairs.end(), in_order);
  if (history) split_candidates();
  count_pairs();
}

/* With newton off a pair with a ghost is listed from both sides, a grain with its own image too. */
void FixRelax::count_pairs() {
  const NeighList *list = pair->list;
  const double *r = atom->radius;
  long halves = 0;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK, o = owner(atom, order, j);
      double shift[2];
      shift_of(o, j, shift);
      if (was_near(i, o, shift, r[i] + r[j])) halves += j < atom->nlocal || force->newton_pair ? 2 : 1;
    }
  }
  listed = halves / 2;
  listed_at = pair->builds;
}

long FixRelax::pairs_on_list() {
  if (listed_at != pair->builds) count_pairs();
  return listed;
}

/* With friction a pair is sorted with its memory; the kernel wants two lists. */
void FixRelax::split_candidates() {
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate &a, const Candidate &b) { return in_order(a.pair, b.pair); });
  pairs.resize(candidates.size());
  memory.resize(candidates.size());
  for (std::size_t c = 0; c < candidates.size(); c++) {
    pairs[c] = candidates[c].pair;
    memory[c] = candidates[c].memory;
  }
}

gh_relax_end FixRelax::kernel(gh_relax_state *s) {
  work.resize(gh_relax_work(s->n, s->npairs));
  s->work = work.data();
  pair->one_stiffness(&s->stiffness);
  return (by_fire ? gh_relax_fire : gh_relax_run)(s, tolerance, floor_force, max_steps - steps, &residual,
                                                  &mean_force, &steps);
}

gh_relax_end FixRelax::kernel_with_friction(gh_relax_state *state) {
  const std::size_t n = state->n;
  gh_contact_law law;
  coulomb->one_law(&law);
  for (auto *a : {&R, &T, &Tn, &W, &M}) a->resize(n);
  for (std::size_t r = 0; r < n; r++) {
    const int i = order[r];
    R[r] = atom->radius[i];
    T[r] = history->theta_now(i);
    Tn[r] = history->theta_converged(i);
    W[r] = atom->omega[i][2];
  }
  work.resize(gh_relax_friction_work(state->n, state->npairs));
  gh_relax_friction s = {};
  s.grains = *state;
  s.grains.work = work.data();
  s.law = &law;
  s.radius = R.data(), s.memory = memory.data(), s.theta_n = Tn.data();
  s.theta = T.data(), s.w = W.data(), s.m = M.data();
  s.watch = watched;
  const gh_relax_end how = (by_fire ? gh_relax_friction_fire : gh_relax_friction_run)(
      &s, tolerance, floor_force, max_steps - steps, &residual, &mean_force, &steps);
  state->damping = s.grains.damping;
  state->fire = s.grains.fire;
  watched = s.watch;
  for (std::size_t r = 0; turns && r < n; r++) {
    history->set_turn(order[r], T[r]);
    atom->omega[order[r]][2] = W[r];
  }
  return how;
}

/* Steps on LAMMPS's neighbour list until the end of the relaxation or of the list. */
void FixRelax::run_kernel() {
  const std::size_t n = atom->nlocal;
  sort_ids();
  find_pairs();
  for (auto *a : {&X, &V, &F, &X0}) a->resize(2 * n);
  for (std::size_t r = 0; r < n; r++)
    for (std::size_t k = 0; k < 2; k++) {
      X[2 * r + k] = atom->x[order[r]][k];
      V[2 * r + k] = atom->v[order[r]][k];
      X0[2 * r + k] = pair->build_x[3 * (std::size_t)order[r] + k];
    }
  gh_relax_state s = {};
  s.n = (int)n;
  s.held = held.data();
  s.npairs = (int)pairs.size();
  s.pairs = pairs.data();
  s.x = X.data(), s.v = V.data(), s.f = F.data(), s.x0 = X0.data();
  s.slack = neighbor->skin / 2;
  s.frame = frame;
  s.started = steps > 0;
  s.damping = damping;
  s.fire = fire;
  const long before = steps;
  const gh_relax_end how = coulomb ? kernel_with_friction(&s) : kernel(&s);
  refuse_nan();
  damping = s.damping;
  fire = s.fire;
  evaluated += (steps - before) * (long)pairs.size();
  for (std::size_t r = 0; r < n; r++) {
    if (held[r]) continue;
    for (std::size_t k = 0; k < 2; k++) {
      atom->x[order[r]][k] = X[2 * r + k];
      atom->v[order[r]][k] = V[2 * r + k];
    }
  }
  if (how == GH_RELAX_CONVERGED) end(CONVERGED);
  else if (how == GH_RELAX_UNJAMMED) end(UNJAMMED);
  else if (how == GH_RELAX_STEPS || steps >= max_steps) end(SPENT);
  if (how == GH_RELAX_REBUILD) next_reneighbor = update->ntimestep;
}
