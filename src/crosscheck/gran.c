/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS's own pair style gran/hooke/history along a path, in this process.
 *
 * The motion from row to row must reach the contacts as velocities: the style integrates the tangential
 * displacement from them, and grains that are moved with the box (`remap x`) would leave their springs
 * behind. So the grains get the velocity field of the deforming cell, the cell follows with `remap v`, and
 * after the last step the field is taken off again. */
#include "crosscheck/peers.h"

#include "granhom/lammps.h"

#include <stdlib.h>
#include <string.h>

/* Columns of the computes. The style gives the tangential force as p1, p2; `force` is the normal force. */
enum { DISTANCE, NORMAL, NORMAL_X, NORMAL_Y, SHEAR_X, SHEAR_Y };
static const double BALANCE = 1e-9; /* of the list of contacts and LAMMPS's virial */

typedef struct gran {
  gh_context *ctx;
  const gh_peer_problem *p;
  peer_motion m;
  peer_cell cell;
  void *lmp;
} gran;

#define DO(...) GH_TRY(gh_lmp_command(g->ctx, g->lmp, __VA_ARGS__))

/* ---- setting up ---- */

static gh_status make_atoms(gran *g) {
  int n = g->p->n, *id = NULL, *type = NULL;
  double *x = NULL;
  gh_status status;
  GH_TRY_OR(gh_alloc(g->ctx, (size_t)n, sizeof *id, &id), done);
  GH_TRY_OR(gh_alloc(g->ctx, (size_t)n, sizeof *type, &type), done);
  GH_TRY_OR(gh_alloc(g->ctx, 3 * (size_t)n, sizeof *x, &x), done);
  for (int i = 0; i < n; i++) {
    id[i] = i + 1;
    type[i] = 1;
    x[3 * i] = 0.5 * (g->cell.t[0] + g->cell.t[1]);
    x[3 * i + 1] = 0.5 * g->cell.t[3];
  }
  status = gh_lmp_create_atoms(g->ctx, g->lmp, n, id, type, x);
done:
  free(id);
  free(type);
  free(x);
  return status;
}

/* Positions, wrapped into the cell, radii and masses. */
static gh_status fill_atoms(gran *g) {
  double **x, *radius, *mass;
  int *tag;
  const double *t = g->cell.t, *q = g->cell.q;
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "x", &x));
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "radius", &radius));
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "rmass", &mass));
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "id", &tag));
  for (int k = 0; k < g->p->n; k++) {
    const double *at = g->p->x + 2 * (tag[k] - 1);
    double y[2] = {q[0] * at[0] + q[2] * at[1], q[1] * at[0] + q[3] * at[1]}; /* q^T x */
    double up = floor(y[1] / t[3]), right = floor((y[0] - t[1] * y[1] / t[3]) / t[0]);
    x[k][0] = y[0] - t[0] * right - t[1] * up;
    x[k][1] = y[1] - t[3] * up;
    radius[k] = g->p->radius[tag[k] - 1];
    mass[k] = 1;
  }
  return GH_OK;
}

static gh_status make_box(gran *g) {
  const double *t = g->cell.t;
  double z = 0;
  for (int i = 0; i < g->p->n; i++) z = fmax(z, g->p->radius[i]);
  DO("units lj");
  DO("dimension 2");
  DO("atom_style sphere");
  DO("atom_modify map array sort 0 0");
  DO("newton off");
  DO("comm_modify vel yes");
  DO("box tilt large");
  DO("boundary p p p");
  DO("region cell prism 0 %.17g 0 %.17g %.17g %.17g %.17g 0 0", t[0], t[3], -z, z, t[1]);
  DO("create_box 1 cell");
  GH_TRY(make_atoms(g));
  return fill_atoms(g);
}

