/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Servo-control of a frame (docs/explanation/frames.md): its grains are fixed, and moved along what is unbalanced
 * between sweeps of the relaxation of all others.
 *
 * That is a fixed-point iteration on the stiffness S of the frame, condensed onto its grains: it converges if the gain
 * times the largest eigenvalue of S is below 2. Where it ends the frame counts as free: its tangent is that of the
 * condition itself. */
#include "micro/internal.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_SWEEPS = 20000, DEPTH = GH_SERVO_DEPTH };

/* Moments have twice the gain of forces, as in the paper: g_m R^2 = 2 g_a. */
static const double turn_gain = 2;
/* Times the least residual so far: sweeps diverge. */
static const double divergence = 1e3;

struct gh_servo {
  gh_solver *other; /* of the free frame while it is held, and the other way round; NULL: one serves both */
  unsigned char *fixed; /* of the frame while it is held */
  bool moves, is_free;
  int n, *grain;                      /* corrections: three numbers (u, r theta) of each of n / 3 grains */
  double *out, *last, *step;          /* n: what is unbalanced, in this sweep and the last; the correction */
  double *dout[DEPTH], *dstep[DEPTH]; /* n: their differences from sweep to sweep, the latest last */
};

void gh_servo_destroy(gh_servo **to) {
  gh_servo *s = *to;
  if (!s) return;
  gh_solver_destroy(&s->other);
  void *const arrays[] = {s->fixed, s->grain, s->out, s->last, s->step};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  for (int k = 0; k < DEPTH; k++) {
    free(s->dout[k]);
    free(s->dstep[k]);
  }
  free(s);
  *to = NULL;
}

gh_status gh_servo_create(gh_rve *r) {
  const gh_rve_frame *f = r->frame;
  gh_servo *s;
  GH_TRY(gh_alloc(r->ctx, 1, sizeof *s, &s));
  r->servo = s;
  s->moves = gh_condition_of(&r->options).edges[0] != GH_EDGES_DISPLACEMENT;
  GH_TRY(gh_alloc(r->ctx, (size_t)r->n, 1, &s->fixed));
  memcpy(s->fixed, f->fixed, (size_t)r->n);
  GH_TRY(gh_alloc(r->ctx, (size_t)r->n, sizeof(int), &s->grain));
  for (int i = 0; i < r->n; i++)
    if (f->on[i]) s->grain[s->n++] = i;
  s->n *= 3;
  double **const arrays[] = {&s->out, &s->last, &s->step};
  for (int k = 0; k < 3; k++) GH_TRY(gh_alloc(r->ctx, (size_t)s->n, sizeof(double), arrays[k]));
  for (int k = 0; k < r->options.servo_acceleration; k++) {
    GH_TRY(gh_alloc(r->ctx, (size_t)s->n, sizeof(double), &s->dout[k]));
    GH_TRY(gh_alloc(r->ctx, (size_t)s->n, sizeof(double), &s->dstep[k]));
  }
  if (!gh_frame_is_open(f)) return GH_OK;
  return gh_solver_frame(r->ctx, r->n, !gh_rve_friction(r), f, &s->other);
}

/* Between sweeps and what follows them. */
static void servo_turn(gh_rve *r, bool free_frame) {
  gh_servo *s = r->servo;
  if (!s || !s->moves || s->is_free == free_frame) return;
  s->is_free = free_frame;
  r->held = free_frame ? NULL : r->frame->held;
  r->pinned = free_frame && !gh_frame_is_open(r->frame);
  for (int i = 0; i < r->n; i++) r->frame->fixed[i] = free_frame ? 0 : s->fixed[i];
  if (!s->other) return;
  gh_solver *swap = s->other;
  s->other = r->solver;
  r->solver = swap;
}

void gh_servo_hold(gh_rve *r) {
  servo_turn(r, false);
}

/* ---- sweeps ---- */

/* Forces and couples that are to vanish, over the mean normal contact force; returns their norm. */
static double unbalance_find(gh_rve *r) {
  gh_servo *s = r->servo;
  const bool open = gh_frame_is_open(r->frame);
  const double *force = open ? r->frame->balance : r->list.force, scale = 1 / r->m.mean_force;
  double sum = 0;
  for (int k = 0; k < s->n; k += 3) {
    const int i = s->grain[k / 3];
    const bool corner = !open && i == r->frame->corner; /* it follows F, and only rotates */
    for (int h = 0; h < 2; h++) s->out[k + h] = corner ? 0 : scale * force[2 * i + h];
    s->out[k + 2] = r->turns ? scale * r->list.moment[i] / r->radius[i] : 0;
    for (int h = 0; h < 3; h++) sum += s->out[k + h] * s->out[k + h];
  }
  return sqrt(sum);
}

