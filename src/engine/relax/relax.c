/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dynamic relaxation on a list of neighbour pairs (dissertation 4.4). */
#include "engine/relax/relax_parts.h"

#include "contact/normal.h"

#include "granhom/base.h"

#include <string.h>

enum { BOUND_EVERY = 32 }; /* steps between two bounds of the largest eigenvalue */

/* Least damping, over 1/dt. Grains that collide without a network between them have no lowest eigenvalue, and
 * without damping never come to rest. */
static const double LEAST_DAMPING = 1e-2;

enum { PER_BLOCK = 3 };

/* The parts of the work space. */
typedef struct parts {
  double *given; /* PAIR_GIVEN x npairs */
  double *pair;  /* PAIR_EXERTED x npairs */
  double *old;   /* 2 n: forces of the last step */
  double *block; /* PER_BLOCK n: stiffness of each grain alone */
  int *i, *j;    /* npairs: grains of each pair */
} parts;

size_t gh_relax_work(int n, int npairs) {
  return (PAIR_GIVEN + PAIR_EXERTED) * (size_t)npairs + (2 + PER_BLOCK) * (size_t)n +
         (2 * (size_t)npairs * sizeof(int) + sizeof(double) - 1) / sizeof(double);
}

static parts divide(const gh_relax_state *s) {
  const size_t n = (size_t)s->n, npairs = (size_t)s->npairs;
  parts w = {.given = s->work};
  w.pair = w.given + PAIR_GIVEN * npairs;
  w.old = w.pair + PAIR_EXERTED * npairs;
  w.block = w.old + 2 * n;
  w.i = (int *)(void *)(w.block + PER_BLOCK * n);
  w.j = w.i + npairs;
  return w;
}

void gh_relax_begin(gh_relax_state *s) {
  const parts w = divide(s);
  gh_pairs_lay_out(s->pairs, (size_t)s->npairs, w.given, w.i, w.j);
}

/* Forces and overlaps of all pairs, without branches so that it vectorises; negative: apart. */
static void pair_forces(const int *restrict first, const int *restrict second, size_t n, double E,
                        const double *restrict given, const double *restrict x, double *restrict out) {
#pragma omp simd
  for (size_t p = 0; p < n; p++) {
    const int i = first[p], j = second[p];
    const double lx = x[2 * j] - x[2 * i] + given[SHIFT_X * n + p],
                 ly = x[2 * j + 1] - x[2 * i + 1] + given[SHIFT_Y * n + p], d = sqrt(lx * lx + ly * ly),
                 e = given[REACH * n + p] - d, factor = gh_normal_factor(E, e >= 0 ? e : 0, d);
    out[FORCE_X * n + p] = factor * lx;
    out[FORCE_Y * n + p] = factor * ly;
    out[OVERLAP * n + p] = e;
  }
}

static double gather(const gh_relax_state *s, const parts *w) {
  return gh_pairs_gather(s->n, (size_t)s->npairs, w->i, w->j, w->pair, NULL, s->f, NULL);
}

double gh_relax_largest(int n, const unsigned char *held, const double *f, const double *couple) {
  double largest = 0;
  for (int i = 0; i < n; i++) {
    const double force = held && held[i] ? 0 : hypot(f[2 * i], f[2 * i + 1]);
    largest = gh_max(largest, gh_max(force, couple ? fabs(couple[i]) : 0));
    if (!isfinite(f[2 * i]) || !isfinite(f[2 * i + 1])) return NAN;
  }
  return isfinite(largest) ? largest : NAN;
}

double gh_relax_forces(gh_relax_state *s, double *mean_force) {
  const parts w = divide(s);
  const size_t n = (size_t)s->npairs;
  pair_forces(w.i, w.j, n, s->stiffness, w.given, s->x, w.pair);
  if (s->frame)
    gh_frame_weigh(s->frame, n, w.i, w.j, 2, (double *const[]){w.pair + FORCE_X * n, w.pair + FORCE_Y * n});
  *mean_force = s->stiffness * gather(s, &w);
  if (s->frame) gh_frame_act(s->frame, s->n, NULL, s->f, NULL);
  double largest = 0, all = 0;
  for (int i = 0; i < s->n; i++) {
    const double f2 = s->f[2 * i] * s->f[2 * i] + s->f[2 * i + 1] * s->f[2 * i + 1];
    if (f2 > largest && !(s->held && s->held[i])) largest = f2;
    all += f2;
  }
  /* the comparison passes over NaN, and squares may have left the range of numbers */
  return all <= GH_RELAX_MOST && largest >= GH_RELAX_LEAST ? sqrt(largest)
                                                           : gh_relax_largest(s->n, s->held, s->f, NULL);
}

double gh_relax_quotient(double up, double down) {
  const double quotient = up / down;
  return down > 0 && up > 0 && isfinite(quotient) ? quotient : 0;
}

double gh_relax_bound(double kxx, double kxy, double kyy) {
  return kxx + kyy + sqrt((kxx - kyy) * (kxx - kyy) + 4 * kxy * kxy);
}

double gh_relax_time_step(double bound) {
  return 1.8 / sqrt(bound);
}

/* The quadratic form of a contact in the displacements of its two grains is at most twice the sum of those of
 * the grains' own blocks. Pairs that nearly touch count too: they may touch before the next bound. */