static gh_status make_styles(gran *g) {
  const peer_motion *m = &g->m;
  DO("neighbor %.17g bin", m->skin);
  DO("neigh_modify every 1 delay 0 check yes one 10000");
  DO("pair_style gran/hooke/history %.17g %.17g %.17g %.17g %.17g 1", m->kn, m->kt, m->contact, m->contact,
     m->mu);
  DO("pair_coeff * *");
  DO("timestep %.17g", m->dt);
  DO("fix move all %s", m->rotate ? "nve/sphere disc" : "nve");
  DO("fix plane all enforce2d");
  DO("fix drag all viscous %.17g", m->viscous);
  DO("compute contact all pair/local dist force fx fy p1 p2 cutoff radius");
  DO("compute pressure all pressure NULL virial");
  DO("thermo_style custom step");
  DO("thermo 0");
  return gh_lmp_command(g->ctx, g->lmp, "run 0 post no");
}

/* ---- from row to row ---- */

/* Adds the velocity field sign (to - from)/time now^-1 x, which carries the cell `from` to `to`. */
static gh_status add_field(gran *g, const double from[4], const double to[4], const double now[4],
                           double rate) {
  double **x, **v, field[4], inverse[4];
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "x", &x));
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "v", &v));
  gh_inv2(now, inverse);
  for (int k = 0; k < 4; k++) field[k] = rate * (to[k] - from[k]);
  gh_mul2(field, inverse, field);
  for (int k = 0; k < g->p->n; k++) {
    double w[2];
    gh_apply2(field, x[k], w);
    v[k][0] += w[0];
    v[k][1] += w[1];
  }
  return GH_OK;
}

static gh_status go(gran *g, int row) {
  peer_cell next;
  peer_cell_find(g->p, row, &next);
  const double *from = g->cell.t, *to = next.t;
  if (memcmp(from, to, sizeof next.t) != 0) {
    double rate = 1 / (g->p->steps_per_row * g->m.dt);
    GH_TRY(add_field(g, from, to, from, rate));
    DO("unfix drag");
    DO("fix cell all deform 1 x final 0 %.17g y final 0 %.17g xy final %.17g remap v flip no units box",
       to[0], to[3], to[1]);
    DO("run %d post no", g->p->steps_per_row);
    DO("unfix cell");
    GH_TRY(add_field(g, from, to, to, -rate));
    DO("fix drag all viscous %.17g", g->m.viscous);
    DO("run 0 post no");
  }
  g->cell = next;
  return GH_OK;
}

/* ---- what is measured ---- */

/* The normal force on grain 1 lies along the branch vector, of which LAMMPS reports the length alone. */
static bool read_contact(const double *row, double l[2], double f[2]) {
  if (row[NORMAL] == 0) return false; /* a touch without overlap */
  for (int c = 0; c < 2; c++) {
    l[c] = -row[NORMAL_X + c] * row[DISTANCE] / row[NORMAL];
    f[c] = row[NORMAL_X + c] + row[SHEAR_X + c];
  }
  return true;
}

/* Stress and mean force, turned as `cell` states. */
static gh_status sum_contacts(gran *g, const peer_cell *cell, gh_peer_row *r) {
  int count;
  double **rows;
  peer_sum sum = {0};
  GH_TRY(gh_lmp_local(g->ctx, g->lmp, "contact", &count, &rows));
  for (int k = 0; k < count; k++) {
    double l[2], force[2];
    if (read_contact(rows[k], l, force)) peer_add(&sum, l, force);
  }
  peer_close(&sum, cell, r);
  return GH_OK;
}

/* The residual takes the drag too: forces alone may be small in passing. */
static gh_status measure(gran *g, gh_peer_row *r) {
  double **f, **v, **torque, *radius, largest = 0;
  GH_TRY(sum_contacts(g, &g->cell, r));
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "f", &f));
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "v", &v));
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "torque", &torque));
  GH_TRY(gh_lmp_atom(g->ctx, g->lmp, "radius", &radius));
  for (int k = 0; k < g->p->n; k++) {
    double drag[2] = {g->m.viscous * v[k][0], g->m.viscous * v[k][1]};
    const double sizes[] = {hypot(f[k][0] + drag[0], f[k][1] + drag[1]), hypot(drag[0], drag[1]),
                            g->m.rotate ? fabs(torque[k][2]) / radius[k] : 0};
    for (int c = 0; c < 3; c++)
      if (!(sizes[c] <= largest)) largest = sizes[c]; /* NaN stays */
  }
  r->residual = largest / (r->mean_force + g->m.floor);
  return GH_OK;
}

