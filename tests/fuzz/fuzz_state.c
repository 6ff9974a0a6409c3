/* SPDX-License-Identifier: GPL-2.0-or-later */
/* States of one material point (--load-state): a file of ours with datasets that are missing, of another type
 * or shape, or with other values. The checksum is that of the changed file, so that the reader sees it;
 * damaged bytes are refused before HDF5 sees them, and are the matter of another target (bytes). */
#include "../../driver/rve_state.h"
#include "fuzz.h"

#include <string.h>
#include <unistd.h>

static const char *const names[] = {"boundary",  "law",   "packing/cell", "packing/radius",
                                    "packing/x", "state", "packing",      NULL};

/* An RVE that has read a state gives a stress, or states why not. */
static void state_use(gh_context *ctx, gh_rve *rve) {
  static const double F[4] = {0.9999, 0, 0, 1};
  double P[4] = {0};
  gh_status status = gh_rve_evaluate(rve, F, 0, P, NULL);
  if (status == GH_OK) fuzz_require(gh_finite(P, 4), "a stress that is not finite");
  else fuzz_require(*gh_message(ctx), "a failure without a message");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  gh_context *ctx = fuzz_begin();
  gh_rve_options options = gh_rve_defaults();
  gh_packing *packing = NULL;
  gh_rve *rve = NULL;
  options.engine = GH_ENGINE_NATIVE;
  options.boundary = GH_RESTRICTED;
  options.max_steps = 200;
  options.law = (gh_contact_law){.normal_stiffness = 1, .friction = size > 0 && data[0] & 1};
  const char *base = options.law.friction ? "friction.h5" : "smooth.h5";
  if (options.law.friction) {
    options.law.tangential_stiffness = 1;
    options.law.friction_coefficient = 0.5;
  }
  const char *folder = fuzz_folder("states");
  fuzz_require(chdir(folder) == 0, "no folder");
  fuzz_require(gh_packing_read(ctx, "p.data", &packing) == GH_OK &&
                   gh_rve_create(ctx, packing, &options, &rve) == GH_OK,
               gh_message(ctx));
  if (size > 0) fuzz_change_h5(ctx, base, names, data + 1, size - 1);
  if (fuzz_good(ctx, rve_state_load(ctx, base, rve, &options, packing))) state_use(ctx, rve);
  fuzz_require(chdir("..") == 0, "no folder above");
  gh_rve_destroy(&rve);
  gh_packing_destroy(&packing);
  fuzz_end(ctx);
  return 0;
}
