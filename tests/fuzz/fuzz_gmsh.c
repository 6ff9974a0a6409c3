/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Gmsh's meshes. */
#include "fuzz.h"
#include "granhom/macro.h"

static void mesh_use(const gh_mesh *m) {
  fuzz_require(m->nnodes > 0 && m->nelements > 0 && gh_finite(m->X, 2 * (size_t)m->nnodes),
               "a mesh with coordinates that are not finite");
  for (int e = 0; e < m->nelements; e++)
    for (int k = 0; k < 4; k++)
      fuzz_require(m->quad[e][k] >= 0 && m->quad[e][k] < m->nnodes, "an element with a node that is none");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *file = fuzz_file("packings", "msh", data, size);
  gh_context *ctx = fuzz_begin();
  gh_mesh *mesh = NULL;
  if (fuzz_good(ctx, gh_mesh_read_gmsh(ctx, file, &mesh))) {
    mesh_use(mesh);
    fuzz_good(ctx, gh_mesh_check(ctx, mesh));
  }
  gh_mesh_destroy(&mesh);
  fuzz_end(ctx);
  return 0;
}
