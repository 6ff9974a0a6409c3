/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The styles without friction in LAMMPS's own hands, and LAMMPS's errors as messages. */
#include "lammps_help.h"

#include <lammps/library.h>

/* Errors of LAMMPS come back as its own message, and the process lives on. */
static void errors_become_messages(void **state) {
  (void)state;
  static const char *const wrong[][2] = {
      {"bogus 1 2", "Unknown command"},
      {"units furlong", "(src/update.cpp:"},
      {"pair_style no/such/style", "Unrecognized pair style"},
      {"pair_style granhom/normal 3", "no arguments"},
      {"run 1", "before simulation box"},
      {"variable a equal 1/0\nprint $a", "Divide by 0"},
  };
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    void *lmp;
    char line[200], *rest;
    OK(gh_lmp_open(ctx, &lmp));
    snprintf(line, sizeof line, "%s", wrong[k][0]);
    rest = strchr(line, '\n');
    if (rest) {
      *rest++ = 0;
      OK(gh_lmp_command(ctx, lmp, "%s", line));
    }
    assert_int_equal(gh_lmp_command(ctx, lmp, "%s", rest ? rest : line), GH_ENGINE);
    if (!strstr(gh_message(ctx), wrong[k][1])) fail_msg("no \"%s\" in: %s", wrong[k][1], gh_message(ctx));
    gh_lmp_close(&lmp);
    assert_null(lmp);
  }
}

/* A random 3D packing of 60 spheres of two types; newton on or off. */
static void *open_3d(const char *newton, bool tilted) {
  void *lmp;
  uint64_t seed = 99;
  int id[60], type[60];
  double x[180], *radius;
  OK(gh_lmp_open(ctx, &lmp));
  OK(gh_lmp_command(ctx, lmp, "atom_style sphere"));
  OK(gh_lmp_command(ctx, lmp, "newton %s", newton));
  OK(gh_lmp_command(ctx, lmp, "box tilt large"));
  OK(gh_lmp_command(ctx, lmp,
                    tilted ? "region r prism 0 4 0 4 0 3 1 0.5 -0.7" : "region r block 0 4 0 4 0 3"));
  OK(gh_lmp_command(ctx, lmp, "create_box 2 r"));
  for (int i = 0; i < 60; i++) {
    id[i] = i + 1;
    type[i] = 1 + i % 2;
    double s[3] = {uniform(&seed), uniform(&seed), uniform(&seed)};
    x[3 * i] = 4 * s[0] + (tilted ? 1 * s[1] + 0.5 * s[2] : 0);
    x[3 * i + 1] = 4 * s[1] - (tilted ? 0.7 * s[2] : 0);
    x[3 * i + 2] = 3 * s[2];
  }
  OK(gh_lmp_create_atoms(ctx, lmp, 60, id, type, x));
  OK(gh_lmp_atom(ctx, lmp, "radius", &radius));
  for (int i = 0; i < 60; i++) radius[i] = type[i] == 1 ? 0.5 : 0.35;
  OK(gh_lmp_command(ctx, lmp, "neighbor 0.1 bin"));
  OK(gh_lmp_command(ctx, lmp, "pair_style granhom/normal"));
  OK(gh_lmp_command(ctx, lmp, "pair_coeff 1 1 40"));
  OK(gh_lmp_command(ctx, lmp, "pair_coeff 2 2 60"));
  OK(gh_lmp_command(ctx, lmp, "compute c all granhom/contact/local"));
  return lmp;
}

/* A vector or scalar of a compute, as LAMMPS's library hands it out. */
static const double *global_data(void *lmp, const char *id, int type) {
  const double *data = lammps_extract_compute(lmp, id, LMP_STYLE_GLOBAL, type);
  assert_non_null(data);
  return data;
}

/* What a row states of itself: force, energy and trace of the second derivative from overlap and distance. */
static void assert_row(const double *row) {
  int a = (int)row[0], b = (int)row[1];
  double E = a % 2 && b % 2 ? 40 : a % 2 || b % 2 ? 50 : 60; /* odd ids are of type 1; mixed: the mean */
  double d = sqrt(row[2] * row[2] + row[3] * row[3] + row[4] * row[4]), e = row[8];
  assert_true(a <= b);
  for (int m = 0; m < 3; m++) assert_near(row[5 + m], -E * e * row[2 + m] / d, 1e-11);
  assert_near(row[9], E * e * e / 2, 1e-11);
  assert_near(row[10] + row[13] + row[15], E * (1 - 2 * e / d), 1e-9);
}

