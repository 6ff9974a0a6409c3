/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The sections of LAMMPS data files. */
#include "io/lammps_data.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum {
  ATOM_WORDS = 7,     /* id type diameter density x y z */
  FLAGGED_WORDS = 10, /* and three image flags */
  MIN_ATOM_BYTES =
      14 /* "1 1 1 1 0 0 0\n": what bounds the atoms a file can hold, whatever its header states */
};

/* What a section is to granhom, and the count of its lines, which may begin with a label. */
typedef enum { READ_ATOMS, READ_LABELS, OVER, COEFFICIENTS, SHAPES, BONDED } section_kind;

static const struct {
  const char *name;
  section_kind kind;
  int count; /* a gh_data_header; -1: one for each pair of types */
} sections[] = {{"Atoms", READ_ATOMS, GH_DATA_ATOMS},
                {"Atom Type Labels", READ_LABELS, GH_DATA_TYPES},
                {"Masses", OVER, GH_DATA_TYPES},
                {"Velocities", OVER, GH_DATA_ATOMS},
                {"Pair Coeffs", COEFFICIENTS, GH_DATA_TYPES},
                {"PairIJ Coeffs", COEFFICIENTS, -1},
                {"Ellipsoids", SHAPES, GH_DATA_NONE},
                {"Lines", SHAPES, GH_DATA_NONE},
                {"Triangles", SHAPES, GH_DATA_NONE},
                {"Bodies", SHAPES, GH_DATA_NONE},
                {"Bonds", BONDED, GH_DATA_NONE},
                {"Angles", BONDED, GH_DATA_NONE},
                {"Dihedrals", BONDED, GH_DATA_NONE},
                {"Impropers", BONDED, GH_DATA_NONE},
                /* of bonds that are not there */
                {"Bond Type Labels", OVER, GH_DATA_BOND_TYPES},
                {"Angle Type Labels", OVER, GH_DATA_ANGLE_TYPES},
                {"Dihedral Type Labels", OVER, GH_DATA_DIHEDRAL_TYPES},
                {"Improper Type Labels", OVER, GH_DATA_IMPROPER_TYPES},
                {"Bond Coeffs", OVER, GH_DATA_BOND_TYPES},
                {"Angle Coeffs", OVER, GH_DATA_ANGLE_TYPES},
                {"Dihedral Coeffs", OVER, GH_DATA_DIHEDRAL_TYPES},
                {"Improper Coeffs", OVER, GH_DATA_IMPROPER_TYPES}};

/* Index of the section that a line opens, -1 when it opens none. */
static int find_section(const char *line) {
  for (size_t s = 0; s < sizeof sections / sizeof *sections; s++)
    if (strcmp(line, sections[s].name) == 0) return (int)s;
  return -1;
}

bool gh_data_opens_section(const char *line) {
  return find_section(line) >= 0;
}

static bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* ---- labels ---- */

static int by_text(const void *p, const void *q) {
  return strcmp(((const gh_data_label *)p)->text, ((const gh_data_label *)q)->text);
}

static gh_status read_label(gh_data_parser *p, char *line, bool *there) {
  char quoted[GH_QUOTE], *word[2];
  long type;
  int n = gh_words(line, 2, word);
  if (n != 2) return GH_DATA_FAIL(p, "%d words in the line of a label; wanted: a type and its label", n);
  if (!gh_parse_integer(word[0], 1, p->data->ntypes, &type))
    return GH_DATA_FAIL(p, "type '%s' is not an integer from 1 to %d (atom types, line %d)",
                        gh_quote(word[0], quoted), p->data->ntypes, p->seen[GH_DATA_TYPES]);
  if (strchr("0123456789*", *word[1]))
    return GH_DATA_FAIL(p, "label '%s' begins with a digit or a *", gh_quote(word[1], quoted));
  if (there[type - 1]) return GH_DATA_FAIL(p, "a second label for type %ld", type);
  there[type - 1] = true;
  p->labels[type - 1] = (gh_data_label){word[1], (int)type};
  return GH_OK;
}

