/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Coulomb friction by return mapping: force, couple, history and their exact derivative (dissertation 7.2,
 * Table 7.1, as settled in method 8.6-8.14).
 *
 * Everything is incremental between the converged state n and the trial state: l_n is the branch vector at n
 * (of the separated pair, if the contact formed since), gamma_n, gamma_pl_n and alpha_n its history, zero for
 * a contact that formed since. Rotations enter through q = r_i dtheta_i + r_j dtheta_j alone.
 * Inline, in C and in C++; plane problems. */
#ifndef GRANHOM_CONTACT_COULOMB_H
#define GRANHOM_CONTACT_COULOMB_H

#include "contact/normal.h"
#include "granhom/contact.h"

/* What the increment starts from and goes to. */
typedef struct gh_coulomb_step {
  double l[2], d;                /* branch vector and its length > 0 */
  double reach;                  /* r_i + r_j >= d */
  double ln[2];                  /* branch vector at n */
  double q;                      /* r_i dtheta_i + r_j dtheta_j */
  double gamma, gamma_pl, alpha; /* of n */
} gh_coulomb_step;

typedef struct gh_coulomb_result {
  double f[2];                   /* force on grain i, normal part included */
  double force, couple;          /* f_t, and M: the moments are -r_i M, -r_j M */
  double gamma, gamma_pl, alpha; /* of the trial state */
  double multiplier;             /* dlambda >= 0 */
  double c;                      /* scaling of (7.20) */
  int slides;                    /* 0, or the sign of the sliding force */
} gh_coulomb_result;

static inline int gh_coulomb_is_proportional(const gh_contact_law *law) {
  return law->hardening_law == GH_HARDENING_PROPORTIONAL;
}
/* What the friction limit has of the normal force: tan(rho), with proportional hardening. */
static inline double gh_coulomb_coefficient(const gh_contact_law *law, double alpha) {
  const double mu = law->friction_coefficient;
  return gh_coulomb_is_proportional(law) ? mu + law->hardening * alpha : mu;
}
/* The friction limit at the normal force fn. */
static inline double gh_coulomb_limit(const gh_contact_law *law, double fn, double alpha) {
  const double mu = law->friction_coefficient, h = law->hardening;
  return gh_coulomb_is_proportional(law) ? fn * (mu + h * alpha) : fn * mu + h * alpha;
}
/* By how much that grows with alpha. Pairs that are apart are evaluated too, with any result. */
static inline double gh_coulomb_growth(const gh_contact_law *law, double fn) {
  return gh_coulomb_is_proportional(law) ? law->hardening * (fn > 0 ? fn : 0) : law->hardening;
}

/* Slip of the increment (7.5), (method 8.7), and the scaling c (7.20). */
static inline double gh_coulomb_slip(const gh_contact_law *law, const gh_coulomb_step *s, double *c) {
  const double dot = s->ln[0] * s->l[0] + s->ln[1] * s->l[1], /* |l_n| |l| cos */
      cross = s->ln[0] * s->l[1] - s->ln[1] * s->l[0],        /* |l_n| |l| sin */
      turn = s->q * s->d / s->reach;
  if (law->slip == GH_SLIP_OBJECTIVE) {
    *c = 1;
    return turn - sqrt(s->ln[0] * s->ln[0] + s->ln[1] * s->ln[1]) * atan2(cross, dot);
  }
  *c = dot / (s->d * s->d);
  return turn - cross / s->d;
}

