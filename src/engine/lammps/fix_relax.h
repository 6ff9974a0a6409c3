/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS fix granhom/relax: dynamic relaxation of grains to a force residual. */
#ifndef GRANHOM_LAMMPS_FIX_RELAX_H
#define GRANHOM_LAMMPS_FIX_RELAX_H

#include "engine/lammps/c_mpi.h"
#include "engine/lammps/guard.h"
#include "engine/relax/relax_fire.h"

#include "fix.h"

#include <vector>

namespace granhom {

class FixHistory;
class PairCoulomb;
class PairNormal;

class FixRelax : public LAMMPS_NS::Fix {
public:
  FixRelax(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);
  int setmask() override;
  void init() override;
  void setup(int vflag) override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  void initial_integrate(int vflag) override;
  void final_integrate() override;
  void post_run() override;
  int pack_reverse_comm(int n, int first, double *buf) override;
  void unpack_reverse_comm(int n, int *list, double *buf) override;
  double compute_vector(int n) override;
  double memory_usage() override;

  /* ---- for a program that drives LAMMPS through its library (guard.h) ---- */

  /* From now on the fix does nothing in a step unless relax_next() was called, and the cell may change
   * between steps. Before the first run, which sets LAMMPS up; all that follows is advance(). */
  void drive(bool periodic);
  /* One time step as LAMMPS's run_style verlet makes it, without a command to be parsed and without output.
   */
  void advance();
  /* The box becomes [0, lx] x [0, ly] with the tilt xy; the lists are rebuilt in the next step. */
  void set_cell(double lx, double ly, double xy);
  void rebuild_next();
  /* The next steps relax, until finished(). */
  void relax_next(const gh_relax_options &o, const gh_relax_frame *frame);
  bool finished() const { return ended != RUNNING; }
  void idle() { active = false; }
  int group_bit() const { return groupbit; }
  long builds() const;
  /* Pairs on LAMMPS's list as the kernel sees it: those that were within reach and skin when it was made,
   * each once. */
  long pairs_on_list();
  /* Of the last relaxation. */
  void tell(guard_relaxed *r) const;
  /* Between time steps, with friction: see guard_ramp. */
  void ramp(const gh_ramp &o, gh_relax_friction *s, gh_relax_result *r, guard_ramped *list);

private:
  enum state { RUNNING, CONVERGED, UNJAMMED, SPENT };

  double tolerance, floor_force;
  long max_steps;
  bool inner;                           /* steps are made inside one time step, by the kernel */
  bool by_fire;                         /* FIRE instead of damped central differences */
  bool driven, cluster, active, forced; /* forced: the run was ended through LAMMPS's timer */
  PairNormal *pair;
  PairCoulomb *coulomb; /* the same with friction; null without */
  FixHistory *history;  /* null without friction */
  bool turns;           /* grains rotate */

  state ended;
  bool fresh;                            /* the next step begins a new relaxation */
  double damping;                        /* of the kernel's last step, carried from list to list */
  gh_fire fire;                          /* the same, of FIRE */
  gh_relax_watch watched;                /* the same, with friction */
  const gh_relax_frame *frame = nullptr; /* of the next steps; a program's own */
  double first_least;                    /* least damping to begin with */
  long patience;                         /* gh_relax_options */
  double residual, mean_force;
  long steps, rebuilds, builds_at_start;
  long evaluated, listed, listed_at; /* pairs; listed: of the list number listed_at */
  LAMMPS_NS::bigint ended_at;        /* time step */

  /* one step per time step: last sums over the grains, see measure() */
  double dt, vf, ff, vv, vf_before;
  bool compare;
  std::vector<double> block; /* 6 per atom: xx yy zz xy xz yz of a grain's own stiffness; with friction the
                                third coordinate is r theta/sqrt(2) */

  struct Candidate {
    gh_pair pair;
    gh_pair_memory memory;
    int k[2]; /* image of the pair, between unwrapped positions */
  };
  std::vector<Candidate> candidates;

  /* inner steps: the grains in the order of their ids */
  std::vector<int> order, rank;
  std::vector<unsigned char> held;
  std::vector<gh_pair> pairs;
  std::vector<double> X, V, F, X0, work;
  std::vector<gh_pair_memory> memory;
  std::vector<double> R, T, Tn, W, M; /* radii, rotations now and at n, their velocities, moments */
  std::vector<gh_slip> committed;     /* on a ramp */

  void begin();
  void parse(int narg, char **arg);
  void check_inner();
  void measure();
  void refuse_nan();
  double largest_force();
  void judge();
  void add_blocks();
  double time_step();
  void add_block(int i, int j, const double *l, double d2);
  void add_block_with_friction(int i, int j, const double *l, double d2);
  void step();
  void turn(double a, double b);
  void sort_ids();
  void find_pairs();
  void count_pairs();
  void add_pair(int i, int j);
  bool was_near(int i, int o, const double shift[2], double reach) const;
  void shift_of(int o, int j, double shift[2]) const;
  void split_candidates();
  void note_committed();
  gh_relax_end kernel(gh_relax_state *s);
  gh_relax_end kernel_with_friction(gh_relax_state *s);
  void run_kernel();
  void surround();
  void stop_run();
  void start();
  void renew_lists();
  void end(state how);
};

} // namespace granhom

#endif
