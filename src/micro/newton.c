/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Newton steps of the free grains: the finish of a relaxation, of the last part behind a ramp, and leaving a
 * limit cycle (method 3). */
#include "micro/internal.h"

#include <string.h>

const double gh_rve_first_relaxation = 1e-5;

/* Numbers the unknowns at the current contacts and rattlers. */
static gh_status unknowns_number(gh_rve *r) {
  const gh_solver_input in = gh_rve_solver_input(r);
  return gh_solver_number(r->ctx, r->solver, &in);
}

/* As they are numbered, with r->shift. */
static gh_status stiffness_factor(gh_rve *r, bool *regular) {
  const gh_solver_input in = gh_rve_solver_input(r);
  r->m.factorisations++;
  return gh_solver_factor(r->ctx, r->solver, &in, r->shift, regular);
}

/* Friction leaves modes without stiffness: grains that roll on each other like gears where no odd cycle of
 * contacts blocks them, grains that one contact holds, grains whose contacts all slide. A little stiffness of
 * position and rotation decides them in the tangent. */
gh_status gh_rve_factor(gh_rve *r, bool help, bool *regular) {
  double most = 1e-6 * r->options.law.normal_stiffness;
  r->shift = 0;
  GH_TRY(unknowns_number(r));
  for (;;) {
    GH_TRY(stiffness_factor(r, regular));
    if (*regular || !help || r->shift >= most) return GH_OK;
    r->shift = r->shift > 0 ? 10 * r->shift : 1e-3 * most;
  }
}

/* Rolling changes no contact force, so that any amount of it is the same equilibrium. Grains whose contacts
 * slide without hardening can come to rest in many places, and relaxation alone decides in which. */
static bool contacts_only_roll(const gh_rve *r) {
  if (r->options.law.hardening > 0) return true;
  for (int c = 0; c < r->list.count; c++)
    if (r->list.friction[c].slides) return false;
  return true;
}

static gh_status equilibrium_factor(gh_rve *r, bool *good) {
  double start = gh_seconds();
  GH_TRY(gh_rve_find_rattlers(r));
  GH_TRY(gh_rve_factor(r, gh_rve_friction(r) && contacts_only_roll(r), good));
  r->cost.factorise += gh_seconds() - start;
  return GH_OK;
}

/* Unbalanced forces of the contacts between grains that are no rattlers: the others end with the step. */
static void backbone_balance(const gh_rve *r) {
  const gh_solver *s = r->solver;
  for (int i = 0; i < r->n; i++)
    if (s->unknown[3 * i] >= 0) memcpy(&s->rhs[s->unknown[3 * i]], &r->list.force[2 * i], 2 * sizeof(double));
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = r->list.contacts + c;
    const int end[2] = {q->i, q->j};
    for (int e = 0; e < 2; e++) {
      int u = s->unknown[3 * end[e]];
      if (u < 0 || !r->rattlers->flag[end[1 - e]]) continue;
      for (int k = 0; k < 2; k++) s->rhs[u + k] -= e ? -q->f[k] : q->f[k];
    }
  }
}

static bool loose_pair_is(const gh_loose_pair *p, const gh_loose_pair *q) {
  const double other = 1e-3 * q->reach; /* images of a pair differ in their shift, by a length of the cell */
  return p->i == q->i && p->j == q->j && fabs(p->shift[0] - q->shift[0]) < other &&
         fabs(p->shift[1] - q->shift[1]) < other;
}

/* Contacts of rattlers are remembered: a grain that is pushed out of one contact may be pressed into another,
 * which is not seen at the next step where it has opened. */
static gh_status loose_pairs_remember(gh_rve *r) {
  for (int c = 0; c < r->list.count; c++) {
    const gh_contact *q = r->list.contacts + c;
    gh_loose_pair now = {.i = q->i, .j = q->j, .reach = q->overlap + hypot(q->l[0], q->l[1])};
    int p = 0;
    if (q->i == q->j || !(r->rattlers->flag[q->i] || r->rattlers->flag[q->j])) continue;
    for (int k = 0; k < 2; k++) now.shift[k] = q->l[k] - (r->x[2 * q->j + k] - r->x[2 * q->i + k]);
    while (p < r->nloose && !loose_pair_is(&r->loose[p], &now)) p++;
    if (p < r->nloose) continue;
    GH_TRY(gh_grow(r->ctx, (size_t)++r->nloose, sizeof *r->loose, &r->loose_capacity, &r->loose));
    r->loose[p] = now;
  }
  return GH_OK;
}

