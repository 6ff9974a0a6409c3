/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Dynamic relaxation with friction on a list of neighbour pairs (dissertation 4.4, chapter 7). */
#include "engine/relax/relax_friction.h"

#include "contact/coulomb.h"

#include "granhom/base.h"

#include <string.h>

enum { BOUND_EVERY = 32 }; /* steps between two bounds of the largest eigenvalue */

/* Least damping, over 1/dt: at first (relax.c states why), and at most. It is doubled where the residual has
 * not come down to half in PATIENCE steps: sliding contacts make the stiffness unsymmetric, and grains may
 * circle, fed by the forces, without that the quotient of Rayleigh sees anything to damp. */
static const double LEAST_DAMPING = 1e-2, MOST_DAMPING = 1;
enum { PATIENCE = 1000 };

/* Numbers of each pair: what it is and remembers, one array for each, so that loops over pairs vectorise; and
 * what it exerts: force on grain i, couple, overlap. */
enum { SHIFT_X, SHIFT_Y, REACH, LN_X, LN_Y, GAMMA, GAMMA_PL, ALPHA, GIVEN };
enum { FORCE_X, FORCE_Y, COUPLE, OVERLAP, DISSIPATED, EXERTED };
enum { PER_BLOCK = 6 };

/* Grains between contacts that slide the wrong way spin: nothing resists until the slip of one of them has
 * gone back to its limit, and a small moment takes thousands of steps for it. So where the residual has not
 * come down to half in SPIN_PATIENCE steps and is below SPIN_RESIDUAL, those that turned the most since then
 * continue at once to where nothing drives them any more, if that is SPIN_LEAST times as far or farther. */
enum { SPIN_PATIENCE = 200, SPIN_LEAST = 2, SPIN_TRIALS = 60 };
static const double SPIN_RESIDUAL = 1e-3, SPIN_SHARE = 0.5, SPIN_REST = 1e-3;

/* The parts of the work space. */
typedef struct parts {
  double *given;  /* GIVEN x npairs */
  double *pair;   /* EXERTED x npairs */
  double *rolled; /* n: r (theta - theta_n) */
  double *couple; /* n: sum of the couples, -m/r */
  double *old_f;  /* 2 n: forces of the last step */
  double *old_c;  /* n: sums of the couples of the last step */
  double *block;  /* PER_BLOCK n: stiffness of each grain alone */
  double *before; /* n: `rolled` when it was last looked for spins */
  double *x0;     /* 2 n: on a ramp, where the pairs were found, moved along */
  int *i, *j;     /* npairs: grains of each pair */
} parts;

size_t gh_relax_friction_work(int n, int npairs) {
  return (GIVEN + EXERTED) * (size_t)npairs + (8 + PER_BLOCK) * (size_t)n +
         (2 * (size_t)npairs * sizeof(int) + sizeof(double) - 1) / sizeof(double);
}

static parts divide(const gh_relax_friction *s) {
  const size_t n = (size_t)s->grains.n, npairs = (size_t)s->grains.npairs;
  parts w = {.given = s->grains.work};
  w.pair = w.given + GIVEN * npairs;
  w.rolled = w.pair + EXERTED * npairs;
  w.couple = w.rolled + n;
  w.old_f = w.couple + n;
  w.old_c = w.old_f + 2 * n;
  w.block = w.old_c + n;
  w.before = w.block + PER_BLOCK * n;
  w.x0 = w.before + n;
  w.i = (int *)(void *)(w.x0 + 2 * n);
  w.j = w.i + npairs;
  return w;
}

static double is_free(const gh_relax_friction *s, int i) {
  return s->grains.held && s->grains.held[i] ? 0 : 1;
}

/* Lays the pairs and their memory out in the work space. */
static void lay_out(const gh_relax_friction *s, const parts *w) {
  const size_t n = (size_t)s->grains.npairs;
  for (size_t p = 0; p < n; p++) {
    const gh_pair *q = &s->grains.pairs[p];
    const gh_pair_memory *m = &s->memory[p];
    const double all[GIVEN] = {q->shift[0], q->shift[1], q->reach,    m->ln[0],
                               m->ln[1],    m->gamma,    m->gamma_pl, m->alpha};
    for (size_t k = 0; k < GIVEN; k++) w->given[k * n + p] = all[k];
    w->i[p] = q->i, w->j[p] = q->j;
  }
}

