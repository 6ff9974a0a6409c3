/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Checksums of binary files. */
#ifndef GRANHOM_IO_SEAL_H
#define GRANHOM_IO_SEAL_H

#include "granhom/base.h"

/* Bytes at the front of a file that the seal takes. */
enum { GH_SEAL = 512 };
/* Seals a file in memory, of length bytes (at least GH_SEAL). kind: what it holds and the version of that,
 * "state 1", at most 39 letters. */
void gh_seal_make(const char *kind, void *bytes, size_t length);
/* Checks each byte of a file. GH_INPUT: missing, empty, no file, damaged (whatever was changed, cut off or
 * appended), of another kind, or an HDF5 file without a seal; with `sealed` the latter is allowed, and
 * *sealed states whether. GH_SYSTEM: cannot be read. */
gh_status gh_seal_check(gh_context *ctx, const char *path, const char *kind, bool *sealed);

#endif
