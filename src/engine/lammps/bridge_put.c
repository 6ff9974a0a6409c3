/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS is set to a cell, positions, rotations and state n, and evaluates them. */
#include "engine/lammps/bridge.h"

#include <string.h>

/* Writes the given positions, wrapped again from them alone. */
static gh_status write_set(bridge *e) {
  bridge_arrays a;
  GH_TRY(bridge_atoms(e, &a));
  if (e->periodic) GH_TRY(guard_set_cell(e->ctx, e->lmp, FIX, e->t));
  else GH_TRY(guard_rebuild(e->ctx, e->lmp, FIX));
  for (int k = 0; k < e->n; k++) {
    int i = a.tag[k] - 1;
    double y[2], s[2], *w = &e->wrap[2 * i];
    bridge_transpose_apply(e->q, &e->given[2 * i], y);
    w[0] = w[1] = 0;
    if (e->periodic) {
      bridge_lattice_coordinates(e->t, y, s);
      w[0] = floor(s[0]);
      w[1] = floor(s[1]);
    }
    a.x[k][0] = y[0] - e->t[0] * w[0] - e->t[1] * w[1];
    a.x[k][1] = y[1] - e->t[3] * w[1];
    a.x[k][2] = 0;
    a.image[k] = NO_IMAGE;
  }
  return GH_OK;
}

/* Writes the given positions in the images that the grains are in, so that the neighbour list may hold. */
static gh_status write_move(bridge *e) {
  bridge_arrays a;
  GH_TRY(bridge_atoms(e, &a));
  for (int k = 0; k < e->n; k++) {
    int i = a.tag[k] - 1;
    double y[2], w[2];
    bridge_transpose_apply(e->q, &e->given[2 * i], y);
    bridge_decode_image(a.image[k], w);
    w[0] += e->wrap[2 * i];
    w[1] += e->wrap[2 * i + 1];
    a.x[k][0] = y[0] - e->t[0] * w[0] - e->t[1] * w[1];
    a.x[k][1] = y[1] - e->t[3] * w[1];
  }
  return GH_OK;
}

/* ---- state n ---- */

/* State n belongs to the frame and the images of the last write_set. */
static gh_status write_history(bridge *e) {
  double H[4];
  bridge_lattice_n(e, H);
  for (int i = 0; i < e->n; i++) {
    const double *w = &e->wrap[2 * i];
    double *y = &e->frame_n[2 * i];
    bridge_transpose_apply(e->q, &e->x_n[2 * i], y);
    for (int k = 0; k < 2 && e->periodic; k++) y[k] -= H[2 * k] * w[0] + H[2 * k + 1] * w[1];
  }
  for (int c = 0; c < e->nslips; c++) {
    e->keyed[c] = e->slips[c];
    bridge_image_of_lammps(e, e->slips[c].i, e->slips[c].j, e->slips[c].image, e->keyed[c].image);
  }
  return guard_history(e->ctx, e->lmp, H, e->frame_n, e->theta_n, e->keyed, e->nslips);
}

/* Grains that do not rotate stay as they were at n, whatever is asked for. */
static gh_status write_rotations(bridge *e) {
  return guard_set_rotations(e->ctx, e->lmp, e->law.fixed_rotations ? e->theta_n : e->theta);
}

gh_status bridge_blame(const bridge *e, gh_status s) {
  return s == GH_ENGINE && strstr(gh_message(e->ctx), GRANHOM_COINCIDE) ? GH_DIVERGED : s;
}

/* LAMMPS evaluates the forces at the given positions; write puts them into its arrays. The first time, and
 * the first after a failure, a `run 0` sets LAMMPS up, and what it computes is dropped. */
static gh_status evaluate(bridge *e, gh_status (*write)(bridge *)) {
  bool started = e->started;
  e->valid = e->started = e->relaxed = false;
  if (!started) {
    GH_TRY(write_set(e));
    GH_TRY(bridge_blame(e, guard_command(e->ctx, e->lmp, "run 0 post no")));
  }
  GH_TRY(write(e));
  if (e->law.friction) {
    if (!started || write == write_set) GH_TRY(write_history(e));
    GH_TRY(write_rotations(e));
  }
  GH_TRY(bridge_blame(e, guard_advance(e->ctx, e->lmp, FIX)));
  e->valid = e->started = true;
  return GH_OK;
}

/* LAMMPS sorts grains into bins of half their reach, and packings that fly apart would fill the memory with
 * empty ones. */
static gh_status check_bins(const bridge *e) {
  static const double most_bins = 1e7;
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, mean = 0, largest = 0;
  for (int i = 0; i < e->n; i++) {
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], e->given[2 * i + k]);
      high[k] = fmax(high[k], e->given[2 * i + k]);
    }
    mean += e->radius[i] / e->n;
    largest = fmax(largest, e->radius[i]);
  }
  double bin = largest + SKIN * mean / 2, width[2] = {high[0] - low[0] + 4 * bin, high[1] - low[1] + 4 * bin};
  if (e->periodic) width[0] = e->t[0], width[1] = e->t[3];
  if (width[0] / bin * (width[1] / bin) <= most_bins) return GH_OK;
  return gh_fail(e->ctx, GH_INPUT,
                 "the %s of %g by %g is too large for LAMMPS with grains of diameter %g: both must be in the "
                 "same unit (the native engine has no such limit)",
                 e->periodic ? "cell" : "packing", width[0], width[1], 2 * largest);
}

gh_status bridge_put(bridge *e) {
  if (e->periodic) bridge_split_cell(e);
  e->valid = false;
  GH_TRY(check_bins(e));
  return evaluate(e, write_set);
}

gh_status bridge_put_moved(bridge *e) {
  return evaluate(e, write_move);
}
