/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Meshes and Gmsh files. */
#include "granhom/macro.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/* cmocka's own compares as float. */
static void near_at(double a, double b, double limit, const char *file, int line) {
  if (fabs(a - b) <= limit) return;
  print_error("%.17g and %.17g differ by more than %g\n", a, b, limit);
  _fail(file, line);
}
#define assert_near(a, b, limit) near_at(a, b, limit, __FILE__, __LINE__)

static const char *const v22 = "tests/data/mesh/two_v22.msh", *const v41 = "tests/data/mesh/two_v41.msh";

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

/* For every edge of a set: the body's middle lies to its left. */
static void check_left(const gh_mesh *mesh, int set, double mx, double my) {
  const gh_mesh_set *s = mesh->sets + set;
  for (int k = 0; k < s->nedges; k++) {
    const double *a = mesh->X + 2 * s->edges[k][0], *b = mesh->X + 2 * s->edges[k][1];
    assert_true((b[0] - a[0]) * (my - a[1]) - (b[1] - a[1]) * (mx - a[0]) > 0);
  }
}

/* A rectangle has the nodes, quadrilaterals, sets and edge directions that its header states. */
static void test_rectangle(void **state) {
  gh_mesh *mesh;
  const double low[2] = {-1, 2}, size[2] = {6, 4};
  const int n[2] = {3, 2};
  assert_int_equal(gh_mesh_rectangle(*state, low, size, n, &mesh), GH_OK);
  assert_int_equal(mesh->nnodes, 12);
  assert_int_equal(mesh->nelements, 6);
  assert_near(mesh->X[2 * 11], 5, 1e-14);
  assert_near(mesh->X[2 * 11 + 1], 6, 1e-14);
  const char *const names[] = {"left", "right", "bottom", "top"};
  const int count[] = {3, 3, 4, 4};
  for (int k = 0; k < 4; k++) {
    int set = gh_mesh_find(mesh, names[k]);
    assert_true(set >= 0);
    assert_int_equal(mesh->sets[set].nnodes, count[k]);
    assert_int_equal(mesh->sets[set].nedges, count[k] - 1);
    check_left(mesh, set, 2, 4);
    for (int j = 1; j < count[k]; j++) assert_true(mesh->sets[set].nodes[j] > mesh->sets[set].nodes[j - 1]);
  }
  assert_int_equal(gh_mesh_find(mesh, "middle"), -1);
  gh_mesh_destroy(&mesh);
  assert_null(mesh);
}

/* Gauss points of the unit square lie at (1 -+ 1/sqrt 3)/2. */
static void test_gauss(void **state) {
  gh_mesh *mesh;
  const double low[2] = {0, 0}, size[2] = {1, 1};
  const int n[2] = {1, 1};
  assert_int_equal(gh_mesh_rectangle(*state, low, size, n, &mesh), GH_OK);
  double x[8], a = 0.5 - 0.5 / sqrt(3), b = 1 - a, expected[8] = {a, a, b, a, a, b, b, b};
  gh_mesh_gauss(mesh, x);
  for (int k = 0; k < 8; k++) assert_near(x[k], expected[k], 1e-15);
  gh_mesh_destroy(&mesh);
}

/* A rectangle without size or elements, or with numbers that are not finite, is refused. */
static void test_rectangle_refused(void **state) {
  gh_mesh *mesh;
  const double low[2] = {0, 0}, nowhere[2] = {NAN, 0}, flat[2] = {1, 0}, size[2] = {1, 1};
  const int n[2] = {1, 1}, none[2] = {0, 1}, many[2] = {1000000, 1000000};
  assert_int_equal(gh_mesh_rectangle(*state, low, flat, n, &mesh), GH_INPUT);
  assert_int_equal(gh_mesh_rectangle(*state, nowhere, size, n, &mesh), GH_INPUT);
  assert_int_equal(gh_mesh_rectangle(*state, low, size, none, &mesh), GH_INPUT);
  assert_int_equal(gh_mesh_rectangle(*state, low, size, many, &mesh), GH_INPUT);
  assert_null(mesh);
}

/* An element that was turned inside out, or that has a corner of 180 degrees, is named. */
static void test_check(void **state) {
  gh_mesh *mesh;
  const double low[2] = {0, 0}, size[2] = {2, 1};
  const int n[2] = {2, 1};
  assert_int_equal(gh_mesh_rectangle(*state, low, size, n, &mesh), GH_OK);
  mesh->X[2 * 2] = 0.5; /* right bottom node to the left of the middle one */
  assert_int_equal(gh_mesh_check(*state, mesh), GH_INPUT);
  assert_non_null(strstr(gh_message(*state), "element 1"));
  mesh->X[2 * 2] = 1.5;
  mesh->X[2 * 2 + 1] = 0.5; /* on the line from the middle bottom to the right top node */
  assert_int_equal(gh_mesh_check(*state, mesh), GH_INPUT);
  mesh->X[2 * 2] = NAN;
  assert_int_equal(gh_mesh_check(*state, mesh), GH_INPUT);
  assert_non_null(strstr(gh_message(*state), "node 2"));
  gh_mesh_destroy(&mesh);
}

