/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Forces with friction on a list of neighbour pairs, and the time step that they allow (dissertation chapter 7). */
#include "contact/coulomb.h"
#include "engine/relax/relax_friction_parts.h"

#include <string.h>

size_t gh_relax_friction_work(int n, int npairs) {
  return (GIVEN + EXERTED) * (size_t)npairs + (11 + PER_BLOCK) * (size_t)n +
         (2 * (size_t)npairs * sizeof(int) + sizeof(double) - 1) / sizeof(double);
}

gh_friction_parts gh_friction_divide(const gh_relax_friction *s) {
  const size_t n = (size_t)s->grains.n, npairs = (size_t)s->grains.npairs;
  gh_friction_parts w = {.given = s->grains.work};
  w.pair = w.given + GIVEN * npairs;
  w.rolled = w.pair + EXERTED * npairs;
  w.couple = w.rolled + n;
  w.old_f = w.couple + n;
  w.old_c = w.old_f + 2 * n;
  w.block = w.old_c + n;
  w.before = w.block + PER_BLOCK * n;
  w.x0 = w.before + n;
  w.crept = w.x0 + 2 * n;
  w.i = (int *)(void *)(w.crept + 3 * n);
  w.j = w.i + npairs;
  return w;
}

void gh_friction_lay_out(const gh_relax_friction *s, const gh_friction_parts *w) {
  const size_t n = (size_t)s->grains.npairs;
  gh_pairs_lay_out(s->grains.pairs, n, w->given, w->i, w->j);
  for (size_t p = 0; p < n; p++) {
    const gh_pair_memory *m = &s->memory[p];
    w->given[LN_X * n + p] = m->ln[0];
    w->given[LN_Y * n + p] = m->ln[1];
    w->given[GAMMA * n + p] = m->gamma;
    w->given[GAMMA_PL * n + p] = m->gamma_pl;
    w->given[ALPHA * n + p] = m->alpha;
  }
}

/* Force, couple and overlap of pair p, without branches so that loops vectorise; inlined for one measure of slip at
 * a time, with and without commit. A grain's own image exerts no net force. */
__attribute__((always_inline)) static inline void
pair_force(size_t p, size_t n, const int *restrict first, const int *restrict second,
           const gh_contact_law *law, bool commits, double *restrict given, const double *restrict x,
           const double *restrict rolled, double *restrict out) {
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
  gh_coulomb_evaluate(law, &s, &r);
  const double e = s.reach - s.d, touch = e >= 0 ? 1 : 0, net = i != j ? touch : 0;
  out[FORCE_X * n + p] = net * r.f[0];
  out[FORCE_Y * n + p] = net * r.f[1];
  out[COUPLE * n + p] = touch * r.couple;
  out[OVERLAP * n + p] = e;
  if (!commits) return;
  out[DISSIPATED * n + p] =
      touch * r.multiplier * law->normal_stiffness * gh_coulomb_coefficient(law, r.alpha) * e;
  given[LN_X * n + p] = lx;
  given[LN_Y * n + p] = ly;
  given[GAMMA * n + p] = touch * r.gamma; /* a contact that opens loses its slip, not its hardening */
  given[GAMMA_PL * n + p] = touch * r.gamma_pl;
  given[ALPHA * n + p] = e >= 0 ? r.alpha : s.alpha;
}

/* One loop for each measure of slip, with and without commit, so that they are constants in it. */
__attribute__((always_inline)) static inline void projected_pairs(const gh_relax_friction *s,
                                                                  const gh_friction_parts *w, bool commits) {
  const size_t n = (size_t)s->grains.npairs;
  const int *const i = w->i, *const j = w->j;
  const double *const x = s->grains.x, *const rolled = w->rolled;
  double *const given = w->given, *const out = w->pair;
  gh_contact_law law = *s->law;
  law.slip = GH_SLIP_PROJECTED;
#pragma omp simd
  for (size_t p = 0; p < n; p++) pair_force(p, n, i, j, &law, commits, given, x, rolled, out);
}
static void projected_forces(const gh_relax_friction *s, const gh_friction_parts *w) {
  projected_pairs(s, w, false);
}
static void projected_commit(const gh_relax_friction *s, const gh_friction_parts *w) {
  projected_pairs(s, w, true);
}

