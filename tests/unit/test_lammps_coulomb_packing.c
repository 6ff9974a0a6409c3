/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Pair style granhom/coulomb in LAMMPS's own hands: reference packings, boxes that flip, tangents. */
#include "coulomb_help.h"

#include <lammps/library.h>

enum { MOST = 150 };

/* The reference packing in LAMMPS's own hands. */
static void *open_packing(gh_context *ctx, const char *name, const char *style, const char *coefficients) {
  static const char *const before[] = {"dimension 2", "atom_style sphere", "atom_modify map array",
                                       "newton off",  "box tilt large",    NULL};
  static const char *const after[] = {"neighbor 0.02 bin", "neigh_modify every 1 delay 0 check yes",
                                      "compute s all granhom/stress", NULL};
  void *lmp;
  OK(gh_lmp_open(ctx, &lmp));
  commands(ctx, lmp, before);
  OK(gh_lmp_command(ctx, lmp, "read_data tests/data/cases/packings/%s.data", name));
  command(ctx, lmp, "change_box all triclinic");
  OK(gh_lmp_command(ctx, lmp, "pair_style %s", style));
  OK(gh_lmp_command(ctx, lmp, "pair_coeff * * %s", coefficients));
  commands(ctx, lmp, after);
  return lmp;
}

/* A box that fix deform flips is the same packing as one that it does not flip. */
static void flips(void **state) {
  gh_context *ctx = *state;
  static double f[2][3 * MOST];
  int n = 0;
  for (int k = 0; k < 2; k++) {
    void *lmp = open_packing(ctx, "p150d", "granhom/coulomb", "1000 800 0.5 10");
    command(ctx, lmp, "timestep 1e-4");
    command(ctx, lmp, "fix m all nve/sphere disc");
    command(ctx, lmp, "fix d all viscous 0.3");
    command(ctx, lmp,
            k ? "fix s all deform 1 xy final 1.4 remap x flip yes"
              : "fix s all deform 1 xy final 1.4 remap x flip no");
    command(ctx, lmp, "run 600 post no");
    double tilt = lammps_get_thermo(lmp, "xy"), wide = lammps_get_thermo(lmp, "lx");
    assert_true(k ? tilt < 0.5 * wide : tilt > 0.5 * wide);
    OK(gh_lmp_setting(ctx, lmp, "nlocal", &n));
    forces(ctx, lmp, n, f[k]);
    gh_lmp_close(&lmp);
  }
  print_message("forces up to %g, flipped or not differ by %g\n", norm(f[0], 3 * n),
                distance(f[0], f[1], 3 * n));
  NEAR("forces", distance(f[0], f[1], 3 * n), 0, 1e-8 * norm(f[0], 3 * n));
}

/* The box becomes (1 + g) of lx and xy, or of ly. */
static void stretch(gh_context *ctx, void *lmp, int along, const double box[3], double g) {
  if (along) OK(gh_lmp_command(ctx, lmp, "change_box all y final 0 %.17g remap", box[1] * (1 + g)));
  else
    OK(gh_lmp_command(ctx, lmp, "change_box all x final 0 %.17g xy final %.17g remap", box[0] * (1 + g),
                      box[2] * (1 + g)));
}

static void stress_now(void *lmp, double s[4]) {
  const double *v = lammps_extract_compute(lmp, "s", 0, LMP_TYPE_VECTOR);
  memcpy(s, (double[4]){v[0], v[1], v[3], v[4]}, 4 * sizeof *s);
}

/* The tangent is the derivative of the relaxed stress at fixed state n, with friction and without, with one
 * relaxation step per time step and with many, damped and FIRE, and with both laws of hardening. LAMMPS's boxes allow F11, F12, F22; turning
 * gives F21. */
static void tangents(void **state) {
  gh_context *ctx = *state;
  static const char *const styles[] = {"granhom/normal", "granhom/coulomb increment manual",
                                       "granhom/coulomb increment manual hardening proportional"};
  for (int k = 0; k < 6; k++) {
    void *lmp = open_packing(ctx, "p50d", styles[(k > 0) + (k > 3)],
                             k > 3 ? "1000 800 0.3 100"
                             : k   ? "1000 800 0.3 20"
                                   : "1000");
    const double h = 1e-6;
    double A[16], S[4], worst = 0;
    command(ctx, lmp, "compute t all granhom/tangent");
    command(ctx, lmp,
            k == 3            ? "fix r all granhom/relax tolerance 1e-11 inner yes method fire"
            : k % 2 == 0 && k ? "fix r all granhom/relax tolerance 1e-11"
                              : "fix r all granhom/relax tolerance 1e-11 inner yes");
    command(ctx, lmp, "run 100000 post no");
    for (int step = 0; step < 2; step++) {
      if (k) command(ctx, lmp, "fix_modify granhom_history commit yes");
      command(ctx, lmp, "change_box all x scale 0.999 y scale 0.9995 xy delta 0.001 remap");
      command(ctx, lmp, "run 100000 post no");
    }
    double **array = lammps_extract_compute(lmp, "t", LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY);
    assert_non_null(array);
    memcpy(A, array[0], sizeof A);
    stress_now(lmp, S);
    const double box[3] = {lammps_get_thermo(lmp, "lx"), lammps_get_thermo(lmp, "ly"),
                           lammps_get_thermo(lmp, "xy")};
    for (int c = 0; c < 4; c++) {
      if (c == 2) continue;
      double P[2][4];
      for (int side = 0; side < 2; side++) {
        const double g = side ? -h : h, move = side ? -2 * h : h; /* from the other side */
        if (c == 1) OK(gh_lmp_command(ctx, lmp, "change_box all xy delta %.17g remap", move * box[1]));
        else stretch(ctx, lmp, c, box, g);
        command(ctx, lmp, "run 100000 post no");
        double s[4],
            J = c == 1 ? 1 : 1 + g,
            inverse[4] = {c == 0 ? 1 / J : 1, 0, c == 1 ? -g : 0, c == 3 ? 1 / J : 1}; /* of F, transposed */
        stress_now(lmp, s);
        gh_mul2(s, inverse, P[side]);
        for (int m = 0; m < 4; m++) P[side][m] *= J;
      }
      if (c == 1) OK(gh_lmp_command(ctx, lmp, "change_box all xy delta %.17g remap", h * box[1]));
      else stretch(ctx, lmp, c, box, 0);
      command(ctx, lmp, "run 100000 post no");
      for (int m = 0; m < 4; m++) worst = fmax(worst, fabs(A[4 * m + c] - (P[0][m] - P[1][m]) / (2 * h)));
    }
    print_message("tangent %g, against differences %g\n", norm(A, 16), worst / norm(A, 16));
    NEAR("tangent", worst / norm(A, 16), 0, 1e-5);
    const double WS[4] = {-S[2], -S[3], S[0], S[1]};
    for (int m = 0; m < 4 && !k; m++) NEAR("turning", A[4 * m + 2] - A[4 * m + 1], WS[m], 1e-9 * norm(A, 16));
    gh_lmp_close(&lmp);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(flips), TEST(tangents)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
