/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Overlap, coordination, fabric and stress of a packing in equilibrium. */
#include "prepare/finish.h"

static void principal(gh_finish_report *r) {
  double c = r->fabric[0] - r->fabric[2], s = 2 * r->fabric[1];
  r->anisotropy = hypot(c, s);
  r->anisotropy_angle = r->anisotropy > 0 ? 0.5 * atan2(s, c) : 0;
}

gh_status finish_report_fill(gh_rve *rve, double mean_radius, gh_finish_report *r) {
  const gh_rve_measures *m = gh_rve_measure(rve);
  gh_rve_view v;
  GH_TRY(gh_rve_look(rve, &v));
  *r = (gh_finish_report){.residual = m->residual,
                          .volume_fraction = m->volume_fraction,
                          .rattlers = m->rattlers,
                          .acoustic = m->acoustic,
                          .acoustic_angle = m->acoustic_angle};
  for (int k = 0; k < 4; k++) r->cauchy[k] = m->cauchy[k];
  r->pressure = -(m->cauchy[0] + m->cauchy[3]) / 2;
  for (int k = 0; k < v.ncontacts && !m->unjammed; k++) {
    const gh_contact *c = &v.contacts[k];
    if ((v.flags[c->i] | v.flags[c->j]) & 1) continue; /* a rattler carries nothing */
    double d2 = c->l[0] * c->l[0] + c->l[1] * c->l[1];
    r->contacts++;
    r->overlap += c->overlap;
    r->fabric[0] += c->l[0] * c->l[0] / d2;
    r->fabric[1] += c->l[0] * c->l[1] / d2;
    r->fabric[2] += c->l[1] * c->l[1] / d2;
  }
  if (!r->contacts) return GH_OK;
  r->overlap /= r->contacts * mean_radius;
  for (int k = 0; k < 3; k++) r->fabric[k] /= r->contacts;
  r->coordination = 2.0 * r->contacts / (v.n - r->rattlers);
  r->coordination_all = 2.0 * r->contacts / v.n;
  principal(r);
  return GH_OK;
}

void gh_finish_print(const gh_finish_report *r, gh_text *out) {
  const double degrees = 180 / GH_PI;
  gh_text_print(out, "mean overlap           %.6g of the mean radius\n", r->overlap);
  gh_text_print(out, "pressure               %.6g\n", r->pressure);
  gh_text_print(out, "Cauchy stress          s11 %.6g  s22 %.6g  s12 %.6g\n", r->cauchy[0], r->cauchy[3],
                (r->cauchy[1] + r->cauchy[2]) / 2);
  gh_text_print(out, "residual               %.3g of the mean contact force\n", r->residual);
  gh_text_print(out, "soft volume fraction   %.6f (cell scaled by %.6g)\n", r->volume_fraction,
                r->linear_scale);
  gh_text_print(out, "contacts, rattlers     %d, %d\n", r->contacts, r->rattlers);
  gh_text_print(out, "coordination number    %.4f (%.4f over all grains)\n", r->coordination,
                r->coordination_all);
  gh_text_print(
      out, "fabric anisotropy      %.4f (difference of the principal values of mean n(x)n, %.0f degrees)\n",
      r->anisotropy, r->anisotropy_angle * degrees);
  gh_text_print(out, "smallest acoustic      %.6g at %.0f degrees (periodic conditions)\n", r->acoustic,
                r->acoustic_angle * degrees);
}
