/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A packing: what a LAMMPS data file means, checked. */
#include "granhom/packing.h"
#include "granhom/io.h"

#include <stdlib.h>
#include <string.h>

void gh_packing_destroy(gh_packing **packing) {
  if (!packing || !*packing) return;
  gh_packing *p = *packing;
  free(p->id);
  free(p->type);
  free(p->radius);
  free(p->x);
  free(p);
  *packing = NULL;
}

static gh_status allocate(gh_context *ctx, int n, gh_packing *p) {
  p->n = n;
  GH_TRY(gh_alloc(ctx, (size_t)n, sizeof(int), &p->id));
  GH_TRY(gh_alloc(ctx, (size_t)n, sizeof(int), &p->type));
  GH_TRY(gh_alloc(ctx, (size_t)n, sizeof(double), &p->radius));
  return gh_alloc(ctx, 2 * (size_t)n, sizeof(double), &p->x);
}

/* A line of the file, with what the sort needs. */
typedef struct entry {
  int id, k;
} entry;

static int by_id(const void *a, const void *b) {
  const entry *p = a, *q = b;
  return p->id != q->id ? (p->id > q->id) - (p->id < q->id) : (p->k > q->k) - (p->k < q->k);
}

static gh_status check_grain(gh_context *ctx, const char *path, const gh_lammps_data *d, int k) {
  if (d->id[k] < 1) return gh_fail(ctx, GH_INPUT, "%s:%d: id %d: ids start at 1", path, d->line[k], d->id[k]);
  if (!(d->diameter[k] > 0))
    return gh_fail(ctx, GH_INPUT, "%s:%d: grain %d has the diameter %g; it must be positive", path,
                   d->line[k], d->id[k], d->diameter[k]);
  if (d->x[3 * k + 2] != 0)
    return gh_fail(ctx, GH_INPUT, "%s:%d: grain %d has z = %g; plane packings have z = 0", path, d->line[k],
                   d->id[k], d->x[3 * k + 2]);
  return GH_OK;
}

/* Like LAMMPS: a grain outside the cell stands for its image inside. */
static void wrap(const gh_packing *p, const double inverse[4], double x[2]) {
  double s[2] = {x[0] - p->low[0], x[1] - p->low[1]};
  gh_apply2(inverse, s, s);
  double k[2] = {floor(s[0]), floor(s[1])};
  for (int a = 0; a < 2; a++) x[a] -= p->cell[2 * a] * k[0] + p->cell[2 * a + 1] * k[1];
}

/* Index of a grain by its place. */
typedef struct place {
  double x[2];
  int i;
} place;

static int by_place(const void *a, const void *b) {
  const place *p = a, *q = b;
  for (int k = 0; k < 2; k++)
    if (p->x[k] != q->x[k]) return p->x[k] < q->x[k] ? -1 : 1;
  return 0;
}

/* Grains at one place have no direction to push, and a cell that its grains fill many times is a mistake of
 * units or of columns. */
static gh_status check_places(gh_context *ctx, const char *path, const gh_packing *p) {
  static const double most_filled = 20;
  double area = 0;
  for (int i = 0; i < p->n; i++) area += acos(-1) * p->radius[i] * p->radius[i];
  if (!(area <= most_filled * gh_det2(p->cell)))
    return gh_fail(
        ctx, GH_INPUT,
        "%s: the grains fill the cell %.3g times, at most %g is possible; the likely cause is units "
        "(diameters and cell must be in the same one)",
        path, area / gh_det2(p->cell), most_filled);
  place *all;
  GH_TRY(gh_alloc(ctx, (size_t)p->n, sizeof *all, &all));
  for (int i = 0; i < p->n; i++) all[i] = (place){{p->x[2 * i], p->x[2 * i + 1]}, i};
  qsort(all, (size_t)p->n, sizeof *all, by_place);
  gh_status status = GH_OK;
  for (int k = 1; k < p->n && status == GH_OK; k++)
    if (by_place(&all[k - 1], &all[k]) == 0)
      status = gh_fail(ctx, GH_INPUT, "%s: grains %d and %d are at one place, (%g, %g)", path,
                       p->id[all[k - 1].i], p->id[all[k].i], all[k].x[0], all[k].x[1]);
  free(all);
  return status;
}

