/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS fix granhom/history: the converged state n of pair style granhom/coulomb.
 *
 * The pair style makes it at the start of the first run. Each atom keeps its own record of every partner, so
 * that it takes them along to another rank, and keys them by the partner's id and the lattice vectors between
 * the unwrapped positions: wrapping does not change those. The trial state is written down where it was
 * evaluated, positions included, and becomes state n later (commit), whatever has moved meanwhile. */
#ifndef GRANHOM_LAMMPS_FIX_HISTORY_H
#define GRANHOM_LAMMPS_FIX_HISTORY_H

#include "engine/lammps/c_mpi.h"
#include "granhom/contact.h"

#include "fix.h"

#include <vector>

namespace granhom {

class FixHistory : public LAMMPS_NS::Fix {
public:
  static constexpr const char *ID = "granhom_history";
  static constexpr const char *STAYS =
      "Fix granhom_history holds the slip of the contacts of pair style granhom/coulomb: it may not be "
      "removed "
      "or replaced. To drop all history: pair_style none, then pair_style granhom/coulomb again";

  struct Partner {
    LAMMPS_NS::tagint tag;
    int k[2]; /* image of the partner: l = x_partner + H k - x with unwrapped positions */
    double gamma, gamma_pl, alpha;
  };

  FixHistory(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);
  ~FixHistory() override;
  int setmask() override;
  void init() override;
  void post_run() override;
  void initial_integrate(int vflag) override;
  void post_integrate() override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  int modify_param(int narg, char **arg) override;
  double memory_usage() override;

  void grow_arrays(int nmax) override;
  void copy_arrays(int i, int j, int delflag) override;
  void set_arrays(int i) override;
  int pack_exchange(int i, double *buf) override;
  int unpack_exchange(int nlocal, double *buf) override;
  int pack_restart(int i, double *buf) override;
  void unpack_restart(int nlocal, int nth) override;
  int size_restart(int nlocal) override;
  int maxsize_restart() override;
  void write_restart(FILE *fp) override;
  void restart(char *buf) override;
  int pack_forward_comm(int n, int *list, double *buf, int pbc_flag, int *pbc) override;
  void unpack_forward_comm(int n, int first, double *buf) override;

  /* ---- for the pair style ---- */

  /* The pair style's pointer to this fix, null when the fix goes. */
  void held_by(FixHistory **pointer) { holder = pointer; }
  /* Of all ranks: contacts with slip at n. */
  long slips() const;
  /* each_step: state n is the end of the last time step, else it stays until a commit. turns: rotations
   * follow omega. keep_alpha: contacts that have opened keep alpha (of use with hardening only). */
  void configure(bool each_step, bool turns, bool keep_alpha);
  /* Brings the ghosts up to date; positions are those of now. new_list: the neighbour list is new. */
  void refresh(bool new_list);
  bool fresh() const { return ghosts_known; } /* ghosts belong to the neighbour list */
  /* At the first forces of a run, after refresh(): how far commands between the runs have moved
   * atom j against atom i, beyond what the box carried along; l = x_j - x_i. NaN: one of them is new. */
  bool starts() const { return starting; }
  double moved_by_commands(int i, int j, const double l[2]) const;
  /* Image of j as atom i sees it; i is owned. */
  void image_n(int i, int j, int k[2]) const;
  /* Branch vector at n, and theta - theta_n. */
  void branch_n(int i, int j, const int k[2], double ln[2]) const;
  double turned(int i) const { return turn[i]; }
  /* Record of owned atom i; -1: there is none. */
  int find(int i, LAMMPS_NS::tagint tag, const int k[2]) const;
  const Partner &record(int index) const { return pool[index]; }
  void begin_trial();
  bool keeps_alpha() const { return keep_alpha; }
  void mark(int index) { used[index] = 1; } /* its contact is closed: alpha need not be kept for it */
  void touch(int i, const Partner &p);
  void end_trial();
  /* The trial state becomes state n. Without one since the last commit: nothing. */
  void commit();

