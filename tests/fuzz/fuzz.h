/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the fuzz targets share.
 *
 * A target is one file fuzz_NAME.c with LLVMFuzzerTestOneInput. It hands the bytes to one reader and checks
 * what comes back: GH_OK with values that are finite, or GH_INPUT with a message of one line. All else stops
 * the program, so that libFuzzer, or standalone.c, keeps the input. tests/fuzz/run.py prepares the folder
 * that targets work in (FUZZ_DATA). */
#ifndef GRANHOM_FUZZ_H
#define GRANHOM_FUZZ_H

#include "granhom/io.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A context for one input; quiet. */
gh_context *fuzz_begin(void);
void fuzz_end(gh_context *ctx);
/* GH_OK or GH_INPUT with a message of one line without control characters. Returns status == GH_OK. */
bool fuzz_good(const gh_context *ctx, gh_status status);
/* Stops the program unless `good`. */
void fuzz_require(bool good, const char *what);

/* Writes the bytes to a file of this process in `folder` of FUZZ_DATA, which becomes the folder worked in;
 * its name. */
const char *fuzz_file(const char *folder, const char *ending, const void *data, size_t size);
/* The bytes as a text that the caller frees. */
char *fuzz_text(const uint8_t *data, size_t size);
/* A folder of this process with a copy of the files in `folder` of FUZZ_DATA; its name. It becomes the folder
 * worked in. */
const char *fuzz_folder(const char *folder);

/* What the seal at the start of a file of ours states of its kind. */
void fuzz_kind(const char *path, char kind[40]);

/* Changes to an HDF5 file of ours, as the bytes say: datasets removed, replaced by others of another type,
 * shape or content. `names`: those it may have; ends with NULL. */
void fuzz_change_h5(gh_context *ctx, const char *path, const char *const *names, const uint8_t *data,
                    size_t size);

#endif