/* Labels of all types, up to the next section, whose line it returns in *line. */
static gh_status read_label_lines(gh_data_parser *p, bool *there, char **line) {
  char quoted[GH_QUOTE];
  int n = 0;
  while ((*line = gh_data_line(p)) && !gh_data_opens_section(*line)) {
    GH_TRY(read_label(p, *line, there));
    n++;
  }
  if (n != p->data->ntypes)
    return GH_DATA_FAIL(p, "%d labels for %d types; each must have one", n, p->data->ntypes);
  if (n > 0) qsort(p->labels, (size_t)n, sizeof *p->labels, by_text);
  for (int k = 1; k < n; k++)
    if (strcmp(p->labels[k].text, p->labels[k - 1].text) == 0)
      return GH_DATA_FAIL(p, "two types have the label '%s'", gh_quote(p->labels[k].text, quoted));
  return GH_OK;
}

static gh_status read_labels(gh_data_parser *p, char **line) {
  bool *there;
  if (p->labels) return GH_DATA_FAIL(p, "%s", "a second section Atom Type Labels");
  GH_TRY(gh_alloc(p->ctx, (size_t)p->data->ntypes, sizeof *p->labels, &p->labels));
  GH_TRY(gh_alloc(p->ctx, (size_t)p->data->ntypes, sizeof *there, &there));
  gh_status s = read_label_lines(p, there, line);
  free(there);
  return s;
}

/* A type by its number or its label. */
static gh_status read_type(gh_data_parser *p, const char *text, int *type) {
  char quoted[GH_QUOTE];
  long number;
  *type = 0;
  if (gh_parse_integer(text, 1, p->data->ntypes, &number)) *type = (int)number;
  if (!*type && p->labels) {
    const gh_data_label key = {text, 0}, *found = bsearch(&key, p->labels, (size_t)p->data->ntypes,
                                                          sizeof *p->labels, by_text);
    if (found) *type = found->type;
  }
  if (*type) return GH_OK;
  if (is_letter(*text))
    return GH_DATA_FAIL(p,
                        "type '%s' is no number, and no label of a section Atom Type Labels before the atoms",
                        gh_quote(text, quoted));
  return GH_DATA_FAIL(p, "type '%s' is not an integer from 1 to %d (atom types, line %d)",
                      gh_quote(text, quoted), p->data->ntypes, p->seen[GH_DATA_TYPES]);
}

/* ---- atoms ---- */

/* Places of the values in the line of an atom, behind id and type. */
typedef struct columns {
  int diameter, density, x;
  const char *words;
} columns;

/* The styles that have these values and nothing more. */
static gh_status find_style(gh_data_parser *p, columns *c) {
  static const columns sphere = {2, 3, 4, "id type diameter density x y z"},
                       hybrid = {5, 6, 2, "id type x y z diameter density"};
  static const char *const spheres[] = {"", "sphere", "granular", "id type diameter density x y z"};
  char style[GH_QUOTE] = "", quoted[GH_QUOTE];
  size_t n = 0;
  for (const char *t = p->comment; *t && n + 1 < sizeof style; t++) /* one blank between words */
    if (!strchr(" \t", *t)) style[n++] = *t;
    else if (n && style[n - 1] != ' ') style[n++] = ' ';
  for (size_t k = 0; k < sizeof spheres / sizeof *spheres; k++)
    if (strcmp(style, spheres[k]) == 0) {
      *c = sphere;
      return GH_OK;
    }
  *c = hybrid;
  if (strcmp(style, "hybrid sphere") == 0) return GH_OK;
  if (strcmp(style, "hybrid") == 0)
    return GH_DATA_FAIL(
        p, "%s",
        "the atoms are of style 'hybrid', and of which styles is not said; wanted is 'sphere', or "
        "'hybrid sphere' and no other style (Atoms # hybrid sphere)");
  if (strncmp(style, "hybrid ", 7) == 0)
    return GH_DATA_FAIL(
        p, "the atoms are of style '%s', wanted is 'sphere', or 'hybrid sphere' and no other style",
        gh_quote(p->comment, quoted));
  return GH_DATA_FAIL(p, "the atoms are of style '%s', wanted is 'sphere'", gh_quote(p->comment, quoted));
}

