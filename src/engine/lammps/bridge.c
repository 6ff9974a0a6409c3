/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The LAMMPS engine: one quiet LAMMPS instance per packing.
 *
 * LAMMPS cells are upper triangular. The cell H is split into Q T (Q a rotation), a multiple of the first
 * lattice vector taken off the second until the tilt is at most half, the grains are rotated by Q^T and
 * wrapped. Vectors that come out are turned back by Q. A cluster keeps its frame and has no images.
 * gh_engine_set writes into LAMMPS's arrays and forces a new neighbour list: what follows depends on nothing
 * that came before.
 *
 * With friction, state n is kept as it was given. Each gh_engine_set turns it into the frame of that cell:
 * the same rotation, the same lattice vectors taken off the positions, and the same change of the basis, with
 * the lattice of n; keys of contacts change by the vectors taken off and by the basis. */
#include "engine/lammps/bridge.h"

#include <stdlib.h>
#include <string.h>

/* ---- making and closing ---- */

static void bridge_destroy(void *self) {
  bridge *e = self;
  if (!e) return;
  guard_close(&e->lmp);
  void *const arrays[] = {e->held,     e->given, e->x,        e->force,  e->radius,   e->type,
                          e->wrap,     e->order, e->first,    e->shift,  e->contacts, e->x_n,
                          e->theta_n,  e->theta, e->frame_n,  e->moment, e->slips,    e->keyed,
                          e->friction, e->image, e->velocity, e->spin};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  gh_relax_frame_free(&e->frame);
  free(e->turned);
  free(e);
}

static gh_status allocate(gh_context *ctx, const gh_engine_setup *setup, bridge *e) {
  size_t n = (size_t)e->n, d = sizeof(double);
  GH_TRY(gh_relax_frame_make(ctx, setup, &e->frame));
  GH_TRY(gh_alloc(ctx, n, 1, &e->held));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->given));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->x));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->force));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &e->wrap));
  GH_TRY(gh_alloc(ctx, n, d, &e->radius));
  GH_TRY(gh_alloc(ctx, n, sizeof(int), &e->type));
  if (e->law.friction) {
    GH_TRY(gh_alloc(ctx, 2 * n, d, &e->x_n));
    GH_TRY(gh_alloc(ctx, 2 * n, d, &e->frame_n));
    GH_TRY(gh_alloc(ctx, n, d, &e->theta_n));
    GH_TRY(gh_alloc(ctx, n, d, &e->theta));
    GH_TRY(gh_alloc(ctx, n, d, &e->moment));
    GH_TRY(gh_alloc(ctx, 2 * n, d, &e->velocity));
    GH_TRY(gh_alloc(ctx, n, d, &e->spin));
    GH_TRY(gh_grow(ctx, 1, sizeof(gh_friction), &e->friction_capacity, &e->friction)); /* never NULL */
  }
  return gh_alloc(ctx, n + 1, sizeof(int), &e->first);
}

/* Box of one by one, to be changed by the first set; the configuration come before it. */
static gh_status make_box(bridge *e, int types) {
  gh_context *ctx = e->ctx;
  void *lmp = e->lmp;
  GH_TRY(guard_command(ctx, lmp, "units lj"));
  GH_TRY(guard_command(ctx, lmp, "dimension 2"));
  GH_TRY(guard_command(ctx, lmp, "atom_style sphere"));
  GH_TRY(guard_command(ctx, lmp, "atom_modify map array sort 0 0"));
  GH_TRY(guard_command(ctx, lmp, "newton off"));
  GH_TRY(guard_command(ctx, lmp, "box tilt large"));
  GH_TRY(guard_command(ctx, lmp, "boundary %s", e->periodic ? "p p p" : "f f p"));
  double z = 0; /* LAMMPS refuses a box that is thin against the reach of the contacts */
  for (int i = 0; i < e->n; i++) z = fmax(z, e->radius[i]);
  GH_TRY(guard_command(ctx, lmp, "region cell %s 0 1 0 1 %.17g %.17g%s", e->periodic ? "prism" : "block", -z,
                       z, e->periodic ? " 0 0 0" : ""));
  return guard_command(ctx, lmp, "create_box %d cell", types);
}

static gh_status make_atoms(bridge *e) {
  int *id = NULL;
  double *x = NULL;
  gh_status status;
  GH_TRY_OR(gh_alloc(e->ctx, (size_t)e->n, sizeof *id, &id), done);
  GH_TRY_OR(gh_alloc(e->ctx, 3 * (size_t)e->n, sizeof *x, &x), done);
  for (int i = 0; i < e->n; i++) {
    id[i] = i + 1;
    x[3 * i] = x[3 * i + 1] = 0.5;
  }
  status = guard_create_atoms(e->ctx, e->lmp, e->n, id, e->type, x);
done:
  free(id);
  free(x);
  return status;
}

