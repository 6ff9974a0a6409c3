/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The header of LAMMPS data files: counts and the cell. */
#include "io/lammps_data.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_TYPES = 10000 /* LAMMPS's pair styles keep tables of types x types */ };

static const struct {
  const char *words;
  gh_data_header what;
  int numbers;
} headers[] = {{"atoms", GH_DATA_ATOMS, 1},
               {"atom types", GH_DATA_TYPES, 1},
               {"xlo xhi", GH_DATA_X, 2},
               {"ylo yhi", GH_DATA_Y, 2},
               {"zlo zhi", GH_DATA_Z, 2},
               {"xy xz yz", GH_DATA_TILT, 3},
               {"avec", GH_DATA_AVEC, 3},
               {"bvec", GH_DATA_BVEC, 3},
               {"cvec", GH_DATA_CVEC, 3},
               {"abc origin", GH_DATA_ORIGIN, 3},
               {"bonds", GH_DATA_NONE, 1},
               {"angles", GH_DATA_NONE, 1},
               {"dihedrals", GH_DATA_NONE, 1},
               {"impropers", GH_DATA_NONE, 1},
               {"ellipsoids", GH_DATA_NONE, 1},
               {"lines", GH_DATA_NONE, 1},
               {"triangles", GH_DATA_NONE, 1},
               {"bodies", GH_DATA_NONE, 1},
               {"bond types", GH_DATA_BOND_TYPES, 1},
               {"angle types", GH_DATA_ANGLE_TYPES, 1},
               {"dihedral types", GH_DATA_DIHEDRAL_TYPES, 1},
               {"improper types", GH_DATA_IMPROPER_TYPES, 1},
               {"extra bond per atom", GH_DATA_SPARE, 1},
               {"extra angle per atom", GH_DATA_SPARE, 1},
               {"extra dihedral per atom", GH_DATA_SPARE, 1},
               {"extra improper per atom", GH_DATA_SPARE, 1},
               {"extra special per atom", GH_DATA_SPARE, 1}};

/* Whether the n words end with the words of a header, after at least one more. *before: the words in front of
 * them. */
static bool ends_with(char *const *word, int n, const char *words, int *before) {
  int count = 1;
  for (const char *c = words; *c; c++) count += *c == ' ';
  if (n <= count) return false;
  for (int k = n - count; k < n; k++) {
    size_t length = strlen(word[k]);
    if (strncmp(word[k], words, length) != 0 || (words[length] != ' ' && words[length] != 0)) return false;
    words += length + (words[length] == ' ');
  }
  *before = n - count;
  return true;
}

static gh_status read_count(gh_data_parser *p, const char *text, const char *what, long high, int *count) {
  char quoted[GH_QUOTE];
  long value;
  if (!gh_parse_integer(text, 1, high, &value))
    return GH_DATA_FAIL(p, "the number of %s is '%s', it must be from 1 to %ld", what, gh_quote(text, quoted),
                        high);
  *count = (int)value;
  return GH_OK;
}

static gh_status read_bounds(gh_data_parser *p, char *const *word, int d) {
  double *low = &p->data->low[d], *high = &p->data->high[d];
  char name[4] = {(char)('x' + d), 'l', 'o', 0};
  GH_TRY(gh_data_number(p, word[0], name, low));
  name[1] = 'h', name[2] = 'i';
  GH_TRY(gh_data_number(p, word[1], name, high));
  /* also the size: it overflows for bounds near the largest number */
  if (!(*low < *high) || !isfinite(*high - *low)) {
    return GH_DATA_FAIL(p, "%clo = %g and %chi = %g: low must be below high by a finite size", 'x' + d, *low,
                        'x' + d, *high);
  }
  return GH_OK;
}

/* Grains have contacts and are round: bonds, triangles and the like would be lost. */
static gh_status read_none(gh_data_parser *p, const char *text, const char *words) {
  char quoted[GH_QUOTE];
  long value;
  bool shape = strcmp(words, "ellipsoids") == 0 || strcmp(words, "lines") == 0 ||
               strcmp(words, "triangles") == 0 || strcmp(words, "bodies") == 0;
  if (!gh_parse_integer(text, 0, LONG_MAX, &value))
    return GH_DATA_FAIL(p, "the number of %s is '%s', it must be an integer from 0", words,
                        gh_quote(text, quoted));
  if (value == 0) return GH_OK;
  if (shape)
    return GH_DATA_FAIL(p, "%ld %s, and only round grains are read (atom style sphere)", value, words);
  return GH_DATA_FAIL(
      p,
      "%ld %s, which would be lost: grains act on each other by contacts alone. To go without "
      "them, take this line and the section out",
      value, words);
}

