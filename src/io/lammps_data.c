/* LAMMPS data files of atom_style sphere. SPDX-License-Identifier: GPL-2.0-or-later
 * The format: https://docs.lammps.org/read_data.html. The first line is a title; then header lines, whose
 * words stand behind their numbers, in any order; then sections, each opened by a line with its name. */
#include "io/file.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum {
  MOST_MEGABYTES = 512,
  MAX_TYPES = 10000,  /* LAMMPS's pair styles keep tables of types x types */
  ATOM_WORDS = 7,     /* id type diameter density x y z */
  FLAGGED_WORDS = 10, /* and three image flags */
  MIN_ATOM_BYTES = 14 /* "1 1 1 1 0 0 0\n": what bounds the atoms a file can hold, whatever its header says */
};

typedef enum { ATOMS, TYPES, X, Y, Z, TILT, OTHER, NHEADERS } header;

typedef struct {
  gh_context *ctx;
  gh_reader r;
  gh_lammps_data *data;
  int seen[NHEADERS]; /* line of each header, 0 while missing */
  bool atoms_read;
  const char *comment; /* of the line that was read last, "" when it has none */
} parser;

/* A message about the line that was read last. */
#define FAIL_HERE(p, format, ...)                                                                            \
  gh_fail((p)->ctx, GH_INPUT, "%s:%d: " format, (p)->r.path, (p)->r.line, __VA_ARGS__)

/* The next line that says something, without blanks around it and without its comment; NULL at the end. */
static char *next_line(parser *p) {
  char *line;
  while ((line = gh_reader_line(&p->r))) {
    char *hash = strchr(line, '#');
    p->comment = hash ? gh_trim(hash + 1) : "";
    if (hash) *hash = 0;
    line = gh_trim(line);
    if (*line) return line;
  }
  return NULL;
}

/* ---- header ---- */

static const struct {
  const char *words;
  header what;
  int numbers;
} headers[] = {{"atoms", ATOMS, 1},
               {"atom types", TYPES, 1},
               {"xlo xhi", X, 2},
               {"ylo yhi", Y, 2},
               {"zlo zhi", Z, 2},
               {"xy xz yz", TILT, 3},
               /* counts of things that grains do not have */
               {"bonds", OTHER, 1},
               {"angles", OTHER, 1},
               {"dihedrals", OTHER, 1},
               {"impropers", OTHER, 1},
               {"bond types", OTHER, 1},
               {"angle types", OTHER, 1},
               {"dihedral types", OTHER, 1},
               {"improper types", OTHER, 1},
               {"extra bond per atom", OTHER, 1},
               {"extra angle per atom", OTHER, 1},
               {"extra dihedral per atom", OTHER, 1},
               {"extra improper per atom", OTHER, 1},
               {"extra special per atom", OTHER, 1},
               {"ellipsoids", OTHER, 1},
               {"lines", OTHER, 1},
               {"triangles", OTHER, 1},
               {"bodies", OTHER, 1}};

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

static gh_status read_count(parser *p, const char *text, const char *what, long high, int *count) {
  char quoted[GH_QUOTE];
  long value;
  if (!gh_parse_integer(text, 1, high, &value))
    return FAIL_HERE(p, "the number of %s is '%s', it must be from 1 to %ld", what, gh_quote(text, quoted),
                     high);
  *count = (int)value;
  return GH_OK;
}

static gh_status read_number(parser *p, const char *text, const char *what, double *value) {
  char quoted[GH_QUOTE];
  if (gh_parse_number(text, value)) return GH_OK;
  return FAIL_HERE(p, "%s: '%s' is not a finite number", what, gh_quote(text, quoted));
}

static gh_status read_bounds(parser *p, char *const *word, int d) {
  double *low = &p->data->low[d], *high = &p->data->high[d];
  char name[4] = {(char)('x' + d), 'l', 'o', 0};
  GH_TRY(read_number(p, word[0], name, low));
  memcpy(name + 1, "hi", 2);
  GH_TRY(read_number(p, word[1], name, high));
  /* also the size: it overflows for bounds near the largest number */
  if (!(*low < *high) || !isfinite(*high - *low)) {
    return FAIL_HERE(p, "%clo = %g and %chi = %g: low must be below high by a finite size", 'x' + d, *low,
                     'x' + d, *high);
  }
  return GH_OK;
}