static gh_status fill(gh_context *ctx, const char *path, const gh_lammps_data *d, entry *order,
                      gh_packing *p) {
  p->cell[0] = d->high[0] - d->low[0];
  p->cell[1] = d->xy;
  p->cell[3] = d->high[1] - d->low[1];
  if (d->general) memcpy(p->cell, d->cell, sizeof p->cell);
  memcpy(p->low, d->low, sizeof p->low);
  if (d->xz != 0 || d->yz != 0)
    return gh_fail(ctx, GH_INPUT, "%s: xz = %g and yz = %g tilt the cell out of the plane", path, d->xz,
                   d->yz);
  if (!(gh_det2(p->cell) > 0)) return gh_fail(ctx, GH_INPUT, "%s: the cell has no area", path);
  double inverse[4];
  gh_inv2(p->cell, inverse);
  for (int k = 0; k < d->natoms; k++) {
    GH_TRY(check_grain(ctx, path, d, k));
    order[k] = (entry){d->id[k], k};
  }
  qsort(order, (size_t)d->natoms, sizeof *order, by_id);
  for (int i = 0; i < d->natoms; i++) {
    int k = order[i].k;
    if (i && order[i].id == order[i - 1].id)
      return gh_fail(ctx, GH_INPUT, "%s:%d: id %d occurs twice (first on line %d)", path, d->line[k],
                     d->id[k], d->line[order[i - 1].k]);
    p->id[i] = d->id[k];
    p->type[i] = d->type[k];
    p->radius[i] = d->diameter[k] / 2;
    p->x[2 * i] = d->x[3 * k];
    p->x[2 * i + 1] = d->x[3 * k + 1];
    wrap(p, inverse, &p->x[2 * i]);
  }
  return check_places(ctx, path, p);
}

gh_status gh_packing_read(gh_context *ctx, const char *path, gh_packing **packing) {
  *packing = NULL;
  gh_lammps_data *data;
  GH_TRY(gh_file_expect(ctx, gh_lammps_data_read(ctx, path, &data), path, GH_FILE_PACKING));
  gh_packing *p = NULL;
  entry *order = NULL;
  gh_status status;
  if (data->natoms < 1)
    GH_TRY_OR(gh_fail(ctx, GH_INPUT, "%s: a packing needs at least one grain", path), done);
  GH_TRY_OR(gh_alloc(ctx, 1, sizeof *p, &p), done);
  GH_TRY_OR(allocate(ctx, data->natoms, p), done);
  GH_TRY_OR(gh_alloc(ctx, (size_t)data->natoms, sizeof *order, &order), done);
  GH_TRY_OR(fill(ctx, path, data, order, p), done);
  *packing = p;
  p = NULL;
done:
  free(order);
  gh_packing_destroy(&p);
  gh_lammps_data_destroy(&data);
  return status;
}

gh_status gh_packing_copy(gh_context *ctx, const gh_packing *from, gh_packing **packing) {
  gh_packing *p;
  GH_TRY(gh_alloc(ctx, 1, sizeof *p, &p));
  gh_status status = allocate(ctx, from->n, p);
  if (status != GH_OK) {
    gh_packing_destroy(&p);
    return status;
  }
  size_t n = (size_t)from->n;
  memcpy(p->id, from->id, n * sizeof(int));
  memcpy(p->type, from->type, n * sizeof(int));
  memcpy(p->radius, from->radius, n * sizeof(double));
  memcpy(p->x, from->x, 2 * n * sizeof(double));
  memcpy(p->cell, from->cell, sizeof p->cell);
  memcpy(p->low, from->low, sizeof p->low);
  *packing = p;
  return GH_OK;
}

/* LAMMPS wants an upper triangular cell with the tilt small: turns the cell by Q^T of cell = Q T, and takes
 * multiples of the first lattice vector off the second, which leaves the lattice as it is. turn: Q^T, for the
 * positions. */
static void upright(double cell[4], double turn[4]) {
  double a = hypot(cell[0], cell[2]), c = cell[0] / a, s = cell[2] / a;
  memcpy(turn, (double[4]){c, s, -s, c}, 4 * sizeof(double));
  gh_mul2(turn, cell, cell);
  cell[2] = 0;
  cell[1] -= nearbyint(cell[1] / cell[0]) * cell[0];
}

gh_status gh_packing_write(gh_context *ctx, const gh_packing *p, const char *path, const double *x,
                           const double *cell) {
  size_t n = (size_t)p->n;
  gh_lammps_data d = {.natoms = p->n, .ntypes = 1, .id = p->id, .type = p->type};
  double T[4], turn[4], *memory;
  GH_TRY(gh_alloc(ctx, 5 * n, sizeof(double), &memory));
  d.diameter = memory;
  d.density = memory + n;
  d.x = memory + 2 * n;
  memcpy(T, cell ? cell : p->cell, sizeof T);
  upright(T, turn);
  const double *from = x ? x : p->x;
  for (int i = 0; i < p->n; i++) {
    double y[2] = {from[2 * i], from[2 * i + 1]};
    if (p->type[i] > d.ntypes) d.ntypes = p->type[i];
    gh_apply2(turn, y, &d.x[3 * i]);
    d.diameter[i] = 2 * p->radius[i];
    d.density[i] = 1;
  }
  double low[2];
  gh_apply2(turn, p->low, low);
  d.low[0] = low[0], d.low[1] = low[1], d.low[2] = -0.5;
  d.high[0] = low[0] + T[0], d.high[1] = low[1] + T[3], d.high[2] = 0.5;
  d.xy = T[1];
  gh_status status = gh_lammps_data_write(ctx, path, "granhom packing, 2d disks, atom_style sphere", &d);
  free(memory);
  return status;
}

double gh_packing_mean_radius(const gh_packing *p) {
  double sum = 0;
  for (int i = 0; i < p->n; i++) sum += p->radius[i];
  return sum / p->n;
}
