/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the peers share. */
#ifndef GRANHOM_CROSSCHECK_PEERS_H
#define GRANHOM_CROSSCHECK_PEERS_H

#include "granhom/crosscheck.h"

/* Cell of a row in the peers' frame, which has the first lattice vector along x: F_row cell = q t, q a
 * rotation. row -1: before the path. */
typedef struct peer_cell {
  double q[4], t[4]; /* t[2] == 0 */
} peer_cell;
void peer_cell_find(const gh_peer_problem *p, int row, peer_cell *c);

/* Numbers of the damped motion. Grains have the mass 1, whatever their size: equilibrium does not depend on
 * the masses, and equal ones relax fastest. */
typedef struct peer_motion {
  double dt;
  double viscous; /* drag force over velocity of each grain (fix viscous) */
  double contact; /* damping of relative motion in contacts, over the mass of the pair (gamma_n, gamma_t) */
  double skin;    /* of neighbour lists */
  double floor;   /* added to the mean force in the residual: grains without contacts come to rest too */
  double kn, kt, mu;  /* kt > 0 also without friction, where mu = 0 */
  bool rotate;        /* moments turn grains */
  long steps_a_check; /* between two checks of the residual */
} peer_motion;
peer_motion peer_motion_of(const gh_peer_problem *p);

/* Takes part in the sums of a row; f: force on the grain that the branch vector l starts from. */
typedef struct peer_sum {
  double s[4], normal;
  int contacts;
} peer_sum;
void peer_add(peer_sum *sum, const double l[2], const double f[2]);
/* Stress in the frame of F, mean force and number of contacts. */
void peer_close(const peer_sum *sum, const peer_cell *c, gh_peer_row *row);

/* Ends with a message. */
void peer_end(gh_peer_result *r, gh_peer_end end, const char *format, ...) GH_PRINTF(3, 4);

gh_status peer_lammps(gh_context *ctx, const gh_peer_problem *p, gh_peer_row *row, gh_peer_result *r);
gh_status peer_liggghts(gh_context *ctx, const gh_peer_problem *p, gh_peer_row *row, gh_peer_result *r);

#endif
