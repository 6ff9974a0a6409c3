/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The reference cases for one RVE, frictionless and with friction, made by an independent program
 * (tests/data/cases).
 * GH_ENGINE=native|lammps restricts the run to
 * one engine. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "granhom/io.h"
#include "granhom/micro.h"

#define CASES "tests/data/cases/"

typedef struct rve_case {
  const char *name, *packing, *path;
  gh_boundary boundary;
  double tolerance;
  double friction_angle, hardening; /* degrees; angle 0: frictionless */
  gh_engine_kind engine;
} rve_case;

static const rve_case cases[] = {
    {"uniax2_taylor_p150", "p150", "uniax2_20", GH_TAYLOR, 1e-10, 0, 0, GH_ENGINE_NATIVE},
    {"uniax2_taylor_periodic_p150", "p150", "uniax2_20", GH_TAYLOR_CELL, 1e-10, 0, 0, GH_ENGINE_NATIVE},
    {"uniax2_restricted_p150", "p150", "uniax2_20", GH_RESTRICTED, 1e-8, 0, 0, GH_ENGINE_NATIVE},
    {"uniax05_periodic_p150d", "p150d", "uniax05_50", GH_PERIODIC, 1e-8, 0, 0, GH_ENGINE_NATIVE},
    {"biaxshear_periodic_p50", "p50", "biax1_shear5", GH_PERIODIC, 1e-8, 0, 0, GH_ENGINE_NATIVE},
    {"biaxshear_restricted_p50", "p50", "biax1_shear5", GH_RESTRICTED, 1e-8, 0, 0, GH_ENGINE_NATIVE},
    {"stretchrot_taylor_p50", "p50", "stretch_rot30", GH_TAYLOR, 1e-10, 0, 0, GH_ENGINE_NATIVE},
    {"stretchrotfine_periodic_p50", "p50", "stretch_rot30_fine", GH_PERIODIC, 1e-8, 0, 0, GH_ENGINE_NATIVE},
    {"uniaxfric20_taylor_p150", "p150", "uniax10_100", GH_TAYLOR, 1e-8, 20, 0, GH_ENGINE_NATIVE},
    {"uniaxfric20_taylorperiodic_p150", "p150", "uniax10_100", GH_TAYLOR_CELL, 1e-8, 20, 0, GH_ENGINE_NATIVE},
    {"cyclicfric_h0_taylor_p150", "p150", "cyclic_shear50_400", GH_TAYLOR, 1e-8, 30, 0, GH_ENGINE_NATIVE},
    {"cyclicfric_h1000_taylor_p150", "p150", "cyclic_shear50_400", GH_TAYLOR, 1e-8, 30, 1000,
     GH_ENGINE_NATIVE},
    {"cyclefric05_periodic_p50d", "p50d", "fric_small_cycle", GH_PERIODIC, 1e-7, 5, 0, GH_ENGINE_NATIVE},
    {"cyclefric20_restricted_p50d", "p50d", "fric_small_cycle", GH_RESTRICTED, 1e-7, 20, 0, GH_ENGINE_NATIVE},
    {"uniaxfric20_restricted_p50", "p50", "uniax05_50", GH_RESTRICTED, 1e-7, 20, 0, GH_ENGINE_NATIVE},
    {"shearcyclefric30_taylor_p20", "p20", "cyclic_fric_steps10", GH_TAYLOR, 1e-8, 30, 100, GH_ENGINE_NATIVE},
};
enum { NCASES = sizeof cases / sizeof *cases };

#define OK(call) assert_ok(ctx, call, __FILE__, __LINE__)
static void assert_ok(gh_context *ctx, gh_status s, const char *file, int line) {
  if (s == GH_OK) return;
  print_error("%s\n", gh_message(ctx));
  _fail(file, line);
}

static gh_csv *read_csv(gh_context *ctx, const char *folder, const char *name) {
  char path[256];
  gh_csv *csv;
  snprintf(path, sizeof path, CASES "%s/%s.csv", folder, name);
  OK(gh_csv_read(ctx, path, &csv));
  return csv;
}

static double at(const gh_csv *csv, int row, const char *name) {
  int c = gh_csv_find(csv, name);
  assert_true(c >= 0);
  return csv->value[row * csv->ncols + c];
}

/* Largest |A| of a tangent in tangents.csv and the values; false when this step of the case has none. */
static bool reference_tangent(const char *name, int step, double A[16]) {
  char line[2048];
  FILE *f = fopen(CASES "tangents.csv", "r");
  assert_non_null(f);
  bool found = false;
  while (!found && fgets(line, sizeof line, f)) {
    char *word = strtok(line, ",");
    if (strcmp(word, name) || atoi(strtok(NULL, ",")) != step) continue;
    for (int k = 0; k < 4; k++) strtok(NULL, ","); /* bc, friction, contacts, slipping */
    for (int k = 0; k < 16; k++) A[k] = atof(strtok(NULL, ","));
    found = true;
  }
  fclose(f);
  return found;
}

