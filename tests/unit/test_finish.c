/* SPDX-License-Identifier: GPL-2.0-or-later */
/* From hard packings to mechanics: finish, fabric, hull.
 * What a finished packing is, is judged by sums over all pairs and images that are written here again. */
#include "../help.h"

#include "granhom/finish.h"

/* ---- the judge: all pairs, all images, E = 1 ---- */

typedef struct judge {
  int contacts, rattlers;
  double overlap, residual, pressure, stress[4], anisotropy;
} judge;

typedef struct touch {
  int i, j;
  double n[2], l, e;
} touch;

static int touches(const gh_packing *p, touch *list, int most) {
  int count = 0;
  for (int i = 0; i < p->n; i++)
    for (int j = i; j < p->n; j++)
      for (int a = -2; a <= 2; a++)
        for (int b = -2; b <= 2; b++) {
          if (i == j && (a < 0 || (a == 0 && b <= 0))) continue;
          double d[2];
          for (int k = 0; k < 2; k++)
            d[k] = p->x[2 * j + k] - p->x[2 * i + k] + a * p->cell[2 * k] + b * p->cell[2 * k + 1];
          double l = hypot(d[0], d[1]), e = p->radius[i] + p->radius[j] - l;
          if (e < 0) continue;
          assert_true(count < most);
          list[count++] = (touch){i, j, {d[0] / l, d[1] / l}, l, e};
        }
  return count;
}

/* In a jammed packing only grains in the network carry: those with fewer than 3 contacts of any weight do
 * not, nor do grains that are pushed with less than 1e-6 of the mean force. */
static judge judge_packing(const gh_packing *p) {
  enum { MOST = 20000 };
  touch *t = malloc(MOST * sizeof *t);
  double *f = calloc(2 * (size_t)p->n, sizeof *f), *load = calloc((size_t)p->n, sizeof *load);
  assert_true(t && f && load);
  judge q = {0};
  int count = touches(p, t, MOST);
  double sum = 0, V = gh_det2(p->cell), fabric[3] = {0}, largest = 0;
  for (int c = 0; c < count; c++) {
    sum += t[c].e;
    load[t[c].i] = fmax(load[t[c].i], t[c].e);
    load[t[c].j] = fmax(load[t[c].j], t[c].e);
  }
  for (int c = 0; c < count; c++) {
    if (t[c].e < 1e-6 * sum / count) continue;
    q.contacts++;
    q.overlap += t[c].e;
    for (int k = 0; k < 2; k++) {
      f[2 * t[c].i + k] -= t[c].e * t[c].n[k];
      f[2 * t[c].j + k] += t[c].e * t[c].n[k];
    }
    for (int k = 0; k < 4; k++) q.stress[k] -= t[c].e * t[c].l * t[c].n[k / 2] * t[c].n[k % 2] / V;
    fabric[0] += t[c].n[0] * t[c].n[0], fabric[1] += t[c].n[0] * t[c].n[1],
        fabric[2] += t[c].n[1] * t[c].n[1];
  }
  for (int i = 0; i < p->n; i++) {
    largest = fmax(largest, hypot(f[2 * i], f[2 * i + 1]));
    q.rattlers += load[i] < 1e-6 * sum / count;
  }
  q.residual = largest / (q.overlap / q.contacts);
  q.overlap /= q.contacts * gh_packing_mean_radius(p);
  q.pressure = -(q.stress[0] + q.stress[3]) / 2;
  q.anisotropy = hypot(fabric[0] - fabric[2], 2 * fabric[1]) / q.contacts;
  free(t);
  free(f);
  free(load);
  return q;
}

/* ---- packings ---- */

/* Points at random places with the sizes of Table 5.1 (in its shares), volume fraction phi. */
static gh_packing *random_packing(gh_context *ctx, int n, double phi, unsigned long long seed) {
  static const double size[3] = {0.100, 0.125, 0.160};
  double radius[400], x[800], area = 0;
  assert_true(n <= 400);
  for (int i = 0; i < n; i++) {
    radius[i] = size[i % 4 == 0 ? 2 : i % 2] / 2;
    area += help_pi * radius[i] * radius[i];
  }
  double side = sqrt(area / phi), cell[4] = {side, 0, 0, side};
  for (int i = 0; i < 2 * n; i++) x[i] = side * uniform(&seed);
  return make_packing(ctx, n, cell, radius, x);
}

