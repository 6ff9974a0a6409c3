/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Work, energy and residuals of all converged substeps (docs/explanation/method.md, "Error estimates").
 *
 * All sums go over the integration points or the degrees of freedom in their order, so that they do not
 * depend on ranks. */
#include "macro/internal.h"

/* int P : dF dV0 from m->eq to m->now by the trapezoidal rule. */
double gh_internal_work(const gh_macro *m) {
  double sum = 0;
  for (int p = 0; p < m->npoints; p++) {
    const double *F0 = m->eq.F + 4 * (size_t)p, *F1 = m->now.F + 4 * (size_t)p, *P0 = m->eq.P + 4 * (size_t)p,
                 *P1 = m->now.P + 4 * (size_t)p;
    double density = 0;
    for (int k = 0; k < 4; k++) density += 0.5 * (P0[k] + P1[k]) * (F1[k] - F0[k]);
    sum += m->shapes.weight[p] * density;
  }
  return sum;
}

/* Of the loads, of what fades and of the supports on the displacements between the two. What acts on the
 * nodes of a footing besides it acts on the body. */
static double external_work(gh_macro *m, const gh_attempt *a, double t0) {
  const bool fade = !a->released;
  double sum = gh_footings_work(m, a->to, t0, a->t, fade);
  gh_external_forces(m, a->to, t0, fade, m->eq.u, m->fext);
  gh_external_forces(m, a->to, a->t, fade, m->now.u, m->trial);
  for (int d = 0; d < m->ndof; d++) {
    double twice = a->to->fixed[d] ? m->eq.fint[d] + m->now.fint[d] : m->fext[d] + m->trial[d];
    sum += 0.5 * twice * (m->now.u[d] - m->eq.u[d]);
  }
  return sum;
}

/* What the packings of the last evaluation hold and have dissipated. */
static void tally_update_energy(gh_macro *m) {
  gh_tally *w = &m->tally;
  w->energy = w->dissipation = 0;
  for (int p = 0; p < m->npoints; p++) {
    const gh_rve_measures *q = gh_farm_measure(m->farm, p);
    w->energy += q ? m->shapes.weight[p] * q->energy : NAN;
    w->dissipation += q ? m->shapes.weight[p] * q->dissipation : NAN;
    if (q) w->micro_residual = gh_max(w->micro_residual, q->residual);
  }
}

void gh_energy_begin(gh_macro *m) {
  tally_update_energy(m);
  gh_macro_zero_energy(m);
}

void gh_energy_count(gh_macro *m, const gh_attempt *a, double t0, bool evaluated, bool balanced) {
  gh_tally *w = &m->tally;
  double inner = gh_internal_work(m), outer = external_work(m, a, t0);
  w->inner += inner;
  w->outer += outer;
  if (!balanced) w->freed += outer - inner;
  if (evaluated) tally_update_energy(m);
  double held = w->energy - w->energy0 + w->dissipation - w->dissipation0;
  w->largest = gh_max(w->largest, fabs(w->inner));
  if (!isnan(held)) w->largest = gh_max(w->largest, fabs(held)); /* only RVEs report their energy */
}

void gh_energy_residual(gh_macro *m, double relative) {
  m->tally.residual = gh_max(m->tally.residual, relative);
}

void gh_macro_zero_energy(gh_macro *m) {
  gh_tally *w = &m->tally;
  w->inner = w->outer = w->freed = w->largest = 0;
  w->energy0 = w->energy;
  w->dissipation0 = w->dissipation;
}

static double work_find_scale(const gh_macro *m) {
  double sum = 0;
  for (int p = 0; p < m->npoints; p++) {
    const double *F = m->eq.F + 4 * (size_t)p, *P = m->eq.P + 4 * (size_t)p;
    double FF = 0, PP = 0;
    for (int k = 0; k < 4; k++) FF += F[k] * F[k], PP += P[k] * P[k];
    sum += m->shapes.weight[p] * sqrt(FF * PP);
  }
  return sum;
}

void gh_macro_energy(const gh_macro *m, gh_energy *e) {
  const gh_tally *w = &m->tally;
  *e = (gh_energy){.inner_work = w->inner,
                   .outer_work = w->outer,
                   .freed = w->freed,
                   .energy = w->energy - w->energy0,
                   .dissipation = w->dissipation - w->dissipation0,
                   .largest = w->largest,
                   .scale = work_find_scale(m),
                   .residual = w->residual,
                   .micro_residual = w->micro_residual};
}

/* Where there is no energy to compare with, what is missing is all there is. */
static double imbalance_relative(const gh_energy *e, double part) {
  const double whole = e->largest;
  if (part == 0 || whole <= 1e-12 * e->scale) return 0;
  return whole == 0 && isfinite(part) ? copysign(1, part) : part / whole;
}

double gh_energy_defect(const gh_energy *e) {
  return imbalance_relative(e, e->inner_work - e->energy - e->dissipation);
}

double gh_work_defect(const gh_energy *e) {
  return imbalance_relative(e, e->outer_work - e->freed - e->inner_work);
}
