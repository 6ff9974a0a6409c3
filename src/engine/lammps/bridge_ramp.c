/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The LAMMPS engine on a ramp.
 *
 * The kernel leads the packing along on one list, in the frame of the cell that LAMMPS has, which stays as it
 * is. Where the list ends, and where the ramp ends, the state that was reached becomes state n, and LAMMPS is
 * set to it: with another cell, frame, basis and images. Velocities are kept in the frame of space between
 * lists, and what was committed by the images between positions as the RVE keeps them. */
#include "engine/lammps/bridge.h"

#include "contact/slips.h"

#include <string.h>

/* ---- history ---- */

/* LAMMPS has them by (i, j): only images of one pair change places. */
static void slips_sort(gh_slip *s, int count) {
  for (int a = 1; a < count; a++) {
    const gh_slip moved = s[a];
    int b = a;
    for (; b > 0 && gh_slip_order(&s[b - 1], &moved) > 0; b--) s[b] = s[b - 1];
    s[b] = moved;
  }
}

/* The slips of state n become those that the kernel has committed. */
static gh_status slips_take(bridge *e, const gh_slip *committed, int count) {
  GH_TRY(gh_grow(e->ctx, (size_t)(count + e->nslips), sizeof *e->keyed, &e->keyed_capacity, &e->keyed));
  gh_slip *to = e->keyed;
  for (int c = 0; c < count; c++) {
    to[c] = committed[c];
    bridge_image_as_given(e, to[c].i, to[c].j, committed[c].image, to[c].image);
  }
  slips_sort(to, count);
  e->nslips = gh_slips_add_opened(to, count, e->slips, e->nslips);
  const size_t capacity = e->keyed_capacity;
  e->keyed = e->slips, e->keyed_capacity = e->slip_capacity;
  e->slips = to, e->slip_capacity = capacity;
  return gh_grow(e->ctx, (size_t)e->nslips, sizeof *e->keyed, &e->keyed_capacity, &e->keyed);
}

/* ---- frames ---- */

/* The gradient `to`, given in the frame of space, in LAMMPS's. */
static void gradient_turn(const bridge *e, const double to[4], double turned[4]) {
  const double qt[4] = {e->q[0], e->q[2], e->q[1], e->q[3]};
  double r[4];
  gh_mul2(qt, to, r);
  gh_mul2(r, e->q, turned);
}

/* Positions where the kernel has left them, e->x in LAMMPS's frame, in that of space: lattice vectors that were
 * taken off have followed, too, and are those of the present e->cell. */
static gh_status positions_unwrap(bridge *e) {
  bridge_arrays a;
  GH_TRY(bridge_atoms(e, &a));
  for (int k = 0; k < e->n; k++) {
    const int i = a.tag[k] - 1;
    double w[2], y[2];
    bridge_decode_image(a.image[k], w);
    w[1] += e->wrap[2 * i + 1];
    w[0] += e->wrap[2 * i] - e->lattice_shift * w[1];
    gh_apply2(e->q, &e->x[2 * i], y);
    for (int c = 0; c < 2; c++)
      e->given[2 * i + c] = y[c] + e->cell[2 * c] * w[0] + e->cell[2 * c + 1] * w[1];
  }
  return GH_OK;
}

/* ---- the ramp ---- */

/* What the kernel has reached becomes state n, and LAMMPS is set to it. `ramp` is in the frame of space; the
 * cell was `from` at its start. */
static gh_status ramp_follow(bridge *e, const gh_relax_ramp *ramp, const double from[4],
                             const guard_ramped *list) {
  double G[4];
  gh_relax_ramp_gradient(ramp, G);
  if (e->periodic) gh_mul2(G, from, e->cell);
  GH_TRY(positions_unwrap(e));
  GH_TRY(slips_take(e, list->slips, list->nslips));
  memcpy(e->cell_n, e->cell, sizeof e->cell_n);
  memcpy(e->x_n, e->given, 2 * (size_t)e->n * sizeof(double));
  for (int i = 0; i < e->n; i++) gh_apply2(e->q, &e->velocity[2 * i], &e->velocity[2 * i]);
  return bridge_put(e);
}

/* Along the ramp on LAMMPS's present list. */
static gh_status ramp_on_list(bridge *e, const gh_ramp *o, const double from[4], gh_relax_friction *f,
                              gh_relax_result *r, gh_relax_end *end) {
  guard_ramped list;
  gh_relax_frame frame;
  f->grains.frame = bridge_frame(e, &frame) ? &frame : NULL;
  gradient_turn(e, o->to, f->ramp->to);
  for (int i = 0; i < e->n && f->grains.started; i++)
    bridge_transpose_apply(e->q, &e->velocity[2 * i], &e->velocity[2 * i]);
  e->valid = false;
  GH_TRY(bridge_blame(e, guard_ramp(e->ctx, e->lmp, FIX, o, f, r, &list)));
  e->cost.pairs += list.pairs;
  *end = list.end;
  memcpy(f->ramp->to, o->to, sizeof f->ramp->to);
  if (!isfinite(r->residual)) return GH_OK; /* there is no state to be set; gh_engine_ramp refuses it */
  return ramp_follow(e, f->ramp, from, &list);
}

/* Rotations come from LAMMPS; those of state n follow within the kernel. */
static gh_relax_friction ramp_grains(bridge *e) {
  return (gh_relax_friction){
      .grains = {.n = e->n, .held = e->held, .x = e->x, .v = e->velocity, .f = e->force},
      .law = &e->law,
      .radius = e->radius,
      .theta_n = e->theta_n,
      .theta = e->theta,
      .w = e->spin,
      .m = e->moment};
}

gh_status bridge_ramp(void *self, const gh_ramp *o, gh_ramp_result *result) {
  bridge *e = self;
  double start = gh_seconds(), from[4];
  gh_relax_ramp ramp = {.steps = o->steps, .round_off = o->round_off};
  gh_relax_friction f = ramp_grains(e);
  gh_relax_result *r = &result->relaxed;
  gh_relax_end end = GH_RELAX_REBUILD;
  *result = (gh_ramp_result){0};
  GH_TRY(bridge_check_valid(e));
  memcpy(from, e->cell, sizeof from);
  f.ramp = &ramp;
  while (end == GH_RELAX_REBUILD && r->steps < o->max_steps) GH_TRY(ramp_on_list(e, o, from, &f, r, &end));
  r->converged = gh_relax_at_rest(end);
  r->least_damping = f.watch.least;
  result->done = ramp.done;
  result->dissipated = ramp.dissipated;
  result->slips = e->slips, result->nslips = e->nslips;
  e->cost.steps += r->steps;
  e->cost.relax_seconds += gh_seconds() - start;
  return GH_OK;
}