double gh_relax_safe_step(const gh_relax_state *s) {
  double *k = divide(s).block, bound = 4 * s->stiffness;
  memset(k, 0, PER_BLOCK * (size_t)s->n * sizeof *k);
  for (int p = 0; p < s->npairs; p++) {
    const gh_pair *q = &s->pairs[p];
    double l[2] = {s->x[2 * q->j] - s->x[2 * q->i] + q->shift[0],
                   s->x[2 * q->j + 1] - s->x[2 * q->i + 1] + q->shift[1]};
    double d2 = l[0] * l[0] + l[1] * l[1];
    if (d2 > 1.01 * q->reach * q->reach) continue;
    double b[3] = {l[0] * l[0] / d2, l[0] * l[1] / d2, l[1] * l[1] / d2};
    for (int c = 0; c < 3; c++) {
      k[3 * q->i + c] += s->stiffness * b[c];
      k[3 * q->j + c] += s->stiffness * b[c];
    }
  }
  for (int i = 0; i < s->n; i++) {
    double b = gh_relax_bound(k[3 * i], k[3 * i + 1], k[3 * i + 2]);
    if (b > bound) bound = b;
  }
  return gh_relax_time_step(bound);
}

/* A constraint that ties grains to each other is kept if all are slowed down alike. */
static double move_slow_down(const gh_relax_state *s, double a, double b, double fastest) {
  double most = 0;
  if (!s->frame || !s->frame->area) return 1;
  for (int i = 0; i < s->n; i++) {
    if (s->held && s->held[i]) continue;
    most = fmax(most, hypot(a * s->v[2 * i] + b * s->f[2 * i], a * s->v[2 * i + 1] + b * s->f[2 * i + 1]));
  }
  return most >= fastest ? 0.999 * fastest / most : 1;
}

double gh_relax_move(gh_relax_state *s, double a, double b, double dt) {
  const double fastest = 0.9 * s->slack / dt; /* so that round-off does not decide when the list is rebuilt */
  const double all = move_slow_down(s, a, b, fastest);
  double far = 0;
  for (int i = 0; i < s->n; i++) {
    const double free = s->held && s->held[i] ? 0 : all;
    double *v = s->v + 2 * i, *x = s->x + 2 * i, r2 = 0, v2 = 0;
    for (int k = 0; k < 2; k++) {
      v[k] = free * (a * v[k] + b * s->f[2 * i + k]);
      v2 += v[k] * v[k];
    }
    const double slower = v2 > fastest * fastest ? fastest / sqrt(v2) : 1;
    for (int k = 0; k < 2; k++) {
      v[k] *= slower;
      x[k] += dt * v[k];
      r2 += (x[k] - s->x0[2 * i + k]) * (x[k] - s->x0[2 * i + k]);
    }
    far = r2 > far ? r2 : far;
  }
  return far;
}

/* One step with the damping `c`; returns the square of the largest distance from x0. */
static double advance(gh_relax_state *s, double c, double dt) {
  const double a = s->started ? (2 - c * dt) / (2 + c * dt) : 0,
               b = s->started ? 2 * dt / (2 + c * dt) : dt / 2;
  s->started = 1;
  return gh_relax_move(s, a, b, dt);
}

/* Rayleigh quotient of the last displacement dt v with the change of the forces: a running estimate of the
 * lowest eigenvalue that is still moving. */
static double rayleigh(const gh_relax_state *s, const double *old, double dt) {
  double up = 0, down = 0;
#pragma omp simd reduction(+ : up, down)
  for (int k = 0; k < 2 * s->n; k++) {
    up += s->v[k] * (old[k] - s->f[k]);
    down += s->v[k] * s->v[k];
  }
  return gh_relax_quotient(up, dt * down);
}

gh_relax_end gh_relax_run(gh_relax_state *s, double tolerance, double floor, long max_steps, double *residual,
                          double *mean_force, long *steps) {
  double *old = divide(s).old, dt = 0;
  bool far = false, stale = true;
  gh_relax_begin(s);
  for (long k = 0;; k++) {
    double largest = gh_relax_forces(s, mean_force);
    ++*steps;
    *residual = *mean_force > 0 ? largest / *mean_force : 0;
    if (!isfinite(largest)) return *residual = NAN, GH_RELAX_STEPS;
    if (k > 0) {
      double lowest = rayleigh(s, old, dt);
      s->damping = 2 * sqrt(lowest);
      stale = gh_relax_time_step(lowest) < 0.95 * dt; /* above the bound of all eigenvalues: new contacts */
    }
    if (far) return GH_RELAX_REBUILD; /* before anything is concluded: the list may miss contacts */
    if (*mean_force <= floor) return *residual = 0, GH_RELAX_UNJAMMED;
    if (*residual <= tolerance) return GH_RELAX_CONVERGED;
    if (k + 1 >= max_steps) return GH_RELAX_STEPS;
    if (stale || k % BOUND_EVERY == 0) dt = gh_relax_safe_step(s);
    s->damping = fmax(s->damping, LEAST_DAMPING / dt);
    memcpy(old, s->f, 2 * (size_t)s->n * sizeof *old);
    far = advance(s, s->damping, dt) > s->slack * s->slack;
  }
}
