/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Explicit relaxation: M u'' + c M u' + f_int(u) = f_ext by central differences, from stresses alone.
 *
 * M is lumped, with a density for each unknown that makes the critical time step 1: a quarter of the row sum
 * of |K| (Gershgorin), K that of an isotropic elastic body on this mesh. Its modulus is found from stresses:
 * the body is deflected by a strain of 1e-6 in the stiffest shape of K, and what it resists with is the
 * modulus. Where the last steps show a stiffness beyond the bound, du . dR > 4 du . M du, it grows and the
 * body starts again from rest. Damping follows the last step: c = 2 xi sqrt(du . dR / du . M du).
 *
 * Prescribed displacements are carried into the body by the same K, with conjugate gradients: imposed on one
 * row of elements alone they would rearrange its packings. Nothing is factorised.
 *
 * The kinetic energy alone vanishes wherever the body reverses, and is small where it creeps. So it counts as at
 * rest when the kinetic energy of the coming half step is small against the work of the increment and the
 * residual forces are what Newton's iteration would accept at this tolerance. */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

/* Strain of the deflection that measures the modulus: far above what equilibria of packings leave open, far
 * below what opens contacts. */
static const double strain = 1e-6;
/* Conjugate gradients end at this share of the first residual: they carry displacements, and do not solve. */
static const double carried = 1e-4;
/* Where relaxation stands in for Newton it has other ways beside it: it ends when so many steps in a row did
 * not halve the smallest residual, as they do to and fro over a discontinuity. */
enum { PATIENCE = 150 };
enum { STEPS = 2000, POWERS = 30, GRADIENTS = 2000, ARRAYS = 5 };

gh_status gh_relax_check(gh_context *ctx, const gh_macro_options *o) {
  if (o->method < GH_METHOD_NEWTON || o->method > GH_METHOD_AUTOMATIC)
    return gh_fail(ctx, GH_INPUT, "solver: there is no method %d", (int)o->method);
  if (!(o->damping_ratio > 0 && isfinite(o->damping_ratio)))
    return gh_fail(ctx, GH_INPUT, "solver: damping_ratio %g must be above 0", o->damping_ratio);
  if (!(o->safety > 0 && o->safety < 1))
    return gh_fail(ctx, GH_INPUT, "solver: safety %g must lie between 0 and 1", o->safety);
  return GH_OK;
}

gh_status gh_relax_allocate(gh_macro *m) {
  gh_relax_arrays *r = &m->relax;
  size_t n = 2 * (size_t)m->ndof;
  GH_TRY(gh_alloc(m->ctx, ARRAYS * n, sizeof *r->numbers, &r->numbers));
  r->mass = r->numbers, r->velocity = r->mass + n, r->last = r->velocity + n;
  r->shape = r->last + n, r->work = r->shape + n;
  return GH_OK;
}

/* ---- masses ---- */

/* A footing's unknowns move its nodes by as much at most, so its row is the sum of theirs; for other rows
 * each of its nodes stands for two unknowns of it. */
static void masses_of_footings(gh_macro *m) {
  double *mass = m->relax.mass;
  for (int a = 0; a < m->mesh->nnodes; a++) {
    if (m->owner[a] < 0) continue;
    double *q = mass + m->ndof + 3 * m->owner[a];
    q[0] += mass[2 * a], q[1] += mass[2 * a + 1], q[2] += mass[2 * a] + mass[2 * a + 1];
  }
}

/* K and the masses of a body of this modulus. Equal Lame constants: those of many grains in contact without
 * friction. */
static void body_assemble(gh_macro *m, double modulus) {
  double A[4][16] = {{0}}, *mass = m->relax.mass;
  for (int k = 0; k < 64; k++) {
    const int i = k >> 3 & 1, J = k >> 2 & 1, j = k >> 1 & 1, L = k & 1;
    A[k / 16][k % 16] = modulus * ((i == J) * (j == L) + (i == j) * (J == L) + (i == L) * (J == j));
  }
  memset(mass, 0, 2 * (size_t)m->ndof * sizeof *mass);
  gh_system_clear(m->system);
  for (int e = 0; e < m->mesh->nelements; e++) {
    double K[8][8];
    int dof[8];
    for (int k = 0; k < 8; k++) dof[k] = 2 * m->mesh->quad[e][k / 2] + k % 2;
    gh_element_stiffness(&m->shapes, e, A[0], K);
    gh_system_add(m->system, 8, dof, K[0]);
    for (int k = 0; k < 64; k++) {
      const int column = dof[k % 8];
      mass[dof[k / 8]] += 0.25 * fabs(K[k / 8][k % 8]) * (m->owner[column / 2] >= 0 ? 2 : 1);
    }
  }
  masses_of_footings(m);
}