  /* ---- for fix granhom/relax, which turns the grains itself ---- */

  void turns_elsewhere(bool yes) { elsewhere = yes; }
  void set_turn(int i, double new_theta) { theta[i] = new_theta; }
  double theta_now(int i) const { return theta[i]; }
  double theta_converged(int i) const { return theta_n[i]; }

  /* ---- for a program that drives LAMMPS: arrays by id - 1, one rank ---- */

  /* State n: lattice (columns), positions as LAMMPS's unwrapped ones (n x 2), rotations, history. */
  void set_converged(const double H[4], const double *x, const double *rotations, const gh_slip *slips,
                     int nslips);
  void set_rotations(const double *rotations);
  void get_rotations(double *rotations) const;

private:
  /* Where an atom that no command has moved is found at the start of a run, as part of the period: with
   * setup, and without, when fixes of before this one have moved it by a time step. A packing that a command
   * has moved by just this less than a whole period is refused, so the second is no round number. */
  static constexpr double ROUNDED = 1e-9, STEPPED = 0.4142;
  /* Numbers of a partner, and before the partners of an atom: now, and in restart files of before version 2
   */
  enum { RECORD = 6, HEAD = 11, HEAD_1 = 6 };

  bool each_step = true, turns = true, keep_alpha = false, elsewhere = false;
  bool driven = false; /* by a program, which gives state n itself */
  FixHistory **holder = nullptr;
  /* state n */
  double Hn[4];
  std::vector<double> xn, theta_n; /* xn, turn and steps: of ghosts too */
  std::vector<int> first, count;   /* partners of an atom: pool[first ... first + count) */
  std::vector<Partner> pool;
  /* end of the last run: what differs from it at the start of the next was done by commands */
  double Hl[4];
  std::vector<double> xw;               /* as LAMMPS has it; NaN: not known */
  std::vector<int> fl;                  /* image flags */
  std::vector<LAMMPS_NS::tagint> known; /* id; 0: a new atom */
  bool born = false;                    /* there may be new atoms here */
  bool starting = false;                /* the forces to come are the first of a run */
  bool awaited = true;                  /* reconcile() is due: since the end of the last run */
  std::vector<double> xl;               /* unwrapped, of ghosts too, for the start of a run only */
  bool sending_last = false;
  /* now */
  std::vector<double> theta, turn;
  std::vector<int> steps; /* 2 per atom: lattice vectors from the owner's unwrapped position to the atom */
  bool ghosts_known = false, new_ghosts = false;
  /* trial */
  bool trial = false;
  bool moved = true; /* atoms have come, gone or changed places since forces were computed */
  double Ht[4];
  std::vector<double> xt, theta_t;
  std::vector<int> tfirst, tcount, owner;
  std::vector<Partner> touched, tpool;
  std::vector<char> used;
  std::vector<int> local, place;   /* scratch of set_converged */
  mutable std::vector<int> finger; /* where the last search of an atom ended */
  /* flips of the box */
  bool stepping = false;
  double tilt_before = 0;

  void cell(double H[4]) const;
  void unwrapped(int i, double x[2]) const;
  void follow_flip();
  struct Change { /* of an atom, by commands between runs */
    LAMMPS_NS::tagint before, now;
    LAMMPS_NS::tagint steps[2]; /* lattice vectors that its unwrapped position gained */
  };
  bool reconcile(double near);
  void note_end(int i);
  bool follow_images(int i, double near, Change *c);
  void place_new(int i);
  void rekey(const std::vector<Change> &mine);
  void follow_births();
  template <typename Keep> void filter_records(Keep keep);
  void carry_alpha();
  void compact();
  int most_partners() const;
  int pack(int i, double *buf) const;
  int unpack(int i, const double *buf);
};

} // namespace granhom

#endif
