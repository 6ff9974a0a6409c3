/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Packings: reading, checking, writing; replicas and boundary sets. */
#include "../help.h"

#include <unistd.h>

/* A file with this text in the folder for temporary files; the caller removes it. */
static void put(char path[64], const char *text) {
  strcpy(path, "/tmp/granhom-packing-XXXXXX");
  int fd = mkstemp(path);
  assert_true(fd >= 0);
  assert_int_equal(write(fd, text, strlen(text)), strlen(text));
  close(fd);
}

/* Count, cell, radii and order of a packing of the reference cases, as its file states. */
static void p150_is_read(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p150");
  static const double low = -0.77192671935149959;
  assert_int_equal(p->n, 150);
  assert_true(p->cell[0] == -2 * low && p->cell[3] == -2 * low && p->cell[1] == 0 && p->cell[2] == 0);
  assert_true(p->low[0] == low && p->low[1] == low);
  int sizes[4] = {0};
  for (int i = 0; i < p->n; i++) {
    assert_int_equal(p->id[i], i + 1);
    assert_int_equal(p->type[i], 1);
    sizes[0] += p->radius[i] == 0.05, sizes[1] += p->radius[i] == 0.0625;
    sizes[2] += p->radius[i] == 0.08, sizes[3] += p->radius[i] == 0.125;
    for (int k = 0; k < 2; k++) assert_true(p->x[2 * i + k] >= low && p->x[2 * i + k] < -low);
  }
  assert_int_equal(sizes[0], 35);
  assert_int_equal(sizes[1], 74);
  assert_int_equal(sizes[2], 40);
  assert_int_equal(sizes[3], 1);
  NEAR("mean radius", gh_packing_mean_radius(p), (35 * 0.05 + 74 * 0.0625 + 40 * 0.08 + 0.125) / 150, 1e-15);
  gh_packing_destroy(&p);
  assert_null(p);
  gh_packing_destroy(&p);
}

#define HEAD "t\n2 atoms\n2 atom types\n0 4 xlo xhi\n0 2 ylo yhi\n-1 1 zlo zhi\n"

/* Each fault of the input is refused with the line it stands on and what is wrong. */
static void faults_are_named_with_their_line(void **state) {
  gh_context *ctx = *state;
  static const char *const faults[][2] = {
      {HEAD "\nAtoms\n\n3 1 1 1 1 1 0\n3 1 1 1 3 1 0\n", ":11: id 3 occurs twice (first on line 10)"},
      {HEAD "\nAtoms\n\n1 1 0 1 1 1 0\n2 1 1 1 3 1 0\n", ":10: grain 1 has the diameter 0"},
      {HEAD "\nAtoms\n\n1 1 1 1 1 1 0\n2 1 -0.5 1 3 1 0\n", ":11: grain 2 has the diameter -0.5"},
      {HEAD "\nAtoms\n\n1 1 1 1 1 1 0\n2 1 nan 1 3 1 0\n", ":11: diameter: 'nan'"},
      {HEAD "\nAtoms\n\n1 1 1 1 1 1 0\n2 1 1 1 nan 1 0\n", ":11: x: 'nan'"},
      {HEAD "\nAtoms\n\n1 1 1 1 1 1 0.25\n2 1 1 1 3 1 0\n", ":10: grain 1 has z = 0.25"},
      {HEAD "\nAtoms\n\n1 1 1 1 1 1 0\n", ":10: 1 atoms, but the header (line 2) states 2"},
      {HEAD "\nAtoms\n\n1 1 1 1 1 1 0\n2 1 1 1", ":11: 4 words"},
      {HEAD "0 0.1 0 xy xz yz\n\nAtoms\n\n1 1 1 1 1 1 0\n2 1 1 1 3 1 0\n", "xz = 0.1 and yz = 0 tilt"},
      {HEAD "0 0 -0.1 xy xz yz\n\nAtoms\n\n1 1 1 1 1 1 0\n2 1 1 1 3 1 0\n", "xz = 0 and yz = -0.1 tilt"},
      {HEAD "\nAtoms\n\n7 1 1 1 1 1 0\n2 1 1 1 5 1 0\n", "grains 2 and 7 are at one place, (1, 1)"},
      {HEAD "\nAtoms\n\n1 1 20 1 1 1 0\n2 1 1 1 3 1 0\n", "the grains fill the cell 39.4 times"},
      {"t\n0 atoms\n", ":2: the number of atoms is '0'"},
      {"", "empty"},
  };
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    char path[64];
    gh_packing *p = (gh_packing *)1;
    put(path, faults[k][0]);
    FAILS(gh_packing_read(ctx, path, &p), GH_INPUT, faults[k][1]);
    assert_null(p);
    assert_memory_equal(gh_message(ctx), path, strlen(path));
    remove(path);
  }
  gh_packing *p;
  FAILS(gh_packing_read(ctx, "/tmp/granhom/none.data", &p), GH_INPUT, "No such file");
}