static double quad_area(const gh_mesh *mesh, int e) {
  double sum = 0;
  for (int a = 0; a < 4; a++) {
    const double *x = mesh->X + 2 * mesh->quad[e][a], *y = mesh->X + 2 * mesh->quad[e][(a + 1) % 4];
    sum += 0.5 * (x[0] * y[1] - x[1] * y[0]);
  }
  return sum;
}

/* Both versions of the same mesh: unused nodes left out, the clockwise and the repeated quadrilateral put
 * right, sets by name, boundary edges with the body on the left, inner lines as nodes only. */
static void test_gmsh(void **state) {
  const char *const path[] = {v22, v41};
  for (int k = 0; k < 2; k++) {
    gh_mesh *mesh;
    assert_int_equal(gh_mesh_read_gmsh(*state, path[k], &mesh), GH_OK);
    assert_int_equal(mesh->nnodes, 6);
    assert_int_equal(mesh->nelements, 2);
    for (int e = 0; e < 2; e++) assert_near(quad_area(mesh, e), 1, 1e-15);
    assert_int_equal(gh_mesh_check(*state, mesh), GH_OK);
    int left = gh_mesh_find(mesh, "left side"), right = gh_mesh_find(mesh, "right");
    int inner = gh_mesh_find(mesh, "3"), corner = gh_mesh_find(mesh, "corner");
    assert_int_equal(mesh->nsets, 4 + k); /* MSH 4.1 has a line with a second group */
    assert_true(left >= 0 && right >= 0 && inner >= 0 && corner >= 0);
    assert_int_equal(mesh->sets[left].nedges, 1);
    assert_int_equal(mesh->sets[right].nedges, 1);
    check_left(mesh, left, 1, 0.5);
    check_left(mesh, right, 1, 0.5);
    assert_int_equal(mesh->sets[inner].nnodes, 2);
    assert_int_equal(mesh->sets[inner].nedges, 0);
    assert_int_equal(mesh->sets[corner].nnodes, 1);
    const double *x = mesh->X + 2 * mesh->sets[corner].nodes[0];
    assert_true(x[0] == 2 && x[1] == 0);
    for (int j = 0; j < 2; j++) assert_true(mesh->X[2 * mesh->sets[left].nodes[j]] == 0);
    gh_mesh_destroy(&mesh);
  }
}

static char *read_text(const char *path) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  char *text = calloc(1, 8192);
  assert_non_null(text);
  assert_true(fread(text, 1, 8191, file) > 0);
  fclose(file);
  return text;
}

/* Reads text as a mesh file; the message must name file and line and hold `word`. */
static void refuse(gh_context *ctx, const char *text, const char *word) {
  char path[] = "/tmp/granhom-mesh-XXXXXX", place[64];
  int handle = mkstemp(path);
  assert_true(handle >= 0);
  size_t length = strlen(text);
  assert_int_equal(write(handle, text, length), (ssize_t)length);
  close(handle);
  gh_mesh *mesh;
  assert_int_equal(gh_mesh_read_gmsh(ctx, path, &mesh), GH_INPUT);
  unlink(path);
  assert_null(mesh);
  snprintf(place, sizeof place, "%s:", path);
  assert_ptr_equal(strstr(gh_message(ctx), place), gh_message(ctx));
  if (!strstr(gh_message(ctx), word)) fail_msg("\"%s\" lacks \"%s\"", gh_message(ctx), word);
}

