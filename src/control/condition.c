/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Conditions on stress and deformation: words, values, derivatives. */
#include "granhom/control.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[GH_QUANTITIES] = {
#define GH_X(name) #name,
    GH_QUANTITY_LIST(GH_X)
#undef GH_X
};

/* ---- words ---- */

static int find(const char *word, size_t length) {
  for (int k = 0; k < GH_QUANTITIES; k++)
    if (strlen(names[k]) == length && !strncmp(names[k], word, length)) return k;
  return -1;
}

static gh_status refuse(gh_context *ctx, const char *text, const char *why) {
  char list[160] = "";
  for (int k = 0; k < GH_QUANTITIES; k++) {
    strcat(list, k ? " " : "");
    strcat(list, names[k]);
  }
  return gh_fail(ctx, GH_INPUT,
                 "\"%s\" is no condition: %s; a condition is one of %s, or a sum like \"s22 - 0.5 s11\"",
                 text, why, list);
}

static const char *blanks(const char *at) {
  return at + strspn(at, " \t");
}

/* One term: sign, number, name. The sign may be missing in the first. Returns what is wrong, or NULL. */
static const char *term(const char **at, bool first, gh_condition *c) {
  double factor = 1;
  const char *p = blanks(*at);
  if (*p == '+' || *p == '-') factor = *p++ == '-' ? -1 : 1;
  else if (!first) return "a sign is missing between two quantities";
  p = blanks(p);
  if (isdigit((unsigned char)*p) || *p == '.') {
    char *end;
    factor *= strtod(p, &end);
    p = blanks(end);
    if (*p == '*') p = blanks(p + 1);
  }
  size_t length = 0;
  while (isalnum((unsigned char)p[length])) length++;
  int k = find(p, length);
  if (k < 0) return length ? "unknown quantity" : "a quantity is missing";
  c->factor[k] += factor;
  *at = blanks(p + length);
  return isfinite(factor) ? NULL : "a factor is not finite";
}

static bool is_stress(int k) {
  return k > GH_QUANTITY_volume;
}

gh_status gh_condition_parse(gh_context *ctx, const char *text, gh_condition *c) {
  *c = (gh_condition){0};
  const char *at = blanks(text), *wrong = NULL;
  bool first = true;
  for (; !wrong && (first || *at); first = false) wrong = term(&at, first, c);
  if (wrong) return refuse(ctx, text, wrong);
  int stresses = 0, others = 0;
  for (int k = 0; k < GH_QUANTITIES; k++)
    if (c->factor[k] != 0) ++*(is_stress(k) ? &stresses : &others);
  if (stresses && others) return refuse(ctx, text, "it mixes stress and deformation");
  if (!stresses && !others) return refuse(ctx, text, "nothing is left of it");
  c->stress = stresses > 0;
  return GH_OK;
}

/* ---- values ---- */

double gh_condition_value(const gh_condition *c, const double F[4], const double P[4]) {
  double s[4], value[GH_QUANTITIES], sum = 0;
  gh_cauchy2(P, F, s);
  memcpy(value + GH_QUANTITY_F11, F, 4 * sizeof *F);
  memcpy(value + GH_QUANTITY_P11, P, 4 * sizeof *P);
  value[GH_QUANTITY_volume] = gh_det2(F);
  value[GH_QUANTITY_s11] = s[0];
  value[GH_QUANTITY_s12] = (s[1] + s[2]) / 2; /* equal but for round-off */
  value[GH_QUANTITY_s22] = s[3];
  value[GH_QUANTITY_pressure] = -(s[0] + s[3]) / 2;
  for (int k = 0; k < GH_QUANTITIES; k++)
    if (c->factor[k] != 0) sum += c->factor[k] * value[k];
  return sum;
}

/* ds_ij/dF_kL = (A_iMkL F_jM + P_iL delta_jk)/J - s_ij cof_kL/J. */
static void cauchy_slope(int i, int j, const double F[4], const double P[4], const double A[16],
                         double d[4]) {
  const double cof[4] = {F[3], -F[2], -F[1], F[0]}, J = gh_det2(F);
  double s[4];
  gh_cauchy2(P, F, s);
  for (int k = 0; k < 2; k++)
    for (int L = 0; L < 2; L++) {
      double sum = j == k ? P[2 * i + L] : 0;
      for (int M = 0; M < 2; M++) sum += A[8 * i + 4 * M + 2 * k + L] * F[2 * j + M];
      d[2 * k + L] = (sum - s[2 * i + j] * cof[2 * k + L]) / J;
    }
}

static void quantity_slope(int q, const double F[4], const double P[4], const double A[16], double d[4]) {
  const double cof[4] = {F[3], -F[2], -F[1], F[0]};
  double e[4];
  if (q <= GH_QUANTITY_F22) {
    for (int a = 0; a < 4; a++) d[a] = a == q;
  } else if (q == GH_QUANTITY_volume) {
    memcpy(d, cof, sizeof cof);
  } else if (q <= GH_QUANTITY_P22) {
    memcpy(d, A + 4 * (q - GH_QUANTITY_P11), sizeof e);
  } else if (q == GH_QUANTITY_s11 || q == GH_QUANTITY_s22) {
    int i = q == GH_QUANTITY_s22;
    cauchy_slope(i, i, F, P, A, d);
  } else {
    bool shear = q == GH_QUANTITY_s12;
    cauchy_slope(0, shear, F, P, A, d);
    cauchy_slope(1, !shear, F, P, A, e);
    for (int a = 0; a < 4; a++) d[a] = (shear ? 0.5 : -0.5) * (d[a] + e[a]);
  }
}

void gh_condition_slope(const gh_condition *c, const double F[4], const double P[4], const double A[16],
                        double slope[4]) {
  for (int a = 0; a < 4; a++) slope[a] = 0;
  for (int q = 0; q < GH_QUANTITIES; q++) {
    double d[4];
    if (c->factor[q] == 0) continue;
    quantity_slope(q, F, P, A, d);
    for (int a = 0; a < 4; a++) slope[a] += c->factor[q] * d[a];
  }
}