/* Grains come in the order of their ids, and one outside the cell stands for its image inside, also in a
 * tilted cell. */
static void grains_are_sorted_and_wrapped(void **state) {
  gh_context *ctx = *state;
  char path[64];
  gh_packing *p;
  put(path, HEAD "1 0 0 xy xz yz\n\nAtoms\n\n7 2 1 1 6.5 3 0\n5 1 0.5 1 -0.5 0.5 0\n");
  OK(gh_packing_read(ctx, path, &p));
  remove(path);
  assert_true(p->id[0] == 5 && p->id[1] == 7 && p->type[0] == 1 && p->type[1] == 2);
  assert_true(p->radius[0] == 0.25 && p->radius[1] == 0.5);
  assert_true(p->cell[0] == 4 && p->cell[1] == 1 && p->cell[2] == 0 && p->cell[3] == 2);
  assert_true(p->x[0] == 3.5 && p->x[1] == 0.5); /* + L_1 */
  assert_true(p->x[2] == 1.5 && p->x[3] == 1);   /* - L_1 - L_2 */
  gh_packing_destroy(&p);
}

static void assert_same_packing(const gh_packing *a, const gh_packing *b) {
  size_t n = (size_t)a->n;
  assert_int_equal(a->n, b->n);
  assert_memory_equal(a->id, b->id, n * sizeof(int));
  assert_memory_equal(a->type, b->type, n * sizeof(int));
  assert_memory_equal(a->radius, b->radius, n * sizeof(double));
  assert_memory_equal(a->x, b->x, 2 * n * sizeof(double));
  assert_true(distance(a->low, b->low, 2) == 0);
  assert_true(distance(a->cell, b->cell, 4) <=
              4e-16); /* the file holds low and high: their difference rounds */
}

/* What is written is read back as it was, and a copy is the same packing in memory of its own. */
static void write_and_read_give_the_same_packing(void **state) {
  gh_context *ctx = *state;
  char path[64];
  put(path, "");
  for (int tilted = 0; tilted < 2; tilted++) {
    gh_packing *p = case_packing(ctx, "p50"), *q, *c;
    p->type[3] = 4;
    if (tilted) p->cell[1] = 0.3 / 7;
    OK(gh_packing_write(ctx, p, path, NULL, NULL));
    OK(gh_packing_read(ctx, path, &q));
    OK(gh_packing_copy(ctx, p, &c));
    if (!tilted) assert_same_packing(p, q);
    else NEAR("tilt", q->cell[1], p->cell[1], 0);
    assert_same_packing(p, c);
    p->x[0] = 99;
    assert_true(c->x[0] != 99);
    gh_packing_destroy(&p);
    gh_packing_destroy(&q);
    gh_packing_destroy(&c);
  }
  remove(path);
}

