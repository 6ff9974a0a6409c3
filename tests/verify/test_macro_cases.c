/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The reference cases of the macro problem: blocks whose 36 or 64 integration points are packings of 150
 * grains.
 *
 * Data and source: tests/data/cases/macro/README.md (an independent program; agreement to 1e-8 of a column's
 * largest value). The macro problem is solved to 1e-11. */
#include "granhom/io.h"
#include "granhom/macro.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>
#include <cmocka.h>

static const char *const folder = "tests/data/cases/macro";
static const double agreement = 1e-8;

typedef struct problem {
  gh_context *ctx;
  cJSON *json;
  gh_packing *packing;
  gh_mesh *mesh;
  gh_farm *farm;
  gh_loads *loads;
  gh_macro *macro;
  gh_csv *steps, *nodes, *gauss;
  double *XG;
} problem;

static void check(problem *p, gh_status s) {
  if (s != GH_OK) fail_msg("%s", gh_message(p->ctx));
}

static const cJSON *get(const cJSON *object, const char *key) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
  if (!item) fail_msg("the case has no \"%s\"", key);
  return item;
}

static double number(const cJSON *array, int k) {
  return cJSON_GetArrayItem(array, k)->valuedouble;
}

static cJSON *read_json(const char *name) {
  char path[256], *text = calloc(1, 1 << 16);
  snprintf(path, sizeof path, "%s/%s.json", folder, name);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  assert_non_null(text);
  size_t got = fread(text, 1, (1 << 16) - 1, file);
  fclose(file);
  cJSON *json = cJSON_ParseWithLength(text, got);
  free(text);
  assert_non_null(json);
  return json;
}

static gh_csv *read_table(problem *p, const char *name, const char *what) {
  char path[256];
  gh_csv *csv;
  snprintf(path, sizeof path, "%s/%s_%s.csv", folder, name, what);
  check(p, gh_csv_read(p->ctx, path, &csv));
  return csv;
}

static void make_mesh(problem *p) {
  const cJSON *mesh = get(p->json, "mesh"), *size = get(mesh, "size"), *n = get(mesh, "n"), *move;
  const int elements[2] = {(int)number(n, 0), (int)number(n, 1)};
  check(p, gh_mesh_rectangle(p->ctx, (const double[2]){0, 0},
                             (const double[2]){number(size, 0), number(size, 1)}, elements, &p->mesh));
  cJSON_ArrayForEach(move, get(mesh, "move")) {
    int node = (int)number(move, 1) * (elements[0] + 1) + (int)number(move, 0);
    for (int i = 0; i < 2; i++) p->mesh->X[2 * node + i] += number(move, 2 + i);
  }
}

static void make_problem(problem *p, gh_context *ctx, const char *name) {
  *p = (problem){.ctx = ctx, .json = read_json(name)};
  const cJSON *rve = get(p->json, "rve");
  char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, get(rve, "packing")->valuestring);
  check(p, gh_packing_read(ctx, path, &p->packing));
  make_mesh(p);
  gh_rve_options options = gh_rve_defaults();
  options.engine = GH_ENGINE_NATIVE;
  options.tolerance = 1e-11;
  options.law.normal_stiffness = get(get(rve, "params"), "En")->valuedouble;
  assert_true(gh_boundary_from_name(get(rve, "bc")->valuestring, &options.boundary));
  check(p, gh_farm_create_rves(ctx, 4 * p->mesh->nelements, p->packing, &options, &p->farm));
  check(p, gh_loads_create(ctx, p->mesh, &p->loads));
  gh_macro_options solver = gh_macro_defaults();
  solver.tolerance = 1e-11;
  check(p, gh_macro_create(ctx, p->mesh, p->farm, &solver, &p->macro));
  p->steps = read_table(p, name, "steps");
  p->nodes = read_table(p, name, "nodes");
  p->gauss = read_table(p, name, "gauss");
  p->XG = calloc(8 * (size_t)p->mesh->nelements, sizeof *p->XG);
  assert_non_null(p->XG);
  gh_mesh_gauss(p->mesh, p->XG);
}

static void drop_problem(problem *p) {
  gh_macro_destroy(&p->macro);
  gh_loads_destroy(&p->loads);
  gh_farm_destroy(&p->farm);
  gh_mesh_destroy(&p->mesh);
  gh_packing_destroy(&p->packing);
  gh_csv_destroy(&p->steps);
  gh_csv_destroy(&p->nodes);
  gh_csv_destroy(&p->gauss);
  cJSON_Delete(p->json);
  free(p->XG);
}

static double largest(const gh_csv *csv, int column) {
  double value = 0;
  for (int r = 0; r < csv->nrows; r++) value = fmax(value, fabs(csv->value[r * csv->ncols + column]));
  return value;
}

/* Columns that hold nothing but round-off (reactions that vanish) are measured by `least`. */
static void compare(const gh_csv *csv, int row, const char *name, double value, double least) {
  int column = gh_csv_find(csv, name);
  assert_true(column >= 0);
  double expected = csv->value[row * csv->ncols + column], scale = fmax(largest(csv, column), least);
  if (!(fabs(value - expected) <= agreement * scale))
    fail_msg("row %d, %s: %.14g where %.14g is expected, off by %.2g of %g", row, name, value, expected,
             fabs(value - expected) / scale, scale);
}

