/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS data files as others write them: labels, styles, general triclinic cells, sections that mean
 * something. */
#include "granhom/packing.h"
#include "test_io.h"

#include <time.h>

static char text[1 << 14];

static const char head[] =
    "LAMMPS data file via write_data, version 2 Aug 2023, timestep = 0, units = lj\n\n2 atoms\n2 "
    "atom types\n\n-1 1 xlo xhi\n-1 1 ylo yhi\n-0.5 0.5 zlo zhi\n\n",
                  atoms[] = "Atoms # sphere\n\n1 1 0.5 1 0.25 0 0\n2 2 1 1 -0.5 0.5 0\n\n";

static const char *put_data(place *p, const char *a, const char *b, const char *c) {
  snprintf(text, sizeof text, "%s%s%s", a, b, c);
  return put_file(p, "a.data", text);
}

/* The two grains of `atoms`. */
static void assert_grains(place *p, const char *path) {
  static const int type[] = {1, 2};
  static const double diameter[] = {0.5, 1}, x[] = {0.25, 0, 0, -0.5, 0.5, 0};
  gh_lammps_data *d;
  if (gh_lammps_data_read(p->ctx, path, &d) != GH_OK) fail_msg("%s", gh_message(p->ctx));
  assert_int_equal(d->natoms, 2);
  assert_memory_equal(d->type, type, sizeof type);
  assert_memory_equal(d->diameter, diameter, sizeof diameter);
  assert_memory_equal(d->x, x, sizeof x);
  gh_lammps_data_destroy(&d);
}

static void assert_refused(place *p, const char *path, const char *rest) {
  gh_lammps_data *d;
  char wanted[400];
  if (gh_lammps_data_read(p->ctx, path, &d) != GH_INPUT) fail_msg("read: %s", rest);
  assert_null(d);
  snprintf(wanted, sizeof wanted, "%s%s", path, rest);
  if (strncmp(gh_message(p->ctx), wanted, strlen(wanted)) != 0)
    fail_msg("\"%s\" does not begin with \"%s\"", gh_message(p->ctx), wanted);
}

/* Types by number, by label, by both. */
static void labels_are_types(void **state) {
  place *p = *state;
  static const char names[] = "Atom Type Labels\n\n2 silt\n1 quartz # the common one\n\n";
  assert_grains(p, put_data(p, head, names, atoms));
  assert_grains(
      p, put_data(p, head, names, "Atoms # sphere\n\n1 quartz 0.5 1 0.25 0 0\n2 silt 1 1 -0.5 0.5 0\n"));
  assert_grains(p, put_data(p, head, names,
                            "Masses\n\nquartz 1\nsilt 2\n\nPair Coeffs # granular\n\nquartz hertz 1\nsilt "
                            "hertz 1\n\nAtoms # sphere\n\n1 1 0.5 1 0.25 0 0\n2 silt 1 1 -0.5 0.5 0\n"));
  assert_refused(
      p, put_data(p, head, "", "Atoms\n\n1 quartz 0.5 1 0.25 0 0\n"),
      ":12: type 'quartz' is no number, and no label of a section Atom Type Labels before the atoms");
  assert_refused(p, put_data(p, head, names, "Atoms\n\n1 clay 0.5 1 0.25 0 0\n"),
                 ":17: type 'clay' is no number, and no label");
  assert_refused(p, put_data(p, head, "Atom Type Labels\n\n1 quartz\n\n", atoms),
                 ":14: 1 labels for 2 types");
  assert_refused(p, put_data(p, head, "Atom Type Labels\n\n1 quartz\n1 silt\n", atoms),
                 ":13: a second label for type 1");
  assert_refused(p, put_data(p, head, "Atom Type Labels\n\n1 silt\n2 silt\n\n", atoms),
                 ":15: two types have the label 'silt'");
  assert_refused(p, put_data(p, head, "Atom Type Labels\n\n3 silt\n", atoms),
                 ":12: type '3' is not an integer from 1 to 2");
  assert_refused(p, put_data(p, head, "Atom Type Labels\n\n1 7up\n", atoms),
                 ":12: label '7up' begins with a digit");
}

