/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The frame of LAMMPS's cell: lattice, images and positions there and back. */
#include "engine/lammps/bridge.h"

#include <string.h>

/* ---- frames ---- */

void bridge_transpose_apply(const double q[4], const double x[2], double y[2]) {
  double y0 = q[0] * x[0] + q[2] * x[1], y1 = q[1] * x[0] + q[3] * x[1];
  y[0] = y0;
  y[1] = y1;
}

/* cell = Q T before the reduction of the tilt. */
void bridge_split_cell(bridge *e) {
  const double *h = e->cell;
  double length = hypot(h[0], h[2]), c = h[0] / length, s = h[2] / length;
  double tilt = c * h[1] + s * h[3];
  e->lattice_shift = (int)nearbyint(tilt / length);
  memcpy(e->q, (double[4]){c, -s, s, c}, sizeof e->q);
  memcpy(e->t, (double[4]){length, tilt - e->lattice_shift * length, 0, gh_det2(h) / length}, sizeof e->t);
}

/* Lattice coordinates of y in t. */
void bridge_lattice_coordinates(const double t[4], const double y[2], double s[2]) {
  s[1] = y[1] / t[3];
  s[0] = (y[0] - t[1] * s[1]) / t[0];
}

/* ---- LAMMPS's arrays ---- */

gh_status bridge_atoms(bridge *e, bridge_arrays *a) {
  int nlocal;
  GH_TRY(guard_setting(e->ctx, e->lmp, "nlocal", &nlocal));
  if (nlocal != e->n)
    return gh_fail(e->ctx, GH_ENGINE, "LAMMPS has lost grains: %d of %d are left", nlocal, e->n);
  GH_TRY(guard_atom(e->ctx, e->lmp, "x", &a->x));
  GH_TRY(guard_atom(e->ctx, e->lmp, "f", &a->f));
  GH_TRY(guard_atom(e->ctx, e->lmp, "id", &a->tag));
  return guard_atom(e->ctx, e->lmp, "image", &a->image);
}

/* Image flags of an atom in x and y. */
void bridge_decode_image(int image, double k[2]) {
  k[0] = (image & 1023) - 512;
  k[1] = ((image >> 10) & 1023) - 512;
}

/* ---- images of state n ---- */

/* Image between positions as given, in the basis of the cell, from LAMMPS's and back. */
void bridge_image_as_given(const bridge *e, int i, int j, const int k[2], int image[2]) {
  image[1] = k[1] + (int)(e->wrap[2 * i + 1] - e->wrap[2 * j + 1]);
  image[0] = k[0] + (int)(e->wrap[2 * i] - e->wrap[2 * j]) - e->lattice_shift * image[1];
}

void bridge_image_of_lammps(const bridge *e, int i, int j, const int image[2], int k[2]) {
  k[0] = image[0] + e->lattice_shift * image[1] + (int)(e->wrap[2 * j] - e->wrap[2 * i]);
  k[1] = image[1] + (int)(e->wrap[2 * j + 1] - e->wrap[2 * i + 1]);
}

/* Lattice of n in the frame and the basis of the present cell. */
void bridge_lattice_n(const bridge *e, double H[4]) {
  memcpy(H, (double[4]){1, 0, 0, 1}, 4 * sizeof *H);
  if (!e->periodic) return;
  double a[2] = {e->cell_n[0], e->cell_n[2]}, b[2] = {e->cell_n[1], e->cell_n[3]};
  for (int k = 0; k < 2; k++) b[k] -= e->lattice_shift * a[k];
  bridge_transpose_apply(e->q, a, a);
  bridge_transpose_apply(e->q, b, b);
  memcpy(H, (double[4]){a[0], b[0], a[1], b[1]}, 4 * sizeof *H);
}

bool bridge_frame(bridge *e, gh_relax_frame *frame) {
  if (!gh_relax_frame_used(&e->frame)) return false;
  *frame = e->frame; /* areas are columns of a sum: they stay as the positions turn */
  for (int i = 0; i < e->n && e->frame.force; i++)
    bridge_transpose_apply(e->q, &e->frame.force[2 * i], &e->turned[2 * i]);
  if (e->frame.force) frame->force = e->turned;
  return true;
}

gh_status bridge_check_valid(const bridge *e) {
  if (e->valid) return GH_OK;
  return gh_fail(e->ctx, GH_ENGINE,
                 "the LAMMPS engine has no positions: gh_engine_set was not called or failed");
}

/* Positions now, unwrapped, in the frame of space. Fixed grains are where they were put, to the last bit. */
gh_status bridge_read_positions(bridge *e) {
  memcpy(e->x, e->given, 2 * (size_t)e->n * sizeof(double));
  if (!e->relaxed) return GH_OK;
  bridge_arrays a;
  GH_TRY(bridge_atoms(e, &a));
  for (int k = 0; k < e->n; k++) {
    int i = a.tag[k] - 1;
    if (e->held[i]) continue;
    double w[2];
    bridge_decode_image(a.image[k], w);
    w[0] += e->wrap[2 * i];
    w[1] += e->wrap[2 * i + 1];
    double y[2] = {a.x[k][0] + e->t[0] * w[0] + e->t[1] * w[1], a.x[k][1] + e->t[3] * w[1]};
    gh_apply2(e->q, y, &e->x[2 * i]);
  }
  return GH_OK;
}