/* `text` with the first occurrence of `old` replaced. */
static void refuse_changed(gh_context *ctx, const char *path, const char *old, const char *new,
                           const char *word) {
  char *text = read_text(path), *at = strstr(text, old), *changed = calloc(1, 16384);
  assert_non_null(at);
  assert_non_null(changed);
  sprintf(changed, "%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
  refuse(ctx, changed, word);
  free(text);
  free(changed);
}

/* Files that are not what can be read are refused with file, line and the reason. */
static void test_gmsh_refused(void **state) {
  gh_mesh *mesh;
  assert_int_equal(gh_mesh_read_gmsh(*state, "tests/data/mesh/no-such.msh", &mesh), GH_INPUT);
  assert_int_equal(gh_mesh_read_gmsh(*state, "tests/data/mesh", &mesh), GH_INPUT);
  assert_int_equal(gh_mesh_read_gmsh(*state, "tests/data/mesh/triangle.msh", &mesh), GH_INPUT);
  assert_non_null(strstr(gh_message(*state), "triangle.msh:12: a triangle"));
  refuse(*state, "", "empty");
  refuse(*state, "solid\n", "$MeshFormat");
  refuse_changed(*state, v22, "2.2 0 8", "4.0 0 8", ":2: MSH version 4.0");
  refuse_changed(*state, v22, "2.2 0 8", "2.2 1 8", ":2: a binary");
  refuse_changed(*state, v22, "20 1 0 0", "20 1 0 0.5", ":14: node 20 has z");
  refuse_changed(*state, v22, "20 1 0 0", "20 nan 0 0", ":14: \"nan\"");
  refuse_changed(*state, v22, "20 1 0 0", "10 1 0 0", ":14: node 10 occurs twice");
  refuse_changed(*state, v22, "3 2 9 1 10 20 50 40", "3 2 9 1 10 20 50 99", "node 99");
  refuse_changed(*state, v22, "3 2 9 1 10 20 50 40", "3 2 9 1 10 50 20 40", "not convex");
  refuse_changed(*state, v22, "3 2 9 1 10 20 50 40", "16 2 9 1 10 20 50 40", "quadratic quadrilateral");
  refuse_changed(*state, v22, "Elements\n8", "Elements\n800000", "more than the rest");
  refuse_changed(*state, v22, "Nodes\n8", "Nodes\n7", "80");
  refuse_changed(*state, v22, "1 1 \"left side\"", "1 1 \"corner\"", "corner");
  refuse_changed(*state, v41, "5 6 1 6", "5 7 1 6", "announced");
  refuse_changed(*state, v41, "3 8 10 80", "3 9 10 80", "announced");
  refuse_changed(*state, v41, "$EndPeriodic", "", "$Periodic has no");
  refuse_changed(*state, v41, "$Periodic\n0\n$EndPeriodic",
                 "$PartitionedEntities\n0\n$EndPartitionedEntities", "partition");
}

/* A file cut off anywhere is refused and nothing is left behind. */
static void test_gmsh_truncated(void **state) {
  const char *const path[] = {v22, v41};
  for (int k = 0; k < 2; k++) {
    char *text = read_text(path[k]);
    for (size_t length = strlen(text) - 2; length > 0; length -= length < 7 ? 1 : 7) {
      text[length] = '\0';
      refuse(*state, text, "");
    }
    free(text);
  }
}

static void corners_of_a_rectangle(void **state) {
  gh_context *ctx = *state;
  const double low[2] = {0, 0}, size[2] = {2, 3};
  const int elements[2] = {2, 3};
  static const struct {
    const char *name;
    double X[2];
  } corners[] = {
      {"bottom_left", {0, 0}}, {"bottom_right", {2, 0}}, {"top_left", {0, 3}}, {"top_right", {2, 3}}};
  gh_mesh *mesh;
  int set;
  assert_int_equal(gh_mesh_rectangle(ctx, low, size, elements, &mesh), GH_OK);
  assert_int_equal(gh_mesh_find_corner(ctx, mesh, "middle", &set), GH_OK);
  assert_int_equal(set, -1);
  for (int k = 0; k < 4; k++) {
    assert_int_equal(gh_mesh_find_corner(ctx, mesh, corners[k].name, &set), GH_OK);
    assert_int_equal(set, 4 + k);
    assert_int_equal(mesh->sets[set].nnodes, 1);
    assert_int_equal(mesh->sets[set].nedges, 0);
    for (int i = 0; i < 2; i++) assert_true(mesh->X[2 * mesh->sets[set].nodes[0] + i] == corners[k].X[i]);
  }
  assert_int_equal(gh_mesh_find_corner(ctx, mesh, "left", &set), GH_OK);
  assert_int_equal(set, 0);
  assert_int_equal(gh_mesh_find_corner(ctx, mesh, "top_left", &set), GH_OK); /* once */
  assert_int_equal(set, 6);
  assert_int_equal(mesh->nsets, 8);
  gh_mesh_destroy(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rectangle),    cmocka_unit_test(corners_of_a_rectangle),
      cmocka_unit_test(test_gauss),        cmocka_unit_test(test_rectangle_refused),
      cmocka_unit_test(test_check),        cmocka_unit_test(test_gmsh),
      cmocka_unit_test(test_gmsh_refused), cmocka_unit_test(test_gmsh_truncated),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