/* Styles with the values of sphere are read in their order of columns; others are named. */
static void styles_are_read_or_named(void **state) {
  place *p = *state;
  static const char rows[] = "\n\n1 1 0.5 1 0.25 0 0\n2 2 1 1 -0.5 0.5 0 0 0 0\n",
                    mixed[] = "\n\n1 1 0.25 0 0 0.5 1\n2 2 -0.5 0.5 0 1 1 0 0 0\n";
  static const char *const spheres[] = {"Atoms", "Atoms # sphere", "Atoms  #sphere", "Atoms # granular",
                                        "Atoms # id type diameter density x y z"};
  for (size_t k = 0; k < sizeof spheres / sizeof *spheres; k++)
    assert_grains(p, put_data(p, head, spheres[k], rows));
  assert_grains(p, put_data(p, head, "Atoms # hybrid sphere", mixed));
  assert_grains(p, put_data(p, head, "Atoms\t# hybrid   sphere ", mixed));
  assert_refused(p, put_data(p, head, "Atoms # hybrid", mixed),
                 ":10: the atoms are of style 'hybrid', and of which");
  assert_refused(p, put_data(p, head, "Atoms # hybrid sphere bond", mixed),
                 ":10: the atoms are of style 'hybrid sphere bond', wanted is 'sphere', or 'hybrid sphere' "
                 "and no other");
  static const char *const others[] = {"atomic", "full", "bpm/sphere", "ellipsoid", "body", "charge", "line"};
  for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
    char section[64], message[128];
    snprintf(section, sizeof section, "Atoms # %s", others[k]);
    snprintf(message, sizeof message, ":10: the atoms are of style '%s', wanted is 'sphere'", others[k]);
    assert_refused(p, put_data(p, head, section, rows), message);
  }
  assert_refused(p, put_data(p, head, "Atoms # hybrid sphere", "\n\n1 1 0.25 0 0 0.5\n"),
                 ":12: 6 words in the line of an atom; wanted: id type x y z diameter density, then");
}

/* Sections that would be lost are refused with their line; those that say nothing about grains are passed
 * over. */
static void sections_are_refused_or_passed_over(void **state) {
  place *p = *state;
  static const char *const bonded[] = {"Bonds", "Angles", "Dihedrals", "Impropers"},
                           *const shapes[] = {"Ellipsoids", "Lines", "Triangles", "Bodies"},
                           *const over[] = {"Masses\n\n1 1\n2 2\n\n",
                                            "Velocities\n\n1 0 0 0 0 0 0\n2 0 0 0 0 0 1\n\n",
                                            "Pair Coeffs # gran/hooke\n\n1 1 x\n2 1 x\n\n",
                                            "PairIJ Coeffs # granular\n\n1 1 a\n1 2 b\n2 2 c\n\n"};
  char section[128], message[128];
  for (int k = 0; k < 4; k++) {
    snprintf(section, sizeof section, "%s\n\n1 1 1 2\n", bonded[k]);
    snprintf(message, sizeof message, ":15: a section %s, which would be lost: grains act on", bonded[k]);
    assert_refused(p, put_data(p, head, atoms, section), message);
    snprintf(section, sizeof section, "%s\n\n1 1 1 2\n", shapes[k]);
    snprintf(message, sizeof message, ":15: a section %s, and only round grains are read", shapes[k]);
    assert_refused(p, put_data(p, head, atoms, section), message);
    snprintf(message, sizeof message, ":10: a section %s, and only round", shapes[k]);
    assert_refused(p, put_data(p, head, section, atoms), message);
    assert_grains(p, put_data(p, head, over[k], atoms));
    assert_grains(p, put_data(p, head, atoms, over[k]));
  }
  static const char *const counts[] = {"bonds",      "angles", "dihedrals", "impropers",
                                       "ellipsoids", "lines",  "triangles", "bodies"};
  for (int k = 0; k < 8; k++) {
    snprintf(section, sizeof section, "title\n0 %s\n%s", counts[k], strchr(head, '\n') + 1);
    assert_grains(p, put_data(p, section, atoms, ""));
    snprintf(section, sizeof section, "title\n3 %s\n%s", counts[k], strchr(head, '\n') + 1);
    snprintf(message, sizeof message, ":2: 3 %s, ", counts[k]);
    assert_refused(p, put_data(p, section, atoms, ""), message);
  }
  assert_grains(
      p,
      put_data(p, "t\n1 bond types\n2 extra bond per atom\n", strchr(head, '\n') + 1,
               "Bond Type Labels\n\n1 glue\n\nBond Coeffs\n\nglue 1 2\n\nAtoms # sphere\n\n1 1 0.5 1 0.25 0 "
               "0\n2 2 1 1 -0.5 0.5 0\n"));
  assert_refused(p, put_data(p, head, atoms, "Property\n\n1 2\n"), ":15: unknown section 'Property'");
  assert_refused(p, put_data(p, head, "Masses\n\n1 1\n2 2\nquartz 1\n", atoms),
                 ":14: unknown section 'quartz 1'");
}

