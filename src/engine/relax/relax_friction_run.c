/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dynamic relaxation with friction on a list of neighbour pairs (dissertation 4.4). */
#include "engine/relax/relax_friction_parts.h"

#include <string.h>

enum { BOUND_EVERY = 32 }; /* steps between two bounds of the largest eigenvalue */

/* Least damping, over 1/dt: at first (relax.c states why), and at most. It is doubled where the residual has
 * not come down to half in PATIENCE steps: sliding contacts make the stiffness unsymmetric, and grains may
 * circle, fed by the forces, without that the quotient of Rayleigh sees anything to damp. */
static const double LEAST_DAMPING = 1e-2, MOST_DAMPING = 1, LOWEST_DAMPING = 1e-6;
enum { PATIENCE = 1000 };

/* Grains between contacts that slide the wrong way spin: nothing resists until the slip of one of them has
 * gone back to its limit, and a small moment takes thousands of steps for it. So where the residual has not
 * come down to half in SPIN_PATIENCE steps and is below SPIN_RESIDUAL, those that turned the most since then
 * continue at once to where nothing drives them any more, if that is SPIN_LEAST times as far or farther. */
enum { SPIN_PATIENCE = 200, SPIN_LEAST = 2, SPIN_TRIALS = 60 };
static const double SPIN_RESIDUAL = 1e-3, SPIN_SHARE = 0.5, SPIN_REST = 1e-3;

/* On a ramp grains that hardly touch creep along a chain of others, and damping holds them: they leap as the spinning
 * ones do, if they go at least CREEP_SHARE of the longest way, by CREEP_SLACK of the list's slack at most, and with
 * an eye on the residual. */
static const double CREEP_SHARE = 0.1, CREEP_SLACK = 0.2, CREEP_RISE = 1.5;

/* One step of what may move, with the damping `c`; returns the square of the largest distance from x0. No rim
 * turns as far as the slack at once, as no grain goes (gh_relax_move). */
static double advance(gh_relax_friction *s, const double *couple, double c, double dt) {
  gh_relax_state *g = &s->grains;
  const double a = (2 - c * dt) / (2 + c * dt), b = (g->started ? 2 : 1) * dt / (g->started ? 2 + c * dt : 2),
               fastest = 0.9 * g->slack / dt, far = gh_relax_move(g, a, b, dt);
  for (int i = 0; i < g->n && !s->law->fixed_rotations; i++) { /* m/I = -2 couple/r */
    const double w = s->radius[i] * a * s->w[i] - 2 * b * couple[i],
                 limited = w > fastest ? fastest : (w < -fastest ? -fastest : w);
    s->w[i] = limited / s->radius[i];
    s->theta[i] += dt * s->w[i];
  }
  g->started = 1;
  return far;
}

/* Rayleigh quotient, in the metric of the masses, of the last displacement with the change of the forces: a
 * running estimate of the lowest eigenvalue that is still moving. */
static double rayleigh(const gh_relax_friction *s, const gh_friction_parts *w, double dt) {
  const gh_relax_state *g = &s->grains;
  double up = 0, down = 0;
#pragma omp simd reduction(+ : up, down)
  for (int k = 0; k < 2 * g->n; k++) {
    up += g->v[k] * (w->old_f[k] - g->f[k]);
    down += g->v[k] * g->v[k];
  }
  for (int i = 0; i < g->n && !s->law->fixed_rotations; i++) {
    const double rim = s->radius[i] * s->w[i];
    up += rim * (w->couple[i] - w->old_c[i]);
    down += 0.5 * rim * rim;
  }
  return gh_relax_quotient(up, dt * down);
}

/* Power of the moments of the spinning grains along their way `spun`, over the radius. It falls with the
 * leap, because positions fix the normal forces, and the potential of the rotations is convex then. */
static double spin_power(const gh_relax_friction *s, const gh_friction_parts *w, const double *spun) {
  double power = 0;
  for (int i = 0; i < s->grains.n; i++) power -= w->couple[i] * spun[i];
  return power;
}

/* Turns the spinning grains on by `leap` times their way; the power there. */
static double spin_on(gh_relax_friction *s, const gh_friction_parts *w, const double *spun, double leap,
                      double *mean_force) {
  for (int i = 0; i < s->grains.n; i++) s->theta[i] += leap * spun[i] / s->radius[i];
  gh_friction_forces(s, w, mean_force);
  return spin_power(s, w, spun);
}

/* The way of the grains that spin since `before`, in its place, zero for the others; returns the longest over
 * the grain's radius. Grains that roll on each other go equally far. */
