/* LAMMPS fix granhom/relax: dynamic relaxation of grains to a force residual (dissertation 4.4, method 3).
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * Unit masses, central differences (4.39), (4.40), damping 2 sqrt(lambda) with lambda from the Rayleigh
 * quotient of the last step. Positions move in initial_integrate, so that forces, energies, ghosts and
 * neighbour list that LAMMPS makes afterwards in the same step belong to them. */
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

enum { BOUND_EVERY = 32 }; /* steps between two bounds of the largest eigenvalue */

FixRelax::FixRelax(LAMMPS *l, int narg, char **arg)
    : Fix(l, narg, arg), tolerance(1e-8), floor_force(0), max_steps(LONG_MAX), inner(false), by_fire(false),
      driven(false), cluster(false), active(true), forced(false), pair(nullptr), coulomb(nullptr),
      history(nullptr), turns(false), ended(RUNNING), fresh(true), damping(0), fire(), watched(),
      first_least(0), residual(0), mean_force(0), steps(0), rebuilds(0), builds_at_start(0), evaluated(0),
      listed(0), listed_at(-1), ended_at(-1), dt(0), vf(0), ff(0), vv(0), vf_before(0), compare(false) {
  parse(narg, arg);
  time_integrate = 1;
  vector_flag = 1;
  size_vector = 5;
  extvector = 0;
  comm_reverse = 6;
  if (by_fire && !inner)
    error->all(FLERR, std::string("Fix granhom/relax with method fire requires inner yes"));
  if (inner) {
    force_reneighbor = 1;
    next_reneighbor = -1;
    if (comm->nprocs > 1)
      error->all(FLERR, std::string("Fix granhom/relax with inner yes requires one MPI rank"));
    if (domain->dimension != 2)
      error->all(FLERR, std::string("Fix granhom/relax with inner yes requires a 2d simulation"));
  }
}

/* Relaxation steps of one relaxation with inner yes where max_steps is not given. */
static const long INNER_STEPS = 10000000;

void FixRelax::parse(int narg, char **arg) {
  for (int k = 3; k < narg; k += 2) {
    if (k + 1 >= narg)
      error->all(FLERR, std::string("Illegal fix granhom/relax command: no value for ") + arg[k]);
    std::string word = arg[k], value = arg[k + 1];
    if (word == "inner") {
      if (value != "yes" && value != "no")
        error->all(FLERR, "Illegal fix granhom/relax command: inner is yes or no, not " + value);
      inner = value == "yes";
    } else if (word == "method") {
      if (value != "damped" && value != "fire")
        error->all(FLERR, "Illegal fix granhom/relax command: method is damped or fire, not " + value);
      by_fire = value == "fire";
    } else if (word == "max_steps") {
      max_steps = utils::bnumeric(FLERR, arg[k + 1], false, lmp);
      if (max_steps < 1)
        error->all(FLERR, "Illegal fix granhom/relax command: max_steps must be positive, not " + value);
    } else if (word == "tolerance" || word == "floor") {
      double number = utils::numeric(FLERR, arg[k + 1], false, lmp);
      if (!(number >= 0) || !std::isfinite(number))
        error->all(FLERR,
                   "Illegal fix granhom/relax command: " + word + " must not be negative, not " + value);
      (word == "floor" ? floor_force : tolerance) = number;
    } else error->all(FLERR, "Illegal fix granhom/relax command: unknown keyword " + word);
  }
  /* within one time step nothing else ends a relaxation that does not converge */
  if (inner && max_steps == LONG_MAX) max_steps = INNER_STEPS;
}

int FixRelax::setmask() {
  return PRE_EXCHANGE | INITIAL_INTEGRATE | FINAL_INTEGRATE | POST_RUN;
}

void FixRelax::init() {
  if (std::strncmp(update->integrate_style, "respa", 5) == 0)
    error->all(FLERR, std::string("Fix granhom/relax does not run with run_style respa"));
  pair = PairNormal::require(lmp, "Fix granhom/relax");
  pair->driven_by_program(driven);
  coulomb = dynamic_cast<PairCoulomb *>(pair);
  history = coulomb ? coulomb->history() : nullptr;
  turns = coulomb && coulomb->turning();
  if (history) history->turns_elsewhere(true);
  if (inner) check_inner();
}