/* 3D, newton on and off, box straight and tilted: the rows' forces add up to the atoms' forces, their
 * energies and virials to LAMMPS's energy and pressure tensor, and the compute's own totals say the same. */
static void compute_sums_3d(void **state) {
  (void)state;
  static const int pair_of[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < 4; k++) {
    void *lmp = open_3d(k % 2 ? "on" : "off", k / 2);
    int count, *tag;
    double **rows, **f, sum[61][3] = {{0}}, energy = 0, virial[6] = {0};
    OK(gh_lmp_command(ctx, lmp, "compute e all pe"));
    OK(gh_lmp_command(ctx, lmp, "compute p all pressure NULL virial"));
    OK(gh_lmp_command(ctx, lmp, "thermo_style custom step c_e c_p[1]"));
    OK(gh_lmp_command(ctx, lmp, "fix r all granhom/relax"));
    OK(gh_lmp_command(ctx, lmp, "run 0 post no"));
    OK(gh_lmp_local(ctx, lmp, "c", &count, &rows));
    OK(gh_lmp_atom(ctx, lmp, "f", &f));
    OK(gh_lmp_atom(ctx, lmp, "id", &tag));
    assert_true(count > 30);
    for (int r = 0; r < count; r++) {
      assert_row(rows[r]);
      energy += rows[r][9];
      for (int m = 0; m < 3; m++) {
        sum[(int)rows[r][0]][m] += rows[r][5 + m];
        sum[(int)rows[r][1]][m] -= rows[r][5 + m];
      }
      for (int m = 0; m < 6; m++) virial[m] -= rows[r][2 + pair_of[m][0]] * rows[r][5 + pair_of[m][1]];
    }
    for (int i = 0; i < 60; i++)
      for (int m = 0; m < 3; m++) assert_near(f[i][m], sum[tag[i]][m], 1e-10);
    assert_near(*global_data(lmp, "e", LMP_TYPE_SCALAR), energy, 1e-11 * energy);
    for (int m = 0; m < 6; m++) {
      assert_near(global_data(lmp, "p", LMP_TYPE_VECTOR)[m], virial[m] / 48, 1e-11 * fabs(virial[0]));
      assert_near(global_data(lmp, "c", LMP_TYPE_VECTOR)[m], -virial[m] / 48, 1e-11 * fabs(virial[0]));
    }
    assert_near(global_data(lmp, "c", LMP_TYPE_VECTOR)[6], energy, 1e-11 * energy);
    assert_near(global_data(lmp, "c", LMP_TYPE_VECTOR)[7], count, 0);
    gh_lmp_close(&lmp);
  }
}

/* The compute refuses to read a list that is out of date: before any run, and after the box has changed. */
static void compute_refuses_stale_lists(void **state) {
  (void)state;
  void *lmp = open_3d("off", false);
  int count, again;
  double **rows;
  assert_int_equal(gh_lmp_local(ctx, lmp, "c", &count, &rows), GH_ENGINE);
  assert_non_null(strstr(gh_message(ctx), "run 0"));
  OK(gh_lmp_command(ctx, lmp, "fix r all granhom/relax"));
  OK(gh_lmp_command(ctx, lmp, "run 0 post no"));
  OK(gh_lmp_local(ctx, lmp, "c", &count, &rows));
  OK(gh_lmp_command(ctx, lmp, "change_box all x scale 0.9 remap"));
  OK(gh_lmp_command(ctx, lmp, "reset_timestep 1"));
  assert_int_equal(gh_lmp_local(ctx, lmp, "c", &again, &rows), GH_ENGINE);
  assert_non_null(strstr(gh_message(ctx), "run 0"));
  OK(gh_lmp_command(ctx, lmp, "run 0 post no"));
  OK(gh_lmp_local(ctx, lmp, "c", &again, &rows));
  assert_true(again > count);
  assert_int_equal(gh_lmp_local(ctx, lmp, "nothing", &again, &rows), GH_ENGINE);
  gh_lmp_close(&lmp);
}

