/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the files of the reader of LAMMPS data files share. */
#ifndef GRANHOM_IO_LAMMPS_DATA_H
#define GRANHOM_IO_LAMMPS_DATA_H

#include "io/file.h"

typedef enum {
  GH_DATA_ATOMS,
  GH_DATA_TYPES,
  GH_DATA_X,
  GH_DATA_Y,
  GH_DATA_Z,
  GH_DATA_TILT,
  GH_DATA_AVEC, /* general triclinic */
  GH_DATA_BVEC,
  GH_DATA_CVEC,
  GH_DATA_ORIGIN,
  GH_DATA_BOND_TYPES, /* these four: how many lines their coefficients have */
  GH_DATA_ANGLE_TYPES,
  GH_DATA_DIHEDRAL_TYPES,
  GH_DATA_IMPROPER_TYPES,
  GH_DATA_NONE, /* a count of things that grains do not have; must be 0 */
  GH_DATA_SPARE,
  GH_DATA_HEADERS
} gh_data_header;

typedef struct gh_data_label {
  const char *text; /* points into the file's text */
  int type;
} gh_data_label;

typedef struct gh_data_parser {
  gh_context *ctx;
  gh_reader r;
  gh_lammps_data *data;
  const char *title;
  int seen[GH_DATA_HEADERS];   /* line of each header, 0 while missing */
  long count[GH_DATA_HEADERS]; /* of what is counted */
  double vector[4][3];         /* avec, bvec, cvec, abc origin */
  gh_data_label *labels;       /* ntypes, sorted by text; NULL without a section Atom Type Labels */
  bool atoms_read;
  const char *comment; /* of the line that was read last, "" when it has none */
} gh_data_parser;

/* A message about the line that was read last. */
#define GH_DATA_FAIL(p, format, ...)                                                                         \
  gh_fail((p)->ctx, GH_INPUT, "%s:%d: " format, (p)->r.path, (p)->r.line, __VA_ARGS__)

/* The next line that states something, without blanks around it and without its comment; NULL at the end. */
char *gh_data_line(gh_data_parser *p);
gh_status gh_data_number(gh_data_parser *p, const char *text, const char *what, double *value);

/* ---- lammps_header.c ---- */

/* One line of the header, which is changed. */
gh_status gh_data_header_line(gh_data_parser *p, char *line);
/* At the end of the header: is everything there? Makes the cell. */
gh_status gh_data_header_end(gh_data_parser *p);

/* ---- lammps_sections.c ---- */

bool gh_data_opens_section(const char *line);
/* The sections behind the header, beginning with the one that `line` opens. */
gh_status gh_data_sections(gh_data_parser *p, char *line);

#endif
