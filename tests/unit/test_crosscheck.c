/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Other programs on the same packing and path: closed forms, agreement with an RVE, and what is said of a
 * program that is missing, fails or hangs. */
#include "../help.h"

#include "granhom/crosscheck.h"

#include <dirent.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MOST_ROWS = 16 };

static gh_contact_law law(double E, double Et, double mu) {
  return (gh_contact_law){
      .normal_stiffness = E, .friction = mu > 0, .tangential_stiffness = Et, .friction_coefficient = mu};
}

/* A problem on a packing; x is freed by the caller. */
static gh_peer_problem pose(const gh_packing *p, gh_contact_law l, int rows, const double *F) {
  double *x = test_malloc(2 * (size_t)p->n * sizeof *x);
  for (int i = 0; i < 2 * p->n; i++) x[i] = p->x[i] - p->low[i % 2];
  gh_peer_problem q = {.n = p->n,
                       .radius = p->radius,
                       .x = x,
                       .law = l,
                       .rows = rows,
                       .F = F,
                       .tolerance = 1e-10,
                       .max_steps = 100000,
                       .steps_per_row = 50,
                       .seconds = 60};
  memcpy(q.cell, p->cell, sizeof q.cell);
  return q;
}

static bool installed(void) {
  return system("command -v liggghts >/dev/null 2>&1") == 0;
}

/* 4 x 4 equal disks of radius 1/2 that just touch. */
static gh_packing *square_lattice(gh_context *ctx) {
  double radius[16], x[32];
  for (int k = 0; k < 16; k++) {
    radius[k] = 0.5;
    x[2 * k] = k % 4 + 0.25, x[2 * k + 1] = k / 4 + 0.75;
  }
  return make_packing(ctx, 16, (double[4]){4, 0, 0, 4}, radius, x);
}

/* Compressed by c, a square lattice has the overlap 1 - c in each contact and the pressure E (1 - c)/c. */
static void test_pressure(void **state) {
  gh_context *ctx = *state;
  const double F[] = {1, 0, 0, 1, 0.999, 0, 0, 0.999}, E = 1000;
  gh_packing *p = square_lattice(ctx);
  gh_peer_problem q = pose(p, law(E, 400, 0.5), 1, F + 4);
  for (int kind = 0; kind < 2; kind++) {
    gh_peer_row row;
    gh_peer_result r;
    if (kind == GH_PEER_LIGGGHTS && !installed()) continue;
    OK(gh_peer_run(ctx, kind, &q, &row, &r));
    assert_string_equal(r.message, "");
    assert_int_equal(r.end, GH_PEER_DONE);
    assert_int_equal(row.contacts, 32);
    NEAR("s11", row.cauchy[0], -E * 0.001 / 0.999, 1e-9);
    NEAR("s22", row.cauchy[3], -E * 0.001 / 0.999, 1e-9);
    NEAR("mean force", row.mean_force, E * 0.001, 1e-9);
    assert_true(r.seconds > 0 && row.steps >= 50);
  }
  test_free((void *)q.x);
  gh_packing_destroy(&p);
}

/* Sheared by g, each grain rotates until the tangential forces on it balance: all contacts have half the
 * slip, f_t = E_t g a/2, s12 = f_t/a, as long as f_t < mu f_n; then s12 = mu f_n/a. Normal forces on the
 * turned normals add f_n g/a. */
static void test_shear(void **state) {
  gh_context *ctx = *state;
  const double a = 0.9999, E = 1000, Et = 400, mu = 0.5, g[] = {0, 1e-5, 1e-3};
  double F[12];
  for (int k = 0; k < 3; k++) memcpy(F + 4 * k, (double[4]){a, a * g[k], 0, a}, 4 * sizeof(double));
  gh_packing *p = square_lattice(ctx);
  gh_peer_problem q = pose(p, law(E, Et, mu), 3, F);
  gh_peer_row row[3];
  gh_peer_result r;
  q.steps_per_row =
      5000; /* the faster the motion, the more a sliding contact shoots beyond and springs back */
  OK(gh_peer_run(ctx, GH_PEER_LAMMPS, &q, row, &r));
  assert_string_equal(r.message, "");
  double fn = E * (1 - a);
  NEAR("no shear", row[0].cauchy[1], 0, 1e-12);
  NEAR("stick", row[1].cauchy[1], Et * g[1] / 2, 1e-3 * Et * g[1] / 2);
  NEAR("slip", row[2].cauchy[1], mu * fn / a, 0.02 * mu * fn);
  /* without rotation the upright contacts alone slip, by the whole of it */
  q.law.fixed_rotations = 1;
  OK(gh_peer_run(ctx, GH_PEER_LAMMPS, &q, row, &r));
  NEAR("stick, fixed rotations", row[1].cauchy[1], Et * g[1], 1e-3 * Et * g[1]);
  test_free((void *)q.x);
  gh_packing_destroy(&p);
}

