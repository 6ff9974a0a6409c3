/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS fix granhom/relax: dynamic relaxation of grains to a force residual (dissertation 4.4, method 3).
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
      first_least(0), patience(0), residual(0), mean_force(0), steps(0), rebuilds(0), builds_at_start(0),
      evaluated(0), listed(0), listed_at(-1), ended_at(-1), dt(0), vf(0), ff(0), vv(0), vf_before(0),
      compare(false) {
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
  watched.patience = patience;
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
  gh_relax_friction_bound(&coulomb->law(atom->type[i], atom->type[j]), coulomb->coefficient(i, j, l, d2),
                          &along, &across);
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
    const gh_contact_law &law = coulomb->law(i, i);
    gh_relax_friction_bound(&law, law.friction_coefficient, &along, &across);
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
  fresh = ended != RUNNING; /* a run with pre no continues with what is unfinished */
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
                  committed.capacity() * sizeof(gh_slip) +
                  (order.capacity() + rank.capacity()) * sizeof(int) + held.capacity());
}
