/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Rattlers: grains that their contacts cannot hold (Table 4.3).
 *
 * A grain is supported when the largest angular gap between its contacts is below 180 degrees. Contacts with
 * marked grains do not count, so the search is repeated until nothing changes. A gap of 180 degrees (two
 * opposite contacts, the special case of the text) holds if it carries force. */
#include "micro/internal.h"

#include <stdlib.h>
#include <string.h>

gh_status gh_rattlers_create(gh_context *ctx, int members, gh_rattlers **rattlers) {
  gh_rattlers *r;
  *rattlers = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *r, &r));
  gh_status status = gh_alloc(ctx, (size_t)members, 1, &r->flag);
  if (status == GH_OK) status = gh_alloc(ctx, (size_t)members + 2, sizeof(int), &r->start);
  if (status != GH_OK) gh_rattlers_destroy(&r);
  *rattlers = r;
  return status;
}

void gh_rattlers_destroy(gh_rattlers **rattlers) {
  if (!rattlers || !*rattlers) return;
  free((*rattlers)->flag);
  free((*rattlers)->start);
  free((*rattlers)->link);
  free((*rattlers)->angle);
  free(*rattlers);
  *rattlers = NULL;
}

/* Lists for each grain its contacts: contact number c as seen from i is 2c, as seen from j 2c+1. */
static gh_status contacts_link(gh_context *ctx, gh_rattlers *r, int n, const gh_contact *contacts,
                               int ncontacts) {
  GH_TRY(gh_grow(ctx, 2 * (size_t)ncontacts + 1, sizeof(int), &r->link_capacity, &r->link));
  GH_TRY(gh_grow(ctx, 2 * (size_t)ncontacts + 1, sizeof(double), &r->angle_capacity, &r->angle));
  memset(r->start, 0, ((size_t)n + 2) * sizeof(int));
  for (int c = 0; c < ncontacts; c++) {
    r->start[contacts[c].i + 2]++;
    r->start[contacts[c].j + 2]++;
  }
  for (int i = 2; i < n + 2; i++) r->start[i] += r->start[i - 1];
  for (int c = 0; c < ncontacts; c++) {
    r->link[r->start[contacts[c].i + 1]++] = 2 * c;
    r->link[r->start[contacts[c].j + 1]++] = 2 * c + 1;
  }
  return GH_OK;
}

/* Angles of the contacts of grain i with grains that are no rattlers, ascending; returns their number, *force
 * the largest contact force. */
static int contacts_find_angles(const gh_rattlers *r, int i, const gh_contact *contacts, double *angle,
                                double *force) {
  int count = 0;
  *force = 0;
  for (int p = r->start[i]; p < r->start[i + 1]; p++) {
    const gh_contact *c = &contacts[r->link[p] / 2];
    bool back = r->link[p] % 2;
    if (r->flag[back ? c->i : c->j]) continue;
    double a = back ? atan2(-c->l[1], -c->l[0]) : atan2(c->l[1], c->l[0]);
    int q = count++;
    for (; q > 0 && angle[q - 1] > a; q--) angle[q] = angle[q - 1];
    angle[q] = a;
    *force = gh_max(*force, hypot(c->f[0], c->f[1]));
  }
  return count;
}

static bool grain_is_rattler(const gh_rattlers *r, int i, const gh_contact *contacts, double mean_force) {
  double *angle = r->angle, force;
  int count = contacts_find_angles(r, i, contacts, angle, &force);
  if (count < 2) return true;
  double gap = angle[0] + 2 * GH_PI - angle[count - 1];
  for (int q = 1; q < count; q++) gap = gh_max(gap, angle[q] - angle[q - 1]);
  return gap > GH_PI + 1e-9 || (gap >= GH_PI - 1e-9 && force <= 1e-6 * mean_force);
}

gh_status gh_rattlers_find(gh_context *ctx, gh_rattlers *r, int n, const unsigned char *held,
                           const gh_contact *contacts, int ncontacts, double mean_force, int *count) {
  GH_TRY(contacts_link(ctx, r, n, contacts, ncontacts));
  for (int i = 0; i < n; i++) r->flag[i] = 0;
  *count = 0;
  for (bool repeat = true; repeat;) {
    repeat = false;
    for (int i = 0; i < n; i++) {
      if (r->flag[i] || (held && held[i]) || !grain_is_rattler(r, i, contacts, mean_force)) continue;
      r->flag[i] = 1;
      ++*count;
      repeat = true;
    }
  }
  return GH_OK;
}

int gh_rattlers_loose(gh_rattlers *r, int n, const unsigned char *held, const gh_contact_list *list) {
  int count = 0;
  memset(r->flag, 1, (size_t)n);
  for (int c = 0; c < list->count; c++) r->flag[list->contacts[c].i] = r->flag[list->contacts[c].j] = 0;
  for (int i = 0; i < n; i++) count += r->flag[i] && !(held && held[i]);
  return count;
}
