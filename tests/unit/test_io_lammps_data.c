/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Tests of LAMMPS data files. */
#include "test_io.h"

static const char header[] = "title\n2 atoms\n3 atom types\n-1 1 xlo xhi\n0 2 ylo yhi\n-.5 .5 zlo zhi\n";

/* A packing of the reference cases: its size, first and last atom as they stand in the file. */
static void a_packing_of_the_cases_is_read(void **state) {
  place *p = *state;
  gh_lammps_data *d;
  assert_int_equal(gh_lammps_data_read(p->ctx, "tests/data/cases/packings/block150.data", &d), GH_OK);
  assert_int_equal(d->natoms, 150);
  assert_int_equal(d->ntypes, 1);
  assert_true(d->low[0] == -0.77849463407422481 && d->high[1] == 0.77849463407422481 && d->high[2] == 0.5);
  assert_true(d->xy == 0 && d->xz == 0 && d->yz == 0);
  assert_int_equal(d->id[0], 1);
  assert_int_equal(d->line[0], 12);
  assert_true(d->diameter[0] == 0.25 && d->x[0] == -0.31430713103258934 && d->x[1] == -0.10010482781317376);
  assert_int_equal(d->line[149], 161);
  gh_lammps_data_destroy(&d);
  assert_null(d);
  gh_lammps_data_destroy(&d);
}

/* Header in any order with comments, sections before and behind the atoms, image flags, ids in any order, CR
 * LF, a tilted cell. */
static void everything_that_is_allowed_is_read(void **state) {
  place *p = *state;
  gh_lammps_data *d;
  assert_int_equal(gh_lammps_data_read(p->ctx, "tests/data/io/everything.data", &d), GH_OK);
  assert_int_equal(d->natoms, 3);
  assert_int_equal(d->ntypes, 2);
  assert_true(d->xy == 0.25 && d->xz == 0 && d->yz == -0.125);
  static const int id[] = {7, 3, 5}, type[] = {1, 2, 2}, line[] = {22, 24, 25};
  static const double diameter[] = {.5, 1, 0.75}, density[] = {1, 2, 3},
                      x[] = {0, 0.5, 0, 1, 1.5, 0, -1e-3, 0.25, 0};
  assert_memory_equal(d->id, id, sizeof id);
  assert_memory_equal(d->type, type, sizeof type);
  assert_memory_equal(d->line, line, sizeof line);
  assert_memory_equal(d->diameter, diameter, sizeof diameter);
  assert_memory_equal(d->density, density, sizeof density);
  assert_memory_equal(d->x, x, sizeof x);
  gh_lammps_data_destroy(&d);
}

/* What is written comes back bit by bit, with and without tilt. */
static void a_round_trip_is_bitwise(void **state) {
  enum { N = 200 };
  place *p = *state;
  int id[N], type[N];
  double diameter[N], density[N], x[3 * N];
  gh_lammps_data d = {.natoms = N,
                      .ntypes = 4,
                      .low = {-1 / 3., -0.1, -.5},
                      .high = {1 / 3., 0.7, .5},
                      .id = id,
                      .type = type,
                      .diameter = diameter,
                      .density = density,
                      .x = x},
                 *r;
  srand(11);
  print_message("seed 11\n");
  for (int k = 0; k < N; k++) {
    id[k] = N - k, type[k] = 1 + rand() % 4, diameter[k] = rand() / 3e9, density[k] = 1e3 * rand() / 7.;
    for (int c = 0; c < 3; c++) x[3 * k + c] = (rand() - RAND_MAX / 2) / 3e9;
  }
  const char *path = in_folder(p, "a.data");
  for (int tilted = 0; tilted < 2; tilted++) {
    d.xy = tilted ? 0.1 : 0, d.yz = tilted ? -1 / 7. : 0;
    assert_int_equal(gh_lammps_data_write(p->ctx, path, "a title\nof two lines", &d), GH_OK);
    assert_int_equal(gh_lammps_data_read(p->ctx, path, &r), GH_OK);
    assert_int_equal(r->natoms, N);
    assert_int_equal(r->ntypes, 4);
    assert_memory_equal(r->low, d.low, sizeof d.low);
    assert_memory_equal(r->high, d.high, sizeof d.high);
    assert_true(r->xy == d.xy && r->xz == d.xz && r->yz == d.yz);
    assert_memory_equal(r->id, id, sizeof id);
    assert_memory_equal(r->type, type, sizeof type);
    assert_memory_equal(r->diameter, diameter, sizeof diameter);
    assert_memory_equal(r->density, density, sizeof density);
    assert_memory_equal(r->x, x, sizeof x);
    gh_lammps_data_destroy(&r);
  }
}