/* Forces, couples and overlaps of all pairs, without branches so that it vectorises; inlined for one measure
 * of slip at a time, with and without commit. A grain's own image exerts no net force. */
__attribute__((always_inline)) static inline void
pair_forces(const int *restrict first, const int *restrict second, size_t n, const gh_contact_law law,
            bool commits, double *restrict given, const double *restrict x, const double *restrict rolled,
            double *restrict out) {
#pragma omp simd
  for (size_t p = 0; p < n; p++) {
    const int i = first[p], j = second[p];
    const double lx = x[2 * j] - x[2 * i] + given[SHIFT_X * n + p],
                 ly = x[2 * j + 1] - x[2 * i + 1] + given[SHIFT_Y * n + p];
    const gh_coulomb_step s = {.l = {lx, ly},
                               .d = sqrt(lx * lx + ly * ly),
                               .reach = given[REACH * n + p],
                               .ln = {given[LN_X * n + p], given[LN_Y * n + p]},
                               .q = rolled[i] + rolled[j],
                               .gamma = given[GAMMA * n + p],
                               .gamma_pl = given[GAMMA_PL * n + p],
                               .alpha = given[ALPHA * n + p]};
    gh_coulomb_result r;
    gh_coulomb_evaluate(&law, &s, &r);
    const double e = s.reach - s.d, touch = e >= 0 ? 1 : 0, net = i != j ? touch : 0;
    out[FORCE_X * n + p] = net * r.f[0];
    out[FORCE_Y * n + p] = net * r.f[1];
    out[COUPLE * n + p] = touch * r.couple;
    out[OVERLAP * n + p] = e;
    if (!commits) continue;
    out[DISSIPATED * n + p] = touch * r.multiplier * law.normal_stiffness * law.friction_coefficient * e;
    given[LN_X * n + p] = lx;
    given[LN_Y * n + p] = ly;
    given[GAMMA * n + p] = touch * r.gamma; /* a contact that opens loses its slip, not its hardening */
    given[GAMMA_PL * n + p] = touch * r.gamma_pl;
    given[ALPHA * n + p] = e >= 0 ? r.alpha : s.alpha;
  }
}

/* One loop for each, so that the measure of slip and the commit are constants in it. */
static void projected_forces(const gh_relax_friction *s, const parts *w) {
  gh_contact_law law = *s->law;
  law.slip = GH_SLIP_PROJECTED;
  pair_forces(w->i, w->j, (size_t)s->grains.npairs, law, false, w->given, s->grains.x, w->rolled, w->pair);
}

static void projected_commit(const gh_relax_friction *s, const parts *w) {
  gh_contact_law law = *s->law;
  law.slip = GH_SLIP_PROJECTED;
  pair_forces(w->i, w->j, (size_t)s->grains.npairs, law, true, w->given, s->grains.x, w->rolled, w->pair);
}

static void objective_forces(const gh_relax_friction *s, const parts *w) {
  gh_contact_law law = *s->law;
  law.slip = GH_SLIP_OBJECTIVE;
  pair_forces(w->i, w->j, (size_t)s->grains.npairs, law, false, w->given, s->grains.x, w->rolled, w->pair);
}

static void objective_commit(const gh_relax_friction *s, const parts *w) {
  gh_contact_law law = *s->law;
  law.slip = GH_SLIP_OBJECTIVE;
  pair_forces(w->i, w->j, (size_t)s->grains.npairs, law, true, w->given, s->grains.x, w->rolled, w->pair);
}

/* Adds forces and couples of the pairs to the grains; returns the mean overlap. Pairs are sorted by i: that
 * side is summed in registers. */
static double gather(const gh_relax_friction *s, const double *restrict pair, double *restrict couple) {
  const gh_relax_state *g = &s->grains;
  const size_t n = (size_t)g->npairs;
  double *restrict f = g->f, overlap = 0;
  int contacts = 0;
  memset(f, 0, 2 * (size_t)g->n * sizeof *f);
  memset(couple, 0, (size_t)g->n * sizeof *couple);
  for (size_t p = 0; p < n;) {
    const int i = g->pairs[p].i;
    double fx = 0, fy = 0, m = 0, sum = 0;
    for (; p < n && g->pairs[p].i == i; p++) {
      const int j = g->pairs[p].j;
      const double px = pair[FORCE_X * n + p], py = pair[FORCE_Y * n + p], pm = pair[COUPLE * n + p],
                   e = pair[OVERLAP * n + p];
      fx += px;
      fy += py;
      m += pm;
      sum += e >= 0 ? e : 0;
      contacts += e >= 0;
      f[2 * j] -= px;
      f[2 * j + 1] -= py;
      couple[j] += pm;
    }
    f[2 * i] += fx;
    f[2 * i + 1] += fy;
    couple[i] += m;
    overlap += sum;
  }
  return contacts ? overlap / contacts : 0;
}