static gh_status read_header_values(parser *p, header what, char *const *word) {
  gh_lammps_data *d = p->data;
  switch (what) {
  case ATOMS:
    return read_count(p, word[0], "atoms", INT_MAX / 4, &d->natoms);
  case TYPES:
    return read_count(p, word[0], "atom types", MAX_TYPES, &d->ntypes);
  case X:
  case Y:
  case Z:
    return read_bounds(p, word, (int)what - X);
  case TILT:
    GH_TRY(read_number(p, word[0], "xy", &d->xy));
    GH_TRY(read_number(p, word[1], "xz", &d->xz));
    return read_number(p, word[2], "yz", &d->yz);
  default:
    return GH_OK;
  }
}

/* *known: whether the words make a header line. */
static gh_status read_header(parser *p, char *const *word, int n, bool *known) {
  *known = false;
  for (size_t h = 0; h < sizeof headers / sizeof *headers && !*known; h++) {
    int before;
    if (!ends_with(word, n, headers[h].words, &before)) continue;
    *known = true;
    header what = headers[h].what;
    if (before != headers[h].numbers) {
      return FAIL_HERE(p, "%d numbers before '%s', %d are wanted", before, headers[h].words,
                       headers[h].numbers);
    }
    if (what != OTHER && p->seen[what]) {
      return FAIL_HERE(p, "'%s' occurs twice, first in line %d", headers[h].words, p->seen[what]);
    }
    p->seen[what] = p->r.line;
    GH_TRY(read_header_values(p, what, word));
  }
  return GH_OK;
}

static gh_status check_header(parser *p) {
  for (size_t h = 0; h < sizeof headers / sizeof *headers; h++) {
    header what = headers[h].what;
    if (what == TILT || what == OTHER || p->seen[what]) continue;
    return FAIL_HERE(p, "the header ends here and has no line '%s' (the first line of the file is a title)",
                     headers[h].words);
  }
  return GH_OK;
}

/* ---- sections ---- */

static const char *const sections[] = {"Atoms",
                                       "Masses",
                                       "Velocities",
                                       "Pair Coeffs",
                                       "PairIJ Coeffs",
                                       "Bond Coeffs",
                                       "Angle Coeffs",
                                       "Dihedral Coeffs",
                                       "Improper Coeffs",
                                       "Bonds",
                                       "Angles",
                                       "Dihedrals",
                                       "Impropers",
                                       "Ellipsoids",
                                       "Lines",
                                       "Triangles",
                                       "Bodies",
                                       "Atom Type Labels",
                                       "Bond Type Labels",
                                       "Angle Type Labels",
                                       "Dihedral Type Labels",
                                       "Improper Type Labels"};

/* Index of the section that a line opens, -1 when it opens none. */
static int find_section(const char *line) {
  for (size_t s = 0; s < sizeof sections / sizeof *sections; s++)
    if (strcmp(line, sections[s]) == 0) return (int)s;
  return -1;
}

static bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static gh_status allocate_atoms(parser *p) {
  gh_lammps_data *d = p->data;
  size_t left = p->r.length - (size_t)(p->r.next - p->r.text), n = left / MIN_ATOM_BYTES + 1;
  if (n > (size_t)d->natoms) n = (size_t)d->natoms;
  GH_TRY(gh_alloc(p->ctx, n, sizeof *d->id, &d->id));
  GH_TRY(gh_alloc(p->ctx, n, sizeof *d->type, &d->type));
  GH_TRY(gh_alloc(p->ctx, n, sizeof *d->line, &d->line));
  GH_TRY(gh_alloc(p->ctx, n, sizeof *d->diameter, &d->diameter));
  GH_TRY(gh_alloc(p->ctx, n, sizeof *d->density, &d->density));
  return gh_alloc(p->ctx, 3 * n, sizeof *d->x, &d->x);
}

