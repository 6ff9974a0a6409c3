/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS's rows of contacts as contacts of the engine. */
#include "engine/lammps/bridge.h"

#include <string.h>

/* A row of the compute as a contact in the frame of space. */
static void turn_contact(const bridge *e, const double *row, gh_contact *c) {
  const double h[4] = {row[HXX], row[HXY], row[HXY], row[HYY]}, qt[4] = {e->q[0], e->q[2], e->q[1], e->q[3]};
  double r[4];
  *c = (gh_contact){
      .i = (int)row[TAG1] - 1, .j = (int)row[TAG2] - 1, .overlap = row[OVERLAP], .energy = row[ENERGY]};
  gh_apply2(e->q, row + LX, c->l);
  gh_apply2(e->q, row + FX, c->f);
  gh_mul2(e->q, h, r);
  gh_mul2(r, qt, r);
  c->h[0] = r[0];
  c->h[1] = r[1];
  c->h[2] = r[3];
}

/* The sum of lattice vectors between the branch vector and the grains' positions, free of round-off. */
static void image_shift(const bridge *e, const double *row, double shift[2]) {
  int i = (int)row[TAG1] - 1, j = (int)row[TAG2] - 1;
  double d[2] = {e->x[2 * j] - e->x[2 * i], e->x[2 * j + 1] - e->x[2 * i + 1]}, s[2];
  shift[0] = shift[1] = 0;
  if (!e->periodic) return;
  bridge_transpose_apply(e->q, d, d);
  d[0] = row[LX] - d[0];
  d[1] = row[LY] - d[1];
  bridge_lattice_coordinates(e->t, d, s);
  double ky = nearbyint(s[1]), kx = nearbyint(s[0]) - e->lattice_shift * ky;
  shift[0] = e->cell[0] * kx + e->cell[1] * ky;
  shift[1] = e->cell[2] * kx + e->cell[3] * ky;
}

/* By image with friction; else by the sum of lattice vectors, the order of the native engine. */
static bool before(const bridge *e, double **rows, int a, int b) {
  if (rows[a][TAG2] != rows[b][TAG2]) return rows[a][TAG2] < rows[b][TAG2];
  if (e->law.friction) {
    const int *p = &e->image[2 * a], *q = &e->image[2 * b];
    return p[1] != q[1] ? p[1] < q[1] : p[0] < q[0];
  }
  if (e->shift[2 * a + 1] != e->shift[2 * b + 1]) return e->shift[2 * a + 1] < e->shift[2 * b + 1];
  return e->shift[2 * a] < e->shift[2 * b];
}

/* e->order: the rows by (i, j, image), the order of the native engine. */
static void sort_rows(bridge *e, double **rows, int count) {
  memset(e->first, 0, ((size_t)e->n + 1) * sizeof(int));
  for (int a = 0; a < count; a++) e->first[(int)rows[a][TAG1]]++;
  for (int i = 0; i < e->n; i++) e->first[i + 1] += e->first[i];
  for (int a = count - 1; a >= 0;
       a--) { /* first[i+1] is the end of grain i's rows and moves to their begin */
    int p = --e->first[(int)rows[a][TAG1]];
    e->order[p] = a;
  }
  for (int p = 1; p < count; p++) {
    int a = e->order[p], b = p;
    for (; b > 0 && rows[e->order[b - 1]][TAG1] == rows[a][TAG1] && before(e, rows, a, e->order[b - 1]); b--)
      e->order[b] = e->order[b - 1];
    e->order[b] = a;
  }
}

/* The tangential part of a row in the frame of space: moments, couple and slip do not turn. */
static void turn_friction(const bridge *e, const double *row, const int *image, gh_friction *f) {
  const double *d = row + DERIVATIVE, *q = e->q, ff[4] = {d[0], d[1], d[3], d[4]},
               qt[4] = {q[0], q[2], q[1], q[3]}, fq[2] = {d[2], d[5]}, ml[2] = {d[6], d[7]};
  double r[4], a[2], b[2];
  *f = (gh_friction){.slip = {.i = (int)row[TAG1] - 1,
                              .j = (int)row[TAG2] - 1,
                              .image = {image[0], image[1]},
                              .gamma = row[GAMMA],
                              .gamma_pl = row[GAMMA_PL],
                              .alpha = row[ALPHA]},
                     .force = row[SLIP_FORCE],
                     .couple = row[COUPLE],
                     .energy = row[ENERGY_T],
                     .dissipated = row[DISSIPATED],
                     .slides = row[SLIDES] != 0};
  gh_mul2(q, ff, r);
  gh_mul2(r, qt, r);
  gh_apply2(q, fq, a);
  gh_apply2(q, ml, b);
  memcpy(f->d, (double[9]){r[0], r[1], a[0], r[2], r[3], a[1], b[0], b[1], d[8]}, sizeof f->d);
}

/* Keys and order of the rows. */
static gh_status sort_contacts(bridge *e, double **rows, int count) {
  const size_t m = (size_t)count;
  if (e->law.friction) {
    GH_TRY(gh_grow(e->ctx, 2 * m, sizeof *e->image, &e->image_capacity, &e->image));
    GH_TRY(gh_grow(e->ctx, m, sizeof *e->friction, &e->friction_capacity, &e->friction));
    for (int a = 0; a < count; a++) {
      const int k[2] = {(int)rows[a][KX], (int)rows[a][KY]};
      bridge_image_as_given(e, (int)rows[a][TAG1] - 1, (int)rows[a][TAG2] - 1, k, &e->image[2 * a]);
    }
  } else {
    GH_TRY(gh_grow(e->ctx, 2 * m, sizeof *e->shift, &e->shift_capacity, &e->shift));
    for (int a = 0; a < count; a++) image_shift(e, rows[a], &e->shift[2 * a]);
  }
  sort_rows(e, rows, count);
  return GH_OK;
}

gh_status bridge_collect(bridge *e, int *count) {
  double **rows;
  GH_TRY(guard_local(e->ctx, e->lmp, COMPUTE, count, &rows));
  size_t m = (size_t)*count;
  GH_TRY(gh_grow(e->ctx, m, sizeof *e->order, &e->order_capacity, &e->order));
  GH_TRY(gh_grow(e->ctx, m, sizeof *e->contacts, &e->contact_capacity, &e->contacts));
  GH_TRY(bridge_read_positions(e));
  GH_TRY(sort_contacts(e, rows, *count));
  for (int p = 0; p < *count; p++) {
    const int r = e->order[p];
    turn_contact(e, rows[r], &e->contacts[p]);
    if (e->law.friction) turn_friction(e, rows[r], &e->image[2 * r], &e->friction[p]);
  }
  bridge_arrays a;
  GH_TRY(bridge_atoms(e, &a));
  for (int k = 0; k < e->n; k++) gh_apply2(e->q, a.f[k], &e->force[2 * (a.tag[k] - 1)]);
  if (!e->law.friction) return GH_OK;
  double **torque;
  GH_TRY(guard_atom(e->ctx, e->lmp, "torque", &torque));
  for (int k = 0; k < e->n; k++) e->moment[a.tag[k] - 1] = torque[k][2];
  return GH_OK;
}