/* Largest difference to an RVE on the native engine, over the largest stress. */
static double difference(gh_context *ctx, const gh_packing *p, const gh_peer_problem *q,
                         const gh_peer_row *row) {
  gh_rve_options o = rve_options(GH_ENGINE_NATIVE, GH_PERIODIC, q->law.normal_stiffness, q->tolerance);
  gh_rve *rve;
  double worst = 0, scale = 0, P[4];
  o.law = q->law;
  OK(gh_rve_create(ctx, p, &o, &rve));
  for (int k = 0; k < q->rows; k++) {
    OK(gh_rve_evaluate(rve, q->F + 4 * k, 0, P, NULL));
    OK(gh_rve_commit(rve));
    worst = fmax(worst, distance(gh_rve_measure(rve)->cauchy, row[k].cauchy, 4));
    scale = fmax(scale, norm(row[k].cauchy, 4));
  }
  gh_rve_destroy(&rve);
  return worst / scale;
}

static double compare(gh_context *ctx, gh_peer_kind kind, gh_contact_law l, int rows, const double *F) {
  gh_packing *p = case_packing(ctx, "p50d");
  gh_peer_problem q = pose(p, l, rows, F);
  gh_peer_row row[MOST_ROWS];
  gh_peer_result r;
  OK(gh_peer_run(ctx, kind, &q, row, &r));
  assert_string_equal(r.message, "");
  assert_int_equal(r.rows, rows);
  for (int k = 0; k < rows; k++) assert_true(row[k].residual <= q.tolerance);
  double d = difference(ctx, p, &q, row);
  test_free((void *)q.x);
  gh_packing_destroy(&p);
  return d;
}

/* Uniaxial compression by 0.05 % an increment; with `sheared` also shear, and a rotation that grows to 5
 * degrees. */
static void make_path(double *F, int rows, double step, bool sheared) {
  for (int k = 0; k < rows; k++) {
    double U[4] = {1 - step * k, sheared ? step * k : 0, 0, 1}, Q[4];
    rotation(sheared ? 0.087 * k / rows : 0, Q);
    gh_mul2(Q, U, F + 4 * k);
  }
}

/* A row that is there twice: nothing moves, and nothing changes. */
static void test_standing(void **state) {
  gh_context *ctx = *state;
  const double F[] = {1, 0, 0, 1, 0.999, 0, 0, 1, 0.999, 0, 0, 1, 0.998, 0, 0, 1};
  gh_packing *p = case_packing(ctx, "p50d");
  gh_peer_problem q = pose(p, law(1000, 200, 0.5), 4, F);
  for (int kind = 0; kind < 2; kind++) {
    gh_peer_row row[4];
    gh_peer_result r;
    if (kind == GH_PEER_LIGGGHTS && !installed()) continue;
    OK(gh_peer_run(ctx, kind, &q, row, &r));
    assert_string_equal(r.message, "");
    NEAR("stress of the second", distance(row[1].cauchy, row[2].cauchy, 4), 0, 1e-8 * norm(row[1].cauchy, 4));
    assert_true(distance(row[2].cauchy, row[3].cauchy, 4) > 1e-3 * norm(row[1].cauchy, 4));
  }
  test_free((void *)q.x);
  gh_packing_destroy(&p);
}

/* Without friction the equilibrium is the same; the stress is known to some hundred times the residual of
 * 1e-10. */
static void test_frictionless(void **state) {
  gh_context *ctx = *state;
  double F[4 * 4];
  make_path(F, 4, 5e-4, true);
  assert_true(compare(ctx, GH_PEER_LAMMPS, law(1000, 0, 0), 4, F) < 1e-7);
  make_path(F, 4, 5e-4, false);
  if (installed()) assert_true(compare(ctx, GH_PEER_LIGGGHTS, law(1000, 0, 0), 4, F) < 1e-7);
}

/* With friction the laws differ by the increment and by lever arms, which count in parts of the overlap over
 * the radius (0.02 here) of the tangential forces. */
static void test_friction(void **state) {
  gh_context *ctx = *state;
  double F[4 * 10];
  make_path(F, 10, 1e-4, false);
  for (int kind = 0; kind < 2; kind++)
    for (int k = 0; k < 2; k++) {
      if (kind == GH_PEER_LIGGGHTS && !installed()) continue;
      double d = compare(ctx, kind, law(1000, 200, k ? 0.5 : 0.1), 10, F);
      assert_true(d < 5e-3);
      assert_true(d > 1e-9); /* friction acts */
    }
  make_path(F, 10, 1e-4, true);
  assert_true(compare(ctx, GH_PEER_LAMMPS, law(1000, 200, 0.5), 10, F) < 5e-3);
}