/* fix granhom/relax in a plain script relaxes 3D packings to its tolerance and ends the run by itself. */
static void relax_3d(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    void *lmp = open_3d(k ? "on" : "off", true);
    double residual, ended, mean, **f;
    OK(gh_lmp_command(ctx, lmp, "set type 1 diameter 1.3")); /* jammed */
    OK(gh_lmp_command(ctx, lmp, "set type 2 diameter 1.0"));
    OK(gh_lmp_command(ctx, lmp, "neigh_modify every 1 delay 0 check yes"));
    OK(gh_lmp_command(ctx, lmp, "fix r all granhom/relax tolerance 1e-9"));
    OK(gh_lmp_command(ctx, lmp, "run 200000"));
    OK(gh_lmp_fix_vector(ctx, lmp, "r", 0, &residual));
    OK(gh_lmp_fix_vector(ctx, lmp, "r", 1, &mean));
    OK(gh_lmp_fix_vector(ctx, lmp, "r", 4, &ended));
    assert_true(ended == 1 || ended == 2);
    assert_true(residual <= 1e-9);
    OK(gh_lmp_atom(ctx, lmp, "f", &f));
    for (int i = 0; i < 60; i++)
      assert_true(sqrt(f[i][0] * f[i][0] + f[i][1] * f[i][1] + f[i][2] * f[i][2]) <= 1.001e-9 * mean);
    OK(gh_lmp_command(ctx, lmp, "run 10 pre no")); /* thermo output with energies: they were tallied */
    gh_lmp_close(&lmp);
  }
}

/* Wrong arguments of the styles end in messages that name them. */
static void wrong_arguments(void **state) {
  (void)state;
  static const char *const wrong[][2] = {
      {"pair_coeff 1 1", "pair_coeff I J E"},
      {"pair_coeff 1 1 -5", "positive and finite, not -5"},
      {"pair_coeff 1 1 0", "positive and finite, not 0"},
      {"pair_coeff 1 1 inf", "inf"},
      {"pair_coeff 1 9 1", "9"},
      {"fix r all granhom/relax tolerance", "no value for tolerance"},
      {"fix r all granhom/relax tolerance -1", "not -1"},
      {"fix r all granhom/relax max_steps 0", "not 0"},
      {"fix r all granhom/relax inner maybe", "not maybe"},
      {"fix r all granhom/relax inner yes", "2d"},
      {"fix r all granhom/relax method cg", "method is damped or fire, not cg"},
      {"fix r all granhom/relax method fire", "method fire requires inner yes"},
      {"fix r all granhom/relax speed 3", "unknown keyword speed"},
      {"compute d all granhom/contact/local x", "no arguments"},
  };
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    void *lmp = open_3d("off", false);
    assert_int_equal(gh_lmp_command(ctx, lmp, "%s", wrong[k][0]), GH_ENGINE);
    if (!strstr(gh_message(ctx), wrong[k][1])) fail_msg("no \"%s\" in: %s", wrong[k][1], gh_message(ctx));
    gh_lmp_close(&lmp);
  }
}

/* The styles are there again after `clear`. */
static void styles_after_clear(void **state) {
  (void)state;
  void *lmp = open_3d("off", false);
  OK(gh_lmp_command(ctx, lmp, "clear"));
  OK(gh_lmp_command(ctx, lmp, "atom_style sphere"));
  OK(gh_lmp_command(ctx, lmp, "region r block 0 1 0 1 0 1"));
  OK(gh_lmp_command(ctx, lmp, "create_box 1 r"));
  OK(gh_lmp_command(ctx, lmp, "pair_style granhom/normal"));
  OK(gh_lmp_command(ctx, lmp, "fix r all granhom/relax"));
  OK(gh_lmp_command(ctx, lmp, "compute c all granhom/contact/local"));
  gh_lmp_close(&lmp);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(errors_become_messages),
                                     cmocka_unit_test(compute_sums_3d),
                                     cmocka_unit_test(compute_refuses_stale_lists),
                                     cmocka_unit_test(relax_3d),
                                     cmocka_unit_test(wrong_arguments),
                                     cmocka_unit_test(styles_after_clear)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
