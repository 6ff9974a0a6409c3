/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Damaged bytes of a binary file: refused, with a message, before HDF5 sees them. Each input is three bytes
 * per change: where, and what is added to the byte there. */
#include "../../driver/rve_state.h"
#include "fuzz.h"

#include <stdio.h>
#include <unistd.h>

/* Whether the file is another one afterwards. */
static bool file_damage(const char *path, const uint8_t *data, size_t size) {
  FILE *file = fopen(path, "r+");
  fuzz_require(file && fseek(file, 0, SEEK_END) == 0, "no file");
  long length = ftell(file);
  int different = 0;
  for (size_t k = 0; k + 3 <= size && k < 30; k += 3) {
    long at = (data[k] + 256L * data[k + 1]) % length;
    fseek(file, at, SEEK_SET);
    int c = fgetc(file);
    fseek(file, at, SEEK_SET);
    fputc((c + data[k + 2]) & 0xFF, file);
    different += data[k + 2] != 0;
  }
  fclose(file);
  return different == 1; /* several at one place may make up for each other */
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  gh_context *ctx = fuzz_begin();
  gh_rve_options options = gh_rve_defaults();
  gh_packing *packing = NULL;
  gh_rve *rve = NULL;
  options.engine = GH_ENGINE_NATIVE;
  options.boundary = GH_RESTRICTED;
  options.law = (gh_contact_law){.normal_stiffness = 1};
  const char *folder = fuzz_folder("states");
  fuzz_require(chdir(folder) == 0, "no folder");
  bool damaged = file_damage("smooth.h5", data, size);
  fuzz_require(gh_packing_read(ctx, "p.data", &packing) == GH_OK &&
                   gh_rve_create(ctx, packing, &options, &rve) == GH_OK,
               gh_message(ctx));
  bool good = fuzz_good(ctx, rve_state_load(ctx, "smooth.h5", rve, &options, packing));
  fuzz_require(!good || !damaged, "a damaged file is read as a good one");
  fuzz_require(chdir("..") == 0, "no folder above");
  gh_rve_destroy(&rve);
  gh_packing_destroy(&packing);
  fuzz_end(ctx);
  return 0;
}