/* The writer refuses what the reader would refuse, and a full disk, and leaves the file of before. */
static void the_writer_refuses(void **state) {
  place *p = *state;
  int id[200], type[200];
  double diameter[200], density[200], x[600] = {0};
  gh_lammps_data d = {.natoms = 200,
                      .ntypes = 1,
                      .high = {1, 1, 1},
                      .id = id,
                      .type = type,
                      .diameter = diameter,
                      .density = density,
                      .x = x};
  for (int k = 0; k < 200; k++) id[k] = k + 1, type[k] = 1, diameter[k] = 1 / 3., density[k] = 1;
  const char *path = put_file(p, "a.data", "before");
  x[4] = NAN;
  assert_int_equal(gh_lammps_data_write(p->ctx, path, "t", &d), GH_INTERNAL);
  assert_message(p, path, ": atom 2 (type 1) has a value that cannot be written");
  x[4] = 0, type[1] = 2;
  assert_int_equal(gh_lammps_data_write(p->ctx, path, "t", &d), GH_INTERNAL);
  type[1] = 1, d.high[2] = 0;
  assert_int_equal(gh_lammps_data_write(p->ctx, path, "t", &d), GH_INTERNAL);
  assert_message(p, path, ": a cell without a finite size was to be written");
  d.high[2] = 1, d.natoms = 0;
  assert_int_equal(gh_lammps_data_write(p->ctx, path, "t", &d), GH_INTERNAL);
  d.natoms = 200;
  limit_files(4096);
  gh_status s = gh_lammps_data_write(p->ctx, path, "t", &d);
  limit_files(RLIM_INFINITY);
  assert_int_equal(s, GH_SYSTEM);
  assert_message(p, path, ": cannot write: File too large");
  size_t length;
  char *text = get_file(path, &length);
  assert_string_equal(text, "before");
  free(text);
  assert_int_equal(count_entries(p->folder), 1);
}

static void assert_refused(place *p, const char *text, const char *message) {
  const char *path = put_file(p, "a.data", text);
  gh_lammps_data *d;
  assert_int_equal(gh_lammps_data_read(p->ctx, path, &d), GH_INPUT);
  assert_null(d);
  assert_message(p, path, message);
}