static gh_status read_atom(parser *p, char *const *word, int n, int k) {
  gh_lammps_data *d = p->data;
  char quoted[GH_QUOTE];
  long id, type, image;
  if (n != ATOM_WORDS && n != FLAGGED_WORDS) {
    return FAIL_HERE(p,
                     "%d words in the line of an atom; wanted: id type diameter density x y z, then three "
                     "image flags or none",
                     n);
  }
  if (!gh_parse_integer(word[0], 1, INT_MAX, &id))
    return FAIL_HERE(p, "id '%s' is not an integer from 1 to %d", gh_quote(word[0], quoted), INT_MAX);
  if (!gh_parse_integer(word[1], 1, d->ntypes, &type)) {
    return FAIL_HERE(p, "type '%s' is not an integer from 1 to %d (atom types, line %d)",
                     gh_quote(word[1], quoted), d->ntypes, p->seen[TYPES]);
  }
  GH_TRY(read_number(p, word[2], "diameter", &d->diameter[k]));
  GH_TRY(read_number(p, word[3], "density", &d->density[k]));
  for (int c = 0; c < 3; c++) {
    static const char *const names[] = {"x", "y", "z"};
    GH_TRY(read_number(p, word[4 + c], names[c], &d->x[3 * k + c]));
  }
  for (int w = ATOM_WORDS; w < n;
       w++) /* by how many cells LAMMPS moved the atom back: the same atom of the periodic packing */
    if (!gh_parse_integer(word[w], INT_MIN, INT_MAX, &image))
      return FAIL_HERE(p, "image flag '%s' is not an integer", gh_quote(word[w], quoted));
  d->id[k] = (int)id;
  d->type[k] = (int)type;
  d->line[k] = p->r.line;
  return GH_OK;
}

/* Reads the atoms up to the next section, whose line it returns in *line (NULL at the end of the file). */
static gh_status read_atoms(parser *p, char **line) {
  char quoted[GH_QUOTE], *word[FLAGGED_WORDS];
  int k = 0, natoms = p->data->natoms;
  if (p->atoms_read) return FAIL_HERE(p, "%s", "a second section Atoms");
  if (*p->comment && strcmp(p->comment, "sphere") != 0)
    return FAIL_HERE(p, "the atoms are of style '%s', wanted is 'sphere'", gh_quote(p->comment, quoted));
  GH_TRY(allocate_atoms(p));
  p->atoms_read = true;
  while ((*line = next_line(p))) {
    if (find_section(*line) >= 0 || (k == natoms && is_letter(**line))) break;
    if (k == natoms)
      return FAIL_HERE(p, "more atoms than the %d of the header (line %d)", natoms, p->seen[ATOMS]);
    GH_TRY(read_atom(p, word, gh_words(*line, FLAGGED_WORDS, word), k));
    k++;
  }
  if (k == natoms) return GH_OK;
  return FAIL_HERE(p, "%d atoms, but the header (line %d) says %d: the file is truncated", k, p->seen[ATOMS],
                   natoms);
}

/* The sections behind the header, beginning with the one that `line` opens. */
static gh_status read_sections(parser *p, char *line) {
  char quoted[GH_QUOTE];
  while (line) {
    int section = find_section(line);
    if (section < 0 && is_letter(*line)) return FAIL_HERE(p, "unknown section '%s'", gh_quote(line, quoted));
    if (section == 0) GH_TRY(read_atoms(p, &line));
    else line = next_line(p);
  }
  if (!p->atoms_read) return FAIL_HERE(p, "%s", "truncated: the file ends without a section Atoms");
  return GH_OK;
}

static gh_status read_file(parser *p) {
  enum { WORDS = 8 }; /* the longest header line has 6 */
  char *line, *word[WORDS], quoted[GH_QUOTE];
  gh_reader_line(&p->r); /* title */
  while ((line = next_line(p))) {
    if (find_section(line) >= 0) {
      GH_TRY(check_header(p));
      return read_sections(p, line);
    }
    bool known = false;
    gh_quote(line, quoted);
    int n = gh_words(line, WORDS, word);
    if (n <= WORDS) GH_TRY(read_header(p, word, n, &known));
    if (!known)
      return FAIL_HERE(p, "'%s' is neither a header line nor a section of a LAMMPS data file", quoted);
  }
  return FAIL_HERE(p, "%s", "truncated: the file ends without a section Atoms");
}