/* The kernel knows the contact forces of one law and nothing else. */
void FixRelax::check_inner() {
  double E;
  gh_contact_law law;
  if (force->pair != pair || force->bond || force->kspace)
    error->all(FLERR, std::string("Fix granhom/relax with inner yes: ") + force->pair_style +
                          " must be the only force");
  if (coulomb ? !coulomb->one_law(&law) : !pair->one_stiffness(&E))
    error->all(FLERR, std::string("Fix granhom/relax with inner yes requires one ") +
                          (coulomb ? "law" : "stiffness") + " for all types");
  if (coulomb && coulomb->each_step())
    error->all(FLERR,
               std::string("Fix granhom/relax with inner yes requires granhom/coulomb with increment manual: "
                           "its steps are not time steps"));
  for (int k = 0; k < modify->nfix; k++)
    if ((modify->fmask[k] & POST_FORCE) && std::strcmp(modify->fix[k]->style, "enforce2d") != 0)
      error->all(FLERR, std::string("Fix granhom/relax with inner yes: fix ") + modify->fix[k]->id +
                            " changes forces, use inner no");
  if (neighbor->nex_type || neighbor->nex_group || neighbor->nex_mol)
    error->all(FLERR, std::string("Fix granhom/relax with inner yes allows no neigh_modify exclude"));
}

void FixRelax::begin() {
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) std::fill(atom->v[i], atom->v[i] + 3, 0.0);
  for (int i = 0; turns && i < atom->nlocal; i++) atom->omega[i][2] = 0;
  fresh = compare = false;
  steps = rebuilds = evaluated = 0;
  residual = mean_force = damping = vf = ff = vv = vf_before = 0;
  watched = gh_relax_watch();
  watched.least = first_least;
  builds_at_start = pair->builds;
  ended = RUNNING;
  ended_at = -1;
  dt = 0;
}

/* Begins a relaxation at the positions whose forces LAMMPS has just computed. */
void FixRelax::start() {
  begin();
  if (driven) return;
  measure();
  if (inner) return; /* the kernel judges */
  steps = 1;
  judge();
}

void FixRelax::setup(int) {
  if (!driven) start();
}

/* ---- one step per time step ---- */

/* Residual and mean normal contact force at the forces that LAMMPS has computed, and the sums over what is
 * free from which step() gets the Rayleigh quotient: v.f, f.f, v.v, for rotations in the metric of the
 * inertia r^2/2. One reduction each for sums and maximum. */
void FixRelax::measure() {
  double mine[5] = {pair->force_sum, pair->contact_count, 0, 0, 0}, sum[5], largest = 0, most;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *v = atom->v[i], *f = atom->f[i];
    double f2 = 0;
    for (int k = 0; k < domain->dimension; k++) {
      f2 += f[k] * f[k];
      mine[2] += v[k] * f[k];
      mine[4] += v[k] * v[k];
    }
    mine[3] += f2;
    largest = std::max(largest, f2);
  }
  for (int i = 0; turns && i < atom->nlocal; i++) {
    const double rim = atom->torque[i][2] / atom->radius[i], speed = atom->omega[i][2] * atom->radius[i];
    mine[2] += speed * rim;
    mine[3] += 2 * rim * rim;
    mine[4] += 0.5 * speed * speed;
    largest = std::max(largest, rim * rim);
  }
  MPI_Allreduce(mine, sum, 5, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(&largest, &most, 1, MPI_DOUBLE, MPI_MAX, world);
  mean_force = sum[1] > 0 ? sum[0] / sum[1] : 0;
  most = sum[3] <= GH_RELAX_MOST && most >= GH_RELAX_LEAST ? std::sqrt(most) : largest_force();
  residual = mean_force > 0 ? most / mean_force : 0;
  if (!std::isfinite(most) || !std::isfinite(mean_force)) residual = NAN;
  refuse_nan();
  vf = sum[2];
  ff = sum[3];
  vv = sum[4];
}

