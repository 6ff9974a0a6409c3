/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Wrong use of pair style granhom/coulomb, hybrids, restart files. */
#include "coulomb_help.h"

#include <lammps/library.h>
#include <unistd.h>

/* Wrong use ends in messages that say what is wrong. */
static void wrong_use(void **state) {
  gh_context *ctx = *state;
  static const char *const wrong[][2] = {
      {"pair_style granhom/coulomb increment", "no value for increment"},
      {"pair_style granhom/coulomb increment often", "increment is manual or step, not often"},
      {"pair_style granhom/coulomb slip wet", "slip is projected or objective, not wet"},
      {"pair_style granhom/coulomb hardening half", "hardening is printed or proportional, not half"},
      {"pair_style granhom/coulomb speed 3", "unknown keyword speed"},
      {"pair_coeff * * 100", "pair_coeff I J E_n E_t mu h"},
      {"pair_coeff * * -1 80 0.3 0",
       "Normal stiffness of pair granhom/coulomb must be positive and finite, not -1"},
      {"pair_coeff * * 100 0 0.3 0",
       "Tangential stiffness of pair granhom/coulomb must be positive and finite, not 0"},
      {"pair_coeff * * 100 80 -0.3 0",
       "Friction coefficient of pair granhom/coulomb must be finite and not negative, but is -0.3"},
      {"pair_coeff * * 100 80 0.3 -2",
       "Hardening of pair granhom/coulomb must be finite and not negative, but is -2"},
      {"fix h all granhom/history", "made by pair style granhom/coulomb"},
      {"compute w second granhom/stress", "wants the group all"},
      {"compute w all granhom/tangent x", "takes no arguments"},
      {"run_style respa 2 2\nrun 0", "does not run with run_style respa"},
      {"run 0\ngroup first id 1\ndelete_atoms group first compress no\nfix_modify granhom_history commit yes",
       "use run 0 before commit yes"},
      {"run 0\nfix_modify granhom_history commit no", "takes commit yes"},
      {"minimize 0 0 1 1", "use fix granhom/relax"},
      {"fix r all granhom/relax inner yes\nrun 1", "requires granhom/coulomb with increment manual"},
      {"fix r all granhom/relax inner maybe", "inner is yes or no, not maybe"},
  };
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    void *lmp = two_disks(ctx, "", "100 80 0.3 0", (double[2]){1.48, 0});
    char text[300], *line = text, *rest;
    gh_status status = GH_OK;
    snprintf(text, sizeof text, "%s", wrong[k][0]);
    for (; line && status == GH_OK; line = rest) {
      rest = strchr(line, '\n');
      if (rest) *rest++ = 0;
      status = gh_lmp_command(ctx, lmp, "%s", line);
    }
    FAILS(status, GH_ENGINE, wrong[k][1]);
    gh_lmp_close(&lmp);
  }
}

/* What the pair style cannot do is refused: newton on, three dimensions, no radii; a compute from before the
 * pair style, which has another number of columns. */
static void wrong_simulation(void **state) {
  gh_context *ctx = *state;
  static const char *const wrong[][4] = {
      {"dimension 2", "atom_style sphere", "newton on", "requires newton off"},
      {"dimension 3", "atom_style sphere", "newton off", "requires a 2d simulation"},
      {"dimension 2", "atom_style atomic", "newton off", "requires atom style sphere"},
      {"dimension 2", "atom_style sphere", "newton off", "must be defined after the pair style"}};
  static const char *const rest[] = {"region r block 0 9 0 8 -1 1", "create_box 1 r",
                                     "create_atoms 1 single 1 1 0", NULL};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    void *lmp;
    OK(gh_lmp_open(ctx, &lmp));
    for (int line = 0; line < 3; line++) command(ctx, lmp, wrong[k][line]);
    commands(ctx, lmp, rest);
    if (k == 2) command(ctx, lmp, "mass 1 1");
    if (k == 3) command(ctx, lmp, "compute c all granhom/contact/local");
    command(ctx, lmp, "pair_style granhom/coulomb");
    command(ctx, lmp, "pair_coeff * * 100 80 0.3 0");
    FAILS(gh_lmp_command(ctx, lmp, "run 0"), GH_ENGINE, wrong[k][3]);
    gh_lmp_close(&lmp);
  }
}

/* A hybrid may have one of the two pair styles, not both: computes and the relaxation would see half the
 * contacts. */