static gh_status read_vector(gh_data_parser *p, char *const *word, const char *words, double v[3]) {
  for (int c = 0; c < 3; c++) GH_TRY(gh_data_number(p, word[c], words, &v[c]));
  return GH_OK;
}

static gh_status read_values(gh_data_parser *p, gh_data_header what, const char *words, char *const *word) {
  gh_lammps_data *d = p->data;
  char quoted[GH_QUOTE];
  switch (what) {
  case GH_DATA_ATOMS:
    return read_count(p, word[0], "atoms", INT_MAX / 4, &d->natoms);
  case GH_DATA_TYPES:
    return read_count(p, word[0], "atom types", MAX_TYPES, &d->ntypes);
  case GH_DATA_X:
  case GH_DATA_Y:
  case GH_DATA_Z:
    return read_bounds(p, word, (int)what - GH_DATA_X);
  case GH_DATA_TILT:
    GH_TRY(gh_data_number(p, word[0], "xy", &d->xy));
    GH_TRY(gh_data_number(p, word[1], "xz", &d->xz));
    return gh_data_number(p, word[2], "yz", &d->yz);
  case GH_DATA_AVEC:
  case GH_DATA_BVEC:
  case GH_DATA_CVEC:
  case GH_DATA_ORIGIN:
    return read_vector(p, word, words, p->vector[what - GH_DATA_AVEC]);
  case GH_DATA_NONE:
    return read_none(p, word[0], words);
  case GH_DATA_SPARE:
    return GH_OK;
  default:
    if (gh_parse_integer(word[0], 0, INT_MAX, &p->count[what])) return GH_OK;
    return GH_DATA_FAIL(p, "the number of %s is '%s', it must be an integer from 0", words,
                        gh_quote(word[0], quoted));
  }
}

/* *known: whether the words make a header line. */
static gh_status read_header(gh_data_parser *p, char *const *word, int n, bool *known) {
  *known = false;
  for (size_t h = 0; h < sizeof headers / sizeof *headers && !*known; h++) {
    int before;
    if (!ends_with(word, n, headers[h].words, &before)) continue;
    *known = true;
    gh_data_header what = headers[h].what;
    if (before != headers[h].numbers) {
      return GH_DATA_FAIL(p, "%d numbers before '%s', %d are wanted", before, headers[h].words,
                          headers[h].numbers);
    }
    if (what != GH_DATA_NONE && what != GH_DATA_SPARE && p->seen[what]) {
      return GH_DATA_FAIL(p, "'%s' occurs twice, first in line %d", headers[h].words, p->seen[what]);
    }
    p->seen[what] = p->r.line;
    GH_TRY(read_values(p, what, headers[h].words, word));
  }
  return GH_OK;
}

/* ---- files of other kinds ---- */

/* Three to eight numbers, or the names of such columns: x y z r. */
static bool lists_spheres(char *line) {
  static const char *const names[] = {"x", "y",        "z",  "r",    "rad", "radius",
                                      "d", "diameter", "id", "type", NULL};
  char *word[8];
  int numbers = 0, named = 0;
  for (char *c = line; *c; c++)
    if (strchr(",;", *c)) *c = ' ';
  int n = gh_words(line, 8, word);
  if (n < 3 || n > 8) return false;
  for (int k = 0; k < n; k++) {
    double value;
    numbers += gh_parse_number(word[k], &value);
    for (int m = 0; names[m]; m++) named += strcmp(word[k], names[m]) == 0;
  }
  return numbers == n || named == n;
}