/* Not vectorised: each pair has a call of atan2. */
__attribute__((always_inline)) static inline void objective_pairs(const gh_relax_friction *s,
                                                                  const gh_friction_parts *w, bool commits) {
  const size_t n = (size_t)s->grains.npairs;
  gh_contact_law law = *s->law;
  law.slip = GH_SLIP_OBJECTIVE;
  for (size_t p = 0; p < n; p++)
    pair_force(p, n, w->i, w->j, &law, commits, w->given, s->grains.x, w->rolled, w->pair);
}
static void objective_forces(const gh_relax_friction *s, const gh_friction_parts *w) {
  objective_pairs(s, w, false);
}
static void objective_commit(const gh_relax_friction *s, const gh_friction_parts *w) {
  objective_pairs(s, w, true);
}

static double gather(const gh_relax_friction *s, const gh_friction_parts *w) {
  const gh_relax_state *g = &s->grains;
  const size_t n = (size_t)g->npairs;
  return gh_pairs_gather(g->n, n, w->i, w->j, w->pair, w->pair + COUPLE * n, g->f, w->couple);
}

/* What the pairs do not have themselves. */
static void ramp_commit(gh_relax_friction *s, const gh_friction_parts *w) {
  const size_t n = (size_t)s->grains.npairs;
  for (size_t p = 0; p < n; p++) s->ramp->dissipated += w->pair[DISSIPATED * n + p];
  if (!s->law->fixed_rotations) memcpy(s->theta_n, s->theta, (size_t)s->grains.n * sizeof(double));
}

/* What is dissipated is known on a ramp alone. */
static void frame_weigh(const gh_relax_friction *s, const gh_friction_parts *w) {
  const size_t n = (size_t)s->grains.npairs;
  double *const values[] = {w->pair + FORCE_X * n, w->pair + FORCE_Y * n, w->pair + COUPLE * n,
                            w->pair + DISSIPATED * n};
  gh_frame_weigh(s->grains.frame, n, w->i, w->j, s->ramp ? 4 : 3, values);
}

