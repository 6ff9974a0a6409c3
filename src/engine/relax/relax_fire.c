/* SPDX-License-Identifier: GPL-2.0-or-later */
/* FIRE, without and with friction.
 *
 * One loop for both: s->friction is NULL without friction. Steps are semi-implicit Euler's (velocities, then
 * positions), which J. Guénolé et al., Comput. Mater. Sci. 175, 109584 (2020) found to suit FIRE best. */
#include "engine/relax/relax_fire.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { BOUND_EVERY = 32 }; /* steps between two bounds of the largest eigenvalue */

/* The parameters of Bitzek et al. They advise a largest step of about ten times that of a careful simulation:
 * here the largest is what is stable, and the first a tenth of it. */
static const double FIRST_STEP = 0.1, GROW = 1.1, SHRINK = 0.5, FIRST_MIX = 0.1, MIX_LESS = 0.99;
enum { DELAY = 5 };

typedef struct problem {
  gh_relax_state *grains;
  gh_relax_friction *friction; /* `grains` are its own; NULL: frictionless */
  bool turns;
} problem;

/* Sums over all that may move, in the metric of the masses. */
typedef struct sums {
  double vf, vv, ff;
} sums;

static double is_free(const gh_relax_state *g, int i) {
  return g->held && g->held[i] ? 0 : 1;
}

static double evaluate(const problem *p, double *mean_force) {
  return p->friction ? gh_relax_friction_again(p->friction, mean_force)
                     : gh_relax_forces(p->grains, mean_force);
}

static double safe_step(const problem *p) {
  return p->friction ? gh_relax_friction_safe_step(p->friction) : gh_relax_safe_step(p->grains);
}

/* Nothing moves yet: what the velocities held before is not looked at. */
static void start(const problem *p) {
  gh_relax_state *g = p->grains;
  memset(g->v, 0, 2 * (size_t)g->n * sizeof *g->v);
  if (p->turns) memset(p->friction->w, 0, (size_t)g->n * sizeof(double));
  g->fire = (gh_fire){.step = FIRST_STEP, .mix = FIRST_MIX};
  g->started = 1;
}

/* Inertia is r^2/2: rotations have the velocity r w/sqrt(2) and the force sqrt(2) m/r. */
static sums add_up(const problem *p) {
  const gh_relax_state *g = p->grains;
  sums t = {0};
  for (int i = 0; i < g->n; i++) {
    const double free = is_free(g, i), *v = g->v + 2 * i, *f = g->f + 2 * i;
    t.vf += free * (v[0] * f[0] + v[1] * f[1]);
    t.vv += free * (v[0] * v[0] + v[1] * v[1]);
    t.ff += free * (f[0] * f[0] + f[1] * f[1]);
  }
  for (int i = 0; p->turns && i < g->n; i++) {
    const double r = p->friction->radius[i], w = p->friction->w[i], m = p->friction->m[i];
    t.vf += w * m;
    t.vv += 0.5 * r * r * w * w;
    t.ff += 2 * m * m / (r * r);
  }
  return t;
}

/* Step and mixing from the power; false: what moves goes uphill and has to stop. */
static bool steer(gh_fire *fire, const sums *t) {
  if (t->vf > 0 || t->vv == 0) {
    if (t->vf > 0 && ++fire->downhill > DELAY) {
      fire->step = fmin(GROW * fire->step, 1);
      fire->mix *= MIX_LESS;
    }
    return true;
  }
  *fire = (gh_fire){.step = SHRINK * fire->step, .mix = FIRST_MIX};
  return false;
}

/* v <- (1 - mix) (v + dt f) + mix |v + dt f| f/|f|, with the norm from the sums: a v + b f. */
static void factors(const sums *t, bool downhill, double mix, double dt, double *a, double *b) {
  const double vf = downhill ? t->vf : 0, vv = downhill ? t->vv : 0,
               speed = sqrt(fmax(vv + 2 * dt * vf + dt * dt * t->ff, 0));
  *a = downhill ? 1 - mix : 0;
  *b = (1 - mix) * dt + (t->ff > 0 ? mix * speed / sqrt(t->ff) : 0);
}

static void turn(gh_relax_friction *s, double a, double b, double dt) {
  const double fastest = 0.9 * s->grains.slack / dt;
  for (int i = 0; i < s->grains.n; i++) {
    const double r = s->radius[i], rim = a * r * s->w[i] + 2 * b * s->m[i] / r;
    s->w[i] = fmin(fmax(rim, -fastest), fastest) / r;
    s->theta[i] += dt * s->w[i];
  }
}

static bool step(const problem *p, double safe) {
  gh_relax_state *g = p->grains;
  const sums t = add_up(p);
  const bool downhill = steer(&g->fire, &t);
  const double dt = g->fire.step * safe;
  double a, b;
  factors(&t, downhill, g->fire.mix, dt, &a, &b);
  if (p->turns) turn(p->friction, a, b, dt);
  return gh_relax_move(g, a, b, dt) > g->slack * g->slack;
}

static gh_relax_end run(const problem *p, double tolerance, double floor, long max_steps, double *residual,
                        double *mean_force, long *steps) {
  double safe = 0;
  bool far = false;
  if (!p->grains->started) start(p);
  for (long k = 0;; k++) {
    const double largest = evaluate(p, mean_force);
    ++*steps;
    *residual = *mean_force > 0 ? largest / *mean_force : 0;
    if (!isfinite(largest)) return *residual = NAN, GH_RELAX_STEPS;
    if (far) return GH_RELAX_REBUILD; /* before anything is concluded: the list may miss contacts */
    if (*mean_force <= floor) return *residual = 0, GH_RELAX_UNJAMMED;
    if (*residual <= tolerance) return GH_RELAX_CONVERGED;
    if (k + 1 >= max_steps) return GH_RELAX_STEPS;
    if (k % BOUND_EVERY == 0) safe = safe_step(p);
    far = step(p, safe);
  }
}

gh_relax_end gh_relax_fire(gh_relax_state *s, double tolerance, double floor, long max_steps,
                           double *residual, double *mean_force, long *steps) {
  gh_relax_begin(s);
  return run(&(problem){.grains = s}, tolerance, floor, max_steps, residual, mean_force, steps);
}

gh_relax_end gh_relax_friction_fire(gh_relax_friction *s, double tolerance, double floor, long max_steps,
                                    double *residual, double *mean_force, long *steps) {
  const problem p = {.grains = &s->grains, .friction = s, .turns = !s->law->fixed_rotations};
  gh_relax_friction_begin(s);
  return run(&p, tolerance, floor, max_steps, residual, mean_force, steps);
}
