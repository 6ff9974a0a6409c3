/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One body in halves of the increments and one in whole increments.
 *
 * The two do not begin each increment at the same state: each continues from its own, so that their
 * difference is that of two whole paths. What a stress owes to the length of the last increment alone (with
 * friction the factor c of (7.20)) would else be counted in each increment again.
 *
 * The halves start at a depth of bisection of their own: substeps are not longer than half the shortest
 * substep of the whole increment, so that one that was bisected is compared with a finer one too. */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- saving and restoring a body ---- */

static gh_status body_save(gh_macro *m, gh_keep *k) {
  gh_farm_drop_mark(m->farm, &k->mark);
  k->size = gh_macro_state_size(m);
  GH_TRY(gh_grow(m->ctx, k->size, sizeof *k->state, &k->capacity, &k->state));
  gh_macro_save(m, k->state);
  return gh_farm_mark_states(m->farm, &k->mark);
}

static gh_status body_restore(gh_macro *m, const gh_keep *k) {
  gh_farm_return(m->farm, k->mark);
  return gh_macro_load(m, k->state, k->size);
}

static void body_drop(gh_macro *m, gh_keep *k) {
  gh_farm_drop_mark(m->farm, &k->mark);
}

void gh_estimate_free(gh_macro *m) {
  gh_keep *const all[] = {&m->begin_of, &m->whole};
  for (int k = 0; k < 2; k++) {
    body_drop(m, all[k]);
    free(all[k]->state);
  }
  free(m->compared);
}

/* ---- what is compared ---- */

/* Places in m->compared: P at the start and at the end of the increment, of both bodies. */
typedef struct places {
  double *before, *whole_before; /* npoints x 4 */
  double *P, *u, *reaction;      /* of the body in whole increments: npoints x 4, ndof, ndof */
} places;

static places places_find(const gh_macro *m) {
  double *at = m->compared;
  size_t n = 4 * (size_t)m->npoints;
  return (places){at, at + n, at + 2 * n, at + 3 * n, at + 3 * n + m->ndof};
}

static gh_status places_allocate(gh_macro *m) {
  size_t n = 12 * (size_t)m->npoints + 2 * (size_t)m->ndof;
  return m->compared ? GH_OK : gh_alloc(m->ctx, n, sizeof *m->compared, &m->compared);
}

static void stress_copy(const gh_macro *m, double *P) {
  memcpy(P, m->eq.P, 4 * (size_t)m->npoints * sizeof *P);
}

static void whole_record(gh_macro *m) {
  const places at = places_find(m);
  stress_copy(m, at.P);
  memcpy(at.u, m->eq.u, (size_t)m->ndof * sizeof *at.u);
  memcpy(at.reaction, m->reaction, (size_t)m->ndof * sizeof *at.reaction);
}

/* Squares of P, of its change, of the difference and of its growth. */
static void bodies_compare_point(const gh_macro *m, int p, double now[4]) {
  const places at = places_find(m);
  memset(now, 0, 4 * sizeof *now);
  for (int i = 0; i < 4; i++) {
    const size_t k = 4 * (size_t)p + (size_t)i;
    const double off = m->eq.P[k] - at.P[k], off_before = at.before[k] - at.whole_before[k],
                 change = m->eq.P[k] - at.before[k];
    now[0] += m->eq.P[k] * m->eq.P[k];
    now[1] += change * change;
    now[2] += off * off;
    now[3] += (off - off_before) * (off - off_before);
  }
}