/* Radii, and the group "free" of the grains that relaxation may move. */
static gh_status set_grains(bridge *e, int free_bit) {
  double *radius;
  int *tag, *mask;
  GH_TRY(guard_atom(e->ctx, e->lmp, "radius", &radius));
  GH_TRY(guard_atom(e->ctx, e->lmp, "id", &tag));
  GH_TRY(guard_atom(e->ctx, e->lmp, "mask", &mask));
  for (int k = 0; k < e->n; k++) {
    int i = tag[k] - 1;
    radius[k] = e->radius[i];
    if (!e->held[i]) mask[k] |= free_bit;
  }
  return GH_OK;
}

static gh_status set_law(bridge *e) {
  const gh_contact_law *law = &e->law;
  if (!law->friction) {
    GH_TRY(guard_command(e->ctx, e->lmp, "pair_style granhom/normal"));
    return guard_command(e->ctx, e->lmp, "pair_coeff * * %.17g", law->normal_stiffness);
  }
  GH_TRY(guard_command(
      e->ctx, e->lmp, "pair_style granhom/coulomb increment manual slip %s rotations %s hardening %s",
      law->slip == GH_SLIP_OBJECTIVE ? "objective" : "projected", law->fixed_rotations ? "fixed" : "free",
      law->hardening_law == GH_HARDENING_PROPORTIONAL ? "proportional" : "printed"));
  return guard_command(e->ctx, e->lmp, "pair_coeff * * %.17g %.17g %.17g %.17g", law->normal_stiffness,
                       law->tangential_stiffness, law->friction_coefficient, law->hardening);
}

static gh_status set_styles(bridge *e) {
  gh_context *ctx = e->ctx;
  void *lmp = e->lmp;
  double mean = 0;
  for (int i = 0; i < e->n; i++) mean += e->radius[i] / e->n;
  int free_bit;
  GH_TRY(guard_command(ctx, lmp, "neighbor %.17g bin", SKIN * mean));
  /* one: the largest grain of a wide size distribution has thousands of candidates around it */
  GH_TRY(guard_command(ctx, lmp, "neigh_modify every 1 delay 0 check yes one 10000"));
  GH_TRY(set_law(e));
  GH_TRY(guard_command(ctx, lmp, "group free empty"));
  GH_TRY(guard_command(ctx, lmp, "fix " FIX " free granhom/relax inner yes"));
  GH_TRY(guard_command(ctx, lmp, "compute " COMPUTE " all granhom/contact/local"));
  /* Thermo output that needs no energy: LAMMPS would ask for it at steps that were not tallied. */
  GH_TRY(guard_command(ctx, lmp, "thermo_style custom step"));
  GH_TRY(guard_command(ctx, lmp, "thermo 0"));
  GH_TRY(guard_command(ctx, lmp, "uncompute thermo_press")); /* else each run tallies energy and virial */
  GH_TRY(guard_command(ctx, lmp, "uncompute thermo_pe"));
  GH_TRY(guard_drive(ctx, lmp, FIX, e->periodic, &free_bit));
  return set_grains(e, free_bit);
}

static gh_status take_setup(bridge *e, const gh_engine_setup *s, int *types) {
  *types = 1;
  memcpy(e->radius, s->radius, (size_t)e->n * sizeof(double));
  if (s->held) memcpy(e->held, s->held, (size_t)e->n);
  for (int i = 0; i < e->n; i++) {
    e->type[i] = s->type ? s->type[i] : 1;
    if (e->type[i] > *types) *types = e->type[i];
  }
  if (*types > MOST_TYPES)
    return gh_fail(e->ctx, GH_INPUT, "the LAMMPS engine takes at most %d types of grains, not %d", MOST_TYPES,
                   *types);
  return GH_OK;
}

static gh_status bridge_create(gh_context *ctx, const gh_engine_setup *setup, void **self) {
  bridge *e;
  int types;
  gh_status status;
  GH_TRY(gh_alloc(ctx, 1, sizeof *e, &e));
  *e = (bridge){.ctx = ctx, .n = setup->n, .periodic = setup->periodic, .law = setup->law, .q = {1, 0, 0, 1}};
  GH_TRY_OR(allocate(ctx, setup, e), failed);
  GH_TRY_OR(take_setup(e, setup, &types), failed);
  GH_TRY_OR(guard_open(ctx, &e->lmp), failed);
  GH_TRY_OR(make_box(e, types), failed);
  GH_TRY_OR(make_atoms(e), failed);
  GH_TRY_OR(set_styles(e), failed);
  *self = e;
  return GH_OK;
failed:
  bridge_destroy(e);
  return status;
}

/* ---- the engine's calls ---- */