/* A line that is no header line. Changes `line`. */
static gh_status refuse_line(gh_data_parser *p, char *line) {
  char quoted[GH_QUOTE];
  bool first = true;
  gh_quote(line, quoted);
  for (int h = 0; h < GH_DATA_HEADERS; h++) first = first && !p->seen[h];
  if (first && strncmp(p->title, "ITEM:", 5) == 0)
    return gh_fail(p->ctx, GH_INPUT,
                   "%s:1: a LAMMPS dump, and a data file is wanted: read_dump, then write_data makes one",
                   p->r.path);
  if (first && strncmp(p->title, "# vtk", 5) == 0)
    return gh_fail(p->ctx, GH_INPUT, "%s:1: a VTK file, and a LAMMPS data file is wanted", p->r.path);
  if (first && lists_spheres(line))
    return GH_DATA_FAIL(
        p, "%s",
        "a list of spheres (x y z r) has no cell, which a packing needs; docs/how-to/packing.md "
        "shows how to make a LAMMPS data file of it");
  return GH_DATA_FAIL(p, "'%s' is neither a header line nor a section of a LAMMPS data file", quoted);
}

gh_status gh_data_header_line(gh_data_parser *p, char *line) {
  enum { WORDS = 8 }; /* the longest header line has 6 */
  char *word[WORDS];
  bool known = false;
  char *copy = strdup(line);
  if (!copy) return gh_fail(p->ctx, GH_MEMORY, "%s: no memory to read it", p->r.path);
  int n = gh_words(line, WORDS, word);
  gh_status s = n <= WORDS ? read_header(p, word, n, &known) : GH_OK;
  if (s == GH_OK && !known) s = refuse_line(p, copy);
  free(copy);
  return s;
}

/* ---- the cell ---- */

static gh_status general_cell(gh_data_parser *p) {
  static const char *const names[] = {"avec", "bvec", "cvec"};
  gh_lammps_data *d = p->data;
  const double *a = p->vector[0], *b = p->vector[1], *c = p->vector[2];
  for (int k = 0; k < 3; k++)
    if (!p->seen[GH_DATA_AVEC + k])
      return GH_DATA_FAIL(p, "the header ends here and has no line '%s' of its general triclinic cell",
                          names[k]);
  for (int h = GH_DATA_X; h <= GH_DATA_TILT; h++)
    if (p->seen[h])
      return gh_fail(
          p->ctx, GH_INPUT,
          "%s:%d: the cell is given twice: here by its bounds, and as a general triclinic cell (avec, "
          "line %d)",
          p->r.path, p->seen[h], p->seen[GH_DATA_AVEC]);
  for (int k = 0; k < 2; k++)
    if (p->vector[k][2] != 0 || c[k] != 0)
      return gh_fail(
          p->ctx, GH_INPUT,
          "%s:%d: the general triclinic cell leaves the plane: avec and bvec must have z = 0, and cvec "
          "must have x = y = 0",
          p->r.path, p->seen[GH_DATA_AVEC + (c[k] != 0 ? 2 : k)]);
  const double cell[4] = {a[0], b[0], a[1], b[1]};
  double det = cell[0] * cell[3] - cell[1] * cell[2];
  if (!(det * c[2] > 0) || !isfinite(det) || !(c[2] > 0))
    return gh_fail(
        p->ctx, GH_INPUT,
        "%s:%d: avec, bvec and cvec must be right-handed, with cvec along z, and span a finite volume",
        p->r.path, p->seen[GH_DATA_AVEC]);
  d->general = true;
  memcpy(d->cell, cell, sizeof cell);
  memcpy(d->low, p->vector[3], sizeof d->low);
  const double size[3] = {a[0], b[1], c[2]};
  for (int k = 0; k < 3; k++) d->high[k] = d->low[k] + size[k];
  return GH_OK;
}

gh_status gh_data_header_end(gh_data_parser *p) {
  bool general = false;
  for (int h = GH_DATA_AVEC; h <= GH_DATA_ORIGIN; h++) general = general || p->seen[h];
  for (size_t h = 0; h < sizeof headers / sizeof *headers; h++) {
    gh_data_header what = headers[h].what;
    if (what > (general ? GH_DATA_TYPES : GH_DATA_Z) || p->seen[what]) continue;
    return GH_DATA_FAIL(p,
                        "the header ends here and has no line '%s' (the first line of the file is a title)",
                        headers[h].words);
  }
  return general ? general_cell(p) : GH_OK;
}
