/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The module of the LAMMPS engine, loaded on demand. */
#define _GNU_SOURCE
#include "engine/module.h"

#include <dlfcn.h>
#include <libgen.h>
#include <limits.h>
#include <link.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef GH_MODULE_LAMMPS
#define GH_MODULE_LAMMPS 0 /* the Makefile names the version that the module is built with */
#endif

/* Its folders: that of the program or the library which this code is part of, as in the folder of a build,
 * and from there as installed in bin/ and lib/. An archive that has been installed knows its place besides,
 * for programs that are linked to it and lie elsewhere. */
enum { PLACES = 4 };
typedef struct places {
  char path[PLACES][PATH_MAX];
  int count;
} places;

/* The folder of the program or the library that has this function; false where the system does not say. */
static bool folder_find(char folder[PATH_MAX]) {
  static const char here; /* an object lies where the code does */
  char file[PATH_MAX];
  Dl_info info;
  struct link_map *map;
  if (!dladdr1(&here, &info, (void **)&map, RTLD_DL_LINKMAP) || !map) return false;
  if (!realpath(*map->l_name ? map->l_name : "/proc/self/exe", file)) return false;
  snprintf(folder, PATH_MAX, "%s", dirname(file));
  return true;
}

static void places_add(places *p, const char *folder, const char *below) {
  char *path = p->path[p->count];
  const int length = snprintf(path, PATH_MAX, "%s%s/" GH_MODULE_FILE, folder, below);
  if (length < PATH_MAX) p->count++;
}

static void places_list(places *p) {
  char folder[PATH_MAX];
  p->count = 0;
  if (folder_find(folder)) {
    places_add(p, folder, "");
    places_add(p, folder, "/granhom");
    places_add(p, folder, "/../lib/granhom");
  }
#ifdef GH_MODULE_PLACE
  places_add(p, GH_MODULE_PLACE, "");
#endif
}

/* The first place where there is a file; NULL after a message that names all. */
static const char *places_search(gh_context *ctx, const places *p) {
  char tried[1024] = "";
  for (int k = 0; k < p->count; k++) {
    if (access(p->path[k], F_OK) == 0) return p->path[k];
    const size_t used = strlen(tried);
    snprintf(tried + used, sizeof tried - used, "%s%.300s", k ? ", " : "", p->path[k]);
  }
  gh_fail(ctx, GH_ENGINE,
          "the LAMMPS engine cannot be loaded: there is none of the files %s; `make` builds it beside the "
          "program, `make install` puts it into PREFIX/lib/granhom",
          tried);
  return NULL;
}

static gh_status module_check(gh_context *ctx, const char *path, const gh_lammps_module *module) {
  if (!module)
    return gh_fail(ctx, GH_ENGINE, "the LAMMPS engine cannot be loaded: %s is no module of granhom", path);
  if (strcmp(module->build(), gh_build()) == 0) return GH_OK;
  return gh_fail(ctx, GH_ENGINE,
                 "the LAMMPS engine cannot be loaded: %s is of another build of granhom (%s, not %s)", path,
                 module->build(), gh_build());
}

/* RTLD_LOCAL: nothing of LAMMPS and its libraries takes the place of what the program has. RTLD_NODELETE:
 * LAMMPS, Python and MPI leave functions behind that are called when the program ends. */
static gh_status module_load(gh_context *ctx, const char *path, const gh_lammps_module **module) {
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!handle) return gh_fail(ctx, GH_ENGINE, "the LAMMPS engine cannot be loaded: %s", dlerror());
  const gh_lammps_module *found = dlsym(handle, "gh_lammps_linked");
  GH_TRY(module_check(ctx, path, found));
  *module = found;
  return GH_OK;
}

gh_status gh_lammps_load(gh_context *ctx, const gh_lammps_module **module) {
  static _Atomic(const gh_lammps_module *) loaded; /* a constant, which whoever comes first looks up */
  *module = &gh_lammps_linked ? &gh_lammps_linked : atomic_load(&loaded);
  if (*module) return GH_OK;
  places all;
  places_list(&all);
  const char *path = places_search(ctx, &all);
  if (!path) return GH_ENGINE;
  GH_TRY(module_load(ctx, path, module));
  atomic_store(&loaded, *module);
  return GH_OK;
}

int gh_engine_lammps_built(void) {
  places all;
  places_list(&all);
  return &gh_lammps_linked || places_search(NULL, &all) ? GH_MODULE_LAMMPS : 0;
}
