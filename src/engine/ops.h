/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What an engine must be able to do; the private side of include/granhom/engine.h. */
#ifndef GRANHOM_ENGINE_OPS_H
#define GRANHOM_ENGINE_OPS_H

#include "granhom/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gh_engine_ops {
  const char *name;
  gh_status (*create)(gh_context *ctx, const gh_engine_setup *setup, void **self);
  void (*destroy)(void *self);
  gh_status (*begin)(void *self, const gh_converged *state); /* only with friction */
  gh_status (*set)(void *self, const double cell[4], const double *x, const double *theta);
  gh_status (*move)(void *self, const double *x, const double *theta);
  gh_status (*load)(void *self, const double *force, const double *moment);
  gh_status (*relax)(void *self, const gh_relax_options *options, gh_relax_result *result);
  gh_status (*ramp)(void *self, const gh_ramp *ramp, gh_ramp_result *result); /* only with friction */
  gh_status (*contacts)(void *self, gh_contact_list *list);
  gh_status (*get)(void *self, double *x, double *theta);
  void (*costs)(const void *self, gh_engine_cost *cost);
} gh_engine_ops;

extern const gh_engine_ops gh_native_ops; /* src/engine/native/ */
extern const gh_engine_ops gh_lammps_ops; /* src/engine/lammps/, within the module (engine/module.h) */

#ifdef __cplusplus
}
#endif
#endif
