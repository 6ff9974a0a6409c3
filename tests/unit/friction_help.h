/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Packings with friction that the tests of both engines share. */
#ifndef GRANHOM_TESTS_FRICTION_HELP_H
#define GRANHOM_TESTS_FRICTION_HELP_H

#include "slips_help.h"

enum { MOST = 150, MOST_SLIPS = 2000 };

static const gh_contact_law LAW = {
    .normal_stiffness = 100, .friction = 1, .tangential_stiffness = 80, .friction_coefficient = 0.3};

/* A packing at n and in the trial state. */
typedef struct sample {
  int n, nslips;
  bool periodic;
  double radius[MOST], cell_n[4], x_n[2 * MOST], theta_n[MOST], cell[4], x[2 * MOST], theta[MOST];
  gh_slip slips[MOST_SLIPS];
} sample;

static inline gh_engine *make_engine_of(gh_context *ctx, gh_engine_kind kind, const sample *s,
                                        gh_contact_law law, const unsigned char *held) {
  gh_engine *e;
  const gh_engine_setup setup = {
      .n = s->n, .radius = s->radius, .held = held, .periodic = s->periodic, .law = law};
  OK(gh_engine_create(ctx, kind, &setup, &e));
  return e;
}

static inline gh_engine *make_engine(gh_context *ctx, const sample *s, gh_contact_law law,
                                     const unsigned char *held) {
  return make_engine_of(ctx, GH_ENGINE_NATIVE, s, law, held);
}

static inline gh_converged state_n(const sample *s) {
  gh_converged n = {.x = s->x_n, .theta = s->theta_n, .slips = s->slips, .nslips = s->nslips};
  memcpy(n.cell, s->cell_n, sizeof n.cell);
  return n;
}

static inline void put(gh_context *ctx, gh_engine *e, const sample *s) {
  const gh_converged n = state_n(s);
  OK(gh_engine_begin(e, &n));
  OK(gh_engine_set(e, s->cell, s->x, s->theta));
}

static inline gh_contact_list evaluate(gh_context *ctx, gh_engine *e, const sample *s) {
  gh_contact_list list;
  put(ctx, e, s);
  OK(gh_engine_contacts(e, &list));
  assert_non_null(list.friction);
  assert_non_null(list.moment);
  return list;
}

/* A random packing that overlaps, in a cell that is rotated and tilted, with grains many lattice vectors
 * apart, and a random history of its contacts at n. */
static inline void draw_tilted(gh_context *ctx, unsigned long long *seed, int n, double largest, double tilt,
                               bool periodic, sample *s) {
  const double F[4] = {1 + 0.01 * (uniform(seed) - 0.5), 0.01 * (uniform(seed) - 0.5),
                       0.01 * (uniform(seed) - 0.5), 1 + 0.01 * (uniform(seed) - 0.5)},
               T[4] = {0.6 + uniform(seed), tilt * (uniform(seed) - 0.5), 0, 0.6 + uniform(seed)};
  double Q[4];
  *s = (sample){.n = n, .periodic = periodic};
  rotation(6 * uniform(seed), Q);
  gh_mul2(Q, T, s->cell_n);
  gh_mul2(F, s->cell_n, s->cell);
  for (int i = 0; i < n; i++) {
    double f[2] = {uniform(seed), uniform(seed)};
    for (int k = 0; k < 2 && periodic; k++) f[k] = 6 * f[k] - 3;
    s->radius[i] = largest * (0.3 + 0.7 * uniform(seed));
    s->theta_n[i] = uniform(seed);
    s->theta[i] = s->theta_n[i] + 0.04 * (uniform(seed) - 0.5);
    gh_apply2(s->cell_n, f, &s->x_n[2 * i]);
    gh_apply2(F, &s->x_n[2 * i], &s->x[2 * i]);
    for (int k = 0; k < 2; k++) s->x[2 * i + k] += 0.06 * largest * (uniform(seed) - 0.5);
  }
  sample at_n = *s;
  memcpy(at_n.x, s->x_n, sizeof at_n.x);
  memcpy(at_n.cell, s->cell_n, sizeof at_n.cell);
  memcpy(at_n.theta, s->theta_n, sizeof at_n.theta);
  gh_engine *g = make_engine(ctx, s, LAW, NULL);
  gh_contact_list list = evaluate(ctx, g, &at_n);
  s->nslips = draw_slips(seed, &list, largest, MOST_SLIPS, s->slips);
  gh_engine_destroy(&g);
}

static inline void draw(gh_context *ctx, unsigned long long *seed, int n, double largest, bool periodic,
                        sample *s) {
  draw_tilted(ctx, seed, n, largest, 1, periodic, s);
}

/* A reference packing at rest, rotated by `turn` and deformed by F; no history. */
static inline void case_sample(gh_context *ctx, const char *name, const double F[4], double turn, sample *s) {
  gh_packing *p = case_packing(ctx, name);
  double Q[4], QF[4];
  *s = (sample){.n = p->n, .periodic = true};
  assert_in_range(p->n, 1, MOST);
  rotation(turn, Q);
  gh_mul2(Q, F, QF);
  memcpy(s->radius, p->radius, (size_t)p->n * sizeof(double));
  gh_mul2(Q, p->cell, s->cell_n);
  gh_mul2(QF, p->cell, s->cell);
  for (int i = 0; i < p->n; i++) {
    gh_apply2(Q, &p->x[2 * i], &s->x_n[2 * i]);
    gh_apply2(QF, &p->x[2 * i], &s->x[2 * i]);
  }
  gh_packing_destroy(&p);
}

static inline gh_contact_law random_law(unsigned long long *seed, int trial) {
  gh_contact_law law = LAW;
  law.hardening = trial & 1 ? 30 * uniform(seed) : 0;
  law.slip = trial & 2 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
  law.hardening_law = trial & 4 ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
  return law;
}

/* Forces (2 n) and moments (n) in one array; the number of contacts and of sliding ones. */
static inline void all_forces(gh_context *ctx, gh_engine *g, const sample *s, double *out, int count[2]) {
  const gh_contact_list list = evaluate(ctx, g, s);
  memcpy(out, list.force, 2 * (size_t)s->n * sizeof *out);
  memcpy(out + 2 * s->n, list.moment, (size_t)s->n * sizeof *out);
  count[0] = list.count, count[1] = 0;
  for (int c = 0; c < list.count; c++) count[1] += list.friction[c].slides;
}

#endif