static double find_spins(const gh_relax_friction *s, const gh_friction_parts *w) {
  double longest = 0, turn = 0, *spun = w->before;
  for (int i = 0; i < s->grains.n; i++) {
    spun[i] = w->rolled[i] - spun[i];
    longest = fmax(longest, fabs(spun[i]));
  }
  for (int i = 0; i < s->grains.n; i++) {
    if (fabs(spun[i]) < SPIN_SHARE * longest) spun[i] = 0;
    turn = fmax(turn, fabs(spun[i]) / s->radius[i]);
  }
  return turn;
}

/* From the leap `far`, where the power is none or negative, to where it is `rest` at most; at `near` it is
 * positive. */
static void settle(gh_relax_friction *s, const gh_friction_parts *w, const double *spun, double near,
                   double far, double rest, double *mean_force) {
  double at = far;
  for (int k = 0; k < SPIN_TRIALS; k++) {
    const double middle = 0.5 * (near + far), there = spin_on(s, w, spun, middle - at, mean_force);
    at = middle;
    if (fabs(there) <= rest) return;
    if (there > 0) near = middle;
    else far = middle;
  }
}

/* Leaps of the spinning grains to where the power of their moments ends, a radian at most; none where it ends
 * nearby. */
static void leap(gh_relax_friction *s, const gh_friction_parts *w, double *mean_force) {
  const double turn = find_spins(s, w), *spun = w->before, power = spin_power(s, w, spun);
  double at = 0;
  if (!(power > 0)) return;
  for (double next = SPIN_LEAST; next * turn < 1; next *= 4) {
    const double there = spin_on(s, w, spun, next - at, mean_force);
    if (there > 0) {
      at = next;
      continue;
    }
    if (at > 0) settle(s, w, spun, at, next, SPIN_REST * power, mean_force);
    else spin_on(s, w, spun, -next, mean_force);
    break;
  }
  for (int i = 0; i < s->grains.n && at > 0; i++)
    if (spun[i] != 0) s->w[i] = 0;
}

/* Changes the least damping where the residual does not come down. Slip of an increment flutters, which wants
 * more of it, and a grain that creeps out between its last contacts less: it is raised to the largest, and begins
 * again. On a ramp nothing flutters: it is lowered. */
static void watch(gh_relax_watch *w, double residual, bool ramp) {
  if (w->record == 0) w->record = INFINITY, w->waited = 0, w->least = fmax(w->least, LEAST_DAMPING);
  if (residual <= 0.5 * w->record) {
    w->record = residual, w->waited = 0;
  } else if (++w->waited == PATIENCE && w->patience == 0) {
    w->record = residual, w->waited = 0;
    if (ramp) w->least = w->least > LOWEST_DAMPING ? fmax(w->least / 10, LOWEST_DAMPING) : LEAST_DAMPING;
    else w->least = w->least < MOST_DAMPING ? fmin(2 * w->least, MOST_DAMPING) : LEAST_DAMPING;
  }
}

/* Nothing moves yet (4.41): what the velocities held before is not looked at. */
static void start(gh_relax_friction *s) {
  memset(s->grains.v, 0, 2 * (size_t)s->grains.n * sizeof(double));
  if (!s->law->fixed_rotations) memset(s->w, 0, (size_t)s->grains.n * sizeof(double));
}

/* Where grains are, for creep_on. */
static void creep_note(const gh_relax_friction *s, const gh_friction_parts *w) {
  const size_t n = (size_t)s->grains.n;
  memcpy(w->crept, s->grains.x, 2 * n * sizeof(double));
  memcpy(w->crept + 2 * n, s->theta, n * sizeof(double));
}

/* Those that moved the farthest since creep_note move by a multiple of that path: twice the last one if that did not
 * raise the residual, else an eighth. Slip is committed on the way there, too, and dissipates what that stores. */