/* What the pairs do not have themselves. */
static void ramp_commit(gh_relax_friction *s, const parts *w) {
  const size_t n = (size_t)s->grains.npairs;
  for (size_t p = 0; p < n; p++) s->ramp->dissipated += w->pair[DISSIPATED * n + p];
  if (!s->law->fixed_rotations) memcpy(s->theta_n, s->theta, (size_t)s->grains.n * sizeof(double));
}

/* The moment over the radius is the sum of the couples: m = -r sum M. */
static double forces(gh_relax_friction *s, const parts *w, double *mean_force) {
  const gh_relax_state *g = &s->grains;
  const bool turns = !s->law->fixed_rotations;
  for (int i = 0; i < g->n; i++) w->rolled[i] = turns ? s->radius[i] * (s->theta[i] - s->theta_n[i]) : 0;
  if (s->law->slip == GH_SLIP_OBJECTIVE) (s->ramp ? objective_commit : objective_forces)(s, w);
  else (s->ramp ? projected_commit : projected_forces)(s, w);
  if (s->ramp) ramp_commit(s, w);
  *mean_force = s->law->normal_stiffness * gather(s, w->pair, w->couple);
  double largest = 0, all = 0;
  for (int i = 0; i < g->n; i++) {
    const double f2 = g->f[2 * i] * g->f[2 * i] + g->f[2 * i + 1] * g->f[2 * i + 1],
                 c2 = turns ? w->couple[i] * w->couple[i] : 0, free2 = is_free(s, i) * f2,
                 here = free2 > c2 ? free2 : c2;
    if (turns) s->m[i] = -s->radius[i] * w->couple[i];
    largest = here > largest ? here : largest;
    all += f2 + c2;
  }
  /* the comparison passes over NaN, and squares may have left the range of numbers */
  return all <= GH_RELAX_MOST && largest >= GH_RELAX_LEAST
             ? sqrt(largest)
             : gh_relax_largest(g->n, g->held, g->f, turns ? w->couple : NULL);
}

void gh_relax_friction_begin(gh_relax_friction *s) {
  const parts w = divide(s);
  lay_out(s, &w);
}

double gh_relax_friction_again(gh_relax_friction *s, double *mean_force) {
  const parts w = divide(s);
  return forces(s, &w, mean_force);
}

double gh_relax_friction_forces(gh_relax_friction *s, double *mean_force) {
  gh_relax_friction_begin(s);
  return gh_relax_friction_again(s, mean_force);
}

/* Stiffness of a contact along and across its branch vector that bounds the quadratic form of its derivative,
 * in the displacement N along and the slip B across. Sticking, the form is E_n N^2 + E_t B^2. Sliding, it is
 * E_n N^2 + b mu E_n N B + (1 - b) E_t B^2 with b = E_t/(E_t + h) <= 1; and mu N B <= mu (a N^2 + B^2/a)/2,
 * here with a = min(1, mu E_n/(2 E_t)), which needs no more than E_t across where mu E_n <= 2 E_t. Without
 * friction and hardening nothing resists slip. Parts of the order of overlap over radius are left to the
 * distance of gh_relax_time_step from the limit. */
void gh_relax_friction_bound(const gh_contact_law *law, double *along, double *across) {
  const double En = law->normal_stiffness, Et = law->tangential_stiffness, mu = law->friction_coefficient;
  *along = En * (1 + 0.5 * mu * fmin(1, mu * En / (2 * Et)));
  *across = mu == 0 && law->hardening == 0 ? 0 : fmax(Et, 0.5 * mu * En);
}

