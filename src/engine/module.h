/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the module of the LAMMPS engine gives to the library that loads it.
 *
 * LAMMPS brings some fifty libraries along, which nobody should wait for who does not use it. So
 * src/engine/lammps/ is a module of its own, granhom-lammps.so, of which this table is the only way in. It
 * has its own copies of src/base/context.c and of the kernels that it shares with the native engine, and asks
 * nothing of the program: it may be linked to libgranhom.so or libgranhom.a, or load one of them itself. */
#ifndef GRANHOM_ENGINE_MODULE_H
#define GRANHOM_ENGINE_MODULE_H

#include "engine/ops.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The functions are those of granhom/lammps.h, where they are described. */
typedef struct gh_lammps_module {
  const char *(*build)(void); /* gh_build() of the module: a gh_context looks the same on both sides */
  const gh_engine_ops *engine;
  gh_status (*open)(gh_context *ctx, void **lmp);
  int (*version)(gh_context *ctx, void *lmp);
  void (*close)(void **lmp);
  gh_status (*command)(gh_context *ctx, void *lmp, const char *format, ...) GH_PRINTF(3, 4);
  gh_status (*create_atoms)(gh_context *ctx, void *lmp, int n, const int *id, const int *type,
                            const double *x);
  gh_status (*setting)(gh_context *ctx, void *lmp, const char *name, int *value);
  gh_status (*atom)(gh_context *ctx, void *lmp, const char *name, void *p);
  gh_status (*local)(gh_context *ctx, void *lmp, const char *id, int *count, double ***rows);
  gh_status (*fix_vector)(gh_context *ctx, void *lmp, const char *id, int component, double *value);
  gh_status (*program)(gh_context *ctx, int argc, char **argv, bool programs, int *exit_status, bool *alone);
} gh_lammps_module;

#define GH_MODULE_FILE "granhom-lammps.so"

/* The table of granhom-lammps.so. Tests link the objects of the module themselves, and have it then without
 * loading anything; elsewhere its address is NULL. */
extern const gh_lammps_module gh_lammps_linked __attribute__((weak));

/* Loads the module when it is asked for the first time. GH_ENGINE: it is not there, or of another build, or
 * one of LAMMPS's libraries is missing; the message names the places. It stays loaded. */
gh_status gh_lammps_load(gh_context *ctx, const gh_lammps_module **module);

#ifdef __cplusplus
}
#endif
#endif