/* Faults of the header: counts, bounds, missing, twice, unknown, cut off. */
static void faults_of_the_header(void **state) {
  static const char *const faults[][2] = {
      {"", ": the file is empty"},
      {"title", ":1: truncated: the file ends without a section Atoms"},
      {"title\n2 atoms\n1 atom ty",
       ":3: '1 atom ty' is neither a header line nor a section of a LAMMPS data file"},
      {"t\n0 atoms\n", ":2: the number of atoms is '0', it must be from 1 to 536870911"},
      {"t\n-3 atoms\n", ":2: the number of atoms is '-3', it must be from 1 to 536870911"},
      {"t\n99999999999999999999 atoms\n",
       ":2: the number of atoms is '99999999999999999999', it must be from 1 to 536870911"},
      {"t\n1e3 atoms\n", ":2: the number of atoms is '1e3', it must be from 1 to 536870911"},
      {"t\n2000000000 atom types\n",
       ":2: the number of atom types is '2000000000', it must be from 1 to 10000"},
      {"t\n1 2 atoms\n", ":2: 2 numbers before 'atoms', 1 are wanted"},
      {"t\n1 xlo xhi\n", ":2: 1 numbers before 'xlo xhi', 2 are wanted"},
      {"t\n0 nan xlo xhi\n", ":2: xhi: 'nan' is not a finite number"},
      {"t\n0x1 1 ylo yhi\n", ":2: ylo: '0x1' is not a finite number"},
      {"t\n1 1 zlo zhi\n", ":2: zlo = 1 and zhi = 1: low must be below high by a finite size"},
      {"t\n-1e308 1e308 xlo xhi\n",
       ":2: xlo = -1e+308 and xhi = 1e+308: low must be below high by a finite size"},
      {"t\n0 0 inf xy xz yz\n", ":2: yz: 'inf' is not a finite number"},
      {"t\n\n1 atoms\n# c\n1 atoms\n", ":5: 'atoms' occurs twice, first in line 3"},
      {"t\n1 atoms\n1 atom types\n0 1 xlo xhi\n0 1 zlo zhi\n\nAtoms\n",
       ":7: the header ends here and has no line 'ylo yhi' (the first line of the file is a title)"},
      {"1 atoms\n1 atom types\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\nAtoms\n",
       ":6: the header ends here and has no line 'atoms' (the first line of the file is a title)"},
      {"t\nhello world\n", ":2: 'hello world' is neither a header line nor a section of a LAMMPS data file"},
      {"t\na b c d e f g h i j\n",
       ":2: 'a b c d e f g h i j' is neither a header line nor a section of a LAMMPS data file"},
      {"t\n\x01\x02\n", ":2: '\?\?' is neither a header line nor a section of a LAMMPS data file"},
  };
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++)
    assert_refused(*state, faults[k][0], faults[k][1]);
}

/* Faults behind the header: styles, words, ids, types, numbers, too few and too many atoms. */
static void faults_of_the_sections(void **state) {
  static const char *const faults[][2] = {
      {"Masses\n\n1 1\n", ":9: truncated: the file ends without a section Atoms"},
      {"Atoms # atomic\n", ":7: the atoms are of style 'atomic', wanted is 'sphere'"},
      {"Atoms\n\n1 1 1 1 0 0\n", ":9: 6 words in the line of an atom; wanted: id type diameter density x y "
                                 "z, then three image flags or none"},
      {"Atoms\n\n1 1 1 1 0 0 0 1\n", ":9: 8 words in the line of an atom; wanted: id type diameter density x "
                                     "y z, then three image flags or none"},
      {"Atoms\n\n0 1 1 1 0 0 0\n", ":9: id '0' is not an integer from 1 to 2147483647"},
      {"Atoms\n\n4294967297 1 1 1 0 0 0\n", ":9: id '4294967297' is not an integer from 1 to 2147483647"},
      {"Atoms\n\nnan 1 1 1 0 0 0\n", ":9: id 'nan' is not an integer from 1 to 2147483647"},
      {"Atoms\n\n1 4 1 1 0 0 0\n", ":9: type '4' is not an integer from 1 to 3 (atom types, line 3)"},
      {"Atoms\n\n1 1 x 1 0 0 0\n", ":9: diameter: 'x' is not a finite number"},
      {"Atoms\n\n1 1 1 1m 0 0 0\n", ":9: density: '1m' is not a finite number"},
      {"Atoms\n\n1 1 1 1 0 inf 0\n", ":9: y: 'inf' is not a finite number"},
      {"Atoms\n\n1 1 1 1 0 0 0 0 0.5 0\n", ":9: image flag '0.5' is not an integer"},
      {"Atoms\n\n1 1 1 1 0 0 0\n", ":9: 1 atoms, but the header (line 2) states 2: the file is truncated"},
      {"Atoms\n\n1 1 1 1 0 0 0\n2 1 1 1 1 0", ":10: 6 words in the line of an atom; wanted: id type diameter "
                                              "density x y z, then three image flags or none"},
      {"Atoms\n1 1 1 1 0 0 0\n2 1 1 1 0 0 0\n3 1 1 1 0 0 0\n",
       ":10: more atoms than the 2 of the header (line 2)"},
      {"Atoms\n1 1 1 1 0 0 0\n2 1 1 1 0 0 0\nAtoms\n", ":10: a second section Atoms"},
      {"Atoms\n1 1 1 1 0 0 0\n2 1 1 1 0 0 0\n\nSpeeds\n", ":11: unknown section 'Speeds'"},
  };
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    char text[512];
    snprintf(text, sizeof text, "%s%s", header, faults[k][0]);
    assert_refused(*state, text, faults[k][1]);
  }
}

