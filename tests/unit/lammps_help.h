/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the tests of the LAMMPS engine share: packings, engines, contacts and how they are compared. */
#ifndef GRANHOM_TESTS_LAMMPS_HELP_H
#define GRANHOM_TESTS_LAMMPS_HELP_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/lammps/guard.h"
#include "granhom/engine.h"
#include "granhom/io.h"

#include <stdlib.h>
#include <string.h>

#define STIFFNESS 50.0
#define PACKING "tests/data/cases/packings/p150.data"

/* The contacts of an engine without friction. */
static inline gh_status list_of(gh_engine *e, const gh_contact **c, int *count, const double **force) {
  gh_contact_list list = {0};
  gh_status status = gh_engine_contacts(e, &list);
  *c = list.contacts, *count = list.count, *force = list.force;
  return status;
}

static gh_context *ctx;

#define OK(call)                                                                                             \
  do {                                                                                                       \
    gh_status s_ = (call);                                                                                   \
    if (s_ != GH_OK) fail_msg("%s: %s", #call, gh_message(ctx));                                             \
  } while (0)

static inline void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.17g is not %.17g within %g", value, expected, tolerance);
}

/* A small generator of its own (xorshift), so that failures can be repeated. */
static inline double uniform(uint64_t *seed) {
  *seed ^= *seed << 13;
  *seed ^= *seed >> 7;
  *seed ^= *seed << 17;
  return (double)(*seed >> 11) / 9007199254740992.0;
}

typedef struct packing {
  int n;
  double cell[4];
  double *x, *radius;
  unsigned char *held;
  bool cluster;
} packing;

static inline packing make(int n) {
  return (packing){.n = n,
                   .cell = {1, 0, 0, 1},
                   .x = calloc(2 * (size_t)n, sizeof(double)),
                   .radius = calloc((size_t)n, sizeof(double)),
                   .held = calloc((size_t)n, 1)};
}

static inline void drop(packing *p) {
  free(p->x);
  free(p->radius);
  free(p->held);
}

static inline packing read_p150(void) {
  gh_lammps_data *d;
  OK(gh_lammps_data_read(ctx, PACKING, &d));
  packing p = make(d->natoms);
  memcpy(p.cell, (double[4]){d->high[0] - d->low[0], d->xy, 0, d->high[1] - d->low[1]}, sizeof p.cell);
  for (int i = 0; i < p.n; i++) {
    p.x[2 * i] = d->x[3 * i];
    p.x[2 * i + 1] = d->x[3 * i + 1];
    p.radius[i] = d->diameter[i] / 2;
  }
  gh_lammps_data_destroy(&d);
  return p;
}

/* x <- F x, cell <- F cell. */
static inline void deform(packing *p, const double F[4]) {
  for (int i = 0; i < p->n; i++) gh_apply2(F, &p->x[2 * i], &p->x[2 * i]);
  gh_mul2(F, p->cell, p->cell);
}

static inline gh_engine *open_engine(const packing *p, gh_engine_kind kind) {
  gh_engine_setup s = {.n = p->n,
                       .radius = p->radius,
                       .held = p->held,
                       .periodic = !p->cluster,
                       .law = {.normal_stiffness = STIFFNESS}};
  gh_engine *e;
  OK(gh_engine_create(ctx, kind, &s, &e));
  return e;
}

typedef struct outcome {
  const gh_contact *c;
  int count;
  const double *f;
} outcome;

static inline outcome contacts_of(gh_engine *e) {
  outcome o;
  OK(list_of(e, &o.c, &o.count, &o.f));
  return o;
}

static inline void assert_same_contacts(outcome a, outcome b, int n, double tolerance) {
  assert_int_equal(a.count, b.count);
  for (int k = 0; k < a.count; k++) {
    const gh_contact *p = &a.c[k], *q = &b.c[k];
    assert_int_equal(p->i, q->i);
    assert_int_equal(p->j, q->j);
    for (int m = 0; m < 2; m++) {
      assert_near(p->l[m], q->l[m], tolerance);
      assert_near(p->f[m], q->f[m], STIFFNESS * tolerance);
    }
    for (int m = 0; m < 3; m++) assert_near(p->h[m], q->h[m], 10 * STIFFNESS * tolerance);
    assert_near(p->overlap, q->overlap, tolerance);
    assert_near(p->energy, q->energy, STIFFNESS * tolerance);
  }
  for (int k = 0; k < 2 * n; k++) assert_near(a.f[k], b.f[k], 10 * STIFFNESS * tolerance);
}

/* The forces on the grains are the sums of the contacts' forces. */
static inline void assert_sums(outcome o, int n, double tolerance) {
  double *f = calloc(2 * (size_t)n, sizeof *f);
  for (int k = 0; k < o.count; k++)
    for (int m = 0; m < 2; m++) {
      f[2 * o.c[k].i + m] += o.c[k].f[m];
      f[2 * o.c[k].j + m] -= o.c[k].f[m];
    }
  for (int k = 0; k < 2 * n; k++) assert_near(o.f[k], f[k], tolerance);
  free(f);
}

static inline void rotation(double degrees, double Q[4]) {
  double c = cos(degrees * acos(-1) / 180), s = sin(degrees * acos(-1) / 180);
  memcpy(Q, (double[4]){c, -s, s, c}, sizeof(double[4]));
}

static inline int set_up(void **state) {
  (void)state;
  return gh_context_create(&ctx) != GH_OK;
}

static inline int tear_down(void **state) {
  (void)state;
  gh_context_destroy(&ctx);
  return 0;
}

#endif