/* ---- programs that are not LIGGGHTS ---- */

typedef struct fake {
  char folder[64], program[96], seen[128];
} fake;

static void make_fake(fake *f, const char *body) {
  snprintf(f->folder, sizeof f->folder, "/tmp/granhom-test-XXXXXX");
  assert_non_null(mkdtemp(f->folder));
  snprintf(f->program, sizeof f->program, "%s/program", f->folder);
  snprintf(f->seen, sizeof f->seen, "%s/seen", f->folder);
  FILE *file = fopen(f->program, "w");
  assert_non_null(file);
  if (body) fprintf(file, "#!/bin/sh\n%s\n", body);
  else fprintf(file, "\177no program\n");
  fclose(file);
  assert_int_equal(chmod(f->program, 0700), 0);
  setenv("TMPDIR", f->folder, 1);
  setenv("SEEN", f->seen, 1);
}

/* Nothing is left of the run but the program, and what it wrote down itself. */
static void remove_fake(fake *f) {
  int left = 0;
  DIR *folder = opendir(f->folder);
  for (struct dirent *e; (e = readdir(folder));)
    left += e->d_name[0] != '.' && strcmp(e->d_name, "program") && strcmp(e->d_name, "seen");
  closedir(folder);
  assert_int_equal(left, 0);
  unsetenv("TMPDIR");
  unlink(f->program);
  unlink(f->seen);
  rmdir(f->folder);
}

static void run_fake(gh_context *ctx, const char *program, double seconds, gh_peer_result *r) {
  const double F[] = {1, 0, 0, 1};
  gh_packing *p = square_lattice(ctx);
  gh_peer_problem q = pose(p, law(1000, 400, 0.5), 1, F);
  gh_peer_row row;
  q.program = program;
  q.seconds = seconds;
  OK(gh_peer_run(ctx, GH_PEER_LIGGGHTS, &q, &row, r));
  test_free((void *)q.x);
  gh_packing_destroy(&p);
}

static void test_missing(void **state) {
  gh_peer_result r;
  run_fake(*state, "no-such-program", 10, &r);
  assert_int_equal(r.end, GH_PEER_MISSING);
  assert_non_null(strstr(r.message, "there is no program no-such-program"));
  run_fake(*state, "/tmp", 10, &r);
  assert_int_equal(r.end, GH_PEER_MISSING);
}