/* Who drives the fix from outside refuses it there, and may try a shorter step. */
void FixRelax::refuse_nan() {
  if (driven || std::isfinite(residual)) return;
  const char *const text =
      "Fix granhom/relax: a force is not finite (two grains at one place, or stiffness and "
      "lengths whose product no number holds: choose other units)";
  error->all(FLERR, std::string(text));
}

/* The largest force or moment over the radius of all ranks, slowly, but for numbers whose squares overflow or
 * underflow; NaN or inf where one is. */
double FixRelax::largest_force() {
  double mine = 0, most;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *f = atom->f[i];
    if (atom->mask[i] & groupbit) {
      const double size = std::hypot(f[0], f[1], domain->dimension == 3 ? f[2] : 0);
      mine = std::isfinite(size) ? std::max(mine, size) : INFINITY;
    }
    if (!turns) continue;
    const double rim = std::fabs(atom->torque[i][2] / atom->radius[i]);
    mine = std::isfinite(rim) ? std::max(mine, rim) : INFINITY;
  }
  MPI_Allreduce(&mine, &most, 1, MPI_DOUBLE, MPI_MAX, world);
  return most;
}

void FixRelax::judge() {
  if (mean_force <= floor_force && (floor_force > 0 || ff <= 0)) end(UNJAMMED);
  else if (mean_force > 0 && residual <= tolerance) end(CONVERGED);
  else if (steps >= max_steps) end(SPENT);
}

void FixRelax::end(state how) {
  ended = how;
  ended_at = update->ntimestep;
  if (how == UNJAMMED) residual = 0;
}

void FixRelax::add_block(int i, int j, const double *l, double d2) {
  double s = pair->stiffness(atom->type[i], atom->type[j]) / d2;
  const double b[6] = {s * l[0] * l[0], s * l[1] * l[1], s * l[2] * l[2],
                       s * l[0] * l[1], s * l[0] * l[2], s * l[1] * l[2]};
  for (int k = 0; k < 6; k++) {
    block[6 * (std::size_t)i + k] += b[k];
    if (force->newton_pair || j < atom->nlocal) block[6 * (std::size_t)j + k] += b[k];
  }
}

/* Bounds of relax_friction.c; the slip is t.(u_i - u_j) + r_i theta_i + r_j theta_j. */
void FixRelax::add_block_with_friction(int i, int j, const double *l, double d2) {
  double along, across;
  gh_relax_friction_bound(&coulomb->law(atom->type[i], atom->type[j]), &along, &across);
  const double n[2] = {l[0] / std::sqrt(d2), l[1] / std::sqrt(d2)}, turn = turns ? std::sqrt(2.) : 0;
  for (int side = 0; side < (j < atom->nlocal ? 2 : 1); side++) {
    const double t[3] = {side ? n[1] : -n[1], side ? -n[0] : n[0], turn};
    const double b[6] = {along * n[0] * n[0] + across * t[0] * t[0],
                         along * n[1] * n[1] + across * t[1] * t[1],
                         across * t[2] * t[2],
                         along * n[0] * n[1] + across * t[0] * t[1],
                         across * t[0] * t[2],
                         across * t[1] * t[2]};
    for (int k = 0; k < 6; k++) block[6 * (std::size_t)(side ? j : i) + k] += b[k];
  }
}

/* The stiffness block of each grain from the contacts that it has or nearly has. */
void FixRelax::add_blocks() {
  const NeighList *list = pair->list;
  const int nlocal = atom->nlocal, newton = force->newton_pair;
  block.assign(6 * (std::size_t)(nlocal + atom->nghost), 0.0);
  for (int ii = 0; ii < list->inum; ii++) {
    int i = list->ilist[ii];
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      int j = list->firstneigh[i][jj] & NEIGHMASK;
      const double *xi = atom->x[i], *xj = atom->x[j];
      double l[3] = {xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2]};
      double d2 = l[0] * l[0] + l[1] * l[1] + l[2] * l[2], reach = atom->radius[i] + atom->radius[j];
      if (d2 > 1.01 * reach * reach) continue;
      if (coulomb) add_block_with_friction(i, j, l, d2);
      else add_block(i, j, l, d2);
    }
  }
  if (newton) granhom::reverse_comm(comm, this);
}

