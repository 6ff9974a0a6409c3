/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The parts of results and report that have closed forms: density functions, anisotropy, nodal averages,
 * tables, dumps that grow by whole frames. */
#include "../help.h"

#include "report/report.h"
#include "results/results.h"
#include "scene/output.h"

#include <sys/stat.h>
#include <unistd.h>

/* ---- density functions ---- */

enum { M = 360 };

static double mean(const double *f) {
  double sum = 0;
  for (int k = 0; k < M; k++) sum += f[k];
  return sum / M;
}

/* Three directions 60 degrees apart, window 25 degrees: 180/(3 * 25) within 12.5 degrees of each, 0
 * elsewhere. */
static void hexagonal_lattice(void **state) {
  (void)state;
  double x[6], f[M];
  for (int k = 0; k < 3; k++)
    x[2 * k] = 3 * cos(help_pi * (0.1 + k / 3.0)), x[2 * k + 1] = 3 * sin(help_pi * (0.1 + k / 3.0));
  report_density(3, x, NULL, 25 * help_pi / 180, M, f);
  for (int k = 0; k < M; k++) {
    double off = fabs(remainder(k - 18.0, 60));
    NEAR("density", f[k], off < 12.4 ? 180 / 75.0 : 0, 1e-12);
  }
  NEAR("mean", mean(f), 1, 1e-12);
}

/* Weights 3 and 1 along x and y: 3/4 and 1/4 of the whole, each spread over 25 of 180 degrees. */
static void weights(void **state) {
  (void)state;
  double x[4] = {-2, 0, 0, 5}, w[2] = {3, 1}, f[M];
  report_density(2, x, w, 25 * help_pi / 180, M, f);
  NEAR("along x", f[0], 0.75 * 180 / 25, 1e-12);
  NEAR("opposite", f[180], f[0], 0);
  NEAR("along y", f[90], 0.25 * 180 / 25, 1e-12);
  NEAR("between", f[45], 0, 0);
}

static void even_distribution(void **state) {
  (void)state;
  enum { N = 1800 };
  double x[2 * N], f[M];
  for (int k = 0; k < N; k++)
    x[2 * k] = cos(help_pi * (k + 0.5) / N), x[2 * k + 1] = sin(help_pi * (k + 0.5) / N);
  report_density(N, x, NULL, 25 * help_pi / 180, M, f);
  for (int k = 0; k < M; k++) NEAR("density", f[k], 1, 1e-9);
  report_density(0, x, NULL, 1, M, f);
  NEAR("without directions", norm(f, M), 0, 0);
}

/* ---- numbers of a point ---- */

static double number(const char *name, const gh_rve_measures *m) {
  for (size_t k = 0; k < scene_number_count; k++)
    if (strcmp(scene_numbers[k].name, name) == 0) return scene_numbers[k].of(m);
  fail_msg("there is no number '%s'", name);
  return NAN;
}

/* A fabric with the principal values 0.7 and 0.3, the larger one at 25 degrees. */
static void anisotropy(void **state) {
  (void)state;
  double a = 25 * help_pi / 180, c = cos(a), s = sin(a);
  gh_rve_measures m = {.fabric = {0.7 * c * c + 0.3 * s * s, 0.4 * c * s, 0.7 * s * s + 0.3 * c * c},
                       .sliding = 4};
  NEAR("anisotropy", number("anisotropy", &m), 0.4, 1e-15);
  NEAR("angle", number("anisotropy_angle", &m), a, 1e-15);
  NEAR("sliding", number("sliding", &m), 4, 0);
  gh_rve_measures none = {0};
  NEAR("without contacts", number("anisotropy", &none), 0, 0);
  NEAR("angle without contacts", number("anisotropy_angle", &none), 0, 0);
}

/* A field that is linear over a mesh of rectangles comes back at the nodes as it is. */
static void nodal_average(void **state) {
  gh_context *ctx = *state;
  gh_mesh *mesh;
  OK(gh_mesh_rectangle(ctx, (double[]){-1, 2}, (double[]){6, 3}, (int[]){3, 2}, &mesh));
  double gauss[48], points[48], nodes[24];
  gh_mesh_gauss(mesh, gauss);
  for (int p = 0; p < 24; p++) {
    points[2 * p] = 1 + 2 * gauss[2 * p] - 3 * gauss[2 * p + 1];
    points[2 * p + 1] = gauss[2 * p + 1];
  }
  OK(gh_mesh_nodal_average(ctx, mesh, 2, points, nodes));
  for (int n = 0; n < mesh->nnodes; n++) {
    NEAR("first", nodes[2 * n], 1 + 2 * mesh->X[2 * n] - 3 * mesh->X[2 * n + 1], 1e-12);
    NEAR("second", nodes[2 * n + 1], mesh->X[2 * n + 1], 1e-12);
  }
  gh_mesh_destroy(&mesh);
}

/* ---- tables ---- */

static void write_file(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
}

/* A folder of its own, left empty by the test. */
static void make_folder(char path[64]) {
  strcpy(path, "/tmp/granhom_report_XXXXXX");
  assert_non_null(mkdtemp(path));
}