static void test_failing(void **state) {
  static const struct {
    const char *body, *words;
  } cases[] = {
      {"echo begin; echo 'ERROR: no such style'; echo end; exit 3", "status 3: ERROR: no such style"},
      {"echo it ends >&2", "status 0: it ends"},
      {"kill -SEGV $$", "signal 11"},
      {NULL, "status 127: it cannot be executed"},
      {"echo granhom unrest 0 1e-3 2e-3 0", "no equilibrium within 100000 time steps: residual 0.002"},
      {"echo granhom row 0 50 0 0 0", "LIGGGHTS has not written its contacts"},
      {"d=$(dirname \"$2\"); echo 'ITEM: ENTRIES' >$d/contacts.0; echo '1 2 nan' >>$d/contacts.0; echo "
       "granhom "
       "row 0 50 0 0 0",
       "list of contacts cannot be read"},
      {"d=$(dirname \"$2\"); printf 'ITEM: NUMBER OF ENTRIES\\n2\\nITEM: ENTRIES\\n0 0 0 1 0 0 1 2 0 -1 0 "
       "0\\n' >$d/contacts.0; "
       "echo granhom row 0 50 0 0 0",
       "list of contacts cannot be read"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    gh_peer_result r;
    fake f;
    make_fake(&f, cases[k].body);
    run_fake(*state, f.program, 10, &r);
    assert_int_equal(r.end, GH_PEER_FAILED);
    if (!strstr(r.message, cases[k].words)) fail_msg("\"%s\" lacks \"%s\"", r.message, cases[k].words);
    remove_fake(&f);
  }
}

/* What hangs is ended with all it has started, and it sees nothing of this program's MPI. */
static void test_hanging(void **state) {
  gh_peer_result r;
  fake f;
  make_fake(&f, "sleep 600 & echo $! >$SEEN; env | grep -c -e ^PMIX_ -e ^OMPI_COMM >>$SEEN; wait");
  setenv("PMIX_RANK", "0", 1);
  run_fake(*state, f.program, 0.5, &r);
  unsetenv("PMIX_RANK");
  assert_int_equal(r.end, GH_PEER_STOPPED);
  assert_non_null(strstr(r.message, "stopped after 0.5 s"));
  assert_true(r.seconds < 10);
  int child = 0, variables = -1;
  FILE *file = fopen(f.seen, "r");
  assert_non_null(file);
  assert_int_equal(fscanf(file, "%d %d", &child, &variables), 2);
  fclose(file);
  assert_int_equal(variables, 0);
  char path[64], word[2] = "R";
  snprintf(path, sizeof path, "/proc/%d/stat", child); /* gone, or not yet collected by init: state Z */
  for (int k = 0; k < 500 && *word != 'Z'; k++) { /* the signal may take its time where there is much to do */
    file = fopen(path, "r");
    if (!file || fscanf(file, "%*d %*s %1s", word) != 1) *word = 'Z';
    if (file) fclose(file);
    if (*word != 'Z') nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
  }
  assert_string_equal(word, "Z");
  remove_fake(&f);
}

static void test_tilted(void **state) {
  gh_context *ctx = *state;
  const double F[] = {1, 0, 0, 1, 1, 0.01, 0, 1};
  gh_packing *p = square_lattice(ctx);
  gh_peer_problem q = pose(p, law(1000, 400, 0.5), 2, F);
  gh_peer_row row[2];
  gh_peer_result r;
  q.program = "/bin/false";
  OK(gh_peer_run(ctx, GH_PEER_LIGGGHTS, &q, row, &r));
  assert_int_equal(r.end, GH_PEER_UNABLE);
  assert_non_null(strstr(r.message, "row 1: the cell is tilted"));
  test_free((void *)q.x);
  gh_packing_destroy(&p);
}

/* No equilibrium, no time, no contact. */
static void test_limits(void **state) {
  gh_context *ctx = *state;
  const double F[] = {1, 0, 0, 1, 0.99, 0, 0, 1, 1.2, 0, 0, 1.2};
  gh_packing *p = case_packing(ctx, "p50d");
  gh_peer_problem q = pose(p, law(1000, 0, 0), 3, F);
  gh_peer_row row[3];
  gh_peer_result r;
  q.max_steps = 60;
  OK(gh_peer_run(ctx, GH_PEER_LAMMPS, &q, row, &r));
  assert_int_equal(r.end, GH_PEER_FAILED);
  assert_int_equal(r.rows, 1);
  assert_non_null(strstr(r.message, "row 1: no equilibrium within 60 time steps"));
  q.seconds = 1e-6;
  OK(gh_peer_run(ctx, GH_PEER_LAMMPS, &q, row, &r));
  assert_int_equal(r.end, GH_PEER_STOPPED);
  q.seconds = 60, q.max_steps = 20000, q.F = F + 8, q.rows = 1; /* the grains fly apart and come to rest */
  for (int kind = 0; kind < 2; kind++) {
    if (kind == GH_PEER_LIGGGHTS && !installed()) continue;
    OK(gh_peer_run(ctx, kind, &q, row, &r));
    assert_string_equal(r.message, "");
    assert_int_equal(row[0].contacts, 0);
    assert_true(norm(row[0].cauchy, 4) == 0);
  }
  test_free((void *)q.x);
  gh_packing_destroy(&p);
}

static void test_refused(void **state) {
  gh_context *ctx = *state;
  double F[] = {1, 0, 0, 1};
  gh_packing *p = square_lattice(ctx);
  gh_peer_problem good = pose(p, law(1000, 400, 0.5), 1, F), q = good;
  gh_peer_row row;
  gh_peer_result r;
#define REFUSED(words) FAILS(gh_peer_run(ctx, GH_PEER_LAMMPS, &q, &row, &r), GH_INPUT, words), q = good
  q.law.hardening = 1;
  REFUSED("hardening must be 0");
  q.law.normal_stiffness = -1;
  REFUSED("stiffness");
  q.tolerance = 1;
  REFUSED("tolerance");
  q.seconds = 0;
  REFUSED("time limit");
  q.cell[0] = 1.9;
  REFUSED("row -1 of the path: the cell is 1.9 wide");
  F[1] = 0.6;
  REFUSED("row 0 of the path: the cell is sheared by 0.6 of its width");
  F[1] = 0, F[3] = -1;
  REFUSED("row 0 of the path: det F must be positive");
  test_free((void *)good.x);
  gh_packing_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_pressure),     TEST(test_standing), TEST(test_shear),
                                     TEST(test_frictionless), TEST(test_friction), TEST(test_missing),
                                     TEST(test_failing),      TEST(test_hanging),  TEST(test_tilted),
                                     TEST(test_limits),       TEST(test_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
