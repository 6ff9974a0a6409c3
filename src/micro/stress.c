/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Stress, energy and other sums over the contacts of an RVE in equilibrium (methods 4, 5). */
#include "micro/internal.h"

#include <string.h>

static double grains_find_area(const gh_rve *r) {
  double area = 0;
  for (int i = 0; i < r->packing->n; i++) area += GH_PI * r->packing->radius[i] * r->packing->radius[i];
  return area;
}

/* Energy, dissipation and the number of sliding contacts. */
static gh_status friction_sum(gh_rve *r) {
  if (!gh_rve_friction(r)) return GH_OK;
  double energy = 0;
  const gh_friction *t = r->list.friction;
  for (int c = 0; c < r->list.count; c++) {
    energy += t[c].energy;
    r->m.sliding += t[c].slides != 0;
  }
  r->m.energy_t = r->m.unjammed ? 0 : energy / r->volume;
  r->m.dissipation = r->dissipated / r->volume;
  if (!isfinite(r->m.energy_t) || !isfinite(r->m.dissipation))
    return gh_fail(r->ctx, GH_DIVERGED, "the energy of the sliding contacts is not finite");
  return GH_OK;
}

/* Couples of the frame work on the rotation of F. */
static void couple_add(gh_rve *r, double P[4]) {
  double slope[4], curvature[16];
  const double couple = gh_frame_couple(r);
  gh_rotation_slope(r->F, slope, curvature);
  for (int k = 0; k < 4; k++) P[k] += couple * slope[k];
  r->m.couple = couple / r->volume;
}

gh_status gh_rve_sums(gh_rve *r) {
  double inverse[4], P[4] = {0}, energy = 0, fabric[3] = {0}, overlap = 0, copies = 0;
  int carrying = 0, engulfed = 0;
  gh_inv2(r->F, inverse);
  if (!r->m.unjammed)
    for (int c = 0; c < r->list.count; c++) {
      const gh_contact *q = &r->list.contacts[c];
      double m[2], d2 = q->l[0] * q->l[0] + q->l[1] * q->l[1];
      gh_apply2(inverse, q->l, m); /* the branch vector before the deformation */
      for (int k = 0; k < 4; k++) P[k] += q->f[k / 2] * m[k % 2];
      energy += q->energy;
      fabric[0] += q->l[0] * q->l[0] / d2;
      fabric[1] += q->l[0] * q->l[1] / d2;
      fabric[2] += q->l[1] * q->l[1] / d2;
      if (r->rattlers && (r->rattlers->flag[q->i] || r->rattlers->flag[q->j])) continue;
      carrying++;
      if (gh_frame_is_open(r->frame)) copies += 1 - gh_frame_share_of(r->frame, q);
      overlap += q->overlap;
      engulfed += q->overlap > fmin(r->radius[q->i], r->radius[q->j]);
    }
  GH_TRY(friction_sum(r));
  if (r->frame && r->frame->fixed && r->turns && !r->m.unjammed) couple_add(r, P);
  energy += r->m.energy_t * r->volume;
  for (int k = 0; k < 4; k++) r->m.P[k] = P[k] / r->volume;
  r->m.energy = energy / r->volume;
  if (!gh_finite(r->m.P, 4) || !isfinite(r->m.energy))
    return gh_fail(r->ctx, GH_DIVERGED, "the stress of the packing is not finite");
  for (int k = 0; k < 3; k++)
    r->m.fabric[k] = !r->m.unjammed && r->list.count ? fabric[k] / r->list.count : 0;
  r->m.overlap = carrying ? overlap / carrying / r->mean_radius : 0;
  r->m.engulfed = engulfed;
  gh_cauchy2(r->m.P, r->F, r->m.cauchy);
  r->m.volume_fraction = grains_find_area(r) / (r->volume * gh_det2(r->F));
  int members = r->packing->n - r->m.rattlers; /* copies count once */
  if (r->cluster) members += r->n - r->packing->n;
  r->m.coordination = r->m.unjammed || members < 1 ? 0 : 2 * (carrying - copies) / members;
  return GH_OK;
}

/* Lattice vectors (in the reference cell) that a contact of a periodic cell bridges. */
static void contact_bridge(const gh_rve *r, const gh_contact *q, const double *y, double m[2]) {
  double inverse[4], k[2];
  gh_inv2(r->F, inverse);
  gh_apply2(inverse, q->l, m);
  for (int a = 0; a < 2; a++) m[a] -= y[2 * q->j + a] - y[2 * q->i + a];
  gh_inv2(r->lattice, inverse);
  gh_apply2(inverse, m, k);
  k[0] = round(k[0]), k[1] = round(k[1]);
  gh_apply2(r->lattice, k, m);
}

gh_status gh_rve_boundary_stress(gh_rve *r, double P[4]) {
  memset(P, 0, 4 * sizeof *P);
  if (r->m.unjammed) return GH_OK;
  const double *y = r->y;
  if (r->periodic) /* (5.22): the contacts across the boundary work on the lattice vectors */
    for (int c = 0; c < r->list.count; c++) {
      double m[2];
      contact_bridge(r, &r->list.contacts[c], y, m);
      for (int k = 0; k < 4; k++) P[k] += r->list.contacts[c].f[k / 2] * m[k % 2];
    }
  for (int i = 0; i < r->n;
       i++) { /* (5.16), (5.19): external forces balance the contacts of the prescribed grains */
    const bool pulled = gh_frame_is_open(r->frame) && r->frame->edges[i];
    if (r->relaxes && !(r->held && r->held[i]) && !pulled) continue;
    for (int k = 0; k < 4; k++) P[k] -= r->list.force[2 * i + k / 2] * y[2 * i + k % 2];
  }
  for (int k = 0; k < 4; k++) P[k] /= r->volume;
  return GH_OK;
}