/* Table 7.1 for a contact with overlap >= 0. Without branches, so that loops over contacts vectorise. */
static inline void gh_coulomb_evaluate(const gh_contact_law *law, const gh_coulomb_step *s,
                                       gh_coulomb_result *r) {
  const double Et = law->tangential_stiffness, e = s->reach - s->d, fn = law->normal_stiffness * e;
  r->gamma = s->gamma + gh_coulomb_slip(law, s, &r->c);
  r->gamma_pl = s->gamma_pl;
  r->alpha = s->alpha;
  const double trial = Et * (r->gamma - r->gamma_pl), size = fabs(trial), sign = copysign(1, trial),
               beyond = gh_coulomb_is_proportional(law)
                            ? size - fn * gh_coulomb_coefficient(law, r->alpha)
                            : size - law->hardening * r->alpha - fn * law->friction_coefficient,
               slip = beyond > 0 ? beyond : 0;
  /* (7.16), (7.17); the force is taken from the limit, so that no friction is exactly none */
  r->multiplier = slip / (Et + gh_coulomb_growth(law, fn));
  r->gamma_pl += r->multiplier * sign;
  r->alpha += r->multiplier;
  const double limit = gh_coulomb_limit(law, fn, r->alpha);
  r->force = sign * (beyond > 0 ? limit : size);
  r->slides = beyond > 0 ? (trial > 0 ? 1 : -1) : 0;
  r->couple = r->c * (s->d / s->reach) * r->force;
  const double normal = gh_normal_factor(law->normal_stiffness, e, s->d), along = r->c * r->force / s->d;
  r->f[0] = normal * s->l[0] + along * s->l[1]; /* t = (-l_y, l_x) / d */
  r->f[1] = normal * s->l[1] - along * s->l[0];
}

/* Derivative of (f_x, f_y, M) with respect to (l_x, l_y, q) at fixed state n: 3 x 3, row-major. The Coulomb
 * limit moves with the overlap, and c and s = |l|/(r_i + r_j) with the branch vector (method 8.12). */
static inline void gh_coulomb_derivative(const gh_contact_law *law, const gh_coulomb_step *s,
                                         const gh_coulomb_result *r, double *d9) {
  const double En = law->normal_stiffness, Et = law->tangential_stiffness, d = s->d, R = s->reach, e = R - d,
               h = gh_coulomb_growth(law, En * e), mu = gh_coulomb_coefficient(law, r->alpha),
               n[2] = {s->l[0] / d, s->l[1] / d}, t[2] = {-n[1], n[0]};
  const double stiff = r->slides ? Et * h / (Et + h) : Et,    /* df_t/dgamma */
      limit = r->slides ? r->slides * Et * mu / (Et + h) : 0; /* df_t/df_n */
  const double lt = s->ln[0] * t[0] + s->ln[1] * t[1], ln = s->ln[0] * n[0] + s->ln[1] * n[1];
  const int objective = law->slip == GH_SLIP_OBJECTIVE;
  const double turned = objective ? sqrt(s->ln[0] * s->ln[0] + s->ln[1] * s->ln[1]) / d : r->c, ratio = d / R,
               ft = r->force;
  double g[2], dc[2]; /* of f_t and of c, with respect to l */
  for (int k = 0; k < 2; k++) {
    g[k] = stiff * (s->q / R * n[k] - turned * t[k]) - limit * En * n[k];
    dc[k] = objective ? 0 : (lt * t[k] - ln * n[k]) / (d * d);
  }
  const double gq = stiff * ratio;
  for (int i = 0; i < 2; i++) {
    for (int k = 0; k < 2; k++)
      d9[3 * i + k] = En * (n[i] * n[k] - e / d * t[i] * t[k]) - t[i] * (ft * dc[k] + r->c * g[k]) +
                      r->c * ft / d * n[i] * t[k];
    d9[3 * i + 2] = -r->c * t[i] * gq;
    d9[6 + i] = ratio * (ft * dc[i] + r->c * g[i]) + r->c * ft / R * n[i];
  }
  d9[8] = r->c * ratio * gq;
}

/* What the tangential spring and printed hardening store (7.6). */
static inline double gh_coulomb_energy(const gh_contact_law *law, const gh_coulomb_result *r) {
  const double elastic = r->gamma - r->gamma_pl, Et = law->tangential_stiffness,
               h = gh_coulomb_is_proportional(law) ? 0 : law->hardening;
  return 0.5 * Et * elastic * elastic + 0.5 * h * r->alpha * r->alpha;
}

/* What the step has dissipated at the overlap e (7.13): all that friction takes but what hardening stores. */
static inline double gh_coulomb_dissipated(const gh_contact_law *law, const gh_coulomb_result *r, double e) {
  return r->multiplier * law->normal_stiffness * e * gh_coulomb_coefficient(law, r->alpha);
}
#endif