static void hybrids(void **state) {
  gh_context *ctx = *state;
  static const char *const lines[] = {"dimension 2",
                                      "atom_style sphere",
                                      "newton off",
                                      "region r block 0 9 0 8 -1 1",
                                      "create_box 2 r",
                                      "create_atoms 1 single 1 1 0",
                                      "create_atoms 2 single 1.95 1 0",
                                      "neighbor 0.3 bin",
                                      NULL};
  for (int both = 0; both < 2; both++) {
    void *lmp;
    OK(gh_lmp_open(ctx, &lmp));
    commands(ctx, lmp, lines);
    command(ctx, lmp,
            both ? "pair_style hybrid granhom/coulomb granhom/normal"
                 : "pair_style hybrid granhom/coulomb zero 2");
    command(ctx, lmp, both ? "pair_coeff 1 1 granhom/normal 100" : "pair_coeff 1 1 zero");
    command(ctx, lmp, both ? "pair_coeff 2 2 granhom/normal 100" : "pair_coeff 2 2 zero");
    command(ctx, lmp, "pair_coeff 1 2 granhom/coulomb 100 80 0.3 0");
    command(ctx, lmp, "fix h all viscous 0");
    if (both) {
      FAILS(gh_lmp_command(ctx, lmp, "compute s all granhom/stress\n"), GH_OK, "");
      FAILS(gh_lmp_command(ctx, lmp, "run 0"), GH_ENGINE, "has 1 granhom/normal and 1 granhom/coulomb");
    } else {
      command(ctx, lmp, "compute s all granhom/stress");
      command(ctx, lmp, "run 0");
      const double *stress = lammps_extract_compute(lmp, "s", 0, LMP_TYPE_VECTOR);
      NEAR("stress", stress[0], -100 * 0.05 * 0.95 / 72, 1e-13);
    }
    gh_lmp_close(&lmp);
  }
}

/* Restart files: with the same law they continue, with another law or style they are refused. */
static void restarts(void **state) {
  gh_context *ctx = *state;
  static const struct {
    const char *line, *words;
  } scripts[] = {
      {NULL, NULL},
      {"pair_style granhom/coulomb increment manual", NULL},
      {"pair_coeff * * 100 80 0.3 10", NULL},
      {"pair_coeff * * 100 80 0.2 10", "other coefficients of the types 1 and 1"},
      {"pair_style granhom/coulomb slip objective", "with slip projected, the script states objective"},
      {"pair_style granhom/coulomb hardening proportional",
       "with hardening printed, the script states proportional"},
      {"pair_style granhom/coulomb rotations fixed", "with rotations free, the script states fixed"},
      {"pair_style granhom/normal\npair_coeff * * 100", "granhom/normal would drop"}};
  char file[] = "/tmp/granhom-restart-XXXXXX";
  const int handle = mkstemp(file);
  assert_true(handle >= 0);
  close(handle);
  double f[6], g[6];
  void *lmp = two_disks(ctx, "increment step", "100 80 0.3 10", (double[2]){1.48, 0});
  double **w;
  OK(gh_lmp_atom(ctx, lmp, "omega", &w));
  w[0][2] = 2;
  command(ctx, lmp, "run 7 post no");
  OK(gh_lmp_command(ctx, lmp, "write_restart %s", file));
  command(ctx, lmp, "run 0 post no");
  forces(ctx, lmp, 2, f);
  assert_true(fabs(f[2]) > 0.1);
  gh_lmp_close(&lmp);
  for (size_t k = 0; k < sizeof scripts / sizeof *scripts; k++) {
    OK(gh_lmp_open(ctx, &lmp));
    command(ctx, lmp, "newton off");
    OK(gh_lmp_command(ctx, lmp, "read_restart %s", file));
    char text[200];
    snprintf(text, sizeof text, "%s", scripts[k].line ? scripts[k].line : "");
    char *rest = strchr(text, '\n');
    if (rest) *rest++ = 0;
    if (*text) command(ctx, lmp, text);
    if (rest) command(ctx, lmp, rest);
    if (scripts[k].words) FAILS(gh_lmp_command(ctx, lmp, "run 0 post no"), GH_ENGINE, scripts[k].words);
    else {
      command(ctx, lmp, "run 0 post no");
      forces(ctx, lmp, 2, g);
      assert_memory_equal(f, g, sizeof f);
    }
    gh_lmp_close(&lmp);
  }
  unlink(file);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(wrong_use), TEST(wrong_simulation), TEST(hybrids), TEST(restarts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
