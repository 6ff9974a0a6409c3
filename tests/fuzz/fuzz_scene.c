/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Scenes: reading, checking, explaining, and the loads of some increments of each step. */
#include "fuzz.h"
#include "granhom/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("scenes/block", "yaml", data, size);
  gh_context *ctx = fuzz_begin();
  gh_scene *scene = NULL;
  gh_text *out;
  if (fuzz_good(ctx, gh_scene_read(ctx, file, &scene))) {
    fuzz_require(gh_text_create(ctx, &out) == GH_OK, "no text");
    gh_scene_explain(scene, out);
    gh_text_destroy(&out);
    fuzz_require(gh_scene_steps(scene) >= 1, "a scene without steps");
  }
  gh_scene_destroy(&scene);
  fuzz_end(ctx);
  return 0;
}