static const char general[] =
    "t\n2 atoms\n2 atom types\n2 0 0 avec\n0.5 2 0 bvec\n0 0 1 cvec\n-1 -1 -0.5 abc origin\n\n";

/* A general triclinic cell in the plane is the packing of the same cell given by bounds and tilt, turned or
 * not. */
static void general_triclinic_cells(void **state) {
  place *p = *state;
  gh_packing *a, *b;
  assert_grains(p, put_data(p, general, atoms, ""));
  if (gh_packing_read(p->ctx, put_data(p, general, atoms, ""), &a) != GH_OK)
    fail_msg("%s", gh_message(p->ctx));
  const char *path =
      put_data(p, "t\n2 atoms\n2 atom types\n-1 1 xlo xhi\n-1 1 ylo yhi\n-.5 .5 zlo zhi\n0.5 0 0 xy xz yz\n",
               atoms, "");
  assert_int_equal(gh_packing_read(p->ctx, path, &b), GH_OK);
  assert_memory_equal(a->cell, b->cell, sizeof a->cell);
  assert_memory_equal(a->x, b->x, 4 * sizeof *a->x);
  gh_packing_destroy(&a);
  gh_packing_destroy(&b);
  path = put_data(p, "t\n2 atoms\n2 atom types\n0 2 0 avec\n-2 0.5 0 bvec\n0 0 1 cvec\n1 -1 0 abc origin\n\n",
                  "Atoms\n\n1 1 0.5 1 0 0.25 0\n2 2 1 1 -0.5 -0.5 0\n", "");
  if (gh_packing_read(p->ctx, path, &a) != GH_OK) fail_msg("%s", gh_message(p->ctx));
  static const double cell[] = {0, -2, 2, 0.5}, x[] = {0, 0.25, -0.5, -0.5};
  assert_memory_equal(a->cell, cell, sizeof cell);
  for (int k = 0; k < 4; k++) assert_true(fabs(a->x[k] - x[k]) < 1e-15);
  gh_packing_destroy(&a);
  static const char *const faults[][2] = {
      {"2 0 0 avec\n0.5 2 0 bvec\n",
       ":6: the header ends here and has no line 'cvec' of its general triclinic cell"},
      {"2 0 0.1 avec\n0.5 2 0 bvec\n0 0 1 cvec\n", ":4: the general triclinic cell leaves the plane"},
      {"2 0 0 avec\n0.5 2 0 bvec\n0.1 0 1 cvec\n", ":6: the general triclinic cell leaves the plane"},
      {"0.5 2 0 avec\n2 0 0 bvec\n0 0 1 cvec\n", ":4: avec, bvec and cvec must be right-handed"},
      {"2 0 0 avec\n4 0 0 bvec\n0 0 1 cvec\n", ":4: avec, bvec and cvec must be right-handed"},
      {"2 0 0 avec\n0 2 0 bvec\n0 0 1 cvec\n0 1 xlo xhi\n", ":7: the cell is given twice"},
      {"2 0 avec\n", ":4: 2 numbers before 'avec', 3 are wanted"}};
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++)
    assert_refused(p, put_data(p, "t\n2 atoms\n2 atom types\n", faults[k][0], atoms), faults[k][1]);
}