/* Smallest distance of i and j over the images. */
static double nearest(const gh_packing *p, int i, int j) {
  double best = INFINITY;
  for (int a = -2; a <= 2; a++)
    for (int b = -2; b <= 2; b++) {
      double x = p->x[2 * j] - p->x[2 * i] + p->cell[0] * a + p->cell[1] * b;
      double y = p->x[2 * j + 1] - p->x[2 * i + 1] + p->cell[2] * a + p->cell[3] * b;
      best = fmin(best, hypot(x, y));
    }
  return best;
}

/* A deformed and turned packing is written in the turned frame: all distances between grains are kept. */
static void a_deformed_packing_keeps_its_distances(void **state) {
  gh_context *ctx = *state;
  char path[64];
  gh_packing *p = case_packing(ctx, "p20"), *q;
  double F[4] = {0.9, -0.55, 0.6, 0.8}, cell[4], *x;
  put(path, "");
  OK(gh_alloc(ctx, 40, sizeof *x, &x));
  gh_mul2(F, p->cell, cell);
  for (int i = 0; i < 20; i++) gh_apply2(F, &p->x[2 * i], &x[2 * i]);
  OK(gh_packing_write(ctx, p, path, x, cell));
  OK(gh_packing_read(ctx, path, &q));
  memcpy(p->x, x, 40 * sizeof *x);
  memcpy(p->cell, cell, sizeof cell);
  assert_true(q->cell[2] == 0);
  NEAR("area", gh_det2(q->cell), gh_det2(cell), 1e-15);
  for (int i = 0; i < 20; i++)
    for (int j = 0; j < 20; j++)
      if (i != j) NEAR("distance", nearest(q, i, j), nearest(p, i, j), 1e-14);
  remove(path);
  free(x);
  gh_packing_destroy(&p);
  gh_packing_destroy(&q);
}

/* Distance of a point from the line through `at` along `direction`. */
static double from_line(const double *point, const double *at, const double *direction) {
  double x = point[0] - at[0], y = point[1] - at[1];
  return fabs(x * direction[1] - y * direction[0]) / hypot(direction[0], direction[1]);
}

/* Whether the cluster has exactly one replica of grain i shifted by (a, b), and where it must be. */
/* A strongly tilted cell is written with another second lattice vector of the same lattice, of a tilt that
 * LAMMPS takes, and each grain where one of its images is. */
static void a_strong_tilt_is_reduced(void **state) {
  gh_context *ctx = *state;
  gh_packing *p = case_packing(ctx, "p20"), *q;
  char path[64];
  put(path, "");
  double lx = p->cell[0], inverse[4];
  const double tilts[] = {3, -3, 2.3, 0.7, -0.51, 12.49};
  for (int t = 0; t < 6; t++) {
    p->cell[1] = tilts[t] * lx;
    gh_inv2(p->cell, inverse);
    OK(gh_packing_write(ctx, p, path, NULL, NULL));
    OK(gh_packing_read(ctx, path, &q));
    assert_true(fabs(q->cell[1]) <= 0.5 * lx && q->cell[2] == 0);
    NEAR("lx", q->cell[0], lx, 1e-15);
    NEAR("ly", q->cell[3], p->cell[3], 1e-15);
    double k = (p->cell[1] - q->cell[1]) / lx;
    NEAR("lattice", k, nearbyint(k), 1e-14);
    for (int i = 0; i < p->n; i++) {
      double s[2] = {q->x[2 * i] - p->x[2 * i], q->x[2 * i + 1] - p->x[2 * i + 1]};
      gh_apply2(inverse, s, s);
      for (int d = 0; d < 2; d++) NEAR("lattice vectors", s[d], nearbyint(s[d]), 1e-13);
    }
    gh_packing_destroy(&q);
  }
  remove(path);
  gh_packing_destroy(&p);
}