static void bodies_compare(const gh_macro *m, gh_difference *d) {
  const places at = places_find(m);
  double area = 0, u = 0, du = 0, sum[4] = {0};
  for (int p = 0; p < m->npoints; p++) {
    double now[4];
    bodies_compare_point(m, p, now);
    area += m->shapes.weight[p];
    for (int i = 0; i < 4; i++) sum[i] += m->shapes.weight[p] * now[i];
    d->scale_most = gh_max(d->scale_most, sqrt(now[0]));
    d->most = gh_max(d->most, sqrt(now[2]));
  }
  for (int k = 0; k < m->ndof; k++) {
    du += (m->eq.u[k] - at.u[k]) * (m->eq.u[k] - at.u[k]);
    u += m->eq.u[k] * m->eq.u[k];
  }
  d->scale = sqrt(sum[0] / area), d->change = sqrt(sum[1] / area);
  d->stress = sqrt(sum[2] / area), d->growth = sqrt(sum[3] / area);
  d->displacement = sqrt(du), d->scale_u = sqrt(u);
  d->reactions = at.reaction;
}

/* ---- both bodies ---- */

static gh_status whole_solve(gh_macro *m, const gh_loads *loads, gh_difference *d) {
  gh_macro_watch *watch = m->watch;
  if (m->apart) GH_TRY(body_restore(m, &m->whole));
  stress_copy(m, places_find(m).whole_before);
  m->watch = NULL;
  gh_status status = gh_macro_solve(m, loads, &d->whole);
  m->watch = watch;
  if (status != GH_OK) return status;
  whole_record(m);
  return body_save(m, &m->whole);
}

static gh_status halves_solve(gh_macro *m, const gh_loads *loads, gh_macro_report *r, gh_difference *d) {
  m->first_level = m->deepest + 1;
  gh_status status = gh_macro_solve(m, loads, r);
  m->first_level = 0;
  d->seconds = r->seconds;
  return status;
}

/* No equilibrium in halves: the body in whole increments is the one that stays. */
static gh_status whole_take_over(gh_macro *m, gh_macro_report *r, const gh_difference *d) {
  const double micro = r->micro_seconds, seconds = r->seconds;
  GH_TRY(body_restore(m, &m->whole));
  *r = d->whole;
  r->micro_seconds = micro, r->seconds = seconds;
  return GH_OK;
}

static gh_status bodies_solve(gh_macro *m, const gh_loads *loads, gh_macro_report *r, gh_difference *d) {
  GH_TRY(places_allocate(m));
  GH_TRY(body_save(m, &m->begin_of));
  stress_copy(m, places_find(m).before);
  gh_status whole = whole_solve(m, loads, d);
  if (whole != GH_OK && whole != GH_DIVERGED) return whole;
  GH_TRY(body_restore(m, &m->begin_of));
  gh_status halves = halves_solve(m, loads, r, d);
  m->apart = d->known = whole == GH_OK && halves == GH_OK;
  d->halves = halves == GH_OK;
  if (d->known) bodies_compare(m, d);
  if (whole == GH_OK && halves == GH_DIVERGED) halves = whole_take_over(m, r, d);
  if (r->jumps > 0 || d->whole.jumps > 0) m->apart = false;
  r->micro_seconds += d->whole.micro_seconds;
  r->seconds += d->whole.seconds;
  return halves;
}

gh_status gh_macro_solve_twice(gh_macro *m, const gh_loads *loads, gh_macro_report *report,
                               gh_difference *difference) {
  gh_macro_report unused, *r = report ? report : &unused;
  *r = (gh_macro_report){0};
  *difference = (gh_difference){0};
  gh_status status = bodies_solve(m, loads, r, difference);
  body_drop(m, &m->begin_of);
  if (!m->apart) body_drop(m, &m->whole);
  return status;
}

void gh_macro_join(gh_macro *m) {
  m->apart = false;
  body_drop(m, &m->whole);
}

bool gh_macro_apart(const gh_macro *m) {
  return m->apart;
}

gh_status gh_macro_exchange(gh_macro *m) {
  if (!m->apart) return GH_OK;
  GH_TRY(body_save(m, &m->begin_of));
  GH_TRY(body_restore(m, &m->whole));
  const gh_keep swap = m->begin_of;
  m->begin_of = m->whole;
  m->whole = swap;
  body_drop(m, &m->begin_of);
  return GH_OK;
}

gh_status gh_macro_part(gh_macro *m) {
  GH_TRY(body_save(m, &m->whole));
  m->apart = true;
  return GH_OK;
}
