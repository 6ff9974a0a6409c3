/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A foreign program that uses granhom as a material law: one packing as the workspace, two integration points
 * that share it, a step that is cut, a state that is kept and restored.
 *
 *   cc -std=c17 material.c $(pkg-config --cflags --libs granhom) -o material
 *   ./material PACKING.data PATH.csv [lammps|native]
 *
 * PATH.csv has the columns F11 F12 F21 F22. The first point goes along it and its P and A are printed, one
 * row per step; the second point has F = 1 throughout, to show that it does not feel the first. */
#include <granhom/granhom.h>

#include <stdlib.h>
#include <string.h>

/* What a finite element program keeps per integration point: the state at the start of the step and at its
 * end. */
typedef struct point {
  double *begin, *end;
  size_t begin_size, end_size; /* in doubles; with friction they change from step to step */
} point;

static void must(gh_context *ctx, gh_status status) {
  if (status == GH_OK) return;
  fprintf(stderr, "material: %s\n", gh_message(ctx));
  exit(gh_exit_status(status));
}

/* All points start from the packing as it was read. */
static void start(gh_context *ctx, gh_rve *rve, point *p) {
  p->begin_size = p->end_size = gh_rve_state_size(rve);
  p->begin = malloc(p->begin_size * sizeof *p->begin);
  p->end = malloc(p->end_size * sizeof *p->end);
  if (!p->begin || !p->end) abort();
  must(ctx, gh_rve_save(rve, p->begin));
  memcpy(p->end, p->begin, p->begin_size * sizeof *p->begin);
}

/* The material law, in the form of a UMAT: state at the start of the step and F at its end in; P, A = dP/dF
 * and the state at the end out. It may be called for the same step as often as Newton wants: p->begin does
 * not change. Returns GH_DIVERGED where the packing finds no equilibrium: the caller takes a smaller step. */
static gh_status material(gh_rve *rve, point *p, const double F[4], double P[4], double A[16]) {
  gh_status status = gh_rve_load(rve, p->begin, p->begin_size);
  if (status == GH_OK) status = gh_rve_evaluate(rve, F, GH_WANT_TANGENT, P, A);
  if (status != GH_OK) return status;
  size_t size = gh_rve_trial_size(rve);
  double *end = realloc(p->end, size * sizeof *end);
  if (!end) abort();
  p->end = end;
  p->end_size = size;
  return gh_rve_save_trial(rve, p->end);
}

/* The step has converged: its end is the start of the next. (To give a step up, just do not call this.) */
static void commit(point *p) {
  point old = *p;
  p->begin = old.end, p->begin_size = old.end_size;
  p->end = old.begin, p->end_size = old.begin_size;
}

static void print_row(int step, const double P[4], const double A[16]) {
  printf("%d", step);
  for (int k = 0; k < 4; k++) printf(",%.17g", P[k]);
  for (int k = 0; k < 16; k++) printf(",%.17g", A[k]);
  printf("\n");
}

/* One step of both points; `other` stays at F = 1. */
static void step(gh_context *ctx, gh_rve *rve, point *p, point *other, int number, const double F[4]) {
  const double one[4] = {1, 0, 0, 1}, far[4] = {0.9 * F[0], F[1], F[2], F[3]};
  double P[4], A[16], Q[4], B[16];
  /* A first try goes much too far, as Newton's iteration may. The step is cut: nothing is committed, and the
   * next try starts from the same state. */
  gh_status tried = material(rve, p, far, P, A);
  if (tried != GH_OK && tried != GH_DIVERGED) must(ctx, tried);
  must(ctx, material(rve, other, one, Q, B)); /* same workspace, another point */
  must(ctx, material(rve, p, F, P, A));
  commit(p);
  commit(other);
  print_row(number, P, A);
}

static void walk(gh_context *ctx, gh_rve *rve, const gh_csv *path) {
  static const char *const names[4] = {"F11", "F12", "F21", "F22"};
  point p, other;
  double *kept = NULL;
  size_t size = 0;
  start(ctx, rve, &p);
  start(ctx, rve, &other);
  for (int row = 0; row < path->nrows; row++) {
    double F[4];
    for (int k = 0; k < 4; k++) F[k] = path->value[row * path->ncols + gh_csv_find(path, names[k])];
    if (row ==
        path->nrows / 2) { /* a checkpoint: a state is numbers, and can go to a file or another process */
      size = p.begin_size;
      kept = malloc(size * sizeof *kept);
      if (!kept) abort();
      memcpy(kept, p.begin, size * sizeof *kept);
    }
    step(ctx, rve, &p, &other, row, F);
  }
  /* Back to the checkpoint, and the same steps again: the same rows to the last digit. */
  free(p.begin);
  p.begin = kept;
  p.begin_size = size;
  for (int row = path->nrows / 2; row < path->nrows; row++) {
    double F[4];
    for (int k = 0; k < 4; k++) F[k] = path->value[row * path->ncols + gh_csv_find(path, names[k])];
    step(ctx, rve, &p, &other, row, F);
  }
  free(p.begin), free(p.end);
  free(other.begin), free(other.end);
}

static void check_columns(const gh_csv *path) {
  if (gh_csv_find(path, "F11") >= 0 && gh_csv_find(path, "F12") >= 0 && gh_csv_find(path, "F21") >= 0 &&
      gh_csv_find(path, "F22") >= 0)
    return;
  fprintf(stderr, "material: the path needs the columns F11 F12 F21 F22\n");
  exit(2);
}

int main(int argc, char **argv) {
  gh_context *ctx;
  gh_packing *packing;
  gh_csv *path;
  gh_rve *rve;
  if (argc < 3) {
    fprintf(stderr, "usage: material PACKING.data PATH.csv [lammps|native]\n");
    return 2;
  }
  if (gh_context_create(&ctx) != GH_OK) return 1;
  must(ctx, gh_packing_read(ctx, argv[1], &packing));
  must(ctx, gh_csv_read(ctx, argv[2], &path));
  check_columns(path);

  /* One RVE per packing, law and boundary condition: the workspace of all points that have them. */
  gh_rve_options options = gh_rve_defaults(); /* periodic, LAMMPS, residual 1e-8 */
  options.law = (gh_contact_law){.normal_stiffness = 50};
  if (argc > 3 && !strcmp(argv[3], "native")) options.engine = GH_ENGINE_NATIVE;
  must(ctx, gh_rve_create(ctx, packing, &options, &rve));

  printf("step,P11,P12,P21,P22");
  for (int n = 0; n < 16; n++)
    printf(",A%d%d%d%d", (n >> 3) + 1, (n >> 2 & 1) + 1, (n >> 1 & 1) + 1, (n & 1) + 1);
  printf("\n");
  walk(ctx, rve, path);

  gh_rve_destroy(&rve);
  gh_csv_destroy(&path);
  gh_packing_destroy(&packing);
  gh_context_destroy(&ctx);
  return 0;
}