static void compare_tangent(const char *name, int step, const double A[16]) {
  double R[16], largest = 0, worst = 0;
  if (!reference_tangent(name, step, R)) return;
  for (int k = 0; k < 16; k++) largest = fmax(largest, fabs(R[k]));
  for (int k = 0; k < 16; k++) worst = fmax(worst, fabs(A[k] - R[k]));
  print_message("  tangent at step %d: %.1e of the largest component\n", step, worst / largest);
  assert_true(worst <= 1e-6 * largest);
}

/* What is stored and dissipated relative to the largest energy of the path, and the number of sliding
 * contacts (which a contact at the limit may change by one). */
static void compare_energies(const gh_rve_measures *m, const gh_csv *out, int row, bool friction) {
  double scale = 1e-6 * at(out, out->nrows - 1, "energy");
  assert_true(fabs(m->energy - m->energy_t - at(out, row, "energy_n")) <= scale);
  if (!friction) return;
  assert_true(fabs(m->energy_t - at(out, row, "energy_t")) <= scale);
  assert_true(fabs(m->dissipation - at(out, row, "dissipation")) <= scale);
  assert_true(fabs(m->sliding - at(out, row, "slipping")) <= 1);
}

/* Stresses of a whole path, and tangents where the reference has them, agree with the independent program. */
static void case_is_met(void **state) {
  const rve_case *c = *state;
  const char *only = getenv("GH_ENGINE");
  if (only && strcmp(only, c->engine == GH_ENGINE_NATIVE ? "native" : "lammps")) skip();
  static const char *const P_names[] = {"P11", "P12", "P21", "P22"}, *const s_names[] = {"s11", "s12", "s21",
                                                                                         "s22"};
  gh_context *ctx;
  gh_packing *packing;
  gh_rve *rve;
  char path[256];
  assert_int_equal(gh_context_create(&ctx), GH_OK);
  gh_csv *in = read_csv(ctx, "paths", c->path), *out = read_csv(ctx, "expected", c->name);
  snprintf(path, sizeof path, CASES "packings/%s.data", c->packing);
  OK(gh_packing_read(ctx, path, &packing));
  gh_rve_options o = gh_rve_defaults();
  o.boundary = c->boundary, o.engine = c->engine, o.law.normal_stiffness = 1000, o.tolerance = 1e-11;
  o.integration = GH_INTEGRATION_WHOLE; /* the law that the cases were made with */
  if (c->friction_angle > 0) {
    o.law.friction = 1, o.law.tangential_stiffness = 1000, o.law.hardening = c->hardening;
    o.law.friction_coefficient = tan(c->friction_angle * acos(-1) / 180);
  }
  OK(gh_rve_create(ctx, packing, &o, &rve));
  double largest = 0, worst = 0;
  int worst_row = 0;
  assert_int_equal(in->nrows, out->nrows);
  for (int row = 0; row < out->nrows; row++)
    for (int k = 0; k < 4; k++) largest = fmax(largest, fabs(at(out, row, P_names[k])));
  for (int row = 0; row < in->nrows; row++) {
    double F[4] = {at(in, row, "F11"), at(in, row, "F12"), at(in, row, "F21"), at(in, row, "F22")}, P[4],
           A[16];
    OK(gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A));
    const gh_rve_measures *m = gh_rve_measure(rve);
    for (int k = 0; k < 4; k++) {
      double d = fmax(fabs(P[k] - at(out, row, P_names[k])), fabs(m->cauchy[k] - at(out, row, s_names[k])));
      if (d > worst) worst = d, worst_row = row;
    }
    if (getenv("GH_VERBOSE"))
      print_message("  row %d: %.1e  residual %.1e steps %ld Newton-finished %d factorisations %d contacts "
                    "%d rattlers %d\n",
                    row, worst / largest, m->residual, m->steps, m->polished, m->factorisations, m->contacts,
                    m->rattlers);
    compare_energies(m, out, row, c->friction_angle > 0);
    compare_tangent(c->name, row, A);
    OK(gh_rve_commit(rve));
  }
  gh_rve_cost cost;
  gh_rve_costs(rve, &cost);
  print_message("  %s: %.1e of the largest stress (row %d); %.2f ms and %.0f relaxation steps an increment\n",
                c->name, worst / largest, worst_row, 1e3 * cost.total / in->nrows,
                (double)cost.steps / in->nrows);
  assert_true(worst <= c->tolerance * largest);
  gh_rve_destroy(&rve);
  gh_packing_destroy(&packing);
  gh_csv_destroy(&in);
  gh_csv_destroy(&out);
  gh_context_destroy(&ctx);
}

int main(void) {
  static struct CMUnitTest tests[2 * NCASES];
  static rve_case states[2 * NCASES];
  static char names[2 * NCASES][64];
  for (int k = 0; k < 2 * NCASES; k++) {
    states[k] = cases[k % NCASES];
    if (k >= NCASES) states[k].engine = GH_ENGINE_LAMMPS;
    snprintf(names[k], sizeof names[k], "%s_%s", states[k].name, k >= NCASES ? "lammps" : "native");
    tests[k] = (struct CMUnitTest){names[k], case_is_met, NULL, NULL, &states[k]};
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