/* Triangular lattice of m x m unit disks, lattice constant a. */
static gh_packing *triangular(gh_context *ctx, int m, double a) {
  double radius[100], x[200], cell[4] = {m * a, 0.5 * m * a, 0, sqrt(0.75) * m * a};
  assert_true(m <= 10);
  for (int i = 0; i < m * m; i++) {
    radius[i] = 1;
    x[2 * i] = a * (i % m) + 0.5 * a * (i / m) + 0.1;
    x[2 * i + 1] = sqrt(0.75) * a * (i / m) + 0.1;
  }
  return make_packing(ctx, m * m, cell, radius, x);
}

static gh_packing *finished(gh_context *ctx, const gh_packing *hard, const char *how, const char *cell,
                            double anisotropy, gh_finish_report *r) {
  gh_finish_options o = gh_finish_defaults();
  gh_packing *soft;
  OK(gh_finish_parse(ctx, how, &o));
  assert_true(gh_finish_cell_from_name(cell, &o.cell));
  o.anisotropy = anisotropy;
  OK(gh_finish(ctx, hard, &o, &soft, r));
  return soft;
}

/* ---- tests ---- */

/* A triangular lattice with the overlap x has the lattice constant 2 - x, the pressure sqrt(3) E x / (2 - x)
 * and six contacts per grain, from wherever it starts. */
static void lattice_overlap(void **state) {
  gh_context *ctx = *state;
  static const double start[] = {2.08, 2, 1.9};
  for (int k = 0; k < 3; k++) {
    gh_packing *hard = triangular(ctx, 4, start[k]);
    gh_finish_report r;
    const double x = 0.01;
    gh_packing *soft = finished(ctx, hard, "overlap=0.01", "scaled", NAN, &r);
    NEAR("overlap", r.overlap, x, 0.01 * x);
    NEAR("lattice constant", soft->cell[0] / 4, 2 - r.overlap, 1e-12);
    NEAR("pressure", r.pressure, sqrt(3) * r.overlap / (2 - r.overlap), 1e-12);
    NEAR("coordination", r.coordination, 6, 0);
    NEAR("anisotropy", r.anisotropy, 0, 1e-12);
    NEAR("shear stress", r.cauchy[1], 0, 1e-14);
    NEAR("scale", r.linear_scale, soft->cell[0] / hard->cell[0], 1e-14);
    assert_int_equal(r.rattlers, 0);
    gh_packing_destroy(&hard);
    gh_packing_destroy(&soft);
  }
}

/* The smallest acoustic eigenvalue of the triangular lattice just in contact is mu = sqrt(3)/4 E (up to the
 * overlap). */
static void lattice_acoustic(void **state) {
  gh_context *ctx = *state;
  gh_packing *hard = triangular(ctx, 4, 2);
  gh_finish_report r;
  gh_packing *soft = finished(ctx, hard, "overlap=1e-5", "scaled", NAN, &r);
  NEAR("acoustic", r.acoustic, sqrt(3) / 4, 1e-4);
  gh_packing_destroy(&hard);
  gh_packing_destroy(&soft);
}

/* Random floating grains end in equilibrium with the wanted mean overlap in a square cell, for overlaps over
 * two decades. */
static void random_overlap(void **state) {
  gh_context *ctx = *state;
  const unsigned long long seed = 11;
  print_message("seed %llu\n", seed);
  gh_packing *hard = random_packing(ctx, 120, 0.6, seed);
  static const char *const how[] = {"overlap=0.05", "overlap=0.005", "overlap=0.0005"};
  static const double wanted[] = {0.05, 0.005, 0.0005};
  for (int k = 0; k < 3; k++) {
    gh_finish_report r;
    gh_packing *soft = finished(ctx, hard, how[k], "auto", NAN, &r);
    judge q = judge_packing(soft);
    NEAR("overlap", q.overlap, wanted[k], 0.01 * wanted[k]);
    NEAR("residual", q.residual, 0, 1e-10);
    NEAR("reported overlap", r.overlap, q.overlap, 1e-9 * q.overlap);
    NEAR("reported pressure", r.pressure, q.pressure, 1e-9 * q.pressure);
    NEAR("reported anisotropy", r.anisotropy, q.anisotropy, 1e-9);
    assert_int_equal(r.contacts, q.contacts);
    assert_int_equal(r.rattlers, q.rattlers);
    NEAR("coordination", r.coordination, 2.0 * q.contacts / (hard->n - q.rattlers), 1e-12);
    NEAR("coordination of all", r.coordination_all, 2.0 * q.contacts / hard->n, 1e-12);
    NEAR("square cell", soft->cell[0], soft->cell[3], 1e-12);
    NEAR("tilt", soft->cell[1], 0, 1e-12);
    assert_memory_equal(soft->radius, hard->radius, (size_t)hard->n * sizeof(double));
    gh_packing_destroy(&soft);
  }
  gh_packing_destroy(&hard);
}