static gh_status bridge_begin(void *self, const gh_converged *state) {
  bridge *e = self;
  const size_t n = (size_t)e->n, slips = (size_t)state->nslips;
  const size_t room = 2 * slips; /* a ramp puts those that it commits beside them, in either of the two */
  GH_TRY(gh_grow(e->ctx, room, sizeof *e->slips, &e->slip_capacity, &e->slips));
  GH_TRY(gh_grow(e->ctx, room, sizeof *e->keyed, &e->keyed_capacity, &e->keyed));
  memcpy(e->x_n, state->x, 2 * n * sizeof(double));
  memcpy(e->theta_n, state->theta, n * sizeof(double));
  if (slips) memcpy(e->slips, state->slips, slips * sizeof *e->slips);
  if (e->periodic) memcpy(e->cell_n, state->cell, sizeof e->cell_n);
  e->nslips = state->nslips;
  e->valid = false; /* until the next gh_engine_set */
  return GH_OK;
}

static gh_status bridge_set(void *self, const double cell[4], const double *x, const double *theta) {
  bridge *e = self;
  double start = gh_seconds();
  if (e->periodic) memcpy(e->cell, cell, sizeof e->cell);
  memcpy(e->given, x, 2 * (size_t)e->n * sizeof(double));
  if (e->law.friction) memcpy(e->theta, theta, (size_t)e->n * sizeof(double));
  gh_status status = bridge_put(e);
  e->cost.set_seconds += gh_seconds() - start;
  return status;
}

static gh_status bridge_move(void *self, const double *x, const double *theta) {
  bridge *e = self;
  double start = gh_seconds();
  GH_TRY(bridge_check_valid(e));
  memcpy(e->given, x, 2 * (size_t)e->n * sizeof(double));
  if (e->law.friction) memcpy(e->theta, theta, (size_t)e->n * sizeof(double));
  gh_status status = bridge_put_moved(e);
  e->cost.set_seconds += gh_seconds() - start;
  return status;
}

static gh_status bridge_load(void *self, const double *force, const double *moment) {
  bridge *e = self;
  if (force && !e->turned) GH_TRY(gh_alloc(e->ctx, 2 * (size_t)e->n, sizeof(double), &e->turned));
  return gh_relax_frame_load(e->ctx, e->n, force, moment, &e->frame);
}

static gh_status relax(bridge *e, const gh_relax_options *o, gh_relax_result *r) {
  guard_relaxed end;
  gh_relax_frame frame;
  GH_TRY(bridge_check_valid(e));
  e->valid = e->started = false;
  GH_TRY(bridge_blame(e, guard_relax(e->ctx, e->lmp, FIX, o, bridge_frame(e, &frame) ? &frame : NULL, &end)));
  e->valid = e->started = e->relaxed = true;
  *r = (gh_relax_result){end.residual, end.mean_force, end.steps, end.converged, end.least_damping};
  e->cost.steps += r->steps;
  e->cost.pairs += end.pairs;
  return GH_OK;
}

static gh_status bridge_relax(void *self, const gh_relax_options *options, gh_relax_result *result) {
  bridge *e = self;
  double start = gh_seconds();
  *result = (gh_relax_result){0};
  gh_status status = options->max_steps < 1 ? GH_OK : relax(e, options, result);
  e->cost.relax_seconds += gh_seconds() - start;
  return status;
}

static gh_status bridge_contacts(void *self, gh_contact_list *list) {
  bridge *e = self;
  double start = gh_seconds();
  GH_TRY(bridge_check_valid(e));
  int count;
  long pairs;
  GH_TRY(guard_pairs(e->ctx, e->lmp, FIX, &pairs));
  GH_TRY(bridge_collect(e, &count));
  *list = (gh_contact_list){.count = count,
                            .contacts = e->contacts,
                            .friction = e->friction,
                            .force = e->force,
                            .moment = e->moment};
  e->cost.evaluations++;
  e->cost.pairs += pairs;
  e->cost.contact_seconds += gh_seconds() - start;
  return GH_OK;
}

static gh_status bridge_get(void *self, double *x, double *theta) {
  bridge *e = self;
  GH_TRY(bridge_check_valid(e));
  GH_TRY(bridge_read_positions(e));
  memcpy(x, e->x, 2 * (size_t)e->n * sizeof(double));
  return e->law.friction ? guard_get_rotations(e->ctx, e->lmp, theta) : GH_OK;
}

static void bridge_costs(const void *self, gh_engine_cost *cost) {
  const bridge *e = self;
  *cost = e->cost;
  guard_builds(e->ctx, e->lmp, FIX, &cost->rebuilds);
}

const gh_engine_ops gh_lammps_ops = {.name = "lammps",
                                     .create = bridge_create,
                                     .destroy = bridge_destroy,
                                     .begin = bridge_begin,
                                     .set = bridge_set,
                                     .move = bridge_move,
                                     .load = bridge_load,
                                     .relax = bridge_relax,
                                     .ramp = bridge_ramp,
                                     .contacts = bridge_contacts,
                                     .get = bridge_get,
                                     .costs = bridge_costs};