static void assert_replica(const gh_packing *p, const gh_cluster *c, int i, int a, int b, bool wanted) {
  int found = 0;
  for (int m = p->n; m < c->n; m++) {
    if (c->grain[m] != i || c->image[m][0] != a || c->image[m][1] != b) continue;
    found++;
    NEAR("x", c->x[2 * m], p->x[2 * i] + a * p->cell[0] + b * p->cell[1], 1e-15);
    NEAR("y", c->x[2 * m + 1], p->x[2 * i + 1] + a * p->cell[2] + b * p->cell[3], 1e-15);
    assert_true(c->radius[m] == p->radius[i] && c->type[m] == p->type[i] && c->boundary[m] == 1);
  }
  assert_int_equal(found, wanted);
}

/* Replicas of method 8.1, from the distances of the centres to the four edges of the cell. */
static int check_cluster(gh_context *ctx, const gh_packing *p) {
  gh_cluster *c;
  OK(gh_cluster_create(ctx, p, &c));
  double first[2] = {p->cell[0], p->cell[2]}, second[2] = {p->cell[1], p->cell[3]};
  double far[2] = {p->low[0] + first[0] + second[0], p->low[1] + first[1] + second[1]};
  int replicas = 0;
  for (int i = 0; i < p->n; i++) {
    const double *x = &p->x[2 * i], r = p->radius[i];
    bool left = from_line(x, p->low, second) <= r, right = from_line(x, far, second) <= r;
    bool bottom = from_line(x, p->low, first) <= r, top = from_line(x, far, first) <= r;
    int own = 0;
    for (int a = -1; a <= 1; a++)
      for (int b = -1; b <= 1; b++) {
        if (!a && !b) continue;
        bool wanted = (a == 0 || (a == 1 ? left : right)) && (b == 0 || (b == 1 ? bottom : top));
        assert_replica(p, c, i, a, b, wanted);
        own += wanted;
      }
    assert_int_equal(c->boundary[i], own > 0);
    assert_true(c->grain[i] == i && c->image[i][0] == 0 && c->image[i][1] == 0 && c->x[2 * i] == x[0] &&
                c->radius[i] == r);
    replicas += own;
  }
  assert_int_equal(c->n, p->n + replicas);
  gh_cluster_destroy(&c);
  assert_null(c);
  gh_cluster_destroy(&c);
  return replicas;
}

/* Replicas of the packings of the reference cases, counted one by one. */
static void replicas_of_the_cases(void **state) {
  static const char *const names[] = {"p20", "p50", "p50d", "p150", "p150d", "block150"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    gh_packing *p = case_packing(*state, names[k]);
    int replicas = check_cluster(*state, p);
    print_message("%s: %d replicas\n", names[k], replicas);
    assert_true(replicas > 0);
    gh_packing_destroy(&p);
  }
}

/* Replicas in random tilted cells, down to one grain that reaches all four edges. */
static void replicas_in_tilted_cells(void **state) {
  unsigned long long seed = 5;
  print_message("seed %llu\n", seed);
  for (int trial = 0; trial < 200; trial++) {
    int n = 1 + trial % 12;
    double cell[4] = {0.5 + uniform(&seed), 3 * uniform(&seed) - 1.5, 0, 0.5 + uniform(&seed)}, radius[12],
           x[24];
    for (int i = 0; i < n; i++) {
      double s[2] = {uniform(&seed), uniform(&seed)};
      radius[i] = 0.02 + 0.4 * uniform(&seed) * uniform(&seed);
      gh_apply2(cell, s, &x[2 * i]);
    }
    gh_packing *p = make_packing(*state, n, cell, radius, x);
    check_cluster(*state, p);
    gh_packing_destroy(&p);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(p150_is_read),
                                     TEST(faults_are_named_with_their_line),
                                     TEST(grains_are_sorted_and_wrapped),
                                     TEST(write_and_read_give_the_same_packing),
                                     TEST(a_deformed_packing_keeps_its_distances),
                                     TEST(a_strong_tilt_is_reduced),
                                     TEST(replicas_of_the_cases),
                                     TEST(replicas_in_tilted_cells)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