gh_status gh_lammps_data_read(gh_context *ctx, const char *path, gh_lammps_data **data) {
  *data = NULL;
  parser p = {.ctx = ctx};
  GH_TRY(gh_reader_open_most(ctx, path, MOST_MEGABYTES, &p.r));
  gh_status s = gh_alloc(ctx, 1, sizeof *p.data, &p.data);
  if (s == GH_OK) s = read_file(&p);
  gh_reader_close(&p.r);
  if (s == GH_OK) *data = p.data;
  else gh_lammps_data_destroy(&p.data);
  return s;
}

void gh_lammps_data_destroy(gh_lammps_data **data) {
  if (!data || !*data) return;
  gh_lammps_data *d = *data;
  free(d->id);
  free(d->type);
  free(d->line);
  free(d->diameter);
  free(d->density);
  free(d->x);
  free(d);
  *data = NULL;
}

/* ---- writing ---- */

/* What the reader would refuse is never written. */
static gh_status check_data(gh_context *ctx, const char *path, const gh_lammps_data *d) {
  const double tilt[3] = {d->xy, d->xz, d->yz};
  if (d->natoms < 1 || d->ntypes < 1) {
    return gh_fail(ctx, GH_INTERNAL, "%s: %d atoms of %d types to be written, at least 1 each is wanted",
                   path, d->natoms, d->ntypes);
  }
  for (int c = 0; c < 3; c++) {
    if (!(d->low[c] < d->high[c]) || !isfinite(d->high[c] - d->low[c]) || !isfinite(tilt[c]))
      return gh_fail(ctx, GH_INTERNAL, "%s: a cell without a finite size was to be written", path);
  }
  for (int k = 0; k < d->natoms; k++) {
    const double value[5] = {d->diameter[k], d->density[k], d->x[3 * (size_t)k], d->x[3 * (size_t)k + 1],
                             d->x[3 * (size_t)k + 2]};
    if (!gh_finite(value, 5) || d->id[k] < 1 || d->type[k] < 1 || d->type[k] > d->ntypes) {
      return gh_fail(ctx, GH_INTERNAL, "%s: atom %d (type %d) has a value that cannot be written", path,
                     d->id[k], d->type[k]);
    }
  }
  return GH_OK;
}

static void print_data(gh_text *t, const char *title, const gh_lammps_data *d) {
  static const char axis[] = "xyz";
  gh_text_print(t, "%.*s\n\n%d atoms\n%d atom types\n\n", (int)strcspn(title, "\r\n"), title, d->natoms,
                d->ntypes);
  for (int c = 0; c < 3; c++)
    gh_text_print(t, "%.17g %.17g %clo %chi\n", d->low[c], d->high[c], axis[c], axis[c]);
  if (d->xy != 0 || d->xz != 0 || d->yz != 0)
    gh_text_print(t, "%.17g %.17g %.17g xy xz yz\n", d->xy, d->xz, d->yz);
  gh_text_print(t, "\nAtoms # sphere\n\n");
  for (int k = 0; k < d->natoms; k++) {
    const double *x = d->x + 3 * (size_t)k;
    gh_text_print(t, "%d %d %.17g %.17g %.17g %.17g %.17g\n", d->id[k], d->type[k], d->diameter[k],
                  d->density[k], x[0], x[1], x[2]);
  }
}

gh_status gh_lammps_data_write(gh_context *ctx, const char *path, const char *title,
                               const gh_lammps_data *data) {
  gh_text *text;
  GH_TRY(check_data(ctx, path, data));
  GH_TRY(gh_text_create(ctx, &text));
  print_data(text, title, data);
  gh_status s = gh_text_commit(text, path);
  gh_text_destroy(&text);
  return s;
}
