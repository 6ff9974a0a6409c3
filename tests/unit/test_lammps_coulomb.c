/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Pair style granhom/coulomb in LAMMPS's own hands: two disks against closed forms, increment by
 * increment. */
#include "coulomb_help.h"

#include <lammps/library.h>

/* The only row of the contacts; NULL: there is none. */
static const double *row_of(gh_context *ctx, void *lmp) {
  int count;
  double **rows;
  OK(gh_lmp_local(ctx, lmp, "c", &count, &rows));
  assert_in_range(count, 0, 1);
  return count ? rows[0] : NULL;
}

static void turn_second(gh_context *ctx, void *lmp, double d, double from, double to) {
  OK(gh_lmp_command(ctx, lmp, "displace_atoms second move %.17g %.17g 0", d * (cos(to) - cos(from)),
                    d * (sin(to) - sin(from))));
}

/* Increments by hand: the second disk goes round the first in committed steps. The contact sticks, then
 * slides with the slope E_t h/(E_t + h), and unloads with E_t; force, torque, stress and LAMMPS's virial are
 * those of the closed form, and a commit without a move leaves all but the scaling c. Proportional hardening has
 * the same slope with h/f_n. */
static void increments_by(gh_context *ctx, const char *style, const char *coefficients) {
  const double e = 0.02, d = 1.5 - e, step = 0.0005, Et = 80, h = 20, fn = 100 * e, slip = d * sin(step);
  void *lmp = two_disks(ctx, style, coefficients, (double[2]){d, 0});
  command(ctx, lmp, "compute p all pressure NULL virial");
  command(ctx, lmp, "run 0 post no");
  double gamma = 0, plastic = 0, b = 0;
  for (int k = 1; k <= 25; k++) {
    const int back = k > 20;
    turn_second(ctx, lmp, d, b, b + (back ? -step : step));
    b += back ? -step : step;
    command(ctx, lmp, "run 0 post no");
    gamma -= back ? -slip : slip;
    const int slides = !back && -gamma * Et > 0.3 * fn;
    if (slides) plastic = gamma + (h * Et * -gamma + Et * 0.3 * fn) / (Et + h) / Et;
    double f[6];
    for (int again = 0; again < 2; again++) {
      const double ft = Et * (gamma - plastic), c = again ? 1 : cos(step), n[2] = {cos(b), sin(b)},
                   expected[2] = {-fn * n[0] + c * ft * n[1], -fn * n[1] - c * ft * n[0]};
      forces(ctx, lmp, 2, f);
      const double *row = row_of(ctx, lmp), *stress = lammps_extract_compute(lmp, "s", 0, LMP_TYPE_VECTOR);
      assert_non_null(row);
      NEAR("gamma", row[18], gamma, 1e-13);
      NEAR("gamma_pl", row[19], plastic, 1e-12);
      NEAR("alpha", row[20], -plastic, 1e-12);
      NEAR("f_t", row[17], ft, 1e-11);
      if (!again) assert_int_equal((int)row[21], slides);
      for (int m = 0; m < 2; m++) {
        NEAR("force", f[m], expected[m], 1e-11);
        NEAR("reaction", f[3 + m], -expected[m], 1e-11);
        for (int q = 0; q < 2; q++) NEAR("stress", stress[3 * m + q], expected[m] * d * n[q] / 72, 1e-12);
      }
      NEAR("torque", f[2], -c * d / 1.5 * ft, 1e-11);
      NEAR("torque", f[5], -0.5 * c * d / 1.5 * ft, 1e-11);
      if (again) break;
      command(ctx, lmp, "fix_modify granhom_history commit yes");
      command(ctx, lmp, "run 0 post no");
    }
  }
  assert_true(plastic < -0.001);
  gh_lmp_close(&lmp);
}
static void increments_by_hand(void **state) {
  increments_by(*state, "increment manual", "100 80 0.3 20");
  increments_by(*state, "increment manual hardening proportional", "100 80 0.3 10");
}

/* Each time step an increment: a disk that turns with a given omega slips by omega r dt |l|/(r_i + r_j) a
 * step; many runs, with setup or without, are as good as one. */
static void increments_by_time_step(void **state) {
  gh_context *ctx = *state;
  const double d = 1.48, omega = 2, slip = omega * 0.001 * d / 1.5;
  double f[3][6];
  for (int k = 0; k < 3; k++) {
    void *lmp = two_disks(ctx, "increment step", "100 80 0.3 0", (double[2]){d, 0});
    double **w;
    command(ctx, lmp, "fix drag all viscous 0");
    OK(gh_lmp_atom(ctx, lmp, "omega", &w));
    w[0][2] = omega;
    for (int run = 0; run < 3; run++) command(ctx, lmp, k && run ? "run 1 pre no post no" : "run 1 post no");
    if (k == 2) command(ctx, lmp, "run 0 post no");
    const double *row = row_of(ctx, lmp);
    NEAR("gamma", row[18], 3 * slip, 1e-14);
    forces(ctx, lmp, 2, f[k]);
    NEAR("torque", f[k][2], -80 * 3 * slip * d / 1.5, 1e-12);
    command(ctx, lmp, "run 10 post no");
    NEAR("limit", row_of(ctx, lmp)[17], 0.6, 1e-12);
    gh_lmp_close(&lmp);
  }
  for (int k = 1; k < 3; k++) NEAR("runs", distance(f[0], f[k], 6), 0, 1e-12);
}

