/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Rattlers: grains that their contacts cannot hold (Table 4.3).
 *
 * A grain is supported when the largest angular gap between its contacts is below 180 degrees. Contacts with
 * marked grains do not count, so the search is repeated until nothing changes. A gap of 180 degrees (two
 * opposite contacts, the special case of the text) holds if it carries force. */
#include "micro/internal.h"

#include <stdlib.h>
#include <string.h>

/* Of gaps of half a turn: radians. */
static const double angle_tolerance = 1e-9;

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
  free((*rattlers)->direction);
  free(*rattlers);
  *rattlers = NULL;
}

/* Lists for each grain its contacts: contact number c as seen from i is 2c, as seen from j 2c+1. */
static gh_status contacts_link(gh_context *ctx, gh_rattlers *r, int n, const gh_contact *contacts,
                               int ncontacts) {
  GH_TRY(gh_grow(ctx, 2 * (size_t)ncontacts + 1, sizeof(int), &r->link_capacity, &r->link));
  GH_TRY(
      gh_grow(ctx, 2 * (size_t)ncontacts + 1, sizeof *r->direction, &r->direction_capacity, &r->direction));
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

/* Contact number `link` of grain i as that grain sees it. */
static bool contact_is_back(int link) {
  return link % 2;
}

/* Grows with the angle of a direction, from 0 along x to 4. */
static double direction_order(const double n[2]) {
  const double along = n[0] / (fabs(n[0]) + fabs(n[1]));
  return n[1] >= 0 ? 1 - along : 3 + along;
}

/* Directions of the contacts of grain i with grains that are no rattlers, by ascending angle; returns their
 * number. */
static int contacts_find_directions(const gh_rattlers *r, int i, const gh_contact *contacts, double (*n)[3]) {
  int count = 0;
  for (int p = r->start[i]; p < r->start[i + 1]; p++) {
    const gh_contact *c = &contacts[r->link[p] / 2];
    const bool back = contact_is_back(r->link[p]);
    if (r->flag[back ? c->i : c->j]) continue;
    const double sign = (back ? -1 : 1) / sqrt(c->l[0] * c->l[0] + c->l[1] * c->l[1]),
                 to[2] = {sign * c->l[0], sign * c->l[1]}, order = direction_order(to);
    int q = count++;
    for (; q > 0 && n[q - 1][2] > order; q--) memcpy(n[q], n[q - 1], sizeof n[q]);
    n[q][0] = to[0], n[q][1] = to[1], n[q][2] = order;
  }
  return count;
}

/* The angle from one direction on to the next against half a turn: -1 below, 0 equal to it, 1 above. Where the two
 * are one direction it is none or a whole turn; from the last the first comes next. */
static int gap_size(const double from[3], const double to[3], bool last) {
  const double cross = from[0] * to[1] - from[1] * to[0], dot = from[0] * to[0] + from[1] * to[1];
  if (fabs(cross) > angle_tolerance) return cross > 0 ? -1 : 1;
  if (dot < 0) return 0;
  return to[2] + (last ? 4 : 0) - from[2] > 2 ? 1 : -1;
}

/* The largest force between grain i and grains that are no rattlers. */
static double contacts_largest_force(const gh_rattlers *r, int i, const gh_contact *contacts) {
  double force = 0;
  for (int p = r->start[i]; p < r->start[i + 1]; p++) {
    const gh_contact *c = &contacts[r->link[p] / 2];
    if (!r->flag[contact_is_back(r->link[p]) ? c->i : c->j]) force = gh_max(force, hypot(c->f[0], c->f[1]));
  }
  return force;
}

static bool grain_is_rattler(const gh_rattlers *r, int i, const gh_contact *contacts, double mean_force) {
  const int count = contacts_find_directions(r, i, contacts, r->direction);
  if (count < 2) return true;
  int largest = gap_size(r->direction[count - 1], r->direction[0], true);
  for (int q = 1; q < count && largest <= 0; q++) {
    const int size = gap_size(r->direction[q - 1], r->direction[q], false);
    largest = size > largest ? size : largest;
  }
  return largest > 0 || (largest == 0 && contacts_largest_force(r, i, contacts) <= 1e-6 * mean_force);
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