/* One more step, with LAMMPS's own sums. compute pair/local has been seen to use a list of neighbours that no
 * longer held: its contacts must give LAMMPS's virial. */
static gh_status finish_row(gran *g, gh_peer_row *r) {
  static const int component[3] = {0, 3, 2}; /* xx, yy, xy = x_branch y_force, which is s21 */
  gh_peer_row turned = *r;
  double p[3], worst = 0, q[4] = {1, 0, 0, 1};
  DO("fix virial all ave/time 1 1 1 c_pressure[1] c_pressure[2] c_pressure[4]");
  DO("run 1 post no");
  for (int c = 0; c < 3; c++) GH_TRY(gh_lmp_fix_vector(g->ctx, g->lmp, "virial", c, p + c));
  DO("unfix virial");
  DO("run 0 post no"); /* runs without setup may follow */
  GH_TRY(measure(g, r));
  peer_cell upright = {0};
  memcpy(upright.q, q, sizeof q);
  memcpy(upright.t, g->cell.t, sizeof upright.t);
  GH_TRY(sum_contacts(g, &upright, &turned));
  for (int c = 0; c < 3; c++) worst = gh_max(worst, fabs(p[c] + turned.cauchy[component[c]]));
  double size = fmax(fabs(p[0]), fabs(p[1]));
  if (worst <= BALANCE * size || r->contacts == 0) return GH_OK;
  return gh_fail(g->ctx, GH_ENGINE,
                 "LAMMPS's list of %d contacts does not give its virial: they differ by %.2g of it",
                 r->contacts, worst / size);
}

/* ---- the path ---- */

static gh_status relax(gran *g, double end, gh_peer_row *r, gh_peer_result *result) {
  for (r->steps = 0; r->steps < g->p->max_steps;) {
    DO("run %ld pre no post no", g->m.steps_a_check);
    r->steps += g->m.steps_a_check;
    GH_TRY(measure(g, r));
    if (r->residual <= g->p->tolerance) {
      GH_TRY(finish_row(g, r));
      r->steps++;
      if (r->residual <= g->p->tolerance) return GH_OK;
    }
    if (gh_seconds() > end) {
      peer_end(result, GH_PEER_STOPPED, "row %d: stopped after %g s with the residual %.2g", result->rows,
               g->p->seconds, r->residual);
      return GH_OK;
    }
  }
  peer_end(result, GH_PEER_FAILED, "row %d: no equilibrium within %ld time steps: residual %.2g",
           result->rows, g->p->max_steps, r->residual);
  return GH_OK;
}

static gh_status walk(gran *g, gh_peer_row *row, gh_peer_result *result) {
  double end = gh_seconds() + g->p->seconds;
  GH_TRY(gh_lmp_open(g->ctx, &g->lmp));
  GH_TRY(make_box(g));
  GH_TRY(make_styles(g));
  while (result->rows < g->p->rows) {
    GH_TRY(go(g, result->rows));
    GH_TRY(relax(g, end, row + result->rows, result));
    if (result->end != GH_PEER_DONE) break;
    row[result->rows++].steps += g->p->steps_per_row;
  }
  return GH_OK;
}

gh_status peer_lammps(gh_context *ctx, const gh_peer_problem *p, gh_peer_row *row, gh_peer_result *result) {
  gran g = {.ctx = ctx, .p = p, .m = peer_motion_of(p)};
  peer_cell_find(p, -1, &g.cell);
  gh_status status = walk(&g, row, result);
  gh_lmp_close(&g.lmp);
  if (status == GH_ENGINE) { /* what LAMMPS states is a result, not an error of this program */
    peer_end(result, GH_PEER_FAILED, "row %d: %s", result->rows, gh_message(ctx));
    status = GH_OK;
  }
  return status;
}