/* Adds a pair that overlaps where the step leads to the systems of the rattlers among its ends: sum of n (x) n
 * (xx, xy, yy) and of the overlap times n. */
static bool loose_pair_add(const gh_rve *r, const gh_loose_pair *q, double gap) {
  const int end[2] = {q->i, q->j};
  const bool loose[2] = {r->rattlers->flag[q->i], r->rattlers->flag[q->j]};
  double n[2];
  for (int k = 0; k < 2; k++) n[k] = r->step[2 * q->j + k] - r->step[2 * q->i + k] + q->shift[k];
  const double d = hypot(n[0], n[1]), overlap = q->reach - d;
  if (!(overlap > 0 && d > 0) || !(loose[0] || loose[1])) return false;
  for (int e = 0; e < 2; e++) {
    double *w = r->loose_push + LOOSE_PUSH * end[e];
    const double away = (overlap + gap) / (loose[0] + loose[1]) / d * (e ? 1 : -1);
    if (!loose[e]) continue;
    w[0] += n[0] * n[0] / (d * d), w[1] += n[0] * n[1] / (d * d), w[2] += n[1] * n[1] / (d * d);
    w[3] += away * n[0], w[4] += away * n[1];
  }
  return true;
}

/* Moves a rattler by what lets go of its contacts, in the sense of least squares. */
static void loose_grain_push(gh_rve *r, int i) {
  const double most = 0.05 * r->mean_radius, *w = r->loose_push + LOOSE_PUSH * i,
               small = 1e-6 * (w[0] + w[2]), xx = w[0] + small, yy = w[2] + small,
               det = xx * yy - w[1] * w[1];
  if (!(det > 0)) return;
  const double push[2] = {(yy * w[3] - w[1] * w[4]) / det, (xx * w[4] - w[1] * w[3]) / det},
               far = hypot(push[0], push[1]), slower = far > most ? most / far : 1;
  for (int k = 0; k < 2; k++) r->step[2 * i + k] += slower * push[k];
}

/* Rattlers carry nothing, but lean on others, and relaxation never parts them quite. A step of the others by
 * more than that overlap would press them: they are pushed aside. One that its neighbours trap is left in their
 * midst, and is no rattler at the next step. */
static gh_status rattlers_clear(gh_rve *r) {
  enum { SWEEPS = 50 };
  const double gap = 1e-9 * r->mean_radius;
  GH_TRY(loose_pairs_remember(r));
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    bool moved = false;
    memset(r->loose_push, 0, LOOSE_PUSH * (size_t)r->n * sizeof *r->loose_push);
    for (int p = 0; p < r->nloose; p++) moved = loose_pair_add(r, r->loose + p, gap) || moved;
    if (!moved) return GH_OK;
    for (int i = 0; i < r->n; i++) loose_grain_push(r, i);
  }
  return GH_OK;
}

static gh_status forces_solve(gh_rve *r) {
  const gh_solver *s = r->solver;
  const double *dx;
  backbone_balance(r);
  GH_TRY(gh_solver_solve(r->ctx, r->solver, 1, &dx));
  for (int i = 0; i < r->n; i++)
    for (int k = 0; k < 2; k++)
      r->step[2 * i + k] = r->x[2 * i + k] + (s->unknown[3 * i] >= 0 ? dx[s->unknown[3 * i] + k] : 0);
  return rattlers_clear(r);
}

static gh_status forces_and_moments_solve(gh_rve *r) {
  const gh_solver *s = r->solver;
  const double *dx;
  for (int i = 0; i < r->n; i++) {
    const double out[3] = {r->list.force[2 * i], r->list.force[2 * i + 1], r->list.moment[i]};
    for (int k = 0; k < 3; k++)
      if (s->unknown[3 * i + k] >= 0) s->rhs[s->unknown[3 * i + k]] = out[k];
  }
  GH_TRY(gh_solver_solve(r->ctx, r->solver, 1, &dx));
  for (int i = 0; i < r->n; i++) {
    const int *u = &s->unknown[3 * i];
    for (int k = 0; k < 2; k++) r->step[2 * i + k] = r->x[2 * i + k] + (u[k] >= 0 ? dx[u[k]] : 0);
    r->turn[i] = r->theta[i] + (u[2] >= 0 ? dx[u[2]] : 0);
  }
  return GH_OK;
}

void gh_rve_newton_begin(gh_rve *r) {
  r->nloose = 0;
}