static gh_status allocate_atoms(gh_data_parser *p) {
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

static gh_status read_atom(gh_data_parser *p, const columns *c, char *const *word, int n, int k) {
  static const char *const names[] = {"x", "y", "z"};
  gh_lammps_data *d = p->data;
  char quoted[GH_QUOTE];
  long id, image;
  if (n != ATOM_WORDS && n != FLAGGED_WORDS) {
    return GH_DATA_FAIL(p, "%d words in the line of an atom; wanted: %s, then three image flags or none", n,
                        c->words);
  }
  if (!gh_parse_integer(word[0], 1, INT_MAX, &id))
    return GH_DATA_FAIL(p, "id '%s' is not an integer from 1 to %d", gh_quote(word[0], quoted), INT_MAX);
  GH_TRY(read_type(p, word[1], &d->type[k]));
  GH_TRY(gh_data_number(p, word[c->diameter], "diameter", &d->diameter[k]));
  GH_TRY(gh_data_number(p, word[c->density], "density", &d->density[k]));
  for (int i = 0; i < 3; i++)
    GH_TRY(gh_data_number(p, word[c->x + i], names[i], &d->x[3 * (size_t)k + (size_t)i]));
  for (int w = ATOM_WORDS; w < n;
       w++) /* by how many cells LAMMPS moved the atom back: the same atom of the periodic packing */
    if (!gh_parse_integer(word[w], INT_MIN, INT_MAX, &image))
      return GH_DATA_FAIL(p, "image flag '%s' is not an integer", gh_quote(word[w], quoted));
  d->id[k] = (int)id;
  d->line[k] = p->r.line;
  return GH_OK;
}

/* Reads the atoms up to the next section, whose line it returns in *line (NULL at the end of the file). */
static gh_status read_atoms(gh_data_parser *p, char **line) {
  char *word[FLAGGED_WORDS];
  int k = 0, natoms = p->data->natoms;
  columns c;
  if (p->atoms_read) return GH_DATA_FAIL(p, "%s", "a second section Atoms");
  GH_TRY(find_style(p, &c));
  GH_TRY(allocate_atoms(p));
  p->atoms_read = true;
  while ((*line = gh_data_line(p))) {
    if (gh_data_opens_section(*line) || (k == natoms && is_letter(**line))) break;
    if (k == natoms)
      return GH_DATA_FAIL(p, "more atoms than the %d of the header (line %d)", natoms,
                          p->seen[GH_DATA_ATOMS]);
    GH_TRY(read_atom(p, &c, word, gh_words(*line, FLAGGED_WORDS, word), k));
    k++;
  }
  if (k == natoms) return GH_OK;
  return GH_DATA_FAIL(p, "%d atoms, but the header (line %d) states %d: the file is truncated", k,
                      p->seen[GH_DATA_ATOMS], natoms);
}

/* ---- the others ---- */

/* Passes over a section, up to the next one. Lines of types may begin with the type's label. */
static gh_status pass_section(gh_data_parser *p, int s, char **line) {
  const double types = p->data->ntypes;
  double lines = sections[s].count < 0                ? types * (types + 1) / 2
                 : sections[s].count == GH_DATA_TYPES ? types
                 : sections[s].count == GH_DATA_ATOMS ? p->data->natoms
                                                      : (double)p->count[sections[s].count];
  if (sections[s].kind == COEFFICIENTS)
    gh_log(p->ctx, GH_LEVEL_INFO,
           "%s:%d: the section %s is passed over: contacts have the law of this computation", p->r.path,
           p->r.line, sections[s].name);
  for (double k = 0; (*line = gh_data_line(p)) && !gh_data_opens_section(*line); k++)
    if (k >= lines && is_letter(**line)) break;
  return GH_OK;
}

static gh_status refuse_section(gh_data_parser *p, int s) {
  if (sections[s].kind == SHAPES)
    return GH_DATA_FAIL(p, "a section %s, and only round grains are read (atom style sphere)",
                        sections[s].name);
  return GH_DATA_FAIL(
      p,
      "a section %s, which would be lost: grains act on each other by contacts alone. To go without "
      "it, take the section out",
      sections[s].name);
}

gh_status gh_data_sections(gh_data_parser *p, char *line) {
  char quoted[GH_QUOTE];
  while (line) {
    int s = find_section(line);
    if (s < 0 && is_letter(*line)) return GH_DATA_FAIL(p, "unknown section '%s'", gh_quote(line, quoted));
    if (s < 0) line = gh_data_line(p);
    else if (sections[s].kind == READ_ATOMS) GH_TRY(read_atoms(p, &line));
    else if (sections[s].kind == READ_LABELS) GH_TRY(read_labels(p, &line));
    else if (sections[s].kind == OVER || sections[s].kind == COEFFICIENTS) GH_TRY(pass_section(p, s, &line));
    else return refuse_section(p, s);
  }
  if (!p->atoms_read) return GH_DATA_FAIL(p, "%s", "truncated: the file ends without a section Atoms");
  return GH_OK;
}