int FixRelax::pack_reverse_comm(int n, int first, double *buf) {
  std::copy_n(block.data() + 6 * (std::size_t)first, 6 * (std::size_t)n, buf);
  return 6 * n;
}

void FixRelax::unpack_reverse_comm(int n, int *list, double *buf) {
  for (int a = 0; a < n; a++)
    for (int k = 0; k < 6; k++) block[6 * (std::size_t)list[a] + k] += buf[6 * a + k];
}

/* Below the stability limit: the largest eigenvalue is at most twice that of the grains' own blocks, and that
 * is at most m + sqrt((d-1)/d) |K - m 1| with the mean m of its d eigenvalues (an equality for d = 2). */
double FixRelax::time_step() {
  add_blocks();
  const int unknowns = coulomb ? 3 : domain->dimension;
  const double d = unknowns;
  double mine[2] = {0, 0}, all[2];
  for (int i = 0; i < atom->nlocal; i++) {
    const double *k = &block[6 * (std::size_t)i];
    double m = (k[0] + k[1] + k[2]) / d, dev = 2 * (k[3] * k[3] + k[4] * k[4] + k[5] * k[5]);
    for (int c = 0; c < unknowns; c++) dev += (k[c] - m) * (k[c] - m);
    mine[0] = std::max(mine[0], m + std::sqrt((d - 1) / d * dev));
  }
  for (int i = 1; i <= atom->ntypes; i++) {
    mine[1] = std::max(mine[1], pair->stiffness(i, i));
    if (!coulomb) continue;
    double along, across;
    gh_relax_friction_bound(&coulomb->law(i, i), &along, &across);
    mine[1] = std::max(mine[1], 4 * std::max(along, (turns ? 3 : 1) * across));
  }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, world);
  return gh_relax_time_step(std::max(2 * all[0], all[1]));
}

void FixRelax::step() {
  double up = vf_before - vf, lambda = compare ? gh_relax_quotient(up, dt * vv) : 0,
         c = 2 * std::sqrt(lambda);
  if ((steps - 1) % BOUND_EVERY == 0 || dt == 0) dt = time_step();
  double a = compare ? (2 - c * dt) / (2 + c * dt) : 0, b = compare ? 2 * dt / (2 + c * dt) : dt / 2;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int k = 0; k < domain->dimension; k++) {
      atom->v[i][k] = a * atom->v[i][k] + b * atom->f[i][k];
      atom->x[i][k] += dt * atom->v[i][k];
    }
  }
  if (turns) turn(a, b);
  vf_before = a * vf + b * ff;
  compare = true;
}

/* Grains outside the group rotate too (Remark 7.3). */
void FixRelax::turn(double a, double b) {
  for (int i = 0; i < atom->nlocal; i++) {
    const double r = atom->radius[i];
    double &w = atom->omega[i][2];
    w = a * w + b * atom->torque[i][2] / (0.5 * r * r);
    history->set_turn(i, history->theta_now(i) + dt * w);
  }
}

/* ---- many steps inside one time step ---- */

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

/* Adds the pair to the kernel's list: lower id first, ghosts as their owner and a sum of lattice vectors.
 * With newton off a pair with a ghost is listed from both sides. A grain's own images exert no net force;
 * with friction they exert a moment, and the one of the two sides that the keys name stands for both. */