/* The moment over the radius is the sum of the couples: m = -r sum M. */
double gh_friction_forces(gh_relax_friction *s, const gh_friction_parts *w, double *mean_force) {
  const gh_relax_state *g = &s->grains;
  const bool turns = !s->law->fixed_rotations;
  for (int i = 0; i < g->n; i++) w->rolled[i] = turns ? s->radius[i] * (s->theta[i] - s->theta_n[i]) : 0;
  if (s->law->slip == GH_SLIP_OBJECTIVE) (s->ramp ? objective_commit : objective_forces)(s, w);
  else (s->ramp ? projected_commit : projected_forces)(s, w);
  if (g->frame) frame_weigh(s, w);
  if (s->ramp) ramp_commit(s, w);
  *mean_force = s->law->normal_stiffness * gather(s, w);
  if (g->frame) gh_frame_act(g->frame, g->n, s->radius, g->f, w->couple);
  double largest = 0, all = 0;
  for (int i = 0; i < g->n; i++) {
    const double f2 = g->f[2 * i] * g->f[2 * i] + g->f[2 * i + 1] * g->f[2 * i + 1],
                 c2 = turns ? w->couple[i] * w->couple[i] : 0, free2 = gh_friction_free(s, i) * f2,
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
  const gh_friction_parts w = gh_friction_divide(s);
  gh_friction_lay_out(s, &w);
}

double gh_relax_friction_again(gh_relax_friction *s, double *mean_force) {
  const gh_friction_parts w = gh_friction_divide(s);
  return gh_friction_forces(s, &w, mean_force);
}

double gh_relax_friction_forces(gh_relax_friction *s, double *mean_force) {
  gh_relax_friction_begin(s);
  return gh_relax_friction_again(s, mean_force);
}

/* Stiffness of a contact along and across its branch vector that bounds the quadratic form of its derivative,
 * in the displacement N along and the slip B across. Sticking, the form is E_n N^2 + E_t B^2. Sliding, it is
 * E_n N^2 + b mu E_n N B + (1 - b) E_t B^2 with b = E_t/(E_t + h) <= 1; and mu N B <= mu (a N^2 + B^2/a)/2,
 * here with a = min(1, mu E_n/(2 E_t)), which needs no more than E_t across where mu E_n <= 2 E_t. Without
 * friction and hardening nothing resists slip. Proportional hardening adds to mu, and its h is positive. Parts of
 * the order of overlap over radius are left to the distance of gh_relax_time_step from the limit. */
void gh_relax_friction_bound(const gh_contact_law *law, double mu, double *along, double *across) {
  const double En = law->normal_stiffness, Et = law->tangential_stiffness;
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

/* The largest coefficient of friction of the pairs: those that slide have come to it. */
static double largest_coefficient(const gh_relax_friction *s, const gh_friction_parts *w) {
  const size_t n = (size_t)s->grains.npairs;
  const double En = s->law->normal_stiffness;
  double largest = s->law->friction_coefficient;
  if (!gh_coulomb_is_proportional(s->law)) return largest;
  for (size_t p = 0; p < n; p++) {
    const double fn = En * w->pair[OVERLAP * n + p], now = fabs(w->pair[COUPLE * n + p]);
    largest = fmax(largest, gh_coulomb_coefficient(s->law, w->given[ALPHA * n + p]));
    if (fn > 0) largest = fmax(largest, now / fn);
  }
  return largest;
}

/* A contact's form is along N^2 + across B^2 at most (gh_relax_friction_bound), and N and B are each a part
 * of grain i plus a part of grain j. As (a + b)^2 <= 2 a^2 + 2 b^2, the whole form is at most twice the sum
 * of the forms in which one grain moves alone, which is twice the sum of the grains' own blocks: twice the
 * largest eigenvalue of a block bounds all. For a grain and its own image a = b: that is an equality. Pairs
 * that nearly touch count too: they may touch before the next bound. On a ramp images have moved since the list
 * was made. */
double gh_friction_time_step(const gh_relax_friction *s, const gh_friction_parts *w) {
  const gh_relax_state *g = &s->grains;
  const size_t pairs = (size_t)g->npairs;
  double *block = w->block;
  const double turns = s->law->fixed_rotations ? 0 : 1;
  double along, across;
  gh_relax_friction_bound(s->law, largest_coefficient(s, w), &along, &across);
  memset(block, 0, PER_BLOCK * (size_t)g->n * sizeof *block);
  for (size_t p = 0; p < pairs; p++) {
    const gh_pair *q = &g->pairs[p];
    double n[2] = {g->x[2 * q->j] - g->x[2 * q->i] + w->given[SHIFT_X * pairs + p],
                   g->x[2 * q->j + 1] - g->x[2 * q->i + 1] + w->given[SHIFT_Y * pairs + p]};
    const double d2 = n[0] * n[0] + n[1] * n[1];
    if (d2 > 1.01 * q->reach * q->reach) continue;
    for (int k = 0; k < 2; k++) n[k] /= sqrt(d2);
    const double other = q->i == q->j ? 0 : 1; /* an own image neither approaches nor shifts */
    add_block(block + PER_BLOCK * q->i, other * gh_friction_free(s, q->i), turns, n, 1, along, across);
    add_block(block + PER_BLOCK * q->j, other * gh_friction_free(s, q->j), turns, n, -1, along, across);
  }
  double largest = 2 * fmax(along, (1 + 2 * turns) * across); /* two contacts on one line */
  for (int i = 0; i < g->n; i++) largest = fmax(largest, largest_eigenvalue(block + PER_BLOCK * i));
  return gh_relax_time_step(2 * largest);
}

double gh_relax_friction_safe_step(const gh_relax_friction *s) {
  const gh_friction_parts w = gh_friction_divide(s);
  return gh_friction_time_step(s, &w);
}