static void creep_on(gh_relax_friction *s, const gh_friction_parts *w, double residual) {
  gh_relax_state *g = &s->grains;
  const size_t n = (size_t)g->n;
  double longest = 0;
  for (size_t i = 0; i < n; i++)
    longest = fmax(longest, hypot(g->x[2 * i] - w->crept[2 * i], g->x[2 * i + 1] - w->crept[2 * i + 1]));
  if (!(longest > 0)) return;
  gh_relax_watch *c = &s->watch;
  c->leap = c->leap == 0 ? 1 : residual <= CREEP_RISE * c->leapt ? 2 * c->leap : c->leap / 8;
  c->leapt = residual;
  const double times = fmin(c->leap, CREEP_SLACK * g->slack / longest);
  for (size_t i = 0; i < n; i++) {
    const double d[2] = {g->x[2 * i] - w->crept[2 * i], g->x[2 * i + 1] - w->crept[2 * i + 1]};
    if (hypot(d[0], d[1]) < CREEP_SHARE * longest || (g->held && g->held[i])) continue;
    if (g->frame && g->frame->edges && g->frame->edges[i]) continue; /* it is tied to others */
    g->x[2 * i] += times * d[0], g->x[2 * i + 1] += times * d[1];
    if (!s->law->fixed_rotations) s->theta[i] += times * (s->theta[i] - w->crept[2 * n + i]);
  }
}

/* Raises damping, or turns spinning grains on, where the residual does not come down. True: it ends here. */
static bool stalls(gh_relax_friction *s, const gh_friction_parts *w, long k, double residual,
                   double *mean_force) {
  if (!gh_ramp_is_over(s)) return false;
  watch(&s->watch, residual, s->ramp != NULL);
  if (s->watch.patience > 0 && s->watch.waited >= s->watch.patience) return true;
  if (s->ramp && k % SPIN_PATIENCE == 0) {
    if (k > 0 && s->watch.waited >= SPIN_PATIENCE && residual <= SPIN_RESIDUAL) creep_on(s, w, residual);
    creep_note(s, w);
  }
  if (s->ramp || k % SPIN_PATIENCE != 0 || s->law->fixed_rotations) return false;
  if (k > 0 && s->watch.waited >= SPIN_PATIENCE && residual <= SPIN_RESIDUAL) leap(s, w, mean_force);
  memcpy(w->before, w->rolled, (size_t)s->grains.n * sizeof(double));
  return false;
}

/* One step; true: the list must be made again. */
static bool step(gh_relax_friction *s, const gh_friction_parts *w, const gh_ramp_list *list, double dt) {
  gh_relax_state *g = &s->grains;
  g->damping = fmax(g->damping, s->watch.least / dt);
  memcpy(w->old_f, g->f, 2 * (size_t)g->n * sizeof(double));
  memcpy(w->old_c, w->couple, (size_t)g->n * sizeof(double));
  const double far = advance(s, w->couple, g->damping, dt);
  if (!gh_ramp_is_over(s)) gh_ramp_advance(s, w);
  const double slack = gh_ramp_slack(s, list);
  return slack == 0 || far > slack * slack; /* fixed grains go nowhere: the strain alone ends the list */
}

gh_relax_end gh_relax_friction_run(gh_relax_friction *s, double tolerance, double floor, long max_steps,
                                   double *residual, double *mean_force, long *steps) {
  gh_relax_state *g = &s->grains;
  const gh_friction_parts w = gh_friction_divide(s);
  double dt = 0;
  bool far = false, stale = true;
  gh_friction_lay_out(s, &w);
  const gh_ramp_list list = gh_ramp_begin(s, &w);
  if (!g->started) start(s);
  for (long k = 0;; k++) {
    const double largest = gh_friction_forces(s, &w, mean_force);
    ++*steps;
    *residual = *mean_force > 0 ? largest / *mean_force : 0;
    if (!isfinite(largest)) return *residual = NAN, GH_RELAX_STEPS;
    if (k > 0) {
      const double lowest = rayleigh(s, &w, dt);
      g->damping = 2 * sqrt(lowest);
      stale = gh_relax_time_step(lowest) < 0.95 * dt; /* above the bound of all eigenvalues: new contacts */
    }
    if (far)
      return gh_ramp_end(s, &w, GH_RELAX_REBUILD); /* before anything is concluded: contacts may be missed */
    if (gh_ramp_is_over(s) && *mean_force <= floor)
      return *residual = 0, gh_ramp_end(s, &w, GH_RELAX_UNJAMMED);
    if (gh_ramp_is_over(s) && (*residual <= tolerance || (s->ramp && largest <= s->ramp->round_off)))
      return gh_ramp_end(s, &w, GH_RELAX_CONVERGED);
    if (k + 1 >= max_steps) return gh_ramp_end(s, &w, GH_RELAX_STEPS);
    if (stale || k % BOUND_EVERY == 0) dt = gh_friction_time_step(s, &w);
    if (stalls(s, &w, k, *residual, mean_force)) return gh_ramp_end(s, &w, GH_RELAX_STEPS);
    far = step(s, &w, &list, dt);
  }
}