static void tables(void **state) {
  gh_context *ctx = *state;
  char folder[64], path[128];
  report_table t;
  make_folder(folder);
  snprintf(path, sizeof path, "%s/t.csv", folder);
  write_file(path, "step,name,x\n0,start,0.5\n1,a b,-2\n");
  OK(report_table_read(ctx, folder, "t.csv", &t));
  assert_int_equal(t.nrows, 2);
  assert_string_equal(report_table_text(&t, 1, report_table_column(&t, "name")), "a b");
  NEAR("x", report_table_number(&t, 1, report_table_column(&t, "x")), -2, 0);
  assert_true(isnan(report_table_number(&t, 1, 1)));
  assert_int_equal(report_table_column(&t, "nam"), -1);
  report_table_free(&t);
  static const struct {
    const char *text, *message;
  } bad[] = {{"step,name,x\n0,start,0.5\n1,a\n", "t.csv:3: has 2 fields, the header has 3"},
             {"step,name,x\n0,start,0.5\n1,a,0.", "t.csv: the last line is cut off"},
             {"step,name,x\n0,start,0.5,6\n", "t.csv:2: has 4 fields, the header has 3"},
             {"step,name,x\n", "t.csv: holds no increment"}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    write_file(path, bad[k].text);
    FAILS(report_table_read(ctx, folder, "t.csv", &t), GH_INPUT, bad[k].message);
    report_table_free(&t);
  }
  unlink(path);
  FAILS(report_table_read(ctx, folder, "t.csv", &t), GH_INPUT, "t.csv");
  report_table_free(&t);
  rmdir(folder);
}

/* ---- dumps ---- */

static char *read_file(const char *path) {
  FILE *file = fopen(path, "r");
  if (!file) return NULL;
  char *text = calloc(1, 1 << 20);
  assert_non_null(text);
  assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
  fclose(file);
  return text;
}

typedef struct bed {
  char folder[64], scene_path[128], dump[2][160];
  gh_scene *scene;
  gh_farm *farm;
} bed;

static void make_bed(gh_context *ctx, bed *b) {
  char text[2048], here[1024];
  make_folder(b->folder);
  assert_non_null(getcwd(here, sizeof here));
  snprintf(b->scene_path, sizeof b->scene_path, "%s/scene.yaml", b->folder);
  snprintf(b->dump[0], sizeof b->dump[0], "%s/dumps/point_2.dump", b->folder);
  snprintf(b->dump[1], sizeof b->dump[1], "%s/dumps/point_2.contacts.dump", b->folder);
  snprintf(
      text, sizeof text,
      "packing: %s/tests/data/cases/packings/p150.data\ncontact: {normal_stiffness: 50}\nmicro: {boundary: "
      "taylor-cell, engine: native}\nmesh: {rectangle: {size: [1, 1], elements: [1, 1]}}\nsupports: [{edge: "
      "left, fix: both}]\nsteps: [{increments: 1}]\nresults: {dump: [2]}\n",
      here);
  write_file(b->scene_path, text);
  OK(gh_scene_read(ctx, b->scene_path, &b->scene));
  OK(gh_farm_create_rves(ctx, 4, b->scene->packings[0], &b->scene->micro, &b->farm));
  double F[16], P[16];
  for (int k = 0; k < 16; k++) F[k] = (double[]){0.99, 0.002, 0.001, 0.985}[k % 4];
  OK(gh_farm_evaluate(b->farm, F, 0, P, NULL));
}

static void drop_bed(bed *b) {
  char path[128];
  gh_farm_destroy(&b->farm);
  gh_scene_destroy(&b->scene);
  unlink(b->dump[0]);
  unlink(b->dump[1]);
  unlink(b->scene_path);
  snprintf(path, sizeof path, "%s/dumps", b->folder);
  rmdir(path);
  rmdir(b->folder);
}

/* Writes the frames first ... last in the manner of one process. */
static void write_frames(gh_context *ctx, bed *b, int first, int last) {
  scene_output o;
  OK(scene_output_create(b->scene, b->farm, NULL, b->folder, &o));
  for (int k = first; k <= last; k++) {
    gh_frame f = {.counter = k, .name = ""};
    OK(results_write_dumps(o.results, &f));
  }
  scene_output_destroy(&o);
}

/* A process that is killed within a frame, or that continues from an earlier increment, leaves no trace. */
static void dumps_grow_by_whole_frames(void **state) {
  gh_context *ctx = *state;
  bed b;
  make_bed(ctx, &b);
  write_frames(ctx, &b, 0, 3);
  char *whole[2];
  for (int k = 0; k < 2; k++) {
    whole[k] = read_file(b.dump[k]);
    assert_non_null(whole[k]);
  }
  size_t length = strlen(whole[0]);
  for (size_t cut = 0; cut < length; cut += length / 23 + 1) { /* the grains' file was cut here */
    int frames = (int)(4 * cut / length);
    assert_int_equal(truncate(b.dump[0], (off_t)cut), 0);
    write_frames(ctx, &b, frames, 3);
    for (int k = 0; k < 2; k++) {
      char *again = read_file(b.dump[k]);
      assert_string_equal(again, whole[k]);
      free(again);
    }
  }
  write_frames(ctx, &b, 0, 0); /* a new run starts again */
  char *first = read_file(b.dump[0]);
  assert_int_equal(strlen(first), length / 4);
  free(first);
  for (int k = 0; k < 2; k++) free(whole[k]);
  drop_bed(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(hexagonal_lattice), TEST(weights), TEST(even_distribution),         TEST(anisotropy),
      TEST(nodal_average),     TEST(tables),  TEST(dumps_grow_by_whole_frames)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