/* y = K x for nodal unknowns, zero elsewhere. */
static void body_multiply(const gh_macro *m, const gh_attempt *a, const double *x, double *y) {
  memset(y, 0, (size_t)m->ndof * sizeof *y);
  gh_system_multiply(m->system, x, y);
  for (int d = 0; d < m->ndof; d++)
    if (!gh_residual_is_free(m, a, d)) y[d] = 0;
}

static double dot(int n, const double *a, const double *b) {
  double sum = 0;
  for (int k = 0; k < n; k++) sum += a[k] * b[k];
  return sum;
}

/* The stiffest shape of M^-1 K, its largest entry 1, and x . K x; 0: nothing can move. */
static double shape_find(gh_macro *m, const gh_attempt *a) {
  double *x = m->relax.shape, *y = m->relax.work;
  for (int d = 0; d < m->ndof; d++)
    x[d] = gh_residual_is_free(m, a, d) ? (double)(2654435761u * (unsigned)(d + 1) >> 20) / 2048 - 1 : 0;
  for (int k = 0; k < POWERS; k++) {
    double largest = 0;
    body_multiply(m, a, x, y);
    for (int d = 0; d < m->ndof; d++) largest = gh_max(largest, fabs(x[d] = y[d] / m->relax.mass[d]));
    if (largest == 0) return 0;
    for (int d = 0; d < m->ndof; d++) x[d] /= largest;
  }
  body_multiply(m, a, x, y);
  return dot(m->ndof, x, y);
}

static double stress_largest(const gh_macro *m) {
  double largest = 0;
  for (int p = 0; p < m->npoints; p++) largest = gh_max(largest, gh_norm(m->eq.P + 4 * (size_t)p, 4));
  return largest;
}

/* The modulus of the body as it is: by one evaluation. */
static gh_status modulus_find(gh_macro *m, const gh_attempt *a, double *modulus) {
  body_assemble(m, 1);
  const double stiffness = shape_find(m, a), size = strain * m->length, *x = m->relax.shape;
  *modulus = 1;
  if (stiffness == 0) return GH_OK;
  for (int d = 0; d < m->ndof; d++) m->next.u[d] = m->eq.u[d] + size * x[d];
  GH_TRY(gh_macro_evaluate_stress(m, &m->next, &m->eq));
  double work = dot(m->ndof, x, m->next.fint) - dot(m->ndof, x, m->eq.fint);
  GH_TRY(gh_farm_revert(m->farm)); /* nobody commits the deflection */
  *modulus = work / size / stiffness;
  if (!(*modulus > 0)) *modulus = stress_largest(m);
  if (*modulus > 0) return GH_OK;
  char text[256];
  gh_name_unjammed(m, text, sizeof text);
  return gh_fail(m->ctx, GH_DIVERGED, "nothing resists: the body has no stiffness%s%s", *text ? ": " : "",
                 text);
}

/* ---- prescribed displacements ---- */

/* m->du holds the prescribed part; the rest follows as in an elastic body. Footings stay. */
static void displacements_carry(gh_macro *m, const gh_attempt *a) {
  double *r = m->relax.work, *p = m->relax.velocity, *Kp = m->relax.last, *z = m->relax.shape;
  body_multiply(m, a, m->du, r);
  for (int d = 0; d < m->ndof; d++) r[d] = -r[d], p[d] = z[d] = r[d] / m->relax.mass[d];
  double rz = dot(m->ndof, r, z);
  const double enough = carried * carried * rz;
  for (int k = 0; k < GRADIENTS && rz > enough; k++) {
    body_multiply(m, a, p, Kp);
    const double alpha = rz / dot(m->ndof, p, Kp), before = rz;
    for (int d = 0; d < m->ndof; d++) {
      m->du[d] += alpha * p[d];
      r[d] -= alpha * Kp[d];
      z[d] = r[d] / m->relax.mass[d];
    }
    rz = dot(m->ndof, r, z);
    for (int d = 0; d < m->ndof; d++) p[d] = z[d] + rz / before * p[d];
  }
}

/* ---- steps ---- */

/* By m->du to the next iterate. */
static gh_status body_move(gh_macro *m, gh_attempt *a) {
  double residual, scale;
  gh_step_move(m, 1);
  GH_TRY(gh_macro_evaluate_stress(m, &m->next, &m->now));
  gh_residual_find(m, a, &m->next, NULL, m->trial);
  GH_TRY(gh_residual_measure(m, a, m->trial, &residual, &scale));
  gh_step_accept(m, a, residual, scale); /* m->trial is the residual before */
  a->iterations++, a->relaxed++;
  return GH_OK;
}