/* Largest eigenvalue of a symmetric 3 x 3 matrix xx xy yy xq yq qq: Cardano's formula. */
static double largest_eigenvalue(const double *a) {
  const double mean = (a[0] + a[2] + a[5]) / 3, x = a[0] - mean, y = a[2] - mean, q = a[5] - mean,
               off = a[1] * a[1] + a[3] * a[3] + a[4] * a[4],
               spread = sqrt((x * x + y * y + q * q + 2 * off) / 6),
               det = x * (y * q - a[4] * a[4]) - a[1] * (a[1] * q - a[4] * a[3]) +
                     a[3] * (a[1] * a[4] - y * a[3]);
  if (!(spread > 0)) return mean;
  const double r = det / (2 * spread * spread * spread);
  if (!isfinite(r)) return mean + 2 * spread; /* a cube has left the range of numbers: the largest possible */
  return mean + 2 * spread * cos(acos(fmin(1, fmax(-1, r))) / 3);
}

/* Adds the contact to the block of grain i: its stiffness in the displacement of i and in r theta / sqrt(2),
 * in which the mass matrix is the identity. The slip is t.(u_i - u_j) + |l|/(r_i + r_j) (r_i theta_i +
 * r_j theta_j): the last factor is near 1. */
static void add_block(double *k, double free, double turns, const double n[2], double side, double along,
                      double across) {
  const double t[2] = {-free * side * n[1], free * side * n[0]}, turn = turns * sqrt(2);
  k[0] += free * along * n[0] * n[0] + across * t[0] * t[0];
  k[1] += free * along * n[0] * n[1] + across * t[0] * t[1];
  k[2] += free * along * n[1] * n[1] + across * t[1] * t[1];
  k[3] += across * t[0] * turn;
  k[4] += across * t[1] * turn;
  k[5] += across * turn * turn;
}

/* A contact's form is along N^2 + across B^2 at most (gh_relax_friction_bound), and N and B are each a part
 * of grain i plus a part of grain j. As (a + b)^2 <= 2 a^2 + 2 b^2, the whole form is at most twice the sum
 * of the forms in which one grain moves alone, which is twice the sum of the grains' own blocks: twice the
 * largest eigenvalue of a block bounds all. For a grain and its own image a = b: that is an equality. Pairs
 * that nearly touch count too: they may touch before the next bound. On a ramp images have moved since the list
 * was made. */
static double time_step(const gh_relax_friction *s, const parts *w) {
  const gh_relax_state *g = &s->grains;
  const size_t pairs = (size_t)g->npairs;
  double *block = w->block;
  const double turns = s->law->fixed_rotations ? 0 : 1;
  double along, across;
  gh_relax_friction_bound(s->law, &along, &across);
  memset(block, 0, PER_BLOCK * (size_t)g->n * sizeof *block);
  for (size_t p = 0; p < pairs; p++) {
    const gh_pair *q = &g->pairs[p];
    double n[2] = {g->x[2 * q->j] - g->x[2 * q->i] + w->given[SHIFT_X * pairs + p],
                   g->x[2 * q->j + 1] - g->x[2 * q->i + 1] + w->given[SHIFT_Y * pairs + p]};
    const double d2 = n[0] * n[0] + n[1] * n[1];
    if (d2 > 1.01 * q->reach * q->reach) continue;
    for (int k = 0; k < 2; k++) n[k] /= sqrt(d2);
    const double other = q->i == q->j ? 0 : 1; /* an own image neither approaches nor shifts */
    add_block(block + PER_BLOCK * q->i, other * is_free(s, q->i), turns, n, 1, along, across);
    add_block(block + PER_BLOCK * q->j, other * is_free(s, q->j), turns, n, -1, along, across);
  }
  double largest = 2 * fmax(along, (1 + 2 * turns) * across); /* two contacts on one line */
  for (int i = 0; i < g->n; i++) largest = fmax(largest, largest_eigenvalue(block + PER_BLOCK * i));
  return gh_relax_time_step(2 * largest);
}

