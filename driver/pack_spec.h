/* What `granhom pack` shall do: from a YAML file and from options, by the same words.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#ifndef GRANHOM_PACK_SPEC_H
#define GRANHOM_PACK_SPEC_H

#include "granhom/finish.h"
#include "granhom/packing.h"

typedef struct pack_spec {
  char *sieve, *output, *picture; /* owned; NULL: not given */
  int dim, count, ensemble;       /* count 0: as in the sieve curve; ensemble 0: one packing */
  gh_grow_options grow;           /* rate NAN until pack_spec_complete */
  double cell[3], tilt[3];        /* cell[0] 0: not given; tilt: xy xz yz */
  int cells, tilts;               /* numbers given */
  bool finish, soft;              /* soft: a setting that only --finish uses was given */
  gh_finish_options soft_options;
} pack_spec;

void pack_spec_init(pack_spec *spec);
void pack_spec_free(pack_spec *spec);
/* Whether there is a setting of this name (as an option: "volume-fraction"). */
bool pack_spec_knows(const char *name);
/* Sets one by its text. `where` opens the message: "--rate" or "sand.yaml:3: rate". GH_INPUT. */
gh_status pack_spec_set(gh_context *ctx, pack_spec *spec, const char *name, const char *where,
                        const char *text);
/* Sets all that a file says; keys are the options' names with underscores; paths are relative to its folder.
 */
gh_status pack_spec_read(gh_context *ctx, const char *path, pack_spec *spec);
/* Checks what belongs together, fills what depends on the dimension. GH_INPUT. */
gh_status pack_spec_complete(gh_context *ctx, pack_spec *spec);

#endif
