/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Measures of an equilibrium: residual, rattlers, coordination, fabric, areas. */
#include "direct/internal.h"

#include <stdlib.h>
#include <string.h>

double direct_residual(const gh_direct *d, const unsigned char *mask, double *mean_force) {
  const gh_contact_list *l = &d->list;
  double largest = 0, sum = 0;
  for (int i = 0; i < d->n; i++) {
    const double fx = mask[i] & GH_FIXED_X ? 0 : l->force[2 * i] + d->load[2 * i],
                 fy = mask[i] & GH_FIXED_Y ? 0 : l->force[2 * i + 1] + d->load[2 * i + 1];
    largest = gh_max(largest, hypot(fx, fy));
    if (direct_friction(d) && !d->options.law.fixed_rotations)
      largest = gh_max(largest, fabs(l->moment[i]) / d->body->radius[i]);
  }
  for (int c = 0; c < l->count; c++) sum += d->options.law.normal_stiffness * l->contacts[c].overlap;
  *mean_force = l->count ? sum / l->count : 0;
  if (largest == 0) return 0;
  return *mean_force > 0 ? largest / *mean_force : INFINITY;
}

/* ---- rattlers ---- */

static int angle_compare(const void *p, const void *q) {
  const double *a = p, *b = q;
  return (*a > *b) - (*a < *b);
}

/* Whether the contacts lie within half a circle (Table 4.3). */
static bool angles_open(double *angle, int count) {
  if (count < 3) return true;
  qsort(angle, (size_t)count, sizeof *angle, angle_compare);
  double widest = angle[0] + 2 * GH_PI - angle[count - 1];
  for (int k = 1; k < count; k++) widest = fmax(widest, angle[k] - angle[k - 1]);
  return widest >= GH_PI;
}

/* Contacts of each grain as a list: start (n + 1) and contact numbers. */
static gh_status contacts_list(const gh_direct *d, int **start, int **link) {
  const size_t n = (size_t)d->n, count = (size_t)d->list.count;
  GH_TRY(gh_alloc(d->ctx, n + 2, sizeof **start, start));
  GH_TRY(gh_alloc(d->ctx, 2 * count + 1, sizeof **link, link));
  int *s = *start;
  for (size_t c = 0; c < count; c++) s[d->list.contacts[c].i + 2]++, s[d->list.contacts[c].j + 2]++;
  for (size_t i = 2; i < n + 2; i++) s[i] += s[i - 1];
  for (size_t c = 0; c < count; c++) {
    (*link)[s[d->list.contacts[c].i + 1]++] = (int)c;
    (*link)[s[d->list.contacts[c].j + 1]++] = (int)c;
  }
  return GH_OK;
}

static bool grain_rattles(const gh_direct *d, int i, const int *start, const int *link, double *angle) {
  int count = 0;
  for (int k = start[i]; k < start[i + 1]; k++) {
    const gh_contact *q = &d->list.contacts[link[k]];
    const double sign = q->i == i ? 1 : -1;
    if (d->rattler[q->i == i ? q->j : q->i]) continue;
    angle[count++] = atan2(sign * q->l[1], sign * q->l[0]);
  }
  return direct_friction(d) ? count == 0 : angles_open(angle, count);
}

/* Grains on the boundary are supported from outside. */
static gh_status rattlers_find(gh_direct *d) {
  int *start = NULL, *link = NULL, most = 1;
  double *angle = NULL;
  gh_status status;
  memset(d->rattler, 0, (size_t)d->n);
  d->m.rattlers = 0;
  GH_TRY_OR(contacts_list(d, &start, &link), done);
  for (int i = 0; i < d->n; i++) {
    d->degree[i] = start[i + 1] - start[i];
    if (d->degree[i] > most) most = d->degree[i];
  }
  GH_TRY_OR(gh_alloc(d->ctx, (size_t)most, sizeof *angle, &angle), done);
  for (bool found = true; found;) {
    found = false;
    for (int i = 0; i < d->n; i++) {
      if (d->rattler[i] || (d->boundary[i] && d->degree[i] > 0) || !grain_rattles(d, i, start, link, angle))
        continue;
      d->rattler[i] = found = true;
      d->m.rattlers++;
    }
  }
done:
  free(start);
  free(link);
  free(angle);
  return status;
}

/* ---- areas ---- */

static void cross_add(const double a[2], const double b[2], double *area) {
  *area += (a[0] * b[1] - a[1] * b[0]) / 2;
}

/* The outline through its points below the boundary grains, which they take along, and through the nodes at its
 * corners. */
static double area_current(const gh_direct *d) {
  double area = 0, G[4];
  int k = 0;
  outline_gradient(&d->outline, d->u, G);
  for (int side = 0; side < d->outline.nsides; side++) {
    const outline_side *s = d->outline.side + side;
    const int from = d->outline.edge[s->first].a, to = d->outline.edge[s->first + s->count - 1].b;
    double a[2], b[2];
    for (int i = 0; i < 2; i++) a[i] = d->mesh->X[2 * from + i] + d->u[2 * from + i];
    for (; k < d->chain.nmembers && d->chain.member[k].side == side; k++) {
      const chain_member *m = d->chain.member + k;
      gh_apply2(G, m->offset, b);
      for (int i = 0; i < 2; i++) b[i] = d->now.x[2 * m->grain + i] - m->offset[i] - b[i];
      cross_add(a, b, &area);
      memcpy(a, b, sizeof a);
    }
    for (int i = 0; i < 2; i++) b[i] = d->mesh->X[2 * to + i] + d->u[2 * to + i];
    cross_add(a, b, &area);
  }
  return area;
}

/* ---- the whole ---- */

static void fabric_measure(gh_direct *d) {
  double *f = d->m.fabric;
  const int n = d->list.count;
  int counted = 0;
  memset(f, 0, 3 * sizeof *f);
  for (int c = 0; c < n; c++) {
    const gh_contact *q = &d->list.contacts[c];
    const double l2 = q->l[0] * q->l[0] + q->l[1] * q->l[1];
    if (d->rattler[q->i] || d->rattler[q->j]) continue;
    counted++;
    f[0] += q->l[0] * q->l[0] / l2, f[1] += q->l[0] * q->l[1] / l2, f[2] += q->l[1] * q->l[1] / l2;
  }
  for (int k = 0; k < 3 && counted; k++) f[k] /= counted;
  d->m.anisotropy = counted ? hypot(f[0] - f[2], 2 * f[1]) : 0;
  const int grains = d->n - d->m.rattlers;
  d->m.coordination = grains > 0 ? 2.0 * counted / grains : 0;
  d->m.contacts = n;
}

gh_status direct_measure(gh_direct *d) {
  GH_TRY(rattlers_find(d));
  fabric_measure(d);
  d->m.volume = d->outline.area;
  d->m.current = area_current(d);
  d->m.energy = d->energy - d->zero_energy;
  d->m.dissipation = d->now.dissipated - d->zero_dissipated;
  direct_coarsen(d);
  return GH_OK;
}
