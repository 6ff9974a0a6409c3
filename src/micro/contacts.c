/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Contacts and forces of the current positions: unbalanced force, mean force, round-off, rattlers. */
#include "micro/internal.h"

#include <float.h>

/* Share of round-off in the contact forces above which a packing counts as stress-free. */
static const double stress_free = 1e-3;

/* Largest force on a free member, and largest moment over the radius where members rotate. */
static double contacts_largest_unbalance(const gh_rve *r) {
  const double *force = gh_frame_is_open(r->frame) ? r->frame->balance : r->list.force;
  double largest = 0;
  if (r->relaxes)
    for (int i = 0; i < r->n; i++)
      if (!(r->held && r->held[i])) largest = gh_max(largest, hypot(force[2 * i], force[2 * i + 1]));
  if (r->turns)
    for (int i = 0; i < r->n; i++)
      if (!gh_frame_turns_with_F(r->frame, i))
        largest = gh_max(largest, fabs(r->list.moment[i]) / r->radius[i]);
  return largest;
}

/* Number of contacts; those between copies count with their shares. */
static double contacts_count(const gh_rve *r) {
  double count = 0;
  if (!gh_frame_is_open(r->frame)) return r->list.count;
  for (int c = 0; c < r->list.count; c++) count += gh_frame_share_of(r->frame, &r->list.contacts[c]);
  return count;
}

gh_status gh_rve_update_contacts(gh_rve *r) {
  double start = gh_seconds();
  GH_TRY(gh_engine_contacts(r->engine, &r->list));
  if (gh_frame_is_open(r->frame)) GH_TRY(gh_frame_share_contacts(r));
  double sum = 0, all = 0, largest = contacts_largest_unbalance(r);
  const gh_contact *q = r->list.contacts;
  double E = r->options.law.normal_stiffness;
  for (int c = 0; c < r->list.count; c++) {
    all += hypot(q[c].f[0], q[c].f[1]);
    sum += E * q[c].overlap * (gh_frame_is_open(r->frame) ? gh_frame_share_of(r->frame, &q[c]) : 1);
  }
  if (!gh_rve_friction(r)) sum = all; /* the same but for round-off */
  if (!isfinite(all) || !isfinite(sum) || !isfinite(largest))
    return gh_fail(r->ctx, GH_DIVERGED, "a contact force is not finite");
  r->m.mean_force = r->list.count ? sum / contacts_count(r) : 0;
  /* Grains that follow F and just touch carry nothing yet, but they are stiff (6.10); free ones float. */
  r->m.unjammed = r->relaxes ? r->m.mean_force <= r->floor : r->list.count == 0;
  r->m.residual = r->m.mean_force > 0 && !r->m.unjammed ? largest / r->m.mean_force : 0;
  r->m.contacts = r->list.count;
  r->cost.evaluations++;
  r->cost.contacts += gh_seconds() - start;
  return GH_OK;
}

double gh_rve_round_off(const gh_rve *r) {
  const gh_contact_law *law = &r->options.law;
  double stiffest =
      gh_rve_friction(r) ? fmax(law->normal_stiffness, law->tangential_stiffness) : law->normal_stiffness;
  return 16 * DBL_EPSILON * stiffest * r->extent;
}

/* What round-off of the positions leaves of a residual. */
static double contacts_round_off(const gh_rve *r) {
  return r->m.mean_force > 0 ? gh_rve_round_off(r) / r->m.mean_force : 0;
}

/* The residual that is good enough: the required one, or what round-off of the positions leaves. */
double gh_rve_target(const gh_rve *r) {
  return fmax(r->options.tolerance, contacts_round_off(r));
}

/* Forces that are mostly round-off are no stress: whether they balance is not known. */
void gh_rve_find_stress_free(gh_rve *r) {
  r->m.stress_free = r->m.unjammed || contacts_round_off(r) > stress_free;
  if (r->m.stress_free) r->m.residual = 0;
}

/* What round-off of the positions hides: long cells and packings far from the origin have coarse positions.
 */
void gh_rve_find_round_off(gh_rve *r, const double cell[4]) {
  r->extent = hypot(cell[0], cell[2]) + hypot(cell[1], cell[3]);
  for (int k = 0; k < 2 * r->n; k++) r->extent = gh_max(r->extent, fabs(r->x[k]));
  double E = r->options.law.normal_stiffness;
  r->floor = fmax(1e-13 * E * gh_packing_mean_radius(r->packing), 4 * DBL_EPSILON * E * r->extent);
}

gh_status gh_rve_find_rattlers(gh_rve *r) {
  /* traction pushes the grains of a frame against the others */
  const unsigned char *kept = gh_frame_is_open(r->frame) && !gh_rve_friction(r) ? r->frame->on : r->held;
  if (!gh_rve_friction(r))
    return gh_rattlers_find(r->ctx, r->rattlers, r->n, kept, r->list.contacts, r->list.count, r->m.mean_force,
                            &r->m.rattlers);
  r->m.rattlers = gh_rattlers_loose(r->rattlers, r->n, kept, &r->list);
  return GH_OK;
}