/* Value of a support or load in a step: that of the table's column `by`; without one, zero. */
static double amount(const problem *p, const cJSON *item, int step) {
  const cJSON *by = cJSON_GetObjectItemCaseSensitive(item, "by"), *table = get(p->json, "table");
  const cJSON *columns = get(table, "columns");
  for (int c = 0; by && c < cJSON_GetArraySize(columns); c++)
    if (strcmp(cJSON_GetArrayItem(columns, c)->valuestring, by->valuestring) == 0)
      return number(cJSON_GetArrayItem(get(table, "rows"), step), c);
  assert_null(by);
  return 0;
}

static void apply_loads(problem *p, int step) {
  const cJSON *item;
  gh_loads_clear(p->loads);
  cJSON_ArrayForEach(item, get(p->json, "supports")) {
    int set = gh_mesh_find(p->mesh, get(item, "edge")->valuestring);
    check(p,
          gh_loads_displace(p->loads, set, get(item, "dir")->valuestring[0] == 'y', amount(p, item, step)));
  }
  cJSON_ArrayForEach(item, get(p->json, "loads")) {
    double value = amount(p, item, step);
    if (strcmp(get(item, "type")->valuestring, "gravity") == 0) {
      const cJSON *b = get(item, "b");
      check(p, gh_loads_gravity(p->loads, (const double[2]){value * number(b, 0), value * number(b, 1)}));
    } else {
      int set = gh_mesh_find(p->mesh, get(item, "edge")->valuestring);
      check(p, gh_loads_pressure(p->loads, set, value, cJSON_IsTrue(get(item, "follow"))));
    }
  }
}

static void compare_step(problem *p, int step) {
  static const char *const edges[] = {"bottom", "right", "top", "left"};
  double V, v;
  for (int k = 0; k < 4; k++)
    for (int i = 0; i < 2; i++) {
      double sum[2];
      char name[16];
      gh_macro_reaction(p->macro, gh_mesh_find(p->mesh, edges[k]), sum);
      snprintf(name, sizeof name, "%s_%c", edges[k], "xy"[i]);
      compare(p->steps, step, name, sum[i], 1e-3);
    }
  gh_macro_volumes(p->macro, &V, &v);
  compare(p->steps, step, "dilatancy", 100 * (v / V - 1), 0);
}

/* Place nearest to the reference coordinates that a row states; they are printed with 12 digits at least. */
static int find_place(const gh_csv *csv, int row, const double *x, int n) {
  const double *value = csv->value + (size_t)row * (size_t)csv->ncols;
  double X = value[gh_csv_find(csv, "X")], Y = value[gh_csv_find(csv, "Y")];
  for (int k = 0; k < n; k++)
    if (hypot(x[2 * k] - X, x[2 * k + 1] - Y) < 1e-6) return k;
  fail_msg("row %d: no node or point at (%g, %g)", row, X, Y);
  return -1;
}

static void compare_fields(problem *p, int step) {
  static const char *const F[] = {"F11", "F12", "F21", "F22"}, *const P[] = {"P11", "P12", "P21", "P22"};
  const gh_csv *nodes = p->nodes, *gauss = p->gauss;
  for (int r = 0; r < nodes->nrows; r++) {
    if ((int)nodes->value[r * nodes->ncols] != step) continue;
    int a = find_place(nodes, r, p->mesh->X, p->mesh->nnodes);
    compare(nodes, r, "ux", gh_macro_u(p->macro)[2 * a], 0);
    compare(nodes, r, "uy", gh_macro_u(p->macro)[2 * a + 1], 0);
  }
  for (int r = 0; r < gauss->nrows; r++) {
    if ((int)gauss->value[r * gauss->ncols] != step) continue;
    int q = find_place(gauss, r, p->XG, 4 * p->mesh->nelements);
    for (int k = 0; k < 4; k++) {
      compare(gauss, r, F[k], gh_macro_F(p->macro)[4 * q + k], 0);
      compare(gauss, r, P[k], gh_macro_P(p->macro)[4 * q + k], 0);
    }
  }
}

static void run_case(void **state, const char *name) {
  problem p;
  make_problem(&p, *state, name);
  int nsteps = cJSON_GetArraySize(get(get(p.json, "table"), "rows"));
  assert_int_equal(nsteps, p.steps->nrows);
  for (int step = 0; step < nsteps; step++) {
    gh_macro_report report;
    apply_loads(&p, step);
    check(&p, gh_macro_solve(p.macro, p.loads, &report));
    assert_true(report.cuts == 0 && report.jumps == 0);
    compare_step(&p, step);
    compare_fields(&p, step);
  }
  drop_problem(&p);
}

/* Dead side pressure, released from 0.22 to 0.2, then the top is lowered. */
static void test_block(void **state) {
  run_case(state, "block_taylor_p02");
}
/* The same from a side pressure of 0.01. */
static void test_block_from_zero(void **state) {
  run_case(state, "block_taylor_p02_fromzero");
}
/* A distorted mesh under follower pressure. */
static void test_block_distorted(void **state) {
  run_case(state, "block_taylor_p02_distorted");
}
/* Growing weight under a dead-load pressure. */
static void test_gravity(void **state) {
  run_case(state, "gravity_taylor");
}

static int make_context(void **state) {
  gh_context *ctx = NULL;
  int failed = gh_context_create(&ctx) != GH_OK;
  *state = ctx;
  return failed;
}

static int drop_context(void **state) {
  gh_context *ctx = *state;
  gh_context_destroy(&ctx);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_block),
      cmocka_unit_test(test_block_from_zero),
      cmocka_unit_test(test_block_distorted),
      cmocka_unit_test(test_gravity),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