/* A contact that opens loses its slip; alpha returns, here after the pair was apart for two increments. */
static void opening(void **state) {
  gh_context *ctx = *state;
  void *lmp = two_disks(ctx, "increment manual", "100 80 0.3 20", (double[2]){1.48, 0});
  command(ctx, lmp, "run 0 post no");
  turn_second(ctx, lmp, 1.48, 0, 0.01);
  command(ctx, lmp, "run 0 post no");
  const double alpha = row_of(ctx, lmp)[20];
  assert_true(alpha > 1e-3);
  for (int k = 0; k < 3; k++) {
    command(ctx, lmp, "fix_modify granhom_history commit yes");
    if (k < 2)
      command(ctx, lmp, k ? "displace_atoms second move 0.2 0.1 0" : "displace_atoms second move 0.2 0 0");
    else command(ctx, lmp, "displace_atoms second move -0.4 -0.1 0");
    command(ctx, lmp, "run 0 post no");
    if (k < 2) assert_null(row_of(ctx, lmp));
  }
  const double *row = row_of(ctx, lmp), l[2] = {1.48 * cos(0.01), 1.48 * sin(0.01)};
  /* the whole way of the last increment counts: from the separated pair, l + (0.4, 0.1) */
  const double gamma = -((l[0] + 0.4) * l[1] - (l[1] + 0.1) * l[0]) / 1.48,
               force = (80 * gamma - 0.3 * 2 - 20 * alpha) / 100;
  assert_non_null(row);
  NEAR("gamma", row[18], gamma, 1e-13);
  NEAR("alpha", row[20], alpha + force, 1e-12);
  gh_lmp_close(&lmp);
}

/* `unfix` is refused, and takes nothing away. With another pair style the history goes: contacts of one that
 * follows begin without slip, and nothing is listed before its first run, which has a setup, `pre no` or not. */
static void history_taken_away(void **state) {
  gh_context *ctx = *state;
  void *lmp = two_disks(ctx, "increment manual", "100 80 0.3 20", (double[2]){1.48, 0});
  int count;
  double **rows;
  command(ctx, lmp, "run 0 post no");
  turn_second(ctx, lmp, 1.48, 0, 0.003);
  command(ctx, lmp, "run 0 post no");
  const double force = row_of(ctx, lmp)[17];
  assert_true(fabs(force) > 0.1);
  FAILS(gh_lmp_command(ctx, lmp, "unfix granhom_history"), GH_ENGINE, "may not be removed or replaced");
  command(ctx, lmp, "run 0 post no");
  NEAR("f_t", row_of(ctx, lmp)[17], force, 1e-13);
  command(ctx, lmp, "pair_style granhom/normal");
  command(ctx, lmp, "pair_coeff * * 100");
  FAILS(gh_lmp_command(ctx, lmp, "fix_modify granhom_history commit yes"), GH_ENGINE, "granhom_history");
  command(ctx, lmp, "pair_style granhom/coulomb increment manual");
  command(ctx, lmp, "pair_coeff * * 100 80 0.3 20");
  command(ctx, lmp, "reset_timestep 1");
  FAILS(gh_lmp_local(ctx, lmp, "c", &count, &rows), GH_ENGINE, "use run 0 first");
  command(ctx, lmp, "run 0 pre no post no");
  NEAR("f_t", row_of(ctx, lmp)[17], 0, 1e-13);
  gh_lmp_close(&lmp);
}

/* What single() states of a contact is what compute() did: LAMMPS's compute pair/local asks it. */
static void single_contacts(void **state) {
  gh_context *ctx = *state;
  void *lmp = two_disks(ctx, "increment manual slip objective", "100 80 0.3 20", (double[2]){1.3, 0.6});
  int count;
  double **rows, f[6];
  command(ctx, lmp, "compute l all pair/local dist eng force fx fy p1 p2 p3 p4 p5 p6 p7 p8 p9");
  command(ctx, lmp, "compute e all pe");
  command(ctx, lmp, "thermo_style custom step c_e");
  command(ctx, lmp, "run 0 post no");
  command(ctx, lmp, "displace_atoms second move 0.01 -0.02 0");
  command(ctx, lmp, "run 0 post no");
  const double *row = row_of(ctx, lmp);
  double contact[26];
  memcpy(contact, row, sizeof contact);
  forces(ctx, lmp, 2, f);
  OK(gh_lmp_local(ctx, lmp, "l", &count, &rows));
  assert_int_equal(count, 1);
  const double *p = rows[0], *extra = p + 5, sign = p[3] * f[0] > 0 ? 1 : -1; /* of either atom */
  NEAR("distance", p[0], hypot(contact[2], contact[3]), 1e-14);
  NEAR("normal force", p[2], hypot(p[3], p[4]), 1e-12);
  for (int m = 0; m < 2; m++) NEAR("force", p[3 + m] + extra[m], sign * f[m], 1e-12);
  NEAR("energy", p[1], contact[9] + contact[24], 1e-13);
  NEAR("energy of LAMMPS", *(double *)lammps_extract_compute(lmp, "e", 0, LMP_TYPE_SCALAR), p[1], 1e-13);
  const int columns[] = {17, 16, 18, 19, 20, 21}; /* f_t, couple, gamma, gamma_pl, alpha, slides */
  for (int m = 0; m < 6; m++) NEAR("extra", extra[3 + m], contact[columns[m]], 1e-12);
  gh_lmp_close(&lmp);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(increments_by_hand), TEST(increments_by_time_step), TEST(opening),
                                     TEST(history_taken_away), TEST(single_contacts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