void FixRelax::add_pair(int i, int j) {
  int o = owner(atom, order, j), k[2] = {0, 0};
  if (history) history->image(i, j, k);
  if (o == i ? !history || k[1] < 0 || (k[1] == 0 && k[0] < 0)
             : j >= atom->nlocal && !force->newton_pair && rank[i] > rank[o])
    return;
  const double *xi = atom->x[i], *xj = atom->x[j], *xo = atom->x[o];
  double reach = atom->radius[i] + atom->radius[j], far = reach + neighbor->skin;
  double lx = xj[0] - xi[0], ly = xj[1] - xi[1];
  if (lx * lx + ly * ly > far * far) return;
  double ky = domain->yperiodic ? std::round((xj[1] - xo[1]) / domain->yprd) : 0;
  double kx = domain->xperiodic ? std::round((xj[0] - xo[0] - ky * domain->xy) / domain->xprd) : 0;
  gh_pair p = {rank[i], rank[o], {kx * domain->xprd + ky * domain->xy, ky * domain->yprd}, reach};
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
  candidates.push_back({p, m});
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
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      const double lx = atom->x[j][0] - atom->x[i][0], ly = atom->x[j][1] - atom->x[i][1],
                   far = r[i] + r[j] + neighbor->skin;
      if (lx * lx + ly * ly <= far * far) halves += j < atom->nlocal || force->newton_pair ? 2 : 1;
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

/* ---- the time step ---- */

void FixRelax::initial_integrate(int) {
  if (!active) return;
  if (fresh) start();
  if (ended != RUNNING) return;
  if (inner) run_kernel();
  else step();
}

void FixRelax::final_integrate() {
  if (!active) return;
  if (!inner && ended == RUNNING) {
    measure();
    steps++;
    judge();
  }
  rebuilds = pair->builds - builds_at_start;
  if (ended != RUNNING && !driven) stop_run();
}

/* The run ends by LAMMPS's timer. In a script it ends with a time step in which nothing moves and thermo
 * output is due: energies and stress are tallied there, and a following run may start with pre no. */
void FixRelax::stop_run() {
  const bigint now = update->ntimestep;
  const bool thermo_now = output->next_thermo == now;
  if (thermo_now && now > ended_at) {
    timer->force_timeout();
    forced = true;
  } else if (!thermo_now && now < update->laststep) {
    modify->addstep_compute_all(now + 1);
    output->next_thermo = now + 1;
    output->next = std::min(output->next, now + 1);
  }
}

void FixRelax::post_run() {
  if (forced) timer->reset_timeout();
  forced = false;
  if (driven || !update->nsteps) return;
  if (ended == RUNNING || ended == SPENT) {
    char text[160];
    snprintf(text, sizeof text,
             "Fix granhom/relax: not converged, residual %g above the tolerance %g after %ld steps", residual,
             tolerance, steps);
    if (comm->me == 0) error->warning(FLERR, std::string(text));
  }
  fresh = ended != RUNNING; /* a run with pre no goes on with what is unfinished */
}

double FixRelax::compute_vector(int n) {
  const double values[] = {residual, mean_force, (double)steps, (double)rebuilds,
                           ended == CONVERGED  ? 1.
                           : ended == UNJAMMED ? 2.
                                               : 0.};
  if (n < 0 || n >= (int)(sizeof values / sizeof *values)) /* thermo does not look at indices below 1 */
    error->all(FLERR, "Fix granhom/relax has no value " + std::to_string((long)n + 1));
  return values[n];
}

double FixRelax::memory_usage() {
  std::size_t doubles = 0;
  for (const auto *a : {&block, &X, &V, &F, &X0, &work, &R, &T, &Tn, &W, &M}) doubles += a->capacity();
  return (double)(doubles * sizeof(double) + pairs.capacity() * sizeof(gh_pair) +
                  memory.capacity() * sizeof(gh_pair_memory) + candidates.capacity() * sizeof(Candidate) +
                  (order.capacity() + rank.capacity()) * sizeof(int) + held.capacity());
}

/* ---- driven by a program ---- */

void FixRelax::drive(bool periodic) {
  driven = true;
  active = false;
  cluster = !periodic;
  box_change = BOX_CHANGE_X | BOX_CHANGE_Y | (periodic ? BOX_CHANGE_XY : 0);
}

/* Neighbours anew: pre_exchange brings grains back into the box, or the box to the grains. */
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

void FixRelax::relax_next(const gh_relax_options &o) {
  tolerance = o.tolerance;
  floor_force = o.floor;
  max_steps = o.max_steps;
  by_fire = o.method == GH_RELAX_FIRE;
  first_least = o.least_damping;
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