/* Lists of spheres and files of other kinds are named. */
static void other_kinds_are_named(void **state) {
  static const char *const lists[] = {
      "#format x_y_z_r\n0.1 0.2 0 0.05\n",       "0.1 0.2 0 0.05\n0.3 0.2 0 0.05\n",
      "# x y z r\n0.1\t0.2\t0\t0.05\n",          "x,y,z,r\n0.1,0.2,0,0.05\n",
      "made by hand\nx y z r\n0.1 0.2 0 0.05\n", "id x y z r\n1 0.1 0.2 0 0.05\n",
      "##PERIODIC:: 1 1 1\n0.1 0.2 0 0.05\n"};
  place *p = *state;
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
    assert_refused(
        p, put_file(p, "a.txt", lists[k]),
        ":2: a list of spheres (x y z r) has no cell, which a packing needs; docs/how-to/packing.md "
        "shows");
  assert_refused(p, put_file(p, "a.txt", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n"),
                 ":1: a LAMMPS dump, and a data");
  assert_refused(p, put_file(p, "a.vtk", "# vtk DataFile Version 3.0\nx\nASCII\n"), ":1: a VTK file");
  assert_refused(p, put_bytes(p, "a.restart", "LammpS RestartT\0\1\0", 18),
                 ":1: a binary LAMMPS restart; lmp");
  assert_refused(p, put_data(p, head, "Atoms\n\n1 1 0,5 1 0 0 0\n", ""),
                 ":12: diameter: '0,5' is not a finite number (a comma:");
}

/* Line ends of Windows, a byte order mark, tabs, comments everywhere. */
static void line_ends_and_marks_are_no_obstacle(void **state) {
  place *p = *state;
  static char other[1 << 14];
  size_t n = 3;
  memcpy(other, "\xEF\xBB\xBF", 3);
  put_data(p, head, "Masses # none\n\n1 1\n2 2\n\n", atoms);
  for (const char *c = text; *c; c++) {
    if (*c == '\n' && n > 200 && c[-1] != 'e') memcpy(other + n, " # c\r\n", 6), n += 6;
    else if (*c == '\n') memcpy(other + n, "\r\n", 2), n += 2;
    else other[n++] = *c;
  }
  other[n] = 0;
  for (char *c = strstr(other, "1 1 0.5"); *c != '\r'; c++)
    if (*c == ' ') *c = '\t';
  assert_grains(p, put_file(p, "b.data", other));
}

/* A hundred thousand atoms with labels of ten thousand types are read in a moment. */
static void many_atoms_and_labels(void **state) {
  enum { N = 100000, TYPES = 10000 };
  place *p = *state;
  gh_lammps_data *d;
  const char *path = in_folder(p, "many.data");
  FILE *f = fopen(path, "w");
  assert_non_null(f);
  fprintf(f, "t\n%d atoms\n%d atom types\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n\nAtom Type Labels\n\n", N,
          TYPES);
  for (int k = TYPES; k > 0; k--) fprintf(f, "%d label%d\n", k, k);
  fprintf(f, "\nAtoms # sphere\n\n");
  for (int k = 0; k < N; k++) fprintf(f, "%d label%d 0.1 1 0 0 0\n", k + 1, k % TYPES + 1);
  assert_int_equal(fclose(f), 0);
  clock_t begin = clock();
  if (gh_lammps_data_read(p->ctx, path, &d) != GH_OK) fail_msg("%s", gh_message(p->ctx));
  double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
  print_message("%.2f s\n", seconds);
  if (!getenv("SANITIZED")) assert_true(seconds < 5);
  for (int k = 0; k < N; k++) assert_int_equal(d->type[k], k % TYPES + 1);
  gh_lammps_data_destroy(&d);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(labels_are_types),
                                     TEST(styles_are_read_or_named),
                                     TEST(sections_are_refused_or_passed_over),
                                     TEST(general_triclinic_cells),
                                     TEST(other_kinds_are_named),
                                     TEST(line_ends_and_marks_are_no_obstacle),
                                     TEST(many_atoms_and_labels)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