/* Displacement per what is unbalanced, of the correction with this number. */
static double gain_of(const gh_rve *r, int k) {
  const double gain = r->options.servo_gain * r->m.mean_force / r->options.law.normal_stiffness;
  return gain * (k % 3 == 2 ? turn_gain : 1);
}

/* s->step = gain times out. */
static void step_plain(gh_rve *r) {
  gh_servo *s = r->servo;
  for (int k = 0; k < s->n; k++) s->step[k] = gain_of(r, k) * s->out[k];
}

static double product(const double *a, const double *b, int n) {
  double sum = 0;
  for (int k = 0; k < n; k++) sum += a[k] * b[k];
  return sum;
}

/* Anderson: less the combination of the last sweeps that brings `out` nearest to none. dout holds m differences, made
 * orthogonal by Gram-Schmidt, their steps along with them. */
static void step_accelerate(gh_rve *r, int m) {
  gh_servo *s = r->servo;
  for (int a = 0; a < m; a++) {
    const double size = product(s->dout[a], s->dout[a], s->n);
    if (!(size > 0)) continue;
    const double share = product(s->dout[a], s->out, s->n) / size;
    for (int k = 0; k < s->n; k++) s->step[k] -= share * (s->dstep[a][k] + gain_of(r, k) * s->dout[a][k]);
  }
}

/* The difference to the sweep before comes last. It is made orthogonal to the others, which are so among themselves;
 * where there is no room for it the first one goes. */
static void history_add(gh_servo *s, int *m, int depth) {
  if (*m == depth) {
    double *const out = s->dout[0], *const step = s->dstep[0];
    memmove(s->dout, s->dout + 1, (size_t)(depth - 1) * sizeof *s->dout);
    memmove(s->dstep, s->dstep + 1, (size_t)(depth - 1) * sizeof *s->dstep);
    s->dout[depth - 1] = out, s->dstep[depth - 1] = step;
    --*m;
  }
  double *out = s->dout[*m], *step = s->dstep[*m];
  for (int k = 0; k < s->n; k++) out[k] = s->out[k] - s->last[k], step[k] = s->step[k];
  for (int a = 0; a < *m; a++) {
    const double size = product(s->dout[a], s->dout[a], s->n), share = product(s->dout[a], out, s->n);
    for (int k = 0; k < s->n && size > 0; k++) {
      out[k] -= share / size * s->dout[a][k];
      step[k] -= share / size * s->dstep[a][k];
    }
  }
  ++*m;
}

static void frame_move(gh_rve *r) {
  const gh_servo *s = r->servo;
  for (int k = 0; k < s->n; k += 3) {
    const int i = s->grain[k / 3];
    for (int h = 0; h < 2; h++) r->x[2 * i + h] += s->step[k + h];
    if (r->turns) r->theta[i] += s->step[k + 2] / r->radius[i];
  }
}

static gh_status servo_diverged(gh_rve *r, double size) {
  return gh_fail(
      r->ctx, GH_DIVERGED,
      "servo-control does not converge after %d sweeps at F = [%.6g %.6g; %.6g %.6g]: %.3g is unbalanced, "
      "required %.3g; a smaller gain than %g (servo-gain), or servo-acceleration, may",
      r->m.sweeps, r->F[0], r->F[1], r->F[2], r->F[3], size, r->options.servo_tolerance,
      r->options.servo_gain);
}

gh_status gh_servo_equilibrate(gh_rve *r, const gh_start *b) {
  gh_servo *s = r->servo;
  const int depth = r->options.servo_acceleration;
  double least = INFINITY;
  int m = 0;
  for (;;) {
    GH_TRY(gh_rve_equilibrate(r, r->m.sweeps ? NULL : b));
    r->m.sweeps++;
    if (!s->moves || r->m.unjammed) break;
    const double size = unbalance_find(r);
    if (!(size <= divergence * least) || r->m.sweeps >= MOST_SWEEPS) return servo_diverged(r, size);
    least = fmin(least, size);
    if (size <= r->options.servo_tolerance) {
      r->m.residual = gh_max(r->m.residual, size);
      break;
    }
    if (depth > 0 && r->m.sweeps > 1) history_add(s, &m, depth);
    step_plain(r);
    if (depth > 0) step_accelerate(r, m);
    memcpy(s->last, s->out, (size_t)s->n * sizeof(double));
    frame_move(r);
  }
  servo_turn(r, true);
  return GH_OK;
}