/* A header that promises half a billion atoms to a file of two lines costs no memory to speak of. */
static void promised_atoms_take_no_memory(void **state) {
  struct rlimit limit, kept;
  assert_int_equal(getrlimit(RLIMIT_AS, &kept), 0);
  limit = kept;
  limit.rlim_cur = (rlim_t)1 << 30;
  if (kept.rlim_max != RLIM_INFINITY && kept.rlim_max < limit.rlim_cur) limit.rlim_cur = kept.rlim_max;
  bool limited = !getenv("SANITIZED") && setrlimit(RLIMIT_AS, &limit) == 0;
  assert_refused(
      *state,
      "t\n500000000 atoms\n1 atom types\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\nAtoms\n\n1 1 1 1 0 0 0\n",
      ":9: 1 atoms, but the header (line 2) states 500000000: the file is truncated");
  if (limited) setrlimit(RLIMIT_AS, &kept);
}

/* Missing files, folders and binary files. */
static void what_is_no_text_file_is_refused(void **state) {
  place *p = *state;
  gh_lammps_data *d;
  const char *path = in_folder(p, "none.data");
  assert_int_equal(gh_lammps_data_read(p->ctx, path, &d), GH_INPUT);
  assert_message(p, path, ": cannot be opened: No such file or directory");
  assert_int_equal(gh_lammps_data_read(p->ctx, p->folder, &d), GH_INPUT);
  assert_message(p, p->folder, ": is a folder, a file is wanted");
  path = put_bytes(p, "b.data",
                   "\x7f"
                   "ELF\0\0",
                   6);
  assert_int_equal(gh_lammps_data_read(p->ctx, path, &d), GH_INPUT);
  assert_message(p, path, ":1: not a text file: it holds a zero byte");
}

/* A file cut after any byte is read or refused, never more than that; it is whole only without its last
 * digits or line end. */
static void a_file_cut_anywhere_is_safe(void **state) {
  place *p = *state;
  size_t length;
  char *text = get_file("tests/data/io/everything.data", &length);
  int whole = 0;
  for (size_t n = 1; n < length; n++) {
    gh_lammps_data *d;
    gh_status s = gh_lammps_data_read(p->ctx, put_bytes(p, "a.data", text, n), &d);
    assert_true(s == GH_OK || s == GH_INPUT);
    if (s == GH_OK) assert_int_equal(d->natoms, 3);
    whole += s == GH_OK;
    gh_lammps_data_destroy(&d);
  }
  assert_true(whole > 0 && whole < 200);
  free(text);
}

/* Bytes changed at random give a packing or a message, never a crash. */
static void random_damage_is_safe(void **state) {
  place *p = *state;
  size_t length;
  char *text = get_file("tests/data/io/everything.data", &length);
  srand(5);
  print_message("seed 5\n");
  for (int k = 0; k < 2000; k++) {
    gh_lammps_data *d;
    char *damaged = malloc(length);
    memcpy(damaged, text, length);
    for (int c = 0; c < 4; c++) damaged[(size_t)rand() % length] = (char)(1 + rand() % 255);
    gh_status s = gh_lammps_data_read(p->ctx, put_bytes(p, "a.data", damaged, length), &d);
    assert_true(s == GH_OK || s == GH_INPUT);
    assert_true((s == GH_OK) == (d != NULL));
    gh_lammps_data_destroy(&d);
    free(damaged);
  }
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(a_packing_of_the_cases_is_read), TEST(everything_that_is_allowed_is_read),
      TEST(a_round_trip_is_bitwise),        TEST(the_writer_refuses),
      TEST(faults_of_the_header),           TEST(faults_of_the_sections),
      TEST(promised_atoms_take_no_memory),  TEST(what_is_no_text_file_is_refused),
      TEST(a_file_cut_anywhere_is_safe),    TEST(random_damage_is_safe)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