/* A wanted pressure is met to 1 %: in the mean where the cell keeps its shape, in all directions where it
 * relaxes, and then no acoustic tensor has a negative eigenvalue. */
static void random_pressure(void **state) {
  gh_context *ctx = *state;
  for (unsigned long long seed = 1; seed <= 3; seed++) {
    print_message("seed %llu\n", seed);
    gh_packing *hard = random_packing(ctx, 80, 0.7, seed);
    const double p = 0.002;
    gh_finish_report r;
    gh_packing *soft = finished(ctx, hard, "pressure=0.002", "scaled", NAN, &r);
    judge q = judge_packing(soft);
    NEAR("pressure", q.pressure, p, 0.01 * p);
    NEAR("residual", q.residual, 0, 1e-10);
    gh_packing_destroy(&soft);
    soft = finished(ctx, hard, "pressure=0.002", "auto", NAN, &r);
    q = judge_packing(soft);
    NEAR("s11", q.stress[0], -p, 0.01 * p);
    NEAR("s22", q.stress[3], -p, 0.01 * p);
    NEAR("s12", q.stress[1], 0, 0.01 * p);
    NEAR("residual", q.residual, 0, 1e-10);
    assert_true(r.acoustic > 0);
    gh_packing_destroy(&soft);
    gh_packing_destroy(&hard);
  }
}

/* An overlap with a cell that relaxes: the overlap to 1 % and an isotropic stress at once. */
static void relaxed_overlap(void **state) {
  gh_context *ctx = *state;
  gh_packing *hard = random_packing(ctx, 80, 0.7, 5);
  gh_finish_report r;
  gh_packing *soft = finished(ctx, hard, "overlap=0.003", "relaxed", NAN, &r);
  judge q = judge_packing(soft);
  NEAR("overlap", q.overlap, 0.003, 0.00003);
  NEAR("s11 and s22", q.stress[0], q.stress[3], 1e-4 * q.pressure);
  NEAR("s12", q.stress[1], 0, 1e-4 * q.pressure);
  assert_true(r.acoustic > 0);
  gh_packing_destroy(&soft);
  gh_packing_destroy(&hard);
}

/* A stress ten times larger needs ten times the stiffness for the same packing. */
static void stiffness_scales(void **state) {
  gh_context *ctx = *state;
  gh_packing *hard = random_packing(ctx, 60, 0.7, 3), *a, *b;
  gh_finish_options o = gh_finish_defaults();
  gh_finish_report ra, rb;
  o.goal = GH_FINISH_PRESSURE, o.target = 0.001;
  OK(gh_finish(ctx, hard, &o, &a, &ra));
  o.normal_stiffness = 16, o.target = 0.016; /* powers of two scale without round-off */
  OK(gh_finish(ctx, hard, &o, &b, &rb));
  NEAR("pressure", rb.pressure, 16 * ra.pressure, 1e-6 * rb.pressure);
  NEAR("positions", distance(a->x, b->x, 2 * hard->n), 0, 1e-7);
  gh_packing_destroy(&hard);
  gh_packing_destroy(&a);
  gh_packing_destroy(&b);
}

/* The paper's anisotropies 0.02, 0.05, 0.08 are met within 0.005, in equilibrium and with the wanted overlap.
 */
static void wanted_anisotropy(void **state) {
  gh_context *ctx = *state;
  gh_packing *hard = random_packing(ctx, 100, 0.8, 2);
  static const double wanted[] = {0.02, 0.05, 0.08};
  for (int k = 0; k < 3; k++) {
    gh_finish_report r;
    gh_packing *soft = finished(ctx, hard, "overlap=0.005", "auto", wanted[k], &r);
    judge q = judge_packing(soft);
    NEAR("anisotropy", q.anisotropy, wanted[k], 0.005);
    NEAR("overlap", q.overlap, 0.005, 0.00005);
    NEAR("residual", q.residual, 0, 1e-10);
    gh_packing_destroy(&soft);
  }
  gh_packing_destroy(&hard);
}

