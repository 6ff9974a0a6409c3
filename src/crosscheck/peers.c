/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The peers' common half: which problems they take, frames, sums over contacts. */
#include "crosscheck/peers.h"

#include "granhom/engine.h"

#include <stdarg.h>
#include <string.h>

/* Damping over sqrt(stiffness mass), and the time step over 1/sqrt(10 E_n + 6 E_t), about the reciprocal of
 * the highest frequency of dense packings. Measured in docs/reports/crosscheck.md: friction stiffens the slow
 * modes, so that more drag is best; without it, a fifth of this drag lets grains run into other equilibria.
 */
static const double VISCOUS = 0.1, VISCOUS_FRICTION = 0.2, CONTACT = 0.3, TIME_STEP = 1.0;
static const double FLOOR = 1e-9; /* over stiffness and mean radius */
enum { STEPS_A_CHECK = 50 };

const char *gh_peer_end_text(gh_peer_end end) {
  static const char *const text[] = {"done", "missing", "unable", "failed", "stopped"};
  return text[end];
}

void peer_end(gh_peer_result *r, gh_peer_end end, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsnprintf(r->message, sizeof r->message, format, args);
  va_end(args);
  r->end = end;
}

void peer_cell_find(const gh_peer_problem *p, int row, peer_cell *c) {
  double h[4];
  if (row < 0) memcpy(h, p->cell, sizeof h);
  else gh_mul2(p->F + 4 * row, p->cell, h);
  double length = hypot(h[0], h[2]), cosine = h[0] / length, sine = h[2] / length;
  *c = (peer_cell){.q = {cosine, -sine, sine, cosine},
                   .t = {length, cosine * h[1] + sine * h[3], 0, gh_det2(h) / length}};
}

peer_motion peer_motion_of(const gh_peer_problem *p) {
  const gh_contact_law *law = &p->law;
  double kn = law->normal_stiffness, kt = law->friction ? law->tangential_stiffness : kn, mean = 0;
  for (int i = 0; i < p->n; i++) mean += p->radius[i] / p->n;
  return (peer_motion){.dt = TIME_STEP / sqrt(10 * kn + (law->friction ? 6 * kt : 0)),
                       .viscous = (law->friction ? VISCOUS_FRICTION : VISCOUS) * sqrt(kn),
                       .contact = CONTACT * sqrt(kn),
                       .skin = 0.3 * mean,
                       .floor = FLOOR * kn * mean,
                       .kn = kn,
                       .kt = kt,
                       .mu = law->friction ? law->friction_coefficient : 0,
                       .rotate = law->friction && !law->fixed_rotations,
                       .steps_a_check = STEPS_A_CHECK};
}

void peer_add(peer_sum *sum, const double l[2], const double f[2]) {
  for (int k = 0; k < 4; k++) sum->s[k] += f[k / 2] * l[k % 2];
  sum->normal -= (f[0] * l[0] + f[1] * l[1]) / hypot(l[0], l[1]);
  sum->contacts++;
}

void peer_close(const peer_sum *sum, const peer_cell *c, gh_peer_row *row) {
  const double qt[4] = {c->q[0], c->q[2], c->q[1], c->q[3]}, volume = gh_det2(c->t);
  gh_mul2(c->q, sum->s, row->cauchy);
  gh_mul2(row->cauchy, qt, row->cauchy);
  for (int k = 0; k < 4; k++) row->cauchy[k] /= volume;
  row->contacts = sum->contacts;
  row->mean_force = sum->contacts ? sum->normal / sum->contacts : 0;
}

static gh_status check_cells(gh_context *ctx, const gh_peer_problem *p) {
  double largest = 0;
  for (int i = 0; i < p->n; i++) largest = fmax(largest, p->radius[i]);
  for (int row = -1; row < p->rows; row++) {
    if (row >= 0 && (!gh_finite(p->F + 4 * row, 4) || !(gh_det2(p->F + 4 * row) > 0)))
      return gh_fail(ctx, GH_INPUT, "row %d of the path: det F must be positive", row);
    peer_cell c;
    peer_cell_find(p, row, &c);
    if (fabs(c.t[1]) > 0.5 * c.t[0] * (1 + 1e-9))
      return gh_fail(ctx, GH_INPUT,
                     "row %d of the path: the cell is sheared by %.3g of its width; the programs to compare "
                     "with take at most a half",
                     row, fabs(c.t[1]) / c.t[0]);
    double narrow = fmin(c.t[3], c.t[0] * c.t[3] / hypot(c.t[1], c.t[3]));
    if (narrow < 4 * largest)
      return gh_fail(ctx, GH_INPUT,
                     "row %d of the path: the cell is %.6g wide; the programs to compare with need twice the "
                     "largest diameter, %.6g",
                     row, narrow, 4 * largest);
  }
  return GH_OK;
}

gh_status gh_peer_check(gh_context *ctx, const gh_peer_problem *p) {
  GH_TRY(gh_contact_law_check(ctx, &p->law));
  if (p->law.friction && p->law.hardening > 0)
    return gh_fail(ctx, GH_INPUT,
                   "hardening must be 0, not %g: the contact laws to compare with have no hardening",
                   p->law.hardening);
  if (p->n < 1 || p->rows < 1 || p->steps_per_row < 1 || p->max_steps < 1)
    return gh_fail(ctx, GH_INPUT, "a cross-check needs grains, a path and time steps");
  if (!(p->tolerance > 0) || !(p->tolerance < 1) || !(p->seconds > 0))
    return gh_fail(ctx, GH_INPUT, "a cross-check needs a tolerance in (0, 1) and a time limit above 0");
  if (!gh_finite(p->x, 2 * (size_t)p->n) || !gh_finite(p->cell, 4) || !(gh_det2(p->cell) > 0))
    return gh_fail(ctx, GH_INPUT, "a cross-check needs finite positions in a cell with det > 0");
  return check_cells(ctx, p);
}
