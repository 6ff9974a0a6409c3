/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The LAMMPS engine's state, and what its files share. */
#ifndef GRANHOM_LAMMPS_BRIDGE_H
#define GRANHOM_LAMMPS_BRIDGE_H

#include "engine/lammps/contact_columns.h"
#include "engine/lammps/guard.h"
#include "engine/ops.h"

#define FIX "relax"
#define COMPUTE "contacts"
/* Skin over the mean radius: see docs/reports/performance.md for the measurement. */
#define SKIN 0.2
enum { GH_CONTACT_COLUMNS };
enum { NO_IMAGE = (512 << 20) | (512 << 10) | 512 };
enum { MOST_TYPES = 1000 };

typedef struct bridge {
  gh_context *ctx;
  void *lmp;
  int n;
  bool periodic;
  bool started; /* LAMMPS is set up */
  bool valid;   /* LAMMPS's state belongs to `given` and what relaxation made of it */
  bool relaxed; /* the free grains have moved from `given` */
  double cell[4], q[4], t[4];
  int lattice_shift; /* multiples of the first lattice vector taken off the second */
  unsigned char *held;
  gh_relax_frame frame; /* external forces in the frame of space */
  double *turned;       /* n x 2: the same in LAMMPS's; NULL: there are none */
  double *given;        /* n x 2: positions as set or moved */
  double *x;            /* n x 2: positions now */
  double *force;        /* n x 2 */
  double *radius;       /* n */
  int *type;            /* n */
  double *wrap;         /* n x 2: lattice vectors of t taken off before LAMMPS saw the grain */
  int *order, *first;   /* scratch: rows by grain */
  double *shift;
  gh_contact *contacts;
  /* with friction only */
  gh_contact_law law;
  double cell_n[4];
  double *x_n, *theta_n; /* n x 2, n: state n as given */
  double *theta;         /* n: rotations as set or moved */
  double *frame_n;       /* n x 2: x_n as LAMMPS is to know it */
  double *moment;
  double *velocity, *spin; /* n x 2, n: on a ramp */
  gh_slip *slips, *keyed;  /* nslips: as given, with LAMMPS's keys */
  gh_friction *friction;
  int *image; /* scratch: 2 per row */
  int nslips;
  size_t slip_capacity, keyed_capacity, friction_capacity, image_capacity;
  size_t order_capacity, shift_capacity, contact_capacity;
  gh_engine_cost cost;
} bridge;

/* LAMMPS's arrays. */
typedef struct bridge_arrays {
  double **x, **f;
  int *tag, *image;
} bridge_arrays;

/* ---- bridge_frame.c ---- */

void bridge_transpose_apply(const double q[4], const double x[2], double y[2]);
/* cell = Q T before the reduction of the tilt. */
void bridge_split_cell(bridge *e);
/* Lattice coordinates of y in t. */
void bridge_lattice_coordinates(const double t[4], const double y[2], double s[2]);
gh_status bridge_atoms(bridge *e, bridge_arrays *a);
/* Image flags of an atom in x and y. */
void bridge_decode_image(int image, double k[2]);
/* Image between positions as given, in the basis of the cell, from LAMMPS's and back. */
void bridge_image_as_given(const bridge *e, int i, int j, const int k[2], int image[2]);
void bridge_image_of_lammps(const bridge *e, int i, int j, const int image[2], int k[2]);
/* Lattice of n in the frame and the basis of the present cell. */
void bridge_lattice_n(const bridge *e, double H[4]);
/* For relaxation in LAMMPS's frame; false: nothing is to be heeded. */
bool bridge_frame(bridge *e, gh_relax_frame *frame);
gh_status bridge_check_valid(const bridge *e);
/* Where a contact has no direction, what the packing has come to is at fault, not LAMMPS. */
gh_status bridge_blame(const bridge *e, gh_status s);
/* Positions now, unwrapped, in the frame of space. Fixed grains are where they were put, to the last bit. */
gh_status bridge_read_positions(bridge *e);

/* ---- bridge_put.c ---- */

/* LAMMPS evaluates the packing at e->cell, e->given and e->theta with state n. */
gh_status bridge_put(bridge *e);
/* The same where only e->given and e->theta have changed, by little. */
gh_status bridge_put_moved(bridge *e);

/* ---- bridge_ramp.c ---- */

gh_status bridge_ramp(void *self, const gh_ramp *ramp, gh_ramp_result *result);

/* ---- bridge_contacts.c ---- */

/* Contacts, forces and moments of the state that LAMMPS has, into *e. */
gh_status bridge_collect(bridge *e, int *count);

#endif