/* An anisotropy that no grains have is refused with the nearest that was reached. */
static void impossible_anisotropy(void **state) {
  gh_context *ctx = *state;
  gh_packing *hard = random_packing(ctx, 30, 0.7, 2), *soft;
  gh_finish_options o = gh_finish_defaults();
  gh_finish_report r;
  o.target = 0.02, o.anisotropy = 0.9;
  FAILS(gh_finish(ctx, hard, &o, &soft, &r), GH_DIVERGED, "the nearest is 0.");
  assert_null(soft);
  gh_packing_destroy(&hard);
}

/* The same packing comes out to the last bit, and measuring it again states the same. */
static void reproducible(void **state) {
  gh_context *ctx = *state;
  gh_packing *hard = random_packing(ctx, 60, 0.7, 9);
  gh_finish_options o = gh_finish_defaults();
  gh_finish_report r, again;
  gh_packing *a = finished(ctx, hard, "pressure=0.003", "auto", NAN, &r),
             *b = finished(ctx, hard, "pressure=0.003", "auto", NAN, &again);
  assert_memory_equal(a->x, b->x, 2 * (size_t)a->n * sizeof(double));
  assert_memory_equal(a->cell, b->cell, sizeof a->cell);
  OK(gh_finish_measure(ctx, a, &o, &again));
  NEAR("pressure", again.pressure, r.pressure, 1e-12);
  NEAR("anisotropy", again.anisotropy, r.anisotropy, 1e-12);
  NEAR("acoustic", again.acoustic, r.acoustic, 1e-9);
  assert_int_equal(again.rattlers, r.rattlers);
  gh_packing_destroy(&hard);
  gh_packing_destroy(&a);
  gh_packing_destroy(&b);
}

/* LAMMPS finishes a packing as the native engine does. */
static void engines_agree(void **state) {
  gh_context *ctx = *state;
  if (!use_engine(GH_ENGINE_LAMMPS)) skip();
  gh_packing *hard = random_packing(ctx, 40, 0.8, 4), *soft;
  gh_finish_options o = gh_finish_defaults();
  gh_finish_report r;
  o.engine = GH_ENGINE_LAMMPS, o.target = 0.02;
  OK(gh_finish(ctx, hard, &o, &soft, &r));
  judge q = judge_packing(soft);
  NEAR("overlap", q.overlap, 0.02, 0.0002);
  NEAR("residual", q.residual, 0, 1e-10);
  gh_packing_destroy(&hard);
  gh_packing_destroy(&soft);
}

/* Words and values that make no sense are refused with a message. */
static void bad_options(void **state) {
  gh_context *ctx = *state;
  gh_finish_options o = gh_finish_defaults();
  static const char *const bad[] = {"overlap",   "overlap=",    "overlap=x",  "overlap=-1",  "overlap=0",
                                    "overlap=1", "overlap=nan", "pressure=0", "pressure=-3", "density=1",
                                    ""};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
    FAILS(gh_finish_parse(ctx, bad[k], &o), GH_INPUT, bad[k]);
  OK(gh_finish_parse(ctx, "pressure=12.5", &o));
  assert_true(o.goal == GH_FINISH_PRESSURE && o.target == 12.5);
  gh_finish_cell cell;
  assert_false(gh_finish_cell_from_name("square", &cell));
  gh_packing *p = triangular(ctx, 2, 2), *soft;
  gh_finish_report r;
  o = gh_finish_defaults(), o.normal_stiffness = -1;
  FAILS(gh_finish(ctx, p, &o, &soft, &r), GH_INPUT, "normal stiffness");
  o = gh_finish_defaults(), o.anisotropy = -0.1;
  FAILS(gh_finish(ctx, p, &o, &soft, &r), GH_INPUT, "anisotropy");
  o = gh_finish_defaults(), o.goal = GH_FINISH_PRESSURE, o.target = 3; /* grains of E = 1 would vanish */
  FAILS(gh_finish(ctx, p, &o, &soft, &r), GH_INPUT, "pressure");
  o = gh_finish_defaults(), o.target = NAN;
  FAILS(gh_finish(ctx, p, &o, &soft, &r), GH_INPUT, "overlap");
  gh_packing_destroy(&p);
}

/* A square lattice of disks on its cell's boundary leaves gaps of one lattice constant less the diameter:
 * full; without one of the boundary grains the gap is one lattice constant wider: not full. */
