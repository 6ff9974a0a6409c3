/* The LAMMPS engine and its styles, against closed forms, brute force and the native engine.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/lammps/guard.h"
#include "granhom/engine.h"
#include "granhom/io.h"

#include <lammps/library.h>
#include <stdlib.h>
#include <string.h>

#define STIFFNESS 50.0
#define PACKING "tests/data/cases/packings/p150.data"

/* The contacts of an engine without friction. */
static gh_status list_of(gh_engine *e, const gh_contact **c, int *count, const double **force) {
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

static void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.17g is not %.17g within %g", value, expected, tolerance);
}

/* A small generator of its own (xorshift), so that failures can be repeated. */
static double uniform(uint64_t *seed) {
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

static packing make(int n) {
  return (packing){.n = n,
                   .cell = {1, 0, 0, 1},
                   .x = calloc(2 * (size_t)n, sizeof(double)),
                   .radius = calloc((size_t)n, sizeof(double)),
                   .held = calloc((size_t)n, 1)};
}

static void drop(packing *p) {
  free(p->x);
  free(p->radius);
  free(p->held);
}

static packing read_p150(void) {
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
static void deform(packing *p, const double F[4]) {
  for (int i = 0; i < p->n; i++) gh_apply2(F, &p->x[2 * i], &p->x[2 * i]);
  gh_mul2(F, p->cell, p->cell);
}

static gh_engine *open_engine(const packing *p, gh_engine_kind kind) {
  gh_engine_setup s = {
      .n = p->n, .radius = p->radius, .held = p->held, .periodic = !p->cluster, .law = {STIFFNESS}};
  gh_engine *e;
  OK(gh_engine_create(ctx, kind, &s, &e));
  return e;
}

typedef struct outcome {
  const gh_contact *c;
  int count;
  const double *f;
} outcome;

static outcome contacts_of(gh_engine *e) {
  outcome o;
  OK(list_of(e, &o.c, &o.count, &o.f));
  return o;
}

static void assert_same_contacts(outcome a, outcome b, int n, double tolerance) {
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
static void assert_sums(outcome o, int n, double tolerance) {
  double *f = calloc(2 * (size_t)n, sizeof *f);
  for (int k = 0; k < o.count; k++)
    for (int m = 0; m < 2; m++) {
      f[2 * o.c[k].i + m] += o.c[k].f[m];
      f[2 * o.c[k].j + m] -= o.c[k].f[m];
    }
  for (int k = 0; k < 2 * n; k++) assert_near(o.f[k], f[k], tolerance);
  free(f);
}

/* Contacts and their energy by trying all images within `reach` cells. */
static double brute_force(const packing *p, int reach, int *count) {
  double energy = 0;
  *count = 0;
  for (int i = 0; i < p->n; i++)
    for (int j = i; j < p->n; j++)
      for (int a = -reach; a <= reach; a++)
        for (int b = -reach; b <= reach; b++) {
          if (i == j && (b < 0 || (b == 0 && a <= 0))) continue;
          double lx = p->x[2 * j] - p->x[2 * i] + p->cell[0] * a + p->cell[1] * b;
          double ly = p->x[2 * j + 1] - p->x[2 * i + 1] + p->cell[2] * a + p->cell[3] * b;
          double e = p->radius[i] + p->radius[j] - hypot(lx, ly);
          if (e < 0) continue;
          ++*count;
          energy += STIFFNESS * e * e / 2;
        }
  return energy;
}

static double energy_of(outcome o) {
  double sum = 0;
  for (int k = 0; k < o.count; k++) sum += o.c[k].energy;
  return sum;
}

static void rotation(double degrees, double Q[4]) {
  double c = cos(degrees * acos(-1) / 180), s = sin(degrees * acos(-1) / 180);
  memcpy(Q, (double[4]){c, -s, s, c}, sizeof(double[4]));
}

/* ---- closed forms ---- */

/* Two disks: overlap, force, energy and stiffness are the closed form in any cell, also across its boundary.
 */
static void two_disks(void **state) {
  (void)state;
  const double cells[][4] = {{5, 0, 0, 5},  {5, 2.4, 0, 6},  {5, 13, 0, 6},  {4, -3, 3, 4},
                             {0, -7, 7, 0}, {-5, 1, -2, -5}, {12, 80, 2, 20}};
  const int images[][2] = {{0, 0}, {1, 0}, {-2, 3}, {7, -40}};
  packing p = make(2);
  p.radius[0] = 1;
  p.radius[1] = 0.5;
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  const double d[2] = {1.1, -0.8}, r = hypot(1.1, 0.8), n[2] = {d[0] / r, d[1] / r}, o = 1.5 - r;
  for (size_t c = 0; c < sizeof cells / sizeof *cells; c++)
    for (size_t k = 0; k < sizeof images / sizeof *images; k++) {
      const double *H = cells[c];
      double x[4] = {0.3, 4.9, 0, 0};
      for (int m = 0; m < 2; m++)
        x[2 + m] = x[m] + d[m] + H[2 * m] * images[k][0] + H[2 * m + 1] * images[k][1];
      OK(gh_engine_set(e, H, x, NULL));
      outcome got = contacts_of(e);
      assert_int_equal(got.count, 1);
      assert_int_equal(got.c[0].i, 0);
      assert_int_equal(got.c[0].j, 1);
      assert_near(got.c[0].overlap, o, 1e-12);
      assert_near(got.c[0].energy, STIFFNESS * o * o / 2, 1e-10);
      for (int m = 0; m < 2; m++) {
        assert_near(got.c[0].l[m], d[m], 1e-12);
        assert_near(got.c[0].f[m], -STIFFNESS * o * n[m], 1e-10);
        assert_near(got.f[m], -STIFFNESS * o * n[m], 1e-10);
        assert_near(got.f[2 + m], STIFFNESS * o * n[m], 1e-10);
      }
      const double along = STIFFNESS, across = -STIFFNESS * o / r; /* eigenvalues of the second derivative */
      assert_near(got.c[0].h[0], along * n[0] * n[0] + across * n[1] * n[1], 1e-9);
      assert_near(got.c[0].h[1], (along - across) * n[0] * n[1], 1e-9);
      assert_near(got.c[0].h[2], along * n[1] * n[1] + across * n[0] * n[0], 1e-9);
    }
  gh_engine_destroy(&e);
  drop(&p);
}

/* One grain in a square cell touches two of its own images, in any orientation and basis; its force is zero.
 */
static void square_lattice(void **state) {
  (void)state;
  packing p = make(1);
  p.radius[0] = 0.5;
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  const double a = 0.98;
  for (int turn = 0; turn < 24; turn++) {
    double Q[4], cell[4], x[2] = {3.1 * turn, -1};
    rotation(15 * turn, Q);
    for (int shear = -3; shear <= 3; shear++) {
      gh_mul2(Q, (double[4]){a, shear * a, 0, a}, cell);
      OK(gh_engine_set(e, cell, x, NULL));
      outcome o = contacts_of(e);
      assert_int_equal(o.count, 2);
      for (int k = 0; k < 2; k++) {
        assert_int_equal(o.c[k].i, 0);
        assert_int_equal(o.c[k].j, 0);
        assert_near(o.c[k].overlap, 1 - a, 1e-12);
      }
      assert_near(fabs(o.c[0].l[0] * o.c[1].l[1] - o.c[0].l[1] * o.c[1].l[0]), a * a, 1e-12);
      assert_near(hypot(o.f[0], o.f[1]), 0, 1e-12);
    }
  }
  gh_engine_destroy(&e);
  drop(&p);
}

/* Cells of one to four grains, where pairs touch in several images, have the contacts that brute force finds.
 */
static void tiny_cells(void **state) {
  (void)state;
  const uint64_t first = 20240611;
  uint64_t seed = first;
  print_message("seed %llu\n", (unsigned long long)first);
  for (int n = 1; n <= 4; n++) {
    packing p = make(n);
    for (int i = 0; i < n; i++) p.radius[i] = 0.3 + 0.5 * uniform(&seed);
    gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
    for (int k = 0; k < 40; k++) {
      for (int m = 0; m < 4; m++) p.cell[m] = (m == 0 || m == 3) + 1.6 * (uniform(&seed) - 0.5);
      if (gh_det2(p.cell) < 0.5) continue;
      for (int m = 0; m < 2 * n; m++) p.x[m] = 6 * (uniform(&seed) - 0.5);
      int count;
      double energy = brute_force(&p, 14, &count);
      OK(gh_engine_set(e, p.cell, p.x, NULL));
      outcome o = contacts_of(e);
      assert_int_equal(o.count, count);
      assert_near(energy_of(o), energy, 1e-11 * (1 + energy));
      assert_sums(o, n, 1e-10);
    }
    gh_engine_destroy(&e);
    drop(&p);
  }
}

/* A packing without contacts has none, no forces, and counts as relaxed and unjammed. */
static void no_contact(void **state) {
  (void)state;
  packing p = make(2);
  p.radius[0] = p.radius[1] = 0.1;
  p.x[2] = p.x[3] = 0.5;
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  OK(gh_engine_set(e, p.cell, p.x, NULL));
  gh_relax_result r;
  OK(gh_engine_relax(e, &(gh_relax_options){.tolerance = 1e-8, .max_steps = 1000, .method = GH_RELAX_DAMPED},
                     &r));
  assert_true(r.converged);
  assert_near(r.residual, 0, 0);
  assert_near(r.mean_force, 0, 0);
  outcome o = contacts_of(e);
  assert_int_equal(o.count, 0);
  for (int k = 0; k < 4; k++) assert_near(o.f[k], 0, 0);
  gh_engine_destroy(&e);
  drop(&p);
}

/* ---- against the native engine ---- */

static const double deformations[][4] = {
    {1, 0, 0, 1}, {1, 0.03, 0, 1}, {1, 0.8, 0.1, 1}, {0.98, 0, 0, 0.99}, {1, -2.3, 0, 1}};

/* Contacts and forces of 150 grains equal those of the native engine, deformed and turned. */
static void same_as_native(void **state) {
  (void)state;
  packing p = read_p150();
  gh_engine *lammps = open_engine(&p, GH_ENGINE_LAMMPS), *native = open_engine(&p, GH_ENGINE_NATIVE);
  for (size_t k = 0; k < sizeof deformations / sizeof *deformations; k++)
    for (int turn = 0; turn < 2; turn++) {
      packing q = read_p150();
      double Q[4];
      rotation(30 * turn, Q);
      deform(&q, deformations[k]);
      deform(&q, Q);
      OK(gh_engine_set(lammps, q.cell, q.x, NULL));
      OK(gh_engine_set(native, q.cell, q.x, NULL));
      outcome a = contacts_of(lammps), b = contacts_of(native);
      assert_true(a.count > 100);
      assert_same_contacts(a, b, q.n, 1e-12);
      assert_sums(a, q.n, 1e-12);
      drop(&q);
    }
  gh_engine_destroy(&lammps);
  gh_engine_destroy(&native);
  drop(&p);
}

/* A cluster in free space has the contacts of the native engine, wherever it is; grains alone have none. */
static void cluster_as_native(void **state) {
  (void)state;
  packing p = read_p150();
  p.cluster = true;
  gh_engine *lammps = open_engine(&p, GH_ENGINE_LAMMPS), *native = open_engine(&p, GH_ENGINE_NATIVE);
  for (int k = 0; k < 4; k++) {
    deform(&p, (double[4]){1.003, 0.4, -0.5, 0.9});
    for (int i = 0; i < p.n; i++) p.x[2 * i] += 100 * k;
    OK(gh_engine_set(lammps, NULL, p.x, NULL));
    OK(gh_engine_set(native, NULL, p.x, NULL));
    assert_same_contacts(contacts_of(lammps), contacts_of(native), p.n, 1e-12);
  }
  gh_engine_destroy(&lammps);
  gh_engine_destroy(&native);
  drop(&p);
  packing one = make(1);
  one.cluster = true;
  one.radius[0] = 2;
  gh_engine *e = open_engine(&one, GH_ENGINE_LAMMPS);
  OK(gh_engine_set(e, NULL, one.x, NULL));
  assert_int_equal(contacts_of(e).count, 0);
  gh_engine_destroy(&e);
  drop(&one);
}

/* Takes out the contacts without force: where a rattler rests depends on round-off. */
static int loaded(outcome o, double limit, gh_contact *out) {
  int n = 0;
  for (int k = 0; k < o.count; k++)
    if (hypot(o.c[k].f[0], o.c[k].f[1]) > limit) out[n++] = o.c[k];
  return n;
}

/* Relaxed to 1e-11, both engines are in the same equilibrium: forces and branch vectors of loaded contacts
 * agree to 1e-9 (rattlers, and with them the translation of the rest, are free).
 */
static void relax_as_native(void **state) {
  (void)state;
  packing p = read_p150();
  double Q[4];
  gh_contact *c[2];
  gh_relax_result r[2];
  int count[2];
  rotation(30, Q);
  deform(&p, (double[4]){0.985, 0.01, 0, 0.99});
  deform(&p, Q);
  for (int k = 0; k < 2; k++) {
    gh_engine *e = open_engine(&p, k ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS);
    c[k] = calloc(20 * (size_t)p.n, sizeof *c[k]);
    OK(gh_engine_set(e, p.cell, p.x, NULL));
    OK(gh_engine_relax(
        e, &(gh_relax_options){.tolerance = 1e-11, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r[k]));
    assert_true(r[k].converged && r[k].residual <= 1e-11);
    outcome o = contacts_of(e);
    double largest = 0;
    for (int i = 0; i < p.n; i++) largest = fmax(largest, hypot(o.f[2 * i], o.f[2 * i + 1]));
    assert_near(largest / r[k].mean_force, r[k].residual, 2e-12); /* the residual is what the forces say */
    count[k] = loaded(o, 1e-6 * r[k].mean_force, c[k]);
    gh_engine_destroy(&e);
  }
  assert_near(r[0].mean_force, r[1].mean_force, 1e-9 * r[1].mean_force);
  assert_int_equal(count[0], count[1]);
  for (int k = 0; k < count[0]; k++)
    for (int m = 0; m < 2; m++) {
      const gh_contact *a = &c[0][k], *b = &c[1][k];
      assert_true(a->i == b->i && a->j == b->j);
      assert_near(a->f[m], b->f[m], 1e-9 * r[1].mean_force);
      assert_near(a->l[m], b->l[m], 1e-9 * hypot(b->l[0], b->l[1]));
    }
  for (int k = 0; k < 2; k++) free(c[k]);
  drop(&p);
}

/* A cluster with held grains relaxes to the native engine's equilibrium, and moves as it does. */
static void cluster_relaxes_as_native(void **state) {
  (void)state;
  packing p = read_p150();
  p.cluster = true;
  for (int i = 0; i < p.n; i++) p.held[i] = fmax(fabs(p.x[2 * i]), fabs(p.x[2 * i + 1])) > 0.6;
  deform(&p, (double[4]){0.99, 0.01, 0, 0.985});
  gh_contact *c[2];
  int count[2];
  gh_relax_result r[2];
  double *x = calloc(2 * (size_t)p.n, sizeof *x);
  for (int k = 0; k < 2; k++) {
    gh_engine *e = open_engine(&p, k ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS);
    c[k] = calloc(20 * (size_t)p.n, sizeof *c[k]);
    OK(gh_engine_set(e, NULL, p.x, NULL));
    OK(gh_engine_relax(
        e, &(gh_relax_options){.tolerance = 1e-11, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r[k]));
    assert_true(r[k].converged);
    OK(gh_engine_get(e, x, NULL));
    for (int i = 0; i < p.n; i++)
      if (p.held[i]) assert_memory_equal(&x[2 * i], &p.x[2 * i], 2 * sizeof *x);
    OK(gh_engine_move(e, x, NULL));
    count[k] = loaded(contacts_of(e), 1e-6 * r[k].mean_force, c[k]);
    gh_engine_destroy(&e);
  }
  assert_int_equal(count[0], count[1]);
  for (int k = 0; k < count[0]; k++)
    for (int m = 0; m < 2; m++) assert_near(c[0][k].f[m], c[1][k].f[m], 1e-9 * r[1].mean_force);
  free(c[0]);
  free(c[1]);
  free(x);
  drop(&p);
}

/* ---- what an engine promises ---- */

/* What comes back depends on cell and positions only, to the last bit, whatever the engine did before. */
static void no_memory(void **state) {
  (void)state;
  packing p = read_p150();
  size_t bytes = 2 * (size_t)p.n * sizeof(double);
  double *x1 = malloc(bytes), *x2 = malloc(bytes);
  gh_engine *fresh = open_engine(&p, GH_ENGINE_LAMMPS), *used = open_engine(&p, GH_ENGINE_LAMMPS);
  const gh_relax_options options = {.tolerance = 1e-6, .max_steps = 100000, .method = GH_RELAX_DAMPED};
  gh_relax_result r1, r2;
  packing other = read_p150();
  deform(&other, (double[4]){1.1, 0.9, -0.7, 1.2});
  OK(gh_engine_set(used, other.cell, other.x, NULL));
  OK(gh_engine_relax(used, &options, &r2));
  OK(gh_engine_move(used, other.x, NULL));
  deform(&p, (double[4]){0.99, 0.02, 0, 0.99});
  OK(gh_engine_set(fresh, p.cell, p.x, NULL));
  OK(gh_engine_set(used, p.cell, p.x, NULL));
  outcome a = contacts_of(fresh), b = contacts_of(used);
  assert_int_equal(a.count, b.count);
  assert_memory_equal(a.c, b.c, (size_t)a.count * sizeof *a.c);
  assert_memory_equal(a.f, b.f, bytes);
  OK(gh_engine_relax(fresh, &options, &r1));
  OK(gh_engine_relax(used, &options, &r2));
  assert_int_equal(r1.steps, r2.steps);
  assert_memory_equal(&r1.residual, &r2.residual, sizeof r1.residual);
  OK(gh_engine_get(fresh, x1, NULL));
  OK(gh_engine_get(used, x2, NULL));
  assert_memory_equal(x1, x2, bytes);
  gh_engine_destroy(&fresh);
  gh_engine_destroy(&used);
  free(x1);
  free(x2);
  drop(&other);
  drop(&p);
}

/* Held grains stay to the last bit while others relax; positions come back as they were given. */
static void held_grains(void **state) {
  (void)state;
  packing p = read_p150();
  for (int i = 0; i < p.n; i += 3) p.held[i] = 1;
  deform(&p, (double[4]){0.99, 0.01, 0, 0.98});
  for (int i = 0; i < p.n; i++) p.x[2 * i] += 50; /* far from the cell at the origin */
  double *x = malloc(2 * (size_t)p.n * sizeof *x), moved = 0;
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  OK(gh_engine_set(e, p.cell, p.x, NULL));
  OK(gh_engine_get(e, x, NULL));
  assert_memory_equal(x, p.x, 2 * (size_t)p.n * sizeof *x);
  gh_relax_result r;
  OK(gh_engine_relax(
      e, &(gh_relax_options){.tolerance = 1e-9, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r));
  assert_true(r.converged);
  OK(gh_engine_get(e, x, NULL));
  for (int i = 0; i < p.n; i++) {
    if (p.held[i]) assert_memory_equal(&x[2 * i], &p.x[2 * i], 2 * sizeof *x);
    else moved = fmax(moved, hypot(x[2 * i] - p.x[2 * i], x[2 * i + 1] - p.x[2 * i + 1]));
  }
  assert_true(moved > 1e-3);
  outcome o = contacts_of(e);
  for (int i = 0; i < p.n; i++)
    if (!p.held[i]) assert_true(hypot(o.f[2 * i], o.f[2 * i + 1]) <= 1.001e-9 * r.mean_force);
  gh_engine_destroy(&e);
  free(x);
  drop(&p);
}

/* Small and large moves give what setting the same positions gives; small ones keep the neighbour list. */
static void moves(void **state) {
  (void)state;
  const uint64_t first = 7;
  uint64_t seed = first;
  print_message("seed %llu\n", (unsigned long long)first);
  packing p = read_p150();
  gh_engine *a = open_engine(&p, GH_ENGINE_LAMMPS), *b = open_engine(&p, GH_ENGINE_LAMMPS);
  OK(gh_engine_set(a, p.cell, p.x, NULL));
  gh_engine_cost before, after;
  gh_engine_costs(a, &before);
  for (int k = 0; k < 3; k++) {
    for (int m = 0; m < 2 * p.n; m++) p.x[m] += (k == 2 ? 0.1 : 1e-4) * (uniform(&seed) - 0.5);
    OK(gh_engine_move(a, p.x, NULL));
    OK(gh_engine_set(b, p.cell, p.x, NULL));
    assert_same_contacts(contacts_of(a), contacts_of(b), p.n, 1e-12);
    gh_engine_costs(a, &after);
    assert_int_equal(after.rebuilds - before.rebuilds, k == 2);
  }
  gh_engine_destroy(&a);
  gh_engine_destroy(&b);
  drop(&p);
}

/* Relaxation that runs out of steps says so and leaves a consistent state, from which it can go on. */
static void out_of_steps(void **state) {
  (void)state;
  packing p = read_p150();
  deform(&p, (double[4]){0.97, 0, 0, 0.99});
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  gh_relax_result r;
  OK(gh_engine_set(e, p.cell, p.x, NULL));
  OK(gh_engine_relax(e, &(gh_relax_options){.tolerance = 1e-12, .max_steps = 17, .method = GH_RELAX_DAMPED},
                     &r));
  assert_false(r.converged);
  assert_int_equal(r.steps, 17);
  assert_true(r.residual > 1e-3);
  assert_sums(contacts_of(e), p.n, 1e-12);
  OK(gh_engine_relax(
      e, &(gh_relax_options){.tolerance = 1e-9, .max_steps = 100000, .method = GH_RELAX_DAMPED}, &r));
  assert_true(r.converged);
  gh_engine_destroy(&e);
  drop(&p);
}

/* ---- errors ---- */

/* Setups out of range and calls before the first set are refused with a message. */
static void bad_setup(void **state) {
  (void)state;
  const double radius[] = {1, 1}, negative[] = {1, -1}, x[4] = {0, 0, 1, 1}, inverted[4] = {0, 1, 1, 0};
  const double unit[4] = {4, 0, 0, 4}, nan_x[4] = {0, 0, NAN, 1};
  const int types[] = {1, 5000};
  gh_engine *e;
  gh_engine_setup s = {.n = 2, .radius = radius, .type = types, .periodic = true, .law = {1}};
  assert_int_equal(gh_engine_create(ctx, GH_ENGINE_LAMMPS, &s, &e), GH_INPUT);
  assert_non_null(strstr(gh_message(ctx), "5000"));
  s.type = NULL;
  s.radius = negative;
  assert_int_equal(gh_engine_create(ctx, GH_ENGINE_LAMMPS, &s, &e), GH_INPUT);
  s.radius = radius;
  OK(gh_engine_create(ctx, GH_ENGINE_LAMMPS, &s, &e));
  outcome o;
  assert_int_equal(list_of(e, &o.c, &o.count, &o.f), GH_ENGINE);
  assert_int_equal(gh_engine_move(e, x, NULL), GH_ENGINE);
  assert_int_equal(gh_engine_set(e, inverted, x, NULL), GH_INPUT);
  assert_int_equal(gh_engine_set(e, unit, nan_x, NULL), GH_INPUT);
  OK(gh_engine_set(e, unit, x, NULL));
  gh_engine_destroy(&e);
}

/* Coinciding centres are LAMMPS's error: a message with both ids; the engine goes on with the next set. */
static void error_in_run(void **state) {
  (void)state;
  packing p = make(3);
  memcpy(p.cell, (double[4]){9, 0, 0, 9}, sizeof p.cell);
  p.radius[0] = p.radius[1] = p.radius[2] = 1;
  const double bad[6] = {1, 1, 4, 4, 4, 4}, good[6] = {1, 1, 4, 4, 5.5, 4};
  gh_engine *e = open_engine(&p, GH_ENGINE_LAMMPS);
  for (int k = 0; k < 3; k++) {
    outcome o;
    assert_int_equal(gh_engine_set(e, p.cell, bad, NULL), GH_ENGINE);
    assert_non_null(strstr(gh_message(ctx), "coincide"));
    assert_non_null(strstr(gh_message(ctx), "2 and 3"));
    assert_int_equal(list_of(e, &o.c, &o.count, &o.f), GH_ENGINE);
    OK(gh_engine_set(e, p.cell, good, NULL));
    o = contacts_of(e);
    assert_int_equal(o.count, 1);
    assert_near(o.c[0].overlap, 0.5, 1e-13);
  }
  assert_int_equal(gh_engine_set(e, p.cell, bad, NULL), GH_ENGINE);
  gh_engine_destroy(&e);
  drop(&p);
}

/* Errors of LAMMPS come back as its own message, and the process lives on. */
static void errors_become_messages(void **state) {
  (void)state;
  static const char *const wrong[][2] = {
      {"bogus 1 2", "Unknown command"},
      {"units furlong", "(src/update.cpp:"},
      {"pair_style no/such/style", "Unrecognized pair style"},
      {"pair_style granhom/normal 3", "no arguments"},
      {"run 1", "before simulation box"},
      {"variable a equal 1/0\nprint $a", "Divide by 0"},
  };
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    void *lmp;
    char line[200], *rest;
    OK(gh_lmp_open(ctx, &lmp));
    snprintf(line, sizeof line, "%s", wrong[k][0]);
    rest = strchr(line, '\n');
    if (rest) {
      *rest++ = 0;
      OK(gh_lmp_command(ctx, lmp, "%s", line));
    }
    assert_int_equal(gh_lmp_command(ctx, lmp, "%s", rest ? rest : line), GH_ENGINE);
    if (!strstr(gh_message(ctx), wrong[k][1])) fail_msg("no \"%s\" in: %s", wrong[k][1], gh_message(ctx));
    gh_lmp_close(&lmp);
    assert_null(lmp);
  }
}

/* ---- the styles in LAMMPS's own hands ---- */

/* A random 3D packing of 60 spheres of two types; newton on or off. */
static void *open_3d(const char *newton, bool tilted) {
  void *lmp;
  uint64_t seed = 99;
  int id[60], type[60];
  double x[180], *radius;
  OK(gh_lmp_open(ctx, &lmp));
  OK(gh_lmp_command(ctx, lmp, "atom_style sphere"));
  OK(gh_lmp_command(ctx, lmp, "newton %s", newton));
  OK(gh_lmp_command(ctx, lmp, "box tilt large"));
  OK(gh_lmp_command(ctx, lmp,
                    tilted ? "region r prism 0 4 0 4 0 3 1 0.5 -0.7" : "region r block 0 4 0 4 0 3"));
  OK(gh_lmp_command(ctx, lmp, "create_box 2 r"));
  for (int i = 0; i < 60; i++) {
    id[i] = i + 1;
    type[i] = 1 + i % 2;
    double s[3] = {uniform(&seed), uniform(&seed), uniform(&seed)};
    x[3 * i] = 4 * s[0] + (tilted ? 1 * s[1] + 0.5 * s[2] : 0);
    x[3 * i + 1] = 4 * s[1] - (tilted ? 0.7 * s[2] : 0);
    x[3 * i + 2] = 3 * s[2];
  }
  OK(gh_lmp_create_atoms(ctx, lmp, 60, id, type, x));
  OK(gh_lmp_atom(ctx, lmp, "radius", &radius));
  for (int i = 0; i < 60; i++) radius[i] = type[i] == 1 ? 0.5 : 0.35;
  OK(gh_lmp_command(ctx, lmp, "neighbor 0.1 bin"));
  OK(gh_lmp_command(ctx, lmp, "pair_style granhom/normal"));
  OK(gh_lmp_command(ctx, lmp, "pair_coeff 1 1 40"));
  OK(gh_lmp_command(ctx, lmp, "pair_coeff 2 2 60"));
  OK(gh_lmp_command(ctx, lmp, "compute c all granhom/contact/local"));
  return lmp;
}

/* A vector or scalar of a compute, as LAMMPS's library hands it out. */
static const double *global_data(void *lmp, const char *id, int type) {
  const double *data = lammps_extract_compute(lmp, id, LMP_STYLE_GLOBAL, type);
  assert_non_null(data);
  return data;
}

/* What a row says of itself: force, energy and trace of the second derivative from overlap and distance. */
static void assert_row(const double *row) {
  int a = (int)row[0], b = (int)row[1];
  double E = a % 2 && b % 2 ? 40 : a % 2 || b % 2 ? 50 : 60; /* odd ids are of type 1; mixed: the mean */
  double d = sqrt(row[2] * row[2] + row[3] * row[3] + row[4] * row[4]), e = row[8];
  assert_true(a <= b);
  for (int m = 0; m < 3; m++) assert_near(row[5 + m], -E * e * row[2 + m] / d, 1e-11);
  assert_near(row[9], E * e * e / 2, 1e-11);
  assert_near(row[10] + row[13] + row[15], E * (1 - 2 * e / d), 1e-9);
}

/* 3D, newton on and off, box straight and tilted: the rows' forces add up to the atoms' forces, their
 * energies and virials to LAMMPS's energy and pressure tensor, and the compute's own totals say the same. */
static void compute_sums_3d(void **state) {
  (void)state;
  static const int pair_of[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < 4; k++) {
    void *lmp = open_3d(k % 2 ? "on" : "off", k / 2);
    int count, *tag;
    double **rows, **f, sum[61][3] = {{0}}, energy = 0, virial[6] = {0};
    OK(gh_lmp_command(ctx, lmp, "compute e all pe"));
    OK(gh_lmp_command(ctx, lmp, "compute p all pressure NULL virial"));
    OK(gh_lmp_command(ctx, lmp, "thermo_style custom step c_e c_p[1]"));
    OK(gh_lmp_command(ctx, lmp, "fix r all granhom/relax"));
    OK(gh_lmp_command(ctx, lmp, "run 0 post no"));
    OK(gh_lmp_local(ctx, lmp, "c", &count, &rows));
    OK(gh_lmp_atom(ctx, lmp, "f", &f));
    OK(gh_lmp_atom(ctx, lmp, "id", &tag));
    assert_true(count > 30);
    for (int r = 0; r < count; r++) {
      assert_row(rows[r]);
      energy += rows[r][9];
      for (int m = 0; m < 3; m++) {
        sum[(int)rows[r][0]][m] += rows[r][5 + m];
        sum[(int)rows[r][1]][m] -= rows[r][5 + m];
      }
      for (int m = 0; m < 6; m++) virial[m] -= rows[r][2 + pair_of[m][0]] * rows[r][5 + pair_of[m][1]];
    }
    for (int i = 0; i < 60; i++)
      for (int m = 0; m < 3; m++) assert_near(f[i][m], sum[tag[i]][m], 1e-10);
    assert_near(*global_data(lmp, "e", LMP_TYPE_SCALAR), energy, 1e-11 * energy);
    for (int m = 0; m < 6; m++) {
      assert_near(global_data(lmp, "p", LMP_TYPE_VECTOR)[m], virial[m] / 48, 1e-11 * fabs(virial[0]));
      assert_near(global_data(lmp, "c", LMP_TYPE_VECTOR)[m], -virial[m] / 48, 1e-11 * fabs(virial[0]));
    }
    assert_near(global_data(lmp, "c", LMP_TYPE_VECTOR)[6], energy, 1e-11 * energy);
    assert_near(global_data(lmp, "c", LMP_TYPE_VECTOR)[7], count, 0);
    gh_lmp_close(&lmp);
  }
}

/* The compute refuses to read a list that is out of date: before any run, and after the box has changed. */
static void compute_refuses_stale_lists(void **state) {
  (void)state;
  void *lmp = open_3d("off", false);
  int count, again;
  double **rows;
  assert_int_equal(gh_lmp_local(ctx, lmp, "c", &count, &rows), GH_ENGINE);
  assert_non_null(strstr(gh_message(ctx), "run 0"));
  OK(gh_lmp_command(ctx, lmp, "fix r all granhom/relax"));
  OK(gh_lmp_command(ctx, lmp, "run 0 post no"));
  OK(gh_lmp_local(ctx, lmp, "c", &count, &rows));
  OK(gh_lmp_command(ctx, lmp, "change_box all x scale 0.9 remap"));
  OK(gh_lmp_command(ctx, lmp, "reset_timestep 1"));
  assert_int_equal(gh_lmp_local(ctx, lmp, "c", &again, &rows), GH_ENGINE);
  assert_non_null(strstr(gh_message(ctx), "run 0"));
  OK(gh_lmp_command(ctx, lmp, "run 0 post no"));
  OK(gh_lmp_local(ctx, lmp, "c", &again, &rows));
  assert_true(again > count);
  assert_int_equal(gh_lmp_local(ctx, lmp, "nothing", &again, &rows), GH_ENGINE);
  gh_lmp_close(&lmp);
}

/* fix granhom/relax in a plain script relaxes 3D packings to its tolerance and ends the run by itself. */
static void relax_3d(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    void *lmp = open_3d(k ? "on" : "off", true);
    double residual, ended, mean, **f;
    OK(gh_lmp_command(ctx, lmp, "set type 1 diameter 1.3")); /* jammed */
    OK(gh_lmp_command(ctx, lmp, "set type 2 diameter 1.0"));
    OK(gh_lmp_command(ctx, lmp, "neigh_modify every 1 delay 0 check yes"));
    OK(gh_lmp_command(ctx, lmp, "fix r all granhom/relax tolerance 1e-9"));
    OK(gh_lmp_command(ctx, lmp, "run 200000"));
    OK(gh_lmp_fix_vector(ctx, lmp, "r", 0, &residual));
    OK(gh_lmp_fix_vector(ctx, lmp, "r", 1, &mean));
    OK(gh_lmp_fix_vector(ctx, lmp, "r", 4, &ended));
    assert_true(ended == 1 || ended == 2);
    assert_true(residual <= 1e-9);
    OK(gh_lmp_atom(ctx, lmp, "f", &f));
    for (int i = 0; i < 60; i++)
      assert_true(sqrt(f[i][0] * f[i][0] + f[i][1] * f[i][1] + f[i][2] * f[i][2]) <= 1.001e-9 * mean);
    OK(gh_lmp_command(ctx, lmp, "run 10 pre no")); /* thermo output with energies: they were tallied */
    gh_lmp_close(&lmp);
  }
}

/* Wrong arguments of the styles end in messages that name them. */
static void wrong_arguments(void **state) {
  (void)state;
  static const char *const wrong[][2] = {
      {"pair_coeff 1 1", "pair_coeff I J E"},
      {"pair_coeff 1 1 -5", "positive and finite, not -5"},
      {"pair_coeff 1 1 0", "positive and finite, not 0"},
      {"pair_coeff 1 1 inf", "inf"},
      {"pair_coeff 1 9 1", "9"},
      {"fix r all granhom/relax tolerance", "no value for tolerance"},
      {"fix r all granhom/relax tolerance -1", "not -1"},
      {"fix r all granhom/relax max_steps 0", "not 0"},
      {"fix r all granhom/relax inner maybe", "not maybe"},
      {"fix r all granhom/relax inner yes", "2d"},
      {"fix r all granhom/relax method cg", "method is damped or fire, not cg"},
      {"fix r all granhom/relax method fire", "method fire requires inner yes"},
      {"fix r all granhom/relax speed 3", "unknown keyword speed"},
      {"compute d all granhom/contact/local x", "no arguments"},
  };
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    void *lmp = open_3d("off", false);
    assert_int_equal(gh_lmp_command(ctx, lmp, "%s", wrong[k][0]), GH_ENGINE);
    if (!strstr(gh_message(ctx), wrong[k][1])) fail_msg("no \"%s\" in: %s", wrong[k][1], gh_message(ctx));
    gh_lmp_close(&lmp);
  }
}

/* The styles are there again after `clear`. */
static void styles_after_clear(void **state) {
  (void)state;
  void *lmp = open_3d("off", false);
  OK(gh_lmp_command(ctx, lmp, "clear"));
  OK(gh_lmp_command(ctx, lmp, "atom_style sphere"));
  OK(gh_lmp_command(ctx, lmp, "region r block 0 1 0 1 0 1"));
  OK(gh_lmp_command(ctx, lmp, "create_box 1 r"));
  OK(gh_lmp_command(ctx, lmp, "pair_style granhom/normal"));
  OK(gh_lmp_command(ctx, lmp, "fix r all granhom/relax"));
  OK(gh_lmp_command(ctx, lmp, "compute c all granhom/contact/local"));
  gh_lmp_close(&lmp);
}

static int set_up(void **state) {
  (void)state;
  return gh_context_create(&ctx) != GH_OK;
}

static int tear_down(void **state) {
  (void)state;
  gh_context_destroy(&ctx);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_disks),
      cmocka_unit_test(square_lattice),
      cmocka_unit_test(tiny_cells),
      cmocka_unit_test(no_contact),
      cmocka_unit_test(same_as_native),
      cmocka_unit_test(cluster_as_native),
      cmocka_unit_test(relax_as_native),
      cmocka_unit_test(cluster_relaxes_as_native),
      cmocka_unit_test(no_memory),
      cmocka_unit_test(held_grains),
      cmocka_unit_test(moves),
      cmocka_unit_test(out_of_steps),
      cmocka_unit_test(bad_setup),
      cmocka_unit_test(error_in_run),
      cmocka_unit_test(errors_become_messages),
      cmocka_unit_test(compute_sums_3d),
      cmocka_unit_test(compute_refuses_stale_lists),
      cmocka_unit_test(relax_3d),
      cmocka_unit_test(wrong_arguments),
      cmocka_unit_test(styles_after_clear),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