static gh_status body_begin(gh_macro *m, gh_attempt *a) {
  double modulus;
  gh_state_copy(m, &m->eq, &m->now);
  GH_TRY(modulus_find(m, a, &modulus));
  body_assemble(m, modulus);
  if (gh_prescribe(m, a)) {
    displacements_carry(m, a);
    GH_TRY(body_move(m, a));
  } else {
    gh_residual_find(m, a, &m->now, NULL, m->residual);
    GH_TRY(gh_residual_measure(m, a, m->residual, &a->residual, &a->scale));
  }
  return GH_OK;
}

/* Velocities half a step ahead, and their energy. rest: they were zero here. */
static double body_accelerate(gh_macro *m, const gh_attempt *a, double damping, bool rest) {
  const double dt = m->options.safety, brake = 0.5 * damping * dt;
  double *v = m->relax.velocity, energy = 0;
  for (int d = 0; d < gh_residual_size(m); d++) {
    const double push = gh_residual_is_free(m, a, d) ? -dt * m->residual[d] / m->relax.mass[d] : 0;
    v[d] = rest ? 0.5 * push : ((1 - brake) * v[d] + push) / (1 + brake);
    energy += 0.5 * m->relax.mass[d] * v[d] * v[d];
  }
  return energy;
}

/* du . dR / du . M du of the last step, from m->du and the two residuals. */
static double step_stiffness(const gh_macro *m, const gh_attempt *a) {
  double change = 0, size = 0;
  for (int d = 0; d < gh_residual_size(m); d++) {
    if (!gh_residual_is_free(m, a, d)) continue;
    change += m->du[d] * (m->residual[d] - m->trial[d]);
    size += m->relax.mass[d] * m->du[d] * m->du[d];
  }
  return size > 0 ? change / size : 0;
}

/* The masses of a stiffer body. */
static void masses_scale(gh_macro *m, double factor) {
  for (int d = 0; d < gh_residual_size(m); d++) m->relax.mass[d] *= factor;
}

static bool body_is_at_rest(const gh_macro *m, const gh_attempt *a) {
  return gh_residual_converged(m, a) && gh_within(a->kinetic, m->options.tolerance);
}

static gh_status body_relax(gh_macro *m, gh_attempt *a) {
  const bool alone = m->options.method == GH_METHOD_RELAXATION;
  const double first = a->residual;
  double damping = 0, least = first;
  int most = alone ? m->options.max_iterations : PATIENCE;
  bool rest = true, stiff = false;
  for (int k = 0;; k++) {
    const double energy = body_accelerate(m, a, damping, rest), work = fabs(gh_internal_work(m));
    a->kinetic = energy == 0 ? 0 : work > 0 ? energy / work : 1;
    gh_iteration_report(m, a, k, first, m->options.safety);
    if (body_is_at_rest(m, a)) return GH_OK;
    if (!alone && a->residual <= 0.5 * least) {
      least = a->residual;
      most = k + PATIENCE < STEPS ? k + PATIENCE : STEPS;
    }
    if (k >= most)
      return gh_fail(
          m->ctx, GH_DIVERGED,
          "the body does not come to rest in %d steps: relative residual %.3g, kinetic energy %.3g "
          "of the internal work",
          k, gh_relative_residual(a), a->kinetic);
    for (int d = 0; d < gh_residual_size(m); d++) m->du[d] = m->options.safety * m->relax.velocity[d];
    GH_TRY(body_move(m, a));
    const double square = step_stiffness(m, a);
    rest = stiff && square > 4; /* twice in a row: not a packing that rearranges once */
    stiff = !rest && square > 4;
    if (rest) masses_scale(m, fmin(0.3 * square, 4));
    damping = square > 0 ? 2 * m->options.damping_ratio * sqrt(square) : 0;
  }
}

gh_status gh_relax(gh_macro *m, gh_attempt *a) {
  gh_instability_forget(&m->instability);
  gh_instability_forget(&m->swing);
  gh_status status = body_begin(m, a);
  if (status == GH_OK) status = body_relax(m, a);
  a->kinetic = 0;
  if (status == GH_INPUT) status = GH_DIVERGED;
  if (status != GH_OK || m->options.method == GH_METHOD_RELAXATION) return status;
  return gh_macro_evaluate(m, &m->now); /* tangents for Newton */
}