static void hull_of_lattice(void **state) {
  gh_context *ctx = *state;
  double radius[16], x[32], cell[4] = {4, 0, 0, 4};
  for (int i = 0; i < 16; i++) radius[i] = 0.4, x[2 * i] = i % 4, x[2 * i + 1] = i / 4;
  gh_packing *p = make_packing(ctx, 16, cell, radius, x);
  gh_hull h;
  OK(gh_hull_find(ctx, p, &h));
  NEAR("gap", h.gap, 0.2, 1e-14);
  NEAR("smallest", h.smallest, 0.8, 1e-14);
  assert_true(h.full);
  assert_int_equal(h.boundary, 7);
  gh_packing_destroy(&p);
  memmove(&x[4], &x[6], 26 * sizeof *x); /* without the grain at (2, 0) */
  p = make_packing(ctx, 15, cell, radius, x);
  OK(gh_hull_find(ctx, p, &h));
  NEAR("gap", h.gap, 1.2, 1e-14);
  assert_false(h.full);
  assert_int_equal(h.face, 0);
  assert_int_equal(h.id[0] + h.id[1], 2 + 3); /* the grains at (1, 0) and (3, 0) */
  gh_packing_destroy(&p);
}

/* The gap does not depend on the side of the face on which the grains of the chain lie, nor on the tilt of
 * the cell along it: a zigzag has the gap of its slanted links. The other face is closed by a column of
 * touching grains. */
static void hull_of_zigzag(void **state) {
  gh_context *ctx = *state;
  const double radius[8] = {0.4, 0.4, 0.4, 0.2, 0.4, 0.4, 0.4, 0.4};
  for (int tilted = 0; tilted < 2; tilted++) {
    const double tilt = tilted ? 1.3 : 0, cell[4] = {4, tilt, 0, 4};
    /* beside the lower face: (0.1, 0.3) (1.1, -0.3) (2.1, 0.3) (3.1, -0.1) and back to (4.1, 0.3) */
    double x[16] = {0.1, 0.3, 1.1 + tilt, 3.7, 2.1, 0.3, 3.1 + tilt, 3.9};
    for (int i = 4; i < 8; i++) x[2 * i + 1] = 0.3 + 0.8 * (i - 3), x[2 * i] = 0.1 + tilt * 0.2 * (i - 3);
    gh_packing *p = make_packing(ctx, 8, cell, radius, x);
    gh_hull h;
    OK(gh_hull_find(ctx, p, &h));
    NEAR("gap", h.gap, fmax(hypot(1, 0.6) - 0.8, hypot(1, 0.4) - 0.6), 1e-14);
    assert_int_equal(h.face, 0);
    gh_packing_destroy(&p);
  }
}

/* A grain in the middle of a large cell bounds nothing: the hull has a hole and is not full. */
static void hull_with_hole(void **state) {
  gh_context *ctx = *state;
  const double cell[4] = {4, 0, 0, 4}, radius = 0.5, x[2] = {2, 2};
  gh_packing *p = make_packing(ctx, 1, cell, &radius, x);
  gh_hull h;
  OK(gh_hull_find(ctx, p, &h));
  assert_true(isinf(h.gap) && h.gap > 0);
  assert_false(h.full);
  assert_int_equal(h.boundary, 0);
  assert_int_equal(h.id[0], 0);
  gh_packing_destroy(&p);
}

/* Members of an ensemble have numbers of three digits before the ending of the file. */
static void ensemble_names(void **state) {
  (void)state;
  static const char *const in[] = {"a.data", "dir.x/a", "dir/.a", "a.b.data"}, *const out[] = {
                                                                                   "a-007.data",
                                                                                   "dir.x/a-007",
                                                                                   "dir/.a-007",
                                                                                   "a.b-007.data"};
  for (int k = 0; k < 4; k++) {
    char *path = gh_ensemble_path(in[k], 7);
    assert_string_equal(path, out[k]);
    free(path);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(lattice_overlap), TEST(lattice_acoustic), TEST(random_overlap),    TEST(random_pressure),
      TEST(relaxed_overlap), TEST(stiffness_scales), TEST(wanted_anisotropy), TEST(impossible_anisotropy),
      TEST(reproducible),    TEST(engines_agree),    TEST(bad_options),       TEST(hull_of_lattice),
      TEST(hull_of_zigzag),  TEST(hull_with_hole),   TEST(ensemble_names),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
