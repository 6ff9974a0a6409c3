/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What `granhom pack` shall do: from a YAML file and from options, by the same words. */
#ifndef GRANHOM_PACK_SPEC_H
#define GRANHOM_PACK_SPEC_H

#include "options.h"

#include "granhom/finish.h"
#include "granhom/packing.h"

typedef struct pack_spec {
  const char *file;                     /* that describes the packing; NULL: none */
  const char *sieve, *output, *picture; /* NULL: not given */
  char *own_sieve;                      /* sieve, where a file names it; owned */
  int dim, count, ensemble;             /* count 0: as in the sieve curve; ensemble 0: one packing */
  long seed;
  gh_grow_options grow;    /* rate NAN until pack_spec_complete */
  double cell[3], tilt[3]; /* tilt: xy xz yz */
  int cells, tilts;        /* numbers given */
  bool finish, quiet;
  gh_finish_options soft;       /* of --finish */
  double stiffness, anisotropy; /* NAN and -1: not given; into `soft` by pack_spec_complete */
  int finish_cell, engine;
} pack_spec;

/* Options of the command line and keys of the file: groups that fill a pack_spec. */
extern const option_row pack_spec_rows[], pack_growth_rows[], pack_soft_rows[];

/* The keys of the file, as they are written there, with their meaning and default. */
enum { PACK_MOST_KEYS = 31 };
typedef struct pack_terms {
  char name[PACK_MOST_KEYS][32], text[PACK_MOST_KEYS][OPTION_MOST_TEXT];
  gh_term terms[PACK_MOST_KEYS + 1];
} pack_terms;
void pack_terms_list(pack_terms *t);

void pack_spec_init(pack_spec *spec);
void pack_spec_free(pack_spec *spec);
/* Sets a parameter by its text. `where` opens the message: "--rate" or "sand.yaml:3: rate". GH_INPUT, also
 * for a name that is none. */
gh_status pack_spec_set(gh_context *ctx, pack_spec *spec, const char *name, const char *where,
                        const char *text);
/* Sets all that a file states; keys are the options' names with underscores; paths are relative to its
 * folder.
 */
gh_status pack_spec_read(gh_context *ctx, const char *path, pack_spec *spec);
/* Checks what belongs together, fills what depends on the dimension. GH_INPUT. */
gh_status pack_spec_complete(gh_context *ctx, pack_spec *spec);

#endif