gh_status gh_rve_newton_direction(gh_rve *r, bool *definite) {
  GH_TRY(equilibrium_factor(r, definite));
  const double start = gh_seconds();
  if (*definite) GH_TRY(forces_solve(r));
  r->cost.factorise += gh_seconds() - start;
  return GH_OK;
}

/* One full Newton step from x, with the current factor. *falls: the residual is at most `fall` times what it
 * was, and x is there; else all is where it was. */
static gh_status newton_step(gh_rve *r, double fall, bool *falls) {
  double start = gh_seconds(), before = r->m.residual;
  GH_TRY(gh_rve_friction(r) ? forces_and_moments_solve(r) : forces_solve(r));
  r->cost.factorise += gh_seconds() - start;
  GH_TRY(gh_engine_move(r->engine, r->step, r->turn));
  GH_TRY(gh_rve_update_contacts(r));
  *falls = r->m.residual <= fall * before && !r->m.unjammed;
  if (!*falls) {
    GH_TRY(gh_engine_move(r->engine, r->x, r->theta));
    return gh_rve_update_contacts(r);
  }
  memcpy(r->x, r->step, 2 * (size_t)r->n * sizeof(double));
  if (r->theta) memcpy(r->theta, r->turn, (size_t)r->n * sizeof(double));
  return GH_OK;
}

/* Forces with friction have no potential, and relaxation may end in a limit cycle around an equilibrium, or come
 * slowly to that of the last part behind a ramp, where contacts slide. Newton goes there, as long as every step halves the residual; floating grains, which would make the matrix
 * singular or be thrown far, get more and more stiffness of their own. Where it does not come to the
 * end, all is as it was: it may have gone back to an equilibrium that is unstable, which relaxation is just
 * leaving. */
gh_status gh_rve_newton_regularised(gh_rve *r, double tolerance) {
  static const double shifts[] = {0, 1e-9, 1e-6, 1e-4, 1e-2};
  GH_TRY(gh_engine_get(r->engine, r->x, r->theta));
  memcpy(r->x0, r->x, 2 * (size_t)r->n * sizeof(double));
  memcpy(r->theta0, r->theta, (size_t)r->n * sizeof(double));
  gh_rve_newton_begin(r);
  bool moved = false;
  for (size_t k = 0; k < sizeof shifts / sizeof *shifts; k++) {
    for (bool falls = true; falls;) {
      double start = gh_seconds();
      bool regular;
      r->shift = shifts[k] * r->options.law.normal_stiffness;
      GH_TRY(gh_rve_find_rattlers(r));
      GH_TRY(unknowns_number(r));
      GH_TRY(stiffness_factor(r, &regular));
      r->cost.factorise += gh_seconds() - start;
      if (!regular) break;
      GH_TRY(newton_step(r, 0.5, &falls));
      moved = moved || falls;
      if (falls && r->m.residual <= tolerance) return GH_OK;
    }
  }
  if (!moved) return GH_OK;
  GH_TRY(gh_engine_move(r->engine, r->x0, r->theta0));
  return gh_rve_update_contacts(r);
}

/* Newton from the engine's positions as long as it is safe. *done: the residual is reached. Else the engine
 * is at the last safe positions, and *again: another attempt after more relaxation is worth it. */
gh_status gh_rve_newton_finish(gh_rve *r, bool *done, bool *again) {
  *done = false;
  *again = true;
  const double fall = r->relaxes ? 0.5 : 0.95; /* rotations alone have one equilibrium: any fall will do */
  if (gh_rve_friction(r) && r->relaxes &&
      !contacts_only_roll(r)) { /* nine times of ten the matrix is singular */
    *again = false;
    if (!gh_rve_ramps(r)) return GH_OK;
    GH_TRY(gh_rve_newton_regularised(r, gh_rve_target(r)));
    r->m.polished = *done = r->m.residual <= gh_rve_target(r);
    return GH_OK;
  }
  GH_TRY(gh_engine_get(r->engine, r->x, r->theta));
  gh_rve_newton_begin(r);
  for (;;) {
    bool good, falls;
    GH_TRY(equilibrium_factor(r, &good));
    if (!good) { /* with friction: grains that carry nothing slide on their last contact until the end */
      *again = !gh_rve_friction(r);
      return GH_OK;
    }
    GH_TRY(newton_step(r, fall, &falls));
    if (!falls) return GH_OK;
    *done = r->m.residual <= gh_rve_target(r);
    r->m.polished = *done;
    if (*done) return GH_OK;
  }
}
