/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Equal disks on a triangular lattice that all follow F: stress and energy in closed form. By symmetry this
 * is an equilibrium for any F, whatever the boundary condition. */
#include "study/parts.h"

#include <math.h>
#include <string.h>

static const double SAME = 1e-9; /* relative difference of lengths that count as equal */

/* Reference bond k of three. */
static void bond(const study_lattice *l, int k, double b[2]) {
  const double angle = l->angle + k * acos(-1) / 3;
  b[0] = l->spacing * cos(angle), b[1] = l->spacing * sin(angle);
}

/* Distance of x from the next place of the lattice, over the spacing. */
static double off_lattice(const study_lattice *l, const double x[2]) {
  double a[2], b[2], d[2];
  bond(l, 0, a), bond(l, 1, b);
  const double basis[4] = {a[0], b[0], a[1], b[1]};
  double inverse[4], c[2];
  gh_inv2(basis, inverse);
  gh_apply2(inverse, x, c);
  c[0] = rint(c[0]), c[1] = rint(c[1]);
  gh_apply2(basis, c, d);
  return hypot(x[0] - d[0], x[1] - d[1]) / l->spacing;
}

/* The nearest grain or image of the first grain gives spacing and direction. */
static void find_nearest(const gh_packing *p, study_lattice *l) {
  l->spacing = INFINITY;
  for (int j = 0; j < p->n; j++)
    for (int m = -2; m <= 2; m++)
      for (int n = -2; n <= 2; n++) {
        double d[2];
        for (int i = 0; i < 2; i++)
          d[i] = p->x[2 * j + i] - p->x[i] + m * p->cell[2 * i] + n * p->cell[2 * i + 1];
        double length = hypot(d[0], d[1]);
        if ((j == 0 && m == 0 && n == 0) || length >= l->spacing * (1 - SAME)) continue;
        l->spacing = length;
        l->angle = atan2(d[1], d[0]);
      }
}

gh_status study_lattice_find(gh_context *ctx, const gh_packing *p, const gh_contact_law *law,
                             study_lattice *l) {
  *l = (study_lattice){.radius = p->radius[0], .stiffness = law->normal_stiffness};
  if (law->friction) return gh_fail(ctx, GH_INPUT, "the closed form is that of frictionless disks");
  for (int i = 1; i < p->n; i++)
    if (fabs(p->radius[i] - l->radius) > SAME * l->radius)
      return gh_fail(ctx, GH_INPUT, "no triangular lattice: grains %d and %d have the radii %.9g and %.9g",
                     p->id[0], p->id[i], l->radius, p->radius[i]);
  find_nearest(p, l);
  for (int i = 1; i < p->n; i++) {
    const double x[2] = {p->x[2 * i] - p->x[0], p->x[2 * i + 1] - p->x[1]};
    if (off_lattice(l, x) > 1e3 * SAME)
      return gh_fail(ctx, GH_INPUT,
                     "no triangular lattice: grain %d is off by %.2g of the spacing %.6g between grain %d "
                     "and its nearest neighbour",
                     p->id[i], off_lattice(l, x), l->spacing, p->id[0]);
  }
  for (int k = 0; k < 2; k++) {
    const double side[2] = {p->cell[k], p->cell[2 + k]};
    if (off_lattice(l, side) > 1e3 * SAME)
      return gh_fail(ctx, GH_INPUT, "no triangular lattice: it does not fit into its cell");
  }
  const double places = gh_det2(p->cell) / (sqrt(0.75) * l->spacing * l->spacing);
  if (fabs(places - p->n) > 1e-6 * p->n)
    return gh_fail(ctx, GH_INPUT, "no triangular lattice: %d grains at %.6g places", p->n, places);
  return GH_OK;
}

/* Only nearest neighbours may touch. */
static gh_status check_others(gh_context *ctx, const study_lattice *l, const double F[4]) {
  enum { FAR = 6 };
  double a[2], b[2];
  bond(l, 0, a), bond(l, 1, b);
  for (int m = -FAR; m <= FAR; m++)
    for (int n = -FAR; n <= FAR; n++) {
      double d[2] = {m * a[0] + n * b[0], m * a[1] + n * b[1]};
      if (hypot(d[0], d[1]) < 1.5 * l->spacing) continue;
      gh_apply2(F, d, d);
      if (hypot(d[0], d[1]) < 2 * l->radius)
        return gh_fail(
            ctx, GH_INPUT,
            "the closed form does not hold at F = [%g, %g, %g, %g]: grains touch that are not next "
            "to each other",
            F[0], F[1], F[2], F[3]);
    }
  return GH_OK;
}

gh_status study_lattice_answer(gh_context *ctx, const study_lattice *l, const double F[4], double answer[9]) {
  const double volume = sqrt(0.75) * l->spacing * l->spacing; /* of a grain */
  memset(answer, 0, 9 * sizeof *answer);
  GH_TRY(check_others(ctx, l, F));
  for (int k = 0; k < 3; k++) {
    double B[2], b[2];
    bond(l, k, B);
    gh_apply2(F, B, b);
    const double length = hypot(b[0], b[1]), overlap = 2 * l->radius - length;
    if (overlap < 0) continue;
    for (int c = 0; c < 4; c++) /* P = 1/V sum f (x) B, f the force on the grain that b starts from */
      answer[c] -= l->stiffness * overlap * b[c / 2] / length * B[c % 2] / volume;
    answer[8] += 0.5 * l->stiffness * overlap * overlap / volume;
  }
  gh_cauchy2(answer, F, answer + 4);
  return GH_OK;
}