double gh_relax_friction_safe_step(const gh_relax_friction *s) {
  const parts w = divide(s);
  return time_step(s, &w);
}

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
static double rayleigh(const gh_relax_friction *s, const parts *w, double dt) {
  const gh_relax_state *g = &s->grains;
  double up = 0, down = 0;
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
static double spin_power(const gh_relax_friction *s, const parts *w, const double *spun) {
  double power = 0;
  for (int i = 0; i < s->grains.n; i++) power -= w->couple[i] * spun[i];
  return power;
}

/* Turns the spinning grains on by `leap` times their way; the power there. */
static double spin_on(gh_relax_friction *s, const parts *w, const double *spun, double leap,
                      double *mean_force) {
  for (int i = 0; i < s->grains.n; i++) s->theta[i] += leap * spun[i] / s->radius[i];
  forces(s, w, mean_force);
  return spin_power(s, w, spun);
}

/* The way of the grains that spin since `before`, in its place, zero for the others; returns the longest over
 * the grain's radius. Grains that roll on each other go equally far. */
static double find_spins(const gh_relax_friction *s, const parts *w) {
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
static void settle(gh_relax_friction *s, const parts *w, const double *spun, double near, double far,
                   double rest, double *mean_force) {
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
static void leap(gh_relax_friction *s, const parts *w, double *mean_force) {
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

/* Raises the least damping where the residual does not come down; from the largest back to the first, because
 * what flutters wants more of it, and a grain that creeps out between its last contacts less. */
static void watch(gh_relax_watch *w, double residual) {
  if (w->record == 0) w->record = INFINITY, w->waited = 0, w->least = fmax(w->least, LEAST_DAMPING);
  if (residual <= 0.5 * w->record) {
    w->record = residual, w->waited = 0;
  } else if (++w->waited == PATIENCE && w->patience == 0) {
    w->record = residual, w->waited = 0;
    w->least = w->least < MOST_DAMPING ? fmin(2 * w->least, MOST_DAMPING) : LEAST_DAMPING;
  }
}

/* Nothing moves yet (4.41): what the velocities held before is not looked at. */
static void start(gh_relax_friction *s) {
  memset(s->grains.v, 0, 2 * (size_t)s->grains.n * sizeof(double));
  if (!s->law->fixed_rotations) memset(s->w, 0, (size_t)s->grains.n * sizeof(double));
}

/* ---- ramps ---- */

void gh_relax_ramp_gradient(const gh_relax_ramp *ramp, double G[4]) {
  const double share = ramp->steps > 0 ? (double)ramp->done / (double)ramp->steps : 1;
  for (int k = 0; k < 4; k++) {
    const double one = k == 0 || k == 3 ? 1 : 0;
    G[k] = ramp->done < ramp->steps ? one + share * (ramp->to[k] - one) : ramp->to[k];
  }
}

static bool ramp_is_over(const gh_relax_friction *s) {
  return !s->ramp || s->ramp->done >= s->ramp->steps;
}

/* The list is made for positions, and images, that the ramp leaves: `reach` is that of the largest grains, whose
 * pair need not be on it. */
typedef struct ramp_list {
  double from[4], reach;
} ramp_list;

static ramp_list ramp_begin(gh_relax_friction *s, const parts *w) {
  gh_relax_state *g = &s->grains;
  ramp_list list = {.reach = 0};
  if (!s->ramp) return list;
  for (int i = 0; i < g->n; i++) list.reach = fmax(list.reach, 2 * s->radius[i]);
  gh_relax_ramp_gradient(s->ramp, list.from);
  memcpy(w->x0, g->x0, 2 * (size_t)g->n * sizeof(double));
  g->x0 = w->x0;
  return list;
}

/* The next part: all positions and images follow, and grains rotate with the body. */
static void ramp_advance(gh_relax_friction *s, const parts *w) {
  gh_relax_state *g = &s->grains;
  const size_t n = (size_t)g->npairs;
  double before[4], after[4], inverse[4], D[4];
  gh_relax_ramp_gradient(s->ramp, before);
  s->ramp->done++;
  gh_relax_ramp_gradient(s->ramp, after);
  gh_inv2(before, inverse);
  gh_mul2(after, inverse, D);
  for (int i = 0; i < g->n; i++) {
    gh_apply2(D, g->x + 2 * i, g->x + 2 * i);
    gh_apply2(D, w->x0 + 2 * i, w->x0 + 2 * i);
  }
  for (size_t p = 0; p < n; p++) {
    const double shift[2] = {w->given[SHIFT_X * n + p], w->given[SHIFT_Y * n + p]};
    w->given[SHIFT_X * n + p] = D[0] * shift[0] + D[1] * shift[1];
    w->given[SHIFT_Y * n + p] = D[2] * shift[0] + D[3] * shift[1];
  }
  const double turn = atan2(D[2] - D[1], D[0] + D[3]);
  for (int i = 0; i < g->n && !s->law->fixed_rotations; i++) s->theta[i] += turn;
}

/* How far a grain may be from where the list was made: pairs beyond reach and skin come nearer by the strain
 * since then, too. */
static double ramp_slack(const gh_relax_friction *s, const ramp_list *list) {
  const double slack = s->grains.slack;
  double now[4], inverse[4], D[4], strain = 0;
  if (!s->ramp) return slack;
  gh_relax_ramp_gradient(s->ramp, now);
  gh_inv2(list->from, inverse);
  gh_mul2(now, inverse, D);
  const double turn = atan2(D[2] - D[1], D[0] + D[3]), c = cos(turn), si = sin(turn);
  const double out[4] = {D[0] - c, D[1] + si, D[2] - si, D[3] - c};
  for (int k = 0; k < 4; k++) strain += out[k] * out[k];
  return fmax(0, slack - 0.5 * sqrt(strain) * (list->reach + 2 * slack));
}

/* What was committed, into the memory of the pairs. */
static gh_relax_end ramp_end(gh_relax_friction *s, const parts *w, gh_relax_end end) {
  const size_t n = (size_t)s->grains.npairs;
  for (size_t p = 0; s->ramp && p < n; p++)
    s->memory[p] = (gh_pair_memory){.ln = {w->given[LN_X * n + p], w->given[LN_Y * n + p]},
                                    .gamma = w->given[GAMMA * n + p],
                                    .gamma_pl = w->given[GAMMA_PL * n + p],
                                    .alpha = w->given[ALPHA * n + p]};
  return end;
}

/* ---- the relaxation ---- */

/* Raises damping, or turns spinning grains on, where the residual does not come down. True: it ends here. */
static bool stalls(gh_relax_friction *s, const parts *w, long k, double residual, double *mean_force) {
  if (!ramp_is_over(s)) return false;
  watch(&s->watch, residual);
  if (s->watch.patience > 0 && s->watch.waited >= s->watch.patience) return true;
  if (s->ramp || k % SPIN_PATIENCE != 0 || s->law->fixed_rotations) return false;
  if (k > 0 && s->watch.waited >= SPIN_PATIENCE && residual <= SPIN_RESIDUAL) leap(s, w, mean_force);
  memcpy(w->before, w->rolled, (size_t)s->grains.n * sizeof(double));
  return false;
}

/* One step; true: the list must be made again. */
static bool step(gh_relax_friction *s, const parts *w, const ramp_list *list, double dt) {
  gh_relax_state *g = &s->grains;
  g->damping = fmax(g->damping, s->watch.least / dt);
  memcpy(w->old_f, g->f, 2 * (size_t)g->n * sizeof(double));
  memcpy(w->old_c, w->couple, (size_t)g->n * sizeof(double));
  const double far = advance(s, w->couple, g->damping, dt);
  if (!ramp_is_over(s)) ramp_advance(s, w);
  const double slack = ramp_slack(s, list);
  return slack == 0 || far > slack * slack; /* fixed grains go nowhere: the strain alone ends the list */
}

gh_relax_end gh_relax_friction_run(gh_relax_friction *s, double tolerance, double floor, long max_steps,
                                   double *residual, double *mean_force, long *steps) {
  gh_relax_state *g = &s->grains;
  const parts w = divide(s);
  double dt = 0;
  bool far = false, stale = true;
  lay_out(s, &w);
  const ramp_list list = ramp_begin(s, &w);
  if (!g->started) start(s);
  for (long k = 0;; k++) {
    const double largest = forces(s, &w, mean_force);
    ++*steps;
    *residual = *mean_force > 0 ? largest / *mean_force : 0;
    if (!isfinite(largest)) return *residual = NAN, GH_RELAX_STEPS;
    if (k > 0) {
      const double lowest = rayleigh(s, &w, dt);
      g->damping = 2 * sqrt(lowest);
      stale = gh_relax_time_step(lowest) < 0.95 * dt; /* above the bound of all eigenvalues: new contacts */
    }
    if (far)
      return ramp_end(s, &w, GH_RELAX_REBUILD); /* before anything is concluded: contacts may be missed */
    if (ramp_is_over(s) && *mean_force <= floor) return *residual = 0, ramp_end(s, &w, GH_RELAX_UNJAMMED);
    if (ramp_is_over(s) && *residual <= tolerance) return ramp_end(s, &w, GH_RELAX_CONVERGED);
    if (k + 1 >= max_steps) return ramp_end(s, &w, GH_RELAX_STEPS);
    if (stale || k % BOUND_EVERY == 0) dt = time_step(s, &w);
    if (stalls(s, &w, k, *residual, mean_force)) return ramp_end(s, &w, GH_RELAX_STEPS);
    far = step(s, &w, &list, dt);
  }
}
